/* One level of lavapipe: its boxes and leaves as nodes. Node i is box i, and behind the boxes come
 * the leaves, in the order of the file. */
#include "ref/dump/lavapipe.h"

#include <stdlib.h>
#include <string.h>

#define NO_CHILD      UINT32_MAX
#define KIND          3u /* the low bits of a child */
#define KIND_TRIANGLE 0u
#define KIND_BOX      1u
#define KIND_INSTANCE 2u
#define GEOMETRY      0x0FFFFFFFu /* the rest are flags */

/* Where words of leaves are. */
#define TRIANGLE_NUMBER   40u
#define TRIANGLE_GEOMETRY 44u
#define INSTANCE_CUSTOM   8u
#define INSTANCE_BACK     16u
#define INSTANCE_NUMBER   68u
#define INSTANCE_MATRIX   72u

/* A leaf, to be put in the order of its geometry and number. */
struct leaf_key {
    uint32_t geometry, number, slot;
};

struct lvp_reading {
    const struct lvp_level *level;
    struct tree_dump *out;
    uint32_t boxes, slots, leaf_bytes; /* slots: room for leaves */
    uint32_t used;                     /* leaves up to the last that a box leads to */
    struct leaf_key *key;              /* of the leaves that can be hit */
    uint32_t keys;
};

static float float_at(const char *at)
{
    return float_from_bits(serial_word(at));
}

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

static struct box bounds_at(const char *at)
{
    struct box box;
    for (size_t k = 0; k < 3; k++) {
        box.lo[k] = float_at(at + 4 * k);
        box.hi[k] = float_at(at + 12 + 4 * k);
    }
    return box;
}

/* A child's box is in the first of its parents; the root's in the head. */
static enum status read_boxes(struct lvp_reading *r, bool *boxed, struct reason *reason)
{
    struct tree_dump *out = r->out;
    out->node[0].box = bounds_at(r->level->at);
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
                out->node[child].box = bounds_at(box_at(r, i) + 24 * (size_t)k);
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

static int order_of(const void *a, const void *b)
{
    const struct leaf_key *x = a, *y = b;
    if (x->geometry != y->geometry)
        return x->geometry < y->geometry ? -1 : 1;
    if (x->number != y->number)
        return x->number < y->number ? -1 : 1;
    return x->slot < y->slot ? -1 : x->slot > y->slot;
}

static bool are_finite(const char *at, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!float_is_finite(float_at(at + 4 * i)))
            return false;
    return true;
}

/* The keys of leaves that can be hit: a triangle with a vertex that is no number cannot. */
static enum status find_keys(struct lvp_reading *r, struct reason *reason)
{
    for (uint32_t slot = 0; slot < r->used; slot++) {
        const char *at = leaf_at(r, slot);
        if (r->level->handles && !are_finite(at + INSTANCE_MATRIX, 12))
            return lavapipe_fail(r->level, reason,
                                 "instance %u: a number of its transform is not finite", slot);
        if (r->level->handles)
            r->key[r->keys++] = (struct leaf_key){0, serial_word(at + INSTANCE_NUMBER), slot};
        else if (are_finite(at, 9))
            r->key[r->keys++] = (struct leaf_key){serial_word(at + TRIANGLE_GEOMETRY) & GEOMETRY,
                                                  serial_word(at + TRIANGLE_NUMBER), slot};
    }
    qsort(r->key, r->keys, sizeof *r->key, order_of);
    return STATUS_OK;
}

static void put_triangle(const struct lvp_reading *r, uint32_t item, const struct leaf_key *key)
{
    struct tree_dump *out = r->out;
    for (size_t i = 0; i < 9; i++)
        out->scene.vertex[9 * (size_t)item + i] = float_at(leaf_at(r, key->slot) + 4 * i);
    for (uint32_t i = 0; i < 3; i++)
        out->scene.index[3 * (size_t)item + i] = 3 * item + i;
    out->source[item] = (struct dump_source){key->geometry, key->number};
}

static void put_instance(const struct lvp_reading *r, uint32_t item, const struct leaf_key *key)
{
    const char *at = leaf_at(r, key->slot);
    struct dump_instance *to = &r->out->instance[item];
    for (size_t i = 0; i < 12; i++) {
        to->m[i / 4][i % 4] = float_at(at + INSTANCE_MATRIX + 4 * i);
        to->inverse[i / 4][i % 4] = float_at(at + INSTANCE_BACK + 4 * i);
    }
    to->number = key->number;
    to->custom = serial_word(at + INSTANCE_CUSTOM) & 0xFFFFFF;
    to->mask = serial_word(at + INSTANCE_CUSTOM) >> 24;
    to->below = key->slot; /* until its tree is known */
}

/* Leaves with the same number are one item. */
static void put_leaves(struct lvp_reading *r)
{
    struct tree_dump *out = r->out;
    uint32_t items = 0;
    for (uint32_t i = 0; i < r->keys; i++) {
        const struct leaf_key *key = &r->key[i];
        const bool again =
            i > 0 && key[-1].geometry == key->geometry && key[-1].number == key->number;
        if (!again) {
            if (r->level->handles)
                put_instance(r, items, key);
            else
                put_triangle(r, items, key);
            items++;
        }
        out->item[i] = items - 1;
        out->node[r->boxes + key->slot].first = i;
        out->node[r->boxes + key->slot].count = 1;
    }
    for (uint32_t slot = 0; slot < r->used; slot++)
        out->node[r->boxes + slot].leaf = true;
    out->item_count = r->keys;
    out->tri_count = items;
    out->tri_known = true;
    if (!r->level->handles) {
        out->scene.tri_count = items;
        out->scene.vertex_count = 3 * items;
    }
}

static enum status make_room(struct lvp_reading *r, struct reason *reason)
{
    struct tree_dump *out = r->out;
    const size_t nodes = (size_t)r->boxes + r->used;
    const bool top = r->level->handles > 0;
    enum status status = STATUS_OK;
    out->node = alloc_zeroed(nodes, sizeof *out->node);
    out->child = alloc_zeroed(2 * (size_t)r->boxes, sizeof *out->child);
    out->item = alloc_zeroed(r->used, sizeof *out->item);
    r->key = alloc_zeroed(r->used, sizeof *r->key);
    if (top)
        out->instance = alloc_zeroed(r->used, sizeof *out->instance);
    else
        out->source = alloc_zeroed(r->used, sizeof *out->source);
    if (!top)
        status = scene_make(3 * r->used, r->used, &out->scene);
    if (status || !out->node || !out->child || !out->item || !r->key ||
        (top ? !out->instance : !out->source))
        return fail(reason, STATUS_MEMORY, "%s: no memory for %zu nodes", r->level->name, nodes);
    out->node_count = nodes;
    out->bytes = LVP_BOX * (uint64_t)r->boxes + r->leaf_bytes * (uint64_t)r->used;
    return STATUS_OK;
}

enum status lavapipe_read_level(const struct lvp_level *level, struct tree_dump *out,
                                struct reason *reason)
{
    struct lvp_reading r = {
        .level = level, .out = out, .leaf_bytes = level->handles ? LVP_INSTANCE : LVP_TRIANGLE};
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
        status = find_keys(&r, reason);
    if (!status)
        put_leaves(&r);
    free(boxed);
    free(r.key);
    return status;
}
