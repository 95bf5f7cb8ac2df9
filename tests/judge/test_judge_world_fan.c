/* Closed fans behind transforms: woop, rounded to nearest, cannot miss them within an instance,
 * unless a neighbour does not count. Nothing is promised across instances. */
#include "ref/judge/judge_inner.h"
#include "tests/judge/honest_world.h"
#include "tests/exact/placed_trials.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static const struct model woop = {
    .formula = TWIN_WOOP, .rounding = {1, 1, 1, 0x1p-149}, .bits = true, .watertight = true};

#define CORNERS 6
#define TRIS    8

/* An octahedron whose corners are moved a little, from its `first` triangle on, `count` of them. */
static struct scene *some_of_an_octahedron(struct rng *rng, uint32_t first, uint32_t count)
{
    static const float corner[CORNERS][3] = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                             {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
    static const uint32_t index[TRIS][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                            {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    struct scene *scene = calloc(1, sizeof *scene);
    assert_non_null(scene);
    assert_int_equal(scene_make(CORNERS, count, scene), STATUS_OK);
    for (int i = 0; i < 3 * CORNERS; i++) {
        float moved = rng_range(rng, -0.2f, 0.2f);
        scene->vertex[i] = corner[i / 3][i % 3] + moved;
    }
    memcpy(scene->index, index[first], 3 * count * sizeof(uint32_t));
    return scene;
}

/* One mesh an instance, all of them at the same place; of `parts` parts of the octahedron. */
static void place(struct rng *rng, int kind, uint32_t parts, struct judged_world *out)
{
    struct world world = {.mesh_count = parts, .instance_count = parts};
    struct rng same = *rng;
    world.mesh = calloc(parts, sizeof *world.mesh);
    world.instance = calloc(parts, sizeof *world.instance);
    assert_true(world.mesh && world.instance);
    for (uint32_t i = 0; i < parts; i++) {
        struct rng again = same;
        uint32_t count = TRIS / parts;
        world.mesh[i] = (struct world_mesh){some_of_an_octahedron(&again, i * count, count),
                                            calloc(2, sizeof *world.mesh[i].geometry), 2};
        assert_non_null(world.mesh[i].geometry);
        world.mesh[i].geometry[0] = (struct geometry){0, 1, true};
        world.mesh[i].geometry[1] = (struct geometry){1, count - 1, true};
        placed_transform(kind, &again, &world.instance[i]);
        world.instance[i].mesh = i;
    }
    rng_u64(rng);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    judged_world_of(world, out);
}

/* From within, at a corner of the octahedron or a point of one of its edges. */
static struct ray aim(const struct judged_world *w, struct rng *rng)
{
    const struct instance *at = &w->world.instance[0];
    const float *vertex = w->world.mesh[0].scene->vertex;
    uint32_t a = rng_below(rng, CORNERS), b = (a + 2) % CORNERS;
    float part = rng_below(rng, 2) ? 0 : rng_float(rng), from[3], to[3];
    struct ray ray = {.tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        from[k] = rng_range(rng, -0.1f, 0.1f);
        to[k] = (1 - part) * vertex[3 * a + (uint32_t)k] + part * vertex[3 * b + (uint32_t)k];
    }
    for (int k = 0; k < 3; k++) {
        double o = (double)at->m[k][3], p = o;
        for (int j = 0; j < 3; j++) {
            o += (double)at->m[k][j] * (double)from[j];
            p += (double)at->m[k][j] * (double)to[j];
        }
        ray.org[k] = (float)o;
        ray.dir[k] = (float)(p - (double)ray.org[k]);
    }
    return ray;
}

struct fan_tally {
    uint32_t rays, wrong; /* a miss is WRONG */
    uint32_t missed;      /* an honest tracer misses */
};

static void tell(const struct judged_world *w, struct rng *rng, struct ray_mode mode,
                 struct fan_tally *told)
{
    const struct hit miss = {.prim = ABI_NO_PRIM};
    struct judge *judge;
    assert_int_equal(judge_make(w->oracle, &woop, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    for (int n = 0; n < 40; n++) {
        struct legal legal = {.rounding = woop.rounding, .style = LEGAL_ALL_NEAREST};
        struct ray ray = aim(w, rng);
        struct oracle_answer truth = judged_world_truth(w, &ray, mode);
        struct judgement j;
        struct hit hit;
        uint32_t tag;
        if (truth.prim == ABI_NO_PRIM || !ray_in_contract(&ray))
            continue;
        honest_world_trace(w, TWIN_WOOP, &legal, &ray, mode, QUERY_CLOSEST, &hit, &tag);
        assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &hit, tag, &j), STATUS_OK);
        assert_true(j.verdict != VERDICT_WRONG);
        assert_int_equal(judge_world_answer(judge, &ray, mode, &truth, &miss, 0, &j), STATUS_OK);
        told->rays++;
        told->wrong += j.wrong == WRONG_MISSED;
        told->missed += hit.prim == ABI_NO_PRIM;
    }
    judge_free(judge);
}

static struct fan_tally tell_all(uint32_t parts, struct ray_mode mode, uint32_t flags,
                                 bool filtered)
{
    struct fan_tally told = {0, 0, 0};
    for (uint64_t i = 0; i < 60 * PLACED_KINDS; i++) {
        int kind = (int)(i % PLACED_KINDS);
        struct rng rng = rng_make(i, 23);
        struct judged_world w;
        if (strcmp(placed_kind(kind), "at_ends") == 0)
            continue;
        place(&rng, kind, parts, &w);
        for (uint32_t p = 0; p < parts; p++) {
            w.world.instance[p].flags = flags;
            w.world.instance[p].mask = 0xFF;
            w.world.mesh[p].geometry[0].opaque = !filtered;
        }
        w.world.filter.kind = FILTER_NONE;
        tell(&w, &rng, mode, &told);
        judged_world_free(&w);
    }
    print_message("rays %u, WRONG if missed %u, missed by an honest tracer %u\n", told.rays,
                  told.wrong, told.missed);
    return told;
}

static void a_closed_fan_within_an_instance_cannot_be_missed(void **state)
{
    (void)state;
    struct fan_tally told = tell_all(1, ray_mode_all(), 0, false);
    assert_int_equal(told.missed, 0);
    assert_true(told.wrong * 10 > told.rays * 9);
}

/* From within backs are seen. */
static void nor_if_all_of_it_is_on_the_side_that_is_not_culled(void **state)
{
    (void)state;
    struct fan_tally told = tell_all(1, (struct ray_mode){0xFF, ABI_RAY_CULL_FRONT}, 0, false);
    assert_int_equal(told.missed, 0);
    assert_true(told.wrong * 10 > told.rays * 9);
    told =
        tell_all(1, (struct ray_mode){0xFF, ABI_RAY_CULL_BACK}, ABI_INSTANCE_CULL_DISABLE, false);
    assert_int_equal(told.missed, 0);
    assert_true(told.wrong * 10 > told.rays * 9);
}

static void a_neighbour_that_does_not_count_opens_it(void **state)
{
    (void)state;
    struct fan_tally told = tell_all(1, ray_mode_all(), 0, true);
    assert_true(told.missed > 0);
    assert_true(told.wrong > 0 && told.wrong * 10 < told.rays * 9);
}

static void across_instances_nothing_is_promised(void **state)
{
    (void)state;
    struct fan_tally told = tell_all(4, ray_mode_all(), 0, false);
    assert_true(told.wrong * 4 < told.rays * 3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_closed_fan_within_an_instance_cannot_be_missed),
        cmocka_unit_test(nor_if_all_of_it_is_on_the_side_that_is_not_culled),
        cmocka_unit_test(a_neighbour_that_does_not_count_opens_it),
        cmocka_unit_test(across_instances_nothing_is_promised),
    };
    return cmocka_run_group_tests_name("judge_world_fan", tests, NULL, NULL) ? 1 : 0;
}
