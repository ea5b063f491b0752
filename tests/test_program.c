/* SPDX-License-Identifier: MIT */
/* src/base/program.h: where the running program is */
#include "support.h"

#include <limits.h>
#include <sys/stat.h>

#include "base/program.h"

static void the_path_is_that_of_the_file_that_runs(void **state)
{
	char path[PATH_MAX];
	struct rb_error err;
	struct stat named, running;

	(void)state;
	assert_ok(rb_program_path(path, &err));
	assert_true(path[0] == '/');
	assert_string_equal(strrchr(path, '/') + 1, "test_program");
	assert_int_equal(stat(path, &named), 0);
	assert_int_equal(stat(RB_PROGRAM_AGAIN, &running), 0);
	assert_true(named.st_ino == running.st_ino && named.st_dev == running.st_dev);
}

static void beside_it_is_its_folder_and_the_name(void **state)
{
	char path[PATH_MAX], beside[PATH_MAX];
	struct rb_error err;

	(void)state;
	assert_ok(rb_program_path(path, &err));
	assert_true(rb_program_beside("test_program", beside, sizeof beside));
	assert_string_equal(beside, path);
	assert_true(rb_program_beside("../share/x", beside, sizeof beside));
	strcpy(strrchr(path, '/') + 1, "../share/x");
	assert_string_equal(beside, path);
}

static void a_path_that_does_not_fit_is_not_written(void **state)
{
	char beside[PATH_MAX], small[PATH_MAX];

	(void)state;
	assert_true(rb_program_beside("name", beside, sizeof beside));
	const size_t needed = strlen(beside) + 1;
	strcpy(small, "before");
	assert_false(rb_program_beside("name", small, needed - 1));
	assert_string_equal(small, "before");
	assert_true(rb_program_beside("name", small, needed));
	assert_string_equal(small, beside);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_path_is_that_of_the_file_that_runs),
		cmocka_unit_test(beside_it_is_its_folder_and_the_name),
		cmocka_unit_test(a_path_that_does_not_fit_is_not_written),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
