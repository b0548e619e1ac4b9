/* Blocks of impacts on fixed targets, each in series with a spring of its own: energy gives the velocity for every
 * indentation, v^2/2 = E - W - c f^2/2, so that only the turn needs the inverse of the law; times are integrals of (1 + c
 * f')/v, by Gauss's rule. Internal to film_lanes.c. docs/method.md, sections 8 and 10. */
#ifndef FILM_LANE_SPRING_H
#define FILM_LANE_SPRING_H

#include "lanes/film_lane_fixed.h"

/* Impacts in series. work: of the contact since the stage that turns them began; left: energy that was left there; turned,
 * ended: times; bad > 0: left to film_marched, because force and spring may snap through. */
typedef struct {
    double spring[LANES], left[LANES], turned[LANES], ended[LANES], bad[LANES];
    double xi[LANES], force[LANES], work[LANES], slope[LANES], recovery[LANES], exponent[LANES];
    double stored, peak; /* work and largest force of the stages before */
} spring_block;

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
        double x = xi[l] - g->origin, power = f[l] - g->constant - g->slope * x;
        slope[l] = g->slope + (x > 0.0 ? g->exponent * power / x : 0.0);
    }
}

/* Across a whole piece, by Gauss's rule on the way to where force and slope at its end would stop the motion, beyond it, so
 * that no root lies near the end. */
static void cross_in_series(const batch_job *j, int32_t stage, int32_t p, spring_block *b) {
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
static void depth_in_series(const batch_job *j, int32_t stage, int32_t p, double begin, spring_block *b) {
    int power = stage != j->shaped && force_rises(j->curve, stage);
    double end = stage == j->shaped ? j->own->end : j->curve->piece[p].end;
    double low[LANES], high[LANES], f[LANES], w[LANES], slope[LANES], moving[LANES], first[LANES], e[LANES];
    if (power) {
        const film_function *g = &j->curve->piece[p].force;
        EACH(l) w[l] = b->left[l] + j->curve->piece[p].work_at_begin;
        power_depth_lanes(g, w, high);
        law_and_slope_lanes(j, stage, p, high, f, w, slope);
        EACH(l) {
            high[l] += g->origin;
            first[l] = b->left[l] / (b->left[l] + 0.5 * b->spring[l] * f[l] * f[l]);
            e[l] = 0.5 / g->exponent;
        }
        power_lanes(first, e, w);
        EACH(l) b->xi[l] = begin + (high[l] - begin) * w[l];
    } else {
        double at[LANES];
        EACH(l) at[l] = begin;
        law_and_slope_lanes(j, stage, p, at, f, first, slope);
        EACH(l) {
            first[l] += 0.5 * b->spring[l] * f[l] * f[l];
            at[l] = high[l] = end;
        }
        law_and_slope_lanes(j, stage, p, at, f, w, slope);
        EACH(l) {
            double whole = w[l] + 0.5 * b->spring[l] * f[l] * f[l], share = (b->left[l] - first[l]) / (whole - first[l]);
            b->xi[l] = begin + (end - begin) * (share > 0.0 ? sqrt(share) : 0.0);
        }
    }
    EACH(l) {
        low[l] = begin;
        moving[l] = 1.0;
    }
    for (int i = 0; i < DEPTH_STEPS && any(moving); i++) {
        law_and_slope_lanes(j, stage, p, b->xi, f, w, slope);
        EACH(l) {
            double c = b->spring[l], at = b->xi[l], missing = b->left[l] - w[l] - 0.5 * c * f[l] * f[l];
            low[l] = missing >= 0.0 ? at : low[l];
            high[l] = missing >= 0.0 ? high[l] : at;
            double next = at + missing / (f[l] * (1.0 + c * slope[l])), halved = 0.5 * (low[l] + high[l]);
            double near = next >= low[l] ? 1e-9 : 4e-16;
            near = next <= high[l] ? near : 4e-16;
            next = near > 1e-12 ? next : halved;
            b->xi[l] = moving[l] > 0.0 ? next : at;
            moving[l] = fabs(next - at) <= near * at ? 0.0 : moving[l];
        }
    }
    law_and_slope_lanes(j, stage, p, b->xi, b->force, b->work, b->slope);
}

/* From the beginning of piece p, or of a stage that differs between impacts, to the turn. */
static void turn_in_series(const batch_job *j, int32_t stage, int32_t p, double begin, spring_block *b) {
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
static void leave_in_series(const batch_job *j, int32_t stage, spring_block *b) {
    double at[LANES], power[LANES], sum[LANES] = {0.0};
    if (j->curve->stage[stage].unloading == FILM_RETRACE) {
        EACH(l) {
            b->ended[l] = 2.0 * b->turned[l];
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
    EACH(l) b->ended[l] = b->turned[l] + sum[l] / sqrt(2.0 * b->force[l]);
}

/* A block of impacts that turn in piece p of `stage`, from first touch to the end of contact. */
static void spring_lanes(batch_job *j, int32_t stage, int32_t p, const int64_t *index, int count) {
    spring_block b;
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
    int retraced = j->curve->stage[stage].unloading == FILM_RETRACE;
    for (int l = 0; l < count; l++) {
        film_summary *s = &j->summary[index[l]];
        double work = b.stored + b.work[l], given = retraced ? work : b.force[l] * b.recovery[l] / (b.exponent[l] + 1.0);
        s->maximum_force = b.force[l] > b.peak ? b.force[l] : b.peak;
        s->maximum_indentation = b.xi[l];
        s->time_of_maximum_indentation = s->time_impactor_stops = b.turned[l];
        s->contact_duration = b.ended[l];
        s->permanent_indentation = b.xi[l] - b.recovery[l];
        s->final_velocity = -sqrt(2.0 * given + b.spring[l] * b.force[l] * b.force[l]);
        s->shift = 0.0;
        s->work = work - given;
        s->stage = stage;
        s->lines = j->rule.count * (stage + 1);
        int whole = b.recovery[l] > SHORTEST_RECOVERY * b.xi[l] && b.ended[l] < INFINITY && s->final_velocity > -INFINITY;
        whole = whole && b.xi[l] - begin > SHORT_LEG * b.xi[l] && !(b.bad[l] > 0.0);
        if (whole) j->status[index[l]] = FILM_EVENT;
        else leave_alone(j, index[l]);
    }
}

#endif
