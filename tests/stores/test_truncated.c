/* Storage `truncated`: which bits are dropped, each bit that is not is kept, and a leaf has the
 * words of its bits. */
#include "ref/scene/quantise.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <stdlib.h>
#include <string.h>

#define SLOTS    8u
#define VERTICES 16u

static const float ends[] = {0.0f,     -0.0f,    0x1p-149f, -0x1p-149f, 0x1.fffffcp-127f, FLT_MIN,
                             -FLT_MIN, 0x1.8p0f, 1e30f,     -1e30f,     FLT_MAX,          -FLT_MAX};

/* Of each number the sign, the exponent and the upper bits of the fraction remain. */
static void low_bits_are_zero_and_no_others(void **state)
{
    (void)state;
    for (uint32_t bits = 1; bits <= TRUNCATE_BITS_MOST; bits++) {
        struct scene scene, out;
        struct quantised q;
        assert_int_equal(scene_make(ARRAY_COUNT(ends), 0, &scene), STATUS_OK);
        for (uint32_t i = 0; i < 3 * ARRAY_COUNT(ends); i++)
            scene.vertex[i] = ends[(i + i / 3) % ARRAY_COUNT(ends)];
        assert_int_equal(scene_truncate(&scene, bits, &out, &q, NULL), STATUS_OK);
        for (uint32_t i = 0; i < 3 * ARRAY_COUNT(ends); i++) {
            uint32_t was = float_bits(scene.vertex[i]), is = float_bits(out.vertex[i]);
            assert_int_equal(is % (1u << bits), 0);
            assert_int_equal(is / (1u << bits), was / (1u << bits));
        }
        assert_true(q.moved[0] <= (double)FLT_MAX * ((double)(1u << bits) * 0x1p-24));
        scene_free(&out);
        scene_free(&scene);
    }
}

/* `total` triangles, of which the last 8 are a strip of 16 vertices whose coordinates all have
 * `low` zero bits, one exactly so many. */
static struct scene strip(uint32_t total, uint32_t low, uint32_t one)
{
    struct scene scene;
    assert_int_equal(scene_make(VERTICES, total, &scene), STATUS_OK);
    for (uint32_t i = 0; i < 3 * VERTICES; i++) {
        uint32_t word = (0x3F000000u + i * 0x9E3779B9u % 0x00FFFFFFu) >> low << low;
        word = i == one ? (word | 1u << low) : low < 31 ? word & ~(1u << low) : 0;
        scene.vertex[i] = float_from_bits(word);
    }
    for (uint32_t i = 0; i < SLOTS; i++) {
        uint32_t *index = scene.index + 3 * (size_t)(total - SLOTS + i);
        index[0] = i;
        index[1] = i + 1;
        index[2] = i + 8;
    }
    return scene;
}

static uint32_t bits_in(uint32_t x)
{
    uint32_t bits = 0;
    for (; x; x /= 2)
        bits++;
    return bits;
}

static uint32_t distinct(const struct scene *scene, uint32_t count)
{
    uint32_t found = 0;
    bool used[VERTICES] = {false};
    for (uint32_t i = 3 * (scene->tri_count - SLOTS); i < 3 * (scene->tri_count - SLOTS + count);
         i++)
        used[scene->index[i]] = true;
    for (uint32_t v = 0; v < VERTICES; v++) {
        bool again = false;
        for (uint32_t w = 0; w < v; w++)
            again |= used[w] && memcmp(scene->vertex + 3 * w, scene->vertex + 3 * v,
                                       3 * sizeof *scene->vertex) == 0;
        found += used[v] && !again;
    }
    return found;
}

static void expect_leaf(const struct scene *scene, uint32_t count, uint32_t low)
{
    struct packed packed = {.layout = layouts[0], .store = tri_store_find("truncated")};
    uint32_t prim[SLOTS], at;
    uint64_t words;
    for (uint32_t i = 0; i < count; i++)
        prim[i] = scene->tri_count - SLOTS + i;
    assert_int_equal(packed.store->measure(&packed, scene, prim, count, &words, NULL), STATUS_OK);
    uint32_t bits =
        17 + count * (12 + bits_in(prim[count - 1] | 1)) + 3 * distinct(scene, count) * (32 - low);
    assert_int_equal(words, (bits + 31) / 32);
    assert_int_equal(store_put(scene, prim, count, &packed, &at, NULL), STATUS_OK);
    assert_int_equal(packed.item_count, words);
    for (uint32_t slot = 0; slot < count; slot++) {
        float own[3][3], stored[3][3];
        scene_tri(scene, prim[slot], own);
        assert_int_equal(packed.store->item(&packed, at, slot), prim[slot]);
        assert_true(packed.store->tri(&packed, at, slot, stored));
        assert_memory_equal(stored, own, sizeof own);
    }
    assert_int_equal(packed.store->item(&packed, at, count), ABI_NO_PRIM);
    free(packed.item);
}

/* Every number of dropped bits, with the lowest one that is kept in every coordinate. */
static void the_lowest_bit_that_is_set_is_kept(void **state)
{
    (void)state;
    for (uint32_t low = 0; low < 32; low++)
        for (uint32_t one = 0; one < 9; one++)
            for (uint32_t count = 1; count <= SLOTS; count++) {
                /* 8 vertices apart are used by the first triangle. */
                struct scene scene =
                    strip(SLOTS + (count > 4 ? 100000 : 0), low, one < 6 ? one : 24 + one - 6);
                expect_leaf(&scene, count, low);
                scene_free(&scene);
            }
}

/* The number of a triangle has up to 32 bits. */
static void numbers_have_32_bits(void **state)
{
    (void)state;
    for (uint32_t bits = 1; bits <= 32; bits++) {
        struct packed packed = {.layout = layouts[0], .store = tri_store_find("truncated")};
        uint32_t word[8] = {0}, number = 0xFFFFFFFEu >> (32 - bits);
        word[0] = 2u << 3 | 31u << 7 | (bits - 1) << 12;
        uint64_t at = (uint64_t)number << 29; /* behind 17 and 12 bits */
        word[0] |= (uint32_t)at;
        word[1] = (uint32_t)(at >> 32);
        packed.item = word;
        packed.item_count = 8;
        assert_int_equal(packed.store->item(&packed, 0, 0), number);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(low_bits_are_zero_and_no_others),
        cmocka_unit_test(the_lowest_bit_that_is_set_is_kept),
        cmocka_unit_test(numbers_have_32_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
