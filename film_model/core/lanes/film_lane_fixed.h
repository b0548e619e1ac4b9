/* Blocks of impacts on fixed targets: energy gives the turn, the dent and all velocities; times are integrals of 1/velocity,
 * by Gauss's rule. Internal to film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_FIXED_H
#define FILM_LANE_FIXED_H

#include "lanes/film_lane_cross.h"

static const double HERTZ_REST = 1.6453408471595659; /* rest_time(1.5) */

/* Time of a run from rest, or to the turn, over x^q from 1 to 0: sqrt(pi (q + 1)/2) R(y) with y = 1/(q + 1) and
 * R = Gamma(1 + y)/Gamma(1/2 + y), by its asymptotic series at y + 12; rounding for 0 <= y <= 1. */
INLINED double rest_time(double q) {
    double y = 1.0 / (q + 1.0), over = 1.0, under = 1.0, w = y + 12.25, z = 1.0 / (w * w);
    for (int k = 0; k < 12; k++) {
        over *= y + (k + 0.5);
        under *= y + (k + 1.0);
    }
    double high = 631.0 / 524288 + z * (-174317.0 / 134217728 + z * (20491783.0 / 8589934592.0));
    double sum = 1.0 + z * (1.0 / 64 + z * (-19.0 / 8192 + z * high));
    return over / under * sum * sqrt(1.5707963267948966 * (q + 1.0) * w);
}

/* To the turn at xi in a stage of one power from its beginning on: constant, linear and power part scale with the length. */
static void run_power_to_turn(const batch_job *j, int32_t stage, const double *restrict xi, double *restrict time) {
    const film_function *g = &j->curve->piece[j->curve->stage[stage].first].force;
    double begin = j->curve->stage[stage].begin, per = 2.0 * work_factor(g->exponent);
    double length[LANES], flat[LANES], linear[LANES], power[LANES], sum[LANES] = {0.0}, of_power[MOST_POINTS];
    const gauss_rule *rule = &j->rule;
    for (int32_t i = 0; i < rule->count; i++) of_power[i] = 1.0 - (1.0 - rule->rest[i]) * power_of(1.0 - rule->rest[i], g->exponent);
    EACH(l) length[l] = xi[l] - begin;
    power_lanes_of(length, g->exponent, power);
    EACH(l) {
        flat[l] = 2.0 * g->constant * length[l];
        linear[l] = g->slope * length[l] * length[l];
        power[l] *= per * g->coefficient * length[l];
    }
    for (int32_t i = 0; i < rule->count; i++) {
        double rest = rule->rest[i], line = rest * (2.0 - rest), curve = of_power[i], weight = rule->weight[i];
        EACH(l) sum[l] += weight / sqrt(flat[l] * rest + linear[l] * line + power[l] * curve);
    }
    EACH(l) time[l] += length[l] * sum[l];
}

/* To the turn at xi in any other stage, from the beginning of a piece: the law at every point. */
static void run_law_to_turn(const batch_job *j, int32_t stage, int32_t p, double begin, const double *restrict xi,
                            const double *restrict force, const double *restrict work, double *restrict time) {
    double x[PLACES], w[PLACES], none[LANES], length[LANES], sum[LANES] = {0.0};
    const gauss_rule *rule = &j->rule;
    EACH(l) length[l] = xi[l] - begin;
    for (int32_t i = 0; i < rule->count; i++) {
        int32_t at = i % (PLACES / LANES);
        for (int k = 0; k < PLACES && at == 0; k++) x[k] = xi[k % LANES] - length[k % LANES] * rule->rest[i + k / LANES];
        if (stage == j->shaped) law_lanes(j, stage, x, none, w);
        else if (at == 0) works_at(&j->curve->piece[p], x, w);
        EACH(l) {
            double rest = rule->rest[i], left = work[l] - w[at + l];
            double least = 1e-3 * force[l] * length[l] * rest; /* against rounding on a short way */
            sum[l] += rule->weight[i] / sqrt(2.0 * (left > least ? left : least));
        }
    }
    EACH(l) time[l] += length[l] * sum[l];
}

/* The depth at which the work of a stage is `work`, in a piece that ends: steps of third order in a bracket, from the depth on
 * a line that does the work of the piece and meets the force at its end. The slope is that of this line, then between the last
 * two places: so that after a step of 3e-7 of the depth only rounding is left. */
