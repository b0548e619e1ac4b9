/* Taylor series of a contact that sticks, slips or slides, term by term from the equations of film_friction.h.
 *
 * On a stuck piece the recorded motion is retraced: with the time of the record as a function of time,
 *
 *     rate of the record's time: S = w'/U,   U = z_c' - s v_c,   z_c' = nu_c - gamma f(c)
 *     c' = S z_c',   nu_c' = S (load - f(c)),   v_c' = -S rate (P + s f(c))
 *
 * On a straight piece, of slope -s, c' = w'/2. Where stick has ended by |D'| = z', both w' and U are 0: then S = -1, as w'' and
 * dU/d(time of the record) are the same, and the later terms of S follow from the equation one order on. */
#include "oblique/film_friction_parts.h"

#include <math.h>
#include <string.h>

enum { ROOT_STEPS = 200 }; /* towards a root where the slope is 0 too, which halve what is left, or nearly so */

/* last terms of a step, over the scale, exact, coarse and quick; 30 reference values need 1e-13 */
static const double TOLERANCE[3] = {1e-15, 1e-10, 3e-7};
static const double ROUNDED = 4e-16; /* of a root, relative: steps are rounding from there on */
static const double LONGEST = 0.5; /* of a step, in units of time: a few steps in a contact, which takes about 3 */
static const double HIGHEST = 5.0; /* exponent of closed sliding, for the rule of its time */
static const double NEAR = 0.5; /* of the way to z = 0, the longest quick step */

int film_friction_sound(const film_normal *normal, double rate, double velocity) {
    double a = normal->approach, work = normal->slope + normal->coefficient;
    int signs = normal->slope >= 0.0 && normal->coefficient >= 0.0 && normal->gamma >= 0.0 && work > 0.0 && a > 0.0 && rate > 0.0;
    return signs && normal->exponent >= 1.0 && velocity != 0.0 && isfinite(work + normal->exponent + a + rate + velocity);
}

double film_friction_depth(const film_normal *normal) {
    double n = normal->exponent, work = 0.5 * normal->approach * normal->approach, depth = INFINITY;
    if (normal->slope > 0.0) depth = sqrt(2.0 * work / normal->slope);
    if (normal->coefficient > 0.0) depth = fmin(depth, pow((n + 1.0) * work / normal->coefficient, 1.0 / (n + 1.0)));
    return depth;
}

double film_friction_force(const film_normal *normal, double z, double *slope) {
    double power = z > 0.0 ? normal->coefficient * pow(z, normal->exponent - 1.0)
                           : (normal->exponent > 1.0 ? 0.0 : normal->coefficient);
    *slope = normal->slope + normal->exponent * power;
    return z > 0.0 ? normal->slope * z + power * z : 0.0;
}

double film_friction_work(const film_normal *normal, double z) {
    double n = normal->exponent;
    return 0.5 * normal->slope * z * z + normal->coefficient * pow(z, n + 1.0) / (n + 1.0);
}

film_moment film_friction_touched(const film_phase_rule *rule, double part, double depth, double velocity) {
    const film_normal *normal = &rule->normal;
    double t = depth, n = normal->exponent, slope, power = normal->coefficient * pow(depth, n);
    double once = normal->slope * depth * t / 2.0 + power * t / (n + 1.0);
    double twice = normal->slope * depth * t * t / 6.0 + power * t * t / ((n + 1.0) * (n + 2.0));
    film_moment at = {.time = t, .nu = 1.0 + normal->load * t - once};
    at.z = depth + 0.5 * normal->load * t * t - normal->gamma * once - twice;
    at.v = velocity - rule->rate * part * once;
    at.D = velocity * t - rule->rate * part * twice;
    at.q = part * film_friction_force(normal, at.z, &slope);
    return at;
}

double film_friction_first(const film_normal *normal, double rounding) {
    double least = normal->slope > 0.0 ? 1.0 : normal->exponent;
    double depth = 0.3 * pow(rounding, 1.0 / (2.0 * least + (normal->gamma > 0.0 ? 0.0 : 2.0)));
    if (normal->load == 0.0) return depth;
    return fmin(depth, 0.3 * pow(rounding / fmax(fabs(normal->load), rounding), 1.0 / (least + 2.0)));
}

