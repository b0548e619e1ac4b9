/* Random sequences of legal and illegal calls of the FMU runtime. Whatever is called: no crash, only OK or Error, an Error
 * with one message that names the function, OK with finite numbers that were all written, and no memory left over.
 * Arguments: a scratch folder, how many calls, and folders of resources (see tests/fmu_resources.py), as absolute paths.
 * Builds as tests/fmu_check.c does. Prints one line; exits with 1 after saying what does not hold. */
#include "fmu_driver.h"

enum { UNITS = 6, SAVED = 8, LONGEST = 6, MOST_FOLDERS = 40 };

typedef struct {
    unit u;
    int silent; /* no logger */
} player;

typedef struct {
    void *state;
    int version;
} kept;

static resources *folder;
static int folders;
static player players[UNITS];
static kept saves[SAVED];
static unsigned char *bytes[SAVED];
static size_t byte_count[SAVED];
static long good = 0, refused = 0, damaged = 0;

static int likely(int percent) { return whole(1, 100) <= percent; }

/* A number nobody expects. */
static double odd(void) {
    static const double some[] = {0.0, -0.0, 1.0, -1.0, 1e300, -1e300, 1e-300, 4e-324, 1e30, 1e12, -1e5, 1e-9};
    int k = whole(0, 15);
    if (k < 12) return some[k];
    return k == 12 ? NAN : k == 13 ? INFINITY : k == 14 ? -INFINITY : uniform(-1.0, 1.0) * over_decades(1e-20, 1e20);
}

static unsigned some_reference(void) {
    return likely(95) ? (unsigned)whole(0, VARIABLES - 1) : likely(50) ? (unsigned)VARIABLES : 4294967295u;
}

