/* One contact from its start to its end by the lines of the march, and a shorter way for a fixed target, where
 * energy gives the velocity at every node. docs/method.md, section 3. */
#include "march/film_march.h"

#include <string.h>

/* Lengths along a line agree to this fraction of it where a motion passes from one to the next. */
static const double NODE_ROUNDING = 1e-12;

enum { STOP_STEPS = 5 };

/* How far along a line the speed becomes `stop`: the first root of force x + kappa x^2/2 = (v0^2 - stop^2)/2 between 0 and h;
 * NAN: none. force: where the line begins. */
static double way_to_speed(double v0, double stop, double force, double kappa, double h) {
    double energy = 0.5 * (v0 - stop) * (v0 + stop), square = force * force + 2.0 * kappa * energy, found = NAN;
    if (!(stop > 0.0 && square >= 0.0)) return NAN;
    for (int sign = -1; sign <= 1; sign += 2) {
        double x = 2.0 * energy / (force + sign * sqrt(square)), part = x / h;
        if (part >= 0.0 && part <= 1.0 + NODE_ROUNDING && !(fabs(x) >= fabs(found))) found = part < 1.0 ? x : h;
    }
    return found;
}

/* A speed that the impactor may pass on its way, 0: none, and when it first does; NAN: not yet. before: time of the legs before. */
typedef struct {
    double speed, before, time;
} passing;

/* The time from `from`, where the velocity is v, to `to`. tan(omega tau/2) = omega h/(v0 + v1) on each line; the first
 * line of a run from rest and the last one of a run that turns meet the law's force there. docs/method.md, section 3. */
