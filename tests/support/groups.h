/* Trees of any shape for layouts: groups of triangles, each a leaf, in parts that are subtrees.
 * Include after cmocka.h and tree_fixture.h. */
#ifndef SUPPORT_GROUPS_H
#define SUPPORT_GROUPS_H

#include "tests/support/tree_fixture.h"

#include <math.h>
#include <string.h>

#define ITEMS_MOST  14u
#define GROUPS_MOST 80u
#define END         255
#define FULL_GRID   4u /* items of a leaf of the grid family */

/* Items of a leaf, at most; f32 has no end. */
static inline uint32_t groups_leaf_most(const struct layout *layout)
{
    static const struct {
        const char *name;
        uint32_t items;
    } most[] = {{"f32", ITEMS_MOST}, {"rf16", 8},      {"cwbvh80", 3},
                {"half4", 8},        {"tiny8", 4},     {"tiny8_l8", 8},
                {"amd64", 4},        {"amd64_f16", 4}, {"tiny8_l14", ITEMS_MOST},
                {"amd64_f32", 4},    {"amd64_g1", 4},  {"gfx12", 8},
                {"hpb64", 4},        {"obb8", 3}};
    for (size_t i = 0; i < ARRAY_COUNT(most); i++)
        if (strcmp(layout->name, most[i].name) == 0)
            return most[i].items;
    return FULL_GRID;
}

/* Groups of triangles, a leaf each, far from each other, in parts that are subtrees. */
struct groups {
    uint32_t count, total;
    uint32_t items[GROUPS_MOST], part[GROUPS_MOST];
    float x[GROUPS_MOST], y[GROUPS_MOST], z[GROUPS_MOST];
    struct scene scene;
    struct bvh bvh;
};

static inline void groups_place(struct groups *g, uint32_t part, float x, float y, uint32_t items)
{
    assert_true(g->count < GROUPS_MOST);
    g->x[g->count] = x;
    g->y[g->count] = y;
    g->part[g->count] = part;
    g->items[g->count++] = items;
    g->total += items;
}

/* The triangles, in the order of the groups: those of a group turn about the diagonal of a cube, so
 * that all have its box. */
static inline void groups_fill(struct groups *g)
{
    uint32_t prim = 0;
    g->scene = trees_grid(g->total);
    for (uint32_t i = 0; i < g->count; i++)
        for (uint32_t j = 0; j < g->items[i]; j++, prim++) {
            const float corner[3][3] = {{0, 0, 0}, {1, 1, 1}, {1, (float)j / 16, 0}};
            for (int c = 0; c < 3; c++) {
                float *p = g->scene.vertex + 9 * (size_t)prim + 3 * (size_t)c;
                p[0] = g->x[i] + corner[c][0];
                p[1] = g->y[i] + corner[c][1];
                p[2] = g->z[i] + corner[c][2];
            }
        }
}

/* Moves each group by a distance that depends on its place, and the third corner of each of its
 * triangles the farther, the later it comes: the last alone has the lower bound in y. */
static inline void groups_lift(struct groups *g, float by)
{
    float *p = g->scene.vertex;
    for (uint32_t i = 0; i < g->count; i++)
        for (uint32_t j = 0; j < g->items[i]; j++)
            for (uint32_t c = 0; c < 3; c++, p += 3) {
                p[1] -= c == 2 ? 0.5f * by * (float)j : 0;
                p[2] += by * (float)(i % 7);
            }
}

/* Where groups lo to hi are halved: between the two parts in the middle, or within the only one. */
static inline uint32_t cut_of(const struct groups *g, uint32_t lo, uint32_t hi)
{
    uint32_t parts = g->part[hi - 1] - g->part[lo] + 1, cut = lo + 1;
    if (parts == 1)
        return lo + (hi - lo) / 2;
    while (g->part[cut] < g->part[lo] + parts / 2)
        cut++;
    return cut;
}

/* The subtree of groups lo to hi, in pre-order. */
static inline uint32_t grow_range(struct groups *g, uint32_t lo, uint32_t hi)
{
    uint32_t at = g->bvh.node_count++;
    struct bvh_node node = {.item_count = 0};
    for (uint32_t i = 0; i < lo; i++)
        node.item_first += g->items[i];
    if (hi - lo == 1) {
        node.item_count = g->items[lo];
    } else {
        uint32_t cut = cut_of(g, lo, hi);
        node.fst = grow_range(g, lo, cut);
        node.snd = grow_range(g, cut, hi);
    }
    g->bvh.node[at] = node;
    return at;
}

/* A tree with a leaf for each group, balanced over the parts. */
static inline void groups_grow(struct groups *g)
{
    g->bvh = (struct bvh){.prim_count = g->total, .tri_count = g->total};
    g->bvh.node = calloc(2 * g->count, sizeof *g->bvh.node);
    g->bvh.prim = calloc(g->total, sizeof *g->bvh.prim);
    assert_true(g->bvh.node && g->bvh.prim);
    for (uint32_t i = 0; i < g->total; i++)
        g->bvh.prim[i] = i;
    (void)grow_range(g, 0, g->count);
    trees_fit(&g->bvh, &g->scene);
    assert_int_equal(bvh_check(&g->bvh, &g->scene, NULL), STATUS_OK);
}

