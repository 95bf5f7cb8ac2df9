/* Storage: a leaf takes the words that are measured, no more, and is read only where all of it is
 * there. */
#include "ref/fast/block.h"
#include "ref/store.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

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
static uint32_t read(const struct stored_leaf *w, uint32_t slot, float v[3][3])
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

static void check_leaf(const struct tri_store *store, const struct leaf *leaf)
{
    struct stored_leaf w = write_leaf(store, leaf);
    const uint32_t count = leaf->scene.tri_count;
    float v[3][3], is[3][3];
    for (uint32_t slot = 0; slot < count; slot++) {
        assert_int_equal(read(&w, slot, v), leaf->prim[slot]);
        scene_tri(&leaf->scene, leaf->prim[slot], is);
        if (store->tri)
            assert_memory_equal(v, is, sizeof is);
    }
    /* A word less: the last item is not there, or in storages of whole leaves none. */
    w.packed.item_count--;
    assert_int_equal(read(&w, count - 1, v), ABI_NO_PRIM);
    for (uint32_t less = 2; less < w.words; less++) {
        w.packed.item_count--;
        assert_int_equal(read(&w, count - 1, v), ABI_NO_PRIM);
    }
    w.packed.item_count = w.first;
    assert_int_equal(read(&w, 0, v), ABI_NO_PRIM);
    /* With words behind it, no leaf has a ninth item. */
    w.packed.item_count = 4096;
    if (store->id == ABI_STORE_COMPACT || store->id == ABI_STORE_QUANTISED)
        for (uint32_t slot = BLOCK_TRIS; slot < BLOCK_TRIS + 3; slot++)
            assert_int_equal(read(&w, slot, v), ABI_NO_PRIM);
    if (store->id == ABI_STORE_QUANTISED) /* which has its number of items */
        assert_int_equal(read(&w, count, v), ABI_NO_PRIM);
    free(w.word);
}

static void leaves_are_read_where_all_of_them_is_there(void **state)
{
    (void)state;
    static const struct {
        uint32_t count, vertices, most;
    } leaves[] = {{1, 1, 1},      {1, 2, 3},        {1, 3, 100},
                  {2, 4, 255},    {3, 5, 4096},     {8, 16, 65535},
                  {8, 16, 70000}, {7, 9, 1u << 20}, {8, 3, (1u << 21) - 1},
                  {8, 1, 9}};
    for (size_t s = 0; tri_stores[s]; s++)
        for (size_t i = 0; i < ARRAY_COUNT(leaves); i++) {
            struct leaf leaf;
            leaf_make(&leaf, leaves[i].count, leaves[i].vertices, leaves[i].most);
            check_leaf(tri_stores[s], &leaf);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(leaves_are_read_where_all_of_them_is_there),
    };
    return cmocka_run_group_tests_name("store_room", tests, NULL, NULL);
}
