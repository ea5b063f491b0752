/* SPDX-License-Identifier: MIT */
/* src/script/vector.c: vectors of scenes, their operators, lists of numbers, orientations */
#include "support.h"

#include <float.h>

#include <lauxlib.h>
#include <lualib.h>

#include "math/quat.h"
#include "math/random.h"
#include "math/vec3.h"
#include "script/vector.h"

static lua_State *open_lua(void)
{
	lua_State *L = luaL_newstate();

	assert_non_null(L);
	luaL_requiref(L, "_G", luaopen_base, 1);
	luaL_requiref(L, "math", luaopen_math, 1);
	rb_vector_open(L);
	lua_settop(L, 0);
	return L;
}

static void must_run(lua_State *L, const char *text)
{
	if (luaL_dostring(L, text) != LUA_OK)
		fail_msg("'%s': %s", text, lua_tostring(L, -1));
}

static void must_fail(lua_State *L, const char *text, const char *part)
{
	if (luaL_dostring(L, text) == LUA_OK)
		fail_msg("'%s' did not fail", text);
	if (!strstr(lua_tostring(L, -1), part))
		fail_msg("'%s': '%s' has no '%s'", text, lua_tostring(L, -1), part);
	lua_settop(L, 0);
}

/* Leaves the value of an expression as the only one on the stack. */
static void value_of(lua_State *L, const char *expression)
{
	char text[400];

	lua_settop(L, 0);
	snprintf(text, sizeof text, "return %s", expression);
	must_run(L, text);
}

static rb_vec3 vector_of(lua_State *L, const char *expression)
{
	double v[3];

	value_of(L, expression);
	assert_true(rb_vector_numbers(L, -1, 3, v, NULL));
	return rb_vec3_from(v);
}

static double number_of(lua_State *L, const char *expression)
{
	value_of(L, expression);
	assert_int_equal(lua_type(L, -1), LUA_TNUMBER);
	return lua_tonumber(L, -1);
}

static void assert_is(rb_vec3 v, double x, double y, double z)
{
	assert_near(v.x, x, 0);
	assert_near(v.y, y, 0);
	assert_near(v.z, z, 0);
}

static void operators_work_part_by_part(void **state)
{
	lua_State *L = open_lua();

	(void)state;
	assert_is(vector_of(L, "vec3(1, 2, 3) + {10, 20, 30}"), 11, 22, 33);
	assert_is(vector_of(L, "{1, 2, 3} - vec3(10, 20, 30)"), -9, -18, -27);
	assert_is(vector_of(L, "2 * vec3(1, 2, 3)"), 2, 4, 6);
	assert_is(vector_of(L, "vec3(1, 2, 3) * -2"), -2, -4, -6);
	assert_is(vector_of(L, "vec3(1, 2, 4) / 4"), 0.25, 0.5, 1);
	assert_is(vector_of(L, "-vec3 {1, 0, -3}"), -1, -0.0, 3);
	assert_is(vector_of(L, "vec3(1, 0, 0):cross({0, 1, 0})"), 0, 0, 1);
	assert_near(number_of(L, "vec3(1, 2, 3):dot(vec3(4, -5, 6))"), 12, 0);
	assert_near(number_of(L, "vec3(2, 3, 6):length()"), 7, 0);
	assert_is(vector_of(L, "vec3(0, -4, 0):unit()"), 0, -1, 0);
	must_run(L, "assert(vec3(1, 2, 3) == vec3(1, 2, 3) and vec3(1, 2, 3) ~= vec3(1, 2, 4))");
	must_run(L, "assert(vec3(1, 2, 3) ~= vec3(0, 2, 3) and vec3(1, 2, 3) ~= vec3(1, 0, 3))");
	must_run(L, "assert(vec3(0/0, 0, 0) ~= vec3(0/0, 0, 0))");
	must_run(L, "assert(tostring(vec3(1, -2, 0.5)) == '{1.0, -2.0, 0.5}')");
	/* the longest that a vector can be */
	assert_true(number_of(L, "vec3(1e200, 0, 0):length()") == 1e200);
	lua_close(L);
}

static void coordinates_can_be_read_and_set(void **state)
{
	lua_State *L = open_lua();

	(void)state;
	must_run(L, "v = vec3(1, 2, 3) assert(v.x == 1 and v.y == 2 and v.z == 3 and v[2] == 2)");
	must_run(L, "v.y = 5 v.z = 6 assert(v[1] == 1 and v[2] == 5 and v[3] == 6 and #v == 3)");
	must_run(L, "local w = vec3(v) w.x = 9 assert(v.x == 1)"); /* a copy */
	must_fail(L, "v.w = 1", "only x, y and z");
	must_fail(L, "v.x = 'a'", "to numbers");
	must_fail(L, "v[4] = 1", "only x, y and z");
	must_fail(L, "return v.xy", "no field 'xy'");
	must_fail(L, "return v.w", "no field 'w'");
	must_run(L, "assert(v[4] == nil)");
	must_run(L, "assert(getmetatable(v) == 'vec3' and not pcall(setmetatable, v, {}))");
	lua_close(L);
}

