/* Loops over lanes, powers, and whole ways by tables. Internal to film_lanes.c. docs/method.md, section 10.
 *
 * Plain loops over LANES, which compilers turn into vector instructions. Each lane sees the same operations in the same
 * order whatever the other lanes hold and however wide the registers are, so the result of an impact depends on that impact
 * alone: no fused multiply-add, no sum across lanes, no libm function but sqrt; a lane that has converged is not changed. */
#ifndef FILM_LANE_POWER_H
#define FILM_LANE_POWER_H

#include "lanes/film_lanes.h"

#include <string.h>

#if defined(__GNUC__)
#define INLINED static inline __attribute__((always_inline))
#define CALLED static __attribute__((noinline)) /* of which compilers make vector instructions only apart from its caller */
#else
#define INLINED static inline
#define CALLED static
#endif

#define EACH(l) for (int l = 0; l < LANES; l++)

/* Lanes of a group, of which polynomials or springs fit into the nearest cache. Affects cost only. */
enum { GROUP = LANES < 8 ? LANES : 8 };
#define EACH_OF(l) for (int l = 0; l < GROUP; l++)

/* Whether a flag is set. Flags are doubles, 1 or 0, so that SSE2 instructions can select by them. */
static int any(const double *flag) {
    uint64_t bits[LANES], all = 0;
    memcpy(bits, flag, sizeof bits);
    EACH(l) all |= bits[l];
    return all != 0;
}

/* log2 x = e + 2/ln 2 atanh((m - 1)/(m + 1)), x = 2^e m, m from 1/sqrt 2 to sqrt 2; x > 0 and not subnormal. */
static void log2_lanes(const double *restrict x, double *restrict out) {
    uint64_t bits[LANES], high[LANES];
    double m[LANES], e[LANES];
    memcpy(bits, x, sizeof bits);
    EACH(l) {
        high[l] = (bits[l] >> 52) | 0x4330000000000000u; /* as a number: 2^52 + the biased exponent */
        bits[l] = (bits[l] & 0x000fffffffffffffu) | 0x3ff0000000000000u;
    }
    memcpy(m, bits, sizeof m);
    memcpy(e, high, sizeof e);
    EACH(l) {
        double y = m[l] > 1.4142135623730951 ? 0.5 * m[l] : m[l];
        double whole = e[l] - (4503599627370496.0 + (m[l] > 1.4142135623730951 ? 1022.0 : 1023.0));
        double s = (y - 1.0) / (y + 1.0), z = s * s;
        double low = 1.0 / 13 + z * (1.0 / 15 + z * (1.0 / 17 + z * (1.0 / 19)));
        double sum = 1.0 + z * (1.0 / 3 + z * (1.0 / 5 + z * (1.0 / 7 + z * (1.0 / 9 + z * (1.0 / 11 + z * low)))));
        out[l] = whole + 2.8853900817779268 * (s * sum);
    }
}

/* 2^y, with y clamped to -1000 .. 1000. */
static void exp2_lanes(const double *restrict y, double *restrict out) {
    static const double shift = 6755399441055744.0; /* 1.5 2^52: adding and subtracting it rounds to a whole number */
    uint64_t count[LANES], bits[LANES];
    double t[LANES], p[LANES];
    EACH(l) {
        double x = y[l] < -1000.0 ? -1000.0 : y[l];
        x = x > 1000.0 ? 1000.0 : x;
        t[l] = x + shift;
        double r = 0.6931471805599453 * (x - (t[l] - shift));
        double end = 1.0 / 39916800 + r * (1.0 / 479001600 + r * (1.0 / 6227020800.0));
        double high = 1.0 / 5040 + r * (1.0 / 40320 + r * (1.0 / 362880 + r * (1.0 / 3628800 + r * end)));
        double middle = 1.0 / 24 + r * (1.0 / 120 + r * (1.0 / 720 + r * high));
        p[l] = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6 + r * middle)));
    }
    memcpy(count, t, sizeof count);
    memcpy(bits, p, sizeof bits);
    EACH(l) bits[l] += count[l] << 52;
    memcpy(p, bits, sizeof p);
    EACH(l) out[l] = y[l] == y[l] ? p[l] : y[l];
}

/* x^e, each lane with its own e; x below 1e-300 is flushed to 0. */
static void power_lanes(const double *restrict x, const double *restrict e, double *restrict out) {
    double y[LANES], lifted[LANES];
    EACH(l) lifted[l] = x[l] < 1e-300 ? 1e-300 : x[l];
    log2_lanes(lifted, y);
    EACH(l) y[l] *= e[l];
    exp2_lanes(y, out);
    EACH(l) out[l] = x[l] < 1e-300 ? 0.0 : out[l];
}

