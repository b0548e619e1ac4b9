/* One impact on a target that moves, or in series with a spring, by the lanes' code for a block of one: the same operations
 * in the same order, so the same bits as in a batch. docs/method.md, section 10. */
#define FILM_LANES 1
#define FILM_ROUTINES one_lane
#define FILM_OWN static
#include "film_blocks.h"
#include "film_lanes.c"

/* One impact on a curve, to be run by the lanes' code. */
static void give_one(batch_job *j, const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary,
                     int32_t *status) {
    j->curve = curve;
    j->mesh = mesh;
    j->start = start;
    j->summary = summary;
    j->status = status;
    j->family = NULL;
    j->spring = NULL;
    j->shaped = -1;
}

int film_single(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    block one = {{0}, 1};
    double stored;
    b.run = &one_lane;
    give_one(&b.j, curve, mesh, start, summary, status);
    if (start->damping != 0.0) {
        film_prepare_damped(&b.j);
        if (!in_damped_lanes(&b.j, start)) return 0;
        b.damped = one;
        run_damped(&b);
        return 1;
    }
    if (mesh->loading < FEWEST || mesh->unloading < FEWEST || !film_prepare_job(&b.j)) return 0;
    int32_t stage = moving_stage(&b.j, start->nu, start->gamma, &stored);
    if (stage < 0) return 0;
    for (int32_t g = 0; g < 3; g++) b.unloading[stage][g].count = 0;
    run_moving(&b, stage, &one);
    return 1;
}

void film_single_in_series(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                           const double *compliance, int32_t varying, const int32_t *places, const double *values,
                           film_summary *summary, int32_t *status) {
    film_curve own = *curve;
    double *doubles = (double *)&own;
    const int64_t first = 0;
    batch_job j;
    film_make_rule(mesh->loading, &j.rule);
    for (int64_t i = 0; i < count; i++) {
        int32_t stage = 0, piece = -1;
        for (int32_t k = 0; k < varying; k++) doubles[places[k]] = values[i * varying + k];
        give_one(&j, &own, mesh, &start[i], &summary[i], &status[i]);
        j.spring = &compliance[i];
        status[i] = LEFT_ALONE;
        if (!is_plain(&j, &start[i]) || !film_prepare_job(&j)) continue;
        film_prepare_pieces(&j);
        piece = film_piece_on_fixed(&j, 0, &stage);
        if (piece >= 0) one_lane.spring(&j, stage, piece, &first, 1);
    }
}
