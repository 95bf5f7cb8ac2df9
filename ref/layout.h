/* A layout: how a binary tree is packed into bytes, and how one node is decoded. */
#ifndef LAYOUT_H
#define LAYOUT_H

#include "ref/abi.h"
#include "ref/tree/bvh.h"
#include "ref/tree/oblique_box.h"

/* Order in which a traversal visits the children it hits. */
enum visit {
    VISIT_NEAR, /* smaller entry distance first, fst if equal */
    VISIT_FST,  /* fst first: RTRS's reduced-footprint shader */
    VISIT_SND,  /* snd first: RTRS's direct shader */
};

/* How the program reproduced by a faithful layout fails on a tree that it cannot pack. */
enum layout_end {
    LAYOUT_GOES_ON,
    LAYOUT_END_LEAF, /* a leaf has more items than slots */
    LAYOUT_END_ITEM, /* items of a leaf are read as nodes, beyond the last node */
};

struct layout;
struct tri_store; /* ref/store.h */
struct wide_tree; /* ref/tree/wide_tree.h */

/* A packed tree; owns its arrays (see packed_free). node_count == 0: empty scene. */
struct packed {
    const struct layout *layout;
    const struct tri_store *store; /* `indexed` if items are stored in nodes */
    uint32_t *word;                /* node_bytes / 4 words each */
    uint32_t *item;                /* words of the storage, or NULL if items are stored in nodes */
    uint32_t word_count;
    uint32_t item_count;
    size_t item_room;    /* allocated words */
    uint32_t node_count; /* records */
    uint32_t ref_count;  /* references: records, then child slots if leaves have no records */
    uint32_t root;       /* reference of the root */
    uint32_t tri_count;  /* of the scene it was packed from */
    uint32_t stack_need; /* most entries that a traversal can need */
    bool split;          /* from a split tree (ref/tree/bvh.h) */
};

#define WIDE_MAX 8

/* One decoded node. Inner: child_count >= 2 (wide layouts: >= 1), boxes and references of the
 * children; out-of-range references are dropped (RTRS wraps references), so fewer may remain. Leaf:
 * child_count == 0, item slots 0 .. item_count - 1, which packed_item reads. */
struct wide {
    uint32_t child_count;
    uint32_t item_first;
    uint32_t item_count;
    struct box box[WIDE_MAX];
    uint32_t child[WIDE_MAX];
    /* Inner nodes of wide layouts that can be refitted: for each child that is a leaf the
     * item_first and item_count that load() of the child returns, so that refit need not decode the
     * record again; leaf_count 0: the child is an inner node. */
    uint32_t leaf_first[WIDE_MAX];
    uint32_t leaf_count[WIDE_MAX];
};

struct layout {
    const char *name;
    const char *summary;
    uint32_t node_bytes; /* bytes of one record */
    uint32_t width;      /* most children of an inner node: 2 (binary), 4 or 8 */
    bool slots;          /* leaves have no records, see load; always true if width > 2 */
    uint32_t refs; /* references per record, at most its number of words; 0: 1, for a wide layout
                      1 + width */
    enum visit order;
    bool faithful; /* reproduces RTRS or its paper, faults included */
    bool outside;  /* of a plugin (ref/outside/plugin_layout.h): the depth of a packed tree is that
                      of its decoded nodes */
    /* Layouts of a family share their functions and one shader. `shader` names the file
     * shaders/layouts/layout_SHADER.glsl; NULL: the layout's own name. */
    const char *shader;
    const void *family;   /* data of this member for pack, load and box */
    uint32_t constant[2]; /* specialization constants ABI_SPEC_LAYOUT_0 and _1 of its shader */
    /* Packs the whole tree: rounds boxes outward, checks the layout's limits. Sets every member of
     * *out but layout, tri_count, split and stack_need, which packed_make sets; `bvh` may not be
     * empty. Errors: STATUS_LIMIT with the limit, the scene's number and what would fit instead (or
     * "RTRS panics"); STATUS_MEMORY. */
    enum status (*pack)(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason);
    /* Packs a given wide tree of nodes of up to `width` children and leaves of up to `leaf_most`
     * items, which are ranges of `item`; the places of leaves in *tree become those in the storage.
     * Nodes, children and items keep their order. Else as pack(). NULL: pack() alone. */
    uint32_t leaf_most;
    enum status (*pack_tree)(const struct layout *self, struct wide_tree *tree,
                             const uint32_t *item, uint32_t item_count, const struct scene *scene,
                             struct packed *out, struct reason *reason);
    /* Returns how the reproduced program fails on this tree, if it does; then pack() returns
     * STATUS_LIMIT with the same reason. `reason` may be NULL. NULL: it fails on no tree. */
    enum layout_end (*end)(const struct bvh *bvh, struct reason *reason);
    /* Decodes the node `ref`, which must be in range (see packed_ref_valid). Never reads outside
     * the words: a faithful layout can hold any child reference. In a layout whose leaves have no
     * records, child slot s of record r is reference node_count + width * r + s; an empty slot, or
     * the slot of an inner node, decodes as a leaf without items. */
    void (*load)(const struct packed *packed, uint32_t ref, struct wide *out);
    /* Returns the box of the node `ref` itself (wide: the union of its children's). The traversal
     * tests the box of the root. */
    struct box (*box)(const struct packed *packed, uint32_t ref);
    /* Writes new bounds into the node `ref`, rounded outward as little as possible. Binary layouts:
     * the node's own box `own` (also for leaves). Wide layouts, inner nodes only: the boxes of its
     * children, which `node` has in the order of load(), and the frame of that node, but not the
     * frame of the scene. All boxes are finite and not empty. Never writes outside the words.
     * Errors: STATUS_LIMIT a bound that cannot be represented, with the layout and the limit; the
     * words are then undefined. NULL: such trees must be built anew (ref/packed/refit.h). */
    enum status (*rebound)(struct packed *packed, uint32_t ref, const struct box *own,
                           const struct wide *node, struct reason *reason);
    /* Of layouts whose nodes store more of a child than its box: true if the ray certainly meets
     * nothing below `child`, a reference that load(ref) returned, at a distance of up to tmax.
     * Traversals call it where the box is hit. NULL: boxes are all that is stored. */
    bool (*misses)(const struct packed *packed, uint32_t ref, uint32_t child,
                   const struct oblique_ray *ray, float tmax);
    /* The same test with all its numbers, for explanations; NULL if `misses` is. Returns false if
     * the node stores no oriented box of the child. */
    bool (*oblique)(const struct packed *packed, uint32_t ref, uint32_t child,
                    const struct oblique_ray *ray, struct oblique_box *out);
    /* Set only if items are stored in nodes. NULL: pack() writes them with store_put, in any
     * storage. Returns the triangle of item slot item_first + i of a leaf, or ABI_NO_PRIM if the
     * slot is empty or not a triangle. */
    uint32_t (*item)(const struct packed *packed, uint32_t slot);
};

