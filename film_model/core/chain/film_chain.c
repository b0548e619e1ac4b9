/* A chain of bodies: which of its contacts are integrated, and the run from step to step. docs/method.md, section 16. */
#include "chain/film_chain_parts.h"

#include "chain/film_dop853.h"

#include <math.h>
#include <string.h>

/* How late an event is seen: indentation over its depth, or rate over the unit of velocity. The impulse that this leaves out
 * is below rounding but for a force that jumps, of which it is this part. */
static const double LATE = 1e-13;
static const double FIRST = 0.3;                            /* first step over tolerance^(2/5) */
static const double MARGIN = 0.9, SHRINK = 0.1, GROW = 6.0; /* of the next step: as in dop853.f but for the cut */

size_t film_chain_size(int32_t bodies, int32_t contacts, int32_t modes) {
    size_t n = (size_t)bodies + 1, m = (size_t)contacts, size = 2 * m + n + (modes ? 2 * (size_t)modes + 1 : 0);
    return ((2 + STAGES) * size + m + n + 2 * SIGNS * m + (size_t)modes) * sizeof(double) +
           m * (sizeof(film_state) + 3 * sizeof(film_approach)) + size * sizeof(film_span) +
           (m + n) * (sizeof(int32_t) + 1) + SIGNS * m;
}

/* Keeps the largest values of contacts that are integrated. */
static void watch_largest(film_chain_now *c) {
    for (int32_t i = 0; i < c->actives; i++) {
        int32_t k = c->active[i];
        film_chain_summary *result = &c->result[k];
        if (film_touching(c, k)) result->largest_indentation = fmax(result->largest_indentation, c->y[k]);
        if (c->force[k] <= result->largest_force) continue;
        result->largest_force = c->force[k];
        result->time_of_largest_force = c->time;
    }
}

/* When free contact k touches if nothing pushes its bodies; INFINITY: it does not. A damped contact may have let go inside its
 * dent, and then has to leave it first. */
static double touch_time(const film_chain_now *c, int32_t k) {
    double v = film_rate(c, c->y, k), g = film_falling(c, k);
    if (!(g > 0.0 || v > c->of->tolerance)) return INFINITY;
    double gap = (c->state[k].xi_free + 2.0 * LATE * c->of->contact[k].depth) * c->of->contact[k].length - c->y[k];
    double square = v * v + 2.0 * g * gap;
    if (g <= 0.0 && square < 0.0) return INFINITY;
    if (v < 0.0) return square > 0.0 ? (sqrt(square) - v) / g : -v / g;
    return gap > 0.0 ? 2.0 * gap / (v + sqrt(square)) : 0.0;
}

/* Adds what is marked from 0 to count, in the motion from `first` on, to the spans. */
static void add_spans(film_chain_now *c, const uint8_t *marked, int32_t count, int32_t first) {
    for (int32_t i = 0; i < count; i++) {
        if (!marked[i]) continue;
        if (i == 0 || !marked[i - 1]) c->span[c->spans++] = (film_span){first + i, 0};
        c->span[c->spans - 1].size++;
    }
}

/* What is integrated: the contacts that touch or are on the structure, those that share a body with them, and the bodies of all
 * these. Returns the longest free motion of the others. */
static double choose_active(film_chain_now *c) {
    double free_time = INFINITY;
    memset(c->moves, 0, (size_t)c->n + 1);
    for (int32_t k = 0; k < c->m; k++)
        if (film_touching(c, k) || c->of->contact[k].point >= 0)
            c->moves[c->of->contact[k].front] = c->moves[c->of->contact[k].behind] = 1;
    c->moves[c->n] = 0;
    c->actives = c->movers = c->spans = 0;
    for (int32_t k = 0; k < c->m; k++) {
        const film_chain_contact *at = &c->of->contact[k];
        uint8_t active = c->moves[at->front] | c->moves[at->behind] | (at->point >= 0);
        c->known &= active == c->is_active[k];
        c->is_active[k] = active;
        if (active) c->active[c->actives++] = k;
        else free_time = lesser(free_time, touch_time(c, k));
    }
    for (int32_t i = 0; i < c->actives; i++)
        c->moves[c->of->contact[c->active[i]].front] = c->moves[c->of->contact[c->active[i]].behind] = 1;
    for (int32_t b = 0; b < c->n; b++)
        if (c->moves[b]) c->mover[c->movers++] = b;
    add_spans(c, c->is_active, c->m, 0);
    add_spans(c, c->is_active, c->m, c->m);
    add_spans(c, c->moves, c->n, 2 * c->m);
    if (c->of->modes) c->span[c->spans++] = (film_span){2 * c->m + c->n + 1, 2 * c->of->modes + 1};
    return free_time;
}

