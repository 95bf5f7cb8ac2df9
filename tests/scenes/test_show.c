/* What each picture of the tree shows, held against what was computed without it: the traversal's
 * answers and counters, the judge's verdicts, differences by hand. */
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
    assert_int_equal(cpu->open(&options, &s->self, &reason), STATUS_OK);
    assert_int_equal(cpu->prepare(s->self, &s->job.job, &reason), STATUS_OK);
    assert_int_equal(numbers_make(&s->scene, &s->subject.bvh, &s->subject.packed, s->job.job.box,
                                  s->job.job.tri, &s->numbers, &reason),
                     STATUS_OK);
    struct model model = cpu->model(s->self, s->job.job.tri);
    assert_int_equal(oracle_make(&s->scene, &s->oracle, &reason), STATUS_OK);
    assert_int_equal(
        judge_make(s->oracle, &s->scene, &model, s->job.job.tri, QUERY_CLOSEST, &s->judge, &reason),
        STATUS_OK);
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

static struct ray ray_of(const struct show_stand *s, size_t pixel)
{
    struct shade_path path;
    shade_begin(&s->job, &s->view, (uint32_t)(pixel % WIDTH), (uint32_t)(pixel / WIDTH), &path);
    return shade_ray(&s->job, &path);
}

/* --- the table ------------------------------------------------------------------------------- */

static void every_name_finds_its_picture(void **state)
{
    (void)state;
    size_t count = 0;
    for (const struct show *show = shows; show->name; show++, count++) {
        assert_int_equal(show->id, show - shows);
        assert_ptr_equal(show_find(show->name), show);
        assert_true(strlen(show->summary) > 0 && strlen(show->label) > 0);
    }
    assert_int_equal(count, SHOW_CLASS + 1);
    assert_null(show_find("box"));
    assert_null(show_find(""));
}

/* --- values ---------------------------------------------------------------------------------- */

/* The traversal once more, ray by ray, and every picture that follows from it. */
static void answers_and_work_are_the_traversals(void **state)
{
    (void)state;
    static double t[PIXELS], prim[PIXELS], boxes[PIXELS], tris[PIXELS], normal[3 * PIXELS];
    for (size_t l = 0; l < ARRAY_COUNT(repaired); l++) {
        struct show_stand s;
        stand_make(&s, "terrain:k=4", repaired[l]);
        struct show_source source = source_of(&s, "t");
        values_of(&source, PIXELS, t);
        source = source_of(&s, "prim");
        values_of(&source, PIXELS, prim);
        source = source_of(&s, "normal");
        values_of(&source, PIXELS, normal);
        source = source_of(&s, "boxes");
        struct trace_counts counted = values_of(&source, PIXELS, boxes), counts = {0, 0};
        source = source_of(&s, "triangles");
        values_of(&source, PIXELS, tris);
        size_t hits = 0, misses = 0;
        for (size_t i = 0; i < PIXELS; i++) {
            struct ray ray = ray_of(&s, i);
            struct trace_counts before = counts;
            struct hit hit = closest(&s.subject.packed, &s.scene, &ray, &counts);
            assert_true(boxes[i] == (double)(counts.boxes - before.boxes));
            assert_true(tris[i] == (double)(counts.tris - before.tris));
            if (hit.prim == ABI_NO_PRIM) {
                assert_true(isnan(t[i]) && isnan(prim[i]) && isnan(normal[3 * i]));
                misses++;
                continue;
            }
            double length = hypot(hypot(normal[3 * i], normal[3 * i + 1]), normal[3 * i + 2]);
            assert_true(t[i] == (double)hit.t && prim[i] == (double)hit.prim);
            const float *plane = s.shading.tri[hit.prim].plane;
            double along = 0.0, beside = 0.0;
            for (size_t k = 0; k < 3; k++) {
                along += (double)plane[k] * (double)ray.dir[k];
                beside += (double)plane[k] * normal[3 * i + k];
            }
            assert_true(fabs(length - 1.0) < 1e-6);
            assert_true(along > 0.0 ? beside <= 1e-6 : beside >= -1e-6); /* the seen side's */
            hits++;
        }
        assert_true(hits > PIXELS / 10 && misses > PIXELS / 10);
        assert_true(show_sum_of(boxes, PIXELS).sum == (double)counts.boxes);
        assert_true(show_sum_of(tris, PIXELS).sum == (double)counts.tris);
        assert_int_equal(counted.boxes, counts.boxes);
        assert_int_equal(counted.tris, counts.tris);
        stand_free(&s);
    }
}

