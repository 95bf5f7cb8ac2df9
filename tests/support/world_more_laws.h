/* More laws: candidates behind each other, lists, jobs one after the other, and what is no world or
 * no ray. Includes cmocka.h, whose macros must come last. */
#ifndef TESTS_WORLD_MORE_LAWS_H
#define TESTS_WORLD_MORE_LAWS_H

#include "tests/support/world_laws.h"

#define PILE 20

/* Instances of one plate that is not opaque, one behind the other: the nearest has the highest
 * number. */
static inline struct world laws_pile(void)
{
    struct world world = laws_room(1, PILE);
    laws_mesh(world.mesh, (const uint32_t[]){0, 1}, 2);
    for (uint32_t i = 0; i < PILE; i++) {
        world.instance[i] = (struct instance){
            .m = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, (float)i}}, .custom = i, .mask = 1};
        world.instance[i].mask |= 2u << i % 4;
    }
    laws_finish(&world);
    return world;
}

#define LAWS_AT 0.3125f /* u and v of its hits: inside a cell, whatever an engine's rounding */

static inline struct ray laws_down(void)
{
    return (struct ray){{LAWS_AT, LAWS_AT, PILE}, 0, {0, 0, -1}, 100};
}

/* The number of the first plate from the top that the filter passes in that mode; PILE: none. */
static inline uint32_t laws_first(const struct world *world, struct ray_mode mode, uint32_t *count)
{
    uint32_t first = PILE;
    *count = 0;
    for (uint32_t i = PILE; i-- > 0;) {
        const struct place place = world_place_in(world, i, 0);
        if (!world_meets(&world->instance[i], mode) ||
            (!world_is_opaque(&world->instance[i], false, mode) &&
             !filter_passes(&world->filter, &place, LAWS_AT, LAWS_AT)))
            continue;
        first = first == PILE ? i : first;
        ++*count;
    }
    return first;
}

/* What the filter passes over neither ends nor shortens a ray; what it passes is found, whatever
 * lies before it. */
