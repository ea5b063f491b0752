/* SPDX-License-Identifier: MIT */
/*
 * Interpolation must not invent physics: between two frames bodies fall freely except for what the
 * events of the interval say. So the known jumps are subtracted first, a cubic is laid through what
 * is left (rb_frame has positions and velocities at both ends: four conditions), and the jumps are
 * added again. For constant gravity this reproduces the exact parabola arcs between bounces; any
 * other force leaves an error of fourth order in the frame interval.
 *
 * Events are found by body through singly linked lists of indices in two arrays that are kept from
 * call to call; a film asks for thousands of moments. Rotations cannot be interpolated by a
 * polynomial: the angular momentum, which changes evenly, is integrated instead, and what that
 * misses at the end is distributed over the interval.
 */
#include "flow/between.h"

#include <float.h>
#include <stdbool.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "flow/frame.h"
#include "math/mat3.h"
#include "math/quat.h"
#include "math/vec3.h"
#include "method/method.h"

/*
 * Makes `*to` a copy of `from`, count * width doubles: absent there, absent here. Storage is kept
 * if the count is the same. False: no memory.
 */
static bool copy_column(double **to, const double *from, int old_count, int count, int width)
{
	RB_ASSERT(count >= 0 && width > 0);
	if (!from || (*to && old_count != count)) {
		rb_memory_free(*to);
		*to = NULL;
	}
	if (!from)
		return true;
	if (!*to)
		*to = rb_memory_take((size_t)count, (size_t)width * sizeof **to);
	if (!*to)
		return false;
	memcpy(*to, from, (size_t)count * (size_t)width * sizeof **to);
	return true;
}

/*
 * Copies `count` items to the list whose pointer is at `list_address` (of any type of pointer,
 * therefore memcpy). Storage is kept for the next time, however short this list is. False: no
 * memory.
 */
static bool copy_list(void *list_address, int *capacity, const void *from, int count, size_t size)
{
	void *list;
	size_t room = (size_t)*capacity;

	RB_ASSERT(count >= 0 && *capacity >= 0);
	memcpy(&list, list_address, sizeof list);
	if (count == 0)
		return true;
	if (!rb_memory_reserve(&list, &room, (size_t)count, size))
		return false;
	*capacity = (int)room;
	memcpy(list_address, &list, sizeof list);
	memcpy(list, from, (size_t)count * size);
	return true;
}

enum rb_status rb_frame_copy(struct rb_frame *to, const struct rb_frame *from, struct rb_error *err)
{
	const int had = to->body_count, count = from->body_count;
	bool held = true;

	held &= copy_column(&to->position, from->position, had, count, 3);
	held &= copy_column(&to->orientation, from->orientation, had, count, 4);
	held &= copy_column(&to->velocity, from->velocity, had, count, 3);
	held &= copy_column(&to->angular_velocity, from->angular_velocity, had, count, 3);
	held &= copy_column(&to->acceleration, from->acceleration, had, count, 3);
	held &= copy_column(&to->force, from->force, had, count, 3);
	const int had_joints = to->joint_count, joints = from->joint_count;

	held &= copy_column(&to->joint_value, from->joint_value, had_joints, joints, 1);
	held &= copy_column(&to->joint_speed, from->joint_speed, had_joints, joints, 1);
	held &= copy_column(&to->joint_force, from->joint_force, had_joints, joints, 3);
	held &= copy_column(&to->joint_torque, from->joint_torque, had_joints, joints, 3);
	to->joint_count = joints;
	held &= copy_column(&to->probes, from->probes, to->probe_count, from->probe_count, 1);
	to->probe_count = from->probe_count;
	held &= copy_list(&to->events, &to->event_capacity, from->events, from->event_count,
	                  sizeof *to->events);
	held &= copy_list(&to->contacts, &to->contact_capacity, from->contacts, from->contact_count,
	                  sizeof *to->contacts);
	held &= copy_list(&to->shots, &to->shot_capacity, from->shots, from->shot_count,
	                  sizeof *to->shots);
	if (!held) {
		rb_frame_release(to);
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot copy a frame of %d bodies: out of memory", count);
	}
	to->index = from->index;
	to->time_s = from->time_s;
	to->body_count = count;
	to->numbers = from->numbers;
	to->event_count = from->event_count;
	to->contact_count = from->contact_count;
	to->shot_count = from->shot_count;
	to->has_events = from->has_events;
	return RB_OK;
}

