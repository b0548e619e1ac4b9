/* The way back from a turn: unloading branches, the stretched stages of laws that pull, dents. docs/method.md, section 6. */
#include "curve/film_law.h"

/* A shifted branch whose force at xi = 0 is still above 0 has no end and is refused. If that force is below this fraction
 * of its scale, it is rounding, and the branch ends at xi = 0. core_check.c, check_surface. */
static const double SURFACE_ROUNDING = 1e-12;

enum { LENGTH_STEPS = 100 };

/* The stage that a branch FILM_STRETCHED - k stretches. */
static const film_stage *stretched_stage(const film_curve *curve, int32_t branch) { return &curve->stage[FILM_STRETCHED - branch]; }

/* Force and work of a stretched stage: r f0(x) and r l W0(x) at x = (xi - xi_f)/l. docs/method.md, section 6. */
void film_law_stretched(const film_curve *curve, const film_line *line, double xi, double *force, double *work) {
    stage_law(curve, FILM_STRETCHED - line->branch, (xi - line->xi_origin) * line->per_recovery, force, work);
    *force *= line->f_max;
    *work *= line->f_max * line->exponent;
}

double film_slope_stretched(const film_curve *curve, const film_line *line, double xi) {
    double x = (xi - line->xi_origin) * line->per_recovery;
    return line->f_max * line->per_recovery * slope_at(&piece_at(curve, FILM_STRETCHED - line->branch, x)->force, x);
}

/* Its inner end is xi_max, not that of the stage. */
int film_stretched_inmost(const film_curve *curve, int32_t branch) {
    return stretched_stage(curve, branch)[1].unloading == FILM_SIMILAR;
}

double film_stretched_edge(const film_curve *curve, const film_state *s, int direction) {
    const film_stage *stage = stretched_stage(curve, s->branch);
    if (direction > 0 && film_stretched_inmost(curve, s->branch)) return s->xi_max;
    return s->xi_origin + s->exponent * (direction > 0 ? stage->end : stage->begin);
}

/* A short line near the origin of the piece's function takes Simpson's rule. */
double film_stretched_origin(const film_curve *curve, const film_state *s) {
    const film_line *line = &s->line;
    double x = (s->xi - line->xi_origin) * line->per_recovery;
    return line->xi_origin + line->exponent * piece_at(curve, FILM_STRETCHED - s->branch, x)->force.origin;
}

/* The stage, or stretched stage, that holds xi near a line on one; else the line's branch. */
int32_t film_branch_nearby(const film_curve *curve, const film_line *line, double xi) {
    int32_t branch = line->branch;
    while (branch > 0 && xi < curve->stage[branch].begin) branch--;
    while (branch >= 0 && branch + 1 < curve->stages && xi > curve->stage[branch].end) branch++;
    if (branch > FILM_STRETCHED) return branch;
    double x = (xi - line->xi_origin) * line->per_recovery;
    while (branch < FILM_STRETCHED && x < stretched_stage(curve, branch)->begin) branch++;
    while (!film_stretched_inmost(curve, branch) && x > stretched_stage(curve, branch)->end) branch--;
    return branch;
}

/* FILM_SIMILAR: r and l of a contact that turned in `piece` at xi under `force`. */
static void stretch_at(const film_piece *piece, double xi, double force, double *r, double *l) {
    double square = value_at(&piece->recovery, xi), root = sqrt(square * sqrt(square));
    *r = square > 0.0 ? fmax(root * root / (force + 2.0 * root), 1.0) : NAN;
    *l = cbrt(*r);
}

/* The stretched stages that go through (xi, force). The force of the last reversible stage grows with x from
 * its beginning to the end of its pieces; there force/r is sought by Newton's method in a bracket. */
