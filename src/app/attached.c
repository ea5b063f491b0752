/* SPDX-License-Identifier: MIT */
/*
 * The scene of a run comes through its socket as texts, and is loaded as a recorded one would be;
 * that both sides have the same bodies is checked by their counts. A run of a console's own is this
 * program again with the same words, less those for the console; the address of its socket is made
 * of our process number, and connecting is tried until it answers or has ended.
 */
#include "app/attached.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/program.h"
#include "control/wire.h"

/* s for an answer, which the scene's texts may make long; for one attempt to connect. */
static const double answer_s = 10, connect_s = 2;
/*
 * TRIES every TRY_MS: 10 s for a run that is starting anew. PATIENCE_MS: from asking a run to end
 * to killing it.
 */
enum { TRIES = 500, TRY_MS = 20, PATIENCE_MS = 5000 };

/* Sleeps. */
static void rest(int milliseconds)
{
	const struct timespec pause = {.tv_sec = milliseconds / 1000,
	                               .tv_nsec = milliseconds % 1000 * 1000000L};

	RB_ASSERT(milliseconds >= 0);
	nanosleep(&pause, NULL);
}

/* ---- the scene ---- */

/* What a run says of its scene; texts are owned. */
struct told {
	struct rb_source_file *files;
	char **params;
	int file_count, param_count;
	size_t file_room, param_room;
	double duration_s, frame_rate, time_step_s, tolerance_m, stepped_tolerance_m;
	uint64_t seed;
	int body_count, static_count;
};

/* Frees all of it. */
static void release(struct told *told)
{
	for (int i = 0; i < told->file_count; i++) {
		rb_memory_free((void *)(uintptr_t)told->files[i].name);
		rb_memory_free((void *)(uintptr_t)told->files[i].text);
	}
	for (int i = 0; i < told->param_count; i++)
		rb_memory_free(told->params[i]);
	rb_memory_free(told->files);
	rb_memory_free(told->params);
}

/*
 * A word of base64 as bytes with a zero behind them, to be freed; NULL: it is none, or memory is
 * out. "-" stands for nothing.
 */
static char *decode(const char *word, size_t size, size_t *bytes)
{
	*bytes = 0;
	if (size == 1 && word[0] == '-')
		return rb_memory_take(1, 1);
	if (size % 4 != 0)
		return NULL;
	*bytes = size / 4 * 3;
	for (int i = 0; i < 2 && *bytes > 0 && word[size - 1 - (size_t)i] == '='; i++)
		--*bytes;
	char *const text = rb_memory_take(*bytes + 1, 1);
	if (text && *bytes > 0 && !rb_wire_base64_read(text, *bytes, word, size)) {
		rb_memory_free(text);
		return NULL;
	}
	return text;
}

/* Takes over name and text. False: no memory, and they are still the caller's. */
static bool add_file(struct told *told, char *name, char *text, size_t size)
{
	if (!rb_memory_reserve(&told->files, &told->file_room, (size_t)told->file_count + 1,
	                       sizeof *told->files))
		return false;
	told->files[told->file_count++] = (struct rb_source_file){
		.name = name, .text = text, .size_bytes = size};
	return true;
}

/* Appends NAME=VALUE. False: no memory. */
static bool add_param(struct told *told, const char *name, const char *value)
{
	const size_t size = strlen(name) + strlen(value) + 2;
	char *const text = rb_memory_take(size, 1);

	if (!text || !rb_memory_reserve(&told->params, &told->param_room,
	                                (size_t)told->param_count + 1, sizeof *told->params)) {
		rb_memory_free(text);
		return false;
	}
	snprintf(text, size, "%s=%s", name, value);
	told->params[told->param_count++] = text;
	return true;
}

/*
 * Takes "file NAME TEXT" or "param NAME VALUE", the words in base64. False: it is none, or no
 * memory.
 */