static void depth_in_piece(const batch_job *j, int32_t p, const fixed_piece *own, const double *restrict work,
                           double *restrict depth) {
    const film_piece *piece = &j->curve->piece[p];
    double length = piece->end - own->begin, at_end = j->piece_force[p], line = 2.0 * (at_end - own->whole / length) / length;
    double before[LANES], at[LANES], f[LANES], w[LANES], slope[LANES], missing[LANES], next[LANES];
    bracket b;
    EACH(l) {
        double rest = own->before + own->whole - work[l], square = at_end * at_end - 2.0 * line * rest;
        depth[l] = piece->end - 2.0 * rest / (at_end + sqrt(square > 0.0 ? square : 0.0));
        slope[l] = line;
        b.moving[l] = 1.0;
        b.low[l] = own->begin;
        b.high[l] = piece->end;
    }
    for (int i = 0; i < DEPTH_STEPS && any(b.moving); i++) {
        piece_law_lanes(piece, depth, f, w);
        EACH(l) {
            missing[l] = work[l] - w[l];
            double newton = missing[l] / f[l];
            if (i > 0) slope[l] = b.moving[l] > 0.0 ? (f[l] - before[l]) / (depth[l] - at[l]) : slope[l];
            next[l] = depth[l] + newton * (1.0 - 0.5 * slope[l] * newton / f[l]);
            at[l] = depth[l];
            before[l] = f[l];
        }
        move_in_bracket(&b, missing, next, 3e-7, depth);
    }
}

/* Impacts on a fixed target: the turn, and what the way out gives. turned, ended: times; given: work given back. Of impacts in
 * series with a spring also energy left where the stage that turns them began, and slope at the turn; bad > 0: left to
 * film_marched, because force and spring may snap through. */
typedef struct {
    double xi[LANES], force[LANES], work[LANES], turned[LANES];
    double recovery[LANES], exponent[LANES], given[LANES], ended[LANES];
    double spring[LANES], left[LANES], slope[LANES], bad[LANES];
    double stored, peak; /* work and largest force of the stages before */
} fixed_block;

/* The summaries of a block; begin: where the piece, or the stage, that turned it begins. */
static void put_turned(const batch_job *j, int32_t stage, double begin, const int64_t *index, int count, const fixed_block *b,
                       const double *restrict stopped, const double *restrict last) {
    for (int l = 0; l < count; l++) {
        film_summary *s = &j->summary[index[l]];
        s->maximum_force = b->force[l] > b->peak ? b->force[l] : b->peak;
        s->maximum_indentation = b->xi[l];
        s->time_of_maximum_indentation = b->turned[l];
        s->time_impactor_stops = stopped[l];
        s->contact_duration = b->ended[l];
        s->permanent_indentation = b->xi[l] - b->recovery[l];
        s->final_velocity = last[l];
        s->shift = 0.0;
        s->work = b->stored + b->work[l] - b->given[l];
        s->stage = stage;
        s->lines = j->rule.count * (stage + 1);
        int whole = b->recovery[l] > SHORTEST_RECOVERY * b->xi[l] && b->ended[l] < INFINITY && last[l] > -INFINITY;
        whole = whole && b->xi[l] - begin > SHORT_LEG * b->xi[l] && !(b->bad[l] > 0.0);
        if (whole) j->status[index[l]] = FILM_EVENT;
        else leave_alone(j, index[l]);
    }
}

/* Through the pieces before, then to the turn in piece p of `stage`; in a stage that differs between impacts, from its
 * beginning. */
static void load_fixed(batch_job *j, int32_t stage, int32_t p, const double *restrict nu, fixed_block *b) {
    double v[LANES], square[LANES], work[LANES];
    if (stage == j->shaped) p = j->curve->stage[stage].first;
    fixed_piece last = piece_of(j, stage, p);
    b->stored = b->peak = 0.0;
    EACH(l) {
        v[l] = nu[l];
        square[l] = nu[l] * nu[l];
        b->turned[l] = 0.0;
    }
    for (int32_t k = 0; k <= stage; k++) {
        int32_t first = j->curve->stage[k].first, end = k < stage ? first + j->curve->stage[k].count : p;
        for (int32_t i = first; i < end; i++) {
            fixed_piece own = piece_of(j, k, i);
            if (has_way_in(j, k)) cross_by_power(&own, j->curve->piece[i].end - own.begin, square, v, b->turned);
            else if (LANES == 1) cross_by_rule(j, i, &own, square, v, b->turned);
            else cross_piece(j, i, &own, square, v, b->turned);
            if (j->piece_force[i] > b->peak) b->peak = j->piece_force[i];
        }
        if (k < stage) b->stored += j->whole[k];
    }
    EACH(l) work[l] = last.before + (square[l] > 1e-300 ? 0.5 * square[l] : 5e-301);
    if (stage == j->shaped || force_rises(j->curve, stage)) {
        depth_lanes(j, stage, work, b->xi);
        law_lanes(j, stage, b->xi, b->force, b->work);
    } else {
        depth_in_piece(j, p, &last, work, b->xi);
        piece_law_lanes(&j->curve->piece[p], b->xi, b->force, b->work);
    }
    if (plain_power(j, stage)) {
        double q = j->curve->piece[0].force.exponent, rest = q == 1.5 ? HERTZ_REST : rest_time(q);
        EACH(l) b->turned[l] = rest * sqrt(b->xi[l] / b->force[l]);
    } else if (j->simple[stage]) {
        run_power_to_turn(j, stage, b->xi, b->turned);
    } else {
        run_law_to_turn(j, stage, p, last.begin, b->xi, b->force, b->work, b->turned);
    }
}

