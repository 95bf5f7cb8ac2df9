/* All hits of rays against the lists of engines that are made up; and when memory runs out: that is
 * said wherever it is, nothing is done, and the same arrays serve the next call. */
#include "tests/support/allocations.h"

#include "ref/base/rng.h"
#include "ref/trace/all_hits.h"
#include "tests/support/tree_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define RAYS   40u
#define COPIES 30u /* far more than a ray has room for at first */

static const struct tri_test *woop(void)
{
    return tri_test_find("woop");
}

static struct ray ray_at(uint32_t i)
{
    return (struct ray){.org = {i % 2 ? 0.25f : 5, 0.25f, -1.0f - (float)i},
                        .dir = {0, 0, 1},
                        .tmax = 2 * (float)RAYS};
}

/* Every second ray hits all copies, each once, at its own distance. */
static void check(const struct all_hits *all)
{
    assert_int_equal(all->done, RAYS);
    assert_int_equal(all->first[0], 0);
    for (uint32_t i = 0; i < RAYS; i++) {
        uint32_t seen = 0;
        for (size_t k = all->first[i]; k < all->first[i + 1]; k++) {
            assert_true(all->hit[k].t == 1 + (float)i && all->hit[k].prim < COPIES);
            seen |= 1u << all->hit[k].prim;
        }
        assert_int_equal(all->first[i + 1] - all->first[i], i % 2 ? COPIES : 0);
        assert_int_equal(seen, i % 2 ? (1u << COPIES) - 1 : 0);
    }
}

/* Returns how many allocations there are to fail. */
static long fail_each(const struct engine *engine, const struct job *job, bool once)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    struct ray ray[RAYS];
    for (uint32_t i = 0; i < RAYS; i++)
        ray[i] = ray_at(i);
    for (long n = 0; n < 100; n++) {
        struct all_hits all = {.once = once};
        struct reason reason = {""};
        void *self = NULL;
        assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
        assert_int_equal(engine->prepare(self, job, &reason), STATUS_OK);
        long before = atomic_load(&held);
        fail_after(n);
        enum status status = all_hits_next(engine, self, ray, RAYS, &all, &reason);
        atomic_store(&until_failure, -1);
        bool failed = has_failed;
        if (failed) {
            assert_int_equal(status, STATUS_MEMORY);
            assert_non_null(strstr(reason.text, "no memory for "));
            assert_int_equal(all.done, 0);
            status = all_hits_next(engine, self, ray, RAYS, &all, &reason);
        }
        assert_int_equal(status, STATUS_OK);
        check(&all);
        all_hits_free(&all);
        assert_int_equal(held, before);
        engine->close(self);
        if (!failed)
            return n;
    }
    fail_msg("%s: never ends", engine->name);
    return 0;
}

static const char *const names[] = {"brute",      "cpu", "cpu_stackless", "fast",
                                    "fast_small", "kd",  "dual_split"};

static void lists_without_memory_are_none(void **state)
{
    static const float v[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    (void)state;
    struct scene scene = trees_copies(COPIES, v);
    struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
    struct packed packed;
    assert_int_equal(packed_make(layout_find("f32"), &bvh, &scene, &packed, NULL), STATUS_OK);
    const struct job job = {.scene = &scene,
                            .packed = &packed,
                            .box = box_test_find("robust"),
                            .tri = woop(),
                            .query = QUERY_ALL};
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (int once = 0; once < 2; once++) /* six arrays, and one of them grows */
            assert_in_range(fail_each(engine_find(names[e]), &job, once), 7, 99);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* What could not be opened is nothing, which can be closed. */
static void an_engine_that_does_not_open_is_none(void **state)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        long n = 0;
        for (atomic_store(&has_failed, true); has_failed; n++) {
            struct reason reason = {""};
            void *self = &reason;
            long before = atomic_load(&held);
            fail_after(n);
            enum status status = engine_open(engine, &options, &self, &reason);
            atomic_store(&until_failure, -1);
            assert_int_equal(status, has_failed ? STATUS_MEMORY : STATUS_OK);
            assert_int_equal(has_failed, self == NULL);
            assert_int_equal(has_failed, strcmp(reason.text, "no memory for an engine") == 0);
            engine->close(self);
            assert_int_equal(held, before);
        }
        assert_int_equal(n, strcmp(names[e], "cpu_stackless") == 0 ? 3 : 2);
    }
}

/* Finds 9 triangles for each ray; then, as often as it is asked, one more for the third. */
static enum status forget(void *self, const struct ray *ray, size_t count, uint32_t capacity,
                          struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    uint32_t *calls = self;
    (void)reason;
    for (size_t i = 0; i < count; i++) {
        hit_count[i] = *calls > 0 && ray[i].org[0] == 2 ? 10 : 9;
        for (uint32_t k = 0; k < capacity; k++)
            hit[i * capacity + k] = (struct hit){.t = ray[i].org[0], .prim = k};
    }
    (*calls)++;
    return STATUS_OK;
}

/* Lists of up to 24 hits, few of them different, in no order; those of equal distance, triangle and
 * u can still differ. Never more than the room it is given, which is all that it may have. */
