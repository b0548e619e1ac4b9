/* Friction beside a motion that is advanced in steps: springs that slip, for any law that does not pull.
 *
 * The contact radius of the springs is r = f'(xi), the slope of the law's force without damping: 2 E_star times the contact radius,
 * of elastic contacts and of a ball in its dent; where a law yields in loading it is one of two models. Units: those of
 * film_core.h; the displacement over kappa times the unit of length, kappa = E_star/(4 G_star); the friction force, as F, over the
 * unit of force. A spring at r then has the stiffness of its distance to the next, and mass = kappa m_t/m. */
#ifndef FILM_SLIDE_H
#define FILM_SLIDE_H

#include "modal/film_modal.h"
#include "oblique/film_springs.h"

enum { FILM_MOST_SLIDE_STEPS = 400000 }; /* since the caller set `steps` to 0: a second */

/* No pointer: copying it saves it. impulse: of the friction force. work: done on the motion along the surface
 * by that force, what the springs store included. displacement: integral of the sliding velocity. watch: of the phases, its events of the
 * last call and after so much of its time. steps: work since the caller set it to 0, which is limited. unwatched, watched: of
 * film_slide_along, time since it last watched, and the radius then. */
typedef struct {
    double impulse, work, displacement, unwatched, watched;
    film_watch watch;
    int32_t steps, reserved;
    film_springs springs;
} film_sliding;

/* At the start of a motion: mass and velocity as above. FILM_OK or FILM_BAD_NUMBER. */
FILM_API int film_slide_init(film_sliding *sliding, const film_curve *curve, double friction, double mass, double velocity);

/* Between two states of the normal motion, of which only the second may be at an event: FILM_OK, FILM_TOO_MANY steps, or what
 * film_step fails with. friction, rows: as in film_springs.h; 0 rows: that of film_slide_init. */
FILM_API int film_slide(const film_curve *curve, const film_mesh *mesh, const film_state *from, const film_state *to,
                        const double *friction, int32_t rows, film_sliding *sliding);

/* A point of a motion that another integrator follows: nu of the impactor relative to the support; displacement and sliding velocity. */
typedef struct {
    double time, xi, rate, nu, displacement, velocity;
} film_slide_point;

/* The springs alone on the present branch of a state, along the cubics through two points; time does not fall. The impulse and what
 * the velocity follows from are the integrator's. A path of no time only brings the springs to the contact at its end. */
void film_slide_along(const film_curve *curve, const film_state *state, const film_slide_point *from, const film_slide_point *to,
                               const double *friction, int32_t rows, film_sliding *sliding);

/* Both motions forward, the normal one as film_modal_step, to the last bit, and with its status, on a structure whose surface does
 * not move along itself; or FILM_TOO_MANY steps in one of the structure's. dt: in its unit. */
FILM_API int film_slide_on_modes(film_structure *structure, const film_curve *curve, film_modal *state, double *waves, double dt,
                                 const double *friction, int32_t rows, film_sliding *sliding);

/* sizeof film_sliding. */
FILM_API void film_slide_sizes(int64_t sizes[1]);

#endif
