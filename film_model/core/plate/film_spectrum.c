/* Symmetric matrices for Ritz's method, by rows, as film_spectrum.h says.
 *
 * The eigenvalues are those of the inverse of matrix + shift, from Cholesky's factor of the matrix with a diagonal of ones: the lowest
 * of the matrix then keep their digits. A reflection turns `struck` into the last axis, Householder's reduction to a tridiagonal
 * matrix leaves that axis alone, and implicit QL steps turn it: its entries are the components (Golub & Welsch 1969). */
#include "plate/film_spectrum.h"

#include <float.h>

#include "plate/film_rows.h"

#define SHIFT 1e-8      /* least shift over the median of the diagonal */
#define ROUNDED 1e-14   /* eigenvalues of the inverse over the largest, below which they are rounding */
#define BLURRED 1e-5    /* largest component, over the norm, that is taken for rounding however close two eigenvalues are */
#define MOST_STEPS 60   /* of QL for an eigenvalue; two to three are usual */

/* The matrix with a diagonal of ones, and its lower factor in place; scale: what divided its rows. */
static int32_t factorise(int32_t n, double *a, double *scale) {
    for (int32_t i = 0; i < n; i++) scale[i] = 1.0 / sqrt(at(a, n, i)[i]);
    for (int32_t i = 0; i < n; i++) {
        double *row = at(a, n, i);
        for (int32_t j = 0; j < i; j++) row[j] = (row[j] * scale[i] * scale[j] - dot(j, row, at(a, n, j))) / at(a, n, j)[j];
        double rest = 1.0 - dot(i, row, row);
        if (!(rest > 0.0)) return FILM_BAD_NUMBER;
        row[i] = sqrt(rest);
    }
    return FILM_OK;
}

/* The lower part of the inverse in place of the factor. */
static void invert(int32_t n, double *a, const double *scale, double *one) {
    for (int32_t i = 0; i < n; i++) {
        double *row = at(a, n, i);
        for (int32_t j = 0; j < i; j++) one[j] = 0.0;
        for (int32_t k = 0; k < i; k++) add(k + 1, one, -row[k], at(a, n, k));
        double last = 1.0 / row[i];
        for (int32_t j = 0; j < i; j++) row[j] = one[j] * last;
        row[i] = last;
    }
    for (int32_t k = 0; k < n; k++) {
        double *row = at(a, n, k);
        for (int32_t j = 0; j <= k; j++) one[j] = row[j];
        for (int32_t j = 0; j <= k; j++) row[j] = 0.0;
        for (int32_t i = 0; i <= k; i++) add(i + 1, at(a, n, i), one[i], one);
    }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j <= i; j++) at(a, n, i)[j] *= scale[i] * scale[j];
}

/* The first m rows and columns between two reflections I - v v', where v v = 2; product: m doubles. */
static void reflect(int32_t n, int32_t m, double *a, const double *v, double *product) {
    for (int32_t j = 0; j < m; j++) {
        const double *row = at(a, n, j);
        product[j] = dot(j, row, v) + row[j] * v[j];
        add(j, product, v[j], row);
    }
    add(m, product, -0.5 * dot(m, v, product), v);
    for (int32_t j = 0; j < m; j++) {
        double *row = at(a, n, j);
        double one = v[j], two = product[j];
        for (int32_t k = 0; k <= j; k++) row[k] -= one * product[k] + two * v[k];
    }
}

/* The vector that turns x, of m entries, into the last axis; returns what it becomes there. 0: x is there. */
static double mirror_of(int32_t m, const double *x, double *v) {
    double size = sqrt(dot(m, x, x)), turned = -copysign(size, x[m - 1]);
    for (int32_t k = 0; k < m; k++) v[k] = x[k];
    v[m - 1] -= turned;
    double length = sqrt(dot(m, v, v));
    for (int32_t k = 0; k < m; k++) v[k] *= length > 0.0 ? sqrt(2.0) / length : 0.0;
    return turned;
}

/* Two rows turned into each other. */
static inline void turn(int32_t width, double *restrict a, double *restrict b, double c, double s) {
    for (int32_t k = 0; k < width; k++) {
        double one = a[k], two = b[k];
        a[k] = c * one - s * two;
        b[k] = s * one + c * two;
    }
}

