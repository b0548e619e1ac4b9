/* Membrane forces of a structure that is bent by more than a fraction of its thickness: of the energy
 * 1/2 sum_k s_k^2, s_k = sum_ij forms_kij w_i w_j, over the first modes. Over a step the force on each of them is the cubic through its
 * values at the nodes, as the contact force is, so that the modes follow both exactly. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

/* The forces of contact and membrane are solved for in turn, until the latter can be expected to change by less than this fraction
 * of the largest, or than SHARE of the tolerance. A step that needs more turns is too long. In the limit of work so many numbers of
 * the forms, FORM_WORK, count as a step. */
static const double SETTLED = 1e-12, SHARE = 1e-3;
enum { TURNS = 25, FORM_WORK = 1000, ROWS = 4, PER_STEP = 4, PER_CARRIED = (2 * NODES + 3) * NODES };

/* The first guess is the last step's cubic, at most this many of its steps after it began. A turn is expected to leave no less than
 * LEAST_FACTOR of the change. */
static const double FARTHEST = 3.0, LEAST_FACTOR = 1e-4;

/* When the last cubic begins, and for how long it was made; the step that `moved` and `gained` are for, and the factor by which a
 * turn then reduced the change before. */
typedef struct {
    double begins, lasts, h, factor;
} carried_step;

/* Of each mode with membrane forces: accelerations at the nodes, their cubic, displacements at the nodes without them; displacement
 * and rate at node i by the acceleration at node j. */
typedef struct {
    double at_node[NODES], cubic[NODES], free[NODES], moved[NODES][NODES], gained[NODES][NODES];
} carried_mode;

static carried_step *step_of(const film_structure *structure, double *waves) {
    return (carried_step *)(void *)(waves + 4 * (size_t)structure->modes);
}

static carried_mode *modes_of(const film_structure *structure, double *waves) {
    return (carried_mode *)(void *)(waves + 4 * (size_t)structure->modes + PER_STEP);
}

size_t film_waves_size(const film_structure *structure) {
    size_t carried = (size_t)structure->carried;
    return 4 * (size_t)structure->modes + (carried > 0 ? PER_STEP + PER_CARRIED * carried : 0);
}

int film_structure_stretch(film_structure *structure, int32_t carried, int32_t stresses, const double *forms) {
    if (carried < 0 || carried > FILM_MOST_CARRIED || carried > structure->modes || stresses < 0) return FILM_BAD_NUMBER;
    size_t size = (size_t)stresses * (size_t)carried * (size_t)carried;
    for (size_t i = 0; i < size; i++)
        if (!isfinite(forms[i])) return FILM_BAD_NUMBER;
    structure->carried = carried;
    structure->stresses = stresses;
    structure->forms = forms;
    return FILM_OK;
}

/* Sum of s_k^2 at each node; slope: half its derivative by each w. ROWS rows of a form at a time, whose sums do not wait for each
 * other. */
static void squares(const film_structure *structure, double w[][NODES], double slope[][NODES], double sums[NODES]) {
    int32_t n = structure->carried;
    double pulled[FILM_MOST_CARRIED + ROWS][NODES];
    memset(slope, 0, sizeof slope[0] * (size_t)n);
    memset(sums, 0, sizeof(double) * NODES);
    for (int32_t k = 0; k < structure->stresses; k++) {
        const double *form = structure->forms + (size_t)k * (size_t)n * (size_t)n;
        double stress[NODES] = {0.0};
        for (int32_t i = 0; i < n; i += ROWS) {
            double pull[ROWS][NODES] = {{0.0}};
            const double *row[ROWS];
            for (int r = 0; r < ROWS; r++) row[r] = form + (size_t)(i + r < n ? i + r : i) * (size_t)n;
            for (int32_t j = 0; j < n; j++)
                for (int r = 0; r < ROWS; r++)
                    for (int c = 0; c < NODES; c++) pull[r][c] += row[r][j] * w[j][c];
            memcpy(pulled[i], pull, sizeof pull);
        }
        for (int32_t i = 0; i < n; i++)
            for (int c = 0; c < NODES; c++) stress[c] += pulled[i][c] * w[i][c];
        for (int32_t i = 0; i < n; i++)
            for (int c = 0; c < NODES; c++) slope[i][c] += 2.0 * stress[c] * pulled[i][c];
        for (int c = 0; c < NODES; c++) sums[c] += stress[c] * stress[c];
    }
}

