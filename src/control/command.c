/* SPDX-License-Identifier: MIT */
/*
 * A recursive-descent parser without recursion: a line becomes words, the first word chooses a row,
 * a function for its kind takes the arguments. Everything a user reads about commands (usage, help,
 * manual, completion) comes from the rows above. Quoted words are names and never fixed words, so
 * that a body may be called "all".
 *
 * Lines come from sockets and files: each byte is checked to be printable UTF-8 before anything
 * else, sizes are bounded, and messages quote at most 40 bytes of them.
 */
#include "control/command.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/visible.h"
#include "script/nearest.h"

const struct rb_command_row rb_commands[RB_COMMAND_KIND_COUNT] = {
	[RB_COMMAND_PLAY] = {"play", "", 0, "continue the run"},
	[RB_COMMAND_PAUSE] = {"pause", "", 0, "pause at the next frame, for all clients"},
	[RB_COMMAND_TOGGLE] = {"toggle", "", 0, "play or pause"},
	[RB_COMMAND_STEP] = {"step", "[N]", 0, "advance N frames (default: 1), then pause"},
	[RB_COMMAND_BACK] = {"back", "[N]", RB_NEEDS_VIEW | RB_NEEDS_FRAMES,
                             "show the frame N before this one (default: 1)"},
	[RB_COMMAND_SEEK] =
		{"seek", "TIME|PERCENT%", RB_NEEDS_VIEW | RB_NEEDS_FRAMES,
                 "show the frame at a simulated time in seconds, or at a percentage of the run"},
	[RB_COMMAND_SPEED] = {"speed", "FACTOR", RB_NEEDS_VIEW,
                              "show simulated seconds at FACTOR times their pace"},
	[RB_COMMAND_RESTART] = {"restart", "", RB_NEEDS_RUN,
                                "restart the simulation with the same scene and parameters, except "
                                "those changed by 'set'"},
	[RB_COMMAND_STOP] = {"stop", "at collision [on|off]", 0,
                             "pause at each frame that follows a collision (default: on)"},
	[RB_COMMAND_NEXT] = {"next", "[collision]", RB_NEEDS_VIEW | RB_NEEDS_FRAMES,
                             "show the next frame with a collision"},
	[RB_COMMAND_PREVIOUS] = {"previous", "[collision]", RB_NEEDS_VIEW | RB_NEEDS_FRAMES,
                                 "show the frame with a collision before this one"},
	[RB_COMMAND_FOLLOW] = {"follow", "[BODY]", RB_NEEDS_VIEW,
                               "keep a body in the centre of the picture; without a name, none"},
	[RB_COMMAND_CAMERA] =
		{"camera", "NAME|move X Y Z|orbit DEGREES DEGREES|zoom FACTOR|mount [BODY]|all",
                 RB_NEEDS_VIEW,
                 "use a camera of the scene; move it to the right, up and forward (m); orbit what "
                 "it "
                 "looks at; zoom in; mount it on a body; place it so that all moving bodies are "
                 "visible"},
	[RB_COMMAND_SNAPSHOT] = {"snapshot", "[FILE]", RB_NEEDS_VIEW,
                                 "write a picture of this frame"},
	[RB_COMMAND_FILM] =
		{"film", "on|off|[CAMERA] move X Y Z|orbit DEGREES DEGREES|zoom FACTOR",
                 RB_NEEDS_RUN,
                 "draw the pictures of the run's films, or skip them; move the camera of one "
                 "from the next frame on, as 'camera' moves that of a view; a film of several by "
                 "its "
                 "name, one of its cameras by its own"},
	[RB_COMMAND_CHECKPOINT] =
		{"checkpoint", "", RB_NEEDS_RUN,
                 "write a checkpoint beside the recording, from which --resume continues"},
	[RB_COMMAND_BODY] = {"body", "NAME", 0,
                             "numbers of a body, by its name or its number as #3"},
	[RB_COMMAND_SET] = {"set", "PARAMETER VALUE", RB_NEEDS_RUN,
                            "set a parameter of the scene, effective from the next restart"},
	[RB_COMMAND_VIEW] = {"view", "pause|play", RB_NEEDS_VIEW,
                             "pause or resume this view without affecting the run"},
	[RB_COMMAND_STATUS] = {"status", "", 0, "progress and statistics of the run"},
	[RB_COMMAND_HELP] = {"help", "[COMMAND]", 0, "all commands, or one"},
	[RB_COMMAND_QUIT] = {"quit", "", 0,
                             "leave the console; given to a run: end it as if interrupted"},
};

