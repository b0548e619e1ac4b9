/* The next line of a leg, and the flight to the next touch. docs/method.md, sections 2, 4, 5 and 9. */
#include "march/film_march.h"

/* A leg that arrives at the turn it was aimed at with less than this fraction of its last line's first speed has turned: the
 * energy left, 1e-12, is rounding. After a faster arrival the rest is planned afresh. Affects cost only: with 0, rounding
 * plans extra legs. */
static const double TURN_SPEED = 1e-6;

/* A way to the turn below this fraction of the depth is mostly rounding, so the motion turns on the law's tangent instead.
 * core_check.c, check_found: "a stop next to a turn". */
static const double SHORT_WAY_TO_TURN = 1e-9;

/* A line whose end dips below zero force by more than this fraction of the force at its start would hold the contact shut.
 * Affects cost only: with 0, some lines are halved because rounding makes them dip. */
static const double DIP = 1e-12;

/* A leg was aimed at a turn that the motion passes: if it turns, or the run ends, farther ahead than so many times the rest of
 * the leg, the way to there is planned afresh. One line would be too long for the mesh, on every mesh. */
static const double FAR = 2.0;

/* Whether the contact creeps out along a branch that ends at an angle, and never ends. With the ratio u of nu to the force f
 * there, u' = kappa u (gamma - u) - 1. If the slope at the end is at least 4/gamma^2, the larger of the u that stand still
 * there is a bound: no steeper part of the branch takes u below it. docs/method.md, section 9. */
static int creeps_out(const film_curve *curve, const film_state *s) {
    if (s->branch != FILM_BRANCH || s->line.exponent < 1.0 || s->gamma == 0.0 || s->load != 0.0 || !leaves_freely(curve, s)) return 0;
    if (run_limit(curve, s) != s->xi_free || !(s->elastic > 0.0)) return 0;
    double origin = (s->xi_free - s->line.xi_origin) * s->line.per_recovery;
    double slope = s->line.f_max * s->line.exponent * s->line.per_recovery * pow(fmax(origin, 0.0), s->line.exponent - 1.0);
    double square = s->gamma * s->gamma - 4.0 * (1.0 / slope + curve->compliance);
    return square >= 0.0 && 2.0 * s->nu >= s->elastic * (s->gamma + sqrt(square));
}

static int end_never(film_state *s) {
    s->line_ends = ENDS_NEVER;
    s->tau_end = INFINITY;
    return FILM_OK;
}

/* The rest of the way out is rounding, and nothing pushes back in: go to the end of the run at once. */
static int pass_to_limit(const film_curve *curve, film_state *s) {
    film_end_here(s, ENDS_EDGE);
    s->xi_end = run_limit(curve, s);
    law_at(curve, &s->line, s->xi_end, &s->force_end, &s->work_end);
    s->nu_end = fmin(s->nu, s->gamma * s->force_end);
    return FILM_OK;
}

/* The motion turns here. On a free way out only rounding can turn it, and film_finish lets it start again from rest; where
 * the leg itself began here, that was tried, and the run ends. */
static int turn_here(const film_curve *curve, film_state *s) {
    if (leaves_freely(curve, s) && s->xi == s->leg_from) return pass_to_limit(curve, s);
    film_end_here(s, ENDS_TURN);
    return FILM_OK;
}

static double node_fraction(const film_mesh *mesh, const film_state *s, int32_t i) {
    if (s->leg_grading == GRADING_COARSE) {
        double f = (double)i / s->leg_nodes;
        return f * f * (3.0 - 2.0 * f);
    }
    return (s->direction > 0 ? mesh->loading_nodes : mesh->unloading_nodes)[s->leg_grading][i];
}

/* Without a load nothing turns the motion on its way out, but a line may: if it begins with less force than the law, the
 * motion on it begins inwards; if it ends with more, the motion ends inwards. A line that meets the law's force at that end
 * replaces it. `moved` and the result: what move_to says of the line before and after. */
static int make_outward_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int moved, double *y) {
    film_state before = *s;
    double h = s->direction * length;
    if (moved == REACHED) {
        film_make_turn_line(curve, mesh, s, length, 1);
    } else {
        s->line.kappa = 2.0 * (film_mean_force(curve, s, h) - s->elastic) * per_length(s, h);
        s->line.phi = s->elastic;
    }
    motion m = motion_on(s, s->line.phi, s->line.kappa);
    int now = move_to(&m, length, &s->tau_end, y);
    if (now == REACHED) film_set_line_end(s, length, *y);
    else if (now == TURNS_BEFORE) *s = before;
    return now == TURNS_BEFORE ? moved : now;
}

