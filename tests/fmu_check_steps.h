/* Part of fmu_check.c: Co-Simulation at any step against the motion that the core computes. */
#ifndef FMU_CHECK_STEPS_H
#define FMU_CHECK_STEPS_H

#include "fmu_driver.h"

static const double EXACT = 1e-12;        /* of the largest value of its kind: rounding */
static const double TRUE_LAW = 1e-6;      /* many segments against the true law, integrated by Runge-Kutta */
static const double TRUE_CHORDS = 1e-5;   /* the same with chords, which are of second order */
static const double ON_MODES = 1e-9;      /* on a vibrating target, whose later contacts amplify rounding */
static const double DIFFERENCES = 2e-6;   /* finite differences */
static const double SINGULAR = 1e-3;      /* of the scale: near a law's root its slope changes too fast for finite differences */

enum { ROLLBACKS = 1000, CYCLES = 1000, LINE_ROOM = 20000, EVENT_ROOM = 200, SAMPLES = 40, MOST_VISITS = 1000 };

static void near(double a, double b, double scale, double tolerance, const char *what, int line) {
    checks++;
    if (fabs(a - b) <= tolerance * scale) return;
    printf("fmu_check.c:%d: %s: %.17g and %.17g differ by %.2e of %.3g\n    in %s %s\n", line, what, a, b, fabs(a - b) / scale,
           scale, where, detail);
    exit(1);
}
#define NEAR(a, b, scale, tolerance) near((a), (b), (scale), (tolerance), #a " = " #b, __LINE__)

static model *inside(unit *u) { return &((instance *)u->c)->model; }

/* ---------------------------------------------------------------- parameters, and reference motion from the core */

typedef struct {
    double value[SETTABLE];
} settings;

static settings random_settings(const resources *r) {
    settings s;
    memcpy(s.value, r->data.start, sizeof s.value);
    s.value[MASS] *= over_decades(0.5, 2.0);
    s.value[INITIAL_VELOCITY] *= over_decades(0.3, 1.3);
    for (int k = RADIUS; k <= YIELD_STRENGTH; k++)
        if (has(r, (unsigned)k)) s.value[k] *= over_decades(0.7, 1.4);
    if (s.value[TARGET_IMPEDANCE] < RIGID) s.value[TARGET_IMPEDANCE] *= over_decades(0.8, 3.0);
    s.value[LOADING_SEGMENTS] = whole(1, 40);
    s.value[UNLOADING_SEGMENTS] = whole(1, 40);
    return s;
}

static void apply(unit *u, const settings *s) {
    for (unsigned k = 0; k < SETTABLE; k++)
        if (has(u->from, k) && VARIABLE[k].role[u->from->data.kind] == PARAMETER) HOLD(set(u, k, s->value[k]) == GOOD);
}

/* A unit after initialization. */
static unit started(int version, int interface, const resources *from, const settings *s, double time) {
    unit made = make(version, interface, from), *u = &made;
    HOLD(u->c != NULL);
    if (s) apply(u, s);
    HOLD(enter_initialization(u, time) == GOOD);
    HOLD(exit_initialization(u) == GOOD);
    if (interface != COSIMULATION) {
        HOLD(update(u) == GOOD);
        HOLD(leave_event_mode(u) == GOOD);
    }
    return made;
}

static film_line *lines;
static film_state *met;

typedef struct {
    int32_t lines, events;
    double touch, end; /* s: first touch, end of the recorded lines */
    double largest[VARIABLES];
} march;

static void values_of(unit *u, const film_line *line, double tau, double values[VARIABLES]) {
    const model_memory *m = &inside(u)->memory;
    double raw[5];
    film_evaluate(&u->from->data.curve, line, tau, raw);
    memset(values, 0, VARIABLES * sizeof *values);
    values[INDENTATION] = raw[0] * m->length;
    values[RELATIVE_VELOCITY] = raw[1] * m->velocity;
    values[CONTACT_FORCE] = raw[2] * m->force;
    values[IMPACTOR_VELOCITY] = raw[3] * m->velocity;
    values[TARGET_DISPLACEMENT] = raw[4] * m->length;
    values[IMPACTOR_DISPLACEMENT] = (raw[0] + raw[4]) * m->length;
    values[TARGET_VELOCITY] = values[IMPACTOR_VELOCITY] - values[RELATIVE_VELOCITY];
    values[IMPACTOR_ACCELERATION] = m->value[GRAVITY] - values[CONTACT_FORCE] / m->value[MASS];
}
static const unsigned MOTION[] = {INDENTATION, RELATIVE_VELOCITY, CONTACT_FORCE, IMPACTOR_VELOCITY, TARGET_DISPLACEMENT,
                                  IMPACTOR_DISPLACEMENT, TARGET_VELOCITY, IMPACTOR_ACCELERATION};
enum { MOTIONS = sizeof MOTION / sizeof *MOTION };

