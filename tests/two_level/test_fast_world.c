/* The fast traversal of worlds, by every kernel and by the scalar code, against worlds without
 * trees: nearest hits, any hits and lists, with their tags, under masks, flags and filters. */
#include "ref/engine.h"
#include "ref/fast/fast_world.h"
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

#include "tests/two_level/world_stand.h"
#include "tests/two_level/world_against_brute.h"

#define RAYS 300

/* A world, its trees and its fast form. */
struct fast_stand {
    struct world *world;
    struct world_trees trees;
    struct packed_world packed; /* for stand_aim */
    struct fast_world fast;
    uint32_t hits, others, any_hits;
};

static void open_stand(struct world *world, const char *builder, struct fast_stand *out)
{
    struct reason reason = {""};
    *out = (struct fast_stand){.world = world, .trees = stand_trees(world, builder, 2)};
    out->packed = stand_packed(world, &out->trees, "f32", "f32");
    if (fast_world_make(world, &out->trees.top, &out->trees.items, out->trees.bottom,
                        out->packed.record, &out->fast, &reason))
        fail_msg("%s", reason.text);
}

static void close_stand(struct fast_stand *s)
{
    fast_world_free(&s->fast);
    packed_world_free(&s->packed);
    world_trees_free(&s->trees);
}

static void must_be_listed(const struct tagged_list *all, const struct tagged *hit,
                           const char *what)
{
    if (hit->hit.prim == ABI_NO_PRIM ? hit->tag != 0 || all->count > 0 : !is_listed(all, hit))
        fail_msg("%s: triangle %u at %a, tag %x, of %u hits", what, hit->hit.prim,
                 (double)hit->hit.t, hit->tag, all->count);
}

/* The list by the scalar code: what the world has without trees, or only a part of it, where
 * rounding finds hits outside all boxes. */
static void list_all(const struct fast_stand *s, const struct ray *ray, struct ray_mode mode,
                     bool part, struct tagged_list *all)
{
    static struct hit hits[STAND_LIST];
    static uint32_t tags[STAND_LIST];
    static struct tagged_list listed;
    listed.count = fast_world_all(&s->fast, ray, mode, STAND_LIST, hits, tags);
    assert_int_equal(fast_world_all(&s->fast, ray, mode, 0, NULL, NULL), listed.count);
    tagged_fill(&listed, hits, tags, false);
    for (uint32_t i = 0; i < listed.count; i++)
        assert_true(is_listed(all, &listed.entry[i]));
    if (part)
        all->count = listed.count;
    assert_int_equal(listed.count, all->count);
    memcpy(all->entry, listed.entry, all->count * sizeof *all->entry);
}

/* A ray in all ways. With FIRST a nearest hit is any. */
static void must_agree(struct fast_stand *s, const struct ray *ray, struct ray_mode mode, bool part)
{
    static struct hit hits[STAND_LIST];
    static uint32_t tags[STAND_LIST];
    static struct tagged_list all;
    struct tagged one;
    const struct tri_test *woop = tri_test_find("woop");
    const bool first = mode.flags & ABI_RAY_FIRST;
    all.count =
        trace_world_brute_all(s->world, s->packed.record, woop, ray, mode, STAND_LIST, hits, tags);
    tagged_fill(&all, hits, tags, false);
    list_all(s, ray, mode, part, &all);
    const float nearest = all.count ? all.entry[0].hit.t : 0;
    s->hits += all.count > 0;
    s->others += all.count > 0 && all.entry[0].tag != 0;
    for (size_t k = 0; fast_kernels[k]; k++)
        for (int any = 0; any < 2 && fast_kernels[k]->runs(); any++) {
            memset(&one, 0xAA, sizeof one);
            fast_kernels[k]->world(&s->fast, ray, &mode, 1, any, &one.hit, &one.tag);
            must_be_listed(&all, &one, fast_kernels[k]->name);
            if (!any && !first)
                assert_int_equal(float_bits(one.hit.t), float_bits(nearest));
            s->any_hits += any && one.hit.prim != ABI_NO_PRIM;
        }
    for (int any = 0; any < 2; any++) {
        fast_careful_world(&s->fast, ray, mode, any || first, &one.hit, &one.tag);
        if (s->fast.top.node_count == 0 || (mode.flags & ABI_RAY_SKIP_TRIANGLES))
            continue;
        must_be_listed(&all, &one, "careful");
        if (!any && !first)
            assert_int_equal(float_bits(one.hit.t), float_bits(nearest));
    }
}

