/* Batches on the curves of a family: which of its numbers lanes need; and where an impact should turn. docs/method.md,
 * section 10. */
#include "batch/film_batch.h"

static double series_at(const double *of, int32_t nodes, const double *first, int32_t apart) {
    double sum = 0.0;
    for (int32_t n = 0; n < nodes; n++) sum += of[n] * first[(int64_t)n * apart];
    return sum;
}

/* Whether the family's columns from `column` on are `count` doubles of the curve, one after the other. */
static int are_next(const film_family *family, const film_curve *whole, const double *from, int32_t count, int32_t column) {
    const double *places = family->numbers + family->nodes;
    if (column + count > family->varying || column + count > OWN_DOUBLES) return 0;
    for (int32_t k = 0; k < count; k++)
        if (places[column + k] != (double)(from + k - (const double *)whole)) return 0;
    return 1;
}

/* Terms of a series of the unloading that the family varies from `column` on; 0: it does not. */
static int32_t own_terms(const film_family *family, const film_curve *whole, const film_function *g, int32_t column) {
    return g->form == FILM_SERIES && are_next(family, whole, g->series, g->terms, column) ? g->terms : 0;
}

/* What the family varies of piece p of the last stage, and where its columns end; -1: other numbers than lanes can have. */
static int32_t own_columns(const film_family *family, const film_curve *whole, own_stage *own, int32_t p, int32_t column) {
    const film_piece *piece = &whole->piece[whole->stage[whole->stages - 1].first + p];
    own->piece[p].column = column;
    own->piece[p].force = piece->force.terms;
    own->piece[p].mean = piece->mean.terms;
    if (piece->force.form != FILM_SERIES || piece->mean.form != FILM_SERIES) return -1;
    if (!are_next(family, whole, &piece->work_at_begin, 1, column++)) return -1;
    if (!are_next(family, whole, piece->force.series, piece->force.terms, column)) return -1;
    column += piece->force.terms;
    if (!are_next(family, whole, piece->mean.series, piece->mean.terms, column)) return -1;
    column += piece->mean.terms;
    column += own->piece[p].recovery = own_terms(family, whole, &piece->recovery, column);
    column += own->piece[p].exponent = own_terms(family, whole, &piece->exponent, column);
    double next = (double)((const double *)(piece + 1) - (const double *)whole); /* another number of this piece varies */
    if (column < family->varying && family->numbers[family->nodes + column] < next) return -1;
    return column;
}

void film_own_stage(batch_job *j, own_stage *own) {
    const film_family *family = j->family;
    const double *table = family->numbers + family->nodes + family->varying;
    int32_t stage = j->curve->stages - 1, first = j->curve->stage[stage].first, column = 0, p = 0;
    for (; p < OWN_PIECES && first + p < j->curve->pieces; p++) {
        int32_t behind = own_columns(family, j->curve, own, p, column);
        if (behind < 0) break;
        for (int32_t n = 0; n < family->nodes && n < FILM_MAX_NODES; n++) {
            double sum = 0.0; /* at the end of a piece every polynomial is 1 */
            for (int32_t k = 0; k < own->piece[p].force; k++) sum += table[(int64_t)n * family->varying + column + 1 + k];
            own->edge_force[p][n] = sum;
        }
        column = behind;
    }
    own->usable = p;
    j->own = own;
    j->shaped = stage;
}

/* Lanes must not come near the end of their law: lanes need the next piece after the one in which they should turn, too. */
int32_t film_own_piece(const batch_job *j, int64_t i, double v, double stored) {
    const film_family *family = j->family;
    double of[FILM_MAX_NODES], end, nu = j->start[i].nu, gamma = j->start[i].gamma;
    int32_t first = j->curve->stage[j->shaped].first;
    if (!film_factors(family, &j->shape[i * film_family_numbers(family)], of, &end)) return -1;
    for (int32_t p = 0; p < j->own->usable - 1 && j->curve->piece[first + p + 1].end <= end; p++) {
        const double *next = family->numbers + family->nodes + family->varying + j->own->piece[p + 1].column;
        double work = -series_at(of, family->nodes, next, family->varying); /* work_at_begin counts from there */
        double spring = j->spring != NULL ? j->spring[i] : 0.0, force = 0.0;
        if (gamma > 0.0 || spring > 0.0) force = series_at(of, family->nodes, j->own->edge_force[p], 1);
        if (gamma == 0.0) {
            if (0.5 * v * v <= work + 0.5 * spring * force * force) return first + p;
            continue;
        }
        if (turn_excess(stored + work, force, nu, gamma) > 0.0) return first + p;
    }
    return -1;
}

void film_own_factors(const batch_job *j, const int64_t *index, int count, double (*of)[LANES]) {
    double one[FILM_MAX_NODES], end;
    int32_t numbers = film_family_numbers(j->family);
    for (int l = 0; l < LANES; l++) { /* an incomplete block is filled up with its first impact */
        film_factors(j->family, &j->shape[index[l < count ? l : 0] * numbers], one, &end);
        for (int32_t n = 0; n < j->family->nodes; n++) of[n][l] = one[n];
    }
}

static double stored_in_spring(double spring, double force) { return spring > 0.0 ? 0.5 * spring * force * force : 0.0; }

int32_t film_piece_on_fixed(const batch_job *j, int64_t i, int32_t *stage) {
    double nu = j->start[i].nu, energy = 0.5 * nu * nu, spring = j->spring != NULL ? j->spring[i] : 0.0;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        *stage = k;
        if (k == j->shaped) return film_own_piece(j, i, sqrt(2.0 * energy), 0.0);
        if (energy >= j->whole[k] + stored_in_spring(spring, j->end_force[k])) {
            energy -= j->whole[k];
            continue;
        }
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        while (p < last && energy > j->piece_work[p] + stored_in_spring(spring, j->piece_force[p])) p++;
        return p;
    }
    return -1;
}
