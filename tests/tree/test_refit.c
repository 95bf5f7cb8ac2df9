/* Refit (ref/packed/refit.h): trees of moved scenes stay sound in every layout, or are to be built
 * anew and stay what they were. */
#include "ref/packed/refit.h"

#include "ref/packed/packed_walk.h"
#include "ref/trace/trace.h"
#include "ref/packed/packed_check.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/tree/moved.h"
#include "ref/store.h"

#define TRIS 150u

/* --- judging ---------------------------------------------------------------------------------- */

static struct bvh build(const char *builder, const struct scene *scene, uint32_t leaf)
{
    struct build_options options = {.leaf = leaf, .eps = BUILD_EPS_DEFAULT};
    struct bvh bvh;
    struct reason reason = {""};
    if (bvh_build(builder_find(builder), scene, &options, &bvh, &reason))
        fail_msg("%s", reason.text);
    return bvh;
}

/* Not conservative, by what it reproduces. */
static bool loses(const struct layout *layout)
{
    return layout->faithful;
}

/* From outside the soup to the middle of each triangle: what brute force finds. */
static void check_hits(const struct packed *packed, const struct scene *scene)
{
    const struct tri_test *tri = tri_test_find("woop");
    struct box bounds = scene_bounds(scene);
    size_t hits = 0;
    for (uint32_t i = 0; i < scene->tri_count; i += 3) {
        struct ray ray = {.tmin = 0, .tmax = 4};
        struct hit one, all;
        float v[3][3];
        scene_tri(scene, i, v);
        for (int k = 0; k < 3; k++) {
            ray.org[k] = k == (int)(i % 3) ? bounds.lo[k] - 1 : bounds.lo[k] / 2 + bounds.hi[k] / 2;
            ray.dir[k] = v[0][k] / 3 + v[1][k] / 3 + v[2][k] / 3 - ray.org[k];
        }
        trace_brute(scene, tri, QUERY_CLOSEST, &ray, &all);
        assert_int_equal(trace_ray(&(struct job){.scene = scene,
                                                 .packed = packed,
                                                 .box = box_test_find("watertight"),
                                                 .tri = tri,
                                                 .query = QUERY_CLOSEST},
                                   &ray, &one, NULL),
                         STATUS_OK);
        hits += all.prim != ABI_NO_PRIM;
        if (one.prim != all.prim && one.t != all.t)
            fail_msg("%s: ray %u: triangle %u at %g, not %u at %g", packed->layout->name, i,
                     one.prim, (double)one.t, all.prim, (double)all.t);
    }
    assert_true(hits > scene->tri_count / 6);
}

enum refit_fate { HOLDS, REFUSES, EITHER };

/* What a layout must say to a motion of a soup of about 20 units. */
static enum refit_fate fate_of(const struct layout *layout, enum motion motion)
{
    const char *name = layout->name;
    bool away = motion == EXPLODED || motion == FAR || motion == BEYOND_HALVES;
    if (strstr(name, "bf16_scene"))
        return motion == EXPLODED ? EITHER : HOLDS; /* its exponents reach far beyond the frame */
    if (strstr(name, "f16_scene"))                  /* up to twice as far */
        return motion == LARGE ? EITHER : away || motion == GROWN ? REFUSES : HOLDS;
    if (strstr(name, "_scene"))
        return motion == SMALL                              ? EITHER
               : away || motion == LARGE || motion == GROWN ? REFUSES
                                                            : HOLDS;
    if (strcmp(name, "amd64") == 0)
        return away ? EITHER : HOLDS;
    if (strcmp(name, "cwbvh80") == 0 || strncmp(name, "tiny8", 5) == 0 ||
        strncmp(name, "gfx12", 5) == 0)
        return motion == EXPLODED ? REFUSES : HOLDS;
    bool halves = strcmp(name, "rf16") == 0 || strcmp(name, "half4") == 0 ||
                  strstr(name, "f16_world") || strstr(name, "amd64_f16") || strstr(name, "amd64_g");
    return halves && !strstr(name, "bf16") && away ? REFUSES : HOLDS;
}

/* To the scene as it moved, and back to where it was: the tightest boxes depend on where the
 * triangles are alone, so that the words are the first again. */
