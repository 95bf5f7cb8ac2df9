/* Files that other libraries write. Both are binary and little-endian, as their programs are on
 * the machines of this format.
 *
 * tinybvh (jbikker/tinybvh, BVH::Save of tiny_bvh.h): a word with the version of the cache format
 * in its low 24 bits and the layout in its high 8; the number of triangles; the object of class BVH
 * as it lies in memory, 288 bytes on systems of 64 bits; its nodes of 32 bytes; its indices. Its
 * builders leave node 1 out, so that children share a cache line.
 *
 * bvh v2 (madmann91/bvh, Bvh::serialize with nodes of 3 floats): the number of nodes, that of
 * indices; the nodes, 7 words each, bounds axis by axis, then an index with the count of a leaf in
 * its low 4 bits; the indices. It has no version, so only the length tells what it is. */
#include "ref/dump/dump_inner.h"

#include <string.h>

static uint32_t word_at(const char *at)
{
    uint32_t value = 0;
    for (int i = 0; i < 4; i++)
        value |= (uint32_t)(unsigned char)at[i] << (8 * i);
    return value;
}

static float float_at(const char *at)
{
    return float_from_bits(word_at(at));
}

/* Two neighbours, the second maybe beyond the last number. */
static void put_children(struct tree_dump *out, struct dump_node *node, uint32_t first)
{
    node->first = (uint32_t)out->child_count;
    node->count = 2;
    out->child[out->child_count++] = first;
    out->child[out->child_count++] = first == UINT32_MAX ? first : first + 1;
}

/* Room for the nodes, two children each, and the items, which are read. */
static enum status make_room(const char *name, size_t nodes, size_t items, const char *item,
                             struct tree_dump *out, struct reason *reason)
{
    out->node = alloc_zeroed(nodes, sizeof *out->node);
    out->child = alloc_zeroed(2 * nodes, sizeof *out->child);
    out->item = alloc_zeroed(items, sizeof *out->item);
    if (!out->node || !out->child || !out->item)
        return fail(reason, STATUS_MEMORY, "%s: no memory for %zu nodes", name, nodes);
    out->node_count = nodes;
    out->item_count = items;
    for (size_t i = 0; i < items; i++)
        out->item[i] = word_at(item + 4 * i);
    return STATUS_OK;
}

/* --- tinybvh ---------------------------------------------------------------------------------- */

#define TINY_VERSION   166u
#define TINY_LAYOUT    1u
#define TINY_HEAD      8u
#define TINY_FLAGS     0u /* in the object: rebuildable, refittable, may_have_holes */
#define TINY_OF_LAYOUT 32u
#define TINY_USED      40u
#define TINY_TRIANGLES 44u
#define TINY_INDICES   48u
#define TINY_SEEN      52u /* bytes of the object that are read */
#define TINY_OBJECT    288u
#define TINY_NODE      32u

static const char *const tiny_layouts[] = {
    "none",     "BVH",      "BVH_Verbose", "BVH_Double", "BVH_SoA",  "BVH_GPU", "MBVH",
    "BVH4_CPU", "BVH4_GPU", "MBVH8",       "BVH8_CWBVH", "BVH8_CPU", "VoxelSet"};

bool dump_is_tinybvh(const char *bytes, size_t size)
{
    if (size < TINY_HEAD || word_at(bytes) >> 24 == 0 ||
        word_at(bytes) >> 24 >= ARRAY_COUNT(tiny_layouts))
        return false;
    const uint32_t version = word_at(bytes) & 0xFFFFFF;
    return version < 0x200 || (version >= 0x10000 && version < 0x30000);
}

/* Versions of the cache are numbers; programs before it and files of other layouts have that of
 * the library, a byte a part. */
static enum status tiny_head(const char *name, uint32_t head, struct reason *reason)
{
    const uint32_t version = head & 0xFFFFFF, layout = head >> 24;
    if (layout != TINY_LAYOUT)
        return fail(reason, STATUS_INPUT, "%s: tinybvh's layout %u (%s); layout %u (BVH) is read",
                    name, layout,
                    layout < ARRAY_COUNT(tiny_layouts) ? tiny_layouts[layout] : "unknown",
                    TINY_LAYOUT);
    if (version == TINY_VERSION)
        return STATUS_OK;
    if (version > 0xFFFF)
        return fail(reason, STATUS_INPUT,
                    "%s: written by tinybvh %u.%u.%u; version %u of its cache format is read", name,
                    version >> 16, version >> 8 & 255, version & 255, TINY_VERSION);
    return fail(reason, STATUS_INPUT,
                "%s: version %u of tinybvh's cache format; version %u is read", name, version,
                TINY_VERSION);
}

static void tiny_nodes(const char *at, struct tree_dump *out)
{
    for (size_t i = 0; i < out->node_count; i++, at += TINY_NODE) {
        struct dump_node *node = &out->node[i];
        for (size_t k = 0; k < 3; k++) {
            node->box.lo[k] = float_at(at + 4 * k);
            node->box.hi[k] = float_at(at + 16 + 4 * k);
        }
        node->first = word_at(at + 12);
        node->count = word_at(at + 28);
        node->leaf = node->count > 0;
        if (!node->leaf)
            put_children(out, node, node->first);
    }
}

