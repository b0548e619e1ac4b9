/* Derivatives of outputs by parameters: finite differences of fourth order. See model.h.
 *
 * In Initialization Mode: of all outputs, at the start. In Model Exchange: of the motion, as a function of the states, inputs and
 * parameters. In Co-Simulation: of all outputs. Each impact of a stencil is
 * marched from the start, with the inputs of the start, to the event that the outputs show now and to the time now. With
 * the same numbers of segments the results are smooth to rounding, so that the differences are exact to about 1e-10; the motion has
 * kinks where it passes the end of a segment, beside which it is differenced on the other side or in shorter steps. */
#include "model_parts.h"

#include <math.h>
#include <string.h>

enum { POINTS = 5, OTHER_EVENTS = 1 };
enum { AT_START, INTEGRATED, MARCHED }; /* what is differenced */

/* Step over the parameter, as in film_model/solve/slopes.py. */
static const double STEP = 1e-3;

/* Fourth difference over the largest value of a stencil: h^4 f'''' of a smooth value, and up to 2 h times the jump of its slope
 * at a kink, which then moves the derivative by less than 1e-6 of value over parameter. Needed by
 * test_by_parameters_of_what_an_impact_left: in Stronge's law, at a time that is just that of an event. */
static const double KINK = 1e-9;

/* Points at first, first + 1, ... times `step` steps from the value. */
typedef struct {
    int first;
    double step;
    double weight[POINTS];
} stencil;

static const stencil STENCIL[] = {
    {-2, 1.0, {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0}},
    {0, -1.0, {-25.0 / 12.0, 48.0 / 12.0, -36.0 / 12.0, 16.0 / 12.0, -3.0 / 12.0}},
    {0, 1.0, {-25.0 / 12.0, 48.0 / 12.0, -36.0 / 12.0, 16.0 / 12.0, -3.0 / 12.0}},
    {-2, 0.1, {1.0 / 12.0, -8.0 / 12.0, 0.0, 8.0 / 12.0, -1.0 / 12.0}},
}; /* in the order in which they are tried, the others where one leaves the range of the parameter */

static const double FOURTH[POINTS] = {1.0, -4.0, 6.0, -4.0, 1.0};

int model_is_discrete(unsigned reference) {
    return reference < VARIABLES && VARIABLE[reference].changes >= AT_STEPS;
}

static int is_unknown(const model *m, unsigned reference, int what) {
    if (reference - EVENT_INDICATOR_1 < FILM_INDICATORS || reference == TIME || !model_has(m, reference) ||
        VARIABLE[reference].role[m->data->kind] != OUTPUT || VARIABLE[reference].type != REAL)
        return 0;
    if (what == AT_START) return 1;
    return !model_of_friction(reference) && (!model_is_discrete(reference) || (what == MARCHED && reference != MEAN_CONTACT_FORCE));
}

static int get_unknowns(model *m, int what, double values[VARIABLES]) {
    for (unsigned k = 0; k < VARIABLES; k++)
        if (is_unknown(m, k, what) && model_get(m, k, &values[k]) < 0) return -1;
    return 0;
}

/* ---------------------------------------------------------------- the impacts of a stencil */

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

