/* Friction of many impacts by springs, in lanes: film_springs_impact without the motion. Internal to film_lanes.c.
 * docs/method.md, section 15. */
#ifndef FILM_LANE_SLIDE_H
#define FILM_LANE_SLIDE_H

#include "lanes/film_lane_power.h"

/* Least rise of the depth in a step that is not taken as none: 1 over it is finite. */
static const double LEAST_RISE = 1e-200;

/* The springs of a group of impacts, as in film_springs. top: how deep the contact is, as film_springs.reach; met: springs that
 * touch; rise: of q in the last step; cut: if asked for. */
typedef struct {
    double width[GROUP], stiffness[GROUP], power[GROUP], friction[GROUP], mass[GROUP], v[GROUP], q[GROUP], rise[GROUP], top[GROUP], cut[GROUP];
    double u[FILM_MOST_SPRINGS][GROUP], reach[FILM_MOST_SPRINGS][GROUP], sums[FILM_MOST_SPRINGS + 1][GROUP];
    int32_t met[GROUP], count[GROUP], spheres; /* spheres: 1 if that is the power of all */
} spring_group;

static void put_springs(spring_group *restrict g, int l, const film_springs *s) {
    g->width[l] = s->width, g->stiffness[l] = s->stiffness, g->power[l] = s->power, g->friction[l] = s->friction;
    g->mass[l] = s->mass, g->v[l] = s->v, g->count[l] = s->count;
    g->q[l] = g->rise[l] = g->top[l] = 0.0, g->met[l] = 0;
    g->spheres = (l == 0 || g->spheres) && s->power == 2.0;
    for (int32_t j = 0; j < FILM_MOST_SPRINGS && j < s->count; j++) g->u[j][l] = 0.0, g->reach[j][l] = s->reach[j], g->sums[j + 1][l] = s->sums[j + 1];
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

/* film_springs_step. */
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
        moved[l] = (g->v[l] - h[l] / g->mass[l] * (0.5 * g->q[l] + g->rise[l] / 6.0)) * h[l];
        per_share[l] = all[l] > 0.0 ? g->friction[l] * force[l] / (g->stiffness[l] * all[l]) : 0.0;
        per_grown[l] = 1.0 / (grown > LEAST_RISE ? grown : LEAST_RISE);
    }
    least = least > 1 && !watched ? least - 1 : 0; /* the last spring may touch by rounding alone */
    slip_springs(g, 0, least, top, per_share, per_grown, moved, 1, 0, sum);
    if (watched) slip_springs(g, 0, last, top, per_share, per_grown, moved, 0, 1, sum);
    else slip_springs(g, least, last, top, per_share, per_grown, moved, 0, 0, sum);
    EACH_OF(l) {
        double before = g->q[l], q = g->stiffness[l] * sum[l], change = q - before;
        g->v[l] -= h[l] / g->mass[l] * (0.5 * (before + q) - (change - g->rise[l]) / 12.0);
        g->q[l] = q;
        g->rise[l] = change;
        g->top[l] = top[l];
    }
    memcpy(g->met, touch, sizeof touch);
}

/* film_springs_take, if the coefficient depends on the speed. */
static void take_friction(spring_group *restrict g, const double *restrict h, const double *const *table, int32_t rows) {
    for (int l = 0; rows > 1 && l < GROUP; l++)
        g->friction[l] = film_friction_at(table[l], rows, fabs(g->v[l] - h[l] * g->q[l] / g->mass[l]));
}

/* What one group has done so far, and what it is from. */
typedef struct {
    spring_group runs[FILM_SPRINGS_RUNS];
    double force[GROUP], step[GROUP], limits[GROUP], used[GROUP], apart[FILM_SPRINGS_RUNS][GROUP];
    const double *table[GROUP], *forces[GROUP], *radii[GROUP];
    film_springs_impact_result found[GROUP];
} sliding_group;

