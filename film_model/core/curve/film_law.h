/* The contact law as the core evaluates it: force, work and slope at an indentation. Internal.
 * docs/method.md, section 1. */
#ifndef FILM_LAW_H
#define FILM_LAW_H

#include "film_core.h"

#include <math.h>

/* Shortest unloading branch, as a fraction of the depth (weighted with the force): the work of a shorter one is lost in
 * rounding, so it is refused with FILM_BAD_UNLOADING. core_check.c, check_found: "a branch of 1e-13 of the depth". */
static const double SHORTEST_RECOVERY = 1e-12;

/* x^exponent; the exponents of most laws without pow(). */
static inline double power_of(double x, double exponent) {
    if (exponent == 1.5) return x * sqrt(x);
    if (exponent == 1.0) return x;
    if (exponent == 2.0) return x * x;
    if (exponent == 0.5) return sqrt(x);
    if (exponent == 0.25) return sqrt(sqrt(x));
    return pow(x, exponent);
}

/* 1/(q + 1): the integral of x^q is x^(q + 1)/(q + 1). */
static inline double work_factor(double exponent) {
    return exponent == 1.5 ? 0.4 : 1.0 / (exponent + 1.0);
}

/* Clenshaw's summation of a Chebyshev series at -1 <= z <= 1. */
static inline double chebyshev(const film_function *g, double z) {
    double b1 = 0.0, b2 = 0.0;
    for (int k = g->terms - 1; k > 0; k--) {
        double b = 2.0 * z * b1 - b2 + g->series[k];
        b2 = b1;
        b1 = b;
    }
    return z * b1 - b2 + g->series[0];
}

/* x = (xi - origin) per_span of a function, not below 0. */
static inline double scaled_distance(const film_function *g, double xi) {
    double x = (xi - g->origin) * g->per_span;
    return x > 0.0 ? x : 0.0;
}

/* A power without its last term. The square, which few laws have, by a branch: it costs the others 3 % of a batch else. */
static inline double plain_part(const film_function *g, double x) {
    double f = g->constant + g->slope * x;
    return g->square == 0.0 ? f : f + g->square * (x * x);
}

static inline double value_at(const film_function *g, double xi) {
    double x = scaled_distance(g, xi);
    if (g->form == FILM_SERIES) return chebyshev(g, 2.0 * x - 1.0);
    if (g->form == FILM_ROOT_SERIES) return chebyshev(g, 2.0 * sqrt(x) - 1.0);
    double f = plain_part(g, x);
    return g->coefficient == 0.0 ? f : f + g->coefficient * power_of(x, g->exponent);
}

/* The derivative of value_at(). The slope of a root is infinite where it begins: there a power gives the rest of the
 * function's slope, and a series the slope at x = 1e-30, so that the result stays finite. */
static inline double slope_at(const film_function *g, double xi) {
    double x = scaled_distance(g, xi);
    if (g->form == FILM_POWER) {
        double line = g->square == 0.0 ? g->slope : g->slope + 2.0 * g->square * x;
        if (g->coefficient == 0.0 || (x == 0.0 && g->exponent < 1.0)) return line;
        return line + g->coefficient * (g->exponent * power_of(x, g->exponent - 1.0));
    }
    double root = g->form == FILM_ROOT_SERIES ? sqrt(x > 1e-30 ? x : 1e-30) : 0.0;
    double z = root > 0.0 ? 2.0 * root - 1.0 : 2.0 * x - 1.0, before = 0.0, now = 0.0;
    for (int k = g->terms - 1; k > 0; k--) { /* T_k' = k U_{k-1}, the sum by Clenshaw's recurrence */
        double next = 2.0 * z * now - before + k * g->series[k];
        before = now;
        now = next;
    }
    return g->per_span * now * (root > 0.0 ? 1.0 / root : 2.0);
}

/* Both, of a power by one root, of a series by one loop. */
static inline void value_and_slope(const film_function *g, double xi, double *value, double *slope) {
    double x = scaled_distance(g, xi), z = 2.0 * x - 1.0, b1 = 0.0, b2 = 0.0, now = 0.0, before = 0.0;
    if (g->form == FILM_POWER) {
        double power = g->coefficient == 0.0 ? 0.0 : g->coefficient * power_of(x, g->exponent);
        *value = plain_part(g, x) + power;
        *slope = power == 0.0 ? slope_at(g, xi) : g->slope + g->exponent * power / x;
        if (power != 0.0 && g->square != 0.0) *slope += 2.0 * g->square * x;
        return;
    }
    if (g->form == FILM_ROOT_SERIES) {
        *value = value_at(g, xi);
        *slope = slope_at(g, xi);
        return;
    }
    for (int k = g->terms - 1; k > 0; k--) {
        double b = 2.0 * z * b1 - b2 + g->series[k], next = 2.0 * z * now - before + k * g->series[k];
        b2 = b1;
        b1 = b;
        before = now;
        now = next;
    }
    *value = z * b1 - b2 + g->series[0];
    *slope = g->per_span * now * 2.0;
}

