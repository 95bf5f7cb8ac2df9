/* All hits of rays of a world, of an engine that is made up: each hit has its tag and each ray its
 * mode, wherever lists are moved, sorted, thinned or traced again; also when memory runs out. */
#include "tests/support/allocations.h"

#include "ref/base/rng.h"
#include "ref/trace/all_hits.h"
#include "ref/world/world.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define RAYS 3000u
#define MOST 24u /* hits of a ray; a list has room for 8 at first */

static struct ray ray[RAYS];
static struct ray_mode mode[RAYS];

/* What was asked of the engine. */
static struct {
    uint64_t calls, rays;
    bool without; /* modes are NULL */
    bool forgets; /* another number of hits the second time */
    bool even;    /* no hit has another tag than its equals */
} asked;

/* The hits of a ray in no order, few of them different; what differs may be the tag alone. */
static uint32_t drawn(const struct ray *of, struct ray_mode its, struct hit hit[MOST],
                      uint32_t tag[MOST])
{
    struct rng rng = rng_make((uint64_t)of->org[0], its.mask);
    const uint32_t kinds = 1 + rng_below(&rng, 9), count = rng_below(&rng, MOST + 1);
    for (uint32_t k = 0; k < count; k++) {
        hit[k] = (struct hit){.prim = rng_below(&rng, kinds) / 3};
        hit[k].t = (float)rng_below(&rng, kinds) / 2;
        hit[k].u = (float)(rng_below(&rng, 4) == 0);
        hit[k].v = (float)(rng_below(&rng, 4) == 0);
        tag[k] = its.flags ^ (rng_below(&rng, 3) << 8);
        if (asked.even)
            tag[k] = hit[k].prim + 1000;
    }
    return count;
}

static enum status list_drawn(void *self, const struct ray *of, const struct ray_mode *modes,
                              size_t count, uint32_t capacity, struct hit *hit, uint32_t *tag,
                              uint32_t *hit_count, struct reason *reason)
{
    (void)self, (void)reason;
    asked.calls++;
    asked.rays += count;
    assert_true(count * (size_t)capacity <= ALL_HITS_MOST);
    assert_int_equal(modes == NULL, asked.without);
    for (size_t i = 0; i < count; i++) {
        struct hit all[MOST];
        uint32_t tags[MOST];
        const struct ray_mode its = modes ? modes[i] : ray_mode_all();
        if (modes) /* each ray comes with its own */
            assert_memory_equal(&its, &mode[(size_t)of[i].org[0]], sizeof its);
        hit_count[i] = drawn(&of[i], its, all, tags);
        for (uint32_t k = 0; k < hit_count[i] && k < capacity; k++) {
            hit[i * capacity + k] = all[k];
            tag[i * capacity + k] = tags[k];
        }
        hit_count[i] += asked.forgets && asked.calls > 1;
    }
    return STATUS_OK;
}

static const struct world_tracer tracer = {.trace_world_all = list_drawn};
static const struct engine engine = {.name = "drawing", .worlds = &tracer};

static int make(void **state)
{
    (void)state;
    memset(&asked, 0, sizeof asked);
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = (struct ray){.org = {(float)i}};
        mode[i] = (struct ray_mode){i % 256, i % 7};
    }
    return 0;
}

static bool same(const struct hit *a, uint32_t a_tag, const struct hit *b, uint32_t b_tag)
{
    return memcmp(a, b, sizeof *a) == 0 && a_tag == b_tag;
}

static uint32_t times(const struct hit *hit, const uint32_t *tag, size_t count,
                      const struct hit *one, uint32_t its)
{
    uint32_t sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += same(&hit[i], tag[i], one, its);
    return sum;
}

/* The list of ray i is the engine's; with `once` each hit and tag of it, once, in order. */
static void check_list(const struct all_hits *all, size_t at, size_t i)
{
    struct hit want[MOST];
    uint32_t tags[MOST];
    const struct hit *got = all->hit + all->first[i];
    const uint32_t *tag = all->tag + all->first[i];
    const size_t listed = all->first[i + 1] - all->first[i];
    const struct ray_mode its = asked.without ? ray_mode_all() : mode[at + i];
    const uint32_t count = drawn(&ray[at + i], its, want, tags);
    if (!all->once) {
        assert_int_equal(listed, count);
        assert_memory_equal(got, want, count * sizeof *want);
        assert_memory_equal(tag, tags, count * sizeof *tags);
        return;
    }
    for (uint32_t k = 0; k < count; k++)
        assert_int_equal(times(got, tag, listed, &want[k], tags[k]), 1);
    for (size_t k = 0; k < listed; k++)
        assert_true(times(want, tags, count, &got[k], tag[k]) > 0);
    for (size_t k = 1; k < listed; k++)
        assert_true(got[k - 1].t < got[k].t ||
                    (got[k - 1].t == got[k].t && got[k - 1].prim <= got[k].prim));
}

