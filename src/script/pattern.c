/* SPDX-License-Identifier: MIT */
/*
 * A backtracking matcher as in Lua's lstrlib.c: a pattern is walked together with the subject, and
 * what can go on in several ways recurses. `steps` bounds the time, which can be exponential in the
 * pattern, DEPTH_MAX the stack. A mistake is sticky: once set, everything returns at once.
 */
#include "script/pattern.h"

#include <ctype.h>
#include <string.h>

#include "base/error.h"

/*
 * DEPTH_MAX: as MAXCCALLS of Lua. PLAIN_STEPS: a fraction of a second, for those who have no
 * budget.
 */
enum { DEPTH_MAX = 200, PLAIN_STEPS = 10000000 };

static const char *match_here(struct rb_match *m, const char *s, const char *p);

/* Notes the first mistake; NULL, for the caller to return. */
static const char *wrong(struct rb_match *m, const char *what)
{
	if (!m->mistake)
		m->mistake = what;
	return NULL;
}

static int byte_at(const char *p)
{
	return (unsigned char)*p;
}

/* Takes steps for a walk along so many bytes; false: they are used up, or the call's time is. */
static bool pay(struct rb_match *m, ptrdiff_t bytes)
{
	RB_ASSERT_COSTLY(bytes >= 0);
	if (m->steps < (uint64_t)bytes || (m->overtime && rb_overtime_is_up(m->overtime))) {
		m->steps = 0;
		wrong(m, "the pattern takes too many steps on this text");
		return false;
	}
	m->steps -= (uint64_t)bytes;
	return true;
}

/* Just behind the single character class that begins at p. */
static const char *class_end(struct rb_match *m, const char *p)
{
	const int first = byte_at(p++);

	if (first == '%') {
		if (p == m->pattern_end)
			return wrong(m, "malformed pattern (ends with '%')");
		return p + 1;
	}
	if (first != '[')
		return p;
	const char *const set = p;
	if (p < m->pattern_end && *p == '^')
		p++;
	/* a ']' in the first place stands for itself */
	do {
		if (p == m->pattern_end)
			return wrong(m, "malformed pattern (missing ']')");
		if (*p++ == '%') {
			if (p == m->pattern_end)
				return wrong(m, "malformed pattern (missing ']')");
			p++;
		}
	} while (p == m->pattern_end || *p != ']');
	return pay(m, p - set) ? p + 1 : NULL;
}

/*
 * Whether a character is in the class %c named by `class`; of an upper-case one, whether it is not.
 */
static bool in_class(int c, int class)
{
	bool in;

	switch (tolower(class)) {
	case 'a':
		in = isalpha(c);
		break;
	case 'c':
		in = iscntrl(c);
		break;
	case 'd':
		in = isdigit(c);
		break;
	case 'g':
		in = isgraph(c);
		break;
	case 'l':
		in = islower(c);
		break;
	case 'p':
		in = ispunct(c);
		break;
	case 's':
		in = isspace(c);
		break;
	case 'u':
		in = isupper(c);
		break;
	case 'w':
		in = isalnum(c);
		break;
	case 'x':
		in = isxdigit(c);
		break;
	default:
		return class == c;
	}
	return isupper(class) ? !in : in;
}

/* Whether a character is in a set; `p` is at its '[', `last` at its ']'. */
static bool in_set(int c, const char *p, const char *last)
{
	const bool inside = p[1] != '^';

	if (!inside)
		p++;
	while (++p < last) {
		if (*p == '%') {
			p++;
			if (in_class(c, byte_at(p)))
				return inside;
		} else if (p[1] == '-' && p + 2 < last) {
			if (byte_at(p) <= c && c <= byte_at(p + 2))
				return inside;
			p += 2;
		} else if (byte_at(p) == c) {
			return inside;
		}
	}
	return !inside;
}

/* Whether the character at s matches the single item from p to `end`. */
static bool single(struct rb_match *m, const char *s, const char *p, const char *end)
{
	if (!pay(m, *p == '[' ? end - p : 1) || s >= m->subject_end)
		return false;
	switch (*p) {
	case '.':
		return true;
	case '%':
		return in_class(byte_at(s), byte_at(p + 1));
	case '[':
		return in_set(byte_at(s), p, end - 1);
	default:
		return *p == *s;
	}
}

