/* Blocks of impacts on targets that move, to the turn. Internal to film_lanes.c. docs/method.md, sections 5 and 10. */
#ifndef FILM_LANE_LOAD_H
#define FILM_LANE_LOAD_H

#include "lanes/film_lane_line.h"
#include "lanes/film_lane_taylor.h"

enum { AIM_STEPS = 8 };
static const double AIM_TOLERANCE = 5e-3; /* fraction of the energy: less than the error of turn_excess. Affects cost only */

/* Along a loading stage towards aim, up to the node before it. nodes NULL: those of a trial. */
static void run_towards(batch_job *j, int32_t stage, int32_t segments, const double *nodes, const double *restrict aim,
                        lanes *restrict s) {
    const film_curve *curve = j->curve;
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    double begin = curve->stage[stage].begin, x1[LANES], f1[LANES], w1[LANES];
    lines n;
    const table_row *r = film_lines_of(j, UNIT_POWER, 1, segments, nodes, j->simple[stage] ? g->exponent : ANY_POWER)->rows;
    if (j->simple[stage]) {
        double span[LANES], power[LANES], stiff[LANES], c = g->constant, k = g->slope;
        EACH(l) span[l] = aim[l] - begin;
        power_lanes_of(span, g->exponent, power);
        EACH(l) {
            power[l] *= g->coefficient;
            stiff[l] = power[l] / span[l];
        }
        for (int32_t i = 1; i < segments; i++) {
            double x = r[i - 1].x, h = r[i].h, kappa = r[i].kappa, phi = r[i].phi;
            EACH(l) {
                n.h[l] = span[l] * h;
                n.kappa[l] = k + stiff[l] * kappa;
                n.phi[l] = c + k * (span[l] * x) + power[l] * phi;
            }
            pass_inwards(s, &n);
        }
        EACH(l) s->xi[l] = begin + span[l] * r[segments - 1].x;
        law_lanes(j, stage, s->xi, s->force, s->work);
        return;
    }
    for (int32_t i = 1; i < segments; i++) {
        EACH(l) x1[l] = begin + (aim[l] - begin) * r[i].x;
        law_lanes(j, stage, x1, f1, w1);
        make_lines(s, &n, 1.0, 0, x1, f1, w1);
        pass_inwards(s, &n);
    }
}

/* The turn near x1: the last line meets the law's force at x1. The time is that at which nu = gamma f of the true law, by
 * Newton's method from tau or, where it is not known, from a step of Halley's at the line's beginning: with the line's force
 * instead, the time of the turn would err by gamma f'' h^2/(12 f). docs/method.md, section 5. */
static void turn_near(batch_job *j, int32_t stage, const double *restrict x1, lanes *restrict s, int known, int steps,
                       double *restrict tau) {
    double phi[LANES], kappa[LANES], y0[LANES], d1[LANES], a2[LANES], x[LANES], y[LANES], f1[LANES], w1[LANES];
    double w[LANES], miss[LANES];
    law_lanes(j, stage, x1, f1, w1);
    EACH(l) {
        double g = s->gamma[l], h = x1[l] - s->xi[l], mean = (w1[l] - s->work[l]) / h;
        phi[l] = 2.0 * mean - f1[l];
        kappa[l] = 2.0 * (f1[l] - mean) / h;
        a2[l] = g * kappa[l];
        y0[l] = s->w[l] - g * phi[l];
        d1[l] = -(phi[l] - s->load[l]) - a2[l] * y0[l];
        double d2 = -a2[l] * d1[l] - kappa[l] * y0[l];
        tau[l] = known ? tau[l] : 2.0 * y0[l] * d1[l] / (y0[l] * d2 - 2.0 * d1[l] * d1[l]);
    }
    for (int i = 0; i <= steps; i++) {
        polynomials(y0, d1, a2, kappa, tau, x, y, miss);
        EACH(l) {
            w[l] = y[l] + s->gamma[l] * (phi[l] + kappa[l] * x[l]);
            x[l] += s->xi[l];
        }
        law_lanes(j, stage, x, f1, w1);
        if (i == steps) break;
        /* gamma f falls by a2 y, as on the line */
        EACH(l) tau[l] += (w[l] - s->gamma[l] * f1[l]) / (f1[l] - s->load[l] + a2[l] * y[l]);
    }
    EACH(l) {
        double g = s->gamma[l], bad = fabs(w[l] - g * f1[l]) < 1e-9 * (w[l] + y0[l]) ? miss[l] : 1.0;
        bad = y0[l] > 0.0 ? bad : 1.0;
        s->bad[l] = tau[l] > 0.0 ? s->bad[l] + bad : 1.0;
        s->time[l] += tau[l];
        s->xi[l] = x[l];
        s->force[l] = f1[l];
        s->work[l] = w1[l];
        s->w[l] = g * f1[l];
    }
}

