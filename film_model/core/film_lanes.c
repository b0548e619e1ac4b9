/* Runs blocks of impacts, side by side in lanes: see film_batch.h. film_avx2.c, film_avx512.c and film_single.c compile it too.
 * docs/method.md, section 10. */
#include "film_lane_fixed.h"
#include "film_lane_load.h"
#include "film_lane_unload.h"

#ifndef FILM_ROUTINES
#define FILM_ROUTINES film_plain
#endif
#ifndef FILM_OWN
#define FILM_OWN
#endif

FILM_OWN const block_routines FILM_ROUTINES = {fixed_lanes, load_lanes, leave_lanes, unload_lanes, retrace_lanes};