static bool take_texts(struct told *told, const char *line, size_t size)
{
	const bool file = strncmp(line, "file ", 5) == 0;
	const char *const name = line + (file ? 5 : 6);
	const size_t name_size = strcspn(name, " \n");
	const size_t used = (size_t)(name - line) + name_size + 1;
	size_t name_bytes, bytes;

	if (used > size)
		return false;
	char *const first = decode(name, name_size, &name_bytes);
	char *const second = decode(line + used, size - used, &bytes);
	bool good = first && second;
	if (good && file)
		good = add_file(told, first, second, bytes);
	else if (good)
		good = add_param(told, first, second);
	if (!good || !file) {
		rb_memory_free(first);
		rb_memory_free(second);
	}
	return good;
}

/* Takes one line of the answer; keys that are not known are skipped. */
static bool take_line(struct told *told, const char *line, size_t size)
{
	static const struct {
		const char *key;
		size_t offset;
	} numbers[] = {{"duration ", offsetof(struct told, duration_s)},
	               {"frame-rate ", offsetof(struct told, frame_rate)},
	               {"time-step ", offsetof(struct told, time_step_s)},
	               {"tolerance ", offsetof(struct told, tolerance_m)},
	               {"stepped-tolerance ", offsetof(struct told, stepped_tolerance_m)}};

	if (strncmp(line, "file ", 5) == 0 || strncmp(line, "param ", 6) == 0)
		return take_texts(told, line, size);
	if (strncmp(line, "bodies ", 7) == 0)
		return sscanf(line + 7, "%d %d", &told->body_count, &told->static_count) == 2;
	if (strncmp(line, "seed ", 5) == 0)
		told->seed = strtoull(line + 5, NULL, 10);
	for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
		if (strncmp(line, numbers[i].key, strlen(numbers[i].key)) == 0)
			*(double *)((char *)told + numbers[i].offset) = strtod(
				line + strlen(numbers[i].key), NULL);
	return true;
}

/* Takes the whole answer. */
static enum rb_status take_scene(struct told *told, const char *lines, struct rb_error *err)
{
	while (*lines) {
		const size_t size = strcspn(lines, "\n");
		if (!take_line(told, lines, size))
			return RB_FAIL(err, RB_ERR_MISSING,
			               "the run's answer to 'scene' can't be read");
		lines += size + (lines[size] == '\n');
	}
	if (told->file_count == 0)
		return RB_FAIL(err, RB_ERR_MISSING, "the run does not send its scene");
	return RB_OK;
}

/* Loads the scene and makes the model. */
static enum rb_status load(struct rb_loaded *loaded, const struct told *told, bool trust,
                           struct rb_error *err)
{
	const struct rb_script_options options = {
		.path = told->files[0].name,
		.params = (const char *const *)told->params,
		.param_count = told->param_count,
		.has_seed = true,
		.seed = told->seed,
		.files = told->files,
		.file_count = told->file_count,
		.trust = trust,
	};
	enum rb_status status = rb_script_load(&loaded->script, &loaded->scene, &loaded->mistakes,
	                                       &options, err);

	RB_ASSERT(told->file_count > 0);
	if (status)
		return status;
	struct rb_world_def *const world = &loaded->scene.world;
	world->duration_s = told->duration_s;
	world->frame_rate = told->frame_rate;
	world->time_step_s = told->time_step_s;
	world->tolerance_m = told->tolerance_m;
	world->stepped_tolerance_m = told->stepped_tolerance_m;
	status = rb_model_create(&loaded->model, &loaded->scene, &loaded->mistakes, err);
	if (!status && (loaded->model->body_count != told->body_count ||
	                loaded->model->static_count != told->static_count))
		return RB_FAIL(err, RB_ERR_INPUT,
		               "the scene of the run gives %d moving bodies here, there are %d",
		               loaded->model->body_count, told->body_count);
	return status;
}

/*
 * Path of the recording, to be freed, which the run states from its own folder; NULL: there is
 * none.
 */
static enum rb_status find_recording(char **recording, const char *lines, struct rb_error *err)
{
	const char *folder = NULL, *name = NULL;