static void lists_have_their_tags(void **state)
{
    (void)state;
    for (int once = 0; once < 2; once++)
        for (int without = 0; without < 2; without++) {
            struct all_hits all = {.once = once};
            uint64_t longer = 0, hits = 0;
            make(NULL);
            asked.without = without;
            /* The same arrays again, for fewer rays. */
            for (size_t at = 0; at < RAYS; at += all.done) {
                const size_t count = at == 0 ? RAYS - 700 : RAYS - at;
                assert_int_equal(all_hits_next_world(&engine, NULL, ray + at,
                                                     without ? NULL : mode + at, count, &all, NULL),
                                 STATUS_OK);
                assert_int_equal(all.done, count);
                for (size_t i = 0; i < all.done; i++)
                    check_list(&all, at, i);
                hits += all.first[all.done];
            }
            for (uint32_t i = 0; i < RAYS; i++) {
                struct hit hit[MOST];
                uint32_t tag[MOST];
                longer += drawn(&ray[i], without ? ray_mode_all() : mode[i], hit, tag) > 8;
            }
            assert_int_equal(all.again, longer);
            assert_int_equal(asked.rays, RAYS + longer);
            assert_true(longer > RAYS / 3 && hits > 8 * RAYS);
            all_hits_free(&all);
            assert_true(!all.tag && !all.scratch_tag && !all.retry_mode && !all.hit);
        }
}

/* Of few rays and many, also where an array is full to its last element. */
static void arrays_have_room_for_what_is_listed(void **state)
{
    (void)state;
    uint32_t full = 0;
    for (size_t at = 0; at < 40; at++)
        for (size_t count = 1; count <= 34; count++) {
            struct all_hits all = {.once = false};
            assert_int_equal(
                all_hits_next_world(&engine, NULL, ray + at, mode + at, count, &all, NULL),
                STATUS_OK);
            const size_t hits = all.first[all.done];
            assert_true(all.done == count && all.first_capacity > count);
            assert_true(all.hit_capacity >= hits && all.tag_capacity >= hits);
            assert_true(all.scratch_capacity >= 8 * count && all.scratch_tag_capacity >= 8 * count);
            assert_true(all.retry_capacity >= count && all.retry_mode_capacity >= count);
            assert_true(all.retry_of_capacity >= count && all.count_capacity >= 2 * ALL_HITS_RAYS);
            full += hits > 16 && ((hits - 1) & (hits - 2)) == 0; /* one more than a power of 2 */
            all_hits_free(&all);
        }
    assert_true(full > 10);
}

/* By distance and number; equals by what they have beside it, so that one order is right. Of drawn
 * hits no number is negative. */
static bool comes_before(const struct hit *a, uint32_t a_tag, const struct hit *b, uint32_t b_tag)
{
    if (a->t != b->t)
        return a->t < b->t;
    if (a->prim != b->prim)
        return a->prim < b->prim;
    if (a->u != b->u)
        return a->u < b->u;
    return a->v != b->v ? a->v < b->v : a_tag <= b_tag;
}

