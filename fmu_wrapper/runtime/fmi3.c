/* The functions of FMI 3.0, which call those of instance.h. */
#include "fmi3Functions.h"

#define STATUS fmi3Status
#include "fmi_calls.h"

#define CHECK_COUNTS() \
    if (nValues != nValueReferences) \
    return FAIL("%u values for %u scalar variables", (unsigned)nValues, (unsigned)nValueReferences)

static void send_message(const instance *i, int status, const char *category, const char *text) {
    fmi3LogMessageCallback logger = (fmi3LogMessageCallback)i->logger;
    if (logger) logger(i->environment, (fmi3Status)status, category, text);
}

static void call_importer(const instance *i, update_call *update) {
    fmi3Boolean returns = fmi3False;
    ((fmi3IntermediateUpdateCallback)i->importer)(i->environment, update->time, update->set, update->get, update->finished,
                                                  update->can_return, &returns, &update->return_time);
    update->returns = returns;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean loggingOn, size_t nCategories, const fmi3String categories[]) {
    SELF;
    NEED(categories, nCategories);
    (void)loggingOn; /* all errors are logged, and nothing else */
    return fmi3OK;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                          fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment environment,
                                          fmi3LogMessageCallback logMessage) {
    instance_options options = {instanceName, instantiationToken, resourcePath, 1, 0, 0, send_message, environment,
                                (void (*)(void))logMessage};
    (void)visible, (void)loggingOn;
    return instance_new(HERE, &options, NULL);
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                         fmi3Boolean visible, fmi3Boolean loggingOn, fmi3Boolean eventModeUsed,
                                         fmi3Boolean earlyReturnAllowed, const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logMessage, fmi3IntermediateUpdateCallback intermediateUpdate) {
    instance_options options = {instanceName, instantiationToken, resourcePath, 0, eventModeUsed, earlyReturnAllowed,
                                send_message,         environment,        (void (*)(void))logMessage};
    (void)visible, (void)loggingOn;
    instance *made = instance_new(HERE, &options, NULL);
    if (!made) return NULL;
    int status = instance_require(made, HERE, requiredIntermediateVariables, nRequiredIntermediateVariables, call_importer,
                                  (void (*)(void))intermediateUpdate);
    if (status == GOOD && made->data->kind == CONTACT && eventModeUsed) status = instance_error(made, HERE, "this FMU has no event mode");
    if (status == GOOD) return made;
    instance_free(made);
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken, fmi3String resourcePath,
                                               fmi3Boolean visible, fmi3Boolean loggingOn, fmi3InstanceEnvironment environment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption) {
    instance_options options = {instanceName, instantiationToken, resourcePath, 0, 0, 0, send_message, environment,
                                (void (*)(void))logMessage};
    (void)visible, (void)loggingOn, (void)clockUpdate, (void)lockPreemption, (void)unlockPreemption;
    return instance_new(HERE, &options, "Scheduled Execution is not supported by this FMU");
}

void fmi3FreeInstance(fmi3Instance c) {
    if (instance_allows(c, HERE, ANY_MODE)) instance_free(c);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean toleranceDefined, fmi3Float64 tolerance, fmi3Float64 startTime,
                                       fmi3Boolean stopTimeDefined, fmi3Float64 stopTime) {
    SELF;
    (void)toleranceDefined, (void)tolerance; /* the number of segments sets the accuracy */
    if (instance_set_up(i, HERE, startTime, stopTimeDefined, stopTime) != GOOD) return fmi3Error;
    return (fmi3Status)instance_enter_initialization(i, HERE);
}

FORWARD(fmi3ExitInitializationMode(fmi3Instance c), instance_exit_initialization(i, HERE))
FORWARD(fmi3EnterEventMode(fmi3Instance c), instance_enter_event_mode(i, HERE))
FORWARD(fmi3Terminate(fmi3Instance c), instance_terminate(i, HERE))
FORWARD(fmi3Reset(fmi3Instance c), instance_reset(i, HERE))

/* ---------------------------------------------------------------- variables */

