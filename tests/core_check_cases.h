/* Of core_check.c: inputs that once broke the march. */
#ifndef CORE_CHECK_CASES_H
#define CORE_CHECK_CASES_H

#include "core_check_contacts.h"

/* Inputs that broke the march once, each as small as it was found: a power up to `end`, straight on with `slope` after that,
 * or a root; a contact that turns leaves `left` of its depth, or opens along the power with `shifted`. Speed 0: held against it. */
typedef struct {
    const char *what;
    double coefficient, exponent, left, end, slope, root, shifted, damping_exponent;
    film_start start;
    int linearisation;
    int32_t loading, unloading;
    int status;
} found;

enum { FOUND_LINES = 2000 };

static const found found_cases[] = {
    {"a branch of 1e-13 of the depth", 1, 2, 1.0 - 1e-13, 0, 0, 0, 0, 0, {1, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 3, FILM_BAD_UNLOADING},
    {"a branch so steep that its work is rounding", 10, 1, 0, 1e-3, 10, 0, 1e15, 0, {1000, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 2, 2, FILM_BAD_UNLOADING},
    {"a short branch on a soft target", 0.01, 8, 1.0 - 1e-5, 0, 0, 0, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 1, FILM_EVENT},
    {"out of a stage that begins steeply", 1e-3, 0.5, 0, 0.1, 0, 1, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 3, FILM_EVENT},
    {"out of a stiff root", 1e5, 0.3, 0, 0, 0, 0, 0, 0, {1e-3, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 2, FILM_ENDLESS},
    {"a turn on a root", 1e4, 0.3, 0, 0, 0, 0, 0, 0, {1e-6, 0.1, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 2, FILM_ENDLESS},
    {"a turn on a root, a stage behind", 1e4, 0.3, 0, 1, 10, 0, 0, 0, {1, 10, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 2, FILM_ENDLESS},
    {"an over-damped turn", 1e-4, 1, 0, 0, 0, 0, 0, 4, {1, 0, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 1, 3, FILM_EVENT},
    {"creeping out", 10, 1, 0, 0, 0, 0, 0, 0.1, {1, 10, 0, 0, INFINITY, 0.1}, FILM_CHORD, 1, 1, FILM_ENDLESS},
    {"creeping out of a dashpot", 1, 1.5, 0, 0, 0, 0, 0, 0.1, {10, 0, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 1, 1, FILM_ENDLESS},
    {"pulled out of a dashpot with hardly a spring", 1e-11, 1, 0, 0, 0, 0, 0, 4, {0.746, 0, -1e-12, 0, INFINITY, 1e-6}, FILM_WORK_PRESERVING, 8, 8, FILM_EVENT},
    {"all energy spent where a stage ends", 0.01, 1, 0, 1, 0, 1, 0, 0, {0.1, 0, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 4, FILM_EVENT},
    {"out of a damped root", 136, 0.36, 0, 0, 0, 0, 0, 0.25, {0.09, 1.4, 0, 0, INFINITY, 0.06}, FILM_WORK_PRESERVING, 8, 14, FILM_ENDLESS},
    {"out of a damped root on few lines", 1, 0.3, 0, 0, 0, 0, 0, 0.1, {1, 1, 0, 0, INFINITY, 30}, FILM_WORK_PRESERVING, 1, 7, FILM_ENDLESS},
    {"out of hardly more than a spring, on a soft target", 7.7e9, 1.06, 0, 0, 0, 0, 0, 0, {100, 30, 0, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 16, FILM_ENDLESS},
    {"a dashpot that no force follows for long", 1e-4, 50, 0, 0, 0, 0, 0, 0.5, {1e-4, 1e-3, 0, 0, INFINITY, 30}, FILM_WORK_PRESERVING, 6, 3, FILM_ENDLESS},
    {"pulled out of a dashpot at once", 100, 20, 0, 0, 0, 0, 0, 0.25, {1e-4, 0.1, -0.1, 0, INFINITY, 1}, FILM_WORK_PRESERVING, 3, 1, FILM_EVENT},
    {"a damped turn that no line with the speeds at its ends meets", 1, 1.5, 0, 0, 0, 0, 0, 0.25, {5, 10, 0, 0, INFINITY, 10}, FILM_WORK_PRESERVING, 2, 2, FILM_EVENT},
    {"a damped turn against a small load", 1e-4, 2, 0, 0, 0, 0, 0, 1, {0.01, 0, 1e-10, 0, INFINITY, 0.1}, FILM_WORK_PRESERVING, 5, 7, FILM_EVENT},
    {"a weak spring behind a stiff dashpot", 1e-6, 1, 0, 0, 0, 0, 0, 3.5, {15, 0, 0, 0, INFINITY, 4}, FILM_CHORD, 19, 7, FILM_EVENT},
    {"a balance within one number", 1e4, 2, 1.0 - 1e-9, 0, 0, 0, 0, 0, {1, 20, 1e-6, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 8, FILM_ENDLESS},
    {"a balance within one number, shifted", 1, 1.5, 0, 1, 1.5, 0, 1, 0, {148, 0.995, 3.35e-8, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 29, 58, FILM_ENDLESS},
    {"a large load that hardly lets go", 127, 1, 0, 0, 0, 0, 0, 0, {1e-3, 0, 518, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 27, FILM_EVENT},
    {"a large load from rest", 127, 1, 0, 0, 0, 0, 0, 0, {1e-9, 0, 518, 0, 10, 0}, FILM_WORK_PRESERVING, 1, 27, FILM_OK},
    {"in again from rest, a root on chords", 0.25, 0.5, 0, 0, 0, 0, 0, 0, {1e-3, 1e-5, 0.03, 0, 100, 0}, FILM_CHORD, 5, 2, FILM_OK},
    {"a load at rest", 100, 0.5, 0, 0, 0, 0, 0, 0, {0, 0.1, 100, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 2, 8, FILM_ENDLESS},
    {"a stop next to a turn", 1.54e-9, 1.5, 0, 0, 0, 0, 0, 0, {3.34e-3, 0, 0, 3.34e-12, INFINITY, 0}, FILM_WORK_PRESERVING, 4, 1, FILM_EVENT},
    {"a way of which a thousandth is rounding", 0.77870152124034686, 1, 0.99999999900000003, 0, 0, 0, 0, 0, {1e-3, 4.6113314685938925e-5, 7.2433160947246762, 1.0000000000000002e-12, 9, 0}, FILM_WORK_PRESERVING, 32, 1, FILM_OK},
    {"held shut by a load, swinging without end", 1, 1, 0.2, 0, 0, 0, 0, 0, {0.1, 0, 0.5, 0, INFINITY, 0}, FILM_WORK_PRESERVING, 1, 1, FILM_TOO_MANY},
};

static film_curve found_curve(const found *at) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, at->end > 0.0 ? at->end : INFINITY, power(0.0, 0.0, 0.0, at->coefficient, at->exponent));
    if (at->end > 0.0) {
        double force = at->coefficient * pow(at->end, at->exponent);
        piece = add_stage(&curve, INFINITY, power(at->end, force, at->slope, at->root, 0.5));
    }
    film_stage *stage = &curve.stage[curve.stages - 1];
    if (at->left > 0.0) {
        stage->unloading = FILM_RESIDUAL;
        piece->recovery = power(0.0, 0.0, at->left, 0.0, 1.0);
    }
    if (at->shifted > 0.0) {
        stage->unloading = FILM_SHIFTED;
        piece->recovery = power(0.0, at->shifted, 0.0, 0.0, 1.0);
        piece->exponent = power(0.0, at->exponent, 0.0, 0.0, 1.0);
    }
    if (at->damping_exponent > 0.0) {
        stage->damped = 1;
        piece->damping = power(0.0, 0.0, 0.0, 1.0, at->damping_exponent);
    }
    return curve;
}

/* Every line ends where the next one begins. */
static void check_found_lines(const film_curve *curve, const film_mesh *mesh, film_state s, double time_limit) {
    int32_t line_count, event_count;
    film_summary summary;
    double fastest = 0.0;
    film_record(curve, mesh, &s, time_limit, lines, LINE_ROOM, &line_count, events, EVENT_ROOM, &event_count, &summary);
    for (int32_t i = 0; i < line_count; i++) fastest = fmax(fastest, fabs(lines[i].nu));
    for (int32_t i = 0; mesh->linearisation == FILM_WORK_PRESERVING && i + 1 < line_count; i++) {
        double values[5], tau = lines[i + 1].time - lines[i].time;
        film_evaluate(curve, &lines[i], tau, values);
        HOLD(tau >= 0.0 && isfinite(lines[i + 1].xi));
        if (tau == 0.0) continue; /* rounding that is put right */
        NEAR(values[0], lines[i + 1].xi, fabs(lines[i].xi) + fabs(lines[i + 1].xi), LINES_MEET);
        NEAR(values[3], lines[i + 1].nu, fastest, LINES_MEET);
    }
}

static void check_found(void) {
    for (size_t k = 0; k < sizeof found_cases / sizeof *found_cases; k++) {
        const found *at = &found_cases[k];
        film_curve curve = found_curve(at);
        owned_mesh own = make_mesh(at->linearisation, at->loading, at->unloading);
        film_summary summary;
        film_state s;
        snprintf(where, sizeof where, "%s", at->what);
        HOLD(film_check_curve(&curve) == FILM_OK);
        int status = at->start.nu > 0.0 ? film_marched(&curve, &own.mesh, &at->start, &summary) : at->status;
        HOLD(status == at->status);
        if (at->start.nu > 0.0) stir_summary(status, &summary);
        int ended = at->status == FILM_EVENT;
        if (status >= 0 && at->start.nu > 0.0) HOLD(summary.lines <= FOUND_LINES && isfinite(summary.work) && isfinite(summary.shift));
        if (ended) HOLD(summary.contact_duration > 0.0 && isfinite(summary.contact_duration) && isfinite(summary.maximum_force));
        if (ended) HOLD(isfinite(summary.time_of_maximum_indentation) && summary.work >= -ENERGY * at->start.nu * at->start.nu);
        if (ended) HOLD((at->start.load != 0.0 || fabs(summary.final_velocity) <= at->start.nu) && summary.permanent_indentation >= 0.0);

        HOLD(film_init(&curve, &s, 0.0, at->start.nu, at->start.gamma, at->start.load, at->start.stop_velocity) == FILM_OK);
        HOLD(film_damp(&s, at->start.damping) == FILM_OK);
        check_found_lines(&curve, &own.mesh, s, at->start.time_limit);
        double before = 0.5 * s.nu * s.nu;
        int count = 0;
        for (status = FILM_EVENT; status == FILM_EVENT && s.event != FILM_CONTACT_ENDS && count < 20; count++) {
            status = film_step(&curve, &own.mesh, &s, INFINITY);
            double after = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift);
            HOLD(status < 0 || (isfinite(s.time) && isfinite(s.force)));
            double blurred = ENERGY * (fabs(before) + fabs(s.spent) + fabs(s.load) * s.xi_max);
            int kept = status >= 0 && at->linearisation == FILM_WORK_PRESERVING;
            if (kept) HOLD(after <= before + blurred);
            if (kept && s.gamma == 0.0 && s.damper == 0.0) HOLD(after >= before - blurred);
            HOLD(s.load > 0.0 || s.event != FILM_RELOADING_BEGINS);
            before = after;
        }
        HOLD(count < 20 || at->status == FILM_TOO_MANY || at->status == FILM_OK);
        free(own.memory);
    }
}

/* Out of a branch that is hardly more than a spring, and creeps to 1e-200 of its depth. */
static void check_crept(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 4525.5, 0.0, 1.0));
    curve.stage[0].unloading = FILM_SECANT;
    piece->recovery = power(0.0, 1e-6, 0.0, 0.0, 1.0);
    piece->exponent = power(0.0, 1.0365457105506151, 0.0, 0.0, 1.0);
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 16, 23);
    const film_start start = {1.1288e-3, 18.01549273532007, 0.0, 0.0, INFINITY, 0.0};
    film_summary summary;
    snprintf(where, sizeof where, "creeping out of hardly more than a spring");
    HOLD(film_check_curve(&curve) == FILM_OK);
    HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_ENDLESS && summary.lines <= FOUND_LINES);
    free(own.memory);
}

/* Motions on one line that were left at a wrong time. */
static void check_motions(void) {
    double tau, x, y;
    const motion steep = {9.77e-6, -1.126, -1.022, 0.0165}; /* from rest away from a balance: e^t takes Newton's method a step each */
    const motion back = {-0.15, -0.0224, -0.01, -0.092};      /* and inwards, from the wrong side of it */
    const motion slow = {1.5, 0.0, 0.0, 4.3};                 /* a dashpot alone */
    snprintf(where, sizeof where, "motions on one line");
    HOLD(move_to(&steep, 0.00396, &tau, &y) == REACHED);
    motion_at(&steep, tau, &x, &y);
    NEAR(x, 0.00396, 0.00396, EXACT);
    HOLD(move_to(&back, 14.0, &tau, &y) == TURNS_BEFORE);
    HOLD(turn_time(&slow) == INFINITY);
    const motion rest = {0.0, 0.0, -1.0, 0.0}; /* on a balance that is unstable */
    motion_at(&rest, 1e9, &x, &y);
    HOLD(x == 0.0 && y == 0.0);
    const motion to_rest = {0.1, 0.1 * (1.0 + 1e-15), -1.0, 0.0}; /* on the way to one */
    motion_at(&to_rest, 1e9, &x, &y);
    NEAR(x, 0.1, 0.1, EXACT);
    HOLD(fabs(y) < 1e-15);
    const motion soft = {0.001, 0.0, 5e-317, 0.0}; /* a quarter of a period of 1e158 */
    motion_at(&soft, turn_time(&soft), &x, &y);
    HOLD(isfinite(x) && x > 0.0);
    const motion faint = {1.9e-4, 4.2e-314, 2.2e-305, 5.3e-309}; /* y0 over the force is as large as numbers are */
    NEAR(turn_time(&faint), 0.5 * PI / sqrt(2.2e-305), 1e153, EXACT);
    const motion turned = {1.0, 1.001, -1.0, 0.0}; /* turned before one, behind which there would be energy again */
    HOLD(move_to(&turned, 1.1, &tau, &y) == TURNS_BEFORE);
}

/* Time and its remainder: half of the last digit is not rounded away. */
static void check_clock(const film_mesh *mesh) {
    film_state s;
    snprintf(where, sizeof where, "the clock");
    HOLD(film_init(&curves[HERTZ], &s, -1.0, 0.0, 0.0, 0.0, 0.0) == FILM_OK);
    HOLD(film_step(&curves[HERTZ], mesh, &s, 1.0) == FILM_OK);
    s.time = 1.0 + 0x1p-52;
    s.time_low = -0x1p-53;
    double before = s.time;
    HOLD(film_step(&curves[HERTZ], mesh, &s, 0.0) == FILM_OK && s.time == before);
}

/* A load or a velocity whose powers underflow is none. */
static void check_tiny(const film_mesh *mesh) {
    static const double tiny[] = {5e-324, 1e-310, 1e-200};
    for (int k = 0; k < 3; k++) {
        for (int which = 0; which < CURVES; which++) {
            for (int sign = -1; sign <= 1; sign += 2) {
                film_state s;
                int status = FILM_EVENT, count = 0;
                snprintf(where, sizeof where, "a load of %g, curve %d", sign * tiny[k], which);
                HOLD(film_init(&curves[which], &s, -1e-8, 0.0, 0.5, sign * tiny[k], 0.0) == FILM_OK);
                for (; status == FILM_EVENT && count < 20; count++) status = film_step(&curves[which], mesh, &s, INFINITY);
                HOLD(status == FILM_ENDLESS && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
                HOLD(film_init(&curves[which], &s, 0.0, tiny[k], 0.5, 0.0, 0.0) == FILM_OK);
                for (count = 0, status = FILM_EVENT; status == FILM_EVENT && count < 20; count++) status = film_step(&curves[which], mesh, &s, INFINITY);
                HOLD(status == FILM_ENDLESS && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
            }
        }
    }
}

/* To rest where the force has softened to nothing: next to it, and exactly there. */
static void check_softened(void) {
    static const double root[] = {213.21163284237079, -213.21163284237079}, mean[] = {213.21163284237079 / 3.0, -213.21163284237079 / 3.0};
    film_curve curve;
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 8, 3);
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, 236.67, series(FILM_ROOT_SERIES, 0.0, 236.67, 2, root));
    piece->mean = series(FILM_ROOT_SERIES, 0.0, 236.67, 2, mean);
    curve.stage[0].unloading = FILM_SECANT;
    piece->recovery = power(0.0, 1.1547845254488045e-05, 0.0, 0.0, 0.5);
    piece->exponent = power(0.0, 0.3, 0.0, 0.0, 1.0);
    double force, work;
    film_law(&curve, 0, 236.67, &force, &work);
    for (int k = 3; k < 16; k++) {
        snprintf(where, sizeof where, "to rest 1e-%d before the force is none", k);
        HOLD(film_init(&curve, &s, 0.0, sqrt(2.0 * work * (1.0 - pow(10.0, -k))), 0.0, 0.0, 0.0) == FILM_OK);
        check_found_lines(&curve, &own.mesh, s, 1e12);
        double before = 0.5 * s.nu * s.nu;
        int status = FILM_EVENT;
        for (int i = 0; status == FILM_EVENT && i < 20; i++) {
            status = film_step(&curve, &own.mesh, &s, 1e11);
            HOLD(isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
            if (status >= 0) NEAR(0.5 * s.nu * s.nu + s.spent, before, before, 1e-10);
        }
    }
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.0, power(0.0, 1.0, -1.0, 0.0, 1.0));
    HOLD(film_init(&curve, &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK);
    int status = FILM_EVENT;
    for (int i = 0; status == FILM_EVENT && i < 20; i++) {
        status = film_step(&curve, &own.mesh, &s, 1e9);
        HOLD(isfinite(s.xi) && isfinite(s.nu) && isfinite(s.time));
    }
    NEAR(s.xi_max, 1.0, 1.0, 1e-7);
    NEAR(s.nu, -1.0, 1.0, EXACT);
    free(own.memory);
}

/* Pushed in again where rounding has left it beyond the end of its branch. */
static void check_beyond(const film_mesh *mesh) {
    film_state s;
    snprintf(where, sizeof where, "in again from beyond the end of a branch");
    HOLD(film_init(&curves[LAMINATE], &s, 0.0, 1.0, 0.1, 0.0, 0.0) == FILM_OK);
    step_to(&curves[LAMINATE], mesh, &s, FILM_MAXIMUM_INDENTATION);
    s.xi = nextafter(s.xi_free, 0.0);
    s.elastic = s.work = 0.0;
    HOLD(film_input(&s, 0.0, 1e-9 - s.nu, 0.0) == FILM_OK);
    HOLD(film_step(&curves[LAMINATE], mesh, &s, 1e-6) == FILM_EVENT && s.event == FILM_RELOADING_BEGINS);
    HOLD(film_step(&curves[LAMINATE], mesh, &s, 1e-6) >= FILM_OK && isfinite(s.spent) && isfinite(s.nu) && s.loop != 0);
}

/* Creeping out to where two stages meet in forces of rounding, one above the other: out, and not in and out without end. */
static void check_kink(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 25.0, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(0.0, -2.5 + 4.44e-16, 0.1, 0.0, 1.0));
    snprintf(where, sizeof where, "out over stages that meet in rounding");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 2);
        for (int i = 0; i < 40; i++) {
            film_summary summary;
            film_start start = {over_decades(1e-4, 1.0), over_decades(10.0, 30.0), 0.0, 0.0, INFINITY, 0.0};
            int status = film_marched(&curve, &own.mesh, &start, &summary);
            HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && summary.lines <= FOUND_LINES);

            film_state s; /* an integrator's, between the two velocities at which the one and the other turns it */
            HOLD(film_init(&curve, &s, 0.0, 30.0, start.gamma, 0.0, 0.0) == FILM_OK);
            step_to(&curve, &own.mesh, &s, FILM_MAXIMUM_INDENTATION);
            HOLD(film_force(&curve, &s, 25.0, 0.0).force > 3e-16);
            int count = 0;
            s.nu = start.gamma * 3e-16;
            do s.xi = 25.0;
            while (film_switch(&curve, &s) == FILM_EVENT && ++count < 20);
            HOLD(count < 20);
        }
        free(own.memory);
    }
}

/* Where a branch meets the loading curve, in two forces of which one may turn it inwards and the other outwards. */
static void check_branching(const film_mesh *mesh) {
    snprintf(where, sizeof where, "where a branch meets the loading curve");
    for (int which = 0; which < BATCH_CURVES; which++) {
        for (int i = 0; which != DAMPED && i < 40; i++) {
            film_state s;
            double gamma = over_decades(1e-2, 30.0);
            HOLD(film_init(&curves[which], &s, 0.0, over_decades(0.5, 30.0), gamma, 0.0, 0.0) == FILM_OK);
            int status = FILM_EVENT;
            for (int k = 0; status == FILM_EVENT && s.event != FILM_MAXIMUM_INDENTATION; k++) {
                HOLD(k < EVENTS_MOST);
                status = film_step(&curves[which], mesh, &s, INFINITY);
            }
            if (status != FILM_EVENT) continue; /* beyond the law */
            double xi = s.xi, nu = gamma * s.elastic;
            for (int ulps = -3; ulps <= 3; ulps++) {
                int count = 0;
                s.nu = nu * (1.0 + 1.1e-16 * ulps);
                do s.xi = xi;
                while (film_switch(&curves[which], &s) == FILM_EVENT && ++count < 20);
                HOLD(count < 20);
            }
        }
    }
}

/* A turn so soon after a stage has begun that its way is none beside the depth: the force of the stage, were it to go on
 * above where it begins, would fall to 0 there, but it is the force of the one before that serves. */
static void check_beside(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 40.0, power(0.0, 0.0, 1e-6, 0.0, 1.0));
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 4e-5 - 4e5, 1e4, 0.0, 1.0));
    curve.stage[1].unloading = FILM_RESIDUAL;
    piece->recovery = power(0.0, 0.0, 0.5, 0.0, 1.0);
    piece->exponent = power(0.0, 1.5, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "a turn next to the beginning of a stage");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 8);
        for (int k = 0; k < 2; k++) {
            film_summary summary;
            film_start start = {sqrt(2.0 * (8e-4 + 1e-6)), k ? 1e-3 : 0.0, 0.0, 0.0, INFINITY, 0.0};
            HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
            NEAR(summary.maximum_indentation, 40.0, 40.0, 1e-6);
            HOLD(summary.permanent_indentation == 0.5 * summary.maximum_indentation && summary.final_velocity < 0.0);
        }
        free(own.memory);
    }
}

