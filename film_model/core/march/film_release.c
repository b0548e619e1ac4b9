/* Where damping ends a contact, and the largest force with it. docs/method.md, section 7.
 * F = f + c xi' and xi' = nu - gamma F, so a damped contact ends where F falls to 0, before its dent closes at f = 0. */
#include "march/film_march.h"

/* The place of the largest or least force is sought to this fraction of the way; the force there differs by the square of that.
 * Accuracy and cost only: of core_check.c only the hash sees it. */
static const double PEAK_TOLERANCE = 1e-6;

enum { RELEASE_ITERATIONS = 120, PEAK_ITERATIONS = 60 };

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

/* F of the true law at xi, at least a little inside the dent, where f and c are not both 0; negative where it would pull. */
static double force_inside(const film_curve *curve, const film_state *s, double xi, double nu) {
    double f, work, at = fmax(xi, CREPT * s->leg_from);
    law_at(curve, &s->line, at, &f, &work);
    return total_force(&s->line, damping_at(curve, &s->line, at), f, nu);
}

/* Ends the bracket where F is negative within the line just made: at a point of Gauss's rule, or else where F is least, if it falls
 * at first and rises at the end. */
static void end_at_least(const film_curve *curve, const film_state *s, bracket *b) {
    double values[5], at = 0.5 * s->tau_end;
    bracket rates = {0.0, s->tau_end, -film_force_rate(curve, s, s->xi, s->nu), -film_force_rate(curve, s, s->xi_end, s->nu_end)};
    for (int k = 0; k < GAUSS; k++) {
        film_evaluate(curve, &s->line, GAUSS_AT[k] * s->tau_end, values);
        double force = force_inside(curve, s, values[0], values[3]);
        if (force >= 0.0) continue;
        b->high = s->direction * (values[0] - s->xi), b->below = force;
        return;
    }
    if (!(rates.above > 0.0 && rates.below < 0.0)) return;
    for (int k = 0; k < PEAK_ITERATIONS; k++) {
        film_evaluate(curve, &s->line, at, values);
        double next = narrow(&rates, at, -film_force_rate(curve, s, values[0], values[3]), k);
        if (fabs(next - at) <= PEAK_TOLERANCE * s->tau_end) break;
        at = next;
    }
    b->high = s->direction * (values[0] - s->xi);
    b->below = force_inside(curve, s, values[0], values[3]);
}

/* Seeks, within b, the length of a line at whose end F is 0. falls: F is known to be negative at b.high. Returns 1 if a line
 * was made: to there or, if the contact creeps and F stays above 0, over a part of the way or without end. */
static int seek_release(const film_curve *curve, const film_mesh *mesh, film_state *s, bracket b, int falls) {
    double d = s->direction, full = b.high, length = 0.5 * b.high, y;
    s->line_ends = ENDS_RELEASE;
    for (int k = 0; k < RELEASE_ITERATIONS; k++) {
        motion m = film_make_line(curve, mesh, s, length, 0);
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
        if (b.below >= 0.0 && s->load > 0.0) end_at_least(curve, s, &b); /* the load may turn it after a release */
        if (b.below >= 0.0) return;
    }
    if (!seek_release(curve, mesh, s, b, !never)) *s = whole;
}

/* ---------------------------------------------------------------- the largest force */

/* dF/dt and F at the end of a line made over `length` from the current point: values at the ends of lines are more
 * accurate than those between. */
static double rate_after(const film_curve *curve, const film_mesh *mesh, const film_state *s, double length, double *force) {
    film_state trial = *s;
    double y;
    trial.line_ends = ENDS_PART;
    motion m = film_make_line(curve, mesh, &trial, length, 0);
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
