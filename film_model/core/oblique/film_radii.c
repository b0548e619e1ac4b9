/* The contact radii of springs, as film_springs.h says. */
#include "curve/film_law.h"
#include "oblique/film_springs.h"

#include <math.h>

static double known(double x) { return isfinite(x) && x > 0.0 ? x : 0.0; }

/* dF/dz at a depth of loading, which ends at `last`: parabolas through three depths, lines at the ends. */
static double loading_slope(int64_t i, int64_t last, const double *force, const double *depth) {
    if (last == 0) return 0.0;
    if (i == 0) return (force[1] - force[0]) / (depth[1] - depth[0]);
    double before = depth[i] - depth[i - 1];
    if (i == last) return (force[i] - force[i - 1]) / before;
    double after = depth[i + 1] - depth[i], both = before + after;
    return -after / (before * both) * force[i - 1] + (after - before) / (before * after) * force[i]
         + before / (after * both) * force[i + 1];
}

static void radii_of_one(int64_t count, const double *force, const double *depth, const double *law, double modulus, double *first,
                         double *second) {
    int64_t turn = 0;
    double left = 0.0;
    for (int64_t i = 0; i < count; i++) {
        if (depth[i] > depth[turn]) turn = i;
        /* where contact ends: at the last force itself rounding would decide, which may leave a force of 0 or 1e-20 */
        if (force[i] > 0.0) left = depth[i + 1 < count ? i + 1 : i];
    }
    double whole = 0.0, way = fmax(depth[turn] - left, 1e-300); /* 1e-300: no division by 0 */
    for (int64_t i = 0; i < count; i++) {
        double in_dent = whole * sqrt(fmin(fmax((depth[i] - left) / way, 0.0), 1.0)), before = i > 0 ? first[i - 1] : 0.0;
        /* a law whose radius jumps down where it yields does not release what touches */
        double in_loading = i > 0 && depth[i] >= depth[i - 1] ? fmax(known(law[i]), before) : known(law[i]);
        first[i] = force[i] > 0.0 ? (i <= turn ? in_loading : in_dent) : 0.0;
        second[i] = force[i] > 0.0 ? (i <= turn ? known(loading_slope(i, turn, force, depth) / (2.0 * modulus)) : in_dent) : 0.0;
        if (i == turn) whole = first[i];
    }
}

void film_springs_radii(int64_t impacts, int64_t count, const double *force, const double *depth, const double *law, double modulus,
                        double *first, double *second) {
    for (int64_t i = 0; i < impacts; i++) {
        int64_t at = i * count;
        radii_of_one(count, force + at, depth + at, law + at, modulus, first + at, second + at);
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
