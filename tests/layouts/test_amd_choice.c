/* Layout amd64 stores the boxes of a node in float16, rounded outward, or in float32. The root is
 * in float32, and so is what float16 does not hold or makes more than 1.25 times as large. Every
 * box is held to that by its value. */
#include "ref/base/half.h"
#include "ref/store.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "tests/support/built.h"

struct amd_chosen {
    const struct packed *packed;
    const struct scene *scene;
    uint32_t small, large, beyond;
};

static bool to_halves(const struct box *exact, struct box *out)
{
    bool fits = true;
    for (int k = 0; k < 3; k++) {
        out->lo[k] = half_to_float(half_down(exact->lo[k]));
        out->hi[k] = half_to_float(half_up(exact->hi[k]));
        fits = fits && out->lo[k] >= -65504 && out->hi[k] <= 65504;
    }
    return fits;
}

/* Returns the box of the triangles below a reference. */
static struct box check_below(struct amd_chosen *chosen, uint32_t ref)
{
    const struct packed *packed = chosen->packed;
    struct box all = box_empty(), exact[WIDE_MAX], half;
    struct wide node;
    double areas[2] = {0, 0};
    bool fits = true;
    packed->layout->load(packed, ref, &node);
    for (uint32_t s = 0; s < node.item_count && node.child_count == 0; s++) {
        struct box tri = scene_tri_bounds(chosen->scene, packed_item(packed, &node, s));
        box_add_box(&all, &tri);
    }
    for (uint32_t c = 0; c < node.child_count; c++) {
        exact[c] = check_below(chosen, node.child[c]);
        fits = to_halves(&exact[c], &half) && fits;
        areas[0] += box_half_area(&half);
        areas[1] += box_half_area(&exact[c]);
        box_add_box(&all, &exact[c]);
    }
    if (node.child_count == 0)
        return all;
    bool large = ref == packed->root || !fits || areas[0] > 1.25 * areas[1];
    for (uint32_t c = 0; c < node.child_count; c++) {
        (void)to_halves(&exact[c], &half);
        assert_memory_equal(&node.box[c], large ? &exact[c] : &half, sizeof half);
    }
    chosen->large += large;
    chosen->small += !large;
    chosen->beyond += !fits;
    return all;
}

static void each_node_has_the_form_that_it_needs(void **state)
{
    (void)state;
    struct amd_chosen chosen = {0};
    for (uint32_t seed = 0; seed < 24; seed++) {
        struct scene scene = built_soup(200, seed);
        const struct build_options options = {.leaf = 1 + seed % 4, .eps = BUILD_EPS_DEFAULT};
        struct bvh bvh;
        struct packed packed;
        struct reason reason = {""};
        /* Apart from 0 by more on each axis; and to where float16 ends, on either side. */
        for (size_t i = 0; i < 9 * (size_t)scene.tri_count; i++) {
            scene.vertex[i] += (float)(seed % 8) * (float)(i % 3 + 1) * (seed % 2 ? -1.0f : 1.0f);
            scene.vertex[i] *= seed < 16 ? 1.0f : 65504.0f / (float)(seed - 8);
        }
        assert_int_equal(bvh_build(builder_find("sah_binned"), &scene, &options, &bvh, &reason), 0);
        assert_int_equal(packed_make(layout_find("amd64"), &bvh, &scene, &packed, &reason), 0);
        chosen.packed = &packed;
        chosen.scene = &scene;
        check_below(&chosen, packed.root);
        packed_free(&packed);
        bvh_free(&bvh);
        scene_free(&scene);
    }
    print_message("float16 %u, float32 %u, of them too large %u\n", chosen.small, chosen.large,
                  chosen.beyond);
    assert_true(chosen.small > 200 && chosen.large > 200 && chosen.beyond > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_node_has_the_form_that_it_needs),
    };
    return cmocka_run_group_tests_name("amd_choice", tests, NULL, NULL);
}
