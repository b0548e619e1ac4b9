/* Part of fmu_check.c: saved states, several instances, reset. */
#ifndef FMU_CHECK_STATES_H
#define FMU_CHECK_STATES_H

#include "fmu_check_steps.h"

/* ---------------------------------------------------------------- runs that must repeat to the last bit */

/* One random step; the outputs after it go to `values`. */
static void random_step(unit *u, double typical, double values[VARIABLES]) {
    const model_data *data = &u->from->data;
    double size = typical * over_decades(1e-3, 1.0);
    if (data->kind == IMPACT && !relaxing(u->from) && whole(0, 3) == 0) { /* viscoelastic bodies refuse contacts that close again */
        double weight = data->force_scale * 1e-2;
        HOLD(set(u, EXTERNAL_FORCE, whole(0, 1) ? 0.0 : uniform(-0.3 * weight, weight)) == GOOD);
        if (whole(0, 1)) HOLD(set(u, SUPPORT_VELOCITY, uniform(-0.05, 0.05) * data->start[INITIAL_VELOCITY]) == GOOD);
    }
    if (u->interface == EXCHANGE) {
        double x[STATES], z[FILM_INDICATORS];
        int due = 0;
        if (data->kind == CONTACT) {
            HOLD(set(u, INDENTATION, data->length_scale * uniform(-1.0, 3.0)) == GOOD);
            HOLD(set(u, RELATIVE_VELOCITY, uniform(-1.0, 1.0)) == GOOD);
        } else {
            double rates[STATES];
            size_t count = (size_t)model_state_count(data);
            HOLD(get_states(u, x, count) == GOOD && get_rates(u, rates, count) == GOOD);
            for (size_t k = 0; k < count; k++) x[k] += 0.02 * size * rates[k];
            HOLD(set_states(u, x, count) == GOOD);
        }
        u->now += 0.02 * size;
        HOLD(set_time(u, u->now) == GOOD);
        HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
        for (int k = 0; k < FILM_INDICATORS; k++) due |= z[k] <= 0.0;
        int asked;
        HOLD(completed_step(u, &asked) == GOOD);
        if (due || asked) handle(u);
    } else {
        if (data->kind == CONTACT) {
            HOLD(set(u, INDENTATION, data->length_scale * uniform(-1.0, 3.0)) == GOOD);
            double speed = uniform(0.6, 1.0) * data->length_scale / typical; /* a contact that doubles it is refused */
            HOLD(set(u, RELATIVE_VELOCITY, whole(0, 1) ? speed : -speed) == GOOD);
        }
        forward(u, size, NULL);
    }
    get_all(u, values);
}

/* Approximate duration of a contact, s; any time for the contact alone, which has no mass. */
static double typical_time(const resources *r) {
    if (r->data.kind == CONTACT) return 1e-4;
    unit u = started(3, COSIMULATION, r, NULL, 0.0);
    if (beside(r)) {
        double several = (relaxing(r) ? 0.5 : 4.0) * inside(&u)->memory.time_scale;
        dispose(&u);
        return several;
    }
    march m = core_march(&u);
    dispose(&u);
    return (m.end - m.touch) / 1.3;
}

enum { REDONE = 4 };

static void rollback(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    double typical = typical_time(r), first[REDONE][VARIABLES], again[REDONE][VARIABLES], flight;
    unit made = started(version, interface, r, &s, 0.0), *u = &made;
    flight = r->data.kind == IMPACT && interface != EXCHANGE && !beside(r) ? core_march(u).touch : 0.0;
    void *saved = NULL;
    for (int k = 0; k < ROLLBACKS; k++) {
        if (k % 25 == 0) { /* a new start, because the motion ends some time */
            HOLD(reset(u) == GOOD);
            s = random_settings(r);
            apply(u, &s);
            HOLD(enter_initialization(u, uniform(0.0, 1e-3)) == GOOD && exit_initialization(u) == GOOD);
            if (interface != COSIMULATION) HOLD(update(u) == GOOD && leave_event_mode(u) == GOOD);
            if (flight > typical) forward(u, flight, NULL);
        }
        random_step(u, typical, first[0]);
        HOLD(save(u, &saved) == GOOD);
        double now = u->now;
        uint64_t from = seed;
        for (int i = 0; i < REDONE; i++) random_step(u, typical, first[i]);
        seed = from;
        u->now = now;
        HOLD(restore(u, saved) == GOOD);
        for (int i = 0; i < REDONE; i++) random_step(u, typical, again[i]);
        HOLD(memcmp(first, again, sizeof first) == 0);

        size_t size = 0;
        HOLD(saved_size(u, saved, &size) == GOOD && size > 0);
        unsigned char *bytes = malloc(size), *same = malloc(size);
        HOLD(bytes && same && serialize(u, saved, bytes, size) == GOOD);
        unit other = make(version, interface, r);
        void *taken = NULL;
        HOLD(deserialize(&other, bytes, size, &taken) == GOOD);
        HOLD(serialize(&other, taken, same, size) == GOOD && memcmp(bytes, same, size) == 0);
        HOLD(restore(&other, taken) == GOOD);
        seed = from;
        other.now = now;
        for (int i = 0; i < REDONE; i++) random_step(&other, typical, again[i]);
        HOLD(memcmp(first, again, sizeof first) == 0);
        HOLD(forget(&other, &taken) == GOOD && taken == NULL);
        dispose(&other);
        free(bytes);
        free(same);
    }
    HOLD(forget(u, &saved) == GOOD && saved == NULL);
    dispose(u);
}

