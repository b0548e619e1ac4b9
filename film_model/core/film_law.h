/* The law as the core evaluates it, for the march and for the batch. Internal. */
#ifndef FILM_LAW_H
#define FILM_LAW_H

#include "film_core.h"

#include <math.h>

static inline double raised(double x, double exponent) {
    if (exponent == 1.5) return x * sqrt(x);
    if (exponent == 1.0) return x;
    if (exponent == 2.0) return x * x;
    return pow(x, exponent);
}

/* 1/(q + 1), the work of x^q over x^(q+1). */
static inline double work_of(double exponent) {
    return exponent == 1.5 ? 0.4 : 1.0 / (exponent + 1.0);
}

static inline double chebyshev(const film_function *g, double z) {
    double b1 = 0.0, b2 = 0.0;
    for (int k = g->terms - 1; k > 0; k--) {
        double b = 2.0 * z * b1 - b2 + g->series[k];
        b2 = b1;
        b1 = b;
    }
    return z * b1 - b2 + g->series[0];
}

static inline double variable(const film_function *g, double xi) {
    double x = (xi - g->origin) * g->per_span;
    return x > 0.0 ? x : 0.0;
}

static inline double value(const film_function *g, double xi) {
    double x = variable(g, xi);
    if (g->form == FILM_SERIES) return chebyshev(g, 2.0 * x - 1.0);
    if (g->form == FILM_ROOT_SERIES) return chebyshev(g, 2.0 * sqrt(x) - 1.0);
    double f = g->constant + g->slope * x;
    return g->coefficient == 0.0 ? f : f + g->coefficient * raised(x, g->exponent);
}

/* The derivative of value(). Next to the singular point of a root it is as large as the law's there. */
static inline double slope_of(const film_function *g, double xi) {
    double x = variable(g, xi);
    if (g->form == FILM_POWER) {
        if (g->coefficient == 0.0 || (x == 0.0 && g->exponent < 1.0)) return g->slope;
        return g->slope + g->coefficient * (g->exponent * raised(x, g->exponent - 1.0));
    }
    double root = g->form == FILM_ROOT_SERIES ? sqrt(x > 1e-30 ? x : 1e-30) : 0.0;
    double z = root > 0.0 ? 2.0 * root - 1.0 : 2.0 * x - 1.0, before = 0.0, now = 0.0;
    for (int k = g->terms - 1; k > 0; k--) { /* T_k' = k U_{k-1} */
        double next = 2.0 * z * now - before + k * g->series[k];
        before = now;
        now = next;
    }
    return g->per_span * now * (root > 0.0 ? 1.0 / root : 2.0);
}

static inline const film_piece *piece_at(const film_curve *curve, int32_t stage, double xi) {
    const film_piece *piece = &curve->piece[curve->stage[stage].first];
    const film_piece *last = piece + curve->stage[stage].count - 1;
    while (piece < last && xi > piece->end) piece++;
    return piece;
}

static inline void piece_law(const film_piece *piece, double xi, double *force, double *work) {
    const film_function *g = &piece->force;
    if (g->form == FILM_POWER) {
        double x = variable(g, xi);
        double power = g->coefficient == 0.0 ? 0.0 : g->coefficient * raised(x, g->exponent);
        *force = g->constant + g->slope * x + power;
        *work = x * (g->constant + 0.5 * g->slope * x + power * work_of(g->exponent)) - piece->work_at_begin;
    } else {
        *force = value(g, xi);
        *work = fmax(xi - g->origin, 0.0) * value(&piece->mean, xi) - piece->work_at_begin;
    }
}

static inline void stage_law(const film_curve *curve, int32_t stage, double xi, double *force, double *work) {
    piece_law(piece_at(curve, stage, xi), xi, force, work);
}

/* The contact law at an indentation, on the piece that serves there: a loading stage, the unloading branch, or no contact. */
static inline void contact_at(const film_line *line, const film_piece *piece, double xi, double *force, double *work) {
    if (line->branch >= 0) {
        piece_law(piece, xi, force, work);
    } else if (line->branch == FILM_BRANCH) {
        double reach = xi - line->xi_origin, x = reach * line->per_recovery;
        double power = x > 0.0 ? line->f_max * raised(x, line->exponent) : 0.0, f = power + line->f_shift;
        *force = f > 0.0 ? f : 0.0;
        *work = reach * (power * work_of(line->exponent) + line->f_shift) - line->work_free;
    } else {
        *force = *work = 0.0;
    }
}

static inline double contact_slope(const film_line *line, const film_piece *piece, double xi) {
    if (line->branch >= 0) return slope_of(&piece->force, xi);
    double x = (xi - line->xi_origin) * line->per_recovery;
    if (line->branch != FILM_BRANCH || !(x > 0.0 && xi > line->xi_free)) return 0.0;
    return line->f_max * line->exponent * line->per_recovery * raised(x, line->exponent - 1.0);
}

