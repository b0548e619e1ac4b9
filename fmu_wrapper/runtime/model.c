/* See model.h. */
#include "model.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const EVENT_NAMES[] = {"no event", "contact begins", "stage changes", "maximum indentation",
                                          "impactor stops", "contact ends", "reloading begins"};

enum { SEEN_MAXIMUM = 1, SEEN_STOP = 2 }; /* in this contact */
enum { MOST_SWITCHES = 1000 };
static const double BARELY = 1e-300; /* speed of a path where only its direction counts */

static int failed(model *m, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(m->message, sizeof m->message, format, arguments);
    va_end(arguments);
    return -1;
}

static int refused(model *m, int status) {
    const char *why = "the numbers cannot be simulated";
    if (status == FILM_BEYOND_LAW) why = "the indentation passed the end of the contact law; it cannot stop this impactor";
    if (status == FILM_TOO_MANY) why = "the step has too many segments: ask for a shorter one";
    if (status == FILM_TOO_STIFF) why = "the contact law's force at first touch is more than target_impedance can resist";
    if (status == FILM_BAD_UNLOADING) why = "the contact law's unloading from the deepest point reached has no length";
    return failed(m, "%s (status %d)", why, status);
}

void model_init(model *m, const model_data *data) {
    memset(m, 0, sizeof *m);
    m->data = data;
    memcpy(m->memory.value, data->start, sizeof m->memory.value);
    m->memory.shown.stage = m->memory.happened.stage = FILM_FREE;
}

void model_free(model *m) {
    free(m->nodes);
    m->nodes = NULL;
}

/* ---------------------------------------------------------------- parameters and inputs */

int model_set(model *m, unsigned reference, double value) {
    if (reference >= VARIABLES) return failed(m, "no variable has the value reference %u", reference);
    const film_variable *variable = &VARIABLE[reference];
    if (variable->role[m->data->kind] == ABSENT || (reference < SETTABLE && !m->data->available[reference]))
        return failed(m, "%s: this FMU does not have it", variable->name);
    if (variable->role[m->data->kind] == OUTPUT) return failed(m, "%s is an output and cannot be set", variable->name);
    if (!isfinite(value)) return failed(m, "%s: %g is not a number that can be set", variable->name, value);
    if (value < variable->low || value > variable->high)
        return failed(m, "%s: %g %s is out of range: from %g to %g %s", variable->name, value, variable->unit, variable->low,
                      variable->high, variable->unit);
    if (variable->role[m->data->kind] == PARAMETER) m->memory.begun = 0;
    m->memory.value[reference] = value;
    if (m->data->kind == CONTACT && reference == INDENTATION) m->memory.reached = value;
    return 0;
}

static double scaled(const model *m, double scale, const double *power, int powers) {
    static const int by[DAMPING] = {RADIUS, EFFECTIVE_MODULUS, YIELD_STRENGTH, MASS, INITIAL_VELOCITY};
    for (int k = 0; k < powers; k++) {
        double ratio = power[k] == 0.0 ? 1.0 : m->memory.value[by[k]] / m->data->start[by[k]];
        if (ratio != 1.0) scale *= pow(ratio, power[k]);
    }
    return scale;
}

int model_restored(model *m) {
    int32_t loading = (int32_t)m->memory.value[LOADING_SEGMENTS], unloading = (int32_t)m->memory.value[UNLOADING_SEGMENTS];
    if (m->data->kind == CONTACT || (m->nodes && m->mesh.loading == loading && m->mesh.unloading == unloading)) return 0;
    double *nodes = malloc(film_mesh_size(loading, unloading) * sizeof *nodes);
    if (!nodes) return failed(m, "no memory for %d and %d segments", (int)loading, (int)unloading);
    free(m->nodes);
    m->nodes = nodes;
    int status = film_mesh_init(&m->mesh, m->data->linearisation, loading, unloading, nodes);
    return status < 0 ? refused(m, status) : 0;
}

static double load_of(const model *m) {
    const double *value = m->memory.value;
    return (value[MASS] * value[GRAVITY] + value[EXTERNAL_FORCE]) / m->memory.force;
}

