/* SPDX-License-Identifier: MIT */
/* One folder for all tests of a program, made and removed as the fixture of their group. */
#ifndef RB_TESTS_OWN_FOLDER_H
#define RB_TESTS_OWN_FOLDER_H

#include "support.h"

static char folder[256];

/* Path of a file in it. */
static inline char *in_folder(char path[512], const char *name)
{
	snprintf(path, 512, "%s/%s", folder, name);
	return path;
}

static inline int make_folder(void **state)
{
	(void)state;
	support_folder(folder);
	return 0;
}

static inline int remove_folder(void **state)
{
	char command[300];

	(void)state;
	snprintf(command, sizeof command, "rm -rf '%s'", folder);
	return system(command);
}

#endif
