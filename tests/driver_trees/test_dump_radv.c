/* Files of RADV, written by the tests from their description: worlds come again, each word is read
 * from its place, halves are the numbers that they are. */
#include "tests/driver_trees/radv_file.h"
#include "tests/driver_trees/tree_laws.h"

static struct rdv_file file;

static void worlds_come_again(void **state)
{
    (void)state;
    for (size_t w = 0; w < 2 * ARRAY_COUNT(tree_specs); w++) {
        const bool halves = w % 2;
        struct world world = tree_world(w / 2);
        rdv_write(&file, &world, halves);
        struct tree_dump dump = rdv_read_ok(&file);
        const uint64_t inner = tree_must_be_world(&dump, &world, "radv", halves);
        assert_int_equal(dump.bytes, 128 + (halves ? 64 : 128) * (inner - 1) +
                                         128 * (uint64_t)world.instance_count);
        for (size_t i = 0; i < dump.below_count; i++) {
            struct dump_report report = lvp_found(&dump.below[i]);
            assert_true(report.width <= 4);
            free(report.fault);
        }
        tree_dump_free(&dump);
        world_free(&world);
    }
}

static void a_bottom_level_alone_is_a_tree(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=3");
    for (int halves = 0; halves < 2; halves++) {
        rdv_write_mesh(&file, &world, halves);
        struct tree_dump dump = rdv_read_ok(&file);
        tree_must_be_mesh(&dump, &world);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* --- words in their places -------------------------------------------------------------------- */

/* The root has instances 0 to 2 and a box of instances 3 to 6. */
static void each_side_of_a_box_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=7");
    for (unsigned side = 0; side < 24; side++) {
        rdv_write(&file, &world, false);
        const size_t at = file.node[0] + 16 + 4 * (size_t)side;
        const float bound = float_from_bits(lvp_get(&file.raw, at));
        const float moved = nextafterf(bound, side % 6 < 3 ? INFINITY : -INFINITY);
        lvp_put(&file.raw, at, float_bits(moved));
        struct tree_dump dump = rdv_read_ok(&file);
        struct dump_report report = lvp_found(&dump);
        assert_int_equal(report.faults, 1);
        assert_int_equal(report.fault[0].rule, DUMP_SMALL);
        assert_int_equal(report.fault[0].side, side % 6);
        assert_true(report.fault[0].bound == moved && report.fault[0].needs == bound);
        assert_int_equal(report.fault[0].node, side / 6 < 3 ? 1 + side / 6 : 8);
        const struct dump_lacks lacks = lvp_measured(&dump);
        assert_int_equal(lacks.sides, side / 6 < 3);
        free(report.fault);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* The box of halves has instances 3 to 6. A half further in is a bound too small, and told as the
 * number that it is. */
static void each_half_of_a_box_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=7");
    rdv_write(&file, &world, true);
    const size_t place = file.node[0] + 128 + 128 * 7;
    for (unsigned side = 0; side < 24; side++) {
        rdv_write(&file, &world, true);
        const size_t at = place + 16 + 2 * (size_t)side;
        struct half half = {(uint16_t)(file.raw.bytes[at] | file.raw.bytes[at + 1] << 8)};
        const bool up = side % 6 < 3;
        const float bound = half_to_float(half);
        assert_true(fabsf(bound) > 0x1p-13f);
        half.bits = (uint16_t)(half.bits + (up == (bound > 0) ? 1 : -1));
        rdv_put_half(&file, at, half);
        struct tree_dump dump = rdv_read_ok(&file);
        struct dump_report report = lvp_found(&dump);
        const float ulp = ldexpf(1, ilogbf(bound) - 10), apart = report.fault[0].bound - bound;
        assert_int_equal(report.faults, 1);
        assert_int_equal(report.fault[0].rule, DUMP_SMALL);
        assert_int_equal(report.fault[0].side, side % 6);
        assert_int_equal(report.fault[0].triangle, 3 + side / 6);
        assert_true(up ? apart > 0 : apart < 0);
        assert_true(fabsf(apart) == ulp || fabsf(apart) == ulp / 2);
        free(report.fault);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* What 16 bits are, by their definition; a NaN is any. */
static double value_of_half(uint32_t bits)
{
    const int exponent = bits >> 10 & 31;
    const double fraction = bits & 1023, sign = bits >> 15 ? -1 : 1;
    if (exponent == 31)
        return fraction > 0 ? (double)NAN : sign * (double)INFINITY;
    return sign * ldexp(fraction + (exponent ? 1024 : 0), (exponent ? exponent : 1) - 25);
}

static void every_half_is_the_number_that_it_is(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=7");
    rdv_write(&file, &world, true);
    const size_t place = file.node[0] + 128 + 128 * 7;
    for (uint32_t bits = 0; bits < 1u << 16; bits += 24) {
        for (uint32_t i = 0; i < 24; i++)
            rdv_put_half(&file, place + 16 + 2 * (size_t)i, (struct half){(uint16_t)(bits + i)});
        struct tree_dump dump = rdv_read_ok(&file);
        for (uint32_t i = 0; i < 24; i++) {
            const struct box *box = &dump.node[4 + i / 6].box;
            const float is = i % 6 < 3 ? box->lo[i % 6] : box->hi[i % 6 - 3];
            const double should = value_of_half((bits + i) & 0xFFFF);
            assert_true(isnan(should) ? isnan(is) : (double)is == should);
            assert_true(isnan(should) || !signbit(is) == !signbit(should));
        }
        tree_dump_free(&dump);
    }
    world_free(&world);
}

static void the_root_has_the_bounds_of_the_head(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    for (unsigned side = 0; side < 6; side++) {
        rdv_write_mesh(&file, &world, false);
        const size_t at = file.raw.body[0] + 8 + 4 * (size_t)side;
        const float bound = float_from_bits(lvp_get(&file.raw, at));
        lvp_put(&file.raw, at, float_bits(nextafterf(bound, side < 3 ? INFINITY : -INFINITY)));
        struct tree_dump dump = rdv_read_ok(&file);
        tree_must_be_small(&dump, 0, side);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* Flips a bit of each word of an instance that is looked at. */
static void each_word_of_an_instance_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    for (size_t word = 0; word < 32; word++) {
        rdv_write(&file, &world, false);
        const size_t at = rdv_leaf(&file, 0, 2, 4 * word);
        lvp_put(&file.raw, at, lvp_get(&file.raw, at) ^ (word == 0 ? 8 : 1));
        struct tree_dump dump;
        struct reason reason = {""};
        const enum status status = lvp_read(&file.raw, file.raw.size, &dump, &reason);
        if (word < 2 || word == 17) { /* pointer, begin of its nodes: not that of the handle */
            assert_int_equal(status, STATUS_INPUT);
            assert_non_null(strstr(reason.text, "instance 2 has the handle 0x"));
            continue;
        }
        assert_int_equal(status, STATUS_OK);
        const struct dump_differences d = lvp_compared(&dump, &world);
        if (word == 2 || word >= 20) { /* custom index, the transform */
            assert_int_equal(d.instances, 1);
            assert_int_equal(d.instance, 2);
        } else if (word == 16) { /* its number, which is another's */
            assert_true(d.instances > 0);
        } else { /* flags, the way back */
            assert_int_equal(d.instances, 0);
        }
        if (word >= 4 && word < 16)
            assert_int_equal(float_bits(dump.instance[2].inverse[(word - 4) / 4][(word - 4) % 4]),
                             lvp_get(&file.raw, at));
        assert_int_equal(d.triangles, 0);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

static void each_word_of_a_triangle_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    for (size_t word = 0; word < 16; word++) {
        rdv_write_mesh(&file, &world, false);
        const size_t at = rdv_leaf(&file, 0, 5, 4 * word);
        lvp_put(&file.raw, at, lvp_get(&file.raw, at) ^ (word == 12 ? 64 : 1));
        struct tree_dump dump = rdv_read_ok(&file);
        const struct dump_differences d = lvp_compared(&dump, &world);
        assert_int_equal(d.triangles, word < 9 ? 1 : word == 12 || word == 13 ? 2 : 0);
        if (word < 9)
            assert_int_equal(d.triangle.triangle, 5);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_come_again),
        cmocka_unit_test(a_bottom_level_alone_is_a_tree),
        cmocka_unit_test(each_side_of_a_box_is_read_from_its_place),
        cmocka_unit_test(each_half_of_a_box_is_read_from_its_place),
        cmocka_unit_test(every_half_is_the_number_that_it_is),
        cmocka_unit_test(the_root_has_the_bounds_of_the_head),
        cmocka_unit_test(each_word_of_an_instance_is_read_from_its_place),
        cmocka_unit_test(each_word_of_a_triangle_is_read_from_its_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
