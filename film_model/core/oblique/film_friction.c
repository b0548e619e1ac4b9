/* The phases of friction in one impact, the events between them, and the path of what has stuck. */
#include "oblique/film_friction_parts.h"

#include <math.h>
#include <string.h>

enum { MOST_PIECES = 16 };
enum { NOTHING, ENDS, TURNS, CORNER, CAUGHT }; /* how a step ends */

/* terms left out at first touch, and impulses at the end of contact, over the scale; exact, coarse and quick */
static const double ROUNDING[3] = {1e-16, 1e-10, 3e-7};
static const double CLEAR = 10.0;     /* changes of the remaining way, in which no event falls if none is so near */
static const double SLOW = 1e-7;      /* D' over approach, below which all is proportional to it, within as much */
static const double SMALLEST = 1e-6;  /* depth, over D' over approach, below which nothing has stuck that matters */
static const double AT_TURN = 1e-11;  /* z' over approach: no time to stick before the turn; test at psi1 = 2 chi */
static const double SAME = 1e-12;     /* depths, relative, between which no piece of the path fits */
static const double SINGULAR = 1e-7;  /* U over approach: the rest of the piece changes P by the square of this */
static const double UNRESOLVED = 1e-15; /* step over time, where it is over first; test of slow impacts under a load */

/* A piece of the path. end: where it ends; on a stuck piece with nu and D' there. slope: of a straight one. */
typedef struct {
    double begin, end, nu, v, slope;
    int kind;
} path_piece;

/* caught: how many terms of z - c are 0 where a phase begins. along: 1 if z' - s D' is 0 where stick begins. */
typedef struct {
    film_phase_rule rule;
    film_moment now;
    path_piece path[MOST_PIECES];
    double scale, velocity, begun, part; /* velocity, part: D' and dD/dz at first touch */
    int pieces, caught, along;
    film_friction_result *result;
    double *rows;
    int32_t per_step, room, count, status;
} impact;

static double force_of(const impact *in, double z) {
    double slope;
    return film_friction_force(&in->rule.normal, z, &slope);
}

static double speed_of(const impact *in) { return in->now.nu - in->rule.normal.gamma * force_of(in, in->now.z); }

/* ---------------------------------------------------------------- the path */

static void add_piece(impact *in, path_piece piece) {
    if (in->pieces == MOST_PIECES) in->status = FILM_TOO_MANY;
    else if (piece.end > piece.begin + SAME * piece.end) in->path[in->pieces++] = piece;
}

/* Leave the path up to c. */
static void cut(impact *in, double c) {
    while (in->pieces > 0 && in->path[in->pieces - 1].begin >= c * (1.0 - SAME)) in->pieces--;
    if (in->pieces == 0) return;
    path_piece *last = &in->path[in->pieces - 1];
    last->end = c;
    if (last->kind == FILM_STUCK) last->nu = in->now.nu_c, last->v = in->now.v_c;
}

/* Slip with the present sign from the end of the path on; what slipped in this direction before slips again at once. */
static void enter(impact *in) {
    film_moment *now = &in->now;
    while (in->pieces > 0 && in->path[in->pieces - 1].kind == FILM_STRAIGHT &&
           in->path[in->pieces - 1].slope == in->rule.sign) {
        in->pieces--;
        in->caught = 0;
    }
    if (in->pieces == 0) {
        in->rule.kind = FILM_SLIDES;
        in->rule.edge = 0;
        now->c = 0.0;
        return;
    }
    const path_piece *last = &in->path[in->pieces - 1];
    in->rule.kind = FILM_SLIPS, in->rule.piece = last->kind;
    in->rule.edge = in->rule.flat && last->kind == FILM_STUCK;
    now->c = last->end, now->nu_c = last->nu, now->v_c = last->v;
}

/* Slip begins at the edge, with z - c and so many of its derivatives 0. */
static void slip_from_edge(impact *in, double sign, int caught) {
    in->rule.sign = sign;
    in->caught = caught;
    in->now.P = in->now.q - sign * force_of(in, in->now.z);
    enter(in);
}

