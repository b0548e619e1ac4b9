/* The core alone, without Python: thousands of pseudo-random impacts, what must hold in each of them, and one hash over
 * all results, which must not depend on how the compiler optimises. Builds with nothing but the core's sources:
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/core_check.c film_model/core/film_*.c -lm
 *
 * Prints one line with counts and the hash; exits with 1 after saying what does not hold. */
#include "film_core.h"
#include "film_line.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double EXACT = 1e-12;   /* agreement that only rounding disturbs, of the largest value of its kind */
static const double STEPS = 1e-9;    /* a schedule cut in steps: rounding, which bounces and slow motion multiply */
static const double SERIES_ROUNDING = 1e-8;
static const double LINES_MEET = 1e-8; /* where a line ends and the next begins */
static const double ENERGY = 1e-11;  /* balance of energy over a whole contact: the sum of some hundred roundings */

enum { RANDOM_IMPACTS = 3000, RANDOM_SCHEDULES = 1500, SEGMENTS_MOST = 24, LINE_ROOM = 4096, EVENT_ROOM = 256, SAMPLES = 60 };
enum { CURVES = 10, BATCH_CURVES = 14, PARTS = 6, BATCH = 500 };

/* ---------------------------------------------------------------- checking, hashing, random numbers */

static long checks = 0, contacts = 0, events_seen = 0;
static uint64_t hash = 14695981039346656037u;
static char where[200] = "";

static void hold(int condition, const char *what, int line) {
    checks++;
    if (condition) return;
    printf("core_check.c:%d: does not hold: %s\n    in %s\n", line, what, where);
    exit(1);
}
#define HOLD(condition) hold((condition), #condition, __LINE__)

static void near(double a, double b, double scale, double tolerance, const char *what, int line) {
    checks++;
    if (fabs(a - b) <= tolerance * scale) return;
    printf("core_check.c:%d: %s: %.17g and %.17g differ by %.2e of %.3g\n    in %s\n", line, what, a, b,
           fabs(a - b) / scale, scale, where);
    exit(1);
}
#define NEAR(a, b, scale, tolerance) near((a), (b), (scale), (tolerance), #a " = " #b, __LINE__)

static void stir(const void *bytes, size_t count) { /* FNV-1a */
    const unsigned char *byte = bytes;
    for (size_t i = 0; i < count; i++) hash = (hash ^ byte[i]) * 1099511628211u;
}

static void stir_number(double x) {
    uint64_t bits = 0x7ff8000000000000u; /* every NaN alike: its sign means nothing */
    if (x == x) memcpy(&bits, &x, sizeof bits);
    stir(&bits, sizeof bits);
}

static void stir_state(const film_state *s) {
    const double all[] = {s->time, s->time_low, s->xi, s->nu, s->shift, s->force, s->work, s->spent, s->force_peak,
                          s->xi_max, s->f_max, s->xi_free, s->recovery, s->exponent};
    const int32_t flags[] = {s->branch, s->stage_max, s->phase, s->event, s->contacts, s->lines};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) stir_number(all[i]);
    stir(flags, sizeof flags);
}

static void stir_summary(int status, const film_summary *s) {
    const double all[] = {s->maximum_force, s->maximum_indentation, s->time_of_maximum_indentation,
                          s->time_impactor_stops, s->contact_duration, s->permanent_indentation,
                          s->final_velocity, s->shift, s->work};
    const int32_t flags[] = {(int32_t)status, s->stage, s->lines};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) stir_number(all[i]);
    stir(flags, sizeof flags);
}

static uint64_t seed = 20170417;

static double uniform(double low, double high) { /* splitmix64 */
    seed += 0x9e3779b97f4a7c15u;
    uint64_t z = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return low + (high - low) * (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static int32_t whole(int32_t low, int32_t high) { /* both included */
    int32_t n = low + (int32_t)uniform(0.0, (double)(high - low + 1));
    return n > high ? high : n;
}

static double over_decades(double low, double high) { return low * pow(high / low, uniform(0.0, 1.0)); }

static void *room_for(size_t count, size_t size) {
    void *memory = malloc(count * size + (count == 0));
    if (memory == NULL) {
        printf("no memory\n");
        exit(2);
    }
    return memory;
}

/* ---------------------------------------------------------------- curves */

static film_function power(double origin, double constant, double slope, double coefficient, double exponent) {
    film_function g;
    memset(&g, 0, sizeof g);
    g.form = FILM_POWER;
    g.origin = origin;
    g.per_span = 1.0;
    g.constant = constant;
    g.slope = slope;
    g.coefficient = coefficient;
    g.exponent = exponent;
    return g;
}

static film_function series(int32_t form, double begin, double end, int32_t terms, const double *term) {
    film_function g = power(begin, 0.0, 0.0, 0.0, 1.0);
    g.form = form;
    g.per_span = 1.0 / (end - begin);
    g.terms = terms;
    for (int32_t k = 0; k < terms; k++) g.series[k] = term[k];
    return g;
}

/* A stage up to `end`, of one piece, that goes back the way it came. */
static film_piece *add_stage(film_curve *curve, double end, film_function force) {
    film_stage *stage = &curve->stage[curve->stages];
    stage->begin = curve->stages > 0 ? curve->stage[curve->stages - 1].end : 0.0;
    stage->end = end;
    stage->first = curve->pieces;
    stage->count = 1;
    curve->stages++;
    film_piece *piece = &curve->piece[curve->pieces++];
    piece->end = end;
    piece->force = force;
    piece->exponent = power(0.0, 1.5, 0.0, 0.0, 1.0);
    return piece;
}

static film_curve hertz_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, INFINITY, power(0.0, 0.0, 0.0, 1.0, 1.5));
    return curve;
}

/* Elastic, elastoplastic, linear: like Big-Alabo, Harrison & Cartmell's law; Hertz unloading with a larger radius. */
static film_curve elastoplastic_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    const double width = 12.93, edge = 1.0 + width;
    add_stage(&curve, 1.0, power(0.0, 0.0, 0.0, 1.0, 1.5));
    add_stage(&curve, edge, power(1.0, 1.0, 0.0, 1.0, 1.5))->recovery = power(1.0, 1.0, 0.0, pow(width, -1.5), 1.5);
    add_stage(&curve, INFINITY, power(edge, 1.0 + pow(width, 1.5), 5.4, 0.0, 1.0))->recovery =
        power(edge, 2.0, 0.01, 0.0, 1.0);
    curve.stage[1].unloading = curve.stage[2].unloading = FILM_RADIUS;
    return curve;
}

/* x^1.5 up to 1, as a series in the root; then 1 + (x - 1) + (x - 1)^2/4 in two pieces up to 3, where the law ends. A
 * contact that turns there leaves (x - 1)^2/4. */
static film_curve series_curve(void) {
    static const double root_force[] = {0.3125, 0.46875, 0.1875, 0.03125};
    static const double root_mean[] = {0.125, 0.1875, 0.075, 0.0125};
    static const double force[2][3] = {{1.59375, 0.625, 0.03125}, {3.09375, 0.875, 0.03125}};
    static const double mean[2][3] = {{1.28125, 7.0 / 24, 1.0 / 96}, {2.65625, 5.0 / 12, 1.0 / 96}};
    static const double residual[] = {0.375, 0.5, 0.125}, exponent[] = {1.4, 0.1};
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, series(FILM_ROOT_SERIES, 0.0, 1.0, 4, root_force))->mean =
        series(FILM_ROOT_SERIES, 0.0, 1.0, 4, root_mean);
    film_piece *piece = add_stage(&curve, 3.0, series(FILM_SERIES, 1.0, 2.0, 3, force[0]));
    piece->recovery = series(FILM_SERIES, 1.0, 3.0, 3, residual);
    piece->exponent = series(FILM_SERIES, 1.0, 3.0, 2, exponent);
    piece[1] = piece[0];
    piece[1].force = series(FILM_SERIES, 2.0, 3.0, 3, force[1]);
    piece[0].mean = series(FILM_SERIES, 1.0, 2.0, 3, mean[0]);
    piece[1].mean = series(FILM_SERIES, 2.0, 3.0, 3, mean[1]);
    piece[1].work_at_begin = -19.0 / 12.0;
    piece[0].end = 2.0;
    curve.stage[1].count = 2;
    curve.stage[1].unloading = FILM_RESIDUAL;
    curve.pieces = 3;
    return curve;
}

/* f = x; a contact that turned at x leaves LEFT_OVER x and opens along a line: every answer is known. */
static const double LEFT_OVER = 0.2, OVER_DAMPED = 1.78; /* gamma from which it creeps out: 2 sqrt(1 - LEFT_OVER) */

static film_curve linear_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 1.0, 0.0, 1.0));
    piece->recovery = power(0.0, 0.0, LEFT_OVER, 0.0, 1.0);
    piece->exponent = power(0.0, 1.0, 0.0, 0.0, 1.0);
    curve.stage[0].unloading = FILM_RESIDUAL;
    return curve;
}

/* Nothing up to 1, then (x - 1)^1.2, there and back. */
static film_curve clearance_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, power(0.0, 0.0, 0.0, 0.0, 1.5));
    add_stage(&curve, INFINITY, power(1.0, 0.0, 0.0, 1.0, 1.2));
    return curve;
}

/* x^1.5 all the way, which opens along another power. */
static film_curve dented_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 0.0, 1.0, 1.5));
    piece->recovery = power(0.0, 1.3, 0.0, 0.0, 1.0);
    piece->exponent = power(0.0, 1.2, 0.0, 0.0, 1.0);
    curve.stage[0].unloading = FILM_RADIUS;
    return curve;
}

/* Every term of a power at once, from first touch on and then from another origin; the branch and its exponent depend on
 * the depth. */
static film_curve varied_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, 2.0, power(0.0, 0.0, 0.3, 1.0, 1.3));
    piece->recovery = power(0.0, 0.0, 0.05, 0.02, 1.5);
    piece->exponent = power(0.0, 1.5, -0.1, 0.0, 1.0);
    piece = add_stage(&curve, INFINITY, power(1.0, 1.0, 0.5, 1.5, 2.0));
    double x = piece->force.origin, reach = curve.stage[1].begin - x;
    piece->work_at_begin = reach * (1.0 + 0.25 * reach + 0.5 * reach * reach);
    piece->recovery = power(0.0, 1.0, 0.1, 0.0, 1.0);
    piece->exponent = power(0.0, 1.4, 0.0, -0.05, 0.5);
    curve.stage[0].unloading = FILM_RESIDUAL;
    curve.stage[1].unloading = FILM_RADIUS;
    return curve;
}

/* Rises to 1 and falls again: the largest force is where the stages meet. */
static film_curve softening_curve(void) {
    static const double force[] = {0.875, -0.125}, mean[] = {0.9375, -0.0625};
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, power(0.0, 0.0, 1.0, 0.0, 1.0));
    add_stage(&curve, 3.0, series(FILM_SERIES, 1.0, 3.0, 2, force))->mean = series(FILM_SERIES, 1.0, 3.0, 2, mean);
    return curve;
}


/* x^1.5; a contact that turned at x leaves half of it, opens with the power 2.5 and closes again with 1.5. */
static film_curve laminate_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 0.0, 1.0, 1.5));
    piece->recovery = power(0.0, 0.0, 0.5, 0.0, 1.0);
    piece->exponent = power(0.0, 2.5, 0.0, 0.0, 1.0);
    curve.stage[0].unloading = FILM_RESIDUAL;
    curve.stage[0].reload_exponent = 1.5;
    return curve;
}

