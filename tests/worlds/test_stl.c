/* STL: both kinds, told apart by size, shared vertices, what is refused, what is written. */
#define _GNU_SOURCE /* open_memstream */
#include "ref/base/rng.h"
#include "ref/scene/topology.h"
#include "scenes/read/formats.h"
#include "scenes/scenes.h"

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
    enum status status = read_stl("s.stl", copy, size, out, &reason);
    free(copy);
    if (status == STATUS_OK) {
        assert_int_equal(scene_check(out, NULL), STATUS_OK);
        assert_true(out->tri_count > 0);
    } else {
        assert_null(out->vertex);
        assert_int_equal(strncmp(reason.text, "s.stl:", 6), 0);
        assert_null(strchr(reason.text, '\n'));
    }
    return status;
}

static void expect_bytes_refused(const char *bytes, size_t size, const char *rule)
{
    struct scene scene;
    assert_int_equal(read_bytes(bytes, size, &scene), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
}

/* Two triangles of a square, one vertex of which has another zero. */
static const float square[2][3][3] = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                      {{0, 0, 0}, {1, 1, 0}, {-0.0f, 1, 0x1p-149f}}};

#define SQUARE_BYTES (84 + 2 * 50)

/* The square as a binary file, whose header is `head`. */
static void make_binary(const char *head, char bytes[SQUARE_BYTES])
{
    const uint32_t count = 2;
    memset(bytes, 0xA5, SQUARE_BYTES); /* normals and attributes are garbage */
    memset(bytes, 0, 80);
    memcpy(bytes, head, strlen(head));
    memcpy(bytes + 80, &count, 4);
    for (int i = 0; i < 2; i++)
        memcpy(bytes + 84 + 50 * i + 12, square[i], sizeof square[i]);
}

static const char ascii[] =
    "solid a square  with a name\n"
    "facet normal nan 0 0\n outer loop\n"
    "  vertex 0 0 0\n  vertex 1 0 0\n  vertex 1 1.0e0 0\n endloop\nendfacet\n"
    "endsolid a square\n\n"
    "SOLID\r\nFacet Normal 0 0 1 Outer Loop\n"
    "vertex 0 0 0 vertex 1 1 0 vertex -0.0 1\n 1.4e-45 EndLoop endfacet\n"
    "EndSolid";

static void expect_square(const struct scene *scene)
{
    static const uint32_t index[] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(scene->vertex_count, 4);
    assert_int_equal(scene->tri_count, 2);
    assert_memory_equal(scene->index, index, sizeof index);
    assert_memory_equal(scene->vertex, square[0], sizeof square[0]);
    assert_memory_equal(scene->vertex + 9, square[1][2], sizeof square[1][2]);
}

static void binary_and_ascii_are_the_same_mesh(void **state)
{
    (void)state;
    static const char *const heads[] = {"made by hand", "solid a square", "solid", ""};
    struct scene scene;
    for (size_t i = 0; i < ARRAY_COUNT(heads); i++) {
        char bytes[SQUARE_BYTES];
        make_binary(heads[i], bytes);
        assert_int_equal(read_bytes(bytes, sizeof bytes, &scene), STATUS_OK);
        expect_square(&scene);
        scene_free(&scene);
    }
    assert_int_equal(read_bytes(ascii, strlen(ascii), &scene), STATUS_OK);
    expect_square(&scene);
    scene_free(&scene);
}

static void zeros_of_both_signs_are_two_vertices(void **state)
{
    (void)state;
    char bytes[SQUARE_BYTES];
    struct scene scene;
    const uint32_t minus = 0x80000000u;
    make_binary("", bytes);
    memcpy(bytes + 84 + 50 + 12, &minus, 4); /* the first corner of the second triangle */
    assert_int_equal(read_bytes(bytes, sizeof bytes, &scene), STATUS_OK);
    assert_int_equal(scene.vertex_count, 5);
    assert_int_equal(float_bits(scene.vertex[9]), minus);
    scene_free(&scene);
}

