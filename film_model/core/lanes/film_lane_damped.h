/* Contacts under a damped power law, in lanes: by Taylor polynomials of the motion itself, without lines. Internal to
 * film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_DAMPED_H
#define FILM_LANE_DAMPED_H

#include "lanes/film_lane_law.h"

/* Terms of the polynomials beyond the constant. Affects cost only: with more terms steps are longer. */
enum { TERMS = 12 };

/* Length of a step over the radius within which the terms fall: RADIUS over the segments of a leg. The error of a step is about
 * the 13th power of it. Accuracy and cost: tests/test_batch.py compares with the march. */
static const double RADIUS = 1.5;

/* The same at most under a linear law, whose polynomials converge everywhere: steps are exact but for rounding. Needed by
 * test_a_linear_dashpot_is_exact_in_a_batch. */
static const double LINEAR_RADIUS = 0.06;

/* A contact that ends at z = 0 may end so far below it, as a fraction of its depth, by rounding; one that is farther below was
 * followed by too long steps. core_check.c, check_batch: without it a contact of 3 segments ends before it began. */
static const double END_ROUNDING = 1e-12;

enum { MOST_STEPS = 16 }; /* of a contact, per segment of a leg and FEWEST more; longer ones are left to film_marched */
enum { ROOT_STEPS = 80 }; /* to the time of an event */
enum { AT_TURN, AT_STOP, AT_PEAK, AT_RELEASE, MARKS };

typedef double series[TERMS + 1][LANES];

/* Lanes on one step. xi = z^m and dt = z^(m - 1) ds: powers of xi are whole powers of z, so motion begins, turns and ends as a
 * power series in s. */
typedef struct {
    double gamma[LANES], damper[LANES], load[LANES], stop[LANES]; /* damper: c over z^damping + faster z^root */
    series z, nu, time, squares; /* squares: the integral of F^2 dt */
    series power[MOST_POWER + 1]; /* of z: those that are used */
    series elastic, drag;         /* force over stiffness, c over factor: where they are more than one power */
    series y, force, push;        /* xi'; F; F dt/ds */
} damped_lanes;

/* Term k of the powers of z, and of dt/ds. */
static void power_terms(const damped_form *form, damped_lanes *restrict w, int k) {
    memcpy(w->power[1][k], w->z[k], sizeof w->z[k]);
    for (int e = 2; e <= MOST_POWER; e++)
        if (form->used[e]) product_term(w->power[e / 2], w->power[e - e / 2], 0, k, w->power[e][k]);
    if (!form->more) return;
    EACH(l) {
        w->elastic[k][l] = w->power[form->force][k][l] + form->steeper * w->power[2 * form->root][k][l];
        w->drag[k][l] = w->power[form->damping][k][l] + form->faster * w->power[form->root][k][l];
    }
}

/* The terms of all series from those of order 0 of z, nu, time and squares: z' = y/m, nu' = (p - F) z^(m - 1) by s. */
static void motion_terms(const damped_form *form, damped_lanes *restrict w) {
    double m = form->root, (*elastic)[LANES] = form->more ? w->elastic : w->power[form->force];
    double(*drags)[LANES] = form->more ? w->drag : w->power[form->damping];
    EACH(l) w->power[0][0][l] = 1.0;
    for (int k = 1; k <= TERMS; k++) EACH(l) w->power[0][k][l] = 0.0;
    for (int k = 0; k < TERMS; k++) {
        double shared[LANES] = {0.0}, per = 1.0 / (k + 1);
        power_terms(form, w, k);
        if (form->damping > 0 || form->more) product_term(drags, w->y, 1, k, shared);
        EACH(l) {
            double c = w->damper[l] * drags[0][l], f = form->stiffness * elastic[k][l];
            double drag = w->damper[l] * shared[l], g = w->gamma[l];
            w->y[k][l] = (w->nu[k][l] - g * (f + drag)) / (1.0 + g * c);
            w->force[k][l] = f + drag + c * w->y[k][l];
        }
        product_term(w->force, w->power[form->root - 1], 0, k, w->push[k]);
        product_term(w->force, w->push, 0, k, w->squares[k + 1]);
        EACH(l) {
            double clock = w->power[form->root - 1][k][l];
            w->squares[k + 1][l] *= per;
            w->time[k + 1][l] = per * clock;
            w->nu[k + 1][l] = per * (w->load[l] * clock - w->push[k][l]);
            w->z[k + 1][l] = per / m * w->y[k][l];
        }
    }
}

static void sum_series(double (*a)[LANES], const double *restrict at, double *restrict out) {
    double sum[LANES];
    memcpy(sum, a[TERMS], sizeof sum);
    for (int k = TERMS - 1; k >= 0; k--) EACH(l) sum[l] = sum[l] * at[l] + a[k][l];
    memcpy(out, sum, sizeof sum);
}

