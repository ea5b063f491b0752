/* SPDX-License-Identifier: MIT */
/* src/control/server.c, client.c, address.c */
#include "host.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <time.h>

#include "base/memory.h"
#include "control/client.h"
#include "control/wire.h"

static const double patience_s = 120;

static struct rb_client *connected(struct host *host)
{
	struct rb_client *client;

	assert_good(host->err, rb_client_connect(&client, host->path, patience_s, &host->err));
	return client;
}

/* A connection without a protocol. */
static int plain_socket(const char *path)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);

	snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
	assert_true(fd >= 0);
	assert_int_equal(connect(fd, (struct sockaddr *)&address, sizeof address), 0);
	return fd;
}

static void assert_alive(struct host *host)
{
	struct rb_client *client = connected(host);
	const char *lines;
	size_t size;

	assert_good(host->err,
	            rb_client_request(client, "status", patience_s, &lines, &size, &host->err));
	assert_non_null(strstr(lines, "state "));
	rb_client_close(client);
}

static void a_socket_is_private_and_goes_with_its_server(void **state)
{
	struct host host;
	struct stat file;

	(void)state;
	umask(0);
	open_host(&host);
	assert_int_equal(lstat(host.path, &file), 0);
	assert_true(S_ISSOCK(file.st_mode));
	assert_int_equal(file.st_mode & 07777, 0600);
	assert_int_equal(umask(022), 0);
	assert_alive(&host);
	close_host(&host); /* looks whether it is gone */
}

static void a_live_socket_is_never_taken_and_a_stale_one_is(void **state)
{
	struct host host;
	struct rb_server *second;
	struct rb_error err;
	char stale[310];

	(void)state;
	open_host(&host);
	assert_int_equal(rb_server_create(&second, host.path, host.session, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "listens there"));
	assert_alive(&host);

	/* a process that is killed leaves its socket behind */
	snprintf(stale, sizeof stale, "%s2", host.path);
	const pid_t child = fork();
	if (child == 0) {
		struct sockaddr_un address = {.sun_family = AF_UNIX};
		snprintf(address.sun_path, sizeof address.sun_path, "%.100s", stale);
		const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
		_exit(bind(fd, (struct sockaddr *)&address, sizeof address) || listen(fd, 1));
	}
	int status;
	assert_int_equal(waitpid(child, &status, 0), child);
	assert_int_equal(status, 0);
	assert_int_equal(access(stale, F_OK), 0);
	assert_ok(rb_server_create(&second, stale, host.session, &err));
	rb_server_destroy(second);
	assert_int_equal(access(stale, F_OK), -1);
	close_host(&host);
}

