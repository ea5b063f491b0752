/* SPDX-License-Identifier: MIT */
/* src/base/outfile.c: files that have their names when they are whole */
#include "support.h"

#include <dirent.h>
#include <errno.h>
#include <sys/stat.h>

#include "base/outfile.h"

/* How many names the folder has. */
static int names_in(const char *at)
{
	DIR *const open = opendir(at);
	int count = -2; /* . and .. */

	assert_non_null(open);
	while (readdir(open))
		count++;
	closedir(open);
	return count;
}

static const char *text_of(const char *name, char to[64])
{
	FILE *const file = fopen(name, "r");

	if (!file)
		return NULL;
	to[fread(to, 1, 63, file)] = '\0';
	fclose(file);
	return to;
}

static void write_text(const char *name, const char *wanted)
{
	FILE *const file = fopen(name, "w");

	assert_non_null(file);
	fputs(wanted, file);
	fclose(file);
}

static const char *in(const char *at, const char *name, char to[320])
{
	snprintf(to, 320, "%s/%s", at, name);
	return to;
}

/* A folder for each test, and the name of a file in it. */
static char folder[256], path[320], text[64];
static struct rb_outfile out;
static struct rb_error err;

static void place(void **state, const char *name)
{
	(void)state;
	out = (struct rb_outfile){.file = NULL};
	in(support_folder(folder), name, path);
}

static void a_file_has_its_name_when_it_is_published_and_not_before(void **state)
{
	place(state, "a.txt");
	assert_ok(rb_outfile_open(&out, path, 0, &err));
	fputs("whole", out.file);
	assert_null(text_of(path, text));
	assert_int_equal(names_in(folder), 1); /* under another */
	assert_ok(rb_outfile_publish(&out, &err));
	assert_string_equal(text_of(path, text), "whole");
	assert_int_equal(names_in(folder), 1);
	rb_outfile_release(&out); /* safe once more */
	assert_string_equal(text_of(path, text), "whole");
}

static void nothing_stays_of_a_file_that_was_given_up(void **state)
{
	place(state, "a.txt");
	assert_ok(rb_outfile_open(&out, path, 0, &err));
	fputs("part", out.file);
	rb_outfile_release(&out);
	assert_int_equal(names_in(folder), 0);
	struct rb_outfile zero = {.file = NULL};
	rb_outfile_release(&zero);
}

static void a_name_that_is_taken_is_replaced_only_where_that_is_wanted(void **state)
{
	place(state, "a.txt");
	write_text(path, "old");
	assert_int_equal(rb_outfile_check(path, 0, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, path));
	assert_int_equal(rb_outfile_open(&out, path, 0, &err), RB_ERR_CREATE);
	assert_null(out.file);
	assert_string_equal(text_of(path, text), "old");
	assert_ok(rb_outfile_check(path, RB_PLACE_REPLACE, &err));
	assert_ok(rb_outfile_open(&out, path, RB_PLACE_REPLACE, &err));
	fputs("new", out.file);
	assert_string_equal(text_of(path, text), "old"); /* until it is whole */
	assert_ok(rb_outfile_publish(&out, &err));
	assert_string_equal(text_of(path, text), "new");
	assert_int_equal(names_in(folder), 1);
}

/* Somebody else was quicker: that file stays. */
static void a_name_that_is_taken_meanwhile_is_not_replaced(void **state)
{
	place(state, "a.txt");
	assert_ok(rb_outfile_open(&out, path, 0, &err));
	write_text(path, "other");
	assert_int_equal(rb_outfile_publish(&out, &err), RB_ERR_CREATE);
	assert_string_equal(text_of(path, text), "other");
	assert_int_equal(names_in(folder), 1);
}

static void what_is_no_regular_file_is_never_replaced(void **state)
{
	place(state, "sub");
	assert_int_equal(mkdir(path, 0700), 0);
	assert_int_equal(rb_outfile_check(path, RB_PLACE_REPLACE, &err), RB_ERR_CREATE);
}

static void probing_says_whether_a_file_could_be_made_and_leaves_nothing(void **state)
{
	place(state, "a.txt");
	assert_ok(rb_outfile_probe(in(folder, "a.txt", path), 0, &err));
	assert_ok(rb_outfile_probe(in(folder, "new/deep/a.txt", path), 0, &err));
	assert_int_equal(names_in(folder), 0);
	write_text(in(folder, "file", path), "");
	assert_int_equal(rb_outfile_probe(in(folder, "file/a.txt", path), 0, &err), RB_ERR_CREATE);
	assert_int_equal(names_in(folder), 1);
}

static void folders_above_a_name_are_made(void **state)
{
	place(state, "new/deep/a.txt");
	assert_int_equal(rb_outfile_open(&out, path, 0, &err), RB_ERR_CREATE);
	assert_ok(rb_outfile_folders(path, 0, &err));
	assert_ok(rb_outfile_open(&out, path, 0, &err));
	assert_ok(rb_outfile_publish(&out, &err));
	assert_int_equal(access(path, R_OK), 0);
}

/* /dev/full takes nothing: what was written is lost at once, or when it is flushed. */
static void a_write_that_fails_shows_when_the_file_is_published(void **state)
{
	place(state, "a.txt");
	for (int buffered = 0; buffered < 2; buffered++) {
		assert_ok(rb_outfile_open(&out, path, 0, &err));
		if (!freopen("/dev/full", "w", out.file)) {
			out.file = NULL;
			rb_outfile_release(&out);
			skip();
		}
		if (!buffered)
			setvbuf(out.file, NULL, _IONBF, 0);
		fputs("lost", out.file);
		assert_int_equal(rb_outfile_publish(&out, &err), RB_ERR_IO);
		assert_non_null(strstr(err.text, "cannot write '"));
		assert_non_null(strstr(err.text, strerror(ENOSPC)));
		assert_int_equal(names_in(folder), 0);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_file_has_its_name_when_it_is_published_and_not_before),
		cmocka_unit_test(nothing_stays_of_a_file_that_was_given_up),
		cmocka_unit_test(a_name_that_is_taken_is_replaced_only_where_that_is_wanted),
		cmocka_unit_test(a_name_that_is_taken_meanwhile_is_not_replaced),
		cmocka_unit_test(what_is_no_regular_file_is_never_replaced),
		cmocka_unit_test(probing_says_whether_a_file_could_be_made_and_leaves_nothing),
		cmocka_unit_test(folders_above_a_name_are_made),
		cmocka_unit_test(a_write_that_fails_shows_when_the_file_is_published),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
