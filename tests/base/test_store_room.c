/* Storage: a leaf takes the words that are measured, no more, and is read only where all of it is
 * there. */
#include "ref/fast/block.h"
#include "ref/primitives/test_run.h"
#include "ref/primitives/tri_baldwin_webber.h"
#include "ref/store/bits.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/fence.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CANARY 0xA5A5A5A5u
#define AFTER  12u /* words after a leaf, and before it */

/* A scene of one leaf. */
struct leaf {
    float vertex[3 * BLOCK_VERTICES];
    uint32_t index[3 * BLOCK_TRIS], prim[BLOCK_TRIS];
    struct scene scene;
};

/* `vertices` corners with coordinates from 5 to 5 + `most`, whole numbers; `count` triangles name
 * them all. */
static void leaf_make(struct leaf *leaf, uint32_t count, uint32_t vertices, uint32_t most)
{
    for (uint32_t i = 0; i < vertices; i++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t at = i == 0 ? 0 : i == 1 ? most : (most / (i + 1) + 7 * k * i) % most;
            leaf->vertex[3 * i + k] = (float)(5 + at);
        }
    for (uint32_t i = 0; i < 3 * count; i++)
        leaf->index[i] = i < vertices ? vertices - 1 - i : i % vertices;
    for (uint32_t i = 0; i < count; i++)
        leaf->prim[i] = count - 1 - i;
    leaf->scene = (struct scene){
        .vertex = leaf->vertex, .index = leaf->index, .vertex_count = vertices, .tri_count = count};
}

/* The leaf written behind AFTER words and the head; the words after it are canaries. */
struct stored_leaf {
    uint32_t *word;
    struct packed packed;
    uint32_t first, words;
};

static struct stored_leaf write_leaf(const struct tri_store *store, const struct leaf *leaf)
{
    struct stored_leaf w = {.packed = {.layout = layouts[0], .store = store}};
    uint64_t words = 0;
    struct reason reason = {""};
    w.first = store->head_words + AFTER;
    w.word = malloc(4096 * sizeof *w.word);
    assert_non_null(w.word);
    for (uint32_t i = 0; i < 4096; i++)
        w.word[i] = CANARY;
    w.packed.item = w.word;
    if (store->head && store->head(store, &leaf->scene, w.word, &reason))
        fail_msg("%s", reason.text);
    if (store->measure(&w.packed, &leaf->scene, leaf->prim, leaf->scene.tri_count, &words, &reason))
        fail_msg("%s", reason.text);
    assert_true(words >= 1 && words < 512);
    w.words = (uint32_t)words;
    store->write(&w.packed, &leaf->scene, leaf->prim, leaf->scene.tri_count, w.word + w.first);
    for (uint32_t i = store->head_words; i < w.first; i++)
        assert_int_equal(w.word[i], CANARY);
    for (uint32_t i = w.first + w.words; i < 4096; i++)
        assert_int_equal(w.word[i], CANARY);
    w.packed.item_count = w.first + w.words;
    return w;
}

/* Reads an item; what is beyond the vertices is not written. */
static uint32_t read_item(const struct stored_leaf *w, uint32_t slot, float v[3][3])
{
    struct {
        float v[3][3], after[3];
    } out;
    memset(&out, 0x5A, sizeof out);
    const float kept[3] = {out.after[0], out.after[1], out.after[2]};
    const struct tri_store *store = w->packed.store;
    uint32_t prim = store->item(&w->packed, w->first, slot);
    if (store->tri && store->tri(&w->packed, w->first, slot, out.v) != (prim != ABI_NO_PRIM))
        fail_msg("%s, slot %u: triangle %u, but vertices say otherwise", store->name, slot, prim);
    assert_memory_equal(out.after, kept, sizeof kept);
    memcpy(v, out.v, sizeof out.v);
    return prim;
}

/* Reads an item of so many words, behind which there is no memory. */
static uint32_t read_of(struct stored_leaf w, uint32_t count, uint32_t slot)
{
    struct fence fence = fence_make(w.word, count);
    float v[3][3];
    w.packed.item = fence.word;
    w.packed.item_count = count;
    uint32_t prim = read_item(&w, slot, v);
    fence_free(&fence);
    return prim;
}

static void check_leaf(const struct tri_store *store, const struct leaf *leaf)
{
    struct stored_leaf w = write_leaf(store, leaf);
    const uint32_t count = leaf->scene.tri_count;
    float v[3][3], is[3][3];
    for (uint32_t slot = 0; slot < count; slot++) {
        assert_int_equal(read_item(&w, slot, v), leaf->prim[slot]);
        scene_tri(&leaf->scene, leaf->prim[slot], is);
        if (store->tri)
            assert_memory_equal(v, is, sizeof is);
    }
    assert_int_equal(read_of(w, w.first + w.words, count - 1), leaf->prim[count - 1]);
    /* A word less: the last item is not there, or in storages of whole leaves none. */
    for (uint32_t less = 1; less < w.words; less++)
        assert_int_equal(read_of(w, w.first + w.words - less, count - 1), ABI_NO_PRIM);
    for (uint32_t less = 0; less <= AFTER; less++)
        assert_int_equal(read_of(w, w.first - less, 0), ABI_NO_PRIM);
    /* With words behind it, no leaf has a ninth item. */
    w.packed.item_count = 4096;
    if (store->id == ABI_STORE_COMPACT || store->id == ABI_STORE_QUANTISED)
        for (uint32_t slot = BLOCK_TRIS; slot < BLOCK_TRIS + 3; slot++)
            assert_int_equal(read_item(&w, slot, v), ABI_NO_PRIM);
    if (store->lossy) /* these have their number of items */
        assert_int_equal(read_item(&w, count, v), ABI_NO_PRIM);
    free(w.word);
}

