/* Treelets are cut as they are told to be, by a second, plain cut; stacks that are full, accesses
 * of any bytes to DRAM, and which rule a machine breaks. */
#include "tests/traffic/traffic_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* --- cuts ------------------------------------------------------------------------------------- */

/* What a plain cut knows of each reference of a tree whose references each have a record. */
struct plain_cut {
    struct traffic_case *of;
    uint64_t *own, *below, most; /* bytes of it, and with all below it */
    double *area;
    uint32_t *treelet, *root, *front;
    uint32_t count, front_count;
};

static void add_bytes(void *reader, enum touch_array array, uint64_t offset, uint64_t bytes)
{
    (void)array;
    (void)offset;
    *(uint64_t *)reader += bytes;
}

static uint64_t weigh(struct plain_cut *cut, uint32_t ref)
{
    struct touch *touch = &cut->of->walker.touch;
    const struct packed *packed = &cut->of->packed;
    struct wide node;
    packed->layout->load(packed, ref, &node);
    touch->read = add_bytes;
    touch->reader = &cut->own[ref];
    for (uint32_t i = 0; node.child_count == 0 && i < node.item_count; i++)
        (void)packed_item(&touch->packed, &node, i);
    cut->own[ref] += packed->layout->node_bytes;
    cut->below[ref] = cut->own[ref];
    for (uint32_t c = 0; c < node.child_count; c++) {
        cut->area[node.child[c]] = box_half_area(&node.box[c]);
        cut->below[ref] += weigh(cut, node.child[c]);
    }
    return cut->below[ref];
}

static void take(struct plain_cut *cut, uint32_t ref)
{
    const struct packed *packed = &cut->of->packed;
    struct wide node;
    packed->layout->load(packed, ref, &node);
    cut->treelet[ref] = cut->count;
    for (uint32_t c = 0; c < node.child_count; c++)
        cut->front[cut->front_count++] = node.child[c];
}

/* The largest that waits. */
static uint32_t largest(struct plain_cut *cut)
{
    uint32_t best = 0;
    for (uint32_t i = 1; i < cut->front_count; i++)
        best = cut->area[cut->front[i]] > cut->area[cut->front[best]] ? i : best;
    const uint32_t ref = cut->front[best];
    cut->front[best] = cut->front[--cut->front_count];
    return ref;
}

static void cut_plainly(struct plain_cut *cut)
{
    uint32_t roots = 1;
    cut->root[0] = cut->of->packed.root;
    for (; cut->count < roots; cut->count++) {
        uint64_t bytes = cut->own[cut->root[cut->count]];
        const bool all = cut->below[cut->root[cut->count]] <= cut->most;
        bool full = false;
        take(cut, cut->root[cut->count]);
        while (cut->front_count > 0) {
            const uint32_t ref = largest(cut);
            const bool subtree = cut->below[ref] <= cut->most;
            if (all || (!full && !subtree && bytes + cut->own[ref] <= cut->most)) {
                bytes += cut->own[ref];
                take(cut, ref);
            } else {
                full = full || !subtree;
                cut->root[roots++] = ref;
            }
        }
    }
}

static void treelets_are_those_of_a_plain_cut(void **state)
{
    (void)state;
    static const uint64_t most[] = {300, 500, 900, 2000, 20000, 1 << 24};
    for (size_t i = 0; i < ARRAY_COUNT(most); i++) {
        struct traffic_case c;
        assert_true(traffic_case_open("soup:n=700,size=0.5", "f32", "indexed", &c));
        traffic_case_start(&c, 4, 1, most[i]);
        const size_t refs = c.packed.ref_count;
        struct plain_cut cut = {.of = &c,
                                .own = calloc(refs, sizeof *cut.own),
                                .below = calloc(refs, sizeof *cut.below),
                                .most = most[i],
                                .area = calloc(refs, sizeof *cut.area),
                                .treelet = calloc(refs, sizeof *cut.treelet),
                                .root = calloc(refs, sizeof *cut.root),
                                .front = calloc(refs, sizeof *cut.front)};
        const struct scene_treelets *t = &c.walker.treelets;
        (void)weigh(&cut, c.packed.root);
        cut_plainly(&cut);
        assert_int_equal(t->count, cut.count);
        assert_memory_equal(t->root, cut.root, cut.count * sizeof *cut.root);
        for (uint32_t k = 0; k < t->order_count; k++)
            assert_int_equal(t->of[t->order[k]], cut.treelet[t->order[k]]);
        for (uint32_t k = 0; k < cut.count; k++)
            for (uint32_t n = 0; n < t->order_count; n++)
                cut.below[k] =
                    (n ? cut.below[k] : 0) + (t->of[t->order[n]] == k ? cut.own[t->order[n]] : 0);
        for (uint32_t k = 0; k < cut.count; k++)
            assert_int_equal(t->bytes[k], cut.below[k]);
        free(cut.own);
        free(cut.below);
        free(cut.area);
        free(cut.treelet);
        free(cut.root);
        free(cut.front);
        traffic_case_stop(&c);
        traffic_case_close(&c);
    }
}

