/* One contact from its start to its end: undisturbed or damped by the way of a batch, else by film_marched. docs/method.md,
 * section 10. */
#include "batch/film_batch.h"

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    int32_t status;
    int in_lanes = start->gamma >= 0.0 && start->gamma < INFINITY && start->nu > 0.0 && start->nu < INFINITY && is_undisturbed(curve, start);
    if ((in_lanes || start->damping > 0.0) && film_single(curve, mesh, start, summary, &status)) return status;
    return film_marched(curve, mesh, start, summary);
}
