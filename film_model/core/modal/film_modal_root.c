/* Roots of a polynomial on 0 .. 1 by its Bernstein coefficients: where they are all positive it has none, and halving an
 * interval gives the coefficients on both halves (de Casteljau). No root can be missed. Where the
 * coefficients change their sign once the interval has one root, and Newton's method finds it. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

enum { DEPTH = 50, MOST_PARTS = 400, NEWTON_STEPS = 60 };

static const double CONVERGED = 2e-16; /* of a step of Newton's method, in an interval of 0 .. 1 */

typedef struct {
    double c[DEGREE + 1], begin, width;
} part;

/* Splits at `at`: the part before into *left, the part after stays. */
static void split(double *c, int degree, double at, double *left) {
    for (int i = 0; i <= degree; i++) {
        left[i] = c[0];
        for (int k = 0; k < degree - i; k++) c[k] += at * (c[k + 1] - c[k]);
    }
}

double film_bernstein(const double *bernstein, int degree, double at) {
    double before = 1.0 - at, power = 1.0, choose = 1.0, sum = bernstein[0] * before;
    for (int k = 1; k < degree; k++) { /* sum = (1 - at)^(1 - k) times the terms before k */
        power *= at;
        choose *= (double)(degree - k + 1) / k;
        sum = (sum + choose * power * bernstein[k]) * before;
    }
    return sum + power * at * bernstein[degree];
}

static int all_above(const double *c, int degree) {
    for (int i = 0; i <= degree; i++)
        if (c[i] < 0.0) return 0;
    return 1;
}

/* The first negative coefficient, if those before it are not negative and none after it is positive; else 0. */
static int sign_change(const double *c, int degree) {
    int first = 0;
    while (first <= degree && c[first] >= 0.0) first++;
    for (int i = first; i <= degree; i++)
        if (c[i] > 0.0) return 0;
    return first;
}

/* The root on 0 .. 1 of a polynomial that has one, from where its coefficients, drawn as a polygon, change their sign. */
static double only_root(const double *coefficients, int degree, int first) {
    const double *last = coefficients + first;
    double low = 0.0, high = 1.0, at = (first - 1.0 + last[-1] / (last[-1] - last[0])) / degree;
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double c[DEGREE + 1], value, slope, next;
        memcpy(c, coefficients, sizeof(double) * (size_t)(degree + 1));
        for (int n = degree; n > 1; n--)
            for (int k = 0; k < n; k++) c[k] += at * (c[k + 1] - c[k]);
        slope = degree * (c[1] - c[0]);
        value = c[0] + at * (c[1] - c[0]);
        if (value > 0.0) low = at; else high = at;
        next = at - value / slope;
        if (!(next > low && next < high)) next = fabs(next - at) <= CONVERGED ? at : 0.5 * (low + high);
        if (fabs(next - at) <= CONVERGED) return next;
        at = next;
    }
    return at;
}

double film_first_below(const double *bernstein, int degree, double from) {
    part stack[DEPTH + 2], now;
    double left[DEGREE + 1] = {0.0};
    int count = 1;
    if (from == 0.0 && bernstein[0] > 0.0 && all_above(bernstein, degree)) return 2.0;
    memset(stack, 0, sizeof(part));
    memcpy(stack[0].c, bernstein, sizeof(double) * (size_t)(degree + 1));
    stack[0].begin = from;
    stack[0].width = 1.0 - from;
    if (!(from < 1.0)) return 2.0;
    if (from > 0.0) split(stack[0].c, degree, from, left);
    if (!(stack[0].c[0] > 0.0)) {
        if (!(stack[0].c[1] > stack[0].c[0])) return from;
        stack[0].c[0] = 0.0;
        if (stack[0].c[1] < 0.0) stack[0].c[1] = 0.0;
    }
    for (int parts = 0; count > 0 && parts < MOST_PARTS; parts++) {
        now = stack[--count];
        if (all_above(now.c, degree)) continue;
        int first = sign_change(now.c, degree);
        if (first > 0) return now.begin + now.width * only_root(now.c, degree, first);
        if (now.width <= 1e-15 || count > DEPTH - 2) return now.begin + now.width;
        now.width *= 0.5;
        split(now.c, degree, 0.5, left); /* now.c: the half after the middle */
        stack[count] = now;
        stack[count++].begin += now.width;
        memcpy(now.c, left, sizeof left);
        stack[count++] = now;
    }
    return 2.0;
}
