/* What the march starts from: meshes and their gradings, states before the first touch. docs/method.md, section 4. */
#include "march/film_line.h"

#include <string.h>

/* Loads, velocities and gaps below this are 0: their squares and powers underflow. Units of the law's scales.
 * core_check.c, check_tiny. */
static const double TINY = 1e-100;

/* ---------------------------------------------------------------- meshes */

/* Nodes at s^a/(s^a + c (1 - s)^b), cosines or equal segments: film_core.h has the numbers, docs/method.md, section 4, why. */
static double graded(int grading, double s) {
    static const double a[FILM_GRADINGS] = {1.0, 0.0, 1.2, 1.6, 1.6, 1.0};
    static const double b[FILM_GRADINGS] = {1.0, 0.0, 1.7, 1.2, 1.15, 2.5};
    static const double c[FILM_GRADINGS] = {1.0, 0.0, 1.0, 1.0, 0.19, 0.3};
    if (grading == FILM_EQUAL || s <= 0.0 || s >= 1.0) return s;
    if (grading == FILM_COSINE) return 0.5 * (1.0 - cos(PI * s));
    double from = pow(s, a[grading]);
    return from / (from + c[grading] * pow(1.0 - s, b[grading]));
}

/* Loading: EQUAL, COSINE and PLATE_IN. Unloading: EQUAL, COSINE and PLATE_OUT with `unloading` segments, PLATE_SLOW with two
 * times and PLATE_CREEP with four times as many. Each has one node more than segments. */
size_t film_mesh_size(int32_t loading, int32_t unloading) {
    return 3 * ((size_t)loading + 1) + 9 * (size_t)unloading + 5;
}

static double *fill(const double **nodes, int grading, int32_t segments, double *memory) {
    *nodes = memory;
    for (int32_t i = 0; i <= segments; i++) *memory++ = graded(grading, (double)i / segments);
    return memory;
}

int film_mesh_init(film_mesh *mesh, int32_t linearisation, int32_t loading, int32_t unloading, double *memory) {
    memset(mesh, 0, sizeof *mesh);
    if (loading < 1 || unloading < 1 || loading > FILM_MAX_SEGMENTS || unloading > FILM_MAX_SEGMENTS)
        return FILM_BAD_MESH;
    if (linearisation != FILM_CHORD && linearisation != FILM_WORK_PRESERVING) return FILM_BAD_MESH;
    mesh->linearisation = linearisation;
    mesh->loading = loading;
    mesh->unloading = unloading;
    for (int g = FILM_EQUAL; g <= FILM_PLATE_IN; g++) memory = fill(&mesh->loading_nodes[g], g, loading, memory);
    for (int g = FILM_EQUAL; g < FILM_GRADINGS; g++)
        if (g != FILM_PLATE_IN) memory = fill(&mesh->unloading_nodes[g], g, film_unloading(mesh, g), memory);
    return FILM_OK;
}

/* ---------------------------------------------------------------- states */

static double flush_tiny(double x) { return fabs(x) < TINY ? 0.0 : x; }

int film_init(const film_curve *curve, film_state *s, double xi, double nu, double gamma, double load,
              double stop_velocity) {
    memset(s, 0, sizeof *s);
    if (!isfinite(xi) || !isfinite(nu) || !isfinite(gamma) || !isfinite(load) || !isfinite(stop_velocity) ||
        gamma < 0.0 || xi > 0.0)
        return FILM_BAD_NUMBER;
    if (curve->stages < 1) return FILM_BAD_CURVE;
    s->xi = flush_tiny(xi);
    s->nu = flush_tiny(nu);
    s->gamma = flush_tiny(gamma);
    s->load = flush_tiny(load);
    s->stop_velocity = flush_tiny(stop_velocity);
    s->moving_in = s->nu > s->stop_velocity;
    s->branch = FILM_FREE;
    s->stage_max = -1;
    s->phase = FILM_APPROACHING;
    return FILM_OK;
}

int film_damp(film_state *s, double factor) {
    if (!(factor >= 0.0 && factor < INFINITY)) return FILM_BAD_NUMBER;
    s->damper = factor;
    s->has_line = s->has_leg = s->from_turn = 0;
    return FILM_OK;
}

int film_begin(const film_curve *curve, const film_start *start, film_state *s) {
    int status = film_init(curve, s, 0.0, start->nu, start->gamma, start->load, start->stop_velocity);
    return status >= 0 ? film_damp(s, start->damping) : status;
}

int film_input(film_state *s, double load, double nu_change, double stop_velocity) {
    if (!isfinite(load) || !isfinite(nu_change) || !isfinite(stop_velocity)) return FILM_BAD_NUMBER;
    load = flush_tiny(load);
    stop_velocity = flush_tiny(stop_velocity);
    if (load == s->load && nu_change == 0.0 && stop_velocity == s->stop_velocity) return FILM_OK;
    s->load = load;
    s->nu += nu_change;
    s->jumped |= nu_change != 0.0;
    s->stop_velocity = stop_velocity;
    if (s->nu > stop_velocity) s->moving_in = 1;
    s->has_line = s->has_leg = s->from_turn = 0;
    return FILM_OK;
}

void film_sizes(int64_t sizes[5]) {
    sizes[0] = (int64_t)sizeof(film_curve);
    sizes[1] = (int64_t)sizeof(film_mesh);
    sizes[2] = (int64_t)sizeof(film_line);
    sizes[3] = (int64_t)sizeof(film_state);
    sizes[4] = (int64_t)sizeof(film_summary);
}