/* A sorted list is a permutation, hits with their tags, and does not depend on the order before. */
static void sorting_moves_tags_with_hits(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < RAYS; i++) {
        struct hit hit[MOST], sorted[MOST];
        uint32_t tag[MOST], tags[MOST];
        const uint32_t count = drawn(&ray[i], mode[i], hit, tag);
        memcpy(sorted, hit, sizeof sorted);
        memcpy(tags, tag, sizeof tags);
        all_hits_sort_tagged(sorted, tags, count);
        for (uint32_t k = 0; k < count; k++)
            assert_int_equal(times(sorted, tags, count, &hit[k], tag[k]),
                             times(hit, tag, count, &hit[k], tag[k]));
        for (uint32_t k = 1; k < count; k++)
            assert_true(comes_before(&sorted[k - 1], tags[k - 1], &sorted[k], tags[k]));
        for (uint32_t k = 0; k < count; k++) { /* from its end on */
            struct hit turned = hit[k];
            uint32_t its = tag[k];
            if (k < count / 2) {
                hit[k] = hit[count - 1 - k];
                tag[k] = tag[count - 1 - k];
                hit[count - 1 - k] = turned;
                tag[count - 1 - k] = its;
            }
        }
        all_hits_sort_tagged(hit, tag, count);
        assert_memory_equal(hit, sorted, count * sizeof *hit);
        assert_memory_equal(tag, tags, count * sizeof *tag);
    }
    struct hit odd[3] = {{NAN, 0, 0, 1}, {0.0f, 0, 0, 2}, {-0.0f, 0, 0, 2}};
    uint32_t tags[3] = {1, 2, 3};
    all_hits_sort_tagged(odd, tags, 3); /* ends, and loses none */
    assert_int_equal(tags[0] + tags[1] + tags[2], 6);
    all_hits_sort_tagged(NULL, NULL, 0);
}

static void without_tags_that_differ_it_is_the_order_of_scenes(void **state)
{
    (void)state;
    asked.even = true;
    for (uint32_t i = 0; i < RAYS; i++) {
        struct hit hit[MOST], plain[MOST];
        uint32_t tag[MOST];
        const uint32_t count = drawn(&ray[i], mode[i], hit, tag);
        memcpy(plain, hit, sizeof plain);
        all_hits_sort_tagged(hit, tag, count);
        all_hits_sort(plain, count);
        for (uint32_t k = 0; k < count; k++) {
            assert_true(hit[k].t == plain[k].t && hit[k].prim == plain[k].prim);
            assert_int_equal(tag[k], hit[k].prim + 1000);
        }
    }
}

static void lists_without_memory_are_none(void **state)
{
    (void)state;
    for (int once = 0; once < 2; once++) {
        long n = 0;
        for (bool failed = true; failed; n++) {
            struct all_hits all = {.once = once};
            struct reason reason = {""};
            const long before = atomic_load(&held);
            fail_after(n);
            enum status status = all_hits_next_world(&engine, NULL, ray, mode, RAYS, &all, &reason);
            atomic_store(&until_failure, -1);
            failed = has_failed;
            assert_int_equal(status, failed ? STATUS_MEMORY : STATUS_OK);
            if (failed) {
                assert_non_null(strstr(reason.text, "no memory for "));
                assert_int_equal(all.done, 0);
                status = all_hits_next_world(&engine, NULL, ray, mode, RAYS, &all, &reason);
            }
            assert_int_equal(status, STATUS_OK);
            for (size_t i = 0; i < RAYS; i++)
                check_list(&all, 0, i);
            all_hits_free(&all);
            assert_int_equal(held, before);
            assert_true(n < 100);
        }
        assert_in_range(n, 10, 99); /* nine arrays, two of which grow */
    }
}

static void what_cannot_list_is_told(void **state)
{
    (void)state;
    static const struct world_tracer closest = {.trace_world_all = NULL};
    const struct engine scenes = {.name = "scenes"}, listless = {"listless", .worlds = &closest};
    struct all_hits all = {0};
    struct reason reason = {""};
    assert_int_equal(all_hits_next_world(&scenes, NULL, ray, mode, 5, &all, &reason),
                     STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "scenes traces scenes, not worlds");
    assert_int_equal(all_hits_next_world(&listless, NULL, ray, mode, 5, &all, &reason),
                     STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "listless cannot list all hits of a world");
    assert_int_equal(all_hits_next(&engine, NULL, ray, 5, &all, &reason), STATUS_UNSUPPORTED);
    asked.forgets = true;
    assert_int_equal(all_hits_next_world(&engine, NULL, ray, mode, 50, &all, &reason),
                     STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "drawing: a ray hit "));
    assert_int_equal(all.done, 0);
    all_hits_free(&all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(lists_have_their_tags, make),
        cmocka_unit_test_setup(arrays_have_room_for_what_is_listed, make),
        cmocka_unit_test_setup(sorting_moves_tags_with_hits, make),
        cmocka_unit_test_setup(without_tags_that_differ_it_is_the_order_of_scenes, make),
        cmocka_unit_test_setup(lists_without_memory_are_none, make),
        cmocka_unit_test_setup(what_cannot_list_is_told, make),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
