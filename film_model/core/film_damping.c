/* Damping: what it adds to a line, when it ends a contact, the largest force with it. docs/method.md, section 7.
 * F = f + c xi' and xi' = nu - gamma F, so a damped contact ends where F falls to 0, before its dent closes at f = 0. */
#include "film_march.h"

/* The place of the largest force is sought to this fraction of the way; the force there differs by the square of that.
 * Accuracy and cost only: of core_check.c only the hash sees it. */
static const double PEAK_TOLERANCE = 1e-6;

enum { RELEASE_ITERATIONS = 120, PEAK_ITERATIONS = 60 };

/* ---------------------------------------------------------------- the damping of a line */

/* The mean of the law's c over the next h, weighted with y^2 of a speed that goes evenly in time from y0 to y1: held
 * constant, it dissipates as much as c. Where c may begin as a root, the rule's steps are taken to the fourth power.
 * docs/method.md, section 7. */
static double mean_damping(const film_curve *curve, const film_state *s, double h, double y0, double y1) {
    double sum = 0.0, weights = 0.0, per_way = 2.0 / (y0 + y1);
    int root = h > 0.0 && s->xi <= INSIDE_DENT * h;
    for (int k = 0; k < GAUSS; k++) {
        double w = GAUSS_AT[k], u = root ? w * w * w * w : w, y = y0 + (y1 - y0) * u;
        double weight = GAUSS_WEIGHT[k] * y * y * (root ? 4.0 * w * w * w : 1.0);
        sum += weight * damping_at(curve, &s->line, s->xi + h * per_way * u * (y0 + 0.5 * (y1 - y0) * u));
        weights += weight;
    }
    return weights > 0.0 ? sum / weights : damping_at(curve, &s->line, s->xi + 0.5 * h); /* y^2 underflows */
}

/* xi' along the direction of motion, of the true law. */
double film_speed(const film_curve *curve, const film_state *s, double xi, double force, double nu) {
    return s->direction * (nu - s->gamma * force) / (1.0 + s->gamma * damping_at(curve, &s->line, xi));
}

/* Adds damping to the line over the next h, passed with speeds y0 to y1: the mean of c as a constant, and the difference
 * between c y and that at both ends as a tilt of the line's own force, so that the force is the law's there while the work
 * stays that of c y. At a turn c y is 0 and the line keeps its force. plain: the constant alone.
 * docs/method.md, section 7. */
