/* Laws of updates of tracers from outside: after a refit one that takes updates is given the moved
 * vertices and no scene; one that takes none, or that was ended, is given the scene anew; what it
 * answers is the same in both ways, and that of the moved scene. This program is the host, and with
 * --peer the peer (tests/outside/peers.h). */
#define _GNU_SOURCE              /* setenv */
#include "tests/outside/peers.h" /* first: it has a `scene` of its own */

#include "tests/guest/guest_scene.h"
#include "tests/outside/peer_engine.h"

static struct scene moved; /* as `scene`, with other vertices */

static struct job job_at(const struct scene *at)
{
    return (struct job){.scene = at, .tri = tri_test_find("mt")};
}

/* Builds, and refits so often, to one scene and the other in turn; the last status. */
static enum status follow(const struct engine *engine, void *self, uint32_t moves,
                          struct reason *reason)
{
    struct job job = job_at(moves % 2 ? &moved : &scene);
    enum status status = engine->prepare(self, &job, reason);
    for (uint32_t i = 0; i < moves && !status; i++) {
        job = job_at((moves - 1 - i) % 2 ? &moved : &scene);
        status = engine_follow(engine, self, &job, true, reason);
    }
    return status;
}

static void *opened(const struct engine *engine, const char *what)
{
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct reason reason = {""};
    void *self = NULL;
    behave(what);
    if (engine_open(engine, &options, &self, &reason))
        fail_msg("%s", reason.text);
    return self;
}

static void must_trace(const struct engine *engine, void *self, struct hit hit[RAYS])
{
    struct trace_report report;
    struct reason reason = {""};
    if (engine->trace(self, rays, RAYS, hit, &report, &reason))
        fail_msg("%s", reason.text);
}

/* The guest's hits have its first vertex, and how often it was moved since its scene came. */
static void a_guest_is_given_the_moved_vertices(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct hit hit[RAYS];
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_bad.so", inside);
        void *self = opened(engine, "move");
        assert_true(engine_moves(engine, self));
        for (uint32_t moves = 0; moves < 4; moves++) {
            assert_int_equal(follow(engine, self, moves, &reason), STATUS_OK);
            must_trace(engine, self, hit);
            for (uint32_t i = 0; i < RAYS; i++) {
                const uint32_t triangle = i % scene.tri_count;
                if (i % 3 == 1)
                    continue;
                assert_int_equal(hit[i].prim, triangle);
                assert_true(hit[i].v == (float)moves);
                assert_true(hit[i].t ==
                            scene.vertex[3 * scene.index[3 * triangle]] + rays[i].org[0]);
            }
        }
        engine->close(self);
    }
}

static void one_that_takes_no_updates_is_built_anew(void **state)
{
    (void)state;
    static const char *const ways[] = {"good", "old"};
    struct reason reason = {""};
    struct hit hit[RAYS];
    for (int inside = 0; inside < 2; inside++)
        for (size_t i = 0; i < ARRAY_COUNT(ways); i++) {
            const struct engine *engine = engine_way("guest_bad.so", inside);
            void *self = opened(engine, ways[i]);
            assert_false(engine_moves(engine, self));
            assert_int_equal(follow(engine, self, 3, &reason), STATUS_OK);
            must_trace(engine, self, hit);
            assert_true(hit[0].t == scene.vertex[3 * scene.index[0]] + rays[0].org[0]);
            engine->close(self);
        }
}

/* What it does in an update is told, and the next scene is a whole one. */
static void a_failed_update_leaves_nothing_behind(void **state)
{
    (void)state;
    static const struct {
        const char *what, *text;
        enum status status;
        bool apart; /* only there */
    } known[] = {{"move_refuses", "refused: too far", STATUS_REFUSED, false},
                 {"move_fails", "move() failed: without a reason", STATUS_DEVICE, false},
                 {"move_crash", "it was ended by signal 6", STATUS_DEVICE, true}};
    struct hit hit[RAYS];
    for (int inside = 0; inside < 2; inside++)
        for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
            struct reason reason = {""};
            if (inside && known[i].apart)
                continue;
            const struct engine *engine = engine_way("guest_bad.so", inside);
            void *self = opened(engine, known[i].what);
            assert_int_equal(follow(engine, self, 1, &reason), known[i].status);
            if (!strstr(reason.text, known[i].text))
                fail_msg("%s: %s", known[i].what, reason.text);
            assert_int_equal(follow(engine, self, 0, &reason), STATUS_OK);
            must_trace(engine, self, hit);
            assert_true(hit[0].v == 0);
            engine->close(self);
        }
}

