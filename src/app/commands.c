/* SPDX-License-Identifier: MIT */
/*
 * A file of commands is read and checked as a whole before the run begins: a mistake in its last
 * line must not come after hours. Rows are sorted by time, stable, so that those of one time keep
 * their order. Commands are executed by the simulator's thread at the first frame that is not
 * before their time.
 */
#include "app/commands.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/thread.h"
#include "script/load.h"

/*
 * FILE_MAX: 1 MiB is more than anybody writes. PIECE: bytes read at once. WHO_SIZE: of who gave a
 * command, for the log.
 */
enum { FILE_MAX = 1 << 20, PIECE = 4096, WHO_SIZE = 80 };

/*
 * Executes a line and prints its answer. Answers may come from several threads: one at a time,
 * whole.
 */
static bool execute(struct rb_session *session, const char *line, const char *who, FILE *out)
{
	struct rb_answer answer = {0};
	const bool right = rb_session_execute(session, line, who, &answer);

	flockfile(out);
	/*
	 * where memory was out for all of it there is no text; rb_app_finish looks whether it was
	 * written
	 */
	if (answer.size > 0)
		(void)!fwrite(answer.text, 1, answer.size, out);
	fflush(out);
	funlockfile(out);
	rb_answer_release(&answer);
	return right;
}

/* ---- a file ---- */

struct row {
	double time_s; /* -INFINITY: before the first frame */
	int line;      /* in the file, from 1 */
	char *text;    /* the command; part of the file's text */
};

struct rb_commands {
	const char *path;
	char *text; /* owned: the file, its lines ended by zeros */
	size_t size, capacity;
	struct row *rows; /* owned, in order of time, then of lines */
	size_t row_count, row_capacity;
	size_t next; /* row to be executed */
};

void rb_commands_destroy(struct rb_commands *commands)
{
	if (!commands)
		return;
	rb_memory_free(commands->text);
	rb_memory_free(commands->rows);
	rb_memory_free(commands);
}

/* Reads all of the file. */
static enum rb_status read_text(struct rb_commands *commands, struct rb_error *err)
{
	FILE *const file = fopen(commands->path, "re");
	bool held = true;
	size_t got = 1;

	if (!file)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot open '%s': %s", commands->path,
		               strerror(errno));
	while (got > 0 && commands->size <= FILE_MAX) {
		held = rb_memory_reserve(&commands->text, &commands->capacity,
		                         commands->size + PIECE + 1, 1);
		if (!held)
			break;
		errno = 0;
		got = fread(commands->text + commands->size, 1, PIECE, file);
		commands->size += got;
	}
	const int failed = ferror(file) ? errno : 0;
	fclose(file);
	if (!held)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory",
		               commands->path);
	if (failed)
		return RB_FAIL(err, RB_ERR_INPUT, "cannot read '%s': %s", commands->path,
		               strerror(failed));
	if (commands->size > FILE_MAX)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' is larger than 1 MiB, wanted commands",
		               commands->path);
	commands->text[commands->size] = '\0';
	return RB_OK;
}

/* Fails with the line of the file. */
static enum rb_status wrong(const struct rb_commands *commands, const struct row *row,
                            const char *text, struct rb_error *err)
{
	return RB_FAIL(err, RB_ERR_INPUT, "%s:%d: %s", commands->path, row->line, text);
}

/*
 * Takes "at TIME" from the line: the command stays. Without it the command is executed before the
 * first frame.
 */
