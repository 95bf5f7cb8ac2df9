/* Engine vulkan_brute on worlds: the bits of engine brute, part by part. Skipped with the reason
 * where no device can be opened. */
#include "gpu/trace/dispatch.h"
#include "gpu/trace/world_part.h"
#include "scenes/rays/ray_modes.h"
#include "scenes/rays/rays.h"
#include "scenes/worlds.h"
#include "ref/world/bake.h"
#include "tests/support/gpu.h"
#include "tests/support/world_more_laws.h"

#define RAYS 200
#define ROOM 3

static struct laws open_device(void)
{
    struct laws laws = {.engine = engine_find("vulkan_brute"),
                        .self = driver_open("vulkan_brute", NULL)};
    if (!laws.self)
        skip();
    assert_non_null(laws.engine->worlds);
    return laws;
}

static struct laws open_brute(uint32_t threads)
{
    struct laws laws = {.engine = engine_find("brute")};
    const struct engine_options options = {.threads = threads, .device = -1};
    assert_int_equal(engine_open(laws.engine, &options, &laws.self, NULL), STATUS_OK);
    return laws;
}

static void close_both(const struct laws *a, const struct laws *b)
{
    a->engine->close(a->self);
    b->engine->close(b->self);
}

static void it_obeys_the_laws(void **state)
{
    (void)state;
    const struct laws laws = open_device();
    laws_of_names(&laws);
    laws_of_masks(&laws);
    laws_of_piles(&laws);
    laws_of_lists(&laws);
    laws_of_nothing(&laws);
    laws.engine->close(laws.self);
}

/* An instance that is not active keeps the numbers of its triangles, before others and at the end.
 * */
static void inactive_instances_keep_their_numbers(void **state)
{
    (void)state;
    static struct laws_shots shots;
    const struct laws laws = open_device();
    struct world world = laws_room(2, 4);
    laws_mesh(&world.mesh[0], (const uint32_t[]){2}, 1);
    laws_mesh(&world.mesh[1], (const uint32_t[]){2}, 1);
    for (uint32_t i = 0; i < 4; i++) {
        world.instance[i].mesh = i % 2;
        world.instance[i].mask = i % 2 ? 0xFF : 0;
    }
    world.instance[3].mask = 0;
    laws_finish(&world);
    shots.count = 0;
    for (uint32_t prim = 0; prim < 2; prim++)
        laws_add(&shots, laws_aim(&world, 1, prim, 0.25f, 0.25f, true, (struct ray_mode){0xFF, 0}));
    assert_int_equal(laws_fire(&laws, &world, shots.shot, shots.count), 2);
    world_free(&world);
    laws.engine->close(laws.self);
}

/* One engine's answers. */
struct brute_answers_of {
    struct hit hit[RAYS * ROOM];
    uint32_t tag[RAYS * ROOM], found[RAYS];
};

static void answer(const struct laws *laws, const struct world_job *job, const struct ray *ray,
                   const struct ray_mode *mode, struct brute_answers_of *out)
{
    const struct world_tracer *worlds = laws->engine->worlds;
    struct reason reason = {""};
    struct trace_report report;
    memset(out, 0x5A, sizeof *out);
    gpu_must(worlds->prepare_world(laws->self, job, &reason), &reason);
    if (job->query == QUERY_ALL)
        gpu_must(worlds->trace_world_all(laws->self, ray, mode, RAYS, ROOM, out->hit, out->tag,
                                         out->found, &reason),
                 &reason);
    else
        gpu_must(
            worlds->trace_world(laws->self, ray, mode, RAYS, out->hit, out->tag, &report, &reason),
            &reason);
}

/* Every query of one world with one triangle test; returns the number of hits. */
static size_t assert_same(const struct laws *gpu, const struct laws *cpu, const char *spec,
                          const struct tri_test *tri)
{
    static struct brute_answers_of a, b;
    struct world world;
    struct scene baked;
    struct ray *ray;
    static struct ray_mode mode[RAYS];
    struct reason reason = {""};
    size_t hits = 0;
    gpu_must(world_open(spec, 2, &world, &reason), &reason);
    gpu_must(world_bake(&world, 1000, &baked, &reason), &reason);
    gpu_must(ray_set_new(ray_sets[0], &baked, 4, RAYS, &ray, &reason), &reason);
    ray_modes_make(RAY_MODES_MIXED, 4, RAYS, mode);
    for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
        const struct world_job job = {
            .world = &world, .box = box_tests[0], .tri = tri, .query = (enum query)query};
        answer(gpu, &job, ray, mode, &a);
        answer(cpu, &job, ray, mode, &b);
        for (size_t i = 0; i < RAYS * ROOM; i++)
            if (memcmp(&a.hit[i], &b.hit[i], sizeof *a.hit) != 0 || a.tag[i] != b.tag[i] ||
                a.found[i / ROOM] != b.found[i / ROOM])
                fail_msg("%s %s %s place %zu: %u at %a, tag %x; brute %u at %a, tag %x", spec,
                         tri->name, query_name((enum query)query), i, a.hit[i].prim,
                         (double)a.hit[i].t, a.tag[i], b.hit[i].prim, (double)b.hit[i].t, b.tag[i]);
        for (size_t i = 0; i < RAYS && query == QUERY_CLOSEST; i++)
            hits += a.hit[i].prim != ABI_NO_PRIM;
    }
    free(ray);
    scene_free(&baked);
    world_free(&world);
    return hits;
}

