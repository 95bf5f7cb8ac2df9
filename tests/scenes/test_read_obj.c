#include "ref/base/rng.h"
#include "scenes/read/formats.h"
#include "ref/scene/mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* Reads from memory of exactly this size, so that the sanitizer sees a step too far. */
static enum status read_bytes(const char *bytes, size_t size, struct scene *out)
{
    char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    reason.text[0] = '\0';
    enum status status = read_obj("m.obj", copy, size, out, &reason);
    free(copy);
    if (status == STATUS_OK) {
        assert_true(out->tri_count > 0);
        assert_int_equal(scene_check(out, NULL), STATUS_OK);
    } else {
        assert_null(out->vertex);
        assert_int_equal(out->tri_count, 0);
        assert_int_equal(strncmp(reason.text, "m.obj:", 6), 0);
        assert_null(strchr(reason.text, '\n'));
    }
    return status;
}

static void expect_triangles(const char *text, uint32_t vertex_count, uint32_t tri_count,
                             const uint32_t *index)
{
    struct scene scene;
    enum status status = read_bytes(text, strlen(text), &scene);
    if (status != STATUS_OK)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(scene.vertex_count, vertex_count);
    assert_int_equal(scene.tri_count, tri_count);
    assert_memory_equal(scene.index, index, 3 * tri_count * sizeof *index);
    assert_null(scene.normal);
    scene_free(&scene);
}

