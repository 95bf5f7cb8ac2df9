/* Files of RADV with mistakes: what is wrong with a tree is named, and what is no such file is
 * refused, whatever its words say. */
#include "tests/driver_trees/radv_file.h"
#include "tests/driver_trees/tree_laws.h"

static struct rdv_file file;

/* Child 0 of the second box, of instances 3 to 6. */
static size_t second_box(void)
{
    return file.node[0] + 128 + 128 * 7;
}

static void children_that_make_no_tree_are_named(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=7");
    for (int halves = 0; halves < 2; halves++)
        for (int to = 0; to < 3; to++) {
            rdv_write(&file, &world, halves);
            const uint32_t bad[] = {5, rdv_id(&file, 0, second_box(), halves ? 4 : 5),
                                    rdv_leaf_id(&file, 0, 1)};
            lvp_put(&file.raw, second_box(), bad[to]);
            struct tree_dump dump = rdv_read_ok(&file);
            struct dump_report report = lvp_found(&dump);
            assert_int_equal(report.count[to < 2 ? DUMP_CYCLE : DUMP_SHARED], 1);
            /* Instance 3 is in no box now, so that the file has none of it. */
            assert_int_equal(dump.tri_count, 6);
            assert_true(lvp_compared(&dump, &world).instances > 0);
            free(report.fault);
            tree_dump_free(&dump);
        }
    world_free(&world);
}

static void children_that_are_nowhere_are_refused(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=7");
    rdv_write(&file, &world, false);
    const uint32_t leaf = rdv_leaf_id(&file, 0, 3), box = rdv_id(&file, 0, second_box(), 5);
    const struct {
        uint32_t id;
        const char *rule;
    } bad[] = {
        {leaf + 8, "an instance where none is"},
        {rdv_leaf_id(&file, 0, 7), "an instance where none is"},
        {6, "an instance where none is"},
        {box + 16, "beyond the nodes"},
        {box + 8, "beyond the nodes"},
        {0xFFFFFFFE, "beyond the nodes"},
        {0x80000005, "beyond the nodes"},
        {box ^ 1, "within another node"},
        {5 + 8, "within another node"},
        {leaf & ~7u, "a triangle, in a level of instances"},
        {leaf | 7, "a box of a shader's own"},
        {(leaf & ~7u) | 1, "a node of a kind that RADV does not write"},
        {(leaf & ~7u) | 3, "a node of a kind that RADV does not write"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        char text[160];
        rdv_write(&file, &world, false);
        lvp_put(&file.raw, second_box(), bad[i].id);
        snprintf(text, sizeof text,
                 "t: structure at byte 0: box at offset 1024: child 0 is 0x%08x, %s", bad[i].id,
                 bad[i].rule);
        tree_must_refuse(&file.raw, text);
    }
    rdv_write_mesh(&file, &world, false);
    lvp_put(&file.raw, file.node[0], rdv_leaf_id(&file, 0, 0) | 6);
    tree_must_refuse(&file.raw, "an instance, in a level of triangles");
    world_free(&world);
}

/* A number that is twice in the leaves. */
static void doubled_numbers_are_named(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    rdv_write(&file, &world, true);
    lvp_put(&file.raw, rdv_leaf(&file, 0, 3, 64), 1);
    lvp_put(&file.raw, rdv_leaf(&file, 1, 3, 48), 1);
    struct tree_dump dump = rdv_read_ok(&file);
    tree_must_have_doubles(&dump);
    tree_dump_free(&dump);
    world_free(&world);
}

static void numbers_that_are_not_finite(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    rdv_write_mesh(&file, &world, false);
    for (size_t word = 0; word < 9; word++) {
        const size_t at = rdv_leaf(&file, 0, 7, 4 * word);
        const uint32_t was = lvp_get(&file.raw, at);
        lvp_put(&file.raw, at, word % 2 ? 0x7FC00000 : 0xFF800000);
        struct tree_dump dump = rdv_read_ok(&file);
        tree_must_lack_one(&dump, world.mesh[0].scene);
        tree_dump_free(&dump);
        lvp_put(&file.raw, at, was);
    }
    for (size_t word = 0; word < 12; word++) {
        rdv_write(&file, &world, false);
        lvp_put(&file.raw, rdv_leaf(&file, 0, 0, 80 + 4 * word), 0x7F800000);
        tree_must_refuse(&file.raw,
                         "instance at offset 128: a number of its transform is not finite");
    }
    world_free(&world);
}

static void heads_that_are_wrong_are_refused(void **state)
{
    (void)state;
    static const struct {
        bool inner;
        size_t at;
        uint32_t word;
        const char *rule;
    } tries[] = {
        {false, 32, 1 << 30, "t: no tree of a known format"},
        {false, 40, 96, "its head tells "},
        {false, 48, 20, "its head tells "},
        {false, 48, 5, "its two heads differ: "},
        {true, 32, 1024, "its two heads differ: "},
        {true, 40, 1024, "its two heads differ: "},
        {true, 88, 3, "its two heads differ: "},
        {true, 0, 64, "its nodes begin at 64, where no root can be"},
        {true, 0, 132, "its nodes begin at 132, where no root can be"},
        {true, 0, 1 << 20, "its nodes begin at 1048576, where no root can be"},
        {true, 0, 256, "its leaves begin at "},
        {true, 80, 192, "its leaves begin at 192, and "},
    };
    struct world world = lvp_world("placed-turned:count=4");
    for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
        rdv_write(&file, &world, false);
        lvp_put(&file.raw, (tries[i].inner ? file.raw.body[0] : 0) + tries[i].at, tries[i].word);
        tree_must_refuse(&file.raw, tries[i].rule);
    }
    world_free(&world);
}

