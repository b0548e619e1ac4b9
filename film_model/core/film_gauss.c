/* Gauss's rule. docs/method.md, section 10. */
#include "film_batch.h"

enum { NEWTON_STEPS = 8 };

/* Places and weights on 0 .. 1: the roots of Legendre's polynomial, by Newton's method from their asymptotic places. */
static void make_panel(int32_t count, double *at, double *weight) {
    for (int32_t i = 0; i < (count + 1) / 2; i++) {
        double t = cos(3.14159265358979323846 * (i + 0.75) / (count + 0.5)), slope = 0.0;
        for (int step = 0; step < NEWTON_STEPS; step++) {
            double before = 0.0, now = 1.0;
            for (int32_t k = 1; k <= count; k++) {
                double next = ((2 * k - 1) * t * now - (k - 1) * before) / k;
                before = now;
                now = next;
            }
            slope = count * (t * now - before) / (t * t - 1.0);
            t -= now / slope;
            if (fabs(now) < 1e-12 * fabs(slope)) break;
        }
        at[i] = 0.5 * (1.0 - t);
        at[count - 1 - i] = 0.5 * (1.0 + t);
        weight[i] = weight[count - 1 - i] = 1.0 / ((1.0 - t * t) * (slope * slope));
    }
}

void film_make_rule(int32_t segments, gauss_rule *rule) {
    int32_t points = segments + EXTRA_POINTS < MOST_POINTS ? segments + EXTRA_POINTS : MOST_POINTS;
    int32_t panels = (points + PANEL - 1) / PANEL, each = points / panels;
    double at[PANEL], weight[PANEL];
    make_panel(each, at, weight);
    rule->count = panels * each;
    for (int32_t i = 0; i < rule->count; i++) {
        double place = (i / each + at[i % each]) / panels, left = 1.0 - place * place;
        rule->at[i] = place;
        rule->rest[i] = left * left;
        rule->weight[i] = 4.0 * weight[i % each] / panels * place * left;
    }
}
