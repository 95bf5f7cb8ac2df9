/* What the oracle's trees spare, by value: answers do not depend on how much of a tree is passed
 * over, so that no other suite sees a box too large or a bound that is not used. The numbers below
 * are those of this tree and these rays. Where a change makes one smaller, the new one belongs
 * here; where it makes one larger, the change is to be explained. */
#include "ref/oracle/oracle_world.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/support/built.h"

#define RAYS 600u

static void place(const float m[3][4], struct ray *ray)
{
    const struct ray was = *ray;
    for (int k = 0; k < 3; k++) {
        double org = (double)m[k][3], dir = 0;
        for (int j = 0; j < 3; j++) {
            org += (double)m[k][j] * (double)was.org[j];
            dir += (double)m[k][j] * (double)was.dir[j];
        }
        ray->org[k] = (float)org;
        ray->dir[k] = (float)dir;
    }
}

/* Rays from around and inside the scene to its triangles, or to its
 * instances; each fourth is parallel to a plane of the
 * axes, each sixteenth to an axis, each fifth ends on its way. */
static void draw_rays(const struct scene *scene, const struct world *world, uint64_t seed,
                      struct ray ray[RAYS])
{
    struct rng rng = far_rng(seed);
    struct box box = scene_bounds(scene);
    for (uint32_t i = 0; i < RAYS; i++) {
        float v[3][3];
        scene_tri(scene, rng_below(&rng, scene->tri_count), v);
        ray[i] = (struct ray){.tmax = i % 5 == 4 ? 0.5f : INFINITY};
        for (uint32_t k = 0; k < 3; k++) {
            float to = 0.5f * v[0][k] + 0.25f * v[1][k] + 0.25f * v[2][k];
            float from = box.lo[k] + (1.5f * rng_float(&rng) - 0.25f) * (box.hi[k] - box.lo[k]);
            bool level = i % 4 == 3 && (k == i / 4 % 3) != (i % 16 == 15);
            ray[i].org[k] = level ? to : from;
            ray[i].dir[k] = to - ray[i].org[k];
        }
        if (world)
            place(world->instance[i % world->instance_count].m, &ray[i]);
    }
}

/* Prints what differs; returns whether it does. */
static bool differs(const char *what, struct oracle_stats is, struct oracle_stats must)
{
    if (is.pairs == must.pairs && is.undecided == must.undecided && is.wide == must.wide)
        return false;
    print_message("%s: pairs, undecided, wide: {%lu, %lu, %lu}, not {%lu, %lu, %lu}\n", what,
                  (unsigned long)is.pairs, (unsigned long)is.undecided, (unsigned long)is.wide,
                  (unsigned long)must.pairs, (unsigned long)must.undecided,
                  (unsigned long)must.wide);
    return true;
}

/* Whether the oracle of a world, or of a scene without one, does other work than it must. */
static bool works_otherwise(const char *what, const struct scene *scene, const struct world *world,
                            uint64_t seed, struct oracle_stats must)
{
    struct oracle *oracle;
    struct ray ray[RAYS];
    struct oracle_answer answer[RAYS];
    struct oracle_stats stats = {0};
    struct reason reason = {""};
    draw_rays(scene, world, seed, ray);
    enum status status =
        world ? oracle_make_world(world, &oracle, &reason) : oracle_make(scene, &oracle, &reason);
    assert_int_equal(status, STATUS_OK);
    status = world ? oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, NULL, RAYS, 2,
                                          answer, &stats, &reason)
                   : oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, RAYS, 2, answer,
                                    &stats, &reason);
    assert_int_equal(status, STATUS_OK);
    oracle_free(oracle);
    return differs(what, stats, must);
}

static void of_scenes(void **state)
{
    (void)state;
    static const struct oracle_stats must[BUILT_SCENES] = {
        {4909, 1, 0},           /* soup */
        {600000, 4000, 0},      /* copies */
        {21235, 4677, 0},       /* flat */
        {360962, 0, 0},         /* line */
        {40800, 0, 0},          /* points */
        {146837, 73636, 73636}, /* one huge */
        {240500, 1000, 0},      /* two heaps */
        {0, 0, 0},              /* far away */
        {0, 0, 0},              /* extremes */
        {5281, 2, 0},           /* tiny */
        {107517, 0, 0},         /* distances halve */
        {480982, 0, 0},         /* equal centres */
        {7055, 0, 0},           /* axes */
        {0, 0, 0},              /* ends */
    };
    bool bad = false;
    const char *what;
    for (size_t s = 0; s < ARRAY_COUNT(must); s++) {
        struct scene scene = built_scene(s, &what);
        bad |= works_otherwise(what, &scene, NULL, s, must[s]);
        scene_free(&scene);
    }
    assert_false(bad);
}

/* Forty instances of one mesh of 1000 triangles. */
static void of_worlds(void **state)
{
    (void)state;
    static const struct oracle_stats must[WORLD_TURNS] = {
        {197760, 240, 0},         /* identity */
        {4837, 4, 0},             /* moved */
        {113151, 35, 35},         /* turned */
        {4691, 1, 1},             /* far */
        {4755, 3, 3},             /* small */
        {48856, 408, 408},        /* flat */
        {114851, 42, 42},         /* mirror */
        {56178, 243, 243},        /* shear */
        {102686, 41, 41},         /* singular */
        {97226, 81, 79},          /* tiny */
        {0, 0, 0},                /* huge */
        {165536, 5273, 5273},     /* any bits */
        {46265, 14, 0},           /* powers */
        {95720, 91, 0},           /* lattice */
        {539237, 489167, 489143}, /* spread */
    };
    enum { INSTANCES = 40 };
    struct reason reason = {""};
    bool bad = false;
    const char *what;
    for (size_t k = 0; k < WORLD_TURNS; k++) {
        struct scene scene = built_scene(0, &what);
        struct world world;
        struct rng rng = far_rng(k);
        assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
        struct instance *one = world.instance;
        world.instance = calloc(INSTANCES, sizeof *world.instance);
        assert_non_null(world.instance);
        world.instance_count = INSTANCES;
        for (size_t i = 0; i < INSTANCES; i++) {
            world.instance[i] = *one;
            world_turn_draw(&world_turns[k], &rng, world.instance[i].m);
        }
        free(one);
        bad |= works_otherwise(world_turns[k].name, &scene, &world, 99, must[k]);
        world_free(&world);
        scene_free(&scene);
    }
    assert_false(bad);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_scenes),
        cmocka_unit_test(of_worlds),
    };
    return cmocka_run_group_tests_name("oracle_work", tests, NULL, NULL);
}
