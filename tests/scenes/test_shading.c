/* What shading makes of a scene: what is refused, what is filled in, thresholds as published. */
#include "tests/scenes/render_fixture.h"

static void must_refuse(struct picture *p, const char *text)
{
    struct renderer *renderer;
    struct reason reason = {""};
    const struct engine_options options = {.threads = 1};
    picture_settle(p);
    assert_int_equal(renderer_open(engine_find("cpu"), &options, true, &renderer, &reason), 0);
    assert_int_equal(renderer_prepare(renderer, &p->job, &reason), STATUS_INPUT);
    if (!strstr(reason.text, text))
        fail_msg("'%s' does not say '%s'", reason.text, text);
    assert_int_equal(renderer_frame(renderer, &p->view, &p->frame, NULL, &reason), STATUS_INPUT);
    renderer_close(renderer);
}

static void render_refuses_jobs_out_of_range(void **state)
{
    (void)state;
    struct picture p = picture_make("rtrs", looks[0], 8, 8);
    struct frame_job good = p.job;
    p.job.width = 0;
    must_refuse(&p, "0 x 8 pixels");
    p.job = good;
    p.job.height = FRAME_SIDE_MOST + 1;
    must_refuse(&p, "16385 pixels");
    p.job = good;
    p.job.look.bounces = FRAME_BOUNCES_MOST + 1;
    must_refuse(&p, "65 bounces");
    p.job = good;
    p.job.look.ambience = -1;
    must_refuse(&p, "ambience -1");
    p.job = good;
    p.job.light_count = ABI_LIGHTS_MOST + 1;
    must_refuse(&p, "33 lights");
    p.job = good;
    picture_free(&p);
}

static void shading_must_refuse(struct scene *scene, enum status expected, const char *text)
{
    struct shading shading;
    struct reason reason = {""};
    assert_int_equal(shading_make(scene, &looks[0], &shading, &reason), expected);
    assert_null(shading.tri);
    if (!strstr(reason.text, text))
        fail_msg("'%s' does not say '%s'", reason.text, text);
}

static void shading_refuses_what_cannot_be_shown(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_open("rtrs", 1, &scene, NULL), STATUS_OK);
    int32_t material = scene.material_of[7];
    scene.material_of[7] = 3;
    shading_must_refuse(&scene, STATUS_INPUT, "triangle 7: material 3, but the scene has 3");
    scene.material_of[7] = -1;
    shading_must_refuse(&scene, STATUS_INPUT, "triangle 7: material -1");
    scene.material_of[7] = material;
    scene.light[1].strength = -2;
    shading_must_refuse(&scene, STATUS_INPUT, "light 1: strength is -2, below 0");
    scene.light[1].strength = NAN;
    shading_must_refuse(&scene, STATUS_INPUT, "light 1: strength is not finite");
    scene.light[1].strength = 1;
    scene.material[2].albedo[1] = -0.5f;
    shading_must_refuse(&scene, STATUS_INPUT, "material 2: albedo is -0.5");
    scene.material[2].albedo[1] = 0;
    struct light *many = alloc_zeroed(33, sizeof *many);
    assert_non_null(many);
    for (int i = 0; i < 33; i++)
        many[i].strength = i > 0 ? 1.0f : 0.0f; /* one of no strength: 32, and the eye's */
    free(scene.light);
    scene.light = many;
    scene.light_count = 33;
    shading_must_refuse(&scene, STATUS_LIMIT, "more than 32 lights");
    scene_free(&scene);
}

static void shading_fills_what_scenes_lack(void **state)
{
    (void)state;
    struct picture p = picture_make("sphere:n=4", looks[0], 8, 8);
    assert_int_equal(p.job.material_count, p.scene.material_count ? p.scene.material_count : 1);
    if (!p.scene.material_count)
        assert_true(p.job.material[0].color[0] == .5f && p.job.material[0].spec == 10);
    float largest = 0;
    for (uint32_t i = 0; i < 3 * p.scene.vertex_count; i++)
        largest = fmaxf(largest, fabsf(p.scene.vertex[i]));
    for (int k = 0; k < 3; k++)
        largest = fmaxf(largest, fabsf(p.view.pos[k]));
    assert_true(p.job.offset == 0x1p-17f * largest);
    for (uint32_t i = 0; i < p.scene.tri_count; i++) {
        const float *g = p.job.shade[i].plane, *n = p.job.shade[i].na;
        assert_true(fabsf(g[0] * g[0] + g[1] * g[1] + g[2] * g[2] - 1) < 1e-6f);
        assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-6f);
    }
    picture_free(&p);
}

