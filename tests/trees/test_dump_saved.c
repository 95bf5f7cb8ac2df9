/* Files of tinybvh and bvh v2, written by the tests from their descriptions: the trees come
 * again, what is wrong with one is named, and what is no such file is refused. */
#define _POSIX_C_SOURCE 200809L
#include "tests/trees/saved.h"

static struct saved file;

enum { TINY, BVH2, KINDS };

static void save(int kind, const struct bvh *bvh)
{
    if (kind == TINY)
        saved_tinybvh(bvh, bvh_is_split(bvh), &file);
    else
        saved_bvh2(bvh, &file);
}

static size_t node_at(int kind, uint32_t node)
{
    return kind == TINY ? saved_tiny_node(node) : saved_bvh2_node(node);
}

static enum status read_file(unsigned format, struct tree_dump *dump, struct reason *reason)
{
    return tree_dump_read("t", (const char *)file.bytes, file.size, format, dump, reason);
}

static struct tree_dump read_ok(int kind)
{
    struct tree_dump dump;
    struct reason reason = {""};
    if (read_file(DUMP_GUESSED, &dump, &reason))
        fail_msg("%s", reason.text);
    assert_string_equal(dump.format, kind == TINY ? "tinybvh" : "bvh2");
    return dump;
}

static void trees_come_again(void **state)
{
    (void)state;
    static const char *const builder[] = {"median", "sah_sweep", "lbvh"};
    for (uint32_t i = 0; i < 2 * BUILT_SCENES * ARRAY_COUNT(builder); i++) {
        const int kind = (int)(i % KINDS);
        const char *what;
        struct dumped d = dumped_make(built_scene(i / 2 % BUILT_SCENES, &what),
                                      builder[i / 2 / BUILT_SCENES], 1 + i % 15);
        save(kind, &d.bvh);
        struct tree_dump dump = read_ok(kind);
        struct dump_report report = dump_found(&dump, &d.scene);
        struct bvh_stats stats;
        assert_int_equal(bvh_count(&d.bvh, &d.scene, &stats, NULL), STATUS_OK);
        assert_int_equal(report.faults, 0);
        assert_int_equal(report.nodes, stats.node_count);
        assert_int_equal(dump.node_count, stats.node_count + (kind == TINY));
        assert_int_equal(report.leaves, stats.leaf_count);
        assert_int_equal(report.depth, stats.depth);
        assert_int_equal(report.largest_leaf, stats.largest_leaf);
        assert_int_equal(report.items, d.bvh.prim_count);
        assert_int_equal(report.loose, 0);
        assert_int_equal(dump.bytes, dump.node_count * (kind == TINY ? 32u : 28u));
        const double sah = tree_sah(&d.bvh);
        assert_true(fabs(report.sah - sah) <= 1e-12 * sah);
        free(report.fault);
        tree_dump_free(&dump);
        dumped_free(&d);
    }
}

/* A leaf box's bound one float further in: which place of the file holds it, and the fault. */
static void bounds_lie_where_the_format_says(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(40, 2), "median", 3);
    for (int kind = 0; kind < KINDS; kind++)
        for (unsigned side = 0; side < 6; side++) {
            save(kind, &d.bvh);
            struct tree_dump whole = read_ok(kind);
            const uint32_t node = (uint32_t)whole.node_count - 1;
            const size_t at = node_at(kind, node) + (kind == TINY ? 4 * side + (side > 2 ? 4 : 0)
                                                                  : 8 * (side % 3) + side / 3 * 4);
            const float bound = float_from_bits(saved_get(&file, at));
            assert_true(bound == (side < 3 ? whole.node[node].box.lo[side]
                                           : whole.node[node].box.hi[side - 3]));
            saved_set(&file, at, float_bits(nextafterf(bound, side < 3 ? INFINITY : -INFINITY)));
            struct tree_dump dump = read_ok(kind);
            struct dump_report report = dump_found(&dump, &d.scene);
            assert_int_equal(report.faults, 1);
            const struct dump_fault fault = dump_fault_of(&report, DUMP_SMALL);
            assert_int_equal(fault.node, node);
            assert_int_equal(fault.side, side);
            free(report.fault);
            tree_dump_free(&dump);
            tree_dump_free(&whole);
        }
    dumped_free(&d);
}

/* What the first word of a node's range, or its only one, becomes; the fault that must be named. */
static void ranges_that_are_wrong_are_named(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(40, 2), "median", 3);
    const uint32_t items = d.bvh.prim_count;
    for (int kind = 0; kind < KINDS; kind++) {
        save(kind, &d.bvh);
        struct tree_dump whole = read_ok(kind);
        const uint32_t last = (uint32_t)whole.node_count - 1, count = whole.node[last].count;
        uint32_t inner = last;
        while (whole.node[inner].leaf || inner == whole.unused)
            inner--;
        const struct {
            uint32_t node, first;
            enum dump_rule rule;
        } tries[] = {{last, items, DUMP_RANGE},      {last, items - count + 1, DUMP_RANGE},
                     {last, 0, DUMP_TAKEN},          {inner, 0, DUMP_CYCLE},
                     {inner, inner - 1, DUMP_CYCLE}, {inner, last + 1, DUMP_CHILD},
                     {inner, last, DUMP_CHILD}};
        for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
            const bool leaf = tries[i].node == last;
            save(kind, &d.bvh);
            const size_t at = node_at(kind, tries[i].node) + (kind == TINY ? 12 : 24);
            saved_set(&file, at,
                      kind == TINY ? tries[i].first : 16 * tries[i].first + (leaf ? count : 0));
            struct tree_dump dump = read_ok(kind);
            struct dump_report report = dump_found(&dump, &d.scene);
            assert_true(report.count[tries[i].rule] > 0);
            for (size_t f = 0; f < report.fault_count; f++)
                if (report.fault[f].rule == tries[i].rule)
                    assert_true(report.fault[f].node == tries[i].node ||
                                tries[i].rule == DUMP_TAKEN);
            free(report.fault);
            tree_dump_free(&dump);
        }
        tree_dump_free(&whole);
    }
    dumped_free(&d);
}