/* Thrown by a load into swings over where a far steeper stage begins: the target pushes, however short the way. */
static void check_swings(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 40.0, power(0.0, 0.0, 1e-6, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(40.0, 4e-5, 1e4, 0.0, 1.0));
    snprintf(where, sizeof where, "swings over where a stage begins");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 8, 8);
        for (int k = 0; k < 4; k++) {
            film_state s;
            double gamma = k % 2 ? 1e-6 : 0.0, short_of = k / 2 ? 1e-8 : 1e-10;
            HOLD(film_init(&curve, &s, 0.0, 1e-3 * (40.0 - short_of), gamma, 0.0, 0.0) == FILM_OK);
            step_to(&curve, &own.mesh, &s, FILM_MAXIMUM_INDENTATION);
            HOLD(film_input(&s, 6e-5, 0.0, 0.0) == FILM_OK);
            double begin = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift), most = 0.0;
            for (int i = 0; i < 2000; i++) {
                int status = film_step(&curve, &own.mesh, &s, 1e-3);
                HOLD((status == FILM_OK || status == FILM_EVENT) && s.force >= 0.0);
                most = fmax(most, s.force);
                double now = 0.5 * s.nu * s.nu + s.spent - s.load * (s.xi + s.shift);
                HOLD(now <= begin + 1e-10 * (0.5 * s.nu * s.nu + 6e-5 * 40.0));
            }
            HOLD(most > 8e-5); /* it has been in the steeper one */
        }
        free(own.memory);
    }
}

