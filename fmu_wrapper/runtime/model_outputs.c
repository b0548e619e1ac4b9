/* Outputs and their partial derivatives. See model.h. */
#include "model_parts.h"

#include <math.h>

typedef struct {
    double indentation, velocity, target; /* m, m/s, m */
    double force, stiffness, damping;     /* N; its derivatives with respect to indentation and velocity, N/m, N s/m */
    double recoil, share;                 /* velocity of a target without impedance, m/s; over that of the impactor on a spring */
} motion;

/* Indentation and deflection of the spring, whose sum is the march's xi. nu: of the impactor relative to the support. */
static void split_off_spring(const model *m, double nu, motion *out) {
    const model_memory *now = &m->memory;
    film_state unit = now->state;
    double values[5];
    unit.nu = 1.0;
    film_motion(m->curve, &unit, values);
    out->indentation = values[0] * now->length;
    out->target = values[4] * now->length + now->support_displacement;
    out->share = 1.0 - values[1];
    out->recoil = out->share * nu * now->velocity;
}

/* The motion at the current time. The derivatives are set if with_stiffness is not 0. */
static int compute_motion(model *m, motion *out, int with_stiffness) {
    const model_memory *now = &m->memory;
    const film_state *state = &now->state;
    film_contact at = {state->force, 0.0, 0.0};
    out->recoil = now->recoil * now->velocity;
    out->share = 0.0;
    if (m->data->kind == CONTACT && !now->importer_integrates) {
        film_state ahead = *state;
        if (contact_follow_path(m, &ahead, NULL) < 0) return -1;
        at = film_force(m->curve, &ahead, ahead.xi, now->rate / now->velocity);
        if (at.force < -film_pull(m->curve, &ahead)) at.force = at.by_xi = at.by_nu = 0.0; /* the event at zero force comes with the next step */
        out->indentation = now->indentation;
        out->velocity = now->value[RELATIVE_VELOCITY];
    } else if (now->importer_integrates) {
        int contact = m->data->kind == CONTACT;
        out->indentation = contact ? now->value[INDENTATION] : now->states[0];
        out->velocity = contact ? now->value[RELATIVE_VELOCITY] : now->states[1];
        out->target = now->states[2];
        double support = contact ? 0.0 : now->value[SUPPORT_VELOCITY];
        at = film_force(m->curve, state, out->indentation / now->length, (out->velocity - support) / now->velocity);
    } else {
        double change = (now->value[SUPPORT_VELOCITY] - now->support) / now->velocity; /* of the support, in the next step */
        if (relaxes(m)) with_stiffness = 0; /* inputs do not change a force of the past */
        if (with_stiffness || (change != 0.0 && damped(m))) {
            double rate = state->nu - now->recoil - change;
            at = vibrates(m) ? film_modal_force(m->curve, m->modal, state->xi, rate) : film_force(m->curve, state, state->xi, rate);
            if (change != 0.0 && at.force < -film_pull(m->curve, state)) at.force = at.by_xi = at.by_nu = 0.0; /* contact ends there */
        }
        out->indentation = state->xi * now->length;
        out->velocity = state->nu * now->velocity + now->support;
        out->target = state->shift * now->length + now->support_displacement;
        if (sprung(m)) split_off_spring(m, state->nu - change, out);
    }
    out->force = at.force * now->force;
    out->stiffness = at.by_xi * now->force / now->length;
    out->damping = at.by_nu * now->force / now->velocity;
    return 0;
}

static double mobility(const model *m) { /* 1/Z, m/(N s) */
    return m->memory.state.gamma * m->memory.velocity / m->memory.force;
}

/* Work done on the indentation, J: all of the march's but that on the spring. */
static double energy_of_contact(const model *m) {
    const film_state *state = &m->memory.state;
    double bent = 0.5 * m->curve->compliance * state->force * state->force;
    return (state->spent - bent) * m->memory.force * m->memory.length;
}

