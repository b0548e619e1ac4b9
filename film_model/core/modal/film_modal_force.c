/* The force of a step: a cubic through its values at Gauss nodes, which equal the law's at the indentation that this very
 * force leads to. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

enum { NEWTON_STEPS = 40, INDENTATION_STEPS = 100 };

/* Newton's method has converged when its last step is below this fraction of the largest force, or when the next one can be
 * expected to be: it converges quadratically. NEXT_STEP: margin of that expectation. */
static const double SETTLED = 1e-10, NEXT_STEP = 1e5;

/* How far beyond the end of its interval a series may be evaluated, as a fraction of the interval. */
static const double SERIES_OVERRUN = 1.05;

/* Displacement and velocity at node i, per unit of acceleration at node j and of h^2 and h: integrals of the LAGRANGE cubics. */
static const double NODE_MOVED[NODES][NODES] = {
    {0.0032305531606773847, -0.00125019789571951, 0.0005991199028416677, -0.00016908467308653538},
    {0.044654739516219934, 0.0110551611250369, -0.00157634391317577, 0.00031957112533586326},
    {0.10477319401975274, 0.1092821512463123, 0.0110551611250369, -0.000666856745256879},
    {0.14960613448280716, 0.196424835803152, 0.08371702284510275, 0.0032305531606773847},
};
static const double NODE_GAINED[NODES][NODES] = {
    {0.08696371128436346, -0.026604180084998794, 0.012627462689404725, -0.0035551496857956833},
    {0.18811811749986806, 0.16303628871563652, -0.027880428602470895, 0.006735500594538156},
    {0.16719192197418878, 0.35395300603374397, 0.16303628871563652, -0.014190694931141144},
    {0.1774825722545226, 0.31344511474186837, 0.35267675751627187, 0.08696371128436346},
};

/* Bernstein coefficients 2 .. 7 of the polynomial of degree 7 that is 0 at 0 with derivative 0, from its values at the nodes
 * and at 1 and its derivative at 1. */
static const double BENT[BENDS][BENDS] = {
    {17.415891222773297, -0.7925356768031432, 0.3903701271220669, -1.2994399588065046, 1.0952380952380953, -0.047619047619047616},
    {-27.141482953980734, 6.64293133180456, -3.632185162673299, 12.416451070563761, -10.485714285714286, 0.45714285714285713},
    {12.416451070563761, -3.632185162673299, 6.64293133180456, -27.141482953980734, 23.2, -1.0285714285714285},
    {-1.2994399588065046, 0.3903701271220669, -0.7925356768031432, 17.415891222773297, -15.80952380952381, 0.7619047619047619},
    {0.0, 0.0, 0.0, 0.0, 1.0, -0.14285714285714285},
    {0.0, 0.0, 0.0, 0.0, 1.0, 0.0},
};

/* ---------------------------------------------------------------- the law */

/* F and its derivatives on the line's branch; below 0 where a damped contact would pull. */
film_at film_law_on(const film_curve *curve, const film_line *line, double xi, double nu) {
    film_at at = {0.0, 0.0, 0.0};
    double work, rise;
    if (line->branch == FILM_FREE) return at;
    if (line->branch < 0) {
        contact_at(line, NULL, xi, &at.force, &work);
        at.by_xi = contact_slope(line, NULL, xi);
        return at;
    }
    const film_piece *piece = piece_at(curve, line->branch, xi);
    value_and_slope(&piece->force, xi, &at.force, &at.by_xi);
    if (line->damper > 0.0) {
        value_and_slope(&piece->damping, xi, &at.by_nu, &rise);
        at.by_nu *= line->damper;
        at.by_xi += line->damper * rise * nu;
        at.force += at.by_nu * nu;
    }
    return at;
}

/* The indentation xi at which xi + rest f(xi) = depth: Newton's method in a bracket, as the sum grows with xi. */
double film_indentation(const film_curve *curve, const film_line *line, double rest, double depth) {
    if (rest == 0.0 || line->branch == FILM_FREE) return depth;
    double low = line->xi_free, high = depth, xi;
    if (line->branch >= 0) {
        const film_piece *piece = piece_at(curve, line->branch, depth);
        low = curve->stage[line->branch].begin;
        if (piece->force.form != FILM_POWER) high = fmin(depth, piece->force.origin + SERIES_OVERRUN / piece->force.per_span);
    }
    if (!(depth > low)) return depth;
    xi = high;
    for (int k = 0; k < INDENTATION_STEPS; k++) {
        film_at at = film_law_on(curve, line, xi, 0.0);
        double miss = xi + rest * at.force - depth, next = xi - miss / (1.0 + rest * at.by_xi);
        if (fabs(next - xi) <= 4e-16 * fabs(depth)) return next;
        if (miss < 0.0) low = xi; else high = xi;
        xi = next > low && next < high ? next : 0.5 * (low + high);
    }
    return xi;
}

