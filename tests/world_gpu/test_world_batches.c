/* Law of every engine that traces worlds: an answer depends on its ray and that ray's mask and
 * flags alone, wherever in a call it stands. Engines on a GPU cut calls into batches of some
 * thousand rays, others into pieces for threads. */
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

#include "tests/two_level/world_stand.h"

#define RAYS  20000u
#define PIECE 900u
#define ROOM  24u /* hits of a ray that are kept */

static struct world world;
static struct packed_world packed;
static struct ray rays[RAYS];
static struct ray_mode modes[RAYS];

/* What the engine has for a call: a hit a ray, or a list. */
struct piece_answers {
    struct hit *hit;
    uint32_t *tag, *count;
};

static int make(void **state)
{
    static const uint32_t flags[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT, ABI_RAY_OPAQUE,
                                     ABI_RAY_CULL_OPAQUE};
    (void)state;
    world = fixture_room(1, 12);
    fixture_mesh(&world, 0, "soup:n=40,size=0.6", 3);
    for (uint32_t i = 0; i < 12; i++) {
        fixture_transform(WORLD_TURNED, 60 + i, world.instance[i].m);
        world.instance[i].mask = 1u << i % 8;
        world.instance[i].flags = i % 4;
    }
    fixture_finish(&world);
    packed = stand_world(&world, "f32");
    for (uint32_t i = 0; i < RAYS; i++) {
        rays[i] = stand_aim(&packed, 1, i);
        modes[i] = (struct ray_mode){i * 2654435761u >> 24, flags[i * 40503u >> 8 & 3]};
    }
    return 0;
}

static int drop(void **state)
{
    (void)state;
    packed_world_free(&packed);
    world_free(&world);
    return 0;
}

static struct piece_answers answers_for(size_t count, bool lists)
{
    const size_t each = lists ? ROOM : 1;
    struct piece_answers a = {calloc(count * each, sizeof *a.hit),
                              calloc(count * each, sizeof *a.tag), calloc(count, sizeof *a.count)};
    assert_true(a.hit && a.tag && a.count);
    return a;
}

static void answers_free(struct piece_answers *a)
{
    free(a->hit);
    free(a->tag);
    free(a->count);
}

static void ask(const struct engine *engine, void *self, enum query query, size_t first,
                size_t count, struct piece_answers *out)
{
    struct reason reason = {""};
    struct trace_report report;
    enum status status =
        query == QUERY_ALL
            ? engine->worlds->trace_world_all(self, rays + first, modes + first, count, ROOM,
                                              out->hit, out->tag, out->count, &reason)
            : engine->worlds->trace_world(self, rays + first, modes + first, count, out->hit,
                                          out->tag, &report, &reason);
    if (status)
        fail_msg("%s: %s", engine->name, reason.text);
}

static bool is_listed(const struct piece_answers *a, size_t ray, const struct hit *hit,
                      uint32_t tag)
{
    for (uint32_t k = 0; k < a->count[ray]; k++)
        if (memcmp(&a->hit[ray * ROOM + k], hit, sizeof *hit) == 0 && a->tag[ray * ROOM + k] == tag)
            return true;
    return false;
}

/* Ray `i` of a piece against the same one, `of`, of the whole call. */
static bool same(enum query query, const struct piece_answers *piece, size_t i,
                 const struct piece_answers *whole, size_t of)
{
    const struct hit *a = &piece->hit[i], *b = &whole->hit[of];
    if (query == QUERY_ANY)
        return (a->prim == ABI_NO_PRIM) == (b->prim == ABI_NO_PRIM);
    if (query == QUERY_CLOSEST)
        return a->prim == b->prim && piece->tag[i] == whole->tag[of] &&
               (a->prim == ABI_NO_PRIM || memcmp(a, b, sizeof *a) == 0);
    if (piece->count[i] != whole->count[of])
        return false;
    for (uint32_t k = 0; k < piece->count[i]; k++)
        if (!is_listed(whole, of, &piece->hit[i * ROOM + k], piece->tag[i * ROOM + k]))
            return false;
    return true;
}

static void pieces_are_the_same(const struct engine *engine, void *self, enum query query)
{
    static const size_t begin[] = {0,           1, 4096 - PIECE / 2, 8192 - 3, 16384 - PIECE / 2,
                                   RAYS - PIECE};
    struct piece_answers whole = answers_for(RAYS, query == QUERY_ALL);
    struct piece_answers piece = answers_for(PIECE, query == QUERY_ALL);
    size_t hits = 0;
    ask(engine, self, query, 0, RAYS, &whole);
    for (size_t k = 0; k < ARRAY_COUNT(begin); k++) {
        ask(engine, self, query, begin[k], PIECE, &piece);
        for (size_t i = 0; i < PIECE; i++) {
            if (!same(query, &piece, i, &whole, begin[k] + i))
                fail_msg("%s: ray %zu of %u is answered otherwise in a piece", engine->name,
                         begin[k] + i, RAYS);
            hits += query == QUERY_ALL ? whole.count[begin[k] + i] > 0
                                       : whole.hit[begin[k] + i].prim != ABI_NO_PRIM;
        }
    }
    assert_true(hits > PIECE);
    answers_free(&whole);
    answers_free(&piece);
}

static void every_engine_answers_worlds_the_same_in_pieces(void **state)
{
    (void)state;
    size_t played = 0;
    for (size_t e = 0; engines[e]; e++)
        for (int query = QUERY_CLOSEST; query <= QUERY_ALL && engines[e]->worlds; query++) {
            struct engine_options options = {.threads = 2, .device = -1};
            struct world_job job = stand_job(&world, &packed, (enum query)query);
            struct reason reason = {""};
            void *self;
            enum status status = engine_open(engines[e], &options, &self, &reason);
            if (status == STATUS_UNSUPPORTED) {
                print_message("SKIP %s\n", reason.text);
                break;
            }
            if (!status && !engines[e]->needs_packed)
                job.packed = NULL;
            if (!status)
                status = engines[e]->worlds->prepare_world(self, &job, &reason);
            if (status)
                fail_msg("%s: %s", engines[e]->name, reason.text);
            pieces_are_the_same(engines[e], self, (enum query)query);
            engines[e]->close(self);
            played++;
        }
    assert_true(played >= 9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_engine_answers_worlds_the_same_in_pieces),
    };
    return cmocka_run_group_tests(tests, make, drop);
}
