/* SPDX-License-Identifier: MIT */
/*
 * Frames as lines of text, for the socket's `frame` (rbsim-control(7)).
 *
 *   frame INDEX TIME BODIES COLUMNS NUMBERS... BASE64
 *
 * COLUMNS are letters, p: position, o: orientation, v: velocity, w: angular velocity, "-" without
 * any, in this order those that the frame has; BASE64 holds them one after the other in IEEE 754
 * single precision, little endian, "-" where there is nothing. NUMBERS are the scene's at this
 * frame, in full: kinetic and potential energy, momentum, angular momentum, largest penetration,
 * contacts, collisions, rollbacks, substeps, smallest step, stepped. Every byte that comes in is
 * checked: sizes against the number of bodies, base64, finite values.
 */
#ifndef RB_CONTROL_WIRE_H
#define RB_CONTROL_WIRE_H

#include <stdbool.h>
#include <stddef.h>

#include <rbsim/frame.h>

/*
 * The line without its end; `*text` is grown as needed (rb_memory_reserve) and holds it,
 * NUL-terminated.
 */
RB_CHECKED enum rb_status rb_wire_write_frame(char **text, size_t *capacity, size_t *size,
                                              const struct rb_frame *frame, struct rb_error *err);
/*
 * Into a frame with columns for `body_count` bodies, which is made when it is zeroed; columns that
 * the line lacks are NULL then. RB_ERR_INPUT for a line that is none, which may leave parts of it
 * in the frame.
 */
RB_CHECKED enum rb_status rb_wire_read_frame(struct rb_frame *frame, int body_count,
                                             const char *line, size_t size, struct rb_error *err);

/* Plain base64 (RFC 4648), without line breaks. */
size_t rb_wire_base64_size(size_t bytes);
void rb_wire_base64_write(char *text, const void *bytes, size_t size);
/* False when the text is no base64 of exactly `size` bytes. */
bool rb_wire_base64_read(void *bytes, size_t size, const char *text, size_t text_size);

#endif
