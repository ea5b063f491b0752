/* SPDX-License-Identifier: MIT */
#include "base/program.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "base/error.h"

/*
 * Whatever does not begin with '/' is no program's path: /proc may be missing or be another file
 * system, and the kernel writes "(unreachable)..." for a file outside of the process's root.
 */
enum rb_status rb_program_path(char path[PATH_MAX], struct rb_error *err)
{
	const ssize_t size = readlink(RB_PROGRAM_AGAIN, path, PATH_MAX - 1);

	if (size < 0)
		return RB_FAIL(err, RB_ERR_MISSING,
		               RB_PROGRAM_AGAIN
		               " does not say where this program is: %s (mount /proc)",
		               strerror(errno));
	path[size] = '\0';
	if (path[0] != '/')
		return RB_FAIL(err, RB_ERR_MISSING,
		               RB_PROGRAM_AGAIN
		               " does not say where this program is but '%.80s' (mount /proc)",
		               path);
	return RB_OK;
}

bool rb_program_beside(const char *name, char *path, size_t size)
{
	char program[PATH_MAX];
	struct rb_error unused;

	if (rb_program_path(program, &unused))
		return false;
	RB_ASSERT(strrchr(program, '/'));
	const size_t folder = (size_t)(strrchr(program, '/') - program) + 1;
	if (folder + strlen(name) >= size)
		return false;
	memcpy(path, program, folder);
	memcpy(path + folder, name, strlen(name) + 1);
	return true;
}