static enum status draw(void *self, const struct ray *ray, size_t count, uint32_t capacity,
                        struct hit *hit, uint32_t *hit_count, struct reason *reason)
{
    uint64_t *asked = self;
    (void)reason;
    asked[0] += count;
    assert_true(count * (size_t)capacity <= ALL_HITS_MOST);
    for (size_t i = 0; i < count; i++) {
        struct rng rng = rng_make((uint64_t)ray[i].org[0], 3);
        uint32_t kinds = 1 + rng_below(&rng, 9);
        hit_count[i] = rng_below(&rng, 25);
        for (uint32_t k = 0; k < hit_count[i]; k++) {
            struct hit one = {.prim = rng_below(&rng, kinds) / 3};
            one.t = (float)rng_below(&rng, kinds) / 2;
            one.u = (float)(rng_below(&rng, 4) == 0);
            if (k < capacity)
                hit[i * capacity + k] = one;
        }
    }
    return STATUS_OK;
}

static bool same_hit(const struct hit *a, const struct hit *b)
{
    return a->t == b->t && a->u == b->u && a->prim == b->prim;
}

static uint32_t times(const struct hit *hit, size_t count, const struct hit *one)
{
    uint32_t same = 0;
    for (size_t i = 0; i < count; i++)
        same += same_hit(&hit[i], one);
    return same;
}

/* Without `once` the engine's lists, hit by hit; with it the same hits by distance and triangle, of
 * which neighbours that are equal are one. */
static void lists_are_the_engines(void **state)
{
    (void)state;
    const struct engine engine = {.name = "drawing", .trace_all = draw};
    static struct ray ray[3000];
    uint64_t asked = 0, ignored = 0, dropped = 0;
    for (uint32_t i = 0; i < ARRAY_COUNT(ray); i++)
        ray[i].org[0] = (float)i;
    for (int once = 0; once < 2; once++) {
        struct all_hits all = {.once = once};
        uint64_t longer = 0;
        asked = 0;
        assert_int_equal(all_hits_next(&engine, &asked, ray, ARRAY_COUNT(ray), &all, NULL), 0);
        assert_true(all.done == ARRAY_COUNT(ray) && all.first[0] == 0);
        for (uint32_t i = 0; i < ARRAY_COUNT(ray); i++) {
            struct hit want[24];
            uint32_t count;
            const struct hit *got = all.hit + all.first[i];
            size_t listed = all.first[i + 1] - all.first[i];
            (void)draw(&ignored, &ray[i], 1, 24, want, &count, NULL);
            longer += count > 8;
            if (!once) {
                assert_int_equal(listed, count);
                assert_memory_equal(got, want, count * sizeof *want);
                continue;
            }
            for (uint32_t k = 0; k < count; k++) {
                uint32_t kept = times(got, listed, &want[k]);
                assert_in_range(kept, 1, times(want, count, &want[k]));
            }
            for (size_t k = 1; k < listed; k++)
                assert_true(!same_hit(&got[k - 1], &got[k]) &&
                            (got[k - 1].t < got[k].t ||
                             (got[k - 1].t == got[k].t && got[k - 1].prim <= got[k].prim)));
            assert_true(listed <= count);
            dropped += count - listed;
        }
        assert_int_equal(all.again, longer);
        assert_int_equal(asked, ARRAY_COUNT(ray) + longer);
        all_hits_free(&all);
    }
    assert_true(dropped > 1000);
}

static void another_number_of_hits_is_told(void **state)
{
    (void)state;
    const struct engine engine = {.name = "forgetful", .trace_all = forget};
    const struct engine listless = {.name = "listless"};
    struct ray ray[5] = {{{0}, 0, {0}, 0}};
    struct all_hits all = {0};
    struct reason reason = {""};
    uint32_t calls = 0;
    for (int i = 0; i < 5; i++)
        ray[i].org[0] = (float)i;
    assert_int_equal(all_hits_next(&engine, &calls, ray, 2, &all, &reason), STATUS_OK);
    assert_true(all.done == 2 && all.again == 2 && calls == 2);
    for (size_t k = 0; k < 18; k++)
        assert_true(all.hit[k].t == (float)(k / 9) && all.hit[k].prim == k % 9);
    calls = 0;
    assert_int_equal(all_hits_next(&engine, &calls, ray, 5, &all, &reason), STATUS_DEVICE);
    assert_string_equal(reason.text, "forgetful: a ray hit 9 triangles, traced again 10");
    assert_int_equal(all.done, 0);
    assert_int_equal(all_hits_next(&listless, NULL, ray, 5, &all, &reason), STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "listless cannot list all hits");
    assert_int_equal(all.done, 0);
    all_hits_free(&all);
    assert_true(!all.first && !all.hit && !all.scratch && !all.count && !all.retry);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_without_memory_are_none),
        cmocka_unit_test(lists_are_the_engines),
        cmocka_unit_test(another_number_of_hits_is_told),
        cmocka_unit_test(an_engine_that_does_not_open_is_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
