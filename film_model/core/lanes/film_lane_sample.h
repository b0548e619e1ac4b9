/* Samples of motions, in lanes. Internal to film_lanes.c. Each lane is a time, on a line of its own; operations and their
 * order are those of film_evaluate; so are the bits. docs/method.md, sections 3 and 10. */
#ifndef FILM_LANE_SAMPLE_H
#define FILM_LANE_SAMPLE_H

#include "lanes/film_lane_law.h"

#include "march/film_line.h"

typedef struct {
    const film_line *line[LANES];
    double tau[LANES], y0[LANES], phi[LANES], kappa[LANES], a[LANES]; /* times on the lines, and the motion there */
    double xi0[LANES], nu0[LANES], shift0[LANES], gamma[LANES], load[LANES], mass[LANES], phi0[LANES], kappa0[LANES];
    double x[LANES], y[LANES], xi[LANES], rate[LANES], force[LANES], nu[LANES], shift[LANES];
} sampled;

/* Lane l is at a time on a line, often that of the lane before. */
static void put_line(sampled *s, int l, const film_line *line, double time) {
    int same = l > 0 && s->line[l - 1] == line;
    motion m = {0.0, 0.0, 0.0, 0.0};
    if (!same) m = motion_from(1.0, line->nu, line->gamma, line->load, line->phi, line->kappa, line->damping);
    s->line[l] = line;
    s->tau[l] = time - line->time;
    s->y0[l] = same ? s->y0[l - 1] : m.y0;
    s->phi[l] = same ? s->phi[l - 1] : m.phi;
    s->kappa[l] = same ? s->kappa[l - 1] : m.kappa;
    s->a[l] = same ? s->a[l - 1] : m.a;
    s->xi0[l] = line->xi;
    s->nu0[l] = line->nu;
    s->shift0[l] = line->shift;
    s->gamma[l] = line->gamma;
    s->load[l] = line->load;
    s->mass[l] = 1.0 + line->gamma * line->damping;
    s->phi0[l] = line->phi;
    s->kappa0[l] = line->kappa;
}

/* motion_at: in lanes where the series is accurate enough. */
static void move_lanes(sampled *restrict s) {
    double b[LANES], c[LANES], before[LANES], last[LANES], small[LANES], going[LANES], unfit[LANES];
    EACH(l) {
        double tau = s->tau[l];
        b[l] = -2.0 * s->a[l] * tau;
        c[l] = -s->kappa[l] * tau * tau;
        before[l] = s->y0[l];
        last[l] = (-s->phi[l] - 2.0 * s->a[l] * s->y0[l]) * tau;
        small[l] = 1e-17 * (fabs(before[l]) + fabs(last[l]));
        s->y[l] = before[l] + last[l];
        s->x[l] = before[l] + 0.5 * last[l];
        going[l] = fabs(b[l]) <= 1.0 ? 1.0 : 0.0;
        going[l] = fabs(c[l]) <= 1.0 ? going[l] : 0.0;
        unfit[l] = 1.0 - going[l];
    }
    for (int k = 2; k < SERIES_END; k += 2) {
        double by0 = PER_FACTORIAL[k], by1 = PER_FACTORIAL[k + 1], by2 = PER_FACTORIAL[k + 2];
        EACH(l) {
            double p = b[l] * b[l] + c[l], r = b[l] * c[l], next = b[l] * last[l] + c[l] * before[l];
            last[l] = p * last[l] + r * before[l];
            before[l] = next;
            double y = s->y[l] + (before[l] * by0 + last[l] * by1), x = s->x[l] + (before[l] * by1 + last[l] * by2);
            s->y[l] = going[l] > 0.0 ? y : s->y[l];
            s->x[l] = going[l] > 0.0 ? x : s->x[l];
            going[l] = (fabs(before[l]) + fabs(last[l])) * by1 <= small[l] ? 0.0 : going[l];
        }
        if (!any(going)) break;
    }
    EACH(l) s->x[l] *= s->tau[l];
    if (any(unfit)) {
        for (int l = 0; l < LANES; l++) {
            motion m = {s->y0[l], s->phi[l], s->kappa[l], s->a[l]};
            if (unfit[l] > 0.0) motion_at(&m, s->tau[l], &s->x[l], &s->y[l]);
        }
    }
}

