/* The curve of the law for the parameters: of a law with a family of curves, that of their shape; on a target with a static
 * stiffness, in series with a spring. See model.h. */
#include "model_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The shape for the current parameters: shape * prod (p/start)^power. */
static double shape_of(const model *m) {
    static const int by[SHAPE_POWERS] = {RADIUS, EFFECTIVE_MODULUS, YIELD_STRENGTH};
    const model_family *family = &m->data->family;
    double shape = family->shape;
    for (int k = 0; k < SHAPE_POWERS; k++) {
        double ratio = family->power[k] == 0.0 ? 1.0 : m->memory.value[by[k]] / m->data->start[by[k]];
        if (ratio != 1.0) shape *= pow(ratio, family->power[k]);
    }
    return shape;
}

/* That of the target's static stiffness, in the core's units; 0 without one, and before initialization. */
static double compliance_of(const model *m) {
    const model_memory *now = &m->memory;
    return sprung(m) && now->length > 0.0 ? now->force / (now->length * now->value[TARGET_STIFFNESS]) : 0.0;
}

/* Another exponent of a law whose force is a power in all stages. */
static int put_exponent(model *m, double exponent, film_curve *curve) {
    for (int32_t i = 0; i < curve->stages; i++) {
        const film_stage *stage = &curve->stage[i];
        for (int32_t k = stage->first; k < stage->first + stage->count; k++) {
            film_piece *piece = &curve->piece[k];
            film_function *force = &piece->force;
            if (stage->unloading != FILM_RETRACE && exponent > piece->exponent.constant)
                return model_error(m, "exponent: %g must be at most %g, that of unloading: the contact would give energy", exponent,
                                   piece->exponent.constant);
            if (force->coefficient == 0.0) continue; /* without force */
            force->exponent = exponent;
            piece->work_at_begin = force->coefficient * pow(stage->begin - force->origin, exponent + 1.0) / (exponent + 1.0);
        }
    }
    return 0;
}

int model_update_curve(model *m) {
    const model_family *family = &m->data->family;
    double shape = family->nodes > 0 ? shape_of(m) : family->shape;
    const film_curve *whole = (const film_curve *)(m->data + 1);
    int own_shape = shape == family->shape;
    double exponent = m->memory.value[EXPONENT];
    int own_exponent = !m->data->available[EXPONENT] || exponent == m->data->start[EXPONENT];
    double compliance = compliance_of(m);
    if (own_shape && own_exponent && compliance == 0.0) { /* as exported */
        m->curve = &m->data->curve;
        return 0;
    }
    if (!own_shape && !(shape >= family->low && shape <= family->high))
        return model_error(m, "the parameters give the law a shape (yield_strength/effective_modulus) of %g; this FMU was "
                              "exported for shapes from %g to %g", shape, family->low, family->high);
    if (!m->own && !(m->own = malloc(sizeof *m->own))) return model_error(m, "no memory for the curve of the law");
    film_family numbers = {family->low, family->high, family->nodes, family->varying, (const double *)(whole + 1)};
    memcpy(m->own, own_shape ? &m->data->curve : whole, sizeof *m->own);
    int status = own_shape ? FILM_OK : film_shape(&numbers, whole, &shape, m->own);
    if (!own_exponent && put_exponent(m, exponent, m->own) < 0) return -1;
    if (status == FILM_OK) status = film_check_curve(m->own);
    if (status < 0) return model_core_error(m, status);
    if (compliance > 0.0 && film_spring(m->own, compliance) < 0)
        return model_error(m, "target_stiffness: with %g N/m the contact would snap through, because the law's force falls faster "
                              "with the indentation", m->memory.value[TARGET_STIFFNESS]);
    m->curve = m->own;
    return 0;
}
