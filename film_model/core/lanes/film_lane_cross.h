/* Times across whole pieces on fixed targets. Internal to film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_CROSS_H
#define FILM_LANE_CROSS_H

#include "lanes/film_lane_law.h"

/* Where a piece begins, the work of its stage up to there, and its own. */
typedef struct {
    double begin, before, whole;
} fixed_piece;

INLINED fixed_piece piece_of(const batch_job *j, int32_t stage, int32_t p) {
    int first = p == j->curve->stage[stage].first;
    double before = first ? 0.0 : j->piece_work[p - 1];
    return (fixed_piece){first ? j->curve->stage[stage].begin : j->curve->piece[p - 1].end, before, j->piece_work[p] - before};
}

enum { PLACES = LANES > 1 ? LANES : SEVERAL };

/* The works of a piece, as piece_law_lanes has them, at PLACES: those of the lanes or, of one impact, SEVERAL points of the rule. */
static void works_at(const film_piece *piece, const double *restrict xi, double *restrict work) {
    const film_function *g = piece->force.form == FILM_POWER ? &piece->force : &piece->mean;
    double x[PLACES], z[PLACES], a[PLACES] = {0.0}, before[PLACES] = {0.0}, term[FILM_MAX_TERMS + 4] = {0.0};
    for (int i = 0; i < PLACES; i++) {
        x[i] = xi[i] - piece->force.origin;
        x[i] = x[i] > 0.0 ? x[i] : 0.0;
    }
    if (g->form == FILM_POWER) {
        double per = work_factor(g->exponent);
        int power = g->coefficient != 0.0, hertz = power && g->exponent == 1.5;
        for (int i = 0; i < PLACES && hertz; i++) a[i] = x[i] * sqrt(x[i]);
        for (int i = 0; i < PLACES && power && !hertz; i += LANES) power_lanes_of(&x[i], g->exponent, &a[i]);
        for (int i = 0; i < PLACES; i++)
            work[i] = x[i] * (g->constant + 0.5 * g->slope * x[i] + g->coefficient * a[i] * per) - piece->work_at_begin;
        for (int i = 0; i < PLACES && g->square != 0.0; i++) work[i] += g->square * (1.0 / 3) * (x[i] * x[i] * x[i]);
        return;
    }
    for (int i = 0; i < PLACES; i++) {
        z[i] = (xi[i] - g->origin) * g->per_span;
        z[i] = z[i] > 0.0 ? z[i] : 0.0;
    }
    for (int i = 0; i < PLACES && g->form == FILM_ROOT_SERIES; i++) z[i] = sqrt(z[i]);
    for (int i = 0; i < PLACES; i++) z[i] = 2.0 * (2.0 * z[i] - 1.0);
    memcpy(term, g->series, (size_t)g->terms * sizeof *term);
    for (int k = (g->terms + 2) / 4 * 4; k > 0; k -= 4) { /* Clenshaw's summation, as in chebyshev_lanes */
        double t0 = term[k], t1 = term[k - 1], t2 = term[k - 2], t3 = term[k - 3];
        for (int i = 0; i < PLACES; i++) {
            double p = z[i] * a[i] - before[i] + t0, q = z[i] * p - a[i] + t1;
            before[i] = z[i] * q - p + t2;
            a[i] = z[i] * before[i] - q + t3;
        }
    }
    for (int i = 0; i < PLACES; i++) work[i] = x[i] * (0.5 * z[i] * a[i] - before[i] + term[0]) - piece->work_at_begin;
}

/* The time across a whole piece, over length/v, depends on the margin alone, the velocity at the end over v: a Chebyshev
 * series over 0 .. 1. Its values are by Gauss's rule on the way to where force and slope at the end would stop the motion,
 * beyond the piece, so that no root lies near the end. ratio: length over that way; root: s^2 at the end. */
static void fit_crossing(const batch_job *j, int32_t p, const fixed_piece *own, crossing *across) {
    const film_piece *piece = &j->curve->piece[p];
    double length = piece->end - own->begin, whole = own->whole, end_force = j->piece_force[p], slope = slope_at(&piece->force, piece->end);
    double value[MOST_TERMS + LANES], at[MOST_TERMS + LANES], now[MOST_TERMS + LANES], before[MOST_TERMS + LANES];
    int32_t points = j->rule.count, terms = points + EXTRA_TERMS < MOST_TERMS ? points + EXTRA_TERMS : MOST_TERMS;
    if (!(whole > 0.0)) terms = 1; /* without force */
    slope = slope > 0.0 ? slope : 0.0;
    for (int32_t first = 0; first < terms; first += LANES) {
        double x[PLACES], w[PLACES], sum[LANES] = {0.0}, margin[LANES], root[LANES], ratio[LANES];
        EACH(l) at[first + l] = cos(3.14159265358979323846 * (first + l + 0.5) / terms);
        EACH(l) {
            margin[l] = 0.5 * (1.0 + at[first + l]);
            margin[l] *= margin[l]; /* of the energy */
            double left = margin[l] / (1.0 - margin[l]) * whole;
            ratio[l] = length / (length + 2.0 * left / (end_force + sqrt(end_force * end_force + 2.0 * slope * left)));
            root[l] = ratio[l] / (1.0 + sqrt(1.0 - ratio[l]));
        }
        for (int32_t i = 0; i < points; i++) {
            double s = j->rule.at[i], weight = j->rule.across[i];
            EACH(l) x[l] = own->begin + length * (root[l] * s * s * (2.0 - root[l] * s * s) / ratio[l]);
            works_at(piece, x, w);
            EACH(l) {
                double part = (w[l] - own->before) / whole;
                sum[l] += weight * (1.0 - root[l] * s * s) / sqrt(margin[l] + (1.0 - margin[l]) * (1.0 - part));
            }
        }
        EACH(l) value[first + l] = whole > 0.0 ? sum[l] * (root[l] / ratio[l]) : 1.0;
    }
    across->terms = terms;
    for (int32_t i = 0; i < terms; i++) {
        now[i] = 1.0;
        before[i] = at[i];
    }
    for (int32_t k = 0; k < terms; k++) {
        double sum = 0.0;
        for (int32_t i = 0; i < terms; i++) {
            double next = 2.0 * at[i] * now[i] - before[i];
            sum += value[i] * now[i];
            before[i] = now[i];
            now[i] = next;
        }
        across->term[k] = (k > 0 ? 2.0 : 1.0) / terms * sum;
    }
}

