/* A tracer that users could have written, which tests/reported/NAME.c spoils as a report has it: a
 * binary tree of float boxes, cut in the middle of the longest side, and the test of Moeller and
 * Trumbore in double precision. A scene with as many triangles and vertices as the one before, and
 * the same indices, is taken as moved: the tree stays, its boxes are made anew from the leaves up.
 *
 * Before it is included, a report may define its own
 *   SPOIL_REFIT(tree)       how boxes are made anew, in place of refit(tree)
 *   SPOIL_TRACE(...)        as engine->trace
 *   SPOIL_LIST(...)         as engine->trace_all
 * Without any it is right. */
#ifndef REPORTED_TRACER_H
#define REPORTED_TRACER_H

#include "ref/raydiff_engine.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define LEAF_MOST 2u
#define NO_NODE   0xFFFFFFFFu

struct reported_node {
    float lo[3], hi[3];
    uint32_t child;        /* the first of two; a leaf: 0 */
    uint32_t first, count; /* of tree->order, all below */
    uint32_t parent;       /* NO_NODE: the root */
};

struct reported_tree {
    struct raydiff_engine_mesh mesh;
    struct reported_node *node;
    uint32_t *order; /* of triangles */
    uint32_t *index; /* of the last mesh */
    uint32_t count;  /* of nodes */
    uint32_t vertex_count, triangle_count;
};

static const float *vertex_of(const struct reported_tree *tree, uint32_t triangle, int corner)
{
    return tree->mesh.vertex + 3 * (size_t)tree->mesh.index[3 * (size_t)triangle + (size_t)corner];
}

/* The box of triangles order[first] on. */
static void box_of(const struct reported_tree *tree, uint32_t first, uint32_t count,
                   struct reported_node *node)
{
    for (int axis = 0; axis < 3; axis++) {
        node->lo[axis] = INFINITY;
        node->hi[axis] = -INFINITY;
    }
    for (uint32_t i = 0; i < 3 * count; i++) {
        const float *at = vertex_of(tree, tree->order[first + i / 3], (int)(i % 3));
        for (int axis = 0; axis < 3; axis++) {
            node->lo[axis] = fminf(node->lo[axis], at[axis]);
            node->hi[axis] = fmaxf(node->hi[axis], at[axis]);
        }
    }
}

static float centre_of(const struct reported_tree *tree, uint32_t triangle, int axis)
{
    return vertex_of(tree, triangle, 0)[axis] / 3 + vertex_of(tree, triangle, 1)[axis] / 3 +
           vertex_of(tree, triangle, 2)[axis] / 3;
}

/* How many of a node's triangles lie in the lower half, which are put first. */
static uint32_t part(struct reported_tree *tree, const struct reported_node *node)
{
    int axis = 0;
    for (int other = 1; other < 3; other++)
        if (node->hi[other] - node->lo[other] > node->hi[axis] - node->lo[axis])
            axis = other;
    const float middle = node->lo[axis] / 2 + node->hi[axis] / 2;
    uint32_t low = 0, *order = tree->order + node->first;
    for (uint32_t i = 0; i < node->count; i++)
        if (centre_of(tree, order[i], axis) < middle) {
            const uint32_t swap = order[i];
            order[i] = order[low];
            order[low++] = swap;
        }
    return low && low < node->count ? low : node->count / 2;
}

static void grow(struct reported_tree *tree, uint32_t at)
{
    struct reported_node *node = &tree->node[at];
    box_of(tree, node->first, node->count, node);
    if (node->count <= LEAF_MOST)
        return;
    const uint32_t low = part(tree, node), child = tree->count;
    node->child = child;
    tree->count += 2;
    tree->node[child] = (struct reported_node){.first = node->first, .count = low, .parent = at};
    tree->node[child + 1] = (struct reported_node){
        .first = node->first + low, .count = node->count - low, .parent = at};
    grow(tree, child);
    grow(tree, child + 1);
}