/* The first contact of an initialized unit, computed with the core's functions. */
static march core_march(unit *u) {
    const model *m = inside(u);
    const model_memory *now = &m->memory;
    march found;
    film_state s;
    film_summary summary;
    memset(&found, 0, sizeof found);
    HOLD(film_init(&m->data->curve, &s, -now->value[INITIAL_GAP] / now->length, now->value[INITIAL_VELOCITY] / now->velocity,
                   now->state.gamma, now->value[MASS] * now->value[GRAVITY] / now->force, 0.0) == FILM_OK);
    HOLD(film_damp(&s, now->state.damper) == FILM_OK);
    HOLD(film_record(&m->data->curve, &m->mesh, &s, 1e4, lines, LINE_ROOM, &found.lines, met, EVENT_ROOM, &found.events, &summary) ==
         FILM_EVENT);
    found.touch = met[0].time * now->time_scale;
    found.end = found.touch + 1.3 * (s.time * now->time_scale - found.touch);
    for (int k = 0; k <= 400; k++) {
        double values[VARIABLES], time = found.end / now->time_scale * k / 400.0;
        int32_t at = 0;
        while (at + 1 < found.lines && lines[at + 1].time <= time) at++;
        values_of(u, &lines[at], time - lines[at].time, values);
        for (int i = 0; i < MOTIONS; i++) found.largest[MOTION[i]] = fmax(found.largest[MOTION[i]], fabs(values[MOTION[i]]));
    }
    for (int i = 0; i < MOTIONS; i++)
        if (found.largest[MOTION[i]] == 0.0) found.largest[MOTION[i]] = 1e-300; /* a fixed target */
    return found;
}

static void compare_with_lines(unit *u, const march *m) {
    double values[VARIABLES], time = u->now / inside(u)->memory.time_scale;
    int32_t at = 0;
    while (at + 1 < m->lines && lines[at + 1].time <= time) at++;
    values_of(u, &lines[at], time - lines[at].time, values);
    for (int i = 0; i < MOTIONS; i++) {
        snprintf(detail, sizeof detail, "%s at %g s", VARIABLE[MOTION[i]].name, u->now);
        NEAR(get(u, MOTION[i]), values[MOTION[i]], m->largest[MOTION[i]], EXACT);
    }
    detail[0] = 0;
    NEAR(get(u, TIME), u->now, m->end, EXACT);
}

/* Outputs after the end of the contact. */
static void compare_with_events(unit *u, const march *m) {
    const model_memory *now = &inside(u)->memory;
    double expected[VARIABLES], scale[VARIABLES];
    int stops = 0;
    memset(expected, 0, sizeof expected);
    for (int32_t k = 0; k < m->events; k++) {
        const film_state *s = &met[k];
        double time = s->time * now->time_scale;
        if (s->event == FILM_CONTACT_BEGINS) expected[TIME_CONTACT_BEGINS] = time;
        if (s->event == FILM_MAXIMUM_INDENTATION && s->xi * now->length > expected[MAXIMUM_INDENTATION]) {
            expected[TIME_OF_MAXIMUM_INDENTATION] = time;
            expected[MAXIMUM_INDENTATION] = s->xi * now->length;
        }
        if (s->event == FILM_IMPACTOR_STOPS && !stops++) expected[TIME_IMPACTOR_STOPS] = time;
        if (s->event == FILM_CONTACT_ENDS) {
            expected[TIME_CONTACT_ENDS] = expected[TIME_OF_LAST_EVENT] = time;
            expected[REBOUND_VELOCITY] = s->nu * now->velocity;
            expected[PERMANENT_INDENTATION] = s->xi_free * now->length;
            expected[MAXIMUM_FORCE] = s->force_peak * now->force;
        }
    }
    for (unsigned k = 0; k < VARIABLES; k++) scale[k] = m->end;
    scale[MAXIMUM_INDENTATION] = scale[PERMANENT_INDENTATION] = m->largest[INDENTATION];
    scale[REBOUND_VELOCITY] = m->largest[IMPACTOR_VELOCITY];
    scale[MAXIMUM_FORCE] = m->largest[CONTACT_FORCE];
    for (unsigned k = TIME_OF_LAST_EVENT; k <= PERMANENT_INDENTATION; k++) {
        snprintf(detail, sizeof detail, "%s", VARIABLE[k].name);
        NEAR(get(u, k), expected[k], scale[k], EXACT);
    }
    detail[0] = 0;
    HOLD(get(u, EVENT_COUNT) == m->events && get(u, CONTACT_COUNT) == 1 && get(u, LAST_EVENT) == FILM_CONTACT_ENDS);
    HOLD(get(u, PHASE) == FILM_SEPARATED && get(u, STAGE) == FILM_FREE);
}

/* ---------------------------------------------------------------- steps to a communication point, with all events */

static void handle(unit *u) {
    HOLD(enter_event_mode(u) == GOOD);
    HOLD(update(u) == GOOD);
    HOLD(leave_event_mode(u) == GOOD);
}

static long early_returns = 0;

