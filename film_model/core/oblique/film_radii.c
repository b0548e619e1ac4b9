/* The contact radii of a contact that yields, as film_springs.h says. */
#include "oblique/film_springs.h"

#include <math.h>

static double known(double x) { return isfinite(x) && x > 0.0 ? x : 0.0; }

/* dF/dz at a depth of loading, which ends at `last`: parabolas through three depths, lines at the ends. */
static double slope_at(int64_t i, int64_t last, const double *force, const double *depth) {
    if (last == 0) return 0.0;
    if (i == 0) return (force[1] - force[0]) / (depth[1] - depth[0]);
    double before = depth[i] - depth[i - 1];
    if (i == last) return (force[i] - force[i - 1]) / before;
    double after = depth[i + 1] - depth[i], both = before + after;
    return -after / (before * both) * force[i - 1] + (after - before) / (before * after) * force[i]
         + before / (after * both) * force[i + 1];
}

void film_springs_radii(int64_t count, const double *force, const double *depth, const double *law, double modulus, double *first,
                        double *second) {
    int64_t turn = 0;
    double left = 0.0;
    for (int64_t i = 0; i < count; i++) {
        if (depth[i] > depth[turn]) turn = i;
        /* where contact ends: at the last force itself rounding would decide, which may leave a force of 0 or 1e-20 */
        if (force[i] > 0.0) left = depth[i + 1 < count ? i + 1 : i];
    }
    double whole = known(law[turn]), way = fmax(depth[turn] - left, 1e-300); /* 1e-300: no division by 0 */
    for (int64_t i = 0; i < count; i++) {
        double opening = whole * sqrt(fmin(fmax((depth[i] - left) / way, 0.0), 1.0));
        first[i] = force[i] > 0.0 ? (i <= turn ? known(law[i]) : opening) : 0.0;
        second[i] = force[i] > 0.0 ? (i <= turn ? known(slope_at(i, turn, force, depth) / (2.0 * modulus)) : opening) : 0.0;
    }
}
