/* Parameters, inputs and steps of the impact. See model.h. */
#include "model_parts.h"

#include "failures.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const EVENT_NAMES[] = {"no event", "contact begins", "stage changes", "maximum indentation",
                                          "impactor stops", "contact ends", "reloading begins"};

int model_error(model *m, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->message, sizeof m->message, format, arguments);
    va_end(arguments);
    return -1;
}

int model_core_error(model *m, int status) {
    return model_error(m, "%s (status %d)", film_failure(status), status);
}

int model_not_finite(model *m, const char *name) {
    return model_error(m, "%s is not finite: the states or inputs are too large", name);
}

void model_init(model *m, const model_data *data) {
    memset(m, 0, sizeof *m);
    m->data = data;
    m->curve = &data->curve;
    memcpy(m->memory.value, data->start, sizeof m->memory.value);
    m->memory.reported.stage = m->memory.actual.stage = FILM_FREE;
}

void model_free(model *m) {
    free(m->nodes);
    free(m->own);
    free(m->tables);
    free(m->sensed);
    free(m->friction);
    free(m->modal);
    free(m->relax);
    m->nodes = m->tables = m->sensed = m->friction = NULL;
    m->own = NULL;
    m->modal = NULL;
    m->relax = NULL;
}

/* ---------------------------------------------------------------- parameters and inputs */

int model_set(model *m, unsigned reference, double value) {
    if (model_is_sensed(m, reference)) return model_error(m, "the motion of a sensor is an output and cannot be set");
    if (reference >= VARIABLES) return model_error(m, "no variable has the value reference %u", reference);
    const film_variable *variable = &VARIABLE[reference];
    if (variable->role[m->data->kind] == ABSENT || (reference < SETTABLE && !m->data->available[reference]))
        return model_error(m, "%s: this FMU does not have it", variable->name);
    if (variable->role[m->data->kind] == OUTPUT) return model_error(m, "%s is an output and cannot be set", variable->name);
    if (!isfinite(value)) return model_error(m, "%s: %g is not finite", variable->name, value);
    if (value < variable->low || value > variable->high)
        return model_error(m, "%s: %g %s is out of range: from %g to %g %s", variable->name, value, variable->unit,
                           variable->low, variable->high, variable->unit);
    if (variable->role[m->data->kind] == PARAMETER) m->memory.initialized = 0;
    m->memory.value[reference] = value;
    if (reference == INDENTATION) m->memory.indentation = value;
    if (reference == RELATIVE_VELOCITY) m->memory.rate = value;
    return 0;
}

int model_tune(model *m, unsigned reference, double value) {
    model_memory *now = &m->memory;
    if (model_set(m, reference, value) < 0) return -1;
    now->initialized = now->retuned = now->varied = 1;
    now->actual.validity |= model_validity_of_parameters(m);
    return 0;
}

int model_set_input_rate(model *m, unsigned reference, int order, double rate) {
    if (order != 1) return model_error(m, "inputs have time derivatives of order 1, not %d", order);
    if (m->data->kind != IMPACT || reference < EXTERNAL_FORCE || reference >= EXTERNAL_FORCE + INPUTS || !model_has(m, reference))
        return model_error(m, "only inputs of an impact have time derivatives");
    if (!isfinite(rate)) return model_error(m, "the time derivative of %s is not finite", VARIABLE[reference].name);
    m->memory.input_rates[reference - EXTERNAL_FORCE] = rate;
    return 0;
}

static const int SCALES_BY[DAMPINGS] = {RADIUS, EFFECTIVE_MODULUS, YIELD_STRENGTH, YIELD_PRESSURE, HARDNESS, STIFFNESS,
                                        POWER_STIFFNESS, MASS, INITIAL_VELOCITY, DAMPING, DISSIPATION_TIME,
                                        HYSTERESIS_DAMPING};

double model_scaled(const model *m, double scale, const double *power, int powers) {
    for (int k = 0; k < powers; k++) {
        int by = SCALES_BY[k];
        double ratio = power[k] == 0.0 ? 1.0 : m->memory.value[by] / m->data->start[by];
        if (ratio != 1.0) scale *= pow(ratio, power[k]);
    }
    return scale;
}

/* The damping factor at the restitution, N s/m, with the other parameters as exported. */
static double damping_of(const model *m) {
    double e = m->memory.value[RESTITUTION], low = VARIABLE[RESTITUTION].low, next = 0.0, after = 0.0;
    if (!m->data->available[RESTITUTION] || e == m->data->start[RESTITUTION]) return m->data->damping;
    double z = 2.0 * log(e) / log(low) - 1.0;
    for (int k = RESTITUTION_TERMS - 1; k > 0; k--) {
        double sum = m->data->restitution[k] + 2.0 * z * next - after;
        after = next;
        next = sum;
    }
    return (1.0 - e) * exp(m->data->restitution[0] + z * next - after);
}