/* The end of a balanced text, %bxy with xy at p. */
static const char *match_balance(struct rb_match *m, const char *s, const char *p)
{
	if (m->pattern_end - p < 2)
		return wrong(m, "malformed pattern (missing arguments to '%b')");
	if (s >= m->subject_end || *s != *p)
		return NULL;
	int open = 1;
	for (const char *at = s + 1; at < m->subject_end; at++) {
		if (!pay(m, 1))
			return NULL;
		if (*at == p[1]) {
			if (--open == 0)
				return at + 1;
		} else if (*at == *p) {
			open++;
		}
	}
	return NULL;
}

/* As many repetitions of the item as can be, then fewer until the rest matches. */
static const char *match_most(struct rb_match *m, const char *s, const char *p, const char *end)
{
	ptrdiff_t i = 0;

	while (single(m, s + i, p, end))
		i++;
	for (; i >= 0 && !m->mistake; i--) {
		const char *rest = match_here(m, s + i, end + 1);
		if (rest)
			return rest;
	}
	return NULL;
}

/* As few repetitions of the item as the rest needs. */
static const char *match_least(struct rb_match *m, const char *s, const char *p, const char *end)
{
	for (;; s++) {
		const char *rest = match_here(m, s, end + 1);
		if (rest)
			return rest;
		if (m->mistake || !single(m, s, p, end))
			return NULL;
	}
}

/*
 * Opens a capture at s and matches the rest; `what`: RB_CAPTURE_OPEN or RB_CAPTURE_POSITION. Undone
 * when the rest does not match.
 */
static const char *capture_open(struct rb_match *m, const char *s, const char *p, ptrdiff_t what)
{
	if (m->capture_count >= RB_PATTERN_CAPTURES)
		return wrong(m, "too many captures");
	m->capture[m->capture_count++] = (struct rb_capture){s, what};
	const char *end = match_here(m, s, p);
	if (!end)
		m->capture_count--;
	return end;
}

/* Closes the innermost open capture and matches the rest. */
static const char *capture_close(struct rb_match *m, const char *s, const char *p)
{
	int i = m->capture_count - 1;

	while (i >= 0 && m->capture[i].size != RB_CAPTURE_OPEN)
		i--;
	if (i < 0)
		return wrong(m, "invalid pattern capture");
	m->capture[i].size = s - m->capture[i].start;
	const char *end = match_here(m, s, p);
	if (!end)
		m->capture[i].size = RB_CAPTURE_OPEN;
	return end;
}

/* The end of what equals capture `digit`. */
static const char *match_again(struct rb_match *m, const char *s, int digit)
{
	const int i = digit - '1';

	if (i < 0 || i >= m->capture_count || m->capture[i].size == RB_CAPTURE_OPEN)
		return wrong(m, "invalid capture index");
	const ptrdiff_t size = m->capture[i].size;
	if (size < 0) /* a position matches nothing */
		return NULL;
	if (!pay(m, size))
		return NULL;
	if (m->subject_end - s < size || memcmp(m->capture[i].start, s, (size_t)size) != 0)
		return NULL;
	return s + size;
}

/*
 * %f[set] with the set at p: a border between a character outside of the set and one in it. Behind
 * the set, or NULL.
 */
static const char *frontier(struct rb_match *m, const char *s, const char *p)
{
	if (p == m->pattern_end || *p != '[')
		return wrong(m, "missing '[' after '%f' in pattern");
	const char *end = class_end(m, p);
	if (!end || !pay(m, 2 * (end - p)))
		return NULL;
	const int before = s == m->subject ? 0 : byte_at(s - 1);
	const int here = s < m->subject_end ? byte_at(s) : 0;
	return !in_set(before, p, end - 1) && in_set(here, p, end - 1) ? end : NULL;
}

