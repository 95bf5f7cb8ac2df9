/* One level of RADV: its nodes are what the root leads to, since the file does not say where the
 * leaves of a bottom level end. */
#include "ref/dump/radv.h"

#include "ref/base/half.h"
#include "ref/dump/serial_leaves.h"

#include <stdlib.h>

#define NO_CHILD      UINT32_MAX
#define KIND          7u /* the low bits of a child */
#define KIND_TRIANGLE 0u
#define KIND_BOX16    4u
#define KIND_BOX32    5u
#define KIND_INSTANCE 6u
#define KIND_SHADER   7u
#define WIDTH         4u

static const struct serial_places places = {
    .number = 48, .geometry = 52, .custom = 8, .back = 16, .instance = 64, .transform = 80};

/* What 64 bytes are: not known, 1 + the kind of the node that begins there, or one goes on. */
#define FREE   0u
#define MIDDLE 0xFFu

struct radv_reading {
    const struct radv_level *level;
    struct tree_dump *out;
    unsigned char *is; /* by slot */
    uint32_t *queue;   /* slots of nodes, in the order in which they were met */
    uint32_t *number;  /* of the node that begins in a slot */
    uint32_t nodes;
    struct serial_leaves leaves; /* that can be hit */
};

static const char *slot_at(const struct radv_reading *r, uint32_t slot)
{
    return r->level->node + (size_t)RADV_SLOT * slot;
}

static bool is_box(unsigned char is)
{
    return is == 1 + KIND_BOX16 || is == 1 + KIND_BOX32;
}

/* --- which nodes there are -------------------------------------------------------------------- */

static enum status refuse(const struct radv_reading *r, uint32_t slot, unsigned k, uint32_t id,
                          const char *rule, struct reason *reason)
{
    return serial_fail(r->level->name, r->level->begin, reason,
                       "box at offset %llu: child %u is 0x%08x, %s",
                       (unsigned long long)slot * RADV_SLOT, k, id, rule);
}

/* Notes that a child is a node. */
static enum status meet(struct radv_reading *r, uint32_t from, unsigned k, uint32_t id,
                        struct reason *reason)
{
    const uint32_t kind = id & KIND, slot = id >> 3;
    const bool top = r->level->handles > 0;
    const bool large = kind == KIND_BOX32 || kind == KIND_INSTANCE;
    if (kind == KIND_SHADER)
        return refuse(r, from, k, id, "a box of a shader's own", reason);
    if (kind == KIND_TRIANGLE && top)
        return refuse(r, from, k, id, "a triangle, in a level of instances", reason);
    if (kind == KIND_INSTANCE && !top)
        return refuse(r, from, k, id, "an instance, in a level of triangles", reason);
    if (kind > KIND_TRIANGLE && kind < KIND_BOX16)
        return refuse(r, from, k, id, "a node of a kind that RADV does not write", reason);
    if (slot + (uint64_t)large >= r->level->slots)
        return refuse(r, from, k, id, "beyond the nodes", reason);
    if (kind == KIND_INSTANCE && (slot < 2 || slot % 2 != 0 || slot / 2 > r->level->handles))
        return refuse(r, from, k, id, "an instance where none is", reason);
    if (r->is[slot] == 1 + kind)
        return STATUS_OK;
    if (r->is[slot] != FREE || (large && r->is[slot + 1] != FREE))
        return refuse(r, from, k, id, "within another node", reason);
    r->is[slot] = (unsigned char)(1 + kind);
    if (large)
        r->is[slot + 1] = MIDDLE;
    r->queue[r->nodes++] = slot;
    return STATUS_OK;
}

static enum status find_nodes(struct radv_reading *r, struct reason *reason)
{
    enum status status = meet(r, 0, 0, KIND_BOX32, reason);
    for (uint32_t i = 0; i < r->nodes && !status; i++)
        for (unsigned k = 0; k < WIDTH && is_box(r->is[r->queue[i]]) && !status; k++) {
            const uint32_t id = serial_word(slot_at(r, r->queue[i]) + 4 * (size_t)k);
            if (id != NO_CHILD)
                status = meet(r, r->queue[i], k, id, reason);
        }
    return status;
}

/* --- nodes ------------------------------------------------------------------------------------ */

static float half_at(const char *at)
{
    const uint32_t low = (unsigned char)at[0], high = (unsigned char)at[1];
    return half_to_float((struct half){(uint16_t)(low | high << 8)});
}

