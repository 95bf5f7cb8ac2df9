/* Whether a file's instances and triangles are those of a world. */
#ifndef DUMP_WORLD_H
#define DUMP_WORLD_H

#include "ref/dump/tree_dump.h"
#include "ref/world/world.h"

#define DUMP_NO_NUMBER UINT32_MAX

struct dump_differences {
    uint32_t instances; /* missing, not of the world, or with other numbers than it has */
    uint32_t triangles; /* the same, of the trees of instances, each tree once */
    uint32_t instance;  /* the first such instance, or that of the first such triangle's tree */
    struct dump_source triangle; /* that triangle; geometry DUMP_NO_NUMBER: there is none */
};

/* Compares the instances of a top level, transforms bit for bit, and the vertices of their trees
 * with a world's; of a bottom level its triangles with those of the only mesh of the world. An
 * instance without a mesh need not be there. Errors: STATUS_INPUT a bottom level, and a world of
 * several meshes; STATUS_MEMORY. */
enum status dump_compare(const struct tree_dump *dump, const struct world *world,
                         struct dump_differences *out, struct reason *reason) MUST_USE;

#endif