int model_begin(model *m, double time) {
    model_memory *now = &m->memory;
    const double *value = now->value;
    int contact = m->data->kind == CONTACT;
    now->length = scaled(m, m->data->length_scale, m->data->length_power, SCALING);
    now->force = scaled(m, m->data->force_scale, m->data->force_power, SCALING);
    now->tick = contact ? 1.0 : sqrt(value[MASS] * now->length / now->force);
    now->velocity = now->length / now->tick;
    if (!(now->length > 0.0 && now->length < INFINITY && now->force > 0.0 && now->force < INFINITY && now->tick > 0.0 &&
          now->velocity < INFINITY && isfinite(time)))
        return failed(m, "the parameters give no scales: length %g m, force %g N, time %g s", now->length, now->force,
                      now->tick);
    if (model_restored(m) < 0) return -1;
    double rigid = value[TARGET_IMPEDANCE] >= RIGID, gap = contact ? 0.0 : value[INITIAL_GAP];
    double gamma = contact || rigid ? 0.0 : now->force / (value[TARGET_IMPEDANCE] * now->velocity);
    now->support = contact ? 0.0 : value[SUPPORT_VELOCITY];
    now->load = contact ? 0.0 : load_of(m);
    now->support_displacement = 0.0;
    double start = contact ? 0.0 : (value[INITIAL_VELOCITY] - now->support) / now->velocity;
    int status = film_init(&m->data->curve, &now->state, -gap / now->length, start, gamma, now->load,
                           contact ? -1e300 : -now->support / now->velocity); /* no impactor, none that stops */
    if (status < 0) return refused(m, status);
    double damping = scaled(m, m->data->damping, m->data->damping_power, DAMPING);
    if (film_damp(&now->state, damping * now->velocity / now->force) < 0)
        return failed(m, "the parameters give no damping: %g N*s/m; initial_velocity must be > 0 m/s where the contact law's "
                      "damping is for a restitution at it", damping);
    now->start_time = now->now = time;
    memset(&now->happened, 0, sizeof now->happened);
    now->happened.stage = FILM_FREE;
    memcpy(&now->shown, &now->happened, sizeof now->shown);
    now->contact_speed = m->data->speed / now->velocity;
    now->at[0] = -gap;
    now->at[1] = contact ? 0.0 : value[INITIAL_VELOCITY];
    now->at[2] = 0.0;
    now->reached = now->committed_indentation = value[INDENTATION];
    now->committed_rate = value[RELATIVE_VELOCITY];
    now->committed_time = time;
    now->continuous = 0;
    now->begun = 1;
    return 0;
}

/* ---------------------------------------------------------------- the motion now */

typedef struct {
    double indentation, velocity, target; /* m, m/s, m */
    double force, stiffness, damping;     /* N; its derivatives by indentation and by velocity, N/m, N s/m */
} motion_now;

static int damped(const model *m) { return m->data->curve.stage[0].damped; }

/* The contact's path since the last communication point to its input, or to where that has been extended; and every event. */
static int follow_path(model *m, film_state *state, model_record *record);

static int observe(model *m, motion_now *seen, int with_stiffness) {
    const model_memory *now = &m->memory;
    const film_state *state = &now->state;
    film_contact at = {state->force, 0.0, 0.0};
    if (m->data->kind == CONTACT && !now->continuous) {
        film_state ahead = *state;
        if (follow_path(m, &ahead, NULL) < 0) return -1;
        at = film_force(&m->data->curve, &ahead, ahead.xi, now->value[RELATIVE_VELOCITY] / now->velocity);
        if (at.force < 0.0) at.force = at.by_xi = at.by_nu = 0.0; /* between two steps nobody stops it at 0 */
        seen->indentation = now->reached;
        seen->velocity = now->value[RELATIVE_VELOCITY];
    } else if (now->continuous) {
        int contact = m->data->kind == CONTACT;
        seen->indentation = contact ? now->value[INDENTATION] : now->at[0];
        seen->velocity = contact ? now->value[RELATIVE_VELOCITY] : now->at[1];
        seen->target = now->at[2];
        double support = contact ? 0.0 : now->value[SUPPORT_VELOCITY];
        at = film_force(&m->data->curve, state, seen->indentation / now->length, (seen->velocity - support) / now->velocity);
    } else {
        double slower = (now->value[SUPPORT_VELOCITY] - now->support) / now->velocity; /* what the next step begins with */
        if (with_stiffness || (slower != 0.0 && damped(m))) {
            at = film_force(&m->data->curve, state, state->xi, state->nu - slower);
            if (slower != 0.0 && at.force < 0.0) at.force = at.by_xi = at.by_nu = 0.0; /* contact ends there */
        }
        seen->indentation = state->xi * now->length;
        seen->velocity = state->nu * now->velocity + now->support;
        seen->target = state->shift * now->length + now->support_displacement;
    }
    seen->force = at.force * now->force;
    seen->stiffness = at.by_xi * now->force / now->length;
    seen->damping = at.by_nu * now->force / now->velocity;
    return 0;
}

