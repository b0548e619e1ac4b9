/* A line that ends where its motion turns. docs/method.md, section 5. */
#include "march/film_march.h"

/* A turn is known to this fraction of the depth at best: the mean force of a short line is a difference of works.
 * core_check.c, one_schedule with DAMPED. */
static const double TURN_ROUNDING = 2e-15;

/* A jump of the turn by less than so many times that is rounding too, or too small to matter. */
static const double GAP = 64.0;

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
    double last_h = 0.0, last_miss = 0.0, rounding = 0.0;
    for (int k = 0; k < TURN_ITERATIONS; k++) {
        film_make_turn_line(curve, mesh, s, h, plain);
        motion m = motion_on(s, s->line.phi, s->line.kappa);
        double reach = reach_of(&m, &s->tau_end), miss = reach - h;
        *length = h;
        rounding = TURN_ROUNDING * (fabs(s->xi) + h);
        if (fabs(miss) <= tolerance * h + rounding) return TURN;
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
    if (fabs(last_miss) <= GAP * rounding) return TURN;
    return high < INFINITY ? TURN_BETWEEN : NO_TURN;
}
