/* Friction in many impacts: in closed form where a contact slides throughout, by a table where Hertz's law gives back its work
 * and nothing else acts, else as film_friction.
 *
 * The table holds Chebyshev series in x and y, 0 to 1, over chi = rate/2 and psi = |D'|/approach; examples/friction_table.py
 * makes it and has the same panels. Cuts: psi = 1, where sliding begins, with series in the fifth root of psi - 1 beyond;
 * psi = 2 chi, where sliding stops at the turn; and chi = corner(psi), above which slip changes its sign once more before the
 * contact ends. */
#include "oblique/film_friction_parts.h"

#include <math.h>
#include <string.h>

enum { CORNER, BELOW, ABOVE, FORCE, TIME, EARLY, LATE = EARLY + 3, OUTWARD = LATE + 3, PANELS }; /* EARLY, LATE: 3 each */
enum { MOST_TERMS = 32 };

static const double FEWEST = 0.01; /* psi, below which coarse steps would be too coarse; test of coarse steps */
static const double CLOSED = 1e-4; /* of a motion with errors of 1e-5: beyond, an event was missed */
static const double PI = 3.14159265358979323846;
static const double LEAST_CHI = 0.8, MOST_CHI = 1.751, LAST_CHI = 1.9; /* of the table; where ABOVE ends */
static const double EARLIEST = 0.15;                                  /* (psi - 1)/(2 chi - 1) up to which EARLY holds */

static void chebyshev(double x, int terms, double *to) {
    double z = 2.0 * x - 1.0;
    to[0] = 1.0, to[1] = z;
    for (int k = 2; k < terms; k++) to[k] = 2.0 * z * to[k - 1] - to[k - 2];
}

/* What impacts of one chi and one exponent share: series in x of the panels whose y is chi alone, and the time of the turn. */
typedef struct {
    double chi, exponent, turn, series[PANELS][MOST_TERMS];
    int made[PANELS];
} shared;

/* The series in x of a panel at y; returns its terms. A panel's head: where its coefficients begin, and how many terms it has
 * in x and, a multiple of 4, in y. */
static int series_at(const double *table, int which, double y, double *to) {
    const double *head = table + 3 * which, *at = table + (int)head[0];
    int terms = (int)head[1], rows = (int)head[2];
    double in_y[MOST_TERMS];
    chebyshev(y, rows, in_y);
    for (int i = 0; i < terms; i++, at += rows) {
        double part[4] = {0.0, 0.0, 0.0, 0.0};
        for (int j = 0; j < rows; j += 4) {
            for (int k = 0; k < 4; k++) part[k] += at[j + k] * in_y[j + k];
        }
        to[i] = (part[0] + part[1]) + (part[2] + part[3]);
    }
    return terms;
}

static double sum(const double *series, int terms, double x) {
    double in_x[MOST_TERMS], total = 0.0;
    chebyshev(x, terms, in_x);
    for (int i = 0; i < terms; i++) total += in_x[i] * series[i];
    return total;
}

static double panel(const double *table, int which, double x, double y) {
    double series[MOST_TERMS];
    int terms = series_at(table, which, y, series);
    return sum(series, terms, x);
}

/* A panel over x and the chi that impacts share. */
static double across(const double *table, shared *of, int which, double x) {
    int *made = &of->made[which];
    if (!*made) *made = series_at(table, which, (of->chi - LEAST_CHI) / (MOST_CHI - LEAST_CHI), of->series[which]);
    return sum(of->series[which], *made, x);
}

/* By the table, over approach, force and time of the dimensionless motion, for psi >= 0 below 4 chi - 1. */
static void look_up(const double *table, double psi, shared *of, film_friction_brief *to) {
    double chi = of->chi, late = (psi - 1.0) / (2.0 * chi - 1.0);
    if (psi <= 1.0) {
        double corner = panel(table, CORNER, psi, 0.0);
        if (chi <= corner) to->velocity = psi * panel(table, BELOW, psi, (chi - LEAST_CHI) / (corner - LEAST_CHI));
        else to->velocity = psi * panel(table, ABOVE, psi, sqrt((chi - corner) / (LAST_CHI - corner)));
        to->force = psi * across(table, of, FORCE, 0.0);
        to->time_of_force = across(table, of, TIME, 0.0);
    } else if (late < 1.0) {
        int early = late < EARLIEST, first = early ? EARLY : LATE;
        double x = early ? pow(late / EARLIEST, 0.2) : (late - EARLIEST) / (1.0 - EARLIEST);
        to->velocity = across(table, of, first, x);
        to->force = across(table, of, first + 1, x);
        to->time_of_force = across(table, of, first + 2, x);
    } else {
        to->velocity = across(table, of, OUTWARD, late - 1.0); /* the force is largest at the turn, as without friction */
    }
}

