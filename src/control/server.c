/* SPDX-License-Identifier: MIT */
/*
 * One thread, poll, and a state for each client: bytes that came and make no line yet, and an
 * answer that was not taken yet. The states of a client: it hears and is answered; `ended`, it
 * sends no more but still reads; `closing`, it gets what is left; dropped (fd -1). Nothing here
 * ever blocks, so a client that reads slowly only fills its own buffer; beyond OUT_MAX no further
 * line of it is looked at, and if it takes nothing for STALLED_MS it is dropped.
 *
 * Lines are executed one at a time in this thread. The session's lock is held meanwhile, and the
 * simulator does not need it for its frames.
 */
#include "control/server.h"

#include <errno.h>
#include <poll.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"
#include "base/thread.h"
#include "control/address.h"

enum {
	IN_SIZE = RB_COMMAND_LINE_SIZE + 2, /* a line with its end */
	OUT_MAX = 1 << 20,  /* bytes not taken, beyond which no further line is looked at */
	OUT_KEPT = 1 << 20, /* a larger buffer is given back when it is empty */
	STALLED_MS = 10000, /* after which one who asks without reading is dropped */
	GOODBYE_MS = 300,
	ACCEPT_AGAIN_MS = 100
};

struct client {
	int fd;       /* -1: a free place */
	char who[32]; /* for the log of events */
	bool ended;   /* sends no more */
	bool closing; /* gets what is left, and is then closed */
	char in[IN_SIZE + 1];
	size_t in_size;
	struct rb_answer out;
	size_t out_at;     /* bytes of it that were taken */
	uint64_t taken_ns; /* when the client last took something, or had nothing to take */
};

struct rb_server {
	/* set before the thread starts, then only read */
	const char *path;
	struct rb_session *session;
	struct rb_address_file file;
	int listener, wake;
	pthread_t thread;

	atomic_bool stop;

	/* the thread's */
	struct client *clients; /* owned: [RB_SERVER_CLIENTS_MAX] */
	struct pollfd *polls;   /* owned: [RB_SERVER_CLIENTS_MAX + 2] */
	uint64_t client_count;  /* of all that ever came */
	uint64_t deaf_until_ns; /* no descriptors were left to accept with */
};

/* ---- one client ---- */

/* Bytes of answers that the client has not taken. */
static size_t pending(const struct client *client)
{
	RB_ASSERT(client->out_at <= client->out.size);
	return client->out.size - client->out_at;
}

/* Closes the connection at once; the place is free. */
static void drop(struct client *client)
{
	RB_ASSERT(client->fd >= 0);
	close(client->fd);
	rb_answer_release(&client->out);
	client->fd = -1;
}

/*
 * Sends what the client takes now. May drop it: when all is sent and it is closing, or the
 * connection is broken.
 */
static void flush(struct client *client)
{
	RB_ASSERT(client->fd >= 0);
	while (pending(client) > 0) {
		const ssize_t sent = send(client->fd, client->out.text + client->out_at,
		                          pending(client), MSG_NOSIGNAL | MSG_DONTWAIT);
		if (sent < 0 && errno == EINTR)
			continue;
		if (sent < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
			return;
		if (sent <= 0) {
			drop(client);
			return;
		}
		client->out_at += (size_t)sent;
		client->taken_ns = rb_clock_now_ns();
	}
	client->taken_ns = rb_clock_now_ns();
	client->out.size = client->out_at = 0;
	if (client->out.capacity > OUT_KEPT)
		rb_answer_release(&client->out);
	if (client->closing)
		drop(client);
}

/* Answers with an error. */
static void refuse(struct client *client, const char *text)
{
	struct rb_error err;

	rb_answer_end(&client->out, RB_FAIL(&err, RB_ERR_USAGE, "%s", text), &err);
}

/* The first line break of what has come; NULL: there is none. */
static char *line_end(struct client *client)
{
	return memchr(client->in, '\n', client->in_size);
}

/* Executes the first line of what has come, which ends at `end`, and forgets it. */
static void serve_line(struct rb_server *server, struct client *client, char *end)
{
	size_t size = (size_t)(end - client->in);

	RB_ASSERT(end >= client->in && end < client->in + client->in_size);
	if (size > 0 && client->in[size - 1] == '\r')
		size--;
	client->in[size] = '\0';
	if (strlen(client->in) != size)
		refuse(client, "the line holds a zero byte, wanted printable UTF-8");
	else
		(void)rb_session_execute(server->session, client->in, client->who, &client->out);
	client->in_size -= (size_t)(end + 1 - client->in);
	memmove(client->in, end + 1, client->in_size);
}

/* Executes what has come, as far as the answers are taken. May drop the client. */
static void serve(struct rb_server *server, struct client *client)
{
	char *end;

	do {
		while (!client->closing && pending(client) <= OUT_MAX &&
		       (end = line_end(client)) != NULL)
			serve_line(server, client, end);
		if (!client->closing && client->in_size >= IN_SIZE && !line_end(client)) {
			refuse(client, "the line is too long: good bye");
			client->closing = true;
		}
		if (client->ended && !line_end(client))
			client->closing = true; /* half a line is no command */
		flush(client);
	} while (client->fd >= 0 && !client->closing && pending(client) <= OUT_MAX &&
	         line_end(client));
}

/* Takes what has come. May drop the client. */
static void hear(struct client *client)
{
	const size_t room = IN_SIZE - client->in_size;
	const ssize_t got = recv(client->fd, client->in + client->in_size, room, MSG_DONTWAIT);

	RB_ASSERT(client->in_size < IN_SIZE);
	if (got > 0)
		client->in_size += (size_t)got;
	else if (got == 0)
		client->ended = true;
	else if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
		drop(client);
}

/* Whether a client asks and asks and does not read the answers. */
static bool is_stalled(const struct client *client, uint64_t now_ns)
{
	return pending(client) > 0 && (pending(client) > OUT_MAX || client->closing) &&
	       now_ns - client->taken_ns > STALLED_MS * UINT64_C(1000000);
}

/* ---- who comes ---- */

/*
 * Whether the peer is our own user, or root. The file's mode keeps others out, but not one who got
 * in before it was changed, or through a folder with another mask.
 */
static bool is_welcome(int fd)
{
	struct ucred peer;
	socklen_t size = sizeof peer;

	return getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &peer, &size) == 0 &&
	       (peer.uid == geteuid() || peer.uid == 0);
}

