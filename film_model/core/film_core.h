/* The FILM march: contact between an impactor and a target, in dimensionless form.
 *
 *     nu' = p - F          impactor velocity nu, load p held over a step
 *     xi' = nu - gamma F   indentation xi; gamma = 0 for a target that does not move
 *     F = f(xi) + c(xi) xi'   c > 0 only for a damped law, whose contact ends when F falls to 0
 *
 * Every number is dimensionless. Units: indentation delta_s and force F_s, the law's scales; time
 * t_s = sqrt(m delta_s/F_s); velocity v_s = delta_s/t_s; gamma = F_s/(Z v_s), Z the target's impedance; work F_s delta_s.
 * The core knows no law by name, no unit and no file. It allocates nothing, has no globals, calls nothing but
 * libm, and every loop in it is bounded. A film_state holds no pointer: copying it saves it.
 * docs/method.md derives what it does. */
#ifndef FILM_CORE_H
#define FILM_CORE_H

#include <stddef.h>
#include <stdint.h>

#if defined(FILM_API) /* an FMU defines it empty: the core inside it is its own */
#elif defined(_WIN32)
#define FILM_API __declspec(dllexport)
#elif defined(__GNUC__)
#define FILM_API __attribute__((visibility("default")))
#else
#define FILM_API
#endif

enum {
    FILM_MAX_STAGES = 12, /* loading stages of a curve */
    FILM_MAX_PIECES = 64, /* pieces of all its stages: a stage is halved until the series fitted to it converge */
    FILM_MAX_TERMS = 26   /* Chebyshev terms of a fitted function */
};

/* The form of a function of indentation, with x = (xi - origin) per_span. */
enum {
    FILM_POWER = 0,      /* constant + slope x + square x^2 + coefficient x^exponent,  x >= 0, exponent > 0 */
    FILM_SERIES = 1,     /* Chebyshev series in 2x - 1,        0 <= x <= 1 */
    FILM_ROOT_SERIES = 2 /* Chebyshev series in 2 sqrt(x) - 1, 0 <= x <= 1 */
};

typedef struct {
    int32_t form;
    int32_t terms;
    double origin, per_span; /* per_span: 1/length of a series' interval; 1 for a power */
    double constant, slope, square, coefficient, exponent;
    double series[FILM_MAX_TERMS];
} film_function;

/* The unloading rule of a stage, for a contact that turns at depth xi_m: what piece.recovery means.
 * f = f_m ((xi - xi_f)/(xi_m - xi_f))^q, but for FILM_SHIFTED. docs/method.md, section 6. */
enum {
    FILM_RETRACE = 0,  /* back along the loading curve */
    FILM_RADIUS = 1,   /* recovery() is R_d/R: xi_m - xi_f = (f_m/sqrt(R_d/R))^(1/q) */
    FILM_RESIDUAL = 2, /* recovery() is xi_f itself */
    FILM_SECANT = 3,   /* recovery() is f_m/(xi_m - xi_f), but xi_f >= 0 */
    FILM_SHIFTED = 4,  /* recovery() is c: f = f_m - c (xi_m^q - xi^q), down to f = 0 */
    FILM_SIMILAR = 5   /* of a law that pulls: its reversible stages f0, stretched: f = r f0((xi - xi_f)/l), and xi_f follows
                        * from f_m. recovery() is a^2, r = a^3/(f_m + 2 a^1.5), at least 1, l = r^(1/3) */
};

typedef struct {
    double end;             /* indentation up to which this piece of its stage is used */
    double work_at_begin;   /* subtracted from the work since x = 0, so that the work of a stage starts at 0 */
    film_function force;    /* f >= -pull of the curve */
    film_function mean;     /* of a series: its mean since x = 0, so that a small work keeps its digits; of a power: unused */
    film_function recovery; /* of xi_m */
    film_function damping;  /* c over the factor of film_damp, where the stage is damped */
    film_function exponent; /* q of xi_m; of FILM_SIMILAR, unused */
} film_piece;

