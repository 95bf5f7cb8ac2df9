/* Memory that runs out while the oracle of a world is made, or its crossings are listed: each
 * allocation in turn fails. It must be said in one line, with nothing made and nothing kept. And
 * what an instance takes. */
#include "tests/support/allocations.h"

#include "ref/oracle/oracle_tree.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"
#include "tests/support/tree_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define TIMES_MOST 1000

static void a_world_is_made_or_not(void **state)
{
    (void)state;
    struct world_case c;
    world_case_make(&world_turns[2], 3, &c);
    bool done = false;
    long n;
    for (n = 0; n < TIMES_MOST && !done; n++) {
        struct reason reason = {""};
        struct oracle *oracle = c.oracle;
        atomic_store(&held, 0);
        fail_after(n);
        enum status status = oracle_make_world(&c.world, &oracle, &reason);
        atomic_store(&until_failure, -1);
        done = !has_failed;
        if (done) {
            assert_int_equal(status, STATUS_OK);
            oracle_free(oracle);
        } else {
            assert_int_equal(status, STATUS_MEMORY);
            assert_null(oracle);
            assert_non_null(strstr(reason.text, "no memory"));
        }
        assert_int_equal(held, 0);
    }
    assert_true(done && n > 12);
    world_case_free(&c);
}

/* What was in it before does not stay in a tree that is not made. */
static void a_tree_is_made_or_zero(void **state)
{
    (void)state;
    struct world_case c;
    world_case_make(&world_turns[2], 3, &c);
    bool done = false;
    long n;
    for (n = 0; n < TIMES_MOST && !done; n++) {
        struct reason reason = {""};
        struct tree tree;
        memset(&tree, 0xAA, sizeof tree);
        atomic_store(&held, 0);
        fail_after(n);
        enum status status = tree_make(c.world.mesh[0].scene, &tree, &reason);
        atomic_store(&until_failure, -1);
        done = !has_failed;
        assert_int_equal(status, done ? STATUS_OK : STATUS_MEMORY);
        if (done)
            tree_free(&tree);
        assert_null(tree.node);
        assert_null(tree.order);
        assert_int_equal(tree.node_count, 0);
        assert_int_equal(held, 0);
    }
    assert_true(done && n > 3);
    world_case_free(&c);
}

static void crossings_are_listed_or_not(void **state)
{
    (void)state;
    struct world_case c;
    uint32_t failed = 0;
    world_case_make(&world_turns[12], 9, &c);
    for (int i = 0; i < WORLD_RAYS; i++) {
        struct reason reason = {""};
        struct oracle_crossing *list = NULL;
        size_t capacity = 0, count = 7;
        atomic_store(&has_failed, false);
        atomic_store(&until_failure, 0);
        enum status status = oracle_crossings_world(c.oracle, &c.ray[i], ray_mode_all(), INFINITY,
                                                    &list, &capacity, &count, &reason);
        atomic_store(&until_failure, -1);
        assert_int_equal(status, has_failed ? STATUS_MEMORY : STATUS_OK);
        assert_int_equal(count, 0);
        failed += has_failed;
        free(list);
    }
    assert_true(failed > 2);
    world_case_free(&c);
}

/* Of a long list each allocation fails in turn: none of it is kept, in a scene nor in a world. */
static void long_lists_are_whole_or_empty(void **state)
{
    (void)state;
    enum { ROW = 300 };
    struct scene scene = trees_row(ROW);
    struct world world;
    struct oracle *oracle[2];
    struct reason reason = {""};
    assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
    assert_int_equal(oracle_make(&scene, &oracle[0], &reason), STATUS_OK);
    assert_int_equal(oracle_make_world(&world, &oracle[1], &reason), STATUS_OK);
    const struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, INFINITY};
    for (int placed = 0; placed < 2; placed++) {
        bool done = false;
        long n;
        for (n = 0; n < TIMES_MOST && !done; n++) {
            struct oracle_crossing *list = NULL;
            size_t capacity = 0, count = 7;
            fail_after(n);
            enum status status =
                placed ? oracle_crossings_world(oracle[1], &ray, ray_mode_all(), INFINITY, &list,
                                                &capacity, &count, &reason)
                       : oracle_crossings(oracle[0], &ray, INFINITY, &list, &capacity, &count,
                                          &reason);
            atomic_store(&until_failure, -1);
            done = !has_failed;
            assert_int_equal(status, done ? STATUS_OK : STATUS_MEMORY);
            assert_int_equal(count, done ? ROW : 0);
            free(list);
        }
        assert_true(done && n > 2);
        oracle_free(oracle[placed]);
    }
    world_free(&world);
    scene_free(&scene);
}

/* Nothing is made per placed triangle. */
static void an_instance_takes_little(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    struct rng rng = far_rng(5);
    struct reason reason;
    struct scene scene;
    assert_int_equal(scene_make(3 * 500, 500, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 1500; i++) {
        scene.index[i] = i;
        for (uint32_t k = 0; k < 3; k++)
            scene.vertex[3 * i + k] = rng_range(&rng, -1, 1);
    }
    struct geometry geometry = {0, 500, true};
    struct world_mesh mesh = {&scene, &geometry, 1};
    struct world world = {.mesh = &mesh, .mesh_count = 1, .instance_count = COUNT, .borrows = true};
    world.instance = alloc_zeroed(COUNT, sizeof *world.instance);
    for (uint32_t i = 0; i < COUNT; i++) {
        world.instance[i].mask = 0xFF;
        world_turn_draw(&world_turns[2], &rng, world.instance[i].m);
    }
    assert_int_equal(world_finish(&world, &reason), STATUS_OK);
    struct oracle *oracle;
    long before = bytes_held;
    atomic_store(&bytes_most, before);
    assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
    assert_true(bytes_held - before < 160L * COUNT + 500 * 400);
    assert_true(bytes_most - before < 220L * COUNT + 500 * 400); /* while it is made */
    oracle_free(oracle);
    assert_int_equal(bytes_held, before);
    free(world.instance);
    free(world.first);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_world_is_made_or_not),
        cmocka_unit_test(a_tree_is_made_or_zero),
        cmocka_unit_test(crossings_are_listed_or_not),
        cmocka_unit_test(long_lists_are_whole_or_empty),
        cmocka_unit_test(an_instance_takes_little),
    };
    return cmocka_run_group_tests_name("oracle_world_memory", tests, NULL, NULL) ? 1 : 0;
}
