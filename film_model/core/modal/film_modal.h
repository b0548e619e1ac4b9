/* Contact between an impactor and a structure that is known by its natural vibrations, its modes:
 *
 *     x'' = (p - F)/t_s^2                                   impactor displacement x
 *     w_n'' + 2 zeta_n omega_n w_n' + omega_n^2 w_n = share_n k F     displacement of the struck point, mode by mode
 *     xi = x - sum w_n - c F,   F = f(xi) + damping xi'     the law's curve; c: static compliance of the omitted modes
 *
 * Lengths are in units of delta_s and forces in units of F_s, as in film_core.h; time is in the unit of the frequencies, in
 * which the march's unit of time is t_s, and k = m/t_s^2 with the impactor's mass m in the unit of 1/share.
 *
 * Over a step the force is the cubic through its values at four Gauss nodes; under it impactor and modes are followed exactly.
 * docs/method.md, section 13, derives that. Nothing is allocated; the caller owns all memory, and a film_modal together with
 * its waves[] is the whole state: copying both saves it. */
#ifndef FILM_MODAL_H
#define FILM_MODAL_H

#include "film_core.h"

enum {
    FILM_NODES = 4,      /* Gauss nodes of a step */
    FILM_LEVELS = 40,    /* step sizes: longest/2^level */
    FILM_FLIGHTS = 10,   /* step sizes in one flight */
    FILM_BENDS = 6,      /* numbers of the interpolation of x - sum w_n within a step */
    FILM_MOST_MODES = 10000000,
    FILM_MOST_CARRIED = 64, /* modes with membrane forces */
    FILM_MODES_OF_A_STEP = 200, /* a step takes as long as this many modes in it, 2 to 5 ns each */
    FILM_MOST_WORK = 120000000  /* largest `steps` of film_modal times (modes + FILM_MODES_OF_A_STEP) */
};

/* The modes, and tables for every step size used so far. Not to be shared by threads: step sizes are tabulated on demand. */
typedef struct {
    int32_t modes, levels, rigid;       /* rigid: modes of frequency 0, which come first */
    int32_t made[FILM_LEVELS];          /* whether a level is tabulated */
    int32_t instructions;               /* FILM_PLAIN, FILM_AVX2 or FILM_AVX512; the bits are the same with all of them */
    double longest;                     /* step of level 0 */
    int32_t carried, stresses;          /* membrane forces: of the first modes, by so many forms; 0: none */
    const double *frequency, *share;    /* ascending, >= 0; > 0 */
    const double *forms;                /* [stresses][carried][carried], symmetric */
    double *square, *drag;              /* omega^2, 2 zeta omega */
    double *tables;
} film_structure;

/* What one contact on a structure starts with, at first touch. */
typedef struct {
    double nu, load;      /* velocity in delta_s/t_s; p */
    double rest;          /* c, static compliance of the omitted modes in delta_s/F_s */
    double mass, unit;    /* m; t_s */
    double damping;       /* factor of film_damp */
    double tolerance;     /* of a step: error of its impulse over the momentum at the start */
    double limit;         /* time at which a contact is no longer followed */
    double stop;          /* velocity in delta_s/t_s at which FILM_IMPACTOR_STOPS is reported */
    double stretch;       /* delta_s^2 in the unit of length of the forms of film_structure_stretch */
} film_modal_start;

