/* Blocks of impacts on targets that move, from the turn to the end of contact. Internal to film_lanes.c.
 * docs/method.md, section 10. */
#ifndef FILM_LANE_UNLOAD_H
#define FILM_LANE_UNLOAD_H

#include "lanes/film_lane_line.h"

/* Below this fraction of the way that is left, a mean force, a difference of works, is rounding, and the cubic's guess is as
 * good. Affects accuracy only, by less than the lines' error. */
static const double SHORT_WAY_OUT = 1e-4;

/* ---------------------------------------------------------------- when the impactors stop */

/* The line on which each lane's impactor stops: where it begins, and the law's force at both its ends. moving: 1 until it
 * has stopped. */
typedef struct {
    double time[LANES], tau[LANES], w0[LANES], w1[LANES], f0[LANES], f1[LANES];
    double phi[LANES], kappa[LANES], xi[LANES], stage[LANES], from_rest[LANES], moving[LANES];
    const stretch *by; /* NULL: the way back is along the law itself */
} stops;

static void clear_stops(stops *restrict stop) {
    memset(stop, 0, sizeof *stop);
    EACH(l) stop->moving[l] = 1.0;
}

/* Keeps the line just passed, which began at `from` under f0 with w0, for the lanes that stopped on it. */
static void keep_stops(stops *restrict stop, const lanes *restrict s, const lines *restrict n,
                       const double *restrict w0, const double *restrict f0, const double *restrict f1,
                       const double *restrict from, int32_t stage, int from_rest) {
    double here[LANES], rest = from_rest ? 1.0 : 0.0;
    EACH(l) here[l] = s->w[l] > 0.0 ? 0.0 : stop->moving[l];
    if (!any(here)) return;
    EACH(l) {
        stop->time[l] = here[l] > 0.0 ? s->time[l] - n->tau[l] : stop->time[l];
        stop->tau[l] = here[l] > 0.0 ? n->tau[l] : stop->tau[l];
        stop->w0[l] = here[l] > 0.0 ? w0[l] : stop->w0[l];
        stop->w1[l] = here[l] > 0.0 ? s->w[l] : stop->w1[l];
        stop->f0[l] = here[l] > 0.0 ? f0[l] : stop->f0[l];
        stop->f1[l] = here[l] > 0.0 ? f1[l] : stop->f1[l];
        stop->phi[l] = here[l] > 0.0 ? n->phi[l] : stop->phi[l];
        stop->kappa[l] = here[l] > 0.0 ? n->kappa[l] : stop->kappa[l];
        stop->xi[l] = here[l] > 0.0 ? from[l] : stop->xi[l];
        stop->stage[l] = here[l] > 0.0 ? (double)stage : stop->stage[l];
        stop->from_rest[l] = here[l] > 0.0 ? rest : stop->from_rest[l];
        stop->moving[l] = here[l] > 0.0 ? 0.0 : stop->moving[l];
    }
}

/* The law where the lines of the stops begin and at x1, either along the branches, whose exponent is `same` or, NAN,
 * each lane's own, or, without branches, along each lane's stage. */
static void law_of_stops(const batch_job *j, const stops *restrict n, const unloading_queue *branch, double same,
                         const double *restrict x1, double *restrict w0, double *restrict f1, double *restrict w1) {
    if (branch != NULL) {
        double u[LANES];
        EACH(l) u[l] = x1[l] / branch->recovery[l];
        if (same == same) power_lanes_of(u, same, f1);
        else power_lanes(u, branch->exponent, f1);
        EACH(l) {
            double per = 1.0 / (branch->exponent[l] + 1.0);
            f1[l] *= branch->force[l];
            w1[l] = f1[l] * x1[l] * per;
            w0[l] = n->f0[l] * n->xi[l] * per;
        }
        return;
    }
    EACH(l) w0[l] = f1[l] = w1[l] = 0.0;
    for (int32_t k = 0; k < j->curve->stages; k++) {
        double here[LANES], f[LANES], before[LANES], after[LANES];
        EACH(l) here[l] = n->stage[l] == (double)k ? 1.0 : 0.0;
        if (!any(here)) continue;
        back_law_lanes(j, k, n->by, n->xi, f, before);
        EACH(l) w0[l] = here[l] > 0.0 ? before[l] : w0[l];
        back_law_lanes(j, k, n->by, x1, f, after);
        EACH(l) {
            f1[l] = here[l] > 0.0 ? f[l] : f1[l];
            w1[l] = here[l] > 0.0 ? after[l] : w1[l];
        }
    }
}

