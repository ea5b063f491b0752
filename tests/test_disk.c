/* SPDX-License-Identifier: MIT */
/* src/script/disk.c: files of a scene: where they may be, and their bytes */
#include "support.h"

#include <sys/stat.h>

#include "math/random.h"
#include "script/disk.h"

struct place {
	char folder[256];
	struct rb_script script;
	struct rb_error err;
};

/* A folder with a scene's folder `in` and a file `out.txt` beside it. */
static void open_place(struct place *place)
{
	char path[300];

	*place = (struct place){0};
	support_folder(place->folder);
	snprintf(path, sizeof path, "%s/in", place->folder);
	assert_int_equal(mkdir(path, 0700), 0);
	place->script.folder = rb_memory_copy_text(path);
}

static const char *path_in(const struct place *place, const char *name)
{
	static char path[400];

	snprintf(path, sizeof path, "%s/%s", place->folder, name);
	return path;
}

static void put(const struct place *place, const char *name, const void *bytes, size_t size)
{
	FILE *file = fopen(path_in(place, name), "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static void close_place(struct place *place)
{
	static const char *const names[] = {"in/a.txt", "in/sub/b.txt", "in/link", "in/inner",
	                                    "in/pipe",  "in/sub",       "in",      "in2/c.txt",
	                                    "in2",      "out.txt"};

	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		(void)remove(path_in(place, names[i]));
	assert_int_equal(rmdir(place->folder), 0);
	rb_disk_forget(&place->script);
	rb_memory_free(place->script.folder);
}

static void a_path_that_stays_has_no_way_up(void **state)
{
	static const char *const stay[] = {"a",    "a/b.png", ".",      "./a",   "a/./b",
	                                   "..a",  "a..",     "a/..b",  "a/b..", "...",
	                                   "a//b", "a/",      "a/.../b"};
	static const char *const leave[] = {"",     "/",     "/etc/passwd", "..",
	                                    "../a", "a/..",  "a/../b",      "a/../",
	                                    "./..", "a//..", "../",         "//"};

	(void)state;
	for (size_t i = 0; i < sizeof stay / sizeof *stay; i++)
		if (!rb_disk_path_stays(stay[i]))
			fail_msg("'%s' does not stay", stay[i]);
	for (size_t i = 0; i < sizeof leave / sizeof *leave; i++)
		if (rb_disk_path_stays(leave[i]))
			fail_msg("'%s' stays", leave[i]);
}

/* By the definition: split at '/', no part is "..". */
static void random_paths_stay_as_their_parts_say(void **state)
{
	int left = 0;

	(void)state;
	for (uint64_t k = 0; k < 20000; k++) {
		char path[10], copy[10], *rest = copy;
		const size_t size = 1 + rb_random_bits(1, k, 0) % 8;
		bool stays;

		for (size_t i = 0; i < size; i++)
			path[i] = "../a."[rb_random_bits(1, k, i + 1) % 5];
		path[size] = '\0';
		stays = path[0] != '/';
		memcpy(copy, path, sizeof copy);
		for (char *part; (part = strsep(&rest, "/"));)
			stays = stays && strcmp(part, "..") != 0;
		if (rb_disk_path_stays(path) != stays)
			fail_msg("'%s'", path);
		left += !stays;
	}
	assert_in_range(left, 1000, 19000);
}

static void a_file_is_read_whole_with_a_zero_behind_it(void **state)
{
	static unsigned char bytes[100000];
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	for (size_t i = 0; i < sizeof bytes; i++)
		bytes[i] = (unsigned char)rb_random_bits(2, 0, i);
	static const size_t sizes[] = {0, 1, 16383, 16384, 16385, 32767, 32768, sizeof bytes};
	for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
		put(&place, "in/a.txt", bytes, sizes[i]);
		assert_ok(rb_disk_read(&place.script, path_in(&place, "in/a.txt"), &rb_disk_module,
		                       &err));
		assert_int_equal(place.script.reading_size, sizes[i]);
		assert_memory_equal(place.script.reading, bytes, sizes[i]);
		assert_int_equal(place.script.reading[sizes[i]], 0);
	}
	rb_disk_forget(&place.script);
	assert_null(place.script.reading);
	assert_int_equal(place.script.reading_size, 0);
	rb_disk_forget(&place.script);
	close_place(&place);
}

static void assert_unread(struct place *place, const char *name, const struct rb_disk_limit *limit,
                          const char *part)
{
	const char *path = path_in(place, name);

	assert_int_equal(rb_disk_read(&place->script, path, limit, &place->err), RB_ERR_INPUT);
	if (!strstr(place->err.text, part) || !strstr(place->err.text, name))
		fail_msg("'%s' has no '%s'", place->err.text, part);
	assert_null(place->script.reading);
	assert_int_equal(place->script.reading_size, 0);
}

static void what_cannot_be_read_is_told_and_leaves_nothing(void **state)
{
	static const struct rb_disk_limit small = {(size_t)1 << 20, false};
	struct place place;
	struct rb_error err;

	(void)state;
	open_place(&place);
	assert_unread(&place, "in/none", &rb_disk_scene, "No such file");
	assert_unread(&place, "in", &rb_disk_scene, "Is a directory");
	assert_unread(&place, "in", &rb_disk_module, "Is a directory");
	assert_int_equal(mkfifo(path_in(&place, "in/pipe"), 0600), 0);
	assert_unread(&place, "in/pipe", &rb_disk_module, "not a regular file");
	assert_unread(&place, "in/pipe", &rb_disk_texture, "not a regular file");

	char *bytes = rb_memory_take(((size_t)1 << 20) + 1, 1);
	assert_non_null(bytes);
	put(&place, "in/a.txt", bytes, (size_t)1 << 20);
	assert_ok(rb_disk_read(&place.script, path_in(&place, "in/a.txt"), &small, &err));
	assert_int_equal(place.script.reading_size, (size_t)1 << 20);
	put(&place, "in/a.txt", bytes, ((size_t)1 << 20) + 1);
	assert_unread(&place, "in/a.txt", &small, "it has more than 1 MiB");
	rb_memory_free(bytes);
	assert_true(rb_disk_scene.pipes);
	assert_false(rb_disk_module.pipes || rb_disk_texture.pipes);
	close_place(&place);
}

static void no_memory_is_told_as_such(void **state)
{
	struct place place;

	(void)state;
	open_place(&place);
	put(&place, "in/a.txt", "abc", 3);
	const char *path = path_in(&place, "in/a.txt");
	rb_memory_fail_at(1);
	const enum rb_status status = rb_disk_read(&place.script, path, &rb_disk_scene, &place.err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_null(place.script.reading);
	close_place(&place);
}

static void files_are_found_in_the_folder_and_not_behind_links_out_of_it(void **state)
{
	char path[RB_DISK_PATH_SIZE];
	struct place place;

	(void)state;
	open_place(&place);
	put(&place, "out.txt", "x", 1);
	put(&place, "in/a.txt", "x", 1);
	assert_int_equal(mkdir(path_in(&place, "in/sub"), 0700), 0);
	put(&place, "in/sub/b.txt", "x", 1);
	assert_int_equal(symlink("../out.txt", path_in(&place, "in/link")), 0);
	assert_int_equal(symlink("sub/b.txt", path_in(&place, "in/inner")), 0);
	/* a folder whose name only begins like the scene's */
	assert_int_equal(mkdir(path_in(&place, "in2"), 0700), 0);
	put(&place, "in2/c.txt", "x", 1);

	assert_true(rb_disk_find(&place.script, "a.txt", path));
	assert_string_equal(path, path_in(&place, "in/a.txt"));
	assert_true(rb_disk_find(&place.script, "sub/b.txt", path));
	assert_true(rb_disk_find(&place.script, "inner", path));
	assert_false(rb_disk_find(&place.script, "b.txt", path));
	assert_false(rb_disk_find(&place.script, "link", path));
	assert_false(rb_disk_find(&place.script, "../out.txt", path));
	assert_false(rb_disk_find(&place.script, "../in2/c.txt", path));
	assert_false(rb_disk_find(&place.script, "/dev/null", path));

	place.script.sandbox.trust = true;
	assert_true(rb_disk_find(&place.script, "link", path));
	assert_true(rb_disk_find(&place.script, "../out.txt", path));
	assert_true(rb_disk_find(&place.script, "/dev/null", path));
	assert_string_equal(path, "/dev/null");
	assert_false(rb_disk_find(&place.script, "none", path));
	close_place(&place);
}

static void a_name_without_room_is_not_found(void **state)
{
	static char name[RB_DISK_PATH_SIZE + 10], path[RB_DISK_PATH_SIZE];
	struct place place;

	(void)state;
	open_place(&place);
	memset(name, 'a', sizeof name - 1);
	assert_false(rb_disk_find(&place.script, name, path));
	/* many times here: as long as it may be, and the file is there */
	put(&place, "in/a.txt", "x", 1);
	const size_t used = strlen(place.script.folder) + 1 + strlen("a.txt");
	size_t size = 0;
	while (used + size + 2 < RB_DISK_PATH_SIZE) {
		memcpy(name + size, "./", 2);
		size += 2;
	}
	memcpy(name + size, "a.txt", sizeof "a.txt");
	assert_true(rb_disk_find(&place.script, name, path));
	assert_true(strlen(path) < RB_DISK_PATH_SIZE);
	memcpy(name + size, "./a.txt", sizeof "./a.txt");
	assert_false(rb_disk_find(&place.script, name, path));
	close_place(&place);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_path_that_stays_has_no_way_up),
		cmocka_unit_test(random_paths_stay_as_their_parts_say),
		cmocka_unit_test(a_file_is_read_whole_with_a_zero_behind_it),
		cmocka_unit_test(what_cannot_be_read_is_told_and_leaves_nothing),
		cmocka_unit_test(no_memory_is_told_as_such),
		cmocka_unit_test(files_are_found_in_the_folder_and_not_behind_links_out_of_it),
		cmocka_unit_test(a_name_without_room_is_not_found),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
