/* Parts of film_friction.h that its files share. */
#ifndef FILM_FRICTION_PARTS_H
#define FILM_FRICTION_PARTS_H

#include "oblique/film_friction.h"

enum { FILM_TERMS = FILM_FRICTION_ORDER + 1 };
enum { FILM_STUCK, FILM_STRAIGHT }; /* kinds of pieces of the path */

/* The motion at one time: z, nu, D, D' and q, or P in slip; c and, on a stuck piece, nu and D' when it was recorded. */
typedef struct {
    double time, z, nu, D, v, q, P, c, nu_c, v_c;
} film_moment;

/* What holds in a phase. kind: FILM_STICKS, FILM_SLIPS or FILM_SLIDES. piece: on which c is, FILM_STUCK or FILM_STRAIGHT.
 * normal: with an approach of 1, and a depth of about 1. flat: 1 if slip begins with w' = 0; edge: 1 if U = 0 too, where
 * stick has ended (film_friction_step.c). coarse: of film_friction.h. */
typedef struct {
    film_normal normal;
    double rate, sign;
    int kind, piece, flat, edge, coarse;
} film_phase_rule;

/* Taylor series from the beginning of a step, in powers of time or of a clock; `speed` is z', `way` is w'. */
typedef struct {
    double time[FILM_TERMS], root[FILM_TERMS]; /* root: sqrt(z) under a clock, without which contact ends at a double root */
    double z[FILM_TERMS], nu[FILM_TERMS], D[FILM_TERMS], v[FILM_TERMS], q[FILM_TERMS];
    double P[FILM_TERMS], c[FILM_TERMS], nu_c[FILM_TERMS], v_c[FILM_TERMS];
    double f[FILM_TERMS], speed[FILM_TERMS], way[FILM_TERMS];
} film_taylor;

/* 1: numbers in range. */
int film_friction_sound(const film_normal *normal, double rate, double velocity);

/* The depth at which about all work of the approach is done; all of it under one power. */
double film_friction_depth(const film_normal *normal);

/* The force and its slope at a depth. */
double film_friction_force(const film_normal *normal, double z, double *slope);

/* The work of the law up to a depth. */
double film_friction_work(const film_normal *normal, double z);

/* z, nu, D, D' and q at a small depth after first touch, by the first terms in powers of time. part: dD/dz there. */
film_moment film_friction_touched(const film_phase_rule *rule, double part, double depth, double velocity);

/* The depth up to which the terms that it leaves out are below `rounding`. */
double film_friction_first(const film_normal *normal, double rounding);

/* The series from a moment; after first touch, at z > 0. */
void film_friction_series(const film_phase_rule *rule, const film_moment *at, film_taylor *series);

/* The longest step whose last terms are below the tolerance. scale: of D'. */
double film_friction_length(const film_phase_rule *rule, const film_taylor *series, double scale);

/* Sliding in closed form to where it ends, at z = 0 or where w' = 0, for quick solutions under one power alone: friction takes rate times
 * the normal impulse. turn: when z is largest, if that is between; else 0. 1: w' = 0; 0: contact ends; -1: not known. */
int film_friction_slide(const film_phase_rule *rule, film_moment *now, double *turn);

/* Powers of a time, or clock, in a step: sums with a series are its value and its slope there. */
typedef struct {
    double t, value[FILM_TERMS], slope[FILM_TERMS];
} film_powers;

void film_friction_powers(double t, film_powers *powers);
double film_friction_sum(const double *series, const double *powers);

/* The first time up to that of `end` at which a series that is positive before falls to 0; more if there is none. */
double film_friction_root(const double *series, const film_powers *end);

#endif
