/* Of core_check.c: contacts whose answer is known, and input that is refused. */
#ifndef CORE_CHECK_ANSWERS_H
#define CORE_CHECK_ANSWERS_H

#include "core_check_contacts.h"

/* ---------------------------------------------------------------- known answers */

/* f = x on a target that gives way: x'' + gamma x' + x = 0, and on the way out the same with a stiffer spring. Straight
 * lines follow a straight law exactly, however few they are. */
static void check_linear_law(const film_mesh *mesh) {
    for (int i = 0; i < 200; i++) {
        film_start start = {over_decades(1e-3, 1e3), i % 4 == 0 ? 0.0 : over_decades(1e-3, 1.9), 0.0, 0.0, INFINITY, 0.0};
        film_summary got;
        snprintf(where, sizeof where, "linear law, nu %.17g, gamma %.17g", start.nu, start.gamma);
        double a = 0.5 * start.gamma, omega = sqrt(1.0 - a * a), turn = atan2(omega, a) / omega;
        double stiff = 1.0 / (1.0 - LEFT_OVER), b = 0.5 * stiff * start.gamma, square = stiff - b * b;
        int status = film_marched(&curves[LINEAR], mesh, &start, &got);
        if (fabs(square) > 0.01) HOLD(status == (square > 0.0 ? FILM_EVENT : FILM_ENDLESS)); /* or it creeps for ever */
        double deep = start.nu * exp(-a * turn);
        NEAR(got.time_of_maximum_indentation, turn, turn, EXACT);
        NEAR(got.maximum_indentation, deep, deep, EXACT);
        NEAR(got.maximum_force, deep, deep, EXACT);
        if (status == FILM_EVENT) NEAR(got.permanent_indentation, LEFT_OVER * deep, deep, EXACT);
        if (status == FILM_EVENT) NEAR(got.work, 0.5 * LEFT_OVER * deep * deep, deep * deep, EXACT);
        if (square < 0.01) continue; /* near critical damping the formula below cancels */
        omega = sqrt(square);
        double out = (0.5 * acos(-1.0) + atan(b / omega)) / omega; /* x cos + b/omega x sin falls to 0 */
        double late = 1e-15 * deep / fabs(got.final_velocity); /* a position rounded, at the speed of leaving */
        NEAR(got.contact_duration, turn + out, turn + out + late / EXACT, EXACT);
        NEAR(got.final_velocity, -deep * sqrt(stiff) * (1.0 - LEFT_OVER) * exp(-b * out), start.nu, EXACT);
    }
}

/* Hertz on a half-space: the depth by energy, nothing absorbed, and the duration to the order of the method. */
static void check_hertz(void) {
    /* 2 (5/4)^(2/5) integral of (1 - x^(5/2))^(-1/2) from 0 to 1: sqrt(pi) gamma(7/5)/gamma(9/10) */
    const double constant = 2.0 * pow(1.25, 0.4) * sqrt(acos(-1.0)) * tgamma(1.4) / tgamma(0.9);
    double before = 0.0;
    for (int32_t n = 32; n <= 256; n *= 2) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, n, n);
        film_start start = {2.5, 0.0, 0.0, 0.0, INFINITY, 0.0};
        film_summary got;
        snprintf(where, sizeof where, "Hertz, %d segments", (int)n);
        HOLD(film_marched(&curves[HERTZ], &own.mesh, &start, &got) == FILM_EVENT);
        double deep = pow(1.25 * start.nu * start.nu, 0.4), duration = constant * pow(start.nu, -0.2);
        NEAR(got.maximum_indentation, deep, deep, EXACT);
        NEAR(got.maximum_force, pow(deep, 1.5), pow(deep, 1.5), EXACT);
        NEAR(got.final_velocity, -start.nu, start.nu, EXACT);
        NEAR(got.work, 0.0, start.nu * start.nu, EXACT);
        double miss = fabs(got.contact_duration / duration - 1.0);
        if (n > 32) HOLD(before / miss > 14.5 && before / miss < 16.5); /* fourth order: 16 */
        before = miss;
        free(own.memory);
    }
    HOLD(before < 2e-11);
}

/* The same contact under a law and under its series, whose rounding is that of its largest value. */
static void same_contact(const film_curve *law, const film_curve *fitted, const film_mesh *mesh, const film_start *start, int stage,
                         double rounding) {
    film_summary a, b;
    snprintf(where, sizeof where, "a law twice, nu %.17g, gamma %.17g, load %.17g", start->nu, start->gamma, start->load);
    HOLD(film_marched(law, mesh, start, &a) == FILM_EVENT);
    HOLD(film_marched(fitted, mesh, start, &b) == FILM_EVENT);
    HOLD(a.stage == stage && b.stage == stage);
    NEAR(a.maximum_force, b.maximum_force, a.maximum_force, rounding);
    NEAR(a.maximum_indentation, b.maximum_indentation, a.maximum_indentation, rounding);
    NEAR(a.time_of_maximum_indentation, b.time_of_maximum_indentation, a.time_of_maximum_indentation, rounding);
    NEAR(a.contact_duration, b.contact_duration, a.contact_duration, rounding);
    NEAR(a.final_velocity, b.final_velocity, start->nu, rounding);
}

