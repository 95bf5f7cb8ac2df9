/* Files of lavapipe, written by the tests from their description (ref/dump/lavapipe.h): of worlds,
 * each mesh with our own tree. Includes cmocka.h, whose macros must come last. */
#ifndef LAVAPIPE_FILE_H
#define LAVAPIPE_FILE_H

#include "ref/dump/dump_check.h"
#include "ref/dump/dump_instances.h"
#include "ref/dump/dump_world.h"
#include "ref/tree/bvh.h"
#include "ref/world/world_boxes.h"
#include "scenes/worlds.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#define LVP_FILE_MOST  (1u << 20)
#define LVP_FILE_TREES 8u

/* Where the structures are: [0] is the top level. */
struct lvp_file {
    unsigned char bytes[LVP_FILE_MOST];
    size_t size;
    size_t begin[1 + LVP_FILE_TREES], body[1 + LVP_FILE_TREES], leaves[1 + LVP_FILE_TREES];
    uint32_t boxes[1 + LVP_FILE_TREES];
    uint32_t levels;
};

static inline void lvp_put(struct lvp_file *file, size_t at, uint32_t word)
{
    assert_true(at + 4 < sizeof file->bytes);
    for (int i = 0; i < 4; i++)
        file->bytes[at + (size_t)i] = (unsigned char)(word >> 8 * i);
    if (at + 4 > file->size)
        file->size = at + 4;
}

static inline uint32_t lvp_get(const struct lvp_file *file, size_t at)
{
    uint32_t word = 0;
    for (int i = 0; i < 4; i++)
        word |= (uint32_t)file->bytes[at + (size_t)i] << 8 * i;
    return word;
}

static inline void lvp_put_long(struct lvp_file *file, size_t at, uint64_t value)
{
    lvp_put(file, at, (uint32_t)value);
    lvp_put(file, at + 4, (uint32_t)(value >> 32));
}

static inline void lvp_put_floats(struct lvp_file *file, size_t at, const float *x, size_t count)
{
    for (size_t i = 0; i < count; i++)
        lvp_put(file, at + 4 * i, float_bits(x[i]));
}

static inline void lvp_put_box(struct lvp_file *file, size_t at, const struct box *box)
{
    lvp_put_floats(file, at, box->lo, 3);
    lvp_put_floats(file, at + 12, box->hi, 3);
}

/* The place of word `at` of a box, or of a leaf. */
static inline size_t lvp_box_word(const struct lvp_file *file, uint32_t level, uint32_t box,
                                  size_t at)
{
    return file->body[level] + 40 + 56 * (size_t)box + at;
}

static inline size_t lvp_leaf_word(const struct lvp_file *file, uint32_t level, uint32_t leaf,
                                   size_t at)
{
    return file->leaves[level] + (level ? 48 : 120) * (size_t)leaf + at;
}

/* Heads and the room of a level; `handles` of meshes, by instance. */
static inline void lvp_begin(struct lvp_file *file, const struct world *world, uint32_t boxes,
                             uint32_t leaves, const struct box *bounds, uint32_t handles)
{
    const uint32_t level = file->levels++;
    const size_t begin = file->begin[level] = file->size, body = begin + 56 + 8 * (size_t)handles;
    const uint32_t inner = 40 + 56 * boxes + (level ? 48 : 120) * leaves;
    const uint32_t all = inner + 56 + 8 * handles;
    memset(file->bytes + begin, 0, all);
    memcpy(file->bytes + begin, "25.0.7-2~bpo12+1", 16);
    memcpy(file->bytes + begin + 16, "25.0.7-2~bpo12+1", 16);
    lvp_put_long(file, begin + 32, all);
    lvp_put_long(file, begin + 40, inner);
    lvp_put_long(file, begin + 48, handles);
    for (uint32_t i = 0; i < handles; i++)
        lvp_put_long(file, begin + 56 + 8 * (size_t)i,
                     0x7f0000000000u + 0x1000u * (1 + world->instance[i].mesh));
    lvp_put_box(file, body, bounds);
    lvp_put(file, body + 24, all);
    lvp_put(file, body + 28, handles);
    lvp_put(file, body + 32, 40 + 56 * boxes);
    file->body[level] = body;
    file->leaves[level] = body + 40 + 56 * boxes;
    file->boxes[level] = boxes;
    file->size = begin + all;
}

