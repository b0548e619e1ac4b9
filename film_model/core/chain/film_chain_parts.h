/* What the files of a chain share: its state, the steps and the events. Internal. docs/method.md, section 16. */
#ifndef FILM_CHAIN_PARTS_H
#define FILM_CHAIN_PARTS_H

#include "chain/film_chain.h"

enum { TURN, FAR, NEAR, PEAK, SIGNS }; /* what may happen at a contact: film_indicators, and the peak of a damped force */

typedef struct {
    int32_t first, size;
} film_span;

/* Of a contact: indentation, its rate and the change of that. */
typedef struct {
    double way, rate, change;
} film_approach;

/* The motion is a row of numbers: indentations, works, velocities and the 0 of the support's; then q, q' and the energy that
 * damping has taken. */
typedef struct {
    const film_chain *of;
    int32_t n, m, size;             /* bodies, contacts, numbers of the motion */
    int32_t actives, movers, spans; /* what is integrated: contacts, their bodies, and the same as spans of the motion */
    int known;                      /* 1: `sign`, `force` and `push` are those of y and of what is integrated */
    double *y, *trial, *slope, *force, *push, *sign, *sign_now, *reach, time; /* reach: largest |shape| of each mode at a contact */
    int32_t *active, *mover;
    film_approach *now, *low, *high; /* for film_chain_event: in `trial`, and at both ends of an interval */
    uint8_t *is_active, *moves, *watch;
    film_span *span;
    film_state *state;
    film_chain_summary *result;
} film_chain_now;

static inline double *film_velocities(const film_chain_now *c, double *y) { return y + 2 * c->m; }

static inline int film_touching(const film_chain_now *c, int32_t k) { return c->state[k].branch != FILM_FREE; }

/* fmax and fmin of numbers, which compilers inline. */
static inline double greater(double a, double b) { return a > b ? a : b; }
static inline double lesser(double a, double b) { return a < b ? a : b; }

/* The vibrations in a motion: q, q' and what damping has taken. */
static inline double *film_vibrations(const film_chain_now *c, double *y) { return film_velocities(c, y) + c->n + 1; }

/* Sum over the modes of their shapes at a point times a row of numbers, in four parts, which processors add at once. */
static inline double film_at_point(const film_chain_now *c, int32_t point, const double *row) {
    int32_t modes = c->of->modes, j = 0;
    const double *shape = c->of->shapes + (size_t)point * (size_t)modes;
    double part[4] = {0.0, 0.0, 0.0, 0.0};
    for (; j + 4 <= modes; j += 4)
        for (int i = 0; i < 4; i++) part[i] += shape[j + i] * row[j + i];
    for (; j < modes; j++) part[0] += shape[j] * row[j];
    return (part[0] + part[1]) + (part[2] + part[3]);
}

/* d_k' of a motion; of its slope, d_k''. */
static inline double film_rate(const film_chain_now *c, const double *y, int32_t k) {
    const film_chain_contact *at = &c->of->contact[k];
    const double *v = y + 2 * c->m;
    double rate = at->along * v[at->front] - v[at->behind];
    return at->point < 0 ? rate : rate - at->side * film_at_point(c, at->point, v + c->n + 1 + c->of->modes);
}

/* The same of accelerations by weight: of a contact that is open. */
static inline double film_falling(const film_chain_now *c, int32_t k) {
    const film_chain_contact *at = &c->of->contact[k];
    return (at->front < c->n ? at->along * c->of->fall[at->front] : 0.0) - (at->behind < c->n ? c->of->fall[at->behind] : 0.0);
}

/* film_chain_step.c */
double film_chain_force(const film_chain_now *c, const double *y, int32_t k);  /* of contact k; 0 where bodies do not touch */
void film_chain_forces(const film_chain_now *c, const double *y);              /* `force` and `push` of what is integrated */
void film_chain_slopes(const film_chain_now *c, const double *y, double *to);  /* y', with the forces */
void film_chain_step(const film_chain_now *c, double h);                       /* trial: y after h, from the first slope */
double film_chain_error(const film_chain_now *c, double h);                    /* of that step over the tolerance */

/* film_chain_events.c */
void film_chain_signs(const film_chain_now *c, const double *y, double *signs); /* with the forces, of what is integrated */
double film_chain_event(const film_chain_now *c, double h);           /* the step is shortened to the first event in it */
int film_chain_switch(film_chain_now *c, int32_t *failed, double *h); /* the events that are due; h: of the next step */

#endif
