/* States of a contact on modes, and steps of them. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

/* So many steps of no duration in sequence, and events at one time, mean that the motion does not go on. */
enum { MOST_SHORT_STEPS = 200 };

/* The velocity at which the core's own events would report that the impactor stops, which is found here instead. */
static const double NEVER = 1e300;

/* The reference velocity of an impactor that starts at rest, over delta_s/t_s. */
static const double SLOWEST = 1e-3;

/* The first step in contact, over the march's unit of time over the square root of the velocity's power in Hertz's contact
 * time: only where the search for a step size begins. */
static const double FIRST_STEP = 1e-2;

static double time_unit_velocity(const film_modal *s, double nu) { return nu / s->unit; }

/* ---------------------------------------------------------------- states */

int film_modal_init(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves,
                    const film_modal_start *start, double xi) {
    memset(s, 0, sizeof *s);
    int status = film_init(curve, &s->contact, xi, start->nu, 0.0, start->load, 0.0);
    if (status >= 0) status = film_damp(&s->contact, start->damping);
    if (status < 0) return status;
    if (!(start->rest >= 0.0 && start->rest < INFINITY) || !(start->mass > 0.0 && start->mass < INFINITY)) return FILM_BAD_NUMBER;
    if (!(start->unit > 0.0 && start->unit < INFINITY) || !(start->tolerance > 0.0)) return FILM_BAD_NUMBER;
    if (!isfinite(start->stop)) return FILM_BAD_NUMBER;
    if (curve->compliance != 0.0 || (start->rest > 0.0 && curve->stage[0].damped)) return FILM_BAD_CURVE;
    if (structure->carried > 0 && !(start->stretch >= 0.0 && start->stretch < INFINITY)) return FILM_BAD_NUMBER;
    s->contact.stop_velocity = NEVER;
    s->contact.moving_in = 0;
    s->load = s->contact.load;
    s->rest = start->rest;
    s->mass = start->mass;
    s->unit = start->unit;
    s->stretch = structure->carried > 0 ? start->stretch : 0.0;
    s->tolerance = start->tolerance;
    s->x = s->contact.xi;
    s->v = time_unit_velocity(s, s->contact.nu);
    s->speed = time_unit_velocity(s, fmax(fabs(s->contact.nu), SLOWEST));
    s->stop = time_unit_velocity(s, start->stop);
    s->moving_in = s->v > s->stop;
    s->flight_level = -1;
    s->event_at = INFINITY;
    memset(waves, 0, sizeof(double) * film_waves_size(structure));
    film_open_run(curve, &s->contact);
    return FILM_OK;
}

/* What a step of size `size` or less is tried with first. */
static int32_t level_of(const film_structure *structure, double size) {
    int32_t level = 0;
    while (level < structure->levels - 1 && ldexp(structure->longest, -level) > size) level++;
    return level;
}

/* sum += x, with *low the part that rounding drops. */
static void add_time(double *sum, double *low, double x) {
    double t = *sum + (x + *low);
    *low = (*sum - t) + (x + *low);
    *sum = t;
}

/* The work on indentation and rest compliance over the part `theta` of the step, by Gauss's rule of five points, which is
 * exact for these polynomials. */
static double work_of_step(const film_modal *s, double theta) {
    double depth[DEGREE + 1], rate[DEGREE + 1], work = 0.0;
    film_depth_polynomial(s, depth);
    for (int k = 0; k < DEGREE; k++) rate[k] = DEGREE * (depth[k + 1] - depth[k]);
    for (int k = 0; k < GAUSS; k++) {
        double at = theta * GAUSS_AT[k];
        work += GAUSS_WEIGHT[k] * film_force_at(s, at) * film_bernstein(rate, DEGREE - 1, at);
    }
    return theta * work;
}

/* The largest force of the step up to theta at its nodes, which for an undamped law is below that at a turn; of a damped one that of
 * the cubic. The law's at the interpolated rate is up to 3e-4 off where the step is long for the highest modes. */
static void raise_peak(const film_curve *curve, film_modal *s, double theta) {
    double *peak = &s->contact.force_peak, of[NODES];
    for (int j = 0; j < NODES && NODE_AT[j] <= theta; j++) *peak = fmax(*peak, s->force[j]);
    if (is_damped(curve, &s->contact)) {
        film_force_powers(s, of);
        double root = sqrt(fmax(of[2] * of[2] - 3.0 * of[1] * of[3], 0.0)); /* its derivative falls through 0 at: */
        double at = of[2] < 0.0 ? of[1] / (root - of[2]) : (root + of[2]) / (-3.0 * of[3]);
        *peak = fmax(*peak, film_force_at(s, at > 0.0 && at < theta ? at : theta));
    }
    s->peak = fmax(s->peak, *peak);
}

