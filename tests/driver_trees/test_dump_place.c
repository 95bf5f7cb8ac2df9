/* Instances of a top level as triangles: each has the least box of its vertices, or is the point
 * where an instance without any is; and which first words are those of tinybvh. */
#include "ref/base/base.h"
#include "ref/dump/dump_inner.h"
#include "ref/dump/dump_instances.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/driver_trees/lavapipe_file.h"

#define INSTANCES 40u

/* Instances of an empty mesh and of a sphere in turn, by whole numbers, so that all is exact. */
static struct tree_dump make(void)
{
    struct tree_dump dump = {.tri_known = true, .tri_count = INSTANCES, .below_count = 2};
    uint32_t seed = 7;
    dump.instance = calloc(INSTANCES, sizeof *dump.instance);
    dump.below = calloc(2, sizeof *dump.below);
    assert_true(dump.instance && dump.below);
    assert_int_equal(scene_open("sphere:n=2", 1, &dump.below[1].scene, NULL), STATUS_OK);
    struct scene *mesh = &dump.below[1].scene;
    for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
        mesh->vertex[i] = rintf(8 * mesh->vertex[i]) + (float)(i % 3);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        dump.instance[i].below = i % 2;
        for (int j = 0; j < 12; j++) {
            seed = seed * 1664525u + 1013904223u;
            dump.instance[i].m[j / 4][j % 4] = (float)(seed >> 20) - 2048;
        }
    }
    return dump;
}

static void each_instance_has_its_least_box(void **state)
{
    (void)state;
    struct tree_dump dump = make();
    assert_int_equal(dump_place(&dump, NULL), STATUS_OK);
    assert_int_equal(dump.scene.tri_count, INSTANCES);
    assert_int_equal(dump.scene.vertex_count, 3 * INSTANCES);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        const struct box box = scene_tri_bounds(&dump.scene, i);
        const struct scene *mesh = &dump.below[i % 2].scene;
        for (int k = 0; k < 3; k++) {
            const float *row = dump.instance[i].m[k];
            float lo = INFINITY, hi = -INFINITY;
            for (size_t v = 0; v < mesh->vertex_count; v++) {
                const float *at = mesh->vertex + 3 * v;
                const float x = row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + row[3];
                lo = fminf(lo, x);
                hi = fmaxf(hi, x);
            }
            assert_true(box.lo[k] == (i % 2 ? lo : row[3]) && box.hi[k] == (i % 2 ? hi : row[3]));
        }
    }
    tree_dump_free(&dump);
}

/* Where one has no tree, or reaches beyond float32, there are none at all. */
static void there_are_all_boxes_or_none(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 2 * INSTANCES; i++) {
        struct tree_dump dump = make();
        if (i < INSTANCES)
            dump.instance[i].below = DUMP_NO_TREE;
        else
            for (int k = 0; k < 4; k++)
                dump.instance[i / 2 % INSTANCES | 1].m[i % 3][k] = 0x1.fp127f;
        assert_int_equal(dump_place(&dump, NULL), STATUS_OK);
        assert_int_equal(dump.scene.tri_count, 0);
        assert_null(dump.scene.vertex);
        tree_dump_free(&dump);
    }
}

/* A root above leaves, whose boxes lack 1, 2, .. 16 at one side each. */
static void put_boxes(struct tree_dump *dump)
{
    dump->node_count = INSTANCES + 1;
    dump->child_count = dump->item_count = INSTANCES;
    dump->node = calloc(dump->node_count, sizeof *dump->node);
    dump->child = calloc(INSTANCES, sizeof *dump->child);
    dump->item = calloc(INSTANCES, sizeof *dump->item);
    assert_true(dump->node && dump->child && dump->item);
    dump->node[0].count = INSTANCES;
    for (uint32_t i = 0; i < INSTANCES; i++) {
        struct box box = scene_tri_bounds(&dump->scene, i);
        const float lacks = (float)(1u << i % 5);
        if (i % 6 < 3)
            box.lo[i % 6] += lacks;
        else
            box.hi[i % 6 - 3] -= lacks;
        dump->node[1 + i] = (struct dump_node){box, i, 1, true};
        dump->child[i] = 1 + i;
        dump->item[i] = i;
    }
}

