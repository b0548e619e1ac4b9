/* Bodies of functions that fmi2.c and fmi3.c share; both define STATUS, the type of what these return. */
#ifndef FILM_FMI_CALLS_H
#define FILM_FMI_CALLS_H

#include "instance.h"

#define HERE __func__
#define SELF instance *i = c; if (!i) return (STATUS)ERROR
#define FAIL(...) (STATUS)instance_error(i, HERE, __VA_ARGS__)
#define NEED(pointer, count) \
    if ((count) > 0 && !(pointer)) return FAIL("argument %s is NULL", #pointer)
#define FORWARD(declaration, call) \
    STATUS declaration {           \
        SELF;                      \
        return (STATUS)call;       \
    }
#define GET_ALL(references, count, values, value_type, kind, or_kind)                                                 \
    NEED(references, count);                                                                                          \
    NEED(values, count);                                                                                              \
    for (size_t k = 0; k < (count); k++) {                                                                            \
        double number;                                                                                                \
        if (instance_get(i, HERE, (references)[k], kind, or_kind, &number) != GOOD) return (STATUS)ERROR;             \
        (values)[k] = (value_type)number;                                                                             \
    }                                                                                                                 \
    return (STATUS)GOOD
#define SET_ALL(references, count, values, modes, kind, or_kind)                                                      \
    if (!instance_allows(i, HERE, modes)) return (STATUS)ERROR;                                                       \
    NEED(references, count);                                                                                          \
    NEED(values, count);                                                                                              \
    for (size_t k = 0; k < (count); k++)                                                                              \
        if (instance_set(i, HERE, (references)[k], kind, or_kind, (double)(values)[k]) != GOOD) return (STATUS)ERROR; \
    return (STATUS)GOOD

#endif