/* Held by a faint load, out to where a stage begins with a root: from the last number above it the force is large, and at it
 * none; the motion creeps or goes on, but does not stay for lines without end. */
static void check_root(void) {
    film_curve curve;
    double edge = nextafter(0.1, 1.0); /* odd in its last digit: halfway to the next number rounds to that */
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, edge, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(edge, 1e-18, 0.0, 1e5, 0.3));
    snprintf(where, sizeof where, "out to where a root begins");
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        for (int32_t nodes = 1; nodes <= 3; nodes++) {
            owned_mesh own = make_mesh(linearisation, nodes, nodes);
            for (int i = 0; i < 20; i++) {
                film_state s;
                double gamma = over_decades(1e-8, 1e-4), nu = over_decades(1e-6, 1e-3);
                HOLD(film_init(&curve, &s, 0.0, nu, gamma, 1e-23, 0.0) == FILM_OK);
                for (int n = 0, status = FILM_EVENT; n < 40 && status == FILM_EVENT; n++) {
                    int32_t drawn = s.lines;
                    status = film_step(&curve, &own.mesh, &s, INFINITY);
                    HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && s.lines - drawn <= FOUND_LINES);
                }
            }
            free(own.memory);
        }
    }
}

/* A turn within rounding of where a stage begins, of which the work is known to less than the way back does: without a load
 * nothing turns the impactor again. */