static void other_drivers_and_versions_are_refused_with_both(void **state)
{
    (void)state;
    struct world world = lvp_two_meshes();
    struct tree_dump dump;
    struct reason reason = {""};
    rdv_write(&file, &world, false);
    memcpy(file.raw.bytes, "AMD-MESA-DRW", 12);
    assert_int_equal(
        tree_dump_read("t", (const char *)file.raw.bytes, file.raw.size, DUMP_RADV, &dump, &reason),
        STATUS_INPUT);
    assert_non_null(strstr(reason.text, "UUID AMD-MESA-DRW; AMD-MESA-DRV, RADV, is read"));
    lvp_write(&file.raw, &world, NULL);
    assert_int_equal(
        tree_dump_read("t", (const char *)file.raw.bytes, file.raw.size, DUMP_RADV, &dump, &reason),
        STATUS_INPUT);
    assert_non_null(strstr(reason.text, "UUID 25.0.7-2~bpo12+1; AMD-MESA-DRV, RADV, is read"));
    rdv_write(&file, &world, false);
    assert_int_equal(tree_dump_read("t", (const char *)file.raw.bytes, file.raw.size, DUMP_LAVAPIPE,
                                    &dump, &reason),
                     STATUS_INPUT);
    assert_non_null(strstr(reason.text, "UUID AMD-MESA-DRV; lavapipe 25.0.x is read"));
    /* Later heads have three words more before the sizes, and one of room. */
    memmove(file.raw.bytes + file.raw.body[0] + 48, file.raw.bytes + file.raw.body[0] + 32, 16);
    memset(file.raw.bytes + file.raw.body[0] + 32, 0, 16);
    tree_must_refuse(
        &file.raw,
        "its head is that of Mesa 25.1 or later, which may be of GFX12; that of Mesa 25.0");
    rdv_write(&file, &world, false);
    file.raw.bytes[file.raw.begin[2] + 16] ^= 1;
    tree_must_refuse(&file.raw, "of the build 00fe33206120");
    tree_must_refuse(&file.raw, ", below a top level of the build 01fe33206120");
    world_free(&world);
}

/* The handle, what the node points to, and where the nodes begin go together. */
static void pointers_are_those_of_the_handles(void **state)
{
    (void)state;
    struct world world = lvp_two_meshes();
    rdv_write(&file, &world, false);
    lvp_put(&file.raw, 56 + 8 + 4, 0xFFFF9001);
    tree_must_refuse(&file.raw,
                     "instance 1 has the handle 0xffff900100002000, and points to 0xffff90000000");
    rdv_write(&file, &world, false);
    lvp_put_long(&file.raw, 56, 0);
    tree_must_refuse(&file.raw, "instance 0 has the handle 0x0, and points to 0x7f000000");
    rdv_write(&file, &world, false);
    const uint32_t nodes = lvp_get(&file.raw, rdv_leaf(&file, 0, 0, 68));
    lvp_put(&file.raw, rdv_leaf(&file, 0, 0, 68), nodes + 64);
    lvp_put_long(&file.raw, rdv_leaf(&file, 0, 0, 0), (rdv_address(0) + nodes + 64) >> 3);
    char text[80];
    snprintf(text, sizeof text, "instance 0 has nodes at %u, its structure at %u", nodes + 64,
             nodes);
    tree_must_refuse(&file.raw, text);
    world_free(&world);
}

/* By its own number, wherever it is in the file and in the tree. */
static void an_instance_is_named_by_its_number(void **state)
{
    static struct rdv_file whole;
    (void)state;
    struct world world = lvp_two_meshes();
    for (uint32_t bad = 0; bad < world.instance_count; bad++) {
        const uint32_t number = 7 * (world.instance_count - bad);
        char text[80];
        rdv_write(&file, &world, false);
        for (uint32_t i = 0; i < world.instance_count; i++)
            lvp_put(&file.raw, rdv_leaf(&file, 0, i, 64), 7 * (world.instance_count - i));
        whole = file;
        struct tree_dump dump = rdv_read_ok(&file);
        tree_dump_free(&dump);
        lvp_put(&file.raw, 56 + 8 * (size_t)bad, 0x77);
        snprintf(text, sizeof text, "instance %u has the handle 0x", number);
        tree_must_refuse(&file.raw, text);
        file = whole;
        const size_t at = rdv_leaf(&file, 0, bad, 68);
        const uint32_t nodes = lvp_get(&file.raw, at) + 64;
        lvp_put(&file.raw, at, nodes);
        lvp_put_long(&file.raw, rdv_leaf(&file, 0, bad, 0),
                     (rdv_address(world.instance[bad].mesh) + nodes) >> 3 & 0x1FFFFFFFFFFFu);
        snprintf(text, sizeof text, "instance %u has nodes at %u, ", number, nodes);
        tree_must_refuse(&file.raw, text);
    }
    world_free(&world);
}

