/* SPDX-License-Identifier: MIT */
/*
 * The socket never blocks: every wait is a poll with the time that is left until the request's
 * deadline, so that a run that hangs costs its client that time and no more. After a missing answer
 * the connection is not used again, because the late answer would be taken for that of the next
 * request.
 *
 * What arrives is checked as if it came from anybody: sizes are bounded, and a line that is no
 * answer ends the connection.
 */
#include "control/client.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "control/address.h"
#include "control/session.h"

/*
 * 1 GiB: what a server may send for one request, so that a wrong one cannot take all memory. The
 * largest true answer is a frame, 70 bytes a body.
 */
static const size_t answer_max = (size_t)1 << 30;

/* Bytes asked for at once: about what a Unix socket buffers. */
enum { PIECE = 65536 };

struct rb_client {
	int fd;
	bool broken; /* an answer is missing: the next one could be taken for it */
	char *in;    /* owned: what has come and was not taken */
	size_t in_size, in_capacity;
	char *lines; /* owned: the last answer */
	size_t lines_size, lines_capacity;
	char path[sizeof((struct sockaddr_un *)0)->sun_path];
};

void rb_client_close(struct rb_client *client)
{
	if (!client)
		return;
	if (client->fd >= 0)
		close(client->fd);
	rb_memory_free(client->in);
	rb_memory_free(client->lines);
	rb_memory_free(client);
}

/*
 * A moment of base/clock; timeouts are bounded to 12 days, which keeps the product within 64 bits.
 * NAN counts as 0.
 */
static uint64_t deadline_of(double timeout_s)
{
	return rb_clock_now_ns() + (uint64_t)(fmin(fmax(timeout_s, 0), 1e6) * 1e9);
}

/* Waits until the socket can be read or written (poll's `events`). False: the time is over. */
static bool wait_for(const struct rb_client *client, short events, uint64_t deadline_ns)
{
	RB_ASSERT(client->fd >= 0);
	for (;;) {
		const uint64_t now = rb_clock_now_ns();
		struct pollfd one = {.fd = client->fd, .events = events};
		const uint64_t left_ms = now < deadline_ns ? (deadline_ns - now + 999999) / 1000000
		                                           : 0;
		const int news = poll(&one, 1, (int)fmin((double)left_ms, 1e6));
		if (news > 0)
			return true;
		if (news == 0 && left_ms == 0)
			return false;
	}
}

/* Fails, and makes every later request fail. */
static enum rb_status no_answer(struct rb_client *client, const char *why, struct rb_error *err)
{
	client->broken = true;
	return RB_FAIL(err, RB_ERR_MISSING, "'%s' does not answer: %s", client->path, why);
}

/* Waits until more has come, which is appended to client->in. */
static enum rb_status hear(struct rb_client *client, uint64_t deadline_ns, struct rb_error *err)
{
	if (client->in_size > answer_max)
		return no_answer(client, "too much comes", err);
	if (!rb_memory_reserve(&client->in, &client->in_capacity, client->in_size + PIECE, 1)) {
		client->broken = true;
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot read from '%s': out of memory",
		               client->path);
	}
	for (;;) {
		if (!wait_for(client, POLLIN, deadline_ns))
			return no_answer(client, "the time is over", err);
		const ssize_t got = recv(client->fd, client->in + client->in_size, PIECE,
		                         MSG_DONTWAIT);
		if (got > 0) {
			client->in_size += (size_t)got;
			return RB_OK;
		}
		if (got == 0)
			return no_answer(client, "the connection was closed", err);
		if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
			return no_answer(client, strerror(errno), err);
	}
}

/*
 * Finds the end of the line that begins at byte `at` of what has come, waiting for it; `*size`
 * without the line break.
 */
static enum rb_status take_line(struct rb_client *client, size_t at, uint64_t deadline_ns,
                                size_t *size, struct rb_error *err)
{
	size_t looked = at;

	RB_ASSERT(at <= client->in_size);
	for (;;) {
		const char *const end = client->in_size > looked ? memchr(client->in + looked, '\n',
		                                                          client->in_size - looked)
		                                                 : NULL;
		if (end) {
			*size = (size_t)(end - (client->in + at));
			return RB_OK;
		}
		looked = client->in_size;
		const enum rb_status status = hear(client, deadline_ns, err);
		if (status)
			return status;
	}
}

/* Forgets the first bytes of what has come. */
static void consume(struct rb_client *client, size_t size)
{
	RB_ASSERT(size <= client->in_size);
	client->in_size -= size;
	memmove(client->in, client->in + size, client->in_size);
}

/* Reads the first line: is this a run of rbsim, with our protocol? */
static enum rb_status check_greeting(struct rb_client *client, uint64_t deadline_ns,
                                     struct rb_error *err)
{
	static const char name[] = "rbsim ";
	size_t size;

	const enum rb_status status = take_line(client, 0, deadline_ns, &size, err);
	if (status)
		return status;
	client->in[size] = '\0';
	const char *const line = client->in;
	if (strncmp(line, "error ", 6) == 0)
		return RB_FAIL(err, RB_ERR_MISSING, "'%s' rejects the connection: %.120s",
		               client->path, line + 6);
	if (strncmp(line, name, strlen(name)) != 0)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "the program that answers at '%s' is not a run of rbsim",
		               client->path);
	const long protocol = strtol(line + strlen(name), NULL, 10);
	if (protocol != RB_SESSION_PROTOCOL)
		return RB_FAIL(err, RB_ERR_MISSING,
		               "the run at '%s' speaks protocol %ld, wanted %d", client->path,
		               protocol, RB_SESSION_PROTOCOL);
	consume(client, size + 1);
	return RB_OK;
}

