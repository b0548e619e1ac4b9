/* What film_batch.c, which sorts impacts into blocks, and film_lanes.c, which runs a block, share. Internal. */
#ifndef FILM_BATCH_H
#define FILM_BATCH_H

#include "film_law.h"

/* Wider registers are used on x86-64; not by GCC for Windows, which does not align them on the stack. */
#if defined(__x86_64__) && (defined(__clang__) || (defined(__GNUC__) && !defined(_WIN32)))
#define FILM_WIDE
#endif

enum { LANES = 32 }; /* impacts of a block */

/* One line and the node at its end. The force is phi where the line begins and has the slope kappa up to here. */
typedef struct {
    double x, h, kappa, phi;
    double force; /* of the law at the node */
    double work;  /* twice the work: from the stage's beginning to here; on a power from here to its end */
} row;

/* A run over x^exponent from 0 to 1, which turns there, or back from rest; or across a stage. */
typedef struct {
    int32_t stage, direction, segments; /* stage: UNIT_POWER or the one that is crossed; direction: +1 or -1 */
    double exponent;
    const double *nodes; /* NULL: those of a trial */
    double peak;         /* largest force at its nodes */
    double rest;         /* time of a run over the power on a fixed target */
    const row *rows;     /* 0 .. segments */
} table;

static const double SHORT_LEG = 1e-9; /* of the depth: a leg to the turn whose length rounding has made too uncertain */
static const double ANY_POWER = 1.5; /* where only the nodes of a run are asked for */
enum { UNIT_POWER = -1, ROWS = 3456, TABLES = 128, AIMING_SEGMENTS = 4 };

typedef struct {
    const film_curve *curve;
    const film_mesh *mesh;
    const film_start *start;
    film_summary *summary;
    int32_t *status;
    double whole[FILM_MAX_STAGES], end_force[FILM_MAX_STAGES]; /* work of a stage, force at its end */
    double piece_work[FILM_MAX_PIECES], piece_force[FILM_MAX_PIECES]; /* at its end; work from its stage's beginning */
    double exponent[FILM_MAX_STAGES];    /* of the branch on which a contact that turned there opens; NAN: it varies */
    int32_t simple[FILM_MAX_STAGES];     /* one power from its beginning on, whose force rises */
    int32_t table_count, row_count;
    table tables[TABLES];
    row rows[ROWS];
} job;

/* The lines of a run; there is room for every table a batch can ask for. */
const table *film_lines_of(job *j, int32_t stage, int32_t direction, int32_t segments, const double *nodes,
                           double exponent);

/* A stage of one power whose force rises: its depth for a given work is found from above. */
static inline int rises(const film_curve *curve, int32_t stage) {
    const film_function *g = &curve->piece[curve->stage[stage].first].force;
    return curve->stage[stage].count == 1 && g->form == FILM_POWER && g->constant >= 0.0 && g->slope >= 0.0 &&
           g->coefficient >= 0.0;
}

/* The same power law from first touch on: a run to the turn is one run, scaled, and where the law is reversible the way
 * back is a branch that opens at 0. */
static inline int plain_power(const job *j, int32_t stage) {
    const film_function *g = &j->curve->piece[0].force;
    return stage == 0 && j->simple[0] && g->constant == 0.0 && g->slope == 0.0 && g->coefficient > 0.0;
}

/* W + g f (0.79 nu - 0.27 g f) - nu^2/2, which is about 0 where the target turns the impactor; g f cannot exceed nu. */
static inline double spent_less_energy(double work, double force, double nu, double gamma) {
    double push = gamma * force < nu ? gamma * force : nu;
    return work + push * (0.79 * nu - 0.27 * push) - 0.5 * nu * nu;
}

/* Impacts on targets that give way, where they are on the law. */
typedef struct {
    double gamma[LANES], w[LANES], time[LANES];     /* impactor velocity w */
    double xi[LANES], force[LANES], work[LANES];    /* where each lane is, and the law there */
    double bad[LANES];                              /* left to film_impact */
} lanes;

/* Impacts at their deepest: work so far and largest force; the branch that opens, and gamma sqrt(force/depth) on it. */
typedef struct {
    lanes at;
    double stored[LANES], peak[LANES], recovery[LANES], exponent[LANES], slowness[LANES];
} deepest;

/* Impacts that have turned and wait to leave, by grading and stage. */
typedef struct {
    int64_t index[LANES];
    double gamma[LANES], time[LANES], top[LANES], force[LANES], recovery[LANES], exponent[LANES], stored[LANES];
    int count;
} leaving;

/* What runs a block, for one instruction set. */
typedef struct {
    /* impacts that turn in `stage` on a fixed target, from first touch to the end of contact */
    void (*fixed)(job *j, int32_t stage, const int64_t *index, int count);
    /* impacts that should turn in `stage`, to the turn */
    void (*in)(job *j, int32_t stage, const int64_t *index, int count, deepest *t);
    /* from the turn out along their branches; exponent NAN: each has its own */
    void (*out)(job *j, int32_t grading, double exponent, leaving *q);
    /* from the turn in `stage` back along the law */
    void (*back)(job *j, int32_t stage, const int64_t *index, int count, lanes *s, const double *stored);
} routines;

extern const routines film_plain;
#if defined(FILM_WIDE)
extern const routines film_avx2, film_avx512;
#endif

#endif