/* Elastic, then linear with the slope at yield; opens along the elastic curve, shifted down. Twice as deep, along a Hertz
 * curve of the contact radius reached. */
static film_curve shifted_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, power(0.0, 0.0, 0.0, 1.0, 1.5));
    add_stage(&curve, 4.0, power(1.0, 1.0, 1.5, 0.0, 1.0))->recovery = power(0.0, 1.0, 0.0, 0.0, 1.0);
    add_stage(&curve, INFINITY, power(4.0, 5.5, 1.5, 0.0, 1.0))->recovery = power(0.0, 0.0, 0.0, 1.0, 0.5);
    curve.stage[1].unloading = FILM_SHIFTED;
    curve.stage[2].unloading = FILM_SECANT;
    return curve;
}

/* A curve of powers in series with a spring. */
static film_curve sprung(film_curve curve) {
    const double c = 0.3;
    double force = 0.0, work;
    for (int32_t k = 0; k < curve.stages; k++) {
        double before = force, end = curve.stage[k].end;
        curve.piece[k].work_at_begin += 0.5 * c * before * before;
        curve.stage[k].begin += c * before;
        if (end < INFINITY) {
            film_law(&curve, k, end, &force, &work);
            curve.stage[k].end = curve.piece[k].end = end + c * force;
        }
    }
    curve.compliance = c;
    return curve;
}

/* A shifted branch ends with a slope 1.5 sqrt(xi_f), at most 2.04 here: 2/sqrt(slope). */
static const double SHIFTED_OVER_DAMPED = 1.4;

/* x^1.5 with damping in proportion to x^0.5: Kuwabara and Kono's. */
static film_curve damped_curve(void) {
    film_curve curve = hertz_curve();
    curve.piece[0].damping = power(0.0, 0.0, 0.0, 1.0, 0.5);
    curve.stage[0].damped = 1;
    return curve;
}

enum { HERTZ, ELASTOPLASTIC, SERIES, LINEAR, LAMINATE, SHIFTED, DAMPED, SPRUNG, SPRUNG_LAMINATE, SPRUNG_SHIFTED, CLEARANCE, DENTED, VARIED, SOFTENING };
static film_curve curves[BATCH_CURVES];
static const double work_rounding[CURVES] = {0.0, 0.0, 4e-15, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}; /* of a series: of its largest value, near 5 */

/* ---------------------------------------------------------------- meshes */

typedef struct {
    film_mesh mesh;
    double *memory;
} owned_mesh;

static owned_mesh make_mesh(int32_t linearisation, int32_t loading, int32_t unloading) {
    owned_mesh made;
    made.memory = room_for(film_mesh_size(loading, unloading), sizeof *made.memory);
    HOLD(film_mesh_init(&made.mesh, linearisation, loading, unloading, made.memory) == FILM_OK);
    for (int g = 0; g < FILM_GRADINGS; g++) {
        const double *nodes[] = {made.mesh.loading_nodes[g], made.mesh.unloading_nodes[g]};
        const int32_t counts[] = {loading, film_unloading(&made.mesh, g)};
        for (int k = 0; k < 2; k++) {
            if (nodes[k] == NULL) continue;
            HOLD(nodes[k][0] == 0.0 && nodes[k][counts[k]] == 1.0);
            for (int32_t i = 0; i < counts[k]; i++) HOLD(nodes[k][i] < nodes[k][i + 1]);
        }
    }
    return made;
}

/* ---------------------------------------------------------------- one contact, recorded */

static film_line *lines;
static film_state *events;

/* Along the lines of a record: each begins where the one before ends, and each does the work of the true law. */
static void check_lines(int which, const film_state *begin, int32_t count, int work_preserving) {
    const film_curve *curve = &curves[which];
    double depth = 0.0, speed = fabs(begin->nu), force = 0.0, moved = 0.0, values[5];
    for (int32_t i = 0; i < count; i++) {
        depth = fmax(depth, fabs(lines[i].xi));
        speed = fmax(speed, fabs(lines[i].nu));
        moved = fmax(moved, fabs(lines[i].shift));
    }
    for (int32_t i = 0; i + 1 < count; i++) {
        const film_line *line = &lines[i], *next = &lines[i + 1];
        double tau = next->time - line->time;
        HOLD(tau >= 0.0);
        double tolerance = which == SERIES ? SERIES_ROUNDING : EXACT; /* where a line turns is sought by its work */
        film_evaluate(curve, line, tau, values);
        /* tau is a difference of rounded times */
        double late = 4.0 * 2.3e-16 * next->time;
        force = fmax(force, values[2]);
        HOLD(values[2] >= -EXACT * force);
        double pull = fabs(line->phi) + fabs(line->kappa) * fabs(next->xi - line->xi) + fabs(line->load);
        if (next->nu == begin->stop_velocity) /* cut where nu is that, to a length known to 1e-13, and maybe slow there */
            late += 1e-13 * depth / fmax(fabs(values[1]), 1e-300);
        double bent = line->branch == FILM_FREE ? 0.0 : curve->compliance * values[2]; /* the spring's own */
        NEAR(values[0] + bent, next->xi, depth + late * (speed + line->gamma * pull) / EXACT, tolerance);
        if (fabs(values[1]) < 1e-7 * speed) tolerance = 1e-7; /* at a turn a speed of which the square is rounding is dropped */
        NEAR(values[3], next->nu, speed + late * pull / EXACT, tolerance);
        NEAR(values[4] - bent, next->shift, moved + line->gamma * (speed + late * pull / EXACT), tolerance);
        if (line->branch == FILM_FREE || next->branch == FILM_FREE || which == DAMPED) continue;
        if (!work_preserving || next->phase != line->phase || next->branch != line->branch) continue;
        double h = next->xi - line->xi, mean = line->phi + 0.5 * line->kappa * h;
        NEAR(mean * h, next->spent - line->spent, force * depth + work_rounding[which] / EXACT, EXACT);
        double before, after;
        if (line->branch < 0) continue;
        film_law(curve, line->branch, line->xi, &values[0], &before);
        film_law(curve, line->branch, next->xi, &values[0], &after);
        NEAR(after - before, next->spent - line->spent, force * depth + work_rounding[which] / EXACT, EXACT);
    }
}

/* Energy and momentum from the start of contact to s. Momentum: dnu = p dt - dshift/gamma, whatever the lines. Energy:
 * what is missing was radiated, and none can be radiated into a fixed target. */
static void check_balance(int which, const film_state *begin, const film_state *s, int work_preserving) {
    double energy = 0.5 * begin->nu * begin->nu, load = begin->load, t = s->time - begin->time;
    double scale = energy + fabs(load * s->xi) + fabs(load * s->shift) + fabs(s->spent) + work_rounding[which] / ENERGY;
    double missing = energy + load * (s->xi - begin->xi + s->shift - begin->shift) - 0.5 * s->nu * s->nu - s->spent;
    HOLD(isfinite(missing));
    if (work_preserving) HOLD(missing >= -ENERGY * scale);
    if (work_preserving && begin->gamma == 0.0) NEAR(missing, 0.0, scale, ENERGY);
    if (begin->gamma == 0.0) {
        HOLD(s->shift == 0.0);
    } else {
        double impulse = fabs(begin->nu) + fabs(s->nu) + fabs(load * t);
        NEAR(s->nu - begin->nu, load * t - (s->shift - begin->shift) / begin->gamma, impulse, EXACT);
    }
}

static void check_samples(const film_curve *curve, int32_t count, double end) {
    static double times[SAMPLES], values[5 * SAMPLES];
    static int8_t stages[SAMPLES], phases[SAMPLES];
    double alone[5];
    for (int i = 0; i < SAMPLES; i++) times[i] = 1.1 * end * i / (SAMPLES - 1);
    film_sample(curve, lines, count, times, SAMPLES, values, stages, phases);
    for (int i = 0; i < SAMPLES; i++) {
        int32_t k = 0;
        while (k + 1 < count && lines[k + 1].time <= times[i]) k++;
        film_evaluate(curve, &lines[k], times[i] - lines[k].time, alone);
        HOLD(memcmp(alone, values + 5 * i, sizeof alone) == 0);
        HOLD(stages[i] == lines[k].branch && phases[i] == lines[k].phase);
        for (int j = 0; j < 5; j++) {
            HOLD(isfinite(alone[j]));
            stir_number(alone[j]);
        }
    }
}

/* A record without enough room says so, and writes nothing beyond what it was given. */
static void check_little_room(const film_curve *curve, const film_mesh *mesh, const film_state *begin, double limit,
                              int32_t line_count, int32_t event_count) {
    int32_t short_of_lines = whole(0, line_count - 1), short_of_events = whole(0, event_count - 1), a, b;
    for (int k = 0; k < 2; k++) {
        int32_t line_room = k == 0 ? short_of_lines : line_count, event_room = k == 0 ? event_count : short_of_events;
        film_line *few = room_for((size_t)line_room, sizeof *few);
        film_state *some = room_for((size_t)event_room, sizeof *some), s = *begin;
        int status = film_record(curve, mesh, &s, limit, few, line_room, &a, some, event_room, &b);
        HOLD(a <= line_room && b <= event_room);
        HOLD(status == FILM_FULL || (k == 0 && a == line_room)); /* the flight that follows is left out */
        HOLD(memcmp(few, lines, (size_t)a * sizeof *few) == 0);
        HOLD(memcmp(some, events, (size_t)b * sizeof *some) == 0);
        free(few);
        free(some);
    }
}

/* The order in which things may happen, and what holds when they do. */
static void check_events(const film_curve *curve, int32_t count, const film_start *start) {
    double time = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const film_state *s = &events[i];
        double relative = s->nu - s->gamma * s->force, speed = fabs(s->nu) + s->gamma * s->force + start->nu, force, work;
        events_seen++;
        stir_state(s);
        HOLD(s->time >= time);
        HOLD((s->event == FILM_CONTACT_BEGINS) == (i == 0));
        HOLD(s->force >= 0.0 && s->force <= s->force_peak * (1.0 + EXACT));
        if (s->event == FILM_MAXIMUM_INDENTATION || s->event == FILM_RELOADING_BEGINS)
            NEAR(relative, 0.0, speed, 1e-8); /* its energy is rounding */
        double tolerance = curve == &curves[SERIES] ? 1e-4 : EXACT; /* a series fades out in its rounding */
        /* short of the turn only the line that meets the turn may stop: then it is reported there, within the lines' error */
        int at_turn = i > 0 && events[i - 1].event == FILM_MAXIMUM_INDENTATION && events[i - 1].time == s->time;
        if (s->event == FILM_IMPACTOR_STOPS && at_turn) HOLD(s->nu <= start->stop_velocity);
        if (s->event == FILM_IMPACTOR_STOPS && !at_turn) NEAR(s->nu, start->stop_velocity, speed, tolerance);
        if (s->event == FILM_CONTACT_ENDS) {
            HOLD(s->force == 0.0 && s->phase == FILM_SEPARATED && s->branch == FILM_FREE);
            HOLD(relative <= EXACT * speed);
            if (curve != &curves[DAMPED]) NEAR(s->xi, s->xi_free, s->xi_max, EXACT);
            else HOLD(s->xi >= 0.0 && s->xi <= s->xi_max * (1.0 + EXACT));
        }
        if (s->branch >= 0) {
            film_law(curve, s->branch, s->xi, &force, &work);
            NEAR(s->elastic, force, s->force_peak, EXACT);
            if (s->event == FILM_MAXIMUM_INDENTATION || curve != &curves[DAMPED]) NEAR(s->force, force, s->force_peak, 1e-7);
        }
        time = s->time;
    }
}

