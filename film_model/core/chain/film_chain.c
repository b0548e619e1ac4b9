/* A chain of bodies: where its contacts begin, turn and end, and the steps between. */
#include "chain/film_chain.h"

#include "chain/film_dop853.h"
#include "curve/film_law.h"

#include <math.h>
#include <string.h>

enum { D, V, W, PARTS };               /* indentations, velocities, works */
enum { TURN, FAR, NEAR, PEAK, SIGNS }; /* what may happen at a contact: film_indicators, and the peak of a damped force */
enum { MOST_SWITCHES = 8, ROOT_STEPS = 60 };

/* How late an event is seen: indentation over its depth, or rate over the unit of velocity. The impulse that this leaves out
 * is below rounding but for a force that jumps, of which it is this part. */
static const double LATE = 1e-13;
static const double AIM = -1e-13, LATEST = -4e-13; /* sign that a step to an event aims at, and the least that is accepted */
static const double STILL = 1e-2;   /* part of the tolerance: a rate inwards of a contact that is let go */
static const double BEGIN = 0.3;    /* first step of a contact over (tolerance/rate^1.5)^(2/5): Hertz's force is (rate t)^1.5 */
static const double COUNTED = 10.0; /* rate over the tolerance from which a contact that begins again is counted */
static const double MARGIN = 0.9, SHRINK = 0.1, GROW = 6.0; /* of the next step: as in dop853.f but for the cut */

typedef struct {
    const film_chain *of;
    int32_t n, first, last; /* bodies; contacts that are integrated, with the bodies beside them */
    int known;              /* 1: `sign` and `force` are those of y and of first .. last */
    double *y, *trial, *slope, *force, *sign, *sign_now, *watch, time;
    film_state *state;
    film_chain_summary *result;
} chain;

size_t film_chain_size(int32_t bodies) {
    size_t n = (size_t)bodies;
    return n * ((2 * PARTS + PARTS * STAGES + 1 + 3 * SIGNS) * sizeof(double) + sizeof(film_state));
}

/* fmax and fmin of numbers, which compilers inline. */
static double greater(double a, double b) { return a > b ? a : b; }
static double lesser(double a, double b) { return a < b ? a : b; }

static double rate(const chain *c, const double *y, int32_t k) {
    const double *v = y + V * c->n;
    return k + 1 < c->n ? v[k] - v[k + 1] : v[k];
}

static int touching(const chain *c, int32_t k) { return c->state[k].branch != FILM_FREE; }

/* The force of contact k; 0 where bodies do not touch. */
static double force_at(const chain *c, const double *y, int32_t k) {
    if (k >= c->of->contacts || !touching(c, k)) return 0.0;
    const film_chain_contact *at = &c->of->contact[k];
    const film_line *line = &c->state[k].line;
    double xi = y[D * c->n + k] / at->length, f, work;
    law_at(at->curve, line, xi, &f, &work);
    return at->force * total_force(line, damping_at(at->curve, line, xi), f, rate(c, y, k));
}

static double force_before(const chain *c, int32_t k) { return k > c->first ? c->force[k - 1] : 0.0; }
static int32_t last_body(const chain *c) { return c->last + 1 < c->n ? c->last + 1 : c->n - 1; }
/* y' of the contacts first .. last and the bodies beside them. */
static void slopes(const chain *c, const double *y, double *to) {
    for (int32_t k = c->first; k <= last_body(c); k++) { /* the contact behind the last body is open */
        c->force[k] = force_at(c, y, k);
        to[D * c->n + k] = rate(c, y, k);
        to[V * c->n + k] = c->of->gravity + (force_before(c, k) - c->force[k]) / c->of->mass[k];
        to[W * c->n + k] = c->force[k] * to[D * c->n + k];
    }
}

/* to = y + h (weights of a row) times the slopes. */
static void combine(const chain *c, const film_rk_row *row, double h, double *to) {
    for (int part = 0; part < PARTS; part++) {
        int32_t first = part * c->n + c->first, size = (part == V ? last_body(c) : c->last) - c->first + 1;
        const double *y = c->y + first;
        double *out = to + first;
        for (int32_t k = 0; k < size; k++) out[k] = y[k];
        for (int j = 0; j < row->count; j++) {
            const double *slope = c->slope + row->from[j] * PARTS * c->n + first;
            double weight = h * row->weight[j];
            for (int32_t k = 0; k < size; k++) out[k] += weight * slope[k];
        }
    }
}

