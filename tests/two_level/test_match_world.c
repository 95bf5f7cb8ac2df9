/* Matches over worlds: honest engines agree, whatever the world and the rays; a scene in a world is
 * the scene. */
#include "tests/two_level/world_match.h"

#include "scenes/worlds.h"

#define RAYS 150

/* Engines of ours on the processor; others have tests of their own. */
static bool runs_here(const struct engine *engine)
{
    return engine->worlds && !engine->gpu && !engine->library;
}

/* Rows of every engine and query; returns how many hits they have together. */
static size_t run_all(struct world_play *p, const char *what)
{
    size_t hits = 0;
    for (size_t e = 0; engines[e]; e++)
        for (int q = QUERY_CLOSEST; q <= QUERY_ALL && runs_here(engines[e]); q++) {
            play_run(p, engines[e], (enum query)q);
            assert_world_agrees(p, what);
            assert_int_equal(p->row.layout != NULL, engines[e]->needs_packed);
            hits += p->row.hits;
        }
    return hits;
}

/* Smaller than the generators' own sizes. */
static const char *small(const char *generator)
{
    static const char *const specs[] = {"crowd:n=60", "twins:k=6", "placed-far:count=4",
                                        "nest:n=2,count=8"};
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++)
        if (strncmp(specs[i], generator, strlen(generator)) == 0)
            return specs[i];
    return generator;
}

static void honest_engines_agree_on_every_world(void **state)
{
    (void)state;
    for (size_t g = 0; world_generators[g]; g++) {
        struct world world;
        struct reason reason = {""};
        size_t hits[RAY_MODES_COUNT];
        if (world_open(small(world_generators[g]->name), 1, &world, &reason))
            fail_msg("%s", reason.text);
        for (int m = 0; m < RAY_MODES_COUNT; m++) {
            struct world_play *p = play_world(&world, (enum ray_modes)m, RAYS);
            hits[m] = run_all(p, world_generators[g]->name);
            play_done(p);
        }
        assert_true(hits[RAY_MODES_ALL] > hits[RAY_MODES_MIXED]);
        assert_true(hits[RAY_MODES_MIXED] > hits[RAY_MODES_DRAWN]);
        world_free(&world);
    }
}

