/* Where a leg ends: at the turn that energy gives on a fixed target, at the turn of trial legs on others. Nodes are graded
 * towards that point, and the last line must meet the law's force there. Where the impactor stops. docs/method.md, section 5. */
#include "march/film_march.h"

/* A trial leg only places the nodes of the next, so its turn is sought to this fraction of its last line. Affects cost only:
 * another value moves the nodes, and results by less than the lines' error. */
static const double TRIAL_TOLERANCE = 1e-2;

enum { BALANCE_HALVINGS = 100 };

static int aim_by_energy(const film_curve *curve, film_state *s) {
    series_place near = {0.0, 0.0, 0.0};
    int status = film_turning_point(curve, &s->line, s->xi, s->work, s->nu, s->load, run_limit(curve, s), &near, &s->leg_to);
    s->leg_ends = status == FILM_EVENT ? ENDS_TURN : ENDS_EDGE;
    return status < 0 ? status : FILM_OK;
}

/* ---------------------------------------------------------------- targets that move, damping: trial legs */

/* Where the true law balances the load, from the current point towards the end of the leg or beyond, by halving;
 * `otherwise` if it never does. */
static double balance(const film_curve *curve, const film_state *s, double otherwise) {
    double low = s->xi, high = s->leg_to, limit = run_limit(curve, s), force, work;
    double side = s->elastic - s->load;
    if (side == 0.0) return high; /* no force to balance: damping alone slows the motion, and stops it anywhere */
    for (int k = 0; k < DOUBLINGS && high != limit; k++) {
        law_at(curve, &s->line, high, &force, &work);
        if (!(side > 0.0 ? force > s->load : force < s->load)) break;
        high = limit < INFINITY ? limit : s->xi + 2.0 * (high - s->xi);
    }
    if (!(high < INFINITY)) return otherwise;
    for (int k = 0; k < BALANCE_HALVINGS; k++) {
        double middle = 0.5 * (low + high);
        law_at(curve, &s->line, middle, &force, &work);
        if (side > 0.0 ? force > s->load : force < s->load) low = middle; else high = middle;
    }
    return high;
}

/* Follows a leg of `nodes` lines from s to its end, without what happens there. */
static int follow_trial(const film_curve *curve, const film_mesh *mesh, const film_state *s, int32_t nodes, film_state *trial) {
    *trial = *s;
    trial->leg_nodes = nodes;
    trial->leg_grading = GRADING_COARSE;
    if (nodes == 1) trial->leg_ends = s->from_turn ? ENDS_EDGE : ENDS_TURN;
    for (int k = 0; k < 4 * nodes + 4; k++) {
        int status = film_next_line(curve, mesh, trial, TRIAL_TOLERANCE);
        if (status < 0) return status;
        if (trial->line_ends != ENDS_NODE || trial->leg_node >= trial->leg_nodes - 1) break;
        film_follow(trial);
    }
    return FILM_OK;
}

/* Trial legs of 1, 4, 16 ... segments, each aimed by the one before. docs/method.md, section 5. */
static int aim_by_trial(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    double limit = s->leg_to; /* of the run */
    if (!(limit < INFINITY)) { /* a fixed target stops the impactor later than one that moves: begin with its turn */
        film_state fixed = *s;
        int status = aim_by_energy(curve, &fixed);
        if (status < 0) return status;
        s->leg_to = fixed.leg_to;
        s->leg_ends = ENDS_TURN;
    }
    for (int32_t nodes = 1; nodes <= 4 || 3 * nodes <= s->leg_nodes; nodes *= 4) {
        film_state trial;
        int status = follow_trial(curve, mesh, s, nodes, &trial);
        if (status < 0) return status;
        s->leg_ends = trial.line_ends == ENDS_NODE ? ENDS_TURN : trial.line_ends;
        s->leg_to = s->leg_ends == ENDS_EDGE ? limit : s->leg_ends == ENDS_NEVER ? balance(curve, s, trial.xi_end) : trial.xi_end;
        if (s->leg_ends == ENDS_EDGE && limit < INFINITY) break;
        if (s->leg_ends == ENDS_EDGE) { /* a run without an end; its few lines went too far */
            s->leg_ends = ENDS_TURN;
            s->leg_to = trial.xi_end;
        }
    }
    return FILM_OK;
}

/* Sets leg_to and leg_ends of the run that begins here. On the way out without a load nothing turns the motion before the
 * contact ends. docs/method.md, section 5. */
int film_aim_leg(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    s->leg_to = run_limit(curve, s);
    s->leg_ends = ENDS_EDGE;
    if (leaves_freely(curve, s)) return FILM_OK;
    return s->gamma == 0.0 && !is_damped(curve, s) ? aim_by_energy(curve, s) : aim_by_trial(curve, mesh, s);
}

/* ---------------------------------------------------------------- at rest */

/* The force of the law at xi, near the current point; on the loading curve, of the stage that holds xi. */
static double force_nearby(const film_curve *curve, const film_state *s, double xi) {
    film_line line = s->line;
    double force, work;
    line.branch = film_branch_nearby(curve, &line, xi);
    law_at(curve, &line, xi, &force, &work);
    return force;
}

/* Whether the speed of a contact is only the rounding error of its force: under a law that pulls, on a moving target. */
static int is_still(const film_curve *curve, const film_state *s) {
    double rounded = film_force_rounding(curve, s, s->branch >= 0 ? s->branch : s->stage_max);
    return curve->pull > 0.0 && fabs(s->nu - s->gamma * s->elastic) <= s->gamma * rounded;
}