/* --- small machines --------------------------------------------------------------------------- */

/* Of few triangles, so that stacks and queues are full. */
static void full_stacks_and_queues_lose_nothing(void **state)
{
    (void)state;
    static const char *const layout[] = {"f32", "cwbvh80", "half4"};
    for (size_t n = 0; n < 3 * 6; n++) {
        struct traffic_case c;
        char spec[40];
        snprintf(spec, sizeof spec, "soup:n=%u,size=1", 4u << n / 3);
        assert_true(traffic_case_open(spec, layout[n % 3], "indexed", &c));
        traffic_case_start(&c, 40, 2, 800);
        struct traffic_machine m = traffic_small();
        for (m.queue = 1; m.queue <= 64; m.queue *= 4)
            for (size_t i = 0; schedulers[i]; i++) {
                const struct traffic_result r = traffic_case_play(&c, schedulers[i]->name, &m);
                assert_true(r.wrong == 0 && r.other == 0 && r.conserved);
            }
        traffic_case_stop(&c);
        traffic_case_close(&c);
    }
}

/* Whole bursts, of whatever bytes. */
static void dram_moves_the_bursts_of_any_bytes(void **state)
{
    (void)state;
    const struct traffic_memory_size size = {
        .cache = {{64, 1, 64}, {64, 1, 64}}, .units = 1, .row_bytes = 1024};
    for (uint64_t from = 0; from < 130; from++)
        for (uint64_t bytes = 0; bytes < 200; bytes++) {
            struct traffic_memory m;
            assert_int_equal(traffic_memory_make(&size, &m, NULL), STATUS_OK);
            traffic_access(&m, 0, TRAFFIC_DRAM, TRAFFIC_AT_RAYS, from, bytes, bytes % 2);
            const uint64_t bursts = bytes ? (from + bytes - 1) / 64 - from / 64 + 1 : 0;
            const struct traffic_count *count = &m.count[TRAFFIC_DRAM];
            assert_int_equal(count->read + count->written, 64 * bursts);
            assert_int_equal(bytes % 2 ? count->read : count->written, 0);
            traffic_memory_free(&m);
            assert_true(!m.cache && m.count[TRAFFIC_DRAM].read == 0 && m.row_misses == 0);
        }
}

/* The first and the last number that each part may be, and those beside them. */
static void wrong_machines_are_named(void **state)
{
    (void)state;
    static const char *const what[] = {"units", "lanes", "rays of a packet", "bytes of a treelet",
                                       "rays in queues"};
    static const uint64_t most[] = {64, 256, 64, 1u << 30, 1u << 28};
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 4; k++) {
            const uint64_t value = (const uint64_t[]){0, 1, most[i], most[i] + 1}[k];
            struct traffic_machine m = traffic_small();
            struct reason reason = {""};
            char text[80];
            m.memory.units = i == 0 ? (uint32_t)value : 1;
            m.lanes = i == 1 ? (uint32_t)value : 1;
            m.packet = i == 2 ? (uint32_t)value : 1;
            m.treelet = i == 3 ? value : 1;
            m.queue = i == 4 ? value : 1;
            snprintf(text, sizeof text, "%s: %llu is not in 1 to %llu", what[i],
                     (unsigned long long)value, (unsigned long long)most[i]);
            const bool right = k == 1 || k == 2;
            assert_int_equal(traffic_machine_check(&m, &reason), right ? STATUS_OK : STATUS_INPUT);
            if (i > 0 || k > 0) /* of no unit the memory tells */
                assert_string_equal(reason.text, right ? "" : text);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(treelets_are_those_of_a_plain_cut),
        cmocka_unit_test(full_stacks_and_queues_lose_nothing),
        cmocka_unit_test(dram_moves_the_bursts_of_any_bytes),
        cmocka_unit_test(wrong_machines_are_named),
    };
    return cmocka_run_group_tests_name("traffic_cuts", tests, NULL, NULL) ? 1 : 0;
}
