/* Friction in any contact, by springs beside each other that slip: for laws that yield or are damped, in steps.
 *
 * Springs at radii r share the tangential stiffness 8 G_star a and the normal force like those of Popov's reduction of a
 * sphere, p(r) ~ 1 - r^2/a^2. Errors fall faster than one over the number of steps. Units: any consistent ones.
 * Nothing is allocated; copying a film_springs saves it. */
#ifndef FILM_SPRINGS_H
#define FILM_SPRINGS_H

#include "film_core.h"

enum { FILM_MOST_SPRINGS = 256 }; /* most springs */

/* stiffness: of one spring. width: distance of the springs. mass: m_t. v: sliding velocity, also where nothing touches.
 * q: friction force. push: acceleration by what else acts. radius: of the contact, now. u: deflections. cut: if watched is 1, how
 * many springs slipped in the last step, negative if against their direction at first. */
typedef struct {
    double stiffness, width, friction, mass, v, q, push, radius;
    double u[FILM_MOST_SPRINGS];
    int32_t count, reserved, watched, cut;
} film_springs;

/* Springs up to the radius `largest`, that do not touch; a step to a larger one doubles their distance. modulus: G_star. count: 1 to FILM_MOST_SPRINGS. FILM_OK, or
 * FILM_BAD_NUMBER: a count out of range, or a number that is not finite, or not > 0; friction may be 0, the velocity any. */
FILM_API int film_springs_init(film_springs *state, int32_t count, double modulus, double largest, double friction, double mass,
                               double velocity);

/* Forward by a time >= 0, at the end of which the contact has this normal force and radius; both 0 without contact. The
 * rule of the midpoint: half a step with the friction force before, half with that after. */
FILM_API void film_springs_step(film_springs *state, double time, double force, double radius);

/* A coefficient of friction over the sliding speed: `rows` pairs (speed, coefficient) of increasing speed, with lines between and
 * constant beyond; one pair for a constant one. */
FILM_API double film_friction_at(const double *table, int32_t rows, double speed);

/* The coefficient of the next step: that at the speed which the present friction force leads to, with an error of its square. */
FILM_API void film_springs_take(film_springs *state, double time, const double *table, int32_t rows);

/* One impact: velocity at the end; force, step: largest |q|, and after how many steps; apart: largest difference of the velocity, at
 * any time, to that of half as many springs in half as many steps; slack: what the friction force lacks to its limit, a share of the
 * impulses; 0 if the contact slides throughout. */
typedef struct {
    double velocity, force, apart, slack;
    int64_t step;
} film_springs_impact_result;

/* An impact from first touch on in steps of a time; force, radius: before the first step and after each. friction, rows: as above.
 * steps: even. count: of springs, even. velocities, forces: room for the sliding velocity and friction force at the times of `force`,
 * or null. FILM_OK or FILM_BAD_NUMBER as film_springs_init. */
FILM_API int film_springs_impact(int32_t count, double modulus, double mass, double velocity, const double *friction, int32_t rows,
                                 double time, int64_t steps, const double *force, const double *radius,
                                 film_springs_impact_result *result, double *velocities, double *forces);

/* How many springs touch. */
FILM_API int32_t film_springs_touching(const film_springs *state);

/* Energy of the springs. */
FILM_API double film_springs_energy(const film_springs *state);

/* Contact radii of a contact that yields, at recorded forces and depths: in loading those of its law, and of an elastic contact with
 * the slope of its force, F' = 2 modulus a; in unloading both shrink from the law's at the turn, as a ball's in its dent. modulus:
 * E_star. law: radii of the law, not finite if unknown; read up to the turn only. */
FILM_API void film_springs_radii(int64_t count, const double *force, const double *depth, const double *law, double modulus,
                                 double *first, double *second);

/* sizeof film_springs. */
FILM_API int64_t film_springs_size(void);

#endif
