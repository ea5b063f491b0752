/* SPDX-License-Identifier: MIT */
#include "film/encoder.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"

extern char **environ;

enum {
	ARGUMENTS_MAX = 64,
	ARGUMENT_SIZE = 64,
	SAID_SIZE = 2048,
	PIPE_SIZE = 1 << 20,
	LIST_SIZE = 1 << 18,
	GIF_FPS_MAX = 50 /* delays are hundredths of a second, and of 1 most programs make 10 */
};

static const double list_timeout_s = 5, pause_ms = 50;

enum format { FORMAT_MP4, FORMAT_WEBM, FORMAT_GIF, FORMAT_COUNT };

struct coder {
	const char *name;
	const char *arguments[20]; /* of ffmpeg, for the output */
};

/* The colours of a picture are sRGB; what a player is told is BT.709, which has the same primaries. */
#define BT709                                                                       \
	"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", \
		"-color_range", "tv"
#define TO_YUV "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd"

static const struct {
	const char *ending, *muxer, *filter;
	struct coder coders[2]; /* the better one first */
} formats[FORMAT_COUNT] = {
	[FORMAT_MP4] = {".mp4",
                        "mp4",
                        TO_YUV ",format=yuv420p",
                        {{"libx264",
                          {"-preset", "veryfast", "-crf", "18", "-movflags", "+faststart",
                           BT709}}}},
	[FORMAT_WEBM] = {".webm",
                         "webm",
                         TO_YUV ",format=yuv420p",
                         {{"libvpx-vp9",
                           {"-deadline", "realtime", "-cpu-used", "8", "-row-mt", "1", "-crf", "30",
                            "-b:v", "0", BT709}},
                          {"libvpx",
                           {"-deadline", "realtime", "-cpu-used", "8", "-crf", "10", "-b:v", "20M",
                            BT709}}}},
	[FORMAT_GIF] = {".gif", "gif", NULL, {{"gif", {NULL}}}},
};

/* A program at work. */
struct child {
	pid_t pid;            /* 0: none */
	int in, out;          /* -1: none */
	int complaints;       /* its standard error; -1: none or at its end */
	char said[SAID_SIZE]; /* the end of what it said there */
	size_t said_size;
};

struct arguments {
	const char *list[ARGUMENTS_MAX];
	int count;
};

struct rb_encoder {
	enum format format;
	const char *coder_name;
	int width, height;               /* of pictures */
	int padded_width, padded_height; /* as ffmpeg gets them */
	uint8_t *padded;                 /* owned; NULL where they are the same */
	uint64_t pictures;
	bool failed;
	char *title;
	char size[ARGUMENT_SIZE], rate[ARGUMENT_SIZE];
	double fps;

	char *path;            /* owned */
	struct rb_outfile out; /* ffmpeg writes it by its name */
	/* of a gif: pictures without loss and the palette, both of which its second pass reads */
	char *pictures_path, *palette_path;
	struct child child;
};

static const char *program(void)
{
	const char *const named = getenv("RBSIM_FFMPEG");

	return named && *named ? named : "ffmpeg";
}

/* ---- children ---- */

static void close_end(int *end)
{
	if (*end >= 0)
		close(*end);
	*end = -1;
}

static int set_up(posix_spawn_file_actions_t *actions, posix_spawnattr_t *attributes, int in,
                  int out, int complaints)
{
	sigset_t none, all;
	int failed = posix_spawn_file_actions_init(actions);

	if (failed)
		return failed;
	failed = posix_spawnattr_init(attributes);
	if (failed) {
		posix_spawn_file_actions_destroy(actions);
		return failed;
	}
	sigemptyset(&none);
	sigfillset(&all);
	/* A group of its own: ctrl-C at the terminal is for us, and the film is then finished. */
	posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
	                                             POSIX_SPAWN_SETSIGDEF);
	posix_spawnattr_setpgroup(attributes, 0);
	posix_spawnattr_setsigmask(attributes, &none);
	posix_spawnattr_setsigdefault(attributes, &all);
	if (in >= 0)
		failed |= posix_spawn_file_actions_adddup2(actions, in, 0);
	else
		failed |= posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
	if (out >= 0)
		failed |= posix_spawn_file_actions_adddup2(actions, out, 1);
	else
		failed |= posix_spawn_file_actions_addopen(actions, 1, "/dev/null", O_WRONLY, 0);
	failed |= posix_spawn_file_actions_adddup2(actions, complaints, 2);
	/* whatever other libraries have opened without asking for close-on-exec */
	failed |= posix_spawn_file_actions_addclosefrom_np(actions, 3);
	return failed;
}

