/* Many contacts, each in series with a spring of its own. docs/method.md, sections 8 and 10. */
#include "batch/film_batch.h"

/* What film_put_in_series changes of a curve. */
typedef struct {
    film_stage stage[FILM_MAX_STAGES];
    double end[FILM_MAX_PIECES], work_at_begin[FILM_MAX_PIECES];
} free_ends;

static void keep_ends(const film_curve *curve, free_ends *kept) {
    for (int32_t k = 0; k < curve->stages; k++) kept->stage[k] = curve->stage[k];
    for (int32_t p = 0; p < curve->pieces; p++) {
        kept->end[p] = curve->piece[p].end;
        kept->work_at_begin[p] = curve->piece[p].work_at_begin;
    }
}

static void put_back(film_curve *curve, const free_ends *kept) {
    for (int32_t k = 0; k < curve->stages; k++) curve->stage[k] = kept->stage[k];
    for (int32_t p = 0; p < curve->pieces; p++) {
        curve->piece[p].end = kept->end[p];
        curve->piece[p].work_at_begin = kept->work_at_begin[p];
    }
    curve->compliance = 0.0;
}

/* The work of the springless law is at most this on the way to the turn: a fixed target without a load stores all of it. */
static double most_work(const film_curve *curve, const film_start *start) {
    return start->gamma == 0.0 && is_undisturbed(curve, start) ? 0.5 * start->nu * start->nu : INFINITY;
}

/* Those of status LEFT_ALONE by the march, one after another. */
static void march_in_series(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                            const double *compliance, const film_family *family, const double *shape, int32_t varying,
                            const int32_t *places, const double *values, film_summary *summary, int32_t *status) {
    film_curve own = *curve;
    free_ends whole;
    double *doubles = (double *)&own;
    keep_ends(curve, &whole);
    int32_t numbers = family == NULL ? 0 : film_family_numbers(family);
    for (int64_t i = 0; i < count; i++) {
        double energy = most_work(curve, &start[i]);
        if (status[i] != LEFT_ALONE) continue;
        for (int again = 1; again; energy = INFINITY) { /* again if rounding takes it beyond the pieces that are made */
            int shaped = FILM_OK;
            own.pieces = curve->pieces;
            put_back(&own, &whole);
            if (family != NULL) shaped = film_shape_up_to(family, curve, &shape[i * numbers], energy, &own);
            for (int32_t k = 0; k < varying; k++) doubles[places[k]] = values[i * varying + k];
            int made = shaped < 0 ? shaped : film_put_in_series(&own, compliance[i]);
            status[i] = made < 0 ? made : film_impact(&own, mesh, &start[i], &summary[i]);
            again = status[i] == FILM_BEYOND_LAW && family != NULL && energy < INFINITY;
        }
    }
}

void film_batch_in_series(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                          const double *compliance, const film_family *family, const double *shape, int32_t varying,
                          const int32_t *places, const double *values, film_summary *summary, int32_t *status) {
    if (varying == 0) film_run_rows(instructions, family, curve, mesh, count, start, shape, compliance, summary, status);
    else film_single_in_series(curve, mesh, count, start, compliance, varying, places, values, summary, status);
    march_in_series(curve, mesh, count, start, compliance, family, shape, varying, places, values, summary, status);
}
