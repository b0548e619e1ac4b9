/* Differences of two summaries of the same contacts, and their rounding errors. docs/method.md, section 12. */
#include "march/film_solve.h"

#include <float.h>
#include <math.h>

/* Errors of velocities and permanent indentations are relative to at least this fraction of their scale. */
static const double FLOOR = 1e-3;

/* Rounding of the energy at the deepest point, over DBL_EPSILON: it is the sum of as many works as there are lines.
 * tests/test_sweep_accuracy.py compares it with elastic contacts, which must give their energy back. */
static const double ENERGY_ROUNDING = 2.0;

/* The work of a pull, which is the difference of two, counts this many times. tests/test_estimates.py. */
static const double PULL_ROUNDING = 4.0;

/* The work of a load and a pull is summed over the lines: from about this number on, its rounding grows with the root of it.
 * tests/test_estimates.py. */
static const double FEW_LINES = 400.0;

/* ENERGY_ROUNDING in series with a spring, where the law is evaluated at an indentation that is sought.
 * tests/test_one_and_many.py, seed 1390. */
static const double SERIES_ROUNDING = 2e4;

/* Rounding of the work of a load on the way of that spring, over DBL_EPSILON; tests/test_estimates.py. */
static const double SPRING_ROUNDING = 128.0;

/* A turn nearer than 1e-9 of the indentation is taken along a tangent (film_next.c). That matters if this is more than
 * about 1e-2 of the indentation beyond the clearance. */
static const double SHORT_WAY = 1e-9, DEEP = 1e7;

/* Rounding of the time at which the impactor stops, over DBL_EPSILON and the share of its velocity that it loses until then:
 * of a target that moves towards a slower impactor. tests/test_estimates.py. */
static const double STOP_ROUNDING = 32.0;

/* |a - b|/scale: 0 if both are NaN or the scale is 0, 1 if one is NaN. */
static double apart(double a, double b, double scale) {
    if (isnan(a) || isnan(b)) return isnan(a) && isnan(b) ? 0.0 : 1.0;
    double off = scale == 0.0 ? 0.0 : fabs(a - b) / scale;
    return isnan(off) ? 1.0 : off;
}

static double larger(double a, double b) { return a > b ? a : b; }

/* Bounds on the error of n segments over the difference to n/2, and of n over the difference to 2n: asymptotically 1/15 and 16/15
 * for fourth order, 1/3 and 4/3 for chords; larger, for meshes that are still coarse. */
static const double OF_FINE[] = {0.6, 0.5}, OF_COARSE[] = {2.4, 1.6};

/* By how much doubling the segments divides the error. If the difference of two meshes falls by more, they may agree by chance:
 * the bound is then from the meshes before. tests/test_one_and_many.py. */
static const double REGULAR_FALL[] = {4.0, 16.0};

/* The bound over the difference to half as many segments, up to COARSE segments; it falls as 1/n to OF_FINE. Where errors do not
 * yet fall with the fourth power, at kinks of the law and in slow contacts under a load, two meshes may agree by chance.
 * tests/test_sweep_accuracy.py, tests/test_estimates.py. */
static const double COARSE_FACTOR = 2.0, COARSE = 24.0;

/* Tables of whole ways and lanes serve a limited number of segments, more than LANES_END. Where they serve only the coarser of
 * two meshes, the finer one has more than MANY_LINES times as many lines and errors of its own: SWITCHED bounds them over the
 * difference. tests/test_estimates.py. */
enum { LANES_END = 48 };
static const double MANY_LINES = 3.0, SWITCHED = 2.0;

/* Bound on the relative error of the time at which the impactor stops within the first line from first touch, over the fraction
 * of the approach velocity that it loses until then; of chords over 1. 0.006 under Hertz's law, 0.09 under tsuji, 0.2 under
 * hunt-crossley. tests/test_estimates.py. */
static const double STOP_IN_A_LINE = 0.25;

/* On vibrating targets an error of the time of the largest indentation counts this many times less: vibrations that hardly change
 * the force move its flat maximum. Where the force is known to 1e-4, the indentation is within 1e-4 of the largest for 1e-2 of the
 * contact time; where it is known to 1e-6, for 1e-3. */
static const double FLAT = 10.0;

