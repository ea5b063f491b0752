/* SPDX-License-Identifier: MIT */
/* 64-bit hash over bytes (XXH64, by its published specification) and SHA-256 (FIPS 180-4). */
#ifndef RB_BASE_HASH_H
#define RB_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

uint64_t rb_hash_bytes(const void *bytes, size_t size, uint64_t seed);

/* One 64-bit value well mixed (the finalizer of splitmix64). */
static inline uint64_t rb_hash_mix(uint64_t x)
{
	x ^= x >> 30;
	x *= 0xbf58476d1ce4e5b9u;
	x ^= x >> 27;
	x *= 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

/* Lower-case hexadecimal digits and a terminating zero. */
void rb_hash_sha256(const void *bytes, size_t size, char hex[65]);

#endif
