/* The normal motions of many contacts, from which springs of friction take their forces. docs/method.md, section 15. */
#ifndef FILM_MOTIONS_H
#define FILM_MOTIONS_H

#include "film_core.h"

/* Room for film_motions_many: lines and events of one contact, and 5 values of each sample. */
typedef struct {
    film_line *lines;
    film_state *events;
    double *sampled;
    int64_t samples;
    int32_t line_room, event_room, instructions, reserved;
} film_motions;

/* Whether lanes can run motions on a curve of all, without lines. */
FILM_API int film_motions_in_lanes(const film_curve *curve);

/* Force, depth and, of a reversible law and unless NULL, the slope of its force, of many contacts, in lanes or by lines, at the times of
 * film_springs_knots: times[i samples + k], force[i samples + k]; and the power of film_springs_power. legs get the time at which a
 * contact yields with a kink of its force, else 0. Forces are NaN of a contact that fails, has more lines than there is room, or no
 * finite last time. */
FILM_API void film_motions_many(const film_motions *room, const film_curves *of, const film_mesh *mesh, int64_t count,
                                const film_start *start, double *legs, double *times, double *force, double *depth, double *slope,
                                double *power);

#endif
