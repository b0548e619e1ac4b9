/* Derivatives of outputs by parameters: finite differences of fourth order. See model.h.
 *
 * In Initialization Mode: of all outputs, at the start. In Co-Simulation: of the discrete outputs. Each impact of a stencil is
 * marched from the start, with the inputs of the start, to the event that the outputs show now and to the time now. With
 * the same numbers of segments the results are smooth to rounding, so that the differences are exact to about 1e-10. */
#include "model_parts.h"

#include <math.h>
#include <string.h>

enum { POINTS = 5, OTHER_EVENTS = 1 };

/* Step over the parameter, as in film_model/solve/slopes.py. */
static const double STEP = 1e-3;

/* Fourth difference over the largest value of a stencil: h^4 f'''' of a smooth value, and up to 2 h times the jump of its slope
 * at a kink, which then moves the derivative by less than 1e-6 of value over parameter. Needed by
 * test_by_parameters_of_what_an_impact_left: in Stronge's law, at a time that is just that of an event. */
static const double KINK = 1e-9;

/* Points at first, first + 1, ... steps from the value; side: sign of the step. */
typedef struct {
    int first, side;
    double weight[POINTS];
} stencil;

static const stencil STENCIL[] = {
    {-2, 1, {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0}},
    {0, -1, {-25.0 / 12.0, 48.0 / 12.0, -36.0 / 12.0, 16.0 / 12.0, -3.0 / 12.0}},
    {0, 1, {-25.0 / 12.0, 48.0 / 12.0, -36.0 / 12.0, 16.0 / 12.0, -3.0 / 12.0}},
}; /* in the order in which they are tried, the others where one leaves the range of the parameter */

static const double FOURTH[POINTS] = {1.0, -4.0, 6.0, -4.0, 1.0};

int model_is_discrete(unsigned reference) {
    return reference < VARIABLES && VARIABLE[reference].changes >= AT_STEPS;
}

static int is_unknown(const model *m, unsigned reference, int initial) {
    return reference - EVENT_INDICATOR_1 >= FILM_INDICATORS && reference != TIME && VARIABLE[reference].role[m->data->kind] == OUTPUT &&
           VARIABLE[reference].type == REAL &&
           (initial ? model_has(m, reference) : model_is_discrete(reference) && reference != MEAN_CONTACT_FORCE && !model_of_friction(reference));
}

/* ---------------------------------------------------------------- the impacts of a stencil */

static int at_start(model *m, double values[VARIABLES]) {
    if (model_initialize(m, m->memory.start_time) < 0) return -1;
    for (unsigned k = 0; k < VARIABLES; k++)
        if (is_unknown(m, k, 1) && model_get(m, k, &values[k]) < 0) return -1;
    return 0;
}

/* March to a time, or to the event number `events`; copy the record of that event. Returns OTHER_EVENTS if there are many more. */
static int march(model *m, double end, int to_event, int32_t events, model_record *record) {
    const model_record *now = &m->memory.actual;
    int stopped = 1;
    while (stopped) {
        if (model_step(m, end, 1, &stopped) < 0) return -1;
        if (stopped && now->events == events) memcpy(record, now, sizeof *record);
        if (to_event && now->events >= events) return 0;
        if (now->events > events + MAX_SWITCHES) return OTHER_EVENTS;
    }
    return 0;
}

/* The discrete outputs when the impact `of` has the parameters of m. Returns OTHER_EVENTS if its events then differ. */
static int as_marched(model *m, const model *of, double values[VARIABLES]) {
    const model_memory *then = &of->memory;
    model_record record;
    int32_t events = then->reported.events;
    if (model_initialize(m, then->start_time) < 0) return -1;
    memcpy(&record, &m->memory.actual, sizeof record);
    int status = march(m, then->time, 0, events, &record);
    for (unsigned k = SETTABLE; k < VARIABLES; k++)
        if (VARIABLE[k].changes == AT_STEPS && k != MEAN_CONTACT_FORCE && !model_of_friction(k) && model_get(m, k, &values[k]) < 0) return -1;
    if (status == 0 && m->memory.actual.events < events)
        status = march(m, 2.0 * then->time - then->start_time, 1, events, &record);
    if (status != 0) return status;
    for (unsigned k = SETTABLE; k < VARIABLES; k++)
        if (VARIABLE[k].changes >= AT_EVENTS) values[k] = record.value[k - SETTABLE];
    const model_record *shown = &then->reported;
    return record.events != events || record.last_event != shown->last_event || record.contacts != shown->contacts ||
                   record.had != shown->had ? OTHER_EVENTS : 0;
}

/* ---------------------------------------------------------------- differences */

