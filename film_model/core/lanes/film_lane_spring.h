/* Blocks of impacts on fixed targets, each in series with a spring of its own: energy gives the velocity for every
 * indentation, v^2/2 = E - W - c f^2/2, so that only the turn needs the inverse of the law; times are integrals of (1 + c
 * f')/v, by Gauss's rule. Internal to film_lanes.c. docs/method.md, sections 8 and 10. */
#ifndef FILM_LANE_SPRING_H
#define FILM_LANE_SPRING_H

#include "lanes/film_lane_fixed.h"

/* Force, work and slope in piece p of a stage; in a stage that differs between impacts each lane on its own piece. */
static void law_and_slope_lanes(const batch_job *j, int32_t stage, int32_t p, const double *restrict xi, double *restrict f,
                                double *restrict w, double *restrict slope) {
    const film_piece *piece = &j->curve->piece[p];
    const film_function *g = &piece->force;
    double same[LANES];
    if (stage == j->shaped) {
        stage_lanes(j, stage, FORCE_AND_WORK, xi, f, w);
        stage_lanes(j, stage, SLOPE, xi, slope, same);
        return;
    }
    piece_law_lanes(piece, xi, f, w);
    if (g->form != FILM_POWER) {
        piece_lanes(j, stage, piece, SLOPE, xi, slope, same);
        return;
    }
    EACH(l) { /* of the force, so that no second power is needed */
        double x = xi[l] - g->origin, power = f[l] - plain_part(g, x);
        slope[l] = g->slope + 2.0 * g->square * x + (x > 0.0 ? g->exponent * power / x : 0.0);
    }
}

/* Across a whole piece, by Gauss's rule on the way to where force and slope at its end would stop the motion, beyond it, so
 * that no root lies near the end. */
static void cross_in_series(const batch_job *j, int32_t stage, int32_t p, fixed_block *b) {
    fixed_piece own = piece_of(j, stage, p);
    double length = j->curve->piece[p].end - own.begin, force = j->piece_force[p], slope = slope_at(&j->curve->piece[p].force, j->curve->piece[p].end);
    double left[LANES], ratio[LANES], over[LANES], x[LANES], f[LANES], w[LANES], rise[LANES], sum[LANES] = {0.0};
    EACH(l) {
        double c = b->spring[l], by = 1.0 + c * slope, bend = slope * by + c * slope * slope, end = force * by;
        left[l] = b->left[l] - j->piece_work[p] - 0.5 * c * force * force;
        left[l] = left[l] > 0.0 ? left[l] : 0.0;
        double way = end + sqrt(end * end + (bend > 0.0 ? 2.0 * bend * left[l] : 0.0));
        ratio[l] = length * way / (length * way + 2.0 * left[l]);
        over[l] = 1.0 / (1.0 + sqrt(1.0 - ratio[l]));
    }
    for (int32_t i = 0; i < j->rule.count; i++) {
        double s = j->rule.at[i], weight = j->rule.across[i];
        EACH(l) x[l] = own.begin + length * (over[l] * s * s * (2.0 - ratio[l] * over[l] * s * s));
        law_and_slope_lanes(j, stage, p, x, f, w, rise);
        EACH(l) {
            double c = b->spring[l], by = 1.0 + c * rise[l], part = 1.0 - ratio[l] * over[l] * s * s;
            double square = left[l] + (j->piece_work[p] - w[l]) + 0.5 * c * (force - f[l]) * (force + f[l]);
            sum[l] += weight * part * by / sqrt(2.0 * square);
            b->bad[l] = by > 0.0 ? b->bad[l] : 1.0;
        }
    }
    EACH(l) b->turned[l] += length * over[l] * sum[l];
    b->peak = force > b->peak ? force : b->peak;
}

/* The indentation in piece p of `stage`, or anywhere in a stage that differs between impacts, at which contact and spring have
 * taken up b->left: Newton's method in a bracket, from where the work alone would turn the impact, or as if energy grew as a
 * square. */
static void depth_in_series(const batch_job *j, int32_t stage, int32_t p, double begin, fixed_block *b) {
    int power = stage != j->shaped && force_rises(j->curve, stage);
    double end = stage == j->shaped ? j->own->end : j->curve->piece[p].end;
    double f[LANES], w[LANES], slope[LANES], first[LANES], e[LANES], missing[LANES], next[LANES];
    bracket in;
    if (power) {
        const film_function *g = &j->curve->piece[p].force;
        EACH(l) w[l] = b->left[l] + j->curve->piece[p].work_at_begin;
        power_depth_lanes(g, w, in.high);
        law_and_slope_lanes(j, stage, p, in.high, f, w, slope);
        EACH(l) {
            in.high[l] += g->origin;
            first[l] = b->left[l] / (b->left[l] + 0.5 * b->spring[l] * f[l] * f[l]);
            e[l] = 0.5 / g->exponent;
        }
        power_lanes(first, e, w);
        EACH(l) b->xi[l] = begin + (in.high[l] - begin) * w[l];
    } else {
        double at[LANES];
        EACH(l) at[l] = begin;
        law_and_slope_lanes(j, stage, p, at, f, first, slope);
        EACH(l) {
            first[l] += 0.5 * b->spring[l] * f[l] * f[l];
            at[l] = in.high[l] = end;
        }
        law_and_slope_lanes(j, stage, p, at, f, w, slope);
        EACH(l) {
            double whole = w[l] + 0.5 * b->spring[l] * f[l] * f[l], share = (b->left[l] - first[l]) / (whole - first[l]);
            b->xi[l] = begin + (end - begin) * (share > 0.0 ? sqrt(share) : 0.0);
        }
    }
    EACH(l) {
        in.low[l] = begin;
        in.moving[l] = 1.0;
    }
    for (int i = 0; i < DEPTH_STEPS && any(in.moving); i++) {
        law_and_slope_lanes(j, stage, p, b->xi, f, w, slope);
        EACH(l) {
            double c = b->spring[l];
            missing[l] = b->left[l] - w[l] - 0.5 * c * f[l] * f[l];
            next[l] = b->xi[l] + missing[l] / (f[l] * (1.0 + c * slope[l]));
        }
        move_in_bracket(&in, missing, next, 1e-9, b->xi);
    }
    law_and_slope_lanes(j, stage, p, b->xi, b->force, b->work, b->slope);
}

