/* Files of lavapipe with mistakes: what is wrong with a tree is named, and what is no such file is
 * refused, whatever its words say. */
#include "tests/driver_trees/tree_laws.h"

static struct lvp_file file;

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
        tree_must_refuse(&file, "t: structure at byte 0: box 1: child 1 is ");
    }
    lvp_write(&file, &world, NULL);
    lvp_put(&file, lvp_box_word(&file, 1, 0, 48), lvp_leaf_child(&file, 1, 0) | 2);
    tree_must_refuse(&file, "child 0 is an instance, in a level of triangles");
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
    tree_must_have_doubles(&dump);
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
    tree_must_lack_one(&dump.below[0], world.mesh[0].scene);
    tree_dump_free(&dump);
    lvp_put(&file, lvp_leaf_word(&file, 0, 0, 76), 0x7F800000);
    tree_must_refuse(&file, "instance 0: a number of its transform is not finite");
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
        tree_must_refuse(&file, tries[i].rule);
    }
    lvp_write(&file, &world, NULL);
    lvp_put(&file, file.body[0] + 24, 1);
    tree_must_refuse(&file, "its two heads differ");
    lvp_write(&file, &world, NULL);
    lvp_put(&file, file.body[0] + 28, 3);
    tree_must_refuse(&file, "its two heads differ");
    for (uint32_t by = 1; by < 3; by++) {
        lvp_write(&file, &world, NULL);
        lvp_put(&file, file.body[0] + 32, by == 1 ? 40 : 40 + 57);
        tree_must_refuse(&file, "its leaves begin at");
    }
    world_free(&world);
}

static void write_two_meshes(void)
{
    struct world world = lvp_two_meshes();
    lvp_write(&file, &world, NULL);
    world_free(&world);
}

static void structures_below_are_those_of_the_handles(void **state)
{
    (void)state;
    tree_must_be_whole(&file, write_two_meshes);
    tree_must_be_of_handles(&file, write_two_meshes);
    tree_must_say_where(&file, write_two_meshes);
}

static void any_word_may_be_anything(void **state)
{
    (void)state;
    static const uint32_t words[] = {0,          1,          41,         97,        0x60,
                                     0xFFFFFFFF, 0x7FFFFFFF, 0x7FC00000, 0x7F800000};
    struct world world = lvp_world("placed-turned:count=3");
    lvp_write(&file, &world, NULL);
    tree_must_end(&file, words, ARRAY_COUNT(words));
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
