/* What happens at the contacts of a chain of bodies, and when. docs/method.md, section 16. */
#include "chain/film_chain_parts.h"

#include "chain/film_dop853.h"
#include "curve/film_law.h"

#include <string.h>

enum { MOST_SWITCHES = 8, ROOT_STEPS = 60 };

static const double AIM = -1e-13, LATEST = -4e-13; /* sign that a step to an event aims at, and the least that is accepted */
static const double STILL = 1e-2;   /* part of the tolerance: a rate inwards of a contact that is let go */
static const double BEGIN = 0.3;    /* first step of a contact over (tolerance/rate^1.5)^(2/5): Hertz's force is (rate t)^1.5 */
static const double COUNTED = 10.0; /* rate over the tolerance from which a contact that begins again is counted */

/* Signs of contact k in this motion of its own: what happens where one falls below 0. */
static void signs_of(const film_chain_now *c, int32_t k, const film_approach *now, double sign[SIGNS]) {
    const film_chain_contact *at = &c->of->contact[k];
    film_state *s = &c->state[k];
    double indicators[FILM_INDICATORS];
    for (int j = 0; j < SIGNS; j++) sign[j] = 1.0;
    s->xi = now->way / at->length;
    s->nu = now->rate;
    film_indicators(at->curve, s, 1e-3 * at->depth, indicators); /* late by 1e-3 of its 1e-10: LATE of film_chain.c */
    for (int j = TURN; j <= NEAR; j++) sign[j] = greater(lesser(indicators[j] / at->depth, 1.0), -1.0);
    if (s->damper == 0.0 || !film_touching(c, k)) return;
    film_contact force = film_force(at->curve, s, s->xi, s->nu);
    sign[PEAK] = force.by_xi * s->nu / at->length + force.by_nu * now->change;
}

static film_approach approach_of(const film_chain_now *c, const double *y, const double *slope, int32_t k) {
    return (film_approach){y[k], slope[k], film_rate(c, slope, k)};
}

void film_chain_signs(const film_chain_now *c, const double *y, double *signs) {
    double *slope = c->slope + (STAGES - 1) * c->size; /* the stage that the next step takes last */
    film_chain_slopes(c, y, slope);
    for (int32_t i = 0; i < c->actives; i++) {
        int32_t k = c->active[i];
        c->now[k] = approach_of(c, y, slope, k);
        signs_of(c, k, &c->now[k], signs + SIGNS * k);
    }
}

/* ---------------------------------------------------------------- when */

/* At t, on the polynomial of degree 5 that has way, rate and change at 0 and at w. */
static film_approach between(const film_approach *from, const film_approach *to, double w, double t) {
    double way = to->way - (from->way + w * (from->rate + 0.5 * w * from->change));
    double rate = w * (to->rate - (from->rate + w * from->change)), change = w * w * (to->change - from->change), s = t / w;
    double third = 10.0 * way - 4.0 * rate + 0.5 * change, fourth = -15.0 * way + 7.0 * rate - change;
    double fifth = 6.0 * way - 3.0 * rate + 0.5 * change;
    return (film_approach){
        from->way + t * (from->rate + 0.5 * t * from->change) + s * s * s * (third + s * (fourth + s * fifth)),
        from->rate + t * from->change + s * s * (3.0 * third + s * (4.0 * fourth + s * 5.0 * fifth)) / w,
        from->change + s * (6.0 * third + s * (12.0 * fourth + s * 20.0 * fifth)) / (w * w),
    };
}

/* When sign j of contact k falls to AIM within w, on that polynomial, by the Illinois method; w: it does not. */
static double fall_of(const film_chain_now *c, int32_t k, int j, double w) {
    double low = 0.0, high = w, sign[SIGNS], t = w;
    int side = 0;
    signs_of(c, k, &c->low[k], sign);
    double at_low = sign[j] - AIM;
    signs_of(c, k, &c->high[k], sign);
    double at_high = sign[j] - AIM;
    if (!(at_low > 0.0 && at_high < 0.0)) return w;
    for (int count = 0; count < ROOT_STEPS && high - low > 1e-16 * w; count++) {
        t = low + (high - low) * fmin(fmax(at_low / (at_low - at_high), 0.001), 0.999);
        film_approach now = between(&c->low[k], &c->high[k], w, t);
        signs_of(c, k, &now, sign);
        double at = sign[j] - AIM;
        if (fabs(at) < 0.5 * fabs(AIM)) break;
        if (at < 0.0) {
            if (side < 0) at_low *= 0.5;
            high = t, at_high = at, side = -1;
        } else {
            if (side > 0) at_high *= 0.5;
            low = t, at_low = at, side = 1;
        }
    }
    return t;
}

