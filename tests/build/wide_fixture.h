/* What the tests of wide trees in stages share. Includes cmocka.h, whose macros must come last. */
#ifndef TESTS_WIDE_FIXTURE_H
#define TESTS_WIDE_FIXTURE_H

#include "ref/layout.h"
#include "ref/staged/staged_wide.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static const char *const wide_layouts[] = {"cwbvh80", "tiny8", "tiny8_l8", "tiny8_l14"};

static inline struct staged wide_staged(enum staged_kind kind, const struct scene *scene)
{
    struct staged staged;
    struct reason reason = {""};
    if (staged_build(kind, scene, &staged, NULL, &reason))
        fail_msg("%s", reason.text);
    return staged;
}

/* The wide tree packed by C. Returns the status of packing: STATUS_OK or STATUS_LIMIT. */
static inline enum status wide_pack(const struct staged_wide *wide, const struct staged *staged,
                                    const struct layout *layout, const struct scene *scene,
                                    struct packed *out, struct reason *reason)
{
    struct wide_tree tree;
    assert_int_equal(staged_wide_tree(wide, staged, &tree), STATUS_OK);
    const uint32_t need = tree.stack_need;
    enum status status =
        packed_make_tree(layout, &tree, wide->item, wide->item_count, scene, out, reason);
    if (status && status != STATUS_LIMIT)
        fail_msg("%s", reason->text);
    if (!status && wide->node_count > 0) /* a layout's traversal pushes all, and pops one */
        assert_int_equal(out->stack_need, need + 1);
    wide_tree_free(&tree);
    return status;
}

/* Scene i of WIDE_SCENES: those that are hard, then few triangles, subnormal ones, zeros of both
 * signs, and about 1e30. */
#define WIDE_SCENES (BUILT_SCENES + 20)

static inline struct scene wide_scene(size_t i, const char **what)
{
    static const float scales[] = {1e-40f, 0x1p-126f, 1e29f};
    if (i < BUILT_SCENES)
        return built_scene(i, what);
    const uint32_t n = (uint32_t)(i - BUILT_SCENES);
    *what = "few";
    if (n < 16)
        return built_soup(n, n);
    struct scene scene = built_soup(400, n);
    *what = n < 19 ? "scaled" : "zeros";
    for (size_t c = 0; c < 9 * (size_t)scene.tri_count; c++)
        scene.vertex[c] = n < 19      ? scene.vertex[c] * scales[n - 16]
                          : c % 5 < 3 ? (c % 2 ? 0.0f : -0.0f)
                                      : scene.vertex[c];
    return scene;
}

#endif
