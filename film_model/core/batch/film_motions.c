/* See film_motions.h. */
#include "batch/film_motions.h"

#include "batch/film_batch.h"
#include "oblique/film_springs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TIMED = 16 }; /* contacts whose times are taken together */

void film_springs_knots(int64_t count, int64_t knots, const double *legs, double *times) {
    int64_t values = 2 * (knots + 1);
    for (int64_t first = 0; first < count; first += TIMED, legs += 3 * TIMED, times += values * TIMED) {
        int64_t own = count - first < TIMED ? count - first : TIMED;
        for (int64_t k = 0; k <= knots; k++) {
            double share = film_leg_share((double)k / (double)knots);
            for (int64_t i = 0; i < own; i++) {
                double turn = legs[3 * i], end = legs[3 * i + 1];
                times[i * values + k] = k == knots ? turn : turn * share;
                times[i * values + 2 * knots + 1 - k] = k == knots ? turn : end - (end - turn) * share;
            }
        }
        for (int64_t i = 0; i < own; i++) film_bend_times(knots, legs + 3 * i, times + i * values);
    }
}

int film_motions_kink(const film_curve *curve) {
    film_line line = {.branch = 0};
    if (curve->stages < 2) return 0;
    double end = curve->stage[0].end, before = film_contact_slope(curve, &line, end);
    line.branch = 1;
    return fabs(film_contact_slope(curve, &line, end) - before) > 0.25 * before;
}

void film_motions_many(int instructions, const film_curves *of, int64_t count, const film_start *start, int64_t samples, double *legs,
                       double *times, double *force, double *depth, double *slope, double *power) {
    int alike = of->family == NULL && of->varying == 0 && of->compliance == NULL;
    law_cubics law;
    film_curve made = *of->curve;
    double bad[LANES];
    motions_wanted to = {.curve = alike ? of->curve : &made, .samples = samples};
    if (alike && film_make_cubics(of->curve, &law)) to.law = &law;
    int64_t step = to.law ? LANES : 1;
    film_springs_knots(count, samples / 2 - 1, legs, times);
    for (int64_t i = 0; i < count; i += step) {
        int own = (int)(count - i < step ? count - i : step);
        to.start = start + i, to.legs = legs + 3 * i, to.times = times + i * samples;
        to.force = force + i * samples, to.depth = depth + i * samples, to.slope = slope ? slope + i * samples : NULL;
        bad[0] = 1.0;
        double energy = of->family ? film_most_work(of->curve, &start[i]) : INFINITY;
        if (alike || film_curve_of(of, i, energy, &made) >= 0) {
            to.kink = !slope && film_motions_kink(to.curve);
            if (to.law) film_routines(instructions)->record(&to, own, bad);
            else film_record_alone(&to, bad);
        }
        for (int l = 0; l < own; l++) {
            power[i + l] = film_springs_power(to.curve);
            for (int64_t k = 0; k < samples && bad[l] > 0.0; k++) to.force[l * samples + k] = NAN;
        }
    }
}

/* The sum over the knots from one to another of values, by cubics between, over their distance: value k is rise[k] force[by k]. */
static double between(int64_t from, int64_t to, const double *rise, const double *force, int64_t by) {
    static const double ends[4] = {-16.0 / 24.0, 7.0 / 24.0, -4.0 / 24.0, 1.0 / 24.0};
    double sum = 0.0;
    for (int64_t k = from; k <= to; k++) sum += rise[k] * force[by * k];
    for (int k = 0; k < 4; k++) sum += ends[k] * (rise[from + k] * force[by * (from + k)] + rise[to - k] * force[by * (to - k)]);
    return sum;
}

void film_springs_impulses(int64_t count, int64_t knots, const double *legs, const double *force, double *impulse) {
    double rise[FILM_MOST_STEPS + 1]; /* of film_leg_share, from knot to knot */
    for (int64_t k = 0; k <= knots && k <= FILM_MOST_STEPS; k++) {
        double x = (double)k / (double)knots, fourth = x * x * x * x, by = 1.0 + 16.0 * fourth;
        rise[k] = 2.0 * film_leg_share(x) * (1.0 + 8.0 * fourth) / by / (x > 0.0 ? x : 1.0) / (double)knots;
    }
    for (int64_t i = 0; i < count; i++, legs += 3, force += 2 * (knots + 1)) {
        film_bend bend = film_bend_of(legs[2], legs[0], knots);
        int64_t bent = bend.knot > 0 ? bend.knot : 0;
        double out = (legs[1] - legs[0]) * between(0, knots, rise, force + 2 * knots + 1, -1);
        impulse[i] = out + bend.late * between(bent, knots, rise, force, 1) + (bent > 0 ? bend.early * between(0, bent, rise, force, 1) : 0.0);
    }
}

void film_springs_roughness(int64_t count, int64_t knots, const double *legs, const double *values, double *roughness) {
    for (int64_t i = 0; i < count; i++, legs += 3, values += 2 * (knots + 1)) {
        int64_t knot = film_bend_of(legs[2], legs[0], knots).knot;
        double largest = 0.0, most = 0.0;
        for (int64_t k = 0; k <= knots; k++) largest = values[k] > largest ? values[k] : largest;
        for (int64_t k = 3; k + 3 <= knots; k += 2) {
            double between = (9.0 * (values[k - 1] + values[k + 1]) - values[k - 3] - values[k + 3]) / 16.0;
            double beside = fabs(values[k] - between);
            most = llabs(knot - k) >= 3 && beside > most ? beside : most;
        }
        roughness[i] = most / largest;
    }
}

void film_springs_many(int instructions, int64_t count, const int64_t *places, int32_t springs, int32_t estimated, const double *numbers,
                       const double *friction, int32_t rows, int shared, int64_t steps, int64_t knots, const double *force, const double *radius,
                       film_springs_brief *results) {
    film_routines(instructions)
        ->slide[springs < FILM_MOST_SPRINGS](count, places, springs, estimated, numbers, friction, rows, shared, steps, knots, force, radius, results);
}
