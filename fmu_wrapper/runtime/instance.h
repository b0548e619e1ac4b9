/* An FMU instance, shared by FMI 2.0 and 3.0: allowed calls in each state, saved states, messages.
 * Functions return GOOD or ERROR, the values of fmi2OK/fmi3OK and fmi2Error/fmi3Error; with ERROR, the function has sent
 * a message. */
#ifndef FILM_INSTANCE_H
#define FILM_INSTANCE_H

#include "model.h"

enum { GOOD = 0, WARNING = 1, ERROR = 3 };

/* States of an instance, as bits: a set of them says where a call is allowed. */
enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    EVENT = 4,
    CONTINUOUS = 8,
    STEPPING = 16,
    TERMINATED = 32,
    FAILED = 64,
    INTERMEDIATE = 128, /* within a step, while the importer is called */
    RUNNING = EVENT | CONTINUOUS | STEPPING,
    ANY_MODE = 127      /* but that one */
};

typedef struct instance instance;
typedef void report(const instance *i, int status, const char *category, const char *text);

/* A call of the importer in Intermediate Update Mode: what it may do, and its answer. */
typedef struct {
    double time; /* s */
    int set, get, finished, can_return;
    int returns;
    double return_time; /* s */
} update_call;
typedef void update_caller(const instance *i, update_call *call);

/* Content of a saved state; no pointers. */
typedef struct {
    model_memory memory;
    double stop_time;
    int32_t mode, has_stop_time;
} instance_state;

struct instance {
    model model;
    model_data *data;
    instance_state state; /* except state.memory: model.memory is used */
    int model_exchange, event_mode, early_return;
    report *report;
    void *environment;
    void (*logger)(void); /* the importer's callback; `report` casts it to its type */
    char *name;
    update_caller *updater;   /* NULL: no intermediate updates */
    void (*importer)(void);   /* the importer's callback for them; `updater` casts it to its type */
    update_call update;       /* in Intermediate Update Mode, the present one */
    int sets;                 /* whether the importer sets inputs then */
    unsigned char required[VARIABLES + SENSED * MOST_SENSORS]; /* variables that it may access then, by value reference */
};

typedef struct {
    const char *name, *token, *folder;
    int model_exchange, event_mode, early_return;
    report *report;
    void *environment;
    void (*logger)(void);
} instance_options;

/* Returns NULL after an error message if the instance cannot be created. With `error` != NULL, only sends that message. */
instance *instance_new(const char *function, const instance_options *options, const char *error);
void instance_free(instance *i);

int instance_allows(const instance *i, const char *function, int modes);
int instance_error(const instance *i, const char *function, const char *format, ...);

int instance_set_up(instance *i, const char *function, double start, int has_stop, double stop);
int instance_enter_initialization(instance *i, const char *function);
int instance_exit_initialization(instance *i, const char *function);
int instance_terminate(instance *i, const char *function);
int instance_reset(instance *i, const char *function);

/* Get or set one variable, whose type (REAL, WHOLE or ENUMERATION) must be one of two, which may be the same. */
int instance_get(instance *i, const char *function, unsigned reference, int type, int or_type, double *value);
int instance_set(instance *i, const char *function, unsigned reference, int type, int or_type, double value);

int instance_save(instance *i, const char *function, void **saved);
int instance_restore(instance *i, const char *function, const void *saved);
int instance_free_state(void **saved);
int instance_size(instance *i, const char *function, const void *saved, size_t *size);
int instance_serialize(instance *i, const char *function, const void *saved, unsigned char *bytes, size_t size);
int instance_deserialize(instance *i, const char *function, const unsigned char *bytes, size_t size, void **saved);

/* sensitivity = J seed, J = partial derivatives of the unknowns with respect to the knowns; adjoint: transposed J. */
int instance_derivatives(instance *i, const char *function, const unsigned *unknowns, size_t unknown_count,
                         const unsigned *knowns, size_t known_count, const double *seed, double *sensitivity, int adjoint);

int instance_step(instance *i, const char *function, double from, double size, int *event);
/* Call the importer during steps, if it wants variables then. An impact: inputs at the end of each part of the step, before it
 * is computed, and in between change linearly; outputs at the inner ends, and at events. A contact: both at the inner ends. */
int instance_require(instance *i, const char *function, const unsigned *references, size_t count, update_caller *updater,
                     void (*importer)(void));
/* Whether a variable may be accessed; outside Intermediate Update Mode always. */
int instance_may_get(const instance *i, const char *function, unsigned reference);
int instance_may_set(const instance *i, const char *function, unsigned reference);

int instance_enter_event_mode(instance *i, const char *function);
/* *restart: 1 if an event has changed the motion, so that an integrator should start anew. */
int instance_update(instance *i, const char *function, int *restart);
int instance_leave_event_mode(instance *i, const char *function, int mode);
int instance_completed(instance *i, const char *function);
int instance_set_time(instance *i, const char *function, double time);
int instance_set_states(instance *i, const char *function, const double *states, size_t count);
/* States, derivatives, nominal values or event indicators. */
enum { GET_STATES, GET_RATES, GET_NOMINALS, GET_INDICATORS };
int instance_vector(instance *i, const char *function, int what, double *values, size_t count);
size_t instance_state_count(const instance *i);

#endif
