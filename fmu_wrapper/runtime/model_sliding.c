/* Friction: the motion along the surface, in the units of film_slide.h. See model.h. */
#include "model_parts.h"

#include <stdlib.h>
#include <string.h>

/* Of differences, where what slips slips on: a moment over the unit of time ahead; the step over the size of a state. */
static const double AHEAD = 1e-4, STEP = 1e-6;

static double velocity_unit(const model *m) { return m->data->friction.ratio * m->memory.velocity; }

static double inertia_of(const model *m) {
    const model_friction *own = &m->data->friction;
    return own->inertia * m->memory.value[MASS] * own->lever * own->lever;
}

const double *model_friction_table(const model_data *data) {
    size_t modes = (size_t)(data->modes.count > 0 ? (data->modes.sensors + 3) * data->modes.count : 0);
    return (const double *)((const unsigned char *)data + data->size) - modes - 2 * (size_t)data->friction.rows;
}

int model_update_friction(model *m) {
    size_t rows = (size_t)m->data->friction.rows;
    const double *pair = model_friction_table(m->data);
    if (rows == 0) return 0;
    if (!m->friction) m->friction = malloc(2 * rows * sizeof *m->friction);
    if (!m->friction) return model_error(m, "no memory for the table of friction");
    for (double *to = m->friction; to < m->friction + 2 * rows; to += 2, pair += 2) to[0] = pair[0] / velocity_unit(m), to[1] = pair[1];
    return 0;
}

int sliding_begin(model *m) {
    model_memory *now = &m->memory;
    const model_friction *own = &m->data->friction;
    const double *value = now->value;
    now->tangential_support = value[TANGENTIAL_SUPPORT_VELOCITY];
    now->pushed = now->turned = now->sliding_time = 0.0;
    now->sliding_event = now->sliding_events = 0;
    memset(&now->accepted, 0, sizeof now->accepted);
    now->states[3] = now->states[6] = 0.0;
    now->states[4] = value[INITIAL_TANGENTIAL_VELOCITY], now->states[5] = value[INITIAL_SPIN];
    double velocity = value[INITIAL_TANGENTIAL_VELOCITY] + own->lever * value[INITIAL_SPIN] - now->tangential_support;
    double mass = own->ratio / (1.0 + 1.0 / own->inertia);
    int status = film_slide_init(&now->sliding, m->curve, value[FRICTION], mass, velocity / velocity_unit(m));
    if (status < 0) return model_core_error(m, status);
    sliding_input(m);
    return 0;
}

void sliding_input(model *m) {
    model_memory *now = &m->memory;
    const double *value = now->value;
    double rate = value[TANGENTIAL_FORCE] / value[MASS] + value[TORQUE] * m->data->friction.lever / inertia_of(m);
    now->sliding.springs.friction = value[FRICTION];
    now->sliding.springs.v -= (value[TANGENTIAL_SUPPORT_VELOCITY] - now->tangential_support) / velocity_unit(m);
    now->sliding.springs.push = rate * now->time_scale / velocity_unit(m);
    now->tangential_support = value[TANGENTIAL_SUPPORT_VELOCITY];
}

int sliding_follow(model *m, const film_state *from) {
    model_memory *now = &m->memory;
    double time = now->state.time - from->time;
    now->pushed += now->value[TANGENTIAL_FORCE] * time * clock_of(m);
    now->turned += now->value[TORQUE] * time * clock_of(m);
    int status = vibrates(m) ? FILM_OK
                             : film_slide(m->curve, &m->mesh, from, &now->state, m->friction, m->data->friction.rows, &now->sliding);
    const film_watch *watch = &now->sliding.watch;
    if (watch->events == 0) return status;
    now->sliding_events += watch->events;
    now->sliding_event = watch->kinds[watch->events - 1] + 1; /* 0 is free */
    now->sliding_time = now->start_time + from->time * clock_of(m) + watch->begins[watch->events - 1] * now->time_scale;
    return status;
}

/* In Model Exchange, the point of now: on the present branch of the normal motion. */
static film_slide_point point_of(const model *m) {
    const model_memory *now = &m->memory;
    const double *x = now->states, *value = now->value, lever = m->data->friction.lever;
    film_slide_point at = {.time = (now->time - now->start_time) / now->time_scale, .xi = x[0] / now->length};
    at.nu = (x[1] - value[SUPPORT_VELOCITY]) / now->velocity;
    at.rate = at.nu - now->state.gamma * film_force(m->curve, &now->state, at.xi, at.nu).force;
    at.displacement = x[3] / (m->data->friction.ratio * now->length);
    at.velocity = (x[4] + lever * x[5] - value[TANGENTIAL_SUPPORT_VELOCITY]) / velocity_unit(m);
    return at;
}

/* Springs from the accepted point to that of now. */
static void slide_on(const model *m, film_sliding *sliding, const film_slide_point *to) {
    sliding->springs.friction = m->memory.value[FRICTION];
    film_slide_along(m->curve, &m->memory.state, &m->memory.accepted, to, m->friction, m->data->friction.rows, sliding);
}

void sliding_accept(model *m) {
    model_memory *now = &m->memory;
    const film_watch *watch = &now->sliding.watch;
    double *value = now->actual.value, since = now->start_time + now->accepted.time * now->time_scale;
    film_slide_point to = point_of(m);
    slide_on(m, &now->sliding, &to);
    now->accepted = to;
    value[SLIDING - SETTABLE] = watch->phase + 1;
    if (watch->events == 0) return;
    value[SLIDING_EVENT_COUNT - SETTABLE] += watch->events;
    value[LAST_SLIDING_EVENT - SETTABLE] = watch->kinds[watch->events - 1] + 1;
    value[TIME_OF_LAST_SLIDING_EVENT - SETTABLE] = since + watch->begins[watch->events - 1] * now->time_scale;
}

