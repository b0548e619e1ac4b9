/* What both FMI versions share: an instance, which calls it allows when, its saved states and its messages.
 * Every function returns GOOD or ERROR, which are fmi2OK/fmi3OK and fmi2Error/fmi3Error; an ERROR has been reported. */
#ifndef FILM_INSTANCE_H
#define FILM_INSTANCE_H

#include "model.h"

enum { GOOD = 0, ERROR = 3 };

/* Where an instance is, as a set for what a call allows. */
enum {
    INSTANTIATED = 1,
    INITIALIZATION = 2,
    EVENT = 4,
    CONTINUOUS = 8,
    STEPPING = 16,
    TERMINATED = 32,
    FAILED = 64,
    RUNNING = EVENT | CONTINUOUS | STEPPING,
    ANYWHERE = 127
};

typedef struct instance instance;
typedef void report(const instance *i, int status, const char *category, const char *text);

/* All that a saved state holds; no pointers. */
typedef struct {
    model_memory memory;
    double stop_time;
    int32_t mode, has_stop_time;
} instance_state;

struct instance {
    model model;
    model_data *data;
    instance_state state; /* but for the memory, which is the model's */
    int model_exchange, event_mode, early_return;
    report *report;
    void *environment;
    void (*logger)(void); /* as the importer gave it; report knows its type */
    char *name;
};

typedef struct {
    const char *name, *token, *folder;
    int model_exchange, event_mode, early_return;
    report *report;
    void *environment;
    void (*logger)(void);
} instance_options;

/* NULL when it cannot be made, with a reason reported; `why` is reported instead of trying, if there is one. */
instance *instance_new(const char *function, const instance_options *options, const char *why);
void instance_free(instance *i);

int instance_allows(const instance *i, const char *function, int modes);
int instance_fails(const instance *i, const char *function, const char *format, ...);

int instance_set_up(instance *i, const char *function, double start, int has_stop, double stop);
int instance_enter_initialization(instance *i, const char *function);
int instance_exit_initialization(instance *i, const char *function);
int instance_terminate(instance *i, const char *function);
int instance_reset(instance *i, const char *function);

/* One variable of the type (REAL, WHOLE or ENUMERATION) or, where either will do, of two types. */
int instance_get(instance *i, const char *function, unsigned reference, int type, int or_type, double *value);
int instance_set(instance *i, const char *function, unsigned reference, int type, int or_type, double value);

int instance_save(instance *i, const char *function, void **saved);
int instance_restore(instance *i, const char *function, const void *saved);
int instance_size(instance *i, const char *function, const void *saved, size_t *size);
int instance_serialize(instance *i, const char *function, const void *saved, unsigned char *bytes, size_t size);
int instance_deserialize(instance *i, const char *function, const unsigned char *bytes, size_t size, void **saved);

/* sensitivity = (partial derivatives of the unknowns by the knowns) seed, or with the transposed matrix. */
int instance_derivatives(instance *i, const char *function, const unsigned *unknowns, size_t unknown_count,
                         const unsigned *knowns, size_t known_count, const double *seed, double *sensitivity, int adjoint);

int instance_step(instance *i, const char *function, double from, double size, int *event);

int instance_enter_event_mode(instance *i, const char *function);
int instance_update(instance *i, const char *function);
int instance_leave_event_mode(instance *i, const char *function, int mode);
int instance_completed(instance *i, const char *function);
int instance_set_time(instance *i, const char *function, double time);
int instance_set_states(instance *i, const char *function, const double *states, size_t count);
/* What: the states, their rates, their nominals, the event indicators. */
enum { GET_STATES, GET_RATES, GET_NOMINALS, GET_INDICATORS };
int instance_vector(instance *i, const char *function, int what, double *values, size_t count);
size_t instance_state_count(const instance *i);

#endif
