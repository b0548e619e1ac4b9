/* Steps in contact: how long they are, and the events in them. docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

/* The error of a step of twice the duration over that of this one: a longer step is tried if its error can be expected to meet
 * the tolerance. */
static const double GROWTH = 40.0;

/* The end of a step at an event is sought to this fraction of the march's unit of time, or to CUT_SHARE of the tolerance. */
static const double CUT_TOLERANCE = 1e-10, CUT_SHARE = 1e-3;

/* An event this close to the beginning of a step, as a fraction of it, happens there. */
static const double AT_ONCE = 1e-13;

/* Contact under a load rests when its energy above that of equilibrium is below this fraction of load times indentation: the
 * force then differs from the load by about 1e-6 of it. Without it a structure's fading vibration turns without end;
 * tests/test_modal_component.py. The energy is computed only where the force is as near to the load as REST_FORCE says. */
static const double REST_ENERGY = 1e-12, REST_FORCE = 1e-5;

/* A step to an event takes as long as so many others at each try: its table is made, sines and cosines of every mode. */
enum { CUT_WORK = 6 };

enum { CUTS = 8, TURNS_A_STEP = 16, REST_STEPS = 4 };

/* ---------------------------------------------------------------- polynomials whose roots are events */

/* The rate of x - sum w_n over the step along `direction`, times the step's duration: degree 6. */
static void rate_polynomial(const film_modal *s, double direction, double bernstein[DEGREE + 1]) {
    double depth[DEGREE + 1];
    film_depth_polynomial(s, depth);
    for (int k = 0; k < DEGREE; k++) bernstein[k] = direction * DEGREE * (depth[k + 1] - depth[k]);
}

/* From powers to Bernstein coefficients of degree n <= 4. */
static void from_powers(const double *powers, int degree, double *bernstein) {
    static const double choose[5][5] = {{1, 0, 0, 0, 0}, {1, 1, 0, 0, 0}, {1, 2, 1, 0, 0}, {1, 3, 3, 1, 0}, {1, 4, 6, 4, 1}};
    for (int i = 0; i <= degree; i++) {
        bernstein[i] = 0.0;
        for (int k = 0; k <= i; k++) bernstein[i] += powers[k] * choose[i][k] / choose[degree][k];
    }
}

/* x - sum w_n at which the run ends in this direction; INFINITY: nowhere. */
static double depth_of_edge(const film_curve *curve, const film_modal *s, int direction) {
    double edge = run_edge(curve, &s->contact, direction);
    if (!(edge < INFINITY) || s->rest == 0.0) return edge;
    return edge + s->rest * film_law_on(curve, &s->contact.line, edge, 0.0).force;
}

/* ---------------------------------------------------------------- events that a step only passes */

/* Whether a turn leaves the law's branch as it is, so that the step goes on through it. */
static int is_soft_turn(const film_curve *curve, const film_state *contact, int direction) {
    if (contact->branch >= 0) return direction < 0 || curve->stage[contact->branch].unloading == FILM_RETRACE;
    return film_reload_exponent(curve, contact) == 0.0;
}

/* Where in the step the modes turn, near `at`, where the polynomial of `rate` does: high ones move within the step otherwise than it, and
 * a flat maximum shows it. One step of Newton's method. */
static double turn_of_modes(const film_structure *structure, film_modal *s, const double *waves, const double *rate, double at) {
    double second[DEGREE - 1], x, v, w, u, t = at * s->h;
    for (int k = 0; k < DEGREE - 1; k++) second[k] = (DEGREE - 1) * (rate[k + 1] - rate[k]);
    film_ball_at(s, t, &x, &v);
    for (int32_t i = 0; i < structure->modes; i++) {
        film_moved_mode(structure, s, waves, i, t, &w, &u);
        v -= u;
    }
    s->steps += CUT_WORK;
    return at - v * s->h / film_bernstein(second, DEGREE - 2, at);
}

