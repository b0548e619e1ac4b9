/* The FMU runtime without an importer: what must hold for every FMU, through the functions of FMI 2.0 and 3.0, against the
 * core itself and against each other. Arguments: folders of resources (see tests/fmu_resources.py), as absolute paths.
 *
 *     cc -std=c99 -O1 -g -fsanitize=address,undefined -ffp-contract=off -Wl,--wrap=malloc,--wrap=calloc,--wrap=free
 *        -I film_model/core -I fmu_wrapper/runtime -isystem FMI_HEADERS tests/fmu_check.c film_model/core/film_core.c
 *        fmu_wrapper/runtime/{model,resource,instance,fmi2,fmi3}.c -lm
 *
 * Prints one line; exits with 1 after saying what does not hold. */
#include "fmu_driver.h"

static const double EXACT = 1e-12;        /* of the largest value of its kind: rounding */
static const double TRUE_LAW = 1e-6;      /* fine lines against the true law under Runge-Kutta */
static const double TRUE_CHORDS = 1e-5;   /* ... of chords, whose error is of second order */
static const double DIFFERENCES = 2e-6;   /* finite differences */
static const double SINGULAR = 1e-3;      /* of the scale: next to a law's root its slope changes too fast to be sought */

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

/* ---------------------------------------------------------------- parameters, and the march by the core alone */

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

/* Ready to step. */
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
    double touch, end; /* s: first touch, and how long the recorded lines hold */
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

/* The first contact of a unit that is ready to step, by the core alone. */
static march core_march(unit *u) {
    const model *m = inside(u);
    const model_memory *now = &m->memory;
    march found;
    film_state s;
    memset(&found, 0, sizeof found);
    HOLD(film_init(&m->data->curve, &s, -now->value[INITIAL_GAP] / now->length, now->value[INITIAL_VELOCITY] / now->velocity,
                   now->state.gamma, now->value[MASS] * now->value[GRAVITY] / now->force, 0.0) == FILM_OK);
    HOLD(film_damp(&s, now->state.damper) == FILM_OK);
    HOLD(film_record(&m->data->curve, &m->mesh, &s, 1e4, lines, LINE_ROOM, &found.lines, met, EVENT_ROOM, &found.events) ==
         FILM_EVENT);
    found.touch = met[0].time * now->tick;
    found.end = found.touch + 1.3 * (s.time * now->tick - found.touch);
    for (int k = 0; k <= 400; k++) {
        double values[VARIABLES], time = found.end / now->tick * k / 400.0;
        int32_t at = 0;
        while (at + 1 < found.lines && lines[at + 1].time <= time) at++;
        values_of(u, &lines[at], time - lines[at].time, values);
        for (int i = 0; i < MOTIONS; i++) found.largest[MOTION[i]] = fmax(found.largest[MOTION[i]], fabs(values[MOTION[i]]));
    }
    for (int i = 0; i < MOTIONS; i++)
        if (found.largest[MOTION[i]] == 0.0) found.largest[MOTION[i]] = 1e-300; /* a target that stays */
    return found;
}

