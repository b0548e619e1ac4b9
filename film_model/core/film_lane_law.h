/* Powers, the law and its inverse, in lanes. Internal to film_lanes.c. docs/method.md, section 10.
 *
 * Plain loops over LANES, which compilers turn into vector instructions. Each lane sees the same operations in the same
 * order whatever the other lanes hold and however wide the registers are, so the result of an impact depends on that impact
 * alone: no fused multiply-add, no sum across lanes, no libm function but sqrt; a lane that has converged is not changed. */
#ifndef FILM_LANE_LAW_H
#define FILM_LANE_LAW_H

#include "film_batch.h"

#include <string.h>

#if defined(__GNUC__)
#define INLINED static inline __attribute__((always_inline))
#define CALLED static __attribute__((noinline)) /* of which compilers make vector instructions only apart from its caller */
#else
#define INLINED static inline
#define CALLED static
#endif

enum { DEPTH_STEPS = 60 };

#define EACH(l) for (int l = 0; l < LANES; l++)

/* Whether a flag is set. Flags are doubles, 1 or 0, so that SSE2 instructions can select by them. */
static int any(const double *flag) {
    uint64_t bits[LANES], all = 0;
    memcpy(bits, flag, sizeof bits);
    EACH(l) all |= bits[l];
    return all != 0;
}

/* ---------------------------------------------------------------- powers */

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

/* ---------------------------------------------------------------- the law */

/* Clenshaw's summation of two series at once, so that the processor works on one while the other waits for its last step.
 * Missing terms of the shorter series are 0, which leaves its sums 0. */
static void chebyshev_lanes(const film_function *g, const film_function *h, const double *restrict zg,
                            const double *restrict zh, double *restrict a, double *restrict b) {
    double a1[LANES] = {0.0}, a2[LANES] = {0.0}, b1[LANES] = {0.0}, b2[LANES] = {0.0};
    double of_g[FILM_MAX_TERMS + 4] = {0.0}, of_h[FILM_MAX_TERMS + 4] = {0.0};
    memcpy(of_g, g->series, (size_t)g->terms * sizeof *of_g);
    memcpy(of_h, h->series, (size_t)h->terms * sizeof *of_h);
    for (int k = ((g->terms > h->terms ? g->terms : h->terms) + 2) / 4 * 4; k > 0; k -= 4) {
        const double *cg = of_g + k, *ch = of_h + k;
        double g0 = cg[0], g1 = cg[-1], g2 = cg[-2], g3 = cg[-3], h0 = ch[0], h1 = ch[-1], h2 = ch[-2], h3 = ch[-3];
        EACH(l) {
            double z = 2.0 * zg[l], p = z * a1[l] - a2[l] + g0, q = z * p - a1[l] + g1;
            a2[l] = z * q - p + g2;
            a1[l] = z * a2[l] - q + g3;
        }
        EACH(l) {
            double z = 2.0 * zh[l], p = z * b1[l] - b2[l] + h0, q = z * p - b1[l] + h1;
            b2[l] = z * q - p + h2;
            b1[l] = z * b2[l] - q + h3;
        }
    }
    EACH(l) {
        a[l] = zg[l] * a1[l] - a2[l] + of_g[0];
        b[l] = zh[l] * b1[l] - b2[l] + of_h[0];
    }
}

/* The argument of a function: x of a power, z of a series. */
static void variable_lanes(const film_function *g, const double *restrict xi, double *restrict z) {
    EACH(l) {
        double x = (xi[l] - g->origin) * g->per_span;
        z[l] = x > 0.0 ? x : 0.0;
    }
    if (g->form == FILM_ROOT_SERIES) {
        EACH(l) z[l] = sqrt(z[l]);
    }
    if (g->form != FILM_POWER) {
        EACH(l) z[l] = 2.0 * z[l] - 1.0;
    }
}

static void power_value_lanes(const film_function *g, const double *restrict xi, double *restrict out) {
    double x[LANES], power[LANES] = {0.0};
    variable_lanes(g, xi, x);
    if (g->coefficient != 0.0) power_lanes_of(x, g->exponent, power);
    EACH(l) out[l] = g->constant + g->slope * x[l] + g->coefficient * power[l];
}

/* Two functions at once. */
static void value_lanes(const film_function *g, const film_function *h, const double *restrict xi, double *restrict a,
                        double *restrict b) {
    double zg[LANES], zh[LANES], none[LANES];
    int power_g = g->form == FILM_POWER, power_h = h->form == FILM_POWER;
    if (power_g) power_value_lanes(g, xi, a);
    else variable_lanes(g, xi, zg);
    if (power_h) power_value_lanes(h, xi, b);
    else variable_lanes(h, xi, zh);
    if (!power_g && !power_h) chebyshev_lanes(g, h, zg, zh, a, b);
    else if (!power_g) chebyshev_lanes(g, g, zg, zg, a, none);
    else if (!power_h) chebyshev_lanes(h, h, zh, zh, b, none);
}