/* NULL-terminated: the layouts that every product of tests runs over. The first keeps all bits of
 * float32; the others are compared with it. */
extern const struct layout *const layouts[];

/* NULL-terminated: these, in the same order, then the other members of families, then the layouts
 * added with layout_add. */
extern const struct layout *const *const layouts_all;

#define LAYOUTS_ADDED_MOST 4

/* Adds a layout at the end of layouts_all; it is borrowed until the program ends. Call it only
 * while no other thread reads the table. Errors: STATUS_INPUT the name is already in use;
 * STATUS_LIMIT more than LAYOUTS_ADDED_MOST. */
enum status layout_add(const struct layout *layout, struct reason *reason) MUST_USE;

/* NULL-terminated: what `--layout auto` chooses from, in this order: 16-byte records as long as 15
 * bits of index suffice, then compact nodes of 32-bit indices, then float32. */
extern const struct layout *const layouts_auto[];

/* Returns the layout of that name in layouts_all, or NULL. */
const struct layout *layout_find(const char *name);

/* Returns the base name of its shader files, after "trace_" and "render_". */
static inline const char *layout_shader(const struct layout *layout)
{
    return layout->shader ? layout->shader : layout->name;
}

/* True if its nodes are traversed as wide nodes: children pushed in order, leaves without
 * records. */
static inline bool layout_is_wide(const struct layout *layout)
{
    return layout->width > 2 || layout->slots;
}

/* Returns the references per record: packed.ref_count is packed.node_count times this. */
static inline uint32_t layout_refs(const struct layout *layout)
{
    if (layout->refs)
        return layout->refs;
    return layout_is_wide(layout) ? 1 + layout->width : 1;
}

/* Returns the maximum traversal stack of a layout, in entries. */
static inline uint32_t layout_stack_most(const struct layout *layout)
{
    return layout_is_wide(layout) ? ABI_STACK_WIDE : ABI_STACK_MAX;
}

/* True if `ref` is a node of the packed words. */
static inline bool packed_ref_valid(const struct packed *packed, uint32_t ref)
{
    return ref < packed->ref_count;
}

/* Packs `bvh` in `layout`, with its triangles in `store`. An empty tree gives node_count 0, which
 * every engine traces as misses. Errors: STATUS_INPUT the number of triangles differs from the
 * scene's; STATUS_LIMIT of the layout or the storage, a storage other than `indexed` for a layout
 * that stores items in nodes, or a tree deeper than layout_stack_most; STATUS_MEMORY. */
enum status packed_make_stored(const struct layout *layout, const struct tri_store *store,
                               const struct bvh *bvh, const struct scene *scene, struct packed *out,
                               struct reason *reason) MUST_USE;

/* Packs a given wide tree with the layout's pack_tree, which it has, and storage `indexed`. Errors:
 * STATUS_LIMIT of the layout, or a tree that needs more than layout_stack_most; STATUS_MEMORY. */
enum status packed_make_tree(const struct layout *layout, struct wide_tree *tree,
                             const uint32_t *item, uint32_t item_count, const struct scene *scene,
                             struct packed *out, struct reason *reason) MUST_USE;

/* The same with storage `indexed`. */
enum status packed_make(const struct layout *layout, const struct bvh *bvh,
                        const struct scene *scene, struct packed *out,
                        struct reason *reason) MUST_USE;

/* Packs in the first of layouts_auto that can hold the scene. `refused` receives one line for each
 * earlier layout that cannot, separated by newlines, at most `refused_bytes` with the terminator.
 * Errors: STATUS_INPUT as packed_make; STATUS_MEMORY; STATUS_LIMIT if none can. */
enum status packed_make_auto(const struct bvh *bvh, const struct scene *scene, struct packed *out,
                             char *refused, size_t refused_bytes, struct reason *reason) MUST_USE;

void packed_free(struct packed *packed);

/* Bytes of the nodes, and of the storage. */
static inline uint64_t packed_node_bytes(const struct packed *packed)
{
    return 4 * (uint64_t)packed->word_count;
}

static inline uint64_t packed_item_bytes(const struct packed *packed)
{
    return 4 * (uint64_t)packed->item_count;
}

#endif
