/* SPDX-License-Identifier: MIT */
/*
 * Decimals are kept as integers times a power of ten, never as doubles: the k-th value of a
 * progression is first + k * step exactly, and is written back as the shortest decimal text, so
 * that recordings, labels and file comparisons show 0.3 and not 0.30000000000000004. All three
 * numbers of a range are brought to the smallest of their exponents; where that overflows 64 bits
 * the range is refused.
 */
#include "sweep/axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/memory.h"

/*
 * DIGITS_MAX: any 18 decimal digits fit into int64_t. EXPONENT_MAX: beyond the range of double
 * (1e-324 to 1e308), with room for the digits.
 */
enum { DIGITS_MAX = 18, EXPONENT_MAX = 400 };

/* digits * 10^exponent */
struct decimal {
	int64_t digits;
	int exponent;
};

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

/* "e-3", with its length; false: no exponent, or one that is out of reach. */
static bool take_exponent(const char *text, int *exponent)
{
	const bool minus = text[1] == '-';
	const char *at = text + 1 + (text[1] == '-' || text[1] == '+');
	int value = 0;

	if (!is_digit(*at))
		return false;
	for (; is_digit(*at) && value <= EXPONENT_MAX; at++)
		value = 10 * value + (*at - '0');
	*exponent += minus ? -value : value;
	return *at == '\0' && value <= EXPONENT_MAX;
}

/*
 * Reads a whole text that is a decimal number of at most DIGITS_MAX digits, without trailing zeros:
 * two equal numbers become equal structs. False: it is not one.
 */
static bool read_decimal(const char *text, struct decimal *out)
{
	const bool minus = *text == '-';
	bool point = false, any = false;
	int digits = 0;

	*out = (struct decimal){0};
	for (text += *text == '-' || *text == '+'; is_digit(*text) || (*text == '.' && !point);
	     text++) {
		point = point || *text == '.';
		if (*text == '.')
			continue;
		any = true;
		digits += out->digits > 0 || *text != '0';
		if (digits > DIGITS_MAX)
			return false;
		out->digits = 10 * out->digits + (*text - '0');
		out->exponent -= point;
	}
	if (!any ||
	    (*text && ((*text != 'e' && *text != 'E') || !take_exponent(text, &out->exponent))))
		return false;
	while (out->digits != 0 && out->digits % 10 == 0) {
		out->digits /= 10;
		out->exponent++;
	}
	if (out->digits == 0)
		out->exponent = EXPONENT_MAX; /* any will do */
	if (minus)
		out->digits = -out->digits;
	return true;
}

/* Brings a number to a smaller exponent. False: the digits do not fit 64 bits. */
static bool scale_to(struct decimal *number, int exponent)
{
	RB_ASSERT(exponent <= number->exponent || number->digits == 0);
	for (; number->exponent > exponent && number->digits != 0; number->exponent--)
		if (__builtin_mul_overflow(number->digits, 10, &number->digits))
			return false;
	number->exponent = exponent;
	return true;
}

static int smaller(int a, int b)
{
	return a < b ? a : b;
}

/*
 * Makes a progression of low, high, step. Counted by integer division of exact numbers, so that
 * `high` is included whenever it is low plus a multiple of step.
 */