/* A depth in `stage` beyond the turn of impacts with the relative velocity y at its beginning, or the stage's end: that on a
 * fixed target or, under a force that does not fall, that under the force f0 at the beginning alone. */
static void beyond_turn(batch_job *j, int32_t stage, const double *restrict y, double f0, double *restrict high) {
    double begin = j->curve->stage[stage].begin, end = reach_of(j, stage), energy[LANES], whole[LANES];
    if (stage != j->shaped && f0 > 0.0 && (force_rises(j->curve, stage) || j->end_force[stage] >= f0)) {
        EACH(l) {
            double reach = begin + 0.5 * y[l] * y[l] / f0;
            high[l] = reach < end ? reach : end;
        }
        return;
    }
    whole_lanes(j, stage, whole);
    EACH(l) {
        energy[l] = 0.5 * y[l] * y[l];
        energy[l] = energy[l] < whole[l] ? energy[l] : whole[l];
    }
    depth_lanes(j, stage, energy, high);
}

/* How far impacts go under a force that rises from f0 along one line of slope kappa: by energy, with two thirds of the drag that
 * the first velocity y would cause. */
INLINED double reach_on_line(double f0, double kappa, double gamma, double y) {
    double resisting = f0 + (2.0 / 3) * gamma * kappa * y, square = resisting * resisting + kappa * y * y;
    return y * y / (resisting + sqrt(square > 0.0 ? square : 0.0));
}

/* About where the impacts turn that are at the beginning of `stage`, within 2 % on Hertz's law: the root of turn_excess in what
 * is left of the relative velocity and what the force grows by. First as if work grew as a square; then one line to there; then
 * false position, the value at the older end halved. */
static void first_aim(batch_job *j, int32_t stage, const lanes *restrict s, double *restrict aim) {
    double begin = j->curve->stage[stage].begin, y[LANES], energy[LANES], guess[LANES], f[LANES], w[LANES], moving[LANES];
    double low[LANES], high[LANES], below[LANES], above[LANES];
    EACH(l) {
        double left = s->w[l] - s->gamma[l] * s->force[l];
        y[l] = left > 0.0 ? left : 0.0;
        energy[l] = 0.5 * y[l] * y[l];
    }
    beyond_turn(j, stage, y, s->force[0], high);
    law_lanes(j, stage, high, f, w);
    EACH(l) {
        double far = high[l] - begin, kappa = (f[l] - s->force[l]) / far;
        low[l] = begin;
        below[l] = -energy[l];
        above[l] = turn_excess(w[l], f[l] - s->force[l], y[l], s->gamma[l]);
        aim[l] = high[l];
        moving[l] = above[l] > 0.0 ? 1.0 : 0.0;
        guess[l] = w[l] > 2.0 * energy[l] ? far * sqrt(energy[l] / w[l]) : reach_on_line(s->force[l], kappa, s->gamma[l], y[l]);
    }
    for (int i = 0; i < AIM_STEPS && any(moving); i++) {
        EACH(l) {
            double next = low[l] - (high[l] - low[l]) * below[l] / (above[l] - below[l]), guessed = begin + guess[l];
            next = i < 2 && guessed > low[l] && guessed < high[l] ? guessed : next;
            aim[l] = moving[l] > 0.0 ? next : aim[l];
        }
        law_lanes(j, stage, aim, f, w);
        EACH(l) {
            double excess = turn_excess(w[l], f[l] - s->force[l], y[l], s->gamma[l]);
            high[l] = excess > 0.0 ? aim[l] : high[l];
            low[l] = excess > 0.0 ? low[l] : aim[l];
            below[l] = excess > 0.0 ? 0.5 * below[l] : excess;
            above[l] = excess > 0.0 ? excess : 0.5 * above[l];
            guess[l] = reach_on_line(s->force[l], (f[l] - s->force[l]) / (aim[l] - begin), s->gamma[l], y[l]);
            moving[l] = fabs(excess) < AIM_TOLERANCE * energy[l] ? 0.0 : moving[l];
        }
    }
}