/* Layouts, triangle tests and builders of the tables in turn. */
static void honest_engines_agree_on_every_member(void **state)
{
    (void)state;
    struct world world = fixture_world("needles:n=60", WORLD_TURNED, 5, 2);
    struct reason reason = {""};
    struct world_play *p = play_world(&world, RAY_MODES_MIXED, RAYS);
    size_t layouts_run = 0, split = 0;
    for (size_t b = 0; builders_all[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++) {
            const size_t at = b * 7 + t;
            size_t count = 0;
            while (layouts[count])
                count++;
            const struct layout *layout = layouts[at % count];
            if (builders_all[b]->faithful || layout->faithful ||
                match_rebuild(&p->match, builders_all[b], &p->options.build, tri_tests[t],
                              &reason) ||
                match_pack(&p->match, layout, &reason))
                continue;
            layouts_run++;
            split += p->match.packed_world.split;
            for (int q = QUERY_CLOSEST; q <= QUERY_ALL; q++) {
                play_run(p, engine_find("cpu"), (enum query)q);
                if (p->row.judged)
                    assert_world_agrees(p, layout->name);
            }
        }
    assert_true(layouts_run > 10 && split > 0);
    play_done(p);
    world_free(&world);
}

/* A split tree lists triangles twice; rays along them meet several of their boxes. */
static void lists_of_split_trees_have_each_triangle_once(void **state)
{
    (void)state;
    struct world world = fixture_world("needles:n=500", WORLD_TURNED, 2, 2);
    struct world_play *p = play_world(&world, RAY_MODES_ALL, 2000);
    const struct build_options much = {.leaf = 2, .split_budget = 3};
    if (match_rebuild(&p->match, builder_find("sbvh"), &much, p->options.tri, &p->reason) ||
        match_pack(&p->match, layout_find("f32"), &p->reason))
        fail_msg("%s", p->reason.text);
    assert_true(p->match.packed_world.split);
    play_run(p, engine_find("cpu"), QUERY_ALL);
    assert_world_agrees(p, "split");
    play_done(p);
    world_free(&world);
}

/* --- scenes as worlds ------------------------------------------------------------------------- */

static void assert_same_row(const struct row *a, const struct row *b)
{
    assert_int_equal(a->status, ROW_OK);
    assert_int_equal(b->status, ROW_OK);
    assert_int_equal(a->rays, b->rays);
    assert_int_equal(a->hits, b->hits);
    assert_int_equal(a->compared, b->compared);
    assert_memory_equal(a->count, b->count, sizeof a->count);
    assert_memory_equal(a->wrong, b->wrong, sizeof a->wrong);
    assert_int_equal(a->bit_differences, b->bit_differences);
    assert_int_equal(a->differences, b->differences);
    assert_int_equal(a->lists.triangles, b->lists.triangles);
    assert_true(a->worst_over == b->worst_over);
    assert_int_equal(a->bits, b->bits);
    assert_int_equal(a->judged, b->judged);
}

static void assert_same_truth(const struct match *a, const struct match *b)
{
    for (size_t i = 0; i < a->ray_count; i++) {
        assert_int_equal(a->truth[i].tie_count, b->truth[i].tie_count);
        if (a->truth[i].tie_count == 1) /* else it may be any of them */
            assert_int_equal(a->truth[i].prim, b->truth[i].prim);
        assert_int_equal(a->truth[i].class, b->truth[i].class);
    }
}

static void a_scene_in_a_world_is_the_scene(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=200", "sphere:n=6", "cornell", "needles:n=60"};
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++) {
        struct scene scene;
        struct world world;
        struct reason reason = {""};
        struct match match;
        if (scene_open(specs[s], 1, &scene, &reason) || world_of_scene(&scene, &world, &reason) ||
            world_finish(&world, &reason))
            fail_msg("%s", reason.text);
        struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
        if (match_make(&scene, p->ray, RAYS, &p->options, &p->pool, &match, &reason) ||
            match_pack(&match, layout_find("f32"), &reason))
            fail_msg("%s", reason.text);
        assert_same_truth(&p->match, &match);
        for (size_t e = 0; engines[e]; e++)
            for (int q = QUERY_CLOSEST; q <= QUERY_ALL && runs_here(engines[e]); q++) {
                struct row row;
                play_run(p, engines[e], (enum query)q);
                match_set(&match, p->options.box, (enum query)q);
                match_run(&match, engines[e], &row);
                assert_same_row(&p->row, &row);
                assert_true(p->row.of_world && !row.of_world);
                assert_memory_equal(p->match.answer, match.answer, row.rays * sizeof *match.answer);
            }
        match_free(&match);
        play_done(p);
        world_free(&world);
        scene_free(&scene);
    }
}

/* Placed by powers of two, permutations, mirrors and whole numbers, with vertices of few bits:
 * baking rounds nothing. */
static void a_world_is_its_baked_scene(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 4; seed++) {
        struct world world = fixture_world("sphere:n=4", WORLD_MIRRORED, 6, seed);
        for (uint32_t i = 0; i < 3 * world.mesh->scene->vertex_count; i++)
            world.mesh->scene->vertex[i] = rintf(256 * world.mesh->scene->vertex[i]) / 256;
        struct scene baked;
        struct reason reason = {""};
        struct match match;
        struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
        if (world_bake(&world, UINT32_MAX, &baked, &reason) ||
            match_make(&baked, p->ray, RAYS, &p->options, &p->pool, &match, &reason) ||
            match_pack(&match, layout_find("f32"), &reason))
            fail_msg("%s", reason.text);
        assert_same_truth(&p->match, &match);
        for (size_t e = 0; engines[e]; e++)
            for (int q = QUERY_CLOSEST; q <= QUERY_ALL && runs_here(engines[e]); q++) {
                struct row row;
                play_run(p, engines[e], (enum query)q);
                assert_world_agrees(p, "placed exactly");
                match_set(&match, p->options.box, (enum query)q);
                match_run(&match, engines[e], &row);
                assert_int_equal(row.differences, 0);
            }
        match_free(&match);
        scene_free(&baked);
        play_done(p);
        world_free(&world);
    }
}

