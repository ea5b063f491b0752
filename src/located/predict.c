/* SPDX-License-Identifier: MIT */
/*
 * The next event of one body. A gas spends most of its time here, so spheres on parabolas of equal
 * acceleration have a fast path: their relative motion is straight, a branch-free SIMD test filters
 * two pairs at a time, and only the few that may collide are solved. All others use pair_contacts
 * or approach.
 */
#include "located/predict.h"

#include "base/error.h"

#include <float.h>

#include "located/approach.h"
#include "located/crowd.h"
#include "math/decay.h"
#include "math/quartic.h"

/* Number of bodies from which arrays exceed the caches, so that prefetching pays. */
enum { PREFETCH_BODIES = 4096 };

/* The search for a body's next event. */
struct search {
	struct rb_located *l;
	int i, except;
	double now, until;
	double radius;
	bool plain;   /* a centred sphere on a parabola */
	bool general; /* collision filters or driven bodies exist: pairs are tested one by one */
	bool quick;   /* plain, under gravity alone, without filters */
	bool falls;   /* it has an acceleration by constant forces */
	double decay; /* 1/s: rate of linear drag */
	bool follows; /* it is on a piece, approximated by `parabola` */
	struct rb_parabola parabola;
	rb_vec3 position, velocity, acceleration; /* now */
	double reach, speed; /* m: largest coordinate or radius; m/s: largest component */
	int touching;
	struct rb_next next;
};

/* fmax is a library call without -ffinite-math-only, which costs time here. */
static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

static inline double largest(rb_vec3 a)
{
	return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z)));
}

/* Seconds from now, for the transformed time tau of math/decay if the body has drag. */
static inline double seconds(const struct search *s, double tau)
{
	return s->decay > 0 ? rb_decay_time(s->decay, tau) : tau;
}

/* Keeps a touch if it is the earliest. */
static inline void add_touch(struct search *s, int j, double t, bool again)
{
	if (t >= s->next.touch_s)
		return;
	s->next.touch_s = t;
	s->next.partner = j;
	s->next.unfinished = again;
}

/*
 * Touch with a sphere at x moving with v now, of equal acceleration and decay: now, or at a root.
 */
static inline void add_flight(struct search *s, int j, rb_vec3 x, rb_vec3 v, double radius)
{
	const struct rb_located *l = s->l;
	const rb_vec3 d = rb_vec3_sub(x, s->position), w = rb_vec3_sub(v, s->velocity);
	const double sum = s->radius + radius;
	const double b = rb_vec3_dot(d, w), c = rb_vec3_dot(d, d) - sum * sum;

	if (c < 1e-3 * sum * sum || b < 0) {
		const double reach = larger(larger(s->reach, radius), largest(x));
		const double band = DBL_EPSILON * (8 * reach + 2 * s->now * fabs(b) / sum);

		if (c <= 2 * sum * band) {
			const double noise = 8 * DBL_EPSILON * (s->speed + largest(v));

			if (j != s->except && !rb_event_set_held(l, s->i, j))
				s->touching++;
			if (-b > noise * sum && !rb_event_set_held(l, s->i, j) &&
			    rb_contact_point_approaches(l, s->i, j, s->now))
				add_touch(s, j, s->now, false);
			return;
		}
	}
	/*
	 * no touch before c / (-2 b), which may be later than one already known; drag makes it
	 * later still
	 */
	if (!(b < 0) || c * (1 - 1e-9) > -2 * b * (s->next.touch_s - s->now))
		return;
	if (!rb_squares_hold(b * b)) {
		const double tau = rb_touch_time(d, w, sum);

		if (isfinite(tau))
			add_touch(s, j, s->now + seconds(s, tau), false);
		return;
	}
	const double square = rb_vec3_dot(w, w);
	double discriminant = b * b - square * c;
	if (discriminant < 1e-4 * b * b) {
		/* grazing: without the cancellation */
		const double speed = sqrt(square);
		const double offset = rb_vec3_length(rb_vec3_cross(d, w));

		discriminant = (speed * sum - offset) * (speed * sum + offset);
		if (discriminant < 0)
			return;
	}
	add_touch(s, j, s->now + seconds(s, c / (sqrt(discriminant) - b)), false);
}

