/* Engines that cheat in a world are found, each as what it is. */
#include "tests/two_level/world_match.h"

#include "tests/two_level/world_cheats.h"

#define RAYS 1200

#define KIND(wrong) (1u << WRONG_##wrong)

static const struct lie {
    enum world_cheat cheat;
    const char *name;
    uint32_t closest, all; /* kinds that it must be found as; 0: it is no lie there */
    uint32_t also;         /* kinds that it may be found as besides */
} lies[] = {
    {CHEAT_NONE, "none", 0, 0, 0},
    {CHEAT_NO_MASK, "no mask", KIND(MASKED), KIND(MASKED), 0},
    {CHEAT_MASK_EQUAL, "mask equal", KIND(MISSED), KIND(MISSED), 0},
    {CHEAT_NO_SKIP, "no skip", KIND(MASKED), KIND(MASKED), 0},
    {CHEAT_NO_CULL, "no cull", KIND(CULLED), KIND(CULLED), 0},
    {CHEAT_NO_DISABLE, "no disable", KIND(MISSED), KIND(MISSED), 0},
    {CHEAT_NO_FLIP, "no flip", KIND(FACING) | KIND(CULLED), KIND(FACING) | KIND(CULLED),
     KIND(MISSED)},
    {CHEAT_MIRROR, "mirror", KIND(FACING) | KIND(CULLED), KIND(FACING) | KIND(CULLED),
     KIND(MISSED)},
    {CHEAT_OTHER_FACE, "other face", KIND(FACING), KIND(FACING), 0},
    {CHEAT_NO_OPACITY_CULL, "no opacity cull", KIND(OPACITY), KIND(OPACITY), 0},
    {CHEAT_NO_FORCE, "no force", KIND(OPACITY) | KIND(MISSED), KIND(OPACITY) | KIND(MISSED), 0},
    {CHEAT_NO_RAY_OPACITY, "no ray opacity", KIND(OPACITY) | KIND(MISSED),
     KIND(OPACITY) | KIND(MISSED), 0},
    {CHEAT_NO_FILTER, "no filter", KIND(OPACITY), KIND(OPACITY), 0},
    {CHEAT_PASS_OVER, "pass over", KIND(MISSED), KIND(MISSED), 0},
    {CHEAT_FIRST_PASSED, "first passed", KIND(MISSED), 0, 0},
    {CHEAT_NO_FIRST, "no first", 0, 0, 0},
    {CHEAT_INSTANCE_0, "instance 0", KIND(MISSED), KIND(MISSED), 0},
    {CHEAT_INDEX, "index", KIND(INSTANCE), KIND(INSTANCE), 0},
    {CHEAT_CUT, "cut", KIND(INSTANCE), KIND(INSTANCE), 0},
    {CHEAT_MISS_TAG, "miss tag", KIND(INSTANCE), 0, 0},
    {CHEAT_NOT_CARRIED, "not carried", KIND(MISSED), 0, 0},
    {CHEAT_LAST_TRANSFORM, "last transform", KIND(INSTANCE), KIND(INSTANCE),
     KIND(MISSED) | KIND(PHANTOM) | KIND(TRIANGLE) | KIND(DISTANCE) | KIND(BARYCENTRIC) |
         KIND(CULLED) | KIND(FACING)},
    {CHEAT_LENGTH, "length", KIND(DISTANCE), KIND(DISTANCE), KIND(MISSED)},
};

static void run_lie(struct world_play *p, const struct lie *lie, enum query query, uint32_t kinds)
{
    const struct row *row = &p->row;
    char text[400] = "";
    uint32_t found = 0;
    cheater.cheat = lie->cheat;
    play_run(p, &cheating, query);
    for (int w = WRONG_MISSED; w < WRONG_COUNT; w++)
        if (row->wrong[w]) {
            found |= 1u << w;
            size_t at = strlen(text);
            snprintf(text + at, sizeof text - at, " %s %zu", wrong_name((enum wrong)w),
                     row->wrong[w]);
        }
    print_message("%s, %s:%s\n", lie->name, query_name(query), text);
    assert_int_equal(row->status, ROW_OK);
    assert_found_in_world(p);
    if ((found & kinds) != kinds || (found & ~(kinds | lie->also)))
        fail_msg("%s, %s: found as%s", lie->name, query_name(query), text);
    assert_int_equal(row_failed(row), kinds != 0);
    assert_int_equal(row->differences, row->count[VERDICT_WRONG]);
    if (!kinds)
        assert_world_agrees(p, lie->name);
    else
        assert_int_equal(row->finding_count,
                         row->differences < FINDING_MOST ? row->differences : FINDING_MOST);
}

