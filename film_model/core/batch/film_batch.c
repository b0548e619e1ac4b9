/* Many impacts at once, by faster ways than the march where there are any; on targets that move the results differ from
 * film_marched's by less than the error of the lines. Impacts are sorted into blocks by the piece of the law in which they
 * should turn; film_lanes.c runs a block. docs/method.md, section 10. */
#include "batch/film_blocks.h"

#if defined(FILM_WIDE)
static const block_routines *const routines[] = {&film_plain, &film_avx2, &film_avx512};
#else
static const block_routines *const routines[] = {&film_plain};
#endif

const block_routines *film_routines(int instructions) { return routines[instructions]; }

/* ---------------------------------------------------------------- sorting */

/* Makes each lane's stages for a block that should turn in `piece`. */
static void make_own(batch *b, const block *waiting, int32_t piece) {
    double of[FILM_MAX_NODES][LANES];
    film_own_factors(&b->j, waiting->index, waiting->count, of);
    b->run->shape(&b->j, piece - b->j.curve->stage[b->j.shaped].first + 2, (const double(*)[LANES])of);
}

static void run_fixed(batch *b, int32_t stage, block *waiting) {
    if (waiting->count == 0) return;
    if (stage == b->j.shaped) make_own(b, waiting, (int32_t)(waiting - b->fixed));
    if (b->j.rule.count == 0) film_make_rule(b->j.mesh->loading, &b->j.rule);
    (b->j.spring != NULL ? b->run->spring : b->run->fixed)(&b->j, stage, (int32_t)(waiting - b->fixed), waiting->index, waiting->count);
    waiting->count = 0;
}

/* Runs a block to the turn and to the end of contact. */
static void run_block(batch *b, int32_t stage, block *waiting) {
    if (waiting->count > 0 && stage == b->j.shaped) make_own(b, waiting, (int32_t)(waiting - b->moving));
    run_moving(b, stage, waiting);
}

/* film_piece_on_fixed for a target that moves. */
static int32_t moving_piece(const batch_job *j, int64_t i, int32_t *stage) {
    double stored, nu = j->start[i].nu, gamma = j->start[i].gamma;
    int32_t k = *stage = moving_stage(j, nu, gamma, &stored);
    if (k < 0) return -1;
    if (k == j->shaped) return film_own_piece(j, i, nu, stored);
    int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
    while (p < last && !(turn_excess(stored + j->piece_work[p], j->piece_force[p], nu, gamma) > 0.0)) p++;
    return p;
}

void film_prepare_pieces(batch_job *j) {
    for (int32_t k = 0; k < j->curve->stages; k++)
        for (int32_t p = j->curve->stage[k].first; p < j->curve->stage[k].first + j->curve->stage[k].count; p++) {
            j->piece_work[p] = j->piece_force[p] = INFINITY;
            double end = j->curve->piece[p].end;
            if (end < INFINITY) stage_law(j->curve, k, end, &j->piece_force[p], &j->piece_work[p]);
        }
}

enum { FEW = 4 }; /* up to so many impacts are faster one by one than as a block */

/* A block that is not full. */
static void run_few(batch *b, int32_t stage, block *waiting) {
    batch_job *j = &b->j;
    int alone = waiting->count <= FEW && j->family == NULL;
    for (int l = 0; alone && l < waiting->count; l++) {
        int64_t i = waiting->index[l];
        alone = film_single(j->curve, j->mesh, &j->start[i], &j->summary[i], &j->status[i]);
    }
    if (alone) waiting->count = 0;
    else run_block(b, stage, waiting);
}

/* Runs all blocks that are not full. */
static void run_rest(batch *b) {
    const film_curve *curve = b->j.curve;
    for (int32_t k = 0; k < curve->stages; k++) {
        for (int32_t p = curve->stage[k].first; p < curve->stage[k].first + curve->stage[k].count; p++) {
            run_fixed(b, k, &b->fixed[p]);
            run_few(b, k, &b->moving[p]);
        }
        for (int32_t g = 0; g < 3; g++) run_unloading(b, k, g);
    }
}

/* Puts each impact into its block and runs full blocks. One call takes the undamped impacts under a load that lanes may run
 * (j->loaded), the other the rest. Returns how many are left for the other call. */
static int64_t sort_impacts(batch *b, int64_t count, int in_lanes, int moving) {
    batch_job *j = &b->j;
    int64_t others = 0;
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &j->start[i];
        int32_t stage = 0, piece = -1;
        int damped = in_damped_lanes(j, s), plain = !damped && in_lanes && is_plain(j, s), fixed = by_quadrature(j, s);
        if ((plain && s->load > 0.0) != j->loaded) {
            others++;
            continue;
        }
        if (damped) {
            b->damped.index[b->damped.count++] = i;
            if (b->damped.count == LANES) run_damped(b);
            continue;
        }
        if (plain && fixed) piece = film_piece_on_fixed(j, i, &stage);
        if (s->stop_velocity < 0.0 && (!fixed || j->curve->stage[stage].unloading == FILM_RETRACE)) piece = -1; /* it may stop in any stage */
        else if (plain && !fixed && moving) piece = moving_piece(j, i, &stage);
        if (piece < 0) {
            leave_alone(j, i);
            continue;
        }
        block *waiting = fixed ? &b->fixed[piece] : &b->moving[piece];
        waiting->index[waiting->count++] = i;
        if (waiting->count < LANES) continue;
        if (fixed) run_fixed(b, stage, waiting);
        else run_block(b, stage, waiting);
    }
    return others;
}

/* Runs the impacts of b->j. */
static void run_batch(batch *b, int instructions, int64_t count) {
    batch_job *j = &b->j;
    const film_mesh *mesh = j->mesh;
    int in_lanes = film_prepare_job(j), moving = in_lanes && mesh->loading >= FEWEST && mesh->unloading >= FEWEST;
    b->run = routines[instructions];
    if (in_lanes) film_prepare_pieces(j);
    j->rule.count = 0;
    for (int32_t p = 0; p < FILM_MAX_PIECES; p++) j->across[p].terms = 0;
    film_prepare_damped(j);
    b->damped.count = 0;
    for (int32_t p = 0; p < FILM_MAX_PIECES; p++) b->fixed[p].count = b->moving[p].count = 0;
    for (int32_t k = 0; k < FILM_MAX_STAGES; k++)
        for (int32_t g = 0; g < 3; g++) b->unloading[k][g].count = 0;
    j->loaded = 0;
    int64_t loaded = sort_impacts(b, count, in_lanes, moving);
    if (in_lanes) run_rest(b);
    run_damped(b);
    if (loaded == 0) return;
    j->loaded = 1;
    sort_impacts(b, count, in_lanes, moving);
    run_rest(b);
}

void film_batch(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    batch b;
    give(&b.j, curve, mesh, start, summary, status);
    run_batch(&b, instructions, count);
}

void film_run_rows(int instructions, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                   film_summary *summary, int32_t *status) {
    batch b;
    own_stage own;
    give(&b.j, of->curve, mesh, start, summary, status);
    b.j.spring = of->compliance;
    b.j.family = of->family;
    b.j.shape = of->shape;
    if (of->family != NULL) film_own_stage(&b.j, &own);
    run_batch(&b, instructions, count);
}
