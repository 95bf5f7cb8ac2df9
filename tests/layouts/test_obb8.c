/* Layout obb8: oriented boxes hold their triangles, by exact sums. */
#include "ref/packed/packed_check.h"
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/obb8_words.h"

/* --- exact sums ------------------------------------------------------------------------------- */

/* The sign of a point's place along an axis less a plane. */
static int side_of(const uint32_t *word, uint32_t j, uint32_t s, bool up, const float v[3],
                   double more)
{
    double part[2];
    plane_of(word, j, s, up, part);
    const double x[] = {axis_of(word, j, 0) * (double)v[0],
                        axis_of(word, j, 1) * (double)v[1],
                        axis_of(word, j, 2) * (double)v[2],
                        -part[0],
                        -part[1],
                        -more};
    return sign_of_sum(x, 6);
}

static void sums_are_exact(void **state)
{
    (void)state;
    const double a[] = {0x1p60, 1, -0x1p60, 0x1p-60, -1};
    assert_int_equal(sign_of_sum(a, 5), 1);
    const double b[] = {1, 0x1p-53, 0x1p-106, -1, -0x1p-53, -0x1p-105};
    assert_int_equal(sign_of_sum(b, 6), -1);
    const double c[] = {0x1p100, 3, -0x1p100, -3};
    assert_int_equal(sign_of_sum(c, 4), 0);
}

/* --- containment ------------------------------------------------------------------------------ */

/* What is met below the children of records. */
struct obb8_held {
    uint32_t oblique, points, tight, slots;
};

static void check_point(const uint32_t *word, uint32_t s, const float v[3], bool met[3][2],
                        struct obb8_held *held)
{
    for (uint32_t j = 0; j < 3; j++)
        for (int up = 0; up < 2; up++) {
            double step = ldexp(1, (int)bits(word, 224 + 8 * j, 8) - 127);
            int side = side_of(word, j, s, up, v, 0);
            if (up ? side > 0 : side < 0)
                fail_msg("slot %u, axis %u: %.9g %.9g %.9g lies outside", s, j, (double)v[0],
                         (double)v[1], (double)v[2]);
            side = side_of(word, j, s, up, v, up ? -1.01 * step : 1.01 * step);
            met[j][up] |= up ? side > 0 : side < 0; /* within a step, and a little for rounding */
            held->points++;
        }
}

/* All points below a child of a record. */
static void check_below(const struct packed *packed, const struct scene *scene, uint32_t ref,
                        const uint32_t *word, uint32_t s, bool met[3][2], struct obb8_held *held)
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++)
        check_below(packed, scene, node.child[c], word, s, met, held);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++) {
        float v[3][3];
        scene_tri(scene, packed_item(packed, &node, i), v);
        for (uint32_t c = 0; c < 3; c++)
            check_point(word, s, v[c], met, held);
    }
}

static void check_record(const struct packed *packed, const struct scene *scene, uint32_t record,
                         struct obb8_held *held)
{
    const uint32_t *word = packed->word + WORDS * (size_t)record;
    struct wide node;
    packed->layout->load(packed, record, &node);
    assert_true(bits(word, 120, 8) <= 1 && bits(word, 252, 4) == 0);
    if (!bits(word, 120, 8)) {
        for (uint32_t i = 24; i < WORDS; i++)
            assert_int_equal(word[i], 0);
        return;
    }
    held->oblique++;
    for (uint32_t j = 0; j < 3; j++) { /* at right angles, none is 0 */
        const uint32_t next = (j + 1) % 3;
        int dot = 0, square = 0;
        for (uint32_t k = 0; k < 3; k++) {
            dot += axis_of(word, j, k) * axis_of(word, next, k);
            square += axis_of(word, j, k) * axis_of(word, j, k);
        }
        assert_true(dot == 0 && square > 0);
    }
    for (uint32_t s = 0; s < node.child_count; s++) {
        bool met[3][2] = {{false}};
        check_below(packed, scene, node.child[s], word, s, met, held);
        for (uint32_t j = 0; j < 3; j++)
            held->tight += met[j][0] + met[j][1];
        held->slots |= 1u << s;
    }
}