/* One item with its repetition. NULL with *go: goes on with *s and *p. */
static const char *match_item(struct rb_match *m, const char **s, const char **p, bool *go)
{
	const char *end = class_end(m, *p);

	if (!end)
		return NULL;
	const char repeat = end < m->pattern_end ? *end : '\0';
	switch (repeat) {
	case '?':
		if (single(m, *s, *p, end)) {
			const char *rest = match_here(m, *s + 1, end + 1);
			if (rest || m->mistake)
				return rest;
		}
		*p = end + 1;
		*go = !m->mistake;
		return NULL;
	case '+':
		return single(m, *s, *p, end) ? match_most(m, *s + 1, *p, end) : NULL;
	case '*':
		return match_most(m, *s, *p, end);
	case '-':
		return match_least(m, *s, *p, end);
	default:
		*go = single(m, *s, *p, end);
		*s += 1;
		*p = end;
		return NULL;
	}
}

/* %b, %f or a back reference. NULL with *go: goes on with *s and *p. */
static const char *match_special(struct rb_match *m, const char **s, const char **p, bool *go)
{
	const char what = (*p)[1];

	if (what == 'b') {
		const char *end = match_balance(m, *s, *p + 2);
		*s = end;
		*p += 4;
		*go = end != NULL;
	} else if (what == 'f') {
		const char *end = frontier(m, *s, *p + 2);
		*p = end;
		*go = end != NULL;
	} else {
		const char *end = match_again(m, *s, what);
		*s = end;
		*p += 2;
		*go = end != NULL;
	}
	return NULL;
}

/* Walks along the pattern until it ends or something recurses. The end of the match, or NULL. */
static const char *match_steps(struct rb_match *m, const char *s, const char *p)
{
	for (;;) {
		bool go = false;
		const char *end;

		if (p == m->pattern_end)
			return s;
		if (*p == '(') {
			const bool position = p + 1 < m->pattern_end && p[1] == ')';
			return position ? capture_open(m, s, p + 2, RB_CAPTURE_POSITION)
			                : capture_open(m, s, p + 1, RB_CAPTURE_OPEN);
		}
		if (*p == ')')
			return capture_close(m, s, p + 1);
		if (*p == '$' && p + 1 == m->pattern_end)
			return s == m->subject_end ? s : NULL;
		if (*p == '%' && p + 1 < m->pattern_end &&
		    (p[1] == 'b' || p[1] == 'f' || isdigit(byte_at(p + 1))))
			end = match_special(m, &s, &p, &go);
		else
			end = match_item(m, &s, &p, &go);
		if (!go)
			return end;
	}
}

/* match_steps with the depth counted. */
static const char *match_here(struct rb_match *m, const char *s, const char *p)
{
	RB_ASSERT_COSTLY(m->depth >= 0);
	if (m->depth >= DEPTH_MAX)
		return wrong(m, "pattern too complex");
	if (m->mistake)
		return NULL;
	m->depth++;
	const char *end = match_steps(m, s, p);
	m->depth--;
	return end;
}

void rb_match_start(struct rb_match *match, const char *subject, size_t subject_size,
                    const char *pattern, size_t pattern_size, uint64_t steps)
{
	RB_ASSERT(subject && pattern);
	match->subject = subject;
	match->subject_end = subject + subject_size;
	match->pattern_end = pattern + pattern_size;
	match->steps = steps;
	match->mistake = NULL;
	match->overtime = NULL;
	match->depth = 0;
	match->capture_count = 0;
}

const char *rb_match_at(struct rb_match *match, const char *at, const char *pattern)
{
	match->capture_count = 0;
	match->depth = 0;
	const char *end = match_here(match, at, pattern);
	return match->mistake ? NULL : end;
}

bool rb_pattern_found(const char *text, const char *pattern)
{
	struct rb_match match;
	const size_t size = strlen(text);
	const bool anchored = *pattern == '^';
	const char *first = anchored ? pattern + 1 : pattern;

	rb_match_start(&match, text, size, pattern, strlen(pattern), PLAIN_STEPS);
	for (const char *at = text; at <= text + size; at++) {
		if (rb_match_at(&match, at, first))
			return true;
		if (anchored || match.mistake)
			break;
	}
	return match.mistake && strstr(text, pattern) != NULL;
}
