/* SPDX-License-Identifier: MIT */
#include "sink/h5mark.h"

#include <errno.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/error.h"

/* Places in the superblock of versions 2 and 3 with addresses of 8 bytes. */
enum {
	VERSION_AT = 8,
	OFFSETS_AT = 9,
	LENGTHS_AT = 10,
	FLAGS_AT = 11,
	END_AT = 28,
	SUM_AT = 44,
	SIZE = 48
};
enum { FLAG_WRITE = 1, FLAG_SWMR = 4 };

/* Rotated to the left. */
static uint32_t turned(uint32_t x, int by)
{
	RB_ASSERT(by > 0 && by < 32);
	return x << by | x >> (32 - by);
}

/* Four bytes, little endian. */
static uint32_t word_at(const unsigned char *bytes)
{
	return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 |
	       (uint32_t)bytes[3] << 24;
}

/*
 * lookup3 over the 44 bytes before the sum, as H5_checksum_lookup3: three blocks of twelve bytes,
 * and eight that are left.
 */
static uint32_t checksum(const unsigned char *bytes)
{
	uint32_t a, b, c;

	a = b = c = 0xdeadbeef + SUM_AT;
	for (int block = 0; block < 3; block++, bytes += 12) {
		static const int by[6] = {4, 6, 8, 16, 19, 4};

		a += word_at(bytes);
		b += word_at(bytes + 4);
		c += word_at(bytes + 8);
		for (int k = 0; k < 6; k += 3) {
			a -= c;
			a ^= turned(c, by[k]);
			c += b;
			b -= a;
			b ^= turned(a, by[k + 1]);
			a += c;
			c -= b;
			c ^= turned(b, by[k + 2]);
			b += a;
		}
	}
	a += word_at(bytes);
	b += word_at(bytes + 4);
	static const int last[7] = {14, 11, 25, 16, 4, 14, 24};
	uint32_t *const x[3] = {&a, &b, &c};
	for (int k = 0; k < 7; k++) {
		uint32_t *const to = x[(k + 2) % 3], *const from = x[(k + 1) % 3];

		*to ^= *from;
		*to -= turned(*from, last[k]);
	}
	return c;
}

/* Writes `size` bytes of a value, little endian. */
static void put(unsigned char *to, uint64_t value, int size)
{
	RB_ASSERT(size >= 0 && size <= 8);
	for (int i = 0; i < size; i++)
		to[i] = (unsigned char)(value >> (8 * i));
}

void rb_mark_image(unsigned char *image, size_t size)
{
	RB_ASSERT(size >= SIZE);
	image[FLAGS_AT] = 0;
	put(image + END_AT, size, 8);
	put(image + SUM_AT, checksum(image), 4);
}

enum rb_status rb_mark_clear(int fd, const char *name, bool *was, struct rb_error *err)
{
	static const unsigned char signature[8] = {0x89, 'H', 'D', 'F', '\r', '\n', 0x1a, '\n'};
	unsigned char bytes[SIZE];
	struct stat found;

	*was = false;
	if (pread(fd, bytes, SIZE, 0) != SIZE || memcmp(bytes, signature, sizeof signature) != 0)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' is not an HDF5 file", name);
	if (bytes[VERSION_AT] < 2 || bytes[VERSION_AT] > 3 || bytes[OFFSETS_AT] != 8 ||
	    bytes[LENGTHS_AT] != 8)
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' is not a recording of rbsim", name);
	if (word_at(bytes + SUM_AT) != checksum(bytes))
		return RB_FAIL(err, RB_ERR_INPUT, "'%s' is damaged: its first bytes have changed",
		               name);
	*was = (bytes[FLAGS_AT] & (FLAG_WRITE | FLAG_SWMR)) != 0;
	if (!*was)
		return RB_OK;
	const uint64_t end = word_at(bytes + END_AT) | (uint64_t)word_at(bytes + END_AT + 4) << 32;
	/*
	 * the killed writer may have written behind the mark: what is made next must not overwrite
	 * it
	 */
	if (fstat(fd, &found) == 0 && (uint64_t)found.st_size > end)
		put(bytes + END_AT, (uint64_t)found.st_size, 8);
	bytes[FLAGS_AT] &= (unsigned char)~(FLAG_WRITE | FLAG_SWMR);
	put(bytes + SUM_AT, checksum(bytes), 4);
	if (pwrite(fd, bytes, SIZE, 0) != SIZE)
		return RB_FAIL(err, RB_ERR_IO, "cannot write '%s': %s", name, strerror(errno));
	return RB_OK;
}
