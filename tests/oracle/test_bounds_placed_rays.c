/* Transforms as the twins see them, against rationals: the inverse and its rounding, kappa, the
 * contract of a ray in the space of the mesh. An instance at the identity has the twins of its
 * scene. */
#include "tests/exact/exact_gmp_replay.h"
#include "tests/exact/placed_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static uint64_t trials(void)
{
    return getenv("RAYDIFF_SLOW") ? 20000 : 500;
}

static double off_by(double x, const mpq_t exact)
{
    mpq_t off;
    mpq_init(off);
    mpq_set_d(off, x);
    mpq_sub(off, off, exact);
    double out = fabs(mpq_get_d(off));
    mpq_clear(off);
    return out;
}

/* Draws transforms and their inverses. */
static bool draw(struct exact_placed *placed, uint64_t i)
{
    struct rng rng = rng_make(i, 31);
    placed->trial.ray = (struct ray){{0, 0, 0}, 0, {1, 0, 0}, 1};
    placed_transform((int)(i % PLACED_KINDS), &rng, &placed->instance);
    return placed_truth(placed);
}

static void the_inverse_is_the_nearest_and_known_beyond_it(void **state)
{
    (void)state;
    struct exact_placed placed = {0};
    uint64_t numbers = 0, subnormal = 0;
    placed_init(&placed);
    for (uint64_t i = 0; i < PLACED_KINDS * trials(); i++) {
        if (!draw(&placed, i))
            continue;
        const struct twin_place *place = &placed.place;
        for (int k = 0; k < 9; k++) {
            double exact = fabs(mpq_get_d(placed.inverse[k]));
            float nearest = exact_gmp_round(placed.inverse[k]);
            assert_true(place->w[k] == nearest);
            assert_true(off_by(place->near[k], placed.inverse[k]) <= 0x1p-52 * exact);
            assert_true(off_by((double)place->w[k], placed.inverse[k]) <= place->off[k]);
            assert_true((place->off[k] == 0) ==
                        (off_by((double)place->w[k], placed.inverse[k]) == 0));
            numbers++;
            subnormal += exact > 0 && exact < 0x1p-126;
        }
    }
    placed_clear(&placed);
    print_message("%llu numbers of inverses, %llu below the normal range\n",
                  (unsigned long long)numbers, (unsigned long long)subnormal);
    assert_true(numbers > 1000 && subnormal > 100);
}

/* 24929 * 673 is 2^24 + 1, half way between two float32 numbers; 2^-100 more is beyond a double. */
static void the_inverse_is_rounded_once(void **state)
{
    (void)state;
    struct instance instance = {
        .m = {{1, 24929, -0x1p-100f, 0}, {0, 1, 673 * 0x1p-24f, 0}, {0, 0, 1, 0}}};
    struct twin_place place;
    assert_int_equal(twin_place_of(&instance, &place, NULL), STATUS_OK);
    assert_true(place.w[2] == 1 + 0x1p-23f);
    instance.m[0][2] = 0;
    assert_int_equal(twin_place_of(&instance, &place, NULL), STATUS_OK);
    assert_true(place.w[2] == 1); /* to even */
    instance.m[0][2] = 0x1p-100f;
    assert_int_equal(twin_place_of(&instance, &place, NULL), STATUS_OK);
    assert_true(place.w[2] == 1);
}

/* By rows of |M| |M^-1|, in double from rationals. */
static void kappa_is_the_norm_of_the_product_of_sizes(void **state)
{
    (void)state;
    struct exact_placed placed = {0};
    double largest = 0;
    placed_init(&placed);
    for (uint64_t i = 0; i < PLACED_KINDS * trials(); i++) {
        if (!draw(&placed, i))
            continue;
        double most = 0;
        for (int r = 0; r < 3; r++) {
            double sum = 0;
            for (int c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++)
                    sum += fabs((double)placed.instance.m[r][k]) *
                           fabs(mpq_get_d(placed.inverse[3 * k + c]));
            most = fmax(most, sum);
        }
        assert_true(fabs(placed.place.kappa - most) <= 0x1p-40 * most);
        assert_true(placed.place.kappa >= 1 - 0x1p-40);
        largest = fmax(largest, most);
    }
    placed_clear(&placed);
    assert_true(largest > 1e6); /* nearly singular ones were there */
}

