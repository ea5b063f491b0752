/* SPDX-License-Identifier: MIT */
/*
 * Brings the ways in (socket, standard input, file) together with the player and the session, which
 * outlive a run: on a restart only the run is exchanged. The next scene is loaded while the old run
 * still stands, so a mistake in a parameter leaves the old run paused and alive.
 */
#include "app/listen.h"

#include <signal.h>
#include <string.h>

#include "app/commands.h"
#include "base/error.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/thread.h"
#include "control/history.h"
#include "control/server.h"

struct rb_listen {
	/* set before any thread starts, then only read */
	const struct rb_options *options;
	struct rb_player *player;
	struct rb_session *session;
	struct rb_server *server; /* NULL: no socket */
	struct rb_stdin *input;   /* NULL: standard input is not read */
	sigset_t mask_before;

	/* the simulator's thread */
	struct rb_loaded *loaded;     /* borrowed: of this run */
	struct rb_commands *commands; /* NULL: no file */
	FILE *out;
	struct rb_loaded *next;      /* owned: of the next run */
	struct rb_options again;     /* for the next run */
	const char **params;         /* owned: of `again` */
	struct rb_session_set *sets; /* owned: texts in `params` */
};

/* ---- life ---- */

/* Standard input has ended: without a socket nobody is left to say play. */
static void input_ended(void *user)
{
	struct rb_listen *const listen = user;

	if (!listen->server)
		rb_player_attend(listen->player, false);
}

/* Whether commands come from standard input. */
static bool reads_stdin(const struct rb_options *options)
{
	return options->commands && strcmp(options->commands, "-") == 0;
}

/* Opens the ways in. What can be wrong with a file comes first: nobody has seen the socket then. */
static enum rb_status open_ways(struct rb_listen *listen, struct rb_error *err)
{
	const struct rb_options *const options = listen->options;
	const struct rb_commands_check check = {.scene = &listen->loaded->scene,
	                                        .duration_s = listen->loaded->model->duration_s,
	                                        .attended = options->listen != NULL};
	enum rb_status status = RB_OK;

	rb_player_attend(listen->player, options->listen || reads_stdin(options));
	/* what can be wrong with a file first: nobody has seen the socket then */
	if (options->commands && !reads_stdin(options))
		status = rb_commands_read(&listen->commands, options->commands, &check, err);
	if (!status && options->listen)
		status = rb_server_create(&listen->server, options->listen, listen->session, err);
	if (!status && reads_stdin(options))
		status = rb_stdin_start(&listen->input, listen->session, listen->out, input_ended,
		                        listen, err);
	return status;
}

/* Blocks the signals that the progress thread takes, before any other thread is started. */
static void block_signals(sigset_t *before)
{
	const sigset_t signals = rb_thread_stops();

	pthread_sigmask(SIG_BLOCK, &signals, before);
}

enum rb_status rb_listen_create(struct rb_listen **listen, const struct rb_options *options,
                                struct rb_loaded *loaded, const struct rb_run_info *info,
                                struct rb_error *err)
{
	*listen = NULL;
	if (!options->listen && !options->commands)
		return RB_OK;
	struct rb_listen *const l = rb_memory_take(1, sizeof *l);
	if (!l)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot take commands: out of memory");
	block_signals(&l->mask_before);
	l->options = options;
	l->loaded = loaded;
	l->out = options->json ? stderr : stdout;
	enum rb_status status = rb_player_create(&l->player, loaded->model->frame_count,
	                                         loaded->model->duration_s, err);
	if (!status)
		status = rb_session_create(&l->session, l->player, err);
	if (!status)
		status = rb_session_attach(l->session, info, loaded->output, err);
	if (!status)
		status = open_ways(l, err);
	if (status) {
		rb_listen_destroy(l);
		return status;
	}
	*listen = l;
	return RB_OK;
}

void rb_listen_destroy(struct rb_listen *listen)
{
	if (!listen)
		return;
	if (listen->player)
		rb_player_end(listen->player);
	rb_stdin_stop(listen->input);
	rb_server_destroy(listen->server);
	rb_session_destroy(listen->session);
	rb_player_destroy(listen->player);
	rb_commands_destroy(listen->commands);
	if (listen->next)
		rb_loaded_release(listen->next);
	rb_memory_free(listen->next);
	rb_memory_free(listen->params);
	rb_memory_free(listen->sets);
	pthread_sigmask(SIG_SETMASK, &listen->mask_before, NULL);
	rb_memory_free(listen);
}

/* ---- while the run goes on ---- */

unsigned rb_listen_fields(const struct rb_listen *listen)
{
	return listen ? (unsigned)RB_HISTORY_FIELDS : 0;
}

