/* The core under inputs that were chosen to break it: bytes become a curve of stages, a mesh, a start, and steps, loads and
 * supports one after the other; of each it is asked that the outcome is one that film_core.h names, that no number is NaN
 * and no call draws lines without end, that energy and momentum are kept, and that a saved state runs on to the same bits.
 *
 * With a guide that looks for new ways through the code (clang's libFuzzer), for as long as one likes:
 *
 *     clang -std=c99 -O1 -g -DGUIDED -fsanitize=fuzzer,address,undefined -fno-sanitize-recover=all -ffp-contract=off \
 *         -I film_model/core tests/core_fuzz.c $(find film_model/core -name 'film_*.c') -lm -o core_fuzz
 *     mkdir corpus && ./core_fuzz corpus -max_len=600 -timeout=60 -max_total_time=3600
 *
 * Without: `core_fuzz 20000` runs that many inputs of its own, always the same; `core_fuzz FILE...` runs inputs again.
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/core_fuzz.c $(find film_model/core -name 'film_*.c') -lm -o core_fuzz
 */
#include "film_core.h"
#include "power_function.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 20000, EVENTS = 400, SEGMENTS_MOST = 40, EVENTS_A_CALL = 60, CALLS = 24, BATCH = 40 };

static const double EXACT = 1e-9;  /* of the largest value of its kind: rounding, which adverse numbers multiply */
static const double LINES_MEET = 1e-7; /* where a line is cut at a turn or a stop, ways of 1e-9 of the depth are neglected */
static const double STIFF = 60.0;  /* damping over a line, up to which the rule of five points integrates it */

/* Abscissas and weights of Gauss's rule on 0 .. 1. */
enum { GAUSS = 5 };
static const double GAUSS_AT[GAUSS] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155, 0.953089922969332};
static const double GAUSS_WEIGHT[GAUSS] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                           0.23931433524968324, 0.11846344252809454};

static char where[300];
static long runs, calls, events_seen, lines_seen, refused[16];

static film_curve curve;
static double none, idle; /* what rounding makes of a force of 0, and of no work */

static void tell(const char *name, const film_function *g) {
    fprintf(stderr, "      %s: form %d, origin %.17g, %.17g + %.17g x + %.17g x^2 + %.17g x^%.17g", name, (int)g->form, g->origin, g->constant,
            g->slope, g->square, g->coefficient, g->exponent);
    for (int k = 0; k < g->terms; k++) fprintf(stderr, "%s %.17g", k ? "," : "; series", g->series[k]);
    fprintf(stderr, "\n");
}

static void fail(const char *what, int line) {
    fprintf(stderr, "core_fuzz.c:%d: %s\n    in %s\n", line, what, where);
    for (int32_t k = 0; k < curve.stages; k++) {
        const film_stage *stage = &curve.stage[k];
        fprintf(stderr, "    stage %d from %.17g to %.17g, unloading %d, reloading %g\n", (int)k, stage->begin, stage->end, (int)stage->unloading,
                stage->reload_exponent);
        for (int32_t i = stage->first; i < stage->first + stage->count; i++) {
            tell("force", &curve.piece[i].force);
            if (stage->unloading != FILM_RETRACE) tell("recovery", &curve.piece[i].recovery);
            if (stage->unloading != FILM_RETRACE) tell("exponent", &curve.piece[i].exponent);
            if (stage->damped) tell("damping", &curve.piece[i].damping);
        }
    }
    abort();
}