/* A box of two slots over the end of another node, whichever of them is met first. */
static void nodes_do_not_overlap(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    for (uint32_t leaf = 1; leaf < world.mesh[0].scene->tri_count; leaf++)
        for (size_t first = 0; first < 2; first++) {
            char text[120];
            rdv_write_mesh(&file, &world, false);
            const uint32_t id[] = {rdv_leaf_id(&file, 0, leaf),
                                   (rdv_leaf_id(&file, 0, leaf - 1) & ~7u) | 5};
            lvp_put(&file.raw, file.node[0], id[first]);
            lvp_put(&file.raw, file.node[0] + 4, id[1 - first]);
            snprintf(text, sizeof text, "box at offset 0: child 1 is 0x%08x, within another node",
                     id[1 - first]);
            tree_must_refuse(&file.raw, text);
        }
    world_free(&world);
}

static void write_two_meshes(void)
{
    struct world world = lvp_two_meshes();
    rdv_write(&file, &world, true);
    world_free(&world);
}

static void structures_below_are_those_of_the_handles(void **state)
{
    (void)state;
    tree_must_be_whole(&file.raw, write_two_meshes);
    tree_must_be_of_handles(&file.raw, write_two_meshes);
    tree_must_say_where(&file.raw, write_two_meshes);
}

/* An inactive instance is in no box, and its handle may be anything. The file then has the
 * structures of all handles, or of those in boxes. */
static void handles_of_inactive_instances_may_be_anything(void **state)
{
    (void)state;
    struct world world = lvp_two_meshes();
    rdv_write(&file, &world, false);
    const uint32_t last = world.instance_count - 1;
    const size_t at = file.node[0] + 128 + 128 * (size_t)world.instance_count;
    assert_int_equal(world.instance_count, 5);
    /* The root has instances 0 to 2, the other box 3 and 4. */
    lvp_put(&file.raw, at + 4, 0xFFFFFFFF);
    struct tree_dump dump = rdv_read_ok(&file);
    assert_int_equal(dump.tri_count, 4);
    assert_int_equal(dump.below_count, 2);
    tree_dump_free(&dump);
    lvp_put_long(&file.raw, 56 + 8 * (size_t)last, 0x123456789000);
    dump = rdv_read_ok(&file);
    assert_int_equal(dump.below_count, 2);
    for (uint32_t i = 0; i < 4; i++)
        assert_int_equal(dump.instance[i].below, i % 2);
    tree_dump_free(&dump);
    world_free(&world);
}

/* A transform of zeros: the point 0 beside a box that begins at 1 lacks 1, in u of 2^-24 2^-149. */
static void sizes_of_nothing_are_the_least_float(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    rdv_write(&file, &world, false);
    const float zeros[12] = {0}, one[6] = {1, 0, 0, 2, 0, 0};
    lvp_put_floats(&file.raw, rdv_leaf(&file, 0, 0, 80), zeros, 12);
    lvp_put_floats(&file.raw, file.node[0] + 16, one, 6);
    struct tree_dump dump = rdv_read_ok(&file);
    const struct dump_lacks lacks = lvp_measured(&dump);
    assert_int_equal(lacks.sides, 1);
    assert_int_equal(lacks.most.side, 0);
    assert_true(lacks.most.lacks == 1 && lacks.most.u == 0x1p+173);
    tree_dump_free(&dump);
    world_free(&world);
}

static void any_word_may_be_anything(void **state)
{
    (void)state;
    static const uint32_t words[] = {0,  1,    4,          5,          6,          21,        32,
                                     64, 0x60, 0xFFFFFFFF, 0x7FFFFFFF, 0x7FC00000, 0x7F800000};
    struct world world = lvp_world("crowd:n=5");
    rdv_write(&file, &world, true);
    tree_must_end(&file.raw, words, ARRAY_COUNT(words));
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(children_that_make_no_tree_are_named),
        cmocka_unit_test(children_that_are_nowhere_are_refused),
        cmocka_unit_test(doubled_numbers_are_named),
        cmocka_unit_test(numbers_that_are_not_finite),
        cmocka_unit_test(heads_that_are_wrong_are_refused),
        cmocka_unit_test(other_drivers_and_versions_are_refused_with_both),
        cmocka_unit_test(pointers_are_those_of_the_handles),
        cmocka_unit_test(an_instance_is_named_by_its_number),
        cmocka_unit_test(nodes_do_not_overlap),
        cmocka_unit_test(structures_below_are_those_of_the_handles),
        cmocka_unit_test(handles_of_inactive_instances_may_be_anything),
        cmocka_unit_test(sizes_of_nothing_are_the_least_float),
        cmocka_unit_test(any_word_may_be_anything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
