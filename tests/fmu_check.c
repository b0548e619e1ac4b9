/* Checks of the FMU runtime without an importer: the functions of FMI 2.0 and 3.0 against the core and against each other,
 * for every FMU. Arguments: folders of resources (see tests/fmu_resources.py), as absolute paths.
 *
 *     cc -std=c99 -O1 -g -fsanitize=address,undefined -ffp-contract=off -Wl,--wrap=malloc,--wrap=calloc,--wrap=free
 *        -I film_model/core -I fmu_wrapper/runtime -isystem FMI_HEADERS tests/fmu_check.c
 *        with the sources of fmu_wrapper/platforms.py -lm
 *
 * Prints one line; at the first failed assertion it prints that and exits with status 1. */
#include "fmu_check_model.h"
#include "fmu_check_updates.h"
/* ---------------------------------------------------------------- the contact alone */

/* Damping coefficient of a law; in all laws of this check it is a power. */
static double law_damping(const resources *r, double xi) {
    const film_function *c = &r->data.curve.piece[0].damping;
    if (!r->data.curve.stage[0].damped) return 0.0;
    HOLD(c->form == FILM_POWER && c->slope == 0.0 && c->origin == 0.0);
    return c->constant + (c->coefficient == 0.0 ? 0.0 : c->coefficient * pow(xi, c->exponent));
}

/* Indentation at constant rate in and out: the force does not depend on the step, and in loading it is the law's. */
static void contact_at_any_step(const resources *r, int version, int interface) {
    settings s = random_settings(r);
    unit first = started(version, interface, r, &s, 0.0);
    const model_memory *m = &inside(&first)->memory;
    double length = m->length, scale_force = m->force, found[2 * SAMPLES + 1], peak = length * uniform(0.5, 4.0);
    double damper = m->state.damper, lasts = r->data.curve.stage[0].damped ? 1e-5 : 1.0; /* short, so that the damping force is not negligible */
    dispose(&first);
    for (int parts = 1; parts <= 7; parts += 3) {
        double largest = 0.0;
        unit made = started(version, interface, r, &s, 0.0), *u = &made;
        for (int k = 0; k <= 2 * SAMPLES * parts; k++) {
            double along = (double)k / (SAMPLES * parts), out = along > 1.0 ? along - 1.0 : 0.0;
            double depth = along <= 1.0 ? peak * along : peak * (1.0 - 1.1 * out);
            double rate = along < 1.0 ? 1.0 : -1.1; /* over peak / lasts */
            if (k == SAMPLES * parts) rate = interface == EXCHANGE ? -1e-6 : 0.0; /* so that the cubic path does not exceed the peak */
            if (interface == EXCHANGE) {
                HOLD(set_time(u, along * lasts) == GOOD);
                HOLD(set(u, INDENTATION, depth) == GOOD && set(u, RELATIVE_VELOCITY, rate * peak / lasts) == GOOD);
                double z[FILM_INDICATORS];
                HOLD(get_indicators(u, z, FILM_INDICATORS) == GOOD);
                if (z[0] <= 0.0 || z[1] <= 0.0 || z[2] <= 0.0 || z[3] <= 0.0) {
                    handle(u);
                    after_event(u);
                }
                int asked;
                HOLD(completed_step(u, &asked) == GOOD);
            } else {
                if (k > 0) forward(u, lasts / (SAMPLES * parts), NULL);
                HOLD(set(u, INDENTATION, depth) == GOOD && set(u, RELATIVE_VELOCITY, rate * peak / lasts) == GOOD);
            }
            double force = get(u, CONTACT_FORCE), expected, work, *known = &found[k / parts];
            largest = fmax(largest, force);
            if (k % parts) continue;
            HOLD(force >= 0.0);
            if (along <= 1.0 && along > 0.0) {
                int32_t stage = 0;
                while (stage + 1 < r->data.curve.stages && depth / length > r->data.curve.stage[stage].end) stage++;
                film_law(&r->data.curve, stage, depth / length, &expected, &work);
                expected = fmax(expected + damper * law_damping(r, depth / length) * get(u, RELATIVE_VELOCITY) / length, 0.0);
                NEAR(force, expected * scale_force, force, EXACT);
            }
            if (parts > 1) NEAR(force, *known, largest, 1e-9 > EXACT && along > 1.0 ? 1e-11 : EXACT);
            *known = force;
        }
        HOLD(get(u, CONTACT_FORCE) == 0.0);
        if (interface == EXCHANGE) handle(u);
        else forward(u, lasts, NULL);
        NEAR(get(u, MAXIMUM_INDENTATION), peak, peak, EXACT);
        NEAR(get(u, MAXIMUM_FORCE), largest, largest, EXACT);
        HOLD(get(u, CONTACT_COUNT) == 1.0 && get(u, PHASE) == FILM_SEPARATED);
        dispose(u);
    }
}

