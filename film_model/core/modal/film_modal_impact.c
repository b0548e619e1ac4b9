/* Whole impacts on a structure: until the impactor is out of its reach, with a record of what happened, or many of them.
 * docs/method.md, section 13. */
#include "modal/film_modal_parts.h"

#include <string.h>

#define SLOWEST 1e-3 /* velocity of an impact without one, over delta_s/t_s */
#define CLOSE 1e-3   /* relative accuracy of the contact time of film_modal_felt */

static double now_of(const film_modal *s) { return s->time + s->tau; }

/* A step in contact that ends it needs two segments: its own, and that of the flight. */
static int has_room(const film_modal_record *record) {
    return record == NULL || (record->segment_count + 1 < record->segment_room && record->event_count < record->event_room &&
                              record->flight_count < record->flight_room);
}

static void record_segment(const film_structure *structure, const film_modal *s, const double *waves, int32_t kind,
                           film_modal_record *record) {
    film_modal_segment *to = &record->segments[record->segment_count++];
    memset(to, 0, sizeof *to);
    to->time = s->time;
    int whole = kind == FILM_STEP_JUMP || (kind == FILM_STEP_FLIGHT && structure->carried == 0); /* of a flight */
    to->h = kind == FILM_STEP_REST || whole ? INFINITY : s->h;
    to->x = s->x;
    to->v = s->v;
    to->depth = s->x - s->shift;
    to->depth_rate = s->v - s->rate;
    to->load = s->load;
    to->unit = s->unit;
    to->rest = s->rest;
    to->line = s->contact.line;
    to->line.branch = s->contact.branch;
    to->flight = -1;
    if (kind == FILM_STEP_REST) return;
    if (!whole) {
        memcpy(to->force, s->force, sizeof to->force);
        memcpy(to->bend, s->bend, sizeof to->bend);
        return;
    }
    size_t size = 2 * (size_t)structure->modes;
    to->flight = record->flight_count++;
    memcpy(record->flights + (size_t)to->flight * size, waves + begins_at(structure, s), size * sizeof(double));
}

/* The event just met, in the record and in the summary. */
static void note_event(const film_structure *structure, const film_curve *curve, const film_modal *s, const double *waves,
                       film_modal_summary *summary, film_modal_record *record) {
    film_modal_event event;
    film_summary *core = &summary->core;
    memset(&event, 0, sizeof event);
    film_modal_motion(structure, curve, s, waves, event.values);
    event.time = now_of(s);
    event.event = s->contact.event;
    event.branch = s->contact.branch;
    if (record != NULL) record->events[record->event_count++] = event;
    core->maximum_force = fmax(core->maximum_force, fmax(s->peak, event.values[2]));
    film_note_turn(event.event, event.time, event.values[0], s->contact.stage_max, core);
    if (event.event == FILM_CONTACT_ENDS) {
        summary->contacts++;
        if (isnan(core->contact_duration)) core->contact_duration = event.time;
        core->permanent_indentation = event.values[0];
        core->final_velocity = event.values[3];
        core->shift = event.values[4];
    }
}

/* How long a flight is followed: as long as the impact so far, and for the longest period. */
static double patience(const film_structure *structure, const film_modal *s) {
    double slowest = structure->rigid < structure->modes ? 2.0 * PI / structure->frequency[structure->rigid] : 0.0;
    return now_of(s) + fmax(now_of(s), slowest);
}