/* Linear interpolation, exact at part 0. */
static double mix(double a, double b, double part)
{
	return a + part * (b - a);
}

static rb_vec3 mix_vec3(rb_vec3 a, rb_vec3 b, double part)
{
	return (rb_vec3){mix(a.x, b.x, part), mix(a.y, b.y, part), mix(a.z, b.z, part)};
}

static void mix_column(double *out, const double *a, int count, double part)
{
	for (int i = 0; i < count; i++)
		out[i] = mix(a[i], out[i], part);
}

/* What joints carry jumps at impacts, which the mean of both sides hides no better than either. */
static void mix_joints(struct rb_frame *out, const struct rb_frame *a, double part)
{
	const int count = out->joint_count;

	if (!out->joint_value || !a->joint_value)
		return;
	mix_column(out->joint_value, a->joint_value, count, part);
	mix_column(out->joint_speed, a->joint_speed, count, part);
	mix_column(out->joint_force, a->joint_force, 3 * count, part);
	mix_column(out->joint_torque, a->joint_torque, 3 * count, part);
}

/* ---- impacts of the interval ---- */

/* No more links than this for each event: its two bodies. */
enum { SIDES = 2 };

/* One interval and the moment in it that is asked for; times since its beginning, s. */
struct interval {
	const struct rb_model *model;
	const struct rb_frame *a, *b;
	struct rb_between *links;
	double length_s, t;
	double step_count; /* 0: it was not stepped */
	double early_s;    /* of the body that is looked at: early_of */
};

/*
 * Makes a list, in order of time, of the events that change each body that moves freely. Links are
 * numbered 1 + 2 event + side, 0 ends a list. False: no memory.
 */
static bool link_events(struct rb_between *between, const struct rb_model *model,
                        const struct rb_frame *b)
{
	const size_t bodies = (size_t)model->body_count;
	const size_t links = SIDES * (size_t)b->event_count;

	if (!b->has_events || b->event_count == 0)
		return true;
	void *first = between->first, *next = between->next;
	const bool held = rb_memory_reserve(&first, &between->first_capacity, bodies,
	                                    sizeof *between->first) &&
	                  rb_memory_reserve(&next, &between->next_capacity, links,
	                                    sizeof *between->next);
	between->first = first;
	between->next = next;
	if (!held)
		return false;
	memset(between->first, 0, bodies * sizeof *between->first);
	/* from the last to the first, so that the lists begin with the earliest */
	for (size_t link = links; link-- > 0;) {
		const struct rb_event *const event = &b->events[link / SIDES];
		const int i = model->index_of[link % SIDES ? event->b : event->a];
		const bool is_change = event->kind >= RB_EVENT_IMPULSE &&
		                       event->kind <= RB_EVENT_DISPLACEMENT; /* of one body */
		if ((event->kind != RB_EVENT_COLLISION && !is_change) ||
		    (is_change && link % SIDES) || i >= model->body_count ||
		    !(model->inverse_mass[i] > 0))
			continue;
		between->next[link] = between->first[i];
		between->first[i] = 1 + (int)link;
	}
	return true;
}

/* Whether link_events has made lists for this interval; between->first is stale otherwise. */
static bool has_links(const struct interval *in)
{
	return in->b->has_events && in->b->event_count > 0;
}

static int first_link(const struct interval *in, int i)
{
	return has_links(in) ? in->links->first[i] : 0;
}

static int next_link(const struct interval *in, int link)
{
	RB_ASSERT_COSTLY(link > 0);
	return in->links->next[link - 1];
}

