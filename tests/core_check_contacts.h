/* Of core_check.c: random contacts, recorded, in steps, and in batches. */
#ifndef CORE_CHECK_CONTACTS_H
#define CORE_CHECK_CONTACTS_H

#include "core_check_tools.h"

/* ---------------------------------------------------------------- one contact, recorded */

static film_line *lines;
static film_state *events;

/* Along the lines of a record: each begins where the one before ends, and each does the work of the true law. */
static void check_lines(int which, const film_state *begin, int32_t count, int work_preserving) {
    const film_curve *curve = &curves[which];
    double depth = 0.0, speed = fabs(begin->nu), force = 0.0, moved = 0.0, values[5];
    for (int32_t i = 0; i < count; i++) {
        depth = fmax(depth, fabs(lines[i].xi));
        speed = fmax(speed, fabs(lines[i].nu));
        moved = fmax(moved, fabs(lines[i].shift));
    }
    for (int32_t i = 0; i + 1 < count; i++) {
        const film_line *line = &lines[i], *next = &lines[i + 1];
        double tau = next->time - line->time;
        HOLD(tau >= 0.0);
        double tolerance = which == SERIES ? SERIES_ROUNDING : EXACT; /* where a line turns is sought by its work */
        film_evaluate(curve, line, tau, values);
        /* tau is a difference of rounded times */
        double late = 4.0 * 2.3e-16 * next->time;
        force = fmax(force, values[2]);
        HOLD(values[2] >= -EXACT * force);
        double pull = fabs(line->phi) + fabs(line->kappa) * fabs(next->xi - line->xi) + fabs(line->load);
        if (next->nu == begin->stop_velocity) /* cut where nu is that, to a length known to 1e-13, and maybe slow there */
            late += 1e-13 * depth / fmax(fabs(values[1]), 1e-300);
        double bent = line->branch == FILM_FREE ? 0.0 : curve->compliance * values[2]; /* the spring's own */
        NEAR(values[0] + bent, next->xi, depth + late * (speed + line->gamma * pull) / EXACT, tolerance);
        if (fabs(values[1]) < 1e-7 * speed) tolerance = 1e-7; /* at a turn a speed of which the square is rounding is dropped */
        NEAR(values[3], next->nu, speed + late * pull / EXACT, tolerance);
        NEAR(values[4] - bent, next->shift, moved + line->gamma * (speed + late * pull / EXACT), tolerance);
        if (line->branch == FILM_FREE || next->branch == FILM_FREE || which == DAMPED) continue;
        if (!work_preserving || next->phase != line->phase || next->branch != line->branch) continue;
        double h = next->xi - line->xi, mean = line->phi + 0.5 * line->kappa * h;
        NEAR(mean * h, next->spent - line->spent, force * depth + work_rounding[which] / EXACT, EXACT);
        double before, after;
        if (line->branch < 0) continue;
        film_law(curve, line->branch, line->xi, &values[0], &before);
        film_law(curve, line->branch, next->xi, &values[0], &after);
        NEAR(after - before, next->spent - line->spent, force * depth + work_rounding[which] / EXACT, EXACT);
    }
}

/* Energy and momentum from the start of contact to s. Momentum: dnu = p dt - dshift/gamma, whatever the lines. Energy:
 * what is missing was radiated, and none can be radiated into a fixed target. */
static void check_balance(int which, const film_state *begin, const film_state *s, int work_preserving) {
    double energy = 0.5 * begin->nu * begin->nu, load = begin->load, t = s->time - begin->time;
    double scale = energy + fabs(load * s->xi) + fabs(load * s->shift) + fabs(s->spent) + work_rounding[which] / ENERGY;
    double missing = energy + load * (s->xi - begin->xi + s->shift - begin->shift) - 0.5 * s->nu * s->nu - s->spent;
    HOLD(isfinite(missing));
    if (work_preserving) HOLD(missing >= -ENERGY * scale);
    if (work_preserving && begin->gamma == 0.0) NEAR(missing, 0.0, scale, ENERGY);
    if (begin->gamma == 0.0) {
        HOLD(s->shift == 0.0);
    } else {
        double impulse = fabs(begin->nu) + fabs(s->nu) + fabs(load * t);
        NEAR(s->nu - begin->nu, load * t - (s->shift - begin->shift) / begin->gamma, impulse, EXACT);
    }
}

