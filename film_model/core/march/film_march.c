/* The march: plans legs, follows their lines, and decides what comes after each. docs/method.md, sections 1, 6 and 9. */
#include "march/film_march.h"

#include <string.h>

/* The length of the last line before a turn is sought to this fraction of itself, so that energy is kept to rounding.
 * core_check.c, check_found: "out of hardly more than a spring, on a soft target". */
static const double TURN_TOLERANCE = 1e-12;

/* ---------------------------------------------------------------- planning a leg */

/* The direction of a run that does not begin at a turn. FILM_EVENT: it has changed, at the deepest point of the loading curve
 * or because film_input changed nu. */
static int choose_direction(const film_curve *curve, film_state *s) {
    double y = s->nu - s->gamma * s->elastic, excess = s->elastic - s->load;
    int at_rest = fabs(y) <= REST_SPEED * (fabs(s->nu) + s->gamma * s->elastic);
    int direction = at_rest ? (excess < 0.0 ? 1 : -1) : (y > 0.0 ? 1 : -1);
    int turned = s->branch >= 0 && s->direction > 0 && direction < 0 && s->xi > 0.0 && s->xi >= s->xi_max;
    int reversed = s->jumped && direction != s->direction;
    s->from_turn = at_rest;
    s->direction = direction;
    s->jumped = 0;
    if (turned) {
        int status = film_remember_turn(curve, s);
        s->event = FILM_MAXIMUM_INDENTATION;
        s->phase = FILM_UNLOADING;
        return status < 0 ? status : FILM_EVENT;
    }
    s->phase = run_phase(s);
    if (!reversed) return FILM_OK;
    s->event = direction > 0 ? FILM_RELOADING_BEGINS : FILM_MAXIMUM_INDENTATION;
    return FILM_EVENT;
}

/* The grading of a leg's nodes. docs/method.md, section 4. */
static int32_t choose_grading(const film_curve *curve, const film_mesh *mesh, const film_state *s) {
    if (mesh->linearisation == FILM_CHORD) return FILM_EQUAL;
    if (s->gamma == 0.0) return FILM_COSINE;
    if (s->direction < 0 && film_is_pulled(s->elastic, film_pull(curve, s))) return FILM_COSINE;
    double depth = s->branch < 0 ? s->recovery : s->xi;
    double slowness = s->direction > 0 ? 0.0 : s->gamma * sqrt(s->f_max / depth);
    /* the damping force is most curved where the contact begins and ends */
    if (is_damped(curve, s)) return slowness < 1.75 ? FILM_COSINE : FILM_PLATE_CREEP;
    return s->direction > 0 ? FILM_PLATE_IN : film_grading(slowness);
}

/* Plans the leg that starts here: direction, end, nodes. FILM_EVENT: the direction has changed.
 * docs/method.md, sections 4 and 5. */
static int plan_leg(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    film_open_run(curve, s);
    if (s->branch == FILM_FREE) return FILM_OK;
    int status = s->from_turn ? FILM_OK : choose_direction(curve, s);
    if (status != FILM_OK) return status;
    film_choose_loop(curve, s);
    film_open_run(curve, s);
    s->leg_from = s->xi;
    s->leg_node = 0;
    s->leg_nodes = s->direction > 0 ? mesh->loading : mesh->unloading;
    status = film_aim_leg(curve, mesh, s);
    if (status < 0) return status;
    if (film_make_rest_line(curve, s)) return FILM_OK;
    s->leg_grading = choose_grading(curve, mesh, s);
    if (s->direction < 0) s->leg_nodes = film_unloading(mesh, s->leg_grading);
    s->has_leg = 1;
    return FILM_OK;
}

/* The event that nu has fallen to stop_velocity. */
int film_stop(film_state *s) {
    s->moving_in = 0;
    s->event = FILM_IMPACTOR_STOPS;
    return FILM_EVENT;
}

