/* One step of a chain of bodies. docs/method.md, section 16. */
#include "chain/film_chain_parts.h"

#include "chain/film_dop853.h"
#include "curve/film_law.h"

enum { NEAR_BY = 512 }; /* numbers of the motion that are combined together, and stay in the fastest memory */

double film_chain_force(const film_chain_now *c, const double *y, int32_t k) {
    if (!film_touching(c, k)) return 0.0;
    const film_chain_contact *at = &c->of->contact[k];
    const film_line *line = &c->state[k].line;
    double xi = y[k] / at->length, f, work;
    law_at(at->curve, line, xi, &f, &work);
    return at->force * total_force(line, damping_at(at->curve, line, xi), f, film_rate(c, y, k));
}

void film_chain_forces(const film_chain_now *c, const double *y) {
    for (int32_t i = 0; i < c->movers; i++) c->push[c->mover[i]] = 0.0;
    for (int32_t i = 0; i < c->actives; i++) {
        int32_t k = c->active[i];
        const film_chain_contact *at = &c->of->contact[k];
        double force = c->force[k] = film_chain_force(c, y, k);
        c->push[at->front] -= at->along * force;
        c->push[at->behind] += force;
    }
}

/* Slopes of the vibrations under the forces. */
static void vibrate(const film_chain_now *c, const double *q, double *to) {
    const film_chain *of = c->of;
    int32_t n = of->modes;
    double lost[4] = {0.0, 0.0, 0.0, 0.0};
    for (int32_t j = 0; j < n; j++) {
        double rate = q[n + j], drag = of->drag[j] * rate;
        to[j] = rate;
        to[n + j] = -(drag + of->square[j] * q[j]);
        lost[j % 4] += drag * rate;
    }
    for (int32_t i = 0; i < c->actives; i++) {
        const film_chain_contact *at = &of->contact[c->active[i]];
        double push = at->side * c->force[c->active[i]];
        if (at->point < 0 || push == 0.0) continue;
        const double *shape = of->shapes + (size_t)at->point * (size_t)n;
        for (int32_t j = 0; j < n; j++) to[n + j] += push * shape[j];
    }
    to[2 * n] = (lost[0] + lost[1]) + (lost[2] + lost[3]);
}

void film_chain_slopes(const film_chain_now *c, const double *y, double *to) {
    film_chain_forces(c, y);
    for (int32_t i = 0; i < c->actives; i++) {
        int32_t k = c->active[i];
        to[k] = film_rate(c, y, k);
        to[c->m + k] = c->force[k] * to[k];
    }
    double *v = film_velocities(c, to);
    for (int32_t i = 0; i < c->movers; i++) {
        int32_t b = c->mover[i];
        v[b] = c->of->fall[b] + c->push[b] / c->of->mass[b];
    }
    if (c->of->modes) vibrate(c, y + 2 * c->m + c->n + 1, film_vibrations(c, to));
}

/* to = y + h (weights of a row) times the slopes, of `size` numbers from `first` on. */
static void combine_part(const film_chain_now *c, const film_rk_row *row, double h, double *to, int32_t first, int32_t size) {
    const double *y = c->y + first;
    double *out = to + first;
    for (int32_t k = 0; k < size; k++) out[k] = y[k];
    for (int j = 0; j < row->count; j++) {
        const double *slope = c->slope + row->from[j] * c->size + first;
        double weight = h * row->weight[j];
        for (int32_t k = 0; k < size; k++) out[k] += weight * slope[k];
    }
}

static void combine(const film_chain_now *c, const film_rk_row *row, double h, double *to) {
    for (int32_t part = 0; part < c->spans; part++)
        for (int32_t done = 0, size = c->span[part].size; done < size; done += NEAR_BY)
            combine_part(c, row, h, to, c->span[part].first + done, size - done < NEAR_BY ? size - done : NEAR_BY);
}

void film_chain_step(const film_chain_now *c, double h) {
    const double *v = film_velocities(c, c->y);
    double *to = film_velocities(c, c->trial);
    for (int32_t k = 0; k < c->m; k++) { /* free motion */
        c->trial[k] = c->y[k] + h * film_rate(c, c->y, k) + 0.5 * film_falling(c, k) * h * h;
        c->trial[c->m + k] = c->y[c->m + k];
    }
    for (int32_t b = 0; b < c->n; b++) to[b] = v[b] + c->of->fall[b] * h;
    if (c->actives == 0) return;
    for (int s = 1; s <= STAGES; s++) {
        combine(c, &DOP853[s], h, c->trial);
        if (s < STAGES) film_chain_slopes(c, c->trial, c->slope + s * c->size);
    }
}

/* Estimates of orders 5 and 3 of number i of the motion, in this unit: the largest so far are kept, and their sum. */
static void estimate(const film_chain_now *c, int32_t i, double unit, double largest[2], double *sum) {
    double five = 0.0, three = 0.0;
    for (int s = 0; s < STAGES; s++) {
        double slope = c->slope[s * c->size + i];
        five += FIFTH[s] * slope;
        three += THIRD[s] * slope;
    }
    *sum += five + three;
    largest[0] = greater(largest[0], fabs(five / unit));
    largest[1] = greater(largest[1], fabs(three / unit));
}

/* Both estimates are combined as in dop853.f. INFINITY: the step leaves the range of a law. */
double film_chain_error(const film_chain_now *c, double h) {
    double largest[2] = {0.0, 0.0}, sum = 0.0;
    if (c->actives == 0) return 0.0;
    for (int32_t i = 0; i < c->actives; i++) {
        const film_chain_contact *at = &c->of->contact[c->active[i]];
        estimate(c, c->active[i], at->length * at->depth, largest, &sum);
    }
    for (int32_t i = 0; i < c->movers; i++) estimate(c, 2 * c->m + c->mover[i], 1.0, largest, &sum);
    for (int32_t j = 0; j < c->of->modes; j++)
        if (c->reach[j] > 0.0) estimate(c, 2 * c->m + c->n + 1 + c->of->modes + j, 1.0 / c->reach[j], largest, &sum);
    if (!isfinite(sum)) return INFINITY;
    double fifth = largest[0], third = largest[1];
    return fifth == 0.0 ? 0.0 : fabs(h) * fifth * fifth / sqrt(fifth * fifth + 0.01 * third * third) / c->of->tolerance;
}
