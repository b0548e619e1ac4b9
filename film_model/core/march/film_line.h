/* The exact motion on one line. Internal. docs/method.md, section 3.
 *
 * On a line the elastic force is phi_0 + kappa x. The relative velocity y = xi' = nu - gamma phi then obeys
 *
 *     y'' + 2 a y' + kappa y = 0,   a = kappa gamma/2,   y'(0) = -(phi_0 - p) - 2 a y_0:
 *
 * one formula for every damping regime, regular at kappa = 0 and at kappa = a^2 (critical damping). With a damping c that
 * is constant on the line, F = phi + c y, it is y = (nu - gamma phi)/M with M = 1 + gamma c: the same equation with
 * (phi_0 - p)/M, kappa/M and a = (kappa gamma + c)/(2 M). Written for motion towards positive x; motion outwards is its
 * mirror image. */
#ifndef FILM_LINE_H
#define FILM_LINE_H

#include "curve/film_law.h"

static const double PI = 3.14159265358979323846;

/* A motion towards an unstable balance (kappa < 0) leaves it along the growing exponential, whose amplitude is the small
 * difference of two terms. Below this fraction of the force that difference is rounding, and is taken as 0.
 * core_check.c, check_motions. */
static const double UNSTABLE_ROUNDING = 4e-15;

/* An over-damped motion approaches its balance exponentially. If the balance is beyond the end of the line by less than
 * this fraction of its length, a search for the time would only find rounding: the end is never reached.
 * core_check.c, check_found: "creeping out". */
static const double BALANCE_ROUNDING = 1e-13;

enum { TURNS_BEFORE, REACHED, NEVER_REACHED }; /* NEVER_REACHED: it comes to rest before */
enum { ROOT_ITERATIONS = 200, NEWTON_PATIENCE = 40, DOUBLINGS = 2100 };

typedef struct {
    double y0, phi, kappa, a; /* phi: the line's force at x = 0, less the load */
} motion;

enum { SERIES_END = 24 };
static const double PER_FACTORIAL[SERIES_END + 2] = {
    1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880,
    1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800.0, 1.0 / 87178291200.0,
    1.0 / 1307674368000.0, 1.0 / 20922789888000.0, 1.0 / 355687428096000.0, 1.0 / 6402373705728000.0,
    1.0 / 121645100408832000.0, 1.0 / 2432902008176640000.0, 1.0 / 51090942171709440000.0,
    1.0 / 1124000727777607680000.0, 1.0 / 25852016738884976640000.0, 1.0 / 620448401733239439360000.0,
    1.0 / 15511210043330985984000000.0};

/* x and y after a short time, by Taylor's series: its terms d_k/k! follow d_k = -(2 a tau) d_{k-1} - kappa tau^2 d_{k-2}.
 * b = -2 a tau, c = -kappa tau^2. */
static inline void motion_by_series(const motion *m, double tau, double b, double c, double *x, double *y) {
    const double *over = PER_FACTORIAL;
    double before = m->y0, last = (-m->phi - 2.0 * m->a * m->y0) * tau;
    double small = 1e-17 * (fabs(before) + fabs(last));
    double sum_y = before + last, sum_x = before + 0.5 * last, p = b * b + c, r = b * c;
    for (int k = 2; k < SERIES_END; k += 2) { /* two terms at a time, each from the two before */
        double next = b * last + c * before;
        last = p * last + r * before;
        before = next;
        sum_y += before * over[k] + last * over[k + 1];
        sum_x += before * over[k + 1] + last * over[k + 2];
        if ((fabs(before) + fabs(last)) * over[k + 1] <= small) break;
    }
    *x = sum_x * tau;
    *y = sum_y;
}

/* x and y after a long time, in closed form: with s the response to a unit velocity and sigma its integral,
 * y = y0 s' - phi s and x = y0 s - phi sigma. */