/* The same over the march's unit, for all parameters. */
static double damper_of(const model *m) {
    return model_scaled(m, damping_of(m), m->data->damping_power, DAMPINGS) * m->memory.velocity / m->memory.force;
}

static int bad_damping(model *m) {
    return model_error(m, "the parameters give an invalid damping of %g N*s/m; initial_velocity must be > 0 m/s if the law's "
                          "damping depends on it", damper_of(m) * m->memory.force / m->memory.velocity);
}

int model_follow_tuning(model *m) {
    model_memory *now = &m->memory;
    int planned = vibrates(m) && m->modal->has_step && m->modal->kind != FILM_STEP_JUMP; /* with the damping before */
    if (!now->retuned || now->state.branch != FILM_FREE || planned) return 0;
    now->retuned = 0;
    if (damper_of(m) == now->state.damper) return 0;
    int status = film_damp(&now->state, damper_of(m));
    if (vibrates(m)) film_damp(&m->modal->contact, now->state.damper);
    return status < 0 ? bad_damping(m) : 0;
}

static int update_mesh(model *m) {
    int32_t loading = (int32_t)m->memory.value[LOADING_SEGMENTS], unloading = (int32_t)m->memory.value[UNLOADING_SEGMENTS];
    if (m->data->kind == CONTACT || vibrates(m) || relaxes(m)) return 0;
    if (m->nodes && m->mesh.loading == loading && m->mesh.unloading == unloading) return 0;
    double *nodes = malloc(film_mesh_size(loading, unloading) * sizeof *nodes);
    if (!nodes) return model_error(m, "no memory for %d and %d segments", (int)loading, (int)unloading);
    free(m->nodes);
    m->nodes = nodes;
    int status = film_mesh_init(&m->mesh, m->data->linearisation, loading, unloading, nodes);
    return status < 0 ? model_core_error(m, status) : 0;
}

int model_update(model *m) {
    int failed = update_mesh(m) < 0 || model_update_curve(m) < 0 || model_update_modes(m) < 0 || model_update_relaxing(m) < 0;
    return failed || model_update_friction(m) < 0 ? -1 : 0;
}

/* The state of a target that vibrates, or of viscoelastic bodies. */
static int begin_beside(model *m, double nu, double xi, double gamma) {
    const model_modes *modes = &m->data->modes;
    const model_memory *now = &m->memory;
    double stop = -now->support / now->velocity;
    film_modal_start on_modes = {nu, now->load, modes->rest * now->force / now->length, now->value[MASS], now->time_scale,
                                 now->state.damper, modes->tolerance, INFINITY, stop, 0.0};
    film_start relaxing = {nu, gamma, now->load, stop, INFINITY, 0.0};
    return vibrates(m) ? modes_begin(m, &on_modes, xi) : relaxes(m) ? relaxing_begin(m, &relaxing, xi) : FILM_OK;
}

/* Scales, mesh and curve for the parameters. */
static int scale(model *m) {
    model_memory *now = &m->memory;
    const double *value = now->value;
    now->length = model_scaled(m, m->data->length_scale, m->data->length_power, SCALINGS);
    now->force = model_scaled(m, m->data->force_scale, m->data->force_power, SCALINGS);
    if (m->data->available[EXPONENT]) now->force *= pow(now->length, value[EXPONENT] - m->data->start[EXPONENT]); /* K length^q */
    now->time_scale = m->data->kind == CONTACT ? 1.0 : sqrt(value[MASS] * now->length / now->force);
    now->velocity = now->length / now->time_scale;
    if (!(now->length > 0.0 && now->length < INFINITY && now->force > 0.0 && now->force < INFINITY && now->time_scale > 0.0 &&
          now->velocity < INFINITY))
        return model_error(m, "the parameters give invalid scales: length %g m, force %g N, time %g s", now->length,
                           now->force, now->time_scale);
    return model_update(m);
}

/* F/(Z velocity) in the core's units; 0 for a target that does not move. */
static double gamma_of(const model *m) {
    double impedance = m->memory.value[TARGET_IMPEDANCE];
    return m->data->kind == CONTACT || impedance >= RIGID ? 0.0 : m->memory.force / (impedance * m->memory.velocity);
}

