/* The loops over all modes. film_modal_avx2.c and film_modal_avx512.c compile this file too. Sums are taken in WIDE parts, of
 * every eighth mode, so that all instruction sets add in the same order. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

enum { WIDE = 8, BLOCK = 64, CHUNK = 32, SERIES = 17 };

/* Up to this phase the reduction below is exact to the last bit. */
static const double LARGEST_PHASE = 1e5;

/* A register of LANES numbers, and the same at any place of an array. Wider types than registers are slow with gcc. */
#ifndef FILM_LANES
#define FILM_LANES 2
#endif
enum { LANES = FILM_LANES, PARTS = WIDE / LANES };
typedef double lanes __attribute__((vector_size(FILM_LANES * sizeof(double))));
typedef double loose __attribute__((vector_size(FILM_LANES * sizeof(double)), aligned(sizeof(double)), may_alias));
#define AT(array, i) (*(const loose *)((array) + (i)))
#define PUT(array, i, value) (*(loose *)((array) + (i)) = (value))

static double total(const lanes parts[PARTS]) {
    double sum[WIDE];
    memcpy(sum, parts, sizeof sum);
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
}

/* ---------------------------------------------------------------- a step */

/* Adds to the sums of the parts from `from` to `to`; rated: of w_n' too. A part at a time keeps its sums in registers. */
static inline void add_free(const film_structure *structure, const film_table *table, const double *begin, size_t from, size_t to,
                            int rated, lanes moved[NODES][PARTS], lanes rates[NODES][PARTS]) {
    size_t n = (size_t)structure->modes;
    const double *w = begin, *u = begin + n, *c = table->node_cos, *s = table->node_sin;
    for (int k = 0; k < PARTS; k++) {
        lanes sum[NODES], rate[NODES];
        for (int at = 0; at < NODES; at++) sum[at] = moved[at][k], rate[at] = rates[at][k];
        for (size_t m = from + (size_t)(k * LANES); m < to; m += WIDE) {
            lanes a = AT(w, m), b = AT(u, m), pull = AT(structure->square, m) * a + AT(structure->drag, m) * b;
            for (int at = 0; at < NODES; at++) {
                lanes cosine = AT(c, (size_t)at * n + m), sine = AT(s, (size_t)at * n + m);
                sum[at] += a * cosine + b * sine;
                if (rated) rate[at] += b * cosine - pull * sine;
            }
        }
        for (int at = 0; at < NODES; at++) moved[at][k] = sum[at], rates[at][k] = rate[at];
    }
}

static void free_sums(const film_structure *structure, const film_table *table, const double *begin, double moved[NODES], double *rate) {
    size_t n = (size_t)structure->modes, whole = n - n % WIDE;
    const double *w = begin, *u = begin + n, *c = table->node_cos, *s = table->node_sin;
    lanes sum[NODES][PARTS] = {{{0.0}}}, rates[NODES][PARTS] = {{{0.0}}};
    for (size_t from = 0; from < whole; from += BLOCK) {
        size_t to = from + BLOCK < whole ? from + BLOCK : whole;
        if (rate != NULL) add_free(structure, table, begin, from, to, 1, sum, rates);
        else add_free(structure, table, begin, from, to, 0, sum, rates);
    }
    for (int at = 0; at < NODES; at++) {
        moved[at] = total(sum[at]);
        for (size_t i = whole, k = (size_t)at * n + whole; i < n; i++, k++) moved[at] += w[i] * c[k] + u[i] * s[k];
        if (rate == NULL) continue;
        rate[at] = total(rates[at]);
        for (size_t i = whole, k = (size_t)at * n + whole; i < n; i++, k++)
            rate[at] += u[i] * c[k] - (structure->square[i] * w[i] + structure->drag[i] * u[i]) * s[k];
    }
}

