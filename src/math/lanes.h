/* SPDX-License-Identifier: MIT */
/*
 * Four doubles at a time: vectors of GCC and Clang, in halves where registers are no wider, to the
 * same bits. They go by reference, since how they would be passed by value depends on the
 * processor. Functions are inlined into what is compiled for AVX2 and into its twin for any
 * processor (RB_LANES_AVX2).
 */
#ifndef RB_MATH_LANES_H
#define RB_MATH_LANES_H

#include <math.h>
#include <stdbool.h>

#ifdef __SSE2__
#include <immintrin.h>
#endif

enum { RB_LANES = 4 };
typedef double rb_lanes __attribute__((vector_size(RB_LANES * sizeof(double)), aligned(8)));
typedef long long rb_lanes_mask
	__attribute__((vector_size(RB_LANES * sizeof(long long)), aligned(8)));
#define RB_LANES_INLINE static inline __attribute__((always_inline))

#if defined(__x86_64__) && !defined(__AVX2__)
#define RB_LANES_AVX2 __attribute__((target("avx2,fma")))

/* May functions that are marked so be called? */
static inline bool rb_lanes_avx2(void)
{
	return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
}

/* The same of vectors twice as long. */
#define RB_LANES_AVX512 __attribute__((target("avx512f,avx512dq,avx512vl")))

static inline bool rb_lanes_avx512(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
	       __builtin_cpu_supports("avx512vl");
}
#else
#define RB_LANES_AVX2
#define RB_LANES_AVX512

static inline bool rb_lanes_avx2(void)
{
	return false;
}

static inline bool rb_lanes_avx512(void)
{
	return false;
}
#endif

RB_LANES_INLINE void rb_lanes_root(const rb_lanes *x, rb_lanes *r)
{
#ifdef __SSE2__
	const __m128d low = _mm_sqrt_pd((__m128d){(*x)[0], (*x)[1]});
	const __m128d high = _mm_sqrt_pd((__m128d){(*x)[2], (*x)[3]});

	*r = (rb_lanes){low[0], low[1], high[0], high[1]};
#else
	for (int i = 0; i < RB_LANES; i++)
		(*r)[i] = sqrt((*x)[i]);
#endif
}

/* Sum of the lanes, in their order. */
RB_LANES_INLINE double rb_lanes_sum(const rb_lanes *x)
{
	return (((*x)[0] + (*x)[1]) + (*x)[2]) + (*x)[3];
}

#endif