static void a_number_of_the_inverse_beyond_float32_is_refused(void **state)
{
    (void)state;
    struct instance instance = {.m = {{1, 0, 0, 0}, {0, 0x1p-128f, 0, 0}, {0, 0, 1, 0}}};
    struct twin_place place;
    struct reason reason = {""};
    assert_int_equal(twin_place_of(&instance, &place, &reason), STATUS_LIMIT);
    assert_string_equal(reason.text, "row 1, column 1 of the inverse is beyond float32");
    assert_true(place.kappa == 0);
    instance.m[1][1] = 0x1.000008p-128f; /* its inverse rounds to a number */
    assert_int_equal(twin_place_of(&instance, &place, &reason), STATUS_OK);
    assert_true(place.w[4] == 0x1.fffffp+127f);
}

/* How many evaluations leave the contract where none may. */
static uint64_t left_contract(bool fuses, uint64_t *inside)
{
    struct rng rng = rng_make(9, 2);
    uint64_t left = 0;
    *inside = 0;
    for (uint64_t i = 0; i < 100 * trials(); i++) {
        struct ray ray = {{0, 0, 0}, 0, {1, 1, 1}, 1};
        struct twin_place place = {.w = {0, 0, 0, 0, 1, 0, 0, 0, 1}};
        struct twin_ray out;
        int small = -(int)rng_below(&rng, fuses ? 16 : 40);
        place.w[0] = ldexpf(2 - 0x1p-23f * (float)rng_below(&rng, 4), small);
        place.w[1] = rng_below(&rng, 2) ? place.w[0] : nextafterf(place.w[0], 0);
        ray.dir[0] = 2 - 0x1p-23f * (float)rng_below(&rng, 4);
        ray.dir[1] = -ray.dir[0];
        for (int k = 0; k < 9; k++)
            place.near[k] = (double)place.w[k];
        twin_ray_of(&place, ROUNDING_VULKAN, fuses, &ray, &out);
        *inside += out.in_contract;
        for (int n = 0; n < 4 && out.in_contract; n++) {
            struct legal legal = {.rounding = ROUNDING_VULKAN,
                                  .fuses = fuses,
                                  .style = LEGAL_RANDOM,
                                  .rng = rng_make(i, (uint64_t)n)};
            struct ray one = legal_transform(&legal, &place, &ray);
            left += !ray_in_contract(&one);
        }
    }
    return left;
}

static void rays_stay_in_contract(void **state)
{
    (void)state;
    for (int fuses = 0; fuses < 2; fuses++) {
        uint64_t inside;
        assert_int_equal(left_contract(fuses, &inside), 0);
        assert_true(inside > trials());
    }
}

/* --- identity, and many ----------------------------------------------------------------------- */

static bool same_bits(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0;
}

static void assert_alike(const struct twin *a, const struct twin *b)
{
    assert_true(a->possible == b->possible && a->certain == b->certain && a->beyond == b->beyond);
    assert_true(memcmp(a->edge, b->edge, sizeof a->edge) == 0 && a->det == b->det);
    assert_true(same_bits(a->t_err, b->t_err) && same_bits(a->u_err, b->u_err));
    assert_true(same_bits(a->v_err, b->v_err) && same_bits(a->t_near, b->t_near));
    assert_true(same_bits(a->u_near, b->u_near) && same_bits(a->v_near, b->v_near));
    assert_true(same_bits(a->t_off, b->t_off));
}

static const enum twin_formula own[] = {TWIN_MT,       TWIN_MT_RTRS,        TWIN_WOOP,
                                        TWIN_PLUECKER, TWIN_BALDWIN_WEBBER, TWIN_TRI_ACCEL};