/* All lanes at first touch; an incomplete block is filled up with its first impact. */
static void start_lanes(const batch_job *j, const int64_t *index, int count, lanes *restrict s, double *restrict nu) {
    EACH(l) {
        const film_start *start = &j->start[index[l < count ? l : 0]];
        s->gamma[l] = start->gamma;
        s->load[l] = start->load;
        s->w[l] = nu[l] = start->nu;
        s->time[l] = 0.0;
        s->bad[l] = 0.0;
    }
}

/* Across the whole of stage k by lines, to its end. Returns the largest force. */
static double cross_by_lines(batch_job *j, int32_t k, lanes *restrict s) {
    const line_table *whole = film_lines_of(j, k, 1, j->mesh->loading, j->mesh->loading_nodes[FILM_PLATE_IN], 0.0);
    lines n;
    for (int32_t i = 1; i <= j->mesh->loading; i++) {
        EACH(l) {
            n.h[l] = whole->rows[i].h;
            n.kappa[l] = whole->rows[i].kappa;
            n.phi[l] = whole->rows[i].phi;
        }
        pass_inwards(s, &n);
    }
    return whole->peak;
}

/* Across the whole stages before `stage`, to its beginning. Returns their work; *largest: their largest force. */
static double cross_before(batch_job *j, int32_t stage, lanes *restrict s, double *largest) {
    double stored = 0.0;
    for (int32_t k = j->touch; k < stage; k++) {
        double peak = cross_by_lines(j, k, s);
        stored += j->whole[k];
        *largest = peak > *largest ? peak : *largest;
    }
    EACH(l) s->xi[l] = j->curve->stage[stage].begin;
    law_lanes(j, stage, s->xi, s->force, s->work);
    return stored;
}

/* Aims at the turn in `stage`: an estimate, then trial legs of 4, 16 ... segments, each aimed by the one before.
 * docs/method.md, section 5. */
static void aim_lanes(batch_job *j, int32_t stage, const lanes *restrict s, double *restrict aim) {
    double end = reach_of(j, stage), tau[LANES];
    first_aim(j, stage, s, aim);
    int32_t first = stage > 0 && j->mesh->loading < 2 * AIMING_SEGMENTS ? AIMING_SEGMENTS / 2 : AIMING_SEGMENTS;
    for (int32_t m = first; m == first || 3 * m <= j->mesh->loading; m *= 4) {
        lanes trial = *s;
        run_towards(j, stage, m, NULL, aim, &trial);
        turn_near(j, stage, aim, &trial, 0, 1, tau);
        EACH(l) { /* a trial only places the nodes, so a rough one is left alone */
            double to = trial.xi[l] < end ? trial.xi[l] : end;
            aim[l] = fabs(trial.xi[l] - aim[l]) < 0.1 * aim[l] ? to : aim[l];
        }
    }
}

/* Along `stage` to the turn near `aim`. Lanes whose turn is too far from their aim are bad. */
static void run_to_aim(batch_job *j, int32_t stage, double *restrict aim, lanes *restrict s) {
    double end = reach_of(j, stage), last[LANES], tau[LANES];
    run_towards(j, stage, j->mesh->loading, j->mesh->loading_nodes[FILM_PLATE_IN], aim, s);
    EACH(l) last[l] = s->xi[l];
    lanes trial = *s;
    turn_near(j, stage, aim, &trial, 0, 1, tau);
    EACH(l) {
        s->bad[l] = fabs(trial.xi[l] - aim[l]) < aim[l] - last[l] ? s->bad[l] : 1.0;
        aim[l] = trial.xi[l] < end ? trial.xi[l] : end;
    }
    turn_near(j, stage, aim, s, 1, 3, tau);
    EACH(l) {
        s->bad[l] = s->xi[l] <= end ? s->bad[l] : 1.0;
        s->bad[l] = fabs(s->xi[l] - aim[l]) < 0.1 * (s->xi[l] - last[l]) ? s->bad[l] : 1.0;
    }
}

/* To the turn in `stage`, by lines or by powers. Returns the work of the stages before; *largest: their largest force. */
static double load_by_lines(batch_job *j, int32_t stage, turned_lanes *restrict t, double *largest) {
    double aim[LANES], stored = cross_before(j, stage, &t->at, largest);
    int32_t legs = stage - j->touch;
    if (turns_by_powers(j, stage)) {
        run_by_powers(j, stage, &t->at);
    } else {
        aim_lanes(j, stage, &t->at, aim);
        run_to_aim(j, stage, aim, &t->at);
        legs++;
    }
    EACH(l) t->lines[l] = (double)j->mesh->loading * legs;
    return stored;
}

