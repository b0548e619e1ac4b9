/* See film_slide.h. */
#include "modal/film_slide.h"
#include "modal/film_modal_parts.h"

#include <math.h>
#include <string.h>

enum { MOST_EVENTS_A_STEP = 64, MOST_PARTS = 256, FEW_PARTS = 4 /* of a path */ };

static const double LONGEST = 0.002;     /* step, over the unit of time of the march */
static const double OF_A_PERIOD = 0.003; /* a step, over the time in which the springs would turn the motion by 1 rad */

typedef struct {
    double force, slope; /* F >= 0, and r */
} grip;

/* At a state, before which the indentation was `before`. While it grows a law that yields releases nothing that touches, as in
 * film_springs_radii. */
static grip grip_of(const film_curve *curve, const film_state *state, double before, const film_sliding *sliding) {
    grip now = {fmax(state->force, 0.0), 0.0};
    if (state->branch == FILM_FREE) return (grip){0.0, 0.0};
    now.slope = film_contact_slope(curve, &state->line, state->xi);
    int yields = curve->stage[curve->stages - 1].unloading != FILM_RETRACE;
    if (yields && state->xi >= before) now.slope = fmax(now.slope, sliding->springs.radius);
    if (!(now.force > 0.0 && now.slope > 0.0)) now.force = now.slope = 0.0;
    return now;
}

static void advance(film_sliding *sliding, grip now, double h, const double *friction, int32_t rows) {
    film_springs *s = &sliding->springs;
    film_springs_take(s, h, friction, rows);
    double before = s->v, radius = s->radius;
    film_springs_step(s, h, now.force, now.slope);
    film_springs_watch(&sliding->watch, s->cut, film_springs_touching(s), radius, s->radius, h);
    double impulse = s->mass * (before - s->v + s->push * h);
    sliding->impulse += impulse;
    sliding->displacement += 0.5 * (before + s->v) * h;
    sliding->work += 0.5 * (before + s->v) * impulse;
}

/* Without friction one step is exact. */
static double longest_step(const film_sliding *sliding, double slope, int32_t rows) {
    if (sliding->springs.friction == 0.0 && sliding->springs.q == 0.0 && rows == 0) return INFINITY;
    return fmin(LONGEST, OF_A_PERIOD / sqrt(fmax(slope, 1.0) / fmin(sliding->springs.mass, 1.0)));
}

static double steps_for(const film_sliding *sliding, grip now, double dt, int32_t rows) {
    return fmax(ceil(dt / longest_step(sliding, now.slope, rows)), 1.0);
}

/* Whether so many steps are still allowed. */
static int spend(film_sliding *sliding, double count) {
    int allowed = count <= FILM_MOST_SLIDE_STEPS - sliding->steps;
    if (allowed) sliding->steps += (int32_t)count;
    return allowed;
}

static int follow(const film_curve *curve, const film_mesh *mesh, film_state *state, double time) {
    int status = FILM_EVENT;
    for (int k = 0; status == FILM_EVENT && k < MOST_EVENTS_A_STEP; k++)
        status = film_step(curve, mesh, state, fmax(time - state->time, 0.0));
    return status < 0 ? status : FILM_OK;
}

int film_slide_init(film_sliding *sliding, const film_curve *curve, double friction, double mass, double velocity) {
    memset(sliding, 0, sizeof *sliding);
    int status = film_springs_init(&sliding->springs, FILM_MOST_SPRINGS, 0.125, 1.0, film_springs_power(curve), friction, mass, velocity);
    sliding->watch.phase = -1;
    return status;
}

int film_slide(const film_curve *curve, const film_mesh *mesh, const film_state *from, const film_state *to, const double *friction,
               int32_t rows, film_sliding *sliding) {
    film_state state = *from;
    double dt = to->time - from->time;
    if (!(dt >= 0.0 && dt < INFINITY)) return FILM_BAD_NUMBER;
    sliding->watch.events = 0, sliding->watch.passed = 0.0;
    if (dt == 0.0) return FILM_OK;
    if (state.branch == FILM_FREE) {
        advance(sliding, (grip){0.0, 0.0}, dt, friction, rows);
        return FILM_OK;
    }
    double count = steps_for(sliding, grip_of(curve, &state, state.xi, sliding), dt, rows);
    if (!spend(sliding, count)) return FILM_TOO_MANY;
    for (double k = 1.0; k < count; k += 1.0) {
        double xi = state.xi;
        int status = follow(curve, mesh, &state, from->time + dt * (k / count));
        if (status < 0) return status;
        advance(sliding, grip_of(curve, &state, xi, sliding), dt / count, friction, rows);
    }
    advance(sliding, grip_of(curve, to, state.xi, sliding), dt / count, friction, rows);
    return FILM_OK;
}

/* A cubic through values and slopes at both ends of a time, after a part of it. */
static double between(double part, double time, double from, double slope, double to, double end_slope) {
    double left = 1.0 - part;
    return left * left * ((1.0 + 2.0 * part) * from + part * time * slope) + part * part * ((1.0 + 2.0 * left) * to - left * time * end_slope);
}

