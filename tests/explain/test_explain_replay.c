/* The replay is the reference traversal: the same bits, with nothing changed, over every layout,
 * box test, triangle test and query; and each switch does what it says. */
#include "ref/explain/replay.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/explain/explained.h"
#include "tests/support/opened.h"
#include "tests/support/faults.h"
#include "ref/primitives/test_run.h"
#include "ref/store.h"

#include <math.h>

#define RAYS 400

static void make_rays(const struct scene *scene, struct ray *ray, size_t count)
{
    assert_int_equal(ray_set_make(ray_set_find("mixed"), scene, 3, count, ray, NULL), STATUS_OK);
}

static void same_as_trace_ray(const struct subject *s, const struct ray *ray)
{
    struct explain_tree tree;
    struct replay_change plain = {0};
    assert_int_equal(explain_tree_make(s->scene, &s->bvh, &s->packed, &tree, NULL), STATUS_OK);
    for (size_t b = 0; box_tests[b]; b++)
        for (size_t t = 0; tri_tests[t]; t++)
            for (int q = 0; q <= QUERY_ANY && (b == 0 || tri_tests[t]->core); q++)
                for (size_t i = 0; i < RAYS; i++) {
                    struct explain_replay replay = {.scene = s->scene,
                                                    .tree = &tree,
                                                    .box_id = box_tests[b]->id,
                                                    .tri_id = tri_tests[t]->id,
                                                    .query = (enum query)q};
                    struct hit hit, expected;
                    enum status status = trace_ray(&(struct job){.scene = s->scene,
                                                                 .packed = &s->packed,
                                                                 .box = box_tests[b],
                                                                 .tri = tri_tests[t],
                                                                 .query = (enum query)q},
                                                   &ray[i], &expected, NULL);
                    enum replay_end end = replay_run(&replay, &plain, &ray[i], &hit, NULL);
                    assert_int_equal(end == REPLAY_DONE, status == STATUS_OK);
                    assert_memory_equal(&hit, &expected, sizeof hit);
                }
    explain_tree_free(&tree);
}

static void a_plain_replay_gives_the_bits_of_the_traversal(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300", "grid", "platonic"};
    static struct ray ray[RAYS];
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene = opened(specs[i], 1);
        make_rays(&scene, ray, RAYS);
        for (size_t b = 0; builders[b]; b++)
            for (size_t l = 0; layouts[l]; l++) {
                struct subject s =
                    subject_make(&scene, builders[b]->name, 4, SEED_EPS, layouts[l]->name);
                if (s.status == STATUS_OK)
                    same_as_trace_ray(&s, ray);
                subject_free(&s);
            }
        scene_free(&scene);
    }
}

/* Of wide nodes, too; and what is told of them leads from the root to the triangle's leaf, each box
 * that of its parent's slot. */
static void wide_nodes_are_replayed_and_known(void **state)
{
    (void)state;
    static const char *const names[] = {"bvh2_u12_scene", "bvh4_f16_world", "bvh8_u8_node",
                                        "cwbvh80"};
    static struct ray ray[RAYS];
    struct scene scene = opened("soup:n=300", 1);
    make_rays(&scene, ray, RAYS);
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        struct subject s = subject_make(&scene, "median", 2, SEED_EPS, names[l]);
        struct explain_tree tree;
        assert_int_equal(s.status, STATUS_OK);
        same_as_trace_ray(&s, ray);
        assert_int_equal(explain_tree_make(&scene, &s.bvh, &s.packed, &tree, NULL), STATUS_OK);
        assert_int_equal(tree.record[0], s.packed.root);
        uint32_t known = 0;
        for (uint32_t ref = 0; ref < s.packed.ref_count; ref++) {
            if (tree.node[ref] == EXPLAIN_NONE)
                continue;
            const struct box *box = &tree.box[tree.node[ref]], *exact = &tree.exact[tree.node[ref]];
            known++;
            assert_int_equal(tree.record[tree.node[ref]], ref);
            for (int k = 0; k < 3; k++)
                assert_true(box->lo[k] <= exact->lo[k] && exact->hi[k] <= box->hi[k]);
        }
        assert_in_range(known, s.packed.node_count - 2, s.packed.ref_count);
        explain_tree_free(&tree);
        subject_free(&s);
    }
    scene_free(&scene);
}

