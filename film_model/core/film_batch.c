/* Many impacts at once, by faster ways than the march where there are any; on targets that move the results differ from
 * film_marched's by less than the error of the lines. Impacts are sorted into blocks by the piece of the law in which they
 * should turn; film_lanes.c runs a block. docs/method.md, section 10. */
#include "film_blocks.h"

/* ---------------------------------------------------------------- instruction sets
 * The same source for the plain instructions of the processor's kind and, on x86, for AVX2 and AVX-512; never with
 * fused multiply-adds, so that all give the same bits. */

#if defined(FILM_WIDE)
#include <cpuid.h>

int film_instructions(void) {
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || !(c & bit_OSXSAVE)) return FILM_PLAIN;
    /* which registers the operating system saves */
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 0x06) != 0x06 || !__get_cpuid_count(7, 0, &a, &b, &c, &d) || !(b & bit_AVX2)) return FILM_PLAIN;
    const unsigned all = bit_AVX512F | bit_AVX512DQ | bit_AVX512VL;
    return (low & 0xe6) == 0xe6 && (b & all) == all ? FILM_AVX512 : FILM_AVX2;
}

static const block_routines *const routines[] = {&film_plain, &film_avx2, &film_avx512};
#else
int film_instructions(void) { return FILM_PLAIN; }
static const block_routines *const routines[] = {&film_plain};
#endif

/* ---------------------------------------------------------------- sorting */

static void run_fixed(batch *b, int32_t stage, block *waiting) {
    if (waiting->count > 0) b->run->fixed(&b->j, stage, waiting->index, waiting->count);
    waiting->count = 0;
}

/* The piece of *stage in which a fixed target should turn the impactor, by the march's own arithmetic; -1: none. */
static int32_t fixed_piece(const batch_job *j, double v, int32_t *stage) {
    for (int32_t k = 0; k < j->curve->stages; k++) {
        double energy = 0.5 * v * v, left = energy - j->whole[k];
        if (left >= 0.0) {
            v = speed_after(v, j->whole[k]);
            continue;
        }
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        while (p < last && energy > j->piece_work[p]) p++;
        *stage = k;
        return p;
    }
    return -1;
}

/* The same for a target that moves. */
static int32_t moving_piece(const batch_job *j, double nu, double gamma, int32_t *stage) {
    double stored;
    int32_t k = *stage = moving_stage(j, nu, gamma, &stored);
    if (k < 0) return -1;
    int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
    while (p < last && !(turn_excess(stored + j->piece_work[p], j->piece_force[p], nu, gamma) > 0.0)) p++;
    return p;
}

/* Work and force at the ends of all pieces. */
static void prepare_pieces(batch_job *j) {
    for (int32_t k = 0; k < j->curve->stages; k++)
        for (int32_t p = j->curve->stage[k].first; p < j->curve->stage[k].first + j->curve->stage[k].count; p++) {
            j->piece_work[p] = j->piece_force[p] = INFINITY;
            double end = j->curve->piece[p].end;
            if (end < INFINITY) stage_law(j->curve, k, end, &j->piece_force[p], &j->piece_work[p]);
        }
}

enum { FEW = 4 }; /* impacts that one by one take less time than a block of them */

/* A block that is not full. */
static void run_few(batch *b, int32_t stage, block *waiting) {
    batch_job *j = &b->j;
    int alone = waiting->count <= FEW;
    for (int l = 0; alone && l < waiting->count; l++) {
        int64_t i = waiting->index[l];
        alone = film_single(j->curve, j->mesh, &j->start[i], &j->summary[i], &j->status[i]);
    }
    if (alone) waiting->count = 0;
    else run_moving(b, stage, waiting);
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

void film_batch_with(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count,
                     const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    batch_job *j = &b.j;
    j->curve = curve;
    j->mesh = mesh;
    j->start = start;
    j->summary = summary;
    j->status = status;
    int in_lanes = film_prepare_job(j), moving = in_lanes && mesh->loading >= FEWEST && mesh->unloading >= FEWEST;
    b.run = routines[instructions];
    if (in_lanes) prepare_pieces(j);
    for (int32_t p = 0; p < FILM_MAX_PIECES; p++) b.fixed[p].count = b.moving[p].count = 0;
    for (int32_t k = 0; k < FILM_MAX_STAGES; k++)
        for (int32_t g = 0; g < 3; g++) b.unloading[k][g].count = 0;
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &start[i];
        int32_t stage = 0, piece = -1;
        if (in_lanes && s->gamma >= 0.0 && s->gamma < INFINITY && s->nu > 0.0 && s->nu < INFINITY && is_undisturbed(s)) {
            if (s->gamma == 0.0) piece = fixed_piece(j, s->nu, &stage);
            else if (moving) piece = moving_piece(j, s->nu, s->gamma, &stage);
        }
        if (piece < 0) {
            status[i] = film_marched(curve, mesh, s, &summary[i]);
            continue;
        }
        block *waiting = s->gamma == 0.0 ? &b.fixed[piece] : &b.moving[piece];
        waiting->index[waiting->count++] = i;
        if (waiting->count < LANES) continue;
        if (s->gamma == 0.0) run_fixed(&b, stage, waiting);
        else run_moving(&b, stage, waiting);
    }
    if (in_lanes) run_rest(&b);
}

enum { WORTH_ASKING = 2000 }; /* impacts, for the microseconds that film_instructions may take */

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    int instructions = count < WORTH_ASKING ? FILM_PLAIN : film_instructions();
    film_batch_with(instructions, curve, mesh, count, start, summary, status);
}
