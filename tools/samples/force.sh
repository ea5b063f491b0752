# SPDX-License-Identifier: MIT
# A force of tools/sample: a pull to a point, by each method against the closed form.
most=4

add()
{
	cat >src/force/tether.c <<'END'
/* SPDX-License-Identifier: MIT */
/* Pulls every free body's centre of mass to a point, -stiffness times the way from there. */
#include "model/element.h"

struct tether {
	rb_vec3 center;   /* m */
	double stiffness; /* N/m */
	int line;
};

#define AT(member) offsetof(struct tether, member)

static const struct rb_row keys[] = {
	{"center", RB_ROW_VECTOR, 0, 0, AT(center), NULL, "{0, 0, 0}", "m", "where it pulls to"},
	{"stiffness", RB_ROW_NUMBER, RB_RANGE_NOT_NEGATIVE, 0, AT(stiffness), NULL, "required", "N/m",
	 "times the distance"},
};

static rb_vec3 way(const struct tether *tether, const struct rb_pose *pose)
{
	return rb_vec3_sub(pose->position, tether->center);
}

static bool act(const struct rb_element_query *query, const void *row, int index, const struct rb_pose *pose,
                struct rb_wrench *out)
{
	const struct tether *tether = row;

	(void)query, (void)index;
	*out = (struct rb_wrench){.force = rb_vec3_scale(-tether->stiffness, way(tether, pose))};
	return true;
}

static double energy(const struct rb_element_query *query, const void *row)
{
	const struct tether *tether = row;
	double sum = 0;

	for (int i = 0; i < query->model->body_count; i++) {
		const struct rb_pose pose = query->pose(query, i);
		const rb_vec3 x = way(tether, &pose);

		if (query->model->inverse_mass[i] > 0)
			sum += 0.5 * tether->stiffness * rb_vec3_dot(x, x);
	}
	return sum;
}

extern const struct rb_element_kind rb_force_tether;
const struct rb_element_kind rb_force_tether = {
	.name = "tether",
	.plural = "tethers",
	.feature = RB_FEATURE_ELEMENTS,
	.row_size = sizeof(struct tether),
	.line_at = AT(line),
	.defaults = &(const struct tether){.stiffness = 0},
	.keys = {"tether", keys, sizeof keys / sizeof keys[0], NULL},
	.act = act,
	.energy = energy,
};
END
	edit src/force/kinds.c 's|^const struct rb_element_kind \*const rb_element_kinds\[\] = {|extern const struct rb_element_kind rb_force_tether;\n&\&rb_force_tether, |'
	place force/tether force/kinds "a pull to a point"
}

try()
{
	cat >swing.lua <<'END'
-- A ball in two tethers: about {0.5, 0, 1} with an angular frequency of 2.
world { duration = 2, frame_rate = 50, time_step = 1e-4, method = param("method", "auto", "of the run") }
record { ledger = true }
tether { center = {0, 0, 1}, stiffness = 2 }
tether { center = {1, 0, 1}, stiffness = 2 }
local ball = sphere { radius = 0.1, mass = 1, position = {1.5, 0, 1} }
local bound = param("bound", 1e-9, "m")
expect("the ball swings", function() return math.abs(ball.position.x - 0.5 - math.cos(4)), bound end)
expect("energy stays", function() return math.abs(energy() - 2.5), 5 * bound end)
END
	for method in auto located stepped; do
		bound=1e-9
		[ $method != stepped ] || bound=1e-3
		"$rbsim" swing.lua --method $method --param bound=$bound -o swing.h5 --force --quiet ||
			fail "the sample force is wrong by $method"
	done
	"$rbsim" info swing.h5 --json | grep -q '"tether_count":2' || fail "the recording has no tethers"
	"$rbsim" check swing.lua | grep -q '2 tethers' || fail "check says nothing of tethers"
	"$rbsim" --print-tables scene | grep -q 'table tether' || fail "the tables of keys have no tether"
	"$rbsim" check swing.lua --method classic 2>&1 | grep -q "has no tethers" || fail "classic steps leave tethers out"
}