/* How many impacts have a phase after step i. */
static int watch_group(sliding_group *restrict s, int64_t i, const double *time) {
    const spring_group *fine = &s->runs[0];
    int known = 0;
    for (int l = 0; l < GROUP; l++) {
        film_watch *watch = &s->found[l].watch;
        if (watch->events == 0) film_springs_watch(watch, (int32_t)fine->cut[l], fine->met[l], s->radii[l][i - 1], s->radii[l][i], time[l]);
        known += watch->events > 0;
    }
    return known;
}

static void follow_group(sliding_group *restrict s, const double *time, int32_t rows, int64_t steps) {
    spring_group *fine = &s->runs[0];
    double h[FILM_SPRINGS_RUNS][GROUP], force[GROUP], radius[GROUP];
    int watched = 1;
    for (int k = 0; k < FILM_SPRINGS_RUNS; k++) EACH_OF(l) h[k][l] = (1 << k) * time[l];
    for (int64_t i = 1; i <= steps; i++) {
        EACH_OF(l) force[l] = s->forces[l][i], radius[l] = s->radii[l][i];
        for (int k = 0; k < FILM_SPRINGS_RUNS && i % (1 << k) == 0; k++) {
            take_friction(&s->runs[k], h[k], s->table, rows);
            slide_group(&s->runs[k], h[k], force, radius, watched && k == 0);
            for (int l = 0; k > 0 && l < GROUP; l++) {
                double apart = fabs(s->runs[k - 1].v[l] - s->runs[k].v[l]);
                s->apart[k][l] = apart > s->apart[k][l] ? apart : s->apart[k][l];
            }
        }
        if (watched) watched = watch_group(s, i, time) < GROUP;
        EACH_OF(l) {
            double size = fabs(fine->q[l]);
            s->step[l] = size > s->force[l] ? (double)i : s->step[l];
            s->force[l] = size > s->force[l] ? size : s->force[l];
            s->limits[l] += fine->friction[l] * force[l];
            s->used[l] += size;
        }
    }
}

/* film_springs_many; an incomplete group is filled up with its first impact. */
static void slide_lanes(int64_t count, int32_t springs, const double *numbers, const double *friction, int32_t rows, int shared,
                        int64_t steps, const double *force, const double *radius, film_springs_brief *results) {
    sliding_group s;
    film_springs runs[FILM_SPRINGS_RUNS];
    memset(&s, 0, sizeof s);
    memset(runs, 0, sizeof runs);
    for (int64_t first = 0; first < count; first += GROUP) {
        double time[GROUP];
        int status[GROUP];
        memset(s.force, 0, offsetof(sliding_group, table) - offsetof(sliding_group, force));
        for (int l = 0; l < GROUP; l++) {
            int64_t i = first + (first + l < count ? l : 0);
            const double *n = numbers + 5 * i;
            s.table[l] = friction + (shared ? 0 : 2 * rows * i);
            s.forces[l] = force + i * (steps + 1), s.radii[l] = radius + i * (steps + 1);
            s.found[l] = (film_springs_impact_result){.velocity = n[3], .watch = {.phase = -1}};
            status[l] = film_springs_begin(runs, springs, n[0], n[1], n[2], n[3], s.table[l][1], steps, s.radii[l]);
            for (int k = 0; k < FILM_SPRINGS_RUNS; k++) put_springs(&s.runs[k], l, &runs[k]);
            time[l] = n[4];
        }
        follow_group(&s, time, rows, steps);
        for (int l = 0; l < GROUP && first + l < count; l++) {
            film_springs_impact_result *found = &s.found[l];
            if (status[l] == FILM_OK) {
                found->velocity = s.runs[0].v[l], found->force = s.force[l], found->step = (int64_t)s.step[l];
                status[l] = film_springs_end(found, s.apart[1][l], s.apart[2][l], s.limits[l], s.used[l]);
            }
            results[first + l] = (film_springs_brief){found->velocity, found->force, found->error, found->slack, found->step, found->regime, status[l]};
        }
    }
}

#endif