static void check_out(void) {
    film_curve curve;
    double edge = 0.10225308097531023, slope = 1.0243235815473825e-17, x = edge - 0.004;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, edge, power(0.0, 0.0, slope, 0.0, 1.0));
    add_stage(&curve, INFINITY, power(0.004, slope * edge - 8.7e-4 * pow(x, 1.5), 0.0, 8.7e-4, 1.5));
    curve.piece[1].work_at_begin = x * (curve.piece[1].force.constant + 8.7e-4 * pow(x, 1.5) / 2.5);
    snprintf(where, sizeof where, "out from a turn in rounding");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 1, 17);
        for (int i = -100; i < 100; i++) {
            film_start start = {sqrt(slope) * edge * (1.0 + 2.3e-16 * i), 0.0, 0.0, 0.0, INFINITY, 0.0};
            film_summary summary;
            HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_EVENT && summary.lines <= FOUND_LINES);
        }
        free(own.memory);
    }
}

/* A force that is nothing for the most of the way, up to an end far beyond the turn: aimed at from chords of hardly any slope. */
static void check_faint(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 30.0, power(0.0, 0.0, 0.0, 4.8e-71, 50.0));
    snprintf(where, sizeof where, "hardly any force for the most of the way");
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh own = make_mesh(linearisation, 6, 8);
        for (int i = 0; i < 20; i++) {
            film_start start = {over_decades(1e-4, 1e-2), over_decades(1e-4, 1e-2), 0.0, 0.0, INFINITY, 0.0};
            film_summary summary;
            HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
            double depth = pow(51.0 * 0.5 * start.nu * start.nu / 4.8e-71, 1.0 / 51.0);
            NEAR(summary.maximum_indentation, depth, depth, 0.05); /* a chord of six does too much work */
            HOLD(isfinite(summary.shift) && summary.final_velocity < 0.0);
        }
        free(own.memory);
    }
}