typedef struct {
    double begin, end; /* indentation; end may be INFINITY in the last stage, whose last piece must then be a power */
    /* within a stage the force has no jump and no extreme, and it is 0 only where the stage begins */
    int32_t first, count; /* its pieces */
    int32_t unloading;    /* FILM_RETRACE ... FILM_SIMILAR */
    int32_t damped;       /* 1: the only stage of a reversible law with damping */
    double reload_exponent; /* r > 0: reloading follows ((xi - xi_f)/(xi_m - xi_f))^r; 0: the unloading branch */
} film_stage;

/* A law. The first stage begins at 0, or below if the law pulls: contact then begins at 0, in the stage that holds it, and
 * ends where the first stage begins. Stages of a law that pulls are reversible, and then FILM_SIMILAR; the pieces of the last
 * reversible one may go on beyond its end, for the branches of the others. docs/method.md, section 6. With a compliance c the contact is in series with a spring: the march's xi is then the sum of the indentation and
 * the spring's deflection c f. Beginnings and ends of stages and pieces are values of that sum, functions take the
 * indentation. docs/method.md, section 8. */
typedef struct {
    int32_t stages, pieces;
    film_stage stage[FILM_MAX_STAGES];
    film_piece piece[FILM_MAX_PIECES];
    double compliance;
    double pull; /* the largest -f of a law that pulls, in its reversible stages, without compliance; 0 for all others */
} film_curve;

/* The curves of a law whose stages depend on one more number, its shape (S_y/E, say), for shapes from low to high. They
 * differ from one curve, `whole`, in where the last stage ends, and in some doubles of its pieces. Each is a Chebyshev
 * series in z = 2 ln(shape/low)/ln(high/low) - 1, in `numbers`: the series of ln(end), `nodes` terms; the places of the
 * `varying` doubles among the doubles of film_curve, ascending; then for every term a row of `varying` coefficients.
 * If high is 0 the curves depend on more numbers: of each contact, `shape` then is a factor of each row, and the end. */
typedef struct {
    double low, high;
    int32_t nodes, varying;
    const double *numbers;
} film_family;
enum { FILM_MAX_NODES = 96 };
enum { FILM_CHORD = 0, FILM_WORK_PRESERVING = 1 };

/* Gradings of the nodes of a leg: positions as a function of s, the fraction of segments. docs/method.md, section 4.
 * Their exponents are in film_setup.c (graded), which also counts them (film_mesh_size); film_batch.c has a queue for each
 * PLATE grading of unloading. */
enum {
    FILM_EQUAL = 0,       /* s                          chords */
    FILM_COSINE = 1,      /* sin^2(pi s/2)              half-space; damped laws on any target, unless they are slow */
    FILM_PLATE_IN = 2,    /* a = 1.2, b = 1.7,  c = 1    in s^a/(s^a + c (1 - s)^b), loading on a compliant target */
    FILM_PLATE_OUT = 3,   /* a = 1.6, b = 1.2,  c = 1    unloading, gamma sqrt(f_m/(xi_m - xi_f)) below 1.1 */
    FILM_PLATE_SLOW = 4,  /* a = 1.6, b = 1.15, c = 0.19 ... below 2.5: twice as many segments */
    FILM_PLATE_CREEP = 5, /* a = 1,   b = 2.5,  c = 0.3  ... above: four times as many */
    FILM_GRADINGS = 6
};

/* The grading of an unloading leg. slowness: gamma sqrt(f_max/depth), depth: of the branch or, along the loading curve,
 * the indentation where the leg begins. */
static inline int32_t film_grading(double slowness) {
    return slowness < 1.1 ? FILM_PLATE_OUT : slowness < 2.5 ? FILM_PLATE_SLOW : FILM_PLATE_CREEP;
}

/* Numbers of segments and positions of nodes of legs, shared by any number of states. ..._nodes[g] points at the nodes of
 * grading g, one more than segments, inside the caller's memory, filled by film_mesh_init. EQUAL and COSINE exist both for
 * loading and for unloading. */
