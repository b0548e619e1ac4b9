/* Part of fmu_fuzz.c: random calls, legal and illegal. */
#ifndef FMU_FUZZ_CALLS_H
#define FMU_FUZZ_CALLS_H

#include "fmu_driver.h"

enum { UNITS = 6, SAVED = 8, LONGEST = 8, MOST_FOLDERS = 40 };

typedef struct {
    unit u;
    int silent;  /* no logger */
    int updated; /* called in steps */
} player;

typedef struct {
    void *state;
    int version;
} kept;

static resources *folder;
static int folders;
static player players[UNITS], *stepping = NULL; /* the latter in its step */
static kept saves[SAVED];
static unsigned char *bytes[SAVED];
static size_t byte_count[SAVED];
static long good = 0, refused = 0, damaged = 0;

static int likely(int percent) { return whole(1, 100) <= percent; }

/* An unusual number. */
static double odd(void) {
    static const double some[] = {0.0, -0.0, 1.0, -1.0, 1e300, -1e300, 1e-300, 4e-324, 1e30, 1e12, -1e5, 1e-9};
    int k = whole(0, 15);
    if (k < 12) return some[k];
    return k == 12 ? NAN : k == 13 ? INFINITY : k == 14 ? -INFINITY : uniform(-1.0, 1.0) * over_decades(1e-20, 1e20);
}

static unsigned some_reference(void) {
    return likely(95) ? (unsigned)whole(0, VARIABLES - 1) : likely(80) ? (unsigned)(VARIABLES + whole(0, 7)) : 4294967295u;
}