/* trial: y after h. The first stage is there; forces are those at the end. */
static void step(const chain *c, double h) {
    const double *v = c->y + V * c->n, g = c->of->gravity;
    for (int32_t k = 0; k < c->n; k++) { /* free motion */
        double falls = k + 1 < c->n ? 0.0 : 0.5 * g * h * h;
        c->trial[D * c->n + k] = c->y[D * c->n + k] + h * rate(c, c->y, k) + falls;
        c->trial[V * c->n + k] = v[k] + g * h;
        c->trial[W * c->n + k] = c->y[W * c->n + k];
    }
    if (c->last < c->first) return;
    for (int s = 1; s <= STAGES; s++) {
        combine(c, &DOP853[s], h, c->trial);
        if (s < STAGES) slopes(c, c->trial, c->slope + s * PARTS * c->n);
    }
}

/* Estimated error of the step over the tolerance, as dop853.f combines both estimates, of the largest. INFINITY: the step
 * leaves the range of a law. */
static double error_of(const chain *c, double h) {
    double fifth = 0.0, third = 0.0, sum = 0.0;
    if (c->last < c->first) return 0.0;
    for (int part = D; part <= V; part++)
        for (int32_t k = c->first; k <= (part == D ? c->last : last_body(c)); k++) {
            if (part == D && k >= c->of->contacts) continue;
            double five = 0.0, three = 0.0, unit = part == D ? c->of->contact[k].length * c->of->contact[k].depth : 1.0;
            for (int s = 0; s < STAGES; s++) {
                double slope = c->slope[(s * PARTS + part) * c->n + k];
                five += FIFTH[s] * slope;
                three += THIRD[s] * slope;
            }
            sum += five + three;
            fifth = greater(fifth, fabs(five / unit));
            third = greater(third, fabs(three / unit));
        }
    if (!isfinite(sum)) return INFINITY;
    return fifth == 0.0 ? 0.0 : fabs(h) * fifth * fifth / sqrt(fifth * fifth + 0.01 * third * third) / c->of->tolerance;
}

/* ---------------------------------------------------------------- events */

/* Signs of contact k in `y`: what happens where one falls below 0. */
static void signs_of(const chain *c, const double *y, int32_t k, double *sign) {
    const film_chain_contact *at = &c->of->contact[k];
    film_state *s = &c->state[k];
    double indicators[FILM_INDICATORS];
    for (int j = 0; j < SIGNS; j++) sign[j] = 1.0;
    s->xi = y[D * c->n + k] / at->length;
    s->nu = rate(c, y, k);
    film_indicators(at->curve, s, 1e-3 * at->depth, indicators); /* late by 1e-3 of its 1e-10: LATE */
    for (int j = TURN; j <= NEAR; j++) sign[j] = greater(lesser(indicators[j] / at->depth, 1.0), -1.0);
    if (s->damper == 0.0 || !touching(c, k)) return;
    const double *mass = c->of->mass;
    double own = (force_before(c, k) - c->force[k]) / mass[k], next = 0.0;
    if (k + 1 < c->n) next = (c->force[k] - (k < c->last ? c->force[k + 1] : 0.0)) / mass[k + 1];
    else own += c->of->gravity;
    film_contact now = film_force(at->curve, s, s->xi, s->nu);
    sign[PEAK] = now.by_xi * s->nu / at->length + now.by_nu * (own - next);
}

/* The forces in `y`, and the signs of contacts in it that are integrated. */
static void signs_in(const chain *c, const double *y, double *signs) {
    if (c->last < c->first) return;
    for (int32_t k = c->first; k <= c->last && k < c->of->contacts; k++)
        c->force[k] = force_at(c, y, k);
    for (int32_t k = c->first; k <= c->last && k < c->of->contacts; k++) signs_of(c, y, k, signs + SIGNS * k);
}

