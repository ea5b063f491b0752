/* SPDX-License-Identifier: MIT */
#include "base/pack.h"

#include "base/error.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

void rb_pack_release(struct rb_pack *pack)
{
	if (!pack->loading)
		rb_memory_free(pack->bytes);
	*pack = (struct rb_pack){0};
}

void rb_pack_restart(struct rb_pack *pack)
{
	RB_ASSERT(!pack->loading);
	pack->size = 0;
	pack->failed = pack->no_memory = false;
	pack->why = pack->where = NULL;
}

enum rb_status rb_pack_status(const struct rb_pack *pack, const char *what, struct rb_error *err)
{
	if (!pack->failed)
		return RB_OK;
	if (pack->no_memory)
		return RB_FAIL(err, RB_ERR_MEMORY, "no memory for %s", what);
	if (pack->where)
		return RB_FAIL(err, RB_ERR_INPUT, "%s can't be right: '%s' is %s", what,
		               pack->where, pack->why);
	return RB_FAIL(err, RB_ERR_INPUT, "%s can't be right: %s", what, pack->why);
}

void rb_pack_fail(struct rb_pack *pack, const char *why)
{
	if (pack->failed)
		return;
	pack->failed = true;
	pack->why = why;
}

void rb_pack_fail_at(struct rb_pack *pack, const char *where, const char *why)
{
	if (!pack->failed)
		pack->where = where;
	rb_pack_fail(pack, why);
}

void rb_pack_fail_memory(struct rb_pack *pack)
{
	if (!pack->failed)
		pack->failed = pack->no_memory = true;
}

unsigned char *rb_pack_room(struct rb_pack *pack, size_t size)
{
	unsigned char *room;

	if (pack->loading && !pack->failed && pack->size - pack->at < size)
		rb_pack_fail(pack, "it ends too early");
	if (!pack->loading && !pack->failed && pack->capacity - pack->size < size &&
	    !rb_memory_reserve(&pack->bytes, &pack->capacity, pack->size + size, 1))
		rb_pack_fail_memory(pack);
	if (pack->failed)
		return NULL;
	room = pack->bytes + (pack->loading ? pack->at : pack->size);
	*(pack->loading ? &pack->at : &pack->size) += size;
	return room;
}

static void save(struct rb_pack *pack, const void *bytes, size_t size)
{
	unsigned char *const to = size > 0 ? rb_pack_room(pack, size) : NULL;

	if (to)
		memcpy(to, bytes, size);
}

static void load(struct rb_pack *pack, void *bytes, size_t size)
{
	const unsigned char *const from = size > 0 ? rb_pack_room(pack, size) : NULL;

	if (size == 0)
		return;
	if (from)
		memcpy(bytes, from, size);
	else
		memset(bytes, 0, size);
}

void rb_pack_bytes_slowly(struct rb_pack *pack, void *bytes, size_t size)
{
	if (pack->loading)
		load(pack, bytes, size);
	else
		save(pack, bytes, size);
}

void rb_pack_load_bool(struct rb_pack *pack, bool *value)
{
	unsigned char byte = 0;

	rb_pack_bytes(pack, &byte, 1);
	(void)rb_pack_check(pack, byte <= 1, "neither true nor false");
	*value = byte == 1;
}

void rb_pack_load_int(struct rb_pack *pack, int *value, int low, int high)
{
	int32_t number = 0;

	rb_pack_bytes(pack, &number, sizeof number);
	if (!rb_pack_check(pack, number >= low && number <= high, "a number out of its range"))
		number = low;
	*value = number;
}

void rb_pack_count(struct rb_pack *pack, size_t *value, size_t most, size_t each)
{
	uint64_t number = *value;

	rb_pack_u64(pack, &number);
	const bool fits = number <= most &&
	                  (each == 0 || !pack->loading || number <= (pack->size - pack->at) / each);
	if (!rb_pack_check(pack, fits, "a count that is too large"))
		number = 0;
	*value = (size_t)number;
}

void rb_pack_load_doubles(struct rb_pack *pack, double *value, size_t count)
{
	if (count > SIZE_MAX / sizeof *value)
		rb_pack_fail(pack, "a count that is too large");
	else
		rb_pack_bytes(pack, value, count * sizeof *value);
}

void rb_pack_load_times(struct rb_pack *pack, double *value, size_t count)
{
	bool good = true;

	rb_pack_load_doubles(pack, value, count);
	for (size_t i = 0; !pack->failed && i < count; i++)
		good &= !isnan(value[i]);
	(void)rb_pack_check(pack, good, "not a number");
}

void rb_pack_load_finite(struct rb_pack *pack, double *value, size_t count)
{
	bool good = true;

	rb_pack_load_doubles(pack, value, count);
	for (size_t i = 0; !pack->failed && i < count; i++)
		good &= isfinite(value[i]) != 0;
	(void)rb_pack_check(pack, good, "a number that is not finite");
}
