/* Pictures by shaders at the ends of what can be drawn: more than buffers hold, and paths that are
 * not finished. */
#include "tests/gpu/drawn.h"

/* A picture whose segments are more than one buffer holds. */
static void large_pictures_are_drawn_in_slabs(void **state)
{
    (void)state;
    enum { WIDTH = 600, HEIGHT = 300 };
    struct drawn_stand stand = stand_or_skip(false);
    struct reason reason = {""};
    struct look look = repaired;
    look.bounces = FRAME_BOUNCES_MOST;
    struct scene scene = mirrors("platonic", 0, 0);
    picture_nearer(&scene, 0.3f); /* what is shown fills the last rows, too */
    struct picture p = picture_of(scene, look, false, WIDTH, HEIGHT);
    struct frame got = drawn_make(&p);
    struct frame steps = drawn_make(&p);
    draw(&stand, &p, &got);
    p.job.plan = FRAME_STEPS;
    draw(&stand, &p, &steps);
    same_bits("slabs in steps", &p, &got, &steps);
    frame_free(&steps);
    struct look one = repaired; /* the same first segments, in one go */
    one.bounces = 1;
    if ((uint64_t)WIDTH * HEIGHT * FRAME_BOUNCES_MOST * sizeof(struct segment) <
        vk_limits(stand.vk)->buffer_bytes)
        print_message("one buffer is enough here\n");
    p.job.look = one;
    assert_true(picture_draw(&p, "cpu", 0, true, &p.frame));
    for (size_t i = 0; i < (size_t)WIDTH * HEIGHT; i++)
        assert_memory_equal(&p.frame.segment[i], &got.segment[FRAME_BOUNCES_MOST * i],
                            sizeof(struct segment));
    p.job.width = FRAME_SIDE_MOST;
    p.job.look.bounces = FRAME_BOUNCES_MOST;
    gpu_must(framer_prepare(stand.framer, &p.job, &reason), &reason);
    if ((uint64_t)FRAME_SIDE_MOST * 16 * FRAME_BOUNCES_MOST * sizeof(struct segment) >
        vk_limits(stand.vk)->buffer_bytes) {
        assert_int_equal(framer_draw(stand.framer, &p.view, &got, &p.report, &reason),
                         STATUS_LIMIT);
        assert_non_null(strstr(reason.text, "16 rows of 16384 pixels"));
    }
    frame_free(&got);
    picture_free(&p);
    stand_close(&stand);
}

/* --- paths that are not finished -------------------------------------------------------------- */

static void broken(struct drawn_stand *stand, struct picture *p, enum frame_plan plan,
                   const char *text)
{
    struct reason reason = {""};
    struct frame got = drawn_make(p);
    picture_settle(p);
    p->job.plan = plan;
    gpu_must(framer_prepare(stand->framer, &p->job, &reason), &reason);
    assert_int_equal(framer_draw(stand->framer, &p->view, &got, &p->report, &reason),
                     STATUS_DEVICE);
    if (!strstr(reason.text, text) || !strstr(reason.text, "pixel "))
        fail_msg("'%s' does not say '%s' and which pixel", reason.text, text);
    assert_true(p->report.flags & ABI_FLAG_EXHAUSTED);
    frame_free(&got);
}

/* A chain of `depth` inner nodes with a leaf beside each, all as large as the scene. */
static void make_chain(struct picture *p, uint32_t depth)
{
    struct node_f32 *node = calloc(2 * depth + 1, sizeof *node);
    assert_non_null(node);
    for (uint32_t i = 0; i <= 2 * depth; i++)
        node[i] = (struct node_f32){.lo = {-9, -9, -9},
                                    .hi = {9, 9, 9},
                                    .first = i < depth ? 2 * depth - i : 0,
                                    .count = i < depth ? 0 : 1};
    free(p->packed.word);
    p->packed.word = (uint32_t *)node;
    p->packed.node_count = p->packed.ref_count = 2 * depth + 1;
    p->packed.word_count = p->packed.node_count * (uint32_t)(sizeof *node / 4);
    p->packed.root = 0;
}

static void broken_trees_are_named(void **state)
{
    (void)state;
    struct drawn_stand stand = stand_or_skip(false);
    struct look look = repaired;
    look.bounces = 1;
    struct picture p = picture_make("sphere", look, 17, 17);
    struct frame got = drawn_make(&p);
    make_chain(&p, 20);
    p.packed.stack_need = 20;
    draw(&stand, &p, &got);
    p.packed.stack_need = 16; /* a lie */
    for (int i = 0; i < 2; i++)
        broken(&stand, &p, i ? FRAME_STEPS : FRAME_WHOLE, "traversal stack overran");
    ((struct node_f32 *)p.packed.word)[3].first = 0;
    p.packed.stack_need = 40;
    for (int i = 0; i < 2; i++)
        broken(&stand, &p, i ? FRAME_STEPS : FRAME_WHOLE, "the tree has a cycle");
    frame_free(&got);
    picture_free(&p);
    stand_close(&stand);
}

/* Coincident triangles: every ray that meets one meets all. Box tests that cull are used, so that
 * AUTO begins with whole paths. */
static void loops_that_a_driver_ends_lead_to_steps(void **state)
{
    (void)state;
    enum { SHEETS = 3000 };
    struct drawn_stand stand = stand_or_skip(false);
    float(*corner)[3] = calloc(3 * SHEETS, sizeof *corner);
    struct material *material = calloc(SHEETS, sizeof *material);
    assert_true(corner && material);
    for (int i = 0; i < SHEETS; i++) { /* two mirrors that face each other */
        const float z = i % 2 ? -1 : 1;
        memcpy(corner[3 * i], (float[]){-9, -9, z}, sizeof *corner);
        memcpy(corner[3 * i + 1], (float[]){9, -9, z}, sizeof *corner);
        memcpy(corner[3 * i + 2], (float[]){0, 9, z}, sizeof *corner);
        material[i] = (struct material){{1, 1, 1}, {0.5f, 0, 0.9f}, 1};
    }
    const struct light light = {{0, 0, 0.5f}, 1};
    const struct camera camera = {.pos = {0, 0, -0.5f}, .at = {0.3f, 0, 1}};
    struct look look = repaired;
    look.bounces = 64;
    struct picture p =
        picture_of(picture_scene((const float(*)[3])corner, SHEETS, material, &light, 1, camera),
                   look, false, 8, 8);
    struct frame got = drawn_make(&p);
    assert_true(picture_draw(&p, "cpu", 1, true, &p.frame));
    draw(&stand, &p, &got);
    as_in_c("auto", &p, &p.frame, &got);
    const bool ended = framer_plan(stand.framer) == FRAME_STEPS;
    assert_int_equal(ended, strstr(vk_limits(stand.vk)->driver, "Mesa 22.") != NULL);
    if (ended)
        broken(&stand, &p, FRAME_WHOLE, "ended its loop early");
    frame_free(&got);
    picture_free(&p);
    free(corner);
    free(material);
    stand_close(&stand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(large_pictures_are_drawn_in_slabs),
        cmocka_unit_test(broken_trees_are_named),
        cmocka_unit_test(loops_that_a_driver_ends_lead_to_steps),
    };
    return cmocka_run_group_tests_name("vulkan_frame_ends", tests, NULL, NULL) ? 1 : 0;
}