static void refit_one(struct packed *packed, const struct scene *scene, const struct scene *first,
                      enum motion motion)
{
    struct snapshot before = snapshot(packed);
    struct reason reason = {""};
    enum refit_fate fate = fate_of(packed->layout, motion);
    enum status status = packed_refit(packed, scene, &reason);
    if (status) {
        assert_int_equal(status, STATUS_LIMIT);
        assert_int_equal(strncmp(reason.text, "rebuild: ", 9), 0);
        assert_true(same_as(packed, &before));
    } else if (!loses(packed->layout)) {
        if (packed_check(packed, scene, NULL, &reason))
            fail_msg("motion %d: %s", (int)motion, reason.text);
        if (motion != POINT && motion < EXPLODED)
            check_hits(packed, scene);
    }
    if (fate != EITHER && (fate == HOLDS) != !status)
        fail_msg("%s: motion %d: %s", packed->layout->name, (int)motion,
                 status ? reason.text : "not noticed");
    if (motion == STILL && !same_as(packed, &before))
        fail_msg("%s: a refit to the same scene changes words", packed->layout->name);
    if (!status && packed_refit(packed, first, &reason))
        fail_msg("%s: motion %d and back: %s", packed->layout->name, (int)motion, reason.text);
    if (!status && !same_as(packed, &before))
        fail_msg("%s: motion %d and back: other words", packed->layout->name, (int)motion);
    drop(&before);
}

/* --- tests ------------------------------------------------------------------------------------ */

static void every_layout_holds_what_has_moved_or_says_rebuild(void **state)
{
    (void)state;
    struct scene scene = built_soup(TRIS, 5);
    struct bvh bvh = build("sah_sweep", &scene, 4);
    for (int m = 0; m < MOTIONS; m++) {
        struct scene moved = moved_by(&scene, (enum motion)m, 7);
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed;
            struct reason reason = {""};
            if (packed_make(layouts_all[l], &bvh, &scene, &packed, &reason))
                fail_msg("%s", reason.text);
            if (layouts_all[l]->rebound) {
                refit_one(&packed, &moved, &scene, (enum motion)m);
            } else {
                struct snapshot before = snapshot(&packed);
                assert_int_equal(packed_refit(&packed, &moved, &reason), STATUS_LIMIT);
                assert_int_equal(strncmp(reason.text, "rebuild: layout ", 16), 0);
                assert_true(same_as(&packed, &before));
                assert_true(layouts_all[l]->faithful || layouts_all[l]->outside ||
                            layouts_all[l]->misses);
                drop(&before);
            }
            packed_free(&packed);
        }
        scene_free(&moved);
    }
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Scenes that press on the numbers: many frames of a mesh that stretches until it no longer fits.
 */
static void frames_of_a_motion_stay_sound_one_after_the_other(void **state)
{
    (void)state;
    for (size_t s = 0; s < BUILT_SCENES; s++) {
        const char *what;
        struct scene scene = built_scene(s, &what);
        scene.tri_count = scene.tri_count < 60 ? scene.tri_count : 60;
        struct bvh bvh = build("median", &scene, 3);
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed;
            struct reason reason = {""};
            if (!layouts_all[l]->rebound || loses(layouts_all[l]))
                continue;
            enum status status = packed_make(layouts_all[l], &bvh, &scene, &packed, &reason);
            struct scene moved = moved_by(&scene, STILL, 0);
            for (uint64_t frame = 0; frame < 4 && !status; frame++) {
                status = packed_refit(&packed, &moved, &reason);
                if (!status && packed_check(&packed, &moved, NULL, &reason))
                    fail_msg("%s, frame %d: %s", what, (int)frame, reason.text);
                assert_true(!status || (frame && strncmp(reason.text, "rebuild: ", 9) == 0));
                scene_move(&moved, 1e-4f, frame);
            }
            scene_free(&moved);
            packed_free(&packed);
        }
        bvh_free(&bvh);
        scene_free(&scene);
    }
}

