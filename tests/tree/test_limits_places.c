/* Law of every layout: what it can hold depends on a scene's numbers, not on the place of the
 * triangle that has them, nor on axis and sign: each triangle in turn gets a far vertex, on each
 * axis and side, so that every child of every node has the largest bound once. */
#include "ref/packed/packed_check.h"
#include "ref/packed/refit.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/tree_fixture.h"

#include <stdlib.h>

#define TRIS 41u

/* At the largest float16, one beyond what rounds to it, in the middle of bfloat16, near the largest
 * float. */
static const float far[] = {65504.0f, 65505.0f, 65520.0f, 131072.0f, 1e30f, 3e38f};

/* A grid whose triangle `prim` has one coordinate at `value`. */
static struct scene reaching(uint32_t prim, int axis, float value)
{
    struct scene scene = trees_grid(TRIS);
    uint32_t vertex = scene.index[3 * prim];
    scene.vertex[3 * vertex + (uint32_t)axis] = value;
    return scene;
}

static struct bvh build(const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    assert_int_equal(bvh_build(builder_find("median"), scene, &options, &bvh, &reason), 0);
    return bvh;
}

static enum status packs(const struct layout *layout, uint32_t leaf, uint32_t prim, int axis,
                         float value)
{
    struct scene scene = reaching(prim, axis, value);
    struct bvh bvh = build(&scene, leaf);
    struct packed packed;
    struct reason reason = {""};
    enum status status = packed_make(layout, &bvh, &scene, &packed, &reason);
    if (!status && packed_check(&packed, &scene, NULL, &reason))
        fail_msg("%s, leaf %u, triangle %u, axis %d at %g: %s", layout->name, leaf, prim, axis,
                 (double)value, reason.text);
    assert_true(!status || status == STATUS_LIMIT);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
    return status;
}

/* The same of a tree of the grid that is refitted. */
static enum status refits(const struct layout *layout, uint32_t leaf, uint32_t prim, int axis,
                          float value)
{
    struct scene grid = trees_grid(TRIS), scene = reaching(prim, axis, value);
    struct bvh bvh = build(&grid, leaf);
    struct packed packed;
    struct reason reason = {""};
    assert_int_equal(packed_make(layout, &bvh, &grid, &packed, &reason), 0);
    enum status status = packed_refit(&packed, &scene, &reason);
    if (!status && packed_check(&packed, &scene, NULL, &reason))
        fail_msg("%s, refitted, leaf %u, triangle %u, axis %d at %g: %s", layout->name, leaf, prim,
                 axis, (double)value, reason.text);
    assert_true(!status || status == STATUS_LIMIT);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&grid);
    scene_free(&scene);
    return status;
}

typedef enum status hold_function(const struct layout *layout, uint32_t leaf, uint32_t prim,
                                  int axis, float value);

/* Of one layout and magnitude; returns what becomes of all. */
static enum status of_all_places(hold_function *into, const char *what, const struct layout *layout,
                                 uint32_t leaf, float value)
{
    enum status first = into(layout, leaf, 0, 0, value);
    for (int side = 0; side < 6; side++)
        for (uint32_t prim = 0; prim < TRIS; prim++)
            if (into(layout, leaf, prim, side / 2, side & 1 ? -value : value) != first)
                fail_msg("%s, %s: axis %d at %s%g: triangle %u is %s, triangle 0 at x %g is not",
                         layout->name, what, side / 2, side & 1 ? "-" : "", (double)value, prim,
                         first ? "held" : "refused", (double)value);
    return first;
}

static void must_not_depend_on_the_place(hold_function *into, const char *what)
{
    size_t refused = 0, held = 0;
    for (size_t l = 0; layouts_all[l]; l++)
        for (size_t f = 0; f < ARRAY_COUNT(far) && !layouts_all[l]->faithful; f++) {
            bool fails = of_all_places(into, what, layouts_all[l], (uint32_t)(1 + f % 3), far[f]);
            refused += fails;
            held += !fails;
        }
    assert_true(refused > 20 && held > 20);
}

static void what_is_packed_does_not_depend_on_the_place(void **state)
{
    (void)state;
    must_not_depend_on_the_place(packs, "packed");
}

static void what_is_refitted_does_not_depend_on_the_place(void **state)
{
    (void)state;
    must_not_depend_on_the_place(refits, "refitted");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_packed_does_not_depend_on_the_place),
        cmocka_unit_test(what_is_refitted_does_not_depend_on_the_place),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
