/* Impacts by the thousand: what film_impact gives, by shorter ways where there are any.
 *
 * On a fixed target without a load, energy gives the velocity at every node and tan(omega tau/2) = omega h/(v0 + v1)
 * the time between two, so a summary needs neither events nor states. Everything else takes the march's own steps. */
#include "film_line.h"

#include <string.h>

/* Time from one node to the next over the whole run, from `from`, where the velocity is v, to `to`. The first line of a
 * run from rest and the last one of a run that turns meet the law's force there. */
static double cross(const film_curve *curve, const film_line *run, double from, double to, double v, int turns,
                    int32_t segments, const double *nodes, double *peak) {
    double f0, w0, f1, w1, x0 = from, v0 = v, time = 0.0;
    law_at(curve, run, from, &f0, &w0);
    double total = v * v + 2.0 * w0;
    for (int32_t i = 1; i <= segments; i++) {
        double x1 = i < segments ? from + (to - from) * nodes[i] : to, h = x1 - x0;
        law_at(curve, run, x1, &f1, &w1);
        double square = total - 2.0 * w1, per_h = 1.0 / h, mean = (w1 - w0) * per_h, kappa = (f1 - f0) * per_h;
        double v1 = square > 0.0 && !(turns && i == segments) ? sqrt(square) : 0.0;
        if (turns && i == segments) kappa = 2.0 * (f1 - mean) * per_h;
        else if (i == 1 && v == 0.0) kappa = 2.0 * (mean - f0) * per_h;
        double r = fabs(h) / (v0 + v1);
        time += 2.0 * r * arc(kappa * r * r);
        if (f1 > *peak) *peak = f1;
        x0 = x1;
        f0 = f1;
        w0 = w1;
        v0 = v1;
    }
    return time;
}

static double speed_at(double v, double work_done) {
    double square = v * v - 2.0 * work_done;
    return square > 0.0 ? sqrt(square) : 0.0;
}

static int fixed_target(const film_curve *curve, const film_mesh *mesh, double nu, film_summary *summary) {
    film_line run;
    memset(&run, 0, sizeof run);
    double v = nu, xi = 0.0, time = 0.0, to = 0.0, force, work, peak = 0.0, stored = 0.0;
    int status = FILM_OK;
    const double *in = mesh->loading_nodes[FILM_COSINE], *out = mesh->unloading_nodes[FILM_COSINE];
    for (;; run.branch++) {
        if (run.branch >= curve->stages) return FILM_BEYOND_LAW;
        double end = curve->stage[run.branch].end;
        status = film_turning_point(curve, &run, xi, 0.0, v, 0.0, end, &to);
        if (status < 0) return status;
        time += cross(curve, &run, xi, to, v, status == FILM_EVENT, mesh->loading, in, &peak);
        summary->lines += mesh->loading;
        law_at(curve, &run, to, &force, &work);
        stored += work;
        xi = to;
        if (status == FILM_EVENT) break;
        v = speed_at(v, work);
    }
    summary->maximum_force = peak;
    summary->maximum_indentation = xi - curve->compliance * force;
    summary->time_of_maximum_indentation = summary->time_impactor_stops = time;
    summary->stage = run.branch;
    double given_back = stored;
    status = open_branch(curve, &run, xi, force);
    if (status < 0) return status;
    if (run.branch == FILM_BRANCH) {
        law_at(curve, &run, xi, &force, &given_back);
        time += cross(curve, &run, xi, run.xi_free, 0.0, 0, mesh->unloading, out, &peak);
        summary->lines += mesh->unloading;
    } else {
        for (v = 0.0; run.branch >= 0; run.branch--) {
            to = curve->stage[run.branch].begin;
            law_at(curve, &run, xi, &force, &work);
            time += cross(curve, &run, xi, to, v, 0, mesh->unloading, out, &peak);
            summary->lines += mesh->unloading;
            v = speed_at(v, -work);
            xi = to;
        }
    }
    summary->contact_duration = time;
    summary->permanent_indentation = run.branch == FILM_BRANCH ? run.xi_free : 0.0;
    summary->final_velocity = -sqrt(2.0 * given_back);
    summary->work = stored - given_back;
    return FILM_EVENT;
}