/* Twice the rounding unit of what a bound is the sum of, from the largest number of each axis. */
static double plain_unit(const struct tree_dump *dump, uint32_t item)
{
    const struct scene *mesh = &dump->below[dump->instance[item].below].scene;
    const float *row = dump->instance[item].m[item % 3];
    double sum = fabs((double)row[3]);
    for (int k = 0; k < 3; k++) {
        double most = 0;
        for (size_t v = 0; v < mesh->vertex_count; v++)
            most = fmax(most, fabs((double)mesh->vertex[3 * v + (size_t)k]));
        sum += fabs((double)row[k]) * most;
    }
    return ldexp(sum, -24);
}

/* Each coordinate of a vertex in turn is the largest of its axis. Only meshes with vertices are
 * judged, which every other instance is of. */
static void what_boxes_lack_is_of_all_vertices(void **state)
{
    (void)state;
    size_t numbers = 1;
    for (size_t n = 0; n < numbers; n++) {
        struct tree_dump dump = make();
        struct dump_lacks lacks;
        struct scene *mesh = &dump.below[1].scene;
        double most = 0;
        numbers = 3 * (size_t)mesh->vertex_count;
        mesh->vertex[n] = n % 2 ? -40 : 40;
        assert_int_equal(dump_place(&dump, NULL), STATUS_OK);
        put_boxes(&dump);
        assert_int_equal(dump_measure(&dump, &lacks, NULL), STATUS_OK);
        assert_true(lacks.judged == INSTANCES / 2 && lacks.small == INSTANCES / 2);
        assert_int_equal(lacks.sides, INSTANCES / 2);
        for (uint32_t i = 1; i < INSTANCES; i += 2) {
            const double u = (double)(1u << i % 5) / plain_unit(&dump, i);
            if (u > most)
                assert_true(lacks.most.item >= i);
            most = fmax(most, u);
            assert_int_equal(lacks.side[i / 2].item, i);
            assert_int_equal(lacks.side[i / 2].side, i % 6);
            if (lacks.most.item != i)
                continue;
            assert_true(lacks.most.side == i % 6 && lacks.most.lacks == 1u << i % 5);
            assert_true(fabs(lacks.most.u - u) <= 1e-12 * u);
        }
        assert_true(fabs(lacks.most.u - most) <= 1e-12 * most);
        free(lacks.side);
        tree_dump_free(&dump);
    }
}

/* From the first of its layouts to the last, of versions 0.x and 1.x or 2.x as it writes them. */
static void tinybvh_has_twelve_layouts(void **state)
{
    (void)state;
    static const uint32_t versions[] = {0, 1, 0x1FF, 0x200, 0xFFFF, 0x10000, 0x2FFFF, 0x30000};
    for (uint32_t layout = 0; layout < 256; layout++)
        for (size_t v = 0; v < ARRAY_COUNT(versions); v++) {
            const uint32_t word[2] = {layout << 24 | versions[v], 0};
            const bool is = layout >= 1 && layout <= 12 && v != 3 && v != 4 && v != 7;
            assert_int_equal(dump_is_tinybvh((const char *)word, 8), is);
            assert_false(dump_is_tinybvh((const char *)word, 7));
        }
}

/* A level of lavapipe that ends where its leaves would begin has none. */
static void a_level_without_leaves_is_a_tree(void **state)
{
    (void)state;
    static struct lvp_file file;
    const struct box bounds = {{0, 0, 0}, {0, 0, 0}};
    lvp_begin(&file, NULL, 1, 0, &bounds, 0);
    for (size_t k = 0; k < 2; k++)
        lvp_put(&file, lvp_box_word(&file, 0, 0, 48 + 4 * k), UINT32_MAX);
    struct tree_dump dump = lvp_read_ok(&file);
    assert_int_equal(dump.node_count, 1);
    assert_int_equal(dump.child_count + dump.scene.tri_count, 0);
    tree_dump_free(&dump);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_instance_has_its_least_box),
        cmocka_unit_test(there_are_all_boxes_or_none),
        cmocka_unit_test(what_boxes_lack_is_of_all_vertices),
        cmocka_unit_test(tinybvh_has_twelve_layouts),
        cmocka_unit_test(a_level_without_leaves_is_a_tree),
    };
    return cmocka_run_group_tests_name("dump_place", tests, NULL, NULL);
}
