#include "ref/judge/leaks.h"

#include "ref/trace/all_hits.h"
#include "ref/twin/twin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays traced at a time. */
#define BATCH 65536u

const char *leak_aim_name(enum leak_aim aim)
{
    static const char *const names[LEAK_AIMS] = {"vertex", "midpoint", "edge", "beside"};
    return aim < LEAK_AIMS ? names[aim] : "unknown";
}

struct leak_tally leaks_total(const struct leaks *leaks)
{
    struct leak_tally sum = {0};
    for (enum leak_aim aim = 0; aim < LEAK_AIMS; aim++) {
        const struct leak_tally *t = &leaks->tally[aim];
        sum.rays += t->rays;
        sum.misses += t->misses;
        sum.empty += t->empty;
        sum.doubles += t->doubles;
        sum.even += t->even;
        sum.lost += t->lost;
        sum.phantoms += t->phantoms;
        sum.repeated += t->repeated;
    }
    return sum;
}

/* Words mixed one after the other (the finaliser of MurmurHash3). */
static uint64_t mix(uint64_t digest, const void *data, size_t bytes)
{
    uint32_t word;
    const unsigned char *at = data, *end = at + bytes;
    for (; at < end; at += sizeof word) {
        memcpy(&word, at, sizeof word);
        digest = (digest ^ word) * 0xFF51AFD7ED558CCDu;
        digest ^= digest >> 33;
    }
    return digest;
}

static void keep(struct leaks *out, const struct leak_rays *rays, size_t i, const uint32_t *pair)
{
    if (out->finding_count == LEAK_FINDINGS)
        return;
    struct leak_finding *finding = &out->finding[out->finding_count++];
    *finding = (struct leak_finding){.is_double = pair != NULL,
                                     .aim = (enum leak_aim)rays->aim[i],
                                     .ray_index = i,
                                     .ray = rays->ray[i],
                                     .prim = {ABI_NO_PRIM, ABI_NO_PRIM}};
    if (pair)
        memcpy(finding->prim, pair, sizeof finding->prim);
}

static enum status count_misses(const struct leak_rays *rays, const struct engine *engine,
                                void *self, const struct job *job, struct leaks *out,
                                uint64_t *digest, struct reason *reason)
{
    struct job closest = *job;
    closest.query = QUERY_CLOSEST;
    struct hit *hit = alloc_zeroed(BATCH, sizeof *hit);
    if (!hit)
        return fail(reason, STATUS_MEMORY, "no memory for %u hits", BATCH);
    enum status status = engine->prepare(self, &closest, reason);
    for (size_t at = 0; at < rays->ray_count && !status; at += BATCH) {
        size_t part = rays->ray_count - at < BATCH ? rays->ray_count - at : BATCH;
        struct trace_report report = {0};
        status = engine->trace(self, rays->ray + at, part, hit, &report, reason);
        out->ns += report.ns;
        for (size_t i = 0; i < part && !status; i++) {
            struct leak_tally *tally = &out->tally[rays->aim[at + i]];
            tally->rays++;
            if (digest)
                digest[at + i] = mix(0, &hit[i], sizeof hit[i]);
            if (hit[i].prim != ABI_NO_PRIM)
                continue;
            tally->misses++;
            keep(out, rays, at + i, NULL);
        }
    }
    free(hit);
    return status;
}

static int facing(const struct oracle *oracle, const struct ray *ray, uint32_t prim)
{
    struct oracle_pair pair;
    oracle_pair(oracle, ray, prim, &pair);
    return pair.det;
}

/* True if the fan of `p` is a ring all of which the ray sees from side `side`. */
static bool fan_is_flat(const struct topology *topology, const struct oracle *oracle,
                        const struct ray *ray, uint32_t p, int side)
{
    if (!topology_fan_is_ring(topology, p))
        return false;
    for (uint32_t i = topology->fan_first[p]; i < topology->fan_first[p + 1]; i++)
        if (facing(oracle, ray, topology->fan[i]) != side)
            return false;
    return true;
}

/* True if `a` and `b` have a point in common whose fan lets the ray hit only one of them. */
static bool share_flat_fan(const struct topology *topology, const struct oracle *oracle,
                           const struct ray *ray, uint32_t a, uint32_t b, int side)
{
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < 3; j++) {
            uint32_t p = topology->corner[3 * (size_t)a + i];
            if (p == topology->corner[3 * (size_t)b + j] &&
                fan_is_flat(topology, oracle, ray, p, side))
                return true;
        }
    return false;
}