	for (const char *line = lines; line && *line;) {
		if (strncmp(line, "folder ", 7) == 0)
			folder = line + 7;
		if (strncmp(line, "recording ", 10) == 0)
			name = line + 10;
		line = strchr(line, '\n');
		line += line != NULL;
	}
	if (!name)
		return RB_OK;
	const int folder_size = folder && name[0] != '/' ? (int)strcspn(folder, "\n") : 0;
	const int name_size = (int)strcspn(name, "\n");
	*recording = rb_memory_take((size_t)folder_size + (size_t)name_size + 2, 1);
	if (!*recording)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot attach: out of memory");
	sprintf(*recording, "%.*s%s%.*s", folder_size, folder ? folder : "",
	        folder_size > 0 ? "/" : "", name_size, name);
	return RB_OK;
}

/* Asks, again and again while the run answers that it is restarting. */
static enum rb_status ask(struct rb_client *client, const char *line, const char **lines,
                          struct rb_error *err)
{
	enum rb_status status = RB_ERR_USAGE;
	size_t size;

	for (int i = 0; i < TRIES && status == RB_ERR_USAGE; i++) {
		if (i > 0)
			rest(TRY_MS);
		status = rb_client_request(client, line, answer_s, lines, &size, err);
	}
	return status;
}

enum rb_status rb_attached_load(struct rb_loaded *loaded, char **recording,
                                struct rb_client *client, bool trust, struct rb_error *err)
{
	struct told told = {0};
	const char *lines;

	*loaded = (struct rb_loaded){0};
	*recording = NULL;
	enum rb_status status = ask(client, "hello", &lines, err);
	if (!status)
		status = find_recording(recording, lines, err);
	if (!status)
		status = ask(client, "scene", &lines, err);
	if (!status)
		status = take_scene(&told, lines, err);
	if (!status)
		status = load(loaded, &told, trust, err);
	release(&told);
	if (status) {
		rb_memory_free(*recording);
		*recording = NULL;
	}
	return status;
}

/* ---- a process of its own ---- */

/*
 * A name in the first usable folder of three, short enough for the system, which allows 107 bytes.
 */
static void name_socket(char address[108])
{
	const char *const places[] = {getenv("XDG_RUNTIME_DIR"), getenv("TMPDIR"), "/tmp"};

	for (int i = 0; i < 3; i++)
		if (places[i] && places[i][0] == '/' && strlen(places[i]) < 70) {
			snprintf(address, 108, "%s/rbsim-%ld.socket", places[i], (long)getpid());
			return;
		}
}

/* How many words from the i-th on are for the console alone; 0: none. */
static int words_of_console(char *const *argv, int i, int argc)
{
	static const char *const options[] = {"--fps", "--speed"};

	if (strcmp(argv[i], "--detach") == 0)
		return 1;
	for (size_t k = 0; k < sizeof options / sizeof *options; k++) {
		const size_t size = strlen(options[k]);
		if (strcmp(argv[i], options[k]) == 0)
			return i + 1 < argc ? 2 : 1;
		if (strncmp(argv[i], options[k], size) == 0 && argv[i][size] == '=')
			return 1;
	}
	return 0;
}

/* The words of the run, to be freed; NULL: no memory. */
static const char **make_words(const struct rb_process *child, const struct rb_options *options,
                               const struct rb_viewer_run *again)
{
	static const char verb[] = "console";
	const int set_count = again ? again->set_count : 0;
	const char **const words = rb_memory_take((size_t)options->argc + (size_t)set_count * 2 + 8,
	                                          sizeof *words);
	bool seen = false;
	int count = 0, last = options->argc;

	if (!words)
		return NULL;
	words[count++] = options->argv[0];
	words[count++] = "run";
	words[count++] = "--listen";
	words[count++] = child->address;
	if (again && !options->no_record)
		words[count++] = "--force";
	/* of two values of a parameter the last one counts; after -- there are only files */
	for (int i = options->argc - 1; i > 0; i--)
		if (strcmp(options->argv[i], "--") == 0)
			last = i;
	for (int i = 1; i <= options->argc; i++) {
		for (int k = 0; i == last && k < set_count; k++) {
			words[count++] = "--param";
			words[count++] = again->sets[k].text;
		}
		if (i == options->argc)
			break;
		const int skip = words_of_console(options->argv, i, options->argc);
		if (skip > 0)
			i += skip - 1;
		else if (!seen && strcmp(options->argv[i], verb) == 0)
			seen = true;
		else
			words[count++] = options->argv[i];
	}
	return words;
}