static void check_series(const film_mesh *mesh) {
    for (int i = 0; i < 200; i++) { /* down to forces of 1e-7 of the largest */
        film_start start = {over_decades(1e-6, 0.89), i % 2 ? 0.0 : over_decades(1e-3, 5.0), 0.0, 0.0, INFINITY, 0.0};
        same_contact(&curves[HERTZ], &curves[SERIES], mesh, &start, 0, SERIES_ROUNDING);
    }
    static const double root[] = {214.0, 214.0}, mean[] = {428.0 / 3.0, 428.0 / 3.0};
    for (int i = 0; i < 100; i++) { /* a root that begins where almost nothing was, as soft a target, and a turn within 1e-11 of its span */
        film_curve law, fitted;
        memset(&law, 0, sizeof law);
        add_stage(&law, 0.5, power(0.0, 0.0, 1e-11, 0.0, 1.0));
        fitted = law;
        add_stage(&law, 236.5, power(0.5, 5e-12, 0.0, 428.0 / sqrt(236.0), 0.5));
        add_stage(&fitted, 236.5, series(FILM_ROOT_SERIES, 0.5, 236.5, 2, root))->mean = series(FILM_ROOT_SERIES, 0.5, 236.5, 2, mean);
        film_start start = {over_decades(1e-2, 1.0), over_decades(1.0, 30.0), -1e-12, 0.0, INFINITY, 0.0};
        same_contact(&law, &fitted, mesh, &start, 1, 2e-4); /* it creeps out to forces of rounding */
    }
}

/* ---------------------------------------------------------------- bad input */

#define REFUSED(change)                                     \
    do {                                                    \
        film_curve bad = curves[which];                     \
        change;                                             \
        HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);     \
    } while (0)

static void check_bad_springs(void) {
    static const double bad[] = {0.0, -1.0, NAN, INFINITY};
    film_curve curve = curves[SOFTENING];
    for (int k = 0; k < 4; k++) HOLD(film_spring(&curve, bad[k]) == FILM_BAD_CURVE);
    HOLD(film_spring(&curve, 7.9) == FILM_OK && curve.compliance == 7.9);
    HOLD(film_spring(&curve, 0.1) == FILM_BAD_CURVE); /* it has one */
    curve = curves[SOFTENING];
    HOLD(film_spring(&curve, 8.1) == FILM_BAD_CURVE); /* the slope is -1/8: it would snap through */
    curve = curves[DAMPED];
    HOLD(film_spring(&curve, 0.1) == FILM_BAD_CURVE);
}

