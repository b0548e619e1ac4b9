/* An importer as small as can be, for platforms that this one emulates: loads the binary of an FMU and prints the outputs
 * of one simulation through FMI 3.0 and one through FMI 2.0. Arguments: library, token, URI of the resources, which must
 * also be in the folder named below, stop time, number of steps. */
#include "fmi2Functions.h"
#include "fmi3Functions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define WIN32_LEAN_AND_MEAN
#define NOUSER /* without winuser.h, whose INPUT conflicts with that of variables.h */
#include <windows.h>
static void *open_library(const char *path) { return (void *)LoadLibraryA(path); }
static void close_library(void *library) { FreeLibrary((HMODULE)library); }
static void find(void *library, const char *name, void *function) {
    FARPROC found = GetProcAddress((HMODULE)library, name);
    memcpy(function, &found, sizeof found);
#else
#include <dlfcn.h>
static void *open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void close_library(void *library) { dlclose(library); }
static void find(void *library, const char *name, void *function) {
    void *found = dlsym(library, name);
    memcpy(function, &found, sizeof found);
#endif
    if (found) return;
    printf("%s is missing\n", name);
    exit(1);
}

#include "variables.h"

static const char FOLDER[] = "r\xc3\xa9sultats d'\xc3\xa9t\xc3\xa9 %20/"; /* UTF-8, a space, and what looks like an escape */

static void log_3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
    (void)environment, (void)status, (void)category;
    printf("%s\n", message);
}

static void log_2(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String message, ...) {
    (void)environment, (void)status, (void)category, (void)message;
    printf("%s has failed\n", name);
}

static void need(int condition, const char *what) {
    if (condition) return;
    printf("%s failed\n", what);
    exit(1);
}

static const unsigned REAL_OUTPUTS[] = {
    INDENTATION,         RELATIVE_VELOCITY,     IMPACTOR_VELOCITY,           IMPACTOR_DISPLACEMENT, TARGET_DISPLACEMENT,
    TARGET_VELOCITY,     IMPACTOR_ACCELERATION, CONTACT_FORCE,               TIME_OF_LAST_EVENT,    TIME_CONTACT_BEGINS,
    TIME_OF_MAXIMUM_INDENTATION, MAXIMUM_INDENTATION, MAXIMUM_FORCE, TIME_IMPACTOR_STOPS, TIME_CONTACT_ENDS, REBOUND_VELOCITY,
    PERMANENT_INDENTATION};
enum { OUTPUTS = sizeof REAL_OUTPUTS / sizeof *REAL_OUTPUTS };

static void show(const double values[OUTPUTS]) {
    for (int k = 0; k < OUTPUTS; k++) printf("%.17g%c", values[k], k + 1 < OUTPUTS ? ' ' : '\n');
}

#define FIND(name) name##TYPE *name; find(library, #name, &name)

static void simulate_3(void *library, const char *token, double stop, int steps) {
    double values[OUTPUTS];
    fmi3Boolean event, end, early;
    FIND(fmi3InstantiateCoSimulation);
    FIND(fmi3EnterInitializationMode);
    FIND(fmi3ExitInitializationMode);
    FIND(fmi3DoStep);
    FIND(fmi3GetFloat64);
    FIND(fmi3FreeInstance);
    need(!fmi3InstantiateCoSimulation("host", "{none}", FOLDER, 0, 0, 0, 0, NULL, 0, NULL, log_3, NULL), "refusing a token");
    fmi3Instance i = fmi3InstantiateCoSimulation("host", token, FOLDER, 0, 0, 0, 0, NULL, 0, NULL, log_3, NULL);
    need(i != NULL, "fmi3InstantiateCoSimulation");
    need(fmi3EnterInitializationMode(i, 0, 0.0, 0.0, 0, 0.0) == fmi3OK, "fmi3EnterInitializationMode");
    need(fmi3ExitInitializationMode(i) == fmi3OK, "fmi3ExitInitializationMode");
    double now = 0.0;
    for (int k = 1; k <= steps; k++) {
        need(fmi3DoStep(i, now, stop * k / steps - now, 1, &event, &end, &early, &now) == fmi3OK, "fmi3DoStep");
        need(fmi3GetFloat64(i, REAL_OUTPUTS, OUTPUTS, values, OUTPUTS) == fmi3OK, "fmi3GetFloat64");
        show(values);
    }
    fmi3FreeInstance(i);
}

static void simulate_2(void *library, const char *token, const char *uri, double stop, int steps) {
    static const fmi2CallbackFunctions functions = {log_2, NULL, NULL, NULL, NULL};
    double values[OUTPUTS];
    FIND(fmi2Instantiate);
    FIND(fmi2SetupExperiment);
    FIND(fmi2EnterInitializationMode);
    FIND(fmi2ExitInitializationMode);
    FIND(fmi2DoStep);
    FIND(fmi2GetReal);
    FIND(fmi2FreeInstance);
    fmi2Component i = fmi2Instantiate("host", fmi2CoSimulation, token, uri, &functions, 0, 0);
    need(i != NULL, "fmi2Instantiate");
    need(fmi2SetupExperiment(i, 0, 0.0, 0.0, 0, 0.0) == fmi2OK, "fmi2SetupExperiment");
    need(fmi2EnterInitializationMode(i) == fmi2OK, "fmi2EnterInitializationMode");
    need(fmi2ExitInitializationMode(i) == fmi2OK, "fmi2ExitInitializationMode");
    double now = 0.0;
    for (int k = 1; k <= steps; k++) {
        need(fmi2DoStep(i, now, stop * k / steps - now, 1) == fmi2OK, "fmi2DoStep");
        now += stop * k / steps - now;
        need(fmi2GetReal(i, REAL_OUTPUTS, OUTPUTS, values) == fmi2OK, "fmi2GetReal");
        show(values);
    }
    fmi2FreeInstance(i);
}

int main(int count, char **argument) {
    need(count == 6, "usage: fmu_host LIBRARY TOKEN URI STOP STEPS:");
    for (int again = 0; again < 2; again++) { /* loaded, unloaded, loaded */
        void *library = open_library(argument[1]);
        need(library != NULL, "loading the library");
        simulate_3(library, argument[2], atof(argument[4]), atoi(argument[5]));
        simulate_2(library, argument[2], argument[3], atof(argument[4]), atoi(argument[5]));
        close_library(library);
    }
    return 0;
}
