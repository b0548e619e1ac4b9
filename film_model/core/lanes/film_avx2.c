/* film_lanes.c for processors with AVX2: the same operations on wider registers, so the same bits. */
#include "lanes/film_lanes.h"

#if defined(FILM_WIDE)
#include "march/film_line.h"

#include <string.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define FILM_ROUTINES film_avx2
#include "lanes/film_lanes.c"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
