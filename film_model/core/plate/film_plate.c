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

/* k h of the shortest waves. From 1.4 on all waves together deflect more than the layer less the half-space. */
#define SHORTEST 1.2

/* k h of the longest waves at most: from a thickness of 1/5 of the side on, they alone deflect 3 % more than the layer. */
#define THICKEST 0.9

/* What the half-space of a contact law takes up of the plate: ln 2 - gamma - (5/6) int (f(s) - 6/s^3 - 6/(5 s) [s < 1]) ds,
 * f = (sinh s cosh s + s)/(sinh^2 s - s^2) - 1, over s = k h of waves 1/k in an elastic layer. */
static const double LOCAL = 1.054;
#define IMAGES 6 /* of a force, to each side: the next ones change its reach by 1e-19 of it */

double film_plate_around(double reach) { return log(reach) - LOCAL; }

int32_t film_plate_sheared(const film_plate *plate) {
    double h = plate->thickness, a = plate->a, b = plate->b;
    double inside = fmin(fmin(plate->x, a - plate->x), fmin(plate->y, b - plate->y));
    return h > 0.0 && inside >= h && PI * h * hypot(1.0 / a, 1.0 / b) <= THICKEST;
}

/* The plate as it is followed. */
static film_plate followed(const film_plate *plate) {
    film_plate found = *plate;
    if (!film_plate_sheared(plate)) found.thickness = found.softness = found.bulge = 0.0;
    return found;
}

static double inertia(const film_plate *plate) { return plate->mass * plate->thickness * plate->thickness / 12.0; }

/* Wave number of the shortest waves. */
static double shortest(const film_plate *plate) { return plate->thickness > 0.0 ? SHORTEST / plate->thickness : INFINITY; }

/* Square of the frequency of a wave, from k^2 and the bending energy D k^4. */
static double rate_of(const film_plate *plate, double square, double bending) {
    double mass = plate->mass, soft = plate->softness, turning = inertia(plate);
    double bent = 1.0 + soft * plate->d11 * square, last = bending + plate->bed * bent;
    double middle = mass * bent + turning * (square + plate->bed * soft);
    return last / ((middle + sqrt(middle * middle - 4.0 * mass * turning * soft * last)) / 2.0);
}

double film_plate_highest(const film_plate *plate) {
    double square = shortest(plate) * shortest(plate);
    return plate->thickness > 0.0 ? sqrt(rate_of(plate, square, plate->d11 * square * square)) : INFINITY;
}

static double wave(int64_t n, double side, double at, double order) {
    double k = (double)n * PI / side, sine = sin((double)n * PI * at / side + order * (PI / 2.0));
    return order > 0.0 ? pow(k, order) * sine : sine;
}

static double anisotropy(const film_plate *plate) { return plate->mixed / sqrt(plate->d11 * plate->d22); }

/* Half-waves along a side that a mode up to a frequency has at most, and one more. */
static double waves(const film_plate *plate, double highest, double stiffness, double side) {
    double least = fmin(1.0, (1.0 + anisotropy(plate)) / 2.0); /* energy over that of both directions alone */
    double rate = highest * highest, bent = rate * plate->mass / stiffness / least;
    double slow = rate * plate->mass * plate->softness / 2.0, turn = rate * inertia(plate) / stiffness / 2.0;
    double k = sqrt(slow + turn + sqrt((slow - turn) * (slow - turn) + bent));
    return (k > shortest(plate) ? shortest(plate) : k) * side / PI + 1.0;
}

static double most(const film_plate *plate, double highest) {
    return waves(plate, highest, plate->d11, plate->a) * waves(plate, highest, plate->d22, plate->b);
}

double film_plate_most(const film_plate *plate, double highest) {
    film_plate own = followed(plate);
    return most(&own, highest);
}

static double largest(int64_t count, double side, double at) {
    double found = 0.0;
    for (int64_t n = 1; n <= count; n++) found = fmax(found, fabs(wave(n, side, at, 0.0)));
    return found;
}