/* A child as lavapipe writes it. */
static inline uint32_t lvp_box_child(uint32_t box)
{
    return (40 + 56 * box) | 1;
}

static inline uint32_t lvp_leaf_child(const struct lvp_file *file, uint32_t level, uint32_t leaf)
{
    return (40 + 56 * file->boxes[level] + (level ? 48 : 120) * leaf) | (level ? 0 : 2);
}

/* The bottom level of a mesh whose tree has one triangle a leaf, in the order of its inner nodes.
 * Triangles are numbered within their geometries. */
static inline void lvp_add_mesh(struct lvp_file *file, const struct world *world, uint32_t mesh)
{
    const struct scene *scene = world->mesh[mesh].scene;
    struct bvh bvh;
    const struct build_options options = {.leaf = 1};
    assert_int_equal(builder_find("sah_sweep")->build(scene, &options, &bvh, NULL), STATUS_OK);
    const struct box bounds = scene_bounds(scene);
    const uint32_t tris = scene->tri_count, level = file->levels;
    uint32_t *place = calloc(bvh.node_count, sizeof *place), boxes = 0;
    assert_non_null(place);
    for (uint32_t i = 0; i < bvh.node_count; i++)
        if (!bvh.node[i].item_count)
            place[i] = boxes++;
    lvp_begin(file, world, boxes ? boxes : 1, tris, &bounds, 0);
    for (uint32_t i = 0; i < bvh.node_count; i++) {
        const uint32_t child[2] = {bvh.node[i].fst, bvh.node[i].snd};
        for (unsigned k = 0; k < 2 && !bvh.node[i].item_count; k++) {
            const struct bvh_node *to = &bvh.node[child[k]];
            lvp_put_box(file, lvp_box_word(file, level, place[i], 24 * k), &to->bounds);
            lvp_put(file, lvp_box_word(file, level, place[i], 48 + 4 * k),
                    to->item_count ? lvp_leaf_child(file, level, bvh.prim[to->item_first])
                                   : lvp_box_child(place[child[k]]));
        }
    }
    if (boxes == 0) {
        lvp_put_box(file, lvp_box_word(file, level, 0, 0), &bounds);
        lvp_put(file, lvp_box_word(file, level, 0, 48), lvp_leaf_child(file, level, 0));
        lvp_put(file, lvp_box_word(file, level, 0, 52), 0xFFFFFFFF);
    }
    for (uint32_t i = 0; i < tris; i++) {
        uint32_t geometry = 0;
        while (i >= world->mesh[mesh].geometry[geometry].first +
                        world->mesh[mesh].geometry[geometry].count)
            geometry++;
        for (uint32_t v = 0; v < 3; v++)
            lvp_put_floats(file, lvp_leaf_word(file, level, i, 12 * (size_t)v),
                           scene->vertex + 3 * (size_t)scene->index[3 * i + v], 3);
        lvp_put(file, lvp_leaf_word(file, level, i, 40),
                i - world->mesh[mesh].geometry[geometry].first);
        lvp_put(file, lvp_leaf_word(file, level, i, 44), geometry | 0x80000000u);
    }
    free(place);
    bvh_free(&bvh);
}

/* The top level: a chain of boxes, so that box i has instance i and box i + 1. `box` has the world
 * box of each instance. */
static inline void lvp_add_top(struct lvp_file *file, const struct world *world,
                               const struct box *box)
{
    const uint32_t count = world->instance_count, boxes = count > 1 ? count - 1 : 1;
    struct box rest = box_empty();
    file->size = file->levels = 0;
    for (uint32_t i = 0; i < count; i++)
        box_add_box(&rest, &box[i]);
    lvp_begin(file, world, boxes, count, &rest, count);
    for (uint32_t i = 0; i < boxes; i++) {
        const bool last = i + 1 == boxes;
        rest = box_empty();
        for (uint32_t k = i + 1; k < count; k++)
            box_add_box(&rest, &box[k]);
        lvp_put_box(file, lvp_box_word(file, 0, i, 0), &box[i]);
        lvp_put(file, lvp_box_word(file, 0, i, 48), lvp_leaf_child(file, 0, i));
        lvp_put_box(file, lvp_box_word(file, 0, i, 24), &rest);
        lvp_put(file, lvp_box_word(file, 0, i, 52),
                count == 1 ? 0xFFFFFFFF
                : last     ? lvp_leaf_child(file, 0, count - 1)
                           : lvp_box_child(i + 1));
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct instance *instance = &world->instance[i];
        lvp_put_long(file, lvp_leaf_word(file, 0, i, 0),
                     0x7f0000000000u + 0x1000u * (1 + instance->mesh));
        lvp_put(file, lvp_leaf_word(file, 0, i, 8), instance->custom | instance->mask << 24);
        lvp_put(file, lvp_leaf_word(file, 0, i, 68), i);
        lvp_put_floats(file, lvp_leaf_word(file, 0, i, 72), &instance->m[0][0], 12);
    }
}