/* Frames of one step command: a bound that fits any integer type and that no run reaches. */
static const double frames_max = 1e9;
static const double degree = 0.017453292519943295; /* rad */

/* Words of the longest command: film CAMERA move X Y Z. */
enum { WORDS_MAX = 6 };

/* A line taken apart. */
struct words {
	char text[WORDS_MAX][RB_COMMAND_TEXT_SIZE];
	bool quoted[WORDS_MAX]; /* then it is a name and never a fixed word */
	int count;
};

/* One line on its way to a command; words[0] is the command's name. */
struct parse {
	const struct rb_command_row *row;
	struct words words;
	struct rb_command *command;
	struct rb_error *err;
};

/* ---- a line as words ---- */

size_t rb_command_character(const char *text)
{
	return *text == '\t' ? 1 : rb_visible_size(text);
}

/* Fails unless the line is printable UTF-8 of at most RB_COMMAND_LINE_SIZE bytes. */
static enum rb_status check_bytes(const char *line, struct rb_error *err)
{
	size_t size = 0;

	while (line[size]) {
		const size_t one = rb_command_character(line + size);
		if (one == 0)
			return RB_FAIL(err, RB_ERR_USAGE,
			               "byte %zu of the line is 0x%02x, wanted printable UTF-8",
			               size + 1, (unsigned)(unsigned char)line[size]);
		size += one;
		if (size > RB_COMMAND_LINE_SIZE)
			return RB_FAIL(err, RB_ERR_USAGE, "the line is longer than %d bytes",
			               RB_COMMAND_LINE_SIZE);
	}
	return RB_OK;
}

/* At most 40 bytes of a text for a message, cut between characters, with dots where it was cut. */
static const char *shown(const char *text, char out[48])
{
	size_t size = 0;

	while (text[size]) {
		const size_t one = rb_command_character(text + size);
		if (one == 0 || size + one > 40)
			break;
		size += one;
	}
	snprintf(out, 48, "%.*s%s", (int)size, text, text[size] ? "..." : "");
	return out;
}

static bool is_space(char c)
{
	return c == ' ' || c == '\t';
}

/*
 * Appends the word at `*at`, which moves behind it. Within quotes only a quote ends it; there is no
 * escape.
 */
static enum rb_status take_word(struct words *words, const char **at, struct rb_error *err)
{
	char beginning[48];
	const bool quoted = **at == '"';
	const char *const begin = *at + quoted;
	const size_t size = strcspn(begin, quoted ? "\"" : " \t");

	RB_ASSERT(words->count >= 0 && words->count <= WORDS_MAX);
	if (quoted && begin[size] != '"')
		return RB_FAIL(err, RB_ERR_USAGE, "'%s' has no quote at its end",
		               shown(*at, beginning));
	if (quoted && begin[size + 1] && !is_space(begin[size + 1]))
		return RB_FAIL(err, RB_ERR_USAGE, "'%s': wanted a space after the closing quote",
		               shown(begin + size, beginning));
	if (size >= RB_COMMAND_TEXT_SIZE)
		return RB_FAIL(err, RB_ERR_USAGE, "'%s' is a word of more than %d bytes",
		               shown(begin, beginning), RB_COMMAND_TEXT_SIZE - 1);
	if (words->count == WORDS_MAX)
		return RB_FAIL(err, RB_ERR_USAGE, "'%s' is one word too many",
		               shown(begin, beginning));
	memcpy(words->text[words->count], begin, size);
	words->text[words->count][size] = '\0';
	words->quoted[words->count] = quoted;
	words->count++;
	*at = begin + size + quoted;
	return RB_OK;
}

/* Cuts a line, of which the bytes were checked, into words. */
static enum rb_status split(struct words *words, const char *line, struct rb_error *err)
{
	for (const char *at = line;;) {
		while (is_space(*at))
			at++;
		if (*at == '\0')
			return RB_OK;
		const enum rb_status status = take_word(words, &at, err);
		if (status)
			return status;
	}
}

/* ---- arguments ---- */

/* The n-th argument from 1, NULL: there are fewer. */
static const char *argument(const struct parse *parse, int n)
{
	RB_ASSERT(n >= 0);
	return n < parse->words.count ? parse->words.text[n] : NULL;
}