/* Between two communication points the maximum indentation is that of the cubic. */
static void contact_peak(const resources *r, int version) {
    for (int k = 0; k < 200; k++) {
        unit made = started(version, COSIMULATION, r, NULL, 0.0), *u = &made;
        double h = over_decades(1e-6, 1.0), a = r->data.length_scale * uniform(0.1, 3.0), b = a * uniform(0.3, 1.2);
        double rate_a = a / h * over_decades(0.01, 2.0), rate_b = -rate_a * over_decades(0.01, 1.9); /* doubled, it is refused */
        double peak = fmax(a, b);
        HOLD(set(u, INDENTATION, a) == GOOD && set(u, RELATIVE_VELOCITY, rate_a) == GOOD);
        forward(u, h, NULL);
        HOLD(set(u, INDENTATION, b) == GOOD && set(u, RELATIVE_VELOCITY, rate_b) == GOOD);
        double tried = get(u, CONTACT_FORCE);
        HOLD(get(u, CONTACT_FORCE) == tried);
        forward(u, h, NULL);
        for (int i = 0; i <= 20000; i++) {
            double t = i / 20000.0, q = 1.0 - t;
            peak = fmax(peak, a * q * q * (1.0 + 2.0 * t) + b * t * t * (3.0 - 2.0 * t) + h * t * q * (rate_a * q - rate_b * t));
        }
        NEAR(get(u, MAXIMUM_INDENTATION), peak, peak, 1e-8);
        dispose(u);
    }
}

static void contact_derivative(const resources *r, int version, int interface) {
    unit made = started(version, interface, r, NULL, 0.0), *u = &made;
    for (int k = 0; k < 200; k++) {
        double depth = r->data.length_scale * uniform(0.05, 3.5), by = 1e-6 * depth, seeds[1] = {2.0}, slope;
        unsigned force = CONTACT_FORCE, indentation = INDENTATION;
        if (interface != EXCHANGE) { /* at rest: the maximum does not depend on the next point */
            HOLD(set(u, RELATIVE_VELOCITY, 0.0) == GOOD);
            forward(u, 1e-3, NULL);
        }
        HOLD(set(u, RELATIVE_VELOCITY, depth - get(u, INDENTATION)) == GOOD);
        if (interface == EXCHANGE) handle(u); /* at this point if the direction changes */
        HOLD(set(u, INDENTATION, depth) == GOOD);
        if (interface == EXCHANGE) handle(u);
        HOLD(derivative(u, &force, 1, &indentation, 1, seeds, &slope) == GOOD);
        double at = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth + by) == GOOD);
        double more = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth - by) == GOOD);
        double less = get(u, CONTACT_FORCE);
        HOLD(set(u, INDENTATION, depth) == GOOD);
        HOLD(get(u, CONTACT_FORCE) == at);
        snprintf(detail, sizeof detail, "%g N/m; at %g m: %g, %g, %g N", slope / 2.0, depth, less, at, more);
        double up = (more - at) / by, down = (at - less) / by, middle = 0.5 * (up + down); /* at the end of a stage the two sides differ */
        HOLD(fabs(slope / 2.0 - middle) <= 1e-5 * middle + 1e-6 || fabs(up - down) > 1e-2 * middle);
    }
    detail[0] = 0;
    dispose(u);
}

