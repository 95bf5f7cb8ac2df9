/* Lies about worlds in lists of all hits, and of a tracer whose formula is not known. */
#include "ref/judge/judge_inner.h"
#include "scenes/scenes.h"
#include "tests/judge/honest_world.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/judge/lying.h"

#define WORLDS 500
#define RAYS   6

/* Names the same triangle of other instances in place of an entry of a right list. */
static uint32_t rename_entry(const struct lying *l, struct hit *hit, uint32_t *tag, size_t count,
                             size_t at)
{
    const struct world *world = &l->w->world;
    struct hit kept = hit[at];
    uint32_t kept_tag = tag[at], from = world_instance_of(world, kept.prim), renamed = 0;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        if (i == from || world->instance[i].mesh != world->instance[from].mesh)
            continue;
        hit[at].prim = world->first[i] + kept.prim - world->first[from];
        tag[at] = world->instance[i].custom | (kept_tag & ABI_TAG_FRONT);
        struct list_judgement j = list_judged(l, hit, tag, count);
        renamed += j.judgement.wrong == WRONG_INSTANCE && j.at_fault.prim == hit[at].prim;
    }
    hit[at] = kept;
    tag[at] = kept_tag;
    return renamed;
}

/* Spoils entry `at` of a right list. */
static void spoil_entry(struct lying *l, struct hit *hit, uint32_t *tag, size_t count, size_t at)
{
    struct list_judgement j;
    tag[at] ^= 0x100u;
    j = list_judged(l, hit, tag, count);
    assert_true(j.judgement.wrong == WRONG_INSTANCE && j.at_fault.prim == hit[at].prim);
    tag[at] ^= 0x100u;
    l->caught[WRONG_INSTANCE]++;
    if (side_at(l, hit[at].prim)) {
        tag[at] ^= ABI_TAG_FRONT;
        j = list_judged(l, hit, tag, count);
        assert_true(j.judgement.wrong == WRONG_FACING || j.judgement.wrong == WRONG_CULLED);
        assert_int_equal(j.at_fault.prim, hit[at].prim);
        tag[at] ^= ABI_TAG_FRONT;
        l->caught[WRONG_FACING]++;
    }
}

/* Puts what is exactly hit and does not count at the end of a right list, and leaves out what
 * does. */
static void spoil_list(struct lying *l, struct hit *hit, uint32_t *tag, size_t count)
{
    for (uint32_t prim = 0; prim < world_tri_count(&l->w->world); prim++) {
        struct oracle_pair pair;
        oracle_pair(l->w->oracle, &l->ray, prim, &pair);
        if (!oracle_is_hit(&pair) || !oracle_in_range(&pair, ORACLE_OPEN))
            continue;
        enum oracle_admission admission = oracle_admit(l->w->oracle, &l->ray, l->mode, prim, &pair);
        hit[count] = exact_hit(l, prim, &pair);
        tag[count] = exact_tag(l, prim, &pair);
        enum wrong wrong = list_judged(l, hit, tag, count + 1).judgement.wrong;
        assert_true(admission != ORACLE_MASKED || wrong == WRONG_MASKED);
        assert_true(admission != ORACLE_CULLED_OPACITY || wrong == WRONG_OPACITY);
        assert_true(admission != ORACLE_CULLED_FACING || wrong == WRONG_CULLED);
        l->caught[wrong]++;
    }
    for (size_t i = 0; i < count; i++) {
        struct hit kept = hit[i];
        uint32_t kept_tag = tag[i];
        struct oracle_crossing crossing = {.prim = kept.prim};
        oracle_pair(l->w->oracle, &l->ray, kept.prim, &crossing.pair);
        if (!oracle_is_hit(&crossing.pair) || !is_certain(l, &crossing))
            continue;
        memmove(hit + i, hit + i + 1, (count - i - 1) * sizeof *hit);
        memmove(tag + i, tag + i + 1, (count - i - 1) * sizeof *tag);
        struct list_judgement j = list_judged(l, hit, tag, count - 1);
        assert_true(j.judgement.wrong == WRONG_MISSED && j.judgement.expected == kept.prim);
        l->caught[WRONG_MISSED]++;
        memmove(hit + i + 1, hit + i, (count - i - 1) * sizeof *hit);
        memmove(tag + i + 1, tag + i, (count - i - 1) * sizeof *tag);
        hit[i] = kept;
        tag[i] = kept_tag;
    }
}

