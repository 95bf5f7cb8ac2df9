/* Engines of the processor on one world: however many rays there are and however many threads take
 * them, with modes or without, each is answered in its place, nothing is written behind the last,
 * and what is reported is the sum of what single rays take. */
#include "ref/engine.h"
#include "ref/store.h"
#include "ref/trace/trace_world.h"
#include "ref/two_level/world_check.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/two_level/braid_stand.h"

#define RAYS  200u
#define ROOM  3u
#define TIMES 300u

static const uint32_t counts[] = {0, 1, 2, 63, 64, 65, 129, 193, RAYS};
static const char *const names[] = {"brute", "cpu", "fast"};
static const unsigned threads[] = {1, 3};

static struct world world;
static struct packed_world packed, braided;
static struct ray ray[RAYS];
static struct ray_mode modes[RAYS];

static int make(void **state)
{
    (void)state;
    world = fixture_everything();
    packed = stand_world(&world, "f32");
    braided = braid_world(&world, "median", "f32", 4);
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = stand_aim(&packed, 1, i);
        modes[i] = (struct ray_mode){i % 7 ? 0xFF : i, i % 3 ? 0 : ABI_RAY_CULL_BACK};
        modes[i].flags |= i % 4 == 1 ? ABI_RAY_FIRST : 0;
    }
    return braided.entry_count > packed.entry_count ? 0 : 1;
}

static int drop(void **state)
{
    (void)state;
    packed_world_free(&braided);
    packed_world_free(&packed);
    world_free(&world);
    return 0;
}

static void *prepared(const struct engine *engine, unsigned count, const struct packed_world *of,
                      enum query query)
{
    const struct engine_options options = {.threads = count, .device = -1};
    const struct world_job job = stand_job(&world, engine->needs_packed ? of : NULL, query);
    struct reason reason = {""};
    void *self = NULL;
    if (engine_open(engine, &options, &self, &reason) ||
        engine->worlds->prepare_world(self, &job, &reason))
        fail_msg("%s: %s", engine->name, reason.text);
    return self;
}

static struct ray_mode mode_of(bool with, uint32_t i)
{
    return with ? modes[i] : ray_mode_all();
}

/* What one ray must get. Engine fast has an order of its own: alone. */
static struct tagged one_ray(const struct engine *engine, void *self, enum query query, uint32_t i,
                             struct ray_mode mode, struct trace_counts *work)
{
    const struct world_job job = stand_job(&world, &packed, query);
    struct tagged out;
    if (engine->brute) {
        trace_world_brute(&world, packed.record, job.tri, query, &ray[i], mode, &out.hit, &out.tag);
        work->tris += world_tri_count(&world);
    } else if (!engine->own_tree) {
        assert_int_equal(trace_world_ray(&job, &ray[i], mode, &out.hit, &out.tag, work), STATUS_OK);
    } else {
        struct trace_report report;
        assert_int_equal(
            engine->worlds->trace_world(self, &ray[i], &mode, 1, &out.hit, &out.tag, &report, NULL),
            STATUS_OK);
    }
    return out;
}

struct answered {
    struct hit hit[RAYS + 1];
    uint32_t tag[RAYS + 1];
};

/* Bytes that are read; those of engine fast are known to itself. */
static uint64_t bytes_of(const struct engine *engine)
{
    uint64_t bytes =
        engine->brute ? 24 * sizeof(struct instance_record) : packed_world_bytes(&packed);
    for (uint32_t i = 0; i < world.mesh_count; i++)
        bytes += 12 * (uint64_t)world.mesh[i].scene->vertex_count +
                 12 * (uint64_t)world.mesh[i].scene->tri_count;
    return bytes;
}