/* True if the triangles are one or have a point in common. */
static bool touch(const struct topology *topology, uint32_t a, uint32_t b)
{
    const uint32_t *p = topology->corner + 3 * (size_t)a, *q = topology->corner + 3 * (size_t)b;
    for (size_t i = 0; i < 9; i++)
        if (p[i / 3] == q[i % 3])
            return true;
    return false;
}

static bool exclude(const struct topology *topology, const struct oracle *oracle,
                    const struct ray *ray, uint32_t a, uint32_t b)
{
    if (!touch(topology, a, b)) /* most pairs, without exact arithmetic */
        return false;
    int side = facing(oracle, ray, a);
    if (side == 0 || facing(oracle, ray, b) != side)
        return false;
    return topology_shared_edge(topology, a, b) != TOPOLOGY_NONE ||
           share_flat_fan(topology, oracle, ray, a, b, side);
}

size_t leaks_extra(const struct topology *topology, const struct oracle *oracle,
                   const struct ray *ray, const uint32_t *prim, size_t count, uint32_t pair[2],
                   uint32_t *group)
{
    size_t extra = 0;
    for (size_t i = 0; i < count; i++) {
        group[i] = (uint32_t)i;
        for (size_t k = 0; k < i; k++) {
            if (group[k] == group[i] || !exclude(topology, oracle, ray, prim[k], prim[i]))
                continue;
            if (pair && extra == 0) {
                pair[0] = prim[k];
                pair[1] = prim[i];
            }
            extra++;
            for (size_t j = 0, old = group[i]; j <= i; j++)
                if (group[j] == old)
                    group[j] = group[k];
        }
    }
    return extra;
}

/* The engine whose lists are counted. */
struct lister {
    const struct leak_rays *rays;
    struct model model;
};

static struct twin twin_of(const struct lister *lister, const struct ray *ray, uint32_t prim)
{
    float v[3][3];
    scene_tri(oracle_scene(lister->rays->oracle), prim, v);
    return twin_eval(lister->model.formula, lister->model.rounding, ray, v);
}

/* True if the formula cannot reject `prim`, which the ray crosses inside, without accepting one
 * that touches it: no sign is open, or around the corners of each open edge the ray sees one side
 * only. Else it is within a rounding of a silhouette and may pass both walls that meet there. */
static bool is_wall(const struct lister *lister, const struct ray *ray, uint32_t prim)
{
    if (lister->model.formula == TWIN_UNKNOWN)
        return true;
    const struct topology *topology = lister->rays->topology;
    struct twin twin = twin_of(lister, ray, prim);
    if (twin.certain)
        return true;
    for (uint32_t c = 0; c < 3; c++) {
        uint32_t p = topology->corner[3 * (size_t)prim + c];
        if (twin.edge[(c + 1) % 3] != 0 && twin.edge[(c + 2) % 3] != 0)
            continue;
        if (twin.det == 0 || !topology_fan_is_ring(topology, p))
            return false;
        for (uint32_t i = topology->fan_first[p]; i < topology->fan_first[p + 1]; i++)
            if (twin_of(lister, ray, topology->fan[i]).det != twin.det)
                return false;
    }
    return true;
}

/* Compares a list with the exact crossings of its ray. Rounding may choose among triangles that
 * touch; what touches none is another wall, unless the formula may err so far. */
static enum status count_walls(const struct lister *lister, size_t i, const uint32_t *prim,
                               size_t count, struct leak_tally *tally, struct reason *reason)
{
    const struct leak_rays *rays = lister->rays;
    struct oracle_crossing *crossing = NULL;
    const struct ray *ray = &rays->ray[i];
    size_t capacity = 0, crossings = 0;
    bool lost = false, phantom = false;
    enum status status =
        oracle_crossings(rays->oracle, ray, INFINITY, &crossing, &capacity, &crossings, reason);
    for (size_t c = 0; c < crossings && !status; c++) {
        bool listed = crossing[c].pair.class != ORACLE_INSIDE;
        for (size_t k = 0; k < count && !listed; k++)
            listed = touch(rays->topology, prim[k], crossing[c].prim);
        lost = lost || (!listed && is_wall(lister, ray, crossing[c].prim));
    }
    for (size_t k = 0; k < count && !status; k++) {
        bool met = false;
        for (size_t c = 0; c < crossings && !met; c++)
            met = touch(rays->topology, prim[k], crossing[c].prim);
        phantom = phantom || (!met && (lister->model.formula == TWIN_UNKNOWN ||
                                       !twin_of(lister, ray, prim[k]).possible));
    }
    tally->lost += lost;
    tally->phantoms += phantom;
    free(crossing);
    return status;
}