static void piece_law_lanes(const film_piece *piece, const double *restrict xi, double *restrict force,
                            double *restrict work) {
    const film_function *g = &piece->force;
    if (g->form != FILM_POWER) {
        value_lanes(g, &piece->mean, xi, force, work);
        EACH(l) {
            double x = xi[l] - g->origin;
            work[l] = (x > 0.0 ? x : 0.0) * work[l] - piece->work_at_begin;
        }
        return;
    }
    double x[LANES], power[LANES] = {0.0}, per = work_factor(g->exponent);
    EACH(l) {
        x[l] = xi[l] - g->origin;
        x[l] = x[l] > 0.0 ? x[l] : 0.0;
    }
    if (g->coefficient != 0.0) power_lanes_of(x, g->exponent, power);
    EACH(l) {
        double part = g->coefficient * power[l];
        force[l] = g->constant + g->slope * x[l] + part;
        work[l] = x[l] * (g->constant + 0.5 * g->slope * x[l] + part * per) - piece->work_at_begin;
    }
}

/* piece_law_lanes where each lane has its own series. The pieces lie at the same depths. */
static void own_law_lanes(const own_stage *own, const film_piece *first, int32_t p, const double *restrict xi,
                          double *restrict force, double *restrict work) {
    const film_function *g = &first[p].force;
    const double(*column)[LANES] = &own->value[own->piece[p].column];
    const double(*of_force)[LANES] = column + 1, (*of_mean)[LANES] = of_force + own->piece[p].force;
    double z[LANES], a1[LANES] = {0.0}, a2[LANES] = {0.0}, b1[LANES] = {0.0}, b2[LANES] = {0.0};
    variable_lanes(g, xi, z);
    for (int32_t k = own->piece[p].force - 1; k > 0; k--) {
        EACH(l) {
            double a = 2.0 * z[l] * a1[l] - a2[l] + of_force[k][l];
            a2[l] = a1[l];
            a1[l] = a;
        }
    }
    for (int32_t k = own->piece[p].mean - 1; k > 0; k--) {
        EACH(l) {
            double b = 2.0 * z[l] * b1[l] - b2[l] + of_mean[k][l];
            b2[l] = b1[l];
            b1[l] = b;
        }
    }
    EACH(l) {
        double x = xi[l] - g->origin;
        force[l] = z[l] * a1[l] - a2[l] + of_force[0][l];
        work[l] = (x > 0.0 ? x : 0.0) * (z[l] * b1[l] - b2[l] + of_mean[0][l]) - column[0][l];
    }
}

enum { FORCE_AND_WORK, RECOVERY_AND_EXPONENT };

static void piece_lanes(const batch_job *j, int32_t stage, const film_piece *piece, int which, const double *restrict xi,
                        double *restrict a, double *restrict b) {
    const film_piece *first = &j->curve->piece[j->curve->stage[stage].first];
    if (which == RECOVERY_AND_EXPONENT) value_lanes(&piece->recovery, &piece->exponent, xi, a, b);
    else if (stage == j->shaped) own_law_lanes(j->own, first, (int32_t)(piece - first), xi, a, b);
    else piece_law_lanes(piece, xi, a, b);
}

/* Pieces of a stage that lanes may be on. */
static int32_t pieces_of(const batch_job *j, int32_t stage) {
    return stage == j->shaped ? j->own->pieces : j->curve->stage[stage].count;
}

/* Where the last of them ends. */
static double reach_of(const batch_job *j, int32_t stage) {
    return stage == j->shaped ? j->own->end : j->curve->stage[stage].end;
}

/* The piece of a stage that holds xi, of those that lanes may be on. */
static const film_piece *lane_piece(const batch_job *j, int32_t stage, double xi) {
    const film_piece *piece = &j->curve->piece[j->curve->stage[stage].first], *last = piece + pieces_of(j, stage) - 1;
    while (piece < last && xi > piece->end) piece++;
    return piece;
}

/* 1 for the lanes that lane_piece puts in this piece of a stage. */
static void lanes_in(const batch_job *j, int32_t stage, const film_piece *piece, const double *restrict xi,
                     double *restrict here) {
    const film_piece *first = &j->curve->piece[j->curve->stage[stage].first];
    const film_piece *last = first + pieces_of(j, stage) - 1;
    double from = piece == first ? 0.0 : piece[-1].end, to = piece == last ? INFINITY : piece->end;
    double below = piece == first ? 1.0 : 0.0;
    EACH(l) {
        here[l] = xi[l] > from ? 1.0 : below;
        here[l] = xi[l] > to ? 0.0 : here[l];
    }
}

/* Two functions of a stage, each lane on its own piece. */
static void stage_lanes(const batch_job *j, int32_t stage, int which, const double *restrict xi,
                        double *restrict a, double *restrict b) {
    const film_piece *piece = lane_piece(j, stage, xi[0]);
    double done[LANES], here[LANES], one[LANES], two[LANES];
    piece_lanes(j, stage, piece, which, xi, a, b);
    if (j->curve->stage[stage].count == 1) return;
    lanes_in(j, stage, piece, xi, done);
    for (int l = 1; l < LANES; l++) {
        if (done[l] > 0.0) continue;
        piece = lane_piece(j, stage, xi[l]);
        piece_lanes(j, stage, piece, which, xi, one, two);
        lanes_in(j, stage, piece, xi, here);
        EACH(k) {
            done[k] = here[k] > 0.0 ? 1.0 : done[k];
            a[k] = here[k] > 0.0 ? one[k] : a[k];
            b[k] = here[k] > 0.0 ? two[k] : b[k];
        }
    }
}

