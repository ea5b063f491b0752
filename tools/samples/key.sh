# SPDX-License-Identifier: MIT
# A key of scenes of tools/sample: a factor of a body's mass.
most=4

add()
{
	edit include/rbsim/scene.h 's|^	double mass, density; .*|&\n	double mass_factor; /* 1; times the mass that follows from all else */|'
	edit src/model/scene.c '/^struct rb_body_def rb_body_def_default/,/^}/s|^		.density = .*|&\n		.mass_factor = 1,|'
	after src/script/rows.c '	{"name", RB_ROW_TEXT, 0, 0, AT(rb_body_def, name), NULL, "none", "", "unique; recorded"},' <<'END'
	{"mass_factor", RB_ROW_NUMBER, RB_RANGE_POSITIVE, 0, AT(rb_body_def, mass_factor), NULL, "1",
	 "1", "times the mass that follows from all else"},
END
	edit src/model/validate.c '/^double rb_body_mass/,/^}/s|return isnan|return body->mass_factor * (isnan|' \
		'/^double rb_body_mass/,/^}/s|: body->mass;|: body->mass);|'
	edit src/model/validate.c '/^static void check_tolerance/i\
/* Whether it could have any effect. */\
static void check_factor(struct check *check)\
{\
	for (int i = 0; i < check->scene->body_count; i++)\
		if (check->scene->bodies[i].is_static \&\& check->scene->bodies[i].mass_factor != 1)\
			world_mistake(check, "a body that never moves has no use for '"'mass_factor'"'");\
}\
' 's|^	check_method(&check);|	check_factor(\&check);\n&|'
}

try()
{
	cat >heavy.lua <<'END'
-- Twice the mass, half the acceleration.
world { duration = 1, frame_rate = 10, gravity_force = {12, 0, 0} }
local ball = sphere { radius = 0.1, mass = 3, mass_factor = param("factor", 2, "1"), position = {0, 0, 0} }
expect("its mass", function() return math.abs(ball.mass - 6), 0 end)
expect("its speed", function() return math.abs(ball.velocity.x - 2), 1e-14 end)
END
	"$rbsim" heavy.lua -o heavy.h5 --quiet || fail "the sample key has no effect"
	"$rbsim" heavy.lua --no-record --quiet --param factor=4 2>/dev/null && fail "the sample key has one value"
	"$rbsim" --print-tables scene | grep -q 'mass_factor' || fail "the tables of keys have no 'mass_factor'"
	"$rbsim" check heavy.lua --param factor=-2 2>&1 | grep -q "heavy.lua:3: sphere: 'mass_factor' must be" ||
		fail "a factor out of its range is not refused"
	echo 'sphere { radius = 1, mas_factor = 2 }' | cat heavy.lua - >near.lua
	"$rbsim" check near.lua 2>&1 | grep -q "did you mean 'mass_factor'" || fail "a near name has no advice"
	echo 'sphere { radius = 1, static = true, position = {9, 0, 0}, mass_factor = 2 }' | cat heavy.lua - >static.lua
	"$rbsim" check static.lua 2>&1 | grep -q "has no use for 'mass_factor'" || fail "a factor without effect is not refused"
}
