/* The traversal of worlds does what ref/trace/trace_world.h says, in that order: hits, tags, lists
 * and counts are those of a walk by calls through both levels, for every box test and triangle
 * test. */
#include "ref/trace/trace_world.h"
#include "ref/two_level/braid.h"
#include "ref/world/object_ray.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/support/walk_by_call.h"
#include "tests/two_level/braid_stand.h"

#define RAYS  40u
#define LISTS 4u

static struct world world;
static struct ray ray[RAYS];
static struct ray_mode modes[RAYS];

/* Both levels; the top is the first member, so that it leads to the whole. */
struct called_world {
    struct called top, bottom;
    const struct world_job *job;
    const struct ray *ray;
    struct ray_mode mode;
};

static void enter_instances(struct called *top, const struct wide *leaf)
{
    struct called_world *both = (struct called_world *)top;
    struct called *bottom = &both->bottom;
    const struct packed_world *packed = both->job->packed;
    for (uint32_t slot = 0; slot < leaf->item_count && !top->ended; slot++) {
        const uint32_t entry = packed_item(&packed->top, leaf, slot);
        const struct instance_record *record = &packed->record[entry];
        const struct instance_at at = {.world = &world,
                                       .record = record,
                                       .index = packed->instance[entry],
                                       .mode = both->mode};
        const struct job job = {.scene = world_scene(&world, at.index),
                                .packed = &packed->bottom[record->mesh],
                                .box = both->job->box,
                                .tri = both->job->tri,
                                .query = top->job->query};
        if (!world_meets(&world.instance[at.index], both->mode))
            continue;
        struct ray inside = transform_ray(record, both->ray);
        bottom->at = &at;
        bottom->best = top->best;
        bottom->tbest = top->tbest;
        called_tree(bottom, &job, &inside);
        top->best = bottom->best;
        top->tbest = bottom->tbest;
        top->ended = bottom->ended;
    }
}

static void walk_world_by_call(const struct world_job *job, const struct ray *of,
                               struct ray_mode mode, enum query query, struct called_world *both)
{
    const struct job top = {.packed = &job->packed->top, .box = job->box, .query = query};
    memset(both, 0, sizeof *both);
    both->job = job;
    both->ray = of;
    both->mode = mode;
    both->top.best = hit_none();
    both->top.tbest = of->tmax;
    both->top.enter = enter_instances;
    both->top.wider = braid_width(job->packed->share, job->packed->reach, of->org);
    called_tree(&both->top, &top, of);
}

static void expect_counts(const struct trace_counts *got, const struct called_world *want)
{
    assert_int_equal(got->boxes, 7 + want->top.counts.boxes + want->bottom.counts.boxes);
    assert_int_equal(got->tris, 9 + want->bottom.counts.tris);
}

static void expect_list(const struct world_job *job, uint32_t i)
{
    static struct called_world want;
    walk_world_by_call(job, &ray[i], modes[i], QUERY_ALL, &want);
    for (uint32_t room = 0; room <= LISTS; room++) {
        struct trace_counts counts = {7, 9};
        struct hit list[LISTS + 1];
        uint32_t tags[LISTS + 1], count = 77, found = want.bottom.found;
        uint32_t kept = found < room ? found : room;
        memset(list, 0x5A, sizeof list);
        memset(tags, 0x5A, sizeof tags);
        assert_int_equal(trace_world_ray_all(job, &ray[i], modes[i], room, room ? list : NULL,
                                             room ? tags : NULL, &count, room ? &counts : NULL),
                         STATUS_OK);
        assert_int_equal(count, found);
        assert_memory_equal(list, want.bottom.list, kept * sizeof *list);
        assert_memory_equal(tags, want.bottom.tags, kept * sizeof *tags);
        assert_true(list[kept].prim == 0x5A5A5A5A && tags[kept] == 0x5A5A5A5A);
        if (room)
            expect_counts(&counts, &want);
    }
}

/* Returns how many rays hit. */
static uint32_t expect_rays(const struct world_job *job)
{
    uint32_t hits = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        static struct called_world want;
        struct trace_counts counts = {7, 9};
        struct hit hit;
        uint32_t tag = 7;
        if (job->query == QUERY_ALL) {
            expect_list(job, i);
            continue;
        }
        bool first = modes[i].flags & ABI_RAY_FIRST;
        walk_world_by_call(job, &ray[i], modes[i], first ? QUERY_ANY : job->query, &want);
        assert_int_equal(trace_world_ray(job, &ray[i], modes[i], &hit, &tag, &counts), STATUS_OK);
        assert_memory_equal(&hit, &want.top.best, sizeof hit);
        assert_int_equal(tag, want.bottom.tag);
        expect_counts(&counts, &want);
        hits += hit.prim != ABI_NO_PRIM;
    }
    return hits;
}

static void expect_world(const struct packed_world *packed)
{
    for (uint32_t b = 0; box_tests[b]; b++)
        for (uint32_t t = 0; tri_tests[t]; t++)
            for (int query = QUERY_CLOSEST; query <= QUERY_ALL; query++) {
                const struct world_job job = {.world = &world,
                                              .packed = packed,
                                              .box = box_tests[b],
                                              .tri = tri_tests[t],
                                              .query = (enum query)query};
                uint32_t hits = expect_rays(&job);
                assert_true(query == QUERY_ALL || (hits > RAYS / 4 && hits < RAYS));
            }
}

static void both_levels_are_walked_in_order(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "f32", "cwbvh80"};
    world = fixture_everything();
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        struct packed_world packed =
            l ? stand_world(&world, names[l]) : braid_world(&world, "median", names[l], 4);
        packed.share = l == 1 ? 0.01f : packed.share; /* boxes that are wider are met more often */
        for (uint32_t i = 0; i < RAYS; i++) {
            ray[i] = stand_aim(&packed, 1, i);
            modes[i] = (struct ray_mode){i % 7 ? 0xFF : i, i % 3 ? 0 : ABI_RAY_CULL_BACK};
            modes[i].flags |= i % 4 == 1 ? ABI_RAY_FIRST : 0;
        }
        expect_world(&packed);
        packed_world_free(&packed);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(both_levels_are_walked_in_order),
    };
    return cmocka_run_group_tests_name("world_order", tests, NULL, NULL);
}
