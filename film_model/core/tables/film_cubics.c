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

/* Below which the force is as there: of a later stage, which begins as a root at most, 2e-4 of that beyond are left. */
static double least_of(const film_stage *stage) { return stage->begin > 0.0 ? 0x1p-24 * stage->begin : CUBIC_LEAST; }

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

int film_has_cubics(const film_curve *curve) {
    int64_t rows = 0;
    for (int32_t k = 0; k < curve->stages; k++)
        rows += interval_of(fmin(curve->stage[k].end, CUBIC_MOST) - curve->stage[k].begin) - interval_of(least_of(&curve->stage[k])) + 1;
    return curve->compliance == 0.0 && !(curve->pull > 0.0) && curve->stage[0].end > CUBIC_LEAST && rows <= CUBIC_ROWS;
}

void film_make_cubics(const film_curve *curve, double most, law_cubics *to) {
    int64_t rows = 0;
    to->damped = curve->stage[0].damped;
    to->most = 0.0;
    for (to->stages = 0; to->stages < curve->stages && to->most < most; to->stages++) {
        int32_t k = to->stages;
        const film_stage *stage = &curve->stage[k];
        double begin = to->begin[k] = stage->begin, least = to->least[k] = least_of(stage), length = stage->end - begin;
        /* as many rows as hold `most`, but whole ones: they do not depend on what else is in a batch */
        if (most < stage->end) length = fmin(length, interval_begin(interval_of(fmax(most - begin, least)) + 1));
        int64_t first = interval_of(least), last = interval_of(length);
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
}
