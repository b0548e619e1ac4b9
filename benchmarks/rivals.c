/* Rivals of the core, for benchmarks/rivals.py: written for these two cases alone, and compiled with the core's flags, so that
 * times differ by the method and not by the compiler. Impacts stand side by side in lanes, as in the core; RIVAL_LANES 1 gives
 * one impact at a time.
 *
 * taylor: Hertz's law on a target that moves. With xi = y^2 and dt = 2y ds the equations are polynomials,
 *     y' = nu - gamma y^3,  nu' = -2 y^4,  t' = 2y,
 * whose Taylor series of any order follows from four products of series. Steps are as long as the last terms allow. The
 * three events are roots of the series themselves.
 *
 * gauss: Big-Alabo's law on a fixed target. Energy gives the turn and the rebound; the times are integrals of 1/velocity, by
 * Gauss's rule where there is no closed form. */
#include "film_core.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#define EACH(l) for (int l = 0; l < RIVAL_LANES; l++)
enum { MOST_ORDER = 24, MOST_STEPS = 400, VALUES = 6 };
enum { FORCE, DEPTH, TURNED, STOPPED, ENDED, SPEED };

#define INLINED static inline __attribute__((always_inline))

/* ---------------------------------------------------------------- Taylor series in the root of the indentation */

/* All lanes at once: the compiler makes instructions of them as wide as the processor's. */
#if RIVAL_LANES == 1
typedef double wide;
#define LANE(x, l) (x)
#else
typedef double wide __attribute__((vector_size(8 * RIVAL_LANES)));
#define LANE(x, l) ((x)[l])
#endif

typedef struct {
    wide y[MOST_ORDER + 1], nu[MOST_ORDER + 1], t[MOST_ORDER + 1];
    double h[RIVAL_LANES];
    int next[RIVAL_LANES]; /* the event that is next: 0 turn, 1 stop, 2 end, 3 over */
} series;

INLINED void make_series(series *s, wide gamma, int order) {
    wide two[MOST_ORDER + 1];
#pragma GCC unroll 24
    for (int n = 0; n < order; n++) {
        double per = 1.0 / (n + 1);
        wide sum = s->y[0] * s->y[n], cube, fourth;
#pragma GCC unroll 24
        for (int j = 1; 2 * j < n; j++) sum += s->y[j] * s->y[n - j];
        two[n] = n == 0 ? sum : n % 2 ? sum + sum : sum + sum + s->y[n / 2] * s->y[n / 2];
        cube = two[0] * s->y[n];
        fourth = two[0] * two[n];
#pragma GCC unroll 24
        for (int j = 1; j <= n; j++) cube += two[j] * s->y[n - j];
#pragma GCC unroll 24
        for (int j = 1; 2 * j < n; j++) fourth += two[j] * two[n - j];
        if (n > 0) fourth = n % 2 ? fourth + fourth : fourth + fourth + two[n / 2] * two[n / 2];
        s->y[n + 1] = per * (s->nu[n] - gamma * cube);
        s->nu[n + 1] = -2.0 * per * fourth;
        s->t[n + 1] = 2.0 * per * s->y[n];
    }
}

/* log2 and 2^x within 0.09: enough for the length of a step. x >= 1e-300. */
INLINED double rough_log2(double x) {
    int64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (double)bits * 0x1p-52 - 1023.0;
}

INLINED double rough_exp2(double x) {
    double out;
    int64_t bits = (int64_t)((x + 1023.0) * 0x1p52);
    memcpy(&out, &bits, sizeof out);
    return out;
}

/* The step at whose end the last two terms are below `tolerance`, of the first velocity and the largest y. */
INLINED void choose_step(series *s, const double *per_y, const double *per_nu, double tolerance, int order) {
    double y[2][RIVAL_LANES], nu[2][RIVAL_LANES];
    memcpy(y, &s->y[order - 1], sizeof y);
    memcpy(nu, &s->nu[order - 1], sizeof nu);
    EACH(l) {
        double last = fabs(y[1][l]) * per_y[l] + fabs(nu[1][l]) * per_nu[l];
        double before = fabs(y[0][l]) * per_y[l] + fabs(nu[0][l]) * per_nu[l];
        double one = rough_log2(last * (1.0 / tolerance) + 1e-300) * (1.0 / order);
        double two = rough_log2(before * (1.0 / tolerance) + 1e-300) * (1.0 / (order - 1));
        s->h[l] = s->next[l] < 3 ? rough_exp2(one > two ? -one : -two) : 0.0;
    }
}

