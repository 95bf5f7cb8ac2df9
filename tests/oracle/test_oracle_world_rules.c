/* Laws of the oracle of a world that need no second road: a scene is a world, what an exact
 * transform places is the same as baked vertices, numbers of instances are names, masks and culls
 * are sets. */
#include "tests/exact/gmp_world.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static struct reason reason;

static void closest(const struct oracle *oracle, const struct ray *ray, const struct ray_mode *mode,
                    size_t count, struct oracle_answer *out)
{
    assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, mode, count, 1,
                                          out, NULL, &reason),
                     STATUS_OK);
}

/* --- a scene as a world ----------------------------------------------------------------------- */

static void expect_same_pair(const struct oracle_pair *a, const struct oracle_pair *b)
{
    assert_true(a->class == b->class && a->range == b->range && a->det == b->det);
    assert_true(a->t_lo == b->t_lo && a->t_hi == b->t_hi && a->margin == b->margin);
    assert_true(a->by_filter == b->by_filter);
    assert_memory_equal(a->edge, b->edge, sizeof a->edge);
}

static void expect_same_crossings(const struct oracle *scene, const struct oracle *world,
                                  const struct ray *ray)
{
    struct oracle_crossing *one = NULL, *two = NULL;
    size_t capacity[2] = {0, 0}, count[2];
    assert_int_equal(oracle_crossings(scene, ray, INFINITY, &one, &capacity[0], &count[0], &reason),
                     STATUS_OK);
    assert_int_equal(oracle_crossings_world(world, ray, ray_mode_all(), INFINITY, &two,
                                            &capacity[1], &count[1], &reason),
                     STATUS_OK);
    assert_int_equal(count[0], count[1]);
    for (size_t i = 0; i < count[0]; i++) {
        assert_int_equal(one[i].prim, two[i].prim);
        expect_same_pair(&one[i].pair, &two[i].pair);
    }
    free(one);
    free(two);
}

static void a_scene_is_a_world(void **state)
{
    (void)state;
    static const enum oracle_path paths[] = {ORACLE_BRUTE, ORACLE_TREE, ORACLE_AUTO};
    for (int k = 0; k < ORACLE_CASES; k++)
        for (uint64_t b = 0; b < 6; b++) {
            struct oracle_batch batch;
            struct oracle *oracle;
            struct world world;
            struct oracle_answer want[BATCH], got[BATCH];
            batch_make(&oracle_cases[k], 600 + b, &batch);
            assert_int_equal(world_of_scene(&batch.scene, &world, &reason), STATUS_OK);
            assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
            assert_ptr_equal(oracle_world(oracle), &world);
            assert_null(oracle_scene(oracle));
            assert_null(oracle_world(batch.oracle));
            for (int p = 0; p < 6; p++) {
                enum oracle_ends ends = p % 2 ? ORACLE_OPEN : ORACLE_CLOSED;
                assert_int_equal(oracle_closest(batch.oracle, paths[p / 2], ends, batch.ray, BATCH,
                                                1, want, NULL, &reason),
                                 STATUS_OK);
                assert_int_equal(oracle_closest_world(oracle, paths[p / 2], ends, batch.ray, NULL,
                                                      BATCH, 1, got, NULL, &reason),
                                 STATUS_OK);
                for (int i = 0; i < BATCH; i++)
                    assert_true(answer_same(&want[i], &got[i]));
            }
            for (uint32_t i = 0; i < BATCH; i++) {
                struct oracle_pair one, two;
                oracle_pair(batch.oracle, &batch.ray[i], i, &one);
                oracle_pair(oracle, &batch.ray[i], i, &two);
                expect_same_pair(&one, &two);
                expect_same_crossings(batch.oracle, oracle, &batch.ray[i]);
                if (!one.det)
                    continue;
                assert_int_equal(oracle_is_front(batch.oracle, &one, i), one.det < 0);
                assert_int_equal(oracle_is_front(oracle, &one, i), one.det < 0);
                assert_int_equal(oracle_admit(batch.oracle, &batch.ray[i],
                                              (struct ray_mode){1, ABI_RAY_CULL_BACK}, i, &one),
                                 one.det < 0 ? ORACLE_ADMITTED : ORACLE_CULLED_FACING);
            }
            oracle_free(oracle);
            world_free(&world);
            batch_free(&batch);
        }
}

/* --- baked vertices --------------------------------------------------------------------------- */