/* --- pipes ------------------------------------------------------------------------------------ */

static void a_peer_with_flag_64_is_sent_vertices(void **state)
{
    (void)state;
    static const char *const ways[] = {"moves", "honest"};
    struct reason reason = {""};
    struct hit hit[RAYS], own;
    for (size_t i = 0; i < ARRAY_COUNT(ways); i++) {
        const struct engine *engine = peer_engine(ways[i]);
        void *self = opened(engine, "good");
        assert_int_equal(engine_moves(engine, self), i == 0);
        for (uint32_t moves = 0; moves < 3; moves++) {
            assert_int_equal(follow(engine, self, moves, &reason), STATUS_OK);
            must_trace(engine, self, hit);
            for (uint32_t k = 0; k < RAYS; k++) {
                trace_brute(&scene, tri_test_find("mt"), QUERY_CLOSEST, &rays[k], &own);
                assert_memory_equal(&own, &hit[k], sizeof own);
            }
        }
        engine->close(self);
    }
}

static void a_peer_is_sent_each_update_once(void **state)
{
    (void)state;
    struct reason reason = {""};
    struct hit hit[RAYS];
    const struct engine *engine = peer_engine("moves_told");
    void *self = opened(engine, "good");
    for (uint32_t moves = 0; moves < 4; moves++) {
        assert_int_equal(follow(engine, self, moves, &reason), STATUS_OK);
        for (int again = 0; again < 2; again++) {
            must_trace(engine, self, hit);
            assert_true(hit[0].t == (float)moves);
        }
    }
    engine->close(self);
}

/* It refuses the update or dies of it; then it has no scene, and is sent all of it. */
static void a_peer_that_lost_its_scene_is_sent_all_of_it(void **state)
{
    (void)state;
    static const struct {
        const char *what, *text;
        enum status status;
    } known[] = {{"moves_refuses", "refused: only teapots", STATUS_REFUSED},
                 {"moves_dies", "it ended with exit code 4", STATUS_DEVICE}};
    struct hit hit[RAYS], own;
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        struct reason reason = {""};
        const struct engine *engine = peer_engine(known[i].what);
        void *self = opened(engine, "good");
        assert_int_equal(follow(engine, self, 1, &reason), known[i].status);
        assert_non_null(strstr(reason.text, known[i].text));
        must_trace(engine, self, hit); /* the scene that it was to be moved to */
        trace_brute(&scene, tri_test_find("mt"), QUERY_CLOSEST, &rays[0], &own);
        assert_memory_equal(&own, &hit[0], sizeof own);
        engine->close(self);
    }
}

static int make_both(void **state)
{
    if (make_scene(state) || scene_make(scene.vertex_count, scene.tri_count, &moved))
        return -1;
    memcpy(moved.index, scene.index, 3 * sizeof *scene.index * scene.tri_count);
    for (uint32_t i = 0; i < scene.vertex_count; i++) {
        moved.vertex[3 * i] = -scene.vertex[3 * i + 1];
        moved.vertex[3 * i + 1] = 0.5f * scene.vertex[3 * i];
        moved.vertex[3 * i + 2] = scene.vertex[3 * i + 2] + 3;
    }
    return 0;
}

static int free_both(void **state)
{
    scene_free(&moved);
    return free_scene(state);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_guest_is_given_the_moved_vertices),
        cmocka_unit_test(one_that_takes_no_updates_is_built_anew),
        cmocka_unit_test(a_failed_update_leaves_nothing_behind),
        cmocka_unit_test(a_peer_with_flag_64_is_sent_vertices),
        cmocka_unit_test(a_peer_is_sent_each_update_once),
        cmocka_unit_test(a_peer_that_lost_its_scene_is_sent_all_of_it),
    };
    program = argv[0];
    if (guest_host_is_meant(argc, argv))
        return guest_host_main(argv);
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return peer_main(argv[2]);
    find_folder(argv[0]);
    return cmocka_run_group_tests(tests, make_both, free_both);
}
