/* Engines of the processor on one scene: however many rays there are and however many threads take
 * them, each is answered in its place, nothing is written behind the last, and what is reported is
 * the sum of what single rays take. */
#include "ref/engine.h"
#include "ref/packed/packed_walk.h"
#include "ref/trace/trace.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include <stdio.h>

#include "tests/support/built.h"

#define RAYS  200u
#define ROOM  2u
#define TIMES 300u

static const uint32_t counts[] = {0,  1,  2,  3,  15,  16,  17,  31,  32,  33,
                                  63, 64, 65, 66, 127, 128, 129, 130, 193, RAYS};
static const char *const names[] = {"brute",      "cpu", "cpu_stackless", "fast",
                                    "fast_small", "kd",  "dual_split"};
static const unsigned threads[] = {1, 3};

static struct scene scene;
static struct bvh bvh;
static struct packed packed;
static uint32_t *links;
static struct ray ray[RAYS];

static int make(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    struct rng rng = rng_make(1, 2);
    scene = built_soup(400, 1);
    for (size_t prim = 0; prim < scene.tri_count; prim++) { /* dense: rays hit several */
        float *v = scene.vertex + 9 * prim, from[3] = {v[0], v[1], v[2]};
        for (int c = 0; c < 9; c++)
            v[c] -= 0.85f * from[c % 3];
    }
    if (bvh_build(builder_find("median"), &scene, &options, &bvh, NULL) ||
        packed_make(layout_find("f32"), &bvh, &scene, &packed, NULL) ||
        packed_links(&packed, &links, NULL))
        return 1;
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = (struct ray){.tmax = i % 5 ? INFINITY : 0.5f};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = rng_range(&rng, -2, 2);
            ray[i].dir[k] = rng_range(&rng, -1, 1) - ray[i].org[k];
        }
    }
    return 0;
}

static int drop(void **state)
{
    (void)state;
    free(links);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    return 0;
}

static struct job job_of(const struct scene *of, const struct packed *tree, enum query query)
{
    return (struct job){.scene = of,
                        .packed = tree,
                        .box = box_test_find("watertight"),
                        .tri = tri_test_find("woop"),
                        .query = query};
}

static void *opened(const struct engine *engine, unsigned count)
{
    const struct engine_options options = {.threads = count, .device = -1};
    struct reason reason = {""};
    void *self = NULL;
    if (engine_open(engine, &options, &self, &reason))
        fail_msg("%s: %s", engine->name, reason.text);
    return self;
}

static void *prepared(const struct engine *engine, unsigned count, const struct job *job)
{
    void *self = opened(engine, count);
    struct reason reason = {""};
    if (engine->prepare(self, job, &reason))
        fail_msg("%s: %s", engine->name, reason.text);
    return self;
}

/* What cpu and brute hold: three floats a vertex, three numbers a triangle, and the packed tree. */
static uint64_t bytes_of(const struct job *job)
{
    uint64_t bytes = 4 * 3 * (uint64_t)job->scene->vertex_count;
    bytes += 4 * 3 * (uint64_t)job->scene->tri_count;
    return job->packed ? bytes + packed_node_bytes(job->packed) + packed_item_bytes(job->packed)
                       : bytes;
}

/* Of the scene, what an engine with a tree of its own but no triangles holds. */
static uint64_t scene_of(const struct engine *engine, const struct job *job)
{
    const bool reads = engine->own_tree && !engine->own_tri;
    return reads ? 12 * ((uint64_t)job->scene->vertex_count + job->scene->tri_count) : 0;
}

/* What one ray must get. Engines with a tree of their own have an order of their own: alone. */
static struct hit one_ray(const struct engine *engine, const struct job *job, uint32_t i,
                          struct trace_counts *work)
{
    struct hit hit;
    struct job linked = *job;
    if (engine->brute) {
        trace_brute(job->scene, job->tri, job->query, &ray[i], &hit);
        work->tris += job->scene->tri_count;
    } else if (!engine->own_tree) {
        linked.parent = engine->binary ? links : NULL;
        assert_int_equal(trace_ray(&linked, &ray[i], &hit, work), STATUS_OK);
    } else {
        struct trace_report report;
        void *self = prepared(engine, 1, job);
        assert_int_equal(engine->trace(self, &ray[i], 1, &hit, &report, NULL), STATUS_OK);
        work->boxes += report.boxes;
        work->tris += report.tris;
        engine->close(self);
    }
    return hit;
}