/* Modes that are all are none. */
static void no_modes_are_all_modes(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=60,size=0.6", WORLD_TURNED, 7, 3);
    struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
    struct match none;
    if (match_make_world(&world, p->ray, NULL, RAYS, &p->options, &p->pool, &none, &p->reason) ||
        match_pack(&none, layout_find("f32"), &p->reason))
        fail_msg("%s", p->reason.text);
    for (int q = QUERY_CLOSEST; q <= QUERY_ALL; q++) {
        struct row row;
        play_run(p, engine_find("cpu"), (enum query)q);
        match_set(&none, p->options.box, (enum query)q);
        match_run(&none, engine_find("cpu"), &row);
        assert_same_row(&p->row, &row);
    }
    match_free(&none);
    play_done(p);
    world_free(&world);
}

/* More lists than are made at once: each is of its ray's mode. */
static void long_matches_have_their_modes(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=20,size=0.6", WORLD_TURNED, 3, 3);
    for (uint32_t i = 0; i < world.instance_count; i++)
        world.instance[i].mask = 1u << i;
    struct world_play *p = play_world(&world, RAY_MODES_DRAWN, 20000);
    play_run(p, engine_find("cpu"), QUERY_ALL);
    assert_world_agrees(p, "long");
    assert_true(p->row.lists.triangles > p->row.hits);
    play_done(p);
    world_free(&world);
}

/* A world that no ray hits proves nothing. */
static void a_world_without_hits_is_vacuous(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=60,size=0.6", WORLD_TURNED, 3, 3);
    struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
    for (uint32_t i = 0; i < world.instance_count; i++)
        world.instance[i].mask = 0;
    struct match match;
    if (match_make_world(&world, p->ray, p->mode, RAYS, &p->options, &p->pool, &match,
                         &p->reason) ||
        match_pack(&match, layout_find("f32"), &p->reason))
        fail_msg("%s", p->reason.text);
    for (int q = QUERY_CLOSEST; q <= QUERY_ALL; q++) {
        struct row row;
        match_set(&match, p->options.box, (enum query)q);
        match_run(&match, engine_find("cpu"), &row);
        assert_int_equal(row.status, ROW_VACUOUS);
        assert_int_equal(row.hits, 0);
        assert_true(row_failed(&row));
    }
    match_free(&match);
    play_done(p);
    world_free(&world);
}

/* The top has a builder and a layout of its own where the options name them. */
static void tops_may_be_others(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=60,size=0.6", WORLD_TURNED, 9, 3);
    struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
    const struct layout *f32 = layout_find("f32"), *rf16 = layout_find("rf16");
    for (int other = 0; other < 2; other++) {
        struct match_options options = p->options;
        options.top_builder = other ? builder_find("lbvh") : NULL;
        options.top_layout = other ? rf16 : NULL;
        struct match match;
        if (match_make_world(&world, p->ray, p->mode, RAYS, &options, &p->pool, &match,
                             &p->reason) ||
            match_pack(&match, f32, &p->reason))
            fail_msg("%s", p->reason.text);
        assert_ptr_equal(match.packed_world.top.layout, other ? rf16 : f32);
        assert_ptr_equal(match.packed_world.bottom[0].layout, f32);
        assert_ptr_equal(match_layout(&match), f32);
        const struct bvh *mine = &match.trees.top, *its = &p->match.trees.top;
        const bool same = mine->node_count == its->node_count &&
                          memcmp(mine->prim, its->prim, its->prim_count * sizeof *its->prim) == 0;
        assert_int_equal(same, !other);
        match_run(&match, engine_find("cpu"), &p->row);
        assert_world_agrees(p, "top of its own");
        assert_true(p->row.judged);
        match_free(&match);
        options.top_layout = layout_find("rtrs_direct");
        if (match_make_world(&world, p->ray, p->mode, RAYS, &options, &p->pool, &match,
                             &p->reason) ||
            match_pack(&match, f32, &p->reason))
            fail_msg("%s", p->reason.text);
        match_run(&match, engine_find("cpu"), &p->row);
        assert_false(p->row.judged); /* as published */
        match_free(&match);
    }
    play_done(p);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(honest_engines_agree_on_every_world),
        cmocka_unit_test(honest_engines_agree_on_every_member),
        cmocka_unit_test(lists_of_split_trees_have_each_triangle_once),
        cmocka_unit_test(a_scene_in_a_world_is_the_scene),
        cmocka_unit_test(a_world_is_its_baked_scene),
        cmocka_unit_test(no_modes_are_all_modes),
        cmocka_unit_test(long_matches_have_their_modes),
        cmocka_unit_test(a_world_without_hits_is_vacuous),
        cmocka_unit_test(tops_may_be_others),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
