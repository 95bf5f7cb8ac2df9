/* Laws of the blocks of small trees (ref/fast/small_block.h): what they hold, to the bit. */
#include "tests/fast/small_fixture.h"

#define WORDS (SMALL_WORDS + SMALL_BEYOND)

static int32_t ordered(uint32_t bits)
{
    return (int32_t)small_order(bits);
}

static void ordered_integers_are_in_the_order_of_floats(void **state)
{
    (void)state;
    static const float rising[] = {-INFINITY,  -3e38f, -1e30f, -1.5f,     -1.0f,     -0x1p-126f,
                                   -0x1p-149f, -0.0f,  0.0f,   0x1p-149f, 0x1p-126f, 1.0f,
                                   1.5f,       1e30f,  3e38f,  INFINITY};
    for (size_t i = 1; i < ARRAY_COUNT(rising); i++)
        assert_true(ordered(float_bits(rising[i - 1])) < ordered(float_bits(rising[i])));
    struct rng rng = rng_make(5, 1);
    for (int i = 0; i < 100000; i++) {
        uint32_t bits = (uint32_t)rng_u64(&rng), other = (uint32_t)rng_u64(&rng);
        float a = float_from_bits(bits), b = float_from_bits(other);
        assert_int_equal(small_order(small_order(bits)), bits);
        if (a < b)
            assert_true(ordered(bits) < ordered(other));
    }
}

/* --- blocks ----------------------------------------------------------------------------------- */

/* Integers of a row whose differences have exactly `width` bits. */
static void make_row(struct rng *rng, uint32_t width, uint32_t count, uint32_t *row)
{
    const uint32_t mask = low_bits(width), least = (uint32_t)rng_u64(rng) & ~mask;
    for (uint32_t i = 0; i < count; i++)
        row[i] = least + ((uint32_t)rng_u64(rng) & mask);
    if (count > 1) {
        row[0] = least;
        row[count - 1] = least + mask;
    }
}

/* Blocks of any widths and counts, not made of a scene, as numbers of triangles are small there. */
static void what_is_written_is_read(void **state)
{
    (void)state;
    struct rng rng = rng_make(1, 1);
    for (uint32_t round = 0; round < 6000; round++) {
        struct small_block block = {.vertex_count = 2 + rng_below(&rng, SMALL_VERTICES - 1),
                                    .tri_count = 1 + rng_below(&rng, SMALL_TRIS)};
        uint32_t row[3][SMALL_VERTICES], word[WORDS] = {0};
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t most = SMALL_ROW_MOST / block.vertex_count;
            block.width[k] = (round + 11 * k) % 33;
            block.width[k] = block.width[k] < most ? block.width[k] : most;
            make_row(&rng, block.width[k], block.vertex_count, row[k]);
            block.least[k] = (int32_t)row[k][0];
            memcpy(block.vertex[k], row[k], sizeof row[k]);
        }
        block.prim_width = block.tri_count > 1 ? round % 33 : 0;
        block.prim_width += block.prim_width == 31;
        make_row(&rng, block.prim_width, block.tri_count, block.prim);
        block.least_prim = block.prim[0];
        for (uint32_t i = 0; i < block.tri_count; i++)
            for (uint32_t c = 0; c < 3; c++)
                block.corner[i] |= rng_below(&rng, block.vertex_count) << 4 * c;
        assert_true(small_block_words(&block) <= SMALL_WORDS);
        small_block_write(&block, word);
        assert_int_equal(word[small_block_words(&block)], 0);
        assert_int_equal(small_vertices(word[0]), block.vertex_count);
        assert_int_equal(small_tris(word[0]), block.tri_count);
        for (uint32_t i = 0; i < block.tri_count; i++) {
            assert_int_equal(small_prim(word, i), block.prim[i]);
            assert_int_equal(small_corner(word, i), block.corner[i]);
        }
        for (uint32_t k = 0; k < 3; k++)
            for (uint32_t i = 0; i < block.vertex_count; i++)
                assert_int_equal(small_order(small_vertex(word, k, i)), row[k][i]);
    }
}

static void blocks_hold_their_triangles(void **state)
{
    (void)state;
    struct rng rng = rng_make(2, 1);
    uint32_t full = 0, refused = 0, widest = 0;
    for (uint32_t round = 0; round < 4000; round++) {
        struct scene scene = any_scene(&rng, round % (KINDS + 1), 3 + rng_below(&rng, 16), 60);
        uint32_t prim[SMALL_TRIS + 1], word[WORDS] = {0}, count = SMALL_TRIS;
        struct small_block block;
        for (uint32_t i = 0; i <= SMALL_TRIS; i++)
            prim[i] = rng_below(&rng, scene.tri_count);
        assert_false(small_block_make(&scene, prim, SMALL_TRIS + 1, &block));
        while (!small_block_make(&scene, prim, count, &block))
            count--;
        assert_true(count >= 1);
        full += count == SMALL_TRIS;
        refused += count < SMALL_TRIS;
        small_block_write(&block, word);
        for (uint32_t i = 0; i < count; i++) {
            float v[3][3], w[3][3];
            scene_tri(&scene, prim[i], v);
            small_tri(word, i, w);
            assert_memory_equal(v, w, sizeof v);
            assert_int_equal(small_prim(word, i), prim[i]);
        }
        for (uint32_t k = 0; k < 3; k++)
            widest = small_width(word[0], k) > widest ? small_width(word[0], k) : widest;
        scene_free(&scene);
    }
    assert_true(full > 500 && refused > 50);
    assert_int_equal(widest, 32);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ordered_integers_are_in_the_order_of_floats),
        cmocka_unit_test(what_is_written_is_read),
        cmocka_unit_test(blocks_hold_their_triangles),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
