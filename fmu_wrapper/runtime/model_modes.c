/* The impact on a target that vibrates, by the core's contact on modes. See model.h. */
#include "model_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

size_t model_modal_size(const model_data *data) {
    return data->modes.count > 0 ? sizeof(film_modal) + 4 * sizeof(double) * (size_t)data->modes.count : 0;
}

static double *waves_of(const model *m) { return (double *)(m->modal + 1); }

/* The numbers of the modes, which end the data. */
static const double *numbers_of(const model_data *data) {
    return (const double *)((const unsigned char *)data + data->size) - 3 * (size_t)data->modes.count;
}

/* The longest step [s] for the parameters: that of the export times the power of 2 nearest to the ratio of the scales of time. */
static double longest_step(const model *m) {
    const model_data *data = m->data;
    double usual = sqrt(data->start[MASS] * data->length_scale / data->force_scale);
    int power;
    double part = frexp(m->memory.time_scale / usual, &power); /* 0.5 .. 1 */
    return ldexp(data->modes.longest, part * part < 0.5 ? power - 1 : power);
}

int model_update_modes(model *m) {
    const model_modes *modes = &m->data->modes;
    size_t count = (size_t)modes->count;
    const double *numbers = numbers_of(m->data);
    if (!vibrates(m) || !(m->memory.time_scale > 0.0)) return 0; /* the latter before initialization */
    double longest = longest_step(m);
    if (m->modal && m->structure.longest == longest) return 0;
    if (!m->tables) m->tables = malloc(film_structure_size(modes->count, modes->levels) * sizeof *m->tables);
    if (!m->modal) m->modal = calloc(1, model_modal_size(m->data));
    if (!m->sensed) m->sensed = calloc((size_t)(SENSED * modes->sensors + 1), sizeof *m->sensed);
    if (!m->tables || !m->modal || !m->sensed) return model_error(m, "no memory for %d natural vibrations", (int)modes->count);
    int status = film_structure_init(&m->structure, modes->count, numbers, numbers + count, numbers + 2 * count, longest,
                                     modes->levels, m->tables);
    return status < 0 ? model_core_error(m, status) : 0;
}

static void show_all(model *m) {
    model_memory *now = &m->memory;
    double values[5];
    now->unsummed = 0;
    film_modal_motion(&m->structure, m->curve, m->modal, waves_of(m), values);
    memcpy(&now->state, &m->modal->contact, sizeof now->state);
    now->state.time = m->modal->time + m->modal->tau;
    now->state.xi = values[0];
    now->state.force = values[2];
    now->state.nu = values[3];
    now->state.shift = values[4];
    now->state.spent = film_modal_work(m->modal, values[2]);
    now->recoil = values[3] - values[1];
}

/* The motion now into the state that outputs and events are made from. Between contacts xi is the impactor's displacement, with no
 * shift or recoil, until modes_sum adds up the modes. */
static void show(model *m) {
    model_memory *now = &m->memory;
    double x, nu;
    m->sensed_known = 0;
    if (!film_modal_jumps(m->modal, &x, &nu)) {
        show_all(m);
        return;
    }
    memcpy(&now->state, &m->modal->contact, sizeof now->state);
    now->state.time = m->modal->time + m->modal->tau;
    now->state.xi = x;
    now->state.nu = nu;
    now->state.force = now->state.shift = now->recoil = 0.0;
    now->state.spent = film_modal_work(m->modal, 0.0);
    now->unsummed = 1;
}

void modes_sum(model *m) {
    if (m->memory.unsummed) show_all(m);
}

int model_is_sensed(const model *m, unsigned reference) {
    return vibrates(m) && reference >= VARIABLES && reference - VARIABLES < (unsigned)(SENSED * m->data->modes.sensors);
}

const char *model_name(const model *m, unsigned reference) {
    return model_is_sensed(m, reference) ? "the motion of a sensor" : reference < VARIABLES ? VARIABLE[reference].name : "the unknown";
}

double modes_sensed(model *m, unsigned reference) {
    const model_memory *now = &m->memory;
    const model_modes *modes = &m->data->modes;
    unsigned at = reference - VARIABLES;
    const double of_support[SENSED] = {now->support_displacement, now->value[SUPPORT_VELOCITY], 0.0};
    if (!m->sensed_known) {
        const double *weights = numbers_of(m->data) - (size_t)modes->sensors * (size_t)modes->count;
        film_modal_sensed(&m->structure, m->modal, waves_of(m), modes->sensors, weights, m->sensed);
        m->sensed_known = 1;
    }
    return m->sensed[at] * now->length + of_support[at % SENSED];
}

void modes_renew_work(model *m) { m->modal->steps = 0; }

int modes_begin(model *m, const film_modal_start *start, double xi) {
    int status = film_modal_init(&m->structure, m->curve, m->modal, waves_of(m), start, xi);
    if (status == FILM_OK) show(m);
    return status;
}

int modes_input(model *m, double load, double nu_change, double stop_velocity) {
    int status = film_modal_input(&m->structure, m->curve, m->modal, waves_of(m), load, nu_change, stop_velocity);
    if (status == FILM_OK) show(m);
    return status;
}

int modes_step(model *m, double dt) {
    film_structure *structure = &m->structure;
    int status = slides(m) ? film_slide_on_modes(structure, m->curve, m->modal, waves_of(m), dt, m->friction, m->data->friction.rows,
                                                 &m->memory.sliding)
                           : film_modal_step(structure, m->curve, m->modal, waves_of(m), dt);
    if (status >= 0) show(m);
    return status;
}