/* Whether the n-th argument is this fixed word. */
static bool is_word(const struct parse *parse, int n, const char *word)
{
	return n < parse->words.count && !parse->words.quoted[n] &&
	       strcmp(parse->words.text[n], word) == 0;
}

/* Fails: argument `n` is not what was wanted, or missing. */
static enum rb_status wrong(const struct parse *parse, int n, const char *wanted)
{
	const char *found = argument(parse, n);
	char text[48];

	if (!found)
		return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s' needs %s (usage: %s %s)",
		               parse->row->name, wanted, parse->row->name, parse->row->arguments);
	return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s': got '%s', wanted %s", parse->row->name,
	               shown(found, text), wanted);
}

/*
 * Fails if there are more than `count` arguments; returned by each of the functions below as its
 * last check.
 */
static enum rb_status at_most(const struct parse *parse, int count)
{
	char text[48];

	if (parse->words.count - 1 <= count)
		return RB_OK;
	return RB_FAIL(parse->err, RB_ERR_USAGE, "'%s': unexpected '%s' (usage: %s%s%s)",
	               parse->row->name, shown(argument(parse, count + 1), text), parse->row->name,
	               *parse->row->arguments ? " " : "", parse->row->arguments);
}

/* A plain decimal number: no spaces, no hexadecimal, no infinity. NULL is none. */
static bool number(const char *text, double *value)
{
	char *end;

	if (!text || !*text || text[strspn(text, "+-.0123456789eE")] != '\0')
		return false;
	*value = strtod(text, &end);
	return *end == '\0' && isfinite(*value);
}

/* Arguments [N]: a whole number, 1 by default. */
static enum rb_status take_count(struct parse *parse)
{
	const char *text = argument(parse, 1);
	double value = 1;

	if (text && (text[strspn(text, "0123456789")] != '\0' || !number(text, &value) ||
	             value < 1 || value > frames_max))
		return wrong(parse, 1, "a whole number from 1 to 1000000000");
	parse->command->number = value;
	return at_most(parse, 1);
}

/* Arguments TIME or PERCENT%. */
static enum rb_status take_seek(struct parse *parse)
{
	static const char wanted[] = "a time in seconds from 0, or 0% to 100%";
	char text[RB_COMMAND_TEXT_SIZE];
	double value;

	if (!argument(parse, 1))
		return wrong(parse, 1, wanted);
	snprintf(text, sizeof text, "%s", argument(parse, 1));
	const size_t size = strlen(text);
	const bool percent = size > 0 && text[size - 1] == '%';
	if (percent)
		text[size - 1] = '\0';
	if (!number(text, &value) || value < 0 || (percent && value > 100))
		return wrong(parse, 1, wanted);
	parse->command->number = value;
	parse->command->is_percent = percent;
	return at_most(parse, 1);
}

/* Argument n: a positive number. */
static enum rb_status take_factor(struct parse *parse, int n)
{
	double value;

	if (!number(argument(parse, n), &value) || !(value > 0))
		return wrong(parse, n, "a number above 0");
	parse->command->number = value;
	return at_most(parse, n);
}

/* Argument n: one of two fixed words; is_on becomes whether it is the first. */
static enum rb_status take_choice(struct parse *parse, int n, const char *yes, const char *no)
{
	char wanted[64];

	snprintf(wanted, sizeof wanted, "'%s' or '%s'", yes, no);
	parse->command->is_on = is_word(parse, n, yes);
	if (!parse->command->is_on && !is_word(parse, n, no))
		return wrong(parse, n, wanted);
	return at_most(parse, n);
}

/* Arguments at collision [on|off]. */
static enum rb_status take_stop(struct parse *parse)
{
	if (!is_word(parse, 1, "at"))
		return wrong(parse, 1, "'at collision on' or 'at collision off'");
	if (!is_word(parse, 2, "collision"))
		return wrong(parse, 2, "'collision'");
	parse->command->is_on = true;
	return argument(parse, 3) ? take_choice(parse, 3, "on", "off") : RB_OK;
}

/* Argument n as a text; `needed`: it may not be missing. An empty text is refused. */
static enum rb_status take_text(struct parse *parse, int n, bool needed, const char *wanted)
{
	const char *text = argument(parse, n);