static void leaves_are_read_where_all_of_them_is_there(void **state)
{
    (void)state;
    static const uint32_t most[] = {1, 9, 255, 4097, 65535, 70000, (1u << 21) - 1};
    for (size_t s = 0; tri_stores[s]; s++)
        for (uint32_t count = 1; count <= BLOCK_TRIS; count++)
            for (uint32_t vertices = 1; vertices <= BLOCK_VERTICES && vertices <= 3 * count;
                 vertices++)
                for (size_t i = 0; i < ARRAY_COUNT(most); i++) {
                    struct leaf leaf;
                    if (tri_stores[s]->id == ABI_STORE_DGF1 && most[i] > 4097)
                        continue; /* a block of 128 bytes does not hold all of these */
                    leaf_make(&leaf, count, vertices, most[i]);
                    check_leaf(tri_stores[s], &leaf);
                }
}

/* Whatever is before and behind; of the last word nothing behind it is touched. */
static void bits_are_where_they_are_put(void **state)
{
    (void)state;
    for (uint32_t at = 0; at < 70; at++)
        for (uint32_t width = 0; width <= 32; width++)
            for (uint32_t value = 0; value < 4; value++) {
                uint32_t word[4] = {0}, most = width ? 0xFFFFFFFFu >> (32 - width) : 0;
                uint32_t is = value * 0x9E3779B9u & most;
                struct fence fence = fence_make(word, (at + width + 31) / 32);
                bits_put(fence.word, at, width, is);
                assert_int_equal(bits_get(fence.word, at, width), is);
                for (uint32_t bit = 0; bit < at + width; bit++)
                    assert_int_equal(bits_get(fence.word, bit, 1),
                                     bit < at ? 0 : is >> (bit - at) & 1u);
                for (uint32_t i = 0; i < (at + width + 31) / 32; i++)
                    fence.word[i] = ~fence.word[i];
                assert_int_equal(bits_get(fence.word, at, width), ~is & most);
                fence_free(&fence);
            }
    for (uint32_t width = 0; width < 31; width++) {
        assert_int_equal(bits_of((1u << width) - 1), width);
        assert_int_equal(bits_of(1u << width), width + 1);
    }
}

/* Ten words an item: nine floats that are made of the vertices, then the number, with the axis of
 * Baldwin and Weber's test in the upper bits. */
static void rows_by_value(void **state)
{
    (void)state;
    static const char *const names[] = {"gathered", "edges", "baldwin_webber"};
    for (size_t s = 0; s < ARRAY_COUNT(names); s++)
        for (int turn = 0; turn < 3; turn++) {
            const float at[3][3] = {{1, 2, 3}, {4, 6, 3}, {2, 9, 3.5f}};
            struct leaf leaf = {.index = {0, 1, 2}};
            struct stored_leaf w;
            uint32_t axis = 0, want[10];
            float row[9];
            for (int i = 0; i < 9; i++)
                leaf.vertex[i] = row[i] = at[i / 3][(i + turn) % 3];
            leaf.scene = (struct scene){
                .vertex = leaf.vertex, .index = leaf.index, .vertex_count = 3, .tri_count = 1};
            w = write_leaf(tri_store_find(names[s]), &leaf);
            for (int i = 3; i < 9 && s == 1; i++)
                row[i] -= row[i % 3];
            if (s == 2) {
                float v[3][3];
                scene_tri(&leaf.scene, 0, v);
                axis = (uint32_t)baldwin_webber_transform(v, row);
                assert_int_equal(axis, (2 + 3 - turn) % 3); /* the flattest one */
            }
            memcpy(want, row, sizeof row);
            want[9] = axis << 30;
            assert_memory_equal(w.word + w.first, want, sizeof want);
            free(w.word);
        }
}

/* Of a row that every ray meets, whatever its axis: no row has a fourth one. */
static void an_axis_that_is_none_is_no_triangle(void **state)
{
    (void)state;
    const float row[9] = {[2] = 0.25f, [5] = 0.25f};
    const struct ray ray = {{1, 2, 3}, -10, {-1, -1, -1}, 10};
    const struct tri_ray at = tri_ray_make(&ray);
    struct leaf leaf;
    leaf_make(&leaf, 1, 3, 5);
    struct stored_leaf w = write_leaf(tri_store_find("baldwin_webber"), &leaf);
    memcpy(w.word + w.first, row, sizeof row);
    for (uint32_t axis = 0; axis < 4; axis++) {
        struct hit hit;
        w.word[w.first + 9] = axis << 30;
        bool met = w.packed.store->test(&w.packed, w.first, 0, ABI_TRI_BALDWIN_WEBBER, &at, &hit);
        assert_int_equal(met, axis < 3);
    }
    free(w.word);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leaves_are_read_where_all_of_them_is_there),
        cmocka_unit_test(bits_are_where_they_are_put),
        cmocka_unit_test(rows_by_value),
        cmocka_unit_test(an_axis_that_is_none_is_no_triangle),
    };
    return cmocka_run_group_tests_name("store_room", tests, NULL, NULL);
}
