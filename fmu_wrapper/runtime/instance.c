/* See instance.h. */
#include "instance_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_MESSAGE = 512 };

/* ---------------------------------------------------------------- messages and modes */

int instance_error(const instance *i, const char *function, const char *format, ...) {
    char text[LONGEST_MESSAGE];
    int used = snprintf(text, sizeof text, "%s: ", function);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + used, sizeof text - (size_t)used, format, arguments);
    va_end(arguments);
    if (i && i->report) i->report(i, ERROR, "logStatusError", text);
    return ERROR;
}

static int report_model_error(const instance *i, const char *function) {
    return instance_error(i, function, "%s", i->model.message);
}

int instance_fail(instance *i, const char *function) {
    i->state.mode = FAILED;
    return report_model_error(i, function);
}

void instance_announce(instance *i) {
    char text[LONGEST_MESSAGE];
    while (model_announce(&i->model, text, sizeof text))
        if (i->report) i->report(i, WARNING, "validity", text);
}

static void list_modes(int modes, char *text, size_t room) {
    static const char *const names[] = {"Instantiated", "Initialization Mode", "Event Mode", "Continuous-Time Mode",
                                        "Step Mode", "Terminated", "Error", "Intermediate Update Mode"};
    size_t used = 0;
    text[0] = 0;
    for (int k = 0; k < 8; k++)
        if (modes & (1 << k) && used < room)
            used += (size_t)snprintf(text + used, room - used, "%s%s", used ? ", " : "", names[k]);
}

int instance_allows(const instance *i, const char *function, int modes) {
    if (!i) return 0;
    if (i->state.mode & modes) return 1;
    char now[40], allowed[160];
    list_modes(i->state.mode, now, sizeof now);
    list_modes(modes, allowed, sizeof allowed);
    instance_error(i, function, "called in state %s; allowed in: %s", now, allowed);
    return 0;
}

/* ---------------------------------------------------------------- creation and modes */

instance *instance_new(const char *function, const instance_options *options, const char *error) {
    instance none;
    char message[LONGEST_MESSAGE];
    const char *name = options->name ? options->name : "";
    instance *i = calloc(1, sizeof *i);
    memset(&none, 0, sizeof none);
    none.report = options->report;
    none.environment = options->environment;
    none.logger = options->logger;
    none.name = (char *)name;
    if (i) i->name = malloc(strlen(name) + 1);
    if (!i || !i->name) error = "no memory for an instance";
    if (!error && !*name) error = "instanceName must not be empty";
    if (!error) i->data = model_read_data(options->folder, message, sizeof message);
    if (!error && !i->data) error = message;
    if (!error && (!options->token || strcmp(options->token, i->data->token) != 0)) {
        snprintf(message, sizeof message, "the GUID or instantiation token \"%.80s\" must be \"%s\"",
                 options->token ? options->token : "", i->data->token);
        error = message;
    }
    if (!error && options->model_exchange && !model_has_exchange(i->data))
        error = "this FMU is for Co-Simulation, because its target vibrates or follows the force by a static stiffness, or its "
                "bodies are viscoelastic";
    if (error) {
        instance_error(&none, function, "%s", error), instance_free(i);
        return NULL;
    }
    memcpy(i->name, name, strlen(name) + 1);
    i->model_exchange = options->model_exchange;
    i->event_mode = options->event_mode;
    i->early_return = options->early_return;
    i->report = options->report;
    i->environment = options->environment;
    i->logger = options->logger;
    i->state.mode = INSTANTIATED;
    model_init(&i->model, i->data);
    return i;
}

void instance_free(instance *i) {
    if (!i) return;
    model_free(&i->model);
    free(i->data);
    free(i->name);
    free(i);
}

int instance_set_up(instance *i, const char *function, double start, int has_stop, double stop) {
    ALLOW(INSTANTIATED);
    if (!isfinite(start)) return instance_error(i, function, "startTime %g s must be finite", start);
    if (has_stop && !(stop >= start))
        return instance_error(i, function, "stopTime %g s must not be before startTime %g s", stop, start);
    i->model.memory.start_time = i->model.memory.time = start;
    i->model.memory.initialized = 0;
    i->state.has_stop_time = has_stop;
    i->state.stop_time = has_stop ? stop : 0.0;
    return GOOD;
}