/* The state; of waves[] beside it one half holds w_n and w_n' at the beginning of the step, the other both at its end. */
typedef struct {
    film_state contact;               /* branch, dent and direction; xi and nu (rate of xi) at the last event */
    double time, time_low;            /* when the step began, and what rounding drops */
    double x, v;                      /* of the impactor `since` after the step began: 0, but in a jump with new inputs */
    double since;
    double shift, rate;               /* sums of w_n and w_n' then */
    double load, rest, mass, unit;    /* as in film_modal_start */
    double stretch;                   /* as in film_modal_start */
    double stop;                      /* velocity of the impactor at which FILM_IMPACTOR_STOPS is reported */
    double speed, tolerance;          /* reference velocity for errors, in delta_s per unit of time; of a step */
    double last_force, last_slope;    /* of the force's cubic where the last step in contact ended */
    double spent, peak;               /* work done on the indentation and the rest compliance; largest F */
    double deepest;                   /* largest x - sum w_n at a turn that a step passed */
    double h, tau;                    /* duration of the step, and time since it began */
    double force[FILM_NODES];         /* F at the nodes */
    double bend[FILM_BENDS];
    double end_x, end_v, end_shift, end_rate;
    double event_at;                  /* time in the step of the next event that does not end it; INFINITY: none */
    double reach;                     /* in flight: the most that the modes can move the struck point */
    double blur[FILM_FLIGHTS];        /* in flight: error of the interpolation over steps of 2^k times the shortest */
    int32_t event_kind, ends;         /* of that event; how the step ends: ENDS_... in film_march.h */
    int32_t end_direction;            /* in which the contact then moves */
    int32_t half;                     /* of waves[] that holds the beginning of the step: 0 or 1 */
    int32_t level, flight_level;      /* of the next step; of the shortest steps in flight, -1 before they are known */
    int32_t kind, has_step;           /* FILM_STEP_... */
    int32_t short_steps, steps;       /* steps of duration 0 in sequence; work in steps, since the impact began or the
                                         caller of film_modal_step set it to 0 */
    int32_t moving_in, flight_size;   /* 1: the impactor's stop is still to be reported; k of the next step in flight */
} film_modal;

enum {
    FILM_STEP_CONTACT = 0, /* under the cubic force */
    FILM_STEP_FLIGHT = 1,  /* without contact, of a length at which the interpolation is exact enough */
    FILM_STEP_JUMP = 2,    /* without contact, of any length */
    FILM_STEP_REST = 3     /* in contact at rest under a load, without end */
};

/* A step as recorded, or a whole flight: `flight` is the place of its modal state among the flights, -1 in contact; h of a
 * flight and of a contact at rest is INFINITY. */
typedef struct {
    double time, h, x, v, depth, depth_rate; /* depth: x - sum w_n */
    double load, unit, rest;
    double force[FILM_NODES], bend[FILM_BENDS];
    film_line line;
    int32_t flight, reserved;
} film_modal_segment;

/* An event: the five values of film_motion there, times in the structure's unit. */
typedef struct {
    double time, values[5];
    int32_t event, branch;
} film_modal_event;

/* The caller's arrays for a record, and how much of each is filled. flights: 2 n numbers each. */
typedef struct {
    film_modal_segment *segments;
    film_modal_event *events;
    double *flights;
    int32_t segment_room, event_room, flight_room;
    int32_t segment_count, event_count, flight_count;
} film_modal_record;

/* What an impact did; times in the structure's unit. contact_duration: of the first contact; permanent_indentation and
 * final_velocity: after the last. waited: 1 if the structure still moves so far that it may touch the impactor again. */
typedef struct {
    film_summary core;
    int32_t contacts, waited;
} film_modal_summary;

/* Number of doubles that film_structure_init needs; memory must outlive the structure, as must frequency and share. */
FILM_API size_t film_structure_size(int32_t modes, int32_t levels);

/* FILM_OK, or FILM_BAD_NUMBER: frequencies not ascending or below 0, shares not above 0, damping ratios outside 0 .. 1 (NULL:
 * all 0), a number that is not finite. */
FILM_API int film_check_modes(int32_t modes, const double *frequency, const double *share, const double *ratio);

/* FILM_OK, or FILM_BAD_NUMBER: as film_check_modes; or levels outside 1 .. FILM_LEVELS, a longest step not above 0. */
FILM_API int film_structure_init(film_structure *structure, int32_t modes, const double *frequency, const double *share,
                                 const double *ratio, double longest, int32_t levels, double *memory);

/* Membrane forces of the first `carried` modes, of the energy 1/2 sum_k (sum_ij forms_kij w_i w_j)^2, w in the caller's unit of length
 * and the energy in that of 1/share times length^2 over the structure's unit of time squared. FILM_OK or FILM_BAD_NUMBER. */
FILM_API int film_structure_stretch(film_structure *structure, int32_t carried, int32_t stresses, const double *forms);

/* Number of doubles of waves[]. */
FILM_API size_t film_waves_size(const film_structure *structure);

/* A state at xi <= 0 in front of the structure at rest, or at first touch. waves: film_waves_size doubles. */
FILM_API int film_modal_init(const film_structure *structure, const film_curve *curve, film_modal *state, double *waves,
                             const film_modal_start *start, double xi);

