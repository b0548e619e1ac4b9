/* The motion on lines: to their ends, to a time on them. docs/method.md, sections 1 and 3. */
#include "march/film_march.h"

#include <string.h>

/* Each line starts where the motion is now. */
void film_open_line(film_state *s) {
    film_line *line = &s->line;
    line->time = s->time;
    line->xi = s->xi;
    line->nu = s->nu;
    line->shift = s->shift;
    line->work = s->work;
    line->spent = s->spent;
}

/* To the end of the current line. Momentum gives the target's displacement: xi and nu are closed forms, and
 * nu' = p - F, shift' = gamma F. docs/method.md, section 1. */
void film_follow(film_state *s) {
    s->shift = s->line.shift + s->gamma * (s->load * s->tau_end - (s->nu_end - s->line.nu));
    s->spent = s->line.spent + (s->work_end - s->line.work);
    if (s->line.damper > 0.0) s->spent += film_dissipated(&s->line, s->tau_end, s->xi_end, s->nu_end, s->work_end);
    s->xi = s->xi_end;
    s->nu = s->nu_end;
    s->elastic = s->force_end;
    s->work = s->work_end;
    if (s->elastic > s->force_peak) s->force_peak = s->elastic;
    s->leg_node += s->line_ends != ENDS_PART && s->line_ends != ENDS_STOP && s->line_ends != ENDS_RELEASE;
}

/* xi, xi', force, nu and shift on a line, tau after it began, on the march's own axis. The force is the true law's.
 * docs/method.md, section 3. */
static void evaluate(const film_curve *curve, const film_line *line, double tau, double values[5]) {
    motion m = motion_from(1.0, line->nu, line->gamma, line->load, line->phi, line->kappa, line->damping);
    double x, y, work;
    motion_at(&m, tau, &x, &y);
    double nu = y * (1.0 + line->gamma * line->damping) + line->gamma * (line->phi + line->kappa * x);
    values[0] = line->xi + x;
    law_at(curve, line, values[0], &values[2], &work);
    if (line->damper > 0.0) values[2] = fmax(total_force(line, damping_at(curve, line, values[0]), values[2], nu), 0.0);
    values[1] = nu - line->gamma * values[2];
    values[3] = nu;
    values[4] = line->shift + (line->branch == FILM_FREE ? 0.0 : line->gamma * (line->load * tau - (nu - line->nu)));
}

/* The current point becomes that on the line, tau after it began. */
void film_move_along(const film_curve *curve, film_state *s, double tau) {
    double values[5];
    evaluate(curve, &s->line, tau, values);
    s->xi = values[0];
    s->nu = values[3];
    s->shift = values[4];
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = values[2];
    s->spent = s->line.spent + (s->work - s->line.work);
    if (s->line.damper > 0.0) s->spent += film_dissipated(&s->line, tau, s->xi, s->nu, s->work);
}

void film_evaluate(const film_curve *curve, const film_line *line, double tau, double values[5]) {
    double x[5]; /* values may be unaligned */
    evaluate(curve, line, tau, x);
    film_split_off_spring(curve, line, x);
    memcpy(values, x, sizeof x);
}

void film_motion(const film_curve *curve, const film_state *s, double values[5]) {
    double x[5] = {s->xi, s->nu - s->gamma * s->force, s->force, s->nu, s->shift};
    film_state at = *s;
    film_open_run(curve, &at);
    film_split_off_spring(curve, &at.line, x);
    memcpy(values, x, sizeof x);
}

void film_sample(const film_curve *curve, const film_line *lines, int32_t line_count, const double *times,
                 int64_t count, double *values, int8_t *stages, int8_t *phases) {
    int32_t at = 0;
    for (int64_t i = 0; i < count; i++) {
        while (at + 1 < line_count && lines[at + 1].time <= times[i]) at++;
        film_evaluate(curve, &lines[at], times[i] - lines[at].time, values + 5 * i);
        stages[i] = (int8_t)(lines[at].branch < FILM_FREE ? FILM_BRANCH : lines[at].branch);
        phases[i] = (int8_t)lines[at].phase;
    }
}
