/* Impacts by the thousand: what film_impact gives, by shorter ways where there are any.
 *
 * On a fixed target without a load, energy gives the velocity at every node and tan(omega tau/2) = omega h/(v0 + v1)
 * the time between two, so a summary needs neither events nor states. Everything else takes the march's own steps. */
#include "film_batch.h"

#include "film_line.h"

#include <string.h>

/* Time from one node to the next over the whole run, from `from`, where the velocity is v, to `to`. The first line of a
 * run from rest and the last one of a run that turns meet the law's force there. */
static double cross(const film_curve *curve, const film_line *run, double from, double to, double v, int turns,
                    int32_t segments, const double *nodes, double *peak) {
    double f0, w0, f1, w1, x0 = from, v0 = v, time = 0.0;
    law_at(curve, run, from, &f0, &w0);
    double total = v * v + 2.0 * w0;
    for (int32_t i = 1; i <= segments; i++) {
        double x1 = i < segments ? from + (to - from) * nodes[i] : to, h = x1 - x0;
        law_at(curve, run, x1, &f1, &w1);
        double square = total - 2.0 * w1, per_h = 1.0 / h, mean = (w1 - w0) * per_h, kappa = (f1 - f0) * per_h;
        double v1 = square > 0.0 && !(turns && i == segments) ? sqrt(square) : 0.0;
        if (turns && i == segments) kappa = 2.0 * (f1 - mean) * per_h;
        else if (i == 1 && v == 0.0) kappa = 2.0 * (mean - f0) * per_h;
        double r = fabs(h) / (v0 + v1);
        time += 2.0 * r * arc(kappa * r * r);
        if (f1 > *peak) *peak = f1;
        x0 = x1;
        f0 = f1;
        w0 = w1;
        v0 = v1;
    }
    return time;
}

static double speed_at(double v, double work_done) {
    double square = v * v - 2.0 * work_done;
    return square > 0.0 ? sqrt(square) : 0.0;
}

static int fixed_target(const film_curve *curve, const film_mesh *mesh, double nu, film_summary *summary) {
    film_line run;
    memset(&run, 0, sizeof run);
    double v = nu, xi = 0.0, time = 0.0, to = 0.0, force, work, peak = 0.0, stored = 0.0;
    int status = FILM_OK;
    const double *in = mesh->loading_nodes[FILM_COSINE], *out = mesh->unloading_nodes[FILM_COSINE];
    for (;; run.branch++) {
        if (run.branch >= curve->stages) return FILM_BEYOND_LAW;
        double end = curve->stage[run.branch].end;
        status = film_turning_point(curve, &run, xi, 0.0, v, 0.0, end, &to);
        if (status < 0) return status;
        law_at(curve, &run, to, &force, &work);
        if (status == FILM_EVENT && to - xi <= SHORT_LEG * to) { /* the way is rounding; the velocity is not */
            time += force > 0.0 ? v / force : 0.0;
            if (force > peak) peak = force;
        } else {
            time += cross(curve, &run, xi, to, v, status == FILM_EVENT, mesh->loading, in, &peak);
        }
        summary->lines += mesh->loading;
        stored += work;
        xi = to;
        if (status == FILM_EVENT) break;
        v = speed_at(v, work);
    }
    summary->maximum_force = peak;
    summary->maximum_indentation = xi - curve->compliance * force;
    summary->time_of_maximum_indentation = summary->time_impactor_stops = time;
    summary->stage = run.branch;
    double given_back = stored;
    status = open_branch(curve, &run, xi, force);
    if (status < 0) return status;
    if (run.branch == FILM_BRANCH) {
        law_at(curve, &run, xi, &force, &given_back);
        time += cross(curve, &run, xi, run.xi_free, 0.0, 0, mesh->unloading, out, &peak);
        summary->lines += mesh->unloading;
    } else {
        for (v = 0.0; run.branch >= 0; run.branch--) {
            to = curve->stage[run.branch].begin;
            law_at(curve, &run, xi, &force, &work);
            time += cross(curve, &run, xi, to, v, 0, mesh->unloading, out, &peak);
            summary->lines += mesh->unloading;
            v = speed_at(v, -work);
            xi = to;
        }
    }
    summary->contact_duration = time;
    summary->permanent_indentation = run.branch == FILM_BRANCH ? run.xi_free : 0.0;
    summary->final_velocity = -sqrt(2.0 * given_back);
    summary->work = stored - given_back;
    return FILM_EVENT;
}

static int undisturbed(const film_start *start) {
    return start->load == 0.0 && start->stop_velocity == 0.0 && start->time_limit == INFINITY && start->damping == 0.0;
}

