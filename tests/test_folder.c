/* SPDX-License-Identifier: MIT */
/* src/sweep/folder.c: the files of a sweep, written, read back and damaged */
#include "support.h"

#include <ftw.h>
#include <sys/stat.h>

#include "base/hash.h"
#include "math/random.h"
#include "sweep/folder.h"

static struct rb_source_file file_of(const char *name, const char *text)
{
	struct rb_source_file file = {.name = name, .text = text, .size_bytes = strlen(text)};

	rb_hash_sha256(text, file.size_bytes, file.sha256);
	return file;
}

static int drop(const char *path, const struct stat *about, int kind, struct FTW *walk)
{
	(void)about, (void)kind, (void)walk;
	return remove(path);
}

static void drop_folder(const char *folder)
{
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

static const char *path_in(const char *folder, const char *name)
{
	static char path[RB_FOLDER_PATH_SIZE];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void put(const char *folder, const char *name, const char *text, size_t size)
{
	FILE *file = fopen(path_in(folder, name), "wb");

	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

/* A sweep of six points over a scene, a module beside it, a helper and a picture. */
struct sweep {
	char top[256], folder[300];
	struct rb_source_file files[4];
	struct rb_plan plan;
	struct rb_error err;
};

static void open_sweep(struct sweep *sweep)
{
	static const char *const params[] = {"a=0:0.2:0.1", "b=x,\"y\" # z"};
	const struct rb_plan_wish wish = {.version = "7",
	                                  .scene = "s.lua",
	                                  .params = params,
	                                  .param_count = 2,
	                                  .seeds = 1,
	                                  .base_seed = 3,
	                                  .records = true};
	bool there = false;

	*sweep = (struct sweep){.files = {file_of("s.lua", "return 1"),
	                                  file_of("parts.deep.wall", "return 2"),
	                                  file_of("rbsim.pile", "return 3"),
	                                  file_of("pictures/face.png", "not one")}};
	snprintf(sweep->folder, sizeof sweep->folder, "%s/sweep", support_folder(sweep->top));
	if (rb_plan_init(&sweep->plan, &wish, sweep->files, 4, &sweep->err) ||
	    rb_folder_write(sweep->folder, &sweep->plan, sweep->files, &there, &sweep->err))
		fail_msg("%s", sweep->err.text);
	assert_false(there);
}

static void close_sweep(struct sweep *sweep)
{
	rb_plan_release(&sweep->plan);
	drop_folder(sweep->top);
}

static void every_file_of_the_scene_has_its_copy(void **state)
{
	static const char *const names[] = {"scene/s.lua", "scene/parts/deep/wall.lua",
	                                    "lua/rbsim/pile.lua", "scene/pictures/face.png"};
	struct sweep sweep;
	struct rb_error err;
	char *text;
	size_t size;

	(void)state;
	open_sweep(&sweep);
	for (int i = 0; i < 4; i++) {
		assert_ok(rb_folder_read(path_in(sweep.folder, names[i]), 100, &text, &size, &err));
		assert_int_equal(size, sweep.files[i].size_bytes);
		assert_string_equal(text, sweep.files[i].text);
		rb_memory_free(text);
	}
	close_sweep(&sweep);
}

/* A scene that was trusted may name pictures anywhere; a sweep writes into its folder only. */
static void files_that_lie_outside_of_the_scene_are_not_copied(void **state)
{
	const struct rb_source_file files[] = {file_of("s.lua", ""), file_of("../out.png", "x"),
	                                       file_of("a/../../out.PNG", "x"),
	                                       file_of("/tmp/rbsim-never.png", "x")};
	const struct rb_plan_wish wish = {.version = "7", .scene = "s.lua", .seeds = 1};
	struct rb_plan plan, back;
	struct rb_error err;
	char top[256], folder[300];
	bool there;

	(void)state;
	snprintf(folder, sizeof folder, "%s/sweep", support_folder(top));
	assert_ok(rb_plan_init(&plan, &wish, files, 4, &err));
	assert_ok(rb_folder_write(folder, &plan, files, &there, &err));
	assert_int_equal(access(path_in(top, "out.png"), F_OK), -1);
	assert_int_equal(access(path_in(top, "out.PNG"), F_OK), -1);
	assert_int_equal(access(path_in(folder, "out.png"), F_OK), -1);
	assert_int_equal(access("/tmp/rbsim-never.png", F_OK), -1);
	assert_ok(rb_folder_load(folder, &back, "7", &err));
	assert_int_equal(back.file_count, 4);
	assert_string_equal(back.files[3].name, "/tmp/rbsim-never.png");
	rb_plan_release(&back);
	rb_plan_release(&plan);
	drop_folder(top);
}

static void what_is_loaded_is_what_was_planned(void **state)
{
	struct sweep sweep;
	struct rb_plan back;
	struct rb_error err;

	(void)state;
	open_sweep(&sweep);
	assert_ok(rb_folder_load(sweep.folder, &back, "7", &err));
	assert_ok(rb_folder_check(sweep.folder, &back, true, &err));
	assert_int_equal(back.count, 6);
	assert_true(back.records && !back.films);
	assert_int_equal(back.line_count, sweep.plan.line_count);
	for (int i = 0; i < back.line_count; i++)
		assert_string_equal(back.lines[i], sweep.plan.lines[i]);
	for (uint64_t k = 0; k < 6; k++)
		assert_true(rb_plan_seed(&back, k) == rb_plan_seed(&sweep.plan, k));
	rb_plan_release(&back);
	/* who would run other points is told what differs */
	const char *const params[] = {"a=0:0.2:0.1", "b=x,y"};
	const struct rb_plan_wish wish = {.version = "7",
	                                  .scene = "s.lua",
	                                  .params = params,
	                                  .param_count = 2,
	                                  .seeds = 1,
	                                  .base_seed = 3,
	                                  .records = true};
	assert_ok(rb_plan_init(&back, &wish, sweep.files, 4, &err));
	assert_int_equal(rb_folder_check(sweep.folder, &back, false, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "it has '# param b=x,\"y\" # z' where this one has "
	                                 "'# param b=x,y' (-o takes another folder)"));
	rb_plan_release(&back);
	sweep.files[2] = file_of("rbsim.pile", "return 4");
	assert_ok(rb_plan_init(&back, &wish, sweep.files, 4, &err));
	assert_int_equal(rb_folder_check(sweep.folder, &back, false, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "'rbsim.pile' has changed since"));
	rb_plan_release(&back);
	close_sweep(&sweep);
}

/* Rows changed, taken away, added: only the head is read where nothing else is asked. */
static void rows_are_compared_where_that_is_asked_for(void **state)
{
	struct sweep sweep;
	struct rb_error err;
	char *text, changed[4096];
	size_t size;

	(void)state;
	open_sweep(&sweep);
	assert_ok(rb_folder_read(path_in(sweep.folder, RB_FOLDER_PLAN), 4000, &text, &size, &err));
	char *const last = strrchr(text, '\n') - 1;
	for (int how = 0; how < 3; how++) {
		size_t length = size;

		memcpy(changed, text, size);
		if (how == 0)
			changed[last - text] ^= 1;
		else if (how == 1)
			length -= 20;
		else
			changed[length++] = '\n';
		put(sweep.folder, RB_FOLDER_PLAN, changed, length);
		assert_int_equal(rb_folder_check(sweep.folder, &sweep.plan, true, &err),
		                 RB_ERR_INPUT);
		assert_ok(rb_folder_check(sweep.folder, &sweep.plan, false, &err));
	}
	put(sweep.folder, RB_FOLDER_PLAN, text, size);
	assert_ok(rb_folder_check(sweep.folder, &sweep.plan, true, &err));
	rb_memory_free(text);
	close_sweep(&sweep);
}

/* Bytes changed, taken away, doubled: a stated status, and a plan that can be released. */
static void damaged_plans_do_no_harm(void **state)
{
	struct sweep sweep;
	struct rb_error err;
	char *text, changed[4096];
	size_t size;
	int good = 0, bad = 0;

	(void)state;
	open_sweep(&sweep);
	assert_ok(rb_folder_read(path_in(sweep.folder, RB_FOLDER_PLAN), 2000, &text, &size, &err));
	for (uint64_t k = 0; k < 1500; k++) {
		const size_t at = rb_random_bits(1, k, 0) % size,
			     other = rb_random_bits(1, k, 1) % size,
			     length = 1 + rb_random_bits(1, k, 2) % 30;
		struct rb_plan plan;
		size_t used = size;

		memcpy(changed, text, size);
		if (k % 3 == 0) {
			changed[at] = (char)rb_random_bits(1, k, 3);
		} else if (k % 3 == 1) {
			used = at;
		} else {
			const size_t most = size - (at > other ? at : other);
			memcpy(changed + at, text + other, length < most ? length : most);
		}
		put(sweep.folder, RB_FOLDER_PLAN, changed, used);
		err = (struct rb_error){0};
		const enum rb_status status = rb_folder_load(sweep.folder, &plan, "7", &err);
		if (status != RB_OK && status != RB_ERR_INPUT)
			fail_msg("change %d: status %d: %s", (int)k, (int)status, err.text);
		if (status != RB_OK)
			assert_true(*err.text);
		good += status == RB_OK;
		bad += status != RB_OK;
		rb_plan_release(&plan);
	}
	/* rows are not read, and there are as many of these bytes as of the head */
	assert_true(good > 50 && bad > 300);
	rb_memory_free(text);
	close_sweep(&sweep);
}

static void names_of_points_sort_as_their_numbers(void **state)
{
	const struct rb_plan small = {.count = 3}, large = {.count = 100001},
			     most = {.count = RB_PLAN_POINTS_MAX};
	char path[RB_FOLDER_PATH_SIZE];

	(void)state;
	assert_string_equal(rb_folder_path(&small, NULL, 17, ".h5", path), "point-00017.h5");
	assert_string_equal(rb_folder_path(&small, "a/b", 2, "", path), "a/b/point-00002");
	assert_string_equal(rb_folder_path(&large, "", 17, ".log", path), "/point-000017.log");
	assert_string_equal(rb_folder_path(&large, NULL, 100000, ".log", path), "point-100000.log");
	assert_string_equal(rb_folder_path(&most, NULL, 5, "", path), "point-0000005");
}

static void what_is_too_long_or_too_large_is_told(void **state)
{
	static char folder[RB_FOLDER_PATH_SIZE + 10], out[RB_FOLDER_PATH_SIZE];
	struct rb_error err;
	char top[256], *text;
	size_t size;

	(void)state;
	memset(folder, 'a', RB_FOLDER_PATH_SIZE - 3);
	assert_ok(rb_folder_name(folder, "b", out, &err));
	assert_int_equal(strlen(out), RB_FOLDER_PATH_SIZE - 1);
	assert_int_equal(rb_folder_name(folder, "bc", out, &err), RB_ERR_CREATE);
	assert_false(rb_folder_has_plan(folder));

	support_folder(top);
	put(top, "x", "12345", 5);
	assert_ok(rb_folder_read(path_in(top, "x"), 5, &text, &size, &err));
	assert_int_equal(size, 5);
	assert_int_equal(text[5], 0);
	rb_memory_free(text);
	assert_int_equal(rb_folder_read(path_in(top, "x"), 4, &text, &size, &err), RB_ERR_INPUT);
	assert_null(text);
	assert_non_null(strstr(err.text, "it is not a file, or too large"));
	assert_int_equal(rb_folder_read(top, 400, &text, &size, &err), RB_ERR_INPUT);
	assert_int_equal(rb_folder_read(path_in(top, "y"), 4, &text, &size, &err), RB_ERR_INPUT);
	assert_non_null(strstr(err.text, "No such file"));
	rb_memory_fail_at(1);
	const enum rb_status status = rb_folder_read(path_in(top, "x"), 5, &text, &size, &err);
	rb_memory_fail_at(0);
	assert_int_equal(status, RB_ERR_MEMORY);
	assert_null(text);
	drop_folder(top);
}

static void a_folder_with_other_things_is_left_alone(void **state)
{
	const struct rb_source_file files[] = {file_of("s.lua", "new")};
	const struct rb_plan_wish wish = {.version = "7", .scene = "s.lua", .seeds = 1};
	struct rb_plan plan;
	struct rb_error err;
	char top[256], *text;
	size_t size;
	bool there;

	(void)state;
	support_folder(top);
	assert_ok(rb_plan_init(&plan, &wish, files, 1, &err));
	put(top, "mine.h5", "x", 1);
	assert_int_equal(rb_folder_write(top, &plan, files, &there, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "it holds 'mine.h5' and no plan of a sweep"));
	assert_int_equal(access(path_in(top, "scene"), F_OK), -1);
	remove(path_in(top, "mine.h5"));
	/* what one that was stopped at its beginning has left is taken over */
	assert_int_equal(mkdir(path_in(top, "scene"), 0700), 0);
	put(top, "scene/s.lua", "old", 3);
	assert_ok(rb_folder_write(top, &plan, files, &there, &err));
	assert_false(there);
	assert_ok(rb_folder_read(path_in(top, "scene/s.lua"), 100, &text, &size, &err));
	assert_string_equal(text, "new");
	rb_memory_free(text);
	rb_plan_release(&plan);
	drop_folder(top);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_file_of_the_scene_has_its_copy),
		cmocka_unit_test(files_that_lie_outside_of_the_scene_are_not_copied),
		cmocka_unit_test(what_is_loaded_is_what_was_planned),
		cmocka_unit_test(rows_are_compared_where_that_is_asked_for),
		cmocka_unit_test(damaged_plans_do_no_harm),
		cmocka_unit_test(names_of_points_sort_as_their_numbers),
		cmocka_unit_test(what_is_too_long_or_too_large_is_told),
		cmocka_unit_test(a_folder_with_other_things_is_left_alone),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
