/* Friction of many impacts by springs, in lanes of double and of single precision. Internal to film_lanes.c. docs/method.md, section 15. */
#ifndef FILM_LANE_SPRINGS_H
#define FILM_LANE_SPRINGS_H

#include "lanes/film_lane_power.h"

#include <float.h>

/* Lanes of a group whose springs slip side by side: more would not fit into the nearest cache, fewer wait for each other. */
#define SPRUNG (LANES < 128 / (int)sizeof(real) ? LANES : 128 / (int)sizeof(real))
#define EACH_SPRUNG(l) for (int l = 0; l < SPRUNG; l++)

enum { CHUNK = 16 }; /* steps of a group that are prepared together, since they do not wait for each other */

/* Least rise of the depth in a step that is not taken as none: 1 over it times any depth is finite. */
#define LEAST_RISE 1e-20f

/* Rounding of the sum of springs that all slip, and of what is left to move before one of them sticks, which is larger. */
#define SUMMED (256 * ROUNDING)
#define STUCK (2048 * ROUNDING)

/* The names of film_lane_slide.h, once for each precision. */
#define before_cubic IN_LANES(before_cubic)
#define begin_step IN_LANES(begin_step)
#define begin_time IN_LANES(begin_time)
#define bend_knots IN_LANES(bend_knots)
#define between_knots IN_LANES(between_knots)
#define end_in IN_LANES(end_in)
#define end_slide IN_LANES(end_slide)
#define end_step IN_LANES(end_step)
#define follow_leg IN_LANES(follow_leg)
#define group_plan IN_LANES(group_plan)
#define group_steps IN_LANES(group_steps)
#define limit_step IN_LANES(limit_step)
#define measure_step IN_LANES(measure_step)
#define move_springs IN_LANES(move_springs)
#define passed IN_LANES(passed)
#define plan_step IN_LANES(plan_step)
#define plan_steps IN_LANES(plan_steps)
#define put_apart IN_LANES(put_apart)
#define put_knots IN_LANES(put_knots)
#define put_limits IN_LANES(put_limits)
#define put_springs IN_LANES(put_springs)
#define slide_group IN_LANES(slide_group)
#define slide_lanes IN_LANES(slide_lanes)
#define sliding_group IN_LANES(sliding_group)
#define slip_springs IN_LANES(slip_springs)
#define spring_group IN_LANES(spring_group)
#define take_friction IN_LANES(take_friction)
#define take_knots IN_LANES(take_knots)
#define take_steps IN_LANES(take_steps)
#define watch_group IN_LANES(watch_group)

#define real double
#define ROUNDING DBL_EPSILON
#define IN_LANES(name) name##_double
#include "lanes/film_lane_slide.h"
#undef real
#undef ROUNDING
#undef IN_LANES
#define real float
#define ROUNDING FLT_EPSILON
#define IN_LANES(name) name##_single
#include "lanes/film_lane_slide.h"

#endif