static enum rb_status take_time(const struct rb_commands *commands, struct row *row,
                                double duration_s, struct rb_error *err)
{
	char *text = row->text + strspn(row->text, " \t"), *end, message[128];

	row->time_s = -(double)INFINITY;
	if (strncmp(text, "at", 2) != 0 || (text[2] != ' ' && text[2] != '\t'))
		return RB_OK;
	text += 2 + strspn(text + 2, " \t");
	const size_t size = strcspn(text, " \t");
	row->time_s = strspn(text, "+-.0123456789eE") >= size ? strtod(text, &end) : (double)NAN;
	if (!(row->time_s >= 0) || size == 0 || end != text + size || isinf(row->time_s))
		return wrong(commands, row,
		             "wanted 'at TIME command', with a time in seconds from 0", err);
	if (row->time_s > duration_s) {
		snprintf(message, sizeof message, "%g s is after the end of the run, %g s",
		         row->time_s, duration_s);
		return wrong(commands, row, message, err);
	}
	row->text = text + size;
	return RB_OK;
}

/* Whether a command may leave the run paused. */
static bool pauses(const struct rb_command *command)
{
	return command->kind == RB_COMMAND_PAUSE || command->kind == RB_COMMAND_TOGGLE ||
	       command->kind == RB_COMMAND_STEP ||
	       (command->kind == RB_COMMAND_STOP && command->is_on);
}

/* `*given` is false for a line without a command. */
static enum rb_status check_row(const struct rb_commands *commands, struct row *row, bool *given,
                                const struct rb_commands_check *check, struct rb_error *err)
{
	struct rb_command command;
	struct rb_error own = {0};
	char message[128];

	enum rb_status status = take_time(commands, row, check->duration_s, err);
	if (status)
		return status;
	status = rb_command_parse(&command, given, row->text, &own);
	if (status || !*given)
		return status ? wrong(commands, row, own.text, err) : RB_OK;
	status = rb_session_serves(command.kind, &own);
	if (!status && command.kind == RB_COMMAND_SET)
		status = rb_script_check_param(check->scene, command.text, command.value, &own);
	if (status == RB_ERR_MEMORY)
		return RB_FAIL(err, status, "%s", own.text);
	if (status)
		return wrong(commands, row, own.text, err);
	if (pauses(&command) && !check->attended) {
		snprintf(message, sizeof message,
		         "'%s' needs --listen: otherwise a paused run cannot be continued",
		         rb_commands[command.kind].name);
		return wrong(commands, row, message, err);
	}
	return RB_OK;
}

static int by_time(const void *a, const void *b)
{
	const struct row *const x = a, *const y = b;

	if (x->time_s < y->time_s || x->time_s > y->time_s)
		return x->time_s < y->time_s ? -1 : 1;
	return x->line < y->line ? -1 : x->line > y->line;
}

static enum rb_status read_rows(struct rb_commands *commands, const struct rb_commands_check *check,
                                struct rb_error *err)
{
	char *const end = commands->text + commands->size;
	int line = 1;

	for (char *at = commands->text; at < end; line++) {
		struct row row = {.line = line, .text = at};
		char *stop = memchr(at, '\n', (size_t)(end - at));
		bool given;
		if (!stop)
			stop = end;
		at = stop + 1;
		if (stop > row.text && stop[-1] == '\r')
			stop--;
		*stop = '\0';
		if (strlen(row.text) != (size_t)(stop - row.text))
			return wrong(commands, &row, "a zero byte in a line of text", err);
		const enum rb_status status = check_row(commands, &row, &given, check, err);
		if (status)
			return status;
		if (!given)
			continue;
		if (!rb_memory_reserve(&commands->rows, &commands->row_capacity,
		                       commands->row_count + 1, sizeof row))
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory",
			               commands->path);
		commands->rows[commands->row_count++] = row;
	}
	if (commands->row_count > 0)
		qsort(commands->rows, commands->row_count, sizeof *commands->rows, by_time);
	return RB_OK;
}

enum rb_status rb_commands_read(struct rb_commands **commands, const char *path,
                                const struct rb_commands_check *check, struct rb_error *err)
{
	struct rb_commands *const c = rb_memory_take(1, sizeof *c);

	*commands = NULL;
	if (!c)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read '%s': out of memory", path);
	c->path = path;
	enum rb_status status = read_text(c, err);
	if (!status)
		status = read_rows(c, check, err);
	if (status) {
		rb_commands_destroy(c);
		return status;
	}
	*commands = c;
	return RB_OK;
}