static void parts_of_any_size_make_the_same_picture(void **state)
{
    (void)state;
    static double whole[3 * PIXELS], parts[3 * PIXELS];
    struct show_stand s;
    stand_make(&s, "sphere:n=8", "rf16");
    for (const struct show *show = shows; show->name; show++) {
        struct show_source source = source_of(&s, show->name);
        size_t bytes = sizeof *whole * show->planes * PIXELS;
        struct trace_counts one = values_of(&source, PIXELS, whole);
        struct trace_counts many = values_of(&source, 37, parts);
        assert_memory_equal(whole, parts, bytes);
        assert_int_equal(one.boxes, many.boxes);
        assert_int_equal(one.tris, many.tris);
    }
    stand_free(&s);
}

static void the_numbers_of_a_sphere_are_plausible(void **state)
{
    (void)state;
    static double value[PIXELS];
    struct show_stand s;
    stand_make(&s, "sphere:n=8", "rf16");
    struct show_source source = source_of(&s, "depth");
    values_of(&source, PIXELS, value);
    struct show_sum sum = show_sum_of(value, PIXELS);
    assert_true(sum.most >= 2.0 && sum.most <= (double)s.subject.packed.stack_need);
    source = source_of(&s, "overlap");
    values_of(&source, PIXELS, value);
    sum = show_sum_of(value, PIXELS);
    assert_true(sum.least >= 1.0 && sum.pixels > 0 && sum.pixels < PIXELS);
    double leaves = sum.sum;
    source = source_of(&s, "overlap-all");
    values_of(&source, PIXELS, value);
    assert_true(show_sum_of(value, PIXELS).sum > leaves + (double)sum.pixels);
    source = source_of(&s, "inflation");
    values_of(&source, PIXELS, value);
    sum = show_sum_of(value, PIXELS);
    assert_true(sum.pixels == PIXELS && sum.least >= 1.0 && sum.most > 1.0 && sum.most < 2.0);
    stand_free(&s);
}

/* The walk and the engine on two different trees: what is shown would not be what ran. */
static void a_walk_that_the_engine_did_not_take_is_refused(void **state)
{
    (void)state;
    static double value[PIXELS];
    struct show_stand s, other;
    struct reason reason = {""};
    stand_make(&s, "sphere:n=8", "rf16");
    stand_make(&other, "sphere:n=8", "f32");
    struct show_source source = source_of(&s, "boxes");
    source.self = other.self;
    assert_int_equal(show_values(&source, 0, PIXELS, value, NULL, &reason), STATUS_INTERNAL);
    assert_non_null(strstr(reason.text, "add up to"));
    source.self = s.self;
    source.numbers = other.numbers;
    assert_int_equal(show_values(&source, 0, PIXELS, value, NULL, &reason), STATUS_INTERNAL);
    assert_non_null(strstr(reason.text, "add up to"));
    stand_free(&other);
    stand_make(&other, "soup:n=50", "f32");
    source.numbers = other.numbers;
    assert_int_equal(show_values(&source, 0, PIXELS, value, NULL, &reason), STATUS_INTERNAL);
    assert_non_null(strstr(reason.text, "says otherwise"));
    stand_free(&s);
    stand_free(&other);
}

/* --- the judge ------------------------------------------------------------------------------- */

static void *inner; /* of engine cpu */