#define ACCESS(name, type_name, kind)                                                                                     \
    fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,         \
                             type_name values[], size_t nValues) {                                                        \
        SELF;                                                                                                             \
        CHECK_COUNTS();                                                                                                   \
        GET_ALL(valueReferences, nValues, values, type_name, kind, kind);                                                 \
    }                                                                                                                     \
    fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences,         \
                             const type_name values[], size_t nValues) {                                                  \
        SELF;                                                                                                             \
        CHECK_COUNTS();                                                                                                   \
        SET_ALL(valueReferences, nValues, values, INSTANTIATED | INITIALIZATION | RUNNING | INTERMEDIATE, kind, kind);    \
    }
ACCESS(Float64, fmi3Float64, REAL)
ACCESS(Int32, fmi3Int32, WHOLE)
ACCESS(Int64, fmi3Int64, ENUMERATION)

/* This FMU has no variables of these types. */
#define REFERENCES fmi3Instance c, const fmi3ValueReference valueReferences[], size_t nValueReferences
#define NO_VARIABLES(function, type_name)                                                                                 \
    FORWARD(function(REFERENCES, type_name values[], size_t nValues),                                                     \
            ((void)valueReferences, (void)values,                                                                         \
             nValueReferences == 0 && nValues == 0 ? fmi3OK : FAIL("this FMU has no variables of this type")))
#define NEITHER(name)                                    \
    NO_VARIABLES(fmi3Get##name, fmi3##name)              \
    NO_VARIABLES(fmi3Set##name, const fmi3##name)
NEITHER(Float32)
NEITHER(Int8)
NEITHER(UInt8)
NEITHER(Int16)
NEITHER(UInt16)
NEITHER(UInt32)
NEITHER(UInt64)
NEITHER(Boolean)
NEITHER(String)

#define UNSUPPORTED_CALL(declaration, count, ...)                                                     \
    FORWARD(declaration, ((void)valueReferences, __VA_ARGS__, (count) == 0 ? fmi3OK : FAIL("not supported by this FMU")))

UNSUPPORTED_CALL(fmi3GetBinary(REFERENCES, size_t valueSizes[], fmi3Binary values[], size_t nValues), nValueReferences + nValues,
        (void)valueSizes, (void)values)
UNSUPPORTED_CALL(fmi3SetBinary(REFERENCES, const size_t valueSizes[], const fmi3Binary values[], size_t nValues),
        nValueReferences + nValues, (void)valueSizes, (void)values)
UNSUPPORTED_CALL(fmi3GetClock(REFERENCES, fmi3Clock values[]), nValueReferences, (void)values)
UNSUPPORTED_CALL(fmi3SetClock(REFERENCES, const fmi3Clock values[]), nValueReferences, (void)values)
UNSUPPORTED_CALL(fmi3GetIntervalDecimal(REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]),
        nValueReferences, (void)intervals, (void)qualifiers)
UNSUPPORTED_CALL(fmi3GetIntervalFraction(REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                           fmi3IntervalQualifier qualifiers[]),
        nValueReferences, (void)counters, (void)resolutions, (void)qualifiers)
UNSUPPORTED_CALL(fmi3GetShiftDecimal(REFERENCES, fmi3Float64 shifts[]), nValueReferences, (void)shifts)
UNSUPPORTED_CALL(fmi3GetShiftFraction(REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]), nValueReferences,
        (void)counters, (void)resolutions)
UNSUPPORTED_CALL(fmi3SetIntervalDecimal(REFERENCES, const fmi3Float64 intervals[]), nValueReferences, (void)intervals)
UNSUPPORTED_CALL(fmi3SetIntervalFraction(REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
        nValueReferences, (void)counters, (void)resolutions)
UNSUPPORTED_CALL(fmi3SetShiftDecimal(REFERENCES, const fmi3Float64 shifts[]), nValueReferences, (void)shifts)
UNSUPPORTED_CALL(fmi3SetShiftFraction(REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]),
        nValueReferences, (void)counters, (void)resolutions)

fmi3Status fmi3GetOutputDerivatives(REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues) {
    SELF;
    if (!instance_allows(i, HERE, STEPPING | EVENT | INTERMEDIATE)) return fmi3Error;
    NEED(valueReferences, nValueReferences);
    NEED(orders, nValueReferences);
    NEED(values, nValues);
    CHECK_COUNTS();
    for (size_t k = 0; k < nValues; k++)
        if (!instance_may_get(i, HERE, valueReferences[k])) return fmi3Error;
        else if (model_output_rate(&i->model, valueReferences[k], orders[k], &values[k]) < 0)
            return FAIL("%s", i->model.message);
    return fmi3OK;
}