static inline void laws_of_piles(const struct laws *laws)
{
    struct world world = laws_pile();
    uint32_t none = 0;
    for (uint32_t seed = 0; seed < 200; seed++) {
        const struct ray_mode mode = {seed % 3 ? 0xFF : 2u << seed % 4,
                                      seed % 2 ? ABI_RAY_FIRST : 0};
        const struct ray ray = laws_down();
        world.filter = (struct filter_rule){FILTER_CELLS, seed, seed % 5 * 16};
        uint32_t count, first = laws_first(&world, mode, &count);
        none += first == PILE;
        for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct hit hit;
            uint32_t tag;
            struct trace_report report;
            struct reason reason = {""};
            bool any = query == QUERY_ANY || seed % 2;
            laws_prepare(laws, &world, (enum query)query);
            if (laws->engine->worlds->trace_world(laws->self, &ray, &mode, 1, &hit, &tag, &report,
                                                  &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(hit.prim == ABI_NO_PRIM, first == PILE);
            if (first == PILE || (any && laws->unnamed))
                assert_int_equal(tag, 0);
            else if (!any)
                assert_int_equal(hit.prim, first);
            if (first != PILE && !(any && laws->unnamed)) {
                const struct place place = world_place(&world, hit.prim);
                assert_true(filter_passes(&world.filter, &place, LAWS_AT, LAWS_AT));
                assert_int_equal(tag, ABI_TAG_FRONT | hit.prim);
                assert_true(fabsf(hit.t - (float)(PILE - hit.prim)) < 1e-4f);
            }
        }
    }
    assert_true(none > 20 && none < 180);
    world_free(&world);
}

/* Lists have every hit that counts, each once; ABI_RAY_FIRST ends none; a count may be over the
 * room, and behind the room nothing is written. */
static inline void laws_of_lists(const struct laws *laws)
{
    enum { RAYS = 70, ROOM = 5 };
    struct world world = laws_pile();
    static struct hit hit[RAYS * PILE];
    static uint32_t tag[RAYS * PILE], found[RAYS];
    static struct ray ray[RAYS];
    static struct ray_mode mode[RAYS];
    struct reason reason = {""};
    const struct world_tracer *worlds = laws->engine->worlds;
    world.filter = (struct filter_rule){FILTER_TRIANGLES, 3, 160};
    for (uint32_t i = 0; i < RAYS; i++) {
        ray[i] = laws_down();
        mode[i] = (struct ray_mode){i % 3 ? 0xFF : 2u << i % 4,
                                    (i % 2 ? ABI_RAY_FIRST : 0) | (i % 5 ? 0 : ABI_RAY_OPAQUE)};
    }
    laws_prepare(laws, &world, QUERY_ALL);
    for (int short_of = 0; short_of < 2; short_of++) {
        uint32_t room = short_of ? ROOM : PILE;
        memset(tag, 0x5A, sizeof tag);
        if (worlds->trace_world_all(laws->self, ray, mode, RAYS, room, hit, tag, found, &reason))
            fail_msg("%s", reason.text);
        for (uint32_t i = 0; i < RAYS; i++) {
            uint32_t count, seen = 0;
            (void)laws_first(&world, mode[i], &count);
            assert_int_equal(found[i], count);
            for (uint32_t k = 0; k < room; k++) {
                const struct hit *h = &hit[i * room + k];
                if (k >= count) {
                    assert_int_equal(tag[i * room + k], 0x5A5A5A5A);
                    continue;
                }
                assert_true(h->prim < PILE && !(seen >> h->prim & 1));
                seen |= 1u << h->prim;
                assert_int_equal(tag[i * room + k], ABI_TAG_FRONT | h->prim);
                assert_true(fabsf(h->t - (float)(PILE - h->prim)) < 1e-4f);
            }
        }
    }
    /* With no room there are only counts; without modes every plate is met. */
    if (worlds->trace_world_all(laws->self, ray, NULL, 2, 0, NULL, NULL, found, &reason))
        fail_msg("%s", reason.text);
    uint32_t count;
    (void)laws_first(&world, ray_mode_all(), &count);
    assert_true(found[0] == count && found[1] == count && count > ROOM);
    world_free(&world);
}

static inline uint32_t laws_single(const struct laws *laws, struct ray ray, uint32_t *tag)
{
    struct hit hit = {0, 0, 0, 5};
    struct trace_report report;
    struct reason reason = {""};
    *tag = 5;
    if (laws->engine->worlds->trace_world(laws->self, &ray, NULL, 1, &hit, tag, &report, &reason))
        fail_msg("%s", reason.text);
    return hit.prim;
}

/* No rays, no instances, no triangles; a scene in between; then the first world again. */
static inline void laws_of_nothing(const struct laws *laws)
{
    struct world empty = {0}, pile = laws_pile(), idle = laws_pile();
    const struct job plain = {.scene = pile.mesh->scene, .box = box_tests[0], .tri = tri_tests[0]};
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit;
    uint32_t tag;
    for (uint32_t i = 0; i < PILE; i++)
        idle.instance[i].mask = 0;
    laws_finish(&empty);
    laws_finish(&idle);
    for (int round = 0; round < 2; round++) {
        const struct ray ray = laws_down();
        laws_prepare(laws, &pile, QUERY_CLOSEST);
        assert_int_equal(laws_single(laws, ray, &tag), PILE - 1);
        assert_int_equal(tag, ABI_TAG_FRONT | (PILE - 1));
        assert_int_equal(laws->engine->worlds->trace_world(laws->self, NULL, NULL, 0, NULL, NULL,
                                                           &report, &reason),
                         STATUS_OK);
        for (int without = 0; without < 2; without++) {
            laws_prepare(laws, without ? &empty : &idle, QUERY_CLOSEST);
            assert_int_equal(laws_single(laws, ray, &tag), ABI_NO_PRIM);
            assert_int_equal(tag, 0);
        }
        if (laws->engine->prepare(laws->self, &plain, &reason) ||
            laws->engine->trace(laws->self, &ray, 1, &hit, &report, &reason))
            fail_msg("%s", reason.text);
        assert_true(hit.prim == 0 && fabsf(hit.t - PILE) < 1e-4f);
    }
    world_free(&empty);
    world_free(&pile);
    world_free(&idle);
}

/* Rays that are none are misses, and end nothing. */
static inline void laws_of_bad_rays(const struct laws *laws)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 3e38f};
    struct world world = laws_pile();
    uint32_t tag;
    for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        laws_prepare(laws, &world, (enum query)query);
        for (int word = 0; word < 8; word++)
            for (size_t b = 0; b < ARRAY_COUNT(bad); b++) {
                const struct ray down = laws_down();
                float words[8];
                struct ray ray;
                memcpy(words, &down, sizeof words);
                words[word] = bad[b];
                memcpy(&ray, words, sizeof ray);
                bool harmless = word == 7 && bad[b] > 100; /* a tmax */
                bool found = laws_single(laws, ray, &tag) != ABI_NO_PRIM;
                assert_true(found == harmless || bad[b] == 3e38f);
            }
    }
    world_free(&world);
}

#endif