	if (text ? *text == '\0' : needed)
		return wrong(parse, n, wanted);
	if (text)
		snprintf(parse->command->text, sizeof parse->command->text, "%s", text);
	return at_most(parse, n);
}

/* Arguments n, n + 1, ...: two or three numbers, multiplied by `unit`. */
static enum rb_status take_vector(struct parse *parse, int n, int count, double unit)
{
	RB_ASSERT(count == 2 || count == 3);
	for (int i = 0; i < count; i++) {
		if (!number(argument(parse, n + i), &parse->command->vector[i]))
			return wrong(parse, n + i,
			             count == 3 ? "three numbers in metres"
			                        : "two numbers in degrees");
		parse->command->vector[i] *= unit;
	}
	return at_most(parse, n + count - 1);
}

/*
 * How a camera is moved, if argument n says that it is; else `*is_one` is false and nothing is
 * taken.
 */
static enum rb_status take_movement(struct parse *parse, int n, bool *is_one)
{
	enum rb_camera_action *const action = &parse->command->action;

	*is_one = true;
	if (is_word(parse, n, "move")) {
		*action = RB_CAMERA_MOVE;
		return take_vector(parse, n + 1, 3, 1);
	}
	if (is_word(parse, n, "orbit")) {
		*action = RB_CAMERA_ORBIT;
		return take_vector(parse, n + 1, 2, degree);
	}
	if (is_word(parse, n, "zoom")) {
		*action = RB_CAMERA_ZOOM;
		return take_factor(parse, n + 1);
	}
	*is_one = false;
	return RB_OK;
}

/* Arguments of film. A camera's name may be left out where only one makes a film. */
static enum rb_status take_film(struct parse *parse)
{
	if (is_word(parse, 1, "on") || is_word(parse, 1, "off"))
		return take_choice(parse, 1, "on", "off");
	enum rb_status status = take_movement(parse, 1, &parse->command->moves);
	if (status || parse->command->moves)
		return status;
	if (!argument(parse, 1) || !argument(parse, 2))
		return wrong(parse, 1, "'on', 'off', or move, orbit or zoom after a camera's name");
	snprintf(parse->command->text, sizeof parse->command->text, "%s", argument(parse, 1));
	status = take_movement(parse, 2, &parse->command->moves);
	return status || parse->command->moves ? status : wrong(parse, 2, "move, orbit or zoom");
}

/* Arguments of camera: a movement, mount, all, or else a name. */
static enum rb_status take_camera(struct parse *parse)
{
	enum rb_camera_action *const action = &parse->command->action;
	bool is_movement;

	const enum rb_status status = take_movement(parse, 1, &is_movement);
	if (status || is_movement)
		return status;
	if (is_word(parse, 1, "mount")) {
		*action = RB_CAMERA_MOUNT;
		return take_text(parse, 2, false, "the name of a body");
	}
	if (is_word(parse, 1, "all")) {
		*action = RB_CAMERA_ALL;
		return at_most(parse, 2);
	}
	*action = RB_CAMERA_NAMED;
	return take_text(parse, 1, true,
	                 "the name of a camera, or move, orbit, zoom, mount or all");
}

/*
 * Arguments PARAMETER VALUE. The name may not hold '=', which parts it from the value in the list
 * of values set.
 */
static enum rb_status take_set(struct parse *parse)
{
	struct rb_command *const command = parse->command;

	if (!argument(parse, 1) || !argument(parse, 1)[0] || strchr(argument(parse, 1), '='))
		return wrong(parse, 1, "the name of a parameter and a value");
	if (!argument(parse, 2))
		return wrong(parse, 2, "a value");
	snprintf(command->text, sizeof command->text, "%s", argument(parse, 1));
	snprintf(command->value, sizeof command->value, "%s", argument(parse, 2));
	return at_most(parse, 2);
}

/*
 * Takes the arguments of the command's kind; every kind is listed, so that the compiler reports a
 * new one.
 */
