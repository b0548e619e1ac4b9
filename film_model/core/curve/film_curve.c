/* Curves: their checks and their families. docs/method.md, sections 1 and 8. */
#include "curve/film_law.h"

#include <string.h>

/* ---------------------------------------------------------------- curves */

void film_law(const film_curve *curve, int32_t stage, double xi, double *force, double *work) {
    film_line line;
    memset(&line, 0, sizeof line);
    line.branch = stage;
    law_at(curve, &line, xi, force, work);
}

static int bad_function(const film_function *g) {
    if (g->form == FILM_POWER)
        return !(isfinite(g->constant) && isfinite(g->slope) && isfinite(g->square) && isfinite(g->coefficient) && g->exponent > 0.0 &&
                 isfinite(g->exponent) && isfinite(g->origin) && g->per_span == 1.0);
    if (g->form != FILM_SERIES && g->form != FILM_ROOT_SERIES) return 1;
    if (g->terms < 1 || g->terms > FILM_MAX_TERMS || !(g->per_span > 0.0 && g->per_span < INFINITY) || !isfinite(g->origin)) return 1;
    for (int k = 0; k < g->terms; k++)
        if (!isfinite(g->series[k])) return 1;
    return 0;
}

/* Whether a stage is the last reversible one before those of FILM_SIMILAR. */
static int is_stretched(const film_curve *curve, const film_stage *stage) {
    int last = stage == &curve->stage[curve->stages - 1];
    return !last && stage->unloading == FILM_RETRACE && stage[1].unloading == FILM_SIMILAR;
}

static int bad_piece(const film_curve *curve, const film_stage *stage, const film_piece *piece) {
    int last = piece == &curve->piece[stage->first + stage->count - 1];
    if (bad_function(&piece->force) || !isfinite(piece->work_at_begin)) return 1;
    if (piece->force.form != FILM_POWER && bad_function(&piece->mean)) return 1;
    if (stage->unloading != FILM_RETRACE && (bad_function(&piece->recovery) || bad_function(&piece->exponent))) return 1;
    if (stage->damped && bad_function(&piece->damping)) return 1;
    if (last && piece->end != stage->end && !(piece->end > stage->end && is_stretched(curve, stage))) return 1;
    return !(piece->end < INFINITY) && !(last && stage == &curve->stage[curve->stages - 1] && piece->force.form == FILM_POWER);
}

static int bad_stage(const film_curve *curve, const film_stage *stage, int32_t pieces_before) {
    if (stage->first != pieces_before || stage->count < 1 || stage->count > FILM_MAX_PIECES - pieces_before) return 1;
    if (stage->unloading < FILM_RETRACE || stage->unloading > FILM_SIMILAR) return 1;
    if (stage->unloading == FILM_SIMILAR && (!(curve->pull > 0.0) || stage->reload_exponent != 0.0)) return 1;
    if (stage->damped != 0 && (stage->damped != 1 || curve->stages > 1 || stage->unloading != FILM_RETRACE)) return 1;
    if (!(stage->reload_exponent >= 0.0 && stage->reload_exponent < INFINITY)) return 1;
    double begin = stage->begin;
    for (int32_t i = stage->first; i < stage->first + stage->count; i++) {
        if (!(curve->piece[i].end > begin) || bad_piece(curve, stage, &curve->piece[i])) return 1;
        begin = curve->piece[i].end;
    }
    return 0;
}

static int bad_beginning(const film_curve *curve) {
    double begin = curve->stage[0].begin;
    if (!(curve->pull > 0.0)) return curve->pull != 0.0 || begin != 0.0;
    if (!(curve->pull < INFINITY && begin <= 0.0 && begin > -INFINITY) || curve->compliance > 0.0) return 1;
    for (int32_t k = 0; k < curve->stages; k++) { /* reversible, then similar */
        int before = k > 0 ? curve->stage[k - 1].unloading : FILM_RETRACE;
        int similar = curve->stage[k].unloading == FILM_SIMILAR && k > 0 && curve->stage[k].begin > 0.0;
        if (curve->stage[k].damped || !(similar || (curve->stage[k].unloading == FILM_RETRACE && before == FILM_RETRACE))) return 1;
    }
    return !(curve->stage[curve->stages - 1].end > 0.0);
}

