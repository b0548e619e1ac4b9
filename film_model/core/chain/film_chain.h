/* Bodies on lines, each guided along its own, which touch in pairs: body a of contact k is in front, b behind, and the
 * line of b is at an angle with cosine c_k to that of a.
 *
 *     d_k' = c_k v_a - v_b              indentation (negative: gap)
 *     m_b v_b' = m_b fall_b + F_k       F_k(d_k, d_k'): the law of contact k, with its own history
 *     m_a v_a' = m_a fall_a - c_k F_k   and so on: each body has the sum over its contacts
 *
 * by the method of Dormand and Prince of order 8 (Hairer, Norsett & Wanner, Solving ODEs I, DOP853) with a step that ends at
 * each event. Units: any of mass, length and velocity; time is length over velocity. docs/method.md, section 16. */
#ifndef FILM_CHAIN_H
#define FILM_CHAIN_H

#include "film_core.h"

typedef struct {
    const film_curve *curve; /* without a spring */
    double length, force;    /* units of its indentation and force */
    double depth;            /* about its largest indentation, over `length`: what is small beside it is rounding */
    double damping;          /* factor of film_damp for indentation rates in the unit of velocity */
    double gap;              /* at the start */
    double along;            /* c_k */
    int32_t front, behind;   /* its bodies; behind = bodies: a fixed support */
} film_chain_contact;

typedef struct {
    int32_t bodies, contacts;
    const double *mass, *velocity, *fall; /* fall: acceleration by the weight */
    const film_chain_contact *contact;
    double limit;        /* time; INFINITY: until contact is open everywhere and no neighbours approach */
    double tolerance;    /* of a step: velocities, and indentations over their depths */
    int32_t most_steps, reserved;
} film_chain;

/* What one contact did. NaN: it did not happen. work: done on the indentation, less what it gave back. */
typedef struct {
    double largest_force, time_of_largest_force, largest_indentation, begins, ends, work;
    int32_t count, touching;
} film_chain_summary;

/* Bytes that film_chain_run needs. */
FILM_API size_t film_chain_size(int32_t bodies, int32_t contacts);

/* From the start to the limit or to the end. indentation: of each contact, velocity: of each body, at the end. contact:
 * `contacts` rows. times: `count` of samples, ascending; samples: rows of indentations, velocities and forces; beyond the end,
 * free motion. FILM_EVENT: nothing more happens without weight; FILM_OK: at the limit; FILM_TOO_MANY steps; or what the law of
 * contact *failed refuses. memory: film_chain_size. */
FILM_API int film_chain_run(const film_chain *chain, double *time, double *indentation, double *velocity,
                            film_chain_summary *contact, int64_t count, const double *times, double *samples, int32_t *steps,
                            int32_t *failed, void *memory);

FILM_API void film_chain_sizes(int64_t sizes[3]);

#endif
