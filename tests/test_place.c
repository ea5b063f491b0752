/* SPDX-License-Identifier: MIT */
#include "support.h"

#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/place.h"

static char folder[256];

static const char *in_folder(char path[600], const char *name)
{
	snprintf(path, 600, "%s/%s", folder, name);
	return path;
}

static int make_folder(void **state)
{
	(void)state;
	support_folder(folder);
	return chdir(folder);
}

/* What a scene names stays below, whatever stands in its way; what users name may lead on. */
static void links_are_followed_where_the_user_has_named_them(void **state)
{
	static const struct {
		const char *path;
		unsigned how;
		enum rb_status status;
	} cases[] = {
		{"a/b/x", RB_PLACE_BENEATH, RB_OK},
		{"a/./b//x", RB_PLACE_BENEATH, RB_OK},
		{"x", RB_PLACE_BENEATH, RB_OK},
		{"a/link/x", RB_PLACE_BENEATH, RB_ERR_CREATE},
		{"a/self/b/x", RB_PLACE_BENEATH, RB_ERR_CREATE},
		{"a/none/x", RB_PLACE_BENEATH | RB_PLACE_MAKE, RB_ERR_CREATE},
		{"a/../x", RB_PLACE_BENEATH, RB_ERR_CREATE},
		{"/tmp/x", RB_PLACE_BENEATH, RB_ERR_CREATE},
		{"a/link/x", 0, RB_OK},
		{"a/../x", 0, RB_OK},
		{"/x", 0, RB_OK},
		{"a/link/b/x", RB_PLACE_BELOW(6), RB_OK},
		{"a/link/back/x", RB_PLACE_BELOW(6), RB_ERR_CREATE},
		{"a", 0, RB_OK},
		{"a/", 0, RB_ERR_CREATE},
		{"a/..", 0, RB_ERR_CREATE},
		{"", 0, RB_ERR_CREATE},
	};
	struct rb_place place;
	struct rb_error err;
	struct stat found;
	char path[600];

	(void)state;
	assert_int_equal(mkdir("a", 0777) | mkdir("a/b", 0777) | mkdir("out", 0777) |
	                         mkdir("out/b", 0777),
	                 0);
	assert_int_equal(symlink("../out", "a/link") | symlink(".", "a/self") |
	                         symlink("../out/none", "a/none") | symlink("..", "out/back"),
	                 0);
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		if (rb_place_open(&place, cases[i].path, cases[i].how, &err) != cases[i].status)
			fail_msg("'%s'", cases[i].path);
		rb_place_release(&place);
	}
	assert_int_not_equal(stat(in_folder(path, "out/none"), &found), 0);
}

/* A folder that is a link by now changes nothing. */
static void the_folder_is_the_one_that_was_found(void **state)
{
	char name[RB_PLACE_NAME_SIZE];
	struct rb_place place;
	struct rb_error err;
	struct stat found;

	(void)state;
	assert_int_equal(mkdir("first", 0777) | mkdir("other", 0777), 0);
	assert_ok(rb_place_open(&place, "first/file", 0, &err));
	assert_int_equal(rename("first", "moved") | symlink("other", "first"), 0);
	const int file = rb_place_create(&place, "", name);
	assert_true(file >= 0);
	close(file);
	assert_ok(rb_place_publish(&place, name, &err));
	rb_place_release(&place);
	assert_int_equal(stat("moved/file", &found), 0);
	assert_int_not_equal(stat("other/file", &found), 0);
}

/* Two of them differ, and one that stays behind is found again. */
static void names_of_new_files_differ_and_are_tidied(void **state)
{
	char name[3][RB_PLACE_NAME_SIZE];
	struct rb_place place;
	struct rb_error err;
	struct stat found;

	(void)state;
	assert_ok(rb_place_open(&place, "run.h5", 0, &err));
	for (int i = 0; i < 3; i++) {
		const int file = rb_place_create(&place, i < 2 ? ".more" : ".else", name[i]);
		assert_true(file >= 0);
		close(file);
	}
	assert_string_not_equal(name[0], name[1]);
	rb_place_tidy(&place, ".more");
	assert_int_not_equal(stat(name[0], &found), 0);
	assert_int_not_equal(stat(name[1], &found), 0);
	assert_int_equal(stat(name[2], &found), 0);
	rb_place_release(&place);
}