static void binary_files_are_refused_by_byte(void **state)
{
    (void)state;
    char bytes[SQUARE_BYTES + 1];
    make_binary("made", bytes);
    bytes[SQUARE_BYTES] = 0;
    expect_bytes_refused(bytes, 83, "s.stl: begins with no \"solid\", and is shorter than the 84");
    expect_bytes_refused(bytes, 84,
                         "s.stl: byte 80: 2 triangles take 184 bytes, but the file has 84");
    expect_bytes_refused(bytes, SQUARE_BYTES - 1,
                         "2 triangles take 184 bytes, but the file has 183");
    expect_bytes_refused(bytes, SQUARE_BYTES + 1,
                         "2 triangles take 184 bytes, but the file has 185");
    memcpy(bytes, "solid", 5);
    expect_bytes_refused(bytes, SQUARE_BYTES - 1,
                         "2 triangles take 184 bytes, but the file has 183");
    memset(bytes + 80, 0xFF, 4);
    expect_bytes_refused(bytes, SQUARE_BYTES, "4294967295 triangles take 214748364834 bytes, but");
    memset(bytes + 80, 0, 4);
    expect_bytes_refused(bytes, 84, "s.stl: has no triangle");
    make_binary("made", bytes);
    const uint32_t nan = 0x7FC00000u, inf = 0x7F800000u;
    memcpy(bytes + 84 + 12 + 16, &nan, 4);
    expect_bytes_refused(bytes, SQUARE_BYTES, "s.stl: byte 112: y is not a finite number");
    make_binary("made", bytes);
    memcpy(bytes + 84 + 50 + 12 + 32, &inf, 4);
    expect_bytes_refused(bytes, SQUARE_BYTES, "s.stl: byte 178: z is not a finite number");
}

static void expect_refused(const char *old, const char *new, const char *rule)
{
    const char *at = strstr(ascii, old);
    char text[sizeof ascii + 40];
    assert_non_null(at);
    int size =
        snprintf(text, sizeof text, "%.*s%s%s", (int)(at - ascii), ascii, new, at + strlen(old));
    expect_bytes_refused(text, (size_t)size, rule);
}

static void ascii_files_are_refused_by_line(void **state)
{
    (void)state;
    expect_refused("outer", "inner", "s.stl:3: 'outer' must stand here, not 'inner'");
    expect_refused("loop", "lop", "s.stl:3: 'loop' must stand here, not 'lop'");
    expect_refused("vertex 1 0 0", "vertex 1 0", "s.stl:6: z: 'vertex' is not a finite number");
    expect_refused("vertex 1 0 0", "vertex 1 nan 0", "s.stl:5: y: 'nan' is not a finite number");
    expect_refused("vertex 1 0 0", "vertex 1 1e39 0",
                   "s.stl:5: y: '1e39' is beyond the range of a");
    expect_refused("vertex 1 0 0", "vertx 1 0 0", "s.stl:5: 'vertex' must stand here, not 'vertx'");
    expect_refused(" endloop", "vertex 2 2 2 endloop",
                   "s.stl:7: 'endloop' must stand here, not 'vert");
    expect_refused("endfacet", "", "s.stl:9: 'endfacet' must stand here, not 'endsolid'");
    expect_refused("endsolid a square", "", "s.stl:11: 'endsolid' must stand here, not 'SOLID'");
    expect_refused("endsolid a square", "facets",
                   "s.stl:9: 'endsolid' must stand here, not 'facets'");
    expect_refused("EndSolid", "", "s.stl:15: 'endsolid' must stand here, not end of file");
    expect_refused("normal nan 0 0", "normal nan 0",
                   "s.stl:3: 'outer' must stand here, not 'loop'");
    expect_refused("EndSolid", "EndSolid x\nmore", "s.stl:16: 'solid' must stand here, not 'more'");
    expect_refused("solid a", "sold a", "(one in ASCII begins with \"solid\")");
    expect_bytes_refused("solid x\nendsolid x\n", 19, "s.stl: has no triangle");
    expect_bytes_refused("solid", 5, "s.stl:1: 'endsolid' must stand here, not end of file");
    /* Every beginning of the text is refused, but for the first solid alone. */
    const size_t first = (size_t)(strstr(ascii, "endsolid") - ascii) + strlen("endsolid");
    const size_t second = (size_t)(strstr(ascii, "SOLID") - ascii);
    for (size_t size = 0; size < strlen(ascii); size++) {
        struct scene scene;
        bool whole = read_bytes(ascii, size, &scene) == STATUS_OK;
        scene_free(&scene);
        assert_int_equal(whole, size >= first && size <= second);
    }
}

