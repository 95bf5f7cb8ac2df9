/* Nodes of all numbers of children with leaves of all numbers of items in each slot, and nodes in
 * each slot, as the shaders decode them: a ray at each triangle finds it. */
#include "ref/primitives/primitives.h"
#include "ref/store.h"
#include "tests/support/gpu.h"

#include "tests/support/groups.h"

#define TREES_MOST 640u

/* One of each shader, and of each way that a family stores bounds. */
static const char *const played[] = {
    "f32",          "rf16",      "cwbvh80",         "half4",          "amd64_f16",
    "amd64_f32",    "tiny8_l14", "bvh2_f16_node",   "bvh4_u10_scene", "bvh4_f32_world",
    "bvh8_u8_node", "gfx12",     "bvh8_bf16_world", "hpb64",          "obb8",
};

struct slot_tree {
    struct groups groups;
    struct packed packed;
    struct ray *ray;
    struct hit *hit;
    uint32_t *flag;
};

static struct slot_tree *trees;
static size_t tree_count;

/* The next tree, of what was placed in its groups. */
static void finish_tree(const struct layout *layout)
{
    struct slot_tree *tree = &trees[tree_count++];
    struct groups *g = &tree->groups;
    struct reason reason = {""};
    groups_fill(g);
    groups_grow(g);
    gpu_must(packed_make(layout, &g->bvh, &g->scene, &tree->packed, &reason), &reason);
    tree->ray = calloc(g->total, sizeof *tree->ray);
    tree->hit = calloc(g->total, sizeof *tree->hit);
    tree->flag = calloc(g->total, sizeof *tree->flag);
    assert_true(tree->ray && tree->hit && tree->flag);
    for (uint32_t i = 0; i < g->total; i++)
        tree->ray[i] = groups_ray(g, i);
    assert_true(tree_count < TREES_MOST);
}

static void make_trees(const struct layout *layout)
{
    uint32_t most = groups_leaf_most(layout);
    tree_count = 0;
    memset(trees, 0, TREES_MOST * sizeof *trees);
    for (uint32_t children = 2; children <= layout->width; children++)
        for (uint32_t s = 0; s < children; s++)
            for (uint32_t items = 1; items <= most; items++) {
                groups_of_sizes(&trees[tree_count].groups, children, s, items, most);
                finish_tree(layout);
            }
    for (uint32_t s = 0; s < 2 * layout->width; s++) {
        groups_in_slots(&trees[tree_count].groups, layout, s / 2, s % 2 == 0);
        finish_tree(layout);
    }
}

static void drop_trees(void)
{
    for (size_t i = 0; i < tree_count; i++) {
        free(trees[i].ray);
        free(trees[i].hit);
        free(trees[i].flag);
        packed_free(&trees[i].packed);
        groups_free(&trees[i].groups);
    }
}

static void expect_answers(struct tracer *tracer, const struct layout *layout)
{
    struct engine_task *task = calloc(tree_count, sizeof *task);
    struct reason reason = {""};
    assert_non_null(task);
    for (size_t i = 0; i < tree_count; i++)
        task[i] = (struct engine_task){.job = {.scene = &trees[i].groups.scene,
                                               .packed = &trees[i].packed,
                                               .box = box_test_find("robust"),
                                               .tri = tri_test_find("mt"),
                                               .query = QUERY_CLOSEST},
                                       .ray = trees[i].ray,
                                       .ray_count = trees[i].groups.total,
                                       .hit = trees[i].hit,
                                       .flag = trees[i].flag};
    gpu_must(tracer_trace_tasks(tracer, task, tree_count, &reason), &reason);
    for (size_t i = 0; i < tree_count; i++) {
        gpu_must(task[i].status, &task[i].reason);
        for (uint32_t k = 0; k < trees[i].groups.total; k++)
            if (trees[i].hit[k].prim != k)
                fail_msg("%s: tree %zu of %u groups: a ray at triangle %u finds %d", layout->name,
                         i, trees[i].groups.count, k, (int)trees[i].hit[k].prim);
    }
    free(task);
}

static void shaders_find_every_item_in_every_slot(void **state)
{
    (void)state;
    const struct vk_options options = gpu_options();
    struct tracer *tracer = gpu_tracer(&options, 0);
    trees = calloc(TREES_MOST, sizeof *trees);
    assert_non_null(trees);
    for (size_t l = 0; l < ARRAY_COUNT(played); l++) {
        const struct layout *layout = layout_find(played[l]);
        make_trees(layout);
        expect_answers(tracer, layout);
        drop_trees();
    }
    free(trees);
    gpu_close_tracer(tracer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_find_every_item_in_every_slot),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