static void expect_rays(const struct engine *engine, enum query query, bool with)
{
    static struct answered want, got;
    struct trace_counts work[RAYS + 1] = {{0, 0}};
    uint32_t hits = 0;
    void *alone = prepared(engine, 1, &packed, query);
    for (uint32_t i = 0; i < RAYS; i++) {
        work[i + 1] = work[i];
        struct tagged one = one_ray(engine, alone, query, i, mode_of(with, i), &work[i + 1]);
        want.hit[i] = one.hit;
        want.tag[i] = one.tag;
        hits += one.hit.prim != ABI_NO_PRIM;
    }
    engine->close(alone);
    assert_true(hits > RAYS / 4 && hits < RAYS);
    for (size_t t = 0; t < ARRAY_COUNT(threads); t++) {
        void *self = prepared(engine, threads[t], &packed, query);
        for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
            const uint32_t rays = counts[c];
            struct trace_report report;
            memset(&got, 0x5A, sizeof got);
            assert_int_equal(engine->worlds->trace_world(self, ray, with ? modes : NULL, rays,
                                                         got.hit, got.tag, &report, NULL),
                             STATUS_OK);
            assert_memory_equal(got.hit, want.hit, rays * sizeof *got.hit);
            assert_memory_equal(got.tag, want.tag, rays * sizeof *got.tag);
            assert_true(got.hit[rays].prim == 0x5A5A5A5A && got.tag[rays] == 0x5A5A5A5A);
            assert_int_equal(report.boxes, work[rays].boxes);
            assert_int_equal(report.tris, work[rays].tris);
            if (!engine->own_tree)
                assert_int_equal(report.memory_bytes, bytes_of(engine));
        }
        engine->close(self);
    }
}

static void every_ray_is_answered_in_its_place(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
            for (int with = 0; with < 2; with++)
                expect_rays(engine_find(names[e]), (enum query)query, with);
}

static void any_ends_at_the_first_that_is_found(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        static struct answered got[2];
        uint32_t farther = 0;
        for (int any = 0; any < 2; any++) {
            void *self = prepared(engine, 1, &packed, any ? QUERY_ANY : QUERY_CLOSEST);
            struct trace_report report;
            assert_int_equal(engine->worlds->trace_world(self, ray, NULL, RAYS, got[any].hit,
                                                         got[any].tag, &report, NULL),
                             STATUS_OK);
            engine->close(self);
        }
        for (uint32_t i = 0; i < RAYS; i++)
            farther += got[0].hit[i].prim != ABI_NO_PRIM && got[1].hit[i].t > got[0].hit[i].t;
        assert_true(farther > 5);
    }
}

/* A list is the same for each ray alone, and has as many as brute lists. */
static void lists_are_in_their_place(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (uint32_t n = 0; n < 2 * 2 * (ROOM + 1); n++) {
            const struct engine *engine = engine_find(names[e]);
            const struct world_job job = stand_job(&world, &packed, QUERY_ALL);
            const uint32_t room = n / 4;
            const bool with = n & 1;
            static struct hit want[RAYS * ROOM], got[(RAYS + 1) * ROOM + 1];
            static uint32_t want_tag[RAYS * ROOM], tag[(RAYS + 1) * ROOM + 1];
            uint32_t count[RAYS], found[RAYS + 1], over = 0;
            void *self = prepared(engine, threads[n / 2 % 2], &packed, QUERY_ALL);
            memset(want, 0x5A, sizeof want);
            memset(want_tag, 0x5A, sizeof want_tag);
            for (uint32_t i = 0; i < RAYS; i++) {
                const struct ray_mode mode = mode_of(with, i);
                assert_int_equal(
                    engine->worlds->trace_world_all(self, &ray[i], &mode, 1, room, &want[i * room],
                                                    &want_tag[i * room], &count[i], NULL),
                    STATUS_OK);
                if (!engine->own_tri) /* another test of triangles */
                    assert_int_equal(count[i], trace_world_brute_all(&world, packed.record, job.tri,
                                                                     &ray[i], mode, 0, NULL, NULL));
                over += count[i] > room;
            }
            assert_true(over > 10);
            for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
                const uint32_t rays = counts[c];
                memset(got, 0x5A, sizeof got);
                memset(tag, 0x5A, sizeof tag);
                memset(found, 0x5A, sizeof found);
                assert_int_equal(engine->worlds->trace_world_all(self, ray, with ? modes : NULL,
                                                                 rays, room, room ? got : NULL,
                                                                 room ? tag : NULL, found, NULL),
                                 STATUS_OK);
                assert_memory_equal(found, count, rays * sizeof *found);
                assert_memory_equal(got, want, (size_t)rays * room * sizeof *got);
                assert_memory_equal(tag, want_tag, (size_t)rays * room * sizeof *tag);
                assert_true(found[rays] == 0x5A5A5A5A && tag[rays * room] == 0x5A5A5A5A);
            }
            engine->close(self);
        }
}