/* ---------------------------------------------------------------- within a step */

/* x and v of the impactor tau after the beginning of the step. */
void film_ball_at(const film_modal *s, double tau, double *x, double *v) {
    tau -= s->since;
    double per = 1.0 / (s->unit * s->unit), gained = s->load * tau, moved = 0.5 * s->load * tau * tau;
    *v = s->v;
    *x = s->x;
    if (s->kind == FILM_STEP_REST) return;
    if (s->kind == FILM_STEP_CONTACT) {
        double theta = tau / s->h, power = tau, of[NODES];
        film_force_powers(s, of);
        for (int k = 0; k < NODES; k++) {
            gained -= of[k] * power / (k + 1);
            moved -= of[k] * power * tau / ((k + 1) * (k + 2));
            power *= theta;
        }
    }
    *v = s->v + per * gained;
    *x = s->x + s->v * tau + per * moved;
}

double film_force_at(const film_modal *s, double theta) {
    double of[NODES];
    film_force_powers(s, of);
    return of[0] + theta * (of[1] + theta * (of[2] + theta * of[3]));
}

/* x - sum w_n over the step, as Bernstein coefficients. */
void film_depth_polynomial(const film_modal *s, double bernstein[DEGREE + 1]) {
    double depth = s->x - s->shift, slope = (s->v - s->rate) * s->h / DEGREE;
    for (int k = 0; k <= DEGREE; k++) bernstein[k] = depth + k * slope + (k >= 2 ? s->bend[k - 2] : 0.0);
}

int film_pushes(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], double theta) {
    film_state at = s->contact;
    double rate[DEGREE + 1];
    for (int k = 0; k < DEGREE; k++) rate[k] = DEGREE * (depth[k + 1] - depth[k]);
    at.xi = film_bernstein(depth, DEGREE, theta);
    at.nu = film_bernstein(rate, DEGREE - 1, theta) * s->unit / s->h;
    if (at.branch == FILM_FREE && !(at.xi > at.xi_free)) return 0;
    at.xi = fmax(at.xi, CREPT); /* where f and c are not both 0 */
    return film_release_margin(curve, &at) > 0.0;
}

double film_push_changes(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], double low, double high) {
    int after = film_pushes(curve, s, depth, high);
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (low + high);
        if (film_pushes(curve, s, depth, middle) == after) high = middle; else low = middle;
    }
    return high;
}

/* ---------------------------------------------------------------- the step */

/* w_n and w_n' at the end of the step, and their sums into the state. */
static void end_modes(const film_structure *structure, const film_table *table, film_modal *s, double *waves) {
    double p[NODES], sums[2];
    film_force_cubic(s, p);
    film_loops_of(structure)->move(structure, table, waves + begins_at(structure, s), waves + ends_at(structure, s), p, sums);
    s->end_shift = sums[0];
    s->end_rate = sums[1];
}

/* Solves four equations by elimination; a[i][NODES] is the right side. 0 if a pivot is 0 or not finite. No pivoting is needed:
 * as the step becomes short the matrix becomes diagonal, and Gauss's collocation has positive pivots. */
static int solve_four(double a[NODES][NODES + 1], double x[NODES]) {
    double per[NODES];
    for (int k = 0; k < NODES; k++) {
        if (!(fabs(a[k][k]) > 0.0 && fabs(a[k][k]) < INFINITY)) return 0;
        per[k] = 1.0 / a[k][k];
        for (int i = k + 1; i < NODES; i++) {
            double factor = a[i][k] * per[k];
            for (int j = k + 1; j <= NODES; j++) a[i][j] -= factor * a[k][j];
        }
    }
    for (int k = NODES - 1; k >= 0; k--) {
        x[k] = a[k][NODES];
        for (int j = k + 1; j < NODES; j++) x[k] -= a[k][j] * x[j];
        x[k] *= per[k];
    }
    return 1;
}

