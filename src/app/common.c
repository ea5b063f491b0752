/* SPDX-License-Identifier: MIT */
#include "app/common.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <sys/statvfs.h>

#include "app/json.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/place.h"
#include "base/visible.h"
#include "flow/frame.h"
#include "math/vec3.h"
#include "model/element.h"
#include "model/joint_type.h"
#include "model/shape.h"
#include "model/descriptor.h"
#include "script/pattern.h"

int rb_app_fail(const struct rb_options *options, const struct rb_error *err)
{
	rb_print(stderr, "rbsim: %s\n", *err->text ? err->text : rb_status_name(err->status));
	if (options->debug && err->file)
		rb_print(stderr, "rbsim: (%s error, from %s:%d)\n", rb_status_name(err->status),
		         err->file, err->line);
	return rb_status_exit_code(err->status);
}

bool rb_app_refused_as_expected(const struct rb_loaded *loaded, const struct rb_error *err)
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

/* Whether a text says where in a script it arose: FILE:LINE: ... */
static bool has_place(const struct rb_loaded *loaded, const char *text)
{
	const size_t size = loaded->scene.file ? strlen(loaded->scene.file) : 0;
	const char *colon = size && strncmp(text, loaded->scene.file, size) == 0
	                            ? text + size
	                            : text + strcspn(text, ": ");
	const size_t digits = *colon == ':' ? strspn(colon + 1, "0123456789") : 0;

	return digits > 0 && colon[1 + digits] == ':';
}

/*
 * Prints the calls that led to an error: of a callback always; of a scene that does not load, where
 * the place says enough, with --debug.
 */
static void print_traceback(const struct rb_options *options, const struct rb_loaded *loaded,
                            const struct rb_error *err)
{
	const char *traceback = loaded->script ? rb_script_traceback(loaded->script) : "";
	const bool callback = err->status == RB_ERR_SCENE && loaded->mistakes.count == 0;
	const char *calls = NULL;

	/* the last: the message before it may say so too */
	for (const char *at = traceback; (at = strstr(at, "stack traceback:")); at++)
		calls = at;
	if (!calls || !(callback || options->debug))
		return;
	const char *const first = calls;
	while (*calls) {
		const size_t size = strcspn(calls, "\n");
		/* a name of a function may hold a line break: no line of it begins one of ours */
		rb_print(stderr, "%s%.*s\n", calls == first || *calls == '\t' ? "" : "\t",
		         (int)size, calls);
		calls += size + (calls[size] == '\n');
	}
}

int rb_app_fail_scene(const struct rb_options *options, const struct rb_loaded *loaded,
                      const struct rb_error *err)
{
	const struct rb_mistakes *const mistakes = &loaded->mistakes;

	if (rb_app_refused_as_expected(loaded, err)) {
		if (!options->quiet)
			rb_print(stderr, "rbsim: refused, as the scene expects: %s\n", err->text);
		return 0;
	}
	if (mistakes->count == 0 || (err->status != RB_ERR_SCENE && err->status != RB_ERR_USAGE)) {
		if (err->status == RB_ERR_SCENE && has_place(loaded, err->text))
			rb_print(stderr, "%s\n", err->text);
		else
			(void)rb_app_fail(options, err);
	} else {
		for (int i = 0; i < mistakes->count && i < RB_MISTAKES_MAX; i++)
			if (mistakes->line[i])
				rb_print(stderr, "%s\n", mistakes->line[i]);
		if (mistakes->count > RB_MISTAKES_MAX)
			rb_print(stderr, "rbsim: and %d more\n", mistakes->count - RB_MISTAKES_MAX);
		if (options->debug && err->file)
			rb_print(stderr, "rbsim: (%s error, from %s:%d)\n",
			         rb_status_name(err->status), err->file, err->line);
	}
	print_traceback(options, loaded, err);
	if (loaded->scene.expect_refused)
		rb_print(stderr,
		         "rbsim: the scene expected to be refused with status %d and '%s'\n",
		         loaded->scene.expect_refused,
		         loaded->scene.expect_refused_pattern ? loaded->scene.expect_refused_pattern
		                                              : "");
	return rb_status_exit_code(err->status);
}