/* Two units that step in turn give the same results as each one alone; a unit after reset, the same as a new one. */
static void no_cross_talk(const resources *a, int version_a, const resources *b, int version_b) {
    enum { STEPS = 40 };
    static double alone[2][STEPS][VARIABLES], values[VARIABLES];
    const resources *from[2] = {a, b};
    const int version[2] = {version_a, version_b};
    settings s[2] = {random_settings(a), random_settings(b)};
    uint64_t begin[2] = {seed, seed + 1}, at[2];
    double typical[2] = {typical_time(a), typical_time(b)};
    for (int k = 0; k < 2; k++) {
        unit u = started(version[k], COSIMULATION, from[k], &s[k], 0.0);
        seed = begin[k];
        for (int i = 0; i < STEPS; i++) random_step(&u, typical[k], alone[k][i]);
        HOLD(reset(&u) == GOOD);
        apply(&u, &s[k]);
        HOLD(enter_initialization(&u, 0.0) == GOOD && exit_initialization(&u) == GOOD);
        seed = begin[k];
        for (int i = 0; i < STEPS; i++) {
            random_step(&u, typical[k], values);
            HOLD(memcmp(values, alone[k][i], sizeof values) == 0);
        }
        dispose(&u);
    }
    unit both[2] = {started(version[0], COSIMULATION, a, &s[0], 0.0), started(version[1], COSIMULATION, b, &s[1], 0.0)};
    memcpy(at, begin, sizeof at);
    for (int i = 0; i < 2 * STEPS; i++) {
        seed = at[i % 2];
        random_step(&both[i % 2], typical[i % 2], values);
        at[i % 2] = seed;
        HOLD(memcmp(values, alone[i % 2][i / 2], sizeof values) == 0);
    }
    dispose(&both[0]);
    dispose(&both[1]);
}

/* A state can only be restored in the same FMU and the same kind of instance; getting a state may overwrite an old one. */
static void foreign_states(const resources *r, const resources *another) {
    size_t size = 0;
    void *saved = NULL, *taken = &size;
    unit donor = make(3, COSIMULATION, r);
    HOLD(save(&donor, &saved) == GOOD && saved_size(&donor, saved, &size) == GOOD);
    unsigned char *bytes = malloc(size);
    HOLD(bytes && serialize(&donor, saved, bytes, size) == GOOD);
    unit other[] = {make(3, EXCHANGE, r), make(3, WITH_EVENTS, r), make(3, COSIMULATION, another), make(2, COSIMULATION, r)};
    for (int k = 0; k < 4; k++) {
        if (!other[k].c) continue; /* the contact has no event mode, a vibrating target no Model Exchange */
        HOLD(deserialize(&other[k], bytes, size, &taken) == (k == 2 ? ERROR : GOOD));
        HOLD((taken == NULL) == (k == 2));
        HOLD(restore(&other[k], saved) == (k == 3 ? GOOD : ERROR));
        HOLD(k == 3 || strstr(last_message, k == 2 ? "another FMU" : "Co-Simulation"));
        HOLD(forget(&other[k], &taken) == GOOD);
        dispose(&other[k]);
    }
    HOLD(forget(&donor, &saved) == GOOD);
    dispose(&donor);
    free(bytes);
}

/* The saved states of a unit after reset and of a new unit have the same bytes. */
static void reset_is_new(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    double typical = typical_time(r), values[VARIABLES];
    unit made = started(version, interface, r, &s, 1.0), *u = &made;
    for (int i = 0; i < 20; i++) random_step(u, typical, values);
    HOLD(reset(u) == GOOD);
    unit fresh = make(version, interface, r);
    void *saved[2] = {NULL, NULL};
    size_t size = 0;
    HOLD(save(u, &saved[0]) == GOOD && save(&fresh, &saved[1]) == GOOD && saved_size(u, saved[0], &size) == GOOD);
    unsigned char *bytes = malloc(2 * size);
    HOLD(bytes && serialize(u, saved[0], bytes, size) == GOOD && serialize(&fresh, saved[1], bytes + size, size) == GOOD);
    HOLD(memcmp(bytes, bytes + size, size) == 0);
    free(bytes);
    HOLD(forget(u, &saved[0]) == GOOD && forget(&fresh, &saved[1]) == GOOD);
    dispose(&fresh);
    dispose(u);
}

#endif