static void each_cheat_is_found_as_what_it_is(void **state)
{
    (void)state;
    struct world world = fixture_everything();
    struct world_play *p = play_world(&world, RAY_MODES_DRAWN, RAYS);
    bool tried[CHEAT_COUNT] = {false};
    for (size_t i = 0; i < ARRAY_COUNT(lies); i++) {
        run_lie(p, &lies[i], QUERY_CLOSEST, lies[i].closest);
        run_lie(p, &lies[i], QUERY_ALL, lies[i].all);
        tried[lies[i].cheat] = true;
    }
    tried[CHEAT_EXCHANGE] = true; /* below */
    for (int c = 0; c < CHEAT_COUNT; c++)
        assert_true(tried[c]);
    play_done(p);
    world_free(&world);
}

/* To any hit, a right triangle behind another one is right. */
static void cheats_of_any_hits_are_found(void **state)
{
    (void)state;
    static const struct lie any[] = {
        {CHEAT_NONE, "none", 0, 0, 0},
        {CHEAT_NO_MASK, "no mask", KIND(MASKED), 0, 0},
        {CHEAT_NO_CULL, "no cull", KIND(CULLED), 0, 0},
        {CHEAT_NO_FILTER, "no filter", KIND(OPACITY), 0, 0},
        {CHEAT_NO_OPACITY_CULL, "no opacity cull", KIND(OPACITY), 0, 0},
        {CHEAT_PASS_OVER, "pass over", KIND(MISSED), 0, 0},
        {CHEAT_FIRST_PASSED, "first passed", KIND(MISSED), 0, 0},
        {CHEAT_INSTANCE_0, "instance 0", KIND(MISSED), 0, 0},
        {CHEAT_CUT, "cut", KIND(INSTANCE), 0, 0},
        {CHEAT_OTHER_FACE, "other face", KIND(FACING), 0, 0},
        {CHEAT_NOT_CARRIED, "not carried", 0, 0, 0},
    };
    struct world world = fixture_everything();
    struct world_play *p = play_world(&world, RAY_MODES_MIXED, RAYS);
    for (size_t i = 0; i < ARRAY_COUNT(any); i++)
        run_lie(p, &any[i], QUERY_ANY, any[i].closest);
    play_done(p);
    world_free(&world);
}

/* Where a ray's own flag makes it an any-hit: not found without such rays. */
static void what_modes_do_not_ask_is_not_found(void **state)
{
    (void)state;
    static const enum world_cheat unseen[] = {
        CHEAT_NO_MASK,         CHEAT_NO_SKIP,      CHEAT_NO_CULL,  CHEAT_NO_DISABLE,
        CHEAT_NO_OPACITY_CULL, CHEAT_FIRST_PASSED, CHEAT_NO_FIRST, CHEAT_NO_RAY_OPACITY};
    struct world world = fixture_everything();
    struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
    for (size_t i = 0; i < ARRAY_COUNT(unseen); i++) {
        const struct lie lie = {unseen[i], "of modes", 0, 0, 0};
        run_lie(p, &lie, QUERY_CLOSEST, 0);
        run_lie(p, &lie, QUERY_ALL, 0);
    }
    play_done(p);
    world_free(&world);
}

/* Custom indices that are numbers of other instances, exchanged with these. */
static void exchanged_instances_are_found(void **state)
{
    (void)state;
    struct world world = fixture_world("soup:n=60,size=0.6", WORLD_TURNED, 7, 3);
    for (uint32_t i = 0; i < 7; i++)
        world.instance[i].custom = (3 * i + 1) % 7;
    struct world_play *p = play_world(&world, RAY_MODES_MIXED, RAYS);
    const struct lie lie = {CHEAT_EXCHANGE, "exchange", KIND(INSTANCE), 0, 0};
    run_lie(p, &lie, QUERY_CLOSEST, KIND(INSTANCE));
    run_lie(p, &lie, QUERY_ANY, KIND(INSTANCE));
    run_lie(p, &lie, QUERY_ALL, KIND(INSTANCE));
    play_done(p);
    world_free(&world);
}

/* --- tags alone ------------------------------------------------------------------------------- */

static void another_custom(unsigned spoilt, struct hit *hit, uint32_t *tag)
{
    (void)spoilt, (void)hit;
    *tag ^= 1;
}

static void another_face_now_and_then(unsigned spoilt, struct hit *hit, uint32_t *tag)
{
    (void)hit;
    if (spoilt % 2)
        *tag ^= ABI_TAG_FRONT;
}

/* As the cheating engine, but with the bits of engine cpu to be kept. */
static struct model model_of_bits(const struct engine *engine, void *self,
                                  const struct tri_test *tri)
{
    struct model model = cpu_rays_model(engine, self, tri);
    model.bits = true;
    return model;
}