/* Advance by `size` and handle the events on the way; their times go to `times` if it is not NULL. */
static int forward(unit *u, double size, double *times) {
    double end = u->now + size;
    int events = 0;
    for (int visits = 0;; visits++) {
        stepped how;
        int before = (int)get(u, u->from->data.kind == IMPACT ? EVENT_COUNT : CONTACT_COUNT), phase = (int)get(u, PHASE);
        HOLD(visits < MOST_VISITS);
        HOLD(do_step(u, u->now, end - u->now, &how) == GOOD);
        HOLD(u->interface != COSIMULATION || !how.event);
        HOLD(u->interface == EARLY_RETURN || how.time == u->now + (end - u->now));
        HOLD(how.early == (u->interface == EARLY_RETURN && how.event && how.time < u->now + (end - u->now)));
        early_returns += how.early;
        if (how.event) {
            HOLD((int)get(u, EVENT_COUNT) == before); /* outputs change in event mode */
            handle(u);
            int passed = (int)get(u, EVENT_COUNT) - before; /* 0 if an input has reversed the motion */
            HOLD(passed > 0 ? passed == 1 || u->interface != EARLY_RETURN : passed == 0 && (int)get(u, PHASE) != phase);
            if (u->interface == EARLY_RETURN && passed) HOLD(get(u, TIME_OF_LAST_EVENT) == how.time && get(u, TIME) == how.time);
            if (times) times[events] = get(u, TIME_OF_LAST_EVENT);
            events++;
        }
        u->now = how.time;
        if (u->interface != EARLY_RETURN || (!how.early && !how.event)) return events;
        if (!(end > u->now)) { /* an event at the communication point itself */
            u->now = end;
            return events;
        }
    }
}

static void at_any_step(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    unit first = started(version, interface, r, &s, 0.0);
    march m = core_march(&first);
    const double sizes[] = {1e-6, 7.3e-6, m.end, 0.0}; /* 0.0: random sizes */
    dispose(&first);
    for (int k = 0; k < 4; k++) {
        unit made = started(version, interface, r, &s, 0.0), *u = &made;
        double times[EVENT_ROOM];
        int events = interface == EARLY_RETURN ? (int)get(u, EVENT_COUNT) : 0, before = events;
        double left = m.end, flight = 0.99 * m.touch;
        if (flight > 1e-3) forward(u, flight, NULL); /* in one step, not in millions */
        for (left -= u->now; left > 0.0; left = m.end - u->now) {
            double size = sizes[k] > 0.0 ? sizes[k] : m.end * over_decades(1e-4, 1.0);
            events += forward(u, size < left ? size : left, times + events);
            compare_with_lines(u, &m);
        }
        compare_with_events(u, &m);
        if (interface == EARLY_RETURN) {
            HOLD(events == m.events);
            for (int e = before; e < events; e++) NEAR(times[e], met[e].time * inside(u)->memory.time_scale, m.end, EXACT);
        }
        HOLD(terminate(u) == GOOD);
        HOLD(get(u, CONTACT_COUNT) == 1);
        dispose(u);
    }
}

/* Where the march is not that of the curve alone: the same after steps of any size as after one, to rounding, with as many events; the energies add up. */
static void the_same_at_any_step(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    unit whole_ = started(version, interface, r, &s, 0.0), made = started(version, interface, r, &s, 0.0), *u = &made;
    double end = 12.0 * inside(u)->memory.time_scale, pull = s.value[GRAVITY] * s.value[MASS], largest = r->data.force_scale;
    double energy = get(u, KINETIC_ENERGY);
    forward(&whole_, end, NULL);
    while (end - u->now > 1e-9 * end) forward(u, fmin(end * over_decades(1e-4, 1.0), end - u->now), NULL);
    forward(u, fmax(end - u->now, 0.0), NULL);
    HOLD(get(u, EVENT_COUNT) == get(&whole_, EVENT_COUNT) && get(u, CONTACT_COUNT) >= 1.0);
    NEAR(get(u, TIME_OF_LAST_EVENT), get(&whole_, TIME_OF_LAST_EVENT), end, ON_MODES);
    NEAR(get(u, CONTACT_FORCE), get(&whole_, CONTACT_FORCE), largest, ON_MODES);
    NEAR(get(u, IMPACTOR_VELOCITY), get(&whole_, IMPACTOR_VELOCITY), inside(u)->memory.velocity, ON_MODES);
    NEAR(get(u, IMPACTOR_DISPLACEMENT), get(&whole_, IMPACTOR_DISPLACEMENT), inside(u)->memory.length, ON_MODES);
    double sum = get(u, KINETIC_ENERGY) + get(u, CONTACT_ENERGY) + get(u, TARGET_ENERGY) - get(u, EXTERNAL_WORK);
    NEAR(sum, energy, energy + fabs(pull * end), ON_MODES);
    if (!exchanges(r)) HOLD(make(version, EXCHANGE, r).c == NULL && strstr(last_message, "Co-Simulation"));
    dispose(&whole_);
    dispose(u);
}

#endif