/* The outputs when the impact `of` has the parameters of m. Returns OTHER_EVENTS if its events then differ. */
static int as_marched(model *m, const model *of, double values[VARIABLES]) {
    const model_memory *then = &of->memory;
    model_record record;
    int32_t events = then->reported.events;
    if (model_initialize(m, then->start_time) < 0) return -1;
    memcpy(&record, &m->memory.actual, sizeof record);
    int status = march(m, then->time, 0, events, &record);
    if (status >= 0 && get_unknowns(m, MARCHED, values) < 0) return -1;
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

/* The outputs at another value of a parameter. */
static int evaluate(model *moved, const model *m, unsigned known, double value, int what, double values[VARIABLES]) {
    if (what == INTEGRATED) {
        memcpy(&moved->memory, &m->memory, sizeof moved->memory);
        return model_move_parameter(moved, known, value) < 0 ? -1 : get_unknowns(moved, what, values);
    }
    memcpy(moved->memory.value, m->memory.value, sizeof moved->memory.value);
    if (what == MARCHED) memcpy(&moved->memory.value[EXTERNAL_FORCE], m->memory.first_inputs, sizeof m->memory.first_inputs);
    moved->memory.start_time = m->memory.start_time;
    if (model_set(moved, known, value) < 0) return -1;
    if (what == MARCHED) return as_marched(moved, m, values);
    return model_initialize(moved, m->memory.start_time) < 0 ? -1 : get_unknowns(moved, what, values);
}

/* What rounding of an output is relative to, where the output itself may be near 0. */
static double size_of(const model *m, unsigned unknown, double impulse) {
    double mass = m->memory.value[MASS], length = m->data->nominal[0], speed = m->data->speed;
    switch (unknown) {
    case INDENTATION:
    case IMPACTOR_DISPLACEMENT:
    case TARGET_DISPLACEMENT: return length;
    case RELATIVE_VELOCITY:
    case RATE_OF_INDENTATION:
    case IMPACTOR_VELOCITY:
    case TARGET_VELOCITY:
    case RATE_OF_TARGET_DISPLACEMENT: return speed;
    case IMPACTOR_ACCELERATION:
    case RATE_OF_IMPACTOR_VELOCITY: return speed * speed / length;
    case CONTACT_FORCE: return m->data->kind == IMPACT ? mass * speed * speed / length : 0.0;
    case KINETIC_ENERGY: return mass * speed * speed;
    case CONTACT_ENERGY:
    case TARGET_ENERGY:
    case EXTERNAL_WORK: return 0.125 * impulse * impulse / mass;
    default: return 0.0;
    }
}

/* again: after another stencil, of the motion that has kinks there. */
static int differences(model *moved, const model *m, unsigned known, int what, const stencil *at, int again, model_slopes *slopes) {
    double values[POINTS][VARIABLES] = {{0.0}}, h = at->step * step_by(m, known), point[POINTS];
    for (int k = 0; k < POINTS; k++) {
        point[k] = m->memory.value[known] + h * (at->first + k);
        int status = evaluate(moved, m, known, point[k], what, values[k]);
        if (status != 0) return status;
    }
    double step = (point[POINTS - 1] - point[0]) / (POINTS - 1);
    for (unsigned n = 0; n < VARIABLES; n++) {
        if (again && (!slopes->kinked[n] || model_is_discrete(n))) continue;
        double sum = 0.0, fourth = 0.0, size = size_of(m, n, values[0][CONTACT_IMPULSE]);
        for (int k = 0; k < POINTS; k++) {
            sum += at->weight[k] * (values[k][n] - values[0][n]); /* exactly 0 of a constant */
            fourth += FOURTH[k] * values[k][n];
            size = fmax(size, fabs(values[k][n]));
        }
        slopes->value[n] = sum / step;
        slopes->kinked[n] = !(fabs(fourth) <= KINK * size);
    }
    return 0;
}

/* Why there are no derivatives by parameters now, or NULL. */
static const char *refusal(const model *m, int what) {
    if (what != MARCHED) return NULL;
    if (m->data->kind == CONTACT) return "of a contact in Co-Simulation it is known in Initialization Mode only";
    if (vibrates(m)) return "on a target that vibrates it is known in Initialization Mode only";
    return m->memory.varied ? "it is known while inputs and tunable parameters are those of the start" : NULL;
}

/* By the first stencil that fits; of motion with a kink there, by the next. */
static int slopes_over(model *moved, const model *m, unsigned known, int what, model_slopes *slopes) {
    int found = -1, kinked = 0;
    for (size_t k = 0; k < sizeof STENCIL / sizeof *STENCIL && (found < 0 || (found == 0 && kinked)); k++) {
        int status = differences(moved, m, known, what, &STENCIL[k], found == 0, slopes);
        if (found < 0) found = status;
        kinked = 0;
        for (unsigned n = 0; n < VARIABLES; n++) kinked |= what == MARCHED && slopes->kinked[n] && !model_is_discrete(n);
    }
    return found;
}

static int slopes_by(model *m, unsigned known, int what, model_slopes *slopes) {
    const film_variable *by = &VARIABLE[known];
    const char *why = refusal(m, what);
    if (by->type != REAL) return model_error(m, "there is no derivative by %s, which is a whole number", by->name);
    if (why) return model_error(m, "there is no derivative by the parameter %s now: %s", by->name, why);
    memset(slopes, 0, sizeof *slopes);
    slopes->by = known;
    if (known == TARGET_IMPEDANCE && m->memory.value[known] >= RIGID) return 0; /* the target does not move */
    model moved;
    model_init(&moved, m->data);
    int status = slopes_over(&moved, m, known, what, slopes);
    if (status < 0) model_error(m, "there is no derivative by %s: %.180s", by->name, moved.message);
    if (status == OTHER_EVENTS)
        model_error(m, "there is no derivative by %s: other events happen within %g %% of %g %s", by->name, 200.0 * STEP,
                    m->memory.value[known], by->unit);
    model_free(&moved);
    if (status != 0) slopes->by = VARIABLES;
    return status == 0 ? 0 : -1;
}

int model_derivative(model *m, unsigned unknown, unsigned known, int initial, model_slopes *slopes, double *derivative) {
    if (!model_is_parameter(m, known)) return model_partial(m, unknown, known, derivative);
    if (initial && model_is_sensed(m, unknown)) { /* the target is at rest */
        *derivative = 0.0;
        return 0;
    }
    const char *by = VARIABLE[known].name, *of = model_name(m, unknown);
    int what = initial ? AT_START : m->memory.importer_integrates ? INTEGRATED : MARCHED;
    if (unknown >= VARIABLES || !is_unknown(m, unknown, what))
        return model_error(m, "%s has no derivative by the parameter %s%s", of, by, initial ? "" : " after Initialization Mode");
    if (slopes->by != known && slopes_by(m, known, what, slopes) < 0) return -1;
    if (slopes->kinked[unknown])
        return model_error(m, "%s has no derivative by %s: there is a kink or jump within %g %% of %g %s", of, by, 200.0 * STEP,
                           m->memory.value[known], VARIABLE[known].unit);
    *derivative = slopes->value[unknown];
    return isfinite(*derivative) ? 0 : model_not_finite(m, of);
}
