/* The impact, and the contact alone, as components in SI units; the FMI functions only call these functions.
 * Independent of FMI. No global variables; the only memory allocated is that of the mesh's nodes, of a curve, of a
 * vibrating target, and of viscoelastic bodies 340 kB. Positive directions point into the target. */
#ifndef FILM_MODEL_H
#define FILM_MODEL_H

#include "modal/film_modal.h"
#include "modal/film_slide.h"
#include "relax/film_relax.h"
#include "variables.h"

/* Indentation, impactor velocity, target displacement; with friction also sliding displacement, tangential velocity, spin and
 * tangential impulse. */
enum { NORMAL_STATES = 3, STATES = 7 };
enum { SCALINGS = 7, DAMPINGS = 12, RESTITUTION_TERMS = 48 };  /* parameters that scale the march, and its damping; see model_data */
enum { INPUTS = 5 };                   /* of an impact, from EXTERNAL_FORCE on */
enum { LIMITS = 2, LONGEST_REASON = 80 };
enum { MAX_STEP_EVENTS = 100000, MAX_SLIDING_EVENTS = 4000 }; /* of a step, and with friction: a ball may bounce for ever; 0.1 to 2 s */

/* The family of curves of a law whose stages depend on a shape: shape * prod (p/start)^power with p = radius, effective
 * modulus, yield strength. If nodes > 0, a film_curve (`whole`) and the numbers of film_family follow model_data. */
enum { SHAPE_POWERS = 3 };
typedef struct {
    double shape, power[SHAPE_POWERS], low, high;
    int32_t nodes, varying;
} model_family;

/* A target that vibrates: count > 0, and (sensors + 3) count numbers follow model_data (after those of the family): the weights of
 * film_modal_sensed, natural frequencies [rad/s], ascending, shares [1/kg] and damping ratios. rest: compliance of the omitted
 * modes, m/N. The value references of the sensors follow those of the variables, SENSED a sensor. */
typedef struct {
    double longest, rest, tolerance; /* of film_structure [s], film_modal_start */
    int32_t count, levels, sensors, padding;
} model_modes;
enum { SENSED = 3, MOST_SENSORS = 100 }; /* displacement, velocity and acceleration of a sensor */

/* Viscoelastic bodies: tolerance > 0. law: rates in 1/s; tolerance: of film_relax. */
typedef struct {
    film_relaxation law;
    double tolerance;
} model_relaxation;

/* An FMU has friction if the input torque is available. ratio: kappa = E_star/(4 G_star); lever: from the impactor's centre to the
 * contact, m; inertia: its moment of inertia over mass lever^2. rows: pairs of sliding speed, m/s, and coefficient, in place of the
 * parameter friction; they follow model_data between the numbers of the family and those of the modes. */
typedef struct {
    double ratio, lever, inertia;
    int32_t rows, padding;
} model_friction;
enum { MOST_ROWS = 100000 };

/* What Python's film_model/problem/stresses.py computes, in numbers; 0 for what is unknown. radius: m; hertz: force over the
 * indentation to the power 1.5 of an elastic contact, N/m^1.5; first_radius: contact radius at first yield over the ball's;
 * onset to sunk: of the contact of law elastoplastic (laws/elastoplastic.py), hardens being the exponent of its hardening;
 * widening: a^2/(R delta) of the law's own contact where it is not Hertz's; shear, depth: largest shear stress and its place
 * below the surface, over the peak pressure and the contact radius. The others are the constants there. */
typedef struct {
    double radius, hertz, first_radius, onset, spread, lateness, pressure, pressure_flattened, pressure_bend, strain, hardens;
    double share, flattened, sunk, widening, hertzian, shallow, shear, depth;
} model_stresses;

/* The data of an export: resources/model.film, written by fmu_wrapper/resource.py, with fmu_wrapper/layout.py, this structure
 * in Python; little endian, as all platforms are.
 * The scales of the march depend on the parameters p of the law (SCALES_BY in model.c):
 * length = length_scale * prod (p/start)^length_power, and force likewise. The damping factor (N s/m) is such a product
 * too, with mass, initial velocity and parameters of damping; at another restitution e than at the start, (1 - e) exp(series) stands
 * for it, a Chebyshev series in 2 ln(e)/ln(least e) - 1. The assumptions of the export hold for parameters within
 * `valid`, where `reason` names what fails below and above, and for indentations up to `limit`, which is such a product. */
