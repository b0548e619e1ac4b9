/* Many impacts: sorted into blocks by film_batch.c, or one after another by film_curves.c. Internal. docs/method.md,
 * section 10. */
#ifndef FILM_BATCH_H
#define FILM_BATCH_H

#include "lanes/film_lanes.h"

const block_routines *film_routines(int instructions);

/* One impact as a row of film_batch; on a fixed target whole pieces are crossed by quadrature. 0: lanes cannot run it, or
 * would be slower. */
int film_single(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary, int32_t *status);

/* The motion of one contact on a curve of its own, as lanes record it. */
void film_record_alone(const motions_wanted *m, double *bad);

/* Contacts on curves of their own, for those of them that lanes can run: in blocks, or of curves that vary one after another. The
 * others have the status LEFT_ALONE. */
void film_run_rows(int instructions, const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start,
                   film_summary *summary, int32_t *status);
void film_run_varying(const film_curves *of, const film_mesh *mesh, int64_t count, const film_start *start, film_summary *summary,
                      int32_t *status);

/* The curve of contact i. energy: of film_shape_up_to. own: at first a copy of the curve of all. FILM_OK or FILM_BAD_CURVE. */
int film_curve_of(const film_curves *of, int64_t i, double energy, film_curve *own);

/* The work of the springless law is at most this on the way to the turn: a fixed target without a load stores all of it. */
double film_most_work(const film_curve *curve, const film_start *start);

/* Laws with a shape: film_batch_shape.c. film_own_stage prepares the last stage; film_own_piece gives the piece in which an
 * impact should turn that enters the last stage at v after `stored` work, -1 if lanes cannot run it; film_own_factors gives
 * the factors of a block. */
void film_own_stage(batch_job *j, own_stage *own);
int32_t film_own_piece(const batch_job *j, int64_t i, double v, double stored);
void film_own_factors(const batch_job *j, const int64_t *index, int count, double (*of)[LANES]);

/* Impacts on a curve, of which lanes run those without a load. */
static inline void give(batch_job *j, const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary,
                 int32_t *status) {
    j->curve = curve;
    j->mesh = mesh;
    j->start = start;
    j->summary = summary;
    j->status = status;
    j->family = NULL;
    j->spring = NULL;
    j->loaded = 0;
    j->shaped = -1;
}

/* The piece of *stage in which a fixed target should turn impact i; -1: none. */
int32_t film_piece_on_fixed(const batch_job *j, int64_t i, int32_t *stage);

#endif