/* The least of the signs that are watched: those that were above 0 at the beginning of the step and have been seen below. */
static double watched(const chain *c) {
    double least = 1.0;
    for (int32_t i = SIGNS * c->first; i < SIGNS * (c->last + 1) && i < SIGNS * c->of->contacts; i++) {
        if (c->sign[i] > 0.0 && c->sign_now[i] < 0.0) c->watch[i] = 1.0;
        if (c->watch[i] != 0.0) least = lesser(least, c->sign_now[i]);
    }
    return least;
}

/* Shortens a step to the first event in it, by the Illinois method. */
static double to_event(const chain *c, double h) {
    if (c->last < c->first) return h;
    double low = 0.0, high = h, at_low = 1.0;
    int side = 0;
    memset(c->watch, 0, (size_t)(SIGNS * c->n) * sizeof(double));
    signs_in(c, c->trial, c->sign_now);
    double at_high = watched(c);
    if (at_high >= LATEST) return h;
    for (int32_t i = 0; i < SIGNS * c->n; i++)
        if (c->watch[i] != 0.0) at_low = fmin(at_low, c->sign[i]);
    for (int count = 0; count < ROOT_STEPS && high - low > 1e-16 * h; count++) {
        h = low + (high - low) * fmin(fmax((at_low - AIM) / (at_low - at_high), 0.01), 0.99);
        step(c, h);
        signs_in(c, c->trial, c->sign_now);
        double at = watched(c);
        if (at < 0.0 && at >= LATEST) break;
        if (at < 0.0) {
            if (side < 0) at_low *= 0.5;
            high = h, at_high = at, side = -1;
        } else {
            if (side > 0) at_high *= 0.5;
            low = h, at_low = at, side = 1;
        }
    }
    return h;
}

/* The state goes on from an event at contact k: 0 or above, or what its law refuses. */
static int switch_contact(chain *c, int32_t k) {
    const film_chain_contact *at = &c->of->contact[k];
    film_chain_summary *result = &c->result[k];
    film_state *s = &c->state[k];
    int status = FILM_EVENT;
    for (int count = 0; count < MOST_SWITCHES && status == FILM_EVENT; count++) {
        s->xi = c->y[D * c->n + k] / at->length;
        s->nu = rate(c, c->y, k);
        status = film_switch(at->curve, s);
        if (status != FILM_EVENT) break;
        if (s->event == FILM_CONTACT_BEGINS) {
            if (result->count == 0 || s->nu > COUNTED * c->of->tolerance) result->count++;
            if (isnan(result->begins)) result->begins = c->time;
        } else if (s->event == FILM_CONTACT_ENDS) {
            result->ends = c->time;
        }
    }
    return status;
}

/* A contact at rest that can no longer change a velocity by more than a step may: it ends where its force is 0. Without it the
 * row behind a wave creeps apart for 1e5 contacts. */
static void let_go(chain *c, int32_t k) {
    film_state *s = &c->state[k];
    const film_chain_contact *at = &c->of->contact[k];
    double *d = &c->y[D * c->n + k], left = *d / at->length - s->xi_free, f, work;
    if (at->curve->pull > 0.0 || !(left > 0.0 && fabs(s->nu) < c->of->tolerance * (s->direction < 0 ? 1.0 : STILL))) return;
    law_at(at->curve, &s->line, *d / at->length, &f, &work);
    if (f * at->force * left * at->length > c->of->tolerance * c->of->tolerance * c->of->mass[k]) return;
    *d = s->xi_free * at->length;
    s->branch = FILM_FREE;
    s->phase = FILM_SEPARATED;
    c->known = 0;
    c->result[k].ends = c->time;
}

/* Keeps the largest values of contacts that are integrated. */
static void watch_largest(chain *c) {
    for (int32_t k = c->first; k <= c->last && k < c->of->contacts; k++) {
        film_chain_summary *result = &c->result[k];
        if (touching(c, k)) result->largest_indentation = fmax(result->largest_indentation, c->y[D * c->n + k]);
        if (c->force[k] <= result->largest_force) continue;
        result->largest_force = c->force[k];
        result->time_of_largest_force = c->time;
    }
}

