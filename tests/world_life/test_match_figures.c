/* What a match tells of its trees is what its trees have, counted from the trees themselves: of all
 * meshes, of parts of instances, and after steps those of the last one. */
#include "ref/match/match_engine.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"

#include "tests/life/lives.h"
#include "tests/world_life/world_lives.h"

#define RAYS 4u

static uint32_t larger(uint32_t a, uint32_t b)
{
    return a > b ? a : b;
}

static struct bvh_stats stats_of(const struct bvh *bvh, const struct scene *scene)
{
    struct bvh_stats stats;
    assert_int_equal(bvh_count(bvh, scene, &stats, NULL), STATUS_OK);
    return stats;
}

/* `below` has room for each mesh. */
static struct bvh_stats stats_of_world(const struct world *world, const struct world_trees *trees,
                                       struct bvh_stats *below)
{
    struct bvh_stats all = stats_of(&trees->top, &trees->items);
    uint32_t deepest = 0;
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        below[i] = stats_of(&trees->bottom[i], world->mesh[i].scene);
        deepest = larger(deepest, below[i].depth);
        all.largest_leaf = larger(all.largest_leaf, below[i].largest_leaf);
        all.node_count += below[i].node_count;
        all.leaf_count += below[i].leaf_count;
        all.loose_count += below[i].loose_count;
    }
    all.depth += deepest;
    return all;
}

static struct match_options options_of(uint32_t leaf, const struct match_life *life)
{
    return (struct match_options){.builder = builder_find("sah_sweep"),
                                  .build = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT},
                                  .box = box_tests[0],
                                  .tri = tri_tests[0],
                                  .query = QUERY_CLOSEST,
                                  .life = life,
                                  .repeats = 1};
}

/* A match of a world, packed; its rays are freed with it. */
struct figures {
    struct pool pool;
    struct match match;
    struct ray *ray;
    struct ray_mode *mode;
};

static struct figures *figures_make(const struct world *world, const struct match_options *options,
                                    const char *layout)
{
    struct figures *f = calloc(1, sizeof *f);
    struct reason reason = {""};
    assert_non_null(f);
    if (world_rays_new(world, ray_set_find("mixed"), RAY_MODES_MIXED, 3, RAYS, &f->ray, &f->mode,
                       &reason) ||
        match_make_world(world, f->ray, f->mode, RAYS, options, &f->pool, &f->match, &reason) ||
        match_pack(&f->match, layout_find(layout), &reason))
        fail_msg("%s", reason.text);
    return f;
}

static void figures_free(struct figures *f)
{
    match_free(&f->match);
    pool_free(&f->pool);
    free(f->ray);
    free(f->mode);
    free(f);
}

static void worlds_are_counted_whole(void **state)
{
    (void)state;
    static const char *const specs[] = {"mixed", "crowd:n=30", "placed-turned:count=9",
                                        "twins:k=3"};
    static const char *const layouts_here[] = {"f32", "rf16", "cwbvh80"};
    uint32_t later_smaller = 0, with_parts = 0;
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++)
        for (uint32_t how = 0; how < 6; how++) {
            struct match_options options = options_of(how % 2 ? 7 : 2, NULL);
            struct bvh_stats below[64];
            struct world world;
            assert_int_equal(world_open(specs[s], 3, &world, NULL), STATUS_OK);
            options.braid = how % 3 ? 16 : 0;
            struct figures *f = figures_make(&world, &options, layouts_here[how % 3]);
            const struct bvh_stats is = stats_of_world(&world, &f->match.trees, below);
            assert_memory_equal(&f->match.stats, &is, sizeof is);
            later_smaller += below[world.mesh_count - 1].largest_leaf < is.largest_leaf;
            const struct packed_world *packed = &f->match.packed_world;
            struct row row = {.status = ROW_OK};
            match_row_bytes(&f->match, &row);
            assert_int_equal(row.node_bytes + row.item_bytes, packed_world_bytes(packed));
            with_parts += packed->entry_count > packed->instance_count;
            figures_free(f);
            world_free(&world);
        }
    assert_true(later_smaller > 1 && with_parts > 4);
}

static const char *const steps[] = {"rebuild:jitter", "rebuild:swap:3,rebuild:jitter:1",
                                    "refit:jitter:1,rebuild:one:2", "refit:jitter:2",
                                    "rebuild:jitter,refit:mirror:1,refit:swap:2"};

