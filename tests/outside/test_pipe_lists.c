/* Laws of what engines "pipe:COMMAND" list and tell (ref/outside/pipe.h, flags 16 and 32): lists
 * arrive as they were sent, whatever the room; bytes arrive, too; a list that breaks the protocol
 * is told with its ray. The peers are this program, run as `test_pipe_lists --peer WHAT`. */
#define _GNU_SOURCE /* setenv */
#include "ref/trace/all_hits.h"
#include "tests/outside/peers.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/outside/peer_engine.h"

#define RAYS 200

#include "tests/outside/pipe_stand.h"

#define TREE UINT64_C(0x123456789ab)

static const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};

/* --- the peer --------------------------------------------------------------------------------- */

/* Writes the hits of a ray, each of a scene that is its triangle alone, and returns how many. */
static uint32_t peer_list(const struct peer_request *request, uint32_t ray, struct hit *hit)
{
    struct scene one = request->scene;
    uint32_t count = 0;
    one.tri_count = 1;
    for (uint32_t k = 0; k < request->scene.tri_count; k++) {
        one.index = request->scene.index + 3 * (size_t)k;
        trace_brute(&one, tri_test_find("mt"), QUERY_CLOSEST, &request->ray[ray], &hit[count]);
        if (hit[count].prim != ABI_NO_PRIM)
            hit[count++].prim = k;
    }
    return count;
}

/* What is wrong with a list; `hit` has room for three of each triangle. */
static uint32_t peer_spoil(const char *what, uint32_t triangles, uint32_t count, struct hit *hit)
{
    if (is(what, "misses"))
        hit[0] = (struct hit){.prim = ABI_NO_PRIM};
    if (is(what, "beyond"))
        hit[0].prim = triangles;
    if (is(what, "twice"))
        memcpy(hit + count, hit, count * sizeof *hit);
    return is(what, "twice") ? 2 * count : is(what, "many") ? 2 * triangles + 2 : count;
}

static void peer_lists(const char *what, const struct peer_request *request)
{
    const uint32_t asked = request->head.rays, capacity = request->head.zero;
    const size_t room = 3 * (size_t)request->scene.tri_count + 1;
    struct hit *hit = calloc(room * asked, sizeof *hit);
    uint32_t *count = calloc(asked, sizeof *count);
    for (uint32_t i = 0; hit && count && i < asked; i++) {
        count[i] = peer_list(request, i, hit + i * room);
        if (i == 3)
            count[i] = peer_spoil(what, request->scene.tri_count, count[i], hit + i * room);
    }
    if (is(what, "numberless")) {
        fwrite(count, sizeof *count, asked / 2, stdout);
        exit(5);
    }
    fwrite(count, sizeof *count, asked, stdout);
    for (uint32_t i = 0; i < asked; i++) {
        if (i == 17)
            peer_amid(what);
        fwrite(hit + i * room, sizeof *hit, count[i] < capacity ? count[i] : capacity, stdout);
    }
    free(hit);
    free(count);
}

static int lister_main(const char *what)
{
    static const uint32_t memory[] = {(uint32_t)TREE, (uint32_t)(TREE >> 32), 7, 0, 11, 1};
    struct peer_request request = {0};
    bool opening = true;
    while (peer_read(&request)) {
        struct pipe_answer head = peer_head(what, &request.head);
        head.flags = is(what, "without") ? 0 : is(what, "silent") ? 16 : 48;
        fwrite(&head, sizeof head, 1, stdout);
        if (!opening && (head.flags & 32))
            fwrite(memory, sizeof *memory, is(what, "forgetful") ? 3 : 6, stdout);
        if (!opening && is(what, "forgetful"))
            exit(6);
        if (request.head.query == 2)
            peer_lists(what, &request);
        else
            peer_hits(what, &request);
        peer_after(what, &request.head);
        opening = false;
    }
    free(request.ray);
    scene_free(&request.scene);
    return 0;
}

/* --- laws ------------------------------------------------------------------------------------- */

static const struct engine *open_peer(const char *what, enum query query, void **self,
                                      enum status *status, struct reason *reason)
{
    const struct engine *engine = peer_engine(what);
    const struct job job = job_of(query);
    assert_int_equal(engine_open(engine, &options, self, reason), STATUS_OK);
    *status = engine->prepare(*self, &job, reason);
    return engine;
}

/* Lists of engine brute, sorted. */
static void brute_lists(struct all_hits *out)
{
    const struct engine *brute = engine_find("brute");
    const struct engine_options one = {.threads = 1};
    const struct job job = job_of(QUERY_ALL);
    struct reason reason = {""};
    void *self;
    assert_int_equal(engine_open(brute, &one, &self, &reason), STATUS_OK);
    assert_int_equal(brute->prepare(self, &job, &reason), STATUS_OK);
    assert_int_equal(all_hits_next(brute, self, rays, RAYS, out, &reason), STATUS_OK);
    brute->close(self);
}