/* Along lines outwards that begin at w0 under phi: ways and velocities after tau, and 1 where the polynomial errs. */
INLINED void along_lines(const double *restrict gamma, const double *restrict load, const double *restrict w0, const double *restrict phi,
                         const double *restrict kappa, const double *restrict from_rest, const double *restrict tau,
                         double *restrict x, double *restrict y, double *restrict unfit) {
    double y0[LANES], d1[LANES], a2[LANES];
    EACH(l) {
        a2[l] = gamma[l] * kappa[l];
        y0[l] = from_rest[l] > 0.0 ? 0.0 : gamma[l] * phi[l] - w0[l];
        d1[l] = (phi[l] - load[l]) - a2[l] * y0[l];
    }
    polynomials(y0, d1, a2, kappa, tau, x, y, unfit);
}

/* About when each impactor stops within its line: the cubic through both velocities w0 > 0 and w1 <= 0 and both accelerations, p - f. */
static void guess_stops(const stops *restrict n, const double *restrict load, double *restrict tau) {
    EACH(l) {
        double w0 = n->w0[l], d0 = (load[l] - n->f0[l]) * n->tau[l], d1 = (load[l] - n->f1[l]) * n->tau[l], r = w0 / (w0 - n->w1[l]);
        double c2 = 3.0 * (n->w1[l] - w0) - 2.0 * d0 - d1, c3 = 2.0 * (w0 - n->w1[l]) + d0 + d1;
        for (int i = 0; i < 3; i++) {
            r -= (w0 + r * (d0 + r * (c2 + r * c3))) / (d0 + r * (2.0 * c2 + 3.0 * r * c3));
            r = r > 0.0 ? r : 0.0; /* a line too long for its cubic */
            r = r < 1.0 ? r : 1.0;
        }
        tau[l] = r * n->tau[l];
    }
}

/* When the impactors stop, NAN where one does not. The line is made again to where the cubic says, as film_end_at_stop does,
 * and Newton's method finds the time on it; lanes whose line is too long for that are bad. docs/method.md, section 10. */
static void stop_times(const batch_job *j, const stops *restrict n, lanes *restrict s, const unloading_queue *branch, double same,
                       double *restrict time) {
    double tau[LANES], near[LANES], x[LANES], y[LANES], unfit[LANES], x1[LANES], before[LANES], f1[LANES], w1[LANES];
    double phi[LANES], kappa[LANES], far[LANES];
    guess_stops(n, s->load, near);
    along_lines(s->gamma, s->load, n->w0, n->phi, n->kappa, n->from_rest, near, x, y, unfit);
    EACH(l) {
        tau[l] = near[l];
        far[l] = x[l] > SHORT_WAY_OUT * n->xi[l] ? 1.0 : 0.0; /* the cubic is good enough nearer than that */
        far[l] = x[l] < n->xi[l] ? far[l] : 0.0;
        x1[l] = far[l] > 0.0 ? n->xi[l] - x[l] : n->xi[l];
    }
    law_of_stops(j, n, branch, same, x1, before, f1, w1);
    EACH(l) {
        double per = 1.0 / x[l], mean = (before[l] - w1[l]) * per;
        kappa[l] = n->from_rest[l] > 0.0 ? 2.0 * (n->f0[l] - mean) * per : (n->f0[l] - f1[l]) * per;
        phi[l] = n->from_rest[l] > 0.0 ? n->f0[l] : mean + 0.5 * kappa[l] * x[l];
    }
    for (int i = 0; i < 2; i++) {
        double over[LANES];
        along_lines(s->gamma, s->load, n->w0, phi, kappa, n->from_rest, tau, x, y, over);
        EACH(l) {
            double force = phi[l] - kappa[l] * x[l], next = tau[l] + (s->gamma[l] * force - y[l]) / (force - s->load[l]);
            far[l] = fabs(next - near[l]) <= 0.1 * n->tau[l] ? far[l] : 0.0;
            tau[l] = next;
            unfit[l] += far[l] > 0.0 ? over[l] : 0.0;
        }
    }
    EACH(l) {
        double stopped = n->time[l] + (far[l] > 0.0 ? tau[l] : near[l]), here = n->moving[l] > 0.0 ? 0.0 : 1.0;
        here = n->w0[l] > 0.0 ? here : 0.0;
        time[l] = here > 0.0 ? stopped : NAN;
        s->bad[l] += here > 0.0 ? unfit[l] : s->load[l] > 0.0 ? 1.0 : 0.0; /* under a load it may stop within a line and go on */
    }
}

