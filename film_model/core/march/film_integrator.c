/* The same contact for another integrator of the true law, which owns xi, nu and shift: the force, indicators whose signs
 * change where something happens, and what happens there (FMI's Model Exchange). docs/method.md, section 11. */
#include "march/film_march.h"

/* How late an indicator changes sign, as a fraction of `speed`: FMI wants none to be 0 right after an event.
 * Needed by test_no_indicator_is_0_right_after_an_event. */
static const double INDICATOR_DELAY = 1e-10;

/* film_force_rounding where two stages meet at the current point, or a branch and the loading curve; 0 elsewhere. At such a
 * point the one force may turn the motion inwards and the other outwards. */
static double kink_tolerance(const film_curve *curve, const film_state *s) {
    double reach = ADJACENT * fabs(s->xi);
    if (s->branch == FILM_BRANCH) return fabs(s->xi - s->xi_max) <= reach ? film_force_rounding(curve, s, s->stage_max) : 0.0;
    if (s->branch <= FILM_STRETCHED) {
        int meets = fabs(s->xi - run_edge(curve, s, 1)) <= reach;
        meets |= s->branch < FILM_STRETCHED && fabs(s->xi - run_edge(curve, s, -1)) <= reach;
        return meets ? film_force_rounding(curve, s, s->stage_max) : 0.0;
    }
    for (int32_t k = s->branch; k <= s->branch + 1 && k < curve->stages; k++)
        if (k > 0 && fabs(s->xi - curve->stage[k].begin) <= reach) return film_force_rounding(curve, s, k);
    return 0.0;
}

/* docs/method.md, section 11. */
void film_indicators(const film_curve *curve, const film_state *s, double speed, double indicators[FILM_INDICATORS]) {
    double late = INDICATOR_DELAY * fabs(speed), force, work;
    for (int k = 0; k < FILM_INDICATORS; k++) indicators[k] = 1.0;
    if (s->branch == FILM_FREE) {
        indicators[1] = fmax(s->xi_free - s->xi, -film_release_margin(curve, s)) + late;
        return;
    }
    law_at(curve, &s->line, s->xi, &force, &work);
    double far = run_limit(curve, s), near = run_edge(curve, s, -s->direction);
    indicators[0] = s->direction * (s->nu - s->gamma * force) + s->gamma * kink_tolerance(curve, s) + late;
    if (far < INFINITY) indicators[1] = s->direction * (far - s->xi) + late;
    if (near < INFINITY) indicators[2] = s->direction * (s->xi - near) + late;
    indicators[3] = (s->moving_in ? s->nu - s->stop_velocity : s->stop_velocity - s->nu) + late;
    if (!is_damped(curve, s)) return;
    if (s->direction < 0) indicators[1] = fmin(indicators[1], film_release_margin(curve, s) + late);
    else indicators[4] = (s->rising ? 1.0 : -1.0) * film_force_rate(curve, s, s->xi, s->nu) + late;
}

/* In flight: whether the contact begins, and at which xi. A damped contact may begin again inside its dent. */
static int touches(const film_curve *curve, film_state *s) {
    if (s->xi < s->xi_free || (s->xi == s->xi_free && !(s->nu > 0.0 || (s->nu == 0.0 && s->load > 0.0)))) return 0;
    double margin = film_release_margin(curve, s);
    if (!(margin > 0.0)) return 0; /* the dent closes more slowly than the impactor leaves */
    if (margin == INFINITY) s->xi = s->xi_free;
    return 1;
}

/* In contact: how the run ends in the current state, or ENDS_NODE if it goes on; puts xi to where it ends. */
static int run_ends(const film_curve *curve, film_state *s) {
    double ahead = s->direction * (s->nu - s->gamma * s->force), edge = run_limit(curve, s);
    double to_edge = s->direction * (edge - s->xi);
    int released = s->direction < 0 && is_damped(curve, s) && film_release_margin(curve, s) < 0.0;
    if (to_edge > 0.0 && ahead >= -s->gamma * kink_tolerance(curve, s) && !released) return ENDS_NODE;
    if (to_edge > 0.0 && released) return ENDS_RELEASE;
    if (!(to_edge > 0.0)) {
        s->xi = edge;
        return ENDS_EDGE;
    }
    edge = run_edge(curve, s, -s->direction); /* a step back over the beginning of the run: it turned there at the latest */
    if (s->direction * (s->xi - edge) < 0.0) s->xi = edge;
    return ENDS_TURN;
}

/* Ends the run at the current xi, in the given way. docs/method.md, section 11. */
int film_end_run(const film_curve *curve, film_state *s, int ends) {
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->elastic;
    film_open_line(s);
    film_end_here(s, ends);
    int status = film_finish(curve, NULL, s);
    film_choose_loop(curve, s);
    film_open_run(curve, s);
    return status;
}

static int handle_event(const film_curve *curve, film_state *s) {
    int ends = ENDS_EDGE;
    s->event = FILM_NO_EVENT;
    film_open_run(curve, s);
    law_at(curve, &s->line, s->xi, &s->elastic, &s->work);
    s->force = s->elastic;
    if (!isfinite(s->xi) || !isfinite(s->nu) || !isfinite(s->force)) return FILM_BAD_NUMBER;
    if (s->branch == FILM_FREE) {
        if (!touches(curve, s)) return FILM_OK;
    } else {
        if (is_damped(curve, s)) s->force_peak = fmax(s->force_peak, contact_force(curve, s));
        if (s->moving_in && s->nu < s->stop_velocity) return film_stop(s);
        if (s->nu > s->stop_velocity) s->moving_in = 1;
        ends = run_ends(curve, s);
        if (ends == ENDS_NODE) return FILM_OK;
    }
    return film_end_run(curve, s, ends);
}

/* docs/method.md, section 11. */
int film_switch(const film_curve *curve, film_state *s) {
    int status = handle_event(curve, s);
    s->rising = status >= 0 && s->direction > 0 && is_damped(curve, s) && film_force_rate(curve, s, s->xi, s->nu) >= 0.0;
    return status;
}