static void move(const film_structure *structure, const film_table *table, const double *begin, double *end, const double p[NODES],
                 double sums[2]) {
    size_t n = (size_t)structure->modes, whole = n - n % WIDE;
    const double *w = begin, *u = begin + n, *c = table->end_cos, *s = table->end_sin, *rc = table->rate_cos, *rs = table->rate_sin;
    const double *y1 = table->push, *y2 = y1 + n, *y3 = y2 + n, *y4 = y3 + n, *y5 = y4 + n;
    double *w_end = end, *u_end = end + n, p0 = p[0], p1 = p[1], p2 = p[2], p3 = p[3];
    lanes sum[2][PARTS] = {{{0.0}}};
    for (size_t i = 0; i < whole; i += WIDE) {
        for (int k = 0; k < PARTS; k++) {
            size_t m = i + (size_t)(k * LANES);
            lanes a = AT(w, m), b = AT(u, m), r2 = AT(y2, m), r3 = AT(y3, m), r4 = AT(y4, m);
            lanes moved = (a * AT(c, m) + b * AT(s, m)) + ((p0 * r2 + p1 * r3) + (p2 * r4 + p3 * AT(y5, m)));
            lanes rate = (a * AT(rc, m) + b * AT(rs, m)) + ((p0 * AT(y1, m) + p1 * r2) + (p2 * r3 + p3 * r4));
            PUT(w_end, m, moved);
            PUT(u_end, m, rate);
            sum[0][k] += moved;
            sum[1][k] += rate;
        }
    }
    sums[0] = total(sum[0]);
    sums[1] = total(sum[1]);
    for (size_t i = whole; i < n; i++) {
        w_end[i] = (w[i] * c[i] + u[i] * s[i]) + ((p0 * y2[i] + p1 * y3[i]) + (p2 * y4[i] + p3 * y5[i]));
        u_end[i] = (w[i] * rc[i] + u[i] * rs[i]) + ((p0 * y1[i] + p1 * y2[i]) + (p2 * y3[i] + p3 * y4[i]));
        sums[0] += w_end[i];
        sums[1] += u_end[i];
    }
}

/* ---------------------------------------------------------------- tables */

/* Cosine and sine of the phases frequency t <= LARGEST_PHASE: the nearest multiple of pi/2 is subtracted in three parts, and
 * the rest, up to pi/4, goes into the polynomials of fdlibm (Sun Microsystems 1993, k_sin.c and k_cos.c). */
static void circular(int count, const double *restrict frequency, double t, double *restrict cosine, double *restrict sine) {
    static const double shift = 6755399441055744.0; /* 1.5 2^52: adding and subtracting it rounds to a whole number */
    for (int i = 0; i < count; i++) {
        double z = frequency[i] * t, k = (z * 0.6366197723675814 + shift) - shift;
        double quadrant = k - 4.0 * ((0.25 * k + shift) - shift); /* -2 .. 2 */
        double r = ((z - k * 1.5707963267341256) - k * 6.077100506303966e-11) - k * 2.0222662487959506e-21, q = r * r;
        double s = r + r * q * (-1.6666666666666632e-01 + q * (8.33333333332249e-03 + q * (-1.984126982985795e-04 +
                   q * (2.7557313707070068e-06 + q * (-2.5050760253406863e-08 + q * 1.58969099521155e-10)))));
        double c = 1.0 - (0.5 * q - q * q * (4.16666666666666e-02 + q * (-1.388888888887411e-03 + q * (2.480158728947673e-05 +
                   q * (-2.7557314351390663e-07 + q * (2.087572321298175e-09 - q * 1.1359647557788195e-11))))));
        int odd = quadrant == 1.0 || quadrant == -1.0;
        double of_c = odd ? s : c, of_s = odd ? c : s;
        cosine[i] = quadrant == 1.0 || fabs(quadrant) == 2.0 ? -of_c : of_c;
        sine[i] = quadrant == -1.0 || fabs(quadrant) == 2.0 ? -of_s : of_s;
    }
}

/* The responses y_k = responses[k + 2] of undamped modes, as film_responses: the first `slow` of them from their series. */
static void undamped(int count, int slow, const double *restrict frequency, const double *restrict square, double t,
                     double y[RESPONSES][CHUNK]) {
    static const double even[SERIES] = {
        0.041666666666666664, 0.001388888888888889, 2.48015873015873e-05, 2.755731922398589e-07, 2.08767569878681e-09,
        1.1470745597729725e-11, 4.779477332387385e-14, 1.5619206968586225e-16, 4.110317623312165e-19,
        8.896791392450574e-22, 1.6117375710961184e-24, 2.4795962632247976e-27, 3.279889237069838e-30,
        3.7699876288159054e-33, 3.8003907548547434e-36, 3.387157535521162e-39, 2.6882202662866363e-42};
    static const double odd[SERIES] = {
        0.008333333333333333, 0.0001984126984126984, 2.7557319223985893e-06, 2.505210838544172e-08,
        1.6059043836821613e-10, 7.647163731819816e-13, 2.8114572543455206e-15, 8.22063524662433e-18,
        1.9572941063391263e-20, 3.868170170630684e-23, 6.446950284384474e-26, 9.183689863795546e-29,
        1.1309962886447716e-31, 1.216125041553518e-34, 1.151633562077195e-37, 9.67759295863189e-41,
        7.265460179153071e-44};
    double t2 = t * t, half = 0.5 * t2, sixth = t2 * t / 6.0;
    for (int i = 0; i < slow; i++) { /* t^4 sum (-z)^m/(2m + 4)! and t^5 sum (-z)^m/(2m + 5)!, z = square t^2; downwards */
        double z = square[i] * t2, sum2 = even[SERIES - 1], sum3 = odd[SERIES - 1];
        for (int m = SERIES - 2; m >= 0; m--) {
            sum2 = even[m] - z * sum2;
            sum3 = odd[m] - z * sum3;
        }
        y[4][i] = t2 * t2 * sum2;
        y[5][i] = t2 * t2 * t * sum3;
        y[3][i] = sixth - square[i] * y[5][i];
        y[2][i] = half - square[i] * y[4][i];
        y[1][i] = t - square[i] * y[3][i];
        y[0][i] = 1.0 - square[i] * y[2][i];
    }
    circular(count - slow, frequency + slow, t, y[0] + slow, y[1] + slow);
    for (int i = slow; i < count; i++) { /* upwards: y_k = (t^k/k! - y_(k-2))/square */
        double per = 1.0 / square[i];
        y[1][i] /= frequency[i];
        y[2][i] = (1.0 - y[0][i]) * per;
        y[3][i] = (t - y[1][i]) * per;
        y[4][i] = (half - y[2][i]) * per;
        y[5][i] = (sixth - y[3][i]) * per;
    }
}