/* The same for one impact, by the rule itself. square: of the velocity. */
static void cross_by_rule(const batch_job *j, int32_t p, const fixed_piece *own, double *restrict square, double *restrict v,
                        double *restrict time) {
    const film_piece *piece = &j->curve->piece[p];
    const gauss_rule *rule = &j->rule;
    double part[PLACES], x[PLACES], w[PLACES], sum = 0.0, length = piece->end - own->begin, end = own->before + own->whole;
    double left = *square - 2.0 * own->whole, force = j->piece_force[p], slope = j->piece_slope[p];
    left = left > 0.0 ? left : 0.0;
    slope = slope > 0.0 ? slope : 0.0;
    double ratio = length / (length + left / (force + sqrt(force * force + slope * left)));
    double root = ratio / (1.0 + sqrt(1.0 - ratio)), per = length * (root / ratio);
    for (int32_t i = 0; i < rule->filled; i += PLACES) {
        for (int k = 0; k < PLACES; k++) {
            part[k] = rule->at[i + k] * rule->at[i + k];
            x[k] = own->begin + per * part[k] * (2.0 - root * part[k]);
        }
        works_at(piece, x, w);
        for (int k = 0; k < PLACES; k++) x[k] = rule->across[i + k] * (1.0 - root * part[k]) / sqrt(left + 2.0 * (end - w[k]));
        for (int k = 0; k < PLACES; k++) sum += x[k];
    }
    *time += own->whole > 0.0 ? per * sum : length / *v;
    *square = left;
    *v = sqrt(left);
}

/* Time across a first stage of exponent 3/2 over its length and 1/v, a hypergeometric function of the margin m,
 * 2F1(1/2, 2/5; 7/5; 1 - m^2), by powers of 2 m - 1: off by 4e-16.
 * test_batch::test_an_elastic_stage_on_a_half_space_needs_no_quadrature. */
enum { ELASTIC_TERMS = 20 };
static const double elastic_crossing[ELASTIC_TERMS] = {
    1.17669072775655, -0.21954913926491954, 0.0544358320439377, -0.014877384096266244, 0.0042711764881621225,
    -0.0012631804300619256, 0.00038107214983778426, -0.00011660587036074875, 3.60634181062296e-05, -1.1246593899248536e-05,
    3.5309996549791726e-06, -1.114603399891645e-06, 3.527924829633677e-07, -1.1223053038817836e-07, 3.673074447645098e-08,
    -1.182339974532726e-08, 3.0401979392263163e-09, -9.48402834374613e-10, 6.615019596334223e-10, -2.1993559056499493e-10};

static void cross_by_power(const fixed_piece *own, double length, double *restrict square, double *restrict v, double *restrict time) {
    double z[LANES], per[LANES], even[LANES] = {0.0}, odd[LANES] = {0.0};
    EACH(l) {
        double left = square[l] - 2.0 * own->whole;
        per[l] = 1.0 / v[l];
        square[l] = left > 0.0 ? left : 0.0;
        v[l] = sqrt(square[l]);
        z[l] = 2.0 * (v[l] * per[l]) - 1.0;
    }
    for (int k = ELASTIC_TERMS - 2; k >= 0; k -= 2) {
        EACH(l) {
            even[l] = even[l] * (z[l] * z[l]) + elastic_crossing[k];
            odd[l] = odd[l] * (z[l] * z[l]) + elastic_crossing[k + 1];
        }
    }
    EACH(l) time[l] += length * per[l] * (even[l] + z[l] * odd[l]);
}

/* Across the whole of a piece. square: of the velocity. */
static void cross_piece(batch_job *j, int32_t p, const fixed_piece *own, double *restrict square, double *restrict v,
                        double *restrict time) {
    crossing *across = &j->across[p];
    double length = j->curve->piece[p].end - own->begin, twice = 2.0 * own->whole;
    double z[LANES], per[LANES], a[LANES] = {0.0}, b[LANES] = {0.0};
    if (across->terms == 0) fit_crossing(j, p, own, across);
    EACH(l) {
        double left = square[l] - twice;
        per[l] = 1.0 / v[l];
        square[l] = left > 0.0 ? left : 0.0;
        v[l] = sqrt(square[l]);
        z[l] = 4.0 * (v[l] * per[l]) - 2.0;
    }
    for (int32_t k = across->terms - 1; k > 0; k--) {
        double term = across->term[k];
        EACH(l) {
            double next = z[l] * a[l] + (term - b[l]);
            b[l] = a[l];
            a[l] = next;
        }
    }
    EACH(l) time[l] += length * per[l] * (0.5 * z[l] * a[l] + (across->term[0] - b[l]));
}

#endif