void rb_listen_frame(struct rb_listen *listen, const struct rb_frame *frame)
{
	RB_ASSERT(listen && frame);
	rb_session_keep(listen->session, frame);
}

double rb_listen_paused_s(const struct rb_listen *listen)
{
	return rb_player_status(listen->player).paused_s;
}

void rb_listen_forget(void *listen)
{
	const struct rb_listen *const l = listen;

	if (l->server)
		rb_server_forget(l->server);
}

/*
 * The parameters of the command line, then those that were set: of two with one name the last
 * holds.
 */
static enum rb_status gather_params(struct rb_listen *listen, struct rb_error *err)
{
	const struct rb_options *const options = listen->options;
	int count = 0;

	if (!listen->sets)
		listen->sets = rb_memory_take(RB_SESSION_SETS_MAX, sizeof *listen->sets);
	if (!listen->params)
		listen->params = rb_memory_take((size_t)options->param_count + RB_SESSION_SETS_MAX,
		                                sizeof *listen->params);
	if (!listen->sets || !listen->params)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory");
	for (int i = 0; i < options->param_count; i++)
		listen->params[count++] = options->params[i];
	const int set_count = rb_session_sets(listen->session, listen->sets);
	for (int i = 0; i < set_count; i++)
		listen->params[count++] = listen->sets[i].text;
	listen->again = *options;
	listen->again.params = listen->params;
	listen->again.param_count = count;
	listen->again.force = true;
	listen->again.resume = false;
	return RB_OK;
}

/* Loads the scene for the next run as it was read, not as its file may be by now. */
static enum rb_status load_next(struct rb_listen *listen, const struct rb_listen_calls *calls,
                                struct rb_error *err)
{
	enum rb_status status = gather_params(listen, err);

	if (status)
		return status;
	listen->next = rb_memory_take(1, sizeof *listen->next);
	if (!listen->next)
		return RB_FAIL(err, RB_ERR_MEMORY, "out of memory");
	status = rb_loaded_again(listen->next, listen->loaded, &listen->again, calls->stop,
	                         calls->user, err);
	if (!status)
		return RB_OK;
	rb_loaded_release(listen->next);
	rb_memory_free(listen->next);
	listen->next = NULL;
	return status;
}

enum rb_player_verdict rb_listen_gate(struct rb_listen *listen, const struct rb_player_frame *frame,
                                      const struct rb_listen_calls *calls)
{
	struct rb_error err = {0};

	rb_player_arrive(listen->player, frame);
	if (listen->commands)
		rb_commands_execute(listen->commands, frame->time_s, listen->session, listen->out);
	for (;;) {
		const enum rb_player_verdict verdict = rb_player_gate(listen->player, calls->stop,
		                                                      calls->user);
		if (verdict == RB_PLAYER_KEEP) {
			calls->keep(calls->user);
			continue;
		}
		if (verdict != RB_PLAYER_RESTART || load_next(listen, calls, &err) == RB_OK)
			return verdict;
		if (calls->stop(calls->user))
			continue; /* the gate says so */
		rb_log(RB_LOG_WARNING, "cannot restart: %s", err.text);
		rb_session_tell(listen->session, "cannot restart, the run is paused: %.120s",
		                err.text);
		rb_player_pause(listen->player);
	}
}

void rb_listen_has_films(struct rb_listen *listen, bool has)
{
	if (listen)
		rb_player_has_films(listen->player, has);
}

void rb_listen_film(struct rb_listen *listen, bool on)
{
	if (listen)
		rb_player_film(listen->player, on);
}

bool rb_listen_take_aim(struct rb_listen *listen, struct rb_player_aim *aim)
{
	return listen && rb_player_take_aim(listen->player, aim);
}

bool rb_listen_filming(const struct rb_listen *listen)
{
	return !listen || rb_player_filming(listen->player);
}

/* ---- from one run to the next ---- */

void rb_listen_run_ends(struct rb_listen *listen)
{
	RB_ASSERT(listen->loaded != NULL);
	rb_session_detach(listen->session);
	listen->loaded = NULL;
}

struct rb_loaded *rb_listen_next(struct rb_listen *listen)
{
	struct rb_loaded *const next = listen->next;

	listen->next = NULL;
	return next;
}

const struct rb_options *rb_listen_options(const struct rb_listen *listen)
{
	return &listen->again;
}

enum rb_status rb_listen_begin_again(struct rb_listen *listen, struct rb_loaded *loaded,
                                     const struct rb_run_info *info, struct rb_error *err)
{
	rb_player_begin_again(listen->player, loaded->model->frame_count,
	                      loaded->model->duration_s);
	listen->loaded = loaded;
	return rb_session_attach(listen->session, info, loaded->output, err);
}
