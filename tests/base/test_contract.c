/* The numbers of docs/verdicts.md, A8, are those at which ray_in_contract and the judge turn, found
 * by asking them. Run from the root of the sources. */
#include "ref/judge/judge.h"
#include "ref/primitives/primitives.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST (-140)
#define MOST  127

/* Whether what is asked about stays in the contract with this power of two in it. */
typedef bool probe_fn(float x);

static bool direction_of(float x)
{
    const struct ray ray = {{0, 0, 0}, 0, {x, 0, 0}, INFINITY};
    return ray_in_contract(&ray);
}

static bool share_of(float x)
{
    const struct ray ray = {{0, 0, 0}, 0, {1, -x, 0}, INFINITY};
    return ray_in_contract(&ray);
}

static bool origin_of(float x)
{
    const struct ray ray = {{0, x, 0}, 0, {1, 0, 0}, INFINITY};
    return ray_in_contract(&ray);
}

static bool coordinate_of(float x)
{
    float vertex[9] = {-1, -1, 1, 1, -1, 1, 0, 1, x};
    uint32_t index[3] = {0, 1, 2};
    const struct scene scene = {
        .vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    const struct ray ray = {{5, 5, 5}, 0, {0, 0, 1}, INFINITY};
    const struct model model = {.formula = TWIN_MT, .rounding = ROUNDING_IEEE};
    const struct oracle_answer truth = {.prim = ABI_NO_PRIM};
    const struct hit miss = {.prim = ABI_NO_PRIM};
    struct oracle *oracle;
    struct judge *judge;
    struct judgement judgement;
    struct reason reason;
    assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
    assert_int_equal(judge_make(oracle, &model, QUERY_CLOSEST, &judge, &reason), 0);
    assert_int_equal(judge_answer(judge, &ray, &truth, &miss, &judgement), STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    return judgement.verdict != VERDICT_OUT_OF_CONTRACT;
}

/* The exponent of the last power of two, from 1 downward or upward, with which it does; one more
 * ulp and it does not. */
static int turns_at(probe_fn *probe, int step)
{
    int power = 0;
    assert_true(probe(1));
    while (power + step >= LEAST && power + step <= MOST && probe(ldexpf(1, power + step)))
        power += step;
    assert_false(probe(nextafterf(ldexpf(1, power), step > 0 ? INFINITY : 0)));
    return power;
}

/* The exponents "2^N" of the paragraph, in their order. */
static size_t told(int *power, size_t most)
{
    static char text[1 << 20];
    FILE *file = fopen("docs/verdicts.md", "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = 0;
    fclose(file);
    char *at = strstr(text, "- **A8 `out_of_contract`**");
    assert_non_null(at);
    char *end = strstr(at, "\n\n");
    assert_non_null(end);
    *end = 0;
    size_t count = 0;
    while ((at = strstr(at, "2^")) != NULL && count < most)
        power[count++] = (int)strtol(at + 2, &at, 10);
    return count;
}

static void the_page_tells_where_the_contract_ends(void **state)
{
    (void)state;
    const int expected[] = {turns_at(direction_of, -1), turns_at(direction_of, 1),
                            turns_at(share_of, -1), turns_at(origin_of, 1),
                            turns_at(coordinate_of, 1)};
    int power[16];
    assert_int_equal(told(power, 16), ARRAY_COUNT(expected));
    for (size_t i = 0; i < ARRAY_COUNT(expected); i++)
        if (power[i] != expected[i])
            fail_msg("number %zu of docs/verdicts.md, A8, is 2^%d: the code has 2^%d", i, power[i],
                     expected[i]);
}

/* What has no number: all of it is in the paragraph's words. */
static void the_other_rules(void **state)
{
    (void)state;
    const struct ray good = {{0, 0, 0}, 0, {1, 0, 0}, INFINITY};
    struct ray ray = good;
    assert_true(ray_in_contract(&ray));
    ray.tmin = ray.tmax = 1;
    assert_true(ray_in_contract(&ray));
    ray.tmin = nextafterf(1, 2);
    assert_false(ray_in_contract(&ray));
    ray = good, ray.tmin = INFINITY;
    assert_false(ray_in_contract(&ray));
    ray = good, ray.tmin = -0x1p-149f;
    assert_false(ray_in_contract(&ray));
    ray = good, ray.tmax = NAN;
    assert_false(ray_in_contract(&ray));
    ray = good, ray.dir[0] = 0;
    assert_false(ray_in_contract(&ray));
    for (int k = 0; k < 3; k++) {
        ray = good, ray.org[k] = NAN;
        assert_false(ray_in_contract(&ray));
        ray = good, ray.dir[k] = -INFINITY;
        assert_false(ray_in_contract(&ray));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_page_tells_where_the_contract_ends),
        cmocka_unit_test(the_other_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
