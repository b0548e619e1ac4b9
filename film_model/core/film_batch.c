/* Many impacts at once, by faster ways than film_impact where there are any; on targets that move the results differ from
 * film_impact's by less than the error of the lines. Impacts are sorted into blocks by the piece of the law in which they
 * should turn; film_lanes.c runs a block. docs/method.md, section 10. */
#include "film_batch.h"

/* ---------------------------------------------------------------- tables of lines
 * On a stage that is one power from its beginning on, and on an unloading branch, nodes are the same fractions at every
 * depth, and the lines between them scale; across a whole stage they are the same for every impact. */

static void table_law(const batch_job *j, const line_table *t, double x, double *force, double *work) {
    if (t->stage != UNIT_POWER) {
        stage_law(j->curve, t->stage, x, force, work);
        return;
    }
    *force = power_of(x, t->exponent);
    *work = *force * x * work_factor(t->exponent);
}

/* The same lines as film_make_line's. docs/method.md, section 2. */
static void make_rows(const batch_job *j, line_table *t, table_row *rows) {
    double begin = 0.0, end = 1.0, f0 = 0.0, w0 = 0.0;
    int unit = t->stage == UNIT_POWER;
    if (!unit) {
        begin = j->curve->stage[t->stage].begin;
        end = j->curve->stage[t->stage].end;
    }
    for (int32_t i = 0; i <= t->segments; i++) {
        double s = (double)i / t->segments, f1, w1;
        s = t->nodes != NULL ? t->nodes[i] : s * s * (3.0 - 2.0 * s);
        table_row *r = &rows[i];
        r->x = t->direction > 0 ? begin + (end - begin) * s : end + (begin - end) * s;
        if (i == t->segments) r->x = t->direction > 0 ? end : begin;
        table_law(j, t, r->x, &f1, &w1);
        r->force = f1;
        r->work = unit ? 2.0 * (work_factor(t->exponent) - w1) : 2.0 * w1;
        if (i > 0) {
            double h = r->x - rows[i - 1].x, mean = (w1 - w0) / h, kappa = (f1 - f0) / h;
            if (unit && t->direction > 0 && i == t->segments) kappa = 2.0 * (f1 - mean) / h; /* the law's force at the turn */
            if (unit && t->direction < 0 && i == 1) kappa = 2.0 * (mean - f0) / h;
            r->h = fabs(h);
            r->kappa = kappa;
            r->phi = mean - 0.5 * kappa * h;
            if (f1 > t->peak) t->peak = f1;
            double per = r->h / (sqrt(rows[i - 1].work) + sqrt(r->work));
            if (unit) t->rest_time += 2.0 * per * arc(kappa * per * per);
        } else {
            r->h = r->kappa = r->phi = 0.0;
        }
        f0 = f1;
        w0 = w1;
    }
}

const line_table *film_lines_of(batch_job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes,
                                double exponent) {
    for (int32_t i = 0; i < j->table_count; i++) {
        const line_table *t = &j->tables[i];
        if (t->nodes == nodes && t->stage == stage && t->direction == direction && t->segments == segments &&
            (stage != UNIT_POWER || t->exponent == exponent))
            return t;
    }
    line_table *t = &j->tables[j->table_count++];
    table_row *rows = &j->rows[j->row_count];
    j->row_count += segments + 1;
    *t = (line_table){stage, direction, segments, exponent, nodes, 0.0, 0.0, rows};
    make_rows(j, t, rows);
    return t;
}

/* ---------------------------------------------------------------- what all impacts share */

/* The exponent of a stage's branches where it is one number, else NAN. */
static double branch_exponent(const film_curve *curve, int32_t stage) {
    const film_piece *piece = &curve->piece[curve->stage[stage].first];
    for (int32_t p = 0; p < curve->stage[stage].count; p++) {
        const film_function *g = &piece[p].exponent;
        if (g->form != FILM_POWER || g->slope != 0.0 || g->coefficient != 0.0) return NAN;
        if (g->constant != piece->exponent.constant) return NAN;
    }
    return piece->exponent.constant;
}

