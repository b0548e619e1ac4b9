/* Runs blocks of impacts, side by side in lanes: see film_lanes.h. film_avx2.c, film_avx512.c and film_single.c compile it too.
 * docs/method.md, section 10. */
#include "lanes/film_lane_damped.h"
#include "lanes/film_lane_fixed.h"
#include "lanes/film_lane_load.h"
#include "lanes/film_lane_motion.h"
#include "lanes/film_lane_sample.h"
#include "lanes/film_lane_spring.h"
#include "lanes/film_lane_unload.h"

#include "lanes/film_lane_springs.h" /* last: it gives names another meaning */

#ifndef FILM_ROUTINES
#define FILM_ROUTINES film_plain
#endif
#ifndef FILM_OWN
#define FILM_OWN
#endif

/* The numbers that differ, of the first pieces of the last stage: as film_shape has them. */
static void shape_lanes(const batch_job *j, int32_t pieces, const double (*of)[LANES]) {
    own_stage *own = j->own;
    int32_t nodes = j->family->nodes, varying = j->family->varying, last = pieces - 1, count = own->piece[last].column + 1;
    const double *table = j->family->numbers + nodes + varying;
    count += own->piece[last].force + own->piece[last].mean + own->piece[last].recovery + own->piece[last].exponent;
    for (int32_t v = 0; v < count; v++) {
        double sum[LANES] = {0.0};
        for (int32_t n = 0; n < nodes; n++) {
            double one = table[(int64_t)n * varying + v];
            EACH(l) sum[l] += of[n][l] * one;
        }
        memcpy(own->value[v], sum, sizeof sum);
    }
    double at[LANES], force[LANES];
    own->pieces = pieces;
    own->end = j->curve->piece[j->curve->stage[j->shaped].first + pieces - 1].end;
    EACH(l) at[l] = own->end;
    law_lanes(j, j->shaped, at, force, own->whole);
}

FILM_OWN const block_routines FILM_ROUTINES = {shape_lanes, fixed_lanes, spring_lanes, load_lanes, leave_lanes, unload_lanes,
                                               retrace_lanes, damped_contact_lanes, sample_lanes, record_lanes,
                                               {slide_lanes_double, slide_lanes_single}};