int model_initialize(model *m, double time) {
    model_memory *now = &m->memory;
    const double *value = now->value;
    int contact = m->data->kind == CONTACT;
    if (!isfinite(time)) return model_error(m, "the start time of %g s is not finite", time);
    if (scale(m) < 0) return -1;
    double gap = contact ? 0.0 : value[INITIAL_GAP], gamma = gamma_of(m);
    now->support = contact ? 0.0 : value[SUPPORT_VELOCITY];
    now->load = contact ? 0.0 : load_of(m);
    now->support_displacement = 0.0;
    double start = contact ? 0.0 : (value[INITIAL_VELOCITY] - now->support) / now->velocity;
    int status = film_init(m->curve, &now->state, -gap / now->length, start, gamma, now->load,
                           contact ? -1e300 : -now->support / now->velocity); /* a contact alone has no impactor that stops */
    if (status < 0) return model_core_error(m, status);
    if (film_damp(&now->state, damper_of(m)) < 0) return bad_damping(m);
    now->recoil = 0.0;
    status = begin_beside(m, start, -gap / now->length, gamma);
    if (status < 0) return model_core_error(m, status);
    now->start_time = now->time = time;
    memset(&now->actual, 0, sizeof now->actual);
    now->actual.stage = FILM_FREE;
    now->actual.validity = model_validity_of_parameters(m);
    memcpy(&now->reported, &now->actual, sizeof now->reported);
    now->announced = now->retuned = 0;
    now->step_force = now->impulse = now->released = now->external = 0.0;
    memcpy(now->first_inputs, &value[EXTERNAL_FORCE], sizeof now->first_inputs);
    memset(now->input_rates, 0, sizeof now->input_rates);
    now->varied = 0;
    now->contact_speed = m->data->speed / now->velocity;
    now->states[0] = -gap;
    now->states[1] = contact ? 0.0 : value[INITIAL_VELOCITY];
    now->states[2] = 0.0;
    now->indentation = now->committed_indentation = value[INDENTATION];
    now->committed_rate = now->rate = value[RELATIVE_VELOCITY];
    now->committed_time = time;
    now->importer_integrates = 0;
    if (slides(m) && sliding_begin(m) < 0) return -1;
    now->initialized = 1;
    return 0;
}

static int move_to(model *m, unsigned reference, double value) {
    model_memory *now = &m->memory;
    double force = now->force, velocity = now->velocity, time_scale = now->time_scale;
    if (model_set(m, reference, value) < 0) return -1;
    now->initialized = 1; /* the motion goes on */
    if (scale(m) < 0) return -1;
    film_state *state = &now->state;
    if (film_damp(state, damper_of(m)) < 0) return bad_damping(m);
    state->gamma = state->line.gamma = gamma_of(m);
    if (state->branch != FILM_FREE) state->line.damper = state->damper;
    state->force_peak *= force / now->force;
    now->contact_speed *= velocity / now->velocity;
    sliding_rescale(m, time_scale, velocity);
    return 0;
}

int model_move_parameter(model *m, unsigned reference, double value) {
    double before = m->memory.value[reference];
    int of_start = reference == INITIAL_VELOCITY || reference == INITIAL_GAP || reference == INITIAL_TANGENTIAL_VELOCITY ||
                   reference == INITIAL_SPIN || VARIABLE[reference].type != REAL;
    int of_body = reference == MASS || reference == TARGET_IMPEDANCE || reference == GRAVITY || reference == FRICTION;
    if (of_start) return model_error(m, "%s belongs to the start: it can only be set before the end of Initialization Mode",
                                     VARIABLE[reference].name);
    if (!of_body && model_remembers(m))
        return model_error(m, "%s cannot change now: the contact remembers an indentation with the parameters that it began with",
                           VARIABLE[reference].name);
    if (move_to(m, reference, value) == 0) {
        m->memory.actual.validity |= model_validity_of_parameters(m);
        return 0;
    }
    char said[sizeof m->message];
    memcpy(said, m->message, sizeof said);
    move_to(m, reference, before);
    memcpy(m->message, said, sizeof said);
    return -1;
}

/* ---------------------------------------------------------------- steps */

static int pass_input(model *m, double load, double nu_change, double stop) {
    if (vibrates(m)) return modes_input(m, load, nu_change, stop);
    return relaxes(m) ? relaxing_input(m, load, nu_change, stop) : film_input(&m->memory.state, load, nu_change, stop);
}

static int advance_alone(model *m, double dt) {
    if (vibrates(m)) return modes_step(m, dt);
    return relaxes(m) ? relaxing_step(m, dt) : film_step(m->curve, &m->mesh, &m->memory.state, dt);
}

static int advance(model *m, double dt) {
    film_state from;
    if (!slides(m)) return advance_alone(m, dt);
    memcpy(&from, &m->memory.state, sizeof from);
    int status = advance_alone(m, dt);
    if (status < 0) return status;
    int slid = sliding_follow(m, &from);
    return slid < 0 ? slid : status;
}

