/* How much slack the constants of twins of placed triangles have that are not roundings. Prints the
 * table. */
static double inverse_share = 0x1p-24, inverse_least = 0x1p-150;
static double grid_rounded = 0x1p-24, grid_fused = 0x1p-48;
#define PLACED_TURNED
#define INVERSE_SHARE inverse_share
#define INVERSE_LEAST inverse_least
#define GRID_ROUNDED  grid_rounded
#define GRID_FUSED    grid_fused
#include "ref/twin/twin_place.c"
#include "ref/twin/twin_placed.c"

#include "tests/exact/placed_trials.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

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

/* --- slack ------------------------------------------------------------------------------------ */

/* The largest |w - exact| over what a constant promises. */
static double worst_inverse(bool below_normal)
{
    struct exact_placed placed = {0};
    double worst = 0;
    placed_init(&placed);
    for (uint64_t i = 0; i < PLACED_KINDS * trials(); i++) {
        if (!draw(&placed, i))
            continue;
        for (int k = 0; k < 9; k++) {
            double exact = fabs(mpq_get_d(placed.inverse[k]));
            if (exact > 0 && (exact < 0x1p-126) == below_normal)
                worst = fmax(worst, off_by((double)placed.place.w[k], placed.inverse[k]) /
                                        (below_normal ? inverse_least : inverse_share * exact));
        }
    }
    placed_clear(&placed);
    return worst;
}

static void the_inverse_s_rounding_has_this_much_slack(void **state)
{
    (void)state;
    double share = worst_inverse(false), least = worst_inverse(true);
    print_message("INVERSE_SHARE: chosen 2^-24, broke below %.4f of it; INVERSE_LEAST: chosen "
                  "2^-150, broke below %.4f of it\n",
                  share, least);
    assert_true(share <= 1 && share > 0.95);
    assert_true(least <= 1 && least > 0.95);
}

/* How small an evaluated component gets over what is promised, at least; below 1 it is broken. */
static double least_seen(bool fuses)
{
    double least = INFINITY;
    struct rng rng = rng_make(3, 5);
    for (uint64_t i = 0; i < 200 * trials(); i++) {
        struct twin_place place = {.identity = false};
        struct ray ray = {{0, 0, 0}, 0, {0, 0, 1}, 1};
        struct legal legal = {.rounding = ROUNDING_VULKAN, .fuses = fuses, .rng = rng};
        legal.style = LEGAL_RANDOM;
        float near_two = 2 - ldexpf(1, -23) * (float)(1 + rng_below(&rng, 8));
        ray.dir[0] = i % 2 ? near_two : rng_range(&rng, 1, 2);
        place.w[0] = i % 2 ? near_two : rng_range(&rng, 1, 2);
        ray.dir[1] = -ray.dir[0];
        place.w[1] = place.w[0];
        if (rng_below(&rng, 2))
            place.w[1] = nextafterf(place.w[1], rng_below(&rng, 2) ? 0 : 3);
        rng_u64(&rng);
        float seen = fabsf(legal_transform(&legal, &place, &ray).dir[0]);
        if (seen > 0)
            least = fmin(least, (double)seen / least_component(&place, &ray, 0, fuses));
    }
    return least;
}

static void the_grid_of_a_component_has_this_much_slack(void **state)
{
    (void)state;
    double rounded = least_seen(false), fused = least_seen(true);
    print_message("GRID_ROUNDED: chosen 2^-24, broke above %.3f of it; GRID_FUSED: chosen 2^-48, "
                  "broke above %.3f of it\n",
                  rounded, fused);
    assert_true(rounded >= 1 && rounded < 4);
    assert_true(fused >= 1 && fused < 4);
}

/* Whether any evaluation leaves the contract where none may, with a grid that is `factor` wider. */
static uint64_t left_contract(double factor, bool fuses, uint64_t *inside)
{
    struct rng rng = rng_make(9, 2);
    uint64_t left = 0;
    grid_rounded = 0x1p-24 * factor;
    grid_fused = 0x1p-48 * factor;
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
    grid_rounded = 0x1p-24;
    grid_fused = 0x1p-48;
    return left;
}

static void rays_would_leave_the_contract_with_a_wider_grid(void **state)
{
    (void)state;
    for (int fuses = 0; fuses < 2; fuses++) {
        uint64_t inside, all;
        assert_int_equal(left_contract(1, fuses, &inside), 0);
        assert_true(left_contract(0x1p30, fuses, &all) > 0);
        assert_true(all > inside);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_inverse_s_rounding_has_this_much_slack),
        cmocka_unit_test(the_grid_of_a_component_has_this_much_slack),
        cmocka_unit_test(rays_would_leave_the_contract_with_a_wider_grid),
    };
    return cmocka_run_group_tests_name("bounds_placed_slack", tests, NULL, NULL) ? 1 : 0;
}
