/* Treelets of every layout: laws of the parts, and of what they read. */
#include "tests/traffic/traffic_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define SCENE "soup:n=400"

/* Each node is in one treelet, beside its parent or as its root; parents come first; none is larger
 * than it may be, unless it is one subtree less. */
static void check_parts(const struct traffic_case *c, uint64_t most)
{
    const struct scene_treelets *t = &c->walker.treelets;
    uint64_t total = 0;
    uint32_t way;
    assert_true(t->count >= 1);
    assert_int_equal(t->root[0], c->packed.root);
    for (uint32_t i = 0; i < t->order_count; i++) {
        uint32_t ref = t->order[i], parent = t->parent[ref], of = t->of[ref];
        assert_true(of < t->count);
        if (ref == c->packed.root)
            continue;
        assert_true(of == t->of[parent] || (t->root[of] == ref && of > t->of[parent]));
        if (touch_record(&c->packed, ref, &way) == touch_record(&c->packed, parent, &way))
            assert_int_equal(of, t->of[parent]);
    }
    for (uint32_t i = 0; i < t->count; i++) {
        assert_in_range(t->bytes[i], 1, most);
        assert_int_equal(t->of[t->root[i]], i);
        total += t->bytes[i];
    }
    /* Two that hang together and would fit in one are both parts above subtrees. */
    assert_true(t->count == 1 || total > most);
}

/* Counts how often a burst of the tree is in a treelet's runs. */
static void check_runs(const struct traffic_case *c)
{
    const struct scene_treelets *t = &c->walker.treelets;
    for (uint32_t i = 0; i < t->count; i++) {
        uint64_t bytes = 0;
        for (size_t k = t->first[i]; k < t->first[i + 1]; k++) {
            const struct treelet_run *run = &t->run[k];
            assert_int_equal(run->bytes % 64 + run->offset % 64, 0);
            bytes += run->bytes;
            if (k > t->first[i] && t->run[k - 1].array == run->array)
                assert_true(t->run[k - 1].offset + t->run[k - 1].bytes < run->offset);
        }
        assert_true(bytes >= 64);
    }
    assert_int_equal(t->first[t->count], t->run_count);
}

static void parts_of_every_layout_and_storage_keep_the_laws(void **state)
{
    (void)state;
    static const uint64_t most[] = {400, 1024, 5000, 1 << 24};
    size_t played = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t s = 0; tri_stores[s]; s++) {
            struct traffic_case c;
            if (!traffic_case_open(SCENE, layouts_all[l]->name, tri_stores[s]->name, &c))
                continue;
            for (size_t i = 0; i < ARRAY_COUNT(most); i++) {
                struct reason reason = {""};
                enum status status = traffic_walker_make(&c.job, most[i], &c.walker, &reason);
                if (status == STATUS_INPUT && most[i] < 5000)
                    continue; /* a node with the triangles of its leaves is larger */
                assert_int_equal(status, STATUS_OK);
                assert_int_equal(treelets_runs(&c.walker.treelets, &c.walker.touch, &reason),
                                 STATUS_OK);
                check_parts(&c, most[i]);
                check_runs(&c);
                assert_true(i < 3 || c.walker.treelets.count == 1);
                traffic_walker_free(&c.walker);
                played++;
            }
            traffic_case_close(&c);
        }
    assert_true(played > 200);
}

static void add_items(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    (void)offset;
    *(uint64_t *)reader += array == TOUCH_ITEMS ? bytes : 0;
}

/* Leaves are adjacent, so that all of them read all words but the head. */
static void leaves_read_all_words_of_a_storage(void **state)
{
    (void)state;
    size_t played = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t s = 0; tri_stores[s]; s++) {
            struct traffic_case c;
            struct reason reason = {""};
            uint64_t bytes = 0;
            if (!traffic_case_open(SCENE, layouts_all[l]->name, tri_stores[s]->name, &c))
                continue;
            if (layouts_all[l]->item) {
                traffic_case_close(&c);
                continue;
            }
            assert_int_equal(traffic_walker_make(&c.job, 1 << 24, &c.walker, &reason), STATUS_OK);
            struct touch *touch = &c.walker.touch;
            touch->read = add_items;
            touch->reader = &bytes;
            for (uint32_t i = 0; i < c.walker.treelets.order_count; i++) {
                struct wide node;
                c.packed.layout->load(&c.packed, c.walker.treelets.order[i], &node);
                for (uint32_t k = 0; node.child_count == 0 && k < node.item_count; k++)
                    (void)packed_item(&touch->packed, &node, k);
            }
            assert_int_equal(bytes, packed_item_bytes(&c.packed) - 4 * tri_stores[s]->head_words);
            traffic_walker_free(&c.walker);
            traffic_case_close(&c);
            played++;
        }
    assert_true(played > 20);
}

/* A treelet that a node does not fit in is refused, with the number that would do. */
static void a_treelet_smaller_than_a_node_is_refused(void **state)
{
    (void)state;
    struct traffic_case c;
    struct reason reason = {""};
    assert_true(traffic_case_open(SCENE, "f32", "indexed", &c));
    assert_int_equal(traffic_walker_make(&c.job, 31, &c.walker, &reason), STATUS_INPUT);
    const char *has = strstr(reason.text, "has ");
    assert_non_null(has);
    uint64_t least = strtoull(has + 4, NULL, 10);
    assert_true(least > 32);
    assert_int_equal(traffic_walker_make(&c.job, least, &c.walker, &reason), STATUS_OK);
    traffic_walker_free(&c.walker);
    traffic_case_close(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_of_every_layout_and_storage_keep_the_laws),
        cmocka_unit_test(leaves_read_all_words_of_a_storage),
        cmocka_unit_test(a_treelet_smaller_than_a_node_is_refused),
    };
    return cmocka_run_group_tests_name("scene_treelets", tests, NULL, NULL) ? 1 : 0;
}
