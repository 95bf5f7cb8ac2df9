/* Answers of tracers that cheat in a world, decided again by rationals: what the judge calls WRONG
 * is confirmed, and nothing that an honest tracer answers is. */
#include "ref/judge/judge_world.h"
#include "scenes/rays/ray_modes.h"
#include "tests/exact/gmp_world_redecide.h"
#include "tests/two_level/two_level_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/two_level/world_cheats.h"
#include "tests/two_level/world_stand.h"

#define RAYS 400

static struct stand {
    struct world world;
    struct packed_world packed;
    struct oracle *oracle;
    struct ray ray[RAYS];
    struct ray_mode mode[RAYS];
    struct oracle_answer truth[RAYS];
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    size_t opinion[GMP_OVERTURNED + 1], proof[GMP_PROOF_EXCUSED + 1];
} * s;

static const struct model own = {.formula = TWIN_MT, .rounding = ROUNDING_IEEE, .bits = true},
                          unknown = {.formula = TWIN_UNKNOWN, .rounding = ROUNDING_IEEE};

static int make(void **state)
{
    (void)state;
    s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->world = fixture_everything();
    s->packed = stand_world(&s->world, "f32");
    assert_int_equal(oracle_make_world(&s->world, &s->oracle, NULL), STATUS_OK);
    ray_modes_make(RAY_MODES_DRAWN, 7, RAYS, s->mode);
    for (uint32_t i = 0; i < RAYS; i++)
        s->ray[i] = stand_aim(&s->packed, 21, i);
    assert_int_equal(oracle_closest_world(s->oracle, ORACLE_AUTO, ORACLE_CLOSED, s->ray, s->mode,
                                          RAYS, 0, s->truth, NULL, NULL),
                     STATUS_OK);
    return 0;
}

static int drop(void **state)
{
    (void)state;
    oracle_free(s->oracle);
    packed_world_free(&s->packed);
    world_free(&s->world);
    free(s);
    return 0;
}

static void trace_with(enum world_cheat cheat)
{
    cheat_answers(cheat, &s->world, QUERY_CLOSEST, s->ray, s->mode, RAYS, s->hit, s->tag);
}

static struct gmp_second decided(const struct model *model, uint32_t i)
{
    const struct gmp_world_question question = {.world = &s->world,
                                                .ray = &s->ray[i],
                                                .mode = s->mode[i],
                                                .model = model,
                                                .hit = &s->hit[i],
                                                .tag = s->tag[i]};
    return gmp_world_redecide(&question);
}

/* Decides again what the judge calls WRONG; returns how many those are. */
static size_t decide_wrong(const struct model *model, uint32_t *kinds)
{
    struct judge *judge;
    size_t wrong = 0;
    memset(s->opinion, 0, sizeof s->opinion);
    memset(s->proof, 0, sizeof s->proof);
    *kinds = 0;
    assert_int_equal(judge_make(s->oracle, model, QUERY_CLOSEST, &judge, NULL), STATUS_OK);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct judgement j;
        assert_int_equal(judge_world_answer(judge, &s->ray[i], s->mode[i], &s->truth[i], &s->hit[i],
                                            s->tag[i], &j),
                         STATUS_OK);
        if (j.verdict != VERDICT_WRONG)
            continue;
        struct gmp_second second = decided(model, i);
        s->opinion[second.opinion]++;
        s->proof[second.proof]++;
        *kinds |= 1u << j.wrong;
        wrong++;
    }
    judge_free(judge);
    return wrong;
}