/* Step of a stencil: of a value that may be 0, over its size in the impact that was exported. */
static double step_by(const model *m, unsigned known) {
    const double *value = m->memory.value;
    double length = m->data->nominal[0], speed = m->data->speed;
    if (known == EXPONENT) return 0.1 * STEP; /* a force K x^q changes with q by ln x, x the indentation in m */
    if (value[known] != 0.0) return STEP * fabs(value[known]);
    if (known == INITIAL_VELOCITY) return STEP * speed;
    if (known == INITIAL_GAP) return STEP * length;
    return STEP * (known == GRAVITY ? speed * speed / (length + value[INITIAL_GAP]) : 1.0);
}

static int differences(model *moved, const model *m, unsigned known, int initial, const stencil *at, model_slopes *slopes) {
    double values[POINTS][VARIABLES] = {{0.0}}, h = at->side * step_by(m, known), point[POINTS];
    for (int k = 0; k < POINTS; k++) {
        double value = m->memory.value[known] + h * (at->first + k);
        memcpy(moved->memory.value, m->memory.value, sizeof moved->memory.value);
        if (!initial) memcpy(&moved->memory.value[EXTERNAL_FORCE], m->memory.first_inputs, sizeof m->memory.first_inputs);
        moved->memory.start_time = m->memory.start_time;
        if (model_set(moved, known, value) < 0) return -1;
        int status = initial ? at_start(moved, values[k]) : as_marched(moved, m, values[k]);
        if (status != 0) return status;
        point[k] = value;
    }
    double step = (point[POINTS - 1] - point[0]) / (POINTS - 1), impulse = values[0][CONTACT_IMPULSE];
    double energy = 0.125 * impulse * impulse / m->memory.value[MASS]; /* that rounding of differences is relative to */
    for (unsigned n = 0; n < VARIABLES; n++) {
        double sum = 0.0, fourth = 0.0, size = n >= CONTACT_ENERGY && n <= EXTERNAL_WORK ? energy : 0.0;
        for (int k = 0; k < POINTS; k++) {
            sum += at->weight[k] * values[k][n];
            fourth += FOURTH[k] * values[k][n];
            size = fmax(size, fabs(values[k][n]));
        }
        slopes->value[n] = sum / step;
        slopes->kinked[n] = !(fabs(fourth) <= KINK * size);
    }
    return 0;
}

/* Why there are no derivatives by parameters now, or NULL. */
static const char *refusal(const model *m) {
    if (m->data->kind == CONTACT || m->memory.importer_integrates)
        return "it is known in Initialization Mode, and of an impact in Co-Simulation";
    if (vibrates(m)) return "on a target that vibrates it is known in Initialization Mode only";
    return m->memory.varied ? "it is known while inputs and tunable parameters are those of the start" : NULL;
}

static int slopes_by(model *m, unsigned known, int initial, model_slopes *slopes) {
    const film_variable *by = &VARIABLE[known];
    const char *why = initial ? NULL : refusal(m);
    if (by->type != REAL) return model_error(m, "there is no derivative by %s, which is a whole number", by->name);
    if (why) return model_error(m, "there is no derivative by the parameter %s now: %s", by->name, why);
    if (known == TARGET_IMPEDANCE && m->memory.value[known] >= RIGID) { /* the target does not move */
        memset(slopes, 0, sizeof *slopes);
        slopes->by = known;
        return 0;
    }
    model moved;
    model_init(&moved, m->data);
    int status = -1;
    for (size_t k = 0; status < 0 && k < sizeof STENCIL / sizeof *STENCIL; k++)
        status = differences(&moved, m, known, initial, &STENCIL[k], slopes);
    if (status < 0) model_error(m, "there is no derivative by %s: %.180s", by->name, moved.message);
    if (status == OTHER_EVENTS)
        model_error(m, "there is no derivative by %s: other events happen within %g %% of %g %s", by->name, 200.0 * STEP,
                    m->memory.value[known], by->unit);
    model_free(&moved);
    slopes->by = status == 0 ? known : VARIABLES;
    return status == 0 ? 0 : -1;
}

int model_derivative(model *m, unsigned unknown, unsigned known, int initial, model_slopes *slopes, double *derivative) {
    if (!model_is_parameter(m, known)) return model_partial(m, unknown, known, derivative);
    if (initial && model_is_sensed(m, unknown)) { /* the target is at rest */
        *derivative = 0.0;
        return 0;
    }
    const char *by = VARIABLE[known].name, *of = model_name(m, unknown);
    if (unknown >= VARIABLES || !is_unknown(m, unknown, initial))
        return model_error(m, "%s has no derivative by the parameter %s%s", of, by,
                           initial ? "" : " after Initialization Mode: only what events and contacts leave has one");
    if (slopes->by != known && slopes_by(m, known, initial, slopes) < 0) return -1;
    if (slopes->kinked[unknown])
        return model_error(m, "%s has no derivative by %s: there is a kink or jump within %g %% of %g %s", of, by, 200.0 * STEP,
                           m->memory.value[known], VARIABLE[known].unit);
    *derivative = slopes->value[unknown];
    return isfinite(*derivative) ? 0 : model_not_finite(m, of);
}