/* Above the standard three, so that setting these up in the child does not overwrite one. */
static bool make_pipe(int ends[2])
{
	if (pipe2(ends, O_CLOEXEC) != 0)
		return false;
	for (int i = 0; i < 2; i++) {
		if (ends[i] > 2)
			continue;
		const int moved = fcntl(ends[i], F_DUPFD_CLOEXEC, 3);
		close(ends[i]);
		ends[i] = moved;
	}
	if (ends[0] >= 0 && ends[1] >= 0)
		return true;
	close_end(&ends[0]);
	close_end(&ends[1]);
	return false;
}

static int spawn(struct child *child, const struct arguments *arguments, const int in[2],
                 const int out[2], const int complaints[2])
{
	posix_spawn_file_actions_t actions;
	posix_spawnattr_t attributes;
	char *list[ARGUMENTS_MAX + 1];

	int failed = set_up(&actions, &attributes, in[0], out[1], complaints[1]);
	if (failed)
		return failed;
	/* the system's prototype lacks a const that it keeps to */
	memcpy(list, arguments->list, sizeof arguments->list);
	list[arguments->count] = NULL;
	failed = posix_spawnp(&child->pid, list[0], &actions, &attributes, list, environ);
	posix_spawn_file_actions_destroy(&actions);
	posix_spawnattr_destroy(&attributes);
	return failed;
}

/* With a pipe to its input, or one from its output, and always one from its standard error. */
static enum rb_status start(struct child *child, const struct arguments *arguments, bool feeds,
                            bool listens, struct rb_error *err)
{
	int in[2] = {-1, -1}, out[2] = {-1, -1}, complaints[2] = {-1, -1};
	int failed = 0;

	*child = (struct child){.in = -1, .out = -1, .complaints = -1};
	if ((feeds && !make_pipe(in)) || (listens && !make_pipe(out)) || !make_pipe(complaints))
		failed = errno;
	if (!failed)
		failed = spawn(child, arguments, in, out, complaints);
	close_end(&in[0]);
	close_end(&out[1]);
	close_end(&complaints[1]);
	if (failed) {
		child->pid = 0;
		close_end(&in[1]);
		close_end(&out[0]);
		close_end(&complaints[0]);
		return RB_FAIL(
			err, RB_ERR_MISSING,
			"cannot run '%s': %s (video needs ffmpeg: install it, or name it in RBSIM_FFMPEG; PNG does not need it)",
			arguments->list[0], strerror(failed));
	}
	child->in = in[1];
	child->out = out[0];
	child->complaints = complaints[0];
	if (child->in >= 0) {
		fcntl(child->in, F_SETFL, O_NONBLOCK);
		fcntl(child->in, F_SETPIPE_SZ, PIPE_SIZE); /* only faster, where it may */
	}
	fcntl(child->complaints, F_SETFL, O_NONBLOCK);
	return RB_OK;
}

/* What has come on its standard error; the end of it is kept. */
static void hear(struct child *child)
{
	char chunk[512];

	while (child->complaints >= 0) {
		const ssize_t size = read(child->complaints, chunk, sizeof chunk);
		if (size < 0 && errno == EINTR)
			continue;
		if (size < 0 && errno == EAGAIN)
			return;
		if (size <= 0) {
			close_end(&child->complaints);
			return;
		}
		const size_t room = sizeof child->said - 1, got = (size_t)size;
		if (child->said_size + got > room) {
			const size_t gone = child->said_size + got - room;
			memmove(child->said, child->said + gone, child->said_size - gone);
			child->said_size -= gone;
		}
		memcpy(child->said + child->said_size, chunk, got);
		child->said_size += got;
		child->said[child->said_size] = '\0';
	}
}

