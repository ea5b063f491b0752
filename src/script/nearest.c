/* SPDX-License-Identifier: MIT */
/*
 * The restricted Damerau-Levenshtein distance (optimal string alignment): three rows of the table
 * suffice. Words are near if no more than a third of the letters, and three, are edited; of two
 * letters one, unless it is changed for another, which leaves nothing that tells the word. A common
 * beginning of three letters counts as near too, since abbreviations are the other usual mistake,
 * and so do capitals for small letters.
 */
#include "script/nearest.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "base/error.h"

/*
 * Longer words are not compared: no name of the language is as long, and the time grows with the
 * square.
 */
enum { WORD_MAX = 40 };

static int least(int a, int b)
{
	return a < b ? a : b;
}

/*
 * Edits (insert, delete, change, swap neighbours) of `a` that make `b`; WORD_MAX, which is far
 * apart, for words that are too long.
 */
static int distance_of(const char *a, size_t a_size, const char *b, size_t b_size)
{
	int rows[3][WORD_MAX + 1];
	int *before = rows[0], *above = rows[1], *row = rows[2];
	const int other = a_size <= 2 ? 2 : 1;

	if (a_size > WORD_MAX || b_size > WORD_MAX)
		return WORD_MAX;
	for (int j = 0; j <= (int)b_size; j++) {
		above[j] = j;
		before[j] = 0;
	}
	for (int i = 1; i <= (int)a_size; i++) {
		row[0] = i;
		for (int j = 1; j <= (int)b_size; j++) {
			const int change = above[j - 1] + (a[i - 1] != b[j - 1] ? other : 0);
			row[j] = least(change, least(above[j], row[j - 1]) + 1);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
				row[j] = least(row[j], before[j - 2] + 1);
		}
		int *const turn = before;
		before = above;
		above = row;
		row = turn;
	}
	return above[b_size];
}

struct rb_nearest rb_nearest_to(const char *word)
{
	return (struct rb_nearest){.word = word, .distance = WORD_MAX};
}

void rb_nearest_offer(struct rb_nearest *nearest, const char *candidate, size_t size)
{
	const size_t word_size = strlen(nearest->word);
	int distance = distance_of(nearest->word, word_size, candidate, size);
	const int allowed = word_size == 2 ? 1 : word_size < 9 ? (int)word_size / 3 : 3;

	RB_ASSERT(nearest->word != NULL);
	/* a word cut short, or written out: 'pos', 'angular' */
	const size_t shorter = word_size < size ? word_size : size;
	if (shorter >= 3 && memcmp(nearest->word, candidate, shorter) == 0 && distance > allowed)
		distance = allowed;
	/* other capitals are nothing but a slip of the finger: 'g' for 'G' */
	if (word_size == size && size > 0 && strncasecmp(nearest->word, candidate, size) == 0)
		distance = 0;
	if (distance > allowed || distance > nearest->distance || size >= sizeof nearest->best)
		return;
	/* of two that are as near the first by name, so that the order of offering is of no account
	 */
	if (distance == nearest->distance && nearest->best[0]) {
		const int order = strncmp(candidate, nearest->best, size);
		if (order > 0 || (order == 0 && size >= strlen(nearest->best)))
			return;
	}
	nearest->distance = distance;
	memcpy(nearest->best, candidate, size);
	nearest->best[size] = '\0';
}

const char *rb_nearest_hint(const struct rb_nearest *nearest, char out[96])
{
	RB_ASSERT(strlen(nearest->best) < sizeof nearest->best);
	out[0] = '\0';
	if (nearest->best[0])
		snprintf(out, 96, " (did you mean '%s'?)", nearest->best);
	return out;
}
