/* Rows of numbers, for the matrices of Ritz's method. */
#ifndef FILM_ROWS_H
#define FILM_ROWS_H

#include <math.h>
#include <stddef.h>
#include <stdint.h>

/* Row k of a matrix of so many columns. */
static inline double *at(double *rows, int32_t width, int32_t k) { return rows + (ptrdiff_t)k * width; }

/* Four sums, which do not wait for each other. */
static inline double dot(int32_t n, const double *a, const double *b) {
    double one = 0.0, two = 0.0, three = 0.0, four = 0.0;
    int32_t k = 0;
    for (; k + 4 <= n; k += 4) {
        one += a[k] * b[k];
        two += a[k + 1] * b[k + 1];
        three += a[k + 2] * b[k + 2];
        four += a[k + 3] * b[k + 3];
    }
    for (; k < n; k++) one += a[k] * b[k];
    return (one + two) + (three + four);
}

static inline void add(int32_t n, double *restrict a, double scale, const double *restrict b) {
    for (int32_t k = 0; k < n; k++) a[k] += scale * b[k];
}

#endif