/* Its exit, as waitpid tells it, heard out to the end. */
static int wait_for(struct child *child)
{
	int outcome = 0;
	pid_t ended = 0;

	close_end(&child->in);
	while (ended == 0) {
		struct pollfd wish = {.fd = child->complaints, .events = POLLIN};
		if (child->complaints >= 0)
			poll(&wish, 1, (int)pause_ms);
		hear(child);
		/* its own children may keep the pipe open for longer than it lives */
		ended = waitpid(child->pid, &outcome, child->complaints >= 0 ? WNOHANG : 0);
		if (ended < 0 && errno == EINTR)
			ended = 0;
	}
	hear(child);
	close_end(&child->complaints);
	close_end(&child->out);
	child->pid = 0;
	return outcome;
}

static void stop(struct child *child)
{
	if (child->pid > 0) {
		kill(-child->pid, SIGKILL);
		kill(child->pid, SIGKILL);
		(void)wait_for(child);
	}
}

/* The last line with something on it. */
static const char *last_words(struct child *child)
{
	char *const said = child->said;
	size_t end = child->said_size;

	while (end > 0 && strchr("\r\n \t", said[end - 1]))
		end--;
	said[end] = '\0';
	while (end > 0 && said[end - 1] != '\n' && said[end - 1] != '\r')
		end--;
	return said[end] ? said + end : "it said nothing";
}

static enum rb_status tell_exit(struct child *child, int outcome, struct rb_error *err)
{
	if (WIFSIGNALED(outcome))
		return RB_FAIL(err, RB_ERR_MISSING, "'%s' was ended by signal %d (%s): %.120s",
		               program(), WTERMSIG(outcome), strsignal(WTERMSIG(outcome)),
		               last_words(child));
	return RB_FAIL(err, RB_ERR_MISSING, "'%s' has failed with exit status %d: %.140s",
	               program(), WEXITSTATUS(outcome), last_words(child));
}

static enum rb_status finish_child(struct child *child, struct rb_error *err)
{
	const int outcome = wait_for(child);

	return outcome == 0 ? RB_OK : tell_exit(child, outcome, err);
}

/* ---- what ffmpeg can do ---- */

/* All that it says on its standard output, up to LIST_SIZE. */
static enum rb_status read_list(struct child *child, char *list, struct rb_error *err)
{
	const uint64_t begin = rb_clock_now_ns();
	size_t size = 0;
	ssize_t got = 1;

	while (got != 0 && size < LIST_SIZE - 1) {
		struct pollfd wish = {.fd = child->out, .events = POLLIN};
		hear(child);
		if ((double)(rb_clock_now_ns() - begin) * 1e-9 > list_timeout_s) {
			stop(child);
			return RB_FAIL(err, RB_ERR_MISSING,
			               "'%s' does not say within %g s what it can do", program(),
			               list_timeout_s);
		}
		if (poll(&wish, 1, (int)pause_ms) <= 0)
			continue;
		got = read(child->out, list + size, LIST_SIZE - 1 - size);
		if (got > 0)
			size += (size_t)got;
		else if (got < 0 && errno != EINTR)
			break;
	}
	list[size] = '\0';
	close_end(&child->out);
	return finish_child(child, err);
}

/* A line " V....D libx264   H.264 ...": the second word is the name. */
static bool lists(const char *list, const char *name)
{
	const size_t size = strlen(name);

	for (const char *line = list; line; line = strchr(line, '\n')) {
		line += strspn(line, "\n ");
		const char *const word = line + strcspn(line, " \n") + 1;
		if (*line == 'V' && strncmp(word, name, size) == 0 && word[size] == ' ')
			return true;
	}
	return false;
}

static enum rb_status find_coder(enum format format, const struct coder **coder,
                                 struct rb_error *err)
{
	const struct arguments arguments = {{program(), "-hide_banner", "-encoders"}, 3};
	struct child child;
	char *const list = rb_memory_take(LIST_SIZE, 1);

	if (!list)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot look for '%s': out of memory",
		               program());
	*coder = NULL;
	enum rb_status status = start(&child, &arguments, false, true, err);
	if (!status)
		status = read_list(&child, list, err);
	for (int i = 0; i < 2 && !status && !*coder; i++)
		if (formats[format].coders[i].name && lists(list, formats[format].coders[i].name))
			*coder = &formats[format].coders[i];
	rb_memory_free(list);
	if (!status && !*coder)
		status = RB_FAIL(err, RB_ERR_MISSING,
		                 "'%s' has no encoder '%s', which %s needs (install one that has, "
		                 "or choose another ending)",
		                 program(), formats[format].coders[0].name, formats[format].ending);
	return status;
}