static void check_samples(const film_curve *curve, int32_t count, double end) {
    static double times[SAMPLES], values[5 * SAMPLES];
    static int8_t stages[SAMPLES], phases[SAMPLES];
    double alone[5];
    for (int i = 0; i < SAMPLES; i++) times[i] = 1.1 * end * i / (SAMPLES - 1);
    film_sample(curve, lines, count, times, SAMPLES, values, stages, phases);
    for (int i = 0; i < SAMPLES; i++) {
        int32_t k = 0;
        while (k + 1 < count && lines[k + 1].time <= times[i]) k++;
        film_evaluate(curve, &lines[k], times[i] - lines[k].time, alone);
        HOLD(memcmp(alone, values + 5 * i, sizeof alone) == 0);
        HOLD(stages[i] == lines[k].branch && phases[i] == lines[k].phase);
        for (int j = 0; j < 5; j++) {
            HOLD(isfinite(alone[j]));
            stir_number(alone[j]);
        }
    }
}

/* A record without enough room says so, and writes nothing beyond what it was given. */
static void check_little_room(const film_curve *curve, const film_mesh *mesh, const film_state *begin, double limit,
                              int32_t line_count, int32_t event_count) {
    film_summary summary;
    int32_t short_of_lines = whole(0, line_count - 1), short_of_events = whole(0, event_count - 1), a, b;
    for (int k = 0; k < 2; k++) {
        int32_t line_room = k == 0 ? short_of_lines : line_count, event_room = k == 0 ? event_count : short_of_events;
        film_line *few = room_for((size_t)line_room, sizeof *few);
        film_state *some = room_for((size_t)event_room, sizeof *some), s = *begin;
        int status = film_record(curve, mesh, &s, limit, few, line_room, &a, some, event_room, &b, &summary);
        HOLD(a <= line_room && b <= event_room);
        HOLD(status == FILM_FULL || (k == 0 && a == line_room)); /* the flight that follows is left out */
        HOLD(memcmp(few, lines, (size_t)a * sizeof *few) == 0);
        HOLD(memcmp(some, events, (size_t)b * sizeof *some) == 0);
        free(few);
        free(some);
    }
}

/* The order in which things may happen, and what holds when they do. */
static void check_events(const film_curve *curve, int32_t count, const film_start *start) {
    double time = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const film_state *s = &events[i];
        double relative = s->nu - s->gamma * s->force, speed = fabs(s->nu) + s->gamma * s->force + start->nu, force, work;
        events_seen++;
        stir_state(s);
        HOLD(s->time >= time);
        HOLD((s->event == FILM_CONTACT_BEGINS) == (i == 0));
        HOLD(s->force >= 0.0 && s->force <= s->force_peak * (1.0 + EXACT));
        if (s->event == FILM_MAXIMUM_INDENTATION || s->event == FILM_RELOADING_BEGINS)
            NEAR(relative, 0.0, speed, 1e-8); /* its energy is rounding */
        double tolerance = curve == &curves[SERIES] ? 1e-4 : EXACT; /* a series fades out in its rounding */
        /* short of the turn only the line that meets the turn may stop: then it is reported there, within the lines' error */
        int at_turn = i > 0 && events[i - 1].event == FILM_MAXIMUM_INDENTATION && events[i - 1].time == s->time;
        if (s->event == FILM_IMPACTOR_STOPS && at_turn) HOLD(s->nu <= start->stop_velocity);
        if (s->event == FILM_IMPACTOR_STOPS && !at_turn) NEAR(s->nu, start->stop_velocity, speed, tolerance);
        if (s->event == FILM_CONTACT_ENDS) {
            HOLD(s->force == 0.0 && s->phase == FILM_SEPARATED && s->branch == FILM_FREE);
            HOLD(relative <= EXACT * speed);
            if (curve != &curves[DAMPED]) NEAR(s->xi, s->xi_free, s->xi_max, EXACT);
            else HOLD(s->xi >= 0.0 && s->xi <= s->xi_max * (1.0 + EXACT));
        }
        if (s->branch >= 0) {
            film_law(curve, s->branch, s->xi, &force, &work);
            NEAR(s->elastic, force, s->force_peak, EXACT);
            if (s->event == FILM_MAXIMUM_INDENTATION || curve != &curves[DAMPED]) NEAR(s->force, force, s->force_peak, 1e-7);
        }
        time = s->time;
    }
}