/* Adds an exponent to the known ones; returns how many there are. */
static int32_t add_exponent(double exponent, double *known, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (known[i] == exponent) return count;
    known[count] = exponent;
    return count + 1;
}

/* 0: lanes cannot run this stage. */
static int prepare_stage(batch_job *j, int32_t k) {
    const film_curve *curve = j->curve;
    const film_stage *stage = &curve->stage[k];
    const film_function *g = &curve->piece[stage->first].force;
    int rising = force_rises(curve, k), reversible = stage->unloading == FILM_RETRACE;
    if (!reversible && stage->unloading == FILM_SHIFTED) return 0; /* it may creep out for ever: only the march sees that */
    j->simple[k] = rising && g->origin == stage->begin;
    j->exponent[k] = reversible ? NAN : branch_exponent(curve, k);
    j->whole[k] = j->end_force[k] = INFINITY;
    if (stage->end < INFINITY) stage_law(curve, k, stage->end, &j->end_force[k], &j->whole[k]);
    else if (!rising) return 0;
    for (int32_t p = stage->first; p < stage->first + stage->count; p++) {
        j->piece_work[p] = j->piece_force[p] = INFINITY;
        if (curve->piece[p].end < INFINITY) stage_law(curve, k, curve->piece[p].end, &j->piece_force[p], &j->piece_work[p]);
    }
    if (reversible && plain_power(j, k)) j->exponent[k] = g->exponent;
    return 1;
}

/* What all impacts share. 0: lanes cannot run this curve or mesh. */
static int prepare_job(batch_job *j) {
    const film_curve *curve = j->curve;
    int32_t n = j->mesh->loading, m = j->mesh->unloading, back = 0, powers = 0, branches = 0;
    double power[FILM_MAX_STAGES], branch[FILM_MAX_STAGES];
    j->table_count = j->row_count = 0;
    if (curve->compliance != 0.0 || curve->pull != 0.0 || j->mesh->linearisation != FILM_WORK_PRESERVING || n > ROWS || m > ROWS) return 0;
    for (int32_t k = 0; k < curve->stages; k++) {
        if (!prepare_stage(j, k)) return 0;
        if (curve->stage[k].unloading == FILM_RETRACE && k > 0) back = k;
        powers = add_exponent(j->simple[k] ? curve->piece[curve->stage[k].first].force.exponent : ANY_POWER, power, powers);
        if (j->exponent[k] == j->exponent[k]) branches = add_exponent(j->exponent[k], branch, branches);
    }
    /* of each stage's exponent: loading, graded and by cosines, and by trials (together less than n/2 + 12), and by as
     * many cosines as unloading; of each branch's: every grading and cosines; of each stage: across and back */
    int64_t rows = (int64_t)powers * (2 * (n + 1) + n / 2 + 12 + m + 1) + (int64_t)branches * (8 * m + 4) +
                   (int64_t)curve->stages * 2 * (n + 1) + (int64_t)back * (m + 1);
    return rows <= ROWS && 8 * powers + 4 * branches + 3 * curve->stages <= TABLES;
}

#if defined(FILM_WIDE)
static const block_routines *const routines[] = {&film_plain, &film_avx2, &film_avx512};
#else
static const block_routines *const routines[] = {&film_plain};
#endif

/* ---------------------------------------------------------------- blocks */

typedef struct {
    int64_t index[LANES];
    int count;
} block;

typedef struct {
    batch_job j;
    const block_routines *run;
    block fixed[FILM_MAX_PIECES], moving[FILM_MAX_PIECES]; /* by the piece in which they should turn */
    unloading_queue unloading[FILM_MAX_STAGES][3];         /* by stage and grading */
} batch;