static void every_kind_of_lie_is_found_in_lists(void **state)
{
    (void)state;
    uint32_t caught[WRONG_COUNT] = {0}, renamed = 0;
    for (uint64_t i = 0; i < WORLDS; i++) {
        struct judged_world w;
        struct judge *judge;
        struct model model = model_of(i % OWN, false);
        struct rng rng = rng_make(i, 17);
        judged_world_make(5000 + i, &w);
        assert_int_equal(judge_make(w.oracle, &model, QUERY_ALL, &judge, NULL), STATUS_OK);
        for (int n = 0; n < RAYS; n++) {
            struct lying l = {.w = &w, .judge = judge, .ray = judged_world_aim(&w, &rng)};
            struct legal legal = {.rounding = ROUNDING_IEEE, .style = LEGAL_ALL_NEAREST};
            struct hit hit[WORLD_MOST_HITS];
            uint32_t tag[WORLD_MOST_HITS];
            l.mode = judged_world_mode(&rng);
            size_t count = honest_world_list(&w, model.formula, &legal, &l.ray, l.mode, hit, tag);
            struct list_judgement right = list_judged(&l, hit, tag, count);
            assert_true(right.judgement.verdict != VERDICT_WRONG);
            for (size_t k = 0; k < count; k++)
                spoil_entry(&l, hit, tag, count, k);
            for (size_t k = 0; k < count; k++)
                renamed += rename_entry(&l, hit, tag, count, k);
            spoil_list(&l, hit, tag, count);
            for (int k = 0; k < WRONG_COUNT; k++)
                caught[k] += l.caught[k];
        }
        judge_free(judge);
        judged_world_free(&w);
    }
    for (int k = WRONG_MISSED; k < WRONG_COUNT; k++)
        print_message("%s %u; ", wrong_name((enum wrong)k), caught[k]);
    print_message("\n");
    assert_true(caught[WRONG_MISSED] > 100 && caught[WRONG_MASKED] > 20);
    assert_true(caught[WRONG_CULLED] > 100 && caught[WRONG_OPACITY] > 100);
    assert_true(caught[WRONG_INSTANCE] > 1000 && caught[WRONG_FACING] > 100);
    assert_true(caught[WRONG_TWICE] > 100 && renamed > 100);
}

/* --- a black box ------------------------------------------------------------------------------ */

/* True if the transform may excuse more than a hundredth of a mesh of unit size. */
static bool is_wide(const struct lying *l, uint32_t prim)
{
    uint32_t i = world_instance_of(&l->w->world, prim);
    double far = 0, least = INFINITY;
    for (int k = 0; k < 3; k++) {
        double length = 0;
        for (int r = 0; r < 3; r++)
            length += fabs((double)l->w->world.instance[i].m[r][k]);
        least = fmin(least, length);
        far =
            fmax(far, fabs((double)l->ray.org[k]) + fabs((double)l->w->world.instance[i].m[k][3]));
    }
    return 64 * l->judge->place[i].kappa * 0x1p-24 * 3 * far > 0.01 * least;
}

/* Of an unknown formula: what no number decides is no less exact, and behind a transform with a
 * kappa of at most 2^10 a t that is a tenth off is no rounding. */