static film_start random_start(int curve) {
    film_start start = {over_decades(1e-3, 30.0), 0.0, 0.0, 0.0, INFINITY, 0.0};
    if (curve == SERIES || curve == SOFTENING) start.nu = over_decades(0.03, 4.0); /* beyond 3.6 the law ends before a fixed target wins */
    if (uniform(0.0, 1.0) < 0.7) start.gamma = over_decades(1e-4, 30.0);
    if (uniform(0.0, 1.0) < 0.3) start.load = uniform(-0.5, 0.5) * fmin(1.0, start.nu);
    if (uniform(0.0, 1.0) < 0.2) start.stop_velocity = uniform(-0.5, 0.5) * start.nu;
    if (start.load > 0.0) start.time_limit = uniform(0.0, 200.0);
    if (curve == DAMPED) start.damping = over_decades(1e-2, 3.0);
    return start;
}

static void one_contact(int which, const film_mesh *mesh, const film_start *start) {
    const film_curve *curve = &curves[which];
    film_state s, begin;
    film_summary summary, again;
    int32_t line_count, event_count;
    snprintf(where, sizeof where, "curve %d, nu %.17g, gamma %.17g, load %.17g, stop %.17g, limit %.17g, mesh %d %d %d",
             which, start->nu, start->gamma, start->load, start->stop_velocity, start->time_limit,
             (int)mesh->linearisation, (int)mesh->loading, (int)mesh->unloading);
    int work_preserving = mesh->linearisation == FILM_WORK_PRESERVING;
    int status = film_marched(curve, mesh, start, &summary);
    stir_summary(status, &summary);
    contacts++;
    HOLD(film_marched(curve, mesh, start, &again) == status);
    HOLD(memcmp(&summary, &again, sizeof again) == 0);

    HOLD(film_init(curve, &begin, 0.0, start->nu, start->gamma, start->load, start->stop_velocity) == FILM_OK);
    HOLD(film_damp(&begin, start->damping) == FILM_OK);
    s = begin;
    int recorded = film_record(curve, mesh, &s, start->time_limit, lines, LINE_ROOM, &line_count, events, EVENT_ROOM, &event_count, &again);
    HOLD(recorded == status);
    check_lines(which, &begin, line_count, work_preserving);
    check_events(curve, event_count, start);
    if (status < 0) {
        HOLD(status == FILM_BEYOND_LAW && which == SERIES);
        return;
    }
    check_balance(which, &begin, &s, work_preserving && status == FILM_EVENT); /* at a node */
    check_samples(curve, line_count, s.time);
    check_little_room(curve, mesh, &begin, start->time_limit, line_count, event_count);
    stir_state(&s);
    int creeps = (which == LINEAR && start->gamma > OVER_DAMPED) || (which == SERIES && !work_preserving) ||
                 ((which == SHIFTED || which == SPRUNG_SHIFTED) && start->gamma > SHIFTED_OVER_DAMPED);
    if (start->load <= 0.0) HOLD(status == FILM_EVENT || (status == FILM_ENDLESS && creeps));
    if (status != FILM_EVENT) return;
    double t = s.time, v = start->nu + fabs(s.nu), tolerance = EXACT + work_rounding[which] / (0.5 * v * v);
    NEAR(summary.contact_duration, t, t, tolerance);
    NEAR(summary.final_velocity, again.final_velocity, v, tolerance);
    NEAR(summary.permanent_indentation, again.permanent_indentation, s.xi_max, tolerance);
    NEAR(summary.maximum_indentation, again.maximum_indentation, s.xi_max, tolerance);
    NEAR(summary.time_of_maximum_indentation, again.time_of_maximum_indentation, t, tolerance);
    NEAR(summary.maximum_force, again.maximum_force, s.force_peak, tolerance);
    NEAR(summary.shift, again.shift, s.shift + 1e-300, tolerance);
    NEAR(summary.work, again.work, 0.5 * v * v, ENERGY + work_rounding[which] / (0.5 * v * v));
    HOLD(again.contact_duration == t && again.final_velocity == s.nu && again.permanent_indentation == s.xi);
    NEAR(again.maximum_indentation, s.xi_max - curves[which].compliance * s.f_max, s.xi_max, tolerance);
}

