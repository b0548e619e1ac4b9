/* Many contacts one after another: recorded, and sampled. docs/method.md, section 10. */
#include "film_law.h"

int64_t film_record_many(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                         film_line *lines, int64_t line_room, int32_t *line_counts, film_state *events, int32_t event_room) {
    for (int64_t i = 0; i < count; i++) {
        const film_start *s = &start[i];
        film_state state;
        int32_t room = line_room < FILM_MAX_SEGMENTS ? (int32_t)line_room : FILM_MAX_SEGMENTS, event_count = 0;
        line_counts[i] = 0;
        int status = s->nu > 0.0 ? film_init(curve, &state, 0.0, s->nu, s->gamma, s->load, s->stop_velocity) : FILM_BAD_NUMBER;
        if (status >= 0) status = film_damp(&state, s->damping);
        if (status >= 0)
            status = film_record(curve, mesh, &state, s->time_limit, lines, room, &line_counts[i], events, event_room, &event_count);
        if (status == FILM_FULL) return i;
        if (status < 0) line_counts[i] = 0;
        lines += line_counts[i];
        line_room -= line_counts[i];
    }
    return count;
}

void film_sample_many(const film_curve *curve, int64_t count, const film_line *lines, const int32_t *line_counts,
                      int64_t samples, const double *times, double *values, int8_t *stages, int8_t *phases) {
    for (int64_t i = 0; i < count; i++) {
        film_sample(curve, lines, line_counts[i], &times[i * samples], samples, &values[5 * i * samples], stages, phases);
        lines += line_counts[i];
    }
}
