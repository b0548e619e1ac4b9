/* The responses of modes to a force that is a cubic in time, and tables of them for one step size.
 * docs/method.md, section 13. */
#include "film_modal_parts.h"

#include <string.h>

/* Below this phase (or damping) over t the responses come from their Taylor series, whose terms then only decrease, and from
 * the recursion downwards; above it from cosine and sine, and the recursion upwards. Both are accurate at the border. */
static const double SERIES_PHASE = 6.0;

/* A frequency below this is no vibration, and its square underflows. */
static const double LEAST_FREQUENCY = 1e-100;

enum { SERIES_TERMS = 60, EVEN_TERMS = 17, PER_MODE = 2 * NODES + 4 + 2 * NODES, PER_TABLE = 2 * NODES * NODES };

static const double FACTORIAL[NODES] = {1.0, 1.0, 2.0, 6.0};

/* ---------------------------------------------------------------- responses */

/* y_2 and y_3 without damping: t^4 sum (-z)^m/(2m + 4)! and t^5 sum (-z)^m/(2m + 5)!, z = square t^2. */
static void by_even_series(double square, double t, double *y) {
    static const double even[EVEN_TERMS] = {
        0.041666666666666664, 0.001388888888888889, 2.48015873015873e-05, 2.755731922398589e-07, 2.08767569878681e-09,
        1.1470745597729725e-11, 4.779477332387385e-14, 1.5619206968586225e-16, 4.110317623312165e-19,
        8.896791392450574e-22, 1.6117375710961184e-24, 2.4795962632247976e-27, 3.279889237069838e-30,
        3.7699876288159054e-33, 3.8003907548547434e-36, 3.387157535521162e-39, 2.6882202662866363e-42};
    static const double odd[EVEN_TERMS] = {
        0.008333333333333333, 0.0001984126984126984, 2.7557319223985893e-06, 2.505210838544172e-08,
        1.6059043836821613e-10, 7.647163731819816e-13, 2.8114572543455206e-15, 8.22063524662433e-18,
        1.9572941063391263e-20, 3.868170170630684e-23, 6.446950284384474e-26, 9.183689863795546e-29,
        1.1309962886447716e-31, 1.216125041553518e-34, 1.151633562077195e-37, 9.67759295863189e-41,
        7.265460179153071e-44};
    double z = square * t * t, sum2 = 0.0, sum3 = 0.0;
    for (int m = z < 0.25 ? 5 : z < 4.0 ? 9 : EVEN_TERMS - 1; m >= 0; m--) {
        sum2 = even[m] - z * sum2;
        sum3 = odd[m] - z * sum3;
    }
    double t2 = t * t;
    y[4] = t2 * t2 * sum2;
    y[5] = t2 * t2 * t * sum3;
}

/* y_2 and y_3 by their series: y_k = sum a_m t^(k + 2 + m)/(k + 2 + m)!, a_m = -drag a_(m-1) - square a_(m-2). */
static void by_series(double square, double drag, double t, double *y) {
    double before = 0.0, now = 1.0, power = t * t * t * t / 24.0, damp = drag * t, turn = square * t * t;
    double sum2 = 0.0, sum3 = 0.0;
    for (int m = 0; m < SERIES_TERMS; m++) {
        double next = power * t / (m + 5), term = now * power, after;
        sum2 += term;
        sum3 += now * next;
        after = -damp * now - turn * before;
        before = now;
        now = after;
        power *= 1.0 / (m + 5);
        if (m > 0 && fabs(now) * power + fabs(before) * power < 1e-18 * fabs(sum2)) break;
    }
    y[4] = sum2;
    y[5] = sum3;
}