int film_check_curve(const film_curve *curve) {
    int32_t pieces = 0;
    if (curve->stages < 1 || curve->stages > FILM_MAX_STAGES || bad_beginning(curve)) return FILM_BAD_CURVE;
    if (!(curve->compliance >= 0.0 && curve->compliance < INFINITY)) return FILM_BAD_CURVE;
    if (curve->compliance > 0.0 && curve->stage[0].damped) return FILM_BAD_CURVE;
    for (int32_t k = 0; k < curve->stages; k++) {
        if (k > 0 && curve->stage[k].begin != curve->stage[k - 1].end) return FILM_BAD_CURVE;
        if (bad_stage(curve, &curve->stage[k], pieces)) return FILM_BAD_CURVE;
        pieces += curve->stage[k].count;
    }
    return pieces == curve->pieces ? FILM_OK : FILM_BAD_CURVE;
}

/* ---------------------------------------------------------------- families of curves */

/* The Chebyshev polynomials at z. */
static void polynomials(double z, int32_t count, double *of) {
    of[0] = 1.0;
    of[1] = z;
    for (int32_t n = 2; n < count; n++) of[n] = 2.0 * z * of[n - 1] - of[n - 2];
}

int film_factors(const film_family *family, const double *shape, double *of, double *end) {
    double log_end = 0.0;
    if (family->nodes < 2 || family->nodes > FILM_MAX_NODES) return 0;
    if (family->high == 0.0) {
        memcpy(of, shape, (size_t)family->nodes * sizeof *of);
        *end = shape[family->nodes];
        return *end > 0.0;
    }
    if (!(*shape >= family->low && *shape <= family->high)) return 0;
    polynomials(2.0 * log(*shape / family->low) / log(family->high / family->low) - 1.0, family->nodes, of);
    for (int32_t n = 0; n < family->nodes; n++) log_end += of[n] * family->numbers[n];
    *end = exp(log_end);
    return 1;
}

int film_shape(const film_family *family, const film_curve *whole, const double *shape, film_curve *curve) {
    return film_shape_up_to(family, whole, shape, INFINITY, curve);
}

/* The work that the last stage has done where piece p begins, if the family varies it from `column` on; else -INFINITY. */
static double work_before(const film_family *family, const film_curve *whole, const double *of, int32_t p, int32_t *column) {
    const double *places = family->numbers + family->nodes, *table = places + family->varying;
    double place = (double)(&whole->piece[p].work_at_begin - (const double *)whole), sum = 0.0;
    while (*column < family->varying && places[*column] < place) ++*column;
    if (*column >= family->varying || places[*column] != place) return -INFINITY;
    for (int32_t n = 0; n < family->nodes; n++) sum -= of[n] * table[(int64_t)n * family->varying + *column];
    return sum;
}

int film_shape_up_to(const film_family *family, const film_curve *whole, const double *shape, double energy, film_curve *curve) {
    enum { TOGETHER = 64 };
    int32_t nodes = family->nodes, varying = family->varying, last = whole->stages - 1, first = whole->stage[last].first;
    const double *places = family->numbers + nodes, *table = places + varying;
    double of[FILM_MAX_NODES], end, sum[TOGETHER], *doubles = (double *)curve;
    if (!film_factors(family, shape, of, &end)) return FILM_BAD_CURVE;
    int32_t piece = first, column = 0;
    while (piece < whole->pieces - 1 && whole->piece[piece].end < end) {
        curve->piece[piece].end = whole->piece[piece].end;
        if (energy < INFINITY && work_before(family, whole, of, piece + 1, &column) > energy) {
            end = whole->piece[piece].end;
            break;
        }
        piece++;
    }
    curve->pieces = piece + 1;
    curve->stage[last].count = piece + 1 - first;
    curve->piece[piece].end = curve->stage[last].end = end;
    double beyond = (double)((const double *)&whole->piece[piece + 1] - (const double *)whole);
    while (varying > 0 && places[varying - 1] >= beyond) varying--;
    for (int32_t v = 0; v < varying; v += TOGETHER) {
        int32_t count = varying - v < TOGETHER ? varying - v : TOGETHER;
        memset(sum, 0, sizeof sum);
        for (int32_t n = 0; n < nodes; n++) {
            const double *row = table + (int64_t)n * family->varying + v;
            for (int32_t k = 0; k < count; k++) sum[k] += of[n] * row[k];
        }
        for (int32_t k = 0; k < count; k++) doubles[(int32_t)places[v + k]] = sum[k];
    }
    return FILM_OK;
}
