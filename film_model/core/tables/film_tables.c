/* What impacts of one law and mesh share: its stages, and the lines that scale with the depth. docs/method.md, section 10. */
#include "tables/film_job.h"

#include <string.h>

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
        begin = t->stage == j->touch ? 0.0 : j->curve->stage[t->stage].begin;
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
        } else {
            r->h = r->kappa = r->phi = 0.0;
        }
        f0 = f1;
        w0 = w1;
    }
}

line_table *film_lines_of(batch_job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes, double exponent) {
    for (int32_t i = 0; i < j->table_count; i++) {
        line_table *t = &j->tables[i];
        if (t->nodes == nodes && t->stage == stage && t->direction == direction && t->segments == segments &&
            (stage != UNIT_POWER || t->exponent == exponent))
            return t;
    }
    line_table *t = &j->tables[j->table_count++];
    table_row *rows = &j->rows[j->row_count];
    j->row_count += segments + 1;
    *t = (line_table){stage, direction, segments, exponent, nodes, 0.0, rows};
    make_rows(j, t, rows);
    return t;
}

/* ---------------------------------------------------------------- what all impacts share */

/* The exponent of a stage's branches where it is one number, else NAN. */
static double branch_exponent(const film_curve *curve, int32_t stage) {
    const film_piece *piece = &curve->piece[curve->stage[stage].first];
    for (int32_t p = 0; p < curve->stage[stage].count; p++) {
        const film_function *g = &piece[p].exponent;
        if (g->form != FILM_POWER || g->slope != 0.0 || g->square != 0.0 || g->coefficient != 0.0) return NAN;
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

/* Whether lanes can run a stage: a shifted branch may creep out for ever, which only the march sees. */
static int is_served(const film_curve *curve, int32_t k) {
    return curve->stage[k].unloading != FILM_SHIFTED && (curve->stage[k].end < INFINITY || force_rises(curve, k));
}

void film_prepare_stage(batch_job *j, int32_t k) {
    const film_curve *curve = j->curve;
    const film_stage *stage = &curve->stage[k];
    const film_function *g = &curve->piece[stage->first].force;
    int reversible = stage->unloading == FILM_RETRACE;
    j->simple[k] = force_rises(curve, k) && g->origin == stage->begin && g->square == 0.0;
    j->exponent[k] = reversible || stage->unloading == FILM_SIMILAR ? NAN : branch_exponent(curve, k);
    if (reversible && plain_power(j, k)) j->exponent[k] = g->exponent;
}

/* The work of a stage that has an end, and the force there. */
static void prepare_end(batch_job *j, int32_t k) {
    const film_curve *curve = j->curve;
    const film_stage *stage = &curve->stage[k];
    j->whole[k] = j->end_force[k] = INFINITY;
    if (stage->end < INFINITY) stage_law(curve, k, stage->end, &j->end_force[k], &j->whole[k]);
    if (curve->pull > 0.0 && k <= j->touch) {
        double force, before = j->whole[k];
        if (k == j->touch) stage_law(curve, k, 0.0, &force, &before);
        j->parting += before;
        j->whole[k] -= before;
    }
}

/* Whether the contacts of a mesh are marched along its lines. */
static int needs_lines(const film_mesh *mesh) { return mesh->linearisation != FILM_WORK_PRESERVING || mesh->ways != FILM_ANY_WAY; }

int film_is_quick(const film_curve *curve, const film_mesh *mesh) {
    if (curve->compliance != 0.0 || needs_lines(mesh)) return 0;
    for (int32_t k = 0; k < curve->stages; k++)
        if (!is_served(curve, k)) return 0;
    return 1;
}

int film_prepare_job(batch_job *j) {
    const film_curve *curve = j->curve;
    int32_t n = j->mesh->loading, m = j->mesh->unloading, powers = 0, branches = 0;
    double power[FILM_MAX_STAGES], branch[FILM_MAX_STAGES];
    j->table_count = j->row_count = j->touch = 0;
    j->parting = 0.0;
    while (j->touch < curve->stages - 1 && !(curve->stage[j->touch].end > 0.0)) j->touch++;
    if (!film_is_quick(curve, j->mesh) || n > ROWS || m > ROWS) return 0;
    for (int32_t k = 0; k < curve->stages; k++) {
        film_prepare_stage(j, k);
        prepare_end(j, k);
        powers = add_exponent(j->simple[k] ? curve->piece[curve->stage[k].first].force.exponent : ANY_POWER, power, powers);
        if (j->exponent[k] == j->exponent[k]) branches = add_exponent(j->exponent[k], branch, branches);
    }
    /* of each stage's exponent: loading, and by trials (together less than n/2 + 12); of each branch's: every grading; of each
     * stage: across */
    int64_t rows = (int64_t)powers * (n + 1 + n / 2 + 12) + (int64_t)branches * (7 * m + 3) + (int64_t)curve->stages * (n + 1);
    return rows <= ROWS && 8 * powers + 3 * branches + curve->stages <= TABLES;
}

/* exponent times root, if that is a whole number up to MOST_POWER; else -1. */
static int32_t whole_multiple(double exponent, int32_t root) {
    double times = exponent * root;
    return times >= 0.0 && times <= MOST_POWER && times == (double)(int32_t)times ? (int32_t)times : -1;
}

/* The factor of a function that is one power from 0 on, or one and *more >= 0 times x^highest, which is higher, and its
 * exponent; 0 if it is neither. */
static double leading_power(const film_function *g, int highest, double *exponent, double *more) {
    double slope = g->slope, square = g->square, *above = highest == 1 ? &slope : &square;
    if (g->form != FILM_POWER || g->origin != 0.0 || g->per_span != 1.0) return 0.0;
    *more = 0.0;
    if (g->coefficient != 0.0 && g->exponent < highest) {
        *more = *above / g->coefficient;
        *above = 0.0;
    }
    int parts = (g->constant != 0.0) + (slope != 0.0) + (square != 0.0) + (g->coefficient != 0.0);
    *exponent = g->coefficient != 0.0 ? g->exponent : square != 0.0 ? 2.0 : slope != 0.0 ? 1.0 : 0.0;
    return parts == 1 && *more >= 0.0 ? g->constant + slope + square + g->coefficient : 0.0;
}

void film_prepare_damped(batch_job *j) {
    const film_curve *curve = j->curve;
    const film_piece *piece = curve->piece;
    damped_form *form = &j->damped;
    double force = 0.0, damping = 0.0;
    memset(form, 0, sizeof *form);
    if (curve->stages != 1 || !curve->stage[0].damped || curve->stage[0].count != 1 || curve->stage[0].begin != 0.0 ||
        curve->stage[0].end < INFINITY || curve->compliance != 0.0 || needs_lines(j->mesh) ||
        j->mesh->loading < 1)
        return;
    form->stiffness = leading_power(&piece->force, 2, &force, &form->steeper);
    form->factor = leading_power(&piece->damping, 1, &damping, &form->faster);
    form->more = form->steeper + form->faster > 0.0;
    if (!(form->stiffness > 0.0 && form->factor > 0.0 && force >= 1.0)) return;
    for (int32_t root = 1; root <= 4 && form->root == 0; root *= 2) {
        form->force = whole_multiple(force, root);
        form->damping = whole_multiple(damping, root);
        if (form->force >= form->damping + form->more && form->damping >= 0) form->root = root;
    }
    if (form->root == 0) return;
    form->used[form->force] = form->used[form->damping] = form->used[form->root - 1] = 1;
    if (form->more) form->used[form->root] = form->used[2 * form->root] = 1;
    for (int e = MOST_POWER; e > 1; e--)
        if (form->used[e]) form->used[e / 2] = form->used[e - e / 2] = 1;
}
