/* The law in cubics. docs/method.md, section 15. */
#include "tables/film_job.h"

#include <string.h>

/* Intervals are numbered by the first bits of the numbers in them. */
static int64_t interval_of(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (int64_t)(bits >> CUBIC_SHIFT);
}

static double interval_begin(int64_t interval) {
    uint64_t bits = (uint64_t)interval << CUBIC_SHIFT;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Of where a later stage begins, beyond it, below which its force is as there: it begins as a root at most. */
static const double LEAST_BEYOND = 0x1p-24;

/* The cubic in x - a that has the values and slopes of a function at a and b >= a, less `begin`. */
static void put_cubic(const film_function *at_a, const film_function *at_b, double begin, double a, double b, double *cubic) {
    double per = b > a ? 1.0 / (b - a) : 0.0, first, last, begins, ends;
    value_and_slope(at_a, begin + a, &first, &begins);
    value_and_slope(at_b, begin + b, &last, &ends);
    double mean = (last - first) * per;
    cubic[0] = first;
    cubic[1] = begins;
    cubic[2] = (3.0 * mean - 2.0 * begins - ends) * per;
    cubic[3] = (begins + ends - 2.0 * mean) * per * per;
}

int film_make_cubics(const film_curve *curve, law_cubics *to) {
    int64_t rows = 0, room = curve->stage[0].damped ? DAMPED_ROWS : CUBIC_ROWS;
    if (curve->compliance != 0.0 || curve->pull > 0.0) return 0;
    to->stages = curve->stages, to->damped = curve->stage[0].damped;
    for (int32_t k = 0; k < curve->stages; k++) {
        const film_stage *stage = &curve->stage[k];
        double begin = to->begin[k] = stage->begin, length = fmin(stage->end, CUBIC_MOST) - begin;
        double least = to->least[k] = begin > 0.0 ? LEAST_BEYOND * begin : CUBIC_LEAST;
        int64_t first = interval_of(least), last = interval_of(length);
        if (!(length > least) || rows + last - first >= room) return 0;
        to->most = begin + length;
        to->first[k] = first - rows;
        for (int64_t i = first; i <= last; i++, rows++) {
            double a = interval_begin(i), b = i < last ? interval_begin(i + 1) : length;
            const film_piece *at_a = piece_at(curve, k, begin + a), *at_b = piece_at(curve, k, begin + b);
            to->row[rows].from = a;
            put_cubic(&at_a->force, &at_b->force, begin, a, b, to->row[rows].force);
            if (to->damped) put_cubic(&at_a->damping, &at_b->damping, begin, a, b, to->damping[rows]);
        }
    }
    return 1;
}