static void what_is_no_vector_is_told(void **state)
{
	lua_State *L = open_lua();

	(void)state;
	must_fail(L, "vec3(1, 2)", "got nothing for number 3");
	must_fail(L, "vec3(1, '2', 3)", "got the text '2' for number 2");
	must_fail(L, "vec3({1, 2})", "got {1, 2} for number 1");
	must_fail(L, "vec3({1, 2, 3, z = 4})", "expected three numbers");
	must_fail(L, "return vec3(1, 2, 3) + 5", "'+' needs two vectors (got 5)");
	must_fail(L, "return {} - vec3(1, 2, 3)", "'-' needs two vectors (got {})");
	must_fail(L, "return vec3(1, 2, 3) * vec3(1, 2, 3)", "a:dot(b)");
	must_fail(L, "return vec3(1, 2, 3) * '2'", "'*' needs a number");
	must_fail(L, "return 2 / vec3(1, 2, 3)", "'/' needs a vector and a number");
	must_fail(L, "return vec3(0, 0, 0):unit()", "without length");
	must_fail(L, "return vec3(0/0, 0, 0):unit()", "without length");
	must_fail(L, "return vec3(1, 2, 3):dot(4)", "'dot' needs two vectors");
	must_fail(L, "return deg('x')", "number expected");
	must_run(L, "v = vec3(1, 2, 3) for i = 1, 3 do rawset(v, i, nil) end");
	must_run(L, "assert(tostring(v) == '{a broken vec3}' and v ~= vec3(1, 2, 3))");
	lua_close(L);
}

/* Of unit vectors and products what geometry says of them. */
static void random_vectors_obey_geometry(void **state)
{
	lua_State *L = open_lua();
	char text[400];

	(void)state;
	for (uint64_t k = 0; k < 300; k++) {
		double c[6];

		for (uint64_t i = 0; i < 6; i++)
			c[i] = ldexp(rb_random_unit(7, k, i) - 0.5, (int)(k % 40) - 20);
		snprintf(text, sizeof text,
		         "a = vec3(%.17g, %.17g, %.17g) b = vec3(%.17g, %.17g, %.17g)", c[0], c[1],
		         c[2], c[3], c[4], c[5]);
		must_run(L, text);
		const rb_vec3 a = rb_vec3_from(c), b = rb_vec3_from(c + 3);
		const double la = sqrt(a.x * a.x + a.y * a.y + a.z * a.z),
			     lb = sqrt(b.x * b.x + b.y * b.y + b.z * b.z);
		const rb_vec3 cross = vector_of(L, "a:cross(b)");
		const double dot = number_of(L, "a:dot(b)"), cl = rb_vec3_length(cross);

		/* a few roundings of numbers up to la lb */
		assert_near(cl * cl + dot * dot, la * la * lb * lb,
		            16 * DBL_EPSILON * la * la * lb * lb);
		assert_near(rb_vec3_dot(cross, a), 0, 16 * DBL_EPSILON * la * la * lb);
		assert_near(number_of(L, "a:unit():length()"), 1, 4 * DBL_EPSILON);
		assert_near(number_of(L, "a:unit():dot(a)"), la, 4 * DBL_EPSILON * la);
		const rb_vec3 back = vector_of(L, "a + b - b - a");
		assert_near(rb_vec3_length(back), 0, 4 * DBL_EPSILON * (la + lb));
	}
	lua_close(L);
}

static void degrees_become_radians(void **state)
{
	lua_State *L = open_lua();

	(void)state;
	assert_near(number_of(L, "deg(180)"), 3.14159265358979323846, 0);
	assert_near(number_of(L, "math.cos(deg(60))"), 0.5, 4 * DBL_EPSILON);
	assert_near(number_of(L, "deg(-360) + 2 * math.pi"), 0, 4 * DBL_EPSILON);
	lua_close(L);
}

static void lists_of_numbers_hold_nothing_else(void **state)
{
	static const struct {
		const char *text;
		int found;
		bool right;
	} cases[] = {{"{1, 2, 3}", 3, true},
	             {"{1, 2}", 2, false},
	             {"{1, 2, 3, 4}", 4, false},
	             {"{1, 2, 3, x = 1}", 3, false},
	             {"{1, '2', 3}", 1, false},
	             {"{1, nil, 3}", 1, false},
	             {"{}", 0, false},
	             {"'123'", 0, false},
	             {"{1, 0/0, 1/0}", 3, true},
	             {"setmetatable({1, 2}, {__index = {1, 2, 3}})", 2, false}};
	lua_State *L = open_lua();

	(void)state;
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double v[3] = {-1, -1, -1};
		int found = -1;

		value_of(L, cases[i].text);
		assert_int_equal(rb_vector_numbers(L, 1, 3, v, &found), cases[i].right);
		assert_int_equal(found, cases[i].found);
		assert_int_equal(lua_gettop(L), 1);
	}
	lua_close(L);
}