int film_modal_go_on(film_structure *structure, const film_curve *curve, double limit, film_modal *s, double *waves,
                     film_modal_summary *summary, film_modal_record *record) {
    double until = s->contact.branch == FILM_FREE && summary->contacts > 0 ? patience(structure, s) : limit;
    int status = FILM_OK, in_flight = s->contact.branch == FILM_FREE;
    int32_t most = film_most_steps(structure);
    for (int32_t k = 0; status >= 0; k++) {
        if (!has_room(record)) return FILM_FULL;
        if (k >= most || s->steps >= most) return FILM_TOO_MANY;
        if (!s->has_step) {
            status = film_plan_step(structure, curve, s, waves);
            if (status < 0) break;
            if (record != NULL && (!in_flight || structure->carried > 0) && s->h > 0.0) record_segment(structure, s, waves, s->kind, record);
        }
        double dt = fmax(until - now_of(s), 0.0);
        int fallen = in_flight && (s->load > 0.0 || structure->carried > 0) && summary->contacts > 0 && film_leaves(structure, s, waves);
        if (s->h == INFINITY || fallen) status = FILM_ENDLESS; /* out of reach, or at rest; a fall back is another impact */
        else status = film_advance(structure, curve, s, waves, &dt);
        if (status < 0 || status == FILM_ENDLESS) break;
        if (status == FILM_EVENT) {
            s->steps += EVENT_WORK;
            note_event(structure, curve, s, waves, summary, record);
            if (record != NULL && s->contact.event == FILM_CONTACT_ENDS && structure->carried == 0) record_segment(structure, s, waves, FILM_STEP_FLIGHT, record);
            in_flight = s->contact.branch == FILM_FREE;
            until = in_flight ? patience(structure, s) : limit;
            status = FILM_OK;
        } else if (!(now_of(s) < until)) {
            break;
        }
    }
    if (status == FILM_OK && !in_flight) film_stop_step(structure, curve, s, waves); /* the time limit falls within a step */
    if (record != NULL && status >= 0 && in_flight && structure->carried > 0) /* what follows, without membrane forces */
        record_segment(structure, s, waves, FILM_STEP_JUMP, record);
    double force = in_flight ? 0.0 : s->last_force;
    summary->core.maximum_force = fmax(summary->core.maximum_force, fmax(s->peak, force));
    summary->core.work = film_modal_work(s, force);
    summary->core.lines = s->steps;
    if (status < 0) return status;
    if (!in_flight) {
        summary->core.contact_duration = summary->core.permanent_indentation = summary->core.final_velocity = NAN;
        return status;
    }
    summary->waited = status != FILM_ENDLESS;
    return FILM_EVENT;
}

int film_modal_impact(film_structure *structure, const film_curve *curve, const film_modal_start *start, film_modal *s,
                      double *waves, film_modal_summary *summary, film_modal_record *record) {
    memset(summary, 0, sizeof *summary);
    summary->core.time_impactor_stops = summary->core.contact_duration = summary->core.permanent_indentation = NAN;
    summary->core.final_velocity = NAN;
    int status = film_modal_init(structure, curve, s, waves, start, 0.0);
    if (status < 0) return status;
    return film_modal_go_on(structure, curve, start->limit, s, waves, summary, record);
}

void film_modal_batch(film_structure *structure, const film_curve *curve, int64_t count, const film_modal_start *start,
                      double *waves, film_modal_summary *summary, int32_t *status) {
    film_modal s;
    for (int64_t i = 0; i < count; i++)
        status[i] = film_modal_impact(structure, curve, &start[i], &s, waves, &summary[i], NULL);
}

double film_modal_felt(int32_t modes, const double *frequency, const double *share, double rest, double mass, double shortest,
                       double softness, double slow, int32_t *free) {
    double felt = rest, duration = shortest;
    for (int32_t round = 0; round <= 2 * modes; round++) { /* each longer time leaves fewer slow modes, or as many and ends */
        double loose = 0.0;
        felt = rest;
        *free = 0;
        for (int32_t k = 0; k < modes; k++) {
            if (frequency[k] <= slow / duration) {
                loose += share[k];
                (*free)++;
            } else {
                felt += share[k] / (frequency[k] * frequency[k]);
            }
        }
        double lasts = shortest * sqrt((1.0 + felt / softness) / (1.0 + mass * loose));
        if (lasts <= duration || *free == 0) break;
        duration = lasts * (1.0 + CLOSE);
    }
    return felt;
}

void film_modal_still(const film_curve *curve, double nu, film_summary *summary) {
    double nodes[80]; /* film_mesh_size(6, 6) */
    film_mesh mesh;
    film_start start = {.nu = fmax(nu, SLOWEST), .time_limit = INFINITY};
    film_mesh_init(&mesh, FILM_WORK_PRESERVING, 6, 6, nodes);
    if (film_marched(curve, &mesh, &start, summary) == FILM_EVENT) return;
    summary->time_of_maximum_indentation = 1.0;
    summary->contact_duration = 3.0;
}
