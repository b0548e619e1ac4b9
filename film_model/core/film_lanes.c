/* Runs of blocks of impacts, side by side in lanes: see film_batch.h. film_avx2.c and film_avx512.c compile it too. */
#include "film_lane_line.h"

#ifndef FILM_ROUTINES
#define FILM_ROUTINES film_plain
#endif

enum { AIM_STEPS = 8 };
static const double SHORT_WAY_OUT = 1e-4; /* of the way that is left: a shorter one's mean force is rounding */
static const double AIM = 5e-3; /* of the energy: closer than the formula for it */
static const double HERTZ_AIM = 1e-5; /* of the depth: what its formula leaves */

/* ---------------------------------------------------------------- fixed targets, side by side */

/* Time across a line over 2h: A/S, A = atan(sqrt z)/sqrt z, z = kappa (h/S)^2, S = v0 + v1, as a [3/3] Pade
 * approximant in z without a division of its own: 7e-12 off at z = 0.1, rounding below 0.03. bend: kappa h^2. */
INLINED double crossing(double sum, double bend) {
    double s = sum * sum, b = bend * bend;
    double over = s * (s * (s + (50.0 / 39) * bend) + (283.0 / 715) * b) + (256.0 / 15015) * (b * bend);
    double under = s * (s * (s + (21.0 / 13) * bend) + (105.0 / 143) * b) + (35.0 / 429) * (b * bend);
    return over / (sum * under);
}

static void cross_stage(job *j, int32_t stage, int32_t segments, const double *nodes, double *restrict v,
                        double *restrict time, double *restrict peak) {
    const table *t = film_lines_of(j, stage, 1, segments, nodes, 0.0);
    double square[LANES];
    EACH(l) square[l] = v[l] * v[l];
    for (int32_t i = 1; i <= segments; i++) {
        const row *r = &t->rows[i];
        double spent = r->work, twice = 2.0 * r->h, bend = r->kappa * r->h * r->h;
        EACH(l) {
            double left = square[l] - spent, v1 = sqrt(left > 0.0 ? left : 0.0);
            time[l] += twice * crossing(v[l] + v1, bend);
            v[l] = v1;
        }
    }
    EACH(l) peak[l] = t->peak > peak[l] ? t->peak : peak[l];
}