/* In one part, in two (32,768 placed triangles) and in three (36,000). */
static void it_has_the_bits_of_brute(void **state)
{
    (void)state;
    static const char *const specs[] = {"mixed", "mixed:filter=2", "wall", "placed-turned:n=32",
                                        "crowd:n=3000"};
    const struct laws gpu = open_device(), cpu = open_brute(2);
    for (size_t s = 0; s < ARRAY_COUNT(specs); s++)
        assert_true(assert_same(&gpu, &cpu, specs[s], tri_tests[s]) > RAYS / 10);
    close_both(&gpu, &cpu);
}

/* A part ends within an instance: its last triangle and the next one are listed once each. */
static void triangles_where_parts_meet_are_tested_once(void **state)
{
    (void)state;
    static struct brute_answers_of a, b;
    static struct ray ray[RAYS];
    static struct ray_mode mode[RAYS];
    const struct laws gpu = open_device(), cpu = open_brute(2);
    struct world world = laws_room(1, 2);
    laws_mesh(&world.mesh[0], (const uint32_t[]){DISPATCH_PART + 8}, 1);
    laws_finish(&world);
    for (uint32_t i = 0; i < RAYS; i++) {
        const uint32_t prim = DISPATCH_PART - 4 + i % 8;
        ray[i] = laws_aim(&world, 0, prim, 0.25f, 0.25f, true, ray_mode_all()).ray;
        mode[i] = ray_mode_all();
    }
    const struct world_job job = {
        .world = &world, .box = box_tests[0], .tri = tri_tests[0], .query = QUERY_ALL};
    answer(&gpu, &job, ray, mode, &a);
    answer(&cpu, &job, ray, mode, &b);
    assert_memory_equal(&a, &b, sizeof a);
    for (uint32_t i = 0; i < RAYS; i++)
        assert_true(a.found[i] > 0);
    world_free(&world);
    close_both(&gpu, &cpu);
}

/* Those of mask 0 have numbers, at the end as in between. */
static void instances_that_are_not_active_keep_their_triangles(void **state)
{
    (void)state;
    static struct brute_answers_of a, b;
    static struct ray ray[RAYS];
    static struct ray_mode mode[RAYS];
    const struct laws gpu = open_device(), cpu = open_brute(1);
    for (uint32_t masked = 1; masked < 16; masked++) {
        struct world world = laws_room(1, 4);
        laws_mesh(&world.mesh[0], (const uint32_t[]){2}, 1);
        for (uint32_t i = 0; i < 4; i++)
            world.instance[i].mask = masked >> i & 1 ? 0 : 0xFF;
        laws_finish(&world);
        for (uint32_t i = 0; i < RAYS; i++) {
            ray[i] = laws_aim(&world, i % 4, i / 4 % 2, 0.25f, 0.25f, true, ray_mode_all()).ray;
            mode[i] = ray_mode_all();
        }
        for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
            const struct world_job job = {.world = &world,
                                          .box = box_tests[0],
                                          .tri = tri_tests[0],
                                          .query = (enum query)query};
            answer(&gpu, &job, ray, mode, &a);
            answer(&cpu, &job, ray, mode, &b);
            assert_memory_equal(&a, &b, sizeof a);
            for (size_t i = 0; i < 8 && query == QUERY_CLOSEST; i++)
                assert_int_equal(a.hit[i].prim == ABI_NO_PRIM, masked >> i % 4 & 1);
        }
        world_free(&world);
    }
    close_both(&gpu, &cpu);
}

/* Every placed triangle is in one part, and no part goes through more than it may. */
static void parts_cover_a_world_once(void **state)
{
    (void)state;
    enum { COUNT = 3 * DISPATCH_PART };
    for (uint32_t size = 0; size < 4; size++) {
        struct world world = laws_room(2, COUNT);
        laws_mesh(&world.mesh[0], (const uint32_t[]){size == 3 ? 40000u : size}, 1);
        laws_mesh(&world.mesh[1], (const uint32_t[]){0}, 1);
        for (uint32_t i = 0; i < COUNT; i++) {
            bool empty = size == 3 ? i % DISPATCH_PART != 5 : i / DISPATCH_PART == 1;
            world.instance[i].mesh = !empty ? 0 : i % 2 ? 1 : WORLD_NO_MESH;
        }
        laws_finish(&world);
        struct world_push push = {0};
        uint32_t next = 0, parts = 0;
        bool more;
        do {
            more = world_part_next(&world, &push);
            assert_int_equal(push.first, next);
            assert_true(push.last - push.first <= DISPATCH_PART);
            next = push.last;
            parts++;
            if (next == push.first)
                continue;
            assert_true(world.first[push.index] <= push.first);
            assert_true(world.first[push.index + 1] > push.first);
            assert_true(world_instance_of(&world, next - 1) - push.index < DISPATCH_PART);
        } while (more);
        assert_int_equal(next, world_tri_count(&world));
        assert_true(size == 0 ? parts == 1 : parts > 1);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_obeys_the_laws),
        cmocka_unit_test(inactive_instances_keep_their_numbers),
        cmocka_unit_test(it_has_the_bits_of_brute),
        cmocka_unit_test(triangles_where_parts_meet_are_tested_once),
        cmocka_unit_test(instances_that_are_not_active_keep_their_triangles),
        cmocka_unit_test(parts_cover_a_world_once),
    };
    return cmocka_run_group_tests_name("brute_world", tests, NULL, NULL);
}