/* How each mode answers to accelerations at the nodes, where it would be at the nodes, and a guess of its accelerations. */
static void set_carried(const film_structure *structure, const film_modal *s, double *waves, const film_table *table) {
    int32_t n = structure->modes;
    const double *w = waves + begins_at(structure, s), *u = w + n;
    carried_step *step = step_of(structure, waves);
    carried_mode *mode = modes_of(structure, waves);
    double since = s->time - step->begins;
    for (int32_t m = 0; m < structure->carried; m++) {
        for (int i = 0; i < NODES; i++) {
            double y[RESPONSES], per_h = 1.0, t = fmin(since + NODE_AT[i] * s->h, FARTHEST * step->lasts);
            const double *p = mode[m].cubic;
            size_t at = (size_t)i * (size_t)n + (size_t)m;
            mode[m].free[i] = w[m] * table->node_cos[at] + u[m] * table->node_sin[at];
            mode[m].at_node[i] = p[0] + t * (p[1] + t * (p[2] / 2.0 + t * p[3] / 6.0));
            if (s->h == step->h) continue;
            film_responses(structure->square[m], structure->drag[m], NODE_AT[i] * s->h, y);
            memset(mode[m].moved[i], 0, sizeof mode[m].moved[i]);
            memset(mode[m].gained[i], 0, sizeof mode[m].gained[i]);
            for (int k = 0; k < NODES; k++) {
                for (int j = 0; j < NODES; j++) {
                    mode[m].moved[i][j] += LAGRANGE[j][k] * FACTORIAL[k] * per_h * y[k + 2];
                    mode[m].gained[i][j] += LAGRANGE[j][k] * FACTORIAL[k] * per_h * y[k + 1];
                }
                per_h /= s->h;
            }
        }
    }
    if (s->h != step->h) step->factor = 1.0;
    step->h = s->h;
}

/* The membrane's accelerations at the nodes, from where the forces bring the modes; returns their largest change over their largest. */
static double renew(const film_structure *structure, const film_modal *s, carried_mode *mode) {
    double w[FILM_MOST_CARRIED][NODES], slope[FILM_MOST_CARRIED][NODES], sums[NODES], per = s->mass / (s->unit * s->unit);
    double change = 0.0, most = 0.0, sum = 0.0;
    for (int32_t m = 0; m < structure->carried; m++) {
        for (int i = 0; i < NODES; i++) {
            w[m][i] = mode[m].free[i];
            for (int j = 0; j < NODES; j++)
                w[m][i] += mode[m].moved[i][j] * (structure->share[m] * per * s->force[j] + mode[m].at_node[j]);
        }
    }
    squares(structure, w, slope, sums);
    for (int32_t m = 0; m < structure->carried; m++) {
        for (int i = 0; i < NODES; i++) {
            double next = -structure->share[m] * s->stretch * slope[m][i];
            change = fmax(change, fabs(next - mode[m].at_node[i]));
            most = fmax(most, fabs(next));
            sum += fabs(next);
            mode[m].at_node[i] = next;
        }
    }
    if (!(sum < INFINITY)) return INFINITY; /* fmax passes over NaN */
    return most > 0.0 ? change / most : 0.0;
}

/* depth and rate of the contact's equations under the membrane forces. */
static void shift_equations(const film_structure *structure, const carried_mode *mode, const film_equations *free,
                            film_equations *e) {
    for (int i = 0; i < NODES; i++) {
        e->depth[i] = free->depth[i];
        e->rate[i] = free->rate[i];
        for (int32_t m = 0; m < structure->carried; m++) {
            for (int j = 0; j < NODES; j++) {
                e->depth[i] -= mode[m].moved[i][j] * mode[m].at_node[j];
                e->rate[i] -= mode[m].gained[i][j] * mode[m].at_node[j];
            }
        }
    }
}