/* Term k of the product of two series; two sums, which do not wait for each other. */
static double product(const double *a, const double *b, int k) {
    double even = 0.0, odd = 0.0;
    int j = 0;
    for (; j < k; j += 2) {
        even += a[j] * b[k - j];
        odd += a[j + 1] * b[k - j - 1];
    }
    return j == k ? even + a[k] * b[0] + odd : even + odd;
}

/* Term k of y = x^power for a series x with x[0] > 0, from x y' = power y x'. slopes: j x[j], and slopes[0] = 0. */
static void raise_term(const double *x, const double *slopes, double power, double *y, int k) {
    if (k == 0) {
        y[0] = pow(x[0], power);
        return;
    }
    double share = (power + 1.0) / k, sum[2] = {0.0, 0.0};
    for (int j = 1; j <= k; j++) sum[j % 2] += (share * slopes[j] - x[j]) * y[k - j];
    y[k] = (sum[0] + sum[1]) / x[0];
}

/* The force along a series of depths: power = x^(exponent - 1), f and its slope. steps: k x[k]. */
typedef struct {
    double steps[FILM_TERMS], power[FILM_TERMS], f[FILM_TERMS], slope[FILM_TERMS];
} forces;

static void force_term(const film_normal *normal, const double *x, forces *to, int k) {
    double linear = normal->slope * x[k], constant = k == 0 ? normal->slope : 0.0;
    if (normal->coefficient == 0.0 || normal->exponent == 1.0) {
        to->f[k] = linear + normal->coefficient * x[k];
        to->slope[k] = constant + (k == 0 ? normal->coefficient : 0.0);
        return;
    }
    to->steps[k] = k * x[k];
    raise_term(x, to->steps, normal->exponent - 1.0, to->power, k);
    to->f[k] = linear + normal->coefficient * product(to->power, x, k);
    to->slope[k] = constant + normal->exponent * normal->coefficient * to->power[k];
}

/* The retraced record beside the series: forces at c, z_c', U, S, and dU/d(time of the record). */
typedef struct {
    forces at_c;
    double z_rate[FILM_TERMS], U[FILM_TERMS], S[FILM_TERMS], bend[FILM_TERMS], load[FILM_TERMS];
    double pull[FILM_TERMS];
} record;

/* Term k of what follows from c, nu_c, v_c and P up to k. */
static void record_term(const film_phase_rule *rule, const film_taylor *of, record *r, int k) {
    force_term(&rule->normal, of->c, &r->at_c, k);
    if (rule->piece == FILM_STRAIGHT) return;
    r->z_rate[k] = of->nu_c[k] - rule->normal.gamma * r->at_c.f[k];
    r->U[k] = k == 0 && rule->edge ? 0.0 : r->z_rate[k] - rule->sign * of->v_c[k];
    r->load[k] = (k == 0 ? rule->normal.load : 0.0) - r->at_c.f[k];
    r->pull[k] = -rule->rate * (of->P[k] + rule->sign * r->at_c.f[k]);
    if (rule->edge) {
        double turn = rule->normal.gamma == 0.0 ? 0.0 : rule->normal.gamma * product(r->at_c.slope, r->z_rate, k);
        r->bend[k] = r->load[k] - turn - rule->sign * r->pull[k];
    }
}

/* Term k of S, with w' known up to k, at an edge up to k + 1. */
static void rate_term(const film_phase_rule *rule, const film_taylor *of, record *r, int k) {
    double left;
    if (!rule->edge) {
        left = of->way[k];
        for (int j = 1; j <= k; j++) left -= r->U[j] * r->S[k - j];
        r->S[k] = left / r->U[0];
        return;
    }
    if (k == 0) {
        r->S[0] = -1.0;
        return;
    }
    double known = 0.0; /* (k + 1) U[k + 1] without the part of S[k] */
    for (int j = 0; j < k; j++) known += r->S[j] * r->bend[k - j];
    left = of->way[k + 1] - r->S[0] * known / (k + 1);
    for (int j = 2; j <= k; j++) left -= r->U[j] * r->S[k + 1 - j];
    r->S[k] = left / (r->U[1] + r->S[0] * r->bend[0] / (k + 1));
}

