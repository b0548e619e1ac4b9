/* Steps of Co-Simulation, with intermediate updates. See instance.h. */
#include "instance_parts.h"

#include <math.h>
#include <string.h>

static const double SAME_TIME = 1e-9; /* of a step: tolerance for a communication point to equal the end of the last step */
enum { PARTS = 8 }; /* of a step, equal: inputs that change linearly in each have 1/64 of the error of a linear change in the whole */

/* ---------------------------------------------------------------- what the importer may access */

/* Inputs, and outputs that change continuously: intermediateUpdate="true" in modelDescription.xml. */
static int is_continuous(const instance *i, unsigned reference) {
    if (model_is_sensed(&i->model, reference)) return 1;
    if (reference == TIME || reference >= VARIABLES || (reference < SETTABLE && VARIABLE[reference].role[i->data->kind] == PARAMETER))
        return 0;
    int absent = VARIABLE[reference].role[i->data->kind] == ABSENT ||
                 (reference < SETTABLE && !i->data->available[reference]);
    return !absent && VARIABLE[reference].type == REAL && VARIABLE[reference].changes == ANY_TIME;
}

static int is_input(const instance *i, unsigned reference) {
    return reference < SETTABLE && VARIABLE[reference].role[i->data->kind] == INPUT;
}

int instance_require(instance *i, const char *function, const unsigned *references, size_t count, update_caller *updater,
                     void (*importer)(void)) {
    if (!importer || count == 0) return GOOD;
    NEED(references, count);
    for (size_t k = 0; k < count; k++) {
        unsigned reference = references[k];
        if (!is_continuous(i, reference))
            return instance_error(i, function, "requiredIntermediateVariables: the value reference %u is not one of a variable "
                                               "with intermediateUpdate = true", reference);
        i->required[reference] = 1;
        i->sets |= is_input(i, reference);
    }
    if (i->data->kind == CONTACT && !i->sets) return GOOD; /* its outputs change with its inputs */
    i->updater = updater;
    i->importer = importer;
    return GOOD;
}

static int may(const instance *i, const char *function, unsigned reference, int now, const char *access, const char *flag) {
    if (i->state.mode != INTERMEDIATE) return 1;
    int required = reference < sizeof i->required && i->required[reference];
    if (!now) instance_error(i, function, "%s must not be %s in this intermediate update: %s is false",
                             model_name(&i->model, reference), access, flag);
    else if (!required)
        instance_error(i, function, "%s must be in requiredIntermediateVariables to be %s in an intermediate update",
                       model_name(&i->model, reference), access);
    return now && required;
}

int instance_may_get(const instance *i, const char *function, unsigned reference) {
    return may(i, function, reference, i->update.get, "read", "intermediateVariableGetAllowed");
}

int instance_may_set(const instance *i, const char *function, unsigned reference) {
    return may(i, function, reference, i->update.set, "set", "intermediateVariableSetRequested");
}

/* ---------------------------------------------------------------- calls of the importer */

static void call_importer(instance *i, double time, int set, int get, int can_return) {
    update_call update = {time, set, get, get, can_return, 0, time};
    memcpy(&i->update, &update, sizeof update);
    i->state.mode = INTERMEDIATE;
    i->updater(i, &i->update);
    i->state.mode = STEPPING;
}

/* A part of an impact's step: its times, s, and the inputs there, between which they change linearly. */
typedef struct {
    double from, to, before[INPUTS], after[INPUTS];
} step_part;

/* The inputs that move the impactor during a part: their means. */
static void set_mean_inputs(instance *i, const step_part *part) {
    double *value = &i->model.memory.value[EXTERNAL_FORCE];
    for (int k = 0; k < INPUTS; k++) value[k] = 0.5 * part->before[k] + 0.5 * part->after[k];
}

/* The inputs at the time reached. */
static void set_present_inputs(instance *i, const step_part *part) {
    double *value = &i->model.memory.value[EXTERNAL_FORCE], share = (i->model.memory.time - part->from) / (part->to - part->from);
    for (int k = 0; k < INPUTS; k++)
        value[k] = share >= 1.0 ? part->after[k] : (1.0 - share) * part->before[k] + share * part->after[k];
}

/* Ask for the inputs at the end of a part. */
static void begin_part(instance *i, step_part *part, double to) {
    double *value = &i->model.memory.value[EXTERNAL_FORCE];
    part->from = i->model.memory.time;
    part->to = to;
    memcpy(part->before, value, sizeof part->before);
    if (i->sets) call_importer(i, to, 1, 0, 0);
    memcpy(part->after, value, sizeof part->after);
    set_mean_inputs(i, part);
}

/* A step in parts: its times, s, of which the importer may change the end; and the events so far. */
typedef struct {
    double from, end;
    int stop_at_events, events;
} step_course;