/*
 * What an event has made of its body's centre of mass, at once: change of velocity, m/s, and of
 * position, m; when_s since the interval's beginning.
 */
struct jump {
	const struct rb_event *event;
	double when_s;
	rb_vec3 velocity, position;
};

/*
 * The jump of body i at this link. The impulse of a collision is the one on body b: a gets its
 * negative. Events are put into the interval where rounding has them outside.
 */
static struct jump jump_of(const struct interval *in, int i, int link)
{
	const struct rb_event *const event = &in->b->events[(link - 1) / SIDES];
	const rb_vec3 none = {0, 0, 0};
	const bool pushes = event->kind == RB_EVENT_COLLISION || event->kind == RB_EVENT_IMPULSE;
	const bool is_impact = event->kind == RB_EVENT_COLLISION;
	const double sign = is_impact && !((link - 1) % SIDES) ? -1 : 1;
	const double when_s = event->time_s - in->a->time_s - (is_impact ? in->early_s : 0);

	RB_ASSERT_COSTLY(link > 0 && (link - 1) / SIDES < in->b->event_count);
	return (struct jump){.event = event,
	                     .when_s = fmin(fmax(when_s, 0), in->length_s),
	                     .velocity = pushes ? rb_vec3_scale(sign * in->model->inverse_mass[i],
	                                                        event->impulse)
	                                        : none,
	                     .position = event->kind == RB_EVENT_DISPLACEMENT ? event->impulse
	                                                                      : none};
}

/* m/s: what impacts have added to a velocity, and what callbacks have. */
static void sum_jumps(const struct interval *in, int i, rb_vec3 *impacts, rb_vec3 *changes)
{
	*impacts = *changes = (rb_vec3){0, 0, 0};
	for (int link = first_link(in, i); link; link = next_link(in, link)) {
		const struct jump jump = jump_of(in, i, link);
		rb_vec3 *const sum = jump.event->kind == RB_EVENT_COLLISION ? impacts : changes;

		*sum = rb_vec3_add(*sum, jump.velocity);
	}
}

/* Unlinks the collisions of a body, and leaves what callbacks have changed. */
static void drop_impacts(const struct interval *in, int i)
{
	int *last = &in->links->first[i];

	for (int link = *last; link; link = *last)
		if (jump_of(in, i, link).event->kind == RB_EVENT_COLLISION)
			*last = in->links->next[link - 1];
		else
			last = &in->links->next[link - 1];
}

/*
 * Drops the collisions of a stepped body where they explain its change of velocity worse than none.
 * A step resolves an impact on a pile together with what the pile presses back, and only the impact
 * is an event; so the impacts count where the velocities of both frames are nearer to a fall with
 * them than to one without.
 */
static void choose_impacts(const struct interval *in, int i)
{
	const struct rb_world_def *world = &in->model->scene->world;
	const rb_vec3 weight = rb_vec3_add_scaled(world->gravity, in->model->inverse_mass[i],
	                                          world->gravity_force);
	rb_vec3 impacts, changes;

	if (!first_link(in, i))
		return;
	sum_jumps(in, i, &impacts, &changes);
	const rb_vec3 more = rb_vec3_sub(rb_vec3_from(in->b->velocity + 3 * i),
	                                 rb_vec3_from(in->a->velocity + 3 * i));
	const rb_vec3 without = rb_vec3_sub(rb_vec3_add_scaled(more, -in->length_s, weight),
	                                    changes);
	const rb_vec3 with = rb_vec3_sub(without, impacts);

	if (rb_vec3_dot(with, with) > rb_vec3_dot(without, without))
		drop_impacts(in, i);
}

/* ---- where it is ---- */

/* Motion of a centre of mass without what impacts have made of it: x + v t + a t^2 + c t^3. */
struct smooth {
	rb_vec3 x, v, a, c;
};

static rb_vec3 smooth_at(const struct smooth *m, double t)
{
	return rb_vec3_add_scaled(m->x, t,
	                          rb_vec3_add_scaled(m->v, t, rb_vec3_add_scaled(m->a, t, m->c)));
}

