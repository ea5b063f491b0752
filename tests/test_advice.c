/* SPDX-License-Identifier: MIT */
/* src/script/advice.c: words of other programs, and that what is advised instead is there */
#include "support.h"

#include "model/shape.h"
#include "script/advice.h"
#include "script/rows.h"

static bool is_key(const struct rb_row_table *table, const char *word)
{
	return rb_row_find(table, word, NULL) != NULL;
}

/* Some call of the language has a key of that name. */
static bool is_known_key(const char *word)
{
	static const struct rb_row_table *const tables[] = {
		&rb_rows_world, &rb_rows_contact_pair, &rb_rows_plane,  &rb_rows_force,
		&rb_rows_light, &rb_rows_particle,     &rb_rows_record, &rb_rows_param};

	for (size_t t = 0; t < sizeof tables / sizeof *tables; t++)
		if (is_key(tables[t], word))
			return true;
	return false;
}

static bool is_shape(const char *word, size_t size)
{
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++) {
		const char *name = rb_shape_types[k]->name;

		if (strlen(name) == size && memcmp(name, word, size) == 0)
			return true;
	}
	return false;
}

static void words_for_bodies_lead_to_shapes_that_there_are(void **state)
{
	static const char *const words[][2] = {{"ball", "sphere"},
	                                       {"cube", "box"},
	                                       {"cuboid", "box"},
	                                       {"ground", "plane"},
	                                       {"floor", "plane"}};

	(void)state;
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const char *text = rb_advice_for_global(words[i][0]);

		assert_non_null(text);
		const size_t size = strcspn(text, " ");
		assert_true(is_shape(text, size));
		assert_memory_equal(text, words[i][1], size);
		/* the word itself is no call, else nobody would be advised */
		assert_false(is_shape(words[i][0], strlen(words[i][0])));
	}
}

/* A union is made by `body`; the name of its type is no call. */
static void words_for_unions_lead_to_the_call_that_makes_them(void **state)
{
	static const char *const words[] = {"compound", "rigidbody", "RigidBody", "addBody"};

	(void)state;
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		assert_non_null(strstr(rb_advice_for_global(words[i]), "body { shapes = "));
		assert_null(strstr(rb_advice_for_global(words[i]), "union {"));
	}
}

static void keys_that_are_advised_are_keys_of_the_call_that_is_named(void **state)
{
	(void)state;
	for (int i = 0; i < 3; i++) {
		static const char *const words[] = {"dt", "timestep", "fps"};
		static const char *const keys[] = {"time_step", "time_step", "frame_rate"};
		const char *text = rb_advice_for_key(words[i]);

		assert_non_null(text);
		assert_true(is_key(&rb_rows_world, keys[i]));
		assert_ptr_equal(strstr(text, keys[i]), text);
		assert_non_null(strstr(text, "of world"));
	}
	for (int i = 0; i < 4; i++) {
		static const char *const words[] = {"bounciness", "elasticity", "restitution",
		                                    "friction"};
		const char *text = rb_advice_for_key(words[i]);

		assert_non_null(text);
		assert_non_null(strstr(text, "material"));
	}
	assert_true(is_key(&rb_rows_material, "restitution"));
	assert_true(is_key(&rb_rows_material, "friction"));
	assert_false(is_key(&rb_rows_body, "restitution"));
	assert_false(is_key(&rb_rows_body, "friction"));
	assert_non_null(strstr(rb_advice_for_key("omega"), "'angular_velocity'"));
	assert_non_null(strstr(rb_advice_for_key("spin"), "'angular_velocity'"));
	assert_true(is_key(&rb_rows_body, "angular_velocity"));
	assert_ptr_equal(strstr(rb_advice_for_key("fixed"), "static = true"),
	                 rb_advice_for_key("fixed"));
	assert_int_equal(rb_row_find(&rb_rows_body, "static", NULL)->type, RB_ROW_BOOLEAN);
}

static bool shape_has(const struct rb_shape_type *type, const char *word)
{
	for (int i = 0; i < type->key_count; i++)
		if (strcmp(type->key[i].key, word) == 0)
			return true;
	return false;
}

/* Some shape has the key, but not the word that may stand for it. */
static bool some_shape_has(const char *key, const char *word)
{
	for (int kind = 0; kind < RB_SHAPE_KIND_COUNT; kind++)
		if (shape_has(rb_shape_types[kind], key) && !shape_has(rb_shape_types[kind], word))
			return true;
	return false;
}