static double mobility(const model *m) { /* 1/Z */
    return m->memory.state.gamma * m->memory.velocity / m->memory.force;
}

static int not_finite(model *m, const char *name) {
    return failed(m, "%s is not finite: the states or inputs are too large", name);
}

static int look(model *m, unsigned reference, double *value) {
    const model_memory *now = &m->memory;
    motion_now seen;
    if (reference < SETTABLE && VARIABLE[reference].role[m->data->kind] != OUTPUT) {
        *value = now->value[reference];
        return 0;
    }
    if (!now->begun && model_begin(m, now->start_time) < 0) return -1;
    switch (reference) {
    case TIME: *value = now->now; return 0;
    case PHASE: *value = now->shown.phase; return 0;
    case STAGE: *value = now->shown.stage; return 0;
    case CONTACT_COUNT: *value = now->shown.contacts; return 0;
    case EVENT_COUNT: *value = now->shown.events; return 0;
    case LAST_EVENT: *value = now->shown.last_event; return 0;
    default: break;
    }
    if (reference >= EVENT_INDICATOR_1) {
        double indicators[FILM_INDICATORS];
        if (model_indicators(m, indicators) < 0) return -1;
        *value = indicators[reference - EVENT_INDICATOR_1];
        return 0;
    }
    if (reference >= TIME_OF_LAST_EVENT) {
        *value = now->shown.time[reference - SETTABLE];
        return 0;
    }
    if (observe(m, &seen, 0) < 0) return -1;
    double target_velocity = now->value[SUPPORT_VELOCITY] + mobility(m) * seen.force;
    switch (reference) {
    case INDENTATION: *value = seen.indentation; break;
    case RELATIVE_VELOCITY: *value = seen.velocity - target_velocity; break;
    case IMPACTOR_VELOCITY: *value = seen.velocity; break;
    case IMPACTOR_DISPLACEMENT: *value = seen.indentation + seen.target; break;
    case TARGET_DISPLACEMENT: *value = seen.target; break;
    case TARGET_VELOCITY: *value = target_velocity; break;
    case IMPACTOR_ACCELERATION:
        *value = now->value[GRAVITY] + (now->value[EXTERNAL_FORCE] - seen.force) / now->value[MASS];
        break;
    default: *value = seen.force; break;
    }
    return 0;
}

int model_get(model *m, unsigned reference, double *value) {
    *value = 0.0;
    if (reference >= VARIABLES || VARIABLE[reference].role[m->data->kind] == ABSENT ||
        (reference < SETTABLE && !m->data->available[reference]))
        return failed(m, "no variable of this FMU has the value reference %u", reference);
    if (look(m, reference, value) < 0) return -1;
    return isfinite(*value) ? 0 : not_finite(m, VARIABLE[reference].name);
}

/* Partial derivatives of the outputs: by row the unknown, by column what it may depend on. */
int model_depends(const model *m, unsigned unknown, unsigned known) {
    int impact = m->data->kind == IMPACT;
    int by_rate = impact ? known == IMPACTOR_VELOCITY || known == SUPPORT_VELOCITY : known == RELATIVE_VELOCITY;
    int by_force = known == INDENTATION || (damped(m) && by_rate);
    switch (unknown) {
    case CONTACT_FORCE: return by_force;
    case INDENTATION: return impact && known == INDENTATION;
    case IMPACTOR_VELOCITY:
    case TARGET_DISPLACEMENT: return known == unknown;
    case IMPACTOR_DISPLACEMENT: return known == INDENTATION || known == TARGET_DISPLACEMENT;
    case RELATIVE_VELOCITY:
        return impact && (known == INDENTATION || known == IMPACTOR_VELOCITY || known == SUPPORT_VELOCITY);
    case TARGET_VELOCITY: return by_force || known == SUPPORT_VELOCITY;
    case IMPACTOR_ACCELERATION: return by_force || known == EXTERNAL_FORCE;
    default: return -1;
    }
}