/*
 * The child after fork: only what may be called between fork and exec. `errors`: where its standard
 * error goes.
 */
_Noreturn static void become_run(const char **words, int errors, bool stays, pid_t parent)
{
	const int nothing = open("/dev/null", O_RDWR);

	/* keys that send signals are for the console; it passes on what is for the run */
	setpgid(0, 0);
	if (!stays)
		prctl(PR_SET_PDEATHSIG, SIGTERM);
	if (!stays && getppid() != parent)
		_exit(127);
	dup2(nothing, STDIN_FILENO);
	dup2(nothing, STDOUT_FILENO);
	dup2(errors, STDERR_FILENO);
	execv(RB_PROGRAM_AGAIN, (char *const *)(uintptr_t)words);
	_exit(127);
}

enum rb_status rb_process_start(struct rb_process *child, const struct rb_options *options,
                                const struct rb_viewer_run *again, struct rb_error *err)
{
	const pid_t parent = getpid();
	char program[PATH_MAX];
	int ends[2];

	*child = (struct rb_process){.errors = -1};
	const enum rb_status status = rb_program_path(program, err);
	if (status)
		return status;
	name_socket(child->address);
	const char **const words = make_words(child, options, again);
	if (!words)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot start a run: out of memory");
	if (pipe2(ends, O_CLOEXEC) < 0) {
		rb_memory_free(words);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a run: %s", strerror(errno));
	}
	const pid_t process = fork();
	if (process == 0)
		become_run(words, ends[1], options->detach, parent);
	const int reason = errno;
	close(ends[1]);
	rb_memory_free(words);
	if (process < 0) {
		close(ends[0]);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot start a run: %s", strerror(reason));
	}
	fcntl(ends[0], F_SETFL, O_NONBLOCK);
	child->process = process;
	child->errors = ends[0];
	return RB_OK;
}

bool rb_process_lives(struct rb_process *child)
{
	int status;

	if (child->process == 0 || waitpid(child->process, &status, WNOHANG) == 0)
		return child->process != 0;
	child->process = 0;
	child->exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
	return false;
}

enum rb_status rb_process_connect(struct rb_process *child, struct rb_client **client,
                                  struct rb_error *err)
{
	enum rb_status status = RB_ERR_INPUT;

	*client = NULL;
	while (status == RB_ERR_INPUT && rb_process_lives(child)) {
		status = rb_client_connect(client, child->address, connect_s, err);
		if (status)
			rest(TRY_MS);
	}
	/* one that was over sooner than it could be talked to */
	return *client || !rb_process_lives(child) ? RB_OK : status;
}

void rb_process_end(struct rb_process *child)
{
	if (!rb_process_lives(child))
		return;
	kill(child->process, SIGTERM);
	for (int waited = 0; waited < PATIENCE_MS && rb_process_lives(child); waited += TRY_MS) {
		char bytes[512];
		rest(TRY_MS);
		/* it must not wait for somebody to read what it says */
		while (read(child->errors, bytes, sizeof bytes) > 0)
			;
	}
	if (child->process != 0) {
		kill(child->process, SIGKILL);
		waitpid(child->process, NULL, 0);
		child->process = 0;
		child->exit_code = 128 + SIGKILL;
	}
}

void rb_process_release(struct rb_process *child)
{
	if (child->errors >= 0)
		close(child->errors);
	child->errors = -1;
}
