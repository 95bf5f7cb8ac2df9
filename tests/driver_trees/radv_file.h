/* Files of RADV, written by the tests from their description (ref/dump/radv.h): of worlds, each
 * mesh with our own tree made four wide, boxes as floats or as halves. */
#ifndef RADV_FILE_H
#define RADV_FILE_H

#include "ref/base/half.h"
#include "tests/driver_trees/lavapipe_file.h"

/* Structures of a file; [0] is the top level if there is one. */
struct rdv_file {
    struct lvp_file raw;              /* bytes, size, where structures begin, how many */
    size_t node[1 + LVP_FILE_TREES];  /* the first of the nodes, in the file */
    size_t inner[1 + LVP_FILE_TREES]; /* boxes but for the root: the next to be written */
    bool top[1 + LVP_FILE_TREES];
    bool halves; /* boxes below the root have halves */
};

static inline uint64_t rdv_address(uint32_t mesh)
{
    return (mesh % 2 ? 0xFFFF900000000000u : 0x7f0000000000u) + 0x1000u * (1 + (uint64_t)mesh);
}

static inline size_t rdv_leaf_bytes(const struct rdv_file *file, uint32_t level)
{
    return file->top[level] ? 128 : 64;
}

/* The place of byte `at` of a leaf. */
static inline size_t rdv_leaf(const struct rdv_file *file, uint32_t level, uint32_t leaf, size_t at)
{
    return file->node[level] + 128 + rdv_leaf_bytes(file, level) * leaf + at;
}

/* The word for a node at a place of the file. */
static inline uint32_t rdv_id(const struct rdv_file *file, uint32_t level, size_t place,
                              uint32_t kind)
{
    return (uint32_t)((place - file->node[level]) / 8) | kind;
}

static inline uint32_t rdv_leaf_id(const struct rdv_file *file, uint32_t level, uint32_t leaf)
{
    return rdv_id(file, level, rdv_leaf(file, level, leaf, 0), file->top[level] ? 6 : 0);
}

static inline void rdv_put_half(struct rdv_file *file, size_t at, struct half half)
{
    file->raw.bytes[at] = (unsigned char)half.bits;
    file->raw.bytes[at + 1] = (unsigned char)(half.bits >> 8);
}

/* Child k of a box, with its bounds, and the way back. */
static inline void rdv_put_child(struct rdv_file *file, uint32_t level, size_t place, uint32_t kind,
                                 unsigned k, uint32_t id, const struct box *box)
{
    lvp_put(&file->raw, place + 4 * (size_t)k, id);
    if (kind == 5)
        lvp_put_box(&file->raw, place + 16 + 24 * (size_t)k, box);
    for (size_t c = 0; c < 3 && kind == 4; c++) {
        rdv_put_half(file, place + 16 + 12 * (size_t)k + 2 * c, half_down(box->lo[c]));
        rdv_put_half(file, place + 22 + 12 * (size_t)k + 2 * c, half_up(box->hi[c]));
    }
    if (id != 0xFFFFFFFF)
        lvp_put(&file->raw, file->node[level] - 4 * ((size_t)id / 8 + 1),
                rdv_id(file, level, place, kind));
}

static inline void rdv_put_none(struct rdv_file *file, uint32_t level, size_t place, uint32_t kind,
                                unsigned k)
{
    const struct box none = {{NAN, NAN, NAN}, {NAN, NAN, NAN}};
    rdv_put_child(file, level, place, kind, k, 0xFFFFFFFF, &none);
}

/* Heads, and room for all that may come. */
static inline void rdv_begin(struct rdv_file *file, uint32_t leaves, const struct box *bounds,
                             bool top)
{
    const uint32_t level = file->raw.levels++;
    file->top[level] = top;
    const size_t inner = leaves < 2 ? 1 : leaves - 1, leaf = rdv_leaf_bytes(file, level);
    const size_t room = leaf * leaves + 128 * inner;
    const size_t begin = file->raw.size, at = begin + 56 + (top ? 8 * (size_t)leaves : 0);
    const size_t nodes = (104 + room / 64 * 4 + 63) / 64 * 64;
    assert_true(at + nodes + room + 256 < sizeof file->raw.bytes);
    memset(file->raw.bytes + begin, 0, at - begin + nodes + room + 256);
    memcpy(file->raw.bytes + begin, "AMD-MESA-DRV", 12);
    memcpy(file->raw.bytes + begin + 16, "\x01\xfe\x33 a build's own", 16);
    file->raw.begin[level] = begin;
    file->raw.body[level] = at;
    file->node[level] = at + nodes;
    file->inner[level] = at + nodes + 128 + leaf * leaves;
    lvp_put_long(&file->raw, begin + 48, top ? leaves : 0);
    lvp_put(&file->raw, at, (uint32_t)nodes);
    lvp_put_box(&file->raw, at + 8, bounds);
    lvp_put_long(&file->raw, at + 80, nodes + 128);
    lvp_put_long(&file->raw, at + 88, top ? leaves : 0);
    lvp_put(&file->raw, file->node[level] - 4, 0xFFFFFFFF);
}