static void law_lanes(const batch_job *j, int32_t stage, const double *restrict xi, double *restrict force,
                      double *restrict work) {
    const film_stage *own = &j->curve->stage[stage];
    if (own->count == 1 && stage != j->shaped) piece_law_lanes(&j->curve->piece[own->first], xi, force, work);
    else stage_lanes(j, stage, FORCE_AND_WORK, xi, force, work);
}

/* The work of as much of a stage as lanes may be on. */
static void whole_lanes(const batch_job *j, int32_t stage, double *restrict whole) {
    EACH(l) whole[l] = stage == j->shaped ? j->own->whole[l] : j->whole[stage];
}

/* The depth at which the work of a stage is `work`, which must not exceed that of whole_lanes. Newton's method: on a rising
 * power from above, where it does not overshoot, elsewhere in a bracket. */
static void depth_lanes(const batch_job *j, int32_t stage, const double *restrict work, double *restrict depth) {
    const film_piece *piece = &j->curve->piece[j->curve->stage[stage].first];
    const film_function *g = &piece->force;
    double begin = j->curve->stage[stage].begin, end = reach_of(j, stage), f[LANES], w[LANES], whole[LANES];
    int from_above = stage != j->shaped && force_rises(j->curve, stage);
    double moving[LANES];
    whole_lanes(j, stage, whole);
    if (from_above) {
        double c = g->constant, s = g->slope, k = g->coefficient, per = work_factor(g->exponent), root[LANES];
        EACH(l) {
            double t = work[l] + piece->work_at_begin;
            root[l] = t / (k > 0.0 ? k * per : 1.0);
            depth[l] = c > 0.0 || s > 0.0 ? 2.0 * t / (c + sqrt(c * c + 2.0 * s * t)) : INFINITY;
        }
        if (k > 0.0) {
            double e[LANES], nearly[LANES];
            EACH(l) e[l] = per;
            power_lanes(root, e, nearly);
            EACH(l) depth[l] = nearly[l] < depth[l] ? nearly[l] : depth[l];
        }
        EACH(l) {
            depth[l] += g->origin;
            moving[l] = 1.0;
        }
        if (k == 0.0 && g->origin == begin) return;
    } else {
        EACH(l) {
            depth[l] = begin + (end - begin) * sqrt(work[l] / whole[l]); /* as if work grew as a square */
            moving[l] = 1.0;
        }
    }
    double low[LANES], high[LANES];
    EACH(l) {
        low[l] = begin;
        high[l] = from_above ? INFINITY : end;
    }
    for (int i = 0; i < DEPTH_STEPS; i++) {
        law_lanes(j, stage, depth, f, w);
        EACH(l) {
            double missing = work[l] - w[l], at = depth[l];
            low[l] = missing >= 0.0 ? at : low[l];
            high[l] = missing >= 0.0 ? high[l] : at;
            double next = at + missing / f[l], halved = 0.5 * (low[l] + high[l]);
            double near = next >= low[l] ? 1e-9 : 4e-16;
            near = next <= high[l] ? near : 4e-16;
            near = from_above ? 1e-9 : near;
            next = near > 1e-12 ? next : halved;
            depth[l] = moving[l] > 0.0 ? next : at;
            moving[l] = fabs(next - at) <= near * at ? 0.0 : moving[l];
        }
        if (!any(moving)) break;
    }
}

/* The unloading rule for lanes that turned at xi under `force` in `stage`, which is not reversible: length and exponent of
 * the branch. The caller refuses a length that is not positive. */
static void open_lanes(const batch_job *j, int32_t stage, const double *restrict xi, const double *restrict force,
                       double *restrict recovery, double *restrict exponent) {
    double given[LANES], load[LANES], e[LANES];
    const film_curve *curve = j->curve;
    stage_lanes(j, stage, RECOVERY_AND_EXPONENT, xi, given, exponent);
    if (curve->stage[stage].unloading == FILM_RESIDUAL) {
        EACH(l) recovery[l] = xi[l] - given[l];
        return;
    }
    if (curve->stage[stage].unloading == FILM_SECANT) {
        EACH(l) {
            double r = force[l] / given[l];
            recovery[l] = r < xi[l] ? r : xi[l];
        }
        return;
    }
    EACH(l) {
        load[l] = force[l] / sqrt(given[l]);
        e[l] = 1.0 / exponent[l];
    }
    power_lanes(load, e, recovery);
    EACH(l) { /* for q = 1.5 a step of Newton's method towards the cube root of load^2: power_lanes errs by some ulps */
        double r = recovery[l], cube = r - (r * r * r - load[l] * load[l]) / (3.0 * r * r);
        recovery[l] = exponent[l] == 1.5 ? cube : r;
    }
}

#endif