/* F at z and nu. */
static void damped_force(const damped_form *form, const damped_lanes *w, const double *restrict z, const double *restrict nu,
                         double *restrict force) {
    double f[LANES], c[LANES];
    two_powers(z, form->stiffness, form->force, form->stiffness * form->steeper, 2 * form->root, f);
    two_powers(z, 1.0, form->damping, form->faster, form->root, c);
    EACH(l) {
        c[l] *= w->damper[l];
        force[l] = (f[l] + c[l] * nu[l]) / (1.0 + w->gamma[l] * c[l]);
    }
}

/* What falls to 0 at an event: the relative velocity at the turn; nu over the velocity of the stop; dF/ds at the largest
 * force; F at the end, over the power of z that it shares with c. */
static void event_values(const damped_form *form, const damped_lanes *w, int event, const double *restrict z,
                         const double *restrict nu, double *restrict out) {
    double f[LANES], c[LANES], whole[LANES], force[LANES], k = form->stiffness, more = k * form->steeper;
    int m = form->root, of_f = form->force, of_c = form->damping;
    if (event == AT_STOP) {
        EACH(l) out[l] = nu[l] - w->stop[l];
    } else if (event == AT_TURN) {
        two_powers(z, k, of_f, more, 2 * m, f);
        EACH(l) out[l] = nu[l] - w->gamma[l] * f[l];
    } else if (event == AT_RELEASE) {
        two_powers(z, k, of_f - of_c, more, 2 * m - of_c, f);
        if (of_f == of_c) EACH(l) out[l] = z[l];
        else EACH(l) out[l] = f[l] + w->damper[l] * nu[l];
        if (!form->more) return;
        two_powers(z, 0.0, 0, form->faster, m - of_c, c);
        EACH(l) out[l] += c[l] * (w->damper[l] * nu[l]);
    } else {
        int shared = of_c > 0 ? of_c : m;
        damped_force(form, w, z, nu, force);
        two_powers(z, of_f * k, of_f - shared, 2 * m * more, 2 * m - shared, f);
        two_powers(z, of_c, 0, m * form->faster, m - shared, c);
        two_powers(z, 1.0, m + of_c - shared, form->faster, 2 * m - shared, whole);
        EACH(l) {
            double moved = nu[l] - w->gamma[l] * force[l];
            double spring = f[l] + c[l] * w->damper[l] * moved;
            out[l] = spring * moved / m + w->damper[l] * whole[l] * (w->load[l] - force[l]);
        }
    }
}

/* Where in 0 .. h the value of an event, above 0 at 0 and not at h, falls to 0: false position, the value at the older end
 * halved. */
static void event_place(const damped_form *form, damped_lanes *restrict w, int event, const double *restrict h,
                        const double *restrict first, const double *restrict last, const double *restrict due,
                        double *restrict place) {
    double low[LANES], high[LANES], above[LANES], below[LANES], moving[LANES], z[LANES], nu[LANES], value[LANES], side[LANES];
    EACH(l) {
        low[l] = side[l] = 0.0;
        high[l] = place[l] = h[l];
        above[l] = first[l];
        below[l] = last[l];
        moving[l] = due[l];
    }
    for (int i = 0; i < ROOT_STEPS && any(moving); i++) {
        double at[LANES];
        EACH(l) {
            double next = low[l] + (high[l] - low[l]) * above[l] / (above[l] - below[l]);
            next = next > low[l] ? next : 0.5 * (low[l] + high[l]);
            at[l] = next < high[l] ? next : 0.5 * (low[l] + high[l]);
        }
        sum_series(w->z, at, z);
        sum_series(w->nu, at, nu);
        event_values(form, w, event, z, nu, value);
        EACH(l) {
            double step = fabs(at[l] - place[l]), positive = value[l] > 0.0 ? 1.0 : -1.0;
            double halved = positive == side[l] ? 0.5 : 1.0;
            low[l] = positive > 0.0 ? at[l] : low[l];
            high[l] = positive > 0.0 ? high[l] : at[l];
            below[l] = positive > 0.0 ? halved * below[l] : value[l];
            above[l] = positive > 0.0 ? value[l] : halved * above[l];
            side[l] = positive;
            place[l] = moving[l] > 0.0 ? at[l] : place[l];
            moving[l] = step > 1e-15 * h[l] && high[l] - low[l] > 1e-15 * h[l] ? moving[l] : 0.0;
        }
    }
}

/* Contacts between two steps, and what they have done so far. */
typedef struct {
    double moving[LANES], bad[LANES], steps[LANES];
    double value[MARKS][LANES], passed[MARKS][LANES]; /* of each event: its value; 1: it has been, or cannot come */
    double peak[LANES], depth[LANES], turned[LANES], stopped[LANES]; /* largest force; deepest z; times of turn and stop */
    double z[LANES], nu[LANES], time[LANES], squares[LANES];
} damped_contacts;

