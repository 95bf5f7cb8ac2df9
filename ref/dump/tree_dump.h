/* A tree as another program wrote it: any number of children a node, nothing believed. */
#ifndef TREE_DUMP_H
#define TREE_DUMP_H

#include "ref/tree/bvh.h"

#include <stdio.h>

/* An inner node has the children child[first .. first + count - 1], a leaf the triangles
 * item[first .. first + count - 1]. Ranges of children lie within their array, and all else may be
 * wrong: numbers of children and triangles, ranges of leaves, bounds. */
struct dump_node {
    struct box box;
    uint32_t first, count;
    bool leaf;
};

#define DUMP_NO_TREE UINT32_MAX

/* An instance, as the file has it. */
struct dump_instance {
    float m[3][4];       /* from the mesh into the world; finite */
    float inverse[3][4]; /* the same back, as the driver made it */
    uint32_t number;     /* among the instances that the tree was built of */
    uint32_t custom, mask;
    uint32_t below; /* place in tree_dump.below; DUMP_NO_TREE: the file has not its tree */
};

/* Which triangle of which geometry a triangle of the file is. */
struct dump_source {
    uint32_t geometry, triangle;
};

/* Owns its arrays (see tree_dump_free). Node 0 is the root. */
struct tree_dump {
    const char *format; /* a member of dump_formats */
    struct dump_node *node;
    uint32_t *child, *item;
    size_t node_count, child_count, item_count;
    bool splits;        /* a triangle may be in several leaves, each of which holds a part of it */
    bool holes;         /* nodes that nothing reaches are room left over, not a fault */
    uint32_t unused;    /* node that is never reached by design; 0: none */
    uint64_t bytes;     /* of the nodes in the tracer's memory; 0: not known */
    uint32_t tri_count; /* of the scene, if tri_known */
    bool tri_known;
    struct scene scene; /* triangles that the file holds itself; tri_count 0: none */
    char *spec;         /* the scene that the file names, or NULL */
    /* Of a top level: items are instances, tri_count of them. `scene` then has for each a triangle
     * with the bounds that its box needs, unless one of their trees is not in the file. */
    struct dump_instance *instance; /* by item; NULL: this is no top level */
    struct tree_dump *below;        /* below_count trees */
    size_t below_count;
    struct dump_source *source; /* of each triangle of `scene`; or NULL: not told */
};

#define DUMP_RAYDIFF  0 /* our own text */
#define DUMP_TINYBVH  1 /* what tinybvh's BVH::Save writes */
#define DUMP_BVH2     2 /* what serialize() of madmann91's bvh, version 2, writes */
#define DUMP_LAVAPIPE 3 /* acceleration structures that lavapipe of Mesa 25.0 serialises */
#define DUMP_RADV     4 /* the same of RADV of Mesa 25.0, for GFX10.3 to GFX11.5 */
#define DUMP_FORMATS  5
#define DUMP_GUESSED  DUMP_FORMATS

/* Names of the formats; NULL-terminated. */
extern const char *const dump_formats[DUMP_FORMATS + 1];

/* Reads a tree; `format` DUMP_GUESSED: of the format that the bytes are like. bytes[size] is 0.
 * Errors: STATUS_INPUT "NAME:LINE: rule" or "NAME: rule", another version with both versions;
 * STATUS_MEMORY. On error *out is zero. */
enum status tree_dump_read(const char *name, const char *bytes, size_t size, unsigned format,
                           struct tree_dump *out, struct reason *reason) MUST_USE;

/* Our own text (docs/formats.md): of a dump, with its triangles or the scene that it names. Ranges
 * of leaves must lie within their array. Write errors set the stream's error flag only. */
void tree_dump_write(const struct tree_dump *dump, FILE *stream);

/* A dump of one of our trees, with the same numbers of nodes. Errors: STATUS_MEMORY. */
enum status tree_dump_make(const struct bvh *bvh, struct tree_dump *out) MUST_USE;

/* Frees the arrays and zeroes the dump. A zero dump is allowed. */
void tree_dump_free(struct tree_dump *dump);

#endif
