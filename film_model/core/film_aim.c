/* Where a leg ends: at the turn that energy gives on a fixed target, at the turn of trial legs on others. Nodes are graded
 * towards that point, and the last line must meet the law's force there. Where the impactor stops. docs/method.md, section 5. */
#include "film_march.h"

/* A turn is known to this fraction of the depth at best: the mean force of a short line is a difference of works.
 * core_check.c, one_schedule with DAMPED. */
static const double TURN_ROUNDING = 2e-15;

/* A trial leg only places the nodes of the next, so its turn is sought to this fraction of its last line. Cost only: another
 * value moves the nodes, and the results by less than the lines' error. */
static const double TRIAL_TOLERANCE = 1e-2;

/* Newton's method has converged when a step is below this fraction of the depth: the error of the next one is its square.
 * core_check.c, check_linear_law, at 1e-4. */
static const double NEWTON_SETTLED = 1e-9;

enum { BALANCE_HALVINGS = 100 };

/* ---------------------------------------------------------------- a line that ends at the turn */

/* How far the motion goes on a line until it turns, and when; INFINITY if it never does. An over-damped motion that a load
 * pushes creeps up to its balance, and turns there after an infinite time. */
static double reach_of(const motion *m, double *tau) {
    double reach = INFINITY, y;
    *tau = INFINITY;
    if (!(m->y0 > 0.0) && !(m->phi < 0.0 && m->a > 0.0)) {
        reach = *tau = 0.0;
    } else if (m->a == 0.0) {
        double root = m->phi * m->phi + m->kappa * m->y0 * m->y0;
        int driven = m->phi < 0.0 && m->kappa > 0.0; /* the load drives it on, past the balance */
        if (driven || (root >= 0.0 && m->phi + sqrt(root) > 0.0)) {
            reach = driven ? (sqrt(root) - m->phi) / m->kappa : m->y0 * m->y0 / (m->phi + sqrt(root));
            double ratio = reach / m->y0;
            *tau = 2.0 * ratio * arc(m->kappa * ratio * ratio);
        }
    } else if ((*tau = turn_time(m)) < INFINITY) {
        motion_at(m, *tau, &reach, &y);
    } else if (m->kappa > 0.0 && m->phi < 0.0) {
        reach = -m->phi / m->kappa;
    } else if (m->kappa == 0.0 && m->phi == 0.0) {
        reach = 0.5 * m->y0 / m->a;
    }
    return reach;
}

/* The length h for which the line over h, which meets the law's force at its end (film_make_turn_line), turns after exactly
 * h: there y = nu - gamma f is 0 on the line and on the law. Secant steps in a bracket; *length is the first guess and the
 * answer. NO_TURN: the motion passes `limit`; TURN_BETWEEN: there is no such length, since lines up to *length turn late and
 * longer ones early. docs/method.md, section 5. */
int film_find_turn(const film_curve *curve, const film_mesh *mesh, film_state *s, double *length, double limit,
                   double tolerance, int plain) {
    double low = 0.0, high = INFINITY, h = *length < limit ? *length : limit;
    double last_h = 0.0, last_miss = 0.0;
    for (int k = 0; k < TURN_ITERATIONS; k++) {
        film_make_turn_line(curve, mesh, s, h, plain);
        motion m = motion_on(s, s->line.phi, s->line.kappa);
        double reach = reach_of(&m, &s->tau_end), miss = reach - h;
        *length = h;
        if (fabs(miss) <= tolerance * h + TURN_ROUNDING * (fabs(s->xi) + h)) return TURN;
        if (miss > 0.0) low = h; else high = h;
        if (miss > 0.0 && h >= limit) return NO_TURN;
        double next = reach;
        if (k > 0 && reach < INFINITY && miss != last_miss) next = h - miss * (h - last_h) / (miss - last_miss);
        last_h = h;
        last_miss = miss;
        double top = high < limit ? high : limit;
        double middle = high > 100.0 * low ? (low > 0.0 ? sqrt(low) * sqrt(high) : 1e-3 * high) : 0.5 * (low + high);
        if (!(next > low && next < high)) next = high < INFINITY ? middle : 2.0 * h;
        if (k > 20 && high < INFINITY) next = middle;
        h = next < top ? next : top;
    }
    return high < INFINITY ? TURN_BETWEEN : NO_TURN;
}