/* When free contact k touches if nothing pushes its bodies; INFINITY: they do not approach. A damped contact may have let go
 * inside its dent, and then has to leave it first. */
static double touch_time(const chain *c, int32_t k) {
    double v = rate(c, c->y, k), g = k + 1 < c->n ? 0.0 : c->of->gravity;
    double gap = (c->state[k].xi_free + 2.0 * LATE * c->of->contact[k].depth) * c->of->contact[k].length - c->y[D * c->n + k];
    if (g == 0.0) return v > c->of->tolerance ? greater(gap, 0.0) / v : INFINITY;
    double square = v * v + 2.0 * g * gap;
    if (v < 0.0) return square > 0.0 ? (sqrt(square) - v) / g : -v / g;
    return gap > 0.0 ? 2.0 * gap / (v + sqrt(square)) : 0.0;
}

/* The contacts that are integrated: from the one before the first that touches to the one after the last; and the longest
 * free motion of the others. */
static double choose_window(chain *c) {
    double free_time = INFINITY;
    int32_t first = c->first, last = c->last;
    c->first = c->n, c->last = -1;
    for (int32_t k = 0; k < c->of->contacts; k++) {
        if (!touching(c, k)) continue;
        if (c->first == c->n) c->first = k > 0 ? k - 1 : 0;
        c->last = k + 1 < c->n ? k + 1 : k;
    }
    c->known &= first == c->first && last == c->last;
    for (int32_t k = 0; k < c->of->contacts; k++)
        if (k < c->first || k > c->last) free_time = lesser(free_time, touch_time(c, k));
    return free_time;
}

/* Whether there has been contact, there is none now, and neighbours do not approach but for gravity. */
static int is_over(const chain *c) {
    int32_t count = 0;
    for (int32_t k = 0; k < c->of->contacts; k++) {
        if (touching(c, k) || rate(c, c->y, k) > c->of->tolerance) return 0;
        count += c->result[k].count;
    }
    return count > 0;
}

/* ---------------------------------------------------------------- the run */

static void write_sample(const chain *c, double *row) {
    memcpy(row, c->trial, 2 * (size_t)c->n * sizeof(double));
    for (int32_t k = 0; k < c->n; k++)
        row[2 * c->n + k] = force_at(c, c->trial, k);
}

/* Samples up to h from now, each at the end of a step of its own; returns how many are done. */
static int64_t sample(const chain *c, double h, int64_t done, int64_t count, const double *times, double *samples) {
    for (; done < count && times[done] <= c->time + h; done++) {
        step(c, times[done] - c->time);
        write_sample(c, samples + FILM_CHAIN_COLUMNS * c->n * done);
    }
    return done;
}

/* Events that are due now, at contacts that are integrated or that free motion has closed. h: of the next step. */
static int switch_contacts(chain *c, int32_t *failed, double *h) {
    for (int32_t k = 0; k < c->of->contacts; k++) {
        double *sign = c->sign + SIGNS * k;
        if (k < c->first || k > c->last) {
            if (c->y[D * c->n + k] < c->state[k].xi_free * c->of->contact[k].length) continue;
            signs_of(c, c->y, k, sign);
        }
        if (sign[TURN] > 0.0 && sign[FAR] > 0.0 && sign[NEAR] > 0.0) {
            if (touching(c, k)) let_go(c, k);
            continue;
        }
        c->known = 0;
        int free = !touching(c, k), status = switch_contact(c, k);
        if (free && touching(c, k)) *h = fmin(*h, BEGIN * pow(c->of->tolerance, 0.4) * pow(fabs(rate(c, c->y, k)), -0.6));
        *failed = k;
        if (status < 0) return status;
    }
    return FILM_OK;
}

