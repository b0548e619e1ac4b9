/* Contacts of bodies that relax: states, steps and events. docs/method.md, section 14. */
#include "relax/film_relax_parts.h"

#include <math.h>
#include <string.h>

/* First step over the elastic contact's time scale, and the most by which a step is longer than the one before. */
static const double FIRST_STEP = 0.02, GROWTH = 2.0;

/* Longest step over that time scale. */
static const double LONGEST_STEP = 0.5;

/* Rate of indentation over the reference velocity, and integral of e d(xi) over the depth, that count as 0 where a step
 * ends there. */
static const double TURNED = 1e-12, ENDED = 1e-13;

/* Velocity over the reference velocity from which the way out turns again, and up to which the impactor stops at the turn.
 * Between two steps of the way out, whose forces differ in their last digits there, it turns again from JUMPED. */
static const double INWARDS = 1e-9, JUMPED = 1e-5;

enum { TRIES = 60, MOST_EVENTS = 64 };

/* ---------------------------------------------------------------- states */

static int32_t law_is_good(const film_relaxation *law) {
    double sum = law->rest;
    if (law->terms < 0 || law->terms > FILM_RELAXATIONS || !(law->rest > 0.0)) return 0;
    for (int32_t i = 0; i < law->terms; i++) {
        if (!(law->share[i] >= 0.0) || !(law->rate[i] > 0.0) || law->rate[i] == INFINITY) return 0;
        sum += law->share[i];
    }
    return fabs(sum - 1.0) < 1e-9;
}

int film_relax_init(film_relax *s, const film_relaxation *law, const film_start *start, double tolerance, double xi) {
    double sum = start->nu + start->gamma + start->load + start->stop_velocity + xi;
    memset(s, 0, sizeof *s);
    if (!law_is_good(law) || sum - sum != 0.0 || !(xi <= 0.0) || !(start->gamma >= 0.0) || !(tolerance > 0.0)) return FILM_BAD_NUMBER;
    s->law = *law;
    s->gamma = start->gamma;
    s->load = start->load;
    s->stop_velocity = start->stop_velocity;
    s->tolerance = tolerance;
    s->xi = xi;
    s->nu = start->nu;
    s->branch = FILM_FREE;
    s->phase = FILM_APPROACHING;
    s->stop_at = INFINITY;
    return FILM_OK;
}

void film_relax_motion(const film_relax *s, const film_relax_step *steps, double values[5]) {
    if (s->has_step) {
        film_relax_at(&steps[s->steps - 1], s->gamma, s->tau, values);
        values[2] = film_relax_force(s, steps, s->steps - 1, s->tau);
        values[1] = values[3] - s->gamma * values[2];
        return;
    }
    double t = s->tau;
    values[0] = s->xi + t * (s->nu + 0.5 * s->load * t);
    values[1] = values[3] = s->nu + s->load * t;
    values[2] = 0.0;
    values[4] = s->shift;
    if (s->branch == FILM_FREE || s->steps == 0) return;
    const film_relax_step *last = &steps[s->steps - 1]; /* between two steps of a contact */
    film_relax_at(last, s->gamma, last->length, values);
    values[2] = film_relax_force(s, steps, s->steps - 1, last->length);
    values[3] = s->nu;
    values[1] = s->nu - s->gamma * values[2];
}

double film_relax_spent(const film_relax *s, const film_relax_step *steps) {
    return s->spent + (s->has_step ? film_relax_work(&steps[s->steps - 1], s->tau) : 0.0);
}

/* Ends the step, or the flight, where the motion is now. */
static void close_here(film_relax *s, film_relax_step *steps) {
    double values[5];
    film_relax_motion(s, steps, values);
    s->spent = film_relax_spent(s, steps);
    if (s->has_step) {
        film_relax_step *step = &steps[s->steps - 1];
        if (s->branch == 0) s->peak = fmax(s->peak, film_relax_peak(s, steps, s->steps - 1, s->tau)); /* the way out only falls */
        if (s->tau < step->length) {
            film_relax_memory(&s->law, step, s->tau, s->branch == 0, s->q, s->p);
            step->length = s->tau;
            s->ends = FILM_NO_EVENT;
        }
    }
    s->time += s->tau;
    s->tau = 0.0;
    s->has_step = 0;
    s->xi = values[0];
    s->nu = values[3];
    s->shift = values[4];
}

int film_relax_input(film_relax *s, film_relax_step *steps, double load, double nu_change, double stop_velocity) {
    double sum = load + nu_change + stop_velocity;
    if (sum - sum != 0.0) return FILM_BAD_NUMBER;
    close_here(s, steps);
    s->load = load;
    s->nu += nu_change;
    s->stop_velocity = stop_velocity;
    return FILM_OK;
}