typedef struct {
    int32_t linearisation; /* FILM_CHORD or FILM_WORK_PRESERVING */
    int32_t loading;       /* segments of a loading leg in one stage, 1 .. FILM_MAX_SEGMENTS */
    int32_t unloading;     /* segments of an unloading leg that is not slow; film_unloading gives the others */
    int32_t ways;          /* FILM_ANY_WAY .. FILM_LINES_ALONE; film_mesh_init: FILM_ANY_WAY */
    const double *loading_nodes[FILM_GRADINGS];
    const double *unloading_nodes[FILM_GRADINGS];
} film_mesh;

/* Whether impacts may take shorter ways than their lines: tables, quadrature, power series. FILM_LINES_ALONE: nor is the largest
 * force of a damped contact sought between nodes. */
enum { FILM_ANY_WAY = 0, FILM_LINES = 1, FILM_LINES_ALONE = 2 };

enum { FILM_MAX_SEGMENTS = 4000000 };

/* Segments of an unloading leg: more where contact ends slowly, so that the error stays about the same. */
static inline int32_t film_unloading(const film_mesh *mesh, int32_t grading) {
    return mesh->unloading * (grading == FILM_PLATE_CREEP ? 4 : grading == FILM_PLATE_SLOW ? 2 : 1);
}

/* Where the impactor is. */
enum {
    FILM_APPROACHING = 0, /* no contact yet */
    FILM_LOADING = 1,     /* indentation grows along the law's loading curve */
    FILM_UNLOADING = 2,   /* indentation shrinks */
    FILM_RELOADING = 3,   /* indentation grows along the unloading branch */
    FILM_RESTING = 4,     /* in contact, so close to equilibrium that the law is straight */
    FILM_SEPARATED = 5    /* contact has ended */
};

enum {
    FILM_NO_EVENT = 0,
    FILM_CONTACT_BEGINS = 1,
    FILM_STAGE_CHANGES = 2,
    FILM_MAXIMUM_INDENTATION = 3, /* indentation stops growing */
    FILM_IMPACTOR_STOPS = 4,      /* nu falls to stop_velocity */
    FILM_CONTACT_ENDS = 5,
    FILM_RELOADING_BEGINS = 6     /* indentation stops shrinking: the load pushes the impactor back in */
};

enum {
    FILM_OK = 0,             /* the time asked for was reached */
    FILM_ENDLESS = 2,        /* no further event: at rest, creeping out, or flying away */
    FILM_EVENT = 1,          /* stopped at an event, state.event says which */
    FILM_BAD_NUMBER = -1,    /* NaN, a negative step, a negative gamma ... */
    FILM_BAD_CURVE = -2,     /* stages that do not follow each other, no stage, an unknown form */
    FILM_BAD_MESH = -3,      /* segment counts out of range */
    FILM_BEYOND_LAW = -4,    /* the indentation passes the end of the law's last stage */
    FILM_TOO_MANY = -5,      /* more than FILM_MAX_STEP_LINES lines in one call, or FILM_MAX_EVENTS of one contact */
    FILM_BAD_UNLOADING = -6, /* the unloading rule gives a branch shorter than 1e-12 of the depth */
    FILM_FULL = -7,          /* the caller's array is too short */
    FILM_TOO_STIFF = -8,     /* the force at first touch exceeds Z nu: the target moves away at once */
    FILM_TURNS_AGAIN = -9,   /* film_relax.h: the indentation grows again before contact ends */
    FILM_REMEMBERS = -10     /* film_relax.h: a contact begins before the body has forgotten the one before */
};

enum { FILM_MAX_STEP_LINES = 10000000, FILM_MAX_EVENTS = 200000 /* of one contact in film_impact */ };