/* Signs of zeros included: -0 in the transform is the identity, too. */
static void an_instance_at_the_identity_has_the_twins_of_its_scene(void **state)
{
    (void)state;
    struct instance instance = {.m = {{1, -0.0f, 0, -0.0f}, {0, 1, -0.0f, 0}, {0, 0, 1, 0}}};
    struct twin_place place;
    struct gmp_pair pair;
    assert_int_equal(twin_place_of(&instance, &place, NULL), STATUS_OK);
    assert_true(place.identity && place.kappa == 1);
    exact_gmp_init(&pair);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t i = 0; i < trials() / 10; i++) {
            struct trials_trial trial;
            struct twin_ray ray;
            trial_make(kind, i, &pair, &trial);
            twin_ray_of(&place, ROUNDING_VULKAN, true, &trial.ray, &ray);
            assert_memory_equal(&ray.ray, &trial.ray, sizeof ray.ray);
            assert_true(ray.in_contract == ray_in_contract(&trial.ray));
            for (size_t f = 0; f < ARRAY_COUNT(own); f++) {
                struct twin a = twin_eval(own[f], ROUNDING_VULKAN, &trial.ray, trial.v);
                struct twin b = twin_eval_placed(own[f], ROUNDING_VULKAN, &ray, trial.v);
                assert_alike(&a, &b);
                assert_memory_equal(&a.t, &b.t, sizeof a.t);
            }
        }
    exact_gmp_clear(&pair);
}

/* Runs of the identity between others, on two scenes. */
static void many_are_the_same_as_one_by_one(void **state)
{
    (void)state;
    enum { RAYS = 300 };
    static struct twin_place place[RAYS];
    static struct twin_ray ray[RAYS];
    static struct twin_placed_pair pair[RAYS];
    static struct twin twin[RAYS];
    float vertex[2][9] = {{0, 0, 4, 1, 0, 5, 0, 1, 4.5f}, {1, 0, 3, -1, 0.5f, 3, 0, -1, 4}};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene[2] = {
        {.vertex = vertex[0], .vertex_count = 3, .index = index, .tri_count = 1},
        {.vertex = vertex[1], .vertex_count = 3, .index = index, .tri_count = 1}};
    struct rng rng = rng_make(1, 1);
    for (int i = 0; i < RAYS; i++) {
        struct instance instance;
        const struct ray one = {
            {0, 0, 0}, 0, {rng_range(&rng, -1, 1), rng_range(&rng, -1, 1), 1}, INFINITY};
        placed_transform(rng_below(&rng, 3) ? 0 : 2, &rng, &instance);
        assert_int_equal(twin_place_of(&instance, &place[i], NULL), STATUS_OK);
        twin_ray_of(&place[i], ROUNDING_IEEE, false, &one, &ray[i]);
        pair[i] = (struct twin_placed_pair){&ray[i], &scene[i / 20 % 2], 0};
    }
    for (size_t f = 0; f < ARRAY_COUNT(own); f++) {
        twin_eval_placed_many(own[f], ROUNDING_IEEE, pair, RAYS, twin);
        for (int i = 0; i < RAYS; i++) {
            float v[3][3];
            scene_tri(pair[i].scene, 0, v);
            struct twin alone = twin_eval_placed(own[f], ROUNDING_IEEE, &ray[i], v);
            assert_alike(&alone, &twin[i]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_inverse_is_the_nearest_and_known_beyond_it),
        cmocka_unit_test(the_inverse_is_rounded_once),
        cmocka_unit_test(kappa_is_the_norm_of_the_product_of_sizes),
        cmocka_unit_test(a_number_of_the_inverse_beyond_float32_is_refused),
        cmocka_unit_test(rays_stay_in_contract),
        cmocka_unit_test(an_instance_at_the_identity_has_the_twins_of_its_scene),
        cmocka_unit_test(many_are_the_same_as_one_by_one),
    };
    return cmocka_run_group_tests_name("bounds_placed_rays", tests, NULL, NULL) ? 1 : 0;
}