int model_partial(model *m, unsigned unknown, unsigned known, double *partial) {
    motion_now seen;
    *partial = 0.0;
    if (unknown >= VARIABLES || VARIABLE[unknown].role[m->data->kind] != OUTPUT || model_depends(m, unknown, known) < 0)
        return failed(m, "%s is no continuous output", unknown < VARIABLES ? VARIABLE[unknown].name : "an unknown reference");
    int state = known == INDENTATION || known == IMPACTOR_VELOCITY || known == TARGET_DISPLACEMENT;
    if (known >= VARIABLES || (VARIABLE[known].role[m->data->kind] != INPUT && !(m->data->kind == IMPACT && state)))
        return failed(m, "%s is neither an input nor a state", known < VARIABLES ? VARIABLE[known].name : "an unknown reference");
    if (!m->memory.begun && model_begin(m, m->memory.start_time) < 0) return -1;
    if (!model_depends(m, unknown, known)) return 0;
    if (observe(m, &seen, 1) < 0) return -1;
    double mass = m->memory.value[MASS], force = 0.0;
    if (known == INDENTATION) force = seen.stiffness;
    if (known == IMPACTOR_VELOCITY || known == RELATIVE_VELOCITY) force = seen.damping;
    if (known == SUPPORT_VELOCITY) force = -seen.damping;
    switch (unknown) {
    case CONTACT_FORCE: *partial = force; break;
    case RELATIVE_VELOCITY:
        *partial = (known == SUPPORT_VELOCITY ? -1.0 : known == IMPACTOR_VELOCITY ? 1.0 : 0.0) - force * mobility(m);
        break;
    case TARGET_VELOCITY: *partial = (known == SUPPORT_VELOCITY ? 1.0 : 0.0) + force * mobility(m); break;
    case IMPACTOR_ACCELERATION: *partial = ((known == EXTERNAL_FORCE ? 1.0 : 0.0) - force) / mass; break;
    default: *partial = 1.0; break;
    }
    return isfinite(*partial) ? 0 : not_finite(m, VARIABLE[unknown].name);
}

/* ---------------------------------------------------------------- events */

static void note(model_record *record, unsigned reference, double value) {
    record->time[reference - SETTABLE] = value;
}

/* The event the state has just passed. */
static void happen(model *m, const film_state *state, double time, double velocity, model_record *record) {
    const model_memory *now = &m->memory;
    double indentation = state->xi * now->length, left = state->xi_free * now->length;
    record->phase = state->phase;
    record->stage = state->branch;
    record->events++;
    record->last_event = state->event;
    note(record, TIME_OF_LAST_EVENT, time);
    switch (state->event) {
    case FILM_CONTACT_BEGINS:
        for (unsigned k = TIME_CONTACT_BEGINS; k <= PERMANENT_INDENTATION; k++) note(record, k, 0.0);
        record->contacts = state->contacts;
        record->seen = 0;
        note(record, TIME_CONTACT_BEGINS, time);
        break;
    case FILM_MAXIMUM_INDENTATION:
        if (!(record->seen & SEEN_MAXIMUM) || indentation > record->time[MAXIMUM_INDENTATION - SETTABLE]) {
            note(record, TIME_OF_MAXIMUM_INDENTATION, time);
            note(record, MAXIMUM_INDENTATION, indentation);
        }
        record->seen |= SEEN_MAXIMUM;
        note(record, MAXIMUM_FORCE, state->force_peak * now->force);
        break;
    case FILM_IMPACTOR_STOPS:
        if (!(record->seen & SEEN_STOP) && state->branch != FILM_FREE) {
            note(record, TIME_IMPACTOR_STOPS, time);
            record->seen |= SEEN_STOP;
        }
        break;
    case FILM_CONTACT_ENDS:
        note(record, TIME_CONTACT_ENDS, time);
        note(record, REBOUND_VELOCITY, velocity);
        note(record, PERMANENT_INDENTATION, left);
        note(record, MAXIMUM_FORCE, state->force_peak * now->force);
        break;
    default: break;
    }
}

int model_hides(const model *m) {
    return m->memory.happened.events != m->memory.shown.events || m->memory.happened.phase != m->memory.shown.phase;
}

void model_show(model *m) {
    memcpy(&m->memory.shown, &m->memory.happened, sizeof m->memory.shown);
}

/* ---------------------------------------------------------------- stepping the impact */

