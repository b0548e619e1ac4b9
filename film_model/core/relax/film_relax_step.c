/* One step of a relaxing contact: its force by collocation, and the memory of the way in. docs/method.md, section 14. */
#include "modal/film_modal_parts.h"
#include "relax/film_relax_parts.h"

#include <math.h>
#include <string.h>

/* Largest change of a force in the last round of the iteration, over the scale of the forces. */
static const double SETTLED = 1e-14;

/* Rounds of the iteration: a step for which more are needed is too long. */
enum { ROUNDS = 25, BISECTIONS = 60 };

/* Implicit steps in which a free surface is followed; more of them leave less. */
enum { RECOVERY = 64 };

/* Below this the functions come from a series, and the recursion downwards; above it from exp(), and upwards. */
static const double SERIES_ARGUMENT = 2.0;

/* Distance of t1, as an integral of e d(xi) over the depth, from which one correction of first order leaves 1e-14. */
static const double NEAR = 1e-8;

/* ---------------------------------------------------------------- functions */

/* hat[m] = m! phi_m(-z): exp(-z) at m = 0, and 1 at z = 0 for all m. */
static void hats(double z, double hat[6]) {
    static const double series[] = { /* 5!/(5 + k)! */
        1.0, 0.16666666666666666, 0.023809523809523808, 0.002976190476190476, 0.00033068783068783067,
        3.306878306878307e-05, 3.006253006253006e-06, 2.505210838544172e-07, 1.9270852604185938e-08, 1.376489471727567e-09,
        9.17659647818378e-11, 5.735372798864862e-12, 3.373748705214625e-13, 1.8743048362303472e-14, 9.864762295949196e-16,
        4.932381147974598e-17, 2.348752927606951e-18, 1.0676149670940688e-19, 4.641804204756821e-21, 1.934085085315342e-22,
        7.736340341261368e-24};
    if (z < SERIES_ARGUMENT) {
        double sum = 0.0;
        for (int k = z < 0.05 ? 7 : z < 0.5 ? 12 : 20; k >= 0; k--) sum = series[k] - z * sum;
        hat[5] = sum;
        hat[4] = 1.0 - z * sum * (1.0 / 5.0);
        hat[3] = 1.0 - z * hat[4] * (1.0 / 4.0);
        hat[2] = 1.0 - z * hat[3] * (1.0 / 3.0);
        hat[1] = 1.0 - z * hat[2] * (1.0 / 2.0);
        hat[0] = 1.0 - z * hat[1];
        return;
    }
    hat[0] = exp(-z);
    for (int m = 0; m < 5; m++) hat[m + 1] = (m + 1) * (1.0 - hat[m]) / z;
}

static double polynomial(const double *a, int degree, double u) {
    double sum = a[degree];
    for (int m = degree - 1; m >= 0; m--) sum = sum * u + a[m];
    return sum;
}

/* The cubic through values at the nodes. */
static void cubic(const double *value, double *a) {
    for (int m = 0; m < NODES; m++) {
        a[m] = 0.0;
        for (int j = 0; j < NODES; j++) a[m] += LAGRANGE[j][m] * value[j];
    }
}

static double power(double xi) { return xi > 0.0 ? xi * sqrt(xi) : 0.0; }

/* ---------------------------------------------------------------- motion in a step */

/* Integrals over 0 .. u of the force, and of that integral. */
static void impulses(const film_relax_step *step, double u, double *once, double *twice) {
    const double *a = step->force;
    *once = u * (a[0] + u * (a[1] / 2.0 + u * (a[2] / 3.0 + u * a[3] / 4.0)));
    *twice = u * u * (a[0] / 2.0 + u * (a[1] / 6.0 + u * (a[2] / 12.0 + u * a[3] / 20.0)));
}

static double depth_at(const film_relax_step *step, double gamma, double u) {
    double once, twice, h = step->h;
    impulses(step, u, &once, &twice);
    return step->xi + h * (step->nu * u - gamma * once + h * (0.5 * step->load * u * u - twice));
}

static void fill_rate(film_relax_step *step, double gamma) {
    const double *a = step->force;
    step->rate[0] = step->nu - gamma * a[0];
    for (int m = 1; m < 5; m++)
        step->rate[m] = step->h * ((m == 1 ? step->load : 0.0) - a[m - 1] / m) - (m < 4 ? gamma * a[m] : 0.0);
}

