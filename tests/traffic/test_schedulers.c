/* Schedulers: every answer is engine cpu's, and what moves keeps the laws. */
#include "ref/base/rng.h"
#include "tests/traffic/traffic_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

/* Machines of many sizes: all of one, and many of few. */
static struct traffic_machine draw_machine(struct rng *rng)
{
    struct traffic_machine m = traffic_small();
    m.memory.units = 1 + rng_below(rng, 5);
    m.lanes = 1 + rng_below(rng, 7);
    m.packet = 1 + rng_below(rng, 64);
    m.queue = 1 + rng_below(rng, 300);
    m.memory.cache[0].bytes = 128u << rng_below(rng, 8);
    return m;
}

/* The places of waves after the second are those of the first two. */
static void check_result(const struct scheduler *s, const struct traffic_result *r,
                         const struct traffic_case *c)
{
    uint64_t rays = 0, places = 0;
    for (uint32_t k = 0; k < c->paths.depth; k++) {
        rays += c->paths.wave[k].count;
        places += k < 2 ? c->paths.wave[k].count : 0;
    }
    assert_true(c->paths.wave[1].count > 5); /* the camera rays that hit */
    if (r->wrong || r->reloads || !r->conserved)
        fail_msg("%s: %zu wrong, %zu loaded again, %s", s->name, (size_t)r->wrong,
                 (size_t)r->reloads, r->conserved ? "conserved" : "bytes do not add up");
    assert_int_equal(r->rays, rays);
    /* A ray is read, and its answer is written. */
    assert_true(r->count[TRAFFIC_DRAM].in[TRAFFIC_RAYS] >= 32 * places);
    assert_true(r->count[TRAFFIC_DRAM].out[TRAFFIC_HITS] >= 16 * places);
}

static void answers_are_the_cpus_in_every_layout_and_storage(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 1);
    size_t played = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t s = 0; tri_stores[s]; s++) {
            struct traffic_case c;
            if (!traffic_case_open("soup:n=500,size=0.5", layouts_all[l]->name, tri_stores[s]->name,
                                   &c))
                continue;
            if (tri_store_answers(c.packed.store, c.job.tri->id)) {
                traffic_case_start(&c, 24, 3, 5000);
                for (size_t i = 0; schedulers[i]; i++) {
                    struct traffic_machine m = draw_machine(&rng);
                    if (schedulers[i]->kd && played > 10)
                        continue; /* its tree is none of these layouts' */
                    struct traffic_result r = traffic_case_play(&c, schedulers[i]->name, &m);
                    check_result(schedulers[i], &r, &c);
                    assert_true(r.other == 0 ||
                                (schedulers[i]->reorders && layouts_all[l]->faithful));
                    played++;
                }
                traffic_case_stop(&c);
            }
            traffic_case_close(&c);
        }
    assert_true(played > 500);
}