static int undisturbed(const film_start *start) {
    return start->load == 0.0 && start->stop_velocity == 0.0 && start->time_limit == INFINITY;
}

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    film_state s;
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = NAN;
    summary->final_velocity = NAN;
    if (!(start->nu > 0.0 && start->nu < INFINITY)) return FILM_BAD_NUMBER;
    if (start->gamma == 0.0 && undisturbed(start) && mesh->linearisation == FILM_WORK_PRESERVING)
        return fixed_target(curve, mesh, start->nu, summary);
    int status = film_init(curve, &s, 0.0, start->nu, start->gamma, start->load, start->stop_velocity);
    while (status >= 0) {
        status = film_step(curve, mesh, &s, start->time_limit - s.time);
        if (status != FILM_EVENT || s.event == FILM_CONTACT_ENDS) break;
        if (s.lines > FILM_MAX_STEP_LINES) return FILM_TOO_MANY;
        double indentation = s.xi - curve->compliance * s.force;
        if (s.event == FILM_MAXIMUM_INDENTATION && indentation > summary->maximum_indentation) {
            summary->maximum_indentation = indentation;
            summary->time_of_maximum_indentation = s.time;
            summary->stage = s.stage_max;
        } else if (s.event == FILM_IMPACTOR_STOPS && isnan(summary->time_impactor_stops)) {
            summary->time_impactor_stops = s.time;
        }
    }
    if (status < 0) return status;
    summary->maximum_force = s.force_peak;
    summary->shift = s.shift;
    summary->work = s.spent;
    summary->lines = s.lines;
    if (status == FILM_EVENT) {
        summary->contact_duration = s.time;
        summary->permanent_indentation = s.xi;
        summary->final_velocity = s.nu;
    }
    return status;
}

/* ---------------------------------------------------------------- plates, several at a time
 * Impacts on compliant targets march side by side in lanes, so that one need not wait for another's divisions. The lines
 * are the march's; the motion on them is a short Taylor polynomial instead of a converged one, the turn is found on the
 * true law, and what does not fit (a long line, a turn in another stage than expected) is left to film_impact. */
enum { LANES = 8, AIMING_SEGMENTS = 4 };
static const double REACH = 1.6; /* largest 2a tau + kappa tau^2 of a line: its polynomial errs by at most reach^12/12! */

typedef struct {
    double xi[LANES], f[LANES], work[LANES]; /* where each lane is, and the law there */
    double w[LANES], time[LANES];            /* impactor velocity */
} lanes;

/* x and y = x' after tau, by the Taylor polynomial of y'' = -a2 y' - k y. */
static inline double polynomial(double y0, double d1, double a2, double k, double tau, double *x) {
    double d2 = -a2 * d1 - k * y0, d3 = -a2 * d2 - k * d1, d4 = -a2 * d3 - k * d2, d5 = -a2 * d4 - k * d3;
    double d6 = -a2 * d5 - k * d4, d7 = -a2 * d6 - k * d5, d8 = -a2 * d7 - k * d6, d9 = -a2 * d8 - k * d7;
    double d10 = -a2 * d9 - k * d8, d11 = -a2 * d10 - k * d9;
    double x8 = d8 * (1.0 / 362880) + tau * (d9 * (1.0 / 3628800) + tau * (d10 * (1.0 / 39916800) + tau * d11 * (1.0 / 479001600)));
    double x4 = d4 * (1.0 / 120) + tau * (d5 * (1.0 / 720) + tau * (d6 * (1.0 / 5040) + tau * (d7 * (1.0 / 40320) + tau * x8)));
    double y8 = d8 * (1.0 / 40320) + tau * (d9 * (1.0 / 362880) + tau * (d10 * (1.0 / 3628800) + tau * d11 * (1.0 / 39916800)));
    double y4 = d4 * (1.0 / 24) + tau * (d5 * (1.0 / 120) + tau * (d6 * (1.0 / 720) + tau * (d7 * (1.0 / 5040) + tau * y8)));
    *x = tau * (y0 + tau * (d1 * 0.5 + tau * (d2 * (1.0 / 6) + tau * (d3 * (1.0 / 24) + tau * x4))));
    return y0 + tau * (d1 + tau * (d2 * 0.5 + tau * (d3 * (1.0 / 6) + tau * y4)));
}