/* power_of. */
static void same_power_lanes(double exponent, const double *restrict x, double *restrict out) {
    if (exponent == 0.5) {
        EACH(l) out[l] = sqrt(x[l]);
    } else if (exponent == 0.25) {
        EACH(l) out[l] = sqrt(sqrt(x[l]));
    } else if (exponent == 1.5 || exponent == 1.0 || exponent == 2.0) {
        power_lanes_of(x, exponent, out);
    } else {
        for (int l = 0; l < LANES; l++) out[l] = pow(x[l], exponent);
    }
}

/* value_at. */
static void same_value_lanes(const film_function *g, const double *restrict xi, double *restrict out) {
    double z[LANES], b1[LANES] = {0.0}, b2[LANES] = {0.0};
    variable_lanes(g, xi, z);
    if (g->form == FILM_POWER) {
        if (g->coefficient != 0.0) same_power_lanes(g->exponent, z, b1);
        EACH(l) out[l] = g->constant + g->slope * z[l] + g->coefficient * b1[l];
        for (int l = 0; l < LANES && g->square != 0.0; l++) out[l] += g->square * (z[l] * z[l]);
        return;
    }
    for (int k = g->terms - 1; k > 0; k--) {
        double term = g->series[k];
        EACH(l) {
            double b = 2.0 * z[l] * b1[l] - b2[l] + term;
            b2[l] = b1[l];
            b1[l] = b;
        }
    }
    EACH(l) out[l] = z[l] * b1[l] - b2[l] + g->series[0];
}

enum { ON_BRANCH = -1, ALONE = -2 }; /* where a lane is: or the number of its piece */

/* The force where a lane is ALONE: film_evaluate. */
static double force_alone(const film_curve *curve, const film_line *line, double xi, double nu) {
    double force, work;
    law_at(curve, line, xi, &force, &work);
    return line->damper > 0.0 ? fmax(total_force(line, damping_at(curve, line, xi), force, nu), 0.0) : force;
}

/* The force of all lanes, as if they were on one piece. */
static void piece_force_lanes(const film_piece *piece, const sampled *restrict s, double damper, double *restrict force) {
    double c[LANES];
    same_value_lanes(&piece->force, s->xi, force);
    if (!(damper > 0.0)) return;
    same_value_lanes(&piece->damping, s->xi, c);
    EACH(l) {
        double f = force[l], own = damper * c[l], damped = f + own * (s->nu[l] - s->gamma[l] * f) / (1.0 + s->gamma[l] * own);
        damped = own == 0.0 ? f : damped;
        force[l] = damped > 0.0 ? damped : 0.0;
    }
}

/* The same on the unloading branch of a line. */
static void branch_force_lanes(const film_line *line, const double *restrict xi, double *restrict force) {
    double x[LANES], power[LANES];
    EACH(l) {
        x[l] = (xi[l] - line->xi_origin) * line->per_recovery;
        x[l] = x[l] > 0.0 ? x[l] : 0.0;
    }
    same_power_lanes(line->exponent, x, power);
    EACH(l) {
        double f = (x[l] > 0.0 ? line->f_max * power[l] : 0.0) + line->f_shift;
        force[l] = f > 0.0 ? f : 0.0;
    }
}

/* Whether two lines are of one unloading branch. */
static int same_branch(const film_line *a, const film_line *b) {
    return a->xi_origin == b->xi_origin && a->per_recovery == b->per_recovery && a->exponent == b->exponent &&
           a->f_max == b->f_max && a->f_shift == b->f_shift;
}

