/* The all-hits query: trace_ray_all and trace_brute_all against their definitions, and what
 * ref/trace/all_hits.c promises. Engines are in test_all_engines.c. */
#include "tests/support/all_hits_fixture.h"

#include "ref/oracle/oracle.h"
#include "ref/primitives/test_run.h"

#include <math.h>

#define RAYS 4000

static struct oracle *oracle_of(const struct scene *scene)
{
    struct oracle *oracle;
    struct reason reason = {""};
    stand_must(oracle_make(scene, &oracle, &reason), &reason);
    return oracle;
}

static bool listed(const struct hit *hit, size_t count, uint32_t prim)
{
    for (size_t i = 0; i < count; i++)
        if (hit[i].prim == prim)
            return true;
    return false;
}

/* Every triangle that the test accepts, once, in index order. */
static void brute_lists_what_the_test_accepts(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("soup:n=200,size=0.5", "mixed", 500, "f32", 4);
    size_t total = 0;
    for (size_t t = 0; tri_tests[t]; t++)
        for (size_t i = 0; i < s.ray_count; i++) {
            struct hit hit[200];
            struct tri_ray r = tri_ray_make(&s.ray[i]);
            uint32_t count = trace_brute_all(&s.scene, tri_tests[t], &s.ray[i], 200, hit), at = 0;
            for (uint32_t prim = 0; prim < s.scene.tri_count; prim++) {
                float v[3][3];
                struct hit one;
                scene_tri(&s.scene, prim, v);
                if (!tri_test_run(tri_tests[t]->id, &r, v, &one))
                    continue;
                one.prim = prim;
                assert_true(at < count);
                assert_memory_equal(&hit[at], &one, sizeof one);
                at++;
            }
            assert_int_equal(at, count);
            total += count;
        }
    assert_true(total > 3 * s.ray_count);
    stand_free(&s);
}

/* A tree finds each triangle of brute force's list at most once and with the same bits, and none
 * beside; what it leaves out is no exact hit. */
static void a_tree_leaves_out_no_exact_hit(void **state)
{
    (void)state;
    static const char *const specs[] = {"soup:n=300,size=0.5", "flake", "cornell", "stack"};
    for (size_t k = 0; k < ARRAY_COUNT(specs); k++) {
        struct fixture_stand s = stand_make(specs[k], "mixed", RAYS, k % 2 ? "rf16" : "f32", 8);
        struct oracle *oracle = oracle_of(&s.scene);
        struct hit *all = calloc(s.scene.tri_count, sizeof *all);
        struct hit *got = calloc(s.scene.tri_count, sizeof *got);
        assert_true(all && got);
        size_t found = 0;
        for (size_t i = 0; i < s.ray_count; i++) {
            const struct tri_test *tri = tri_tests[i % 2];
            uint32_t most = s.scene.tri_count, count;
            uint32_t brute = trace_brute_all(&s.scene, tri, &s.ray[i], most, all);
            assert_int_equal(trace_ray_all(&(struct job){.scene = &s.scene,
                                                         .packed = &s.packed,
                                                         .box = box_tests[0],
                                                         .tri = tri,
                                                         .query = QUERY_ALL},
                                           &s.ray[i], most, got, &count, NULL),
                             STATUS_OK);
            all_hits_sort(got, count);
            for (uint32_t j = 1; j < count; j++)
                assert_true(got[j - 1].t < got[j].t ||
                            (got[j - 1].t == got[j].t && got[j - 1].prim < got[j].prim));
            for (uint32_t j = 0; j < brute; j++) {
                struct oracle_pair pair;
                size_t at = 0;
                while (at < count && got[at].prim != all[j].prim)
                    at++;
                if (at < count) {
                    assert_memory_equal(&got[at], &all[j], sizeof *got);
                    found++;
                    continue;
                }
                oracle_pair(oracle, &s.ray[i], all[j].prim, &pair);
                if (pair.class != ORACLE_MISS && pair.class != ORACLE_ZERO_AREA &&
                    pair.range != ORACLE_BELOW && pair.range != ORACLE_ABOVE)
                    fail_msg("%s ray %zu: triangle %u (%s, margin %g) is not listed", specs[k], i,
                             all[j].prim, oracle_class_name(pair.class), pair.margin);
            }
            for (uint32_t j = 0; j < count; j++)
                assert_true(listed(all, brute, got[j].prim));
        }
        assert_true(found > RAYS / 2);
        free(all);
        free(got);
        oracle_free(oracle);
        stand_free(&s);
    }
}

/* The nearest of all hits is the closest hit, except where a box behind it hides a nearer one that
 * no exact ray hits. */
