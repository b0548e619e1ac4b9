/* Many contacts one after another: recorded, and sampled. docs/method.md, section 10. */
#include "batch/film_many.h"

#include "batch/film_batch.h"

#include <string.h>

/* The lines of one contact that begins with a velocity; *line_count is 0 if it fails. film_record's status. */
static int record_one(const film_curve *curve, const film_mesh *mesh, const film_start *s, film_line *lines, int64_t line_room,
                    int32_t *line_count, film_state *events, int32_t event_room) {
    film_state state;
    film_summary summary;
    int32_t room = line_room < FILM_MAX_SEGMENTS ? (int32_t)line_room : FILM_MAX_SEGMENTS, event_count = 0;
    *line_count = 0;
    int status = s->nu > 0.0 ? film_begin(curve, s, &state) : FILM_BAD_NUMBER;
    if (status >= 0)
        status = film_record(curve, mesh, &state, s->time_limit, lines, room, line_count, events, event_room, &event_count, &summary);
    if (status < 0) *line_count = 0;
    return status;
}

int64_t film_record_many(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                         film_line *lines, int64_t line_room, int32_t *line_counts, film_state *events, int32_t event_room) {
    film_mesh own = *mesh;
    own.ways = FILM_LINES_ALONE;
    for (int64_t i = 0; i < count; i++) {
        if (record_one(curve, &own, &start[i], lines, line_room, &line_counts[i], events, event_room) == FILM_FULL) return i;
        lines += line_counts[i];
        line_room -= line_counts[i];
    }
    return count;
}

/* Lines that are turned into columns at a time: as many as fill a line of the cache. */
enum { TURNED = 8 };

void film_line_columns(int64_t count, const film_line *lines, int64_t stride, double *numbers, int32_t *words) {
    double own[TURNED][FILM_LINE_NUMBERS];
    for (int64_t first = 0; first < count; first += TURNED) {
        int64_t some = count - first < TURNED ? count - first : TURNED;
        for (int64_t i = 0; i < some; i++) {
            memcpy(own[i], &lines[first + i], sizeof own[i]);
            words[first + i] = lines[first + i].branch;
            words[stride + first + i] = lines[first + i].phase;
        }
        for (int64_t k = 0; k < FILM_LINE_NUMBERS; k++)
            for (int64_t i = 0; i < some; i++) numbers[k * stride + first + i] = own[i][k];
    }
}

static void sample_nothing(int64_t samples, double *values, int64_t stride) {
    for (int64_t k = 0; k < 5; k++)
        for (int64_t j = 0; j < samples; j++) values[k * stride + j] = NAN;
}

void film_sample_many(int instructions, const film_curve *curve, int64_t count, const film_line *lines,
                      const int32_t *line_counts, int64_t samples, const double *times, double *values) {
    const block_routines *run = film_routines(instructions);
    for (int64_t i = 0, stride = count * samples; i < count; i++) {
        const double *own = &times[i * samples];
        int known = line_counts[i] > 0 && samples > 0 && isfinite(own[samples - 1]);
        if (known) run->sample(curve, lines, line_counts[i], own, samples, &values[i * samples], stride);
        else sample_nothing(samples, &values[i * samples], stride);
        lines += line_counts[i];
    }
}