/* From the beginning of the stage, at v, to the turn at xi, where the law is force and work, by energy. */
static void run_to_turn(job *j, int32_t stage, int32_t segments, const double *nodes, const double *restrict v,
                        const double *restrict xi, const double *restrict force, const double *restrict work,
                        double *restrict time, double *restrict peak) {
    const film_curve *curve = j->curve;
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    double begin = curve->stage[stage].begin, v0[LANES], x0[LANES], f0[LANES], w0[LANES];
    if (plain_power(j, stage)) { /* one run, scaled */
        double rest = film_lines_of(j, UNIT_POWER, 1, segments, nodes, g->exponent)->rest;
        EACH(l) time[l] += rest * sqrt(xi[l] / force[l]);
        EACH(l) peak[l] = force[l] > peak[l] ? force[l] : peak[l];
        return;
    }
    EACH(l) v0[l] = v[l];
    if (j->simple[stage]) {
        const row *r = film_lines_of(j, UNIT_POWER, 1, segments, nodes, g->exponent)->rows;
        double flat[LANES], linear[LANES], power[LANES], sum[LANES] = {0.0};
        EACH(l) x0[l] = xi[l] - begin;
        raised_lanes(x0, g->exponent, power);
        EACH(l) {
            flat[l] = 2.0 * g->constant * x0[l];
            linear[l] = g->slope * x0[l] * x0[l];
            power[l] *= g->coefficient * x0[l];
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
        EACH(l) {
            time[l] += 2.0 * x0[l] * sum[l];
            peak[l] = force[l] > peak[l] ? force[l] : peak[l];
        }
        return;
    }
    double first_force, first_work;
    stage_law(curve, stage, begin, &first_force, &first_work);
    EACH(l) {
        x0[l] = begin;
        f0[l] = first_force;
        w0[l] = first_work;
    }
    for (int32_t i = 1; i <= segments; i++) {
        double x1[LANES], f1[LANES], w1[LANES], fraction = nodes[i];
        EACH(l) {
            x1[l] = i < segments ? begin + (xi[l] - begin) * fraction : xi[l];
            f1[l] = force[l];
            w1[l] = work[l];
        }
        if (i < segments) law_lanes(curve, stage, x1, f1, w1);
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

/* A block of impacts that turn in `stage`, from first touch to the end of contact. */
static void fixed_lanes(job *j, int32_t stage, const int64_t *index, int count) {
    const film_curve *curve = j->curve;
    const film_mesh *mesh = j->mesh;
    const double *in = mesh->loading_nodes[FILM_COSINE], *out = mesh->unloading_nodes[FILM_COSINE];
    int32_t n = mesh->loading, m = mesh->unloading, drawn = n * (stage + 1);
    double nu[LANES], v[LANES], energy[LANES], xi[LANES], force[LANES], work[LANES], recovery[LANES], given[LANES];
    double turned[LANES] = {0.0}, peak[LANES] = {0.0}, ended[LANES], left[LANES], stored = 0.0;
    EACH(l) v[l] = nu[l] = j->start[index[l < count ? l : 0]].nu;
    for (int32_t k = 0; k < stage; k++) {
        cross_stage(j, k, n, in, v, turned, peak);
        stored += j->whole[k];
    }
    EACH(l) energy[l] = 0.5 * v[l] * v[l];
    depth_lanes(curve, stage, j->whole[stage], energy, xi);
    law_lanes(curve, stage, xi, force, work);
    run_to_turn(j, stage, n, in, v, xi, force, work, turned, peak);
    if (curve->stage[stage].unloading != FILM_RETRACE) {
        double exponent[LANES], time[LANES];
        open_lanes(curve, stage, xi, force, recovery, exponent);
        if (j->exponent[stage] == j->exponent[stage]) {
            double rest = film_lines_of(j, UNIT_POWER, 1, m, out, j->exponent[stage])->rest;
            EACH(l) time[l] = rest;
        } else {
            run_from_rest(mesh, exponent, time);
        }
        EACH(l) {
            ended[l] = turned[l] + time[l] * sqrt(recovery[l] / force[l]);
            given[l] = force[l] * recovery[l] / (exponent[l] + 1.0);
            left[l] = xi[l] - recovery[l];
        }
        drawn += m;
    } else { /* the same lines the other way round, if they are as many */
        double back[LANES] = {0.0}, peak_again[LANES] = {0.0};
        EACH(l) v[l] = nu[l];
        if (n != m) {
            for (int32_t k = 0; k < stage; k++) cross_stage(j, k, m, out, v, back, peak_again);
            run_to_turn(j, stage, m, out, v, xi, force, work, back, peak_again);
        }
        EACH(l) {
            ended[l] = turned[l] + (n == m ? turned[l] : back[l]);
            given[l] = stored + work[l];
            left[l] = 0.0;
            recovery[l] = xi[l];
        }
        drawn += m * (stage + 1);
    }
    for (int l = 0; l < count; l++) {
        film_summary *s = &j->summary[index[l]];
        double last = -sqrt(2.0 * given[l]);
        s->maximum_force = peak[l];
        s->maximum_indentation = xi[l];
        s->time_of_maximum_indentation = s->time_impactor_stops = turned[l];
        s->contact_duration = ended[l];
        s->permanent_indentation = left[l];
        s->final_velocity = last;
        s->shift = 0.0;
        s->work = stored + work[l] - given[l];
        s->stage = stage;
        s->lines = drawn;
        int whole = recovery[l] > SHORTEST_RECOVERY * xi[l] && ended[l] < INFINITY && last > -INFINITY;
        whole = whole && xi[l] - curve->stage[stage].begin > SHORT_LEG * xi[l];
        j->status[index[l]] = whole ? FILM_EVENT : film_impact(curve, mesh, &j->start[index[l]], s);
    }
}

/* ---------------------------------------------------------------- targets that give way, side by side */

/* Along a loading stage towards aim, up to the node before it. nodes NULL: a trial. */
static void run_towards(job *j, int32_t stage, int32_t segments, const double *nodes, const double *restrict aim,
                        lanes *restrict s) {
    const film_curve *curve = j->curve;
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    double begin = curve->stage[stage].begin, x1[LANES], f1[LANES], w1[LANES];
    lines n;
    const row *r = film_lines_of(j, UNIT_POWER, 1, segments, nodes, j->simple[stage] ? g->exponent : ANY_POWER)->rows;
    if (j->simple[stage]) {
        double span[LANES], power[LANES], stiff[LANES], c = g->constant, k = g->slope;
        EACH(l) span[l] = aim[l] - begin;
        raised_lanes(span, g->exponent, power);
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
        law_lanes(curve, stage, s->xi, s->force, s->work);
        return;
    }
    for (int32_t i = 1; i < segments; i++) {
        EACH(l) x1[l] = begin + (aim[l] - begin) * r[i].x;
        law_lanes(curve, stage, x1, f1, w1);
        draw_lines(s, &n, 1.0, 0, x1, f1, w1);
        pass_inwards(s, &n);
    }
}

/* The turn near x1: the last line meets the law's force at x1, and the time is that at which nu = gamma f on the law,
 * by steps of Newton's method from tau or, where it is not known, from Halley's step at the line's beginning. */
static void turn_lanes(job *j, int32_t stage, const double *restrict x1, lanes *restrict s, int known, int steps,
                       double *restrict tau) {
    double phi[LANES], kappa[LANES], y0[LANES], d1[LANES], a2[LANES], x[LANES], y[LANES], f1[LANES], w1[LANES];
    double w[LANES], miss[LANES];
    law_lanes(j->curve, stage, x1, f1, w1);
    EACH(l) {
        double g = s->gamma[l], h = x1[l] - s->xi[l], mean = (w1[l] - s->work[l]) / h;
        phi[l] = 2.0 * mean - f1[l];
        kappa[l] = 2.0 * (f1[l] - mean) / h;
        a2[l] = g * kappa[l];
        y0[l] = s->w[l] - g * phi[l];
        d1[l] = -phi[l] - a2[l] * y0[l];
        double d2 = -a2[l] * d1[l] - kappa[l] * y0[l];
        tau[l] = known ? tau[l] : 2.0 * y0[l] * d1[l] / (y0[l] * d2 - 2.0 * d1[l] * d1[l]);
    }
    for (int i = 0; i <= steps; i++) {
        polynomials(y0, d1, a2, kappa, tau, x, y, miss);
        EACH(l) {
            w[l] = y[l] + s->gamma[l] * (phi[l] + kappa[l] * x[l]);
            x[l] += s->xi[l];
        }
        law_lanes(j->curve, stage, x, f1, w1);
        if (i == steps) break;
        /* gamma f falls by a2 y, as on the line */
        EACH(l) tau[l] += (w[l] - s->gamma[l] * f1[l]) / (f1[l] + a2[l] * y[l]);
    }
    EACH(l) {
        double g = s->gamma[l], bad = fabs(w[l] - g * f1[l]) < 1e-9 * w[l] ? miss[l] : 1.0;
        bad = y0[l] > 0.0 ? bad : 1.0;
        s->bad[l] = tau[l] > 0.0 ? s->bad[l] + bad : 1.0;
        s->time[l] += tau[l];
        s->xi[l] = x[l];
        s->force[l] = f1[l];
        s->work[l] = w1[l];
        s->w[l] = g * f1[l];
    }
}

/* Where the impacts turn on Hertz's law, within 1e-5 for gamma nu^{1/5} up to 60: on a fixed target at the depth X that
 * energy gives, on this one under 1/P of the force there, P a function of gamma f(X)/nu alone, fitted to the march. */
static void hertz_aim(const job *j, const double *restrict nu, const double *restrict gamma, double *restrict aim) {
    double k = j->curve->piece[0].force.coefficient, power[LANES], e[LANES], x[LANES], p[LANES], share[LANES];
    EACH(l) {
        power[l] = 1.25 * (nu[l] * nu[l]) / k;
        e[l] = 0.4;
    }
    power_lanes(power, e, x);
    EACH(l) {
        double s = gamma[l] * k * x[l] * sqrt(x[l]) / nu[l];
        p[l] = (1.0 + s * (1.1872359 + s * (0.28208004 + s * 0.0117072))) / (1.0 + s * (0.27930149 + s * 0.01171541));
        e[l] = -2.0 / 3;
    }
    power_lanes(p, e, share);
    EACH(l) aim[l] = x[l] * share[l];
}

/* About where the impacts turn, within 2 % on Hertz's law: false position, the stale end halved. A fixed target would
 * stop them later. */
static void first_aim(job *j, int32_t stage, double stored, const double *restrict nu, const double *restrict gamma,
                      double *restrict aim) {
    const film_curve *curve = j->curve;
    double begin = curve->stage[stage].begin, whole = j->whole[stage];
    double low[LANES], high[LANES], below[LANES], above[LANES], f[LANES], w[LANES], energy[LANES];
    double moving[LANES];
    EACH(l) {
        energy[l] = 0.5 * nu[l] * nu[l] - stored;
        low[l] = begin;
    }
    EACH(l) energy[l] = energy[l] < whole ? energy[l] : whole;
    depth_lanes(curve, stage, whole, energy, high);
    law_lanes(curve, stage, low, f, w);
    EACH(l) below[l] = spent_less_energy(stored + w[l], f[l], nu[l], gamma[l]);
    law_lanes(curve, stage, high, f, w);
    EACH(l) {
        above[l] = spent_less_energy(stored + w[l], f[l], nu[l], gamma[l]);
        aim[l] = high[l];
        moving[l] = above[l] > 0.0 ? 1.0 : 0.0;
    }
    for (int i = 0; i < AIM_STEPS && any(moving); i++) {
        double x[LANES];
        EACH(l) {
            double next = low[l] - (high[l] - low[l]) * below[l] / (above[l] - below[l]);
            x[l] = moving[l] > 0.0 ? next : aim[l];
        }
        law_lanes(curve, stage, x, f, w);
        EACH(l) {
            double excess = spent_less_energy(stored + w[l], f[l], nu[l], gamma[l]);
            high[l] = excess > 0.0 ? x[l] : high[l];
            low[l] = excess > 0.0 ? low[l] : x[l];
            below[l] = excess > 0.0 ? 0.5 * below[l] : excess;
            above[l] = excess > 0.0 ? excess : 0.5 * above[l];
            aim[l] = x[l];
            moving[l] = fabs(excess) < AIM * (0.5 * nu[l] * nu[l]) ? 0.0 : moving[l];
        }
    }
}

/* Across all stages before, then along `stage` to the turn, for a block of impacts that should turn there. turned: the
 * lanes there, the branches open. */
static void plate_in_lanes(job *j, int32_t stage, const int64_t *index, int count, deepest *restrict t) {
    lanes *restrict s = &t->at;
    const film_curve *curve = j->curve;
    const double *nodes = j->mesh->loading_nodes[FILM_PLATE_IN];
    int32_t segments = j->mesh->loading;
    double nu[LANES], aim[LANES], last[LANES], tau[LANES], before = 0.0, end = curve->stage[stage].end, largest = 0.0;
    lines n;
    lanes trial;
    EACH(l) {
        const film_start *start = &j->start[index[l < count ? l : 0]];
        s->gamma[l] = start->gamma;
        s->w[l] = nu[l] = start->nu;
        s->time[l] = 0.0;
        s->bad[l] = 0.0;
    }
    for (int32_t k = 0; k < stage; k++) {
        const table *whole = film_lines_of(j, k, 1, segments, nodes, 0.0);
        for (int32_t i = 1; i <= segments; i++) {
            EACH(l) {
                n.h[l] = whole->rows[i].h;
                n.kappa[l] = whole->rows[i].kappa;
                n.phi[l] = whole->rows[i].phi;
            }
            pass_inwards(s, &n);
        }
        before += j->whole[k];
        largest = whole->peak > largest ? whole->peak : largest;
    }
    EACH(l) s->xi[l] = curve->stage[stage].begin;
    law_lanes(curve, stage, s->xi, s->force, s->work);
    int32_t m = AIMING_SEGMENTS;
    int sure = 0;
    if (plain_power(j, stage) && curve->piece[0].force.exponent == 1.5) {
        hertz_aim(j, nu, s->gamma, aim);
        EACH(l) aim[l] = aim[l] < end ? aim[l] : end;
        m *= 4;
        sure = 1.0 - nodes[segments - 1] > 100.0 * HERTZ_AIM;
    } else {
        first_aim(j, stage, before, nu, s->gamma, aim);
    }
    for (; m == AIMING_SEGMENTS || 3 * m <= segments; m *= 4) { /* each aims the next */
        trial = *s;
        run_towards(j, stage, m, NULL, aim, &trial);
        turn_lanes(j, stage, aim, &trial, 0, 1, tau);
        EACH(l) { /* a trial may be rough: it only places the nodes */
            double to = trial.xi[l] < end ? trial.xi[l] : end;
            aim[l] = fabs(trial.xi[l] - aim[l]) < 0.1 * aim[l] ? to : aim[l];
        }
    }
    run_towards(j, stage, segments, nodes, aim, s);
    EACH(l) last[l] = s->xi[l];
    if (!sure) {
        trial = *s;
        turn_lanes(j, stage, aim, &trial, 0, 1, tau);
        EACH(l) {
            /* a last line too long or short */
            s->bad[l] = fabs(trial.xi[l] - aim[l]) < aim[l] - last[l] ? s->bad[l] : 1.0;
            aim[l] = trial.xi[l] < end ? trial.xi[l] : end;
        }
    }
    turn_lanes(j, stage, aim, s, !sure, 3, tau);
    double exponent = plain_power(j, stage) ? j->exponent[stage] : 1.0; /* back along the law it is of no use */
    EACH(l) {
        s->bad[l] = s->xi[l] <= end ? s->bad[l] : 1.0;
        s->bad[l] = fabs(s->xi[l] - aim[l]) < 0.1 * (s->xi[l] - last[l]) ? s->bad[l] : 1.0;
        t->stored[l] = before + s->work[l];
        t->peak[l] = s->force[l] > largest ? s->force[l] : largest;
        t->recovery[l] = s->xi[l];
        t->exponent[l] = exponent;
    }
    if (curve->stage[stage].unloading != FILM_RETRACE)
        open_lanes(curve, stage, s->xi, s->force, t->recovery, t->exponent);
    EACH(l) {
        s->bad[l] = t->recovery[l] > SHORTEST_RECOVERY * s->xi[l] ? s->bad[l] : 1.0;
        s->bad[l] = t->exponent[l] > 0.0 ? s->bad[l] : 1.0;
        t->slowness[l] = s->gamma[l] * sqrt(s->force[l] / t->recovery[l]);
    }
}

/* The line on which each lane's impactor stops: where it begins, and the law's force at both its ends. */
typedef struct {
    double time[LANES], tau[LANES], w0[LANES], w1[LANES], f0[LANES], f1[LANES];
    double phi[LANES], kappa[LANES], xi[LANES], stage[LANES], from_rest[LANES], moving[LANES];
} stops;

static void await_stops(stops *restrict stop) {
    memset(stop, 0, sizeof *stop);
    EACH(l) stop->moving[l] = 1.0;
}

/* Keeps the line just passed, which began at `from` under f0 with w0, for the lanes that stopped on it. */
static void keep_stops(stops *restrict stop, const lanes *restrict s, const lines *restrict n,
                       const double *restrict w0, const double *restrict f0, const double *restrict f1,
                       const double *restrict from, int32_t stage, int from_rest) {
    double here[LANES], rest = from_rest ? 1.0 : 0.0;
    EACH(l) here[l] = s->w[l] > 0.0 ? 0.0 : stop->moving[l];
    if (!any(here)) return;
    EACH(l) {
        stop->time[l] = here[l] > 0.0 ? s->time[l] - n->tau[l] : stop->time[l];
        stop->tau[l] = here[l] > 0.0 ? n->tau[l] : stop->tau[l];
        stop->w0[l] = here[l] > 0.0 ? w0[l] : stop->w0[l];
        stop->w1[l] = here[l] > 0.0 ? s->w[l] : stop->w1[l];
        stop->f0[l] = here[l] > 0.0 ? f0[l] : stop->f0[l];
        stop->f1[l] = here[l] > 0.0 ? f1[l] : stop->f1[l];
        stop->phi[l] = here[l] > 0.0 ? n->phi[l] : stop->phi[l];
        stop->kappa[l] = here[l] > 0.0 ? n->kappa[l] : stop->kappa[l];
        stop->xi[l] = here[l] > 0.0 ? from[l] : stop->xi[l];
        stop->stage[l] = here[l] > 0.0 ? (double)stage : stop->stage[l];
        stop->from_rest[l] = here[l] > 0.0 ? rest : stop->from_rest[l];
        stop->moving[l] = here[l] > 0.0 ? 0.0 : stop->moving[l];
    }
}

/* The law where the lines of the stops begin and at x1, either along the branches, whose exponent is `same` or, NAN,
 * each lane's own, or, without branches, along each lane's stage. */
static void law_of_stops(const job *j, const stops *restrict n, const leaving *branch, double same,
                         const double *restrict x1, double *restrict w0, double *restrict f1, double *restrict w1) {
    if (branch != NULL) {
        double u[LANES];
        EACH(l) u[l] = x1[l] / branch->recovery[l];
        if (same == same) raised_lanes(u, same, f1);
        else power_lanes(u, branch->exponent, f1);
        EACH(l) {
            double per = 1.0 / (branch->exponent[l] + 1.0);
            f1[l] *= branch->force[l];
            w1[l] = f1[l] * x1[l] * per;
            w0[l] = n->f0[l] * n->xi[l] * per;
        }
        return;
    }
    EACH(l) w0[l] = f1[l] = w1[l] = 0.0;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        double here[LANES], f[LANES], before[LANES], after[LANES];
        EACH(l) here[l] = n->stage[l] == (double)k ? 1.0 : 0.0;
        if (!any(here)) continue;
        law_lanes(j->curve, k, n->xi, f, before);
        EACH(l) w0[l] = here[l] > 0.0 ? before[l] : w0[l];
        law_lanes(j->curve, k, x1, f, after);
        EACH(l) {
            f1[l] = here[l] > 0.0 ? f[l] : f1[l];
            w1[l] = here[l] > 0.0 ? after[l] : w1[l];
        }
    }
}

/* Along lines outwards that begin at w0 under phi: ways and velocities after tau, and 1 where the polynomial errs. */
INLINED void along_lines(const double *restrict gamma, const double *restrict w0, const double *restrict phi,
                         const double *restrict kappa, const double *restrict from_rest, const double *restrict tau,
                         double *restrict x, double *restrict y, double *restrict unfit) {
    double y0[LANES], d1[LANES], a2[LANES];
    EACH(l) {
        a2[l] = gamma[l] * kappa[l];
        y0[l] = from_rest[l] > 0.0 ? 0.0 : gamma[l] * phi[l] - w0[l];
        d1[l] = phi[l] - a2[l] * y0[l];
    }
    polynomials(y0, d1, a2, kappa, tau, x, y, unfit);
}

/* When the impactors stop, within lines that begin at w0 > 0 and end at w1 <= 0; NAN where one does not. The cubic
 * through both velocities and both accelerations, -f, says where about; the line is drawn again to there, as the march
 * cuts it, and Newton's method finds the time on that line. Where it is too long for that, the march is left to it. */
static void stop_times(const job *j, const stops *restrict n, lanes *restrict s, const leaving *branch, double same,
                       double *restrict time) {
    double tau[LANES], near[LANES], x[LANES], y[LANES], unfit[LANES], x1[LANES], before[LANES], f1[LANES], w1[LANES];
    double phi[LANES], kappa[LANES], far[LANES];
    EACH(l) {
        double w0 = n->w0[l], d0 = -n->f0[l] * n->tau[l], d1 = -n->f1[l] * n->tau[l], r = w0 / (w0 - n->w1[l]);
        double c2 = 3.0 * (n->w1[l] - w0) - 2.0 * d0 - d1, c3 = 2.0 * (w0 - n->w1[l]) + d0 + d1;
        for (int i = 0; i < 3; i++) {
            r -= (w0 + r * (d0 + r * (c2 + r * c3))) / (d0 + r * (2.0 * c2 + 3.0 * r * c3));
            r = r > 0.0 ? r : 0.0; /* a line too long for its cubic */
            r = r < 1.0 ? r : 1.0;
        }
        near[l] = tau[l] = r * n->tau[l];
    }
    along_lines(s->gamma, n->w0, n->phi, n->kappa, n->from_rest, near, x, y, unfit);
    EACH(l) {
        far[l] = x[l] > SHORT_WAY_OUT * n->xi[l] ? 1.0 : 0.0; /* the cubic is good enough nearer than that */
        far[l] = x[l] < n->xi[l] ? far[l] : 0.0;
        x1[l] = far[l] > 0.0 ? n->xi[l] - x[l] : n->xi[l];
    }
    law_of_stops(j, n, branch, same, x1, before, f1, w1);
    EACH(l) {
        double per = 1.0 / x[l], mean = (before[l] - w1[l]) * per;
        kappa[l] = n->from_rest[l] > 0.0 ? 2.0 * (n->f0[l] - mean) * per : (n->f0[l] - f1[l]) * per;
        phi[l] = n->from_rest[l] > 0.0 ? n->f0[l] : mean + 0.5 * kappa[l] * x[l];
    }
    for (int i = 0; i < 2; i++) {
        double over[LANES];
        along_lines(s->gamma, n->w0, phi, kappa, n->from_rest, tau, x, y, over);
        EACH(l) {
            double force = phi[l] - kappa[l] * x[l], next = tau[l] + (s->gamma[l] * force - y[l]) / force;
            far[l] = fabs(next - near[l]) <= 0.1 * n->tau[l] ? far[l] : 0.0;
            tau[l] = next;
            unfit[l] += far[l] > 0.0 ? over[l] : 0.0;
        }
    }
    EACH(l) {
        double stopped = n->time[l] + (far[l] > 0.0 ? tau[l] : near[l]), here = n->moving[l] > 0.0 ? 0.0 : 1.0;
        here = n->w0[l] > 0.0 ? here : 0.0;
        time[l] = here > 0.0 ? stopped : NAN;
        s->bad[l] += here > 0.0 ? unfit[l] : 0.0;
    }
}

/* What one lane has done. */
static void leave_lane(job *j, const lanes *s, double stopped, int l, int64_t index, double left, double stored,
                       double given) {
    film_summary *out = &j->summary[index];
    const film_start *start = &j->start[index];
    out->time_impactor_stops = stopped;
    out->contact_duration = s->time[l];
    out->permanent_indentation = left;
    out->final_velocity = s->w[l];
    out->shift = s->gamma[l] * (start->nu - s->w[l]);
    out->work = stored - given;
    int whole = s->bad[l] == 0.0 && s->time[l] < INFINITY && fabs(s->w[l]) < INFINITY;
    j->status[index] = whole ? FILM_EVENT : film_impact(j->curve, j->mesh, start, out);
}

/* A block of impacts from rest at their deepest point out along their branches; exponent NAN: each lane has its own. */
static void plate_out_lanes(job *j, int32_t grading, double same, leaving *q) {
    const double *nodes = j->mesh->unloading_nodes[grading];
    int32_t segments = film_unloading(j->mesh, grading);
    double stiff[LANES], w0[LANES], f0[LANES], f1[LANES], from[LANES], stopped[LANES];
    const row *r = same == same ? film_lines_of(j, UNIT_POWER, -1, segments, nodes, same)->rows : NULL;
    lanes s;
    lines n;
    stops stop;
    int any_moves = 1;
    for (int l = q->count; l < LANES; l++) { /* an incomplete block is filled up with its first impact */
        q->gamma[l] = q->gamma[0];
        q->time[l] = q->time[0];
        q->top[l] = q->top[0];
        q->force[l] = q->force[0];
        q->recovery[l] = q->recovery[0];
        q->exponent[l] = q->exponent[0];
    }
    EACH(l) {
        s.gamma[l] = q->gamma[l];
        s.time[l] = q->time[l];
        s.w[l] = q->gamma[l] * q->force[l];
        s.bad[l] = 0.0;
        s.xi[l] = q->recovery[l];
        s.force[l] = q->force[l];
        s.work[l] = q->force[l] * q->recovery[l] / (q->exponent[l] + 1.0);
        stiff[l] = q->force[l] / q->recovery[l];
        f1[l] = q->force[l];
    }
    await_stops(&stop);
    for (int32_t i = 1; i <= segments; i++) {
        if (any_moves) {
            EACH(l) {
                w0[l] = s.w[l];
                f0[l] = f1[l];
                from[l] = q->recovery[l] * (i == 1 ? 1.0 : 1.0 - nodes[i - 1]);
            }
        }
        if (r != NULL) {
            double h = r[i].h, kappa = r[i].kappa, phi = r[i].phi, force = r[i].force;
            EACH(l) {
                n.h[l] = q->recovery[l] * h;
                n.kappa[l] = stiff[l] * kappa;
                n.phi[l] = q->force[l] * phi;
                f1[l] = q->force[l] * force;
            }
        } else {
            double u[LANES], x1[LANES], w1[LANES], fraction = i < segments ? 1.0 - nodes[i] : 0.0;
            EACH(l) u[l] = fraction;
            power_lanes(u, q->exponent, f1);
            EACH(l) {
                x1[l] = q->recovery[l] * fraction;
                f1[l] *= q->force[l];
                w1[l] = f1[l] * x1[l] / (q->exponent[l] + 1.0);
            }
            draw_lines(&s, &n, -1.0, i == 1, x1, f1, w1);
        }
        if (i == 1) pass_from_rest(&s, &n);
        else pass_outwards(&s, &n);
        if (any_moves) {
            keep_stops(&stop, &s, &n, w0, f0, f1, from, FILM_BRANCH, i == 1);
            any_moves = any(stop.moving);
        }
    }
    stop_times(j, &stop, &s, q, same, stopped);
    for (int l = 0; l < q->count; l++)
        leave_lane(j, &s, stopped[l], l, q->index[l], q->top[l] - q->recovery[l], q->stored[l],
                   q->force[l] * q->recovery[l] / (q->exponent[l] + 1.0));
    q->count = 0;
}

/* The way back along a reversible law, stage by stage, from rest at the turn: the lanes have turned in `stage`. */
static void plate_back_lanes(job *j, int32_t stage, const int64_t *index, int count, lanes *restrict s,
                             const double *restrict stored) {
    const film_mesh *mesh = j->mesh;
    double largest[LANES], from[LANES], begin[LANES], x1[LANES], f1[LANES], w1[LANES], w0[LANES], f0[LANES], stopped[LANES];
    double until[LANES];
    const double *nodes[LANES];
    int32_t segments[LANES], drawn[LANES] = {0};
    lines n;
    stops stop;
    EACH(l) largest[l] = s->force[l];
    await_stops(&stop);
    for (int32_t k = stage; k >= 0; k--) {
        double to = j->curve->stage[k].begin;
        int32_t most = 0;
        EACH(l) {
            int32_t grading = film_grading(s->gamma[l] * sqrt(largest[l] / s->xi[l]));
            from[l] = s->xi[l];
            nodes[l] = mesh->unloading_nodes[grading];
            segments[l] = film_unloading(mesh, grading);
            most = segments[l] > most ? segments[l] : most;
            drawn[l] += segments[l];
        }
        law_lanes(j->curve, k, from, s->force, s->work);
        for (int32_t i = 1; i <= most; i++) {
            EACH(l) {
                x1[l] = i < segments[l] ? from[l] + (to - from[l]) * nodes[l][i] : to;
                w0[l] = s->w[l];
                f0[l] = s->force[l];
                begin[l] = s->xi[l];
                until[l] = s->time[l];
            }
            law_lanes(j->curve, k, x1, f1, w1);
            draw_lines(s, &n, -1.0, i == 1 && k == stage, x1, f1, w1);
            EACH(l) { /* a lane that has no line left takes one that comes to nothing, while others go on */
                if (i <= segments[l]) continue;
                n.h[l] = 1.0;
                n.phi[l] = n.kappa[l] = 0.0;
                s->w[l] = -1.0;
            }
            if (i == 1 && k == stage) pass_from_rest(s, &n);
            else pass_outwards(s, &n);
            EACH(l) {
                if (i <= segments[l]) continue;
                s->w[l] = w0[l];
                s->time[l] = until[l];
            }
            keep_stops(&stop, s, &n, w0, f0, f1, begin, k, i == 1 && k == stage);
        }
    }
    stop_times(j, &stop, s, NULL, NAN, stopped);
    for (int l = 0; l < count; l++) {
        j->summary[index[l]].lines += drawn[l];
        leave_lane(j, s, stopped[l], l, index[l], 0.0, stored[l], stored[l]);
    }
}

const routines FILM_ROUTINES = {fixed_lanes, plate_in_lanes, plate_out_lanes, plate_back_lanes};
