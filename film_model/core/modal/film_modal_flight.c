/* Flights between contacts: impactor and modes move freely, and the next touch is found without missing any.
 * docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

/* The interpolation of a vibration of amplitude a over a step of phase z errs by at most this times z^8 a: the largest value of
 * theta^2 (1 - theta)^2 prod |theta - node| over 8!. It never errs by more than OVERSHOOT times a. */
static const double INTERPOLATION = 8.5e-9, OVERSHOOT = 4.0;

/* A touch is too shallow to matter below this power of the tolerance of a step, over the depth: its impulse is smaller still. */
static const double GRAZING = 2.0 / 3.0;

/* A jump is worthwhile beyond this many steps. */
static const double JUMP_STEPS = 2.0;

/* A mode is slow that turns by less than this angle [rad] while a jump begins to be worthwhile. */
static const double SLOW = 1e-3;

/* A jump takes as long as this many steps: sines, cosines and roots of every mode. */
enum { JUMP_WORK = 8 };

/* A touch is sought to this fraction of the march's unit of time. */
static const double LANDING = 1e-12;

enum { TOUCH_STEPS = 8, DENT_SAMPLES = 16 };

/* A bound on the error of the interpolation over a step of this level. */
static double blur_of(const film_structure *structure, const double *amplitude, int32_t level) {
    double h = ldexp(structure->longest, -level), error = 0.0;
    for (int32_t i = structure->rigid; i < structure->modes; i++) {
        double z = structure->frequency[i] * h, z2 = z * z, z4 = z2 * z2, share = INTERPOLATION * z4 * z4;
        error += amplitude[i] * (share < OVERSHOOT ? share : OVERSHOOT);
    }
    return error;
}

/* The bound on the motion of all modes, and the shortest steps: those whose interpolation errs by less than a touch that
 * would matter is deep. The half of waves that the next step writes holds the amplitudes. */
static void start_flight(const film_structure *structure, film_modal *s, double *waves) {
    double shallow = pow(s->tolerance, GRAZING) * s->speed * s->unit, *amplitude = waves + ends_at(structure, s);
    const double *begin = waves + begins_at(structure, s);
    double shared = film_shared_energy(structure, s, waves);
    s->reach = 0.0;
    for (int32_t i = structure->rigid; i < structure->modes; i++) {
        double most = i < structure->carried ? sqrt(2.0 * shared * structure->share[i]) / structure->frequency[i] : 0.0;
        amplitude[i] = fmax(most, hypot(begin[i], begin[structure->modes + i] / structure->frequency[i]));
        s->reach += amplitude[i];
    }
    for (int k = 0; k < FILM_FLIGHTS; k++) s->blur[k] = INFINITY;
    for (s->flight_level = 0; s->flight_level < structure->levels; s->flight_level++) {
        for (int k = FILM_FLIGHTS - 1; k > 0; k--) s->blur[k] = s->blur[k - 1];
        s->blur[0] = blur_of(structure, amplitude, s->flight_level);
        if (s->blur[0] <= shallow || s->flight_level == structure->levels - 1) break;
    }
    s->flight_size = FILM_FLIGHTS / 2;
}

/* The first time at which the impactor's depth x + v t + a t^2/2 reaches a structure that comes to meet it by `reach`: INFINITY
 * if never. */
static double meeting(const film_modal *s, double x, double v, double a, double reach) {
    double gap = fmax(s->contact.xi_free - x - reach, 0.0), root = v * v + 2.0 * a * gap;
    if (gap == 0.0 && reach > 0.0) return 0.0; /* a structure at rest may be touched without ever being pressed */
    if (a == 0.0) return v > 0.0 ? gap / v : INFINITY;
    if (root < 0.0) return INFINITY;
    if (v > 0.0) return 2.0 * gap / (v + sqrt(root));
    return a > 0.0 ? (sqrt(root) - v) / a : INFINITY;
}