static void what_is_no_socket_is_not_touched(void **state)
{
	struct host host;
	struct rb_server *second;
	struct rb_error err;
	char path[600], target[310];

	(void)state;
	open_host(&host);
	snprintf(target, sizeof target, "%s/file", host.folder);
	const int fd = open(target, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	assert_true(fd >= 0);
	close(fd);
	assert_int_equal(rb_server_create(&second, target, host.session, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "not a socket"));
	assert_int_equal(access(target, F_OK), 0);
	unlink(target);
	assert_int_equal(symlink("nowhere", target), 0);
	assert_int_equal(rb_server_create(&second, target, host.session, &err), RB_ERR_CREATE);
	unlink(target);

	snprintf(path, sizeof path, "%s/%0200d", host.folder, 1);
	assert_int_equal(rb_server_create(&second, path, host.session, &err), RB_ERR_CREATE);
	assert_non_null(strstr(err.text, "wanted 1 to 107"));
	snprintf(path, sizeof path, "%s/none/s", host.folder);
	assert_int_equal(rb_server_create(&second, path, host.session, &err), RB_ERR_CREATE);
	assert_int_equal(rb_server_create(&second, "", host.session, &err), RB_ERR_CREATE);
	close_host(&host);
}

static void a_socket_that_was_replaced_is_not_taken_away(void **state)
{
	struct host host;

	(void)state;
	open_host(&host);
	unlink(host.path);
	const int fd = open(host.path, O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
	close(fd);
	rb_server_destroy(host.server);
	host.server = NULL;
	assert_int_equal(access(host.path, F_OK), 0);
	unlink(host.path);
	close_host(&host);
}

static void a_client_tells_why_it_gets_nothing(void **state)
{
	struct host host;
	struct rb_client *client;
	const char *lines;
	size_t size;
	struct rb_error err;
	char path[310];

	(void)state;
	open_host(&host);
	snprintf(path, sizeof path, "%s/none", host.folder);
	assert_int_equal(rb_client_connect(&client, path, 1, &err), RB_ERR_INPUT);
	client = connected(&host);
	assert_int_equal(rb_client_request(client, "pausse", patience_s, &lines, &size, &err),
	                 RB_ERR_USAGE);
	assert_non_null(strstr(err.text, "did you mean 'pause'?"));
	assert_int_equal(rb_client_request(client, "status\nquit", patience_s, &lines, &size, &err),
	                 RB_ERR_USAGE);
	assert_ok(rb_client_request(client, "help", patience_s, &lines, &size, &err));
	assert_int_equal(strncmp(lines, "play: ", 6), 0);
	rb_server_destroy(host.server);
	host.server = NULL;
	assert_int_equal(rb_client_request(client, "status", patience_s, &lines, &size, &err),
	                 RB_ERR_MISSING);
	assert_int_equal(rb_client_request(client, "status", patience_s, &lines, &size, &err),
	                 RB_ERR_MISSING);
	rb_client_close(client);
	close_host(&host);
}

/* Somebody else's server, which says one thing and nothing more. */
static void assert_refused(const char *path, const char *greeting, const char *message)
{
	struct sockaddr_un address = {.sun_family = AF_UNIX};
	const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	struct rb_client *client;
	struct rb_error err;

	snprintf(address.sun_path, sizeof address.sun_path, "%s", path);
	assert_int_equal(bind(listener, (struct sockaddr *)&address, sizeof address), 0);
	assert_int_equal(listen(listener, 1), 0);
	const pid_t child = fork();
	if (child == 0) {
		const int fd = accept(listener, NULL, NULL);
		(void)!write(fd, greeting, strlen(greeting));
		pause();
	}
	/* the child ends before anything can fail: an assertion leaves this function */
	const enum rb_status status = child < 0 ? RB_OK
	                                        : rb_client_connect(&client, path, 0.5, &err);
	if (child > 0) {
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
	}
	close(listener);
	unlink(path);
	assert_int_equal(status, RB_ERR_MISSING);
	if (!strstr(err.text, message))
		fail_msg("'%s': \"%s\"", greeting, err.text);
}

static void a_client_knows_its_server(void **state)
{
	char folder[256], path[300];

	(void)state;
	support_folder(folder);
	snprintf(path, sizeof path, "%s/s", folder);
	assert_refused(path, "220 mail\n", "is not a run of rbsim");
	assert_refused(path, "rbsim 2 x\n", "protocol 2, wanted 1");
	assert_refused(path, "error too many clients\n", "too many clients");
	assert_refused(path, "rbsim 1", "the time is over");
	rmdir(folder);
}

/* ---- many, slow, broken and hostile clients ---- */

static void many_are_served_at_once_and_one_too_many_is_told(void **state)
{
	static struct rb_client *clients[RB_SERVER_CLIENTS_MAX];
	struct host host;
	struct rb_client *late;
	const char *lines;
	size_t size;

	(void)state;
	assert_true((int)RB_SERVER_CLIENTS_MAX >= 64);
	open_host(&host);
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
		clients[i] = connected(&host);
	assert_int_equal(rb_client_connect(&late, host.path, patience_s, &host.err),
	                 RB_ERR_MISSING);
	assert_non_null(strstr(host.err.text, "too many clients"));
	for (int round = 0; round < 3; round++)
		for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++) {
			assert_good(host.err, rb_client_request(clients[i], "help step", patience_s,
			                                        &lines, &size, &host.err));
			assert_int_equal(strncmp(lines, "step [N]: ", 10), 0);
		}
	for (int i = 0; i < RB_SERVER_CLIENTS_MAX; i++)
		rb_client_close(clients[i]);
	/* the places are free again, as soon as the server has looked */
	while (rb_client_connect(&late, host.path, patience_s, &host.err) != RB_OK)
		nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
	rb_client_close(late);
	close_host(&host);
}

static void connections_leave_nothing_behind(void **state)
{
	struct host host;

	(void)state;
	open_host(&host);
	assert_alive(&host);
	const int before = dup(0);
	close(before);
	for (int i = 0; i < 1000; i++) {
		if (i % 3 == 0)
			assert_alive(&host);
		else
			close(plain_socket(host.path)); /* at once, without a word */
	}
	assert_alive(&host);
	rb_server_destroy(host.server);
	host.server = NULL;
	const int after = dup(0);
	close(after);
	assert_true(after <= before);
	close_host(&host);
}

static void one_who_never_reads_costs_bounded_memory_and_nobody_else_waits(void **state)
{
	struct host host;
	char line[64];

	(void)state;
	open_host(&host);
	keep_frame(&host, 0);
	const int hung = plain_socket(host.path);
	assert_int_equal(fcntl(hung, F_SETFL, O_NONBLOCK), 0);
	snprintf(line, sizeof line, "help\n");
	const uint64_t before = rb_memory_counts().bytes_now;
	/* until nothing has been taken for a while: the server does not listen to it any more */
	for (int full = 0, i = 0; full < 300; i++) {
		if (send(hung, line, strlen(line), MSG_NOSIGNAL) > 0) {
			full = 0;
		} else {
			assert_int_equal(errno, EAGAIN);
			full++;
			nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
		}
		if (i % 500 == 0)
			assert_alive(&host);
	}
	assert_alive(&host);
	assert_true(rb_memory_counts().bytes_now - before < 4 << 20);
	/* when it reads at last, it gets what it was owed */
	char piece[65536];
	size_t got = 0;
	while (got < (size_t)1 << 20) {
		const ssize_t one = recv(hung, piece, sizeof piece, 0);
		assert_true(one > 0 || (one < 0 && errno == EAGAIN));
		if (one > 0)
			got += (size_t)one;
		else
			nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
	}
	close(hung);
	assert_alive(&host);
	close_host(&host);
}

/* All that comes until the connection is closed, or the text holds what is waited for. */
static size_t hear(int fd, char *text, size_t size, const char *until)
{
	const struct timeval patience = {.tv_sec = 10};
	size_t got = 0;

	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
	text[0] = '\0';
	while (got + 1 < size && !(until && strstr(text, until))) {
		const ssize_t one = recv(fd, text + got, size - 1 - got, 0);
		if (one <= 0)
			break;
		got += (size_t)one;
		text[got] = '\0';
	}
	return got;
}

static void lines_come_in_pieces_and_together(void **state)
{
	static const char all[] = "help step\r\nhelp play\n";
	struct host host;
	char text[4096];

	(void)state;
	open_host(&host);
	const int fd = plain_socket(host.path);
	for (size_t i = 0; i < strlen(all); i++)
		assert_int_equal(send(fd, all + i, 1, 0), 1);
	hear(fd, text, sizeof text, " play: continue the run\nok\n");
	assert_non_null(strstr(text, "rbsim 1 Three\n step [N]: "));
	/* one who says all and then only listens gets all answers */
	assert_int_equal(send(fd, "help stop\nhelp set\nqui", 22, 0), 22);
	shutdown(fd, SHUT_WR);
	hear(fd, text, sizeof text, NULL);
	assert_non_null(strstr(text, " set PARAMETER VALUE: "));
	close(fd);
	/* half a line was no command */
	assert_int_equal(rb_player_gate(host.player, NULL, NULL), RB_PLAYER_GO);
	close_host(&host);
}

static void what_is_no_line_is_refused(void **state)
{
	struct host host;
	char text[4096], line[3000];

	(void)state;
	open_host(&host);
	int fd = plain_socket(host.path);
	assert_int_equal(send(fd, "sta\0tus\n", 8, 0), 8);
	hear(fd, text, sizeof text, "error");
	assert_non_null(strstr(text, "zero byte"));
	assert_int_equal(send(fd, "\x1b[A\xff\n", 5, 0), 5);
	hear(fd, text, sizeof text, "0x1b");
	assert_non_null(strstr(text, "error byte 1 of the line is 0x1b"));
	close(fd);

	memset(line, 'a', sizeof line);
	line[RB_COMMAND_LINE_SIZE] = '\n'; /* as long as a line may be */
	fd = plain_socket(host.path);
	assert_int_equal(send(fd, line, RB_COMMAND_LINE_SIZE + 1, 0), RB_COMMAND_LINE_SIZE + 1);
	hear(fd, text, sizeof text, "error");
	assert_non_null(strstr(text, "a word of more than"));
	line[RB_COMMAND_LINE_SIZE] = 'a';
	assert_int_equal(send(fd, line, sizeof line, MSG_NOSIGNAL), sizeof line);
	hear(fd, text, sizeof text, NULL); /* until it is closed */
	assert_non_null(strstr(text, "error the line is too long"));
	close(fd);
	assert_alive(&host);
	close_host(&host);
}

static void random_bytes_do_no_harm(void **state)
{
	const time_t end = time(NULL) + 3;
	struct host host;
	unsigned random = 12345;
	char bytes[512], text[65536];

	(void)state;
	open_host(&host);
	keep_frame(&host, 0);
	while (time(NULL) < end) {
		const int fd = plain_socket(host.path);
		for (int k = 0; k < 8; k++) {
			for (size_t i = 0; i < sizeof bytes; i++) {
				random = random * 1664525 + 1013904223;
				/* some bytes are drawn from commands, so that more than the first is looked at */
				bytes[i] = random & 1u << 30
				                   ? "step seek\"\n #%1 "[random >> 20 & 15]
				                   : (char)(random >> 16);
			}
			if (send(fd, bytes, sizeof bytes, MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
				break;
			while (recv(fd, text, sizeof text, MSG_DONTWAIT) > 0)
				;
		}
		close(fd);
	}
	assert_alive(&host);
	close_host(&host);
}

static void a_client_that_is_killed_is_forgotten(void **state)
{
	struct host host;

	(void)state;
	open_host(&host);
	for (int i = 0; i < 20; i++) {
		const pid_t child = fork();
		if (child == 0) {
			const int fd = plain_socket(host.path);
			for (;;)
				if (send(fd, "status\nhelp\n", 12, MSG_NOSIGNAL) < 0)
					_exit(0);
		}
		nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
		kill(child, SIGKILL);
		waitpid(child, NULL, 0);
	}
	assert_alive(&host);
	close_host(&host);
}

/* Frames come while many ask for them: the simulator never waits longer than for a copy. */
static void *ask_for_frames(void *argument)
{
	struct host *host = argument;
	struct rb_client *client;
	struct rb_error err;
	struct rb_frame frame = {0};
	uint64_t last = 0;

	if (rb_client_connect(&client, host->path, patience_s, &err))
		return (void *)(uintptr_t) "cannot connect";
	for (int i = 0; i < 300; i++) {
		const char *lines, *wrong = NULL;
		size_t size;
		if (rb_client_request(client, i % 2 ? "frame" : "frame all", patience_s, &lines,
		                      &size, &err))
			wrong = "no frame";
		else if (rb_wire_read_frame(&frame, BODIES, lines, size - 1, &err))
			wrong = "a broken frame";
		else if (frame.index < last || frame.position[6] != (double)frame.index)
			wrong = "another frame";
		if (wrong)
			return (void *)(uintptr_t)wrong;
		last = frame.index;
	}
	rb_frame_release(&frame);
	rb_client_close(client);
	return NULL;
}

static void frames_go_out_while_others_come_in(void **state)
{
	enum { MANY = 8 };
	pthread_t threads[MANY];
	struct host host;

	(void)state;
	open_host(&host);
	keep_frame(&host, 0);
	for (int i = 0; i < MANY; i++)
		assert_int_equal(pthread_create(&threads[i], NULL, ask_for_frames, &host), 0);
	for (uint64_t k = 1; k < 20000; k++)
		keep_frame(&host, k);
	for (int i = 0; i < MANY; i++) {
		void *wrong;
		pthread_join(threads[i], &wrong);
		if (wrong)
			fail_msg("%s", (const char *)wrong);
	}
	close_host(&host);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_socket_is_private_and_goes_with_its_server),
		cmocka_unit_test(a_live_socket_is_never_taken_and_a_stale_one_is),
		cmocka_unit_test(what_is_no_socket_is_not_touched),
		cmocka_unit_test(a_socket_that_was_replaced_is_not_taken_away),
		cmocka_unit_test(a_client_tells_why_it_gets_nothing),
		cmocka_unit_test(a_client_knows_its_server),
		cmocka_unit_test(many_are_served_at_once_and_one_too_many_is_told),
		cmocka_unit_test(connections_leave_nothing_behind),
		cmocka_unit_test(one_who_never_reads_costs_bounded_memory_and_nobody_else_waits),
		cmocka_unit_test(lines_come_in_pieces_and_together),
		cmocka_unit_test(what_is_no_line_is_refused),
		cmocka_unit_test(random_bytes_do_no_harm),
		cmocka_unit_test(a_client_that_is_killed_is_forgotten),
		cmocka_unit_test(frames_go_out_while_others_come_in),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
