/* Law of every engine: an answer depends on its ray alone, not on how many rays a call has, where
 * in the call it stands, or how much room each has. Engines on a GPU cut calls into batches, of
 * lists at 2^22 hits and of rays at 2^18: both are passed here. */
#include "tests/support/all_hits_fixture.h"

#define ROOM_MANY 4096u /* 1024 rays a batch */
#define ROOM_FEW  32u   /* more than a ray of these scenes hits */
#define LISTED    2500u
#define TRACED    ((1u << 18) + 70000u)
#define PIECE     1000u

/* Opened, or NULL where it cannot run. */
static void *opened(const struct engine *engine)
{
    struct engine_options options = {.threads = 2, .device = -1};
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine, &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED)
        print_message("SKIP %s\n", reason.text);
    else
        stand_must(status, &reason);
    return self;
}

static int by_prim(const void *a, const void *b)
{
    const struct hit *x = a, *y = b;
    return x->prim < y->prim ? -1 : x->prim > y->prim;
}

static void list_all(const struct engine *engine, void *self, const struct fixture_stand *s,
                     uint32_t room, struct hit *hit, uint32_t *count)
{
    struct reason reason = {""};
    stand_must(engine->trace_all(self, s->ray, s->ray_count, room, hit, count, &reason), &reason);
    for (size_t i = 0; i < s->ray_count; i++)
        qsort(hit + i * room, count[i] < room ? count[i] : room, sizeof *hit, by_prim);
}

static void lists_are_the_same(const struct engine *engine, void *self,
                               const struct fixture_stand *s)
{
    struct hit *few = calloc((size_t)LISTED * ROOM_FEW, sizeof *few);
    struct hit *many = calloc((size_t)LISTED * ROOM_MANY, sizeof *many);
    uint32_t *count[2] = {calloc(LISTED, sizeof **count), calloc(LISTED, sizeof **count)};
    size_t hits = 0, beyond = 0;
    assert_true(few && many && count[0] && count[1]);
    list_all(engine, self, s, ROOM_FEW, few, count[0]);
    list_all(engine, self, s, ROOM_MANY, many, count[1]);
    for (size_t i = 0; i < LISTED; i++) {
        if (count[0][i] != count[1][i])
            fail_msg("%s: ray %zu has %u hits, and %u with more room", engine->name, i, count[0][i],
                     count[1][i]);
        assert_in_range(count[0][i], 0, ROOM_FEW);
        if (memcmp(few + i * ROOM_FEW, many + i * ROOM_MANY, count[0][i] * sizeof *few) != 0)
            fail_msg("%s: the hits of ray %zu are others with more room", engine->name, i);
        hits += count[0][i];
        beyond += i >= 1024 && count[0][i] > 0;
    }
    assert_true(hits > LISTED / 2 && beyond > 100);
    free(few);
    free(many);
    free(count[0]);
    free(count[1]);
}

static void every_engine_lists_the_same_in_several_batches(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("soup:n=200,size=0.5", "mixed", LISTED, "f32", 4);
    struct job job = stand_job(&s, "robust", "mt", QUERY_ALL);
    size_t played = 0;
    for (size_t e = 0; engines[e]; e++) {
        void *self = engines[e]->trace_all ? opened(engines[e]) : NULL;
        struct reason reason = {""};
        if (!self)
            continue;
        stand_must(engines[e]->prepare(self, &job, &reason), &reason);
        lists_are_the_same(engines[e], self, &s);
        engines[e]->close(self);
        played++;
    }
    assert_true(played >= 2);
    stand_free(&s);
}

/* Of the whole call and of a piece of it, which begins anywhere. */
static void pieces_are_the_same(const struct engine *engine, void *self,
                                const struct fixture_stand *s, enum query query)
{
    static const size_t begin[] = {0, 1, TRACED / 2, (1u << 18) - PIECE / 2, TRACED - PIECE};
    struct hit *whole = calloc(TRACED, sizeof *whole), piece[PIECE];
    struct trace_report report;
    struct reason reason = {""};
    size_t hits = 0;
    assert_non_null(whole);
    stand_must(engine->trace(self, s->ray, TRACED, whole, &report, &reason), &reason);
    for (size_t k = 0; k < ARRAY_COUNT(begin); k++) {
        stand_must(engine->trace(self, s->ray + begin[k], PIECE, piece, &report, &reason), &reason);
        for (size_t i = 0; i < PIECE; i++) {
            const struct hit *of = &whole[begin[k] + i];
            bool hit = of->prim != ABI_NO_PRIM, same = piece[i].prim == of->prim;
            hits += hit;
            if (query == QUERY_ANY ? hit != (piece[i].prim != ABI_NO_PRIM)
                                   : !same || (hit && memcmp(&piece[i], of, sizeof *of) != 0))
                fail_msg("%s: ray %zu of %u is answered otherwise in a piece", engine->name,
                         begin[k] + i, TRACED);
        }
    }
    assert_true(hits > PIECE);
    free(whole);
}

static void every_engine_answers_the_same_in_pieces(void **state)
{
    (void)state;
    struct fixture_stand s = stand_make("soup:n=12,size=1", "mixed", TRACED, "f32", 4);
    size_t played = 0;
    for (size_t e = 0; engines[e]; e++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct job job = stand_job(&s, "robust", "mt", query);
            struct reason reason = {""};
            void *self = opened(engines[e]);
            if (!self)
                continue;
            stand_must(engines[e]->prepare(self, &job, &reason), &reason);
            pieces_are_the_same(engines[e], self, &s, query);
            engines[e]->close(self);
            played++;
        }
    assert_true(played >= 6);
    stand_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_engine_lists_the_same_in_several_batches),
        cmocka_unit_test(every_engine_answers_the_same_in_pieces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