/* Show the outputs now; the importer may ask for an early return. */
static int show_outputs(instance *i, const char *function, step_course *course) {
    double now = i->model.memory.time, from = course->from, end = course->end, tolerance = SAME_TIME * (end - from);
    call_importer(i, now, i->sets && i->data->kind == CONTACT, 1, i->early_return);
    if (!i->update.returns) return GOOD;
    double to = i->update.return_time;
    if (i->early_return && to >= from - tolerance && to <= end + tolerance) {
        course->end = fmin(fmax(to, now), end);
        return GOOD;
    }
    i->state.mode = FAILED;
    if (!i->early_return) return instance_error(i, function, "earlyReturnRequested is true, but canReturnEarly was false");
    return instance_error(i, function, "earlyReturnTime %.17g s must be from %.17g s to %.17g s, in the step", to, from, end);
}

/* An impact to the end of a part, or to an event at which the step ends; *stopped is then 1. */
static int advance(instance *i, const char *function, const step_part *part, step_course *course, int *stopped) {
    model *m = &i->model;
    for (;;) {
        if (model_continue(m, fmin(part->to, course->end), 1, stopped) < 0) return instance_fail(i, function);
        if (!*stopped || course->stop_at_events) return GOOD;
        if (++course->events > MAX_STEP_EVENTS) {
            i->state.mode = FAILED;
            return instance_error(i, function, "more than %d events in one step, at %g s: ask for a shorter step", (int)MAX_STEP_EVENTS,
                                  m->memory.time);
        }
        set_present_inputs(i, part);
        if (m->memory.time < course->end && show_outputs(i, function, course) != GOOD) return ERROR;
        if (i->update.returns && m->memory.time >= course->end) return GOOD;
        set_mean_inputs(i, part); /* those at the event would move the target otherwise, and turn the motion again at once */
    }
}

/* A step with intermediate updates, at the ends of its parts and at events. */
static int step_in_parts(instance *i, const char *function, double from, double end, int stop_at_events) {
    model *m = &i->model;
    model_memory *now = &m->memory;
    step_course course = {from, end, stop_at_events, 0};
    double since = now->time, impulse = now->impulse;
    int impact = i->data->kind == IMPACT, stopped = 0;
    i->update.returns = 0;
    model_begin_step(m);
    for (int k = 1; now->time < course.end && !stopped; k++) {
        double to = k < PARTS ? fmin(from + (end - from) * k / PARTS, course.end) : course.end;
        step_part part;
        if (!(to > now->time)) continue;
        if (impact) {
            begin_part(i, &part, to);
            if (advance(i, function, &part, &course, &stopped) != GOOD) return ERROR;
            set_present_inputs(i, &part);
            if (!stopped && model_apply_inputs(m) < 0) return instance_fail(i, function);
        } else if (model_continue(m, to, 0, &stopped) < 0) {
            return instance_fail(i, function);
        }
        if (!stopped && now->time < course.end && show_outputs(i, function, &course) != GOOD) return ERROR;
    }
    if (impact && now->time > since) now->step_force = (now->impulse - impulse) / (now->time - since);
    return GOOD;
}

/* ---------------------------------------------------------------- a step */

int instance_step(instance *i, const char *function, double from, double size, int *event) {
    model_memory *now = &i->model.memory;
    double end = from + size;
    *event = 0;
    ALLOW(STEPPING);
    if (!(size >= 0.0) || !isfinite(end))
        return instance_error(i, function, "the step of %g s from %g s must be >= 0 s and finite", size, from);
    if (size > 0.0 && !(end > from)) return instance_error(i, function, "the step of %g s is below the resolution of the time %g s", size, from);
    if (!(fabs(from - now->time) <= SAME_TIME * size + 1e-14 * fabs(now->time)))
        return instance_error(i, function, "the step begins at %.17g s, but the last one ended at %.17g s", from, now->time);
    if (i->state.has_stop_time && end > i->state.stop_time + SAME_TIME * (size + fabs(end)))
        return instance_error(i, function, "the step ends at %g s, after the stop time %g s", end, i->state.stop_time);
    if (i->event_mode && model_has_unreported(&i->model))
        return instance_error(i, function, "the event at %.17g s must first be handled in Event Mode", now->time);
    int stopped, stop_at_events = i->event_mode && i->early_return;
    if (i->updater && end > now->time) {
        if (step_in_parts(i, function, from, end, stop_at_events) != GOOD) return ERROR;
    } else if (model_step(&i->model, end > now->time ? end : now->time, stop_at_events, &stopped) < 0) {
        return instance_fail(i, function);
    }
    instance_announce(i);
    if (!i->event_mode) model_report(&i->model);
    *event = model_has_unreported(&i->model);
    return GOOD;
}