/* Triangles in pairs at the same place: either may be the answer where the order is another. */
static void exact_ties_are_counted_apart(void **state)
{
    (void)state;
    struct traffic_case c;
    uint64_t ties = 0;
    assert_true(traffic_case_open(TRAFFIC_TWICE "soup:n=400,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 2000, 3, 600);
    struct traffic_machine m = traffic_small();
    for (size_t i = 0; schedulers[i]; i++) {
        struct traffic_result r = traffic_case_play(&c, schedulers[i]->name, &m);
        check_result(schedulers[i], &r, &c);
        ties += r.ties;
        assert_int_equal(r.other, 0);
        /* The others walk as engine cpu does. */
        if (!schedulers[i]->reorders)
            assert_int_equal(r.ties, 0);
    }
    assert_true(ties > 0);
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* What a cache does not have to read twice, each scheduler of the same walk reads once. */
static void infinite_caches_read_the_working_set(void **state)
{
    (void)state;
    static const char *const same[] = {"depth_first", "sorted", "treelets", "strata"};
    struct traffic_case c;
    struct traffic_machine m = traffic_small();
    m.memory.cache[0] = m.memory.cache[1] = (struct traffic_cache_size){1 << 24, 16, 64};
    assert_true(traffic_case_open("soup:n=3000,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 500, 3, 2000);
    uint64_t set = 0, visits = 0, rays = 0;
    for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
        struct traffic_result r = traffic_case_play(&c, same[i], &m);
        assert_int_equal(traffic_scene_part(&r, TRAFFIC_DRAM), r.working_set);
        assert_true(set == 0 || r.working_set == set);
        set = r.working_set;
        /* A ray visits the same nodes, and on a trail its parents too. */
        if (i == 0) {
            visits = r.visits;
            rays = traffic_part(&r, TRAFFIC_DRAM, TRAFFIC_RAYS);
        }
        /* To sort rays reads and writes each once. */
        if (i == 1)
            assert_in_range(traffic_part(&r, TRAFFIC_DRAM, TRAFFIC_RAYS), rays + 64 * r.rays,
                            rays + 64 * r.rays + 128 * c.paths.depth);
        assert_true(i == 3 ? r.visits > visits : r.visits == visits);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* Bytes of level 1 are those of the traversal as bench/measure/touch.h records it. */
static void add(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    uint64_t *sum = reader;
    (void)offset;
    sum[array != TOUCH_NODES] += bytes;
}

static void level_1_gets_what_the_cpu_reads(void **state)
{
    (void)state;
    static const char *const store[] = {"indexed", "gathered"};
    for (size_t s = 0; s < 2; s++) {
        struct traffic_case c;
        struct touch touch;
        struct reason reason;
        uint64_t sum[2] = {0, 0};
        assert_true(traffic_case_open("soup:n=600,size=0.5", "f32", store[s], &c));
        traffic_case_start(&c, 300, 2, 2000);
        assert_int_equal(touch_make(&c.packed, &c.scene, false, NULL, &touch, &reason), STATUS_OK);
        touch.read = add;
        touch.reader = sum;
        for (uint32_t k = 0; k < c.paths.depth; k++)
            for (size_t i = 0; i < c.paths.wave[k].count; i++) {
                struct hit hit;
                assert_int_equal(touch_ray(&touch, &c.job, &c.paths.wave[k].ray[i], &hit),
                                 STATUS_OK);
            }
        static const char *const same[] = {"depth_first", "sorted", "treelets"};
        for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
            struct traffic_machine m = traffic_small();
            struct traffic_result r = traffic_case_play(&c, same[i], &m);
            assert_int_equal(traffic_part(&r, TRAFFIC_L1, TRAFFIC_NODES), sum[0]);
            assert_int_equal(traffic_part(&r, TRAFFIC_L1, TRAFFIC_TRIANGLES), sum[1]);
        }
        touch_free(&touch);
        traffic_case_stop(&c);
        traffic_case_close(&c);
    }
}

/* A packet of one ray reads what the ray does; of more no more nodes than they do one by one. */
static void packets_share_what_they_read(void **state)
{
    (void)state;
    struct traffic_case c;
    struct traffic_machine m = traffic_small();
    assert_true(traffic_case_open("sphere:n=12", "f32", "indexed", &c));
    traffic_case_start(&c, 900, 1, 2000);
    struct traffic_result one_by_one = traffic_case_play(&c, "depth_first", &m);
    uint64_t before = UINT64_MAX, tris_before = UINT64_MAX;
    for (m.packet = 1; m.packet <= 64; m.packet *= 4) {
        struct traffic_result r = traffic_case_play(&c, "packets", &m);
        uint64_t read = traffic_scene_part(&r, TRAFFIC_L1);
        uint64_t tris = traffic_part(&r, TRAFFIC_L1, TRAFFIC_TRIANGLES);
        if (m.packet == 1) {
            assert_int_equal(r.visits, one_by_one.visits);
            assert_int_equal(read, traffic_scene_part(&one_by_one, TRAFFIC_L1));
        }
        assert_true(read < before && tris < tris_before);
        before = read;
        tris_before = tris;
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* Bursts that DRAM gives a stream: those of the segments, each once for a wavefront. */
static void segments_are_read_once_for_a_wavefront(void **state)
{
    (void)state;
    struct traffic_case c;
    struct traffic_machine m = traffic_small();
    m.memory.units = 1;
    m.queue = 100000;
    assert_true(traffic_case_open("soup:n=2000,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 4000, 2, 2000);
    const struct scene_treelets *t = &c.walker.treelets;
    uint64_t all = 0;
    for (size_t i = 0; i < t->run_count; i++)
        all += t->run[i].bytes;
    struct traffic_result dual = traffic_case_play(&c, "dual", &m);
    assert_true(dual.loads <= (uint64_t)t->count * c.paths.depth);
    assert_true(dual.loads > t->count);
    assert_true(traffic_scene_part(&dual, TRAFFIC_DRAM) <= all * c.paths.depth);
    assert_true(traffic_scene_part(&dual, TRAFFIC_DRAM) > all);
    /* One chip with room for all is the same stream, with queues and hits on the chip. */
    struct traffic_result mach = traffic_case_play(&c, "mach_rt", &m);
    assert_int_equal(mach.loads, dual.loads);
    assert_int_equal(mach.visits, dual.visits);
    assert_int_equal(traffic_scene_part(&mach, TRAFFIC_L2),
                     traffic_scene_part(&dual, TRAFFIC_DRAM));
    assert_in_range(traffic_part(&mach, TRAFFIC_DRAM, TRAFFIC_RAYS), 32 * mach.rays,
                    32 * mach.rays + 64 * c.paths.depth);
    /* Queues are written and read, and nothing else but the rays at the start. */
    uint64_t written = dual.count[TRAFFIC_DRAM].out[TRAFFIC_RAYS];
    assert_true(written > 0);
    assert_in_range(dual.count[TRAFFIC_DRAM].in[TRAFFIC_RAYS], written + 32 * dual.rays,
                    written + 32 * dual.rays + 64 * c.paths.depth);
    /* More chips with less room load more often, from a level that holds all. */
    m.memory.units = 4;
    m.queue = 300;
    m.memory.cache[1] = (struct traffic_cache_size){1 << 24, 16, 64};
    struct traffic_result many = traffic_case_play(&c, "mach_rt", &m);
    assert_true(many.loads > dual.loads);
    assert_int_equal(traffic_scene_part(&many, TRAFFIC_DRAM), many.working_set);
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* With the scene in one treelet there are no queues to wait in but the first. */
static void one_treelet_is_no_treelets(void **state)
{
    (void)state;
    struct traffic_case c;
    struct traffic_machine m = traffic_small();
    m.queue = 100000;
    assert_true(traffic_case_open("soup:n=600,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 800, 3, 1 << 24);
    struct traffic_result plain = traffic_case_play(&c, "depth_first", &m);
    static const char *const same[] = {"treelets", "strata", "dual"};
    for (size_t i = 0; i < ARRAY_COUNT(same); i++) {
        struct traffic_result r = traffic_case_play(&c, same[i], &m);
        assert_int_equal(r.loads, c.paths.depth);
        if (i != 1)
            assert_int_equal(r.visits, plain.visits);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* RayCore's reads are those of engine kd, ray by ray. */
static void add_kd(void *reader, enum kd_read array, ptrdiff_t number, size_t bytes)
{
    uint64_t *sum = reader;
    (void)number;
    sum[array != KD_READ_NODE] += bytes;
}

static void raycore_reads_what_engine_kd_does(void **state)
{
    (void)state;
    struct traffic_case c;
    struct traffic_machine m = traffic_small();
    uint64_t sum[2] = {0, 0};
    assert_true(traffic_case_open("soup:n=600,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 400, 3, 2000);
    struct traffic_result r = traffic_case_play(&c, "raycore", &m);
    for (uint32_t k = 0; k < c.paths.depth; k++)
        for (size_t i = 0; i < c.paths.wave[k].count; i++)
            (void)kd_watched(&c.kd, &c.paths.wave[k].ray[i], add_kd, sum);
    assert_int_equal(traffic_part(&r, TRAFFIC_L1, TRAFFIC_NODES), sum[0]);
    assert_int_equal(traffic_part(&r, TRAFFIC_L1, TRAFFIC_TRIANGLES), sum[1]);
    assert_int_equal(traffic_part(&r, TRAFFIC_L1, TRAFFIC_STACK), 0);
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* A path goes on where its ray hits, and each ray of it begins there. */
static void paths_end_where_nothing_is_hit(void **state)
{
    (void)state;
    struct traffic_case c;
    assert_true(traffic_case_open("cornell", "f32", "indexed", &c));
    traffic_case_start(&c, 1000, 16, 4000);
    assert_true(c.paths.depth > 2);
    for (uint32_t k = 0; k < c.paths.depth; k++) {
        const struct traffic_wave *wave = &c.paths.wave[k];
        const struct traffic_wave *next = k + 1 < c.paths.depth ? wave + 1 : NULL;
        size_t hits = 0;
        for (size_t i = 0; i < wave->count; i++) {
            if (wave->hit[i].prim == ABI_NO_PRIM)
                continue;
            for (int a = 0; a < 3 && next; a++) {
                float at = wave->ray[i].org[a] + wave->hit[i].t * wave->ray[i].dir[a];
                float off = next->ray[hits].org[a] - at;
                assert_true(off < 1 && off > -1); /* the room is hundreds wide */
            }
            if (next)
                assert_int_equal(next->path[hits], wave->path[i]);
            hits++;
        }
        assert_int_equal(next ? next->count : 0, next ? hits : 0);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

static void members_say_what_they_are(void **state)
{
    (void)state;
    for (size_t i = 0; schedulers[i]; i++) {
        assert_ptr_equal(scheduler_find(schedulers[i]->name), schedulers[i]);
        assert_non_null(schedulers[i]->summary);
        assert_non_null(schedulers[i]->uses);
        assert_true(strlen(schedulers[i]->name) <= 11); /* of the table */
    }
    assert_null(scheduler_find("none"));
}

/* Answers as its number says: 0 the right one, 1 none, 2 twice, 3 another triangle, 4 a miss. */
static uint32_t answers_of(uint32_t ray)
{
    return ray % 7 < 5 ? ray % 7 : 0;
}

static enum status play_by_number(struct traffic_run *run, struct reason *reason)
{
    (void)reason;
    for (uint32_t k = 0; k < run->depth; k++)
        for (uint32_t i = 0; i < run->paths->wave[k].count; i++) {
            struct hit hit = run->paths->wave[k].hit[i];
            const uint32_t what = answers_of(i);
            if (what == 3)
                hit = (struct hit){0.5f, 0.25f, 0.25f, UINT32_MAX - 1};
            if (what == 4)
                hit = (struct hit){.prim = ABI_NO_PRIM};
            for (uint32_t times = what == 1 ? 0 : what == 2 ? 2 : 1; times > 0; times--)
                traffic_note_answer(run, k, i, &hit);
        }
    return STATUS_OK;
}

/* An answer that is missing, given twice or another one is wrong. */
static void what_is_wrong_is_counted(void **state)
{
    (void)state;
    static const struct scheduler by_number = {.name = "by_number", .play = play_by_number};
    const struct traffic_machine machine = traffic_small();
    struct traffic_case c;
    struct traffic_result r;
    struct reason reason;
    assert_true(traffic_case_open("soup:n=500,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 200, 3, 5000);
    struct traffic_run run = {
        .machine = &machine, .paths = &c.paths, .depth = c.paths.depth, .walker = &c.walker};
    size_t wrong = 0, missed = 0;
    for (uint32_t k = 0; k < c.paths.depth; k++)
        for (uint32_t i = 0; i < c.paths.wave[k].count; i++) {
            bool miss = c.paths.wave[k].hit[i].prim == ABI_NO_PRIM;
            missed += miss && answers_of(i) == 4;
            wrong += answers_of(i) > 0 && !(miss && answers_of(i) == 4);
        }
    assert_int_equal(traffic_play(&by_number, &run, &r, &reason), STATUS_OK);
    assert_true(missed > 0);
    assert_int_equal(r.wrong, wrong);
    assert_int_equal(r.ties + r.other, 0);
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(members_say_what_they_are),
        cmocka_unit_test(answers_are_the_cpus_in_every_layout_and_storage),
        cmocka_unit_test(exact_ties_are_counted_apart),
        cmocka_unit_test(infinite_caches_read_the_working_set),
        cmocka_unit_test(level_1_gets_what_the_cpu_reads),
        cmocka_unit_test(packets_share_what_they_read),
        cmocka_unit_test(segments_are_read_once_for_a_wavefront),
        cmocka_unit_test(one_treelet_is_no_treelets),
        cmocka_unit_test(raycore_reads_what_engine_kd_does),
        cmocka_unit_test(what_is_wrong_is_counted),
        cmocka_unit_test(paths_end_where_nothing_is_hit),
    };
    return cmocka_run_group_tests_name("schedulers", tests, NULL, NULL) ? 1 : 0;
}