/* Touch of a pair of spheres under the same acceleration; false: it is no such pair. */
static bool add_sphere(struct search *s, int j)
{
	const struct rb_located *l = s->l;
	const struct rb_arc *arc = &l->arc[j];

	if (!s->plain || (l->piece && l->piece[j].piece.n > 0))
		return false;
	const bool quick = s->quick && arc->plain_radius > 0;
	if (!quick && l->model->shape[j].kind != RB_SHAPE_SPHERE)
		return false;
	/* a plain sphere has the same acceleration: the rest of its arc is not read */
	const rb_vec3 a = quick ? s->acceleration : arc->acceleration;
	if (a.x != s->acceleration.x || a.y != s->acceleration.y || a.z != s->acceleration.z)
		return false;
	const double age = s->now - arc->anchor_s;
	rb_vec3 v, x;
	if (l->decays) {
		if (arc->decay != s->decay)
			return false;
		v = rb_decay_velocity(s->decay, age, arc->velocity, a);
		x = rb_vec3_add(arc->position, rb_decay_way(s->decay, age, arc->velocity, a));
	} else {
		v = rb_vec3_add_scaled(arc->velocity, age, a);
		x = rb_vec3_add_scaled(arc->position, age,
		                       rb_vec3_add_scaled(arc->velocity, 0.5 * age, a));
	}

	add_flight(s, j, x, v, quick ? arc->plain_radius : l->model->shape[j].radius);
	return true;
}

/* Two doubles in one vector register (SSE2 or NEON). */
typedef double two __attribute__((vector_size(16)));

struct two_vec {
	two x, y, z;
};

static inline two both(double a)
{
	return (two){a, a};
}

static inline struct two_vec pair_of(rb_vec3 a, rb_vec3 b)
{
	return (struct two_vec){{a.x, b.x}, {a.y, b.y}, {a.z, b.z}};
}

