/* The contact of bodies that relax under inputs chosen to break it: random series, starts, steps, loads and velocity changes.
 * Of each it is asked that the outcome is one that film_core.h names, that no number is NaN, that no force pulls, that a
 * contact without load keeps its balance of energy, and that a saved state runs on to the same bits.
 *
 *     cc -std=c99 -O2 -ffp-contract=off -I film_model/core tests/relax_fuzz.c $(find film_model/core -name 'film_*.c') -lm -o relax_fuzz
 *     ./relax_fuzz 2000
 */
#include "relax/film_relax.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FUZZ "relax_fuzz.c"
#include "fuzz_numbers.h"

enum { CALLS = 60 };

static const double BALANCE = 1e-9; /* of the impact energy: the work of each step is exact */
static const double GAIN = 1e-6;    /* of the impact energy: what a contact that is all but elastic gains at a tolerance of 1e-2 */

static long ended, refused;
static film_relax_step steps[FILM_RELAX_STEPS], kept_steps[FILM_RELAX_STEPS];

static film_relaxation random_law(void) {
    film_relaxation law;
    memset(&law, 0, sizeof law);
    law.terms = (int32_t)(uniform() * (FILM_RELAXATIONS + 1));
    law.rest = 1.0;
    for (int32_t i = 0; i < law.terms; i++) {
        law.share[i] = uniform() * law.rest * 0.7;
        law.rest -= law.share[i];
        law.rate[i] = spread(1e-12, 1e12);
    }
    return law;
}

static void check(const film_relax *s, int status) {
    double values[5], sum = 0.0;
    if (status > FILM_ENDLESS || status < FILM_REMEMBERS) fail("an unknown outcome");
    if (status < 0) return;
    film_relax_motion(s, steps, values);
    for (int k = 0; k < 5; k++) sum += values[k];
    if (sum - sum != 0.0) fail("a number that is not finite");
    if (values[2] < 0.0) fail("a force that pulls");
}

static void whole_impact(const film_relaxation *law, film_start start) {
    film_relax state;
    film_summary summary;
    start.load = 0.0;
    int status = film_relax_impact(law, &start, spread(1e-6, 1e-2), &state, steps, &summary);
    check(&state, status);
    if (status != FILM_EVENT) return;
    ended++;
    double energy = 0.5 * start.nu * start.nu, left = 0.5 * summary.final_velocity * summary.final_velocity;
    if (!(summary.work > -GAIN * energy)) fail("energy that is gained");
    if (start.gamma == 0.0 && fabs(energy - left - summary.work) > BALANCE * energy) fail("energy that is lost");
}

static void stepped(const film_relaxation *law, const film_start *start) {
    film_relax state, kept;
    double unit = pow(start->nu, -0.2);
    int status = film_relax_init(&state, law, start, 1e-3, uniform() < 0.5 ? 0.0 : -spread(1e-3, 1.0) * start->nu);
    for (int k = 0; k < CALLS && status >= 0; k++) {
        double dt = spread(1e-4, 2.0) * unit;
        kept = state;
        memcpy(kept_steps, steps, sizeof steps);
        status = film_relax_advance(&state, steps, dt);
        check(&state, status);
        if (uniform() < 0.2) {
            film_relax first = state;
            state = kept;
            memcpy(steps, kept_steps, sizeof steps);
            if (film_relax_advance(&state, steps, dt) != status || memcmp(&state, &first, sizeof state) != 0) fail("another result");
        }
        if (status >= 0 && uniform() < 0.1) film_relax_input(&state, steps, spread(1e-3, 3.0) * start->nu, (uniform() - 0.5) * start->nu, 0.0);
    }
    if (status < 0) refused++;
}

int main(int argc, char **argv) {
    long count = argc > 1 ? atol(argv[1]) : 200;
    for (runs = 0; runs < count; runs++) {
        seed = 77777u + (uint64_t)runs;
        for (int k = 0; k < 8; k++) uniform();
        film_relaxation law = random_law();
        film_start start = {spread(1e-3, 1e3), uniform() < 0.5 ? 0.0 : spread(1e-3, 3.0), 0.0, -0.0, INFINITY, 0.0};
        if (uniform() < 0.3) start.load = spread(1e-3, 1.0);
        whole_impact(&law, start);
        stepped(&law, &start);
    }
    printf("%ld impacts, of which %ld ended; %ld stepped ones refused\n", runs, ended, refused);
    return 0;
}
