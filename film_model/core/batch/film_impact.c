/* One contact from its start to its end: undisturbed or damped by the way of a batch, else by film_marched. And many, one after
 * another, each on a curve of its own. docs/method.md, section 10. */
#include "batch/film_batch.h"

#include <string.h>

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    int32_t status;
    int in_lanes = start->gamma >= 0.0 && start->gamma < INFINITY && start->nu > 0.0 && start->nu < INFINITY && is_undisturbed(curve, start);
    if ((in_lanes || start->damping > 0.0) && film_single(curve, mesh, start, summary, &status)) return status;
    return film_marched(curve, mesh, start, summary);
}

void film_impacts_left(const film_family *family, const film_curve *whole, const film_mesh *mesh, int64_t count,
                       const film_start *start, const double *shape, film_summary *summary, int32_t *status) {
    film_curve curve = *whole;
    int made = FILM_BAD_CURVE;
    int32_t numbers = film_family_numbers(family);
    const double *last = NULL;
    for (int64_t i = 0; i < count; i++) {
        if (status[i] != LEFT_ALONE) continue;
        const double *own = &shape[i * numbers];
        if (last == NULL || memcmp(own, last, (size_t)numbers * sizeof *own) != 0) made = film_shape_at(family, whole, own, &curve);
        last = own;
        status[i] = made < 0 ? made : film_impact(&curve, mesh, &start[i], &summary[i]);
    }
}

void film_batch_varied(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                       int32_t varying, const int32_t *places, const double *values, film_summary *summary, int32_t *status) {
    film_curve own = *curve;
    double *doubles = (double *)&own;
    for (int64_t i = 0; i < count; i++) {
        for (int32_t k = 0; k < varying; k++) doubles[places[k]] = values[i * varying + k];
        status[i] = film_impact(&own, mesh, &start[i], &summary[i]);
    }
}