/* If the leg is so short that the law is straight over the whole swing around the balance, makes one line for all time to
 * come, in both directions, and returns 1. Where two stages of different slope meet, the swing leaves the line; there only a
 * leg between adjacent floats comes to rest. A law that pulls is in balance where two stages meet: a leg that ends there
 * without a speed goes back and forth by rounding. docs/method.md, section 9. */
int film_make_rest_line(const film_curve *curve, film_state *s) {
    double depth = fmin(s->branch < 0 ? s->recovery : s->xi, fabs(s->xi - s->xi_free));
    double least = ADJACENT * fabs(s->xi), reach = fmax(REST_LENGTH * depth, least), length = fabs(s->leg_to - s->leg_from);
    int at_edge = s->leg_ends == ENDS_EDGE;
    if (length >= (at_edge ? least : reach) || (at_edge && !is_still(curve, s))) return 0;
    double f_low = force_nearby(curve, s, s->xi - 2.0 * reach), f_high = force_nearby(curve, s, s->xi + 2.0 * reach);
    double kappa = (f_high - f_low) / (4.0 * reach), damping = damping_at(curve, &s->line, s->xi);
    double y = s->nu - s->gamma * s->elastic, excess = s->elastic - s->load;
    double swing = length < least ? 0.0 : sqrt(excess * excess + kappa * (1.0 + s->gamma * damping) * y * y);
    if (!(swing < s->load - f_low && swing < f_high - s->load)) return 0;
    film_open_line(s);
    s->line.phi = s->elastic;
    s->line.kappa = kappa;
    s->line.damping = damping;
    s->line_ends = ENDS_NEVER;
    s->tau_end = INFINITY;
    s->phase = s->line.phase = FILM_RESTING;
    return 1;
}

/* ---------------------------------------------------------------- where the impactor stops */

enum { STOP_ITERATIONS = 60, NEWTON_STEPS = 10 };

/* The velocity is least where the force is the load, so this fraction of the force costs its square of the velocity. */
static const double DIP_TOLERANCE = 1e-9;

/* The force on the line after a way x, at the speed y. */
static double line_force(const film_state *s, double x, double y) {
    return s->line.phi + s->direction * (s->line.kappa * x + s->line.damping * y);
}

/* The impactor stops on the line just made: end it there, as at a node. The length for which nu at the end of the line is
 * stop_velocity, by Newton's method with dnu/dxi = (load - phi)/y in a bracket; from rest in the root of the length, since
 * nu falls with time and the way grows as its square. docs/method.md, section 5. */
void film_end_at_stop(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    film_state whole = *s;
    double full = s->direction * (s->xi_end - s->xi), low = 0.0, high = full, y = 0.0;
    double fraction = (s->nu - s->stop_velocity) / (s->nu - s->nu_end);
    int at_rest = s->from_turn && s->leg_node == 0;
    double length = at_rest ? full * fraction * fraction : full * fraction;
    s->line_ends = ENDS_STOP;
    for (int k = 0; k < STOP_ITERATIONS; k++) {
        motion m = film_make_line(curve, mesh, s, length, 0);
        if (move_to(&m, length, &s->tau_end, &y) != REACHED) { /* this line turns before */
            high = length;
            length = 0.5 * (low + high);
            continue;
        }
        film_set_line_end(s, length, y);
        double excess = s->nu_end - s->stop_velocity, phi = s->line.phi + s->line.kappa * s->direction * length;
        phi += s->line.damping * s->direction * y;
        if (excess > 0.0) low = length; else high = length;
        double step = excess * y / (phi - s->load), root = 1.0 + 0.5 * step / length;
        double next = !at_rest ? length + step : root > 0.0 ? length * root * root : 0.0;
        if (!(next > low && next < high) || k > NEWTON_STEPS) next = 0.5 * (low + high);
        if (fabs(next - length) <= (at_rest ? 1e-12 * length : 1e-14 * full)) {
            if (fabs(excess) > 1e-6 * (whole.nu - whole.nu_end)) break; /* it stops only on the line to the turn */
            double late = excess / (phi - s->load); /* near a turn the time is known better than the way */
            if (fabs(late) < 0.5 * s->tau_end) s->tau_end += late;
            s->nu_end = s->stop_velocity;
            return;
        }
        length = next;
    }
    *s = whole;
}

/* On the way out under a load, nu falls until the force has fallen to the load and rises afterwards: it may pass stop_velocity
 * twice within one line, which its end does not show. Ends the line at the first pass. docs/method.md, section 5. */
void film_end_at_dip(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    motion m = motion_on(s, s->line.phi, s->line.kappa);
    film_state whole = *s;
    double low = 0.0, high = s->tau_end, x, y;
    motion_at(&m, high, &x, &y);
    double above = line_force(s, 0.0, m.y0) - s->load, below = line_force(s, x, y) - s->load, near = DIP_TOLERANCE * (above - below);
    if (!(above > 0.0 && below < 0.0)) return;
    double excess = below;
    for (int k = 0; k < STOP_ITERATIONS && fabs(excess) > near; k++) { /* false position, the value at the older end halved */
        double at = low + (high - low) * above / (above - below), before = excess;
        motion_at(&m, at, &x, &y);
        excess = line_force(s, x, y) - s->load;
        if (excess > 0.0) {
            low = at;
            above = excess;
            if (before > 0.0) below *= 0.5;
        } else {
            high = at;
            below = excess;
            if (before < 0.0 && k > 0) above *= 0.5;
        }
    }
    film_set_line_end(s, x, y);
    if (s->nu_end < s->stop_velocity) film_end_at_stop(curve, mesh, s);
    if (s->line_ends != ENDS_STOP) *s = whole;
}
