/* What the oracle's trees spare, by value: answers do not depend on how much of a tree is passed
 * over, so that no other suite sees a box too large or a bound that is not used. The numbers below
 * are those of this tree and these rays. Where a change makes one smaller, the new one belongs
 * here; where it makes one larger, the change is to be explained. */
#include "ref/oracle/oracle_world.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/support/built.h"

#define RAYS 300u

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

/* Rays from around and inside the scene to its triangles, or to its instances; each fourth is
 * parallel to a plane of the axes, each sixteenth to an axis, each fifth ends on its way. */
static void draw_rays(const struct scene *scene, const struct world *world, uint64_t seed,
                      uint32_t count, struct ray ray[RAYS])
{
    struct rng rng = far_rng(seed);
    struct box box = scene_bounds(scene);
    for (uint32_t i = 0; i < count; i++) {
        float v[3][3];
        scene_tri(scene, rng_below(&rng, scene->tri_count), v);
        ray[i] = (struct ray){.tmax = i % 5 == 4 ? 1 : INFINITY};
        for (uint32_t k = 0; k < 3; k++) {
            float to = 0.5f * v[0][k] + 0.25f * v[1][k] + 0.25f * v[2][k];
            float part = 1.5f * rng_float(&rng) - 0.25f;
            float from = (1 - part) * box.lo[k] + part * box.hi[k];
            bool level = i % 4 == 3 && (k == i / 4 % 3) != (i % 16 == 15);
            from = from < -FLT_MAX ? -FLT_MAX : from > FLT_MAX ? FLT_MAX : from;
            ray[i].org[k] = level ? to : from;
            ray[i].dir[k] = 0.5f * to - 0.5f * ray[i].org[k];
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
                            uint64_t seed, uint32_t count, struct oracle_stats must)
{
    struct oracle *oracle;
    struct ray ray[RAYS];
    struct oracle_answer answer[RAYS];
    struct oracle_stats stats = {0};
    struct reason reason = {""};
    draw_rays(scene, world, seed, count, ray);
    enum status status =
        world ? oracle_make_world(world, &oracle, &reason) : oracle_make(scene, &oracle, &reason);
    assert_int_equal(status, STATUS_OK);
    status = world ? oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, NULL, count, 2,
                                          answer, &stats, &reason)
                   : oracle_closest(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, count, 2, answer,
                                    &stats, &reason);
    assert_int_equal(status, STATUS_OK);
    oracle_free(oracle);
    return differs(what, stats, must);
}

static void of_scenes(void **state)
{
    (void)state;
    static const struct oracle_stats must[BUILT_SCENES] = {
        {2464, 1, 0},          /* soup */
        {300000, 1000, 0},     /* copies */
        {8391, 1826, 0},       /* flat */
        {153147, 0, 0},        /* line */
        {12600, 0, 0},         /* points */
        {81936, 39569, 39569}, /* one huge */
        {120000, 500, 0},      /* two heaps */
        {55000, 0, 0},         /* far away */
        {13945, 0, 0},         /* extremes */
        {2661, 1, 0},          /* tiny */
        {53525, 0, 0},         /* distances halve */
        {239934, 0, 0},        /* equal centres */
        {3511, 0, 0},          /* axes */
        {24174, 17042, 17042}, /* ends */
    };
    bool bad = false;
    const char *what;
    for (size_t s = 0; s < ARRAY_COUNT(must); s++) {
        struct scene scene = built_scene(s, &what);
        bad |= works_otherwise(what, &scene, NULL, s, RAYS, must[s]);
        scene_free(&scene);
    }
    assert_false(bad);
}

/* Forty instances of one mesh of 1000 triangles. */
static void of_worlds(void **state)
{
    (void)state;
    static const struct oracle_stats must[WORLD_TURNS] = {
        {98160, 160, 0},       /* identity */
        {2408, 2, 0},          /* moved */
        {57017, 17, 17},       /* turned */
        {2342, 1, 1},          /* far */
        {2349, 2, 2},          /* small */
        {24365, 207, 207},     /* flat */
        {57623, 22, 22},       /* mirror */
        {28389, 123, 123},     /* shear */
        {50264, 24, 24},       /* singular */
        {48561, 45, 44},       /* tiny */
        {0, 0, 0},             /* huge */
        {87873, 2635, 2635},   /* any bits */
        {23211, 6, 0},         /* powers */
        {47728, 44, 0},        /* lattice */
        {20981, 19039, 19039}, /* spread */
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
        assert_int_equal(world_finish(&world, &reason), STATUS_OK);
        bad |= works_otherwise(world_turns[k].name, &scene, &world, 99,
                               k + 1 < WORLD_TURNS ? RAYS : 20, must[k]);
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
