/* Engines with scenes and worlds, matches, builders, layouts, storages and scenes hold no more
 * memory after each time (tests/laws/in_use.h). */
#define _GNU_SOURCE /* setenv */
#include "tests/gpu/fake_engines.h"

#include "ref/match/match.h"
#include "ref/packed/packed_walk.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/packed_world.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include "tests/laws/in_use.h"

#define COUNT 200u
#define ROOM  8u

/* --- engines ---------------------------------------------------------------------------------- */

static struct {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    uint32_t *links;
    struct ray ray[COUNT];
    struct world world;
    struct packed_world packed_world;
    struct ray *world_ray;
    struct ray_mode *mode;
    struct hit hit[COUNT * ROOM];
    uint32_t tag[COUNT * ROOM], found[COUNT];
    void *kept; /* an engine that is opened once */
} all;

static void use(const struct engine *engine, void *self)
{
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        const struct job job = {.scene = &all.scene,
                                .packed = engine->needs_packed ? &all.packed : NULL,
                                .box = box_test_find("robust"),
                                .tri = tri_test_find("mt"),
                                .query = query,
                                .parent = engine->needs_packed ? all.links : NULL};
        struct reason reason = {""};
        struct trace_report report;
        if (engine->prepare(self, &job, &reason))
            continue;
        if (query == QUERY_ALL && engine->trace_all)
            (void)engine->trace_all(self, all.ray, COUNT, ROOM, all.hit, all.found, &reason);
        else if (query != QUERY_ALL)
            (void)engine->trace(self, all.ray, COUNT, all.hit, &report, &reason);
    }
}

static void use_world(const struct engine *engine, void *self)
{
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        const struct world_job job = {.world = &all.world,
                                      .packed = engine->needs_packed ? &all.packed_world : NULL,
                                      .box = box_test_find("robust"),
                                      .tri = tri_test_find("mt"),
                                      .query = query};
        struct reason reason = {""};
        struct trace_report report;
        if (engine->worlds->prepare_world(self, &job, &reason))
            continue;
        if (query != QUERY_ALL)
            (void)engine->worlds->trace_world(self, all.world_ray, all.mode, COUNT, all.hit,
                                              all.tag, &report, &reason);
        else if (engine->worlds->trace_world_all)
            (void)engine->worlds->trace_world_all(self, all.world_ray, all.mode, COUNT, ROOM,
                                                  all.hit, all.tag, all.found, &reason);
    }
}

static enum status open_one(const struct engine *engine, void **self)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    fake.run = all_done;
    return engine_open(engine, &options, self, &reason);
}

static void open_and_close(const void *what)
{
    const struct engine *engine = what;
    void *self;
    assert_int_equal(open_one(engine, &self), STATUS_OK);
    use(engine, self);
    if (engine->worlds)
        use_world(engine, self);
    engine->close(self);
}

static void prepare_again(const void *what)
{
    use(what, all.kept);
}

static void prepare_worlds_again(const void *what)
{
    use_world(what, all.kept);
}

static void engines_hold_no_more(void **state)
{
    (void)state;
    size_t played = 0;
    assert_int_equal(setenv("RAYDIFF_VULKAN_LIBRARY", "", 1), 0);
    for (size_t i = 0; engines[i]; i++) {
        const struct engine *engine = engines[i];
        fake_reset();
        if (open_one(engine, &all.kept))
            continue;
        must_hold_no_more(engine->name, "prepared again, it", prepare_again, engine);
        if (engine->worlds)
            must_hold_no_more(engine->name, "prepared for a world again, it", prepare_worlds_again,
                              engine);
        engine->close(all.kept);
        must_hold_no_more(engine->name, "opened and closed, it", open_and_close, engine);
        played++;
    }
    assert_int_equal(unsetenv("RAYDIFF_VULKAN_LIBRARY"), 0);
    assert_true(played >= 9);
}

/* --- matches ---------------------------------------------------------------------------------- */

static struct match_options match_options_of(enum query query)
{
    return (struct match_options){.builder = builder_find("median"),
                                  .build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT},
                                  .box = box_test_find("robust"),
                                  .tri = tri_test_find("mt"),
                                  .query = query,
                                  .repeats = 1,
                                  .brute_budget = 100000,
                                  .brute_rays = 10};
}

/* Rows of several engines, among them such as are compared with one engine and another. */
static void run_rows(struct match *match)
{
    static struct engine beside[2]; /* with the same answers as others */
    static const char *const names[] = {"cpu",        "fast",          "brute", "cpu_stackless",
                                        "fast_small", "embree_robust", "fast",  "cpu"};
    struct row row;
    for (size_t i = 0; i < ARRAY_COUNT(names); i++)
        if (engine_find(names[i]))
            match_run(match, engine_find(names[i]), &row);
    for (size_t i = 0; i < 2; i++) {
        beside[i] = *engine_find("cpu");
        beside[i].plain = engine_find(i ? "fast" : "brute");
        match_run(match, &beside[i], &row);
        assert_ptr_equal(row.against,
                         match->options.query == QUERY_ALL ? row.against : beside[i].plain);
    }
}

