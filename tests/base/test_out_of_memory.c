/* Memory that runs out anywhere between a scene and its hits: each allocation in turn fails, of
 * every builder, layout, storage and engine on the processor. It must be said in one line, with
 * nothing made and nothing kept. */
#include "tests/support/allocations.h"

#include "ref/build/links.h"
#include "ref/builders/reinsert.h"
#include "ref/tree/cover.h"
#include "ref/engine.h"
#include "ref/fast/fast.h"
#include "ref/packed/packed_unpack.h"
#include "ref/packed/packed_walk.h"
#include "ref/scene/quantise.h"
#include "ref/packed/refit.h"
#include "ref/tree/tree_quality.h"
#include "ref/packed/packed_check.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"

/* --- work that is done without one of its allocations ----------------------------------------- */

/* What is to be done; it frees what it makes. */
struct memory_work {
    const char *name;
    const struct scene *scene;
    const struct scene *moved; /* the same triangles, elsewhere */
    const struct bvh *bvh;
    struct packed *packed;
    const struct builder *builder;
    const struct layout *layout;
    const struct tri_store *store;
    const struct engine *engine;
    uint32_t passes, threads;
    bool silent; /* has no reason to give */
    bool small;
};

typedef enum status work_fn(const struct memory_work *work, struct reason *reason);

struct work_of {
    work_fn *fn;
    const struct memory_work *work;
};

static enum status do_work(const void *of, struct reason *reason)
{
    const struct work_of *w = of;
    enum status status = w->fn(w->work, reason);
    if (status == STATUS_MEMORY && w->work->silent)
        (void)(fail)(reason, status, "no memory");
    return status;
}

/* As each_fails. */
static long fail_each(work_fn *fn, const struct memory_work *work, long step)
{
    return each_fails(work->name, do_work, &(struct work_of){fn, work}, step);
}

static enum status do_build(const struct memory_work *work, struct reason *reason)
{
    const struct build_options options = {
        .leaf = 2, .eps = BUILD_EPS_DEFAULT, .passes = work->passes, .threads = work->threads};
    struct bvh bvh = {.node_count = 7};
    enum status status = bvh_build(work->builder, work->scene, &options, &bvh, reason);
    if (status)
        assert_true(!bvh.node && !bvh.prim && bvh.node_count == 0 && bvh.prim_count == 0);
    bvh_free(&bvh);
    return status;
}

static enum status do_pack(const struct memory_work *work, struct reason *reason)
{
    struct packed packed = {.node_count = 7};
    enum status status =
        packed_make_stored(work->layout, work->store, work->bvh, work->scene, &packed, reason);
    if (status)
        assert_true(!packed.word && !packed.item && packed.node_count == 0);
    packed_free(&packed);
    return status;
}

static enum status do_pack_auto(const struct memory_work *work, struct reason *reason)
{
    struct packed packed = {.node_count = 7};
    char refused[400];
    enum status status =
        packed_make_auto(work->bvh, work->scene, &packed, refused, sizeof refused, reason);
    packed_free(&packed);
    return status;
}

static enum status do_check(const struct memory_work *work, struct reason *reason)
{
    return packed_check(work->packed, work->scene, NULL, reason);
}

static enum status do_unpack(const struct memory_work *work, struct reason *reason)
{
    struct bvh bvh;
    enum status status = packed_unpack(work->packed, work->scene, &bvh, reason);
    bvh_free(&bvh);
    return status;
}

static enum status do_links(const struct memory_work *work, struct reason *reason)
{
    uint32_t *parent;
    enum status status = packed_links(work->packed, &parent, reason);
    free(parent);
    return status;
}

/* To other vertices and back. */
static enum status do_refit(const struct memory_work *work, struct reason *reason)
{
    enum status status = packed_refit(work->packed, work->moved, reason);
    bool is_moved = !status;
    if (!status)
        status = packed_refit(work->packed, work->scene, reason);
    if (!status)
        return status;
    atomic_store(&until_failure, -1); /* it is as it was before that call */
    assert_int_equal(packed_check(work->packed, is_moved ? work->moved : work->scene, NULL, NULL),
                     STATUS_OK);
    if (is_moved)
        assert_int_equal(packed_refit(work->packed, work->scene, NULL), STATUS_OK);
    return status;
}

static enum status do_tree_refit(const struct memory_work *work, struct reason *reason)
{
    struct bvh copy = *work->bvh;
    return bvh_refit(&copy, work->scene, reason);
}

static enum status do_tree_check(const struct memory_work *work, struct reason *reason)
{
    return bvh_check(work->bvh, work->scene, reason);
}

