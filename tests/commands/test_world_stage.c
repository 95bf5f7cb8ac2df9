/* What raydiff conform --worlds plays is what the trial's name says: its world and its rays' masks
 * and flags are those of the composition and of the seed, whichever trial was played before. */
#include "cmd/conform/cmd_world_trial.h"
#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

#define RAYS 40u

static struct world_trial trial_drawn(struct rng *rng)
{
    struct world_trial trial = {.engine = engine_find("cpu"),
                                .layout = layout_find("f32"),
                                .builder = builder_find("median"),
                                .box = box_tests[0],
                                .tri = tri_tests[0]};
    trial.query = rng_below(rng, 2) ? QUERY_ANY : QUERY_CLOSEST;
    trial.seed = 1 + rng_below(rng, 3);
    for (uint32_t a = 0; a < COMPOSED_AXES; a++)
        trial.of.member[a] = rng_below(rng, composed_members((enum composed_axis)a));
    return trial;
}

/* Another, which differs in the seed alone (`axis` is COMPOSED_AXES) or in one axis. */
static struct world_trial trial_beside(struct world_trial trial, uint32_t axis)
{
    if (axis == COMPOSED_AXES) {
        trial.seed++;
        return trial;
    }
    const uint32_t members = composed_members((enum composed_axis)axis);
    trial.of.member[axis] = (trial.of.member[axis] + 1) % members;
    return trial;
}

static void must_be_of(const struct world_stage *stage, const struct world_trial *trial)
{
    struct ray_mode mode[RAYS];
    struct world world;
    struct reason reason = {""};
    assert_int_equal(composed_make(&trial->of, trial->seed, &world, &reason), STATUS_OK);
    composed_modes(&trial->of, trial->seed, RAYS, mode);
    assert_memory_equal(stage->mode, mode, sizeof mode);
    assert_int_equal(stage->world.instance_count, world.instance_count);
    for (uint32_t i = 0; i < world.instance_count; i++) {
        const struct instance *is = &stage->world.instance[i], *of = &world.instance[i];
        assert_memory_equal(is->m, of->m, sizeof of->m);
        assert_true(is->mesh == of->mesh && is->custom == of->custom && is->mask == of->mask &&
                    is->flags == of->flags);
    }
    assert_memory_equal(&stage->world.filter, &world.filter, sizeof world.filter);
    assert_ptr_equal(stage->match.ray, stage->ray);
    assert_ptr_equal(stage->match.mode, stage->mode);
    assert_int_equal(stage->match.options.query, trial->query);
    world_free(&world);
}

static void what_is_played_is_what_the_name_says(void **state)
{
    (void)state;
    struct rng rng = rng_make(8, 0);
    struct world_stage stage = {.ray_count = RAYS};
    struct world_trial trial = trial_drawn(&rng);
    for (uint32_t i = 0; i <= 2 * COMPOSED_AXES + 1; i++) {
        struct world_stage fresh = {.ray_count = RAYS};
        struct row row, alone;
        struct reason reason = {""};
        trial = i % 2 ? trial_beside(trial, i / 2) : trial_drawn(&rng);
        assert_int_equal(world_stage_run(&stage, &trial, &row, &reason), STATUS_OK);
        must_be_of(&stage, &trial);
        assert_int_equal(world_stage_run(&fresh, &trial, &alone, &reason), STATUS_OK);
        assert_memory_equal(stage.ray, fresh.ray, RAYS * sizeof *stage.ray);
        assert_int_equal(row.status, alone.status);
        assert_int_equal(row.hits, alone.hits);
        assert_memory_equal(row.count, alone.count, sizeof row.count);
        world_stage_free(&fresh);
    }
    world_stage_free(&stage);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_played_is_what_the_name_says)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
