/* Springs that slip, as film_springs.h says. docs/method.md, section 15. */
#include "oblique/film_springs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    FEWEST = 4,  /* springs that share the force within 2 % of what they stand for: a contact that grows has a phase with them */
    MET = 2,     /* most springs that a slip which spreads slowly meets in a step */
    PERSISTS = 5 /* steps in which not all slip, before that is a phase: where sliding ends, all stop within less */
};

/* Of a width, beyond the last spring but half a width: sums over springs are as integrals up to an edge there, where forces fall to 0 in
 * proportion to the distance, as B2(1/2 + 1/sqrt(12)) = 0; so where the contact is largest. */
static const double EDGE = 0.28867513459481287;
static const double SPHERE = 2.0;  /* power of a sphere */
static const double BEFORE = 0.0625; /* part of the difference before the last in the error of the finest run: the last may be small by chance */
/* Share of the impulse of friction that may lack to its limit in a contact that slides throughout: what 32 springs in 128 steps resolve
 * (test_regimes_of_batches_are_those_of_single_impacts). */
static const double SLIDES = 3e-4;

static int positive(double x) { return isfinite(x) && x > 0.0; }

double film_springs_reached(double power, double widths) {
    if (power == 2.0) return widths * widths; /* a sphere, most often */
    return power == 0.0 ? (widths > 0.0 ? 1.0 : 0.0) : pow(widths, power);
}

static double reached(const film_springs *state, double radius) { return film_springs_reached(state->power, radius / state->width); }

double film_springs_power(const film_curve *curve) {
    const film_function *force = &curve->piece[0].force;
    int alone = curve->stages == 1 && curve->pieces == 1 && curve->stage[0].unloading == FILM_RETRACE && force->form == FILM_POWER;
    if (!alone || force->constant != 0.0 || force->origin != 0.0) return SPHERE;
    if (force->square == 0.0 && (force->coefficient == 0.0 || force->exponent == 1.0)) return 0.0;
    return force->slope != 0.0 || force->square != 0.0 || force->exponent < 1.0 ? SPHERE : fmin(1.0 / (force->exponent - 1.0), FILM_MOST_POWER);
}

/* The numbers of springs, and what they reach unless it is known. */
static int prepare(film_springs *state, int32_t count, double modulus, double largest, double power, double friction, double mass,
                   double velocity) {
    int known = state->count == count && state->power == power;
    if (count < 1 || count > FILM_MOST_SPRINGS || !(power >= 0.0 && power <= FILM_MOST_POWER)) return FILM_BAD_NUMBER;
    if (!positive(modulus) || !positive(largest) || !positive(mass)) return FILM_BAD_NUMBER;
    if (!(isfinite(friction) && friction >= 0.0 && isfinite(velocity))) return FILM_BAD_NUMBER;
    state->count = count;
    state->width = largest / count;
    state->stiffness = 8.0 * modulus * state->width;
    state->power = power, state->friction = friction, state->mass = mass, state->v = velocity;
    for (int32_t j = 0; !known && j < count; j++) {
        state->reach[j] = power > 0.0 ? film_springs_reached(power, j + 0.5) : 0.0;
        state->sums[j + 1] = state->sums[j] + state->reach[j];
    }
    return FILM_OK;
}

int film_springs_init(film_springs *state, int32_t count, double modulus, double largest, double power, double friction, double mass,
                      double velocity) {
    memset(state, 0, sizeof *state);
    return prepare(state, count, modulus, largest, power, friction, mass, velocity);
}

/* Springs of twice the distance, until none beyond the last is reached at a radius: half as many for what there is, and new ones beyond. */
static void widen(film_springs *state, double radius) {
    for (int twice = 0; state->width * (state->count + 0.5) < radius && twice < 1100; twice++) {
        int32_t half = state->count / 2;
        for (int32_t j = 0; j < half; j++) state->u[j] = 0.5 * (state->u[2 * j] + state->u[2 * j + 1]);
        for (int32_t j = half; j < state->count; j++) state->u[j] = 0.0;
        state->width *= 2.0;
        state->stiffness *= 2.0;
    }
}

/* How many springs touch: those with (j + 1/2) width < radius. */
static int32_t touching(const film_springs *state, double radius) {
    double springs = ceil(radius / state->width - 0.5);
    return springs <= 0.0 ? 0 : (int32_t)fmin(springs, state->count);
}

