/* Part of fmu_fuzz.c: random calls of functions for features that these FMUs do not have. */
#ifndef FMU_FUZZ_ABSENT_H
#define FMU_FUZZ_ABSENT_H

#include "fmu_fuzz_calls.h"

typedef union {
    fmi3Float32 f;
    fmi3Int8 i8;
    fmi3UInt8 u8;
    fmi3Int16 i16;
    fmi3UInt16 u16;
    fmi3UInt32 u32;
    fmi3UInt64 u64;
    fmi3Boolean b;
    fmi2Boolean b2;
    fmi3String s;
    fmi3Binary binary;
    fmi3IntervalQualifier q;
    double d;
} any_value;

static void call_absent_2(player *p) {
    unsigned reference = some_reference();
    any_value v;
    size_t one = (size_t)likely(80);
    int status, order = 1;
    void *c = p->u.c;
    memset(&v, 0, sizeof v);
    fmi2Status state;
    fmi2String text;
    switch (whole(0, 12)) {
    case 10: CALL(p, fmi2GetStatus, c, fmi2DoStepStatus, &state); break;
    case 11: CALL(p, fmi2GetStringStatus, c, fmi2PendingStatus, &text); break;
    case 0: CALL(p, fmi2GetBoolean, c, &reference, one, &v.b2); break;
    case 1: CALL(p, fmi2SetBoolean, c, &reference, one, &v.b2); break;
    case 2: CALL(p, fmi2GetString, c, &reference, one, &v.s); break;
    case 3: CALL(p, fmi2SetString, c, &reference, one, &v.s); break;
    case 4: CALL(p, fmi2SetRealInputDerivatives, c, &reference, one, &order, &v.d); break;
    case 5: CALL(p, fmi2GetRealOutputDerivatives, c, &reference, one, &order, &v.d); break;
    case 6: CALL(p, fmi2CancelStep, c); break;
    case 7: CALL(p, fmi2GetBooleanStatus, c, (fmi2StatusKind)whole(0, 4), likely(90) ? &v.b2 : NULL); break;
    case 8: CALL(p, fmi2GetRealStatus, c, (fmi2StatusKind)whole(0, 4), likely(90) ? &v.d : NULL); break;
    case 9: CALL(p, fmi2GetIntegerStatus, c, fmi2PendingStatus, &order); break;
    default: CALL(p, fmi2SetDebugLogging, c, likely(50), one, NULL); break;
    }
}

