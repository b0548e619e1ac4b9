/* Bodies on lines, each guided along its own, which touch in pairs: body a of contact k is in front, b behind, and the
 * line of b is at an angle with cosine c_k to that of a. In place of a or b may be a point of one vibrating structure.
 *
 *     d_k' = c_k v_a - v_b              indentation (negative: gap)
 *     m_b v_b' = m_b fall_b + F_k       F_k(d_k, d_k'): the law of contact k, with its own history
 *     m_a v_a' = m_a fall_a - c_k F_k   and so on: each body has the sum over its contacts
 *     q_n'' + drag_n q_n' + square_n q_n = sum_k s_k shape_kn F_k     vibrations; a point moves by sum_n shape_kn q_n
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
    int32_t front, behind;   /* its bodies; = bodies: a fixed support, or the structure */
    int32_t point, side;     /* of the structure, -1: not there; s_k: 1 where the structure is behind, -1 where in front */
} film_chain_contact;

typedef struct {
    int32_t bodies, contacts;
    const double *mass, *velocity, *fall; /* fall: acceleration by the weight */
    const film_chain_contact *contact;
    double limit;        /* time; INFINITY: until contact is open everywhere and no neighbours approach */
    double tolerance;    /* of a step: velocities, and indentations over their depths */
    int32_t most_steps;
    int32_t modes, points, reserved;      /* of the structure, 0: none; one contact at least is on it */
    const double *square, *drag, *shapes; /* shapes: [points][modes], of modal masses of 1 */
} film_chain;

/* What one contact did. NaN: it did not happen. work: done on the indentation, less what it gave back. */
typedef struct {
    double largest_force, time_of_largest_force, largest_indentation, begins, ends, work;
    int32_t count, touching;
} film_chain_summary;

/* Bytes that film_chain_run needs. */
FILM_API size_t film_chain_size(int32_t bodies, int32_t contacts, int32_t modes);

/* From the start to the limit or to the end. indentation: of each contact, velocity: of each body, at the end. contact:
 * `contacts` rows. structure: energy of its vibrations at the end, and what their damping has taken. times: `count` of samples,
 * ascending; samples: rows of indentations, velocities and forces, then of displacement, velocity and acceleration of each point;
 * beyond the end, free motion. FILM_EVENT: nothing more happens without weight; FILM_OK: at the limit; FILM_TOO_MANY steps; or what the law of
 * contact *failed refuses. memory: film_chain_size. */
FILM_API int film_chain_run(const film_chain *chain, double *time, double *indentation, double *velocity,
                            film_chain_summary *contact, double structure[2], int64_t count, const double *times, double *samples,
                            int32_t *steps, int32_t *failed, void *memory);

FILM_API void film_chain_sizes(int64_t sizes[3]);

#endif
