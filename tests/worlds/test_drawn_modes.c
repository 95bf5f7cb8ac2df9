/* What rays may meet of a world, drawn: legal, everything legal, each by its number alone. */
#include "scenes/rays/ray_modes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define MANY 40000u

static struct ray_mode mode[MANY], other[MANY];

static bool is_all(struct ray_mode m)
{
    return m.mask == 0xFF && m.flags == 0;
}

static void every_mode_is_legal(void **state)
{
    (void)state;
    for (int modes = 0; modes < RAY_MODES_COUNT; modes++)
        for (uint64_t seed = 0; seed < 3; seed++) {
            ray_modes_make((enum ray_modes)modes, seed, MANY, mode);
            for (uint32_t i = 0; i < MANY; i++) {
                struct reason reason = {""};
                if (ray_mode_check(mode[i], &reason))
                    fail_msg("%u: mask %x flags %x: %s", i, mode[i].mask, mode[i].flags,
                             reason.text);
            }
        }
}

/* All that ray_mode_check takes: with every set of flags, with every mask. */
static void everything_legal_occurs(void **state)
{
    (void)state;
    static bool flags[ABI_RAY_FLAGS + 1], masks[256];
    uint32_t legal = 0, bits[8] = {0}, whole = 0;
    for (uint64_t seed = 0; seed < 20; seed++) {
        ray_modes_make(RAY_MODES_DRAWN, seed, MANY, mode);
        for (uint32_t i = 0; i < MANY; i++) {
            flags[mode[i].flags] = true;
            masks[mode[i].mask] = true;
            whole += mode[i].mask == 0xFF;
            for (int b = 0; b < 8; b++)
                bits[b] += mode[i].mask == 1u << b;
        }
    }
    for (uint32_t f = 0; f <= ABI_RAY_FLAGS; f++) {
        const bool takes = ray_mode_check((struct ray_mode){0xFF, f}, NULL) == STATUS_OK;
        if (takes != flags[f])
            fail_msg("flags %x are %slegal, and drawn is %d", f, takes ? "" : "not ", flags[f]);
        legal += takes;
    }
    assert_int_equal(legal, 5 * 4 * 2 * 2); /* opacity, facing or skipping, first, no shader */
    for (uint32_t m = 0; m < 256; m++)
        assert_true(masks[m]);
    assert_in_range(whole, 20 * MANY * 45 / 100, 20 * MANY * 55 / 100);
    for (int b = 0; b < 8; b++)
        assert_in_range(bits[b], 20 * MANY * 28 / 1000, 20 * MANY * 36 / 1000);
}

static void a_mode_depends_on_seed_and_number_alone(void **state)
{
    (void)state;
    for (int modes = 0; modes < RAY_MODES_COUNT; modes++) {
        uint32_t same = 0;
        ray_modes_make((enum ray_modes)modes, 5, MANY, mode);
        memset(other, 0x5A, sizeof other);
        ray_modes_make((enum ray_modes)modes, 5, 100, other);
        assert_memory_equal(mode, other, 100 * sizeof *mode);
        assert_int_equal(other[100].mask, 0x5A5A5A5A); /* as many as there is room for */
        ray_modes_make((enum ray_modes)modes, 6, MANY, other);
        for (uint32_t i = 0; i < MANY; i++)
            same += mode[i].mask == other[i].mask && mode[i].flags == other[i].flags;
        assert_true(modes == RAY_MODES_ALL ? same == MANY : same < MANY * 2 / 3);
        ray_modes_make((enum ray_modes)modes, 5, 0, NULL);
    }
}

/* Neighbours are drawn apart: of the next ray another mode can be known from none. */
static void neighbours_are_drawn_apart(void **state)
{
    (void)state;
    static const uint32_t steps[] = {1, 2, 3, 256};
    ray_modes_make(RAY_MODES_DRAWN, 9, MANY, mode);
    for (size_t s = 0; s < ARRAY_COUNT(steps); s++) {
        uint32_t both = 0, one = 0;
        for (uint32_t i = 0; i + steps[s] < MANY; i++) {
            one += mode[i].mask == 0xFF;
            both += mode[i].mask == 0xFF && mode[i + steps[s]].mask == 0xFF;
        }
        assert_in_range(both, one * 45 / 100, one * 55 / 100);
    }
}

static void even_rays_of_mixed_are_all(void **state)
{
    (void)state;
    ray_modes_make(RAY_MODES_DRAWN, 7, MANY, other);
    ray_modes_make(RAY_MODES_MIXED, 7, MANY, mode);
    for (uint32_t i = 0; i < MANY; i++)
        if (i % 2 == 0)
            assert_true(is_all(mode[i]));
        else
            assert_memory_equal(&mode[i], &other[i], sizeof *mode);
    ray_modes_make(RAY_MODES_ALL, 7, MANY, mode);
    for (uint32_t i = 0; i < MANY; i++)
        assert_true(is_all(mode[i]));
}

static void modes_have_names(void **state)
{
    (void)state;
    assert_string_equal(ray_modes_name(RAY_MODES_ALL), "all");
    assert_string_equal(ray_modes_name(RAY_MODES_MIXED), "mixed");
    assert_string_equal(ray_modes_name(RAY_MODES_DRAWN), "drawn");
    assert_null(ray_modes_name(RAY_MODES_COUNT));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_mode_is_legal),
        cmocka_unit_test(everything_legal_occurs),
        cmocka_unit_test(a_mode_depends_on_seed_and_number_alone),
        cmocka_unit_test(neighbours_are_drawn_apart),
        cmocka_unit_test(even_rays_of_mixed_are_all),
        cmocka_unit_test(modes_have_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
