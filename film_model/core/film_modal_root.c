/* Roots of a polynomial on 0 .. 1 by its Bernstein coefficients: where they are all positive it has none, and halving an
 * interval gives the coefficients on both halves (de Casteljau). No root can be missed. docs/method.md, section 13. */
#include "film_modal_parts.h"

#include <string.h>

enum { DEPTH = 50, MOST_PARTS = 400 };

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
    double c[DEGREE + 1], left[DEGREE + 1] = {0.0};
    memcpy(c, bernstein, sizeof(double) * (size_t)(degree + 1));
    split(c, degree, at, left);
    return left[degree];
}

static int all_above(const part *p, int degree) {
    for (int i = 0; i <= degree; i++)
        if (p->c[i] < 0.0) return 0;
    return 1;
}

double film_first_below(const double *bernstein, int degree, double from) {
    part stack[DEPTH + 2], now;
    double left[DEGREE + 1] = {0.0};
    int count = 1;
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
        if (all_above(&now, degree)) continue;
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
