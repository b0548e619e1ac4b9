/* The way to the turn in a stage whose force is c + s x + k x^(3/2), x from its beginning, in lanes: by Taylor polynomials of
 * the motion itself, without lines. Internal to film_lanes.c. docs/method.md, section 10. */
#ifndef FILM_LANE_TAYLOR_H
#define FILM_LANE_TAYLOR_H

#include "lanes/film_lane_law.h"

/* Terms of the polynomials; the macros below are for this many. Affects cost only. */
enum { WAY_TERMS = 12 };

/* Length of a step over the radius within which the terms fall: WAY_RADIUS over the segments of a leg, but at least
 * SHORTEST_SHARE, which leaves rounding only. The error of a way is about the 12th power of it. Accuracy and cost:
 * test_a_power_law_beyond_yield_needs_lines_up_to_it_only. */
static const double WAY_RADIUS = 1.3, SHORTEST_SHARE = 0.1;

enum { WAY_STEPS = 60 }; /* to the turn; about 12 of them are needed with SHORTEST_SHARE, longer ways are left to film_marched */
enum { TURN_STEPS = 3 }; /* of Halley's method for the time of the turn */
static const double TURN_SETTLED = 1e-4; /* the last of them, as a fraction of the time: an error of its cube is left */

/* DO(1) ... DO(last), last < 12. If `last` is a constant, the compiler removes the choice and keeps the terms in registers. */
#define UP_TO(last, DO)                                                                                                  \
    if ((last) >= 1) { DO(1) } if ((last) >= 2) { DO(2) } if ((last) >= 3) { DO(3) } if ((last) >= 4) { DO(4) }          \
    if ((last) >= 5) { DO(5) } if ((last) >= 6) { DO(6) } if ((last) >= 7) { DO(7) } if ((last) >= 8) { DO(8) }          \
    if ((last) >= 9) { DO(9) } if ((last) >= 10) { DO(10) } if ((last) >= 11) { DO(11) }

typedef double way_series[WAY_TERMS + 1][GROUP];

/* A group on one step: x = z^2 and dt = z ds, so that x^(3/2) = z^3 and the motion is a power series in s from the beginning of
 * the stage to the turn. The first terms are where it is. */
typedef struct {
    double constant, slope, power; /* c, s, k */
    double gamma[GROUP];
    way_series z, nu, y, time; /* y: the relative velocity */
} way_group;

/* What rough_log2 gives for 1, and how much more it gives for twice a number. */
static const double ROUGH_DOUBLE = 4294967296.0, ROUGH_ONE = 4503599627370496.0 + 1023.0 * 4294967296.0;

/* Term k of all series, and k + 1 of z and nu: z' = y/2, nu' = -F z by s. second, third: z^2 and z^3. stiff: by how much
 * gamma F grows with z. What depends on z_k itself comes last, so that the next term waits for two multiplications and a
 * subtraction alone. */
INLINED void way_term(way_group *restrict w, way_series second, way_series third, const double *restrict stiff, int k) {
    double per = 1.0 / (k + 1), even = k > 0 && k % 2 == 0 ? 0.5 : 0.0, half[GROUP], cubic[GROUP] = {0.0}, fourth[GROUP];
#define OF_SECOND(i) EACH_OF(l) half[l] += w->z[i][l] * w->z[k - (i)][l];
#define OF_THIRD(i) EACH_OF(l) cubic[l] += second[k - (i)][l] * w->z[i][l];
#define OF_FOURTH(i) EACH_OF(l) fourth[l] += second[i][l] * second[k - (i)][l];
    EACH_OF(l) half[l] = even * (w->z[k / 2][l] * w->z[k / 2][l]);
    UP_TO((k - 1) / 2, OF_SECOND)
    UP_TO(k - 1, OF_THIRD)
    EACH_OF(l) {
        double z0 = w->z[0][l], square = z0 * z0, known2 = half[l] + half[l], known3 = cubic[l] + z0 * known2;
        if (k == 0) {
            second[0][l] = square;
            third[0][l] = square * z0;
            w->y[0][l] = w->nu[0][l] - w->gamma[l] * (w->constant + w->slope * square + w->power * third[0][l]);
        } else {
            double known = w->nu[k][l] - w->gamma[l] * (w->slope * known2 + w->power * known3);
            second[k][l] = known2 + 2.0 * z0 * w->z[k][l];
            third[k][l] = known3 + 3.0 * square * w->z[k][l];
            w->y[k][l] = known - stiff[l] * w->z[k][l];
        }
        w->z[k + 1][l] = 0.5 * per * w->y[k][l];
        w->time[k + 1][l] = per * w->z[k][l];
    }
    EACH_OF(l) fourth[l] = even * (second[k / 2][l] * second[k / 2][l]);
    UP_TO((k - 1) / 2, OF_FOURTH)
    EACH_OF(l) {
        double whole = k == 0 ? second[0][l] * second[0][l] : 2.0 * (fourth[l] + second[0][l] * second[k][l]);
        w->nu[k + 1][l] = -per * (w->constant * w->z[k][l] + w->slope * third[k][l] + w->power * whole);
    }
}

