/* SPDX-License-Identifier: MIT */
#include "classic/contact.h"

#include "step/gap.h"
#include "classic/groups.h"
#include "constraint/impulse.h"

/* Few rows may iterate longer, for high ratios of mass. */
enum { SWEEPS = 400, ROW_SWEEPS = 16000 };

double rb_contact_tolerance(const struct rb_pass *pass)
{
	return 1e-3 * pass->world->model->tolerance_m / pass->dt_s;
}

void rb_contact_begin(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;

	for (int k = 0; k < pass->touch_count; k++) {
		struct rb_touch *touch = &pass->touch[k];
		const struct rb_contact *before = world->contacts.count > 0
		                                          ? rb_contacts_find(&world->contacts,
		                                                             touch->a, touch->b)
		                                          : NULL;

		touch->lasting = before != NULL;
		touch->force_normal = before ? before->normal : (rb_vec3){0, 0, 0};
		touch->normal_force = before ? before->normal_force : 0;
		touch->tangent_force = before ? before->tangent_force : (rb_vec3){0, 0, 0};
	}
}

/*
 * How far the gap opens within the substep at normal velocities `before` and `after` the forces, m.
 */
static double opening(double before, double after, double h)
{
	if (before <= 0)
		return 0;
	/* thrown up and drawn back: v^2 / (2 a) with a = (before - after) / h */
	return after < 0 ? 0.5 * before * before * h / (before - after)
	                 : 0.5 * (before + after) * h;
}

/* Speed to get out of the second half of the tolerance, m/s. */
static double given_back(const struct rb_pass *pass, double gap)
{
	const double tolerance = pass->world->model->tolerance_m;

	/*
	 * arcs can deepen a contact within a step; of straight motion rb_contact_resolve takes care
	 */
	if (!pass->world->model->center_of_mass)
		return 0;
	/*
	 * more than the tolerance there is only where no rollback keeps it: that must not become
	 * speed
	 */
	return fmin(fmax(0, -gap - 0.5 * tolerance), tolerance) / pass->dt_s;
}

double rb_contact_forced(const struct rb_pass *pass, const struct rb_link *link)
{
	const struct rb_world *world = pass->world;
	const int body[2] = {link->a, link->b};
	double sum = 0;

	for (int k = 0; k < 2; k++)
		if (body[k] < world->model->body_count)
			sum += fabs(rb_vec3_dot(
				rb_vec3_sub(rb_world_row3(world->state.velocity, body[k]),
			                    rb_world_row3(world->mark.velocity, body[k])),
				link->normal));
	return sum * pass->dt_s / pass->h_s;
}

bool rb_contact_crowded(const struct rb_pass *pass, const struct rb_touch *touch)
{
	const struct rb_world *world = pass->world;
	const unsigned char *held = world->groups->held;

	return touch->lasting || held[touch->a] ||
	       (touch->b < world->model->body_count && held[touch->b]);
}

static bool is_lasting(const struct rb_pass *pass, const struct rb_touch *touch,
                       const struct rb_gap *gap, const struct rb_link *link)
{
	const struct rb_world *world = pass->world;
	const double before = rb_vec3_dot(rb_link_velocity(world, &world->mark, link),
	                                  link->normal);
	const double after = rb_vec3_dot(rb_link_velocity(world, &world->state, link),
	                                 link->normal);

	if (gap->gap <= touch->band) {
		/* what leave_speed gives back of an overlap is no opening */
		const double given = given_back(pass, gap->gap);
		if (opening(before - given, after - given, pass->h_s) <= touch->band &&
		    (touch->lasting || before >= -rb_link_noise(world, link)))
			return true;
	}
	/*
	 * soft landing: the forces bring them together, and no faster than they can within a step
	 */
	if (!rb_contact_crowded(pass, touch))
		return false;
	const double forced = rb_contact_forced(pass, link);
	double max = forced;
	if (touch->lasting) {
		/* the centres move straight while the surfaces bend away: s^2 / (2 r) a step */
		const rb_vec3 slide = rb_vec3_sub(
			rb_world_row3(world->mark.velocity, link->a),
			link->b < world->model->body_count
				? rb_world_row3(world->mark.velocity, link->b)
				: (rb_vec3){0, 0, 0});

		max += rb_vec3_dot(slide, slide) * pass->dt_s /
		       rb_gap_radius(world->model, touch->a, touch->b);
	}
	return -before <= max &&
	       gap->gap < pass->h_s * (fmax(0, -before) + forced * pass->h_s / pass->dt_s);
}

/*
 * How far the centre of a shape off its centre of mass leaves the straight line in this substep, m.
 */
