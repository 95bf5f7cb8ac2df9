/* What nodes that the root does not lead to, and numbers at the end of their range, change of what
 * is found: faults alone. */
#define _POSIX_C_SOURCE 200809L
#include "tests/trees/dump_fixture.h"
#include "tests/trees/saved.h"

/* Adds nodes that nothing leads to, with large boxes. */
static void add_islands(struct tree_dump *dump, uint32_t islands)
{
    const size_t count = dump->node_count;
    struct dump_node *node = realloc(dump->node, (count + islands) * sizeof *node);
    assert_non_null(node);
    dump->node = node;
    for (uint32_t i = 0; i < islands; i++)
        node[count + i] = (struct dump_node){.leaf = i % 2 == 0,
                                             .box = {{-1000, -1000, -1000}, {1000, 1000, 1000}}};
    dump->node_count += islands;
}

static void nodes_that_nothing_leads_to_measure_nothing(void **state)
{
    (void)state;
    for (uint32_t islands = 1; islands < 6; islands++)
        for (int known = 0; known < 2; known++) {
            struct dumped d = dumped_make(built_soup(64, 7), "median", 2);
            const struct scene *scene = known ? &d.scene : NULL;
            struct dump_report before = dump_found(&d.dump, scene);
            add_islands(&d.dump, islands);
            struct dump_report after = dump_found(&d.dump, scene);
            assert_int_equal(after.faults, before.faults + islands);
            assert_int_equal(after.count[DUMP_UNREACHED], islands);
            for (uint32_t i = 0; i < islands; i++)
                assert_int_equal(after.fault[i].node, d.dump.node_count - islands + i);
            free(before.fault);
            free(after.fault);
            after.faults = before.faults;
            after.fault_count = before.fault_count;
            after.fault = before.fault;
            memcpy(after.count, before.count, sizeof after.count);
            if (!known) /* a NaN, which is not measured without a scene */
                after.overlap = before.overlap = 0;
            assert_memory_equal(&after, &before, sizeof after);
            dumped_free(&d);
        }
}

/* Neighbours that begin with the last number: neither is a node, and none is another's. */
static void the_neighbour_of_the_last_number_is_none(void **state)
{
    (void)state;
    static struct saved file;
    struct dumped d = dumped_make(built_soup(20, 2), "median", 3);
    for (uint32_t first = UINT32_MAX; first > UINT32_MAX - 3; first--) {
        struct tree_dump dump;
        struct reason reason = {""};
        saved_tinybvh(&d.bvh, false, &file);
        saved_set(&file, saved_tiny_node(0) + 12, first);
        if (tree_dump_read("t", (const char *)file.bytes, file.size, DUMP_TINYBVH, &dump, &reason))
            fail_msg("%s", reason.text);
        struct dump_report report = dump_found(&dump, &d.scene);
        assert_int_equal(report.count[DUMP_CHILD], 2);
        assert_int_equal(report.count[DUMP_CYCLE] + report.count[DUMP_SHARED], 0);
        free(report.fault);
        tree_dump_free(&dump);
    }
    dumped_free(&d);
}

/* Where neither a scene nor the file tells how many triangles there are, it is one more than the
 * largest number of an item, but not more than the items are: as if that were told. */
static void numbers_of_items_tell_how_many_triangles_there_are(void **state)
{
    (void)state;
    struct rng rng = rng_make(23, 0);
    for (uint32_t turn = 0; turn < 400; turn++) {
        struct dumped d = dumped_make(built_soup(1 + rng_below(&rng, 12), turn), "median", 2);
        const uint32_t items = (uint32_t)d.dump.item_count;
        uint64_t count = 0;
        for (uint32_t i = 0; i < items; i++) {
            const uint32_t any[] = {rng_below(&rng, items), items - 1, items, items + 1,
                                    UINT32_MAX};
            if (rng_below(&rng, 3) == 0)
                d.dump.item[i] = any[rng_below(&rng, 1 + turn % ARRAY_COUNT(any))];
            count = d.dump.item[i] >= count ? (uint64_t)d.dump.item[i] + 1 : count;
        }
        d.dump.tri_known = false;
        struct dump_report guessed = dump_found(&d.dump, NULL);
        d.dump.tri_known = true;
        d.dump.tri_count = (uint32_t)(count < items ? count : items);
        struct dump_report told = dump_found(&d.dump, NULL);
        assert_memory_equal(guessed.count, told.count, sizeof told.count);
        assert_int_equal(guessed.fault_count, told.fault_count);
        for (size_t i = 0; i < told.fault_count; i++) {
            char text[2][DUMP_FAULT_TEXT];
            assert_string_equal(dump_fault_text(&guessed.fault[i], text[0]),
                                dump_fault_text(&told.fault[i], text[1]));
        }
        free(guessed.fault);
        free(told.fault);
        dumped_free(&d);
    }
}

/* However many bounds of a node are no numbers: it is one fault, told with the first of them. */
static void bounds_that_are_no_numbers_are_one_fault(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(64, 7), "median", 2);
    for (uint32_t node = 0; node < d.dump.node_count; node += 9) {
        const struct box whole = d.dump.node[node].box;
        for (unsigned sides = 1; sides < 64; sides++) {
            struct box *box = &d.dump.node[node].box;
            unsigned first = 6;
            for (unsigned side = 6; side-- > 0;)
                if (sides >> side & 1) {
                    *(side < 3 ? &box->lo[side] : &box->hi[side - 3]) = NAN;
                    first = side;
                }
            struct dump_report report = dump_found(&d.dump, &d.scene);
            assert_int_equal(report.faults, 1);
            const struct dump_fault fault = dump_fault_of(&report, DUMP_NAN);
            assert_int_equal(fault.node, node);
            assert_int_equal(fault.side, first);
            free(report.fault);
            *box = whole;
        }
    }
    dumped_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_that_are_no_numbers_are_one_fault),
        cmocka_unit_test(nodes_that_nothing_leads_to_measure_nothing),
        cmocka_unit_test(the_neighbour_of_the_last_number_is_none),
        cmocka_unit_test(numbers_of_items_tell_how_many_triangles_there_are),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
