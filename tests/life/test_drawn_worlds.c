/* Worlds that campaigns draw: over enough trials every generator, parameter and kind of geometry
 * comes, and what is taken over of a world is all of it. */
#include "fuzz/gen/gen_world.h"
#include "scenes/worlds.h"

#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define DRAWS      1500u
#define NAMES_MOST 64u

static size_t generator_of(const char *name)
{
    size_t i = 0;
    while (strcmp(world_generators[i]->name, name) != 0)
        i++;
    return i;
}

/* Whether a mesh has geometries of both kinds. */
static bool has_both(const struct trial_world *world)
{
    for (uint32_t i = 1; i < world->geometry_count; i++)
        if (world->geometry[i].mesh == world->geometry[i - 1].mesh &&
            world->geometry[i].opaque != world->geometry[i - 1].opaque)
            return true;
    return false;
}

static void every_generator_of_worlds_comes(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 1);
    uint32_t drawn[NAMES_MOST] = {0}, both = 0, names = 0, least = UINT32_MAX, most = 0;
    for (uint32_t i = 0; i < DRAWS; i++) {
        struct fuzz_trial trial;
        const char *name;
        struct reason reason = {""};
        uint32_t triangles = 0;
        if (gen_world_of_scenes(&rng, 1, &trial, &name, &reason))
            fail_msg("%s", reason.text);
        for (uint32_t g = 0; g < trial.world.geometry_count; g++)
            triangles += trial.world.geometry[g].count;
        assert_int_equal(triangles, trial.scene.tri_count);
        drawn[generator_of(name)]++;
        both += has_both(&trial.world);
        fuzz_trial_free(&trial);
    }
    for (; world_generators[names]; names++)
        if (!world_generators[names]->undrawn) {
            least = drawn[names] < least ? drawn[names] : least;
            most = drawn[names] > most ? drawn[names] : most;
        } else {
            assert_int_equal(drawn[names], 0);
        }
    /* About equally often. */
    assert_true(names < NAMES_MOST && least > 0 && most < 3 * least);
    assert_true(both > 0);
}

/* Meshes by the recipes of scenes, with geometries that are filtered and others that are not. */
static void geometries_of_both_kinds_come(void **state)
{
    (void)state;
    const struct gen_options options = {
        .triangles_least = 4, .triangles_most = 24, .rays = 1, .worlds = true};
    struct rng rng = rng_make(11, 1);
    uint32_t opaque = 0, filtered = 0, meshes = 0;
    for (uint32_t i = 0; i < 400; i++) {
        struct fuzz_trial trial;
        struct reason reason = {""};
        if (gen_world_draw(&rng, &options, &trial, &reason))
            fail_msg("%s", reason.text);
        if (trial.world.geometry_count > 0)
            meshes |= 1u << trial.world.geometry[trial.world.geometry_count - 1].mesh;
        for (uint32_t g = 0; g < trial.world.geometry_count; g++)
            *(trial.world.geometry[g].opaque ? &opaque : &filtered) += 1;
        fuzz_trial_free(&trial);
    }
    assert_true(filtered > 50 && opaque > 2 * filtered);
    assert_int_equal(meshes & 0xF, 0xF); /* one to three, and an empty one */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_generator_of_worlds_comes),
        cmocka_unit_test(geometries_of_both_kinds_come),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
