/* Memory that runs out in the life of a world: each allocation in turn fails. It must be said in
 * one line, with nothing made and nothing kept; and what a life makes does not depend on what it
 * is made from once it is made. */
#include "tests/support/allocations.h"

#include "tests/world_life/world_lives.h"

#include "tests/support/each_fails.h"

/* What work is done on. */
struct life_work {
    const struct world_recipe *recipe;
    const struct world_lived *lived;
    const struct world_life *before;
    enum life_act act;
};

static enum status do_worlds(const void *of, struct reason *reason)
{
    const struct life_work *work = of;
    struct world out[LIFE_STEPS_MOST + 1];
    enum status status =
        steps_worlds(&work->lived->first, work->lived->step, work->lived->count, out, reason);
    if (!status)
        steps_worlds_free(out, work->lived->count);
    return status;
}

static enum status do_begin(const void *of, struct reason *reason)
{
    const struct life_work *work = of;
    const struct world_life zero = {0};
    struct world_life out;
    enum status status = world_life_begin(work->recipe, &work->lived->world[0], &out, reason);
    if (status)
        assert_memory_equal(&out, &zero, sizeof zero);
    world_life_free(&out);
    assert_memory_equal(&out, &zero, sizeof zero);
    return status;
}

static enum status do_step(const void *of, struct reason *reason)
{
    const struct life_work *work = of;
    const struct world_life zero = {0};
    struct world_life out;
    enum status status = world_life_step(work->recipe, work->act, &work->lived->world[1],
                                         work->before, &out, reason);
    if (status)
        assert_memory_equal(&out, &zero, sizeof zero);
    else
        assert_int_equal(out.fate, work->act == LIFE_REFIT ? LIFE_REFITTED : LIFE_REBUILT);
    world_life_free(&out);
    return status;
}

static void each_allocation_may_fail(void **state)
{
    (void)state;
    static const char *const steps[] = {"refit:drift:2", "refit:jitter:1", "refit:exchange:4",
                                        "refit:far:3,refit:turn:2,refit:masks:1"};
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT, .threads = 1};
    const struct world_build build = {.top = builder_find("median"),
                                      .bottom = builder_find("median"),
                                      .top_options = options,
                                      .bottom_options = options};
    const struct world_recipe recipe = {&build, layout_find("f32"), layout_find("cwbvh80"),
                                        tri_store_find("indexed")};
    for (size_t i = 0; i < ARRAY_COUNT(steps); i++) {
        struct world_lived *lived = world_lived_make("mixed:count=9", steps[i]);
        struct world_life before;
        assert_int_equal(world_life_begin(&recipe, &lived->world[0], &before, NULL), STATUS_OK);
        struct life_work work = {&recipe, lived, &before, LIFE_REFIT};
        const long worlds = each_fails("worlds", do_worlds, &work, 1);
        const long begin = each_fails("a beginning", do_begin, &work, 1);
        const long refit = each_fails("a refit", do_step, &work, 1);
        work.act = LIFE_REBUILD;
        const long rebuild = each_fails("a new one", do_step, &work, 1);
        assert_true(worlds > 10 && begin > 20 && refit > 30 && rebuild > 20);
        world_life_free(&before);
        world_lived_free(lived);
    }
}

/* The trees of a step are its own: those before stay as they are, and may go. */
static void a_refit_shares_nothing_with_what_was_before(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    const struct world_build build = {.top = builder_find("sah_binned"),
                                      .bottom = builder_find("sah_binned"),
                                      .top_options = options,
                                      .bottom_options = options};
    struct world_lived *lived = world_lived_make("mixed", "refit:drift:1,refit:jitter:2");
    uint32_t played = 0;
    for (size_t s = 0; tri_stores[s]; s++) {
        const struct world_recipe recipe = {&build, layout_find("f32"), layout_find("f32"),
                                            tri_stores[s]};
        struct world_life first, same, next;
        struct packed_world fresh;
        enum status status = world_life_begin(&recipe, &lived->world[0], &first, NULL);
        if (status == STATUS_LIMIT)
            continue; /* the storage holds no such triangles */
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(world_life_begin(&recipe, &lived->world[0], &same, NULL), STATUS_OK);
        status = world_life_step(&recipe, LIFE_REFIT, &lived->world[1], &first, &next, NULL);
        assert_int_equal(status, STATUS_OK);
        assert_true(same_packed_worlds(&first.packed, &same.packed));
        for (uint32_t i = 0; i < first.trees.mesh_count; i++)
            assert_memory_equal(first.trees.bottom[i].node, same.trees.bottom[i].node,
                                first.trees.bottom[i].node_count * sizeof(struct bvh_node));
        world_life_free(&first);
        if (next.fate == LIFE_REFITTED) {
            status = packed_world_make(&lived->world[1], &next.trees, recipe.top, recipe.bottom,
                                       recipe.store, &fresh, NULL);
            assert_int_equal(status, STATUS_OK);
            assert_true(tri_stores[s]->head || same_packed_worlds(&fresh, &next.packed));
            packed_world_free(&fresh);
        }
        world_life_free(&same);
        world_life_free(&next);
        played++;
    }
    assert_true(played > 3);
    world_lived_free(lived);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_allocation_may_fail),
        cmocka_unit_test(a_refit_shares_nothing_with_what_was_before),
    };
    return cmocka_run_group_tests_name("world_life_memory", tests, NULL, NULL);
}
