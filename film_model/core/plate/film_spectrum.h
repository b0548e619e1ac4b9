/* Eigenvalues of a stiffness, and where a vector points among its eigenvectors; static deflections. */
#ifndef FILM_SPECTRUM_H
#define FILM_SPECTRUM_H

#include "film_core.h"

/* Eigenvalues > 0 of a symmetric n x n matrix, ascending, and the components of `struck` along their eigenvectors, 0 where these
 * are rounding; how many there are, or FILM_BAD_NUMBER if the matrix is not positive. least: of the shift that the matrix gets.
 * Overwrites `energy`; memory: 5 n doubles. film_model/targets/ritz.py: spectrum says why by the inverse. */
FILM_API int32_t film_spectrum(int32_t n, double *energy, const double *struck, double least, double *memory, double *square,
                               double *seen);

/* Eigenvalues of a symmetric tridiagonal matrix in place of its diagonal d, in no order; beside: below the diagonal, n doubles. Each
 * column of the n x width `rows` becomes its components along the eigenvectors. FILM_BAD_NUMBER if they are not found. */
FILM_API int32_t film_tridiagonal(int32_t n, double *d, double *beside, int32_t width, double *rows);

/* struck A^-1 struck for a positive symmetric matrix A, which is overwritten; memory: n doubles. NaN if it is not positive. */
FILM_API double film_compliance(int32_t n, double *energy, const double *struck, double *memory);

#endif
