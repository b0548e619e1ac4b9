/* What the files of the instance share. */
#ifndef FILM_INSTANCE_PARTS_H
#define FILM_INSTANCE_PARTS_H

#include "instance.h"

/* After an error of the model that the motion cannot go on from. */
int instance_fail(instance *i, const char *function);
/* Send a warning for every assumption of the export that has been found not to hold. */
void instance_announce(instance *i);

/* In functions whose arguments are `i` and `function`. */
#define ALLOW(modes)                                       \
    do {                                                   \
        if (!instance_allows(i, function, modes)) return ERROR; \
    } while (0)

#define NEED(pointer, count)                                                                              \
    do {                                                                                                  \
        if ((count) > 0 && !(pointer)) return instance_error(i, function, "argument %s is NULL", #pointer); \
    } while (0)

#endif