static void every_transform_is_traced(void **state)
{
    (void)state;
    for (uint32_t kind = 0; kind < WORLD_KINDS; kind++) {
        struct world world = fixture_world("soup:n=30,size=0.4", kind, 25, 60 + kind);
        struct fast_stand s;
        open_stand(&world, kind % 2 ? "median" : "sah_sweep", &s);
        assert_true(s.fast.plain);
        for (uint64_t i = 0; i < RAYS; i++) {
            struct ray ray = stand_aim(&s.packed, kind, i);
            must_agree(&s, &ray, ray_mode_all(), false);
        }
        assert_true(s.hits > RAYS / 8 && s.any_hits >= s.hits);
        close_stand(&s);
        world_free(&world);
    }
}

/* Masks, flags of instances and rays, opacity and filters, each with each. */
static void what_does_not_count_is_passed(void **state)
{
    (void)state;
    for (uint32_t turn = 0; turn < 12; turn++) {
        struct world world = fixture_room(2, 30);
        fixture_mesh(&world, 0, "soup:n=40,size=0.5", 3);
        fixture_mesh(&world, 1, "sphere:n=2", 1 + turn % 2);
        for (uint32_t i = 0; i < 30; i++) {
            fixture_transform(i % 2 ? WORLD_TURNED : WORLD_MIRRORED, 60 * turn + i,
                              world.instance[i].m);
            world.instance[i].mesh = i % 7 == 3 ? WORLD_NO_MESH : i % 2;
            world.instance[i].mask = i % 5 == 4 ? 0 : 1u << i % 8;
            world.instance[i].flags = (i + turn) % 12;
        }
        world.filter = (struct filter_rule){turn % 4, turn, 128};
        fixture_finish(&world);
        struct fast_stand s;
        open_stand(&world, "median", &s);
        for (uint64_t i = 0; i < RAYS; i++) {
            static const uint32_t one[] = {0, ABI_RAY_OPAQUE, ABI_RAY_NO_OPAQUE,
                                           ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE},
                                  other[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT,
                                             ABI_RAY_SKIP_TRIANGLES},
                                  third[] = {0, ABI_RAY_FIRST, ABI_RAY_SKIP_CLOSEST};
            struct ray ray = stand_aim(&s.packed, turn, i);
            struct ray_mode mode = {(uint32_t)(i % 3 ? 0xFF : 1 + i * 37 % 255),
                                    one[i % 5] | other[i / 5 % 4] | third[i / 20 % 3]};
            must_agree(&s, &ray, mode, false);
        }
        assert_true(s.hits > RAYS / 16 && s.others > 0);
        close_stand(&s);
        world_free(&world);
    }
}

/* Rays that kernels leave to the scalar code, at the top or in an instance: of no finite numbers,
 * from far away, along axes with directions of the smallest numbers, and into instances that are
 * tiny or huge. */
static void odd_rays_are_traced_with_care(void **state)
{
    (void)state;
    struct world world = fixture_room(1, 12);
    fixture_mesh(&world, 0, "soup:n=30,size=0.6", 1);
    for (uint32_t i = 0; i < 12; i++) {
        float size = i % 3 == 0 ? 1.0f : i % 3 == 1 ? 0x1p-44f : 0x1p42f;
        fixture_transform(WORLD_TURNED, i, world.instance[i].m);
        for (int k = 0; k < 9; k++)
            world.instance[i].m[k / 3][k % 3] *= size;
    }
    fixture_finish(&world);
    struct fast_stand s;
    open_stand(&world, "median", &s);
    for (uint64_t i = 0; i < 4 * RAYS; i++) {
        struct ray ray = stand_aim(&s.packed, 5, i);
        static const float scales[] = {1, 0x1p-45f, 0x1p45f, 0x1p-140f};
        float scale = scales[i % 4];
        for (int k = 0; k < 3; k++)
            ray.dir[k] *= scale;
        ray.tmax /= scale;
        if (i % 16 == 7)
            ray.dir[i % 3] = NAN;
        if (i % 16 == 9)
            ray.org[i % 3] = INFINITY;
        if (i % 16 == 11)
            ray.dir[i % 3] = 0;
        must_agree(&s, &ray, ray_mode_all(), true);
    }
    assert_true(s.hits > 50);
    close_stand(&s);
    world_free(&world);
}