static inline void motion_in_closed_form(const motion *m, double tau, double *x, double *y) {
    double a = m->a, square = a * a - m->kappa, reach = square * tau * tau, s, ds, sigma;
    if (square > 0.0 && fabs(reach) >= 0.01) { /* over-damped: rates a + d and kappa/(a + d), without cancellation */
        double d = sqrt(square), fast = a + d, slow = m->kappa / fast;
        if (slow < 0.0 && fabs(slow * m->y0 + m->phi) <= UNSTABLE_ROUNDING * fabs(m->phi)) { /* comes to rest there */
            *x = -m->y0 * expm1(-fast * tau) / fast;
            *y = m->y0 * exp(-fast * tau);
            return;
        }
        double e_slow = exp(-slow * tau), e_fast = exp(-fast * tau);
        double grown = m->kappa == 0.0 ? tau / fast : -expm1(-slow * tau) / m->kappa;
        s = (e_slow - e_fast) / (2.0 * d);
        ds = (fast * e_fast - slow * e_slow) / (2.0 * d);
        sigma = grown * fast / (2.0 * d) + expm1(-fast * tau) / (2.0 * d * fast);
    } else {
        double even, odd, decay = exp(-a * tau);
        if (fabs(reach) < 0.01) { /* near critical damping: even series in (a^2 - kappa) tau^2 */
            even = 1.0 + reach / 2.0 * (1.0 + reach / 12.0 * (1.0 + reach / 30.0 * (1.0 + reach / 56.0 * (1.0 + reach / 90.0))));
            odd = tau * (1.0 + reach / 6.0 * (1.0 + reach / 20.0 * (1.0 + reach / 42.0 * (1.0 + reach / 72.0 * (1.0 + reach / 110.0)))));
        } else { /* under-damped */
            double omega = sqrt(-square);
            even = cos(omega * tau);
            odd = sin(omega * tau) / omega;
        }
        s = decay * odd;
        ds = decay * (even - a * odd);
        sigma = (1.0 - decay * (even + a * odd)) / m->kappa;
    }
    *x = m->phi == 0.0 ? m->y0 * s : m->y0 * s - m->phi * sigma; /* sigma is infinite for the smallest kappa */
    *y = m->y0 * ds - m->phi * s;
}

/* x and y after tau. docs/method.md, section 3. */
static inline void motion_at(const motion *m, double tau, double *x, double *y) {
    double b = -2.0 * m->a * tau, c = -m->kappa * tau * tau;
    if (fabs(b) <= 1.0 && fabs(c) <= 1.0) motion_by_series(m, tau, b, c, x, y);
    else if (m->y0 == 0.0 && m->phi == 0.0) *x = *y = 0.0; /* at rest, where a growing exponential may be infinite */
    else motion_in_closed_form(m, tau, x, y);
}

/* When y falls to 0: tan(sqrt(D) tau)/sqrt(D) = y0/(phi + a y0), D = kappa - a^2; INFINITY if it never does. A motion
 * that starts backwards, y0 < 0, and is turned round by the force first, turns half a period later.
 * docs/method.md, section 3. */
static inline double turn_time(const motion *m) {
    double rate = m->phi + m->a * m->y0, square = m->kappa - m->a * m->a;
    if (m->y0 > 0.0 && rate > 0.0) {
        double r = m->y0 / rate, reach = square * r * r;
        if (reach > -0.98 && reach < INFINITY) return r * arc(reach);
        if (square < 0.0) {
            double d = sqrt(-square), left = m->phi + m->kappa / (m->a + d) * m->y0; /* rate - d y0, without cancellation */
            if (m->a > 0.0) return left > 0.0 ? 0.5 / d * log((rate + d * m->y0) / left) : INFINITY;
            return r * arc(reach);
        }
    }
    if (!(square > 0.0)) return INFINITY;
    double angle = atan2(sqrt(square) * m->y0, rate);
    return (angle >= 0.0 ? angle : angle + 2.0 * PI) / sqrt(square);
}

/* First time with x = length > 0, and y then: Newton's method in a bracket, for the lines on which move_to's shorter way
 * does not converge. */
static inline int move_to_by_bracket(const motion *m, double length, double *tau, double *y) {
    double low = 0.0, high = turn_time(m), x;
    if (m->y0 <= 0.0 && m->phi >= 0.0) return m->phi > 0.0 || m->y0 < 0.0 ? TURNS_BEFORE : NEVER_REACHED;
    if (high < INFINITY) {
        motion_at(m, high, &x, y);
        if (x < length) return TURNS_BEFORE;
    } else {
        if (m->kappa > 0.0 && -m->phi <= m->kappa * length * (1.0 + BALANCE_ROUNDING)) return NEVER_REACHED;
        high = m->y0 > 0.0 ? length / m->y0 : sqrt(-2.0 * length / m->phi);
        for (int k = 0; k < DOUBLINGS; k++, high *= 2.0) {
            motion_at(m, high, &x, y);
            if (!(x > -INFINITY)) return TURNS_BEFORE; /* it started backwards and never comes back */
            if (!(x < length)) break;
            if (k == DOUBLINGS - 1 || high > 1e300) return NEVER_REACHED;
        }
    }
    double t = 0.5 * (low + high);
    for (int k = 0; k < ROOT_ITERATIONS; k++) {
        motion_at(m, t, &x, y);
        if (x < length) low = t; else high = t;
        double next = *y > 0.0 ? t - (x - length) / *y : low;
        /* after NEWTON_PATIENCE every other step halves: on a growing e^t each of Newton's steps is as short as 1 */
        if (!(next > low && next < high) || (k > NEWTON_PATIENCE && k % 2)) next = 0.5 * (low + high);
        if (fabs(next - t) <= 4e-16 * t) break;
        t = next;
    }
    *tau = t;
    return REACHED;
}