/* Whether there has been contact, there is none now, and bodies do not approach but for their weight. */
static int is_over(const film_chain_now *c) {
    int32_t count = 0;
    for (int32_t k = 0; k < c->m; k++) {
        if (film_touching(c, k) || film_rate(c, c->y, k) > c->of->tolerance) return 0;
        count += c->result[k].count;
    }
    return count > 0;
}

static void write_sample(const film_chain_now *c, double *row) {
    size_t m = (size_t)c->m, n = (size_t)c->n;
    memcpy(row, c->trial, m * sizeof(double));
    memcpy(row + m, film_velocities(c, c->trial), n * sizeof(double));
    for (int32_t k = 0; k < c->m; k++)
        row[c->m + c->n + k] = film_chain_force(c, c->trial, k);
    if (c->of->modes == 0) return;
    double *q = film_vibrations(c, c->trial), *slope = c->slope + (STAGES - 1) * c->size, *moved = row + 2 * m + n;
    film_chain_slopes(c, c->trial, slope);
    for (int32_t p = 0; p < c->of->points; p++, moved += 3) {
        moved[0] = film_at_point(c, p, q);
        moved[1] = film_at_point(c, p, q + c->of->modes);
        moved[2] = film_at_point(c, p, film_vibrations(c, slope) + c->of->modes);
    }
}

/* Samples up to h from now, each at the end of a step of its own; returns how many are done. */
static int64_t sample(const film_chain_now *c, double h, int64_t done, int64_t count, const double *times, double *samples) {
    for (; done < count && times[done] <= c->time + h; done++) {
        film_chain_step(c, times[done] - c->time);
        write_sample(c, samples + (2 * c->m + c->n + 3 * c->of->points) * done);
    }
    return done;
}

/* One step, at most to the limit, and the events at its end. h: that of the step control, and of the next step. */
static int advance(film_chain_now *c, double *h, double free_time, int64_t *done, int64_t count, const double *times,
                   double *samples, int32_t *failed) {
    double left = c->of->limit - c->time, length = fmin(fmin(c->actives ? *h : INFINITY, free_time), left), error;
    if (c->actives) film_chain_slopes(c, c->y, c->slope);
    if (!c->known) film_chain_signs(c, c->y, c->sign);
    for (;;) {
        film_chain_step(c, length);
        error = film_chain_error(c, length);
        double factor = fmin(fmax(MARGIN * pow(error, -0.125), SHRINK), GROW);
        if (error <= 1.0) {
            *h = length == *h || factor < 1.0 ? factor * length : fmax(*h, factor * length);
            break;
        }
        if (!(factor < 1.0)) return FILM_BAD_NUMBER;
        *h = length = factor * length;
        if (c->time + length == c->time) return FILM_TOO_MANY;
    }
    length = film_chain_event(c, length);
    int64_t before = *done;
    *done = sample(c, length, *done, count, times, samples);
    if (*done > before) film_chain_step(c, length);
    memcpy(c->y, c->trial, (size_t)c->size * sizeof(double));
    c->time = length == left ? c->of->limit : c->time + length;
    if (*done > before) film_chain_signs(c, c->y, c->sign_now); /* those of the step to the event otherwise */
    memcpy(c->sign, c->sign_now, (size_t)(SIGNS * c->m) * sizeof(double));
    c->known = 1;
    watch_largest(c);
    return film_chain_switch(c, failed, h);
}