static enum rb_status find_format(const char *path, enum format *format, struct rb_error *err)
{
	const char *const dot = strrchr(path, '.');

	for (int i = 0; i < FORMAT_COUNT; i++)
		if (dot && strcmp(dot, formats[i].ending) == 0) {
			*format = (enum format)i;
			return RB_OK;
		}
	return RB_FAIL(err, RB_ERR_SCENE, "video '%s': its name must end in .mp4, .webm or .gif",
	               path);
}

enum rb_status rb_encoder_check(const struct rb_encoder_options *options, struct rb_error *err)
{
	const struct coder *coder;
	enum format format;
	enum rb_status status = find_format(options->path, &format, err);

	if (!status)
		status = rb_outfile_probe(options->path, options->replace, err);
	if (!status)
		status = find_coder(format, &coder, err);
	return status;
}

/* ---- encoding ---- */

static void add(struct arguments *arguments, const char *text)
{
	RB_ASSERT(arguments->count < ARGUMENTS_MAX);
	arguments->list[arguments->count++] = text;
}

static void add_pair(struct arguments *arguments, const char *option, const char *value)
{
	add(arguments, option);
	add(arguments, value);
}

static void begin(struct arguments *arguments)
{
	*arguments = (struct arguments){0};
	add(arguments, program());
	add(arguments, "-hide_banner");
	add(arguments, "-nostdin");
	add_pair(arguments, "-loglevel", "error");
	add(arguments, "-y");
}

static void add_pictures(struct arguments *arguments, const struct rb_encoder *encoder)
{
	add_pair(arguments, "-f", "rawvideo");
	add_pair(arguments, "-pix_fmt", "rgba");
	add_pair(arguments, "-s", encoder->size);
	add_pair(arguments, "-framerate", encoder->rate);
	add_pair(arguments, "-i", "pipe:0");
}

/* "file:NAME", since a name may look like an option or a protocol. Owned by the caller. */
static char *file_name(const char *path, const char *ending)
{
	static const char protocol[] = "file:";
	const size_t size = sizeof protocol + strlen(path) + strlen(ending);
	char *const name = rb_memory_take(size, 1);

	if (name)
		snprintf(name, size, "%s%s%s", protocol, path, ending);
	return name;
}

/* The shortest text that is the number: 60, 29.97, from which ffmpeg makes the fraction. */
static void print_rate(char out[ARGUMENT_SIZE], double fps)
{
	for (int digits = 1; digits <= 17; digits++) {
		snprintf(out, ARGUMENT_SIZE, "%.*g", digits, fps);
		if (strtod(out, NULL) == fps && !strpbrk(out, "eE"))
			return;
	}
	snprintf(out, ARGUMENT_SIZE, "%.12f", fps);
}

static enum rb_status start_film(struct rb_encoder *encoder, const struct coder *coder,
                                 const char *output, struct rb_error *err)
{
	struct arguments arguments;

	begin(&arguments);
	add_pictures(&arguments, encoder);
	add_pair(&arguments, "-vf", formats[encoder->format].filter);
	add_pair(&arguments, "-c:v", coder->name);
	for (int i = 0; coder->arguments[i]; i++)
		add(&arguments, coder->arguments[i]);
	if (*encoder->title)
		add_pair(&arguments, "-metadata", encoder->title);
	add_pair(&arguments, "-f", formats[encoder->format].muxer);
	add(&arguments, output);
	return start(&encoder->child, &arguments, true, false, err);
}

/*
 * A palette for the whole film is known only at its end. Pictures are kept until then without loss, in a file and not
 * in ffmpeg's memory, which would take as much as all of them.
 */
static enum rb_status start_gif(struct rb_encoder *encoder, struct rb_error *err)
{
	struct arguments arguments;
	char graph[160];
	/* of 60 pictures a second every second one: even steps look better than the rate itself */
	const double fps = encoder->fps / ceil(encoder->fps / GIF_FPS_MAX);

