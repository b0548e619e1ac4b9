/* What a contact does after a turn: the branch it takes, and the loops of a law that reloads along another curve.
 * docs/method.md, section 6. */
#include "march/film_march.h"

/* A law that reloads along another curve stays on its branch if the way back from the turn is shorter than this fraction of
 * the recovery: over such a way the two curves differ by rounding. core_check.c, check_small_loop. */
static const double SMALL_LOOP = 1e-6;

/* The contact turns on the loading curve: keep the deepest point, and take the branch that leads back from it.
 * docs/method.md, section 6. */
int film_remember_turn(const film_curve *curve, film_state *s) {
    film_line *line = &s->line;
    double force;
    s->xi_max = s->xi;
    s->f_max = s->elastic;
    s->stage_max = line->branch = s->branch;
    int status = film_open_branch(curve, line, s->xi, s->elastic);
    if (status < 0 || line->branch == s->branch) return status;
    s->branch = line->branch;
    s->loop = LOOP_NONE;
    s->xi_free = line->xi_free;
    s->recovery = s->xi - curve->compliance * s->elastic - s->xi_free;
    s->exponent = line->exponent;
    s->xi_origin = line->xi_origin;
    s->f_scale = line->f_max;
    law_at(curve, line, s->xi, &force, &s->work);
    return FILM_OK;
}

/* The rounding of the force where `stage` begins: KINK_ROUNDING of the largest number it is computed from. */
double film_force_rounding(const film_curve *curve, const film_state *s, int32_t stage) {
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    return KINK_ROUNDING * fmax(s->force_peak, fmax(fabs(g->constant), fabs(g->series[0])));
}

/* Where a contact begins: on the loading curve of a spot without a dent, else on the branch that leads back to its deepest
 * point; of the stages of a law that pulls, on the one that goes on from there. docs/method.md, section 6. */
int32_t film_branch_at_touch(const film_curve *curve, const film_state *s) {
    film_state at = *s;
    int unloading = s->stage_max >= 0 ? curve->stage[s->stage_max].unloading : FILM_RETRACE;
    at.branch = unloading == FILM_RETRACE ? 0 : unloading == FILM_SIMILAR ? FILM_STRETCHED : FILM_BRANCH;
    while (curve->pull > 0.0 && !(run_edge(curve, &at, 1) > s->xi)) at.branch += at.branch < 0 ? -1 : 1;
    return at.branch;
}

/* ---------------------------------------------------------------- reloading loops */

double film_reload_exponent(const film_curve *curve, const film_state *s) {
    return s->stage_max >= 0 ? curve->stage[s->stage_max].reload_exponent : 0.0;
}

/* A branch from (a, f_a) to (b, f_b), both on the march's axis: the part of ((xi - origin)/span)^q between them, scaled and
 * shifted in force. docs/method.md, section 6. */
static void stretch_branch(const film_curve *curve, film_line *line, double origin, double span, double q, double a, double f_a,
                           double b, double f_b) {
    a -= curve->compliance * f_a;
    b -= curve->compliance * f_b;
    double low = power_of(fmax((a - origin) / span, 0.0), q); /* rounding may put the end of a contact before its origin */
    line->xi_origin = origin;
    line->per_recovery = 1.0 / span;
    line->exponent = q;
    line->f_max = (f_b - f_a) / (power_of((b - origin) / span, q) - low);
    line->f_shift = f_a - line->f_max * low;
    line->work_free = 0.0;
}

/* Writes into the line what all lines of a run share: load, target, and the branch. docs/method.md, section 6. */
void film_open_run(const film_curve *curve, film_state *s) {
    film_line *line = &s->line;
    line->load = s->load;
    line->gamma = s->gamma;
    line->branch = s->branch;
    line->phase = s->phase;
    line->damper = is_damped(curve, s) ? s->damper : 0.0;
    line->xi_free = s->xi_free;
    double span = s->xi_max - curve->compliance * s->f_max - s->xi_origin;
    if (s->branch == FILM_BRANCH && s->loop == LOOP_RELOAD) {
        stretch_branch(curve, line, s->xi_free, s->recovery, film_reload_exponent(curve, s), s->xi_in, s->f_in, s->xi_max, s->f_max);
    } else if (s->branch == FILM_BRANCH && s->loop == LOOP_INNER) {
        stretch_branch(curve, line, s->xi_origin, span, s->exponent, s->xi_in, s->f_in, s->xi_out, s->f_out);
    } else {
        line->xi_origin = s->xi_origin;
        line->per_recovery = s->recovery > 0.0 ? 1.0 / span : 0.0;
        line->exponent = s->exponent;
        line->f_max = s->f_scale;
        line->f_shift = s->f_scale > 0.0 ? s->f_max - s->f_scale : 0.0;
        line->work_free = (s->xi_free - s->xi_origin) * line->f_shift * (1.0 - work_factor(s->exponent));
    }
    if (s->branch <= FILM_STRETCHED) {
        line->per_recovery = 1.0 / s->exponent;
        line->f_shift = line->work_free = 0.0;
    }
}

/* Go on from the current point along another branch, on which the force is the same. */
void film_change_loop(const film_curve *curve, film_state *s, int32_t loop) {
    s->loop = loop;
    film_open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
}

/* A law with a reload exponent leaves the branch it has turned on. docs/method.md, section 6. */
void film_choose_loop(const film_curve *curve, film_state *s) {
    if (s->branch != FILM_BRANCH || film_reload_exponent(curve, s) == 0.0) return;
    if (s->direction > 0 && s->loop == LOOP_NONE && s->xi_max - s->xi > SMALL_LOOP * s->recovery) {
        s->xi_in = s->xi;
        s->f_in = s->elastic;
        film_change_loop(curve, s, LOOP_RELOAD);
    } else if (s->direction < 0 && s->loop == LOOP_RELOAD && s->xi - s->xi_in > SMALL_LOOP * s->recovery) {
        s->xi_out = s->xi;
        s->f_out = s->elastic;
        film_change_loop(curve, s, LOOP_INNER);
    }
}
