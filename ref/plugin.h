/* Interface of a layout plugin, a shared object for
 *   raydiff check SCENE --layout ./mine.so --shader mine.glsl
 * It is plain C and needs nothing else of raydiff. The object exports one function, raydiff_plugin.
 * The GLSL file defines what shaders/layouts/layout_f32.glsl defines (two children), or what
 * shaders/wide.glsl lists (4 or 8).
 *
 *   cc -std=c17 -O2 -ffp-contract=off -shared -fPIC -I RAYDIFF -o mine.so mine.c
 *
 * raydiff checks all results of a plugin before it uses them, and packs in a process of its own. A
 * plugin with wrong results is rejected with the record named; one that crashes or hangs is
 * reported. */
#ifndef RAYDIFF_PLUGIN_H
#define RAYDIFF_PLUGIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAYDIFF_PLUGIN_VERSION 1u
#define RAYDIFF_NO_PRIM        0xFFFFFFFFu /* an item slot without a triangle */
#define RAYDIFF_WIDE_MOST      8u

struct raydiff_box {
    float lo[3];
    float hi[3];
};

/* A node of the binary tree to be packed. Inner: item_count == 0, children node[fst] and node[snd].
 * Leaf: triangles prim[item_first .. item_first + item_count - 1]. */
struct raydiff_node {
    struct raydiff_box bounds;
    uint32_t fst, snd;
    uint32_t item_first, item_count;
};

/* The tree. Nodes are in pre-order: node 0 is the root, fst is the node's own index plus 1, the
 * whole subtree of fst comes before snd. In a split tree prim_count exceeds the scene's
 * triangles. */
struct raydiff_tree {
    const struct raydiff_node *node;
    const uint32_t *prim;
    uint32_t node_count; /* at least 1 */
    uint32_t prim_count; /* entries of prim */
};

/* The scene. Triangle i has the vertices index[3i .. 3i+2] of three floats each. Tracers read
 * triangles by their number; raydiff passes them to the shader, gathered. */
struct raydiff_scene {
    const float *vertex;
    const uint32_t *index;
    uint32_t vertex_count, tri_count;
};

/* A packed tree. Its arrays belong to raydiff. */
struct raydiff_packed {
    uint32_t *word; /* node_bytes / 4 for each record; GLSL: node_quad, in fours */
    uint32_t *item; /* NULL if there are no items; GLSL: item_word */
    uint32_t records, items;
    uint32_t root; /* record of the root */
};

/* Output of pack(). */
struct raydiff_out {
    struct raydiff_packed packed;
    /* Gives `packed` zeroed arrays for that many records and items; call it once. False: no memory,
     * or over 2^32 - 1 words; pack() then returns RAYDIFF_MEMORY. */
    bool (*alloc)(struct raydiff_out *out, uint32_t records, uint32_t items);
    char *reason; /* for RAYDIFF_LIMIT: a line without the layout's name, 0-terminated */
    size_t reason_bytes;
};

enum {
    RAYDIFF_OK = 0,
    RAYDIFF_LIMIT = 1, /* this layout cannot hold such a scene: which limit, and what would fit */
    RAYDIFF_MEMORY = 2
};

/* A decoded node. Inner: child_count boxes and references of children (two children: exactly 2; 4
 * or 8: at least 1). Leaf: child_count == 0, item slots item_first .. item_first + item_count - 1,
 * at least one. With two children a reference is a record. With 4 or 8, leaves have no records: a
 * leaf in child slot s of record r is reference records + width * r + s. */
struct raydiff_wide {
    uint32_t child_count;
    uint32_t item_first, item_count;
    struct raydiff_box box[RAYDIFF_WIDE_MOST];
    uint32_t child[RAYDIFF_WIDE_MOST];
};

struct raydiff_plugin {
    uint32_t version; /* RAYDIFF_PLUGIN_VERSION */
    uint32_t bytes;   /* sizeof(struct raydiff_plugin) */
    const char *name; /* a letter, then letters, digits and _, at most 15 in all; not a name of
                         raydiff's own */
    const char *summary;
    uint32_t node_bytes; /* per record: a multiple of 16, as shaders read quads; at most 1024 */
    uint32_t width;      /* most children of a node: 2, 4 or 8 */
    /* Packs the whole tree, boxes rounded outward. Must not keep its arguments. */
    int (*pack)(const struct raydiff_tree *tree, const struct raydiff_scene *scene,
                struct raydiff_out *out);
    /* Decodes the node `ref`. Must return the same result every time; may be called by many
     * threads. *out is uninitialized. */
    void (*load)(const struct raydiff_packed *packed, uint32_t ref, struct raydiff_wide *out);
    /* Two children: returns the box of the node `ref` itself. 4 or 8: NULL, it is the union of the
     * children's. */
    struct raydiff_box (*box)(const struct raydiff_packed *packed, uint32_t ref);
    /* Returns the triangle of any item slot, or RAYDIFF_NO_PRIM. NULL: packed->item[slot]. */
    uint32_t (*item)(const struct raydiff_packed *packed, uint32_t slot);
};

/* The function that the shared object exports. */
const struct raydiff_plugin *raydiff_plugin(void);

#endif
