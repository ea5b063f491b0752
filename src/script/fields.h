/* SPDX-License-Identifier: MIT */
/* Checked access to the table of keys that a scene hands to a call; a wrong value leaves the
 * default in its place. */
#ifndef RB_SCRIPT_FIELDS_H
#define RB_SCRIPT_FIELDS_H

#include "script/call.h"

/* Reads every row that has a place into `definition`, notes unknown keys. */
void rb_call_read(struct rb_call *call, void *definition);

bool rb_call_given(const struct rb_call *call, const char *key); /* and right */
bool rb_call_tried(const struct rb_call *call, const char *key); /* right or wrong */

/* Pushes the value of a key, nil where there is none; its type. */
int rb_call_push(const struct rb_call *call, const char *key);

/*
 * Pushes the list at `key`, and returns its length; -1 with nothing pushed when there is none, or a
 * mistake was noted because it is no list.
 */
int rb_call_push_list(struct rb_call *call, const char *key, const char *of, int most);

#endif