static enum status do_overlap(const struct memory_work *work, struct reason *reason)
{
    double overlap;
    (void)reason;
    return tree_overlap(work->bvh, work->scene, 0, &overlap);
}

static enum status do_quantise(const struct memory_work *work, struct reason *reason)
{
    struct scene out;
    struct quantised moved;
    enum status status = scene_quantise(work->scene, 12, &out, &moved, reason);
    scene_free(&out);
    return status;
}

static enum status do_fast(const struct memory_work *work, struct reason *reason)
{
    struct fast_tree tree;
    enum status status =
        (work->small ? fast_make_small : fast_make)(work->bvh, work->scene, &tree, reason);
    if (status)
        assert_true(!tree.node && !tree.small && !tree.block && tree.node_count == 0);
    fast_free(&tree);
    return status;
}

#define RAYS 3u

static enum status do_engine(const struct memory_work *work, struct reason *reason)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct ray ray[RAYS] = {{.dir = {0, 0, 1}, .tmax = 1e30f},
                                  {.dir = {0, 1, 0}, .tmax = 1e30f},
                                  {.dir = {1, 0.5f, 0}, .tmax = 1e30f}};
    const struct job job = {.scene = work->scene,
                            .packed = work->packed,
                            .box = box_test_find("robust"),
                            .tri = tri_test_find("woop"),
                            .query = QUERY_CLOSEST};
    struct hit hit[RAYS];
    struct trace_report report;
    void *self = NULL;
    enum status status = engine_open(work->engine, &options, &self, reason);
    if (!status)
        status = work->engine->prepare(self, &job, reason);
    if (!status)
        status = work->engine->trace(self, ray, RAYS, hit, &report, reason);
    if (status && self) { /* is usable when there is memory again */
        atomic_store(&until_failure, -1);
        assert_int_equal(work->engine->prepare(self, &job, NULL), STATUS_OK);
        assert_int_equal(work->engine->trace(self, ray, RAYS, hit, &report, NULL), STATUS_OK);
    }
    work->engine->close(self);
    return status;
}

/* --- all of them -------------------------------------------------------------------------------
 */

/* Builder sbvh splits it. */
static struct bvh tree_of(const struct scene *scene, const char *builder)
{
    const struct build_options options = {
        .leaf = 3, .eps = BUILD_EPS_DEFAULT, .split_budget = 2, .split_alpha = -1};
    struct bvh bvh;
    assert_int_equal(bvh_build(builder_find(builder), scene, &options, &bvh, NULL), STATUS_OK);
    return bvh;
}

static void every_builder(void **state)
{
    (void)state;
    struct scene scene = built_soup(200, 1);
    for (size_t b = 0; builders_all[b]; b++)
        for (uint32_t passes = 0; passes <= (builders_all[b]->faithful ? 0u : 2u); passes += 2)
            for (uint32_t threads = 1; threads <= 2; threads++) {
                struct memory_work work = {.name = builders_all[b]->name,
                                           .scene = &scene,
                                           .builder = builders_all[b],
                                           .passes = passes,
                                           .threads = threads};
                assert_true(fail_each(do_build, &work, 1) >= 3);
            }
    scene_free(&scene);
}

/* Enough triangles that threads have their own parts. */
static void every_builder_of_many_triangles(void **state)
{
    (void)state;
    struct scene scene = built_soup(20000, 1);
    for (size_t b = 0; builders_all[b]; b++) {
        struct memory_work work = {.name = builders_all[b]->name,
                                   .scene = &scene,
                                   .builder = builders_all[b],
                                   .threads = 2};
        fail_each(do_build, &work, 5);
    }
    scene_free(&scene);
}

