/* Blocks of impacts that run side by side in lanes. Internal. docs/method.md, section 10. */
#ifndef FILM_LANES_H
#define FILM_LANES_H

#include "lanes/film_wide.h"
#include "march/film_march.h"
#include "oblique/film_springs.h"
#include "tables/film_job.h"

/* The time over that of a leg of contact, after a share x of its steps from first touch on: as x^2 at first, so that radius and
 * force are as powers of x, and soon in proportion. */
static inline double film_leg_share(double x) {
    double square = x * x;
    return square * sqrt(sqrt(17.0 / (1.0 + 16.0 * square * square)));
}

/* A way in whose force has a kink lasts `early` times its shares up to `share`, at the knot `knot`, and `late` times those beyond: the kink
 * lies at an eighth of the knots, and so of the steps of all runs. Without a kink, or for other numbers of knots, knot is -FILM_BEND and
 * share 1. FILM_BEND: knots of a cubic on one side. */
enum { FILM_BEND = 4, FILM_BENDS = 8 };
typedef struct {
    double share, early, late;
    int64_t knot;
} film_bend;

static inline film_bend film_bend_of(double kink, double turn, int64_t knots) {
    film_bend bend = {1.0, turn, turn, -FILM_BEND};
    int64_t part = knots / FILM_BENDS, least = (FILM_BEND + part - 1) / (part > 0 ? part : 1);
    if (!(kink > 0.0 && kink < turn) || part < 2 || knots % FILM_BENDS != 0) return bend;
    double square = (kink / turn) * (kink / turn), fourth = (16.0 * square * square + square * sqrt(256.0 * square * square + 68.0)) / 34.0;
    double nearest = floor(sqrt(sqrt(fourth)) * FILM_BENDS + 0.5);
    bend.knot = part * (int64_t)fmin(fmax(nearest, (double)least), (double)(FILM_BENDS - least));
    bend.share = film_leg_share((double)bend.knot / (double)knots);
    bend.early = kink / bend.share, bend.late = (turn - kink) / (1.0 - bend.share);
    return bend;
}

/* The knots of a way in with the kink of its leg, from those without. */
static inline void film_bend_times(int64_t knots, const double *leg, double *times) {
    film_bend bend = film_bend_of(leg[2], leg[0], knots);
    double at = bend.share * leg[0], early = bend.early / leg[0], late = bend.late / leg[0];
    if (bend.knot < 0) return;
    for (int64_t k = 0; k < knots; k++) times[k] = early * fmin(times[k], at) + late * fmax(times[k] - at, 0.0);
    times[bend.knot] = leg[2];
}

/* For film_batch_of: an impact that lanes cannot run. */
enum { LEFT_ALONE = 100 };

/* Leaves an impact to film_marched: at once, or later, when its curve (of its shape, or in series with its spring) is made. */
static inline void leave_alone(const batch_job *j, int64_t i) {
    int later = j->family != NULL || j->spring != NULL;
    j->status[i] = later ? LEFT_ALONE : film_marched(j->curve, j->mesh, &j->start[i], &j->summary[i]);
}

/* Whether lanes can run a damped impact. */
static inline int in_damped_lanes(const batch_job *j, const film_start *s) {
    return j->damped.root > 0 && s->damping > 0.0 && s->damping < INFINITY && s->nu > 0.0 && s->nu < INFINITY && s->gamma >= 0.0 &&
           s->gamma < INFINITY && s->load >= 0.0 && s->load < INFINITY;
}

/* W + g f (0.79 nu - 0.27 g f) - nu^2/2, which is near 0 where a target that moves turns the impactor; g f <= nu.
 * docs/method.md, section 10. */
static inline double turn_excess(double work, double force, double nu, double gamma) {
    double push = gamma * force < nu ? gamma * force : nu;
    return work + push * (0.79 * nu - 0.27 * push) - 0.5 * nu * nu;
}

/* No damping; a load only on a moving target under a law that does not pull; a time limit only with a load or a pull, under
 * which contact may never end. */
static inline int is_free(const film_curve *curve, const film_start *start) {
    int loaded = start->load > 0.0 && start->load < INFINITY && start->gamma > 0.0 && curve->pull == 0.0;
    int limited = start->time_limit < INFINITY && curve->pull == 0.0 && !loaded;
    return (start->load == 0.0 || loaded) && !limited && start->damping == 0.0;
}

/* The same without a moving support: what the shorter ways can do. */
static inline int is_undisturbed(const film_curve *curve, const film_start *start) {
    return start->stop_velocity == 0.0 && is_free(curve, start);
}

