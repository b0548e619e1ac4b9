/* Errors of contacts on meshes, and one contact to an accuracy. docs/method.md, section 12. */
#ifndef FILM_SOLVE_H
#define FILM_SOLVE_H

#include "film_core.h"

/* off[i]: the largest relative difference of two summaries of the contact that starts with start[i], relative to b[i]; 1 for a
 * value that exists in only one of them. Permanent indentations and velocities are relative to at least 1e-3 of the maximum
 * indentation and of the approach velocity, work to the impact energy. If the approach velocity is 0, only values up to the
 * maximum indentation count, because whether contact ends then depends on rounding. vibrates: whether the target does; then the time
 * of the largest indentation counts less. film_differences: of one contact value by value, maximum force and indentation, time of
 * the latter, time at which the impactor stops, duration, permanent indentation, final velocity and work. */
enum { FILM_COMPARED = 8 };
FILM_API void film_compare(int64_t count, const film_start *start, const film_summary *a, const film_summary *b, int vibrates,
                           double *off);
FILM_API void film_differences(const film_start *start, const film_summary *a, const film_summary *b, int vibrates,
                               double off[FILM_COMPARED]);

/* off[i]: the largest change of a contact's results by neglecting an effect: `full` with it, `without` without; 1 if only one of both
 * ends, NaN if a status is negative. Force, maximum indentation and times are relative to those of `full`, permanent indentations to
 * its maximum indentation, velocities to its approach velocity, work and the energy that the target takes to the impact energy.
 * units: four of each contact, length, force, time and velocity of the march without the effect over those of that with it. */
FILM_API void film_change(int64_t count, const int32_t *status, const film_start *start, const film_summary *full,
                          const int32_t *other_status, const film_start *other_start, const film_summary *without,
                          const double *units, double *off);

/* off[i]: how much rounding may change summary[i], relative as in film_compare, at most 1. clearance: where the law's force begins. */
FILM_API void film_rounding(const film_curve *curve, int64_t count, const film_start *start, const film_summary *summary,
                            double clearance, double *off);

/* bound[i]: on the error of fine[i] on `mesh`, from off[i] = film_compare of coarse[i], on a mesh of half as many segments.
 * before[i]: the same of that mesh and of one still coarser, or 0. by_three: whether three meshes judge; two may agree by
 * chance where they are coarse. film_bound_coarse: on the error of coarse[i] on `mesh`, from its difference to a mesh of twice
 * as many segments. Both without rounding. docs/method.md, section 12. */
FILM_API void film_bound_fine(const film_mesh *mesh, int by_three, int64_t count, const film_start *start, const film_summary *coarse,
                              const film_summary *fine, const double *off, const double *before, double *bound);
FILM_API void film_bound_coarse(const film_mesh *mesh, int64_t count, const film_start *start, const film_summary *coarse,
                                const double *off, double *bound);

/* segments[i]: of the first trial of a contact, at least `least`: more for strong damping, which stops the impactor early. */
FILM_API void film_first_segments(int64_t count, const double *damping, int32_t least, int32_t *segments);

/* One contact to an accuracy, on the lines that film_record records. level: which of the meshes. estimated: bound on the relative
 * error, as film_compare takes it, of every value. reached: 1 if it is at most the accuracy. */
typedef struct {
    film_summary summary;
    double estimated;
    int32_t level, reached;
} film_solution;

/* The first of meshes, each of twice the segments of the one before, on which a contact meets the accuracy; judged by three of
 * them, so that it is the third at least. Without `reached`: more segments would not help, or there are FILM_MOST_SEGMENTS, or
 * the next mesh would take more than about FILM_MOST_LINES, as a contact may that swings under its weight.
 * clearance: where the law's force begins. film_marched's status; FILM_FULL: more meshes are needed. */
enum { FILM_MOST_SEGMENTS = 49152, FILM_MOST_LINES = 500000 };
FILM_API int film_solve(const film_curve *curve, const film_start *start, const film_mesh *meshes, int32_t count, double accuracy,
                        double clearance, film_solution *found);

/* The error of a contact on meshes[0], from meshes[1] of twice its segments. */
FILM_API int film_estimate(const film_curve *curve, const film_start *start, const film_mesh meshes[2], double clearance,
                           film_solution *found);

#endif
