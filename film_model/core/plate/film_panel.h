/* A rectangular plate with any edges: the energy of Ritz's products f_p(x) g_q(y), and its static deflection.
 *
 *     1/2 of the integral of D11 w_xx^2 + 2 D12 w_xx w_yy + D22 w_yy^2 + 4 D66 w_xy^2 + bed w^2, and of springs along the edges
 *
 * film_model/targets/ritz.py derives it. Units: any consistent ones. */
#ifndef FILM_PANEL_H
#define FILM_PANEL_H

#include "plate/film_ritz.h"

typedef struct {
    double mass; /* per area */
    double d11, d12, d22, d66;
    double a, b;       /* sides, along x and y */
    double springs[4]; /* stiffness per length of the edges at x = 0, x = a, y = 0, y = b */
    double bed;        /* stiffness per area */
    int32_t edges[4];
} film_panel;

/* Half-waves along x (0) or y (1) up to a frequency. */
FILM_API double film_panel_waves(const film_panel *panel, int32_t along, double highest);

/* Degree of the polynomials along y that resolve the vibrations of half-waves with the wave number `wave` along x. spare: beyond
 * what waves and decay need. */
FILM_API int32_t film_panel_degree(const film_panel *panel, double wave, double highest, double spare);

/* Groups of products that do not interact, and the products p, q of one that vibrations up to a frequency need (infinite: all); how
 * many these are. sharpness: of their own frequencies, the highest over that. least: so many functions of each side are taken
 * however high. */
FILM_API int32_t film_panel_groups(const film_panel *panel, const film_ritz *x, const film_ritz *y);
FILM_API int32_t film_panel_group(const film_panel *panel, const film_ritz *x, const film_ritz *y, double highest, double sharpness,
                                  int32_t least, int32_t group, int32_t *p, int32_t *q);

/* The matrix of the energy of n products, orthonormal in the integral of w^2: n x n. */
FILM_API void film_panel_energy(const film_panel *panel, const film_ritz *x, const film_ritz *y, int32_t n, const int32_t *p,
                                const int32_t *q, double *energy);

/* Static deflection over force at a point, where the edges at x = 0 and a are any and those at y = 0 and b simply supported. */
FILM_API double film_panel_levy(const film_panel *panel, double x, double y);

#endif