/* Across a line of signed length h whose force begins at phi with slope kappa: time and velocity at its end. d = +1
 * inwards, -1 outwards. served: 0 where the polynomial cannot serve. */
static inline void cross_line(const double *restrict gamma, const double *restrict h, const double *restrict phi,
                              const double *restrict kappa, double d, int at_rest, const double *restrict w,
                              double *restrict tau, double *restrict w1, double *restrict served) {
    for (int l = 0; l < LANES; l++) {
        double g = gamma[l], length = d * h[l], k = kappa[l], load = d * phi[l], a2 = g * k;
        double y0 = d * (w[l] - g * phi[l]), drag = 0.5 * a2 * length, before = y0 - drag;
        double square = before * before - length * (2.0 * load + k * length);
        double y1 = sqrt(square > 0.0 ? square : 0.0) - drag, least = 0.1 * y0;
        y1 = y1 > least ? y1 : least;
        double q = 2.0 * length / (y0 + y1);
        q -= q * q * q * (k + a2 * (y1 - y0) / length) * (1.0 / 12);
        double d1 = -load - a2 * y0;
        double u = 0.0, rough = 0.0, end = 0.0;
        for (int pass = 0; pass <= at_rest; pass++) { /* the guess for a line from rest needs a second correction */
            q += u;
            double x, y = polynomial(y0, d1, a2, k, q, &x);
            double slope = -(load + k * x) - a2 * y, bend = -a2 * slope - k * y, miss = length - x;
            rough = miss / y;
            u = miss / (y + rough * (0.5 * slope + rough * (1.0 / 6) * bend));
            end = y + u * (slope + u * (0.5 * bend - u * (1.0 / 6) * (a2 * bend + k * slope)));
        }
        tau[l] = q + u;
        w1[l] = d * end + g * (phi[l] + k * h[l]);
        double good = end > 0.0 ? 1.0 : 0.0;
        good = fabs(rough) < 0.05 * q ? good : 0.0; /* u may be short by chance, where x never gets as far */
        good = fabs(a2 * q) + fabs(k) * q * q < REACH ? good : 0.0;
        served[l] = good;
    }
}

/* The march's own way across one line of one lane. */
static int cross_alone(double gamma, double h, double phi, double kappa, double d, int at_rest, double w, double *tau,
                       double *w1) {
    double y = 0.0;
    motion m = {at_rest ? 0.0 : d * (w - gamma * phi), d * phi, kappa, 0.5 * kappa * gamma};
    int left = leave(&m, d * h, tau, &y);
    *w1 = d * y + gamma * (phi + kappa * h);
    return left == LEFT;
}

/* To the next node, x1 of each lane, along a loading stage (run[l].branch) or an unloading branch. */
static void next_node(const film_curve *curve, const film_line *run, const double *gamma, const double *x1, double d,
                      int at_rest, lanes *s, double *bad) {
    double h[LANES], phi[LANES], kappa[LANES], f1[LANES], work1[LANES], tau[LANES], w1[LANES], served[LANES];
    for (int l = 0; l < LANES; l++) law_at(curve, &run[l], x1[l], &f1[l], &work1[l]);
    for (int l = 0; l < LANES; l++) {
        h[l] = x1[l] - s->xi[l];
        double per_h = 1.0 / h[l], mean = (work1[l] - s->work[l]) * per_h;
        kappa[l] = at_rest ? 2.0 * (mean - s->f[l]) * per_h : (f1[l] - s->f[l]) * per_h;
        phi[l] = at_rest ? s->f[l] : mean - 0.5 * kappa[l] * h[l];
    }
    if (at_rest) cross_line(gamma, h, phi, kappa, d, 1, s->w, tau, w1, served);
    else cross_line(gamma, h, phi, kappa, d, 0, s->w, tau, w1, served);
    for (int l = 0; l < LANES; l++)
        if (!(served[l] > 0.0) &&
            !cross_alone(gamma[l], h[l], phi[l], kappa[l], d, at_rest, s->w[l], &tau[l], &w1[l])) bad[l] = 1.0;
    for (int l = 0; l < LANES; l++) {
        s->w[l] = w1[l];
        s->time[l] += tau[l];
        s->xi[l] = x1[l];
        s->f[l] = f1[l];
        s->work[l] = work1[l];
    }
}

