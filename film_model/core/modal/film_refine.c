/* As many modes as the accuracy needs. docs/method.md, section 13. */
#include "modal/film_refine.h"

#include <math.h>
#include <string.h>

/* Tolerance of a step over the accuracy. The error of a time or a slow rebound may be 40 times as large. */
static const double STEP = 0.03;

/* Least tolerance of a step: for a smaller one rounding makes its steps too short. */
static const double TIGHTEST = 1e-13;

/* Rate at which contact follows the structure, over the highest frequency, from which on runs are compared: below it results
 * converge. On 24 plates an accuracy of 1e-3 is reached at 0.04 to 0.12. */
static const double FOLLOWED = 1.0;

/* Error of the omitted compliance that does not matter, over that and the contact's, and over the accuracy. */
static const double NEGLIGIBLE = 1e-3;

/* Error of the omitted compliance over that of the run before, below which one with more modes is worth its time. */
static const double FALLING = 0.5;

/* Modes of a run of a damped law from which on the next may be the result although it is not expected to be: recording it takes 3 % of
 * it, and which run shows that more bring no accuracy is not known before. */
enum { MANY = 400 };

/* Bound on the error of a run over its difference to one with half the highest frequency, without damping of the law and with. The
 * omitted compliance of damped laws is a mode, and errors up to 4 times the difference. benchmarks/random_structures.py compares
 * estimates with errors. */
static const double FACTOR[] = {3.0, 5.0};

/* By how much doubling the highest frequency divides the error at least, likewise. If a difference falls by more, two runs may agree
 * by chance: the estimate is then from the difference before. With 4 and with 12 as many errors are bounded. */
static const double FALL[] = {8.0, 4.0};

/* Factor of the impulse that scales the tolerance of a step. With half or twice as much impacts take about as long. */
static const double IMPULSES = 80.0;

/* Factors of the highest frequency from one run to the next. HIGHER: the next has more modes. STIFFER: the last two had the same modes, so
 * that only the mode of a damped law's omitted compliance gets stiffer; errors then about halve with each doubling. */
static const double HIGHER = 2.0, STIFFER = 4.0;

/* Velocity of an impact without one, over delta_s/t_s. */
static const double SLOWEST = 1e-3;

/* Bound on the error by the number of modes with membrane forces over the change if only half of them have these: the error is about
 * inversely proportional to the number. */
static const double MEMBRANE_FACTOR = 2.0;

static double larger(double a, double b) { return a > b ? a : b; }

double film_tightened(double tolerance, double share) { return larger(tolerance * share, TIGHTEST); }

double film_step_tolerance(double accuracy) { return film_tightened(accuracy, STEP); }

void film_refine_bounds(int damped, int64_t count, const double *before, const double *change, double *bound) {
    for (int64_t i = 0; i < count; i++) bound[i] = FACTOR[damped != 0] * larger(change[i], before[i] / FALL[damped != 0]);
}

/* Rate at which the contact follows the structure: its stiffness times the sum of the modes' shares, which is about proportional to the
 * highest frequency, over that. */
static double swiftness(const film_refine *r, const film_summary *core, double shares, double highest) {
    double stiffness = core->maximum_indentation > 0.0 ? core->maximum_force / core->maximum_indentation : 0.0;
    return stiffness * r->force / r->length * shares / highest;
}

/* Factor of the steps' tolerance, at most 1: the impulse of the largest force over the time that contact takes to follow the structure,
 * times IMPULSES, over the momentum. An error as large would change that force as much. */
static double step_share(const film_refine *r, const film_summary *core, double swift) {
    double rate = swift * r->time;
    return rate > 0.0 ? fmin(1.0, IMPULSES * core->maximum_force / (rate * larger(r->start.nu, SLOWEST))) : 1.0;
}

/* The largest difference of two runs; value by value in off[]. */
static double differences(const film_refine *r, const film_run *a, const film_run *b, double off[FILM_COMPARED]) {
    double most = 0.0;
    film_differences(&r->start, &a->core, &b->core, 1, off);
    if (r->reversible) off[5] = 0.0; /* a permanent indentation is reported as 0 */
    for (int k = 0; k < FILM_COMPARED; k++) most = larger(most, off[k]);
    return most;
}

