/* SPDX-License-Identifier: MIT */
/* Words of other programs and of later versions, and what a scene writes instead. */
#ifndef RB_SCRIPT_ADVICE_H
#define RB_SCRIPT_ADVICE_H

/* What to write instead of a global, or of a key of any call; NULL: nothing is known. */
const char *rb_advice_for_global(const char *name);
const char *rb_advice_for_key(const char *key);

#endif
