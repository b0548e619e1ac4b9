/* A simply supported rectangular plate, in closed form: its vibrations (Navier) and its static deflection.
 *
 *     phi = sin(i pi x/a) sin(j pi y/b),   modal mass = mass a b/4,
 *     omega^2 = (pi^4 (D11 i^4/a^4 + 2 mixed i^2 j^2/(a b)^2 + D22 j^4/b^4) + bed)/mass
 *
 * mixed = D12 + 2 D66 > -sqrt(D11 D22). Units: any consistent ones. */
#ifndef FILM_PLATE_H
#define FILM_PLATE_H

#include "film_core.h"

typedef struct {
    double a, b;               /* sides */
    double mass;               /* per area */
    double d11, mixed, d22;    /* bending stiffnesses */
    double bed;                /* stiffness of an elastic bed per area */
} film_plate;

/* A bound on the number of modes up to a frequency. */
FILM_API double film_plate_most(const film_plate *plate, double highest);

/* The modes up to a frequency without a node at the first point, i by i; how many there are, of which `room` are written, or
 * FILM_BAD_NUMBER if these may be more than FILM_MOST_MODES. at: x, y and the orders of the derivatives in both, of each of
 * `points` >= 1 points. shapes: phi at the points of each mode. */
FILM_API int64_t film_plate_modes(const film_plate *plate, double highest, int32_t points, const double *at, int64_t room,
                                  double *frequency, double *shapes);

/* Static deflection over force at a point of a plate without bed. */
FILM_API double film_plate_compliance(const film_plate *plate, double x, double y);

#endif
