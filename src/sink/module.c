/* SPDX-License-Identifier: MIT */
/*
 * A module is looked for in RBSIM_MODULE_DIR if that is set, and nowhere else then; else beside the
 * program (build tree) and in ../lib/rbsim (installed). The version in its table is compared before
 * anything else of it is used, because an old module beside a new program would be called with
 * wrong structs.
 */
#include "sink/module.h"

#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/program.h"

/* Bytes of a folder's name. */
enum { PATH_SIZE = 4096 };

/* A module's file, its exported object and, after it was asked for, what became of it. */
struct module {
	const char *file_name, *symbol;
	int version;          /* wanted; the object begins with its own */
	const char *left_out; /* what this program was built without; NULL: it was not */
	/* written once, under the module's pthread_once_t; then only read */
	const void *loaded;
	struct rb_error failure;
};

#ifdef RB_WITHOUT_FILM
#define NO_FILM "films (WITH_FILM=0)"
#else
#define NO_FILM NULL
#endif
#ifdef RB_WITHOUT_CONSOLE
#define NO_CONSOLE "the console (WITH_CONSOLE=0)"
#else
#define NO_CONSOLE NULL
#endif

static struct module hdf5 = {.file_name = "rbsim-hdf5.so",
                             .symbol = "rb_hdf5_module",
                             .version = RB_HDF5_MODULE_VERSION};
static struct module film = {.file_name = "rbsim-film.so",
                             .symbol = "rb_film_module",
                             .version = RB_FILM_MODULE_VERSION,
                             .left_out = NO_FILM};
static struct module console = {.file_name = "rbsim-console.so",
                                .symbol = "rb_console_module",
                                .version = RB_CONSOLE_MODULE_VERSION,
                                .left_out = NO_CONSOLE};
_Static_assert(offsetof(struct rb_hdf5_module, version) == 0 &&
                       offsetof(struct rb_film_module, version) == 0 &&
                       offsetof(struct rb_console_module, version) == 0,
               "load_from reads it from there");

/* Notes why a module cannot be had. */
static void refuse(struct module *module, const char *path, const char *why)
{
	RB_FAIL(&module->failure, RB_ERR_MISSING, "cannot load '%s': %s", path, why);
}

/* Loads the module of a file, or notes why not. */
static void load_from(struct module *module, const char *path)
{
	/* the module's own names are found at once (-z now), those of libraries when used */
	void *const library = dlopen(path, RTLD_LAZY | RTLD_LOCAL);

	if (!library) {
		/* the loader's text begins with the path */
		const char *const text = dlerror();
		const char *const colon = text ? strstr(text, ": ") : NULL;
		refuse(module, path, colon ? colon + 2 : text ? text : "unknown failure");
		return;
	}
	const int *const version = dlsym(library, module->symbol);
	if (!version || *version != module->version) {
		char why[80];
		snprintf(why, sizeof why, "its version is %d, this program needs %d",
		         version ? *version : 0, module->version);
		refuse(module, path, why);
		dlclose(library);
		return;
	}
	/* Never unloaded: the libraries underneath keep state of their own. */
	module->loaded = version;
}

/* Finds and loads a module, once; the outcome stays. */
static void load(struct module *module)
{
	char name[64], path[PATH_SIZE + 64];
	struct rb_error unknown;
	const char *const given = getenv("RBSIM_MODULE_DIR");

	if (module->left_out) {
		RB_FAIL(&module->failure, RB_ERR_MISSING, "this program was built without %s",
		        module->left_out);
		return;
	}
	if (given && given[0]) {
		snprintf(path, sizeof path, "%.*s/%s", PATH_SIZE, given, module->file_name);
		load_from(module, path);
		return;
	}
	if (rb_program_path(path, &unknown)) {
		char why[160];
		snprintf(why, sizeof why, "%.120s, or set RBSIM_MODULE_DIR", unknown.text);
		refuse(module, module->file_name, why);
		return;
	}
	*strrchr(path, '/') = '\0';
	RB_FAIL(&module->failure, RB_ERR_MISSING,
	        "cannot find '%s' in '%.80s' or '%.80s/../lib/rbsim' (RBSIM_MODULE_DIR names "
	        "another)",
	        module->file_name, path, path);
	/* as built, then as installed */
	static const char *const places[] = {"", "../lib/rbsim/"};
	for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
		snprintf(name, sizeof name, "%s%s", places[i], module->file_name);
		if (rb_program_beside(name, path, sizeof path) && access(path, F_OK) == 0) {
			load_from(module, path);
			return;
		}
	}
}

/* Of librbsim, which is linked with HDF5; the program has none, and loads it. */
extern const struct rb_hdf5_module rb_hdf5_module __attribute__((weak));

static void load_hdf5(void)
{
	if (&rb_hdf5_module)
		hdf5.loaded = &rb_hdf5_module;
	else
		load(&hdf5);
}

static void load_film(void)
{
	load(&film);
}

static void load_console(void)
{
	load(&console);
}

/* The outcome of the one attempt; RB_OK: it is loaded. */
static enum rb_status answer(const struct module *module, struct rb_error *err)
{
	if (module->loaded)
		return RB_OK;
	if (err)
		*err = module->failure;
	return module->failure.status;
}

enum rb_status rb_module_hdf5(const struct rb_hdf5_module **module, struct rb_error *err)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;

	pthread_once(&once, load_hdf5);
	*module = hdf5.loaded;
	return answer(&hdf5, err);
}

bool rb_module_has_film(void)
{
	return !film.left_out;
}

enum rb_status rb_module_film(const struct rb_film_module **module, struct rb_error *err)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;

	pthread_once(&once, load_film);
	*module = film.loaded;
	return answer(&film, err);
}

enum rb_status rb_module_console(const struct rb_console_module **module, struct rb_error *err)
{
	static pthread_once_t once = PTHREAD_ONCE_INIT;

	pthread_once(&once, load_console);
	*module = console.loaded;
	return answer(&console, err);
}
