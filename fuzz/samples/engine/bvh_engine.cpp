// A tracer as a shared object, in C++: a tree of boxes, in double precision.
//   c++ -O2 -shared -fPIC -I RAYDIFF -o bvh.so bvh_engine.cpp
//   raydiff check sphere --engine ./bvh.so
// BUG=1 enters no box that is flat; BUG=2 has room for 16 triangles, and crashes with more; BUG=3
// keeps the boxes of before when vertices have moved.
#include "ref/raydiff_engine.h"
#include <algorithm>
#include <cmath>
#include <new>
#include <vector>
#ifndef BUG
#define BUG 0
#endif

// A triangle, and the box of a part of the array whose middle it is; the halves are parts, too.
struct Node { float corner[9], lo[3], hi[3]; uint32_t number; };
using Tree = std::vector<Node>;

static void halve(Node *first, Node *last, int axis, bool sort)
{
    for (Node *n; first < last; first = n + 1, axis = (axis + 1) % 3) {
        auto less = [=](const Node &a, const Node &b) { return a.corner[axis] < b.corner[axis]; };
        n = first + (last - first) / 2;
        if (sort)
            std::nth_element(first, n, last, less);
        std::fill(n->lo, n->lo + 3, INFINITY);
        std::fill(n->hi, n->hi + 3, -INFINITY);
        for (ptrdiff_t i = 0; i < 9 * (last - first); i++) {
            n->lo[i % 3] = std::min(n->lo[i % 3], first[i / 9].corner[i % 9]);
            n->hi[i % 3] = std::max(n->hi[i % 3], first[i / 9].corner[i % 9]);
        }
        halve(first, n, (axis + 1) % 3, sort);
    }
}

static void place(Tree &tree, const raydiff_engine_mesh *mesh)
{
    for (Node &node : tree)
        for (size_t k = 0; k < 9; k++)
            node.corner[k] = mesh->vertex[3 * size_t(mesh->index[3 * node.number + k / 3]) + k % 3];
}

static int build(void *self, const raydiff_engine_mesh *mesh, char *)
try {
    Tree &tree = *static_cast<Tree *>(self);
    tree.resize(BUG == 2 ? std::min(mesh->triangle_count, 16u) : mesh->triangle_count);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        tree.at(i).number = i;
    place(tree, mesh);
    halve(tree.data(), tree.data() + tree.size(), 0, true);
    return RAYDIFF_ENGINE_OK;
} catch (const std::bad_alloc &) { // no exception may leave a function of the table
    return RAYDIFF_ENGINE_MEMORY;
}

// An update: each triangle stays in its place of the tree, and all boxes are made again.
static int move(void *self, const raydiff_engine_mesh *mesh, char *)
{
    Tree &tree = *static_cast<Tree *>(self);
    place(tree, mesh);
    if (BUG != 3)
        halve(tree.data(), tree.data() + tree.size(), 0, false);
    return RAYDIFF_ENGINE_OK;
}

static double det(const double *a, const double *b, const double *c)
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static void look(const Node *first, const Node *last, const raydiff_engine_ray &ray, bool any,
                 double &tmax, raydiff_engine_hit &hit)
{
    for (const Node *n; first < last; first = n + 1) {
        double near = ray.tmin, far = tmax, d[3], s[3], e1[3], e2[3];
        n = first + (last - first) / 2;
        for (int k = 0; k < 3; k++) {
            const double a = n->corner[k], o = ray.origin[k], slow = 1 / double(ray.direction[k]);
            const double lo = (n->lo[k] - o - 1e-300) * slow, hi = (n->hi[k] - o + 1e-300) * slow;
            d[k] = ray.direction[k], s[k] = o - a;
            e1[k] = n->corner[3 + k] - a, e2[k] = n->corner[6 + k] - a;
            near = std::max(near, std::min(lo, hi)); // 1e-300: never 0 times infinity
            far = std::min(far, std::max(lo, hi));
        }
        if (BUG == 1 ? near >= far : near > far + 1e-15 * (std::fabs(near) + std::fabs(far)))
            return;
        const double all = -det(d, e1, e2), t = det(s, e1, e2) / all; // Moeller and Trumbore
        const double u = -det(d, s, e2) / all, v = -det(d, e1, s) / all;
        if (u >= 0 && v >= 0 && u + v <= 1 && t >= ray.tmin && t <= tmax) {
            hit = {float(t), float(u), float(v), n->number};
            tmax = any ? -1e300 : t; // nothing else is looked at
        }
        look(first, n, ray, any, tmax, hit);
    }
}

static int trace(void *self, const raydiff_engine_ray *ray, size_t count, uint32_t query,
                 raydiff_engine_hit *hit, char *)
{
    const Tree &tree = *static_cast<Tree *>(self);
    for (size_t i = 0; i < count; i++) {
        double tmax = ray[i].tmax;
        hit[i].triangle = RAYDIFF_ENGINE_NONE;
        look(tree.data(), tree.data() + tree.size(), ray[i], query > 0, tmax, hit[i]);
    }
    return RAYDIFF_ENGINE_OK;
}

static int open_tracer(const raydiff_engine_options *, void **self, char *)
{
    return (*self = new (std::nothrow) Tree) ? RAYDIFF_ENGINE_OK : RAYDIFF_ENGINE_MEMORY;
}
static void close_tracer(void *self) { delete static_cast<Tree *>(self); }
static void model(void *, raydiff_engine_model *out) { out->displacement = 4; } // usual: 32
static void memory(void *self, raydiff_engine_memory *out)
{
    out->tree_bytes = sizeof(Node) * static_cast<Tree *>(self)->size();
}

const struct raydiff_engine *raydiff_engine(void)
{
    static const struct raydiff_engine engine = {
        RAYDIFF_ENGINE_VERSION, sizeof engine, "bvh", "a tree of boxes, in double precision",
        RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_MOVE, 0, open_tracer,
        close_tracer, build, trace, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr, nullptr,
        model, memory, move};
    return &engine;
}