static rb_vec3 smooth_velocity(const struct smooth *m, double t)
{
	return rb_vec3_add_scaled(m->v, t, rb_vec3_add_scaled(rb_vec3_scale(2, m->a), 3 * t, m->c));
}

/*
 * The cubic of body i with the jumps taken out: `from` and `to` are its centres of mass in both
 * frames. Hermite's form; exact where the acceleration is constant, however many impacts there are.
 */
static struct smooth smooth_of(const struct interval *in, int i, rb_vec3 from, rb_vec3 to)
{
	const double h = in->length_s;
	const rb_vec3 v0 = rb_vec3_from(in->a->velocity + 3 * i);
	rb_vec3 v1 = rb_vec3_from(in->b->velocity + 3 * i);

	RB_ASSERT_COSTLY(in->length_s > 0);
	for (int link = first_link(in, i); link; link = next_link(in, link)) {
		const struct jump jump = jump_of(in, i, link);
		v1 = rb_vec3_sub(v1, jump.velocity);
		to = rb_vec3_sub(rb_vec3_add_scaled(to, jump.when_s - h, jump.velocity),
		                 jump.position);
	}
	const rb_vec3 mean = rb_vec3_scale(1 / h, rb_vec3_sub(to, from));
	const rb_vec3 sum = rb_vec3_add(v0, v1);
	return (struct smooth){
		.x = from,
		.v = v0,
		.a = rb_vec3_scale(1 / h,
	                           rb_vec3_sub(rb_vec3_scale(3, mean), rb_vec3_add(sum, v0))),
		.c = rb_vec3_scale(1 / (h * h), rb_vec3_add_scaled(sum, -2, mean)),
	};
}

/* Whether an event's time is the end of a step, within the rounding of the later frame's time. */
static bool ends_step(const struct interval *in, const struct rb_event *event)
{
	const double step_s = in->length_s / in->step_count;
	const double steps = (event->time_s - in->a->time_s) / step_s;

	RB_ASSERT_COSTLY(in->step_count > 0);
	return fabs(steps - nearbyint(steps)) * step_s <= 8 * DBL_EPSILON * in->b->time_s;
}

/*
 * s by which the impacts of a step are taken to act before the end of the step, at which they are
 * recorded: groups that are too large are resolved as a whole. What stops a body has then acted
 * from the step's beginning on, what throws it back at its end; one jump of both is where the step
 * has the body if it acts earlier, by what leaves the least of the motion that a constant
 * acceleration does not explain. Never before the step. Impacts at their own moments, and changes
 * by callbacks, are where they are recorded: 0.
 */
static double early_of(const struct interval *in, int i, const struct smooth *smooth)
{
	rb_vec3 sum = {0, 0, 0};

	for (int link = first_link(in, i); link; link = next_link(in, link)) {
		const struct jump jump = jump_of(in, i, link);

		if (jump.event->kind != RB_EVENT_COLLISION || !ends_step(in, jump.event))
			return 0;
		sum = rb_vec3_add(sum, jump.velocity);
	}
	const double square = rb_vec3_dot(sum, sum), h = in->length_s;
	if (!(square > 0))
		return 0;
	/* m: to where the cubic ends from the parabola with the velocities of both ends */
	const rb_vec3 rest = rb_vec3_scale(-0.5 * h * h * h, smooth->c);
	return fmin(fmax(rb_vec3_dot(rest, sum) / square, 0), h / in->step_count);
}

/*
 * Centre of mass of body i at `t` and, in `*velocity`, its velocity, with the events up to then; of
 * those at `t` itself only the ones before the link `until` (0: all).
 */
