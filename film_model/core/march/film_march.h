/* What the files of the march share. Internal.
 *
 * A contact is a sequence of runs: a run goes in one direction along one loading stage or unloading branch. On a run the
 * march plans a leg, from where it is to where the run ends or the motion turns, cuts the leg into lines at the mesh's
 * nodes, and follows each line in closed form (film_line.h):
 *
 *     film_setup.c       meshes, states before the first touch
 *     film_energy.c      where energy turns the impactor back on a fixed target
 *     film_damping.c     the true force with damping, what damping adds to a line
 *     film_branch.c      the branch after a turn, reloading loops
 *     film_follow.c      the motion on lines
 *     film_draw.c        one line
 *     film_turn.c        a line that ends at the turn
 *     film_next.c        the next line of a leg
 *     film_release.c     where damping ends a contact, the largest force with it
 *     film_aim.c         where a leg ends, where the impactor stops
 *     film_march.c       plans legs, decides what comes after each line
 *     film_integrator.c  the same contact for another integrator of the true law
 *     film_marched.c     one contact from its start to its end
 *
 * Each calls only those above it in this list, and the files of curve/. */
#ifndef FILM_MARCH_H
#define FILM_MARCH_H

#include "march/film_line.h"

/* How a line, or a leg, ends: at a node of the leg; at the end of the stage or branch; at a turn; never (it comes to rest
 * after an infinite time); and between two nodes: because the line was too long, because the impactor stops, or because the
 * force of a damped contact falls to 0. */
enum { ENDS_NODE, ENDS_EDGE, ENDS_TURN, ENDS_NEVER, ENDS_PART, ENDS_STOP, ENDS_RELEASE };

/* Which branch FILM_BRANCH is, for a law with a reload exponent. LOOP_NONE: from xi_max out. LOOP_RELOAD: from xi_in back in
 * to xi_max. LOOP_INNER: after a turn at xi_out on that way in, out again to xi_in, and from there on as LOOP_NONE.
 * Reloading lies above unloading, and a turn on the innermost branch stays on it, so no sequence of turns gains energy. */
enum { LOOP_NONE, LOOP_RELOAD, LOOP_INNER };

enum { NO_TURN, TURN, TURN_BETWEEN };      /* film_find_turn */
enum { GRADING_COARSE = -1 };              /* nodes of a trial leg: 3 s^2 - 2 s^3, without a table */
enum { TURN_ITERATIONS = 60, HALVINGS = 60 };

/* Where two stages, or a branch and the loading curve, meet, forces that differ by less than this fraction of the largest
 * number they are computed from differ by rounding only. Without it a motion may cross back and forth without end.
 * core_check.c, check_kink. */
static const double KINK_ROUNDING = 1e-12;

/* Indentations that differ by less than this fraction are adjacent floats, or nearly: a leg between them comes to rest.
 * core_check.c, check_rest. */
static const double ADJACENT = 1e-15;

/* A speed y = nu - gamma f below this fraction of nu is rounding, so the motion is at rest.
 * Without it core_check.c does not end. */
static const double REST_SPEED = 1e-13;

/* A line of a damped law that begins within this fraction of its length of first touch begins there, where c may be a root; a
 * velocity below this fraction is rounding. core_check.c, one_schedule with DAMPED: without it a step does not end. */
static const double INSIDE_DENT = 1e-9;

/* A contact creeps out and never ends if its indentation has fallen to this fraction of its depth, or if its next line takes
 * longer than 1/CREPT. Without it core_check.c, check_crept does not end. */
static const double CREPT = 1e-30;

/* A leg shorter than this fraction of the contact's depth is straight: curvature changes the force over it by 1e-12.
 * core_check.c, check_found: "a load at rest". */
static const double REST_LENGTH = 1e-6;

/* The length of a leg to the turn below this fraction of the depth is mostly rounding: its time is then v/force, and lanes
 * leave it to film_marched. Needed by core_check.c, check_short_leg, and
 * test_a_turn_just_inside_a_stage_agrees_with_the_march: times are off by up to 4e-9 without it. */
static const double SHORT_LEG = 1e-9;

/* Abscissas and weights of Gauss's rule of five points on 0 .. 1. */
enum { GAUSS = 5 };
static const double GAUSS_AT[GAUSS] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155, 0.953089922969332};
static const double GAUSS_WEIGHT[GAUSS] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                           0.23931433524968324, 0.11846344252809454};

/* The motion from the current point on a line whose force there is phi, with slope kappa. */
static inline motion motion_on(const film_state *s, double phi, double kappa) {
    return motion_from(s->direction, s->nu, s->gamma, s->load, phi, kappa, s->line.damping);
}

static inline int is_damped(const film_curve *curve, const film_state *s) {
    return s->damper > 0.0 && s->branch >= 0 && curve->stage[s->branch].damped;
}

/* 1/h, by which a difference of forces becomes a slope; 0 if xi + h rounds to xi: that difference is rounding, too. */
static inline double per_length(const film_state *s, double h) { return s->xi + h != s->xi ? 1.0 / h : 0.0; }

/* The velocity v on a fixed target after some work. */
static inline double speed_after(double v, double work) {
    double square = v * v - 2.0 * work;
    return square > 0.0 ? sqrt(square) : 0.0;
}

