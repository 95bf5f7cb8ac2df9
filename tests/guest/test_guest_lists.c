/* Laws of what tracers from outside list and tell (ref/guest/): in both ways a list holds what rays
 * at single triangles give, whatever the room; bytes are those that the tracer counts, and what it
 * does not tell is 0, unknown. This program is the host. */
#define _GNU_SOURCE /* setenv */
#include "tests/guest/guest_scene.h"

#include "ref/trace/all_hits.h"

#define ROOM 6

static const struct engine_options options = {.threads = 1, .peer_ms = 20000, .peer_mb = 64};

static void *opened(const struct engine *engine)
{
    void *self;
    struct reason reason = {""};
    if (engine_open(engine, &options, &self, &reason))
        fail_msg("%s", reason.text);
    return self;
}

static enum status prepare(const struct engine *engine, void *self, const struct scene *of,
                           enum query query, struct reason *reason)
{
    const struct job job = {.scene = of, .tri = tri_test_find("mt"), .query = query};
    return engine->prepare(self, &job, reason);
}

/* What the sample answers to all rays at one triangle alone, the nearest hits. */
static void at_one_triangle(const struct engine *engine, void *self, uint32_t triangle,
                            struct hit hit[RAYS])
{
    struct scene one = scene;
    struct trace_report report;
    struct reason reason = {""};
    one.index = scene.index + 3 * (size_t)triangle;
    one.tri_count = 1;
    assert_int_equal(prepare(engine, self, &one, QUERY_CLOSEST, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, rays, RAYS, hit, &report, &reason), STATUS_OK);
}

/* Takes from each list the hit that its ray has on that triangle; returns how many were there. */
static size_t take_one(const struct all_hits *all, bool *seen, uint32_t triangle,
                       const struct hit one[RAYS])
{
    size_t count = 0;
    for (size_t i = 0; i < RAYS; i++) {
        bool listed = false;
        for (size_t k = all->first[i]; k < all->first[i + 1]; k++) {
            const struct hit *hit = &all->hit[k];
            if (hit->prim != triangle)
                continue;
            assert_false(listed || seen[k]);
            assert_true(hit->t == one[i].t && hit->u == one[i].u && hit->v == one[i].v);
            listed = seen[k] = true;
        }
        assert_int_equal(listed, one[i].prim != ABI_NO_PRIM);
        count += listed;
    }
    return count;
}

static void lists_hold_what_single_triangles_give(void **state)
{
    (void)state;
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_brute.so", inside);
        struct all_hits all = {.once = false};
        struct reason reason = {""};
        size_t total = 0;
        void *self = opened(engine);
        assert_true(engine_lists(engine, self));
        assert_int_equal(prepare(engine, self, &scene, QUERY_ALL, &reason), STATUS_OK);
        assert_int_equal(all_hits_next(engine, self, rays, RAYS, &all, &reason), STATUS_OK);
        assert_int_equal(all.done, RAYS);
        bool *seen = calloc(all.first[RAYS], sizeof *seen);
        for (uint32_t k = 0; k < scene.tri_count; k++) {
            struct hit one[RAYS];
            at_one_triangle(engine, self, k, one);
            total += take_one(&all, seen, k, one);
        }
        assert_int_equal(total, all.first[RAYS]);
        assert_true(total > RAYS);
        free(seen);
        all_hits_free(&all);
        engine->close(self);
    }
}

/* With less room than hits the numbers are full, and no more than the room is written. */
static void room_bounds_what_is_written(void **state)
{
    static const struct hit untouched = {7, 7, 7, 7777777};
    (void)state;
    behave("good");
    for (int inside = 0; inside < 2; inside++)
        for (uint32_t room = 0; room <= ROOM; room++) {
            const struct engine *engine = engine_way("guest_bad.so", inside);
            struct hit hit[3 * ROOM + 1];
            uint32_t count[3] = {0};
            struct reason reason = {""};
            void *self = opened(engine);
            for (size_t i = 0; i < ARRAY_COUNT(hit); i++)
                hit[i] = untouched;
            assert_int_equal(prepare(engine, self, &scene, QUERY_ALL, &reason), STATUS_OK);
            assert_int_equal(engine->trace_all(self, rays, 3, room, hit, count, &reason), 0);
            for (size_t i = 0; i < 3; i++) {
                assert_int_equal(count[i], scene.tri_count);
                for (uint32_t k = 0; k < room; k++) /* the guest lists them in their order */
                    assert_memory_equal(&hit[i * room + k], &((struct hit){1, 0, 0, k}),
                                        sizeof *hit);
            }
            assert_memory_equal(&hit[3 * (size_t)room], &untouched, sizeof untouched);
            engine->close(self);
        }
}

struct list_fate {
    const char *what;
    enum status status;
    enum engine_fault fault; /* in a process of its own; FINE: it is not played inside */
    const char *text;
};

