/* SPDX-License-Identifier: MIT */
/*
 * Films are made by an ffmpeg process that reads raw pictures from a pipe. Linking libavcodec is
 * not done: its licence, patents and versions would become ours, and a crash in it would end the
 * run. The output is a descriptor of a temporary file beside the final one, which ffmpeg inherits
 * and names by /proc/self/fd, so that it can neither be redirected nor left half done under the
 * final name.
 *
 * Bits of a film depend on ffmpeg; those of the pictures do not.
 */
#include "film/encoder.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/outfile.h"
#include "film/child.h"

enum {
	ARGUMENTS_MAX = 64,
	ARGUMENT_SIZE = 64,
	LIST_SIZE = 1 << 18,
	PAUSE_MS = 50,
	WRITE_SIZE = 1 << 16, /* twice what ffmpeg writes at once */
	GIF_FPS_MAX = 50 /* delays are hundredths of a second, and of 1 most programs make 10 */
};

/*
 * Seconds without a sign of life: a disk that spins up or other work on all processors takes
 * seconds; more is an option.
 */
static const double patience_s = 60;

/* By the ending of the name. */
enum format { FORMAT_MP4, FORMAT_WEBM, FORMAT_GIF, FORMAT_COUNT };

struct coder {
	const char *name;
	const char *arguments[20]; /* of ffmpeg, for the output */
};

/* Pictures are sRGB, films are tagged BT.709, which has the same primaries. */
#define BT709                                                                       \
	"-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709", \
		"-color_range", "tv"
#define TO_YUV "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd"

static const struct {
	const char *ending, *muxer, *filter;
	/*
	 * Pictures per second. Their times are milliseconds in a webm, and in a player's hands. A
	 * gif's delays have 16 bits of hundredths of a second; a quarter of an hour for a picture
	 * is more than anybody looks at a film.
	 */
	double fps_min, fps_max;
	struct coder coders[2]; /* the better one first */
} formats[FORMAT_COUNT] = {
	[FORMAT_MP4] = {".mp4",
                        "mp4",
                        TO_YUV ",format=yuv420p",
                        0.001,
                        1000,
                        {{"libx264",
                          {"-preset", "veryfast", "-crf", "18", "-movflags", "+faststart",
                           BT709}}}},
	[FORMAT_WEBM] = {".webm",
                         "webm",
                         TO_YUV ",format=yuv420p",
                         0.001,
                         1000,
                         {{"libvpx-vp9",
                           {"-deadline", "realtime", "-cpu-used", "8", "-row-mt", "1", "-crf", "30",
                            "-b:v", "0", BT709}},
                          {"libvpx",
                           {"-deadline", "realtime", "-cpu-used", "8", "-crf", "10", "-b:v", "20M",
                            BT709}}}},
	[FORMAT_GIF] = {".gif", "gif", NULL, 0.002, 1000, {{"gif", {NULL}}}},
};

struct arguments {
	const char *list[ARGUMENTS_MAX];
	int count;
};

struct rb_encoder {
	enum format format;
	int width, height;               /* of pictures */
	int padded_width, padded_height; /* as ffmpeg gets them */
	uint8_t *padded;                 /* owned; NULL where they are the same */
	uint64_t pictures;
	bool failed;
	char *title;
	char size[ARGUMENT_SIZE], rate[ARGUMENT_SIZE];
	double fps;

	char *path;            /* owned */
	struct rb_outfile out; /* ffmpeg writes it */
	/*
	 * of a gif: pictures without loss and the palette, both of which its second pass reads; -1:
	 * none
	 */
	int lossless, palette;
	/* what ffmpeg calls them: it inherits the descriptors */
	char output[RB_PLACE_LINK_SIZE], lossless_path[RB_PLACE_LINK_SIZE],
		palette_path[RB_PLACE_LINK_SIZE];
	struct rb_child child;
	double patience_s;
	const atomic_bool *cut; /* borrowed; NULL: never */
};