int film_stretch_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves,
                      const film_table *table, film_equations *e, double *error) {
    carried_step *step = step_of(structure, waves);
    carried_mode *mode = modes_of(structure, waves);
    film_equations free = *e;
    double change = 1.0, left = INFINITY, settled = fmax(SETTLED, SHARE * s->tolerance);
    set_carried(structure, s, waves, table);
    int64_t work = 0;
    for (int turn = 0; turn < TURNS && left > settled; turn++) {
        work += (int64_t)structure->stresses * structure->carried * structure->carried;
        shift_equations(structure, mode, &free, e);
        int status = s->kind == FILM_STEP_CONTACT ? film_solve_forces(curve, s, e) : FILM_OK;
        if (status < 0) return status;
        double before = change;
        change = renew(structure, s, mode);
        if (!(change < INFINITY)) return FILM_TOO_MANY;
        if (turn > 0) step->factor = fmin(fmax(change / before, LEAST_FACTOR), 1.0);
        left = change * step->factor; /* convergence is linear */
    }
    s->steps += (int32_t)(work / FORM_WORK);
    if (left > settled) return FILM_TOO_MANY;
    shift_equations(structure, mode, &free, e);
    double third = 0.0;
    step->begins = s->time;
    step->lasts = s->h;
    for (int32_t m = 0; m < structure->carried; m++) {
        double own = 0.0, per_h = 1.0;
        for (int j = 0; j < NODES; j++) own += LEGENDRE_3[j] * mode[m].at_node[j];
        third += fabs(own);
        for (int k = 0; k < NODES; k++) {
            mode[m].cubic[k] = 0.0;
            for (int j = 0; j < NODES; j++) mode[m].cubic[k] += LAGRANGE[j][k] * mode[m].at_node[j] * FACTORIAL[k] * per_h;
            per_h /= s->h;
        }
    }
    *error += third * s->h / s->speed;
    return FILM_OK;
}

void film_stretch_end(const film_structure *structure, film_modal *s, double *waves, const film_table *table) {
    const carried_mode *mode = modes_of(structure, waves);
    size_t n = (size_t)structure->modes;
    double *w = waves + ends_at(structure, s), *u = w + n;
    for (size_t m = 0; m < (size_t)structure->carried; m++) {
        double moved = 0.0, rate = 0.0, per = 1.0 / structure->share[m];
        for (size_t k = 0; k < NODES; k++) {
            moved += mode[m].cubic[k] * table->push[(k + 1) * n + m] * per;
            rate += mode[m].cubic[k] * table->push[k * n + m] * per;
        }
        w[m] += moved;
        u[m] += rate;
        s->end_shift += moved;
        s->end_rate += rate;
    }
}

void film_stretched_mode(const film_structure *structure, const double *waves, int32_t n, const double y[RESPONSES], double *w,
                         double *u) {
    const double *cubic = waves + 4 * (size_t)structure->modes + PER_STEP + PER_CARRIED * (size_t)n + NODES;
    for (int k = 0; k < NODES; k++) {
        *w += cubic[k] * y[k + 2];
        *u += cubic[k] * y[k + 1];
    }
}

/* Energy of the membrane forces and accelerations by them at these displacements. */
static double stretched(const film_structure *structure, const film_modal *s, const double *w, double *accelerations) {
    double at[FILM_MOST_CARRIED][NODES] = {{0.0}}, slope[FILM_MOST_CARRIED][NODES], sums[NODES];
    for (int32_t i = 0; i < structure->carried; i++) at[i][0] = w[i];
    squares(structure, at, slope, sums);
    for (int32_t i = 0; i < structure->carried; i++) accelerations[i] = -structure->share[i] * s->stretch * slope[i][0];
    return 0.5 * s->stretch * sums[0];
}

/* Energy of the membrane forces and of the modes that have them at the beginning of the step, in units of length squared of the
 * state over the structure's unit of time squared, with masses in that of 1/share. */
double film_shared_energy(const film_structure *structure, const film_modal *s, const double *waves) {
    const double *w = waves + begins_at(structure, s), *u = w + structure->modes;
    double energy = 0.0;
    if (structure->carried == 0) return 0.0;
    for (int32_t i = 0; i < structure->carried; i++)
        energy += 0.5 * (u[i] * u[i] + structure->square[i] * w[i] * w[i]) / structure->share[i];
    double accelerations[FILM_MOST_CARRIED];
    return energy + stretched(structure, s, w, accelerations);
}

double film_stretch_now(const film_structure *structure, const film_modal *s, const double *waves, double accelerations[]) {
    double w[FILM_MOST_CARRIED], u;
    if (structure->carried == 0) return 0.0;
    memcpy(w, waves + begins_at(structure, s), sizeof(double) * (size_t)structure->carried);
    for (int32_t i = 0; i < structure->carried && s->has_step && s->tau > 0.0; i++)
        film_moved_mode(structure, s, waves, i, s->tau, &w[i], &u);
    return stretched(structure, s, w, accelerations);
}

double film_modal_stretching(const film_structure *structure, const film_modal *s, const double *waves) {
    double accelerations[FILM_MOST_CARRIED];
    return film_stretch_now(structure, s, waves, accelerations) * s->unit * s->unit / s->mass;
}
