#define _GNU_SOURCE /* mkdtemp, open_memstream */
#include "ref/base/rng.h"
#include "ref/files/file.h"
#include "scenes/read/formats.h"
#include "scenes/read/normals.h"
#include "scenes/scenes.h"
#include "tests/support/published.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/support/root.h"

static struct reason reason;

static const char *in_folder(const char *name)
{
    static char path[300];
    snprintf(path, sizeof path, "%s/%s", root, name);
    return path;
}

/* What a writer makes, as text with a 0 behind it; the caller frees it. */
static char *written(enum status (*write)(const struct scene *, FILE *, struct reason *),
                     const struct scene *scene, size_t *size)
{
    char *text = NULL;
    FILE *stream = open_memstream(&text, size);
    assert_non_null(stream);
    assert_int_equal(write(scene, stream, &reason), STATUS_OK);
    assert_int_equal(fclose(stream), 0);
    return text;
}

/* Triangles of random bits: every finite float, subnormal and negative zeros among them. */
static struct scene make_wild(uint32_t vertex_count, uint32_t tri_count)
{
    struct scene scene;
    assert_int_equal(scene_make(vertex_count, tri_count, &scene), STATUS_OK);
    struct rng rng = rng_make(5, 0);
    for (uint32_t i = 0; i < 3 * vertex_count; i++) {
        do
            scene.vertex[i] = float_from_bits((uint32_t)rng_u64(&rng));
        while (!float_is_finite(scene.vertex[i]));
        if (i % 5 == 0)
            scene.vertex[i] = float_from_bits((uint32_t)rng_u64(&rng) & 0x800000FF);
    }
    for (uint32_t i = 0; i < 3 * tri_count; i++)
        scene.index[i] = rng_below(&rng, vertex_count);
    return scene;
}

static void assert_same_triangles(const struct scene *a, const struct scene *b)
{
    assert_int_equal(a->vertex_count, b->vertex_count);
    assert_int_equal(a->tri_count, b->tri_count);
    assert_memory_equal(a->vertex, b->vertex, 12 * (size_t)a->vertex_count);
    assert_memory_equal(a->index, b->index, 12 * (size_t)a->tri_count);
}

static void every_format_keeps_every_bit(void **state)
{
    (void)state;
    struct scene scene = make_wild(500, 700), back;
    static const char *const names[] = {"wild.obj", "wild.ply", "wild.json", "Wild.OBJ"};
    for (size_t i = 0; i < ARRAY_COUNT(names); i++) {
        assert_int_equal(scene_write(in_folder(names[i]), &scene, &reason), STATUS_OK);
        enum status status = scene_read(in_folder(names[i]), &back, &reason);
        if (status != STATUS_OK)
            print_error("%s\n", reason.text);
        assert_int_equal(status, STATUS_OK);
        assert_same_triangles(&scene, &back);
        scene_free(&back);
    }
    scene_free(&scene);
}

static void rtrs_keeps_what_only_it_can_hold(void **state)
{
    (void)state;
    struct scene scene = make_wild(30, 20), back;
    scene.normal = alloc_zeroed(90, sizeof(float));
    scene.material_of = alloc_zeroed(20, sizeof(int32_t));
    scene.light = alloc_zeroed(2, sizeof(struct light));
    scene.material = alloc_zeroed(3, sizeof(struct material));
    assert_true(scene.normal && scene.material_of && scene.light && scene.material);
    scene.light_count = 2;
    scene.material_count = 3;
    for (int i = 0; i < 90; i++)
        scene.normal[i] = 1.0f / (float)(i + 1);
    for (int i = 0; i < 20; i++)
        scene.material_of[i] = i % 3;
    scene.light[1] = (struct light){{1.5f, -2, 1e-9f}, 0.1f};
    scene.material[2] = (struct material){{0.1f, 0.2f, 0.3f}, {1e20f, 0.5f, 0.6f}, 1425};
    scene.camera = (struct camera){{1, 2, 3}, {0.1f, 0, -7}, false};
    scene.has_camera = true;
    assert_int_equal(scene_write(in_folder("full.json"), &scene, &reason), STATUS_OK);
    assert_int_equal(scene_read(in_folder("full.json"), &back, &reason), STATUS_OK);
    assert_same_triangles(&scene, &back);
    assert_memory_equal(scene.normal, back.normal, 90 * sizeof(float));
    assert_memory_equal(scene.material_of, back.material_of, 20 * sizeof(int32_t));
    assert_int_equal(back.light_count, 2);
    assert_memory_equal(scene.light, back.light, 2 * sizeof(struct light));
    assert_int_equal(back.material_count, 3);
    assert_memory_equal(scene.material, back.material, 3 * sizeof(struct material));
    assert_memory_equal(scene.camera.pos, back.camera.pos, sizeof scene.camera.pos);
    assert_memory_equal(scene.camera.at, back.camera.at, sizeof scene.camera.at);
    assert_false(back.camera.orbit);
    scene_free(&scene);
    scene_free(&back);
}