/* One straight piece of the force, on which the motion is closed-form. docs/method.md, section 3. */
typedef struct {
    double time;          /* when it begins */
    double xi, nu, shift; /* indentation, impactor velocity and target displacement there */
    double phi, kappa;    /* the line's force there, and its slope */
    double work, spent;   /* work of the true law there: since its stage began, and since contact began */
    double load, gamma;   /* p and gamma */
    /* if branch is FILM_BRANCH: f_shift + f_max ((xi - xi_origin) per_recovery)^exponent, 0 at xi_free; work_free: the work
     * of that expression at xi_free. If it is FILM_STRETCHED - k: f_max times the force of stage k at
     * (xi - xi_origin) per_recovery; exponent is 1/per_recovery */
    double xi_free, per_recovery, f_max, exponent, xi_origin, f_shift, work_free;
    double damping, damper; /* c, constant on the line; the factor of the law's c */
    int32_t branch;         /* loading stage, FILM_BRANCH, FILM_FREE, or FILM_STRETCHED - k for stage k */
    int32_t phase;
} film_line;

enum { FILM_BRANCH = -1, FILM_FREE = -2, FILM_STRETCHED = -3 };

/* A motion at one time. Lengths, velocities, forces and times in the units above. */
typedef struct {
    /* where the motion is: callers may read these nine as one block, in this order */
    double time, time_low; /* time and the part that rounding drops */
    double xi, nu;         /* indentation (negative: gap), impactor velocity relative to the support */
    double shift;          /* target displacement relative to the support */
    double force, work;    /* F; work of f since its stage or branch began */
    double spent;          /* work done on the indentation since the first contact */
    double force_peak;     /* largest F of this contact at nodes and ends of stages; with damping, anywhere */
    /* what acts on it */
    double gamma, load, stop_velocity; /* gamma; p; velocity at which FILM_IMPACTOR_STOPS is reported */
    double damper;                     /* factor of the law's c */
    double elastic;                    /* f at xi: F without damping */
    /* what the spot remembers: the deepest point, its f, and the branch that leads back from it */
    double xi_max, f_max;
    double xi_free, recovery; /* where the branch ends: a dent; length of the branch, in indentation */
    double exponent, xi_origin, f_scale; /* exponent, xi_origin and f_max of film_line on that branch */
    /* reloading loop: where reloading began, where it turned on the way in, and f there */
    double xi_in, f_in, xi_out, f_out;
    /* the leg: one way in one direction along one stage or branch, cut into lines at its nodes */
    double leg_from, leg_to;     /* indentations */
    int32_t leg_node, leg_nodes; /* nodes passed, and in all */
    int32_t leg_grading, leg_ends;
    /* the line: time since it began, with its rounding, and when it ends; the motion there */
    double tau, tau_low, tau_end;
    double xi_end, nu_end, force_end, work_end; /* force_end: f */
    film_line line;
    int32_t line_ends; /* how line and leg end: ENDS_... in film_march.h */
    int32_t has_line, has_leg;
    int32_t from_turn;         /* 1: the leg begins at rest, at a turn */
    int32_t direction;         /* +1 inwards, -1 outwards */
    int32_t branch, stage_max; /* as in film_line; the stage of xi_max, -1 without one */
    int32_t moving_in;         /* 1: nu is above stop_velocity */
    int32_t loop;              /* which branch FILM_BRANCH is: LOOP_... in film_march.h */
    int32_t rising;            /* for film_switch: a damped contact's force grows on the way in */
    int32_t jumped;            /* 1: film_input has changed nu, and maybe the direction */
    /* reports */
    int32_t phase, event, contacts, lines; /* contacts and lines so far */
} film_state;

/* How one contact starts: at first touch, with velocity nu > 0 of the impactor relative to the support, or with nu = 0
 * and a load > 0. */
typedef struct {
    double nu, gamma, load, stop_velocity;
    double time_limit; /* when to stop following a contact that the load holds shut; INFINITY allowed */
    double damping;    /* the factor of film_damp */
} film_start;

