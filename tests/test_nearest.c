/* SPDX-License-Identifier: MIT */
/* src/script/nearest.c: which of many names is meant by a word that is none of them */
#include "support.h"

#include "math/random.h"
#include "script/nearest.h"

/* The hint for `word` among names, NULL-terminated. Static storage. */
static const char *hint_of(const char *word, const char *const *names)
{
	static char out[96];
	struct rb_nearest nearest = rb_nearest_to(word);

	for (; *names; names++)
		rb_nearest_offer(&nearest, *names, strlen(*names));
	return rb_nearest_hint(&nearest, out);
}

static void assert_means(const char *word, const char *name)
{
	static const char *const names[] = {
		"mass",     "material",   "position",         "restitution", "radius", "velocity",
		"friction", "frame_rate", "angular_velocity", "up",          "fov",    NULL};
	char wanted[96] = "";

	if (name)
		snprintf(wanted, sizeof wanted, " (did you mean '%s'?)", name);
	assert_string_equal(hint_of(word, names), wanted);
}

static void slips_of_the_pen_are_understood(void **state)
{
	(void)state;
	assert_means("postion", "position");   /* left out */
	assert_means("possition", "position"); /* one too many */
	assert_means("pozition", "position");  /* another */
	assert_means("poistion", "position");  /* two turned round */
	assert_means("resitution", "restitution");
	assert_means("mas", "mass");
	assert_means("vov", "fov");
	assert_means("pu", "up");
	assert_means("framerate", "frame_rate");
	assert_means("position", "position");
}

static void capitals_do_not_count(void **state)
{
	static const char *const names[] = {"softening", "G", "angle", NULL};

	(void)state;
	assert_string_equal(hint_of("g", names), " (did you mean 'G'?)");
	assert_string_equal(hint_of("SOFTENING", names), " (did you mean 'softening'?)");
	assert_string_equal(hint_of("h", names), "");
}

static void cut_words_and_written_out_words_are_understood(void **state)
{
	(void)state;
	assert_means("pos", "position");
	assert_means("vel", "velocity");
	assert_means("angular", "angular_velocity");
	assert_means("radius_of_the_ball", "radius");
	assert_means("po", NULL); /* two letters are too few */
	assert_means("osi", NULL);
}

static void what_is_far_from_all_gets_no_hint(void **state)
{
	(void)state;
	assert_means("", NULL);
	assert_means("x", NULL);
	assert_means("colour", NULL);
	assert_means("quaternion", NULL);
	assert_means("ov", "fov");
	assert_means("ox", NULL); /* two edits in two letters */
	assert_means("ux", NULL); /* one of two letters is another */
	assert_means("mars", "mass");
	assert_means("mine", NULL); /* two edits in four */
	assert_string_equal(hint_of("dens", (const char *const[]){"deg", "sensor", NULL}), "");
	assert_string_equal(hint_of("mass", (const char *const[]){NULL}), "");
}

/* Edits of two words by the definition (optimal string alignment), from their ends. */
static int edits(const char *a, int m, const char *b, int n, int other)
{
	if (m == 0 || n == 0)
		return m + n;
	int best = edits(a, m - 1, b, n - 1, other) + (a[m - 1] != b[n - 1] ? other : 0);
	const int gone = edits(a, m - 1, b, n, other) + 1, come = edits(a, m, b, n - 1, other) + 1;

	best = gone < best ? gone : best;
	best = come < best ? come : best;
	if (m > 1 && n > 1 && a[m - 1] == b[n - 2] && a[m - 2] == b[n - 1]) {
		const int turned = edits(a, m - 2, b, n - 2, other) + 1;
		best = turned < best ? turned : best;
	}
	return best;
}

static int random_word(char out[8], uint64_t index)
{
	const int size = (int)(rb_random_bits(1, index, 0) % 7);

	for (int i = 0; i < size; i++)
		out[i] = (char)('a' + rb_random_bits(1, index, (uint64_t)i + 1) % 3);
	out[size] = '\0';
	return size;
}

