/* Whether the assumptions of the export hold: see `valid` and `limit` of model_data. */
#include "model_parts.h"

#include <math.h>
#include <stdio.h>

enum { TOUCH = 16 }; /* of what has been logged: that the velocity of a contact is outside */

static double limit_of(const model *m, int which) {
    return model_scaled(m, m->data->limit[which], m->data->limit_power[which], SCALINGS);
}

int model_validity_at(const model *m, double indentation) {
    return (indentation > limit_of(m, 0) ? YIELDS : 0) | (indentation > limit_of(m, 1) ? WIDE : 0);
}

static int is_beyond(const model *m, int parameter, double value) {
    const double *valid = m->data->valid[parameter], *also = m->data->also;
    if (parameter == INITIAL_VELOCITY && value >= also[0] && value <= also[1]) return 0;
    return m->data->kind == IMPACT && m->data->available[parameter] && (value < valid[0] || value > valid[1]);
}

/* The initial velocity is judged at first touch. */
static int is_outside(const model *m, int parameter) {
    return parameter != INITIAL_VELOCITY && is_beyond(m, parameter, m->memory.value[parameter]);
}

int model_validity_of_parameters(const model *m) {
    for (int k = 0; k < SETTABLE; k++)
        if (is_outside(m, k)) return OUTSIDE;
    return 0;
}

void model_judge_touch(const model *m, double speed, model_record *record) {
    if (!(speed > 0.0) || !is_beyond(m, INITIAL_VELOCITY, speed)) return;
    record->validity |= OUTSIDE;
    if (record->outside_contact) return;
    record->outside_contact = record->contacts;
    record->outside_speed = speed;
}

static int announce_beyond(const model *m, int parameter, double value, const char *when, char *text, size_t room) {
    const double *valid = m->data->valid[parameter];
    const char *unit = VARIABLE[parameter].unit;
    return snprintf(text, room, "%s: %g %s%s is outside the range of validity, from %g to %g %s; what is not simulated but "
                    "matters: %s", VARIABLE[parameter].name, value, unit, when, valid[0], valid[1], unit,
                    m->data->reason[parameter][value > valid[1]]);
}

static int announce_outside(const model *m, char *text, size_t room) {
    for (int k = 0; k < SETTABLE; k++)
        if (is_outside(m, k)) return announce_beyond(m, k, m->memory.value[k], "", text, room);
    return 0;
}

int model_announce(model *m, char *text, size_t room) {
    model_memory *now = &m->memory;
    if (now->actual.outside_contact && !(now->announced & TOUCH)) {
        char when[48];
        now->announced |= TOUCH;
        snprintf(when, sizeof when, " at first touch of contact %d", (int)now->actual.outside_contact);
        return announce_beyond(m, INITIAL_VELOCITY, now->actual.outside_speed, when, text, room) > 0;
    }
    int news = now->actual.validity & ~now->announced;
    now->announced |= news & OUTSIDE;
    if (news & OUTSIDE && announce_outside(m, text, room) > 0) return 1;
    news &= ~OUTSIDE;
    if (news & COARSE) {
        now->announced |= COARSE;
        return snprintf(text, room, "a contact lasted %d communication steps; with fewer than %d the bodies may gain 1 %% of "
                        "their velocity and more: ask for shorter steps", (int)now->actual.coarse, (int)FEWEST_STEPS) > 0;
    }
    if (!news) return 0;
    int which = news & YIELDS ? 0 : 1;
    now->announced |= which == 0 ? YIELDS : WIDE;
    snprintf(text, room, which == 0 ? "the indentation exceeds %g m, where the contact yields, but the law is elastic"
                                    : "the indentation exceeds %g m, where the contact is too wide for the law",
             limit_of(m, which));
    return 1;
}