/* Engine cpu, and every third hit a little too far, every seventh lost. */
static enum status off_trace(void *self, const struct ray *ray, size_t count, struct hit *hit,
                             struct trace_report *report, struct reason *reason)
{
    (void)self;
    enum status status = engine_find("cpu")->trace(inner, ray, count, hit, report, reason);
    for (size_t i = 0; i < count; i++) {
        if (i % 3 == 0 && hit[i].prim != ABI_NO_PRIM)
            hit[i].t *= 1.0f + 0x1p-12f;
        if (i % 7 == 1)
            hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    }
    return status;
}

static void what_is_right_is_within_its_bound_and_what_is_not_is_not(void **state)
{
    (void)state;
    static double error[PIXELS], class[PIXELS], prim[PIXELS], off_error[PIXELS], off_class[PIXELS];
    const struct engine off = {.name = "off", .trace = off_trace};
    struct show_stand s;
    stand_make(&s, "terrain:k=4", "f32");
    inner = s.self;
    struct show_source source = source_of(&s, "prim");
    values_of(&source, PIXELS, prim);
    source = source_of(&s, "error");
    values_of(&source, PIXELS, error);
    source.engine = &off;
    values_of(&source, PIXELS, off_error);
    source = source_of(&s, "class");
    values_of(&source, PIXELS, class);
    source.engine = &off;
    values_of(&source, PIXELS, off_class);
    size_t too_far = 0, lost = 0;
    for (size_t i = 0; i < PIXELS; i++) {
        bool hit = !isnan(prim[i]);
        assert_true(class[i] != (double)VERDICT_WRONG);
        assert_true(isnan(error[i]) ? !hit : error[i] >= 0.0 && error[i] <= 1.0);
        if (hit && class[i] == (double)VERDICT_RIGHT && i % 7 == 1) {
            assert_true(isnan(off_error[i]) && off_class[i] == (double)VERDICT_WRONG);
            lost++;
        } else if (hit && class[i] == (double)VERDICT_RIGHT && i % 3 == 0) {
            assert_true(off_error[i] > 1.0 && off_class[i] == (double)VERDICT_WRONG);
            too_far++;
        } else if (i % 3 != 0 && i % 7 != 1) {
            assert_true(off_class[i] == class[i]);
            assert_true(off_error[i] == error[i] || isnan(error[i]));
        }
    }
    assert_true(too_far > 50 && lost > 20);
    stand_free(&s);
}

/* The error of each pixel is the judge's own. */
static void errors_are_the_judges(void **state)
{
    (void)state;
    static double error[PIXELS];
    static struct judgement judgement[PIXELS];
    static struct ray ray[PIXELS];
    static struct hit hit[PIXELS];
    struct trace_report report;
    struct reason reason;
    struct show_stand s;
    size_t some = 0;
    stand_make(&s, "terrain:k=4", "f32");
    struct show_source source = source_of(&s, "error");
    values_of(&source, PIXELS, error);
    for (uint32_t i = 0; i < PIXELS; i++) {
        struct shade_path path;
        shade_begin(&s.job, &s.view, i % WIDTH, i / WIDTH, &path);
        ray[i] = shade_ray(&s.job, &path);
    }
    assert_int_equal(engine_find("cpu")->trace(s.self, ray, PIXELS, hit, &report, &reason),
                     STATUS_OK);
    assert_int_equal(verdicts_make(s.oracle, s.judge, ray, hit, PIXELS, judgement, &reason),
                     STATUS_OK);
    for (size_t i = 0; i < PIXELS; i++) {
        const double expected = verdict_error(&judgement[i], &hit[i], false);
        assert_true(isnan(expected) ? isnan(error[i]) : error[i] == expected);
        some += expected > 0;
    }
    assert_true(some > 100);
    stand_free(&s);
}