static void check_bad_curves(void) {
    for (int which = 0; which < CURVES; which++) {
        snprintf(where, sizeof where, "bad versions of curve %d", which);
        HOLD(film_check_curve(&curves[which]) == FILM_OK);
        int32_t last = curves[which].stages - 1;
        REFUSED(bad.stages = 0);
        REFUSED(bad.stages = FILM_MAX_STAGES + 1);
        REFUSED(bad.stages = -1);
        REFUSED(bad.pieces++);
        REFUSED(bad.stage[0].begin = 0.5);
        REFUSED(bad.stage[0].begin = NAN);
        REFUSED(bad.stage[last].end = NAN);
        REFUSED(bad.stage[last].end = -1.0);
        REFUSED(bad.stage[0].first = 1);
        REFUSED(bad.stage[0].first = -1);
        REFUSED(bad.stage[last].count = 0);
        REFUSED(bad.stage[last].count = FILM_MAX_PIECES + 1);
        REFUSED(bad.stage[last].count = INT32_MAX);
        REFUSED(bad.stage[last].unloading = 5);
        REFUSED(bad.stage[last].unloading = -1);
        REFUSED(bad.stage[last].reload_exponent = -1.0);
        REFUSED(bad.stage[last].reload_exponent = NAN);
        REFUSED(bad.compliance = -1e-9);
        REFUSED(bad.compliance = NAN);
        REFUSED(bad.compliance = INFINITY);
        if (which == DAMPED) REFUSED(bad.compliance = 1e-9);
        REFUSED(bad.piece[0].end = 0.0);
        REFUSED(bad.piece[0].end = NAN);
        REFUSED(bad.piece[0].work_at_begin = NAN);
        REFUSED(bad.piece[0].force.form = 3);
        REFUSED(bad.piece[0].force.form = -1);
        REFUSED(bad.piece[0].force.origin = INFINITY);
        REFUSED(bad.piece[0].force.per_span = 0.0);
        REFUSED(bad.piece[0].force.per_span = NAN);
        if (which != SERIES) {
            REFUSED(bad.piece[0].force.constant = NAN);
            REFUSED(bad.piece[0].force.slope = INFINITY);
            REFUSED(bad.piece[0].force.square = NAN);
            REFUSED(bad.piece[0].force.coefficient = -INFINITY);
            REFUSED(bad.piece[0].force.exponent = 0.0);
            REFUSED(bad.piece[0].force.exponent = -1.5);
            REFUSED(bad.piece[0].force.exponent = NAN);
            REFUSED(bad.piece[0].force.per_span = 2.0);
        } else {
            REFUSED(bad.piece[0].force.terms = 0);
            REFUSED(bad.piece[0].force.terms = FILM_MAX_TERMS + 1);
            REFUSED(bad.piece[0].force.series[1] = NAN);
            REFUSED(bad.piece[0].mean.terms = 0);
            REFUSED(bad.piece[0].mean.series[3] = INFINITY);
            REFUSED(bad.stage[last].end = bad.piece[2].end = INFINITY);
        }
        if (last > 0) {
            REFUSED(bad.stage[1].begin = 1.5);
            REFUSED(bad.stage[0].end = INFINITY);
            REFUSED(bad.stage[1].first = 0);
        }
        REFUSED(bad.stage[last].damped = 2);
        if (which == DAMPED) {
            REFUSED(bad.piece[0].damping.coefficient = NAN);
            REFUSED(bad.stage[0].unloading = FILM_RESIDUAL);
        } else if (which != HERTZ) {
            REFUSED(bad.stage[last].damped = 1);
            REFUSED(bad.piece[curves[which].stage[last].first].recovery.form = 7);
            REFUSED(bad.piece[curves[which].stage[last].first].recovery.origin = NAN);
            REFUSED(bad.piece[curves[which].stage[last].first].exponent.per_span = -1.0);
        }
    }
}

static void check_bad_meshes(void) {
    static const int32_t counts[][3] = {{FILM_WORK_PRESERVING, 0, 5}, {FILM_WORK_PRESERVING, 5, 0},
                                        {FILM_CHORD, -1, 5}, {FILM_CHORD, 5, FILM_MAX_SEGMENTS + 1},
                                        {FILM_WORK_PRESERVING, INT32_MAX, 1}, {2, 5, 5}, {-1, 5, 5}};
    film_start start = {1.0, 0.0, 0.0, 0.0, INFINITY, 0.0};
    film_summary summary;
    film_state s;
    int32_t a, b;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        snprintf(where, sizeof where, "bad mesh %d", (int)i);
        film_mesh mesh;
        HOLD(film_mesh_init(&mesh, counts[i][0], counts[i][1], counts[i][2], NULL) == FILM_BAD_MESH);
        HOLD(film_marched(&curves[HERTZ], &mesh, &start, &summary) == FILM_BAD_MESH);
        HOLD(film_init(&curves[HERTZ], &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK);
        HOLD(film_step(&curves[HERTZ], &mesh, &s, 1.0) == FILM_BAD_MESH);
        HOLD(film_record(&curves[HERTZ], &mesh, &s, 1.0, lines, 1, &a, events, 1, &b, &summary) == FILM_BAD_MESH);
        HOLD(a == 0 && b == 0);
    }
}