/* The piece of a stage that holds xi; the last one beyond the end of the stage. */
static inline const film_piece *piece_at(const film_curve *curve, int32_t stage, double xi) {
    const film_piece *piece = &curve->piece[curve->stage[stage].first];
    const film_piece *last = piece + curve->stage[stage].count - 1;
    while (piece < last && xi > piece->end) piece++;
    return piece;
}

/* Force, and work since the stage began. */
static inline void piece_law(const film_piece *piece, double xi, double *force, double *work) {
    const film_function *g = &piece->force;
    if (g->form == FILM_POWER) {
        double x = scaled_distance(g, xi);
        double power = g->coefficient == 0.0 ? 0.0 : g->coefficient * power_of(x, g->exponent);
        *force = g->constant + g->slope * x + power;
        *work = x * (g->constant + 0.5 * g->slope * x + power * work_factor(g->exponent)) - piece->work_at_begin;
        if (g->square == 0.0) return;
        *force += g->square * (x * x);
        *work += g->square * (1.0 / 3) * (x * x * x);
    } else {
        *force = value_at(g, xi);
        *work = fmax(xi - g->origin, 0.0) * value_at(&piece->mean, xi) - piece->work_at_begin;
    }
}

static inline void stage_law(const film_curve *curve, int32_t stage, double xi, double *force, double *work) {
    piece_law(piece_at(curve, stage, xi), xi, force, work);
}

/* Of a shifted branch, nearer to its end than this fraction of the depth there, force and work are small differences of the
 * terms of film_open_branch: the power series about the end keeps their digits. tests/test_small_restitution.py. */
static const double SHORT_BRANCH = 0.05;

enum { BRANCH_TERMS = 16 }; /* of rounding at SHORT_BRANCH */

/* -f_shift ((1 + r)^q - 1) and its integral, r = (xi - xi_free)/xi_free: -f_shift is the power at xi_free. */
static inline void short_branch(const film_line *line, double from_free, double *force, double *work) {
    double r = from_free / line->xi_free, q = line->exponent, term = 1.0, sum = 0.0, integral = 0.0;
    for (int k = 1; k <= BRANCH_TERMS; k++) {
        term *= (q - k + 1.0) / k * r;
        sum += term;
        integral += term / (k + 1.0);
    }
    *force = fmax(-line->f_shift * sum, 0.0);
    *work = -line->f_shift * from_free * integral;
}

/* Force and work on the curve that a line belongs to: a loading stage, the unloading branch, or no contact (both 0).
 * The work of a branch counts from xi_free, where its force is 0. */
static inline void contact_at(const film_line *line, const film_piece *piece, double xi, double *force, double *work) {
    if (line->branch >= 0) {
        piece_law(piece, xi, force, work);
    } else if (line->branch == FILM_BRANCH) {
        double from_free = xi - line->xi_free;
        if (line->work_free < 0.0 && fabs(from_free) < SHORT_BRANCH * line->xi_free) { /* FILM_SHIFTED */
            short_branch(line, from_free, force, work);
            return;
        }
        double reach = xi - line->xi_origin, x = reach * line->per_recovery;
        double power = x > 0.0 ? line->f_max * power_of(x, line->exponent) : 0.0, f = power + line->f_shift;
        *force = f > 0.0 ? f : 0.0;
        *work = reach * (power * work_factor(line->exponent) + line->f_shift) - line->work_free;
    } else {
        *force = *work = 0.0;
    }
}

static inline double contact_slope(const film_line *line, const film_piece *piece, double xi) {
    if (line->branch >= 0) return slope_at(&piece->force, xi);
    double x = (xi - line->xi_origin) * line->per_recovery;
    if (line->branch != FILM_BRANCH || !(x > 0.0 && xi > line->xi_free)) return 0.0;
    return line->f_max * line->exponent * line->per_recovery * power_of(x, line->exponent - 1.0);
}

/* film_spring without film_check_curve. */
int film_put_in_series(film_curve *curve, double c);

