/* The core alone, without Python: thousands of pseudo-random impacts, what must hold in each of them, and one hash over
 * all results, which must not depend on how the compiler optimises. Builds with nothing but the core's sources:
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/core_check.c $(find film_model/core -name 'film_*.c') -lm
 *
 * Prints one line with counts and the hash, which is to be that of core_check_result.txt; exits with 1 after saying what
 * does not hold. */
#include "core_check_answers.h"
#include "core_check_cases.h"

int main(void) {
    lines = room_for(LINE_ROOM, sizeof *lines);
    events = room_for(EVENT_ROOM, sizeof *events);
    curves[HERTZ] = hertz_curve();
    curves[ELASTOPLASTIC] = elastoplastic_curve();
    curves[SERIES] = series_curve();
    curves[LINEAR] = linear_curve();
    curves[CLEARANCE] = clearance_curve();
    curves[DENTED] = dented_curve();
    curves[VARIED] = varied_curve();
    curves[SOFTENING] = softening_curve();
    curves[LAMINATE] = laminate_curve();
    curves[SHIFTED] = shifted_curve();
    curves[DAMPED] = damped_curve();
    curves[SPRUNG] = sprung(curves[ELASTOPLASTIC]);
    curves[SPRUNG_LAMINATE] = sprung(curves[LAMINATE]);
    curves[SPRUNG_SHIFTED] = sprung(curves[SHIFTED]);
    check_bad_curves();
    check_bad_springs();
    check_bad_meshes();
    check_small_loop();
    check_rest();
    check_overrun();
    check_hertz();
    check_found();
    check_crept();
    check_huge();
    check_softened();
    check_kink();
    check_beside();
    check_swings();
    check_root();
    check_out();
    check_faint();
    check_pulled();
    check_no_way();
    check_lets_go();
    check_no_spring();
    check_drawn_out();
    check_motions();
    for (int linearisation = FILM_CHORD; linearisation <= FILM_WORK_PRESERVING; linearisation++) {
        owned_mesh few = make_mesh(linearisation, 3, 5), fine = make_mesh(linearisation, 40, 80);
        check_bad_numbers(&few.mesh);
        check_endless(&few.mesh);
        check_clock(&few.mesh);
        check_tiny(&few.mesh);
        check_beyond(&few.mesh);
        check_branching(&few.mesh);
        check_linear_law(&few.mesh);
        if (linearisation == FILM_WORK_PRESERVING) check_series(&fine.mesh);
        for (int which = 0; which < BATCH_CURVES; which++) {
            check_batch(which, &few.mesh, 1e-5, 0.5);
            check_batch(which, &fine.mesh, 1e-12, 1e-4);
        }
        free(few.memory);
        free(fine.memory);
    }
    for (int i = 0; i < RANDOM_IMPACTS || i < RANDOM_SCHEDULES; i++) {
        int32_t unloading = whole(1, SEGMENTS_MOST), loading = whole(1, SEGMENTS_MOST);
        owned_mesh own = make_mesh(whole(0, 3) ? FILM_WORK_PRESERVING : FILM_CHORD, loading, unloading);
        int which = whole(0, CURVES - 1);
        film_start start = random_start(which);
        if (i < RANDOM_IMPACTS) one_contact(which, &own.mesh, &start);
        if (i < RANDOM_SCHEDULES) one_schedule(which, &own.mesh);
        free(own.memory);
    }
    check_surface(); /* draws random numbers: after those of the hash */
    check_short_leg();
    check_bad_stretched();
    check_stretched();
    free(lines);
    free(events);
    printf("core_check: %ld checks, %ld contacts, %ld events, hash %016llx\n", checks, contacts, events_seen,
           (unsigned long long)hash);
    return 0;
}