void film_stop_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    int32_t n = structure->modes;
    double x, v, t = s->tau;
    if (!s->has_step || t == 0.0) return;
    s->last_force = s->last_slope = 0.0;
    if (s->kind == FILM_STEP_CONTACT) {
        s->spent += work_of_step(s, t / s->h);
        raise_peak(curve, s, t / s->h);
        s->last_force = fmax(film_force_at(s, t / s->h), 0.0);
    }
    film_ball_at(s, t, &x, &v);
    s->shift = s->rate = 0.0;
    double *now = waves + begins_at(structure, s);
    for (int32_t i = 0; i < n; i++) {
        double w, u;
        film_moved_mode(structure, s, waves, i, t, &w, &u);
        now[i] = w;
        now[n + i] = u;
        s->shift += w;
        s->rate += u;
    }
    s->x = x;
    s->v = v;
    add_time(&s->time, &s->time_low, t);
    s->tau = s->since = 0.0;
}

int film_modal_input(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double load,
                     double nu_change, double stop_velocity) {
    if (!isfinite(load) || !isfinite(nu_change) || !isfinite(stop_velocity)) return FILM_BAD_NUMBER;
    double stop = time_unit_velocity(s, stop_velocity);
    if (load == s->load && nu_change == 0.0 && stop == s->stop) return FILM_OK;
    if (!film_turn_jump(structure, s, load, time_unit_velocity(s, nu_change))) {
        film_stop_step(structure, curve, s, waves);
        s->has_step = 0;
        s->event_at = INFINITY;
        s->flight_level = -1;
        s->v += time_unit_velocity(s, nu_change);
    }
    s->load = s->contact.load = load;
    s->stop = stop;
    if (s->v > s->stop) s->moving_in = 1;
    return FILM_OK;
}

/* ---------------------------------------------------------------- steps */

/* To the end of the step. */
static void finish_step(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    if (s->kind == FILM_STEP_JUMP && s->ends == ENDS_NODE) film_end_jump(structure, s, waves);
    if (s->kind == FILM_STEP_CONTACT && s->h > 0.0) {
        s->spent += work_of_step(s, 1.0);
        raise_peak(curve, s, 1.0);
        s->last_force = film_force_at(s, 1.0);
        s->last_slope = 2.0 * (s->last_force - film_force_at(s, 0.5)) / s->h;
    }
    s->short_steps = s->h > 0.0 ? 0 : s->short_steps + 1;
    add_time(&s->time, &s->time_low, s->h);
    s->tau = s->since = 0.0;
    s->has_step = 0;
    s->x = s->end_x;
    s->v = s->end_v;
    s->shift = s->end_shift;
    s->rate = s->end_rate;
    if (s->v > s->stop) s->moving_in = 1;
    s->half = !s->half;
}

/* Ends the run where the step has ended. */
static int end_run(const film_structure *structure, const film_curve *curve, film_modal *s) {
    film_state *contact = &s->contact;
    int free = contact->branch == FILM_FREE;
    double depth = s->x - s->shift, rate = (s->v - s->rate) * s->unit;
    /* a turn so close to the end of the step that it was not met before; the next step then has no duration */
    if (!free && contact->direction != s->end_direction) s->ends = ENDS_TURN;
    if (s->ends == ENDS_EDGE && !free) contact->xi = run_limit(curve, contact);
    else if (!free) contact->xi = film_indentation(curve, &contact->line, s->rest, depth);
    else contact->xi = is_damped(curve, contact) || depth > contact->xi_free ? fmax(depth, contact->xi_free) : contact->xi_free;
    if (free && !(contact->damper > 0.0)) contact->xi = contact->xi_free;
    contact->nu = s->ends == ENDS_TURN ? 0.0 : rate;
    int status = film_end_run(curve, contact, s->ends);
    s->peak = fmax(s->peak, contact->force_peak);
    if (contact->branch == FILM_FREE) {
        s->flight_level = -1;
        s->last_force = s->last_slope = 0.0;
    } else if (free) {
        s->level = level_of(structure, FIRST_STEP * s->unit);
        s->last_force = s->last_slope = 0.0;
    }
    return status;
}

