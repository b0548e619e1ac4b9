/* film_lanes.c for processors with AVX-512: the same operations on wider registers, so the same bits. */
#include "lanes/film_lanes.h"

#if defined(FILM_WIDE)
#include "march/film_line.h"

#include <string.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")
#endif
#define FILM_ROUTINES film_avx512
#include "lanes/film_lanes.c"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