static void nothing_yet(film_summary *summary) {
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = NAN;
    summary->final_velocity = NAN;
}

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    film_state s;
    nothing_yet(summary);
    if (!(start->nu > 0.0 || (start->nu == 0.0 && start->load > 0.0)) || start->nu == INFINITY) return FILM_BAD_NUMBER;
    if (start->gamma == 0.0 && undisturbed(start) && mesh->linearisation == FILM_WORK_PRESERVING) {
        int status = fixed_target(curve, mesh, start->nu, summary);
        if (status < 0 || summary->contact_duration < INFINITY) return status;
        nothing_yet(summary); /* energies lost in the rounding of the law's work: the march knows more */
    }
    int status = film_init(curve, &s, 0.0, start->nu, start->gamma, start->load, start->stop_velocity);
    if (status >= 0) status = film_damp(&s, start->damping);
    for (int32_t events = 0; status >= 0; events++) {
        status = film_step(curve, mesh, &s, start->time_limit - s.time);
        if (status != FILM_EVENT || s.event == FILM_CONTACT_ENDS) break;
        if (events >= FILM_MAX_EVENTS || s.lines > FILM_MAX_STEP_LINES) return FILM_TOO_MANY;
        double indentation = s.xi - curve->compliance * s.force;
        if (s.event == FILM_MAXIMUM_INDENTATION && indentation > summary->maximum_indentation) {
            summary->maximum_indentation = indentation;
            summary->time_of_maximum_indentation = s.time;
            summary->stage = s.stage_max;
        } else if (s.event == FILM_IMPACTOR_STOPS && isnan(summary->time_impactor_stops)) {
            summary->time_impactor_stops = s.time;
        }
    }
    if (status < 0) return status;
    summary->maximum_force = fmax(s.force_peak, s.force); /* that of the end, where the time is up on the way in */
    summary->shift = s.shift;
    summary->work = s.spent;
    summary->lines = s.lines;
    if (status == FILM_EVENT) {
        summary->contact_duration = s.time;
        summary->permanent_indentation = s.xi;
        summary->final_velocity = s.nu;
    }
    return status;
}

/* ---------------------------------------------------------------- tables
 * On a stage that is one power from its beginning on, and on an unloading branch, nodes are the same fractions at every
 * depth, and the lines between them scale; across a whole stage they are the same for every impact. Both are drawn once
 * a batch. */

static void power_at(double exponent, double x, double *force, double *work) {
    *force = raised(x, exponent);
    *work = *force * x * work_of(exponent);
}

static void draw_rows(const job *j, table *t, row *rows) {
    double begin = 0.0, end = 1.0, f0, w0;
    int unit = t->stage == UNIT_POWER;
    if (!unit) {
        begin = j->curve->stage[t->stage].begin;
        end = j->curve->stage[t->stage].end;
    }
    for (int32_t i = 0; i <= t->segments; i++) {
        double s = (double)i / t->segments, f1, w1;
        s = t->nodes != NULL ? t->nodes[i] : s * s * (3.0 - 2.0 * s);
        row *r = &rows[i];
        r->x = t->direction > 0 ? begin + (end - begin) * s : end + (begin - end) * s;
        if (i == t->segments) r->x = t->direction > 0 ? end : begin;
        if (unit) power_at(t->exponent, r->x, &f1, &w1);
        else stage_law(j->curve, t->stage, r->x, &f1, &w1);
        r->force = f1;
        r->work = unit ? 2.0 * (work_of(t->exponent) - w1) : 2.0 * w1;
        if (i > 0) {
            double h = r->x - rows[i - 1].x, mean = (w1 - w0) / h, kappa = (f1 - f0) / h;
            if (unit && t->direction > 0 && i == t->segments) kappa = 2.0 * (f1 - mean) / h; /* true there */
            if (unit && t->direction < 0 && i == 1) kappa = 2.0 * (mean - f0) / h;
            r->h = fabs(h);
            r->kappa = kappa;
            r->phi = mean - 0.5 * kappa * h;
            if (f1 > t->peak) t->peak = f1;
            double per = r->h / (sqrt(rows[i - 1].work) + sqrt(r->work));
            if (unit) t->rest += 2.0 * per * arc(kappa * per * per);
        } else {
            r->h = r->kappa = r->phi = 0.0;
        }
        f0 = f1;
        w0 = w1;
    }
}

/* There is room for every table a batch can ask for: see batch_begins. */
const table *film_lines_of(job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes,
                           double exponent) {
    for (int32_t i = 0; i < j->table_count; i++) {
        const table *t = &j->tables[i];
        if (t->nodes == nodes && t->stage == stage && t->direction == direction && t->segments == segments &&
            (stage != UNIT_POWER || t->exponent == exponent))
            return t;
    }
    table *t = &j->tables[j->table_count++];
    row *rows = &j->rows[j->row_count];
    j->row_count += segments + 1;
    t->stage = stage;
    t->direction = direction;
    t->segments = segments;
    t->exponent = exponent;
    t->nodes = nodes;
    t->peak = t->rest = 0.0;
    t->rows = rows;
    draw_rows(j, t, rows);
    return t;
}

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