static void lists_arrive_as_they_were_sent(void **state)
{
    (void)state;
    struct all_hits want = {.once = false};
    struct reason reason = {""};
    enum status status;
    void *self;
    brute_lists(&want);
    assert_true(want.first[RAYS] > RAYS / 2);
    const struct engine *engine = open_peer("lists", QUERY_ALL, &self, &status, &reason);
    assert_int_equal(status, STATUS_OK);
    for (uint32_t room = 0; room < 4; room++) {
        static struct hit hit[3 * RAYS + 1];
        uint32_t count[RAYS];
        memset(hit, 0x77, sizeof hit);
        assert_int_equal(engine->trace_all(self, rays, RAYS, room, hit, count, &reason), 0);
        for (size_t i = 0; i < RAYS; i++) {
            const size_t number = want.first[i + 1] - want.first[i];
            assert_int_equal(count[i], number);
            for (size_t k = 0; k < number && k < room; k++) /* both go through the triangles */
                assert_memory_equal(&hit[i * room + k], &want.hit[want.first[i] + k], sizeof *hit);
        }
        assert_int_equal(hit[RAYS * (size_t)room].prim, 0x77777777);
    }
    engine->close(self);
    all_hits_free(&want);
    must_have_no_children();
}

static void bytes_arrive(void **state)
{
    static const struct {
        const char *what;
        enum query query;
        uint64_t tree, scene, all;
    } known[] = {{"lists", QUERY_CLOSEST, TREE, 7, TREE + 7 + 11 + (UINT64_C(1) << 32)},
                 {"lists", QUERY_ALL, TREE, 7, TREE + 7 + 11 + (UINT64_C(1) << 32)},
                 {"silent", QUERY_CLOSEST, 0, 0, 0}};
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        struct trace_report report = {.ns = 1};
        struct reason reason = {""};
        enum status status;
        void *self;
        const struct engine *engine =
            open_peer(known[i].what, known[i].query, &self, &status, &reason);
        assert_int_equal(status, STATUS_OK);
        assert_int_equal(engine->trace(self, rays, 0, NULL, &report, &reason), STATUS_OK);
        assert_true(report.node_bytes == known[i].tree && report.scene_bytes == known[i].scene);
        assert_true(report.memory_bytes == known[i].all && report.item_bytes == 0);
        engine->close(self);
    }
}

static const struct {
    const char *what;
    enum status status;
    size_t ray;
    const char *said;
} hostile[] = {
    {"misses", STATUS_DEVICE, 3, "its list of ray 3 has a miss as hit 0 of "},
    {"beyond", STATUS_DEVICE, 3, "its list of ray 3 names triangle 2048 of 2048"},
    {"many", STATUS_DEVICE, 3, "its list of ray 3 has 4098 hits on 2048 triangles"},
    {"twice", STATUS_OK, 0, ""},
    {"dies", STATUS_DEVICE, 17, "it was ended by signal 9 after the answer to ray "},
    {"numberless", STATUS_DEVICE, 0, "it ended with exit code 5 before the answer to ray 0"},
    {"long", STATUS_DEVICE, 200, "its answer is longer than 200 rays"},
    {"lists", STATUS_OK, 0, ""},
};

static void a_list_that_is_none_is_told_with_its_ray(void **state)
{
    static struct hit hit[RAYS * 5000];
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(hostile); i++) {
        struct reason reason = {""};
        uint32_t count[RAYS];
        enum status status;
        size_t ray = 0;
        void *self;
        const struct engine *engine =
            open_peer(hostile[i].what, QUERY_ALL, &self, &status, &reason);
        assert_int_equal(status, STATUS_OK);
        status = engine->trace_all(self, rays, RAYS, 5000, hit, count, &reason);
        if (status != hostile[i].status || !strstr(reason.text, hostile[i].said))
            fail_msg("%s: %s, '%s'", hostile[i].what, status_text(status), reason.text);
        if (status) {
            size_t want = hostile[i].ray;
            engine->fault(self, &ray);
            while (strcmp(hostile[i].what, "dies") == 0 && count[want - 1] == 0)
                want--; /* that it began to send an empty list is not seen */
            assert_int_equal(ray, want);
        }
        engine->close(self);
    }
}

static void peers_that_do_not_list_say_so(void **state)
{
    (void)state;
    struct reason reason = {""};
    enum status status;
    void *self;
    const struct engine *engine = open_peer("without", QUERY_ALL, &self, &status, &reason);
    assert_int_equal(status, STATUS_UNSUPPORTED);
    assert_non_null(strstr(reason.text, "cannot list all hits: its flags have no 16"));
    assert_false(engine_lists(engine, self));
    engine->close(self);
    engine = open_peer("forgetful", QUERY_CLOSEST, &self, &status, &reason);
    assert_int_equal(status, STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "it ended with exit code 6 at a request without rays"));
    engine->close(self);
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return lister_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_arrive_as_they_were_sent),
        cmocka_unit_test(bytes_arrive),
        cmocka_unit_test(a_list_that_is_none_is_told_with_its_ray),
        cmocka_unit_test(peers_that_do_not_list_say_so),
    };
    return cmocka_run_group_tests(tests, make_scene, free_scene);
}
