/* A simply supported rectangular plate, in closed form: its vibrations and its static deflection under a force at x, y.
 *
 *     w = sin(i pi x/a) sin(j pi y/b),   psi = turn grad w/k,   k^2 = pi^2 (i^2/a^2 + j^2/b^2),
 *     modal mass = (mass + inertia turn^2) a b/4,   inertia = mass thickness^2/12
 *
 * Kirchhoff (Navier): turn = k, thickness = softness = bulge = 0, mixed = D12 + 2 D66 > -sqrt(D11 D22),
 *     mass omega^2 = pi^4 (D11 i^4/a^4 + 2 mixed i^2 j^2/(a b)^2 + D22 j^4/b^4) + bed
 * Mindlin, with shear and rotary inertia; isotropic, D11 = mixed = D22 = D:
 *     (k^2/softness + bed - mass omega^2) (D k^2 + 1/softness - inertia omega^2) = (k/softness)^2,
 *     turn = k + softness (bed - mass omega^2)/k
 * film_model/targets/thick_plate.py derives it; both faces move by w + bulge div psi. Units: any consistent ones. */
#ifndef FILM_PLATE_H
#define FILM_PLATE_H

#include "film_core.h"

typedef struct {
    double a, b;                       /* sides */
    double x, y;                       /* struck point */
    double mass;                       /* per area */
    double d11, mixed, d22;            /* bending stiffnesses */
    double bed;                        /* stiffness of an elastic bed per area */
    double thickness, softness, bulge; /* of a plate with shear; all 0 without */
} film_plate;

/* Whether shear is known: the plate is not struck within its thickness of an edge, and has waves that are not too short. Without,
 * the functions below have none. */
FILM_API int32_t film_plate_sheared(const film_plate *plate);

/* Frequency of the shortest waves of a plate with shear; infinite without. */
FILM_API double film_plate_highest(const film_plate *plate);

/* A bound on the number of modes up to a frequency. */
FILM_API double film_plate_most(const film_plate *plate, double highest);

/* The modes up to a frequency without a node at the struck point, i by i; how many there are, of which `room` are written, or
 * FILM_BAD_NUMBER if these may be more than FILM_MOST_MODES. at: x, y and the orders of the derivatives in both, of each of
 * `points` more points; those of the second order are curvatures of psi. shapes: of a face there and, before, at the struck point,
 * over the root of the modal mass. */
FILM_API int64_t film_plate_modes(const film_plate *plate, double highest, int32_t points, const double *at, int64_t room,
                                  double *frequency, double *shapes);

/* Static deflection over force of a plate without bed, with shear less that of the contact's half-space. */
FILM_API double film_plate_compliance(const film_plate *plate);

/* Its part of shear under a point force over h^2/(10 pi D), if shear ends at so many thicknesses from there: ln(reach) - 1.054. */
FILM_API double film_plate_around(double reach);

/* The part of shear in that of each of many plates. */
FILM_API void film_plate_shear(int64_t count, const film_plate *plates, double *found);

#endif