/* One stage of coefficient x^exponent, with a damping of constant + x^0.25. */
static film_curve dashpot(double end, double coefficient, double exponent, double constant) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, end, power(0.0, 0.0, 0.0, coefficient, exponent));
    curve.stage[0].damped = 1;
    piece->damping = power(0.0, constant, 0.0, 1.0, 0.25);
    HOLD(film_check_curve(&curve) == FILM_OK);
    return curve;
}

/* Pulled out of a dashpot, slowly, on lines too long for it: none ends with a force that is not the law's. */
static void check_drawn_out(void) {
    snprintf(where, sizeof where, "pulled out of a dashpot, slowly");
    film_curve curve = dashpot(INFINITY, 1e5, 1.5, 0.0);
    for (int i = 0; i < 3000; i++) {
        owned_mesh own = random_mesh(8);
        film_summary summary;
        film_start start = {over_decades(300.0, 3000.0), over_decades(10.0, 100.0), -over_decades(1e-5, 1e-3), 0.0, INFINITY, over_decades(10.0, 100.0)};
        int status = film_marched(&curve, &own.mesh, &start, &summary);
        HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && summary.lines <= FOUND_LINES);
        HOLD(isfinite(summary.work) && summary.maximum_force <= start.nu);
        free(own.memory);
    }
}

/* A pull a billion times the contact force stops the impactor at once: the target has moved as far as its momentum says. */
static void check_pulled(void) {
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 3, 3);
    snprintf(where, sizeof where, "a pull a billion times the contact force");
    for (int i = 0; i < 40; i++) {
        double gamma = over_decades(1.0, 10.0), nu = over_decades(1.0, 100.0);
        HOLD(film_init(&curves[LINEAR], &s, 0.0, nu, gamma, 0.0, 0.0) == FILM_OK);
        step_to(&curves[LINEAR], &own.mesh, &s, FILM_MAXIMUM_INDENTATION);
        HOLD(film_input(&s, -1e9 * s.force, 0.0, 0.0) == FILM_OK);
        film_state before = s;
        HOLD(film_step(&curves[LINEAR], &own.mesh, &s, INFINITY) == FILM_EVENT && s.event == FILM_IMPACTOR_STOPS);
        double way = s.xi + s.shift - before.xi - before.shift; /* under one force */
        NEAR(way, 0.5 * before.nu * before.nu / (1e9 * before.force), before.gamma * before.nu + 1e6 * way, 1e-14);
    }
    free(own.memory);
}

/* Stopped on a way that is rounding of the indentation: the line has a slope as the law's, and may be asked a little late. */
static void check_no_way(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 1e-17, 0.0, 1.0));
    curve.stage[0].unloading = FILM_RESIDUAL;
    piece->recovery = power(0.0, 0.0, 0.165, 0.0, 1.0);
    piece->exponent = power(0.0, 0.515, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "a stop on a way that is rounding");
    HOLD(film_check_curve(&curve) == FILM_OK);
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 3, 3);
    for (int i = 0; i < 40; i++) {
        film_state s;
        double values[5];
        double gamma = over_decades(1e-6, 1e-4), nu = over_decades(1e-14, 1e-12);
        HOLD(film_init(&curve, &s, 0.0, nu, gamma, -1e-3, 0.0) == FILM_OK);
        step_to(&curve, &own.mesh, &s, FILM_IMPACTOR_STOPS);
        HOLD(fabs(s.line.kappa) < 1e-3);
        film_evaluate(&curve, &s.line, 1e-15 * s.time, values);
        for (int j = 0; j < 5; j++) HOLD(isfinite(values[j]));
    }
    free(own.memory);
}