static double force_of(const model *m, const film_sliding *s) { return s->springs.q * m->memory.force; }

static double work_of(const model *m, const film_sliding *s) {
    return (s->work - film_springs_energy(&s->springs)) * m->memory.force * velocity_unit(m) * m->memory.time_scale;
}

/* Outputs that are functions of the springs. */
static double output_of_springs(const model *m, unsigned reference, const film_sliding *s) {
    const double *value = m->memory.value;
    switch (reference) {
    case FRICTION_FORCE: return force_of(m, s);
    case FRICTION_WORK: return work_of(m, s);
    case RATE_OF_TANGENTIAL_VELOCITY: return (value[TANGENTIAL_FORCE] - force_of(m, s)) / value[MASS];
    default: return (value[TORQUE] - m->data->friction.lever * force_of(m, s)) / inertia_of(m);
    }
}

static double exchanged(const model *m, unsigned reference) {
    const model_memory *now = &m->memory;
    film_slide_point at = point_of(m);
    film_sliding ahead;
    switch (reference) {
    case SLIDING_DISPLACEMENT: return now->states[3];
    case SLIDING_VELOCITY: return at.velocity * velocity_unit(m);
    case TANGENTIAL_VELOCITY: return now->states[4];
    case SPIN: return now->states[5];
    case TANGENTIAL_IMPULSE: return now->states[6];
    case SLIDING:
    case SLIDING_EVENT_COUNT:
    case LAST_SLIDING_EVENT:
    case TIME_OF_LAST_SLIDING_EVENT: return now->reported.value[reference - SETTABLE];
    default: break;
    }
    memcpy(&ahead, &now->sliding, sizeof ahead);
    slide_on(m, &ahead, &at);
    return output_of_springs(m, reference, &ahead);
}

double sliding_output(const model *m, unsigned reference) {
    const model_memory *now = &m->memory;
    const film_sliding *s = &now->sliding;
    double impulse = s->impulse * now->force * now->time_scale;
    if (now->importer_integrates) return exchanged(m, reference);
    switch (reference) {
    case SLIDING_DISPLACEMENT: return s->displacement * velocity_unit(m) * now->time_scale;
    case SLIDING_VELOCITY: return s->springs.v * velocity_unit(m) - (now->value[TANGENTIAL_SUPPORT_VELOCITY] - now->tangential_support);
    case TANGENTIAL_VELOCITY: return now->value[INITIAL_TANGENTIAL_VELOCITY] + (now->pushed - impulse) / now->value[MASS];
    case SPIN: return now->value[INITIAL_SPIN] + (now->turned - m->data->friction.lever * impulse) / inertia_of(m);
    case TANGENTIAL_IMPULSE: return impulse;
    case SLIDING: return s->watch.phase + 1;
    case SLIDING_EVENT_COUNT: return now->sliding_events;
    case LAST_SLIDING_EVENT: return now->sliding_event;
    case TIME_OF_LAST_SLIDING_EVENT: return now->sliding_time;
    default: return output_of_springs(m, reference, s);
    }
}

void sliding_rescale(model *m, double time_scale, double velocity) {
    film_slide_point *at = &m->memory.accepted;
    at->time *= time_scale / m->memory.time_scale;
    at->rate *= velocity / m->memory.velocity;
    at->nu *= velocity / m->memory.velocity;
    at->velocity *= velocity / m->memory.velocity;
}

/* The difference of an output of springs by a state or input, of that size. In Co-Simulation the springs are where the motion is. */
static int difference(const model *m, unsigned unknown, unsigned known, double *slope) {
    model ahead = *m;
    model_memory *now = &ahead.memory;
    double rates[STATES], ends[2], size = m->data->speed, *value = known < SETTABLE ? &now->value[known] : NULL;
    for (int k = 0; k < STATES; k++) {
        if (!m->memory.importer_integrates && model_get(&ahead, model_state(k), &now->states[k]) < 0) return -1;
        if (known == model_state(k)) value = &now->states[k], size = m->data->nominal[k];
    }
    if (!m->memory.importer_integrates) now->importer_integrates = 1, now->accepted = point_of(&ahead);
    if (model_rates(&ahead, rates) < 0) return -1;
    for (int k = 0; k < STATES; k++) now->states[k] += AHEAD * now->time_scale * rates[k];
    now->time += AHEAD * now->time_scale;
    double at = *value;
    for (int side = 0; side < 2; side++) {
        *value = at + (side ? STEP : -STEP) * size;
        ends[side] = exchanged(&ahead, unknown);
    }
    *slope = (ends[1] - ends[0]) / (2.0 * STEP * size);
    return 0;
}

int sliding_partial(model *m, unsigned unknown, unsigned known, double *partial) {
    double mass = m->memory.value[MASS], lever = m->data->friction.lever;
    int direct = 1; /* not by the springs */
    switch (unknown) {
    case SLIDING_VELOCITY: *partial = known == SPIN ? lever : known == TANGENTIAL_SUPPORT_VELOCITY ? -1.0 : 1.0; break;
    case RATE_OF_TANGENTIAL_VELOCITY: *partial = 1.0 / mass, direct = known == TANGENTIAL_FORCE; break;
    case RATE_OF_SPIN: *partial = 1.0 / inertia_of(m), direct = known == TORQUE; break;
    default: *partial = 1.0, direct = unknown == known; break;
    }
    if (direct) return 0;
    if (!model_has_exchange(m->data)) { /* inputs do not change the springs at once */
        *partial = 0.0;
        return 0;
    }
    return difference(m, unknown, known, partial) < 0 ? model_not_finite(m, VARIABLE[unknown].name) : 0;
}