/* ---------------------------------------------------------------- steps */

/* Time of an elastic contact, to about a factor of 2. */
static double clock_of(const film_relax *s) { return pow(s->speed, -0.2); }

/* Next length to try after a step that ends beyond the turn, or before it by an extrapolation that is too short for another
 * step; 0 if it ends well. *ends: FILM_MAXIMUM_INDENTATION if it ends at the turn. */
static double length_to_turn(const film_relax *s, const film_relax_step *to, int32_t *ends) {
    double rate = to->rate[0] + to->rate[1] + to->rate[2] + to->rate[3] + to->rate[4];
    double slope = (to->rate[1] + 2.0 * to->rate[2] + 3.0 * to->rate[3] + 4.0 * to->rate[4]) / to->h;
    if (fabs(rate) <= TURNED * s->speed && slope < 0.0) {
        *ends = FILM_MAXIMUM_INDENTATION;
        return 0.0;
    }
    if (rate < 0.0) return to->h * film_relax_falls(to->rate, 0.0, 1.0);
    double more = -rate / slope;
    return slope < 0.0 && more < 1e-3 * to->h ? to->h + more : 0.0;
}

/* The same to the end of contact, where the integral of e d(xi) is 0. */
static double length_to_end(const film_relax *s, const film_relax_step *to, const film_relax_trial *trial, int32_t *ends) {
    double slope = to->rate[0] + to->rate[1] + to->rate[2] + to->rate[3] + to->rate[4];
    for (int32_t i = 0; i < s->law.terms; i++) slope -= s->law.share[i] * s->law.rate[i] * trial->p[i];
    if (fabs(trial->push) <= ENDED * to->xi) {
        *ends = FILM_CONTACT_ENDS;
        return 0.0;
    }
    double more = -trial->push / slope;
    if (trial->push < 0.0) return slope < 0.0 && to->h + more > 0.0 ? to->h + more : 0.5 * to->h;
    return slope < 0.0 && more < 1e-3 * to->h ? to->h + more : 0.0;
}

/* Places of t1 at the nodes of a step of length h, as if it went back as fast as on the last step. */
static void guess_matches(const film_relax *s, double h, double match[4]) {
    static const double at[4] = {0.07, 0.33, 0.67, 0.93};
    double behind = s->time > s->turned ? (s->turned - s->match) / (s->time - s->turned) : 1.0;
    for (int j = 0; j < 4; j++) match[j] = s->match - behind * at[j] * h;
}

/* Plans the next step of a contact. */
static int plan_step(film_relax *s, film_relax_step *steps) {
    film_relax_step *to = &steps[s->steps];
    film_relax_trial trial;
    double clock = clock_of(s), h = s->next_h > 0.0 ? s->next_h : FIRST_STEP * clock, match[4], growth;
    int found = 0;
    if (s->steps >= FILM_RELAX_STEPS) return FILM_TOO_MANY;
    memset(to, 0, sizeof *to);
    memset(&trial, 0, sizeof trial); /* so that the bytes of a state depend on its past only */
    for (int k = 0; k < TRIES && !found; k++) {
        double wanted = s->tolerance * s->speed, next;
        guess_matches(s, h, match);
        if (!film_relax_try(s, steps, to, h, match, &trial)) {
            h *= 0.5;
            continue;
        }
        if (!(trial.error <= wanted)) {
            h *= fmax(0.2, 0.9 * sqrt(sqrt(wanted / trial.error)));
            continue;
        }
        s->ends = FILM_NO_EVENT;
        next = s->branch == 0 ? length_to_turn(s, to, &s->ends) : length_to_end(s, to, &trial, &s->ends);
        found = next == 0.0;
        if (!found) h = next;
    }
    if (!found) return FILM_TOO_MANY;
    growth = trial.error > 0.0 ? 0.9 * sqrt(sqrt(s->tolerance * s->speed / trial.error)) : GROWTH;
    s->next_h = fmin(h * fmin(GROWTH, growth), LONGEST_STEP * clock);
    memcpy(s->q, trial.q, sizeof s->q);
    memcpy(s->p, trial.p, sizeof s->p);
    s->match = match[3];
    s->steps++;
    s->has_step = 1;
    s->tau = 0.0;
    for (int k = 1; k <= 4 && s->branch == FILM_BRANCH; k++) { /* not at the beginning: the cubic is extrapolated there */
        double now[5];
        film_relax_at(to, s->gamma, 0.25 * k * to->length, now);
        if (now[1] > INWARDS * s->speed) return FILM_TURNS_AGAIN;
    }
    return FILM_OK;
}