void rb_app_json_refusal(const struct rb_options *options, const struct rb_loaded *loaded,
                         const struct rb_error *err, int exit_code)
{
	static const char *const operand_names[RB_VERB_COUNT][2] = {
		[RB_VERB_RUN] = {"scene"},      [RB_VERB_CHECK] = {"scene"},
		[RB_VERB_INFO] = {"file"},      [RB_VERB_DIFF] = {"a", "b"},
		[RB_VERB_REPLAY] = {"file"},    [RB_VERB_REPAIR] = {"file"},
		[RB_VERB_CONVERGE] = {"scene"}, [RB_VERB_RENDER] = {"file"},
		[RB_VERB_SWEEP] = {"sweep"},    [RB_VERB_COLLECT] = {"sweep"},
	};
	struct rb_json json = {.file = stdout};

	if (!options->json)
		return;
	rb_json_open(&json, NULL, '{');
	for (int i = 0; i < 2; i++)
		if (operand_names[options->verb][i])
			rb_json_text(&json, operand_names[options->verb][i], options->operand[i]);
	rb_json_text(&json, "status", "refused");
	rb_json_text(&json, "reason", *err->text ? err->text : rb_status_name(err->status));
	rb_json_count(&json, "exit_status", (uint64_t)exit_code);
	rb_json_text(&json, "error", *err->text ? err->text : rb_status_name(err->status));
	rb_json_open(&json, "mistakes", '[');
	for (int i = 0; loaded && i < loaded->mistakes.count && i < RB_MISTAKES_MAX; i++)
		if (loaded->mistakes.line[i])
			rb_json_text(&json, NULL, loaded->mistakes.line[i]);
	rb_json_close(&json, ']');
	rb_json_close(&json, '}');
	putchar('\n');
}

int rb_app_refuse(const struct rb_options *options, const struct rb_error *err)
{
	const int exit_code = rb_app_fail(options, err);

	rb_app_json_refusal(options, NULL, err, exit_code);
	return exit_code;
}

int rb_app_refuse_scene(const struct rb_options *options, const struct rb_loaded *loaded,
                        const struct rb_error *err)
{
	const int exit_code = rb_app_fail_scene(options, loaded, err);

	rb_app_json_refusal(options, loaded, err, exit_code);
	return exit_code;
}

int rb_app_not_refused(const struct rb_loaded *loaded)
{
	const char *pattern = loaded->scene.expect_refused_pattern;

	rb_print(stderr, "rbsim: '%s' expected to be refused with status %d%s%s%s, but was not\n",
	         loaded->scene.file, loaded->scene.expect_refused, pattern ? " and '" : "",
	         pattern ? pattern : "", pattern ? "'" : "");
	return rb_status_exit_code(RB_ERR_EXPECT);
}

int rb_app_finish(const struct rb_options *options, int exit_code)
{
	struct rb_error err;

	RB_ASSERT(exit_code >= 0 && exit_code < 256);
	errno = 0;
	if (fflush(stdout) == 0 && !ferror(stdout))
		return exit_code;
	(void)RB_FAIL(&err, RB_ERR_IO, "cannot write standard output: %s",
	              errno ? strerror(errno) : "an earlier write failed");
	const int failed = rb_app_fail(options, &err);
	return exit_code > rb_status_exit_code(RB_ERR_EXPECT) ? exit_code : failed;
}

/* Puts what the command line says in place of what the scene says. */
static void override(struct rb_world_def *world, const struct rb_options *options)
{
	static const char *const rollback_names[] = {[RB_ROLLBACK_SELECTIVE] = "selective",
	                                             [RB_ROLLBACK_GLOBAL] = "global",
	                                             [RB_ROLLBACK_NONE] = "none"};

	if (!isnan(options->duration_s) || options->step_count > 0) {
		world->duration_s = options->duration_s;
		world->steps = options->step_count;
	}
	if (!isnan(options->time_step_s))
		world->time_step_s = options->time_step_s;
	if (!isnan(options->tolerance_m))
		world->tolerance_m = options->tolerance_m;
	if (options->method && rb_method_find(options->method) >= 0)
		world->method = (enum rb_method_kind)rb_method_find(options->method);
	for (int i = 0; options->rollback && i < 3; i++)
		if (strcmp(options->rollback, rollback_names[i]) == 0)
			world->rollback = (enum rb_rollback_kind)i;
	if (options->has_seed)
		world->seed = options->seed;
	/* a number of the command line stands on no line of the scene */
	if (!isnan(options->duration_s) || options->step_count > 0 ||
	    !isnan(options->time_step_s) || !isnan(options->tolerance_m) || options->method)
		world->line = 0;
}