/* Also where the traversal gives up: any words, any stack. */
static void a_plain_replay_of_garbage_ends_as_the_traversal(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    struct scene scene = opened("soup:n=200", 1);
    struct rng rng = rng_make(5, 0);
    make_rays(&scene, ray, RAYS);
    for (size_t l = 0; layouts[l]; l++)
        for (int round = 0; round < 6; round++) {
            struct subject s = subject_make(&scene, "median", 4, SEED_EPS, layouts[l]->name);
            assert_int_equal(s.status, STATUS_OK);
            for (int k = 0; k < 1 << round; k++)
                s.packed.word[rng_below(&rng, s.packed.word_count)] = rng_below(&rng, UINT32_MAX);
            /* A traversal of 2^32 - 1 item slots takes too long to be of use here. */
            for (uint32_t w = 7; s.packed.layout->node_bytes == 32 && w < s.packed.word_count;
                 w += 8)
                s.packed.word[w] %= 16;
            for (uint32_t w = 3; s.packed.layout->node_bytes == 48 && w < s.packed.word_count;
                 w += 12)
                s.packed.word[w] %= 16;
            same_as_trace_ray(&s, ray);
            subject_free(&s);
        }
    scene_free(&scene);
}

static void without_a_tree_it_is_brute_force(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    struct scene scene = opened("soup:n=100", 1);
    struct replay_change plain = {0};
    make_rays(&scene, ray, RAYS);
    for (size_t t = 0; tri_tests[t]; t++)
        for (int q = 0; q <= QUERY_ANY; q++)
            for (size_t i = 0; i < RAYS; i++) {
                struct explain_replay replay = {
                    .scene = &scene, .tri_id = tri_tests[t]->id, .query = (enum query)q};
                struct hit hit, expected;
                trace_brute(&scene, tri_tests[t], (enum query)q, &ray[i], &expected);
                assert_int_equal(replay_run(&replay, &plain, &ray[i], &hit, NULL), REPLAY_DONE);
                assert_memory_equal(&hit, &expected, sizeof hit);
            }
    scene_free(&scene);
}

static void the_rule_of_a_box_test_is_found_by_asking_it(void **state)
{
    (void)state;
    struct slab_rule robust = slab_rule_of(ABI_BOX_ROBUST), rtrs = slab_rule_of(ABI_BOX_RTRS);
    assert_true(robust.closed && robust.by_order);
    assert_true(robust.far == SLAB_FAR);
    assert_false(rtrs.closed || rtrs.by_order);
    assert_true(rtrs.far == 1.0f);
}

/* Each property once more, written out: the bits are those of the test itself. */
static void the_rules_give_the_bits_of_the_box_tests(void **state)
{
    (void)state;
    static struct ray ray[RAYS];
    struct scene scene = opened("soup:n=100", 1);
    make_rays(&scene, ray, RAYS);
    size_t hits = 0;
    for (size_t b = 0; box_tests[b]; b++) {
        struct slab_rule rule = slab_rule_of(box_tests[b]->id);
        struct box bounds = scene_bounds(&scene);
        rule.plain = false;
        for (size_t i = 0; i < RAYS; i++)
            for (uint32_t prim = 0; prim < scene.tri_count; prim++) {
                struct slab_ray r = slab_ray_make(&ray[i]), by_rule = r;
                struct box box = scene_tri_bounds(&scene, prim);
                slab_ray_place(&r, &bounds);
                slab_rule_place(&rule, &by_rule, &bounds);
                float entry = 0, expected_entry = 0;
                bool expected = box_test_run(rule.id, &r, &box, ray[i].tmax, &expected_entry);
                assert_int_equal(slab_by_rule(&rule, &by_rule, &box, ray[i].tmax, &entry),
                                 expected);
                assert_true(!expected || float_bits(entry) == float_bits(expected_entry));
                hits += expected;
            }
    }
    assert_true(hits > 1000);
    scene_free(&scene);
}