/* law_at and law_slope in series with a spring: kept out of line, where they cost other laws nothing. */
void film_law_in_series(const film_curve *curve, const film_line *line, double x, double *force, double *work);
double film_slope_in_series(const film_curve *curve, const film_line *line, double x);

/* The true law where a line lives: at an indentation, or, in series with a spring, at indentation + compliance force. */
static inline void law_at(const film_curve *curve, const film_line *line, double x, double *force, double *work) {
    if (curve->compliance != 0.0) film_law_in_series(curve, line, x, force, work);
    else contact_at(line, line->branch >= 0 ? piece_at(curve, line->branch, x) : 0, x, force, work);
}

/* The slope of the force in law_at. */
static inline double law_slope(const film_curve *curve, const film_line *line, double x) {
    if (curve->compliance != 0.0) return film_slope_in_series(curve, line, x);
    return contact_slope(line, line->branch >= 0 ? piece_at(curve, line->branch, x) : 0, x);
}

/* c at xi. */
static inline double damping_at(const film_curve *curve, const film_line *line, double xi) {
    if (line->damper == 0.0 || line->branch < 0) return 0.0;
    return line->damper * value(&piece_at(curve, line->branch, xi)->damping, xi);
}

/* F at xi where the elastic force is f, unclipped: xi' (1 + gamma c) = nu - gamma f. */
static inline double total_force(const film_line *line, double c, double f, double nu) {
    return c == 0.0 ? f : f + c * (nu - line->gamma * f) / (1.0 + line->gamma * c);
}

/* atan(sqrt z)/sqrt z, and atanh for z < 0. */
static inline double arc(double z) {
    if (fabs(z) < 0.04) {
        double q = z * z;
        double even = 1.0 + q * (1.0 / 5 + q * (1.0 / 9 + q * (1.0 / 13 + q * (1.0 / 17 + q / 21))));
        double odd = 1.0 / 3 + q * (1.0 / 7 + q * (1.0 / 11 + q * (1.0 / 15 + q / 19)));
        return even - z * odd;
    }
    if (z > 0.0) return atan(sqrt(z)) / sqrt(z);
    return z > -1.0 ? atanh(sqrt(-z)) / sqrt(-z) : INFINITY;
}

static const double SHORTEST_RECOVERY = 1e-12; /* of depth times force: the work of a shorter branch is rounding */
static const double ROUNDED_TOUCH = 1e-12; /* a shifted branch that misses zero force by less ends at xi = 0 */

/* The unloading rule: a run that turns on a loading stage at xi (with the spring's deflection), under force, continues on
 * the branch that leads back from there, or, where the stage is reversible, on the stage itself. */
static inline int open_branch(const film_curve *curve, film_line *run, double xi, double force) {
    const film_piece *piece = piece_at(curve, run->branch, xi);
    int unloading = curve->stage[run->branch].unloading;
    if (unloading == FILM_RETRACE) return FILM_OK;
    xi -= curve->compliance * force;
    double given = value(&piece->recovery, xi), q = value(&piece->exponent, xi), span, scale = force, origin;
    if (unloading == FILM_SHIFTED) {
        origin = 0.0;
        span = xi;
        scale = given * raised(xi, q);
        double left = 1.0 - force / scale;
        run->xi_free = left > 0.0 ? pow(left, 1.0 / q) * xi : left > -ROUNDED_TOUCH ? 0.0 : NAN;
    } else if (unloading == FILM_RADIUS) {
        double load = force / sqrt(given);
        span = q == 1.5 ? cbrt(load * load) : pow(load, 1.0 / q);
        run->xi_free = origin = xi - span;
    } else {
        run->xi_free = origin = unloading == FILM_RESIDUAL ? given : fmax(xi - force / given, 0.0);
        span = xi - origin;
    }
    if (!(span > 0.0 && span < INFINITY && q > 0.0 && force * (xi - run->xi_free) > SHORTEST_RECOVERY * scale * xi)) return FILM_BAD_UNLOADING;
    run->xi_origin = origin;
    run->per_recovery = 1.0 / span;
    run->f_max = scale;
    run->f_shift = force - scale;
    run->work_free = (run->xi_free - origin) * run->f_shift * (1.0 - work_of(q)); /* the force is 0 there */
    run->exponent = q;
    run->branch = FILM_BRANCH;
    return FILM_OK;
}

/* Where a fixed target turns the impactor back on its run from xi, where the work is `work`, towards `limit`, under
 * load: FILM_OK with *to = limit if there is energy to reach it, FILM_EVENT with the turning point, FILM_BEYOND_LAW. */
int film_turning_point(const film_curve *curve, const film_line *run, double xi, double work, double nu, double load,
                       double limit, double *to);

#endif