static int take_inputs(model *m) {
    model_memory *now = &m->memory;
    double support = now->value[SUPPORT_VELOCITY], load = load_of(m);
    if (load == now->load && support == now->support) return 0;
    if (now->state.branch != FILM_FREE) now->state.force_peak = fmax(now->state.force_peak, now->state.force);
    int status = film_input(&now->state, load, (now->support - support) / now->velocity, -support / now->velocity);
    if (status < 0) return refused(m, status);
    now->load = load;
    now->support = support;
    return 0;
}

static int step_impact(model *m, double end, int stop_at_events, int *stopped) {
    model_memory *now = &m->memory;
    film_state *state = &now->state;
    *stopped = 0;
    if (take_inputs(m) < 0) return -1;
    if (!isfinite((end - now->start_time) / now->tick)) return failed(m, "a step to %g s is too long", end);
    for (int events = 0;;) {
        double before = state->time, left = (end - now->start_time) / now->tick - before;
        int status = film_step(&m->data->curve, &m->mesh, state, left > 0.0 ? left : 0.0);
        now->support_displacement += now->support * (state->time - before) * now->tick;
        if (status < 0) return refused(m, status);
        now->happened.phase = state->phase;
        now->happened.stage = state->branch;
        if (status != FILM_EVENT) {
            now->now = end;
            if (isfinite(state->xi) && isfinite(state->nu) && isfinite(state->shift) && isfinite(now->support_displacement)) return 0;
            return failed(m, "the motion leaves the range of numbers before %g s", end);
        }
        double time = now->start_time + state->time * now->tick;
        time = fmin(fmax(time, now->now), end);
        happen(m, state, time, state->nu * now->velocity + now->support, &now->happened);
        if (stop_at_events) {
            now->now = time;
            *stopped = 1;
            return 0;
        }
        if (++events > MOST_EVENTS)
            return failed(m, "more than %d events in one step, the last one %s at %g s: ask for a shorter step",
                          (int)MOST_EVENTS, EVENT_NAMES[state->event], time);
    }
}

/* ---------------------------------------------------------------- stepping the contact */

static int settle(model *m, film_state *state, double xi, double nu, model_record *record) {
    for (int k = 0; k < MOST_SWITCHES; k++) {
        state->xi = xi;
        state->nu = nu;
        int status = film_switch(&m->data->curve, state);
        if (status < 0) return refused(m, status);
        if (status != FILM_EVENT) return 0;
        if (record) happen(m, state, m->memory.now, 0.0, record);
    }
    return failed(m, "the indentation %g m changes the contact without end", xi * m->memory.length);
}

/* Straight on to an indentation, m, and every event on the way. */
static int walk(model *m, film_state *state, double indentation, double rate, model_record *record) {
    double nu = (rate < 0.0 ? -1.0 : 1.0) * (damped(m) ? BARELY : 1.0);
    int turns = nu < 0.0 && state->direction > 0 && state->branch != FILM_FREE; /* where it was, and goes back from there */
    if (turns && settle(m, state, state->xi, nu, record) < 0) return -1;
    return settle(m, state, indentation / m->memory.length, nu, record);
}

/* The largest indentation between two points of a path with given rates, if it lies between them: that of the cubic. */
static int peak_between(double a, double rate_a, double b, double rate_b, double time, double *peak) {
    if (!(rate_a > 0.0 && rate_b < 0.0 && time > 0.0)) return 0;
    double c2 = 3.0 * (b - a) - (2.0 * rate_a + rate_b) * time, c3 = 2.0 * (a - b) + (rate_a + rate_b) * time;
    double first = rate_a * time, root = sqrt(c2 * c2 - 3.0 * c3 * first);
    double s = first / (root - c2); /* of c1 + 2 c2 s + 3 c3 s^2 = 0, where it falls through 0 */
    if (!(s > 0.0 && s < 1.0)) return 0;
    *peak = a + s * (first + s * (c2 + s * c3));
    return *peak > a && *peak > b;
}

static int follow_path(model *m, film_state *state, model_record *record) {
    const model_memory *now = &m->memory;
    double to = now->reached, rate = now->value[RELATIVE_VELOCITY], from = now->committed_indentation, peak;
    double time = to == now->value[INDENTATION] ? now->now - now->committed_time : 0.0; /* extended: a straight line */
    if (peak_between(from, now->committed_rate, to, rate, time, &peak) && walk(m, state, peak, 1.0, record) < 0) return -1;
    double way = to - state->xi * now->length;
    int apart = state->branch == FILM_FREE && state->xi > 0.0; /* of a damped law: in its dent, which has not opened */
    if (!(damped(m) && apart) && walk(m, state, to, way != 0.0 ? way : rate, record) < 0) return -1;
    return damped(m) ? settle(m, state, to / now->length, rate / now->velocity, record) : 0;
}

