/* Of core_check.c: checking, hashing, curves and meshes. */
#ifndef CORE_CHECK_TOOLS_H
#define CORE_CHECK_TOOLS_H

#include "film_core.h"
#include "march/film_line.h"
#include "power_function.h"
#include "random_numbers.h"

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

/* ---------------------------------------------------------------- checking, hashing */

static long checks = 0, contacts = 0, events_seen = 0;
static uint64_t hash = 14695981039346656037u;
static char where[200] = "";

static void hold(int condition, const char *what, const char *file, int line) {
    checks++;
    if (condition) return;
    printf("%s:%d: does not hold: %s\n    in %s\n", file, line, what, where);
    exit(1);
}
#define HOLD(condition) hold((condition), #condition, __FILE__, __LINE__)

static void near(double a, double b, double scale, double tolerance, const char *what, const char *file, int line) {
    checks++;
    if (fabs(a - b) <= tolerance * scale) return;
    printf("%s:%d: %s: %.17g and %.17g differ by %.2e of %.3g\n    in %s\n", file, line, what, a, b,
           fabs(a - b) / scale, scale, where);
    exit(1);
}
#define NEAR(a, b, scale, tolerance) near((a), (b), (scale), (tolerance), #a " = " #b, __FILE__, __LINE__)

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

enum { EVENTS_MOST = 1000 }; /* of a contact that is asked to come to an event: more, and it never will */

/* Steps from event to event, up to one of the kind. */
static void step_to(const film_curve *curve, const film_mesh *mesh, film_state *s, int32_t event) {
    for (int k = 0; s->event != event; k++) HOLD(k < EVENTS_MOST && film_step(curve, mesh, s, INFINITY) == FILM_EVENT);
}

static void *room_for(size_t count, size_t size) {
    void *memory = malloc(count * size + (count == 0));
    if (memory == NULL) {
        printf("no memory\n");
        exit(2);
    }
    return memory;
}

/* ---------------------------------------------------------------- curves */

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

static film_curve sprung(film_curve curve) {
    HOLD(film_spring(&curve, 0.3) == FILM_OK);
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

/* Drawn in this order, as the order in which a function's arguments are evaluated depends on the compiler. */
static owned_mesh random_mesh(int32_t most) {
    int32_t unloading = whole(1, most), loading = whole(1, most);
    return make_mesh(FILM_WORK_PRESERVING, loading, unloading);
}

#endif
