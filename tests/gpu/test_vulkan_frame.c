/* Pictures by shaders: the same paths as the renderer in C to the bit, whichever way the work is
 * divided, on every driver that needs no GPU. */
#include "tests/gpu/drawn.h"

static void paths_have_the_bits_of_c(void **state)
{
    (void)state;
    struct picture picture[] = {
        picture_make("rtrs", repaired, 41, 23),
        picture_of(mirrors("soup:n=150", 2, 0.25f), rtrs, true, 41, 23),
    };
    size_t drivers = 0;
    for (size_t i = 0; i < ARRAY_COUNT(picture); i++)
        assert_true(picture_draw(&picture[i], "cpu", 1, true, &picture[i].frame));
    for (size_t d = 0; d < ARRAY_COUNT(cpu_drivers); d++) {
        struct drawn_stand stand;
        if (!stand_open(cpu_drivers[d], false, &stand))
            continue;
        for (size_t i = 0; i < ARRAY_COUNT(picture); i++) {
            struct frame got = drawn_make(&picture[i]);
            draw(&stand, &picture[i], &got);
            as_in_c(cpu_drivers[d], &picture[i], &picture[i].frame, &got);
            frame_free(&got);
        }
        stand_close(&stand);
        drivers++;
    }
    for (size_t i = 0; i < ARRAY_COUNT(picture); i++)
        picture_free(&picture[i]);
    if (!drivers)
        skip();
}

/* Whole paths, paths in steps, and the pipeline for every scene, each with its own constants. */
static void all_plans_have_the_same_bits(void **state)
{
    (void)state;
    static const struct {
        enum frame_plan plan;
        bool general;
        const char *what;
    } other[] = {{FRAME_STEPS, false, "steps"},
                 {FRAME_WHOLE, true, "general"},
                 {FRAME_STEPS, true, "general steps"}};
    struct drawn_stand stand = stand_or_skip(false);
    for (size_t i = 0; i < 2; i++) {
        const bool published = i == 1;
        /* Without lights, and without anything that mirrors or shines, code is left out. */
        struct scene scene = mirrors("soup:n=150", published ? 0 : 3, published ? 0 : 0.5f);
        for (size_t m = 0; published && m < 3; m++)
            scene.material[m].albedo[2] = 0;
        struct look look = published ? rtrs : repaired;
        look.ambience = 0;
        struct picture p = picture_of(scene, look, published, 37, 20);
        struct frame whole = drawn_make(&p), got = drawn_make(&p);
        assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
        p.job.plan = FRAME_WHOLE;
        draw(&stand, &p, &whole);
        assert_int_equal(framer_plan(stand.framer), FRAME_WHOLE);
        as_in_c("whole", &p, &p.frame, &whole);
        for (size_t k = 0; k < ARRAY_COUNT(other) - i; k++) {
            p.job.plan = other[k].plan;
            p.job.general = other[k].general;
            const uint32_t pipelines = framer_pipelines(stand.framer);
            draw(&stand, &p, &got);
            if (i < 2) /* of this profile nothing was drawn by that one */
                assert_int_equal(framer_pipelines(stand.framer), pipelines + 1);
            assert_int_equal(framer_plan(stand.framer), other[k].plan);
            same_bits(other[k].what, &p, &whole, &got);
        }
        frame_free(&whole);
        frame_free(&got);
        picture_free(&p);
    }
    stand_close(&stand);
}

/* Materials of exponent 0 shine where the light is mirrored away from the eye only as published;
 * and of other exponents nowhere there. */
static void shine_of_any_exponent_has_the_bits_of_c(void **state)
{
    (void)state;
    struct drawn_stand stand = stand_or_skip(false);
    for (size_t i = 0; i < 4; i++) {
        struct scene scene = mirrors("soup:n=150", 3, 0.25f);
        for (size_t m = 0; m < scene.material_count; m++) {
            scene.material[m].albedo[1] = 1;
            scene.material[m].spec = i & 1 ? 0.0f : (float)(m % 3);
        }
        struct picture p = picture_of(scene, i & 2 ? rtrs : repaired, false, 31, 23);
        struct frame got = drawn_make(&p);
        assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
        draw(&stand, &p, &got);
        as_in_c("shine", &p, &p.frame, &got);
        frame_free(&got);
        picture_free(&p);
    }
    stand_close(&stand);
}