/* One step, at most to the limit, and the events at its end. h: that of the step control, and of the next step. */
static int advance(chain *c, double *h, double free_time, int64_t *done, int64_t count, const double *times, double *samples,
                   int32_t *failed) {
    double left = c->of->limit - c->time, length = fmin(fmin(c->last < c->first ? INFINITY : *h, free_time), left), error;
    if (c->last >= c->first) slopes(c, c->y, c->slope);
    if (!c->known) signs_in(c, c->y, c->sign);
    for (;;) {
        step(c, length);
        error = error_of(c, length);
        double factor = fmin(fmax(MARGIN * pow(error, -0.125), SHRINK), GROW);
        if (error <= 1.0) {
            *h = length == *h || factor < 1.0 ? factor * length : fmax(*h, factor * length);
            break;
        }
        if (!(factor < 1.0)) return FILM_BAD_NUMBER;
        *h = length = factor * length;
        if (c->time + length == c->time) return FILM_TOO_MANY;
    }
    length = to_event(c, length);
    int64_t before = *done;
    *done = sample(c, length, *done, count, times, samples);
    if (*done > before) step(c, length);
    memcpy(c->y, c->trial, PARTS * (size_t)c->n * sizeof(double));
    c->time = length == left ? c->of->limit : c->time + length;
    if (*done > before) signs_in(c, c->y, c->sign_now); /* those of the step to the event otherwise */
    memcpy(c->sign, c->sign_now, (size_t)(SIGNS * c->n) * sizeof(double));
    c->known = 1;
    watch_largest(c);
    return switch_contacts(c, failed, h);
}

static int begin(chain *c, void *memory, film_chain_summary *result) {
    const film_chain *of = c->of;
    int32_t n = c->n = of->bodies;
    double *at = memory;
    memset(memory, 0, film_chain_size(n));
    c->y = at, c->trial = c->y + PARTS * n, c->slope = c->trial + PARTS * n, c->force = c->slope + PARTS * STAGES * n;
    c->sign = c->force + n, c->sign_now = c->sign + SIGNS * n, c->watch = c->sign_now + SIGNS * n;
    c->state = (film_state *)(void *)(c->watch + SIGNS * n);
    c->result = result;
    c->time = 0.0;
    for (int32_t k = 0; k < n; k++) {
        c->y[V * n + k] = of->velocity[k];
        if (k >= of->contacts) continue;
        c->y[D * n + k] = -of->contact[k].gap;
        result[k] = (film_chain_summary){.time_of_largest_force = NAN, .begins = NAN, .ends = NAN};
        /* never reported: that a body stops */
        int status = film_init(of->contact[k].curve, &c->state[k], fmin(-of->contact[k].gap, 0.0), 0.0, 0.0, 0.0, -1e300);
        if (status == FILM_OK) status = film_damp(&c->state[k], of->contact[k].damping);
        if (status != FILM_OK) return status;
    }
    return FILM_OK;
}

int film_chain_run(const film_chain *of, double *time, double *indentation, double *velocity, film_chain_summary *contact,
                   int64_t count, const double *times, double *samples, int32_t *steps, int32_t *failed, void *memory) {
    chain c = {.of = of};
    double h = BEGIN * pow(of->tolerance, 0.4);
    int64_t done = 0;
    int status = begin(&c, memory, contact);
    for (*steps = 0; status == FILM_OK && c.time < of->limit; ++*steps) {
        double free_time = choose_window(&c);
        if (c.last < c.first && (free_time == INFINITY || (of->limit == INFINITY && is_over(&c)))) {
            status = FILM_EVENT;
            break;
        }
        if (*steps == of->most_steps) status = FILM_TOO_MANY;
        else status = advance(&c, &h, free_time, &done, count, times, samples, failed);
    }
    *time = c.time;
    for (int32_t k = 0; k < c.n; k++) indentation[k] = c.y[D * c.n + k], velocity[k] = c.y[V * c.n + k];
    for (int32_t k = 0; k < of->contacts; k++) contact[k].work = c.y[W * c.n + k], contact[k].touching = touching(&c, k);
    if (status >= 0) {
        choose_window(&c);
        if (c.last >= c.first) slopes(&c, c.y, c.slope);
        sample(&c, INFINITY, done, count, times, samples);
    }
    return status;
}

void film_chain_sizes(int64_t sizes[3]) {
    sizes[0] = sizeof(film_chain);
    sizes[1] = sizeof(film_chain_contact);
    sizes[2] = sizeof(film_chain_summary);
}