/* The input has been heard: it is the path now, and remembered. */
static int commit(model *m) {
    model_memory *now = &m->memory;
    now->reached = now->value[INDENTATION];
    if (follow_path(m, &now->state, &now->happened) < 0) return -1;
    now->committed_indentation = now->reached;
    now->committed_rate = now->value[RELATIVE_VELOCITY];
    now->committed_time = now->now;
    return 0;
}

static int step_contact(model *m, double end) {
    model_memory *now = &m->memory;
    if (commit(m) < 0) return -1;
    now->reached = now->committed_indentation + now->committed_rate * (end - now->now);
    now->now = end;
    return 0;
}

int model_step(model *m, double end, int stop_at_events, int *stopped) {
    *stopped = 0;
    return m->data->kind == CONTACT ? step_contact(m, end) : step_impact(m, end, stop_at_events, stopped);
}

int model_start(model *m, int continuous) {
    model_memory *now = &m->memory;
    int stopped;
    now->continuous = continuous;
    if (m->data->kind == CONTACT) {
        if (!continuous) return commit(m);
        return model_switch(m);
    }
    return continuous ? model_switch(m) : step_impact(m, now->start_time, 0, &stopped);
}

/* ---------------------------------------------------------------- model exchange */

/* The state as an importer's integrator has it. */
static void place(model *m) {
    model_memory *now = &m->memory;
    film_state *state = &now->state;
    if (m->data->kind == CONTACT) {
        state->xi = now->value[INDENTATION] / now->length;
        state->nu = now->value[RELATIVE_VELOCITY] / now->velocity;
        return;
    }
    state->time = (now->now - now->start_time) / now->tick;
    state->xi = now->at[0] / now->length;
    state->nu = (now->at[1] - now->value[SUPPORT_VELOCITY]) / now->velocity;
    state->shift = now->at[2] / now->length;
    state->load = load_of(m);
    state->stop_velocity = -now->value[SUPPORT_VELOCITY] / now->velocity;
}

int model_rates(model *m, double rates[STATES]) {
    if (model_get(m, RELATIVE_VELOCITY, &rates[0]) < 0 || model_get(m, IMPACTOR_ACCELERATION, &rates[1]) < 0 ||
        model_get(m, TARGET_VELOCITY, &rates[2]) < 0)
        return -1;
    return 0;
}

int model_indicators(model *m, double indicators[FILM_INDICATORS]) {
    if (m->memory.continuous) place(m);
    film_indicators(&m->data->curve, &m->memory.state, m->memory.contact_speed, indicators);
    if (m->data->kind == CONTACT) indicators[3] = indicators[4] = 1.0; /* no impactor, no acceleration */
    for (int k = 0; k < FILM_INDICATORS; k++)
        if (!isfinite(indicators[k])) return not_finite(m, VARIABLE[EVENT_INDICATOR_1 + k].name);
    return 0;
}

void model_reached(model *m) {
    film_state *state = &m->memory.state;
    if (!damped(m)) return; /* an event tells the peak */
    place(m);
    state->force_peak = fmax(state->force_peak, film_force(&m->data->curve, state, state->xi, state->nu).force);
}

int model_switch(model *m) {
    model_memory *now = &m->memory;
    double indicators[FILM_INDICATORS];
    if (model_indicators(m, indicators) < 0) return -1;
    int jumped = m->data->kind == CONTACT && indicators[2] <= 0.0; /* back, while its rate says onwards */
    for (int k = 0; k < MOST_SWITCHES; k++, jumped = 0) {
        place(m);
        if (jumped) now->state.nu = -now->state.direction;
        int status = film_switch(&m->data->curve, &now->state);
        if (status < 0) return refused(m, status);
        now->happened.phase = now->state.phase;
        now->happened.stage = now->state.branch;
        if (status != FILM_EVENT) return 0;
        if (now->state.event == FILM_CONTACT_BEGINS && now->state.nu != 0.0) now->contact_speed = fabs(now->state.nu);
        happen(m, &now->state, now->now, m->data->kind == CONTACT ? 0.0 : now->at[1], &now->happened);
    }
    return failed(m, "the contact changes without end at %g s", now->now);
}
