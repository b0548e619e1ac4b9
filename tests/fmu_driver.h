/* Shared by the C checks of the FMU runtime: assertions, counted memory, the last message, and one
 * interface to the functions of FMI 2.0 and 3.0. Each program includes it in one source file. */
#ifndef FMU_DRIVER_H
#define FMU_DRIVER_H

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include "instance.h"
#include "random_numbers.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------- checking */

static long checks = 0, messages = 0;
static int last_status = 0;
static char last_message[1024] = "";
static char where[400] = "", detail[100] = "";

static void hold(int condition, const char *what, const char *file, int line) {
    checks++;
    if (condition) return;
    printf("%s:%d: does not hold: %s\n    in %s %s\n    the last message: %s\n", file, line, what, where, detail, last_message);
    exit(1);
}
#define HOLD(condition) hold((condition), #condition, __FILE__, __LINE__)

/* ---------------------------------------------------------------- memory: link with --wrap=malloc,calloc,free */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *memory);

static long blocks = 0;      /* allocated and not freed */
static long until_none = -1; /* allocations that still succeed; -1: all */
static long refusals = 0;

static int none_left(void) {
    int none = until_none == 0;
    if (until_none > 0) until_none--;
    refusals += none;
    return none;
}

void *__wrap_malloc(size_t size) {
    void *memory = none_left() ? NULL : __real_malloc(size);
    blocks += memory != NULL;
    return memory;
}

void *__wrap_calloc(size_t count, size_t size) {
    void *memory = none_left() ? NULL : __real_calloc(count, size);
    blocks += memory != NULL;
    return memory;
}

void __wrap_free(void *memory) {
    blocks -= memory != NULL;
    __real_free(memory);
}

/* ---------------------------------------------------------------- messages */

static void heard(int status, const char *category, const char *text) {
    if (strcmp(category, "validity") == 0 && status == WARNING) return; /* comes with calls that succeed */
    messages++;
    last_status = status;
    snprintf(last_message, sizeof last_message, "%s", text);
}

static void logger_2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                     fmi2String format, ...) {
    char text[1024];
    va_list arguments;
    (void)environment, (void)name;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    heard((int)status, category, text);
}

static void logger_3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment;
    heard((int)status, category, message);
}

static const fmi2CallbackFunctions CALLBACKS = {logger_2, NULL, NULL, NULL, NULL};

/* ---------------------------------------------------------------- an FMU's resources */

typedef struct {
    char path[1024], uri[3200];
    model_data data;
    model_data *file; /* with all that follows it */
} resources;

static void open_resources(resources *r, const char *path) {
    char message[600];
    model_data *data = model_read_data(path, message, sizeof message);
    if (!data || strlen(path) >= sizeof r->path || path[0] != '/') {
        printf("%s\n", data ? "the path must be absolute" : message);
        exit(2);
    }
    memcpy(&r->data, data, sizeof r->data);
    r->file = data;
    snprintf(r->path, sizeof r->path, "%s", path);
    size_t used = (size_t)snprintf(r->uri, sizeof r->uri, "file://");
    for (const char *c = path; *c; c++) { /* escape all characters that may be escaped */
        int plain = *c == '/' || (*c >= 'a' && *c <= 'z');
        used += (size_t)snprintf(r->uri + used, sizeof r->uri - used, plain ? "%c" : "%%%02X", plain ? *c : (unsigned char)*c);
    }
}

static void close_resources(resources *r, int count) {
    for (int k = 0; k < count; k++) free(r[k].file);
    free(r);
}

static inline int relaxing(const resources *r) { return r->data.relaxation.tolerance > 0.0; }

/* For Model Exchange too: not on a target that vibrates or has a static stiffness, nor of viscoelastic bodies. */
static inline int exchanges(const resources *r) {
    return r->data.modes.count == 0 && !relaxing(r) && !r->data.available[TARGET_STIFFNESS];
}

/* Those, or with friction: not the march of the law's curve alone. */
static inline int beside(const resources *r) { return !exchanges(r) || r->data.available[TORQUE]; }

/* ---------------------------------------------------------------- one interface to both versions */

enum { COSIMULATION, WITH_EVENTS, EARLY_RETURN, EXCHANGE, INTERFACES }; /* the middle two in FMI 3.0 only */

typedef struct {
    int version, interface;
    const resources *from;
    void *c;
    double now; /* communication point */
} unit;

/* What the importer does in intermediate updates of FMI 3.0, or NULL; and what it accesses then. */
static fmi3IntermediateUpdateCallback importer = NULL;
static unsigned required[VARIABLES];
static size_t required_count = 0;
static unit *in_step = NULL; /* whose step calls it */

