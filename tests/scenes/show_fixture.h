/* What test_show.c and test_show_values.c share; includes cmocka.h. */
#ifndef SHOW_FIXTURE_H
#define SHOW_FIXTURE_H

#include "scenes/render/show.h"
#include "scenes/render/camera.h"
#include "scenes/render/render.h"
#include "scenes/render/shade.h"
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include "tests/support/faults.h"
#include "tests/support/trace_fixture.h"
#include <math.h>

#define WIDTH  48u
#define HEIGHT 32u
#define PIXELS (WIDTH * HEIGHT)

/* A picture of a scene by engine cpu. */
struct show_stand {
    struct scene scene;
    struct subject subject;
    struct shading shading;
    struct frame_job job;
    struct view view;
    void *self;
    struct numbers *numbers;
    struct oracle *oracle;
    struct judge *judge;
};

static void stand_make(struct show_stand *s, const char *spec, const char *layout)
{
    struct reason reason = {""};
    *s = (struct show_stand){.scene = generated(spec)};
    s->subject = subject_make(&s->scene, "median", 4, SEED_EPS, layout);
    struct camera camera = scene_camera(&s->scene);
    s->job = (struct frame_job){.job = {.scene = &s->scene,
                                        .packed = &s->subject.packed,
                                        .box = box_test_find("robust"),
                                        .tri = tri_test_find("mt"),
                                        .query = QUERY_CLOSEST},
                                .look = {.bounces = 1},
                                .width = WIDTH,
                                .height = HEIGHT};
    assert_int_equal(shading_make(&s->scene, &s->job.look, &s->shading, &reason), STATUS_OK);
    frame_job_fill(&s->shading, &camera, &s->job);
    s->view = camera_view(&camera, PROFILE_REPAIRED, WIDTH, HEIGHT);
    const struct engine *cpu = engine_find("cpu");
    struct engine_options options = {.threads = 2, .device = -1};
    assert_int_equal(engine_open(cpu, &options, &s->self, &reason), STATUS_OK);
    assert_int_equal(cpu->prepare(s->self, &s->job.job, &reason), STATUS_OK);
    assert_int_equal(numbers_make(&s->scene, &s->subject.bvh, &s->subject.packed, s->job.job.box,
                                  s->job.job.tri, &s->numbers, &reason),
                     STATUS_OK);
    struct model model = engine_model(cpu, s->self, s->job.job.tri);
    assert_int_equal(oracle_make(&s->scene, &s->oracle, &reason), STATUS_OK);
    assert_int_equal(judge_make(s->oracle, &model, QUERY_CLOSEST, &s->judge, &reason), STATUS_OK);
}

static void stand_free(struct show_stand *s)
{
    judge_free(s->judge);
    oracle_free(s->oracle);
    numbers_free(s->numbers);
    engine_find("cpu")->close(s->self);
    shading_free(&s->shading);
    subject_free(&s->subject);
    scene_free(&s->scene);
}

static struct show_source source_of(const struct show_stand *s, const char *show)
{
    struct show_source source = {.show = show_find(show),
                                 .job = &s->job,
                                 .view = &s->view,
                                 .engine = engine_find("cpu"),
                                 .self = s->self};
    assert_non_null(source.show);
    if (source.show->from == SHOW_FROM_WALK)
        source.numbers = s->numbers;
    if (source.show->from == SHOW_FROM_JUDGE) {
        source.oracle = s->oracle;
        source.judge = s->judge;
    }
    return source;
}

/* All pixels, in parts of `step`. */
static struct trace_counts values_of(const struct show_source *source, size_t step, double *value)
{
    struct trace_counts counts = {0, 0};
    struct reason reason = {""};
    for (size_t i = 0; i < PIXELS; i += step) {
        size_t count = PIXELS - i < step ? PIXELS - i : step;
        if (show_values(source, i, count, value + source->show->planes * i, &counts, &reason))
            fail_msg("%s", reason.text);
    }
    return counts;
}

#endif