/* ---------------------------------------------------------------- dependencies and derivatives */

static fmi3Status dependencies(instance *i, const char *function, fmi3ValueReference dependent, size_t *count, size_t elements[],
                               fmi3ValueReference independents[], size_t of[], fmi3DependencyKind kinds[]) {
    *count = 0;
    int known_output = model_is_sensed(&i->model, dependent) || (dependent < VARIABLES && VARIABLE[dependent].role[i->data->kind] == OUTPUT);
    if (!known_output || model_depends(&i->model, dependent, TIME) < 0)
        return (fmi3Status)instance_error(i, function, "value reference %u is not a real output", dependent);
    for (unsigned known = 0; known < VARIABLES; known++) {
        if (model_depends(&i->model, dependent, known) != 1) continue;
        if (independents) {
            elements[*count] = of[*count] = 0;
            independents[*count] = known;
            kinds[*count] = fmi3Dependent;
        }
        ++*count;
    }
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference valueReference, size_t *nDependencies) {
    SELF;
    NEED(nDependencies, 1);
    return dependencies(i, HERE, valueReference, nDependencies, NULL, NULL, NULL, NULL);
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elementIndicesOfDependent[],
                                       fmi3ValueReference independents[], size_t elementIndicesOfIndependents[],
                                       fmi3DependencyKind dependencyKinds[], size_t nDependencies) {
    SELF;
    size_t count;
    NEED(elementIndicesOfDependent, nDependencies);
    NEED(independents, nDependencies);
    NEED(elementIndicesOfIndependents, nDependencies);
    NEED(dependencyKinds, nDependencies);
    fmi3Status status = dependencies(i, HERE, dependent, &count, NULL, NULL, NULL, NULL);
    if (status != fmi3OK) return status;
    if (count != nDependencies)
        return FAIL("%u dependencies, but there are %u", (unsigned)nDependencies, (unsigned)count);
    return dependencies(i, HERE, dependent, &count, elementIndicesOfDependent, independents, elementIndicesOfIndependents,
                        dependencyKinds);
}

#define DERIVATIVE(name, adjoint, seeds, results)                                                                         \
    fmi3Status name(fmi3Instance c, const fmi3ValueReference unknowns[], size_t nUnknowns, const fmi3ValueReference knowns[], \
                    size_t nKnowns, const fmi3Float64 seed[], size_t nSeed, fmi3Float64 sensitivity[], size_t nSensitivity) { \
        SELF;                                                                                                             \
        if (nSeed != (seeds) || nSensitivity != (results))                                                                \
            return FAIL("%u seeds and %u sensitivities do not match %u unknowns and %u knowns",    \
                                              (unsigned)nSeed, (unsigned)nSensitivity, (unsigned)nUnknowns, (unsigned)nKnowns); \
        return (fmi3Status)instance_derivatives(i, HERE, unknowns, nUnknowns, knowns, nKnowns, seed, sensitivity, adjoint); \
    }
DERIVATIVE(fmi3GetDirectionalDerivative, 0, nKnowns, nUnknowns)
DERIVATIVE(fmi3GetAdjointDerivative, 1, nUnknowns, nKnowns)

/* ---------------------------------------------------------------- saved states */

FORWARD(fmi3GetFMUState(fmi3Instance c, fmi3FMUState *FMUState), instance_save(i, HERE, FMUState))
FORWARD(fmi3SetFMUState(fmi3Instance c, fmi3FMUState FMUState), instance_restore(i, HERE, FMUState))

FORWARD(fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *FMUState), instance_free_state(FMUState))
FORWARD(fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState FMUState, size_t *size),
        instance_size(i, HERE, FMUState, size))
FORWARD(fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size),
        instance_serialize(i, HERE, FMUState, serializedState, size))
FORWARD(fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte serializedState[], size_t size, fmi3FMUState *FMUState),
        instance_deserialize(i, HERE, serializedState, size, FMUState))

/* ---------------------------------------------------------------- configuration and events */