/* More triangles than one dispatch of a step tests. */
static void brute_force_has_the_bits_of_c(void **state)
{
    (void)state;
    static const char *const specs[] = {"rtrs", "soup:n=20000"};
    struct drawn_stand stand = stand_or_skip(true);
    for (size_t i = 0; i < 2; i++) {
        const uint32_t side = i ? 6 : 19;
        struct look look = i ? rtrs : repaired;
        look.bounces = i ? 2 : 4;
        struct picture p = picture_of(mirrors(specs[i], 2, 0.5f), look, false, side, side);
        struct frame got = drawn_make(&p);
        assert_true(picture_draw(&p, "brute", 1, true, &p.frame));
        draw(&stand, &p, &got);
        assert_int_equal(framer_plan(stand.framer), i ? FRAME_STEPS : FRAME_WHOLE);
        as_in_c("brute", &p, &p.frame, &got);
        if (!i) {
            p.job.plan = FRAME_STEPS;
            draw(&stand, &p, &got);
            as_in_c("brute in steps", &p, &p.frame, &got);
        }
        frame_free(&got);
        picture_free(&p);
    }
    stand_close(&stand);
}

/* A layout whose shader none before it has. */
static bool shader_is_new(size_t at)
{
    for (size_t i = 0; i < at; i++)
        if (strcmp(layout_shader(layouts_all[i]), layout_shader(layouts_all[at])) == 0)
            return false;
    return true;
}

/* And with the shader of every layout: RTRS's lose triangles, in C too. */
static void tiles_of_any_side_cover_the_picture(void **state)
{
    (void)state;
    static const uint32_t tile[] = {1, 3, 8, 16, 5};
    struct drawn_stand stand = stand_or_skip(false);
    struct picture p = picture_make("rtrs", repaired, 37, 19);
    struct frame got = drawn_make(&p);
    struct reason reason = {""};
    size_t drawn = 0;
    for (size_t i = 0; layouts_all[i]; i++) {
        if (!shader_is_new(i))
            continue;
        packed_free(&p.packed);
        gpu_must(packed_make(layouts_all[i], &p.bvh, &p.scene, &p.packed, &reason), &reason);
        p.job.tile = tile[drawn++ % ARRAY_COUNT(tile)];
        assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
        draw(&stand, &p, &got);
        as_in_c(layouts_all[i]->name, &p, &p.frame, &got);
    }
    assert_true(drawn >= 12);
    frame_free(&got);
    picture_free(&p);
    stand_close(&stand);
}

static void empty_jobs_are_black(void **state)
{
    (void)state;
    struct drawn_stand stand = stand_or_skip(false);
    for (int i = 0; i < 3; i++) { /* no tree, no segment, no light */
        struct look look = repaired;
        look.ambience = i == 2 ? 0 : 0.5f;
        look.camera_light = 0;
        look.bounces = i == 1 ? 0 : 2;
        struct picture p = picture_of(mirrors("sphere", 0, 0.5f), look, false, 18, 5);
        struct frame got = drawn_make(&p);
        if (i == 0)
            p.packed.node_count = p.packed.ref_count = 0;
        draw(&stand, &p, &got);
        for (size_t k = 0; k < 18 * 5; k++) {
            assert_int_equal(got.pixel[k], 0xFF000000u);
            for (size_t b = 0; i == 0 && b < 2; b++) {
                const struct segment *s = &got.segment[2 * k + b];
                assert_int_equal(s->prim, b ? ABI_NO_SEGMENT : ABI_NO_PRIM);
                assert_true(s->t == 0 && s->asked == 0 && s->shadowed == 0);
            }
        }
        frame_free(&got);
        picture_free(&p);
    }
    stand_close(&stand);
}

static void as_many_lights_and_bounces_as_there_may_be(void **state)
{
    (void)state;
    struct drawn_stand stand = stand_or_skip(false);
    struct reason reason = {""};
    struct look look = repaired;
    look.bounces = FRAME_BOUNCES_MOST;
    struct picture p =
        picture_of(mirrors("cornell", ABI_LIGHTS_MOST - 1, 0.5f), look, false, 12, 9);
    struct frame got = drawn_make(&p);
    assert_int_equal(p.job.light_count, ABI_LIGHTS_MOST);
    assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
    uint32_t asked = 0;
    for (size_t i = 0; i < (size_t)12 * 9 * FRAME_BOUNCES_MOST; i++)
        asked |= p.frame.segment[i].asked;
    assert_true(asked >> 31); /* the last light is seen from somewhere */
    draw(&stand, &p, &got);
    as_in_c("most", &p, &p.frame, &got);
    p.job.general = true;
    assert_int_equal(framer_prepare(stand.framer, &p.job, &reason), STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "8 lights and 8 bounces"));
    assert_int_equal(framer_draw(stand.framer, &p.view, &got, &p.report, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "prepared"));
    frame_free(&got);
    picture_free(&p);
    stand_close(&stand);
}

