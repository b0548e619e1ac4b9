/* Friction: the motion along the surface, in the units of film_slide.h. See model.h. */
#include "model_parts.h"

#include <stdlib.h>

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

double sliding_output(const model *m, unsigned reference) {
    const model_memory *now = &m->memory;
    const film_sliding *s = &now->sliding;
    double impulse = s->impulse * now->force * now->time_scale;
    switch (reference) {
    case SLIDING_VELOCITY: return s->springs.v * velocity_unit(m);
    case TANGENTIAL_VELOCITY: return now->value[INITIAL_TANGENTIAL_VELOCITY] + (now->pushed - impulse) / now->value[MASS];
    case SPIN: return now->value[INITIAL_SPIN] + (now->turned - m->data->friction.lever * impulse) / inertia_of(m);
    case FRICTION_FORCE: return s->springs.q * now->force;
    case TANGENTIAL_IMPULSE: return impulse;
    case SLIDING: return s->watch.phase + 1;
    case SLIDING_EVENT_COUNT: return now->sliding_events;
    case LAST_SLIDING_EVENT: return now->sliding_event;
    case TIME_OF_LAST_SLIDING_EVENT: return now->sliding_time;
    default: return (s->work - film_springs_energy(&s->springs)) * now->force * velocity_unit(m) * now->time_scale;
    }
}
