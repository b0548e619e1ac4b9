/* How many modes of a structure an impact needs: the highest frequency is raised until three runs agree. The caller finds the modes
 * and makes the runs that film_refine asks for: docs/method.md, section 13. */
#ifndef FILM_REFINE_H
#define FILM_REFINE_H

#include "march/film_solve.h"
#include "modal/film_modal.h"

enum {
    FILM_ENOUGH = 0, /* no more: the result is the run up to `highest` */
    FILM_RUN = 1,    /* an impact on the modes up to `highest`, with steps of this `tolerance` */
    FILM_SHARES = 2, /* only the sum of the shares of the modes up to `highest` */
    FILM_SOFTER = 3, /* a run with frequencies that are higher by their errors, and more omitted compliance: by `error` */
    FILM_FEWER = 4,  /* a run with membrane forces of half as many modes */
    FILM_FAILED = 5, /* the run that just failed was needed */
    FILM_REFINED = 2,           /* tolerance of a step over that of the run with twice the highest frequency */
    FILM_MOST_FOLLOWED = 100000 /* modes of a run, for the memory of their tables: 136 bytes per mode and step size in use */
};

/* A run. core: of the march's units. status: below 0 if it failed; FILM_TOO_MANY: also for too many modes. modes: with the one that
 * stands for the omitted ones. shares: sum of those of all others. omitted, error: compliance of the modes above the highest, and a
 * bound on its error, with what the others have less if their frequencies are higher by their errors. */
typedef struct {
    film_summary core;
    double shares, omitted, error;
    double highest, tolerance; /* that were asked for */
    int32_t status, modes;
} film_run;

typedef struct {
    /* given. length, force, time: delta_s, F_s, t_s in the units of the structure. most: highest frequency of all runs; most_work: of
     * all runs together, as FILM_MOST_WORK. skips: whether frequencies may be left out that the contact follows quickly; carried:
     * whether there are membrane forces; damped, reversible: the law */
    film_start start;
    double length, force, time;
    double accuracy, most, most_work;
    int32_t damped, reversible, skips, carried;
    /* what the caller does next. final: whether that run may be the result */
    int32_t ask, final;
    double highest, tolerance;
    /* the result. below: highest frequency of the run before. errors: estimates, value by value as of film_differences; changes: by
     * the errors of frequencies and omitted compliance; estimated: the largest error; own: what the last two kinds of runs add to it */
    double below, estimated, own, membrane;
    double errors[FILM_COMPARED], changes[FILM_COMPARED];
    /* of its own */
    film_run runs[3];
    double work, estimates[3];
    int32_t count, tried, over;
    int32_t earlier, stiffer; /* of the run that is asked for: it goes before the others; it has a stiffer omitted mode only */
} film_refine;

/* Asks for the first run, up to the frequency `first`; what is given is set before. */
FILM_API void film_refine_begin(film_refine *refine, double first);

/* Takes what was asked for, and asks for the next. */
FILM_API void film_refine_next(film_refine *refine, const film_run *run);

/* A share of a tolerance, as far as a step can meet it. */
FILM_API double film_tightened(double tolerance, double share);

/* Tolerance of a step for an accuracy. */
FILM_API double film_step_tolerance(double accuracy);

/* bound[i]: on the error of a run, from its difference change[i] to one with half the highest frequency, and before[i], that of the
 * latter to one with a quarter. damped: whether the law is. */
FILM_API void film_refine_bounds(int damped, int64_t count, const double *before, const double *change, double *bound);

/* sizeof film_run, film_refine. */
FILM_API void film_refine_sizes(int64_t sizes[2]);

#endif
