/* Differences of two summaries of the same contacts, and their rounding errors. docs/method.md, section 12. */
#include "film_core.h"

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

/* A turn nearer than 1e-9 of the indentation is taken under a constant force (film_draw.c). That matters if this is more than
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

static double difference(const film_start *start, const film_summary *a, const film_summary *b) {
    double depth = b->maximum_indentation, final = b->final_velocity, speed = larger(start->nu, 1e-300);
    double off = apart(a->maximum_force, b->maximum_force, b->maximum_force);
    off = larger(off, apart(a->maximum_indentation, depth, depth));
    off = larger(off, apart(a->time_of_maximum_indentation, b->time_of_maximum_indentation, b->time_of_maximum_indentation));
    if (start->nu == 0.0) return off;
    off = larger(off, apart(a->time_impactor_stops, b->time_impactor_stops, fabs(b->time_impactor_stops)));
    off = larger(off, apart(a->contact_duration, b->contact_duration, b->contact_duration));
    double floor = larger(fabs(b->permanent_indentation), FLOOR * depth);
    off = larger(off, apart(a->permanent_indentation, b->permanent_indentation, floor));
    double slow = larger(fmin(fabs(final), fabs(final - start->stop_velocity)), FLOOR * speed);
    off = larger(off, apart(a->final_velocity, final, slow));
    return larger(off, apart(a->work, b->work, larger(0.5 * speed * speed, fabs(b->work))));
}

/* Energy that rounding may add or take: of the largest that the contact held, and of the law's work at the deepest point,
 * which is known no better than the indentation beyond `clearance`, where the force begins. A load and a pull do work too. It
 * changes the final velocity v by its size over v, and a final velocity of 0 by its root. */
static double rounding(const film_curve *curve, const film_start *start, const film_summary *s, double clearance) {
    double impact = 0.5 * start->nu * start->nu, depth = s->maximum_indentation, speed = fabs(s->final_velocity);
    double closed = depth > clearance ? depth / (depth - clearance) : 1.0;
    double unit = (curve->compliance > 0.0 ? SERIES_ROUNDING : ENERGY_ROUNDING) * DBL_EPSILON;
    double push = (start->load + PULL_ROUNDING * curve->pull) * sqrt(1.0 + s->lines / FEW_LINES);
    double lost = unit * (impact * closed + push * depth);
    double other = closed > DEEP ? SHORT_WAY * closed : 0.0;
    if (start->stop_velocity > 0.0 && !isnan(s->time_impactor_stops))
        other += STOP_ROUNDING * DBL_EPSILON * start->nu / (start->nu - start->stop_velocity);
    if (!(speed >= 0.0) || !(impact > 0.0)) return other + unit * closed;
    return other + lost / (larger(speed, sqrt(lost)) * larger(speed, FLOOR * start->nu));
}

/* Relative rounding error of a march of 100 segments; it grows with the square root of their number. */
static const double MARCH_ROUNDING = 2e-14;

void film_compare(int64_t count, const film_start *start, const film_summary *a, const film_summary *b, double *off) {
    for (int64_t i = 0; i < count; i++) off[i] = difference(&start[i], &a[i], &b[i]);
}

void film_rounding(const film_curve *curve, int64_t count, const film_start *start, const film_summary *summary,
                   double clearance, double *off) {
    for (int64_t i = 0; i < count; i++) {
        double march = MARCH_ROUNDING * sqrt(summary[i].lines / 100.0);
        off[i] = fmin(march + rounding(curve, &start[i], &summary[i], clearance), 1.0);
    }
}