/* Out along the branches that lead back from the turn, or along a reversible law, which takes as long as the way in. */
static void unload_fixed(const batch_job *j, int32_t stage, fixed_block *b) {
    double rest[LANES];
    if (j->curve->stage[stage].unloading == FILM_RETRACE) {
        EACH(l) {
            b->ended[l] = 2.0 * b->turned[l];
            b->given[l] = b->stored + b->work[l];
            b->recovery[l] = b->xi[l];
        }
        return;
    }
    open_lanes(j, stage, b->xi, b->force, b->recovery, b->exponent);
    if (j->exponent[stage] == j->exponent[stage]) {
        double same = j->exponent[stage] == 1.5 ? HERTZ_REST : rest_time(j->exponent[stage]);
        EACH(l) rest[l] = same;
    } else {
        EACH(l) rest[l] = rest_time(b->exponent[l]);
    }
    EACH(l) {
        b->ended[l] = b->turned[l] + rest[l] * sqrt(b->recovery[l] / b->force[l]);
        b->given[l] = b->force[l] * b->recovery[l] / (b->exponent[l] + 1.0);
    }
}

static const double SMALL_SHARE = 1e-4; /* of the work, at which four powers of it leave rounding */

/* When impactors stop on their branch, on which the share z = 1 - u^(q + 1) of the work is given back at the part u of the
 * recovery: at the speed sqrt(2 z given), NAN beyond the end. The integral of 1/velocity, by Gauss's rule; where z is small, and
 * 1 - u rounding, that of 1/force over the velocity, by powers of z. */
static void stop_fixed(const batch_job *j, const double *restrict stop, const fixed_block *b, double *restrict stopped) {
    double share[LANES], kept[LANES], at[LANES], e[LANES], power[LANES], length[LANES], sum[LANES] = {0.0};
    EACH(l) {
        share[l] = 0.5 * stop[l] * stop[l] / b->given[l];
        kept[l] = share[l] < 1.0 ? 1.0 - share[l] : 0.0;
        e[l] = 1.0 / (b->exponent[l] + 1.0);
    }
    power_lanes(kept, e, at);
    EACH(l) {
        length[l] = 1.0 - at[l];
        e[l] = b->exponent[l] + 1.0;
    }
    for (int32_t i = 0; i < j->rule.count; i++) {
        double rest = j->rule.rest[i], weight = j->rule.weight[i];
        EACH(l) at[l] = 1.0 - length[l] * rest;
        power_lanes(at, e, power);
        EACH(l) {
            double given = 1.0 - power[l], least = length[l] * rest; /* against rounding on a short way */
            sum[l] += weight / sqrt(2.0 * b->given[l] * (given > least ? given : least));
        }
    }
    EACH(l) {
        double q = b->exponent[l] / e[l], z = share[l];
        double early = -stop[l] / b->force[l] * (1.0 + z * q * (1.0 / 3.0 + z * (q + 1.0) * (0.1 + z * (q + 2.0) * (1.0 / 42.0))));
        double time = z < SMALL_SHARE ? early : b->recovery[l] * length[l] * sum[l];
        stopped[l] = kept[l] > 0.0 ? b->turned[l] + time : NAN;
    }
}

/* A block of impacts that turn in piece p of `stage`, from first touch to the end of contact. */
static void fixed_lanes(batch_job *j, int32_t stage, int32_t p, const int64_t *index, int count) {
    fixed_block b;
    double nu[LANES], last[LANES], stop[LANES], stopped[LANES];
    EACH(l) {
        const film_start *start = &j->start[index[l < count ? l : 0]]; /* an incomplete block is filled up with its first impact */
        nu[l] = start->nu;
        stop[l] = start->stop_velocity < 0.0 ? start->stop_velocity : 0.0;
        b.bad[l] = 0.0;
    }
    load_fixed(j, stage, p, nu, &b);
    unload_fixed(j, stage, &b);
    EACH(l) stopped[l] = b.turned[l];
    if (any(stop)) stop_fixed(j, stop, &b, stopped);
    EACH(l) last[l] = -sqrt(2.0 * b.given[l]);
    put_turned(j, stage, j->curve->stage[stage].begin, index, count, &b, stopped, last);
}

#endif
