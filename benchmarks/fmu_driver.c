/* What the FMU functions cost beyond the march they carry. Built and run by benchmarks/fmu.py with the folders of an FMU's
 * resources as arguments. Prints a line each: the least nanoseconds of many rounds. */
#define _POSIX_C_SOURCE 199309L

#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include "instance.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 60, CALLS = 400, STEPS = 1000, LINE_ROOM = 4000, EVENT_ROOM = 100 };

static double nanoseconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static void need(int condition, const char *what) {
    if (condition) return;
    printf("%s failed\n", what);
    exit(1);
}

/* An instance that is ready, what brings it back there, and how its contact goes. */
typedef struct {
    int version;
    void *c, *start;
    double end;
    film_state state;
} subject;

static subject made(int version, const char *folder, const model_data *data) {
    static const fmi2CallbackFunctions none = {NULL, NULL, NULL, NULL, NULL};
    subject s;
    char uri[4200];
    memset(&s, 0, sizeof s);
    s.version = version;
    snprintf(uri, sizeof uri, "file://%s", folder);
    if (version == 2) {
        s.c = fmi2Instantiate("benchmark", fmi2CoSimulation, data->token, uri, &none, fmi2False, fmi2False);
        need(s.c && !fmi2EnterInitializationMode(s.c) && !fmi2ExitInitializationMode(s.c), "starting");
        need(!fmi2GetFMUstate(s.c, &s.start), "saving");
    } else {
        s.c = fmi3InstantiateCoSimulation("benchmark", data->token, folder, 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
        need(s.c && !fmi3EnterInitializationMode(s.c, 0, 0.0, 0.0, 0, 0.0) && !fmi3ExitInitializationMode(s.c), "starting");
        need(!fmi3GetFMUState(s.c, &s.start), "saving");
    }
    memcpy(&s.state, &((instance *)s.c)->model.memory.state, sizeof s.state);
    return s;
}

static void back(const subject *s) {
    if (s->version == 2) fmi2SetFMUstate(s->c, s->start);
    else fmi3SetFMUState(s->c, s->start);
}

static int step(const subject *s, double from, double size) {
    fmi3Boolean event, end, early;
    double reached;
    if (s->version == 2) return (int)fmi2DoStep(s->c, from, size, fmi2False);
    return (int)fmi3DoStep(s->c, from, size, fmi3False, &event, &end, &early, &reached);
}

static film_line *lines;
static film_state *events;
static double checksum = 0.0; /* so that nothing is left out */

/* One call of each kind of work. */
static void by_core(const subject *s) { /* the march alone: line after line, event after event */
    const model *m = &((instance *)s->c)->model;
    film_state state = s->state;
    double end = s->end / m->memory.time_scale;
    while (film_step(&m->data->curve, &m->mesh, &state, end - state.time) == FILM_EVENT) checksum += state.time;
    checksum += state.xi;
}

static void by_record(const subject *s) { /* the march with every line and event written down */
    const model *m = &((instance *)s->c)->model;
    film_state state = s->state;
    int32_t line_count, event_count;
    film_summary summary;
    film_record(&m->data->curve, &m->mesh, &state, s->end / m->memory.time_scale, lines, LINE_ROOM, &line_count, events, EVENT_ROOM,
                &event_count, &summary);
    checksum += state.xi;
}

static void by_one_step(const subject *s) {
    back(s);
    need(step(s, 0.0, s->end) == 0, "a step");
}

static void by_steps(const subject *s) {
    back(s);
    double now = 0.0;
    for (int k = 1; k <= STEPS; k++) {
        double next = s->end * k / STEPS;
        need(step(s, now, next - now) == 0, "a step");
        now += next - now;
    }
}

static void by_core_steps(const subject *s) {
    const model *m = &((instance *)s->c)->model;
    film_state state = s->state;
    double size = s->end / m->memory.time_scale / STEPS;
    for (int k = 0; k < STEPS; k++)
        while (film_step(&m->data->curve, &m->mesh, &state, fmax(size * (k + 1) - state.time, 0.0)) == FILM_EVENT) checksum += 1.0;
    checksum += state.xi;
}

static void by_outputs(const subject *s) {
    static const unsigned references[] = {INDENTATION, RELATIVE_VELOCITY, IMPACTOR_VELOCITY, CONTACT_FORCE};
    double values[4];
    if (s->version == 2) fmi2GetReal(s->c, references, 4, values);
    else fmi3GetFloat64(s->c, references, 4, values, 4);
    checksum += values[0];
}

static double least(void (*work)(const subject *), const subject *s, int calls) {
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        double initialized = nanoseconds();
        for (int k = 0; k < calls; k++) work(s);
        best = fmin(best, (nanoseconds() - initialized) / calls);
    }
    return best;
}

int main(int count, char **folder) {
    lines = malloc(LINE_ROOM * sizeof *lines);
    events = malloc(EVENT_ROOM * sizeof *events);
    need(lines && events, "memory");
    for (int k = 1; k < count; k++) {
        char message[512];
        model_data *data = model_read_data(folder[k], message, sizeof message);
        need(data != NULL, folder[k]);
        for (int version = 2; version <= 3; version++) {
            subject s = made(version, folder[k], data);
            const model *m = &((instance *)s.c)->model;
            film_state state = s.state;
            while (film_step(&m->data->curve, &m->mesh, &state, 1e6) == FILM_EVENT && state.event != FILM_CONTACT_ENDS) continue;
            need(state.event == FILM_CONTACT_ENDS, "a contact");
            s.end = state.time * m->memory.time_scale * 1.0001;
            double core = least(by_core, &s, CALLS), record = least(by_record, &s, CALLS);
            double restore = least(back, &s, CALLS), whole = least(by_one_step, &s, CALLS) - restore;
            double many = (least(by_steps, &s, 4) - restore) / STEPS, many_core = least(by_core_steps, &s, 4) / STEPS;
            printf("%d %d %d %.1f %.1f %.1f %.1f %.1f %.1f %.1f\n", k - 1, version, (int)state.lines, core, record, whole, restore,
                   many, many_core, least(by_outputs, &s, CALLS));
            if (version == 2) {
                fmi2FreeFMUstate(s.c, &s.start);
                fmi2FreeInstance(s.c);
            } else {
                fmi3FreeFMUState(s.c, &s.start);
                fmi3FreeInstance(s.c);
            }
        }
        free(data);
    }
    fprintf(stderr, "checksum %g\n", checksum);
    free(lines);
    free(events);
    return 0;
}