static int32_t with(double exponent, double *known, int32_t count) {
    for (int32_t i = 0; i < count; i++)
        if (known[i] == exponent) return count;
    known[count] = exponent;
    return count + 1;
}

/* What all impacts share. 0: this curve or mesh is not for lanes. */
static int batch_begins(job *j) {
    const film_curve *curve = j->curve;
    const film_mesh *mesh = j->mesh;
    int32_t n = mesh->loading, m = mesh->unloading, back = 0, powers = 0, branches = 0;
    double power[FILM_MAX_STAGES], branch[FILM_MAX_STAGES];
    j->table_count = j->row_count = 0;
    if (mesh->linearisation != FILM_WORK_PRESERVING || n > ROWS || m > ROWS) return 0;
    for (int32_t k = 0; k < curve->stages; k++) {
        const film_stage *stage = &curve->stage[k];
        const film_function *g = &curve->piece[stage->first].force;
        int rising = rises(curve, k), reversible = stage->unloading == FILM_RETRACE;
        if (!reversible && stage->unloading == FILM_SHIFTED) return 0; /* it may creep out for ever: the march sees that */
        j->simple[k] = rising && g->origin == stage->begin;
        j->exponent[k] = reversible ? NAN : branch_exponent(curve, k);
        j->whole[k] = j->end_force[k] = INFINITY;
        if (stage->end < INFINITY) stage_law(curve, k, stage->end, &j->end_force[k], &j->whole[k]);
        else if (!rising) return 0;
        for (int32_t p = stage->first; p < stage->first + stage->count; p++) {
            j->piece_work[p] = j->piece_force[p] = INFINITY;
            if (curve->piece[p].end < INFINITY)
                stage_law(curve, k, curve->piece[p].end, &j->piece_force[p], &j->piece_work[p]);
        }
        if (reversible && k > 0) back = k;
        if (reversible && plain_power(j, k)) j->exponent[k] = g->exponent;
        powers = with(j->simple[k] ? g->exponent : ANY_POWER, power, powers);
        if (j->exponent[k] == j->exponent[k]) branches = with(j->exponent[k], branch, branches);
    }
    /* of each stage's exponent: loading, graded and by cosines, and by trials (together less than n/2 + 12), and by as
     * many cosines as unloading; of each branch's: every grading and cosines; of each stage: across and back */
    int64_t rows = (int64_t)powers * (2 * (n + 1) + n / 2 + 12 + m + 1) + (int64_t)branches * (8 * m + 4) +
                   (int64_t)curve->stages * 2 * (n + 1) + (int64_t)back * (m + 1);
    return rows <= ROWS && 8 * powers + 4 * branches + 3 * curve->stages <= TABLES;
}

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

static const routines *const sets[] = {&film_plain, &film_avx2, &film_avx512};
#else
int film_instructions(void) { return FILM_PLAIN; }
static const routines *const sets[] = {&film_plain};
#endif

/* ---------------------------------------------------------------- blocks */

typedef struct {
    int64_t index[LANES];
    int count;
} block;

typedef struct {
    job j;
    const routines *run;
    block fixed[FILM_MAX_PIECES], moving[FILM_MAX_PIECES]; /* by the piece in which they should turn */
    leaving leaving[FILM_MAX_STAGES][3];
} batch;

static void flush_leaving(batch *b, int32_t stage, int32_t k) {
    leaving *q = &b->leaving[stage][k];
    if (q->count > 0) b->run->out(&b->j, FILM_PLATE_OUT + k, b->j.exponent[stage], q);
}

static void flush_fixed(batch *b, int32_t stage, block *waiting) {
    if (waiting->count > 0) b->run->fixed(&b->j, stage, waiting->index, waiting->count);
    waiting->count = 0;
}

