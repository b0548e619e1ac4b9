/* What impacts of one law share, and the tables that replace lines. Internal. docs/method.md, section 10. */
#ifndef FILM_JOB_H
#define FILM_JOB_H

#include "curve/film_law.h"

#ifndef FILM_LANES
#define FILM_LANES 32
#endif
enum { LANES = FILM_LANES }; /* impacts of a block */

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

/* Of every lane, the force and the mean of its own last stage, and the unloading if it varies: what differs between the curves
 * of a family. */
enum { OWN_PIECES = 14, OWN_DOUBLES = 768 };
typedef struct {
    int32_t usable; /* pieces of the last stage, from its beginning, for which there is room */
    int32_t pieces; /* those that the block may reach */
    double end;     /* of the last of them */
    double whole[LANES]; /* work up to there */
    /* where its work_at_begin is in `value`; terms of the series behind; recovery, exponent: 0 if all lanes share them */
    struct { int32_t column, force, mean, recovery, exponent; } piece[OWN_PIECES];
    double edge_force[OWN_PIECES][FILM_MAX_NODES]; /* of each row: force where the piece ends */
    double value[OWN_DOUBLES][LANES];
} own_stage;

/* Gauss's rule on a way to the turn, in panels of at most PANEL points: after the fraction x of it, x = s^2 (2 - s^2), so that
 * sqrt(1 - x) = 1 - s^2, to which the velocity before a turn is proportional, and sqrt x, of which a force at first touch is a
 * power, have no root. For n segments: n + EXTRA_POINTS points, at most MOST_POINTS, reduced to fill panels of one size. One
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

/* A damped power law as lanes run it: in z, with xi = z^root, force = stiffness (z^force + steeper z^(2 root)), c = factor
 * (z^damping + faster z^root); root 0: lanes cannot run it. */
enum { MOST_POWER = 8 };
typedef struct {
    int32_t root, force, damping, more; /* more: 1 if steeper or faster are not 0 */
    int32_t used[MOST_POWER + 1]; /* 1: the power of z is a product that is needed */
    double stiffness, steeper, factor, faster;
} damped_form;

/* A law as cubics in the indentation since the beginning of a stage, eight between one and its double, as a force may begin a stage as a
 * root: in stage k the one whose number is that of the first bits of that indentation, at least least[k], less first[k]. They hold up to
 * the indentation `most`. Error: 5e-6 of the largest force, at first touch that at CUBIC_LEAST (tests/test_recorded_motions.py). */
enum { CUBIC_SHIFT = 49, CUBIC_ROWS = 1536, DAMPED_ROWS = 8 * 72 };
#define CUBIC_LEAST 0x1p-40
#define CUBIC_MOST 0x1p+31
typedef struct {
    double from, force[4]; /* coefficients of powers of what is beyond `from` */
} law_cubic;
typedef struct {
    double begin[FILM_MAX_STAGES], least[FILM_MAX_STAGES], most;
    int64_t first[FILM_MAX_STAGES];
    int32_t stages, damped;
    law_cubic row[CUBIC_ROWS];
    double damping[DAMPED_ROWS][4]; /* of the only stage */
} law_cubics;

/* Returns 1; or 0 if the law pulls, is in series with a spring, or needs more cubics than there is room for. */
int film_make_cubics(const film_curve *curve, law_cubics *to);

/* What motions of impacts in lanes are from, and where they go: at ascending times, values of impact i from i samples on. law: NULL of one
 * impact that has a curve of its own. legs: as of film_motions_many. kink: 1 if the slope of the law jumps where its
 * first stage ends. slope: of the force without damping; NULL if the law yields. */
typedef struct {
    const film_curve *curve;
    const law_cubics *law;
    const film_start *start;
    int64_t samples;
    int kink;
    double *legs, *times, *force, *depth, *slope;
} motions_wanted;

/* A batch, and what its impacts share. */
typedef struct {
    const film_family *family; /* NULL: all impacts share the curve */
    const double *shape;
    const double *spring; /* compliance in series with each contact; NULL: none */
    int loaded;     /* 1: the blocks' impacts are under loads, for which tables of whole ways do not hold */
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
    int32_t simple[FILM_MAX_STAGES];  /* one power from its beginning on, whose force rises, without a square */
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

/* What damped impacts of j->curve on j->mesh share: j->damped. */
void film_prepare_damped(batch_job *j);

/* The table of a run, made when it is first asked for; there is room for all that a batch can ask for. */
line_table *film_lines_of(batch_job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes, double exponent);

/* Tables of whole ways, film_way_in.c and film_way_out.c: eight pieces for each doubling of 1 + number, up to MAP_END. */
enum { MAP_PIECES = 32, FILM_WAY_IN_TERMS = 11, FILM_WAY_IN_VALUES = 2, FILM_WAY_OUT_TERMS = 14, FILM_WAY_OUT_VALUES = 3 };
static const double MAP_END = 15.0;
extern const double film_way_in[MAP_PIECES * FILM_WAY_IN_TERMS * FILM_WAY_IN_VALUES + 2];
extern const double film_way_out[MAP_PIECES * FILM_WAY_OUT_TERMS * FILM_WAY_OUT_VALUES + 2];

/* A stage of one power whose force rises: Newton's method finds its depth for a given work from above. */
static inline int force_rises(const film_curve *curve, int32_t stage) {
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    int pulled = curve->pull > 0.0 && g->slope == 0.0 && g->square == 0.0 && g->coefficient > 0.0 && g->exponent >= 1.0;
    return curve->stage[stage].count == 1 && g->form == FILM_POWER && (g->constant >= 0.0 || pulled) && g->slope >= 0.0 &&
           g->square >= 0.0 && g->coefficient >= 0.0;
}

/* One power law k x^q from first touch on: a run to the turn is one run, scaled, and where the law is reversible the way
 * back is a branch that ends at 0. */
static inline int plain_power(const batch_job *j, int32_t stage) {
    const film_function *g = &j->curve->piece[0].force;
    return stage == 0 && j->simple[0] && g->constant == 0.0 && g->slope == 0.0 && g->coefficient > 0.0;
}

/* A power law from first touch on whose exponent is that of the tables of whole ways. */
static inline int has_way_in(const batch_job *j, int32_t stage) {
    return !j->loaded && plain_power(j, stage) && j->curve->piece[0].force.exponent == 1.5;
}

#endif