void film_relax_at(const film_relax_step *step, double gamma, double tau, double values[5]) {
    double once, twice, u = tau / step->h, h = step->h;
    impulses(step, u, &once, &twice);
    values[0] = depth_at(step, gamma, u);
    values[1] = polynomial(step->rate, 4, u);
    values[2] = polynomial(step->force, 3, u);
    values[3] = step->nu + h * (step->load * u - once);
    values[4] = step->shift + gamma * h * once;
}

double film_relax_work(const film_relax_step *step, double tau) {
    double u = tau / step->h, sum = 0.0, product[8] = {0.0};
    for (int m = 0; m < 4; m++)
        for (int k = 0; k < 5; k++) product[m + k] += step->force[m] * step->rate[k];
    for (int m = 7; m >= 0; m--) sum = sum * u + product[m] / (m + 1);
    return step->h * u * sum;
}

double film_relax_falls(const double *a, double from, double to) {
    if (polynomial(a, 4, to) > 0.0) return 2.0;
    double low = from, high = to;
    for (int k = 0; k < BISECTIONS; k++) {
        double middle = 0.5 * (low + high);
        if (polynomial(a, 4, middle) > 0.0) low = middle;
        else high = middle;
    }
    return high;
}

/* ---------------------------------------------------------------- memory */

void film_relax_memory(const film_relaxation *law, const film_relax_step *step, double tau, int way_in, double *q, double *p) {
    double u = tau / step->h, hat[6];
    for (int32_t i = 0; i < law->terms; i++) {
        double grown = 0.0, gone = 0.0, at = 1.0;
        hats(law->rate[i] * tau, hat);
        for (int m = 0; m < 5; m++) {
            at *= u;
            grown += step->grown[m + 1] * at * hat[m + 1];
            gone += step->rate[m] * at * hat[m + 1] / (m + 1);
        }
        q[i] = way_in ? hat[0] * step->q[i] + grown : 0.0;
        p[i] = hat[0] * step->p[i] + step->h * gone;
    }
}

/* Depth after a time without force, and p then: rest w + sum of share_i p_i stays 0, and p_i' = w' - rate_i p_i. w is a sum of
 * falling exponentials, each of which an implicit Euler step makes fall more slowly. */
static double recovered(const film_relaxation *law, double *p, double time) {
    double w = 0.0, h = time / RECOVERY;
    for (int32_t i = 0; i < law->terms; i++) w -= law->share[i] * p[i] / law->rest;
    for (int k = 0; k < RECOVERY && h > 0.0; k++) {
        double force = law->rest * w, stiffness = law->rest;
        for (int32_t i = 0; i < law->terms; i++) {
            p[i] /= 1.0 + law->rate[i] * h;
            force += law->share[i] * p[i];
            stiffness += law->share[i] / (1.0 + law->rate[i] * h);
        }
        w -= force / stiffness;
        for (int32_t i = 0; i < law->terms; i++) p[i] -= force / stiffness / (1.0 + law->rate[i] * h);
    }
    return w;
}

double film_relax_left(const film_relax *s, const film_relax_step *steps) {
    film_relax after = *s;
    double now = s->time + s->tau;
    if (s->branch != FILM_FREE || s->contacts == 0) return 0.0;
    double left = recovered(&s->law, after.old, now - s->begun);
    if (s->steps == 0) return left;
    return left + recovered(&s->law, after.p, now - steps[s->steps - 1].time - steps[s->steps - 1].length);
}

void film_relax_carry(film_relax *s, const film_relax_step *steps) {
    double now = s->time + s->tau;
    if (s->contacts == 0) return;
    recovered(&s->law, s->old, now - s->begun);
    if (s->steps > 0) recovered(&s->law, s->p, now - steps[s->steps - 1].time - steps[s->steps - 1].length);
    for (int32_t i = 0; i < s->law.terms; i++) s->old[i] += s->p[i];
}

/* The step of the way in that holds a time. */
static const film_relax_step *step_at(const film_relax *s, const film_relax_step *steps, double time) {
    int32_t low = 0, high = s->approach;
    while (high - low > 1) {
        int32_t middle = (low + high) / 2;
        if (steps[middle].time <= time) low = middle;
        else high = middle;
    }
    return &steps[low];
}

