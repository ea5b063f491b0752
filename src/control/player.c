/* SPDX-License-Identifier: MIT */
/*
 * All state is behind one lock that is held for a few instructions; the gate is a loop over a
 * condition. Requests are flags, not a queue: asking twice for the same is the same, and the
 * simulator takes all that has been asked for at the next frame. Only movements of cameras are a
 * queue, because each of them counts.
 *
 * The gate decides in the order keep, quit, restart: a checkpoint that was asked for before the end
 * is still written.
 */
#include "control/player.h"

#include <math.h>
#include <pthread.h>
#include <string.h>
#include <time.h>

#include "base/clock.h"
#include "base/error.h"
#include "base/memory.h"

/*
 * ms between two questions for signals while the gate waits: handlers cannot signal a condition
 * variable, and 50 ms are not felt.
 */
enum { ASK_EVERY_MS = 50 };

struct rb_player {
	pthread_mutex_t lock;
	pthread_cond_t changed;

	/* protected by lock */
	struct rb_player_status
		status; /* but for what is made when asked for: wall_s, paused_s, pausing, paused */
	uint64_t start_ns, paused_ns; /* the pauses that are over */
	uint64_t paused_since_ns;     /* 0: the gate is not waiting */
	bool pausing;                 /* wait at the next frame */
	uint64_t steps;               /* frames to go on by before pausing, 0: not stepping */
	bool restarting, quitting, keeping, attended;
	struct rb_player_aim aim[RB_PLAYER_AIMS_MAX]; /* that wait for the simulator's thread */
	int aim_count;
};

enum rb_status rb_player_create(struct rb_player **player, uint64_t frame_count, double duration_s,
                                struct rb_error *err)
{
	struct rb_player *const p = rb_memory_take(1, sizeof *p);
	pthread_condattr_t attributes;

	RB_ASSERT(duration_s >= 0);
	*player = p;
	if (!p)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot make the run's player: out of memory");
	pthread_condattr_init(&attributes);
	pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
	pthread_mutex_init(&p->lock, NULL);
	pthread_cond_init(&p->changed, &attributes);
	pthread_condattr_destroy(&attributes);
	p->start_ns = rb_clock_now_ns();
	p->attended = true;
	p->status = (struct rb_player_status){
		.frame_count = frame_count, .duration_s = duration_s, .filming = true};
	return RB_OK;
}

void rb_player_destroy(struct rb_player *player)
{
	if (!player)
		return;
	pthread_cond_destroy(&player->changed);
	pthread_mutex_destroy(&player->lock);
	rb_memory_free(player);
}

void rb_player_begin_again(struct rb_player *player, uint64_t frame_count, double duration_s)
{
	RB_ASSERT(duration_s >= 0);
	pthread_mutex_lock(&player->lock);
	player->status = (struct rb_player_status){
		.frame_count = frame_count,
		.duration_s = duration_s,
		.stops_at_collision = player->status.stops_at_collision,
		.filming = true,
		.restarts = player->status.restarts + 1,
	};
	player->start_ns = rb_clock_now_ns();
	player->paused_ns = player->paused_since_ns = 0;
	player->aim_count = 0;
	player->restarting = false;
	/* steps under way are of the run that is gone: what they would have ended in is a pause */
	player->pausing |= player->steps > 0;
	player->steps = 0;
	pthread_mutex_unlock(&player->lock);
}

void rb_player_arrive(struct rb_player *player, const struct rb_player_frame *frame)
{
	pthread_mutex_lock(&player->lock);
	struct rb_player_status *const s = &player->status;
	const struct rb_frame_numbers *const n = frame->numbers;
	const double part = s->duration_s > 0 ? frame->time_s / s->duration_s * RB_PLAYER_PARTS : 0;

	s->begun = true;
	s->frame = frame->index;
	s->time_s = frame->time_s;
	s->collisions += n->collisions;
	s->rollbacks += n->rollbacks;
	/*
	 * the collisions of a frame were before it: those of the last frame belong to the last part
	 */
	s->part[part < RB_PLAYER_PARTS ? (int)fmax(part, 0) : RB_PLAYER_PARTS - 1] += n->collisions;
	if (n->smallest_step > 0 &&
	    (s->smallest_step_s <= 0 || n->smallest_step < s->smallest_step_s))
		s->smallest_step_s = n->smallest_step;
	s->max_penetration_m = fmax(s->max_penetration_m, n->max_penetration);
	s->kinetic_energy = n->kinetic_energy;
	s->potential_energy = n->potential_energy;
	s->ring_used = frame->ring_used;
	s->ring_slots = frame->ring_slots;
	/* the last step of several is the pause */
	if (player->steps > 0 && --player->steps == 0)
		player->pausing = true;
	if (s->stops_at_collision && n->collisions > 0) {
		player->pausing = true;
		player->steps = 0;
	}
	pthread_mutex_unlock(&player->lock);
}

/*
 * Whether the gate has to wait. Nobody attended, or an end, overrides a pause: a run must not stand
 * still for ever without anybody who could say play.
 */
static bool waits_locked(const struct rb_player *player)
{
	return player->pausing && player->attended && !player->quitting && !player->restarting &&
	       !player->status.ended;
}

/* The moment ASK_EVERY_MS from now on the monotonic clock. */
static struct timespec soon(void)
{
	struct timespec at;

	clock_gettime(CLOCK_MONOTONIC, &at);
	at.tv_nsec += ASK_EVERY_MS * 1000000L;
	if (at.tv_nsec >= 1000000000) {
		at.tv_nsec -= 1000000000;
		at.tv_sec++;
	}
	return at;
}