/* To the turn on a power law of exponent 3/2, by film_way_in. A fixed target would turn the impactor at the depth X that energy
 * gives. beyond: 1 for the lanes beyond the table. */
static void load_by_table(const batch_job *j, const double *restrict nu, turned_lanes *restrict t, double *restrict beyond) {
    double k = j->curve->piece[0].force.coefficient, power[LANES], e[LANES], x[LANES], number[LANES], way[LANES][4];
    lanes *restrict s = &t->at;
    EACH(l) {
        power[l] = 1.25 * (nu[l] * nu[l]) / k;
        e[l] = 0.4;
    }
    power_lanes(power, e, x);
    EACH(l) {
        double r = x[l];
        x[l] = r + 0.4 * r * (power[l] / (r * r * sqrt(r)) - 1.0); /* power_lanes errs by some ulps */
        number[l] = s->gamma[l] * k * x[l] * sqrt(x[l]) / nu[l];
        beyond[l] = number[l] < MAP_END ? 0.0 : 1.0;
    }
    map_lanes(film_way_in, FILM_WAY_IN_TERMS, FILM_WAY_IN_VALUES, number, way);
    EACH(l) {
        double depth = x[l] * way[l][0];
        s->time[l] = x[l] / nu[l] * way[l][1];
        s->xi[l] = depth;
        s->force[l] = k * (depth * sqrt(depth));
        s->work[l] = 0.4 * s->force[l] * depth;
        s->w[l] = s->gamma[l] * s->force[l];
        s->bad[l] = depth <= j->curve->stage[0].end ? 0.0 : 1.0;
        t->lines[l] = 0.0;
    }
}

/* Marches the lanes beyond the table. */
static void load_beyond(batch_job *j, const int64_t *index, int count, turned_lanes *restrict t,
                        const double *restrict beyond) {
    turned_lanes by_lines;
    double largest = 0.0, again[LANES];
    start_lanes(j, index, count, &by_lines.at, again);
    load_by_lines(j, 0, &by_lines, &largest);
    EACH(l) {
        int lined = beyond[l] > 0.0;
        t->at.time[l] = lined ? by_lines.at.time[l] : t->at.time[l];
        t->at.xi[l] = lined ? by_lines.at.xi[l] : t->at.xi[l];
        t->at.force[l] = lined ? by_lines.at.force[l] : t->at.force[l];
        t->at.work[l] = lined ? by_lines.at.work[l] : t->at.work[l];
        t->at.w[l] = lined ? by_lines.at.w[l] : t->at.w[l];
        t->at.bad[l] = lined ? by_lines.at.bad[l] : t->at.bad[l];
        t->lines[l] = lined ? by_lines.lines[l] : t->lines[l];
    }
}

/* A block of impacts that should turn in `stage`, from first touch to the turn, and the branches from there. */
static void load_lanes(batch_job *j, int32_t stage, const int64_t *index, int count, turned_lanes *restrict t) {
    lanes *restrict s = &t->at;
    double nu[LANES], beyond[LANES], largest = 0.0, stored = 0.0;
    start_lanes(j, index, count, s, nu);
    if (has_way_in(j, stage)) {
        load_by_table(j, nu, t, beyond);
        if (any(beyond)) load_beyond(j, index, count, t, beyond);
    } else {
        stored = load_by_lines(j, stage, t, &largest);
    }
    double exponent = plain_power(j, stage) ? j->exponent[stage] : 1.0; /* 1: retraced, not used */
    EACH(l) {
        t->stored[l] = stored + s->work[l];
        t->peak[l] = s->force[l] > largest ? s->force[l] : largest;
        t->recovery[l] = s->xi[l];
        t->exponent[l] = exponent;
    }
    int rule = j->curve->stage[stage].unloading;
    if (rule != FILM_RETRACE && rule != FILM_SIMILAR)
        open_lanes(j, stage, s->xi, s->force, t->recovery, t->exponent);
    EACH(l) {
        s->bad[l] = t->recovery[l] > SHORTEST_RECOVERY * s->xi[l] ? s->bad[l] : 1.0;
        s->bad[l] = t->exponent[l] > 0.0 ? s->bad[l] : 1.0;
        t->slowness[l] = s->gamma[l] * sqrt(s->force[l] / t->recovery[l]);
    }
}

#endif