/* What the way in up to t1 leaves at a later time. push: integral of e d(xi); force: of e d(xi^1.5); by_match: d push/d t1. */
typedef struct {
    double push, force, by_match, xi;
} remembered;

static remembered remember(const film_relax *s, const film_relax_step *steps, double t1, double time) {
    const film_relax_step *step = step_at(s, steps, t1);
    double q[FILM_RELAXATIONS], p[FILM_RELAXATIONS], tau = fmin(fmax(t1 - step->time, 0.0), step->length), e = s->law.rest;
    remembered found;
    film_relax_memory(&s->law, step, tau, 1, q, p);
    found.xi = fmax(depth_at(step, s->gamma, tau / step->h), 0.0);
    found.push = s->law.rest * found.xi;
    found.force = s->law.rest * polynomial(step->grown, 5, tau / step->h);
    for (int32_t i = 0; i < s->law.terms; i++) {
        double left = s->law.share[i] * exp(-s->law.rate[i] * (time - t1));
        e += left;
        found.push += left * p[i];
        found.force += left * q[i];
    }
    found.by_match = e * fmax(polynomial(step->rate, 4, tau / step->h), 0.0);
    return found;
}

/* The force at a time on the way out, with `push` the integral of e d(xi) since first touch; *t1: guessed, and found. Near
 * the root d(force) = 1.5 sqrt(xi) d(push), which does not need the slope: it is 0 at the turn. */
static double force_out(const film_relax *s, const film_relax_step *steps, double time, double push, double *t1) {
    double low = s->begun, high = s->turned, root, off;
    remembered at = {0.0, 0.0, 0.0, 0.0};
    if (!(push > 0.0)) {
        *t1 = low;
        return 0.0;
    }
    for (int k = 0; k < BISECTIONS; k++) {
        if (!(*t1 > low && *t1 < high)) *t1 = 0.5 * (low + high);
        at = remember(s, steps, *t1, time);
        off = at.push - push;
        if (fabs(off) <= NEAR * push) break;
        if (off > 0.0) high = *t1;
        else low = *t1;
        if (!(high - low > 1e-15 * high)) break;
        *t1 -= off / at.by_match; /* outside the bracket, or not finite: bisected above */
    }
    root = sqrt(at.xi);
    return fmax(at.force - 1.5 * root * (at.push - push), 0.0);
}

double film_relax_force(const film_relax *s, const film_relax_step *steps, int32_t k, double tau) {
    const film_relax_step *step = &steps[k];
    double xi = depth_at(step, s->gamma, tau / step->h), q[FILM_RELAXATIONS], p[FILM_RELAXATIONS];
    int way_in = k < s->approach || s->branch == 0;
    film_relax_memory(&s->law, step, tau, way_in, q, p);
    double force = s->law.rest * power(xi), push = s->law.rest * xi, t1 = 2.0 * s->turned - step->time - tau;
    for (int32_t i = 0; i < s->law.terms; i++) {
        force += s->law.share[i] * q[i];
        push += s->law.share[i] * p[i];
    }
    return way_in ? fmax(force, 0.0) : force_out(s, steps, step->time + tau, push, &t1);
}

double film_relax_peak(const film_relax *s, const film_relax_step *steps, int32_t k, double tau) {
    const double *a = steps[k].force, end = tau / steps[k].h;
    double most = film_relax_force(s, steps, k, tau), square = a[2] * a[2] - 3.0 * a[1] * a[3]; /* F' = a1 + 2 a2 u + 3 a3 u^2 */
    if (square < 0.0) return most;
    double sum = -(a[2] + copysign(sqrt(square), a[2])), places[2] = {sum / (3.0 * a[3]), a[1] / sum};
    for (int i = 0; i < 2; i++)
        if (places[i] > 0.0 && places[i] < end) most = fmax(most, film_relax_force(s, steps, k, places[i] * steps[k].h));
    return most;
}

/* ---------------------------------------------------------------- one step */

/* Sums over the exponentials at the nodes: what is left of the memory, and the weights of the coefficients of xi^1.5
 * but the first on the way in, and of those of xi' on the way out. */
typedef struct {
    double left[NODES], weight[NODES][5];
} weights;

