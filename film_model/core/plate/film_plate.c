/* A simply supported rectangular plate in closed form, as film_plate.h says. */
#include "plate/film_plate.h"

#include "modal/film_modal.h"

#include <math.h>

#define PI 3.14159265358979323846
#define ZETA_3 1.2020569031595942 /* sum of 1/i^3 */

/* A shape smaller than this, over the largest there, is a node: rounding leaves 1e-13 of sines of a thousand half-waves.
 * Shares are its square. tests/test_plate_modes.py counts the modes at the centre. */
#define NODE 1e-10

/* A^2 - 1 below which the difference of the sums of both roots comes from derivatives at two Gauss nodes between them: their
 * error is 1e-13 there, and the difference would lose as many digits as the roots share. tests/test_static_stiffness.py. */
#define DOUBLE_ROOT 1e-6
#define COMPLEX_STEP 1e-8 /* of the derivative */

#define TERMS 10000 /* of the sum over i: the known sum of cosines over cubes lacks 5e-9/1.2 of itself at most */

static double wave(int64_t n, double side, double at, double order) {
    double k = (double)n * PI / side, sine = sin((double)n * PI * at / side + order * (PI / 2.0));
    return order > 0.0 ? pow(k, order) * sine : sine;
}

static double anisotropy(const film_plate *plate) { return plate->mixed / sqrt(plate->d11 * plate->d22); }

/* Half-waves along a side that a mode up to a frequency has at most, and one more. */
static double waves(const film_plate *plate, double highest, double stiffness, double side) {
    double least = fmin(1.0, (1.0 + anisotropy(plate)) / 2.0); /* energy over that of both directions alone */
    double square = highest * highest * plate->mass / (PI * PI * PI * PI) / least;
    return sqrt(sqrt(square / stiffness)) * side + 1.0;
}

double film_plate_most(const film_plate *plate, double highest) {
    return waves(plate, highest, plate->d11, plate->a) * waves(plate, highest, plate->d22, plate->b);
}

static double largest(int64_t most, double side, double at) {
    double found = 0.0;
    for (int64_t n = 1; n <= most; n++) found = fmax(found, fabs(wave(n, side, at, 0.0)));
    return found;
}

int64_t film_plate_modes(const film_plate *plate, double highest, int32_t points, const double *at, int64_t room,
                         double *frequency, double *shapes) {
    if (!(film_plate_most(plate, highest) <= FILM_MOST_MODES)) return FILM_BAD_NUMBER;
    int64_t along = (int64_t)waves(plate, highest, plate->d11, plate->a);
    int64_t across = (int64_t)waves(plate, highest, plate->d22, plate->b), count = 0;
    double least = NODE * largest(along, plate->a, at[0]) * largest(across, plate->b, at[1]);
    for (int64_t i = 1; i <= along; i++) {
        double u = (double)i / plate->a, own = wave(i, plate->a, at[0], 0.0);
        for (int64_t j = 1; j <= across; j++) {
            double v = (double)j / plate->b, uu = u * u, vv = v * v;
            double square = PI * PI * PI * PI * (plate->d11 * uu * uu + 2.0 * plate->mixed * uu * vv + plate->d22 * vv * vv);
            double omega = sqrt((square + plate->bed) / plate->mass);
            if (!(omega <= highest) || !(fabs(own * wave(j, plate->b, at[1], 0.0)) > least)) continue;
            if (count < room) {
                frequency[count] = omega;
                for (int32_t p = 0; p < points; p++) {
                    const double *point = at + 4 * p;
                    double across_it = wave(j, plate->b, point[1], point[3]);
                    shapes[count * points + p] = wave(i, plate->a, point[0], point[2]) * across_it;
                }
            }
            count++;
        }
    }
    return count;
}

typedef struct {
    double re, im;
} number; /* complex: not all compilers have those of C99 */

/* exp(-z) */
static number decay(number z) {
    double size = exp(-z.re);
    return (number){size * cos(z.im), -size * sin(z.im)};
}

/* 2 times the sum over j of sin^2(j angle/2)/(j^2 + p^2) */
static number sum_over_j(number p, double angle) {
    number far = decay((number){2.0 * PI * p.re, 2.0 * PI * p.im});
    number near = decay((number){angle * p.re, angle * p.im});
    number other = decay((number){(2.0 * PI - angle) * p.re, (2.0 * PI - angle) * p.im});
    number above = {1.0 + far.re - near.re - other.re, far.im - near.im - other.im};
    number below = {p.re * (1.0 - far.re) + p.im * far.im, p.im * (1.0 - far.re) - p.re * far.im};
    double scale = PI / 2.0 / (below.re * below.re + below.im * below.im);
    return (number){scale * (above.re * below.re + above.im * below.im), scale * (above.im * below.re - above.re * below.im)};
}

/* -1/2 of its derivative by the square of a real p. */
static double slope_over_j(double square, double angle) {
    double p = sqrt(square);
    return -sum_over_j((number){p, 0.5 * COMPLEX_STEP * p}, angle).im / (2.0 * COMPLEX_STEP * square);
}

/* The sum over j of sin^2(j angle/2)/(j^4 + 2 A m j^2 + m^2) by partial fractions: the roots are -j^2 = m (A +- sqrt(A^2 - 1)),
 * and their square roots are sqrt(m) (cosine +- sine), the second of these imaginary if A < 1. */
static double inner_sum(double ratio, double mean, double angle) {
    double off = (ratio - 1.0) * (ratio + 1.0), root = sqrt(mean);
    if (off < DOUBLE_ROOT && off > -COMPLEX_STEP * COMPLEX_STEP) {
        double step = sqrt(fmax(off, 0.0) / 3.0);
        return 0.5 * (slope_over_j(mean * (ratio + step), angle) + slope_over_j(mean * (ratio - step), angle));
    }
    double cosine = sqrt((1.0 + ratio) / 2.0), sine = sqrt(fabs(ratio - 1.0) / 2.0), scale = 4.0 * mean * cosine * sine;
    if (off < 0.0) return -sum_over_j((number){root * cosine, root * sine}, angle).im / scale;
    number far = {root * (cosine + sine), 0.0}, near = {root / (cosine + sine), 0.0};
    return 0.5 * (sum_over_j(near, angle).re - sum_over_j(far, angle).re) / scale;
}

/* Navier's double series (4/(a b)) sum phi^2/(mass omega^2). The terms of the sum over i approach those of
 * limit sum sin^2(i pi x/a)/i^3 exponentially; that sum is known. */
double film_plate_compliance(const film_plate *plate, double x, double y) {
    double ratio = anisotropy(plate), slender = sqrt(plate->d11 / plate->d22) * (plate->b / plate->a) * (plate->b / plate->a);
    double limit = PI / (4.0 * sqrt(2.0 * (1.0 + ratio))) / (slender * sqrt(slender));
    double angle = 2.0 * PI * y / plate->b, rest = 0.0, cosines = 0.0;
    for (int i = TERMS; i >= 1; i--) {
        double n = i, turn = n * PI * x / plate->a, sine = sin(turn);
        rest += sine * sine * (inner_sum(ratio, slender * n * n, angle) - limit / (n * n * n));
        cosines += cos(2.0 * turn) / (n * n * n);
    }
    double whole = rest + limit * (ZETA_3 - cosines) / 2.0;
    return 4.0 * plate->b * plate->b * plate->b / (PI * PI * PI * PI * plate->a * plate->d22) * whole;
}