/* The summary of one lane, or film_marched's where the lane is bad. */
static void report_lane(batch_job *j, const lanes *s, double stopped, int l, int64_t index, double left, double stored,
                       double given) {
    film_summary *out = &j->summary[index];
    const film_start *start = &j->start[index];
    out->time_impactor_stops = s->gamma[l] > 0.0 ? stopped : out->time_of_maximum_indentation;
    out->contact_duration = s->time[l];
    out->permanent_indentation = left;
    out->final_velocity = s->w[l];
    out->shift = s->gamma[l] * (start->nu - s->w[l] + start->load * s->time[l]);
    out->work = stored - given;
    int whole = s->bad[l] == 0.0 && s->time[l] < INFINITY && s->time[l] <= start->time_limit && fabs(s->w[l]) < INFINITY;
    whole = whole && !film_grazes(start->load, out->maximum_indentation, start->nu);
    if (whole) j->status[index] = FILM_EVENT;
    else leave_alone(j, index);
}

/* ---------------------------------------------------------------- the whole way out */

/* From rest at the deepest point to the end of a branch of exponent 3/2, by film_way_out; lanes of a slowness beyond the table
 * are left out. */
static void leave_lanes(batch_job *j, const int64_t *index, int count, const turned_lanes *t) {
    double way[LANES][4], stopped[LANES];
    lanes s = t->at;
    map_lanes(film_way_out, FILM_WAY_OUT_TERMS, FILM_WAY_OUT_VALUES, t->slowness, way);
    EACH(l) {
        double clock = sqrt(t->recovery[l] / s.force[l]);
        stopped[l] = s.time[l] + clock * way[l][2];
        s.time[l] += clock * way[l][0];
        s.w[l] = -sqrt(t->recovery[l] * s.force[l]) * way[l][1];
    }
    for (int l = 0; l < count; l++)
        if (t->slowness[l] < MAP_END)
            report_lane(j, &s, stopped[l], l, index[l], s.xi[l] - t->recovery[l], t->stored[l], 0.4 * s.force[l] * t->recovery[l]);
}

/* ---------------------------------------------------------------- along branches */

/* Puts the lanes at rest at their deepest point; xi counts from the end of the branch. */
static void start_unloading(unloading_queue *q, lanes *restrict s) {
    for (int l = q->count; l < LANES; l++) { /* an incomplete block is filled up with its first impact */
        q->gamma[l] = q->gamma[0];
        q->load[l] = q->load[0];
        q->time[l] = q->time[0];
        q->top[l] = q->top[0];
        q->force[l] = q->force[0];
        q->recovery[l] = q->recovery[0];
        q->exponent[l] = q->exponent[0];
    }
    EACH(l) {
        s->gamma[l] = q->gamma[l];
        s->load[l] = q->load[l];
        s->time[l] = q->time[l];
        s->w[l] = q->gamma[l] * q->force[l];
        s->bad[l] = 0.0;
        s->xi[l] = q->recovery[l];
        s->force[l] = q->force[l];
        s->work[l] = q->force[l] * q->recovery[l] / (q->exponent[l] + 1.0);
    }
}