/* When in the step nu falls to the stop velocity; INFINITY if it does not. */
static double stop_in(const film_relax *s, const film_relax_step *step) {
    const double *a = step->force;
    double nu[5] = {step->nu - s->stop_velocity, step->h * (step->load - a[0]), -step->h * a[1] / 2.0, -step->h * a[2] / 3.0,
                    -step->h * a[3] / 4.0};
    if (!s->moving_in) return INFINITY;
    double u = film_relax_falls(nu, 0.0, step->length / step->h);
    /* on a fixed target it stops at the turn, which is then reported first */
    return u > 1.0 || (s->ends == FILM_MAXIMUM_INDENTATION && s->gamma == 0.0) ? INFINITY : u * step->h;
}

/* ---------------------------------------------------------------- events */

static int report(film_relax *s, int32_t event) {
    s->event = event;
    return FILM_EVENT;
}

/* The velocity that makes an elastic contact as deep as a velocity, or a load, does; and that depth. */
static double speed_of(double nu, double load) { return fmax(fabs(nu), pow(fabs(load), 5.0 / 6.0)); }
static double depth_of(double speed) { return pow(1.25 * speed * speed, 0.4); }

static int begin_contact(film_relax *s) {
    s->xi = 0.0;
    s->branch = 0;
    s->phase = FILM_LOADING;
    s->begun = s->time;
    s->approach = s->steps = 0;
    s->next_h = s->peak = 0.0;
    s->moving_in = s->nu > s->stop_velocity;
    s->speed = speed_of(s->nu, s->load);
    memset(s->q, 0, sizeof s->q);
    memset(s->p, 0, sizeof s->p);
    s->contacts++;
    return report(s, FILM_CONTACT_BEGINS);
}

/* Free flight by dt, or to the next contact. */
static int fly(film_relax *s, film_relax_step *steps, double dt) {
    double now[5], root, touch = INFINITY;
    film_relax_motion(s, steps, now);
    root = now[1] * now[1] - 2.0 * s->load * now[0];
    if (now[0] >= 0.0 && s->contacts == 0) touch = now[1] > 0.0 || (now[1] == 0.0 && s->load > 0.0) ? 0.0 : INFINITY;
    else if (now[0] < 0.0 && root >= 0.0 && now[1] + sqrt(root) > 0.0) touch = -2.0 * now[0] / (now[1] + sqrt(root));
    else if (now[0] >= 0.0 && s->load > 0.0 && now[1] < 0.0) touch = -now[1] / s->load; /* turns before the surface is reached */
    if (touch > dt) {
        if (dt == INFINITY) return FILM_ENDLESS;
        s->tau += dt;
        return FILM_OK;
    }
    s->tau += touch;
    film_relax_motion(s, steps, now);
    if (film_relax_left(s, steps) > FILM_FORGOTTEN * depth_of(speed_of(now[1], s->load))) return FILM_REMEMBERS;
    if (s->contacts > 0 && now[0] > 1e-9) return FILM_REMEMBERS;
    film_relax_carry(s, steps);
    close_here(s, steps);
    return begin_contact(s);
}

static int turn(film_relax *s) {
    s->branch = FILM_BRANCH;
    s->phase = FILM_UNLOADING;
    s->approach = s->steps;
    s->turned = s->match = s->time;
    return report(s, FILM_MAXIMUM_INDENTATION);
}

static int part(film_relax *s) {
    s->branch = FILM_FREE;
    s->phase = FILM_SEPARATED;
    return report(s, FILM_CONTACT_ENDS);
}

/* The event at the end of the step, or none. */
static int end_step(film_relax *s, film_relax_step *steps) {
    int32_t ends = s->ends;
    close_here(s, steps);
    s->ends = FILM_NO_EVENT;
    if (ends == FILM_MAXIMUM_INDENTATION) return turn(s);
    if (ends == FILM_CONTACT_ENDS) return part(s);
    return FILM_OK;
}

/* A jump of the velocity, between two steps, may turn the indentation: an event, a failure, or FILM_OK. */
static int turn_by_jump(film_relax *s, const film_relax_step *steps) {
    double now[5];
    film_relax_motion(s, steps, now);
    if (s->branch == 0 && now[1] < 0.0) return s->steps > 0 ? turn(s) : part(s);
    return s->branch == FILM_BRANCH && now[1] > JUMPED * s->speed ? FILM_TURNS_AGAIN : FILM_OK;
}