/* A time before which the modes cannot bring the struck point to the impactor under a load; at least `enough`, if that is
 * easily shown; INFINITY if never. A mode moves by at most its amplitude A, and from w with the velocity u by at least u t -
 * omega^2 A t^2/2. The latter is for slow modes, whose amplitudes may be beyond all the rest: without a load, an impactor that
 * leaves them behind is out of reach. */
static double earliest(const film_structure *structure, const film_modal *s, const double *waves, double load, double enough) {
    int32_t n = structure->modes, i;
    double x = s->x, v = s->v, a = load / (s->unit * s->unit), reach = s->reach;
    const double *begin = waves + begins_at(structure, s);
    for (i = 0; i < structure->rigid; i++) {
        x -= begin[i];
        v -= begin[n + i];
    }
    double away = a == 0.0 && v < 0.0 ? (x + reach - s->contact.xi_free) / -v : INFINITY, wait = meeting(s, x, v, a, reach);
    for (; i < n && structure->carried == 0 && wait <= enough && structure->frequency[i] * enough < SLOW; i++) {
        double omega = structure->frequency[i], amplitude = hypot(begin[i], begin[n + i] / omega);
        x -= begin[i];
        v -= begin[n + i];
        a += omega * omega * amplitude;
        reach = i + 1 < n ? fmax(reach - amplitude, 0.0) : 0.0;
        wait = fmax(wait, meeting(s, x, v, a, reach));
    }
    return wait >= away ? INFINITY : wait;
}

/* A jump of this length, which may be infinite. */
static void jump(film_modal *s, double h) {
    s->kind = FILM_STEP_JUMP;
    s->h = h;
    if (h < INFINITY) s->steps += JUMP_WORK;
}

void film_end_jump(const film_structure *structure, film_modal *s, double *waves) {
    int32_t n = structure->modes;
    double *end = waves + ends_at(structure, s), h = s->h;
    s->end_shift = s->end_rate = 0.0;
    for (int32_t i = 0; i < n; i++) {
        film_moved_mode(structure, s, waves, i, h, &end[i], &end[n + i]);
        s->end_shift += end[i];
        s->end_rate += end[n + i];
    }
    film_ball_at(s, h, &s->end_x, &s->end_v);
}

/* Where a damped contact begins within the flight's step, inside its dent; 2: nowhere. */
static double find_grip(const film_curve *curve, const film_modal *s, const double depth[DEGREE + 1]) {
    for (int k = 1; k <= DENT_SAMPLES; k++) {
        double at = (double)k / DENT_SAMPLES;
        if (film_pushes(curve, s, depth, at)) return film_push_changes(curve, s, depth, (k - 1.0) / DENT_SAMPLES, at);
    }
    return 2.0;
}

/* Where within the step the impactor comes as near as `blur`, 2 if nowhere. */
static double find_touch(const film_modal *s, double blur) {
    double depth[DEGREE + 1], gap[DEGREE + 1];
    film_depth_polynomial(s, depth);
    for (int k = 0; k <= DEGREE; k++) gap[k] = s->contact.xi_free - blur - depth[k];
    return film_first_below(gap, DEGREE, 0.0);
}

/* The step of the flight again, of the duration h, with the membrane forces. */
static int end_at(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double h) {
    film_table table = film_table_at(structure, structure->levels);
    film_equations e;
    double error;
    film_loops_of(structure)->fill(structure, &table, h);
    s->steps += JUMP_WORK;
    int status = film_try_step(structure, curve, s, waves, &table, h, &e, &error);
    return status == FILM_OK ? film_take_step(structure, s, waves, &table, &e) : status;
}

