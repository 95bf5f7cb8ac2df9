/* The traversal does what ref/trace/trace.h says, in that order: hits, lists and counts are those
 * of a walk by calls, for every layout, storage, box test and triangle test. Many triangles are
 * there twice, so that boxes are as far and hits as near as others. */
#include "ref/packed/packed_walk.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/built.h"
#include "tests/support/walk_by_call.h"

#define RAYS  24u
#define TRIS  96u
#define LISTS 3u

static struct scene scene;
static struct bvh bvh;
static struct ray ray[RAYS];

/* Triangles on whole numbers, each second one like the one before, in an order that parts them. */
static int make(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct rng rng = rng_make(3, 1);
    scene = trees_grid(TRIS);
    for (uint32_t prim = 0; prim < TRIS / 2; prim++) {
        float *v = scene.vertex + 9 * (size_t)prim;
        for (uint32_t c = 0; c < 9; c++)
            v[c] = (c < 3 ? 0 : v[c % 3]) + (float)rng_below(&rng, 4) - (c < 3 ? 2.0f : 1.0f);
        memcpy(v + 9 * (size_t)(TRIS / 2), v, 9 * sizeof *v);
    }
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = (struct ray){.tmax = i % 5 ? 100 : 0.75f};
        for (uint32_t k = 0; k < 3; k++) {
            bool along = i % 3 == 0 && k != i / 3 % 3; /* an axis */
            ray[i].org[k] = rng_range(&rng, -4, 4) * (along ? 0.25f : 1);
            ray[i].dir[k] = along ? 0 : rng_range(&rng, -1, 1) - ray[i].org[k];
        }
    }
    return bvh_build(builder_find("median"), &scene, &options, &bvh, NULL) ? 1 : 0;
}

static int drop(void **state)
{
    (void)state;
    bvh_free(&bvh);
    scene_free(&scene);
    return 0;
}

static void expect_list(const struct job *job, uint32_t i, const struct called *want)
{
    struct hit list[LISTS + 1];
    struct trace_counts counts = {7, 9};
    for (uint32_t room = 0; room <= LISTS; room++) {
        uint32_t count = 77, kept = want->found < room ? want->found : room;
        memset(list, 0x5A, sizeof list);
        assert_int_equal(
            trace_ray_all(job, &ray[i], room, room ? list : NULL, &count, room ? NULL : &counts),
            STATUS_OK);
        assert_int_equal(count, want->found);
        assert_memory_equal(list, want->list, kept * sizeof *list);
        assert_int_equal(list[kept].prim, 0x5A5A5A5A);
    }
    assert_int_equal(counts.boxes, 7 + want->counts.boxes);
    assert_int_equal(counts.tris, 9 + want->counts.tris);
}

/* Returns how many rays hit something. */
static uint32_t expect_rays(const struct job *job)
{
    static struct called want[RAYS];
    struct hit hits[RAYS];
    uint32_t flags[RAYS], work[RAYS], hit_count = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        walk_by_call(job, &ray[i], &want[i]);
        if (job->query == QUERY_ALL) {
            expect_list(job, i, &want[i]);
            hit_count += want[i].found > 0;
            continue;
        }
        struct trace_counts counts = {3, 5};
        struct hit hit;
        assert_int_equal(trace_ray(job, &ray[i], &hit, &counts), STATUS_OK);
        assert_memory_equal(&hit, &want[i].best, sizeof hit);
        assert_int_equal(counts.boxes, 3 + want[i].counts.boxes);
        assert_int_equal(counts.tris, 5 + want[i].counts.tris);
        hit_count += hit.prim != ABI_NO_PRIM;
    }
    for (uint32_t rays = 1; job->query != QUERY_ALL && rays <= RAYS; rays += RAYS - 1) {
        memset(hits, 0x5A, sizeof hits);
        memset(flags, 0x5A, sizeof flags);
        assert_int_equal(trace_rays(job, ray, rays, hits, flags, rays == 1 ? NULL : work),
                         STATUS_OK);
        for (uint32_t i = 0; i < rays; i++) {
            assert_memory_equal(&hits[i], &want[i].best, sizeof *hits);
            assert_int_equal(flags[i], ABI_FLAG_DONE);
            if (rays > 1)
                assert_int_equal(work[i], want[i].counts.boxes << 16 | want[i].counts.tris);
        }
    }
    return hit_count;
}

