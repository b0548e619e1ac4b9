/* A sentence for each failure of the core. Generated from film_model/base/errors.py; do not edit. */
#ifndef FILM_FAILURES_H
#define FILM_FAILURES_H

static inline const char *film_failure(int status) {
    switch (status) {
    case -1: return "a value of this impact is outside the solver's range";
    case -2: return "the law's curve is invalid: its stages must join without a gap";
    case -3: return "the number of segments is outside the solver's range";
    case -4: return "the indentation passed the end of the law's last stage: the law cannot stop this impactor";
    case -5: return "the motion needs more segments than are allowed: ask for fewer segments or for a shorter step";
    case -6: return "the law's unloading from the maximum indentation has zero length";
    case -7: return "the motion has more segments or events than the caller's arrays can hold";
    case -8: return "the law's force at first touch exceeds the target's impedance times the impact velocity";
    case -9: return "the indentation grows again before contact ends, for which viscoelastic contact is not solved: viscoelasticity = false in [effects] takes the instantaneous modulus";
    case -10: return "a contact begins before the viscoelastic material has forgotten the one before, which is not solved: viscoelasticity = false in [effects] takes the instantaneous modulus";
    default: return "unknown status";
    }
}

#endif