void rb_commands_execute(struct rb_commands *commands, double time_s, struct rb_session *session,
                         FILE *out)
{
	char who[WHO_SIZE];

	while (commands->next < commands->row_count &&
	       commands->rows[commands->next].time_s <= time_s) {
		const struct row *const row = &commands->rows[commands->next++];
		snprintf(who, sizeof who, "%.60s:%d", commands->path, row->line);
		(void)execute(session, row->text, who, out);
	}
}

/* ---- standard input ---- */

struct rb_stdin {
	/* set before the thread starts, then only read */
	struct rb_session *session;
	FILE *out;
	void (*ended)(void *user);
	void *user;
	int wake;
	pthread_t thread;

	/* the thread's */
	char in[RB_COMMAND_LINE_SIZE + 3];
	size_t in_size;
	bool skipping; /* the rest of a line that was too long */
};

/* Reads a piece when there is one; false: the input or the run has ended. */
static bool hear(struct rb_stdin *input)
{
	struct pollfd polls[2] = {{.fd = STDIN_FILENO, .events = POLLIN},
	                          {.fd = input->wake, .events = POLLIN}};

	if (poll(polls, 2, -1) < 0)
		return errno == EINTR;
	if (polls[1].revents)
		return false;
	const ssize_t got = read(STDIN_FILENO, input->in + input->in_size,
	                         sizeof input->in - 1 - input->in_size);
	if (got > 0)
		input->in_size += (size_t)got;
	return got > 0 || (got < 0 && (errno == EINTR || errno == EAGAIN));
}

static void serve_line(struct rb_stdin *input, char *end)
{
	size_t size = (size_t)(end - input->in);

	if (size > 0 && input->in[size - 1] == '\r')
		size--;
	input->in[size] = '\0';
	if (!input->skipping)
		(void)execute(input->session,
		              strlen(input->in) == size ? input->in : "\x01", /* is refused */
		              "standard input", input->out);
	input->skipping = false;
	input->in_size -= (size_t)(end + 1 - input->in);
	memmove(input->in, end + 1, input->in_size);
}

static void *listen_to(void *argument)
{
	struct rb_stdin *const input = argument;
	char *end;

	rb_thread_name("commands");
	while (hear(input)) {
		while ((end = memchr(input->in, '\n', input->in_size)) != NULL)
			serve_line(input, end);
		if (input->in_size < sizeof input->in - 1)
			continue;
		/* a line without an end: told once, by what does not fit either */
		input->in[input->in_size] = '\0';
		if (!input->skipping)
			(void)execute(input->session, input->in, "standard input", input->out);
		input->skipping = true;
		input->in_size = 0;
	}
	input->ended(input->user);
	return NULL;
}

enum rb_status rb_stdin_start(struct rb_stdin **input, struct rb_session *session, FILE *out,
                              void (*ended)(void *user), void *user, struct rb_error *err)
{
	struct rb_stdin *const s = rb_memory_take(1, sizeof *s);

	*input = NULL;
	if (!s)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read standard input: out of memory");
	*s = (struct rb_stdin){.session = session, .out = out, .ended = ended, .user = user};
	s->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	int failed = s->wake < 0 ? errno : 0;
	if (!failed)
		failed = rb_thread_start(&s->thread, listen_to, s);
	if (failed) {
		if (s->wake >= 0)
			close(s->wake);
		rb_memory_free(s);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot read standard input: %s",
		               strerror(failed));
	}
	*input = s;
	return RB_OK;
}

void rb_stdin_stop(struct rb_stdin *input)
{
	const uint64_t one = 1;

	if (!input)
		return;
	(void)!write(input->wake, &one, sizeof one);
	pthread_join(input->thread, NULL);
	close(input->wake);
	rb_memory_free(input);
}
