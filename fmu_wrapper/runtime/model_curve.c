/* The curve of the law for the parameters: of a law with a family of curves, that of their shape. See model.h. */
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

int model_update_curve(model *m) {
    const model_family *family = &m->data->family;
    double shape = family->nodes > 0 ? shape_of(m) : family->shape;
    const film_curve *whole = (const film_curve *)(m->data + 1);
    if (shape == family->shape) { /* as exported */
        m->curve = &m->data->curve;
        return 0;
    }
    if (!(shape >= family->low && shape <= family->high))
        return model_error(m, "the parameters give the law a shape (yield_strength/effective_modulus) of %g; this FMU was "
                              "exported for shapes from %g to %g", shape, family->low, family->high);
    if (!m->own && !(m->own = malloc(sizeof *m->own))) return model_error(m, "no memory for the curve of the law");
    film_family numbers = {family->low, family->high, family->nodes, family->varying, (const double *)(whole + 1)};
    memcpy(m->own, whole, sizeof *whole);
    int status = film_shape(&numbers, whole, shape, m->own);
    if (status == FILM_OK) status = film_check_curve(m->own);
    if (status < 0) return model_core_error(m, status);
    m->curve = m->own;
    return 0;
}