static inline unit make(int version, int interface, const resources *from) {
    unit u = {version, interface, from, NULL, 0.0};
    const char *token = from->data.token;
    if (version == 2)
        u.c = fmi2Instantiate("unit", interface == EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation, token, from->uri, &CALLBACKS,
                              fmi2False, fmi2True);
    else if (interface == EXCHANGE)
        u.c = fmi3InstantiateModelExchange("unit", token, from->path, fmi3False, fmi3True, NULL, logger_3);
    else
        u.c = fmi3InstantiateCoSimulation("unit", token, from->path, fmi3False, fmi3True, interface != COSIMULATION,
                                          interface == EARLY_RETURN, required, required_count, NULL, logger_3, importer);
    return u;
}

static inline void dispose(unit *u) {
    if (u->version == 2) fmi2FreeInstance(u->c);
    else fmi3FreeInstance(u->c);
    u->c = NULL;
}

#define EITHER(call_2, call_3) (u->version == 2 ? (int)(call_2) : (int)(call_3))

static inline int set(unit *u, unsigned reference, double value) {
    if (VARIABLE[reference].type == REAL)
        return EITHER(fmi2SetReal(u->c, &reference, 1, &value), fmi3SetFloat64(u->c, &reference, 1, &value, 1));
    int number = (int)value;
    return EITHER(fmi2SetInteger(u->c, &reference, 1, &number), fmi3SetInt32(u->c, &reference, 1, &number, 1));
}

static inline double get(unit *u, unsigned reference) {
    double value = 0.0;
    int32_t number = 0;
    fmi3Int64 item = 0;
    int status = GOOD;
    switch (VARIABLE[reference].type) {
    case REAL:
        status = EITHER(fmi2GetReal(u->c, &reference, 1, &value), fmi3GetFloat64(u->c, &reference, 1, &value, 1));
        break;
    case WHOLE:
        status = EITHER(fmi2GetInteger(u->c, &reference, 1, &number), fmi3GetInt32(u->c, &reference, 1, &number, 1));
        value = number;
        break;
    default:
        status = EITHER(fmi2GetInteger(u->c, &reference, 1, &number), fmi3GetInt64(u->c, &reference, 1, &item, 1));
        value = u->version == 2 ? number : (double)item;
        break;
    }
    HOLD(status == GOOD);
    HOLD(isfinite(value));
    return value;
}

static inline int has(const resources *r, unsigned reference) {
    if (!exchanges(r) && VARIABLE[reference].changes == IN_MODEL_EXCHANGE) return 0;
    int rubs = reference == RATE_OF_TANGENTIAL_VELOCITY || reference == RATE_OF_SPIN;
    rubs |= reference >= SLIDING_DISPLACEMENT && reference <= TIME_OF_LAST_SLIDING_EVENT;
    if (rubs && !r->data.available[TORQUE]) return 0;
    return VARIABLE[reference].role[r->data.kind] != ABSENT && (reference >= SETTABLE || r->data.available[reference]);
}

/* Require all inputs and outputs that may be accessed in intermediate updates. */
static inline void require(const resources *r, int inputs) {
    required_count = 0;
    for (unsigned k = EXTERNAL_FORCE; k < VARIABLES; k++) {
        const film_variable *v = &VARIABLE[k];
        int input = v->role[r->data.kind] == INPUT, output = v->role[r->data.kind] == OUTPUT;
        if (has(r, k) && v->type == REAL && v->changes == ANY_TIME && ((input && inputs) || output)) required[required_count++] = k;
    }
}

/* All variables; 0 for those that this FMU does not have. */
static inline void get_all(unit *u, double values[VARIABLES]) {
    for (unsigned k = 0; k < VARIABLES; k++) values[k] = has(u->from, k) ? get(u, k) : 0.0;
}

static inline int enter_initialization(unit *u, double start) {
    u->now = start;
    if (u->version == 3) return (int)fmi3EnterInitializationMode(u->c, fmi3False, 0.0, start, fmi3False, 0.0);
    int status = (int)fmi2SetupExperiment(u->c, fmi2False, 0.0, start, fmi2False, 0.0);
    return status == GOOD ? (int)fmi2EnterInitializationMode(u->c) : status;
}

static inline int exit_initialization(unit *u) {
    return EITHER(fmi2ExitInitializationMode(u->c), fmi3ExitInitializationMode(u->c));
}

static inline int enter_event_mode(unit *u) { return EITHER(fmi2EnterEventMode(u->c), fmi3EnterEventMode(u->c)); }

static inline int update(unit *u) {
    fmi2EventInfo info = {fmi2True, fmi2True, fmi2True, fmi2True, fmi2True, 1.0};
    fmi3Boolean again = fmi3True, end = fmi3True, nominals = fmi3True, values = fmi3True, defined = fmi3True;
    fmi3Float64 next = 0.0;
    int status = EITHER(fmi2NewDiscreteStates(u->c, &info),
                        fmi3UpdateDiscreteStates(u->c, &again, &end, &nominals, &values, &defined, &next));
    if (status != GOOD) return status;
    HOLD(u->version == 2 ? !info.newDiscreteStatesNeeded && !info.terminateSimulation && !info.nextEventTimeDefined &&
                               !info.nominalsOfContinuousStatesChanged && (!info.valuesOfContinuousStatesChanged || u->interface == EXCHANGE)
                         : !again && !end && !nominals && !defined && (!values || u->interface == EXCHANGE));
    return status;
}

