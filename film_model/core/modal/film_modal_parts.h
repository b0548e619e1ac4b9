/* What the files of the contact on modes share. Internal.
 *
 *     film_modal_table.c     the modes' responses to powers of time; tables of a step size
 *     film_modal_loops.c     the loops over all modes, for several instruction sets
 *     film_modal_force.c     the force of a step, by collocation at its nodes
 *     film_modal_stretch.c   membrane forces
 *     film_modal_root.c      where a polynomial first falls below 0
 *     film_modal_contact.c   steps in contact: their size, the events in them
 *     film_modal_flight.c    flights between contacts
 *     film_modal.c           states, steps, impacts */
#ifndef FILM_MODAL_PARTS_H
#define FILM_MODAL_PARTS_H

#include "modal/film_modal.h"
#include "march/film_march.h"
#include "lanes/film_wide.h"

enum { NODES = FILM_NODES, BENDS = FILM_BENDS, DEGREE = 7, RESPONSES = 6 };

/* Gauss nodes on 0 .. 1, and LAGRANGE[j][k]: coefficient of theta^k in the cubic that is 1 at node j, 0 at the others. */
static const double NODE_AT[NODES] = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263};
static const double LAGRANGE[NODES][NODES] = {
    {1.5267881254572668, -8.546023607872199, 14.325858354171888, -7.420540068038946},
    {-0.8136324494869273, 13.807166925689577, -31.38822236344606, 18.79544940755506},
    {0.4007615203116504, -7.417070421462639, 24.998125859219122, -18.79544940755506},
    {-0.11391719628198993, 2.155927103645261, -7.93576184994495, 7.420540068038946},
};

/* The third Legendre coefficient of the cubic that is 1 at node j. */
static const double LEGENDRE_3[NODES] = {-0.37102700340194733, 0.939772470377753, -0.939772470377753, 0.37102700340194733};

static const double FACTORIAL[NODES] = {1.0, 1.0, 2.0, 6.0};

/* Below this phase (or damping) over t the responses come from their Taylor series, whose terms then only decrease, and from
 * the recursion downwards; above it from cosine and sine, and the recursion upwards. Both are accurate at the border. */
static const double SERIES_PHASE = 6.0;

/* One table: how a step of one size moves every mode, per unit of share k for forces. */
typedef struct {
    double *node_cos, *node_sin;  /* [NODES][n]: of w and of w' at the beginning, on w at the nodes */
    double *end_cos, *end_sin;    /* [n]: on w at the end */
    double *rate_cos, *rate_sin;  /* [n]: on w' at the end */
    double *push;                 /* [RESPONSES - 1][n]: share x responses y_1 .. y_5 at the end */
    double *nodes, *node_rates;   /* [NODES][NODES]: sums over the modes of the responses at node i to the force at node j */
} film_table;

/* film_modal_loops.c, for one instruction set. free_sums: sums of w_n at the nodes without a force and, unless rate is NULL, of w_n'. move:
 * w_n and w_n' at the end of the step under the force sum p_k theta^k/k!, from `begin` to `end`; their sums. fill: a table. */
typedef struct {
    void (*free_sums)(const film_structure *structure, const film_table *table, const double *begin, double moved[NODES], double *rate);
    void (*move)(const film_structure *structure, const film_table *table, const double *begin, double *end, const double p[NODES],
                 double sums[2]);
    void (*fill)(const film_structure *structure, const film_table *table, double h);
} film_loops;
extern const film_loops film_loops_plain;
#if defined(FILM_WIDE)
extern const film_loops film_loops_avx2, film_loops_avx512;
#endif
const film_loops *film_loops_of(const film_structure *structure);

/* Where in waves[] the modes at the beginning and at the end of the step are. */
static inline size_t begins_at(const film_structure *structure, const film_modal *s) {
    return s->half ? 2 * (size_t)structure->modes : 0;
}
static inline size_t ends_at(const film_structure *structure, const film_modal *s) {
    return s->half ? 0 : 2 * (size_t)structure->modes;
}

/* film_modal_table.c. responses[k + 2]: of w at time t to the force theta^k/k!, k = 0 .. 3; at 0 and 1 (k = -2, -1) the
 * derivatives w' and w of the response to an impulse. */