/* ---------------------------------------------------------------- steps, inputs, saving */

typedef struct {
    double duration, load, push, stop_velocity;
} part;

/* On to `until`, through every event; what the last step said. */
static int march(const film_curve *curve, const film_mesh *mesh, film_state *s, double until, film_state *seen,
                 int32_t *count) {
    for (int k = 0; k < 100000; k++) {
        double left = (until - s->time) - s->time_low;
        int status = film_step(curve, mesh, s, left > 0.0 ? left : 0.0);
        if (status != FILM_EVENT) return status;
        /* A bounce that loses nothing comes back to the old depth with no speed: rounding decides whether it passes. */
        double relative = fabs(s->nu - s->gamma * s->force);
        if (s->event == FILM_STAGE_CHANGES && relative < 1e-6 * sqrt(s->f_max * s->recovery)) continue;
        if (*count < EVENT_ROOM) seen[*count] = *s;
        ++*count;
    }
    hold(0, "a step ends", __FILE__, __LINE__);
    return FILM_TOO_MANY;
}

/* The parts one after the other, each cut into `cuts` steps at random times. */
static int perform(const film_curve *curve, const film_mesh *mesh, film_state *s, const part *parts, int count, int cuts,
                   film_state *seen, int32_t *events_in_all) {
    double begin = s->time;
    *events_in_all = 0;
    for (int i = 0; i < count; i++) {
        HOLD(film_input(s, parts[i].load, parts[i].push, parts[i].stop_velocity) == FILM_OK);
        double cut = 0.0;
        for (int k = 1; k <= cuts; k++) {
            cut = k == cuts ? 1.0 : cut + (1.0 - cut) * uniform(0.0, 2.0 / (cuts - k + 1));
            int status = march(curve, mesh, s, begin + fmin(cut, 1.0) * parts[i].duration, seen, events_in_all);
            if (status != FILM_OK) return status;
        }
        begin += parts[i].duration;
    }
    return FILM_OK;
}

static void same_state(const film_state *a, const film_state *b, double depth, double speed, double tolerance) {
    HOLD(a->phase == b->phase && a->branch == b->branch && a->stage_max == b->stage_max && a->contacts == b->contacts);
    NEAR(a->time, b->time, b->time, tolerance);
    NEAR(a->xi, b->xi, depth + fabs(b->xi), tolerance);
    NEAR(a->nu, b->nu, speed, tolerance);
    NEAR(a->shift, b->shift, depth + fabs(b->shift), tolerance);
    NEAR(a->force, b->force, b->force_peak + b->f_max + b->force, tolerance);
    NEAR(a->xi_max, b->xi_max, depth, tolerance);
}

/* An impactor that is dropped, loaded, pushed with its support, and lands again and again: one step a part equals many,
 * and a state that was put aside runs on to the same bits. */