static inline int leave_event_mode(unit *u) {
    if (u->interface == EXCHANGE) return EITHER(fmi2EnterContinuousTimeMode(u->c), fmi3EnterContinuousTimeMode(u->c));
    return (int)fmi3EnterStepMode(u->c);
}

static inline int reset(unit *u) { return EITHER(fmi2Reset(u->c), fmi3Reset(u->c)); }
static inline int terminate(unit *u) { return EITHER(fmi2Terminate(u->c), fmi3Terminate(u->c)); }
static inline int save(unit *u, void **saved) { return EITHER(fmi2GetFMUstate(u->c, saved), fmi3GetFMUState(u->c, saved)); }
static inline int restore(unit *u, void *saved) { return EITHER(fmi2SetFMUstate(u->c, saved), fmi3SetFMUState(u->c, saved)); }
static inline int forget(unit *u, void **saved) { return EITHER(fmi2FreeFMUstate(u->c, saved), fmi3FreeFMUState(u->c, saved)); }

static inline int saved_size(unit *u, void *saved, size_t *size) {
    return EITHER(fmi2SerializedFMUstateSize(u->c, saved, size), fmi3SerializedFMUStateSize(u->c, saved, size));
}

static inline int serialize(unit *u, void *saved, unsigned char *bytes, size_t size) {
    return EITHER(fmi2SerializeFMUstate(u->c, saved, (fmi2Byte *)bytes, size), fmi3SerializeFMUState(u->c, saved, bytes, size));
}

static inline int deserialize(unit *u, const unsigned char *bytes, size_t size, void **saved) {
    return EITHER(fmi2DeSerializeFMUstate(u->c, (const fmi2Byte *)bytes, size, saved),
                  fmi3DeserializeFMUState(u->c, bytes, size, saved));
}

/* *event_mode: whether the FMU asks for Event Mode; only with friction, for a new phase of sliding. */
static inline int completed_step(unit *u, int *event_mode) {
    fmi2Boolean event = fmi2True, end = fmi2True;
    fmi3Boolean event_3 = fmi3True, end_3 = fmi3True;
    int status = EITHER(fmi2CompletedIntegratorStep(u->c, fmi2True, &event, &end),
                        fmi3CompletedIntegratorStep(u->c, fmi3True, &event_3, &end_3));
    HOLD(u->version == 2 ? !end : !end_3);
    *event_mode = u->version == 2 ? event : event_3;
    HOLD(!*event_mode || u->from->data.available[TORQUE]);
    return status;
}

static inline int set_time(unit *u, double time) { return EITHER(fmi2SetTime(u->c, time), fmi3SetTime(u->c, time)); }

static inline int set_states(unit *u, const double *x, size_t count) {
    return EITHER(fmi2SetContinuousStates(u->c, x, count), fmi3SetContinuousStates(u->c, x, count));
}

static inline int get_states(unit *u, double *x, size_t count) {
    return EITHER(fmi2GetContinuousStates(u->c, x, count), fmi3GetContinuousStates(u->c, x, count));
}

static inline int get_rates(unit *u, double *rates, size_t count) {
    return EITHER(fmi2GetDerivatives(u->c, rates, count), fmi3GetContinuousStateDerivatives(u->c, rates, count));
}

static inline int get_nominals(unit *u, double *x, size_t count) {
    return EITHER(fmi2GetNominalsOfContinuousStates(u->c, x, count), fmi3GetNominalsOfContinuousStates(u->c, x, count));
}

static inline int get_indicators(unit *u, double *z, size_t count) {
    return EITHER(fmi2GetEventIndicators(u->c, z, count), fmi3GetEventIndicators(u->c, z, count));
}

static inline int derivative(unit *u, const unsigned *unknown, size_t unknowns, const unsigned *known, size_t knowns, const double *seeds,
                      double *result) {
    return EITHER(fmi2GetDirectionalDerivative(u->c, unknown, unknowns, known, knowns, seeds, result),
                  fmi3GetDirectionalDerivative(u->c, unknown, unknowns, known, knowns, seeds, knowns, result, unknowns));
}

typedef struct {
    int event, early;
    double time;
} stepped;

/* One call; FMI 2.0 only returns the status. */
static inline int do_step(unit *u, double from, double size, stepped *how) {
    in_step = u;
    if (u->version == 2) {
        how->event = how->early = 0;
        how->time = from + size;
        return (int)fmi2DoStep(u->c, from, size, fmi2True);
    }
    fmi3Boolean event = fmi3True, end = fmi3True, early = fmi3True;
    int status = (int)fmi3DoStep(u->c, from, size, fmi3True, &event, &end, &early, &how->time);
    how->event = event;
    how->early = early;
    if (status == GOOD) HOLD(!end && (!early || event || importer));
    return status;
}

#endif
