#include "ref/base/rng.h"
#include "ref/files/file.h"
#include "scenes/read/formats.h"
#include "tests/support/published.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

static enum status read_bytes(const char *bytes, size_t size, struct scene *out)
{
    char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    reason.text[0] = '\0';
    enum status status = read_rtrs("s.json", copy, size, out, &reason);
    free(copy);
    if (status == STATUS_OK) {
        assert_true(out->tri_count > 0);
        assert_int_equal(scene_check(out, NULL), STATUS_OK);
    } else {
        assert_null(out->vertex);
        assert_null(out->light);
        assert_int_equal(strncmp(reason.text, "s.json:", 7), 0);
        assert_null(strchr(reason.text, '\n'));
    }
    return status;
}

/* A small scene; integers stand where floats may. */
static const char sample[] =
    "{\"camera\": {\"pos\": [0, 1.5, -10], \"at\": [0.0, 0, 0], \"roll\": null},\n"
    "\"camera_controller\": \"Fixed\", \"extra\": [1, {\"a\": 2}],\n"
    "\"prims\": [{\"indices\": [0, 1, 2], \"material\": 1}],\n"
    "\"vertices\": [{\"pos\": [0, 0, 0], \"normal\": [0, 0, 1]},\n"
    " {\"pos\": [0.1, -0.0, 1e-45], \"normal\": [0, 0, 1]},\n"
    " {\"pos\": [3.4028235e38, 16777217, 2], \"normal\": [0.6, 0, 0.8]}],\n"
    "\"lights\": [{\"pos\": [1, 2, 3], \"strength\": 1.5}],\n"
    "\"materials\": [{\"color\": [0.4, 0.4, 0.3], \"albedo\": [0.6, 0.3, 0.1], \"spec\": 50},\n"
    " {\"color\": [0.3, 0.1, 0.1], \"albedo\": [0.9, 0.1, 0], \"spec\": 10}]}\n";

/* Reads the sample with the first `old` replaced by `new`. */
static enum status read_changed(const char *old, const char *new, struct scene *out)
{
    const char *at = strstr(sample, old);
    assert_non_null(at);
    char *text = malloc(sizeof sample + strlen(new));
    assert_non_null(text);
    int size = sprintf(text, "%.*s%s%s", (int)(at - sample), sample, new, at + strlen(old));
    enum status status = read_bytes(text, (size_t)size, out);
    free(text);
    return status;
}