static void one_schedule(int which, const film_mesh *mesh) {
    static film_state seen[2][EVENT_ROOM];
    const film_curve *curve = &curves[which];
    film_state s, once, cut, saved, redone;
    part parts[PARTS];
    int32_t count[2];
    double nu = over_decades(1e-2, which == SERIES ? 1.5 : 10.0), gamma = uniform(0.0, 1.0) < 0.3 ? 0.0 : over_decades(1e-3, 10.0);
    double gap = uniform(0.0, 1.0) < 0.5 ? 0.0 : uniform(0.0, 3.0), speed = nu;
    uint64_t from = seed;
    for (int i = 0; i < PARTS; i++) {
        parts[i].duration = over_decades(1e-2, 20.0);
        parts[i].load = uniform(0.0, 1.0) < 0.3 ? 0.0 : uniform(-0.2, 0.3) * nu;
        /* Undamped and pushed back into its dent, it would come to the old depth with no speed: no two runs agree there. */
        if (gamma == 0.0 && which != HERTZ) parts[i].load = -fabs(parts[i].load);
        parts[i].push = uniform(0.0, 1.0) < 0.7 ? 0.0 : uniform(-0.3, 0.3) * nu;
        parts[i].stop_velocity = uniform(0.0, 1.0) < 0.7 ? 0.0 : uniform(-0.2, 0.2) * nu;
        speed += fabs(parts[i].load) * parts[i].duration + fabs(parts[i].push);
    }
    snprintf(where, sizeof where, "schedule from seed %llu, curve %d, nu %.6g, gamma %.6g, mesh %d %d %d",
             (unsigned long long)from, which, nu, gamma, (int)mesh->linearisation, (int)mesh->loading, (int)mesh->unloading);
    HOLD(film_init(curve, &s, -gap, nu, gamma, 0.0, 0.0) == FILM_OK);
    if (which == DAMPED) HOLD(film_damp(&s, 0.3) == FILM_OK);
    once = cut = s;
    int status = perform(curve, mesh, &once, parts, PARTS, 1, seen[0], &count[0]);
    int cut_status = perform(curve, mesh, &cut, parts, PARTS, whole(2, 40), seen[1], &count[1]);
    HOLD(status == cut_status && (status == FILM_OK || (status == FILM_BEYOND_LAW && which == SERIES)));
    HOLD(count[0] == count[1]);
    double tolerance = which == SERIES || gamma == 0.0 ? SERIES_ROUNDING : STEPS, depth = fmax(once.xi_max, 1e-3 * speed);
    same_state(&cut, &once, depth, speed, tolerance);
    for (int32_t i = 0; i < count[0] && i < EVENT_ROOM; i++) {
        HOLD(seen[0][i].event == seen[1][i].event);
        same_state(&seen[1][i], &seen[0][i], depth, speed, tolerance);
        stir_state(&seen[0][i]);
        events_seen++;
    }
    contacts += once.contacts;
    stir_state(&once);
    stir_state(&cut);

    memcpy(&saved, &s, sizeof saved);
    int first_cuts = whole(1, 5), first_parts = whole(1, PARTS);
    perform(curve, mesh, &saved, parts, first_parts, first_cuts, seen[0], &count[0]);
    memcpy(&once, &saved, sizeof saved);
    memcpy(&redone, &saved, sizeof saved);
    from = seed;
    status = perform(curve, mesh, &once, parts, PARTS, 7, seen[0], &count[0]);
    seed = from;
    HOLD(perform(curve, mesh, &redone, parts, PARTS, 7, seen[1], &count[1]) == status && count[0] == count[1]);
    HOLD(memcmp(&once, &redone, sizeof once) == 0);
    size_t kept = (size_t)(count[0] < EVENT_ROOM ? count[0] : EVENT_ROOM);
    HOLD(memcmp(seen[0], seen[1], kept * sizeof *seen[0]) == 0);
}

/* ---------------------------------------------------------------- many at once */

/* A summary without lines, and the march's: all but times differ by `same` on fixed targets and on a straight law, whose lines are
 * exact, else by `lines_error`; so do times, which are quadratures on fixed targets. */
static void check_near(const film_summary *found, const film_summary *slow, const film_start *start, int linear, double same,
                       double lines_error) {
    int fixed = start->gamma == 0.0 && !(start->damping > 0.0);
    double tolerance = fixed || linear ? same : lines_error, of_times = fixed ? lines_error : tolerance;
    NEAR(found->maximum_force, slow->maximum_force, slow->maximum_force, tolerance);
    NEAR(found->maximum_indentation, slow->maximum_indentation, slow->maximum_indentation, tolerance);
    NEAR(found->time_of_maximum_indentation, slow->time_of_maximum_indentation, slow->contact_duration, of_times);
    NEAR(found->contact_duration, slow->contact_duration, slow->contact_duration, of_times);
    NEAR(found->permanent_indentation, slow->permanent_indentation, slow->maximum_indentation, tolerance);
    NEAR(found->final_velocity, slow->final_velocity, start->nu, tolerance);
    NEAR(found->shift, slow->shift, fabs(slow->shift) + 1e-300, tolerance);
    NEAR(found->work, slow->work, start->nu * start->nu, tolerance);
    HOLD(found->stage == slow->stage);
    HOLD(isnan(found->time_impactor_stops) == isnan(slow->time_impactor_stops));
    if (!isnan(slow->time_impactor_stops))
        NEAR(found->time_impactor_stops, slow->time_impactor_stops, slow->contact_duration, lines_error);
}

