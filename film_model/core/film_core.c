/* The march: legs, the lines that replace the law on them, and what happens where a line ends. See film_core.h. */
#include "film_core.h"

#include "film_line.h"

#include <string.h>

/* How a line, or a leg, ends. PART, STOP and RELEASE (F falls to 0) end between two nodes. */
enum { ENDS_NODE, ENDS_EDGE, ENDS_TURN, ENDS_NEVER, ENDS_PART, ENDS_STOP, ENDS_RELEASE };
/* The branches of a law that reloads on its own: from xi_max out; back in from xi_in to xi_max; from xi_out on the way
 * in, out again to xi_in, and from there on as before. Reloading lies above unloading, and what turns on the innermost
 * branch stays on it, so that no sequence of turns gives energy. */
enum { LOOP_NONE, LOOP_RELOAD, LOOP_INNER };
enum { GRADING_COARSE = -1 }; /* nodes of a trial leg: 3 s^2 - 2 s^3, no table needed */

enum { TURN_NOT, TURN, TURN_BETWEEN };

static const double TURN_TOLERANCE = 1e-12;      /* of the length of the last segment, a small part of the depth */
static const double TURN_ROUNDING = 2e-15;       /* of the depth: a short segment's mean force is not known better */
static const double TRIAL_TURN_TOLERANCE = 1e-2; /* a trial only aims the nodes */
static const double TURN_SPEED = 1e-6;           /* of the speed a line began with: its energy, 1e-12, is rounding */
static const double SHORT_TURN = 1e-9;           /* of the depth: a way to the turn of which rounding is a part */
static const double REST_LENGTH = 1e-6;          /* of the contact's depth: curvature changes the force by 1e-12 */
static const double NEIGHBOURS = 1e-15;           /* of the indentation: numbers that can hardly be told apart */
static const double REST_SPEED = 1e-13;          /* of the impactor's: rounding of y = nu - gamma f */
static const double NEWTON_SETTLED = 1e-9;       /* relative; the next step's error is the square */
static const double SHORT_WAY = 2e-4;            /* of the distance to the law's singular point; see mean_force */
static const double WITHIN = 1e-9;               /* of the depth: where to ask whether a contact still holds */
static const double SHALLOWEST = 1e-12;          /* of the scale: where to ask for f/c of a contact that has no depth */
static const double SAME_FORCE = 1e-12;          /* of the largest: what rounding makes of one force where two stages meet */
static const double TINY = 1e-100;               /* of a load, a velocity, a gap: their squares and powers underflow */
static const double CREPT = 1e-30;               /* of the depth, or of one over the time: a contact that creeps as far never ends */
static const double PEAK_TOLERANCE = 1e-8;       /* of the way: F differs by its square */
static const double SMALL_LOOP = 1e-6;           /* of the recovery: a shorter way back in is the way out */
enum { RELEASE_ITERATIONS = 120, PEAK_ITERATIONS = 60 };
enum { TURN_ITERATIONS = 60, HALVINGS = 60, NEWTON_STEPS = 10 };

/* ---------------------------------------------------------------- a contact in series with a spring */

enum { SERIES_STEPS = 100 };
static const double SERIES_REACH = 1.05; /* of a series' interval: how far beyond its end it still serves */

/* The indentation xi at which xi + compliance force(xi) = x. The sum grows with xi, so Newton's method in a bracket. */
static double indentation_at(const film_curve *curve, const film_line *line, const film_piece *piece, double x) {
    double c = curve->compliance, low = line->xi_free, high = x, force, work;
    if (line->branch >= 0) {
        const film_function *g = &piece->force;
        low = g->origin;
        if (g->form != FILM_POWER) high = fmin(x, low + SERIES_REACH / g->per_span);
    }
    if (!(x > low)) return x;
    contact_at(line, piece, low, &force, &work);
    if (!(low + c * force < x)) return low;
    double xi = high;
    for (int k = 0; k < SERIES_STEPS; k++) {
        contact_at(line, piece, xi, &force, &work);
        double miss = xi + c * force - x, next = xi - miss / (1.0 + c * contact_slope(line, piece, xi));
        if (fabs(next - xi) <= 4e-16 * x) return next;
        if (miss < 0.0) low = xi; else high = xi;
        xi = next > low && next < high ? next : 0.5 * (low + high);
    }
    return xi;
}

void film_law_in_series(const film_curve *curve, const film_line *line, double x, double *force, double *work) {
    const film_piece *piece = line->branch >= 0 ? piece_at(curve, line->branch, x) : 0;
    if (line->branch == FILM_FREE) {
        *force = *work = 0.0;
        return;
    }
    contact_at(line, piece, indentation_at(curve, line, piece, x), force, work);
    *work += 0.5 * curve->compliance * *force * *force;
}

double film_slope_in_series(const film_curve *curve, const film_line *line, double x) {
    const film_piece *piece = line->branch >= 0 ? piece_at(curve, line->branch, x) : 0;
    if (line->branch == FILM_FREE) return 0.0;
    double slope = contact_slope(line, piece, indentation_at(curve, line, piece, x));
    return slope / (1.0 + curve->compliance * slope);
}

/* ---------------------------------------------------------------- lines */

static motion on_line(const film_state *s, double phi, double kappa) {
    double d = s->direction, c = s->line.damping, per_m = 1.0 / (1.0 + s->gamma * c);
    motion m = {d * (s->nu - s->gamma * phi) * per_m, d * (phi - s->load) * per_m, kappa * per_m,
                0.5 * (kappa * s->gamma + c) * per_m};
    return m;
}

static int damped(const film_curve *curve, const film_state *s) {
    return s->damper > 0.0 && s->branch >= 0 && curve->stage[s->branch].damped;
}

/* Abscissas and weights of Gauss's rule of five points on 0 .. 1. */
enum { GAUSS = 5 };
static const double GAUSS_AT[GAUSS] = {0.046910077030668004, 0.23076534494715845, 0.5, 0.76923465505284155, 0.953089922969332};
static const double GAUSS_WEIGHT[GAUSS] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                           0.23931433524968324, 0.11846344252809454};

/* The mean of the law's c over the next h, weighted with a speed that goes evenly from y0 to y1: as a constant it takes as
 * much energy as c. */
