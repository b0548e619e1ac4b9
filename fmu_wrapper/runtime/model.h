/* The impact, and the contact alone, as components in SI units: what the FMI functions are thin shims around.
 * Knows no FMI. No globals; the only memory allocated is that of a mesh's nodes. Directions are positive into the target. */
#ifndef FILM_MODEL_H
#define FILM_MODEL_H

#include "film_core.h"
#include "variables.h"

enum { STATES = 3, SCALING = 3, DAMPING = 5 }; /* indentation, impactor velocity, target displacement; see model_data */
enum { MOST_EVENTS = 1000000 };   /* in one step: a ball that bounces for ever has no end of them */

/* What an export fixes: resources/model.film, written by fmu_wrapper/resource.py, little endian as all platforms are.
 * The scales of the march are length = length_scale * prod (p/start)^length_power over p = radius, effective modulus and
 * yield strength; force likewise. What the curve's damping is multiplied with, N s/m, is a product of powers of mass and
 * initial velocity too. */
typedef struct {
    char magic[8];
    uint64_t size;     /* of this structure */
    uint64_t checksum; /* FNV-1a of everything after it */
    char token[64];    /* instantiation token, GUID */
    int32_t kind, linearisation;
    int32_t available[SETTABLE]; /* whether this law has the parameter */
    int32_t even;                /* keeps the numbers below at multiples of 8 */
    double start[SETTABLE];
    double length_scale, length_power[SCALING];
    double force_scale, force_power[SCALING];
    double damping, damping_power[DAMPING];
    double speed; /* typical relative velocity, m/s */
    double nominal[STATES];
    film_curve curve;
} model_data;

/* What is known of events: the discrete outputs. */
typedef struct {
    int32_t phase, stage, contacts, events, last_event, seen;
    double time[VARIABLES - SETTABLE]; /* times and values, by value reference less SETTABLE */
} model_record;

/* Everything that changes, without pointers: copying it saves it. */
typedef struct {
    double value[SETTABLE]; /* parameters and inputs, SI */
    double start_time, now;
    double length, force, tick, velocity; /* scales: m, N, s, m/s */
    double load, support;                 /* as the state has them: a part of the force scale; m/s */
    double support_displacement;
    double contact_speed;
    double at[STATES]; /* an importer's integrator has them here, SI */
    double committed_time, committed_indentation, committed_rate, reached; /* contact: last point of the path, and
                                                                              the indentation now */
    film_state state;
    model_record happened, shown; /* what is known, and what outputs tell: more comes to light by model_show */
    int32_t begun, continuous;    /* parameters are taken over; an importer's integrator owns the states */
} model_memory;

typedef struct {
    const model_data *data;
    film_mesh mesh;
    double *nodes;
    char message[240]; /* of the last failure */
    model_memory memory;
} model;

/* Read, check and free the data of an export. NULL with a message of at most `room` characters. */
model_data *model_read_data(const char *folder, char *message, size_t room);
/* A file URI such as file:///tmp/a%20b/resources as a path, in place of `path` with its room; 0, or -1 if it is none. */
int model_path_of_uri(const char *uri, char *path, size_t room);

/* FNV-1a. */
uint64_t model_checksum(const void *from, size_t count);

void model_init(model *m, const model_data *data);
void model_free(model *m);

/* All of these return 0, or -1 with m->message. */
int model_set(model *m, unsigned reference, double value);
int model_get(model *m, unsigned reference, double *value);
int model_partial(model *m, unsigned unknown, unsigned known, double *partial);
int model_depends(const model *m, unsigned unknown, unsigned known);
/* Takes over the parameters; time: when the simulation starts. */
int model_begin(model *m, double time);
/* After model_begin: whatever happens at once. `continuous`: an importer's integrator owns the states. */
int model_start(model *m, int continuous);
/* To time `end` >= now, s. With stop_at_events: to the next event, if that comes first; *stopped says so. */
int model_step(model *m, double end, int stop_at_events, int *stopped);
/* Whether something has happened that outputs do not tell yet; to tell it. */
int model_hides(const model *m);
void model_show(model *m);
/* The nodes that belong to the memory, after it was replaced. */
int model_restored(model *m);

/* Model exchange. */
int model_rates(model *m, double rates[STATES]);
int model_indicators(model *m, double indicators[FILM_INDICATORS]);
int model_switch(model *m); /* all events that are due */
void model_reached(model *m); /* the states and inputs are a point of the motion, not only tried */

#endif