static void every_ray_is_answered_in_its_place(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            const struct engine *engine = engine_find(names[e]);
            const struct job job = job_of(&scene, &packed, (enum query)query);
            struct hit want[RAYS], got[RAYS + 1], behind;
            struct trace_counts work[RAYS + 1] = {{0, 0}};
            uint32_t hits = 0;
            for (uint32_t i = 0; i < RAYS; i++) {
                work[i + 1] = work[i];
                want[i] = one_ray(engine, &job, i, &work[i + 1]);
                hits += want[i].prim != ABI_NO_PRIM;
            }
            assert_true(hits > RAYS / 4 && hits < RAYS);
            memset(&behind, 0x5A, sizeof behind);
            for (size_t t = 0; t < ARRAY_COUNT(threads); t++) {
                void *self = prepared(engine, threads[t], &job);
                for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
                    struct trace_report report;
                    memset(got, 0x5A, sizeof got);
                    assert_int_equal(engine->trace(self, ray, counts[c], got, &report, NULL),
                                     STATUS_OK);
                    assert_memory_equal(got, want, counts[c] * sizeof *got);
                    assert_memory_equal(&got[counts[c]], &behind, sizeof behind);
                    assert_int_equal(report.boxes, work[counts[c]].boxes);
                    assert_int_equal(report.tris, work[counts[c]].tris);
                    if (strcmp(names[e], "cpu") == 0 || strcmp(names[e], "brute") == 0)
                        assert_int_equal(report.memory_bytes, bytes_of(&job));
                    assert_int_equal(report.node_bytes > 0, engine->own_tree);
                    assert_int_equal(report.node_bytes + report.item_bytes + scene_of(engine, &job),
                                     engine->own_tree ? report.memory_bytes : 0);
                }
                engine->close(self);
            }
        }
}

/* Nearest hits and any hits are different answers of the same engine. */
static void any_ends_at_the_first_that_is_found(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++) {
        const struct engine *engine = engine_find(names[e]);
        struct hit hit[2][RAYS];
        uint32_t farther = 0;
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            const struct job job = job_of(&scene, &packed, (enum query)query);
            void *self = prepared(engine, 1, &job);
            struct trace_report report;
            assert_int_equal(engine->trace(self, ray, RAYS, hit[query == QUERY_ANY], &report, NULL),
                             STATUS_OK);
            engine->close(self);
        }
        for (uint32_t i = 0; i < RAYS; i++) {
            assert_int_equal(hit[0][i].prim == ABI_NO_PRIM, hit[1][i].prim == ABI_NO_PRIM);
            farther += hit[0][i].prim != ABI_NO_PRIM && hit[1][i].t > hit[0][i].t;
        }
        /* Leaves of kd are small, and dual_split goes front to back. */
        bool few = strcmp(names[e], "kd") == 0 || strcmp(names[e], "dual_split") == 0;
        assert_true(farther > (few ? 0 : 5));
    }
}

