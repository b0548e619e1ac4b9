/* The way back along stretched stages of a law that pulls, in lanes. Internal to film_lanes.c. docs/method.md, section 6. */
#ifndef FILM_LANE_STRETCH_H
#define FILM_LANE_STRETCH_H

#include "lanes/film_lane_line.h"

/* The largest error, as a fraction of the force, that stretch_lanes corrects by one Newton step: its closed form is that of
 * JKR's law, so only rounding and the fit remain. Lanes of another law have a larger one and are left to film_marched. */
static const double STRETCH = 1e-9;

/* FILM_SIMILAR: r and l of each lane, and the dent xi_f. */
typedef struct {
    double force[LANES], length[LANES], per_length[LANES], dent[LANES];
} stretch;

/* Of lanes that have turned in `stage`: they then count xi from the dent. Returns the last reversible stage; *given: the work of
 * the way from the turn to where the stage `touch` begins for an impact. */
static int32_t stretch_lanes(const batch_job *j, int32_t stage, lanes *restrict s, stretch *restrict by, double *restrict given) {
    const film_curve *curve = j->curve;
    double square[LANES], ignored[LANES], cubed[LANES], wanted[LANES], x[LANES], slope[LANES], f[LANES], w[LANES], e[LANES], stored = 0.0;
    int32_t k = stage;
    while (k > 0 && curve->stage[k].unloading == FILM_SIMILAR) k--;
    double low = curve->stage[k].begin, high = curve->piece[curve->stage[k].first + curve->stage[k].count - 1].end;
    for (int32_t i = j->touch; i < k; i++) stored += j->whole[i];
    stage_lanes(j, stage, RECOVERY_AND_EXPONENT, s->xi, square, ignored);
    EACH(l) {
        double root = sqrt(square[l] * sqrt(square[l])), r = root * root / (s->force[l] + 2.0 * root);
        by->force[l] = r > 1.0 ? r : 1.0;
        wanted[l] = s->force[l] / by->force[l];
        cubed[l] = 1.0 + sqrt(1.0 + wanted[l]);
        e[l] = 1.0 / 3;
    }
    power_lanes(by->force, e, by->length);
    power_lanes(cubed, e, x);
    EACH(l) {
        double c = by->length[l], u = x[l]; /* power_lanes errs by some ulps */
        c -= (c * c * c - by->force[l]) / (3.0 * c * c);
        u -= (u * u * u - cubed[l]) / (3.0 * u * u);
        by->length[l] = c;
        by->per_length[l] = 1.0 / c;
        x[l] = u * (3.0 * (u * u * u) - 4.0); /* JKR's law: f = u^6 - 2 u^3 */
        slope[l] = u * u * u * (u * u * u - 1.0) / (u * (2.0 * (u * u * u) - 2.0 / 3));
    }
    law_lanes(j, k, x, f, w);
    EACH(l) {
        double miss = wanted[l] - f[l], inside = x[l] > low && x[l] < high ? s->bad[l] : 1.0;
        s->bad[l] = fabs(miss) <= STRETCH * wanted[l] ? inside : 1.0;
        x[l] += miss / slope[l];
        w[l] += miss / slope[l] * wanted[l];
        by->dent[l] = s->xi[l] - by->length[l] * x[l];
        s->xi[l] = by->length[l] * x[l];
        given[l] = by->force[l] * by->length[l] * (stored + w[l]);
    }
    return k;
}

/* law_lanes on stretched stages, xi counted from the dent; by NULL: on the stages themselves. */
static void back_law_lanes(const batch_job *j, int32_t stage, const stretch *by, const double *restrict xi,
                           double *restrict force, double *restrict work) {
    double x[LANES];
    if (by == NULL) {
        law_lanes(j, stage, xi, force, work);
        return;
    }
    EACH(l) x[l] = xi[l] * by->per_length[l];
    law_lanes(j, stage, x, force, work);
    EACH(l) {
        force[l] *= by->force[l];
        work[l] *= by->force[l] * by->length[l];
    }
}

#endif