static void the_nearest_of_all_is_the_closest(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("soup:n=300,size=0.5", "random", RAYS, "f32", 4);
    size_t hits = 0;
    for (size_t i = 0; i < s.ray_count; i++) {
        struct hit all[300], closest;
        uint32_t count;
        assert_int_equal(trace_ray_all(&(struct job){.scene = &s.scene,
                                                     .packed = &s.packed,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[0],
                                                     .query = QUERY_ALL},
                                       &s.ray[i], 300, all, &count, NULL),
                         STATUS_OK);
        assert_int_equal(trace_ray(&(struct job){.scene = &s.scene,
                                                 .packed = &s.packed,
                                                 .box = box_tests[0],
                                                 .tri = tri_tests[0],
                                                 .query = QUERY_CLOSEST},
                                   &s.ray[i], &closest, NULL),
                         STATUS_OK);
        all_hits_sort(all, count);
        assert_int_equal(count > 0, closest.prim != ABI_NO_PRIM);
        if (count > 0)
            assert_memory_equal(&all[0], &closest, sizeof closest);
        hits += count;
    }
    assert_true(hits > RAYS);
    stand_free(&s);
}

/* Too little room: the count is whole, the first hits are the same, nothing else is written. */
static void room_cuts_the_list_not_the_count(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("stack:n=12", "primary", 400, "f32", 4);
    size_t cut = 0;
    for (size_t i = 0; i < s.ray_count; i++) {
        struct hit all[512], got[512];
        uint32_t count, again;
        assert_int_equal(trace_ray_all(&(struct job){.scene = &s.scene,
                                                     .packed = &s.packed,
                                                     .box = box_tests[0],
                                                     .tri = tri_tests[0],
                                                     .query = QUERY_ALL},
                                       &s.ray[i], 512, all, &count, NULL),
                         STATUS_OK);
        assert_true(count <= 512);
        for (uint32_t room = 0; room <= 5; room++) {
            memset(got, 0xA5, sizeof got);
            struct hit canary = got[0];
            assert_int_equal(trace_ray_all(&(struct job){.scene = &s.scene,
                                                         .packed = &s.packed,
                                                         .box = box_tests[0],
                                                         .tri = tri_tests[0],
                                                         .query = QUERY_ALL},
                                           &s.ray[i], room, room ? got : NULL, &again, NULL),
                             STATUS_OK);
            assert_int_equal(again, count);
            uint32_t kept = count < room ? count : room;
            assert_memory_equal(got, all, kept * sizeof *got);
            assert_memory_equal(&got[kept], &canary, sizeof canary);
            memset(got, 0xA5, sizeof got);
            assert_int_equal(trace_brute_all(&s.scene, tri_tests[0], &s.ray[i], room, got), count);
            assert_memory_equal(&got[kept], &canary, sizeof canary);
            cut += count > room;
        }
    }
    assert_true(cut > 100);
    stand_free(&s);
}

/* Work is counted, a cyclic tree ends. */
static void a_cycle_ends_with_no_count(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("soup:n=64,size=0.5", "primary", 64, "f32", 4);
    struct node_f32 *node = (struct node_f32 *)s.packed.word;
    struct trace_counts counts = {0, 0};
    size_t limits = 0;
    for (uint32_t i = 0; i < s.packed.node_count; i++)
        if (node[i].count == 0)
            node[i].first = 0; /* back to the root */
    for (size_t i = 0; i < s.ray_count; i++) {
        struct hit hit[8];
        uint32_t count = 77;
        enum status status = trace_ray_all(&(struct job){.scene = &s.scene,
                                                         .packed = &s.packed,
                                                         .box = box_tests[0],
                                                         .tri = tri_tests[0],
                                                         .query = QUERY_ALL},
                                           &s.ray[i], 8, hit, &count, &counts);
        assert_true(status == STATUS_OK || (status == STATUS_LIMIT && count == 0));
        limits += status == STATUS_LIMIT;
    }
    assert_true(limits > 0 && counts.boxes > 0);
    stand_free(&s);
}

static void sorting_is_by_distance_then_index(void **state)
{
    (void)state;
    struct hit hit[] = {{2, 0, 0, 1}, {1, 0, 0, 9}, {1, 0, 0, 3}, {0.5f, 0, 0, 7}};
    static const uint32_t order[] = {7, 3, 9, 1};
    all_hits_sort(hit, ARRAY_COUNT(hit));
    for (size_t i = 0; i < ARRAY_COUNT(hit); i++)
        assert_int_equal(hit[i].prim, order[i]);
}

/* A made-up engine: ray i has as many hits as its tmin says, the k-th is triangle k. */
struct all_counting {
    size_t most_at_once, traced, calls;
    bool forgets; /* the second time one hit less */
};

static enum status counting_all(void *self, const struct ray *ray, size_t ray_count,
                                uint32_t capacity, struct hit *hit, uint32_t *hit_count,
                                struct reason *reason)
{
    struct all_counting *c = self;
    (void)reason;
    if (ray_count * capacity > c->most_at_once)
        c->most_at_once = ray_count * capacity;
    c->traced += ray_count;
    c->calls++;
    for (size_t i = 0; i < ray_count; i++) {
        hit_count[i] = (uint32_t)ray[i].tmin - (c->forgets && capacity > 8);
        for (uint32_t k = 0; k < hit_count[i] && k < capacity; k++)
            hit[i * capacity + k] = (struct hit){ray[i].tmax, 0, 0, k};
    }
    return STATUS_OK;
}

