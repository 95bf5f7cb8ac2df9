/* Engines after the steps of worlds, beside the exact truth of the world at that step; and updates
 * that forget something, which must be found. */
#include "ref/engines/embree_named.h"

#include "tests/world_life/world_lived_match.h"

static struct pool pool = {.options = {.device = -1, .threads = 1}};

static void engines_in_c_are_right_over_layouts(void **state)
{
    (void)state;
    static const char *const of[] = {"f32", "rf16", "cwbvh80"};
    const struct engine *cpu = engine_find("cpu");
    for (size_t l = 0; l < ARRAY_COUNT(of); l++)
        assert_int_equal(world_lived_all(cpu, layout_find(of[l]), (enum query)l, &pool), 0);
    assert_int_equal(world_lived_all(engine_find("fast"), layouts[0], QUERY_CLOSEST, &pool), 0);
    assert_int_equal(world_lived_all(engine_find("brute"), NULL, QUERY_CLOSEST, &pool), 0);
}

static void refits_and_builds_of_worlds_leave_the_same_answers(void **state)
{
    (void)state;
    struct world_lived *refit = world_lived_make("crowd:n=30", "refit:drift:3,refit:exchange:2"),
                       *build =
                           world_lived_make("crowd:n=30", "rebuild:drift:3,rebuild:exchange:2");
    const struct engine *cpu = engine_find("cpu");
    const struct row a = world_lived_row(refit, cpu, layouts[0], QUERY_CLOSEST, &pool),
                     b = world_lived_row(build, cpu, layouts[0], QUERY_CLOSEST, &pool);
    assert_int_equal(a.life.fate, LIFE_REFITTED);
    assert_int_equal(b.life.fate, LIFE_REBUILT);
    assert_int_equal(a.count[VERDICT_WRONG] + b.count[VERDICT_WRONG], 0);
    assert_int_equal(a.hits, b.hits);
    assert_true(a.status == ROW_OK && b.status == ROW_OK && a.hits > 20);
    world_lived_free(refit);
    world_lived_free(build);
}