/* What slipped outside c sticks: a straight piece. */
static void stick_all(impact *in) {
    film_moment *now = &in->now;
    double c = in->rule.kind == FILM_SLIPS ? fmin(now->c, now->z) : 0.0;
    cut(in, c);
    add_piece(in, (path_piece){.begin = c, .end = now->z, .slope = in->rule.sign, .kind = FILM_STRAIGHT});
}

/* ---------------------------------------------------------------- events */

/* Whether a series, over t^zeros, falls to 0 before the time of `end`, which then becomes the first time of that. */
static int falls(double *series, int zeros, film_powers *end) {
    for (int k = 0; k < FILM_TERMS && zeros > 0; k++) series[k] = k + zeros < FILM_TERMS ? series[k + zeros] : 0.0;
    double t = film_friction_root(series, end);
    if (t > end->t) return 0;
    film_friction_powers(t, end);
    return 1;
}

/* z' - side D' falls to 0 for one of both sides, which becomes the sign. */
static int stick_ends(impact *in, const film_taylor *of, film_powers *end) {
    double series[FILM_TERMS], sign = in->rule.sign;
    int found = NOTHING;
    for (int side = -1; side <= 1; side += 2) {
        for (int k = 0; k < FILM_TERMS; k++) series[k] = of->speed[k] - side * of->v[k];
        if (falls(series, in->along && side == (sign > 0.0 ? 1 : -1), end)) {
            in->rule.sign = side;
            found = TURNS;
        }
    }
    return found;
}

/* The first event in a step up to the time of `end`, which it shortens. */
static int first_event(impact *in, const film_taylor *of, film_powers *end) {
    double series[FILM_TERMS];
    int event = NOTHING;
    if (in->rule.kind == FILM_STICKS) return stick_ends(in, of, end);
    for (int k = 0; k < FILM_TERMS; k++) series[k] = -of->way[k];
    if (falls(series, in->rule.flat, end)) event = TURNS;
    if (in->rule.kind == FILM_SLIDES) {
        memcpy(series, in->rule.normal.exponent == 1.5 ? of->root : of->z, sizeof series);
        return falls(series, 0, end) ? ENDS : event;
    }
    memcpy(series, of->c, sizeof series);
    series[0] -= fmax(in->path[in->pieces - 1].begin, SMALLEST * in->scale);
    if (falls(series, 0, end)) event = CORNER;
    for (int k = 0; k < FILM_TERMS; k++) series[k] = of->z[k] - of->c[k];
    return falls(series, in->caught, end) ? CAUGHT : event;
}

/* ---------------------------------------------------------------- steps */

static void write_row(impact *in, double t, double z, double D, double v, double q, double c) {
    if (in->count == in->room) {
        in->status = FILM_FULL;
        return;
    }
    double row[FILM_FRICTION_COLUMNS] = {in->now.time + t, z, D, v, q, c};
    memcpy(in->rows + FILM_FRICTION_COLUMNS * (size_t)in->count++, row, sizeof row);
}

static void write_rows(impact *in, const film_taylor *of, double h) {
    for (int i = 0; in->rows && i < in->per_step && in->status == FILM_OK; i++) {
        film_powers at;
        film_friction_powers(h * i / in->per_step, &at);
        double z = film_friction_sum(of->z, at.value), c = z, D = film_friction_sum(of->D, at.value);
        if (in->rule.kind != FILM_STICKS) c = in->rule.kind == FILM_SLIDES ? 0.0 : film_friction_sum(of->c, at.value);
        double v = film_friction_sum(of->v, at.value), q = film_friction_sum(of->q, at.value);
        write_row(in, film_friction_sum(of->time, at.value), z, D, v, q, c);
    }
}

