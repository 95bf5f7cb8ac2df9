/* Memory that runs out while answers are compared and explained: each allocation in turn fails. */
#include "tests/support/allocations.h"

#include "ref/explain/judged.h"
#include "ref/look/look_decoded.h"
#include "ref/look/numbers.h"
#include "ref/match/match.h"
#include "ref/match/original.h"
#include "ref/scene/topology.h"
#include "ref/store.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "tests/support/built.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/each_fails.h"

#define RAYS 40

/* Everything of one scene; what is worked on in turn. */
struct suspects {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    struct ray ray[RAYS];
    const struct engine *engine;
    enum query query;
    bool moved; /* the tree is of the scene at rest, and refitted */
};

static void start(struct suspects *s, const char *layout)
{
    struct reason reason = {""};
    const struct build_options build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    *s = (struct suspects){.engine = engine_find("cpu")};
    if (scene_open("soup:n=30", 3, &s->scene, &reason) ||
        ray_set_make(ray_sets[0], &s->scene, 3, RAYS, s->ray, NULL) ||
        builder_find("median")->build(&s->scene, &build, &s->bvh, &reason) ||
        packed_make(layout_find(layout), &s->bvh, &s->scene, &s->packed, &reason))
        fail_msg("%s", reason.text);
}

static void end(struct suspects *s)
{
    packed_free(&s->packed);
    bvh_free(&s->bvh);
    scene_free(&s->scene);
}

static enum status do_explain_tree(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct explain_tree tree;
    enum status status = explain_tree_make(&s->scene, &s->bvh, &s->packed, &tree, reason);
    if (status)
        assert_true(!tree.exact && !tree.record && !tree.node && !tree.parent && !tree.leaf);
    explain_tree_free(&tree);
    return status;
}

static enum status do_numbers(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct numbers *numbers = NULL;
    enum status status =
        numbers_make(&s->scene, &s->bvh, &s->packed, box_tests[0], tri_tests[0], &numbers, reason);
    if (status)
        assert_null(numbers);
    numbers_free(numbers);
    return status;
}

static enum status do_decoded(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct bvh bvh;
    enum status status = decoded_tree(&s->packed, &s->scene, &bvh, reason);
    if (status)
        assert_true(!bvh.node && !bvh.prim);
    bvh_free(&bvh);
    return status;
}

static void what_looks_at_packed_trees(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "cwbvh80"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        struct suspects s;
        start(&s, names[i]);
        assert_true(each_fails("explain_tree", do_explain_tree, &s, 1) > 4);
        assert_true(each_fails("numbers", do_numbers, &s, 1) > 3);
        if (i == 0)
            assert_true(each_fails("decoded", do_decoded, &s, 1) > 1);
        end(&s);
    }
}

/* Later, a ray that cannot be judged for lack of memory is out of contract, and no error. */
static enum status do_judged(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct job job = {.scene = &s->scene,
                            .packed = &s->packed,
                            .box = box_tests[0],
                            .tri = tri_tests[0],
                            .query = QUERY_CLOSEST};
    struct judged judged = {0};
    struct oracle *oracle = NULL;
    void *self = NULL;
    enum status status = engine_open(s->engine, &options, &self, reason);
    if (status)
        return status;
    status = s->engine->prepare(self, &job, reason);
    if (!status)
        status = oracle_make(&s->scene, &oracle, reason);
    if (!status) {
        const struct judged_job from = {
            .engine = s->engine, .self = self, .job = &job, .bvh = &s->bvh, .oracle = oracle};
        status = judged_make(&from, &judged, reason);
    }
    judged_free(&judged);
    oracle_free(oracle);
    s->engine->close(self);
    return status;
}

/* The row tells of memory as a status does, or is right all the same. */
static enum status do_match(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct pool pool = {0};
    struct match match;
    static struct row row;
    const struct match_options options = {.builder = builder_find("median"),
                                          .build = {.leaf = 4, .eps = BUILD_EPS_DEFAULT},
                                          .box = box_tests[0],
                                          .tri = tri_tests[0],
                                          .store = tri_stores[0],
                                          .query = s->query,
                                          .rest = s->moved ? &s->scene : NULL,
                                          .repeats = 2,
                                          .brute_budget = UINT64_MAX};
    enum status status = match_make(&s->scene, s->ray, RAYS, &options, &pool, &match, reason);
    if (status)
        return status;
    status = match_pack(&match, layout_find("f32"), reason);
    if (!status)
        match_run(&match, s->engine, &row);
    if (!status && row.status != ROW_OK) {
        *reason = row.reason;
        status = STATUS_MEMORY;
    }
    match_free(&match);
    pool_free(&pool);
    return status;
}

static enum status do_original(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct original original;
    struct quantised quantised;
    struct scene coarse;
    enum status status = scene_quantise(&s->scene, 12, &coarse, &quantised, reason);
    if (status)
        return status;
    status = original_make(&s->scene, &quantised, s->ray, RAYS, &original, reason);
    if (status)
        assert_true(!original.oracle && !original.truth);
    original_free(&original);
    scene_free(&coarse);
    return status;
}

static enum status do_topology(const void *of, struct reason *reason)
{
    const struct suspects *s = of;
    struct topology topology;
    enum status status = topology_make(&s->scene, &topology, reason);
    topology_free(&topology);
    return status;
}

static void what_compares_answers(void **state)
{
    (void)state;
    static const char *const traced[] = {"cpu", "fast", "fast_small", "brute"};
    struct suspects s;
    start(&s, "f32");
    assert_true(each_fails("topology", do_topology, &s, 1) > 0);
    assert_true(each_fails("original", do_original, &s, 1) > 2);
    assert_true(each_fails("judged", do_judged, &s, 1) > 5);
    for (size_t i = 0; i < ARRAY_COUNT(traced); i++)
        for (s.query = 0; s.query <= QUERY_ALL; s.query++) {
            s.engine = engine_find(traced[i]);
            assert_true(each_fails(traced[i], do_match, &s, 1) > 10);
        }
    s.moved = true;
    s.query = QUERY_CLOSEST;
    s.engine = engine_find("cpu");
    assert_true(each_fails("moved", do_match, &s, 1) > 14);
    end(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_looks_at_packed_trees),
        cmocka_unit_test(what_compares_answers),
    };
    return cmocka_run_group_tests_name("explain_memory", tests, NULL, NULL);
}
