/* What these files share: film_impact.c, one impact; film_tables.c, what impacts of one law share; film_batch.c, which sorts
 * impacts into blocks; film_lanes.c, which runs a block, and film_single.c, which compiles it for a block of one. Internal.
 * docs/method.md, section 10. */
#ifndef FILM_BATCH_H
#define FILM_BATCH_H

#include "film_law.h"
#include "film_wide.h"

#ifndef FILM_LANES
#define FILM_LANES 32
#endif
enum { LANES = FILM_LANES }; /* impacts of a block */

/* The length of a leg to the turn below this fraction of the depth is mostly rounding: its time is then v/force, and lanes
 * leave it to film_marched. Needed by core_check.c, check_short_leg, and
 * test_a_turn_just_inside_a_stage_agrees_with_the_march: times are off by up to 4e-9 without it. */
static const double SHORT_LEG = 1e-9;

/* One line and the node at its end. */
typedef struct {
    double x;          /* of the node */
    double h;          /* length of the line */
    double kappa, phi; /* slope of the line, force where it begins */
    double force;      /* of the law at the node */
    double work;       /* twice the work: of a stage, from its beginning to here; of a power, from here to its end */
} table_row;

/* The lines of a run that many impacts share: over x^exponent from 0 to 1, which turns there or comes back from rest, and
 * which scales with the depth; or across a whole stage. */
typedef struct {
    int32_t stage, direction, segments; /* stage: UNIT_POWER or the one that is crossed; direction: +1 or -1 */
    double exponent;
    const double *nodes; /* NULL: those of a trial */
    double peak;         /* largest force at its nodes */
    const table_row *rows; /* 0 .. segments */
} line_table;

static const double ANY_POWER = 1.5; /* exponent of a table of which only the nodes are used */
enum { UNIT_POWER = -1, ROWS = 3456, TABLES = 128, AIMING_SEGMENTS = 4 };

/* Of every lane, the force and the mean of its own last stage: what differs between the curves of a family. */
enum { OWN_PIECES = 14, OWN_DOUBLES = 640 };
typedef struct {
    int32_t usable; /* pieces of the last stage, from its beginning, for which there is room */
    int32_t pieces; /* those that the block may reach */
    double end;     /* of the last of them */
    double whole[LANES]; /* work up to there */
    struct { int32_t column, force, mean; } piece[OWN_PIECES]; /* where its work_at_begin is in `value`; terms of both series behind */
    double edge_force[OWN_PIECES][FILM_MAX_NODES]; /* of each row: force where the piece ends */
    double value[OWN_DOUBLES][LANES];
} own_stage;

/* Gauss's rule on a way to the turn, in panels of at most PANEL points: after the fraction x of it, x = s^2 (2 - s^2), so that
 * sqrt(1 - x) = 1 - s^2, to which the velocity before a turn is proportional, and sqrt x, of which a force at first touch is a
 * power, have no root. For n segments: n + EXTRA_POINTS points, at most MOST_POINTS, less what does not fill panels of one size. One
 * impact takes SEVERAL at a time: `filled` points, the last of which have no weight. */
enum { PANEL = 16, EXTRA_POINTS = 2, MOST_POINTS = 256, SEVERAL = 8 };
typedef struct {
    int32_t count, filled;
    double at[MOST_POINTS], rest[MOST_POINTS];       /* s, 1 - x */
    double across[MOST_POINTS], weight[MOST_POINTS]; /* 4 s ds, and dx: of 1/velocity over the length of the way */
} gauss_rule;

void film_make_rule(int32_t segments, gauss_rule *rule);

/* The time across a whole piece on a fixed target, as a Chebyshev series; terms 0: not yet computed. */
enum { EXTRA_TERMS = 2, MOST_TERMS = 64 };
typedef struct {
    int32_t terms;
    double term[MOST_TERMS];
} crossing;

/* A damped power law as lanes run it: in z, with xi = z^root, force = stiffness z^force, c = factor z^damping; root 0: lanes
 * cannot. */
enum { MOST_POWER = 6 };
typedef struct {
    int32_t root, force, damping;
    int32_t used[MOST_POWER + 1]; /* 1: the power of z is a product that is needed */
    double stiffness, factor;
} damped_form;

/* A batch, and what its impacts share. */
typedef struct {
    const film_family *family; /* NULL: all impacts share the curve */
    const double *shape;
    const double *spring; /* compliance in series with each contact; NULL: none */
    int32_t shaped; /* the stage that differs between impacts; -1: none */
    own_stage *own;
    const film_curve *curve;
    const film_mesh *mesh;
    const film_start *start;
    film_summary *summary;
    int32_t *status;
    double whole[FILM_MAX_STAGES], end_force[FILM_MAX_STAGES]; /* work of a stage, force at its end */
    double piece_work[FILM_MAX_PIECES], piece_force[FILM_MAX_PIECES]; /* at its end; work from its stage's beginning */
    double piece_slope[FILM_MAX_PIECES];                              /* the same, of the force; of one impact only */
    double exponent[FILM_MAX_STAGES]; /* of the branch of a contact that turned there; NAN: it depends on the depth */
    int32_t touch;  /* the stage in which contact begins: 0, unless the law pulls */
    double parting; /* work from the end of contact to first touch: 0, unless the law pulls */
    int32_t simple[FILM_MAX_STAGES];  /* one power from its beginning on, whose force rises */
    gauss_rule rule;
    crossing across[FILM_MAX_PIECES];
    damped_form damped;
    int32_t table_count, row_count;
    line_table tables[TABLES];
    table_row rows[ROWS];
} batch_job;