/*
 * The scene's record file, or its own name with another ending, in the current folder; to be freed.
 * NULL: no memory.
 */
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

/* Bytes of all of the file system that `name` will be on; 0: not known. */
static double disk_bytes(const char *name)
{
	char *const folder = rb_memory_copy_text(name);
	char *const slash = folder ? strrchr(folder, '/') : NULL;
	struct statvfs about = {0};

	if (slash)
		slash[slash == folder] = '\0';
	const bool known = folder && statvfs(slash ? folder : ".", &about) == 0;
	rb_memory_free(folder);
	return known ? (double)about.f_blocks * (double)about.f_frsize : 0;
}

/* Refuses what this disk or no patience is enough for, before anything is made. */
static enum rb_status check_size(const struct rb_loaded *loaded, struct rb_error *err)
{
	/* the least that a frame takes, of any run on any machine; and more than anybody waits */
	const double frame_s = 1e-6, wait_s = 365.25 * 24 * 3600;
	const struct rb_model *const model = loaded->model;
	const struct rb_record_def *const record = &loaded->scene.record;
	const double frames = (double)model->frame_count;
	double bytes = (double)rb_frame_bytes(model, record->fields) /
	               (record->single_precision ? 2 : 1);
	char needed[32], there[32], years[64] = "", line[16] = "";

	/* compressed, its time at least */
	bytes = (record->compression > 0 ? 0 : bytes) + sizeof(double);
	bytes *= frames / (record->every > 1 ? record->every : 1);
	const double disk = loaded->output ? disk_bytes(loaded->output) : 0;
	const bool too_large = disk > 0 && bytes > disk, too_long = frames * frame_s > wait_s;
	if (!too_large && !too_long)
		return RB_OK;
	if (too_long)
		snprintf(years, sizeof years, " and %.2g years at a microsecond each",
		         frames * frame_s / wait_s);
	rb_text_bytes((uint64_t)fmin(bytes, 1e19), needed);
	rb_text_bytes((uint64_t)disk, there);
	if (loaded->scene.world.line > 0)
		snprintf(line, sizeof line, ":%d", loaded->scene.world.line);
	/* on another disk the same scene runs */
	return RB_FAIL(err, too_long ? RB_ERR_SCENE : RB_ERR_CREATE,
	               "%s%s: world: 'duration' %g s times 'frame_rate' %g makes %g frames, which "
	               "would take at least %s of disk%s%s%s%s",
	               loaded->scene.file, line, model->duration_s, model->frame_rate, frames,
	               needed, years, disk > 0 ? " (all of this disk: " : "", disk > 0 ? there : "",
	               disk > 0 ? ")" : "");
}

/* Loads the scene; `from`: its stored files, and who may stop it. */
static enum rb_status load(struct rb_loaded *loaded, const struct rb_script_options *from,
                           const struct rb_options *options, struct rb_error *err)
{
	struct rb_script_options script_options = *from;

	script_options.path = options->operand[0];
	script_options.params = options->params;
	script_options.param_count = options->param_count;
	script_options.has_seed = options->has_seed;
	script_options.seed = options->seed;
	script_options.trust = options->trust;
	*loaded = (struct rb_loaded){0};
	enum rb_status status = rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes,
	                                       &script_options, err);
	if (status)
		return status;
	override(&loaded->scene.world, options);
	if (options->keep_ledger && !loaded->scene.record.ledger_given)
		loaded->scene.record.ledger = loaded->scene.record.ledger_given = true;
	status = rb_model_create(&loaded->model, &loaded->scene, &loaded->mistakes, err);
	if (status || options->no_record)
		return status ? status : check_size(loaded, err);
	loaded->how = (options->force || options->resume ? RB_PLACE_REPLACE : 0) |
	              (options->output || options->trust ? 0 : RB_PLACE_BENEATH);
	loaded->output = options->output ? rb_memory_copy_text(options->output)
	                                 : default_output(&loaded->scene, options->operand[0]);
	if (!loaded->output)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot load '%s': out of memory",
		               options->operand[0]);
	return check_size(loaded, err);
}

enum rb_status rb_loaded_init(struct rb_loaded *loaded, const struct rb_options *options,
                              struct rb_error *err)
{
	return load(loaded, &(struct rb_script_options){0}, options, err);
}