/* The response to an impulse: sin(nu t)/nu e^(-drag t/2), and its derivative; beyond critical damping its continuation. */
static void impulse(double square, double drag, double t, double *rate, double *moved) {
    double a = 0.5 * drag, d = square - a * a, fade = drag > 0.0 ? exp(-a * t) : 1.0, c, s;
    if (d * t * t > 1e-6) {
        double nu = sqrt(d);
        c = cos(nu * t);
        s = sin(nu * t) / nu;
    } else { /* all but critically damped */
        c = 1.0 - 0.5 * d * t * t;
        s = t * (1.0 - d * t * t / 6.0);
    }
    *moved = fade * s;
    *rate = fade * (c - a * s);
}

void film_responses(double square, double drag, double t, double y[RESPONSES]) {
    if (square * t * t < SERIES_PHASE * SERIES_PHASE && drag * t < SERIES_PHASE) {
        if (drag == 0.0) by_even_series(square, t, y);
        else by_series(square, drag, t, y);
        y[3] = t * t * t / 6.0 - drag * y[4] - square * y[5]; /* downwards: y_(k-2) = t^k/k! - drag y_(k-1) - square y_k */
        y[2] = 0.5 * t * t - drag * y[3] - square * y[4];
        y[1] = t - drag * y[2] - square * y[3];
        y[0] = 1.0 - drag * y[1] - square * y[2];
        return;
    }
    double per = 1.0 / square, power = 1.0;
    impulse(square, drag, t, &y[0], &y[1]);
    for (int k = 0; k < NODES; k++) { /* upwards: y_k = (t^k/k! - drag y_(k-1) - y_(k-2))/square */
        y[k + 2] = (power - drag * y[k + 1] - y[k]) * per;
        power *= t / (k + 1);
    }
}

/* w and w' of mode n, t after the beginning of the step, under the step's force. */
void film_moved_mode(const film_structure *structure, const film_modal *s, const double *waves, int32_t n, double t, double *w,
                     double *u) {
    double y[RESPONSES], square = structure->square[n], drag = structure->drag[n];
    double w0 = waves[n], u0 = waves[structure->modes + n], pushed = 0.0, pushed_rate = 0.0;
    if (s->kind == FILM_STEP_CONTACT) film_responses(square, drag, t, y);
    else impulse(square, drag, t, &y[0], &y[1]);
    *w = w0 * (y[0] + drag * y[1]) + u0 * y[1];
    *u = u0 * y[0] - square * w0 * y[1];
    if (s->kind != FILM_STEP_CONTACT) return;
    double per_h = 1.0;
    for (int k = 0; k < NODES; k++) {
        double part = 0.0;
        for (int j = 0; j < NODES; j++) part += LAGRANGE[j][k] * s->force[j];
        part *= FACTORIAL[k] * per_h;
        pushed += part * y[k + 2];
        pushed_rate += part * y[k + 1];
        per_h /= s->h;
    }
    double stiffness = structure->share[n] * s->mass / (s->unit * s->unit);
    *w += stiffness * pushed;
    *u += stiffness * pushed_rate;
}

/* ---------------------------------------------------------------- tables */

static size_t table_size(int32_t modes) { return (size_t)PER_MODE * (size_t)modes + PER_TABLE; }

/* omega^2 and drag, and a table for every level and one for steps that an event cuts. */
size_t film_structure_size(int32_t modes, int32_t levels) { return 2 * (size_t)modes + ((size_t)levels + 1) * table_size(modes); }

/* The places of a table; level == levels: the one for steps of any size. */
film_table film_table_at(const film_structure *structure, int32_t level) {
    size_t n = (size_t)structure->modes;
    double *at = structure->tables + (size_t)level * table_size(structure->modes);
    film_table table;
    table.node_cos = at;
    table.node_sin = at + NODES * n;
    table.end_cos = at + 2 * NODES * n;
    table.end_sin = table.end_cos + n;
    table.rate_cos = table.end_sin + n;
    table.rate_sin = table.rate_cos + n;
    table.push = table.rate_sin + n;
    table.push_rate = table.push + NODES * n;
    table.nodes = table.push_rate + NODES * n;
    table.node_rates = table.nodes + NODES * NODES;
    return table;
}

