/* Ritz's method for plates with any edges, as film_panel.h says. */
#include "plate/film_panel.h"

#include <math.h>

#define PI 3.14159265358979323846
#define HIGH 32      /* functions of a side below this always matter: the first vibrations are then accurate */
#define NEAR 1.05    /* waves over those at the highest frequency, up to which functions always matter */
#define LONE 0.85    /* and beyond those along the other side */
#define HELD 0.94    /* sharpness that they need, as no edge is free, over that of others */
#define DECAYED 24.0 /* exponent at which a coefficient is neglected: e^-24 = 4e-11 */

static double wave_of(int32_t p) { return (p + 1) * (PI / 2.0); } /* of the sines of a line without series */

static double bent(const film_ritz *line, int32_t p) { return line->bent ? line->bent[p] : pow(wave_of(p), 4.0); }

static double sloped(const film_ritz *line, int32_t p, int32_t q) {
    return line->sloped ? line->sloped[(ptrdiff_t)p * line->functions + q] : p == q ? wave_of(p) * wave_of(p) : 0.0;
}

static double crossed(const film_ritz *line, int32_t p, int32_t q) {
    return line->crossed ? line->crossed[(ptrdiff_t)p * line->functions + q] : -sloped(line, p, q);
}

double film_panel_waves(const film_panel *panel, int32_t along, double highest) {
    double bending = along ? panel->d22 : panel->d11, side = along ? panel->b : panel->a;
    return sqrt(sqrt(panel->mass * highest * highest / bending)) * side / PI;
}

/* Two for each half-wave across, or for the decay e^(-kappa y) from an edge, whose coefficients fall as e^(-n^2/(kappa b)); four
 * steps an octave, so that many half-waves share their polynomials. */
int32_t film_panel_degree(const film_panel *panel, double wave, double highest, double spare) {
    double square = wave * wave, mean = (panel->d12 + 2.0 * panel->d66) / panel->d22 * square;
    double spread = (panel->mass * highest * highest - panel->d11 * square * square) / panel->d22;
    double root = sqrt(fmax(mean * mean + spread, 0.0));
    double across = sqrt(fmax(root - mean, 0.0)) * panel->b, decay = sqrt(fmax(root + mean, 0.0)) * panel->b;
    double degree = spare + fmax(2.0 / PI * across, sqrt(DECAYED * decay));
    int power;
    (void)frexp(degree, &power);
    double octave = ldexp(1.0, power - 3); /* a quarter of the power of 2 that is not above it */
    return (int32_t)(ceil(degree / octave) * octave);
}

/* Whether even and odd functions along a side do not interact. */
static int symmetric(const film_panel *panel, int32_t along) {
    const double *springs = panel->springs + 2 * along;
    return panel->edges[2 * along] == panel->edges[2 * along + 1] && springs[0] == springs[1];
}

static int32_t halves(const film_panel *panel, const film_ritz *line, int32_t along) {
    const int32_t *edges = panel->edges + 2 * along;
    if (edges[0] == FILM_EDGE_SIMPLE && edges[1] == FILM_EDGE_SIMPLE) return line->functions; /* each half-wave vibrates alone */
    return symmetric(panel, along) ? 2 : 1;
}

static int32_t half_of(const film_ritz *line, int32_t count, int32_t p) {
    return count == line->functions ? p : count == 2 ? line->odd[p] : 0;
}

int32_t film_panel_groups(const film_panel *panel, const film_ritz *x, const film_ritz *y) {
    return halves(panel, x, 0) * halves(panel, y, 1);
}

/* Whether no edge is free. High functions of q waves along the other side then change vibrations by about q^4/p^5 of their p waves. */
static int supported(const film_panel *panel) {
    int found = 1;
    for (int k = 0; k < 4; k++) found = found && panel->edges[k] != FILM_EDGE_FREE;
    return found;
}

int32_t film_panel_group(const film_panel *panel, const film_ritz *x, const film_ritz *y, double highest, double sharpness,
                         int32_t least, int32_t group, int32_t *p, int32_t *q) {
    int32_t along = halves(panel, x, 0), across = halves(panel, y, 1), count = 0, held = supported(panel);
    double a = 2.0 / panel->a, b = 2.0 / panel->b, limit = panel->mass * highest * highest;
    for (int32_t i = 0; i < x->functions; i++) {
        if (half_of(x, along, i) != group / across) continue;
        for (int32_t j = 0; j < y->functions; j++) {
            if (half_of(y, across, j) != group % across) continue;
            double one = panel->d11 * pow(a, 4.0) * bent(x, i) / limit, two = panel->d22 * pow(b, 4.0) * bent(y, j) / limit;
            double mixed = 4.0 * panel->d66 * sloped(x, i, i) * sloped(y, j, j) + 2.0 * panel->d12 * crossed(x, i, i) * crossed(y, j, j);
            double waves = sqrt(sqrt(one)), others = sqrt(sqrt(two)); /* over those at the highest frequency */
            int always = i >= x->shapes || i < least, also = j >= y->shapes || j < least;
            int high = held && (i >= HIGH || j >= HIGH);
            int first = high ? (always && also) || (always && others <= NEAR) || (also && waves <= NEAR) : always || also;
            int matters = !high || (waves <= fmax(NEAR, LONE + others) && others <= fmax(NEAR, LONE + waves));
            double most = sharpness * (high ? HELD : 1.0);
            if (!first && !(matters && one + two + a * a * b * b * mixed / limit <= most * most)) continue;
            p[count] = i;
            q[count++] = j;
        }
    }
    return count;
}

/* Energy of two products in the springs of the edges that bound one side. */
static double sprung(const double *springs, const film_ritz *line, double scale, int32_t i, int32_t j) {
    double found = 0.0;
    for (int32_t k = 0; k < 2; k++) {
        double s = k ? 1.0 : -1.0;
        if (springs[k] != 0.0) found += springs[k] * scale * film_ritz_at(line, i, s) * film_ritz_at(line, j, s);
    }
    return found;
}

void film_panel_energy(const film_panel *panel, const film_ritz *x, const film_ritz *y, int32_t n, const int32_t *p,
                       const int32_t *q, double *energy) {
    double a = 2.0 / panel->a, b = 2.0 / panel->b, both = a * a * b * b;
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j <= i; j++) {
            double twist = 4.0 * panel->d66 * sloped(x, p[i], p[j]) * sloped(y, q[i], q[j]);
            double saddle = crossed(x, p[i], p[j]) * crossed(y, q[j], q[i]) + crossed(x, p[j], p[i]) * crossed(y, q[i], q[j]);
            double found = both * (twist + panel->d12 * saddle);
            if (i == j) found += panel->d11 * pow(a, 4.0) * bent(x, p[i]) + panel->d22 * pow(b, 4.0) * bent(y, q[i]) + panel->bed;
            if (q[i] == q[j]) found += sprung(panel->springs, x, a, p[i], p[j]);
            if (p[i] == p[j]) found += sprung(panel->springs + 2, y, b, q[i], q[j]);
            energy[(ptrdiff_t)i * n + j] = energy[(ptrdiff_t)j * n + i] = found;
        }
}
