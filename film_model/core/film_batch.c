/* Impacts by the thousand. One impact after the other here: film_impact is the reference that a vector kernel, which
 * belongs in this file, has to agree with. */
#include "film_core.h"

#include <math.h>
#include <string.h>

int film_impact(const film_curve *curve, const film_mesh *mesh, const film_start *start, film_summary *summary) {
    film_state s;
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = NAN;
    summary->final_velocity = NAN;
    if (!(start->nu > 0.0)) return FILM_BAD_NUMBER;
    int status = film_init(curve, &s, 0.0, start->nu, start->gamma, start->load, start->stop_velocity);
    while (status >= 0) {
        status = film_step(curve, mesh, &s, start->time_limit - s.time);
        if (status != FILM_EVENT || s.event == FILM_CONTACT_ENDS) break;
        if (s.event == FILM_MAXIMUM_INDENTATION && s.xi > summary->maximum_indentation) {
            summary->maximum_indentation = s.xi;
            summary->time_of_maximum_indentation = s.time;
            summary->stage = s.stage_max;
        } else if (s.event == FILM_IMPACTOR_STOPS && isnan(summary->time_impactor_stops)) {
            summary->time_impactor_stops = s.time;
        }
    }
    if (status < 0) return status;
    summary->maximum_force = s.force_peak;
    summary->shift = s.shift;
    summary->work = s.spent;
    summary->lines = s.lines;
    if (status == FILM_EVENT) {
        summary->contact_duration = s.time;
        summary->permanent_indentation = s.xi;
        summary->final_velocity = s.nu;
    }
    return status;
}

void film_batch(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                film_summary *summary, int32_t *status) {
    for (int64_t i = 0; i < count; i++) status[i] = film_impact(curve, mesh, &start[i], &summary[i]);
}