/* ---------------------------------------------------------------- fixed targets: energy */

/* Kinetic energy left at xi on a fixed target, and its slope. `energy`: kinetic energy + work - load xi of the run. */
static double energy_at(const film_curve *curve, const film_line *run, double energy, double load, double xi,
                        series_place *near, double *slope) {
    double force, work;
    law_near(curve, run, xi, near, &force, &work);
    *slope = load - force;
    return energy - work + load * xi;
}

/* In a stage without an end: *inner, where energy is left, and *outer, where none is. The leading term of a power gives an
 * *outer of about the right size; elsewhere the way is doubled. */
static int bracket_turn(const film_curve *curve, const film_line *run, double xi, double total, double load, double *inner,
                        double *outer, series_place *near) {
    const film_piece *piece = piece_at(curve, run->branch, INFINITY);
    const film_function *g = &piece->force;
    double reach = INFINITY, slope;
    if (g->coefficient > 0.0 && g->slope >= 0.0 && g->constant >= 0.0 && load <= 0.0 && curve->compliance == 0.0)
        reach = pow((g->exponent + 1.0) * (total + piece->work_at_begin) / g->coefficient, work_factor(g->exponent));
    *outer = reach < INFINITY ? g->origin + reach * (1.0 + 1e-12) : xi + 1.0;
    for (int k = 0; energy_at(curve, run, total, load, *outer, near, &slope) > 0.0; k++) {
        if (k >= DOUBLINGS || !(*outer < 1e300)) return FILM_BEYOND_LAW;
        *inner = *outer;
        *outer = xi + 2.0 * (*outer - xi);
    }
    return FILM_OK;
}

/* Where the law's work has used up the kinetic energy at the start and the load's work: Newton's method in a bracket.
 * docs/method.md, section 5. */
int film_turning_point(const film_curve *curve, const film_line *run, double xi, double work, double nu, double load,
                       double limit, series_place *near, double *to) {
    double energy = 0.5 * nu * nu, total = energy + work - load * xi, slope, inner = xi, outer = limit, at = limit;
    if (limit < INFINITY) {
        double left = energy_at(curve, run, total, load, limit, near, &slope);
        if (left >= 0.0) {
            *to = limit;
            return FILM_OK;
        }
        if (energy > 0.0) at = xi + (limit - xi) * sqrt(energy / (energy - left)); /* as if work grew as a square */
    } else {
        int status = bracket_turn(curve, run, xi, total, load, &inner, &outer, near);
        if (status < 0) return status;
        at = outer;
    }
    double d = outer > inner ? 1.0 : -1.0;
    for (int k = 0; k < ROOT_ITERATIONS; k++) {
        energy = energy_at(curve, run, total, load, at, near, &slope);
        if (energy >= 0.0) inner = at; else outer = at;
        double next = at - energy / slope;
        int inside = d * (next - inner) > 0.0 && d * (outer - next) > 0.0;
        int settled = fabs(next - at) <= (inside ? NEWTON_SETTLED : 4e-16) * fabs(at);
        at = inside ? next : settled ? at : 0.5 * (inner + outer);
        if (settled) break;
    }
    *to = at;
    return FILM_EVENT;
}

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
    for (int32_t nodes = 1; nodes == 1 || 3 * nodes <= s->leg_nodes; nodes *= 4) {
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
        motion m = film_make_line(curve, mesh, s, length);
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
 * twice on one line, whose end does not tell. Ends the line where it passes first. docs/method.md, section 5. */
void film_end_at_dip(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    motion m = motion_on(s, s->line.phi, s->line.kappa);
    film_state whole = *s;
    double low = 0.0, high = s->tau_end, x, y;
    motion_at(&m, high, &x, &y);
    if (!(line_force(s, 0.0, m.y0) > s->load && line_force(s, x, y) < s->load)) return;
    for (int k = 0; k < STOP_ITERATIONS; k++) {
        double middle = 0.5 * (low + high);
        motion_at(&m, middle, &x, &y);
        if (line_force(s, x, y) > s->load) low = middle; else high = middle;
    }
    film_set_line_end(s, x, y);
    if (s->nu_end < s->stop_velocity) film_end_at_stop(curve, mesh, s);
    if (s->line_ends != ENDS_STOP) *s = whole;
}