/* A file of a world whose instances all have meshes; meshes come in the order in which instances
 * name them. `box`: of instances, or NULL for the least. */
static inline void lvp_write(struct lvp_file *file, const struct world *world,
                             const struct box *box)
{
    struct box *least = NULL;
    struct reason reason = {""};
    bool done[LVP_FILE_TREES] = {false};
    assert_true(world->mesh_count <= LVP_FILE_TREES);
    if (world_boxes_make(world, WORLD_BOXES_OF_VERTICES, &least, &reason))
        fail_msg("%s", reason.text);
    lvp_add_top(file, world, box ? box : least);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const uint32_t mesh = world->instance[i].mesh;
        if (!done[mesh])
            lvp_add_mesh(file, world, mesh);
        done[mesh] = true;
    }
    free(least);
    file->bytes[file->size] = 0;
}

/* --- as the tests meet them ------------------------------------------------------------------- */

static inline struct world lvp_world(const char *what)
{
    struct world world;
    struct reason reason = {""};
    if (world_open(what, 1, &world, &reason))
        fail_msg("%s", reason.text);
    return world;
}

static inline enum status lvp_read(const struct lvp_file *file, size_t size, struct tree_dump *dump,
                                   struct reason *reason)
{
    return tree_dump_read("t", (const char *)file->bytes, size, DUMP_GUESSED, dump, reason);
}

static inline struct tree_dump lvp_read_ok(const struct lvp_file *file)
{
    struct tree_dump dump;
    struct reason reason = {""};
    if (lvp_read(file, file->size, &dump, &reason))
        fail_msg("%s", reason.text);
    assert_string_equal(dump.format, "lavapipe");
    return dump;
}

static inline struct dump_report lvp_found(const struct tree_dump *dump)
{
    struct dump_report report;
    struct reason reason = {""};
    const struct scene *scene = dump->scene.tri_count ? &dump->scene : NULL;
    if (dump_check(dump, scene, SIZE_MAX, true, &report, &reason))
        fail_msg("%s", reason.text);
    return report;
}

static inline struct dump_lacks lvp_measured(const struct tree_dump *dump)
{
    struct dump_lacks lacks;
    struct reason reason = {""};
    assert_true(dump->instance && dump->scene.tri_count);
    if (dump_measure(dump, &lacks, &reason))
        fail_msg("%s", reason.text);
    free(lacks.side);
    lacks.side = NULL;
    return lacks;
}

static inline struct dump_differences lvp_compared(const struct tree_dump *dump,
                                                   const struct world *world)
{
    struct dump_differences out;
    struct reason reason = {""};
    if (dump_compare(dump, world, &out, &reason))
        fail_msg("%s", reason.text);
    return out;
}

/* A world of two meshes, instances of both in turn; of what others opened. */
static inline struct world lvp_two_meshes(void)
{
    struct world a = lvp_world("placed-turned:count=5"), b = lvp_world("sphere:n=2");
    struct reason reason = {""};
    struct world_mesh *mesh = calloc(2, sizeof *mesh);
    assert_non_null(mesh);
    mesh[0] = a.mesh[0];
    mesh[1] = b.mesh[0];
    free(a.mesh);
    a.mesh = mesh;
    a.mesh_count = 2;
    b.mesh_count = 0;
    world_free(&b);
    for (uint32_t i = 0; i < a.instance_count; i++)
        a.instance[i].mesh = i % 2;
    free(a.first);
    a.first = NULL;
    if (world_finish(&a, &reason))
        fail_msg("%s", reason.text);
    return a;
}

#endif
