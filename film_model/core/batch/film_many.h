/* Many contacts one after another: recorded, and sampled. docs/method.md, section 10. */
#ifndef FILM_MANY_H
#define FILM_MANY_H

#include "film_core.h"

/* film_record by lines alone for many contacts: lines one after the other, line_counts[i] of contact i, 0 if it fails or does
 * not begin with a velocity. Returns how many contacts were recorded: all, or those before the first that does not fit. */
FILM_API int64_t film_record_many(const film_curve *curve, const film_mesh *mesh, int64_t count, const film_start *start,
                                  film_line *lines, int64_t line_room, int32_t *line_counts, film_state *events,
                                  int32_t event_room);

/* Lines as columns: number k of line i, as in film_line, becomes numbers[k stride + i]; words: branches, at + stride phases. */
enum { FILM_LINE_NUMBERS = 19 };
FILM_API void film_line_columns(int64_t count, const film_line *lines, int64_t stride, double *numbers, int32_t *words);

/* film_sample for many contacts, with the lines of film_record_many: times[i samples + k], values[(v count + i) samples + k].
 * NaN for a contact without lines or whose last time is not finite. The bits are the same with all instructions. */
FILM_API void film_sample_many(int instructions, const film_curve *curve, int64_t count, const film_line *lines,
                               const int32_t *line_counts, int64_t samples, const double *times, double *values);

#endif
