/* SPDX-License-Identifier: MIT */
#include "app/common.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "base/memory.h"
#include "script/pattern.h"

int rb_app_fail(const struct rb_options *options, const struct rb_error *err)
{
	fprintf(stderr, "rbsim: %s\n", *err->text ? err->text : rb_status_name(err->status));
	if (options->debug && err->file)
		fprintf(stderr, "rbsim: (%s error, from %s:%d)\n", rb_status_name(err->status),
		        err->file, err->line);
	return rb_status_exit_code(err->status);
}

static bool refused_as_expected(const struct rb_loaded *loaded, const struct rb_error *err)
{
	const char *pattern = loaded->scene.expect_refused_pattern;

	if (loaded->scene.expect_refused == 0 ||
	    loaded->scene.expect_refused != rb_status_exit_code(err->status))
		return false;
	if (!pattern || rb_pattern_found(err->text, pattern))
		return true;
	for (int i = 0; i < loaded->mistakes.count && i < RB_MISTAKES_MAX; i++)
		if (loaded->mistakes.line[i] && rb_pattern_found(loaded->mistakes.line[i], pattern))
			return true;
	return false;
}

int rb_app_fail_scene(const struct rb_options *options, const struct rb_loaded *loaded,
                      const struct rb_error *err)
{
	const struct rb_mistakes *const mistakes = &loaded->mistakes;
	const char *traceback = loaded->script ? rb_script_traceback(loaded->script) : "";

	if (refused_as_expected(loaded, err)) {
		if (!options->quiet)
			fprintf(stderr, "rbsim: refused, as the scene expects: %s\n", err->text);
		return 0;
	}
	if (mistakes->count == 0 || (err->status != RB_ERR_SCENE && err->status != RB_ERR_USAGE)) {
		(void)rb_app_fail(options, err);
	} else {
		for (int i = 0; i < mistakes->count && i < RB_MISTAKES_MAX; i++)
			if (mistakes->line[i])
				fprintf(stderr, "%s\n", mistakes->line[i]);
		if (mistakes->count > RB_MISTAKES_MAX)
			fprintf(stderr, "rbsim: and %d more\n", mistakes->count - RB_MISTAKES_MAX);
		if (options->debug && err->file)
			fprintf(stderr, "rbsim: (%s error, from %s:%d)\n",
			        rb_status_name(err->status), err->file, err->line);
	}
	if (options->debug && *traceback)
		fprintf(stderr, "%s\n", traceback);
	if (loaded->scene.expect_refused)
		fprintf(stderr, "rbsim: the scene expected to be refused with status %d and '%s'\n",
		        loaded->scene.expect_refused,
		        loaded->scene.expect_refused_pattern ? loaded->scene.expect_refused_pattern
		                                             : "");
	return rb_status_exit_code(err->status);
}

int rb_app_not_refused(const struct rb_loaded *loaded)
{
	const char *pattern = loaded->scene.expect_refused_pattern;

	fprintf(stderr, "rbsim: '%s' expected to be refused with status %d%s%s%s, but was not\n",
	        loaded->scene.file, loaded->scene.expect_refused, pattern ? " and '" : "",
	        pattern ? pattern : "", pattern ? "'" : "");
	return rb_status_exit_code(RB_ERR_EXPECT);
}

int rb_app_finish(const struct rb_options *options, int exit_code)
{
	struct rb_error err;

	errno = 0;
	if (fflush(stdout) == 0 && !ferror(stdout))
		return exit_code;
	(void)RB_FAIL(&err, RB_ERR_IO, "cannot write standard output: %s",
	              errno ? strerror(errno) : "an earlier write failed");
	const int failed = rb_app_fail(options, &err);
	return exit_code ? exit_code : failed;
}

