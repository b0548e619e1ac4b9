/* Bodies in a row that touch their neighbours only, and a fixed support behind the last one if there is a contact for it:
 *
 *     d_k' = v_k - v_{k+1}                      indentation between bodies k and k + 1 (negative: gap)
 *     m_k v_k' = m_k gravity + F_{k-1} - F_k    F_k(d_k, d_k'): the law of contact k, with its own history
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
} film_chain_contact;

typedef struct {
    int32_t bodies, contacts; /* contacts: bodies - 1, or bodies with a support */
    const double *mass, *velocity;
    const film_chain_contact *contact;
    double gravity;      /* acceleration towards the support */
    double limit;        /* time; INFINITY: until contact is open everywhere and no neighbours approach */
    double tolerance;    /* of a step: velocities, and indentations over their depths */
    int32_t most_steps, reserved;
} film_chain;

/* What one contact did. NaN: it did not happen. work: done on the indentation, less what it gave back. */
typedef struct {
    double largest_force, time_of_largest_force, largest_indentation, begins, ends, work;
    int32_t count, touching;
} film_chain_summary;

enum { FILM_CHAIN_COLUMNS = 3 }; /* of a sample, each for all bodies: indentation, velocity, force of contact k */

/* Number of doubles and bytes that film_chain_run needs. */
FILM_API size_t film_chain_size(int32_t bodies);

/* From the start to the limit or to the end. indentation, velocity, work: as above, `bodies` each, at the end, where the last
 * indentation is the displacement of the last body; work without the law's history is its integral. contact: `contacts` rows.
 * times: `count` of samples, ascending; samples: rows of FILM_CHAIN_COLUMNS x bodies; beyond the end, free motion.
 * FILM_EVENT: nothing more happens without gravity; FILM_OK: at the limit; FILM_TOO_MANY steps; or what the law of contact
 * *failed refuses. memory: film_chain_size. */
FILM_API int film_chain_run(const film_chain *chain, double *time, double *indentation, double *velocity,
                            film_chain_summary *contact, int64_t count, const double *times, double *samples, int32_t *steps,
                            int32_t *failed, void *memory);

FILM_API void film_chain_sizes(int64_t sizes[3]);

#endif
