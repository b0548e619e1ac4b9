/* Normal motions at given times, in lanes, by Runge and Kutta's rule of fourth order. Internal to film_lanes.c. docs/method.md,
 * section 15. */
#ifndef FILM_LANE_MOTION_H
#define FILM_LANE_MOTION_H

#include "lanes/film_lane_law.h"

/* Impacts between two times. leaves: 1 on the branch most ((xi - origin) per)^exponent + shift, else 0, on the loading curve; some, all: as
 * flags of all lanes together. run: of the only impact that has a curve of its own. */
typedef struct {
    const motions_wanted *m;
    double gamma[LANES], load[LANES], damper[LANES], speed[LANES], bad[LANES], leaves[LANES];
    double origin[LANES], per[LANES], exponent[LANES], most[LANES], shift[LANES];
    double xi[LANES], nu[LANES], force[LANES], slope[LANES]; /* slope: of the force without damping on the loading curve, if asked for */
    film_line run;
    int some, all, powers; /* powers: 1 if not all exponents are 3/2 */
} moving_lanes;

enum { SINGLE = 4 }; /* steps over one sample, at first touch */

/* What is left of the velocity where lanes should turn, and of the force where contact should end, at most. */
static const double NEAR = 1e-3;

/* The force on the loading curve, and its slope unless NULL. */
static void cubic_lanes(const law_cubics *law, const double *restrict xi, double *restrict force, double *restrict slope, double *restrict damping) {
    double x[LANES], most[LANES], least[LANES];
    uint64_t bits[LANES];
    int64_t row[LANES], first[LANES];
    EACH(l) {
        most[l] = xi[l] < law->most ? xi[l] : law->most;
        x[l] = most[l], least[l] = law->least[0], first[l] = law->first[0];
    }
    for (int32_t k = 1; k < law->stages; k++) EACH(l) {
        x[l] = most[l] >= law->begin[k] ? most[l] - law->begin[k] : x[l];
        least[l] = most[l] >= law->begin[k] ? law->least[k] : least[l];
        first[l] = most[l] >= law->begin[k] ? law->first[k] : first[l];
    }
    EACH(l) x[l] = x[l] > least[l] ? x[l] : least[l];
    memcpy(bits, x, sizeof bits);
    EACH(l) row[l] = (int64_t)(bits[l] >> CUBIC_SHIFT) - first[l];
    for (int l = 0; l < LANES; l++) {
        const law_cubic *at = &law->row[row[l]];
        const double *c = at->force;
        double w = x[l] - at->from;
        force[l] = c[0] + w * (c[1] + w * (c[2] + w * c[3]));
        if (slope) slope[l] = c[1] + w * (2.0 * c[2] + w * (3.0 * c[3]));
    }
    for (int l = 0; law->damped && l < LANES; l++) {
        const double *c = law->damping[row[l]];
        double w = x[l] - law->row[row[l]].from;
        damping[l] = c[0] + w * (c[1] + w * (c[2] + w * c[3]));
    }
}

static void branch_lanes(const moving_lanes *restrict s, const double *restrict xi, double *restrict force) {
    double x[LANES], power[LANES], other[LANES];
    EACH(l) {
        x[l] = (xi[l] - s->origin[l]) * s->per[l];
        x[l] = x[l] > 0.0 ? x[l] : 0.0;
        power[l] = x[l] * sqrt(x[l]);
    }
    if (s->powers) {
        power_lanes(x, s->exponent, other);
        EACH(l) power[l] = s->exponent[l] == 1.5 ? power[l] : other[l];
    }
    EACH(l) {
        double f = s->most[l] * power[l] + s->shift[l];
        f = f > 0.0 ? f : 0.0;
        force[l] = s->leaves[l] > 0.0 ? f : force[l];
    }
}

/* The stage of a curve that holds xi. */
static int32_t stage_at(const film_curve *curve, double xi) {
    int32_t k = 0;
    while (k + 1 < curve->stages && xi >= curve->stage[k].end) k++;
    return k;
}

/* cubic_lanes and branch_lanes of the only impact, on its own curve. */
static void force_on_curve(const film_curve *curve, const film_line *run, double xi, double *force, double *slope, double *damping) {
    film_line at = *run;
    double work;
    if (at.branch >= 0) at.branch = stage_at(curve, xi);
    if (at.branch >= 0 && curve->compliance == 0.0) *force = value_at(&piece_at(curve, at.branch, xi)->force, xi);
    else law_at(curve, &at, xi, force, &work);
    if (slope) *slope = film_contact_slope(curve, &at, xi);
    *damping = at.branch >= 0 && curve->stage[at.branch].damped ? value_at(&piece_at(curve, at.branch, xi)->damping, xi) : 0.0;
}

/* The force at indentations and velocities, and the slope of the loading curve unless NULL. */
static void moving_force(const moving_lanes *restrict s, const double *restrict xi, const double *restrict nu, double *restrict force,
                         double *restrict slope) {
    const law_cubics *law = s->m->law;
    double c[LANES] = {0.0};
    if (!law) {
        force_on_curve(s->m->curve, &s->run, xi[0], force, slope, c);
    } else {
        if (!s->all) cubic_lanes(law, xi, force, slope, c);
        if (s->some) branch_lanes(s, xi, force);
    }
    if (!s->m->curve->stage[0].damped) return;
    EACH(l) {
        double own = s->damper[l] * c[l];
        force[l] += own * (nu[l] - s->gamma[l] * force[l]) / (1.0 + s->gamma[l] * own);
    }
}

