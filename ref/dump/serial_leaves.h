/* Leaves of serialised structures as the items of a dump. For the readers of drivers' structures.
 *
 * The words of a leaf are at other places in each driver's structures, and mean the same. */
#ifndef SERIAL_LEAVES_H
#define SERIAL_LEAVES_H

#include "ref/dump/serialised.h"

/* Where words of leaves are, in bytes. The three vertices of a triangle come first. */
struct serial_places {
    size_t number, geometry;                  /* of a triangle; 28 bits of the latter, then flags */
    size_t custom, back, instance, transform; /* of an instance; the custom index has 24 bits, then
                                               * comes the mask; two matrices of 3 rows of 4 */
};

/* A leaf that can be hit. */
struct serial_leaf {
    const char *at;
    uint32_t geometry, number; /* geometry 0: of an instance */
    uint32_t place;            /* among the leaves of the file */
    uint32_t node;             /* of the dump */
};

struct serial_leaves {
    const struct serial_places *places;
    bool top;                 /* instances, else triangles */
    struct serial_leaf *leaf; /* `count` of them; the caller frees it */
    uint32_t count;
};

/* Makes room for so many leaves, and for their items in the dump. Errors: STATUS_MEMORY, without a
 * reason; what was made is freed with the leaves and the dump. */
enum status serial_leaves_make(uint32_t room, struct serial_leaves *leaves,
                               struct tree_dump *dump) MUST_USE;

/* Adds the leaf whose words begin at `at`, but for a triangle with a vertex that is no number: that
 * cannot be hit. Returns false if it is an instance with a number of its transform that is not
 * finite. */
bool serial_leaf_add(struct serial_leaves *leaves, const char *at, uint32_t place,
                     uint32_t node) MUST_USE;

/* Makes the items of the dump, in the order of geometries and numbers; leaves with the same ones
 * are the same item. The nodes of leaves get their items, and instances the place of their leaf as
 * `below`, until their tree is known. */
void serial_leaves_put(struct serial_leaves *leaves, struct tree_dump *dump);

/* The least x y z and the most of a box, as six floats. */
struct box serial_box(const char *at);

#endif