/* Sets the next event after `from` [0 .. 1 of the step] that the step passes: a turn, or the impactor's stop. */
void film_next_event(const film_structure *structure, const film_curve *curve, film_modal *s, const double *waves, double from) {
    double depth[DEGREE + 1], bernstein[DEGREE + 1], powers[NODES], speed[NODES + 1], per = s->h / (s->unit * s->unit), at;
    s->event_at = INFINITY;
    if (s->kind != FILM_STEP_CONTACT || !(s->h > 0.0)) return;
    if (is_soft_turn(curve, &s->contact, s->contact.direction)) {
        rate_polynomial(s, s->contact.direction, bernstein);
        at = film_first_below(bernstein, DEGREE - 1, from);
        if (at < 1.0) {
            film_depth_polynomial(s, depth);
            if (s->contact.direction > 0 && film_bernstein(depth, DEGREE, at) > s->deepest)
                at = fmin(fmax(turn_of_modes(structure, s, waves, bernstein, at), from), 1.0);
            s->event_at = at * s->h;
            s->event_kind = FILM_MAXIMUM_INDENTATION;
        }
    }
    if (!s->moving_in) return;
    film_force_powers(s, powers);
    speed[0] = s->v - s->stop;
    for (int k = 0; k < NODES; k++) speed[k + 1] = -per * powers[k] / (k + 1);
    speed[1] += per * s->load;
    from_powers(speed, NODES, bernstein);
    at = film_first_below(bernstein, NODES, from);
    if (at <= 1.0 && at * s->h < s->event_at) {
        s->event_at = at * s->h;
        s->event_kind = FILM_IMPACTOR_STOPS;
    }
}

/* Handles the event at event_at, to which tau has advanced. */
int film_soft_event(const film_structure *structure, const film_curve *curve, film_modal *s, const double *waves) {
    double bernstein[DEGREE + 1], theta = s->event_at / s->h;
    int status;
    if (s->event_kind == FILM_IMPACTOR_STOPS) {
        s->moving_in = 0;
        status = film_stop(&s->contact);
    } else {
        film_depth_polynomial(s, bernstein);
        double depth = film_bernstein(bernstein, DEGREE, theta);
        s->deepest = fmax(s->deepest, depth);
        s->contact.xi = film_indentation(curve, &s->contact.line, s->rest, depth);
        s->contact.nu = 0.0;
        status = film_end_run(curve, &s->contact, ENDS_TURN);
        s->contact.force_peak = fmax(s->contact.force_peak, s->contact.elastic);
        s->peak = fmax(s->peak, s->contact.force_peak);
    }
    film_next_event(structure, curve, s, waves, theta);
    return status;
}

/* ---------------------------------------------------------------- events that end a step */

/* edge - depth in this direction as Bernstein coefficients; whether they are all above 0, so that the edge is not reached. */
static int is_inside(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], int direction,
                     double bernstein[DEGREE + 1]) {
    double edge = depth_of_edge(curve, s, direction);
    int inside = 1;
    for (int i = 0; i <= DEGREE && edge < INFINITY; i++) {
        bernstein[i] = direction * (edge - depth[i]);
        inside &= bernstein[i] > 0.0;
    }
    return inside;
}

/* Where, from `from` to `to` in the step, a damped contact on its way out is released; 2: nowhere. The cubic force falls below 0
 * earlier where the law's vanishes without a change of sign. */
static double find_release(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1], double from, double to) {
    for (int k = 0; k <= NODES; k++) {
        double at = k < NODES ? NODE_AT[k] : to;
        if (!(at > from) || at > to) continue;
        if (!film_pushes(curve, s, depth, at)) return film_push_changes(curve, s, depth, from, at);
        from = at;
    }
    return 2.0;
}