/* The responses of `count` modes from mode `from` on. */
static void responses_of(const film_structure *structure, int32_t from, int count, double t, double y[RESPONSES][CHUNK]) {
    const double *frequency = structure->frequency + from, *square = structure->square + from, *drag = structure->drag + from;
    int damped = 0, slow = 0;
    for (int i = 0; i < count; i++) {
        damped |= drag[i] != 0.0;
        slow += square[i] * t * t < SERIES_PHASE * SERIES_PHASE;
    }
    if (!damped && frequency[count - 1] * t <= LARGEST_PHASE) {
        undamped(count, slow, frequency, square, t, y);
        return;
    }
    for (int i = 0; i < count; i++) {
        double own[RESPONSES];
        film_responses(square[i], drag[i], t, own);
        for (int k = 0; k < RESPONSES; k++) y[k][i] = own[k];
    }
}

/* sum of share y. */
static double shared(int count, const double *share, const double *y) {
    int whole = count - count % WIDE;
    lanes parts[PARTS] = {{0.0}};
    for (int i = 0; i < whole; i += WIDE)
        for (int k = 0; k < PARTS; k++) parts[k] += AT(share, i + k * LANES) * AT(y, i + k * LANES);
    double sum = total(parts);
    for (int i = whole; i < count; i++) sum += share[i] * y[i];
    return sum;
}

static void fill(const film_structure *structure, const film_table *table, double h) {
    int32_t n = structure->modes;
    double sums[NODES][RESPONSES] = {{0.0}}, weight[NODES][NODES], y[RESPONSES][CHUNK]; /* weight: of y_k in the response to force j */
    double per_h = 1.0;
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < NODES; j++) weight[j][k] = LAGRANGE[j][k] * FACTORIAL[k] * per_h;
        per_h /= h;
    }
    for (int32_t from = 0; from < n; from += CHUNK) {
        int count = n - from < CHUNK ? (int)(n - from) : CHUNK;
        const double *square = structure->square + from, *drag = structure->drag + from, *share = structure->share + from;
        for (int at = 0; at <= NODES; at++) {
            size_t to = (size_t)at * (size_t)n + (size_t)from;
            double *c = at < NODES ? table->node_cos + to : table->end_cos + from;
            double *s = at < NODES ? table->node_sin + to : table->end_sin + from;
            responses_of(structure, from, count, at < NODES ? NODE_AT[at] * h : h, y);
            for (int i = 0; i < count; i++) c[i] = y[0][i] + drag[i] * y[1][i];
            memcpy(s, y[1], sizeof(double) * (size_t)count);
            for (int k = 1; k < RESPONSES && at < NODES; k++) sums[at][k] += shared(count, share, y[k]);
        }
        for (int i = 0; i < count; i++) table->rate_cos[from + i] = -square[i] * y[1][i];
        memcpy(table->rate_sin + from, y[0], sizeof(double) * (size_t)count);
        for (int k = 1; k < RESPONSES; k++)
            for (int i = 0; i < count; i++) table->push[(size_t)(k - 1) * (size_t)n + (size_t)(from + i)] = share[i] * y[k][i];
    }
    for (int at = 0; at < NODES; at++) {
        for (int j = 0; j < NODES; j++) {
            double moved = 0.0, rate = 0.0;
            for (int k = 0; k < NODES; k++) {
                moved += weight[j][k] * sums[at][k + 2];
                rate += weight[j][k] * sums[at][k + 1];
            }
            table->nodes[NODES * at + j] = moved;
            table->node_rates[NODES * at + j] = rate;
        }
    }
}

#ifndef FILM_LOOPS
#define FILM_LOOPS film_loops_plain
#endif

const film_loops FILM_LOOPS = {free_sums, move, fill};