/* Pulled out of a dashpot next to which the spring is nothing: at rest it holds, and the least motion outwards lets go. */
static void check_lets_go(void) {
    snprintf(where, sizeof where, "pulled out of a dashpot next to which the spring is nothing");
    film_curve curve = dashpot(30.0, 4.8e-71, 50.0, 0.0);
    for (int i = 0; i < 300; i++) {
        owned_mesh own = random_mesh(8);
        film_state s;
        double load = -over_decades(1e-3, 1e-1), gamma = over_decades(1e-3, 1e-1), nu = over_decades(1e-4, 1e-2);
        HOLD(film_init(&curve, &s, 0.0, nu, gamma, load, 0.0) == FILM_OK);
        HOLD(film_damp(&s, over_decades(1e-2, 1.0)) == FILM_OK);
        for (int count = 0; s.event != FILM_CONTACT_ENDS && count < 20; count++) {
            HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT);
            HOLD(isfinite(s.time) && isfinite(s.xi) && isfinite(s.nu) && isfinite(s.shift) && isfinite(s.spent));
        }
        HOLD(s.event == FILM_CONTACT_ENDS);
        free(own.memory);
    }
}

/* Stopped by a dashpot alone, where the spring's force is so small that its square is none. */
static void check_no_spring(void) {
    snprintf(where, sizeof where, "stopped by a dashpot next to which the spring is nothing");
    film_curve curve = dashpot(1000.0, 1.9e-146, 49.0, 1.0);
    for (int i = 0; i < 40; i++) {
        owned_mesh own = random_mesh(8);
        film_state s;
        int status = FILM_OK;
        double gamma = over_decades(1.0, 30.0), nu = over_decades(1e-3, 1e-1);
        HOLD(film_init(&curve, &s, 0.0, nu, gamma, 0.0, 0.0) == FILM_OK);
        HOLD(film_damp(&s, over_decades(10.0, 30.0)) == FILM_OK);
        for (int count = 0; status >= 0 && status != FILM_ENDLESS && count < 20; count++) {
            status = film_step(&curve, &own.mesh, &s, 30.0);
            HOLD(status >= 0 && s.lines <= FOUND_LINES && isfinite(s.xi) && isfinite(s.nu));
            HOLD(film_input(&s, count % 2 ? 0.0 : 1e-9, 0.0, 0.0) == FILM_OK); /* aimed afresh */
        }
        free(own.memory);
    }
}

/* A coefficient as large as numbers are, of a power that is as small. */
static void check_huge(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1e-6, power(0.0, 0.0, 0.0, 1e308, 50.0));
    film_state s;
    snprintf(where, sizeof where, "a coefficient of 1e308");
    HOLD(film_check_curve(&curve) == FILM_OK);
    HOLD(film_init(&curve, &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK && film_switch(&curve, &s) == FILM_EVENT);
    film_contact small = film_force(&curve, &s, 1e-9, 1.0), large = film_force(&curve, &s, 9e-7, 1.0);
    HOLD(small.force == 0.0 && small.by_xi == 0.0);
    NEAR(large.by_xi, 50.0 * large.force / 9e-7, large.by_xi, EXACT);
}

/* A branch that ends where the law began, as a shifted branch along the loading curve does: rounding may put its end below
 * the surface. */
static void check_surface(void) {
    snprintf(where, sizeof where, "a shifted branch that ends at the surface");
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 5, 5);
    for (int i = 0; i < 100; i++) {
        film_curve curve;
        double exponent = uniform(1.0, 2.0), coefficient = over_decades(0.1, 10.0);
        memset(&curve, 0, sizeof curve);
        film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 0.0, coefficient, exponent));
        curve.stage[0].unloading = FILM_SHIFTED;
        piece->recovery = power(0.0, coefficient * (1.0 - 1e-15), 0.0, 0.0, 1.0);
        piece->exponent = power(0.0, exponent, 0.0, 0.0, 1.0);
        film_start start = {over_decades(1e-2, 10.0), 0.0, 0.0, 0.0, INFINITY, 0.0};
        film_summary summary;
        HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
        NEAR(summary.permanent_indentation, 0.0, summary.maximum_indentation, 1e-6);
        NEAR(summary.final_velocity, -start.nu, start.nu, 1e-10);
    }
    free(own.memory);
}

/* Creeping out along a branch that reloads along another curve: without a load nothing pushes it in again, and loops over
 * ways of rounding would. */
static void check_small_loop(void) {
    film_curve curve;
    film_state s;
    owned_mesh own = make_mesh(FILM_CHORD, 13, 5);
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 1.0, 0.21280823231451274, 1.2814706862038445));
    curve.stage[0].unloading = FILM_SHIFTED;
    curve.stage[0].reload_exponent = 0.84720209072113484;
    piece->recovery = power(0.0, 98571402.462328449, 0.0, 0.0, 1.0);
    piece->exponent = power(0.0, 2.475043098429099, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "small loops without a load");
    HOLD(film_init(&curve, &s, 0.0, 0.0013164725680577768, 2.2810419566277993, 0.0, 0.0) == FILM_OK);
    for (int status = FILM_EVENT; status == FILM_EVENT;) {
        status = film_step(&curve, &own.mesh, &s, INFINITY);
        HOLD(status >= FILM_OK && s.event != FILM_RELOADING_BEGINS && s.lines <= 200);
    }
    free(own.memory);
}

/* Held by a faint load in a dent that leaves almost no recovery: it comes to rest where adjacent floats are all there is. */
static void check_rest(void) {
    film_curve curve;
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 15, 12);
    memset(&curve, 0, sizeof curve);
    film_piece *piece = add_stage(&curve, INFINITY, power(0.0, 0.0, 0.0, 1.0646741943125229, 1.6658583884167495));
    curve.stage[0].unloading = FILM_RESIDUAL;
    piece->recovery = power(0.0, 0.0, 0.99999998028130377, 0.0, 1.0);
    piece->exponent = power(0.0, 2.0345909873729227, 0.0, 0.0, 1.0);
    snprintf(where, sizeof where, "to rest between adjacent floats");
    HOLD(film_init(&curve, &s, 0.0, 0.26843351861354958, 0.0032161185081785895, 1.0951036121660659e-08, 0.0) == FILM_OK);
    for (int status = FILM_EVENT; status == FILM_EVENT;) {
        status = film_step(&curve, &own.mesh, &s, INFINITY);
        HOLD((status == FILM_EVENT || status == FILM_ENDLESS) && s.lines <= FOUND_LINES);
    }
    HOLD(s.phase == FILM_RESTING);
    free(own.memory);
}