/* Where in the step its run ends, and how: the first edge, turn or release after the turns that the step passes; 2: nowhere. */
static double find_end(const film_curve *curve, film_modal *s, int *ends, int *direction) {
    double depth[DEGREE + 1], bernstein[DEGREE + 1], from = 0.0;
    int d = s->contact.direction, damped = is_damped(curve, &s->contact);
    film_depth_polynomial(s, depth);
    int soft = !damped && is_soft_turn(curve, &s->contact, 1) && is_soft_turn(curve, &s->contact, -1);
    if (soft && is_inside(curve, s, depth, -d, bernstein)) { /* no turn leads to an end */
        *ends = ENDS_EDGE;
        *direction = d;
        return is_inside(curve, s, depth, d, bernstein) ? 2.0 : film_first_below(bernstein, DEGREE, 0.0);
    }
    for (int k = 0; k < TURNS_A_STEP; k++) {
        double best, at;
        rate_polynomial(s, d, bernstein);
        best = film_first_below(bernstein, DEGREE - 1, from);
        *ends = ENDS_TURN;
        *direction = d;
        at = is_inside(curve, s, depth, d, bernstein) ? 2.0 : film_first_below(bernstein, DEGREE, from);
        if (at <= 1.0 && at <= best) {
            best = at;
            *ends = ENDS_EDGE;
        }
        if (d < 0 && damped && (at = find_release(curve, s, depth, from, fmin(best, 1.0))) <= 1.0) {
            best = at;
            *ends = ENDS_RELEASE;
        }
        if (best > 1.0 || *ends != ENDS_TURN || !is_soft_turn(curve, &s->contact, d)) return best;
        from = best;
        d = -d;
    }
    return 2.0;
}

/* The second derivative of x - sum w_n at the end of the step. */
static double second_rate(const film_modal *s) {
    double depth[DEGREE + 1];
    film_depth_polynomial(s, depth);
    return DEGREE * (DEGREE - 1) * (depth[DEGREE] - 2.0 * depth[DEGREE - 1] + depth[DEGREE - 2]) / (s->h * s->h);
}

/* By how much the step should be longer to end at the event. */
static double correction(const film_curve *curve, const film_modal *s, int ends, int direction) {
    double rate = s->end_v - s->end_rate, depth = s->end_x - s->end_shift;
    if (ends == ENDS_EDGE) return (depth_of_edge(curve, s, direction) - depth) / rate;
    if (ends == ENDS_TURN) return -rate / second_rate(s);
    film_at at = film_law_on(curve, &s->contact.line, depth, rate * s->unit);
    return -at.force / (at.by_xi * rate + at.by_nu * s->unit * second_rate(s));
}

/* A step of no duration: the event happens here. */
static void stay(const film_structure *structure, film_modal *s, double *waves) {
    s->h = 0.0;
    memset(s->bend, 0, sizeof s->bend);
    s->end_x = s->x;
    s->end_v = s->v;
    s->end_shift = s->shift;
    s->end_rate = s->rate;
    memcpy(waves + ends_at(structure, s), waves + begins_at(structure, s), 2 * sizeof(double) * (size_t)structure->modes);
}

/* The step again, so long that it ends where find_end says. */
static int cut(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double at, int ends,
               int direction) {
    film_table table = film_table_at(structure, structure->levels);
    double full = s->h, h = at * full, error;
    film_equations e;
    s->ends = ends;
    s->end_direction = direction;
    for (int k = 0; k < CUTS; k++) {
        if (!(h > AT_ONCE * full)) {
            stay(structure, s, waves);
            return FILM_OK;
        }
        film_loops_of(structure)->fill(structure, &table, h);
        s->steps += CUT_WORK;
        int status = film_try_step(structure, curve, s, waves, &table, h, &e, &error);
        if (status == FILM_OK) status = film_take_step(structure, s, waves, &table, &e);
        if (status < 0) return status;
        double more = correction(curve, s, ends, direction);
        if (!(fabs(more) > fmax(CUT_TOLERANCE, CUT_SHARE * s->tolerance) * s->unit) || !(fabs(more) < INFINITY)) break;
        h = fmin(fmax(h + more, 0.25 * h), fmin(2.0 * h, full));
    }
    return FILM_OK;
}

/* ---------------------------------------------------------------- rest */