static void check_bad_numbers(const film_mesh *mesh) {
    static const double not_finite[] = {NAN, INFINITY, -INFINITY};
    const film_curve *curve = &curves[ELASTOPLASTIC];
    film_state s, before;
    film_summary summary;
    int32_t a, b;
    snprintf(where, sizeof where, "bad numbers");
    for (int k = 0; k < 3; k++) {
        double x = not_finite[k];
        HOLD(film_init(curve, &s, x, 1.0, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, x, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, x, 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, 0.0, x, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_init(curve, &s, 0.0, 1.0, 0.0, 0.0, x) == FILM_BAD_NUMBER);
        const film_start bad[] = {{x, 0.0, 0.0, 0.0, INFINITY, 0.0}, {1.0, x, 0.0, 0.0, INFINITY, 0.0},
                                  {1.0, 0.0, x, 0.0, INFINITY, 0.0}, {1.0, 0.0, 0.0, x, INFINITY, 0.0},
                                  {1.0, 0.0, 0.0, 0.0, INFINITY, x}};
        for (int i = 0; i < 5; i++) HOLD(film_marched(curve, mesh, &bad[i], &summary) == FILM_BAD_NUMBER);
    }
    const film_start none[] = {{0.0, 0.0, 0.0, 0.0, INFINITY, 0.0}, {-1.0, 0.0, 0.0, 0.0, INFINITY, 0.0},
                               {1.0, -1e-9, 0.0, 0.0, INFINITY, 0.0}, {1.0, 0.0, 0.0, 0.0, NAN, 0.0},
                               {1.0, 0.0, 0.0, 0.0, -1.0, 0.0}, {1.0, 0.0, 0.0, 0.0, INFINITY, -1e-9}};
    for (int i = 0; i < 6; i++) HOLD(film_marched(curve, mesh, &none[i], &summary) == FILM_BAD_NUMBER);
    HOLD(film_init(curve, &s, 1e-9, 1.0, 0.0, 0.0, 0.0) == FILM_BAD_NUMBER);
    HOLD(film_init(curve, &s, -1.0, 1.0, -1.0, 0.0, 0.0) == FILM_BAD_NUMBER);

    HOLD(film_init(curve, &s, -0.5, 2.0, 0.1, 0.0, 0.0) == FILM_OK);
    HOLD(film_step(curve, mesh, &s, 0.7) == FILM_EVENT && s.event == FILM_CONTACT_BEGINS);
    HOLD(film_step(curve, mesh, &s, 0.2) == FILM_OK);
    memcpy(&before, &s, sizeof s);
    HOLD(film_step(curve, mesh, &s, -1e-300) == FILM_BAD_NUMBER);
    HOLD(film_step(curve, mesh, &s, NAN) == FILM_BAD_NUMBER);
    HOLD(film_record(curve, mesh, &s, NAN, lines, LINE_ROOM, &a, events, EVENT_ROOM, &b, &summary) == FILM_BAD_NUMBER);
    HOLD(film_record(curve, mesh, &s, s.time - 0.1, lines, LINE_ROOM, &a, events, EVENT_ROOM, &b, &summary) == FILM_BAD_NUMBER);
    for (int k = 0; k < 3; k++) {
        HOLD(film_input(&s, not_finite[k], 0.0, 0.0) == FILM_BAD_NUMBER);
        HOLD(film_input(&s, 0.0, not_finite[k], 0.0) == FILM_BAD_NUMBER);
        HOLD(film_input(&s, 0.0, 0.0, not_finite[k]) == FILM_BAD_NUMBER);
    }
    HOLD(film_step(curve, mesh, &s, 0.0) == FILM_OK);
    HOLD(film_input(&s, 0.0, 0.0, 0.0) == FILM_OK);
    HOLD(memcmp(&before, &s, sizeof s) == 0); /* refusals, no time and no change leave the state as it was */
}

/* Steps without end stop at every event, and then say that nothing will ever come. */
static void check_endless(const film_mesh *mesh) {
    for (int which = 0; which < CURVES; which++) {
        film_state s, before;
        snprintf(where, sizeof where, "endless steps, curve %d", which);
        HOLD(film_init(&curves[which], &s, -1.0, 1.0, 0.3, 0.0, 0.0) == FILM_OK);
        int32_t ends = 0;
        while (film_step(&curves[which], mesh, &s, INFINITY) == FILM_EVENT) {
            HOLD(isfinite(s.time) && ++ends < 20);
            stir_state(&s);
        }
        HOLD(s.event == FILM_CONTACT_ENDS && s.phase == FILM_SEPARATED && s.contacts == 1 && isfinite(s.xi));
        memcpy(&before, &s, sizeof s);
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS);
        HOLD(s.time == before.time && s.xi == before.xi && s.nu == before.nu);

        HOLD(film_init(&curves[which], &s, -1.0, -1.0, 0.3, 0.0, 0.0) == FILM_OK); /* away from the target */
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS && s.contacts == 0);
        HOLD(film_init(&curves[which], &s, 0.0, 0.0, 0.0, 0.0, 0.0) == FILM_OK); /* at rest where contact begins */
        HOLD(film_step(&curves[which], mesh, &s, INFINITY) == FILM_ENDLESS && s.contacts == 0);

        /* held shut by a load on a target that damps: it comes to rest where force and load balance */
        HOLD(film_init(&curves[which], &s, 0.0, 0.5, 1.0, 0.4, 0.0) == FILM_OK);
        for (ends = 0; film_step(&curves[which], mesh, &s, INFINITY) == FILM_EVENT; ends++) HOLD(ends < 1000);
        HOLD(film_step(&curves[which], mesh, &s, 1e6) == FILM_OK);
        NEAR(s.force, 0.4, 0.4, 1e-9);
        NEAR(s.nu, 0.4, 0.4, 1e-9); /* a compliant target yields at the speed gamma f for ever */
        stir_state(&s);
    }
}

#endif