static struct box box_of_halves(const char *at)
{
    struct box box;
    for (size_t k = 0; k < 3; k++) {
        box.lo[k] = half_at(at + 2 * k);
        box.hi[k] = half_at(at + 6 + 2 * k);
    }
    return box;
}

/* A child's box is in the first of its parents; the root's in the head. */
static void read_box(struct radv_reading *r, uint32_t slot, bool *boxed)
{
    struct tree_dump *out = r->out;
    struct dump_node *node = &out->node[r->number[slot]];
    const char *at = slot_at(r, slot);
    node->first = (uint32_t)out->child_count;
    for (size_t k = 0; k < WIDTH; k++) {
        const uint32_t id = serial_word(at + 4 * k);
        if (id == NO_CHILD)
            continue;
        const uint32_t child = r->number[id >> 3];
        out->child[out->child_count++] = child;
        node->count++;
        if (!boxed[child])
            out->node[child].box = r->is[slot] == 1 + KIND_BOX32 ? serial_box(at + 16 + 24 * k)
                                                                 : box_of_halves(at + 16 + 12 * k);
        boxed[child] = true;
    }
}

static void read_boxes(struct radv_reading *r, bool *boxed)
{
    r->out->node[0].box = serial_box(r->level->at + 8);
    boxed[0] = true;
    for (uint32_t slot = 0; slot < r->level->slots; slot++) {
        if (is_box(r->is[slot]))
            read_box(r, slot, boxed);
        if (r->is[slot] != FREE)
            r->out->bytes += RADV_SLOT;
    }
}

/* --- leaves ----------------------------------------------------------------------------------- */

static enum status find_leaves(struct radv_reading *r, struct reason *reason)
{
    for (uint32_t slot = 0; slot < r->level->slots; slot++) {
        const uint32_t node = r->number[slot];
        const bool instance = r->is[slot] == 1 + KIND_INSTANCE;
        if (!instance && r->is[slot] != 1 + KIND_TRIANGLE)
            continue;
        r->out->node[node].leaf = true;
        /* Instances have two slots each, behind the root's two. */
        if (!serial_leaf_add(&r->leaves, slot_at(r, slot), instance ? slot / 2 - 1 : slot, node))
            return serial_fail(r->level->name, r->level->begin, reason,
                               "instance at offset %llu: a number of its transform is not finite",
                               (unsigned long long)slot * RADV_SLOT);
    }
    return STATUS_OK;
}

/* --- all -------------------------------------------------------------------------------------- */

static enum status no_memory(const struct radv_reading *r, struct reason *reason)
{
    return fail(reason, STATUS_MEMORY, "%s: no memory for %llu nodes", r->level->name,
                (unsigned long long)r->level->slots);
}

/* Room for the nodes that were found, which it numbers. */
static enum status make_room(struct radv_reading *r, struct reason *reason)
{
    struct tree_dump *out = r->out;
    uint32_t boxes = 0, count = 0;
    for (uint32_t slot = 0; slot < r->level->slots; slot++) {
        boxes += is_box(r->is[slot]);
        if (r->is[slot] != FREE && r->is[slot] != MIDDLE)
            r->number[slot] = count++;
    }
    out->node = alloc_zeroed(count, sizeof *out->node);
    out->child = alloc_zeroed(WIDTH * (size_t)boxes, sizeof *out->child);
    if (serial_leaves_make(count - boxes, &r->leaves, out) || !out->node || !out->child)
        return no_memory(r, reason);
    out->node_count = count;
    return STATUS_OK;
}

enum status radv_read_level(const struct radv_level *level, struct tree_dump *out,
                            struct reason *reason)
{
    struct radv_reading r = {
        .level = level, .out = out, .leaves = {.places = &places, .top = level->handles > 0}};
    bool *boxed = alloc_zeroed(level->slots, sizeof *boxed);
    r.is = alloc_zeroed(level->slots, 1);
    r.queue = alloc_zeroed(level->slots, sizeof *r.queue);
    r.number = alloc_zeroed(level->slots, sizeof *r.number);
    enum status status = STATUS_OK;
    if (!boxed || !r.is || !r.queue || !r.number)
        status = no_memory(&r, reason);
    if (!status)
        status = find_nodes(&r, reason);
    if (!status)
        status = make_room(&r, reason);
    if (!status) {
        read_boxes(&r, boxed);
        status = find_leaves(&r, reason);
    }
    if (!status)
        serial_leaves_put(&r.leaves, out);
    free(boxed);
    free(r.is);
    free(r.queue);
    free(r.number);
    free(r.leaves.leaf);
    return status;
}
