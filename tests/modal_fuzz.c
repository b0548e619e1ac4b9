/* The contact on modes under inputs chosen to break it: random structures, curves, starts, steps and loads. Of each it is asked
 * that the outcome is one that film_core.h names, that no number is NaN, that no step draws on without end, that energy is
 * kept where the law is reversible, that a saved state runs on to the same bits, and that all instruction sets give the same.
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/modal_fuzz.c $(find film_model/core -name 'film_*.c') -lm -o modal_fuzz
 *     ./modal_fuzz 2000
 */
#include "plate/film_plate.h"
#include "modal/film_modal_parts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUZZ "modal_fuzz.c"
#include "fuzz_numbers.h"

enum { MODES = 40, WAVES = 48 * MODES, TABLED = 400, LEVELS = 40, CALLS = 60, EVENTS = 4000 };

static const double BALANCE = 1e-6; /* of the impact energy: random steps and loads, a tolerance of 1e-8 of a step */

static long events_seen, refused[16];

/* f = xi^q; with unloading along a branch or with damping, at random. */
static film_curve random_curve(int *reversible, double *damping) {
    film_curve curve;
    double pick = uniform();
    memset(&curve, 0, sizeof curve);
    curve.stages = curve.pieces = 1;
    film_stage *stage = &curve.stage[0];
    film_piece *piece = &curve.piece[0];
    stage->end = piece->end = uniform() < 0.1 ? spread(0.1, 10.0) : INFINITY;
    stage->count = 1;
    piece->force.per_span = piece->recovery.per_span = piece->exponent.per_span = piece->damping.per_span = 1.0;
    piece->force.exponent = piece->recovery.exponent = piece->exponent.exponent = piece->damping.exponent = 1.0;
    piece->force.coefficient = 1.0;
    piece->force.exponent = uniform() < 0.5 ? 1.5 : 1.0 + 1.5 * uniform();
    if (uniform() < 0.1) piece->force.constant = spread(1e-3, 1.0);
    *damping = 0.0;
    *reversible = pick < 0.4;
    if (pick >= 0.4 && pick < 0.8) {
        stage->unloading = FILM_RADIUS;
        piece->recovery.constant = spread(1.0, 20.0);
        piece->exponent.constant = 1.5;
        stage->reload_exponent = uniform() < 0.5 ? 1.5 : 0.0;
    } else if (pick >= 0.8) {
        stage->damped = 1;
        piece->damping.constant = uniform() < 0.3 ? 1.0 : 0.0;
        piece->damping.coefficient = 1.0;
        piece->damping.exponent = 0.5;
        *damping = spread(1e-3, 3.0);
    }
    return curve;
}

static double energy_of(const film_structure *structure, const film_curve *curve, const film_modal *s, const double *waves) {
    double energies[MODES], values[5], sum, force, work = 0.0;
    film_modal_energies(structure, s, waves, energies);
    film_modal_motion(structure, curve, s, waves, values);
    sum = 0.5 * values[3] * values[3] + 0.5 * s->rest * values[2] * values[2];
    for (int i = 0; i < structure->modes; i++) sum += energies[i];
    if (values[0] > 0.0) film_law(curve, 0, values[0], &force, &work);
    return sum + (s->contact.branch == FILM_FREE ? 0.0 : work);
}

static void check_status(int status) {
    if (status == FILM_BAD_NUMBER || status == FILM_BAD_CURVE || status == FILM_BAD_MESH || status == FILM_FULL)
        fail("a status that these inputs cannot have");
    if (status < 0) refused[-status]++;
}

/* Random steps and loads; halfway a copy of the state does the same. */
static void walk(film_structure *structure, const film_curve *curve, const film_modal_start *start, int reversible) {
    film_modal s, copy;
    double waves[4 * MODES], waves_copy[4 * MODES], values[5];
    int loaded = uniform() < 0.4;
    int status = film_modal_init(structure, curve, &s, waves, start, uniform() < 0.5 ? 0.0 : -spread(1e-3, 10.0));
    if (status < 0) fail("the start is refused");
    double before = energy_of(structure, curve, &s, waves);
    for (int k = 0; k < CALLS && status >= 0; k++) {
        double dt = start->unit * spread(1e-4, 10.0), left = dt;
        if (loaded && uniform() < 0.3 &&
            film_modal_input(structure, curve, &s, waves, uniform() - 0.3, spread(1e-3, 3.0) * (uniform() - 0.5), 0.1 * (uniform() - 0.5)) < 0)
            fail("an input is refused");
        copy = s;
        memcpy(waves_copy, waves, sizeof waves);
        double end = s.time + s.tau + dt;
        for (int i = 0; i < EVENTS; i++) {
            status = film_modal_step(structure, curve, &s, waves, left);
            if (status != FILM_EVENT) break;
            events_seen++;
            left = fmax(end - (s.time + s.tau), 0.0);
        }
        check_status(status);
        film_modal_motion(structure, curve, &s, waves, values);
        for (int i = 0; i < 5; i++)
            if (!isfinite(values[i])) fail("a value is not finite");
        if (status == FILM_OK && fabs(s.time + s.tau - end) > 1e-9 * end) fail("the time was not reached");
        left = dt;
        int again = FILM_OK;
        for (int i = 0; i < EVENTS; i++) {
            again = film_modal_step(structure, curve, &copy, waves_copy, left);
            if (again != FILM_EVENT) break;
            left = fmax(end - (copy.time + copy.tau), 0.0);
        }
        if (again != status || memcmp(&copy.x, &s.x, sizeof s.x) || memcmp(waves, waves_copy, 2 * sizeof(double) * (size_t)structure->modes))
            fail("a saved state does not run on to the same bits");
    }
    if (reversible && !loaded && status >= 0) {
        double change = fabs(energy_of(structure, curve, &s, waves) - before) / before;
        if (!(change < BALANCE)) {
            fprintf(stderr, "energy changed by %g of itself\n", change);
            fail("energy is not kept");
        }
    }
}