/* A refitted binary tree packs to the words that its packed form is refitted to. */
static void both_refits_are_the_same(void **state)
{
    (void)state;
    static const char *const names[] = {"f32", "rf16"};
    struct scene scene = built_soup(TRIS, 6);
    struct scene moved = moved_by(&scene, LARGE, 8);
    for (size_t b = 0; builders_all[b]; b++) {
        struct bvh bvh = build(builders_all[b]->name, &scene, 2);
        struct packed from[ARRAY_COUNT(names)], anew;
        struct reason reason = {""};
        for (size_t l = 0; l < ARRAY_COUNT(names); l++)
            assert_int_equal(packed_make(layout_find(names[l]), &bvh, &scene, &from[l], NULL), 0);
        struct bvh old = bvh;
        old.node = calloc(bvh.node_count, sizeof *old.node);
        assert_non_null(old.node);
        memcpy(old.node, bvh.node, bvh.node_count * sizeof *old.node);
        enum status status = bvh_refit(&bvh, &moved, &reason);
        assert_int_equal(status, bvh_is_split(&bvh) ? STATUS_LIMIT : STATUS_OK);
        if (status) {
            assert_int_equal(strncmp(reason.text, "rebuild: ", 9), 0);
            assert_memory_equal(bvh.node, old.node, bvh.node_count * sizeof *old.node);
        } else if (bvh_check(&bvh, &moved, &reason)) {
            fail_msg("%s: %s", builders_all[b]->name, reason.text);
        }
        for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
            assert_int_equal(packed_refit(&from[l], &moved, &reason), status);
            if (!status) {
                assert_int_equal(packed_make(layout_find(names[l]), &bvh, &moved, &anew, NULL), 0);
                assert_memory_equal(anew.word, from[l].word, 4 * (size_t)anew.word_count);
                packed_free(&anew);
            }
            packed_free(&from[l]);
        }
        free(old.node);
        bvh_free(&bvh);
    }
    scene_free(&moved);
    scene_free(&scene);
}

/* Triangles as they are stored are the moved scene's. */
static void check_stored(const struct packed *packed, const struct scene *scene)
{
    struct packed_walk walk;
    assert_int_equal(packed_walk_make(packed, &walk), STATUS_OK);
    for (uint32_t i = 0; i < walk.visit_count && packed->store->tri; i++) {
        struct wide leaf;
        packed->layout->load(packed, walk.visit[i].ref, &leaf);
        for (uint32_t s = 0; s < leaf.item_count && leaf.child_count == 0; s++) {
            float is[3][3], must[3][3];
            scene_tri(scene, packed_item(packed, &leaf, s), must);
            assert_true(packed->store->tri(packed, leaf.item_first, s, is));
            assert_memory_equal(is, must, sizeof is);
        }
    }
    packed_walk_free(&walk);
}

static void storages_have_the_moved_vertices(void **state)
{
    (void)state;
    struct scene scene = built_soup(TRIS, 9);
    struct scene moved = moved_by(&scene, LARGE, 3);
    struct bvh bvh = build("median", &scene, 3);
    for (size_t s = 0; tri_stores[s]; s++)
        for (size_t l = 0; layouts_all[l]; l++) {
            struct packed packed, anew;
            struct reason reason = {""};
            if (!layouts_all[l]->rebound || tri_stores[s]->lossy ||
                strstr(layouts_all[l]->name, "_scene") ||
                packed_make_stored(layouts_all[l], tri_stores[s], &bvh, &scene, &packed, &reason))
                continue;
            struct snapshot before = snapshot(&packed);
            assert_int_equal(packed_refit(&packed, &scene, &reason), STATUS_OK);
            assert_true(same_as(&packed, &before));
            drop(&before);
            if (packed_refit(&packed, &moved, &reason))
                fail_msg("%s", reason.text);
            check_stored(&packed, &moved);
            if (!loses(layouts_all[l]) && packed_check(&packed, &moved, NULL, &reason))
                fail_msg("%s", reason.text);
            if (strcmp(layouts_all[l]->name, "f32") == 0) {
                assert_int_equal(
                    packed_make_stored(layouts_all[l], tri_stores[s], &bvh, &moved, &anew, &reason),
                    STATUS_OK);
                assert_int_equal(anew.item_count, packed.item_count);
                assert_memory_equal(anew.item, packed.item, 4 * (size_t)anew.item_count);
                packed_free(&anew);
            }
            packed_free(&packed);
        }
    bvh_free(&bvh);
    scene_free(&moved);
    scene_free(&scene);
}