int film_relax_advance(film_relax *s, film_relax_step *steps, double dt) {
    if (!(dt >= 0.0)) return FILM_BAD_NUMBER;
    s->event = FILM_NO_EVENT;
    for (int k = 0; k <= 2 * FILM_RELAX_STEPS; k++) {
        if (s->branch == FILM_FREE) return fly(s, steps, dt);
        if (s->moving_in && !s->has_step && s->branch == FILM_BRANCH && s->nu - s->stop_velocity <= INWARDS * s->speed) {
            s->moving_in = 0;
            return report(s, FILM_IMPACTOR_STOPS);
        }
        if (!s->has_step) {
            int status = turn_by_jump(s, steps);
            if (status == FILM_OK) status = plan_step(s, steps);
            if (status != FILM_OK) return status;
            s->stop_at = stop_in(s, &steps[s->steps - 1]);
        }
        const film_relax_step *step = &steps[s->steps - 1];
        double end = fmin(step->length, s->stop_at), left = end - s->tau;
        if (dt < left) {
            s->tau += dt;
            return FILM_OK;
        }
        dt -= left;
        s->tau = end;
        if (s->stop_at < step->length) {
            s->stop_at = INFINITY;
            s->moving_in = 0;
            return report(s, FILM_IMPACTOR_STOPS);
        }
        if (end_step(s, steps) == FILM_EVENT) return FILM_EVENT;
    }
    return FILM_TOO_MANY;
}

/* ---------------------------------------------------------------- contacts */

int film_relax_impact(const film_relaxation *law, const film_start *start, double tolerance, film_relax *s,
                      film_relax_step *steps, film_summary *summary) {
    memset(summary, 0, sizeof *summary);
    summary->time_impactor_stops = summary->contact_duration = summary->permanent_indentation = summary->final_velocity = NAN;
    if (!(start->nu > 0.0 || (start->nu == 0.0 && start->load > 0.0))) return FILM_BAD_NUMBER;
    int status = film_relax_init(s, law, start, tolerance, 0.0);
    for (int k = 0; k < MOST_EVENTS && status >= 0; k++) {
        double now = s->time + s->tau, values[5];
        status = film_relax_advance(s, steps, fmax(start->time_limit - now, 0.0));
        if (status != FILM_EVENT || s->event == FILM_CONTACT_ENDS) break;
        film_relax_motion(s, steps, values);
        now = s->time + s->tau;
        if (s->event == FILM_MAXIMUM_INDENTATION) {
            summary->maximum_indentation = values[0];
            summary->time_of_maximum_indentation = now;
        } else if (s->event == FILM_IMPACTOR_STOPS) {
            summary->time_impactor_stops = now;
        }
    }
    if (status < 0) return status;
    if (s->has_step) close_here(s, steps);
    summary->maximum_force = s->peak;
    summary->shift = s->shift;
    summary->work = s->spent;
    summary->lines = s->steps;
    if (status == FILM_EVENT) {
        summary->contact_duration = s->time;
        summary->permanent_indentation = s->xi;
        summary->final_velocity = s->nu;
    }
    return status;
}

void film_relax_batch(int64_t count, const film_relaxation *laws, const film_start *start, double tolerance, film_relax *state,
                      film_relax_step *steps, film_summary *summary, int32_t *status) {
    for (int64_t i = 0; i < count; i++) status[i] = film_relax_impact(&laws[i], &start[i], tolerance, state, steps, &summary[i]);
}

void film_relax_sample(const film_relax *s, const film_relax_step *steps, const double *times, int64_t count, double *values,
                       int8_t *branches) {
    film_relax after = *s;
    int32_t k = 0;
    for (int64_t i = 0; i < count; i++) {
        while (k < s->steps && times[i] > steps[k].time + steps[k].length) k++;
        if (s->branch == FILM_FREE && times[i] == s->time) k = s->steps; /* the end of contact, without force */
        if (k < s->steps) {
            double tau = fmax(times[i] - steps[k].time, 0.0), *at = &values[5 * i];
            film_relax_at(&steps[k], s->gamma, tau, at);
            at[2] = film_relax_force(s, steps, k, tau);
            at[1] = at[3] - s->gamma * at[2];
            branches[i] = k < s->approach || s->approach == 0 ? 0 : FILM_BRANCH;
        } else {
            after.has_step = 0;
            after.tau = fmax(times[i] - s->time, 0.0);
            film_relax_motion(&after, steps, &values[5 * i]);
            branches[i] = (int8_t)s->branch;
        }
    }
}

void film_relax_sizes(int64_t sizes[3]) {
    sizes[0] = (int64_t)sizeof(film_relaxation);
    sizes[1] = (int64_t)sizeof(film_relax_step);
    sizes[2] = (int64_t)sizeof(film_relax);
}