/* From the beginning of piece p, or of a stage that differs between impacts, to the turn. */
static void turn_in_series(const batch_job *j, int32_t stage, int32_t p, double begin, fixed_block *b) {
    double x[LANES], f[LANES], w[LANES], rise[LANES], length[LANES], sum[LANES] = {0.0};
    EACH(l) length[l] = b->xi[l] - begin;
    for (int32_t i = 0; i < j->rule.count; i++) {
        double rest = j->rule.rest[i], weight = j->rule.weight[i];
        EACH(l) x[l] = b->xi[l] - length[l] * rest;
        law_and_slope_lanes(j, stage, p, x, f, w, rise);
        EACH(l) {
            double c = b->spring[l], by = 1.0 + c * rise[l];
            double left = b->work[l] - w[l] + 0.5 * c * (b->force[l] - f[l]) * (b->force[l] + f[l]);
            double least = 1e-3 * b->force[l] * length[l] * rest; /* against rounding on a short way */
            sum[l] += weight * by / sqrt(2.0 * (left > least ? left : least));
            b->bad[l] = by > 0.0 ? b->bad[l] : 1.0;
        }
    }
    EACH(l) b->turned[l] += length[l] * sum[l];
}

/* Out from the turn: along a power of the recovery, or along a reversible law, which takes as long as the way in. */
static void leave_in_series(const batch_job *j, int32_t stage, fixed_block *b) {
    double at[LANES], power[LANES], sum[LANES] = {0.0};
    if (j->curve->stage[stage].unloading == FILM_RETRACE) {
        EACH(l) {
            b->ended[l] = 2.0 * b->turned[l];
            b->given[l] = b->stored + b->work[l];
            b->recovery[l] = b->xi[l];
        }
        return;
    }
    open_lanes(j, stage, b->xi, b->force, b->recovery, b->exponent);
    for (int32_t i = 0; i < j->rule.count; i++) {
        double u = 1.0 - j->rule.rest[i], weight = j->rule.weight[i];
        EACH(l) at[l] = u;
        if (j->exponent[stage] == j->exponent[stage]) power_lanes_of(at, j->exponent[stage], power);
        else power_lanes(at, b->exponent, power);
        EACH(l) {
            double q = b->exponent[l], own = b->recovery[l], bent = b->spring[l] * b->force[l];
            double given = own * (1.0 - u * power[l]) / (q + 1.0) + 0.5 * bent * (1.0 - power[l] * power[l]);
            sum[l] += weight * (own + bent * q * (power[l] / u)) / sqrt(given);
        }
    }
    EACH(l) {
        b->ended[l] = b->turned[l] + sum[l] / sqrt(2.0 * b->force[l]);
        b->given[l] = b->force[l] * b->recovery[l] / (b->exponent[l] + 1.0);
    }
}

/* A block of impacts that turn in piece p of `stage`, from first touch to the end of contact. */
static void spring_lanes(batch_job *j, int32_t stage, int32_t p, const int64_t *index, int count) {
    fixed_block b;
    double last[LANES];
    memset(&b, 0, sizeof b);
    EACH(l) {
        int64_t i = index[l < count ? l : 0]; /* an incomplete block is filled up with its first impact */
        b.spring[l] = j->spring[i];
        b.left[l] = 0.5 * j->start[i].nu * j->start[i].nu;
    }
    if (stage == j->shaped) p = j->curve->stage[stage].first;
    for (int32_t k = 0; k <= stage; k++) {
        int32_t first = j->curve->stage[k].first, end = k < stage ? first + j->curve->stage[k].count : p;
        for (int32_t i = first; i < end; i++) cross_in_series(j, k, i, &b);
        if (k == stage) break;
        b.stored += j->whole[k];
        EACH(l) b.left[l] -= j->whole[k];
    }
    double begin = piece_of(j, stage, p).begin;
    depth_in_series(j, stage, p, begin, &b);
    turn_in_series(j, stage, p, begin, &b);
    leave_in_series(j, stage, &b);
    EACH(l) last[l] = -sqrt(2.0 * b.given[l] + b.spring[l] * b.force[l] * b.force[l]);
    put_turned(j, stage, begin, index, count, &b, b.turned, last);
}

#endif