/* Views one after the other: nothing is made anew, and nothing of the frame before is left. */
static void views_need_no_new_pipelines(void **state)
{
    (void)state;
    struct drawn_stand stand = stand_or_skip(false);
    struct reason reason = {""};
    struct picture p = picture_make("rtrs", repaired, 20, 20);
    struct frame got = drawn_make(&p);
    const struct camera camera = scene_camera(&p.scene);
    draw(&stand, &p, &got);
    const uint32_t pipelines = framer_pipelines(stand.framer);
    assert_int_equal(pipelines, 1);
    for (int i = 0; i < 9; i++) { /* more than there are serials */
        const struct camera turned = camera_orbit(&camera, 0.7 * i);
        p.view = camera_view(&turned, PROFILE_REPAIRED, 20, 20);
        assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
        gpu_must(framer_draw(stand.framer, &p.view, &got, &p.report, &reason), &reason);
        as_in_c("turned", &p, &p.frame, &got);
        assert_true(p.report.ns > 0);
    }
    assert_int_equal(framer_pipelines(stand.framer), pipelines);
    free(got.color);
    free(got.segment);
    got.color = NULL;
    got.segment = NULL;
    uint32_t *with = got.pixel;
    got.pixel = calloc(400, 4);
    assert_non_null(got.pixel);
    gpu_must(framer_draw(stand.framer, &p.view, &got, &p.report, &reason), &reason);
    assert_memory_equal(with, got.pixel, 1600);
    assert_int_equal(framer_pipelines(stand.framer), pipelines + 1); /* records nothing */
    free(with);
    frame_free(&got);
    picture_free(&p);
    stand_close(&stand);
}

/* Whatever of a frame is recorded, it is the same: pixels alone, with colours, with segments,
 * with both; each drawn by a framer that has drawn nothing else. */
static void what_is_recorded_changes_nothing(void **state)
{
    (void)state;
    const enum frame_plan plans[] = {FRAME_WHOLE, FRAME_STEPS};
    for (uint32_t i = 0; i < 8; i++) {
        struct drawn_stand stand = stand_or_skip(false);
        struct picture p = picture_make("rtrs", repaired, 61, 47);
        struct frame whole = drawn_make(&p), got = drawn_make(&p);
        float *const color = got.color;
        struct segment *const segment = got.segment;
        p.job.plan = plans[i / 4];
        assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
        got.color = i & 1 ? color : NULL;
        got.segment = i & 2 ? segment : NULL;
        draw(&stand, &p, &got);
        draw(&stand, &p, &whole);
        as_in_c("all of it", &p, &p.frame, &whole);
        got.color = i & 1 ? color : memcpy(color, whole.color, 3 * 61 * 47 * sizeof *color);
        got.segment =
            i & 2 ? segment
                  : memcpy(segment, whole.segment, 61 * 47 * p.job.look.bounces * sizeof *segment);
        same_bits("a part of it", &p, &got, &whole);
        frame_free(&got);
        frame_free(&whole);
        picture_free(&p);
        stand_close(&stand);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_recorded_changes_nothing),
        cmocka_unit_test(paths_have_the_bits_of_c),
        cmocka_unit_test(all_plans_have_the_same_bits),
        cmocka_unit_test(shine_of_any_exponent_has_the_bits_of_c),
        cmocka_unit_test(brute_force_has_the_bits_of_c),
        cmocka_unit_test(tiles_of_any_side_cover_the_picture),
        cmocka_unit_test(empty_jobs_are_black),
        cmocka_unit_test(as_many_lights_and_bounces_as_there_may_be),
        cmocka_unit_test(views_need_no_new_pipelines),
    };
    return cmocka_run_group_tests_name("vulkan_frame", tests, NULL, NULL) ? 1 : 0;
}
