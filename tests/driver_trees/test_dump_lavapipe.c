/* Files of lavapipe, written by the tests from their description: worlds come again, each word is
 * read from its place, what boxes lack is what GMP's rationals say. */
#include "tests/driver_trees/tree_laws.h"

#include <gmp.h>
#include <stdio.h>

static struct lvp_file file;

static void worlds_come_again(void **state)
{
    (void)state;
    for (size_t w = 0; w < ARRAY_COUNT(tree_specs); w++) {
        struct world world = tree_world(w);
        lvp_write(&file, &world, NULL);
        struct tree_dump dump = lvp_read_ok(&file);
        const uint64_t inner = tree_must_be_world(&dump, &world, "lavapipe", false);
        assert_int_equal(dump.bytes, 56 * inner + 120 * (uint64_t)world.instance_count);
        tree_dump_free(&dump);
        world_free(&world);
    }
}

static void a_bottom_level_alone_is_a_tree(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=3");
    lvp_write(&file, &world, NULL);
    file.size -= file.begin[1];
    memmove(file.bytes, file.bytes + file.begin[1], file.size + 1);
    struct tree_dump dump = lvp_read_ok(&file);
    tree_must_be_mesh(&dump, &world);
    tree_dump_free(&dump);
    world_free(&world);
}

/* --- words in their places -------------------------------------------------------------------- */