/* A ray whose hit is the only one that differs, in its tag: found by the judge and in the bits. */
static void a_tag_alone_is_found(void **state)
{
    (void)state;
    struct engine exact = cheating;
    exact.model = model_of_bits;
    struct world world = fixture_world("soup:n=60,size=0.6", WORLD_TURNED, 7, 3);
    struct world_play *p = play_world(&world, RAY_MODES_ALL, RAYS);
    size_t first = 0;
    while (p->match.truth[first].prim == ABI_NO_PRIM || !isfinite(p->match.truth[first].t_next))
        first++;
    p->options.box = box_test_find("watertight"); /* loses nothing that brute force finds */
    static const enum query queries[] = {QUERY_CLOSEST, QUERY_ALL}; /* any hit may be another */
    for (size_t q = 0; q < ARRAY_COUNT(queries); q++) {
        cheater.cheat = CHEAT_NONE;
        cheater.ray = &p->ray[first];
        cheater.spoil = another_custom;
        play_run(p, &exact, queries[q]);
        const struct row *row = &p->row;
        assert_int_equal(row->status, ROW_OK);
        assert_int_equal(row->bit_differences, 1);
        assert_int_equal(row->wrong[WRONG_INSTANCE], 1);
        assert_int_equal(row->differences, 2);
        assert_int_equal(row->finding_count, 2);
        for (int i = 0; i < 2; i++) {
            const struct finding *f = &row->finding[i];
            assert_int_equal(f->ray_index, first);
            assert_int_equal(f->bits, i == 0);
            const uint32_t right = world.instance[f->world.got.instance].custom;
            assert_int_equal(f->world.tag & ABI_TAG_CUSTOM, right ^ 1);
            if (f->bits) {
                assert_memory_equal(&f->got, &f->expected, sizeof f->got);
                assert_int_equal(f->world.expected_tag, f->world.tag ^ 1);
            }
        }
        assert_found_in_world(p);
        cheater.spoil = another_face_now_and_then;
        cheater.spoilt = 0;
        play_run(p, &exact, queries[q]);
        assert_int_equal(p->row.wrong[WRONG_NOT_REPEATABLE], 1);
        assert_true(row_failed(&p->row));
        cheater.ray = NULL;
        play_run(p, &exact, queries[q]);
        assert_world_agrees(p, "as it is");
    }
    play_done(p);
    world_free(&world);
}

/* Any-hit says miss where the same engine's closest hit says hit. */
static void any_hits_are_compared_with_closest_hits(void **state)
{
    (void)state;
    struct world world = fixture_everything();
    struct world_play *p = play_world(&world, RAY_MODES_MIXED, RAYS);
    cheater.cheat = CHEAT_NONE;
    play_run(p, &cheating, QUERY_CLOSEST);
    assert_world_agrees(p, "closest");
    cheater.cheat = CHEAT_INSTANCE_0;
    play_run(p, &cheating, QUERY_ANY);
    assert_true(p->row.wrong[WRONG_MISSED] + p->row.wrong[WRONG_ANY_DISAGREES] > 0);
    assert_int_equal(p->row.wrong[WRONG_MISSED] + p->row.wrong[WRONG_ANY_DISAGREES],
                     p->row.count[VERDICT_WRONG]);
    play_done(p);
    world_free(&world);
}

/* What cannot trace worlds, or list their hits, is skipped; the first cannot run here at all. */
static void what_traces_no_worlds_is_skipped(void **state)
{
    (void)state;
    struct engine scenes = cheating, listless = cheating;
    struct world_tracer closest = cheat_worlds;
    scenes.worlds = NULL;
    closest.trace_world_all = NULL;
    listless.worlds = &closest;
    struct world world = fixture_everything();
    struct world_play *p = play_world(&world, RAY_MODES_MIXED, 50);
    play_run(p, &scenes, QUERY_CLOSEST);
    assert_int_equal(p->row.status, ROW_SKIPPED);
    assert_int_equal(p->row.cause, STATUS_UNSUPPORTED);
    assert_true(p->row.absent);
    assert_string_equal(p->row.reason.text, "cheating traces scenes, not worlds");
    play_run(p, &listless, QUERY_ALL);
    assert_int_equal(p->row.status, ROW_SKIPPED);
    assert_false(p->row.absent);
    assert_string_equal(p->row.reason.text, "cheating cannot list all hits of a world");
    play_done(p);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_cheat_is_found_as_what_it_is),
        cmocka_unit_test(cheats_of_any_hits_are_found),
        cmocka_unit_test(what_modes_do_not_ask_is_not_found),
        cmocka_unit_test(exchanged_instances_are_found),
        cmocka_unit_test(a_tag_alone_is_found),
        cmocka_unit_test(any_hits_are_compared_with_closest_hits),
        cmocka_unit_test(what_traces_no_worlds_is_skipped),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
