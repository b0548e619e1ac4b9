/* The core alone, without Python: thousands of pseudo-random impacts, what must hold in each of them, and one hash over
 * all results, which must not depend on how the compiler optimises. Builds with nothing but the core's sources:
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/core_check.c film_model/core/film_*.c -lm
 *
 * Prints one line with counts and the hash; exits with 1 after saying what does not hold. */
#include "film_core.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double EXACT = 1e-12;   /* agreement that only rounding disturbs, of the largest value of its kind */
static const double ENERGY = 1e-11;  /* balance of energy over a whole contact: the sum of some hundred roundings */

enum { RANDOM_IMPACTS = 3000, RANDOM_SCHEDULES = 1500, SEGMENTS_MOST = 24, LINE_ROOM = 4096, EVENT_ROOM = 256, SAMPLES = 60 };
enum { CURVES = 4, PARTS = 6, BATCH = 500 };

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

/* x^1.5 up to 1, as a series in the root; then 1 + (x - 1) + (x - 1)^2/4 in two pieces up to 3, where the law ends. */
static film_curve series_curve(void) {
    static const double root_force[] = {0.3125, 0.46875, 0.1875, 0.03125};
    static const double root_work[] = {7.875 / 80, 13.125 / 80, 7.5 / 80, 2.8125 / 80, 0.625 / 80, 0.0625 / 80};
    static const double first_force[] = {1.59375, 0.625, 0.03125};
    static const double first_work[] = {0.5 + 0.125 + 0.0625 + 5.0 / 192, 0.5 + 0.25 + 5.0 / 128, 0.0625 + 1.0 / 64,
                                        1.0 / 384};
    static const double second_force[] = {2.84375, 0.875, 0.03125};
    static const double residual[] = {0.375, 0.5, 0.125}; /* (x - 1)^2/4 */
    static const double exponent[] = {1.4, 0.1};
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, series(FILM_ROOT_SERIES, 0.0, 1.0, 4, root_force))->work =
        series(FILM_ROOT_SERIES, 0.0, 1.0, 6, root_work);
    film_piece *piece = add_stage(&curve, 3.0, series(FILM_SERIES, 1.0, 2.0, 3, first_force));
    piece[0].end = 2.0;
    piece[0].work = series(FILM_SERIES, 1.0, 2.0, 4, first_work);
    piece[0].recovery = series(FILM_SERIES, 1.0, 3.0, 3, residual);
    piece[0].exponent = series(FILM_SERIES, 1.0, 3.0, 2, exponent);
    piece[1] = piece[0];
    piece[1].end = 3.0;
    piece[1].force = series(FILM_SERIES, 2.0, 3.0, 3, second_force);
    double begin = 1.0 + 0.5 + 1.0 / 12; /* work of the first piece */
    const double second_work[] = {begin + 1.125 + 0.125 + 0.0625 + 13.0 / 192, 0.0, 0.0, 1.0 / 384};
    piece[1].work = series(FILM_SERIES, 2.0, 3.0, 4, second_work);
    /* 2.25 u + 0.75 u^2 + u^3/12 with u = (1 + z)/2, plus `begin` */
    piece[1].work.series[0] = begin + 2.25 / 2 + 0.75 / 4 * 1.5 + 1.0 / 96 * 2.5;
    piece[1].work.series[1] = 2.25 / 2 + 0.75 / 4 * 2.0 + 1.0 / 96 * 3.75;
    piece[1].work.series[2] = 0.75 / 4 * 0.5 + 1.0 / 96 * 1.5;
    piece[1].work.series[3] = 1.0 / 96 * 0.25;
    /* u + u^2/2 + u^3/12 */
    piece[0].work.series[0] = 1.0 / 2 + 0.5 / 4 * 1.5 + 1.0 / 96 * 2.5;
    piece[0].work.series[1] = 1.0 / 2 + 0.5 / 4 * 2.0 + 1.0 / 96 * 3.75;
    piece[0].work.series[2] = 0.5 / 4 * 0.5 + 1.0 / 96 * 1.5;
    piece[0].work.series[3] = 1.0 / 96 * 0.25;
    curve.stage[1].count = 2;
    curve.stage[1].unloading = FILM_RESIDUAL;
    curve.pieces = 3;
    return curve;
}