/* A third of the letters may be edited; the prefix rule is kept out of it. */
static void a_name_is_near_when_few_edits_part_it(void **state)
{
	int near = 0, far = 0;

	(void)state;
	for (uint64_t k = 0; k < 3000; k++) {
		char word[8], name[8];
		const int word_size = random_word(word, 2 * k);
		const int name_size = random_word(name, 2 * k + 1);
		const int allowed = word_size <= 1 ? 0 : word_size <= 5 ? 1 : 2;
		const int shorter = word_size < name_size ? word_size : name_size;
		const int apart = edits(word, word_size, name, name_size, word_size == 2 ? 2 : 1);

		if (name_size == 0 || (shorter >= 3 && memcmp(word, name, (size_t)shorter) == 0))
			continue;
		struct rb_nearest nearest = rb_nearest_to(word);
		rb_nearest_offer(&nearest, name, (size_t)name_size);
		if (apart <= allowed) {
			assert_string_equal(nearest.best, name);
			assert_int_equal(nearest.distance, apart);
			near++;
		} else {
			if (*nearest.best)
				fail_msg("'%s' and '%s' are %d apart", word, name, apart);
			far++;
		}
	}
	assert_true(near > 100 && far > 100);
}

static void the_order_of_offering_is_of_no_account(void **state)
{
	(void)state;
	for (uint64_t k = 0; k < 300; k++) {
		char word[8], names[6][8], first[96] = "", out[96];

		random_word(word, 5000 + 7 * k);
		for (uint64_t i = 0; i < 6; i++)
			random_word(names[i], 5001 + 7 * k + i);
		for (int turn = 0; turn < 12; turn++) {
			struct rb_nearest nearest = rb_nearest_to(word);

			for (int i = 0; i < 6; i++) {
				const char *name =
					names[turn < 6 ? (i + turn) % 6 : (17 - i - turn) % 6];
				rb_nearest_offer(&nearest, name, strlen(name));
			}
			rb_nearest_hint(&nearest, out);
			if (turn == 0)
				memcpy(first, out, sizeof first);
			assert_string_equal(out, first);
		}
	}
	assert_string_equal(hint_of("cat", (const char *const[]){"car", "bat", "hat", NULL}),
	                    " (did you mean 'bat'?)");
}

/* A name is as long as it is said to be; what has no room is left out whole. */
static void names_may_be_long_and_need_not_end(void **state)
{
	char word[300], name[300], out[96];

	(void)state;
	struct rb_nearest nearest = rb_nearest_to("radius");
	rb_nearest_offer(&nearest, "radius, mass", 6);
	assert_string_equal(nearest.best, "radius");
	assert_int_equal(nearest.distance, 0);

	memset(word, 'a', sizeof word);
	memset(name, 'a', sizeof name);
	word[sizeof word - 1] = '\0';
	nearest = rb_nearest_to(word);
	rb_nearest_offer(&nearest, name, 64);
	assert_string_equal(rb_nearest_hint(&nearest, out), "");
	rb_nearest_offer(&nearest, name, 63); /* what the long word begins with */
	assert_int_equal(strlen(nearest.best), 63);
	assert_int_equal(strlen(rb_nearest_hint(&nearest, out)),
	                 63 + strlen(" (did you mean ''?)"));
	nearest = rb_nearest_to("aab");
	rb_nearest_offer(&nearest, name, sizeof name);
	assert_string_equal(rb_nearest_hint(&nearest, out), "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(slips_of_the_pen_are_understood),
		cmocka_unit_test(capitals_do_not_count),
		cmocka_unit_test(cut_words_and_written_out_words_are_understood),
		cmocka_unit_test(what_is_far_from_all_gets_no_hint),
		cmocka_unit_test(a_name_is_near_when_few_edits_part_it),
		cmocka_unit_test(the_order_of_offering_is_of_no_account),
		cmocka_unit_test(names_may_be_long_and_need_not_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