static void nothing_of_it_is_excused_of_a_black_box(void **state)
{
    (void)state;
    uint32_t caught[WRONG_COUNT] = {0}, ill = 0, off = 0;
    const struct model model = {.formula = TWIN_UNKNOWN};
    for (uint64_t i = 0; i < WORLDS / 2; i++) {
        struct judged_world w;
        struct judge *judge;
        struct rng rng = rng_make(i, 19);
        judged_world_make(9000 + i, &w);
        assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        for (int n = 0; n < RAYS; n++) {
            struct lying l = {.w = &w, .judge = judge, .ray = judged_world_aim(&w, &rng)};
            l.mode = judged_world_mode(&rng);
            l.truth = judged_world_truth(&w, &l.ray, l.mode);
            for (uint32_t prim = 0; prim < world_tri_count(&w.world); prim++) {
                struct oracle_pair pair;
                oracle_pair(w.oracle, &l.ray, prim, &pair);
                if (!oracle_is_hit(&pair) || !oracle_in_range(&pair, ORACLE_OPEN))
                    continue;
                struct hit hit = exact_hit(&l, prim, &pair), far = hit;
                uint32_t tag = exact_tag(&l, prim, &pair);
                enum oracle_admission a = oracle_admit(w.oracle, &l.ray, l.mode, prim, &pair);
                if (a == ORACLE_MASKED)
                    lie(&l, hit, tag, WRONG_MASKED, false);
                if (a == ORACLE_CULLED_OPACITY)
                    lie(&l, hit, tag, WRONG_OPACITY, false);
                if (a == ORACLE_CULLED_FACING)
                    lie(&l, hit, tag, WRONG_CULLED, false);
                if (a != ORACLE_ADMITTED)
                    continue;
                lie(&l, hit, tag ^ 2u, WRONG_INSTANCE, false);
                struct judgement j = judged(&l, &hit, tag);
                ill += j.ill_conditioned;
                far.t *= 0.9f;
                bool beside = pair.margin < 0.01 || is_wide(&l, prim);
                if (!judge_takes(judge, &l.ray, prim) && prim == l.truth.prim) {
                    assert_true(j.verdict == VERDICT_OUT_OF_CONTRACT);
                } else if (!beside && prim == l.truth.prim && far.t > l.ray.tmin) {
                    j = judged(&l, &far, tag);
                    off += j.verdict == VERDICT_WRONG;
                    caught[WRONG_NOT]++;
                }
            }
            for (int k = 0; k < WRONG_COUNT; k++)
                caught[k] += l.caught[k];
        }
        judge_free(judge);
        judged_world_free(&w);
    }
    print_message(
        "masked %u, culled %u, opacity %u, instance %u; ill-conditioned %u; a t that is off "
        "%u of %u\n",
        caught[WRONG_MASKED], caught[WRONG_CULLED], caught[WRONG_OPACITY], caught[WRONG_INSTANCE],
        ill, off, caught[WRONG_NOT]);
    assert_true(caught[WRONG_MASKED] > 20 && caught[WRONG_CULLED] > 100);
    assert_true(caught[WRONG_OPACITY] > 100 && caught[WRONG_INSTANCE] > 100 && ill > 0);
    assert_true(caught[WRONG_NOT] > 50 && off * 20 > caught[WRONG_NOT] * 19);
}

/* Any hit without a triangle: an honest one is never WRONG; where nothing can be hit it is a
 * phantom, also if what is there is masked or culled. */
static void a_hit_without_a_triangle_must_be_possible(void **state)
{
    (void)state;
    const struct model model = {.formula = TWIN_UNKNOWN, .any_unnamed = true};
    uint32_t phantom = 0, hidden = 0, excused = 0;
    for (uint64_t i = 0; i < WORLDS / 2; i++) {
        struct judged_world w;
        struct judge *judge;
        struct rng rng = rng_make(i, 41);
        judged_world_make(11000 + i, &w);
        assert_int_equal(judge_make(w.oracle, &model, QUERY_ANY, &judge, NULL), STATUS_OK);
        for (int n = 0; n < RAYS; n++) {
            struct lying l = {.w = &w, .judge = judge, .ray = judged_world_aim(&w, &rng)};
            const struct hit says_hit = {.prim = 0};
            l.mode = judged_world_mode(&rng);
            l.truth = judged_world_truth(&w, &l.ray, l.mode);
            struct judgement j = judged(&l, &says_hit, 0);
            if (l.truth.prim != ABI_NO_PRIM) {
                assert_int_equal(j.verdict, VERDICT_RIGHT);
                continue;
            }
            struct oracle_answer any = judged_world_truth(&w, &l.ray, ray_mode_all());
            phantom += j.wrong == WRONG_PHANTOM;
            hidden += j.wrong == WRONG_PHANTOM && any.prim != ABI_NO_PRIM;
            excused += j.verdict != VERDICT_WRONG;
        }
        judge_free(judge);
        judged_world_free(&w);
    }
    print_message("phantoms %u, of them %u before what does not count; excused %u\n", phantom,
                  hidden, excused);
    assert_true(phantom > 50 && hidden > 20 && excused > 0);
}