static film_start random_start(int curve) {
    film_start start = {over_decades(1e-3, 30.0), 0.0, 0.0, 0.0, INFINITY, 0.0};
    if (curve == SERIES || curve == SOFTENING) start.nu = over_decades(0.03, 4.0); /* beyond 3.6 the law ends before a fixed target wins */
    if (uniform(0.0, 1.0) < 0.7) start.gamma = over_decades(1e-4, 30.0);
    if (uniform(0.0, 1.0) < 0.3) start.load = uniform(-0.5, 0.5) * fmin(1.0, start.nu);
    if (uniform(0.0, 1.0) < 0.2) start.stop_velocity = uniform(-0.5, 0.5) * start.nu;
    if (start.load > 0.0) start.time_limit = uniform(0.0, 200.0);
    if (curve == DAMPED) start.damping = over_decades(1e-2, 3.0);
    return start;
}

static void one_contact(int which, const film_mesh *mesh, const film_start *start) {
    const film_curve *curve = &curves[which];
    film_state s, begin;
    film_summary summary, again;
    int32_t line_count, event_count;
    snprintf(where, sizeof where, "curve %d, nu %.17g, gamma %.17g, load %.17g, stop %.17g, limit %.17g, mesh %d %d %d",
             which, start->nu, start->gamma, start->load, start->stop_velocity, start->time_limit,
             (int)mesh->linearisation, (int)mesh->loading, (int)mesh->unloading);
    int work_preserving = mesh->linearisation == FILM_WORK_PRESERVING;
    int status = film_impact(curve, mesh, start, &summary);
    stir_summary(status, &summary);
    contacts++;
    HOLD(film_impact(curve, mesh, start, &again) == status);
    HOLD(memcmp(&summary, &again, sizeof again) == 0);

    HOLD(film_init(curve, &begin, 0.0, start->nu, start->gamma, start->load, start->stop_velocity) == FILM_OK);
    HOLD(film_damp(&begin, start->damping) == FILM_OK);
    s = begin;
    int recorded = film_record(curve, mesh, &s, start->time_limit, lines, LINE_ROOM, &line_count, events, EVENT_ROOM, &event_count);
    HOLD(recorded == status);
    check_lines(which, &begin, line_count, work_preserving);
    check_events(curve, event_count, start);
    if (status < 0) {
        HOLD(status == FILM_BEYOND_LAW && which == SERIES);
        return;
    }
    check_balance(which, &begin, &s, work_preserving && status == FILM_EVENT); /* at a node */
    check_samples(curve, line_count, s.time);
    check_little_room(curve, mesh, &begin, start->time_limit, line_count, event_count);
    stir_state(&s);
    int creeps = (which == LINEAR && start->gamma > OVER_DAMPED) || (which == SERIES && !work_preserving) ||
                 ((which == SHIFTED || which == SPRUNG_SHIFTED) && start->gamma > SHIFTED_OVER_DAMPED);
    if (start->load <= 0.0) HOLD(status == FILM_EVENT || (status == FILM_ENDLESS && creeps));
    if (status != FILM_EVENT) return;
    double t = s.time, v = start->nu + fabs(s.nu), tolerance = EXACT + work_rounding[which] / (0.5 * v * v);
    NEAR(summary.contact_duration, t, t, tolerance);
    NEAR(summary.final_velocity, s.nu, v, tolerance);
    NEAR(summary.permanent_indentation, s.xi, s.xi_max, tolerance);
    NEAR(summary.maximum_indentation, s.xi_max - curves[which].compliance * s.f_max, s.xi_max, tolerance);
    NEAR(summary.maximum_force, s.force_peak, s.force_peak, tolerance);
    NEAR(summary.shift, s.shift, s.shift + 1e-300, tolerance);
    NEAR(summary.work, s.spent, 0.5 * v * v, ENERGY + work_rounding[which] / (0.5 * v * v));
}

/* ---------------------------------------------------------------- steps, inputs, saving */

typedef struct {
    double duration, load, push, stop_velocity;
} part;

/* On to `until`, through every event; what the last step said. */
static int march(const film_curve *curve, const film_mesh *mesh, film_state *s, double until, film_state *seen,
                 int32_t *count) {
    for (int k = 0; k < 100000; k++) {
        double left = (until - s->time) - s->time_low;
        int status = film_step(curve, mesh, s, left > 0.0 ? left : 0.0);
        if (status != FILM_EVENT) return status;
        /* A bounce that loses nothing comes back to the old depth with no speed: rounding decides whether it passes. */
        double relative = fabs(s->nu - s->gamma * s->force);
        if (s->event == FILM_STAGE_CHANGES && relative < 1e-6 * sqrt(s->f_max * s->recovery)) continue;
        if (*count < EVENT_ROOM) seen[*count] = *s;
        ++*count;
    }
    HOLD(!"a step ends");
    return FILM_TOO_MANY;
}

/* The parts one after the other, each cut into `cuts` steps at random times. */
static int perform(const film_curve *curve, const film_mesh *mesh, film_state *s, const part *parts, int count, int cuts,
                   film_state *seen, int32_t *events_in_all) {
    double begin = s->time;
    *events_in_all = 0;
    for (int i = 0; i < count; i++) {
        HOLD(film_input(s, parts[i].load, parts[i].push, parts[i].stop_velocity) == FILM_OK);
        double cut = 0.0;
        for (int k = 1; k <= cuts; k++) {
            cut = k == cuts ? 1.0 : cut + (1.0 - cut) * uniform(0.0, 2.0 / (cuts - k + 1));
            int status = march(curve, mesh, s, begin + fmin(cut, 1.0) * parts[i].duration, seen, events_in_all);
            if (status != FILM_OK) return status;
        }
        begin += parts[i].duration;
    }
    return FILM_OK;
}

static void same_state(const film_state *a, const film_state *b, double depth, double speed, double tolerance) {
    HOLD(a->phase == b->phase && a->branch == b->branch && a->stage_max == b->stage_max && a->contacts == b->contacts);
    NEAR(a->time, b->time, b->time, tolerance);
    NEAR(a->xi, b->xi, depth + fabs(b->xi), tolerance);
    NEAR(a->nu, b->nu, speed, tolerance);
    NEAR(a->shift, b->shift, depth + fabs(b->shift), tolerance);
    NEAR(a->force, b->force, b->force_peak + b->f_max + b->force, tolerance);
    NEAR(a->xi_max, b->xi_max, depth, tolerance);
}

/* An impactor that is dropped, loaded, pushed with its support, and lands again and again: one step a part equals many,
 * and a state that was put aside runs on to the same bits. */
static void one_schedule(int which, const film_mesh *mesh) {
    static film_state seen[2][EVENT_ROOM];
    const film_curve *curve = &curves[which];
    film_state s, once, cut, saved, redone;
    part parts[PARTS];
    int32_t count[2];
    double nu = over_decades(1e-2, which == SERIES ? 1.5 : 10.0), gamma = uniform(0.0, 1.0) < 0.3 ? 0.0 : over_decades(1e-3, 10.0);
    double gap = uniform(0.0, 1.0) < 0.5 ? 0.0 : uniform(0.0, 3.0), speed = nu;
    uint64_t from = seed;
    for (int i = 0; i < PARTS; i++) {
        parts[i].duration = over_decades(1e-2, 20.0);
        parts[i].load = uniform(0.0, 1.0) < 0.3 ? 0.0 : uniform(-0.2, 0.3) * nu;
        /* Undamped and pushed back into its dent, it would come to the old depth with no speed: no two runs agree there. */
        if (gamma == 0.0 && which != HERTZ) parts[i].load = -fabs(parts[i].load);
        parts[i].push = uniform(0.0, 1.0) < 0.7 ? 0.0 : uniform(-0.3, 0.3) * nu;
        parts[i].stop_velocity = uniform(0.0, 1.0) < 0.7 ? 0.0 : uniform(-0.2, 0.2) * nu;
        speed += fabs(parts[i].load) * parts[i].duration + fabs(parts[i].push);
    }
    snprintf(where, sizeof where, "schedule from seed %llu, curve %d, nu %.6g, gamma %.6g, mesh %d %d %d",
             (unsigned long long)from, which, nu, gamma, (int)mesh->linearisation, (int)mesh->loading, (int)mesh->unloading);
    HOLD(film_init(curve, &s, -gap, nu, gamma, 0.0, 0.0) == FILM_OK);
    if (which == DAMPED) HOLD(film_damp(&s, 0.3) == FILM_OK);
    once = cut = s;
    int status = perform(curve, mesh, &once, parts, PARTS, 1, seen[0], &count[0]);
    int cut_status = perform(curve, mesh, &cut, parts, PARTS, whole(2, 40), seen[1], &count[1]);
    HOLD(status == cut_status && (status == FILM_OK || (status == FILM_BEYOND_LAW && which == SERIES)));
    HOLD(count[0] == count[1]);
    double tolerance = which == SERIES || gamma == 0.0 ? SERIES_ROUNDING : STEPS, depth = fmax(once.xi_max, 1e-3 * speed);
    same_state(&cut, &once, depth, speed, tolerance);
    for (int32_t i = 0; i < count[0] && i < EVENT_ROOM; i++) {
        HOLD(seen[0][i].event == seen[1][i].event);
        same_state(&seen[1][i], &seen[0][i], depth, speed, tolerance);
        stir_state(&seen[0][i]);
        events_seen++;
    }
    contacts += once.contacts;
    stir_state(&once);
    stir_state(&cut);

    memcpy(&saved, &s, sizeof saved);
    perform(curve, mesh, &saved, parts, whole(1, PARTS), whole(1, 5), seen[0], &count[0]);
    memcpy(&once, &saved, sizeof saved);
    memcpy(&redone, &saved, sizeof saved);
    from = seed;
    status = perform(curve, mesh, &once, parts, PARTS, 7, seen[0], &count[0]);
    seed = from;
    HOLD(perform(curve, mesh, &redone, parts, PARTS, 7, seen[1], &count[1]) == status && count[0] == count[1]);
    HOLD(memcmp(&once, &redone, sizeof once) == 0);
    size_t kept = (size_t)(count[0] < EVENT_ROOM ? count[0] : EVENT_ROOM);
    HOLD(memcmp(seen[0], seen[1], kept * sizeof *seen[0]) == 0);
}

/* ---------------------------------------------------------------- many at once */

/* A batch gives every impact what it gives it alone, wherever it stands among the others and whatever the instructions;
 * and what film_impact gives: to the last bit where it marches alone, else to `same` on fixed targets and on a straight law,
 * whose lines are exact, and to `lines`, of the error of the lines, on targets that give way. */