static const struct list_fate fates[] = {
    {"all_misses", STATUS_DEVICE, ENGINE_NONSENSE, "its list of ray 0 has a miss as hit 0 of 128"},
    {"all_beyond", STATUS_DEVICE, ENGINE_NONSENSE, "its list of ray 0 names triangle 128 of 128"},
    {"all_thrice", STATUS_DEVICE, ENGINE_NONSENSE, "list of ray 0 has 384 hits on 128 triangles"},
    {"all_refuses", STATUS_REFUSED, ENGINE_NONSENSE, "guest_bad.so refused: lists are too long"},
    {"lazy", STATUS_DEVICE, ENGINE_FINE, "its list of ray 0 has 4278124286 hits"},
    {"crash", STATUS_DEVICE, ENGINE_FINE, "it was ended by signal 11 before the answer to ray 0"},
    {"complains", STATUS_DEVICE, ENGINE_FINE, "standard error: something is odd"},
};

static void whatever_a_list_is_is_told(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(fates); i++)
        for (int inside = 0; inside < (fates[i].fault == ENGINE_FINE ? 1 : 2); inside++) {
            const struct engine *engine = engine_way("guest_bad.so", inside);
            static struct hit hit[3 * 400];
            uint32_t count[3];
            struct reason reason = {""};
            size_t ray;
            behave(fates[i].what);
            void *self = opened(engine);
            assert_int_equal(prepare(engine, self, &scene, QUERY_ALL, &reason), STATUS_OK);
            enum status status = engine->trace_all(self, rays, 3, 400, hit, count, &reason);
            if (status != fates[i].status || !strstr(reason.text, fates[i].text))
                fail_msg("%s, %s: status %d, '%s'", fates[i].what, inside ? "inside" : "apart",
                         status, reason.text);
            if (fates[i].fault && !inside)
                assert_int_equal(engine->fault(self, &ray), fates[i].fault);
            if (!inside && status == STATUS_DEVICE) { /* the next request starts it again */
                behave("good");
                assert_int_equal(engine->trace_all(self, rays, 3, 400, hit, count, &reason), 0);
            }
            engine->close(self);
        }
}

static void one_without_lists_says_so(void **state)
{
    (void)state;
    behave("only_closest");
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_bad.so", inside);
        struct reason reason = {""};
        void *self = opened(engine);
        assert_false(engine_lists(engine, self));
        assert_int_equal(prepare(engine, self, &scene, QUERY_ALL, &reason), STATUS_UNSUPPORTED);
        assert_non_null(strstr(reason.text, "cannot list all hits: its `can` has no ALL"));
        engine->close(self);
    }
}

/* --- bytes ------------------------------------------------------------------------------------ */

static struct trace_report told(bool inside, const char *what, enum query query, size_t count)
{
    const struct engine *engine = engine_way("guest_bad.so", inside);
    struct hit hit[RAYS];
    struct trace_report report = {.node_bytes = 5, .scene_bytes = 5, .memory_bytes = 5};
    struct reason reason = {""};
    behave(what);
    void *self = opened(engine);
    assert_int_equal(prepare(engine, self, &scene, query, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, rays, count, hit, &report, &reason), STATUS_OK);
    engine->close(self);
    return report;
}

/* The guest counts its triangles, so that bytes are those of the scene that it has built. */
static void bytes_are_those_that_are_told(void **state)
{
    const uint64_t tree = 100 + (UINT64_C(1) << 40) + scene.tri_count;
    (void)state;
    for (int inside = 0; inside < 2; inside++) {
        for (size_t count = 0; count <= RAYS; count += RAYS) {
            const struct trace_report report = told(inside, "good", QUERY_CLOSEST, count);
            assert_true(report.node_bytes == tree);
            assert_int_equal(report.scene_bytes, 20);
            assert_true(report.memory_bytes == tree + 20 + 3);
        }
        assert_true(told(inside, "good", QUERY_ALL, 0).node_bytes == tree);
        for (int none = 0; none < 2; none++) {
            const struct trace_report report =
                told(inside, none ? "memory_none" : "memory_zero", QUERY_ANY, RAYS);
            assert_int_equal(report.node_bytes, 0);
            assert_int_equal(report.scene_bytes, 0);
            assert_int_equal(report.memory_bytes, 0);
        }
    }
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_hold_what_single_triangles_give),
        cmocka_unit_test(room_bounds_what_is_written),
        cmocka_unit_test(whatever_a_list_is_is_told),
        cmocka_unit_test(one_without_lists_says_so),
        cmocka_unit_test(bytes_are_those_that_are_told),
    };
    if (guest_host_is_meant(argc, argv))
        return guest_host_main(argv);
    find_folder(argv[0]);
    return cmocka_run_group_tests(tests, make_scene, free_scene);
}
