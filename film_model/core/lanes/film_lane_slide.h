/* Friction of many impacts by springs, in lanes: film_springs_impact without the motion. Internal to film_lanes.c.
 * docs/method.md, section 15. */
#ifndef FILM_LANE_SLIDE_H
#define FILM_LANE_SLIDE_H

#include "lanes/film_lane_power.h"

/* Least rise of the depth in a step that is not taken as none: 1 over it is finite. */
static const double LEAST_RISE = 1e-200;

/* The springs of a group of impacts, as in film_springs. top: how deep the contact is, as film_springs.reach; met: springs that
 * touch; rate: of q over time in the last step; last: the time of that step; cut: if asked for. */
typedef struct {
    double width[GROUP], stiffness[GROUP], power[GROUP], friction[GROUP], mass[GROUP], v[GROUP], q[GROUP], rate[GROUP], last[GROUP];
    double top[GROUP], cut[GROUP];
    double u[FILM_MOST_SPRINGS][GROUP], reach[FILM_MOST_SPRINGS][GROUP], sums[FILM_MOST_SPRINGS + 1][GROUP];
    int32_t met[GROUP], count[GROUP], spheres; /* spheres: 1 if that is the power of all */
} spring_group;

/* Springs that do not touch. Those of the impact before in the lane are kept where they are alike. */
static void put_springs(spring_group *restrict g, int l, const film_springs *s) {
    int32_t alike = g->power[l] == s->power && g->count[l] == s->count ? s->count : 0;
    g->width[l] = s->width, g->stiffness[l] = s->stiffness, g->power[l] = s->power, g->friction[l] = s->friction;
    g->mass[l] = s->mass, g->v[l] = s->v, g->count[l] = s->count;
    g->q[l] = g->rate[l] = g->last[l] = g->top[l] = 0.0, g->met[l] = 0;
    g->spheres = (l == 0 || g->spheres) && s->power == 2.0;
    for (int32_t j = alike; j < FILM_MOST_SPRINGS && j < s->count; j++)
        g->reach[j][l] = s->reach[j], g->sums[j + 1][l] = s->sums[j + 1];
    g->sums[0][l] = 0.0;
}

/* Springs from `first` to `last` in a step, and their sum after it: those that do not touch end at 0, one that the contact has just
 * reached moves with it for its part of the step. whole: all of them touch all the time. */
INLINED void slip_springs(spring_group *restrict g, int32_t first, int32_t last, const double *restrict top, const double *restrict per_share,
                          const double *restrict per_grown, const double *restrict moved, int whole, int watched, double *restrict sum) {
    for (int32_t j = first; j < last; j++) EACH_OF(l) {
        double left = top[l] - g->reach[j][l], most = left * per_share[l], part = left * per_grown[l];
        most = whole || most > 0.0 ? most : 0.0;
        part = part < 1.0 ? part : 1.0;
        part = whole || j < g->met[l] ? 1.0 : part;
        double u = g->u[j][l] + moved[l] * part;
        if (watched) g->cut[l] += left > 0.0 ? (u > most ? 1.0 : 0.0) - (u < -most ? 1.0 : 0.0) : 0.0;
        u = u < -most ? -most : u;
        u = u > most ? most : u;
        g->u[j][l] = u;
        sum[l] += u;
    }
}

/* film_springs_step, by Adams's rules for steps of any time; in one of none a contact that jumps wide or narrow does so. */
CALLED void slide_group(spring_group *restrict g, const double *restrict h, const double *restrict force, const double *restrict radius,
                        int watched) {
    double widths[GROUP], top[GROUP], all[GROUP], moved[GROUP], per_share[GROUP], per_grown[GROUP], sum[GROUP] = {0.0};
    int32_t touch[GROUP], last = 0, least = FILM_MOST_SPRINGS;
    EACH_OF(l) {
        widths[l] = radius[l] / g->width[l];
        double springs = widths[l] - 0.5, most = g->count[l];
        springs = springs > 0.0 ? springs : 0.0;
        springs = springs < most ? springs : most;
        touch[l] = (int32_t)springs;
        touch[l] += touch[l] < springs;
        top[l] = widths[l] * widths[l];
        g->cut[l] = 0.0;
    }
    for (int l = 0; !g->spheres && l < GROUP; l++) top[l] = film_springs_reached(g->power[l], widths[l]);
    for (int l = 0; l < GROUP; l++) {
        int32_t fewer = touch[l] < g->met[l] ? touch[l] : g->met[l], more = touch[l] + g->met[l] - fewer;
        least = fewer < least ? fewer : least;
        last = more > last ? more : last;
        all[l] = touch[l] * top[l] - g->sums[touch[l]][l];
    }
    EACH_OF(l) {
        double grown = top[l] - g->top[l];
        moved[l] = (g->v[l] - h[l] / g->mass[l] * (0.5 * g->q[l] + g->rate[l] * h[l] / 6.0)) * h[l];
        per_share[l] = all[l] > 0.0 ? g->friction[l] * force[l] / (g->stiffness[l] * all[l]) : 0.0;
        per_grown[l] = 1.0 / (grown > LEAST_RISE ? grown : LEAST_RISE);
    }
    least = least > 1 && !watched ? least - 1 : 0; /* the last spring may touch by rounding alone */
    slip_springs(g, 0, least, top, per_share, per_grown, moved, 1, 0, sum);
    if (watched) slip_springs(g, 0, last, top, per_share, per_grown, moved, 0, 1, sum);
    else slip_springs(g, least, last, top, per_share, per_grown, moved, 0, 0, sum);
    EACH_OF(l) {
        double before = g->q[l], q = g->stiffness[l] * sum[l], change = q - before, both = h[l] + g->last[l];
        double even = g->last[l] > 0.0 ? 2.0 * h[l] / both : 1.0; /* the step over the mean of it and the one before */
        g->v[l] -= h[l] / g->mass[l] * (0.5 * (before + q) - even * (change - g->rate[l] * h[l]) / 12.0);
        g->q[l] = q;
        g->rate[l] = h[l] > 0.0 ? change / h[l] : g->rate[l];
        g->last[l] = h[l] > 0.0 ? h[l] : g->last[l];
        g->top[l] = top[l];
    }
    memcpy(g->met, touch, sizeof touch);
}