/* Ends the flight at the touch near h, by Newton's method on the sum of the modes. */
static int land(const film_structure *structure, const film_curve *curve, film_modal *s, double *waves, double h) {
    for (int k = 0; k < TOUCH_STEPS; k++) {
        if (structure->carried > 0 && h > 0.0) {
            int status = end_at(structure, curve, s, waves, h);
            if (status < 0) return status;
        } else {
            jump(s, h);
            film_end_jump(structure, s, waves);
        }
        if (s->end_x - s->end_shift > s->contact.xi_free && s->contact.damper > 0.0) break;
        double rate = s->end_v - s->end_rate, more = (s->contact.xi_free - (s->end_x - s->end_shift)) / rate;
        if (!(rate > 0.0) || fabs(more) <= LANDING * s->unit || !(h + more >= 0.0) || fabs(more) > 0.1 * h) break;
        h += more;
    }
    s->ends = ENDS_EDGE;
    return FILM_OK;
}

static double worthwhile_jump(const film_structure *structure, const film_modal *s) {
    return JUMP_STEPS * ldexp(structure->longest, -s->flight_level);
}

int film_turn_jump(const film_structure *structure, film_modal *s, double load, double v_change) {
    double x, v, wait;
    if (!s->has_step || s->kind != FILM_STEP_JUMP || s->ends != ENDS_NODE || structure->rigid > 0) return 0;
    film_ball_at(s, s->tau, &x, &v);
    wait = meeting(s, x, v + v_change, load / (s->unit * s->unit), s->reach);
    if (!(wait > worthwhile_jump(structure, s))) return 0;
    s->x = x;
    s->v = v + v_change;
    s->since = s->tau;
    s->h = s->tau + wait;
    return 1;
}

int film_leaves(const film_structure *structure, const film_modal *s, const double *waves) {
    return earliest(structure, s, waves, 0.0, worthwhile_jump(structure, s)) == INFINITY;
}

/* Plans the next part of a flight: a jump over the time in which no touch is possible, else a step. A step is as long as it
 * surely ends before a touch; the shortest ones see every touch, and end there. */
int film_plan_flight(film_structure *structure, const film_curve *curve, film_modal *s, double *waves) {
    double depth[DEGREE + 1], error, at = 2.0;
    film_equations e;
    if (s->flight_level < 0) start_flight(structure, s, waves);
    int in_dent = s->contact.damper > 0.0 && curve->stage[0].damped && s->x - s->shift > s->contact.xi_free;
    int32_t k = in_dent ? 0 : s->flight_size;
    double shortest = ldexp(structure->longest, -s->flight_level), worthwhile = worthwhile_jump(structure, s);
    double wait = earliest(structure, s, waves, s->load, in_dent ? 0.0 : worthwhile);
    s->ends = ENDS_NODE;
    s->event_at = INFINITY;
    if (wait > worthwhile && structure->carried == 0) {
        jump(s, wait);
        return FILM_OK;
    }
    s->kind = FILM_STEP_FLIGHT;
    for (; s->flight_level - k < structure->levels; k--) { /* k < 0: as short as the membrane forces need */
        if (k > 0 && !(s->blur[k] < INFINITY)) continue;
        film_table table = film_level_table(structure, s->flight_level - k);
        int status = film_try_step(structure, curve, s, waves, &table, ldexp(shortest, k), &e, &error);
        if (structure->carried > 0 && (status == FILM_TOO_MANY || error > s->tolerance)) continue;
        if (status == FILM_OK) status = film_take_step(structure, s, waves, &table, &e);
        if (status < 0) return status;
        if (in_dent) {
            film_depth_polynomial(s, depth);
            at = find_grip(curve, s, depth);
            break;
        }
        at = find_touch(s, k > 0 ? s->blur[k] : 0.0);
        if (at > 1.0 || k <= 0) break;
    }
    if (s->flight_level - k >= structure->levels) return FILM_TOO_MANY;
    s->flight_size = k < FILM_FLIGHTS - 1 && at > 1.0 ? k + 1 : k < 0 ? 0 : k;
    return at <= 1.0 ? land(structure, curve, s, waves, at * s->h) : FILM_OK;
}