/* What is known once all boxes are there: sizes, as of a structure that was compacted. */
static inline void rdv_end(struct rdv_file *file, uint32_t level)
{
    const size_t begin = file->raw.begin[level], at = file->raw.body[level];
    const uint64_t size = file->inner[level] - at, all = size + (at - begin + 127) / 128 * 128;
    lvp_put_long(&file->raw, begin + 32, all);
    lvp_put_long(&file->raw, begin + 40, size);
    lvp_put_long(&file->raw, at + 32, size);
    lvp_put_long(&file->raw, at + 40, all);
    file->raw.size = begin + all;
}

/* The children that a node has if the largest inner ones are replaced by their own, up to four. */
static inline unsigned rdv_widen(const struct bvh *bvh, uint32_t node, uint32_t child[4])
{
    unsigned count = 2;
    child[0] = bvh->node[node].fst;
    child[1] = bvh->node[node].snd;
    while (count < 4) {
        unsigned best = 4;
        for (unsigned k = 0; k < count; k++)
            if (!bvh->node[child[k]].item_count &&
                (best == 4 || box_half_area(&bvh->node[child[k]].bounds) >
                                  box_half_area(&bvh->node[child[best]].bounds)))
                best = k;
        if (best == 4)
            break;
        child[count++] = bvh->node[child[best]].snd;
        child[best] = bvh->node[child[best]].fst;
    }
    return count;
}

static inline void rdv_put_box(struct rdv_file *file, uint32_t level, const struct bvh *bvh,
                               uint32_t node, size_t place, uint32_t kind)
{
    uint32_t child[4];
    const unsigned count = rdv_widen(bvh, node, child);
    for (unsigned k = 0; k < 4; k++) {
        if (k >= count) {
            rdv_put_none(file, level, place, kind, k);
            continue;
        }
        const struct bvh_node *to = &bvh->node[child[k]];
        const uint32_t below = to->item_count ? 0 : file->halves ? 4 : 5;
        const size_t at = to->item_count ? rdv_leaf(file, level, bvh->prim[to->item_first], 0)
                                         : file->inner[level];
        if (!to->item_count)
            file->inner[level] += below == 5 ? 128 : 64;
        rdv_put_child(file, level, place, kind, k, rdv_id(file, level, at, below), &to->bounds);
        if (!to->item_count)
            rdv_put_box(file, level, bvh, child[k], at, below);
    }
}

/* The bottom level of a mesh. Triangles are numbered within their geometries. */
static inline void rdv_add_mesh(struct rdv_file *file, const struct world *world, uint32_t mesh)
{
    const struct scene *scene = world->mesh[mesh].scene;
    const struct build_options options = {.leaf = 1};
    const struct box bounds = scene_bounds(scene);
    const uint32_t level = file->raw.levels;
    struct bvh bvh;
    assert_int_equal(builder_find("sah_sweep")->build(scene, &options, &bvh, NULL), STATUS_OK);
    rdv_begin(file, scene->tri_count, &bounds, false);
    if (bvh.node_count > 1) {
        rdv_put_box(file, level, &bvh, 0, file->node[level], 5);
    } else {
        rdv_put_child(file, level, file->node[level], 5, 0, rdv_leaf_id(file, level, 0), &bounds);
        for (unsigned k = 1; k < 4; k++)
            rdv_put_none(file, level, file->node[level], 5, k);
    }
    uint32_t geometry = 0;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        const struct world_mesh *of = &world->mesh[mesh];
        while (i >= of->geometry[geometry].first + of->geometry[geometry].count)
            geometry++;
        for (uint32_t v = 0; v < 3; v++)
            lvp_put_floats(&file->raw, rdv_leaf(file, level, i, 12 * (size_t)v),
                           scene->vertex + 3 * (size_t)scene->index[3 * i + v], 3);
        lvp_put(&file->raw, rdv_leaf(file, level, i, 48), i - of->geometry[geometry].first);
        lvp_put(&file->raw, rdv_leaf(file, level, i, 52), geometry | 0x80000000u);
        lvp_put(&file->raw, rdv_leaf(file, level, i, 60), 9);
    }
    rdv_end(file, level);
    bvh_free(&bvh);
}