static enum rb_status take_arguments(struct parse *parse)
{
	switch (parse->command->kind) {
	case RB_COMMAND_STEP:
	case RB_COMMAND_BACK:
		return take_count(parse);
	case RB_COMMAND_SEEK:
		return take_seek(parse);
	case RB_COMMAND_SPEED:
		return take_factor(parse, 1);
	case RB_COMMAND_STOP:
		return take_stop(parse);
	case RB_COMMAND_NEXT:
	case RB_COMMAND_PREVIOUS:
		if (argument(parse, 1) && !is_word(parse, 1, "collision"))
			return wrong(parse, 1, "'collision' or nothing");
		return at_most(parse, 1);
	case RB_COMMAND_FOLLOW:
		return take_text(parse, 1, false, "the name of a body");
	case RB_COMMAND_CAMERA:
		return take_camera(parse);
	case RB_COMMAND_SNAPSHOT:
		return take_text(parse, 1, false, "a file's name");
	case RB_COMMAND_FILM:
		return take_film(parse);
	case RB_COMMAND_BODY:
		return take_text(parse, 1, true, "the name of a body");
	case RB_COMMAND_SET:
		return take_set(parse);
	case RB_COMMAND_VIEW:
		return take_choice(parse, 1, "play", "pause");
	case RB_COMMAND_HELP:
		return take_text(parse, 1, false, "a command");
	case RB_COMMAND_PLAY:
	case RB_COMMAND_PAUSE:
	case RB_COMMAND_TOGGLE:
	case RB_COMMAND_RESTART:
	case RB_COMMAND_CHECKPOINT:
	case RB_COMMAND_STATUS:
	case RB_COMMAND_QUIT:
	case RB_COMMAND_KIND_COUNT:
		break;
	}
	return at_most(parse, 0);
}

/* The row of a command's name, NULL: there is none. */
static const struct rb_command_row *row_of(const char *name)
{
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++)
		if (strcmp(rb_commands[i].name, name) == 0)
			return &rb_commands[i];
	return NULL;
}

/* Fails with the nearest name. */
static enum rb_status unknown(const char *name, struct rb_error *err)
{
	struct rb_nearest nearest = rb_nearest_to(name);
	char hint[96], text[48];

	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++)
		rb_nearest_offer(&nearest, rb_commands[i].name, strlen(rb_commands[i].name));
	return RB_FAIL(err, RB_ERR_USAGE, "unknown command '%s'%s", shown(name, text),
	               nearest.best[0] ? rb_nearest_hint(&nearest, hint) : "; help lists them");
}

enum rb_status rb_command_parse(struct rb_command *command, bool *given, const char *line,
                                struct rb_error *err)
{
	struct parse parse = {.command = command, .err = err};

	*command = (struct rb_command){0};
	*given = false;
	enum rb_status status = check_bytes(line, err);
	if (status)
		return status;
	while (is_space(*line))
		line++;
	if (*line == '\0' || *line == '#')
		return RB_OK;
	status = split(&parse.words, line, err);
	if (status)
		return status;
	parse.row = parse.words.quoted[0] ? NULL : row_of(parse.words.text[0]);
	if (!parse.row)
		return unknown(parse.words.text[0], err);
	command->kind = (enum rb_command_kind)(parse.row - rb_commands);
	status = take_arguments(&parse);
	if (!status && command->kind == RB_COMMAND_HELP && command->text[0] &&
	    !row_of(command->text))
		status = unknown(command->text, err);
	if (status)
		*command = (struct rb_command){0};
	*given = !status;
	return status;
}

/* ---- continuations ---- */

/* Fixed words behind a command, by their place; NULL: there are none. */
static const char *const *fixed_words(enum rb_command_kind kind, int place)
{
	static const char *const at[] = {"at", NULL}, *const collision[] = {"collision", NULL},
				 *const on_off[] = {"on", "off", NULL},
				 *const film[] = {"on", "off", "move", "orbit", "zoom", NULL},
				 *const movement[] = {"move", "orbit", "zoom", NULL},
				 *const view[] = {"pause", "play", NULL},
				 *const camera[] = {"move", "orbit", "zoom", "mount", "all", NULL};

	switch (kind) {
	case RB_COMMAND_STOP:
		return place == 1 ? at : place == 2 ? collision : place == 3 ? on_off : NULL;
	case RB_COMMAND_NEXT:
	case RB_COMMAND_PREVIOUS:
		return place == 1 ? collision : NULL;
	case RB_COMMAND_FILM:
		return place == 1 ? film : place == 2 ? movement : NULL;
	case RB_COMMAND_VIEW:
		return place == 1 ? view : NULL;
	case RB_COMMAND_CAMERA:
		return place == 1 ? camera : NULL;
	default:
		return NULL;
	}
}

/*
 * Whether names of bodies, cameras or parameters may stand at a place; `*kind` becomes the command
 * whose names are to be asked for.
 */