/* Whether there are shorter ways than lines for this curve and mesh. */
int film_is_quick(const film_curve *curve, const film_mesh *mesh);

/* What tells how impacts unload that turn in stage k, and whether the stage is one power; j->simple[0] is known if k > 0. */
void film_prepare_stage(batch_job *j, int32_t k);

/* What all impacts of j->curve on j->mesh share, but for the ends of pieces. 0: lanes cannot run this curve or mesh. */
int film_prepare_job(batch_job *j);

/* Work and force at the ends of all pieces. */
void film_prepare_pieces(batch_job *j);

/* The piece of *stage in which a fixed target should turn impact i; -1: none. */
int32_t film_piece_on_fixed(const batch_job *j, int64_t i, int32_t *stage);

/* What damped impacts of j->curve on j->mesh share: j->damped. */
void film_prepare_damped(batch_job *j);

/* Whether lanes can run a damped impact. */
static inline int in_damped_lanes(const batch_job *j, const film_start *s) {
    return j->damped.root > 0 && s->damping > 0.0 && s->damping < INFINITY && s->nu > 0.0 && s->nu < INFINITY && s->gamma >= 0.0 &&
           s->gamma < INFINITY && s->load >= 0.0 && s->load < INFINITY;
}

/* The table of a run, made when it is first asked for; there is room for all that a batch can ask for. */
line_table *film_lines_of(batch_job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes, double exponent);

/* One impact as a row of film_batch; on a fixed target whole pieces are crossed by quadrature. 0: lanes cannot run it, or
 * should not. */
int film_single(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary, int32_t *status);

/* Contacts in series with springs, as in film_batch_in_series, whose curves vary, one after another; LEFT_ALONE: lanes cannot run
 * it. */
void film_single_in_series(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                           const double *compliance, int32_t varying, const int32_t *places, const double *values,
                           film_summary *summary, int32_t *status);

/* Tables of whole ways, film_way_in.c and film_way_out.c: eight pieces for each doubling of 1 + number, up to MAP_END. */
enum { MAP_PIECES = 32, FILM_WAY_IN_TERMS = 11, FILM_WAY_IN_VALUES = 2, FILM_WAY_OUT_TERMS = 14, FILM_WAY_OUT_VALUES = 3 };
static const double MAP_END = 15.0;
extern const double film_way_in[MAP_PIECES * FILM_WAY_IN_TERMS * FILM_WAY_IN_VALUES + 2];
extern const double film_way_out[MAP_PIECES * FILM_WAY_OUT_TERMS * FILM_WAY_OUT_VALUES + 2];

/* The table of the way through an elastic stage, film_way_through.c: pieces of the push up to PUSH_END, each in two at MARGIN. */
enum { PUSH_PIECES = 4, LIMIT_TERMS = 14, THROUGH_TERMS = 14, THROUGH_NUMBERS = 8 * (14 + 10 + 6 + 2) };
static const double PUSH_END = 0.7, MARGIN = 0.4375;
extern const double film_largest_share[PUSH_PIECES * LIMIT_TERMS];
extern const double film_way_through[2 * PUSH_PIECES * THROUGH_NUMBERS];

/* For film_batch_shaped and film_batch_in_series: an impact that lanes cannot run. */
enum { LEFT_ALONE = 100 };

/* Leaves an impact to film_marched: at once, or when the curve of its shape or in series with its spring is made. */
static inline void leave_alone(const batch_job *j, int64_t i) {
    j->status[i] = j->family != NULL || j->spring != NULL ? LEFT_ALONE : film_marched(j->curve, j->mesh, &j->start[i], &j->summary[i]);
}

/* Impacts in blocks; family and spring: of film_batch_shaped and film_batch_in_series, or NULL. Those that lanes cannot run have
 * the status LEFT_ALONE if one of them is given. */
void film_run_rows(int instructions, const film_family *family, const film_curve *whole, const film_mesh *mesh, int64_t count,
                   const film_start *start, const double *shape, const double *spring, film_summary *summary, int32_t *status);

/* The impacts that film_batch_shaped left alone, one after another. */
void film_impacts_left(const film_family *family, const film_curve *whole, const film_mesh *mesh, int64_t count,
                       const film_start *start, const double *shape, film_summary *summary, int32_t *status);

/* Laws with a shape: film_batch_shape.c. Prepares the last stage; the piece in which an impact should
 * turn that begins the last stage at v, with `stored` work done, -1: none that lanes may use; the factors of a block. */