/* tinybvh says by a flag that a tree splits, and by another that it has holes. */
static void flags_of_tinybvh_are_read(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(40, 2), "median", 3);
    for (int splits = 0; splits < 2; splits++) {
        saved_tinybvh(&d.bvh, splits, &file);
        const size_t item = file.size - 4;
        saved_set(&file, item, saved_get(&file, item - 4)); /* twice in a leaf */
        struct tree_dump dump = read_ok(TINY);
        assert_int_equal(dump.splits, splits);
        assert_int_equal(dump.tri_count, 40);
        struct dump_report report = dump_found(&dump, &d.scene);
        assert_int_equal(report.count[DUMP_DOUBLED], 1);
        assert_int_equal(report.count[DUMP_MISSING], 1);
        free(report.fault);
        tree_dump_free(&dump);
    }
    saved_tinybvh(&d.bvh, false, &file);
    const uint32_t nodes = saved_get(&file, 8 + 40);
    memmove(file.bytes + saved_tiny_node(nodes + 1), file.bytes + saved_tiny_node(nodes),
            file.size - saved_tiny_node(nodes));
    file.size += 32;
    saved_set(&file, 8 + 40, nodes + 1);
    for (unsigned char holes = 0; holes < 2; holes++) {
        file.bytes[8 + 2] = holes;
        struct tree_dump dump = read_ok(TINY);
        struct dump_report report = dump_found(&dump, &d.scene);
        assert_int_equal(report.faults, holes ? 0 : 1);
        assert_int_equal(report.count[DUMP_UNREACHED], !holes);
        free(report.fault);
        tree_dump_free(&dump);
    }
    dumped_free(&d);
}

static void must_refuse(unsigned format, const char *rule)
{
    struct tree_dump dump;
    struct reason reason = {""};
    assert_int_equal(read_file(format, &dump, &reason), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        fail_msg("%s, not %s", reason.text, rule);
    assert_null(dump.node);
}

static void another_version_is_refused_with_both(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(40, 2), "median", 3);
    saved_tinybvh(&d.bvh, false, &file);
    saved_set(&file, 0, 167 | 1u << 24);
    must_refuse(DUMP_GUESSED, "t: version 167 of tinybvh's cache format; version 166 is read");
    saved_set(&file, 0, 0x010607 | 1u << 24);
    must_refuse(DUMP_GUESSED, "t: written by tinybvh 1.6.7; version 166 of its cache format");
    saved_set(&file, 0, 166 | 10u << 24);
    must_refuse(DUMP_GUESSED, "t: tinybvh's layout 10 (BVH8_CWBVH); layout 1 (BVH) is read");
    saved_set(&file, 0, 166 | 99u << 24);
    must_refuse(DUMP_TINYBVH, "t: tinybvh's layout 99 (unknown); layout 1 (BVH) is read");
    saved_tinybvh(&d.bvh, false, &file);
    saved_set(&file, 8 + 32, 2);
    must_refuse(DUMP_GUESSED, "t: the object tells another layout or number of triangles");
    saved_tinybvh(&d.bvh, false, &file);
    saved_set(&file, 4, 41);
    must_refuse(DUMP_GUESSED, "t: the object tells another layout or number of triangles");
    saved_set(&file, 8 + 44, 41);
    must_refuse(DUMP_GUESSED, "t: 40 indices for 41 triangles");
    file.size = 0; /* bvh v2 with nodes of double: one leaf of one triangle */
    for (int i = 0; i < 20; i++)
        saved_word(&file, i == 0 || i == 2 ? 1 : 0);
    must_refuse(DUMP_GUESSED, "t: bvh v2 with nodes of double; those of float are read");
    must_refuse(DUMP_BVH2, "t: bvh v2 with nodes of double; those of float are read");
    dumped_free(&d);
}

/* Cut or longer by any number of bytes: no tree. */
static void files_of_another_length_are_refused(void **state)
{
    (void)state;
    struct dumped d = dumped_make(built_soup(20, 2), "median", 3);
    for (int kind = 0; kind < KINDS; kind++) {
        save(kind, &d.bvh);
        const size_t whole = file.size;
        for (size_t size = 0; size < whole + 40; size++) {
            struct tree_dump dump = {0};
            file.size = size;
            const enum status status =
                read_file(kind == TINY ? DUMP_TINYBVH : DUMP_BVH2, &dump, NULL);
            assert_int_equal(status, size == whole ? STATUS_OK : STATUS_INPUT);
            tree_dump_free(&dump);
        }
    }
    dumped_free(&d);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(trees_come_again),
        cmocka_unit_test(bounds_lie_where_the_format_says),
        cmocka_unit_test(ranges_that_are_wrong_are_named),
        cmocka_unit_test(flags_of_tinybvh_are_read),
        cmocka_unit_test(another_version_is_refused_with_both),
        cmocka_unit_test(files_of_another_length_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
