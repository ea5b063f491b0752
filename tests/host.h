/* SPDX-License-Identifier: MIT */
/* A run without a simulation, for the tests of what commands it: its frames are made by hand. */
#ifndef RB_TESTS_HOST_H
#define RB_TESTS_HOST_H

#include "worlds.h"

#include "control/history.h"
#include "control/server.h"
#include "flow/frame.h"

/* As assert_ok, with an error that is called otherwise. */
#define assert_good(error, call)                                   \
	do {                                                       \
		if ((call) != RB_OK)                               \
			fail_msg("%s: '%s'", #call, (error).text); \
	} while (0)

enum { BODIES = 3 };

/* Torn down by close_host, which looks whether the socket has gone. */
struct host {
	struct lab lab;
	struct rb_run_info info;
	struct rb_player *player;
	struct rb_session *session;
	struct rb_server *server;
	char folder[256], path[300];
	struct rb_error err;
};

static inline void open_scene(struct lab *lab)
{
	static const char source[] = "a scene\0with a zero";
	const struct rb_param_def number = {.name = "e",
	                                    .help = "",
	                                    .type = RB_PARAM_NUMBER,
	                                    .default_text = "0.5",
	                                    .value_text = "0.5",
	                                    .min = 0,
	                                    .max = 1};
	const struct rb_param_def choice = {.name = "kind",
	                                    .help = "",
	                                    .type = RB_PARAM_TEXT,
	                                    .default_text = "up",
	                                    .value_text = "up",
	                                    .min = (double)NAN,
	                                    .max = (double)NAN,
	                                    .choices = "up, down"};

	lab_open(lab, 10, 10);
	lab->scene.world.title = "Three\nballs";
	for (int i = 0; i < BODIES; i++) {
		struct rb_body_def def = lab_sphere_def(0.1, 1, (rb_vec3){i, 0, 1},
		                                        (rb_vec3){0, 0, 0});
		def.name = i == 1 ? "the ball" : i == 2 ? "c" : NULL;
		lab_add(lab, &def);
	}
	lab_plane(lab, (rb_vec3){0, 0, 0}, (rb_vec3){0, 0, 1});
	assert_good(lab->error, rb_scene_add_param(&lab->scene, &number, &lab->error));
	assert_good(lab->error, rb_scene_add_param(&lab->scene, &choice, &lab->error));
	assert_good(lab->error, rb_scene_add_file(&lab->scene, "scene.lua", source,
	                                          sizeof source - 1, "", &lab->error));
	assert_good(lab->error, rb_model_create(&lab->model, &lab->scene, NULL, &lab->error));
}

static inline void open_session(struct host *host)
{
	*host = (struct host){0};
	open_scene(&host->lab);
	host->info = (struct rb_run_info){.version = "0",
	                                  .build = "b",
	                                  .command = "c",
	                                  .host = "h",
	                                  .author = "a",
	                                  .method = "m",
	                                  .rollback = "r",
	                                  .model = host->lab.model,
	                                  .scene = &host->lab.scene};
	assert_good(host->err, rb_player_create(&host->player, 101, 10, &host->err));
	rb_player_attend(host->player, false); /* the test is the simulator: nobody would wake it */
	assert_good(host->err, rb_session_create(&host->session, host->player, &host->err));
	assert_good(host->err, rb_session_attach(host->session, &host->info, NULL, &host->err));
}

static inline void open_host(struct host *host)
{
	open_session(host);
	support_folder(host->folder);
	snprintf(host->path, sizeof host->path, "%s/s", host->folder);
	assert_good(host->err,
	            rb_server_create(&host->server, host->path, host->session, &host->err));
}

static inline void close_host(struct host *host)
{
	rb_server_destroy(host->server);
	rb_session_destroy(host->session);
	rb_player_destroy(host->player);
	lab_close(&host->lab);
	if (*host->folder) {
		assert_int_equal(access(host->path, F_OK), -1);
		rmdir(host->folder);
	}
}

/* Frame k as a run would keep it: body i is at (k, i, 0). */
static inline void keep_frame(struct host *host, uint64_t k)
{
	struct rb_frame frame;

	assert_good(host->err, rb_frame_init(&frame, host->lab.model,
	                                     RB_HISTORY_FIELDS | RB_FIELD_EVENTS, &host->err));
	frame.index = k;
	frame.time_s = (double)k / 10;
	for (int i = 0; i < BODIES; i++) {
		frame.position[3 * i] = (double)k;
		frame.position[3 * i + 1] = i;
		frame.velocity[3 * i] = 0.1;
	}
	rb_session_keep(host->session, &frame);
	const struct rb_player_frame passing = {
		.numbers = &frame.numbers, .index = k, .time_s = frame.time_s};
	rb_player_arrive(host->player, &passing);
	rb_frame_release(&frame);
}

/* What the session answers to a line, without a socket. Static storage. */
static inline const char *asked(struct host *host, const char *line)
{
	static char text[65536];
	struct rb_answer answer = {0};

	(void)rb_session_execute(host->session, line, "test", &answer);
	assert_true(answer.size < sizeof text);
	memcpy(text, answer.text, answer.size);
	text[answer.size] = '\0';
	rb_answer_release(&answer);
	return text;
}

static inline void assert_answer(struct host *host, const char *line, const char *part)
{
	const char *answer = asked(host, line);

	if (!strstr(answer, part))
		fail_msg("'%s': answered \"%s\", wanted \"%s\"", line, answer, part);
}

#endif