/* film_springs_take, if the coefficient depends on the speed. */
static void take_friction(spring_group *restrict g, const double *restrict h, const double *const *table, int32_t rows) {
    for (int l = 0; rows > 1 && l < GROUP; l++)
        g->friction[l] = film_friction_at(table[l], rows, fabs(g->v[l] - h[l] * g->q[l] / g->mass[l]));
}

/* What one group has done so far, and what it is from: a leg of contact in steps, each between two of its knots. when: time of the largest |q|. near_forces, near_radii: at the four
 * knots around a step. */
typedef struct {
    spring_group runs[FILM_SPRINGS_RUNS];
    double force[GROUP], when[GROUP], limits[GROUP], used[GROUP], apart[FILM_SPRINGS_RUNS][GROUP];
    const double *table[GROUP], *forces[GROUP], *radii[GROUP];
    double share[FILM_MOST_STEPS + 1]; /* of a leg, after each of its steps on the way in */
    double near_forces[4][GROUP], near_radii[4][GROUP];
    film_springs_impact_result found[GROUP];
} sliding_group;

/* The four knots from `first` of a leg on, whose values begin at `begin`; the last four were from `before` on. */
CALLED void take_knots(sliding_group *restrict s, int64_t begin, int64_t first, int64_t before) {
    int k = 0;
    if (first == before) return;
    for (; first == before + 1 && k < 3; k++) EACH_OF(l) {
        s->near_forces[k][l] = s->near_forces[k + 1][l];
        s->near_radii[k][l] = s->near_radii[k + 1][l];
    }
    for (; k < 4; k++)
        for (int l = 0; l < GROUP; l++)
            s->near_forces[k][l] = s->forces[l][begin + first + k], s->near_radii[k][l] = s->radii[l][begin + first + k];
}

/* The cubic through four knots at x from the first of them, at least 0. */
CALLED void between_knots(double (*restrict near)[GROUP], double x, double *restrict out) {
    double a = x - 1.0, b = x - 2.0, c = x - 3.0;
    double w0 = -a * b * c / 6.0, w1 = x * b * c / 2.0, w2 = -x * a * c / 2.0, w3 = x * a * b / 6.0;
    EACH_OF(l) {
        double value = w0 * near[0][l] + w1 * near[1][l] + w2 * near[2][l] + w3 * near[3][l];
        out[l] = value > 0.0 ? value : 0.0;
    }
}

/* How many impacts have a phase after a step. */
static int watch_group(sliding_group *restrict s, const double *before, const double *radius, const double *time) {
    const spring_group *fine = &s->runs[0];
    int known = 0;
    for (int l = 0; l < GROUP; l++) {
        film_watch *watch = &s->found[l].watch;
        if (watch->events == 0) film_springs_watch(watch, (int32_t)fine->cut[l], fine->met[l], before[l], radius[l], time[l]);
        known += watch->events > 0;
    }
    return known;
}

/* How much of a leg is passed after step i. */
static double passed(const sliding_group *s, int out, int64_t i, int64_t steps) { return out ? 1.0 - s->share[steps - i] : s->share[i]; }

/* Step i of a leg in the finest run, and the steps of others that end with it; step 0 takes no time. */
CALLED void step_group(sliding_group *restrict s, int out, int64_t i, int64_t steps, const double *leg, int32_t rows, const double *force,
                       const double *radius, int watched) {
    double now = passed(s, out, i, steps);
    for (int k = 0; k < FILM_SPRINGS_RUNS && i % (1 << k) == 0; k++) {
        double h[GROUP], part = i > 0 ? now - passed(s, out, i - (1 << k), steps) : 0.0;
        EACH_OF(l) h[l] = part * leg[l];
        take_friction(&s->runs[k], h, s->table, rows);
        slide_group(&s->runs[k], h, force, radius, watched && k == 0);
        if (k == 0) continue;
        EACH_OF(l) {
            double apart = fabs(s->runs[k - 1].v[l] - s->runs[k].v[l]);
            s->apart[k][l] = apart > s->apart[k][l] ? apart : s->apart[k][l];
        }
    }
}

