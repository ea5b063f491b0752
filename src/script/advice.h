/* SPDX-License-Identifier: MIT */
/* Words of other programs, and what a scene writes instead. */
#ifndef RB_SCRIPT_ADVICE_H
#define RB_SCRIPT_ADVICE_H

/* What to write instead of a global, or of a key of any call; NULL: nothing is known. */
const char *rb_advice_for_global(const char *name);
const char *rb_advice_for_key(const char *key);
/* What a scene writes for a field that bodies do not have. */
const char *rb_advice_for_field(const char *word);
/* The k-th key that a word may mean, in calls that have such a key; NULL: no more. */
const char *rb_advice_synonym(const char *word, int k);

#endif