/* Instances of one size that lie in each other. In every second one numbers are too small for a
 * kernel, so that the scalar code and a kernel find nearer hits than each other in turns. */
static void care_in_one_instance_keeps_the_hits_of_others(void **state)
{
    (void)state;
    struct world world = fixture_room(2, 12);
    fixture_mesh(&world, 0, "soup:n=30,size=0.9", 1);
    fixture_mesh(&world, 1, "soup:n=30,size=0.9", 1);
    for (uint32_t i = 0; i < 3 * world.mesh[1].scene->vertex_count; i++)
        world.mesh[1].scene->vertex[i] *= 0x1p-41f;
    for (uint32_t i = 0; i < 12; i++) {
        fixture_transform(WORLD_TURNED, i, world.instance[i].m);
        world.instance[i].mesh = i % 2;
        for (uint32_t k = 0; k < 12; k++)
            if (k % 4 == 3)
                world.instance[i].m[k / 4][3] = 0.1f * (float)(i * (k + 5) % 7);
            else if (i % 2)
                world.instance[i].m[k / 4][k % 4] *= 0x1p41f;
    }
    fixture_finish(&world);
    struct fast_stand s;
    open_stand(&world, "median", &s);
    for (uint64_t i = 0; i < 4 * RAYS; i++) {
        struct ray ray = stand_aim(&s.packed, 5, i);
        must_agree(&s, &ray, ray_mode_all(), true);
    }
    assert_true(s.hits > 3 * RAYS);
    close_stand(&s);
    world_free(&world);
}

/* Without instances, with one, and where none is active. */
static void small_worlds_are_worlds(void **state)
{
    (void)state;
    for (uint32_t count = 0; count < 3; count++) {
        struct world world = fixture_room(1, count);
        fixture_mesh(&world, 0, "sphere:n=2", 1);
        for (uint32_t i = 0; i < count; i++)
            world.instance[i].mask = count == 1 ? 0xFF : 0;
        fixture_finish(&world);
        struct fast_stand s;
        open_stand(&world, "median", &s);
        assert_int_equal(s.fast.top.node_count, count == 1);
        for (uint32_t i = 0; i < 50; i++) {
            struct ray ray = {.org = {3, 0.001f * (float)i, 0.1f}, .dir = {-1, 0, 0}, .tmax = 10};
            must_agree(&s, &ray, ray_mode_all(), false);
        }
        assert_int_equal(s.hits, count == 1 ? 50 : 0);
        close_stand(&s);
        world_free(&world);
    }
}