/* What friction has done in a step. begin: time of the leg, NULL for 0. */
CALLED void measure_step(sliding_group *restrict s, const double *restrict begin, double share, const double *restrict leg,
                         const double *restrict time, const double *restrict force) {
    const spring_group *fine = &s->runs[0];
    EACH_OF(l) {
        double size = fabs(fine->q[l]), at = (begin ? begin[l] : 0.0) + share * leg[l];
        s->when[l] = size > s->force[l] ? at : s->when[l];
        s->force[l] = size > s->force[l] ? size : s->force[l];
        s->limits[l] += fine->friction[l] * force[l] * time[l];
        s->used[l] += size * time[l];
    }
}

/* A leg of contact; whether impacts are left without a phase. out: 1 on the way out, which begins with a step of no time: where the contact turns its radius may jump. */
static int follow_leg(sliding_group *restrict s, int out, double (*legs)[GROUP], int32_t rows, int64_t steps, int64_t knots, int watched) {
    double force[GROUP], radius[GROUP], before[GROUP], time[GROUP], per = (double)knots / (double)steps, *leg = legs[out];
    int64_t begin = out * (knots + 1), near = -2;
    EACH_OF(l) before[l] = s->radii[l][begin];
    for (int64_t i = !out; i <= steps; i++) {
        double x = (double)i * per, share = passed(s, out, i, steps), part = i > 0 ? share - passed(s, out, i - 1, steps) : 0.0;
        int64_t own = i > 0 ? (int64_t)(x - 0.5 * per) : 0, first = own < 1 ? 0 : own - 1 < knots - 3 ? own - 1 : knots - 3;
        take_knots(s, begin, first, near);
        near = first;
        between_knots(s->near_forces, x - (double)near, force);
        between_knots(s->near_radii, x - (double)near, radius);
        step_group(s, out, i, steps, leg, rows, force, radius, watched);
        EACH_OF(l) time[l] = part * leg[l];
        if (watched && i > 0) watched = watch_group(s, before, radius, time) < GROUP;
        measure_step(s, out ? legs[0] : NULL, share, leg, time, force);
        memcpy(before, radius, sizeof before);
    }
    return watched;
}

/* film_springs_many; an incomplete group is filled up with its first impact. */
static void slide_lanes(int64_t count, int32_t springs, const double *numbers, const double *friction, int32_t rows, int shared,
                        int64_t steps, int64_t knots, const double *force, const double *radius, film_springs_brief *results) {
    sliding_group s;
    film_springs runs[FILM_SPRINGS_RUNS];
    int64_t values = 2 * (knots + 1);
    memset(&s, 0, sizeof s);
    memset(runs, 0, sizeof runs);
    for (int64_t i = 0; i <= steps && i <= FILM_MOST_STEPS; i++) s.share[i] = film_leg_share((double)i / (double)steps);
    for (int64_t first = 0; first < count; first += GROUP) {
        double legs[2][GROUP];
        int status[GROUP];
        memset(s.force, 0, offsetof(sliding_group, table) - offsetof(sliding_group, force));
        for (int k = 0; k < FILM_SPRINGS_RUNS; k++) memset(s.runs[k].u, 0, (size_t)(springs >> k) * sizeof s.runs[k].u[0]);
        for (int l = 0; l < GROUP; l++) {
            int64_t i = first + (first + l < count ? l : 0);
            const double *n = numbers + 6 * i;
            s.table[l] = friction + (shared ? 0 : 2 * rows * i);
            s.forces[l] = force + i * values, s.radii[l] = radius + i * values;
            s.found[l] = (film_springs_impact_result){.velocity = n[3], .watch = {.phase = -1}};
            status[l] = film_springs_begin(runs, springs, n[0], n[1], n[2], n[3], s.table[l][1], values - 1, s.radii[l]);
            for (int k = 0; k < FILM_SPRINGS_RUNS; k++) put_springs(&s.runs[k], l, &runs[k]);
            legs[0][l] = n[4], legs[1][l] = n[5] - n[4];
        }
        int watched = follow_leg(&s, 0, legs, rows, steps, knots, 1);
        follow_leg(&s, 1, legs, rows, steps, knots, watched);
        for (int l = 0; l < GROUP && first + l < count; l++) {
            film_springs_impact_result *found = &s.found[l];
            if (status[l] == FILM_OK) {
                found->velocity = s.runs[0].v[l], found->force = s.force[l];
                status[l] = film_springs_end(found, s.apart[1][l], s.apart[2][l], s.limits[l], s.used[l]);
            }
            const film_springs_brief brief = {found->velocity, found->force, s.when[l], found->error, found->slack, found->regime, status[l]};
            results[first + l] = brief;
        }
    }
}

#endif