CALLED void way_terms(way_group *restrict w) {
    double stiff[GROUP];
    way_series second, third;
    EACH_OF(l) stiff[l] = w->gamma[l] * w->z[0][l] * (2.0 * w->slope + 3.0 * w->power * w->z[0][l]);
#define NEXT_TERM(k) way_term(w, second, third, stiff, k);
    NEXT_TERM(0)
    UP_TO(WAY_TERMS - 1, NEXT_TERM)
}

/* The sums of series at s. Even and odd powers apart, so that neither sum waits for the other. */
INLINED void sum_way(way_series a, const double *restrict s, double *restrict out) {
    EACH_OF(l) {
        double square = s[l] * s[l], even = a[WAY_TERMS][l], odd = a[WAY_TERMS - 1][l];
        for (int k = WAY_TERMS - 2; k > 0; k -= 2) {
            even = even * square + a[k][l];
            odd = odd * square + a[k - 1][l];
        }
        out[l] = (even * square + a[0][l]) + s[l] * odd;
    }
}

/* About log2 x, off by less than 0.09, from its bits: times 2^32, plus ROUGH_ONE. */
INLINED void rough_log2(const double *restrict x, double *restrict out) {
    uint64_t bits[GROUP];
    memcpy(bits, x, sizeof bits);
    EACH_OF(l) bits[l] = bits[l] >> 20 | 0x4330000000000000u;
    memcpy(out, bits, sizeof bits);
}

/* Lengths of steps: a share of the radius within which the last terms of y fall, relative to the velocity that the energy
 * would give. */
CALLED void way_lengths(const way_group *restrict w, double share, double *restrict h) {
    double energy[GROUP], whole[GROUP], least[GROUP];
    uint64_t bits[GROUP];
    EACH_OF(l) {
        double x = w->z[0][l] * w->z[0][l], mean = w->constant + 0.5 * w->slope * x + 0.4 * w->power * (x * w->z[0][l]);
        energy[l] = w->nu[0][l] * w->nu[0][l] + 2.0 * x * mean;
        least[l] = 100.0 * ROUGH_DOUBLE;
    }
    rough_log2(energy, whole);
    for (int k = WAY_TERMS - 4; k < WAY_TERMS; k++) {
        double size[GROUP], log[GROUP];
        EACH_OF(l) size[l] = fabs(w->y[k][l]) + 1e-300;
        rough_log2(size, log);
        EACH_OF(l) {
            double falls = ((whole[l] - ROUGH_ONE) * 0.5 - (log[l] - ROUGH_ONE)) * (1.0 / k);
            least[l] = falls < least[l] ? falls : least[l];
        }
    }
    EACH_OF(l) least[l] += ROUGH_ONE;
    memcpy(bits, least, sizeof bits);
    EACH_OF(l) bits[l] <<= 20; /* back, as if the bits were a logarithm */
    memcpy(h, bits, sizeof bits);
    EACH_OF(l) h[l] *= share;
}

/* Puts the lanes of a group that still move inwards at the end of their step; last: the relative velocity there. */
CALLED void way_step(way_group *restrict w, const double *restrict h, double *restrict time, double *restrict moving,
                     double *restrict last) {
    double z[GROUP], nu[GROUP], after[GROUP];
    sum_way(w->y, h, last);
    sum_way(w->z, h, z);
    sum_way(w->nu, h, nu);
    sum_way(w->time, h, after);
    EACH_OF(l) {
        moving[l] = last[l] > 0.0 ? moving[l] : 0.0;
        w->z[0][l] = moving[l] > 0.0 ? z[l] : w->z[0][l];
        w->nu[0][l] = moving[l] > 0.0 ? nu[l] : w->nu[0][l];
        time[l] += moving[l] > 0.0 ? after[l] : 0.0;
    }
}

