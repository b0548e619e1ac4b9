/* The contact alone: its memory follows the indentation that the importer communicates. See model.h.
 *
 * Between two communication points the indentation is taken as the cubic with the indentations and rates at both. Only its
 * maximum is computed, because the law's memory depends on the turning points of the indentation, not on time. */
#include "model_parts.h"

#include <math.h>

/* Of the velocity of bodies in a contact alone: at 5 steps of an elastic contact, where the true value is 1, masters that step side by
 * side give 2.1. Needed by test_a_contact_of_too_few_steps_is_an_error. */
static const double MOST_GAIN = 2.0;

/* All events at a given indentation and indentation rate, in the core's units. */
static int apply_events(model *m, film_state *state, double xi, double nu, model_record *record) {
    for (int k = 0; k < MAX_SWITCHES; k++) {
        state->xi = xi;
        state->nu = nu;
        int status = film_switch(m->curve, state);
        if (status < 0) return model_core_error(m, status);
        if (status != FILM_EVENT) return 0;
        if (record) model_record_event(m, state, m->memory.time, 0.0, record);
    }
    return model_error(m, "more than %d events at an indentation of %g m", (int)MAX_SWITCHES, xi * m->memory.length);
}

/* Move to an indentation, m, with all events on the way. Only the sign of `rate` matters. */
static int move_to(model *m, film_state *state, double indentation, double rate, model_record *record) {
    double nu = (rate < 0.0 ? -1.0 : 1.0) * (damped(m) ? SLOWEST : 1.0);
    if (rate == 0.0) return 0; /* no direction: a contact at indentation 0 has not begun */
    int turns = nu < 0.0 && state->direction > 0 && state->branch != FILM_FREE; /* at the current indentation */
    if (turns && apply_events(m, state, state->xi, nu, record) < 0) return -1;
    return apply_events(m, state, indentation / m->memory.length, nu, record);
}

/* Maximum of the cubic with indentations a, b and rates rate_a, rate_b at two points `time` apart; 0 if it has none
 * between them. With s = t/time the cubic is a + first s + c2 s^2 + c3 s^3. */
static int peak_between(double a, double rate_a, double b, double rate_b, double time, double *peak) {
    if (!(rate_a > 0.0 && rate_b < 0.0 && time > 0.0)) return 0;
    double c2 = 3.0 * (b - a) - (2.0 * rate_a + rate_b) * time, c3 = 2.0 * (a - b) + (rate_a + rate_b) * time;
    double first = rate_a * time, root = sqrt(c2 * c2 - 3.0 * c3 * first);
    double s = first / (root - c2); /* root of first + 2 c2 s + 3 c3 s^2, where it changes from + to - */
    if (!(s > 0.0 && s < 1.0)) return 0;
    *peak = a + s * (first + s * (c2 + s * c3));
    return *peak > a && *peak > b;
}

int contact_follow_path(model *m, film_state *state, model_record *record) {
    const model_memory *now = &m->memory;
    double to = now->indentation, rate = now->value[RELATIVE_VELOCITY], from = now->committed_indentation, peak;
    double time = to == now->value[INDENTATION] ? now->time - now->committed_time : 0.0; /* extrapolated: no cubic */
    if (peak_between(from, now->committed_rate, to, rate, time, &peak) && move_to(m, state, peak, 1.0, record) < 0) return -1;
    double way = to - state->xi * now->length;
    int apart = state->branch == FILM_FREE && state->xi > 0.0; /* in the dent that a damped contact left */
    if (!(damped(m) && apart) && move_to(m, state, to, way != 0.0 ? way : rate, record) < 0) return -1;
    return damped(m) ? apply_events(m, state, to / now->length, rate / now->velocity, record) : 0;
}

int contact_accept_input(model *m) {
    model_memory *now = &m->memory;
    now->indentation = now->value[INDENTATION];
    if (contact_follow_path(m, &now->state, &now->actual) < 0) return -1;
    now->committed_indentation = now->indentation;
    now->committed_rate = now->value[RELATIVE_VELOCITY];
    now->committed_time = now->time;
    return 0;
}

/* A contact of few communication steps gains energy in most masters: see COARSE. One that has doubled the velocity of the bodies is
 * an error, since their motion goes on with that energy, and no shorter step from here on undoes it. time: of the last step, s. */
static int count_step(model *m, double time) {
    model_memory *now = &m->memory;
    model_record *record = &now->actual;
    int steps = record->steps;
    if (record->stage != FILM_FREE) {
        if (record->steps++ == 0) now->contact_speed = fmax(now->committed_rate, 0.0) / now->velocity;
        return 0;
    }
    record->steps = 0;
    if (steps == 0 || steps >= FEWEST_STEPS) return 0;
    record->validity |= COARSE;
    if (!record->coarse) record->coarse = steps;
    double gain = fabs(now->committed_rate) / (now->contact_speed * now->velocity);
    if (now->contact_speed == 0.0 || !(gain > MOST_GAIN)) return 0; /* at rest in contact: there is no such velocity */
    return model_error(m, "the communication steps are too long: a contact of %d of them left the bodies with %.3g times the velocity "
                          "of %.3g m/s with which they met; ask for steps below %.2g s", steps, gain, now->contact_speed * now->velocity,
                       steps * time / FEWEST_STEPS);
}

/* After the step the force belongs to the motion that is extrapolated from the input: the indentation by its rate; the
 * rate, on which only a damped force depends, by its change since the last input. */
int contact_step(model *m, double end) {
    model_memory *now = &m->memory;
    double since = now->committed_time, rate_since = now->committed_rate;
    if (contact_accept_input(m) < 0 || count_step(m, now->time - since) < 0) return -1;
    double ahead = now->value[INPUT_EXTRAPOLATION] * (end - now->time);
    now->indentation = now->committed_indentation + now->committed_rate * ahead;
    double change = now->time > since ? (now->committed_rate - rate_since) / (now->time - since) : 0.0;
    now->rate = damped(m) ? now->committed_rate + change * ahead : now->committed_rate;
    now->time = end;
    return 0;
}
