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

static double surface_of(const struct traffic_case *c, uint32_t parent, uint32_t ref)
{
    struct wide node;
    double side[3];
    uint32_t slot = 0;
    c->packed.layout->load(&c->packed, parent, &node);
    while (node.child[slot] != ref)
        slot++;
    for (int k = 0; k < 3; k++)
        side[k] = (double)node.box[slot].hi[k] - (double)node.box[slot].lo[k];
    return side[0] * side[1] + side[0] * side[2] + side[1] * side[2];
}

/* What a treelet takes has no less surface than what was there to take and is left: nodes with more
 * below them than fits, beside a node that it takes or beside one above that. */
static void check_largest_first(const struct traffic_case *c, size_t *looked)
{
    const struct scene_treelets *t = &c->walker.treelets;
    bool *cut = calloc(t->count, sizeof *cut); /* whether treelets hang below it */
    assert_non_null(cut);
    for (uint32_t i = 1; i < t->count; i++)
        cut[t->of[t->parent[t->root[i]]]] = true;
    for (uint32_t i = 0; i < t->order_count; i++) {
        const uint32_t ref = t->order[i], of = t->of[ref];
        uint32_t way;
        if (!cut[of] || t->root[of] == ref ||
            touch_record(&c->packed, ref, &way) == touch_record(&c->packed, t->parent[ref], &way))
            continue;
        const double taken = surface_of(c, t->parent[ref], ref);
        for (uint32_t at = ref; at != t->root[of]; at = t->parent[at]) {
            struct wide node;
            c->packed.layout->load(&c->packed, t->parent[at], &node);
            for (uint32_t s = 0; s < node.child_count; s++) {
                const uint32_t left = t->of[node.child[s]];
                if (left == of || !cut[left])
                    continue;
                assert_true(surface_of(c, t->parent[at], node.child[s]) <= taken);
                ++*looked;
            }
        }
    }
    free(cut);
}

/* --- bursts ----------------------------------------------------------------------------------- */

#define ARRAYS      4u
#define BURSTS_MOST 4096u /* of an array */
#define BURST_ORDER 64u

static unsigned char is_read[ARRAYS][BURSTS_MOST];

static void mark(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    (void)reader;
    for (uint64_t at = offset; at < offset + bytes; at++) {
        assert_true(at / BURST_ORDER < BURSTS_MOST);
        is_read[array][at / BURST_ORDER] = 1;
    }
}

/* Marks the bursts of which a node, or the items of a leaf, read a byte. */
static void mark_node(struct touch *touch, uint32_t ref)
{
    struct wide node;
    touch->packed.layout->load(&touch->packed, ref, &node);
    for (uint32_t i = 0; node.child_count == 0 && i < node.item_count; i++)
        (void)packed_item(&touch->packed, &node, i);
}

/* The runs of each treelet are the bursts of which its nodes read a byte, and no others. */
static void check_bursts(struct traffic_case *c)
{
    struct touch *touch = &c->walker.touch;
    const struct scene_treelets *t = &c->walker.treelets;
    const struct touch before = *touch;
    touch->read = mark;
    for (uint32_t i = 0; i < t->count; i++) {
        memset(is_read, 0, sizeof is_read);
        for (uint32_t at = 0; at < t->order_count; at++)
            if (t->of[t->order[at]] == i)
                mark_node(touch, t->order[at]);
        if (i == 0)
            (void)touch->packed.layout->box(&touch->packed, c->packed.root);
        for (size_t k = t->first[i]; k < t->first[i + 1]; k++)
            for (uint64_t at = t->run[k].offset; at < t->run[k].offset + t->run[k].bytes;
                 at += BURST_ORDER) {
                assert_int_equal(is_read[t->run[k].array][at / BURST_ORDER], 1);
                is_read[t->run[k].array][at / BURST_ORDER] = 2;
            }
        for (size_t k = 0; k < sizeof is_read; k++)
            assert_int_not_equal(is_read[k / BURSTS_MOST][k % BURSTS_MOST], 1);
    }
    touch->read = before.read;
    touch->reader = before.reader;
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
    size_t played = 0, looked = 0;
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
                check_largest_first(&c, &looked);
                if (s == 0 && i > 0)
                    check_bursts(&c);
                assert_true(i < 3 || c.walker.treelets.count == 1);
                traffic_walker_free(&c.walker);
                played++;
            }
            traffic_case_close(&c);
        }
    assert_true(played > 200 && looked > 1000);
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