void film_differences(const film_start *start, const film_summary *a, const film_summary *b, int vibrates, double off[FILM_COMPARED]) {
    double depth = b->maximum_indentation, final = b->final_velocity, speed = larger(start->nu, 1e-300);
    double known = b->time_of_maximum_indentation, time = a->time_of_maximum_indentation;
    double floor = larger(fabs(b->permanent_indentation), FLOOR * depth);
    double slow = larger(fmin(fabs(final), fabs(final - start->stop_velocity)), FLOOR * speed);
    off[0] = apart(a->maximum_force, b->maximum_force, b->maximum_force);
    off[1] = apart(a->maximum_indentation, depth, depth);
    off[2] = apart(vibrates ? known + (time - known) / FLAT : time, known, known);
    off[3] = apart(a->time_impactor_stops, b->time_impactor_stops, fabs(b->time_impactor_stops));
    off[4] = apart(a->contact_duration, b->contact_duration, b->contact_duration);
    off[5] = apart(a->permanent_indentation, b->permanent_indentation, floor);
    off[6] = apart(a->final_velocity, final, slow);
    off[7] = apart(a->work, b->work, larger(0.5 * speed * speed, fabs(b->work)));
    if (start->nu == 0.0) off[3] = off[4] = off[5] = off[6] = off[7] = 0.0;
}

/* Energy that rounding may add or take: of the largest that the contact held, and of the law's work at the deepest point,
 * which is known no better than the indentation beyond `clearance`, where the force begins. A load and a pull do work too. It
 * changes the final velocity v by about its size over v, and a final velocity of 0 by its root. */
static double rounding(const film_curve *curve, const film_start *start, const film_summary *s, double clearance) {
    double impact = 0.5 * start->nu * start->nu, depth = s->maximum_indentation, speed = fabs(s->final_velocity);
    double closed = depth > clearance ? depth / (depth - clearance) : 1.0;
    double unit = (curve->compliance > 0.0 ? SERIES_ROUNDING : ENERGY_ROUNDING) * DBL_EPSILON;
    double push = (start->load + PULL_ROUNDING * curve->pull) * sqrt(1.0 + s->lines / FEW_LINES);
    double lost = unit * (impact * closed + push * depth);
    lost += SPRING_ROUNDING * DBL_EPSILON * push * curve->compliance * s->maximum_force;
    double other = closed > DEEP ? SHORT_WAY * closed : 0.0;
    if (start->stop_velocity > 0.0 && !isnan(s->time_impactor_stops))
        other += STOP_ROUNDING * DBL_EPSILON * start->nu / (start->nu - start->stop_velocity);
    if (!(speed >= 0.0) || !(impact > 0.0)) return other + unit * closed;
    double share = 2.0 * lost / (larger(speed, sqrt(lost)) * larger(speed, FLOOR * start->nu)); /* of the energy at the end */
    return other + (share < 1.0 ? share / (1.0 + sqrt(1.0 - share)) : 1.0);
}

/* Relative rounding error of a march of 100 segments; it grows with the square root of their number. */
static const double MARCH_ROUNDING = 2e-14;

void film_compare(int64_t count, const film_start *start, const film_summary *a, const film_summary *b, int vibrates, double *off) {
    for (int64_t i = 0; i < count; i++) {
        double each[FILM_COMPARED];
        film_differences(&start[i], &a[i], &b[i], vibrates, each);
        off[i] = each[0];
        for (int k = 1; k < FILM_COMPARED; k++) off[i] = larger(off[i], each[k]);
    }
}

/* |a/b - 1|: 1 if only one of both values exists. */
static double relative(double a, double b) {
    if (a == b) return 0.0;
    return b > 0.0 && a >= 0.0 ? fabs(a / b - 1.0) : 1.0;
}

/* |a - b|/scale; NaN, which is no change, if the scale is 0. */
static double over(double a, double b, double scale) { return scale == 0.0 ? NAN : fabs(a - b) / scale; }

/* Energy that the target takes: the remainder in the balance of energy. */
static double radiated(const film_start *start, const film_summary *s) {
    double lost = 0.5 * (start->nu * start->nu - s->final_velocity * s->final_velocity) - s->work;
    return lost + start->load * (s->permanent_indentation + s->shift);
}