/* Whether half a line may be better, on the way out without a load. A work-preserving line may dip below zero force where
 * the law only touches it, and a chord be too steep where the law lies below it: both would hold the contact shut. */
static int too_steep_outwards(const film_curve *curve, const film_mesh *mesh, const film_state *s, double length) {
    double h = s->direction * length, middle, work;
    if (s->line.phi + s->line.kappa * s->direction * length < -DIP * s->elastic) return 1;
    if (mesh->linearisation != FILM_CHORD) return 0;
    law_at(curve, &s->line, s->xi + 0.5 * h, &middle, &work);
    return middle < 0.499999 * (s->elastic + s->force_end);
}

enum { AT_LIMIT = -1 }; /* shorten_line, beside what move_to says: half the line is less than rounding, so the run is over */

/* Halves a line until its motion reaches the end: on a free way out if it is too steep, and from rest on a target that moves,
 * since one line cannot match the law both at rest and at a turn. `moved` and the result: as in make_outward_line. */
static int shorten_line(const film_curve *curve, const film_mesh *mesh, film_state *s, int moved, double *length, motion *m,
                        double *y) {
    int at_rest = s->from_turn && s->leg_node == 0;
    for (int k = 0; moved != REACHED && k < HALVINGS; k++) {
        if (leaves_freely(curve, s)) {
            double free = s->branch >= 0 ? 0.0 : s->xi_free;
            if (!too_steep_outwards(curve, mesh, s, *length)) break;
            if (s->xi - free < CREPT * (s->xi_max - free)) return NEVER_REACHED;
        } else if (moved != TURNS_BEFORE || !at_rest || s->gamma == 0.0 || s->leg_grading == GRADING_COARSE) {
            break;
        }
        *length *= 0.5;
        s->line_ends = ENDS_PART;
        if (leaves_freely(curve, s) && s->xi + s->direction * *length == s->xi) return AT_LIMIT;
        *m = film_make_line(curve, mesh, s, *length, 0);
        moved = move_to(m, *length, &s->tau_end, y);
    }
    return moved;
}

/* The leg ends where the motion on this very line turns, under the law's force: for chords, as in the paper, and for a line
 * from rest. */
static int end_at_own_turn(const film_curve *curve, film_state *s, const motion *m) {
    double x, y;
    s->tau_end = turn_time(m);
    if (!(m->y0 >= 0.0 && s->tau_end > 0.0 && s->tau_end < INFINITY)) return turn_here(curve, s);
    motion_at(m, s->tau_end, &x, &y);
    s->line_ends = ENDS_TURN;
    film_set_line_end(s, x, 0.0);
    law_at(curve, &s->line, s->xi_end, &s->force_end, &s->work_end);
    s->nu_end = s->gamma * s->force_end;
    if (leaves_freely(curve, s) && s->xi_end == s->leg_from) return pass_to_limit(curve, s);
    return FILM_OK;
}

enum { TURN_AHEAD = 1 }; /* line_to_node, beside FILM_OK: the motion turns before the node, on a line still to be found */

/* The line to the next node, *length ahead at `to`. own_turn: a turn before the node is the line's own.
 * docs/method.md, sections 2 and 5. */
static int line_to_node(const film_curve *curve, const film_mesh *mesh, film_state *s, double to, double *length, int own_turn) {
    int at_rest = s->from_turn && s->leg_node == 0, freely = leaves_freely(curve, s);
    double y;
    if (!(*length > 0.0)) {
        film_end_here(s, s->line_ends);
        if (s->line_ends == ENDS_TURN) s->nu_end = s->gamma * s->elastic; /* its speed is rounding */
        return FILM_OK;
    }
    if (at_rest && s->line_ends == ENDS_TURN && s->gamma > 0.0) { /* from rest to a turn: in two lines */
        *length *= 0.5;
        s->line_ends = ENDS_PART;
    }
    motion m = film_make_line(curve, mesh, s, *length, 0);
    int moved = move_to(&m, *length, &s->tau_end, &y);
    if (moved != REACHED && freely && is_damped(curve, s)) return end_never(s); /* F falls to 0 on the way */
    if (moved != REACHED && is_damped(curve, s)) { /* or did the tilt turn it? */
        m = film_make_line(curve, mesh, s, *length, 1);
        moved = move_to(&m, *length, &s->tau_end, &y);
    }
    if (moved == TURNS_BEFORE && m.y0 < 0.0 && freely && !at_rest)
        moved = make_outward_line(curve, mesh, s, *length, moved, &y);
    if (moved != REACHED) moved = shorten_line(curve, mesh, s, moved, length, &m, &y);
    if (moved == AT_LIMIT) return pass_to_limit(curve, s);
    if (moved == REACHED) {
        if (s->line_ends == ENDS_TURN && y > TURN_SPEED * m.y0) s->line_ends = ENDS_NODE; /* it turns later: plan afresh */
        film_set_line_end(s, *length, s->line_ends == ENDS_TURN ? 0.0 : y);
        if (freely && s->nu_end > s->gamma * s->force_end) moved = make_outward_line(curve, mesh, s, *length, moved, &y);
    }
    if (moved == REACHED) {
        if (s->line_ends != ENDS_PART) s->xi_end = to;
        if (s->line_ends == ENDS_TURN && turn_time(&m) < INFINITY) s->tau_end = turn_time(&m); /* y there is only rounding */
        return FILM_OK;
    }
    if (moved == NEVER_REACHED) return end_never(s);
    return own_turn ? end_at_own_turn(curve, s, &m) : TURN_AHEAD;
}

