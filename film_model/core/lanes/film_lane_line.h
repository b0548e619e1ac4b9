/* The motion on lines, and the way back along stretched stages of a law that pulls, in lanes. Internal to film_lanes.c. Short
 * polynomials replace the closed forms of film_line.h; where they are not accurate enough, film_line.h is used lane by lane.
 * docs/method.md, sections 3, 6 and 10. */
#ifndef FILM_LANE_LINE_H
#define FILM_LANE_LINE_H

#include "lanes/film_lane_law.h"

#include "march/film_line.h"

/* Up to where the polynomials of ten and of twenty terms are used, in units of the line's own time: see terms. Affects
 * accuracy only, on meshes of a few segments (beyond, film_line.h is used): changes the recorded hash, fails no check. */
static const double REACH = 0.8, FAR_REACH = 3.6;

/* Longest correction of a line's time, as a fraction of it: the correction errs by its fourth power, 1e-6. Affects accuracy
 * only: changes the recorded hash, fails no check. */
static const double LONGEST_STEP = 0.03;

/* x and y = x' after tau on a line, y'' = -a2 y' - k y, b = -a2 tau, c = -k tau^2: Taylor polynomials, whose terms
 * before division by j! are t_j = b t_{j-1} + c t_{j-2}, two at a time. They err by reach^10/10! and, where far, by
 * reach^20/20!, for |b| reach + |c| <= reach^2: 3e-8 and 6e-8 of a line at most, and like n^-10 in n segments. */
typedef struct {
    double t1, t2, t3, t4, t8, t9, high_x, high_y; /* high: the terms from t5 on */
} terms;

INLINED terms first_terms(double y0, double t1, double b, double c) {
    double p = b * b + c, r = b * c, t2 = b * t1 + c * y0, t3 = p * t1 + r * y0, t4 = b * t3 + c * t2;
    double t5 = p * t3 + r * t2, t6 = b * t5 + c * t4, t7 = p * t5 + r * t4, t8 = b * t7 + c * t6, t9 = p * t7 + r * t6;
    double high_y = (t5 * (1.0 / 120) + t6 * (1.0 / 720)) + (t7 * (1.0 / 5040) + t8 * (1.0 / 40320));
    double high_x = (t5 * (1.0 / 720) + t6 * (1.0 / 5040)) + (t7 * (1.0 / 40320) + t8 * (1.0 / 362880));
    high_y += t9 * (1.0 / 362880);
    high_x += t9 * (1.0 / 3628800);
    return (terms){t1, t2, t3, t4, t8, t9, high_x, high_y};
}

INLINED void further_terms(double t8, double t9, double b, double c, double *high_x, double *high_y) {
    double p = b * b + c, r = b * c, t10 = b * t9 + c * t8, t11 = p * t9 + r * t8, t12 = b * t11 + c * t10;
    double t13 = p * t11 + r * t10, t14 = b * t13 + c * t12, t15 = p * t13 + r * t12, t16 = b * t15 + c * t14;
    double t17 = p * t15 + r * t14, t18 = b * t17 + c * t16, t19 = p * t17 + r * t16;
    *high_y += t10 * (1.0 / 3628800) + t11 * (1.0 / 39916800) + t12 * (1.0 / 479001600) + t13 * (1.0 / 6227020800.0) +
               t14 * (1.0 / 87178291200.0) + t15 * (1.0 / 1307674368000.0) + t16 * (1.0 / 20922789888000.0) +
               t17 * (1.0 / 355687428096000.0) + t18 * (1.0 / 6402373705728000.0) + t19 * (1.0 / 121645100408832000.0);
    *high_x += t10 * (1.0 / 39916800) + t11 * (1.0 / 479001600) + t12 * (1.0 / 6227020800.0) +
               t13 * (1.0 / 87178291200.0) + t14 * (1.0 / 1307674368000.0) + t15 * (1.0 / 20922789888000.0) +
               t16 * (1.0 / 355687428096000.0) + t17 * (1.0 / 6402373705728000.0) +
               t18 * (1.0 / 121645100408832000.0) + t19 * (1.0 / 2432902008176640000.0);
}

/* x and y after q in all lanes, from y0 with y' = d1; further terms only where a lane needs them. unfit: 1 where even they
 * are not accurate enough. */