/* Plans the step that begins here. */
int film_plan_step(film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    int status;
    s->contact.event = FILM_NO_EVENT;
    if (s->short_steps > MOST_SHORT_STEPS || s->steps >= film_most_steps(structure)) return FILM_TOO_MANY;
    if (!isfinite(s->x) || !isfinite(s->v) || !isfinite(s->shift) || !isfinite(s->rate)) return FILM_BAD_NUMBER;
    if (s->contact.branch == FILM_FREE) status = film_plan_flight(structure, curve, s, waves);
    else status = film_plan_contact(structure, curve, s, waves);
    if (status < 0) return status;
    s->steps++;
    s->tau = 0.0;
    s->has_step = 1;
    return FILM_OK;
}

/* Forward by *dt at most, within the planned step; *dt becomes the rest. */
int film_advance(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double *dt) {
    double to = fmin(s->event_at, s->h);
    s->contact.event = FILM_NO_EVENT;
    if (s->tau + *dt < to) {
        s->tau += *dt;
        *dt = 0.0;
        return FILM_OK;
    }
    if (to == INFINITY) return FILM_ENDLESS;
    *dt = fmax(*dt - (to - s->tau), 0.0);
    s->tau = to;
    if (s->event_at <= s->h) {
        if (is_damped(curve, &s->contact)) raise_peak(curve, s, to / s->h);
        return film_soft_event(structure, curve, s, waves);
    }
    finish_step(structure, curve, s, waves);
    return s->ends == ENDS_NODE ? FILM_OK : end_run(structure, curve, s);
}

int film_modal_step(film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double dt) {
    if (!(dt >= 0.0)) return FILM_BAD_NUMBER;
    while (s->steps < film_most_steps(structure)) {
        int status = s->has_step ? FILM_OK : film_plan_step(structure, curve, s, waves);
        if (status == FILM_OK) status = film_advance(structure, curve, s, waves, &dt);
        if (status == FILM_EVENT) s->steps += EVENT_WORK;
        if (status != FILM_OK || (dt == 0.0 && s->has_step)) return status;
    }
    return FILM_TOO_MANY;
}

/* ---------------------------------------------------------------- what a state tells */

/* The five values from x, v of the impactor and x - sum w_n with its rate, on a line. */
static void values_on(const film_curve *curve, const film_line *line, double rest, double unit, const double ball[4],
                      double values[5]) {
    double xi = film_indentation(curve, line, rest, ball[2]), nu = ball[3] * unit;
    film_at at = film_law_on(curve, line, xi, nu);
    values[0] = xi;
    values[1] = nu / (1.0 + rest * at.by_xi);
    values[2] = fmax(at.force, 0.0);
    values[3] = ball[1] * unit;
    values[4] = ball[0] - xi;
}

/* x, v, x - sum w_n and its rate now. */
static void current(const film_structure *structure, const film_modal *s, const double *waves, double now[4]) {
    double depth[DEGREE + 1], rate[DEGREE + 1];
    now[0] = s->x;
    now[1] = s->v;
    now[2] = s->x - s->shift;
    now[3] = s->v - s->rate;
    if (!s->has_step || !(s->tau > 0.0) || s->kind == FILM_STEP_REST) return;
    film_ball_at(s, s->tau, &now[0], &now[1]);
    if (s->kind == FILM_STEP_JUMP) {
        now[2] = now[0];
        now[3] = now[1];
        for (int32_t i = 0; i < structure->modes; i++) {
            double w, u;
            film_moved_mode(structure, s, waves, i, s->tau, &w, &u);
            now[2] -= w;
            now[3] -= u;
        }
        return;
    }
    film_depth_polynomial(s, depth);
    for (int k = 0; k < DEGREE; k++) rate[k] = DEGREE * (depth[k + 1] - depth[k]) / s->h;
    now[2] = film_bernstein(depth, DEGREE, s->tau / s->h);
    now[3] = film_bernstein(rate, DEGREE - 1, s->tau / s->h);
}

void film_modal_motion(const film_structure *structure, const film_curve *curve, const film_modal *s, const double *waves,
                       double values[5]) {
    double now[4];
    film_line line = s->contact.line;
    current(structure, s, waves, now);
    line.branch = s->contact.branch;
    values_on(curve, &line, s->rest, s->unit, now, values);
    if (s->contact.event == FILM_CONTACT_ENDS && !(s->contact.damper > 0.0)) values[0] = s->contact.xi_free;
    if (s->contact.event == FILM_CONTACT_BEGINS) values[0] = s->contact.xi;
}