static double mean_damping(const film_curve *curve, const film_state *s, double h, double y0, double y1) {
    double sum = 0.0, weights = 0.0, per_way = 2.0 / (y0 + y1);
    int root = h > 0.0 && s->xi <= WITHIN * h; /* c may begin as a root there: fourth powers of even steps */
    for (int k = 0; k < GAUSS; k++) {
        double w = GAUSS_AT[k], u = root ? w * w * w * w : w, y = y0 + (y1 - y0) * u;
        double weight = GAUSS_WEIGHT[k] * y * y * (root ? 4.0 * w * w * w : 1.0);
        sum += weight * damping_at(curve, &s->line, s->xi + h * per_way * u * (y0 + 0.5 * (y1 - y0) * u));
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : damping_at(curve, &s->line, s->xi + 0.5 * h); /* speeds whose squares underflow */
}

/* Speed along the direction of motion, of the true law. */
static double speed_at(const film_curve *curve, const film_state *s, double xi, double force, double nu) {
    return s->direction * (nu - s->gamma * force) / (1.0 + s->gamma * damping_at(curve, &s->line, xi));
}

/* 1/h; 0 where h is rounding of the indentation, and what the force changes over it would be no slope. */
static double per_way(const film_state *s, double h) { return s->xi + h != s->xi ? 1.0 / h : 0.0; }

/* Damping of the line over the next h, passed with speeds y0 to y1: a constant, and what c y is more or less than that at
 * the ends put on the line's own force, with as much work as c y in all. At a turn c y is 0, and the line keeps its force.
 * plain: the constant alone. */
static void damp(const film_curve *curve, const film_mesh *mesh, film_state *s, double h, double y0, double y1, int plain) {
    double mean = mean_damping(curve, s, h, y0, y1), c0 = damping_at(curve, &s->line, s->xi), c1 = damping_at(curve, &s->line, s->xi + h);
    double d = s->direction, at = mean, tilt;
    s->line.damping = mean;
    /* a line too long for the speeds to be known: what they say of c y might drive the motion */
    if (plain || mesh->linearisation == FILM_CHORD || mean * fabs(h) > 0.5 * fmax(y0, y1) || per_way(s, h) == 0.0) return;
    /* the mean speed over the way: of y^2 that goes evenly with time, as in mean_damping */
    double speed = 2.0 / 3.0 * (y0 * y0 + y0 * y1 + y1 * y1) / (y0 + y1);
    if (y0 == 0.0 || y1 == 0.0) {
        at = y0 == 0.0 ? c0 : c1;
        tilt = (y0 == 0.0 ? 2.0 : -2.0) * d * (mean - at) * speed / h;
        s->line.phi -= y0 == 0.0 ? 0.0 : tilt * h;
    } else {
        tilt = d * ((c1 - mean) * y1 - (c0 - mean) * y0) / h;
        s->line.phi -= 0.5 * tilt * h;
    }
    s->line.damping = at;
    s->line.kappa += tilt;
}

/* The edge of the current stage or branch towards the deep, or towards the free surface. */
static double edge_of(const film_curve *curve, const film_state *s, int direction) {
    if (s->branch == FILM_BRANCH && s->loop != LOOP_NONE)
        return direction < 0 ? s->xi_in : s->loop == LOOP_INNER ? s->xi_out : s->xi_max;
    if (s->branch == FILM_BRANCH) return direction > 0 ? s->xi_max : s->xi_free;
    return direction > 0 ? curve->stage[s->branch].end : curve->stage[s->branch].begin;
}

/* Where the current run must end at the latest. */
static double limit_of(const film_curve *curve, const film_state *s) { return edge_of(curve, s, s->direction); }

/* Mean force between the current point and the end of the line. Over a short way work differences are mostly rounding,
 * and Simpson's rule is exact: its error is (h/x)^4/2880 of the force, x the distance from the law's singular point. */
static double mean_force(const film_curve *curve, const film_state *s, double h) {
    double origin = s->branch >= 0 ? piece_at(curve, s->branch, s->xi)->force.origin : s->line.xi_origin;
    double near = s->xi - curve->compliance * s->elastic - origin, far = s->xi + h - curve->compliance * s->force_end - origin;
    double x = fabs(near) < fabs(far) ? near : far;
    double way = (s->xi + h) - s->xi; /* what rounding has made of h, and the work is over */
    if (way != 0.0 && fabs(way) >= SHORT_WAY * fabs(x)) return (s->work_end - s->work) / way;
    double middle, work;
    law_at(curve, &s->line, s->xi + 0.5 * h, &middle, &work);
    return (s->elastic + 4.0 * middle + s->force_end) / 6.0;
}

/* The line from the current point over `length` that meets the law's force at the far end: it does the law's work, or
 * it is the chord. */
static void line_to_turn(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int plain) {
    double h = s->direction * length;
    law_at(curve, &s->line, s->xi + h, &s->force_end, &s->work_end);
    double near = mesh->linearisation == FILM_CHORD ? s->elastic : 2.0 * mean_force(curve, s, h) - s->force_end;
    s->line.kappa = (s->force_end - near) * per_way(s, h);
    s->line.phi = near;
    s->line.damping = 0.0;
    if (damped(curve, s)) {
        double y0 = speed_at(curve, s, s->xi, s->elastic, s->nu);
        damp(curve, mesh, s, h, y0 > 0.0 ? y0 : 1.0, 0.0, plain || !(y0 > 0.0)); /* of rounding, where it is none */
    }
}

/* The last line must pass through the law's force where the motion turns, since y = nu - gamma f there: the length h
 * for which the line over h turns after exactly h. Secant steps inside a bracket; `length` is the first guess and
 * becomes the answer. An over-damped line that a load pushes on creeps up to its balance and turns there after an infinite
 * time. TURN_NOT: none up to `limit`; TURN_BETWEEN: lines turn late up to the length found, and early after it. */
static int find_turn(const film_curve *curve, const film_mesh *mesh, film_state *s, double *length, double limit,
                     double tolerance, int plain) {
    double low = 0.0, high = INFINITY, h = *length < limit ? *length : limit;
    double last_h = 0.0, last_miss = 0.0;
    for (int k = 0; k < TURN_ITERATIONS; k++) {
        line_to_turn(curve, mesh, s, h, plain);
        motion m = on_line(s, s->line.phi, s->line.kappa);
        double reach = INFINITY, tau = INFINITY, y;
        if (!(m.y0 > 0.0) && !(m.phi < 0.0 && m.a > 0.0)) {
            reach = tau = 0.0;
        } else if (m.a == 0.0) {
            double root = m.phi * m.phi + m.kappa * m.y0 * m.y0;
            int driven = m.phi < 0.0 && m.kappa > 0.0; /* first on, past the balance */
            if (driven || (root >= 0.0 && m.phi + sqrt(root) > 0.0)) {
                reach = driven ? (sqrt(root) - m.phi) / m.kappa : m.y0 * m.y0 / (m.phi + sqrt(root));
                double ratio = reach / m.y0;
                tau = 2.0 * ratio * arc(m.kappa * ratio * ratio);
            }
        } else if ((tau = turn_time(&m)) < INFINITY) {
            move(&m, tau, &reach, &y);
        } else if (m.kappa > 0.0 && m.phi < 0.0) {
            reach = -m.phi / m.kappa;
        } else if (m.kappa == 0.0 && m.phi == 0.0) {
            reach = 0.5 * m.y0 / m.a;
        }
        double miss = reach - h;
        s->tau_end = tau;
        *length = h;
        if (fabs(miss) <= tolerance * h + TURN_ROUNDING * (fabs(s->xi) + h)) return TURN;
        if (miss > 0.0) low = h; else high = h;
        if (miss > 0.0 && h >= limit) return TURN_NOT;
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
    return high < INFINITY ? TURN_BETWEEN : TURN_NOT;
}

static double node(const film_mesh *mesh, const film_state *s, int32_t i) {
    if (s->leg_grading == GRADING_COARSE) {
        double f = (double)i / s->leg_nodes;
        return f * f * (3.0 - 2.0 * f);
    }
    return (s->direction > 0 ? mesh->loading_nodes : mesh->unloading_nodes)[s->leg_grading][i];
}

/* The line whose law serves now; of a damped law in flight, the one that serves where its dent has not opened yet. */
static film_line serving(const film_curve *curve, const film_state *s) {
    film_line line = s->line;
    if (s->branch == FILM_FREE && s->damper > 0.0 && curve->stage[0].damped) {
        line.branch = 0;
        line.damper = s->damper;
    }
    return line;
}

/* By how much nu is above the velocity outwards at which F is 0, nu + f/c: of the sign of F, and smooth where f and c go
 * to 0 together. Without damping nothing lets go, or takes hold, but at the dent's end. */
static double hold(const film_curve *curve, const film_state *s) {
    film_line line = serving(curve, s);
    double f, work, at = fmax(s->xi, SHALLOWEST), c = damping_at(curve, &line, at);
    if (!(c > 0.0)) return INFINITY;
    law_at(curve, &line, at, &f, &work);
    return fmin(s->nu + f / c, 1e300);
}

/* A contact that let go within its dent, and that the load turns back there: when F rises from 0 again. */
static double touches_again(const film_curve *curve, const film_state *s) {
    film_line within = s->line;
    double low = 0.0, high = -s->nu / s->load, f, work;
    within.branch = 0;
    within.damper = s->damper;
    for (int k = 0; k < HALVINGS; k++) {
        double t = 0.5 * (low + high), xi = s->xi + t * (s->nu + 0.5 * s->load * t);
        law_at(curve, &within, xi, &f, &work);
        if (total_force(&within, damping_at(curve, &within, xi), f, s->nu + s->load * t) > 0.0) high = t; else low = t;
    }
    return high;
}

static void free_line(const film_curve *curve, film_state *s) {
    double gap = s->xi_free - s->xi, p = s->load, nu = s->nu;
    s->line.phi = s->line.kappa = s->line.damping = 0.0;
    s->direction = 1;
    s->line_ends = ENDS_NEVER;
    s->tau_end = INFINITY;
    double square = nu * nu + 2.0 * p * gap, above = gap < 0.0 ? hold(curve, s) : INFINITY;
    int pressed = above < INFINITY && above > WITHIN * fabs(nu); /* within its dent: the support's velocity has changed */
    if (pressed || (gap <= 0.0 && (nu > 0.0 || (nu == 0.0 && p > 0.0)))) {
        s->tau_end = 0.0;
    } else if (p > 0.0 && !(square > 0.0)) {
        s->tau_end = touches_again(curve, s);
    } else if (p > 0.0) { /* falls, after rising if nu < 0 */
        s->tau_end = nu >= 0.0 ? 2.0 * gap / (nu + sqrt(square)) : (sqrt(square) - nu) / p;
    } else if (nu > 0.0 && square > 0.0) {
        s->tau_end = 2.0 * gap / (nu + sqrt(square));
    }
    if (!(s->tau_end < INFINITY)) return;
    s->line_ends = ENDS_EDGE;
    s->xi_end = gap < 0.0 && (pressed || !(square > 0.0 && p > 0.0 && nu < 0.0)) ? s->xi + s->tau_end * (nu + 0.5 * p * s->tau_end) : s->xi_free;
    s->nu_end = nu + p * s->tau_end;
}

/* The motion stops here, at once. */
static void end_here(film_state *s, int ends) {
    s->line.phi = s->elastic;
    s->line.kappa = s->line.damping = s->tau_end = 0.0;
    s->line_ends = ends;
    s->xi_end = s->xi;
    s->nu_end = s->nu;
    s->force_end = s->elastic;
    s->work_end = s->work;
}

/* What is left of the way out is rounding, and nothing pushes back. */
static void let_go(const film_curve *curve, film_state *s) {
    end_here(s, ENDS_EDGE);
    s->xi_end = limit_of(curve, s);
    law_at(curve, &s->line, s->xi_end, &s->force_end, &s->work_end);
    s->nu_end = fmin(s->nu, s->gamma * s->force_end);
}

/* The motion turns here. On the way out without a load only rounding turns it, and it starts again from rest, unless that
 * was tried. */
static void turn_here(const film_curve *curve, film_state *s) {
    if (s->direction < 0 && s->load <= 0.0 && s->xi == s->leg_from) let_go(curve, s);
    else end_here(s, ENDS_TURN);
}

/* Whether the line leads to the end of a branch that meets zero force at an angle: over-damped, it never gets there. */
static int ends_steeply(const film_state *s) {
    int out = s->line_ends == ENDS_EDGE && s->branch == FILM_BRANCH && s->direction < 0;
    return out && s->line.f_shift < 0.0 && s->gamma > 0.0;
}

/* The line over the next `length`, and the motion on it. Whatever its ends, it does the work of the law; chords do not. */
static motion draw(const film_curve *curve, const film_mesh *mesh, film_state *s, double length) {
    double h = s->direction * length, per_h = per_way(s, h);
    law_at(curve, &s->line, s->xi + h, &s->force_end, &s->work_end);
    double mean = mean_force(curve, s, h);
    int at_rest = s->from_turn && s->leg_node == 0;
    s->line.kappa = (s->force_end - s->elastic) * per_h;
    s->line.phi = mean - 0.5 * s->line.kappa * h;
    if (mesh->linearisation == FILM_CHORD) {
        s->line.phi = s->elastic;
    } else if (at_rest) { /* y = nu - gamma f is 0 there */
        s->line.phi = s->elastic;
        s->line.kappa = 2.0 * (mean - s->elastic) * per_h;
    } else if (s->line_ends == ENDS_NEVER || ends_steeply(s)) { /* balance where the law balances */
        s->line.kappa = 2.0 * (s->force_end - mean) * per_h;
        s->line.phi = 2.0 * mean - s->force_end;
    }
    s->line.damping = 0.0;
    if (damped(curve, s)) { /* its mean, and with that the velocity to weight it with */
        double tau, y = 0.0;
        s->line.damping = mean_damping(curve, s, h, 1.0, 1.0);
        motion rough = on_line(s, s->line.phi, s->line.kappa);
        if (at_rest) rough.y0 = 0.0;
        if (leave(&rough, length, &tau, &y) == LEFT && y > 0.0) {
            double nu = s->direction * y * (1.0 + s->gamma * s->line.damping) + s->gamma * (s->line.phi + s->line.kappa * h);
            y = fmax(speed_at(curve, s, s->xi + h, s->force_end, nu), 0.0);
        } else {
            y = 0.0;
        }
        double y0 = at_rest ? 0.0 : fmax(speed_at(curve, s, s->xi, s->elastic, s->nu), 0.0);
        if (y0 + y > 0.0) damp(curve, mesh, s, h, y0, y, 0);
    }
    motion m = on_line(s, s->line.phi, s->line.kappa);
    if (at_rest && fabs(m.y0) <= REST_SPEED * (fabs(s->nu) + s->gamma * s->elastic)) m.y0 = 0.0;
    return m;
}

static void land(film_state *s, double length, double y) {
    double h = s->direction * length;
    s->xi_end = s->xi + h;
    double yield = s->gamma * s->line.damping;
    s->nu_end = s->direction * y * (1.0 + yield) + s->gamma * (s->line.phi + s->line.kappa * h);
}

/* Whether the law lies below its chord over the next h: a flatter chord is to be had halfway. */
static int sags(const film_curve *curve, const film_state *s, double h) {
    double middle, work;
    law_at(curve, &s->line, s->xi + 0.5 * h, &middle, &work);
    return middle < 0.499999 * (s->elastic + s->force_end);
}

/* Without a load nothing turns the motion on the way out, but the line just drawn over `length` does, or ends with the motion
 * inwards: it begins with less force than the law's, or ends with more. One that is true to the law at that end leaves
 * outwards, or creeps for ever. */
static int push_out(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int left, double *y) {
    film_state drawn = *s;
    double h = s->direction * length;
    if (left == LEFT) {
        line_to_turn(curve, mesh, s, length, 1);
    } else {
        s->line.kappa = 2.0 * (mean_force(curve, s, h) - s->elastic) * per_way(s, h);
        s->line.phi = s->elastic;
    }
    motion m = on_line(s, s->line.phi, s->line.kappa);
    int now = leave(&m, length, &s->tau_end, y);
    if (now == LEFT) land(s, length, *y);
    else if (now == LEFT_NOT) *s = drawn;
    return now == LEFT_NOT ? left : now;
}

/* The next line of the leg: replaces the law from the current point to the next node. */
static int cut(const film_curve *curve, const film_mesh *mesh, film_state *s, double turn_tolerance) {
    int last = s->leg_node + 1 >= s->leg_nodes, at_rest = s->from_turn && s->leg_node == 0;
    int own_turn = at_rest || (mesh->linearisation == FILM_CHORD && s->gamma == 0.0 && !damped(curve, s));
    double d = s->direction, limit = limit_of(curve, s), x, y;
    double to = last ? s->leg_to : s->leg_from + (s->leg_to - s->leg_from) * node(mesh, s, s->leg_node + 1);
    double length = d * (to - s->xi), edge = d * (limit - s->xi);
    s->line_ends = last ? s->leg_ends : ENDS_NODE;
    if (!(edge > 0.0) && (s->line_ends == ENDS_TURN || s->line_ends == ENDS_NEVER)) {
        end_here(s, s->leg_ends = ENDS_EDGE);
        return FILM_OK;
    }
    if (s->line_ends == ENDS_TURN && !at_rest && length <= SHORT_TURN * fabs(s->xi)) { /* under one force */
        int nowhere = !(length > 0.0) && s->leg_to == s->leg_from;
        double speed = d * (s->nu - s->gamma * s->elastic), pull = d * (s->elastic - s->load);
        if (speed > 0.0 && (nowhere || speed * speed <= 2.0 * SHORT_TURN * pull * fabs(s->xi))) {
            end_here(s, ENDS_TURN);
            s->line.damping = damping_at(curve, &s->line, s->xi);
            motion m = on_line(s, s->elastic, 0.0);
            s->tau_end = pull > 0.0 ? turn_time(&m) : 0.0;
            s->nu_end = s->gamma * s->elastic;
            return FILM_OK;
        }
    }
    if (s->line_ends != ENDS_TURN || own_turn) {
        if (!(length > 0.0)) {
            end_here(s, s->line_ends);
            if (s->line_ends == ENDS_TURN) s->nu_end = s->gamma * s->elastic; /* its speed is rounding */
            return FILM_OK;
        }
        if (at_rest && s->line_ends == ENDS_TURN && s->gamma > 0.0) { /* no line is true to the law at rest and at a turn */
            length *= 0.5;
            s->line_ends = ENDS_PART;
        }
        motion m = draw(curve, mesh, s, length);
        int left = leave(&m, length, &s->tau_end, &y);
        if (left != LEFT && d < 0.0 && s->load <= 0.0 && damped(curve, s)) { /* it lets go on the way */
            s->line_ends = ENDS_NEVER;
            s->tau_end = INFINITY;
            return FILM_OK;
        }
        if (left == LEFT_NOT && m.y0 < 0.0 && d < 0.0 && s->load <= 0.0 && !at_rest) left = push_out(curve, mesh, s, length, left, &y);
        /* A line may dip below zero where the law only touches it, or as a chord be too steep, and would hold the contact
         * shut for ever. Without a load nothing does: go halfway, and again, until the law is flat enough to let go. And a
         * line from rest that turns on a target that gives way is not true to the law there: halfway, as before any turn. */
        for (int k = 0; left != LEFT && k < HALVINGS; k++) {
            if (d < 0.0 && s->load <= 0.0) {
                int dips = s->line.phi + s->line.kappa * d * length < -1e-12 * s->elastic;
                if (!dips && !(mesh->linearisation == FILM_CHORD && sags(curve, s, d * length))) break;
                double free = s->branch >= 0 ? 0.0 : s->xi_free;
                if (s->xi - free < CREPT * (s->xi_max - free)) {
                    left = LEFT_NEVER;
                    break;
                }
            } else if (left != LEFT_NOT || !at_rest || s->gamma == 0.0 || s->leg_grading == GRADING_COARSE) {
                break;
            }
            length *= 0.5;
            s->line_ends = ENDS_PART;
            if (d < 0.0 && s->load <= 0.0 && s->xi + d * length == s->xi) {
                let_go(curve, s);
                return FILM_OK;
            }
            m = draw(curve, mesh, s, length);
            left = leave(&m, length, &s->tau_end, &y);
        }
        if (left == LEFT) {
            if (s->line_ends == ENDS_TURN && y > TURN_SPEED * m.y0) s->line_ends = ENDS_NODE; /* later: plan afresh */
            land(s, length, s->line_ends == ENDS_TURN ? 0.0 : y);
            if (d < 0.0 && s->load <= 0.0 && s->nu_end > s->gamma * s->force_end) left = push_out(curve, mesh, s, length, left, &y);
        }
        if (left == LEFT) {
            if (s->line_ends != ENDS_PART) s->xi_end = to;
            if (s->line_ends == ENDS_TURN && turn_time(&m) < INFINITY) s->tau_end = turn_time(&m); /* y: root of rounding */
            return FILM_OK;
        }
        if (left == LEFT_NEVER) {
            s->line_ends = ENDS_NEVER;
            s->tau_end = INFINITY;
            return FILM_OK;
        }
        if (own_turn) { /* the line's own turn; on a chord as in the paper, with the law's force there */
            s->tau_end = turn_time(&m);
            if (!(m.y0 >= 0.0 && s->tau_end > 0.0 && s->tau_end < INFINITY)) {
                turn_here(curve, s);
                return FILM_OK;
            }
            move(&m, s->tau_end, &x, &y);
            s->line_ends = ENDS_TURN;
            land(s, x, 0.0);
            law_at(curve, &s->line, s->xi_end, &s->force_end, &s->work_end);
            s->nu_end = s->gamma * s->force_end;
            if (d < 0.0 && s->load <= 0.0 && s->xi_end == s->leg_from) let_go(curve, s);
            return FILM_OK;
        }
        length *= 0.5;
    }
    if (!(d * (s->nu - s->gamma * s->elastic) > 0.0)) {
        turn_here(curve, s);
        return FILM_OK;
    }
    if (!(length > 0.0)) length = 1e-3 * fabs(s->leg_to - s->leg_from);
    int turn = TURN_BETWEEN;
    const double guess = length;
    for (int plain = 0; turn == TURN_BETWEEN && plain <= damped(curve, s); plain++) {
        length = guess;
        turn = find_turn(curve, mesh, s, &length, edge, turn_tolerance, plain);
    }
    if (turn == TURN_BETWEEN && !(s->line.kappa > 0.0)) { /* lines turn at once, or run away: so does the law's, or it passes */
        s->leg_node = s->leg_nodes - 1;
        s->line_ends = ENDS_NODE; /* plan afresh */
        motion m = draw(curve, mesh, s, length);
        while (leave(&m, length, &s->tau_end, &y) != LEFT) { /* to rest where the force is none: halfway, and again */
            length *= 0.5;
            if (!(length > SHORT_TURN * fabs(s->xi))) {
                turn_here(curve, s);
                return FILM_OK;
            }
            m = draw(curve, mesh, s, length);
        }
        land(s, length, y);
        return FILM_OK;
    }
    if (turn != TURN_NOT) {
        s->line_ends = ENDS_TURN;
        s->xi_end = s->xi + d * length;
        s->nu_end = s->gamma * s->force_end;
        if (!(s->tau_end < INFINITY)) s->line_ends = ENDS_NEVER;
        return FILM_OK;
    }
    if (!(edge < INFINITY)) return FILM_BEYOND_LAW;
    line_to_turn(curve, mesh, s, edge, 0); /* it does not turn before the edge: this line was tried and passes it */
    motion m = on_line(s, s->line.phi, s->line.kappa);
    s->leg_node = s->leg_nodes - 1;
    s->leg_to = limit;
    s->leg_ends = s->line_ends = ENDS_EDGE;
    if (leave(&m, edge, &s->tau_end, &y) != LEFT) {
        s->tau_end = turn_time(&m);
        y = 0.0;
    }
    land(s, edge, y);
    s->xi_end = limit;
    return s->tau_end < INFINITY ? FILM_OK : FILM_BEYOND_LAW;
}

/* The impactor stops on the line just cut: end the line there, as at a node. A length is sought over which the line
 * brings nu down to stop_velocity: Newton's method with dnu/dxi = (load - phi)/y. */
static void cut_at_stop(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    film_state whole = *s;
    double full = s->direction * (s->xi_end - s->xi), low = 0.0, high = full, y = 0.0;
    double part = (s->nu - s->stop_velocity) / (s->nu - s->nu_end);
    int at_rest = s->from_turn && s->leg_node == 0; /* the way grows as the square of time, and nu falls with its root */
    double length = at_rest ? full * part * part : full * part;
    s->line_ends = ENDS_STOP;
    for (int k = 0; k < TURN_ITERATIONS; k++) {
        motion m = draw(curve, mesh, s, length);
        if (leave(&m, length, &s->tau_end, &y) != LEFT) { /* it does not get as far */
            high = length;
            length = 0.5 * (low + high);
            continue;
        }
        land(s, length, y);
        double excess = s->nu_end - s->stop_velocity, phi = s->line.phi + s->line.kappa * s->direction * length;
        phi += s->line.damping * s->direction * y;
        if (excess > 0.0) low = length; else high = length;
        double step = excess * y / (phi - s->load), root = 1.0 + 0.5 * step / length;
        double next = !at_rest ? length + step : root > 0.0 ? length * root * root : 0.0;
        if (!(next > low && next < high) || k > NEWTON_STEPS) next = 0.5 * (low + high);
        if (fabs(next - length) <= (at_rest ? 1e-12 * length : 1e-14 * full)) {
            if (fabs(excess) > 1e-6 * (whole.nu - whole.nu_end)) break; /* only the line that meets the turn stops */
            /* next to a turn the way is known less well than the time */
            double late = excess / (phi - s->load);
            if (fabs(late) < 0.5 * s->tau_end) s->tau_end += late;
            s->nu_end = s->stop_velocity;
            return;
        }
        length = next;
    }
    *s = whole;
}

/* F of the true law at xi, a little within where the dent ends: there f and c are both 0. */
static double holding_force(const film_curve *curve, const film_state *s, double xi, double nu) {
    double f, work, at = fmax(xi, WITHIN * s->leg_from);
    law_at(curve, &s->line, at, &f, &work);
    return total_force(&s->line, damping_at(curve, &s->line, at), f, nu);
}

static int lets_go_between(const film_curve *curve, const film_state *s) {
    double values[5];
    for (int k = 0; k < GAUSS; k++) {
        film_evaluate(curve, &s->line, GAUSS_AT[k] * s->tau_end, values);
        if (holding_force(curve, s, values[0], values[3]) < 0.0) return 1;
    }
    return 0;
}

/* A damped contact ends when F falls to 0 on the way out: if it does so on the line just cut, end the line there. The
 * length is sought over which the line brings it to 0. */
static void cut_at_release(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    film_state whole = *s;
    double d = s->direction, low = 0.0, above = holding_force(curve, s, s->xi, s->nu), y;
    int never = s->line_ends == ENDS_NEVER;
    if (!(above > 0.0) && d * (s->nu - s->gamma * s->elastic) > 0.0) {
        end_here(s, ENDS_RELEASE);
        return;
    }
    double high = d * ((never ? s->leg_to : s->xi_end) - s->xi);
    double below = never ? NAN : holding_force(curve, s, s->xi_end, s->nu_end), length = 0.5 * high;
    if (!(high > 0.0) || (never && s->load > 0.0)) return;
    if (!never && below >= 0.0 && !(s->load > 0.0 && lets_go_between(curve, s))) return;
    double full = high;
    int seen = !never; /* a force that has fallen to 0 */
    s->line_ends = ENDS_RELEASE;
    for (int k = 0; k < RELEASE_ITERATIONS; k++) {
        motion m = draw(curve, mesh, s, length);
        int left = leave(&m, length, &s->tau_end, &y);
        if (left == LEFT) land(s, length, y);
        /* it does not get as far, or only with a force that is not the law's, which would turn the motion from there */
        if (left != LEFT || (!seen && s->load <= 0.0 && s->nu_end > 2.0 * s->gamma * s->force_end)) {
            high = length;
            below = NAN;
            length = 0.5 * (low + high);
            continue;
        }
        double force = holding_force(curve, s, s->xi_end, s->nu_end);
        if (!(force > 0.0) && s->xi + d * length == s->xi) {
            end_here(s, ENDS_RELEASE);
            return;
        }
        if (force > 0.0) {
            low = length;
            above = force;
            if (k % 3 == 2) below *= 0.5;
        } else {
            high = length;
            below = force;
            seen = 1;
            if (k % 3 == 2) above *= 0.5;
        }
        if (!seen && k >= 8) { /* it only creeps, on lines too long for the law: a part of the way, and on */
            s->line_ends = ENDS_PART;
            if (s->xi < CREPT * s->xi_max || s->tau_end * CREPT > 1.0) {
                s->line_ends = ENDS_NEVER;
                s->tau_end = INFINITY;
            }
            return;
        }
        double next = low + (high - low) * above / (above - below);
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - length) <= 1e-14 * full || high - low <= 1e-15 * full) return;
        length = next;
    }
    *s = whole;
}

