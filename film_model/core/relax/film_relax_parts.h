/* What the files of the relaxing contact share. Internal.
 *
 *     film_relax_step.c   one step: the force by collocation, the memory of the way in
 *     film_relax.c        states, events, contacts */
#ifndef FILM_RELAX_PARTS_H
#define FILM_RELAX_PARTS_H

#include "relax/film_relax.h"

/* A step whose force is being sought. */
typedef struct {
    double q[FILM_RELAXATIONS], p[FILM_RELAXATIONS]; /* where the step ends */
    double push;                                     /* the integral of e(t - s) d(xi) since first touch, there */
    double error;                                    /* of the step's impulse */
} film_relax_trial;

/* 0 if the iteration does not settle: the step is too long. match[]: t1 at the nodes, guessed and found, on the way out. */
int film_relax_try(const film_relax *s, const film_relax_step *steps, film_relax_step *to, double h, double match[4],
                   film_relax_trial *trial);

/* The integrals q and p at `tau` of a step. */
void film_relax_memory(const film_relaxation *law, const film_relax_step *step, double tau, int way_in, double *q, double *p);

/* Before a contact begins: what is left of the ones before goes into `old`. */
void film_relax_carry(film_relax *s, const film_relax_step *steps);

/* xi, xi', F, nu and displacement at `tau` of a step, F and xi' by the polynomials. */
void film_relax_at(const film_relax_step *step, double gamma, double tau, double values[5]);

/* F at `tau` of step k at the motion there, as the collocation has it at the nodes. */
double film_relax_force(const film_relax *s, const film_relax_step *steps, int32_t k, double tau);

/* Work done on the indentation up to `tau` of a step; the largest force up to there: the cubic says where. */
double film_relax_work(const film_relax_step *step, double tau);
double film_relax_peak(const film_relax *s, const film_relax_step *steps, int32_t k, double tau);

/* The first u in (from, 1] at which a polynomial of degree 4 in u is 0 or below; 2 if it is not at the end. */
double film_relax_falls(const double *polynomial, double from, double to);

#endif