/* No line turns at its own end, and the lines soften: the law softens to less than the load, or to no force. Makes a line
 * that the motion passes; the rest is planned afresh. docs/method.md, section 5. */
static int pass_softening(const film_curve *curve, const film_mesh *mesh, film_state *s, double length) {
    double y;
    s->leg_node = s->leg_nodes - 1;
    s->line_ends = ENDS_NODE;
    motion m = film_make_line(curve, mesh, s, length, 0);
    while (move_to(&m, length, &s->tau_end, &y) != REACHED) {
        length *= 0.5;
        if (!(length > SHORT_WAY_TO_TURN * fabs(s->xi))) return turn_here(curve, s);
        m = film_make_line(curve, mesh, s, length, 0);
    }
    film_set_line_end(s, length, y);
    return FILM_OK;
}

/* The last line of a leg, which ends where its motion turns under the law's own force; `guess`: its length, about. If it
 * does not turn up to `edge`, where the run ends, the line to there. docs/method.md, section 5. */
static int line_to_turn(const film_curve *curve, const film_mesh *mesh, film_state *s, double guess, double edge,
                        double tolerance) {
    double length = 0.0, y;
    int turn = TURN_BETWEEN;
    if (!(s->direction * (s->nu - s->gamma * s->elastic) > 0.0)) return turn_here(curve, s);
    if (!(guess > 0.0)) guess = 1e-3 * fabs(s->leg_to - s->leg_from);
    for (int plain = 0; turn == TURN_BETWEEN && plain <= is_damped(curve, s); plain++) { /* plain: without tilt by damping */
        length = guess;
        turn = film_find_turn(curve, mesh, s, &length, edge, tolerance, plain);
    }
    if (turn == TURN_BETWEEN && !(s->line.kappa > 0.0)) return pass_softening(curve, mesh, s, length);
    if (turn != NO_TURN) {
        double usual = fmax(guess, fabs(s->leg_to - s->leg_from) / s->leg_nodes);
        if (length > FAR * usual && s->leg_grading != GRADING_COARSE) return pass_softening(curve, mesh, s, guess);
        s->line_ends = s->tau_end < INFINITY ? ENDS_TURN : ENDS_NEVER;
        s->xi_end = s->xi + s->direction * length;
        s->nu_end = s->gamma * s->force_end;
        return FILM_OK;
    }
    if (!(edge < INFINITY)) return FILM_BEYOND_LAW;
    if (edge > FAR * guess) return pass_softening(curve, mesh, s, guess);
    film_make_turn_line(curve, mesh, s, edge, 0);
    motion m = motion_on(s, s->line.phi, s->line.kappa);
    s->leg_node = s->leg_nodes - 1;
    s->leg_to = run_limit(curve, s);
    s->leg_ends = s->line_ends = ENDS_EDGE;
    if (move_to(&m, edge, &s->tau_end, &y) != REACHED) {
        s->tau_end = turn_time(&m);
        y = 0.0;
    }
    film_set_line_end(s, edge, y);
    s->xi_end = s->leg_to;
    return s->tau_end < INFINITY ? FILM_OK : FILM_BEYOND_LAW;
}

/* For a turn so near that a line to it would be rounding: the motion turns on the law's tangent, if the force that acts here
 * stops it within SHORT_WAY_TO_TURN. Returns 1 if so. */