INLINED wide evaluate(const wide *c, wide x, int order) {
    wide out = c[order];
#pragma GCC unroll 24
    for (int k = order - 1; k >= 0; k--) out = out * x + c[k];
    return out;
}

/* The next event of all lanes, each by Newton's method on its series, and the motion there. */
INLINED void locate(const series *s, const wide *is, wide x, const double *due, double near, int order, wide *y, wide *nu, wide *t) {
    wide e[MOST_ORDER + 1];
#pragma GCC unroll 24
    for (int k = 0; k < order; k++) e[k] = (k + 1.0) * is[0] * s->y[k + 1] + is[1] * s->nu[k] + is[2] * s->y[k];
    for (int i = 0; i < 8; i++) {
        wide value = e[order - 1], slope = 0.0 * x;
        double moved = 0.0;
#pragma GCC unroll 24
        for (int k = order - 2; k >= 0; k--) {
            slope = slope * x + value;
            value = value * x + e[k];
        }
        wide step = value / slope;
        x -= step;
        EACH(l) {
            double far = fabs(LANE(step, l)) - near * s->h[l];
            moved += due[l] <= 0.0 && far > 0.0 ? 1.0 : 0.0;
        }
        if (moved == 0.0) break;
    }
    *y = evaluate(s->y, x, order);
    *nu = evaluate(s->nu, x, order);
    *t = evaluate(s->t, x, order);
}

/* Records the events that lie within the step. Returns 1 once all contacts are over. */
INLINED int find_events(series *s, wide y1, wide nu1, wide gamma, double near, int order, int count, double (*out)[VALUES]) {
    wide rate = nu1 - gamma * y1 * y1 * y1, is[3], x, y, nu, t;
    double due[RIVAL_LANES];
    for (;;) {
        int any = 0, over = 0;
        EACH(l) {
            int kind = s->next[l];
            double now = kind == 0 ? LANE(rate, l) : kind == 1 ? LANE(nu1, l) : LANE(y1, l);
            double was = kind == 0 ? LANE(s->y[1], l) : kind == 1 ? LANE(s->nu[0], l) : LANE(s->y[0], l);
            due[l] = kind < 3 ? now : 1.0;
            any += due[l] <= 0.0;
            over += kind == 3;
            LANE(x, l) = due[l] <= 0.0 ? s->h[l] * was / (was - now) : 0.0;
            LANE(is[0], l) = kind == 0 ? 1.0 : 0.0;
            LANE(is[1], l) = kind == 1 ? 1.0 : 0.0;
            LANE(is[2], l) = kind >= 2 ? 1.0 : 0.0;
        }
        if (over == RIVAL_LANES) return 1;
        if (any == 0) return 0;
        locate(s, is, x, due, near, order, &y, &nu, &t);
        for (int l = 0; l < RIVAL_LANES; l++) {
            if (!(due[l] <= 0.0)) continue;
            double *to = out[l < count ? l : 0], depth = LANE(y, l) * LANE(y, l);
            int kind = s->next[l]++;
            if (kind == 0) to[FORCE] = depth * LANE(y, l), to[DEPTH] = depth, to[TURNED] = LANE(t, l);
            else if (kind == 1) to[STOPPED] = LANE(t, l);
            else to[ENDED] = LANE(t, l), to[SPEED] = LANE(nu, l);
        }
    }
}

INLINED int taylor_block(const double *nu0, const double *gamma, double tolerance, int order, int count, double (*out)[VALUES]) {
    series s;
    double per_y[RIVAL_LANES], per_nu[RIVAL_LANES], near = sqrt(tolerance);
    wide g, h, y, nu, t;
    memcpy(&g, gamma, sizeof g);
    memcpy(&s.nu[0], nu0, sizeof g);
    s.y[0] = s.t[0] = 0.0 * g;
    EACH(l) {
        s.next[l] = 0;
        per_nu[l] = 1.0 / nu0[l];
        per_y[l] = sqrt(sqrt(per_nu[l])); /* about: in the law's own units the depth is near nu^0.8 */
    }
    for (int step = 1; step <= MOST_STEPS; step++) {
        make_series(&s, g, order);
        choose_step(&s, per_y, per_nu, tolerance, order);
        memcpy(&h, s.h, sizeof h);
        y = evaluate(s.y, h, order);
        nu = evaluate(s.nu, h, order);
        t = evaluate(s.t, h, order);
        if (find_events(&s, y, nu, g, near, order, count, out)) return step;
        s.y[0] = y;
        s.nu[0] = nu;
        s.t[0] = t;
    }
    return MOST_STEPS;
}