static void expect_refused(const char *old, const char *new, const char *rule)
{
    struct scene scene;
    enum status status = read_changed(old, new, &scene);
    scene_free(&scene);
    assert_int_equal(status, STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
}

static void rtrs_reads_every_field(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(read_bytes(sample, strlen(sample), &scene), STATUS_OK);
    static const float vertex[] = {0, 0, 0, 0.1f, -0.0f, 0x1p-149f, 0x1.fffffep127f, 0x1p24f, 2};
    static const float normal[] = {0, 0, 1, 0, 0, 1, 0.6f, 0, 0.8f};
    static const uint32_t index[] = {0, 1, 2};
    static const struct light light = {{1, 2, 3}, 1.5f};
    static const struct material material[] = {{{0.4f, 0.4f, 0.3f}, {0.6f, 0.3f, 0.1f}, 50},
                                               {{0.3f, 0.1f, 0.1f}, {0.9f, 0.1f, 0}, 10}};
    assert_int_equal(scene.vertex_count, 3);
    assert_int_equal(scene.tri_count, 1);
    assert_int_equal(scene.light_count, 1);
    assert_int_equal(scene.material_count, 2);
    assert_memory_equal(scene.vertex, vertex, sizeof vertex);
    assert_memory_equal(scene.normal, normal, sizeof normal);
    assert_memory_equal(scene.index, index, sizeof index);
    assert_int_equal(scene.material_of[0], 1);
    assert_memory_equal(scene.light, &light, sizeof light);
    assert_memory_equal(scene.material, material, sizeof material);
    assert_true(scene.has_camera && !scene.camera.orbit);
    assert_true(scene.camera.pos[1] == 1.5f && scene.camera.pos[2] == -10.0f);
    assert_true(scene.camera.at[0] == 0.0f);
    scene_free(&scene);
}

static void rtrs_needs_no_lights_and_no_materials(void **state)
{
    (void)state;
    struct scene scene;
    assert_int_equal(read_changed("{\"pos\": [1, 2, 3], \"strength\": 1.5}", "", &scene),
                     STATUS_OK);
    assert_int_equal(scene.light_count, 0);
    assert_null(scene.light);
    scene_free(&scene);
    const char *text =
        "{\"camera\":{\"pos\":[0,0,1],\"at\":[0,0,0]},\"camera_controller\":\"Orbit\","
        "\"prims\":[{\"indices\":[0,0,0],\"material\":0}],\"vertices\":[{\"pos\":"
        "[0,0,0],\"normal\":[0,0,1]}],\"lights\":[],\"materials\":[]}";
    assert_int_equal(read_bytes(text, strlen(text), &scene), STATUS_OK);
    assert_null(scene.material);
    assert_true(scene.camera.orbit);
    scene_free(&scene);
}

static void rtrs_names_the_path_and_rule(void **state)
{
    (void)state;
    expect_refused("0.6, 0, 0.8", "0.6, null, 0.8", "vertices[2].normal[1]: is null");
    expect_refused("[0.1, -0.0, 1e-45]", "[0.1, \"1\", 0]", "vertices[1].pos[1]: must be a number");
    expect_refused("3.4028235e38", "3.4028236e38", "vertices[2].pos[0]: is beyond the range");
    expect_refused("1e-45", "-1e300", "vertices[1].pos[2]: is beyond the range");
    expect_refused("1e-45", "1e999", "s.json:5:"); /* beyond a double: refused by the parser */
    expect_refused("[0.1, -0.0, 1e-45]", "[0.1, 0]",
                   "vertices[1].pos: must be an array of exactly 3");
    expect_refused("[0.1, -0.0, 1e-45]", "[0, 0, 0, 0]", "vertices[1].pos: must be an array of");
    expect_refused("[0.1, -0.0, 1e-45]", "7", "vertices[1].pos: must be an array of exactly 3");
    expect_refused("\"normal\": [0.6, 0, 0.8]", "\"n\": 0", "vertices[2].normal: is missing");
    expect_refused("{\"pos\": [0, 0, 0], \"normal\": [0, 0, 1]}", "5",
                   "vertices[0]: must be an object");
    expect_refused("[0, 1, 2]", "[0, 1, 3]", "prims[0].indices[2]: names a vertex that does not");
    expect_refused("[0, 1, 2]", "[0, -1, 2]", "prims[0].indices[1]: must be a whole number");
    expect_refused("[0, 1, 2]", "[0, 1.0, 2]", "prims[0].indices[1]: must be a whole number");
    expect_refused("[0, 1, 2]", "[0, 4294967296, 2]", "prims[0].indices[1]: must be");
    expect_refused("\"material\": 1", "\"material\": 2", "prims[0].material: names a material");
    expect_refused("\"material\": 1", "\"material\": -1", "prims[0].material: must be a whole");
    expect_refused("\"material\": 1", "\"material\": 0.5", "prims[0].material: must be a whole");
    expect_refused("{\"indices\": [0, 1, 2], \"material\": 1}", "", "prims: is empty");
    expect_refused("1.5}", "null}", "lights[0].strength: is null");
    expect_refused("\"spec\": 10", "\"spec\": [10]", "materials[1].spec: must be a number");
    expect_refused("\"Fixed\"", "\"Free\"", "camera_controller: must be \"Orbit\" or \"Fixed\"");
    expect_refused("\"Fixed\"", "{\"Fixed\": 1}", "camera_controller: must be");
    expect_refused("\"at\"", "\"to\"", "camera.at: is missing");
    expect_refused("\"extra\": [1, {\"a\": 2}]", "\"lights\": []",
                   "s.json: lights: is there twice");
    expect_refused("\"roll\"", "\"at\"", "s.json:1:57: duplicate object key");
    expect_refused("\"extra\": [1", "\"extra\": [1,,", "s.json:2:");
    expect_refused("\"strength\": 1.5}]", "\"strength\": 1.5} 7]", "s.json:7:48: ',' or ']' must");
    expect_refused("\"strength\": 1.5}]", "\"strength\": 1.5}],", "s.json:7:49: a key in quotes");
    expect_refused("\"lights\":", "\"lights\"", "s.json:7:10: ':' must stand here");
    expect_refused("\"vertices\": [", "\"vertices\": 5, \"v\": [", "s.json:4:13: an array must");
    expect_refused("10}]}", "10}]} {", "s.json:9:68: nothing may follow");
    expect_refused("10}]}", "10}]", "s.json:10:1: the text is cut short");
    static const char *const keys[] = {"camera", "camera_controller", "prims", "vertices",
                                       "lights", "materials"};
    for (size_t i = 0; i < ARRAY_COUNT(keys); i++) {
        char old[32], rule[64];
        snprintf(old, sizeof old, "\"%s\"", keys[i]);
        snprintf(rule, sizeof rule, "s.json: %s: is missing", keys[i]);
        expect_refused(old, "\"other\"", rule);
    }
}

static void rtrs_refuses_what_is_no_scene(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "[]", "3", "\"x\"", "null", "{", "{}", "{]", "\xFF\xFE{", "{\"camera\": NaN}", "v 0 0 0\n"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct scene scene;
        assert_int_equal(read_bytes(bad[i], strlen(bad[i]), &scene), STATUS_INPUT);
    }
    /* Deep nesting must not exhaust the stack. */
    enum { DEEP = 1000000 };
    char *text = malloc(DEEP);
    assert_non_null(text);
    memset(text, '[', DEEP);
    struct scene scene;
    assert_int_equal(read_bytes(text, DEEP, &scene), STATUS_INPUT);
    free(text);
}