static double change(const film_start *p, const film_summary *a, const film_start *q, const film_summary *b, int end,
                     const double *unit) {
    double length = unit[0], force = unit[1], time = unit[2], speed = unit[3], energy = length * force;
    double depth = a->maximum_indentation, impact = 0.5 * (p->nu * p->nu);
    double off = larger(relative(b->maximum_indentation * length, depth), relative(b->maximum_force * force, a->maximum_force));
    off = larger(relative(b->time_of_maximum_indentation * time, a->time_of_maximum_indentation), off);
    if (!end) return off;
    off = larger(relative(b->contact_duration * time, a->contact_duration), off);
    off = larger(over(b->permanent_indentation * length, a->permanent_indentation, depth), off);
    off = larger(over(b->final_velocity * speed, a->final_velocity, p->nu), off);
    off = larger(over(b->work * energy, a->work, impact), off);
    if (!(p->gamma > 0.0 || q->gamma > 0.0)) return off;
    return larger(over(radiated(q, b) * energy, radiated(p, a), impact), off);
}

void film_change(int64_t count, const int32_t *status, const film_start *start, const film_summary *full, const int32_t *other_status,
                 const film_start *other_start, const film_summary *without, const double *units, double *off) {
    for (int64_t i = 0; i < count; i++) {
        int ends = status[i] == FILM_EVENT, other_ends = other_status[i] == FILM_EVENT;
        if (status[i] < 0 || other_status[i] < 0) off[i] = NAN;
        else if (ends != other_ends) off[i] = 1.0;
        else off[i] = change(&start[i], &full[i], &other_start[i], &without[i], ends, &units[4 * i]);
    }
}

void film_rounding(const film_curve *curve, int64_t count, const film_start *start, const film_summary *summary,
                   double clearance, double *off) {
    for (int64_t i = 0; i < count; i++) {
        double march = MARCH_ROUNDING * sqrt(summary[i].lines / 100.0);
        off[i] = fmin(march + rounding(curve, &start[i], &summary[i], clearance), 1.0);
    }
}

/* Bound on the error of the time at which the impactor stops where two meshes do not show it. A line that reaches the stop is made
 * again to end there. If that is the first of n lines, meshes of fewer segments have the same line up to the stop; nor do they show
 * much if the first line takes half of that way. Only of a free target that moves towards a slower impactor. */
static double unseen(const film_mesh *mesh, const film_start *start, const film_summary *fine) {
    if (!(start->stop_velocity > 0.0)) return 0.0;
    int chords = mesh->linearisation == FILM_CHORD;
    double half = sin(0.5 * 3.14159265358979323846 / mesh->loading);
    double first = chords ? 1.0 / mesh->loading : half * half; /* the first node over the depth, if that is in the first stage */
    double lost = chords ? 1.0 : 1.0 - start->stop_velocity / start->nu;
    return fine->time_impactor_stops * start->nu < 2.0 * first * fine->maximum_indentation ? STOP_IN_A_LINE * lost : 0.0;
}

void film_bound_fine(const film_mesh *mesh, int by_three, int64_t count, const film_start *start, const film_summary *coarse,
                     const film_summary *fine, const double *off, const double *before, double *bound) {
    double settled = OF_FINE[mesh->linearisation], doubtful = larger(settled, COARSE_FACTOR * fmin(1.0, COARSE / mesh->loading));
    double fall = REGULAR_FALL[mesh->linearisation];
    for (int64_t i = 0; i < count; i++) {
        double factor = by_three && !(start[i].load > 0.0) ? settled : doubtful;
        if (mesh->loading >= LANES_END && fine[i].lines > MANY_LINES * coarse[i].lines) factor = SWITCHED;
        bound[i] = larger(factor * larger(off[i], before[i] / fall), unseen(mesh, &start[i], &fine[i]));
    }
}

void film_bound_coarse(const film_mesh *mesh, int64_t count, const film_start *start, const film_summary *coarse, const double *off,
                       double *bound) {
    for (int64_t i = 0; i < count; i++)
        bound[i] = larger(OF_COARSE[mesh->linearisation] * off[i], unseen(mesh, &start[i], &coarse[i]));
}