/* Outputs that are constant between events or steps. Returns 0 if the variable is another one. */
static int get_constant(const model *m, unsigned reference, double *value) {
    const model_memory *now = &m->memory;
    switch (reference) {
    case TIME: *value = now->time; return 1;
    case PHASE:
    case PHASE_CODE: *value = now->reported.phase; return 1;
    case STAGE: *value = now->reported.stage < FILM_FREE ? FILM_BRANCH : now->reported.stage; return 1;
    case CONTACT_COUNT: *value = now->reported.contacts; return 1;
    case EVENT_COUNT: *value = now->reported.events; return 1;
    case LAST_EVENT:
    case LAST_EVENT_CODE: *value = now->reported.last_event; return 1;
    case VALIDITY: *value = now->reported.validity; return 1;
    case MEAN_CONTACT_FORCE: *value = now->step_force; return 1;
    case CONTACT_IMPULSE: *value = now->impulse; return 1;
    case CONTACT_ENERGY: *value = energy_of_contact(m); return 1;
    case TARGET_ENERGY: *value = 0.0 - now->released - energy_of_contact(m); return 1;
    case EXTERNAL_WORK: *value = now->external; return 1;
    default: break;
    }
    if (VARIABLE[reference].changes < AT_EVENTS) return 0;
    *value = now->reported.value[reference - SETTABLE];
    return 1;
}

/* Whether an output is known without what the target does. */
static int of_impactor(unsigned reference) {
    return reference == IMPACTOR_VELOCITY || reference == IMPACTOR_DISPLACEMENT || reference == KINETIC_ENERGY ||
           reference == IMPACTOR_ACCELERATION || reference == CONTACT_FORCE;
}

static int get_motion(model *m, unsigned reference, double *value) {
    const model_memory *now = &m->memory;
    motion current;
    if (!of_impactor(reference)) modes_sum(m);
    if (compute_motion(m, &current, 0) < 0) return -1;
    double recoil = mobility(m) * current.force + current.recoil, mass = now->value[MASS];
    double target_velocity = now->value[SUPPORT_VELOCITY] + recoil;
    switch (reference) {
    case INDENTATION: *value = current.indentation; break;
    case RATE_OF_INDENTATION:
    case RELATIVE_VELOCITY: *value = current.velocity - target_velocity; break;
    case IMPACTOR_VELOCITY: *value = current.velocity; break;
    case IMPACTOR_DISPLACEMENT: *value = current.indentation + current.target; break;
    case TARGET_DISPLACEMENT: *value = current.target; break;
    case RATE_OF_TARGET_DISPLACEMENT:
    case TARGET_VELOCITY: *value = target_velocity; break;
    case RATE_OF_IMPACTOR_VELOCITY:
    case IMPACTOR_ACCELERATION: *value = now->value[GRAVITY] + (now->value[EXTERNAL_FORCE] - current.force) / mass; break;
    case KINETIC_ENERGY: *value = 0.5 * mass * current.velocity * current.velocity; break;
    default: *value = current.force; break;
    }
    return 0;
}

static int get_output(model *m, unsigned reference, double *value) {
    const model_memory *now = &m->memory;
    int sensed = model_is_sensed(m, reference);
    if (reference < SETTABLE && VARIABLE[reference].role[m->data->kind] != OUTPUT) {
        *value = now->value[reference];
        return 0;
    }
    if (!now->initialized && model_initialize(m, now->start_time) < 0) return -1;
    if (sensed) {
        *value = modes_sensed(m, reference);
        return 0;
    }
    if (model_of_friction(reference)) {
        *value = sliding_output(m, reference);
        return 0;
    }
    if (get_constant(m, reference, value)) return 0;
    if (reference - EVENT_INDICATOR_1 >= FILM_INDICATORS) return get_motion(m, reference, value);
    double indicators[FILM_INDICATORS];
    if (model_indicators(m, indicators) < 0) return -1;
    *value = indicators[reference - EVENT_INDICATOR_1];
    return 0;
}

/* Variables of Model Exchange only. */
static int is_exchanged(unsigned reference) { return reference < VARIABLES && VARIABLE[reference].changes == IN_MODEL_EXCHANGE; }

int model_has(const model *m, unsigned reference) {
    if (model_is_sensed(m, reference)) return 1;
    return reference < VARIABLES && VARIABLE[reference].role[m->data->kind] != ABSENT &&
           (reference >= SETTABLE || m->data->available[reference]) && (slides(m) || !model_of_friction(reference)) &&
           (model_has_exchange(m->data) || !is_exchanged(reference));
}