int film_modal_jumps(const film_modal *s, double *x, double *nu) {
    if (!s->has_step || s->kind != FILM_STEP_JUMP || !(s->tau > 0.0)) return 0;
    film_ball_at(s, s->tau, x, nu);
    *nu *= s->unit;
    return 1;
}

film_contact film_modal_force(const film_curve *curve, const film_modal *s, double xi, double rate) {
    film_line line = s->contact.line;
    line.branch = s->contact.branch;
    film_at at = film_law_on(curve, &line, xi, rate);
    film_contact found = {at.force, at.by_xi, at.by_nu};
    return found;
}

double film_modal_work(const film_modal *s, double force) {
    int within = s->has_step && s->kind == FILM_STEP_CONTACT && s->tau > 0.0;
    return s->spent + (within ? work_of_step(s, s->tau / s->h) : 0.0) - 0.5 * s->rest * force * force;
}

void film_modal_energies(const film_structure *structure, const film_modal *s, const double *waves, double *energies) {
    double per = s->unit * s->unit / s->mass;
    const double *begin = waves + begins_at(structure, s);
    for (int32_t i = 0; i < structure->modes; i++) {
        double w = begin[i], u = begin[structure->modes + i];
        if (s->has_step && s->tau > 0.0) film_moved_mode(structure, s, waves, i, s->tau, &w, &u);
        energies[i] = 0.5 * (u * u + structure->square[i] * w * w) * per / structure->share[i];
    }
}

void film_modal_sensed(const film_structure *structure, const film_modal *s, const double *waves, int32_t sensors,
                       const double *weights, double *sensed) {
    const double *begin = waves + begins_at(structure, s);
    int within = s->has_step && s->tau > 0.0;
    double force = within && s->kind == FILM_STEP_CONTACT ? film_force_at(s, s->tau / s->h) : s->last_force;
    double push = s->mass / (s->unit * s->unit) * force;
    double stretched[FILM_MOST_CARRIED];
    film_stretch_now(structure, s, waves, stretched);
    memset(sensed, 0, 3 * sizeof(double) * (size_t)sensors);
    for (int32_t i = 0; i < structure->modes; i++) {
        double w = begin[i], u = begin[structure->modes + i];
        if (within) film_moved_mode(structure, s, waves, i, s->tau, &w, &u);
        double a = structure->share[i] * push - structure->drag[i] * u - structure->square[i] * w;
        if (i < structure->carried) a += stretched[i];
        for (int32_t k = 0; k < sensors; k++) {
            double weight = weights[(size_t)k * (size_t)structure->modes + (size_t)i];
            sensed[3 * k] += weight * w;
            sensed[3 * k + 1] += weight * u;
            sensed[3 * k + 2] += weight * a;
        }
    }
}

void film_modal_sample(const film_structure *structure, const film_curve *curve, const film_modal_segment *segments,
                       int32_t segment_count, const double *flights, const double *times, int64_t count, double *values,
                       int8_t *branches) {
    int32_t at = 0;
    film_modal s;
    memset(&s, 0, sizeof s);
    for (int64_t i = 0; i < count; i++) {
        double now[4];
        const double *waves = NULL;
        while (at + 1 < segment_count && segments[at + 1].time <= times[i]) at++;
        const film_modal_segment *of = &segments[at];
        s.x = of->x;
        s.v = of->v;
        s.shift = of->x - of->depth;
        s.rate = of->v - of->depth_rate;
        s.h = of->h;
        s.load = of->load;
        s.unit = of->unit;
        s.has_step = 1;
        s.tau = times[i] - of->time;
        s.kind = of->flight >= 0 ? FILM_STEP_JUMP : of->h < INFINITY ? FILM_STEP_CONTACT : FILM_STEP_REST;
        memcpy(s.force, of->force, sizeof s.force);
        memcpy(s.bend, of->bend, sizeof s.bend);
        if (of->flight < 0) s.tau = fmin(s.tau, of->h);
        else waves = flights + (size_t)of->flight * 2 * (size_t)structure->modes;
        current(structure, &s, waves, now);
        values_on(curve, &of->line, of->rest, of->unit, now, values + 5 * i);
        branches[i] = (int8_t)of->line.branch;
    }
}

void film_modal_sizes(int64_t sizes[6]) {
    sizes[0] = (int64_t)sizeof(film_structure);
    sizes[1] = (int64_t)sizeof(film_modal);
    sizes[2] = (int64_t)sizeof(film_modal_start);
    sizes[3] = (int64_t)sizeof(film_modal_segment);
    sizes[4] = (int64_t)sizeof(film_modal_event);
    sizes[5] = (int64_t)sizeof(film_modal_summary);
}