static void lists_are_in_their_place(void **state)
{
    (void)state;
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (size_t t = 0; t < ARRAY_COUNT(threads); t++)
            for (uint32_t room = 0; room <= ROOM; room++) {
                const struct engine *engine = engine_find(names[e]);
                const struct job job = job_of(&scene, &packed, QUERY_ALL);
                void *self = prepared(engine, threads[t], &job);
                struct hit want[RAYS * ROOM], got[(RAYS + 1) * ROOM + 1];
                uint32_t count[RAYS], found[RAYS + 1], over = 0;
                memset(want, 0x5A, sizeof want);
                for (uint32_t i = 0; i < RAYS; i++) {
                    assert_int_equal(
                        engine->trace_all(self, &ray[i], 1, room, &want[i * room], &count[i], NULL),
                        STATUS_OK);
                    assert_int_equal(count[i], trace_brute_all(&scene, job.tri, &ray[i], 0, NULL));
                    over += count[i] > room;
                }
                assert_true(over > 10);
                for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
                    const uint32_t rays = counts[c];
                    memset(got, 0x5A, sizeof got);
                    memset(found, 0x5A, sizeof found);
                    assert_int_equal(
                        engine->trace_all(self, ray, rays, room, room ? got : NULL, found, NULL),
                        STATUS_OK);
                    assert_memory_equal(found, count, rays * sizeof *found);
                    assert_memory_equal(got, want, (size_t)rays * room * sizeof *got);
                    assert_int_equal(found[rays], 0x5A5A5A5A);
                    assert_int_equal(got[rays * room].prim, 0x5A5A5A5A);
                }
                engine->close(self);
            }
}

static void an_empty_scene_is_missed_by_all(void **state)
{
    (void)state;
    struct scene empty = {0};
    struct bvh none;
    struct packed nothing;
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    assert_int_equal(bvh_build(builder_find("median"), &empty, &options, &none, NULL), STATUS_OK);
    assert_int_equal(packed_make(layout_find("f32"), &none, &empty, &nothing, NULL), STATUS_OK);
    for (size_t e = 0; e < ARRAY_COUNT(names); e++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++)
            for (size_t c = 0; c < ARRAY_COUNT(counts); c++) {
                const struct engine *engine = engine_find(names[e]);
                const struct job full = job_of(&scene, &packed, (enum query)query);
                const struct job job = job_of(&empty, &nothing, (enum query)query);
                const struct hit miss = {.prim = ABI_NO_PRIM};
                struct hit got[RAYS];
                uint32_t found[RAYS];
                struct trace_report report;
                void *self = prepared(engine, 1, &full);
                assert_int_equal(engine->prepare(self, &job, NULL), STATUS_OK);
                memset(got, 0x5A, sizeof got);
                memset(found, 0x5A, sizeof found);
                enum status status =
                    query == QUERY_ALL
                        ? engine->trace_all(self, ray, counts[c], 1, got, found, NULL)
                        : engine->trace(self, ray, counts[c], got, &report, NULL);
                assert_int_equal(status, STATUS_OK);
                for (uint32_t i = 0; i < counts[c]; i++)
                    if (query == QUERY_ALL)
                        assert_int_equal(found[i], 0);
                    else
                        assert_memory_equal(&got[i], &miss, sizeof miss);
                engine->close(self);
            }
    packed_free(&nothing);
    bvh_free(&none);
}

/* Returns how many rays are not. */
static uint32_t expect_unfinished(const struct engine *engine, enum query query, unsigned team_size,
                                  uint32_t rays, struct packed *poor)
{
    const struct packed whole = *poor;
    struct reason reason = {""};
    struct trace_report report;
    struct hit hit[RAYS];
    uint32_t found[RAYS], unfinished = 0, last = 0;
    char text[200] = "";
    struct job job = job_of(&scene, poor, query);
    *poor = packed; /* the tree is whole when it is prepared */
    void *self = prepared(engine, team_size, &job);
    *poor = whole;
    job.parent = engine->binary ? links : NULL;
    for (uint32_t i = 0; i < rays; i++) {
        enum status ended = query == QUERY_ALL
                                ? trace_ray_all(&job, &ray[i], 0, NULL, &found[i], NULL)
                                : trace_ray(&job, &ray[i], &hit[i], NULL);
        unfinished += ended != STATUS_OK;
        last = ended ? i : last;
    }
    enum status status = query == QUERY_ALL
                             ? engine->trace_all(self, ray, rays, 0, NULL, found, &reason)
                             : engine->trace(self, ray, rays, hit, &report, &reason);
    if (unfinished)
        snprintf(text, sizeof text,
                 "%u of %u rays not finished: stack of %u or %u nodes exhausted, last ray %u",
                 unfinished, rays, poor->stack_need, packed.node_count, last);
    assert_int_equal(status, unfinished ? STATUS_DEVICE : STATUS_OK);
    assert_string_equal(reason.text, text);
    engine->close(self);
    return unfinished;
}

