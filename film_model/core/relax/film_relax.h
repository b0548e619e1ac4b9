/* Contact of bodies that relax: Hertz's geometry, a modulus that falls with time under load, and Ting's solution.
 *
 *     nu' = p - F,   xi' = nu - gamma F
 *     way in:   F = integral over 0 .. t of e(t - s) d(xi^1.5)(s)
 *     way out:  the same over 0 .. t1(t), the time at which the contact was as wide as it is now:
 *               integral over t1 .. t of e(t - s) d(xi)(s) = 0.  Contact ends when t1 is 0.
 *     e(t) = rest + sum of share_i exp(-rate_i t),   e(0) = 1
 *
 * Units as in film_core.h, with the law's scales for the instantaneous modulus. Over a step the force is the cubic through
 * its values at four Gauss nodes; motion and relaxation under it are exact. docs/method.md, section 14, derives that.
 * Nothing is allocated: the caller owns the steps of a contact, which are its memory and its record. */
#ifndef FILM_RELAX_H
#define FILM_RELAX_H

#include "film_core.h"

enum {
    FILM_RELAXATIONS = 24,  /* exponentials of e(t) */
    FILM_RELAX_STEPS = 600  /* most steps of one contact */
};

/* e(t): rest > 0 and shares >= 0, which together are 1; rates > 0 in 1/t_s. */
typedef struct {
    int32_t terms, reserved;
    double rest, share[FILM_RELAXATIONS], rate[FILM_RELAXATIONS];
} film_relaxation;

/* A step of a contact; polynomials in u = (t - time)/h, lowest power first. */
typedef struct {
    double time, h, length;        /* length <= h: up to where it is used */
    double xi, nu, shift, load;    /* where it begins */
    double force[4], rate[5];      /* F and xi' */
    double grown[6];               /* xi^1.5, on the way in */
    double q[FILM_RELAXATIONS], p[FILM_RELAXATIONS]; /* integrals of exp(-rate (t - s)) d(xi^1.5) and d(xi), at `time` */
} film_relax_step;

/* The motion at one time; with the steps beside it the whole state. */
typedef struct {
    film_relaxation law;
    double gamma, load, stop_velocity; /* as in film_state */
    double tolerance;                  /* of a step: error of its impulse over the momentum */
    double speed;                      /* to which errors of this contact are relative */
    double time, xi, nu, shift;        /* when the step begins; in flight, when it began */
    double tau, stop_at;               /* time since then; time in the step at which nu falls to stop_velocity */
    double q[FILM_RELAXATIONS], p[FILM_RELAXATIONS]; /* when the step ends */
    double old[FILM_RELAXATIONS];      /* p of the contacts before this one, free since, when it began */
    double next_h;                     /* of the next step */
    double begun, turned;              /* times of first touch and of the turn */
    double match;                      /* t1 where the last step ended */
    double peak, spent;                /* largest F; work done on the indentation, up to the step */
    int32_t approach, steps;           /* steps on the way in, and in all */
    int32_t ends, moving_in, has_step; /* how the step ends: a FILM_... event or 0; 1: above stop_velocity */
    int32_t branch, phase, event, contacts, reserved;
} film_relax;

/* A state at xi <= 0 in front of a body without memory. start: as of film_impact, without damping and limit. */
FILM_API int film_relax_init(film_relax *state, const film_relaxation *law, const film_start *start, double tolerance, double xi);

/* As film_input. */
FILM_API int film_relax_input(film_relax *state, film_relax_step *steps, double load, double nu_change, double stop_velocity);

/* As film_step. steps: room for FILM_RELAX_STEPS. FILM_TURNS_AGAIN: the indentation grows again before contact ends;
 * FILM_REMEMBERS: the next contact begins before the body has forgotten the one before: where film_relax_left is more than
 * FILM_FORGOTTEN of the depth that an elastic contact would have. Less changes its results by at most 0.4 of that part. */
#define FILM_FORGOTTEN 1e-2
FILM_API int film_relax_advance(film_relax *state, film_relax_step *steps, double dt);

/* The five values of film_motion, now. */
FILM_API void film_relax_motion(const film_relax *state, const film_relax_step *steps, double values[5]);

/* Depth in the middle that the surface has not yet recovered from the contacts before, or slightly more; 0 during a contact. */
FILM_API double film_relax_left(const film_relax *state, const film_relax_step *steps);

/* Work done on the indentation since the first contact, up to now. */
FILM_API double film_relax_spent(const film_relax *state, const film_relax_step *steps);

/* One contact, from first touch: as film_impact. State and steps hold its record. */
FILM_API int film_relax_impact(const film_relaxation *law, const film_start *start, double tolerance, film_relax *state,
                               film_relax_step *steps, film_summary *summary);

/* count contacts, one after another; laws[i] in the unit of time of start[i]. */
FILM_API void film_relax_batch(int64_t count, const film_relaxation *laws, const film_start *start, double tolerance,
                               film_relax *state, film_relax_step *steps, film_summary *summary, int32_t *status);

/* As film_sample, for the contact in state and steps and the flight after it. */
FILM_API void film_relax_sample(const film_relax *state, const film_relax_step *steps, const double *times, int64_t count,
                                double *values, int8_t *branches);

/* sizeof film_relaxation, film_relax_step, film_relax. */
FILM_API void film_relax_sizes(int64_t sizes[3]);

#endif