static void keep_force(impact *in, double q, double time) {
    if (fabs(q) <= in->result->force) return;
    in->result->force = fabs(q);
    in->result->time_of_force = time;
}

static void watch_at(impact *in, const film_taylor *of, const film_powers *at) {
    keep_force(in, film_friction_sum(of->q, at->value), in->now.time + film_friction_sum(of->time, at->value));
}

/* Keeps the largest |q|: at the end of a step, or where its slope changes sign within. */
static void watch_force(impact *in, const film_taylor *of, const film_powers *end) {
    double slope[FILM_TERMS] = {0.0};
    film_powers at;
    watch_at(in, of, end);
    if (of->q[1] * film_friction_sum(of->q, end->slope) >= 0.0) return;
    for (int k = 1; k < FILM_TERMS; k++) slope[k - 1] = copysign(k, of->q[1]) * of->q[k];
    film_friction_powers(fmin(film_friction_root(slope, end), end->t), &at);
    watch_at(in, of, &at);
}

static void move_on(impact *in, const film_taylor *of, const film_powers *end) {
    film_moment *now = &in->now;
    now->time += film_friction_sum(of->time, end->value);
    now->z = film_friction_sum(of->z, end->value);
    now->nu = film_friction_sum(of->nu, end->value);
    now->D = film_friction_sum(of->D, end->value);
    now->v = film_friction_sum(of->v, end->value);
    now->q = film_friction_sum(of->q, end->value);
    in->rule.edge = in->rule.flat = in->caught = in->along = 0;
    if (in->rule.kind != FILM_SLIPS) return;
    now->P = film_friction_sum(of->P, end->value);
    now->c = film_friction_sum(of->c, end->value);
    if (in->rule.piece == FILM_STRAIGHT) return;
    now->nu_c = film_friction_sum(of->nu_c, end->value);
    now->v_c = film_friction_sum(of->v_c, end->value);
}

/* Slip near c = 0: P = -s (1 - s part) f(c) is left for so short a time that its impulse is known to rounding. 1: it is,
 * and c = 0 now. */
static int slides_now(impact *in, const film_taylor *of) {
    if (in->rule.kind != FILM_SLIPS || in->pieces > 1 || in->rule.flat || of->way[0] >= 0.0) return 0;
    double part = in->rule.piece == FILM_STUCK ? in->part : -in->rule.sign; /* slope of the path at 0 */
    double c = in->now.c, per_c = 1.0 - in->rule.sign * part, way = -of->way[0];
    double work = in->rule.rate * film_friction_work(&in->rule.normal, c) / way;
    double spread = (in->rule.rate + 1.0) * force_of(in, c) * c, most = fabs(per_c) + spread;
    double unknown = most * most * c / way * (fabs(of->way[1]) / way + 1.0) + 2.0 * most * spread;
    if (work * unknown > ROUNDING[in->rule.coarse] * in->scale) return 0;
    in->now.v += in->rule.sign * per_c * per_c * work;
    return 1;
}

static int on_stuck_piece(const impact *in) {
    return in->rule.kind == FILM_SLIPS && in->rule.piece == FILM_STUCK && !in->rule.edge;
}

/* U = 0 where a stuck piece begins at which slip with the same sign had ended: c falls there without limit. */
static int at_singular_end(const impact *in) {
    if (!on_stuck_piece(in)) return 0;
    double speed = in->now.nu_c - in->rule.normal.gamma * force_of(in, in->now.c);
    return speed - in->rule.sign * in->now.v_c < SINGULAR;
}

/* Sliding near z = 0: the rest of the contact, as :func:`slides_now`. */
static int ends_now(impact *in, const film_taylor *of) {
    double speed = -of->speed[0], z = in->now.z;
    if (in->rule.kind != FILM_SLIDES || speed <= 0.0) return 0;
    double impulse = film_friction_work(&in->rule.normal, z) / speed, left = z / speed;
    double unknown = (of->f[0] * (left + in->rule.normal.gamma) + fabs(in->rule.normal.load) * left) / speed;
    double most = in->rule.rate * impulse;
    if (most * unknown > ROUNDING[in->rule.coarse] * in->scale) return 0;
    if (in->rule.sign * in->now.v + speed < CLEAR * (most + impulse)) return 0;
    in->now.time += left;
    in->now.z = in->now.q = 0.0;
    in->now.D += in->now.v * left;
    in->now.v -= in->rule.sign * most;
    return 1;
}