static inline void join(struct reported_node *node, const struct reported_node *child)
{
    for (int axis = 0; axis < 3; axis++) {
        node->lo[axis] = fminf(child[0].lo[axis], child[1].lo[axis]);
        node->hi[axis] = fmaxf(child[0].hi[axis], child[1].hi[axis]);
    }
}

/* Children stand behind their parents. */
static inline void refit(struct reported_tree *tree)
{
    for (uint32_t at = tree->count; at-- > 0;) {
        struct reported_node *node = &tree->node[at];
        if (node->child)
            join(node, &tree->node[node->child]);
        else
            box_of(tree, node->first, node->count, node);
    }
}

/* Written behind the include, where a report defines it. */
#ifndef SPOIL_REFIT
#define SPOIL_REFIT refit
#endif
static void SPOIL_REFIT(struct reported_tree *tree);

static void drop(void *self)
{
    struct reported_tree *tree = self;
    free(tree->node);
    free(tree->order);
    free(tree->index);
    free(tree);
}

static int open_tracer(const struct raydiff_engine_options *options, void **self, char *reason)
{
    (void)options, (void)reason;
    *self = calloc(1, sizeof(struct reported_tree));
    return *self ? RAYDIFF_ENGINE_OK : RAYDIFF_ENGINE_MEMORY;
}

static bool has_moved(const struct reported_tree *tree, const struct raydiff_engine_mesh *mesh)
{
    return tree->count && tree->triangle_count == mesh->triangle_count &&
           tree->vertex_count == mesh->vertex_count &&
           !memcmp(tree->index, mesh->index, 12 * (size_t)mesh->triangle_count);
}

