/* What is saved beside model_memory: the state of a vibrating target, or of viscoelastic bodies with its steps; and the impact of
 * such bodies, by the core's relaxing contact. See model.h. */
#include "model_parts.h"

#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------- saved states */

static size_t relaxing_size(int32_t steps) { return sizeof(film_relax) + (size_t)steps * sizeof(film_relax_step); }

size_t model_beside(const model *m) {
    return relaxes(m) ? relaxing_size(m->relax ? m->relax->steps : 0) : model_modal_size(m->data);
}

void model_save_beside(const model *m, void *to) {
    const void *from = relaxes(m) ? (const void *)m->relax : (const void *)m->modal;
    if (from) memcpy(to, from, model_beside(m));
}

void model_restore_beside(model *m, const void *from) {
    if (m->relax) memcpy(m->relax, from, relaxing_size(((const film_relax *)from)->steps));
    if (m->modal) memcpy(m->modal, from, model_modal_size(m->data));
    m->sensed_known = 0;
}

int model_is_beside(const model_data *data, const void *saved, size_t size) {
    const film_relax *state = saved;
    if (!(data->relaxation.tolerance > 0.0)) return size == model_modal_size(data);
    return size >= sizeof *state && state->steps >= 0 && state->steps <= FILM_RELAX_STEPS && size == relaxing_size(state->steps);
}

/* ---------------------------------------------------------------- viscoelastic bodies */

static film_relax_step *steps_of(const model *m) { return (film_relax_step *)(m->relax + 1); }

int model_update_relaxing(model *m) {
    if (!relaxes(m) || m->relax) return 0;
    m->relax = calloc(1, relaxing_size(FILM_RELAX_STEPS));
    return m->relax ? 0 : model_error(m, "no memory for the steps of a viscoelastic contact");
}

/* The motion now into the state that outputs and events are made from; nothing is left of the indentation in the end. */
static void show(model *m) {
    film_state *shown = &m->memory.state;
    const film_relax *s = m->relax;
    double values[5];
    film_relax_motion(s, steps_of(m), values);
    shown->time = s->time + s->tau;
    shown->xi = values[0];
    shown->force = values[2];
    shown->nu = values[3];
    shown->shift = values[4];
    shown->spent = film_relax_spent(s, steps_of(m));
    shown->force_peak = s->peak;
    shown->branch = s->branch;
    shown->phase = s->phase;
    shown->event = s->event;
    shown->contacts = s->contacts;
}

int relaxing_begin(model *m, const film_start *start, double xi) {
    film_relaxation law = m->data->relaxation.law;
    for (int32_t k = 0; k < law.terms; k++) law.rate[k] *= m->memory.time_scale;
    int status = film_relax_init(m->relax, &law, start, m->data->relaxation.tolerance, xi);
    if (status == FILM_OK) show(m);
    return status;
}

int relaxing_input(model *m, double load, double nu_change, double stop_velocity) {
    int status = film_relax_input(m->relax, steps_of(m), load, nu_change, stop_velocity);
    if (status == FILM_OK) show(m);
    return status;
}

int relaxing_step(model *m, double dt) {
    int status = film_relax_advance(m->relax, steps_of(m), dt);
    m->memory.state.time = m->relax->time + m->relax->tau; /* of a failure, too */
    if (status >= 0) show(m);
    return status;
}