/* z and the time since the step began where y = 0: from the root of a parabola, by Halley's method with the y'' of y = 0.
 * missed: 1 where that is not accurate enough. */
CALLED void way_turn(way_group *restrict w, const double *restrict h, const double *restrict last, double *restrict z,
                     double *restrict after, double *restrict missed) {
    double s[GROUP], y[GROUP];
    EACH_OF(l) {
        double y0 = w->y[0][l], y1 = w->y[1][l], per = 1.0 / h[l], bend = (last[l] - y0) * per - y1;
        double square = y1 * y1 - 4.0 * bend * per * y0;
        s[l] = 2.0 * y0 / (sqrt(square > 0.0 ? square : 0.0) - y1);
    }
    for (int i = 0; i < TURN_STEPS; i++) {
        sum_way(w->y, s, y);
        sum_way(w->z, s, z);
        EACH_OF(l) {
            double square = z[l] * z[l], stiff = w->gamma[l] * (w->slope * z[l] + 1.5 * w->power * square);
            double fall = z[l] * (w->constant + square * (w->slope + w->power * z[l])) + stiff * y[l], step = y[l] / fall;
            missed[l] = step * (1.0 - 0.5 * stiff * step);
            s[l] += missed[l];
            z[l] += 0.5 * y[l] * missed[l];
        }
    }
    sum_way(w->time, s, after);
    EACH_OF(l) {
        double far = s[l] <= h[l] ? fabs(missed[l]) : 1e300;
        missed[l] = far < TURN_SETTLED * s[l] ? 0.0 : 1.0;
    }
}

/* A group of lanes, from `from` on, from the beginning of `stage` to the turn in it; xi counts from there. */
static void group_to_turn(const batch_job *j, int32_t stage, int from, lanes *restrict s) {
    const film_function *g = &j->curve->piece[j->curve->stage[stage].first].force;
    double share = WAY_RADIUS / j->mesh->loading, time[GROUP], moving[GROUP], last[GROUP], h[GROUP];
    double z[GROUP], after[GROUP], missed[GROUP], any_moves = 1.0;
    way_group w;
    w.constant = g->constant;
    w.slope = g->slope;
    w.power = g->coefficient;
    if (share < SHORTEST_SHARE) share = SHORTEST_SHARE;
    EACH_OF(l) {
        w.gamma[l] = s->gamma[from + l];
        w.nu[0][l] = s->w[from + l];
        w.z[0][l] = w.time[0][l] = w.y[WAY_TERMS][l] = 0.0;
        time[l] = s->time[from + l];
        moving[l] = 1.0;
    }
    for (int i = 0; i < WAY_STEPS && any_moves > 0.0; i++) {
        way_terms(&w);
        way_lengths(&w, share, h);
        way_step(&w, h, time, moving, last);
        any_moves = 0.0;
        EACH_OF(l) any_moves += moving[l];
    }
    way_turn(&w, h, last, z, after, missed);
    EACH_OF(l) {
        s->bad[from + l] += moving[l] + missed[l];
        s->time[from + l] = time[l] + after[l];
        s->xi[from + l] = z[l] * z[l];
    }
}

/* From the beginning of `stage` to the turn in it. */
static void run_by_powers(const batch_job *j, int32_t stage, lanes *restrict s) {
    double begin = j->curve->stage[stage].begin, end = j->curve->stage[stage].end;
    for (int from = 0; from < LANES; from += GROUP) group_to_turn(j, stage, from, s);
    EACH(l) s->xi[l] += begin;
    law_lanes(j, stage, s->xi, s->force, s->work);
    EACH(l) {
        s->w[l] = s->gamma[l] * s->force[l];
        s->bad[l] = s->xi[l] <= end ? s->bad[l] : 1.0;
    }
}

/* Whether that stage has such a force and film_way_in is not for it. */
static int turns_by_powers(const batch_job *j, int32_t stage) {
    const film_function *g = &j->curve->piece[j->curve->stage[stage].first].force;
    return stage != j->shaped && !j->loaded && j->simple[stage] && !has_way_in(j, stage) && g->coefficient > 0.0 && g->exponent == 1.5;
}

#endif