/* Term k + 1 of z, nu, D and D', and of z' and w' there; q is known up to k. */
static void advance(const film_phase_rule *rule, film_taylor *of, forces *at_z, int k) {
    of->z[k + 1] = of->speed[k] / (k + 1);
    of->nu[k + 1] = ((k == 0 ? rule->normal.load : 0.0) - of->f[k]) / (k + 1);
    of->D[k + 1] = of->v[k] / (k + 1);
    of->v[k + 1] = -rule->rate * of->q[k] / (k + 1);
    force_term(&rule->normal, of->z, at_z, k + 1);
    of->f[k + 1] = at_z->f[k + 1];
    of->speed[k + 1] = of->nu[k + 1] - rule->normal.gamma * of->f[k + 1];
    of->way[k + 1] = of->speed[k + 1] - rule->sign * of->v[k + 1];
}

/* Terms k + 1 of P, c and the record. */
static void retrace(const film_phase_rule *rule, film_taylor *of, record *r, int k) {
    of->P[k + 1] = -rule->sign * product(r->at_c.slope, of->way, k) / (k + 1);
    if (rule->piece == FILM_STRAIGHT) {
        of->c[k + 1] = 0.5 * of->way[k] / (k + 1);
        return;
    }
    rate_term(rule, of, r, k);
    of->c[k + 1] = product(r->S, r->z_rate, k) / (k + 1);
    of->nu_c[k + 1] = product(r->S, r->load, k) / (k + 1);
    of->v_c[k + 1] = product(r->S, r->pull, k) / (k + 1);
}

/* Stick and sliding under f = slope z + coefficient z^1.5, in powers of a clock that runs with dt = y d(clock), y = sqrt(z):
 * all equations are polynomials then, and the series converge far beyond first touch. */
static void clocked_series(const film_phase_rule *rule, const film_moment *at, film_taylor *of) {
    double *y = of->root, pull[FILM_TERMS], slope[FILM_TERMS]; /* y, load - f, and y f'(z) */
    const film_normal *normal = &rule->normal;
    int sticks = rule->kind == FILM_STICKS;
    y[0] = sqrt(at->z), of->time[0] = 0.0, of->nu[0] = at->nu, of->D[0] = at->D, of->v[0] = at->v, of->q[0] = at->q;
    for (int k = 0; k < FILM_TERMS; k++) {
        of->z[k] = product(y, y, k);
        of->f[k] = normal->slope * of->z[k] + normal->coefficient * product(y, of->z, k);
        of->speed[k] = of->nu[k] - normal->gamma * of->f[k];
        of->way[k] = of->speed[k] - rule->sign * of->v[k];
        if (!sticks) of->q[k] = rule->sign * of->f[k];
        if (k == FILM_FRICTION_ORDER) break;
        pull[k] = (k == 0 ? normal->load : 0.0) - of->f[k];
        slope[k] = normal->slope * y[k] + 1.5 * normal->coefficient * of->z[k];
        y[k + 1] = 0.5 * of->speed[k] / (k + 1);
        of->time[k + 1] = y[k] / (k + 1);
        of->nu[k + 1] = product(y, pull, k) / (k + 1);
        of->D[k + 1] = rule->coarse == FILM_FRICTION_QUICK ? 0.0 : product(y, of->v, k) / (k + 1); /* for rows only */
        if (!sticks) {
            of->v[k + 1] = rule->sign * rule->rate * (of->nu[k + 1] - normal->load * of->time[k + 1]); /* of the impulse */
            continue;
        }
        of->v[k + 1] = -rule->rate * product(y, of->q, k) / (k + 1);
        of->q[k + 1] = product(slope, of->v, k) / (k + 1);
    }
}