/* A batch gives every impact what it gives it alone, wherever it stands among the others and whatever the instructions;
 * and what the march gives: to the last bit where that is all there is, else nearly. film_impact gives the one or the other to the
 * last bit, but crosses pieces on fixed targets in its own way. */
static void check_batch(int which, const film_mesh *mesh, double same, double lines_error) {
    film_start *start = room_for(BATCH, sizeof *start);
    film_summary *summary = room_for(BATCH, sizeof *summary), *again = room_for(BATCH, sizeof *again), alone, slow;
    int32_t *status = room_for(BATCH, sizeof *status), *status_again = room_for(BATCH, sizeof *status_again), one;
    film_summary single;
    for (int i = 0; i < BATCH; i++) start[i] = random_start(which);
    start[BATCH / 2].nu = NAN;
    film_batch(film_instructions(), &curves[which], mesh, BATCH, start, summary, status);
    for (int32_t count = 0; count <= BATCH; count += 100) {
        for (int instructions = FILM_PLAIN; instructions <= film_instructions(); instructions++) {
            film_batch(instructions, &curves[which], mesh, count, start, again, status_again);
            HOLD(memcmp(again, summary, (size_t)count * sizeof *summary) == 0);
            HOLD(memcmp(status_again, status, (size_t)count * sizeof *status) == 0);
        }
    }
    for (int i = 0; i < BATCH; i++) {
        snprintf(where, sizeof where, "batch, curve %d, nu %.17g, gamma %.17g, load %.17g, mesh %d %d %d", which,
                 start[i].nu, start[i].gamma, start[i].load, (int)mesh->linearisation, (int)mesh->loading,
                 (int)mesh->unloading);
        film_batch(film_instructions(), &curves[which], mesh, 1, &start[i], &alone, &one);
        HOLD(one == status[i]);
        HOLD(memcmp(&alone, &summary[i], sizeof alone) == 0);
        stir_summary(status[i], &summary[i]);
        HOLD(film_marched(&curves[which], mesh, &start[i], &slow) == status[i]);
        HOLD(film_impact(&curves[which], mesh, &start[i], &single) == status[i]);
        int damped = start[i].damping > 0.0;
        int quick = mesh->linearisation == FILM_WORK_PRESERVING && start[i].gamma == 0.0 && !damped && start[i].load == 0.0;
        if (!quick) HOLD(memcmp(&single, &alone, sizeof single) == 0);
        stir_summary(status[i], &single);
        int stops_late = start[i].gamma == 0.0 && start[i].stop_velocity < 0.0; /* which lanes find on a branch */
        int moved = start[i].stop_velocity != 0.0 && !stops_late;
        int fixed_load = start[i].load != 0.0 && start[i].gamma == 0.0;
        if (mesh->linearisation == FILM_CHORD || (!damped && (fixed_load || moved)))
            HOLD(memcmp(&alone, &slow, sizeof alone) == 0);
        int straight = which == LINEAR || which == SOFTENING;
        if (status[i] != FILM_EVENT || (straight && start[i].gamma > 1.5)) continue; /* near critical damping */
        if (start[i].gamma * pow(start[i].nu, 0.2) > 2.0) continue; /* fades out slowly: asks for more segments */
        if (which == CLEARANCE && fabs(slow.final_velocity) < 0.1 * start[i].nu) continue; /* how long it takes to part is rounding */
        check_near(&alone, &slow, &start[i], which == LINEAR, same, lines_error);
        check_near(&single, &slow, &start[i], which == LINEAR, same, lines_error);
    }
    HOLD(status[BATCH / 2] == FILM_BAD_NUMBER);
    film_batch(film_instructions(), &curves[which], mesh, 0, NULL, NULL, NULL);
    free(start);
    free(summary);
    free(again);
    free(status);
    free(status_again);
}

#endif
