/* The functions of FMI 2.0, which call those of instance.h. */
#include "fmi2Functions.h"

#define STATUS fmi2Status
#include "fmi_calls.h"

#include <string.h>

/* The text is passed as a printf format: its % signs are doubled. Other formatting is avoided, because some importers do
 * not apply printf. */
static void send_message(const instance *i, int status, const char *category, const char *text) {
    fmi2CallbackLogger logger = (fmi2CallbackLogger)i->logger;
    char format[1024];
    size_t used = 0;
    for (; *text && used + 2 < sizeof format; text++) {
        if (*text == '%') format[used++] = '%';
        format[used++] = *text;
    }
    format[used] = 0;
    if (logger) logger(i->environment, i->name, (fmi2Status)status, category, format);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories, const fmi2String categories[]) {
    SELF;
    NEED(categories, nCategories);
    (void)loggingOn; /* all errors are logged, and nothing else */
    return fmi2OK;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID, fmi2String fmuResourceLocation,
                              const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean loggingOn) {
    char folder[4096] = "", raw[4096] = "";
    instance_options options = {instanceName, fmuGUID, folder, fmuType == fmi2ModelExchange, 0, 0, send_message, NULL, NULL};
    (void)visible, (void)loggingOn;
    if (functions) {
        options.environment = functions->componentEnvironment;
        options.logger = (void (*)(void))functions->logger;
    }
    int bad = model_path_of_uri(fmuResourceLocation, folder, sizeof folder, 1) < 0;
    /* Some importers do not escape: a folder may be called a%20b. */
    if ((bad || !model_has_data(folder)) && model_path_of_uri(fmuResourceLocation, raw, sizeof raw, 0) == 0 && model_has_data(raw)) {
        memcpy(folder, raw, sizeof folder);
        bad = 0;
    }
    return instance_new(HERE, &options, bad ? "fmuResourceLocation must be a file URI such as file:///tmp/fmu/resources" : NULL);
}

void fmi2FreeInstance(fmi2Component c) { instance_free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime) {
    SELF;
    (void)toleranceDefined, (void)tolerance; /* the number of segments sets the accuracy */
    return (fmi2Status)instance_set_up(i, HERE, startTime, stopTimeDefined, stopTime);
}

FORWARD(fmi2EnterInitializationMode(fmi2Component c), instance_enter_initialization(i, HERE))
FORWARD(fmi2ExitInitializationMode(fmi2Component c), instance_exit_initialization(i, HERE))
FORWARD(fmi2Terminate(fmi2Component c), instance_terminate(i, HERE))
FORWARD(fmi2Reset(fmi2Component c), instance_reset(i, HERE))

/* ---------------------------------------------------------------- variables */

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Real value[]) {
    SELF;
    GET_ALL(vr, nvr, value, fmi2Real, REAL, REAL);
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2Integer value[]) {
    SELF;
    GET_ALL(vr, nvr, value, fmi2Integer, WHOLE, ENUMERATION);
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Real value[]) {
    SELF;
    SET_ALL(vr, nvr, value, INSTANTIATED | INITIALIZATION | RUNNING, REAL, REAL);
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer value[]) {
    SELF;
    SET_ALL(vr, nvr, value, INSTANTIATED | INITIALIZATION | RUNNING, WHOLE, ENUMERATION);
}

/* This FMU has no variables of these types. */
#define NO_VARIABLES(name, type)                                                                       \
    FORWARD(fmi2##name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, type value[]),      \
            ((void)vr, (void)value, nvr == 0 ? fmi2OK : FAIL("this FMU has no variables of this type")))
NO_VARIABLES(GetBoolean, fmi2Boolean)
NO_VARIABLES(GetString, fmi2String)
NO_VARIABLES(SetBoolean, const fmi2Boolean)
NO_VARIABLES(SetString, const fmi2String)

/* ---------------------------------------------------------------- saved states */

FORWARD(fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate), instance_save(i, HERE, FMUstate))
FORWARD(fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate), instance_restore(i, HERE, FMUstate))
FORWARD(fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate), instance_free_state(FMUstate))
FORWARD(fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size),
        instance_size(i, HERE, FMUstate, size))
FORWARD(fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size),
        instance_serialize(i, HERE, FMUstate, (unsigned char *)serializedState, size))
FORWARD(fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size, fmi2FMUstate *FMUstate),
        instance_deserialize(i, HERE, (const unsigned char *)serializedState, size, FMUstate))
