/* The hard cases of worlds: an engine that cheats in one way fails the case made for it, as what it
 * is, and one that does not cheat passes all. */
#include "tests/hard/members.h"
#include "tests/hard/run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "tests/two_level/world_cheats.h"

#define KIND(wrong) (1u << WRONG_##wrong)

static const struct hard_case *case_of(unsigned number)
{
    for (size_t i = 0; hard_case_at(i); i++)
        if (hard_case_at(i)->number == number)
            return hard_case_at(i);
    fail_msg("there is no hard case %u", number);
    return NULL;
}

static void play(const struct hard_case *one, enum world_cheat cheat, enum query query,
                 struct hard_result *result)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct hard_member member = {
        .query = query, .engine = &cheating, .tri = tri_test_find("mt")};
    struct hard_stage stage = hard_stage_make(&options);
    struct reason reason = {""};
    cheater.cheat = cheat;
    if (hard_run(&stage, one, &member, result, &reason))
        fail_msg("%s", reason.text);
    hard_stage_free(&stage);
}

static void who_does_not_cheat_passes(void **state)
{
    (void)state;
    size_t cases = 0;
    for (size_t i = 0; hard_case_at(i); i++)
        for (int q = QUERY_CLOSEST; q < QUERY_COUNT && hard_case_at(i)->flags & HARD_WORLD; q++) {
            struct hard_result result;
            char text[900];
            play(hard_case_at(i), CHEAT_NONE, (enum query)q, &result);
            hard_result_print(&result, text, sizeof text);
            if (result.outcome != HARD_PASSED || result.refused || !result.played)
                fail_msg("%s %s: %s", hard_case_at(i)->name, query_name((enum query)q), text);
            cases += q == QUERY_CLOSEST;
        }
    assert_int_equal(cases, 17);
}

static const struct hard_lie {
    unsigned number;
    enum world_cheat cheat;
    uint32_t kinds; /* of WRONG that must be found */
    uint32_t also;  /* and that may be */
} hard_lies[] = {
    {101, CHEAT_CORNERS, KIND(MISSED), 0},
    {102, CHEAT_FLOAT_INVERSE, KIND(DISTANCE), KIND(MISSED) | KIND(BARYCENTRIC) | KIND(TRIANGLE)},
    {103, CHEAT_FORTH_AND_BACK, KIND(DISTANCE),
     KIND(MISSED) | KIND(BARYCENTRIC) | KIND(TRIANGLE) | KIND(PHANTOM)},
    {104, CHEAT_MIRROR, KIND(FACING) | KIND(CULLED) | KIND(MISSED), 0},
    {104, CHEAT_OTHER_FACE, KIND(FACING), 0},
    {104, CHEAT_NO_FLIP, KIND(FACING) | KIND(CULLED) | KIND(MISSED), 0},
    {104, CHEAT_NO_CULL, KIND(CULLED), 0},
    {105, CHEAT_INSTANCE_0, KIND(MISSED), 0},
    {106, CHEAT_CUT, KIND(INSTANCE), 0},
    {107, CHEAT_MASK_EQUAL, KIND(MISSED), 0},
    {107, CHEAT_NO_MASK, KIND(MASKED), 0},
    {108, CHEAT_NO_DISABLE, KIND(MISSED), 0},
    {109, CHEAT_LENGTH, KIND(DISTANCE), 0},
    {110, CHEAT_FIRST_PASSED, KIND(MISSED), 0},
    {110, CHEAT_NO_FILTER, KIND(OPACITY), 0},
    {111, CHEAT_LAST_TRANSFORM, KIND(MISSED), KIND(INSTANCE) | KIND(PHANTOM)},
    {112, CHEAT_EMPTY, KIND(PHANTOM), KIND(MASKED)},
    {113, CHEAT_COMPACT, KIND(MASKED), KIND(INSTANCE) | KIND(PHANTOM)},
    {114, CHEAT_GEOMETRY, KIND(TRIANGLE), 0},
    {115, CHEAT_EXCHANGE, KIND(INSTANCE), 0},
    {116, CHEAT_STALE, KIND(MISSED), 0},
    {117, CHEAT_NORMALS, KIND(FACING) | KIND(CULLED) | KIND(MISSED), 0},
};

