/* Re-braiding: how wide the boxes of opened instances must be, and which instances that leaves
 * whole (ref/two_level/braid.h). */
#include "ref/two_level/braid.h"
#include "ref/world/object_ray.h"
#include "tests/two_level/two_level_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/braid_stand.h"

/* The largest row sum of |M| |W|. */
static long double kappa_of(const struct instance *instance)
{
    float w[9];
    long double most = 0;
    assert_int_equal(transform_inverse(instance->m, w, NULL), STATUS_OK);
    for (int i = 0; i < 3; i++) {
        long double row = 0;
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                row += fabsl((long double)instance->m[i][j] * (long double)w[3 * j + k]);
        most = fmaxl(most, row);
    }
    return most;
}

/* The largest of |T|, the box's numbers and |M| times the mesh's longest side. */
static long double reach_of(const struct world *world, uint32_t at, const struct box *box)
{
    const struct instance *instance = &world->instance[at];
    const struct box mesh = scene_bounds(world_scene(world, at));
    long double far = 0, side = 0, norm = 0;
    for (int k = 0; k < 3; k++) {
        long double row = 0;
        for (int j = 0; j < 3; j++)
            row += fabsl((long double)instance->m[k][j]);
        norm = fmaxl(norm, row);
        side = fmaxl(side, (long double)mesh.hi[k] - (long double)mesh.lo[k]);
        far = fmaxl(far, fabsl((long double)instance->m[k][3]));
        far = fmaxl(far, fmaxl(fabsl((long double)box->lo[k]), fabsl((long double)box->hi[k])));
    }
    return fmaxl(far, norm * side);
}

/* Instances of a mesh whose vertices lie `away` from its own origin, and that are moved back by as
 * much: |T| is larger than every number of their boxes. */
static struct world moved_back(enum world_kind kind, float away)
{
    struct world world = fixture_room(1, 200);
    fixture_mesh(&world, 0, "sphere:n=3", 1);
    struct scene *scene = world.mesh[0].scene;
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++)
        scene->vertex[i] += away;
    for (uint32_t i = 0; i < world.instance_count; i++) {
        float(*m)[4] = world.instance[i].m;
        fixture_transform(kind, 1000 * (90 + (uint64_t)kind) + i, m);
        for (int k = 0; k < 3; k++)
            m[k][3] -= away * (m[k][0] + m[k][1] + m[k][2]);
    }
    fixture_finish(&world);
    return world;
}

/* Never below what the proof asks for, and at most 2^-18 above it. */
static void needs_are_rounded_up(void **state)
{
    (void)state;
    uint32_t opened = 0;
    for (uint32_t turn = 0; turn < 2 * WORLD_KINDS; turn++) {
        struct world world =
            moved_back((enum world_kind)(turn % WORLD_KINDS), turn < WORLD_KINDS ? 0 : 4096);
        struct box *box;
        assert_int_equal(world_boxes_make(&world, WORLD_BOXES_AUTO, &box, NULL), STATUS_OK);
        for (uint32_t i = 0; i < world.instance_count; i++) {
            float share, reach;
            const long double kappa = kappa_of(&world.instance[i]);
            const long double far = reach_of(&world, i, &box[i]);
            if (!braid_needs(&world, i, &box[i], &share, &reach)) {
                assert_true(kappa > (long double)BRAID_KAPPA_MOST);
                continue;
            }
            opened++;
            assert_true((long double)share >= (long double)BRAID_SHARE * kappa);
            assert_true((long double)share <= (long double)BRAID_SHARE * kappa * (1 + 0x1p-18L));
            assert_true((long double)reach >= far);
            assert_true((long double)reach <= far * (1 + 0x1p-18L));
        }
        free(box);
        world_free(&world);
    }
    assert_true(opened > 2000);
}

/* One instance farther and farther away: it is opened while twice the width is at most 2^-6 of its
 * longest side, and whole from there on. */
static void an_instance_is_whole_where_its_parts_would_be_too_wide(void **state)
{
    (void)state;
    uint32_t opened = 0, whole = 0;
    for (int power = 0; power < 24; power++)
        for (int half = 0; half < 4; half++) {
            struct world world = fixture_room(1, 1);
            fixture_mesh(&world, 0, "sphere:n=4", 1);
            for (int k = 0; k < 3; k++)
                world.instance[0].m[k][k] = 2;
            world.instance[0].m[0][3] = ldexpf(1 + 0.25f * (float)half, power);
            fixture_finish(&world);
            struct world_trees trees = braid_trees(&world, "median", 2, 2);
            const struct box *box = &trees.box[0];
            float share, reach, side = 0;
            assert_true(braid_needs(&world, 0, box, &share, &reach));
            for (int k = 0; k < 3; k++)
                side = fmaxf(side, box->hi[k] - box->lo[k]);
            const bool opens = 2 * (double)share * (double)reach <= BRAID_WIDTH_MOST * (double)side;
            assert_int_equal(trees.parts.count, opens ? 2 : 0);
            opened += opens;
            whole += !opens;
            world_trees_free(&trees);
            world_free(&world);
        }
    assert_true(opened > 10 && whole > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(needs_are_rounded_up),
        cmocka_unit_test(an_instance_is_whole_where_its_parts_would_be_too_wide),
    };
    return cmocka_run_group_tests_name("braid_needs", tests, NULL, NULL);
}