static void embree_updates_its_world_in_every_mode(void **state)
{
    (void)state;
    static const char *const modes[] = {"embree",       "embree:robust", "embree:dynamic",
                                        "embree:refit", "embree:high",   "embree:robust:compact"};
    uint32_t refits = 0;
    enum status status = STATUS_OK;
    struct reason reason = {""};
    if (!pool_get(&pool, engine_find("embree"), &status, &reason)) {
        assert_int_equal(status, STATUS_UNSUPPORTED);
        skip();
    }
    for (size_t i = 0; i < ARRAY_COUNT(world_lived_steps); i++) {
        const char *last = strrchr(world_lived_steps[i], ',');
        refits += strncmp(last ? last + 1 : world_lived_steps[i], "refit", 5) == 0;
    }
    for (size_t i = 0; i < ARRAY_COUNT(modes); i++) {
        const struct engine *engine = engine_find(modes[i]);
        if (!engine && embree_named(modes[i], &engine, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(world_lived_all(engine, NULL, i % 2 ? QUERY_ALL : QUERY_CLOSEST, &pool),
                         refits);
    }
}

/* --- what forgets something ------------------------------------------------------------------- */

/* Planted: of an update all but one part is used, which is what it was when it was prepared. */
enum forgets { NOTHING, ALL, INVERSES, BOXES, MASKS, MESHES, VERTICES };

static struct {
    enum forgets what;
    struct packed_world first; /* borrows */
    struct world world;
    struct packed_world mixed; /* what is traced */
    struct world moved;        /* likewise; borrows all but instances */
    struct instance_record *record;
    struct instance *instance;
} held;

static enum status forgetful_prepare(void *self, const struct world_job *job, struct reason *reason)
{
    held.first = *job->packed;
    held.world = *job->world;
    return engine_find("cpu")->worlds->prepare_world(self, job, reason);
}

/* The masks that it had, in place of those that it should have. */
static void mix_masks(const struct world *now)
{
    held.moved = *now;
    free(held.instance);
    held.instance = malloc(now->instance_count * sizeof *held.instance);
    assert_non_null(held.instance);
    for (uint32_t i = 0; i < now->instance_count; i++) {
        held.instance[i] = now->instance[i];
        held.instance[i].mask = held.world.instance[i].mask;
    }
    held.moved.instance = held.instance;
}

static void mix_record(const struct instance_record *old, struct instance_record *out)
{
    if (held.what == INVERSES)
        memcpy(out->w, old->w, sizeof out->w);
    if (held.what == MESHES)
        out->mesh = old->mesh;
}

static enum status forgetful_move(void *self, const struct world_job *job, struct reason *reason)
{
    struct world_job mixed = *job;
    if (held.what == ALL)
        return STATUS_OK;
    const uint32_t count = job->packed->entry_count;
    held.mixed = *job->packed;
    free(held.record);
    held.record = malloc(count * sizeof *held.record);
    assert_non_null(held.record);
    memcpy(held.record, job->packed->record, count * sizeof *held.record);
    for (uint32_t i = 0; i < count; i++)
        mix_record(&held.first.record[i], &held.record[i]);
    held.mixed.record = held.record;
    if (held.what == BOXES)
        held.mixed.top = held.first.top;
    if (held.what == VERTICES)
        held.mixed.bottom = held.first.bottom;
    mixed.packed = &held.mixed;
    if (held.what == MASKS) {
        mix_masks(job->world);
        mixed.world = &held.moved;
    }
    return engine_find("cpu")->worlds->prepare_world(self, &mixed, reason);
}

static struct row forget(const char *spec, enum forgets what, const char *steps)
{
    static struct engine engine; /* the pool closes it at the end */
    static struct world_tracer worlds;
    struct world_lived *lived = world_lived_make(spec, steps);
    worlds = *engine_find("cpu")->worlds;
    worlds.prepare_world = forgetful_prepare;
    worlds.move_world = forgetful_move;
    engine = *engine_find("cpu");
    engine.name = "forgetful";
    engine.reference = false;
    engine.worlds = &worlds;
    held.what = what;
    const struct row row =
        world_lived_row(lived, &engine, layout_find("f32"), QUERY_CLOSEST, &pool);
    assert_int_equal(row.status, ROW_OK);
    world_lived_free(lived);
    return row;
}

/* Each is WRONG after the update, and right when it is prepared anew: the update is at fault. */
static void what_an_update_of_a_world_forgets_is_found(void **state)
{
    (void)state;
    static const struct {
        const char *spec;
        enum forgets what;
        const char *steps;
    } of[] = {{"crowd:n=30", ALL, "refit:drift:1"},
              {"crowd:n=30", INVERSES, "refit:turn"},
              {"crowd:n=30", INVERSES, "refit:scale:1"},
              {"crowd:n=30", BOXES, "refit:drift:1"},
              {"crowd:n=30", VERTICES, "refit:jitter:1"},
              {"crowd:n=30", ALL, "refit:exchange:1,refit:reflect"},
              {"mixed", MASKS, "refit:masks:3"},
              {"mixed", MESHES, "refit:exchange:7"}};
    for (size_t i = 0; i < ARRAY_COUNT(of); i++) {
        const struct row row = forget(of[i].spec, of[i].what, of[i].steps);
        if (!(row.life.updated && row.count[VERDICT_WRONG] > 3 && row.life.again))
            fail_msg("%s: %zu WRONG", of[i].steps, row.count[VERDICT_WRONG]);
        assert_int_equal(row.life.wrong_again, 0);
        assert_true(row_failed(&row));
    }
}

static void what_forgets_nothing_is_right(void **state)
{
    (void)state;
    static const char *const steps[] = {"refit:drift:1", "refit:turn", "refit:masks:3",
                                        "refit:jitter:1"};
    for (size_t i = 0; i < ARRAY_COUNT(steps); i++) {
        const struct row row = forget("crowd:n=30", NOTHING, steps[i]);
        assert_true(row.life.updated && !row_failed(&row) && !row.life.again);
    }
    /* It updates after refits alone. */
    assert_false(forget("crowd:n=30", ALL, "rebuild:drift:1").life.updated);
    assert_int_equal(forget("crowd:n=30", ALL, "rebuild:drift:1").count[VERDICT_WRONG], 0);
}

static int close_pool(void **state)
{
    (void)state;
    pool_free(&pool);
    free(held.record);
    free(held.instance);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_in_c_are_right_over_layouts),
        cmocka_unit_test(refits_and_builds_of_worlds_leave_the_same_answers),
        cmocka_unit_test(embree_updates_its_world_in_every_mode),
        cmocka_unit_test(what_an_update_of_a_world_forgets_is_found),
        cmocka_unit_test(what_forgets_nothing_is_right),
    };
    return cmocka_run_group_tests(tests, NULL, close_pool);
}