/* Whether a contact that ends stays closed: the kinetic energy at first touch is rounding of the work of the load, which presses
 * the impactor back in. */
static inline int film_grazes(double load, double depth, double approach) {
    return load > 0.0 && approach * approach <= 1e-12 * load * depth;
}

/* The end of the current stage or branch, inwards (direction 1) or outwards (-1). */
static inline double run_edge(const film_curve *curve, const film_state *s, int direction) {
    if (s->branch == FILM_BRANCH && s->loop != LOOP_NONE)
        return direction < 0 ? s->xi_in : s->loop == LOOP_INNER ? s->xi_out : s->xi_max;
    if (s->branch == FILM_BRANCH) return direction > 0 ? s->xi_max : s->xi_free;
    if (s->branch <= FILM_STRETCHED) return film_stretched_edge(curve, s, direction);
    return direction > 0 ? curve->stage[s->branch].end : curve->stage[s->branch].begin;
}

/* Where the current run ends if the motion does not turn before. */
static inline double run_limit(const film_curve *curve, const film_state *s) { return run_edge(curve, s, s->direction); }

/* The phase of a run along the current branch in the current direction. */
static inline int32_t run_phase(const film_state *s) {
    return s->direction < 0 ? FILM_UNLOADING : s->branch < 0 ? FILM_RELOADING : FILM_LOADING;
}

/* Whether nothing pushes or pulls the impactor back in: its way out then has no turn, and a line that shows one is wrong. */
static inline int leaves_freely(const film_curve *curve, const film_state *s) {
    return s->direction < 0 && s->load <= 0.0 && curve->pull == 0.0;
}

/* F at the current point. */
static inline double contact_force(const film_curve *curve, const film_state *s) {
    if (s->branch == FILM_FREE) return 0.0;
    double force = total_force(&s->line, damping_at(curve, &s->line, s->xi), s->elastic, s->nu);
    return force > 0.0 || curve->pull > 0.0 ? force : 0.0;
}

/* The files from below; each calls only those before it. film_setup.c's functions are in film_core.h. */

/* Where a fixed target turns the impactor back on its run from xi, where the work is `work`, towards `limit`, under
 * `load`: FILM_OK with *to = limit if there is energy to reach it, FILM_EVENT with the turning point, FILM_BEYOND_LAW. */
int film_turning_point(const film_curve *curve, const film_line *run, double xi, double work, double nu, double load,
                       double limit, series_place *near, double *to);

/* film_damping.c */
void film_damp_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int at_rest,
                    int plain);
void film_add_damping(const film_curve *curve, const film_mesh *mesh, film_state *s, double h, double y0, double y1, int plain);
double film_speed(const film_curve *curve, const film_state *s, double xi, double force, double nu);
double film_dissipated(const film_line *line, double tau, double xi, double nu, double work);
double film_force_rate(const film_curve *curve, const film_state *s, double xi, double nu);
double film_release_margin(const film_curve *curve, const film_state *s);
double film_touch_time(const film_curve *curve, const film_state *s);

/* film_branch.c */
int film_remember_turn(const film_curve *curve, film_state *s);
double film_force_rounding(const film_curve *curve, const film_state *s, int32_t stage);
int32_t film_branch_at_touch(const film_curve *curve, const film_state *s);
double film_reload_exponent(const film_curve *curve, const film_state *s);
void film_open_run(const film_curve *curve, film_state *s);
void film_change_loop(const film_curve *curve, film_state *s, int32_t loop);
void film_choose_loop(const film_curve *curve, film_state *s);

/* film_follow.c */
void film_open_line(film_state *s);
void film_follow(film_state *s);
void film_move_along(const film_curve *curve, film_state *s, double tau);

/* film_draw.c */
double film_mean_force(const film_curve *curve, const film_state *s, double h);
void film_make_turn_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int plain);
motion film_make_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int plain);
void film_set_line_end(film_state *s, double length, double y);
void film_end_here(film_state *s, int ends);

/* film_turn.c */
int film_find_turn(const film_curve *curve, const film_mesh *mesh, film_state *s, double *length, double limit,
                   double tolerance, int plain);

/* film_next.c */
int film_next_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double turn_tolerance);
void film_make_flight(const film_curve *curve, film_state *s);

/* film_release.c */
void film_end_at_release(const film_curve *curve, const film_mesh *mesh, film_state *s);
void film_raise_peak(const film_curve *curve, const film_mesh *mesh, const film_state *walked, double *peak);

/* film_aim.c */
int film_aim_leg(const film_curve *curve, const film_mesh *mesh, film_state *s);
int film_make_rest_line(const film_curve *curve, film_state *s);
void film_end_at_stop(const film_curve *curve, const film_mesh *mesh, film_state *s);
void film_end_at_dip(const film_curve *curve, const film_mesh *mesh, film_state *s);

/* film_march.c */
int film_stop(film_state *s);
int film_finish(const film_curve *curve, const film_mesh *mesh, film_state *s);
void film_clear_summary(film_summary *summary);

/* What a turn, or a stop of the impactor, adds to the summary. */
void film_note_turn(int32_t event, double time, double indentation, int32_t stage, film_summary *summary);

/* film_integrator.c */
int film_end_run(const film_curve *curve, film_state *s, int ends);

#endif