/* Sum of the first values; four sums, which do not wait for each other. */
static double sum_of(const double *values, int32_t count) {
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int32_t j = 0;
    for (; j + 4 <= count; j += 4) {
        for (int k = 0; k < 4; k++) sum[k] += values[j + k];
    }
    for (; j < count; j++) sum[0] += values[j];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

void film_springs_move(film_springs *state, double moved, double force, double radius) {
    widen(state, radius);
    int32_t touch = touching(state, radius), met = touching(state, state->radius);
    double top = reached(state, radius), all = touch * top - state->sums[touch];
    double per_share = all > 0.0 ? state->friction * force / (state->stiffness * all) : 0.0;
    /* a spring that the contact has just reached moves with it for its part of the step, in which the depth grows evenly */
    double grown = fmax(top - reached(state, state->radius), 0.0);
    for (int32_t j = met; j < touch; j++) state->u[j] -= moved * fmax(1.0 - (top - state->reach[j]) / grown, 0.0);
    state->cut = 0, state->stuck = touch;
    for (int32_t j = touch - 1; j >= 0; j--) {
        double most = (top - state->reach[j]) * per_share, u = state->u[j] + moved;
        int side = (u > most) - (u < -most);
        state->cut += side;
        if (side != 0) state->stuck = j;
    }
    for (int32_t j = 0; j < touch; j++) { /* comparisons that compilers turn into vectors */
        double most = (top - state->reach[j]) * per_share, u = state->u[j] + moved;
        u = u < -most ? -most : u;
        state->u[j] = u > most ? most : u;
    }
    for (int32_t j = touch; j < met; j++) state->u[j] = 0.0;
    state->q = state->stiffness * sum_of(state->u, touch);
    state->radius = radius;
}

void film_springs_step(film_springs *state, double time, double force, double radius) {
    double before = state->q, rise = state->rise * time, a_time = time / state->mass;
    film_springs_move(state, (state->v + 0.5 * time * state->push - a_time * (0.5 * before + rise / 6.0)) * time, force, radius);
    double change = state->q - before;
    state->v += time * state->push - a_time * (0.5 * (before + state->q) - (state->even ? (change - rise) / 12.0 : 0.0));
    state->rise = state->even && time > 0.0 ? change / time : 0.0;
}

int32_t film_springs_touching(const film_springs *state) { return touching(state, state->radius); }

static void begin_phase(film_watch *watch, int phase, double ago) {
    if (phase == watch->phase && phase != FILM_REVERSES) return;
    watch->phase = phase == FILM_REVERSES ? FILM_SLIPS : phase;
    if (phase < 0 || watch->events == FILM_MOST_PHASES) return;
    watch->begins[watch->events] = fmax(watch->passed - ago, 0.0);
    watch->kinds[watch->events++] = phase;
}

/* No spring slips: all stick, unless the contact shrinks, in which slip only changes its sign; a slip that spreads slowly has steps in
 * which no spring is met. The first phase of a contact begins with it, a later one in the middle of a step. */
void film_springs_watch(film_watch *watch, int32_t slipped, int32_t touch, double before, double radius, double h) {
    int cut = abs(slipped), sign = slipped > 0 ? 1 : -1, last = watch->cut;
    watch->passed += h;
    watch->cut = cut;
    watch->waited = watch->phase < 0 && radius > 0.0 ? watch->waited + h : 0.0;
    double ago = fmax(watch->waited, 0.5 * h);
    if (touch == 0) {
        begin_phase(watch, -1, 0.0);
    } else if (watch->phase < 0 && touch < FEWEST && radius > before) {
        return;
    } else if (cut == 0) {
        if (radius >= before) begin_phase(watch, FILM_STICKS, ago);
        else if (last > MET) watch->sign = -watch->sign, begin_phase(watch, FILM_REVERSES, ago);
    } else {
        int whole = cut >= touch, turns = sign != watch->sign && watch->phase >= FILM_SLIPS;
        int partly = watch->phase == FILM_SLIDES && !whole && !turns;
        watch->partly = partly ? watch->partly + 1 : 0;
        watch->sign = sign;
        if (partly && watch->partly < PERSISTS) return;
        begin_phase(watch, whole ? FILM_SLIDES : turns ? FILM_REVERSES : FILM_SLIPS, ago + fmax(watch->partly - 1.0, 0.0) * h);
    }
}

double film_springs_energy(const film_springs *state) {
    double sum = 0.0;
    for (int32_t j = 0; j < state->count; j++) sum += state->u[j] * state->u[j];
    return 0.5 * state->stiffness * sum;
}

double film_friction_at(const double *table, int32_t rows, double speed) {
    int32_t k = 0;
    while (k < rows && table[2 * k] <= speed) k++;
    if (k == 0) return table[1];
    const double *low = table + 2 * (k - 1);
    return k == rows ? low[1] : low[1] + (low[3] - low[1]) * ((speed - low[0]) / (low[2] - low[0]));
}

double film_friction_slid(const double *table, int32_t rows, double velocity, double impulse) {
    double v = fabs(velocity), now;
    while (impulse > 0.0 && (now = film_friction_at(table, rows, fabs(v))) > 0.0) {
        double low = -INFINITY, high = INFINITY, slope = 0.0; /* the rows of either sign around v, and the slope between */
        for (int32_t k = 0; k < 2 * rows; k++) {
            double row = k < rows ? table[2 * k] : -table[2 * (k - rows)];
            if (row < v) low = fmax(low, row);
            else high = fmin(high, row);
        }
        if (isfinite(low) && isfinite(high))
            slope = (film_friction_at(table, rows, fabs(high)) - film_friction_at(table, rows, fabs(low))) / (high - low);
        double end = now + slope * (low - v), whole = slope == 0.0 ? (v - low) / now : end > 0.0 ? log(now / end) / slope : INFINITY;
        double part = fmin(whole, impulse);
        v = whole < impulse ? low : v - (slope == 0.0 ? now * part : -now * expm1(-slope * part) / slope);
        impulse -= part;
    }
    return copysign(1.0, velocity) * v;
}

void film_springs_take(film_springs *state, double time, const double *table, int32_t rows) {
    if (rows > 0) state->friction = film_friction_at(table, rows, fabs(state->v + time * (state->push - state->q / state->mass)));
}

/* The regime, by which a contact that slides throughout has no other phase. */
static void judge(film_springs_impact_result *result) {
    film_watch *watch = &result->watch;
    int32_t kept = 0;
    result->regime = watch->kinds[0] == FILM_SLIDES ? FILM_SLIDES_FIRST : FILM_STICKS_FIRST;
    if (result->slack > SLIDES) return;
    result->regime = FILM_SLIDES_THROUGHOUT;
    for (int32_t k = 0; k < watch->events; k++)
        if (watch->kinds[k] == FILM_SLIDES) watch->begins[kept] = watch->begins[k], watch->kinds[kept++] = FILM_SLIDES;
    if (kept == 0) watch->begins[kept] = 0.0, watch->kinds[kept++] = FILM_SLIDES;
    watch->events = kept;
}

int film_springs_begin(film_springs *runs, int32_t all, int32_t count, double modulus, double power, double mass, double velocity, double friction,
                       int64_t steps, const double *radius) {
    double largest = 0.0;
    int status = FILM_OK;
    if (power == 0.0) count = 4; /* all springs are alike */
    for (int64_t i = 0; i <= steps; i++) largest = radius[i] > largest ? radius[i] : largest;
    for (int32_t k = 0; k < all && status == FILM_OK; k++, count /= 2) {
        double to = power > 0.0 ? largest * (count / (count + EDGE)) : largest;
        status = prepare(&runs[k], count, modulus, to, power, friction, mass, velocity);
        runs[k].even = 1;
    }
    return status;
}

int film_springs_end(film_springs_impact_result *result, double last, double before, double limits, double used) {
    result->error += last + BEFORE * before;
    result->slack = limits > 0.0 ? 1.0 - used / limits : 0.0;
    judge(result);
    return isfinite(result->velocity + result->error) ? FILM_OK : FILM_BAD_NUMBER;
}

int film_springs_impact(int32_t count, double modulus, double power, double mass, double velocity, const double *friction, int32_t rows,
                        int64_t contacts, const double *begins, const double *time, int64_t steps, const double *force,
                        const double *radius, film_springs_impact_result *result, double *motion) {
    film_springs runs[FILM_SPRINGS_RUNS], *fine = &runs[0];
    film_watch *watch = &result->watch;
    double limits = 0.0, used = 0.0;
    int status = FILM_OK;
    *result = (film_springs_impact_result){.velocity = velocity};
    for (int64_t contact = 0; contact < contacts && status == FILM_OK; contact++) {
        double apart[FILM_SPRINGS_RUNS] = {0.0}, h = time[contact];
        int64_t first = contact * (steps + 1);
        const double *forces = force + first, *radii = radius + first;
        double *row = motion + 3 * first;
        watch->phase = -1, watch->passed = begins[contact], watch->waited = 0.0;
        watch->sign = watch->cut = watch->partly = 0;
        memset(runs, 0, sizeof runs);
        status = film_springs_begin(runs, FILM_SPRINGS_RUNS, count, modulus, power, mass, result->velocity, friction[1], steps, radii);
        if (status != FILM_OK) return status;
        row[0] = result->velocity, row[1] = row[2] = 0.0;
        for (int64_t i = 1; i <= steps; i++) {
            for (int k = 0; k < FILM_SPRINGS_RUNS && i % (1 << k) == 0; k++) {
                film_springs_take(&runs[k], (1 << k) * h, friction, rows);
                film_springs_step(&runs[k], (1 << k) * h, forces[i], radii[i]);
                if (k > 0) apart[k] = fmax(apart[k], fabs(runs[k - 1].v - runs[k].v));
            }
            film_springs_watch(watch, fine->cut, film_springs_touching(fine), radii[i - 1], radii[i], h);
            if (fabs(fine->q) > result->force) result->force = fabs(fine->q), result->step = first + i;
            limits += fine->friction * forces[i] * h, used += fabs(fine->q) * h;
            row[3 * i] = fine->v, row[3 * i + 1] = fine->q, row[3 * i + 2] = fmin(fine->stuck * fine->width, fine->radius);
        }
        result->velocity = fine->v;
        status = film_springs_end(result, apart[1], apart[2], limits, used);
    }
    return status;
}

void film_springs_sizes(int64_t sizes[2]) {
    sizes[0] = (int64_t)sizeof(film_springs);
    sizes[1] = (int64_t)sizeof(film_springs_brief);
}
