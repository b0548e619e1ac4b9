/* One contact to an accuracy: segments are doubled until meshes agree. docs/method.md, section 12. */
#include "march/film_solve.h"

#include <math.h>
#include <string.h>

/* Times at which slow motion under a load is compared: the time limit, halved up to HALVINGS times. */
enum { HALVINGS = 32 };

/* More segments do not help: estimates below SMALL fall by less than STALLED, or an error below rounding by less than FALLS. */
static const double STALLED = 0.7, SMALL = 1e-9, FALLS = 0.5;

/* On meshes of more segments than SO_MANY a motion in which nothing ends has to agree to BETWEEN at times before the limit; there,
 * within lines, errors fall more slowly than at the limit. */
enum { SO_MANY = 3072 };
static const double BETWEEN = 1e-4;

/* By how many doublings strong damping raises the segments of the first trial at most. */
static const double MOST_DOUBLINGS = 8.0;

typedef double film_way[HALVINGS + 1][2];

/* Indentation and velocity of an impactor pressed in by a load. */
static void creep(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_way way) {
    film_state state;
    film_begin(curve, start, &state);
    for (int k = 0; k <= HALVINGS; k++) {
        double until = ldexp(start->time_limit, k - HALVINGS);
        for (int event = 0; event < FILM_MAX_EVENTS; event++)
            if (film_step(curve, mesh, &state, fmax(until - state.time, 0.0)) != FILM_EVENT) break;
        way[k][0] = state.xi;
        way[k][1] = state.nu;
    }
}

/* The largest relative difference of the summaries on two meshes; of the motion itself if there is no maximum. way: the motion on the
 * coarser mesh, if it is known, and then on the finer one. */
static double apart(const film_curve *curve, const film_start *start, const film_mesh *meshes, const film_summary *a,
                    const film_summary *b, film_way way, int *known) {
    double off;
    film_way finer;
    film_compare(1, start, a, b, 0, &off);
    if (a->maximum_indentation > 0.0 || b->maximum_indentation > 0.0 || !isfinite(start->time_limit)) return off;
    if (!*known) creep(curve, &meshes[0], start, way);
    creep(curve, &meshes[1], start, finer);
    for (int column = 0; column < 2; column++) {
        double difference = 0.0, largest = 1e-300;
        for (int k = 0; k <= HALVINGS; k++) {
            difference = fmax(difference, fabs(way[k][column] - finer[k][column]));
            largest = fmax(largest, fabs(finer[k][column]));
        }
        if (meshes[1].loading <= SO_MANY || difference > BETWEEN * largest) off = fmax(off, difference / largest);
    }
    memcpy(way, finer, sizeof finer);
    *known = 1;
    return off;
}

void film_first_segments(int64_t count, const double *damping, int32_t least, int32_t *segments) {
    for (int64_t i = 0; i < count; i++) segments[i] = least << (int)fmin(fmax(logb(1.0 + damping[i]), 0.0), MOST_DOUBLINGS);
}

int film_solve(const film_curve *curve, const film_start *start, const film_mesh *meshes, int32_t count, double accuracy,
               double clearance, film_solution *found) {
    film_summary coarse, fine;
    film_way way;
    double before = 0.0, last = INFINITY;
    int known = 0;
    for (int32_t level = 0; level < count; level++) {
        int status = film_marched(curve, &meshes[level], start, &fine);
        if (status < 0) return status;
        double here = level > 0 ? apart(curve, start, &meshes[level - 1], &coarse, &fine, way, &known) : 0.0;
        if (level > 1) {
            double bound, rounds;
            film_bound_fine(&meshes[level], 1, 1, start, &coarse, &fine, &here, &before, &bound);
            film_rounding(curve, 1, start, &fine, clearance, &rounds);
            double estimated = bound + rounds;
            int settled = (bound < rounds && !(here < FALLS * before)) || (estimated > STALLED * last && estimated < SMALL);
            *found = (film_solution){fine, estimated, level, estimated <= accuracy};
            int costly = meshes[level].loading >= FILM_MOST_SEGMENTS || fine.lines > FILM_MOST_LINES / 2;
            if (found->reached || settled || costly) return status;
            last = estimated;
        }
        before = here;
        coarse = fine;
    }
    return FILM_FULL;
}

int film_estimate(const film_curve *curve, const film_start *start, const film_mesh meshes[2], double clearance, film_solution *found) {
    film_summary fine;
    film_way way;
    double bound, rounds;
    int unknown = 0;
    found->level = 0;
    found->reached = 0;
    int status = film_marched(curve, &meshes[0], start, &found->summary);
    int other = film_marched(curve, &meshes[1], start, &fine);
    if (status < 0 || other < 0) return status < 0 ? status : other;
    double off = apart(curve, start, meshes, &found->summary, &fine, way, &unknown);
    film_bound_coarse(&meshes[0], 1, start, &found->summary, &off, &bound);
    film_rounding(curve, 1, start, &found->summary, clearance, &rounds);
    found->estimated = bound + rounds;
    return status;
}
