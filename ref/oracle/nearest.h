/* The nearest hits of one ray, found from triangles in any order. For the oracle's own files. */
#ifndef ORACLE_NEAREST_H
#define ORACLE_NEAREST_H

#include "ref/oracle/pair.h"

/* The set of triangles at the smallest t so far, and what lies behind. The result does not depend
 * on the order of the triangles, nor on triangles behind nearest_reach. */
struct nearest {
    struct decided rep;      /* one of the set, with which each new t is compared */
    uint32_t prim, count;    /* smallest index and size of the set; count 0: empty */
    double prim_lo, prim_hi; /* enclosure of t of `prim` */
    double least_lo;         /* smallest t_lo in the set */
    double margin;           /* smallest in the set */
    enum oracle_class class; /* of `prim` */
    bool exact;              /* one of the set left the filter */
    double next;             /* smallest t_lo of the hits behind the set */
    double plane_lo;         /* smallest t_lo of the intervals in a plane */
};

void nearest_start(struct nearest *nearest);

/* Adds a decided pair of any class; what is no hit in range changes nothing. */
void nearest_add(struct nearest *nearest, const struct ray *ray, enum oracle_ends ends,
                 struct decided *pair);

/* No triangle whose exact t is above this can change the answer. */
double nearest_reach(const struct nearest *nearest);

void nearest_finish(const struct nearest *nearest, struct oracle_answer *out);

#endif
