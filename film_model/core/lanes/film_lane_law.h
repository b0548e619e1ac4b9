/* The law and its inverse, in lanes. Internal to film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_LAW_H
#define FILM_LANE_LAW_H

#include "lanes/film_lane_power.h"

enum { DEPTH_STEPS = 60 };

/* Clenshaw's summation of two series at once, so that the processor works on one while the other waits for its last step.
 * Missing terms of the shorter series are 0, which leaves its sums 0. */
static void chebyshev_lanes(const film_function *g, const film_function *h, const double *restrict zg,
                            const double *restrict zh, double *restrict a, double *restrict b) {
    double a1[LANES] = {0.0}, a2[LANES] = {0.0}, b1[LANES] = {0.0}, b2[LANES] = {0.0};
    double of_g[FILM_MAX_TERMS + 4] = {0.0}, of_h[FILM_MAX_TERMS + 4] = {0.0};
    memcpy(of_g, g->series, (size_t)g->terms * sizeof *of_g);
    memcpy(of_h, h->series, (size_t)h->terms * sizeof *of_h);
    for (int k = ((g->terms > h->terms ? g->terms : h->terms) + 2) / 4 * 4; k > 0; k -= 4) {
        const double *cg = of_g + k, *ch = of_h + k;
        double g0 = cg[0], g1 = cg[-1], g2 = cg[-2], g3 = cg[-3], h0 = ch[0], h1 = ch[-1], h2 = ch[-2], h3 = ch[-3];
        EACH(l) {
            double z = 2.0 * zg[l], p = z * a1[l] - a2[l] + g0, q = z * p - a1[l] + g1;
            a2[l] = z * q - p + g2;
            a1[l] = z * a2[l] - q + g3;
        }
        EACH(l) {
            double z = 2.0 * zh[l], p = z * b1[l] - b2[l] + h0, q = z * p - b1[l] + h1;
            b2[l] = z * q - p + h2;
            b1[l] = z * b2[l] - q + h3;
        }
    }
    EACH(l) {
        a[l] = zg[l] * a1[l] - a2[l] + of_g[0];
        b[l] = zh[l] * b1[l] - b2[l] + of_h[0];
    }
}

/* The argument of a function: x of a power, z of a series. */
static void variable_lanes(const film_function *g, const double *restrict xi, double *restrict z) {
    EACH(l) {
        double x = (xi[l] - g->origin) * g->per_span;
        z[l] = x > 0.0 ? x : 0.0;
    }
    if (g->form == FILM_ROOT_SERIES) {
        EACH(l) z[l] = sqrt(z[l]);
    }
    if (g->form != FILM_POWER) {
        EACH(l) z[l] = 2.0 * z[l] - 1.0;
    }
}

static void power_value_lanes(const film_function *g, const double *restrict xi, double *restrict out) {
    double x[LANES], power[LANES] = {0.0};
    variable_lanes(g, xi, x);
    if (g->coefficient != 0.0) power_lanes_of(x, g->exponent, power);
    EACH(l) out[l] = g->constant + g->slope * x[l] + g->coefficient * power[l];
    for (int l = 0; l < LANES && g->square != 0.0; l++) out[l] += g->square * (x[l] * x[l]);
}

/* Two functions at once. */
static void value_lanes(const film_function *g, const film_function *h, const double *restrict xi, double *restrict a,
                        double *restrict b) {
    double zg[LANES], zh[LANES], none[LANES];
    int power_g = g->form == FILM_POWER, power_h = h->form == FILM_POWER;
    if (power_g) power_value_lanes(g, xi, a);
    else variable_lanes(g, xi, zg);
    if (power_h) power_value_lanes(h, xi, b);
    else variable_lanes(h, xi, zh);
    if (!power_g && !power_h) chebyshev_lanes(g, h, zg, zh, a, b);
    else if (!power_g) chebyshev_lanes(g, g, zg, zg, a, none);
    else if (!power_h) chebyshev_lanes(h, h, zh, zh, b, none);
}