static struct scene one_triangle(void)
{
    static const float vertex[] = {0, 0, 0, 2, 0, 0, 0, 0.5f, 0};
    struct scene scene;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    for (uint32_t c = 0; c < 3; c++)
        scene.index[c] = c;
    return scene;
}

static void rtrs_text_is_golden(void **state)
{
    (void)state;
    static const char golden[] =
        "{\n  \"camera\": {\n    \"pos\": [\n      0.0,\n      0.0,\n      1e20\n    ],\n"
        "    \"at\": [\n      1.0,\n      0.0,\n      0.0\n    ]\n  },\n"
        "  \"camera_controller\": \"Orbit\",\n  \"prims\": [\n    {\n      \"indices\": [\n"
        "        0,\n        1,\n        2\n      ],\n      \"material\": 0\n    }\n  ],\n"
        "  \"vertices\": [\n"
        "    {\n      \"pos\": [\n        0.0,\n        0.0,\n        0.0\n      ],\n"
        "      \"normal\": [\n        0.0,\n        0.0,\n        1.0\n      ]\n    },\n"
        "    {\n      \"pos\": [\n        2.0,\n        0.0,\n        0.0\n      ],\n"
        "      \"normal\": [\n        0.0,\n        0.0,\n        1.0\n      ]\n    },\n"
        "    {\n      \"pos\": [\n        0.0,\n        0.5,\n        0.0\n      ],\n"
        "      \"normal\": [\n        0.0,\n        0.0,\n        1.0\n      ]\n    }\n  ],\n"
        "  \"lights\": [],\n"
        "  \"materials\": [\n    {\n      \"color\": [\n        0.5,\n        0.1,\n        0.1\n"
        "      ],\n      \"albedo\": [\n        0.9,\n        0.1,\n        0.0\n      ],\n"
        "      \"spec\": 10.0\n    }\n  ]\n}";
    struct scene scene = one_triangle();
    scene.camera = (struct camera){{0, 0, 1e20f}, {1, 0, 0}, true};
    scene.has_camera = true;
    size_t size;
    char *text = written(write_rtrs, &scene, &size);
    assert_string_equal(text, golden);
    assert_int_equal(size, strlen(golden));
    free(text);
    scene_free(&scene);
}

static void obj_and_ply_bytes_are_golden(void **state)
{
    (void)state;
    struct scene scene = one_triangle();
    size_t size;
    char *text = written(write_obj, &scene, &size);
    assert_string_equal(text, "# 3 vertices, 1 triangles\nv 0.0 0.0 0.0\nv 2.0 0.0 0.0\n"
                              "v 0.0 0.5 0.0\nf 1 2 3\n");
    free(text);
    static const char header[] =
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n"
        "property float y\nproperty float z\nelement face 1\n"
        "property list uchar uint vertex_indices\nend_header\n";
    static const unsigned char data[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,    0x40, 0,
                                         0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x3F, 0,    0,
                                         0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0};
    text = written(write_ply, &scene, &size);
    assert_int_equal(size, sizeof header - 1 + sizeof data);
    assert_memory_equal(text, header, sizeof header - 1);
    assert_memory_equal(text + sizeof header - 1, data, sizeof data);
    free(text);
    scene_free(&scene);
}

