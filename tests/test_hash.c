/* SPDX-License-Identifier: MIT */
/* src/base/hash.c */
#include "support.h"

#include "base/hash.h"

/* The generator of the xxHash project's own sanity check: its vectors are over these bytes. */
static void fill_as_xxhash_does(unsigned char *bytes, size_t size)
{
	uint64_t generator = 2654435761u;

	for (size_t i = 0; i < size; i++) {
		bytes[i] = (unsigned char)(generator >> 56);
		generator *= 11400714785074694797u;
	}
}

static void xxh64_gives_the_published_values(void **state)
{
	static const struct {
		size_t size;
		uint64_t seed, hash;
	} vectors[] = {
		{0, 0, 0xef46db3751d8e999u},
		{0, 2654435761u, 0xac75fda2929b17efu},
		{1, 0, 0xe934a84adb052768u},
		{1, 2654435761u, 0x5014607643a9b4c3u},
		{4, 0, 0x9136a0dca57457eeu},
		{14, 0, 0x8282dcc4994e35c8u},
		{14, 2654435761u, 0xc3bd6bf63deb6df0u},
		{222, 0, 0xb641ae8cb691c174u},
		{222, 2654435761u, 0x20cb8ab7ae10c14au},
	};
	unsigned char bytes[222];

	(void)state;
	fill_as_xxhash_does(bytes, sizeof bytes);
	for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++)
		assert_true(rb_hash_bytes(bytes, vectors[i].size, vectors[i].seed) ==
		            vectors[i].hash);
	assert_true(rb_hash_bytes("abc", 3, 0) == 0x44bc2cf5ad770999u);
}

static void xxh64_does_not_depend_on_where_the_bytes_stand(void **state)
{
	unsigned char bytes[120], moved[128];

	(void)state;
	fill_as_xxhash_does(bytes, sizeof bytes);
	for (size_t by = 0; by < 8; by++) {
		memcpy(moved + by, bytes, sizeof bytes);
		assert_true(rb_hash_bytes(moved + by, sizeof bytes, 1) ==
		            rb_hash_bytes(bytes, sizeof bytes, 1));
	}
}

static void every_bit_changes_xxh64(void **state)
{
	unsigned char bytes[77];

	(void)state;
	fill_as_xxhash_does(bytes, sizeof bytes);
	const uint64_t before = rb_hash_bytes(bytes, sizeof bytes, 0);
	for (size_t bit = 0; bit < 8 * sizeof bytes; bit++) {
		bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
		assert_true(rb_hash_bytes(bytes, sizeof bytes, 0) != before);
		bytes[bit / 8] ^= (unsigned char)(1u << bit % 8);
	}
}

static void mixing_gives_splitmix64(void **state)
{
	(void)state;
	/* first outputs of splitmix64 from state 0 (Vigna's reference code) */
	assert_true(rb_hash_mix(0x9e3779b97f4a7c15u) == 0xe220a8397b1dcdafu);
	assert_true(rb_hash_mix(2 * 0x9e3779b97f4a7c15u) == 0x6e789e6aa1b965f4u);
}

static void sha256_gives_the_published_values(void **state)
{
	char hex[65];

	(void)state;
	/* FIPS 180-4 examples of NIST's Cryptographic Standards and Guidelines */
	rb_hash_sha256("", 0, hex);
	assert_string_equal(hex,
	                    "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
	rb_hash_sha256("abc", 3, hex);
	assert_string_equal(hex,
	                    "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
	rb_hash_sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56, hex);
	assert_string_equal(hex,
	                    "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");

	char *many = malloc(1000000);
	assert_non_null(many);
	memset(many, 'a', 1000000);
	rb_hash_sha256(many, 1000000, hex);
	assert_string_equal(hex,
	                    "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
	/* one byte below, at and above the place where the length needs a block of its own */
	rb_hash_sha256(many, 55, hex);
	assert_string_equal(hex,
	                    "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
	rb_hash_sha256(many, 56, hex);
	assert_string_equal(hex,
	                    "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
	rb_hash_sha256(many, 64, hex);
	assert_string_equal(hex,
	                    "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
	free(many);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(xxh64_gives_the_published_values),
		cmocka_unit_test(xxh64_does_not_depend_on_where_the_bytes_stand),
		cmocka_unit_test(every_bit_changes_xxh64),
		cmocka_unit_test(mixing_gives_splitmix64),
		cmocka_unit_test(sha256_gives_the_published_values),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
