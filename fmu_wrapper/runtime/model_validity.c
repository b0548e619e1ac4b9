/* Whether the assumptions of the export hold: see `valid` and `limit` of model_data. */
#include "model_parts.h"

#include <math.h>
#include <stdio.h>

enum { MOST_PREDICTED_EVENTS = 64 }; /* before the first maximum indentation: touch and changes of stage */

static double limit_of(const model *m, int which) {
    return model_scaled(m, m->data->limit[which], m->data->limit_power[which], SCALINGS);
}

int model_validity_at(const model *m, double indentation) {
    return (indentation > limit_of(m, 0) ? YIELDS : 0) | (indentation > limit_of(m, 1) ? WIDE : 0);
}

/* The parameter's value; for the velocity, that at first touch, which the weight and the external force have changed. */
static double compared(const model *m, int parameter) {
    const double *value = m->memory.value;
    if (parameter != INITIAL_VELOCITY) return value[parameter];
    double speed = value[INITIAL_VELOCITY] - value[SUPPORT_VELOCITY];
    double pull = value[GRAVITY] + value[EXTERNAL_FORCE] / value[MASS];
    double square = speed * fabs(speed) + 2.0 * pull * value[INITIAL_GAP];
    return square > 0.0 ? sqrt(square) : 0.0;
}

static int is_outside(const model *m, int parameter) {
    const double *valid = m->data->valid[parameter];
    double value = compared(m, parameter);
    return m->data->kind == IMPACT && m->data->available[parameter] && (value < valid[0] || value > valid[1]);
}

int model_predict_validity(model *m) {
    int found = 0;
    film_state ahead = m->memory.state;
    if (m->data->kind == CONTACT) return 0;
    for (int k = 0; k < SETTABLE; k++)
        if (is_outside(m, k)) found = OUTSIDE;
    if (vibrates(m) || relaxes(m)) return found; /* the rest is said when it happens */
    for (int k = 0; k < MOST_PREDICTED_EVENTS; k++) {
        if (film_step(m->curve, &m->mesh, &ahead, INFINITY) != FILM_EVENT) break;
        if (ahead.event == FILM_MAXIMUM_INDENTATION) return found | model_validity_at(m, model_indentation(m, &ahead) * m->memory.length);
        if (ahead.event == FILM_CONTACT_ENDS) break;
    }
    return found;
}

static int announce_outside(const model *m, char *text, size_t room) {
    for (int k = 0; k < SETTABLE; k++) {
        const double *valid = m->data->valid[k];
        double value = compared(m, k);
        if (!is_outside(m, k)) continue;
        return snprintf(text, room, "%s: %g %s%s is outside the range of validity, from %g to %g %s; what is not simulated but "
                        "matters: %s", VARIABLE[k].name, value, VARIABLE[k].unit, k == INITIAL_VELOCITY ? " at first touch" : "",
                        valid[0], valid[1], VARIABLE[k].unit, m->data->reason[k][value > valid[1]]);
    }
    return 0;
}

int model_announce(model *m, char *text, size_t room) {
    model_memory *now = &m->memory;
    int news = now->actual.validity & ~now->announced;
    if (!news) return 0;
    if (news & OUTSIDE) {
        now->announced |= OUTSIDE;
        return announce_outside(m, text, room) > 0;
    }
    int which = news & YIELDS ? 0 : 1;
    now->announced |= which == 0 ? YIELDS : WIDE;
    snprintf(text, room, which == 0 ? "the indentation exceeds %g m, where the contact yields, but the law is elastic"
                                    : "the indentation exceeds %g m, where the contact is too wide for the law",
             limit_of(m, which));
    return 1;
}