static rb_vec3 center_at(const struct interval *in, int i, const struct smooth *smooth, double t,
                         int until, rb_vec3 *velocity)
{
	rb_vec3 at = smooth_at(smooth, t);

	RB_ASSERT_COSTLY(t >= 0);
	*velocity = smooth_velocity(smooth, t);
	for (int link = first_link(in, i); link != until; link = next_link(in, link)) {
		const struct jump jump = jump_of(in, i, link);
		if (jump.when_s > t)
			break;
		*velocity = rb_vec3_add(*velocity, jump.velocity);
		at = rb_vec3_add(rb_vec3_add_scaled(at, t - jump.when_s, jump.velocity),
		                 jump.position);
	}
	return at;
}

/* ---- how it is turned ---- */

/* The shortest turn that a unit quaternion stands for, as a rotation vector, rad. */
static rb_vec3 turn_of(rb_quat q)
{
	if (q.w < 0)
		q = (rb_quat){-q.w, -q.x, -q.y, -q.z};
	const rb_vec3 axis = {q.x, q.y, q.z};
	const double sine = rb_vec3_length(axis);

	/* angle / sin(angle / 2) goes to 2 */
	return rb_vec3_scale(sine > 0 ? 2 * atan2(sine, q.w) / sine : 2, axis);
}

/*
 * A body that turns as its angular momentum says: that jumps by impacts and changes at an even rate
 * in between.
 */
struct turning {
	const rb_mat3 *inertia, *inverse;
	rb_quat q;
	rb_vec3 momentum, rate; /* kg m^2/s, of both frames but for impacts; N m */
};

/*
 * kg m^2/s in world axes, from an angular velocity in world axes; with the inverse of the inertia,
 * the other way.
 */
static rb_vec3 momentum_of(const rb_mat3 *inertia, rb_quat q, rb_vec3 spin)
{
	return rb_quat_rotate(q, rb_mat3_apply(inertia, rb_quat_rotate_back(q, spin)));
}

static rb_vec3 spin_of(const struct turning *turning)
{
	return momentum_of(turning->inverse, turning->q, turning->momentum);
}

/* `q` after `s` seconds at this angular velocity. */
static rb_quat turned_by(rb_quat q, double s, rb_vec3 spin)
{
	return rb_quat_multiply(rb_quat_from_turn(rb_vec3_scale(s, spin)), q);
}

/*
 * Goes on by `s` seconds in steps of the midpoint rule, each about a fixed axis: right at any
 * length about a principal axis, else of third order in a small angle. A step turns by 1/16 rad,
 * where the error is below what a picture shows; rotations beyond STEPS_MAX steps in a frame are
 * only blur. What the next frame knows better is corrected there.
 */
static void turn_on(struct turning *turning, double s)
{
	enum { STEPS_MAX = 4096 };
	const double angle = 1.0 / 16;
	const double steps = ceil(rb_vec3_length(spin_of(turning)) * s / angle);
	const int count = steps < STEPS_MAX ? (int)fmax(steps, 1) : STEPS_MAX;
	const double step = s / count;

	RB_ASSERT_COSTLY(s >= 0);
	for (int k = 0; k < count; k++) {
		struct turning half = *turning;
		half.q = turned_by(turning->q, step / 2, spin_of(turning));
		half.momentum = rb_vec3_add_scaled(turning->momentum, step / 2, turning->rate);
		turning->q = turned_by(turning->q, step, spin_of(&half));
		turning->momentum = rb_vec3_add_scaled(turning->momentum, step, turning->rate);
	}
	turning->q = rb_quat_unit(turning->q);
}

/*
 * Change of angular momentum, kg m^2/s, by the event of a link, about where the centre of mass is
 * then; `*when_s`: its time.
 */
static rb_vec3 twist_of(const struct interval *in, int i, const struct smooth *smooth, int link,
                        double *when_s)
{
	const struct jump jump = jump_of(in, i, link);
	const struct rb_event *const event = jump.event;
	rb_vec3 velocity;

	*when_s = jump.when_s;
	if (event->kind == RB_EVENT_ANGULAR_IMPULSE)
		return event->impulse;
	if (event->kind != RB_EVENT_COLLISION)
		return (rb_vec3){0, 0, 0};
	const rb_vec3 center = center_at(in, i, smooth, *when_s, link, &velocity);
	const rb_vec3 impulse = rb_vec3_scale((link - 1) % SIDES ? 1 : -1, event->impulse);
	return rb_vec3_cross(rb_vec3_sub(event->point, center), impulse);
}

