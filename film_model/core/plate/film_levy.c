/* Levy's solution of a plate with two opposite edges simply supported: film_panel_levy of film_panel.h.
 *
 * w = sum of w_j(x) sin(j pi y/b), with D11 w'''' - 2 (D12 + 2 D66) k^2 w'' + (D22 k^4 + bed) w = (2/b) F sin(k y) delta(x) and
 * k = j pi/b. Each w_j is the solution on an infinite strip and four exponentials that satisfy the edges; springs hold free ones.
 * The terms approach a multiple of sin^2/j^3, whose sum is known; the remainder is below 1e-7. */
#include "plate/film_panel.h"

#include <math.h>

#define PI 3.14159265358979323846
#define ZETA_3 1.2020569031595942 /* sum of 1/j^3 */
#define TERMS 2000
#define DISTINCT 1e-4 /* least relative distance of the roots' squares: the error is its square, the loss of digits its inverse */

typedef struct {
    double re, im;
} number; /* complex: not all compilers have those of C99 */

static number plus(number a, number b) { return (number){a.re + b.re, a.im + b.im}; }
static number minus(number a, number b) { return (number){a.re - b.re, a.im - b.im}; }
static number times(number a, number b) { return (number){a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re}; }
static number scaled(double s, number a) { return (number){s * a.re, s * a.im}; }
static double square(number a) { return a.re * a.re + a.im * a.im; }

static number over(number a, number b) {
    return scaled(1.0 / square(b), times(a, (number){b.re, -b.im}));
}

static number decay(number rate, double distance) { /* exp(-rate distance) */
    double size = exp(-rate.re * distance), angle = rate.im * distance;
    return (number){size * cos(angle), -size * sin(angle)};
}

static number root(number a) {
    double size = sqrt(square(a)), re = sqrt(fmax(0.5 * (size + a.re), 0.0)), im = sqrt(fmax(0.5 * (size - a.re), 0.0));
    if (a.re > 0.0) im = re > 0.0 ? fabs(a.im) / (2.0 * re) : 0.0;
    else if (im > 0.0) re = fabs(a.im) / (2.0 * im);
    return (number){re, a.im < 0.0 ? -im : im};
}

static number power(number a, int n) { /* n from -1 to 3 */
    number found = {1.0, 0.0};
    for (int k = 0; k < n; k++) found = times(found, a);
    return n < 0 ? over(found, a) : found;
}

typedef struct {
    number rates[2], scale;
} strip;

/* n-th derivative of the solution on the infinite strip, at a distance, outwards. */
static number alone(const strip *s, double distance, int n) {
    number one = s->rates[0], two = s->rates[1];
    number far = over(times(power(scaled(-1.0, one), n), decay(one, distance)), one);
    number near = over(times(power(scaled(-1.0, two), n), decay(two, distance)), two);
    return over(minus(near, far), s->scale);
}

/* The solution of four equations, in `right`. */
static void solve(number matrix[4][4], number right[4]) {
    for (int k = 0; k < 4; k++) {
        int best = k;
        for (int i = k + 1; i < 4; i++)
            if (square(matrix[i][k]) > square(matrix[best][k])) best = i;
        for (int j = 0; j < 4; j++) {
            number kept = matrix[k][j];
            matrix[k][j] = matrix[best][j];
            matrix[best][j] = kept;
        }
        number kept = right[k];
        right[k] = right[best];
        right[best] = kept;
        for (int i = k + 1; i < 4; i++) {
            number factor = over(matrix[i][k], matrix[k][k]);
            for (int j = k; j < 4; j++) matrix[i][j] = minus(matrix[i][j], times(factor, matrix[k][j]));
            right[i] = minus(right[i], times(factor, right[k]));
        }
    }
    for (int k = 3; k >= 0; k--) {
        for (int j = k + 1; j < 4; j++) right[k] = minus(right[k], times(matrix[k][j], right[j]));
        right[k] = over(right[k], matrix[k][k]);
    }
}

/* w_j(x) under a unit force there, but for the factor 2/b. */
static double term(const film_panel *panel, double x, double k) {
    double d11 = panel->d11, both = panel->d12 + 2.0 * panel->d66, mean = both / d11, bed = panel->bed / (k * k * k * k);
    number spread = scaled(1.0 / d11, root((number){both * both - d11 * (panel->d22 + bed), 0.0}));
    if (square(spread) < DISTINCT * mean * DISTINCT * mean) spread = (number){DISTINCT * fabs(mean), 0.0};
    strip s = {{scaled(k, root(plus((number){mean, 0.0}, spread))), scaled(k, root(minus((number){mean, 0.0}, spread)))}, {0.0, 0.0}};
    s.scale = scaled(2.0 * d11, minus(power(s.rates[0], 2), power(s.rates[1], 2)));
    number matrix[4][4], right[4], waves[4];
    for (int end = 0; end < 2; end++) {
        int32_t kind = panel->edges[end];
        double distance = end ? panel->a - x : x;
        for (int row = 2 * end; row < 2 * end + 2; row++) {
            int second = row - 2 * end, n = kind == FILM_EDGE_CLAMPED ? second : kind == FILM_EDGE_FREE ? 2 + second : 2 * second;
            /* every function is written from this edge inwards; derivatives are taken outwards */
            double less = kind == FILM_EDGE_FREE ? (panel->d12 + (n == 3 ? 4.0 * panel->d66 : 0.0)) / d11 * k * k : 0.0;
            double held = n == 3 ? panel->springs[end] / d11 : 0.0;
            for (int column = 0; column < 2; column++) {
                number rate = s.rates[column], back = scaled(-1.0, rate), kept = {held, 0.0};
                number near = minus(power(rate, n), kept), far = minus(power(back, n), kept);
                if (less != 0.0) {
                    near = minus(near, scaled(less, power(rate, n - 2)));
                    far = minus(far, scaled(less, power(back, n - 2)));
                }
                matrix[row][2 * end + column] = near;
                matrix[row][2 * (1 - end) + column] = times(far, decay(rate, panel->a));
            }
            number missing = minus(alone(&s, distance, n), scaled(held, alone(&s, distance, 0)));
            if (less != 0.0) missing = minus(missing, scaled(less, alone(&s, distance, n - 2)));
            right[row] = scaled(-1.0, missing);
        }
        for (int column = 0; column < 2; column++) waves[2 * end + column] = decay(s.rates[column], distance);
    }
    solve(matrix, right);
    number found = alone(&s, 0.0, 0);
    for (int c = 0; c < 4; c++) found = plus(found, times(right[c], waves[c]));
    return found.re;
}

double film_panel_levy(const film_panel *panel, double x, double y) {
    double step = PI / panel->b, limit = term(panel, x, TERMS * step) * TERMS * TERMS * TERMS, rest = 0.0, cosines = 0.0;
    for (int j = TERMS; j >= 1; j--) {
        double cube = (double)j * j * j, sine = sin(j * step * y);
        rest += sine * sine * (term(panel, x, j * step) - limit / cube);
        cosines += cos(2.0 * j * step * y) / cube;
    }
    return 2.0 / panel->b * (rest + limit * (ZETA_3 - cosines) / 2.0);
}
