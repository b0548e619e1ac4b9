/* The contact radii of springs, as film_springs.h says. */
#include "curve/film_law.h"
#include "oblique/film_springs.h"

#include <math.h>

static double known(double x) { return x > 0.0 && x < INFINITY ? x : 0.0; }

static double larger(double a, double b) { return a > b ? a : b; } /* of numbers: fmax is a call */

/* A radius in loading: a law whose radius or slope falls where it yields, or whose slope jitters, releases nothing that touches. */
static double kept(double radius, int64_t i, const double *depth, const double *radii) {
    return i > 0 && depth[i] >= depth[i - 1] ? larger(known(radius), radii[i - 1]) : known(radius);
}

/* dF/dz at a depth of a loading or unloading, of which these are the first and last: parabolas through three depths, lines at the ends. */
static double recorded_slope(int64_t i, int64_t begin, int64_t end, const double *force, const double *depth) {
    if (begin >= end) return 0.0;
    if (i == begin || i == end) {
        int64_t to = i == end ? i : i + 1;
        return (force[to] - force[to - 1]) / (depth[to] - depth[to - 1]);
    }
    double before = depth[i] - depth[i - 1], after = depth[i + 1] - depth[i];
    double rise = after * after * (force[i] - force[i - 1]) + before * before * (force[i + 1] - force[i]);
    return rise / (before * after * (before + after));
}

/* What the deepest contact has left: its largest depth and radius, and the depth at which it ended. */
typedef struct {
    double deepest, whole, left;
} dent;

static double in_dent(const dent *d, double depth) {
    double way = larger(d->deepest - d->left, 1e-300); /* 1e-300: no division by 0 */
    double part = larger((depth - d->left) / way, 0.0);
    return d->whole * sqrt(part < 1.0 ? part : 1.0);
}

static void radii_of_contact(int64_t count, const double *force, const double *depth, const double *law, double modulus, dent *d,
                             double *first, double *second) {
    int64_t turn = 0;
    double left = 0.0;
    for (int64_t i = 0; i < count; i++) {
        if (depth[i] > depth[turn]) turn = i;
        /* where contact ends: at the last force itself rounding would decide, which may leave a force of 0 or 1e-20 */
        if (force[i] > 0.0) left = depth[i + 1 < count ? i + 1 : i];
    }
    for (int64_t i = 0; i < count; i++) {
        int in_loading = i <= turn;
        double slope = recorded_slope(i, in_loading ? 0 : turn + 1, in_loading ? turn : count - 1, force, depth) / (2.0 * modulus);
        first[i] = second[i] = 0.0;
        if (!(force[i] > 0.0)) continue;
        first[i] = in_loading && depth[i] > d->deepest ? kept(law[i], i, depth, first) : in_dent(d, depth[i]);
        second[i] = in_loading ? kept(slope, i, depth, second) : known(slope);
        if (i == turn && depth[i] > d->deepest) *d = (dent){depth[i], first[i], left};
    }
    if (turn == 0 || turn + 1 == count || !(force[turn] > 0.0 && force[turn + 1] > 0.0)) return;
    /* the second jumps at the turn, which lies between times: where a parabola through three depths has it, springs are met on average */
    double before = depth[turn] - depth[turn - 1], after = depth[turn] - depth[turn + 1];
    if (before + after > 0.0) second[turn] += (second[turn + 1] - second[turn]) * (after / (before + after));
}

void film_springs_radii(int64_t impacts, int64_t contacts, int64_t count, const double *force, const double *depth, const double *law,
                        double modulus, double *first, double *second) {
    for (int64_t i = 0; i < impacts; i++) {
        dent d = {-INFINITY, 0.0, 0.0};
        for (int64_t at = i * contacts * count; at < (i + 1) * contacts * count; at += count)
            radii_of_contact(count, force + at, depth + at, law + at, modulus, &d, first + at, second + at);
    }
}

double film_contact_slope(const film_curve *curve, const film_line *line, double x) {
    double slope = fmax(law_slope(curve, line, x), 0.0);
    return slope / (1.0 - curve->compliance * slope); /* law_slope has that of both in series */
}

void film_springs_slopes(const film_curve *curve, int64_t count, const double *force, const double *depth, double *slope) {
    film_line line = {.branch = 0};
    for (int64_t i = 0; i < count; i++) {
        double x = depth[i] + curve->compliance * force[i];
        while (line.branch > 0 && x < curve->stage[line.branch].begin) line.branch--;
        while (line.branch + 1 < curve->stages && x >= curve->stage[line.branch].end) line.branch++;
        slope[i] = force[i] > 0.0 ? film_contact_slope(curve, &line, x) : 0.0;
    }
}
