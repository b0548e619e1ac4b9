/* Many contacts, each on a curve of its own. docs/method.md, sections 8 and 10. */
#include "batch/film_batch.h"

int film_curve_of(const film_curves *of, int64_t i, double energy, film_curve *own) {
    const film_curve *curve = of->curve;
    double *doubles = (double *)own;
    int made = FILM_OK;
    own->pieces = curve->pieces; /* what the contact before has changed */
    own->compliance = curve->compliance;
    for (int32_t k = 0; k < curve->stages; k++) own->stage[k] = curve->stage[k];
    for (int32_t p = 0; p < curve->pieces; p++) {
        own->piece[p].end = curve->piece[p].end;
        own->piece[p].work_at_begin = curve->piece[p].work_at_begin;
    }
    if (of->family != NULL) made = film_shape_up_to(of->family, curve, &of->shape[i * film_family_numbers(of->family)], energy, own);
    for (int32_t k = 0; k < of->varying; k++) doubles[of->places[k]] = of->values[i * of->varying + k];
    return made < 0 || of->compliance == NULL ? made : film_put_in_series(own, of->compliance[i]);
}

double film_most_work(const film_curve *curve, const film_start *start) {
    return start->gamma == 0.0 && is_undisturbed(curve, start) ? 0.5 * start->nu * start->nu : INFINITY;
}

/* Those of status LEFT_ALONE, one after another. */
static void march_on(const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start, film_summary *summary,
                     int32_t *status) {
    film_curve own = *of->curve;
    for (int64_t i = 0; i < count; i++) {
        double energy = of->compliance == NULL ? INFINITY : film_most_work(of->curve, &start[i]);
        if (status[i] != LEFT_ALONE) continue;
        for (int again = 1; again; energy = INFINITY) { /* again if rounding takes it beyond the pieces that are made */
            int made = film_curve_of(of, i, energy, &own);
            status[i] = made < 0 ? made : film_impact(&own, mesh, &start[i], &summary[i]);
            again = status[i] == FILM_BEYOND_LAW && of->family != NULL && energy < INFINITY;
        }
    }
}

void film_batch_of(int instructions, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                   film_summary *summary, int32_t *status) {
    if (of->varying == 0) film_run_rows(instructions, of, mesh, count, start, summary, status);
    else film_run_varying(of, mesh, count, start, summary, status);
    march_on(of, mesh, count, start, summary, status);
}