/* The turn near x1: the last line meets the law's force at x1, and the time is that at which nu = gamma f on the law. */
static void turn(const film_curve *curve, const film_line *run, const double *gamma, const double *x1, lanes *s, int steps,
                 double *bad) {
    for (int l = 0; l < LANES; l++) {
        double f1, w1, g = gamma[l], h = x1[l] - s->xi[l];
        law_at(curve, &run[l], x1[l], &f1, &w1);
        double mean = (w1 - s->work[l]) / h, phi = 2.0 * mean - f1, k = 2.0 * (f1 - mean) / h, a2 = g * k;
        double y0 = s->w[l] - g * phi, d1 = -phi - a2 * y0, d2 = -a2 * d1 - k * y0, x = 0.0, force = f1, w = s->w[l];
        double tau = 2.0 * y0 / (sqrt(fmax(d1 * d1 - 2.0 * y0 * d2, 0.0)) - d1);
        for (int i = 0; i <= steps; i++) {
            double y = polynomial(y0, d1, a2, k, tau, &x);
            law_at(curve, &run[l], s->xi[l] + x, &force, &w1);
            w = y + g * (phi + k * x);
            if (i < steps) tau += (w - g * force) / force;
        }
        int good = y0 > 0.0 && tau > 0.0 && fabs(w - g * force) < 1e-11 * w && fabs(a2 * tau) + fabs(k) * tau * tau < REACH;
        if (!good) bad[l] = 1.0;
        s->time[l] += tau;
        s->xi[l] += x;
        s->f[l] = force;
        s->work[l] = w1;
        s->w[l] = g * force;
    }
}

/* W + g f (0.79 nu - 0.27 g f) - nu^2/2, which is about 0 where the target turns the impactor; g f cannot exceed nu. */
static double spent_less_energy(double work, double force, double nu, double gamma) {
    double push = fmin(gamma * force, nu);
    return work + push * (0.79 * nu - 0.27 * push) - 0.5 * nu * nu;
}

/* The stage in which an impact should turn, and about where, within 2 % on Hertz's law. False position, the stale end halved. Negative: no such stage. */
static int32_t first_aim(const film_curve *curve, double nu, double gamma, double *aim) {
    film_line run;
    double stored = 0.0, force, work, energy = 0.5 * nu * nu;
    memset(&run, 0, sizeof run);
    for (; run.branch < curve->stages; run.branch++) {
        double low = curve->stage[run.branch].begin, high = curve->stage[run.branch].end;
        double still = sqrt(fmax(nu * nu - 2.0 * stored, 0.0));
        if (film_turning_point(curve, &run, low, 0.0, still, 0.0, high, &high) < 0) return -1;
        law_at(curve, &run, low, &force, &work);
        double below = spent_less_energy(stored, force, nu, gamma);
        law_at(curve, &run, high, &force, &work);
        double above = spent_less_energy(stored + work, force, nu, gamma);
        if (above > 0.0) {
            double x = high;
            for (int k = 0; k < 8 && fabs(high - low) > 1e-3 * high; k++) {
                x = low - (high - low) * below / (above - below);
                law_at(curve, &run, x, &force, &work);
                double excess = spent_less_energy(stored + work, force, nu, gamma);
                if (fabs(excess) < 1e-3 * energy) break;
                if (excess > 0.0) { high = x; above = excess; below *= 0.5; }
                else { low = x; below = excess; above *= 0.5; }
            }
            *aim = x;
            return run.branch;
        }
        stored += work;
    }
    return -1;
}

/* When the impactor stops, within a line of duration tau that begins at w0 > 0 and ends at w1 <= 0: the cubic through
 * both velocities and both accelerations, -f. */
static double stop_within(double tau, double w0, double w1, double f0, double f1) {
    double s = w0 / (w0 - w1), d0 = -f0 * tau, d1 = -f1 * tau;
    double c2 = 3.0 * (w1 - w0) - 2.0 * d0 - d1, c3 = 2.0 * (w0 - w1) + d0 + d1;
    for (int i = 0; i < 3; i++) {
        s -= (w0 + s * (d0 + s * (c2 + s * c3))) / (d0 + s * (2.0 * c2 + 3.0 * s * c3));
        s = s > 0.0 ? s < 1.0 ? s : 1.0 : 0.0; /* a line too long for its cubic */
    }
    return s * tau;
}