int model_get(model *m, unsigned reference, double *value) {
    *value = 0.0;
    if (!model_has(m, reference))
        return model_error(m, "this FMU has no variable with value reference %u", reference);
    if (get_output(m, reference, value) < 0) return -1;
    return isfinite(*value) ? 0 : model_not_finite(m, model_name(m, reference));
}

int model_is_parameter(const model *m, unsigned reference) {
    return reference < VARIABLES && model_has(m, reference) && VARIABLE[reference].role[m->data->kind] == PARAMETER;
}

int model_depends(const model *m, unsigned unknown, unsigned known) {
    int exchange = model_has_exchange(m->data);
    if (model_is_sensed(m, unknown)) return (unknown - VARIABLES) % SENSED == 1 && known == SUPPORT_VELOCITY; /* the velocity */
    if (!exchange && is_exchanged(unknown)) return -1;
    if (model_of_friction(unknown) && !slides(m)) return -1;
    if (!exchange && model_is_state(m, known)) return model_depends(m, unknown, TIME); /* they are no states there */
    int impact = m->data->kind == IMPACT;
    if (model_is_parameter(m, known) && !vibrates(m) && model_depends(m, unknown, TIME) >= 0)
        return (impact || unknown == CONTACT_FORCE) && unknown != MEAN_CONTACT_FORCE;
    const film_variable *of = &VARIABLE[unknown];
    unsigned by = of->by[m->data->kind] | (damped(m) ? of->by_if_damped[m->data->kind] : 0u), place = known - EXTERNAL_FORCE;
    if (of->by[m->data->kind] == 0u) return model_is_discrete(unknown) ? 0 : -1;
    return place <= TANGENTIAL_IMPULSE - EXTERNAL_FORCE && (by & BY(known)) != 0u;
}

int model_partial(model *m, unsigned unknown, unsigned known, double *partial) {
    motion current;
    *partial = 0.0;
    int sensed = model_is_sensed(m, unknown);
    if (!sensed && (unknown >= VARIABLES || VARIABLE[unknown].role[m->data->kind] != OUTPUT || model_depends(m, unknown, known) < 0))
        return model_error(m, "%s is not a real output", model_name(m, unknown));
    int state = model_is_state(m, known) && model_has_exchange(m->data);
    if (known >= VARIABLES || (VARIABLE[known].role[m->data->kind] != INPUT && !state))
        return model_error(m, "%s is neither an input, a state nor a parameter", known < VARIABLES ? VARIABLE[known].name : "the known");
    if (!m->memory.initialized && model_initialize(m, m->memory.start_time) < 0) return -1;
    if (!model_depends(m, unknown, known)) return 0;
    *partial = 1.0;
    if (sensed) return 0;
    if (model_of_friction(unknown)) return sliding_partial(m, unknown, known, partial);
    modes_sum(m);
    if (compute_motion(m, &current, 1) < 0) return -1;
    double mass = m->memory.value[MASS], force = 0.0;
    if (known == INDENTATION) force = current.stiffness;
    if (known == IMPACTOR_VELOCITY || known == RELATIVE_VELOCITY) force = current.damping;
    if (known == SUPPORT_VELOCITY) force = -current.damping;
    switch (unknown) {
    case CONTACT_FORCE: *partial = force; break;
    case RATE_OF_INDENTATION:
    case RELATIVE_VELOCITY:
        *partial = (known == SUPPORT_VELOCITY ? -1.0 : known == IMPACTOR_VELOCITY ? 1.0 : 0.0) * (1.0 - current.share) -
                   force * mobility(m);
        break;
    case RATE_OF_TARGET_DISPLACEMENT:
    case TARGET_VELOCITY:
        *partial = (known == SUPPORT_VELOCITY ? 1.0 - current.share : 0.0) + force * mobility(m);
        break;
    case RATE_OF_IMPACTOR_VELOCITY:
    case IMPACTOR_ACCELERATION: *partial = ((known == EXTERNAL_FORCE ? 1.0 : 0.0) - force) / mass; break;
    case KINETIC_ENERGY: *partial = mass * current.velocity; break;
    default: break;
    }
    return isfinite(*partial) ? 0 : model_not_finite(m, VARIABLE[unknown].name);
}
