/* Triangles that are cut before the build: nothing of them is lost, the budget is kept, and the
 * parts lie on both sides of the planes that they should. */
#include "ref/build/presplit.h"
#include "ref/build/room.h"
#include "ref/tree/cover.h"
#include "tests/build/presplit_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static const float shares[] = {0.04f, 0.3f, 1, 6};

static struct part *parts_of(const struct scene *scene, float share, uint32_t threads,
                             uint32_t *count)
{
    const struct build_options options = {.leaf = 4, .presplit = share};
    struct part *part;
    assert_int_equal(presplit_make(scene, &options, threads, &part, count, NULL), STATUS_OK);
    return part;
}

/* --- parts ------------------------------------------------------------------------------------ */

/* As leaves of one node, by the exact check. */
static uint32_t uncovered(const struct scene *scene, const struct part *part, uint32_t count)
{
    struct cover_node *node = calloc(count + 1, sizeof *node);
    uint32_t *item = calloc(count, sizeof *item);
    struct cover_faults faults;
    assert_true(node && item);
    node[0].box = (struct box){{-FLT_MAX, -FLT_MAX, -FLT_MAX}, {FLT_MAX, FLT_MAX, FLT_MAX}};
    for (uint32_t i = 0; i < count; i++) {
        node[i + 1] = (struct cover_node){.box = part[i].box, .item_first = i, .item_count = 1};
        item[i] = part[i].prim;
    }
    const struct cover_tree tree = {node, item, count + 1};
    assert_int_equal(cover_check(&tree, scene, &faults), STATUS_OK);
    free(node);
    free(item);
    return faults.prims;
}

/* Returns the number of triangles that are cut. */
static uint32_t check_parts(const struct scene *scene, const struct part *part, uint32_t count,
                            const char *what)
{
    uint32_t cut = 0;
    for (uint32_t i = 0; i < count; i++) {
        struct box whole = scene_tri_bounds(scene, part[i].prim);
        uint32_t before = i ? part[i - 1].prim : UINT32_MAX;
        bool again = i && part[i].prim == before;
        cut += again && (i < 2 || part[i - 2].prim != before);
        if (!again && part[i].prim != before + 1)
            fail_msg("%s: part %u is of triangle %u", what, i, part[i].prim);
        if (!box_contains_box(&whole, &part[i].box))
            fail_msg("%s: part %u is larger than triangle %u", what, i, part[i].prim);
    }
    assert_int_equal(part[count - 1].prim, scene->tri_count - 1);
    return cut;
}

static void parts_cover_their_triangles_within_the_budget(void **state)
{
    (void)state;
    for (size_t s = 0; s < SCENES; s++)
        for (size_t k = 0; k < ARRAY_COUNT(shares); k++) {
            const char *what;
            struct scene scene = scene_of(s, &what);
            uint32_t count, budget = (uint32_t)((double)shares[k] * scene.tri_count);
            struct part *part = parts_of(&scene, shares[k], 1, &count);
            assert_in_range(count, scene.tri_count, scene.tri_count + budget);
            (void)check_parts(&scene, part, count, what);
            if (uncovered(&scene, part, count))
                fail_msg("%s, %g: %u triangles have parts in no box", what, (double)shares[k],
                         uncovered(&scene, part, count));
            room_free(part);
            scene_free(&scene);
        }
}

/* Two parts of a triangle have a plane between them. */
static void parts_lie_beside_each_other(void **state)
{
    (void)state;
    struct scene scene = slivers(400, 1);
    uint32_t count, pairs = 0;
    struct part *part = parts_of(&scene, 3, 1, &count);
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i + 1; j < count && part[j].prim == part[i].prim; j++) {
            const struct box *a = &part[i].box, *b = &part[j].box;
            bool apart = false;
            for (int k = 0; k < 3; k++)
                apart = apart || a->hi[k] <= b->lo[k] || b->hi[k] <= a->lo[k];
            assert_true(apart);
            pairs++;
        }
    assert_true(pairs > 1000);
    room_free(part);
    scene_free(&scene);
}