int instance_enter_initialization(instance *i, const char *function) {
    ALLOW(INSTANTIATED);
    i->state.mode = INITIALIZATION;
    return GOOD;
}

int instance_exit_initialization(instance *i, const char *function) {
    ALLOW(INITIALIZATION);
    i->state.mode = FAILED;
    if (model_initialize(&i->model, i->model.memory.start_time) < 0) return report_model_error(i, function);
    if (model_start(&i->model, i->model_exchange) < 0) return report_model_error(i, function);
    instance_announce(i);
    i->state.mode = i->model_exchange || i->event_mode ? EVENT : STEPPING;
    if (i->state.mode == STEPPING) model_report(&i->model);
    return GOOD;
}

int instance_terminate(instance *i, const char *function) {
    ALLOW(RUNNING | FAILED);
    i->state.mode = TERMINATED;
    return GOOD;
}

int instance_reset(instance *i, const char *function) {
    ALLOW(ANY_MODE);
    model_free(&i->model);
    model_init(&i->model, i->data);
    memset(&i->state, 0, sizeof i->state);
    i->state.mode = INSTANTIATED;
    return GOOD;
}

/* ---------------------------------------------------------------- variables */

static int of_type(const instance *i, const char *function, unsigned reference, int type, int or_type) {
    static const char *const types[] = {"a real number", "a whole number", "an enumeration"};
    int sensed = model_is_sensed(&i->model, reference), is = sensed ? REAL : reference < VARIABLES ? VARIABLE[reference].type : -1;
    if (is < 0) return instance_error(i, function, "no variable has the value reference %u", reference);
    if (is == type || is == or_type) return GOOD;
    return instance_error(i, function, "%s is %s; use the function for that type", model_name(&i->model, reference), types[is]);
}

int instance_get(instance *i, const char *function, unsigned reference, int type, int or_type, double *value) {
    if (of_type(i, function, reference, type, or_type) != GOOD || !instance_may_get(i, function, reference)) return ERROR;
    return model_get(&i->model, reference, value) < 0 ? report_model_error(i, function) : GOOD;
}

int instance_set(instance *i, const char *function, unsigned reference, int type, int or_type, double value) {
    if (of_type(i, function, reference, type, or_type) != GOOD || !instance_may_set(i, function, reference)) return ERROR;
    int changed = !(i->state.mode & (INSTANTIATED | INITIALIZATION)) && model_is_parameter(&i->model, reference);
    int moved = changed && i->state.mode == CONTINUOUS; /* which FMI does not ask for, but optimisers do */
    if (changed && !moved && !(VARIABLE[reference].tunable && i->state.mode & (STEPPING | EVENT)))
        return instance_error(i, function, "%s can only be set before the end of Initialization Mode%s", VARIABLE[reference].name,
                              VARIABLE[reference].tunable ? ", and between steps or in Event Mode" : "");
    int state = i->model_exchange && i->state.mode == CONTINUOUS && model_is_state(&i->model, reference);
    int (*set)(model *, unsigned, double) = state ? model_set_state : moved ? model_move_parameter : changed ? model_tune : model_set;
    return set(&i->model, reference, value) < 0 ? report_model_error(i, function) : GOOD;
}

int instance_derivatives(instance *i, const char *function, const unsigned *unknowns, size_t unknown_count,
                         const unsigned *knowns, size_t known_count, const double *seed, double *sensitivity, int adjoint) {
    ALLOW(INITIALIZATION | RUNNING | TERMINATED | FAILED);
    NEED(unknowns, unknown_count);
    NEED(knowns, known_count);
    NEED(seed, adjoint ? unknown_count : known_count);
    NEED(sensitivity, adjoint ? known_count : unknown_count);
    model_slopes slopes = {.by = VARIABLES};
    for (size_t k = 0; k < (adjoint ? known_count : unknown_count); k++) sensitivity[k] = 0.0;
    for (size_t column = 0; column < known_count; column++)
        for (size_t row = 0; row < unknown_count; row++) {
            double partial;
            if (model_derivative(&i->model, unknowns[row], knowns[column], i->state.mode == INITIALIZATION, &slopes, &partial) < 0)
                return report_model_error(i, function);
            sensitivity[adjoint ? column : row] += partial * seed[adjoint ? row : column];
        }
    return GOOD;
}

