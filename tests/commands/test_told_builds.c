/* What raydiff build tells, each number beside its own name, in the text and the JSON; and what
 * counts as equal. */
#define _GNU_SOURCE /* open_memstream */
#include "cmd/build/cmd_build.h"

#include "tests/commands/told.h"

static struct build_part part_of(int p)
{
    return (struct build_part){.device_ms = 100 + p,
                               .c_ms = 200 + p,
                               .ratio = 3 + p / 16.0,
                               .ratio_least = 2 + p / 16.0,
                               .ratio_most = 7 + p / 16.0};
}

static void must_be_part(json_t *json, int p)
{
    const struct build_part part = part_of(p);
    assert_true(number_at(json, "device_ms") == part.device_ms);
    assert_true(number_at(json, "c_ms") == part.c_ms);
    assert_true(number_at(json, "ratio") == part.ratio);
    assert_true(number_at(json, "ratio_least") == part.ratio_least);
    assert_true(number_at(json, "ratio_most") == part.ratio_most);
}

/* Each stage's times and ratios, and the memory a triangle. */
static void the_text_and_the_json_of_a_builder(void **state)
{
    (void)state;
    struct build_row row = {
        .scene = "s", .builder = builders_all[0], .triangles = 40, .device_bytes = 9000};
    static struct build_wide wide;
    struct build_refit refit = {
        .scene = "s", .layout = layouts_all[0], .triangles = 40, .part = part_of(31)};
    const struct screen screen = {.width = 400, .wide = true};
    char *text = NULL, line[160];
    size_t size;
    wide = (struct build_wide){.scene = "s",
                               .builder = builders_all[0],
                               .layout = layouts_all[0],
                               .triangles = 40,
                               .nodes = 12,
                               .device_bytes = 700};
    for (int p = 0; p <= STAGED_PARTS; p++)
        row.part[p] = part_of(p);
    for (int p = 0; p < WIDE_PARTS; p++)
        wide.part[p] = part_of(20 + p);
    FILE *before = stdout, *stream = open_memstream(&text, &size);
    assert_non_null(stream);
    stdout = stream;
    build_print(&row, 1, &screen);
    build_print_wide(&wide, 1, &screen);
    build_print_refits(&refit, 1, &screen);
    fclose(stream);
    stdout = before;
    assert_non_null(strstr(text, "device memory: 225.0 bytes a triangle\n"));
    for (int p = 0; p <= 31; p = p == STAGED_PARTS ? 20 : p == 19 + WIDE_PARTS ? 31 : p + 1) {
        const struct build_part part = part_of(p);
        snprintf(line, sizeof line, "%.3f", part.device_ms);
        const char *at = strstr(text, line);
        double number[5];
        assert_non_null(at);
        assert_int_equal(sscanf(at, "%lf %lf %lf %lf-%lf", &number[0], &number[1], &number[2],
                                &number[3], &number[4]),
                         5);
        assert_true(number[1] == part.c_ms && fabs(number[2] - part.ratio) < 0.006);
        assert_true(fabs(number[3] - part.ratio_least) < 0.006);
        assert_true(fabs(number[4] - part.ratio_most) < 0.006);
    }
    free(text);
    json_t *a = build_wide_json(&wide, 1), *b = build_refits_json(&refit, 1);
    assert_true(number_at(a, "0.triangles") == 40 && number_at(a, "0.nodes") == 12);
    assert_true(number_at(a, "0.device_bytes") == 700);
    for (int p = 0; p < WIDE_PARTS; p++)
        must_be_part(json_array_get(json_object_get(json_array_get(a, 0), "stages"), (size_t)p),
                     20 + p);
    must_be_part(json_array_get(b, 0), 31);
    json_decref(a);
    json_decref(b);
}

/* What was refused, was not played or differs is not equal. */
static void only_what_was_compared_is_equal(void **state)
{
    (void)state;
    for (uint32_t how = 0; how < 4; how++) {
        static struct build_wide wide;
        struct build_refit refit = {.scene = "s", .layout = layouts_all[0]};
        wide = (struct build_wide){.scene = "s", .layout = layouts_all[0], .unplayed = how == 3};
        wide.builder = builders_all[0];
        if (how == 1)
            wide.refused = refit.refused = (struct reason){"too large"};
        wide.differs.stage = how == 2 ? "words" : NULL;
        refit.differing = how == 2;
        json_t *a = build_wide_json(&wide, 1), *b = build_refits_json(&refit, 1);
        json_t *one = json_array_get(a, 0), *other = json_array_get(b, 0);
        assert_int_equal(json_is_true(json_object_get(one, "equal")), how == 0);
        assert_int_equal(json_is_true(json_object_get(other, "equal")), how == 0 || how == 3);
        assert_int_equal(json_is_string(json_object_get(one, "refused")), how == 1);
        json_decref(a);
        json_decref(b);
    }
}

/* Each part of a collapse is of its own rounds. */
static void parts_are_of_their_own_rounds(void **state)
{
    (void)state;
    static struct build_wide wide;
    for (uint32_t rounds = 1; rounds < 6; rounds++) {
        for (int p = 0; p < WIDE_PARTS; p++)
            for (uint32_t r = 0; r < rounds; r++) {
                wide.device_ns[p][r] = 1e6 * (1 + p) + 1e3 * (r * 7 % 5);
                wide.c_ns[p][r] = 3e6 * (2 + p) + 1e3 * (r * 3 % 5);
            }
        build_wide_sum(&wide, rounds);
        for (int p = 0; p < WIDE_PARTS; p++) {
            const struct build_part own = build_part_of(wide.device_ns[p], wide.c_ns[p], rounds);
            assert_memory_equal(&wide.part[p], &own, sizeof own);
            assert_true(fabs(own.device_ms - (1 + p)) < 0.01 &&
                        fabs(own.c_ms - 3 * (2 + p)) < 0.01);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_text_and_the_json_of_a_builder),
        cmocka_unit_test(only_what_was_compared_is_equal),
        cmocka_unit_test(parts_are_of_their_own_rounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
