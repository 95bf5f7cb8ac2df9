/* Changes of the shrinker's passes over single numbers: which of them change together, and to what;
 * rounding by the functions of libm. */
#include "tests/worlds/trial_numbers.h"

/* --- rounding --------------------------------------------------------------------------------- */

/* With `kept` significant bits. */
static double with_bits(double x, int kept)
{
    int exponent = ilogb(x);
    return ldexp(round(ldexp(x, kept - 1 - exponent)), exponent - kept + 1);
}

/* Without (with twice) the last bit that it has, if it is no power of two. */
static double last_bit(double x, double sign)
{
    int at = ilogb(x) - 23;
    while (fmod(x, ldexp(1, at + 1)) == 0)
        at++;
    return at == ilogb(x) ? x : x + copysign(ldexp(sign, at), sign * x);
}

static float rounded_by_hand(float number, uint32_t variant, bool tmax)
{
    static const int kept[] = {2, 3, 4, 5, 6, 8, 10, 11, 12, 14, 17, 20};
    double x = (double)number;
    if (variant == 0)
        return tmax ? INFINITY : 0.0f;
    if (variant < 4)
        return variant == 1 ? 1.0f : variant == 2 ? -1.0f : fabsf(number);
    if (x == 0 || isinf(x))
        return number;
    int e = ilogb(x);
    if (variant >= 10 && variant < 22)
        return (float)with_bits(x, kept[variant - 10]);
    switch (variant) {
    case 4: /* the power of two below */
        return (float)copysign(ldexp(1, e), x);
    case 5: /* above */
        return (float)copysign(exp2(ceil(log2(fabs(x)))), x);
    case 6:
        return (float)ldexp(x, -e);
    case 7:
        return (float)ldexp(x, (int)trunc(e / 2.0) - e);
    case 8:
        return (float)ldexp(x, e > 0 ? -1 : e < 0);
    case 9:
        return fabs(x) < 0x1p23 ? (float)round(x) : number;
    default:
        return (float)last_bit(x, variant == 22 ? -1 : 1);
    }
}

static void numbers_are_rounded_as_told(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("numbers");
    struct rng rng = rng_make(3, 0);
    assert_int_equal(pass->variants, 24);
    for (int n = 0; n < 400; n++) {
        struct fuzz_trial was = draw(0, 1);
        struct number of[NUMBERS];
        uint32_t count = numbers_of(&was, of);
        for (uint32_t i = 0; i < count; i++)
            *of[i].x = (rng_below(&rng, 2) ? -1.0f : 1.0f) * rng_scaled(&rng, 1, 2, -40, 80);
        assert_int_equal(pass->things(&was), count);
        uint32_t first = rng_below(&rng, count), row = 1 + rng_below(&rng, count - first);
        for (uint32_t variant = 0; variant < 24; variant++) {
            struct fuzz_trial is = copy_of(&was), want = copy_of(&was);
            numbers_of(&want, of);
            for (uint32_t i = first; i < first + row; i++)
                *of[i].x = rounded_by_hand(*of[i].x, variant, of[i].role == TMAX);
            assert_true(pass->change(&is, first, row, variant));
            compare(&is, &want, 0, "numbers", first, variant);
            fuzz_trial_free(&is);
            fuzz_trial_free(&want);
        }
        fuzz_trial_free(&was);
    }
}

/* --- numbers that change together ------------------------------------------------------------- */

/* Of one size, of transforms both or not; `plane`: places on one axis. */
static bool together(const struct number *a, const struct number *b, bool plane)
{
    bool same = fabsf(*a->x) == fabsf(*b->x) && (a->role == TRANSFORM) == (b->role == TRANSFORM);
    return same && (!plane || (a->axis == b->axis && a->role <= ORG && b->role <= ORG));
}

