/* Model Exchange: an importer's integrator owns the states. See model.h. */
#include "model_parts.h"

#include <math.h>

/* Copy the importer's states and inputs into the core's state. */
static void load_states(model *m) {
    model_memory *now = &m->memory;
    film_state *state = &now->state;
    if (m->data->kind == CONTACT) {
        state->xi = now->value[INDENTATION] / now->length;
        state->nu = now->value[RELATIVE_VELOCITY] / now->velocity;
        return;
    }
    state->time = (now->time - now->start_time) / now->time_scale;
    state->xi = now->states[0] / now->length;
    state->nu = (now->states[1] - now->value[SUPPORT_VELOCITY]) / now->velocity;
    state->shift = now->states[2] / now->length;
    state->load = load_of(m);
    state->stop_velocity = -now->value[SUPPORT_VELOCITY] / now->velocity;
}

int model_has_exchange(const model_data *data) {
    return data->kind == CONTACT ||
           (data->modes.count == 0 && !data->available[TARGET_STIFFNESS] && data->relaxation.tolerance == 0.0);
}

int model_state_count(const model_data *data) {
    return data->kind == CONTACT ? 0 : data->available[TORQUE] ? STATES : NORMAL_STATES;
}

static const unsigned STATE[STATES] = {INDENTATION, IMPACTOR_VELOCITY, TARGET_DISPLACEMENT, SLIDING_DISPLACEMENT, TANGENTIAL_VELOCITY,
                                       SPIN, TANGENTIAL_IMPULSE};

unsigned model_state(int k) { return STATE[k]; }

/* Of a variable among the states, or -1. */
static int state_index(const model *m, unsigned reference) {
    for (int k = 0; k < model_state_count(m->data); k++)
        if (STATE[k] == reference) return k;
    return -1;
}

int model_is_state(const model *m, unsigned reference) { return state_index(m, reference) >= 0; }

int model_set_state(model *m, unsigned reference, double value) {
    if (!isfinite(value)) return model_error(m, "%s: %g is not finite", VARIABLE[reference].name, value);
    m->memory.states[state_index(m, reference)] = value;
    return 0;
}

int model_rates(model *m, double rates[STATES]) {
    static const unsigned rate[STATES] = {RELATIVE_VELOCITY, IMPACTOR_ACCELERATION, TARGET_VELOCITY, SLIDING_VELOCITY,
                                          RATE_OF_TANGENTIAL_VELOCITY, RATE_OF_SPIN, FRICTION_FORCE};
    for (int k = 0; k < model_state_count(m->data); k++)
        if (model_get(m, rate[k], &rates[k]) < 0) return -1;
    return 0;
}

int model_output_rate(model *m, unsigned reference, int order, double *rate) {
    double rates[STATES], partial;
    *rate = 0.0;
    if (order != 1) return model_error(m, "outputs have time derivatives of order 1, not %d", order);
    if (m->data->kind != IMPACT || !model_has_exchange(m->data))
        return model_error(m, "time derivatives of outputs are known of impacts that have Model Exchange too");
    if (!model_has(m, reference) || VARIABLE[reference].role[IMPACT] != OUTPUT || VARIABLE[reference].type != REAL)
        return model_error(m, "value reference %u is not a real output", reference);
    if (model_is_discrete(reference)) return 0;
    if (model_rates(m, rates) < 0) return -1;
    for (int k = 0; k < model_state_count(m->data); k++) {
        if (model_partial(m, reference, STATE[k], &partial) < 0) return -1;
        *rate += partial * rates[k];
    }
    return isfinite(*rate) ? 0 : model_not_finite(m, VARIABLE[reference].name);
}

int model_indicators(model *m, double indicators[FILM_INDICATORS]) {
    if (m->memory.importer_integrates) load_states(m);
    double speed = m->memory.contact_speed;
    if (m->data->kind == CONTACT) speed = m->data->nominal[0] / m->memory.length; /* unit time, 1 s, is no measure of a contact */
    film_indicators(m->curve, &m->memory.state, speed, indicators);
    if (m->data->kind == CONTACT) {
        double turn[FILM_INDICATORS];
        film_indicators(m->curve, &m->memory.state, m->memory.contact_speed, turn);
        indicators[0] = turn[0];
        indicators[3] = indicators[4] = 1.0; /* no impactor that stops, no acceleration */
    }
    for (int k = 0; k < FILM_INDICATORS; k++)
        if (!isfinite(indicators[k])) return model_not_finite(m, VARIABLE[EVENT_INDICATOR_1 + k].name);
    return 0;
}

void model_accept_states(model *m) {
    film_state *state = &m->memory.state;
    if (slides(m)) sliding_accept(m);
    if (!damped(m)) return; /* an undamped force has its maximum at the event maximum indentation */
    load_states(m);
    state->force_peak = fmax(state->force_peak, film_force(m->curve, state, state->xi, state->nu).force);
}

int model_apply_events(model *m) {
    model_memory *now = &m->memory;
    double indicators[FILM_INDICATORS];
    if (model_indicators(m, indicators) < 0) return -1;
    int jumped = m->data->kind == CONTACT && indicators[2] <= 0.0; /* the indentation went back, against its rate */
    for (int k = 0; k < MAX_SWITCHES; k++, jumped = 0) {
        load_states(m);
        if (model_follow_tuning(m) < 0) return -1;
        if (jumped) now->state.nu = -now->state.direction;
        int status = film_switch(m->curve, &now->state);
        if (status < 0) return model_core_error(m, status);
        now->actual.phase = now->state.phase;
        now->actual.stage = now->state.branch;
        if (status != FILM_EVENT && slides(m)) sliding_accept(m);
        if (status != FILM_EVENT) return 0;
        if (now->state.event == FILM_CONTACT_BEGINS && now->state.nu != 0.0) now->contact_speed = fabs(now->state.nu);
        model_record_event(m, &now->state, now->time, m->data->kind == CONTACT ? 0.0 : now->states[1], &now->actual);
    }
    return model_error(m, "more than %d events at %g s", (int)MAX_SWITCHES, now->time);
}