typedef struct {
    char magic[8];
    uint64_t size;     /* of this structure and what follows it */
    uint64_t checksum; /* model_checksum of everything after it */
    char token[64];    /* instantiation token, GUID */
    int32_t kind, linearisation;
    int32_t available[SETTABLE]; /* whether this law has the parameter */
    int32_t padding;             /* aligns the members below to 8 bytes */
    double start[SETTABLE];
    double length_scale, length_power[SCALINGS];
    double force_scale, force_power[SCALINGS];
    double damping, damping_power[DAMPINGS];
    double restitution[RESTITUTION_TERMS];
    double speed; /* typical relative velocity, m/s */
    double nominal[STATES];
    double valid[SETTABLE][2];
    double also[2]; /* m/s: slower velocities at first touch that are valid too */
    char reason[SETTABLE][2][LONGEST_REASON];
    double limit[LIMITS], limit_power[LIMITS][SCALINGS]; /* m: of an elastic law, of a narrow contact */
    model_stresses stresses;
    film_curve curve;
    model_family family;
    model_modes modes;
    model_relaxation relaxation;
    model_friction friction;
} model_data;

enum { HAD_MAXIMUM = 1, HAD_STOP = 2 };         /* events in the current contact */
/* Assumptions of the export that do not hold: see the variable validity. */
enum { OUTSIDE = 1, YIELDS = 2, WIDE = 4, COARSE = 8 };
enum { FEWEST_STEPS = 20 }; /* of a contact alone: with them the restitution of an elastic contact errs by 1.2 % */

/* The discrete outputs. */
typedef struct {
    int32_t phase, stage, contacts, events, last_event, had;
    int32_t validity;        /* sum of OUTSIDE, YIELDS, WIDE, COARSE */
    int32_t steps, coarse;   /* contact: communication steps of the present contact; of the first that had too few, 0: none */
    int32_t outside_contact; /* number of the first contact that began with a velocity outside its range; 0: none */
    double outside_speed;    /* that velocity, m/s */
    double value[VARIABLES - SETTABLE]; /* times and values of events, by value reference - SETTABLE */
} model_record;

/* Everything that changes during a simulation. No pointers: copying it saves it. */
typedef struct {
    double value[SETTABLE];                      /* parameters and inputs, SI */
    double start_time, time;                     /* s */
    double length, force, time_scale, velocity;  /* scales: m, N, s, m/s */
    double load, support;                        /* inputs in use: load over the force scale; support velocity, m/s */
    double support_displacement;                 /* m */
    double contact_speed;                        /* relative velocity at first touch, over the velocity scale */
    double states[STATES];                       /* in Model Exchange, as set by the importer, SI */
    double step_force;                           /* mean contact force over the last communication step, N */
    double impulse, released, external;          /* of contact, N s; work done by the contact force on the impactor, and by
                                                    gravity and external force, J */
    double first_inputs[INPUTS];                 /* those at the start, as `value` */
    double input_rates[INPUTS];                  /* their time derivatives in the next step, 1/s times their units */
    double committed_time, committed_indentation, committed_rate; /* contact: last accepted point of the path, SI */
    double indentation, rate;                    /* contact: at the current time, set or extrapolated, m and m/s */
    double recoil;                               /* velocity of a vibrating target's struck point, over the velocity scale */
    double tangential_support;                   /* the input in use, m/s */
    double pushed, turned;                       /* integrals of tangential_force and torque, N s and N m s */
    film_sliding sliding;                        /* motion along the surface, of an FMU with friction */
    film_slide_point accepted;                   /* in Model Exchange: where its springs are */
    double sliding_time;                         /* when its latest phase began, s; and what and how many */
    int32_t sliding_event, sliding_events;
    film_state state;                            /* on a vibrating target (time in s), and of viscoelastic bodies: as the state
                                                    beside this memory, with the motion now */
    model_record actual, reported; /* after the latest event; as outputs show it, until the next model_report */
    int32_t initialized;           /* the parameters are in use */
    int32_t importer_integrates;   /* Model Exchange */
    int32_t announced;             /* of validity: what has been logged */
    int32_t varied;                /* the inputs in use have changed since the start */
    int32_t unsummed;              /* 1: of a vibrating target, only the sum of xi and shift is known */
    int32_t retuned;               /* 1: a tunable parameter has changed, which the law's damping may not follow yet */
} model_memory;

typedef struct {
    const model_data *data;
    const film_curve *curve; /* for the parameters: that of the data, or `own` */
    film_curve *own;
    film_mesh mesh;
    double *nodes;
    film_structure structure; /* of a vibrating target, with its memory */
    double *tables;
    double *friction;         /* pairs of a table, speeds in the unit of film_slide.h */
    double *sensed;           /* of film_modal_sensed, if known: the motion of the sensors now */
    int32_t sensed_known;
    film_modal *modal;        /* its state, followed by the modes; saved beside model_memory */
    film_relax *relax;        /* state of viscoelastic bodies, followed by its FILM_RELAX_STEPS steps; saved likewise */
    char message[240]; /* of the last error */
    model_memory memory;
} model;

