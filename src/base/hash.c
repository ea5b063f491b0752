/* SPDX-License-Identifier: MIT */
#include "base/hash.h"

#include <string.h>

/*
 * Bytes are put together one by one: the same hash on every machine, and a compiler makes one load
 * of it.
 */
static uint32_t little32(const unsigned char *p)
{
	return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static uint64_t little64(const unsigned char *p)
{
	return (uint64_t)little32(p) | (uint64_t)little32(p + 4) << 32;
}

static uint32_t big32(const unsigned char *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | (uint32_t)p[3];
}

/* XXH64, from "xxHash fast digest algorithm", section "XXH64 algorithm description". */
static const uint64_t prime_1 = 0x9e3779b185ebca87u;
static const uint64_t prime_2 = 0xc2b2ae3d27d4eb4fu;
static const uint64_t prime_3 = 0x165667b19e3779f9u;
static const uint64_t prime_4 = 0x85ebca77c2b2ae63u;
static const uint64_t prime_5 = 0x27d4eb2f165667c5u;

static uint64_t rotate_left(uint64_t x, int by)
{
	return x << by | x >> (64 - by);
}

static uint64_t absorb(uint64_t lane, uint64_t input)
{
	return rotate_left(lane + input * prime_2, 31) * prime_1;
}

static uint64_t merge(uint64_t hash, uint64_t lane)
{
	return (hash ^ absorb(0, lane)) * prime_1 + prime_4;
}

uint64_t rb_hash_bytes(const void *bytes, size_t size, uint64_t seed)
{
	const unsigned char *p = bytes;
	size_t left = size;
	uint64_t hash = seed + prime_5;

	/* four lanes over whole stripes of 32 bytes */
	if (left >= 32) {
		uint64_t lane[4] = {seed + prime_1 + prime_2, seed + prime_2, seed, seed - prime_1};
		for (; left >= 32; left -= 32, p += 32)
			for (int i = 0; i < 4; i++)
				lane[i] = absorb(lane[i], little64(p + 8 * i));
		hash = rotate_left(lane[0], 1) + rotate_left(lane[1], 7) +
		       rotate_left(lane[2], 12) + rotate_left(lane[3], 18);
		for (int i = 0; i < 4; i++)
			hash = merge(hash, lane[i]);
	}
	hash += size;

	/* what is left: eights, one four, single bytes */
	for (; left >= 8; left -= 8, p += 8)
		hash = rotate_left(hash ^ absorb(0, little64(p)), 27) * prime_1 + prime_4;
	if (left >= 4) {
		hash = rotate_left(hash ^ little32(p) * prime_1, 23) * prime_2 + prime_3;
		left -= 4;
		p += 4;
	}
	for (; left > 0; left--, p++)
		hash = rotate_left(hash ^ *p * prime_5, 11) * prime_1;

	/* every input bit reaches every output bit */
	hash = (hash ^ hash >> 33) * prime_2;
	hash = (hash ^ hash >> 29) * prime_3;
	return hash ^ hash >> 32;
}

/* SHA-256, FIPS 180-4: constants 4.2.2, initial value 5.3.3, functions 4.1.2, computation 6.2.2. */
static const uint32_t round_constant[64] = {
	0x428a2f98u, 0x71374491u, 0xb5c0fbcfu, 0xe9b5dba5u, 0x3956c25bu, 0x59f111f1u, 0x923f82a4u,
	0xab1c5ed5u, 0xd807aa98u, 0x12835b01u, 0x243185beu, 0x550c7dc3u, 0x72be5d74u, 0x80deb1feu,
	0x9bdc06a7u, 0xc19bf174u, 0xe49b69c1u, 0xefbe4786u, 0x0fc19dc6u, 0x240ca1ccu, 0x2de92c6fu,
	0x4a7484aau, 0x5cb0a9dcu, 0x76f988dau, 0x983e5152u, 0xa831c66du, 0xb00327c8u, 0xbf597fc7u,
	0xc6e00bf3u, 0xd5a79147u, 0x06ca6351u, 0x14292967u, 0x27b70a85u, 0x2e1b2138u, 0x4d2c6dfcu,
	0x53380d13u, 0x650a7354u, 0x766a0abbu, 0x81c2c92eu, 0x92722c85u, 0xa2bfe8a1u, 0xa81a664bu,
	0xc24b8b70u, 0xc76c51a3u, 0xd192e819u, 0xd6990624u, 0xf40e3585u, 0x106aa070u, 0x19a4c116u,
	0x1e376c08u, 0x2748774cu, 0x34b0bcb5u, 0x391c0cb3u, 0x4ed8aa4au, 0x5b9cca4fu, 0x682e6ff3u,
	0x748f82eeu, 0x78a5636fu, 0x84c87814u, 0x8cc70208u, 0x90befffau, 0xa4506cebu, 0xbef9a3f7u,
	0xc67178f2u,
};

static uint32_t rotate_right(uint32_t x, int by)
{
	return x >> by | x << (32 - by);
}

static void sha256_block(uint32_t state[8], const unsigned char *block)
{
	uint32_t w[64], s[8];

	for (int t = 0; t < 16; t++)
		w[t] = big32(block + 4 * t);
	for (int t = 16; t < 64; t++) {
		const uint32_t s0 = rotate_right(w[t - 15], 7) ^ rotate_right(w[t - 15], 18) ^
		                    w[t - 15] >> 3;
		const uint32_t s1 = rotate_right(w[t - 2], 17) ^ rotate_right(w[t - 2], 19) ^
		                    w[t - 2] >> 10;
		w[t] = s1 + w[t - 7] + s0 + w[t - 16];
	}
	memcpy(s, state, sizeof s);
	for (int t = 0; t < 64; t++) {
		const uint32_t sum1 = rotate_right(s[4], 6) ^ rotate_right(s[4], 11) ^
		                      rotate_right(s[4], 25);
		const uint32_t choice = (s[4] & s[5]) ^ (~s[4] & s[6]);
		const uint32_t t1 = s[7] + sum1 + choice + round_constant[t] + w[t];
		const uint32_t sum0 = rotate_right(s[0], 2) ^ rotate_right(s[0], 13) ^
		                      rotate_right(s[0], 22);
		const uint32_t majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
		memmove(s + 1, s, 7 * sizeof *s);
		s[4] += t1;
		s[0] = t1 + sum0 + majority;
	}
	for (int i = 0; i < 8; i++)
		state[i] += s[i];
}

void rb_hash_sha256(const void *bytes, size_t size, char hex[65])
{
	uint32_t state[8] = {0x6a09e667u, 0xbb67ae85u, 0x3c6ef372u, 0xa54ff53au,
	                     0x510e527fu, 0x9b05688cu, 0x1f83d9abu, 0x5be0cd19u};
	const unsigned char *p = bytes;
	size_t left = size;

	for (; left >= 64; left -= 64, p += 64)
		sha256_block(state, p);

	/* the rest, a one bit, zeros, and the length in bits: one block or two (5.1.1) */
	unsigned char tail[128] = {0};
	const size_t tail_size = left < 56 ? 64 : 128;
	if (left > 0)
		memcpy(tail, p, left);
	tail[left] = 0x80;
	const uint64_t bits = (uint64_t)size * 8;
	for (int i = 0; i < 8; i++)
		tail[tail_size - 1 - (size_t)i] = (unsigned char)(bits >> 8 * i);
	for (size_t at = 0; at < tail_size; at += 64)
		sha256_block(state, tail + at);

	for (int i = 0; i < 64; i++)
		hex[i] = "0123456789abcdef"[state[i / 8] >> (28 - i % 8 * 4) & 15];
	hex[64] = '\0';
}
