/* Batches on the curves of a family: which of its numbers lanes need, and where an impact should turn. docs/method.md,
 * section 10. */
#include "batch/film_batch.h"

static double series_at(const double *of, int32_t nodes, const double *first, int32_t apart) {
    double sum = 0.0;
    for (int32_t n = 0; n < nodes; n++) sum += of[n] * first[(int64_t)n * apart];
    return sum;
}

/* Whether the family's columns from `column` on are work_at_begin, force and mean of a piece, one after the other. */
static int is_in_order(const film_family *family, const film_curve *whole, const film_piece *piece, int32_t column) {
    const double *from[3] = {&piece->work_at_begin, piece->force.series, piece->mean.series};
    const double *places = family->numbers + family->nodes;
    int32_t terms[3] = {1, piece->force.terms, piece->mean.terms};
    int32_t room = family->varying < OWN_DOUBLES ? family->varying : OWN_DOUBLES;
    if (piece->force.form != FILM_SERIES || piece->mean.form != FILM_SERIES) return 0;
    if (column + 1 + terms[1] + terms[2] > room) return 0;
    for (int part = 0; part < 3; part++)
        for (int32_t k = 0; k < terms[part]; k++)
            if (places[column++] != (double)(from[part] + k - (const double *)whole)) return 0;
    return 1;
}

void film_own_stage(batch_job *j, own_stage *own) {
    const film_family *family = j->family;
    const double *table = family->numbers + family->nodes + family->varying;
    int32_t stage = j->curve->stages - 1, first = j->curve->stage[stage].first, column = 0, p = 0;
    for (; p < OWN_PIECES && first + p < j->curve->pieces; p++) {
        const film_piece *piece = &j->curve->piece[first + p];
        if (!is_in_order(family, j->curve, piece, column)) break;
        own->piece[p].column = column;
        own->piece[p].force = piece->force.terms;
        own->piece[p].mean = piece->mean.terms;
        for (int32_t n = 0; n < family->nodes && n < FILM_MAX_NODES; n++) {
            double sum = 0.0; /* at the end of a piece every polynomial is 1 */
            for (int32_t k = 0; k < piece->force.terms; k++) sum += table[(int64_t)n * family->varying + column + 1 + k];
            own->edge_force[p][n] = sum;
        }
        column += 1 + piece->force.terms + piece->mean.terms;
    }
    own->usable = p;
    j->own = own;
    j->shaped = stage;
}

/* Lanes must not come near the end of their law: the piece behind the one in which they should turn has to be theirs too. */
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
