/* tinybvh's BVH8_CPU as a shared object, to race it; the library is not a part of raydiff: name the
 * folder of your own copy of tiny_bvh.h.
 *
 *   c++ -O3 -mavx2 -mfma -shared -fPIC -I RAYDIFF -I TINYBVH -o tinybvh.so tinybvh_engine.cpp
 *   raydiff bench fast --engine fast,inside:./tinybvh.so
 *
 * -DHQ=1 builds with spatial splits. Its rays begin at 0: a ray with tmin > 0 is moved. Its rays
 * are filled before rays_trace is timed, and read behind it. */
#define TINYBVH_IMPLEMENTATION
#include <tiny_bvh.h>

#include "ref/raydiff_engine.h"

#include <cstdio>
#include <new>
#include <vector>

namespace {

struct tracer {
    std::vector<tinybvh::bvhvec4> vertex;
    std::vector<uint32_t> index;
    tinybvh::BVH8_CPU *bvh = nullptr;
    ~tracer() { delete bvh; }
};

struct rays {
    tinybvh::Ray *ray; /* aligned to 64 */
    size_t count;
    bool any;
    std::vector<float> moved; /* what t lacks */
    std::vector<char> blocked;
};

int no_memory(char *reason)
{
    std::snprintf(reason, RAYDIFF_ENGINE_REASON, "no memory");
    return RAYDIFF_ENGINE_MEMORY;
}

int open_tracer(const raydiff_engine_options *, void **self, char *reason)
{
    *self = new (std::nothrow) tracer;
    return *self ? (int)RAYDIFF_ENGINE_OK : no_memory(reason);
}

void close_tracer(void *self) { delete static_cast<tracer *>(self); }

int build(void *self, const raydiff_engine_mesh *mesh, char *reason)
try {
    tracer *t = static_cast<tracer *>(self);
    delete t->bvh;
    t->bvh = nullptr;
    t->vertex.clear();
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        const float *v = mesh->vertex + 3 * (size_t)i;
        t->vertex.push_back(tinybvh::bvhvec4(v[0], v[1], v[2], 0));
    }
    t->index.assign(mesh->index, mesh->index + 3 * (size_t)mesh->triangle_count);
    if (mesh->triangle_count == 0)
        return RAYDIFF_ENGINE_OK;
    t->bvh = new tinybvh::BVH8_CPU;
#if defined(HQ)
    t->bvh->BuildHQ(t->vertex.data(), t->index.data(), mesh->triangle_count);
#else
    t->bvh->Build(t->vertex.data(), t->index.data(), mesh->triangle_count);
#endif
    return RAYDIFF_ENGINE_OK;
} catch (const std::bad_alloc &) {
    return no_memory(reason);
}

void rays_free(void *, void *made)
{
    rays *r = static_cast<rays *>(made);
    std::free(r->ray);
    delete r;
}

int rays_make(void *, const raydiff_engine_ray *ray, size_t count, uint32_t query, void **out,
              char *reason)
try {
    rays *r = new rays{nullptr, count, query == RAYDIFF_ENGINE_QUERY_ANY,
                       std::vector<float>(count), std::vector<char>(count)};
    *out = r;
    r->ray = static_cast<tinybvh::Ray *>(std::aligned_alloc(64, (count + 1) * sizeof *r->ray));
    if (!r->ray)
        return no_memory(reason);
    for (size_t i = 0; i < count; i++) {
        const float *o = ray[i].origin, *d = ray[i].direction, move = ray[i].tmin;
        tinybvh::Ray &to = r->ray[i];
        std::memset(static_cast<void *>(&to), 0, sizeof to);
        to.O = tinybvh::bvhvec3(o[0] + move * d[0], o[1] + move * d[1], o[2] + move * d[2]);
        to.D = tinybvh::bvhvec3(d[0], d[1], d[2]);
        to.rD = tinybvh::tinybvh_rcp(to.D);
        to.mask = RAY_MASK_INTERSECT_ALL;
        to.hit.t = ray[i].tmax < BVH_FAR ? ray[i].tmax - move : BVH_FAR;
        r->moved[i] = move;
    }
    return RAYDIFF_ENGINE_OK;
} catch (const std::bad_alloc &) {
    return no_memory(reason);
}

int rays_trace(void *self, void *made, char *)
{
    const tinybvh::BVH8_CPU *bvh = static_cast<tracer *>(self)->bvh;
    rays *r = static_cast<rays *>(made);
    if (!bvh)
        return RAYDIFF_ENGINE_OK;
    if (r->any)
        for (size_t i = 0; i < r->count; i++)
            r->blocked[i] = bvh->IsOccluded(r->ray[i]);
    else
        for (size_t i = 0; i < r->count; i++)
            r->ray[i].hit.prim = RAYDIFF_ENGINE_NONE, bvh->Intersect(r->ray[i]);
    return RAYDIFF_ENGINE_OK;
}

void hits_read(void *self, const void *made, raydiff_engine_hit *hit)
{
    const rays *r = static_cast<const rays *>(made);
    const bool empty = !static_cast<tracer *>(self)->bvh;
    for (size_t i = 0; i < r->count; i++) {
        const auto &from = r->ray[i].hit;
        hit[i] = raydiff_engine_hit{0, 0, 0, RAYDIFF_ENGINE_NONE};
        if (r->any && r->blocked[i])
            hit[i].triangle = 0; /* it does not tell which */
        if (!r->any && !empty && from.prim != RAYDIFF_ENGINE_NONE)
            hit[i] = raydiff_engine_hit{from.t + r->moved[i], from.u, from.v, from.prim};
    }
}

int trace(void *self, const raydiff_engine_ray *ray, size_t count, uint32_t query,
          raydiff_engine_hit *hit, char *reason)
{
    void *made = nullptr;
    int status = rays_make(self, ray, count, query, &made, reason);
    if (status == RAYDIFF_ENGINE_OK) {
        rays_trace(self, made, reason);
        hits_read(self, made, hit);
    }
    if (made)
        rays_free(self, made);
    return status;
}

void model(void *, raydiff_engine_model *out)
{
    out->flags = RAYDIFF_ENGINE_OPEN_RANGE | RAYDIFF_ENGINE_UNNAMED;
}

void memory(void *self, raydiff_engine_memory *out)
{
    const tracer *t = static_cast<tracer *>(self);
    out->scene_bytes = t->vertex.size() * sizeof t->vertex[0] + 4 * t->index.size();
    if (t->bvh) /* its nodes and copies of triangles */
        out->tree_bytes = 64 * (uint64_t)t->bvh->usedBlocks;
}

const struct raydiff_engine table = [] {
    struct raydiff_engine e = {};
    e.version = RAYDIFF_ENGINE_VERSION;
    e.bytes = sizeof e;
    e.name = "tinybvh";
    e.summary = "tinybvh's BVH8_CPU";
    e.can = RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_NATIVE;
    e.open = open_tracer;
    e.close = close_tracer;
    e.build = build;
    e.trace = trace;
    e.rays_make = rays_make;
    e.rays_trace = rays_trace;
    e.hits_read = hits_read;
    e.rays_free = rays_free;
    e.model = model;
    e.memory = memory;
    return e;
}();

} // namespace

extern "C" const struct raydiff_engine *raydiff_engine(void) { return &table; }
