/* The exact motion on one line. Internal.
 * With phi = phi_0 + kappa x the relative velocity y = xi' = nu - gamma phi obeys y'' + 2 a y' + kappa y = 0,
 * a = kappa gamma/2, y'(0) = -(phi_0 - p) - 2 a y_0: one formula for every damping regime, and kappa = 0 and
 * kappa = a^2 are regular points. A damping c held on the line, F = phi + c y, makes it y = (nu - gamma phi)/M with
 * M = 1 + gamma c: the same with (phi_0 - p)/M, kappa/M and a = (kappa gamma + c)/(2 M). Written for motion towards positive x; motion outwards is its mirror image. */
#ifndef FILM_LINE_H
#define FILM_LINE_H

#include "film_law.h"

static const double PI = 3.14159265358979323846;

static const double ASTRAY = 4e-15; /* of the force: what drives a motion off an unstable balance and is rounding */

enum { LEFT_NOT, LEFT, LEFT_NEVER }; /* it turns before; it passes; it comes to rest before */
enum { ROOT_ITERATIONS = 200, NEWTON_PATIENCE = 40, DOUBLINGS = 2100 };

typedef struct {
    double y0, phi, kappa, a; /* phi: the line's force at x = 0, less the load */
} motion;

/* x and y after tau. Short times: the Taylor series, whose terms d_k/k! follow d_k = -(2a tau) d_{k-1} - kappa tau^2 d_{k-2};
 * long ones: s, the response to a unit velocity, s' and its integral sigma; y = y0 s' - phi s, x = y0 s - phi sigma. */
static inline void move(const motion *m, double tau, double *x, double *y) {
    static const double over[26] = {/* 1/k! */
        1.0, 1.0, 1.0 / 2, 1.0 / 6, 1.0 / 24, 1.0 / 120, 1.0 / 720, 1.0 / 5040, 1.0 / 40320, 1.0 / 362880,
        1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800.0, 1.0 / 87178291200.0,
        1.0 / 1307674368000.0, 1.0 / 20922789888000.0, 1.0 / 355687428096000.0, 1.0 / 6402373705728000.0,
        1.0 / 121645100408832000.0, 1.0 / 2432902008176640000.0, 1.0 / 51090942171709440000.0,
        1.0 / 1124000727777607680000.0, 1.0 / 25852016738884976640000.0, 1.0 / 620448401733239439360000.0,
        1.0 / 15511210043330985984000000.0};
    double b = -2.0 * m->a * tau, c = -m->kappa * tau * tau;
    if (fabs(b) <= 1.0 && fabs(c) <= 1.0) {
        double before = m->y0, last = (-m->phi - 2.0 * m->a * m->y0) * tau;
        double small = 1e-17 * (fabs(before) + fabs(last));
        double sum_y = before + last, sum_x = before + 0.5 * last, p = b * b + c, r = b * c;
        for (int k = 2; k < 24; k += 2) { /* two terms from the two before, at the same time */
            double next = b * last + c * before;
            last = p * last + r * before;
            before = next;
            sum_y += before * over[k] + last * over[k + 1];
            sum_x += before * over[k + 1] + last * over[k + 2];
            if ((fabs(before) + fabs(last)) * over[k + 1] <= small) break;
        }
        *x = sum_x * tau;
        *y = sum_y;
        return;
    }
    if (m->y0 == 0.0 && m->phi == 0.0) { /* at rest, on a balance that may be unstable */
        *x = *y = 0.0;
        return;
    }
    double a = m->a, square = a * a - m->kappa, reach = square * tau * tau;
    double s, ds, sigma;
    if (fabs(reach) < 0.01) { /* around critical damping: even series in (a^2 - kappa) tau^2 */
        double even = 1.0 + reach / 2.0 * (1.0 + reach / 12.0 * (1.0 + reach / 30.0 * (1.0 + reach / 56.0 * (1.0 + reach / 90.0))));
        double odd = tau * (1.0 + reach / 6.0 * (1.0 + reach / 20.0 * (1.0 + reach / 42.0 * (1.0 + reach / 72.0 * (1.0 + reach / 110.0)))));
        double decay = exp(-a * tau);
        s = decay * odd;
        ds = decay * (even - a * odd);
        sigma = (1.0 - decay * (even + a * odd)) / m->kappa;
    } else if (square < 0.0) { /* under-damped */
        double omega = sqrt(-square), decay = exp(-a * tau);
        double even = cos(omega * tau), odd = sin(omega * tau) / omega;
        s = decay * odd;
        ds = decay * (even - a * odd);
        sigma = (1.0 - decay * (even + a * odd)) / m->kappa;
    } else { /* over-damped: rates kappa/(a + d) and a + d, neither found by a difference */
        double d = sqrt(square), fast = a + d, slow = m->kappa / fast;
        if (slow < 0.0 && fabs(slow * m->y0 + m->phi) <= ASTRAY * fabs(m->phi)) { /* to rest on an unstable balance */
            *x = -m->y0 * expm1(-fast * tau) / fast;
            *y = m->y0 * exp(-fast * tau);
            return;
        }
        double e_slow = exp(-slow * tau), e_fast = exp(-fast * tau);
        double grown = m->kappa == 0.0 ? tau / fast : -expm1(-slow * tau) / m->kappa;
        s = (e_slow - e_fast) / (2.0 * d);
        ds = (fast * e_fast - slow * e_slow) / (2.0 * d);
        sigma = grown * fast / (2.0 * d) + expm1(-fast * tau) / (2.0 * d * fast);
    }
    *x = m->phi == 0.0 ? m->y0 * s : m->y0 * s - m->phi * sigma; /* a kappa near the least number makes sigma infinite */
    *y = m->y0 * ds - m->phi * s;
}