/* One block of impacts that should all turn in `stage`; a lane whose status stays 0 could not be served. */
static void plate_block(const film_curve *curve, const film_mesh *mesh, int32_t stage, const film_start *start,
                        const double *first, film_summary *summary, int32_t *status) {
    double gamma[LANES], x1[LANES], aim[LANES], stored[LANES] = {0.0}, peak[LANES] = {0.0}, given[LANES];
    double bad[LANES] = {0.0}, rough[LANES] = {0.0};
    int32_t grade[LANES], n = mesh->loading;
    film_line run[LANES];
    lanes s, trial;
    memset(run, 0, sizeof run);
    memset(&s, 0, sizeof s);
    for (int l = 0; l < LANES; l++) {
        gamma[l] = start[l].gamma;
        s.w[l] = start[l].nu;
    }
    for (int32_t k = 0;; k++) {
        double begin = curve->stage[k].begin, end = curve->stage[k].end;
        for (int l = 0; l < LANES; l++) {
            run[l].branch = k;
            law_at(curve, &run[l], begin, &s.f[l], &s.work[l]);
        }
        if (k == stage) break;
        for (int32_t i = 1; i <= n; i++) {
            for (int l = 0; l < LANES; l++)
                x1[l] = i < n ? begin + (end - begin) * mesh->loading_nodes[FILM_PLATE_IN][i] : end;
            next_node(curve, run, gamma, x1, 1.0, 0, &s, bad);
        }
        for (int l = 0; l < LANES; l++) {
            stored[l] += s.work[l];
            peak[l] = fmax(peak[l], s.f[l]);
        }
    }
    double begin = curve->stage[stage].begin, end = curve->stage[stage].end;
    memcpy(aim, first, sizeof aim);
    for (int32_t m = AIMING_SEGMENTS; m == AIMING_SEGMENTS || 3 * m <= n; m *= 4) { /* each trial aims the next */
        trial = s;
        for (int32_t i = 1; i < m; i++) {
            double f = (double)i / m;
            for (int l = 0; l < LANES; l++) x1[l] = begin + (aim[l] - begin) * f * f * (3.0 - 2.0 * f);
            next_node(curve, run, gamma, x1, 1.0, 0, &trial, rough);
        }
        turn(curve, run, gamma, aim, &trial, 2, rough);
        for (int l = 0; l < LANES; l++) { /* a trial may be rough: it only places the nodes */
            if (fabs(trial.xi[l] - aim[l]) < 0.1 * aim[l]) aim[l] = fmin(trial.xi[l], end);
        }
    }
    for (int32_t i = 1; i < n; i++) {
        for (int l = 0; l < LANES; l++) x1[l] = begin + (aim[l] - begin) * mesh->loading_nodes[FILM_PLATE_IN][i];
        next_node(curve, run, gamma, x1, 1.0, 0, &s, bad);
    }
    trial = s;
    turn(curve, run, gamma, aim, &trial, 2, rough);
    for (int l = 0; l < LANES; l++) {
        if (!(fabs(trial.xi[l] - aim[l]) < aim[l] - x1[l])) bad[l] = 1.0; /* the last line would be too long or short */
        aim[l] = fmin(trial.xi[l], end);
    }
    turn(curve, run, gamma, aim, &s, 4, bad);
    const film_function *law = &curve->piece[curve->stage[0].first].force;
    int plain = law->form == FILM_POWER && law->constant == 0.0 && law->slope == 0.0 && law->origin == 0.0;
    for (int l = 0; l < LANES; l++) {
        film_summary *out = &summary[l];
        if (!(s.xi[l] <= end && fabs(s.xi[l] - aim[l]) < 0.1 * (s.xi[l] - x1[l]))) bad[l] = 1.0;
        out->maximum_indentation = s.xi[l];
        out->time_of_maximum_indentation = s.time[l];
        out->maximum_force = fmax(peak[l], s.f[l]);
        out->stage = stage;
        out->lines = n * (stage + 1) + mesh->unloading;
        out->time_impactor_stops = NAN;
        stored[l] += s.work[l];
        if (bad[l] > 0.0 || open_branch(curve, &run[l], s.xi[l], s.f[l]) < 0) bad[l] = 1.0;
        if (run[l].branch != FILM_BRANCH) { /* reversible: the same power law from the first touch on is a branch */
            if (stage > 0 || !plain) bad[l] = 1.0;
            run[l].branch = FILM_BRANCH;
            run[l].per_recovery = 1.0 / s.xi[l];
            run[l].f_max = s.f[l];
            run[l].exponent = law->exponent;
        }
        double slowness = gamma[l] * sqrt(s.f[l] * run[l].per_recovery);
        grade[l] = slowness < 1.2 ? FILM_PLATE_OUT : slowness < 1.75 ? FILM_PLATE_SLOW : FILM_PLATE_CREEP;
        law_at(curve, &run[l], s.xi[l], &s.f[l], &s.work[l]);
        given[l] = s.work[l];
    }
    for (int32_t i = 1; i <= mesh->unloading; i++) {
        lanes before = s;
        for (int l = 0; l < LANES; l++) {
            double top = summary[l].maximum_indentation;
            x1[l] = i < mesh->unloading ? top + (run[l].xi_free - top) * mesh->unloading_nodes[grade[l]][i] : run[l].xi_free;
        }
        next_node(curve, run, gamma, x1, -1.0, i == 1, &s, bad);
        for (int l = 0; l < LANES; l++)
            if (before.w[l] > 0.0 && s.w[l] <= 0.0)
                summary[l].time_impactor_stops = before.time[l] + stop_within(s.time[l] - before.time[l], before.w[l],
                                                                              s.w[l], before.f[l], s.f[l]);
    }
    for (int l = 0; l < LANES; l++) {
        film_summary *out = &summary[l];
        out->contact_duration = s.time[l];
        out->permanent_indentation = run[l].xi_free;
        out->final_velocity = s.w[l];
        out->shift = gamma[l] * (start[l].nu - s.w[l]);
        out->work = stored[l] - given[l];
        status[l] = bad[l] == 0.0 && isfinite(s.time[l]) && isfinite(s.w[l]) ? FILM_EVENT : 0;
    }
}