int model_apply_inputs(model *m) {
    model_memory *now = &m->memory;
    double support = now->value[SUPPORT_VELOCITY], load = load_of(m);
    if (slides(m)) sliding_input(m);
    if (load == now->load && support == now->support) return 0;
    double change = (now->support - support) / now->velocity, stop = -support / now->velocity;
    if (now->state.branch != FILM_FREE) now->state.force_peak = fmax(now->state.force_peak, now->state.force);
    int status = pass_input(m, load, change, stop);
    if (status < 0) return model_core_error(m, status);
    now->load = load;
    now->support = support;
    now->varied = 1;
    return 0;
}

static int impact_step(model *m, double end, int stop_at_events, int *stopped) {
    model_memory *now = &m->memory;
    film_state *state = &now->state;
    double clock = clock_of(m);
    *stopped = 0;
    if (model_apply_inputs(m) < 0) return -1;
    if (!isfinite((end - now->start_time) / clock)) return model_error(m, "a step to %g s is too long", end);
    int most = slides(m) ? MAX_SLIDING_EVENTS : MAX_STEP_EVENTS;
    for (int events = 0;;) {
        double before = state->time, left = fmax((end - now->start_time) / clock - before, 0.0);
        int status = advance(m, left);
        now->support_displacement += now->support * (state->time - before) * clock;
        if (status < 0) return model_error(m, "%s (status %d); at %g s", film_failure(status), status, now->start_time + state->time * clock);
        now->actual.phase = state->phase;
        now->actual.stage = state->branch;
        if (status != FILM_EVENT) {
            now->time = end;
            if (isfinite(state->xi) && isfinite(state->nu) && isfinite(state->shift) && isfinite(now->support_displacement)) return 0;
            return model_error(m, "the motion is not finite at %g s", end);
        }
        double time = now->start_time + state->time * clock;
        time = fmin(fmax(time, now->time), end);
        model_record_event(m, state, time, state->nu * now->velocity + now->support, &now->actual);
        if (model_follow_tuning(m) < 0) return -1;
        if (stop_at_events) {
            now->time = time;
            *stopped = 1;
            return 0;
        }
        if (++events > most)
            return model_error(m, "more than %d events in one step, the last one %s at %g s: ask for a shorter step",
                          most, EVENT_NAMES[state->event], time);
    }
}

/* Mean force, impulse and work over the step that began at a time, velocity and displacement of the impactor, SI. */
static void balance_step(model *m, double since, double velocity, double displacement) {
    model_memory *now = &m->memory;
    double mass = now->value[MASS], load = now->load * now->force, time = now->time - since;
    double after = now->state.nu * now->velocity + now->support;
    double moved = now->state.xi * now->length + now->state.shift * now->length + now->support_displacement - displacement;
    double impulse = mass * (velocity - after) + load * time, gained = 0.5 * mass * (after - velocity) * (after + velocity);
    now->step_force = time > 0.0 ? impulse / time : now->state.force * now->force;
    now->impulse += impulse;
    now->external += load * moved;
    now->released += gained - load * moved;
}

/* Move the inputs to where their rates bring them after a time. Returns whether one has a rate. */
static int move_inputs(model_memory *now, double time) {
    int moving = 0;
    for (int k = 0; k < INPUTS; k++) {
        now->value[EXTERNAL_FORCE + k] += now->input_rates[k] * time;
        moving |= now->input_rates[k] != 0.0;
    }
    return moving;
}

void model_begin_step(model *m) {
    if (vibrates(m)) modes_renew_work(m);
    m->memory.sliding.steps = 0;
}

int model_step(model *m, double end, int stop_at_events, int *stopped) {
    model_begin_step(m);
    return model_continue(m, end, stop_at_events, stopped);
}

int model_continue(model *m, double end, int stop_at_events, int *stopped) {
    model_memory *now = &m->memory;
    double since = now->time, velocity = now->state.nu * now->velocity + now->support;
    double displacement = (now->state.xi + now->state.shift) * now->length + now->support_displacement;
    *stopped = 0;
    if (model_follow_tuning(m) < 0) return -1;
    if (m->data->kind == CONTACT) return contact_step(m, end);
    int moving = move_inputs(now, 0.5 * (end - since));
    int status = impact_step(m, end, stop_at_events, stopped);
    if (status == 0) balance_step(m, since, velocity, displacement);
    if (!moving || status != 0) return status;
    move_inputs(now, 0.5 * (end - since));
    memset(now->input_rates, 0, sizeof now->input_rates);
    return model_apply_inputs(m);
}

int model_start(model *m, int importer_integrates) {
    model_memory *now = &m->memory;
    int stopped;
    now->importer_integrates = importer_integrates;
    if (m->data->kind == CONTACT) {
        if (!importer_integrates) return contact_accept_input(m);
        return model_apply_events(m);
    }
    return importer_integrates ? model_apply_events(m) : impact_step(m, now->start_time, 0, &stopped);
}
