/* What follows from the largest force and indentation of a contact, by the formulas of film_model/problem/stresses.py with the
 * numbers of model_stresses. See model.h. */
#include "model_parts.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

/* A parameter over its value at the export, on which the numbers are based. */
static double ratio_of(const model *m, int parameter) { return m->memory.value[parameter] / m->data->start[parameter]; }

/* `Pressed` and what follows from it, of law elastoplastic. */
typedef struct {
    double widening, reached, pressure, slope;
} pressed_body;

static pressed_body pressed(const model_stresses *s, double first_radius, double w) {
    double z = (w - 1.0) / s->onset, widening = 1.0 + s->spread * log1p(z * z), radius = sqrt(w * widening);
    double wide = s->pressure_flattened * first_radius * radius, bend = s->pressure_bend;
    double most = s->pressure / (1.0 + wide * sqrt(wide)), bent = 1.0 + (sqrt(w) - 1.0) / (bend * most), fallen = pow(bent, -bend);
    double strained = 1.0 + s->strain * (radius - 1.0) * (radius - 1.0) / radius, hardened = pow(strained, s->hardens);
    double mean = 1.0 + most * (1.0 - fallen);
    double slope = fallen / bent + mean * s->hardens * s->strain * (1.0 - 1.0 / (radius * radius)) / strained;
    return (pressed_body){widening, 1.0 - pow(1.0 + z * z, -s->lateness), mean * hardened, slope * hardened};
}

static double part_of(double end, double reached) { return 1.0 - (1.0 - end) * reached; }

static double radius_of(const model_stresses *s, pressed_body now, double w) {
    double excess = part_of(s->sunk, now.reached) * now.widening - part_of(s->flattened, now.reached);
    double half = 0.5 * s->share * now.pressure * excess;
    return sqrt(now.widening * w + half * half) - half;
}

/* The contact radius over that at first yield. */
static double plastic_radius(const model_stresses *s, double first_radius, double w) {
    pressed_body now = pressed(s, first_radius, w);
    double flat = s->share * part_of(s->flattened, now.reached), own = sqrt(now.widening * w);
    double missing = radius_of(s, now, w) - (1.0 - s->share) * own - flat * now.pressure;
    double longer = 1.0 + missing / (1.0 - s->share + flat * now.slope) / own;
    if (s->share > 0.0) now = pressed(s, first_radius, w * longer * longer);
    return radius_of(s, now, w);
}

/* a^2/(R delta) of a contact that is not Hertz's; 0: unknown. */
static double widening(const model *m, double radius, double indentation) {
    const model_stresses *s = &m->data->stresses;
    if (s->widening > 0.0) return fmin(s->widening, radius / indentation);
    double root = s->first_radius * ratio_of(m, YIELD_STRENGTH) / ratio_of(m, EFFECTIVE_MODULUS), first = root * root * radius;
    if (!(first > 0.0)) return 0.0;
    double w = fmax(indentation / first, 1.0), wide = plastic_radius(s, root, w);
    return fmin(wide * wide / w, radius / indentation);
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
