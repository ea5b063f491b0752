/* SPDX-License-Identifier: MIT */
/*
 * XXH64 comes from libxxhash, compiled in (most inputs are a few numbers long, for which a call
 * into a shared object costs more than the hash); SHA-256 from libmd.
 */
#include "base/hash.h"

#include <assert.h>

#include <sha2.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "base/error.h"

uint64_t rb_hash_bytes(const void *bytes, size_t size, uint64_t seed)
{
	return XXH64(bytes, size, seed);
}

void rb_hash_sha256(const void *bytes, size_t size, char hex[65])
{
	static_assert(SHA256_DIGEST_STRING_LENGTH == 65, "64 digits and a zero");
	/* libmd refuses a null pointer also where nothing is to be read from it */
	const char *const end = SHA256Data(size > 0 ? bytes : (const void *)"", size, hex);

	RB_ASSERT(end == hex);
}