	snprintf(graph, sizeof graph,
	         "[0:v]fps=%.12g,format=bgr0,split[kept][seen];"
	         "[seen]palettegen=reserve_transparent=0:stats_mode=full[palette]",
	         fps);
	begin(&arguments);
	add_pictures(&arguments, encoder);
	add_pair(&arguments, "-filter_complex", graph);
	add_pair(&arguments, "-map", "[kept]");
	add_pair(&arguments, "-c:v", "ffv1");
	add_pair(&arguments, "-level", "3");
	add_pair(&arguments, "-f", "nut");
	add(&arguments, encoder->pictures_path);
	add_pair(&arguments, "-map", "[palette]");
	add_pair(&arguments, "-c:v", "rawvideo");
	add_pair(&arguments, "-pix_fmt", "bgra");
	add_pair(&arguments, "-f", "rawvideo");
	add(&arguments, encoder->palette_path);
	return start(&encoder->child, &arguments, true, false, err);
}

static enum rb_status second_pass(struct rb_encoder *encoder, const char *output,
                                  struct rb_error *err)
{
	struct arguments arguments;

	begin(&arguments);
	add_pair(&arguments, "-i", encoder->pictures_path);
	add_pair(&arguments, "-f", "rawvideo");
	add_pair(&arguments, "-pix_fmt", "bgra");
	add_pair(&arguments, "-s", "16x16");
	add_pair(&arguments, "-i", encoder->palette_path);
	/* a pattern of dots that stands still where the picture does */
	add_pair(&arguments, "-filter_complex",
	         "[0:v][1:v]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle");
	add_pair(&arguments, "-f", "gif");
	add(&arguments, output);
	const enum rb_status status = start(&encoder->child, &arguments, false, false, err);
	return status ? status : finish_child(&encoder->child, err);
}

static enum rb_status no_memory(const char *path, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot encode '%s': out of memory", path);
}

static enum rb_status set_sizes(struct rb_encoder *encoder,
                                const struct rb_encoder_options *options, struct rb_error *err)
{
	const int even = encoder->format == FORMAT_GIF ? 0 : 1; /* chroma is halved in the others */

	encoder->width = options->width;
	encoder->height = options->height;
	encoder->padded_width = options->width + (options->width & even);
	encoder->padded_height = options->height + (options->height & even);
	snprintf(encoder->size, sizeof encoder->size, "%dx%d", encoder->padded_width,
	         encoder->padded_height);
	encoder->fps = options->fps;
	print_rate(encoder->rate, options->fps);
	if (encoder->padded_width == encoder->width && encoder->padded_height == encoder->height)
		return RB_OK;
	encoder->padded = rb_memory_take(
		(size_t)encoder->padded_width * (size_t)encoder->padded_height, 4);
	return encoder->padded ? RB_OK : no_memory(options->path, err);
}

static enum rb_status set_names(struct rb_encoder *encoder,
                                const struct rb_encoder_options *options, struct rb_error *err)
{
	static const char key[] = "title=";
	const char *const title = options->title ? options->title : "";

	encoder->path = rb_memory_copy_text(options->path);
	encoder->title = rb_memory_take(sizeof key + strlen(title), 1);
	if (!encoder->path || !encoder->title)
		return no_memory(options->path, err);
	if (*title)
		sprintf(encoder->title, "%s%s", key, title);
	const enum rb_status status = rb_outfile_open(&encoder->out, encoder->path,
	                                              options->replace, err);
	if (status || encoder->format != FORMAT_GIF)
		return status;
	encoder->pictures_path = file_name(encoder->out.partial, ".pictures");
	encoder->palette_path = file_name(encoder->out.partial, ".palette");
	return encoder->pictures_path && encoder->palette_path ? RB_OK
	                                                       : no_memory(options->path, err);
}

static enum rb_status set_up_encoder(struct rb_encoder *encoder,
                                     const struct rb_encoder_options *options, struct rb_error *err)
{
	const struct coder *coder;
	enum rb_status status = find_format(options->path, &encoder->format, err);

	if (!status)
		status = find_coder(encoder->format, &coder, err);
	if (!status)
		status = set_sizes(encoder, options, err);
	if (!status)
		status = set_names(encoder, options, err);
	if (status)
		return status;
	if (encoder->format == FORMAT_GIF)
		return start_gif(encoder, err);
	char *const output = file_name(encoder->out.partial, "");
	if (!output)
		return no_memory(options->path, err);
	status = start_film(encoder, coder, output, err);
	rb_memory_free(output);
	return status;
}