/* The five values of film_evaluate, of indentation and spring together on the line, become those of the indentation. */
void film_split_off_spring(const film_curve *curve, const film_line *line, double values[5]);
/* Where the law in series was evaluated last, from where its force begins: the sum x, the indentation xi, and
 * d ln xi/d ln x. x is 0: nowhere yet. */
typedef struct {
    double x, xi, exponent;
} series_place;

/* law_at and law_slope in series with a spring, and along stretched stages; not inline, so that they cost other laws
 * nothing. */
void film_law_in_series(const film_curve *curve, const film_line *line, double x, series_place *near, double *force, double *work);
double film_slope_in_series(const film_curve *curve, const film_line *line, double x);
void film_law_stretched(const film_curve *curve, const film_line *line, double xi, double *force, double *work);
double film_slope_stretched(const film_curve *curve, const film_line *line, double xi);

/* Force and work of the true law on the curve that a line belongs to. x is the march's variable: the indentation or, in
 * series with a spring, indentation + compliance force. */
static inline void law_at(const film_curve *curve, const film_line *line, double x, double *force, double *work) {
    if (curve->compliance != 0.0) film_law_in_series(curve, line, x, NULL, force, work);
    else if (line->branch <= FILM_STRETCHED) film_law_stretched(curve, line, x, force, work);
    else contact_at(line, line->branch >= 0 ? piece_at(curve, line->branch, x) : 0, x, force, work);
}

/* law_at for one x after another of a line: `near` shortens the search in series with a spring. */
static inline void law_near(const film_curve *curve, const film_line *line, double x, series_place *near, double *force,
                            double *work) {
    if (curve->compliance != 0.0) film_law_in_series(curve, line, x, near, force, work);
    else law_at(curve, line, x, force, work);
}

/* The slope of the force that law_at gives. */
static inline double law_slope(const film_curve *curve, const film_line *line, double x) {
    if (curve->compliance != 0.0) return film_slope_in_series(curve, line, x);
    if (line->branch <= FILM_STRETCHED) return film_slope_stretched(curve, line, x);
    return contact_slope(line, line->branch >= 0 ? piece_at(curve, line->branch, x) : 0, x);
}

/* The damping c at xi. */
static inline double damping_at(const film_curve *curve, const film_line *line, double xi) {
    if (line->damper == 0.0 || line->branch < 0) return 0.0;
    return line->damper * value_at(&piece_at(curve, line->branch, xi)->damping, xi);
}

/* F = f + c xi' at xi, where the elastic force is f; it may be below 0. xi' = nu - gamma F, so
 * xi' (1 + gamma c) = nu - gamma f. */
static inline double total_force(const film_line *line, double c, double f, double nu) {
    return c == 0.0 ? f : f + c * (nu - line->gamma * f) / (1.0 + line->gamma * c);
}

/* How many numbers a family has of each contact. */
static inline int32_t film_family_numbers(const film_family *family) {
    return family->high == 0.0 ? family->nodes + 1 : 1;
}

/* Whether a stretched stage is the inmost, which ends at xi_max; where it ends; the singular point of its law at xi; the stage
 * or stretched stage that holds xi near a line on one, else the line's branch. */
int film_stretched_inmost(const film_curve *curve, int32_t branch);
double film_stretched_edge(const film_curve *curve, const film_state *s, int direction);
double film_stretched_origin(const film_curve *curve, const film_state *s);
int32_t film_branch_nearby(const film_curve *curve, const film_line *line, double xi);

/* The factors of a family's rows at a shape, and the end of the last stage. 0: shape or family are out of range. */
int film_factors(const film_family *family, const double *shape, double *of, double *end);

/* film_shape, without the pieces that begin where the work of the last stage exceeds `energy`: that stage then ends there. */
int film_shape_up_to(const film_family *family, const film_curve *whole, const double *shape, double energy, film_curve *curve);

/* Whether a leg outwards that begins under this force is pulled all the way: it does not creep, and takes FILM_COSINE. Affects
 * cost and accuracy only: a ball that leaves is not at rest there. */
static inline int film_is_pulled(double force, double pull) { return pull > 0.0 && force <= 1e-6 * pull; }

/* atan(sqrt z)/sqrt z, and its continuation atanh(sqrt -z)/sqrt -z for z < 0; its power series around 0. */
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

/* The unloading rule: a run that turns on a loading stage at xi, under `force`, goes on along the branch that leads back
 * from there or, where the stage is reversible, along the stage itself. FILM_BAD_UNLOADING: the branch is too short. */
int film_open_branch(const film_curve *curve, film_line *run, double xi, double force);

#endif