static void an_unknown_formula_is_measured_by_its_displacement(void **state)
{
    (void)state;
    const struct hit hit = {.t = 1, .prim = 3}, miss = {.prim = ABI_NO_PRIM};
    const struct judgement judgement = {
        .verdict = VERDICT_RIGHT, .over = 0.25, .displacement = 3, .share = 0.5};
    struct judgement noise = judgement, outside = judgement;
    noise.verdict = VERDICT_NOISE;
    outside.verdict = VERDICT_OUT_OF_CONTRACT;
    assert_true(verdict_error(&judgement, &hit, false) == 0.25);
    assert_true(verdict_error(&judgement, &hit, true) == 0.5);
    assert_true(isnan(verdict_error(&judgement, &miss, false)));
    assert_true(isnan(verdict_error(&noise, &hit, false)));
    assert_true(isnan(verdict_error(&outside, &hit, true)));
}

/* --- differences, sums, text ----------------------------------------------------------------- */

static void differences_are_second_less_first(void **state)
{
    (void)state;
    const double a[] = {1, 5, NAN, 2, NAN}, b[] = {3, 4, 7, NAN, NAN};
    double out[5];
    size_t alone = 99;
    show_difference(show_find("boxes"), a, b, 5, out, &alone);
    assert_true(out[0] == 2.0 && out[1] == -1.0 && isnan(out[2]) && isnan(out[3]) && isnan(out[4]));
    assert_int_equal(alone, 2);
    const double same[] = {4, 4, NAN, 4, NAN}, names[] = {4, 5, 4, NAN, NAN};
    show_difference(show_find("prim"), same, names, 5, out, &alone);
    assert_true(out[0] == 0.0 && out[1] == 1.0 && out[2] == 1.0 && out[3] == 1.0 && isnan(out[4]));
    assert_int_equal(alone, 2);
    const double x[] = {1, 0, 0, 0, 1, 0, NAN, NAN, NAN}, y[] = {0, 1, 0, 0, 1, 0, 1, 0, 0};
    show_difference(show_find("normal"), x, y, 3, out, NULL);
    assert_true(fabs(out[0] - 90.0) < 1e-9 && out[1] == 0.0 && isnan(out[2]));
}

static void sums_leave_out_what_has_no_value(void **state)
{
    (void)state;
    const double value[] = {NAN, 4, -2, NAN, 7}, none[] = {NAN, NAN};
    struct show_sum sum = show_sum_of(value, 5);
    assert_int_equal(sum.pixels, 3);
    assert_true(sum.sum == 9.0 && sum.least == -2.0 && sum.most == 7.0 && sum.mean == 3.0);
    assert_int_equal(sum.most_at, 4);
    sum = show_sum_of(none, 2);
    assert_true(sum.pixels == 0 && sum.sum == 0.0 && sum.mean == 0.0);
}

static void values_have_texts(void **state)
{
    (void)state;
    static const struct {
        const char *show;
        double value;
        const char *text;
    } known[] = {
        {"boxes", 12, "12"},     {"t", 0.5, "0.5"},           {"t", (double)NAN, "-"},
        {"class", 0, "right"},   {"class", 9, "wrong"},       {"prim", 123456789, "123456789"},
        {"error", 0.25, "0.25"}, {"class", (double)NAN, "-"}, {"inflation", 1, "1"},
    };
    char text[64];
    for (size_t i = 0; i < ARRAY_COUNT(known); i++) {
        show_text(show_find(known[i].show), known[i].value, text, sizeof text);
        assert_string_equal(text, known[i].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_name_finds_its_picture),
        cmocka_unit_test(answers_and_work_are_the_traversals),
        cmocka_unit_test(parts_of_any_size_make_the_same_picture),
        cmocka_unit_test(the_numbers_of_a_sphere_are_plausible),
        cmocka_unit_test(a_walk_that_the_engine_did_not_take_is_refused),
        cmocka_unit_test(what_is_right_is_within_its_bound_and_what_is_not_is_not),
        cmocka_unit_test(errors_are_the_judges),
        cmocka_unit_test(an_unknown_formula_is_measured_by_its_displacement),
        cmocka_unit_test(differences_are_second_less_first),
        cmocka_unit_test(sums_leave_out_what_has_no_value),
        cmocka_unit_test(values_have_texts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
