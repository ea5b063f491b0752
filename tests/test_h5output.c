/* SPDX-License-Identifier: MIT */
/* src/sink/h5output.c: the file under a recording, its names, its room on disk */
#include "support.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "sink/h5output.h"

struct place {
	char folder[256], path[300];
	struct rb_output output;
	struct rb_error err;
};

static void open_place(struct place *place)
{
	*place = (struct place){0};
	support_folder(place->folder);
	snprintf(place->path, sizeof place->path, "%s/run.h5", place->folder);
}

static void put(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void assert_text(const char *path, const char *wanted)
{
	char text[100] = "";
	FILE *file = fopen(path, "r");

	assert_non_null(file);
	(void)!fread(text, 1, sizeof text - 1, file);
	fclose(file);
	assert_string_equal(text, wanted);
}

/* How many files the folder holds. */
static int files_in(const struct place *place)
{
	DIR *const dir = opendir(place->folder);
	int count = 0;

	assert_non_null(dir);
	for (struct dirent *entry; (entry = readdir(dir));)
		count += *entry->d_name != '.';
	closedir(dir);
	return count;
}

static void close_place(struct place *place)
{
	unlink(place->path);
	assert_int_equal(rmdir(place->folder), 0);
}

/* What the library does: it makes the file under the name that it is given. */
static void make(struct place *place, unsigned how)
{
	struct rb_error err;

	assert_ok(rb_output_open(&place->output, place->path, how, &err));
	put(place->output.library, "new");
	assert_ok(rb_output_attach(&place->output, &err));
}

static void a_file_gets_its_name_when_it_is_published(void **state)
{
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	make(&place, 0);
	assert_int_equal(access(place.path, F_OK), -1);
	assert_int_equal(files_in(&place), 1);
	assert_ptr_equal(strstr(place.output.partial, "run.h5.partial-"), place.output.partial);
	assert_false(place.output.published);
	assert_false(rb_output_is_ours(&place.output));
	assert_ok(rb_output_publish(&place.output, &err));
	assert_ok(rb_output_publish(&place.output, &err));
	assert_true(place.output.published);
	assert_true(rb_output_is_ours(&place.output));
	assert_text(place.path, "new");
	/* the library's name leads to it by whatever it is called */
	assert_text(place.output.library, "new");
	rb_output_release(&place.output);
	rb_output_release(&place.output);
	assert_int_equal(files_in(&place), 1);
	close_place(&place);
}

static void what_was_never_published_is_removed(void **state)
{
	struct place place;

	(void)state;
	open_place(&place);
	put(place.path, "old");
	make(&place, RB_PLACE_REPLACE);
	assert_int_equal(files_in(&place), 2);
	rb_output_release(&place.output);
	assert_int_equal(files_in(&place), 1);
	assert_text(place.path, "old");
	/* opened, and the library never made it */
	struct rb_error err;
	assert_ok(rb_output_open(&place.output, place.path, RB_PLACE_REPLACE, &err));
	assert_int_equal(files_in(&place), 1);
	rb_output_release(&place.output);
	assert_int_equal(files_in(&place), 1);
	close_place(&place);
}

static void another_file_is_replaced_only_where_that_was_asked_for(void **state)
{
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	put(place.path, "old");
	assert_int_equal(rb_output_open(&place.output, place.path, 0, &place.err), RB_ERR_CREATE);
	assert_int_equal(files_in(&place), 1);
	make(&place, RB_PLACE_REPLACE);
	assert_ok(rb_output_publish(&place.output, &err));
	assert_text(place.path, "new");
	rb_output_release(&place.output);
	unlink(place.path);
	/* one that came while ours was being made */
	make(&place, 0);
	put(place.path, "theirs");
	assert_int_equal(rb_output_publish(&place.output, &place.err), RB_ERR_CREATE);
	assert_non_null(strstr(place.err.text, "run.h5"));
	rb_output_release(&place.output);
	assert_text(place.path, "theirs");
	assert_int_equal(files_in(&place), 1);
	close_place(&place);
	/* a folder that is not there */
	assert_int_equal(rb_output_open(&place.output, place.path, 0, &place.err), RB_ERR_CREATE);
	rb_output_release(&place.output);
}

static void only_one_writes_a_recording(void **state)
{
	struct place place, other = {0};
	struct rb_error err;

	(void)state;
	open_place(&place);
	make(&place, 0);
	assert_true(rb_output_lock(&place.output));
	assert_ok(rb_output_publish(&place.output, &err));
	assert_int_equal(rb_output_reopen(&other.output, place.path, 0, &other.err), RB_ERR_CREATE);
	assert_non_null(strstr(other.err.text, "the run that writes it goes on"));
	/* nor is it replaced meanwhile, even by who may replace files */
	assert_int_equal(rb_output_open(&other.output, place.path, RB_PLACE_REPLACE, &other.err),
	                 RB_ERR_CREATE);
	assert_non_null(strstr(other.err.text, "the run that writes it goes on"));
	rb_output_release(&place.output);
	assert_ok(rb_output_reopen(&other.output, place.path, 0, &err));
	assert_true(other.output.published && rb_output_is_ours(&other.output));
	rb_output_release(&other.output);
	assert_text(place.path, "new"); /* it was published: it stays */
	assert_int_equal(chmod(place.path, 0400), 0);
	if (geteuid() != 0) /* whom nothing is forbidden */
		assert_int_equal(rb_output_reopen(&other.output, place.path, 0, &other.err),
		                 RB_ERR_CREATE);
	unlink(place.path);
	assert_int_equal(rb_output_reopen(&other.output, place.path, 0, &other.err), RB_ERR_CREATE);
	assert_non_null(strstr(other.err.text, "No such file"));
	assert_int_equal(symlink("/dev/null", place.path), 0);
	assert_int_equal(rb_output_reopen(&other.output, place.path, 0, &other.err), RB_ERR_CREATE);
	assert_non_null(strstr(other.err.text, "it is a symbolic link"));
	close_place(&place);
}

/* Who reads the old one goes on with it. */
static void other_bytes_take_its_name_in_one_step(void **state)
{
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	make(&place, 0);
	assert_ok(rb_output_publish(&place.output, &err));
	FILE *reader = fopen(place.path, "r");
	assert_non_null(reader);
	assert_int_equal(rb_output_replace(&place.output, "compact", 7), 0);
	assert_text(place.path, "compact");
	assert_int_equal(fgetc(reader), 'n');
	fclose(reader);
	assert_int_equal(files_in(&place), 1);
	/* the file that is held open is not the one of that name any more */
	assert_false(rb_output_is_ours(&place.output));
	rb_output_release(&place.output);
	close_place(&place);
}

static void room_is_taken_and_given_back(void **state)
{
	struct place place;
	struct rb_error err;
	struct stat found;

	(void)state;
	open_place(&place);
	make(&place, 0);
	assert_ok(rb_output_publish(&place.output, &err));
	assert_int_equal(rb_output_reserve(&place.output, 3, 100000), 0);
	/* it is as long as it was, whatever room it has */
	assert_int_equal(fstat(place.output.fd, &found), 0);
	assert_int_equal(found.st_size, 3);
	if (!place.output.cannot_reserve) {
		assert_true(place.output.reserved_bytes >= 100003);
		assert_true(found.st_blocks * 512 >= 100003);
	}
	rb_output_release(&place.output);
	assert_int_equal(stat(place.path, &found), 0);
	assert_int_equal(found.st_size, 3);
	assert_true(found.st_blocks * 512 < 100000);
	close_place(&place);
}

/* In a process of its own, where no file may be longer than 64 KiB. */
static void what_the_system_does_not_give_is_told_before_it_is_written(void **state)
{
	struct place place;
	struct rb_error err;
	int outcome = 0;

	(void)state;
	open_place(&place);
	make(&place, 0);
	assert_ok(rb_output_publish(&place.output, &err));
	const pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		const struct rlimit limit = {65536, 65536};

		signal(SIGXFSZ, SIG_IGN);
		if (setrlimit(RLIMIT_FSIZE, &limit) != 0)
			_exit(2);
		const bool fits = rb_output_reserve(&place.output, 3, 60000) == 0;
		const int number = rb_output_reserve(&place.output, 60000, 10000);
		_exit(fits && (number == EFBIG || place.output.cannot_reserve) ? 0 : 1);
	}
	assert_int_equal(waitpid(child, &outcome, 0), child);
	assert_int_equal(outcome, 0);
	rb_output_release(&place.output);
	close_place(&place);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_file_gets_its_name_when_it_is_published),
		cmocka_unit_test(what_was_never_published_is_removed),
		cmocka_unit_test(another_file_is_replaced_only_where_that_was_asked_for),
		cmocka_unit_test(only_one_writes_a_recording),
		cmocka_unit_test(other_bytes_take_its_name_in_one_step),
		cmocka_unit_test(room_is_taken_and_given_back),
		cmocka_unit_test(what_the_system_does_not_give_is_told_before_it_is_written),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
