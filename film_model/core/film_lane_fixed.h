/* Blocks of impacts on fixed targets, by energy. Internal to film_lanes.c. docs/method.md, sections 3 and 10. */
#ifndef FILM_LANE_FIXED_H
#define FILM_LANE_FIXED_H

#include "film_lane_line.h"

/* Time across a line over 2h: A/S, A = atan(sqrt z)/sqrt z, z = kappa (h/S)^2, S = v0 + v1, as a [3/3] Pade
 * approximant in z without a division of its own: 7e-12 off at z = 0.1, rounding below 0.03. bend: kappa h^2. */
INLINED double crossing(double sum, double bend) {
    double s = sum * sum, b = bend * bend;
    double over = s * (s * (s + (50.0 / 39) * bend) + (283.0 / 715) * b) + (256.0 / 15015) * (b * bend);
    double under = s * (s * (s + (21.0 / 13) * bend) + (105.0 / 143) * b) + (35.0 / 429) * (b * bend);
    return over / (sum * under);
}

/* Across the whole of a stage, whose lines are the same for every impact. */
static void cross_stage(batch_job *j, int32_t stage, int32_t segments, const double *nodes, double *restrict v,
                        double *restrict time, double *restrict peak) {
    const line_table *t = film_lines_of(j, stage, 1, segments, nodes, 0.0);
    double square[LANES];
    EACH(l) square[l] = v[l] * v[l];
    for (int32_t i = 1; i <= segments; i++) {
        const table_row *r = &t->rows[i];
        double spent = r->work, twice = 2.0 * r->h, bend = r->kappa * r->h * r->h;
        EACH(l) {
            double left = square[l] - spent, v1 = sqrt(left > 0.0 ? left : 0.0);
            time[l] += twice * crossing(v[l] + v1, bend);
            v[l] = v1;
        }
    }
    EACH(l) peak[l] = t->peak > peak[l] ? t->peak : peak[l];
}

/* run_to_turn on a stage of one power from its beginning on: constant, linear and power part scale with the length each. */
static void run_power_to_turn(batch_job *j, int32_t stage, int32_t segments, const double *nodes, const double *restrict v,
                              const double *restrict xi, double *restrict time) {
    const film_function *g = &j->curve->piece[j->curve->stage[stage].first].force;
    const table_row *r = film_lines_of(j, UNIT_POWER, 1, segments, nodes, g->exponent)->rows;
    double begin = j->curve->stage[stage].begin, v0[LANES], length[LANES];
    double flat[LANES], linear[LANES], power[LANES], sum[LANES] = {0.0};
    EACH(l) {
        v0[l] = v[l];
        length[l] = xi[l] - begin;
    }
    power_lanes_of(length, g->exponent, power);
    EACH(l) {
        flat[l] = 2.0 * g->constant * length[l];
        linear[l] = g->slope * length[l] * length[l];
        power[l] *= g->coefficient * length[l];
    }
    for (int32_t i = 1; i <= segments; i++) {
        double x = r[i].x, h = r[i].h, left1 = 1.0 - x, left2 = 1.0 - x * x, left3 = r[i].work, hh = h * h;
        double bent = r[i].kappa * hh;
        EACH(l) {
            double v1 = sqrt(flat[l] * left1 + linear[l] * left2 + power[l] * left3);
            sum[l] += h * crossing(v0[l] + v1, linear[l] * hh + power[l] * bent);
            v0[l] = v1;
        }
    }
    EACH(l) time[l] += 2.0 * length[l] * sum[l];
}