#define ORDERS(with) with(6) with(8) with(10) with(12) with(14) with(16) with(18) with(20) with(24)
#define BLOCK_OF(n)                                                                                                     \
    static int block_##n(const double *nu, const double *g, double tolerance, int count, double (*out)[VALUES]) {      \
        return taylor_block(nu, g, tolerance, n, count, out);                                                          \
    }
ORDERS(BLOCK_OF)

/* Summaries of impacts in the law's units; returns the number of steps, 0 for an order that there is not. */
int64_t taylor(int64_t count, const double *nu, const double *gamma, double tolerance, int order, double (*out)[VALUES]) {
    int64_t steps = 0;
    for (int64_t first = 0; first < count; first += RIVAL_LANES) {
        double n[RIVAL_LANES], g[RIVAL_LANES];
        int here = count - first < RIVAL_LANES ? (int)(count - first) : RIVAL_LANES;
        EACH(l) {
            n[l] = nu[first + (l < here ? l : 0)];
            g[l] = gamma[first + (l < here ? l : 0)];
        }
        switch (order) {
#define CASE_OF(k) case k: steps += here * block_##k(n, g, tolerance, here, out + first); break;
            ORDERS(CASE_OF)
        }
    }
    return steps;
}

/* ---------------------------------------------------------------- Gauss's rule for the integral of energy */

enum { STAGES = 4 };

/* Big-Alabo's law in units of its yield point, whose force from there on is f + k z + [stage 1] z^{3/2}, z = xi - begin. The
 * branch has the exponent 3/2 and the length (force^2/ratio)^{1/3}, ratio = 1 + z^{3/2} rise[1], 2 + z rise[2], 2.8.
 * squares: twice the work up to the end of a stage. turn, rest: durations of Hertz's law from first touch and from rest. */
typedef struct {
    double begin[STAGES], f[STAGES], k[STAGES], ratio[STAGES], rise[STAGES], squares[STAGES], turn, rest;
} big_alabo;

/* x^(-1/n) from a guess by the bits of x, whose mean error is taken off: three steps of Newton's method, 1e-9. */
INLINED double inverse_root(double x, int n) {
    double y = rough_exp2(-(rough_log2(x) + 0.043) / n - 0.043);
    for (int i = 0; i < 3; i++) y *= (1.0 + 1.0 / n) - (1.0 / n) * x * (n == 3 ? y * y * y : (y * y) * (y * y) * y);
    return y;
}

/* Adds the time across a stage, or to the turn in it: v^2 = left + 2 (work to the end) and x = end - h s^2, so that the root at
 * a turn is gone. */
static void add_crossing(const big_alabo *law, int stage, const double *h, const double *left, int points, const double *s,
                         const double *w, double *time) {
    double sum[RIVAL_LANES] = {0.0}, whole[RIVAL_LANES], f = law->f[stage], k = law->k[stage];
    EACH(l) whole[l] = left[l] + 2.0 * h[l] * (f + 0.5 * k * h[l] + (stage < 2 ? 0.4 * h[l] * sqrt(h[l]) : 0.0));
    for (int i = 0; i < points; i++) {
        double at = s[i], square = at * at, rest = 1.0 - square, by = w[i] * at;
        if (stage < 2) {
            double power = rest * sqrt(rest);
            EACH(l) {
                double z = h[l] * rest, work = z * (f + 0.4 * power * (h[l] * sqrt(h[l])));
                sum[l] += by / sqrt(whole[l] - 2.0 * work);
            }
        } else { /* the way h s^2 is left as a factor: nothing cancels */
            EACH(l) sum[l] += by / sqrt(left[l] + h[l] * square * (2.0 * f + k * h[l] * (2.0 - square)));
        }
    }
    EACH(l) time[l] += 2.0 * h[l] * sum[l];
}