/* Says why and closes the connection. */
static void turn_away(int fd, const char *text)
{
	char line[128];
	const int size = snprintf(line, sizeof line, "error %s\n", text);

	(void)!send(fd, line, (size_t)size, MSG_NOSIGNAL | MSG_DONTWAIT);
	close(fd);
}

/* Gives a new connection a place and the greeting, or turns it away where all are taken. */
static void greet(struct rb_server *server, int fd)
{
	struct client *client = server->clients;
	char title[128], line[160];

	while (client < server->clients + RB_SERVER_CLIENTS_MAX && client->fd >= 0)
		client++;
	if (client == server->clients + RB_SERVER_CLIENTS_MAX) {
		turn_away(fd, "too many clients");
		return;
	}
	*client = (struct client){.fd = fd, .taken_ns = rb_clock_now_ns()};
	snprintf(client->who, sizeof client->who, "client %llu",
	         (unsigned long long)++server->client_count);
	rb_session_title(server->session, title);
	const int size = snprintf(line, sizeof line, "rbsim %d%s%s\n", RB_SESSION_PROTOCOL,
	                          *title ? " " : "", title);
	rb_answer_put(&client->out, line, (size_t)size);
	flush(client);
}

/*
 * Accepts all that wait. Without free descriptors, listens again after a moment only: the waiting
 * connection would keep poll awake.
 */
static void accept_all(struct rb_server *server)
{
	for (;;) {
		const int fd = accept4(server->listener, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
		if (fd < 0) {
			const bool full = errno == EMFILE || errno == ENFILE || errno == ENOBUFS ||
			                  errno == ENOMEM;
			/* who waits would keep poll awake */
			if (full)
				server->deaf_until_ns = rb_clock_now_ns() +
				                        ACCEPT_AGAIN_MS * UINT64_C(1000000);
			if (errno == EINTR || errno == ECONNABORTED)
				continue;
			return;
		}
		if (is_welcome(fd))
			greet(server, fd);
		else
			turn_away(fd, "this run belongs to another user");
	}
}

/* ---- the thread ---- */

/*
 * Fills what to wait for: [0] to be woken, [1] who comes, then every place. Returns poll's
 * time-out, ms; with answers under way a second, so that stalled clients are noticed.
 */
static int fill_polls(struct rb_server *server)
{
	const uint64_t now_ns = rb_clock_now_ns();
	const bool deaf = now_ns < server->deaf_until_ns;
	int timeout_ms = deaf ? ACCEPT_AGAIN_MS : -1;

	server->polls[0] = (struct pollfd){.fd = server->wake, .events = POLLIN};
	server->polls[1] = (struct pollfd){.fd = deaf ? -1 : server->listener, .events = POLLIN};
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++) {
		struct client *const client = &server->clients[i];
		if (client->fd >= 0 && is_stalled(client, now_ns))
			drop(client);
		const bool hears = client->fd >= 0 && !client->ended && !client->closing &&
		                   client->in_size < IN_SIZE;
		const short events = (short)((hears ? POLLIN : 0) |
		                             (client->fd >= 0 && pending(client) > 0 ? POLLOUT
		                                                                     : 0));
		server->polls[2 + i] = (struct pollfd){.fd = client->fd, .events = events};
		if (client->fd >= 0 && pending(client) > 0 && timeout_ms < 0)
			timeout_ms = 1000;
	}
	return timeout_ms;
}

