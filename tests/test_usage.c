/* SPDX-License-Identifier: MIT */
/* src/sweep/usage.c: how much disk the run of a point has taken */
#include "support.h"

#include <ftw.h>
#include <sys/stat.h>

#include "sweep/usage.h"

static int drop(const char *path, const struct stat *about, int kind, struct FTW *walk)
{
	(void)about, (void)kind, (void)walk;
	return remove(path);
}

static const char *path_in(const char *folder, const char *name)
{
	static char path[RB_FOLDER_PATH_SIZE];

	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void put(const char *folder, const char *name, size_t size)
{
	FILE *file = fopen(path_in(folder, name), "wb");

	assert_non_null(file);
	for (size_t i = 0; i < size; i++)
		putc('x', file);
	assert_int_equal(fclose(file), 0);
}

/* Each number of bytes is a power of two, so that a sum says which files are in it. */
static void files_of_a_point_count_and_no_others(void **state)
{
	const struct rb_plan plan = {.count = 20};
	char folder[256];

	(void)state;
	support_folder(folder);
	assert_near(rb_usage_bytes(folder, &plan, 1), 0, 0);
	put(folder, "point-00001.h5", 1);
	put(folder, "point-00001.h5.checkpoint", 2);
	put(folder, "point-00001.json", 4);
	put(folder, "point-00001.log", 8);
	put(folder, "point-00001.h5.partial-123", 16);
	put(folder, "point-00010.h5", 32);
	put(folder, "plan.csv", 64);
	put(folder, "a-point-00001", 128);
	put(folder, ".point-00001", 256);
	assert_near(rb_usage_bytes(folder, &plan, 1), 1 + 2 + 4 + 8 + 16, 0);
	assert_near(rb_usage_bytes(folder, &plan, 10), 32, 0);
	assert_near(rb_usage_bytes(folder, &plan, 0), 0, 0);
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

static void folders_count_with_all_that_is_in_them(void **state)
{
	const struct rb_plan plan = {.count = 20};
	char folder[256];

	(void)state;
	support_folder(folder);
	assert_int_equal(mkdir(path_in(folder, "point-00003"), 0700), 0);
	assert_int_equal(mkdir(path_in(folder, "point-00003/deep"), 0700), 0);
	assert_int_equal(mkdir(path_in(folder, "scene"), 0700), 0);
	put(folder, "point-00003/film.mp4", 1);
	put(folder, "point-00003/deep/00001.png", 2);
	put(folder, "point-00003/deep/.hidden", 4);
	put(folder, "scene/point-00003", 8);
	put(folder, "point-00003.h5", 16);
	assert_near(rb_usage_bytes(folder, &plan, 3), 1 + 2 + 4 + 16, 0);
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

static void links_count_nothing_and_lead_nowhere(void **state)
{
	const struct rb_plan plan = {.count = 20};
	char folder[256];

	(void)state;
	support_folder(folder);
	assert_int_equal(mkdir(path_in(folder, "point-00003"), 0700), 0);
	assert_int_equal(mkdir(path_in(folder, "other"), 0700), 0);
	put(folder, "other/large", 100);
	put(folder, "point-00003/small", 1);
	assert_int_equal(symlink("../other/large", path_in(folder, "point-00003/file")), 0);
	assert_int_equal(symlink("../other", path_in(folder, "point-00003/folder")), 0);
	assert_int_equal(symlink("..", path_in(folder, "point-00003/up")), 0);
	assert_int_equal(symlink("other", path_in(folder, "point-00003-link")), 0);
	assert_int_equal(mkfifo(path_in(folder, "point-00003.pipe"), 0600), 0);
	assert_near(rb_usage_bytes(folder, &plan, 3), 1, 0);
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

/* Folders in each other to 40: what lies below the 32nd is not looked at. */
static void the_depth_is_bounded(void **state)
{
	const struct rb_plan plan = {.count = 20};
	char folder[256], name[400] = "point-00003";

	(void)state;
	support_folder(folder);
	for (int depth = 0; depth < 40; depth++) {
		char file[420];

		assert_int_equal(mkdir(path_in(folder, name), 0700), 0);
		snprintf(file, sizeof file, "%s/x", name);
		put(folder, file, 1);
		strcat(name, "/d");
	}
	assert_near(rb_usage_bytes(folder, &plan, 3), 32, 0);
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

static void what_is_not_there_counts_nothing(void **state)
{
	const struct rb_plan plan = {.count = 200000};
	char folder[256];

	(void)state;
	support_folder(folder);
	assert_near(rb_usage_bytes(path_in(folder, "no"), &plan, 0), 0, 0);
	/* a plan of many points has longer names */
	put(folder, "point-00017.h5", 1);
	put(folder, "point-000017.h5", 2);
	assert_near(rb_usage_bytes(folder, &plan, 17), 2, 0);
	assert_int_equal(nftw(folder, drop, 8, FTW_DEPTH | FTW_PHYS), 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(files_of_a_point_count_and_no_others),
		cmocka_unit_test(folders_count_with_all_that_is_in_them),
		cmocka_unit_test(links_count_nothing_and_lead_nowhere),
		cmocka_unit_test(the_depth_is_bounded),
		cmocka_unit_test(what_is_not_there_counts_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
