/* SPDX-License-Identifier: MIT */
#include "event/foresee.h"

#include <float.h>

/* The body whose future is looked for; read once. */
struct seer {
	struct rb_located *l;
	int i, except;
	double now, until;
	double radius;
	bool plain;   /* a sphere about its centre on a parabola */
	bool general; /* filters or driven bodies: pairs are looked at one by one */
	rb_vec3 position, velocity, acceleration; /* now */
	double reach, speed; /* largest coordinate or radius; largest component */
	int touching;
	struct rb_next next;
};

/* fmax is a call into the library, which shows here. */
static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

static inline double largest(rb_vec3 a)
{
	return larger(fabs(a.x), larger(fabs(a.y), fabs(a.z)));
}

static inline void see(struct seer *s, int j, double t, bool again)
{
	if (t >= s->next.touch_s)
		return;
	s->next.touch_s = t;
	s->next.partner = j;
	s->next.again = again;
}

/* The hot path: two spheres in flight under the same acceleration. False: not such a pair. */
static bool see_sphere(struct seer *s, int j)
{
	const struct rb_located *l = s->l;
	const struct rb_arc *arc = &l->arc[j];

	if (!s->plain || (l->piece && l->piece[j].piece.n > 0) ||
	    arc->acceleration.x != s->acceleration.x || arc->acceleration.y != s->acceleration.y ||
	    arc->acceleration.z != s->acceleration.z)
		return false;
	const double age = s->now - arc->anchor_s;
	const rb_vec3 v = rb_vec3_add_scaled(arc->velocity, age, arc->acceleration);
	const rb_vec3 x = rb_vec3_add_scaled(
		arc->position, age,
		rb_vec3_add_scaled(arc->velocity, 0.5 * age, arc->acceleration));
	const rb_vec3 d = rb_vec3_sub(x, s->position), w = rb_vec3_sub(v, s->velocity);
	const double radius = l->model->shape[j].radius, sum = s->radius + radius;
	const double b = rb_vec3_dot(d, w), c = rb_vec3_dot(d, d) - sum * sum;

	if (c < 1e-3 * sum * sum || b < 0) {
		const double reach = larger(larger(s->reach, radius), largest(x));
		const double band = DBL_EPSILON * (8 * reach + 2 * s->now * fabs(b) / sum);

		if (c <= 2 * sum * band) {
			const double noise = 8 * DBL_EPSILON * (s->speed + largest(v));

			if (j != s->except && !rb_set_held(l, s->i, j))
				s->touching++;
			if (-b > noise * sum && !rb_set_held(l, s->i, j))
				see(s, j, s->now, false);
			return true;
		}
	}
	if (!(b < 0))
		return true;
	const double square = rb_vec3_dot(w, w);
	double discriminant = b * b - square * c;
	if (discriminant < 1e-4 * b * b) {
		/* grazing: without the cancellation */
		const double speed = sqrt(square);
		const double offset = rb_vec3_length(rb_vec3_cross(d, w));

		discriminant = (speed * sum - offset) * (speed * sum + offset);
		if (discriminant < 0)
			return true;
	}
	see(s, j, s->now + c / (sqrt(discriminant) - b), false);
	return true;
}

/* A plane at rest, seen from a sphere in flight that is not near it. False: not such a pair, or near. */
static bool see_plane(struct seer *s, int j)
{
	const struct rb_located *l = s->l;
	const rb_vec3 n = l->plane_normal[j - l->n];
	const double gap = rb_vec3_dot(rb_vec3_sub(s->position, l->model->position[j]), n) -
	                   s->radius;
	const double rate = rb_vec3_dot(s->velocity, n);
	const double pull = rb_vec3_dot(s->acceleration, n);

	if (!s->plain || !(gap > DBL_EPSILON * (16 * s->reach + 4 * s->now * fabs(rate))))
		return false;
	const double discriminant = rate * rate - 2 * pull * gap;
	if (discriminant < 0 || (rate >= 0 && pull >= 0))
		return true;
	const double t = s->now + (rate < 0 ? 2 * gap / (sqrt(discriminant) - rate)
	                                    : (rate + sqrt(discriminant)) / -pull);
	if (t <= s->until)
		see(s, j, t, false);
	return true;
}