/* The forces, one piece or branch after another. */
static void force_lanes(const film_curve *curve, sampled *restrict s) {
    int32_t at[LANES];
    double done[LANES] = {0.0}, force[LANES];
    for (int l = 0; l < LANES; l++) {
        const film_line *line = s->line[l];
        at[l] = ALONE;
        if (curve->compliance != 0.0) continue;
        if (line->branch == FILM_BRANCH && line->damper == 0.0 && line->work_free == 0.0) at[l] = ON_BRANCH;
        else if (line->branch >= 0) at[l] = (int32_t)(piece_at(curve, line->branch, s->xi[l]) - curve->piece);
    }
    for (int l = 0; l < LANES; l++) {
        const film_line *line = s->line[l];
        if (done[l] > 0.0) continue;
        if (at[l] == ALONE) {
            s->force[l] = force_alone(curve, line, s->xi[l], s->nu[l]);
            continue;
        }
        if (at[l] == ON_BRANCH) branch_force_lanes(line, s->xi, force);
        else piece_force_lanes(&curve->piece[at[l]], s, line->damper, force);
        for (int k = l; k < LANES; k++) {
            const film_line *other = s->line[k];
            int same = other == line || (at[k] == ON_BRANCH ? same_branch(line, other) : line->damper == other->damper);
            if (at[k] != at[l] || !same) continue;
            s->force[k] = force[k];
            done[k] = 1.0;
        }
    }
}

/* A block of samples whose lines are in s. */
static void evaluate_lanes(const film_curve *curve, sampled *restrict s) {
    move_lanes(s);
    EACH(l) {
        s->nu[l] = s->y[l] * s->mass[l] + s->gamma[l] * (s->phi0[l] + s->kappa0[l] * s->x[l]);
        s->xi[l] = s->xi0[l] + s->x[l];
    }
    force_lanes(curve, s);
    EACH(l) {
        s->rate[l] = s->nu[l] - s->gamma[l] * s->force[l];
        s->shift[l] = s->shift0[l] + s->gamma[l] * (s->load[l] * s->tau[l] - (s->nu[l] - s->nu0[l]));
    }
    for (int l = 0; l < LANES; l++) {
        if (s->line[l]->branch == FILM_FREE) s->shift[l] = s->shift0[l] + 0.0;
        if (curve->compliance == 0.0) continue;
        double values[5] = {s->xi[l], s->rate[l], s->force[l], s->nu[l], s->shift[l]};
        film_split_off_spring(curve, s->line[l], values);
        s->xi[l] = values[0];
        s->rate[l] = values[1];
        s->shift[l] = values[4];
    }
}

enum { FEW = 8 }; /* part of a block that takes as long */

static void sample_lanes(const film_curve *curve, const film_line *recorded, int32_t line_count, const double *times,
                         int64_t count, double *values, int64_t stride) {
    sampled s;
    int32_t at = 0;
    for (int64_t first = 0; first < count; first += LANES) {
        int64_t own = count - first < LANES ? count - first : LANES;
        size_t size = (size_t)own * sizeof *values;
        for (int l = 0; l < LANES; l++) {
            double time = times[first + (l < own ? l : own - 1)];
            while (at + 1 < line_count && recorded[at + 1].time <= time) at++;
            put_line(&s, l, &recorded[at], time);
        }
        if (own * FEW < LANES) { /* sooner one by one */
            for (int64_t l = 0; l < own; l++) {
                double of[5];
                film_evaluate(curve, s.line[l], s.tau[l], of);
                for (int k = 0; k < 5; k++) values[k * stride + first + l] = of[k];
            }
            continue;
        }
        evaluate_lanes(curve, &s);
        memcpy(values + first, s.xi, size);
        memcpy(values + stride + first, s.rate, size);
        memcpy(values + 2 * stride + first, s.force, size);
        memcpy(values + 3 * stride + first, s.nu, size);
        memcpy(values + 4 * stride + first, s.shift, size);
    }
}

#endif