/* Whether lanes may run an undamped impact, if they can run its curve. */
static inline int is_plain(const batch_job *j, const film_start *s) {
    int known = s->gamma >= 0.0 && s->gamma < INFINITY && s->nu > 0.0 && s->nu < INFINITY, fixed = s->gamma == 0.0;
    int stops = s->stop_velocity == 0.0 || (fixed && s->stop_velocity < 0.0 && s->stop_velocity > -INFINITY && j->spring == NULL);
    return known && stops && (fixed || j->spring == NULL) && is_free(j->curve, s);
}

/* Whether a fixed target turns an impact by quadrature; laws that pull take the lines of targets that move. */
static inline int by_quadrature(const batch_job *j, const film_start *s) { return s->gamma == 0.0 && j->curve->pull == 0.0; }

/* The stage in which a target that moves should turn the impactor, by the estimate of turn_excess, or else the one that
 * differs between impacts, and the work of those before; -1: none. */
static inline int32_t moving_stage(const batch_job *j, double nu, double gamma, double *stored) {
    int32_t first = j->touch;
    *stored = 0.0;
    if (j->curve->pull > 0.0) *stored = j->whole[first++]; /* what turns under a pull is left to the march */
    for (int32_t k = first; k < j->curve->stages; k++) {
        if (k == j->shaped || !(j->whole[k] < INFINITY) || turn_excess(*stored + j->whole[k], j->end_force[k], nu, gamma) > 0.0) return k;
        *stored += j->whole[k];
    }
    return -1;
}

enum { FEWEST = 3 }; /* segments of a leg on targets that move: fewer are too rough to find the turn from */

/* Impacts on targets that move, where they are on the law. */
typedef struct {
    double gamma[LANES], load[LANES];
    double w[LANES], time[LANES];                /* w: impactor velocity */
    double xi[LANES], force[LANES], work[LANES]; /* where each lane is, and the law there */
    double bad[LANES];                           /* > 0: left to film_marched */
} lanes;

/* Impacts at their deepest: work so far, largest force, the branch that begins there, and gamma sqrt(force/depth) on it. */
typedef struct {
    lanes at;
    double stored[LANES], peak[LANES], recovery[LANES], exponent[LANES], slowness[LANES];
    double lines[LANES]; /* so far: 0 where no stage was passed by lines */
} turned_lanes;

/* Impacts that have turned and wait to unload, of one grading and stage. */
typedef struct {
    int64_t index[LANES];
    double gamma[LANES], load[LANES], time[LANES], top[LANES], force[LANES], recovery[LANES], exponent[LANES], stored[LANES];
    int count;
} unloading_queue;

/* What runs a block, for one instruction set. */
typedef struct {
    /* the own stage of each lane; of: the factors at its shape */
    void (*shape)(const batch_job *j, int32_t pieces, const double (*of)[LANES]);
    /* impacts that turn in `piece` of `stage` on a fixed target, from first touch to the end of contact */
    void (*fixed)(batch_job *j, int32_t stage, int32_t piece, const int64_t *index, int count);
    /* the same, each in series with its spring */
    void (*spring)(batch_job *j, int32_t stage, int32_t piece, const int64_t *index, int count);
    /* impacts that should turn in `stage`, to the turn */
    void (*load)(batch_job *j, int32_t stage, const int64_t *index, int count, turned_lanes *t);
    /* the whole way out from the turn, by a table, for those of exponent 3/2 and slowness below MAP_END */
    void (*leave)(batch_job *j, const int64_t *index, int count, const turned_lanes *t);
    /* from the turn out along their branches; exponent NAN: each has its own */
    void (*unload)(batch_job *j, int32_t grading, double exponent, unloading_queue *q);
    /* from the turn in `stage` back along the law */
    void (*retrace)(batch_job *j, int32_t stage, const int64_t *index, int count, lanes *s, const double *stored);
    /* impacts under a damped power law, from first touch to the end of contact */
    void (*damped)(batch_job *j, const int64_t *index, int count);
    /* the five values of film_evaluate at times on a contact's lines: value k of time i to values[k stride + i] */
    void (*sample)(const film_curve *curve, const film_line *lines, int32_t line_count, const double *times, int64_t count,
                   double *values, int64_t stride);
    /* up to LANES motions */
    void (*record)(const motions_wanted *m, int count, double *bad);
    /* film_springs_many, in numbers of double precision, and of single */
    void (*slide[2])(int64_t count, const int64_t *places, int32_t springs, int32_t estimated, const double *numbers, const double *friction, int32_t rows,
                     int shared, int64_t steps, int64_t knots, const double *force, const double *radius, film_springs_brief *results);
} block_routines;

extern const block_routines film_plain;
#if defined(FILM_WIDE)
extern const block_routines film_avx2, film_avx512;
#endif

#endif