static void see_body(struct seer *s, int j)
{
	const struct rb_located *l = s->l;
	bool again = false;

	if (!s->general && j < l->n ? see_sphere(s, j)
	                            : j >= l->n && l->model->shape[j].kind == RB_SHAPE_PLANE &&
	                                      !s->general && see_plane(s, j))
		return;
	if (!rb_meet_can(l, s->i, j) || rb_set_held(l, s->i, j))
		return;
	if (s->except != j) {
		const struct rb_meet m = rb_meet_at(l, s->i, j, s->now);

		s->touching += m.gap <= rb_meet_band(l, &m, s->now);
	}
	double until = fmin(s->until, s->next.touch_s);
	if (rb_located_on_piece(l, j))
		until = fmin(until, l->piece[j].until_s);
	const double t = rb_meet_time(l, s->i, j, s->now, until, &again);
	see(s, j, t, again);
}

static void open(struct seer *s, struct rb_located *l, int i, double now, int except)
{
	*s = (struct seer){.l = l,
	                   .i = i,
	                   .except = except,
	                   .now = now,
	                   .until = l->end_s,
	                   .radius = l->model->shape[i].radius,
	                   .position = rb_arc_position(l, i, now),
	                   .velocity = rb_arc_velocity(l, i, now),
	                   .acceleration = rb_arc_acceleration(l, i, now),
	                   .next = {.touch_s = HUGE_VAL, .partner = -1, .wall_s = HUGE_VAL}};
	s->plain = l->model->shape[i].kind == RB_SHAPE_SPHERE && !rb_located_on_piece(l, i) &&
	           !l->model->center_of_mass;
	s->general = l->model->group_bit || l->model->driven;
	s->reach = larger(s->radius, largest(s->position));
	s->speed = largest(s->velocity);
	if (rb_located_on_piece(l, i))
		s->until = fmin(s->until, l->piece[i].until_s);
}

static void next_wall(struct seer *s)
{
	struct rb_located *l = s->l;

	if (!l->cells)
		return;
	s->next.wall_s = s->now + rb_cells_leaves(l->cells, s->i, s->position, s->velocity,
	                                          s->acceleration, &s->next.wall);
}

static void keep(struct seer *s)
{
	struct rb_located *l = s->l;

	if (s->next.partner >= 0 && s->next.partner < l->n)
		s->next.generation = l->generation[s->next.partner];
	if (rb_located_driven(l, s->i))
		s->next.wall_s = l->piece[s->i].until_s;
	l->next[s->i] = s->next;
	rb_queue_set(l->queue, s->i, fmin(s->next.touch_s, s->next.wall_s));
}

int rb_foresee(struct rb_located *l, int i, double now, int except)
{
	struct seer s;

	open(&s, l, i, now, except);
	next_wall(&s);
	if (l->model->features & RB_FEATURE_CONTACT) {
		const int near = rb_set_near(l, i);

		for (int k = 0; k < near; k++)
			see_body(&s, l->near[k]);
		for (int j = l->n; j < l->n + l->model->static_count; j++)
			see_body(&s, j);
	}
	keep(&s);
	return s.touching;
}

void rb_foresee_wall(struct rb_located *l, int i, double now)
{
	struct seer s;

	open(&s, l, i, now, -1);
	s.next = l->next[i];
	const int count = rb_cells_cross(l->cells, i, s.next.wall, l->near);
	for (int k = 0; k < count; k++) {
		const int partner = s.next.partner;

		see_body(&s, l->near[k]);
		if (s.next.partner != partner && s.next.partner < l->n)
			s.next.generation = l->generation[s.next.partner];
	}
	next_wall(&s);
	/* the partner's generation is of the moment when it was foreseen */
	l->next[i] = s.next;
	rb_queue_set(l->queue, i, fmin(s.next.touch_s, s.next.wall_s));
}