static rb_vec3 arc(const struct rb_pass *pass, int i)
{
	const struct rb_world *world = pass->world;
	const struct rb_model *model = world->model;

	if (i >= model->body_count || !model->center_of_mass)
		return (rb_vec3){0, 0, 0};
	const rb_vec3 arm = rb_vec3_neg(rb_quat_rotate(
		rb_world_orientation_at(world, &world->state, i), model->center_of_mass[i]));
	const rb_vec3 turn = rb_vec3_scale(pass->h_s, rb_world_row3(world->state.spin, i));
	const double angle = rb_vec3_length(turn);

	/*
	 * (1 - cos) k x (k x r) + (sin - angle) k x r, without the cancellation of either bracket
	 */
	const double half_sine = sin(0.5 * angle), square = angle * angle;
	const double bend = angle > 0 ? 2 * half_sine * half_sine / square : 0;
	const double lag = angle < 1e-2 ? -1.0 / 6 + square / 120
	                                : (sin(angle) - angle) / (square * angle);
	const rb_vec3 once = rb_vec3_cross(turn, arm);

	return rb_vec3_add_scaled(rb_vec3_scale(bend, rb_vec3_cross(turn, once)), lag * square,
	                          once);
}

/*
 * The normal velocity at least wanted: a gap may close but not more, counting what the arcs of
 * eccentric bodies add to straight motion; of an overlap in the second half of the tolerance, its
 * excess is given back within a step.
 */
static double target_speed(const struct rb_pass *pass, const struct rb_link *link, double gap)
{
	const double arcs = rb_vec3_dot(rb_vec3_sub(arc(pass, link->b), arc(pass, link->a)),
	                                link->normal);

	return (-fmax(gap, 0) - arcs) / pass->h_s + given_back(pass, gap);
}

/* Bound on how much the gap can close in this substep, without the mechanics of the contact, m. */
static double closing(const struct rb_pass *pass, const struct rb_touch *touch)
{
	const struct rb_world *world = pass->world;
	double speed = 0;

	for (int k = 0; k < 2; k++) {
		const int i = k == 0 ? touch->a : touch->b;

		if (i < world->model->body_count) /* before the forces, and twice what they add */
			speed += rb_vec3_length(rb_world_row3(world->mark.velocity, i)) +
			         2 * rb_vec3_length(
					     rb_vec3_sub(rb_world_row3(world->state.velocity, i),
			                                 rb_world_row3(world->mark.velocity, i)));
	}
	return speed * pass->h_s;
}

static void reactions(struct rb_pass *pass)
{
	struct rb_world *world = pass->world;
	const rb_arena_mark here = rb_arena_here(pass->arena);
	struct rb_impulse_row *row = NULL;
	int *of = NULL;
	int count = 0;

	for (int k = 0; k < pass->touch_count; k++) {
		struct rb_touch *touch = &pass->touch[k];

		if (!touch->lasting && pass->now[k].gap > touch->band &&
		    pass->now[k].gap > closing(pass, touch))
			continue;
		const struct rb_link link = rb_link_of(world, &world->mark, touch, &pass->now[k]);
		touch->lasting = is_lasting(pass, touch, &pass->now[k], &link);
		if (!touch->lasting) {
			touch->normal_force = 0;
			touch->tangent_force = (rb_vec3){0, 0, 0};
			continue;
		}
		if (!row) {
			row = rb_pass_take(pass, pass->arena, pass->touch_count, sizeof *row);
			of = rb_pass_take(pass, pass->arena, pass->touch_count, sizeof *of);
			if (pass->out_of_memory)
				return;
		}
		/* starts from the reaction of the substep before; across the normal of now */
		const rb_vec3 along = rb_vec3_scale(rb_vec3_dot(touch->tangent_force, link.normal),
		                                    link.normal);
		row[count] = (struct rb_impulse_row){
			.link = link,
			.target_velocity = target_speed(pass, &link, pass->now[k].gap),
			.normal = pass->h_s * touch->normal_force,
			.tangent = rb_vec3_scale(pass->h_s,
		                                 rb_vec3_sub(touch->tangent_force, along)),
		};
		of[count++] = k;
	}
	for (int n = 0; n < count; n++)
		rb_link_push(world, &row[n].link,
		             rb_vec3_add_scaled(row[n].tangent, row[n].normal, row[n].link.normal));
	/* a short substep moves nothing far: what it leaves is taken up by the next long one */
	const double tolerance = rb_contact_tolerance(pass) * fmin(pass->dt_s / pass->h_s, 100);
	rb_impulse_rows_solve(world, row, count,
	                      count * SWEEPS < ROW_SWEEPS ? ROW_SWEEPS / (count > 0 ? count : 1)
	                                                  : SWEEPS,
	                      tolerance);
	for (int n = 0; n < count; n++) {
		struct rb_touch *touch = &pass->touch[of[n]];

		/*
		 * what the forces would have closed but did not need to push stays as it was: not
		 * in contact
		 */
		touch->lasting = row[n].normal > 0 || pass->now[of[n]].gap <= touch->band;
		touch->force_normal = row[n].link.normal;
		touch->normal_force = row[n].normal / pass->h_s;
		touch->tangent_force = rb_vec3_scale(1 / pass->h_s, row[n].tangent);
	}
	rb_arena_back(pass->arena, here);
}