static void flush_moving(batch *b, int32_t stage, block *waiting) {
    job *j = &b->j;
    deepest t;
    int count = waiting->count, back = j->curve->stage[stage].unloading == FILM_RETRACE && !plain_power(j, stage);
    int32_t in = j->mesh->loading * (stage + 1);
    if (count == 0) return;
    waiting->count = 0;
    b->run->in(j, stage, waiting->index, count, &t);
    for (int l = 0; l < count; l++) {
        int64_t i = waiting->index[l];
        film_summary *out = &j->summary[i];
        out->maximum_indentation = t.at.xi[l];
        out->time_of_maximum_indentation = t.at.time[l];
        out->maximum_force = t.peak[l];
        out->stage = stage;
        out->lines = in;
        if (back) continue;
        if (t.at.bad[l] > 0.0) {
            j->status[i] = film_impact(j->curve, j->mesh, &j->start[i], out);
            continue;
        }
        int32_t grading = film_grading(t.slowness[l]), k = grading - FILM_PLATE_OUT;
        leaving *q = &b->leaving[stage][k];
        out->lines = in + film_unloading(j->mesh, grading);
        int at = q->count++;
        q->index[at] = i;
        q->gamma[at] = t.at.gamma[l];
        q->time[at] = t.at.time[l];
        q->top[at] = t.at.xi[l];
        q->force[at] = t.at.force[l];
        q->recovery[at] = t.recovery[l];
        q->exponent[at] = t.exponent[l];
        q->stored[at] = t.stored[l];
        if (q->count == LANES) flush_leaving(b, stage, k);
    }
    if (back) b->run->back(j, stage, waiting->index, count, &t.at, t.stored);
}

/* The piece of the stage in which a fixed target should turn the impactor, by the march's own arithmetic; -1: none. */
static int32_t fixed_piece(const job *j, double v, int32_t *stage) {
    for (int32_t k = 0; k < j->curve->stages; k++) {
        double energy = 0.5 * v * v, left = energy - j->whole[k];
        if (left >= 0.0) {
            v = speed_at(v, j->whole[k]);
            continue;
        }
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        while (p < last && energy > j->piece_work[p]) p++;
        *stage = k;
        return p;
    }
    return -1;
}

/* The same for a target that gives way, about. */
static int32_t moving_piece(const job *j, double nu, double gamma, int32_t *stage) {
    double stored = 0.0;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        int32_t p = j->curve->stage[k].first, last = p + j->curve->stage[k].count - 1;
        int ends = j->whole[k] < INFINITY;
        if (!ends || spent_less_energy(stored + j->whole[k], j->end_force[k], nu, gamma) > 0.0) {
            while (p < last && !(spent_less_energy(stored + j->piece_work[p], j->piece_force[p], nu, gamma) > 0.0)) p++;
            *stage = k;
            return p;
        }
        stored += j->whole[k];
    }
    return -1;
}

enum { FEWEST = 3 }; /* segments of a leg on targets that give way: fewer are too rough to find the turn from */

void film_batch_with(int instructions, const film_curve *curve, const film_mesh *mesh, int64_t count,
                     const film_start *start, film_summary *summary, int32_t *status) {
    batch b;
    job *j = &b.j;
    j->curve = curve;
    j->mesh = mesh;
    j->start = start;
    j->summary = summary;
    j->status = status;
    int lined = curve->compliance == 0.0 && batch_begins(j);
    int moving = lined && mesh->loading >= FEWEST && mesh->unloading >= FEWEST;
    b.run = sets[instructions];
    for (int32_t p = 0; p < FILM_MAX_PIECES; p++) b.fixed[p].count = b.moving[p].count = 0;
    for (int32_t k = 0; k < FILM_MAX_STAGES; k++)
        for (int32_t g = 0; g < 3; g++) b.leaving[k][g].count = 0;
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &start[i];
        int32_t stage = 0, piece = -1;
        if (lined && s->gamma >= 0.0 && s->gamma < INFINITY && s->nu > 0.0 && s->nu < INFINITY && undisturbed(s))
            piece = s->gamma == 0.0 ? fixed_piece(j, s->nu, &stage)
                    : moving        ? moving_piece(j, s->nu, s->gamma, &stage)
                                    : -1;
        if (piece < 0) {
            status[i] = film_impact(curve, mesh, s, &summary[i]);
            continue;
        }
        block *waiting = s->gamma == 0.0 ? &b.fixed[piece] : &b.moving[piece];
        waiting->index[waiting->count++] = i;
        if (waiting->count < LANES) continue;
        if (s->gamma == 0.0) flush_fixed(&b, stage, waiting);
        else flush_moving(&b, stage, waiting);
    }
    for (int32_t k = 0; lined && k < curve->stages; k++) {
        for (int32_t p = curve->stage[k].first; p < curve->stage[k].first + curve->stage[k].count; p++) {
            flush_fixed(&b, k, &b.fixed[p]);
            flush_moving(&b, k, &b.moving[p]);
        }
        for (int32_t g = 0; g < 3; g++) flush_leaving(&b, k, g);
    }
}

enum { WORTH_ASKING = 2000 }; /* impacts, for the microseconds that film_instructions may take */

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    int instructions = count < WORTH_ASKING ? FILM_PLAIN : film_instructions();
    film_batch_with(instructions, curve, mesh, count, start, summary, status);
}