static void check_batch(int which, const film_mesh *mesh, double same, double lines_error) {
    film_start *start = room_for(BATCH, sizeof *start);
    film_summary *summary = room_for(BATCH, sizeof *summary), *again = room_for(BATCH, sizeof *again), alone, slow;
    int32_t *status = room_for(BATCH, sizeof *status), *status_again = room_for(BATCH, sizeof *status_again), one;
    for (int i = 0; i < BATCH; i++) start[i] = random_start(which);
    start[BATCH / 2].nu = NAN;
    film_batch(&curves[which], mesh, BATCH, start, summary, status);
    for (int32_t count = 0; count <= BATCH; count += 100) {
        for (int instructions = FILM_PLAIN; instructions <= film_instructions(); instructions++) {
            film_batch_with(instructions, &curves[which], mesh, count, start, again, status_again);
            HOLD(memcmp(again, summary, (size_t)count * sizeof *summary) == 0);
            HOLD(memcmp(status_again, status, (size_t)count * sizeof *status) == 0);
        }
    }
    for (int i = 0; i < BATCH; i++) {
        snprintf(where, sizeof where, "batch, curve %d, nu %.17g, gamma %.17g, load %.17g, mesh %d %d %d", which,
                 start[i].nu, start[i].gamma, start[i].load, (int)mesh->linearisation, (int)mesh->loading,
                 (int)mesh->unloading);
        film_batch(&curves[which], mesh, 1, &start[i], &alone, &one);
        HOLD(one == status[i]);
        HOLD(memcmp(&alone, &summary[i], sizeof alone) == 0);
        stir_summary(status[i], &summary[i]);
        HOLD(film_impact(&curves[which], mesh, &start[i], &slow) == status[i]);
        if (start[i].load != 0.0 || start[i].stop_velocity != 0.0 || mesh->linearisation == FILM_CHORD)
            HOLD(memcmp(&alone, &slow, sizeof alone) == 0);
        int straight = which == LINEAR || which == SOFTENING;
        if (status[i] != FILM_EVENT || (straight && start[i].gamma > 1.5)) continue; /* near critical damping */
        if (start[i].gamma * pow(start[i].nu, 0.2) > 2.0) continue; /* fades out slowly: asks for more segments */
        if (which == CLEARANCE && fabs(slow.final_velocity) < 0.1 * start[i].nu) continue; /* how long it takes to part is rounding */
        double tolerance = start[i].gamma == 0.0 || which == LINEAR ? same : lines_error;
        NEAR(alone.maximum_force, slow.maximum_force, slow.maximum_force, tolerance);
        NEAR(alone.maximum_indentation, slow.maximum_indentation, slow.maximum_indentation, tolerance);
        NEAR(alone.time_of_maximum_indentation, slow.time_of_maximum_indentation, slow.contact_duration, tolerance);
        NEAR(alone.contact_duration, slow.contact_duration, slow.contact_duration, tolerance);
        NEAR(alone.permanent_indentation, slow.permanent_indentation, slow.maximum_indentation, tolerance);
        NEAR(alone.final_velocity, slow.final_velocity, start[i].nu, tolerance);
        NEAR(alone.shift, slow.shift, fabs(slow.shift) + 1e-300, tolerance);
        NEAR(alone.work, slow.work, start[i].nu * start[i].nu, tolerance);
        HOLD(alone.stage == slow.stage);
        HOLD(isnan(alone.time_impactor_stops) == isnan(slow.time_impactor_stops));
        if (!isnan(slow.time_impactor_stops))
            NEAR(alone.time_impactor_stops, slow.time_impactor_stops, slow.contact_duration, start[i].gamma > 0.0 ? lines_error : same);
    }
    HOLD(status[BATCH / 2] == FILM_BAD_NUMBER);
    film_batch(&curves[which], mesh, 0, NULL, NULL, NULL);
    free(start);
    free(summary);
    free(again);
    free(status);
    free(status_again);
}

/* ---------------------------------------------------------------- known answers */

/* f = x on a target that gives way: x'' + gamma x' + x = 0, and on the way out the same with a stiffer spring. Straight
 * lines follow a straight law exactly, however few they are. */
static void check_linear_law(const film_mesh *mesh) {
    for (int i = 0; i < 200; i++) {
        film_start start = {over_decades(1e-3, 1e3), i % 4 == 0 ? 0.0 : over_decades(1e-3, 1.9), 0.0, 0.0, INFINITY, 0.0};
        film_summary got;
        snprintf(where, sizeof where, "linear law, nu %.17g, gamma %.17g", start.nu, start.gamma);
        double a = 0.5 * start.gamma, omega = sqrt(1.0 - a * a), turn = atan2(omega, a) / omega;
        double stiff = 1.0 / (1.0 - LEFT_OVER), b = 0.5 * stiff * start.gamma, square = stiff - b * b;
        int status = film_impact(&curves[LINEAR], mesh, &start, &got);
        if (fabs(square) > 0.01) HOLD(status == (square > 0.0 ? FILM_EVENT : FILM_ENDLESS)); /* or it creeps for ever */
        double deep = start.nu * exp(-a * turn);
        NEAR(got.time_of_maximum_indentation, turn, turn, EXACT);
        NEAR(got.maximum_indentation, deep, deep, EXACT);
        NEAR(got.maximum_force, deep, deep, EXACT);
        if (status == FILM_EVENT) NEAR(got.permanent_indentation, LEFT_OVER * deep, deep, EXACT);
        if (status == FILM_EVENT) NEAR(got.work, 0.5 * LEFT_OVER * deep * deep, deep * deep, EXACT);
        if (square < 0.01) continue; /* near critical damping the formula below cancels */
        omega = sqrt(square);
        double out = (0.5 * acos(-1.0) + atan(b / omega)) / omega; /* x cos + b/omega x sin falls to 0 */
        double late = 1e-15 * deep / fabs(got.final_velocity); /* a position rounded, at the speed of leaving */
        NEAR(got.contact_duration, turn + out, turn + out + late / EXACT, EXACT);
        NEAR(got.final_velocity, -deep * sqrt(stiff) * (1.0 - LEFT_OVER) * exp(-b * out), start.nu, EXACT);
    }
}

/* Hertz on a half-space: the depth by energy, nothing absorbed, and the duration to the order of the method. */
static void check_hertz(void) {
    /* 2 (5/4)^(2/5) integral of (1 - x^(5/2))^(-1/2) from 0 to 1: sqrt(pi) gamma(7/5)/gamma(9/10) */
    const double constant = 2.0 * pow(1.25, 0.4) * sqrt(acos(-1.0)) * tgamma(1.4) / tgamma(0.9);
    double before = 0.0;
    for (int32_t n = 32; n <= 256; n *= 2) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, n, n);
        film_start start = {2.5, 0.0, 0.0, 0.0, INFINITY, 0.0};
        film_summary got;
        snprintf(where, sizeof where, "Hertz, %d segments", (int)n);
        HOLD(film_impact(&curves[HERTZ], &own.mesh, &start, &got) == FILM_EVENT);
        double deep = pow(1.25 * start.nu * start.nu, 0.4), duration = constant * pow(start.nu, -0.2);
        NEAR(got.maximum_indentation, deep, deep, EXACT);
        NEAR(got.maximum_force, pow(deep, 1.5), pow(deep, 1.5), EXACT);
        NEAR(got.final_velocity, -start.nu, start.nu, EXACT);
        NEAR(got.work, 0.0, start.nu * start.nu, EXACT);
        double miss = fabs(got.contact_duration / duration - 1.0);
        if (n > 32) HOLD(before / miss > 14.5 && before / miss < 16.5); /* fourth order: 16 */
        before = miss;
        free(own.memory);
    }
    HOLD(before < 2e-11);
}

/* The same contact under a law and under its series, whose rounding is that of its largest value. */
static void same_contact(const film_curve *law, const film_curve *fitted, const film_mesh *mesh, const film_start *start, int stage,
                         double rounding) {
    film_summary a, b;
    snprintf(where, sizeof where, "a law twice, nu %.17g, gamma %.17g, load %.17g", start->nu, start->gamma, start->load);
    HOLD(film_impact(law, mesh, start, &a) == FILM_EVENT);
    HOLD(film_impact(fitted, mesh, start, &b) == FILM_EVENT);
    HOLD(a.stage == stage && b.stage == stage);
    NEAR(a.maximum_force, b.maximum_force, a.maximum_force, rounding);
    NEAR(a.maximum_indentation, b.maximum_indentation, a.maximum_indentation, rounding);
    NEAR(a.time_of_maximum_indentation, b.time_of_maximum_indentation, a.time_of_maximum_indentation, rounding);
    NEAR(a.contact_duration, b.contact_duration, a.contact_duration, rounding);
    NEAR(a.final_velocity, b.final_velocity, start->nu, rounding);
}

static void check_series(const film_mesh *mesh) {
    for (int i = 0; i < 200; i++) { /* down to forces of 1e-7 of the largest */
        film_start start = {over_decades(1e-6, 0.89), i % 2 ? 0.0 : over_decades(1e-3, 5.0), 0.0, 0.0, INFINITY, 0.0};
        same_contact(&curves[HERTZ], &curves[SERIES], mesh, &start, 0, SERIES_ROUNDING);
    }
    static const double root[] = {214.0, 214.0}, mean[] = {428.0 / 3.0, 428.0 / 3.0};
    for (int i = 0; i < 100; i++) { /* a root that begins where almost nothing was, as soft a target, and a turn within 1e-11 of its span */
        film_curve law, fitted;
        memset(&law, 0, sizeof law);
        add_stage(&law, 0.5, power(0.0, 0.0, 1e-11, 0.0, 1.0));
        fitted = law;
        add_stage(&law, 236.5, power(0.5, 5e-12, 0.0, 428.0 / sqrt(236.0), 0.5));
        add_stage(&fitted, 236.5, series(FILM_ROOT_SERIES, 0.5, 236.5, 2, root))->mean = series(FILM_ROOT_SERIES, 0.5, 236.5, 2, mean);
        film_start start = {over_decades(1e-2, 1.0), over_decades(1.0, 30.0), -1e-12, 0.0, INFINITY, 0.0};
        same_contact(&law, &fitted, mesh, &start, 1, 2e-4); /* it creeps out to forces of rounding */
    }
}

/* ---------------------------------------------------------------- bad input */

#define REFUSED(change)                                     \
    do {                                                    \
        film_curve bad = curves[which];                     \
        change;                                             \
        HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);     \
    } while (0)

