/* What each picture of the tree shows, held against what was computed without it: the traversal's
 * answers and counters, the judge's verdicts, differences by hand. */
#include "tests/scenes/show_fixture.h"

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

static struct ray ray_of(const struct show_stand *s, size_t pixel)
{
    struct shade_path path;
    shade_begin(&s->job, &s->view, (uint32_t)(pixel % WIDTH), (uint32_t)(pixel / WIDTH), &path);
    return shade_ray(&s->job, &path);
}

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
    assert_non_null(strstr(reason.text, "the C traversal"));
    stand_free(&s);
    stand_free(&other);
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

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_name_finds_its_picture),
        cmocka_unit_test(answers_and_work_are_the_traversals),
        cmocka_unit_test(parts_of_any_size_make_the_same_picture),
        cmocka_unit_test(the_numbers_of_a_sphere_are_plausible),
        cmocka_unit_test(a_walk_that_the_engine_did_not_take_is_refused),
        cmocka_unit_test(what_is_right_is_within_its_bound_and_what_is_not_is_not),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
