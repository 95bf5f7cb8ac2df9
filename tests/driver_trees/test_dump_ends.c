/* What drivers serialise, at its ends: instances that one side has and the other has not, and boxes
 * that are zeros down to the root. */
#include "tests/driver_trees/radv_file.h"
#include "tests/driver_trees/tree_laws.h"

static struct lvp_file file;
static struct rdv_file radv;

static struct tree_dump dump_of(const struct world *world, bool of_radv)
{
    if (of_radv) {
        rdv_write(&radv, world, false);
        return rdv_read_ok(&radv);
    }
    lvp_write(&file, world, NULL);
    return lvp_read_ok(&file);
}

/* Whichever side has fewer: each instance that the other has besides is one difference. */
static void instances_of_one_side_alone_are_differences(void **state)
{
    (void)state;
    for (int of_radv = 0; of_radv < 2; of_radv++) {
        struct world world = lvp_world("placed-turned:count=6");
        const uint32_t all = world.instance_count;
        struct tree_dump whole = dump_of(&world, of_radv);
        for (uint32_t count = 1; count <= all; count++) {
            struct world fewer = world;
            fewer.instance_count = count;
            struct tree_dump part = dump_of(&fewer, of_radv);
            const struct dump_differences more = lvp_compared(&whole, &fewer),
                                          less = lvp_compared(&part, &world);
            assert_int_equal(more.instances, all - count);
            assert_int_equal(less.instances, all - count);
            assert_int_equal(more.triangles + less.triangles, 0);
            if (count < all)
                assert_true(more.instance == count && less.instance == count);
            tree_dump_free(&part);
        }
        tree_dump_free(&whole);
        world_free(&world);
    }
}

/* Boxes of zeros at the end are room, but a level has a root: all of them are none. */
static void a_level_without_a_box_is_refused(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=5");
    const uint32_t boxes = world.instance_count - 1;
    for (uint32_t first = 0; first < boxes; first++) {
        struct tree_dump dump;
        struct reason reason = {""};
        lvp_write(&file, &world, NULL);
        for (size_t at = lvp_box_word(&file, 0, first, 0); at < lvp_box_word(&file, 0, boxes, 0);
             at += 4)
            lvp_put(&file, at, 0);
        /* Of the box before it a child is not there any more. */
        assert_int_equal(lvp_read(&file, file.size, &dump, &reason), STATUS_INPUT);
        assert_non_null(strstr(reason.text, first ? "where none is" : "box 0: child 0 is "));
    }
    world_free(&world);
}

/* Whether bytes are taken for what a driver serialised, by their head alone. */
static bool is_taken(const struct lvp_file *of)
{
    struct tree_dump dump;
    struct reason reason = {""};
    if (!lvp_read(of, of->size, &dump, &reason)) {
        tree_dump_free(&dump);
        return true;
    }
    return !strstr(reason.text, "t: no tree of a known format");
}

/* The sizes and the handles that a head tells have room in the file, to the byte. */
static void what_has_no_room_in_a_file_is_no_structure(void **state)
{
    (void)state;
    static struct lvp_file whole, changed;
    struct world world = lvp_world("placed-turned:count=5");
    for (int of_radv = 0; of_radv < 2; of_radv++) {
        struct tree_dump dump = dump_of(&world, of_radv);
        whole = of_radv ? radv.raw : file;
        const uint64_t size = whole.size, most = (lvp_get(&whole, 32) - 56) / 8;
        const struct {
            size_t at;
            uint64_t value;
            bool taken;
        } tries[] = {{32, size, true},        {32, size + 1, false},
                     {32, UINT64_MAX, false}, {32, 55, false},
                     {40, 0, false},          {40, 1, true},
                     {48, most, true},        {48, most + 1, false},
                     {48, 1ull << 61, false}, {48, UINT64_MAX / 8, false},
                     {48, UINT64_MAX, false}, {32, 1ull << 32, false}};
        for (size_t i = 0; i < ARRAY_COUNT(tries); i++) {
            changed = whole;
            lvp_put_long(&changed, tries[i].at, tries[i].value);
            if (is_taken(&changed) != tries[i].taken)
                fail_msg("%llu at %zu", (unsigned long long)tries[i].value, tries[i].at);
        }
        tree_dump_free(&dump);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(instances_of_one_side_alone_are_differences),
        cmocka_unit_test(a_level_without_a_box_is_refused),
        cmocka_unit_test(what_has_no_room_in_a_file_is_no_structure),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