static void set_equations(const film_structure *structure, const film_modal *s, const double *waves, const film_table *table,
                          double h, film_equations *e) {
    double w[NODES], u[NODES] = {0.0}, per = 1.0 / (s->unit * s->unit);
    const double *begin = waves + begins_at(structure, s);
    film_loops_of(structure)->free_sums(structure, table, begin, w, s->kind == FILM_STEP_CONTACT && s->contact.damper > 0.0 ? u : NULL);
    for (int i = 0; i < NODES; i++) {
        double t = NODE_AT[i] * h;
        e->depth[i] = s->x + t * (s->v + 0.5 * per * s->load * t) - w[i];
        e->rate[i] = s->v + per * s->load * t - u[i];
        for (int j = 0; j < NODES; j++) {
            e->moved[i][j] = per * (h * h * NODE_MOVED[i][j] + s->mass * table->nodes[NODES * i + j]);
            e->gained[i][j] = per * (h * NODE_GAINED[i][j] + s->mass * table->node_rates[NODES * i + j]);
        }
    }
}

/* Newton's method from the forces in s; FILM_TOO_MANY: it does not converge. */
int film_solve_forces(const film_curve *curve, film_modal *s, const film_equations *e) {
    double a[NODES][NODES + 1], x[NODES], before = 0.0;
    for (int k = 0; k < NEWTON_STEPS; k++) {
        double most = 1e-3 * s->peak, step = 0.0;
        for (int i = 0; i < NODES; i++) {
            double xi = e->depth[i] - s->rest * s->force[i], nu = e->rate[i];
            for (int j = 0; j < NODES; j++) {
                xi -= e->moved[i][j] * s->force[j];
                nu -= e->gained[i][j] * s->force[j];
            }
            film_at at = film_law_on(curve, &s->contact.line, xi, nu * s->unit);
            for (int j = 0; j < NODES; j++) a[i][j] = at.by_xi * e->moved[i][j] + at.by_nu * s->unit * e->gained[i][j];
            a[i][i] += 1.0 + s->rest * at.by_xi;
            a[i][NODES] = at.force - s->force[i];
        }
        if (!solve_four(a, x)) return FILM_TOO_MANY;
        for (int i = 0; i < NODES; i++) {
            s->force[i] += x[i];
            if (fabs(s->force[i]) > most) most = fabs(s->force[i]);
            if (fabs(x[i]) > step) step = fabs(x[i]);
        }
        if (!(most < 1e200)) return FILM_TOO_MANY;
        if (step <= SETTLED * most || NEXT_STEP * step * step * step <= SETTLED * most * before * before) return FILM_OK;
        before = step;
    }
    return FILM_TOO_MANY;
}

/* The forces of a step of h from the current point, whose table is given; in flight they are 0. *error: estimate of the error
 * of the impulse over the impactor's momentum at the start. FILM_TOO_MANY: no solution. */
int film_try_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves,
                  const film_table *table, double h, film_equations *e, double *error) {
    double third = 0.0;
    set_equations(structure, s, waves, table, h, e);
    s->h = h;
    *error = 0.0;
    if (s->kind != FILM_STEP_CONTACT) memset(s->force, 0, sizeof s->force);
    int status = FILM_OK;
    if (structure->carried > 0) status = film_stretch_step(structure, curve, s, waves, table, e, error);
    else if (s->kind == FILM_STEP_CONTACT) status = film_solve_forces(curve, s, e);
    if (status < 0 || s->kind != FILM_STEP_CONTACT) return status;
    for (int j = 0; j < NODES; j++) third += LEGENDRE_3[j] * s->force[j];
    *error += fabs(third) * h / (s->speed * s->unit * s->unit);
    return status;
}

/* The motion at the end of the step that was tried last, and the interpolation over it. */
int film_take_step(const film_structure *structure, film_modal *s, double *waves, const film_table *table, const film_equations *e) {
    double target[BENDS], h = s->h;
    end_modes(structure, table, s, waves);
    if (structure->carried > 0) film_stretch_end(structure, s, waves, table);
    film_ball_at(s, h, &s->end_x, &s->end_v);
    double depth = s->x - s->shift, slope = (s->v - s->rate) * h;
    for (int i = 0; i < NODES; i++) {
        double moved = 0.0;
        for (int j = 0; j < NODES; j++) moved += e->moved[i][j] * s->force[j];
        target[i] = e->depth[i] - moved - depth - slope * NODE_AT[i];
    }
    target[NODES] = s->end_x - s->end_shift - depth - slope;
    target[NODES + 1] = (s->end_v - s->end_rate) * h - slope;
    for (int k = 0; k < BENDS; k++) {
        s->bend[k] = 0.0;
        for (int j = 0; j < BENDS; j++) s->bend[k] += BENT[k][j] * target[j];
    }
    return isfinite(s->end_x) && isfinite(s->end_shift) && isfinite(s->end_v) && isfinite(s->end_rate) ? FILM_OK : FILM_BAD_NUMBER;
}