/* All lanes at first touch; an incomplete block is filled up with its first impact. longest: a step of an undamped contact's
 * way in on a fixed target. */
static void start_damped(const batch_job *j, const int64_t *index, int count, damped_lanes *restrict w,
                         damped_contacts *restrict s, double *restrict longest) {
    const damped_form *form = &j->damped;
    double m = form->root, e[LANES], reach[LANES];
    memset(s, 0, sizeof *s);
    EACH(l) {
        const film_start *start = &j->start[index[l < count ? l : 0]];
        w->gamma[l] = start->gamma;
        w->damper[l] = start->damping * form->factor;
        w->load[l] = start->load;
        w->stop[l] = start->stop_velocity;
        s->nu[l] = start->nu;
        s->moving[l] = 1.0;
        s->stopped[l] = NAN;
        reach[l] = 0.5 * (start->nu * start->nu) * (form->force + m) / (m * form->stiffness);
        e[l] = 1.0 / (form->force + m);
    }
    power_lanes(reach, e, longest);
    EACH(l) longest[l] *= 1.2 * m / s->nu[l];
    damped_force(form, w, s->z, s->nu, s->peak);
    for (int event = 0; event < MARKS; event++) event_values(form, w, event, s->z, s->nu, s->value[event]);
    EACH(l) { /* a damping force that begins at 0 rises, and an impactor that moves away does not stop */
        s->value[AT_PEAK][l] = form->damping > 0 ? 1.0 : s->value[AT_PEAK][l];
        s->value[AT_RELEASE][l] = 1.0;
        s->passed[AT_STOP][l] = s->value[AT_STOP][l] > 0.0 ? 0.0 : 1.0;
    }
}

/* Lengths of the next steps: a share of the radius within which the last terms of xi' fall, at most `longest`, relative to the velocity that the
 * energy left would give: a contact that creeps ends as exactly as it began. From first touch only every
 * fifth term is there. */
static void step_lengths(const damped_form *form, const damped_lanes *w, double share, const double *restrict longest,
                         double *restrict h) {
    double most[LANES], work[LANES], per[LANES];
    two_powers(w->z[0], 2.0 * form->root / (form->force + form->root) * form->stiffness, form->force + form->root,
               form->stiffness * form->steeper * (2.0 / 3), 3 * form->root, work);
    EACH(l) {
        per[l] = 1.0 / sqrt(w->nu[0][l] * w->nu[0][l] + fabs(work[l]));
        most[l] = -1000.0;
    }
    for (int k = TERMS - 5; k < TERMS; k++) {
        double size[LANES], log[LANES];
        EACH(l) size[l] = fabs(w->y[k][l]) * per[l] + 1e-200;
        log2_lanes(size, log);
        EACH(l) most[l] = log[l] / k > most[l] ? log[l] / k : most[l];
    }
    EACH(l) most[l] = -most[l];
    exp2_lanes(most, h);
    EACH(l) {
        h[l] *= share;
        h[l] = h[l] < longest[l] ? h[l] : longest[l];
    }
}

/* 1 for the lanes in which an event comes within the step at whose end its value is `end`. */
static void marks_due(const damped_contacts *s, int event, const double *restrict end, double *restrict due) {
    EACH(l) {
        due[l] = s->value[event][l] > 0.0 && !(end[l] > 0.0) ? s->moving[l] : 0.0;
        due[l] = s->passed[event][l] > 0.0 ? 0.0 : due[l];
    }
}

/* What an event at `place` shows. */
static void keep_mark(const damped_form *form, damped_lanes *restrict w, damped_contacts *restrict s, int event,
                      const double *restrict due, const double *restrict place) {
    double z[LANES], nu[LANES], after[LANES], force[LANES];
    sum_series(w->z, place, z);
    sum_series(w->nu, place, nu);
    sum_series(w->time, place, after);
    damped_force(form, w, z, nu, force);
    EACH(l) {
        double time = s->time[l] + after[l];
        s->peak[l] = due[l] > 0.0 && event != AT_STOP && force[l] > s->peak[l] ? force[l] : s->peak[l];
        s->depth[l] = due[l] > 0.0 && event == AT_TURN ? z[l] : s->depth[l];
        s->turned[l] = due[l] > 0.0 && event == AT_TURN ? time : s->turned[l];
        s->stopped[l] = due[l] > 0.0 && event == AT_STOP ? time : s->stopped[l];
        s->passed[event][l] = due[l] > 0.0 && event != AT_PEAK ? 1.0 : s->passed[event][l];
    }
}