/* A stack of the top or of a mesh that is too short: how many rays, of how many, and the last. */
static void rays_that_are_not_finished_are_counted(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("cpu");
    for (size_t t = 0; t < ARRAY_COUNT(threads); t++)
        for (size_t c = 0; c < ARRAY_COUNT(counts); c++)
            for (uint32_t n = 0; n < 8; n++) {
                const enum query query = n & 1 ? QUERY_ALL : QUERY_CLOSEST;
                struct packed *level = n & 2 ? &packed.top : &packed.bottom[0];
                const uint32_t need = level->stack_need;
                struct reason reason = {""};
                struct trace_report report;
                static struct answered got;
                uint32_t found[RAYS], unfinished = 0, last = 0;
                char text[200] = "";
                level->stack_need = n & 4 ? 1 : need - 1;
                const struct world_job job = stand_job(&world, &packed, query);
                void *self = prepared(engine, threads[t], &packed, query);
                for (uint32_t i = 0; i < counts[c]; i++) {
                    struct tagged one;
                    enum status ended =
                        query == QUERY_ALL
                            ? trace_world_ray_all(&job, &ray[i], modes[i], 0, NULL, NULL, &found[i],
                                                  NULL)
                            : trace_world_ray(&job, &ray[i], modes[i], &one.hit, &one.tag, NULL);
                    unfinished += ended != STATUS_OK;
                    last = ended ? i : last;
                }
                enum status status =
                    query == QUERY_ALL
                        ? engine->worlds->trace_world_all(self, ray, modes, counts[c], 0, NULL,
                                                          NULL, found, &reason)
                        : engine->worlds->trace_world(self, ray, modes, counts[c], got.hit, got.tag,
                                                      &report, &reason);
                if (unfinished)
                    snprintf(text, sizeof text,
                             "%u of %u rays not finished: stack or nodes of a level exhausted, "
                             "last ray %u",
                             unfinished, counts[c], last);
                assert_int_equal(status, unfinished ? STATUS_DEVICE : STATUS_OK);
                assert_string_equal(reason.text, text);
                assert_true(unfinished > 0 || counts[c] < 31 || !(n & 4));
                engine->close(self);
                level->stack_need = need;
            }
}

/* Threads add up what each of them took, and lose none of it: the same rays over and over take as
 * often as much. On a stack that is too short, as often as many are not finished. */
static void threads_lose_nothing_of_their_sums(void **state)
{
    (void)state;
    static struct ray many[TIMES * RAYS];
    static struct hit hit[TIMES * RAYS];
    static uint32_t tag[TIMES * RAYS];
    const uint32_t need = packed.top.stack_need;
    for (uint32_t i = 0; i < TIMES * RAYS; i++)
        many[i] = ray[i % RAYS];
    for (uint32_t n = 0; n < 12; n++) {
        const struct engine *engine = engine_find("cpu");
        const bool poor = n & 1;
        struct trace_report one, all;
        struct reason reason[2] = {{""}, {""}};
        unsigned long long unfinished[2] = {0, 0};
        packed.top.stack_need = poor ? 1 : need;
        void *alone = prepared(engine, 1, &packed, QUERY_CLOSEST);
        void *team = prepared(engine, 4, &packed, QUERY_CLOSEST);
        enum status status =
            engine->worlds->trace_world(alone, ray, NULL, RAYS, hit, tag, &one, &reason[0]);
        assert_int_equal(status, poor ? STATUS_DEVICE : STATUS_OK);
        assert_int_equal(status, engine->worlds->trace_world(team, many, NULL, TIMES * RAYS, hit,
                                                             tag, &all, &reason[1]));
        assert_int_equal(all.tris, TIMES * one.tris);
        assert_int_equal(all.boxes, TIMES * one.boxes);
        for (int i = 0; i < 2 && poor; i++)
            assert_int_equal(sscanf(reason[i].text, "%llu of", &unfinished[i]), 1);
        assert_int_equal(unfinished[1], TIMES * unfinished[0]);
        engine->close(alone);
        engine->close(team);
    }
    packed.top.stack_need = need;
}