/* run_to_turn on any other stage: the law at every node. */
static void run_law_to_turn(const batch_job *j, int32_t stage, int32_t segments, const double *nodes,
                            const double *restrict v, const double *restrict xi, const double *restrict force,
                            const double *restrict work, double *restrict time, double *restrict peak) {
    double begin = j->curve->stage[stage].begin, v0[LANES], x0[LANES], f0[LANES], w0[LANES];
    EACH(l) {
        v0[l] = v[l];
        x0[l] = begin;
    }
    law_lanes(j, stage, x0, f0, w0);
    for (int32_t i = 1; i <= segments; i++) {
        double x1[LANES], f1[LANES], w1[LANES], fraction = nodes[i];
        EACH(l) {
            x1[l] = i < segments ? begin + (xi[l] - begin) * fraction : xi[l];
            f1[l] = force[l];
            w1[l] = work[l];
        }
        if (i < segments) law_lanes(j, stage, x1, f1, w1);
        EACH(l) {
            double h = x1[l] - x0[l], per_h = 1.0 / h, mean = (w1[l] - w0[l]) * per_h, left = v[l] * v[l] - 2.0 * w1[l];
            double bend = i < segments ? (f1[l] - f0[l]) * h : 2.0 * (f1[l] - mean) * h;
            double v1 = i < segments ? sqrt(left > 0.0 ? left : 0.0) : 0.0;
            time[l] += 2.0 * h * crossing(v0[l] + v1, bend);
            peak[l] = f1[l] > peak[l] ? f1[l] : peak[l];
            x0[l] = x1[l];
            f0[l] = f1[l];
            w0[l] = w1[l];
            v0[l] = v1;
        }
    }
}

/* From the beginning of the stage, at v, to the turn at xi, where the law is force and work. */
static void run_to_turn(batch_job *j, int32_t stage, int32_t segments, const double *nodes, const double *restrict v,
                        const double *restrict xi, const double *restrict force, const double *restrict work,
                        double *restrict time, double *restrict peak) {
    if (plain_power(j, stage)) {
        double rest = film_rest_time(film_lines_of(j, UNIT_POWER, 1, segments, nodes, j->curve->piece[0].force.exponent));
        EACH(l) time[l] += rest * sqrt(xi[l] / force[l]);
    } else if (j->simple[stage]) {
        run_power_to_turn(j, stage, segments, nodes, v, xi, time);
    } else {
        run_law_to_turn(j, stage, segments, nodes, v, xi, force, work, time, peak);
    }
    EACH(l) peak[l] = force[l] > peak[l] ? force[l] : peak[l];
}

/* Time of a run from rest over x^exponent, from 1 to 0, where the exponent is each lane's own. */
static void run_from_rest(const film_mesh *mesh, const double *restrict exponent, double *restrict time) {
    double u0[LANES], f0[LANES], w0[LANES], v0[LANES], u1[LANES], f1[LANES];
    EACH(l) {
        u0[l] = f0[l] = 1.0;
        w0[l] = 1.0 / (exponent[l] + 1.0);
        v0[l] = time[l] = 0.0;
    }
    for (int32_t i = 1; i <= mesh->unloading; i++) {
        double u = i < mesh->unloading ? 1.0 - mesh->unloading_nodes[FILM_COSINE][i] : 0.0;
        EACH(l) u1[l] = u;
        power_lanes(u1, exponent, f1);
        EACH(l) {
            double h = u0[l] - u, per = 1.0 / (exponent[l] + 1.0), w1 = f1[l] * u * per, mean = (w0[l] - w1) / h;
            double v1 = sqrt(2.0 * (per - w1)), bend = i > 1 ? (f0[l] - f1[l]) * h : 2.0 * (f0[l] - mean) * h;
            time[l] += 2.0 * h * crossing(v0[l] + v1, bend);
            u0[l] = u;
            f0[l] = f1[l];
            w0[l] = w1;
            v0[l] = v1;
        }
    }
}

/* Impacts on a fixed target: the turn, and what the way out gives. */
typedef struct {
    double nu[LANES], xi[LANES], force[LANES], work[LANES], peak[LANES], turned[LANES]; /* turned: time of the turn */
    double recovery[LANES], given[LANES], ended[LANES], left[LANES]; /* given: work given back; left: dent */
    double stored;                                                   /* work of the stages before */
    int32_t lines;
} fixed_block;