void film_friction_series(const film_phase_rule *rule, const film_moment *at, film_taylor *of) {
    forces at_z;
    record r;
    if (rule->kind != FILM_SLIPS && rule->normal.exponent == 1.5) {
        clocked_series(rule, at, of);
        return;
    }
    memset(of->time, 0, sizeof of->time);
    of->time[1] = 1.0;
    of->z[0] = at->z, of->nu[0] = at->nu, of->D[0] = at->D, of->v[0] = at->v, of->q[0] = at->q;
    of->P[0] = at->P, of->c[0] = at->c, of->nu_c[0] = at->nu_c, of->v_c[0] = at->v_c;
    force_term(&rule->normal, of->z, &at_z, 0);
    of->f[0] = at_z.f[0];
    of->speed[0] = of->nu[0] - rule->normal.gamma * of->f[0];
    of->way[0] = rule->flat ? 0.0 : of->speed[0] - rule->sign * of->v[0];
    for (int k = 0; k < FILM_FRICTION_ORDER; k++) {
        if (rule->kind == FILM_STICKS) {
            of->q[k + 1] = product(at_z.slope, of->v, k) / (k + 1);
            advance(rule, of, &at_z, k);
            continue;
        }
        if (rule->kind == FILM_SLIDES) {
            of->q[k] = rule->sign * of->f[k];
            advance(rule, of, &at_z, k);
            continue;
        }
        of->q[k] = of->P[k] + rule->sign * of->f[k];
        record_term(rule, of, &r, k);
        advance(rule, of, &at_z, k);
        retrace(rule, of, &r, k);
    }
    if (rule->kind != FILM_STICKS) {
        of->q[FILM_FRICTION_ORDER] = rule->sign * of->f[FILM_FRICTION_ORDER];
        if (rule->kind == FILM_SLIPS) of->q[FILM_FRICTION_ORDER] += of->P[FILM_FRICTION_ORDER];
    }
}

/* Keeps the largest of the last two terms over the scale. */
static void watch_terms(const double *series, double scale, double last[2]) {
    for (int k = 0; k < 2; k++) last[k] = fmax(last[k], fabs(series[FILM_FRICTION_ORDER - 1 + k]) / scale);
}

double film_friction_length(const film_phase_rule *rule, const film_taylor *of, double scale) {
    double last[2] = {0.0, 0.0}, h = LONGEST;
    watch_terms(of->nu, 1.0, last);
    watch_terms(of->v, scale, last);
    if (rule->kind == FILM_STICKS || rule->coarse == FILM_FRICTION_QUICK) watch_terms(of->q, scale, last); /* quick steps are long */
    if (rule->kind == FILM_SLIPS) {
        watch_terms(of->P, scale, last);
        watch_terms(of->c, 1.0, last);
        if (rule->piece == FILM_STUCK) watch_terms(of->v_c, scale, last);
    }
    for (int k = 0; k < 2; k++) {
        if (last[k] > 0.0) h = fmin(h, pow(TOLERANCE[rule->coarse] / last[k], 1.0 / (FILM_FRICTION_ORDER - 1 + k)));
    }
    /* where the terms of z^n, n near 1, are small up to z = 0, although the series ends there */
    int near_line = rule->normal.exponent > 1.0 && rule->normal.exponent < 1.5 && rule->kind != FILM_SLIPS;
    if (rule->coarse == FILM_FRICTION_QUICK && near_line) h = fmin(h, NEAR * of->z[0] / fabs(of->z[1]));
    return h;
}

void film_friction_powers(double t, film_powers *to) {
    to->t = t;
    to->value[0] = 1.0, to->slope[0] = 0.0;
    for (int k = 1; k < FILM_TERMS; k++) {
        to->value[k] = t * to->value[k - 1];
        to->slope[k] = k * to->value[k - 1];
    }
}