/* A new load, a velocity change of the impactor and the velocity at which its stop is reported, as film_input, from now on. */
FILM_API int film_modal_input(const film_structure *structure, const film_curve *curve, film_modal *state, double *waves,
                              double load, double nu_change, double stop_velocity);

/* Forward by dt >= 0 (INFINITY allowed) or to the next event, whichever is first: FILM_OK, FILM_EVENT
 * (state->contact.event), FILM_ENDLESS (it flies away, or rests), or a failure; FILM_TOO_MANY where state->steps exceeds what
 * FILM_MOST_WORK allows. The state is at time + tau either way. */
FILM_API int film_modal_step(film_structure *structure, const film_curve *curve, film_modal *state, double *waves, double dt);

/* The five values of film_motion now: xi, its rate, F, nu, displacement of the struck point; rates in delta_s/t_s. */
FILM_API void film_modal_motion(const film_structure *structure, const film_curve *curve, const film_modal *state,
                                const double *waves, double values[5]);

/* Whether the impactor moves freely in a jump, so that only what the structure does needs a sum over all modes; then its x, and v in
 * delta_s/t_s, now. */
FILM_API int film_modal_jumps(const film_modal *state, double *x, double *nu);

/* Force and derivatives on the current branch at an indentation and its rate, as film_force. */
FILM_API film_contact film_modal_force(const film_curve *curve, const film_modal *state, double xi, double rate);

/* Work done on the indentation so far; force: F now. */
FILM_API double film_modal_work(const film_modal *state, double force);

/* Energy of each mode now, over F_s delta_s. */
FILM_API void film_modal_energies(const film_structure *structure, const film_modal *state, const double *waves, double *energies);

/* Energy of the membrane forces now, over F_s delta_s. */
FILM_API double film_modal_stretching(const film_structure *structure, const film_modal *state, const double *waves);

/* Displacement, velocity and acceleration of `sensors` points of the structure now, 3 numbers each, in delta_s and the structure's
 * unit of time. weights: n numbers a point, the deflection of each mode there over that at the struck point. */
FILM_API void film_modal_sensed(const film_structure *structure, const film_modal *state, const double *waves, int32_t sensors,
                                const double *weights, double *sensed);

/* One impact, until the impactor is out of reach of the structure or has waited as long as it was in contact before and
 * for the longest period: FILM_EVENT when contact has ended, FILM_ENDLESS when it rests under its load, FILM_OK at the time
 * limit, or a failure. record may be NULL;
 * FILM_FULL: make room in it and call film_modal_go_on, which goes on from there. */
FILM_API int film_modal_impact(film_structure *structure, const film_curve *curve, const film_modal_start *start,
                               film_modal *state, double *waves, film_modal_summary *summary, film_modal_record *record);
FILM_API int film_modal_go_on(film_structure *structure, const film_curve *curve, double limit, film_modal *state,
                              double *waves, film_modal_summary *summary, film_modal_record *record);

/* count impacts, one after the other, on one structure. waves: as film_modal_init. */
FILM_API void film_modal_batch(film_structure *structure, const film_curve *curve, int64_t count, const film_modal_start *start,
                               double *waves, film_modal_summary *summary, int32_t *status);

/* The impact under the law alone, without damping, on a target that does not move; where the law ends before the maximum indentation, with
 * times of the march's unit. */
FILM_API void film_modal_still(const film_curve *curve, double nu, film_summary *summary);

/* The part of a structure's static compliance that a contact feels: of modes with omega t_c above `slow`, and `rest`. Slower ones, `free`
 * of them, move as free masses. t_c: contact time, `shortest` on a fixed target, which the compliance felt lengthens and these masses
 * shorten. mass: of the impactor; softness: of the contact. */
FILM_API double film_modal_felt(int32_t modes, const double *frequency, const double *share, double rest, double mass, double shortest,
                                double softness, double slow, int32_t *free);

/* Samples at count times, ascending, as film_sample. flights: as recorded. */
FILM_API void film_modal_sample(const film_structure *structure, const film_curve *curve, const film_modal_segment *segments,
                                int32_t segment_count, const double *flights, const double *times, int64_t count,
                                double *values, int8_t *branches);

/* sizeof film_structure, film_modal, film_modal_start, film_modal_segment, film_modal_event, film_modal_summary. */
FILM_API void film_modal_sizes(int64_t sizes[6]);

#endif