static inline void groups_free(struct groups *g)
{
    bvh_free(&g->bvh);
    scene_free(&g->scene);
}

/* The first and the last group make the root a cube, whose area is a power of two of theirs: the
 * cost of a leaf and of its parts is exactly the same then, and leaves stay whole. */
static inline void groups_make_cube(struct groups *g)
{
    g->x[g->count - 1] = g->y[g->count - 1] = g->z[g->count - 1] = END;
}

/* A node with a leaf of `items` in slot s; the one beside it is full, so that all of them are no
 * leaf, and the others are of any size. */
static inline void groups_of_sizes(struct groups *g, uint32_t children, uint32_t s, uint32_t items,
                                   uint32_t most)
{
    for (uint32_t i = 0; i < children; i++) {
        uint32_t other = i == (s + 1) % children ? most : 1 + (i + items) % most;
        groups_place(g, i, 16 * (float)i, 16 * (float)(i % 3), i == s ? items : other);
    }
    groups_make_cube(g);
}

/* A short ray through the middle of a triangle, which hits no other. */
static inline struct ray groups_ray(const struct groups *g, uint32_t prim)
{
    float v[3][3], normal[3], length = 0;
    struct ray ray = {.tmax = 0.008f};
    scene_tri(&g->scene, prim, v);
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        normal[k] =
            (v[1][a] - v[0][a]) * (v[2][b] - v[0][b]) - (v[1][b] - v[0][b]) * (v[2][a] - v[0][a]);
        length += normal[k] * normal[k];
    }
    for (int k = 0; k < 3; k++) {
        ray.dir[k] = normal[k] / sqrtf(length);
        ray.org[k] = (v[0][k] + v[1][k] + v[2][k]) / 3 - 0.004f * ray.dir[k];
    }
    return ray;
}

/* One node among leaves in slot s of a full node, or one leaf among nodes; each node is full. */
static inline void groups_in_slots(struct groups *g, const struct layout *layout, uint32_t s,
                                   bool one_node)
{
    for (uint32_t i = 0; i < layout->width; i++) {
        bool node = (i == s) == one_node;
        for (uint32_t k = 0; k < (node ? layout->width : 1); k++)
            groups_place(g, i, 512 * (float)i + 4 * (float)(k % 4), 4 * (float)(k / 4),
                         1 + (i + k) % groups_leaf_most(layout));
    }
}

/* The same with one node and a triangle a group; returns that of slot s of the root, or of the node
 * below it. */
static inline uint32_t groups_of_one(struct groups *g, const struct layout *layout, uint32_t s,
                                     bool below)
{
    uint32_t node = below ? s : (s + 1) % layout->width;
    groups_in_slots(g, layout, node, true);
    for (uint32_t i = 0; i < g->count; i++)
        g->items[i] = 1;
    g->total = g->count;
    return below ? 2 * s : s + (s > node ? layout->width - 1 : 0);
}

/* A value in a triangle's box: at its lower bound, its upper, or both. */
enum bound_side { SIDE_LOWER, SIDE_UPPER, SIDE_BOTH, SIDES };

static inline bool groups_put_end(struct scene *scene, uint32_t prim, int axis,
                                  enum bound_side side, float value)
{
    float *p = scene->vertex + 9 * (size_t)prim + axis, other = side == SIDE_LOWER ? 1.5f : -1.5f;
    if (side != SIDE_BOTH && (side == SIDE_LOWER ? value >= other : value <= other))
        return false;
    for (int c = 0; c < 3; c++)
        p[3 * c] = c == 1 || side == SIDE_BOTH ? value : other * (float)(c + 1);
    return true;
}

#define END_RAYS 14u

/* A ray at such a triangle: along an axis through its middle, from afar; then slanted, from beside
 * it, at its middle or near its second corner, where the value is. */
static inline struct ray groups_end_ray(const struct scene *scene, uint32_t prim, uint32_t k)
{
    static const float slant[4][3] = {
        {1, 0.75f, 0.5f}, {-0.75f, 1, 0.625f}, {0.5f, -0.875f, 1}, {-1, -0.625f, -0.75f}};
    float v[3][3], near = k < 10 ? 0.25f : 0.875f, sign = k % 2 ? -1.0f : 1.0f;
    struct ray ray = {.tmax = k < 6 ? 0x1p30f : 2};
    scene_tri(scene, prim, v);
    for (uint32_t i = 0; i < 3; i++) {
        ray.org[i] = 0.0625f * v[0][i] + near * v[1][i] + (0.9375f - near) * v[2][i];
        if (k >= 6) {
            ray.dir[i] = slant[(k - 6) % 4][i];
            ray.org[i] -= ray.dir[i];
        }
    }
    if (k < 6) {
        ray.org[k / 2] = -0x1p17f * sign;
        ray.dir[k / 2] = sign;
    }
    return ray;
}

#endif
