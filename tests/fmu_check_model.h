/* Part of fmu_check.c: parameters, memory, Model Exchange, derivatives. */
#ifndef FMU_CHECK_MODEL_H
#define FMU_CHECK_MODEL_H

#include "fmu_check_states.h"

/* ---------------------------------------------------------------- parameters */

/* The same impact at another size and speed: what is set after instantiation counts, by laws that hold for every contact
 * law. Everything `longer` times as large at the same speed; and `slower` times as slow with the same energy. */
static void scaling(const resources *r, int version, double longer, double slower) {
    settings s = random_settings(r), t = s;
    int sized = r->data.available[RADIUS] && r->data.available[EFFECTIVE_MODULUS] &&
                (r->data.available[YIELD_STRENGTH] || r->data.length_power[2] == 0.0) && r->data.length_power[0] == 1.0;
    if (!sized) longer = 1.0;
    double time = longer * slower;
    t.value[MASS] *= longer * longer * longer * slower * slower;
    t.value[INITIAL_VELOCITY] /= slower;
    t.value[INITIAL_GAP] *= longer;
    t.value[RADIUS] *= longer;
    t.value[GRAVITY] /= longer * slower * slower;
    if (t.value[TARGET_IMPEDANCE] < RIGID) t.value[TARGET_IMPEDANCE] *= longer * longer * slower;
    unit one = started(version, COSIMULATION, r, &s, 0.0), other = started(version, COSIMULATION, r, &t, 0.0);
    march m = core_march(&one);
    double damper = inside(&one)->memory.state.damper, other_damper = inside(&other)->memory.state.damper;
    int damps_alike = fabs(damper - other_damper) <= EXACT * damper; /* not if the law has a viscosity, which sets a time scale */
    for (int k = 1; k <= SAMPLES && damps_alike; k++) {
        double to = m.end * k / SAMPLES;
        forward(&one, to - one.now, NULL);
        forward(&other, to * time - other.now, NULL);
        NEAR(get(&other, INDENTATION) / longer, get(&one, INDENTATION), m.largest[INDENTATION], EXACT);
        NEAR(get(&other, CONTACT_FORCE) / (longer * longer), get(&one, CONTACT_FORCE), m.largest[CONTACT_FORCE], EXACT);
        NEAR(get(&other, IMPACTOR_VELOCITY) * slower, get(&one, IMPACTOR_VELOCITY), m.largest[IMPACTOR_VELOCITY], EXACT);
    }
    HOLD(!damps_alike || (get(&one, CONTACT_COUNT) == 1 && get(&other, CONTACT_COUNT) == 1));
    if (damps_alike) NEAR(get(&other, TIME_CONTACT_ENDS) / time, get(&one, TIME_CONTACT_ENDS), m.end, EXACT);
    dispose(&one);
    dispose(&other);
}

/* Whether the law is linear, so that any number of segments is exact. */
static int straight(const resources *r) {
    const film_piece *piece = &r->data.curve.piece[0];
    return r->data.curve.pieces == 1 && piece->force.form == FILM_POWER && piece->force.coefficient == 0.0 &&
           piece->damping.coefficient == 0.0;
}