/* A line to march on. docs/method.md, sections 2 and 5. */
static int prepare_line(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    if (s->moving_in && s->nu <= s->stop_velocity) return film_stop(s);
    if (!s->has_leg) {
        int status = plan_leg(curve, mesh, s);
        if (status != FILM_OK) return status;
    }
    if (s->branch == FILM_FREE) {
        film_open_line(s);
        film_make_flight(curve, s);
    } else if (s->has_leg) {
        film_open_line(s);
        int status = film_next_line(curve, mesh, s, TURN_TOLERANCE);
        if (status < 0) return status;
        if (s->direction < 0 && is_damped(curve, s)) film_end_at_release(curve, mesh, s);
    }
    s->tau = s->tau_low = 0.0;
    if (s->moving_in && s->branch != FILM_FREE && s->tau_end < INFINITY) {
        if (s->nu_end < s->stop_velocity) film_end_at_stop(curve, mesh, s);
        else if (s->load > 0.0 && s->direction < 0) film_end_at_dip(curve, mesh, s);
    }
    s->has_line = 1;
    s->lines++;
    return FILM_OK;
}

/* ---------------------------------------------------------------- what follows a line */

/* A flight ends at touch: the loading curve of a spot without a dent, else the branch that leads back to its deepest point.
 * docs/method.md, section 6. */
static int touch(const film_curve *curve, film_state *s) {
    s->contacts++;
    s->event = FILM_CONTACT_BEGINS;
    s->direction = 1;
    s->branch = film_branch_at_touch(curve, s);
    s->phase = run_phase(s);
    s->loop = s->branch == FILM_BRANCH && film_reload_exponent(curve, s) > 0.0 ? LOOP_RELOAD : LOOP_NONE;
    s->xi_in = s->xi_free;
    s->f_in = 0.0;
    film_open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->force_peak = contact_force(curve, s);
    if (s->xi > s->xi_free) s->direction = s->nu > s->gamma * s->elastic ? 1 : -1;
    else if (s->elastic > 0.0 && s->nu < s->gamma * s->elastic) return FILM_TOO_STIFF;
    return FILM_EVENT;
}

static int separate(film_state *s) {
    s->event = FILM_CONTACT_ENDS;
    s->branch = FILM_FREE;
    s->phase = FILM_SEPARATED;
    s->force = s->elastic = s->work = 0.0;
    return FILM_EVENT;
}

static int turn(const film_curve *curve, film_state *s) {
    int status = FILM_EVENT;
    s->event = s->direction > 0 ? FILM_MAXIMUM_INDENTATION : FILM_RELOADING_BEGINS;
    if (s->direction > 0 && s->branch >= 0 && film_remember_turn(curve, s) < 0) status = FILM_BAD_UNLOADING;
    s->direction = -s->direction;
    s->phase = run_phase(s);
    return status;
}

/* To the next stage, or from a branch back to the loading curve. outwards: the force pushed the impactor out up to here, so nu
 * <= gamma f with the f before. If the f after it is lower by rounding only, nu is bounded by that one, because rounding would
 * turn the motion back. */
static int change_stage(const film_curve *curve, film_state *s, int outwards) {
    double before = s->elastic;
    s->event = FILM_STAGE_CHANGES;
    int stretched = s->branch <= FILM_STRETCHED;
    if (s->direction < 0) s->branch += stretched ? 1 : -1;
    else if (stretched && !film_stretched_inmost(curve, s->branch)) s->branch--;
    else if (s->branch >= 0) s->branch++;
    else s->branch = s->xi >= curve->stage[s->stage_max].end ? s->stage_max + 1 : s->stage_max;
    if (s->branch >= curve->stages) return FILM_BEYOND_LAW;
    if (s->direction > 0) s->phase = run_phase(s);
    film_open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->elastic; /* a damped law has one stage */
    if (outwards) {
        int same = before - s->elastic <= film_force_rounding(curve, s, stretched ? s->stage_max : s->branch + 1);
        s->nu = fmin(s->nu, s->gamma * (same ? s->elastic : before));
    }
    return FILM_EVENT;
}