/* The ffmpeg to run. */
static const char *program(void)
{
	const char *const named = getenv("RBSIM_FFMPEG");

	return named && *named ? named : "ffmpeg";
}

/* ---- children ---- */

/* The child's line that reports a full disk or quota, in the C locale's words; NULL: none. */
static const char *words_of_space(const struct rb_child *child, char line[RB_CHILD_SAID_SIZE])
{
	static const int numbers[] = {ENOSPC, EDQUOT, EFBIG};
	const char *words = NULL;

	for (size_t i = 0; i < sizeof numbers / sizeof *numbers && !words; i++)
		words = rb_child_words(child, strerrordesc_np(numbers[i]), line);
	return words;
}

/* True if the disk has less room than ffmpeg writes at once. */
static bool is_full(int file)
{
	struct statvfs room;

	return file >= 0 && fstatvfs(file, &room) == 0 &&
	       (uint64_t)room.f_bavail * room.f_frsize < WRITE_SIZE;
}

/*
 * The error for how the child has ended. Where there is a sign of a full disk, that is the reason.
 */
static enum rb_status tell_end(struct rb_child *child, enum rb_child_end end, int file,
                               struct rb_error *err)
{
	char line[RB_CHILD_SAID_SIZE];
	const bool signaled = end == RB_CHILD_FAILED && WIFSIGNALED(child->outcome);
	const int signal = signaled ? WTERMSIG(child->outcome) : 0;
	const char *const words = words_of_space(child, line);

	if (words)
		return RB_FAIL(err, RB_ERR_IO, "cannot write the film: '%s' says: %.160s",
		               program(), words);
	if (signal == SIGXFSZ)
		return RB_FAIL(err, RB_ERR_IO, "cannot write the film: '%s' was ended by %s",
		               program(), strsignal(signal));
	if (end == RB_CHILD_FAILED && is_full(file))
		return RB_FAIL(err, RB_ERR_IO, "cannot write the film: %s; '%s' said last: %.120s",
		               strerror(ENOSPC), program(), rb_child_last_words(child));
	if (end == RB_CHILD_WELL)
		return RB_OK;
	if (end == RB_CHILD_HUNG)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "'%s' made no progress for %g s and was stopped: %.120s", program(),
		               child->patience_s, rb_child_last_words(child));
	if (end == RB_CHILD_LOST)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot determine how '%s' has ended: %.140s",
		               program(), rb_child_last_words(child));
	if (signaled)
		return RB_FAIL(err, RB_ERR_MISSING, "'%s' was ended by signal %d (%s): %.120s",
		               program(), signal, strsignal(signal), rb_child_last_words(child));
	return RB_FAIL(err, RB_ERR_MISSING, "'%s' has failed with exit status %d: %.140s",
	               program(), WEXITSTATUS(child->outcome), rb_child_last_words(child));
}

/* Waits for the end; an empty `file` (-1: none) is a failure too. */
static enum rb_status finish_child(struct rb_child *child, int file, struct rb_error *err)
{
	struct stat found;
	const enum rb_status status = tell_end(child, rb_child_wait(child), file, err);

	if (status || file < 0 || (fstat(file, &found) == 0 && found.st_size > 0))
		return status;
	return RB_FAIL(err, RB_ERR_MISSING, "'%s' has written nothing: %.160s", program(),
	               rb_child_last_words(child));
}

/* ---- what ffmpeg can do ---- */

/* Reads its standard output, up to LIST_SIZE. */
static enum rb_status read_list(struct rb_child *child, char *list, struct rb_error *err)
{
	const uint64_t begin = rb_clock_now_ns();
	size_t size = 0;
	ssize_t got = 1;