static enum rb_status take_range(struct rb_axis_piece *piece, const struct rb_axis *axis,
                                 const char *const part[3], struct rb_error *err)
{
	struct decimal low, high, step;
	int64_t span;

	if (!read_decimal(part[0], &low) || !read_decimal(part[1], &high) ||
	    !read_decimal(part[2], &step))
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--param': '%s' has a range with a number of more than %d digits",
			axis->text, DIGITS_MAX);
	/*
	 * compared as doubles, which is exact enough for the direction and needs no common exponent
	 */
	const bool rises = strtod(part[1], NULL) >= strtod(part[0], NULL);
	const bool falls = strtod(part[1], NULL) <= strtod(part[0], NULL);
	if (step.digits == 0 || (step.digits > 0 ? !rises : !falls))
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--param': '%s': a step of %s does not lead from %s to %s",
		               axis->text, part[2], part[0], part[1]);
	const int exponent = smaller(smaller(low.exponent, high.exponent), step.exponent);
	if (!scale_to(&low, exponent) || !scale_to(&high, exponent) || !scale_to(&step, exponent) ||
	    __builtin_sub_overflow(high.digits, low.digits, &span))
		return RB_FAIL(
			err, RB_ERR_USAGE,
			"option '--param': '%s': from %s to %s in steps of %s is too long a way",
			axis->text, part[0], part[1], part[2]);
	/* span and step have the same sign here: the quotient is not negative */
	RB_ASSERT(span / step.digits >= 0);
	*piece = (struct rb_axis_piece){.count = (uint64_t)(span / step.digits) + 1,
	                                .first = low.digits,
	                                .step = step.digits,
	                                .exponent = exponent};
	return RB_OK;
}

/* A text that strtod takes whole, finite, and that begins like a number. */
static bool is_number(const char *text)
{
	char *end;

	if (!is_digit(*text) && !strchr("+-.", *text))
		return false;
	const double value = strtod(text, &end);
	return end != text && *end == '\0' && isfinite(value);
}

/*
 * Cuts "a:b:c" at its colons where all parts are numbers; gives how many, 0 where it is no range.
 */
static int cut_range(char *text, const char *part[3])
{
	char *colon[3] = {NULL};
	int count = 0;

	for (char *at = strchr(text, ':'); at && count < 3; at = strchr(at + 1, ':'))
		colon[count++] = at;
	if (count == 0 || count > 2)
		return 0;
	part[0] = text;
	for (int i = 0; i < count; i++) {
		*colon[i] = '\0';
		part[i + 1] = colon[i] + 1;
	}
	bool right = true;
	for (int i = 0; i <= count; i++)
		right = right && *part[i] && is_number(part[i]);
	for (int i = 0; i < count && !right; i++)
		*colon[i] = ':';
	return right ? count + 1 : 0;
}

/*
 * Makes a piece of one text between two commas; `alone`: it is the only one, where it may be empty
 * or a range without a step.
 */
static enum rb_status take_piece(struct rb_axis *axis, char *text, bool alone, struct rb_error *err)
{
	struct rb_axis_piece *const piece = &axis->pieces[axis->piece_count++];
	const char *part[3];
	const int parts = cut_range(text, part);

	if (*text == '\0' && !alone)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--param': '%s' has an empty value in its list", axis->text);
	if (parts == 3)
		return take_range(piece, axis, part, err);
	*piece = (struct rb_axis_piece){.count = 1, .text = text};
	if (parts == 0) {
		if (strlen(text) + 1 > axis->room)
			axis->room = strlen(text) + 1;
		return RB_OK;
	}
	axis->low = strtod(part[0], NULL);
	axis->high = strtod(part[1], NULL);
	if (!alone)
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--param': '%s' has a range without a step in a list "
		               "(wanted: low:high:step)",
		               axis->text);
	if (!(axis->low < axis->high) || !isfinite(axis->high - axis->low))
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--param': '%s': the range must rise (got %s and %s)",
		               axis->text, part[0], part[1]);
	piece->count = 0;
	return RB_OK;
}

/*
 * Cuts the values at their commas. More than `most` are refused before anything is allocated for
 * them.
 */
static enum rb_status take_values(struct rb_axis *axis, uint64_t most, struct rb_error *err)
{
	const bool alone = !strchr(axis->values, ',');

	for (char *at = axis->values, *next; at; at = next) {
		next = strchr(at, ',');
		if (next)
			*next++ = '\0';
		const enum rb_status status = take_piece(axis, at, alone, err);
		if (status)
			return status;
		const uint64_t count = axis->pieces[axis->piece_count - 1].count;
		/* the first comparison keeps the sum from wrapping */
		if (count > most || axis->count + count > most)
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--param': '%s' has more than %llu values",
			               axis->text, (unsigned long long)most);
		axis->count += count;
	}
	return RB_OK;
}

