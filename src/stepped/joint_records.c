/* SPDX-License-Identifier: MIT */
#include "stepped/joint_records.h"

#include <math.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"
#include "stepped/joint_steps.h"
#include "world/joint_events.h"

/* Share of a drive's maximum from which on it counts as at its bound, but for rounding. */
static const double at_bound = 1 - 1e-12;

struct recording {
	struct rb_world *world;
	struct rb_joint_moment moment;
	double h_s;
	struct rb_error *err;
};

static enum rb_status add_event(const struct recording *r, enum rb_event_kind kind, double impulse,
                                double approach)
{
	struct rb_events *reported = &r->world->stepped->reported;

	if (!rb_memory_reserve(&reported->row, &reported->capacity, reported->count + 1,
	                       sizeof *reported->row))
		return RB_FAIL(r->err, RB_ERR_MEMORY, "no memory for the events of a step");
	reported->row[reported->count++] = rb_joint_event(r->world->model, kind, &r->moment,
	                                                  impulse, approach);
	return RB_OK;
}

/* Adds an impact of a limit or rope without force in the last step that was approached. */
static enum rb_status add_impact(const struct recording *r, const struct rb_joint *joint,
                                 const struct rb_step_joint *of, int part)
{
	const bool rope = joint->link.type->one_sided;
	const double approach = part == RB_JOINT_LOW ? -of->rate : of->rate;
	const double lever = rb_linkage_turns(&joint->link) ? joint->size : 1;

	if (of->impulse[part] == 0 || of->last.force[part] != 0 ||
	    !(lever * approach > rb_islands_joint_tolerance(&r->world->stepped->solver)))
		return RB_OK;
	return add_event(r, rope ? RB_EVENT_TAUT : RB_EVENT_LIMIT, of->impulse[part], approach);
}

static enum rb_status add_change(const struct recording *r, int what, bool holds)
{
	int *const noted = r->world->stepped->solver.joint[r->moment.joint].noted;
	enum rb_event_kind kind;

	return rb_joint_event_notes(noted, what, holds, &kind) ? add_event(r, kind, 0, 0) : RB_OK;
}

static enum rb_status add_drive(const struct recording *r, const struct rb_joint *joint,
                                const struct rb_step_joint *of, int what, int part)
{
	const struct rb_joint_state *state = &r->world->joint[r->moment.joint];
	const double max = rb_joint_state_drive(state, joint, what).max;

	if (!(max > 0))
		return RB_OK;
	return add_change(r, what, fabs(of->impulse[part]) < at_bound * r->h_s * max);
}

static enum rb_status add_joint(const struct recording *r)
{
	const struct rb_joint *joint = &r->world->model->joints->joint[r->moment.joint];
	struct rb_step_joint *of = &r->world->stepped->solver.joint[r->moment.joint];
	enum rb_status status = RB_OK;

	memcpy(of->noted, r->world->joint[r->moment.joint].noted, sizeof of->noted);
	/* at rest nothing changes */
	if (of->first_row < 0)
		return RB_OK;
	if (joint->link.type->one_sided) {
		status = add_impact(r, joint, of, 0);
		return status == RB_OK ? add_change(r, RB_JOINT_TAUT, of->impulse[0] != 0) : status;
	}
	if (!rb_linkage_has_free(&joint->link))
		return RB_OK;
	for (int part = RB_JOINT_LOW; part <= RB_JOINT_HIGH && status == RB_OK; part++)
		status = add_impact(r, joint, of, part);
	if (status == RB_OK)
		status = add_drive(r, joint, of, RB_DRIVE_MOTOR, RB_JOINT_MOTOR);
	if (status == RB_OK)
		status = add_drive(r, joint, of, RB_DRIVE_FRICTION, RB_JOINT_FRICTION);
	return status;
}

enum rb_status rb_joint_records_add(struct rb_world *world, const struct rb_cohort *cohort,
                                    double time, double h, const unsigned char *skip,
                                    struct rb_error *err)
{
	struct recording r = {.world = world, .h_s = h, .err = err};
	enum rb_status status = RB_OK;

	RB_ASSERT(h > 0);
	for (int m = 0; world->model->joints && m < cohort->member_count; m++) {
		const int i = cohort->body[m];
		int at = -1;

		if (skip && skip[i])
			continue;
		for (int k; status == RB_OK && (k = rb_joints_next_of(world, i, &at)) >= 0;) {
			const struct rb_joint *joint = &world->model->joints->joint[k];

			r.moment = (struct rb_joint_moment){.joint = k,
			                                    .time_s = time,
			                                    .a = rb_joints_pose(world, joint->a),
			                                    .b = rb_joints_pose(world, joint->b)};
			status = add_joint(&r);
		}
	}
	return status;
}