/*
 * Turns from the earlier frame to `t`: orientation and angular momentum. `smooth` NULL: no events.
 */
static void follow(const struct interval *in, int i, const struct smooth *smooth, double t,
                   struct turning *turning)
{
	double at_s = 0, when_s;

	for (int link = first_link(in, i); link && smooth; link = next_link(in, link)) {
		const rb_vec3 twist = twist_of(in, i, smooth, link, &when_s);
		if (when_s > t)
			break;
		turn_on(turning, when_s - at_s);
		turning->momentum = rb_vec3_add(turning->momentum, twist);
		at_s = when_s;
	}
	turn_on(turning, t - at_s);
}

/*
 * Orientation of body i at in->t, and its angular velocity: what the angular velocities say of the
 * interval, whole turns included; the rotation that is then missing to the later frame takes the
 * shortest way and is distributed evenly. Without angular velocities or moments of inertia this is
 * the great circle.
 */
static rb_quat orientation_at(const struct interval *in, int i, const struct smooth *smooth,
                              rb_vec3 *spin)
{
	const rb_quat from = rb_quat_from(in->a->orientation + 4 * i);
	const rb_quat to = rb_quat_from(in->b->orientation + 4 * i);
	const double part = in->t / in->length_s;
	/* of what is driven nobody knows how it turns but by its spins */
	static const rb_mat3 unit = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
	const bool free = in->model->inverse_mass[i] > 0;
	struct turning now = {.inertia = free ? rb_model_inertia(in->model, i) : &unit,
	                      .inverse = free ? rb_model_inverse_inertia(in->model, i) : &unit,
	                      .q = from};

	if (in->a->angular_velocity && in->b->angular_velocity) {
		const rb_vec3 before = rb_vec3_from(in->a->angular_velocity + 3 * i);
		const rb_vec3 after = rb_vec3_from(in->b->angular_velocity + 3 * i);
		double when_s;
		now.momentum = momentum_of(now.inertia, from, before);
		rb_vec3 rest = rb_vec3_sub(momentum_of(now.inertia, to, after), now.momentum);
		for (int link = first_link(in, i); link && smooth; link = next_link(in, link))
			rest = rb_vec3_sub(rest, twist_of(in, i, smooth, link, &when_s));
		now.rate = rb_vec3_scale(1 / in->length_s, rest);
	}
	struct turning end = now;
	follow(in, i, smooth, in->t, &now);
	follow(in, i, smooth, in->length_s, &end);
	*spin = spin_of(&now);
	const rb_quat back = {end.q.w, -end.q.x, -end.q.y, -end.q.z};
	const rb_vec3 rest = turn_of(rb_quat_multiply(to, back));
	return rb_quat_unit(turned_by(now.q, part, rest));
}

/* ---- a frame ---- */

/* From the object's origin to its centre of mass, m, world axes. */
static rb_vec3 center_arm(const struct rb_model *model, int i, rb_quat q)
{
	return model->center_of_mass ? rb_quat_rotate(q, model->center_of_mass[i])
	                             : (rb_vec3){0, 0, 0};
}

/*
 * Sets the columns of body i in `out` for in->t. Positions are those of origins, while motion is
 * that of centres of mass, so they are converted there and back.
 */
