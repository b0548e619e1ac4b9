/* See film_motions.h. */
#include "batch/film_motions.h"

#include "batch/film_batch.h"
#include "batch/film_many.h"
#include "oblique/film_springs.h"

#include <string.h>

/* Force and depth of one contact over time and, unless it is NULL, the slope of the force. */
static int one_motion(const film_motions *m, const film_curve *curve, const film_mesh *mesh, const film_start *start,
                      const double *times, double *force, double *depth, double *slope) {
    int64_t samples = m->samples;
    int32_t lines;
    int status = film_record_one(curve, mesh, start, m->lines, m->line_room, &lines, m->events, m->event_room);
    if (status < 0) return status;
    film_routines(m->instructions)->sample(curve, m->lines, lines, times, samples, m->sampled, samples);
    memcpy(depth, m->sampled, (size_t)samples * sizeof *depth);
    memcpy(force, m->sampled + 2 * samples, (size_t)samples * sizeof *force);
    if (slope) film_springs_slopes(curve, samples, force, depth, slope);
    return status;
}

int film_motions_by_series(const film_curve *curve, const film_mesh *mesh) {
    batch_job j;
    j.curve = curve, j.mesh = mesh;
    film_prepare_damped(&j);
    return j.damped.root > 0;
}

/* Up to LANES contacts from `first` on by the series of damped ones; their statuses. */
static void by_series(int instructions, const film_curve *curve, const film_mesh *mesh, int count, const film_start *start,
                      const motions_wanted *to, int32_t *status) {
    film_summary summary[LANES];
    batch_job j;
    int64_t index[LANES];
    int in_lanes = 0;
    give(&j, curve, mesh, start, summary, status);
    j.motions = to;
    film_prepare_damped(&j);
    for (int i = 0; i < count; i++) {
        status[i] = LEFT_ALONE;
        if (in_damped_lanes(&j, &start[i]) && isfinite(to->times[(i + 1) * to->samples - 1])) index[in_lanes++] = i;
    }
    if (in_lanes > 0) film_routines(instructions)->damped(&j, index, in_lanes);
}

void film_motions_many(const film_motions *m, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                       const double *times, double *force, double *depth, double *slope, double *power) {
    const film_curve *curve = of->curve;
    film_mesh lines = *mesh;
    film_curve made;
    int alike = of->family == NULL && of->varying == 0 && of->compliance == NULL;
    lines.ways = FILM_LINES_ALONE;
    if (!alike) made = *curve;
    int32_t known[LANES];
    int series = alike && slope && film_motions_by_series(curve, mesh);
    for (int64_t i = 0; i < count; i++, times += m->samples, force += m->samples, depth += m->samples) {
        int status = FILM_BAD_NUMBER;
        if (series && i % LANES == 0) {
            const motions_wanted to = {m->samples, times, force, depth, slope + i * m->samples};
            by_series(m->instructions, curve, mesh, (int)(count - i < LANES ? count - i : LANES), &start[i], &to, known);
        }
        double energy = of->family == NULL ? INFINITY : film_most_work(curve, &start[i]);
        double *own_slope = slope ? slope + i * m->samples : NULL;
        int done = series && known[i % LANES] == FILM_EVENT;
        if (done) status = FILM_OK;
        for (int again = !done && isfinite(times[m->samples - 1]); again; energy = INFINITY) { /* as march_on */
            status = alike ? FILM_OK : film_curve_of(of, i, energy, &made);
            if (status >= 0) status = one_motion(m, alike ? curve : &made, &lines, &start[i], times, force, depth, own_slope);
            again = status == FILM_BEYOND_LAW && energy < INFINITY;
        }
        power[i] = film_springs_power(alike ? curve : &made);
        for (int64_t k = 0; k < m->samples && status < 0; k++) force[k] = NAN;
    }
}

void film_springs_knots(int64_t count, int64_t knots, const double *legs, double *times) {
    for (int64_t i = 0; i < count; i++, times += 2 * (knots + 1)) {
        double turn = legs[2 * i], out = legs[2 * i + 1] - turn;
        for (int64_t k = 0; k <= knots; k++) {
            double share = film_leg_share((double)k / (double)knots);
            times[k] = k == knots ? turn : turn * share;
            times[2 * knots + 1 - k] = k == knots ? turn : legs[2 * i + 1] - out * share;
        }
    }
}

void film_springs_many(int instructions, int64_t count, int32_t springs, int32_t estimated, const double *numbers, const double *friction,
                       int32_t rows, int shared, int64_t steps, int64_t knots, const double *force, const double *radius, film_springs_brief *results) {
    film_routines(instructions)->slide(count, springs, estimated, numbers, friction, rows, shared, steps, knots, force, radius, results);
}