double film_friction_sum(const double *series, const double *powers) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int k = FILM_TERMS;
    for (; k >= 4; k -= 4) { /* from the smallest terms on */
        for (int j = 0; j < 4; j++) sum[j] += series[k - 1 - j] * powers[k - 1 - j];
    }
    for (; k > 0; k--) sum[0] += series[k - 1] * powers[k - 1];
    return (sum[1] + sum[2]) + (sum[3] + sum[0]);
}

static double value_at(const double *series, double t, double *slope) {
    double sum = series[FILM_FRICTION_ORDER], change = 0.0;
    for (int k = FILM_FRICTION_ORDER - 1; k >= 0; k--) {
        change = change * t + sum;
        sum = sum * t + series[k];
    }
    *slope = change;
    return sum;
}

double film_friction_root(const double *series, const film_powers *end) {
    double sum[2] = {0.0, 0.0}, t = 0.0, value = series[0], slope = series[1];
    for (int k = 2; k < FILM_TERMS; k++) sum[k % 2] += (k - 1) * fabs(series[k]) * end->slope[k];
    double bend = end->t > 0.0 ? (sum[0] + sum[1]) / end->t : 0.0;
    /* value + slope dt - bend/2 dt^2 is a lower bound: a step to where it is 0 passes no root */
    for (int step = 0; step < ROOT_STEPS && value > 0.0; step++) {
        double dt = 2.0 * value / (sqrt(slope * slope + 2.0 * bend * value) - slope);
        if (dt <= ROUNDED * t) break;
        t += dt;
        if (!(t <= end->t)) return 2.0 * end->t;
        value = value_at(series, t, &slope);
    }
    return t;
}

/* Time from z = 0 to the speed nu > 0 under one power alone: z^(n + 1) = sin^2 theta, nu = cos theta; over theta^(2/(n + 1)) by Gauss's
 * rule, of which an error of 3e-6 is left for n = 5, and 1e-7 for 3. */
static double time_to(double n, double nu) {
    static const double AT[3] = {0.23861918608319693, 0.66120938646626448, 0.93246951420315205};
    static const double WEIGHTS[3] = {0.46791393457269104, 0.36076157304813861, 0.17132449237917036};
    double whole = pow(acos(fmin(nu, 1.0)), 2.0 / (n + 1.0)), sum = 0.0;
    for (int k = 0; k < 6; k++) {
        double x = 0.5 * (k < 3 ? 1.0 + AT[k] : 1.0 - AT[k - 3]), theta = pow(x * whole, 0.5 * (n + 1.0));
        sum += WEIGHTS[k % 3] * (n == 1.0 ? 1.0 : pow(theta / sin(theta), (n - 1.0) / (n + 1.0)));
    }
    return 0.5 * whole * sum;
}

int film_friction_slide(const film_phase_rule *rule, film_moment *now, double *turn) {
    const film_normal *normal = &rule->normal;
    double n = normal->coefficient == 0.0 ? 1.0 : normal->exponent, begin = now->nu, f_slope;
    int alone = (normal->coefficient == 0.0 || normal->slope == 0.0) && normal->gamma == 0.0 && normal->load == 0.0;
    if (rule->kind != FILM_SLIDES || rule->coarse != FILM_FRICTION_QUICK || rule->flat || !alone || n > HIGHEST) return -1;
    double where = (rule->sign * now->v - rule->rate * begin) / (1.0 - rule->rate); /* nu for w' = 0, which is linear in nu */
    int stops = where > -1.0 && where < begin;
    now->nu = stops ? where : -1.0;
    now->v -= rule->sign * rule->rate * (begin - now->nu);
    now->z = stops ? pow(1.0 - where * where, 1.0 / (n + 1.0)) : 0.0;
    now->q = rule->sign * film_friction_force(normal, now->z, &f_slope);
    double whole = time_to(n, 0.0), first = time_to(n, fabs(begin)), last = stops ? time_to(n, fabs(where)) : 0.0;
    double middle = now->time + (begin > 0.0 ? whole - first : first - whole);
    now->time = middle + (now->nu > 0.0 ? last - whole : whole - last);
    *turn = begin > 0.0 && now->nu < 0.0 ? middle : 0.0;
    return stops;
}