static double work_of(const film_run *run) { return (double)run->core.lines * (run->modes + FILM_MODES_OF_A_STEP); }

static void ask(film_refine *r, int what, double highest, double tolerance) {
    r->ask = what;
    r->highest = highest;
    r->tolerance = tolerance;
}

/* Whether the last run had no more modes than the one before. */
static int has_all(const film_refine *r) { return r->count > 1 && r->runs[r->count - 1].modes == r->runs[r->count - 2].modes; }

/* Whether the accuracy is not reached with more modes, as it seems: if the estimate falls as since a quarter of the highest frequency.
 * Forces of damped laws may begin so suddenly that they show ever higher vibrations. */
static int out_of_reach(const film_refine *r, double highest) {
    double now = r->estimates[2], falls = fmin(now / r->estimates[r->stiffer], 1.0);
    return r->damped && r->tried > 2 && now * pow(falls, log(r->most / highest) / log(4.0)) > r->accuracy;
}

/* A run with a higher highest frequency. */
static void go_up(film_refine *r, double highest, double tolerance) {
    const film_run *last = &r->runs[r->count - 1];
    r->stiffer = has_all(r);
    double higher = fmin((r->stiffer ? STIFFER : HIGHER) * highest, r->most);
    int sure = HIGHER * higher > r->most || r->work + 5.0 * work_of(last) > r->most_work; /* if more modes take no less */
    r->final = sure || (r->damped && last->modes >= MANY) || (r->tried > 0 && r->estimates[2] <= FALL[0] * r->accuracy);
    ask(r, FILM_RUN, higher, tolerance);
}

/* After the first run: the tolerance, or further frequencies that the contact follows quickly. */
static void skip(film_refine *r, double shares) {
    double twice = r->highest;
    if (2.0 * twice > r->most || !(swiftness(r, &r->runs[0].core, shares, twice) > FOLLOWED * twice)) {
        go_up(r, 0.5 * twice, r->tolerance);
    } else {
        ask(r, FILM_SHARES, 2.0 * twice, r->tolerance);
    }
}

/* The estimate is known: how far do the errors of frequencies and omitted compliance and the number of modes with membrane forces change the
 * result? */
static void judge(film_refine *r, int asked) {
    const film_run *coarse = &r->runs[r->count - 2], *fine = &r->runs[r->count - 1];
    const film_summary *core = &coarse->core;
    double unit = r->length / r->force, depth = core->maximum_indentation;
    double soft = core->maximum_force > 0.0 ? depth / core->maximum_force * unit : 0.0;
    int matters = coarse->error > NEGLIGIBLE * r->accuracy * (soft + coarse->omitted);
    r->below = coarse->highest;
    if (asked < FILM_SOFTER && matters) ask(r, FILM_SOFTER, coarse->highest, coarse->tolerance);
    else if (asked < FILM_FEWER && r->carried) ask(r, FILM_FEWER, fine->highest, fine->tolerance);
    else ask(r, FILM_ENOUGH, fine->highest, fine->tolerance);
}

/* Whether the errors of frequencies and omitted compliance are too large and those of a run with more modes are smaller. */
static int more_tell(const film_refine *r) {
    const film_run *coarse = &r->runs[r->count - 2], *fine = &r->runs[r->count - 1];
    return !r->over && r->estimated + r->own > r->accuracy && fine->error < FALLING * coarse->error;
}