/* Makes the own stages of a block that should turn in `piece`. */
static void make_own(batch *b, const block *waiting, int32_t piece) {
    double of[FILM_MAX_NODES][LANES];
    film_own_polynomials(&b->j, waiting->index, waiting->count, of);
    b->run->shape(&b->j, piece - b->j.curve->stage[b->j.shaped].first + 2, (const double(*)[LANES])of);
}

static void run_unloading(batch *b, int32_t stage, int32_t grading) {
    unloading_queue *q = &b->unloading[stage][grading];
    if (q->count > 0) b->run->unload(&b->j, FILM_PLATE_OUT + grading, b->j.exponent[stage], q);
}

static void run_fixed(batch *b, int32_t stage, block *waiting) {
    if (waiting->count > 0 && stage == b->j.shaped) make_own(b, waiting, (int32_t)(waiting - b->fixed));
    if (waiting->count > 0) b->run->fixed(&b->j, stage, waiting->index, waiting->count);
    waiting->count = 0;
}

/* Lane l of t, which has turned in `stage`, waits for others to unload with, or is left to film_impact. */
static void await_unloading(batch *b, int32_t stage, const turned_lanes *t, int l, int64_t i) {
    batch_job *j = &b->j;
    if (t->at.bad[l] > 0.0) {
        leave_alone(j, i);
        return;
    }
    int32_t grading = film_grading(t->slowness[l]), k = grading - FILM_PLATE_OUT;
    unloading_queue *q = &b->unloading[stage][k];
    j->summary[i].lines += film_unloading(j->mesh, grading);
    int at = q->count++;
    q->index[at] = i;
    q->gamma[at] = t->at.gamma[l];
    q->time[at] = t->at.time[l];
    q->top[at] = t->at.xi[l];
    q->force[at] = t->at.force[l];
    q->recovery[at] = t->recovery[l];
    q->exponent[at] = t->exponent[l];
    q->stored[at] = t->stored[l];
    if (q->count == LANES) run_unloading(b, stage, k);
}

static void run_moving(batch *b, int32_t stage, block *waiting) {
    batch_job *j = &b->j;
    turned_lanes t;
    int count = waiting->count, retrace = j->curve->stage[stage].unloading == FILM_RETRACE && !plain_power(j, stage);
    if (count == 0) return;
    if (stage == j->shaped) make_own(b, waiting, (int32_t)(waiting - b->moving));
    waiting->count = 0;
    b->run->load(j, stage, waiting->index, count, &t);
    for (int l = 0; l < count; l++) {
        film_summary *out = &j->summary[waiting->index[l]];
        out->maximum_indentation = t.at.xi[l];
        out->time_of_maximum_indentation = t.at.time[l];
        out->maximum_force = t.peak[l];
        out->stage = stage;
        out->lines = j->mesh->loading * (stage + 1);
        if (!retrace) await_unloading(b, stage, &t, l, waiting->index[l]);
    }
    if (retrace) b->run->retrace(j, stage, waiting->index, count, &t.at, t.stored);
}

/* The piece of *stage in which a fixed target should turn the impactor, by the march's own arithmetic; -1: none. */
static int32_t fixed_piece(const batch_job *j, int64_t i, int32_t *stage) {
    double v = j->start[i].nu;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        *stage = k;
        if (k == j->shaped) return film_own_piece(j, i, v, 0.0);
        double energy = 0.5 * v * v, left = energy - j->whole[k];
        if (left >= 0.0) {
            v = speed_after(v, j->whole[k]);
            continue;
        }
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        while (p < last && energy > j->piece_work[p]) p++;
        return p;
    }
    return -1;
}

/* The same for a target that moves, by the estimate of turn_excess. */
static int32_t moving_piece(const batch_job *j, int64_t i, int32_t *stage) {
    double stored = 0.0, nu = j->start[i].nu, gamma = j->start[i].gamma;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        int ends = j->whole[k] < INFINITY;
        *stage = k;
        if (k == j->shaped) return film_own_piece(j, i, nu, stored);
        if (!ends || turn_excess(stored + j->whole[k], j->end_force[k], nu, gamma) > 0.0) {
            while (p < last && !(turn_excess(stored + j->piece_work[p], j->piece_force[p], nu, gamma) > 0.0)) p++;
            return p;
        }
        stored += j->whole[k];
    }
    return -1;
}