/* Of what has no room to spare, nor of what is no number, whose priority would be none either. */
static void some_triangles_are_not_cut(void **state)
{
    (void)state;
    struct scene scene = slivers(100, 1);
    for (uint32_t i = 0; i < 50; i++)
        for (int c = 1; c < 9; c++) /* lines along x, and triangles with a vertex that is none */
            if (i % 2 && c % 3)
                scene.vertex[9 * i + (uint32_t)c] = scene.vertex[9 * i + (uint32_t)c % 3];
            else if (i % 2 == 0 && c > 6)
                scene.vertex[9 * i + (uint32_t)c] = NAN;
    uint32_t count, cut = 0;
    struct part *part = parts_of(&scene, 20, 1, &count);
    for (uint32_t i = 1; i < count; i++) {
        cut += part[i].prim == part[i - 1].prim;
        assert_true(part[i].prim >= 50 || part[i].prim != part[i - 1].prim);
    }
    assert_in_range(cut, 1700, 2000);
    room_free(part);
    scene_free(&scene);
}

/* Nearly all of it: what is left is less than equal triangles would take together, and planes that
 * miss the triangle. */
static void the_budget_is_used(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=4000");
    for (size_t k = 0; k < ARRAY_COUNT(shares); k++) {
        uint32_t count;
        struct part *part = parts_of(&scene, shares[k], 1, &count);
        double budget = (double)shares[k] * scene.tri_count;
        assert_true((double)(count - scene.tri_count) > 0.97 * budget);
        room_free(part);
    }
    scene_free(&scene);
}

static void parts_do_not_depend_on_the_number_of_threads(void **state)
{
    (void)state;
    struct scene scene = made("needles:n=3000");
    uint32_t count, other;
    struct part *one = parts_of(&scene, 0.7f, 1, &count);
    for (uint32_t threads = 2; threads <= 8; threads += 3) {
        struct part *more = parts_of(&scene, 0.7f, threads, &other);
        assert_int_equal(count, other);
        for (uint32_t i = 0; i < count; i++) {
            assert_memory_equal(&one[i].box, &more[i].box, sizeof one[i].box);
            assert_int_equal(one[i].prim, more[i].prim);
        }
        room_free(more);
    }
    room_free(one);
    scene_free(&scene);
}

/* --- planes and priorities -------------------------------------------------------------------- */

/* Thin triangles between the corners of boxes, in the scene [0, 8]^3 that the last two, points at
 * its corners, make of them. */
static struct scene thin(uint32_t count, const float box[][2][3])
{
    struct scene scene = trees_grid(count + 2);
    for (uint32_t i = 0; i < count + 2; i++)
        for (int k = 0; k < 3; k++) {
            float *v = scene.vertex + 9 * (size_t)i + k;
            v[0] = i < count ? box[i][0][k] : i == count ? 0 : 8;
            v[3] = v[6] = i < count ? box[i][1][k] : v[0];
            v[6] -= i < count && k == 0 ? 0x1p-10f : 0;
        }
    return scene;
}

/* The triangle that the budget for one cut is spent on. */
static uint32_t first_cut(const struct scene *scene, struct part piece[2])
{
    uint32_t count, cut = UINT32_MAX;
    struct part *part = parts_of(scene, 1.01f / (float)scene->tri_count, 1, &count);
    assert_in_range(count, scene->tri_count, scene->tri_count + 1);
    for (uint32_t i = 1; i < count; i++)
        if (part[i].prim == part[i - 1].prim) {
            cut = part[i].prim;
            piece[0] = part[i - 1];
            piece[1] = part[i];
        }
    room_free(part);
    return cut;
}