/* Two triangles that shared an edge only by its place come apart: their block has no room. */
static void a_block_that_grows_is_to_be_built_anew(void **state)
{
    (void)state;
    struct scene scene = trees_grid(4);
    memcpy(scene.vertex + 9, scene.vertex, 9 * sizeof *scene.vertex);
    struct bvh bvh = build("median", &scene, 4);
    struct packed packed;
    struct reason reason = {""};
    assert_int_equal(packed_make_stored(layout_find("f32"), tri_store_find("compact"), &bvh, &scene,
                                        &packed, &reason),
                     STATUS_OK);
    struct snapshot before = snapshot(&packed);
    scene.vertex[10] += 0.25f;
    assert_int_equal(packed_refit(&packed, &scene, &reason), STATUS_LIMIT);
    assert_int_equal(strncmp(reason.text, "rebuild: storage compact: ", 26), 0);
    assert_true(same_as(&packed, &before));
    memcpy(scene.vertex, scene.vertex + 18, 9 * sizeof *scene.vertex);
    memcpy(scene.vertex + 9, scene.vertex + 18, 9 * sizeof *scene.vertex);
    if (packed_refit(&packed, &scene, &reason)) /* fewer vertices: words are left over */
        fail_msg("%s", reason.text);
    check_stored(&packed, &scene);
    assert_int_equal(packed_check(&packed, &scene, NULL, &reason), STATUS_OK);
    drop(&before);
    packed_free(&packed);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void what_is_joined_moves_together(void **state)
{
    (void)state;
    struct scene scene = built_soup(30, 1);
    memcpy(scene.vertex + 30, scene.vertex, 3 * sizeof *scene.vertex);
    scene.vertex[60] = 0, scene.vertex[61] = -0.0f, scene.vertex[62] = 5;
    scene.vertex[63] = -0.0f, scene.vertex[64] = 0, scene.vertex[65] = 5;
    struct box bounds = scene_bounds(&scene);
    struct scene moved = moved_by(&scene, STILL, 0), again = moved_by(&scene, STILL, 0);
    scene_move(&moved, 0.25f, 9);
    scene_move(&again, 0.25f, 9);
    assert_memory_equal(moved.vertex, again.vertex, 9 * 30 * sizeof *moved.vertex);
    assert_memory_equal(moved.vertex + 30, moved.vertex, 3 * sizeof *moved.vertex);
    assert_memory_equal(moved.vertex + 60, moved.vertex + 63, 3 * sizeof *moved.vertex);
    float most = 0, side = 0;
    for (int k = 0; k < 3; k++)
        side = fmaxf(side, bounds.hi[k] - bounds.lo[k]);
    for (size_t i = 0; i < 9 * 30; i++)
        most = fmaxf(most, fabsf(moved.vertex[i] - scene.vertex[i]));
    assert_true(most <= 0.2501f * side && most > 0.2f * side);
    scene_move(&again, 0.25f, 10);
    assert_memory_not_equal(moved.vertex, again.vertex, 9 * 30 * sizeof *moved.vertex);
    memcpy(again.vertex, scene.vertex, 9 * 30 * sizeof *again.vertex);
    scene_move(&again, 0, 10);
    assert_memory_equal(scene.vertex, again.vertex, 9 * 30 * sizeof *again.vertex);
    scene_move(&again, 3e38f, 10);
    assert_int_equal(scene_check(&again, NULL), STATUS_OK);
    scene_free(&moved);
    scene_free(&again);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_layout_holds_what_has_moved_or_says_rebuild),
        cmocka_unit_test(frames_of_a_motion_stay_sound_one_after_the_other),
        cmocka_unit_test(both_refits_are_the_same),
        cmocka_unit_test(storages_have_the_moved_vertices),
        cmocka_unit_test(a_block_that_grows_is_to_be_built_anew),
        cmocka_unit_test(what_is_joined_moves_together),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