	while (got != 0 && size < LIST_SIZE - 1) {
		struct pollfd wish = {.fd = child->out, .events = POLLIN};
		rb_child_hear(child);
		if ((double)(rb_clock_now_ns() - begin) * 1e-9 > child->patience_s) {
			rb_child_stop(child);
			return RB_FAIL(err, RB_ERR_MISSING,
			               "'%s' did not list its encoders within %g s", program(),
			               child->patience_s);
		}
		if (poll(&wish, 1, PAUSE_MS) <= 0)
			continue;
		got = read(child->out, list + size, LIST_SIZE - 1 - size);
		if (got > 0)
			size += (size_t)got;
		else if (got < 0 && errno != EINTR)
			break;
	}
	list[size] = '\0';
	return finish_child(child, -1, err);
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

/* Seconds without a sign of life that are allowed. */
static double patience_of(const struct rb_encoder_options *options)
{
	return options->patience_s > 0 ? options->patience_s : patience_s;
}

/* The first coder of the format that this ffmpeg has. */
static enum rb_status find_coder(enum format format, double patience, const struct coder **coder,
                                 struct rb_error *err)
{
	const struct arguments arguments = {{program(), "-hide_banner", "-encoders"}, 3};
	struct rb_child child;
	char *const list = rb_memory_take(LIST_SIZE, 1);

	if (!list)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot look for '%s': out of memory",
		               program());
	*coder = NULL;
	enum rb_status status = rb_child_start(&child, arguments.list, false, true, NULL, err);
	child.patience_s = patience;
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

/* Format by the name's ending. */
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

/* RB_ERR_SCENE unless the format can hold that many pictures per second. */
static enum rb_status check_rate(const struct rb_encoder_options *options, enum format format,
                                 struct rb_error *err)
{
	const double least = formats[format].fps_min, most = formats[format].fps_max;

	if (options->fps >= least && options->fps <= most)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_SCENE,
	               "video '%s': %.9g pictures per second, where %s takes %g to %g",
	               options->path, options->fps, formats[format].ending, least, most);
}

/*
 * ffmpeg takes pictures of less than 2^28 pixels with 128 more at each edge (av_image_check_size2
 * of libavutil, which counts 8 bytes a pixel in an int).
 */
static enum rb_status check_size(const struct rb_encoder_options *options, struct rb_error *err)
{
	const double most = (double)(1 << 28), edge = 128;

	if ((options->width + edge) * (options->height + edge) < most)
		return RB_OK;
	return RB_FAIL(err, RB_ERR_SCENE,
	               "video '%s': pictures of %d x %d pixels are too large for ffmpeg (wanted "
	               "less than 2^28 pixels; 'png' takes them)",
	               options->path, options->width, options->height);
}

enum rb_status rb_encoder_check(const struct rb_encoder_options *options, struct rb_error *err)
{
	const struct coder *coder;
	enum format format;
	enum rb_status status = find_format(options->path, &format, err);

	if (!status)
		status = check_rate(options, format, err);
	if (!status)
		status = check_size(options, err);
	if (!status)
		status = rb_outfile_probe(options->path, options->how, err);
	if (!status)
		status = find_coder(format, patience_of(options), &coder, err);
	return status;
}

/* ---- encoding ---- */

static void add(struct arguments *arguments, const char *text)
{
	RB_ASSERT(arguments->count < ARGUMENTS_MAX - 1); /* the list ends with NULL */
	arguments->list[arguments->count++] = text;
}

static void add_pair(struct arguments *arguments, const char *option, const char *value)
{
	add(arguments, option);
	add(arguments, value);
}

/* Arguments of every ffmpeg that is started. */
static void begin(struct arguments *arguments)
{
	*arguments = (struct arguments){0};
	add(arguments, program());
	add(arguments, "-hide_banner");
	add(arguments, "-nostdin");
	add_pair(arguments, "-loglevel", "error");
	add(arguments, "-xerror"); /* else a film whose end could not be written is a success */
	add(arguments, "-y");
}

