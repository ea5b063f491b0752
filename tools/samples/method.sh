# SPDX-License-Identifier: MIT
# A method of tools/sample: coasting, which has only bodies that gravity alone acts on, and these exactly.
most=5

add()
{
	mkdir src/coast
	cat >src/coast/coast.h <<'END'
/* SPDX-License-Identifier: MIT */
/*
 * The coasting method: bodies on which only gravity acts.
 *
 * Equations. In a step h: x' = x + h v + h^2 g / 2, v' = v + h g, exact for any h.
 *
 * Decisions: none. What could touch or turn is refused (lacks).
 */
#ifndef RB_COAST_COAST_H
#define RB_COAST_COAST_H

#include "model/descriptor.h"

extern const struct rb_method rb_method_coast;

#endif
END
	cat >src/coast/coast.c <<'END'
/* SPDX-License-Identifier: MIT */
#include "coast/coast.h"

#include "base/error.h"
#include "base/memory.h"
#include "base/pack.h"
#include "step/method_part.h"
#include "world/world.h"

struct rb_coast {
	uint64_t steps; /* so far, of all runs that this one goes on from */
};

static const struct rb_method_part rows[] = {
	{"gravity", "the acceleration of the world", RB_FEATURE_GRAVITY},
	{"move", "positions: parabolas", 0},
	{"turn", "orientations", RB_FEATURE_ROTATION},
};

static const struct rb_method_part *parts(int *count)
{
	*count = (int)(sizeof rows / sizeof rows[0]);
	return rows;
}

static enum rb_status prepare(struct rb_world *world, struct rb_error *err)
{
	if (!world->coast)
		world->coast = rb_memory_take(1, sizeof *world->coast);
	return world->coast ? RB_OK : RB_FAIL(err, RB_ERR_MEMORY, "no memory for coasting");
}

static enum rb_status step(struct rb_world *world, double start_s, double dt_s, struct rb_error *err)
{
	const rb_vec3 g = world->model->scene->world.gravity;

	(void)err;
	for (int i = 0; i < world->model->body_count; i++) {
		const rb_vec3 v = rb_world_row3(world->state.velocity, i);
		const rb_vec3 x = rb_vec3_add_scaled(rb_world_row3(world->state.position, i), dt_s,
		                                     rb_vec3_add_scaled(v, dt_s / 2, g));

		rb_vec3_to(world->state.position + 3 * (size_t)i, x);
		rb_vec3_to(world->state.velocity + 3 * (size_t)i, rb_vec3_add_scaled(v, dt_s, g));
	}
	world->coast->steps++;
	world->frame_counts.substeps++;
	world->state.time_s = start_s + dt_s;
	return RB_OK;
}

static void pack_steps(struct rb_world *world, struct rb_pack *pack)
{
	bool prepared = world->coast != NULL;

	rb_pack_bool(pack, &prepared);
	if (!prepared || pack->failed)
		return;
	if (pack->loading && prepare(world, NULL) != RB_OK)
		pack->failed = pack->no_memory = true;
	else
		rb_pack_u64(pack, &world->coast->steps);
}

static enum rb_status validate(const struct rb_world *world, struct rb_error *err)
{
	if (world->coast && world->state.frame > 0 && world->coast->steps < world->state.frame)
		return RB_FAIL(err, RB_ERR_BUG, "fewer steps than frames");
	return RB_OK;
}

static void release(struct rb_world *world)
{
	rb_memory_free(world->coast);
	world->coast = NULL;
}

static const struct rb_stepper steps = {
	.prepare = prepare, .step = step, .pack = pack_steps, .validate = validate, .release = release};

const struct rb_method rb_method_coast = {
	.name = "coast",
	.what = "parabolas",
	.good_for = "bodies that nothing but gravity acts on",
	.mind = "nothing can touch or turn",
	.steps = &steps,
	.lacks = ~(rb_features)(RB_FEATURE_GRAVITY | RB_FEATURE_EVENTS),
	.parts = parts,
	.parts_title = "parts of coasting",
};
END
	edit src/method/method_table.c 's|^	\[RB_METHOD_STEPPED\] = .*|&\n	[RB_METHOD_COAST] = \&rb_method_coast,|' \
		's|^#include "classic/classic.h"|&\n#include "coast/coast.h"|'
	edit include/rbsim/scene.h 's|^	RB_METHOD_STEPPED,|&\n	RB_METHOD_COAST,|' 's|^#define RB_METHOD_NAMES "[^"]*|&, coast|'
	edit src/world/world.h 's|^struct rb_stepped;|&\nstruct rb_coast;|' \
		's|^	struct rb_stepped \*stepped; .*|&\n	struct rb_coast *coast; /* owned; NULL until it is first used */|'
	place coast/coast method/numbers "the coasting method"
}

try()
{
	cat >throw.lua <<'END'
-- A ball on its parabola, in steps of any length.
world { duration = 2, frame_rate = 8, time_step = 0.04, gravity = {0, 0, -10}, method = "coast" }
local ball = sphere { radius = 0.1, mass = 1, position = {0, 0, 1}, velocity = {3, 0, 5} }
expect("a parabola", function() return (ball.position - vec3(6, 0, 1 + 10 - 20)):length(), 1e-13 end)
expect("its speed", function() return (ball.velocity - vec3(3, 0, -15)):length(), 1e-13 end)
END
	"$rbsim" throw.lua -o whole.h5 --quiet || fail "the sample method is wrong"
	"$rbsim" info whole.h5 | grep -q coast || fail "the recording does not name the method"
	"$rbsim" methods | grep -q '^  coast' || fail "it is not among the methods"
	"$rbsim" check throw.lua | grep -q '^  + move ' || fail "check does not print its parts"
	"$rbsim" throw.lua --method stepped -o other.h5 --quiet || fail "another method cannot be chosen"
	"$rbsim" info other.h5 | grep -q coast && fail "another method was not chosen"
	"$rbsim" throw.lua --method coats --no-record 2>&1 | grep -q 'stepped, coast' || fail "it is not among the choices"
	# a checkpoint has its state
	printf 'at 1 checkpoint\nat 1.1 quit\n' >commands
	"$rbsim" throw.lua -o whole2.h5 --quiet --commands commands 2>/dev/null && fail "the run did not break off"
	"$rbsim" throw.lua -o whole2.h5 --quiet --resume >/dev/null || fail "the run cannot go on"
	"$rbsim" diff whole.h5 whole2.h5 >/dev/null || fail "a run that was interrupted differs"
	# what it lacks is refused
	{ cat throw.lua; echo 'plane { point = {0, 0, -100} }'; } >floor.lua
	"$rbsim" check floor.lua 2>&1 | grep -q "method 'coast' has no feature 'rotation' (" || fail "it takes contacts"
	{ cat throw.lua; echo 'drag { linear = 1 }'; } >drag.lua
	"$rbsim" check drag.lua 2>&1 | grep -q "method 'coast' has no drag" || fail "it takes drag"
}