static void fill_weights(const film_relax *s, double h, int way_in, weights *w) {
    memset(w, 0, sizeof *w);
    for (int32_t i = 0; i < s->law.terms; i++) {
        double rate = s->law.rate[i], share = s->law.share[i], hat[6];
        for (int j = 0; j < NODES; j++) {
            double at = 1.0;
            hats(rate * h * NODE_AT[j], hat);
            w->left[j] += share * hat[0] * (way_in ? s->q[i] : s->p[i]);
            for (int m = 0; m < 5; m++) {
                at *= NODE_AT[j];
                w->weight[j][m] += share * at * hat[m + 1] * (way_in ? 1.0 : h / (m + 1));
            }
        }
    }
}

static double force_in(const film_relax *s, const film_relax_step *to, const weights *w, int j) {
    double f = s->law.rest * polynomial(to->grown, 5, NODE_AT[j]) + w->left[j];
    for (int m = 0; m < 5; m++) f += to->grown[m + 1] * w->weight[j][m];
    return f;
}

/* xi^1.5 by its values at the beginning, the nodes and the end. Without the end the memory would keep the error of an
 * extrapolation. */
static void fill_grown(film_relax_step *to, double gamma) {
    static const double zero_at_nodes[5] = {1.0, -20.0, 90.0, -140.0, 70.0}; /* Legendre's polynomial, 1 at the end */
    double slope[NODES], missed;
    to->grown[0] = power(to->xi);
    for (int j = 0; j < NODES; j++) slope[j] = (power(depth_at(to, gamma, NODE_AT[j])) - to->grown[0]) / NODE_AT[j];
    cubic(slope, to->grown + 1);
    to->grown[5] = 0.0;
    missed = power(depth_at(to, gamma, 1.0)) - polynomial(to->grown, 4, 1.0);
    for (int m = 0; m < 5; m++) to->grown[m + 1] += missed * zero_at_nodes[m];
}

/* Forces at the nodes, by the cubic of the trial before, or of the step before. A step's h is 0 before its first trial. */
static void guess_forces(const film_relax *s, const film_relax_step *steps, const film_relax_step *to, double h, double *force) {
    const film_relax_step *known = to->h > 0.0 ? to : s->steps > 0 ? &steps[s->steps - 1] : NULL;
    for (int j = 0; j < NODES; j++) {
        double u = known == NULL ? 0.0 : (NODE_AT[j] * h + (known == to ? 0.0 : known->length)) / known->h;
        force[j] = known == NULL ? 0.0 : polynomial(known->force, 3, fmin(u, 2.0));
    }
}

int film_relax_try(const film_relax *s, const film_relax_step *steps, film_relax_step *to, double h, double match[4],
                   film_relax_trial *trial) {
    int way_in = s->branch == 0, k;
    double force[NODES], scale = fmax(pow(s->speed, 1.2), s->peak);
    weights w;
    guess_forces(s, steps, to, h, force);
    to->time = s->time;
    to->h = to->length = h;
    to->xi = s->xi;
    to->nu = s->nu;
    to->shift = s->shift;
    to->load = s->load;
    memcpy(to->q, s->q, sizeof to->q);
    memcpy(to->p, s->p, sizeof to->p);
    fill_weights(s, h, way_in, &w);
    for (k = 0; k < ROUNDS; k++) {
        double moved = 0.0;
        cubic(force, to->force);
        fill_rate(to, s->gamma);
        if (way_in) fill_grown(to, s->gamma);
        for (int j = 0; j < NODES; j++) {
            double now, push;
            if (way_in) {
                now = force_in(s, to, &w, j);
            } else {
                push = s->law.rest * depth_at(to, s->gamma, NODE_AT[j]) + w.left[j];
                for (int m = 0; m < 5; m++) push += to->rate[m] * w.weight[j][m];
                now = force_out(s, steps, s->time + NODE_AT[j] * h, push, &match[j]);
            }
            moved = fmax(moved, fabs(now - force[j]));
            force[j] = now;
        }
        if (!(moved > SETTLED * scale)) break;
    }
    if (k == ROUNDS) return 0;
    film_relax_memory(&s->law, to, h, way_in, trial->q, trial->p);
    trial->push = s->law.rest * depth_at(to, s->gamma, 1.0);
    for (int32_t i = 0; i < s->law.terms; i++) trial->push += s->law.share[i] * trial->p[i];
    trial->error = fabs(to->force[3]) / 20.0 * h; /* the last coefficient of its Legendre series */
    return 1;
}