static void run(void) {
    static double memory[1 << 17];
    double frequency[MODES], share[MODES], ratio[MODES], waves[WAVES], damping, omega = spread(0.01, 10.0);
    if (uniform() < 0.4) omega = uniform() < 0.5 ? 0.0 : spread(1e-9, 1e-3); /* a motion as a whole, or almost one */
    int reversible, modes = (int)(uniform() * (MODES + 1)), damped = uniform() < 0.3;
    film_curve curve = random_curve(&reversible, &damping);
    film_structure structure;
    film_modal s;
    film_modal_summary summary;
    for (int i = 0; i < modes; i++) {
        frequency[i] = omega;
        share[i] = spread(1e-3, 30.0);
        ratio[i] = damped ? uniform() : 0.0;
        omega = (omega == 0.0 && uniform() < 0.5) ? 0.0 : fmax(omega, 0.01) * (1.0 + uniform());
    }
    if (film_structure_size(modes, LEVELS) > sizeof memory / sizeof *memory) fail("too little memory");
    if (film_structure_init(&structure, modes, frequency, share, ratio, 1.0, LEVELS, memory) != FILM_OK) fail("the structure is refused");
    film_modal_start start = {spread(1e-2, 30.0), uniform() < 0.3 ? uniform() - 0.3 : 0.0, 0.0, 1.0, spread(0.1, 10.0), damping, 1e-8, 200.0, 0.0, 0.0};
    if (!curve.stage[0].damped && uniform() < 0.7 && curve.piece[0].force.constant == 0.0) start.rest = spread(1e-3, 10.0);
    reversible = reversible && !damped && start.load == 0.0;
    walk(&structure, &curve, &start, reversible);
    int32_t carried = uniform() < 0.3 && modes > 2 ? 2 : 0;
    double forms[8]; /* two symmetric ones */
    for (int form = 0; form < 8; form += 4) {
        for (int k = 0; k < 4; k++) forms[form + k] = uniform() - 0.5;
        forms[form + 2] = forms[form + 1];
    }
    start.stretch = spread(1e-3, 1.0);
    if (film_structure_stretch(&structure, carried, 2, forms) != FILM_OK) fail("the membrane is refused");
    if (film_waves_size(&structure) > WAVES) fail("too few numbers for the waves");
    start.tolerance = 1e-4;
    int status = film_modal_impact(&structure, &curve, &start, &s, waves, &summary, NULL);
    check_status(status);
    if (status >= 0 && !(summary.core.maximum_force >= 0.0 && summary.core.maximum_force < INFINITY)) fail("no largest force");
    for (int32_t set = FILM_PLAIN; set <= film_instructions(); set++) {
        double waves_of_set[WAVES];
        film_modal_summary found;
        film_structure_init(&structure, modes, frequency, share, damped ? ratio : NULL, 1.0, LEVELS, memory);
        film_structure_stretch(&structure, carried, 2, forms);
        structure.instructions = set;
        if (film_modal_impact(&structure, &curve, &start, &s, waves_of_set, &found, NULL) != status) fail("instruction sets differ in the status");
        if (memcmp(waves, waves_of_set, 2 * sizeof(double) * (size_t)modes) || memcmp(&summary, &found, sizeof found))
            fail("instruction sets differ in bits");
    }
    runs++;
}

/* Tables of undamped modes against the responses of single modes, which take cosine and sine from the C library. Below a phase
 * of 6 the terms of their series are up to 65, so they differ by 1e-14. */
