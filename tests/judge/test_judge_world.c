/* Every kind of lie about a world is found. Worlds, rays and modes are random; a lie is made of
 * what is exactly hit, whether it counts or not. */
#include "ref/judge/judge_inner.h"
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

#define WORLDS 1000
#define RAYS   6

/* --- of triangles that do not count ----------------------------------------------------------- */

static void say_what_does_not_count(struct lying *l, uint32_t prim, const struct oracle_pair *pair)
{
    struct hit hit = exact_hit(l, prim, pair);
    uint32_t tag = exact_tag(l, prim, pair);
    bool side = side_at(l, prim) != 0;
    struct twin twin = twin_at(l, prim);
    double du = twin.u_err * 1.001, dv = twin.v_err * 1.001;
    switch (oracle_admit(l->w->oracle, &l->ray, l->mode, prim, pair)) {
    case ORACLE_MASKED:
        lie(l, hit, tag, WRONG_MASKED, false);
        break;
    case ORACLE_CULLED_OPACITY:
        lie(l, hit, tag, WRONG_OPACITY, false);
        break;
    case ORACLE_CULLED_FACING:
        lie(l, hit, tag, WRONG_CULLED, false); /* it says itself which side it sees */
        lie(l, hit, tag ^ ABI_TAG_FRONT, WRONG_CULLED, !side);
        break;
    case ORACLE_FILTERED:
        lie(l, hit, tag, WRONG_OPACITY,
            !isfinite(du) || !isfinite(dv) ||
                oracle_filter_is_open(l->w->oracle, &l->ray, l->mode, prim, du, dv));
        break;
    default:
        break;
    }
}

/* --- of triangles that do --------------------------------------------------------------------- */

/* The same triangle of an instance where nothing of it is hit. */
static void say_anothers(struct lying *l, uint32_t prim, const struct hit *hit, uint32_t tag)
{
    const struct world *world = &l->w->world;
    uint32_t own = world_instance_of(world, prim), local = prim - world->first[own];
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *other = &world->instance[i];
        struct hit named = *hit;
        struct oracle_pair pair;
        named.prim = world->first[i] + local;
        if (i == own || other->mesh != world->instance[own].mesh || !world_meets(other, l->mode))
            continue;
        oracle_pair(l->w->oracle, &l->ray, named.prim, &pair);
        struct twin twin = twin_at(l, named.prim);
        if (twin.possible || other->custom == instance_of(l, prim)->custom ||
            !judge_takes(l->judge, &l->ray, named.prim))
            continue;
        /* With the tag of where it is hit, and with that of the instance that is named; the other
         * may itself rule the triangle out. */
        const uint32_t tags[2] = {tag, other->custom | (tag & ABI_TAG_FRONT)};
        for (int n = 0; n < 2; n++) {
            struct judgement j = judged(l, &named, tags[n]);
            assert_true(j.wrong == WRONG_INSTANCE || j.wrong == WRONG_OPACITY ||
                        (n == 1 && (j.wrong == WRONG_CULLED || j.wrong == WRONG_FACING)));
            l->caught[WRONG_INSTANCE] += j.wrong == WRONG_INSTANCE;
        }
    }
}

static void say_what_is_off(struct lying *l, uint32_t prim, const struct oracle_pair *pair)
{
    struct hit hit = exact_hit(l, prim, pair), far = hit, beside = hit;
    uint32_t tag = exact_tag(l, prim, pair);
    struct twin twin = twin_at(l, prim);
    const struct instance *at = instance_of(l, prim);
    struct judgement right = judged(l, &hit, tag);
    bool was_right = right.verdict != VERDICT_WRONG;
    if (!was_right) /* what lies before it was lost, or the cell of the rounded u is another */
        return;
    lie(l, hit, tag ^ 1u, WRONG_INSTANCE, false);
    lie(l, hit, tag ^ 0x10000u, WRONG_INSTANCE, false);
    lie(l, hit, tag ^ 0x40000000u, WRONG_INSTANCE, false);
    if (side_at(l, prim)) {
        struct judgement j = judged(l, &hit, tag ^ ABI_TAG_FRONT);
        assert_true(j.wrong == WRONG_FACING);
        l->caught[WRONG_FACING]++;
    }
    say_anothers(l, prim, &hit, tag);
    if (!isfinite(twin.t_err) || right.verdict == VERDICT_NOISE ||
        !judge_takes(l->judge, &l->ray, prim))
        return;
    far.t = (float)(twin.t_near + 2.01 * twin.t_err + 2e-7 * fabs(twin.t_near));
    if (far.t < l->ray.tmax && isfinite(far.t)) {
        struct judgement j = judged(l, &far, tag);
        assert_true(j.verdict == VERDICT_WRONG); /* of a wide bound a replay decides: TRIANGLE */
        l->caught[j.wrong]++;
    }
    beside.u = (float)(twin.u_near + 2.01 * twin.u_err + 2e-7);
    if (isfinite(beside.u) && beside.u < 1 && at->flags & ABI_INSTANCE_FORCE_OPAQUE) {
        struct judgement j = judged(l, &beside, tag);
        assert_true(j.verdict == VERDICT_WRONG);
        l->caught[j.wrong]++;
    }
}