/* Its bytes, and that what is opened for a world and then for a scene is of that alone. */
static void an_engine_goes_from_worlds_to_scenes_and_back(void **state)
{
    (void)state;
    const struct engine *fast = engine_find("fast");
    const struct engine_options options = {.threads = 2, .device = -1};
    struct world world = fixture_world("sphere:n=2", WORLD_TURNED, 5, 3);
    struct packed_world packed = stand_world(&world, "rf16");
    struct reason reason = {""};
    struct hit hit[2 * STAND_RAYS];
    uint32_t tag[2 * STAND_RAYS], hits = 0;
    static struct ray ray[2 * STAND_RAYS];
    void *self;
    for (uint32_t i = 0; i < 2 * STAND_RAYS; i++)
        ray[i] = stand_aim(&packed, 3, i);
    assert_int_equal(engine_open(fast, &options, &self, &reason), STATUS_OK);
    for (int turn = 0; turn < 4; turn++) {
        struct trace_report report;
        if (turn % 2) {
            const struct job job = {.scene = world.mesh[0].scene,
                                    .packed = &packed.bottom[0],
                                    .box = box_test_find("watertight"),
                                    .tri = tri_test_find("woop")};
            assert_int_equal(fast->prepare(self, &job, &reason), STATUS_OK);
            assert_int_equal(fast->trace(self, ray, 2, hit, &report, &reason), STATUS_OK);
            continue;
        }
        struct world_job job = stand_job(&world, &packed, turn ? QUERY_ANY : QUERY_CLOSEST);
        job.tri = tri_test_find("woop");
        assert_int_equal(fast->worlds->prepare_world(self, &job, &reason), STATUS_OK);
        assert_int_equal(
            fast->worlds->trace_world(self, ray, NULL, 2 * STAND_RAYS, hit, tag, &report, &reason),
            STATUS_OK);
        assert_true(report.memory_bytes > 5 * 64 + 32 * 12);
        for (uint32_t i = 0; i < 2 * STAND_RAYS; i++) {
            struct tagged near;
            trace_world_brute(&world, packed.record, job.tri, QUERY_CLOSEST, &ray[i],
                              ray_mode_all(), &near.hit, &near.tag);
            assert_int_equal(hit[i].prim == ABI_NO_PRIM, near.hit.prim == ABI_NO_PRIM);
            assert_true(turn || float_bits(hit[i].t) == float_bits(near.hit.t));
            hits += hit[i].prim != ABI_NO_PRIM;
        }
    }
    assert_true(hits > STAND_RAYS / 2);
    fast->close(self);
    packed_world_free(&packed);
    world_free(&world);
}

/* A world is gone when the next one is prepared, or the engine is closed: neither reads it. */
static void worlds_may_go_before_the_engine(void **state)
{
    (void)state;
    const struct engine *fast = engine_find("fast");
    const struct engine_options options = {.threads = 1, .device = -1};
    struct reason reason = {""};
    void *self;
    assert_int_equal(engine_open(fast, &options, &self, &reason), STATUS_OK);
    for (uint32_t turn = 0; turn < 6; turn++) {
        struct world world = fixture_room(1 + turn % 3, 4);
        for (uint32_t m = 0; m < world.mesh_count; m++)
            fixture_mesh(&world, m, "sphere:n=2", 1);
        fixture_finish(&world);
        struct packed_world packed = stand_world(&world, "f32");
        const struct world_job job = stand_job(&world, &packed, QUERY_CLOSEST);
        assert_int_equal(fast->worlds->prepare_world(self, &job, &reason), STATUS_OK);
        packed_world_free(&packed);
        world_free(&world);
        memset(&world, 0xA5, sizeof world); /* as a stack would be used again */
    }
    fast->close(self);
}

/* Every mesh is opaque, and some instances are not: only their hits are the filter's. */
static void instances_alone_may_need_the_filter(void **state)
{
    (void)state;
    struct world world = fixture_everything();
    for (uint32_t m = 0; m < world.mesh_count; m++)
        for (uint32_t g = 0; g < world.mesh[m].geometry_count; g++)
            world.mesh[m].geometry[g].opaque = true;
    for (int forced = 1; forced >= 0; forced--) {
        struct fast_stand s;
        open_stand(&world, "median", &s);
        assert_int_equal(s.fast.plain, !forced);
        for (uint64_t i = 0; i < RAYS; i++) {
            struct ray ray = stand_aim(&s.packed, 5, i);
            must_agree(&s, &ray, ray_mode_all(), false);
        }
        assert_true(s.others > 10);
        close_stand(&s);
        for (uint32_t i = 0; i < world.instance_count; i++)
            world.instance[i].flags &= ~ABI_INSTANCE_FORCE_NO_OPAQUE;
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_transform_is_traced),
        cmocka_unit_test(what_does_not_count_is_passed),
        cmocka_unit_test(odd_rays_are_traced_with_care),
        cmocka_unit_test(care_in_one_instance_keeps_the_hits_of_others),
        cmocka_unit_test(small_worlds_are_worlds),
        cmocka_unit_test(an_engine_goes_from_worlds_to_scenes_and_back),
        cmocka_unit_test(worlds_may_go_before_the_engine),
        cmocka_unit_test(instances_alone_may_need_the_filter),
    };
    return cmocka_run_group_tests_name("fast_world", tests, NULL, NULL);
}