/* Its slope, times the time. */
static double between_slope(double part, double time, double from, double slope, double to, double end_slope) {
    double left = 1.0 - part;
    return 6.0 * part * left * (to - from) + time * (left * (1.0 - 3.0 * part) * slope + part * (1.0 - 3.0 * left) * end_slope);
}

/* To the watch in steps that are not too short for it: its phases are those of some steps. A path of few parts is watched as a whole,
 * because integrators of low order do not meet the slopes at its ends, so that a cubic through them speeds up and slows down. */
static void watch_along(film_sliding *sliding, double h, double longest, double left) {
    film_springs *s = &sliding->springs;
    sliding->unwatched += h;
    if (s->radius > 0.0 && (left > 0.0 || !(sliding->unwatched >= 0.5 * longest))) return;
    film_springs_watch(&sliding->watch, s->cut, film_springs_touching(s), sliding->watched, s->radius, sliding->unwatched);
    sliding->unwatched = 0.0, sliding->watched = s->radius;
}

void film_slide_along(const film_curve *curve, const film_state *state, const film_slide_point *from, const film_slide_point *to,
                      const double *friction, int32_t rows, film_sliding *sliding) {
    film_springs *s = &sliding->springs;
    film_state at = *state;
    double dt = fmax(to->time - from->time, 0.0), moved = from->displacement, usual = longest_step(sliding, s->radius, rows);
    double longest = at.branch == FILM_FREE ? INFINITY : fmax(usual, dt / MOST_PARTS);
    at.xi = from->xi;
    sliding->watch.events = 0, sliding->watch.passed = -sliding->unwatched;
    for (double now = 0.0, next = 0.0; now == 0.0 || now < dt; now = next) {
        next = fmin(now + longest, dt);
        double part = dt > 0.0 ? next / dt : 1.0, xi = at.xi, before = moved, q = s->q, slower = from->rate - from->nu;
        double rate = dt > 0.0 ? between_slope(part, dt, from->xi, from->rate, to->xi, to->rate) / dt : to->rate;
        at.xi = between(part, dt, from->xi, from->rate, to->xi, to->rate);
        at.force = film_force(curve, &at, at.xi, rate - slower - part * (to->rate - to->nu - slower)).force;
        moved = between(part, dt, from->displacement, from->velocity, to->displacement, to->velocity);
        s->v = dt > 0.0 ? between_slope(part, dt, from->displacement, from->velocity, to->displacement, to->velocity) / dt : to->velocity;
        if (rows > 0) s->friction = film_friction_at(friction, rows, fabs(s->v));
        grip there = grip_of(curve, &at, xi, sliding);
        film_springs_move(s, moved - before, there.force, there.slope);
        sliding->work += 0.5 * (q + s->q) * (moved - before);
        watch_along(sliding, next - now, fmin(usual, LONGEST), dt < FEW_PARTS * usual ? dt - next : 0.0);
        if (!(next > now)) break;
    }
}

/* Beside a planned step of a structure, of which `time` passes. */
static int slide_step(const film_structure *structure, const film_curve *curve, film_modal step, const double *waves, double time,
                      const double *friction, int32_t rows, film_sliding *sliding) {
    double begin = step.tau, dt = time / step.unit, values[5];
    if (step.contact.branch == FILM_FREE) {
        advance(sliding, (grip){0.0, 0.0}, dt, friction, rows);
        return FILM_OK;
    }
    double count = steps_for(sliding, grip_of(curve, &step.contact, step.contact.xi, sliding), dt, rows);
    if (!spend(sliding, count)) return FILM_TOO_MANY;
    for (double k = 1.0; k <= count; k += 1.0) {
        double xi = step.contact.xi;
        step.tau = begin + time * (k / count);
        film_modal_motion(structure, curve, &step, waves, values);
        step.contact.xi = values[0], step.contact.force = values[2];
        advance(sliding, grip_of(curve, &step.contact, xi, sliding), dt / count, friction, rows);
    }
    return FILM_OK;
}

int film_slide_on_modes(film_structure *structure, const film_curve *curve, film_modal *state, double *waves, double dt,
                        const double *friction, int32_t rows, film_sliding *sliding) {
    if (!(dt >= 0.0 && dt < INFINITY)) return FILM_BAD_NUMBER;
    sliding->watch.events = 0, sliding->watch.passed = 0.0;
    while (state->steps < film_most_steps(structure)) { /* as film_modal_step */
        int status = state->has_step ? FILM_OK : film_plan_step(structure, curve, state, waves);
        if (status != FILM_OK) return status;
        film_modal step = *state;
        double left = dt;
        status = film_advance(structure, curve, state, waves, &dt);
        if (status == FILM_EVENT) state->steps += EVENT_WORK;
        if (status < 0) return status;
        int slid = slide_step(structure, curve, step, waves, left - dt, friction, rows, sliding);
        if (slid < 0) return slid;
        if (status != FILM_OK || (dt == 0.0 && state->has_step)) return status;
    }
    return FILM_TOO_MANY;
}

void film_slide_sizes(int64_t sizes[1]) { sizes[0] = (int64_t)sizeof(film_sliding); }
