/* Figure 8 by its formulas and by the trees. */
#include "bench/frames/paper.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/opened.h"

#include <unistd.h>

#define TEAPOT "scenes/fetched/utah-teapot.obj"

static struct paper_tree tree_of(const struct scene *scene, uint32_t leaf)
{
    struct paper_tree tree;
    struct reason reason;
    if (paper_tree(scene, leaf, &tree, &reason))
        fail_msg("%s", reason.text);
    return tree;
}

static void the_default_scene_has_the_published_bytes(void **state)
{
    (void)state;
    struct scene scene = opened("rtrs", 1);
    struct paper_tree direct = tree_of(&scene, PAPER_LEAF_DIRECT);
    struct paper_tree rf = tree_of(&scene, PAPER_LEAF_RF);
    uint64_t geometry = paper_geometry(scene.tri_count);
    assert_int_equal(geometry, 680);
    assert_int_equal(direct.direct, 2448);
    assert_int_equal(rf.rf, 656);
    assert_int_equal(paper_uploaded(scene.tri_count, scene.vertex_count), 1424);
    assert_true(paper_agrees(&paper_figures[PAPER_DEFAULT], geometry, &direct, &rf));
    assert_false(paper_agrees(&paper_figures[PAPER_DEFAULT], geometry, &rf, &rf));
    assert_false(paper_agrees(&paper_figures[PAPER_DEFAULT], geometry, &direct, &direct));
    assert_false(paper_agrees(&paper_figures[PAPER_DEFAULT], geometry + 16, &direct, &rf));
    scene_free(&scene);
}

/* Same tree: 48 (2L - 1), 32 (2L - 1) and 16 (3L - 1) bytes of L leaves. */
static void bytes_follow_from_the_leaves(void **state)
{
    (void)state;
    static const char *const specs[] = {"rtrs", "sphere:n=6"};
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene = opened(specs[i], 1);
        for (uint32_t leaf = 2; leaf <= 8; leaf += 2) {
            struct paper_tree tree = tree_of(&scene, leaf);
            uint64_t leaves = tree.stats.leaf_count;
            assert_int_equal(tree.stats.node_count, 2 * leaves - 1);
            assert_int_equal(tree.direct, PAPER_DIRECT_BYTES * (2 * leaves - 1));
            assert_int_equal(tree.plain, PAPER_PLAIN_BYTES * (2 * leaves - 1));
            assert_int_equal(tree.items, 4 * (uint64_t)scene.tri_count);
            if (tree.rf != 0)
                assert_int_equal(tree.rf, PAPER_RF_BYTES * (3 * leaves - 1));
        }
        scene_free(&scene);
    }
}

/* A leaf of more triangles than a record has slots: said as 0, not as an error. */
static void trees_that_do_not_fit_are_said(void **state)
{
    (void)state;
    struct scene scene = opened("soup:n=40,size=0.1", 1);
    struct paper_tree tree = tree_of(&scene, 40);
    assert_int_equal(tree.stats.leaf_count, 1);
    assert_int_equal(tree.direct, 48);
    assert_int_equal(tree.rf, 0);
    scene_free(&scene);
}

/* The fetched teapot has as many triangles as the paper's and other trees: it is another mesh. */
static void the_fetched_teapot_is_another_mesh(void **state)
{
    (void)state;
    const struct paper_figure *figure = &paper_figures[PAPER_TEAPOT];
    assert_int_equal(paper_geometry(figure->tri_count), figure->geometry);
    assert_int_equal(paper_uploaded(figure->tri_count, figure->vertex_count), 204848);
    if (access(TEAPOT, R_OK) != 0) {
        print_message("SKIP no " TEAPOT "\n");
        skip();
    }
    struct scene scene = opened(TEAPOT, 1);
    struct paper_tree direct = tree_of(&scene, PAPER_LEAF_DIRECT);
    struct paper_tree rf = tree_of(&scene, PAPER_LEAF_RF);
    assert_int_equal(scene.tri_count, figure->tri_count);
    assert_int_not_equal(scene.vertex_count, figure->vertex_count);
    assert_false(paper_agrees(figure, paper_geometry(scene.tri_count), &direct, &rf));
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_default_scene_has_the_published_bytes),
        cmocka_unit_test(bytes_follow_from_the_leaves),
        cmocka_unit_test(trees_that_do_not_fit_are_said),
        cmocka_unit_test(the_fetched_teapot_is_another_mesh),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