static void check_scene(const struct scene *scene, uint32_t leaf, struct obb8_held *held)
{
    struct packed packed;
    pack(&packed, "obb8", scene, leaf);
    assert_int_equal(packed_check(&packed, scene, NULL, NULL), STATUS_OK);
    for (uint32_t r = 0; r < packed.node_count; r++)
        check_record(&packed, scene, r, held);
    packed_free(&packed);
}

static void oriented_boxes_hold_their_triangles(void **state)
{
    (void)state;
    static const float scale[] = {0x1p-140f, 0x1p-126f, 0x1p-60f, 1, 0x1p60f, 0x1p86f};
    struct rng rng = rng_make(1, 7);
    struct obb8_held held = {0};
    for (uint32_t round = 0; round < 240; round++) {
        const float size = scale[round % 6], centre = round / 6 % 4 == 0 ? 0 : size * 3;
        struct scene scene = slivers(&rng, 1 + round % 90, centre * (float)(round / 24 % 3 * 100),
                                     size, size * 0.3f);
        for (uint32_t i = 0; i < 9 * scene.tri_count && round % 5 == 0; i++)
            if (rng_below(&rng, 4) == 0) /* zeros of both signs, the least numbers */
                scene.vertex[i] = rng_below(&rng, 2) ? -0.0f : 0x1p-149f;
        for (uint32_t i = 0; i < scene.vertex_count && round % 7 == 0; i++)
            scene.vertex[3 * i + round % 3] = centre; /* flat */
        check_scene(&scene, 1 + round % 3, &held);
        scene_free(&scene);
    }
    assert_true(held.oblique > 500);
    assert_int_equal(held.slots, 255);
    /* Bounds lie within a step of a point. Steps are larger only far from the origin. */
    assert_true(held.tight > 6 * held.oblique);
}

/* A triangle that ends where it begins stands for the box of its vertices: all eight corners. */
static void a_line_stands_for_its_box(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 7);
    for (uint32_t round = 0; round < 200; round++) {
        struct packed packed;
        struct obb8_held held = {0};
        struct wide node;
        struct scene scene = slivers(&rng, 5, 0, 1, 1);
        for (uint32_t i = 0; i < scene.tri_count; i++)
            memcpy(scene.vertex + 9 * (size_t)i + 6, scene.vertex + 9 * (size_t)i, 12);
        for (uint32_t i = 0; i < 9 * 4; i++) /* the others are thin, so that there are axes */
            scene.vertex[i] = i % 9 < 6 ? scene.vertex[i] : scene.vertex[i - 3] + 0.01f;
        pack(&packed, "obb8", &scene, 1);
        packed.layout->load(&packed, 0, &node);
        for (uint32_t c = 0; c < node.child_count && bits(packed.word, 120, 8); c++) {
            float v[3][3];
            bool met[3][2];
            if (packed.item[node.leaf_first[c]] != 4)
                continue;
            scene_tri(&scene, 4, v);
            for (uint32_t corner = 0; corner < 8; corner++) {
                const float at[3] = {v[corner & 1][0], v[corner >> 1 & 1][1], v[corner >> 2][2]};
                check_point(packed.word, c, at, met, &held);
            }
        }
        assert_true(held.points == 48 || !bits(packed.word, 120, 8));
        packed_free(&packed);
        scene_free(&scene);
    }
}

/* Every component of a vertex at the largest magnitude that is taken. */
static void the_largest_numbers_are_held(void **state)
{
    (void)state;
    for (uint32_t signs = 0; signs < 512; signs++) {
        struct obb8_held held = {0};
        struct scene scene = trees_grid(2);
        for (uint32_t i = 0; i < 9; i++)
            scene.vertex[i] = signs >> i & 1 ? 0x1p96f : -0x1p96f;
        check_scene(&scene, 1, &held);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_exact),
        cmocka_unit_test(oriented_boxes_hold_their_triangles),
        cmocka_unit_test(a_line_stands_for_its_box),
        cmocka_unit_test(the_largest_numbers_are_held),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