void film_add_damping(const film_curve *curve, const film_mesh *mesh, film_state *s, double h, double y0, double y1, int plain) {
    double mean = mean_damping(curve, s, h, y0, y1), c0 = damping_at(curve, &s->line, s->xi), c1 = damping_at(curve, &s->line, s->xi + h);
    double d = s->direction, at = mean, tilt;
    s->line.damping = mean;
    /* too long to trust the end speeds: the tilt could add energy, so damping stays constant */
    if (plain || mesh->linearisation == FILM_CHORD || mean * fabs(h) > 0.5 * fmax(y0, y1) || per_length(s, h) == 0.0) return;
    double speed = 2.0 / 3.0 * (y0 * y0 + y0 * y1 + y1 * y1) / (y0 + y1); /* mean over the way, of a speed even in time */
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

/* Adds damping to the line over the next `length`, as film_add_damping. The speed at its end, which weights the mean, is that
 * of the line with an evenly weighted mean. docs/method.md, section 7. */
void film_damp_line(const film_curve *curve, const film_mesh *mesh, film_state *s, double length, int at_rest,
                    int plain) {
    double h = s->direction * length, tau, y = 0.0;
    s->line.damping = mean_damping(curve, s, h, 1.0, 1.0);
    motion rough = motion_on(s, s->line.phi, s->line.kappa);
    if (at_rest) rough.y0 = 0.0;
    if (move_to(&rough, length, &tau, &y) == REACHED && y > 0.0) {
        double nu = s->direction * y * (1.0 + s->gamma * s->line.damping) + s->gamma * (s->line.phi + s->line.kappa * h);
        y = fmax(film_speed(curve, s, s->xi + h, s->force_end, nu), 0.0);
    } else {
        y = 0.0;
    }
    double y0 = at_rest ? 0.0 : fmax(film_speed(curve, s, s->xi, s->elastic, s->nu), 0.0);
    if (y0 + y > 0.0) film_add_damping(curve, mesh, s, h, y0, y, plain);
}

/* The energy that damping took over the first tau of a line, at whose end the impactor is at xi with nu and the law's work
 * is `work`: what is missing from the impactor's energy and is neither stored nor radiated, the integral of gamma F^2 dt.
 * docs/method.md, section 7. */
double film_dissipated(const film_line *line, double tau, double xi, double nu, double work) {
    double gamma = line->gamma, moved = gamma * (line->load * tau - (nu - line->nu)), radiated = 0.0, x, y;
    double gone = 0.5 * (line->nu - nu) * (line->nu + nu) + line->load * (xi - line->xi + moved) - (work - line->work);
    if (gamma == 0.0) return gone;
    motion m = motion_from(1.0, line->nu, gamma, line->load, line->phi, line->kappa, line->damping);
    for (int k = 0; k < GAUSS; k++) {
        motion_at(&m, GAUSS_AT[k] * tau, &x, &y);
        double force = line->phi + line->kappa * x + line->damping * y;
        radiated += GAUSS_WEIGHT[k] * force * force;
    }
    return gone - gamma * radiated * tau;
}

/* ---------------------------------------------------------------- release and touch */

/* A way that ends where a force falls to 0: positive (above) at low, negative (below) at high. */
typedef struct {
    double low, high, above, below;
} bracket;

/* Takes the value at `at` into the bracket and returns the next guess: false position, with the older end's value halved
 * every third step so that neither end stays. */
static double narrow(bracket *b, double at, double value, int step) {
    if (value > 0.0) {
        b->low = at;
        b->above = value;
        if (step % 3 == 2) b->below *= 0.5;
    } else {
        b->high = at;
        b->below = value;
        if (step % 3 == 2) b->above *= 0.5;
    }
    double next = b->low + (b->high - b->low) * b->above / (b->above - b->below);
    return next > b->low && next < b->high ? next : 0.5 * (b->low + b->high);
}

/* The current line, for damping_at and law_at; in flight after a damped contact, one on the stage whose dent may still be
 * open. */
static film_line active_line(const film_curve *curve, const film_state *s) {
    film_line line = s->line;
    if (s->branch == FILM_FREE && s->damper > 0.0 && curve->stage[0].damped) {
        line.branch = 0;
        line.damper = s->damper;
    }
    return line;
}

/* nu + f/c: by how much nu exceeds the outward velocity at which F is 0. It has the sign of F, and is smooth where f and c
 * both go to 0. INFINITY without damping: undamped contacts end only at xi_free. docs/method.md, section 7. */
double film_release_margin(const film_curve *curve, const film_state *s) {
    film_line line = active_line(curve, s);
    double f, work, c = damping_at(curve, &line, s->xi);
    if (!(c > 0.0)) return INFINITY;
    law_at(curve, &line, s->xi, &f, &work);
    return fmin(s->nu + f / c, 1e300);
}

/* When F rises from 0 again, of a contact that was released inside its dent and that the load turns back there, by halving.
 * docs/method.md, section 7. */
double film_touch_time(const film_curve *curve, const film_state *s) {
    film_line inside = s->line;
    double low = 0.0, high = -s->nu / s->load, f, work;
    inside.branch = 0;
    inside.damper = s->damper;
    for (int k = 0; k < HALVINGS; k++) {
        double t = 0.5 * (low + high), xi = s->xi + t * (s->nu + 0.5 * s->load * t);
        law_at(curve, &inside, xi, &f, &work);
        if (total_force(&inside, damping_at(curve, &inside, xi), f, s->nu + s->load * t) > 0.0) high = t; else low = t;
    }
    return high;
}

/* F of the true law at xi, at least a little inside the dent, where f and c are not both 0; negative where it would pull. */
static double force_inside(const film_curve *curve, const film_state *s, double xi, double nu) {
    double f, work, at = fmax(xi, INSIDE_DENT * s->leg_from);
    law_at(curve, &s->line, at, &f, &work);
    return total_force(&s->line, damping_at(curve, &s->line, at), f, nu);
}

/* Whether F is negative somewhere within the line just made. */
static int releases_between(const film_curve *curve, const film_state *s) {
    double values[5];
    for (int k = 0; k < GAUSS; k++) {
        film_evaluate(curve, &s->line, GAUSS_AT[k] * s->tau_end, values);
        if (force_inside(curve, s, values[0], values[3]) < 0.0) return 1;
    }
    return 0;
}

/* Seeks, within b, the length of a line at whose end F is 0. falls: F is known to be negative at b.high. Returns 1 if a line
 * was made: to there or, if the contact creeps and F stays above 0, over a part of the way or without end. */
static int seek_release(const film_curve *curve, const film_mesh *mesh, film_state *s, bracket b, int falls) {
    double d = s->direction, full = b.high, length = 0.5 * b.high, y;
    s->line_ends = ENDS_RELEASE;
    for (int k = 0; k < RELEASE_ITERATIONS; k++) {
        motion m = film_make_line(curve, mesh, s, length);
        int moved = move_to(&m, length, &s->tau_end, &y);
        if (moved == REACHED) film_set_line_end(s, length, y);
        /* the motion does not get as far, or gets there under a force of the line that is far above the law's */
        if (moved != REACHED || (!falls && s->load <= 0.0 && s->nu_end > 2.0 * s->gamma * s->force_end)) {
            b.high = length;
            b.below = NAN;
            length = 0.5 * (b.low + b.high);
            continue;
        }
        double force = force_inside(curve, s, s->xi_end, s->nu_end);
        if (!(force > 0.0) && s->xi + d * length == s->xi) {
            film_end_here(s, ENDS_RELEASE);
            return 1;
        }
        if (!(force > 0.0)) falls = 1;
        double next = narrow(&b, length, force, k);
        if (!falls && k >= 8) {
            s->line_ends = ENDS_PART;
            if (s->xi < CREPT * s->xi_max || s->tau_end * CREPT > 1.0) {
                s->line_ends = ENDS_NEVER;
                s->tau_end = INFINITY;
            }
            return 1;
        }
        if (fabs(next - length) <= 1e-14 * full || b.high - b.low <= 1e-15 * full) return 1;
        length = next;
    }
    return 0;
}

/* A damped contact ends when F falls to 0 on the way out: if it does so on the line just made, end the line there.
 * docs/method.md, section 7. */
void film_end_at_release(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    film_state whole = *s;
    double d = s->direction, now = force_inside(curve, s, s->xi, s->nu);
    int never = s->line_ends == ENDS_NEVER;
    if (!(now > 0.0) && d * (s->nu - s->gamma * s->elastic) > 0.0) {
        film_end_here(s, ENDS_RELEASE);
        return;
    }
    bracket b = {0.0, d * ((never ? s->leg_to : s->xi_end) - s->xi), now, NAN};
    if (!(b.high > 0.0) || (never && s->load > 0.0)) return;
    if (!never) {
        b.below = force_inside(curve, s, s->xi_end, s->nu_end);
        if (b.below >= 0.0 && !(s->load > 0.0 && releases_between(curve, s))) return;
    }
    if (!seek_release(curve, mesh, s, b, !never)) *s = whole;
}

/* ---------------------------------------------------------------- the largest force */

/* dF/dt at xi and nu. */
double film_force_rate(const film_curve *curve, const film_state *s, double xi, double nu) {
    film_contact at = film_force(curve, s, xi, nu);
    return at.by_xi * (nu - s->gamma * at.force) + at.by_nu * (s->load - at.force);
}

/* dF/dt and F at the end of a line made over `length` from the current point: values at the ends of lines are more
 * accurate than those between. */
static double rate_after(const film_curve *curve, const film_mesh *mesh, const film_state *s, double length, double *force) {
    film_state trial = *s;
    double y;
    trial.line_ends = ENDS_PART;
    motion m = film_make_line(curve, mesh, &trial, length);
    if (move_to(&m, length, &trial.tau_end, &y) != REACHED) return -INFINITY; /* it turns before */
    film_set_line_end(&trial, length, y);
    *force = force_inside(curve, &trial, trial.xi_end, trial.nu_end);
    return film_force_rate(curve, &trial, trial.xi_end, trial.nu_end);
}

/* With damping F is largest before the motion turns. Raises *peak to the largest F on the line just followed, sought in the
 * half of it on which F first rises and then falls. docs/method.md, section 7. */
void film_raise_peak(const film_curve *curve, const film_mesh *mesh, const film_state *walked, double *peak) {
    film_state s = *walked;
    double values[5], force = 0.0;
    film_evaluate(curve, &s.line, 0.5 * s.tau_end, values);
    double before = film_force_rate(curve, &s, s.line.xi, s.line.nu), middle = film_force_rate(curve, &s, values[0], values[3]);
    double after = film_force_rate(curve, &s, s.xi_end, s.nu_end), half = s.direction * (values[0] - s.line.xi);
    int first = before >= 0.0 && middle < 0.0;
    if (!first && !(middle >= 0.0 && after < 0.0)) return;
    double full = first ? half : s.direction * (s.xi_end - s.line.xi);
    bracket b = {first ? 0.0 : half, full, first ? before : middle, first ? middle : after};
    double length = 0.5 * (b.low + b.high);
    s.xi = s.line.xi;
    s.nu = s.line.nu;
    s.work = s.line.work;
    law_at(curve, &s.line, s.xi, &s.elastic, &values[0]);
    for (int k = 0; k < PEAK_ITERATIONS; k++) {
        double rate = rate_after(curve, mesh, &s, length, &force);
        *peak = fmax(*peak, force);
        double next = narrow(&b, length, rate, k);
        if (fabs(next - length) <= PEAK_TOLERANCE * full) return;
        length = next;
    }
}