/* A turn so soon after a far steeper stage has begun that its way is rounding: energy gives the time that the march does. */
static void check_short_leg(void) {
    snprintf(where, sizeof where, "a turn within rounding of where a stage begins");
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 8, 8);
    for (int i = 0; i < 100; i++) {
        film_curve curve;
        double slope = over_decades(1e10, 1e18);
        memset(&curve, 0, sizeof curve);
        add_stage(&curve, 40.0, power(0.0, 0.0, 1e-6, 0.0, 1.0));
        film_piece *piece = add_stage(&curve, INFINITY, power(40.0, 4e-5, slope, 0.0, 1.0));
        curve.stage[1].unloading = FILM_SECANT;
        piece->recovery = power(0.0, 1e-3, 0.0, 0.0, 1.0);
        piece->exponent = power(0.0, 1.0, 0.0, 0.0, 1.0);
        film_start start = {sqrt(2.0 * (8e-4 + 1e-6)), 0.0, 0.0, 0.0, INFINITY, 0.0};
        film_summary summary;
        HOLD(film_marched(&curve, &own.mesh, &start, &summary) == FILM_EVENT);
        double v = sqrt(2e-6), before = asin(sqrt(8e-4 / 8.01e-4)) / 1e-3; /* of the stage before, a spring of 1e-6 */
        NEAR(summary.time_of_maximum_indentation, before + 0.5 * PI / sqrt(slope), before, 1e-3 * v);
    }
    free(own.memory);
}

/* In series with a spring, a series goes on a little beyond the end of its stage: an integrator's step may. */
static void check_overrun(void) {
    static const double root_force[] = {0.3125, 0.46875, 0.1875, 0.03125}, root_mean[] = {0.125, 0.1875, 0.075, 0.0125};
    film_curve curve;
    film_state s;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, 1.3, series(FILM_ROOT_SERIES, 0.0, 1.0, 4, root_force))->mean = series(FILM_ROOT_SERIES, 0.0, 1.0, 4, root_mean);
    curve.compliance = 0.3; /* x^1.5 up to 1 */
    snprintf(where, sizeof where, "beyond the end of a stage in series with a spring");
    HOLD(film_check_curve(&curve) == FILM_OK);
    HOLD(film_init(&curve, &s, 0.0, 1.0, 0.0, 0.0, 0.0) == FILM_OK && film_switch(&curve, &s) == FILM_EVENT);
    double before = film_force(&curve, &s, 1.3, 1.0).force, after = film_force(&curve, &s, 1.31, 1.0).force;
    NEAR(before, 1.0, 1.0, EXACT);
    NEAR(after - before, 0.01 * 1.5 / 1.45, 0.01, 0.02);
}

/* A law that pulls and yields: parting, pulling, pushing, plastic; a contact that turns beyond 2 leads back along the first
 * three, stretched. Its force at the turn is `top`, f0(x) of the third stage at x = 1 + y: 0.8 y + 0.2 y^1.5. */
static film_curve stretched_curve(void) {
    film_curve curve;
    memset(&curve, 0, sizeof curve);
    add_stage(&curve, -0.25, power(-1.0, -0.4, -0.8, 0.0, 1.0));
    curve.stage[0].begin = -1.0;
    add_stage(&curve, 1.0, power(-0.25, -1.0, 0.8, 0.0, 1.0));
    add_stage(&curve, 2.0, power(1.0, 0.0, 0.8, 0.2, 1.5))->end = 100.0;
    film_piece *piece = add_stage(&curve, INFINITY, power(2.0, 1.0, 0.9, 0.0, 1.0));
    curve.stage[3].unloading = FILM_SIMILAR;
    piece->recovery = power(2.0, 3.2, 1.9, 0.0, 1.0);
    piece->exponent = power(2.0, 1.0, 0.0, 0.0, 1.0);
    curve.pull = 1.0;
    return curve;
}

/* Work of the reversible stages from their beginning to x > 1. */
static double stretched_work(double x) {
    return -0.75 * 0.7 - 1.25 * 0.5 + 0.4 * (x - 1.0) * (x - 1.0) + 0.08 * pow(x - 1.0, 2.5);
}

/* A contact that yields and sticks: on a fixed target its energy in closed form, in steps the same motion, and the next
 * contact on the same spot begins on the branch and yields further. A ball too slow to part swings, and a pull parts it. */
