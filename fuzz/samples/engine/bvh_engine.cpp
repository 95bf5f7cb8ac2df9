// A tracer as a shared object, in C++: a tree of boxes, and rays in a form of its own.
//
//   c++ -O2 -shared -fPIC -I RAYDIFF -o bvh.so bvh_engine.cpp
//   raydiff check sphere --engine ./bvh.so
//
// BUG=1 enters no box that is flat, and raydiff finds it.
#include "ref/raydiff_engine.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <new>
#include <vector>

using Ray = raydiff_engine_ray;
using Hit = raydiff_engine_hit;
struct V { double x, y, z; };
static V at(const float *p) { return {p[0], p[1], p[2]}; }
static V operator-(V a, V b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static double dot(V a, V b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static V cross(V a, V b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

// Inner: count 0, its children are the node behind it and `next`. Leaf: triangles next, next + 1 ...
struct Node { float lo[3], hi[3]; uint32_t next, count; };

// What a ray is here: its reciprocals are computed once, and its hit is beside it. raydiff makes
// these outside of what it times.
struct Native { Ray ray; float inverse[3]; Hit hit; };
struct Rays { std::vector<Native> ray; uint32_t query; };

struct Tracer {
    raydiff_engine_mesh mesh{};
    std::vector<Node> node;
    std::vector<uint32_t> order; // of the triangles

    const float *corner(uint32_t triangle, int k) const
    {
        return mesh.vertex + 3 * size_t(mesh.index[3 * size_t(triangle) + k]);
    }
    double middle(uint32_t triangle, int axis) const
    {
        return double(corner(triangle, 0)[axis]) + corner(triangle, 1)[axis] + corner(triangle, 2)[axis];
    }

    void build(uint32_t first, uint32_t count)
    {
        size_t self = node.size();
        Node n{{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, first, count};
        for (uint32_t i = first; i < first + count; i++)
            for (int k = 0; k < 9; k++) {
                float x = corner(order[i], k / 3)[k % 3];
                n.lo[k % 3] = std::min(n.lo[k % 3], x);
                n.hi[k % 3] = std::max(n.hi[k % 3], x);
            }
        node.push_back(n);
        if (count <= 4)
            return;
        int axis = 0; // the longest; the triangles are parted at their median
        for (int k = 1; k < 3; k++)
            axis = n.hi[k] - n.lo[k] > n.hi[axis] - n.lo[axis] ? k : axis;
        auto from = order.begin() + first;
        std::nth_element(from, from + count / 2, from + count, [&](uint32_t a, uint32_t b) {
            return middle(a, axis) != middle(b, axis) ? middle(a, axis) < middle(b, axis) : a < b;
        });
        build(first, count / 2);
        node[self].next = uint32_t(node.size());
        node[self].count = 0;
        build(first + count / 2, count - count / 2);
    }

    static bool enters(const Node &n, const Native &r, float tmax)
    {
        float near = r.ray.tmin, far = tmax;
        for (int k = 0; k < 3; k++) {
            if (r.ray.direction[k] == 0) { // never leaves its plane; 0 * infinity is no number
                if (r.ray.origin[k] < n.lo[k] || r.ray.origin[k] > n.hi[k])
                    return false;
            } else if (!std::isinf(r.inverse[k])) { // else subnormal: the box may be met
                float a = (n.lo[k] - r.ray.origin[k]) * r.inverse[k];
                float b = (n.hi[k] - r.ray.origin[k]) * r.inverse[k];
                near = std::max(near, std::min(a, b));
                far = std::min(far, std::max(a, b));
            }
        }
#if defined(BUG) && BUG == 1
        return near < far;
#else // rounding moves a plane by less than 2^-22 of its distance: the box is that much larger
        return near <= far + (std::fabs(near) + std::fabs(far)) / 4194304.0f;
#endif
    }

    // Moeller and Trumbore, in double precision.
    void test(uint32_t triangle, Native &r) const
    {
        V a = at(corner(triangle, 0)), d = at(r.ray.direction), e1 = at(corner(triangle, 1)) - a,
          e2 = at(corner(triangle, 2)) - a, s = at(r.ray.origin) - a, p = cross(d, e2), q = cross(s, e1);
        double det = dot(e1, p), t = dot(e2, q) / det, u = dot(s, p) / det, v = dot(d, q) / det;
        float most = r.hit.triangle == RAYDIFF_ENGINE_NONE ? r.ray.tmax : r.hit.t;
        if (det != 0 && u >= 0 && v >= 0 && u + v <= 1 && t >= r.ray.tmin && t <= most)
            r.hit = {float(t), float(u), float(v), triangle};
    }

    void trace(Native &r, uint32_t query) const
    {
        uint32_t stack[64], depth = 0, now = 0; // 64: the tree is balanced
        r.hit = {0, 0, 0, RAYDIFF_ENGINE_NONE};
        for (bool more = !node.empty(); more; more = depth > 0, now = more ? stack[--depth] : 0)
            while (enters(node[now], r, r.hit.triangle == RAYDIFF_ENGINE_NONE ? r.ray.tmax : r.hit.t)) {
                const Node &n = node[now];
                for (uint32_t i = 0; i < n.count; i++)
                    test(order[n.next + i], r);
                if (query == RAYDIFF_ENGINE_QUERY_ANY && r.hit.triangle != RAYDIFF_ENGINE_NONE)
                    return;
                if (n.count > 0)
                    break;
                stack[depth++] = n.next;
                now++;
            }
    }
};

// No exception may leave a function of the table.
template <typename F> static int guarded(char *reason, F run)
{
    try {
        run();
        return RAYDIFF_ENGINE_OK;
    } catch (const std::bad_alloc &) {
        std::snprintf(reason, RAYDIFF_ENGINE_REASON, "no memory");
        return RAYDIFF_ENGINE_MEMORY;
    }
}

static int open_tracer(const raydiff_engine_options *, void **self, char *reason)
{
    return guarded(reason, [=] { *self = new Tracer; });
}
static void close_tracer(void *self) { delete static_cast<Tracer *>(self); }

static int build(void *self, const raydiff_engine_mesh *mesh, char *reason)
{
    return guarded(reason, [=] {
        Tracer &t = *static_cast<Tracer *>(self);
        t.mesh = *mesh;
        t.node.clear();
        t.order.resize(mesh->triangle_count);
        for (uint32_t i = 0; i < mesh->triangle_count; i++)
            t.order[i] = i;
        if (mesh->triangle_count > 0)
            t.build(0, mesh->triangle_count);
    });
}

static int rays_make(void *, const Ray *ray, size_t count, uint32_t query, void **rays, char *reason)
{
    return guarded(reason, [=] {
        Rays *made = new Rays{{}, query};
        *rays = made; // freed by rays_free, whatever happens
        for (size_t i = 0; i < count; i++)
            made->ray.push_back({ray[i], {1 / ray[i].direction[0], 1 / ray[i].direction[1],
                                          1 / ray[i].direction[2]}, {}});
    });
}
static int rays_trace(void *self, void *rays, char *)
{
    for (Native &r : static_cast<Rays *>(rays)->ray)
        static_cast<Tracer *>(self)->trace(r, static_cast<Rays *>(rays)->query);
    return RAYDIFF_ENGINE_OK;
}
static void hits_read(void *, const void *rays, Hit *hit)
{
    for (const Native &r : static_cast<const Rays *>(rays)->ray)
        *hit++ = r.hit;
}
static void rays_free(void *, void *rays) { delete static_cast<Rays *>(rays); }

// The same with raydiff's rays, which is what runs in a process of its own.
static int trace(void *self, const Ray *ray, size_t count, uint32_t query, Hit *hit, char *reason)
{
    void *rays = nullptr;
    int status = rays_make(self, ray, count, query, &rays, reason);
    if (status == RAYDIFF_ENGINE_OK) {
        status = rays_trace(self, rays, reason);
        hits_read(self, rays, hit);
    }
    rays_free(self, rays);
    return status;
}

static void memory(void *self, raydiff_engine_memory *out)
{
    const Tracer &t = *static_cast<Tracer *>(self);
    out->tree_bytes = sizeof(Node) * t.node.size() + sizeof(uint32_t) * t.order.size();
    out->scene_bytes = 12 * (uint64_t(t.mesh.vertex_count) + t.mesh.triangle_count);
}

const struct raydiff_engine *raydiff_engine(void)
{
    static const struct raydiff_engine engine = {
        RAYDIFF_ENGINE_VERSION, sizeof engine, "bvh", "a median tree, in double precision",
        RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_NATIVE, 0,
        open_tracer, close_tracer, build, trace, /* trace_all */ nullptr,
        /* worlds */ nullptr, nullptr, rays_make, rays_trace, hits_read, rays_free,
        /* model: unknown */ nullptr, memory};
    return &engine;
}