/* The triangles are the same, corner by corner, and read again they are written the same. */
static void what_is_written_is_read_to_the_bit(void **state)
{
    (void)state;
    static const char *const specs[] = {"sphere:n=5", "soup:n=300", "cornell:n=3", "grid:n=9"};
    for (size_t i = 0; i < ARRAY_COUNT(specs); i++) {
        struct scene scene, back;
        char *bytes = NULL, *again = NULL;
        size_t size, again_size;
        assert_int_equal(scene_open(specs[i], 1, &scene, &reason), STATUS_OK);
        FILE *stream = open_memstream(&bytes, &size);
        assert_non_null(stream);
        assert_int_equal(write_stl(&scene, stream, &reason), STATUS_OK);
        assert_int_equal(fclose(stream), 0);
        assert_int_equal(size, 84 + 50 * (size_t)scene.tri_count);
        assert_int_equal(read_bytes(bytes, size, &back), STATUS_OK);
        assert_int_equal(back.tri_count, scene.tri_count);
        for (uint32_t k = 0; k < scene.tri_count; k++) {
            float v[3][3], w[3][3];
            scene_tri(&scene, k, v);
            scene_tri(&back, k, w);
            assert_memory_equal(v, w, sizeof v);
        }
        stream = open_memstream(&again, &again_size);
        assert_non_null(stream);
        assert_int_equal(write_stl(&back, stream, &reason), STATUS_OK);
        assert_int_equal(fclose(stream), 0);
        assert_int_equal(again_size, size);
        assert_memory_equal(again, bytes, size);
        free(again);
        free(bytes);
        scene_free(&back);
        scene_free(&scene);
    }
}

/* A closed mesh stays one: its vertices are shared again. */
static void a_closed_mesh_stays_closed(void **state)
{
    (void)state;
    struct scene scene, back;
    struct topology topology;
    char *bytes = NULL;
    size_t size;
    assert_int_equal(scene_open("sphere:n=7", 1, &scene, &reason), STATUS_OK);
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    assert_int_equal(write_stl(&scene, stream, &reason), STATUS_OK);
    assert_int_equal(fclose(stream), 0);
    assert_int_equal(read_bytes(bytes, size, &back), STATUS_OK);
    assert_int_equal(back.vertex_count, scene.vertex_count);
    assert_int_equal(topology_make(&back, &topology, &reason), STATUS_OK);
    assert_int_equal(topology_is_closed(&topology, &back, &reason), STATUS_OK);
    topology_free(&topology);
    scene_free(&back);
    scene_free(&scene);
    free(bytes);
}

/* Of the writer: the header, unit normals along the winding, 0 0 0 without area, no attributes. */
static void normals_are_written_along_the_winding(void **state)
{
    (void)state;
    struct scene scene;
    char *bytes = NULL;
    size_t size;
    float normal[3];
    assert_int_equal(scene_make(3, 2, &scene), STATUS_OK);
    const float vertex[] = {0, 0, 0, 0, 3e38f, 0, 0, 0, 1e-38f};
    const uint32_t index[] = {0, 1, 2, 1, 1, 2};
    memcpy(scene.vertex, vertex, sizeof vertex);
    memcpy(scene.index, index, sizeof index);
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    assert_int_equal(write_stl(&scene, stream, &reason), STATUS_OK);
    assert_int_equal(fclose(stream), 0);
    assert_int_not_equal(strncmp(bytes, "solid", 5), 0);
    memcpy(normal, bytes + 84, 12);
    assert_true(normal[0] == 1 && normal[1] == 0 && normal[2] == 0);
    memcpy(normal, bytes + 134, 12);
    assert_true(normal[0] == 0 && normal[1] == 0 && normal[2] == 0);
    assert_true(bytes[132] == 0 && bytes[133] == 0);
    free(bytes);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(binary_and_ascii_are_the_same_mesh),
        cmocka_unit_test(zeros_of_both_signs_are_two_vertices),
        cmocka_unit_test(binary_files_are_refused_by_byte),
        cmocka_unit_test(ascii_files_are_refused_by_line),
        cmocka_unit_test(what_is_written_is_read_to_the_bit),
        cmocka_unit_test(a_closed_mesh_stays_closed),
        cmocka_unit_test(normals_are_written_along_the_winding),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