static const struct engine counting_engine = {.name = "counting", .trace_all = counting_all};

static void lists_are_whole_and_memory_is_bounded(void **state)
{
    (void)state;
    struct all_counting c = {0};
    struct all_hits all = {0};
    struct reason reason = {""};
    enum { COUNT = 40000 };
    struct ray *ray = calloc(COUNT, sizeof *ray);
    assert_non_null(ray);
    for (size_t i = 0; i < COUNT; i++) {
        ray[i].tmin = (float)(i % 10);
        ray[i].tmax = (float)i;
        if (i % 100 == 7)
            ray[i].tmin = 100000;
    }
    ray[999].tmin = 5e6f; /* alone over the limit */
    size_t most = 0;
    for (size_t at = 0; at < COUNT; at += all.done) {
        stand_must(all_hits_next(&counting_engine, &c, ray + at, COUNT - at, &all, &reason),
                   &reason);
        assert_true(all.done > 0 && all.done <= ALL_HITS_RAYS);
        for (size_t i = 0; i < all.done; i++) {
            size_t count = all.first[i + 1] - all.first[i];
            assert_int_equal(count, (size_t)ray[at + i].tmin);
            for (size_t k = 0; k < count; k++) {
                const struct hit *hit = &all.hit[all.first[i] + k];
                assert_true(hit->prim == k && hit->t == ray[at + i].tmax);
            }
        }
        if (all.done > 1 || ray[at].tmin < 1e6f)
            most = all.first[all.done] > most ? all.first[all.done] : most;
    }
    assert_true(most <= ALL_HITS_MOST && most > ALL_HITS_MOST / 2);
    assert_true(c.most_at_once <= 5000000);
    assert_int_equal(all.again, COUNT / 100 + COUNT / 10);
    c.forgets = true;
    assert_int_equal(all_hits_next(&counting_engine, &c, ray, COUNT, &all, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "traced again"));
    assert_int_equal(all.done, 0);
    all_hits_free(&all);
    free(ray);
}

/* Rays with so many hits, none of which is kept: how many are done at once, in how many calls. */
static size_t done_of(const uint32_t *hits, size_t rays, size_t *calls)
{
    struct all_counting c = {0};
    struct all_hits all = {0};
    struct reason reason = {""};
    struct ray ray[4] = {0};
    for (size_t i = 0; i < rays; i++)
        ray[i].tmin = (float)hits[i];
    stand_must(all_hits_next(&counting_engine, &c, ray, rays, &all, &reason), &reason);
    size_t done = all.done;
    *calls = c.calls;
    all_hits_free(&all);
    return done;
}

/* What fits to the last hit is done at once, in place and among those that are traced again; of one
 * hit more a part waits. */
static void limits_are_met_exactly(void **state)
{
    (void)state;
    const uint32_t half = ALL_HITS_MOST / 2, quarter = ALL_HITS_MOST / 4;
    const struct {
        uint32_t hits[4];
        size_t rays, done, calls;
    } cases[] = {
        {{half, half}, 2, 2, 2},
        {{half, half + 1}, 2, 1, 2},
        {{half + 1, half}, 2, 1, 2},
        {{half, half - 1, 1}, 3, 3, 2}, /* the third needs no second call */
        {{half, half - 1, 2}, 3, 2, 2},
        {{quarter, quarter, quarter, quarter}, 4, 4, 2},
        {{quarter, quarter, quarter + 1, quarter - 1}, 4, 4, 3}, /* as many places for each */
        {{9, half, 9, 9}, 4, 4, 3},
        {{9, quarter, 9, 9}, 4, 4, 2},
        {{8, 8, 8, 8}, 4, 4, 1},
        {{ALL_HITS_MOST + 1, 1}, 2, 1, 2},
        {{0, ALL_HITS_MOST, 0, 1}, 4, 3, 2},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        size_t calls;
        assert_int_equal(done_of(cases[i].hits, cases[i].rays, &calls), cases[i].done);
        assert_int_equal(calls, cases[i].calls);
    }
}

static void an_engine_that_cannot_is_said(void **state)
{
    (void)state;
    const struct engine none = {.name = "none"};
    struct all_hits all = {0};
    struct reason reason = {""};
    struct ray ray = {{0}, 0, {1, 0, 0}, 1};
    assert_int_equal(all_hits_next(&none, NULL, &ray, 1, &all, &reason), STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "none"));
    all_hits_free(&all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(brute_lists_what_the_test_accepts),
        cmocka_unit_test(a_tree_leaves_out_no_exact_hit),
        cmocka_unit_test(the_nearest_of_all_is_the_closest),
        cmocka_unit_test(room_cuts_the_list_not_the_count),
        cmocka_unit_test(a_cycle_ends_with_no_count),
        cmocka_unit_test(sorting_is_by_distance_then_index),
        cmocka_unit_test(lists_are_whole_and_memory_is_bounded),
        cmocka_unit_test(limits_are_met_exactly),
        cmocka_unit_test(an_engine_that_cannot_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