#define HOLD(condition)                                                    \
    do {                                                                   \
        if (!(condition)) fail("does not hold: " #condition, __LINE__);    \
    } while (0)

static void near(double a, double b, double scale, double tolerance, int one_sided, const char *what, int line) {
    static char text[400];
    if (fabs(a - b) <= tolerance * scale || (one_sided && a <= b)) return;
    snprintf(text, sizeof text, "%s: %.17g and %.17g differ by %.2e of %.3g", what, a, b, fabs(a - b) / scale, scale);
    fail(text, line);
}
#define NEAR(a, b, scale, tolerance) near((a), (b), (scale), (tolerance), 0, #a " = " #b, __LINE__)
#define NO_MORE(a, b, scale, tolerance) near((a), (b), (scale), (tolerance), 1, #a " <= " #b, __LINE__)

/* ---------------------------------------------------------------- bytes */

static const uint8_t *data;
static size_t left_over;

static uint32_t byte(void) {
    if (left_over == 0) return 0;
    left_over--;
    return *data++;
}

static int32_t whole(int32_t low, int32_t high) { return low + (int32_t)(byte() % (uint32_t)(high - low + 1)); }

static double fraction(void) { /* 0 .. 1, and now and then all the bits of a double */
    uint32_t high = byte(), low = byte();
    double x = (256.0 * high + low) / 65535.0;
    if (high % 16 == 7) x += (byte() * 256.0 + byte()) * 0x1p-52;
    return x < 1.0 ? x : 1.0;
}

static double decades(double low, double high) { return low * pow(high / low, fraction()); }

/* One ulp or a few beside x, or x itself. */
static double beside(double x) {
    int32_t n = whole(-2, 2);
    for (; n > 0; n--) x = nextafter(x, INFINITY);
    for (; n < 0; n++) x = nextafter(x, -INFINITY);
    return x;
}

/* ---------------------------------------------------------------- curves */

static double any_exponent(void) {
    static const double usual[] = {1.5, 1.0, 2.0, 1.0 + 1e-12, 2.5, 0.5, 1.2, 0.3, 50.0};
    int32_t k = whole(0, 15);
    return k < 9 ? usual[k] : decades(0.3, 50.0);
}

/* A series without a zero: its first term is more than all others. size: about its largest value. */
static film_function any_series(double begin, double end, double size) {
    film_function g = power(begin, 0.0, 0.0, 0.0, 1.0);
    g.form = whole(0, 1) ? FILM_SERIES : FILM_ROOT_SERIES;
    g.per_span = 1.0 / (end - begin);
    g.terms = whole(1, 8);
    double others = 0.0;
    for (int k = 1; k < g.terms; k++) others += fabs(g.series[k] = size * (fraction() - 0.5) / k);
    g.series[0] = others + size * (whole(0, 3) ? fraction() : 0.0);
    return g;
}

/* The mean of a series from where its interval begins: of the same degree, so its values at as many points give it. */
static film_function mean_of(const film_function *f) {
    static const double pi = 3.14159265358979323846;
    film_function mean = *f;
    memset(mean.series, 0, sizeof mean.series);
    for (int j = 0; j < f->terms; j++) {
        double angle = pi * (j + 0.5) / f->terms, part = 0.5 * (1.0 + cos(angle)), value = 0.0;
        for (int i = 0; i < GAUSS; i++) {
            double z = 2.0 * part * GAUSS_AT[i] - 1.0, before = 1.0, now = z, sum = f->series[0];
            for (int k = 1; k < f->terms; k++) {
                double next = 2.0 * z * now - before;
                sum += f->series[k] * now;
                before = now;
                now = next;
            }
            value += GAUSS_WEIGHT[i] * sum * (f->form == FILM_ROOT_SERIES ? 2.0 * GAUSS_AT[i] : 1.0);
        }
        for (int k = 0; k < f->terms; k++) mean.series[k] += (k ? 2.0 : 1.0) / f->terms * value * cos(k * angle);
    }
    return mean;
}

static double force_at(int32_t stage, double xi) {
    double force, work;
    film_law(&curve, stage, xi, &force, &work);
    return force;
}

/* One piece of a stage: the power of all of it, or a series. */
static void any_piece(film_piece *piece, double begin, double end, double before, int jumps, int inner, int fitted) {
    double size = before > 0.0 && whole(0, 7) ? before : decades(1e-3, 1e3);
    double start = !jumps || whole(0, 3) ? before : before * 2.0 * fraction();
    piece->end = end;
    if (!fitted) {
        double origin = whole(0, 3) || !(start > 0.0) ? begin : begin * fraction(), q = any_exponent(), span = (end < INFINITY ? end : begin + 1.0) - begin;
        double slope = whole(0, 1) ? 0.0 : size * decades(1e-6, 1e2) / span, rise = whole(0, 3) ? size * decades(1e-6, 1e2) : 0.0;
        if (whole(0, 7) == 0 && end < INFINITY) slope = rise = 0.0;
        if (whole(0, 7) == 0) slope = size * 1e-14;
        if (whole(0, 3) == 0 && end < INFINITY) slope = -0.9 * fraction() * start / span; /* it softens */
        if (!(slope > 0.0) && !(rise > 0.0) && !(end < INFINITY)) slope = size;
        piece->force = power(origin, 0.0, slope, rise * pow(span + begin - origin, -q), q);
        double x = begin - origin, square = slope < 0.0 || whole(0, 5) ? 0.0 : size * decades(1e-6, 1e2) / (span * span);
        piece->force.square = square;
        double there = (slope + square * x) * x + (rise > 0.0 ? piece->force.coefficient * pow(x, q) : 0.0);
        piece->force.constant = start - there;
        if (slope < 0.0 && piece->force.constant + slope * (span + x) < 0.0) {
            piece->force.slope = 0.0;
            piece->force.constant += slope * x;
        }
        if (!isfinite(piece->force.coefficient) || !isfinite(piece->force.constant)) piece->force = power(begin, start, size, 0.0, 1.0);
        const film_function *f = &piece->force;
        x = begin - f->origin;
        piece->work_at_begin = x > 0.0 ? x * (f->constant + (0.5 * f->slope + f->square / 3.0 * x) * x + f->coefficient * pow(x, f->exponent) / (f->exponent + 1.0)) : 0.0;
    } else {
        piece->force = any_series(begin, end, size);
        if (inner) piece->force.form = FILM_SERIES;
        if (!jumps) { /* the constant that makes it begin where the one before ends, or the series as it is and nothing */
            double at_begin = 0.0, most = 0.0;
            for (int k = 0; k < piece->force.terms; k++) at_begin += (k % 2 ? -1.0 : 1.0) * piece->force.series[k];
            for (int k = 1; k < piece->force.terms; k++) most += fabs(piece->force.series[k]);
            piece->force.series[0] += before - at_begin;
            if (piece->force.series[0] < most) piece->force.series[0] = -1.0; /* not usable */
        }
        piece->mean = mean_of(&piece->force);
    }
}

static void any_unloading(film_stage *stage, film_piece *piece, double force) {
    double begin = stage->begin, q = whole(0, 1) ? 1.5 : decades(0.3, 8.0);
    if (stage->unloading == FILM_RADIUS) q = fmax(q, 1.0); /* or it leads to billions of depths above the surface */
    piece->exponent = power(0.0, q, whole(0, 3) || !(stage->end < 30.0) ? 0.0 : 0.1 * fraction(), 0.0, 1.0);
    switch (stage->unloading) {
    case FILM_RADIUS: piece->recovery = power(begin, whole(0, 1) ? 1.0 : decades(0.1, 10.0), 0.0, whole(0, 1) ? 0.0 : fraction(), 1.5); break;
    case FILM_RESIDUAL: piece->recovery = power(0.0, 0.0, whole(0, 3) ? fraction() : 1.0 - 1e-9, 0.0, 1.0); break;
    case FILM_SECANT: piece->recovery = power(begin, decades(1e-2, 1e2) * (force + 1e-3), 0.0, whole(0, 1) ? 0.0 : fraction(), 0.5); break;
    case FILM_SHIFTED: piece->recovery = power(begin, decades(0.5, 20.0) * (force + 1e-3), fraction(), 0.0, 1.0); break;
    default: break;
    }
}

/* A law that pulls: parting and pulling down to and up from its largest tension of 1, pushing, and now and then yielding, with
 * a branch of the first three stages stretched. */
static void pulling_curve(void) {
    double least = -decades(1e-3, 3.0), deepest = least * fraction(), free = decades(0.1, 3.0), end = free + decades(0.1, 30.0);
    double left = whole(0, 3) ? fraction() : 0.0, slope = 1.0 / (free - deepest), q = decades(1.01, 3.0), k = decades(1e-2, 10.0);
    int yields = whole(0, 2) > 0, parts = least < deepest && whole(0, 3);
    double force[] = {-left, -1.0, 0.0, slope * (end - free) + k * pow(end - free, q)}, at[] = {least, deepest, free, end};
    curve.pull = 1.0;
    for (int32_t i = parts ? 0 : 1; i < 3 + yields; i++) {
        film_stage *stage = &curve.stage[curve.stages++];
        film_piece *piece = &curve.piece[curve.pieces];
        stage->begin = at[i];
        stage->end = piece->end = i == 3 || (i == 2 && !yields) ? INFINITY : at[i + 1];
        stage->first = curve.pieces++;
        stage->count = 1;
        if (i < 2) piece->force = power(at[i], force[i], (force[i + 1] - force[i]) / (at[i + 1] - at[i]), 0.0, 1.0);
        else piece->force = power(at[i], force[i], i == 2 ? slope : decades(0.1, 10.0), i == 2 ? k : 0.0, i == 2 ? q : 1.0);
        piece->exponent = power(end, 1.0, 0.0, 0.0, 1.0);
        piece->recovery = power(end, decades(0.1, 10.0), i == 3 ? decades(1e-3, 3.0) : 0.0, 0.0, 1.0);
        if (i == 3) stage->unloading = FILM_SIMILAR;
        else if (i == 2 && yields) piece->end = end + decades(1.0, 1e6);
    }
}

/* Stages, each where the one before ends. */
static void any_curve(void) {
    memset(&curve, 0, sizeof curve);
    if (whole(0, 7) == 0) {
        pulling_curve();
        return;
    }
    int32_t stages = whole(1, 5), damped = stages == 1 && whole(0, 1);
    int jumps = whole(0, 3) == 0; /* the way back over a jump would be a slide along it: no stage goes back as it came */
    double begin = 0.0, force = 0.0;
    for (int32_t k = 0; k < stages; k++) {
        film_stage *stage = &curve.stage[k];
        int32_t last = k == stages - 1, endless = last && whole(0, 3);
        stage->begin = begin;
        stage->first = curve.pieces;
        stage->end = endless ? INFINITY : begin + (whole(0, 15) ? decades(0.1, 30.0) : decades(1e-6, 1e3));
        if (!(stage->end > begin)) stage->end = nextafter(begin, INFINITY);
        /* as film_model's curve_of: a stage is one power, or fitted in pieces; its other functions are each one function */
        int fitted = begin > 0.0 && stage->end < INFINITY && whole(0, 3) == 0;
        stage->count = fitted ? whole(1, 4) : 1;
        stage->damped = damped;
        stage->unloading = damped || (!(jumps && k > 0) && whole(0, 2) == 0) ? FILM_RETRACE : whole(FILM_RADIUS, FILM_SHIFTED);
        if (stage->unloading != FILM_RETRACE)
            stage->reload_exponent = whole(0, 3) ? 0.0 : decades(0.3, 6.0);
        double from = begin;
        curve.stages = k + 1;
        for (int32_t i = 0; i < stage->count; i++) {
            film_piece *piece = &curve.piece[curve.pieces++];
            int32_t final = i == stage->count - 1;
            double end = final ? stage->end : from + (isfinite(stage->end) ? (stage->end - from) * (0.1 + 0.8 * fraction()) : decades(0.1, 10.0));
            if (!final && !(end > from && end < stage->end)) { /* no room for another */
                end = stage->end;
                final = 1;
                stage->count = i + 1;
            }
            any_piece(piece, from, end, force, jumps && k > 0 && i == 0, i > 0, fitted);
            if (i == 0) any_unloading(stage, piece, force);
            else piece->recovery = piece[-1].recovery, piece->exponent = piece[-1].exponent;
            double work = 0.0;
            if (i > 0) film_law(&curve, k, from, &force, &work); /* of the piece before */
            piece->work_at_begin -= work;
            if (stage->damped && i > 0) piece->damping = piece[-1].damping; /* without jumps */
            else if (stage->damped) piece->damping = power(0.0, whole(0, 1) ? 0.0 : fraction(), 0.0, fraction(), whole(0, 1) ? 0.25 : decades(0.1, 4.0));
            from = end;
            force = isfinite(end) ? force_at(k, end) : 0.0;
            if (!(force >= 0.0)) force = 0.0;
        }
        begin = stage->end;
    }
}

/* A curve's force must not be negative, nor turn or be 0 within a stage, and numbers must be numbers: what the fuzzer makes of its
 * bytes may be none of that. */
static int usable(void) {
    if (film_check_curve(&curve) != FILM_OK) return 0;
    none = idle = 0.0;
    if (curve.pull > 0.0) return 1;
    for (int32_t p = 0; p < curve.pieces; p++) {
        none = fmax(none, 4e-16 * fabs(curve.piece[p].force.constant));
        idle = fmax(idle, 4e-16 * fabs(curve.piece[p].work_at_begin));
    }
    double worked = 0.0; /* by the stages before */
    for (int32_t k = 0; k < curve.stages; k++) {
        const film_stage *stage = &curve.stage[k];
        double begin = stage->begin, least = 0.0, before = NAN, deepest = fabs(curve.piece[stage->first].work_at_begin), work = 0.0, last = begin;
        int rises = 0, falls = 0;
        /* what a stage begins with is not the rounding of what it is made of */
        if (k > 0 && (force_at(k, begin) < EXACT * fabs(curve.piece[stage->first].force.constant) || worked < EXACT * deepest)) return 0;
        for (int32_t p = stage->first; p < stage->first + stage->count; p++) {
            double end = isfinite(curve.piece[p].end) ? curve.piece[p].end : begin + 10.0;
            for (int32_t i = 0; i <= 32; i++) {
                double force, done, xi = begin + (end - begin) * i / 32.0;
                film_law(&curve, k, xi, &force, &done);
                if (!isfinite(force) || !isfinite(done) || force > 1e30) return 0;
                if (force > 0.0 && before == 0.0 && last > stage->begin) return 0; /* a root within */
                if (done < work - 1e-9 * (fabs(work) + fabs(done))) return 0; /* lost in rounding */
                least = fmin(least, force);
                rises += force > before * (1.0 + 1e-12);
                falls += force < before * (1.0 - 1e-12);
                before = force;
                work = done;
                last = xi;
            }
            begin = end;
        }
        if (least < 0.0 || (rises && falls) || deepest > 1e4 * work) return 0;
        worked += work;
    }
    return 1;
}

/* ---------------------------------------------------------------- what must hold */

static film_mesh mesh;
static double memory[12 * (SEGMENTS_MOST + 1)]; /* film_mesh_size and some */
static film_line lines[LINES];
static film_state events[EVENTS];

static void documented(int status) {
    HOLD(status == FILM_OK || status == FILM_EVENT || status == FILM_ENDLESS || status == FILM_BEYOND_LAW || status == FILM_BAD_UNLOADING ||
         status == FILM_TOO_STIFF);
    if (status < 0) refused[-status]++;
}

static void sane(const film_state *s, int status) {
    if (status < 0) return; /* a failure leaves the state where it was met */
    HOLD(isfinite(s->time) && isfinite(s->xi) && isfinite(s->nu) && isfinite(s->shift) && isfinite(s->force) && isfinite(s->spent));
    HOLD(s->force >= -none - film_pull(&curve, s) * (1.0 + EXACT) && s->force_peak >= -curve.pull * fmax(1.0, s->f_scale) && isfinite(s->force_peak));
    HOLD(s->phase >= FILM_APPROACHING && s->phase <= FILM_SEPARATED);
    HOLD(s->branch > FILM_STRETCHED - FILM_MAX_STAGES && s->branch < curve.stages);
    HOLD(s->gamma > 0.0 || s->shift == 0.0);
}

/* Lines of one call: the nodes of a leg, and what is cut between two of them. */
static void bounded(int32_t drawn) { HOLD(drawn <= 8 * (mesh.loading + mesh.unloading) + 400); }

/* Energy of the impactor, less what the load has put in, and with what the indentation has taken: no more than before. */
static double energy(const film_state *s) { return 0.5 * s->nu * s->nu + s->spent - s->load * (s->xi + s->shift); }

static double energy_scale(const film_state *s) {
    double rounding = idle + 4e-16 * fabs(s->line.f_shift * s->xi); /* of the work of a branch that is a small part of its curve */
    return 0.5 * s->nu * s->nu + fabs(s->spent) + fabs(s->load) * (fabs(s->xi) + fabs(s->shift)) + fmax(fabs(s->f_max * s->xi_max), fabs(s->elastic * s->xi)) + rounding / EXACT;
}

/* The motion on a line is the motion under its force: momentum and energy, integrated over it; and the next one begins
 * where it ends. */
static void check_line(const film_line *line, const film_line *next, double depth, double speed) {
    double tau = next->time - line->time, per_m = 1.0 / (1.0 + line->gamma * line->damping), values[5];
    double a = 0.5 * (line->kappa * line->gamma + line->damping) * per_m, swing = sqrt(fabs(line->kappa) * per_m) + 2.0 * fabs(a);
    double late = 1e-15 * next->time, impulse = 0.0, way = 0.0, pull = 0.0, fastest = 0.0;
    HOLD(tau >= 0.0);
    if (tau == 0.0 || !(swing * tau < STIFF)) return; /* at once: what rounding made of the speed is put right */
    int32_t parts = 2 + (int32_t)(4.0 * swing * tau);
    for (int32_t k = 0; k < parts; k++) {
        for (int i = 0; i < GAUSS; i++) {
            double h = tau / parts, w = GAUSS_WEIGHT[i] * h;
            film_evaluate(&curve, line, (k + GAUSS_AT[i]) * h, values);
            for (int j = 0; j < 5; j++) HOLD(isfinite(values[j]));
            double x = values[0] - line->xi, elastic = line->phi + line->kappa * x;
            double y = (values[3] - line->gamma * elastic) * per_m, force = line->branch == FILM_FREE ? 0.0 : elastic + line->damping * y;
            impulse += w * force;
            way += w * (values[3] - line->gamma * force);
            pull = fmax(pull, fabs(force));
            fastest = fmax(fastest, fabs(values[3]) + line->gamma * fabs(force));
        }
    }
    double way_on = fabs(next->xi - line->xi), rounded = 1e-15 * (fabs(line->xi) + fabs(next->xi)); /* x is a difference here, */
    double blurred = (fabs(line->kappa) + pull / fmax(way_on, rounded)) * rounded / LINES_MEET; /* so is the work, and gamma f turns it */
    if (line->branch >= 0) /* nor is the law's force where the line ends known better */
        blurred = fmax(blurred, fabs(force_at(line->branch, next->xi + rounded) - force_at(line->branch, next->xi - rounded)) / LINES_MEET);
    blurred += none / LINES_MEET;
    double size = depth + fastest * tau + late * fastest / LINES_MEET;
    NEAR(next->nu - line->nu, line->load * tau - impulse, speed + fastest + (pull + fabs(line->load)) * (tau + late / LINES_MEET) + blurred * (tau + line->gamma), LINES_MEET);
    NEAR(next->xi - line->xi, way, size + line->gamma * blurred * tau, LINES_MEET);
}

/* A contact, recorded: lines that follow each other. */
static void check_record(const film_state *begin, double limit) {
    film_state s = *begin;
    int32_t line_count, event_count;
    film_summary summary;
    int status = film_record(&curve, &mesh, &s, limit, lines, LINES, &line_count, events, EVENTS, &event_count, &summary);
    if (status == FILM_FULL) return; /* it bounces or swings for longer than there is room */
    documented(status);
    sane(&s, status);
    lines_seen += line_count;
    int kept = mesh.linearisation == FILM_WORK_PRESERVING; /* a chord's turn has the law's force, and not its own */
    double depth = 0.0, speed = 0.0;
    for (int32_t i = 0; i < line_count; i++) {
        depth = fmax(depth, fabs(lines[i].xi));
        speed = fmax(speed, fabs(lines[i].nu));
    }
    for (int32_t i = 0; kept && i + 1 < line_count; i++) check_line(&lines[i], &lines[i + 1], depth, speed);
    for (int32_t i = 0; i + 1 < event_count; i++) HOLD(events[i].time <= events[i + 1].time);
}

/* Somebody else's integrator of the true law: it may come from anywhere, and what is due is soon done. */
static void check_switches(film_state s) {
    double indicators[FILM_INDICATORS], speed = fabs(s.nu) + 1e-3;
    for (int32_t k = whole(0, 12); k > 0; k--) {
        film_contact at = film_force(&curve, &s, s.xi, s.nu);
        double force = at.force;
        HOLD(isfinite(force) && !isnan(at.by_xi) && !isnan(at.by_nu));
        double h = decades(1e-6, 1.0) * (fabs(s.xi) + 1e-3) / (fabs(s.nu) + s.gamma * fabs(force) + 1e-9);
        double xi = s.xi + h * (s.nu - s.gamma * force), nu = s.nu + h * (s.load - force);
        s.shift += h * s.gamma * force;
        s.time += h;
        s.xi = xi;
        s.nu = nu;
        if (!(fabs(xi) < 1e100 && fabs(nu) < 1e100)) return;
        film_indicators(&curve, &s, speed, indicators);
        int32_t n = 0;
        for (int i = 0; i < FILM_INDICATORS; i++) HOLD(!isnan(indicators[i]));
        for (int status = FILM_EVENT; status == FILM_EVENT; n++) {
            HOLD(n < 3 * FILM_MAX_STAGES);
            status = film_switch(&curve, &s);
            if (status == FILM_BAD_NUMBER && !isfinite(film_force(&curve, &s, s.xi, s.nu).force)) return; /* a leap too far for the law */
            documented(status);
            if (status < 0) return;
            s.xi = xi;
        }
    }
}

/* A number of some size, or one that coincides with something in the state. */
static double any_duration(const film_state *s, double scale) {
    switch (whole(0, 7)) {
    case 0: return 0.0;
    case 1: return s->has_line && s->tau_end < INFINITY ? fmax(beside((s->tau_end - s->tau) - s->tau_low), 0.0) : scale;
    case 2: return s->has_line && s->tau_end < INFINITY ? fmax(s->tau_end - s->tau, 0.0) * fraction() : scale * fraction();
    case 3: return decades(1e-18, 1.0) * scale;
    case 4: return decades(1.0, 1e12) * scale;
    case 5: return INFINITY;
    default: return scale * fraction();
    }
}

static double any_load(const film_state *s, double scale) {
    switch (whole(0, 7)) {
    case 0: return 0.0;
    case 1: return beside(s->force);
    case 2: return -s->force;
    case 3: return s->force * 2.0 * fraction();
    case 4: return scale * decades(1e-12, 1e3);
    case 5: return -scale * decades(1e-12, 1e3);
    default: return s->load;
    }
}

static double any_speed(double scale) {
    switch (whole(0, 7)) {
    case 0: return scale * decades(1e-9, 10.0);
    case 1: return -scale * decades(1e-9, 10.0);
    default: return 0.0;
    }
}

/* On by dt, through every event. */
static int march(film_state *s, double dt) {
    int status = FILM_EVENT;
    film_state node = *s;
    double end = s->time + dt;
    for (int n = 0; status == FILM_EVENT && n < EVENTS_A_CALL; n++) {
        int32_t drawn = s->lines;
        double from = s->time, target = fmax(end - s->time, 0.0);
        status = film_step(&curve, &mesh, s, dt == INFINITY ? INFINITY : target);
        calls++;
        documented(status);
        sane(s, status);
        if (status < 0) return status;
        bounded(s->lines - drawn);
        HOLD(s->time >= from);
        double digits = (1e-15 + 1e-16 * (s->lines - drawn)) * fabs(end); /* dt loses one with each line */
        HOLD(!(dt < INFINITY) || s->time <= end + digits + 1e-300);
        if (status == FILM_OK) HOLD(fabs(s->time - end) <= digits);
        if (status == FILM_EVENT) {
            events_seen++;
            HOLD(s->event > FILM_NO_EVENT && s->event <= FILM_RELOADING_BEGINS);
            if (mesh.linearisation == FILM_WORK_PRESERVING && !node.has_line) {
                double scale = 3.0 * (energy_scale(s) + energy_scale(&node)); /* a turn neglects a way of 1e-9 of the depth */
                /* gamma f turns it, and xi is rounded; the shift is what a load has done less what nu, rounded with each line, shows of it */
                double rounded = 1e-15 * (fabs(s->xi) + fabs(node.xi)), steep = 1e-15 * s->gamma * fabs(s->line.kappa * s->xi);
                if (s->branch >= 0)
                    steep = fmax(steep, s->gamma * fabs(force_at(s->branch, s->xi + rounded) - force_at(s->branch, s->xi - rounded)));
                double pull = s->gamma * fabs(s->load), fast = fmax(fabs(s->nu), fabs(node.nu));
                double blurred = steep * (4.0 * fast + pull) + 4e-15 * (s->lines - drawn) * pull * fast;
                NO_MORE(energy(s), energy(&node), scale + blurred / EXACT, EXACT);
                if (s->gamma == 0.0 && s->damper == 0.0) NEAR(energy(s), energy(&node), scale, EXACT);
            }
            node = *s;
        }
    }
    return status;
}

static void check_saved(const film_state *from, const film_state *to, double dt) {
    film_state again;
    memcpy(&again, from, sizeof again);
    march(&again, dt);
    HOLD(memcmp(&again, to, sizeof again) == 0);
}

static void check_batch(const film_start *first) {
    static film_start start[BATCH];
    static film_summary summary[BATCH], again[BATCH];
    static int32_t status[BATCH], status_again[BATCH];
    film_summary alone;
    int32_t count = first->damping > 0.0 ? BATCH / 8 : BATCH;
    for (int i = 0; i < count; i++) {
        start[i] = *first;
        if (i > 0) start[i].nu *= decades(0.1, 10.0);
        if (i % 3 == 1) start[i].gamma = 0.0;
        if (i % 3 == 2) start[i].gamma = decades(1e-4, 30.0);
        if (i % 20) start[i].load = start[i].stop_velocity = 0.0;
        if (start[i].load > 0.0) start[i].time_limit = fmin(100.0, 1000.0 * start[i].nu / start[i].load); /* it may swing for long */
        if (curve.pull > 0.0) start[i].time_limit = 30.0;
    }
    film_batch(film_instructions(), &curve, &mesh, count, start, summary, status);
    for (int instructions = FILM_PLAIN; instructions <= film_instructions(); instructions++) {
        film_batch(instructions, &curve, &mesh, count - 2, start, again, status_again);
        HOLD(memcmp(again, summary, (size_t)(count - 2) * sizeof *summary) == 0);
        HOLD(memcmp(status_again, status, (size_t)(count - 2) * sizeof *status) == 0);
    }
    for (int i = 0; i < count; i++) {
        if (film_impact(&curve, &mesh, &start[i], &alone) == FILM_EVENT && start[i].gamma > 0.0)
            HOLD(memcmp(&alone, &summary[i], sizeof alone) == 0);
        else if (start[i].gamma == 0.0 && status[i] == FILM_EVENT && start[i].damping == 0.0)
            HOLD(isfinite(alone.contact_duration) && isfinite(alone.final_velocity) && isfinite(alone.work));
        int one = film_marched(&curve, &mesh, &start[i], &alone);
        if (one != FILM_TOO_MANY || start[i].load <= 0.0) documented(one); /* a load alone swings without end */
        if (status[i] != FILM_TOO_MANY || start[i].load <= 0.0) documented(status[i]);
        if (status[i] < 0 || one < 0) continue;
        const film_summary *s = &summary[i];
        HOLD(isfinite(s->maximum_force) && s->maximum_force >= 0.0 && isfinite(s->maximum_indentation) && isfinite(s->shift) && isfinite(s->work));
        if (status[i] == FILM_EVENT) HOLD(isfinite(s->contact_duration) && isfinite(s->final_velocity) && isfinite(s->permanent_indentation));
        if (one == FILM_EVENT) HOLD(isfinite(alone.contact_duration) && isfinite(alone.final_velocity) && isfinite(alone.permanent_indentation));
        if (one == FILM_EVENT) HOLD(alone.time_of_maximum_indentation <= alone.contact_duration);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t count) {
    data = bytes;
    left_over = count;
    where[0] = 0;
    any_curve();
    if (!usable()) return 0;
    runs++;
    int32_t loading = whole(1, whole(0, 3) ? 8 : SEGMENTS_MOST), unloading = whole(1, whole(0, 3) ? 8 : SEGMENTS_MOST);
    HOLD(film_mesh_init(&mesh, whole(0, 3) ? FILM_WORK_PRESERVING : FILM_CHORD, loading, unloading, memory) == FILM_OK);
    film_start start = {decades(1e-3, 1e3), whole(0, 1) ? 0.0 : decades(1e-6, 30.0), 0.0, 0.0, INFINITY, 0.0};
    if (whole(0, 7) == 0) start.nu = 0.0;
    if (whole(0, 3) == 0) { /* fixed, it turns where a stage ends */
        double energy_there = 0.0;
        int32_t stages = whole(1, curve.stages);
        for (int32_t k = 0; k < stages; k++) {
            double force, work;
            film_law(&curve, k, curve.stage[k].end, &force, &work);
            energy_there += work;
        }
        if (energy_there > 0.0 && energy_there < 1e8) start.nu = beside(sqrt(2.0 * energy_there));
    }
    double unit_force = isfinite(curve.stage[0].end) ? force_at(0, curve.stage[0].end) : force_at(0, 1.0);
    unit_force = fmax(unit_force, 1e-3);
    if (curve.stage[0].damped) start.damping = whole(0, 3) ? decades(1e-3, 30.0) : 0.0;
    if (whole(0, 3) == 0) start.load = (whole(0, 1) ? 1.0 : -1.0) * unit_force * decades(1e-9, 10.0);
    start.stop_velocity = any_speed(start.nu);
    double gap = whole(0, 3) ? 0.0 : decades(1e-12, 10.0), scale = 3.0 * decades(0.1, 10.0);
    snprintf(where, sizeof where, "%d stages, nu %.17g, gamma %.17g, load %.17g, stop %.17g, damping %.17g, gap %.17g, mesh %d %d %d", (int)curve.stages,
             start.nu, start.gamma, start.load, start.stop_velocity, start.damping, gap, (int)mesh.linearisation, (int)loading, (int)unloading);

    film_state s, saved;
    HOLD(film_init(&curve, &s, -gap, start.nu, start.gamma, start.load, start.stop_velocity) == FILM_OK);
    HOLD(film_damp(&s, start.damping) == FILM_OK);
    if (start.nu > 0.0) check_record(&s, start.load > 0.0 || curve.pull > 0.0 ? 30.0 * scale : INFINITY); /* it may swing for ever */
    if (start.nu > 0.0) check_batch(&start);
    for (int k = 0, status = FILM_OK; k < CALLS && left_over > 0 && status >= 0; k++) {
        if (whole(0, 1)) HOLD(film_input(&s, any_load(&s, unit_force), any_speed(start.nu), whole(0, 7) ? s.stop_velocity : any_speed(start.nu)) == FILM_OK);
        if (!(fabs(s.nu) < 1e12 && fabs(s.xi) < 1e12)) break;
        memcpy(&saved, &s, sizeof saved);
        double dt = any_duration(&s, scale);
        status = march(&s, dt);
        if (whole(0, 3) == 0) check_saved(&saved, &s, dt);
        if (status >= 0 && whole(0, 3) == 0) check_switches(s);
        if (status == FILM_ENDLESS && whole(0, 1)) break;
    }
    return 0;
}

#ifndef GUIDED

static uint64_t seed = 20170417;

static uint32_t chance(void) { /* splitmix64 */
    seed += 0x9e3779b97f4a7c15u;
    uint64_t z = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return (uint32_t)((z ^ (z >> 31)) >> 32);
}

static int again(const char *path) {
    static uint8_t input[4096];
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        printf("%s: cannot be read\n", path);
        return 2;
    }
    size_t count = fread(input, 1, sizeof input, file);
    fclose(file);
    LLVMFuzzerTestOneInput(input, count);
    return 0;
}

int main(int count, char **argument) {
    char *rest = NULL;
    long inputs = count == 2 ? strtol(argument[1], &rest, 10) : 0;
    if (inputs <= 0 || *rest) {
        for (int k = 1; k < count; k++)
            if (again(argument[k])) return 2;
    } else {
        for (long k = 0; k < inputs; k++) {
            uint8_t input[300];
            size_t length = 60 + chance() % 240;
            for (size_t i = 0; i < length; i++) input[i] = (uint8_t)chance();
            const uint64_t from = seed;
            LLVMFuzzerTestOneInput(input, length);
            seed = from;
        }
    }
    printf("core_fuzz: %ld curves, %ld calls, %ld events, %ld lines; beyond the law %ld, no unloading %ld, too stiff %ld\n", runs, calls, events_seen,
           lines_seen, refused[-FILM_BEYOND_LAW], refused[-FILM_BAD_UNLOADING], refused[-FILM_TOO_STIFF]);
    return 0;
}

#endif