static inline struct two_vec plus_scaled(struct two_vec a, two s, struct two_vec b)
{
	return (struct two_vec){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline struct two_vec scaled(two s, struct two_vec a)
{
	return (struct two_vec){s * a.x, s * a.y, s * a.z};
}

static inline struct two_vec minus(struct two_vec a, struct two_vec b)
{
	return (struct two_vec){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline two dot(struct two_vec a, struct two_vec b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* 0 if both have the same drag, else NAN. */
static inline double decay_mismatch(const struct search *s, const struct rb_arc *arc)
{
	return arc->decay == s->decay ? 0 : (double)NAN;
}

/*
 * Keeps the candidates that add_sphere must examine: those that are near or will come close, and
 * all that are not plain spheres. Branch-free, since the outcome is unpredictable.
 */
static inline __attribute__((always_inline)) int filter_near(const struct search *s, int *near,
                                                             int count, bool falls, bool slows)
{
	const struct rb_arc *arcs = s->l->arc;
	const struct two_vec here = pair_of(s->position, s->position);
	const struct two_vec mine = pair_of(s->velocity, s->velocity);
	const struct two_vec a = pair_of(s->acceleration, s->acceleration);
	const int last = count > 0 ? near[count - 1] : -1;
	int kept = 0;

	for (int k = 0; k < count; k += 2) {
		const int i = near[k], j = near[k + 1 < count ? k + 1 : k];
		const struct rb_arc *first = &arcs[i], *second = &arcs[j];
		const two age = both(s->now) - (two){first->anchor_s, second->anchor_s};
		struct two_vec v = pair_of(first->velocity, second->velocity), mean = v;

		if (slows) {
			const struct rb_decay d = rb_decay_at(s->decay * age[0]),
					      e = rb_decay_at(s->decay * age[1]);

			mean = plus_scaled(scaled((two){d.once, e.once}, v),
			                   (two){d.twice, e.twice} * age, a);
			v = plus_scaled(scaled((two){d.left, e.left}, v),
			                (two){d.once, e.once} * age, a);
		} else if (falls) {
			mean = plus_scaled(v, both(0.5) * age, a);
			v = plus_scaled(v, age, a);
		}
		const struct two_vec d = minus(
			plus_scaled(pair_of(first->position, second->position), age, mean), here);
		const struct two_vec w = minus(v, mine);
		two sum = both(s->radius) + (two){first->plain_radius, second->plain_radius};
		if (slows)
			sum += (two){decay_mismatch(s, first), decay_mismatch(s, second)};
		const two square = sum * sum, b = dot(d, w), c = dot(d, d) - square;
		/* false for NaN radii; 1e-290: squares of smaller numbers underflow */
		const __typeof__(b < c) is_far =
			(c >= both(1e-3) * square) &
			((b >= both(0)) | (b * b * both(1 + 1e-6) + both(1e-290) < dot(w, w) * c));

		/* true is -1 */
		near[kept] = i;
		kept += 1 + (int)is_far[0];
		near[kept] = j;
		kept += 1 + (int)is_far[1];
	}
	/* an odd last one was tested twice */
	if (count % 2 == 1 && kept > 0 && near[kept - 1] == last)
		kept--;
	return kept;
}

/* Filters the candidates; those on pieces are kept in front. */
static int filter_candidates(const struct search *s, int *near, int count)
{
	const struct rb_located *l = s->l;

	int odd = 0;

	/* arcs of bodies on pieces are void */
	for (int k = 0; l->piece && k < count; k++) {
		const int j = near[k];

		if (l->piece[j].piece.n > 0) {
			near[k] = near[odd];
			near[odd++] = j;
		}
	}
	for (int k = 0; l->n >= PREFETCH_BODIES && k < count; k++)
		__builtin_prefetch(&l->arc[near[k]]);
	near += odd;
	count -= odd;
	if (l->decays)
		return odd + filter_near(s, near, count, true, true);
	return odd + (s->falls ? filter_near(s, near, count, true, false)
	                       : filter_near(s, near, count, false, false));
}

/*
 * Touch of a sphere in flight with a plane at rest that it is not near; false: it is no such pair.
 */
static bool add_plane(struct search *s, int j)
{
	const struct rb_located *l = s->l;
	const rb_vec3 n = l->plane_normal[j - l->n];
	const double gap = rb_vec3_dot(rb_vec3_sub(s->position, l->model->position[j]), n) -
	                   s->radius;
	const double rate = rb_vec3_dot(s->velocity, n);
	const double external = rb_vec3_dot(s->acceleration, n);

	if (!s->plain || s->decay > 0 ||
	    !(gap > DBL_EPSILON * (16 * s->reach + 4 * s->now * fabs(rate))))
		return false;
	const double discriminant = rate * rate - 2 * external * gap;
	if (discriminant < 0 || (rate >= 0 && external >= 0))
		return true;
	const double t = s->now + (rate < 0 ? 2 * gap / (sqrt(discriminant) - rate)
	                                    : (rate + sqrt(discriminant)) / -external);
	if (t <= s->until)
		add_touch(s, j, t, false);
	return true;
}

static void add_body(struct search *s, int j);

/* Earliest touch with a plane at rest, without gravity, found without branches. */
struct first_plane {
	double near; /* m: at least add_plane's band, since |v . n| < 2 x the largest component */
	double t;
	int which;
};

static inline void add_one_plane(struct search *s, struct first_plane *first, int j, double gap,
                                 double rate)
{
	if (!(gap > first->near) || s->l->model->shape[j].kind != RB_SHAPE_PLANE) {
		add_body(s, j);
		return;
	}
	const double t = s->now + gap / (rate < 0 ? -rate : 0); /* infinite if it separates */

	first->which = t < first->t ? j : first->which;
	first->t = t < first->t ? t : first->t;
}

/* Touches with all static bodies, two at a time, of a sphere without acceleration. */
static void add_planes(struct search *s)
{
	const struct rb_located *l = s->l;
	const int count = l->model->static_count;
	const rb_vec3 *points = l->model->position + l->n;
	const struct two_vec here = pair_of(s->position, s->position);
	const struct two_vec mine = pair_of(s->velocity, s->velocity);
	struct first_plane first = {DBL_EPSILON * (16 * s->reach + 8 * s->now * s->speed), HUGE_VAL,
	                            -1};

	for (int k = 0; k < count; k += 2) {
		const int next = k + 1 < count ? k + 1 : k;
		const struct two_vec n = pair_of(l->plane_normal[k], l->plane_normal[next]);
		const two gap = dot(minus(here, pair_of(points[k], points[next])), n) -
		                both(s->radius);
		const two rate = dot(mine, n);

		add_one_plane(s, &first, l->n + k, gap[0], rate[0]);
		if (next > k)
			add_one_plane(s, &first, l->n + next, gap[1], rate[1]);
	}
	if (s->decay > 0)
		first.t = s->now + seconds(s, first.t - s->now);
	if (first.t <= s->until)
		add_touch(s, first.which, first.t, false);
}

/* Work, in multiplications, of a candidate whose touch has no closed form. */
enum { SEARCH_WORK = 1 << 13 };

static bool is_interrupted(struct search *s)
{
	if (!rb_interrupt_after(&s->l->world->interrupt, SEARCH_WORK))
		return false;
	s->l->status = RB_FAIL(s->l->err, RB_ERR_INTERRUPT, "interrupted");
	return true;
}

static bool in_contact(const struct rb_located *l, int i)
{
	return i < l->n && l->cluster_of[i] >= 0 && l->cluster[l->cluster_of[i]].held_count > 0;
}

/* Touch with one candidate, by the cheapest test that applies. */
static void add_body(struct search *s, int j)
{
	const struct rb_located *l = s->l;
	struct rb_approach flight = {0};

	if (!s->general && j < l->n ? add_sphere(s, j)
	                            : j >= l->n && l->model->shape[j].kind == RB_SHAPE_PLANE &&
	                                      !s->general && add_plane(s, j))
		return;
	if (!rb_pair_can_touch(l, s->i, j) || rb_event_set_held(l, s->i, j) || is_interrupted(s))
		return;
	double until = fmin(s->until, s->next.touch_s);
	if (rb_located_on_piece(l, j))
		until = fmin(until, l->piece[j].until_s);
	if ((s->follows && rb_pair_remains_separated(l, s->i, j, &s->parabola, s->now, until)) ||
	    rb_pair_is_far(l, s->i, j, s->now, until))
		return;
	if (rb_pair_has_features(l, s->i, j)) {
		const struct rb_approach found = rb_approach_find(l, s->i, j, s->now, until);

		s->l->products += found.products;
		s->touching += found.touching && s->except != j;
		add_touch(s, j, found.touch_s, found.unfinished);
		return;
	}
	if (s->except != j && !(s->follows && rb_pair_is_far(l, s->i, j, s->now, s->now))) {
		const struct rb_contact_point m = rb_contact_point_at(l, s->i, j, s->now);

		s->touching += m.gap <= rb_contact_point_band(l, &m, s->now);
		flight.products += RB_LOCATED_SEARCH;
	}
	const double t = rb_pair_contact_time(l, s->i, j, s->now, until, &flight);
	if (rb_crowd_counts_spheres(l) || in_contact(l, s->i) || in_contact(l, j))
		s->l->products += flight.products;
	add_touch(s, j, t, flight.unfinished);
}

/* Reads position, velocity and acceleration of the body now. */
static inline void read_state(struct search *s, const struct rb_located *l, int i, double now)
{
	const struct rb_arc *arc = &l->arc[i];

	s->until = l->end_s;
	if (rb_located_on_piece(l, i)) {
		s->position = rb_arc_position(l, i, now);
		s->velocity = rb_arc_velocity(l, i, now);
		s->acceleration = rb_arc_acceleration(l, i, now);
		s->until = fmin(s->until, l->piece[i].until_s);
		return;
	}
	const double age = now - arc->anchor_s;

	s->acceleration = arc->acceleration;
	s->decay = rb_arc_decay(l, i);
	if (s->decay > 0) {
		s->position = rb_arc_position(l, i, now);
		s->velocity = rb_arc_velocity(l, i, now);
		return;
	}
	s->velocity = rb_vec3_add_scaled(arc->velocity, age, arc->acceleration);
	s->position = rb_vec3_add_scaled(
		arc->position, age,
		rb_vec3_add_scaled(arc->velocity, 0.5 * age, arc->acceleration));
}

/* Prepares the search for body i. */
static inline void begin(struct search *s, struct rb_located *l, int i, double now, int except)
{
	s->l = l;
	s->i = i;
	s->except = except;
	s->now = now;
	s->touching = 0;
	s->decay = 0;
	s->general = l->model->group_bit || l->model->driven;
	s->quick = l->arc[i].plain_radius > 0 && !rb_located_on_piece(l, i) && !s->general;
	s->plain = s->quick || (l->model->shape[i].kind == RB_SHAPE_SPHERE &&
	                        !rb_located_on_piece(l, i) && !l->model->center_of_mass);
	s->radius = s->quick ? l->arc[i].plain_radius : l->model->shape[i].radius;
	read_state(s, l, i, now);
	s->falls = largest(s->acceleration) > 0;
	s->follows = rb_located_on_piece(l, i);
	if (s->follows)
		s->parabola = rb_relative_parabola(l, i, now);
	s->reach = larger(s->radius, largest(s->position));
	s->speed = largest(s->velocity);
}

/* Bounds on the acceleration of a body over its piece, by axis. */
static rb_vec3 accelerations_max(const struct rb_piece_of *p)
{
	const int first = p->first + RB_PIECE_VELOCITY;

	return (rb_vec3){rb_gauss_rate_bound(&p->piece, first),
	                 rb_gauss_rate_bound(&p->piece, first + 1),
	                 rb_gauss_rate_bound(&p->piece, first + 2)};
}

/*
 * Time at which a body on a piece may leave its cell. The end of a driven body's piece is an event
 * of its own, that of others one of their cluster.
 */
static void next_wall_of_piece(struct search *s)
{
	const struct rb_located *l = s->l;
	const struct rb_piece_of *p = &l->piece[s->i];

	if (l->cells)
		s->next.wall_s = s->now + rb_cells_time_inside(l->cells, s->i, s->position,
		                                               s->velocity, accelerations_max(p),
		                                               &s->next.wall);
	if (s->next.wall_s < p->until_s)
		return;
	s->next.wall_s = rb_located_driven(l, s->i) ? p->until_s : HUGE_VAL;
	s->next.wall = -1;
}

/* The same for a body with drag: its present acceleration, which only decays. */
static rb_vec3 deceleration_now(const struct search *s)
{
	const rb_vec3 a = rb_vec3_add_scaled(s->acceleration, -s->decay, s->velocity);

	return (rb_vec3){fabs(a.x), fabs(a.y), fabs(a.z)};
}

/* The time at which the body leaves its cell. */
static void next_wall(struct search *s)
{
	struct rb_located *l = s->l;

	if (rb_located_on_piece(l, s->i))
		next_wall_of_piece(s);
	else if (l->cells && s->decay > 0)
		s->next.wall_s = s->now + rb_cells_time_inside(l->cells, s->i, s->position,
		                                               s->velocity, deceleration_now(s),
		                                               &s->next.wall);
	else if (l->cells)
		s->next.wall_s = s->now + rb_cells_leaves(l->cells, s->i, s->position, s->velocity,
		                                          s->acceleration, &s->next.wall);
}

/* Stores the event and puts it into the queue. */
static void store(struct search *s)
{
	RB_ASSERT_COSTLY(!(s->next.touch_s < s->now) && !(s->next.wall_s < s->now));

	struct rb_located *l = s->l;

	if (s->next.partner >= 0 && s->next.partner < l->n)
		s->next.generation = l->generation[s->next.partner];
	l->next[s->i] = s->next;
	rb_queue_set(l->queue, s->i, fmin(s->next.touch_s, s->next.wall_s));
}

/*
 * Prefetches what the events of body i will read. With many bodies most of it is in slow memory; it
 * is requested while earlier events are handled, in two stages, the second of which needs the
 * results of the first. Hints only.
 */
static void prefetch_body(const struct rb_located *l, int i)
{
	__builtin_prefetch(&l->arc[i]);
	__builtin_prefetch(&l->arc[i].acceleration);
	__builtin_prefetch(&l->next[i]);
	__builtin_prefetch(&l->generation[i]);
	__builtin_prefetch(&l->cluster_of[i]);
	__builtin_prefetch(&l->model->inverse_mass[i]);
	__builtin_prefetch(&l->model->material[i]);
	rb_queue_prefetch(l->queue, i);
	if (l->cells)
		rb_cells_prefetch(l->cells, i);
}

static void prefetch_next(const struct rb_located *l)
{
	enum { NEXT_END = 3 };
	const int later = rb_queue_later(l->queue);

	for (int k = 1; k < NEXT_END; k++) {
		const int i = rb_queue_soon(l->queue, k);

		if (i < 0 || i >= l->n)
			continue;
		const int j = l->next[i].partner;

		if (l->cells)
			rb_cells_prefetch_near(l->cells, i);
		if (j >= 0 && j < l->n)
			prefetch_body(l, j);
	}
	if (later >= 0 && later < l->n)
		prefetch_body(l, later);
}

int rb_predict(struct rb_located *l, int i, double now, int except)
{
	struct search s;

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	RB_ASSERT_COSTLY(now >= l->arc[i].anchor_s);
	if (l->n >= PREFETCH_BODIES)
		prefetch_next(l);
	if (l->model->features & RB_FEATURE_CONTACT)
		begin(&s, l, i, now, except);
	else /* the only possible event is the end of a driven body's piece */
		s = (struct search){.l = l, .i = i, .now = now};
	s.next = (struct rb_next){.touch_s = HUGE_VAL, .partner = -1, .wall_s = HUGE_VAL};
	next_wall(&s);
	if (l->model->features & RB_FEATURE_CONTACT) {
		int near = rb_event_set_near(l, i);

		if (s.quick)
			near = filter_candidates(&s, l->near, near);
		for (int k = 0; k < near; k++)
			add_body(&s, l->near[k]);
		if (s.quick && !s.falls)
			add_planes(&s);
		for (int j = l->n; j < l->n + l->model->static_count && !(s.quick && !s.falls); j++)
			add_body(&s, j);
	}
	store(&s);
	return s.touching;
}

void rb_predict_wall(struct rb_located *l, int i, double now)
{
	struct search s;

	RB_ASSERT_COSTLY(rb_located_moves(l, i));
	RB_ASSERT_COSTLY(l->cells != NULL);
	if (l->n >= PREFETCH_BODIES)
		prefetch_next(l);
	begin(&s, l, i, now, -1);
	s.next = l->next[i];
	const bool goes = (!rb_located_on_piece(l, i) && !(s.decay > 0)) ||
	                  rb_cells_is_at_wall(l->cells, i, s.next.wall, s.position);
	int count = goes ? rb_cells_cross(l->cells, i, s.next.wall, l->near) : 0;

	if (s.quick)
		count = filter_candidates(&s, l->near, count);
	for (int k = 0; k < count; k++) {
		const int partner = s.next.partner;

		add_body(&s, l->near[k]);
		if (s.next.partner != partner && s.next.partner < l->n)
			s.next.generation = l->generation[s.next.partner];
	}
	next_wall(&s);
	/* the partner's generation is that of the time of prediction */
	l->next[i] = s.next;
	rb_queue_set(l->queue, i, fmin(s.next.touch_s, s.next.wall_s));
}