/* Runs all blocks that are not full. */
static void run_rest(batch *b) {
    const film_curve *curve = b->j.curve;
    for (int32_t k = 0; k < curve->stages; k++) {
        for (int32_t p = curve->stage[k].first; p < curve->stage[k].first + curve->stage[k].count; p++) {
            run_fixed(b, k, &b->fixed[p]);
            run_moving(b, k, &b->moving[p]);
        }
        for (int32_t g = 0; g < 3; g++) run_unloading(b, k, g);
    }
}

enum { FEWEST = 3 }; /* segments of a leg on targets that move: fewer are too rough to find the turn from */

static void give(batch_job *j, const film_curve *curve, const film_mesh *mesh, const film_start *start,
                 film_summary *summary, int32_t *status) {
    j->curve = curve;
    j->mesh = mesh;
    j->start = start;
    j->summary = summary;
    j->status = status;
    j->family = NULL;
    j->shaped = -1;
}

/* Runs the impacts of b->j. */
static void run_batch(batch *b, int instructions, int64_t count) {
    batch_job *j = &b->j;
    const film_mesh *mesh = j->mesh;
    int in_lanes = prepare_job(j), moving = in_lanes && mesh->loading >= FEWEST && mesh->unloading >= FEWEST;
    b->run = routines[instructions];
    for (int32_t p = 0; p < FILM_MAX_PIECES; p++) b->fixed[p].count = b->moving[p].count = 0;
    for (int32_t k = 0; k < FILM_MAX_STAGES; k++)
        for (int32_t g = 0; g < 3; g++) b->unloading[k][g].count = 0;
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &j->start[i];
        int32_t stage = 0, piece = -1;
        if (in_lanes && s->gamma >= 0.0 && s->gamma < INFINITY && s->nu > 0.0 && s->nu < INFINITY && is_undisturbed(s)) {
            if (s->gamma == 0.0) piece = fixed_piece(j, i, &stage);
            else if (moving) piece = moving_piece(j, i, &stage);
        }
        if (piece < 0) {
            leave_alone(j, i);
            continue;
        }
        block *waiting = s->gamma == 0.0 ? &b->fixed[piece] : &b->moving[piece];
        waiting->index[waiting->count++] = i;
        if (waiting->count < LANES) continue;
        if (s->gamma == 0.0) run_fixed(b, stage, waiting);
        else run_moving(b, stage, waiting);
    }
    if (in_lanes) run_rest(b);
}

void film_batch_with(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count,
                     const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    give(&b.j, curve, mesh, start, summary, status);
    run_batch(&b, instructions, count);
}

static void run_shapes(int instructions, const film_family *family, const film_curve *whole, const film_mesh *mesh,
                       int64_t count, const film_start *start, const double *shape, film_summary *summary, int32_t *status) {
    batch b;
    own_stage own;
    give(&b.j, whole, mesh, start, summary, status);
    b.j.family = family;
    b.j.shape = shape;
    film_own_stage(&b.j, &own);
    run_batch(&b, instructions, count);
}

void film_batch_shaped(int instructions, const film_family *family, const film_curve *whole, const film_mesh *mesh,
                       int64_t count, const film_start *start, const double *shape, film_summary *summary, int32_t *status) {
    run_shapes(instructions, family, whole, mesh, count, start, shape, summary, status);
    film_impacts_left(family, whole, mesh, count, start, shape, summary, status); /* its curve needs stack too */
}

enum { WORTH_ASKING = 2000 }; /* impacts, for the microseconds that film_instructions may take */

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    int instructions = count < WORTH_ASKING ? FILM_PLAIN : film_instructions();
    film_batch_with(instructions, curve, mesh, count, start, summary, status);
}