enum rb_status rb_encoder_create(struct rb_encoder **encoder,
                                 const struct rb_encoder_options *options, struct rb_error *err)
{
	RB_ASSERT(options->width > 0 && options->height > 0 && options->fps > 0);
	*encoder = rb_memory_take(1, sizeof **encoder);
	if (!*encoder)
		return no_memory(options->path, err);
	(*encoder)->child = (struct child){.in = -1, .out = -1, .complaints = -1};
	const enum rb_status status = set_up_encoder(*encoder, options, err);
	if (status) {
		rb_encoder_destroy(*encoder);
		*encoder = NULL;
	}
	return status;
}

/* The last column and row once more: nobody sees a seam. */
static void pad(const struct rb_encoder *encoder, const struct rb_pixmap *pixmap)
{
	const size_t row = 4 * (size_t)encoder->width, padded = 4 * (size_t)encoder->padded_width;

	for (int y = 0; y < encoder->padded_height; y++) {
		const int from = y < encoder->height ? y : encoder->height - 1;
		uint8_t *const to = encoder->padded + padded * (size_t)y;
		memcpy(to, pixmap->rgba + row * (size_t)from, row);
		if (padded > row)
			memcpy(to + row, to + row - 4, 4);
	}
}

/*
 * Down the pipe, listening at the same time: who waits on neither side can't be waited for. False: the pipe is
 * broken.
 */
static bool feed(struct child *child, const uint8_t *bytes, size_t size)
{
	while (size > 0) {
		const ssize_t sent = write(child->in, bytes, size);
		if (sent > 0) {
			bytes += sent;
			size -= (size_t)sent;
			continue;
		}
		if (sent < 0 && errno != EAGAIN && errno != EINTR)
			return false;
		struct pollfd wishes[2] = {{.fd = child->in, .events = POLLOUT},
		                           {.fd = child->complaints, .events = POLLIN}};
		poll(wishes, 2, -1);
		if (wishes[1].revents)
			hear(child);
	}
	return true;
}

enum rb_status rb_encoder_picture(struct rb_encoder *encoder, const struct rb_pixmap *pixmap,
                                  struct rb_error *err)
{
	const uint8_t *bytes = pixmap->rgba;

	RB_ASSERT(pixmap->width == encoder->width && pixmap->height == encoder->height);
	RB_ASSERT(!encoder->failed);
	if (encoder->padded) {
		pad(encoder, pixmap);
		bytes = encoder->padded;
	}
	encoder->pictures++;
	if (feed(&encoder->child, bytes,
	         4 * (size_t)encoder->padded_width * (size_t)encoder->padded_height))
		return RB_OK;
	encoder->failed = true;
	const int outcome = wait_for(&encoder->child);
	if (outcome == 0)
		return RB_FAIL(err, RB_ERR_MISSING, "'%s' has ended before the film: %.140s",
		               program(), last_words(&encoder->child));
	return tell_exit(&encoder->child, outcome, err);
}

enum rb_status rb_encoder_finish(struct rb_encoder *encoder, bool discard, uint64_t *bytes,
                                 struct rb_error *err)
{
	struct stat found;

	if (bytes)
		*bytes = 0;
	if (discard || encoder->failed || encoder->pictures == 0) {
		stop(&encoder->child);
		rb_outfile_release(&encoder->out);
		return RB_OK;
	}
	enum rb_status status = finish_child(&encoder->child, err);
	if (!status && encoder->format == FORMAT_GIF) {
		char *const output = file_name(encoder->out.partial, "");
		status = output ? second_pass(encoder, output, err) : no_memory(encoder->path, err);
		rb_memory_free(output);
	}
	encoder->failed = true; /* it takes no more pictures */
	if (status) {
		rb_outfile_release(&encoder->out);
		return status;
	}
	if (bytes && stat(encoder->out.partial, &found) == 0)
		*bytes = (uint64_t)found.st_size;
	return rb_outfile_publish(&encoder->out, err);
}

/* By the name that ffmpeg was given. */
static void remove_named(char *name)
{
	if (name)
		unlink(name + strlen("file:"));
	rb_memory_free(name);
}

void rb_encoder_destroy(struct rb_encoder *encoder)
{
	if (!encoder)
		return;
	stop(&encoder->child);
	rb_outfile_release(&encoder->out);
	remove_named(encoder->pictures_path);
	remove_named(encoder->palette_path);
	rb_memory_free(encoder->padded);
	rb_memory_free(encoder->title);
	rb_memory_free(encoder->path);
	rb_memory_free(encoder);
}
