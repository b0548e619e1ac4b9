/* film_modal_loops.c for processors with AVX2: the same operations on wider registers, so the same bits. */
#include "modal/film_modal_parts.h"

#if defined(FILM_WIDE)
#include <string.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx2"))), apply_to = function)
#else
#pragma GCC target("avx2")
#endif
#define FILM_LOOPS film_loops_avx2
#define FILM_LANES 4
#include "modal/film_modal_loops.c"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