static double crossing_time(const film_curve *curve, const film_line *run, double load, double from, double to, double v,
                            int turns, int32_t segments, const double *nodes, series_place *near, passing *stop, double *peak) {
    double f0, w0, f1, w1, x0 = from, v0 = v, time = 0.0;
    law_near(curve, run, from, near, &f0, &w0);
    double total = v * v + 2.0 * w0;
    for (int32_t i = 1; i <= segments; i++) {
        double x1 = i < segments ? from + (to - from) * nodes[i] : to, h = x1 - x0;
        law_near(curve, run, x1, near, &f1, &w1);
        double square = total - 2.0 * (w1 - load * (x1 - from)), per_h = 1.0 / h, mean = (w1 - w0) * per_h, kappa = (f1 - f0) * per_h;
        if (!(square > 0.0) && i < segments) return INFINITY; /* it turns before */
        double v1 = square > 0.0 && !(turns && i == segments) ? sqrt(square) : 0.0;
        if (turns && i == segments) kappa = 2.0 * (f1 - mean) * per_h;
        else if (i == 1 && v == 0.0) kappa = 2.0 * (mean - f0) * per_h;
        double part = isnan(stop->time) ? way_to_speed(v0, stop->speed, mean - 0.5 * kappa * h - load, kappa, h) : NAN;
        if (!isnan(part) && part != 0.0) { /* a new line begins there */
            double fs = f1, ws = w1, xs = x0 + part;
            for (int step = 0; step < STOP_STEPS; step++) { /* Newton's method on the law */
                law_near(curve, run, xs, near, &fs, &ws);
                double miss = total - 2.0 * (ws - load * (xs - from)) - stop->speed * stop->speed;
                if (step < STOP_STEPS - 1 && fs != load) xs += 0.5 * miss / (fs - load);
            }
            part = xs - x0;
            mean = (ws - w0) / part;
            kappa = i == 1 && v == 0.0 ? 2.0 * (mean - f0) / part : (fs - f0) / part;
            double to_stop = fabs(part) / (v0 + stop->speed);
            time += 2.0 * to_stop * arc(kappa * to_stop * to_stop);
            stop->time = stop->before + time;
            h = x1 - xs;
            mean = (w1 - ws) / h;
            kappa = turns && i == segments ? 2.0 * (f1 - mean) / h : (f1 - fs) / h;
            v0 = stop->speed;
        }
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

/* Where a contact with a fixed target is, by energy. */
typedef struct {
    film_line run; /* its branch: the stage */
    double xi, force, stored, time;
    series_place near;
    passing stop;
} progress;

/* Through the loading stages to the turn. */
static int load_to_turn(const film_curve *curve, const film_mesh *mesh, const film_start *start, progress *at, film_summary *summary) {
    double v = start->nu, load = start->load, to, work, peak = 0.0;
    for (int status = FILM_OK; status != FILM_EVENT; at->run.branch++) {
        if (at->run.branch >= curve->stages) return FILM_BEYOND_LAW;
        double before = 0.0;
        if (at->xi > curve->stage[at->run.branch].begin) law_near(curve, &at->run, at->xi, &at->near, &at->force, &before);
        status = film_turning_point(curve, &at->run, at->xi, before, v, load, curve->stage[at->run.branch].end, &at->near, &to);
        if (status < 0) return status;
        law_near(curve, &at->run, to, &at->near, &at->force, &work);
        at->stop.before = at->time;
        if (status == FILM_EVENT && to - at->xi <= SHORT_LEG * to) { /* the way is mostly rounding, the velocity is not */
            if (at->stop.speed > 0.0 && at->stop.speed <= v && isnan(at->stop.time))
                at->stop.time = at->time + (at->force > load ? (v - at->stop.speed) / (at->force - load) : 0.0);
            at->time += at->force > load ? v / (at->force - load) : 0.0;
            if (at->force > peak) peak = at->force;
        } else {
            at->time += crossing_time(curve, &at->run, load, at->xi, to, v, status == FILM_EVENT, mesh->loading,
                                      mesh->loading_nodes[FILM_COSINE], &at->near, &at->stop, &peak);
        }
        summary->lines += mesh->loading;
        work -= before;
        at->stored += work;
        v = speed_after(v, work - load * (to - at->xi));
        at->xi = to;
    }
    if (load == 0.0) at->stored = 0.5 * start->nu * start->nu; /* all of it, without the rounding of the turn */
    summary->stage = --at->run.branch;
    summary->maximum_force = peak;
    summary->maximum_indentation = at->xi - curve->compliance * at->force;
    summary->time_of_maximum_indentation = at->time;
    return FILM_EVENT;
}

/* The run from at->xi out: where it ends, and whether the contact does. */
static double way_out(const film_curve *curve, const film_line *run, int *last) {
    int stretched = run->branch <= FILM_STRETCHED;
    const film_stage *stage = &curve->stage[stretched ? FILM_STRETCHED - run->branch : run->branch < 0 ? 0 : run->branch];
    *last = stage == curve->stage;
    if (run->branch == FILM_BRANCH) return run->xi_free;
    return stretched ? run->xi_origin + run->exponent * stage->begin : stage->begin;
}

/* Back along the unloading branch, the stretched stages or, of a reversible stage, the law; *given_back: the work of the way. */
static int unload_to_end(const film_curve *curve, const film_mesh *mesh, double load, progress *at, film_summary *summary,
                         double *given_back) {
    const double *nodes = mesh->unloading_nodes[FILM_COSINE];
    double peak = 0.0, v = 0.0, total = 0.0;
    int status = film_open_branch(curve, &at->run, at->xi, at->force);
    if (status < 0) return status;
    int back_along_law = at->run.branch >= 0;
    if (at->run.branch == FILM_BRANCH) at->near.x = 0.0; /* that of the branch counts from its end */
    for (int last = 0; !last; at->run.branch += at->run.branch < 0 ? 1 : -1) {
        double to = way_out(curve, &at->run, &last), work;
        law_near(curve, &at->run, at->xi, &at->near, &at->force, &work);
        at->stop.before = at->time;
        at->time += crossing_time(curve, &at->run, load, at->xi, to, v, 0, mesh->unloading, nodes, &at->near, &at->stop, &peak);
        summary->lines += mesh->unloading;
        v = speed_after(v, -work - load * (to - at->xi));
        if (v == 0.0) at->time = INFINITY; /* it turns before */
        total += work;
        at->xi = to;
    }
    *given_back = back_along_law && curve->pull == 0.0 ? at->stored : total;
    return FILM_EVENT;
}

/* A contact with a fixed target, by energy. docs/method.md, section 3. */
static int impact_by_energy(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    progress at;
    double given_back, load = start->load;
    memset(&at, 0, sizeof at);
    at.stop = (passing){start->stop_velocity, 0.0, NAN};
    while (at.run.branch < curve->stages - 1 && !(curve->stage[at.run.branch].end > 0.0)) at.run.branch++;
    int status = load_to_turn(curve, mesh, start, &at, summary);
    double top = at.xi;
    if (start->stop_velocity == 0.0) at.stop.time = at.time;
    at.stop.speed = -start->stop_velocity;
    if (status >= 0) status = unload_to_end(curve, mesh, load, &at, summary, &given_back);
    if (status < 0) return status;
    summary->time_impactor_stops = at.stop.time;
    summary->contact_duration = at.time;
    summary->permanent_indentation = at.xi;
    summary->final_velocity = -sqrt(2.0 * (given_back - load * (top - at.xi)));
    summary->work = at.stored - given_back;
    return FILM_EVENT;
}

/* Whether energy gives the velocity at every node. */
static int by_energy(const film_mesh *mesh, const film_start *s) {
    return s->gamma == 0.0 && s->nu > 0.0 && s->load >= 0.0 && isfinite(s->stop_velocity) && s->damping == 0.0 && mesh->linearisation == FILM_WORK_PRESERVING;
}

int film_marched(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    film_state s;
    int32_t lines, events;
    film_clear_summary(summary);
    if (!(start->nu > 0.0 || (start->nu == 0.0 && start->load > 0.0)) || start->nu == INFINITY) return FILM_BAD_NUMBER;
    if (by_energy(mesh, start)) {
        int status = impact_by_energy(curve, mesh, start, summary);
        int ended = summary->contact_duration < INFINITY && summary->contact_duration <= start->time_limit;
        ended = ended && start->load * summary->maximum_indentation <= 0.5 * start->nu * start->nu;
        if (status < 0 || ended) return status;
    } /* it turns again, or rounding matters: that of the recorded march, then */
    int status = film_begin(curve, start, &s);
    if (status >= 0)
        status = film_record(curve, mesh, &s, start->time_limit, NULL, FILM_MAX_STEP_LINES, &lines, NULL, FILM_MAX_EVENTS, &events, summary);
    return status == FILM_FULL ? FILM_TOO_MANY : status;
}