/* The placed triangles of a world as a scene, if all vertices are floats. */
static bool bake(const struct world *world, struct scene *out)
{
    uint32_t count = world_tri_count(world);
    bool exact = true;
    mpq_t v[3][3];
    for (int c = 0; c < 3; c++)
        mpq_inits(v[c][0], v[c][1], v[c][2], NULL);
    assert_int_equal(scene_make(3 * count, count, out), STATUS_OK);
    for (uint32_t p = 0; p < count; p++) {
        gmp_world_vertices(world, p, v);
        for (uint32_t i = 0; i < 9; i++) {
            double x = mpq_get_d(v[i / 3][i % 3]);
            out->vertex[9 * p + i] = (float)x;
            exact = exact && exact_gmp_compare(v[i / 3][i % 3], (double)(float)x) == 0;
        }
        for (uint32_t c = 0; c < 3; c++)
            out->index[3 * p + c] = 3 * p + c;
    }
    for (int c = 0; c < 3; c++)
        mpq_clears(v[c][0], v[c][1], v[c][2], NULL);
    return exact;
}

/* All but enclosures, which the filters of the two need not round alike, and t exactly. */
static void expect_baked(const struct oracle *placed, const struct oracle *baked,
                         const struct ray *ray, uint32_t prim)
{
    struct oracle_pair a, b;
    char one[1200], two[1200];
    oracle_pair(placed, ray, prim, &a);
    oracle_pair(baked, ray, prim, &b);
    assert_int_equal(a.class, b.class);
    if (!oracle_is_hit(&a))
        return;
    assert_int_equal(a.range, b.range);
    assert_int_equal(a.det, b.det);
    assert_memory_equal(a.edge, b.edge, sizeof a.edge);
    assert_true(oracle_rational(placed, ray, prim, one, sizeof one));
    assert_true(oracle_rational(baked, ray, prim, two, sizeof two));
    assert_string_equal(one, two);
}

static void exact_transforms_may_be_baked(void **state)
{
    (void)state;
    uint32_t worlds = 0, hits = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 12 && world_turns[k].whole; w++) {
            struct world_case c;
            struct scene scene;
            struct oracle *baked;
            struct oracle_answer got[WORLD_RAYS], want[WORLD_RAYS];
            world_case_make(&world_turns[k], 900 + w, &c);
            for (uint32_t i = 0; i < c.world.instance_count; i++) /* nothing but geometry */
                c.world.instance[i].flags = ABI_INSTANCE_FORCE_OPAQUE, c.world.instance[i].mask = 1;
            oracle_free(c.oracle);
            assert_int_equal(oracle_make_world(&c.world, &c.oracle, &reason), STATUS_OK);
            if (bake(&c.world, &scene)) {
                worlds++;
                assert_int_equal(oracle_make(&scene, &baked, &reason), STATUS_OK);
                closest(c.oracle, c.ray, NULL, WORLD_RAYS, got);
                assert_int_equal(oracle_closest(baked, ORACLE_TREE, ORACLE_CLOSED, c.ray,
                                                WORLD_RAYS, 1, want, NULL, &reason),
                                 STATUS_OK);
                for (int i = 0; i < WORLD_RAYS; i++) {
                    assert_int_equal(got[i].prim, want[i].prim);
                    assert_int_equal(got[i].tie_count, want[i].tie_count);
                    assert_int_equal(got[i].class, want[i].class);
                    hits += got[i].prim != ABI_NO_PRIM;
                    for (uint32_t p = 0; p < scene.tri_count; p++)
                        expect_baked(c.oracle, baked, &c.ray[i], p);
                }
                oracle_free(baked);
            }
            scene_free(&scene);
            world_case_free(&c);
        }
    assert_true(worlds > 20 && hits > 100);
}

/* --- names ------------------------------------------------------------------------------------ */

/* The same world with two instances exchanged, whose meshes have as many triangles. */
static void exchanged_instances_exchange_numbers(void **state)
{
    (void)state;
    uint32_t moved = 0, hits = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 6; w++) {
            struct world_case c;
            struct oracle_answer before[WORLD_RAYS], after[WORLD_RAYS];
            world_case_make(&world_turns[k], 1700 + w, &c);
            c.world.filter.kind = FILTER_ALL; /* the others hash the instance's number */
            closest(c.oracle, c.ray, c.mode, WORLD_RAYS, before);
            oracle_free(c.oracle);
            uint32_t each = c.world.first[1];
            struct instance swap = c.world.instance[0];
            c.world.instance[0] = c.world.instance[4];
            c.world.instance[4] = swap;
            assert_int_equal(oracle_make_world(&c.world, &c.oracle, &reason), STATUS_OK);
            closest(c.oracle, c.ray, c.mode, WORLD_RAYS, after);
            for (int i = 0; i < WORLD_RAYS; i++) {
                assert_int_equal(before[i].tie_count, after[i].tie_count);
                assert_true(before[i].t_next == after[i].t_next);
                hits += before[i].prim != ABI_NO_PRIM;
                if (before[i].tie_count != 1)
                    continue;
                uint32_t at = world_instance_of(&c.world, before[i].prim);
                uint32_t want = before[i].prim;
                if (at == 0 || at == 4)
                    want = c.world.first[4 - at] + before[i].prim - c.world.first[at];
                moved += want != before[i].prim;
                assert_int_equal(after[i].prim, want);
                assert_true(before[i].t_lo == after[i].t_lo && before[i].t_hi == after[i].t_hi);
            }
            assert_int_equal(each, c.world.first[1]);
            world_case_free(&c);
        }
    assert_true(moved > 50 && hits > 200);
}