/* Which bodies rest on others at the beginning of the substep; false: none. */
static bool mark_held(const struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;
	unsigned char *const held = world->groups->held;
	bool any = false;

	for (int k = 0; k < pass->member_count; k++)
		held[pass->member[k]] = 0;
	for (int k = 0; k < pass->touch_count; k++)
		if (pass->touch[k].lasting) {
			any = true;
			held[pass->touch[k].a] = 1;
			if (pass->touch[k].b < world->model->body_count)
				held[pass->touch[k].b] = 1;
		}
	return any;
}

/*
 * Velocity that a body will about have at the end of the substep: of one that rests on others, that
 * of before.
 */
static rb_vec3 foreseen_velocity(const struct rb_world *world, int i)
{
	if (i >= world->model->body_count)
		return (rb_vec3){0, 0, 0};
	return rb_world_row3(world->groups->held[i] ? world->mark.velocity : world->state.velocity,
	                     i);
}

/*
 * A try that is lost anyway need not be worked out: when two bodies that are not in contact would
 * overlap by far if they went on straight, at a speed that is an impact's. `worst` is then set, and
 * the plan ends there.
 */
static void look_ahead(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;
	const double far = 16 * world->model->tolerance_m;
	const bool any = mark_held(pass);

	if (world->model->rollback == RB_ROLLBACK_NONE) /* no try is lost */
		return;
	for (int k = 0; any && k < pass->touch_count; k++) {
		const struct rb_touch *touch = &pass->touch[k];

		if (touch->lasting || pass->now[k].gap <= touch->band)
			continue;
		const rb_vec3 closing = rb_vec3_sub(foreseen_velocity(world, touch->a),
		                                    foreseen_velocity(world, touch->b));
		const double speed = rb_vec3_dot(closing, pass->now[k].normal);
		double forced = world->groups->acceleration[touch->a];
		if (touch->b < world->model->body_count)
			forced += world->groups->acceleration[touch->b];
		/* straight on towards each other: the surfaces only bend away from that */
		const rb_vec3 aside = rb_vec3_add_scaled(closing, -speed, pass->now[k].normal);
		const double bend = rb_vec3_dot(aside, aside) * pass->h_s * pass->h_s /
		                    rb_gap_radius(world->model, touch->a, touch->b);
		const double gap = pass->now[k].gap - speed * pass->h_s + bend;
		if (speed > forced * pass->dt_s && gap < -far) {
			pass->worst = k;
			pass->worst_gap = gap;
			return;
		}
	}
}

/* Moves two bodies apart along the normal, the lighter one more. */
static void part(struct rb_world *world, const struct rb_touch *touch, rb_vec3 normal,
                 double distance)
{
	const struct rb_model *model = world->model;
	const double share = model->inverse_mass[touch->a] /
	                     (model->inverse_mass[touch->a] + model->inverse_mass[touch->b]);
	const int body[2] = {touch->a, touch->b};
	const double shift[2] = {-share * distance, (1 - share) * distance};

	for (int k = 0; k < 2; k++)
		if (body[k] < model->body_count)
			rb_vec3_to(world->state.position + 3 * (size_t)body[k],
			           rb_vec3_add_scaled(rb_world_row3(world->state.position, body[k]),
			                              shift[k], normal));
}

void rb_contact_resolve(struct rb_pass *pass)
{
	struct rb_world *world = pass->world;
	const double reserve = -0.5 * world->model->tolerance_m;
	bool any = false, good = true;

	for (int k = 0; k < pass->touch_count; k++)
		any = any || (pass->touch[k].lasting && pass->now[k].gap < -pass->touch[k].band);
	if (!any)
		return;
	rb_state_copy_rows(&world->mark, &world->state, pass->member, pass->member_count);
	for (int k = 0; k < pass->touch_count; k++)
		if (pass->touch[k].lasting && pass->now[k].gap < -pass->touch[k].band)
			part(world, &pass->touch[k], pass->now[k].normal, -0.5 * pass->now[k].gap);
	for (int k = 0; k < pass->touch_count && good; k++) {
		pass->next[k] = rb_gap_of(world, &world->state, pass->touch[k].a, pass->touch[k].b);
		good = pass->next[k].gap >= fmin(pass->now[k].gap, reserve);
	}
	if (!good) {
		rb_state_copy_rows(&world->state, &world->mark, pass->member, pass->member_count);
		return;
	}
	struct rb_gap *const gaps = pass->now;
	pass->now = pass->next;
	pass->next = gaps;
}

const struct rb_stage rb_stage_look_ahead = {"look_ahead",
                                             "spares the reactions of a try that is lost anyway",
                                             RB_FEATURE_CONTACT, look_ahead};
const struct rb_stage rb_stage_reactions = {"reactions", "lasting contacts, after all other forces",
                                            RB_FEATURE_CONTACT, reactions};