/* The storage of every mesh must suit the triangle test. */
static void each_mesh_is_stored_for_the_test(void **state)
{
    (void)state;
    const struct engine *engine = engine_find("cpu");
    struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
    void *self = prepared(engine, 1, &packed, QUERY_CLOSEST);
    job.tri = tri_test_find("woop");
    assert_true(packed.mesh_count == 2);
    for (uint32_t i = 0; i < packed.mesh_count; i++) {
        const struct tri_store *store = packed.bottom[i].store;
        struct reason reason = {""};
        assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
        packed.bottom[i].store = tri_store_find("edges");
        assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_UNSUPPORTED);
        assert_non_null(strstr(reason.text, "woop"));
        packed.bottom[i].store = store;
    }
    engine->close(self);
}

/* --- fast ------------------------------------------------------------------------------------- */

static uint64_t fast_told(const struct packed_world *of, struct answered *got)
{
    const struct engine *engine = engine_find("fast");
    void *self = prepared(engine, 1, of, QUERY_CLOSEST);
    struct trace_report report;
    assert_int_equal(
        engine->worlds->trace_world(self, ray, modes, RAYS, got->hit, got->tag, &report, NULL),
        STATUS_OK);
    engine->close(self);
    return report.memory_bytes;
}

/* Its top is that of the packed world, as long as that has whole instances; else it is built. The
 * nearest hits are the same. */
static void fast_takes_the_top_of_the_world(void **state)
{
    (void)state;
    static struct answered whole, flat, parts;
    struct world_trees trees = stand_trees(&world, "median", 15);
    struct packed_world wide = stand_packed(&world, &trees, "f32", "f32");
    struct packed_world again = stand_world(&world, "f32");
    const uint64_t bytes = fast_told(&packed, &whole);
    assert_int_equal(fast_told(&again, &flat), bytes);
    assert_memory_equal(&flat, &whole, sizeof flat);
    /* The bottoms are those of `packed`, so that only the top differs. */
    struct packed top = again.top;
    again.top = wide.top;
    assert_true(fast_told(&again, &flat) != bytes);
    again.top = top;
    fast_told(&braided, &parts);
    for (uint32_t i = 0; i < RAYS; i++) { /* a first hit is any of them */
        const bool hit = whole.hit[i].prim != ABI_NO_PRIM;
        assert_int_equal(parts.hit[i].prim != ABI_NO_PRIM, hit);
        if (hit && !(modes[i].flags & ABI_RAY_FIRST))
            assert_true(parts.hit[i].t == whole.hit[i].t);
    }
    packed_world_free(&again);
    packed_world_free(&wide);
    world_trees_free(&trees);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_is_answered_in_its_place),
        cmocka_unit_test(any_ends_at_the_first_that_is_found),
        cmocka_unit_test(lists_are_in_their_place),
        cmocka_unit_test(rays_that_are_not_finished_are_counted),
        cmocka_unit_test(threads_lose_nothing_of_their_sums),
        cmocka_unit_test(each_mesh_is_stored_for_the_test),
        cmocka_unit_test(fast_takes_the_top_of_the_world),
    };
    return cmocka_run_group_tests_name("world_engine_rays", tests, make, drop);
}