/* Up to the system's limit, and what stands beside it then has room, too: another one for another name. */
static void the_longest_names_are_possible(void **state)
{
	char longest[NAME_MAX + 2], name[RB_PLACE_NAME_SIZE], other[RB_PLACE_NAME_SIZE];
	struct rb_place place;
	struct rb_error err;

	(void)state;
	memset(longest, 'x', sizeof longest);
	longest[NAME_MAX + 1] = '\0';
	assert_int_equal(rb_place_open(&place, longest, 0, &err), RB_ERR_CREATE);
	longest[NAME_MAX] = '\0';
	for (int i = 0; i < 2; i++) {
		/* characters of several bytes are not cut */
		for (int k = 0; i == 1 && k + 1 < NAME_MAX; k += 2)
			memcpy(longest + k, "\xc3\xa4", 2);
		assert_ok(rb_place_open(&place, longest, 0, &err));
		assert_true(strlen(rb_place_beside(&place, ".checkpoint~", name)) <= NAME_MAX);
		for (const char *at = name; i == 1 && (unsigned char)*at >= 0x80; at += 2)
			assert_memory_equal(at, "\xc3\xa4", 2);
		assert_string_not_equal(name, rb_place_beside(&place, ".checkpoint", other));
		const int file = rb_place_create(&place, ".checkpoint", name);
		assert_true(file >= 0);
		close(file);
		assert_int_equal(rb_place_rename(&place, name, other), 0);
		rb_place_remove(&place, other);
		rb_place_release(&place);
		longest[0] = 'y';
		assert_ok(rb_place_open(&place, longest, 0, &err));
		assert_string_not_equal(other, rb_place_beside(&place, ".checkpoint", name));
		rb_place_release(&place);
	}
}

static void no_memory_is_an_error(void **state)
{
	const struct rb_memory_counts before = rb_memory_counts();
	struct rb_place place;
	int failures = 0;

	(void)state;
	for (uint64_t k = 1;; k++, failures++) {
		rb_memory_fail_at(k);
		const enum rb_status status = rb_place_open(&place, "a/x", 0, NULL);
		rb_memory_fail_at(0);
		rb_place_release(&place);
		if (!status)
			break;
		assert_int_equal(status, RB_ERR_MEMORY);
	}
	assert_int_equal(failures, 2);
	const struct rb_memory_counts after = rb_memory_counts();
	assert_int_equal(after.taken - before.taken, after.freed - before.freed);
}

/* A recording has a lock while it is made: a whole one, of an open file, which belongs to no process. */
static void a_file_is_written_as_long_as_its_lock_is_held(void **state)
{
	struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
	char path[600];
	const int writer = open(in_folder(path, "locked"), O_RDWR | O_CREAT, 0600);
	const int reader = open(path, O_RDONLY);

	(void)state;
	assert_true(writer >= 0 && reader >= 0);
	assert_false(rb_place_is_written(reader));
	assert_int_equal(fcntl(writer, F_OFD_SETLK, &lock), 0);
	assert_true(rb_place_is_written(reader));
	close(writer);
	assert_false(rb_place_is_written(reader));
	close(reader);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(links_are_followed_where_the_user_has_named_them),
		cmocka_unit_test(the_folder_is_the_one_that_was_found),
		cmocka_unit_test(names_of_new_files_differ_and_are_tidied),
		cmocka_unit_test(the_longest_names_are_possible),
		cmocka_unit_test(no_memory_is_an_error),
		cmocka_unit_test(a_file_is_written_as_long_as_its_lock_is_held),
	};

	return cmocka_run_group_tests(tests, make_folder, NULL);
}