static void check_bad_curves(void) {
    for (int which = 0; which < CURVES; which++) {
        snprintf(where, sizeof where, "bad versions of curve %d", which);
        HOLD(film_check_curve(&curves[which]) == FILM_OK);
        int32_t last = curves[which].stages - 1;
        REFUSED(bad.stages = 0);
        REFUSED(bad.stages = FILM_MAX_STAGES + 1);
        REFUSED(bad.stages = -1);
        REFUSED(bad.pieces++);
        REFUSED(bad.stage[0].begin = 0.5);
        REFUSED(bad.stage[0].begin = NAN);
        REFUSED(bad.stage[last].end = NAN);
        REFUSED(bad.stage[last].end = -1.0);
        REFUSED(bad.stage[0].first = 1);
        REFUSED(bad.stage[0].first = -1);
        REFUSED(bad.stage[last].count = 0);
        REFUSED(bad.stage[last].count = FILM_MAX_PIECES + 1);
        REFUSED(bad.stage[last].count = INT32_MAX);
        REFUSED(bad.stage[last].unloading = 5);
        REFUSED(bad.stage[last].unloading = -1);
        REFUSED(bad.stage[last].reload_exponent = -1.0);
        REFUSED(bad.stage[last].reload_exponent = NAN);
        REFUSED(bad.compliance = -1e-9);
        REFUSED(bad.compliance = NAN);
        REFUSED(bad.compliance = INFINITY);
        if (which == DAMPED) REFUSED(bad.compliance = 1e-9);
        REFUSED(bad.piece[0].end = 0.0);
        REFUSED(bad.piece[0].end = NAN);
        REFUSED(bad.piece[0].work_at_begin = NAN);
        REFUSED(bad.piece[0].force.form = 3);
        REFUSED(bad.piece[0].force.form = -1);
        REFUSED(bad.piece[0].force.origin = INFINITY);
        REFUSED(bad.piece[0].force.per_span = 0.0);
        REFUSED(bad.piece[0].force.per_span = NAN);
        if (which != SERIES) {
            REFUSED(bad.piece[0].force.constant = NAN);
            REFUSED(bad.piece[0].force.slope = INFINITY);
            REFUSED(bad.piece[0].force.coefficient = -INFINITY);
            REFUSED(bad.piece[0].force.exponent = 0.0);
            REFUSED(bad.piece[0].force.exponent = -1.5);
            REFUSED(bad.piece[0].force.exponent = NAN);
            REFUSED(bad.piece[0].force.per_span = 2.0);
        } else {
            REFUSED(bad.piece[0].force.terms = 0);
            REFUSED(bad.piece[0].force.terms = FILM_MAX_TERMS + 1);
            REFUSED(bad.piece[0].force.series[1] = NAN);
            REFUSED(bad.piece[0].mean.terms = 0);
            REFUSED(bad.piece[0].mean.series[3] = INFINITY);
            REFUSED(bad.stage[last].end = bad.piece[2].end = INFINITY);
        }
        if (last > 0) {
            REFUSED(bad.stage[1].begin = 1.5);
            REFUSED(bad.stage[0].end = INFINITY);
            REFUSED(bad.stage[1].first = 0);
        }
        REFUSED(bad.stage[last].damped = 2);
        if (which == DAMPED) {
            REFUSED(bad.piece[0].damping.coefficient = NAN);
            REFUSED(bad.stage[0].unloading = FILM_RESIDUAL);
        } else if (which != HERTZ) {
            REFUSED(bad.stage[last].damped = 1);
            REFUSED(bad.piece[curves[which].stage[last].first].recovery.form = 7);
            REFUSED(bad.piece[curves[which].stage[last].first].recovery.origin = NAN);
            REFUSED(bad.piece[curves[which].stage[last].first].exponent.per_span = -1.0);
        }
    }
}

static void check_bad_meshes(void) {
    static const int32_t counts[][3] = {{FILM_WORK_PRESERVING, 0, 5}, {FILM_WORK_PRESERVING, 5, 0},
                                        {FILM_CHORD, -1, 5}, {FILM_CHORD, 5, FILM_MAX_SEGMENTS + 1},
                                        {FILM_WORK_PRESERVING, INT32_MAX, 1}, {2, 5, 5}, {-1, 5, 5}};
    film_start start = {1.0, 0.0, 0.0, 0.0, INFINITY, 0.0};
    film_summary summary;
    film_state s;
    int32_t a, b;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        snprintf(where, sizeof where, "bad mesh %d", (int)i);
        film_mesh mesh;
        HOLD(film_mesh_init(&mesh, counts[i][0], counts[i][1], counts[i][2], NULL) == FILM_BAD_MESH);
        HOLD(film_impact(&curves[HERTZ], &mesh, &start, &summary) == FILM_BAD_MESH);
        HOLD(film_init(&curves[HERTZ], &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK);
        HOLD(film_step(&curves[HERTZ], &mesh, &s, 1.0) == FILM_BAD_MESH);
        HOLD(film_record(&curves[HERTZ], &mesh, &s, 1.0, lines, 1, &a, events, 1, &b) == FILM_BAD_MESH);
        HOLD(a == 0 && b == 0);
    }
}

static void check_bad_numbers(const film_mesh *mesh) {
    static const double not_finite[] = {NAN, INFINITY, -INFINITY};
    const film_curve *curve = &curves[ELASTOPLASTIC];
    film_state s, before;
    film_summary summary;
    int32_t a, b;
    snprintf(where, sizeof where, "bad numbers");
    for (int k = 0; k < 3; k++) {
        double x = not_finite[k];
        HOLD(film_init(curve, &s, x, 1.0, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, x, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, x, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, 0.0, x, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, 0.0, 0.0, x) == FILM_BAD_NUMBER);
        const film_start bad[] = {{x, 0.0, 0.0, 0.0, INFINITY, 0.0}, {1.0, x, 0.0, 0.0, INFINITY, 0.0},
                                  {1.0, 0.0, x, 0.0, INFINITY, 0.0}, {1.0, 0.0, 0.0, x, INFINITY, 0.0},
                                  {1.0, 0.0, 0.0, 0.0, INFINITY, x}};
        for (int i = 0; i < 5; i++) HOLD(film_impact(curve, mesh, &bad[i], &summary) == FILM_BAD_NUMBER);
    }
    const film_start none[] = {{0.0, 0.0, 0.0, 0.0, INFINITY, 0.0}, {-1.0, 0.0, 0.0, 0.0, INFINITY, 0.0},
                               {1.0, -1e-9, 0.0, 0.0, INFINITY, 0.0}, {1.0, 0.0, 0.0, 0.0, NAN, 0.0},
                               {1.0, 0.0, 0.0, 0.0, -1.0, 0.0}, {1.0, 0.0, 0.0, 0.0, INFINITY, -1e-9}};
    for (int i = 0; i < 6; i++) HOLD(film_impact(curve, mesh, &none[i], &summary) == FILM_BAD_NUMBER);
    HOLD(film_init(curve, &s, 1e-9, 1.0, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
    HOLD(film_init(curve, &s, -1.0, 1.0, -1.0, 0.0, 0.0) == FILM_BAD_NUMBER);

    HOLD(film_init(curve, &s, -0.5, 2.0, 0.1, 0.0, 0.0) == FILM_OK);
    HOLD(film_step(curve, mesh, &s, 0.7) == FILM_EVENT && s.event == FILM_CONTACT_BEGINS);
    HOLD(film_step(curve, mesh, &s, 0.2) == FILM_OK);
    memcpy(&before, &s, sizeof s);
    HOLD(film_step(curve, mesh, &s, -1e-300) == FILM_BAD_NUMBER);
    HOLD(film_step(curve, mesh, &s, NAN) == FILM_BAD_NUMBER);
    HOLD(film_record(curve, mesh, &s, NAN, lines, LINE_ROOM, &a, events, EVENT_ROOM, &b) == FILM_BAD_NUMBER);
    HOLD(film_record(curve, mesh, &s, s.time - 0.1, lines, LINE_ROOM, &a, events, EVENT_ROOM, &b) == FILM_BAD_NUMBER);
    for (int k = 0; k < 3; k++) {
        HOLD(film_input(&s, not_finite[k], 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_input(&s, 0.0, not_finite[k], 0.0) == FILM_BAD_NUMBER);
        HOLD(film_input(&s, 0.0, 0.0, not_finite[k]) == FILM_BAD_NUMBER);
    }
    HOLD(film_step(curve, mesh, &s, 0.0) == FILM_OK);
    HOLD(film_input(&s, 0.0, 0.0, 0.0) == FILM_OK);
    HOLD(memcmp(&before, &s, sizeof s) == 0); /* refusals, no time and no change leave the state as it was */
}

/* Steps without end stop at every event, and then say that nothing will ever come. */
static void check_endless(const film_mesh *mesh) {
    for (int which = 0; which < CURVES; which++) {
        film_state s, before;
        snprintf(where, sizeof where, "endless steps, curve %d", which);
        HOLD(film_init(&curves[which], &s, -1.0, 1.0, 0.3, 0.0, 0.0) == FILM_OK);
        int32_t ends = 0;
        while (film_step(&curves[which], mesh, &s, INFINITY) == FILM_EVENT) {
            HOLD(isfinite(s.time) && ++ends < 20);
            stir_state(&s);
        }
        HOLD(s.event == FILM_CONTACT_ENDS && s.phase == FILM_SEPARATED && s.contacts == 1 && isfinite(s.xi));
        memcpy(&before, &s, sizeof s);
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS);
        HOLD(s.time == before.time && s.xi == before.xi && s.nu == before.nu);

        HOLD(film_init(&curves[which], &s, -1.0, -1.0, 0.3, 0.0, 0.0) == FILM_OK); /* away from the target */
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS && s.contacts == 0);
        HOLD(film_init(&curves[which], &s, 0.0, 0.0, 0.0, 0.0, 0.0) == FILM_OK); /* at rest where contact begins */
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS && s.contacts == 0);

        /* held shut by a load on a target that damps: it comes to rest where force and load balance */
        HOLD(film_init(&curves[which], &s, 0.0, 0.5, 1.0, 0.4, 0.0) == FILM_OK);
        for (ends = 0; film_step(&curves[which], mesh, &s, INFINITY) == FILM_EVENT; ends++) HOLD(ends < 1000);
        HOLD(film_step(&curves[which], mesh, &s, 1e6) == FILM_OK);
        NEAR(s.force, 0.4, 0.4, 1e-9);
        NEAR(s.nu, 0.4, 0.4, 1e-9); /* a compliant target yields at the speed gamma f for ever */
        stir_state(&s);
    }
}

/* Inputs that broke the march once, each as small as it was found: a power up to `end`, straight on with `slope` after that,
 * or a root; a contact that turns leaves `left` of its depth, or opens along the power with `shifted`. Speed 0: held against it. */
typedef struct {
    const char *what;
    double coefficient, exponent, left, end, slope, root, shifted, damping_exponent;
    film_start start;
    int linearisation;
    int32_t loading, unloading;
    int status;
} found;

enum { FOUND_LINES = 2000 };