static bool same_stats(const struct bvh_stats *a, const struct bvh_stats *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* The trees at the end are what is traced; most differ in form from those at the beginning. */
static void a_life_is_counted_at_its_end(void **state)
{
    (void)state;
    uint32_t others = 0;
    for (size_t s = 0; s < ARRAY_COUNT(steps); s++) {
        struct world_lived *lived = world_lived_make("mixed", steps[s]);
        struct match_life life = {.world = lived->world, .count = lived->count};
        struct bvh_stats below[64];
        for (uint32_t i = 0; i < lived->count; i++)
            life.act[i] = lived->step[i].act;
        const struct match_options options = options_of(3, &life);
        struct figures *f = figures_make(&lived->world[lived->count], &options, "f32");
        const struct world_life *last = &f->match.lived[lived->count];
        const struct bvh_stats is =
            stats_of_world(&lived->world[lived->count], &last->trees, below);
        const struct bvh_stats was =
            stats_of_world(&lived->world[0], &f->match.lived[0].trees, below);
        assert_memory_equal(&f->match.stats, &is, sizeof is);
        others += !same_stats(&is, &was);
        figures_free(f);
        world_lived_free(lived);
    }
    assert_true(others > 1);
}

static void a_life_of_a_scene_is_counted_at_its_end(void **state)
{
    (void)state;
    uint32_t others = 0;
    for (size_t s = 0; s < ARRAY_COUNT(steps); s++) {
        struct lived lived = lived_make("soup:n=80", steps[s]);
        struct match_life life = {.scene = lived.scene, .count = lived.count};
        const struct scene *scene = &lived.scene[lived.count];
        struct pool pool = {.count = 0};
        struct ray ray[RAYS];
        struct match match;
        struct reason reason = {""};
        for (uint32_t i = 0; i < lived.count; i++)
            life.act[i] = lived.step[i].act;
        const struct match_options options = options_of(3, &life);
        if (ray_set_make(ray_set_find("mixed"), scene, 3, RAYS, ray, &reason) ||
            match_make(scene, ray, RAYS, &options, &pool, &match, &reason) ||
            match_pack(&match, layout_find("f32"), &reason))
            fail_msg("%s", reason.text);
        const struct bvh_stats is = stats_of(&match.tree[lived.count].bvh, scene),
                               was = stats_of(&match.tree[0].bvh, &lived.scene[0]);
        assert_memory_equal(&match.stats, &is, sizeof is);
        others += !same_stats(&is, &was);
        match_free(&match);
        pool_free(&pool);
        lived_free(&lived);
    }
    assert_true(others > 1);
}

/* Times of parts, which follow each other, are no more than that of the whole. */
static void times_add_up_to_no_more_than_the_whole(void **state)
{
    (void)state;
    struct lived lived = lived_make("soup:n=20000", "refit:jitter:9");
    struct match_options options = options_of(4, NULL);
    struct pool pool = {.count = 0};
    struct ray ray[RAYS];
    struct match match;
    struct reason reason = {""};
    options.builder = builder_find("lbvh63");
    options.rest = &lived.scene[0];
    assert_int_equal(ray_set_make(ray_set_find("mixed"), &lived.scene[1], 3, RAYS, ray, &reason),
                     STATUS_OK);
    uint64_t begun = time_ns();
    assert_int_equal(match_make(&lived.scene[1], ray, RAYS, &options, &pool, &match, &reason),
                     STATUS_OK);
    assert_true(match.refit.build_ns > 0 && match.refit.build_ns <= time_ns() - begun);
    begun = time_ns();
    assert_int_equal(match_pack(&match, layout_find("f32"), &reason), STATUS_OK);
    const uint64_t whole = time_ns() - begun;
    assert_true(match.refit.pack_ns > 0 && match.refit.refit_ns > 0);
    assert_true(match.refit.pack_ns + match.refit.refit_ns <= whole);
    match_free(&match);
    pool_free(&pool);
    lived_free(&lived);
}

/* Boxes of parts of triangles do not contain their triangles, in any mesh of a world. */
static void no_split_tree_keeps_a_test_watertight(void **state)
{
    (void)state;
    uint32_t kept = 0, lost = 0;
    for (size_t b = 0; box_tests[b]; b++)
        for (int split = 0; split < 2; split++) {
            struct match_options options = options_of(2, NULL);
            struct world world;
            bool any = false;
            assert_int_equal(world_open("needles:n=300", 3, &world, NULL), STATUS_OK);
            options.builder = builder_find(split ? "sbvh" : "median");
            options.build.split_budget = split ? 3 : -1;
            options.box = box_tests[b];
            struct figures *f = figures_make(&world, &options, "f32");
            for (uint32_t i = 0; i < world.mesh_count; i++)
                any = any || bvh_is_split(&f->match.trees.bottom[i]);
            const bool keeps = match_keeps_watertight(&f->match, engine_find("cpu"));
            assert_int_equal(keeps, box_tests[b]->watertight && !any);
            kept += keeps;
            lost += box_tests[b]->watertight && any;
            figures_free(f);
            world_free(&world);
        }
    assert_true(kept > 0 && lost > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_are_counted_whole),
        cmocka_unit_test(a_life_is_counted_at_its_end),
        cmocka_unit_test(a_life_of_a_scene_is_counted_at_its_end),
        cmocka_unit_test(times_add_up_to_no_more_than_the_whole),
        cmocka_unit_test(no_split_tree_keeps_a_test_watertight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