/* When y falls to 0: tan(sqrt(D) tau)/sqrt(D) = y0/(phi + a y0), D = kappa - a^2. A start backwards, y0 < 0, that the
 * force turns round first, comes half a period later. */
static inline double turn_time(const motion *m) {
    double rate = m->phi + m->a * m->y0, square = m->kappa - m->a * m->a;
    if (m->y0 > 0.0 && rate > 0.0) {
        double r = m->y0 / rate, reach = square * r * r;
        if (reach > -0.98 && reach < INFINITY) return r * arc(reach);
        if (square < 0.0) {
            double d = sqrt(-square), left = m->phi + m->kappa / (m->a + d) * m->y0; /* rate - d y0, without a difference */
            if (m->a > 0.0) return left > 0.0 ? 0.5 / d * log((rate + d * m->y0) / left) : INFINITY;
            return r * arc(reach);
        }
    }
    if (!(square > 0.0)) return INFINITY;
    double angle = atan2(sqrt(square) * m->y0, rate);
    return (angle >= 0.0 ? angle : angle + 2.0 * PI) / sqrt(square);
}

/* First time with x = length > 0, and y then. */
static inline int leave_slowly(const motion *m, double length, double *tau, double *y) {
    double low = 0.0, high = turn_time(m), x;
    if (m->y0 <= 0.0 && m->phi >= 0.0) return m->phi > 0.0 || m->y0 < 0.0 ? LEFT_NOT : LEFT_NEVER;
    if (high < INFINITY) {
        move(m, high, &x, y);
        if (x < length) return LEFT_NOT;
    } else {
        if (m->kappa > 0.0 && -m->phi <= m->kappa * length * (1.0 + 1e-13)) return LEFT_NEVER;
        high = m->y0 > 0.0 ? length / m->y0 : sqrt(-2.0 * length / m->phi);
        for (int k = 0; k < DOUBLINGS; k++, high *= 2.0) {
            move(m, high, &x, y);
            if (!(x > -INFINITY)) return LEFT_NOT; /* a start backwards, on and on */
            if (!(x < length)) break;
            if (k == DOUBLINGS - 1 || high > 1e300) return LEFT_NEVER;
        }
    }
    double t = 0.5 * (low + high);
    for (int k = 0; k < ROOT_ITERATIONS; k++) {
        move(m, t, &x, y);
        if (x < length) low = t; else high = t;
        double next = *y > 0.0 ? t - (x - length) / *y : low;
        if (!(next > low && next < high) || (k > NEWTON_PATIENCE && k % 2)) next = 0.5 * (low + high); /* e^t takes a step each */
        if (fabs(next - t) <= 4e-16 * t) break;
        t = next;
    }
    *tau = t;
    return LEFT;
}

static inline int leave(const motion *m, double length, double *tau, double *y) {
    double drag = m->a * length, before = m->y0 - drag;
    double square = before * before - length * (2.0 * m->phi + m->kappa * length);
    if (m->a == 0.0) { /* energy gives y, and tan(omega tau/2) = omega length/(y0 + y) */
        if (square < 0.0 || m->y0 < 0.0) return LEFT_NOT;
        *y = sqrt(square);
        double mean = m->y0 + *y;
        if (mean <= 0.0) return m->phi == 0.0 ? LEFT_NEVER : LEFT_NOT;
        double h = length / mean;
        *tau = 2.0 * h * arc(m->kappa * h * h);
        return *tau < INFINITY ? LEFT : LEFT_NOT; /* energy is there again behind a balance out of reach */
    }
    double guess = square > 0.0 && before > 0.0 ? sqrt(square) - drag : 0.0;
    if (m->y0 == 0.0 && square > 0.0) guess = sqrt(square) - drag;
    if (!(guess > 0.1 * m->y0) || m->y0 < 0.0) return leave_slowly(m, length, tau, y);
    double t = 2.0 * length / (m->y0 + guess);
    t -= t * t * t * (m->kappa + 2.0 * m->a * (guess - m->y0) / length) / 12.0;
    if (!(t > 0.0)) return leave_slowly(m, length, tau, y);
    for (int k = 0; k < 6; k++) { /* x is exact at t; near t its Taylor polynomial is */
        double x;
        move(m, t, &x, y);
        if (!(*y > 0.0)) break;
        double miss = length - x, y1 = -(m->phi + m->kappa * x) - 2.0 * m->a * *y, y2 = -2.0 * m->a * y1 - m->kappa * *y;
        double y3 = -2.0 * m->a * y2 - m->kappa * y1, y4 = -2.0 * m->a * y3 - m->kappa * y2;
        double d = miss / *y;
        d = miss / (*y + d * (0.5 * y1 + d * (1.0 / 6 * y2)));
        double reached = d * (*y + d * (0.5 * y1 + d * (1.0 / 6 * y2 + d * (1.0 / 24 * y3 + d * (1.0 / 120) * y4))));
        d -= (reached - miss) / (*y + d * (y1 + d * (0.5 * y2 + d * (1.0 / 6 * y3))));
        if (!(t + d > 0.0)) break;
        double rough = fabs(miss) / *y; /* so short, and y so nearly constant over it, that d is good to rounding */
        if (rough <= 0.003 * t && rough * fabs(y1) <= 0.03 * *y) {
            *y += d * (y1 + d * (0.5 * y2 + d * (1.0 / 6 * y3 + d * (1.0 / 24) * y4)));
            *tau = t + d;
            return *y > 0.0 ? LEFT : leave_slowly(m, length, tau, y);
        }
        t += d;
    }
    return leave_slowly(m, length, tau, y);
}

#endif
