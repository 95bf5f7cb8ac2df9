/* Trees of worlds that are not refitted: which, and why. */
#include "tests/world_life/world_lives.h"

#include <float.h>

/* Why trees cannot be refitted is told after one word, which those that build anew look for. */
static void what_is_built_again_says_why(void **state)
{
    (void)state;
    const struct build_options options = {.leaf = 3, .eps = BUILD_EPS_DEFAULT};
    static const char *const why[] = {
        "rebuild: instance 1 was active, and is not now", "rebuild: instance 2: ",
        "rebuild: mesh 0: the tree is split, its boxes of parts of triangles cannot be refitted",
        "rebuild: a top level with parts of instances is not refitted"};
    for (uint32_t i = 0; i < ARRAY_COUNT(why); i++) {
        struct world_build build = {.top = builder_find("median"),
                                    .bottom = builder_find("median"),
                                    .top_options = options,
                                    .bottom_options = options};
        struct world_lived *lived = world_lived_make("placed-turned:count=5", "");
        struct world_trees trees;
        struct reason reason = {""};
        build.bottom_options.presplit = i == 2 ? 1 : 0;
        build.braid = i == 3 ? 16 : 0;
        assert_int_equal(world_trees_make(&lived->first, &build, &trees, NULL), STATUS_OK);
        if (i == 0)
            lived->first.instance[1].mask = 0;
        if (i == 1)
            lived->first.instance[2].m[0][0] = FLT_MAX, lived->first.instance[2].m[0][3] = FLT_MAX;
        assert_int_equal(world_trees_refit(&trees, &lived->first, &reason), STATUS_LIMIT);
        if (strncmp(reason.text, why[i], strlen(why[i])) != 0)
            fail_msg("%s, not %s", reason.text, why[i]);
        world_trees_free(&trees);
        world_lived_free(lived);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_built_again_says_why)};
    return cmocka_run_group_tests_name("world_life_refused", tests, NULL, NULL);
}
