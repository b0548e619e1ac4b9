/* One impact on a target that moves, by the lanes' code for a block of one: the same operations in the same order, so the
 * same bits as in a batch. docs/method.md, section 10. */
#define FILM_LANES 1
#define FILM_ROUTINES one_lane
#define FILM_OWN static
#include "film_blocks.h"
#include "film_lanes.c"

int film_single(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    block one = {{0}, 1};
    double stored;
    b.run = &one_lane;
    b.j.curve = curve;
    b.j.mesh = mesh;
    b.j.start = start;
    b.j.summary = summary;
    b.j.status = status;
    b.j.family = NULL;
    b.j.shaped = -1;
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