/* Impacts waiting for a block: all should turn in the same stage. */
typedef struct {
    int64_t index[LANES];
    film_start start[LANES];
    double aim[LANES];
    int count;
} queue;

static void flush(const film_curve *curve, const film_mesh *mesh, int32_t stage, queue *q, film_summary *summary,
                  int32_t *status) {
    film_summary out[LANES];
    int32_t done[LANES];
    if (q->count == 0) return;
    for (int l = q->count; l < LANES; l++) { /* an incomplete block is filled up with its first impact */
        q->start[l] = q->start[0];
        q->aim[l] = q->aim[0];
    }
    plate_block(curve, mesh, stage, q->start, q->aim, out, done);
    for (int l = 0; l < q->count; l++) {
        int64_t i = q->index[l];
        summary[i] = out[l];
        status[i] = done[l] ? done[l] : film_impact(curve, mesh, &q->start[l], &summary[i]);
    }
    q->count = 0;
}

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    queue waiting[FILM_MAX_STAGES];
    for (int32_t k = 0; k < curve->stages; k++) waiting[k].count = 0;
    int lined = mesh->linearisation == FILM_WORK_PRESERVING && mesh->loading >= 3 && mesh->unloading >= 3 &&
                curve->compliance == 0.0;
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &start[i];
        double aim = 0.0;
        int32_t stage = -1;
        if (lined && s->gamma > 0.0 && s->gamma < INFINITY && s->nu > 0.0 && s->nu < INFINITY && undisturbed(s))
            stage = first_aim(curve, s->nu, s->gamma, &aim);
        if (stage < 0) {
            status[i] = film_impact(curve, mesh, s, &summary[i]);
            continue;
        }
        queue *q = &waiting[stage];
        q->index[q->count] = i;
        q->start[q->count] = *s;
        q->aim[q->count++] = aim;
        if (q->count == LANES) flush(curve, mesh, stage, q, summary, status);
    }
    for (int32_t k = 0; k < curve->stages; k++) flush(curve, mesh, k, &waiting[k], summary, status);
}
