/* Impacts by the thousand, one after the other: a vector kernel belongs in this file, and has to agree with film_impact.
 *
 * On a fixed target without a load, energy gives the velocity at every node and tan(omega tau/2) = omega h/(v0 + v1)
 * the time between two, so a summary needs neither events nor states. Everything else takes the march's own steps. */
#include "film_law.h"

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
        time += cross(curve, &run, xi, to, v, status == FILM_EVENT, mesh->loading, in, &peak);
        summary->lines += mesh->loading;
        law_at(curve, &run, to, &force, &work);
        stored += work;
        xi = to;
        if (status == FILM_EVENT) break;
        v = speed_at(v, work);
    }
    summary->maximum_force = peak;
    summary->maximum_indentation = xi;
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

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    film_state s;
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = NAN;
    summary->final_velocity = NAN;
    if (!(start->nu > 0.0 && start->nu < INFINITY)) return FILM_BAD_NUMBER;
    if (start->gamma == 0.0 && start->load == 0.0 && start->stop_velocity == 0.0 && start->time_limit == INFINITY &&
        mesh->linearisation == FILM_WORK_PRESERVING)
        return fixed_target(curve, mesh, start->nu, summary);
    int status = film_init(curve, &s, 0.0, start->nu, start->gamma, start->load, start->stop_velocity);
    while (status >= 0) {
        status = film_step(curve, mesh, &s, start->time_limit - s.time);
        if (status != FILM_EVENT || s.event == FILM_CONTACT_ENDS) break;
        if (s.event == FILM_MAXIMUM_INDENTATION && s.xi > summary->maximum_indentation) {
            summary->maximum_indentation = s.xi;
            summary->time_of_maximum_indentation = s.time;
            summary->stage = s.stage_max;
        } else if (s.event == FILM_IMPACTOR_STOPS && isnan(summary->time_impactor_stops)) {
            summary->time_impactor_stops = s.time;
        }
    }
    if (status < 0) return status;
    summary->maximum_force = s.force_peak;
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

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    for (int64_t i = 0; i < count; i++) status[i] = film_impact(curve, mesh, &start[i], &summary[i]);
}