/* Each parameter has an effect, and can be set until the end of Initialization Mode only. */
static void parameters(const resources *r, int version) {
    double typical = typical_time(r), usual[VARIABLES], changed[VARIABLES];
    double steps = r->data.kind == IMPACT && r->data.start[INITIAL_GAP] > 1e-5 ? 1e-2 : 1.1 * typical;
    for (unsigned k = 0; k < SETTABLE; k++) {
        if (!has(r, k) || VARIABLE[k].role[r->data.kind] != PARAMETER) continue;
        if ((k == LOADING_SEGMENTS || k == UNLOADING_SEGMENTS) && straight(r)) continue;
        for (int late = 0; late < 2; late++) {
            unit made = started(version, COSIMULATION, r, NULL, 0.0), *u = &made;
            double value = r->data.start[k], other = value * (VARIABLE[k].type == WHOLE ? 2.0 : 0.9) + (k == GRAVITY ? (relaxing(r) ? 1.0 : 1e3) : 0.0);
            if (k == INITIAL_GAP) other += 1e-6;
            if (k == TARGET_IMPEDANCE && value >= RIGID) other = 3e3;
            for (int change = 0; change < 2; change++) {
                double *values = change ? changed : usual;
                HOLD(reset(u) == GOOD);
                HOLD(get(u, k) == value);
                if (!late) HOLD(set(u, k, change ? other : value) == GOOD);
                HOLD(enter_initialization(u, 0.0) == GOOD);
                get(u, CONTACT_FORCE); /* the parameter can also be set after the model was initialized by a read */
                if (late) HOLD(set(u, k, change ? other : value) == GOOD);
                HOLD(get(u, k) == (change ? other : value));
                HOLD(exit_initialization(u) == GOOD);
                if (r->data.kind == CONTACT) {
                    double depth = 2.5 * r->data.length_scale;
                    HOLD(set(u, INDENTATION, depth) == GOOD && set(u, RELATIVE_VELOCITY, -0.01 * depth / steps) == GOOD);
                }
                forward(u, steps, NULL);
                get_all(u, values);
                int tuned = set(u, k, value) == GOOD && get(u, k) == value;
                HOLD(tuned ? VARIABLE[k].tunable : strstr(last_message, VARIABLE[k].name) != NULL);
            }
            snprintf(detail, sizeof detail, "%s", VARIABLE[k].name);
            changed[k] = usual[k];
            HOLD(memcmp(usual, changed, sizeof usual) != 0);
            detail[0] = 0;
            HOLD(set(u, k, NAN) == ERROR || VARIABLE[k].type == WHOLE);
            HOLD(reset(u) == GOOD);
            HOLD(set(u, k, VARIABLE[k].low - 1.0 - fabs(VARIABLE[k].low)) == ERROR && strstr(last_message, "out of range"));
            dispose(u);
        }
    }
}

/* ---------------------------------------------------------------- memory */

static void cycles(const resources *r) {
    long before = blocks;
    for (int k = 0; k < CYCLES; k++) {
        int version = 2 + k % 2, interface = version == 3 ? k / 2 % INTERFACES : k / 2 % 2 ? EXCHANGE : COSIMULATION;
        if (r->data.kind == CONTACT && interface != EXCHANGE) interface = COSIMULATION;
        if (!exchanges(r) && interface == EXCHANGE) interface = COSIMULATION;
        unit made = started(version, interface, r, NULL, 0.0), *u = &made;
        double values[VARIABLES];
        void *saved = NULL;
        random_step(u, 1e-3, values);
        HOLD(save(u, &saved) == GOOD);
        random_step(u, 1e-3, values);
        HOLD(restore(u, saved) == GOOD);
        HOLD(blocks > before);
        HOLD(forget(u, &saved) == GOOD);
        if (k % 3) HOLD(terminate(u) == GOOD);
        if (k % 3 == 2) HOLD(reset(u) == GOOD);
        dispose(u);
        HOLD(blocks == before);
    }
    for (int k = 0;; k++) { /* allocation number k fails */
        until_none = k;
        refusals = 0;
        unit made = make(2 + k % 2, COSIMULATION, r), *u = &made;
        void *saved = NULL;
        int status = u->c ? enter_initialization(u, 0.0) : ERROR;
        if (status == GOOD) status = exit_initialization(u);
        if (status == GOOD) status = save(u, &saved);
        int all = refusals == 0;
        until_none = -1;
        HOLD(all == (status == GOOD));
        if (saved) HOLD(forget(u, &saved) == GOOD);
        dispose(u);
        HOLD(blocks == before);
        if (all) break;
        HOLD(strstr(last_message, "no memory") != NULL);
    }
    if (r->data.kind == CONTACT || beside(r)) return;
    settings s = random_settings(r);
    s.value[LOADING_SEGMENTS] = s.value[UNLOADING_SEGMENTS] = 100.0;
    unit fine = started(3, COSIMULATION, r, &s, 0.0), coarse = started(3, COSIMULATION, r, NULL, 0.0);
    void *saved = NULL;
    stepped how;
    HOLD(save(&fine, &saved) == GOOD);
    until_none = 0;
    HOLD(restore(&coarse, saved) == ERROR); /* no memory for its mesh */
    until_none = -1;
    HOLD(do_step(&coarse, 0.0, 1e-3, &how) == ERROR);
    HOLD(restore(&coarse, saved) == GOOD);
    HOLD(do_step(&coarse, 0.0, 1e-3, &how) == GOOD);
    HOLD(forget(&coarse, &saved) == GOOD);
    dispose(&coarse);
    dispose(&fine);
    HOLD(blocks == before);
}