static void rtrs_default_scene_is_written_byte_for_byte(void **state)
{
    (void)state;
    const char *path = published_scene();
    if (!path)
        skip();
    struct scene scene;
    char *want, *got;
    size_t want_size, got_size;
    assert_int_equal(scene_read(path, &scene, &reason), STATUS_OK);
    assert_int_equal(scene_write(in_folder("again.json"), &scene, &reason), STATUS_OK);
    assert_int_equal(file_read(path, &want, &want_size, &reason), STATUS_OK);
    assert_int_equal(file_read(in_folder("again.json"), &got, &got_size, &reason), STATUS_OK);
    assert_int_equal(want_size, got_size);
    assert_memory_equal(want, got, want_size);
    free(want);
    free(got);
    scene_free(&scene);
}

static void normals_are_weighted_by_angle(void **state)
{
    (void)state;
    /* A cube's corner: the quad in z = 0 is split in two, and still weighs as much as the others.
     */
    static const float vertex[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t index[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1};
    struct scene scene;
    assert_int_equal(scene_make(5, 4, &scene), STATUS_OK);
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    float *normal = scene_normals(&scene);
    assert_non_null(normal);
    for (int k = 0; k < 3; k++)
        assert_true(fabsf(normal[k] - sqrtf(1.0f / 3.0f)) < 1e-6f);
    assert_true(normal[6] == 0 && normal[7] == 0 && normal[8] == 1);
    free(normal);
    scene_free(&scene);
}

static void normals_are_never_nan(void **state)
{
    (void)state;
    struct scene scene = make_wild(200, 60);
    scene.index[0] = scene.index[1]; /* no area */
    float *normal = scene_normals(&scene);
    assert_non_null(normal);
    for (uint32_t i = 0; i < 200; i++) {
        const float *n = normal + 3 * i;
        assert_true(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
    }
    free(normal);
    scene_free(&scene);
    scene = one_triangle();
    memset(scene.vertex, 0, 9 * sizeof(float));
    normal = scene_normals(&scene);
    assert_non_null(normal);
    assert_true(normal[0] == 0 && normal[1] == 1 && normal[2] == 0);
    free(normal);
    scene_free(&scene);
}

static size_t count_entries(void)
{
    DIR *listing = opendir(root);
    assert_non_null(listing);
    size_t count = 0;
    while (readdir(listing))
        count++;
    closedir(listing);
    return count;
}

static void expect_not_written(const char *path, const struct scene *scene, const char *rule)
{
    size_t before = count_entries();
    assert_int_equal(scene_write(path, scene, &reason), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
    assert_int_equal(count_entries(), before);
}

static void a_failed_write_leaves_nothing(void **state)
{
    (void)state;
    struct scene scene = one_triangle();
    expect_not_written(in_folder("x.off"), &scene, "unknown ending");
    expect_not_written(in_folder("x.ply.gz"), &scene, "unknown ending");
    expect_not_written(in_folder("x"), &scene, "unknown ending");
    expect_not_written(in_folder("no/x.ply"), &scene, "cannot write");
    assert_int_equal(mkdir(in_folder("dir.ply"), 0700), 0);
    expect_not_written(in_folder("dir.ply"), &scene, "is a directory");
    scene.vertex[4] = NAN;
    expect_not_written(in_folder("x.obj"), &scene, "vertex 1: coordinate y is not finite");
    scene.vertex[4] = 0;
    scene.camera.at[2] = INFINITY;
    scene.has_camera = true;
    expect_not_written(in_folder("x.json"), &scene, "camera target: number 2 is not finite");
    scene.normal = alloc_zeroed(9, sizeof(float));
    assert_non_null(scene.normal);
    scene.normal[7] = NAN;
    expect_not_written(in_folder("x.json"), &scene, "normals: number 7 is not finite");
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_format_keeps_every_bit),
        cmocka_unit_test(rtrs_keeps_what_only_it_can_hold),
        cmocka_unit_test(rtrs_text_is_golden),
        cmocka_unit_test(obj_and_ply_bytes_are_golden),
        cmocka_unit_test(rtrs_default_scene_is_written_byte_for_byte),
        cmocka_unit_test(normals_are_weighted_by_angle),
        cmocka_unit_test(normals_are_never_nan),
        cmocka_unit_test(a_failed_write_leaves_nothing),
    };
    return cmocka_run_group_tests_name("writers", tests, make_root, remove_root);
}