static void call_absent_3(player *p) {
    unsigned reference = some_reference();
    any_value v, other;
    size_t size = 0, one = (size_t)likely(80);
    int status, order = 1;
    void *c = p->u.c;
    memset(&v, 0, sizeof v);
    memset(&other, 0, sizeof other);
    switch (whole(0, 35)) {
    case 26: CALL(p, fmi3SetUInt8, c, &reference, one, &v.u8, one); break;
    case 27: CALL(p, fmi3SetInt16, c, &reference, one, &v.i16, one); break;
    case 28: CALL(p, fmi3SetUInt16, c, &reference, one, &v.u16, one); break;
    case 29: CALL(p, fmi3SetUInt32, c, &reference, one, &v.u32, one); break;
    case 30: CALL(p, fmi3GetIntervalFraction, c, &reference, one, &v.u64, &other.u64, &other.q); break;
    case 31: CALL(p, fmi3SetIntervalFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 32: CALL(p, fmi3GetShiftFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 33: CALL(p, fmi3SetShiftFraction, c, &reference, one, &v.u64, &other.u64); break;
    case 34: CALL(p, fmi3SetShiftDecimal, c, &reference, one, &v.d); break;
    case 0: CALL(p, fmi3GetFloat32, c, &reference, one, &v.f, one); break;
    case 1: CALL(p, fmi3GetInt8, c, &reference, one, &v.i8, one); break;
    case 2: CALL(p, fmi3GetUInt8, c, &reference, one, &v.u8, one); break;
    case 3: CALL(p, fmi3GetInt16, c, &reference, one, &v.i16, one); break;
    case 4: CALL(p, fmi3GetUInt16, c, &reference, one, &v.u16, one); break;
    case 5: CALL(p, fmi3GetUInt32, c, &reference, one, &v.u32, one); break;
    case 6: CALL(p, fmi3GetUInt64, c, &reference, one, &v.u64, one); break;
    case 7: CALL(p, fmi3GetBoolean, c, &reference, one, &v.b, one); break;
    case 8: CALL(p, fmi3GetString, c, &reference, one, &v.s, one); break;
    case 9: CALL(p, fmi3SetFloat32, c, &reference, one, &v.f, one); break;
    case 10: CALL(p, fmi3SetUInt64, c, &reference, one, &v.u64, one); break;
    case 11: CALL(p, fmi3SetBoolean, c, &reference, one, &v.b, one); break;
    case 12: CALL(p, fmi3SetString, c, &reference, one, &v.s, one); break;
    case 13: CALL(p, fmi3GetBinary, c, &reference, one, &size, &v.binary, one); break;
    case 14: CALL(p, fmi3SetBinary, c, &reference, one, &size, &v.binary, one); break;
    case 15: CALL(p, fmi3GetClock, c, &reference, one, &v.b); break;
    case 16: CALL(p, fmi3SetClock, c, &reference, one, &v.b); break;
    case 17: CALL(p, fmi3GetIntervalDecimal, c, &reference, one, &v.d, &v.q); break;
    case 18: CALL(p, fmi3SetIntervalDecimal, c, &reference, one, &v.d); break;
    case 19: CALL(p, fmi3GetShiftDecimal, c, &reference, one, &v.d); break;
    case 20: CALL(p, fmi3GetOutputDerivatives, c, &reference, one, &order, &v.d, one); break;
    case 21: CALL(p, fmi3EnterConfigurationMode, c); break;
    case 22: CALL(p, fmi3ExitConfigurationMode, c); break;
    case 23: CALL(p, fmi3EvaluateDiscreteStates, c); break;
    case 24: CALL(p, fmi3ActivateModelPartition, c, reference, 0.0); break;
    case 25: CALL(p, fmi3SetInt8, c, &reference, one, &v.i8, one); break;
    default: CALL(p, fmi3SetDebugLogging, c, likely(50), one, NULL); break;
    }
}

static void call_absent(player *p) { p->u.version == 2 ? call_absent_2(p) : call_absent_3(p); }

/* ---------------------------------------------------------------- calls within a step */

static long updates = 0;

/* An importer that calls whatever it likes; messages of the step itself come later. */
static void any_update(fmi3InstanceEnvironment environment, fmi3Float64 time, fmi3Boolean may_set, fmi3Boolean may_get,
                       fmi3Boolean finished, fmi3Boolean may_return, fmi3Boolean *returns, fmi3Float64 *return_time) {
    static void (*const any[])(player *) = {call_set, call_get, call_set, call_get, call_rates, call_step, call_exchange, call_event_mode,
                                            call_update, call_leave, call_initialization, call_state, call_derivative, call_absent};
    (void)environment, (void)may_return;
    player *p = stepping;
    const model_memory *m = &((instance *)p->u.c)->model.memory;
    long before = messages;
    int status = 0;
    HOLD(may_get == finished && (may_set || may_get) && isfinite(time) && time >= m->time);
    updates++;
    for (int calls = whole(0, 3); calls > 0; calls--) any[whole(0, (int)(sizeof any / sizeof *any) - 1)](p);
    EITHER_CALL(p, fmi2Terminate, (p->u.c), fmi3Terminate, (p->u.c));
    HOLD(status == ERROR);
    fmi3FreeInstance(p->u.c);
    messages = before;
    *returns = likely(may_return ? 10 : 1);
    if (likely(30)) *return_time = likely(80) ? time + uniform(-0.1, 1.0) * m->time_scale : odd();
}

#endif
