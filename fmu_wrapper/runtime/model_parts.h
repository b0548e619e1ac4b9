/* Functions that the files of the model share. */
#ifndef FILM_MODEL_PARTS_H
#define FILM_MODEL_PARTS_H

#include "model.h"

static const double SLOWEST = 1e-300; /* of the velocity scale: a velocity of which only the direction matters */
enum { MAX_SWITCHES = 1000 };         /* events at one time; more than this is an endless loop */

/* These three write m->message and return -1. */
int model_error(model *m, const char *format, ...);
int model_core_error(model *m, int status);
int model_not_finite(model *m, const char *name);

/* Whether this FMU has the variable; whether it is a discrete output that is a real number. */
int model_has(const model *m, unsigned reference);
int model_is_discrete(unsigned reference);

/* Partial derivative of an output with respect to an input or state. */
int model_partial(model *m, unsigned unknown, unsigned known, double *partial);

/* The variable that is a state. */
unsigned model_state(int k);

/* The indentation in a state, over the length scale, without the deflection of a static stiffness. */
double model_indentation(const model *m, const film_state *state);

/* scale * prod (p/start)^power, p the first `powers` parameters that scale the march. */
double model_scaled(const model *m, double scale, const double *power, int powers);

/* Validity: of the parameters but the initial velocity; of the relative velocity at a first touch, m/s; and of an
 * indentation that was reached, m. */
int model_validity_of_parameters(const model *m);
void model_judge_touch(const model *m, double speed, model_record *record);
int model_validity_at(const model *m, double indentation);

/* A vibrating target: its start, new inputs, and a step as film_step; the last two return the core's status. */
int modes_begin(model *m, const film_modal_start *start, double xi);
int modes_input(model *m, double load, double nu_change, double stop_velocity);
int modes_step(model *m, double dt);
double modes_sensed(model *m, unsigned reference); /* of a sensor, SI */
void modes_sum(model *m); /* before the motion of the target is read */
void modes_renew_work(model *m); /* at the beginning of a communication step: its work is limited */

/* Viscoelastic bodies, likewise. */
int relaxing_begin(model *m, const film_start *start, double xi);
int relaxing_input(model *m, double load, double nu_change, double stop_velocity);
int relaxing_step(model *m, double dt);

/* What model_update makes: the curve of the law for the parameters, in m->curve; tables and state of a vibrating target; state
 * and steps of viscoelastic bodies; the table of friction in its units. */
int model_update_curve(model *m);
int model_update_modes(model *m);
int model_update_relaxing(model *m);
int model_update_friction(model *m);
size_t model_modal_size(const model_data *data);

static inline int vibrates(const model *m) { return m->data->kind == IMPACT && m->data->modes.count > 0; }
static inline int relaxes(const model *m) { return m->data->relaxation.tolerance > 0.0; }

/* Whether the target follows the contact force by its static stiffness: the march is that of a contact in series with a spring. */
static inline int sprung(const model *m) { return m->data->kind == IMPACT && m->data->available[TARGET_STIFFNESS]; }

/* Friction: at the start, with new inputs, and beside the motion from a state to that of now, of which only the latter may be at
 * an event (on a vibrating target modes_step has done that); the last returns the core's status. sliding_accept: in Model Exchange, the
 * springs follow to the states and inputs of now; sliding_rescale: after the scales were these; sliding_partial: as model_partial.
 * model_of_friction: whether an output is one of friction, and its value. */
int sliding_begin(model *m);
void sliding_input(model *m);
int sliding_follow(model *m, const film_state *from);
void sliding_accept(model *m);
void sliding_rescale(model *m, double time_scale, double velocity);
int sliding_partial(model *m, unsigned unknown, unsigned known, double *partial);
static inline int model_of_friction(unsigned reference) {
    return (reference >= SLIDING_DISPLACEMENT && reference <= TIME_OF_LAST_SLIDING_EVENT) ||
           reference == RATE_OF_TANGENTIAL_VELOCITY || reference == RATE_OF_SPIN;
}
double sliding_output(const model *m, unsigned reference);
static inline int slides(const model *m) { return m->data->kind == IMPACT && m->data->available[TORQUE]; }

/* The unit of state.time, s. */
static inline double clock_of(const model *m) { return vibrates(m) ? 1.0 : m->memory.time_scale; }

/* Whether the contact remembers the parameters that it began with: by springs of friction, off the law's own stages, or apart from a
 * dent. */
static inline int model_remembers(const model *m) {
    const film_state *state = &m->memory.state;
    int apart = state->branch == FILM_FREE ? state->xi_free != 0.0 : state->branch < 0;
    return apart || (slides(m) && m->memory.sliding.springs.radius > 0.0);
}

static inline int damped(const model *m) { return m->data->curve.stage[0].damped; }

/* Weight and external force on the impactor, over the force scale. */
static inline double load_of(const model *m) {
    const double *value = m->memory.value;
    return (value[MASS] * value[GRAVITY] + value[EXTERNAL_FORCE]) / m->memory.force;
}

/* The damping after a change of parameters, from the next contact on: now or, in a contact, not yet. */
int model_follow_tuning(model *m);

/* Write the event that `state` reports into a record. time: s; velocity: of the impactor, m/s. */
void model_record_event(const model *m, const film_state *state, double time, double velocity, model_record *record);

/* Write the contact radius, dent, pressures and stresses that follow from a record's largest force and indentation. */
void model_record_stresses(const model *m, model_record *record);

/* Contact alone. Move `state` along the indentation from the last accepted point to the current one, with all events on
 * the way; record may be NULL. */
int contact_follow_path(model *m, film_state *state, model_record *record);
/* Make the current indentation the last accepted point. */
int contact_accept_input(model *m);
int contact_step(model *m, double end);

#endif
