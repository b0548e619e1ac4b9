/* One impact by the lanes' code for a block of one: on a target that moves, or in series with a spring, the same operations in
 * the same order, so the same bits as in a batch; on a fixed one without the series that pay only for many impacts.
 * docs/method.md, section 10. */
#define FILM_LANES 1
#define FILM_ROUTINES one_lane
#define FILM_OWN static
#include "batch/film_blocks.h"
#include "lanes/film_lanes.c"

void film_record_alone(const motions_wanted *m, double *bad) { one_lane.record(m, 1, bad); }

/* Work, force and slope where a piece ends, INFINITY where it does not: at the end of a series' interval by the sums of its
 * terms, T_k(1) = 1 and T_k'(1) = k^2. */
static void look_at_end(batch_job *j, int32_t p) {
    const film_piece *piece = &j->curve->piece[p];
    const film_function *g = &piece->force, *h = &piece->mean;
    double *force = &j->piece_force[p], *work = &j->piece_work[p], *slope = &j->piece_slope[p];
    double reach = piece->end - g->origin, sum = 0.0, part = 0.0, of_mean = 0.0;
    *force = *work = *slope = INFINITY;
    if (!(piece->end < INFINITY)) return;
    if (g->form != FILM_SERIES || h->form != FILM_SERIES || fabs(reach * g->per_span - 1.0) > 1e-15 || h->per_span != g->per_span) {
        piece_law(piece, piece->end, force, work);
        *slope = slope_at(g, piece->end);
        return;
    }
    double square = 0.0, odd = 1.0; /* k^2 and (k + 1)^2 - k^2 */
    for (int32_t k = 0; k < g->terms; k++, square += odd, odd += 2.0) {
        sum += g->series[k];
        part += square * g->series[k];
    }
    for (int32_t k = 0; k < h->terms; k++) of_mean += h->series[k];
    *force = sum;
    *slope = 2.0 * g->per_span * part;
    *work = reach * of_mean - piece->work_at_begin;
}

/* One impact on a fixed target: the law is evaluated only as far as the turn. */
static int run_fixed(batch_job *j, double nu) {
    const film_curve *curve = j->curve;
    const int64_t only = 0;
    double energy = 0.5 * nu * nu;
    if (!film_is_quick(curve, j->mesh)) return 0;
    film_prepare_stage(j, 0);
    for (int32_t k = 0; k < curve->stages; k++) {
        int32_t p = curve->stage[k].first, last = p + curve->stage[k].count - 1;
        for (look_at_end(j, p); p < last && energy > j->piece_work[p]; look_at_end(j, ++p)) {
        }
        j->whole[k] = j->piece_work[p];
        if (energy < j->whole[k]) {
            if (k > 0) film_prepare_stage(j, k);
            film_make_rule(j->mesh->loading, &j->rule);
            fixed_lanes(j, k, p, &only, 1);
            return 1;
        }
        energy -= j->whole[k];
    }
    return 0;
}

int film_single(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    block one = {{0}, 1};
    double stored;
    b.run = &one_lane;
    give(&b.j, curve, mesh, start, summary, status);
    b.j.loaded = start->load > 0.0;
    if (by_quadrature(&b.j, start) && start->damping == 0.0) return run_fixed(&b.j, start->nu);
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

void film_run_varying(const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start, film_summary *summary,
                      int32_t *status) {
    film_curve own = *of->curve;
    double *doubles = (double *)&own;
    const int64_t first = 0;
    batch_job j;
    film_make_rule(mesh->loading, &j.rule);
    for (int64_t i = 0; i < count; i++) {
        int32_t stage = 0, piece = -1;
        status[i] = LEFT_ALONE;
        if (of->compliance == NULL) continue;
        for (int32_t k = 0; k < of->varying; k++) doubles[of->places[k]] = of->values[i * of->varying + k];
        give(&j, &own, mesh, &start[i], &summary[i], &status[i]);
        j.spring = &of->compliance[i];
        if (!is_plain(&j, &start[i]) || !film_prepare_job(&j)) continue;
        film_prepare_pieces(&j);
        piece = film_piece_on_fixed(&j, 0, &stage);
        if (piece >= 0) one_lane.spring(&j, stage, piece, &first, 1);
    }
}
