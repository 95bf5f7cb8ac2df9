/* Rays of a world are aimed at what is placed in it: to the bit as at the scene of the placed
 * triangles, under the same draw. */
#include "fuzz/gen/gen.h"
#include "fuzz/gen/gen_world.h"
#include "fuzz/gen/mutate_inner.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define TRIANGLES 12u
#define RAYS      40u

static struct reason reason;

/* Of small whole numbers, so that none is rounded where it is placed. */
static struct fuzz_trial whole_numbers(uint64_t index)
{
    struct fuzz_trial trial;
    struct rng rng = rng_make(4, index);
    assert_int_equal(fuzz_trial_make(3 * TRIANGLES, TRIANGLES, RAYS, &trial, &reason), STATUS_OK);
    for (uint32_t i = 0; i < 9 * TRIANGLES; i++)
        trial.scene.vertex[i] = (float)((int)rng_below(&rng, 17) - 8);
    for (uint32_t i = 0; i < 3 * TRIANGLES; i++)
        trial.scene.index[i] = i;
    for (uint32_t i = 0; i < RAYS; i++)
        trial.ray[i] = (struct ray){{(float)i, 0, 0}, 0, {0, 0, 1}, 100};
    return trial;
}

/* Places the world's mesh once, an axis scaled and all moved; in the other trial its vertices. */
static void place(uint64_t index, struct fuzz_trial *world, struct fuzz_trial *scene)
{
    struct rng rng = rng_make(5, index);
    assert_int_equal(trial_world_make(TRIANGLES, 1, 1, RAYS, &world->world, &reason), STATUS_OK);
    for (int k = 0; k < 3; k++) {
        float *m = world->world.instance[0].m[k];
        m[k] = (float)(1 + rng_below(&rng, 3));
        m[3] = (float)((int)rng_below(&rng, 8001) - 4000);
        for (size_t i = (size_t)k; i < 9 * TRIANGLES; i += 3)
            scene->scene.vertex[i] = m[k] * scene->scene.vertex[i] + m[3];
    }
}

static void rays_are_aimed_at_what_is_placed(void **state)
{
    (void)state;
    size_t edited = 0, different = 0;
    for (uint64_t index = 0; index < 200; index++) {
        struct fuzz_trial world = whole_numbers(index), scene = whole_numbers(index),
                          unmoved = whole_numbers(index);
        struct fuzz_trial *const all[] = {&world, &scene, &unmoved};
        place(index, &world, &scene);
        for (size_t i = 0; i < ARRAY_COUNT(all); i++) {
            struct rng rng = rng_make(6, index);
            bool changed = false;
            assert_int_equal(edit_aim(&rng, all[i], &changed), STATUS_OK);
            assert_true(changed);
        }
        assert_memory_equal(world.ray, scene.ray, RAYS * sizeof *world.ray);
        for (uint32_t i = 0; i < RAYS; i++)
            edited += world.ray[i].org[0] != (float)i || world.ray[i].dir[0] != 0;
        different += memcmp(world.ray, unmoved.ray, RAYS * sizeof *world.ray) != 0;
        for (size_t i = 0; i < ARRAY_COUNT(all); i++)
            fuzz_trial_free(all[i]);
    }
    assert_true(edited > 200 && different > 150);
}

/* The box of a mesh is that of its corners, however few triangles it has and whichever others the
 * scene has. */
static void a_mesh_has_the_box_of_its_corners(void **state)
{
    (void)state;
    for (uint64_t index = 0; index < 60; index++) {
        const uint32_t split[2] = {(uint32_t)index % TRIANGLES,
                                   TRIANGLES - (uint32_t)index % TRIANGLES};
        struct fuzz_trial trial = whole_numbers(index);
        uint32_t first = 0;
        assert_int_equal(trial_world_make(TRIANGLES, 2, 1, RAYS, &trial.world, &reason), STATUS_OK);
        for (uint32_t m = 0; m < 2; m++) {
            trial.world.geometry[m].mesh = m;
            trial.world.geometry[m].count = split[m];
        }
        for (uint32_t m = 0; m < 2; m++) {
            const struct box is = gen_mesh_box(&trial, m);
            struct box wanted = {{-1, -1, -1}, {1, 1, 1}};
            for (uint32_t i = 9 * first; i < 9 * (first + split[m]); i++) {
                const float x = trial.scene.vertex[i];
                float *lo = &wanted.lo[i % 3], *hi = &wanted.hi[i % 3];
                *lo = i < 9 * first + 3 || x < *lo ? x : *lo;
                *hi = i < 9 * first + 3 || x > *hi ? x : *hi;
            }
            assert_memory_equal(&is, &wanted, sizeof is);
            first += split[m];
        }
        fuzz_trial_free(&trial);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rays_are_aimed_at_what_is_placed),
                                       cmocka_unit_test(a_mesh_has_the_box_of_its_corners)};
    return cmocka_run_group_tests_name("aim_placed", tests, NULL, NULL);
}
