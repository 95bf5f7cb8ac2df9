/* What counts of the triangles on a ray. For the oracle's own files. */
#ifndef ORACLE_ADMISSION_H
#define ORACLE_ADMISSION_H

#include "ref/oracle/oracle_world.h"
#include "ref/oracle/pair.h"

/* As oracle_admit, of a decided pair. */
enum oracle_admission admission_of(const struct oracle *oracle, const struct ray *ray,
                                   struct ray_mode mode, const struct decided *pair);

#endif