/* --- masks and culls -------------------------------------------------------------------------- */

/* A cleared bit of an instance's mask leaves what a world without the instance has. */
static void a_masked_instance_is_none(void **state)
{
    (void)state;
    uint32_t changed = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 6; w++) {
            struct world_case c;
            struct ray_mode bit[WORLD_RAYS];
            struct oracle_answer all[WORLD_RAYS], masked[WORLD_RAYS], none[WORLD_RAYS];
            world_case_make(&world_turns[k], 2500 + w, &c);
            c.world.instance[1].mask = 0x35;
            c.world.instance[0].mask = c.world.instance[3].mask = c.world.instance[4].mask = 0x30;
            for (int i = 0; i < WORLD_RAYS; i++)
                bit[i] = (struct ray_mode){0x11, c.mode[i].flags & ~ABI_RAY_SKIP_TRIANGLES};
            closest(c.oracle, c.ray, bit, WORLD_RAYS, all);
            c.world.instance[1].mask = 0x24; /* no bit of 0x11 */
            closest(c.oracle, c.ray, bit, WORLD_RAYS, masked);
            oracle_free(c.oracle);
            c.world.instance[1].mask = 0; /* inactive: the tree has it no more */
            assert_int_equal(oracle_make_world(&c.world, &c.oracle, &reason), STATUS_OK);
            closest(c.oracle, c.ray, bit, WORLD_RAYS, none);
            for (int i = 0; i < WORLD_RAYS; i++) {
                assert_true(answer_same(&masked[i], &none[i]));
                changed += !answer_same(&masked[i], &all[i]);
                assert_true(masked[i].prim == ABI_NO_PRIM ||
                            world_instance_of(&c.world, masked[i].prim) != 1);
            }
            world_case_free(&c);
        }
    assert_true(changed > 50);
}

static size_t list_crossings(const struct world_case *c, int i, struct ray_mode mode,
                             struct oracle_crossing **list)
{
    size_t capacity = 0, count;
    *list = NULL;
    assert_int_equal(oracle_crossings_world(c->oracle, &c->ray[i], mode, INFINITY, list, &capacity,
                                            &count, &reason),
                     STATUS_OK);
    return count;
}

/* Culling the front and culling the back leave all hits, each once; but those of instances that
 * disable it, and touches in plane, which are in both. */
static void front_and_back_are_all(void **state)
{
    (void)state;
    size_t fronts = 0, backs = 0, both = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 5; w++) {
            struct world_case c;
            world_case_make(&world_turns[k], 3100 + w, &c);
            for (int i = 0; i < WORLD_RAYS; i++) {
                struct oracle_crossing *list[3];
                size_t count[3];
                uint32_t flags = c.mode[i].flags &
                                 ~(ABI_RAY_CULL_BACK | ABI_RAY_CULL_FRONT | ABI_RAY_SKIP_TRIANGLES);
                const struct ray_mode mode[3] = {{0xFF, flags},
                                                 {0xFF, flags | ABI_RAY_CULL_BACK},
                                                 {0xFF, flags | ABI_RAY_CULL_FRONT}};
                for (int m = 0; m < 3; m++)
                    count[m] = list_crossings(&c, i, mode[m], &list[m]);
                for (size_t n = 0; n < count[0]; n++) {
                    size_t in[3] = {0, 0, 0};
                    for (int m = 1; m < 3; m++)
                        for (size_t j = 0; j < count[m]; j++)
                            in[m] += list[m][j].prim == list[0][n].prim;
                    uint32_t at = world_instance_of(&c.world, list[0][n].prim);
                    bool twice = list[0][n].pair.class == ORACLE_IN_PLANE ||
                                 (c.world.instance[at].flags & ABI_INSTANCE_CULL_DISABLE);
                    assert_int_equal(in[1] + in[2], twice ? 2 : 1);
                    fronts += !twice && in[1];
                    backs += !twice && in[2];
                    both += twice;
                }
                assert_int_equal(count[1] + count[2], count[0] + both);
                both = 0;
                for (int m = 0; m < 3; m++)
                    free(list[m]);
            }
            world_case_free(&c);
        }
    assert_true(fronts > 100 && backs > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scene_is_a_world),
        cmocka_unit_test(exact_transforms_may_be_baked),
        cmocka_unit_test(exchanged_instances_exchange_numbers),
        cmocka_unit_test(a_masked_instance_is_none),
        cmocka_unit_test(front_and_back_are_all),
    };
    return cmocka_run_group_tests_name("oracle_world_rules", tests, NULL, NULL) ? 1 : 0;
}