static const found found_cases[] = {
    {"a branch of 1e-13 of the depth", 1, 2, 1.0 - 1e-13, 0, 0, 0, 0, 0, {1, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 3, FILM_BAD_UNLOADING},
    {"a branch so steep that its work is rounding", 10, 1, 0, 1e-3, 10, 0, 1e15, 0, {1000, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 2, 2, FILM_BAD_UNLOADING},
    {"a short branch on a soft target", 0.01, 8, 1.0 - 1e-5, 0, 0, 0, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 1, FILM_EVENT},
    {"out of a stage that begins steeply", 1e-3, 0.5, 0, 0.1, 0, 1, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 3, FILM_EVENT},
    {"out of a stiff root", 1e5, 0.3, 0, 0, 0, 0, 0, 0, {1e-3, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 2, FILM_ENDLESS},
    {"a turn on a root", 1e4, 0.3, 0, 0, 0, 0, 0, 0, {1e-6, 0.1, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 2, FILM_ENDLESS},
    {"a turn on a root, a stage behind", 1e4, 0.3, 0, 1, 10, 0, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 2, FILM_ENDLESS},
    {"an over-damped turn", 1e-4, 1, 0, 0, 0, 0, 0, 4, {1, 0, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 1, 3, FILM_EVENT},
    {"creeping out", 10, 1, 0, 0, 0, 0, 0, 0.1, {1, 10, 0, 0, INFINITY, 0.1}, FILM_CHORD, 1, 1, FILM_ENDLESS},
    {"creeping out of a dashpot", 1, 1.5, 0, 0, 0, 0, 0, 0.1, {10, 0, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 1, 1, FILM_ENDLESS},
    {"pulled out of a dashpot with hardly a spring", 1e-11, 1, 0, 0, 0, 0, 0, 4, {0.746, 0, -1e-12, 0, INFINITY, 1e-6}, FILM_WORK_PRESERVING, 8, 8, FILM_EVENT},
    {"all energy spent where a stage ends", 0.01, 1, 0, 1, 0, 1, 0, 0, {0.1, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 4, FILM_EVENT},
    {"out of a damped root", 136, 0.36, 0, 0, 0, 0, 0, 0.25, {0.09, 1.4, 0, 0, INFINITY, 0.06}, FILM_WORK_PRESERVING, 8, 14, FILM_ENDLESS},
    {"out of a damped root on few lines", 1, 0.3, 0, 0, 0, 0, 0, 0.1, {1, 1, 0, 0, INFINITY, 30}, FILM_WORK_PRESERVING, 1, 7, FILM_ENDLESS},
    {"out of hardly more than a spring, on a soft target", 7.7e9, 1.06, 0, 0, 0, 0, 0, 0, {100, 30, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 16, FILM_ENDLESS},
    {"a dashpot that no force follows for long", 1e-4, 50, 0, 0, 0, 0, 0, 0.5, {1e-4, 1e-3, 0, 0, INFINITY, 30}, FILM_WORK_PRESERVING, 6, 3, FILM_ENDLESS},
    {"pulled out of a dashpot at once", 100, 20, 0, 0, 0, 0, 0, 0.25, {1e-4, 0.1, -0.1, 0, INFINITY, 1}, FILM_WORK_PRESERVING, 3, 1, FILM_EVENT},
    {"a damped turn that no line with the speeds at its ends meets", 1, 1.5, 0, 0, 0, 0, 0, 0.25, {5, 10, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 2, 2, FILM_EVENT},
    {"a damped turn against a small load", 1e-4, 2, 0, 0, 0, 0, 0, 1, {0.01, 0, 1e-10, 0, INFINITY, 0.1}, FILM_WORK_PRESERVING, 5, 7, FILM_EVENT},
    {"a weak spring behind a stiff dashpot", 1e-6, 1, 0, 0, 0, 0, 0, 3.5, {15, 0, 0, 0, INFINITY, 4}, FILM_CHORD, 19, 7, FILM_EVENT},
    {"a balance within one number", 1e4, 2, 1.0 - 1e-9, 0, 0, 0, 0, 0, {1, 20, 1e-6, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 8, FILM_ENDLESS},
    {"a balance within one number, shifted", 1, 1.5, 0, 1, 1.5, 0, 1, 0, {148, 0.995, 3.35e-8, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 29, 58, FILM_ENDLESS},
    {"a large load that hardly lets go", 127, 1, 0, 0, 0, 0, 0, 0, {1e-3, 0, 518, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 27, FILM_EVENT},
    {"a large load from rest", 127, 1, 0, 0, 0, 0, 0, 0, {1e-9, 0, 518, 0, 10, 0}, FILM_WORK_PRESERVING, 1, 27, FILM_OK},
    {"in again from rest, a root on chords", 0.25, 0.5, 0, 0, 0, 0, 0, 0, {1e-3, 1e-5, 0.03, 0, 100, 0}, FILM_CHORD, 5, 2, FILM_OK},
    {"a load at rest", 100, 0.5, 0, 0, 0, 0, 0, 0, {0, 0.1, 100, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 2, 8, FILM_ENDLESS},
    {"a stop next to a turn", 1.54e-9, 1.5, 0, 0, 0, 0, 0, 0, {3.34e-3, 0, 0, 3.34e-12, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 1, FILM_EVENT},
    {"a way of which a thousandth is rounding", 0.77870152124034686, 1, 0.99999999900000003, 0, 0, 0, 0, 0, {1e-3, 4.6113314685938925e-5, 7.2433160947246762, 1.0000000000000002e-12, 9, 0}, FILM_WORK_PRESERVING, 32, 1, FILM_OK},
    {"held shut by a load, swinging without end", 1, 1, 0.2, 0, 0, 0, 0, 0, {0.1, 0, 0.5, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 1, FILM_TOO_MANY},
};

static film_curve found_curve(const found *at) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, at->end > 0.0 ? at->end : INFINITY, power(0.0, 0.0, 0.0, at->coefficient, at->exponent));
    if (at->end > 0.0) {
        double force = at->coefficient * pow(at->end, at->exponent);
        piece = add_stage(&curve, INFINITY, power(at->end, force, at->slope, at->root, 0.5));
    }
    film_stage *stage = &curve.stage[curve.stages - 1];
    if (at->left > 0.0) {
        stage->unloading = FILM_RESIDUAL;
        piece->recovery = power(0.0, 0.0, at->left, 0.0, 1.0);
    }
    if (at->shifted > 0.0) {
        stage->unloading = FILM_SHIFTED;
        piece->recovery = power(0.0, at->shifted, 0.0, 0.0, 1.0);
        piece->exponent = power(0.0, at->exponent, 0.0, 0.0, 1.0);
    }
    if (at->damping_exponent > 0.0) {
        stage->damped = 1;
        piece->damping = power(0.0, 0.0, 0.0, 1.0, at->damping_exponent);
    }
    return curve;
}

/* Every line ends where the next one begins. */
static void check_found_lines(const film_curve *curve, const film_mesh *mesh, film_state s, double time_limit) {
    int32_t line_count, event_count;
    double fastest = 0.0;
    film_record(curve, mesh, &s, time_limit, lines, LINE_ROOM, &line_count, events, EVENT_ROOM, &event_count);
    for (int32_t i = 0; i < line_count; i++) fastest = fmax(fastest, fabs(lines[i].nu));
    for (int32_t i = 0; mesh->linearisation == FILM_WORK_PRESERVING && i + 1 < line_count; i++) {
        double values[5], tau = lines[i + 1].time - lines[i].time;
        film_evaluate(curve, &lines[i], tau, values);
        HOLD(tau >= 0.0 && isfinite(lines[i + 1].xi));
        if (tau == 0.0) continue; /* rounding that is put right */
        NEAR(values[0], lines[i + 1].xi, fabs(lines[i].xi) + fabs(lines[i + 1].xi), LINES_MEET);
        NEAR(values[3], lines[i + 1].nu, fastest, LINES_MEET);
    }
}

static void check_found(void) {
    for (size_t k = 0; k < sizeof found_cases / sizeof *found_cases; k++) {
        const found *at = &found_cases[k];
        film_curve curve = found_curve(at);
        owned_mesh own = make_mesh(at->linearisation, at->loading, at->unloading);
        film_summary summary;
        film_state s;
        snprintf(where, sizeof where, "%s", at->what);
        HOLD(film_check_curve(&curve) == FILM_OK);
        int status = at->start.nu > 0.0 ? film_impact(&curve, &own.mesh, &at->start, &summary) : at->status;
        HOLD(status == at->status);
        if (at->start.nu > 0.0) stir_summary(status, &summary);
        int ended = at->status == FILM_EVENT;
        if (status >= 0 && at->start.nu > 0.0) HOLD(summary.lines <= FOUND_LINES && isfinite(summary.work) && isfinite(summary.shift));
        if (ended) HOLD(summary.contact_duration > 0.0 && isfinite(summary.contact_duration) && isfinite(summary.maximum_force));
        if (ended) HOLD(isfinite(summary.time_of_maximum_indentation) && summary.work >= -ENERGY * at->start.nu * at->start.nu);
        if (ended) HOLD((at->start.load != 0.0 || fabs(summary.final_velocity) <= at->start.nu) && summary.permanent_indentation >= 0.0);

        HOLD(film_init(&curve, &s, 0.0, at->start.nu, at->start.gamma, at->start.load, at->start.stop_velocity) == FILM_OK);
        HOLD(film_damp(&s, at->start.damping) == FILM_OK);
        check_found_lines(&curve, &own.mesh, s, at->start.time_limit);
        double before = 0.5 * s.nu * s.nu;
        int count = 0;
        for (status = FILM_EVENT; status == FILM_EVENT && s.event != FILM_CONTACT_ENDS && count < 20; count++) {
            status = film_step(&curve, &own.mesh, &s, INFINITY);
            double after = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift);
            HOLD(status < 0 || (isfinite(s.time) && isfinite(s.force)));
            double blurred = ENERGY * (fabs(before) + fabs(s.spent) + fabs(s.load) * s.xi_max);
            int kept = status >= 0 && at->linearisation == FILM_WORK_PRESERVING;
            if (kept) HOLD(after <= before + blurred);
            if (kept && s.gamma == 0.0 && s.damper == 0.0) HOLD(after >= before - blurred);
            HOLD(s.load > 0.0 || s.event != FILM_RELOADING_BEGINS);
            before = after;
        }
        HOLD(count < 20 || at->status == FILM_TOO_MANY || at->status == FILM_OK);
        free(own.memory);
    }
}

/* Out of a branch that is hardly more than a spring, and creeps to 1e-200 of its depth. */
static void check_crept(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 4525.5, 0.0, 1.0));
    curve.stage[0].unloading = FILM_SECANT;
    piece->recovery = power(0.0, 1e-6, 0.0, 0.0, 1.0);
    piece->exponent = power(0.0, 1.0365457105506151, 0.0, 0.0, 1.0);
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 16, 23);
    const film_start start = {1.1288e-3, 18.01549273532007, 0.0, 0.0, INFINITY, 0.0};
    film_summary summary;
    snprintf(where, sizeof where, "creeping out of hardly more than a spring");
    HOLD(film_check_curve(&curve) == FILM_OK);
    HOLD(film_impact(&curve, &own.mesh, &start, &summary) == FILM_ENDLESS && summary.lines <= FOUND_LINES);
    free(own.memory);
}

/* Motions on one line that were left at a wrong time. */
static void check_motions(void) {
    double tau, x, y;
    const motion steep = {9.77e-6, -1.126, -1.022, 0.0165}; /* from rest away from a balance: e^t takes Newton's method a step each */
    const motion back = {-0.15, -0.0224, -0.01, -0.092};      /* and inwards, from the wrong side of it */
    const motion slow = {1.5, 0.0, 0.0, 4.3};                 /* a dashpot alone */
    snprintf(where, sizeof where, "motions on one line");
    HOLD(leave(&steep, 0.00396, &tau, &y) == LEFT);
    move(&steep, tau, &x, &y);
    NEAR(x, 0.00396, 0.00396, EXACT);
    HOLD(leave(&back, 14.0, &tau, &y) == LEFT_NOT);
    HOLD(turn_time(&slow) == INFINITY);
    const motion rest = {0.0, 0.0, -1.0, 0.0}; /* on a balance that is unstable */
    move(&rest, 1e9, &x, &y);
    HOLD(x == 0.0 && y == 0.0);
    const motion to_rest = {0.1, 0.1 * (1.0 + 1e-15), -1.0, 0.0}; /* on the way to one */
    move(&to_rest, 1e9, &x, &y);
    NEAR(x, 0.1, 0.1, EXACT);
    HOLD(fabs(y) < 1e-15);
    const motion soft = {0.001, 0.0, 5e-317, 0.0}; /* a quarter of a period of 1e158 */
    move(&soft, turn_time(&soft), &x, &y);
    HOLD(isfinite(x) && x > 0.0);
    const motion faint = {1.9e-4, 4.2e-314, 2.2e-305, 5.3e-309}; /* y0 over the force is as large as numbers are */
    NEAR(turn_time(&faint), 0.5 * PI / sqrt(2.2e-305), 1e153, EXACT);
    const motion turned = {1.0, 1.001, -1.0, 0.0}; /* turned before one, behind which there would be energy again */
    HOLD(leave(&turned, 1.1, &tau, &y) == LEFT_NOT);
}

/* Time and its remainder: half of the last digit is not rounded away. */
static void check_clock(const film_mesh *mesh) {
    film_state s;
    snprintf(where, sizeof where, "the clock");
    HOLD(film_init(&curves[HERTZ], &s, -1.0, 0.0, 0.0, 0.0, 0.0) == FILM_OK);
    HOLD(film_step(&curves[HERTZ], mesh, &s, 1.0) == FILM_OK);
    s.time = 1.0 + 0x1p-52;
    s.time_low = -0x1p-53;
    double before = s.time;
    HOLD(film_step(&curves[HERTZ], mesh, &s, 0.0) == FILM_OK && s.time == before);
}

/* A load or a velocity whose powers underflow is none. */
static void check_tiny(const film_mesh *mesh) {
    static const double tiny[] = {5e-324, 1e-310, 1e-200};
    for (int k = 0; k < 3; k++) {
        for (int which = 0; which < CURVES; which++) {
            for (int sign = -1; sign <= 1; sign += 2) {
                film_state s;
                int status = FILM_EVENT, count = 0;
                snprintf(where, sizeof where, "a load of %g, curve %d", sign * tiny[k], which);
                HOLD(film_init(&curves[which], &s, -1e-8, 0.0, 0.5, sign * tiny[k], 0.0) == FILM_OK);
                for (; status == FILM_EVENT && count < 20; count++) status = film_step(&curves[which], mesh, &s, INFINITY);
                HOLD(status == FILM_ENDLESS && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
                HOLD(film_init(&curves[which], &s, 0.0, tiny[k], 0.5, 0.0, 0.0) == FILM_OK);
                for (count = 0, status = FILM_EVENT; status == FILM_EVENT && count < 20; count++) status = film_step(&curves[which], mesh, &s, INFINITY);
                HOLD(status == FILM_ENDLESS && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
            }
        }
    }
}

/* To rest where the force has softened to nothing: next to it, and exactly there. */
static void check_softened(void) {
    static const double root[] = {213.21163284237079, -213.21163284237079}, mean[] = {213.21163284237079 / 3.0, -213.21163284237079 / 3.0};
    film_curve curve;
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 8, 3);
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, 236.67, series(FILM_ROOT_SERIES, 0.0, 236.67, 2, root));
    piece->mean = series(FILM_ROOT_SERIES, 0.0, 236.67, 2, mean);
    curve.stage[0].unloading = FILM_SECANT;
    piece->recovery = power(0.0, 1.1547845254488045e-05, 0.0, 0.0, 0.5);
    piece->exponent = power(0.0, 0.3, 0.0, 0.0, 1.0);
    double force, work;
    film_law(&curve, 0, 236.67, &force, &work);
    for (int k = 3; k < 16; k++) {
        snprintf(where, sizeof where, "to rest 1e-%d before the force is none", k);
        HOLD(film_init(&curve, &s, 0.0, sqrt(2.0 * work * (1.0 - pow(10.0, -k))), 0.0, 0.0, 0.0) == FILM_OK);
        check_found_lines(&curve, &own.mesh, s, 1e12);
        double before = 0.5 * s.nu * s.nu;
        int status = FILM_EVENT;
        for (int i = 0; status == FILM_EVENT && i < 20; i++) {
            status = film_step(&curve, &own.mesh, &s, 1e11);
            HOLD(isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
            if (status >= 0) NEAR(0.5 * s.nu * s.nu + s.spent, before, before, 1e-10);
        }
    }
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, power(0.0, 1.0, -1.0, 0.0, 1.0));
    HOLD(film_init(&curve, &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK);
    int status = FILM_EVENT;
    for (int i = 0; status == FILM_EVENT && i < 20; i++) {
        status = film_step(&curve, &own.mesh, &s, 1e9);
        HOLD(isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
    }
    NEAR(s.xi_max, 1.0, 1.0, 1e-7);
    NEAR(s.nu, -1.0, 1.0, EXACT);
    free(own.memory);
}

/* Pushed in again where rounding has left it beyond the end of its branch. */
static void check_beyond(const film_mesh *mesh) {
    film_state s;
    snprintf(where, sizeof where, "in again from beyond the end of a branch");
    HOLD(film_init(&curves[LAMINATE], &s, 0.0, 1.0, 0.1, 0.0, 0.0) == FILM_OK);
    while (s.event != FILM_MAXIMUM_INDENTATION) HOLD(film_step(&curves[LAMINATE], mesh, &s, INFINITY) == FILM_EVENT);
    s.xi = nextafter(s.xi_free, 0.0);
    s.elastic = s.work = 0.0;
    HOLD(film_input(&s, 0.0, 1e-9 - s.nu, 0.0) == FILM_OK);
    HOLD(film_step(&curves[LAMINATE], mesh, &s, 1e-6) == FILM_EVENT && s.event == FILM_RELOADING_BEGINS);
    HOLD(film_step(&curves[LAMINATE], mesh, &s, 1e-6) >= FILM_OK && isfinite(s.spent) && isfinite(s.nu) && s.loop != 0);
}

/* Creeping out to where two stages meet in forces of rounding, one above the other: out, and not in and out without end. */
static void check_meeting(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 25.0, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(0.0, -2.5 + 4.44e-16, 0.1, 0.0, 1.0));
    snprintf(where, sizeof where, "out over stages that meet in rounding");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 2);
        for (int i = 0; i < 40; i++) {
            film_summary summary;
            film_start start = {over_decades(1e-4, 1.0), over_decades(10.0, 30.0), 0.0, 0.0, INFINITY, 0.0};
            int status = film_impact(&curve, &own.mesh, &start, &summary);
            HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && summary.lines <= FOUND_LINES);

            film_state s; /* an integrator's, between the two velocities at which the one and the other turns it */
            HOLD(film_init(&curve, &s, 0.0, 30.0, start.gamma, 0.0, 0.0) == FILM_OK);
            while (s.event != FILM_MAXIMUM_INDENTATION) HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT);
            HOLD(film_force(&curve, &s, 25.0, 0.0).force > 3e-16);
            int count = 0;
            s.nu = start.gamma * 3e-16;
            do s.xi = 25.0;
            while (film_switch(&curve, &s) == FILM_EVENT && ++count < 20);
            HOLD(count < 20);
        }
        free(own.memory);
    }
}

/* Where a branch meets the loading curve, in two forces of which one may turn it inwards and the other outwards. */
static void check_branching(const film_mesh *mesh) {
    snprintf(where, sizeof where, "where a branch meets the loading curve");
    for (int which = 0; which < BATCH_CURVES; which++) {
        for (int i = 0; which != DAMPED && i < 40; i++) {
            film_state s;
            double gamma = over_decades(1e-2, 30.0);
            HOLD(film_init(&curves[which], &s, 0.0, over_decades(0.5, 30.0), gamma, 0.0, 0.0) == FILM_OK);
            int status = FILM_EVENT;
            while (status == FILM_EVENT && s.event != FILM_MAXIMUM_INDENTATION) status = film_step(&curves[which], mesh, &s, INFINITY);
            if (status != FILM_EVENT) continue; /* beyond the law */
            double xi = s.xi, nu = gamma * s.elastic;
            for (int ulps = -3; ulps <= 3; ulps++) {
                int count = 0;
                s.nu = nu * (1.0 + 1.1e-16 * ulps);
                do s.xi = xi;
                while (film_switch(&curves[which], &s) == FILM_EVENT && ++count < 20);
                HOLD(count < 20);
            }
        }
    }
}

/* A turn so soon after a stage has begun that its way is none beside the depth: the force of the stage, were it to go on
 * above where it begins, would fall to 0 there, but it is the force of the one before that serves. */
static void check_beside(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 40.0, power(0.0, 0.0, 1e-6, 0.0, 1.0));
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 4e-5 - 4e5, 1e4, 0.0, 1.0));
    curve.stage[1].unloading = FILM_RESIDUAL;
    piece->recovery = power(0.0, 0.0, 0.5, 0.0, 1.0);
    piece->exponent = power(0.0, 1.5, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "a turn next to the beginning of a stage");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 8);
        for (int k = 0; k < 2; k++) {
            film_summary summary;
            film_start start = {sqrt(2.0 * (8e-4 + 1e-6)), k ? 1e-3 : 0.0, 0.0, 0.0, INFINITY, 0.0};
            HOLD(film_impact(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
            NEAR(summary.maximum_indentation, 40.0, 40.0, 1e-6);
            HOLD(summary.permanent_indentation == 0.5 * summary.maximum_indentation && summary.final_velocity < 0.0);
        }
        free(own.memory);
    }
}

/* Thrown by a load into swings over where a far steeper stage begins: the target pushes, however short the way. */
static void check_swings(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 40.0, power(0.0, 0.0, 1e-6, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(40.0, 4e-5, 1e4, 0.0, 1.0));
    snprintf(where, sizeof where, "swings over where a stage begins");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 8);
        for (int k = 0; k < 4; k++) {
            film_state s;
            double gamma = k % 2 ? 1e-6 : 0.0, short_of = k / 2 ? 1e-8 : 1e-10;
            HOLD(film_init(&curve, &s, 0.0, 1e-3 * (40.0 - short_of), gamma, 0.0, 0.0) == FILM_OK);
            while (s.event != FILM_MAXIMUM_INDENTATION) HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT);
            HOLD(film_input(&s, 6e-5, 0.0, 0.0) == FILM_OK);
            double begin = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift), most = 0.0;
            for (int i = 0; i < 2000; i++) {
                int status = film_step(&curve, &own.mesh, &s, 1e-3);
                HOLD((status == FILM_OK || status == FILM_EVENT) && s.force >= 0.0);
                most = fmax(most, s.force);
                double now = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift);
                HOLD(now <= begin + 1e-10 * (0.5 * s.nu * s.nu + 6e-5 * 40.0));
            }
            HOLD(most > 8e-5); /* it has been in the steeper one */
        }
        free(own.memory);
    }
}