static void assert_turn(lua_State *L, const char *text, enum rb_turn wanted)
{
	struct rb_turn_found found;
	rb_quat q;

	value_of(L, text);
	if (rb_vector_turn(L, -1, &q, &found) != wanted)
		fail_msg("%s: not %d", text, (int)wanted);
	assert_int_equal(lua_gettop(L), 1);
	if (wanted == RB_TURN_RIGHT)
		assert_near(rb_quat_length(q), 1, 4 * DBL_EPSILON);
}

static void an_orientation_is_a_unit_quaternion_or_an_axis_with_an_angle(void **state)
{
	lua_State *L = open_lua();
	struct rb_turn_found found;
	rb_quat q;

	(void)state;
	assert_turn(L, "{1, 0, 0, 0}", RB_TURN_RIGHT);
	assert_turn(L, "{0.6, 0, 0.8005, 0}", RB_TURN_RIGHT); /* 0.04 % longer */
	assert_turn(L, "{0.6, 0, 0.9, 0}", RB_TURN_NOT_UNIT);
	assert_turn(L, "{0, 0, 0, 0}", RB_TURN_NOT_UNIT);
	assert_turn(L, "{0/0, 0, 0, 0}", RB_TURN_NOT_FINITE);
	assert_turn(L, "{1/0, 0, 0, 0}", RB_TURN_NOT_FINITE);
	assert_turn(L, "{1, 0, 0}", RB_TURN_NO_LIST);
	assert_turn(L, "5", RB_TURN_NO_LIST);
	assert_turn(L, "{axis = {1, 0, 0}}", RB_TURN_NO_LIST);
	assert_turn(L, "{axis = {1, 0, 0}, angle = 1, turns = 2}", RB_TURN_NO_LIST);
	assert_turn(L, "{axis = {1, 0}, angle = 1}", RB_TURN_NO_LIST);
	assert_turn(L, "{axis = {0, 0, 0}, angle = 1}", RB_TURN_NO_AXIS);
	assert_turn(L, "{axis = {0/0, 0, 0}, angle = 1}", RB_TURN_NOT_FINITE);
	assert_turn(L, "{axis = {1, 0, 0}, angle = 1/0}", RB_TURN_NOT_FINITE);
	assert_turn(L, "{axis = {1e-300, 0, 0}, angle = 1}", RB_TURN_RIGHT);
	assert_turn(L, "{axis = {1e300, 1e300, 0}, angle = 1}", RB_TURN_RIGHT);

	/* a quarter turn about z takes x to y; the axis needs no unit length */
	value_of(L, "{axis = vec3(0, 0, 8), angle = deg(90)}");
	assert_int_equal(rb_vector_turn(L, 1, &q, &found), RB_TURN_RIGHT);
	assert_true(found.by_axis);
	const rb_vec3 y = rb_quat_rotate(q, (rb_vec3){1, 0, 0});
	assert_near(y.x, 0, 4 * DBL_EPSILON);
	assert_near(y.y, 1, 4 * DBL_EPSILON);
	assert_near(y.z, 0, 4 * DBL_EPSILON);
	lua_close(L);
}

static int l_check(lua_State *L)
{
	rb_vector_push(L, rb_vector_check(L, 1, "where"));
	return 1;
}

static void an_argument_is_a_finite_vector(void **state)
{
	lua_State *L = open_lua();

	(void)state;
	lua_register(L, "check", l_check);
	assert_is(vector_of(L, "check {1, 2, 3}"), 1, 2, 3);
	must_fail(L, "check(5)", "where: expected a vector {x, y, z} (got 5)");
	must_fail(L, "check()", "where: expected a vector");
	must_fail(L, "check {1, 2, 1/0}", "where: expected finite numbers");
	must_fail(L, "check {0/0, 2, 3}", "where: expected finite numbers");
	lua_close(L);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(operators_work_part_by_part),
		cmocka_unit_test(coordinates_can_be_read_and_set),
		cmocka_unit_test(what_is_no_vector_is_told),
		cmocka_unit_test(random_vectors_obey_geometry),
		cmocka_unit_test(degrees_become_radians),
		cmocka_unit_test(lists_of_numbers_hold_nothing_else),
		cmocka_unit_test(an_orientation_is_a_unit_quaternion_or_an_axis_with_an_angle),
		cmocka_unit_test(an_argument_is_a_finite_vector),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