enum rb_status rb_loaded_again(struct rb_loaded *loaded, const struct rb_loaded *from,
                               const struct rb_options *options, bool (*stop)(void *user),
                               void *user, struct rb_error *err)
{
	const struct rb_script_options script = {.files = from->scene.files,
	                                         .file_count = from->scene.file_count,
	                                         .stop = stop,
	                                         .stop_user = user};

	return load(loaded, &script, options, err);
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

double rb_larger(double a, double b)
{
	return isnan(a) || isnan(b) ? (double)NAN : fmax(a, b);
}

double rb_change_of(rb_vec3 now, rb_vec3 then)
{
	const rb_vec3 change = rb_vec3_sub(now, then);
	const bool finite = isfinite(change.x) && isfinite(change.y) && isfinite(change.z);

	return finite ? rb_vec3_length(change) : (double)NAN;
}

const char *rb_text_measure(const char *before, double value, int digits, const char *unit,
                            char out[64])
{
	if (isfinite(value))
		snprintf(out, 64, "%s%.*g%s%s", before, digits, value, *unit ? " " : "", unit);
	else
		snprintf(out, 64, "not finite");
	return out;
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

const char *rb_text_tolerance(double located_m, double stepped_m, int digits, char out[96])
{
	if (located_m == stepped_m)
		snprintf(out, 96, "%.*g m", digits, located_m);
	else
		snprintf(out, 96, "%.*g m until the first step, then %.*g m", digits, located_m,
		         digits, stepped_m);
	return out;
}

const char *rb_text_shapes(const int counts[RB_SHAPE_KIND_COUNT], char out[160])
{
	size_t used = 0;
	int others = 0;

	RB_ASSERT(counts && out);
	out[0] = '\0';
	for (int k = 0; k < RB_SHAPE_KIND_COUNT; k++)
		others += rb_shape_has_parts((enum rb_shape_kind)k) ? counts[k] : 0;
	for (int k = 0; others > 0 && k < RB_SHAPE_KIND_COUNT; k++)
		if (counts[k] > 0)
			used += (size_t)snprintf(out + used, 160 - used, "%s%d %s",
			                         used > 0 ? ", " : "", counts[k],
			                         counts[k] == 1 ? rb_shape_types[k]->name
			                                        : rb_shape_types[k]->plural);
	return out;
}

/* Appends "3 springs" to a text; the size that would be used. */
static size_t add_count(char *out, size_t used, int count, const char *name)
{
	if (count == 0 || used >= RB_FORCES_TEXT_SIZE)
		return used;
	return used + (size_t)snprintf(out + used, RB_FORCES_TEXT_SIZE - used, "%s%d %s%s",
	                               used > 0 ? ", " : "", count, name, count == 1 ? "" : "s");
}

const char *rb_text_forces(const int element_counts[RB_ELEMENT_KINDS_MAX], int fields,
                           char out[RB_FORCES_TEXT_SIZE])
{
	size_t used = 0;

	out[0] = '\0';
	for (int place = 0; place < rb_element_kind_count; place++)
		used = add_count(out, used, element_counts[place], rb_element_kinds[place]->name);
	add_count(out, used, fields, "field");
	return out;
}

const char *rb_text_joints(const int counts[RB_JOINT_KIND_COUNT], char out[RB_JOINTS_TEXT_SIZE])
{
	size_t used = 0;

	out[0] = '\0';
	for (int kind = 0; kind < RB_JOINT_KIND_COUNT && used < RB_JOINTS_TEXT_SIZE; kind++)
		if (counts[kind] > 0)
			used += (size_t)snprintf(out + used, RB_JOINTS_TEXT_SIZE - used,
			                         "%s%d %s%s", used > 0 ? ", " : "", counts[kind],
			                         rb_joint_types[kind]->noun,
			                         counts[kind] == 1 ? "" : "s");
	return out;
}

void rb_json_forces(struct rb_json *json, const int element_counts[RB_ELEMENT_KINDS_MAX],
                    int fields)
{
	char key[80];

	for (int place = 0; place < rb_element_kind_count; place++) {
		snprintf(key, sizeof key, "%s_count", rb_element_kinds[place]->name);
		rb_json_count(json, key, (uint64_t)element_counts[place]);
	}
	rb_json_count(json, "field_count", (uint64_t)fields);
}