/* Held by a faint load, out to where a stage begins with a root: from the last number above it the force is large, and at it
 * none; the motion creeps or goes on, but does not stay for lines without end. */
static void check_root(void) {
    film_curve curve;
    double edge = nextafter(0.1, 1.0); /* odd in its last digit: halfway to the next number rounds to that */
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, edge, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(edge, 1e-18, 0.0, 1e5, 0.3));
    snprintf(where, sizeof where, "out to where a root begins");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        for (int32_t nodes = 1; nodes <= 3; nodes++) {
            owned_mesh own = make_mesh(linearisation, nodes, nodes);
            for (int i = 0; i < 20; i++) {
                film_state s;
                HOLD(film_init(&curve, &s, 0.0, over_decades(1e-6, 1e-3), over_decades(1e-8, 1e-4), 1e-23, 0.0) == FILM_OK);
                for (int n = 0, status = FILM_EVENT; n < 40 && status == FILM_EVENT; n++) {
                    int32_t drawn = s.lines;
                    status = film_step(&curve, &own.mesh, &s, INFINITY);
                    HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && s.lines - drawn <= FOUND_LINES);
                }
            }
            free(own.memory);
        }
    }
}

/* A turn within rounding of where a stage begins, of which the work is known to less than the way back does: without a load
 * nothing turns the impactor again. */