static int by_prim(const void *left, const void *right)
{
    const struct hit *a = left, *b = right;
    return order_numbers(a->prim, b->prim);
}

/* Counts one ray's list and sorts it by triangle; `scratch` has room for two numbers a hit. */
static enum status count_list(const struct lister *lister, size_t i, struct hit *hit, size_t hits,
                              uint32_t *scratch, struct leaks *out, struct reason *reason)
{
    const struct leak_rays *rays = lister->rays;
    struct leak_tally *tally = &out->tally[rays->aim[i]];
    uint32_t *prim = scratch, *group = scratch + hits, pair[2];
    size_t count = 0;
    qsort(hit, hits, sizeof *hit, by_prim);
    for (size_t k = 0; k < hits; k++)
        if (hit[k].prim < rays->topology->tri_count && (k == 0 || hit[k].prim != hit[k - 1].prim))
            prim[count++] = hit[k].prim;
    tally->repeated += count < hits;
    tally->empty += count == 0;
    tally->even += count % 2 == 0;
    size_t extra =
        leaks_extra(rays->topology, rays->oracle, &rays->ray[i], prim, count, pair, group);
    if (extra > 0) {
        tally->doubles++;
        keep(out, rays, i, pair);
    }
    if ((count - extra) % 2 == 1)
        return STATUS_OK;
    return count_walls(lister, i, prim, count, tally, reason);
}

/* Counts the lists of the rays from `at` on. */
static enum status count_lists_of(const struct lister *lister, size_t at, struct all_hits *all,
                                  struct leaks *out, uint64_t *digest, struct reason *reason)
{
    enum status status = STATUS_OK;
    uint32_t *scratch = alloc_zeroed(2 * all->first[all->done], sizeof *scratch);
    if (!scratch)
        return fail(reason, STATUS_MEMORY, "no memory to count hits");
    for (size_t i = 0; i < all->done && !status; i++) {
        struct hit *hit = all->hit + all->first[i];
        size_t hits = all->first[i + 1] - all->first[i];
        if (digest)
            digest[at + i] = mix(digest[at + i] + hits, hit, hits * sizeof *hit);
        status = count_list(lister, at + i, hit, hits, scratch, out, reason);
    }
    free(scratch);
    return status;
}

static enum status count_lists(const struct leak_rays *rays, const struct engine *engine,
                               void *self, const struct job *job, struct leaks *out,
                               uint64_t *digest, struct reason *reason)
{
    struct job every = *job;
    struct all_hits all = {.once = job->packed && job->packed->split};
    every.query = QUERY_ALL;
    enum status status = engine->prepare(self, &every, reason);
    struct lister lister = {rays, {.formula = TWIN_UNKNOWN}};
    if (!status && engine->model)
        lister.model = engine_model(engine, self, job->tri);
    for (size_t at = 0; at < rays->ray_count && !status; at += all.done) {
        uint64_t start = time_ns();
        status = all_hits_next(engine, self, rays->ray + at, rays->ray_count - at, &all, reason);
        out->ns += time_ns() - start;
        if (!status)
            status = count_lists_of(&lister, at, &all, out, digest, reason);
    }
    all_hits_free(&all);
    return status;
}

enum status leaks_count(const struct leak_rays *rays, const struct engine *engine, void *self,
                        const struct job *job, struct leaks *out, uint64_t *digest,
                        struct reason *reason)
{
    *out = (struct leaks){.lists = engine_lists(engine, self)};
    enum status status = count_misses(rays, engine, self, job, out, digest, reason);
    if (!status && out->lists)
        status = count_lists(rays, engine, self, job, out, digest, reason);
    return status;
}

/* Vulkan specification, Ray Traversal, Watertightness. */
static const struct leak_profile profile_vulkan = {
    .name = "vulkan",
    .summary = "should neither miss nor hit twice at shared edges and closed fans of one winding",
};
/* DirectX Raytracing functional specification, ray-triangle intersection. */
static const struct leak_profile profile_dxr = {
    .name = "dxr",
    .summary = "no miss, and exactly one triangle reported at a shared edge or vertex",
    .misses_must = true,
    .doubles_must = true,
};

const struct leak_profile *const leak_profiles[] = {&profile_vulkan, &profile_dxr, NULL};

const struct leak_profile *leak_profile_find(const char *name)
{
    for (size_t i = 0; leak_profiles[i]; i++)
        if (strcmp(leak_profiles[i]->name, name) == 0)
            return leak_profiles[i];
    return NULL;
}