static void rtrs_survives_every_prefix_and_damaged_byte(void **state)
{
    (void)state;
    size_t length = strlen(sample);
    for (size_t size = 0; size < length - 1; size++) {
        struct scene scene;
        assert_int_equal(read_bytes(sample, size, &scene), STATUS_INPUT);
    }
    static const char bytes[] = {0, '"', '{', ']', ',', '-', '9', '.', 'e', '\n', '\x80'};
    char text[sizeof sample];
    for (size_t i = 0; i < length; i++) {
        memcpy(text, sample, sizeof sample);
        for (size_t k = 0; k < sizeof bytes; k++) {
            text[i] = bytes[k];
            struct scene scene;
            enum status status = read_bytes(text, length, &scene);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            scene_free(&scene);
        }
    }
}

static void rtrs_default_scene_loads_unchanged(void **state)
{
    (void)state;
    const char *path = published_scene();
    if (!path)
        skip();
    char *bytes;
    size_t size;
    struct scene scene;
    assert_int_equal(file_read(path, &bytes, &size, &reason), STATUS_OK);
    assert_int_equal(read_rtrs(path, bytes, size, &scene, &reason), STATUS_OK);
    free(bytes);
    assert_int_equal(scene.tri_count, 40);
    assert_int_equal(scene.vertex_count, 24);
    assert_int_equal(scene.light_count, 3);
    assert_int_equal(scene.material_count, 3);
    assert_true(scene.camera.orbit && scene.camera.pos[2] == -10.0f);
    for (uint32_t i = 0; i < 40; i++)
        assert_int_equal(scene.material_of[i], i < 4); /* the tetrahedron comes first */
    assert_true(scene.material[2].spec == 1425.0f);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rtrs_reads_every_field),
        cmocka_unit_test(rtrs_needs_no_lights_and_no_materials),
        cmocka_unit_test(rtrs_names_the_path_and_rule),
        cmocka_unit_test(rtrs_refuses_what_is_no_scene),
        cmocka_unit_test(rtrs_survives_every_prefix_and_damaged_byte),
        cmocka_unit_test(rtrs_default_scene_loads_unchanged),
    };
    return cmocka_run_group_tests_name("read_rtrs", tests, NULL, NULL);
}
