/* See film_slide.h. */
#include "oblique/film_slide.h"

#include <math.h>

enum { MOST_EVENTS_A_STEP = 64 };

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

static void release(film_sliding *s) {
    for (int k = 0; k < FILM_SPRINGS; k++) s->deflection[k] = 0.0;
    s->force = s->slope = 0.0;
}

/* Half as many springs for what there is, and new ones beyond, until there is one at `slope`. */
static void widen(film_sliding *s, double slope) {
    for (int twice = 0; s->widest < slope && twice < 1100; twice++) {
        for (int k = 0; k < FILM_SPRINGS / 2; k++) s->deflection[k] = 0.5 * (s->deflection[2 * k] + s->deflection[2 * k + 1]);
        for (int k = FILM_SPRINGS / 2; k < FILM_SPRINGS; k++) s->deflection[k] = 0.0;
        s->widest *= 2.0;
    }
}

/* Stretch the springs by `moved`, let them slip, and sum their forces. A spring that the contact has just reached moves with it
 * for its part of the step, in which the square of r grows evenly, as the indentation of a sphere does. */
static void stretch(film_sliding *s, grip now, double moved) {
    widen(s, now.slope);
    double ds = s->widest / FILM_SPRINGS, square = now.slope * now.slope, shares = 0.0, sum = 0.0;
    double grown = fmax(square - s->slope * s->slope, 0.0), share[FILM_SPRINGS];
    for (int k = 0; k < FILM_SPRINGS; k++) {
        double at = (k + 0.5) * ds;
        share[k] = fmax(square - at * at, 0.0);
        shares += share[k];
    }
    if (!(shares > 0.0)) {
        release(s);
        return;
    }
    double limit = s->friction * now.force / (shares * ds);
    for (int k = 0; k < FILM_SPRINGS; k++) {
        double most = share[k] * limit, part = share[k] < grown ? share[k] / grown : 1.0;
        s->deflection[k] = fmin(fmax(s->deflection[k] + part * moved, -most), most);
        sum += s->deflection[k];
    }
    s->force = sum * ds;
    s->slope = now.slope;
}

/* By the rule of the midpoint: half a step with the force before, half with that after. */
static void advance(film_sliding *s, grip now, double h) {
    double before = s->force, begin = s->velocity;
    s->velocity += 0.5 * h * (s->push - s->mobility * before);
    double moved = s->velocity * h;
    stretch(s, now, moved);
    s->velocity += 0.5 * h * (s->push - s->mobility * s->force);
    s->impulse += 0.5 * h * (before + s->force);
    s->work += (0.5 * (begin - s->velocity) * (begin + s->velocity) + s->push * moved) / s->mobility;
}

static int follow(const film_curve *curve, const film_mesh *mesh, film_state *state, double time) {
    int status = FILM_EVENT;
    for (int k = 0; status == FILM_EVENT && k < MOST_EVENTS_A_STEP; k++)
        status = film_step(curve, mesh, state, fmax(time - state->time, 0.0));
    return status < 0 ? status : FILM_OK;
}

int film_slide(const film_curve *curve, const film_mesh *mesh, const film_state *from, double dt, film_sliding *sliding) {
    film_state state = *from;
    if (!(dt >= 0.0 && dt < INFINITY)) return FILM_BAD_NUMBER;
    if (state.branch == FILM_FREE) {
        release(sliding);
        sliding->velocity += sliding->push * dt;
        return FILM_OK;
    }
    double slope = fmax(grip_of(curve, &state).slope, 1.0), rate = sqrt(slope * fmax(sliding->mobility, 1.0));
    double count = ceil(dt / fmin(sliding->longest, OF_A_PERIOD / rate));
    if (!(count <= FILM_MOST_SLIDE_STEPS)) return FILM_TOO_MANY;
    for (double k = 1.0; k <= count; k += 1.0) {
        int status = follow(curve, mesh, &state, from->time + dt * (k / count));
        if (status < 0) return status;
        advance(sliding, grip_of(curve, &state), dt / count);
    }
    return FILM_OK;
}

double film_slide_stored(const film_sliding *sliding) {
    double sum = 0.0;
    for (int k = 0; k < FILM_SPRINGS; k++) sum += sliding->deflection[k] * sliding->deflection[k];
    return 0.5 * sum * (sliding->widest / FILM_SPRINGS);
}

int64_t film_slide_size(void) { return (int64_t)sizeof(film_sliding); }