static void piece_law_lanes(const film_piece *piece, const double *restrict xi, double *restrict force,
                            double *restrict work) {
    const film_function *g = &piece->force;
    if (g->form != FILM_POWER) {
        value_lanes(g, &piece->mean, xi, force, work);
        EACH(l) {
            double x = xi[l] - g->origin;
            work[l] = (x > 0.0 ? x : 0.0) * work[l] - piece->work_at_begin;
        }
        return;
    }
    double x[LANES], power[LANES] = {0.0}, per = work_factor(g->exponent);
    EACH(l) {
        x[l] = xi[l] - g->origin;
        x[l] = x[l] > 0.0 ? x[l] : 0.0;
    }
    if (g->coefficient != 0.0) power_lanes_of(x, g->exponent, power);
    EACH(l) {
        double part = g->coefficient * power[l];
        force[l] = g->constant + g->slope * x[l] + part;
        work[l] = x[l] * (g->constant + 0.5 * g->slope * x[l] + part * per) - piece->work_at_begin;
    }
    if (g->square == 0.0) return;
    EACH(l) {
        force[l] += g->square * (x[l] * x[l]);
        work[l] += g->square * (1.0 / 3) * (x[l] * x[l] * x[l]);
    }
}

/* A series at z, of which each lane has its own terms, by Clenshaw's recurrence. */
static void own_series_lanes(const double (*of)[LANES], int32_t terms, const double *restrict z, double *restrict out) {
    double a1[LANES] = {0.0}, a2[LANES] = {0.0};
    for (int32_t k = terms - 1; k > 0; k--) {
        EACH(l) {
            double a = 2.0 * z[l] * a1[l] - a2[l] + of[k][l];
            a2[l] = a1[l];
            a1[l] = a;
        }
    }
    EACH(l) out[l] = z[l] * a1[l] - a2[l] + of[0][l];
}

/* piece_law_lanes where each lane has its own series. The pieces lie at the same depths. */
static void own_law_lanes(const own_stage *own, const film_piece *first, int32_t p, const double *restrict xi,
                          double *restrict force, double *restrict work) {
    const film_function *g = &first[p].force;
    const double(*column)[LANES] = &own->value[own->piece[p].column];
    double z[LANES], mean[LANES];
    variable_lanes(g, xi, z);
    own_series_lanes(column + 1, own->piece[p].force, z, force);
    own_series_lanes(column + 1 + own->piece[p].force, own->piece[p].mean, z, mean);
    EACH(l) {
        double x = xi[l] - g->origin;
        work[l] = (x > 0.0 ? x : 0.0) * mean[l] - column[0][l];
    }
}

/* The slope of a force that is a series: T_k' = k U_{k-1}, the sum by Clenshaw's recurrence. */
static void slope_lanes(const batch_job *j, int32_t stage, const film_piece *piece, const double *restrict xi,
                        double *restrict slope) {
    const film_function *g = &piece->force;
    int32_t terms = g->terms;
    double(*own)[LANES] = NULL; /* a row for each coefficient */
    double z[LANES], a1[LANES] = {0.0}, a2[LANES] = {0.0};
    if (stage == j->shaped) {
        int32_t p = (int32_t)(piece - &j->curve->piece[j->curve->stage[stage].first]);
        own = &j->own->value[j->own->piece[p].column + 1];
        terms = j->own->piece[p].force;
    }
    variable_lanes(g, xi, z);
    for (int32_t k = terms - 1; k > 0; k--) {
        double of[LANES];
        EACH(l) of[l] = own != NULL ? own[k][l] : g->series[k];
        EACH(l) {
            double a = 2.0 * z[l] * a1[l] - a2[l] + k * of[l];
            a2[l] = a1[l];
            a1[l] = a;
        }
    }
    EACH(l) slope[l] = 2.0 * g->per_span * a1[l];
    if (g->form != FILM_ROOT_SERIES) return;
    EACH(l) { /* over the root: (z + 1)/2 = sqrt x */
        double root = 0.5 * (1.0 + z[l]);
        slope[l] *= 0.5 / (root > 1e-15 ? root : 1e-15);
    }
}

