/* What a report does with what others made: any JSON, pictures, folders. */
#define _GNU_SOURCE /* open_memstream, mkdtemp */
#include "tests/bench/report_fixture.h"

/* Where a file's members are of another type, the page is still one. */
static void put_everywhere(json_t *json, const json_t *value, struct report *report, size_t *tried)
{
    const char *name;
    void *next;
    json_t *member;
    for (size_t i = 0; i < json_array_size(json); i++) {
        json_t *was = json_incref(json_array_get(json, i));
        put_everywhere(was, value, report, tried);
        json_array_set_new(json, i, json_deep_copy(value));
        free(page_of(report));
        json_array_set_new(json, i, was);
        ++*tried;
    }
    json_object_foreach_safe(json, next, name, member)
    {
        json_t *was = json_incref(member);
        put_everywhere(was, value, report, tried);
        json_object_set_new(json, name, json_deep_copy(value));
        free(page_of(report));
        json_object_set_new(json, name, was);
        ++*tried;
    }
}

static void any_json_gives_a_page(void **state)
{
    (void)state;
    static const char *const values[] = {"null", "-1", "1e300", "'<&\\u0001'",
                                         "[]",   "{}", "true",  "[[1],{'a':[{}]}]"};
    static const struct {
        enum report_kind kind;
        const char *text;
    } files[] = {{REPORT_CHECK, check_text},    {REPORT_BENCH, error_text},
                 {REPORT_BENCH, frames_text},   {REPORT_MACHINE, doctor_text},
                 {REPORT_FINDING, replay_text}, {REPORT_PICTURES, diff_text}};
    for (size_t f = 0; f < ARRAY_COUNT(files); f++)
        for (size_t v = 0; v < ARRAY_COUNT(values); v++) {
            struct report report = empty();
            json_t *json = files[f].text == check_text ? check_of("1", "2", "true", "3", "ok")
                                                       : json_of(files[f].text, NULL, 0);
            char text[64];
            snprintf(text, sizeof text, "[%s]", values[v]);
            json_t *value = json_of(text, NULL, 0);
            size_t tried = 0;
            add(&report, files[f].kind, json, 0);
            put_everywhere(json, json_array_get(value, 0), &report, &tried);
            assert_true(tried > 3);
            json_decref(value);
            report_free(&report);
        }
}

static void pictures_are_whole_or_refused(void **state)
{
    (void)state;
    char path[300], *bytes;
    struct image image;
    struct reason reason;
    struct report report = empty();
    snprintf(path, sizeof path, "%s/a.png", root);
    assert_int_equal(image_make(5, 3, &image, &reason), STATUS_OK);
    image.pixel[7] = image_rgb(255, 0, 9);
    assert_int_equal(image_write(path, &image, &reason), STATUS_OK);
    image_free(&image);
    assert_int_equal(report_add_picture(&report, "g", "a <b>", "c \"d\"", path, &reason),
                     STATUS_OK);
    assert_int_equal(report.picture[0].width, 5);
    assert_int_equal(report.picture[0].height, 3);

    size_t size = report.picture[0].size;
    bytes = malloc(size);
    assert_non_null(bytes);
    memcpy(bytes, report.picture[0].png, size);
    bytes[size / 2] = (char)~bytes[size / 2];
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
    free(bytes);
    assert_int_equal(report_add_picture(&report, "g", "t", "", path, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "a.png"));
    snprintf(path, sizeof path, "%s/none.png", root);
    assert_int_equal(report_add_picture(&report, "g", "t", "", path, &reason), STATUS_INPUT);
    assert_int_equal(report.picture_count, 1);

    char *page = page_of(&report);
    has(page, "<h3>g</h3>");
    has(page, "alt=\"a &lt;b&gt;\" src=\"data:image/png;base64,iVBORw0KGgo");
    free(page);
    report_free(&report);
}

/* Together they stay below what the file may have. */
static void too_large_pictures_are_refused(void **state)
{
    (void)state;
    char path[300];
    struct image image;
    struct reason reason;
    struct report report = empty();
    uint32_t bits = 1;
    snprintf(path, sizeof path, "%s/noise.png", root);
    assert_int_equal(image_make(600, 600, &image, &reason), STATUS_OK);
    for (size_t i = 0; i < (size_t)600 * 600; i++) {
        bits = bits * 1664525u + 1013904223u;
        image.pixel[i] = bits >> 8 | 0xFF000000u;
    }
    assert_int_equal(image_write(path, &image, &reason), STATUS_OK);
    image_free(&image);
    assert_int_equal(report_add_picture(&report, "", "t", "", path, &reason), STATUS_OK);
    assert_int_equal(report_add_picture(&report, "", "t", "", path, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "larger than"));
    char *page = page_of(&report);
    assert_true(strlen(page) < REPORT_BYTES_MOST);
    free(page);
    report_free(&report);
}

static void files_of_others_are_refused(void **state)
{
    (void)state;
    static const char *const texts[] = {"{}", "[]", "{\"rows\": 3}", "{\"rows\": [}", "\"x\""};
    char path[300];
    struct reason reason;
    json_t *json;
    snprintf(path, sizeof path, "%s/x.json", root);
    for (size_t i = 0; i < ARRAY_COUNT(texts); i++)
        for (enum report_kind kind = 0; kind < REPORT_KINDS; kind++) {
            FILE *file = fopen(path, "w");
            assert_non_null(file);
            fputs(texts[i], file);
            assert_int_equal(fclose(file), 0);
            assert_int_equal(report_read(path, kind, &json, &reason), STATUS_INPUT);
            assert_null(json);
            assert_non_null(strstr(reason.text, "x.json"));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_json_gives_a_page),
        cmocka_unit_test(pictures_are_whole_or_refused),
        cmocka_unit_test(too_large_pictures_are_refused),
        cmocka_unit_test(files_of_others_are_refused),
    };
    return cmocka_run_group_tests(tests, make_root, remove_root);
}
