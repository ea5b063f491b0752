/* SPDX-License-Identifier: MIT */
/*
 * Walks the folder of a sweep by descriptors, never by paths: a run may be renaming its files
 * meanwhile, and nothing that a scene makes may lead the walk elsewhere through a symbolic link.
 */
#include "sweep/usage.h"

#include <dirent.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

/* Folders within each other: a run makes no more than a scene names. Bounds the recursion. */
enum { DEPTH_MOST = 32 };

/*
 * Sum of the sizes of the regular files in the open folder `folder` whose names begin with `start`,
 * and of all files in the subfolders whose names do. Takes over the descriptor and closes it. A
 * double, because only comparisons with a user's bound follow.
 */
static double bytes_in(int folder, const char *start, int depth)
{
	DIR *const list = fdopendir(folder);
	const struct dirent *entry;
	double sum = 0;

	RB_ASSERT(folder >= 0 && depth <= DEPTH_MOST);
	if (!list) {
		close(folder);
		return 0;
	}
	while ((entry = readdir(list))) {
		const char *const name = entry->d_name;
		struct stat found;

		if (strncmp(name, start, strlen(start)) != 0 || strcmp(name, ".") == 0 ||
		    strcmp(name, "..") == 0 ||
		    fstatat(dirfd(list), name, &found, AT_SYMLINK_NOFOLLOW) != 0)
			continue;
		if (S_ISREG(found.st_mode))
			sum += (double)found.st_size;
		if (!S_ISDIR(found.st_mode) || depth == DEPTH_MOST)
			continue;
		const int inside = openat(dirfd(list), name,
		                          O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
		sum += inside < 0 ? 0 : bytes_in(inside, "", depth + 1);
	}
	closedir(list);
	return sum;
}

double rb_usage_bytes(const char *folder, const struct rb_plan *plan, uint64_t index)
{
	char start[RB_FOLDER_PATH_SIZE];
	const int top = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);

	rb_folder_path(plan, NULL, index, "", start);
	return top < 0 ? 0 : bytes_in(top, start, 0);
}