FORWARD(fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference vUnknown_ref[], size_t nUnknown,
        const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[], fmi2Real dvUnknown[]),
        instance_derivatives(i, HERE, vUnknown_ref, nUnknown, vKnown_ref, nKnown, dvKnown, dvUnknown, 0))

/* ---------------------------------------------------------------- model exchange */

FORWARD(fmi2EnterEventMode(fmi2Component c), instance_enter_event_mode(i, HERE))

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *fmi2eventInfo) {
    SELF;
    NEED(fmi2eventInfo, 1);
    int restart;
    if (instance_update(i, HERE, &restart) != GOOD) return fmi2Error;
    fmi2EventInfo info = {fmi2False, fmi2False, fmi2False, restart, fmi2False, 0.0};
    *fmi2eventInfo = info;
    return fmi2OK;
}

FORWARD(fmi2EnterContinuousTimeMode(fmi2Component c), instance_leave_event_mode(i, HERE, CONTINUOUS))

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean noSetFMUStatePriorToCurrentPoint,
                                       fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation) {
    SELF;
    (void)noSetFMUStatePriorToCurrentPoint;
    NEED(enterEventMode, 1);
    NEED(terminateSimulation, 1);
    if (instance_completed(i, HERE) != GOOD) return fmi2Error;
    *enterEventMode = model_has_unreported(&i->model); /* a new phase of sliding */
    *terminateSimulation = fmi2False;
    return fmi2OK;
}

FORWARD(fmi2SetTime(fmi2Component c, fmi2Real time), instance_set_time(i, HERE, time))
FORWARD(fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t nx), instance_set_states(i, HERE, x, nx))
FORWARD(fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t nx),
        instance_vector(i, HERE, GET_RATES, derivatives, nx))
FORWARD(fmi2GetEventIndicators(fmi2Component c, fmi2Real eventIndicators[], size_t ni),
        instance_vector(i, HERE, GET_INDICATORS, eventIndicators, ni))
FORWARD(fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t nx), instance_vector(i, HERE, GET_STATES, x, nx))
FORWARD(fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real x_nominal[], size_t nx),
        instance_vector(i, HERE, GET_NOMINALS, x_nominal, nx))

/* ---------------------------------------------------------------- co-simulation */

#define TIME_DERIVATIVES(name, type, call)                                                                                \
    fmi2Status name(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[], type value[]) { \
        SELF;                                                                                                             \
        if (!instance_allows(i, HERE, STEPPING)) return fmi2Error;                                                        \
        NEED(vr, nvr);                                                                                                    \
        NEED(order, nvr);                                                                                                 \
        NEED(value, nvr);                                                                                                 \
        for (size_t k = 0; k < nvr; k++)                                                                                  \
            if (call < 0) return FAIL("%s", i->model.message);                                                            \
        return fmi2OK;                                                                                                    \
    }
TIME_DERIVATIVES(fmi2SetRealInputDerivatives, const fmi2Real, model_set_input_rate(&i->model, vr[k], order[k], value[k]))
TIME_DERIVATIVES(fmi2GetRealOutputDerivatives, fmi2Real, model_output_rate(&i->model, vr[k], order[k], &value[k]))

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint) {
    SELF;
    int event;
    (void)noSetFMUStatePriorToCurrentPoint;
    return (fmi2Status)instance_step(i, HERE, currentCommunicationPoint, communicationStepSize, &event);
}

FORWARD(fmi2CancelStep(fmi2Component c),
        instance_error(i, HERE, "no step is in progress: fmi2DoStep returns after the step"))

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value) {
    SELF;
    NEED(value, 1);
    if (s != fmi2LastSuccessfulTime) return FAIL("only fmi2LastSuccessfulTime is supported");
    *value = i->model.memory.time;
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value) {
    SELF;
    NEED(value, 1);
    if (s != fmi2Terminated) return FAIL("only fmi2Terminated is supported");
    *value = fmi2False;
    return fmi2OK;
}

/* Not needed: fmi2DoStep never returns fmi2Pending. */
#define UNSUPPORTED_STATUS(name, type)                                              \
    FORWARD(fmi2##name(fmi2Component c, const fmi2StatusKind s, type *value),       \
            ((void)s, (void)value, FAIL("not supported by this FMU")))
UNSUPPORTED_STATUS(GetStatus, fmi2Status)
UNSUPPORTED_STATUS(GetIntegerStatus, fmi2Integer)
UNSUPPORTED_STATUS(GetStringStatus, fmi2String)