/* What damping took over the first tau of the line, at whose end the impactor is at xi with nu and the law's work is
 * `work`: the energy that is gone and neither stored nor radiated, gamma F^2 dt. */
static double dissipated(const film_line *line, double tau, double xi, double nu, double work) {
    if (line->damper == 0.0) return 0.0;
    double gamma = line->gamma, moved = gamma * (line->load * tau - (nu - line->nu)), radiated = 0.0, x, y;
    double gone = 0.5 * (line->nu - nu) * (line->nu + nu) + line->load * (xi - line->xi + moved) - (work - line->work);
    if (gamma == 0.0) return gone;
    double c = line->damping, per_m = 1.0 / (1.0 + gamma * c);
    motion m = {(line->nu - gamma * line->phi) * per_m, (line->phi - line->load) * per_m, line->kappa * per_m,
                0.5 * (line->kappa * gamma + c) * per_m};
    for (int k = 0; k < GAUSS; k++) {
        move(&m, GAUSS_AT[k] * tau, &x, &y);
        double force = line->phi + line->kappa * x + c * y;
        radiated += GAUSS_WEIGHT[k] * force * force;
    }
    return gone - gamma * radiated * tau;
}

/* To the end of the current line. */
static void follow(film_state *s) {
    s->shift = s->line.shift + s->gamma * (s->load * s->tau_end - (s->nu_end - s->line.nu));
    s->spent = s->line.spent + (s->work_end - s->line.work) + dissipated(&s->line, s->tau_end, s->xi_end, s->nu_end, s->work_end);
    s->xi = s->xi_end;
    s->nu = s->nu_end;
    s->elastic = s->force_end;
    s->work = s->work_end;
    if (s->elastic > s->force_peak) s->force_peak = s->elastic;
    s->leg_node += s->line_ends != ENDS_PART && s->line_ends != ENDS_STOP && s->line_ends != ENDS_RELEASE;
}