/* The offset of second rays is of the largest coordinate, whichever it is and of whichever sign. */
static void offset_is_of_the_largest_coordinate(void **state)
{
    (void)state;
    static const float far[] = {64, -64};
    struct picture p = picture_make("sphere:n=2", looks[0], 8, 8);
    picture_settle(&p);
    struct camera camera = scene_camera(&p.scene);
    memset(camera.pos, 0, sizeof camera.pos);
    frame_job_fill(&p.shading, &camera, &p.job);
    assert_true(p.job.offset > 0 && p.job.offset < 0x1p-17f * 8);
    for (uint32_t i = 0; i < 9 * p.scene.tri_count; i++)
        for (size_t sign = 0; sign < ARRAY_COUNT(far); sign++) {
            float *slot = &p.scene.vertex[3 * p.scene.index[i / 3] + i % 3], kept = *slot;
            *slot = far[sign];
            frame_job_fill(&p.shading, &camera, &p.job);
            assert_true(p.job.offset == 0x1p-17f * 64);
            *slot = kept;
        }
    for (int k = 0; k < 3; k++)
        for (size_t sign = 0; sign < ARRAY_COUNT(far); sign++) {
            camera.pos[k] = far[sign];
            frame_job_fill(&p.shading, &camera, &p.job);
            assert_true(p.job.offset == 0x1p-17f * 64);
            camera.pos[k] = 0;
        }
    picture_free(&p);
}

/* The numbers that stand in the published shader (ref/frame.h). */
static void shading_has_the_published_thresholds(void **state)
{
    (void)state;
    struct picture p = picture_make("rtrs", looks[1], 8, 8);
    assert_int_equal(p.job.look.profile, PROFILE_RTRS);
    assert_true(p.job.tmin == 0.01f && p.job.tmax == 1000.0f && p.job.offset == 0.001f);
    picture_free(&p);
    p = picture_make("rtrs", looks[0], 8, 8);
    assert_true(p.job.tmin == 0.0f && p.job.tmax >= 1e29f);
    picture_free(&p);
}

/* The published profile takes a corner's normal as the file has it. */
static void shading_of_the_published_profile_keeps_normals(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(scene_open("rtrs", 1, &scene, NULL), STATUS_OK);
    free(scene.normal);
    scene.normal = scene_normals(&scene);
    assert_non_null(scene.normal);
    const uint32_t vertex = scene.index[0];
    const float n[3] = {0.5f, -2, 1};
    memcpy(scene.normal + 3 * (size_t)vertex, n, sizeof n);
    for (size_t l = 0; l < ARRAY_COUNT(looks); l++) {
        struct shading shading;
        assert_int_equal(shading_make(&scene, &looks[l], &shading, NULL), STATUS_OK);
        const double length = looks[l].profile == PROFILE_RTRS ? 1 : sqrt(5.25);
        for (int k = 0; k < 3; k++)
            assert_true(shading.tri[0].na[k] == (float)((double)n[k] / length));
        shading_free(&shading);
    }
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(render_refuses_jobs_out_of_range),
        cmocka_unit_test(shading_refuses_what_cannot_be_shown),
        cmocka_unit_test(shading_fills_what_scenes_lack),
        cmocka_unit_test(offset_is_of_the_largest_coordinate),
        cmocka_unit_test(shading_has_the_published_thresholds),
        cmocka_unit_test(shading_of_the_published_profile_keeps_normals),
    };
    return cmocka_run_group_tests_name("shading", tests, NULL, NULL);
}
