/* Record of events: the discrete outputs. See model.h. */
#include "model_parts.h"

#include <math.h>
#include <string.h>

static void set_value(model_record *record, unsigned reference, double value) {
    record->value[reference - SETTABLE] = value;
}

static void set_larger(model_record *record, unsigned reference, double value) {
    set_value(record, reference, fmax(record->value[reference - SETTABLE], value));
}

/* The largest force of this contact and of all, and the stresses. */
static void set_largest_force(const model *m, const film_state *state, model_record *record) {
    double force = state->force_peak * m->memory.force;
    set_value(record, MAXIMUM_FORCE, force);
    set_larger(record, LARGEST_FORCE, force);
    model_record_stresses(m, record);
}

double model_indentation(const model *m, const film_state *state) {
    return state->xi - m->curve->compliance * state->force;
}

void model_record_event(const model *m, const film_state *state, double time, double velocity, model_record *record) {
    const model_memory *now = &m->memory;
    double indentation = model_indentation(m, state) * now->length, left = state->xi_free * now->length;
    record->phase = state->phase;
    record->stage = state->branch;
    record->events++;
    record->last_event = state->event;
    set_value(record, TIME_OF_LAST_EVENT, time);
    switch (state->event) {
    case FILM_CONTACT_BEGINS:
        for (unsigned k = SETTABLE; k < VARIABLES; k++)
            if (VARIABLE[k].changes == AT_CONTACTS) set_value(record, k, 0.0);
        record->contacts = state->contacts;
        record->had = 0;
        set_value(record, TIME_CONTACT_BEGINS, time);
        model_judge_touch(m, velocity - now->value[SUPPORT_VELOCITY] - now->recoil * now->velocity, record);
        break;
    case FILM_MAXIMUM_INDENTATION:
        if (!(record->had & HAD_MAXIMUM) || indentation > record->value[MAXIMUM_INDENTATION - SETTABLE]) {
            set_value(record, TIME_OF_MAXIMUM_INDENTATION, time);
            set_value(record, MAXIMUM_INDENTATION, indentation);
            set_larger(record, LARGEST_INDENTATION, indentation);
        }
        record->had |= HAD_MAXIMUM;
        record->validity |= model_validity_at(m, indentation);
        set_largest_force(m, state, record);
        break;
    case FILM_IMPACTOR_STOPS:
        if (!(record->had & HAD_STOP) && state->branch != FILM_FREE) {
            set_value(record, TIME_IMPACTOR_STOPS, time);
            record->had |= HAD_STOP;
        }
        break;
    case FILM_CONTACT_ENDS:
        set_value(record, TIME_CONTACT_ENDS, time);
        set_value(record, REBOUND_VELOCITY, velocity);
        set_value(record, PERMANENT_INDENTATION, left);
        set_largest_force(m, state, record);
        break;
    default: break;
    }
}

int model_has_unreported(const model *m) {
    const model_record *actual = &m->memory.actual, *reported = &m->memory.reported;
    return actual->events != reported->events || actual->phase != reported->phase ||
           actual->value[SLIDING - SETTABLE] != reported->value[SLIDING - SETTABLE] ||
           actual->value[SLIDING_EVENT_COUNT - SETTABLE] != reported->value[SLIDING_EVENT_COUNT - SETTABLE];
}

void model_report(model *m) {
    memcpy(&m->memory.reported, &m->memory.actual, sizeof m->memory.reported);
}
