/* What a renderer refuses, in which words, and that it draws nothing after it; on the other side of
 * each border it draws. */
#include "scenes/render/render.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/pictures.h"

#include <math.h>
#include <stdio.h>

static const struct engine_options options = {.threads = 2, .device = -1};

/* A renderer that has drawn a picture. */
struct refuser {
    struct picture picture;
    struct renderer *renderer;
};

static void begin(enum profile profile, struct refuser *s)
{
    const struct look look = {.profile = profile, .bounces = 2, .camera_light = 0.25f};
    struct reason reason;
    s->picture = picture_make("sphere:n=4", look, 12, 8);
    picture_settle(&s->picture);
    if (renderer_open(engine_find("cpu"), &options, true, &s->renderer, &reason) ||
        renderer_prepare(s->renderer, &s->picture.job, &reason) ||
        renderer_frame(s->renderer, &s->picture.view, &s->picture.frame, NULL, &reason))
        fail_msg("%s", reason.text);
}

static void end(struct refuser *s)
{
    renderer_close(s->renderer);
    picture_free(&s->picture);
}

static enum status ask(struct refuser *s, enum query query, struct reason *reason)
{
    const struct ray ray = {.dir = {0, 0, 1}, .tmax = 1};
    struct hit hit;
    return renderer_ask(s->renderer, query, &ray, 1, &hit, reason);
}

/* The job is refused with that text, and neither pictures nor rays are left of the last one. */
static void refused(struct refuser *s, const struct frame_job *job, const char *text)
{
    struct reason reason = {""};
    struct frame *frame = &s->picture.frame;
    assert_int_equal(renderer_prepare(s->renderer, &s->picture.job, &reason), STATUS_OK);
    assert_int_equal(renderer_prepare(s->renderer, job, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, text);
    assert_int_equal(renderer_frame(s->renderer, &s->picture.view, frame, NULL, &reason),
                     STATUS_INPUT);
    assert_string_equal(reason.text, "engine cpu: no picture was prepared");
    assert_int_equal(ask(s, QUERY_CLOSEST, &reason), STATUS_INPUT);
    assert_string_equal(reason.text, "engine cpu: not prepared for rays of query closest");
}

static void taken(struct refuser *s, const struct frame_job *job)
{
    struct reason reason = {""};
    if (renderer_prepare(s->renderer, job, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(ask(s, QUERY_CLOSEST, &reason), STATUS_OK);
}

static void sides_are_from_1_to_the_most(void **state)
{
    (void)state;
    static const uint32_t good[][2] = {{1, 1}, {16384, 1}, {1, 16384}, {16384, 16384}};
    static const struct {
        uint32_t width, height;
        const char *text;
    } bad[] = {
        {0, 5, "a picture of 0 x 5 pixels: 1 to 16384 each"},
        {5, 0, "a picture of 5 x 0 pixels: 1 to 16384 each"},
        {16385, 7, "a picture of 16385 x 7 pixels: 1 to 16384 each"},
        {7, 16385, "a picture of 7 x 16385 pixels: 1 to 16384 each"},
    };
    struct refuser s;
    begin(PROFILE_REPAIRED, &s);
    struct frame_job job = s.picture.job;
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        job.width = bad[i].width;
        job.height = bad[i].height;
        refused(&s, &job, bad[i].text);
    }
    for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
        job.width = good[i][0];
        job.height = good[i][1];
        taken(&s, &job);
    }
    end(&s);
}

static void bounces_and_tiles_have_a_most(void **state)
{
    (void)state;
    struct refuser s;
    begin(PROFILE_REPAIRED, &s);
    struct frame_job job = s.picture.job;
    job.look.bounces = 65;
    refused(&s, &job, "65 bounces: 0 to 64");
    job.look.bounces = 64;
    taken(&s, &job);
    job.look.bounces = 0;
    taken(&s, &job);
    job.tile = 17;
    refused(&s, &job, "1 lights (0 to 32), 1 materials (1 or more), tile of 17 pixels (0 to 16)");
    job.tile = 16;
    taken(&s, &job);
    job.material_count = 0;
    refused(&s, &job, "1 lights (0 to 32), 0 materials (1 or more), tile of 16 pixels (0 to 16)");
    job = s.picture.job;
    job.light_count = 33;
    refused(&s, &job, "33 lights (0 to 32), 1 materials (1 or more), tile of 0 pixels (0 to 16)");
    job.light_count = 32;
    taken(&s, &job);
    job.light_count = 0;
    taken(&s, &job);
    job.job.packed = NULL;
    refused(&s, &job, "engine cpu needs a packed tree");
    end(&s);
}

/* Either light alone: below 0 by any amount, infinite, no number; 0 and -0 and the largest are. */
static void lights_are_0_or_more(void **state)
{
    (void)state;
    static const float bad[] = {-0x1p-149f, -1, -INFINITY, INFINITY, NAN};
    static const float good[] = {-0.0f, 0, 0x1p-149f, 0x1.fffffep127f};
    struct refuser s;
    begin(PROFILE_REPAIRED, &s);
    for (int of_eye = 0; of_eye < 2; of_eye++) {
        struct frame_job job = s.picture.job;
        float *light = of_eye ? &job.look.camera_light : &job.look.ambience;
        for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
            char text[128];
            *light = bad[i];
            snprintf(text, sizeof text, "ambience %g, light of the eye %g: 0 or more",
                     (double)job.look.ambience, (double)job.look.camera_light);
            refused(&s, &job, text);
        }
        for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
            *light = good[i];
            taken(&s, &job);
        }
    }
    end(&s);
}

/* Rays are traced of what was prepared: closest always, any with any-hit shadows, all never. */
static void rays_of_other_queries_are_refused(void **state)
{
    (void)state;
    static const char text[] = "engine cpu: not prepared for rays of query ";
    struct refuser s;
    struct reason reason = {""};
    begin(PROFILE_REPAIRED, &s);
    assert_int_equal(ask(&s, QUERY_CLOSEST, &reason), STATUS_OK);
    assert_int_equal(ask(&s, QUERY_ANY, &reason), STATUS_OK);
    assert_int_equal(ask(&s, QUERY_ALL, &reason), STATUS_INPUT);
    assert_memory_equal(reason.text, text, sizeof text - 1);
    assert_string_equal(reason.text + sizeof text - 1, "all");
    end(&s);
    begin(PROFILE_RTRS, &s);
    assert_int_equal(ask(&s, QUERY_CLOSEST, &reason), STATUS_OK);
    assert_int_equal(ask(&s, QUERY_ANY, &reason), STATUS_INPUT);
    assert_string_equal(reason.text + sizeof text - 1, "any");
    assert_int_equal(ask(&s, QUERY_ALL, &reason), STATUS_INPUT);
    end(&s);
}

static void recorded_engines_draw_nothing(void **state)
{
    (void)state;
    struct engine recorded = *engine_find("cpu");
    struct renderer *renderer = (struct renderer *)&recorded;
    struct reason reason = {""};
    recorded.name = "written";
    recorded.recorded = true;
    assert_int_equal(renderer_open(&recorded, &options, true, &renderer, &reason),
                     STATUS_UNSUPPORTED);
    assert_string_equal(reason.text, "written: its answers are recorded: it cannot trace new rays");
    assert_null(renderer);
    renderer_close(renderer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sides_are_from_1_to_the_most),
        cmocka_unit_test(bounces_and_tiles_have_a_most),
        cmocka_unit_test(lights_are_0_or_more),
        cmocka_unit_test(rays_of_other_queries_are_refused),
        cmocka_unit_test(recorded_engines_draw_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