/* ---------------------------------------------------------------- saved states */

typedef struct {
    uint64_t checksum; /* model_checksum of what follows */
    uint64_t size;     /* bytes, with the state beside model_memory that follows this structure */
    char token[64];    /* of the FMU that saved it */
    int32_t model_exchange, event_mode; /* of the instance */
    instance_state state;
} saved_state;

static size_t saved_size(const instance *i) { return sizeof(saved_state) + model_beside(&i->model); }

static uint64_t checksum_of(const saved_state *saved) {
    return model_checksum((const unsigned char *)saved + sizeof saved->checksum, (size_t)saved->size - sizeof saved->checksum);
}

int instance_save(instance *i, const char *function, void **saved) {
    ALLOW(ANY_MODE);
    if (!saved) return instance_error(i, function, "argument FMUState is NULL");
    saved_state *state = *saved;
    if (state && state->size != saved_size(i)) free(state), *saved = state = NULL;
    if (!state) state = calloc(1, saved_size(i));
    if (!state) return instance_error(i, function, "no memory for a state");
    state->size = saved_size(i);
    memcpy(state->token, i->data->token, sizeof state->token);
    state->model_exchange = i->model_exchange;
    state->event_mode = i->event_mode;
    memcpy(&state->state, &i->state, sizeof state->state);
    memcpy(&state->state.memory, &i->model.memory, sizeof state->state.memory);
    model_save_beside(&i->model, state + 1);
    *saved = state;
    return GOOD;
}

int instance_restore(instance *i, const char *function, const void *saved) {
    const saved_state *state = saved;
    ALLOW(ANY_MODE);
    if (!state) return instance_error(i, function, "argument FMUState is NULL");
    if (memcmp(state->token, i->data->token, sizeof state->token) != 0)
        return instance_error(i, function, "the state was saved in another FMU");
    if (state->model_exchange != i->model_exchange || state->event_mode != i->event_mode)
        return instance_error(i, function, "the state was saved in an instance for %s%s",
                              state->model_exchange ? "Model Exchange" : "Co-Simulation", state->event_mode ? " with event mode" : "");
    memcpy(&i->state, &state->state, sizeof i->state);
    memcpy(&i->model.memory, &state->state.memory, sizeof i->model.memory);
    if (model_update(&i->model) == 0) {
        model_restore_beside(&i->model, state + 1);
        return GOOD;
    }
    return instance_fail(i, function); /* the mesh does not belong to the restored memory */
}

int instance_free_state(void **saved) {
    if (saved) free(*saved), *saved = NULL;
    return GOOD;
}

int instance_size(instance *i, const char *function, const void *saved, size_t *size) {
    ALLOW(ANY_MODE);
    if (!saved || !size) return instance_error(i, function, "argument %s is NULL", saved ? "size" : "FMUState");
    *size = (size_t)((const saved_state *)saved)->size;
    return GOOD;
}

int instance_serialize(instance *i, const char *function, const void *saved, unsigned char *bytes, size_t size) {
    ALLOW(ANY_MODE);
    if (!saved || !bytes) return instance_error(i, function, "argument %s is NULL", saved ? "serializedState" : "FMUState");
    const saved_state *state = saved;
    if (size < state->size)
        return instance_error(i, function, "%u bytes are too few; a state has %u", (unsigned)size, (unsigned)state->size);
    uint64_t checksum = checksum_of(state);
    memcpy(bytes, state, (size_t)state->size);
    memcpy(bytes, &checksum, sizeof checksum);
    return GOOD;
}

int instance_deserialize(instance *i, const char *function, const unsigned char *bytes, size_t size, void **saved) {
    ALLOW(ANY_MODE);
    if (!saved || !bytes) return instance_error(i, function, "argument %s is NULL", saved ? "serializedState" : "FMUState");
    *saved = NULL;
    if (size < sizeof(saved_state))
        return instance_error(i, function, "%u bytes are too few; a state has %u or more", (unsigned)size, (unsigned)sizeof(saved_state));
    saved_state *state = malloc(size);
    if (!state) return instance_error(i, function, "no memory for a state");
    memcpy(state, bytes, size);
    int other = memcmp(state->token, i->data->token, sizeof state->token) != 0;
    if (other || state->size != size || state->checksum != checksum_of(state) ||
        !model_is_beside(i->data, state + 1, size - sizeof *state)) {
        free(state);
        return instance_error(i, function, other ? "the state was saved in another FMU" : "the state is damaged");
    }
    *saved = state; /* not freed before: its old value may be uninitialized */
    return GOOD;
}

