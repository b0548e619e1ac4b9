/* The variables, by value reference. Generated from fmu_wrapper/variables.csv; do not edit. */
#ifndef FILM_VARIABLES_H
#define FILM_VARIABLES_H

enum {
    TIME, MASS, INITIAL_VELOCITY, INITIAL_GAP, RADIUS, EFFECTIVE_MODULUS, YIELD_STRENGTH, YIELD_PRESSURE, HARDNESS,
    STIFFNESS, POWER_STIFFNESS, EXPONENT, DAMPING, DISSIPATION_TIME, HYSTERESIS_DAMPING, RESTITUTION, TARGET_IMPEDANCE,
    TARGET_STIFFNESS, GRAVITY, FRICTION, INITIAL_TANGENTIAL_VELOCITY, INITIAL_SPIN, INPUT_EXTRAPOLATION,
    LOADING_SEGMENTS, UNLOADING_SEGMENTS, EXTERNAL_FORCE, SUPPORT_VELOCITY, TANGENTIAL_FORCE, TORQUE,
    TANGENTIAL_SUPPORT_VELOCITY, INDENTATION, RELATIVE_VELOCITY, IMPACTOR_VELOCITY, IMPACTOR_DISPLACEMENT,
    TARGET_DISPLACEMENT, TARGET_VELOCITY, IMPACTOR_ACCELERATION, CONTACT_FORCE, KINETIC_ENERGY, MEAN_CONTACT_FORCE,
    CONTACT_IMPULSE, CONTACT_ENERGY, TARGET_ENERGY, EXTERNAL_WORK, SLIDING_DISPLACEMENT, SLIDING_VELOCITY,
    TANGENTIAL_VELOCITY, SPIN, FRICTION_FORCE, TANGENTIAL_IMPULSE, FRICTION_WORK, SLIDING, SLIDING_EVENT_COUNT,
    LAST_SLIDING_EVENT, TIME_OF_LAST_SLIDING_EVENT, PHASE, STAGE, CONTACT_COUNT, EVENT_COUNT, LAST_EVENT,
    TIME_OF_LAST_EVENT, TIME_CONTACT_BEGINS, TIME_OF_MAXIMUM_INDENTATION, MAXIMUM_INDENTATION, MAXIMUM_FORCE,
    TIME_IMPACTOR_STOPS, TIME_CONTACT_ENDS, REBOUND_VELOCITY, PERMANENT_INDENTATION, CONTACT_RADIUS, DENT_DIAMETER,
    MEAN_PRESSURE, PEAK_PRESSURE, MAXIMUM_SHEAR_STRESS, MAXIMUM_VON_MISES_STRESS, DEPTH_OF_MAXIMUM_STRESS,
    LARGEST_FORCE, LARGEST_INDENTATION, PHASE_CODE, LAST_EVENT_CODE, VALIDITY, RATE_OF_INDENTATION,
    RATE_OF_IMPACTOR_VELOCITY, RATE_OF_TARGET_DISPLACEMENT, RATE_OF_TANGENTIAL_VELOCITY, RATE_OF_SPIN,
    EVENT_INDICATOR_1, EVENT_INDICATOR_2, EVENT_INDICATOR_3, EVENT_INDICATOR_4, EVENT_INDICATOR_5, VARIABLES,
    SETTABLE = 32 /* parameters and inputs come before this one */
};

enum { IMPACT, CONTACT, KINDS };
enum { ABSENT, PARAMETER, INPUT, OUTPUT };
enum { REAL, WHOLE, ENUMERATION };
enum { ANY_TIME, IN_MODEL_EXCHANGE, AT_STEPS, AT_EVENTS, AT_CONTACTS }; /* when a real one changes: CHANGES in variables.py */

static const double RIGID = 1e+30; /* N s/m: a target with this impedance or more does not move */