/* A share of a step from where the lanes are, at the rates there are at some force and velocity. */
static void move_part(const moving_lanes *restrict s, const double *restrict h, double share, const double *restrict nu,
                      const double *restrict force, double *restrict xi_at, double *restrict nu_at) {
    EACH(l) {
        double part = share * h[l];
        xi_at[l] = s->xi[l] + part * (nu[l] - s->gamma[l] * force[l]);
        nu_at[l] = s->nu[l] + part * (s->load[l] - force[l]);
    }
}

static void move_step(moving_lanes *restrict s, const double *restrict h) {
    double xi[LANES], second[LANES], third[LANES], last[LANES], f2[LANES], f3[LANES], f4[LANES];
    move_part(s, h, 0.5, s->nu, s->force, xi, second);
    moving_force(s, xi, second, f2, NULL);
    move_part(s, h, 0.5, second, f2, xi, third);
    moving_force(s, xi, third, f3, NULL);
    move_part(s, h, 1.0, third, f3, xi, last);
    moving_force(s, xi, last, f4, NULL);
    EACH(l) {
        double nu = (s->nu[l] + 2.0 * (second[l] + third[l]) + last[l]) * (1.0 / 6);
        double force = (s->force[l] + 2.0 * (f2[l] + f3[l]) + f4[l]) * (1.0 / 6);
        s->xi[l] += h[l] * (nu - s->gamma[l] * force);
        s->nu[l] += h[l] * (s->load[l] - force);
    }
    moving_force(s, s->xi, s->nu, s->force, s->m->slope ? s->slope : NULL);
}

/* Sample k of all lanes. */
static void put_sample(const motions_wanted *m, int count, int64_t k, const double *xi, const double *force, const double *slope) {
    for (int l = 0; l < count; l++) {
        m->force[l * m->samples + k] = force[l], m->depth[l * m->samples + k] = xi[l] - m->curve->compliance * force[l];
        if (m->slope) m->slope[l * m->samples + k] = slope[l];
    }
}

/* A step between samples, and its cubics: where it began, at which rates, in how much time, and after which share of that a sample lies
 * in between. */
typedef struct {
    double xi[LANES], nu[LANES], rate[LANES], pull[LANES], h[LANES], share[LANES];
} knot_step;

/* From sample k over `each` of them; an incomplete block is filled up with its first impact. The first step of damped contacts is in four,
 * as a damping force may begin as a root of time. */
static void step_between(const motions_wanted *m, moving_lanes *restrict s, int count, int64_t k, int each, knot_step *restrict p) {
    double h[LANES];
    int parts = k == 0 && m->curve->stage[0].damped ? 4 : 1;
    for (int l = 0; l < LANES; l++) {
        const double *time = m->times + (l < count ? l : 0) * m->samples + k;
        p->h[l] = time[each] - time[0];
        p->share[l] = (time[1] - time[0]) / p->h[l];
    }
    memcpy(p->xi, s->xi, sizeof p->xi);
    memcpy(p->nu, s->nu, sizeof p->nu);
    EACH(l) p->rate[l] = s->nu[l] - s->gamma[l] * s->force[l], p->pull[l] = s->load[l] - s->force[l];
    for (int i = 0; i < parts; i++) {
        double share = (double)(3 * i * i + 3 * i + 1) / (parts * parts * parts); /* of cubes */
        EACH(l) h[l] = share * p->h[l];
        move_step(s, h);
    }
}

/* The cubic between two values, at a share of the step between. rate, last: their rates, over the step. */
INLINED double in_step(double share, double before, double after, double rate, double last) {
    double way = after - before;
    return before + share * (rate + share * (3.0 * way - 2.0 * rate - last + share * (rate + last - 2.0 * way)));
}

/* The sample in the midst of a step. */
static void put_between(const motions_wanted *m, const moving_lanes *restrict s, int count, int64_t k, const knot_step *restrict p) {
    double xi[LANES], nu[LANES], force[LANES], slope[LANES];
    EACH(l) {
        double rate = s->nu[l] - s->gamma[l] * s->force[l], pull = s->load[l] - s->force[l];
        xi[l] = in_step(p->share[l], p->xi[l], s->xi[l], p->h[l] * p->rate[l], p->h[l] * rate);
        nu[l] = in_step(p->share[l], p->nu[l], s->nu[l], p->h[l] * p->pull[l], p->h[l] * pull);
    }
    moving_force(s, xi, nu, force, m->slope ? slope : NULL);
    put_sample(m, count, k, xi, force, slope);
}

