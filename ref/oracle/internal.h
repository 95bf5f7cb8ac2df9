/* What an oracle owns. For the oracle's own files. */
#ifndef ORACLE_INTERNAL_H
#define ORACLE_INTERNAL_H

#include "ref/oracle/oracle.h"

struct oracle {
    const struct scene *scene;
    uint8_t *flat; /* per triangle: its vertices are collinear */
};

/* Whether a ray is decided at all: finite but for tmax = INFINITY, and tmin <= tmax. */
bool oracle_takes(const struct ray *ray);

#endif