/* Words of the tree in which an inner node, the so manieth, is its own child. */
static uint32_t *cyclic_words(uint32_t number)
{
    uint32_t *word = calloc(packed.word_count, sizeof *word);
    struct node_f32 node;
    assert_non_null(word);
    memcpy(word, packed.word, packed.word_count * sizeof *word);
    for (uint32_t i = 1; i < packed.node_count; i++) {
        memcpy(&node, word + 8 * (size_t)i, sizeof node);
        if (node.count > 0 || number-- > 0)
            continue;
        node.first = i;
        memcpy(word + 8 * (size_t)i, &node, sizeof node);
        return word;
    }
    fail_msg("no inner node");
    return word;
}

/* A stack that is too short, or a tree that is none: how many rays are not finished, of how many,
 * and the last of them. */
static void rays_that_are_not_finished_are_counted(void **state)
{
    (void)state;
    uint32_t without_stack = 0;
    for (uint32_t n = 0; n < 8; n++) {
        struct packed poor = packed;
        if (n < 4)
            poor.stack_need = n;
        else
            poor.word = cyclic_words(5 * (n - 4));
        for (size_t e = 1; e <= 2; e++)
            for (size_t t = 0; t < ARRAY_COUNT(threads); t++)
                for (size_t c = 0; c < ARRAY_COUNT(counts); c++)
                    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query += 2) {
                        uint32_t some = expect_unfinished(engine_find(names[e]), (enum query)query,
                                                          threads[t], counts[c], &poor);
                        without_stack += e == 2 && some > 0;
                    }
        if (n >= 4)
            free(poor.word);
    }
    assert_true(without_stack > 100);
}

/* Threads add up what each of them took, and lose none of it: the same rays over and over take as
 * often as much. On a stack that is too short, as often as many are not finished. */
static void threads_lose_nothing_of_their_sums(void **state)
{
    (void)state;
    static struct ray many[TIMES * RAYS];
    static struct hit hit[TIMES * RAYS];
    for (uint32_t i = 0; i < TIMES * RAYS; i++)
        many[i] = ray[i % RAYS];
    for (uint32_t n = 0; n < 12; n++) {
        const struct engine *engine = engine_find(n < 6 ? "cpu" : "cpu_stackless");
        const bool poor = n % 2 == 1 && !engine->binary;
        struct packed tree = packed;
        const struct job job = job_of(&scene, &tree, QUERY_CLOSEST);
        struct trace_report one, all;
        struct reason reason[2] = {{""}, {""}};
        unsigned long long unfinished[2] = {0, 0};
        void *alone = prepared(engine, 1, &job), *team = prepared(engine, 4, &job);
        tree.stack_need = poor ? 1 : packed.stack_need;
        enum status status = engine->trace(alone, ray, RAYS, hit, &one, &reason[0]);
        assert_int_equal(status, poor ? STATUS_DEVICE : STATUS_OK);
        assert_int_equal(status, engine->trace(team, many, TIMES * RAYS, hit, &all, &reason[1]));
        assert_int_equal(all.tris, TIMES * one.tris);
        assert_int_equal(all.boxes, TIMES * one.boxes);
        for (int i = 0; i < 2 && poor; i++)
            assert_int_equal(sscanf(reason[i].text, "%llu of", &unfinished[i]), 1);
        assert_int_equal(unfinished[1], TIMES * unfinished[0]);
        engine->close(alone);
        engine->close(team);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_ray_is_answered_in_its_place),
        cmocka_unit_test(any_ends_at_the_first_that_is_found),
        cmocka_unit_test(lists_are_in_their_place),
        cmocka_unit_test(an_empty_scene_is_missed_by_all),
        cmocka_unit_test(rays_that_are_not_finished_are_counted),
        cmocka_unit_test(threads_lose_nothing_of_their_sums),
    };
    return cmocka_run_group_tests_name("engine_rays", tests, make, drop);
}