static void each_cheat_fails_its_case_as_what_it_is(void **state)
{
    (void)state;
    bool met[CHEAT_HARD_COUNT] = {false};
    unsigned last = 0;
    for (size_t i = 0; i < ARRAY_COUNT(hard_lies); i++) {
        const struct hard_lie *lie = &hard_lies[i];
        struct hard_result result;
        char text[900];
        uint32_t found = 0;
        play(case_of(lie->number), lie->cheat, QUERY_CLOSEST, &result);
        hard_result_print(&result, text, sizeof text);
        print_message("%u, cheat %d: %s\n", lie->number, (int)lie->cheat, text);
        for (int w = WRONG_MISSED; w < WRONG_COUNT; w++)
            found |= result.wrong[w] ? 1u << w : 0;
        assert_int_equal(result.outcome, HARD_FAILED);
        if ((found & lie->kinds) != lie->kinds || (found & ~(lie->kinds | lie->also)))
            fail_msg("%u, cheat %d: found as %s", lie->number, (int)lie->cheat, text);
        assert_true(lie->number == last || lie->number == last + 1 || last == 0);
        last = lie->number;
        met[lie->cheat] = true;
    }
    assert_int_equal(last, 117);
    for (int c = CHEAT_COUNT; c < CHEAT_HARD_COUNT; c++)
        assert_true(met[c]);
}

/* The first thing that is broken is told with its ray. */
static void a_result_has_its_first_ray(void **state)
{
    (void)state;
    struct hard_result result;
    char text[900];
    play(case_of(106), CHEAT_CUT, QUERY_CLOSEST, &result);
    assert_int_equal(result.property, PROPERTY_VERDICT);
    assert_string_equal(result.part_label, "24 bits");
    assert_true(result.ray_index < result.rays);
    assert_true(result.got.prim != ABI_NO_PRIM);
    assert_int_equal(result.judgement.wrong, WRONG_INSTANCE);
    assert_int_equal(result.broken[PROPERTY_VERDICT], result.wrong[WRONG_INSTANCE]);
    assert_int_equal(result.broken[PROPERTY_TAG], result.wrong[WRONG_INSTANCE]);
    hard_result_print(&result, text, sizeof text);
    assert_non_null(strstr(text, "first in part 24 bits, verdict: ray"));
}

struct seen_members {
    size_t count, both;
    bool query[QUERY_COUNT];
    bool engine[POOL_MOST];
    bool layout[2];
};

static void see(void *user, const struct hard_case *one, const struct hard_member *m)
{
    struct seen_members *seen = user;
    (void)one;
    assert_non_null(m->engine->worlds);
    assert_int_equal(hard_member_published(m), 0);
    assert_int_equal(m->layout != NULL, m->engine->needs_packed);
    assert_true(!m->top || m->top != m->layout);
    seen->count++;
    seen->both += m->top != NULL;
    seen->query[m->query] = true;
    for (size_t e = 0; engines[e]; e++)
        seen->engine[e] |= engines[e] == m->engine;
    seen->layout[0] |= m->layout == layout_find("f32");
    seen->layout[1] |= m->layout == layout_find("rf16");
}

/* Every engine that traces worlds plays every case, with each query; tops of another layout too. */
static void all_that_trace_worlds_play(void **state)
{
    (void)state;
    const struct hard_tables tables = hard_tables_all();
    for (size_t i = 0; hard_case_at(i); i++) {
        struct seen_members seen = {0};
        if (!(hard_case_at(i)->flags & HARD_WORLD))
            continue;
        hard_each_member(hard_case_at(i), &tables, see, &seen);
        for (size_t e = 0; engines[e]; e++)
            assert_int_equal(seen.engine[e], engines[e]->worlds != NULL);
        for (int q = 0; q < QUERY_COUNT; q++)
            assert_true(seen.query[q]);
        assert_true(seen.both > 0 && seen.layout[0] && seen.layout[1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_does_not_cheat_passes),
        cmocka_unit_test(each_cheat_fails_its_case_as_what_it_is),
        cmocka_unit_test(a_result_has_its_first_ray),
        cmocka_unit_test(all_that_trace_worlds_play),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