INLINED void polynomials(const double *restrict y0, const double *restrict d1, const double *restrict a2,
                         const double *restrict kappa, const double *restrict q, double *restrict x, double *restrict y,
                         double *restrict unfit) {
    double t8[LANES], t9[LANES], high_x[LANES], high_y[LANES], far[LANES];
    EACH(l) {
        double b = -a2[l] * q[l], c = -kappa[l] * (q[l] * q[l]), t1 = d1[l] * q[l];
        terms t = first_terms(y0[l], t1, b, c);
        x[l] = (y0[l] + 0.5 * t1) + (t.t2 * (1.0 / 6) + t.t3 * (1.0 / 24)) + t.t4 * (1.0 / 120);
        y[l] = (y0[l] + t1) + (t.t2 * 0.5 + t.t3 * (1.0 / 6)) + t.t4 * (1.0 / 24);
        t8[l] = t.t8;
        t9[l] = t.t9;
        high_x[l] = t.high_x;
        high_y[l] = t.high_y;
        far[l] = fabs(b) * REACH + fabs(c) <= REACH * REACH ? 0.0 : 1.0;
        unfit[l] = fabs(b) * FAR_REACH + fabs(c) <= FAR_REACH * FAR_REACH ? 0.0 : 1.0;
    }
    if (any(far)) {
        EACH(l) {
            double further_x = high_x[l], further_y = high_y[l];
            further_terms(t8[l], t9[l], -a2[l] * q[l], -kappa[l] * (q[l] * q[l]), &further_x, &further_y);
            high_x[l] = far[l] > 0.0 ? further_x : high_x[l];
            high_y[l] = far[l] > 0.0 ? further_y : high_y[l];
        }
    }
    EACH(l) {
        x[l] = q[l] * (x[l] + high_x[l]);
        y[l] += high_y[l];
    }
}

/* Across lines of length h > 0, whose force begins at phi with slope kappa, under loads p: time, and w at the end. d = +1 inwards, -1
 * outwards; from_rest: y = 0 at the beginning. Energy, with the drag's work by the trapezoidal rule, gives a first guess of
 * the time, which x at that time corrects, from rest twice. again: tau holds the guess. unserved: 1 where that is not
 * accurate enough. */
INLINED void cross_lines(const double *restrict gamma, const double *restrict p, const double *restrict h,
                         const double *restrict phi, const double *restrict kappa, double d, int from_rest, int again,
                         const double *restrict w, double *restrict tau, double *restrict w1, double *restrict unserved) {
    double y0[LANES], d1[LANES], a2[LANES], q[LANES], x[LANES], y[LANES], u[LANES], unfit[LANES];
    EACH(l) {
        double length = h[l], k = kappa[l], load = d * (phi[l] - p[l]), damping = gamma[l] * k;
        double from = from_rest ? 0.0 : d * (w[l] - gamma[l] * phi[l]);
        if (again) {
            q[l] = tau[l];
        } else if (from_rest) { /* by inertia alone, and by damping alone */
            double slow = (1.0 / 3) * damping * length / (-load - 0.5 * k * length);
            q[l] = slow + sqrt(slow * slow + 2.0 * length / (-load - (1.0 / 6) * k * length));
        } else {
            double drag = 0.5 * (damping * length), before = from - drag;
            double square = before * before - length * (load + load + k * length);
            double y1 = sqrt(square > 0.0 ? square : 0.0) - drag, least = 0.1 * from;
            y1 = y1 > least ? y1 : least;
            double twice = 2.0 / (from + y1), guess = twice * length;
            q[l] = guess - guess * guess * (k * guess + damping * (y1 - from) * twice) * (1.0 / 12);
        }
        y0[l] = from;
        d1[l] = -load - damping * from;
        a2[l] = damping;
    }
    for (int pass = 0; pass <= from_rest; pass++) {
        if (pass > 0) EACH(l) q[l] += u[l];
        polynomials(y0, d1, a2, kappa, q, x, y, unfit);
        EACH(l) {
            double k = kappa[l], slope = -(d * (phi[l] - p[l]) + k * x[l]) - a2[l] * y[l], bend = -a2[l] * slope - k * y[l];
            double per_y = 1.0 / y[l], half = 0.5 * (slope * per_y), sixth = (1.0 / 6) * (bend * per_y);
            double part = (h[l] - x[l]) * per_y; /* h - x = y u + slope u^2/2 + bend u^3/6 + ..., inverted */
            double step = part * (1.0 - part * (half - (2.0 * (half * half) - sixth) * part));
            double third = (1.0 / 6) * (a2[l] * bend + k * slope);
            double end = y[l] + step * (slope + step * (0.5 * bend - step * third));
            double sure = fabs(part) < LONGEST_STEP * q[l] ? unfit[l] : 1.0; /* the step may be small by chance */
            u[l] = step;
            unserved[l] = end > 0.0 ? sure : 1.0;
            tau[l] = q[l] + step;
            w1[l] = d * end + gamma[l] * (phi[l] + d * (k * h[l]));
        }
    }
}

