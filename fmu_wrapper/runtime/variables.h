/* The variables, by value reference. Generated from fmu_wrapper/variables.py; do not edit. */
#ifndef FILM_VARIABLES_H
#define FILM_VARIABLES_H

enum {
    TIME,
    MASS,
    INITIAL_VELOCITY,
    INITIAL_GAP,
    RADIUS,
    EFFECTIVE_MODULUS,
    YIELD_STRENGTH,
    TARGET_IMPEDANCE,
    GRAVITY,
    LOADING_SEGMENTS,
    UNLOADING_SEGMENTS,
    EXTERNAL_FORCE,
    SUPPORT_VELOCITY,
    INDENTATION,
    RELATIVE_VELOCITY,
    IMPACTOR_VELOCITY,
    IMPACTOR_DISPLACEMENT,
    TARGET_DISPLACEMENT,
    TARGET_VELOCITY,
    IMPACTOR_ACCELERATION,
    CONTACT_FORCE,
    PHASE,
    STAGE,
    CONTACT_COUNT,
    EVENT_COUNT,
    LAST_EVENT,
    TIME_OF_LAST_EVENT,
    TIME_CONTACT_BEGINS,
    TIME_OF_MAXIMUM_INDENTATION,
    MAXIMUM_INDENTATION,
    MAXIMUM_FORCE,
    TIME_IMPACTOR_STOPS,
    TIME_CONTACT_ENDS,
    REBOUND_VELOCITY,
    PERMANENT_INDENTATION,
    EVENT_INDICATOR_1,
    EVENT_INDICATOR_2,
    EVENT_INDICATOR_3,
    EVENT_INDICATOR_4,
    EVENT_INDICATOR_5,
    VARIABLES,
    SETTABLE = 15 /* parameters and inputs come before this one */
};

enum { IMPACT, CONTACT, KINDS };
enum { ABSENT, PARAMETER, INPUT, OUTPUT };
enum { REAL, WHOLE, ENUMERATION };

static const double RIGID = 1e+30; /* target impedance from which on the target does not move */

typedef struct {
    const char *name, *unit;
    int type, role[KINDS];
    double low, high;
} film_variable;

static const film_variable VARIABLE[VARIABLES] = {
    {"time", "s", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"mass", "kg", REAL, {PARAMETER, ABSENT}, 1e-28, 1000000000000.0},
    {"initial_velocity", "m/s", REAL, {PARAMETER, ABSENT}, -20000.0, 20000.0},
    {"initial_gap", "m", REAL, {PARAMETER, ABSENT}, 0.0, 100000.0},
    {"radius", "m", REAL, {PARAMETER, PARAMETER}, 1e-10, 1000.0},
    {"effective_modulus", "Pa", REAL, {PARAMETER, PARAMETER}, 1.0, 100000000000000.0},
    {"yield_strength", "Pa", REAL, {PARAMETER, PARAMETER}, 1.0, 10000000000000.0},
    {"target_impedance", "N*s/m", REAL, {PARAMETER, ABSENT}, 1e-30, 1e+30},
    {"gravity", "m/s^2", REAL, {PARAMETER, ABSENT}, -1000000000.0, 1000000000.0},
    {"loading_segments", "", WHOLE, {PARAMETER, ABSENT}, 1.0, 1000000.0},
    {"unloading_segments", "", WHOLE, {PARAMETER, ABSENT}, 1.0, 1000000.0},
    {"external_force", "N", REAL, {INPUT, ABSENT}, -1e300, 1e300},
    {"support_velocity", "m/s", REAL, {INPUT, ABSENT}, -1e300, 1e300},
    {"indentation", "m", REAL, {OUTPUT, INPUT}, -1e300, 1e300},
    {"relative_velocity", "m/s", REAL, {OUTPUT, INPUT}, -1e300, 1e300},
    {"impactor_velocity", "m/s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"impactor_displacement", "m", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"target_displacement", "m", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"target_velocity", "m/s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"impactor_acceleration", "m/s^2", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"contact_force", "N", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"phase", "", ENUMERATION, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"stage", "", WHOLE, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"contact_count", "", WHOLE, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_count", "", WHOLE, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"last_event", "", ENUMERATION, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"time_of_last_event", "s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"time_contact_begins", "s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"time_of_maximum_indentation", "s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"maximum_indentation", "m", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"maximum_force", "N", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"time_impactor_stops", "s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"time_contact_ends", "s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"rebound_velocity", "m/s", REAL, {OUTPUT, ABSENT}, -1e300, 1e300},
    {"permanent_indentation", "m", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_indicator_1", "", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_indicator_2", "", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_indicator_3", "", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_indicator_4", "", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
    {"event_indicator_5", "", REAL, {OUTPUT, OUTPUT}, -1e300, 1e300},
};

#endif