static void what_the_coarsest_plane_cuts_comes_first(void **state)
{
    (void)state;
    static const float box[][2][3] = {
        {{0, 0, 0}, {2, 2, 2}}, {{3, 3, 3}, {5, 5, 5}}, {{5, 5, 5}, {7, 7, 7}}};
    struct scene scene = thin(3, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 1);
    assert_true(piece[0].box.hi[0] == 4 && piece[1].box.lo[0] == 4);
    scene_free(&scene);
}

static void a_plane_at_the_end_of_a_box_does_not_cut_it(void **state)
{
    (void)state;
    static const float box[][2][3] = {{{0, 0, 0}, {4, 4, 4}}, {{1, 1, 1}, {1, 3, 3}}};
    struct scene scene = thin(2, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[0] == 2 && piece[1].box.lo[0] == 2);
    scene_free(&scene);
}

static void the_most_room_is_cut_first(void **state)
{
    (void)state;
    static const float box[][2][3] = {
        {{3, 1, 1}, {5, 1, 1}}, {{3, 2, 2}, {5, 2.5f, 2.5f}}, {{3, 1, 2}, {5, 3, 4}}};
    struct scene scene = thin(3, box);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 2);
    scene_free(&scene);
}

static void the_coarsest_of_three_planes_cuts(void **state)
{
    (void)state;
    static const float two[][2][3] = {{{2.5f, 3.5f, 5}, {3.75f, 4.5f, 5.5f}}};
    static const float equal[][2][3] = {{{3.5f, 1, 3}, {4.5f, 7, 5}}};
    struct scene scene = thin(1, two);
    struct part piece[2];
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[1] == 4 && piece[1].box.lo[1] == 4); /* not 3, nor 5.25 */
    scene_free(&scene);
    scene = thin(1, equal);
    assert_int_equal(first_cut(&scene, piece), 0);
    assert_true(piece[0].box.hi[1] == 4 && piece[1].box.lo[1] == 4);
    assert_true(piece[0].box.hi[0] < 4.1f && piece[1].box.lo[0] > 3.9f);
    scene_free(&scene);
}

/* Cuts are shared out by the cube root of what is spare: 8 times as large a triangle, in each axis
 * 2 sqrt(2) times, has twice as many. */
static void cuts_grow_as_the_cube_root(void **state)
{
    (void)state;
    struct scene scene = trees_grid(3);
    static const float size[3] = {8, 8 / 2.828427f, 0};
    for (uint32_t i = 0; i < 27; i++)
        scene.vertex[i] = (i % 9 < 3 ? 0 : size[i / 9]) - (i % 9 == 6 ? 0x1p-10f * size[i / 9] : 0);
    uint32_t count, of[3] = {0};
    struct part *part = parts_of(&scene, 40, 1, &count);
    for (uint32_t i = 0; i < count; i++)
        of[part[i].prim]++;
    assert_int_equal(of[2], 1);
    /* The smaller one's coarsest plane is one level finer: that is another cube root of 2. */
    double ratio = (double)of[0] / of[1];
    if (!(ratio > 0.95 * 2 * cbrt(2) && ratio < 1.05 * 2 * cbrt(2)))
        fail_msg("%u and %u parts", of[0], of[1]);
    room_free(part);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_cover_their_triangles_within_the_budget),
        cmocka_unit_test(parts_lie_beside_each_other),
        cmocka_unit_test(some_triangles_are_not_cut),
        cmocka_unit_test(the_budget_is_used),
        cmocka_unit_test(parts_do_not_depend_on_the_number_of_threads),
        cmocka_unit_test(what_the_coarsest_plane_cuts_comes_first),
        cmocka_unit_test(a_plane_at_the_end_of_a_box_does_not_cut_it),
        cmocka_unit_test(the_most_room_is_cut_first),
        cmocka_unit_test(the_coarsest_of_three_planes_cuts),
        cmocka_unit_test(cuts_grow_as_the_cube_root),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
