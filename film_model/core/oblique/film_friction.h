/* Friction beside the normal motion of a contact that gives back its work: exact between located events.
 *
 *     z' = nu - gamma f(z),  nu' = load - f(z),  f(z) = slope z + coefficient z^exponent,  from z = 0 with nu = approach
 *     D'' = -rate q
 *     stick: q' = f'(z) D'     slip with sign s = 1 or -1 outside the depth c: q = q0(c) + s (f(z) - f(c))
 *
 * Cattaneo, Mindlin, Jaeger and Ciavarella for elastically similar bodies. (D0(c), q0(c)) is the path: where each depth has
 * stuck; c - s D0(c) = w = z - s D. With P = q - s f(z) = q0(c) - s f(c), slip is P' = -s f'(c) w'.
 * Units: z, nu, f and time as in film_core.h; D over (kappa mu) times the unit of length, kappa = E_star/(4 G_star); q over mu
 * times the unit of force; rate = (m/m_t)/kappa. Motions are Taylor series of order FILM_FRICTION_ORDER. */
#ifndef FILM_FRICTION_H
#define FILM_FRICTION_H

#include "film_core.h"

#if !defined(FILM_FRICTION_ORDER) /* film_friction_quick.c defines a lower one */
#define FILM_FRICTION_ORDER 20
#endif

enum {
    FILM_FRICTION_EVENTS = 48,    /* most phases of one impact; elastic impacts have up to seven */
    FILM_FRICTION_STEPS = 1500,   /* most steps of one impact; usual are 20 to 80 */
    FILM_FRICTION_COLUMNS = 6
};

enum { FILM_STICKS, FILM_SLIPS, FILM_REVERSES, FILM_SLIDES }; /* phases: how they begin */
enum { FILM_STICKS_FIRST, FILM_SLIDES_FIRST, FILM_SLIDES_THROUGHOUT }; /* regimes */

/* The normal motion, in units of film_core.h. slope, coefficient >= 0; exponent >= 1; approach > 0. */
typedef struct {
    double slope, coefficient, exponent, approach, gamma, load;
} film_normal;

/* What friction did. velocity: D' when contact ends. force, time_of_force: largest |q|, and when. duration: of the contact.
 * closure: error of the stuck path's first point, retraced, over the smaller of |D'| at first touch and approach: 0 if exact
 * or if nothing is retraced. begins, kinds: of the phases. steps: Taylor steps taken. regime: one of those above. */
typedef struct {
    double velocity, force, time_of_force, duration, closure;
    double begins[FILM_FRICTION_EVENTS];
    int32_t kinds[FILM_FRICTION_EVENTS];
    int32_t phases, steps, regime, reserved;
} film_friction_result;

/* How coarse a solution is: errors up to 1e-8 of a velocity above 0.01 approach, in half the steps, or up to 1e-5. */
enum { FILM_FRICTION_EXACT = 0, FILM_FRICTION_COARSE = 1, FILM_FRICTION_QUICK = 2 };

/* One impact, with D' = velocity at first touch. coarse: one of these. rows: room for `room` rows of time, z, D, D', q
 * and the depth c outside which the contact slips (z if it sticks), `per_step` in each step and the end, or null; *count is their number.
 * FILM_OK; FILM_BAD_NUMBER for numbers out of range; FILM_TOO_MANY events or steps; FILM_FULL: more rows than room. */
FILM_API int film_friction(const film_normal *normal, double rate, double velocity, int coarse, film_friction_result *result,
                           double *rows, int32_t per_step, int32_t room, int32_t *count);

/* The same, faster if it is FILM_FRICTION_QUICK; it may fail where film_friction does not. */
int film_friction_quick(const film_normal *normal, double rate, double velocity, int coarse, film_friction_result *result,
                        double *rows, int32_t per_step, int32_t room, int32_t *count);

/* Of one impact of many. steps: 0 where none was needed. */
typedef struct {
    double velocity, force, time_of_force, closure;
    int32_t status, regime, steps, reserved;
} film_friction_brief;

/* count impacts. coarse: as above. table: of Hertz's law (film_friction_many.c), which holds them unless
 * coarse is FILM_FRICTION_EXACT. */
FILM_API void film_friction_many(int64_t count, const film_normal *normals, const double *rates, const double *velocities,
                                 int coarse, const double *table, film_friction_brief *results);

/* sizeof film_normal, film_friction_result, film_friction_brief. */
FILM_API void film_friction_sizes(int64_t sizes[3]);

#endif