/* The displacement of mode i under the load, at rest. */
static double static_wave(const film_structure *structure, const film_modal *s, int32_t i) {
    return structure->share[i] * s->mass / (s->unit * s->unit) * s->load / structure->square[i];
}

/* Whether the motion that is left at the beginning of the step is negligible. */
static int is_resting(const film_structure *structure, const film_curve *curve, const film_modal *s, const double *waves) {
    if (!(s->load > 0.0) || structure->rigid > 0 || structure->carried > 0 || fabs(s->last_force - s->load) > REST_FORCE * s->load) return 0;
    double xi = film_indentation(curve, &s->contact.line, s->rest, s->x - s->shift), per = s->unit * s->unit / s->mass;
    film_at at = film_law_on(curve, &s->contact.line, xi, 0.0);
    double excess = at.force - s->load, speed = s->v * s->unit;
    double energy = speed * speed + excess * excess * (1.0 / at.by_xi + s->rest);
    const double *begin = waves + begins_at(structure, s);
    for (int32_t i = 0; i < structure->modes; i++) {
        double w = begin[i] - static_wave(structure, s, i), u = begin[structure->modes + i];
        energy += (u * u + structure->square[i] * w * w) * per / structure->share[i];
    }
    return at.by_xi > 0.0 && 0.5 * energy <= REST_ENERGY * s->load * (xi - s->contact.xi_free);
}

/* The contact in equilibrium, from now on. */
static void rest(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    double xi = film_indentation(curve, &s->contact.line, s->rest, s->x - s->shift), *begin = waves + begins_at(structure, s);
    for (int k = 0; k < REST_STEPS; k++) {
        film_at at = film_law_on(curve, &s->contact.line, xi, 0.0);
        xi -= (at.force - s->load) / at.by_xi;
    }
    s->kind = FILM_STEP_REST;
    s->h = s->event_at = INFINITY;
    s->v = s->rate = s->shift = s->contact.nu = 0.0;
    for (int32_t i = 0; i < structure->modes; i++) {
        begin[i] = static_wave(structure, s, i);
        begin[structure->modes + i] = 0.0;
        s->shift += begin[i];
    }
    s->x = xi + s->rest * s->load + s->shift;
    s->last_force = s->load;
    s->last_slope = 0.0;
    s->contact.xi = xi;
    s->contact.phase = FILM_RESTING;
}

/* ---------------------------------------------------------------- the plan */

/* Plans the next step in contact: of the largest duration that meets the tolerance, or to the event that ends it. */
int film_plan_contact(film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    double error = 0.0, at;
    film_equations e;
    int ends, direction, status = FILM_TOO_MANY;
    if (is_resting(structure, curve, s, waves)) {
        rest(structure, curve, s, waves);
        return FILM_OK;
    }
    if (s->contact.phase == FILM_RESTING) s->contact.phase = run_phase(&s->contact);
    s->kind = FILM_STEP_CONTACT;
    for (;; s->level++) {
        if (s->level >= structure->levels) return FILM_TOO_MANY;
        film_table table = film_level_table(structure, s->level);
        double h = ldexp(structure->longest, -s->level);
        for (int j = 0; j < NODES; j++) s->force[j] = fmax(s->last_force + s->last_slope * NODE_AT[j] * h, 0.0);
        status = film_try_step(structure, curve, s, waves, &table, h, &e, &error);
        if (status == FILM_OK && error <= s->tolerance) status = film_take_step(structure, s, waves, &table, &e);
        else status = FILM_TOO_MANY;
        if (status == FILM_OK) break;
        s->steps++;
    }
    s->ends = ENDS_NODE;
    at = find_end(curve, s, &ends, &direction);
    if (at <= 1.0) status = cut(structure, curve, s, waves, at, ends, direction);
    else if (GROWTH * error < s->tolerance && s->level > 0) s->level--;
    if (status < 0) return status;
    film_next_event(structure, curve, s, waves, 0.0);
    return FILM_OK;
}