enum rb_status rb_axis_init(struct rb_axis *axis, const char *text, uint64_t most,
                            struct rb_error *err)
{
	const size_t name = strcspn(text, "=");
	size_t commas = 0;

	*axis = (struct rb_axis){.room = RB_AXIS_NUMBER_SIZE};
	if (name == 0 || text[name] != '=')
		return RB_FAIL(err, RB_ERR_USAGE,
		               "option '--param': '%s' is not of the form NAME=VALUES", text);
	for (const char *c = text; *c; c++) {
		if ((unsigned char)*c < ' ')
			return RB_FAIL(err, RB_ERR_USAGE,
			               "option '--param': a value of '%.*s' holds a line break or "
			               "another control character",
			               (int)name, text);
		commas += *c == ',';
	}
	axis->text = rb_memory_copy_text(text);
	axis->name = rb_memory_copy_text(text);
	axis->values = rb_memory_copy_text(text + name + 1);
	axis->pieces = rb_memory_take(commas + 1, sizeof *axis->pieces);
	if (!axis->text || !axis->name || !axis->values || !axis->pieces)
		return RB_FAIL(err, RB_ERR_MEMORY, "cannot keep '%s': out of memory", text);
	axis->name[name] = '\0';
	return take_values(axis, most, err);
}

void rb_axis_release(struct rb_axis *axis)
{
	rb_memory_free(axis->text);
	rb_memory_free(axis->name);
	rb_memory_free(axis->values);
	rb_memory_free(axis->pieces);
	*axis = (struct rb_axis){0};
}

/* ---- values as texts ---- */

/*
 * digits * 10^exponent without an exponent where that takes no more than DIGITS_MAX characters,
 * else as 12e-30. Fits RB_AXIS_NUMBER_SIZE: sign, 19 digits, point, 18 zeros.
 */
static const char *decimal_text(int64_t digits, int exponent, char out[RB_AXIS_NUMBER_SIZE])
{
	char plain[24];

	while (digits != 0 && digits % 10 == 0 && exponent < 0) {
		digits /= 10;
		exponent++;
	}
	if (digits == 0)
		return strcpy(out, "0");
	const char *const sign = digits < 0 ? "-" : "";
	const int count = snprintf(plain, sizeof plain, "%lld", llabs(digits));
	if (exponent == 0)
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s%s", sign, plain);
	else if (exponent > 0 && count + exponent <= DIGITS_MAX)
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s%s%0*d", sign, plain, exponent, 0);
	else if (exponent > 0 || exponent < -DIGITS_MAX)
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s%se%d", sign, plain, exponent);
	else if (count > -exponent)
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s%.*s.%s", sign, count + exponent, plain,
		         plain + count + exponent);
	else if (count == -exponent)
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s0.%s", sign, plain);
	else
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%s0.%0*d%s", sign, -exponent - count, 0, plain);
	return out;
}

const char *rb_axis_value(const struct rb_axis *axis, uint64_t k, char out[RB_AXIS_NUMBER_SIZE])
{
	const struct rb_axis_piece *piece = axis->pieces;

	RB_ASSERT(k < axis->count);
	for (; k >= piece->count; piece++)
		k -= piece->count;
	if (piece->text)
		return piece->text;
	return decimal_text(piece->first + (int64_t)k * piece->step, piece->exponent, out);
}

const char *rb_axis_at(const struct rb_axis *axis, double unit, char out[RB_AXIS_NUMBER_SIZE])
{
	RB_ASSERT(unit >= 0 && unit <= 1);
	if (axis->count > 0) {
		/* rounding of the product may give count itself */
		uint64_t k = (uint64_t)(unit * (double)axis->count);
		return rb_axis_value(axis, k < axis->count ? k : axis->count - 1, out);
	}
	const double value = axis->low + unit * (axis->high - axis->low);
	for (int digits = 15; digits <= 17; digits++) {
		snprintf(out, RB_AXIS_NUMBER_SIZE, "%.*g", digits, value);
		if (strtod(out, NULL) == value)
			break;
	}
	return out;
}