/* Read and check the data of an export. Returns NULL and writes a message of at most `room` characters on failure. */
model_data *model_read_data(const char *folder, char *message, size_t room);
/* Whether the folder has the file of that data. */
int model_has_data(const char *folder);
/* Convert a file URI such as file:///tmp/a%20b/resources to a path of at most `room` characters. -1: not a file URI.
 * Without `escapes`, %20 stays as it is. */
int model_path_of_uri(const char *uri, char *path, size_t room, int escapes);

/* The pairs of a table of friction. */
const double *model_friction_table(const model_data *data);

/* FNV-1a hash, of words of 8 bytes. */
uint64_t model_checksum(const void *from, size_t count);

void model_init(model *m, const model_data *data);
void model_free(model *m);

/* All functions below that return int return 0, or -1 with m->message, unless noted otherwise. */

int model_set(model *m, unsigned reference, double value);
/* The same of a tunable parameter in a running simulation. */
int model_tune(model *m, unsigned reference, double value);
/* The same of any parameter but those of the start, between steps of the importer's integrator: rates and outputs are functions of
 * states, inputs and parameters. Refused, except mass, impedance and gravity, while a contact remembers an indentation. */
int model_move_parameter(model *m, unsigned reference, double value);
int model_get(model *m, unsigned reference, double *value);
/* Let an input of an impact change at a constant rate in the next step of Co-Simulation; its mean moves the impactor.
 * order: of the time derivative; only 1 is known, here and of outputs. */
int model_set_input_rate(model *m, unsigned reference, int order, double rate);
/* Time derivative of a real output in Co-Simulation. */
int model_output_rate(model *m, unsigned reference, int order, double *rate);
int model_is_parameter(const model *m, unsigned reference);
/* Whether this is the motion of a sensor of this FMU; and the name of a variable for messages. */
int model_is_sensed(const model *m, unsigned reference);
const char *model_name(const model *m, unsigned reference);
/* Whether an output depends directly on a variable: 1 or 0; -1: not a real output. */
int model_depends(const model *m, unsigned unknown, unsigned known);

/* Derivatives of all outputs by one parameter, and which of them have a kink or a jump there. */
typedef struct {
    unsigned by; /* VARIABLES: none yet */
    double value[VARIABLES];
    int kinked[VARIABLES];
} model_slopes;

/* Derivative of an output with respect to an input, a state or a parameter; `slopes` keeps those by the latest parameter.
 * initial: in Initialization Mode. */
int model_derivative(model *m, unsigned unknown, unsigned known, int initial, model_slopes *slopes, double *derivative);

/* Compute scales, mesh and state from the parameters. time: start of the simulation, s. */
int model_initialize(model *m, double time);
/* After model_initialize: handle the events at the start time. */
int model_start(model *m, int importer_integrates);
/* Advance to time `end` >= time, s. With stop_at_events: only to the next event if that is earlier; *stopped is then 1. */
int model_step(model *m, double end, int stop_at_events, int *stopped);
/* The same in two calls, the second for each part of a communication step, whose work is limited as a whole. */
void model_begin_step(model *m);
int model_continue(model *m, double end, int stop_at_events, int *stopped);
/* Pass changed inputs of an impact to the motion, as steps do at their beginning. */
int model_apply_inputs(model *m);
/* Whether an event has happened that the outputs do not show yet (0 or 1); and update the outputs. */
int model_has_unreported(const model *m);
void model_report(model *m);
/* Make what the parameters in the memory need, unless it exists already: mesh, curve, tables, room for states. */
int model_update(model *m);

/* The state beside model_memory: its bytes in use, a copy of them, and that copy back (after model_update). */
size_t model_beside(const model *m);
void model_save_beside(const model *m, void *to);
void model_restore_beside(model *m, const void *from);
/* Whether `size` bytes, aligned as a double, are such a copy. */
int model_is_beside(const model_data *data, const void *saved, size_t size);

/* The next message about an assumption that does not hold and has not been announced yet: 1, or 0 if there is none. */
int model_announce(model *m, char *text, size_t room);

/* Model Exchange. Not on a target that vibrates or has a static stiffness, and not of viscoelastic bodies. */
int model_has_exchange(const model_data *data);
int model_state_count(const model_data *data);
int model_is_state(const model *m, unsigned reference);
int model_set_state(model *m, unsigned reference, double value);
int model_rates(model *m, double rates[STATES]);
int model_indicators(model *m, double indicators[FILM_INDICATORS]);
int model_apply_events(model *m);    /* all events that are due */
void model_accept_states(model *m);  /* states and inputs belong to the solution: the integrator step was accepted; then
                                        model_has_unreported tells of a new phase of sliding */

#endif