/* Sliding in closed form, where it is known: the event that ends it; else NOTHING. */
static int slide_freely(impact *in) {
    double turn;
    int stops = film_friction_slide(&in->rule, &in->now, &turn);
    if (stops < 0) return NOTHING;
    if (turn > 0.0) keep_force(in, force_of(in, 1.0), turn);
    keep_force(in, in->now.q, in->now.time);
    return stops ? TURNS : ENDS;
}

/* On to the end of the phase; the event that ends it. */
static int phase(impact *in) {
    film_taylor of;
    film_powers end;
    while (in->result->steps++ < FILM_FRICTION_STEPS) {
        if (at_singular_end(in)) return CORNER;
        int closed = slide_freely(in);
        if (closed != NOTHING) return closed;
        film_friction_series(&in->rule, &in->now, &of);
        if (slides_now(in, &of)) return CORNER;
        if (ends_now(in, &of)) return ENDS;
        double h = film_friction_length(&in->rule, &of, in->scale);
        if (h <= UNRESOLVED * in->now.time && on_stuck_piece(in)) return CORNER; /* as at_singular_end */
        if (!(h > 0.0)) break;
        film_friction_powers(h, &end);
        int event = first_event(in, &of, &end);
        write_rows(in, &of, end.t);
        watch_force(in, &of, &end);
        move_on(in, &of, &end);
        if (event != NOTHING) return event;
    }
    in->status = FILM_TOO_MANY;
    return ENDS;
}

/* ---------------------------------------------------------------- phases */

static void note(impact *in, int kind) {
    film_friction_result *result = in->result;
    if (result->phases == FILM_FRICTION_EVENTS) {
        in->status = FILM_TOO_MANY;
        return;
    }
    result->begins[result->phases] = in->now.time;
    result->kinds[result->phases++] = kind;
}

static void begin_stick(impact *in) {
    in->rule.kind = FILM_STICKS;
    in->along = 1;
    in->begun = in->now.z;
    note(in, FILM_STICKS);
}

/* c has come to the beginning of its piece. */
static void next_piece(impact *in) {
    const film_moment *now = &in->now;
    if (in->pieces == 1 && in->rule.piece == FILM_STUCK) {
        film_moment was = film_friction_touched(&in->rule, in->part, now->c, in->velocity);
        in->result->closure = fmax(fabs(now->v_c - was.v) / in->scale, fabs(now->nu_c - was.nu));
    }
    in->pieces--;
    enter(in);
    if (in->rule.kind == FILM_SLIDES) note(in, FILM_SLIDES);
}

/* The phase after an event. */
static void next_phase(impact *in, int event) {
    film_moment *now = &in->now;
    int sticks = in->rule.kind == FILM_STICKS, at_turn = speed_of(in) <= AT_TURN;
    if (event == CORNER) {
        next_piece(in);
    } else if (event == CAUGHT) {
        cut(in, now->z);
        slip_from_edge(in, -in->rule.sign, 1);
        note(in, FILM_REVERSES);
    } else if (sticks) {
        add_piece(in, (path_piece){.begin = in->begun, .end = now->z, .nu = now->nu, .v = now->v, .kind = FILM_STUCK});
        in->rule.flat = 1;
        slip_from_edge(in, at_turn ? copysign(1.0, -now->q) : in->rule.sign, 1);
        note(in, FILM_SLIPS);
    } else {
        stick_all(in);
        if (!at_turn) {
            begin_stick(in);
            return;
        }
        in->rule.flat = speed_of(in) >= -AT_TURN;
        slip_from_edge(in, -in->rule.sign, 2);
        note(in, FILM_REVERSES);
    }
}