static void check_stretched(void) {
    film_curve curve = stretched_curve();
    HOLD(film_check_curve(&curve) == FILM_OK);
    for (int i = 0; i < 300; i++) {
        film_state s, cut;
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, whole(3, 24), whole(6, 24));
        double nu = over_decades(2.8, 12.0), gamma = i % 2 == 0 ? 0.0 : over_decades(1e-3, 0.03);
        snprintf(where, sizeof where, "stretched stages, nu %.17g, gamma %.17g, mesh %d %d", nu, gamma, (int)own.mesh.loading, (int)own.mesh.unloading);
        HOLD(film_init(&curve, &s, 0.0, nu, gamma, 0.0, 0.0) == FILM_OK);
        cut = s;
        int32_t changes = 0, out = 0, count = 0;
        while (film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT && s.event != FILM_CONTACT_ENDS) {
            HOLD(++count < EVENTS_MOST);
            changes += s.event == FILM_STAGE_CHANGES;
            out += s.event == FILM_STAGE_CHANGES && s.branch <= FILM_STRETCHED;
            HOLD(s.force >= -film_pull(&curve, &s) * (1.0 + EXACT));
        }
        HOLD(s.event == FILM_CONTACT_ENDS && changes == 4 && out == 2 && s.stage_max == 3);
        double c = pow(3.2 + 1.9 * (s.xi_max - 2.0), 0.75), r = fmax(c * c / (s.f_max + 2.0 * c), 1.0), l = cbrt(r), x = (s.xi_max - s.xi_free) / l, dent;
        NEAR(s.xi, s.xi_free - l, s.xi_max, EXACT);
        NEAR(r * (0.8 * (x - 1.0) + 0.2 * pow(x - 1.0, 1.5)), s.f_max, s.f_max, EXACT);
        film_dents(&curve, 1, 0, NULL, NULL, &s.xi_max, &s.xi, &dent);
        NEAR(dent, s.xi_free, s.xi_max, EXACT);
        double in = stretched_work(2.0) + 0.75 * 0.7 + 0.25 * 0.9 + (s.xi_max - 2.0) * (1.0 + 0.45 * (s.xi_max - 2.0));
        NEAR(s.spent, in - r * l * stretched_work(x), in, ENERGY);
        if (gamma == 0.0) NEAR(0.5 * s.nu * s.nu, 0.5 * nu * nu - s.spent, in, ENERGY);
        double step = s.time / 37.3;
        for (int k = 0; k < 100000 && cut.phase != FILM_SEPARATED; k++) film_step(&curve, &own.mesh, &cut, step);
        NEAR(cut.nu - s.nu, 0.0, nu, STEPS);
        NEAR(cut.xi_free, s.xi_free, s.xi_max, STEPS);
        /* back with more than before */
        double deep = s.xi_max, left = s.xi_free;
        HOLD(film_input(&s, 0.0, 1.3 * nu - s.nu, 0.0) == FILM_OK);
        HOLD(film_step(&curve, &own.mesh, &s, INFINITY) == FILM_EVENT && s.event == FILM_CONTACT_BEGINS);
        HOLD(s.branch == FILM_STRETCHED - 1 && s.phase == FILM_RELOADING && s.xi == left);
        NEAR(s.force, r * (0.8 * 0.25 - 1.0), r, EXACT);
        step_to(&curve, &own.mesh, &s, FILM_MAXIMUM_INDENTATION);
        HOLD(s.xi_max > deep && s.xi_free > left && s.branch == FILM_STRETCHED - 2);
        free(own.memory);
    }
    /* comes to rest where two stages meet, of the force 0: without is_still it goes back and forth for ever */
    film_curve slow = curve;
    slow.piece[1].force = power(-0.25, -1.0, 2.4387461565717476, 0.0, 1.0);
    slow.piece[2].force = power(1.0, 0.0, 2.4387461565717476, 0.03, 2.5);
    slow.stage[1].end = slow.stage[2].begin = slow.piece[1].end = slow.piece[2].force.origin = -0.25 + 1.0 / 2.4387461565717476;
    for (int i = 0; i < 2000; i++) {
        owned_mesh own = make_mesh(FILM_WORK_PRESERVING, whole(1, 12), whole(1, 12));
        film_start start = {over_decades(0.1, 3.0), over_decades(0.1, 3.0), 0.0, 0.0, 60.0, 0.0};
        film_summary summary;
        snprintf(where, sizeof where, "slow and sticky, nu %.17g, gamma %.17g, mesh %d %d", start.nu, start.gamma, (int)own.mesh.loading, (int)own.mesh.unloading);
        int status = film_marched(&slow, &own.mesh, &start, &summary);
        HOLD(status == FILM_OK || status == FILM_EVENT || status == FILM_ENDLESS);
        free(own.memory);
    }
    /* too slow: it sticks, and swings about where the force is 0; a pull beyond the largest tension parts it */
    film_state s;
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 12, 12);
    snprintf(where, sizeof where, "a ball that sticks in its dent");
    HOLD(film_init(&curve, &s, 0.0, 2.2, 0.2, 0.0, 0.0) == FILM_OK);
    step_to(&curve, &own.mesh, &s, FILM_MAXIMUM_INDENTATION);
    HOLD(s.stage_max == 3);
    for (int k = 0; k < 4000; k++) film_step(&curve, &own.mesh, &s, 1.0);
    HOLD(s.phase != FILM_SEPARATED && s.contacts == 1);
    NEAR(s.force, 0.0, s.f_max, 1e-9);
    NEAR(s.xi, s.xi_free + s.exponent, s.xi_max, 1e-9);
    double most = film_pull(&curve, &s);
    HOLD(film_input(&s, -0.5 * most, 0.0, 0.0) == FILM_OK);
    for (int k = 0; k < 4000; k++) film_step(&curve, &own.mesh, &s, 1.0);
    HOLD(s.phase != FILM_SEPARATED);
    NEAR(s.force, -0.5 * most, most, 1e-9);
    HOLD(film_input(&s, -1.01 * most, 0.0, 0.0) == FILM_OK);
    for (int k = 0; k < 4000 && s.phase != FILM_SEPARATED; k++) film_step(&curve, &own.mesh, &s, 1.0);
    HOLD(s.phase == FILM_SEPARATED);
    free(own.memory);
}

/* Curves of which a law that pulls must not be made. */
static void check_bad_stretched(void) {
    film_curve good = stretched_curve(), bad;
    snprintf(where, sizeof where, "stretched stages that are wrong");
    bad = good, bad.pull = 0.0;
    HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);
    bad = good, bad.stage[2].unloading = FILM_SECANT;
    HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);
    bad = good, bad.stage[0].unloading = FILM_SIMILAR;
    HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);
    bad = good, bad.stage[3].reload_exponent = 1.0;
    HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);
    bad = good, bad.piece[1].end = 1.1; /* only the last reversible stage goes on */
    HOLD(film_check_curve(&bad) == FILM_BAD_CURVE);
    bad = good, bad.piece[3].recovery = power(2.0, -1.0, 0.0, 0.0, 1.0);
    owned_mesh own = make_mesh(FILM_WORK_PRESERVING, 6, 6);
    film_start start = {5.0, 0.0, 0.0, 0.0, INFINITY, 0.0};
    film_summary summary;
    HOLD(film_marched(&bad, &own.mesh, &start, &summary) == FILM_BAD_UNLOADING);
    bad = good, bad.piece[2].end = 2.1; /* too short for the branch */
    HOLD(film_marched(&bad, &own.mesh, &start, &summary) == FILM_BAD_UNLOADING);
    free(own.memory);
}

#endif