void film_fill_table(const film_structure *structure, const film_table *table, double h) {
    int32_t n = structure->modes;
    double sums[NODES][RESPONSES], weight[NODES][NODES], y[RESPONSES]; /* weight: of y_k in the response to the force at j */
    memset(sums, 0, sizeof sums);
    double per_h = 1.0;
    for (int k = 0; k < NODES; k++) {
        for (int j = 0; j < NODES; j++) weight[j][k] = LAGRANGE[j][k] * FACTORIAL[k] * per_h;
        per_h /= h;
    }
    for (int32_t i = 0; i < n; i++) {
        double square = structure->square[i], drag = structure->drag[i], share = structure->share[i];
        for (int at = 0; at < NODES; at++) {
            film_responses(square, drag, NODE_AT[at] * h, y);
            table->node_cos[at * n + i] = y[0] + drag * y[1];
            table->node_sin[at * n + i] = y[1];
            for (int k = 1; k < RESPONSES; k++) sums[at][k] += share * y[k];
        }
        film_responses(square, drag, h, y);
        table->end_cos[i] = y[0] + drag * y[1];
        table->end_sin[i] = y[1];
        table->rate_cos[i] = -square * y[1];
        table->rate_sin[i] = y[0];
        for (int j = 0; j < NODES; j++) {
            const double *of = weight[j];
            table->push[j * n + i] = share * (of[0] * y[2] + of[1] * y[3] + of[2] * y[4] + of[3] * y[5]);
            table->push_rate[j * n + i] = share * (of[0] * y[1] + of[1] * y[2] + of[2] * y[3] + of[3] * y[4]);
        }
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

/* The table of a level, filled when it is first used. */
film_table film_level_table(film_structure *structure, int32_t level) {
    film_table table = film_table_at(structure, level);
    if (!structure->made[level]) {
        film_fill_table(structure, &table, ldexp(structure->longest, -level));
        structure->made[level] = 1;
    }
    return table;
}

/* ---------------------------------------------------------------- structures */

int film_check_modes(int32_t modes, const double *frequency, const double *share, const double *ratio) {
    if (modes < 0 || modes > FILM_MOST_MODES) return FILM_BAD_NUMBER;
    for (int32_t i = 0; i < modes; i++) {
        double zeta = ratio == NULL ? 0.0 : ratio[i];
        if (!(frequency[i] >= (i > 0 ? frequency[i - 1] : 0.0) && frequency[i] < 1e100)) return FILM_BAD_NUMBER;
        if (frequency[i] > 0.0 && frequency[i] < LEAST_FREQUENCY) return FILM_BAD_NUMBER;
        if (!(share[i] > 0.0 && share[i] < INFINITY) || !(zeta >= 0.0 && zeta <= 1.0)) return FILM_BAD_NUMBER;
    }
    return FILM_OK;
}

int film_structure_init(film_structure *structure, int32_t modes, const double *frequency, const double *share,
                        const double *ratio, double longest, int32_t levels, double *memory) {
    memset(structure, 0, sizeof *structure);
    if (film_check_modes(modes, frequency, share, ratio) < 0 || levels < 1 || levels > FILM_LEVELS) return FILM_BAD_NUMBER;
    if (!(longest > 0.0 && longest < INFINITY)) return FILM_BAD_NUMBER;
    structure->modes = modes;
    structure->levels = levels;
    structure->longest = longest;
    structure->frequency = frequency;
    structure->share = share;
    structure->square = memory;
    structure->drag = memory + modes;
    structure->tables = memory + 2 * (size_t)modes;
    for (int32_t i = 0; i < modes; i++) {
        double omega = frequency[i];
        structure->square[i] = omega * omega;
        structure->drag[i] = ratio == NULL ? 0.0 : 2.0 * ratio[i] * omega;
        if (omega == 0.0) structure->rigid = i + 1;
    }
    return FILM_OK;
}