/* Input: raw pictures from the pipe. */
static void add_pictures(struct arguments *arguments, const struct rb_encoder *encoder)
{
	add_pair(arguments, "-f", "rawvideo");
	add_pair(arguments, "-pix_fmt", "rgba");
	add_pair(arguments, "-s", encoder->size);
	add_pair(arguments, "-framerate", encoder->rate);
	add_pair(arguments, "-i", "pipe:0");
}

/*
 * Starts ffmpeg with the encoder's files; the sizes of `first` and `second` (-1: none) show
 * progress.
 */
static enum rb_status start(struct rb_encoder *encoder, const struct arguments *arguments,
                            bool feeds, int first, int second, struct rb_error *err)
{
	const int all[] = {fileno(encoder->out.file), encoder->lossless, encoder->palette};
	int kept[4], count = 0;

	/* in rising order */
	for (int last = -1;; count++) {
		kept[count] = -1;
		for (int i = 0; i < 3; i++)
			if (all[i] > last && (kept[count] < 0 || all[i] < kept[count]))
				kept[count] = all[i];
		if (kept[count] < 0)
			break;
		last = kept[count];
	}
	const enum rb_status status = rb_child_start(&encoder->child, arguments->list, feeds, false,
	                                             kept, err);

	encoder->child.patience_s = encoder->patience_s;
	encoder->child.cut = encoder->cut;
	encoder->child.files[0] = first;
	encoder->child.files[1] = second;
	return status;
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

/* One pass for mp4 and webm. */
static enum rb_status start_film(struct rb_encoder *encoder, const struct coder *coder,
                                 struct rb_error *err)
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
	add(&arguments, encoder->output);
	return start(encoder, &arguments, true, fileno(encoder->out.file), -1, err);
}

/*
 * First pass of a gif: the palette for the whole film is known only at its end, so pictures are
 * kept losslessly until then, in a file, because in ffmpeg's memory they would take as much as all
 * of them.
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
	add(&arguments, encoder->lossless_path);
	add_pair(&arguments, "-map", "[palette]");
	add_pair(&arguments, "-c:v", "rawvideo");
	add_pair(&arguments, "-pix_fmt", "bgra");
	add_pair(&arguments, "-f", "rawvideo");
	add(&arguments, encoder->palette_path);
	return start(encoder, &arguments, true, encoder->lossless, encoder->palette, err);
}

/* Second pass of a gif: pictures by the palette. */
static enum rb_status second_pass(struct rb_encoder *encoder, struct rb_error *err)
{
	struct arguments arguments;

	begin(&arguments);
	add_pair(&arguments, "-i", encoder->lossless_path);
	add_pair(&arguments, "-f", "rawvideo");
	add_pair(&arguments, "-pix_fmt", "bgra");
	add_pair(&arguments, "-s", "16x16");
	add_pair(&arguments, "-i", encoder->palette_path);
	/* ordered dither: its pattern is at rest where the picture is */
	add_pair(&arguments, "-filter_complex",
	         "[0:v][1:v]paletteuse=dither=bayer:bayer_scale=4:diff_mode=rectangle");
	add_pair(&arguments, "-f", "gif");
	add(&arguments, encoder->output);
	const enum rb_status status = start(encoder, &arguments, false, fileno(encoder->out.file),
	                                    -1, err);
	return status ? status : finish_child(&encoder->child, encoder->child.files[0], err);
}

static enum rb_status no_memory(const char *path, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_MEMORY, "cannot encode '%s': out of memory", path);
}

/* Sizes as ffmpeg gets them; odd ones are padded where chroma is halved. */
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

/* A temporary file without a name, gone when it is closed. */
static enum rb_status make_nameless(const struct rb_place *place, int *file,
                                    char path[RB_PLACE_LINK_SIZE], struct rb_error *err)
{
	char name[RB_PLACE_NAME_SIZE];

	*file = rb_place_create(place, "", name);
	if (*file < 0)
		return RB_FAIL(err, RB_ERR_CREATE, "cannot create '%s': %s", place->path,
		               strerror(errno));
	rb_place_remove(place, name);
	return rb_place_link(*file, NULL, path, err);
}