/* What a call did: its name, for the message. */
static void outcome(const player *p, const char *name, int status, long before) {
    snprintf(detail, sizeof detail, "after %s", name);
    HOLD(status == GOOD || status == ERROR);
    if (!p->u.c) { /* nobody to ask who logs */
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
/* A call of one version, or of the one that the player has. */
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

/* ---------------------------------------------------------------- making instances */

static void try_to_make(player *p, const resources *r) {
    const char *name = likely(95) ? "fuzz" : likely(50) ? "" : NULL;
    const char *token = likely(95) ? r->data.token : likely(50) ? "{no such}" : NULL;
    unsigned none = 0;
    long before = messages;
    memset(p, 0, sizeof *p);
    p->u.version = whole(2, 3);
    p->u.interface = whole(COSIMULATION, EXCHANGE);
    p->u.from = r;
    p->silent = likely(5);
    static const fmi2CallbackFunctions silence = {NULL, NULL, NULL, NULL, NULL};
    if (p->u.version == 2) {
        static const char *const uris[] = {NULL, "", "file:", "file://", "file:///%zz", "file:///a%00b", "http://a/b", "file://a/b", "/tmp"};
        const char *uri = likely(95) ? r->uri : uris[whole(0, 8)];
        const fmi2CallbackFunctions *functions = !p->silent ? &CALLBACKS : likely(50) ? &silence : NULL;
        p->u.c = fmi2Instantiate(name, p->u.interface == EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation, token, uri, functions,
                                 fmi2False, likely(50));
    } else {
        const char *path = likely(95) ? r->path : likely(30) ? NULL : likely(50) ? "" : "/no/such/folder";
        fmi3LogMessageCallback logger = p->silent ? NULL : logger_3;
        if (likely(2))
            p->u.c = fmi3InstantiateScheduledExecution(name, token, path, fmi3False, fmi3False, NULL, logger, NULL, NULL, NULL);
        else if (p->u.interface == EXCHANGE)
            p->u.c = fmi3InstantiateModelExchange(name, token, path, fmi3False, likely(50), NULL, logger);
        else
            p->u.c = fmi3InstantiateCoSimulation(name, token, path, fmi3False, likely(50), p->u.interface != COSIMULATION,
                                                 p->u.interface == EARLY_RETURN, &none, likely(2) ? 1 : 0, NULL, logger, NULL);
    }
    if (p->u.c || p->silent) HOLD(messages == before);
    else HOLD(messages == before + 1 && last_status == ERROR && strncmp(last_message, "fmi", 3) == 0 && strstr(last_message, ": "));
}

static double typical_step(const player *p) { /* so that a call takes microseconds, not minutes */
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    double tick = m->begun && p->u.from->data.kind == IMPACT ? m->tick : 1e-4;
    return tick * over_decades(1e-4, 30.0);
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
        snprintf(detail, sizeof detail, "getting %s", VARIABLE[references[k]].name);
        if (type == REAL) HOLD(isfinite(reals[k]));
        else HOLD(type == WHOLE || p->u.version == 2 ? wholes[k] >= -2 : items[k] >= 0 && items[k] < 7);
    }
}

static void call_step(player *p) {
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    double from = likely(95) ? m->now : m->now + odd(), size = likely(95) ? typical_step(p) : odd(), time = NAN;
    int status;
    if (size > 1e3 * m->tick && likely(98)) size = 0.0; /* legal, but a million events take a second */
    if (p->u.version == 2) {
        CALL(p, fmi2DoStep, p->u.c, from, size, likely(50));
        if (status == GOOD) CALL(p, fmi2GetRealStatus, p->u.c, fmi2LastSuccessfulTime, &time);
    } else {
        fmi3Boolean event, end, early;
        CALL(p, fmi3DoStep, p->u.c, from, size, likely(50), likely(99) ? &event : NULL, likely(99) ? &end : NULL,
             likely(99) ? &early : NULL, likely(99) ? &time : NULL);
        if (status == GOOD) HOLD(!end && (!early || event) && event + 0u <= 1u);
    }
    if (status == GOOD) HOLD(isfinite(time) && time >= from - 1e-9 * fabs(size) - 1e-12 * fabs(from));
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
    size_t count = p->u.from->data.kind == IMPACT ? STATES : 0, number = 0;
    int status, which = whole(0, 7), sane = likely(90);
    if (which == 4) count = FILM_INDICATORS;
    if (likely(3)) count = (size_t)whole(0, LONGEST);
    for (int k = 0; k < LONGEST; k++) x[k] = NAN;
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    switch (which) {
    case 0:
    case 1:
        for (int k = 0; k < LONGEST; k++) x[k] = sane && k < STATES ? m->at[k] + p->u.from->data.nominal[k] * uniform(-0.3, 0.3) : odd();
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
        double time = sane ? m->now + 1e-6 * uniform(0.0, 1.0) : odd();
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

/* Functions for what these FMUs do not have. */
static void call_absent(player *p) {
    unsigned reference = some_reference();
    union {
        fmi3Float32 f;
        fmi3Int8 i8;
        fmi3UInt8 u8;
        fmi3Int16 i16;
        fmi3UInt16 u16;
        fmi3UInt32 u32;
        fmi3UInt64 u64;
        fmi3Boolean b;
        fmi2Boolean b2;
        fmi3String s;
        fmi3Binary binary;
        fmi3IntervalQualifier q;
        double d;
    } v, other;
    size_t size = 0, one = (size_t)likely(80);
    int status, order = 1;
    void *c = p->u.c;
    memset(&v, 0, sizeof v);
    memset(&other, 0, sizeof other);
    if (p->u.version == 2) {
        fmi2Status state;
        fmi2String text;
        switch (whole(0, 12)) {
        case 10: CALL(p, fmi2GetStatus, c, fmi2DoStepStatus, &state); break;
        case 11: CALL(p, fmi2GetStringStatus, c, fmi2PendingStatus, &text); break;
        case 0: CALL(p, fmi2GetBoolean, c, &reference, one, &v.b2); break;
        case 1: CALL(p, fmi2SetBoolean, c, &reference, one, &v.b2); break;
        case 2: CALL(p, fmi2GetString, c, &reference, one, &v.s); break;
        case 3: CALL(p, fmi2SetString, c, &reference, one, &v.s); break;
        case 4: CALL(p, fmi2SetRealInputDerivatives, c, &reference, one, &order, &v.d); break;
        case 5: CALL(p, fmi2GetRealOutputDerivatives, c, &reference, one, &order, &v.d); break;
        case 6: CALL(p, fmi2CancelStep, c); break;
        case 7: CALL(p, fmi2GetBooleanStatus, c, (fmi2StatusKind)whole(0, 4), likely(90) ? &v.b2 : NULL); break;
        case 8: CALL(p, fmi2GetRealStatus, c, (fmi2StatusKind)whole(0, 4), likely(90) ? &v.d : NULL); break;
        case 9: CALL(p, fmi2GetIntegerStatus, c, fmi2PendingStatus, &order); break;
        default: CALL(p, fmi2SetDebugLogging, c, likely(50), one, NULL); break;
        }
        return;
    }
    switch (whole(0, 35)) {
    case 26: CALL(p, fmi3SetUInt8, c, &reference, one, &v.u8, one); break;
    case 27: CALL(p, fmi3SetInt16, c, &reference, one, &v.i16, one); break;
    case 28: CALL(p, fmi3SetUInt16, c, &reference, one, &v.u16, one); break;
    case 29: CALL(p, fmi3SetUInt32, c, &reference, one, &v.u32, one); break;
    case 30: CALL(p, fmi3GetIntervalFraction, c, &reference, one, &v.u64, &other.u64, &other.q); break;
    case 31: CALL(p, fmi3SetIntervalFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 32: CALL(p, fmi3GetShiftFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 33: CALL(p, fmi3SetShiftFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 34: CALL(p, fmi3SetShiftDecimal, c, &reference, one, &v.d); break;
    case 0: CALL(p, fmi3GetFloat32, c, &reference, one, &v.f, one); break;
    case 1: CALL(p, fmi3GetInt8, c, &reference, one, &v.i8, one); break;
    case 2: CALL(p, fmi3GetUInt8, c, &reference, one, &v.u8, one); break;
    case 3: CALL(p, fmi3GetInt16, c, &reference, one, &v.i16, one); break;
    case 4: CALL(p, fmi3GetUInt16, c, &reference, one, &v.u16, one); break;
    case 5: CALL(p, fmi3GetUInt32, c, &reference, one, &v.u32, one); break;
    case 6: CALL(p, fmi3GetUInt64, c, &reference, one, &v.u64, one); break;
    case 7: CALL(p, fmi3GetBoolean, c, &reference, one, &v.b, one); break;
    case 8: CALL(p, fmi3GetString, c, &reference, one, &v.s, one); break;
    case 9: CALL(p, fmi3SetFloat32, c, &reference, one, &v.f, one); break;
    case 10: CALL(p, fmi3SetUInt64, c, &reference, one, &v.u64, one); break;
    case 11: CALL(p, fmi3SetBoolean, c, &reference, one, &v.b, one); break;
    case 12: CALL(p, fmi3SetString, c, &reference, one, &v.s, one); break;
    case 13: CALL(p, fmi3GetBinary, c, &reference, one, &size, &v.binary, one); break;
    case 14: CALL(p, fmi3SetBinary, c, &reference, one, &size, &v.binary, one); break;
    case 15: CALL(p, fmi3GetClock, c, &reference, one, &v.b); break;
    case 16: CALL(p, fmi3SetClock, c, &reference, one, &v.b); break;
    case 17: CALL(p, fmi3GetIntervalDecimal, c, &reference, one, &v.d, &v.q); break;
    case 18: CALL(p, fmi3SetIntervalDecimal, c, &reference, one, &v.d); break;
    case 19: CALL(p, fmi3GetShiftDecimal, c, &reference, one, &v.d); break;
    case 20: CALL(p, fmi3GetOutputDerivatives, c, &reference, one, &order, &v.d, one); break;
    case 21: CALL(p, fmi3EnterConfigurationMode, c); break;
    case 22: CALL(p, fmi3ExitConfigurationMode, c); break;
    case 23: CALL(p, fmi3EvaluateDiscreteStates, c); break;
    case 24: CALL(p, fmi3ActivateModelPartition, c, reference, 0.0); break;
    case 25: CALL(p, fmi3SetInt8, c, &reference, one, &v.i8, one); break;
    default: CALL(p, fmi3SetDebugLogging, c, likely(50), one, NULL); break;
    }
}

static void call_end(player *p) {
    int status;
    switch (whole(0, 3)) {
    case 0:
        dispose(&p->u);
        if (likely(10)) { /* what has no instance says Error to everything */
            call_get(p);
            call_event_mode(p);
            dispose(&p->u);
        }
        break;
    case 1: EITHER_CALL(p, fmi2Terminate, (p->u.c), fmi3Terminate, (p->u.c)); break;
    default: EITHER_CALL(p, fmi2Reset, (p->u.c), fmi3Reset, (p->u.c)); break;
    }
}

/* A mode where much can be called, by the shortest way. */
static void call_legal_start(player *p) {
    if (((instance *)p->u.c)->state.mode != INSTANTIATED) return;
    double start = uniform(-1.0, 1.0);
    int status;
    if (p->u.version == 2) CALL(p, fmi2SetupExperiment, p->u.c, fmi2False, 0.0, start, fmi2False, 0.0);
    EITHER_CALL(p, fmi2EnterInitializationMode, (p->u.c), fmi3EnterInitializationMode, (p->u.c, fmi3False, 0.0, start, fmi3False, 0.0));
    if (status == GOOD) EITHER_CALL(p, fmi2ExitInitializationMode, (p->u.c), fmi3ExitInitializationMode, (p->u.c));
    if (status == GOOD && ((instance *)p->u.c)->state.mode == EVENT) {
        call_update(p);
        call_leave(p);
    }
}

static void call_something(player *p) {
    static void (*const frequent[])(player *) = {call_step, call_set, call_get, call_exchange};
    static void (*const all[])(player *) = {call_event_mode, call_update, call_leave, call_initialization, call_legal_start,
                                            call_state, call_state, call_derivative, call_absent};
    if (!p->u.c) {
        try_to_make(p, &folder[whole(0, folders - 1)]);
        return;
    }
    snprintf(where, sizeof where, "a sequence: FMI %d, interface %d, state %d, %.200s", p->u.version, p->u.interface,
             ((instance *)p->u.c)->state.mode, p->u.from->path);
    if (likely(1)) call_end(p);
    else if (likely(60)) frequent[whole(0, 3)](p);
    else all[whole(0, (int)(sizeof all / sizeof *all) - 1)](p);
    if (p->u.c && ((instance *)p->u.c)->state.mode & (FAILED | TERMINATED) && likely(20)) {
        int status;
        EITHER_CALL(p, fmi2Reset, (p->u.c), fmi3Reset, (p->u.c));
    }
}

/* ---------------------------------------------------------------- damaged files */

static void write_damaged(const char *scratch, const model_data *data, size_t size) {
    char path[1100];
    snprintf(path, sizeof path, "%s/model.film", scratch);
    FILE *file = fopen(path, "wb");
    HOLD(file && fwrite(data, 1, size, file) == size && fclose(file) == 0);
}

/* Cut short, flipped, or flipped under a fitting checksum: refused, or right enough never to crash. */
static void damaged_file(const char *scratch, const resources *r, int kind) {
    static model_data data; /* static: large */
    static resources other;
    memcpy(&data, &r->data, sizeof data);
    size_t size = sizeof data, head = offsetof(model_data, token), used = offsetof(model_data, curve) + offsetof(film_curve, piece) +
                  (size_t)r->data.curve.pieces * sizeof(film_piece);
    if (kind == 0) size = (size_t)whole(0, (int)size - 1);
    else
        for (int flips = whole(1, 3); flips > 0; flips--) {
            size_t at = kind == 1 ? (size_t)whole(0, (int)size - 1) : (size_t)whole((int)head + 64, (int)used - 1);
            ((unsigned char *)&data)[at] ^= (unsigned char)(1 << whole(0, 7));
        }
    if (kind == 2) data.checksum = model_checksum((const unsigned char *)&data + head, sizeof data - head);
    write_damaged(scratch, &data, size);
    damaged++;
    memcpy(&other, r, sizeof other);
    memcpy(&other.data, &data, sizeof data);
    snprintf(other.path, sizeof other.path, "%s", scratch);
    snprintf(other.uri, sizeof other.uri, "file://%s", scratch);
    unit made = make(whole(2, 3), whole(0, 1) ? COSIMULATION : EXCHANGE, &other);
    snprintf(where, sizeof where, "a damaged file, kind %d, of %.200s", kind, r->path);
    if (!made.c) {
        HOLD(strstr(last_message, "model.film") && strncmp(last_message, "fmi", 3) == 0);
        return;
    }
    HOLD(kind == 2);
    player p;
    memset(&p, 0, sizeof p);
    p.u = made;
    call_legal_start(&p);
    for (int k = 0; k < 30; k++) {
        if (made.interface == EXCHANGE) call_exchange(&p);
        else call_step(&p);
        call_get(&p);
    }
    dispose(&p.u);
}

int main(int count, char **argument) {
    long calls = count > 3 ? atol(argument[2]) : 0;
    HOLD(strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi3GetVersion(), "3.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0);
    if (calls < 1 || count > MOST_FOLDERS) {
        printf("usage: fmu_fuzz SCRATCH CALLS FOLDER...\n");
        return 2;
    }
    folders = count - 3;
    folder = calloc((size_t)folders, sizeof *folder);
    for (int k = 0; k < folders; k++) open_resources(&folder[k], argument[k + 3]);
    for (long k = 0; k < calls; k++) call_something(&players[whole(0, UNITS - 1)]);
    for (long k = 0; k < calls / 300; k++) damaged_file(argument[1], &folder[k % folders], (int)(k % 5 < 2 ? k % 5 : 2));
    for (int k = 0; k < SAVED; k++) {
        fmi3FMUState state = saves[k].state;
        player any;
        memset(&any, 0, sizeof any);
        while (!any.u.c) try_to_make(&any, &folder[0]);
        HOLD(forget(&any.u, &state) == GOOD);
        dispose(&any.u);
        free(bytes[k]);
    }
    for (int k = 0; k < UNITS; k++) dispose(&players[k].u);
    free(folder);
    snprintf(where, sizeof where, "the end");
    detail[0] = 0;
    HOLD(blocks == 0);
    printf("fmu_fuzz: %ld calls, %ld of them good, %ld refused, %ld damaged files and states\n", calls, good, refused, damaged);
    return 0;
}