/* ---------------------------------------------------------------- legs */

/* Kinetic energy left at xi when the target does not move. */
static double energy_at(const film_curve *curve, const film_line *run, double energy, double load, double xi,
                        double *slope) {
    double force, work;
    law_at(curve, run, xi, &force, &work);
    *slope = load - force;
    return energy - work + load * xi;
}

int film_turning_point(const film_curve *curve, const film_line *run, double xi, double work, double nu, double load,
                       double limit, double *to) {
    double energy = 0.5 * nu * nu, total = energy + work - load * xi, slope, inner = xi, outer = limit, at = limit;
    if (limit < INFINITY) {
        double left = energy_at(curve, run, total, load, limit, &slope);
        if (left >= 0.0) {
            *to = limit;
            return FILM_OK;
        }
        if (energy > 0.0) at = xi + (limit - xi) * sqrt(energy / (energy - left)); /* as if work grew as a square */
    } else {
        const film_piece *piece = piece_at(curve, run->branch, INFINITY);
        const film_function *g = &piece->force;
        double reach = INFINITY;
        if (g->coefficient > 0.0 && g->slope >= 0.0 && g->constant >= 0.0 && load <= 0.0 && curve->compliance == 0.0)
            reach = pow((g->exponent + 1.0) * (total + piece->work_at_begin) / g->coefficient, work_of(g->exponent));
        outer = reach < INFINITY ? g->origin + reach * (1.0 + 1e-12) : xi + 1.0;
        for (int k = 0; energy_at(curve, run, total, load, outer, &slope) > 0.0; k++) {
            if (k >= DOUBLINGS || !(outer < 1e300)) return FILM_BEYOND_LAW;
            inner = outer;
            outer = xi + 2.0 * (outer - xi);
        }
        at = outer;
    }
    double d = outer > inner ? 1.0 : -1.0;
    for (int k = 0; k < ROOT_ITERATIONS; k++) { /* Newton; halving guards it */
        energy = energy_at(curve, run, total, load, at, &slope);
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
    int status = film_turning_point(curve, &s->line, s->xi, s->work, s->nu, s->load, limit_of(curve, s), &s->leg_to);
    s->leg_ends = status == FILM_EVENT ? ENDS_TURN : ENDS_EDGE;
    return status < 0 ? status : FILM_OK;
}

/* Where the true law balances the load, from the current point towards the end of the leg, and maybe beyond; `otherwise`
 * if it never does. */
static double balance(const film_curve *curve, const film_state *s, double otherwise) {
    double low = s->xi, high = s->leg_to, limit = limit_of(curve, s), force, work;
    double side = s->elastic - s->load;
    if (side == 0.0) return high; /* no force where it begins, and damping alone slows the motion: the balance is everywhere */
    for (int k = 0; k < DOUBLINGS && high != limit; k++) {
        law_at(curve, &s->line, high, &force, &work);
        if (!(side > 0.0 ? force > s->load : force < s->load)) break;
        high = limit < INFINITY ? limit : s->xi + 2.0 * (high - s->xi);
    }
    if (!(high < INFINITY)) return otherwise;
    for (int k = 0; k < 100; k++) {
        double middle = 0.5 * (low + high);
        law_at(curve, &s->line, middle, &force, &work);
        if (side > 0.0 ? force > s->load : force < s->load) low = middle; else high = middle;
    }
    return high;
}

/* Where a leg on a compliant target ends, from trial legs of 1, 4, 16 ... segments, each aimed by the one before. */
static int aim_by_trial(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    double limit = s->leg_to; /* until the aim is taken */
    if (!(limit < INFINITY)) {
        film_state still = *s; /* a fixed target stops the impactor later than one that gives way */
        int status = aim_by_energy(curve, &still);
        if (status < 0) return status;
        s->leg_to = still.leg_to;
        s->leg_ends = ENDS_TURN;
    }
    for (int32_t nodes = 1; nodes == 1 || 3 * nodes <= s->leg_nodes; nodes *= 4) {
        film_state trial = *s;
        trial.leg_nodes = nodes;
        trial.leg_grading = GRADING_COARSE;
        if (nodes == 1) trial.leg_ends = s->from_turn ? ENDS_EDGE : ENDS_TURN;
        for (int k = 0; k < 4 * nodes + 4; k++) {
            int status = cut(curve, mesh, &trial, TRIAL_TURN_TOLERANCE);
            if (status < 0) return status;
            if (trial.line_ends != ENDS_NODE) break;
            if (trial.leg_node >= trial.leg_nodes - 1) break;
            follow(&trial);
        }
        s->leg_ends = trial.line_ends == ENDS_NODE ? ENDS_TURN : trial.line_ends;
        s->leg_to = s->leg_ends == ENDS_EDGE ? limit : s->leg_ends == ENDS_NEVER ? balance(curve, s, trial.xi_end) : trial.xi_end;
        if (s->leg_ends == ENDS_EDGE && limit < INFINITY) break;
        if (s->leg_ends == ENDS_EDGE) { /* further than a fixed target, on so few lines */
            s->leg_ends = ENDS_TURN;
            s->leg_to = trial.xi_end;
        }
    }
    return FILM_OK;
}

/* The contact turns on the loading curve: remember the spot, and take the branch that leads back. */
static int remember(const film_curve *curve, film_state *s) {
    s->xi_max = s->xi;
    s->f_max = s->elastic;
    s->stage_max = s->branch;
    s->line.branch = s->branch;
    int status = open_branch(curve, &s->line, s->xi, s->elastic);
    if (status < 0 || s->line.branch == s->branch) return status;
    s->branch = FILM_BRANCH;
    s->loop = LOOP_NONE;
    s->xi_free = s->line.xi_free;
    s->recovery = s->xi - curve->compliance * s->elastic - s->xi_free;
    s->exponent = s->line.exponent;
    s->xi_origin = s->line.xi_origin;
    s->f_scale = s->line.f_max;
    s->f_shift = s->line.f_shift;
    s->work_free = s->line.work_free;
    double force;
    law_at(curve, &s->line, s->xi, &force, &s->work);
    return FILM_OK;
}

/* The piece from (a, f_a) to (b, f_b) of ((xi - origin)/span)^q, stretched and shifted in force; a and b are the march's. */
static void stretch(const film_curve *curve, film_line *line, double origin, double span, double q, double a, double f_a, double b,
                    double f_b) {
    a -= curve->compliance * f_a;
    b -= curve->compliance * f_b;
    double low = raised(fmax((a - origin) / span, 0.0), q); /* a contact about to end may be beyond its end by rounding */
    line->xi_origin = origin;
    line->per_recovery = 1.0 / span;
    line->exponent = q;
    line->f_max = (f_b - f_a) / (raised((b - origin) / span, q) - low);
    line->f_shift = f_a - line->f_max * low;
    line->work_free = 0.0;
}

static double reload_exponent(const film_curve *curve, const film_state *s) {
    return s->stage_max >= 0 ? curve->stage[s->stage_max].reload_exponent : 0.0;
}

/* What all lines of a run share, and what each begins with. */
static void open_run(const film_curve *curve, film_state *s) {
    film_line *line = &s->line;
    line->load = s->load;
    line->gamma = s->gamma;
    line->xi_free = s->xi_free;
    double span = s->xi_max - curve->compliance * s->f_max - s->xi_origin;
    line->per_recovery = s->recovery > 0.0 ? 1.0 / span : 0.0;
    line->f_max = s->f_scale;
    line->exponent = s->exponent;
    line->xi_origin = s->xi_origin;
    line->f_shift = s->f_shift;
    line->work_free = s->work_free;
    if (s->branch == FILM_BRANCH && s->loop == LOOP_RELOAD)
        stretch(curve, line, s->xi_free, s->recovery, reload_exponent(curve, s), s->xi_in, s->f_in, s->xi_max, s->f_max);
    if (s->branch == FILM_BRANCH && s->loop == LOOP_INNER)
        stretch(curve, line, s->xi_origin, span, s->exponent, s->xi_in, s->f_in, s->xi_out, s->f_out);
    line->branch = s->branch;
    line->phase = s->phase;
    line->damper = damped(curve, s) ? s->damper : 0.0;
}

/* From the current point on along another branch of the same force. */
static void change_loop(const film_curve *curve, film_state *s, int32_t loop) {
    s->loop = loop;
    open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
}

/* A law that reloads on its own leaves the branch it has turned on, but for a way too short to tell. */
static void choose_loop(const film_curve *curve, film_state *s) {
    if (s->branch != FILM_BRANCH || reload_exponent(curve, s) == 0.0) return;
    if (s->direction > 0 && s->loop == LOOP_NONE && s->xi_max - s->xi > SMALL_LOOP * s->recovery) {
        s->xi_in = s->xi;
        s->f_in = s->elastic;
        change_loop(curve, s, LOOP_RELOAD);
    } else if (s->direction < 0 && s->loop == LOOP_RELOAD && s->xi - s->xi_in > SMALL_LOOP * s->recovery) {
        s->xi_out = s->xi;
        s->f_out = s->elastic;
        change_loop(curve, s, LOOP_INNER);
    }
}

static void open_line(film_state *s) {
    film_line *line = &s->line;
    line->time = s->time;
    line->xi = s->xi;
    line->nu = s->nu;
    line->shift = s->shift;
    line->work = s->work;
    line->spent = s->spent;
}

/* The force of the law at xi, beside the current point: loading, of the stage that serves there. */
static double force_beside(const film_curve *curve, const film_state *s, double xi) {
    film_line line = s->line;
    double force, work;
    while (line.branch > 0 && xi < curve->stage[line.branch].begin) line.branch--;
    while (line.branch >= 0 && line.branch + 1 < curve->stages && xi > curve->stage[line.branch].end) line.branch++;
    law_at(curve, &line, xi, &force, &work);
    return force;
}

/* A leg so short, and so close to balance, that the law is straight: one line for all time to come, in either direction.
 * 1 if it was drawn. Where two stages meet of which one is far steeper it would pull; there only a leg between numbers that
 * can hardly be told apart comes to rest. */
static int rest(const film_curve *curve, film_state *s, double depth) {
    double least = NEIGHBOURS * fabs(s->xi), reach = fmax(REST_LENGTH * depth, least), length = fabs(s->leg_to - s->leg_from);
    if (s->leg_ends == ENDS_EDGE || length >= reach) return 0;
    double f_low = force_beside(curve, s, s->xi - 2.0 * reach), f_high = force_beside(curve, s, s->xi + 2.0 * reach);
    double kappa = (f_high - f_low) / (4.0 * reach), damping = damping_at(curve, &s->line, s->xi);
    double y = s->nu - s->gamma * s->elastic, excess = s->elastic - s->load;
    double swing = length < least ? 0.0 : sqrt(excess * excess + kappa * (1.0 + s->gamma * damping) * y * y);
    if (!(swing < s->load - f_low && swing < f_high - s->load)) return 0;
    open_line(s);
    s->line.phi = s->elastic;
    s->line.kappa = kappa;
    s->line.damping = damping;
    s->line_ends = ENDS_NEVER;
    s->tau_end = INFINITY;
    s->phase = s->line.phase = FILM_RESTING;
    return 1;
}

/* Direction, number of nodes and end of the run that starts here. FILM_EVENT: the direction has changed. */
static int plan(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    open_run(curve, s);
    if (s->branch == FILM_FREE) return FILM_OK;
    double y = s->nu - s->gamma * s->elastic, excess = s->elastic - s->load;
    if (!s->from_turn) {
        int at_rest = fabs(y) <= REST_SPEED * (fabs(s->nu) + s->gamma * s->elastic);
        int direction = at_rest ? (excess < 0.0 ? 1 : -1) : (y > 0.0 ? 1 : -1);
        int turned = s->branch >= 0 && s->direction > 0 && direction < 0 && s->xi > 0.0 && s->xi >= s->xi_max;
        int reversed = s->jumped && direction != s->direction;
        s->from_turn = at_rest;
        s->direction = direction;
        s->jumped = 0;
        if (turned) {
            int status = remember(curve, s);
            s->event = FILM_MAXIMUM_INDENTATION;
            s->phase = FILM_UNLOADING;
            return status < 0 ? status : FILM_EVENT;
        }
        s->phase = direction < 0 ? FILM_UNLOADING : s->branch == FILM_BRANCH ? FILM_RELOADING : FILM_LOADING;
        if (reversed) {
            s->event = direction > 0 ? FILM_RELOADING_BEGINS : FILM_MAXIMUM_INDENTATION;
            return FILM_EVENT;
        }
    }
    choose_loop(curve, s);
    open_run(curve, s);
    double depth = s->branch == FILM_BRANCH ? s->recovery : s->xi;
    s->leg_from = s->xi;
    s->leg_node = 0;
    s->leg_nodes = s->direction > 0 ? mesh->loading : mesh->unloading;
    s->leg_to = limit_of(curve, s);
    s->leg_ends = ENDS_EDGE;
    if (s->direction > 0 || s->load > 0.0) { /* or nothing stops it before contact ends */
        int status = s->gamma == 0.0 && !damped(curve, s) ? aim_by_energy(curve, s) : aim_by_trial(curve, mesh, s);
        if (status < 0) return status;
    }
    if (rest(curve, s, fmin(depth, fabs(s->xi - s->xi_free)))) return FILM_OK;
    if (mesh->linearisation == FILM_CHORD) {
        s->leg_grading = FILM_EQUAL;
    } else if (s->gamma == 0.0) {
        s->leg_grading = FILM_COSINE;
    } else {
        double slowness = s->direction > 0 ? 0.0 : s->gamma * sqrt(s->f_max / depth);
        s->leg_grading = s->direction > 0 ? FILM_PLATE_IN : film_grading(slowness);
        /* a dashpot's force bends most where the indentation is none */
        if (damped(curve, s)) s->leg_grading = slowness < 1.75 ? FILM_COSINE : FILM_PLATE_CREEP;
    }
    if (s->direction < 0) s->leg_nodes = film_unloading(mesh, s->leg_grading);
    s->has_leg = 1;
    return FILM_OK;
}

static int stopped(film_state *s) {
    s->moving_in = 0;
    s->event = FILM_IMPACTOR_STOPS;
    return FILM_EVENT;
}

/* A line to march on, whatever came before. */
static int prepare(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    if (s->moving_in && s->nu <= s->stop_velocity) return stopped(s);
    if (!s->has_leg) {
        int status = plan(curve, mesh, s);
        if (status != FILM_OK) return status;
    }
    if (s->branch == FILM_FREE) {
        open_line(s);
        free_line(curve, s);
    } else if (s->has_leg) {
        open_line(s);
        int status = cut(curve, mesh, s, TURN_TOLERANCE);
        if (status < 0) return status;
        if (s->direction < 0 && damped(curve, s)) cut_at_release(curve, mesh, s);
    }
    s->tau = s->tau_low = 0.0;
    if (s->moving_in && s->branch != FILM_FREE && s->tau_end < INFINITY && s->nu_end < s->stop_velocity)
        cut_at_stop(curve, mesh, s);
    s->has_line = 1;
    s->lines++;
    return FILM_OK;
}

/* F at the current point. */
static double holding(const film_curve *curve, const film_state *s) {
    if (s->branch == FILM_FREE) return 0.0;
    return fmax(total_force(&s->line, damping_at(curve, &s->line, s->xi), s->elastic, s->nu), 0.0);
}

/* dF/dt at xi and nu. */
static double force_rate(const film_curve *curve, const film_state *s, double xi, double nu) {
    film_contact at = film_force(curve, s, xi, nu);
    return at.by_xi * (nu - s->gamma * at.force) + at.by_nu * (s->load - at.force);
}

/* dF/dt, and F, where a line drawn over `length` from the current point ends; values at ends are better than between. */
static double rate_after(const film_curve *curve, const film_mesh *mesh, const film_state *s, double length, double *force) {
    film_state trial = *s;
    double y;
    trial.line_ends = ENDS_PART;
    motion m = draw(curve, mesh, &trial, length);
    if (leave(&m, length, &trial.tau_end, &y) != LEFT) return -INFINITY; /* it turns before */
    land(&trial, length, y);
    *force = holding_force(curve, &trial, trial.xi_end, trial.nu_end);
    return force_rate(curve, &trial, trial.xi_end, trial.nu_end);
}

/* With damping F is largest before the motion turns: the largest on the line just walked, sought in the half where F rises
 * first and falls then. */
static void raise_peak(const film_curve *curve, const film_mesh *mesh, const film_state *walked, double *peak) {
    film_state s = *walked;
    double values[5], force = 0.0;
    film_evaluate(curve, &s.line, 0.5 * s.tau_end, values);
    double before = force_rate(curve, &s, s.line.xi, s.line.nu), middle = force_rate(curve, &s, values[0], values[3]);
    double after = force_rate(curve, &s, s.xi_end, s.nu_end), half = s.direction * (values[0] - s.line.xi);
    int first = before >= 0.0 && middle < 0.0;
    if (!first && !(middle >= 0.0 && after < 0.0)) return;
    double low = first ? 0.0 : half, high = first ? half : s.direction * (s.xi_end - s.line.xi), full = high;
    double rise = first ? before : middle, fall = first ? middle : after, length = 0.5 * (low + high);
    s.xi = s.line.xi;
    s.nu = s.line.nu;
    s.work = s.line.work;
    law_at(curve, &s.line, s.xi, &s.elastic, &values[0]);
    for (int k = 0; k < PEAK_ITERATIONS; k++) {
        double rate = rate_after(curve, mesh, &s, length, &force);
        *peak = fmax(*peak, force);
        if (rate > 0.0) {
            low = length;
            rise = rate;
            if (k % 3 == 2) fall *= 0.5;
        } else {
            high = length;
            fall = rate;
            if (k % 3 == 2) rise *= 0.5;
        }
        double next = low + (high - low) * rise / (rise - fall);
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (fabs(next - length) <= PEAK_TOLERANCE * full) return;
        length = next;
    }
}

/* What rounding makes of one force where `stage` begins: SAME_FORCE of the largest number it is made of. */
static double force_rounding(const film_curve *curve, const film_state *s, int32_t stage) {
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    return SAME_FORCE * fmax(s->force_peak, fmax(fabs(g->constant), fabs(g->series[0])));
}

/* The same where the current point is on the edge of two stages, or where a branch meets the loading curve; 0 elsewhere. */
static double meeting(const film_curve *curve, const film_state *s) {
    double reach = NEIGHBOURS * fabs(s->xi);
    if (s->branch == FILM_BRANCH) return fabs(s->xi - s->xi_max) <= reach ? force_rounding(curve, s, s->stage_max) : 0.0;
    for (int32_t k = s->branch; k <= s->branch + 1 && k < curve->stages; k++)
        if (k > 0 && fabs(s->xi - curve->stage[k].begin) <= reach) return force_rounding(curve, s, k);
    return 0.0;
}

/* What follows when a line has been walked to its end: the next line, leg, stage or branch. */
static int finish(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    int ends = s->line_ends, status = FILM_OK;
    if (s->branch == FILM_FREE) {
        s->xi = s->xi_end;
        s->nu = s->nu_end;
    } else {
        double peak = s->force_peak;
        if (s->line.damper > 0.0 && s->direction > 0 && mesh != NULL) raise_peak(curve, mesh, s, &peak);
        follow(s);
        s->force_peak = fmax(peak, s->force_peak);
    }
    s->has_line = 0;
    if (s->nu > s->stop_velocity) s->moving_in = 1;
    s->event = FILM_NO_EVENT;
    s->from_turn = ends == ENDS_TURN;
    s->force = holding(curve, s);
    s->force_peak = fmax(s->force_peak, s->force);
    if (ends == ENDS_STOP) return stopped(s);
    if (ends == ENDS_PART || (ends == ENDS_NODE && s->leg_node < s->leg_nodes)) return FILM_OK;
    s->has_leg = 0;
    int pushed_out = s->direction < 0 && s->elastic >= fmax(s->load, 0.0) && !(s->load > 0.0 && s->xi == s->leg_from);
    if (ends == ENDS_TURN && pushed_out && mesh != NULL) { /* its speed is rounding: nothing turns it here */
        s->nu = s->gamma * s->elastic;
    } else if (ends == ENDS_TURN) {
        s->event = s->direction > 0 ? FILM_MAXIMUM_INDENTATION : FILM_RELOADING_BEGINS;
        if (s->direction > 0 && s->branch >= 0) status = remember(curve, s);
        s->direction = -s->direction;
        s->phase = s->direction < 0 ? FILM_UNLOADING : s->branch == FILM_BRANCH ? FILM_RELOADING : FILM_LOADING;
    } else if (ends == ENDS_EDGE && s->branch == FILM_FREE) {
        s->contacts++;
        s->force_peak = 0.0;
        s->event = FILM_CONTACT_BEGINS;
        s->direction = 1;
        s->branch = s->stage_max >= 0 && curve->stage[s->stage_max].unloading != FILM_RETRACE ? FILM_BRANCH : 0;
        s->phase = s->branch == FILM_BRANCH ? FILM_RELOADING : FILM_LOADING;
        s->loop = s->branch == FILM_BRANCH && reload_exponent(curve, s) > 0.0 ? LOOP_RELOAD : LOOP_NONE;
        s->xi_in = s->xi_free;
        s->f_in = 0.0;
        open_run(curve, s);
        law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
        s->force = s->force_peak = holding(curve, s);
        if (s->xi > s->xi_free) s->direction = s->nu > s->gamma * s->elastic ? 1 : -1;
        else if (s->elastic > 0.0 && s->nu < s->gamma * s->elastic) return FILM_TOO_STIFF;
    } else if (ends == ENDS_EDGE && s->branch == FILM_BRANCH && s->loop == LOOP_INNER && s->direction > 0) {
        change_loop(curve, s, LOOP_RELOAD);
    } else if (ends == ENDS_EDGE && s->branch == FILM_BRANCH && s->loop != LOOP_NONE && s->direction < 0 &&
               s->xi_in > s->xi_free) {
        change_loop(curve, s, LOOP_NONE);
    } else if (ends == ENDS_RELEASE || (ends == ENDS_EDGE && s->direction < 0 && s->branch <= 0)) {
        s->event = FILM_CONTACT_ENDS;
        s->branch = FILM_FREE;
        s->phase = FILM_SEPARATED;
        s->force = s->elastic = s->work = 0.0;
    } else if (ends == ENDS_EDGE) {
        s->event = FILM_STAGE_CHANGES;
        double before = s->elastic;
        if (s->direction < 0) s->branch--;
        else if (s->branch != FILM_BRANCH) s->branch++;
        else s->branch = s->xi >= curve->stage[s->stage_max].end ? s->stage_max + 1 : s->stage_max;
        if (s->branch >= curve->stages) return FILM_BEYOND_LAW;
        if (s->direction > 0) s->phase = FILM_LOADING;
        open_run(curve, s);
        law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
        s->force = s->elastic; /* a damped law has one stage */
        /* the last line's force was another; and what rounding makes of the two stages' would send it in again */
        if (pushed_out && mesh != NULL) {
            int same = before - s->elastic <= force_rounding(curve, s, s->branch + 1);
            s->nu = fmin(s->nu, s->gamma * (same ? s->elastic : before));
        }
    }
    if (status < 0) return status;
    return s->event == FILM_NO_EVENT ? FILM_OK : FILM_EVENT;
}

/* ---------------------------------------------------------------- what the header promises */

static void add(double *sum, double *low, double x) { /* x >= 0, with the remainder that rounding drops */
    double t = fmax(*sum, *sum + (x + *low)); /* never less, though the remainder be just half of the last digit */
    *low = (*sum - t) + (x + *low);
    *sum = t;
}

/* The state on a line, tau after its beginning, in the march's own xi and shift. */
static void evaluate(const film_curve *curve, const film_line *line, double tau, double values[5]) {
    double yield = 1.0 + line->gamma * line->damping, per_m = 1.0 / yield, x, y, work;
    motion m = {(line->nu - line->gamma * line->phi) * per_m, (line->phi - line->load) * per_m, line->kappa * per_m,
                0.5 * (line->kappa * line->gamma + line->damping) * per_m};
    move(&m, tau, &x, &y);
    double nu = y * yield + line->gamma * (line->phi + line->kappa * x);
    values[0] = line->xi + x;
    law_at(curve, line, values[0], &values[2], &work);
    if (line->damper > 0.0) values[2] = fmax(total_force(line, damping_at(curve, line, values[0]), values[2], nu), 0.0);
    values[1] = nu - line->gamma * values[2];
    values[3] = nu;
    values[4] = line->shift + (line->branch == FILM_FREE ? 0.0 : line->gamma * (line->load * tau - (nu - line->nu)));
}

/* From the march's own values to the true ones: the spring's deflection belongs to the target. */
static void part(const film_curve *curve, const film_line *line, double values[5]) {
    double bent = curve->compliance * values[2];
    if (curve->compliance == 0.0 || line->branch == FILM_FREE) return;
    values[1] *= 1.0 - curve->compliance * law_slope(curve, line, values[0]);
    values[0] -= bent;
    values[4] += bent;
}

void film_evaluate(const film_curve *curve, const film_line *line, double tau, double values[5]) {
    double x[5];
    evaluate(curve, line, tau, x);
    part(curve, line, x);
    memcpy(values, x, sizeof x);
}

void film_motion(const film_curve *curve, const film_state *s, double values[5]) {
    double x[5] = {s->xi, s->nu - s->gamma * s->force, s->force, s->nu, s->shift};
    film_state at = *s;
    open_run(curve, &at);
    part(curve, &at.line, x);
    memcpy(values, x, sizeof x);
}

/* The current point, tau along the line. */
static void stand(const film_curve *curve, film_state *s, double tau) {
    double values[5];
    evaluate(curve, &s->line, tau, values);
    s->xi = values[0];
    s->nu = values[3];
    s->shift = values[4];
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = values[2];
    s->spent = s->line.spent + (s->work - s->line.work) + dissipated(&s->line, tau, s->xi, s->nu, s->work);
}

/* Forward by *dt at most, within one line; *dt becomes what is left. */
static int advance(const film_curve *curve, const film_mesh *mesh, film_state *s, double *dt) {
    double left = (s->tau_end - s->tau) - s->tau_low;
    if (*dt < left) {
        add(&s->tau, &s->tau_low, *dt);
        add(&s->time, &s->time_low, *dt);
        *dt = 0.0;
        stand(curve, s, s->tau);
        s->event = FILM_NO_EVENT;
        return FILM_OK;
    }
    if (left == INFINITY) return FILM_ENDLESS;
    if (left > 0.0) {
        add(&s->time, &s->time_low, left);
        *dt -= left;
    }
    return finish(curve, mesh, s);
}

static int ready(const film_mesh *mesh, const film_state *s) {
    if (mesh->loading < 1 || mesh->unloading < 1 || mesh->loading > FILM_MAX_SEGMENTS ||
        mesh->unloading > FILM_MAX_SEGMENTS)
        return FILM_BAD_MESH;
    return isfinite(s->xi) && isfinite(s->nu) && isfinite(s->load) ? FILM_OK : FILM_BAD_NUMBER;
}

int film_step(const film_curve *curve, const film_mesh *mesh, film_state *s, double dt) {
    int status = dt >= 0.0 ? ready(mesh, s) : FILM_BAD_NUMBER;
    for (int32_t k = 0; status == FILM_OK; k++) {
        if (k >= FILM_MAX_STEP_LINES) return FILM_TOO_MANY;
        if (!s->has_line) status = prepare(curve, mesh, s);
        if (status != FILM_OK) break;
        status = advance(curve, mesh, s, &dt);
        if (status == FILM_OK && dt == 0.0) return FILM_OK;
    }
    return status;
}

int film_record(const film_curve *curve, const film_mesh *mesh, film_state *s, double time_limit, film_line *lines,
                int32_t line_room, int32_t *line_count, film_state *events, int32_t event_room, int32_t *event_count) {
    double dt = time_limit - s->time;
    int status = dt >= 0.0 ? ready(mesh, s) : FILM_BAD_NUMBER;
    *line_count = *event_count = 0;
    while (status >= 0) {
        if (!s->has_line) {
            status = prepare(curve, mesh, s);
            if (status == FILM_OK) {
                if (*line_count >= line_room) return FILM_FULL;
                lines[(*line_count)++] = s->line;
            }
        }
        if (status == FILM_OK) {
            status = advance(curve, mesh, s, &dt);
            if (status == FILM_ENDLESS || (status == FILM_OK && dt == 0.0)) return status;
        }
        if (status == FILM_EVENT) {
            if (*event_count >= event_room) return FILM_FULL;
            events[(*event_count)++] = *s;
            if (s->event == FILM_CONTACT_ENDS) {
                s->line.time = s->time; /* the flight that follows, for those who ask beyond the end */
                if (prepare(curve, mesh, s) == FILM_OK && *line_count < line_room) lines[(*line_count)++] = s->line;
                return FILM_EVENT;
            }
            status = FILM_OK;
        }
    }
    return status;
}

void film_sample(const film_curve *curve, const film_line *lines, int32_t line_count, const double *times,
                 int64_t count, double *values, int8_t *stages, int8_t *phases) {
    int32_t at = 0;
    for (int64_t i = 0; i < count; i++) {
        while (at + 1 < line_count && lines[at + 1].time <= times[i]) at++;
        film_evaluate(curve, &lines[at], times[i] - lines[at].time, values + 5 * i);
        stages[i] = (int8_t)lines[at].branch;
        phases[i] = (int8_t)lines[at].phase;
    }
}

film_contact film_force(const film_curve *curve, const film_state *s, double xi, double nu) {
    film_contact at = {0.0, 0.0, 0.0};
    if (s->branch == FILM_FREE) return at;
    double work, c = damping_at(curve, &s->line, xi);
    law_at(curve, &s->line, xi, &at.force, &work);
    at.by_xi = law_slope(curve, &s->line, xi);
    if (s->line.damper > 0.0 && s->line.branch >= 0) { /* y (1 + gamma c) = nu - gamma f, F = f + c y */
        double yield = 1.0 + s->gamma * c, c_slope = s->line.damper * slope_of(&piece_at(curve, s->line.branch, xi)->damping, xi);
        at.by_xi = (at.by_xi + c_slope * (nu - s->gamma * at.force) / yield) / yield;
        at.force = total_force(&s->line, c, at.force, nu);
        at.by_nu = c / yield;
    }
    return at;
}

void film_indicators(const film_curve *curve, const film_state *s, double speed, double indicators[FILM_INDICATORS]) {
    double late = 1e-10 * fabs(speed), force, work;
    for (int k = 0; k < FILM_INDICATORS; k++) indicators[k] = 1.0;
    if (s->branch == FILM_FREE) {
        indicators[1] = fmax(s->xi_free - s->xi, -hold(curve, s)) + late;
        return;
    }
    law_at(curve, &s->line, s->xi, &force, &work);
    double far = limit_of(curve, s), near = edge_of(curve, s, -s->direction);
    indicators[0] = s->direction * (s->nu - s->gamma * force) + s->gamma * meeting(curve, s) + late;
    if (far < INFINITY) indicators[1] = s->direction * (far - s->xi) + late;
    if (near < INFINITY) indicators[2] = s->direction * (s->xi - near) + late;
    indicators[3] = (s->moving_in ? s->nu - s->stop_velocity : s->stop_velocity - s->nu) + late;
    if (!damped(curve, s)) return;
    if (s->direction < 0) indicators[1] = fmin(indicators[1], hold(curve, s) + late);
    else indicators[4] = (s->rising ? 1.0 : -1.0) * force_rate(curve, s, s->xi, s->nu) + late;
}

static int switched(const film_curve *curve, film_state *s) {
    int ends = ENDS_EDGE;
    s->event = FILM_NO_EVENT;
    open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->elastic;
    if (!isfinite(s->xi) || !isfinite(s->nu) || !isfinite(s->force)) return FILM_BAD_NUMBER;
    if (s->branch == FILM_FREE) {
        if (s->xi < s->xi_free || (s->xi == s->xi_free && !(s->nu > 0.0 || (s->nu == 0.0 && s->load > 0.0)))) return FILM_OK;
        double above = hold(curve, s);
        if (!(above > 0.0)) return FILM_OK; /* its dent opens faster than it */
        if (above == INFINITY) s->xi = s->xi_free;
    } else {
        double ahead = s->direction * (s->nu - s->gamma * s->force), edge = limit_of(curve, s);
        double to_edge = s->direction * (edge - s->xi);
        if (damped(curve, s)) s->force_peak = fmax(s->force_peak, holding(curve, s));
        if (s->moving_in && s->nu < s->stop_velocity) return stopped(s);
        if (s->nu > s->stop_velocity) s->moving_in = 1;
        int lets_go = s->direction < 0 && damped(curve, s) && hold(curve, s) < 0.0;
        /* where two stages meet in forces of rounding, the one may turn it outwards and the other inwards */
        if (ahead >= -s->gamma * meeting(curve, s) && to_edge > 0.0 && !lets_go) return FILM_OK;
        if (lets_go && to_edge > 0.0) {
            ends = ENDS_RELEASE;
        } else if (to_edge > 0.0) { /* within the run: who jumps back over its beginning turned there at the latest */
            ends = ENDS_TURN;
            edge = edge_of(curve, s, -s->direction);
            if (s->direction * (s->xi - edge) < 0.0) s->xi = edge;
        } else {
            s->xi = edge;
        }
    }
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->elastic;
    open_line(s);
    end_here(s, ends);
    int status = finish(curve, NULL, s);
    choose_loop(curve, s);
    open_run(curve, s);
    return status;
}

int film_switch(const film_curve *curve, film_state *s) {
    int status = switched(curve, s);
    s->rising = status >= 0 && s->direction > 0 && damped(curve, s) && force_rate(curve, s, s->xi, s->nu) >= 0.0;
    return status;
}

void film_law(const film_curve *curve, int32_t stage, double xi, double *force, double *work) {
    film_line line;
    memset(&line, 0, sizeof line);
    line.branch = stage;
    law_at(curve, &line, xi, force, work);
}

static int bad_function(const film_function *g) {
    if (g->form == FILM_POWER)
        return !(isfinite(g->constant) && isfinite(g->slope) && isfinite(g->coefficient) && g->exponent > 0.0 &&
                 isfinite(g->exponent) && isfinite(g->origin) && g->per_span == 1.0);
    if (g->form != FILM_SERIES && g->form != FILM_ROOT_SERIES) return 1;
    if (g->terms < 1 || g->terms > FILM_MAX_TERMS || !(g->per_span > 0.0 && g->per_span < INFINITY) || !isfinite(g->origin)) return 1;
    for (int k = 0; k < g->terms; k++)
        if (!isfinite(g->series[k])) return 1;
    return 0;
}

static int bad_piece(const film_curve *curve, const film_stage *stage, const film_piece *piece) {
    int last = piece == &curve->piece[stage->first + stage->count - 1];
    if (bad_function(&piece->force) || !isfinite(piece->work_at_begin)) return 1;
    if (piece->force.form != FILM_POWER && bad_function(&piece->mean)) return 1;
    if (stage->unloading != FILM_RETRACE && (bad_function(&piece->recovery) || bad_function(&piece->exponent))) return 1;
    if (stage->damped && bad_function(&piece->damping)) return 1;
    if (last && piece->end != stage->end) return 1;
    return !(piece->end < INFINITY) && !(last && stage == &curve->stage[curve->stages - 1] && piece->force.form == FILM_POWER);
}

int film_check_curve(const film_curve *curve) {
    int32_t pieces = 0;
    if (curve->stages < 1 || curve->stages > FILM_MAX_STAGES || curve->stage[0].begin != 0.0) return FILM_BAD_CURVE;
    if (!(curve->compliance >= 0.0 && curve->compliance < INFINITY)) return FILM_BAD_CURVE;
    if (curve->compliance > 0.0 && curve->stage[0].damped) return FILM_BAD_CURVE;
    for (int32_t k = 0; k < curve->stages; k++) {
        const film_stage *stage = &curve->stage[k];
        double begin = stage->begin;
        if (k > 0 && begin != curve->stage[k - 1].end) return FILM_BAD_CURVE;
        if (stage->first != pieces || stage->count < 1 || stage->count > FILM_MAX_PIECES - pieces) return FILM_BAD_CURVE;
        if (stage->unloading < FILM_RETRACE || stage->unloading > FILM_SHIFTED) return FILM_BAD_CURVE;
        if (stage->damped != 0 && (stage->damped != 1 || curve->stages > 1 || stage->unloading != FILM_RETRACE)) return FILM_BAD_CURVE;
        if (!(stage->reload_exponent >= 0.0 && stage->reload_exponent < INFINITY)) return FILM_BAD_CURVE;
        pieces += stage->count;
        for (int32_t i = stage->first; i < pieces; i++) {
            if (!(curve->piece[i].end > begin) || bad_piece(curve, stage, &curve->piece[i])) return FILM_BAD_CURVE;
            begin = curve->piece[i].end;
        }
    }
    return pieces == curve->pieces ? FILM_OK : FILM_BAD_CURVE;
}

/* ---------------------------------------------------------------- meshes and states */

static double graded(int grading, double s) {
    static const double a[FILM_GRADINGS] = {1.0, 0.0, 1.2, 1.6, 1.6, 1.0};
    static const double b[FILM_GRADINGS] = {1.0, 0.0, 1.7, 1.2, 1.15, 2.5};
    static const double c[FILM_GRADINGS] = {1.0, 0.0, 1.0, 1.0, 0.19, 0.3};
    if (grading == FILM_EQUAL || s <= 0.0 || s >= 1.0) return s;
    if (grading == FILM_COSINE) return 0.5 * (1.0 - cos(PI * s));
    double from = pow(s, a[grading]);
    return from / (from + c[grading] * pow(1.0 - s, b[grading]));
}

size_t film_mesh_size(int32_t loading, int32_t unloading) {
    return 3 * ((size_t)loading + 1) + 9 * (size_t)unloading + 5;
}

static double *fill(const double **nodes, int grading, int32_t segments, double *memory) {
    *nodes = memory;
    for (int32_t i = 0; i <= segments; i++) *memory++ = graded(grading, (double)i / segments);
    return memory;
}

int film_mesh_init(film_mesh *mesh, int32_t linearisation, int32_t loading, int32_t unloading, double *memory) {
    memset(mesh, 0, sizeof *mesh);
    if (loading < 1 || unloading < 1 || loading > FILM_MAX_SEGMENTS || unloading > FILM_MAX_SEGMENTS)
        return FILM_BAD_MESH;
    if (linearisation != FILM_CHORD && linearisation != FILM_WORK_PRESERVING) return FILM_BAD_MESH;
    mesh->linearisation = linearisation;
    mesh->loading = loading;
    mesh->unloading = unloading;
    for (int g = FILM_EQUAL; g <= FILM_PLATE_IN; g++) memory = fill(&mesh->loading_nodes[g], g, loading, memory);
    for (int g = FILM_EQUAL; g < FILM_GRADINGS; g++)
        if (g != FILM_PLATE_IN) memory = fill(&mesh->unloading_nodes[g], g, film_unloading(mesh, g), memory);
    return FILM_OK;
}

/* A number so small that its powers underflow is none. */
static double told(double x) { return fabs(x) < TINY ? 0.0 : x; }

int film_init(const film_curve *curve, film_state *s, double xi, double nu, double gamma, double load,
              double stop_velocity) {
    memset(s, 0, sizeof *s);
    if (!isfinite(xi) || !isfinite(nu) || !isfinite(gamma) || !isfinite(load) || !isfinite(stop_velocity) ||
        gamma < 0.0 || xi > 0.0)
        return FILM_BAD_NUMBER;
    if (curve->stages < 1) return FILM_BAD_CURVE;
    s->xi = told(xi);
    s->nu = told(nu);
    s->gamma = told(gamma);
    s->load = told(load);
    s->stop_velocity = told(stop_velocity);
    s->moving_in = s->nu > s->stop_velocity;
    s->branch = FILM_FREE;
    s->stage_max = -1;
    s->phase = FILM_APPROACHING;
    return FILM_OK;
}

int film_damp(film_state *s, double factor) {
    if (!(factor >= 0.0 && factor < INFINITY)) return FILM_BAD_NUMBER;
    s->damper = factor;
    s->has_line = s->has_leg = s->from_turn = 0;
    return FILM_OK;
}

int film_input(film_state *s, double load, double nu_change, double stop_velocity) {
    if (!isfinite(load) || !isfinite(nu_change) || !isfinite(stop_velocity)) return FILM_BAD_NUMBER;
    load = told(load);
    stop_velocity = told(stop_velocity);
    if (load == s->load && nu_change == 0.0 && stop_velocity == s->stop_velocity) return FILM_OK;
    s->load = load;
    s->nu += nu_change;
    s->jumped |= nu_change != 0.0;
    s->stop_velocity = stop_velocity;
    if (s->nu > stop_velocity) s->moving_in = 1;
    s->has_line = s->has_leg = s->from_turn = 0;
    return FILM_OK;
}

void film_sizes(int64_t sizes[5]) {
    sizes[0] = (int64_t)sizeof(film_curve);
    sizes[1] = (int64_t)sizeof(film_mesh);
    sizes[2] = (int64_t)sizeof(film_line);
    sizes[3] = (int64_t)sizeof(film_state);
    sizes[4] = (int64_t)sizeof(film_summary);
}
