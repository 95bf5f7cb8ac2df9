/* Matches on refitted trees: engines agree with the truth about the moved scene, and vulkan with
 * cpu, bit for bit. */
#include "ref/match/match.h"
#include "scenes/move.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/support/matched.h"

#include <string.h>

#define MOVED 0.2f

/* A match on a scene that moved; `rest` is the scene before. */
static struct fixture *play_moved(const char *spec, const char *builder, struct scene *rest)
{
    struct fixture *f = prepare(spec, builder, 4);
    *rest = f->scene;
    if (scene_open(spec, 3, &f->scene, &f->reason))
        fail_msg("%s", f->reason.text);
    scene_move(&f->scene, MOVED, 5);
    assert_int_equal(ray_set_make(ray_sets[0], &f->scene, 3, RAYS, f->ray, NULL), STATUS_OK);
    f->options.rest = rest;
    f->options.tri = tri_test_find("woop");
    start(f);
    return f;
}

static void engines_agree_on_refitted_trees(void **state)
{
    (void)state;
    static const char *const names[] = {"f32",   "rf16",         "cwbvh80",        "half4",
                                        "amd64", "bvh4_u8_node", "bvh8_bf16_scene"};
    struct scene rest;
    struct fixture *f = play_moved("soup:n=500", "sah_sweep", &rest);
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        pack(f, names[l]);
        run(f, "cpu");
        assert_agrees(f);
        run(f, "vulkan");
        if (f->row.status == ROW_SKIPPED) {
            print_message("SKIP %s\n", f->row.reason.text);
            continue;
        }
        assert_agrees(f);
        assert_true(f->row.bits);
        assert_int_equal(f->row.bit_differences, 0);
        assert_true(f->row.refit.refit_ns > 0);
        assert_true(f->row.refit.sah_after > f->row.refit.sah_before);
    }
    done(f);
    scene_free(&rest);
}

/* The tree that was not refitted loses hits: the tests above can fail. */
static void without_a_refit_hits_are_lost(void **state)
{
    (void)state;
    struct scene rest;
    struct fixture *f = play_moved("soup:n=500", "median", &rest);
    assert_int_equal(packed_make(layout_find("f32"), &f->match.bvh, &rest, &f->match.packed, NULL),
                     STATUS_OK);
    run(f, "cpu");
    assert_true(f->row.wrong[WRONG_MISSED] > 0);
    done(f);
    scene_free(&rest);
}

static void what_is_to_be_built_anew_is_said(void **state)
{
    (void)state;
    struct scene rest;
    struct fixture *f = play_moved("soup:n=500", "sbvh", &rest);
    assert_int_equal(match_pack(&f->match, layout_find("f32"), &f->reason), STATUS_LIMIT);
    assert_int_equal(strncmp(f->reason.text, "rebuild: the tree is split", 26), 0);
    assert_true(f->match.refit.sah_before > 0 && f->match.refit.sah_after == 0);
    assert_int_equal(match_rebuild(&f->match, builder_find("median"), &f->options.build,
                                   f->options.tri, &f->reason),
                     STATUS_OK);
    assert_int_equal(match_pack(&f->match, layout_find("bvh2_u8_scene"), &f->reason), STATUS_LIMIT);
    assert_int_equal(strncmp(f->reason.text, "rebuild: ", 9), 0);
    assert_null(f->match.packed.layout);
    assert_int_equal(match_pack(&f->match, layout_find("rtrs_direct"), &f->reason), STATUS_LIMIT);
    pack(f, "f32");
    run(f, "cpu");
    assert_agrees(f);
    done(f);
    scene_free(&rest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_agree_on_refitted_trees),
        cmocka_unit_test(without_a_refit_hits_are_lost),
        cmocka_unit_test(what_is_to_be_built_anew_is_said),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