void film_own_stage(batch_job *j, own_stage *own);
int32_t film_own_piece(const batch_job *j, int64_t i, double v, double stored);
void film_own_factors(const batch_job *j, const int64_t *index, int count, double (*of)[LANES]);

/* A stage of one power whose force rises: Newton's method finds its depth for a given work from above. */
static inline int force_rises(const film_curve *curve, int32_t stage) {
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    int pulled = curve->pull > 0.0 && g->slope == 0.0 && g->coefficient > 0.0 && g->exponent >= 1.0;
    return curve->stage[stage].count == 1 && g->form == FILM_POWER && (g->constant >= 0.0 || pulled) && g->slope >= 0.0 &&
           g->coefficient >= 0.0;
}

/* One power law k x^q from first touch on: a run to the turn is one run, scaled, and where the law is reversible the way
 * back is a branch that ends at 0. */
static inline int plain_power(const batch_job *j, int32_t stage) {
    const film_function *g = &j->curve->piece[0].force;
    return stage == 0 && j->simple[0] && g->constant == 0.0 && g->slope == 0.0 && g->coefficient > 0.0;
}

/* A power law from first touch on whose exponent is that of the tables of whole ways. */
static inline int has_way_in(const batch_job *j, int32_t stage) {
    return plain_power(j, stage) && j->curve->piece[0].force.exponent == 1.5;
}

/* W + g f (0.79 nu - 0.27 g f) - nu^2/2, which is near 0 where a target that moves turns the impactor; g f <= nu.
 * docs/method.md, section 10. */
static inline double turn_excess(double work, double force, double nu, double gamma) {
    double push = gamma * force < nu ? gamma * force : nu;
    return work + push * (0.79 * nu - 0.27 * push) - 0.5 * nu * nu;
}

/* The velocity v on a fixed target after some work. */
static inline double speed_after(double v, double work) {
    double square = v * v - 2.0 * work;
    return square > 0.0 ? sqrt(square) : 0.0;
}

/* No load, no damping, and no time limit that ends other contacts than those of a law that pulls, which may never end. */
static inline int is_free(const film_curve *curve, const film_start *start) {
    int limited = start->time_limit < INFINITY && curve->pull == 0.0;
    return start->load == 0.0 && !limited && start->damping == 0.0;
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

/* The largest share of the energy with which a motion of this push turns in a stage of exponent 3/2. place: push over the
 * length of a piece, in piece. */
static inline double largest_share(double place, int piece) {
    const double *row = &film_largest_share[piece * LIMIT_TERMS];
    double at = 2.0 * (place - piece) - 1.0, square = at * at, even = 0.0, odd = 0.0;
    for (int k = LIMIT_TERMS - 2; k >= 0; k -= 2) {
        even = even * square + row[k];
        odd = odd * square + row[k + 1];
    }
    return even + at * odd;
}

/* Whether the first stage, of exponent 3/2 and a push below PUSH_END, turns the impactor. */
static inline int turns_elastically(const batch_job *j, double nu, double gamma) {
    double place = gamma * j->end_force[0] / nu * (PUSH_PIECES / PUSH_END);
    return 2.0 * j->whole[0] / (nu * nu) >= largest_share(place, (int)place);
}

/* turn_excess at the end of stage k, but right where the table of the first stage tells; stored: work of the stages before. */
static inline int turns_within(const batch_job *j, int32_t k, double stored, double nu, double gamma) {
    double excess = turn_excess(stored + j->whole[k], j->end_force[k], nu, gamma);
    int near = fabs(excess) < 0.05 * nu * nu; /* more than turn_excess errs by up to PUSH_END */
    if (near && has_way_in(j, k) && gamma * j->end_force[k] < PUSH_END * nu) return turns_elastically(j, nu, gamma);
    return excess > 0.0;
}

/* The stage in which a target that moves should turn the impactor, by the estimate of turn_excess, or else the one that
 * differs between impacts, and the work of those before; -1: none. */
static inline int32_t moving_stage(const batch_job *j, double nu, double gamma, double *stored) {
    int32_t first = j->touch;
    *stored = 0.0;
    if (j->curve->pull > 0.0) *stored = j->whole[first++]; /* what turns under a pull is left to the march */
    for (int32_t k = first; k < j->curve->stages; k++) {
        if (k == j->shaped || !(j->whole[k] < INFINITY) || turns_within(j, k, *stored, nu, gamma)) return k;
        *stored += j->whole[k];
    }
    return -1;
}

enum { FEWEST = 3 }; /* segments of a leg on targets that move: fewer are too rough to find the turn from */

/* Impacts on targets that move, where they are on the law. */
typedef struct {
    double gamma[LANES], w[LANES], time[LANES];  /* w: impactor velocity */
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
    double gamma[LANES], time[LANES], top[LANES], force[LANES], recovery[LANES], exponent[LANES], stored[LANES];
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
} block_routines;

const block_routines *film_routines(int instructions);

extern const block_routines film_plain;
#if defined(FILM_WIDE)
extern const block_routines film_avx2, film_avx512;
#endif

#endif
