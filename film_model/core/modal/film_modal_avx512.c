/* film_modal_loops.c for processors with AVX-512: the same operations on wider registers, so the same bits. */
#include "modal/film_modal_parts.h"

#if defined(FILM_WIDE)
#include <string.h>

#if defined(__clang__)
#pragma clang attribute push(__attribute__((target("avx512f,avx512dq,avx512vl"))), apply_to = function)
#else
#pragma GCC target("avx512f,avx512dq,avx512vl,prefer-vector-width=512")
#endif
#define FILM_LOOPS film_loops_avx512
#define FILM_LANES 8
#include "modal/film_modal_loops.c"
#if defined(__clang__)
#pragma clang attribute pop
#endif
#endif