static void what_cheats_answer_wrong_is_confirmed(void **state)
{
    (void)state;
    const struct model *const models[] = {&own, &unknown};
    size_t proof[GMP_PROOF_EXCUSED + 1] = {0};
    for (enum world_cheat cheat = CHEAT_NONE; cheat < CHEAT_COUNT; cheat++) {
        trace_with(cheat);
        for (size_t m = 0; m < ARRAY_COUNT(models); m++) {
            uint32_t kinds;
            size_t wrong = decide_wrong(models[m], &kinds);
            print_message("cheat %2d, %s: %3zu wrong, confirmed %zu, open %zu\n", cheat,
                          m ? "unknown" : "mt", wrong, s->opinion[GMP_CONFIRMED],
                          s->opinion[GMP_OPEN]);
            assert_int_equal(s->opinion[GMP_OVERTURNED], 0);
            assert_true(m || s->opinion[GMP_OPEN] == 0);
            assert_true(10 * s->opinion[GMP_OPEN] <= wrong);
            if (cheat == CHEAT_NONE || cheat == CHEAT_NO_FIRST)
                assert_int_equal(wrong, 0);
            for (int p = 0; p <= GMP_PROOF_EXCUSED; p++)
                proof[p] += s->proof[p];
        }
    }
    for (int p = GMP_PROOF_PHANTOM; p < GMP_PROOF_RIGHT; p++) {
        print_message("proof %d: %zu\n", p, proof[p]);
        assert_true(p == GMP_PROOF_BARYCENTRIC || proof[p] > 0);
    }
}

/* Whatever the model is; some of it is even proven to be right. */
static void nothing_honest_is_confirmed(void **state)
{
    (void)state;
    size_t overturned = 0, misses = 0, hits = 0;
    trace_with(CHEAT_NONE);
    for (uint32_t i = 0; i < RAYS; i++) {
        struct gmp_second mine = decided(&own, i), foreign = decided(&unknown, i);
        if (mine.opinion == GMP_CONFIRMED || foreign.opinion == GMP_CONFIRMED)
            fail_msg("ray %u: proofs %d and %d, triangle %u", i, mine.proof, foreign.proof,
                     foreign.prim);
        overturned += mine.opinion == GMP_OVERTURNED;
        misses += s->hit[i].prim == ABI_NO_PRIM;
        hits += s->hit[i].prim != ABI_NO_PRIM;
    }
    print_message("%zu hits, %zu misses; right by rationals: %zu\n", hits, misses, overturned);
    assert_true(hits > 50 && misses > 50 && overturned > misses / 2 + 5);
}

/* An answer that only its numbers spoil: t by a unit in its last place of an engine whose bits are
 * promised, by much of others. */
static void numbers_are_decided_by_value(void **state)
{
    (void)state;
    size_t tried = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        trace_with(CHEAT_NONE);
        if (s->hit[i].prim == ABI_NO_PRIM || (s->mode[i].flags & ABI_RAY_FIRST))
            continue;
        const struct hit right = s->hit[i];
        s->hit[i].t = nextafterf(right.t, INFINITY);
        assert_int_equal(decided(&own, i).opinion, GMP_CONFIRMED);
        s->hit[i].t = right.t * 1.001f;
        assert_int_equal(decided(&own, i).opinion, GMP_CONFIRMED);
        tried += decided(&unknown, i).opinion == GMP_CONFIRMED;
        s->hit[i].t = right.t;
        s->hit[i].u = right.u > 0.5f ? right.u - 0.25f : right.u + 0.25f;
        assert_int_equal(decided(&own, i).proof, GMP_PROOF_BARYCENTRIC);
        s->hit[i].u = nanf("");
        assert_int_equal(decided(&own, i).proof, GMP_PROOF_NOT_FINITE);
        s->hit[i] = right;
        s->hit[i].prim = world_tri_count(&s->world);
        assert_int_equal(decided(&unknown, i).proof, GMP_PROOF_NO_TRIANGLE);
        if (tried > 20)
            break;
    }
    assert_true(tried > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(what_cheats_answer_wrong_is_confirmed, make, drop),
        cmocka_unit_test_setup_teardown(nothing_honest_is_confirmed, make, drop),
        cmocka_unit_test_setup_teardown(numbers_are_decided_by_value, make, drop),
    };
    return cmocka_run_group_tests_name("world_redecide", tests, NULL, NULL);
}
