/* Springs that slip, as film_springs.h says. docs/method.md, section 15. */
#include "oblique/film_springs.h"

#include <math.h>
#include <string.h>

static int positive(double x) { return isfinite(x) && x > 0.0; }

int film_springs_init(film_springs *state, int32_t count, double modulus, double largest, double friction, double mass,
                      double velocity) {
    memset(state, 0, sizeof *state);
    if (count < 1 || count > FILM_MOST_SPRINGS) return FILM_BAD_NUMBER;
    if (!positive(modulus) || !positive(largest) || !positive(mass)) return FILM_BAD_NUMBER;
    if (!(isfinite(friction) && friction >= 0.0 && isfinite(velocity))) return FILM_BAD_NUMBER;
    state->count = count;
    state->width = largest / count;
    state->stiffness = 8.0 * modulus * state->width;
    state->friction = friction, state->mass = mass, state->v = velocity;
    return FILM_OK;
}

/* Springs of twice the distance, until there is one at a radius: half as many for what there is, and new ones beyond. */
static void widen(film_springs *state, double radius) {
    for (int twice = 0; state->width * state->count < radius && twice < 1100; twice++) {
        int32_t half = state->count / 2;
        for (int32_t j = 0; j < half; j++) state->u[j] = 0.5 * (state->u[2 * j] + state->u[2 * j + 1]);
        for (int32_t j = half; j < state->count; j++) state->u[j] = 0.0;
        state->width *= 2.0;
        state->stiffness *= 2.0;
    }
}

/* How many springs touch: those with (j + 1/2) width < radius. */
static int32_t touching(const film_springs *state, double radius) {
    double springs = ceil(radius / state->width - 0.5);
    return springs <= 0.0 ? 0 : (int32_t)fmin(springs, state->count);
}

void film_springs_step(film_springs *state, double time, double force, double radius) {
    widen(state, radius);
    int32_t touch = touching(state, radius), old = touching(state, fmin(state->radius, radius));
    double n = touch, square = radius * radius, width = state->width * state->width;
    state->v += 0.5 * time * (state->push - state->q / state->mass);
    /* the sum of radius^2 - r^2, of which each spring has its share of the normal force */
    double moved = state->v * time, shares = n * square - width * n * (4.0 * n * n - 1.0) / 12.0, sum[4] = {0.0, 0.0, 0.0, 0.0};
    double per_share = shares > 0.0 ? state->friction * force / (state->stiffness * shares) : 0.0;
    /* a spring that the contact has just reached moves with it for its part of the step, in which the square of the radius grows
     * evenly, as the indentation of a sphere does */
    double grown = fmax(square - state->radius * state->radius, 0.0);
    for (int32_t j = old; j < touch; j++) state->u[j] -= moved * fmax(1.0 - (square - width * (j + 0.5) * (j + 0.5)) / grown, 0.0);
    state->cut = 0;
    for (int32_t j = 0; state->watched && j < touch; j++) {
        double r = j + 0.5, most = (square - width * r * r) * per_share, u = state->u[j] + moved;
        state->cut += (u > most) - (u < -most);
    }
    for (int32_t j = 0; j < touch; j++) { /* comparisons that compilers turn into vectors; sums apart, in order */
        double r = j + 0.5, most = (square - width * r * r) * per_share, u = state->u[j] + moved;
        u = u < -most ? -most : u;
        state->u[j] = u > most ? most : u;
    }
    for (int32_t j = 0; j < touch; j++) sum[j & 3] += state->u[j];
    for (int32_t j = touch; j < state->count; j++) state->u[j] = 0.0;
    state->q = state->stiffness * ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    state->v += 0.5 * time * (state->push - state->q / state->mass);
    state->radius = radius;
}

int32_t film_springs_touching(const film_springs *state) { return touching(state, state->radius); }

double film_springs_energy(const film_springs *state) {
    double sum = 0.0;
    for (int32_t j = 0; j < state->count; j++) sum += state->u[j] * state->u[j];
    return 0.5 * state->stiffness * sum;
}

double film_friction_at(const double *table, int32_t rows, double speed) {
    int32_t k = 0;
    while (k < rows && table[2 * k] <= speed) k++;
    if (k == 0) return table[1];
    const double *low = table + 2 * (k - 1);
    return k == rows ? low[1] : low[1] + (low[3] - low[1]) * ((speed - low[0]) / (low[2] - low[0]));
}

void film_springs_take(film_springs *state, double time, const double *table, int32_t rows) {
    if (rows > 0) state->friction = film_friction_at(table, rows, fabs(state->v + time * (state->push - state->q / state->mass)));
}

int film_springs_impact(int32_t count, double modulus, double mass, double velocity, const double *friction, int32_t rows, double time,
                        int64_t steps, const double *force, const double *radius, film_springs_impact_result *result,
                        double *velocities, double *forces) {
    film_springs fine, coarse;
    double largest = 0.0, limits = 0.0, used = 0.0;
    for (int64_t i = 0; i <= steps; i++) largest = fmax(largest, radius[i]);
    *result = (film_springs_impact_result){.velocity = velocity};
    if (film_springs_init(&fine, count, modulus, largest, friction[1], mass, velocity) != FILM_OK) return FILM_BAD_NUMBER;
    if (film_springs_init(&coarse, count / 2, modulus, largest, friction[1], mass, velocity) != FILM_OK) return FILM_BAD_NUMBER;
    if (velocities) velocities[0] = velocity, forces[0] = 0.0;
    for (int64_t i = 1; i <= steps; i++) {
        film_springs_take(&fine, time, friction, rows);
        film_springs_step(&fine, time, force[i], radius[i]);
        if (fabs(fine.q) > result->force) result->force = fabs(fine.q), result->step = i;
        limits += fine.friction * force[i], used += fabs(fine.q);
        if (velocities) velocities[i] = fine.v, forces[i] = fine.q;
        if (i % 2 != 0) continue;
        film_springs_take(&coarse, 2.0 * time, friction, rows);
        film_springs_step(&coarse, 2.0 * time, force[i], radius[i]);
        result->apart = fmax(result->apart, fabs(fine.v - coarse.v));
    }
    result->velocity = fine.v;
    result->slack = limits > 0.0 ? 1.0 - used / limits : 0.0;
    return isfinite(fine.v + result->apart) ? FILM_OK : FILM_BAD_NUMBER;
}

int64_t film_springs_size(void) { return (int64_t)sizeof(film_springs); }