/* --- of what is not answered ------------------------------------------------------------------ */

static void say_nothing(struct lying *l, const struct oracle_crossing *list, size_t count)
{
    const struct hit miss = {.prim = ABI_NO_PRIM};
    lie(l, miss, 1, WRONG_INSTANCE, false);
    for (size_t i = 0; i < count; i++)
        if (oracle_is_hit(&list[i].pair) && is_certain(l, &list[i])) {
            lie(l, miss, 0, WRONG_MISSED, false);
            return;
        }
}

static void say_what_is_not_there(struct lying *l)
{
    uint32_t tris = world_tri_count(&l->w->world);
    lie(l, (struct hit){1, 0.25f, 0.25f, tris}, 0, WRONG_PHANTOM, false);
    for (uint32_t prim = 0; prim < tris; prim += 7) {
        const struct instance *at = instance_of(l, prim);
        struct twin twin = twin_at(l, prim);
        if (twin.possible || !world_meets(at, l->mode) || !judge_takes(l->judge, &l->ray, prim))
            continue;
        struct judgement j = judged(l, &(struct hit){1, 0.25f, 0.25f, prim}, at->custom);
        assert_true(j.verdict == VERDICT_WRONG);
        l->caught[j.wrong]++;
    }
}

/* --- all of it -------------------------------------------------------------------------------- */

static void tell_all(struct lying *l)
{
    struct oracle_crossing *list = NULL;
    size_t capacity = 0, count = 0;
    assert_int_equal(oracle_crossings_world(l->w->oracle, &l->ray, l->mode, INFINITY, &list,
                                            &capacity, &count, NULL),
                     STATUS_OK);
    for (uint32_t prim = 0; prim < world_tri_count(&l->w->world); prim++) {
        struct oracle_pair pair;
        oracle_pair(l->w->oracle, &l->ray, prim, &pair);
        if (!oracle_is_hit(&pair) || !oracle_in_range(&pair, ORACLE_OPEN))
            continue;
        say_what_does_not_count(l, prim, &pair);
        if (oracle_admit(l->w->oracle, &l->ray, l->mode, prim, &pair) == ORACLE_ADMITTED)
            say_what_is_off(l, prim, &pair);
    }
    say_nothing(l, list, count);
    say_what_is_not_there(l);
    free(list);
}

static void every_kind_of_lie_is_found(void **state)
{
    (void)state;
    uint32_t caught[WRONG_COUNT] = {0}, open[WRONG_COUNT] = {0};
    for (uint64_t i = 0; i < WORLDS; i++) {
        struct judged_world w;
        struct judge *judge;
        struct model model = model_of(i % OWN, i / OWN % 2);
        judged_world_make(1000 + i, &w);
        struct rng rng = rng_make(i, 13);
        assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
        for (int n = 0; n < RAYS; n++) {
            struct lying l = {.w = &w, .judge = judge, .ray = judged_world_aim(&w, &rng)};
            l.mode = judged_world_mode(&rng);
            l.truth = judged_world_truth(&w, &l.ray, l.mode);
            tell_all(&l);
            for (int k = 0; k < WRONG_COUNT; k++) {
                caught[k] += l.caught[k];
                open[k] += l.open[k];
            }
        }
        judge_free(judge);
        judged_world_free(&w);
    }
    for (int k = WRONG_MISSED; k < WRONG_COUNT; k++)
        print_message("%s %u, excused %u; ", wrong_name((enum wrong)k), caught[k], open[k]);
    print_message("\n");
    assert_true(caught[WRONG_MISSED] > 100 && caught[WRONG_DISTANCE] > 100);
    assert_true(caught[WRONG_MASKED] > 100 && open[WRONG_MASKED] == 0);
    assert_true(caught[WRONG_CULLED] > 100 && open[WRONG_CULLED] * 10 < caught[WRONG_CULLED]);
    assert_true(caught[WRONG_OPACITY] > 100 && open[WRONG_OPACITY] * 4 < caught[WRONG_OPACITY]);
    assert_true(caught[WRONG_INSTANCE] > 1000 && caught[WRONG_FACING] > 100);
}