enum rb_player_verdict rb_player_gate(struct rb_player *player, bool (*stop)(void *user),
                                      void *user)
{
	enum rb_player_verdict verdict = RB_PLAYER_GO;
	bool stopped = false;

	pthread_mutex_lock(&player->lock);
	while (waits_locked(player) && !player->keeping && !stopped) {
		const struct timespec until = soon();
		if (player->paused_since_ns == 0)
			player->paused_since_ns = rb_clock_now_ns();
		(void)pthread_cond_timedwait(&player->changed, &player->lock, &until);
		if (!waits_locked(player) || !stop)
			continue;
		pthread_mutex_unlock(&player->lock); /* it may ask for the status */
		stopped = stop(user);
		pthread_mutex_lock(&player->lock);
	}
	if (player->paused_since_ns > 0)
		player->paused_ns += rb_clock_now_ns() - player->paused_since_ns;
	player->paused_since_ns = 0;
	if (player->keeping)
		verdict = RB_PLAYER_KEEP;
	else if (player->quitting)
		verdict = RB_PLAYER_QUIT;
	else if (player->restarting)
		verdict = RB_PLAYER_RESTART;
	if (verdict != RB_PLAYER_KEEP)
		player->restarting = false;
	player->keeping = false;
	pthread_mutex_unlock(&player->lock);
	return verdict;
}

void rb_player_end(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->status.ended = true;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_play(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->pausing = false;
	player->steps = 0;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_pause(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->pausing = true;
	player->steps = 0;
	pthread_mutex_unlock(&player->lock);
}

void rb_player_step(struct rb_player *player, uint64_t frames)
{
	pthread_mutex_lock(&player->lock);
	player->steps += frames;
	player->pausing = false;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_restart(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->restarting = true;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_keep(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->keeping = true;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_quit(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	player->quitting = true;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

void rb_player_stop_at_collision(struct rb_player *player, bool on)
{
	pthread_mutex_lock(&player->lock);
	player->status.stops_at_collision = on;
	pthread_mutex_unlock(&player->lock);
}

void rb_player_film(struct rb_player *player, bool on)
{
	pthread_mutex_lock(&player->lock);
	player->status.filming = on;
	pthread_mutex_unlock(&player->lock);
}

bool rb_player_aim(struct rb_player *player, const struct rb_player_aim *aim)
{
	pthread_mutex_lock(&player->lock);
	const bool fits = player->aim_count < RB_PLAYER_AIMS_MAX;
	if (fits)
		player->aim[player->aim_count++] = *aim;
	pthread_mutex_unlock(&player->lock);
	return fits;
}

bool rb_player_take_aim(struct rb_player *player, struct rb_player_aim *aim)
{
	pthread_mutex_lock(&player->lock);
	const bool waits = player->aim_count > 0;
	RB_ASSERT(player->aim_count >= 0 && player->aim_count <= RB_PLAYER_AIMS_MAX);
	if (waits) {
		*aim = player->aim[0];
		memmove(player->aim, player->aim + 1, (size_t)--player->aim_count * sizeof *aim);
	}
	pthread_mutex_unlock(&player->lock);
	return waits;
}

void rb_player_has_films(struct rb_player *player, bool has)
{
	pthread_mutex_lock(&player->lock);
	player->status.has_films = has;
	pthread_mutex_unlock(&player->lock);
}

bool rb_player_filming(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	const bool filming = player->status.filming;
	pthread_mutex_unlock(&player->lock);
	return filming;
}

void rb_player_attend(struct rb_player *player, bool attended)
{
	pthread_mutex_lock(&player->lock);
	player->attended = attended;
	pthread_cond_broadcast(&player->changed);
	pthread_mutex_unlock(&player->lock);
}

struct rb_player_status rb_player_status(struct rb_player *player)
{
	pthread_mutex_lock(&player->lock);
	struct rb_player_status status = player->status;
	const uint64_t now = rb_clock_now_ns();
	const uint64_t paused_ns = player->paused_ns + (player->paused_since_ns > 0
	                                                        ? now - player->paused_since_ns
	                                                        : 0);
	status.pausing = player->pausing && player->attended;
	status.paused = status.pausing && player->paused_since_ns > 0;
	status.paused_s = (double)paused_ns * 1e-9;
	status.wall_s = (double)(now - player->start_ns - paused_ns) * 1e-9;
	pthread_mutex_unlock(&player->lock);
	return status;
}

/* ---- films ---- */

static void consider(struct rb_player_movable *movable, const char *name, bool late)
{
	if (name)
		rb_nearest_offer(&movable->nearest, name, strlen(name));
	if (movable->name[0] && (!name || strcmp(name, movable->name) != 0))
		return;
	movable->found = true;
	movable->early |= !late;
}

void rb_player_consider_films(struct rb_player_movable *movable, const struct rb_scene *scene)
{
	const struct rb_camera_def *const cameras = scene->cameras;

	for (int i = 0; i < scene->camera_count; i++)
		if (cameras[i].png || cameras[i].video)
			consider(movable, cameras[i].name, cameras[i].framed);
	for (int i = 0; i < scene->film_count; i++) {
		const struct rb_film_def *const film = &scene->films[i];
		bool late = false;

		for (int c = 0; c < film->cell_count; c++)
			late |= cameras[film->cells[c]].framed;
		consider(movable, film->camera.name, late);
		for (int c = 0; c < film->cell_count; c++)
			consider(movable, cameras[film->cells[c]].name, late);
	}
}