/* A socket that a run has left, or no socket at all. */
static const char *why_refused(const char *path)
{
	struct stat file;

	return stat(path, &file) == 0 && !S_ISSOCK(file.st_mode) ? "it is not a socket"
	                                                         : "no run listens there any more";
}

/* Connects and checks the greeting. On failure the caller closes the client. */
static enum rb_status reach(struct rb_client *client, const struct sockaddr_un *address,
                            uint64_t deadline_ns, struct rb_error *err)
{
	client->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (client->fd < 0)
		return RB_FAIL(err, RB_ERR_MISSING, "cannot reach '%s': %s", client->path,
		               strerror(errno));
	/* a listener whose queue is full says EAGAIN, and nothing tells when that ends */
	while (connect(client->fd, (const struct sockaddr *)address, sizeof *address) != 0) {
		if ((errno != EAGAIN && errno != EINTR) || rb_clock_now_ns() > deadline_ns)
			return RB_FAIL(err, errno == EAGAIN ? RB_ERR_MISSING : RB_ERR_INPUT,
			               "cannot reach a run at '%s': %s", client->path,
			               errno == ECONNREFUSED ? why_refused(client->path)
			                                     : strerror(errno));
		(void)poll(NULL, 0, 10);
	}
	return check_greeting(client, deadline_ns, err);
}

enum rb_status rb_client_connect(struct rb_client **client, const char *path, double timeout_s,
                                 struct rb_error *err)
{
	struct sockaddr_un address;

	*client = NULL;
	enum rb_status status = rb_address_of(&address, path, RB_ERR_INPUT, err);
	if (status)
		return status;
	struct rb_client *const c = rb_memory_take(1, sizeof *c);
	if (!c)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot reach '%s': out of memory", path);
	c->fd = -1;
	snprintf(c->path, sizeof c->path, "%s", path);
	status = reach(c, &address, deadline_of(timeout_s), err);
	if (status) {
		rb_client_close(c);
		return status;
	}
	*client = c;
	return RB_OK;
}

/* Sends all bytes, waiting as the server takes them. */
static enum rb_status say(struct rb_client *client, const char *bytes, size_t size,
                          uint64_t deadline_ns, struct rb_error *err)
{
	while (size > 0) {
		if (!wait_for(client, POLLOUT, deadline_ns))
			return no_answer(client, "the time is over", err);
		const ssize_t sent = send(client->fd, bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
		if (sent < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
			return no_answer(client, strerror(errno), err);
		if (sent > 0) {
			bytes += sent;
			size -= (size_t)sent;
		}
	}
	return RB_OK;
}

/* Appends a line to the answer. False: no memory. */
static bool keep_line(struct rb_client *client, const char *text, size_t size)
{
	if (!rb_memory_reserve(&client->lines, &client->lines_capacity,
	                       client->lines_size + size + 2, 1))
		return false;
	memcpy(client->lines + client->lines_size, text, size);
	client->lines_size += size;
	client->lines[client->lines_size++] = '\n';
	client->lines[client->lines_size] = '\0';
	return true;
}

/*
 * Reads lines up to the one that ends the answer; RB_ERR_USAGE with the server's text where it is
 * an error.
 */
static enum rb_status take_answer(struct rb_client *client, uint64_t deadline_ns,
                                  struct rb_error *err)
{
	enum rb_status status = RB_OK;
	size_t at = 0, size;

	for (;;) {
		status = take_line(client, at, deadline_ns, &size, err);
		if (status)
			return status;
		const char *const line = client->in + at;
		at += size + 1;
		if (size > 0 && line[0] == ' ') {
			if (keep_line(client, line + 1, size - 1))
				continue;
			client->broken = true;
			return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep an answer: out of memory");
		}
		if (size == 2 && memcmp(line, "ok", 2) == 0)
			break;
		if (size >= 6 && memcmp(line, "error ", 6) == 0) {
			status = RB_FAIL(err, RB_ERR_USAGE, "%.*s",
			                 (int)fmin((double)size - 6, RB_ERROR_TEXT_SIZE), line + 6);
			break;
		}
		if (size == 3 && memcmp(line, "bye", 3) == 0)
			return no_answer(client, "the run has ended", err);
		return no_answer(client, "its answer cannot be understood", err);
	}
	consume(client, at);
	return status;
}

enum rb_status rb_client_request(struct rb_client *client, const char *line, double timeout_s,
                                 const char **lines, size_t *size, struct rb_error *err)
{
	const uint64_t deadline_ns = deadline_of(timeout_s);
	const size_t line_size = strlen(line);
	char sent[RB_COMMAND_LINE_SIZE + 1];

	*lines = "";
	*size = 0;
	if (client->broken)
		return no_answer(client, "an earlier request was not answered", err);
	if (line_size > RB_COMMAND_LINE_SIZE || strchr(line, '\n'))
		return RB_FAIL(err, RB_ERR_USAGE,
		               "a command of %zu bytes, wanted one line of at most %d", line_size,
		               RB_COMMAND_LINE_SIZE);
	client->lines_size = 0;
	memcpy(sent, line, line_size);
	sent[line_size] = '\n';
	enum rb_status status = say(client, sent, line_size + 1, deadline_ns, err);
	if (!status)
		status = take_answer(client, deadline_ns, err);
	if (client->lines_size > 0) {
		*lines = client->lines;
		*size = client->lines_size;
	}
	return status;
}
