/* See film_slide.h. */
#include "oblique/film_slide.h"

#include <math.h>
#include <string.h>

enum { MOST_EVENTS_A_STEP = 64 };

static const double LONGEST = 0.002;     /* step, over the unit of time of the march */
static const double OF_A_PERIOD = 0.003; /* a step, over the time in which the springs would turn the motion by 1 rad */

typedef struct {
    double force, slope; /* F >= 0, and r */
} grip;

static grip grip_of(const film_curve *curve, const film_state *state) {
    grip now = {fmax(state->force, 0.0), 0.0};
    film_state still = *state;
    if (state->branch == FILM_FREE) return (grip){0.0, 0.0};
    still.damper = 0.0;
    now.slope = fmax(film_force(curve, &still, state->xi, 0.0).by_xi, 0.0);
    now.slope /= 1.0 - curve->compliance * now.slope; /* film_force has that of both in series */
    if (!(now.force > 0.0 && now.slope > 0.0)) now.force = now.slope = 0.0;
    return now;
}

static void advance(film_sliding *sliding, grip now, double h) {
    film_springs *s = &sliding->springs;
    double force = s->q, before = s->v, push = s->push;
    film_springs_step(s, h, now.force, now.slope);
    double moved = (before + 0.5 * h * (push - force / s->mass)) * h;
    sliding->impulse += 0.5 * h * (force + s->q);
    sliding->work += s->mass * (0.5 * (before - s->v) * (before + s->v) + push * moved);
}

static int follow(const film_curve *curve, const film_mesh *mesh, film_state *state, double time) {
    int status = FILM_EVENT;
    for (int k = 0; status == FILM_EVENT && k < MOST_EVENTS_A_STEP; k++)
        status = film_step(curve, mesh, state, fmax(time - state->time, 0.0));
    return status < 0 ? status : FILM_OK;
}

int film_slide_init(film_sliding *sliding, double friction, double mass, double velocity) {
    memset(sliding, 0, sizeof *sliding);
    return film_springs_init(&sliding->springs, FILM_MOST_SPRINGS, 0.125, 1.0, friction, mass, velocity);
}

int film_slide(const film_curve *curve, const film_mesh *mesh, const film_state *from, double dt, const double *friction, int32_t rows,
               film_sliding *sliding) {
    film_state state = *from;
    if (!(dt >= 0.0 && dt < INFINITY)) return FILM_BAD_NUMBER;
    if (state.branch == FILM_FREE) {
        advance(sliding, (grip){0.0, 0.0}, dt);
        return FILM_OK;
    }
    double slope = fmax(grip_of(curve, &state).slope, 1.0), rate = sqrt(slope / fmin(sliding->springs.mass, 1.0));
    double count = ceil(dt / fmin(LONGEST, OF_A_PERIOD / rate));
    if (!(count <= FILM_MOST_SLIDE_STEPS)) return FILM_TOO_MANY;
    for (double k = 1.0; k <= count; k += 1.0) {
        int status = follow(curve, mesh, &state, from->time + dt * (k / count));
        if (status < 0) return status;
        film_springs_take(&sliding->springs, dt / count, friction, rows);
        advance(sliding, grip_of(curve, &state), dt / count);
    }
    return FILM_OK;
}

int64_t film_slide_size(void) { return (int64_t)sizeof(film_sliding); }
