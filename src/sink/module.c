/* SPDX-License-Identifier: MIT */
#include "sink/module.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char file_name[] = "rbsim-hdf5.so";

enum { PATH_SIZE = 4096 };

/* Written once, under `once`; then only read. */
static pthread_once_t once = PTHREAD_ONCE_INIT;
static const struct rb_hdf5_module *loaded;
static struct rb_error failure;

/* The folder of the running program, without a slash at its end. */
static bool program_folder(char folder[PATH_SIZE])
{
	const ssize_t size = readlink("/proc/self/exe", folder, PATH_SIZE - 1);

	if (size <= 0)
		return false;
	folder[size] = '\0';
	char *const slash = strrchr(folder, '/');
	if (!slash)
		return false;
	*slash = '\0';
	return true;
}

static void refuse(const char *path, const char *why)
{
	RB_FAIL(&failure, RB_ERR_MISSING, "cannot load '%s': %s", path, why);
}

static void load_from(const char *path)
{
	void *const library = dlopen(path, RTLD_NOW | RTLD_LOCAL);

	if (!library) {
		/* the loader's text begins with the path */
		const char *const text = dlerror();
		const char *const colon = text ? strstr(text, ": ") : NULL;
		refuse(path, colon ? colon + 2 : text ? text : "unknown failure");
		return;
	}
	const struct rb_hdf5_module *const module = dlsym(library, "rb_hdf5_module");
	if (!module || module->version != RB_HDF5_MODULE_VERSION) {
		char why[80];
		snprintf(why, sizeof why, "it is of version %d, this program wants %d",
		         module ? module->version : 0, RB_HDF5_MODULE_VERSION);
		refuse(path, why);
		dlclose(library);
		return;
	}
	/* Never unloaded: the library underneath keeps state of its own. */
	loaded = module;
}

static void load(void)
{
	char folder[PATH_SIZE], path[PATH_SIZE + 64];
	const char *const given = getenv("RBSIM_MODULE_DIR");

	if (given && given[0]) {
		snprintf(path, sizeof path, "%.*s/%s", PATH_SIZE, given, file_name);
		load_from(path);
		return;
	}
	if (!program_folder(folder)) {
		refuse(file_name,
		       "/proc/self/exe does not say where this program is (RBSIM_MODULE_DIR can)");
		return;
	}
	/* as built, then as installed */
	static const char *const places[] = {"", "/../lib/rbsim"};
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		snprintf(path, sizeof path, "%s%s/%s", folder, places[i], file_name);
		if (access(path, F_OK) == 0) {
			load_from(path);
			return;
		}
	}
	RB_FAIL(&failure, RB_ERR_MISSING,
	        "cannot find '%s' in '%.80s' or '%.80s/../lib/rbsim' (RBSIM_MODULE_DIR names another)",
	        file_name, folder, folder);
}

enum rb_status rb_module_hdf5(const struct rb_hdf5_module **module, struct rb_error *err)
{
	pthread_once(&once, load);
	*module = loaded;
	if (loaded)
		return RB_OK;
	if (err)
		*err = failure;
	return failure.status;
}