static int turn_at_once(const film_curve *curve, film_state *s, double length) {
    int no_leg = !(length > 0.0) && s->leg_to == s->leg_from;
    double speed = s->direction * (s->nu - s->gamma * s->elastic), pull = s->direction * (s->elastic - s->load);
    if (!(speed > 0.0 && (no_leg || speed * speed <= 2.0 * SHORT_WAY_TO_TURN * pull * fabs(s->xi)))) return 0;
    film_end_here(s, ENDS_TURN);
    s->line.damping = damping_at(curve, &s->line, s->xi);
    s->line.kappa = fmax(law_slope(curve, &s->line, s->xi), 0.0);
    motion m = motion_on(s, s->elastic, s->line.kappa);
    s->tau_end = pull > 0.0 ? turn_time(&m) : 0.0;
    s->nu_end = s->gamma * s->elastic;
    return 1;
}

/* Replaces the law by a line from the current point to the next node of the leg, to a turn before it, or to where else the
 * line must end; sets line, line_ends, tau_end and the state at the end. docs/method.md, sections 2 and 5. */
int film_next_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double turn_tolerance) {
    if (s->leg_ends == ENDS_EDGE && creeps_out(curve, s)) s->leg_ends = ENDS_NEVER;
    int straight = s->leg_ends == ENDS_NEVER && leaves_freely(curve, s) && s->xi - s->leg_to < REST_LENGTH * s->recovery;
    int last = straight || s->leg_node + 1 >= s->leg_nodes, at_rest = s->from_turn && s->leg_node == 0;
    int own_turn = at_rest || (mesh->linearisation == FILM_CHORD && s->gamma == 0.0 && !is_damped(curve, s));
    double d = s->direction;
    double to = last ? s->leg_to : s->leg_from + (s->leg_to - s->leg_from) * node_fraction(mesh, s, s->leg_node + 1);
    double length = d * (to - s->xi), edge = d * (run_limit(curve, s) - s->xi);
    s->line_ends = last ? s->leg_ends : ENDS_NODE;
    if (!(edge > 0.0) && (s->line_ends == ENDS_TURN || s->line_ends == ENDS_NEVER)) {
        film_end_here(s, s->leg_ends = ENDS_EDGE);
        return FILM_OK;
    }
    if (s->line_ends == ENDS_TURN && !at_rest && length <= SHORT_WAY_TO_TURN * fabs(s->xi) && turn_at_once(curve, s, length))
        return FILM_OK;
    if (s->line_ends != ENDS_TURN || own_turn) {
        if (line_to_node(curve, mesh, s, to, &length, own_turn) == FILM_OK) return FILM_OK;
        length *= 0.5;
    }
    return line_to_turn(curve, mesh, s, length, edge, turn_tolerance);
}

/* The flight to the next touch, at xi_free: nu t + p t^2/2 = gap under the load p. A contact that was released inside its
 * dent, gap < 0, touches again where F rises from 0. docs/method.md, section 9. */
void film_make_flight(const film_curve *curve, film_state *s) {
    double gap = s->xi_free - s->xi, p = s->load, nu = s->nu;
    s->line.phi = s->line.kappa = s->line.damping = 0.0;
    s->direction = 1;
    end_never(s);
    double square = nu * nu + 2.0 * p * gap, margin = gap < 0.0 ? film_release_margin(curve, s) : INFINITY;
    int pressed = margin < INFINITY && margin > INSIDE_DENT * fabs(nu); /* the support's velocity has changed */
    if (pressed || (gap <= 0.0 && (nu > 0.0 || (nu == 0.0 && p > 0.0)))) {
        s->tau_end = 0.0;
    } else if (p > 0.0 && !(square > 0.0)) {
        s->tau_end = film_touch_time(curve, s);
    } else if (p > 0.0) { /* with nu < 0 it rises first, then falls */
        s->tau_end = nu >= 0.0 ? 2.0 * gap / (nu + sqrt(square)) : (sqrt(square) - nu) / p;
    } else if (nu > 0.0 && square > 0.0) {
        s->tau_end = 2.0 * gap / (nu + sqrt(square));
    }
    if (!(s->tau_end < INFINITY)) return;
    int inside = gap < 0.0 && (pressed || !(square > 0.0 && p > 0.0 && nu < 0.0));
    s->line_ends = ENDS_EDGE;
    s->xi_end = inside ? s->xi + s->tau_end * (nu + 0.5 * p * s->tau_end) : s->xi_free;
    s->nu_end = nu + p * s->tau_end;
}
