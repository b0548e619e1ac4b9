/* The normal motions of many contacts, from which springs of friction take their forces. docs/method.md, section 15. */
#ifndef FILM_MOTIONS_H
#define FILM_MOTIONS_H

#include "film_core.h"

/* Whether the slope of a law changes where contacts yield so much that cubics across that do not follow it: by more than a quarter. */
FILM_API int film_motions_kink(const film_curve *curve);

/* Force, depth and, of a reversible law and unless NULL, the slope of its force, of many contacts at the times of film_springs_knots:
 * times[i samples + k], force[i samples + k]; and the power of film_springs_power. legs get the time at which a contact yields with a kink of
 * its force, else 0. Forces are NaN of a contact that has no finite last time, turns again, or does not end then. */
FILM_API void film_motions_many(int instructions, const film_curves *of, int64_t count, const film_start *start, int64_t samples, double *legs,
                                double *times, double *force, double *depth, double *slope, double *power);

#endif