typedef struct {
    double h[LANES], phi[LANES], kappa[LANES], tau[LANES];
} lines;

/* One lane across its line, as the march does. */
static int cross_alone(double gamma, double load, double h, double phi, double kappa, double d, int from_rest, double w, double *tau,
                       double *w1) {
    double y = 0.0;
    motion m = {from_rest ? 0.0 : d * (w - gamma * phi), d * (phi - load), kappa, 0.5 * kappa * gamma};
    int left = move_to(&m, h, tau, &y);
    *w1 = d * y + gamma * (phi + d * (kappa * h));
    return left == REACHED;
}

/* Lanes for which one correction is not accurate enough: a second, or the march's closed form. */
static void cross_again(lanes *restrict s, lines *restrict n, double d, int from_rest,
                        const double *restrict unserved, double *restrict w1) {
    double tau[LANES], end[LANES], left[LANES];
    EACH(l) {
        left[l] = 1.0;
        tau[l] = end[l] = 0.0;
    }
    if (!from_rest) {
        memcpy(tau, n->tau, sizeof tau);
        cross_lines(s->gamma, s->load, n->h, n->phi, n->kappa, d, 0, 1, s->w, tau, end, left);
    }
    for (int l = 0; l < LANES; l++) {
        if (unserved[l] == 0.0 || s->bad[l] > 0.0) continue;
        if (left[l] == 0.0) {
            n->tau[l] = tau[l];
            w1[l] = end[l];
            continue;
        }
        if (!cross_alone(s->gamma[l], s->load[l], n->h[l], n->phi[l], n->kappa[l], d, from_rest, s->w[l], &n->tau[l], &w1[l]))
            s->bad[l] = 1.0;
    }
}

INLINED void pass_lines(lanes *restrict s, lines *restrict n, double d, int from_rest) {
    double w1[LANES], unserved[LANES];
    cross_lines(s->gamma, s->load, n->h, n->phi, n->kappa, d, from_rest, 0, s->w, n->tau, w1, unserved);
    if (any(unserved)) cross_again(s, n, d, from_rest, unserved, w1);
    EACH(l) {
        s->w[l] = w1[l];
        s->time[l] += n->tau[l];
    }
}

static void pass_inwards(lanes *restrict s, lines *restrict n) { pass_lines(s, n, 1.0, 0); }
static void pass_from_rest(lanes *restrict s, lines *restrict n) { pass_lines(s, n, -1.0, 1); }
static void pass_outwards(lanes *restrict s, lines *restrict n) { pass_lines(s, n, -1.0, 0); }

/* The lines to nodes at x1, where the law is f1 and work1; moves the lanes there. docs/method.md, section 2. */
INLINED void make_lines(lanes *restrict s, lines *restrict n, double d, int from_rest, const double *restrict x1,
                        const double *restrict f1, const double *restrict work1) {
    EACH(l) {
        double h = x1[l] - s->xi[l], per_h = 1.0 / h, mean = (work1[l] - s->work[l]) * per_h;
        n->h[l] = d * h;
        n->kappa[l] = from_rest ? 2.0 * (mean - s->force[l]) * per_h : (f1[l] - s->force[l]) * per_h;
        n->phi[l] = from_rest ? s->force[l] : mean - 0.5 * n->kappa[l] * h;
        s->xi[l] = x1[l];
        s->force[l] = f1[l];
        s->work[l] = work1[l];
    }
}

/* ---------------------------------------------------------------- stretched stages */

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