/* Of two instances at one place the one that is named is meant: what is wrong with u is that. */
static void instances_at_one_place_are_not_exchanged(void **state)
{
    (void)state;
    const struct model model = {.formula = TWIN_UNKNOWN};
    struct world world = {.mesh_count = 1, .instance_count = 2};
    struct judged_world w;
    struct judge *judge;
    world.mesh = calloc(1, sizeof *world.mesh);
    world.instance = calloc(2, sizeof *world.instance);
    struct scene *scene = calloc(1, sizeof *scene);
    assert_int_equal(scene_open("grid:n=1,height=0", 1, scene, NULL), STATUS_OK);
    world.mesh[0] = (struct world_mesh){scene, calloc(1, sizeof *world.mesh[0].geometry), 1};
    world.mesh[0].geometry[0] = (struct geometry){0, scene->tri_count, true};
    for (int i = 0; i < 2; i++)
        world.instance[i] = (struct instance){
            .m = {{1, 0, 0, 3}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF, .custom = 5};
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    judged_world_of(world, &w);
    assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    struct lying l = {.w = &w,
                      .judge = judge,
                      .ray = {{3.25f, 0.125f, -1}, 0, {0, 0, 1}, 10},
                      .mode = ray_mode_all()};
    l.truth = judged_world_truth(&w, &l.ray, l.mode);
    uint32_t seen = 0;
    for (uint32_t prim = 0; prim < 4; prim++) {
        struct oracle_pair pair;
        oracle_pair(w.oracle, &l.ray, prim, &pair);
        if (!oracle_is_hit(&pair))
            continue;
        struct hit hit = exact_hit(&l, prim, &pair);
        struct hit off = hit;
        off.u += 0.25f;
        seen++;
        bool front = judged(&l, &hit, 5 | ABI_TAG_FRONT).wrong == WRONG_NOT;
        uint32_t tag = 5 | (front ? ABI_TAG_FRONT : 0);
        assert_int_equal(judged(&l, &hit, tag).wrong, WRONG_NOT);
        assert_int_equal(judged(&l, &off, tag).wrong, WRONG_BARYCENTRIC);
    }
    assert_int_equal(seen, 2);
    judge_free(judge);
    judged_world_free(&w);
}

/* In a world of more triangles than are all looked at, flat grids side by side: a hit one unit in
 * the last place beside a grid is excused in every instance, and one between two grids in none. */
static void large_worlds_are_looked_into_near_the_ray(void **state)
{
    (void)state;
    enum { GRIDS = 9, SIDE = 250 };
    const struct model model = {.formula = TWIN_UNKNOWN, .any_unnamed = true};
    struct world world = {.mesh_count = 1, .instance_count = GRIDS};
    struct judged_world w;
    struct judge *judge;
    world.mesh = calloc(1, sizeof *world.mesh);
    world.instance = calloc(GRIDS, sizeof *world.instance);
    world.mesh[0] =
        (struct world_mesh){calloc(1, sizeof(struct scene)), calloc(1, sizeof(struct geometry)), 1};
    assert_int_equal(scene_open("grid:n=250,height=0", 1, world.mesh[0].scene, NULL), STATUS_OK);
    world.mesh[0].geometry[0] = (struct geometry){0, world.mesh[0].scene->tri_count, true};
    struct box box = scene_bounds(world.mesh[0].scene);
    for (int i = 0; i < GRIDS; i++)
        world.instance[i] = (struct instance){
            .m = {{1, 0, 0, (float)(2 * SIDE * i)}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF};
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    assert_true(world_tri_count(&world) > JUDGE_ALL_MOST);
    judged_world_of(world, &w);
    assert_int_equal(judge_make(w.oracle, &model, QUERY_ANY, &judge, NULL), STATUS_OK);
    for (int i = 0; i < 2 * GRIDS; i++) {
        float at = box.hi[0] + (float)(2 * SIDE * (i / 2)),
              x = i % 2 ? at + 0.25f * SIDE : nextafterf(at, INFINITY);
        struct lying l = {
            .w = &w,
            .judge = judge,
            .ray = {{x, 0.5f * (box.lo[1] + box.hi[1]) + 0.25f, -1000}, 0, {0, 0, 1}, 1e4f},
            .mode = ray_mode_all()};
        const struct hit says_hit = {.prim = 0};
        l.truth = judged_world_truth(&w, &l.ray, l.mode);
        assert_int_equal(l.truth.prim, ABI_NO_PRIM);
        struct judgement j = judged(&l, &says_hit, 0);
        assert_int_equal(j.verdict, i % 2 ? VERDICT_WRONG : VERDICT_BOUNDARY);
        assert_int_equal(j.wrong, i % 2 ? WRONG_PHANTOM : WRONG_NOT);
    }
    judge_free(judge);
    judged_world_free(&w);
}

/* --- contract --------------------------------------------------------------------------------- */

/* One triangle across the x axis, sheared so little that the direction of the ray along that axis
 * gets a component below 2^-60 in the space of the mesh. */
static void out_of_contract_in_an_instance_is_not_judged(void **state)
{
    (void)state;
    const struct model model = model_of(0, false);
    struct judged_world w;
    struct judge *judge;
    struct world world = {.mesh_count = 1, .instance_count = 1};
    world.mesh = calloc(1, sizeof *world.mesh);
    world.instance = calloc(1, sizeof *world.instance);
    assert_true(world.mesh && world.instance);
    struct scene *scene = calloc(1, sizeof *scene);
    assert_int_equal(scene_make(3, 1, scene), STATUS_OK);
    memcpy(scene->vertex, (float[]){2, -1, -1, 2, 3, -1, 2, -1, 3}, 9 * sizeof(float));
    memcpy(scene->index, (uint32_t[]){0, 1, 2}, 3 * sizeof(uint32_t));
    world.mesh[0] = (struct world_mesh){scene, calloc(1, sizeof *world.mesh[0].geometry), 1};
    world.mesh[0].geometry[0] = (struct geometry){0, 1, true};
    for (int n = 0; n < 2; n++) {
        float shear = n ? 0x1p-70f : 0x1p-50f;
        world.instance[0] =
            (struct instance){.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {shear, 0, 1, 0}}, .mask = 0xFF};
        assert_int_equal(world_finish(&world, NULL), STATUS_OK);
        judged_world_of(world, &w);
        assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        struct lying l = {
            .w = &w, .judge = judge, .ray = {{0, 0, 0}, 0, {1, 0, 0}, 9}, .mode = ray_mode_all()};
        l.truth = judged_world_truth(&w, &l.ray, l.mode);
        assert_int_equal(l.truth.prim, 0);
        struct judgement lost = judged(&l, &(struct hit){.prim = ABI_NO_PRIM}, 0);
        struct judgement off = judged(&l, &(struct hit){3, 0.25f, 0.25f, 0}, 0);
        assert_int_equal(lost.verdict, n ? VERDICT_OUT_OF_CONTRACT : VERDICT_WRONG);
        assert_int_equal(off.verdict, n ? VERDICT_OUT_OF_CONTRACT : VERDICT_WRONG);
        assert_false(lost.ill_conditioned || off.ill_conditioned);
        judge_free(judge);
        oracle_free(w.oracle);
        free(w.place);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_lie_is_found_in_lists),
        cmocka_unit_test(nothing_of_it_is_excused_of_a_black_box),
        cmocka_unit_test(a_hit_without_a_triangle_must_be_possible),
        cmocka_unit_test(instances_at_one_place_are_not_exchanged),
        cmocka_unit_test(large_worlds_are_looked_into_near_the_ray),
        cmocka_unit_test(out_of_contract_in_an_instance_is_not_judged),
    };
    return cmocka_run_group_tests_name("judge_world_lists", tests, NULL, NULL) ? 1 : 0;
}