static void divide_memory(film_chain_now *c, void *memory) {
    int32_t n = c->n + 1, m = c->m;
    memset(memory, 0, film_chain_size(c->n, m, c->of->modes));
    c->y = memory, c->trial = c->y + c->size, c->slope = c->trial + c->size;
    c->force = c->slope + STAGES * c->size, c->push = c->force + m;
    c->sign = c->push + n, c->sign_now = c->sign + SIGNS * m, c->reach = c->sign_now + SIGNS * m;
    c->now = (film_approach *)(void *)(c->reach + c->of->modes), c->low = c->now + m, c->high = c->low + m;
    c->state = (film_state *)(void *)(c->high + m);
    c->span = (film_span *)(void *)(c->state + m);
    c->active = (int32_t *)(void *)(c->span + c->size), c->mover = c->active + m;
    c->is_active = (uint8_t *)(void *)(c->mover + n), c->moves = c->is_active + m;
    c->watch = c->moves + n;
}

static int begin(film_chain_now *c, void *memory, film_chain_summary *result) {
    const film_chain *of = c->of;
    c->n = of->bodies, c->m = of->contacts, c->size = 2 * c->m + c->n + 1 + (of->modes ? 2 * of->modes + 1 : 0);
    divide_memory(c, memory);
    c->result = result;
    memcpy(film_velocities(c, c->y), of->velocity, (size_t)c->n * sizeof(double));
    for (int32_t k = 0; k < c->m; k++) {
        c->y[k] = -of->contact[k].gap;
        result[k] = (film_chain_summary){.time_of_largest_force = NAN, .begins = NAN, .ends = NAN};
        /* never reported: that a body stops */
        int status = film_init(of->contact[k].curve, &c->state[k], fmin(-of->contact[k].gap, 0.0), 0.0, 0.0, 0.0, -1e300);
        if (status == FILM_OK) status = film_damp(&c->state[k], of->contact[k].damping);
        if (status != FILM_OK) return status;
        if (of->contact[k].point < 0) continue;
        const double *shape = of->shapes + (size_t)of->contact[k].point * (size_t)of->modes;
        for (int32_t j = 0; j < of->modes; j++) c->reach[j] = greater(c->reach[j], fabs(shape[j]));
    }
    return FILM_OK;
}

/* Energy of the vibrations, and what their damping has taken. */
static void write_energies(const film_chain_now *c, double structure[2]) {
    int32_t n = c->of->modes;
    const double *q = film_vibrations(c, c->y);
    structure[0] = structure[1] = 0.0;
    for (int32_t j = 0; j < n; j++) structure[0] += 0.5 * (q[n + j] * q[n + j] + c->of->square[j] * q[j] * q[j]);
    if (n) structure[1] = q[2 * n];
}

int film_chain_run(const film_chain *of, double *time, double *indentation, double *velocity, film_chain_summary *contact,
                   double structure[2], int64_t count, const double *times, double *samples, int32_t *steps, int32_t *failed,
                   void *memory) {
    film_chain_now c = {.of = of};
    double h = FIRST * pow(of->tolerance, 0.4);
    int64_t done = 0;
    int status = begin(&c, memory, contact);
    for (*steps = 0; status == FILM_OK && c.time < of->limit; ++*steps) {
        double free_time = choose_active(&c);
        if (c.actives == 0 && (free_time == INFINITY || (of->limit == INFINITY && is_over(&c)))) {
            status = FILM_EVENT;
            break;
        }
        if (*steps == of->most_steps) status = FILM_TOO_MANY;
        else status = advance(&c, &h, free_time, &done, count, times, samples, failed);
    }
    *time = c.time;
    write_energies(&c, structure);
    memcpy(indentation, c.y, (size_t)c.m * sizeof(double));
    memcpy(velocity, film_velocities(&c, c.y), (size_t)c.n * sizeof(double));
    for (int32_t k = 0; k < c.m; k++) contact[k].work = c.y[c.m + k], contact[k].touching = film_touching(&c, k);
    if (status >= 0) {
        choose_active(&c);
        if (c.actives) film_chain_slopes(&c, c.y, c.slope);
        sample(&c, INFINITY, done, count, times, samples);
    }
    return status;
}

void film_chain_sizes(int64_t sizes[3]) {
    sizes[0] = sizeof(film_chain);
    sizes[1] = sizeof(film_chain_contact);
    sizes[2] = sizeof(film_chain_summary);
}
