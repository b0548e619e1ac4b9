/* Part of fmu_check.c: intermediate updates of FMI 3.0. */
#ifndef FMU_CHECK_UPDATES_H
#define FMU_CHECK_UPDATES_H

#include "fmu_check_states.h"

static double updated_until = 0.0; /* time of the latest update that showed outputs */
static long updates = 0;

/* Every call that is not allowed in an intermediate update is an error, and changes nothing. */
static void try_forbidden_calls(unit *u, int may_set, int may_get) {
    unsigned time = TIME, mass = u->from->data.kind == IMPACT ? MASS : RADIUS, first = required[0];
    double value = 1.0;
    void *saved = NULL;
    fmi3Boolean flags[3];
    HOLD(fmi3DoStep(u->c, u->now, 1e-6, fmi3True, &flags[0], &flags[1], &flags[2], &value) == fmi3Error);
    HOLD(strstr(last_message, "Intermediate Update Mode") != NULL);
    HOLD(fmi3GetFMUState(u->c, &saved) == fmi3Error && saved == NULL);
    HOLD(fmi3Reset(u->c) == fmi3Error && fmi3Terminate(u->c) == fmi3Error && fmi3EnterEventMode(u->c) == fmi3Error);
    fmi3FreeInstance(u->c);
    HOLD(strstr(last_message, "fmi3FreeInstance: called in state Intermediate Update Mode") != NULL);
    HOLD(fmi3GetFloat64(u->c, &time, 1, &value, 1) == fmi3Error && fmi3SetFloat64(u->c, &mass, 1, &value, 1) == fmi3Error);
    if (!may_get) HOLD(fmi3GetFloat64(u->c, &first, 1, &value, 1) == fmi3Error);
    if (!may_set) HOLD(fmi3SetFloat64(u->c, &first, 1, &value, 1) == fmi3Error);
}

static void check_update(unit *u, double time, int may_set, int may_get, int finished) {
    HOLD(((instance *)u->c)->state.mode == INTERMEDIATE);
    HOLD(finished == may_get && (may_set || may_get) && time >= updated_until);
    if (may_get) updated_until = time;
    updates++;
    for (size_t k = 0; may_get && k < required_count; k++) get(u, required[k]);
    if (whole(0, 9) == 0) try_forbidden_calls(u, may_set, may_get);
}

/* Inputs that swing, and no early return. */
static void swing(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get, fmi3Boolean finished,
                  fmi3Boolean may_return, fmi3Boolean *returns, fmi3Float64 *return_time) {
    const model_data *data = &in_step->from->data;
    (void)environment, (void)may_return, (void)returns, (void)return_time;
    check_update(in_step, time, may_set, may_get, finished);
    if (!may_set || relaxing(in_step->from)) return;
    double phase = sin(time * 1e6);
    if (data->kind == CONTACT) {
        HOLD(set(in_step, INDENTATION, data->length_scale * (1.0 + phase)) == GOOD);
        return;
    }
    HOLD(set(in_step, EXTERNAL_FORCE, 1e-2 * data->force_scale * phase) == GOOD);
    HOLD(set(in_step, SUPPORT_VELOCITY, 0.05 * data->start[INITIAL_VELOCITY] * phase) == GOOD);
    HOLD(set(in_step, SUPPORT_VELOCITY, NAN) == ERROR);
}

/* No inputs; often an early return, at once or later. */
static void hurry(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get, fmi3Boolean finished,
                  fmi3Boolean may_return, fmi3Boolean *returns, fmi3Float64 *return_time) {
    (void)environment;
    check_update(in_step, time, may_set, may_get, finished);
    HOLD(may_return == (in_step->interface == EARLY_RETURN));
    *returns = may_return && whole(0, 5) == 0;
    HOLD(*return_time == time);
    if (whole(0, 1)) *return_time = time + 1e-3 * (time - in_step->now);
}

/* Early returns, and outputs that are read in the step, leave the motion as it is. */
static void updates_of_outputs(const resources *r, int interface) {
    settings s = random_settings(r);
    unit whole_ = started(3, COSIMULATION, r, &s, 0.0);
    require(r, 0);
    importer = hurry;
    unit made = started(3, interface, r, &s, 0.0), *u = &made;
    importer = NULL;
    double end = 12.0 * inside(u)->memory.time_scale, largest = r->data.force_scale;
    updated_until = 0.0;
    forward(&whole_, end, NULL);
    while (end - u->now > 1e-9 * end) {
        double to = u->now + fmin(0.2 * end, end - u->now);
        while (u->now < to) {
            stepped how;
            importer = hurry; /* an early return may come without an event */
            HOLD(do_step(u, u->now, to - u->now, &how) == GOOD);
            importer = NULL;
            HOLD(how.early == (how.time < to) && how.time >= u->now);
            u->now = how.early ? how.time : to;
            if (how.event) handle(u);
        }
    }
    HOLD(get(u, EVENT_COUNT) == get(&whole_, EVENT_COUNT));
    NEAR(get(u, TIME_OF_LAST_EVENT), get(&whole_, TIME_OF_LAST_EVENT), end, ON_MODES);
    NEAR(get(u, CONTACT_FORCE), get(&whole_, CONTACT_FORCE), largest, ON_MODES);
    NEAR(get(u, IMPACTOR_VELOCITY), get(&whole_, IMPACTOR_VELOCITY), inside(u)->memory.velocity, ON_MODES);
    NEAR(get(u, IMPACTOR_DISPLACEMENT), get(&whole_, IMPACTOR_DISPLACEMENT), inside(u)->memory.length, ON_MODES);
    NEAR(get(u, CONTACT_IMPULSE), get(&whole_, CONTACT_IMPULSE), s.value[MASS] * inside(u)->memory.velocity, ON_MODES);
    required_count = 0;
    dispose(&whole_);
    dispose(u);
}

/* Inputs that are set in the step: steps repeat to the last bit. */
static void updates_of_inputs(const resources *r, int interface) {
    settings s = random_settings(r);
    double typical = typical_time(r), first[VARIABLES], again[VARIABLES];
    require(r, 1);
    importer = swing;
    unit made = started(3, interface, r, &s, 0.0), *u = &made;
    void *saved = NULL;
    for (int k = 0; k < 40; k++) {
        uint64_t from = seed;
        double now = u->now;
        updated_until = now;
        HOLD(save(u, &saved) == GOOD);
        random_step(u, typical, first);
        seed = from;
        u->now = updated_until = now;
        HOLD(restore(u, saved) == GOOD);
        random_step(u, typical, again);
        HOLD(memcmp(first, again, sizeof first) == 0);
    }
    HOLD(forget(u, &saved) == GOOD);
    importer = NULL;
    required_count = 0;
    dispose(u);
}

#endif
