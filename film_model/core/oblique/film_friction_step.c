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

enum { ROOT_STEPS = 80 }; /* bisections that leave no double between, with a margin */

static const double TOLERANCE = 1e-15;   /* last terms of a step, over the scale; 30 reference values need 1e-13 */
static const double LONGEST = 0.5;       /* of a step, in units of time: a few steps in a contact, which takes about 3 */

double film_friction_force(const film_normal *normal, double z, double *slope) {
    double power = z > 0.0 ? normal->coefficient * pow(z, normal->exponent - 1.0)
                           : (normal->exponent > 1.0 ? 0.0 : normal->coefficient);
    *slope = normal->slope + normal->exponent * power;
    return z > 0.0 ? normal->slope * z + power * z : 0.0;
}

/* Term k of the product of two series. */
static double product(const double *a, const double *b, int k) {
    double sum = 0.0;
    for (int j = 0; j <= k; j++) sum += a[j] * b[k - j];
    return sum;
}

/* Term k of x^power for a series x with x[0] > 0: from x y' = power y x'. */
static void raise_term(const double *x, double power, double *y, int k) {
    if (k == 0) {
        y[0] = pow(x[0], power);
        return;
    }
    double sum = 0.0;
    for (int j = 1; j <= k; j++) sum += (power * j - (k - j)) * x[j] * y[k - j];
    y[k] = sum / (k * x[0]);
}

/* The force along a series of depths: power = x^(exponent - 1), f and its slope. */
typedef struct {
    double power[FILM_TERMS + 1], f[FILM_TERMS + 1], slope[FILM_TERMS + 1];
} forces;

static void force_term(const film_normal *normal, const double *x, forces *to, int k) {
    double linear = normal->slope * x[k], constant = k == 0 ? normal->slope : 0.0;
    if (normal->coefficient == 0.0 || normal->exponent == 1.0) {
        to->f[k] = linear + normal->coefficient * x[k];
        to->slope[k] = constant + (k == 0 ? normal->coefficient : 0.0);
        return;
    }
    raise_term(x, normal->exponent - 1.0, to->power, k);
    to->f[k] = linear + normal->coefficient * product(to->power, x, k);
    to->slope[k] = constant + normal->exponent * normal->coefficient * to->power[k];
}

/* The retraced record beside the series: forces at c, z_c', U, S, and dU/d(time of the record). */
typedef struct {
    forces at_c;
    double z_rate[FILM_TERMS + 1], U[FILM_TERMS + 1], S[FILM_TERMS + 1], bend[FILM_TERMS + 1], load[FILM_TERMS + 1];
    double pull[FILM_TERMS + 1];
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

void film_friction_series(const film_phase_rule *rule, const film_moment *at, film_taylor *of) {
    forces at_z;
    record r;
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

/* The step whose last two terms are the tolerance times the scale. */
static double length_of(const double *series, double scale) {
    double h = LONGEST;
    for (int k = FILM_FRICTION_ORDER - 1; k <= FILM_FRICTION_ORDER; k++) {
        double term = fabs(series[k]);
        if (term * pow(h, k) > TOLERANCE * scale) h = pow(TOLERANCE * scale / term, 1.0 / k);
    }
    return h;
}

double film_friction_length(const film_phase_rule *rule, const film_taylor *of, double scale) {
    double approach = rule->normal.approach;
    double h = fmin(length_of(of->nu, approach), length_of(of->v, scale));
    if (rule->kind == FILM_STICKS) return fmin(h, length_of(of->q, scale));
    if (rule->kind == FILM_SLIDES) return h;
    h = fmin(h, fmin(length_of(of->P, scale), length_of(of->c, approach)));
    return rule->piece == FILM_STRAIGHT ? h : fmin(h, length_of(of->v_c, scale));
}

double film_friction_at(const double *series, double t) {
    double sum = series[FILM_FRICTION_ORDER];
    for (int k = FILM_FRICTION_ORDER - 1; k >= 0; k--) sum = sum * t + series[k];
    return sum;
}

double film_friction_slope(const double *series, double t) {
    double sum = FILM_FRICTION_ORDER * series[FILM_FRICTION_ORDER];
    for (int k = FILM_FRICTION_ORDER - 1; k >= 1; k--) sum = sum * t + k * series[k];
    return sum;
}

/* Where a function of the series falls through 0 between low, where it is positive, and high: Newton, within the bracket. */
static double between(const double *series, double low, double high) {
    double t = 0.5 * (low + high);
    for (int step = 0; step < ROOT_STEPS; step++) {
        double value = film_friction_at(series, t), slope = film_friction_slope(series, t);
        if (value > 0.0) low = t;
        else high = t;
        double next = slope < 0.0 ? t - value / slope : low;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next == t || next <= low || next >= high) break;
        t = next;
    }
    return high;
}

double film_friction_root(const double *series, double h) {
    if (series[0] <= 0.0) return 0.0;
    if (film_friction_at(series, h) <= 0.0) return between(series, 0.0, h);
    if (!(film_friction_slope(series, 0.0) < 0.0 && film_friction_slope(series, h) > 0.0)) return 2.0 * h;
    double low = 0.0, high = h; /* it falls and rises: its least value may be below 0 */
    for (int step = 0; step < ROOT_STEPS && high > low; step++) {
        double middle = 0.5 * (low + high);
        if (film_friction_at(series, middle) <= 0.0) return between(series, 0.0, middle);
        if (film_friction_slope(series, middle) < 0.0) low = middle;
        else high = middle;
    }
    return 2.0 * h;
}