/* With a stack and, if the layout can, without. */
static uint32_t expect_queries(struct job job, uint32_t *linked)
{
    uint32_t hits = 0;
    uint32_t *links = NULL;
    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        job.query = (enum query)query;
        hits += expect_rays(&job);
    }
    if (packed_links(job.packed, &links, NULL) == STATUS_OK) {
        job.parent = links;
        for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
            job.query = (enum query)query;
            expect_rays(&job);
        }
        ++*linked;
    }
    free(links);
    return hits;
}

static void each_layout_is_walked_in_order(void **state)
{
    (void)state;
    uint32_t hits = 0, trees = 0, linked = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        struct packed packed;
        if (packed_make(layouts_all[l], &bvh, &scene, &packed, NULL))
            continue;
        for (uint32_t b = 0; box_tests[b]; b++)
            hits += expect_queries((struct job){.scene = &scene,
                                                .packed = &packed,
                                                .box = box_tests[b],
                                                .tri = tri_tests[(l + b) % 2]},
                                   &linked);
        packed_free(&packed);
        trees++;
    }
    assert_true(trees > 20 && linked > 12 && hits > trees * RAYS);
}

static void each_storage_and_pair_of_tests_is_walked_in_order(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "cwbvh80"};
    uint32_t hits = 0, pairs = 0, linked = 0;
    for (size_t s = 0; tri_stores[s]; s++)
        for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
            struct packed packed;
            if (packed_make_stored(layout_find(names[l]), tri_stores[s], &bvh, &scene, &packed,
                                   NULL))
                continue;
            for (uint32_t b = 0; box_tests[b]; b++)
                for (uint32_t t = 0; tri_tests[t]; t++) {
                    const struct job job = {.scene = &scene,
                                            .packed = &packed,
                                            .box = box_tests[b],
                                            .tri = tri_tests[t]};
                    if (tri_store_check(packed.store, job.tri->id, job.tri->name, NULL))
                        continue;
                    hits += expect_queries(job, &linked);
                    pairs++;
                }
            packed_free(&packed);
        }
    assert_true(pairs > 30 && linked > 15 && hits > pairs * RAYS);
}

/* --- decoding --------------------------------------------------------------------------------- */

static const struct layout *plain;
static uint32_t loads;

static void load_counted(const struct packed *packed, uint32_t ref, struct wide *out)
{
    loads++;
    plain->load(packed, ref, out);
}

/* Of at least as many rays as there are nodes, all nodes are decoded, once; of fewer, each ray
 * decodes what it visits. The answers are the same. */
static void nodes_are_decoded_once_if_there_are_rays_enough(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "cwbvh80"};
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        struct packed packed;
        plain = layout_find(names[l]);
        struct layout counting = *plain;
        counting.load = load_counted;
        assert_int_equal(packed_make(plain, &bvh, &scene, &packed, NULL), STATUS_OK);
        packed.layout = &counting;
        const struct job job = {.scene = &scene,
                                .packed = &packed,
                                .box = box_test_find("robust"),
                                .tri = tri_test_find("mt")};
        for (uint32_t rays = packed.ref_count - 2; rays < packed.ref_count + 2; rays++) {
            struct ray *many = calloc(rays, sizeof *many);
            struct hit *got = calloc(rays, sizeof *got), want;
            uint32_t *flag = calloc(rays, sizeof *flag), each = 0;
            assert_true(many && got && flag);
            for (uint32_t i = 0; i < rays; i++)
                many[i] = ray[i % RAYS];
            loads = 0;
            assert_int_equal(trace_rays(&job, many, rays, got, flag, NULL), STATUS_OK);
            const uint32_t taken = loads;
            for (uint32_t i = 0; i < rays; i++) {
                loads = 0;
                assert_int_equal(trace_ray(&job, &many[i], &want, NULL), STATUS_OK);
                assert_memory_equal(&got[i], &want, sizeof want);
                each += loads;
            }
            assert_true(each != packed.ref_count);
            assert_int_equal(taken, rays < packed.ref_count ? each : packed.ref_count);
            free(many), free(got), free(flag);
        }
        packed_free(&packed);
    }
}