/* The next lines of branches that have one exponent: the table's, scaled; stiff: force over recovery. f1: the law's force at
 * their ends. */
INLINED void scale_lines(const unloading_queue *restrict q, const double *restrict stiff, const table_row *r, lines *restrict n,
                         double *restrict f1) {
    double h = r->h, kappa = r->kappa, phi = r->phi, force = r->force;
    EACH(l) {
        n->h[l] = q->recovery[l] * h;
        n->kappa[l] = stiff[l] * kappa;
        n->phi[l] = q->force[l] * phi;
        f1[l] = q->force[l] * force;
    }
}

/* The next lines of branches that have an exponent each, to this fraction of the recovery. */
static void make_branch_lines(const unloading_queue *restrict q, double fraction, int from_rest, lanes *restrict s,
                              lines *restrict n, double *restrict f1) {
    double u[LANES], x1[LANES], w1[LANES];
    EACH(l) u[l] = fraction;
    power_lanes(u, q->exponent, f1);
    EACH(l) {
        x1[l] = q->recovery[l] * fraction;
        f1[l] *= q->force[l];
        w1[l] = f1[l] * x1[l] / (q->exponent[l] + 1.0);
    }
    make_lines(s, n, -1.0, from_rest, x1, f1, w1);
}

/* A block of impacts from rest at their deepest point out along their branches; exponent NAN: each lane has its own. */
static void unload_lanes(batch_job *j, int32_t grading, double same, unloading_queue *q) {
    const double *nodes = j->mesh->unloading_nodes[grading];
    int32_t segments = film_unloading(j->mesh, grading);
    double stiff[LANES], w0[LANES], f0[LANES], f1[LANES], from[LANES], stopped[LANES];
    const table_row *r = same == same ? film_lines_of(j, UNIT_POWER, -1, segments, nodes, same)->rows : NULL;
    lanes s;
    lines n;
    stops stop;
    int any_moves = 1;
    start_unloading(q, &s);
    EACH(l) {
        stiff[l] = q->force[l] / q->recovery[l];
        f1[l] = q->force[l];
    }
    clear_stops(&stop);
    for (int32_t i = 1; i <= segments; i++) {
        if (any_moves) {
            EACH(l) {
                w0[l] = s.w[l];
                f0[l] = f1[l];
                from[l] = q->recovery[l] * (i == 1 ? 1.0 : 1.0 - nodes[i - 1]);
            }
        }
        if (r != NULL) scale_lines(q, stiff, &r[i], &n, f1);
        else make_branch_lines(q, i < segments ? 1.0 - nodes[i] : 0.0, i == 1, &s, &n, f1);
        if (i == 1) pass_from_rest(&s, &n);
        else pass_outwards(&s, &n);
        if (any_moves) {
            keep_stops(&stop, &s, &n, w0, f0, f1, from, FILM_BRANCH, i == 1);
            any_moves = any(stop.moving);
        }
    }
    stop_times(j, &stop, &s, q, same, stopped);
    for (int l = 0; l < q->count; l++)
        report_lane(j, &s, stopped[l], l, q->index[l], q->top[l] - q->recovery[l], q->stored[l],
                    q->force[l] * q->recovery[l] / (q->exponent[l] + 1.0));
    q->count = 0;
}

/* ---------------------------------------------------------------- back along the law */

/* The nodes of each lane's leg along a stage. */
typedef struct {
    double from[LANES];
    const double *nodes[LANES];
    int32_t segments[LANES], most;
} lane_legs;