static void expect_refused(const char *text, const char *rule)
{
    struct scene scene;
    enum status status = read_bytes(text, strlen(text), &scene);
    scene_free(&scene);
    assert_int_equal(status, STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
}

#define CORNERS "v 0 0 0\nv 1 0 0\nv 0 1 0\n"

static void obj_reads_every_form_of_corner(void **state)
{
    (void)state;
    static const uint32_t index[] = {0, 1, 2};
    expect_triangles(CORNERS "f 1 2 3\n", 3, 1, index);
    expect_triangles(CORNERS "vt 0 0\nf 1/1 2/1 3/1\n", 3, 1, index);
    expect_triangles(CORNERS "vn 0 0 1\nf 1//1 2//1 3//1\n", 3, 1, index);
    expect_triangles(CORNERS "vt 0 0\nvn 0 0 1\nf 1/1/1 2/-1/-1 3/1/1\n", 3, 1, index);
    expect_triangles(CORNERS "f -3 -2 -1\n", 3, 1, index);
    expect_triangles(CORNERS "f +1 02 -1", 3, 1, index);
}

static void obj_keeps_the_bits_of_positions(void **state)
{
    (void)state;
    const char *text = "v 0.1 -0 1e-45\nv 3.4028235e38 .5 -2.\nv 16777217 1E2 +7\nf 1 2 3\n";
    static const float want[] = {0x1.99999ap-4f, -0.0f,  0x1p-149f, 0x1.fffffep127f, 0.5f, -2.0f,
                                 0x1p24f,        100.0f, 7.0f};
    struct scene scene;
    assert_int_equal(read_bytes(text, strlen(text), &scene), STATUS_OK);
    assert_memory_equal(scene.vertex, want, sizeof want);
    scene_free(&scene);
}

static void obj_splits_polygons_from_their_first_corner(void **state)
{
    (void)state;
    static const uint32_t index[] = {0, 1, 2, 0, 2, 3, 0, 3, 4, 4, 3, 2};
    expect_triangles("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0 0\nf 1 2 3 4 5\nf 5 4 3\n", 5, 4,
                     index);
}

static void obj_counts_back_from_the_newest_vertex(void **state)
{
    (void)state;
    static const uint32_t index[] = {0, 1, 2, 3, 2, 1};
    expect_triangles(CORNERS "f -3 -2 -1\nv 1 1 0\nf -1 -2 -3\n", 4, 2, index);
}

static void obj_takes_lines_as_people_write_them(void **state)
{
    (void)state;
    static const uint32_t index[] = {0, 1, 2};
    expect_triangles("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n", 3, 1, index);
    expect_triangles("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3", 3, 1, index);
    expect_triangles("\xEF\xBB\xBF# mark\n\t v  0\t0 0 \nv 1 0 0 # colour\n\n \nv 0 1 0\nf 1 2 3 #",
                     3, 1, index);
    expect_triangles("v 0 0 \\\n0\nv 1 \\\r\n 0 0\nv 0 1 0\nf 1 \\\n\\\n2 3\n", 3, 1, index);
    expect_triangles("# a path C:\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 3, 1, index);
    expect_triangles("v 0 0 0 1\nv 1 0 0 .5 .5 .5\nv 0 1 0 1 .5 .5 .5\nf 1 2 3\n", 3, 1, index);
    expect_triangles("mtllib a b.mtl\no x\ng a b\ns off\nusemtl a/b#c\nvp 1\nl 1 2\nVendor_2 x\n"
                     "curv 0 1 \\\n1 2\n" CORNERS "f 1 2 3\n",
                     3, 1, index);
}

static void obj_names_line_and_rule(void **state)
{
    (void)state;
    expect_refused(CORNERS "f 1 2 4\n", ":4: vertex index 4, but 3 stand above");
    expect_refused(CORNERS "f 1 2 -4\n", ":4: vertex index -4, but 3 stand above");
    expect_refused(CORNERS "f 1 2 99999999999999999999\n", ":4: corner: at '99999");
    expect_refused(CORNERS "f 0 1 2\n", ":4: vertex index 0");
    expect_refused("f 1 2 3\n" CORNERS, ":1: vertex index 1, but 0 stand above");
    expect_refused(CORNERS "f 1/1 2/1 3/1\n", ":4: texture index 1, but 0 stand above");
    expect_refused(CORNERS "f 1//2 2//2 3//2\n", ":4: normal index 2, but 0 stand above");
    expect_refused(CORNERS "f 1 2\n", ":4: face with 2 corners");
    expect_refused(CORNERS "f\n", ":4: face with 0 corners");
    expect_refused(CORNERS "f 1 2 x\n", ":4: corner: at 'x'");
    expect_refused(CORNERS "f 1/ 2 3\n", ":4: corner");
    expect_refused(CORNERS "f 1.5 2 3\n", ":4: corner ends in '.5'");
    expect_refused(CORNERS "vt 0 0\nvn 0 0 1\nf 1/1/1/1 2 3\n", ":6: corner ends in '/1'");
    expect_refused("v 0 0\n", ":1: z: end of line is not a finite number");
    expect_refused("v 0 0 nan\n", ":1: z: 'nan' is not a finite number");
    expect_refused("v 0 0 \\\n\ninf 0\n", ":2: z: end of line");
    expect_refused("v -inf 0 0\n", ":1: x: '-inf' is not a finite number");
    expect_refused("v 0 1e39 0\n", ":1: y: '1e39' is beyond the range");
    expect_refused("v 0 0x1p3 0\n", ":1: y: '0x1p3' is not a finite number");
    expect_refused("v 0,5 0 0\n", ":1: x: '0,5' is not a finite number");
    expect_refused("v 0 0 0 1 1\n", ":1: v has 5 numbers");
    expect_refused("v 0 0 0 1 1 1 1 1\n", ":1: v has more than 7 numbers");
    expect_refused("v 0 0 0\n1.0 2.0\n", ":2: '1.0' is no keyword");
    expect_refused("\x7F"
                   "ELF\x01\n",
                   ":1: '?ELF?' is no keyword");
    expect_refused(CORNERS, "has no triangle (3 vertices)");
    expect_refused("# nothing\n", "has no triangle (0 vertices)");
}

static void obj_refuses_polygons_of_too_many_corners(void **state)
{
    (void)state;
    for (uint32_t more = 0; more < 2; more++) {
        uint32_t corners = MESH_CORNERS_MOST + more;
        size_t used = strlen(CORNERS "f"), size = used + 2 * (size_t)corners;
        char *text = malloc(size);
        assert_non_null(text);
        memcpy(text, CORNERS "f", used);
        for (size_t i = used; i < size; i++)
            text[i] = (i - used) % 2 ? (char)('1' + i % 3) : ' ';
        struct scene scene;
        enum status status = read_bytes(text, size, &scene);
        assert_int_equal(status, more ? STATUS_INPUT : STATUS_OK);
        if (more)
            assert_non_null(strstr(reason.text, ":4: polygon with more than 65536 corners"));
        else
            assert_int_equal(scene.tri_count, MESH_CORNERS_MOST - 2);
        scene_free(&scene);
        free(text);
    }
}

static const char sample[] = "# sample\r\nmtllib x.mtl\no a\nv 0 0 0\nv 1.5e0 0 -0.25\nv 0 1 0\n"
                             "v 1 1 1 1\nvt 0 0\nvn 0 0 1\ns 1\nf 1/1/1 2/1/1 \\\n 3/1/1\n"
                             "f -1//1 2//1 3//1 1//1\n";

static void obj_survives_every_prefix(void **state)
{
    (void)state;
    uint32_t read = 0;
    for (size_t size = 0; size <= strlen(sample); size++) {
        struct scene scene;
        read += read_bytes(sample, size, &scene) == STATUS_OK;
        scene_free(&scene);
    }
    assert_true(read > 0 && read < strlen(sample));
}

static void obj_survives_every_damaged_byte(void **state)
{
    (void)state;
    static const char bytes[] = {0,   '\n', '\r', '\\', '/', '-',   '9',
                                 'f', 'v',  ' ',  '#',  '.', '\xFF'};
    char text[sizeof sample];
    for (size_t i = 0; i < strlen(sample); i++) {
        memcpy(text, sample, sizeof sample);
        for (size_t k = 0; k < sizeof bytes; k++) {
            text[i] = bytes[k];
            struct scene scene;
            enum status status = read_bytes(text, strlen(sample), &scene);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            scene_free(&scene);
        }
    }
}

static void obj_survives_noise(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 0);
    for (int run = 0; run < 2000; run++) {
        char noise[64];
        for (size_t i = 0; i < sizeof noise; i++)
            noise[i] = (char)rng_u64(&rng);
        memcpy(noise, run % 2 ? "f " : "v ", 2);
        struct scene scene;
        assert_int_equal(read_bytes(noise, sizeof noise, &scene), STATUS_INPUT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_reads_every_form_of_corner),
        cmocka_unit_test(obj_keeps_the_bits_of_positions),
        cmocka_unit_test(obj_splits_polygons_from_their_first_corner),
        cmocka_unit_test(obj_counts_back_from_the_newest_vertex),
        cmocka_unit_test(obj_takes_lines_as_people_write_them),
        cmocka_unit_test(obj_names_line_and_rule),
        cmocka_unit_test(obj_refuses_polygons_of_too_many_corners),
        cmocka_unit_test(obj_survives_every_prefix),
        cmocka_unit_test(obj_survives_every_damaged_byte),
        cmocka_unit_test(obj_survives_noise),
    };
    return cmocka_run_group_tests_name("read_obj", tests, NULL, NULL);
}