/* To the end of the current line, with the largest force on it. mesh NULL: for film_switch. */
static void reach_end(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    if (s->branch == FILM_FREE) {
        s->xi = s->xi_end;
        s->nu = s->nu_end;
    } else {
        if (s->line.damper > 0.0 && s->direction > 0 && mesh != NULL && mesh->ways != FILM_LINES_ALONE)
            film_raise_peak(curve, mesh, s, &s->force_peak);
        film_follow(s);
    }
    s->has_line = 0;
    if (s->nu > s->stop_velocity) s->moving_in = 1;
    s->event = FILM_NO_EVENT;
    s->from_turn = s->line_ends == ENDS_TURN;
    s->force = contact_force(curve, s);
    if (s->force > s->force_peak) s->force_peak = s->force;
}

/* What follows the end of a line: the next line, leg, loop, stage or branch. mesh NULL: for film_switch, whose caller owns
 * the motion. docs/method.md, section 6. */
int film_finish(const film_curve *curve, const film_mesh *mesh, film_state *s) {
    reach_end(curve, mesh, s);
    int ends = s->line_ends, on_branch = s->branch == FILM_BRANCH;
    if (ends == ENDS_STOP) return film_stop(s);
    if (ends == ENDS_PART || (ends == ENDS_NODE && s->leg_node < s->leg_nodes)) return FILM_OK;
    s->has_leg = 0;
    /* the force pushes the impactor out and, under a load, it has moved: if it turns here, that is rounding */
    int outwards = mesh != NULL && s->direction < 0 && s->elastic >= fmax(s->load, 0.0) && !(s->load > 0.0 && s->xi == s->leg_from);
    if (ends == ENDS_TURN && outwards) {
        s->nu = s->gamma * s->elastic; /* go on from rest */
        return FILM_OK;
    }
    if (ends == ENDS_TURN) return turn(curve, s);
    if (ends == ENDS_RELEASE) return separate(s);
    if (ends != ENDS_EDGE) return FILM_OK;
    if (s->branch == FILM_FREE) return touch(curve, s);
    if (on_branch && s->loop == LOOP_INNER && s->direction > 0) {
        film_change_loop(curve, s, LOOP_RELOAD);
        return FILM_OK;
    }
    if (on_branch && s->loop != LOOP_NONE && s->direction < 0 && s->xi_in > s->xi_free) {
        film_change_loop(curve, s, LOOP_NONE);
        return FILM_OK;
    }
    int outmost = s->branch == 0 || on_branch || s->branch == FILM_STRETCHED;
    return s->direction < 0 && outmost ? separate(s) : change_stage(curve, s, outwards);
}

/* ---------------------------------------------------------------- steps */

/* sum += x for x >= 0, with *low the part that rounding drops. Time must not decrease, even where *low rounds it down.
 * core_check.c, check_clock. */
static void add_time(double *sum, double *low, double x) {
    double t = fmax(*sum, *sum + (x + *low));
    *low = (*sum - t) + (x + *low);
    *sum = t;
}

/* Forward by *dt at most, within one line; *dt becomes the rest. */
static int advance(const film_curve *curve, const film_mesh *mesh, film_state *s, double *dt) {
    double left = (s->tau_end - s->tau) - s->tau_low;
    if (*dt < left) {
        add_time(&s->tau, &s->tau_low, *dt);
        add_time(&s->time, &s->time_low, *dt);
        *dt = 0.0;
        film_move_along(curve, s, s->tau);
        s->event = FILM_NO_EVENT;
        return FILM_OK;
    }
    if (left == INFINITY) return FILM_ENDLESS;
    if (left > 0.0) {
        add_time(&s->time, &s->time_low, left);
        *dt -= left;
    }
    return film_finish(curve, mesh, s);
}

/* Whether a mesh and a state can be marched by dt. */
static int check_step(const film_mesh *mesh, const film_state *s, double dt) {
    if (!(dt >= 0.0)) return FILM_BAD_NUMBER;
    if (mesh->loading < 1 || mesh->unloading < 1 || mesh->loading > FILM_MAX_SEGMENTS || mesh->unloading > FILM_MAX_SEGMENTS)
        return FILM_BAD_MESH;
    return isfinite(s->xi) && isfinite(s->nu) && isfinite(s->load) ? FILM_OK : FILM_BAD_NUMBER;
}

