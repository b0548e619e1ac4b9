/* film_lanes.c for processors with AVX-512: the same operations on wider registers, so the same bits. */
#if defined(__GNUC__) && defined(__x86_64__)
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl,prefer-vector-width=512"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")
#endif
#define FILM_ROUTINES film_avx512
#include "film_lanes.c"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#else
typedef int film_without_avx512; /* C wants something in every file */
#endif