/* --- a scene in a world ----------------------------------------------------------------------- */

static void assert_alike(const struct judgement *a, const struct judgement *b)
{
    assert_int_equal(a->verdict, b->verdict);
    assert_int_equal(a->wrong, b->wrong);
    assert_int_equal(a->expected, b->expected);
    assert_true(a->behind == b->behind && a->lost == b->lost && a->fan == b->fan);
    assert_memory_equal(&a->over, &b->over, sizeof a->over);
    assert_memory_equal(&a->displacement, &b->displacement, sizeof a->displacement);
    assert_memory_equal(&a->share, &b->share, sizeof a->share);
}

/* A number that was answered, or one that is a little or much off. */
static struct hit spoilt(struct rng *rng, struct hit hit, uint32_t tris)
{
    uint32_t how = rng_below(rng, 6);
    if (how == 0)
        return (struct hit){.prim = ABI_NO_PRIM};
    if (how == 1)
        hit.prim = rng_below(rng, tris);
    if (how == 2 || how == 3)
        hit.t += hit.t * ldexpf(1, -8 * (int)how);
    if (how == 4)
        hit.u += 1e-5f;
    return hit;
}

/* A scene, and the world of it. */
struct both {
    struct judged_world plain; /* without places */
    struct oracle *of_scene;
    struct judge *alone, *placed;
};

static void make_both(const struct scene *scene, const struct model *model, struct both *out)
{
    *out = (struct both){.of_scene = NULL};
    assert_int_equal(world_of_scene(scene, &out->plain.world, NULL), STATUS_OK);
    assert_int_equal(oracle_make(scene, &out->of_scene, NULL), STATUS_OK);
    assert_int_equal(oracle_make_world(&out->plain.world, &out->plain.oracle, NULL), STATUS_OK);
    assert_int_equal(judge_make(out->of_scene, model, QUERY_CLOSEST, &out->alone, NULL), STATUS_OK);
    assert_int_equal(judge_make(out->plain.oracle, model, QUERY_CLOSEST, &out->placed, NULL),
                     STATUS_OK);
}

static void free_both(struct both *both)
{
    judge_free(both->alone);
    judge_free(both->placed);
    oracle_free(both->of_scene);
    oracle_free(both->plain.oracle);
    world_free(&both->plain.world);
}

static void ask_both(const struct both *both, struct rng *rng)
{
    struct lying l = {.w = &both->plain, .judge = both->placed, .ray = {.tmax = INFINITY}};
    struct hit hit = {.prim = ABI_NO_PRIM};
    struct judgement a, b;
    uint32_t tag = 0;
    for (int k = 0; k < 3; k++) {
        l.ray.org[k] = rng_range(rng, -2, 2);
        l.ray.dir[k] = rng_range(rng, -1, 1);
    }
    assert_int_equal(oracle_closest(both->of_scene, ORACLE_BRUTE, ORACLE_CLOSED, &l.ray, 1, 1,
                                    &l.truth, NULL, NULL),
                     STATUS_OK);
    if (l.truth.prim != ABI_NO_PRIM) {
        struct oracle_pair pair;
        oracle_pair(both->plain.oracle, &l.ray, l.truth.prim, &pair);
        hit = spoilt(rng, exact_hit(&l, l.truth.prim, &pair), both->placed->tri_count);
    }
    if (hit.prim != ABI_NO_PRIM && side_at(&l, hit.prim) < 0)
        tag = ABI_TAG_FRONT;
    assert_int_equal(judge_answer(both->alone, &l.ray, &l.truth, &hit, &a), STATUS_OK);
    assert_int_equal(
        judge_world_answer(both->placed, &l.ray, ray_mode_all(), &l.truth, &hit, tag, &b),
        STATUS_OK);
    assert_alike(&a, &b);
}