static inline void rdv_put_instances(struct rdv_file *file, const struct world *world)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *instance = &world->instance[i];
        const uint64_t address = rdv_address(instance->mesh);
        lvp_put_long(&file->raw, file->raw.begin[0] + 56 + 8 * (size_t)i, address);
        lvp_put(&file->raw, rdv_leaf(file, 0, i, 8), instance->custom | instance->mask << 24);
        lvp_put(&file->raw, rdv_leaf(file, 0, i, 64), i);
        lvp_put_floats(&file->raw, rdv_leaf(file, 0, i, 80), &instance->m[0][0], 12);
    }
}

/* Where each instance's nodes are, once the structures below are there; meshes by their places. */
static inline void rdv_point(struct rdv_file *file, const struct world *world, const uint32_t *tree)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const uint32_t mesh = world->instance[i].mesh, level = 1 + tree[mesh];
        const uint32_t nodes = lvp_get(&file->raw, file->raw.body[level]);
        lvp_put_long(&file->raw, rdv_leaf(file, 0, i, 0),
                     (rdv_address(mesh) + nodes) >> 3 & 0x1FFFFFFFFFFFu);
        lvp_put(&file->raw, rdv_leaf(file, 0, i, 68), nodes);
    }
}

/* The top level: a chain, box i has instances 3 i to 3 i + 2 and box i + 1, or a fourth one. */
static inline void rdv_add_top(struct rdv_file *file, const struct world *world,
                               const struct box *box)
{
    const uint32_t count = world->instance_count;
    struct box rest = box_empty();
    for (uint32_t i = 0; i < count; i++)
        box_add_box(&rest, &box[i]);
    rdv_begin(file, count, &rest, true);
    size_t place = file->node[0];
    uint32_t kind = 5;
    for (uint32_t first = 0; first < count; first += 3) {
        const bool last = first + 4 >= count;
        for (uint32_t k = 0; k < 4; k++) {
            if (first + k >= count) {
                rdv_put_none(file, 0, place, kind, k);
            } else if (k < 3 || last) {
                rdv_put_child(file, 0, place, kind, k, rdv_leaf_id(file, 0, first + k),
                              &box[first + k]);
            } else {
                rest = box_empty();
                for (uint32_t i = first + 3; i < count; i++)
                    box_add_box(&rest, &box[i]);
                const uint32_t below = file->halves ? 4 : 5;
                const size_t at = file->inner[0];
                file->inner[0] += below == 5 ? 128 : 64;
                rdv_put_child(file, 0, place, kind, k, rdv_id(file, 0, at, below), &rest);
                place = at;
                kind = below;
            }
        }
        if (last)
            break;
    }
    rdv_put_instances(file, world);
    rdv_end(file, 0);
}

/* A file of a world whose instances all have meshes, in the order in which instances name them. */
static inline void rdv_write(struct rdv_file *file, const struct world *world, bool halves)
{
    struct box *least = NULL;
    struct reason reason = {""};
    uint32_t tree[LVP_FILE_TREES], trees = 0;
    assert_true(world->mesh_count <= LVP_FILE_TREES);
    if (world_boxes_make(world, WORLD_BOXES_OF_VERTICES, &least, &reason))
        fail_msg("%s", reason.text);
    file->raw.size = file->raw.levels = 0;
    file->halves = halves;
    rdv_add_top(file, world, least);
    for (uint32_t m = 0; m < world->mesh_count; m++)
        tree[m] = UINT32_MAX;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const uint32_t mesh = world->instance[i].mesh;
        if (tree[mesh] == UINT32_MAX) {
            tree[mesh] = trees++;
            rdv_add_mesh(file, world, mesh);
        }
    }
    rdv_point(file, world, tree);
    free(least);
    file->raw.bytes[file->raw.size] = 0;
}

/* The first mesh alone. */
static inline void rdv_write_mesh(struct rdv_file *file, const struct world *world, bool halves)
{
    file->raw.size = file->raw.levels = 0;
    file->halves = halves;
    rdv_add_mesh(file, world, 0);
    file->raw.bytes[file->raw.size] = 0;
}

static inline struct tree_dump rdv_read_ok(const struct rdv_file *file)
{
    struct tree_dump dump;
    struct reason reason = {""};
    if (lvp_read(&file->raw, file->raw.size, &dump, &reason))
        fail_msg("%s", reason.text);
    assert_string_equal(dump.format, "radv");
    return dump;
}

#endif