/* With three runs: estimates the error, and ends if it is small enough or no run can follow. Otherwise asks for a higher run. */
static void compare(film_refine *r, int last) {
    const film_run *fine = &r->runs[r->count - 1];
    if (r->count > 2) {
        double before[FILM_COMPARED], change[FILM_COMPARED];
        differences(r, fine - 2, fine - 1, before);
        differences(r, fine - 1, fine, change);
        film_refine_bounds(r->damped, FILM_COMPARED, before, change, r->errors);
        r->estimated = 0.0;
        for (int k = 0; k < FILM_COMPARED; k++) r->estimated = larger(r->estimated, r->errors[k] += r->tolerance);
        memmove(r->estimates, r->estimates + 1, 2 * sizeof r->estimates[0]);
        r->estimates[2] = r->estimated;
        r->tried++;
        r->over = last || out_of_reach(r, fine->highest);
        if (r->estimated <= r->accuracy || r->over) {
            r->own = 0.0;
            judge(r, FILM_RUN);
            return;
        }
    }
    go_up(r, fine->highest, film_tightened(r->tolerance, 1.0 / FILM_REFINED));
}

/* Puts a run before the others, or after them. */
static void keep(film_refine *r, const film_run *run, int first) {
    if (!first && r->count == 3) {
        memmove(r->runs, r->runs + 1, 2 * sizeof *run);
        r->count = 2;
    }
    if (first) memmove(r->runs + 1, r->runs, (size_t)r->count * sizeof *run);
    film_run *kept = &r->runs[first ? 0 : r->count];
    *kept = *run;
    kept->highest = r->highest;
    kept->tolerance = r->tolerance;
    r->count++;
    r->work += work_of(run);
}

static void took_run(film_refine *r, const film_run *run) {
    int failed = run->status < 0, before = r->earlier;
    if (failed && (r->count < 2 || before || run->status != FILM_TOO_MANY)) {
        r->ask = FILM_FAILED;
        return;
    }
    if (!failed) keep(r, run, before);
    if (r->count == 1) {
        r->tolerance = film_tightened(film_step_tolerance(r->accuracy),
                                      step_share(r, &run->core, swiftness(r, &run->core, run->shares, r->highest)));
        if (r->skips) ask(r, FILM_SHARES, 2.0 * r->highest, r->tolerance);
        else go_up(r, r->highest, r->tolerance);
        return;
    }
    const film_run *fine = &r->runs[r->count - 1];
    int last = failed || before || HIGHER * fine->highest > r->most || r->work + 4.0 * work_of(fine) > r->most_work ||
               4.0 * fine->modes > FILM_MOST_FOLLOWED;
    if (last && r->count == 2) { /* the difference to fewer modes than those of the first run is known quickly */
        r->final = 0;
        r->earlier = 1;
        ask(r, FILM_RUN, 0.25 * fine->highest, (double)(FILM_REFINED * FILM_REFINED) * fine->tolerance);
    } else {
        r->tolerance = fine->tolerance;
        compare(r, last);
    }
}

void film_refine_begin(film_refine *r, double first) {
    r->count = r->tried = r->over = r->final = r->earlier = r->stiffer = 0;
    r->work = r->own = r->membrane = 0.0;
    memset(r->changes, 0, sizeof r->changes);
    ask(r, FILM_RUN, first, FILM_REFINED * film_step_tolerance(r->accuracy));
}

void film_refine_next(film_refine *r, const film_run *run) {
    double each[FILM_COMPARED];
    int asked = r->ask;
    if (asked == FILM_RUN) {
        took_run(r, run);
    } else if (run->status < 0) {
        r->ask = FILM_FAILED;
    } else if (asked == FILM_SHARES) {
        skip(r, run->shares);
    } else if (asked == FILM_SOFTER) {
        r->own = differences(r, &r->runs[r->count - 2], run, r->changes);
        if (more_tell(r)) go_up(r, r->runs[r->count - 1].highest, film_tightened(r->tolerance, 1.0 / FILM_REFINED));
        else judge(r, asked);
    } else {
        r->own += r->membrane = MEMBRANE_FACTOR * differences(r, run, &r->runs[r->count - 1], each);
        judge(r, asked);
    }
}

void film_refine_sizes(int64_t sizes[2]) {
    sizes[0] = (int64_t)sizeof(film_run);
    sizes[1] = (int64_t)sizeof(film_refine);
}