static int stretch_stages(const film_curve *curve, film_line *run, double xi, double force) {
    const film_piece *piece = piece_at(curve, run->branch, xi);
    double r, l;
    stretch_at(piece, xi, force, &r, &l);
    double wanted = force / r;
    int32_t k = run->branch;
    while (k > 0 && curve->stage[k].unloading == FILM_SIMILAR) k--;
    double low = curve->stage[k].begin, high = piece_at(curve, k, INFINITY)->end;
    if (!(r > 0.0 && r < INFINITY && l > 0.0 && l < INFINITY && high < INFINITY)) return FILM_BAD_UNLOADING;
    if (!(wanted > value_at(&piece_at(curve, k, low)->force, low) && wanted < value_at(&piece_at(curve, k, high)->force, high)))
        return FILM_BAD_UNLOADING;
    double root = cbrt(1.0 + sqrt(fmax(1.0 + wanted, 0.0))), x = 3.0 * root * root * root * root - 4.0 * root; /* of JKR's law */
    x = fmin(fmax(x, low), high);
    for (int i = 0; i < LENGTH_STEPS; i++) {
        const film_function *g = &piece_at(curve, k, x)->force;
        double miss = value_at(g, x) - wanted, next = x - miss / slope_at(g, x);
        if (fabs(next - x) <= 4e-16 * fabs(x)) break;
        if (miss < 0.0) low = x; else high = x;
        x = next > low && next < high ? next : 0.5 * (low + high);
    }
    run->xi_free = run->xi_origin = xi - l * x;
    run->per_recovery = 1.0 / l;
    run->exponent = l;
    run->f_max = r;
    run->f_shift = run->work_free = 0.0;
    run->branch = FILM_STRETCHED - k;
    return FILM_OK;
}

/* The unloading rules of film_core.h. The branch is f_shift + f_max ((xi - xi_origin) per_recovery)^q, and its force
 * is 0 at xi_free. docs/method.md, section 6. */
int film_open_branch(const film_curve *curve, film_line *run, double xi, double force) {
    const film_piece *piece = piece_at(curve, run->branch, xi);
    int unloading = curve->stage[run->branch].unloading;
    if (unloading == FILM_RETRACE) return FILM_OK;
    if (unloading == FILM_SIMILAR) return stretch_stages(curve, run, xi, force);
    xi -= curve->compliance * force;
    double given = value_at(&piece->recovery, xi), q = value_at(&piece->exponent, xi), span, scale = force, origin;
    if (unloading == FILM_SHIFTED) {
        origin = 0.0;
        span = xi;
        scale = given * power_of(xi, q);
        double left = 1.0 - force / scale;
        run->xi_free = left > 0.0 ? pow(left, 1.0 / q) * xi : left > -SURFACE_ROUNDING ? 0.0 : NAN;
    } else if (unloading == FILM_RADIUS) {
        double load = force / sqrt(given);
        span = q == 1.5 ? cbrt(load * load) : pow(load, 1.0 / q);
        run->xi_free = origin = xi - span;
    } else {
        run->xi_free = origin = unloading == FILM_RESIDUAL ? given : fmax(xi - force / given, 0.0);
        span = xi - origin;
    }
    int long_enough = force * (xi - run->xi_free) > SHORTEST_RECOVERY * scale * xi; /* false where xi_free is NaN */
    if (!(span > 0.0 && span < INFINITY && q > 0.0 && long_enough)) return FILM_BAD_UNLOADING;
    run->xi_origin = origin;
    run->per_recovery = 1.0 / span;
    run->f_max = scale;
    run->f_shift = force - scale;
    run->work_free = (run->xi_free - origin) * run->f_shift * (1.0 - work_factor(q));
    run->exponent = q;
    run->branch = FILM_BRANCH;
    return FILM_OK;
}

static double dent(const film_curve *curve, double depth, double end) {
    int32_t k = curve->stages - 1;
    while (k > 0 && !(depth > curve->stage[k].begin)) k--;
    double force, work, r, l = 1.0;
    if (curve->stage[k].unloading == FILM_SIMILAR) {
        stage_law(curve, k, depth, &force, &work);
        stretch_at(piece_at(curve, k, depth), depth, force, &r, &l);
    }
    return end - l * curve->stage[0].begin;
}

void film_dents(const film_curve *curve, int64_t count, int32_t varying, const int32_t *places, const double *values,
                const double *depth, const double *end, double *dents) {
    film_curve own = *curve;
    double *doubles = (double *)&own;
    for (int64_t i = 0; i < count; i++) {
        for (int32_t k = 0; k < varying; k++) doubles[places[k]] = values[i * varying + k];
        dents[i] = dent(&own, depth[i], end[i]);
    }
}