int32_t film_tridiagonal(int32_t n, double *d, double *e, int32_t width, double *rows) {
    for (int32_t l = 0; l < n; l++) {
        for (int32_t step = 0;; step++) {
            int32_t m = l;
            while (m + 1 < n && fabs(e[m]) > DBL_EPSILON * (fabs(d[m]) + fabs(d[m + 1])) * 0.5) m++;
            if (m == l) break;
            if (step == MOST_STEPS) return FILM_BAD_NUMBER;
            double g = (d[l + 1] - d[l]) / (2.0 * e[l]), r = hypot(g, 1.0), s = 1.0, c = 1.0, p = 0.0;
            g = d[m] - d[l] + e[l] / (g + copysign(r, g));
            int32_t i = m - 1;
            for (; i >= l; i--) {
                double f = s * e[i], b = c * e[i];
                e[i + 1] = r = sqrt(f * f + g * g);
                if (r == 0.0) {
                    d[i + 1] -= p;
                    e[m] = 0.0;
                    break;
                }
                s = f / r;
                c = g / r;
                g = d[i + 1] - p;
                r = (d[i] - g) * s + 2.0 * c * b;
                p = s * r;
                d[i + 1] = g + p;
                g = c * r - b;
                turn(width, at(rows, width, i), at(rows, width, i + 1), c, s);
            }
            if (r == 0.0 && i >= l) continue;
            d[l] -= p;
            e[l] = g;
            e[m] = 0.0;
        }
    }
    return FILM_OK;
}

/* Both by descending values. */
static void sort(int32_t n, double *values, double *with) {
    for (int32_t gap = n / 2; gap > 0; gap /= 2)
        for (int32_t i = gap; i < n; i++) {
            double value = values[i], other = with[i];
            int32_t k = i;
            for (; k >= gap && values[k - gap] < value; k -= gap) values[k] = values[k - gap], with[k] = with[k - gap];
            values[k] = value;
            with[k] = other;
        }
}

int32_t film_spectrum(int32_t n, double *energy, const double *struck, double least, double *memory, double *square,
                      double *seen) {
    double *d = memory, *e = d + n, *v = e + n, *product = v + n, *scale = product + n;
    for (int32_t i = 0; i < n; i++) d[i] = at(energy, n, i)[i], e[i] = 0.0;
    sort(n, d, e);
    double shift = fmax(least, SHIFT * 0.5 * (d[(n - 1) / 2] + d[n / 2]));
    for (int32_t i = 0; i < n; i++) at(energy, n, i)[i] += shift;
    if (factorise(n, energy, scale) != FILM_OK) return FILM_BAD_NUMBER;
    invert(n, energy, scale, v);
    double turned = mirror_of(n, struck, v);
    reflect(n, n, energy, v, product);
    for (int32_t i = n - 1; i > 0; i--) {
        e[i - 1] = mirror_of(i, at(energy, n, i), v);
        reflect(n, i, energy, v, product);
    }
    for (int32_t i = 0; i < n; i++) {
        square[i] = at(energy, n, i)[i];
        seen[i] = i == n - 1 ? turned : 0.0;
    }
    e[n - 1] = 0.0;
    if (film_tridiagonal(n, square, e, 1, seen) != FILM_OK) return FILM_BAD_NUMBER;
    sort(n, square, seen);
    double rounding = DBL_EPSILON * fmax(fabs(square[0]), fabs(square[n - 1]));
    int32_t count = 0;
    for (int32_t i = 0; i < n; i++) {
        double above = i ? square[i - 1] - square[i] : INFINITY, below = i + 1 < n ? square[i] - square[i + 1] : INFINITY;
        d[i] = rounding / fmax(fmin(above, below), rounding / BLURRED) * fabs(turned);
    }
    for (double largest = square[0]; count < n && square[count] > ROUNDED * largest; count++) {
        square[count] = 1.0 / square[count] - shift;
        if (!(fabs(seen[count]) > d[count])) seen[count] = 0.0;
    }
    return count;
}

double film_compliance(int32_t n, double *energy, const double *struck, double *memory) {
    if (factorise(n, energy, memory) != FILM_OK) return NAN;
    double found = 0.0;
    for (int32_t i = 0; i < n; i++) {
        memory[i] = (struck[i] * memory[i] - dot(i, at(energy, n, i), memory)) / at(energy, n, i)[i];
        found += memory[i] * memory[i];
    }
    return found;
}
