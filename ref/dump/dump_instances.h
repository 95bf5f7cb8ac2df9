/* Instances of a top level that a file has, and how well their boxes contain them. */
#ifndef DUMP_INSTANCES_H
#define DUMP_INSTANCES_H

#include "ref/dump/tree_dump.h"
#include "ref/integers/fraction.h"

/* Makes `scene` of a top level: for each item a triangle whose bounds are the least box of float32
 * numbers that contains M v + T of all vertices of the instance's triangles. Of an instance without
 * triangles it is the point T; `scene` stays empty if a tree is not in the file, or if an instance
 * reaches beyond float32. Errors: STATUS_MEMORY. */
enum status dump_place(struct tree_dump *dump, struct reason *reason) MUST_USE;

/* A side of an instance's box, and what it lacks. */
struct dump_lack {
    uint32_t item;
    unsigned side;  /* 0-2 least x y z, 3-5 most */
    float bound;    /* where the box ends */
    uint32_t steps; /* floats from there to the least box */
    double lacks;   /* how far the exact vertex is beyond the bound, rounded */
    /* The same in units of 2^-24 times the sum of sizes |M_k0| a_0 + |M_k1| a_1 + |M_k2| a_2 +
     * |T_k|, a the largest |coordinate| of the mesh's vertices, or of 2^-24 2^-149 if that is 0:
     * exactly, and rounded. */
    struct fraction exact;
    double u;
};

/* A side of an instance's box that lacks something. */
struct dump_side {
    uint32_t item;
    unsigned side;
    float bound;
};

/* What a top level lacks. */
struct dump_lacks {
    uint32_t judged; /* boxes of instances with triangles */
    uint32_t small;  /* boxes that lack something */
    uint32_t sides;
    uint32_t most_steps;
    struct dump_lack most;  /* the side that lacks most u; if sides > 0 */
    struct dump_side *side; /* all `sides` of them; the caller frees it */
};

/* Measures the box of each leaf that the root leads to against the vertices M v + T of real
 * numbers. The dump has a scene from dump_place. Errors: STATUS_MEMORY; *out is then zero. */
enum status dump_measure(const struct tree_dump *dump, struct dump_lacks *out,
                         struct reason *reason) MUST_USE;

#endif