static void match_scene(const void *what)
{
    const struct match_options options = match_options_of(*(const enum query *)what);
    struct pool pool = {.options = {.threads = 1, .device = -1}};
    struct match match;
    struct reason reason = {""};
    gpu_must(match_make(&all.scene, all.ray, COUNT, &options, &pool, &match, &reason), &reason);
    for (int i = 0; i < 2; i++) {
        gpu_must(match_pack(&match, layout_find(i ? "rf16" : "f32"), &reason), &reason);
        run_rows(&match);
    }
    gpu_must(match_rebuild(&match, builder_find("lbvh"), &options.build, options.tri, &reason),
             &reason);
    match_free(&match);
    pool_free(&pool);
}

static void match_world(const void *what)
{
    const struct match_options options = match_options_of(*(const enum query *)what);
    struct pool pool = {.options = {.threads = 1, .device = -1}};
    struct match match;
    struct reason reason = {""};
    gpu_must(match_make_world(&all.world, all.world_ray, all.mode, COUNT, &options, &pool, &match,
                              &reason),
             &reason);
    for (int i = 0; i < 2; i++) {
        gpu_must(match_pack(&match, layout_find(i ? "rf16" : "f32"), &reason), &reason);
        run_rows(&match);
    }
    match_free(&match);
    pool_free(&pool);
}

static void matches_hold_no_more(void **state)
{
    (void)state;
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        must_hold_no_more(query_name(query), "a match of a scene", match_scene, &query);
        must_hold_no_more(query_name(query), "a match of a world", match_world, &query);
    }
}

/* --- trees ------------------------------------------------------------------------------------ */

static void build(const void *what)
{
    const struct builder *builder = what;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    if (builder->build(&all.scene, &options, &bvh, NULL) == STATUS_OK)
        bvh_free(&bvh);
}

static void pack_stores(const void *what)
{
    const struct layout *layout = what;
    struct reason reason = {""};
    for (size_t s = 0; tri_stores[s]; s++) {
        struct packed packed;
        if (packed_make_stored(layout, tri_stores[s], &all.bvh, &all.scene, &packed, &reason) ==
            STATUS_OK)
            packed_free(&packed);
    }
}

static void open_scene(const void *what)
{
    struct scene scene;
    struct reason reason = {""};
    gpu_must(scene_open(what, 1, &scene, &reason), &reason);
    scene_free(&scene);
}

static void open_world(const void *what)
{
    struct world world;
    struct reason reason = {""};
    gpu_must(world_open(what, 1, &world, &reason), &reason);
    world_free(&world);
}

static void trees_and_scenes_hold_no_more(void **state)
{
    (void)state;
    static const char *const scenes[] = {"soup:n=50", "sphere:n=4", "cornell", "flake:n=1",
                                         "needles:n=50"};
    static const char *const worlds[] = {"mixed", "crowd:n=4"};
    for (size_t i = 0; builders_all[i]; i++)
        must_hold_no_more(builders_all[i]->name, "building", build, builders_all[i]);
    for (size_t i = 0; layouts_all[i]; i++)
        must_hold_no_more(layouts_all[i]->name, "packing", pack_stores, layouts_all[i]);
    for (size_t i = 0; i < ARRAY_COUNT(scenes); i++)
        must_hold_no_more(scenes[i], "opening", open_scene, scenes[i]);
    for (size_t i = 0; i < ARRAY_COUNT(worlds); i++)
        must_hold_no_more(worlds[i], "opening", open_world, worlds[i]);
}

/* --- */

static int make_all(void **state)
{
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    const struct world_build of = {.top = builder_find("median"),
                                   .bottom = builder_find("median"),
                                   .top_options = options,
                                   .bottom_options = options};
    struct world_trees trees;
    struct reason reason = {""};
    (void)state;
    all.scene = generated("soup:n=60");
    all.bvh = median(&all.scene, 2);
    all.packed = pack("f32", &all.bvh, &all.scene);
    gpu_must(packed_links(&all.packed, &all.links, &reason), &reason);
    gpu_must(ray_set_make(ray_sets[0], &all.scene, 1, COUNT, all.ray, &reason), &reason);
    gpu_must(world_open("mixed", 1, &all.world, &reason), &reason);
    gpu_must(world_rays_new(&all.world, ray_sets[0], RAY_MODES_MIXED, 1, COUNT, &all.world_ray,
                            &all.mode, &reason),
             &reason);
    gpu_must(world_trees_make(&all.world, &of, &trees, &reason), &reason);
    gpu_must(packed_world_make(&all.world, &trees, layout_find("f32"), layout_find("f32"),
                               tri_stores[0], &all.packed_world, &reason),
             &reason);
    world_trees_free(&trees);
    return 0;
}

static int free_all(void **state)
{
    (void)state;
    packed_world_free(&all.packed_world);
    world_free(&all.world);
    free(all.world_ray);
    free(all.mode);
    free(all.links);
    packed_free(&all.packed);
    bvh_free(&all.bvh);
    scene_free(&all.scene);
    return 0;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_forgotten_is_seen),
        cmocka_unit_test(engines_hold_no_more),
        cmocka_unit_test(matches_hold_no_more),
        cmocka_unit_test(trees_and_scenes_hold_no_more),
    };
    keep_nothing(argc, argv);
    assert_int_equal(unsetenv("RAYDIFF_VALIDATE"), 0); /* the layer is for drivers */
    return cmocka_run_group_tests_name("freed", tests, make_all, free_all);
}
