/* The oracle's data. For the oracle's own files. */
#ifndef ORACLE_INTERNAL_H
#define ORACLE_INTERNAL_H

#include "ref/oracle/early.h"
#include "ref/oracle/oracle.h"
#include "ref/oracle/oracle_tree.h"
#include "ref/oracle/placing.h"

/* Of a world, only `placing` is set. */
struct oracle {
    struct placing *placing; /* NULL: of a scene */
    const struct scene *scene;
    uint8_t *flat; /* per triangle: its vertices are collinear */
    struct tree tree;
    double *coordinate; /* the arrays of soup; in the order of the tree */
    struct early_soup soup;
    struct box *run; /* bounds of each EARLY_MOST triangles of that order */
    const struct early_kernel *kernel;
};

/* Whether a ray is decided: finite but for tmax = INFINITY, and tmin <= tmax. */
bool oracle_takes(const struct ray *ray);

/* Threads for so many parts of the work, at least 1: as many as asked for (0: as OpenMP says), but
 * no more than there are parts. */
int oracle_team(size_t parts, unsigned threads);

#endif