static void compare_with_lines(unit *u, const march *m) {
    double values[VARIABLES], time = u->now / inside(u)->memory.tick;
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

/* What is known of the contact when it has ended. */
static void compare_with_events(unit *u, const march *m) {
    const model_memory *now = &inside(u)->memory;
    double expected[VARIABLES], scale[VARIABLES];
    int stops = 0;
    memset(expected, 0, sizeof expected);
    for (int32_t k = 0; k < m->events; k++) {
        const film_state *s = &met[k];
        double time = s->time * now->tick;
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
    for (unsigned k = TIME_OF_LAST_EVENT; k < EVENT_INDICATOR_1; k++) {
        snprintf(detail, sizeof detail, "%s", VARIABLE[k].name);
        NEAR(get(u, k), expected[k], scale[k], EXACT);
    }
    detail[0] = 0;
    HOLD(get(u, EVENT_COUNT) == m->events && get(u, CONTACT_COUNT) == 1 && get(u, LAST_EVENT) == FILM_CONTACT_ENDS);
    HOLD(get(u, PHASE) == FILM_SEPARATED && get(u, STAGE) == FILM_FREE);
}

/* ---------------------------------------------------------------- steps: to a communication point, whatever comes */

static void handle(unit *u) {
    HOLD(enter_event_mode(u) == GOOD);
    HOLD(update(u) == GOOD);
    HOLD(leave_event_mode(u) == GOOD);
}

static long early_returns = 0;

/* Forward by `size`; the events on the way are handled, and their times noted in `times` if it is there. */
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
            int passed = (int)get(u, EVENT_COUNT) - before; /* none: an input has turned the motion round */
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
    const double sizes[] = {1e-6, 7.3e-6, m.end, 0.0}; /* the last: any */
    dispose(&first);
    for (int k = 0; k < 4; k++) {
        unit made = started(version, interface, r, &s, 0.0), *u = &made;
        double times[EVENT_ROOM];
        int events = interface == EARLY_RETURN ? (int)get(u, EVENT_COUNT) : 0, before = events;
        double left = m.end, flight = 0.99 * m.touch;
        if (flight > 1e-3) forward(u, flight, NULL); /* not in millions of steps */
        for (left -= u->now; left > 0.0; left = m.end - u->now) {
            double size = sizes[k] > 0.0 ? sizes[k] : m.end * over_decades(1e-4, 1.0);
            events += forward(u, size < left ? size : left, times + events);
            compare_with_lines(u, &m);
        }
        compare_with_events(u, &m);
        if (interface == EARLY_RETURN) {
            HOLD(events == m.events);
            for (int e = before; e < events; e++) NEAR(times[e], met[e].time * inside(u)->memory.tick, m.end, EXACT);
        }
        HOLD(terminate(u) == GOOD);
        HOLD(get(u, CONTACT_COUNT) == 1);
        dispose(u);
    }
}

/* ---------------------------------------------------------------- histories that must repeat to the last bit */

/* One random step of any unit, its outputs after it in `values`. */
static void random_step(unit *u, double typical, double values[VARIABLES]) {
    const model_data *data = &u->from->data;
    double size = typical * over_decades(1e-3, 1.0);
    if (data->kind == IMPACT && whole(0, 3) == 0) {
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
            HOLD(get_states(u, x, STATES) == GOOD && get_rates(u, rates, STATES) == GOOD);
            for (int k = 0; k < STATES; k++) x[k] += 0.02 * size * rates[k];
            HOLD(set_states(u, x, STATES) == GOOD);
        }
        u->now += 0.02 * size;
        HOLD(set_time(u, u->now) == GOOD);
        HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
        for (int k = 0; k < FILM_INDICATORS; k++) due |= z[k] <= 0.0;
        if (due) handle(u);
    } else {
        if (data->kind == CONTACT) {
            HOLD(set(u, INDENTATION, data->length_scale * uniform(-1.0, 3.0)) == GOOD);
            HOLD(set(u, RELATIVE_VELOCITY, uniform(-1.0, 1.0) * data->length_scale / typical) == GOOD);
        }
        forward(u, size, NULL);
    }
    get_all(u, values);
}

/* How long a contact lasts, about; for the contact alone, of a unit that has no mass, anything. */
static double typical_time(const resources *r) {
    if (r->data.kind == CONTACT) return 1e-4;
    unit u = started(3, COSIMULATION, r, NULL, 0.0);
    march m = core_march(&u);
    dispose(&u);
    return (m.end - m.touch) / 1.3;
}

enum { REDONE = 4 };