/* What one contact did. Times count from first touch; NaN: it did not happen. */
typedef struct {
    double maximum_force, maximum_indentation, time_of_maximum_indentation;
    double time_impactor_stops;
    double contact_duration, permanent_indentation, final_velocity; /* damped or adhesive law: where contact ended, not a dent */
    double shift; /* of the target, at the end */
    double work;  /* done on the indentation, less what it gave back */
    int32_t stage, lines;
} film_summary;

/* 0, or FILM_BAD_CURVE / FILM_BAD_NUMBER. */
FILM_API int film_check_curve(const film_curve *curve);

/* The curve of a shape, low <= *shape <= high, or of as many numbers as the family has of each contact. curve: a copy of `whole`,
 * or the curve of another shape. The pieces beyond the end of its last stage are left out. 0, or FILM_BAD_CURVE: the family's
 * numbers or the shape are out of range. */
FILM_API int film_shape(const film_family *family, const film_curve *whole, const double *shape, film_curve *curve);

/* Puts a curve in series with a spring of this compliance > 0. 0, or FILM_BAD_CURVE: the curve has one, is damped or pulls, or
 * its force falls so fast that the contact would snap through. */
FILM_API int film_spring(film_curve *curve, double compliance);

/* Number of doubles that film_mesh_init needs, and the mesh itself. memory must outlive the mesh. */
FILM_API size_t film_mesh_size(int32_t loading, int32_t unloading);
FILM_API int film_mesh_init(film_mesh *mesh, int32_t linearisation, int32_t loading, int32_t unloading, double *memory);

/* A state at indentation xi (<= 0: a gap) with impactor velocity nu, on a spot without a dent.
 * gamma >= 0, finite; stop_velocity: the velocity at which FILM_IMPACTOR_STOPS is reported (0 for a support at rest). */
FILM_API int film_init(const film_curve *curve, film_state *state, double xi, double nu, double gamma, double load,
                       double stop_velocity);

/* The law's c is `factor` >= 0 times the curve's from here on; 0, as after film_init, leaves damping out. */
FILM_API int film_damp(film_state *state, double factor);

/* The state at first touch, with the damping of `start`. */
FILM_API int film_begin(const film_curve *curve, const film_start *start, film_state *state);

/* A new load or a new support: nu is relative to the support, so a support that gains velocity u costs nu - u. */
FILM_API int film_input(film_state *state, double load, double nu_change, double stop_velocity);

/* Forward by dt >= 0 (INFINITY allowed) or to the next event, whichever is first: FILM_OK, FILM_EVENT (state->event says
 * which), FILM_ENDLESS, or a failure. The state is at state->time either way. */
FILM_API int film_step(const film_curve *curve, const film_mesh *mesh, film_state *state, double dt);

/* From state to the end of the next contact, or until time_limit: every line, and the state at every event; after
 * the end of contact one more line, the flight that follows. lines or events NULL: they are only counted. FILM_OK at the limit, or at first touch without velocity where the
 * load presses it back in, FILM_EVENT at the end of contact, FILM_ENDLESS, or a failure. */
FILM_API int film_record(const film_curve *curve, const film_mesh *mesh, film_state *state, double time_limit,
                         film_line *lines, int32_t line_room, int32_t *line_count, film_state *events,
                         int32_t event_room, int32_t *event_count, film_summary *summary);

/* The largest -F of the current branch. */
static inline double film_pull(const film_curve *curve, const film_state *state) {
    return state->branch <= FILM_STRETCHED ? curve->pull * state->f_scale : curve->pull;
}

/* values: indentation, its rate, force, nu, displacement of the struck point - of the true law. In the state, and on a
 * line, tau after its beginning. They differ from the state's own xi and shift where the curve has a compliance. */
FILM_API void film_motion(const film_curve *curve, const film_state *state, double values[5]);
FILM_API void film_evaluate(const film_curve *curve, const film_line *line, double tau, double values[5]);

/* Samples at count times, ascending, from lines; stages[i] the line's branch, or FILM_BRANCH of a stretched
 * stage; phases[i] its phase. */