static void every_layout(void **state)
{
    (void)state;
    struct scene scene = trees_grid(120); /* the same as an item of RTRS's */
    struct bvh bvh = tree_of(&scene, "median");
    for (size_t l = 0; layouts_all[l]; l++) {
        struct memory_work work = {.name = layouts_all[l]->name,
                                   .scene = &scene,
                                   .bvh = &bvh,
                                   .layout = layouts_all[l],
                                   .store = tri_stores[0]};
        assert_true(fail_each(do_pack, &work, 1) >= 2);
    }
    struct memory_work any = {.name = "auto", .scene = &scene, .bvh = &bvh};
    fail_each(do_pack_auto, &any, 1);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void every_storage(void **state)
{
    (void)state;
    struct scene scene = trees_grid(120);
    struct bvh bvh = tree_of(&scene, "sbvh");
    uint32_t played = 0;
    for (size_t s = 0; tri_stores[s]; s++)
        for (size_t l = 0; layouts_all[l]; l++) {
            struct memory_work work = {.name = tri_stores[s]->name,
                                       .scene = &scene,
                                       .bvh = &bvh,
                                       .layout = layouts_all[l],
                                       .store = tri_stores[s]};
            if (work.layout->item)
                continue;
            assert_true(fail_each(do_pack, &work, 1) >= 2);
            played++;
        }
    assert_true(played > 20);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Thin triangles, whose boxes are mostly empty. */
static struct scene needles(void)
{
    struct scene scene;
    assert_int_equal(scene_open("needles:n=80", 1, &scene, NULL), STATUS_OK);
    return scene;
}

/* Of a tree, and of a split one. */
static void what_looks_at_trees(void **state)
{
    static const char *const name[] = {"median", "sbvh"};
    (void)state;
    struct scene scene = needles();
    for (size_t b = 0; b < ARRAY_COUNT(name); b++) {
        struct bvh bvh = tree_of(&scene, name[b]);
        struct memory_work work = {.name = name[b], .scene = &scene, .bvh = &bvh};
        assert_true(fail_each(do_tree_check, &work, 1) > 0);
        assert_true(fail_each(do_fast, &work, 1) > 4);
        work.small = true;
        assert_true(fail_each(do_fast, &work, 1) > 4);
        assert_int_equal(bvh_is_split(&bvh), b == 1);
        if (b == 0)
            assert_true(fail_each(do_tree_refit, &work, 1) > 0);
        struct packed packed;
        assert_int_equal(packed_make(layouts[0], &bvh, &scene, &packed, NULL), STATUS_OK);
        work.packed = &packed;
        assert_true(fail_each(do_check, &work, 1) > 1);
        packed_free(&packed);
        work.silent = true;
        assert_true(fail_each(do_overlap, &work, 1) > 0);
        bvh_free(&bvh);
    }
    struct memory_work work = {.name = "quantise", .scene = &scene};
    assert_true(fail_each(do_quantise, &work, 1) > 1);
    scene_free(&scene);
}

static void what_looks_at_packed_trees(void **state)
{
    static const char *const name[] = {"f32", "rf16", "cwbvh80", "bvh4_f16_node", "tiny8"};
    (void)state;
    struct scene scene = trees_grid(50), moved = trees_grid(50);
    for (size_t c = 2; c < 9 * 50; c += 3)
        moved.vertex[c] = (float)(c % 5);
    struct bvh bvh = tree_of(&scene, "median");
    for (size_t l = 0; l < ARRAY_COUNT(name); l++) {
        struct packed packed;
        assert_int_equal(packed_make(layout_find(name[l]), &bvh, &scene, &packed, NULL), STATUS_OK);
        struct memory_work work = {
            .name = name[l], .scene = &scene, .moved = &moved, .packed = &packed};
        assert_true(fail_each(do_check, &work, 1) > 1);
        assert_true(fail_each(do_refit, &work, 1) > 1);
        if (!layout_is_wide(packed.layout)) {
            assert_true(fail_each(do_links, &work, 1) > 1);
            assert_true(fail_each(do_unpack, &work, 1) > 1);
        }
        packed_free(&packed);
    }
    struct packed stored;
    assert_int_equal(packed_make_stored(layout_find("f32"), tri_store_find("gathered"), &bvh,
                                        &scene, &stored, NULL),
                     STATUS_OK);
    struct memory_work leaves = {
        .name = "gathered", .scene = &scene, .moved = &moved, .packed = &stored};
    assert_true(fail_each(do_refit, &leaves, 1) > 1);
    packed_free(&stored);
    bvh_free(&bvh);
    scene_free(&moved);
    scene_free(&scene);
}

static void engines_on_the_processor(void **state)
{
    static const char *const name[] = {"brute",      "cpu", "cpu_stackless", "fast",
                                       "fast_small", "kd",  "dual_split"};
    (void)state;
    struct scene scene = built_soup(40, 7);
    struct bvh bvh = tree_of(&scene, "median");
    struct packed packed;
    assert_int_equal(packed_make(layouts[0], &bvh, &scene, &packed, NULL), STATUS_OK);
    for (size_t e = 0; e < ARRAY_COUNT(name); e++) {
        struct memory_work work = {
            .name = name[e], .scene = &scene, .packed = &packed, .engine = engine_find(name[e])};
        assert_true(fail_each(do_engine, &work, 1) > 0);
    }
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_builder),
        cmocka_unit_test(every_builder_of_many_triangles),
        cmocka_unit_test(every_layout),
        cmocka_unit_test(every_storage),
        cmocka_unit_test(what_looks_at_trees),
        cmocka_unit_test(what_looks_at_packed_trees),
        cmocka_unit_test(engines_on_the_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