/* ---------------------------------------------------------------- main */

static void place_is(const char *check, const resources *r, int version, int interface) {
    static const char *const names[] = {"Co-Simulation", "event mode", "early return", "Model Exchange"};
    snprintf(where, sizeof where, "%s: FMI %d, %s, %.200s", check, version, names[interface], r->path);
}
#define CHECK(call, ...) (place_is(#call, __VA_ARGS__), call(__VA_ARGS__))

int main(int count, char **path) {
    resources *r = calloc((size_t)count, sizeof *r);
    lines = malloc(LINE_ROOM * sizeof *lines);
    met = malloc(EVENT_ROOM * sizeof *met);
    if (count < 2 || !r || !lines || !met) {
        printf("usage: fmu_check FOLDER...\n");
        return 2;
    }
    for (int k = 1; k < count; k++) open_resources(&r[k], path[k]);
    for (int k = 1; k < count; k++) {
        int impact = r[k].data.kind == IMPACT;
        for (int version = 2; version <= 3; version++) {
            for (int interface = COSIMULATION; interface < INTERFACES; interface++) {
                int own = beside(&r[k]);
                if ((version == 2 || !impact) && (interface == WITH_EVENTS || interface == EARLY_RETURN)) continue;
                if (!exchanges(&r[k]) && interface == EXCHANGE) continue;
                if (own && interface != EXCHANGE)
                    for (int i = 0; i < 10; i++) CHECK(the_same_at_any_step, &r[k], version, interface);
                else if (impact && !own && interface != EXCHANGE)
                    for (int i = 0; i < 3; i++) CHECK(at_any_step, &r[k], version, interface);
                if (!impact)
                    for (int i = 0; i < 10; i++) CHECK(contact_at_any_step, &r[k], version, interface);
                if (!impact) CHECK(contact_derivative, &r[k], version, interface);
                CHECK(rollback, &r[k], version, interface);
                if (version == 3 && interface != EXCHANGE) {
                    place_is("intermediate updates", &r[k], version, interface);
                    for (int i = 0; impact && i < 3; i++) updates_of_outputs(&r[k], interface);
                    updates_of_inputs(&r[k], interface);
                }
                CHECK(reset_is_new, &r[k], version, interface);
            }
            place_is("parameters", &r[k], version, COSIMULATION);
            parameters(&r[k], version);
            place_is("Model Exchange", &r[k], version, EXCHANGE);
            int marched = impact && !beside(&r[k]);
            if (marched) exchange(&r[k], version);
            if (marched) derivatives(&r[k], version);
            place_is("scaling", &r[k], version, COSIMULATION);
            for (int i = 0; marched && i < 10; i++) scaling(&r[k], version, i % 2 ? 2.0 : uniform(0.2, 5.0), i % 2 ? 2.0 : uniform(0.5, 4.0));
            place_is("contact_peak", &r[k], version, COSIMULATION);
            if (!impact) contact_peak(&r[k], version);
        }
        place_is("cycles", &r[k], 3, COSIMULATION);
        cycles(&r[k]);
        for (int other = 1; other < count; other++) {
            place_is("no_cross_talk", &r[other], 2 + (k + other) % 2, COSIMULATION);
            if (other != k) foreign_states(&r[k], &r[other]);
            no_cross_talk(&r[k], 2 + k % 2, &r[other], 2 + (k + other) % 2);
        }
    }
    free(met);
    free(lines);
    close_resources(r, count);
    printf("fmu_check: %d folders, %ld checks, %ld early returns, %ld intermediate updates\n", count - 1, checks, early_returns, updates);
    return blocks == 0 ? 0 : 1;
}
