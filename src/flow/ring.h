/* SPDX-License-Identifier: MIT */
/*
 * Frames on their way from the simulator to its consumers: one producer, a cursor per consumer,
 * all slots taken beforehand.
 *
 *             given back            published, not yet read by all        free
 *         ...................|=====================================|...............
 *                           tail                                  head
 *
 * A lossless consumer reads every frame and holds the producer back when it must. Another one
 * reads the newest, skips the rest, and never holds the producer back: the slot it is reading is
 * exchanged for a spare one. A lossless consumer may have several frames before it gives the oldest
 * of them back, half of the slots at most; columns of bodies of neighbouring slots are one block
 * (rb_frame_init_all), unless a spare has come between.
 *
 * Owned by whoever created it, who adds the consumers before the first frame is acquired (a
 * lossless one between frames too: it sees those that follow) and destroys it after all of them
 * have ended. acquire, publish and close belong to the producer's thread; wait, give_back and
 * detach to the thread of that consumer; abort to anybody.
 */
#ifndef RB_FLOW_RING_H
#define RB_FLOW_RING_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/frame.h>
#include <rbsim/model.h>

struct rb_ring;

enum { RB_RING_CONSUMERS_MAX = 32, RB_RING_SLOTS_MIN = 4, RB_RING_SLOTS_MAX = 32 };

/* How many slots a ring of such frames gets: 4 to 32, as many as fit into 4 MiB. */
int rb_ring_slots_for(const struct rb_model *model, unsigned fields);

/* `slot_count` 0: rb_ring_slots_for. Fails on memory only. */
RB_CHECKED enum rb_status rb_ring_create(struct rb_ring **ring, const struct rb_model *model,
                                         unsigned fields, int slot_count, struct rb_error *err);
void rb_ring_destroy(struct rb_ring *ring); /* NULL is fine */

/*
 * Number of the new consumer in `*consumer`. Fails on memory only; more than RB_RING_CONSUMERS_MAX
 * is a bug.
 */
RB_CHECKED enum rb_status rb_ring_add_consumer(struct rb_ring *ring, bool lossless, int *consumer,
                                               struct rb_error *err);

/*
 * A slot to fill; waits until there is one. NULL when the ring was aborted. Asking twice gives the
 * same slot.
 */
struct rb_frame *rb_ring_acquire(struct rb_ring *ring);
/* Hands the acquired slot to the consumers. */
void rb_ring_publish(struct rb_ring *ring);
/* How many frames a lossless consumer may have at once. */
int rb_ring_keep_most(const struct rb_ring *ring);
/* Frames that were published and that some lossless consumer still needs. Any thread. */
int rb_ring_used(struct rb_ring *ring, int *slot_count);
/*
 * Who a consumer is; borrowed while there is the ring. And who the producer would wait for now;
 * NULL: nobody. Any thread.
 */
void rb_ring_name(struct rb_ring *ring, int consumer, const char *name);
const char *rb_ring_awaited(struct rb_ring *ring);
/* No frame will follow: consumers read what is there and are then told so. */
void rb_ring_close(struct rb_ring *ring);
/* Stops both sides at once: what is unread stays unread. */
void rb_ring_abort(struct rb_ring *ring);

enum rb_ring_news { RB_RING_FRAME, RB_RING_IDLE, RB_RING_CLOSED };

/*
 * Waits `timeout_s` at most. RB_RING_FRAME: `*frame` is the consumer's to read until it gives it
 * back.
 */
enum rb_ring_news rb_ring_wait(struct rb_ring *ring, int consumer, double timeout_s,
                               const struct rb_frame **frame);
void rb_ring_give_back(struct rb_ring *ring, int consumer); /* the oldest that it has */
/* The consumer reads no more: nobody waits for it from now on. */
void rb_ring_detach(struct rb_ring *ring, int consumer);

#endif