/* Whether a motion is known without steps, with the approach velocity as unit. */
static int known(const film_normal *normal, double rate, double velocity, const double *table, shared *of, film_friction_brief *to) {
    int linear = normal->coefficient == 0.0, alone = linear || normal->slope == 0.0;
    double n = linear ? 1.0 : normal->exponent, psi = fabs(velocity), chi = 0.5 * rate;
    if (!alone || normal->gamma != 0.0 || normal->load != 0.0) return 0;
    int slides = psi >= 1.0 && psi >= 2.0 * rate - 1.0;
    if (!slides && !(table && n == 1.5 && chi >= LEAST_CHI && chi <= MOST_CHI)) return 0;
    if (of->chi != chi) of->chi = chi, memset(of->made, 0, sizeof of->made);
    if (of->exponent != n) of->exponent = n, of->turn = sqrt(PI) * tgamma(1.0 + 1.0 / (n + 1.0)) / tgamma(0.5 + 1.0 / (n + 1.0));
    to->velocity = psi - 2.0 * rate;
    to->force = 0.5 * (n + 1.0); /* at the turn, after half the contact */
    to->time_of_force = of->turn;
    if (!slides) look_up(table, psi, of, to);
    to->velocity = copysign(1.0, velocity) * to->velocity;
    to->regime = slides ? FILM_SLIDES_THROUGHOUT : psi > 1.0 ? FILM_SLIDES_FIRST : FILM_STICKS_FIRST;
    return 1;
}

static void one(const film_normal *normal, double rate, double velocity, int coarse, const double *table, shared *of,
                film_friction_brief *to) {
    double approach = normal->approach;
    film_friction_result found;
    memset(to, 0, sizeof *to);
    if (film_friction_sound(normal, rate, velocity) && known(normal, rate, velocity / approach, coarse ? table : NULL, of, to)) {
        double depth = film_friction_depth(normal);
        to->velocity *= approach;
        to->force *= approach * approach / depth;
        to->time_of_force *= depth / approach;
        if (isfinite(to->velocity + to->force + to->time_of_force)) return;
        to->status = FILM_BAD_NUMBER;
        return;
    }
    if (fabs(velocity) <= FEWEST * approach) coarse = FILM_FRICTION_EXACT;
    int quick = coarse == FILM_FRICTION_QUICK && film_friction_quick(normal, rate, velocity, coarse, &found, NULL, 1, 0, NULL) == FILM_OK;
    quick = quick && found.closure <= CLOSED;
    to->status = quick ? FILM_OK : film_friction(normal, rate, velocity, coarse ? FILM_FRICTION_COARSE : FILM_FRICTION_EXACT, &found, NULL, 1, 0, NULL);
    to->velocity = found.velocity, to->force = found.force, to->time_of_force = found.time_of_force;
    to->closure = found.closure, to->steps = found.steps, to->regime = found.regime;
}

void film_friction_many(int64_t count, const film_normal *normals, const double *rates, const double *velocities,
                        int coarse, const double *table, film_friction_brief *results) {
    shared of = {.chi = NAN, .exponent = NAN};
    for (int64_t i = 0; i < count; i++) one(&normals[i], rates[i], velocities[i], coarse, table, &of, &results[i]);
}

void film_friction_sizes(int64_t sizes[3]) {
    sizes[0] = (int64_t)sizeof(film_normal);
    sizes[1] = (int64_t)sizeof(film_friction_result);
    sizes[2] = (int64_t)sizeof(film_friction_brief);
}