static int build(void *self, const struct raydiff_engine_mesh *mesh, char *reason)
{
    struct reported_tree *tree = self;
    const size_t count = mesh->triangle_count;
    (void)reason;
    tree->mesh = *mesh;
    if (has_moved(tree, mesh)) {
        SPOIL_REFIT(tree);
    } else {
        free(tree->node), free(tree->order), free(tree->index);
        tree->node = calloc(2 * count + 1, sizeof *tree->node);
        tree->order = calloc(count + 1, sizeof *tree->order);
        tree->index = malloc(12 * count + 1);
        if (!tree->node || !tree->order || !tree->index)
            return RAYDIFF_ENGINE_MEMORY;
        if (count)
            memcpy(tree->index, mesh->index, 12 * count);
        for (uint32_t i = 0; i < count; i++)
            tree->order[i] = i;
        tree->triangle_count = mesh->triangle_count;
        tree->vertex_count = mesh->vertex_count;
        tree->count = count > 0;
        tree->node[0] = (struct reported_node){.count = mesh->triangle_count, .parent = NO_NODE};
        if (count)
            grow(tree, 0);
    }
    return RAYDIFF_ENGINE_OK;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

/* A hit from tmin to *t, which becomes its distance. */
static bool meets(const struct reported_tree *tree, uint32_t triangle,
                  const struct raydiff_engine_ray *ray, double *t, struct raydiff_engine_hit *hit)
{
    const float *a = vertex_of(tree, triangle, 0), *b = vertex_of(tree, triangle, 1),
                *c = vertex_of(tree, triangle, 2);
    double d[3], e1[3], e2[3], s[3], p[3], q[3];
    for (int i = 0; i < 3; i++) {
        d[i] = ray->direction[i];
        e1[i] = (double)b[i] - a[i];
        e2[i] = (double)c[i] - a[i];
        s[i] = (double)ray->origin[i] - a[i];
    }
    cross(d, e2, p);
    cross(s, e1, q);
    const double det = dot(e1, p), at = dot(e2, q) / det, u = dot(s, p) / det, v = dot(d, q) / det;
    if (det == 0 || !(u >= 0 && v >= 0 && u + v <= 1 && at >= ray->tmin && at <= *t))
        return false;
    *t = at;
    *hit = (struct raydiff_engine_hit){(float)at, (float)u, (float)v, triangle};
    return true;
}

/* Does the ray meet the box before t? In double precision, a little widened: none is lost. */
static bool enters(const struct reported_node *node, const struct raydiff_engine_ray *ray, double t)
{
    double near = ray->tmin, far = t;
    for (int i = 0; i < 3; i++) {
        const double d = ray->direction[i], o = ray->origin[i];
        if (d == 0) {
            if (o < node->lo[i] || o > node->hi[i])
                return false;
            continue;
        }
        const double a = (node->lo[i] - o) / d, b = (node->hi[i] - o) / d;
        near = fmax(near, fmin(a, b));
        far = fmin(far, fmax(a, b));
    }
    return near <= far + 1e-12 * (fabs(near) + fabs(far));
}

typedef struct raydiff_engine_ray ray_in;
typedef struct raydiff_engine_hit hit_out;

static const hit_out no_hit = {0, 0, 0, RAYDIFF_ENGINE_NONE};

/* The nearest hit, or any; with `all`, hits[] of up to `most` and their number. */
static inline uint32_t walk(const struct reported_tree *tree, const ray_in *ray, bool any,
                            hit_out *hit, bool all, uint32_t most)
{
    uint32_t stack[256], depth = 0, found = 0;
    double t = ray->tmax;
    if (!all)
        *hit = no_hit;
    if (tree->count)
        stack[depth++] = 0;
    while (depth) {
        const struct reported_node *node = &tree->node[stack[--depth]];
        if (!enters(node, ray, t))
            continue;
        if (node->child) {
            stack[depth++] = node->child + 1;
            stack[depth++] = node->child;
            continue;
        }
        for (uint32_t i = 0; i < node->count; i++) {
            hit_out one;
            double far = all ? (double)ray->tmax : t;
            if (!meets(tree, tree->order[node->first + i], ray, &far, &one))
                continue;
            if (!all)
                t = far, *hit = one;
            else if (found < most)
                hit[found] = one;
            found++;
            if (any)
                return found;
        }
    }
    return found;
}

static inline int trace(void *self, const ray_in *ray, size_t count, uint32_t query, hit_out *hit,
                        char *reason)
{
    (void)reason;
    for (size_t i = 0; i < count; i++)
        walk(self, &ray[i], query == RAYDIFF_ENGINE_QUERY_ANY, &hit[i], false, 1);
    return RAYDIFF_ENGINE_OK;
}

static inline int trace_all(void *self, const ray_in *ray, size_t count, uint32_t capacity,
                            hit_out *hit, uint32_t *hit_count, char *reason)
{
    (void)reason;
    for (size_t i = 0; i < count; i++)
        hit_count[i] = walk(self, &ray[i], false, hit + i * capacity, true, capacity);
    return RAYDIFF_ENGINE_OK;
}

#ifndef SPOIL_TRACE
#define SPOIL_TRACE trace
#endif
#ifndef SPOIL_LIST
#define SPOIL_LIST trace_all
#endif

/* Reports define these before; they are declared here and written behind the include. */
static int SPOIL_TRACE(void *self, const ray_in *ray, size_t count, uint32_t query, hit_out *hit,
                       char *reason);
static int SPOIL_LIST(void *self, const ray_in *ray, size_t count, uint32_t capacity, hit_out *hit,
                      uint32_t *hit_count, char *reason);

const struct raydiff_engine *raydiff_engine(void)
{
    static const struct raydiff_engine engine = {.version = RAYDIFF_ENGINE_VERSION,
                                                 .bytes = sizeof engine,
                                                 .name = "reported",
                                                 .can = RAYDIFF_ENGINE_CLOSEST |
                                                        RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_ALL,
                                                 .open = open_tracer,
                                                 .close = drop,
                                                 .build = build,
                                                 .trace = SPOIL_TRACE,
                                                 .trace_all = SPOIL_LIST};
    return &engine;
}

#endif