/* Whatever robust accepts is accepted, and whatever the exact ray meets: points of the box. */
static void the_conservative_box_test_turns_away_nothing_that_is_met(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 0);
    size_t refused = 0;
    for (int i = 0; i < 20000; i++) {
        struct ray ray = {.tmax = INFINITY};
        struct box box;
        float at[3], entry;
        for (int k = 0; k < 3; k++) {
            float a = rng_range(&rng, -4, 4), b = i % 3 ? a : rng_range(&rng, -4, 4);
            box.lo[k] = fminf(a, b);
            box.hi[k] = fmaxf(a, b);
            at[k] = rng_below(&rng, 2) ? box.lo[k] : box.hi[k];
            float scale = ldexpf(1, (int)rng_below(&rng, 8) - 4);
            ray.dir[k] = ((float)rng_below(&rng, 9) - 4) * scale;
            ray.org[k] = at[k] - ray.dir[k]; /* exact often enough */
        }
        bool exact = true;
        for (int k = 0; k < 3; k++)
            exact = exact && (double)ray.org[k] + (double)ray.dir[k] == (double)at[k];
        struct slab_ray r = slab_ray_make(&ray);
        bool met = slab_conservative(&r, &box, ray.tmax, &entry);
        if (exact) {
            assert_true(met);
            assert_true(entry <= 1.0f);
        }
        refused += !met;
        struct slab_ray past = r;
        past.o[0] = 100;
        past.d[0] = 1; /* beyond the box for good */
        assert_false(slab_conservative(&past, &box, ray.tmax, &entry));
    }
    assert_true(refused > 100);
}

/* Notes tell what happened on the way. */
static void note_tri(void *user, uint32_t prim)
{
    *(bool *)user |= prim == 0;
}

static void note_nothing(void *user, uint32_t number)
{
    (void)user, (void)number;
}

/* The entry is some steps of a float behind the exit at 1: a box test that is padded by so many u,
 * of 2^-24, reaches it exactly if both planes moved by that do. */
static void a_box_test_is_padded_by_so_many_u(void **state)
{
    (void)state;
    for (uint32_t steps = 0; steps < 20; steps++) {
        const float near = 1 + 0x1p-23f * (float)steps;
        const float corner[18] = {near, 0,  -1, near + 1, 1,  1,  near, 1,  1,
                                  90,   90, 90, 91,       91, 91, 90,   91, 91};
        uint32_t index[6] = {0, 1, 2, 3, 4, 5};
        float vertex[18];
        memcpy(vertex, corner, sizeof vertex);
        const struct scene scene = {
            .vertex = vertex, .index = index, .vertex_count = 6, .tri_count = 2};
        struct subject s = subject_make(&scene, "median", 1, SEED_EPS, "f32");
        struct explain_tree tree;
        assert_int_equal(explain_tree_make(&scene, &s.bvh, &s.packed, &tree, NULL), STATUS_OK);
        for (uint32_t pad = 0; pad < 24; pad += 2) {
            const struct explain_replay replay = {.scene = &scene,
                                                  .tree = &tree,
                                                  .box_id = ABI_BOX_ROBUST,
                                                  .tri_id = ABI_TRI_MT,
                                                  .query = QUERY_CLOSEST};
            const struct replay_change change = {0, DEFECT_NOT_PADDED, pad};
            const struct ray ray = {{0, 0, 0}, 0, {1, 1, 0}, INFINITY};
            const float lesser = 1 - 0x1p-24f * (float)pad, greater = 1 + 0x1p-24f * (float)pad;
            bool tested = false;
            const struct replay_watch watch = {&tested, note_nothing, note_tri, note_nothing};
            struct replay_notes notes = {.prim = ABI_NO_PRIM, .watch = &watch};
            struct hit hit;
            assert_int_equal(replay_run(&replay, &change, &ray, &hit, &notes), REPLAY_DONE);
            assert_int_equal(tested, near * lesser <= greater);
        }
        explain_tree_free(&tree);
        subject_free(&s);
    }
}