/* Turn, force and dent's ratio of radii of impacts that turn in a stage beyond yield, with this energy left there. */
static void find_turn(const big_alabo *law, int stage, const double *energy, double *z, double *force, double *ratio) {
    double f = law->f[stage], k = law->k[stage], rise = law->rise[stage];
    if (stage > 1) {
        EACH(l) {
            force[l] = sqrt(f * f + 2.0 * k * energy[l]);
            z[l] = 2.0 * energy[l] / (f + force[l]);
            ratio[l] = law->ratio[stage] + z[l] * rise;
        }
        return;
    }
    EACH(l) { /* Newton's method */
        double steep = rough_exp2(0.4 * rough_log2(2.5 * energy[l])), flat = energy[l] / f;
        z[l] = steep * flat / (steep + flat);
    }
    for (int i = 0; i < 4; i++) {
        EACH(l) {
            double power = z[l] * sqrt(z[l]);
            z[l] -= (z[l] * (f + 0.4 * power) - energy[l]) / (f + power);
        }
    }
    EACH(l) {
        double power = z[l] * sqrt(z[l]);
        force[l] = f + power;
        ratio[l] = 1.0 + power * rise;
    }
}

/* Impacts that turn in one stage: v, the values of each. */
static void gauss_block(const big_alabo *law, int stage, const double *nu, int points, const double *s, const double *w,
                        double (*v)[RIVAL_LANES]) {
    double energy[RIVAL_LANES], time[RIVAL_LANES] = {0.0}, z[RIVAL_LANES], ratio[RIVAL_LANES], left[RIVAL_LANES], h[RIVAL_LANES];
    if (stage == 0) {
        EACH(l) {
            double root = 1.25 * nu[l] * nu[l], x = root * inverse_root(root * root * root, 5);
            v[FORCE][l] = x * sqrt(x);
            v[TURNED][l] = law->turn * x / nu[l];
            v[ENDED][l] = 2.0 * v[TURNED][l];
            v[SPEED][l] = -nu[l];
            v[DEPTH][l] = x;
        }
        return;
    }
    for (int k = 0; k < stage; k++) {
        EACH(l) {
            h[l] = law->begin[k + 1] - law->begin[k];
            left[l] = nu[l] * nu[l] - law->squares[k];
        }
        add_crossing(law, k, h, left, points, s, w, time);
    }
    EACH(l) energy[l] = 0.5 * (nu[l] * nu[l] - law->squares[stage - 1]);
    find_turn(law, stage, energy, z, v[FORCE], ratio);
    EACH(l) left[l] = 0.0;
    add_crossing(law, stage, z, left, points, s, w, time);
    EACH(l) {
        double force = v[FORCE][l], q = force * force / ratio[l], third = inverse_root(q, 3), recovery = q * third * third;
        v[DEPTH][l] = law->begin[stage] + z[l];
        v[TURNED][l] = time[l];
        v[ENDED][l] = time[l] + law->rest * sqrt(recovery / force);
        v[SPEED][l] = -sqrt(0.8 * force * recovery);
    }
}

static void run_gauss(const big_alabo *law, int stage, const int64_t *index, int count, const double *nu, int points,
                      const double *s, const double *w, double (*out)[VALUES]) {
    double v[VALUES][RIVAL_LANES], at[RIVAL_LANES];
    EACH(l) at[l] = nu[index[l < count ? l : 0]];
    gauss_block(law, stage, at, points, s, w, v);
    for (int l = 0; l < count; l++)
        for (int k = 0; k < VALUES; k++) out[index[l]][k] = v[k == STOPPED ? TURNED : k][l];
}

/* Impacts are collected by the stage in which they turn. s, w: abscissas and weights of Gauss's rule on 0 .. 1. */
void gauss(int64_t total, const double *nu, const big_alabo *law, int points, const double *s, const double *w,
           double (*out)[VALUES]) {
    int64_t waiting[STAGES][RIVAL_LANES];
    int count[STAGES] = {0};
    for (int64_t i = 0; i < total; i++) {
        double square = nu[i] * nu[i];
        int stage = (square > law->squares[0]) + (square > law->squares[1]) + (square > law->squares[2]);
        waiting[stage][count[stage]++] = i;
        if (count[stage] < RIVAL_LANES) continue;
        run_gauss(law, stage, waiting[stage], RIVAL_LANES, nu, points, s, w, out);
        count[stage] = 0;
    }
    for (int k = 0; k < STAGES; k++)
        if (count[k] > 0) run_gauss(law, k, waiting[k], count[k], nu, points, s, w, out);
}

/* ---------------------------------------------------------------- the core, one impact at a time */

typedef int one_impact(const film_curve *, const film_mesh *, const film_start *, film_summary *);

void one_by_one(one_impact *impact, const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    for (int64_t i = 0; i < count; i++) status[i] = impact(curve, mesh, &start[i], &summary[i]);
}
