/* What a ray may meet of a world: masks, flags, opacity, culls, facing, the filter. */
#include "tests/world/world_fixture.h"

#include <math.h>

static unsigned bits_of(uint32_t x)
{
    unsigned bits = 0;
    for (; x; x &= x - 1)
        bits++;
    return bits;
}

static void every_set_of_ray_flags_is_legal_or_refused(void **state)
{
    (void)state;
    struct reason reason;
    for (uint32_t flags = 0; flags < 0x400; flags++) {
        bool legal = flags < 0x200 && bits_of(flags & 0x0C3) <= 1 && bits_of(flags & 0x130) <= 1;
        assert_int_equal(ray_mode_check((struct ray_mode){0xFF, flags}, &reason) == STATUS_OK,
                         legal);
    }
    assert_int_equal(ray_mode_check((struct ray_mode){0, 0}, &reason), STATUS_OK);
    assert_int_equal(ray_mode_check((struct ray_mode){256, 0}, &reason), STATUS_INPUT);
    assert_int_equal(ray_mode_check(ray_mode_all(), &reason), STATUS_OK);
}

static void masks_need_one_common_bit(void **state)
{
    (void)state;
    for (uint32_t mask = 0; mask < 256; mask++)
        for (uint32_t mine = 0; mine < 256; mine++) {
            struct instance instance = {.mask = mine};
            assert_int_equal(world_meets(&instance, (struct ray_mode){mask, 0}),
                             (mask & mine) != 0);
            assert_false(world_meets(&instance, (struct ray_mode){mask, ABI_RAY_SKIP_TRIANGLES}));
            instance.mesh = WORLD_NO_MESH;
            assert_false(world_meets(&instance, (struct ray_mode){mask, 0}));
        }
}

/* The ray's word is the last, then the instance's, then the geometry's. */
static void opacity_is_the_rays_then_the_instances_then_the_geometrys(void **state)
{
    (void)state;
    for (uint32_t ray = 0; ray < 3; ray++)
        for (uint32_t force = 0; force < 3; force++)
            for (int own = 0; own < 2; own++) {
                const struct instance instance = {.flags = force << 2};
                const struct ray_mode mode = {0xFF, ray};
                bool expected = ray ? ray == 1 : force ? force == 1 : own;
                assert_int_equal(world_is_opaque(&instance, own, mode), expected);
            }
}

static void culls_are_by_opacity_and_by_facing_unless_disabled(void **state)
{
    (void)state;
    static const uint32_t by_opacity[] = {0, ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE};
    static const uint32_t by_facing[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT};
    for (int o = 0; o < 3; o++)
        for (int f = 0; f < 3; f++)
            for (uint32_t flags = 0; flags < 4; flags++)
                for (int side = 0; side < 4; side++) {
                    const struct instance instance = {.flags = flags};
                    bool opaque = side & 1, front = side & 2;
                    bool culled = (o == 1 && opaque) || (o == 2 && !opaque);
                    culled |= !(flags & 1) && ((f == 1 && !front) || (f == 2 && front));
                    const struct ray_mode mode = {0xFF, by_opacity[o] | by_facing[f]};
                    assert_int_equal(world_culls(&instance, opaque, front, mode), culled);
                }
}

static void front_is_where_vertices_run_counterclockwise_unless_flipped(void **state)
{
    (void)state;
    struct instance instance = {0};
    assert_true(world_is_front(&instance, -1));
    assert_false(world_is_front(&instance, 1));
    instance.flags = ABI_INSTANCE_FLIP_FACING;
    assert_false(world_is_front(&instance, -1));
    assert_true(world_is_front(&instance, 1));
}

/* A filter passes about its share, and what it passes depends on each of its numbers. */
static void filters_pass_their_share_by_each_number(void **state)
{
    (void)state;
    for (uint32_t share = 0; share <= 256; share += 32) {
        struct filter_rule filter = {FILTER_TRIANGLES, 5, share};
        unsigned passed = 0, other[5] = {0};
        for (uint32_t i = 0; i < 4096; i++) {
            const struct place at = {.instance = i % 16, .geometry = i / 16 % 16, .tri = i / 256};
            struct place moved = at;
            struct filter_rule seeded = filter, celled = filter;
            bool is = filter_passes(&filter, &at, 0.3f, 0.3f);
            passed += is;
            moved.instance += 16;
            other[0] += filter_passes(&filter, &moved, 0.3f, 0.3f) != is;
            moved = at, moved.geometry += 16;
            other[1] += filter_passes(&filter, &moved, 0.3f, 0.3f) != is;
            moved = at, moved.tri += 16;
            other[2] += filter_passes(&filter, &moved, 0.3f, 0.3f) != is;
            seeded.seed = 6;
            other[3] += filter_passes(&seeded, &at, 0.3f, 0.3f) != is;
            celled.kind = FILTER_CELLS;
            other[4] +=
                filter_passes(&celled, &at, 0.3f, 0.3f) != filter_passes(&celled, &at, 0.3f, 0.8f);
            moved = at, moved.mesh = 3, moved.prim = 9; /* follow from the others */
            assert_int_equal(filter_passes(&filter, &moved, 0.9f, 0.1f), is);
        }
        assert_true(fabs(passed / 16.0 - share) < 12);
        for (int k = 0; k < 5; k++)
            assert_int_equal(other[k] > 300, share > 0 && share < 256);
        filter.kind = FILTER_ALL;
        assert_true(filter_passes(&filter, &(struct place){0}, 0, 0));
        filter.kind = FILTER_NONE;
        assert_false(filter_passes(&filter, &(struct place){0}, 0, 0));
    }
}

/* Cells are quarters of u and of v, half open; what lies outside belongs to the first or last. */
static void cells_are_quarters_half_open(void **state)
{
    (void)state;
    static const float lowest[] = {0.0f, 0.25f, 0.5f, 0.75f};
    static const float highest[] = {0x1.fffffep-3f, 0x1.fffffep-2f, 0x1.7ffffep-1f, 1.0f};
    unsigned differ = 0;
    for (uint32_t seed = 0; seed < 64; seed++) {
        const struct filter_rule filter = {FILTER_CELLS, seed, 128};
        const struct place at = {.tri = 3};
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                bool is = filter_passes(&filter, &at, lowest[i], lowest[j]);
                assert_int_equal(filter_passes(&filter, &at, highest[i], highest[j]), is);
                assert_int_equal(filter_passes(&filter, &at, lowest[i], highest[j]), is);
                differ += i > 0 && filter_passes(&filter, &at, lowest[i - 1], lowest[j]) != is;
            }
        assert_int_equal(filter_passes(&filter, &at, -1.0f, 2.0f),
                         filter_passes(&filter, &at, 0.0f, 1.0f));
    }
    assert_true(differ > 200);
    const struct filter_rule cells = {FILTER_CELLS, 0, 1}, others = {FILTER_TRIANGLES, 0, 1};
    assert_true(filter_reads_uv(&cells));
    assert_false(filter_reads_uv(&others));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_set_of_ray_flags_is_legal_or_refused),
        cmocka_unit_test(masks_need_one_common_bit),
        cmocka_unit_test(opacity_is_the_rays_then_the_instances_then_the_geometrys),
        cmocka_unit_test(culls_are_by_opacity_and_by_facing_unless_disabled),
        cmocka_unit_test(front_is_where_vertices_run_counterclockwise_unless_flipped),
        cmocka_unit_test(filters_pass_their_share_by_each_number),
        cmocka_unit_test(cells_are_quarters_half_open),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