/* Recovery and exponent of a piece of the stage that differs between lanes. */
static void own_unloading_lanes(const own_stage *own, const film_piece *piece, int32_t p, const double *restrict xi,
                                double *restrict recovery, double *restrict exponent) {
    const double(*of)[LANES] = &own->value[own->piece[p].column + 1 + own->piece[p].force + own->piece[p].mean];
    int32_t terms = own->piece[p].recovery, more = own->piece[p].exponent;
    double z[LANES];
    if (terms == 0 || more == 0) value_lanes(&piece->recovery, &piece->exponent, xi, recovery, exponent);
    variable_lanes(&piece->recovery, xi, z);
    if (terms > 0) own_series_lanes(of, terms, z, recovery);
    variable_lanes(&piece->exponent, xi, z);
    if (more > 0) own_series_lanes(of + terms, more, z, exponent);
}

enum { FORCE_AND_WORK, RECOVERY_AND_EXPONENT, SLOPE };

static void piece_lanes(const batch_job *j, int32_t stage, const film_piece *piece, int which, const double *restrict xi,
                        double *restrict a, double *restrict b) {
    const film_piece *first = &j->curve->piece[j->curve->stage[stage].first];
    if (which == RECOVERY_AND_EXPONENT && stage == j->shaped) own_unloading_lanes(j->own, piece, (int32_t)(piece - first), xi, a, b);
    else if (which == RECOVERY_AND_EXPONENT) value_lanes(&piece->recovery, &piece->exponent, xi, a, b);
    else if (which == SLOPE) slope_lanes(j, stage, piece, xi, a), memcpy(b, a, LANES * sizeof *b);
    else if (stage == j->shaped) own_law_lanes(j->own, first, (int32_t)(piece - first), xi, a, b);
    else piece_law_lanes(piece, xi, a, b);
}

/* Pieces of a stage that lanes may be on. */
static int32_t pieces_of(const batch_job *j, int32_t stage) {
    return stage == j->shaped ? j->own->pieces : j->curve->stage[stage].count;
}

/* Where the last of them ends. */
static double reach_of(const batch_job *j, int32_t stage) {
    return stage == j->shaped ? j->own->end : j->curve->stage[stage].end;
}

/* The piece of a stage that holds xi, of those that lanes may be on. */
static const film_piece *lane_piece(const batch_job *j, int32_t stage, double xi) {
    const film_piece *piece = &j->curve->piece[j->curve->stage[stage].first], *last = piece + pieces_of(j, stage) - 1;
    while (piece < last && xi > piece->end) piece++;
    return piece;
}

/* 1 for the lanes that lane_piece puts in this piece of a stage. */
static void lanes_in(const batch_job *j, int32_t stage, const film_piece *piece, const double *restrict xi,
                     double *restrict here) {
    const film_piece *first = &j->curve->piece[j->curve->stage[stage].first];
    const film_piece *last = first + pieces_of(j, stage) - 1;
    double from = piece == first ? 0.0 : piece[-1].end, to = piece == last ? INFINITY : piece->end;
    double below = piece == first ? 1.0 : 0.0;
    EACH(l) {
        here[l] = xi[l] > from ? 1.0 : below;
        here[l] = xi[l] > to ? 0.0 : here[l];
    }
}