/* The first moment, and the phase it is in. */
static void touch(impact *in, double velocity) {
    int stick = fabs(velocity) <= 1.0;
    in->part = stick ? velocity : copysign(1.0, velocity);
    double first = film_friction_first(&in->rule.normal, ROUNDING[in->rule.coarse > 0]);
    in->now = film_friction_touched(&in->rule, in->part, first, velocity);
    in->velocity = velocity;
    in->rule.sign = copysign(1.0, velocity);
    in->rule.kind = stick ? FILM_STICKS : FILM_SLIDES;
    in->along = fabs(velocity) == 1.0;
    in->result->kinds[0] = in->rule.kind;
    in->result->phases = 1;
    if (in->rows) write_row(in, -in->now.time, 0.0, 0.0, velocity, 0.0, 0.0);
    if (!stick && speed_of(in) >= fabs(in->now.v)) { /* it has stopped sliding before */
        stick_all(in);
        begin_stick(in);
    }
}

/* The results in the caller's units, of those with the depth and the approach velocity as units. factor: of D'. */
static void scale_back(impact *in, double depth, double approach, double factor) {
    film_friction_result *result = in->result;
    double time = depth / approach, force = factor * approach * approach / depth;
    double units[FILM_FRICTION_COLUMNS] = {time, depth, factor * depth, factor * approach, force, depth};
    for (int i = 0; i < in->count; i++) {
        for (int k = 0; k < FILM_FRICTION_COLUMNS; k++) in->rows[FILM_FRICTION_COLUMNS * i + k] *= units[k];
    }
    for (int i = 0; i < result->phases; i++) result->begins[i] *= time;
    result->velocity = factor * approach * in->now.v;
    result->force *= force;
    result->time_of_force *= time;
    result->duration = time * in->now.time;
}

int film_friction(const film_normal *normal, double rate, double velocity, int coarse, film_friction_result *result, double *rows,
                  int32_t per_step, int32_t room, int32_t *count) {
    double a = normal->approach, depth, factor;
    memset(result, 0, sizeof *result);
    if (count) *count = 0;
    if (!film_friction_sound(normal, rate, velocity)) return FILM_BAD_NUMBER;
    depth = film_friction_depth(normal), factor = fmin(fabs(velocity) / (SLOW * a), 1.0);
    film_normal own = {normal->slope * depth * depth / (a * a), 0.0, normal->exponent, 1.0, normal->gamma * a / depth,
                       normal->load * depth / (a * a)};
    own.coefficient = normal->coefficient * pow(depth, own.exponent + 1.0) / (a * a);
    velocity /= a * factor;
    if (!isfinite(own.slope + own.coefficient + own.exponent + own.gamma + own.load + velocity)) return FILM_BAD_NUMBER;
    impact in = {.rule = {.normal = own, .rate = rate, .coarse = coarse}, .result = result};
    in.rows = rows, in.per_step = per_step, in.room = room;
    in.scale = fmin(fabs(velocity), 1.0);
    touch(&in, velocity);
    while (in.status == FILM_OK) {
        int event = phase(&in);
        if (event == ENDS) break;
        next_phase(&in, event);
    }
    if (rows && in.status == FILM_OK) write_row(&in, 0.0, 0.0, in.now.D, in.now.v, 0.0, 0.0);
    int throughout = result->phases == 1 && result->kinds[0] == FILM_SLIDES;
    result->regime = throughout ? FILM_SLIDES_THROUGHOUT : result->kinds[0] == FILM_STICKS ? FILM_STICKS_FIRST : FILM_SLIDES_FIRST;
    scale_back(&in, depth, a, factor);
    if (count) *count = in.count;
    return in.status != FILM_OK || isfinite(result->velocity + result->force) ? in.status : FILM_BAD_NUMBER;
}