/* The least of the signs that are watched: those that were above 0 at the beginning of the step and have been seen below. */
static double watched(const film_chain_now *c) {
    double least = 1.0;
    for (int32_t i = 0; i < c->actives; i++)
        for (int32_t j = SIGNS * c->active[i]; j < SIGNS * (c->active[i] + 1); j++) {
            if (c->sign[j] > 0.0 && c->sign_now[j] < 0.0) c->watch[j] = 1;
            if (c->watch[j]) least = lesser(least, c->sign_now[j]);
        }
    return least;
}

/* The first event within w, of what is watched. */
static double first_event(const film_chain_now *c, double w) {
    double first = w;
    for (int32_t i = 0; i < c->actives; i++)
        for (int32_t j = 0; j < SIGNS; j++)
            if (c->watch[SIGNS * c->active[i] + j]) first = lesser(first, fall_of(c, c->active[i], j, w));
    return first;
}

/* Between the ends of an interval that holds the event, the motion comes from a polynomial, whose error falls with the third
 * power of the distance from an end: two steps are mostly enough. Halving makes sure of the others. */
double film_chain_event(const film_chain_now *c, double h) {
    double low = 0.0, high = h;
    size_t size = (size_t)c->m * sizeof(film_approach);
    if (c->actives == 0) return h;
    memset(c->watch, 0, (size_t)(SIGNS * c->m));
    for (int32_t i = 0; i < c->actives; i++) { /* the forces are those of c->y */
        int32_t k = c->active[i];
        c->low[k] = approach_of(c, c->y, c->slope, k);
    }
    film_chain_signs(c, c->trial, c->sign_now);
    if (watched(c) >= LATEST) return h;
    memcpy(c->high, c->now, size);
    for (int count = 1; count <= ROOT_STEPS && high - low > 1e-16 * h; count++) {
        double t = count % 4 == 0 ? 0.5 * (high - low) : first_event(c, high - low);
        h = low + (t > 0.0 && t < high - low ? t : 0.5 * (high - low));
        film_chain_step(c, h);
        film_chain_signs(c, c->trial, c->sign_now);
        double at = watched(c);
        if (at < 0.0 && at >= LATEST) break;
        memcpy(at < 0.0 ? c->high : c->low, c->now, size);
        *(at < 0.0 ? &high : &low) = h;
    }
    return h;
}

/* ---------------------------------------------------------------- what follows */

/* The state goes on from an event at contact k: 0 or above, or what its law refuses. */
static int switch_contact(film_chain_now *c, int32_t k) {
    const film_chain_contact *at = &c->of->contact[k];
    film_chain_summary *result = &c->result[k];
    film_state *s = &c->state[k];
    int status = FILM_EVENT;
    for (int count = 0; count < MOST_SWITCHES && status == FILM_EVENT; count++) {
        s->xi = c->y[k] / at->length;
        s->nu = film_rate(c, c->y, k);
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
static void let_go(film_chain_now *c, int32_t k) {
    film_state *s = &c->state[k];
    const film_chain_contact *at = &c->of->contact[k];
    double left = c->y[k] / at->length - s->xi_free, f, work;
    if (at->point >= 0) return; /* a structure in motion parts them */
    if (at->curve->pull > 0.0 || !(left > 0.0 && fabs(s->nu) < c->of->tolerance * (s->direction < 0 ? 1.0 : STILL))) return;
    law_at(at->curve, &s->line, c->y[k] / at->length, &f, &work);
    if (f * at->force * left * at->length > c->of->tolerance * c->of->tolerance * c->of->mass[at->front]) return;
    c->y[k] = s->xi_free * at->length;
    s->branch = FILM_FREE;
    s->phase = FILM_SEPARATED;
    c->known = 0;
    c->result[k].ends = c->time;
}

/* At contacts that are integrated or that free motion has closed. */
int film_chain_switch(film_chain_now *c, int32_t *failed, double *h) {
    for (int32_t k = 0; k < c->m; k++) {
        double *sign = c->sign + SIGNS * k;
        if (!c->is_active[k]) {
            if (c->y[k] < c->state[k].xi_free * c->of->contact[k].length) continue;
            film_approach now = {c->y[k], film_rate(c, c->y, k), 0.0};
            signs_of(c, k, &now, sign);
        }
        if (sign[TURN] > 0.0 && sign[FAR] > 0.0 && sign[NEAR] > 0.0) {
            if (film_touching(c, k)) let_go(c, k);
            continue;
        }
        c->known = 0;
        int free = !film_touching(c, k), status = switch_contact(c, k);
        if (free && film_touching(c, k))
            *h = fmin(*h, BEGIN * pow(c->of->tolerance, 0.4) * pow(fabs(film_rate(c, c->y, k)), -0.6));
        *failed = k;
        if (status < 0) return status;
    }
    return FILM_OK;
}