/* Two functions of a stage, each lane on its own piece. */
static void stage_lanes(const batch_job *j, int32_t stage, int which, const double *restrict xi,
                        double *restrict a, double *restrict b) {
    const film_piece *piece = lane_piece(j, stage, xi[0]);
    double done[LANES], here[LANES], one[LANES], two[LANES];
    piece_lanes(j, stage, piece, which, xi, a, b);
    if (j->curve->stage[stage].count == 1) return;
    lanes_in(j, stage, piece, xi, done);
    for (int l = 1; l < LANES; l++) {
        if (done[l] > 0.0) continue;
        piece = lane_piece(j, stage, xi[l]);
        piece_lanes(j, stage, piece, which, xi, one, two);
        lanes_in(j, stage, piece, xi, here);
        EACH(k) {
            done[k] = here[k] > 0.0 ? 1.0 : done[k];
            a[k] = here[k] > 0.0 ? one[k] : a[k];
            b[k] = here[k] > 0.0 ? two[k] : b[k];
        }
    }
}

static void law_lanes(const batch_job *j, int32_t stage, const double *restrict xi, double *restrict force,
                      double *restrict work) {
    const film_stage *own = &j->curve->stage[stage];
    if (own->count == 1 && stage != j->shaped) piece_law_lanes(&j->curve->piece[own->first], xi, force, work);
    else stage_lanes(j, stage, FORCE_AND_WORK, xi, force, work);
}

/* The work of as much of a stage as lanes may be on. */
static void whole_lanes(const batch_job *j, int32_t stage, double *restrict whole) {
    EACH(l) whole[l] = stage == j->shaped ? j->own->whole[l] : j->whole[stage];
}

/* The x at which the work of a rising power since x = 0 is `work`: steps of third order, from the x of the constant and the
 * linear part, of the square and of the power, whose inverses are summed as squares: at most 15 % off. Where the force begins below 0
 * (c < 0, s = 0), from beyond: by the x at which its mean is 0, x^q k/(q + 1) + c = 0, more than that of the power. */
INLINED void power_depths(const film_function *g, int squared, const double *restrict work, double *restrict x) {
    double c = g->constant, s = g->slope, b = g->square, k = g->coefficient, q = g->exponent, per = work_factor(q);
    double power[LANES], inverse[LANES], moving[LANES];
    EACH(l) inverse[l] = (c + sqrt(c * c + 2.0 * s * work[l])) / (2.0 * work[l]);
    if (squared) {
        EACH(l) power[l] = work[l] * (3.0 / b);
        rough_power_lanes(power, -1.0 / 3, x);
        EACH(l) inverse[l] = sqrt(inverse[l] * inverse[l] + x[l] * x[l]);
    }
    if (k == 0.0 && !squared) {
        EACH(l) x[l] = 1.0 / inverse[l];
        return;
    }
    EACH(l) power[l] = work[l] * (1.0 / (k * per));
    if (k == 0.0) memset(x, 0, LANES * sizeof *x);
    else rough_power_lanes(power, -per, x);
    double balance[LANES] = {0.0};
    if (c < 0.0) {
        EACH(l) power[l] = -c / (k * per);
        EACH(l) moving[l] = 1.0 / q;
        power_lanes(power, moving, balance);
    }
    EACH(l) {
        x[l] = balance[l] + 1.0 / sqrt(x[l] * x[l] + inverse[l] * inverse[l]);
        moving[l] = 1.0;
    }
    for (int i = 0; i < DEPTH_STEPS && any(moving); i++) {
        power_lanes_of(x, q, power);
        EACH(l) {
            double part = k * power[l], line = s * x[l], square = b * (x[l] * x[l]), force = c + line + part;
            double mean = c + 0.5 * line + part * per, rise = line + q * part;
            if (squared) force += square, mean += square * (1.0 / 3), rise += 2.0 * square;
            double per_work = 1.0 / (force * x[l]), missing = work[l] - x[l] * mean;
            double e = missing * per_work, bend = rise * x[l] * per_work;
            x[l] = moving[l] > 0.0 ? x[l] + x[l] * (e * (1.0 - 0.5 * bend * e)) : x[l];
            moving[l] = fabs(e) > 1e-6 ? moving[l] : 0.0;
        }
    }
}