/* by: the inputs and states that it depends on directly, and those if the law is damped: sums of BY. */
#define BY(reference) (1u << ((reference) - EXTERNAL_FORCE))
typedef struct {
    const char *name, *unit;
    int type, changes, tunable, role[KINDS];
    double low, high;
    unsigned by[KINDS], by_if_damped[KINDS];
} film_variable;

static const film_variable VARIABLE[VARIABLES] = {
    {"time", "s", REAL, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"mass", "kg", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, 1e-28, 1000000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"initial_velocity", "m/s", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, -20000.0, 20000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"initial_gap", "m", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, 0.0, 100000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"radius", "m", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1e-10, 1000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"effective_modulus", "Pa", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1.0, 100000000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"yield_strength", "Pa", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1.0, 10000000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"yield_pressure", "Pa", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1.0, 10000000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"hardness", "Pa", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1.0, 10000000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"stiffness", "N/m", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1e-12, 1e+18, {0x0, 0x0}, {0x0, 0x0}},
    {"power_stiffness", "", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 1e-30, 1e+30, {0x0, 0x0}, {0x0, 0x0}},
    {"exponent", "", REAL, ANY_TIME, 0, {PARAMETER, PARAMETER}, 0.1, 10.0, {0x0, 0x0}, {0x0, 0x0}},
    {"damping", "N*s/m", REAL, ANY_TIME, 1, {PARAMETER, PARAMETER}, 1e-30, 1e+30, {0x0, 0x0}, {0x0, 0x0}},
    {"dissipation_time", "s", REAL, ANY_TIME, 1, {PARAMETER, PARAMETER}, 1e-30, 10000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"hysteresis_damping", "s/m", REAL, ANY_TIME, 1, {PARAMETER, PARAMETER}, 1e-30, 1e+30, {0x0, 0x0}, {0x0, 0x0}},
    {"restitution", "", REAL, ANY_TIME, 1, {PARAMETER, PARAMETER}, 0.01, 1.0, {0x0, 0x0}, {0x0, 0x0}},
    {"target_impedance", "N*s/m", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, 1e-30, 1e+30, {0x0, 0x0}, {0x0, 0x0}},
    {"target_stiffness", "N/m", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, 1e-12, 1e+18, {0x0, 0x0}, {0x0, 0x0}},
    {"gravity", "m/s^2", REAL, ANY_TIME, 1, {PARAMETER, ABSENT}, -1000000000.0, 1000000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"friction", "", REAL, ANY_TIME, 1, {PARAMETER, ABSENT}, 0.0, 100.0, {0x0, 0x0}, {0x0, 0x0}},
    {"initial_tangential_velocity", "m/s", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, -20000.0, 20000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"initial_spin", "rad/s", REAL, ANY_TIME, 0, {PARAMETER, ABSENT}, -10000000.0, 10000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"input_extrapolation", "", REAL, ANY_TIME, 0, {ABSENT, PARAMETER}, 0.0, 2.0, {0x0, 0x0}, {0x0, 0x0}},
    {"loading_segments", "", WHOLE, ANY_TIME, 0, {PARAMETER, ABSENT}, 1.0, 1000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"unloading_segments", "", WHOLE, ANY_TIME, 0, {PARAMETER, ABSENT}, 1.0, 1000000.0, {0x0, 0x0}, {0x0, 0x0}},
    {"external_force", "N", REAL, ANY_TIME, 0, {INPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"support_velocity", "m/s", REAL, ANY_TIME, 0, {INPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"tangential_force", "N", REAL, ANY_TIME, 0, {INPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"torque", "N*m", REAL, ANY_TIME, 0, {INPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"tangential_support_velocity", "m/s", REAL, ANY_TIME, 0, {INPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"indentation", "m", REAL, ANY_TIME, 0, {OUTPUT, INPUT}, -1e300, 1e300, {0x20, 0x0}, {0x0, 0x0}},
    {"relative_velocity", "m/s", REAL, ANY_TIME, 0, {OUTPUT, INPUT}, -1e300, 1e300, {0xa2, 0x0}, {0x0, 0x0}},
    {"impactor_velocity", "m/s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x80, 0x0}, {0x0, 0x0}},
    {"impactor_displacement", "m", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x220, 0x0}, {0x0, 0x0}},
    {"target_displacement", "m", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x200, 0x0}, {0x0, 0x0}},
    {"target_velocity", "m/s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x22, 0x0}, {0x80, 0x0}},
    {"impactor_acceleration", "m/s^2", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x21, 0x0}, {0x82, 0x0}},
    {"contact_force", "N", REAL, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x20, 0x20}, {0x82, 0x40}},
    {"kinetic_energy", "J", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x80, 0x0}, {0x0, 0x0}},
    {"mean_contact_force", "N", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"contact_impulse", "N*s", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"contact_energy", "J", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"target_energy", "J", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"external_work", "J", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"sliding_displacement", "m", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x80000, 0x0}, {0x0, 0x0}},
    {"sliding_velocity", "m/s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x600010, 0x0}, {0x0, 0x0}},
    {"tangential_velocity", "m/s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x200000, 0x0}, {0x0, 0x0}},
    {"spin", "rad/s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x400000, 0x0}, {0x0, 0x0}},
    {"friction_force", "N", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x6800b2, 0x0}, {0x0, 0x0}},
    {"tangential_impulse", "N*s", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x1000000, 0x0}, {0x0, 0x0}},
    {"friction_work", "J", REAL, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x6800b2, 0x0}, {0x0, 0x0}},
    {"sliding", "", ENUMERATION, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"sliding_event_count", "", WHOLE, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"last_sliding_event", "", ENUMERATION, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_of_last_sliding_event", "s", REAL, AT_STEPS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"phase", "", ENUMERATION, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"stage", "", WHOLE, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"contact_count", "", WHOLE, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"event_count", "", WHOLE, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"last_event", "", ENUMERATION, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_of_last_event", "s", REAL, AT_EVENTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_contact_begins", "s", REAL, AT_CONTACTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_of_maximum_indentation", "s", REAL, AT_CONTACTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"maximum_indentation", "m", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"maximum_force", "N", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_impactor_stops", "s", REAL, AT_CONTACTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"time_contact_ends", "s", REAL, AT_CONTACTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"rebound_velocity", "m/s", REAL, AT_CONTACTS, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"permanent_indentation", "m", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"contact_radius", "m", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"dent_diameter", "m", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"mean_pressure", "Pa", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"peak_pressure", "Pa", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"maximum_shear_stress", "Pa", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"maximum_von_mises_stress", "Pa", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"depth_of_maximum_stress", "m", REAL, AT_CONTACTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"largest_force", "N", REAL, AT_EVENTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"largest_indentation", "m", REAL, AT_EVENTS, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"phase_code", "", WHOLE, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"last_event_code", "", WHOLE, ANY_TIME, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"validity", "", WHOLE, ANY_TIME, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"rate_of_indentation", "m/s", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0xa2, 0x0}, {0x0, 0x0}},
    {"rate_of_impactor_velocity", "m/s^2", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x21, 0x0}, {0x82, 0x0}},
    {"rate_of_target_displacement", "m/s", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x22, 0x0}, {0x80, 0x0}},
    {"rate_of_tangential_velocity", "m/s^2", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x6800b6, 0x0}, {0x0, 0x0}},
    {"rate_of_spin", "rad/s^2", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, ABSENT}, -1e300, 1e300, {0x6800ba, 0x0}, {0x0, 0x0}},
    {"event_indicator_1", "", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"event_indicator_2", "", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"event_indicator_3", "", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"event_indicator_4", "", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
    {"event_indicator_5", "", REAL, IN_MODEL_EXCHANGE, 0, {OUTPUT, OUTPUT}, -1e300, 1e300, {0x0, 0x0}, {0x0, 0x0}},
};

#endif