int64_t film_plate_modes(const film_plate *plate, double highest, int32_t points, const double *at, int64_t room,
                         double *frequency, double *shapes) {
    film_plate own = followed(plate);
    if (!(most(&own, highest) <= FILM_MOST_MODES)) return FILM_BAD_NUMBER;
    double a = own.a, b = own.b, turning = inertia(&own), limit = shortest(&own) * shortest(&own);
    int64_t along = (int64_t)waves(&own, highest, own.d11, a), across = (int64_t)waves(&own, highest, own.d22, b), count = 0;
    double least = NODE * largest(along, a, own.x) * largest(across, b, own.y);
    for (int64_t i = 1; i <= along; i++) {
        double u = (double)i / a, uu = u * u, half = wave(i, a, own.x, 0.0);
        for (int64_t j = 1; j <= across; j++) {
            double v = (double)j / b, vv = v * v, square = PI * PI * (uu + vv), seen = half * wave(j, b, own.y, 0.0);
            double bending = PI * PI * PI * PI * (own.d11 * uu * uu + 2.0 * own.mixed * uu * vv + own.d22 * vv * vv);
            double rate = rate_of(&own, square, bending), omega = sqrt(rate);
            if (!(omega <= highest && square <= limit && fabs(seen) > least)) continue;
            if (count < room) {
                double turn = 1.0 + own.softness * (own.bed - own.mass * rate) / square; /* over k */
                double scale = 2.0 / sqrt(a * b * (own.mass + turning * turn * turn * square));
                double moved = (1.0 - own.bulge * square * turn) * scale, *shape = shapes + count * (points + 1);
                frequency[count] = omega;
                *shape++ = moved * seen;
                for (const double *point = at; point < at + 4 * points; point += 4) {
                    double order = point[2] + point[3], factor = order == 0.0 ? moved : order == 2.0 ? turn * scale : scale;
                    *shape++ = factor * wave(i, a, point[0], point[2]) * wave(j, b, point[1], point[3]);
                }
            }
            count++;
        }
    }
    return count;
}

/* How much a force's image at a distance changes the square of its reach. */
static double image(double distance, double across, double sine) {
    double ratio = sine / sinh(PI / 2.0 / across * distance);
    return 1.0 + ratio * ratio;
}

/* Distance at which the shear around the force ends, exact: of a membrane under a point force. Green's function of a strip,
 * (1/4 pi) ln((cosh(pi x/b) - cos(pi (y + y')/b))/(cosh(pi x/b) - cos(pi (y - y')/b))), and its images at x = 2 n a, and with the
 * other sign at 2 n a - 2 x. */
static double reach(const film_plate *plate) {
    int turned = plate->a < plate->b;
    double side = turned ? plate->b : plate->a, across = turned ? plate->a : plate->b;
    double x = turned ? plate->y : plate->x, sine = sin(PI * (turned ? plate->x : plate->y) / across), square = 1.0;
    for (int n = -IMAGES; n <= IMAGES; n++) {
        if (n) square *= image(2.0 * side * n, across, sine);
        square /= image(2.0 * side * n - 2.0 * x, across, sine);
    }
    return 2.0 * across / PI * sine * sqrt(square);
}

void film_plate_shear(int64_t count, const film_plate *plates, double *found) {
    for (int64_t k = 0; k < count; k++) {
        double h = plates[k].thickness, soft = h * h / (10.0 * PI * plates[k].d11);
        found[k] = film_plate_sheared(plates + k) ? soft * film_plate_around(reach(plates + k) / h) : 0.0;
    }
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
double film_plate_compliance(const film_plate *plate) {
    double x = plate->x, y = plate->y, sheared;
    film_plate_shear(1, plate, &sheared);
    double ratio = anisotropy(plate), slender = sqrt(plate->d11 / plate->d22) * (plate->b / plate->a) * (plate->b / plate->a);
    double limit = PI / (4.0 * sqrt(2.0 * (1.0 + ratio))) / (slender * sqrt(slender));
    double angle = 2.0 * PI * y / plate->b, rest = 0.0, cosines = 0.0;
    for (int i = TERMS; i >= 1; i--) {
        double n = i, turn = n * PI * x / plate->a, sine = sin(turn);
        rest += sine * sine * (inner_sum(ratio, slender * n * n, angle) - limit / (n * n * n));
        cosines += cos(2.0 * turn) / (n * n * n);
    }
    double whole = rest + limit * (ZETA_3 - cosines) / 2.0;
    return 4.0 * plate->b * plate->b * plate->b / (PI * PI * PI * PI * plate->a * plate->d22) * whole + sheared;
}