FILM_API void film_sample(const film_curve *curve, const film_line *lines, int32_t line_count, const double *times,
                          int64_t count, double *values, int8_t *stages, int8_t *phases);

/* The same contact for another integrator of the true law, which owns xi, nu and shift and puts them into the state before
 * each call. The state keeps the branch and what the spot remembers; lines are not used. docs/method.md, section 11. */
typedef struct {
    double force, by_xi, by_nu; /* F, and its partial derivatives: by xi at one nu, and by nu */
} film_contact;

/* F at xi and nu on the current branch: beyond its end the same curve goes on, and a damped contact's F below 0. */
FILM_API film_contact film_force(const film_curve *curve, const film_state *state, double xi, double nu);

/* All > 0 while the contact goes on as it is; film_switch is due when one falls to 0 or below. None is 0 right after
 * film_switch: each is late by 1e-10 of `speed`, or of the way at that speed in unit time.
 * indicators: of the direction, of the run's far end, of its near end, of the impactor's stop, of a peak. The far end of a
 * damped run outwards is where F falls to 0. A damped force may peak within a run: film_switch only keeps the peak. */
enum { FILM_INDICATORS = 5 };
FILM_API void film_indicators(const film_curve *curve, const film_state *state, double speed,
                              double indicators[FILM_INDICATORS]);

/* Handles one event that is due: FILM_EVENT, state->event says which, and more may be due; FILM_OK: none is; or a failure.
 * If the run's end was passed, state->xi becomes that end: put xi in again before the next call. */
FILM_API int film_switch(const film_curve *curve, film_state *state);

/* The true law: force, and work since the stage began, of loading stage `stage` at xi. */
FILM_API void film_law(const film_curve *curve, int32_t stage, double xi, double *force, double *work);

/* One contact: as film_record ends: FILM_EVENT, FILM_OK, FILM_ENDLESS, or a failure. Without load and limit, or under
 * a damped law, it is film_batch's row, faster than film_marched; on a fixed target times differ by less than their errors. */
FILM_API int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start,
                         film_summary *summary);

/* The same by the lines that film_record records. */
FILM_API int film_marched(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary);

/* count contacts, side by side where possible, on less than 400 kB of stack; status[i] is what film_impact returns for
 * start[i]. The result of an impact does not depend on the others, nor on the instructions, at most film_instructions(), which
 * may take 20 microseconds to ask the processor. docs/method.md, section 10. */
enum { FILM_PLAIN = 0, FILM_AVX2 = 1, FILM_AVX512 = 2 };
FILM_API int film_instructions(void);
FILM_API void film_batch(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                         film_summary *summary, int32_t *status);

/* The curves of many contacts, which differ in the shapes of a family, of whose whole law `curve` then is; in `varying` doubles,
 * places[k] of the k-th among those of film_curve, its value for contact i in values[i varying + k]; and in springs of
 * compliance[i] > 0 in series: NULL or 0 where they do not. */
typedef struct {
    const film_curve *curve;
    const film_family *family;
    const double *shape, *compliance, *values;
    const int32_t *places;
    int32_t varying;
} film_curves;

/* film_batch for contacts on curves of their own, on less than 500 kB of stack, side by side where they do not vary. status[i]
 * is FILM_BAD_CURVE where a contact would snap through its spring. */
FILM_API void film_batch_of(int instructions, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                            film_summary *summary, int32_t *status);

/* dents[i]: what a contact leaves that turned at depth[i] and ended at end[i], of a law that pulls: xi_f of its branch, since
 * the contact ends below xi_f. varying, places, values: as in film_curves. */
FILM_API void film_dents(const film_curve *curve, int64_t count, int32_t varying, const int32_t *places, const double *values,
                         const double *depth, const double *end, double *dents);

/* sizeof film_curve, film_mesh, film_line, film_state, film_summary, for callers that mirror them. */
FILM_API void film_sizes(int64_t sizes[5]);

#endif
