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

/* How many springs touch: those with (j + 1/2) width < radius. */
static int32_t touching(const film_springs *state, double radius) {
    double springs = ceil(radius / state->width - 0.5);
    return springs <= 0.0 ? 0 : (int32_t)fmin(springs, state->count);
}

void film_springs_step(film_springs *state, double time, double force, double radius) {
    int32_t touch = touching(state, radius);
    double n = touch, square = radius * radius, width = state->width * state->width;
    state->v -= 0.5 * time * state->q / state->mass;
    /* the sum of radius^2 - r^2, of which each spring has its share of the normal force */
    double moved = state->v * time, shares = n * square - width * n * (4.0 * n * n - 1.0) / 12.0, sum[4] = {0.0, 0.0, 0.0, 0.0};
    double per_share = shares > 0.0 ? state->friction * force / (state->stiffness * shares) : 0.0;
    for (int32_t j = 0; j < touch; j++) { /* comparisons that compilers turn into vectors; sums apart, in order */
        double r = j + 0.5, most = (square - width * r * r) * per_share, u = state->u[j] + moved;
        u = u < -most ? -most : u;
        state->u[j] = u > most ? most : u;
    }
    for (int32_t j = 0; j < touch; j++) sum[j & 3] += state->u[j];
    for (int32_t j = touch; j < state->count; j++) state->u[j] = 0.0;
    state->q = state->stiffness * ((sum[0] + sum[1]) + (sum[2] + sum[3]));
    state->v -= 0.5 * time * state->q / state->mass;
}

void film_springs_follow(film_springs *state, double time, int64_t steps, const double *force, const double *radius,
                         double *velocity, double *friction) {
    for (int64_t i = 0; i < steps; i++) {
        film_springs_step(state, time, force[i], radius[i]);
        velocity[i] = state->v;
        friction[i] = state->q;
    }
}

int64_t film_springs_size(void) { return (int64_t)sizeof(film_springs); }