static void equal_numbers_change_together(void **state)
{
    (void)state;
    for (uint64_t index = 0; index < TRIALS; index++)
        for (int plane = 0; plane < 2; plane++) {
            const struct shrink_pass *pass = pass_of(plane ? "planes" : "values");
            struct fuzz_trial was = draw(index, RAYS_MOST);
            struct number of[NUMBERS], to[NUMBERS];
            uint32_t n = numbers_of(&was, of);
            assert_int_equal(pass->things(&was), n);
            for (uint32_t first = 0; first < n; first++)
                for (uint32_t variant = 0; variant < pass->variants; variant++) {
                    struct fuzz_trial is = copy_of(&was), want = copy_of(&was);
                    uint32_t before = 0, behind = 0;
                    numbers_of(&want, to);
                    for (uint32_t i = 0; i < n; i++)
                        if (i == first || together(&of[i], &of[first], plane)) {
                            *to[i].x = rounded_by_hand(*to[i].x, variant, of[i].role == TMAX);
                            before += i < first;
                            behind += i > first;
                        }
                    bool changes = before == 0 && behind > 0;
                    assert_int_equal(pass->change(&is, first, 1, variant), changes);
                    if (changes)
                        compare(&is, &want, 0, pass->name, first, variant);
                    fuzz_trial_free(&is);
                    fuzz_trial_free(&want);
                }
            fuzz_trial_free(&was);
        }
}

/* A coordinate is rounded, and the ray moves along its axis: by as much, a half or a quarter. */
static void a_coordinate_carries_the_ray(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("carrying");
    assert_int_equal(pass->variants, 3 * 24);
    for (uint64_t index = 0; index < TRIALS; index++) {
        struct fuzz_trial was = draw(index, 1), two = draw(index, 2);
        assert_int_equal(pass->things(&was), 3 * VERTICES);
        assert_int_equal(pass->things(&two), 0); /* of one ray alone */
        for (uint32_t first = 0; first < 3 * VERTICES; first++)
            for (uint32_t variant = 0; variant < pass->variants; variant++) {
                struct fuzz_trial is = copy_of(&was), want = copy_of(&was);
                float *x = &want.scene.vertex[first], old = *x;
                *x = rounded_by_hand(old, variant / 3, false);
                want.ray[0].org[first % 3] += (*x - old) / (float)(1u << variant % 3);
                assert_true(pass->change(&is, first, 1, variant));
                compare(&is, &want, 0, "carrying", first, variant);
                fuzz_trial_free(&is);
                fuzz_trial_free(&want);
            }
        fuzz_trial_free(&was);
        fuzz_trial_free(&two);
    }
}

/* Of one axis, or of all: whole numbers from 0 on without a gap, in the order that there was. */
static void ranks_keep_the_order(void **state)
{
    (void)state;
    const struct shrink_pass *pass = pass_of("ranks");
    assert_int_equal(pass->variants, 4);
    for (uint64_t index = 0; index < TRIALS; index++)
        for (uint32_t variant = 0; variant < 4; variant++) {
            struct fuzz_trial was = draw(index, 1), is = copy_of(&was);
            const float *from = was.scene.vertex, *to = is.scene.vertex;
            assert_true(pass->change(&is, 0, 1, variant));
            for (uint32_t i = 0; i < 3 * VERTICES; i++) {
                bool ranked = variant == 3 || variant == i % 3, below = to[i] == 0;
                for (uint32_t j = i % 3; j < 3 * VERTICES; j += 3) {
                    assert_int_equal(from[i] < from[j], to[i] < to[j]);
                    assert_int_equal(from[i] == from[j], to[i] == to[j]);
                    below = below || to[j] == to[i] - 1;
                }
                assert_true(ranked ? below && to[i] >= 0 : to[i] == from[i]);
            }
            memcpy(is.scene.vertex, from, 12 * VERTICES);
            compare(&is, &was, 0, "ranks", 0, variant);
            fuzz_trial_free(&was);
            fuzz_trial_free(&is);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_rounded_as_told),
        cmocka_unit_test(equal_numbers_change_together),
        cmocka_unit_test(a_coordinate_carries_the_ray),
        cmocka_unit_test(ranks_keep_the_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