int film_step(const film_curve *curve, const film_mesh *mesh, film_state *s, double dt) {
    int status = check_step(mesh, s, dt);
    for (int32_t k = 0; status == FILM_OK; k++) {
        if (k >= FILM_MAX_STEP_LINES) return FILM_TOO_MANY;
        if (!s->has_line) status = prepare_line(curve, mesh, s);
        if (status != FILM_OK) break;
        status = advance(curve, mesh, s, &dt);
        if (status == FILM_OK && dt == 0.0) return FILM_OK;
    }
    return status;
}

/* A turn counts as deeper than those before only beyond this factor: a contact that swings on its weight turns at the same
 * depth again and again, to rounding. Needed by tests/test_one_and_many.py. */
static const double DEEPER = 1.0 + 1e-10;

void film_clear_summary(film_summary *summary) {
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = NAN;
    summary->final_velocity = NAN;
}

void film_note_turn(int32_t event, double time, double indentation, int32_t stage, film_summary *summary) {
    if (event == FILM_MAXIMUM_INDENTATION && indentation > DEEPER * summary->maximum_indentation) {
        summary->maximum_indentation = indentation;
        summary->time_of_maximum_indentation = time;
        summary->stage = stage;
    } else if (event == FILM_IMPACTOR_STOPS && isnan(summary->time_impactor_stops)) {
        summary->time_impactor_stops = time;
    }
}

/* What an event adds to the summary. */
static void summarise(const film_curve *curve, const film_state *s, film_summary *summary) {
    film_note_turn(s->event, s->time, s->xi - curve->compliance * s->force, s->stage_max, summary);
    if (s->event == FILM_CONTACT_ENDS) {
        summary->contact_duration = s->time;
        summary->permanent_indentation = s->xi;
        summary->final_velocity = s->nu;
    }
}

/* The next line, added to an array unless that is NULL. */
static int next_recorded(const film_curve *curve, const film_mesh *mesh, film_state *s, film_line *lines, int32_t room, int32_t *count) {
    int status = prepare_line(curve, mesh, s);
    if (status != FILM_OK) return status;
    if (*count >= room) return FILM_FULL;
    if (lines != NULL) lines[*count] = s->line;
    ++*count;
    return FILM_OK;
}

int film_record(const film_curve *curve, const film_mesh *mesh, film_state *s, double time_limit, film_line *lines,
                int32_t line_room, int32_t *line_count, film_state *events, int32_t event_room, int32_t *event_count,
                film_summary *summary) {
    double dt = time_limit - s->time, approach = s->nu;
    int status = check_step(mesh, s, dt), over = 0;
    film_clear_summary(summary);
    *line_count = *event_count = 0;
    while (status >= 0 && !over) {
        status = s->has_line ? FILM_OK : next_recorded(curve, mesh, s, lines, line_room, line_count);
        if (status == FILM_OK) {
            status = advance(curve, mesh, s, &dt);
            over = status == FILM_ENDLESS || (status == FILM_OK && dt == 0.0);
        }
        if (status != FILM_EVENT) continue;
        if (s->event == FILM_CONTACT_BEGINS) approach = s->nu;
        over = s->event == FILM_CONTACT_ENDS;
        if (over && film_grazes(s->load, summary->maximum_indentation, approach)) {
            status = FILM_OK;
            break;
        }
        if (*event_count >= event_room) return FILM_FULL;
        if (events != NULL) events[*event_count] = *s;
        ++*event_count;
        summarise(curve, s, summary);
        if (!over) status = FILM_OK;
    }
    if (status < 0) return status;
    summary->maximum_force = fmax(s->force_peak, s->force); /* s->force where the time limit comes on the way in */
    summary->shift = s->shift;
    summary->work = s->spent;
    summary->lines = s->lines;
    if (status == FILM_EVENT && lines != NULL) { /* the flight that follows, for samples after the end */
        s->line.time = s->time;
        if (next_recorded(curve, mesh, s, lines, line_room, line_count) == FILM_FULL) return FILM_FULL;
    }
    return status;
}