static void move_body(struct interval *in, int i, struct rb_frame *out)
{
	const struct rb_frame *const a = in->a, *const b = in->b;
	const bool arcs = b->has_events && out->position && a->position && out->velocity &&
	                  a->velocity;
	const bool turns = out->orientation && a->orientation;
	struct smooth smooth;

	RB_ASSERT(i >= 0 && i < out->body_count);
	in->early_s = 0;
	if (arcs && in->step_count > 0)
		choose_impacts(in, i);
	if (arcs) {
		rb_vec3 from = rb_vec3_from(a->position + 3 * i);
		rb_vec3 to = rb_vec3_from(b->position + 3 * i), velocity;
		if (turns) {
			from = rb_vec3_add(from, center_arm(in->model, i,
			                                    rb_quat_from(a->orientation + 4 * i)));
			to = rb_vec3_add(
				to, center_arm(in->model, i, rb_quat_from(b->orientation + 4 * i)));
		}
		smooth = smooth_of(in, i, from, to);
		if (in->step_count > 0 && first_link(in, i)) {
			in->early_s = early_of(in, i, &smooth);
			smooth = smooth_of(in, i, from, to);
		}
		rb_vec3_to(out->position + 3 * i, center_at(in, i, &smooth, in->t, 0, &velocity));
		rb_vec3_to(out->velocity + 3 * i, velocity);
	}
	if (!turns)
		return;
	rb_vec3 spin;
	const rb_quat q = orientation_at(in, i, arcs ? &smooth : NULL, &spin);
	rb_quat_to(out->orientation + 4 * i, q);
	if (out->angular_velocity && a->angular_velocity)
		rb_vec3_to(out->angular_velocity + 3 * i, spin);
	if (arcs)
		rb_vec3_to(out->position + 3 * i, rb_vec3_sub(rb_vec3_from(out->position + 3 * i),
		                                              center_arm(in->model, i, q)));
}

/* Interpolates what is continuous; counts stay those of the later frame. */
static void mix_numbers(struct rb_frame_numbers *numbers, const struct rb_frame_numbers *before,
                        double part)
{
	numbers->kinetic_energy = mix(before->kinetic_energy, numbers->kinetic_energy, part);
	numbers->potential_energy = mix(before->potential_energy, numbers->potential_energy, part);
	numbers->momentum = mix_vec3(before->momentum, numbers->momentum, part);
	numbers->angular_momentum = mix_vec3(before->angular_momentum, numbers->angular_momentum,
	                                     part);
}

enum rb_status rb_frame_between(struct rb_between *between, const struct rb_model *model,
                                const struct rb_frame *a, const struct rb_frame *b, double time_s,
                                struct rb_error *err)
{
	struct rb_frame *const out = &between->frame;

	RB_ASSERT(a->body_count == b->body_count);
	RB_ASSERT(a->time_s <= time_s && time_s <= b->time_s);
	/*
	 * Columns of a run are the same in all its frames; b's lists and counts are already right.
	 */
	const enum rb_status status = rb_frame_copy(out, time_s == a->time_s ? a : b, err);
	if (status || time_s == a->time_s || time_s == b->time_s)
		return status;
	if (!link_events(between, model, b))
		return RB_FAIL(err, RB_ERR_MEMORY,
		               "cannot look between two frames of %d bodies: out of memory",
		               b->body_count);

	struct interval in = {.model = model,
	                      .a = a,
	                      .b = b,
	                      .links = between,
	                      .length_s = b->time_s - a->time_s,
	                      .t = time_s - a->time_s};
	RB_ASSERT(in.length_s > 0);
	const double part = in.t / in.length_s;
	if (b->numbers.stepped > 0)
		in.step_count = (double)rb_frame_step_count(model, a->time_s, b->time_s);
	out->time_s = time_s;
	/* what is not known better goes straight */
	if (out->position && a->position)
		mix_column(out->position, a->position, 3 * out->body_count, part);
	if (out->velocity && a->velocity)
		mix_column(out->velocity, a->velocity, 3 * out->body_count, part);
	mix_joints(out, a, part);
	for (int i = 0; i < out->body_count; i++)
		move_body(&in, i, out);
	mix_numbers(&out->numbers, &a->numbers, part);
	return RB_OK;
}

void rb_between_release(struct rb_between *between)
{
	rb_frame_release(&between->frame);
	rb_memory_free(between->first);
	rb_memory_free(between->next);
	*between = (struct rb_between){0};
}
