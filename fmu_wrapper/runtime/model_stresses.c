/* What follows from the largest force and indentation of a contact, by the formulas of film_model/problem/stresses.py with the
 * numbers of model_stresses. See model.h. */
#include "model_parts.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* A parameter over its value at the export, on which the numbers are based. */
static double ratio_of(const model *m, int parameter) { return m->memory.value[parameter] / m->data->start[parameter]; }

/* a^2/(R delta) of a contact that is not Hertz's; 0: unknown. */
static double widening(const model *m, double radius, double indentation) {
    const model_stresses *s = &m->data->stresses;
    if (s->widening > 0.0) return fmin(s->widening, radius / indentation);
    double root = s->first_radius * ratio_of(m, YIELD_STRENGTH) / ratio_of(m, EFFECTIVE_MODULUS), first = root * root * radius;
    if (!(first > 0.0)) return 0.0;
    double beyond = (fmax(indentation / first, 1.0) - 1.0) / s->onset;
    return fmin(1.0 + s->spread * log1p(beyond * beyond), radius / indentation);
}

static double *output(model_record *record, unsigned reference) { return &record->value[reference - SETTABLE]; }

void model_record_stresses(const model *m, model_record *record) {
    const model_stresses *s = &m->data->stresses;
    double force = *output(record, MAXIMUM_FORCE), deepest = *output(record, MAXIMUM_INDENTATION);
    double curvature = ratio_of(m, RADIUS), stiffness = s->hertz * ratio_of(m, EFFECTIVE_MODULUS) * sqrt(curvature);
    double radius = s->radius * curvature, hertz = stiffness * deepest * sqrt(deepest);
    for (unsigned k = CONTACT_RADIUS; k <= DEPTH_OF_MAXIMUM_STRESS; k++) *output(record, k) = 0.0;
    if (!(hertz > 0.0)) return;
    if (relaxes(m)) { /* on the way in, the contact is as wide as Hertz's; its largest force comes before the turn */
        *output(record, CONTACT_RADIUS) = sqrt(radius * deepest);
        return;
    }
    int elastic = fabs(force - hertz) <= s->hertzian * hertz;
    double square = radius * deepest * (elastic ? 1.0 : widening(m, radius, deepest)), a = sqrt(square);
    if (!(square > 0.0)) return;
    *output(record, CONTACT_RADIUS) = a;
    if (*output(record, PERMANENT_INDENTATION) > s->shallow * deepest) *output(record, DENT_DIAMETER) = 2.0 * a;
    if (damped(m)) return; /* its largest force is not that at the largest indentation */
    double mean = force / (PI * square), peak = elastic ? 1.5 * mean : 0.0;
    *output(record, MEAN_PRESSURE) = mean;
    *output(record, PEAK_PRESSURE) = peak;
    *output(record, MAXIMUM_SHEAR_STRESS) = s->shear * peak;
    *output(record, MAXIMUM_VON_MISES_STRESS) = 2.0 * s->shear * peak;
    *output(record, DEPTH_OF_MAXIMUM_STRESS) = elastic ? s->depth * a : 0.0;
}