/* Check the status and the messages of a call. name: of the function. */
static void outcome(const player *p, const char *name, int status, long before) {
    snprintf(detail, sizeof detail, "after %s", name);
    HOLD(status == GOOD || status == ERROR);
    if (!p->u.c) { /* no instance, so no logger */
        HOLD(status == ERROR && messages == before);
        return;
    }
    if (status == GOOD) {
        good++;
        HOLD(messages == before);
        return;
    }
    refused++;
    if (p->silent) {
        HOLD(messages == before);
        return;
    }
    HOLD(messages == before + 1 && last_status == ERROR);
    size_t length = strlen(name);
    HOLD(strncmp(last_message, name, length) == 0 && strncmp(last_message + length, ": ", 2) == 0);
    HOLD(strlen(last_message) > length + 10);
}
/* A call of one FMI version, or of the player's version. */
#define CALL(p, name, ...)                                   \
    do {                                                     \
        long before_ = messages;                             \
        int status_ = (int)name(__VA_ARGS__);                \
        status = status_;                                    \
        (void)status;                                        \
        outcome((p), #name, status_, before_);               \
    } while (0)
#define EITHER_CALL(p, name2, arguments2, name3, arguments3)                   \
    do {                                                                       \
        long before_ = messages;                                               \
        if ((p)->u.version == 2) status = (int)name2 arguments2;               \
        else status = (int)name3 arguments3;                                   \
        outcome((p), (p)->u.version == 2 ? #name2 : #name3, status, before_);  \
    } while (0)

static double typical_step(const player *p) { /* so that a call takes microseconds, not minutes */
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    double time_scale = m->initialized && p->u.from->data.kind == IMPACT ? m->time_scale : 1e-4;
    return time_scale * over_decades(1e-4, 30.0);
}

/* ---------------------------------------------------------------- calls */

static void call_set(player *p) {
    unsigned references[LONGEST];
    double reals[LONGEST];
    int32_t wholes[LONGEST];
    fmi3Int64 items[LONGEST];
    int status, count = whole(0, LONGEST), type = likely(70) ? REAL : whole(REAL, ENUMERATION), sane = likely(80);
    const model_data *data = &p->u.from->data;
    for (int k = 0; k < count; k++) {
        references[k] = some_reference();
        if (sane)
            do references[k] = (unsigned)whole(1, SETTABLE - 1);
            while (!has(p->u.from, references[k]) || VARIABLE[references[k]].type != REAL);
        reals[k] = sane ? data->start[references[k] % SETTABLE] * over_decades(0.3, 3.0) : odd();
        if (sane && references[k] == EXTERNAL_FORCE) reals[k] = data->force_scale * uniform(-0.1, 0.3);
        if (sane && references[k] == SUPPORT_VELOCITY) reals[k] = 0.1 * data->start[INITIAL_VELOCITY] * uniform(-1.0, 1.0);
        if (sane && references[k] == INDENTATION) reals[k] = data->length_scale * uniform(-1.0, 4.0);
        if (sane && references[k] == RELATIVE_VELOCITY) reals[k] = uniform(-1.0, 1.0);
        wholes[k] = likely(80) ? whole(1, 50) : likely(80) ? whole(-5, 2000) : likely(50) ? 2147483647 : (-2147483647 - 1);
        items[k] = likely(80) ? whole(-1, 7) : (fmi3Int64)9223372036854775807;
    }
    if (sane) type = REAL;
    const unsigned *from = likely(98) ? references : NULL;
    size_t values = (size_t)(likely(97) ? count : whole(0, LONGEST)), n = (size_t)count;
    if (type == REAL) {
        const double *value = likely(98) ? reals : NULL;
        EITHER_CALL(p, fmi2SetReal, (p->u.c, from, n, value), fmi3SetFloat64, (p->u.c, from, n, value, values));
    } else if (type == WHOLE || p->u.version == 2) {
        const int32_t *value = likely(98) ? wholes : NULL;
        EITHER_CALL(p, fmi2SetInteger, (p->u.c, from, n, value), fmi3SetInt32, (p->u.c, from, n, value, values));
    } else {
        CALL(p, fmi3SetInt64, p->u.c, from, n, likely(98) ? items : NULL, values);
    }
}

static void call_get(player *p) {
    unsigned references[LONGEST];
    double reals[LONGEST];
    int32_t wholes[LONGEST];
    fmi3Int64 items[LONGEST];
    int status, count = whole(0, LONGEST), type = whole(REAL, ENUMERATION), sane = likely(90);
    for (int k = 0; k < count; k++) {
        references[k] = some_reference();
        if (sane)
            do references[k] = (unsigned)whole(0, VARIABLES - 1);
            while (!has(p->u.from, references[k]) || VARIABLE[references[k]].type != type);
        reals[k] = NAN;
        wholes[k] = -1000;
        items[k] = -1000;
    }
    const unsigned *from = likely(98) ? references : NULL;
    int ask = likely(98);
    size_t values = (size_t)(likely(97) ? count : whole(0, LONGEST)), n = (size_t)count;
    if (type == REAL) {
        EITHER_CALL(p, fmi2GetReal, (p->u.c, from, n, ask ? reals : NULL), fmi3GetFloat64,
                    (p->u.c, from, n, ask ? reals : NULL, values));
    } else if (type == WHOLE || p->u.version == 2) {
        EITHER_CALL(p, fmi2GetInteger, (p->u.c, from, n, ask ? wholes : NULL), fmi3GetInt32,
                    (p->u.c, from, n, ask ? wholes : NULL, values));
    } else {
        CALL(p, fmi3GetInt64, p->u.c, from, n, ask ? items : NULL, values);
    }
    for (int k = 0; status == GOOD && k < count; k++) {
        snprintf(detail, sizeof detail, "getting %s", model_name(&((instance *)p->u.c)->model, references[k]));
        if (type == REAL) HOLD(isfinite(reals[k]));
        else HOLD(type == WHOLE || p->u.version == 2 ? wholes[k] >= -2 : items[k] >= 0 && items[k] < 7);
    }
}

static void call_step(player *p) {
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    double from = likely(95) ? m->time : m->time + odd(), size = likely(95) ? typical_step(p) : odd(), time = NAN;
    int status;
    if (size > (beside(p->u.from) ? 30.0 : 1e3) * m->time_scale && likely(98)) size = 0.0; /* valid, but a million events take a second */
    if (p->u.version == 2) {
        CALL(p, fmi2DoStep, p->u.c, from, size, likely(50));
        if (status == GOOD) CALL(p, fmi2GetRealStatus, p->u.c, fmi2LastSuccessfulTime, &time);
    } else {
        fmi3Boolean event, end, early;
        if (((instance *)p->u.c)->state.mode != INTERMEDIATE) stepping = p;
        CALL(p, fmi3DoStep, p->u.c, from, size, likely(50), likely(99) ? &event : NULL, likely(99) ? &end : NULL,
             likely(99) ? &early : NULL, likely(99) ? &time : NULL);
        if (status == GOOD) HOLD(!end && (!early || event || p->updated) && event + 0u <= 1u);
    }
    if (status == GOOD) HOLD(isfinite(time) && time >= from - 1e-9 * fabs(size) - 1e-12 * fabs(from));
}

/* Time derivatives of an input and of an output. */
static void call_rates(player *p) {
    unsigned input = likely(95) ? (unsigned)whole(EXTERNAL_FORCE, SUPPORT_VELOCITY) : some_reference(), output = some_reference();
    int status, order = likely(95) ? 1 : whole(-1, 3);
    const model_data *data = &p->u.from->data;
    double most = input == EXTERNAL_FORCE ? 0.1 * data->force_scale : 0.1 * data->start[INITIAL_VELOCITY];
    double rate = likely(98) ? uniform(-1.0, 1.0) * most / ((instance *)p->u.c)->model.memory.time_scale : odd(), found = NAN;
    if (p->u.version == 2) {
        CALL(p, fmi2SetRealInputDerivatives, p->u.c, likely(98) ? &input : NULL, 1, &order, &rate);
        CALL(p, fmi2GetRealOutputDerivatives, p->u.c, &output, 1, likely(98) ? &order : NULL, &found);
    } else {
        CALL(p, fmi3GetOutputDerivatives, p->u.c, &output, 1, &order, likely(98) ? &found : NULL, (size_t)(likely(98) ? 1 : 2));
    }
    if (status == GOOD) HOLD(isfinite(found));
}

static void call_event_mode(player *p) {
    int status;
    EITHER_CALL(p, fmi2EnterEventMode, (p->u.c), fmi3EnterEventMode, (p->u.c));
}

static void call_update(player *p) {
    fmi2EventInfo info = {9, 9, 9, 9, 9, NAN};
    fmi3Boolean again = 1, end = 1, nominals = 1, values = 1, defined = 1;
    double next = 0.0;
    int status, ask = likely(98);
    EITHER_CALL(p, fmi2NewDiscreteStates, (p->u.c, ask ? &info : NULL), fmi3UpdateDiscreteStates,
                (p->u.c, ask ? &again : NULL, &end, &nominals, &values, &defined, &next));
    if (status == GOOD && p->u.version == 2) HOLD(!info.newDiscreteStatesNeeded && !info.terminateSimulation);
}

static void call_leave(player *p) {
    int status;
    if (p->u.version == 3 && likely(50)) CALL(p, fmi3EnterStepMode, p->u.c);
    else EITHER_CALL(p, fmi2EnterContinuousTimeMode, (p->u.c), fmi3EnterContinuousTimeMode, (p->u.c));
}

static void call_initialization(player *p) {
    double start = likely(90) ? uniform(-1.0, 1.0) : odd(), stop = likely(80) ? start + over_decades(1e-6, 1.0) : odd();
    int status, has_stop = likely(20);
    if (likely(50)) {
        EITHER_CALL(p, fmi2ExitInitializationMode, (p->u.c), fmi3ExitInitializationMode, (p->u.c));
        return;
    }
    if (p->u.version == 2 && likely(50)) {
        CALL(p, fmi2SetupExperiment, p->u.c, fmi2False, 0.0, start, has_stop, stop);
        return;
    }
    EITHER_CALL(p, fmi2EnterInitializationMode, (p->u.c), fmi3EnterInitializationMode,
                (p->u.c, likely(50), 1e-6, start, likely(20), stop));
}

static void call_state(player *p) {
    int k = whole(0, SAVED - 1), status;
    kept *s = &saves[k];
    void *none = &status, **at = likely(97) ? &s->state : NULL;
    switch (whole(0, 4)) {
    case 0:
        EITHER_CALL(p, fmi2GetFMUstate, (p->u.c, at), fmi3GetFMUState, (p->u.c, at));
        if (status == GOOD) HOLD(at && s->state);
        break;
    case 1:
        EITHER_CALL(p, fmi2SetFMUstate, (p->u.c, s->state), fmi3SetFMUState, (p->u.c, s->state));
        break;
    case 2:
        EITHER_CALL(p, fmi2FreeFMUstate, (p->u.c, at), fmi3FreeFMUState, (p->u.c, at));
        if (status == GOOD && at) HOLD(!s->state);
        break;
    case 3: {
        size_t size = 0, *to = likely(97) ? &size : NULL;
        EITHER_CALL(p, fmi2SerializedFMUstateSize, (p->u.c, s->state, to), fmi3SerializedFMUStateSize, (p->u.c, s->state, to));
        if (status != GOOD) break;
        HOLD(size > 0);
        size_t room = likely(95) ? size : (size_t)whole(0, (int)size);
        free(bytes[k]);
        bytes[k] = malloc(room + 1);
        byte_count[k] = 0;
        HOLD(bytes[k] != NULL);
        unsigned char *target = likely(98) ? bytes[k] : NULL;
        EITHER_CALL(p, fmi2SerializeFMUstate, (p->u.c, s->state, (fmi2Byte *)target, room), fmi3SerializeFMUState,
                    (p->u.c, s->state, target, room));
        if (status == GOOD) {
            HOLD(room >= size && target);
            byte_count[k] = size;
        }
        break;
    }
    default: {
        int whole_ = whole(0, 2);
        size_t size = byte_count[k], flip = size ? (size_t)whole(0, (int)size - 1) : 0;
        unsigned char mask = (unsigned char)(whole_ == 0 && size ? 1 << whole(0, 7) : 0);
        if (whole_ == 1 && size) size = (size_t)whole(0, (int)size - 1);
        if (bytes[k]) bytes[k][flip] ^= mask;
        damaged += mask || size < byte_count[k];
        EITHER_CALL(p, fmi2DeSerializeFMUstate, (p->u.c, (fmi2Byte *)bytes[k], size, &none), fmi3DeserializeFMUState,
                    (p->u.c, bytes[k], size, &none));
        HOLD((status == GOOD) == (none != NULL && none != &status));
        if (mask || size < byte_count[k] || size == 0) HOLD(status != GOOD);
        if (bytes[k]) bytes[k][flip] ^= mask;
        if (status == GOOD) {
            EITHER_CALL(p, fmi2SetFMUstate, (p->u.c, none), fmi3SetFMUState, (p->u.c, none));
            EITHER_CALL(p, fmi2FreeFMUstate, (p->u.c, &none), fmi3FreeFMUState, (p->u.c, &none));
        }
        break;
    }
    }
}

static void call_exchange(player *p) {
    double x[LONGEST], *at = likely(98) ? x : NULL;
    size_t count = (size_t)model_state_count(&p->u.from->data), number = 0;
    int status, which = whole(0, 7), sane = likely(90);
    if (which == 4) count = FILM_INDICATORS;
    if (likely(3)) count = (size_t)whole(0, LONGEST);
    for (int k = 0; k < LONGEST; k++) x[k] = NAN;
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    switch (which) {
    case 0:
    case 1:
        for (int k = 0; k < LONGEST; k++) x[k] = sane && k < (int)count && k < STATES ? m->states[k] + p->u.from->data.nominal[k] * uniform(-0.3, 0.3) : odd();
        EITHER_CALL(p, fmi2SetContinuousStates, (p->u.c, at, count), fmi3SetContinuousStates, (p->u.c, at, count));
        return;
    case 2: EITHER_CALL(p, fmi2GetContinuousStates, (p->u.c, at, count), fmi3GetContinuousStates, (p->u.c, at, count)); break;
    case 3:
        EITHER_CALL(p, fmi2GetDerivatives, (p->u.c, at, count), fmi3GetContinuousStateDerivatives, (p->u.c, at, count));
        break;
    case 4: EITHER_CALL(p, fmi2GetEventIndicators, (p->u.c, at, count), fmi3GetEventIndicators, (p->u.c, at, count)); break;
    case 5:
        EITHER_CALL(p, fmi2GetNominalsOfContinuousStates, (p->u.c, at, count), fmi3GetNominalsOfContinuousStates, (p->u.c, at, count));
        break;
    case 6: {
        double time = sane ? m->time + 1e-6 * uniform(0.0, 1.0) : odd();
        EITHER_CALL(p, fmi2SetTime, (p->u.c, time), fmi3SetTime, (p->u.c, time));
        return;
    }
    default: {
        int enter = 9, end = 9;
        fmi3Boolean enter3 = 1, end3 = 1;
        if (p->u.version == 3 && likely(50)) {
            if (likely(50)) CALL(p, fmi3GetNumberOfEventIndicators, p->u.c, likely(95) ? &number : NULL);
            else CALL(p, fmi3GetNumberOfContinuousStates, p->u.c, likely(95) ? &number : NULL);
            return;
        }
        EITHER_CALL(p, fmi2CompletedIntegratorStep, (p->u.c, fmi2True, likely(98) ? &enter : NULL, &end),
                    fmi3CompletedIntegratorStep, (p->u.c, fmi3True, likely(98) ? &enter3 : NULL, &end3));
        return;
    }
    }
    for (size_t k = 0; status == GOOD && k < count; k++) HOLD(isfinite(x[k]));
}

static void call_derivative(player *p) {
    unsigned unknown[LONGEST], known[LONGEST];
    double seeds[LONGEST], result[LONGEST];
    int status, sane = likely(80);
    size_t unknowns = (size_t)whole(0, 4), knowns = (size_t)whole(0, 4);
    for (int k = 0; k < LONGEST; k++) {
        static const unsigned inputs[] = {INDENTATION, IMPACTOR_VELOCITY, TARGET_DISPLACEMENT, EXTERNAL_FORCE, SUPPORT_VELOCITY};
        unknown[k] = sane ? (p->u.from->data.kind == CONTACT ? CONTACT_FORCE : (unsigned)whole(INDENTATION, CONTACT_FORCE)) : some_reference();
        known[k] = sane ? (p->u.from->data.kind == CONTACT ? INDENTATION : inputs[whole(0, 4)]) : some_reference();
        seeds[k] = likely(95) ? uniform(-1.0, 1.0) : odd();
        result[k] = NAN;
    }
    if (p->u.version == 3 && likely(30)) {
        size_t count = 0;
        CALL(p, fmi3GetNumberOfVariableDependencies, p->u.c, unknown[0], likely(95) ? &count : NULL);
        if (status != GOOD) return;
        size_t *elements = malloc((count + 1) * sizeof *elements), *of = malloc((count + 1) * sizeof *of), asked = likely(80) ? count : 1;
        unsigned *independents = malloc((count + 1) * sizeof *independents);
        fmi3DependencyKind *kinds = malloc((count + 1) * sizeof *kinds);
        HOLD(elements && of && independents && kinds);
        CALL(p, fmi3GetVariableDependencies, p->u.c, unknown[0], elements, independents, of, likely(95) ? kinds : NULL, asked);
        for (size_t k = 0; status == GOOD && k < count; k++) HOLD(elements[k] == 0 && of[k] == 0 && independents[k] < VARIABLES);
        free(elements), free(of), free(independents), free(kinds);
        return;
    }
    int finite = 1, adjoint = p->u.version == 3 && likely(30);
    size_t given = likely(95) ? (adjoint ? unknowns : knowns) : 1, got = likely(95) ? (adjoint ? knowns : unknowns) : 1;
    for (size_t k = 0; k < 4; k++) finite &= fabs(seeds[k]) < 1e30;
    if (adjoint) {
        CALL(p, fmi3GetAdjointDerivative, p->u.c, unknown, unknowns, known, knowns, seeds, given, result, got);
    } else {
        EITHER_CALL(p, fmi2GetDirectionalDerivative, (p->u.c, unknown, unknowns, known, knowns, seeds, result),
                    fmi3GetDirectionalDerivative, (p->u.c, unknown, unknowns, known, knowns, seeds, given, result, got));
        if (p->u.version == 2) got = unknowns;
    }
    for (size_t k = 0; status == GOOD && finite && k < got; k++) HOLD(isfinite(result[k]));
}

#endif
