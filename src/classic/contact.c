/* SPDX-License-Identifier: MIT */
/*
 * Reactions by projected Gauss-Seidel over the lasting contacts of a group (constraint/impulse),
 * warm started with the reaction of the substep before. The unilateral condition is on the gap at
 * the end of the substep, gap + h v_n >= 0, rather than on v_n >= 0, so that a contact may close
 * the gap that is left but no more. Baumgarte stabilization is not used: it turns overlap into
 * kinetic energy; overlaps within the tolerance are removed by moving positions
 * (rb_contact_resolve).
 */
#include "classic/contact.h"

#include "base/error.h"
#include "step/flow.h"
#include "step/gap.h"
#include "classic/groups.h"
#include "constraint/impulse.h"

/*
 * Sweeps over the rows; few rows may take as many more as makes ROW_SWEEPS in all, since high
 * ratios of mass converge slowly and few rows cost little.
 */
enum { SWEEPS = 400, ROW_SWEEPS = 16000 };

double rb_contact_tolerance(const struct rb_pass *pass)
{
	RB_ASSERT_COSTLY(pass->dt_s > 0);
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
 * Largest opening of the gap within the substep, m, for the normal velocities `before` and `after`
 * the forces.
 */
static double opening(double before, double after, double h)
{
	if (before <= 0)
		return 0;
	/* ballistic: v^2 / (2 a) with a = (before - after) / h */
	return after < 0 ? 0.5 * before * before * h / (before - after)
	                 : 0.5 * (before + after) * h;
}

/*
 * Normal velocity that removes the part of an overlap beyond half of the tolerance in one step,
 * m/s.
 */
static double given_back(const struct rb_pass *pass, double gap)
{
	const double tolerance = pass->world->model->tolerance_m;

	/*
	 * Only eccentric bodies: their arcs deepen contacts within a step, while overlaps of
	 * straight motion are removed by rb_contact_resolve.
	 */
	if (!pass->world->model->center_of_mass)
		return 0;
	/* without rollback an overlap may exceed the tolerance; that must not become speed */
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

/*
 * The criterion of contact.h: touching and not opening beyond the band, or, in a crowd, soft
 * landing and paths that curve away.
 */
static bool is_lasting(const struct rb_pass *pass, const struct rb_touch *touch,
                       const struct rb_gap *gap, const struct rb_link *link)
{
	const struct rb_world *world = pass->world;
	const double before = rb_vec3_dot(rb_link_velocity(world, &world->mark, link),
	                                  link->normal);
	const double after = rb_vec3_dot(rb_link_velocity(world, &world->state, link),
	                                 link->normal);

	if (gap->gap <= touch->band) {
		/* the speed given back for an overlap is no opening */
		const double given = given_back(pass, gap->gap);
		if (opening(before - given, after - given, pass->h_s) <= touch->band &&
		    (touch->lasting || before >= -rb_link_noise(world, link)))
			return true;
	}
	/* soft landing: brought together by forces, no faster than these can in one step */
	if (!rb_contact_crowded(pass, touch))
		return false;
	const double forced = rb_contact_forced(pass, link);
	double max = forced;
	if (touch->lasting) {
		/* centres move straight while the surfaces curve away by s^2 / (2 r) in a step */
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
 * Deviation of an eccentric shape's centre from the straight line within this substep, m: the
 * rotation formula of Rodrigues less its linear term, with the gyroscopic change of the spin.
 */
static rb_vec3 arc(const struct rb_pass *pass, int i)
{
	const struct rb_world *world = pass->world;
	const struct rb_model *model = world->model;

	if (i >= model->body_count || !model->center_of_mass)
		return (rb_vec3){0, 0, 0};
	const rb_vec3 arm = rb_vec3_neg(rb_quat_rotate(
		rb_world_orientation_at(world, &world->state, i), model->center_of_mass[i]));
	const rb_vec3 spin = rb_world_row3(world->state.spin, i);
	const rb_vec3 turn = rb_flow_turn(world, i, pass->h_s, spin);
	const rb_vec3 beyond = rb_vec3_sub(turn, rb_vec3_scale(pass->h_s, spin));
	const double angle = rb_vec3_length(turn);

	/* (1 - cos) k x (k x r) + (sin - angle) k x r, neither bracket formed by cancellation */
	const double half_sine = sin(0.5 * angle), square = angle * angle;
	const double bend = angle > 0 ? 2 * half_sine * half_sine / square : 0;
	const double lag = angle < 1e-2 ? -1.0 / 6 + square / 120
	                                : (sin(angle) - angle) / (square * angle);
	const rb_vec3 once = rb_vec3_cross(turn, arm);

	return rb_vec3_add(rb_vec3_cross(beyond, arm),
	                   rb_vec3_add_scaled(rb_vec3_scale(bend, rb_vec3_cross(turn, once)),
	                                      lag * square, once));
}

/*
 * Smallest normal velocity allowed: the gap may close but not further, with the arcs of eccentric
 * bodies added to straight motion; an overlap beyond half of the tolerance is given back in a step.
 */
static double target_speed(const struct rb_pass *pass, const struct rb_link *link, double gap)
{
	const double arcs = rb_vec3_dot(rb_vec3_sub(arc(pass, link->b), arc(pass, link->a)),
	                                link->normal);

	return (-fmax(gap, 0) - arcs) / pass->h_s + given_back(pass, gap);
}

/*
 * Bound on how much the gap can close in this substep, m, from velocities alone: a cheap test
 * before the contact's mechanics are set up.
 */
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

/* Finds the lasting contacts and solves their reactions. */
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
		/* warm start; friction of the old normal is projected across the new one */
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
		RB_ASSERT_COSTLY(count <= pass->touch_count);
	}
	for (int n = 0; n < count; n++)
		rb_link_apply(
			world, &row[n].link,
			rb_vec3_add_scaled(row[n].tangent, row[n].normal, row[n].link.normal));
	/* a short substep moves nothing far: its remainder is taken up by the next long one */
	const double tolerance = rb_contact_tolerance(pass) * fmin(pass->dt_s / pass->h_s, 100);
	rb_impulse_rows_solve(world, row, count,
	                      count * SWEEPS < ROW_SWEEPS ? ROW_SWEEPS / (count > 0 ? count : 1)
	                                                  : SWEEPS,
	                      tolerance);
	for (int n = 0; n < count; n++) {
		struct rb_touch *touch = &pass->touch[of[n]];

		/* a contact that needed no impulse and has a gap is none */
		touch->lasting = row[n].normal > 0 || pass->now[of[n]].gap <= touch->band;
		touch->force_normal = row[n].link.normal;
		touch->normal_force = row[n].normal / pass->h_s;
		touch->tangent_force = rb_vec3_scale(1 / pass->h_s, row[n].tangent);
	}
	rb_arena_back(pass->arena, here);
}

/* Marks bodies with a lasting contact at the beginning of the substep; false: none has one. */
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
 * Predicted velocity at the end of the substep: a body in lasting contact keeps its velocity, since
 * reactions will cancel the forces.
 */
static rb_vec3 foreseen_velocity(const struct rb_world *world, int i)
{
	if (i >= world->model->body_count)
		return (rb_vec3){0, 0, 0};
	return rb_world_row3(world->groups->held[i] ? world->mark.velocity : world->state.velocity,
	                     i);
}

/*
 * Rejects a substep before its reactions are solved: when two bodies not in contact would overlap
 * by far going straight, at a speed that makes an impact. Sets `worst`, which ends the list of
 * stages.
 */
static void look_ahead(struct rb_pass *pass)
{
	const struct rb_world *world = pass->world;
	/* far beyond the tolerance, so that no reaction would have saved the substep */
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
		/* straight paths: the surfaces only curve away from each other */
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

/* Moves two bodies apart along the normal in inverse proportion to their masses. */
static void part(struct rb_world *world, const struct rb_touch *touch, rb_vec3 normal,
                 double distance)
{
	RB_ASSERT_COSTLY(world->model->inverse_mass[touch->a] > 0);

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