static void a_scene_in_a_world_is_judged_as_itself(void **state)
{
    (void)state;
    for (uint64_t i = 0; i < 60; i++) {
        struct judged_world w;
        struct both both;
        struct model model = model_of(i % OWN, false);
        struct rng rng = rng_make(i, 29);
        if (i % 6 == 5)
            model = (struct model){.formula = TWIN_UNKNOWN};
        judged_world_make(i, &w);
        make_both(w.world.mesh[i % 2].scene, &model, &both);
        for (int n = 0; n < 200; n++)
            ask_both(&both, &rng);
        free_both(&both);
        judged_world_free(&w);
    }
}

/* --- a cell of the filter --------------------------------------------------------------------- */

/* A triangle that is not opaque, hit at u = 0.25, where the second cell begins. */
static void one_triangle(struct judged_world *w)
{
    struct world world = {.mesh_count = 1, .instance_count = 1};
    struct scene *scene = calloc(1, sizeof *scene);
    world.mesh = calloc(1, sizeof *world.mesh);
    world.instance = calloc(1, sizeof *world.instance);
    struct geometry *geometry = calloc(1, sizeof *geometry);
    assert_true(world.mesh && world.instance && scene && geometry);
    assert_int_equal(scene_make(3, 1, scene), STATUS_OK);
    memcpy(scene->vertex, (float[]){0, 0, 2, 1, 0, 2, 0, 1, 2}, 9 * sizeof(float));
    memcpy(scene->index, (uint32_t[]){0, 1, 2}, 3 * sizeof(uint32_t));
    *geometry = (struct geometry){0, 1, false};
    world.mesh[0] = (struct world_mesh){scene, geometry, 1};
    world.instance[0] =
        (struct instance){.m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}, .mask = 0xFF};
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    judged_world_of(world, w);
}

/* A filter that passes in that cell of u and not in the one beside it. */
static void pass_only(struct judged_world *w, float u, float beside)
{
    const struct place place = world_place(&w->world, 0);
    struct filter_rule *filter = &w->world.filter;
    *filter = (struct filter_rule){.kind = FILTER_CELLS, .share = 128};
    while (!filter_passes(filter, &place, u, 0.1f) || filter_passes(filter, &place, beside, 0.1f))
        filter->seed++;
}

static struct judgement told(struct lying *l, float u)
{
    struct hit hit = {2, u, 0.1f, 0};
    if (u < 0)
        return judged(l, &(struct hit){.prim = ABI_NO_PRIM}, 0);
    return judged(l, &hit, side_at(l, 0) < 0 ? ABI_TAG_FRONT : 0);
}

static void a_cell_that_rounding_decides_leaves_the_triangle_open(void **state)
{
    (void)state;
    const float below = nextafterf(0.25f, 0);
    for (size_t f = 0; f < OWN; f++)
        for (int loose = 0; loose < 2; loose++) {
            struct judged_world w;
            struct judge *judge;
            struct model model = model_of(f, loose);
            one_triangle(&w);
            assert_int_equal(judge_make(w.oracle, &model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
            struct lying l = {.w = &w,
                              .judge = judge,
                              .ray = {{0.25f, 0.1f, 0}, 0, {0, 0, 1}, 9},
                              .mode = ray_mode_all()};
            pass_only(&w, below, 0.25f); /* exactly it does not pass */
            l.truth = judged_world_truth(&w, &l.ray, l.mode);
            assert_int_equal(l.truth.prim, ABI_NO_PRIM);
            assert_int_equal(told(&l, below).verdict, VERDICT_BOUNDARY);
            assert_int_equal(told(&l, -1).verdict, VERDICT_RIGHT);
            assert_int_equal(told(&l, 0.25f).wrong, loose ? WRONG_NOT : WRONG_OPACITY);
            pass_only(&w, 0.25f, below); /* exactly it does */
            l.truth = judged_world_truth(&w, &l.ray, l.mode);
            assert_int_equal(l.truth.prim, 0);
            assert_int_equal(told(&l, 0.25f).verdict, VERDICT_RIGHT);
            assert_int_equal(told(&l, -1).verdict, VERDICT_BOUNDARY);
            assert_int_equal(told(&l, below).wrong, loose ? WRONG_NOT : WRONG_OPACITY);
            judge_free(judge);
            judged_world_free(&w);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_kind_of_lie_is_found),
        cmocka_unit_test(a_scene_in_a_world_is_judged_as_itself),
        cmocka_unit_test(a_cell_that_rounding_decides_leaves_the_triangle_open),
    };
    return cmocka_run_group_tests_name("judge_world", tests, NULL, NULL) ? 1 : 0;
}