/* Through the stages before, then to the turn in `stage`. */
static void load_fixed(batch_job *j, int32_t stage, fixed_block *b) {
    int32_t n = j->mesh->loading;
    const double *nodes = j->mesh->loading_nodes[FILM_COSINE];
    double v[LANES], energy[LANES];
    EACH(l) {
        v[l] = b->nu[l];
        b->turned[l] = b->peak[l] = 0.0;
    }
    b->stored = 0.0;
    b->lines = n * (stage + 1);
    for (int32_t k = 0; k < stage; k++) {
        cross_stage(j, k, n, nodes, v, b->turned, b->peak);
        b->stored += j->whole[k];
    }
    EACH(l) energy[l] = 0.5 * v[l] * v[l];
    depth_lanes(j, stage, energy, b->xi);
    law_lanes(j, stage, b->xi, b->force, b->work);
    run_to_turn(j, stage, n, nodes, v, b->xi, b->force, b->work, b->turned, b->peak);
}

/* Out along the branches that lead back from the turn. */
static void unload_fixed(batch_job *j, int32_t stage, fixed_block *b) {
    int32_t m = j->mesh->unloading;
    double exponent[LANES], time[LANES];
    open_lanes(j, stage, b->xi, b->force, b->recovery, exponent);
    if (j->exponent[stage] == j->exponent[stage]) {
        const double *nodes = j->mesh->unloading_nodes[FILM_COSINE];
        double rest = film_rest_time(film_lines_of(j, UNIT_POWER, 1, m, nodes, j->exponent[stage]));
        EACH(l) time[l] = rest;
    } else {
        run_from_rest(j->mesh, exponent, time);
    }
    EACH(l) {
        b->ended[l] = b->turned[l] + time[l] * sqrt(b->recovery[l] / b->force[l]);
        b->given[l] = b->force[l] * b->recovery[l] / (exponent[l] + 1.0);
        b->left[l] = b->xi[l] - b->recovery[l];
    }
    b->lines += m;
}

/* Back along a reversible law: the same lines the other way round, and the same time if they are as many. */
static void retrace_fixed(batch_job *j, int32_t stage, fixed_block *b) {
    int32_t n = j->mesh->loading, m = j->mesh->unloading;
    const double *nodes = j->mesh->unloading_nodes[FILM_COSINE];
    double v[LANES], back[LANES] = {0.0}, peak[LANES] = {0.0};
    EACH(l) v[l] = b->nu[l];
    if (n != m) {
        for (int32_t k = 0; k < stage; k++) cross_stage(j, k, m, nodes, v, back, peak);
        run_to_turn(j, stage, m, nodes, v, b->xi, b->force, b->work, back, peak);
    }
    EACH(l) {
        b->ended[l] = b->turned[l] + (n == m ? b->turned[l] : back[l]);
        b->given[l] = b->stored + b->work[l];
        b->left[l] = 0.0;
        b->recovery[l] = b->xi[l];
    }
    b->lines += m * (stage + 1);
}

/* A block of impacts that turn in `stage`, from first touch to the end of contact. */
static void fixed_lanes(batch_job *j, int32_t stage, const int64_t *index, int count) {
    fixed_block b;
    EACH(l) b.nu[l] = j->start[index[l < count ? l : 0]].nu; /* an incomplete block is filled up with its first impact */
    load_fixed(j, stage, &b);
    if (j->curve->stage[stage].unloading != FILM_RETRACE) unload_fixed(j, stage, &b);
    else retrace_fixed(j, stage, &b);
    for (int l = 0; l < count; l++) {
        film_summary *s = &j->summary[index[l]];
        double last = -sqrt(2.0 * b.given[l]);
        s->maximum_force = b.peak[l];
        s->maximum_indentation = b.xi[l];
        s->time_of_maximum_indentation = s->time_impactor_stops = b.turned[l];
        s->contact_duration = b.ended[l];
        s->permanent_indentation = b.left[l];
        s->final_velocity = last;
        s->shift = 0.0;
        s->work = b.stored + b.work[l] - b.given[l];
        s->stage = stage;
        s->lines = b.lines;
        int whole = b.recovery[l] > SHORTEST_RECOVERY * b.xi[l] && b.ended[l] < INFINITY && last > -INFINITY;
        whole = whole && b.xi[l] - j->curve->stage[stage].begin > SHORT_LEG * b.xi[l];
        if (whole) j->status[index[l]] = FILM_EVENT;
        else leave_alone(j, index[l]);
    }
}

#endif