/* A leg from sample `first` to `last`, by steps over two samples but for the first ones, and of damped contacts. */
static void move_leg(const motions_wanted *m, moving_lanes *restrict s, int count, int64_t first, int64_t last) {
    knot_step p;
    int damped = m->curve->stage[0].damped;
    put_sample(m, count, first, s->xi, s->force, s->slope);
    for (int64_t k = first; k < last;) {
        int each = damped || k < SINGLE || k + 1 == last ? 1 : 2;
        step_between(m, s, count, k, each, &p);
        if (each == 2) put_between(m, s, count, k + 1, &p);
        k += each;
        put_sample(m, count, k, s->xi, s->force, s->slope);
    }
}

static void touch_lanes(const motions_wanted *m, moving_lanes *restrict s) {
    EACH(l) s->xi[l] = 0.0, s->nu[l] = s->speed[l];
    moving_force(s, s->xi, s->nu, s->force, m->slope ? s->slope : NULL);
}

/* When lanes leave the first stage of the law, by Newton's method on the cubics of steps: kinks[3 l] of lane l. */
static void find_kinks(const motions_wanted *m, moving_lanes *restrict s, int count, double *kinks) {
    double end = m->curve->stage[0].end;
    int64_t knots = m->samples / 2 - 1;
    int left = count;
    knot_step p;
    touch_lanes(m, s);
    for (int64_t k = 0, each; k < knots && left > 0; k += each) {
        each = k < SINGLE || k + 1 == knots ? 1 : 2;
        step_between(m, s, count, k, (int)each, &p);
        for (int l = 0; l < count; l++) {
            if (!(p.xi[l] <= end && s->xi[l] > end)) continue;
            double way = s->xi[l] - p.xi[l], rate = p.h[l] * p.rate[l], last = p.h[l] * (s->nu[l] - s->gamma[l] * s->force[l]), x = (end - p.xi[l]) / way;
            double two = 3.0 * way - 2.0 * rate - last, three = rate + last - 2.0 * way;
            for (int i = 0; i < 4; i++) x -= (in_step(x, p.xi[l], s->xi[l], rate, last) - end) / (rate + x * (2.0 * two + 3.0 * three * x));
            kinks[3 * l] = m->times[l * m->samples + k] + p.h[l] * x;
            left--;
        }
    }
}

/* All lanes at rest where they turn, on the branches along which they leave; bad: of those that are not near a turn. */
static void turn_lanes(const motions_wanted *m, moving_lanes *restrict s) {
    EACH(l) {
        s->bad[l] = fabs(s->nu[l] - s->gamma[l] * s->force[l]) <= NEAR * s->speed[l] ? s->bad[l] : 1.0;
        s->damper[l] = 0.0; /* no damping at rest */
    }
    moving_force(s, s->xi, s->nu, s->force, m->slope ? s->slope : NULL);
    s->all = 1;
    for (int l = 0; l < LANES; l++) {
        film_line line = {.branch = stage_at(m->curve, s->xi[l])};
        if (!(s->xi[l] > 0.0) || film_open_branch(m->curve, &line, s->xi[l], s->force[l]) < 0) s->bad[l] = 1.0;
        s->nu[l] = s->gamma[l] * s->force[l];
        s->leaves[l] = line.branch == FILM_BRANCH ? 1.0 : 0.0;
        s->origin[l] = line.xi_origin, s->per[l] = line.per_recovery, s->exponent[l] = line.exponent;
        s->most[l] = line.f_max, s->shift[l] = line.f_shift, s->run = line;
        if (s->leaves[l] > 0.0) s->some = 1;
        else s->all = 0;
        s->powers |= s->leaves[l] > 0.0 && line.exponent != 1.5;
    }
}

/* Motions of up to LANES impacts. bad: 1 of those that do not turn once, or whose contact does not end when it should. */
static void record_lanes(const motions_wanted *m, int count, double *bad) {
    moving_lanes s;
    int64_t knots = m->samples / 2 - 1;
    double peak[LANES], deepest[LANES], damper[LANES];
    memset(&s, 0, sizeof s);
    s.m = m;
    for (int l = 0; l < LANES; l++) {
        const film_start *start = &m->start[l < count ? l : 0];
        double *legs = &m->legs[l < count ? 3 * l : 0];
        s.gamma[l] = start->gamma, s.load[l] = start->load, s.speed[l] = start->nu, s.damper[l] = start->damping;
        s.bad[l] = legs[1] < INFINITY ? 0.0 : 1.0;
        legs[2] = 0.0;
    }
    memcpy(damper, s.damper, sizeof damper);
    if (m->kink) find_kinks(m, &s, count, &m->legs[2]);
    for (int l = 0; l < count; l++) film_bend_times(knots, &m->legs[3 * l], m->times + l * m->samples);
    touch_lanes(m, &s);
    move_leg(m, &s, count, 0, knots);
    turn_lanes(m, &s);
    memcpy(s.damper, damper, sizeof damper);
    memcpy(peak, s.force, sizeof peak);
    memcpy(deepest, s.xi, sizeof deepest);
    move_leg(m, &s, count, knots + 1, m->samples - 1);
    EACH(l) {
        double lost = fabs(s.force[l]) <= NEAR * peak[l] ? s.bad[l] : 1.0;
        bad[l] = s.xi[l] < deepest[l] ? lost : 1.0;
    }
}

#endif
