/* The numbers of docs/verdicts.md, A8, are those at which ray_in_contract and the judge turn, found
 * by asking them. Run from the root of the sources. */
#include "ref/judge/judge_world.h"
#include "ref/primitives/primitives.h"
#include "ref/world/world.h"

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

/* How a coordinate of a world comes about, on which axis and side, and in which of two instances.
 */
enum far_by { MESH, MOVED, SCALED, TURNED, MOVED_AND_SCALED, CAUSES };
static struct {
    enum far_by cause;
    uint32_t axis, instance;
    float sign;
} made;

/* The triangle is flat on the axis that it is moved along, else one of its corners has a 1 there.
 */
static void place_at(float x, float vertex[9], float m[3][4])
{
    const uint32_t k = made.axis, from = made.cause == TURNED ? (k + 1) % 3 : k;
    vertex[from] = made.cause == MOVED ? 0 : made.cause == MESH ? x * made.sign : 1;
    for (uint32_t i = 0; i < 3; i++)
        m[i][made.cause == TURNED ? (i + 1) % 3 : i] = 1;
    if (made.cause == MOVED_AND_SCALED)
        x /= 2;
    if (made.cause != MESH)
        m[k][made.cause == MOVED ? 3 : from] = x * made.sign;
    if (made.cause == MOVED_AND_SCALED)
        m[k][3] = x * made.sign;
}

/* Two instances of a mesh, one of them far away, and a third without a mesh that is farther. */
static void far_world(float x, struct scene *scene, struct world *out)
{
    struct reason reason;
    assert_int_equal(scene_make(3, 1, scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++)
        scene->index[c] = c;
    scene->vertex[3 + (made.axis + 1) % 3] = scene->vertex[6 + (made.axis + 2) % 3] = 0.5f;
    assert_int_equal(world_of_scene(scene, out, &reason), STATUS_OK);
    struct instance *instance = calloc(3, sizeof *instance);
    assert_non_null(instance);
    for (uint32_t i = 0; i < 3; i++) {
        instance[i] = (struct instance){.mask = 0xFF, .mesh = i < 2 ? 0 : WORLD_NO_MESH};
        for (int k = 0; k < 3 && i != made.instance; k++)
            instance[i].m[k][k] = 1;
    }
    instance[2].m[made.axis][3] = 0x1p100f;
    place_at(x, scene->vertex, instance[made.instance].m);
    free(out->instance);
    free(out->first);
    out->instance = instance;
    out->instance_count = 3;
    out->first = NULL;
    assert_int_equal(world_finish(out, &reason), STATUS_OK);
}

static bool placed_of(float x)
{
    const struct ray ray = {{5, 5, 5}, 0, {0, 0, 1}, INFINITY};
    const struct model model = {.formula = TWIN_MT, .rounding = ROUNDING_IEEE};
    const struct oracle_answer truth = {.prim = ABI_NO_PRIM};
    const struct hit miss = {.prim = ABI_NO_PRIM};
    struct scene scene;
    struct world world;
    struct oracle *oracle;
    struct judge *judge;
    struct judgement judgement;
    struct reason reason;
    far_world(x, &scene, &world);
    assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
    assert_int_equal(judge_make(oracle, &model, QUERY_CLOSEST, &judge, &reason), STATUS_OK);
    assert_int_equal(judge_world_answer(judge, &ray, ray_mode_all(), &truth, &miss, 0, &judgement),
                     STATUS_OK);
    judge_free(judge);
    oracle_free(oracle);
    world_free(&world);
    scene_free(&scene);
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

/* Whatever moves it there, and whichever instance it is. */
static void a_coordinate_of_a_world_is_that_where_it_is_placed(void **state)
{
    (void)state;
    const int scene = turns_at(coordinate_of, 1);
    for (made.cause = 0; made.cause < CAUSES; made.cause++)
        for (made.axis = 0; made.axis < 3; made.axis++)
            for (made.instance = 0; made.instance < 2; made.instance++)
                for (made.sign = -1; made.sign <= 1; made.sign += 2) {
                    const int world = turns_at(placed_of, 1);
                    if (world != scene)
                        fail_msg("cause %d, axis %u, instance %u, sign %g: 2^%d, in a scene 2^%d",
                                 (int)made.cause, made.axis, made.instance, (double)made.sign,
                                 world, scene);
                }
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
        cmocka_unit_test(a_coordinate_of_a_world_is_that_where_it_is_placed),
        cmocka_unit_test(the_other_rules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
