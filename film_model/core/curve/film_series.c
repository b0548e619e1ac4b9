/* A contact in series with a spring: the march's xi is the sum of the indentation and the spring's deflection.
 * docs/method.md, section 8. */
#include "curve/film_law.h"

/* How far beyond the end of its interval a series may be evaluated, as a fraction of the interval: the search for the
 * indentation must be able to pass the end of a piece. core_check.c, check_overrun. */
static const double SERIES_OVERRUN = 1.05;

enum { SERIES_STEPS = 100, SNAP_CHECKS = 40 };

/* Force and slope of the contact itself at an indentation. */
static void law_and_slope(const film_line *line, const film_piece *piece, double xi, double *force, double *slope) {
    if (line->branch >= 0) {
        value_and_slope(&piece->force, xi, force, slope);
        return;
    }
    double reach = xi - line->xi_origin, x = reach * line->per_recovery;
    double power = x > 0.0 ? line->f_max * power_of(x, line->exponent) : 0.0, f = power + line->f_shift;
    *force = f > 0.0 ? f : 0.0;
    *slope = x > 0.0 && xi > line->xi_free ? line->exponent * power / reach : 0.0;
}

/* Where the search for an indentation begins: from the place found before, ln(xi) is a straight line over ln(x), and
 * r^e about ((1 + e) r + 1 - e)/((1 - e) r + 1 + e). */
static double first_guess(double x, const series_place *near, double from, double high) {
    if (near == NULL || !(near->x > 0.0)) return high;
    double r = (x - from) / near->x, e = near->exponent;
    double guess = from + near->xi * ((1.0 + e) * r + 1.0 - e) / ((1.0 - e) * r + 1.0 + e);
    return guess > from && guess < high ? guess : high;
}

/* The indentation xi at which xi + compliance force(xi) = x: Newton's method in a bracket, as the sum grows with xi. It ends
 * when the next step would be rounding: steps fall as their squares. *found: the force there, NAN if the search ended
 * otherwise. docs/method.md, section 8. */
static double indentation_at(const film_curve *curve, const film_line *line, const film_piece *piece, double x,
                             series_place *near, double *found) {
    double c = curve->compliance, from = line->branch >= 0 ? 0.0 : line->xi_free, low = from, high = x, force, slope, last = 0.0;
    int known = 0; /* whether the root is above low */
    if (line->branch >= 0) {
        const film_function *g = &piece->force;
        low = g->origin;
        if (g->form != FILM_POWER) high = fmin(x, low + SERIES_OVERRUN / g->per_span);
    }
    *found = NAN;
    if (!(x > low)) return x;
    double xi = fmax(first_guess(x, near, from, high), low);
    for (int k = 0; k < SERIES_STEPS; k++) {
        law_and_slope(line, piece, xi, &force, &slope);
        double miss = xi + c * force - x, by = 1.0 + c * slope, step = miss / by, next = xi - step;
        if (near != NULL) *near = (series_place){x - from, xi - from, (x - from) / ((xi - from) * by)};
        if (fabs(step) <= 4e-16 * x || fabs(step) * step * step <= 1e-17 * x * last * last) {
            *found = force - slope * step;
            return next;
        }
        if (miss < 0.0) low = xi; else high = xi;
        known |= miss < 0.0;
        last = step;
        if (next > low && next < high) {
            xi = next;
            continue;
        }
        last = 0.0;
        if (!known) {
            known = 1;
            law_and_slope(line, piece, low, &force, &slope);
            if (!(low + c * force < x)) return low;
        }
        xi = 0.5 * (low + high);
    }
    return xi;
}

/* The spring stores c f^2/2. docs/method.md, section 8. */
void film_law_in_series(const film_curve *curve, const film_line *line, double x, series_place *near, double *force, double *work) {
    const film_piece *piece = line->branch >= 0 ? piece_at(curve, line->branch, x) : 0;
    if (line->branch == FILM_FREE) {
        *force = *work = 0.0;
        return;
    }
    double xi = indentation_at(curve, line, piece, x, near, force);
    if (*force > 0.0 && line->branch >= 0 && piece->force.form == FILM_SERIES)
        *work = fmax(xi - piece->force.origin, 0.0) * value_at(&piece->mean, xi) - piece->work_at_begin;
    else
        contact_at(line, piece, xi, force, work);
    *work += 0.5 * curve->compliance * *force * *force;
}

/* d force/d(xi + c force) = f'/(1 + c f'). docs/method.md, section 8. */
double film_slope_in_series(const film_curve *curve, const film_line *line, double x) {
    const film_piece *piece = line->branch >= 0 ? piece_at(curve, line->branch, x) : 0;
    if (line->branch == FILM_FREE) return 0.0;
    double force, slope = contact_slope(line, piece, indentation_at(curve, line, piece, x, NULL, &force));
    return slope / (1.0 + curve->compliance * slope);
}

/* From the march's own xi, rate and shift to those of the contact: the spring's deflection belongs to the target.
 * docs/method.md, section 8. */
void film_split_off_spring(const film_curve *curve, const film_line *line, double values[5]) {
    double bent = curve->compliance * values[2];
    if (curve->compliance == 0.0 || line->branch == FILM_FREE) return;
    values[1] *= 1.0 - curve->compliance * law_slope(curve, line, values[0]);
    values[0] -= bent;
    values[4] += bent;
}

/* Whether a function is sure not to fall: d/dz of a series is at least a_1 - sum k^2 |a_k|, as T_k' <= k^2. */
static int never_falls(const film_function *g) {
    if (g->form == FILM_POWER) return g->slope >= 0.0 && g->square >= 0.0 && g->coefficient >= 0.0;
    double least = g->terms > 1 ? g->series[1] : 0.0;
    for (int k = 2; k < g->terms; k++) least -= k * k * fabs(g->series[k]);
    return least >= 0.0;
}

/* Whether xi + c f does not grow with xi everywhere in a piece that begins at xi = from. */
static int snaps_through(const film_piece *piece, double from, double c) {
    double length = piece->end < INFINITY ? piece->end - from : 9.0 * from + 10.0;
    for (int k = 1; k <= SNAP_CHECKS && !never_falls(&piece->force); k++)
        if (!(1.0 + c * slope_at(&piece->force, from + length * k / SNAP_CHECKS) > 0.0)) return 1;
    return 0;
}

/* Ends of stages and pieces become values of xi + c f, and the work counts the spring's. docs/method.md, section 8. */
int film_put_in_series(film_curve *curve, double c) {
    double begin = 0.0, from = 0.0;
    if (curve->compliance != 0.0 || !(c > 0.0 && c < INFINITY)) return FILM_BAD_CURVE;
    for (int32_t k = 0; k < curve->stages; k++) {
        film_stage *stage = &curve->stage[k];
        film_piece *piece = &curve->piece[stage->first], *last = piece + stage->count - 1;
        double force = value_at(&piece->force, stage->begin), added = 0.5 * c * force * force;
        for (; piece <= last; piece++) {
            if (snaps_through(piece, from, c)) return FILM_BAD_CURVE;
            from = piece->end;
            piece->work_at_begin += added;
            if (from < INFINITY) piece->end += c * value_at(&piece->force, from);
        }
        stage->begin = begin;
        stage->end = begin = last->end;
    }
    curve->compliance = c;
    return FILM_OK;
}

int film_spring(film_curve *curve, double compliance) {
    int status = film_put_in_series(curve, compliance);
    return status < 0 ? status : film_check_curve(curve);
}
