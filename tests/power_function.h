/* A function of the core, for the C checks. */
#ifndef POWER_FUNCTION_H
#define POWER_FUNCTION_H

#include "film_core.h"

#include <string.h>

/* constant + slope x + coefficient x^exponent, x = xi - origin. */
static film_function power(double origin, double constant, double slope, double coefficient, double exponent) {
    film_function g;
    memset(&g, 0, sizeof g);
    g.form = FILM_POWER;
    g.origin = origin;
    g.per_span = 1.0;
    g.constant = constant;
    g.slope = slope;
    g.coefficient = coefficient;
    g.exponent = exponent;
    return g;
}

#endif