static void check_out(void) {
    film_curve curve;
    double edge = 0.10225308097531023, slope = 1.0243235815473825e-17, x = edge - 0.004;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, edge, power(0.0, 0.0, slope, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(0.004, slope * edge - 8.7e-4 * pow(x, 1.5), 0.0, 8.7e-4, 1.5));
    curve.piece[1].work_at_begin = x * (curve.piece[1].force.constant + 8.7e-4 * pow(x, 1.5) / 2.5);
    snprintf(where, sizeof where, "out from a turn in rounding");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 1, 17);
        for (int i = -100; i < 100; i++) {
            film_start start = {sqrt(slope) * edge * (1.0 + 2.3e-16 * i), 0.0, 0.0, 0.0, INFINITY, 0.0};
            film_summary summary;
            HOLD(film_impact(&curve, &own.mesh, &start, &summary) == FILM_EVENT && summary.lines <= FOUND_LINES);
        }
        free(own.memory);
    }
}

/* A force that is nothing for the most of the way, up to an end far beyond the turn: aimed at from chords of hardly any slope. */
static void check_faint(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 30.0, power(0.0, 0.0, 0.0, 4.8e-71, 50.0));
    snprintf(where, sizeof where, "hardly any force for the most of the way");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 6, 8);
        for (int i = 0; i < 20; i++) {
            film_start start = {over_decades(1e-4, 1e-2), over_decades(1e-4, 1e-2), 0.0, 0.0, INFINITY, 0.0};
            film_summary summary;
            HOLD(film_impact(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
            double depth = pow(51.0 * 0.5 * start.nu * start.nu / 4.8e-71, 1.0 / 51.0);
            NEAR(summary.maximum_indentation, depth, depth, 0.05); /* a chord of six does too much work */
            HOLD(isfinite(summary.shift) && summary.final_velocity < 0.0);
        }
        free(own.memory);
    }
}

/* One stage of coefficient x^exponent, with a damping of constant + x^0.25. */
static film_curve dashpot(double end, double coefficient, double exponent, double constant) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, end, power(0.0, 0.0, 0.0, coefficient, exponent));
    curve.stage[0].damped = 1;
    piece->damping = power(0.0, constant, 0.0, 1.0, 0.25);
    HOLD(film_check_curve(&curve) == FILM_OK);
    return curve;
}

/* Pulled out of a dashpot, slowly, on lines too long for it: none ends with a force that is not the law's. */
static void check_drawn_out(void) {
    snprintf(where, sizeof where, "pulled out of a dashpot, slowly");
    film_curve curve = dashpot(INFINITY, 1e5, 1.5, 0.0);
    for (int i = 0; i < 3000; i++) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, whole(1, 8), whole(1, 8));
        film_summary summary;
        film_start start = {over_decades(300.0, 3000.0), over_decades(10.0, 100.0), -over_decades(1e-5, 1e-3), 0.0, INFINITY, over_decades(10.0, 100.0)};
        int status = film_impact(&curve, &own.mesh, &start, &summary);
        HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && summary.lines <= FOUND_LINES);
        HOLD(isfinite(summary.work) && summary.maximum_force <= start.nu);
        free(own.memory);
    }
}

/* A pull a billion times the contact force stops the impactor at once: the target has moved as far as its momentum says. */
static void check_pulled(void) {
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 3, 3);
    snprintf(where, sizeof where, "a pull a billion times the contact force");
    for (int i = 0; i < 40; i++) {
        HOLD(film_init(&curves[LINEAR], &s, 0.0, over_decades(1.0, 100.0), over_decades(1.0, 10.0), 0.0, 0.0) == FILM_OK);
        while (s.event != FILM_MAXIMUM_INDENTATION) HOLD(film_step(&curves[LINEAR], &own.mesh, &s, INFINITY) == FILM_EVENT);
        HOLD(film_input(&s, -1e9 * s.force, 0.0, 0.0) == FILM_OK);
        film_state before = s;
        HOLD(film_step(&curves[LINEAR], &own.mesh, &s, INFINITY) == FILM_EVENT && s.event == FILM_IMPACTOR_STOPS);
        double way = s.xi + s.shift - before.xi - before.shift; /* under one force */
        NEAR(way, 0.5 * before.nu * before.nu / (1e9 * before.force), before.gamma * before.nu + 1e6 * way, 1e-14);
    }
    free(own.memory);
}

/* Stopped on a way that is rounding of the indentation: the line has a slope as the law's, and may be asked a little late. */
static void check_no_way(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    curve.stage[0].unloading = FILM_RESIDUAL;
    piece->recovery = power(0.0, 0.0, 0.165, 0.0, 1.0);
    piece->exponent = power(0.0, 0.515, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "a stop on a way that is rounding");
    HOLD(film_check_curve(&curve) == FILM_OK);
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 3, 3);
    for (int i = 0; i < 40; i++) {
        film_state s;
        double values[5];
        HOLD(film_init(&curve, &s, 0.0, over_decades(1e-14, 1e-12), over_decades(1e-6, 1e-4), -1e-3, 0.0) == FILM_OK);
        while (s.event != FILM_IMPACTOR_STOPS) HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT);
        HOLD(fabs(s.line.kappa) < 1e-3);
        film_evaluate(&curve, &s.line, 1e-15 * s.time, values);
        for (int j = 0; j < 5; j++) HOLD(isfinite(values[j]));
    }
    free(own.memory);
}

/* Pulled out of a dashpot next to which the spring is nothing: at rest it holds, and the least motion outwards lets go. */
static void check_lets_go(void) {
    snprintf(where, sizeof where, "pulled out of a dashpot next to which the spring is nothing");
    film_curve curve = dashpot(30.0, 4.8e-71, 50.0, 0.0);
    for (int i = 0; i < 300; i++) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, whole(1, 8), whole(1, 8));
        film_state s;
        HOLD(film_init(&curve, &s, 0.0, over_decades(1e-4, 1e-2), over_decades(1e-3, 1e-1), -over_decades(1e-3, 1e-1), 0.0) == FILM_OK);
        HOLD(film_damp(&s, over_decades(1e-2, 1.0)) == FILM_OK);
        for (int count = 0; s.event != FILM_CONTACT_ENDS && count < 20; count++) {
            HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT);
            HOLD(isfinite(s.time) && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.shift) && isfinite(s.spent));
        }
        HOLD(s.event == FILM_CONTACT_ENDS);
        free(own.memory);
    }
}

/* Stopped by a dashpot alone, where the spring's force is so small that its square is none. */
static void check_no_spring(void) {
    snprintf(where, sizeof where, "stopped by a dashpot next to which the spring is nothing");
    film_curve curve = dashpot(1000.0, 1.9e-146, 49.0, 1.0);
    for (int i = 0; i < 40; i++) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, whole(1, 8), whole(1, 8));
        film_state s;
        int status = FILM_OK;
        HOLD(film_init(&curve, &s, 0.0, over_decades(1e-3, 1e-1), over_decades(1.0, 30.0), 0.0, 0.0) == FILM_OK);
        HOLD(film_damp(&s, over_decades(10.0, 30.0)) == FILM_OK);
        for (int count = 0; status >= 0 && status != FILM_ENDLESS && count < 20; count++) {
            status = film_step(&curve, &own.mesh, &s, 30.0);
            HOLD(status >= 0 && s.lines <= FOUND_LINES && isfinite(s.xi) && isfinite(s.nu));
            HOLD(film_input(&s, count % 2 ? 0.0 : 1e-9, 0.0, 0.0) == FILM_OK); /* aimed afresh */
        }
        free(own.memory);
    }
}

/* A coefficient as large as numbers are, of a power that is as small. */
static void check_huge(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1e-6, power(0.0, 0.0, 0.0, 1e308, 50.0));
    film_state s;
    snprintf(where, sizeof where, "a coefficient of 1e308");
    HOLD(film_check_curve(&curve) == FILM_OK);
    HOLD(film_init(&curve, &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK && film_switch(&curve, &s) == FILM_EVENT);
    film_contact small = film_force(&curve, &s, 1e-9, 1.0), large = film_force(&curve, &s, 9e-7, 1.0);
    HOLD(small.force == 0.0 && small.by_xi == 0.0);
    NEAR(large.by_xi, 50.0 * large.force / 9e-7, large.by_xi, EXACT);
}

int main(void) {
    lines = room_for(LINE_ROOM, sizeof *lines);
    events = room_for(EVENT_ROOM, sizeof *events);
    curves[HERTZ] = hertz_curve();
    curves[ELASTOPLASTIC] = elastoplastic_curve();
    curves[SERIES] = series_curve();
    curves[LINEAR] = linear_curve();
    curves[CLEARANCE] = clearance_curve();
    curves[DENTED] = dented_curve();
    curves[VARIED] = varied_curve();
    curves[SOFTENING] = softening_curve();
    curves[LAMINATE] = laminate_curve();
    curves[SHIFTED] = shifted_curve();
    curves[DAMPED] = damped_curve();
    curves[SPRUNG] = sprung(curves[ELASTOPLASTIC]);
    curves[SPRUNG_LAMINATE] = sprung(curves[LAMINATE]);
    curves[SPRUNG_SHIFTED] = sprung(curves[SHIFTED]);
    check_bad_curves();
    check_bad_meshes();
    check_hertz();
    check_found();
    check_crept();
    check_huge();
    check_softened();
    check_meeting();
    check_beside();
    check_swings();
    check_root();
    check_out();
    check_faint();
    check_pulled();
    check_no_way();
    check_lets_go();
    check_no_spring();
    check_drawn_out();
    check_motions();
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh few = make_mesh(linearisation, 3, 5), fine = make_mesh(linearisation, 40, 80);
        check_bad_numbers(&few.mesh);
        check_endless(&few.mesh);
        check_clock(&few.mesh);
        check_tiny(&few.mesh);
        check_beyond(&few.mesh);
        check_branching(&few.mesh);
        check_linear_law(&few.mesh);
        if (linearisation == FILM_WORK_PRESERVING) check_series(&fine.mesh);
        for (int which = 0; which < BATCH_CURVES; which++) {
            check_batch(which, &few.mesh, 1e-5, 0.5);
            check_batch(which, &fine.mesh, 1e-12, 1e-4);
        }
        free(few.memory);
        free(fine.memory);
    }
    for (int i = 0; i < RANDOM_IMPACTS || i < RANDOM_SCHEDULES; i++) {
        owned_mesh own = make_mesh(whole(0, 3) ? FILM_WORK_PRESERVING : FILM_CHORD, whole(1, SEGMENTS_MOST), whole(1, SEGMENTS_MOST));
        int which = whole(0, CURVES - 1);
        film_start start = random_start(which);
        if (i < RANDOM_IMPACTS) one_contact(which, &own.mesh, &start);
        if (i < RANDOM_SCHEDULES) one_schedule(which, &own.mesh);
        free(own.memory);
    }
    free(lines);
    free(events);
    printf("core_check: %ld checks, %ld contacts, %ld events, hash %016llx\n", checks, contacts, events_seen,
           (unsigned long long)hash);
    return 0;
}