static void override(struct rb_world_def *world, const struct rb_options *options)
{
	static const char *const rollback_names[] = {[RB_ROLLBACK_SELECTIVE] = "selective",
	                                             [RB_ROLLBACK_GLOBAL] = "global",
	                                             [RB_ROLLBACK_NONE] = "none"};

	if (!isnan(options->duration_s))
		world->duration_s = options->duration_s;
	if (!isnan(options->time_step_s))
		world->time_step_s = options->time_step_s;
	if (!isnan(options->tolerance_m))
		world->tolerance_m = options->tolerance_m;
	if (options->method)
		world->method = strcmp(options->method, "classic") == 0 ? RB_METHOD_CLASSIC
		                                                        : RB_METHOD_AUTO;
	for (int i = 0; options->rollback && i < 3; i++)
		if (strcmp(options->rollback, rollback_names[i]) == 0)
			world->rollback = (enum rb_rollback_kind)i;
	if (options->has_seed)
		world->seed = options->seed;
}

/* The scene's record file, or its own name with another ending, in the current folder. */
static char *default_output(const struct rb_scene *scene, const char *path)
{
	if (scene->record.file)
		return rb_memory_copy_text(scene->record.file);

	const char *slash = strrchr(path, '/');
	const char *base = slash ? slash + 1 : path;
	size_t length = strlen(base);
	if (length > 4 && strcmp(base + length - 4, ".lua") == 0)
		length -= 4;
	char *output = rb_memory_take(length + 4, 1);
	if (output) {
		memcpy(output, base, length);
		memcpy(output + length, ".h5", 4);
	}
	return output;
}

enum rb_status rb_loaded_init(struct rb_loaded *loaded, const struct rb_options *options,
                              struct rb_error *err)
{
	const struct rb_script_options script_options = {
		.path = options->operand[0],
		.params = options->params,
		.param_count = options->param_count,
		.has_seed = options->has_seed,
		.seed = options->seed,
		.trust = options->trust,
	};

	*loaded = (struct rb_loaded){0};
	enum rb_status status = rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes,
	                                       &script_options, err);
	if (status)
		return status;
	override(&loaded->scene.world, options);
	status = rb_model_create(&loaded->model, &loaded->scene, &loaded->mistakes, err);
	if (status || options->no_record)
		return status;
	loaded->output = options->output ? rb_memory_copy_text(options->output)
	                                 : default_output(&loaded->scene, options->operand[0]);
	if (!loaded->output)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory",
		               options->operand[0]);
	return RB_OK;
}

void rb_loaded_release(struct rb_loaded *loaded)
{
	rb_memory_free(loaded->output);
	rb_model_destroy(loaded->model);
	rb_script_destroy(loaded->script);
	rb_scene_release(&loaded->scene);
	rb_mistakes_release(&loaded->mistakes);
	*loaded = (struct rb_loaded){0};
}

uint64_t rb_process_bytes(const char *key)
{
	char line[128];
	uint64_t kilobytes = 0;
	FILE *file = fopen("/proc/self/status", "re");

	while (file && kilobytes == 0 && fgets(line, sizeof line, file))
		if (strncmp(line, key, strlen(key)) == 0)
			(void)sscanf(line + strlen(key), ": %" SCNu64, &kilobytes);
	if (file)
		fclose(file);
	return kilobytes ? kilobytes * 1024 : rb_memory_counts().bytes_peak;
}

const char *rb_text_bytes(uint64_t bytes, char out[32])
{
	static const char *const unit[] = {"kB", "MB", "GB", "TB", "PB", "EB"};
	double value = (double)bytes / 1000;
	int k = 0;

	if (bytes < 1000) {
		snprintf(out, 32, "%" PRIu64 " bytes", bytes);
		return out;
	}
	while (value >= 999.5 && k < 5) {
		value /= 1000;
		k++;
	}
	snprintf(out, 32, "%.3g %s", value, unit[k]);
	return out;
}

const char *rb_text_plural(uint64_t count, const char *one, const char *many)
{
	return count == 1 ? one : many;
}
