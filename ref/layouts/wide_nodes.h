/* Shared by the layouts of wide nodes: the collapse of the tree, the frame of a node's quantised
 * planes, and the mapping of references to records and child slots. */
#ifndef WIDE_NODES_H
#define WIDE_NODES_H

#include "ref/layouts/common.h"
#include "ref/tree/wide_tree.h"

/* A child slot of a record, decoded. */
struct wide_slot {
    bool there;
    uint32_t first; /* inner: its reference; leaf: its first item slot */
    uint32_t count; /* number of items; 0: inner */
    struct box box;
};

/* Decodes all slots of a record, which must be in range. Never reads outside the words. */
typedef void wide_decode(const struct packed *packed, uint32_t record, struct wide_slot *slot);

/* Collapses `bvh` for the layout `self`: nodes of self->width children and leaves of up to
 * `leaf_most` items. Errors: STATUS_LIMIT a vertex or bound that is not finite, or beyond
 * `largest` in magnitude; as wide_tree_make. */
enum status wide_nodes_collapse(const struct layout *self, const struct bvh *bvh,
                                const struct scene *scene, uint32_t leaf_most, float node_cost,
                                float largest, struct wide_tree *out,
                                struct reason *reason) MUST_USE;

/* Appends the items of every leaf, ranges of `item`, to the storage, in the order in which the
 * nodes list them, so that the items of one node are adjacent, and sets the `first` of each leaf to
 * their place.
 * Errors: STATUS_LIMIT a place is not below `places`; as store_put. */
enum status wide_nodes_items(const struct layout *self, const uint32_t *item,
                             const struct scene *scene, uint32_t places, struct wide_tree *tree,
                             struct packed *out, struct reason *reason) MUST_USE;

/* A format of nodes whose record r is reference r and whose child slot s is reference node_count +
 * width * r + s. In a layout with the functions wide_form_*, layout->family points to it, or to a
 * struct that begins with it. A layout with only _load and _box needs only `decode`. */
struct wide_form {
    wide_decode *decode;
    float node_cost;    /* in units of a triangle test, see struct wide_rule */
    float largest;      /* largest magnitude of a bound */
    uint32_t places;    /* places of items, and so of nodes, must be below it */
    /* Writes the boxes of all slots (NULL: no child) and the node's frame, if it has one; does not
     * change the record's other words. */
    void (*put_boxes)(const struct box *const box[WIDE_MAX], uint32_t *word);
    /* Writes the children into a record that already has its boxes and is zero otherwise. */
    void (*put_children)(const struct wide_child *child, uint32_t count, uint32_t *word);
};

/* layout->pack: collapses the tree to nodes of layout->width children. Errors: STATUS_LIMIT a
 * vertex or bound that is not finite, or beyond `largest`, or an item beyond `places`; as
 * wide_tree_make, layout_alloc and store_put. */
enum status wide_form_pack(const struct layout *self, const struct bvh *bvh,
                           const struct scene *scene, struct packed *out,
                           struct reason *reason) MUST_USE;

/* layout->pack_tree. Errors: STATUS_LIMIT a bound beyond `largest`, or an item beyond `places`; as
 * layout_alloc and store_put. */
enum status wide_form_pack_tree(const struct layout *self, struct wide_tree *tree,
                                const uint32_t *item, uint32_t item_count,
                                const struct scene *scene, struct packed *out,
                                struct reason *reason) MUST_USE;

/* layout->load and box; a child whose reference is out of range is dropped. */
void wide_form_load(const struct packed *packed, uint32_t ref, struct wide *out);
struct box wide_form_box(const struct packed *packed, uint32_t ref);

/* layout->rebound. Errors: STATUS_LIMIT a bound beyond `largest`. */
enum status wide_form_rebound(struct packed *packed, uint32_t ref, const struct box *own,
                              const struct wide *node, struct reason *reason) MUST_USE;

/* layout->item for layouts that store distances between items. */
uint32_t wide_nodes_item(const struct packed *packed, uint32_t slot);

/* Parts of wide_form_load and _box. The first lists the children in the slots of a record:
 * references below `inner_refs` are nodes, and a leaf in slot s is reference slot_ref + s. The
 * second returns the union of the boxes of all used slots. */
void wide_nodes_children(const struct packed *packed, const struct wide_slot *slot,
                         uint32_t inner_refs, uint32_t slot_ref, struct wide *out);
struct box wide_nodes_union(const struct packed *packed, const struct wide_slot *slot);

/* The boxes from which pack() and rebound() write a record, one per slot, NULL if it has no child.
 * The first takes them from node `n` of a tree, the second from a packed node, whose children's new
 * boxes `node` has (slots as in wide_nodes_children). The third returns their union. */
void wide_nodes_tree_boxes(const struct wide_tree *tree, uint32_t n,
                           const struct box *box[WIDE_MAX]);
void wide_nodes_boxes(const struct packed *packed, const struct wide_slot *slot,
                      uint32_t inner_refs, const struct wide *node,
                      const struct box *box[WIDE_MAX]);
struct box wide_nodes_frame(const struct box *const box[WIDE_MAX]);

/* Planes of one axis of a node: plane q, 0 to `most`, is at origin + q * 2^exponent. Each is
 * exactly a float32, zero or at least 2^-100 in magnitude, so that no decoder rounds or flushes
 * it. */
struct node_axis {
    float origin;
    int exponent;
};

#define NODE_AXIS_LARGEST 0x1p100f /* largest magnitude of a bound */

/* Returns the finest axis whose planes extend from at most lo to at least hi. lo <= hi, both at
 * most NODE_AXIS_LARGEST in magnitude; `most` is 2 to 4096: with one step no axis holds both
 * signs. */
struct node_axis node_axis_make(float lo, float hi, uint32_t most);

/* Plane q; the last plane that is at most x; the first that is at least x. */
float node_axis_plane(const struct node_axis *axis, uint32_t q);
uint32_t node_axis_down(const struct node_axis *axis, float x);
uint32_t node_axis_up(const struct node_axis *axis, float x);

#endif
