/* See film_motions.h. */
#include "batch/film_motions.h"

#include "batch/film_batch.h"
#include "batch/film_many.h"
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

/* Whether cubics across a change of the slope of a force where a contact yields do not follow it: by more than a quarter. */
static int is_kink(double before, double after) { return fabs(after - before) > 0.25 * before; }

/* When a contact leaves the first stage of its law, at which it yields, if its slope has a kink there; else 0. */
static double yields_at(const film_curve *curve, const film_line *line, int32_t count) {
    int32_t i = 0;
    while (i < count && line[i].branch != 1) i++;
    if (i == 0 || i == count) return 0.0;
    double before = film_contact_slope(curve, &line[i - 1], line[i].xi), after = film_contact_slope(curve, &line[i], line[i].xi);
    return is_kink(before, after) ? line[i].time : 0.0;
}

/* Force and depth of one contact over time and, unless it is NULL, the slope of the force; without one the contact may yield. */
static int one_motion(const film_motions *m, const film_curve *curve, const film_mesh *mesh, const film_start *start,
                      double *legs, double *times, double *force, double *depth, double *slope) {
    int64_t samples = m->samples;
    int32_t lines;
    int status = film_record_one(curve, mesh, start, m->lines, m->line_room, &lines, m->events, m->event_room);
    if (status < 0) return status;
    if (!slope && (legs[2] = yields_at(curve, m->lines, lines)) > 0.0) film_bend_times(samples / 2 - 1, legs, times);
    film_routines(m->instructions)->sample(curve, m->lines, lines, times, samples, 1, m->sampled, samples);
    memcpy(depth, m->sampled, (size_t)samples * sizeof *depth);
    memcpy(force, m->sampled + 2 * samples, (size_t)samples * sizeof *force);
    if (slope) film_springs_slopes(curve, samples, force, depth, slope);
    return status;
}

int film_motions_in_lanes(const film_curve *curve) { return film_has_cubics(curve); }

/* Whether lanes can run motions on the curve, and what these share. */
static int by_lanes(const film_curve *curve, int64_t count, const film_start *start, const double *legs, int yields, law_cubics *law,
                    motions_wanted *to) {
    double most = 0.0, before, after, force;
    for (int64_t i = 0; i < count; i++) most = fmax(most, film_farthest(&start[i], legs[3 * i]));
    if (!film_has_cubics(curve) || !(most > 0.0)) return 0;
    film_make_cubics(curve, most, law);
    to->curve = curve, to->law = law, to->kink = 0;
    if (!yields || curve->stages < 2) return 1;
    double end = curve->stage[0].end;
    value_and_slope(&piece_at(curve, 0, end)->force, end, &force, &before);
    value_and_slope(&piece_at(curve, 1, end)->force, end, &force, &after);
    to->kink = is_kink(fmax(before, 0.0), fmax(after, 0.0));
    return 1;
}

void film_motions_many(const film_motions *m, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                       double *legs, double *times, double *force, double *depth, double *slope, double *power) {
    const film_curve *curve = of->curve;
    film_mesh lines = *mesh;
    film_curve made;
    int alike = of->family == NULL && of->varying == 0 && of->compliance == NULL;
    lines.ways = FILM_LINES_ALONE;
    if (!alike) made = *curve;
    law_cubics law;
    motions_wanted to;
    double bad[LANES];
    int in_lanes = alike && by_lanes(curve, count, start, legs, slope == NULL, &law, &to);
    film_springs_knots(count, m->samples / 2 - 1, legs, times);
    for (int64_t i = 0; i < count; i++, times += m->samples, force += m->samples, depth += m->samples) {
        int status = FILM_BAD_NUMBER;
        double *own_slope = slope ? slope + i * m->samples : NULL;
        if (in_lanes && i % LANES == 0) {
            to.samples = m->samples, to.start = start + i, to.legs = legs + 3 * i;
            to.times = times, to.force = force, to.depth = depth, to.slope = own_slope;
            film_routines(m->instructions)->record(&to, (int)(count - i < LANES ? count - i : LANES), bad);
        }
        double energy = of->family == NULL ? INFINITY : film_most_work(curve, &start[i]);
        int done = in_lanes && bad[i % LANES] == 0.0;
        if (done) status = FILM_OK;
        else if (in_lanes) film_springs_knots(1, m->samples / 2 - 1, legs + 3 * i, times);
        for (int again = !done && isfinite(times[m->samples - 1]); again; energy = INFINITY) { /* as march_on */
            status = alike ? FILM_OK : film_curve_of(of, i, energy, &made);
            if (status >= 0) status = one_motion(m, alike ? curve : &made, &lines, &start[i], legs + 3 * i, times, force, depth, own_slope);
            again = status == FILM_BEYOND_LAW && energy < INFINITY;
        }
        power[i] = film_springs_power(alike ? curve : &made);
        for (int64_t k = 0; k < m->samples && status < 0; k++) force[k] = NAN;
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
        for (int64_t k = 0; k <= knots; k++) largest = fmax(largest, values[k]);
        for (int64_t k = 3; k + 3 <= knots; k += 2) {
            double between = (9.0 * (values[k - 1] + values[k + 1]) - values[k - 3] - values[k + 3]) / 16.0;
            if (llabs(knot - k) >= 3) most = fmax(most, fabs(values[k] - between));
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