/* recovery: of stretched stages, else NULL. */
static void plan_legs(const batch_job *j, const lanes *restrict s, const double *restrict largest, const double *recovery,
                      int pulled, lane_legs *g, int32_t *lines_made) {
    const film_mesh *mesh = j->mesh;
    g->most = 0;
    EACH(l) {
        double depth = recovery != NULL ? recovery[l] : s->xi[l];
        int32_t grading = pulled ? FILM_COSINE : film_grading(s->gamma[l] * sqrt(largest[l] / depth));
        g->from[l] = s->xi[l];
        g->nodes[l] = mesh->unloading_nodes[grading];
        g->segments[l] = film_unloading(mesh, grading);
        g->most = g->segments[l] > g->most ? g->segments[l] : g->most;
        lines_made[l] += g->segments[l];
    }
}

/* Line i of each lane's leg along stage k; lanes whose leg has fewer stay where they are. */
static void retrace_lines(const batch_job *j, int32_t k, const lane_legs *g, int32_t i, int from_rest, lanes *restrict s,
                          stops *restrict stop) {
    double x1[LANES], f1[LANES], w1[LANES], w0[LANES], f0[LANES], begin[LANES], until[LANES];
    lines n;
    EACH(l) {
        double to = j->curve->stage[k].begin * (stop->by != NULL ? stop->by->length[l] : 1.0);
        x1[l] = i < g->segments[l] ? g->from[l] + (to - g->from[l]) * g->nodes[l][i] : to;
        w0[l] = s->w[l];
        f0[l] = s->force[l];
        begin[l] = s->xi[l];
        until[l] = s->time[l];
    }
    back_law_lanes(j, k, stop->by, x1, f1, w1);
    make_lines(s, &n, -1.0, from_rest, x1, f1, w1);
    EACH(l) { /* any line will do for those, their motion is put back below */
        if (i <= g->segments[l]) continue;
        n.h[l] = 1.0;
        n.phi[l] = n.kappa[l] = 0.0;
        s->w[l] = -1.0;
    }
    if (from_rest) pass_from_rest(s, &n);
    else pass_outwards(s, &n);
    EACH(l) {
        if (i <= g->segments[l]) continue;
        s->w[l] = w0[l];
        s->time[l] = until[l];
    }
    keep_stops(stop, s, &n, w0, f0, f1, begin, k, from_rest);
}

/* The way back along a reversible law, or its stretched stages, stage by stage, from rest at the turn: the lanes have turned in
 * `stage`. */
static void retrace_lanes(batch_job *j, int32_t stage, const int64_t *index, int count, lanes *restrict s,
                          const double *restrict stored) {
    double largest[LANES], stopped[LANES], recovery[LANES], given[LANES], left[LANES];
    double outmost = j->curve->stage[0].begin;
    int32_t lines_made[LANES] = {0}, inmost = stage;
    int stretched = j->curve->stage[stage].unloading == FILM_SIMILAR;
    lane_legs g;
    stops stop;
    stretch by;
    clear_stops(&stop);
    EACH(l) {
        largest[l] = s->force[l];
        given[l] = stored[l] + j->parting;
        left[l] = outmost;
    }
    if (stretched) {
        stop.by = &by;
        inmost = stretch_lanes(j, stage, s, &by, given);
        EACH(l) {
            recovery[l] = s->xi[l];
            given[l] += by.force[l] * by.length[l] * j->parting;
            left[l] = by.dent[l] + by.length[l] * outmost;
        }
    }
    for (int32_t k = inmost; k >= 0; k--) {
        int pulled = k < inmost && film_is_pulled(j->end_force[k], j->curve->pull);
        plan_legs(j, s, largest, stretched ? recovery : NULL, pulled, &g, lines_made);
        back_law_lanes(j, k, stop.by, g.from, s->force, s->work);
        for (int32_t i = 1; i <= g.most; i++) retrace_lines(j, k, &g, i, i == 1 && k == inmost, s, &stop);
    }
    stop_times(j, &stop, s, NULL, NAN, stopped);
    for (int l = 0; l < count; l++) {
        j->summary[index[l]].lines += lines_made[l];
        report_lane(j, s, stopped[l], l, index[l], left[l], stored[l], given[l]);
    }
}

#endif
