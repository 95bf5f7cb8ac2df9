/* Layouts from outside of four children: what an honest one packs is the tree, wherever the
 * children stand in a record; every lie is told by the record, a leaf's by the slot. */
#include "ref/packed_walk.h"
#include "ref/plugin_layout.h"
#include "scenes/scenes.h"

static unsigned lie; /* enum lie */
#define LIE lie
#include "tests/plugin_liar_wide.c"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <string.h>

struct stand {
    struct scene scene;
    struct bvh bvh;
    const struct layout *layout;
};

static int stand_make(void **state)
{
    static struct stand stand;
    struct reason reason;
    const struct build_options options = {.leaf = 4, .eps = BUILD_EPS_DEFAULT};
    *state = &stand;
    return scene_open("sphere:n=8", 1, &stand.scene, &reason) ||
           bvh_build(builder_find("median"), &stand.scene, &options, &stand.bvh, &reason) ||
           plugin_layout_add("liar4", raydiff_plugin(), &stand.layout, &reason);
}

static int stand_free(void **state)
{
    struct stand *stand = *state;
    bvh_free(&stand->bvh);
    scene_free(&stand->scene);
    return 0;
}

static void wide_plugin_that_lies_is_refused_by_the_record(void **state)
{
    static const struct {
        enum lie lie;
        const char *says; /* NULL: packed */
    } cases[] = {
        {LIE_HONEST, NULL},
        {LIE_HOLE, NULL},
        {LIE_ULP, "liar4: record 4: x bounds"},
        {LIE_LEAF_ULP, "liar4: record 84, slot 1: x bounds"},
        {LIE_CHILD, "liar4: record 0: child 0 is reference 425 of 425"},
        {LIE_SLOT, "liar4: record 0: child 0 is record 1, slot 1"},
        {LIE_RECORD, "liar4: record 84: a leaf, not a child slot"},
        {LIE_INNER, "liar4: record 84, slot 0: a child slot has children"},
        {LIE_EMPTY, "liar4: record 84: a leaf without items"},
        {LIE_CHILDREN, "liar4: record 0: 5 children, 4 at most"},
    };
    struct stand *s = *state;
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct packed packed;
        struct reason reason = {""};
        lie = cases[i].lie;
        enum status status = packed_make(s->layout, &s->bvh, &s->scene, &packed, &reason);
        packed_free(&packed);
        lie = LIE_HONEST;
        if (status != (cases[i].says ? STATUS_INPUT : STATUS_OK) ||
            (cases[i].says && !strstr(reason.text, cases[i].says)))
            fail_msg("lie %d: %s: %s", (int)cases[i].lie, status_text(status), reason.text);
    }
}

/* A tree of one leaf has a root all the same. */
static void wide_plugin_packs_a_single_leaf(void **state)
{
    struct stand *s = *state;
    const struct build_options options = {.leaf = 512, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct packed packed;
    struct reason reason = {""};
    struct wide node;
    assert_int_equal(bvh_build(builder_find("median"), &s->scene, &options, &bvh, &reason), 0);
    assert_int_equal(bvh.node_count, 1);
    assert_int_equal(packed_make(s->layout, &bvh, &s->scene, &packed, &reason), STATUS_OK);
    s->layout->load(&packed, packed.root, &node);
    assert_int_equal(packed.node_count, 1);
    assert_int_equal(node.child_count, 1);
    assert_int_equal(node.child[0], 1);
    assert_string_equal(packed_name(&packed, 1).text, "record 0, slot 0");
    packed_free(&packed);
    bvh_free(&bvh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(wide_plugin_that_lies_is_refused_by_the_record),
        cmocka_unit_test(wide_plugin_packs_a_single_leaf),
    };
    return cmocka_run_group_tests(tests, stand_make, stand_free);
}