static void synonyms_are_keys_of_some_call(void **state)
{
	static const struct {
		const char *word;
		const struct rb_row_table *table; /* NULL: of a shape that lacks the word */
	} rows[] = {
		{"r", NULL},
		{"diameter", NULL},
		{"height", NULL},
		{"height", &rb_rows_plane},
		{"offset", &rb_rows_plane},
		{"half", NULL},
		{"width", NULL},
		{"rotation", &rb_rows_body},
		{"mu", &rb_rows_material},
		{"e", &rb_rows_material},
		{"g", &rb_rows_world},
		{"end_time", &rb_rows_world},
	};

	(void)state;
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		const struct rb_row_table *const table = rows[i].table;
		const char *key;
		bool found = false;

		assert_false(table && is_key(table, rows[i].word));
		for (int k = 0; (key = rb_advice_synonym(rows[i].word, k)) != NULL; k++)
			found |= table ? is_key(table, key) : some_shape_has(key, rows[i].word);
		if (!found)
			fail_msg("'%s' leads to no key", rows[i].word);
	}
	assert_null(rb_advice_synonym("r", 1));
	assert_null(rb_advice_synonym("r", 3));
	assert_null(rb_advice_synonym("r", -1));
	assert_null(rb_advice_synonym("radius", 0));
}

/* A scene that writes these means them: advice would come where nothing is wrong. */
static void words_of_the_language_are_not_advised_against(void **state)
{
	static const char *const calls[] = {
		"world", "material", "contact_pair", "camera", "record",  "param", "spring", "drag",
		"field", "expect",   "vec3",         "deg",    "require", "math",  "string"};

	(void)state;
	for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
		assert_null(rb_advice_for_global(calls[i]));
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		assert_null(rb_advice_for_global(rb_shape_types[k]->name));
	for (int i = 0; i < rb_rows_body.count; i++)
		assert_null(rb_advice_for_key(rb_rows_body.rows[i].key));
	for (int i = 0; i < rb_rows_world.count; i++)
		assert_null(rb_advice_for_key(rb_rows_world.rows[i].key));
	/* gravity is a key, and only a key */
	assert_true(is_known_key("gravity"));
	assert_non_null(strstr(rb_advice_for_global("gravity"), "world {"));
}

static void functions_of_mathematics_are_those_of_lua(void **state)
{
	static const char *const words[] = {"pi",   "sqrt", "sin",  "cos",   "tan", "asin",
	                                    "acos", "atan", "exp",  "log",   "abs", "min",
	                                    "max",  "huge", "ceil", "random"};

	(void)state;
	for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
		const char *const text = rb_advice_for_global(words[i]);

		assert_non_null(text);
		assert_memory_equal(text, "math.", 5);
		assert_string_equal(text + 5, words[i]);
	}
	assert_string_equal(rb_advice_for_field("z"), "position.z");
	assert_null(rb_advice_for_field("position"));
}

static void only_the_whole_word_counts(void **state)
{
	(void)state;
	assert_null(rb_advice_for_global(""));
	assert_null(rb_advice_for_key(""));
	assert_null(rb_advice_for_global("bal"));
	assert_null(rb_advice_for_global("balls"));
	assert_null(rb_advice_for_global("Ball"));
	assert_null(rb_advice_for_key("d"));
	assert_null(rb_advice_for_key("dt_s"));
	assert_null(rb_advice_for_key("Omega"));
	/* a global is no key and a key is no global */
	assert_null(rb_advice_for_key("ball"));
	assert_null(rb_advice_for_global("fps"));
}

static void other_words_lead_to_what_there_is(void **state)
{
	static const char *const joints[] = {"rod",    "rope",  "hinge",
	                                     "slider", "motor", "constraint"};
	static const char *const ways_out[] = {"os", "io"};

	(void)state;
	for (size_t i = 0; i < sizeof joints / sizeof *joints; i++)
		assert_non_null(strstr(rb_advice_for_global(joints[i]), "joint { kind = "));
	assert_null(rb_advice_for_global("joint"));
	for (int i = 0; i < rb_rows_joint.count; i++) /* but what belongs to other calls as well */
		if (!is_key(&rb_rows_material, rb_rows_joint.rows[i].key))
			assert_null(rb_advice_for_key(rb_rows_joint.rows[i].key));
	assert_non_null(strstr(rb_advice_for_global("mesh"), "hull { file = "));
	assert_non_null(strstr(rb_advice_for_global("mesh"), "terrain { file = "));
	assert_non_null(strstr(rb_advice_for_global("heightfield"), "terrain { height = "));
	for (size_t i = 0; i < sizeof ways_out / sizeof *ways_out; i++)
		assert_non_null(strstr(rb_advice_for_global(ways_out[i]), "no files"));
	assert_non_null(strstr(rb_advice_for_global("debug"), "'debug'"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(words_for_bodies_lead_to_shapes_that_there_are),
		cmocka_unit_test(synonyms_are_keys_of_some_call),
		cmocka_unit_test(words_for_unions_lead_to_the_call_that_makes_them),
		cmocka_unit_test(keys_that_are_advised_are_keys_of_the_call_that_is_named),
		cmocka_unit_test(words_of_the_language_are_not_advised_against),
		cmocka_unit_test(functions_of_mathematics_are_those_of_lua),
		cmocka_unit_test(only_the_whole_word_counts),
		cmocka_unit_test(other_words_lead_to_what_there_is),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