static void notes_follow_the_path(void **state)
{
    (void)state;
    struct scene scene = trees_grid(64);
    struct subject s = subject_make(&scene, "median", 4, SEED_EPS, "rf16");
    struct suspect suspect = suspect_make(&scene, &s.bvh, &s.packed, "robust", "mt");
    for (uint32_t prim = 0; prim < 64; prim++) {
        struct ray ray = ray_at_triangle(&scene, prim);
        struct explain_case the = case_of(&suspect, &ray);
        struct replay_change plain = {0};
        struct replay_note step[2] = {{.node = 0}, {.node = suspect.tree.leaf[prim]}};
        struct replay_notes notes = {.step = step, .count = 2, .prim = prim};
        struct hit hit;
        assert_int_equal(replay_run(&the.replay, &plain, &ray, &hit, &notes), REPLAY_DONE);
        assert_int_equal(hit.prim, prim);
        for (int i = 0; i < 2; i++)
            assert_true(step[i].tested && step[i].hit && step[i].visited && !step[i].skipped);
        assert_true(notes.prim_tested && notes.prim_accepted && notes.prim_kept);
        assert_memory_equal(&notes.prim_hit, &hit, sizeof hit);
    }
    suspect_free(&suspect);
    subject_free(&s);
    scene_free(&scene);
}

/* How many of the rays are answered otherwise than by the traversal of `packed`. */
static size_t count_differences(const struct explain_tree *tree, const struct packed *packed,
                                const struct tri_test *tri, uint32_t repairs, const struct ray *ray)
{
    const struct explain_replay replay = {
        .scene = tree->scene, .tree = tree, .box_id = box_tests[0]->id, .tri_id = tri->id};
    const struct replay_change change = {.repairs = repairs};
    size_t differences = 0;
    for (size_t i = 0; i < RAYS; i++) {
        struct hit hit, expected;
        assert_int_equal(trace_ray(&(struct job){.scene = tree->scene,
                                                 .packed = packed,
                                                 .box = box_tests[0],
                                                 .tri = tri,
                                                 .query = QUERY_CLOSEST},
                                   &ray[i], &expected, NULL),
                         STATUS_OK);
        assert_int_equal(replay_run(&replay, &change, &ray[i], &hit, NULL), REPLAY_DONE);
        differences += memcmp(&hit, &expected, sizeof hit) != 0;
    }
    return differences;
}

/* With the words of a storage turned over the replay is still the traversal, and with the scene's
 * triangles in their place that of a storage in order. */
static void what_a_storage_holds_is_replayed(void **state)
{
    (void)state;
    static const struct {
        const char *store, *tri;
    } pairs[] = {{"gathered", "mt"}, {"edges", "mt"}, {"baldwin_webber", "baldwin_webber"}};
    static struct ray ray[RAYS];
    struct scene scene = opened("soup:n=300", 1);
    make_rays(&scene, ray, RAYS);
    struct subject s = subject_make(&scene, "median", 4, SEED_EPS, "f32");
    for (size_t i = 0; i < ARRAY_COUNT(pairs); i++) {
        const struct tri_test *tri = tri_test_find(pairs[i].tri);
        struct packed packed;
        struct explain_tree tree;
        assert_int_equal(packed_make_stored(layout_find("f32"), tri_store_find(pairs[i].store),
                                            &s.bvh, &scene, &packed, NULL),
                         STATUS_OK);
        assert_int_equal(explain_tree_make(&scene, &s.bvh, &packed, &tree, NULL), STATUS_OK);
        assert_int_equal(count_differences(&tree, &packed, tri, 0, ray), 0);
        for (uint32_t w = 0; w < packed.item_count; w += 10) /* one number of each triangle */
            packed.item[w] ^= 0x80000000u;
        assert_int_equal(count_differences(&tree, &packed, tri, 0, ray), 0);
        assert_true(count_differences(&tree, &s.packed, tri, 0, ray) > RAYS / 8);
        assert_int_equal(count_differences(&tree, &s.packed, tri, 1u << REPAIR_ITEM_STORED, ray),
                         0);
        explain_tree_free(&tree);
        packed_free(&packed);
    }
    subject_free(&s);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plain_replay_gives_the_bits_of_the_traversal),
        cmocka_unit_test(wide_nodes_are_replayed_and_known),
        cmocka_unit_test(a_plain_replay_of_garbage_ends_as_the_traversal),
        cmocka_unit_test(without_a_tree_it_is_brute_force),
        cmocka_unit_test(the_rule_of_a_box_test_is_found_by_asking_it),
        cmocka_unit_test(the_rules_give_the_bits_of_the_box_tests),
        cmocka_unit_test(the_conservative_box_test_turns_away_nothing_that_is_met),
        cmocka_unit_test(a_box_test_is_padded_by_so_many_u),
        cmocka_unit_test(notes_follow_the_path),
        cmocka_unit_test(what_a_storage_holds_is_replayed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
