/* Blocks of impacts that wait to be run, and to unload. Internal to film_batch.c and film_single.c. docs/method.md, section 10. */
#ifndef FILM_BLOCKS_H
#define FILM_BLOCKS_H

#include "batch/film_batch.h"

typedef struct {
    int64_t index[LANES];
    int count;
} block;

typedef struct {
    batch_job j;
    const block_routines *run;
    block fixed[FILM_MAX_PIECES], moving[FILM_MAX_PIECES]; /* by the piece in which they should turn */
    unloading_queue unloading[FILM_MAX_STAGES][3];         /* by stage and grading */
    block damped;
} batch;

static void run_unloading(batch *b, int32_t stage, int32_t grading) {
    unloading_queue *q = &b->unloading[stage][grading];
    if (q->count > 0) b->run->unload(&b->j, FILM_PLATE_OUT + grading, b->j.exponent[stage], q);
}

/* Lane l of t, which has turned in `stage`, waits for others to unload with, or is left to film_marched. */
static void await_unloading(batch *b, int32_t stage, const turned_lanes *t, int l, int64_t i) {
    batch_job *j = &b->j;
    if (t->at.bad[l] > 0.0) {
        leave_alone(j, i);
        return;
    }
    int32_t grading = film_grading(t->slowness[l]), k = grading - FILM_PLATE_OUT;
    unloading_queue *q = &b->unloading[stage][k];
    j->summary[i].lines += film_unloading(j->mesh, grading);
    int at = q->count++;
    q->index[at] = i;
    q->gamma[at] = t->at.gamma[l];
    q->load[at] = t->at.load[l];
    q->time[at] = t->at.time[l];
    q->top[at] = t->at.xi[l];
    q->force[at] = t->at.force[l];
    q->recovery[at] = t->recovery[l];
    q->exponent[at] = t->exponent[l];
    q->stored[at] = t->stored[l];
    if (q->count == LANES) run_unloading(b, stage, k);
}

static void run_damped(batch *b) {
    if (b->damped.count > 0) b->run->damped(&b->j, b->damped.index, b->damped.count);
    b->damped.count = 0;
}

static void run_moving(batch *b, int32_t stage, block *waiting) {
    batch_job *j = &b->j;
    turned_lanes t;
    int count = waiting->count, rule = j->curve->stage[stage].unloading;
    int retrace = rule == FILM_SIMILAR || (rule == FILM_RETRACE && !plain_power(j, stage));
    int leave = !retrace && !j->loaded && j->exponent[stage] == 1.5;
    if (count == 0) return;
    waiting->count = 0;
    b->run->load(j, stage, waiting->index, count, &t);
    for (int l = 0; l < count; l++) {
        film_summary *out = &j->summary[waiting->index[l]];
        out->maximum_indentation = t.at.xi[l];
        out->time_of_maximum_indentation = t.at.time[l];
        out->maximum_force = t.peak[l];
        out->stage = stage;
        out->lines = (int32_t)t.lines[l];
        if (!retrace && !(leave && t.slowness[l] < MAP_END)) await_unloading(b, stage, &t, l, waiting->index[l]);
    }
    if (leave) b->run->leave(j, waiting->index, count, &t);
    if (retrace) b->run->retrace(j, stage, waiting->index, count, &t.at, t.stored);
}

#endif
