/* One level of lavapipe: its boxes and leaves as nodes. Node i is box i, and behind the boxes come
 * the leaves, in the order of the file. */
#include "ref/dump/lavapipe.h"

#include "ref/dump/serial_leaves.h"

#include <stdlib.h>
#include <string.h>

#define NO_CHILD      UINT32_MAX
#define KIND          3u /* the low bits of a child */
#define KIND_TRIANGLE 0u
#define KIND_BOX      1u
#define KIND_INSTANCE 2u

static const struct serial_places places = {
    .number = 40, .geometry = 44, .custom = 8, .back = 16, .instance = 68, .transform = 72};

struct lvp_reading {
    const struct lvp_level *level;
    struct tree_dump *out;
    uint32_t boxes, slots, leaf_bytes; /* slots: room for leaves */
    uint32_t used;                     /* leaves up to the last that a box leads to */
    struct serial_leaves leaves;       /* that can be hit */
};

static const char *box_at(const struct lvp_reading *r, uint32_t box)
{
    return r->level->at + LVP_HEAD + (size_t)LVP_BOX * box;
}

static const char *leaf_at(const struct lvp_reading *r, uint32_t slot)
{
    return r->level->at + r->level->leaf_at + (size_t)r->leaf_bytes * slot;
}

/* The node that child k of a box is. Errors: STATUS_INPUT. */
static enum status child_of(const struct lvp_reading *r, uint32_t box, unsigned k, uint32_t *node,
                            struct reason *reason)
{
    static const char *const kinds[] = {"a triangle", "a box", "an instance", "a shader's box"};
    const uint32_t word = serial_word(box_at(r, box) + 48 + 4 * (size_t)k), kind = word & KIND,
                   at = word & ~KIND;
    const uint32_t leaf = r->level->handles ? KIND_INSTANCE : KIND_TRIANGLE;
    *node = NO_CHILD;
    if (word == NO_CHILD)
        return STATUS_OK;
    if (kind == KIND_BOX && at >= LVP_HEAD && (at - LVP_HEAD) % LVP_BOX == 0 &&
        (at - LVP_HEAD) / LVP_BOX < r->boxes) {
        *node = (at - LVP_HEAD) / LVP_BOX;
        return STATUS_OK;
    }
    if (kind != KIND_BOX && kind != leaf)
        return lavapipe_fail(r->level, reason, "box %u: child %u is %s, in a level of %ss", box, k,
                             kinds[kind], r->level->handles ? "instance" : "triangle");
    if (kind == leaf && at >= r->level->leaf_at && (at - r->level->leaf_at) % r->leaf_bytes == 0 &&
        (at - r->level->leaf_at) / r->leaf_bytes < r->slots) {
        *node = r->boxes + (at - r->level->leaf_at) / r->leaf_bytes;
        return STATUS_OK;
    }
    return lavapipe_fail(r->level, reason, "box %u: child %u is %s at offset %u, where none is",
                         box, k, kinds[kind], at);
}

/* Boxes behind the last that is not all 0 are room, but for the root. */
static uint32_t count_boxes(const struct lvp_reading *r, uint32_t boxes)
{
    static const char zeros[LVP_BOX];
    while (boxes > 1 && memcmp(box_at(r, boxes - 1), zeros, sizeof zeros) == 0)
        boxes--;
    return boxes;
}

/* A child's box is in the first of its parents; the root's in the head. */
static enum status read_boxes(struct lvp_reading *r, bool *boxed, struct reason *reason)
{
    struct tree_dump *out = r->out;
    out->node[0].box = serial_box(r->level->at);
    boxed[0] = true;
    for (uint32_t i = 0; i < r->boxes; i++) {
        out->node[i].first = (uint32_t)out->child_count;
        for (unsigned k = 0; k < 2; k++) {
            uint32_t child;
            enum status status = child_of(r, i, k, &child, reason);
            if (status)
                return status;
            if (child == NO_CHILD)
                continue;
            out->child[out->child_count++] = child;
            out->node[i].count++;
            if (!boxed[child])
                out->node[child].box = serial_box(box_at(r, i) + 24 * (size_t)k);
            boxed[child] = true;
        }
    }
    return STATUS_OK;
}

static enum status find_used(struct lvp_reading *r, struct reason *reason)
{
    for (uint32_t i = 0; i < r->boxes; i++)
        for (unsigned k = 0; k < 2; k++) {
            uint32_t child;
            enum status status = child_of(r, i, k, &child, reason);
            if (status)
                return status;
            if (child != NO_CHILD && child >= r->boxes && child - r->boxes >= r->used)
                r->used = child - r->boxes + 1;
        }
    return STATUS_OK;
}

/* --- leaves ----------------------------------------------------------------------------------- */

static enum status find_leaves(struct lvp_reading *r, struct reason *reason)
{
    for (uint32_t slot = 0; slot < r->used; slot++) {
        r->out->node[r->boxes + slot].leaf = true;
        if (!serial_leaf_add(&r->leaves, leaf_at(r, slot), slot, r->boxes + slot))
            return lavapipe_fail(r->level, reason,
                                 "instance %u: a number of its transform is not finite", slot);
    }
    return STATUS_OK;
}

static enum status make_room(struct lvp_reading *r, struct reason *reason)
{
    struct tree_dump *out = r->out;
    const size_t nodes = (size_t)r->boxes + r->used;
    const enum status status = serial_leaves_make(r->used, &r->leaves, out);
    out->node = alloc_zeroed(nodes, sizeof *out->node);
    out->child = alloc_zeroed(2 * (size_t)r->boxes, sizeof *out->child);
    if (status || !out->node || !out->child)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %zu nodes", r->level->name, nodes);
    out->node_count = nodes;
    out->bytes = LVP_BOX * (uint64_t)r->boxes + r->leaf_bytes * (uint64_t)r->used;
    return STATUS_OK;
}

enum status lavapipe_read_level(const struct lvp_level *level, struct tree_dump *out,
                                struct reason *reason)
{
    struct lvp_reading r = {.level = level,
                            .out = out,
                            .leaf_bytes = level->handles ? LVP_INSTANCE : LVP_TRIANGLE,
                            .leaves = {.places = &places, .top = level->handles > 0}};
    r.boxes = count_boxes(&r, (level->leaf_at - LVP_HEAD) / LVP_BOX);
    r.slots = (uint32_t)((level->size - level->leaf_at) / r.leaf_bytes);
    enum status status = find_used(&r, reason);
    if (!status)
        status = make_room(&r, reason);
    bool *boxed = status ? NULL : alloc_zeroed(out->node_count, sizeof *boxed);
    if (!status && !boxed)
        status = fail(reason, STATUS_MEMORY, "%s: no memory for %zu nodes", level->name,
                      out->node_count);
    if (!status)
        status = read_boxes(&r, boxed, reason);
    if (!status)
        status = find_leaves(&r, reason);
    if (!status)
        serial_leaves_put(&r.leaves, out);
    free(boxed);
    free(r.leaves.leaf);
    return status;
}