FORWARD(fmi3EnterConfigurationMode(fmi3Instance c), instance_error(i, HERE, "this FMU has no structural parameters to configure"))
FORWARD(fmi3ExitConfigurationMode(fmi3Instance c), instance_error(i, HERE, "this FMU has no structural parameters to configure"))

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
    SELF;
    return instance_allows(i, HERE, INITIALIZATION | EVENT) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *discreteStatesNeedUpdate, fmi3Boolean *terminateSimulation,
                                    fmi3Boolean *nominalsOfContinuousStatesChanged, fmi3Boolean *valuesOfContinuousStatesChanged,
                                    fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime) {
    SELF;
    NEED(discreteStatesNeedUpdate, 1);
    NEED(terminateSimulation, 1);
    NEED(nominalsOfContinuousStatesChanged, 1);
    NEED(valuesOfContinuousStatesChanged, 1);
    NEED(nextEventTimeDefined, 1);
    NEED(nextEventTime, 1);
    *discreteStatesNeedUpdate = *terminateSimulation = *nominalsOfContinuousStatesChanged = fmi3False;
    *valuesOfContinuousStatesChanged = *nextEventTimeDefined = fmi3False;
    *nextEventTime = 0.0;
    int restart;
    fmi3Status status = (fmi3Status)instance_update(i, HERE, &restart);
    *valuesOfContinuousStatesChanged = restart != 0;
    return status;
}

FORWARD(fmi3EnterContinuousTimeMode(fmi3Instance c), instance_leave_event_mode(i, HERE, CONTINUOUS))
FORWARD(fmi3EnterStepMode(fmi3Instance c), instance_leave_event_mode(i, HERE, STEPPING))

/* ---------------------------------------------------------------- model exchange */

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *enterEventMode,
                                       fmi3Boolean *terminateSimulation) {
    SELF;
    (void)noSetFMUStatePriorToCurrentPoint;
    NEED(enterEventMode, 1);
    NEED(terminateSimulation, 1);
    if (instance_completed(i, HERE) != GOOD) return fmi3Error;
    *enterEventMode = model_has_unreported(&i->model) != 0; /* a new phase of sliding */
    *terminateSimulation = fmi3False;
    return fmi3OK;
}

FORWARD(fmi3SetTime(fmi3Instance c, fmi3Float64 time), instance_set_time(i, HERE, time))
FORWARD(fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 continuousStates[], size_t nContinuousStates),
        instance_set_states(i, HERE, continuousStates, nContinuousStates))
FORWARD(fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t nContinuousStates),
        instance_vector(i, HERE, GET_RATES, derivatives, nContinuousStates))
FORWARD(fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 eventIndicators[], size_t nEventIndicators),
        instance_vector(i, HERE, GET_INDICATORS, eventIndicators, nEventIndicators))
FORWARD(fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 continuousStates[], size_t nContinuousStates),
        instance_vector(i, HERE, GET_STATES, continuousStates, nContinuousStates))
FORWARD(fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 nominals[], size_t nContinuousStates),
        instance_vector(i, HERE, GET_NOMINALS, nominals, nContinuousStates))

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *nEventIndicators) {
    SELF;
    NEED(nEventIndicators, 1);
    *nEventIndicators = FILM_INDICATORS;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *nContinuousStates) {
    SELF;
    NEED(nContinuousStates, 1);
    *nContinuousStates = instance_state_count(i);
    return fmi3OK;
}

/* ---------------------------------------------------------------- co-simulation */

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime) {
    SELF;
    int event;
    (void)noSetFMUStatePriorToCurrentPoint;
    NEED(eventHandlingNeeded, 1);
    NEED(terminateSimulation, 1);
    NEED(earlyReturn, 1);
    NEED(lastSuccessfulTime, 1);
    fmi3Status status = (fmi3Status)instance_step(i, HERE, currentCommunicationPoint, communicationStepSize, &event);
    *terminateSimulation = fmi3False;
    *eventHandlingNeeded = event != 0;
    *lastSuccessfulTime = i->model.memory.time;
    *earlyReturn = status == fmi3OK && *lastSuccessfulTime < currentCommunicationPoint + communicationStepSize;
    return status;
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clockReference, fmi3Float64 activationTime) {
    SELF;
    (void)clockReference, (void)activationTime;
    return FAIL("Scheduled Execution is not supported by this FMU");
}
