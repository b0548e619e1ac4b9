/* Orthonormal functions on -1 <= s <= 1 for Ritz's method: the shapes of a beam with given ends, made of Legendre
 * polynomials, as film_model/targets/line_functions.py has them. */
#ifndef FILM_RITZ_H
#define FILM_RITZ_H

#include "film_core.h"

enum { FILM_EDGE_SIMPLE = 0, FILM_EDGE_CLAMPED = 1, FILM_EDGE_FREE = 2 }; /* edges */

/* Functions f_p, orthonormal in the integral of f^2 and orthogonal in that of f''^2. bent: that of f_p''^2; sloped: of f_p' f_q';
 * crossed: of f_p'' f_q. Without a series: sines, sin((p + 1) pi (s + 1)/2), as many as are asked for. */
typedef struct {
    int32_t functions, shapes; /* the shapes, and the polynomials that join them */
    int32_t degree;
    int32_t halves;            /* 2: even and odd functions, told by `odd`; 1: the ends differ */
    const double *series;      /* Legendre coefficients, one row of degree + 1 per function */
    const double *bent, *sloped, *crossed;
    const uint8_t *odd;
} film_ritz;

/* Doubles of memory that film_ritz_make takes: those that the line keeps come first, film_ritz_kept of them. */
FILM_API int64_t film_ritz_size(int32_t degree);
FILM_API int64_t film_ritz_kept(int32_t degree);

/* `count` shapes of a beam and the polynomials that join them, in polynomials up to a degree; all of these if count is 0.
 * FILM_BAD_NUMBER if there are not as many. ends: at s = -1 and s = 1. */
FILM_API int32_t film_ritz_make(film_ritz *line, const int32_t *ends, int32_t degree, int32_t count, double *memory);

/* f_p(s) */
FILM_API double film_ritz_at(const film_ritz *line, int32_t p, double s);

#endif