void film_responses(double square, double drag, double t, double responses[RESPONSES]);
void film_force_powers(const film_modal *s, double powers[NODES]); /* of the cubic force, of the place in the step, 0 .. 1 */
void film_force_cubic(const film_modal *s, double p[NODES]);
film_table film_table_at(const film_structure *structure, int32_t level);
film_table film_level_table(film_structure *structure, int32_t level);
void film_moved_mode(const film_structure *structure, const film_modal *s, const double *waves, int32_t n, double t, double *w,
                     double *u);

/* film_modal_root.c: the first place in (from, 1] where the polynomial with these Bernstein coefficients falls below 0, 2 if
 * it does not. A coefficient at `from` that is not above 0 counts as 0 if the polynomial rises there. */
double film_first_below(const double *bernstein, int degree, double from);
double film_bernstein(const double *bernstein, int degree, double at);

/* film_modal_force.c */
typedef struct {
    double force, by_xi, by_nu;
} film_at;
film_at film_law_on(const film_curve *curve, const film_line *line, double xi, double nu);
double film_indentation(const film_curve *curve, const film_line *line, double rest, double depth);
/* What the forces of a step must satisfy: depth_i = free_i - sum_j moved_ij F_j, F_i = law(depth_i - rest F_i, rate_i). */
typedef struct {
    double depth[NODES], rate[NODES], moved[NODES][NODES], gained[NODES][NODES];
} film_equations;
int film_solve_forces(const film_curve *curve, film_modal *s, const film_equations *e);
int film_try_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves,
                  const film_table *table, double h, film_equations *e, double *error);
int film_take_step(const film_structure *structure, film_modal *s, double *waves, const film_table *table, const film_equations *e);
void film_depth_polynomial(const film_modal *s, double bernstein[DEGREE + 1]);
void film_ball_at(const film_modal *s, double tau, double *x, double *v);
double film_force_at(const film_modal *s, double theta);
/* Whether a damped law pushes at a place in the step whose depth is given as a polynomial, a little inside the contact even where it ends;
 * in flight, whether it does so inside the dent. Then where between two places that changes. */
int film_pushes(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], double theta);
double film_push_changes(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], double low, double high);

/* film_modal_stretch.c: the forces of a step, contact's and membrane's, which depend on each other: as film_try_step, whose error
 * grows by that of the membrane forces. Then what they do to the modes at the end of the step, and t after its beginning. */
int film_stretch_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves,
                      const film_table *table, film_equations *e, double *error);
void film_stretch_end(const film_structure *structure, film_modal *s, double *waves, const film_table *table);
/* The accelerations by the membrane forces now; returns their energy, in the unit of film_shared_energy: that of the forces and
 * of the modes that have them, at the beginning of the step. */
double film_stretch_now(const film_structure *structure, const film_modal *s, const double *waves, double accelerations[]);
double film_shared_energy(const film_structure *structure, const film_modal *s, const double *waves);
void film_stretched_mode(const film_structure *structure, const double *waves, int32_t n, const double y[RESPONSES], double *w,
                         double *u);

/* film_modal_contact.c */
int film_plan_contact(film_structure *structure, const film_curve *curve, film_modal *s, double *waves);
void film_next_event(const film_structure *structure, const film_curve *curve, film_modal *s, const double *waves, double from);
int film_soft_event(const film_structure *structure, const film_curve *curve, film_modal *s, const double *waves);

/* film_modal.c */
enum { EVENT_WORK = 8 }; /* an event takes as long as this many steps: to find it, and to record it */

/* Steps after which an impact, or the caller's step, is given up. */
static inline int32_t film_most_steps(const film_structure *structure) {
    return FILM_MOST_WORK / (structure->modes + FILM_MODES_OF_A_STEP);
}

/* The step ends here, tau after it began, under the same force as planned. */
void film_stop_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves);

int film_plan_step(film_structure *structure, const film_curve *curve, film_modal *s, double *waves);
int film_advance(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double *dt);

/* film_modal_flight.c */
/* Whether an impactor in a planned flight leaves the modes' reach, and only the load may bring it back. */
int film_leaves(const film_structure *structure, const film_modal *s, const double *waves);

int film_plan_flight(film_structure *structure, const film_curve *curve, film_modal *s, double *waves);

/* The modes at the end of a jump, which are not needed before. */
void film_end_jump(const film_structure *structure, film_modal *s, double *waves);

/* Whether a jump goes on under a new load and velocity, with the modes as they were; it then does. */
int film_turn_jump(const film_structure *structure, film_modal *s, double load, double v_change);

#endif