/* The correction d of a time at which x misses the length by `miss`: d solves miss = y d + y1 d^2/2 + ... + y4 d^5/120,
 * y1 ... y4 the derivatives of y there; *y becomes y after d. Returns 0 if d is too long for this series; *y is then
 * unchanged. */
static inline int correct_time(const motion *m, double x, double miss, double t, double *y, double *d_out) {
    double y1 = -(m->phi + m->kappa * x) - 2.0 * m->a * *y, y2 = -2.0 * m->a * y1 - m->kappa * *y;
    double y3 = -2.0 * m->a * y2 - m->kappa * y1, y4 = -2.0 * m->a * y3 - m->kappa * y2;
    double d = miss / *y;
    d = miss / (*y + d * (0.5 * y1 + d * (1.0 / 6 * y2)));
    double reached = d * (*y + d * (0.5 * y1 + d * (1.0 / 6 * y2 + d * (1.0 / 24 * y3 + d * (1.0 / 120) * y4))));
    d -= (reached - miss) / (*y + d * (y1 + d * (0.5 * y2 + d * (1.0 / 6 * y3))));
    *d_out = d;
    double rough = fabs(miss) / *y;
    if (!(t + d > 0.0) || !(rough <= 0.003 * t && rough * fabs(y1) <= 0.03 * *y)) return 0;
    *y += d * (y1 + d * (0.5 * y2 + d * (1.0 / 6 * y3 + d * (1.0 / 24) * y4)));
    return 1;
}

/* First time with x = length > 0, and y then. docs/method.md, section 3.
 * On a target that does not move, energy gives y = sqrt(y0^2 - length (2 phi + kappa length)) and then
 * tan(omega tau/2) = omega length/(y0 + y). Otherwise energy, with the drag's work by the trapezoidal rule, gives a first
 * guess of y, and that one of tau. */
static inline int move_to(const motion *m, double length, double *tau, double *y) {
    double drag = m->a * length, before = m->y0 - drag;
    double square = before * before - length * (2.0 * m->phi + m->kappa * length);
    if (m->a == 0.0) {
        if (square < 0.0 || m->y0 < 0.0) return TURNS_BEFORE;
        *y = sqrt(square);
        double mean = m->y0 + *y;
        if (mean <= 0.0) return m->phi == 0.0 ? NEVER_REACHED : TURNS_BEFORE;
        double h = length / mean;
        *tau = 2.0 * h * arc(m->kappa * h * h);
        return *tau < INFINITY ? REACHED : TURNS_BEFORE; /* infinite: the length lies behind an unstable balance */
    }
    double guess = square > 0.0 && before > 0.0 ? sqrt(square) - drag : 0.0;
    if (m->y0 == 0.0 && square > 0.0) guess = sqrt(square) - drag;
    if (!(guess > 0.1 * m->y0) || m->y0 < 0.0) return move_to_by_bracket(m, length, tau, y);
    double t = 2.0 * length / (m->y0 + guess);
    t -= t * t * t * (m->kappa + 2.0 * m->a * (guess - m->y0) / length) / 12.0;
    if (!(t > 0.0)) return move_to_by_bracket(m, length, tau, y);
    for (int k = 0; k < 6; k++) {
        double x, d;
        motion_at(m, t, &x, y);
        if (!(*y > 0.0)) break;
        if (correct_time(m, x, length - x, t, y, &d)) {
            *tau = t + d;
            return *y > 0.0 ? REACHED : move_to_by_bracket(m, length, tau, y);
        }
        if (!(t + d > 0.0)) break;
        t += d;
    }
    return move_to_by_bracket(m, length, tau, y);
}

/* The motion on a line whose force begins at phi with slope kappa and damping c, seen along `direction`. */
static inline motion motion_from(double direction, double nu, double gamma, double load, double phi, double kappa, double c) {
    double per_m = 1.0 / (1.0 + gamma * c);
    motion m = {direction * (nu - gamma * phi) * per_m, direction * (phi - load) * per_m, kappa * per_m,
                0.5 * (kappa * gamma + c) * per_m};
    return m;
}

#endif
