/* Where a fixed target turns the impactor back: energy. docs/method.md, section 5. */
#include "march/film_march.h"

/* Newton's method has converged when a step is below this fraction of the depth: the error of the next one is its square.
 * core_check.c, check_linear_law, at 1e-4. */
static const double NEWTON_SETTLED = 1e-9;

/* Kinetic energy left at xi on a fixed target, and its slope. `energy`: kinetic energy + work - load xi of the run. */
static double energy_at(const film_curve *curve, const film_line *run, double energy, double load, double xi,
                        series_place *near, double *slope) {
    double force, work;
    law_near(curve, run, xi, near, &force, &work);
    *slope = load - force;
    return energy - work + load * xi;
}

/* In a stage without an end: *inner, where energy is left, and *outer, where none is. The leading term of a power gives an
 * *outer of about the right size; elsewhere the way is doubled. */
static int bracket_turn(const film_curve *curve, const film_line *run, double xi, double total, double load, double *inner,
                        double *outer, series_place *near) {
    const film_piece *piece = piece_at(curve, run->branch, INFINITY);
    const film_function *g = &piece->force;
    double reach = INFINITY, slope;
    if (g->coefficient > 0.0 && g->square >= 0.0 && g->slope >= 0.0 && g->constant >= 0.0 && load <= 0.0 && curve->compliance == 0.0)
        reach = pow((g->exponent + 1.0) * (total + piece->work_at_begin) / g->coefficient, work_factor(g->exponent));
    *outer = reach < INFINITY ? g->origin + reach * (1.0 + 1e-12) : xi + 1.0;
    for (int k = 0; energy_at(curve, run, total, load, *outer, near, &slope) > 0.0; k++) {
        if (k >= DOUBLINGS || !(*outer < 1e300)) return FILM_BEYOND_LAW;
        *inner = *outer;
        *outer = xi + 2.0 * (*outer - xi);
    }
    return FILM_OK;
}

/* Where the law's work has used up the kinetic energy at the start and the load's work: Newton's method in a bracket.
 * docs/method.md, section 5. */
int film_turning_point(const film_curve *curve, const film_line *run, double xi, double work, double nu, double load,
                       double limit, series_place *near, double *to) {
    double energy = 0.5 * nu * nu, total = energy + work - load * xi, slope, inner = xi, outer = limit, at = limit;
    if (limit < INFINITY) {
        double left = energy_at(curve, run, total, load, limit, near, &slope);
        if (left >= 0.0) {
            *to = limit;
            return FILM_OK;
        }
        if (energy > 0.0) at = xi + (limit - xi) * sqrt(energy / (energy - left)); /* as if work grew as a square */
    } else {
        int status = bracket_turn(curve, run, xi, total, load, &inner, &outer, near);
        if (status < 0) return status;
        at = outer;
    }
    double d = outer > inner ? 1.0 : -1.0;
    for (int k = 0; k < ROOT_ITERATIONS; k++) {
        energy = energy_at(curve, run, total, load, at, near, &slope);
        if (energy >= 0.0) inner = at; else outer = at;
        double next = at - energy / slope;
        int inside = d * (next - inner) > 0.0 && d * (outer - next) > 0.0;
        int settled = fabs(next - at) <= (inside ? NEWTON_SETTLED : 4e-16) * fabs(at);
        at = inside ? next : settled ? at : 0.5 * (inner + outer);
        if (settled) break;
    }
    *to = at;
    return FILM_EVENT;
}
