/* Ends of the number formats in each slot, axis and side of nodes: engines find along the axes, and
 * slanted from beside them, what they find there without a tree (tests/tree/test_ends_places.c has
 * what is stored). */
#include "ref/engine.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/groups.h"

#include <float.h>

#define TREES_MOST 3200u

/* No subnormals, of vertices: a driver may flush those in the test of the triangle. */
static const float ends[] = {0.0f,     FLT_MIN,       0x1p-100f,    0x1p-25f,
                             0x1p-24f, 0x1p-15f,      0x1.ffcp-15f, 0x1.002p-14f,
                             65504.0f, 0x1.0001p+10f, 65505.0f};

struct end_tree {
    struct groups groups;
    struct packed packed;
    struct ray ray[END_RAYS];
    struct hit got[END_RAYS];
    uint32_t flag[END_RAYS];
    float value;
};

static struct end_tree *trees;
static size_t tree_count, hit_count;

/* Adds the trees of a value in all slots, of those that the layout takes. */
static void add_trees(const struct layout *layout, float value)
{
    for (uint32_t s = 0; s < layout->width; s++)
        for (int axis = 0; axis < 3; axis++)
            for (enum bound_side side = 0; side < SIDES; side++)
                for (uint32_t below = 0; below < 2; below++) {
                    struct end_tree *tree = &trees[tree_count];
                    struct groups *g = &tree->groups;
                    *tree = (struct end_tree){.value = value};
                    uint32_t prim = groups_of_one(g, layout, s, below);
                    groups_fill(g);
                    bool possible = groups_put_end(&g->scene, prim, axis, side, value);
                    groups_grow(g);
                    if (!possible || packed_make(layout, &g->bvh, &g->scene, &tree->packed, NULL)) {
                        groups_free(g);
                        continue;
                    }
                    for (uint32_t k = 0; k < END_RAYS; k++)
                        tree->ray[k] = groups_end_ray(&g->scene, prim, k);
                    assert_true(++tree_count < TREES_MOST);
                }
}

static void drop_trees(void)
{
    for (size_t i = 0; i < tree_count; i++) {
        packed_free(&trees[i].packed);
        groups_free(&trees[i].groups);
    }
}

static struct job job_of(const struct end_tree *tree)
{
    return (struct job){.scene = &tree->groups.scene,
                        .packed = &tree->packed,
                        .box = box_test_find("watertight"),
                        .tri = tri_test_find("woop"),
                        .query = QUERY_CLOSEST};
}

static void answer(const struct engine *engine, void *self)
{
    struct engine_task *task = calloc(tree_count + 1, sizeof *task);
    struct reason reason = {""};
    struct trace_report report;
    assert_non_null(task);
    for (size_t i = 0; i < tree_count; i++) {
        struct end_tree *tree = &trees[i];
        struct job job = job_of(tree);
        task[i] = (struct engine_task){.job = job,
                                       .ray = tree->ray,
                                       .ray_count = END_RAYS,
                                       .hit = tree->got,
                                       .flag = tree->flag};
        if (!engine->trace_tasks &&
            (engine->prepare(self, &job, &reason) ||
             engine->trace(self, tree->ray, END_RAYS, tree->got, &report, &reason)))
            fail_msg("%s: %s", engine->name, reason.text);
    }
    if (engine->trace_tasks && engine->trace_tasks(self, task, tree_count, &reason))
        fail_msg("%s: %s", engine->name, reason.text);
    for (size_t i = 0; i < tree_count; i++)
        if (task[i].status)
            fail_msg("%s: %s", engine->name, task[i].reason.text);
    free(task);
}

static void expect_answers(const struct engine *engine, void *self)
{
    answer(engine, self);
    for (size_t i = 0; i < tree_count; i++)
        for (uint32_t k = 0; k < END_RAYS; k++) {
            const struct end_tree *tree = &trees[i];
            const struct hit *got = &tree->got[k];
            struct job job = job_of(tree);
            struct hit want;
            trace_brute(job.scene, job.tri, job.query, &tree->ray[k], &want);
            bool hits = want.prim != ABI_NO_PRIM;
            hit_count += hits;
            if ((got->prim != ABI_NO_PRIM) != hits || (hits && got->t != want.t))
                fail_msg("%s, %s, tree %zu with %a: triangle %d at %a, not %d at %a", engine->name,
                         tree->packed.layout->name, i, (double)tree->value, (int)got->prim,
                         (double)got->t, (int)want.prim, (double)want.t);
        }
}

static void engines_find_what_is_there(const char *name, const char *const *layout, size_t count)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct engine *engine = engine_find(name);
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine, &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    assert_int_equal(status, STATUS_OK);
    trees = calloc(TREES_MOST, sizeof *trees);
    assert_non_null(trees);
    hit_count = 0;
    for (size_t l = 0; l < count; l++) {
        tree_count = 0;
        for (size_t e = 0; e < 2 * ARRAY_COUNT(ends); e++)
            add_trees(layout_find(layout[l]), e % 2 ? -ends[e / 2] : ends[e / 2]);
        expect_answers(engine, self);
        drop_trees();
    }
    assert_true(hit_count > 500 * count);
    free(trees);
    engine->close(self);
}

static const char *const of_shaders[] = {
    "f32",          "rf16",           "cwbvh80",       "half4",          "amd64_f16",
    "amd64_f32",    "tiny8",          "bvh2_f16_node", "bvh4_u10_scene", "bvh4_f32_world",
    "bvh8_u8_node", "bvh8_bf16_world"};

static void shaders_find_what_is_there(void **state)
{
    (void)state;
    engines_find_what_is_there("vulkan", of_shaders, ARRAY_COUNT(of_shaders));
}

static void fast_finds_what_is_there(void **state)
{
    (void)state;
    engines_find_what_is_there("fast", of_shaders, ARRAY_COUNT(of_shaders));
    engines_find_what_is_there("fast_small", of_shaders, ARRAY_COUNT(of_shaders));
}

static void without_a_stack_it_is_there(void **state)
{
    (void)state;
    engines_find_what_is_there("cpu_stackless", of_shaders, 2);
    engines_find_what_is_there("vulkan_stackless", of_shaders, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_find_what_is_there),
        cmocka_unit_test(fast_finds_what_is_there),
        cmocka_unit_test(without_a_stack_it_is_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