static bool takes_names(enum rb_command_kind *kind, int place, const char *first)
{
	if (*kind == RB_COMMAND_CAMERA && place == 2 && strcmp(first, "mount") == 0) {
		*kind = RB_COMMAND_FOLLOW;
		return true;
	}
	return place == 1 && (*kind == RB_COMMAND_FOLLOW || *kind == RB_COMMAND_BODY ||
	                      *kind == RB_COMMAND_CAMERA || *kind == RB_COMMAND_SET);
}

/* Candidates that begin with what stands there so far. */
struct offers {
	const char *begun;
	const char **out;
	int count, most;
};

/* Takes a candidate that begins as the word does, as far as there is room. */
static void offer(struct offers *offers, const char *candidate)
{
	if (offers->count < offers->most &&
	    strncmp(candidate, offers->begun, strlen(offers->begun)) == 0)
		offers->out[offers->count++] = candidate;
}

int rb_command_complete(const char *line, const struct rb_command_names *names, const char **out,
                        int most)
{
	char words[2][RB_COMMAND_TEXT_SIZE] = {"", ""};
	struct offers offers = {.out = out, .most = most};
	int place = 0;

	RB_ASSERT(most >= 0);
	/* the words that are complete; the last one, maybe empty, has only begun */
	for (const char *at = line;; place++) {
		at += strspn(at, " \t");
		const bool quoted = *at == '"';
		const char *const begin = at + quoted;
		const size_t size = strcspn(begin, quoted ? "\"" : " \t");
		offers.begun = begin;
		if (begin[size] == '\0' || size >= RB_COMMAND_TEXT_SIZE)
			break;
		if (place < 2)
			snprintf(words[place], sizeof words[place], "%.*s", (int)size, begin);
		at = begin + size + quoted;
	}
	const struct rb_command_row *const row = place > 0 ? row_of(words[0]) : NULL;
	enum rb_command_kind kind = row ? (enum rb_command_kind)(row - rb_commands)
	                                : RB_COMMAND_KIND_COUNT;
	if (place == 0 || (kind == RB_COMMAND_HELP && place == 1))
		for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++)
			offer(&offers, rb_commands[i].name);
	if (!row)
		return offers.count;
	const char *const *fixed = fixed_words(kind, place);
	for (; fixed && *fixed; fixed++)
		offer(&offers, *fixed);
	if (!names || !names->name || !takes_names(&kind, place, words[1]))
		return offers.count;
	const char *name;
	for (int i = 0; offers.count < most && (name = names->name(names->user, kind, i)); i++)
		offer(&offers, name);
	return offers.count;
}

/* ---- help ---- */

void rb_command_print_help(FILE *file, const char *name)
{
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		const struct rb_command_row *const row = &rb_commands[i];
		if (name && *name && strcmp(row->name, name) != 0)
			continue;
		fprintf(file, "%s%s%s: %s\n", row->name, *row->arguments ? " " : "", row->arguments,
		        row->help);
	}
}

/* Arguments as mdoc: words in capitals are to be replaced, the others stand as they are. */
static void print_arguments(FILE *file, const char *text)
{
	static const char capitals[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ";

	while (*text) {
		const size_t size = strspn(text, capitals);
		const size_t plain = strcspn(text, capitals);
		if (size > 0)
			fprintf(file, "\\fI%.*s\\fR", (int)size, text);
		else
			fprintf(file, "%.*s", (int)plain, text);
		text += size > 0 ? size : plain;
	}
}

void rb_command_print_manual(FILE *file)
{
	fputs(".\\\" table commands\n.Bl -tag -width Ds\n", file);
	for (int i = 0; i < RB_COMMAND_KIND_COUNT; i++) {
		const struct rb_command_row *const row = &rb_commands[i];
		fprintf(file, ".It Ic %s", row->name);
		if (*row->arguments) {
			fputs(" No ", file);
			print_arguments(file, row->arguments);
		}
		fputc('\n', file);
		fputc(row->help[0] >= 'a' && row->help[0] <= 'z' ? row->help[0] - 'a' + 'A'
		                                                 : row->help[0],
		      file);
		fprintf(file, "%s.\n", row->help + 1);
		if (row->needs & RB_NEEDS_VIEW)
			fputs("Needs a console.\n", file);
	}
	fputs(".El\n.\\\" end\n", file);
}