/* Names, title and open files. */
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
	enum rb_status status = rb_outfile_open(&encoder->out, encoder->path, options->how, err);
	if (!status)
		status = rb_place_link(fileno(encoder->out.file), NULL, encoder->output, err);
	if (status || encoder->format != FORMAT_GIF)
		return status;
	const struct rb_place *const place = &encoder->out.place;
	status = make_nameless(place, &encoder->lossless, encoder->lossless_path, err);
	return status ? status
	              : make_nameless(place, &encoder->palette, encoder->palette_path, err);
}

/* Everything but the encoder's own memory, in order. */
static enum rb_status set_up_encoder(struct rb_encoder *encoder,
                                     const struct rb_encoder_options *options, struct rb_error *err)
{
	const struct coder *coder;
	enum rb_status status = find_format(options->path, &encoder->format, err);

	if (!status)
		status = find_coder(encoder->format, encoder->patience_s, &coder, err);
	if (!status)
		status = set_sizes(encoder, options, err);
	if (!status)
		status = set_names(encoder, options, err);
	if (status)
		return status;
	if (encoder->format == FORMAT_GIF)
		return start_gif(encoder, err);
	return start_film(encoder, coder, err);
}

enum rb_status rb_encoder_create(struct rb_encoder **encoder,
                                 const struct rb_encoder_options *options, struct rb_error *err)
{
	RB_ASSERT(options->width > 0 && options->height > 0 && options->fps > 0);
	*encoder = rb_memory_take(1, sizeof **encoder);
	if (!*encoder)
		return no_memory(options->path, err);
	(*encoder)->cut = options->cut;
	(*encoder)->lossless = (*encoder)->palette = -1;
	(*encoder)->patience_s = patience_of(options);
	rb_child_init(&(*encoder)->child);
	const enum rb_status status = set_up_encoder(*encoder, options, err);
	if (status) {
		rb_encoder_destroy(*encoder);
		*encoder = NULL;
	}
	return status;
}

/* Repeats the last column and row. */
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
	struct rb_child *const child = &encoder->child;
	if (rb_child_feed(child, bytes,
	                  4 * (size_t)encoder->padded_width * (size_t)encoder->padded_height))
		return RB_OK;
	encoder->failed = true;
	const enum rb_status status = tell_end(child, rb_child_wait(child), child->files[0], err);
	return status ? status
	              : RB_FAIL(err, RB_ERR_MISSING, "'%s' has ended before the film: %.140s",
	                        program(), rb_child_last_words(child));
}

enum rb_status rb_encoder_finish(struct rb_encoder *encoder, bool discard, uint64_t *bytes,
                                 struct rb_error *err)
{
	struct stat found;

	if (bytes)
		*bytes = 0;
	if (discard || encoder->failed || encoder->pictures == 0) {
		rb_child_stop(&encoder->child);
		rb_outfile_release(&encoder->out);
		return RB_OK;
	}
	enum rb_status status = finish_child(&encoder->child, encoder->child.files[0], err);
	if (!status && encoder->format == FORMAT_GIF)
		status = second_pass(encoder, err);
	encoder->failed = true; /* it takes no more pictures */
	if (status) {
		rb_outfile_release(&encoder->out);
		return status;
	}
	if (bytes && fstat(fileno(encoder->out.file), &found) == 0)
		*bytes = (uint64_t)found.st_size;
	return rb_outfile_publish(&encoder->out, err);
}

void rb_encoder_destroy(struct rb_encoder *encoder)
{
	if (!encoder)
		return;
	rb_child_stop(&encoder->child);
	rb_outfile_release(&encoder->out);
	if (encoder->lossless >= 0)
		close(encoder->lossless);
	if (encoder->palette >= 0)
		close(encoder->palette);
	rb_memory_free(encoder->padded);
	rb_memory_free(encoder->title);
	rb_memory_free(encoder->path);
	rb_memory_free(encoder);
}