static void rollback(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    double typical = typical_time(r), first[REDONE][VARIABLES], again[REDONE][VARIABLES], flight;
    unit made = started(version, interface, r, &s, 0.0), *u = &made;
    flight = r->data.kind == IMPACT && interface != EXCHANGE ? core_march(u).touch : 0.0;
    void *saved = NULL;
    for (int k = 0; k < ROLLBACKS; k++) {
        if (k % 25 == 0) { /* a new start, or it would stay in one place */
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

/* Two units step by step in turn, each as if it were alone; and a unit that was reset as if it were new. */
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

/* A state belongs to one FMU, and to one kind of instance of it; and it leaves alone the pointer it is made in. */
static void foreign_states(const resources *r, const resources *another) {
    size_t size = 0;
    void *saved = NULL, *taken = &size;
    unit donor = make(3, COSIMULATION, r);
    HOLD(save(&donor, &saved) == GOOD && saved_size(&donor, saved, &size) == GOOD);
    unsigned char *bytes = malloc(size);
    HOLD(bytes && serialize(&donor, saved, bytes, size) == GOOD);
    unit other[] = {make(3, EXCHANGE, r), make(3, WITH_EVENTS, r), make(3, EXCHANGE, another), make(2, COSIMULATION, r)};
    for (int k = 0; k < 4; k++) {
        if (!other[k].c) continue; /* the contact has no event mode */
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

/* A reset unit is a new one: the bytes of their saved states are the same. */
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
    int damps_alike = fabs(damper - other_damper) <= EXACT * damper; /* a given viscosity brings a time of its own */
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

/* A law that its lines are exact for, however many. */
static int straight(const resources *r) {
    const film_piece *piece = &r->data.curve.piece[0];
    return r->data.curve.pieces == 1 && piece->force.form == FILM_POWER && piece->force.coefficient == 0.0 &&
           piece->damping.coefficient == 0.0;
}

/* Each one counts, up to the end of Initialization Mode and not after. */
static void parameters(const resources *r, int version) {
    double typical = typical_time(r), usual[VARIABLES], changed[VARIABLES];
    double steps = r->data.kind == IMPACT && r->data.start[INITIAL_GAP] > 1e-5 ? 1e-2 : 1.1 * typical;
    for (unsigned k = 0; k < SETTABLE; k++) {
        if (!has(r, k) || VARIABLE[k].role[r->data.kind] != PARAMETER) continue;
        if ((k == LOADING_SEGMENTS || k == UNLOADING_SEGMENTS) && straight(r)) continue;
        for (int late = 0; late < 2; late++) {
            unit made = started(version, COSIMULATION, r, NULL, 0.0), *u = &made;
            double value = r->data.start[k], other = value * (VARIABLE[k].type == WHOLE ? 2.0 : 0.9) + (k == GRAVITY ? 1e3 : 0.0);
            if (k == INITIAL_GAP) other += 1e-6;
            if (k == TARGET_IMPEDANCE && value >= RIGID) other = 3e3;
            for (int change = 0; change < 2; change++) {
                double *values = change ? changed : usual;
                HOLD(reset(u) == GOOD);
                HOLD(get(u, k) == value);
                if (!late) HOLD(set(u, k, change ? other : value) == GOOD);
                HOLD(enter_initialization(u, 0.0) == GOOD);
                get(u, CONTACT_FORCE); /* taking it over early is no excuse */
                if (late) HOLD(set(u, k, change ? other : value) == GOOD);
                HOLD(get(u, k) == (change ? other : value));
                HOLD(exit_initialization(u) == GOOD);
                if (r->data.kind == CONTACT) {
                    HOLD(set(u, INDENTATION, 2.5 * r->data.length_scale) == GOOD && set(u, RELATIVE_VELOCITY, 0.0) == GOOD);
                }
                forward(u, steps, NULL);
                get_all(u, values);
                HOLD(set(u, k, value) == ERROR && strstr(last_message, VARIABLE[k].name));
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
    for (int k = 0;; k++) { /* where memory ends */
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
    if (r->data.kind == CONTACT) return;
    settings s = random_settings(r);
    s.value[LOADING_SEGMENTS] = s.value[UNLOADING_SEGMENTS] = 100.0;
    unit fine = started(3, COSIMULATION, r, &s, 0.0), coarse = started(3, COSIMULATION, r, NULL, 0.0);
    void *saved = NULL;
    stepped how;
    HOLD(save(&fine, &saved) == GOOD);
    until_none = 0;
    HOLD(restore(&coarse, saved) == ERROR); /* whose nodes have no room */
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

static void rates_at(unit *u, double time, const double x[STATES], double rates[STATES]) {
    HOLD(set_time(u, time) == GOOD && set_states(u, x, STATES) == GOOD && get_rates(u, rates, STATES) == GOOD);
}

/* One Runge-Kutta step from x over h, to y. */
static void runge_kutta(unit *u, double time, const double x[STATES], double h, double y[STATES]) {
    double k[4][STATES], z[STATES];
    rates_at(u, time, x, k[0]);
    for (int i = 0; i < STATES; i++) z[i] = x[i] + 0.5 * h * k[0][i];
    rates_at(u, time + 0.5 * h, z, k[1]);
    for (int i = 0; i < STATES; i++) z[i] = x[i] + 0.5 * h * k[1][i];
    rates_at(u, time + 0.5 * h, z, k[2]);
    for (int i = 0; i < STATES; i++) z[i] = x[i] + h * k[2][i];
    rates_at(u, time + h, z, k[3]);
    for (int i = 0; i < STATES; i++) y[i] = x[i] + h / 6.0 * (k[0][i] + 2.0 * k[1][i] + 2.0 * k[2][i] + k[3][i]);
}

static int due(unit *u, double time, const double x[STATES]) {
    double z[FILM_INDICATORS];
    int any = 0;
    HOLD(set_time(u, time) == GOOD && set_states(u, x, STATES) == GOOD);
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

/* A simple importer against Co-Simulation with fine lines. */
static void exchange(const resources *r, int version) {
    settings s = random_settings(r);
    s.value[LOADING_SEGMENTS] = 400;
    s.value[UNLOADING_SEGMENTS] = 800;
    s.value[INITIAL_GAP] = fmin(s.value[INITIAL_GAP], 2e-6);
    unit lined = started(version, COSIMULATION, r, &s, 0.0);
    march m = core_march(&lined);
    forward(&lined, m.end, NULL);
    unit made = started(version, EXCHANGE, r, &s, 0.0), *u = &made;
    double x[STATES], nominals[STATES];
    after_event(u);
    HOLD(get_nominals(u, nominals, STATES) == GOOD);
    for (int k = 0; k < STATES; k++) HOLD(nominals[k] > 0.0 && isfinite(nominals[k]));
    HOLD(get_states(u, x, STATES) == GOOD);
    double h = m.end / 4000.0, time = 0.0;
    int events = 0, damped = r->data.curve.stage[0].damped;
    while (time < m.end) {
        double y[STATES];
        double step = fmin(h, m.end - time);
        if (damped && time >= m.touch) step = fmin(step, fmax(0.02 * (time - m.touch), 1e-6 * h)); /* its force may begin as a root */
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
            HOLD(get_states(u, y, STATES) == GOOD && memcmp(x, y, sizeof x) == 0);
            after_event(u);
            HOLD(++events < 100);
        } else {
            time += step;
            memcpy(x, y, sizeof x);
            HOLD(set_time(u, time) == GOOD && set_states(u, x, STATES) == GOOD);
        }
    }
    for (unsigned k = PHASE; k <= LAST_EVENT; k++) HOLD(get(u, k) == get(&lined, k));
    for (unsigned k = 0; k < EVENT_INDICATOR_1; k++) {
        if (VARIABLE[k].type != REAL || VARIABLE[k].role[IMPACT] != OUTPUT) continue;
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

static void move_known(unit *u, unsigned known, double by, const double x[STATES], double input) {
    double y[STATES];
    memcpy(y, x, sizeof y);
    for (unsigned k = 0; k < STATES; k++)
        if (KNOWN[k] == known) y[k] += by;
    if (known == EXTERNAL_FORCE || known == SUPPORT_VELOCITY) HOLD(set(u, known, input + by) == GOOD);
    HOLD(set_states(u, y, STATES) == GOOD);
}

static void derivatives_here(unit *u) {
    double x[STATES], full[UNKNOWNS][KNOWNS], size[UNKNOWNS] = {0.0};
    const model_memory *now = &inside(u)->memory;
    const double typical[KNOWNS] = {now->length, now->velocity, now->length, now->force, now->velocity};
    HOLD(get_states(u, x, STATES) == GOOD);
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

/* Everywhere in a contact: loading, unloading, loading again. */
static void derivatives(const resources *r, int version) {
    settings s = random_settings(r);
    s.value[INITIAL_GAP] = 0.0;
    unit lined = started(version, COSIMULATION, r, &s, 0.0);
    march m = core_march(&lined);
    dispose(&lined);
    unit made = started(version, EXCHANGE, r, &s, 0.0), *u = &made;
    double x[STATES], time = 0.0, h = m.end / 400.0;
    HOLD(get_states(u, x, STATES) == GOOD);
    for (int k = 0; k < 390; k++) {
        double y[STATES];
        runge_kutta(u, time, x, h, y);
        time += h;
        memcpy(x, y, sizeof x);
        if (due(u, time, x)) handle(u);
        const model_memory *now = &inside(u)->memory;
        double from_edge = 1.0;
        for (int32_t i = 0; i < r->data.curve.stages; i++)
            from_edge = fmin(from_edge, fabs(now->at[0] / now->length - r->data.curve.stage[i].begin));
        if (now->state.branch == FILM_BRANCH) from_edge = fmin(from_edge, fabs(now->at[0] / now->length - now->state.xi_free));
        if (k % 13 == 0 && from_edge > SINGULAR) derivatives_here(u);
    }
    dispose(u);
}

/* ---------------------------------------------------------------- the contact alone */

/* A law's c, which all laws of this check write as a power. */
static double law_damping(const resources *r, double xi) {
    const film_function *c = &r->data.curve.piece[0].damping;
    if (!r->data.curve.stage[0].damped) return 0.0;
    HOLD(c->form == FILM_POWER && c->slope == 0.0 && c->origin == 0.0);
    return c->constant + (c->coefficient == 0.0 ? 0.0 : c->coefficient * pow(xi, c->exponent));
}

/* In along a line, out along a line: at any step the same force, and on the way in the law's. */
static void contact_at_any_step(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    unit first = started(version, interface, r, &s, 0.0);
    const model_memory *m = &inside(&first)->memory;
    double length = m->length, scale_force = m->force, found[2 * SAMPLES + 1], peak = length * uniform(0.5, 4.0);
    double damper = m->state.damper, lasts = r->data.curve.stage[0].damped ? 1e-5 : 1.0; /* so that its rate tells */
    dispose(&first);
    for (int parts = 1; parts <= 7; parts += 3) {
        double largest = 0.0;
        unit made = started(version, interface, r, &s, 0.0), *u = &made;
        for (int k = 0; k <= 2 * SAMPLES * parts; k++) {
            double along = (double)k / (SAMPLES * parts), out = along > 1.0 ? along - 1.0 : 0.0;
            double depth = along <= 1.0 ? peak * along : peak * (1.0 - 1.1 * out);
            double rate = along < 1.0 ? 1.0 : -1.1; /* of peak over `lasts` */
            if (k == SAMPLES * parts) rate = interface == EXCHANGE ? -1e-6 : 0.0; /* or the path between would go deeper */
            if (interface == EXCHANGE) {
                HOLD(set_time(u, along * lasts) == GOOD);
                HOLD(set(u, INDENTATION, depth) == GOOD && set(u, RELATIVE_VELOCITY, rate * peak / lasts) == GOOD);
                double z[FILM_INDICATORS];
                HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
                if (z[0] <= 0.0 || z[1] <= 0.0 || z[2] <= 0.0 || z[3] <= 0.0) {
                    handle(u);
                    after_event(u);
                }
                HOLD(completed_step(u) == GOOD);
            } else {
                if (k > 0) forward(u, lasts / (SAMPLES * parts), NULL);
                HOLD(set(u, INDENTATION, depth) == GOOD && set(u, RELATIVE_VELOCITY, rate * peak / lasts) == GOOD);
            }
            double force = get(u, CONTACT_FORCE), expected, work, *known = &found[k / parts];
            largest = fmax(largest, force);
            if (k % parts) continue;
            HOLD(force >= 0.0);
            if (along <= 1.0 && along > 0.0) {
                int32_t stage = 0;
                while (stage + 1 < r->data.curve.stages && depth / length > r->data.curve.stage[stage].end) stage++;
                film_law(&r->data.curve, stage, depth / length, &expected, &work);
                expected = fmax(expected + damper * law_damping(r, depth / length) * get(u, RELATIVE_VELOCITY) / length, 0.0);
                NEAR(force, expected * scale_force, force, EXACT);
            }
            if (parts > 1) NEAR(force, *known, largest, 1e-9 > EXACT && along > 1.0 ? 1e-11 : EXACT);
            *known = force;
        }
        HOLD(get(u, CONTACT_FORCE) == 0.0);
        if (interface == EXCHANGE) handle(u);
        else forward(u, lasts, NULL);
        NEAR(get(u, MAXIMUM_INDENTATION), peak, peak, EXACT);
        NEAR(get(u, MAXIMUM_FORCE), largest, largest, EXACT);
        HOLD(get(u, CONTACT_COUNT) == 1.0 && get(u, PHASE) == FILM_SEPARATED);
        dispose(u);
    }
}

/* The deepest point between two communication points is that of the cubic through them. */
static void contact_peak(const resources *r, int version) {
    for (int k = 0; k < 200; k++) {
        unit made = started(version, COSIMULATION, r, NULL, 0.0), *u = &made;
        double h = over_decades(1e-6, 1.0), a = r->data.length_scale * uniform(0.1, 3.0), b = a * uniform(0.3, 1.2);
        double rate_a = a / h * over_decades(0.01, 2.0), rate_b = -a / h * over_decades(0.01, 2.0), peak = fmax(a, b);
        HOLD(set(u, INDENTATION, a) == GOOD && set(u, RELATIVE_VELOCITY, rate_a) == GOOD);
        forward(u, h, NULL);
        HOLD(set(u, INDENTATION, b) == GOOD && set(u, RELATIVE_VELOCITY, rate_b) == GOOD);
        double tried = get(u, CONTACT_FORCE);
        HOLD(get(u, CONTACT_FORCE) == tried);
        forward(u, h, NULL);
        for (int i = 0; i <= 20000; i++) {
            double t = i / 20000.0, q = 1.0 - t;
            peak = fmax(peak, a * q * q * (1.0 + 2.0 * t) + b * t * t * (3.0 - 2.0 * t) + h * t * q * (rate_a * q - rate_b * t));
        }
        NEAR(get(u, MAXIMUM_INDENTATION), peak, peak, 1e-8);
        dispose(u);
    }
}

static void contact_derivative(const resources *r, int version, int interface) {
    unit made = started(version, interface, r, NULL, 0.0), *u = &made;
    for (int k = 0; k < 200; k++) {
        double depth = r->data.length_scale * uniform(0.05, 3.5), by = 1e-6 * depth, seeds[1] = {2.0}, slope;
        unsigned force = CONTACT_FORCE, indentation = INDENTATION;
        if (interface != EXCHANGE) { /* at rest there: the deepest point is no matter of what comes */
            HOLD(set(u, RELATIVE_VELOCITY, 0.0) == GOOD);
            forward(u, 1e-3, NULL);
        }
        HOLD(set(u, RELATIVE_VELOCITY, depth - get(u, INDENTATION)) == GOOD);
        if (interface == EXCHANGE) handle(u); /* turns where it is, if it turns */
        HOLD(set(u, INDENTATION, depth) == GOOD);
        if (interface == EXCHANGE) handle(u);
        HOLD(derivative(u, &force, 1, &indentation, 1, seeds, &slope) == GOOD);
        double at = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth + by) == GOOD);
        double more = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth - by) == GOOD);
        double less = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth) == GOOD);
        HOLD(get(u, CONTACT_FORCE) == at);
        snprintf(detail, sizeof detail, "%g N/m; at %g m: %g, %g, %g N", slope / 2.0, depth, less, at, more);
        double up = (more - at) / by, down = (at - less) / by, middle = 0.5 * (up + down); /* at a stage's end it has two */
        HOLD(fabs(slope / 2.0 - middle) <= 1e-5 * middle + 1e-6 || fabs(up - down) > 1e-2 * middle);
    }
    detail[0] = 0;
    dispose(u);
}

/* ---------------------------------------------------------------- all of it */

static void place_is(const char *check, const resources *r, int version, int interface) {
    static const char *const names[] = {"Co-Simulation", "event mode", "early return", "Model Exchange"};
    snprintf(where, sizeof where, "%s: FMI %d, %s, %.200s", check, version, names[interface], r->path);
}
#define CHECK(call, ...) (place_is(#call, __VA_ARGS__), call(__VA_ARGS__))

int main(int count, char **path) {
    resources *r = calloc((size_t)count, sizeof *r);
    lines = malloc(LINE_ROOM * sizeof *lines);
    met = malloc(EVENT_ROOM * sizeof *met);
    if (count < 2 || !r || !lines || !met) {
        printf("usage: fmu_check FOLDER...\n");
        return 2;
    }
    for (int k = 1; k < count; k++) open_resources(&r[k], path[k]);
    for (int k = 1; k < count; k++) {
        int impact = r[k].data.kind == IMPACT;
        for (int version = 2; version <= 3; version++) {
            for (int interface = COSIMULATION; interface < INTERFACES; interface++) {
                if ((version == 2 || !impact) && (interface == WITH_EVENTS || interface == EARLY_RETURN)) continue;
                if (impact && interface != EXCHANGE)
                    for (int i = 0; i < 3; i++) CHECK(at_any_step, &r[k], version, interface);
                if (!impact)
                    for (int i = 0; i < 10; i++) CHECK(contact_at_any_step, &r[k], version, interface);
                if (!impact) CHECK(contact_derivative, &r[k], version, interface);
                CHECK(rollback, &r[k], version, interface);
                CHECK(reset_is_new, &r[k], version, interface);
            }
            place_is("parameters", &r[k], version, COSIMULATION);
            parameters(&r[k], version);
            place_is("Model Exchange", &r[k], version, EXCHANGE);
            if (impact) exchange(&r[k], version);
            if (impact) derivatives(&r[k], version);
            place_is("scaling", &r[k], version, COSIMULATION);
            for (int i = 0; impact && i < 10; i++) scaling(&r[k], version, i % 2 ? 2.0 : uniform(0.2, 5.0), i % 2 ? 2.0 : uniform(0.5, 4.0));
            place_is("contact_peak", &r[k], version, COSIMULATION);
            if (!impact) contact_peak(&r[k], version);
        }
        place_is("cycles", &r[k], 3, COSIMULATION);
        cycles(&r[k]);
        for (int other = 1; other < count; other++) {
            place_is("no_cross_talk", &r[other], 2 + (k + other) % 2, COSIMULATION);
            if (other != k) foreign_states(&r[k], &r[other]);
            no_cross_talk(&r[k], 2 + k % 2, &r[other], 2 + (k + other) % 2);
        }
    }
    free(met);
    free(lines);
    free(r);
    printf("fmu_check: %d folders, %ld checks, %ld early returns\n", count - 1, checks, early_returns);
    return blocks == 0 ? 0 : 1;
}