/* ---------------------------------------------------------------- model exchange */

static void rates_at(unit *u, double time, const double x[NORMAL_STATES], double rates[NORMAL_STATES]) {
    HOLD(set_time(u, time) == GOOD && set_states(u, x, NORMAL_STATES) == GOOD && get_rates(u, rates, NORMAL_STATES) == GOOD);
}

/* One Runge-Kutta step of size h from x to y. */
static void runge_kutta(unit *u, double time, const double x[NORMAL_STATES], double h, double y[NORMAL_STATES]) {
    double k[4][NORMAL_STATES], z[NORMAL_STATES];
    rates_at(u, time, x, k[0]);
    for (int i = 0; i < NORMAL_STATES; i++) z[i] = x[i] + 0.5 * h * k[0][i];
    rates_at(u, time + 0.5 * h, z, k[1]);
    for (int i = 0; i < NORMAL_STATES; i++) z[i] = x[i] + 0.5 * h * k[1][i];
    rates_at(u, time + 0.5 * h, z, k[2]);
    for (int i = 0; i < NORMAL_STATES; i++) z[i] = x[i] + h * k[2][i];
    rates_at(u, time + h, z, k[3]);
    for (int i = 0; i < NORMAL_STATES; i++) y[i] = x[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

static int due(unit *u, double time, const double x[NORMAL_STATES]) {
    double z[FILM_INDICATORS];
    int any = 0;
    HOLD(set_time(u, time) == GOOD && set_states(u, x, NORMAL_STATES) == GOOD);
    HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
    for (int k = 0; k < FILM_INDICATORS; k++) {
        HOLD(isfinite(z[k]));
        any |= z[k] <= 0.0;
    }
    return any;
}

static void after_event(unit *u) {
    double z[FILM_INDICATORS];
    HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
    for (int k = 0; k < FILM_INDICATORS; k++) HOLD(z[k] > 0.0 && isfinite(z[k]));
}

/* Model Exchange with a simple integrator against Co-Simulation with many segments. */
static void exchange(const resources *r, int version) {
    settings s = random_settings(r);
    s.value[LOADING_SEGMENTS] = 400;
    s.value[UNLOADING_SEGMENTS] = 800;
    s.value[INITIAL_GAP] = fmin(s.value[INITIAL_GAP], 2e-6);
    unit lined = started(version, COSIMULATION, r, &s, 0.0);
    march m = core_march(&lined);
    forward(&lined, m.end, NULL);
    unit made = started(version, EXCHANGE, r, &s, 0.0), *u = &made;
    double x[NORMAL_STATES], nominals[NORMAL_STATES];
    after_event(u);
    HOLD(get_nominals(u, nominals, NORMAL_STATES) == GOOD);
    for (int k = 0; k < NORMAL_STATES; k++) HOLD(nominals[k] > 0.0 && isfinite(nominals[k]));
    HOLD(get_states(u, x, NORMAL_STATES) == GOOD);
    double h = m.end / 4000.0, time = 0.0;
    int events = 0, damped = r->data.curve.stage[0].damped;
    while (time < m.end) {
        double y[NORMAL_STATES];
        double step = fmin(h, m.end - time);
        if (damped && time >= m.touch) step = fmin(step, fmax(0.02 * (time - m.touch), 1e-6 * h)); /* the force may begin like a root */
        runge_kutta(u, time, x, step, y);
        if (due(u, time + step, y)) {
            double low = 0.0, high = step;
            for (int k = 0; k < 60 && high - low > 1e-15 * m.end; k++) {
                double middle = 0.5 * (low + high);
                runge_kutta(u, time, x, middle, y);
                if (due(u, time + middle, y)) high = middle;
                else low = middle;
            }
            runge_kutta(u, time, x, high, y);
            HOLD(due(u, time + high, y));
            time += high;
            memcpy(x, y, sizeof x);
            handle(u);
            HOLD(get_states(u, y, NORMAL_STATES) == GOOD && memcmp(x, y, sizeof x) == 0);
            after_event(u);
            HOLD(++events < 100);
        } else {
            time += step;
            memcpy(x, y, sizeof x);
            HOLD(set_time(u, time) == GOOD && set_states(u, x, NORMAL_STATES) == GOOD);
        }
    }
    for (unsigned k = PHASE; k <= LAST_EVENT; k++) HOLD(get(u, k) == get(&lined, k));
    for (unsigned k = 0; k <= PERMANENT_INDENTATION; k++) {
        if (VARIABLE[k].type != REAL || VARIABLE[k].role[IMPACT] != OUTPUT) continue;
        if (k >= KINETIC_ENERGY && k <= TIME_OF_LAST_SLIDING_EVENT) continue; /* of the steps of Co-Simulation */
        int motion = k < PHASE && k != TIME;
        double scale = k == MAXIMUM_INDENTATION || k == PERMANENT_INDENTATION ? m.largest[INDENTATION]
                       : k == REBOUND_VELOCITY                                ? m.largest[IMPACTOR_VELOCITY]
                       : k == MAXIMUM_FORCE                                   ? m.largest[CONTACT_FORCE]
                                                                              : m.end;
        snprintf(detail, sizeof detail, "%s", VARIABLE[k].name);
        NEAR(get(u, k), get(&lined, k), motion ? m.largest[k] : scale,
             r->data.linearisation == FILM_CHORD ? TRUE_CHORDS : TRUE_LAW);
        detail[0] = 0;
    }
    dispose(u);
    dispose(&lined);
}

/* ---------------------------------------------------------------- derivatives */

static const unsigned UNKNOWN[] = {INDENTATION, RELATIVE_VELOCITY, IMPACTOR_VELOCITY, IMPACTOR_DISPLACEMENT, TARGET_DISPLACEMENT,
                                   TARGET_VELOCITY, IMPACTOR_ACCELERATION, CONTACT_FORCE};
static const unsigned KNOWN[] = {INDENTATION, IMPACTOR_VELOCITY, TARGET_DISPLACEMENT, EXTERNAL_FORCE, SUPPORT_VELOCITY};
enum { UNKNOWNS = 8, KNOWNS = 5 };

static void move_known(unit *u, unsigned known, double by, const double x[NORMAL_STATES], double input) {
    double y[NORMAL_STATES];
    memcpy(y, x, sizeof y);
    for (unsigned k = 0; k < NORMAL_STATES; k++)
        if (KNOWN[k] == known) y[k] += by;
    if (known == EXTERNAL_FORCE || known == SUPPORT_VELOCITY) HOLD(set(u, known, input + by) == GOOD);
    HOLD(set_states(u, y, NORMAL_STATES) == GOOD);
}

static void derivatives_here(unit *u) {
    double x[NORMAL_STATES], full[UNKNOWNS][KNOWNS], size[UNKNOWNS] = {0.0};
    const model_memory *now = &inside(u)->memory;
    const double typical[KNOWNS] = {now->length, now->velocity, now->length, now->force, now->velocity};
    HOLD(get_states(u, x, NORMAL_STATES) == GOOD);
    for (unsigned k = 0; k < KNOWNS; k++) {
        double one = 1.0;
        for (unsigned i = 0; i < UNKNOWNS; i++) {
            HOLD(derivative(u, &UNKNOWN[i], 1, &KNOWN[k], 1, &one, &full[i][k]) == GOOD);
            size[i] = fmax(size[i], fabs(full[i][k]) * typical[k]);
        }
    }
    for (unsigned k = 0; k < KNOWNS; k++) {
        double by = 1e-5 * typical[k], input = KNOWN[k] >= EXTERNAL_FORCE && KNOWN[k] < INDENTATION ? get(u, KNOWN[k]) : 0.0;
        for (unsigned i = 0; i < UNKNOWNS; i++) {
            move_known(u, KNOWN[k], by, x, input);
            double more = get(u, UNKNOWN[i]);
            move_known(u, KNOWN[k], -by, x, input);
            double less = get(u, UNKNOWN[i]);
            move_known(u, KNOWN[k], 0.0, x, input);
            snprintf(detail, sizeof detail, "%s by %s", VARIABLE[UNKNOWN[i]].name, VARIABLE[KNOWN[k]].name);
            NEAR((more - less) / (2.0 * by) * typical[k], full[i][k] * typical[k],
                 size[i] + 1e-5 * (fabs(more) + fabs(less)), DIFFERENCES);
            detail[0] = 0;
        }
    }
    double seeds[UNKNOWNS], forward_by[UNKNOWNS], back[KNOWNS];
    for (int k = 0; k < UNKNOWNS; k++) seeds[k] = uniform(-1.0, 1.0);
    HOLD(derivative(u, UNKNOWN, UNKNOWNS, KNOWN, KNOWNS, seeds, forward_by) == GOOD);
    for (int i = 0; i < UNKNOWNS; i++) {
        double sum = 0.0;
        for (int k = 0; k < KNOWNS; k++) sum += full[i][k] * seeds[k];
        HOLD(forward_by[i] == sum);
    }
    if (u->version == 2) return;
    HOLD(fmi3GetAdjointDerivative(u->c, UNKNOWN, UNKNOWNS, KNOWN, KNOWNS, seeds, UNKNOWNS, back, KNOWNS) == fmi3OK);
    for (int k = 0; k < KNOWNS; k++) {
        double sum = 0.0;
        for (int i = 0; i < UNKNOWNS; i++) sum += full[i][k] * seeds[i];
        HOLD(back[k] == sum);
    }
}

/* In loading, unloading and reloading. */
static void derivatives(const resources *r, int version) {
    settings s = random_settings(r);
    s.value[INITIAL_GAP] = 0.0;
    unit lined = started(version, COSIMULATION, r, &s, 0.0);
    march m = core_march(&lined);
    dispose(&lined);
    unit made = started(version, EXCHANGE, r, &s, 0.0), *u = &made;
    double x[NORMAL_STATES], time = 0.0, h = m.end / 400.0;
    HOLD(get_states(u, x, NORMAL_STATES) == GOOD);
    for (int k = 0; k < 390; k++) {
        double y[NORMAL_STATES];
        runge_kutta(u, time, x, h, y);
        time += h;
        memcpy(x, y, sizeof x);
        if (due(u, time, x)) handle(u);
        const model_memory *now = &inside(u)->memory;
        double from_edge = 1.0;
        for (int32_t i = 0; i < r->data.curve.stages; i++)
            from_edge = fmin(from_edge, fabs(now->states[0] / now->length - r->data.curve.stage[i].begin));
        if (now->state.branch == FILM_BRANCH) from_edge = fmin(from_edge, fabs(now->states[0] / now->length - now->state.xi_free));
        if (k % 13 == 0 && from_edge > SINGULAR) derivatives_here(u);
    }
    dispose(u);
}

#endif
