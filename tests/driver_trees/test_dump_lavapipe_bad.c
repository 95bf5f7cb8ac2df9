/* Files of lavapipe with mistakes: what is wrong with a tree is named, and what is no such file is
 * refused, whatever its words say. */
#include "tests/driver_trees/lavapipe_file.h"

static struct lvp_file file;

static void must_refuse(const char *rule)
{
    struct tree_dump dump;
    struct reason reason = {""};
    assert_int_equal(lvp_read(&file, file.size, &dump, &reason), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        fail_msg("%s, not %s", reason.text, rule);
    assert_true(!dump.node && !dump.below && !dump.instance && !dump.source);
}

static void children_that_make_no_tree_are_named(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    const struct {
        uint32_t box, leaf; /* the child that it becomes; box UINT32_MAX: that leaf */
        enum dump_rule rule;
    } tries[] = {{0, 0, DUMP_CYCLE},
                 {1, 0, DUMP_CYCLE},
                 {UINT32_MAX, 0, DUMP_SHARED},
                 {UINT32_MAX, 1, DUMP_UNREACHED}};
    for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
        lvp_write(&file, &world, NULL);
        /* Child 1 of box 1, which was box 2. */
        lvp_put(&file, lvp_box_word(&file, 0, 1, 52),
                tries[i].box == UINT32_MAX ? lvp_leaf_child(&file, 0, tries[i].leaf)
                                           : lvp_box_child(tries[i].box));
        struct tree_dump dump = lvp_read_ok(&file);
        struct dump_report report = lvp_found(&dump);
        assert_true(report.count[tries[i].rule] > 0);
        assert_true(report.count[DUMP_UNREACHED] > 0);
        free(report.fault);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* What no box leads to lacks nothing of a box that it does not have. */
static void leaves_without_a_box_are_not_measured(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    for (uint32_t i = 0; i + 1 < world.instance_count; i++) {
        lvp_write(&file, &world, NULL);
        lvp_put(&file, lvp_box_word(&file, 0, i, 48), 0xFFFFFFFF);
        struct tree_dump dump = lvp_read_ok(&file);
        const struct dump_lacks lacks = lvp_measured(&dump);
        assert_int_equal(lacks.judged, world.instance_count - 1);
        assert_int_equal(lacks.small + lacks.sides, 0);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

static void children_that_are_nowhere_are_refused(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    lvp_write(&file, &world, NULL);
    const size_t at = lvp_box_word(&file, 0, 1, 52);
    const uint32_t leaf = lvp_leaf_child(&file, 0, 0);
    const uint32_t bad[] = {leaf + 4,
                            leaf + 120 * 4,
                            leaf - 120,
                            lvp_box_child(3),
                            lvp_box_child(0) + 4,
                            lvp_box_child(0) - 56,
                            0xFFFFFFF1,
                            leaf ^ 2,
                            leaf ^ 1,
                            leaf ^ 3,
                            2,
                            0};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        lvp_put(&file, at, bad[i]);
        must_refuse("t: structure at byte 0: box 1: child 1 is ");
    }
    lvp_write(&file, &world, NULL);
    lvp_put(&file, lvp_box_word(&file, 1, 0, 48), lvp_leaf_child(&file, 1, 0) | 2);
    must_refuse("child 0 is an instance, in a level of triangles");
    world_free(&world);
}

/* A number that is twice in the leaves. */
static void doubled_numbers_are_named(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    lvp_write(&file, &world, NULL);
    lvp_put(&file, lvp_leaf_word(&file, 0, 3, 68), 1);
    lvp_put(&file, lvp_leaf_word(&file, 1, 3, 40), 1);
    struct tree_dump dump = lvp_read_ok(&file);
    struct dump_report report = lvp_found(&dump);
    char text[DUMP_FAULT_TEXT];
    assert_int_equal(report.count[DUMP_DOUBLED], 1);
    assert_int_equal(dump.tri_count, 3);
    for (size_t i = 0; i < report.fault_count; i++)
        if (report.fault[i].rule == DUMP_DOUBLED)
            assert_non_null(strstr(dump_fault_text(&report.fault[i], text), "instance 1"));
    free(report.fault);
    report = lvp_found(&dump.below[0]);
    assert_int_equal(report.count[DUMP_DOUBLED], 1);
    free(report.fault);
    tree_dump_free(&dump);
    world_free(&world);
}

/* Triangles that cannot be hit are in no tree of ours: their leaves are empty. */
static void triangles_with_nan_are_no_items(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    lvp_write(&file, &world, NULL);
    lvp_put(&file, lvp_leaf_word(&file, 1, 7, 16), 0x7FC00000);
    struct tree_dump dump = lvp_read_ok(&file);
    struct dump_report report = lvp_found(&dump.below[0]);
    assert_int_equal(report.items, world.mesh[0].scene->tri_count - 1);
    assert_int_equal(report.empty_leaves, 1);
    assert_int_equal(report.faults, 0);
    free(report.fault);
    tree_dump_free(&dump);
    lvp_put(&file, lvp_leaf_word(&file, 0, 0, 76), 0x7F800000);
    must_refuse("instance 0: a number of its transform is not finite");
    world_free(&world);
}

static void heads_that_are_wrong_are_refused(void **state)
{
    (void)state;
    static const struct {
        size_t at;
        uint32_t word;
        const char *rule;
    } tries[] = {
        {32, 1 << 30, "t: no tree of a known format"},
        {40, 96, "structure at byte 0: its head tells "},
        {48, 2, "structure at byte 0: its head tells "},
        {0, 0x312e3532, "of lavapipe 25.1.7-2~bpo12+1; that of lavapipe 25.0.x is read"},
        {0, 0x2d6c6176, "of the driver with the UUID val-.7-2~bpo12+1; lavapipe 25.0.x is read"},
        {0, 1, "of the driver with the UUID 010000002e372d327e62706f31322b31; lavapipe 25.0.x"},
        {16, 0x312e3532, "of lavapipe 25.0.7-2~bpo12+1, but compatible with 25.1.7-2~bpo12+1"},
    };
    struct world world = lvp_world("placed-turned:count=4");
    for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
        lvp_write(&file, &world, NULL);
        lvp_put(&file, tries[i].at, tries[i].word);
        must_refuse(tries[i].rule);
    }
    lvp_write(&file, &world, NULL);
    lvp_put(&file, file.body[0] + 24, 1);
    must_refuse("its two heads differ");
    lvp_write(&file, &world, NULL);
    lvp_put(&file, file.body[0] + 28, 3);
    must_refuse("its two heads differ");
    for (uint32_t by = 1; by < 3; by++) {
        lvp_write(&file, &world, NULL);
        lvp_put(&file, file.body[0] + 32, by == 1 ? 40 : 40 + 57);
        must_refuse("its leaves begin at");
    }
    world_free(&world);
}

static void structures_below_are_those_of_the_handles(void **state)
{
    (void)state;
    struct world world = lvp_two_meshes();
    lvp_write(&file, &world, NULL);
    const size_t all = file.size;
    for (size_t size = 0; size < all; size += size < 256 ? 1 : 61 + size % 2) {
        struct tree_dump dump;
        struct reason reason = {""};
        if (size == file.begin[1])
            continue;
        const unsigned char was = file.bytes[size];
        file.bytes[size] = 0; /* as behind a file that is read */
        assert_int_equal(lvp_read(&file, size, &dump, &reason), STATUS_INPUT);
        file.bytes[size] = was;
    }
    file.size = file.begin[1];
    struct tree_dump dump = lvp_read_ok(&file);
    assert_int_equal(dump.below_count, 0);
    assert_int_equal(dump.scene.tri_count, 0);
    for (uint32_t i = 0; i < dump.tri_count; i++)
        assert_true(dump.instance[i].below == DUMP_NO_TREE);
    tree_dump_free(&dump);
    file.size = file.begin[2];
    must_refuse("t: 1 structures below the top level, whose handles name ");
    lvp_write(&file, &world, NULL);
    const size_t length = file.begin[2] - file.begin[1], whole = file.size;
    memcpy(file.bytes + whole, file.bytes + file.begin[1], length);
    file.size += length;
    must_refuse("one more than the ");
    memcpy(file.bytes + whole, file.bytes, file.begin[1]);
    file.size = whole + file.begin[1];
    must_refuse("one more than the ");
    lvp_write(&file, &world, NULL);
    memmove(file.bytes, file.bytes + file.begin[1], file.size - file.begin[1]);
    file.size -= file.begin[1];
    must_refuse("bytes behind a bottom level");
    world_free(&world);
}

/* Whatever a word says, reading and checking end. */
static void any_word_may_be_anything(void **state)
{
    (void)state;
    static const uint32_t words[] = {0,          1,          41,         97,        0x60,
                                     0xFFFFFFFF, 0x7FFFFFFF, 0x7FC00000, 0x7F800000};
    struct world world = lvp_world("placed-turned:count=3");
    lvp_write(&file, &world, NULL);
    const size_t words_of = file.size / 4 < 400 ? file.size / 4 : 400;
    for (size_t at = 0; at < words_of; at++)
        for (size_t i = 0; i < ARRAY_COUNT(words); i++) {
            const uint32_t was = lvp_get(&file, 4 * at);
            struct tree_dump dump;
            struct reason reason = {""};
            lvp_put(&file, 4 * at, words[i]);
            const enum status status = lvp_read(&file, file.size, &dump, &reason);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            if (!status) {
                struct dump_report report = lvp_found(&dump);
                free(report.fault);
                if (dump.scene.tri_count && dump.instance)
                    (void)lvp_measured(&dump);
                tree_dump_free(&dump);
            }
            lvp_put(&file, 4 * at, was);
        }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(children_that_make_no_tree_are_named),
        cmocka_unit_test(leaves_without_a_box_are_not_measured),
        cmocka_unit_test(children_that_are_nowhere_are_refused),
        cmocka_unit_test(doubled_numbers_are_named),
        cmocka_unit_test(triangles_with_nan_are_no_items),
        cmocka_unit_test(heads_that_are_wrong_are_refused),
        cmocka_unit_test(structures_below_are_those_of_the_handles),
        cmocka_unit_test(any_word_may_be_anything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
