/* The responses of modes to a force that is a cubic in time, and tables of them for one step size.
 * docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

/* A frequency below this is no vibration, and its square underflows. */
static const double LEAST_FREQUENCY = 1e-100;

enum { SERIES_TERMS = 60, PER_MODE = 2 * NODES + 4 + RESPONSES - 1, PER_TABLE = 2 * NODES * NODES };

/* ---------------------------------------------------------------- responses */

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
        by_series(square, drag, t, y);
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

void film_force_powers(const film_modal *s, double powers[NODES]) {
    for (int k = 0; k < NODES; k++) {
        powers[k] = 0.0;
        for (int j = 0; j < NODES; j++) powers[k] += LAGRANGE[j][k] * s->force[j];
    }
}

/* The step's force per mass, in the unit of time, as sum p_k theta^k/k!; 0 in flight. */
void film_force_cubic(const film_modal *s, double p[NODES]) {
    double per = s->mass / (s->unit * s->unit), powers[NODES];
    film_force_powers(s, powers);
    for (int k = 0; k < NODES; k++) {
        p[k] = s->kind == FILM_STEP_CONTACT ? powers[k] * FACTORIAL[k] * per : 0.0;
        per /= s->h;
    }
}

/* w and w' of mode n, t after the beginning of the step, under the step's force. */
void film_moved_mode(const film_structure *structure, const film_modal *s, const double *waves, int32_t n, double t, double *w,
                     double *u) {
    double y[RESPONSES], square = structure->square[n], drag = structure->drag[n];
    const double *begin = waves + begins_at(structure, s);
    double w0 = begin[n], u0 = begin[structure->modes + n], pushed = 0.0, pushed_rate = 0.0;
    *w = w0;
    *u = u0;
    if (s->kind == FILM_STEP_REST) return;
    int stretched = n < structure->carried && s->kind != FILM_STEP_JUMP;
    if (s->kind == FILM_STEP_CONTACT || stretched) film_responses(square, drag, t, y);
    else impulse(square, drag, t, &y[0], &y[1]);
    *w = w0 * (y[0] + drag * y[1]) + u0 * y[1];
    *u = u0 * y[0] - square * w0 * y[1];
    if (stretched) film_stretched_mode(structure, waves, n, y, w, u);
    if (s->kind != FILM_STEP_CONTACT) return;
    double p[NODES];
    film_force_cubic(s, p);
    for (int k = 0; k < NODES; k++) {
        pushed += p[k] * y[k + 2];
        pushed_rate += p[k] * y[k + 1];
    }
    *w += structure->share[n] * pushed;
    *u += structure->share[n] * pushed_rate;
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
    table.nodes = table.push + (RESPONSES - 1) * n;
    table.node_rates = table.nodes + NODES * NODES;
    return table;
}

const film_loops *film_loops_of(const film_structure *structure) {
#if defined(FILM_WIDE)
    static const film_loops *const loops[] = {&film_loops_plain, &film_loops_avx2, &film_loops_avx512};
    return loops[structure->instructions];
#else
    (void)structure;
    return &film_loops_plain;
#endif
}

/* The table of a level, filled when it is first used. */
film_table film_level_table(film_structure *structure, int32_t level) {
    film_table table = film_table_at(structure, level);
    if (!structure->made[level]) {
        film_loops_of(structure)->fill(structure, &table, ldexp(structure->longest, -level));
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
    structure->instructions = film_instructions();
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