static void each_side_of_a_box_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=3");
    for (unsigned side = 0; side < 12; side++) {
        const bool second = side >= 6; /* box 1: instances 1 and 2 */
        lvp_write(&file, &world, NULL);
        const size_t at = lvp_box_word(&file, 0, 1, 4 * (size_t)side);
        const float bound = float_from_bits(lvp_get(&file, at));
        lvp_put(&file, at, float_bits(nextafterf(bound, side % 6 < 3 ? INFINITY : -INFINITY)));
        struct tree_dump dump = lvp_read_ok(&file);
        struct dump_report report = lvp_found(&dump);
        assert_int_equal(report.faults, 1);
        assert_int_equal(report.fault[0].rule, DUMP_SMALL);
        assert_int_equal(report.fault[0].side, side % 6);
        assert_int_equal(report.fault[0].triangle, second ? 2 : 1);
        assert_true(report.fault[0].instance);
        const struct dump_lacks lacks = lvp_measured(&dump);
        assert_int_equal(lacks.small, 1);
        assert_int_equal(lacks.sides, 1);
        assert_int_equal(lacks.most_steps, 1);
        assert_int_equal(lacks.most.item, second ? 2 : 1);
        assert_int_equal(lacks.most.side, side % 6);
        free(report.fault);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* The bounds in the head are the root's. */
static void the_root_has_the_bounds_of_the_head(void **state)
{
    (void)state;
    struct world world = lvp_world("sphere:n=2");
    for (unsigned side = 0; side < 6; side++) {
        lvp_write(&file, &world, NULL);
        const size_t at = file.body[1] + 4 * (size_t)side;
        const float bound = float_from_bits(lvp_get(&file, at));
        lvp_put(&file, at, float_bits(nextafterf(bound, side < 3 ? INFINITY : -INFINITY)));
        struct tree_dump dump = lvp_read_ok(&file);
        tree_must_be_small(&dump.below[0], 0, side);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* Flips a bit of each word of a leaf that is looked at: one instance, or one triangle, differs. */
static void each_word_of_a_leaf_is_read_from_its_place(void **state)
{
    (void)state;
    struct world world = lvp_world("placed-turned:count=4");
    for (size_t word = 0; word < 30; word++) {
        lvp_write(&file, &world, NULL);
        const size_t at = lvp_leaf_word(&file, 0, 2, 4 * word);
        lvp_put(&file, at, lvp_get(&file, at) ^ 1);
        struct tree_dump dump;
        struct reason reason = {""};
        const enum status status = lvp_read(&file, file.size, &dump, &reason);
        if (word < 2) { /* the handle, of which there is no tree */
            assert_int_equal(status, STATUS_INPUT);
            assert_non_null(strstr(reason.text, "instance 2 is of 0x"));
            continue;
        }
        assert_int_equal(status, STATUS_OK);
        const struct dump_differences d = lvp_compared(&dump, &world);
        if (word == 2 || word >= 18) { /* custom index, the transform */
            assert_int_equal(d.instances, 1);
            assert_int_equal(d.instance, 2);
        } else if (word == 17) { /* its number, which is another's */
            assert_true(d.instances > 0);
        } else { /* flags, the way back */
            assert_int_equal(d.instances, 0);
        }
        if (word >= 4 && word < 16) {
            uint32_t bits;
            memcpy(&bits, &dump.instance[2].inverse[(word - 4) / 4][(word - 4) % 4], sizeof bits);
            assert_int_equal(bits, lvp_get(&file, at));
        }
        assert_int_equal(d.triangles, 0);
        tree_dump_free(&dump);
    }
    for (size_t word = 0; word < 12; word++) {
        lvp_write(&file, &world, NULL);
        const size_t at = lvp_leaf_word(&file, 1, 5, 4 * word);
        lvp_put(&file, at, lvp_get(&file, at) ^ (word == 10 ? 64 : 1));
        struct tree_dump dump = lvp_read_ok(&file);
        const struct dump_differences d = lvp_compared(&dump, &world);
        assert_int_equal(d.instances, 0);
        assert_int_equal(d.triangles, word < 9 ? 1 : word == 9 ? 0 : 2);
        if (word < 9)
            assert_int_equal(d.triangle.triangle, 5);
        tree_dump_free(&dump);
    }
    world_free(&world);
}

/* --- what boxes lack -------------------------------------------------------------------------- */

static void set_float(mpq_t out, float x)
{
    mpq_set_d(out, (double)x);
}

/* What a side of a box lacks, in u, by rationals; not above 0: nothing. */
static void lack_of(const struct instance *instance, const struct scene *mesh, unsigned side,
                    float bound, mpq_t out)
{
    mpq_t sum, term, factor, size;
    mpq_inits(sum, term, factor, size, NULL);
    bool any = false;
    for (uint32_t i = 0; i < 3 * mesh->tri_count; i++) {
        set_float(sum, instance->m[side % 3][3]);
        for (unsigned k = 0; k < 3; k++) {
            set_float(term, instance->m[side % 3][k]);
            set_float(factor, mesh->vertex[3 * mesh->index[i] + k]);
            mpq_mul(term, term, factor);
            mpq_add(sum, sum, term);
        }
        set_float(term, bound);
        mpq_sub(sum, sum, term);
        if (side < 3)
            mpq_neg(sum, sum);
        if (!any || mpq_cmp(sum, out) > 0)
            mpq_set(out, sum);
        any = true;
    }
    set_float(size, fabsf(instance->m[side % 3][3]));
    for (unsigned k = 0; k < 3; k++) {
        float most = 0;
        for (uint32_t i = 0; i < 3 * mesh->tri_count; i++)
            most = fmaxf(most, fabsf(mesh->vertex[3 * mesh->index[i] + k]));
        set_float(term, fabsf(instance->m[side % 3][k]));
        set_float(factor, most);
        mpq_mul(term, term, factor);
        mpq_add(size, size, term);
    }
    mpq_div(out, out, size);
    mpq_set_ui(term, 1u << 24, 1);
    mpq_mul(out, out, term);
    mpq_clears(sum, term, factor, size, NULL);
}

/* Boxes as float32 arithmetic makes them of the corners of the mesh's box. */
static void round_corners(const struct world *world, struct box *box)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        const struct instance *instance = &world->instance[i];
        const struct box mesh = scene_bounds(world_scene(world, i));
        for (int k = 0; k < 3; k++) {
            box[i].lo[k] = box[i].hi[k] = instance->m[k][3];
            for (int c = 0; c < 3; c++) {
                const float a = instance->m[k][c] * mesh.lo[c], b = instance->m[k][c] * mesh.hi[c];
                box[i].lo[k] += fminf(a, b);
                box[i].hi[k] += fmaxf(a, b);
            }
        }
    }
}

static void what_boxes_lack_is_what_rationals_say(void **state)
{
    (void)state;
    uint32_t lacking = 0;
    for (size_t w = 0; w < 8; w++) { /* the second half has negative coordinates alone */
        struct world world = lvp_world(tree_specs[w % 4]);
        struct box box[32];
        uint32_t small = 0, sides = 0;
        mpq_t most, one;
        mpq_inits(most, one, NULL);
        assert_true(world.instance_count <= ARRAY_COUNT(box));
        for (uint32_t m = 0; m < world.mesh_count && w >= 4; m++)
            for (uint32_t i = 0; i < 3 * world.mesh[m].scene->vertex_count; i++)
                world.mesh[m].scene->vertex[i] = -0.3f - fabsf(world.mesh[m].scene->vertex[i]);
        round_corners(&world, box);
        lvp_write(&file, &world, box);
        struct tree_dump dump = lvp_read_ok(&file);
        const struct dump_lacks lacks = lvp_measured(&dump);
        for (uint32_t i = 0; i < world.instance_count; i++) {
            const uint32_t before = sides;
            for (unsigned side = 0; side < 6; side++) {
                const float bound = side < 3 ? box[i].lo[side] : box[i].hi[side - 3];
                lack_of(&world.instance[i], world_scene(&world, i), side, bound, one);
                sides += mpq_sgn(one) > 0;
                if (mpq_cmp(one, most) > 0)
                    mpq_set(most, one);
            }
            small += sides > before;
        }
        assert_int_equal(lacks.small, small);
        assert_int_equal(lacks.sides, sides);
        if (sides) {
            char text[4096], *should = mpq_get_str(NULL, 10, most);
            assert_true(fraction_text(&lacks.most.exact, text, sizeof text));
            assert_string_equal(text, should);
            assert_true(fabs(lacks.most.u - mpq_get_d(most)) <= 1e-15 * lacks.most.u);
            free(should);
        }
        lacking += small;
        mpq_clears(most, one, NULL);
        tree_dump_free(&dump);
        world_free(&world);
    }
    assert_true(lacking > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_come_again),
        cmocka_unit_test(a_bottom_level_alone_is_a_tree),
        cmocka_unit_test(each_side_of_a_box_is_read_from_its_place),
        cmocka_unit_test(the_root_has_the_bounds_of_the_head),
        cmocka_unit_test(each_word_of_a_leaf_is_read_from_its_place),
        cmocka_unit_test(what_boxes_lack_is_what_rationals_say),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