/* One step, or less of it to the end of contact; h: its length. */
static void step_damped(const damped_form *form, double share, const double *restrict longest, damped_lanes *restrict w,
                        damped_contacts *restrict s, double *restrict h) {
    double z[LANES], nu[LANES], time[LANES], squares[LANES], end[LANES], due[LANES], ended[LANES], place[LANES], turned[LANES];
    memcpy(w->z[0], s->z, sizeof s->z);
    memcpy(w->nu[0], s->nu, sizeof s->nu);
    memset(w->time[0], 0, sizeof w->time[0]);
    memset(w->squares[0], 0, sizeof w->squares[0]);
    motion_terms(form, w);
    step_lengths(form, w, share, longest, h);
    sum_series(w->z, h, z);
    sum_series(w->nu, h, nu);
    event_values(form, w, AT_RELEASE, z, nu, end);
    marks_due(s, AT_RELEASE, end, ended);
    if (any(ended)) {
        event_place(form, w, AT_RELEASE, h, s->value[AT_RELEASE], end, ended, place);
        EACH(l) h[l] = ended[l] > 0.0 ? place[l] : h[l];
        sum_series(w->z, h, z);
        sum_series(w->nu, h, nu);
    }
    memcpy(turned, s->passed[AT_TURN], sizeof turned);
    for (int event = AT_TURN; event < AT_RELEASE; event++) {
        event_values(form, w, event, z, nu, end);
        marks_due(s, event, end, due);
        if (any(due)) {
            event_place(form, w, event, h, s->value[event], end, due, place);
            keep_mark(form, w, s, event, due, place);
        }
        memcpy(s->value[event], end, sizeof end);
    }
    sum_series(w->time, h, time);
    sum_series(w->squares, h, squares);
    EACH(l) {
        int back = turned[l] > 0.0 && (s->value[AT_TURN][l] > 0.0 || (w->load[l] > 0.0 && s->value[AT_PEAK][l] > 0.0));
        back = z[l] >= -END_ROUNDING * s->depth[l] ? back : 1;
        s->bad[l] = s->moving[l] > 0.0 && back ? 1.0 : s->bad[l]; /* the load may turn it, or the steps were too long */
        s->z[l] = s->moving[l] > 0.0 ? z[l] : s->z[l];
        s->nu[l] = s->moving[l] > 0.0 ? nu[l] : s->nu[l];
        s->time[l] += s->moving[l] > 0.0 ? time[l] : 0.0;
        s->squares[l] += s->moving[l] > 0.0 ? squares[l] : 0.0;
        s->steps[l] += s->moving[l];
        s->moving[l] = ended[l] > 0.0 || s->bad[l] > 0.0 || !(h[l] > 0.0) ? 0.0 : s->moving[l];
        s->passed[AT_RELEASE][l] = ended[l] > 0.0 ? 1.0 : s->passed[AT_RELEASE][l];
    }
}

/* From first touch to the end of contact. Lanes that do not end in time, or that a load may turn back, are left to
 * film_marched. */
static void damped_contact_lanes(batch_job *j, const int64_t *index, int count) {
    const damped_form *form = &j->damped;
    damped_lanes w;
    damped_contacts s;
    double longest[LANES], share = RADIUS / j->mesh->loading, depth[LANES], dent[LANES], h[LANES];
    if (form->root == 1 && share > LINEAR_RADIUS) share = LINEAR_RADIUS;
    start_damped(j, index, count, &w, &s, longest);
    for (int32_t i = 0; i < MOST_STEPS * (FEWEST + j->mesh->loading) && any(s.moving); i++) step_damped(form, share, longest, &w, &s, h);
    whole_power(s.depth, form->root, depth);
    whole_power(s.z, form->root, dent);
    for (int l = 0; l < count; l++) {
        film_summary *out = &j->summary[index[l]];
        const film_start *start = &j->start[index[l]];
        double passed = s.passed[AT_TURN][l] * s.passed[AT_RELEASE][l], lost = start->nu - s.nu[l];
        if (s.bad[l] > 0.0 || !(passed > 0.0) || !(s.time[l] <= start->time_limit) || film_grazes(start->load, depth[l], start->nu)) {
            leave_alone(j, index[l]);
            continue;
        }
        out->maximum_force = s.peak[l];
        out->maximum_indentation = depth[l];
        out->time_of_maximum_indentation = s.turned[l];
        out->time_impactor_stops = s.stopped[l];
        out->contact_duration = s.time[l];
        out->permanent_indentation = s.z[l] > 0.0 ? dent[l] : 0.0;
        out->final_velocity = s.nu[l];
        out->shift = start->gamma * (start->load * s.time[l] + lost);
        out->work = 0.5 * lost * (start->nu + s.nu[l]) + start->load * (out->permanent_indentation + out->shift) - start->gamma * s.squares[l];
        out->stage = 0;
        out->lines = (int32_t)s.steps[l];
        j->status[index[l]] = FILM_EVENT;
    }
}

#endif