/* Serves every client for which poll has news. */
static void serve_all(struct rb_server *server)
{
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++) {
		struct client *const client = &server->clients[i];
		const struct pollfd *const poll = &server->polls[2 + i];
		/* places taken in this round have not been waited for */
		if (client->fd < 0 || client->fd != poll->fd || poll->revents == 0)
			continue;
		if (poll->revents & POLLIN)
			hear(client);
		else if (poll->revents & (POLLERR | POLLNVAL) ||
		         (poll->revents & POLLHUP && !(poll->events & POLLIN)))
			drop(client); /* nobody is left to take the rest */
		else if (poll->revents & POLLHUP)
			client->ended = true;
		if (client->fd >= 0)
			serve(server, client);
	}
}

/* Whether some client has not taken all of its answers. */
static bool any_pending(const struct rb_server *server)
{
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
		if (server->clients[i].fd >= 0 && pending(&server->clients[i]) > 0)
			return true;
	return false;
}

/*
 * Sends the last answers and "bye", for as long as those who read need for it, but not longer than
 * GOODBYE_MS; then drops all.
 */
static void say_goodbye(struct rb_server *server)
{
	const uint64_t deadline_ns = rb_clock_now_ns() + GOODBYE_MS * UINT64_C(1000000);

	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++) {
		struct client *const client = &server->clients[i];
		if (client->fd < 0)
			continue;
		if (!client->closing)
			rb_answer_put(&client->out, "bye\n", 4);
		client->closing = true;
		flush(client);
	}
	while (any_pending(server) && rb_clock_now_ns() < deadline_ns) {
		for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
			server->polls[i] = (struct pollfd){.fd = server->clients[i].fd,
			                                   .events = POLLOUT};
		(void)poll(server->polls, RB_SERVER_CLIENTS_MAX, GOODBYE_MS / 10);
		for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
			if (server->clients[i].fd >= 0)
				flush(&server->clients[i]);
	}
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
		if (server->clients[i].fd >= 0)
			drop(&server->clients[i]);
}

/* The server's thread. */
static void *run(void *argument)
{
	struct rb_server *const server = argument;

	rb_thread_name("server");
	while (!atomic_load(&server->stop)) {
		const int timeout_ms = fill_polls(server);
		if (poll(server->polls, RB_SERVER_CLIENTS_MAX + 2, timeout_ms) <= 0)
			continue;
		serve_all(server);
		if (server->polls[1].revents)
			accept_all(server);
	}
	say_goodbye(server);
	return NULL;
}

/* ---- life ---- */

/*
 * Frees what there is of a server whose thread has ended or never began; removes the socket's name
 * while the listener is still open.
 */
static void release(struct rb_server *server)
{
	if (server->listener >= 0) {
		rb_address_remove(server->path, &server->file);
		close(server->listener);
	}
	if (server->wake >= 0)
		close(server->wake);
	rb_memory_free(server->clients);
	rb_memory_free(server->polls);
	rb_memory_free(server);
}

enum rb_status rb_server_create(struct rb_server **server, const char *path,
                                struct rb_session *session, struct rb_error *err)
{
	struct rb_server *const s = rb_memory_take(1, sizeof *s);

	*server = NULL;
	if (!s)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot listen on '%s': out of memory", path);
	*s = (struct rb_server){.path = path, .session = session, .listener = -1, .wake = -1};
	s->clients = rb_memory_take(RB_SERVER_CLIENTS_MAX, sizeof *s->clients);
	s->polls = rb_memory_take(RB_SERVER_CLIENTS_MAX + 2, sizeof *s->polls);
	if (!s->clients || !s->polls) {
		release(s);
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot listen on '%s': out of memory", path);
	}
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
		s->clients[i].fd = -1;
	enum rb_status status = rb_address_listen(&s->listener, &s->file, path, err);
	if (status) {
		release(s);
		return status;
	}
	s->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	const int failed = s->wake < 0 ? errno : rb_thread_start(&s->thread, run, s);
	if (failed) {
		release(s);
		return RB_FAIL(err, RB_ERR_MISSING, "cannot listen on '%s': %s", path,
		               strerror(failed));
	}
	*server = s;
	return RB_OK;
}

void rb_server_destroy(struct rb_server *server)
{
	const uint64_t one = 1;

	if (!server)
		return;
	atomic_store(&server->stop, true);
	(void)!write(server->wake, &one, sizeof one);
	pthread_join(server->thread, NULL);
	release(server);
}

void rb_server_forget(const struct rb_server *server)
{
	rb_address_remove(server->path, &server->file);
}