/* x^e within 6 % for x > 0 and |e| <= 1: the bits of a number, read as a whole number, are nearly its logarithm. */
static void rough_power_lanes(const double *restrict x, double e, double *restrict out) {
    static const double shift = 4503599627370496.0, unit = 4294967296.0, bias = 1022.957; /* 2^52, 2^32; 1023 - the mean error */
    uint64_t bits[LANES];
    double t[LANES];
    memcpy(bits, x, sizeof bits);
    EACH(l) bits[l] = (bits[l] >> 20) | 0x4330000000000000u;
    memcpy(t, bits, sizeof t);
    EACH(l) t[l] = ((t[l] - shift) * e + (bias - bias * e) * unit) + shift;
    memcpy(bits, t, sizeof bits);
    EACH(l) bits[l] <<= 20;
    memcpy(out, bits, sizeof bits);
}

/* x^(2/3): the cube root y of 1/x^2 by steps of third order, and Newton's step towards that of x^2. */
static void two_thirds_lanes(const double *restrict x, double *restrict out) {
    double y[LANES];
    rough_power_lanes(x, -2.0 / 3, y);
    EACH(l) {
        double a = x[l] * x[l], e = 1.0 - a * y[l] * (y[l] * y[l]), z = y[l] + y[l] * e * (1.0 / 3 + e * (2.0 / 9));
        e = 1.0 - a * z * (z * z);
        z += z * e * (1.0 / 3 + e * (2.0 / 9));
        double r = a * (z * z);
        out[l] = r - (r * r * r - a) * (z * z) * (1.0 / 3);
    }
}

/* x^exponent with one exponent for all lanes. */
static void power_lanes_of(const double *restrict x, double exponent, double *restrict out) {
    if (exponent == 1.5) {
        EACH(l) out[l] = x[l] * sqrt(x[l]);
    } else if (exponent == 1.0) {
        EACH(l) out[l] = x[l];
    } else if (exponent == 2.0) {
        EACH(l) out[l] = x[l] * x[l];
    } else {
        double e[LANES];
        EACH(l) e[l] = exponent;
        power_lanes(x, e, out);
    }
}

/* The sum of products of the terms of a and b up to k, from term `from` of a on. */
INLINED void product_term(double (*a)[LANES], double (*b)[LANES], int from, int k, double *restrict out) {
    double sum[LANES] = {0.0};
    for (int i = from; i <= k; i++) EACH(l) sum[l] += a[i][l] * b[k - i][l];
    memcpy(out, sum, sizeof sum);
}

static void whole_power(const double *restrict z, int e, double *restrict out) {
    EACH(l) out[l] = e > 0 ? z[l] : 1.0;
    for (int i = 1; i < e; i++) EACH(l) out[l] *= z[l];
}

/* a z^e + b z^f, f >= e. */
static void two_powers(const double *restrict z, double a, int e, double b, int f, double *restrict out) {
    double rest[LANES];
    whole_power(z, e, out);
    if (b != 0.0) {
        whole_power(z, f - e, rest);
        EACH(l) out[l] *= a + b * rest[l];
    } else if (a != 1.0) {
        EACH(l) out[l] *= a;
    }
}

/* The functions of a table at a number from 0 to MAP_END, up to four, each lane at its own; a number that is not there gives
 * values without a meaning. The piece and the place z in it, -1 to 1, are bits of 1 + number; even and odd powers of z are summed
 * apart, so that neither sum waits for the other. */
static void map_lanes(const double *table, int count, int functions, const double *restrict number, double (*restrict out)[4]) {
    uint64_t bits[LANES], piece[LANES];
    double z[LANES];
    EACH(l) {
        double y = number[l] < MAP_END ? 1.0 + number[l] : 1.0;
        z[l] = y > 1.0 ? y : 1.0;
    }
    memcpy(bits, z, sizeof bits);
    EACH(l) {
        piece[l] = (bits[l] >> 49) - (1023u << 3);
        bits[l] = ((bits[l] & 0x0001ffffffffffffu) << 3) | 0x3ff0000000000000u;
    }
    memcpy(z, bits, sizeof z);
    for (int l = 0; l < LANES; l++) {
        const double *row = table + (piece[l] * (uint64_t)count + (uint64_t)count) * (uint64_t)functions;
        double at = 2.0 * z[l] - 3.0, square = at * at, even[4] = {0.0}, odd[4] = {0.0};
        if (count % 2) {
            row -= functions;
            for (int f = 0; f < 4; f++) even[f] = row[f];
        }
        for (int k = count / 2; k > 0; k--) {
            row -= functions;
            for (int f = 0; f < 4; f++) odd[f] = odd[f] * square + row[f];
            row -= functions;
            for (int f = 0; f < 4; f++) even[f] = even[f] * square + row[f];
        }
        for (int f = 0; f < 4; f++) out[l][f] = even[f] + at * odd[f];
    }
}

#endif
