#include "tests/hard/cache.h"

#include "ref/trace/trace.h"

#include <math.h>
#include <stdlib.h>

static bool in_range(const struct scene *scene)
{
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++) {
        float x = fabsf(scene->vertex[i]);
        if (x != 0.0f && !(x >= 0x1p-60f && x <= 0x1p40f))
            return false;
    }
    return true;
}

static enum status make_world(const struct hard_part *part, struct hard_cache *out,
                              struct reason *reason)
{
    const struct match_options options = {
        .builder = builders_all[0],
        .build = {.leaf = part->leaf ? part->leaf : BUILD_LEAF_DEFAULT, .eps = BUILD_EPS_DEFAULT},
        .box = box_tests[0],
        .tri = tri_tests[0],
        .repeats = 2,
        .brute_budget = UINT64_MAX};
    return match_make_world(&part->world, part->ray, part->mode, part->ray_count, &options, NULL,
                            &out->match, reason);
}

size_t cache_truly(const struct hard_cache *cache)
{
    const struct oracle_answer *truth = cache->match.truth ? cache->match.truth : cache->truth;
    size_t count = 0;
    for (size_t i = 0; truth && i < cache->part->ray_count; i++)
        count += truth[i].prim != ABI_NO_PRIM;
    return count;
}

enum status cache_make(const struct hard_part *part, struct hard_cache *out, struct reason *reason)
{
    *out = (struct hard_cache){.part = part};
    if (part->is_world)
        return make_world(part, out, reason);
    out->answer = alloc_zeroed(part->ray_count + 1, sizeof *out->answer);
    out->again = alloc_zeroed(part->ray_count + 1, sizeof *out->again);
    out->cpu = alloc_zeroed(part->ray_count + 1, sizeof *out->cpu);
    out->open = alloc_zeroed(part->ray_count + 1, sizeof *out->open);
    out->judged = alloc_zeroed(part->ray_count + 1, sizeof *out->judged);
    out->in_range = in_range(&part->scene);
    if (!out->answer || !out->again || !out->cpu || !out->open || !out->judged)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", part->ray_count);
    if (part->bad_scene)
        return STATUS_OK;
    enum status status = oracle_make(&part->scene, &out->oracle, reason);
    if (status)
        return status;
    out->truth = alloc_zeroed(part->ray_count, sizeof *out->truth);
    if (!out->truth)
        return fail(reason, STATUS_MEMORY, "no memory for %zu rays", part->ray_count);
    return oracle_closest(out->oracle, ORACLE_AUTO, ORACLE_CLOSED, part->ray, part->ray_count, 1,
                          out->truth, NULL, reason);
}

void cache_free(struct hard_cache *cache)
{
    for (size_t i = 0; i < cache->judge_count; i++)
        judge_free(cache->judge[i].judge);
    for (size_t i = 0; i < CACHE_TRIS; i++)
        free(cache->brute[i]);
    match_free(&cache->match);
    oracle_free(cache->oracle);
    bvh_free(&cache->bvh);
    packed_free(&cache->packed);
    free(cache->truth);
    free(cache->answer);
    free(cache->again);
    free(cache->cpu);
    free(cache->open);
    free(cache->judged);
    *cache = (struct hard_cache){0};
}

static void build(struct hard_cache *cache, const struct builder *builder)
{
    const struct hard_part *part = cache->part;
    struct build_options options = {.leaf = part->leaf ? part->leaf : BUILD_LEAF_DEFAULT,
                                    .eps = part->deep ? 0 : BUILD_EPS_DEFAULT};
    bvh_free(&cache->bvh);
    cache->builder = builder;
    cache->layout = NULL;
    cache->built = builder->build(&part->scene, &options, &cache->bvh, &cache->reason);
}

enum status cache_pack(struct hard_cache *cache, const struct hard_member *member)
{
    if (cache->builder != member->builder)
        build(cache, member->builder);
    if (cache->built)
        return cache->built;
    if (cache->layout != member->layout) {
        packed_free(&cache->packed);
        cache->layout = member->layout;
        cache->checked = false;
        cache->cpu_valid = false;
        cache->reason.text[0] = '\0';
        cache->made = packed_make(member->layout, &cache->bvh, &cache->part->scene, &cache->packed,
                                  &cache->reason);
    }
    return cache->made;
}

const struct hit *cache_brute(struct hard_cache *cache, const struct tri_test *tri)
{
    const struct hard_part *part = cache->part;
    struct hit **hit = &cache->brute[tri->id];
    if (*hit)
        return *hit;
    *hit = alloc_zeroed(part->ray_count, sizeof **hit);
    if (!*hit)
        return NULL;
    struct hit *out = *hit;
    bool heavy = part->ray_count * (uint64_t)part->scene.tri_count > 1000000;
#pragma omp parallel for schedule(dynamic, 16) if (heavy)
    for (long long i = 0; i < (long long)part->ray_count; i++)
        trace_brute(&part->scene, tri, QUERY_CLOSEST, &part->ray[i], &out[i]);
    return out;
}

enum status cache_judge(struct hard_cache *cache, const struct hard_member *member,
                        const struct model *model, struct judge **out, struct reason *reason)
{
    for (size_t i = 0; i < cache->judge_count; i++) {
        const struct hard_judge *at = &cache->judge[i];
        if (at->engine == member->engine && at->tri == member->tri && at->query == member->query &&
            at->watertight == model->watertight) {
            *out = at->judge;
            return STATUS_OK;
        }
    }
    if (cache->judge_count == CACHE_JUDGES) { /* no room: start again */
        for (size_t i = 0; i < cache->judge_count; i++)
            judge_free(cache->judge[i].judge);
        cache->judge_count = 0;
    }
    enum status status = judge_make(cache->oracle, model, member->query, out, reason);
    if (status)
        return status;
    cache->judge[cache->judge_count++] =
        (struct hard_judge){member->engine, member->tri, member->query, model->watertight, *out};
    return STATUS_OK;
}

struct job cache_job(const struct hard_cache *cache, const struct hard_member *member)
{
    return (struct job){.scene = &cache->part->scene,
                        .packed = member->engine->needs_packed ? &cache->packed : NULL,
                        .box = member->box,
                        .tri = member->tri,
                        .query = member->query};
}