static void power_depth_lanes(const film_function *g, const double *restrict work, double *restrict x) {
    if (g->square > 0.0) power_depths(g, 1, work, x);
    else power_depths(g, 0, work, x);
}

/* Depths that are sought between low and high, in lanes that are still moving. */
typedef struct {
    double low[LANES], high[LANES], moving[LANES];
} bracket;

/* To the depths `next`, or to the middle of the bracket if that is left: low where work is `missing`. A lane rests after a step
 * below `close`, as a part of its depth, or below rounding if its bracket was halved. */
INLINED void move_in_bracket(bracket *b, const double *restrict missing, const double *restrict next, double close,
                             double *restrict depth) {
    EACH(l) {
        double at = depth[l];
        b->low[l] = missing[l] >= 0.0 ? at : b->low[l];
        b->high[l] = missing[l] >= 0.0 ? b->high[l] : at;
        double near = next[l] >= b->low[l] ? close : 4e-16, halved = 0.5 * (b->low[l] + b->high[l]);
        near = next[l] <= b->high[l] ? near : 4e-16;
        double to = near > 1e-12 ? next[l] : halved;
        depth[l] = b->moving[l] > 0.0 ? to : at;
        b->moving[l] = fabs(to - at) <= near * at ? 0.0 : b->moving[l];
    }
}

/* The depth at which the work of a stage is `work` > 0, which must not exceed that of whole_lanes. Where the force is no rising
 * power, by Newton's method in a bracket. */
static void depth_lanes(const batch_job *j, int32_t stage, const double *restrict work, double *restrict depth) {
    const film_piece *piece = &j->curve->piece[j->curve->stage[stage].first];
    double begin = j->curve->stage[stage].begin, end = reach_of(j, stage), f[LANES], w[LANES], whole[LANES];
    double missing[LANES], next[LANES];
    bracket b;
    if (stage != j->shaped && force_rises(j->curve, stage)) {
        EACH(l) w[l] = work[l] + piece->work_at_begin;
        power_depth_lanes(&piece->force, w, depth);
        EACH(l) depth[l] += piece->force.origin;
        return;
    }
    whole_lanes(j, stage, whole);
    EACH(l) {
        depth[l] = begin + (end - begin) * sqrt(work[l] / whole[l]); /* as if work grew as a square */
        b.moving[l] = 1.0;
        b.low[l] = begin;
        b.high[l] = end;
    }
    for (int i = 0; i < DEPTH_STEPS && any(b.moving); i++) {
        law_lanes(j, stage, depth, f, w);
        EACH(l) {
            missing[l] = work[l] - w[l];
            next[l] = depth[l] + missing[l] / f[l];
        }
        move_in_bracket(&b, missing, next, 1e-9, depth);
    }
}

/* The unloading rule for lanes that turned at xi under `force` in `stage`, which is not reversible: length and exponent of
 * the branch. The caller refuses a length that is not positive. */
static void open_lanes(const batch_job *j, int32_t stage, const double *restrict xi, const double *restrict force,
                       double *restrict recovery, double *restrict exponent) {
    double given[LANES], load[LANES], e[LANES];
    const film_curve *curve = j->curve;
    stage_lanes(j, stage, RECOVERY_AND_EXPONENT, xi, given, exponent);
    if (curve->stage[stage].unloading == FILM_RESIDUAL) {
        EACH(l) recovery[l] = xi[l] - given[l];
        return;
    }
    if (curve->stage[stage].unloading == FILM_SECANT) {
        EACH(l) {
            double r = force[l] / given[l];
            recovery[l] = r < xi[l] ? r : xi[l];
        }
        return;
    }
    EACH(l) {
        load[l] = force[l] / sqrt(given[l]);
        e[l] = 1.0 / exponent[l];
    }
    if (j->exponent[stage] == 1.5) two_thirds_lanes(load, recovery);
    else power_lanes(load, e, recovery);
}

#endif
