/* SPDX-License-Identifier: MIT */
#include "sweep/usage.h"

#include <dirent.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Of folders in each other: a run makes no more than a scene names. */
enum { DEPTH_MOST = 32 };

/*
 * Of the files in an open folder, which is closed, whose names begin so, and of all in folders
 * whose names do.
 */
static double bytes_in(int folder, const char *start, int depth)
{
	DIR *const list = fdopendir(folder);
	const struct dirent *entry;
	double sum = 0;

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
