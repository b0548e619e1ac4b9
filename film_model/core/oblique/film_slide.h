/* Friction beside a motion that is advanced in steps: springs side by side that slip, for any law that does not pull.
 *
 *     D'' = push - mobility q,   q = sum u ds,   u' = D',   |u| <= friction F (3/2) (r^2 - s^2)/r^3   at 0 < s < r
 *
 * r = f'(xi) is the slope of the law's force without damping: 2 E_star times the contact radius, of elastic contacts and of a
 * ball in its dent; where a law yields in loading it is one of two models. Popov's reduction has such springs, and a
 * sphere's share of the force. Units: those of film_core.h; D over kappa times the unit of length, kappa = E_star/(4 G_star); q, as
 * F, over the unit of force; mobility = (m/m_t)/kappa; push: by what else acts along the surface. */
#ifndef FILM_SLIDE_H
#define FILM_SLIDE_H

#include "film_core.h"

enum { FILM_SPRINGS = 256, FILM_MOST_SLIDE_STEPS = 1000000 /* in one call */ };

/* No pointer: copying it saves it. velocity: D'. force: q. impulse: of q. work: of the friction force on D, what the springs
 * store included. slope: r. widest: the largest r for which there are springs; it doubles when r exceeds it. longest: step, > 0. */
typedef struct {
    double friction, mobility, push, longest;
    double velocity, force, impulse, work, slope, widest;
    double deflection[FILM_SPRINGS]; /* u */
} film_sliding;

/* From a state of the normal motion on by dt, in which only its end may be an event: FILM_OK, FILM_TOO_MANY steps, or what
 * film_step fails with. */
FILM_API int film_slide(const film_curve *curve, const film_mesh *mesh, const film_state *from, double dt, film_sliding *sliding);

/* Energy of the springs, in units of `work`. */
FILM_API double film_slide_stored(const film_sliding *sliding);

/* sizeof film_sliding. */
FILM_API int64_t film_slide_size(void);

#endif