static void check_tables(void) {
    static double memory[1 << 16], frequency[TABLED], share[TABLED];
    film_structure structure;
    for (int i = 0; i < TABLED; i++) {
        frequency[i] = i == 0 ? 0.0 : 1e-3 * pow(10.0, 0.023 * i); /* phases to 1e6, beyond the table's own reduction */
        share[i] = 1.0;
    }
    if (film_structure_size(TABLED, 1) > sizeof memory / sizeof *memory) fail("too little memory");
    for (int32_t set = FILM_PLAIN; set <= film_instructions(); set++) {
        film_structure_init(&structure, TABLED, frequency, share, NULL, 1.0, 1, memory);
        structure.instructions = set;
        film_table table = film_level_table(&structure, 0);
        for (int i = 0; i < TABLED; i++) {
            double y[RESPONSES];
            film_responses(structure.square[i], 0.0, 1.0, y);
            if (!(fabs(table.end_cos[i] - y[0]) < 5e-14) || !(fabs(table.end_sin[i] - y[1]) < 5e-14 * fmin(1.0, 1.0 / frequency[i])))
                fail("a table's cosine or sine is wrong");
            for (int k = 1; k < RESPONSES; k++)
                if (!(fabs(table.push[(k - 1) * TABLED + i] - y[k]) < 1e-13 * fabs(y[k]) + 1e-14 * fmin(1.0, 1.0 / structure.square[i])))
                    fail("a table's response is wrong");
        }
    }
}

/* The modes of a plate: within their bound and the room, without nodes at the struck point, and softer than all of it. */
static void check_plates(void) {
    static double frequency[1000], shapes[2000];
    int sheared = 0;
    for (int k = 0; k < 200; k++) {
        film_plate plate = {.a = spread(1e-2, 10.0), .b = spread(1e-2, 10.0), .mass = spread(0.1, 10.0), .d11 = spread(1e-2, 1e2)};
        plate.x = uniform() * plate.a, plate.y = uniform() * plate.b, plate.d22 = spread(1e-2, 1e2);
        plate.mixed = (uniform() < 0.5 ? 1.0 : 3.0 * uniform() - 0.9) * sqrt(plate.d11 * plate.d22);
        if (k % 2) { /* of Poisson's ratio 0.3 */
            double h = plate.thickness = spread(1e-3, 0.3) * fmin(plate.a, plate.b);
            plate.d22 = plate.mixed = plate.d11, plate.softness = 5.7 / 21.0 * h * h / plate.d11, plate.bulge = 0.3 / 8.4 * h * h;
            sheared += film_plate_sheared(&plate);
        }
        double at[4] = {plate.a / 2.0, plate.b / 2.0, 2.0, 0.0};
        double highest = spread(1.0, 1e4), compliance = film_plate_compliance(&plate), sum = 0.0;
        if (film_plate_most(&plate, highest) > 1e5) continue;
        int64_t room = (int64_t)(1000 * uniform()), count = film_plate_modes(&plate, highest, 1, at, room, frequency, shapes);
        if (!(count >= 0 && (double)count <= film_plate_most(&plate, highest))) fail("more modes of a plate than the bound");
        for (int64_t i = 0; i < count && i < room; i++) {
            if (!(frequency[i] > 0.0 && frequency[i] <= highest) || shapes[2 * i] == 0.0) fail("a mode of a plate that does not belong");
            sum += shapes[2 * i] * shapes[2 * i] / (frequency[i] * frequency[i]);
        }
        if (!(sum <= compliance * (1.0 + 1e-6))) fail("the modes of a plate are softer than the plate");
    }
    if (sheared < 50) fail("too few plates with shear");
    film_plate plate = {1.0, 1.0, 0.5, 0.5, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0};
    if (film_plate_modes(&plate, 1e9, 0, NULL, 0, frequency, shapes) != FILM_BAD_NUMBER) fail("too many modes of a plate");
    if (film_plate_modes(&plate, NAN, 0, NULL, 0, frequency, shapes) != FILM_BAD_NUMBER) fail("a frequency of NaN of a plate");
}

/* What must be refused. */
static void check_refusals(void) {
    static double memory[4096];
    double good[2] = {1.0, 2.0}, falls[2] = {2.0, 1.0}, bad[2] = {1.0, NAN}, negative[2] = {1.0, -1.0}, over[2] = {0.1, 1.5};
    film_structure structure;
    if (film_structure_init(&structure, 2, falls, good, NULL, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("falling frequencies");
    if (film_structure_init(&structure, 2, bad, good, NULL, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("a frequency of NaN");
    if (film_structure_init(&structure, 2, good, negative, NULL, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("a negative share");
    if (film_structure_init(&structure, 2, good, bad, NULL, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("a share of NaN");
    if (film_structure_init(&structure, 2, good, good, over, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("a damping ratio above 1");
    if (film_structure_init(&structure, 2, good, good, NULL, NAN, 4, memory) != FILM_BAD_NUMBER) fail("a step of NaN");
    if (film_structure_init(&structure, 2, good, good, NULL, 1.0, 0, memory) != FILM_BAD_NUMBER) fail("no levels");
    if (film_structure_init(&structure, -1, good, good, NULL, 1.0, 4, memory) != FILM_BAD_NUMBER) fail("less than no modes");
}

int main(int count, char **arguments) {
    long wanted = count > 1 ? atol(arguments[1]) : 300;
    check_refusals();
    check_tables();
    check_plates();
    for (seed = 1; runs < wanted;) {
        seed = (uint64_t)runs * 7919u + 12345u;
        run();
    }
    printf("%ld runs, %ld events, refused: beyond the law %ld, too many %ld, bad unloading %ld\n", runs, events_seen, refused[4], refused[5],
           refused[6]);
    return 0;
}