enum status dump_read_tinybvh(const char *name, const char *bytes, size_t size,
                              struct tree_dump *out, struct reason *reason)
{
    if (size < TINY_HEAD)
        return fail(reason, STATUS_INPUT, "%s: %zu bytes, too few for a file of tinybvh", name,
                    size);
    enum status status = tiny_head(name, word_at(bytes), reason);
    if (status)
        return status;
    const char *object = bytes + TINY_HEAD;
    if (size < TINY_HEAD + TINY_SEEN)
        return fail(reason, STATUS_INPUT, "%s: %zu bytes, too few for a file of tinybvh", name,
                    size);
    const uint32_t nodes = word_at(object + TINY_USED), items = word_at(object + TINY_INDICES);
    const uint64_t arrays = (uint64_t)nodes * TINY_NODE + (uint64_t)items * 4;
    if (size != TINY_HEAD + TINY_OBJECT + arrays)
        return fail(reason, STATUS_INPUT,
                    "%s: %zu bytes, but %u nodes and %u indices make %llu: cut short, or of a "
                    "system that is not of 64 bits",
                    name, size, nodes, items,
                    (unsigned long long)(TINY_HEAD + TINY_OBJECT + arrays));
    if (word_at(object + TINY_OF_LAYOUT) != TINY_LAYOUT ||
        word_at(object + TINY_TRIANGLES) != word_at(bytes + 4))
        return fail(reason, STATUS_INPUT,
                    "%s: the object tells another layout or number of "
                    "triangles than the head",
                    name);
    if (word_at(bytes + 4) > items)
        return fail(reason, STATUS_INPUT, "%s: %u indices for %u triangles", name, items,
                    word_at(bytes + 4));
    out->splits = object[TINY_FLAGS + 1] == 0;
    out->holes = object[TINY_FLAGS + 2] != 0;
    out->unused = nodes > 1;
    out->bytes = (uint64_t)nodes * TINY_NODE;
    out->tri_count = word_at(bytes + 4);
    out->tri_known = true;
    status = make_room(name, nodes, items, bytes + (size - (size_t)items * 4), out, reason);
    if (!status)
        tiny_nodes(bytes + (size - (size_t)arrays), out);
    return status;
}

/* --- bvh v2 ----------------------------------------------------------------------------------- */

#define BVH2_HEAD   8u
#define BVH2_NODE   28u
#define BVH2_COUNT  4u /* bits of an index */
#define BVH2_DOUBLE 56u

static bool is_float(const char *bytes, size_t size)
{
    return size >= BVH2_HEAD &&
           BVH2_HEAD + (uint64_t)word_at(bytes) * BVH2_NODE + (uint64_t)word_at(bytes + 4) * 4 ==
               size;
}

/* Nodes of three doubles have words of 64 bits all over. */
static bool is_double(const char *bytes, size_t size)
{
    return size >= 16 && word_at(bytes + 4) == 0 && word_at(bytes + 12) == 0 &&
           16 + (uint64_t)word_at(bytes) * BVH2_DOUBLE + (uint64_t)word_at(bytes + 8) * 8 == size;
}

bool dump_is_bvh2(const char *bytes, size_t size)
{
    return is_float(bytes, size) || is_double(bytes, size);
}

enum status dump_read_bvh2(const char *name, const char *bytes, size_t size, struct tree_dump *out,
                           struct reason *reason)
{
    if (is_double(bytes, size))
        return fail(reason, STATUS_INPUT,
                    "%s: bvh v2 with nodes of double; those of float are read", name);
    if (!is_float(bytes, size))
        return fail(reason, STATUS_INPUT,
                    "%s: %zu bytes are no file of bvh v2: nodes and indices demand %llu", name,
                    size,
                    size < BVH2_HEAD ? (unsigned long long)BVH2_HEAD
                                     : BVH2_HEAD + (unsigned long long)word_at(bytes) * BVH2_NODE +
                                           (unsigned long long)word_at(bytes + 4) * 4);
    const uint32_t nodes = word_at(bytes), items = word_at(bytes + 4);
    const char *at = bytes + BVH2_HEAD;
    enum status status = make_room(name, nodes, items, at + (size_t)nodes * BVH2_NODE, out, reason);
    out->bytes = (uint64_t)nodes * BVH2_NODE;
    for (size_t i = 0; i < nodes && !status; i++, at += BVH2_NODE) {
        struct dump_node *node = &out->node[i];
        for (size_t k = 0; k < 3; k++) {
            node->box.lo[k] = float_at(at + 8 * k);
            node->box.hi[k] = float_at(at + 8 * k + 4);
        }
        node->first = word_at(at + 24) >> BVH2_COUNT;
        node->count = word_at(at + 24) & ((1u << BVH2_COUNT) - 1);
        node->leaf = node->count > 0;
        if (!node->leaf)
            put_children(out, node, node->first);
    }
    return status;
}