/* --- stacks ----------------------------------------------------------------------------------- */

/* A chain of copies of one triangle, all of whose boxes the ray meets: packed as it is, whatever a
 * stack would have to hold, and `need` is believed. *deepest: what it truly needs, if it packs. */
static struct packed chain(const char *layout, uint32_t count, uint32_t need, struct scene *of,
                           uint32_t *deepest)
{
    static const float v[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    *of = trees_copies(count, v);
    struct bvh tree = trees_make(of, 1, TREES_LEFT);
    struct packed out = {.store = tri_stores[0]}, whole;
    const struct layout *as = layout_find(layout);
    assert_int_equal(as->pack(as, &tree, of, &out, NULL), STATUS_OK);
    out.layout = as;
    out.store = tri_stores[0];
    out.tri_count = count;
    out.stack_need = need;
    *deepest = 0;
    if (packed_make(as, &tree, of, &whole, NULL) == STATUS_OK) {
        *deepest = whole.stack_need;
        packed_free(&whole);
    }
    bvh_free(&tree);
    return out;
}

/* Every hit is found, or the ray is not finished. Returns which. */
static bool finishes(const struct packed *tree, const struct scene *of, bool linked)
{
    const struct ray along = {{1, 1, -5}, 0, {0, 0, 1}, 100};
    uint32_t *links = NULL, found;
    if (linked)
        assert_int_equal(packed_links(tree, &links, NULL), STATUS_OK);
    const struct job job = {.scene = of,
                            .packed = tree,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("mt"),
                            .parent = links};
    enum status status = trace_ray_all(&job, &along, 0, NULL, &found, NULL);
    assert_int_equal(found, status ? 0 : of->tri_count);
    free(links);
    return status == STATUS_OK;
}

/* What the tree needs is enough and one less is not; and however much is allowed, there are no more
 * entries than ABI_STACK_MAX, or ABI_STACK_WIDE, nor levels of a walk without a stack. */
static void a_stack_holds_what_is_needed_and_no_more_than_there_is(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "rf16", "cwbvh80", "half4"};
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        const bool wide = layout_is_wide(layout_find(names[l]));
        const uint32_t most = wide ? ABI_STACK_WIDE : ABI_STACK_MAX;
        uint32_t last = 0, ends = 0;
        for (uint32_t count = wide ? most / 2 : most - 9; count < 2 * most + 9; count++) {
            struct scene of;
            uint32_t need;
            struct packed tree = chain(names[l], count, 4 * most, &of, &need);
            assert_true(need <= most);
            assert_int_equal(finishes(&tree, &of, false), need > 0);
            if (!wide)
                assert_int_equal(finishes(&tree, &of, true), count <= most + 1);
            for (uint32_t less = 0; need && less < 2; less++) {
                tree.stack_need = need - less;
                assert_int_equal(finishes(&tree, &of, false), !less);
            }
            ends += last == most && need == 0;
            last = need > 0 ? need : last;
            packed_free(&tree);
            scene_free(&of);
        }
        assert_true(last == most && ends > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_layout_is_walked_in_order),
        cmocka_unit_test(each_storage_and_pair_of_tests_is_walked_in_order),
        cmocka_unit_test(nodes_are_decoded_once_if_there_are_rays_enough),
        cmocka_unit_test(a_stack_holds_what_is_needed_and_no_more_than_there_is),
    };
    return cmocka_run_group_tests_name("trace_order", tests, make, drop);
}