/* ---------------------------------------------------------------- event mode and model exchange */

int instance_enter_event_mode(instance *i, const char *function) {
    ALLOW(i && i->model_exchange ? CONTINUOUS : STEPPING);
    if (!i->model_exchange && !i->event_mode)
        return instance_error(i, function, "the instance was created without event mode");
    if (i->model_exchange) model_accept_states(&i->model); /* before the inputs change */
    i->state.mode = EVENT;
    return GOOD;
}

int instance_update(instance *i, const char *function, int *restart) {
    *restart = 0;
    ALLOW(EVENT);
    if (i->model_exchange && model_apply_events(&i->model) < 0) return instance_fail(i, function);
    instance_announce(i);
    *restart = i->model_exchange && model_has_unreported(&i->model);
    model_report(&i->model);
    return GOOD;
}

int instance_leave_event_mode(instance *i, const char *function, int mode) {
    ALLOW(EVENT);
    if (i->model_exchange != (mode == CONTINUOUS))
        return instance_error(i, function, "the instance was created for %s", i->model_exchange ? "Model Exchange" : "Co-Simulation");
    i->state.mode = mode;
    return GOOD;
}

int instance_completed(instance *i, const char *function) {
    ALLOW(CONTINUOUS);
    model_accept_states(&i->model);
    return GOOD;
}

int instance_set_time(instance *i, const char *function, double time) {
    ALLOW(EVENT | CONTINUOUS);
    if (!i->model_exchange) return instance_error(i, function, "the instance was created for Co-Simulation");
    if (!isfinite(time) || time < i->model.memory.start_time)
        return instance_error(i, function, "time %g s must not be before the start time %g s", time, i->model.memory.start_time);
    i->model.memory.time = time;
    return GOOD;
}

size_t instance_state_count(const instance *i) {
    return (size_t)model_state_count(i->data);
}

int instance_set_states(instance *i, const char *function, const double *states, size_t count) {
    ALLOW(CONTINUOUS | EVENT);
    if (!i->model_exchange) return instance_error(i, function, "the instance was created for Co-Simulation");
    if (count != instance_state_count(i))
        return instance_error(i, function, "%u states, but there are %u", (unsigned)count, (unsigned)instance_state_count(i));
    NEED(states, count);
    for (size_t k = 0; k < count; k++)
        if (!isfinite(states[k])) return instance_error(i, function, "state %u is %g, it must be finite", (unsigned)k, states[k]);
    for (size_t k = 0; k < count; k++) i->model.memory.states[k] = states[k];
    return GOOD;
}

int instance_vector(instance *i, const char *function, int what, double *values, size_t count) {
    ALLOW(what == GET_NOMINALS ? ANY_MODE : INITIALIZATION | EVENT | CONTINUOUS | TERMINATED | FAILED);
    if (!i->model_exchange) return instance_error(i, function, "the instance was created for Co-Simulation");
    size_t expected = what == GET_INDICATORS ? FILM_INDICATORS : instance_state_count(i);
    if (count != expected) return instance_error(i, function, "%u values, but there are %u", (unsigned)count, (unsigned)expected);
    NEED(values, count);
    if (!i->model.memory.initialized && model_initialize(&i->model, i->model.memory.start_time) < 0) return report_model_error(i, function);
    int status = 0;
    if (count == 0) return GOOD;
    if (what == GET_STATES) memcpy(values, i->model.memory.states, count * sizeof *values);
    else if (what == GET_NOMINALS) memcpy(values, i->data->nominal, count * sizeof *values);
    else if (what == GET_INDICATORS) status = model_indicators(&i->model, values);
    else status = model_rates(&i->model, values);
    return status < 0 ? report_model_error(i, function) : GOOD;
}
