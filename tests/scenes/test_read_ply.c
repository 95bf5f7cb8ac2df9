#include "tests/scenes/ply_fixture.h"

static void expect_triangles(const struct ply_bytes *file, const float *vertex,
                             uint32_t vertex_count, const uint32_t *index, uint32_t tri_count)
{
    struct scene scene;
    enum status status = read_bytes(file->at, file->size, &scene);
    if (status != STATUS_OK)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(scene.vertex_count, vertex_count);
    assert_int_equal(scene.tri_count, tri_count);
    assert_memory_equal(scene.vertex, vertex, 3 * vertex_count * sizeof *vertex);
    assert_memory_equal(scene.index, index, 3 * tri_count * sizeof *index);
    assert_null(scene.normal);
    scene_free(&scene);
}

static void ply_reads_ascii(void **state)
{
    (void)state;
    struct ply_bytes file = {.size = 0};
    add_text(&file, "ply\nformat ascii 1.0\ncomment by hand\nobj_info x\nelement vertex 4\n" XYZ
                    "element face 2\n" FACE "end_header\n"
                    "0 0 0\n0.1 0 -0\n\n1 1 0 \n 0 .001 2\n4 0 1 2 3\n3 3 1 0\n \n");
    expect_triangles(&file, square, 4, fan, 3);
    struct ply_bytes windows = {.size = 0};
    add_text(&windows, "ply\r\nformat ascii 1.0  \r\nelement vertex 4\r\n"
                       "property float32 x\r\nproperty float64 y\r\nproperty float z\r\n"
                       "element face 2\r\nproperty list uint8 uint32 vertex_index\r\n"
                       "end_header\r\n0 0 0\r\n0.1 0 -0\r\n1 1 0\r\n0 .001 2\r\n4 0 1 2 3\r\n"
                       "3 3 1 0");
    expect_triangles(&windows, square, 4, fan, 3);
}

static void ply_reads_binary_of_both_orders(void **state)
{
    (void)state;
    struct ply_bytes little = {.big = false};
    add_text(&little, "ply\nformat binary_little_endian 1.0\n");
    add_mixed(&little);
    expect_triangles(&little, square, 4, fan, 3);
    struct ply_bytes big = {.big = true};
    add_text(&big, "ply\nformat binary_big_endian 1.0\n");
    add_mixed(&big);
    expect_triangles(&big, square, 4, fan, 3);
    add_text(&big, "\n \r\n");
    expect_triangles(&big, square, 4, fan, 3);
    add_word(&big, 0, 1);
    expect_refused_bytes(&big, "bytes follow the last element");
}

/* Coordinates and indices of every type, signed ones with their sign. */
static void ply_reads_every_scalar_type(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        size_t size;
        bool is_signed;
    } types[] = {{"char", 1, true},    {"uchar", 1, false}, {"short", 2, true},
                 {"ushort", 2, false}, {"int", 4, true},    {"uint", 4, false},
                 {"int8", 1, true},    {"uint8", 1, false}, {"int16", 2, true},
                 {"uint16", 2, false}, {"int32", 4, true},  {"uint32", 4, false}};
    static const uint32_t index[] = {0, 1, 2};
    for (size_t t = 0; t < ARRAY_COUNT(types); t++) {
        for (int big = 0; big < 2; big++) {
            struct ply_bytes file = {.big = big};
            char header[400];
            const char *n = types[t].name;
            snprintf(header, sizeof header,
                     "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty %s x\n"
                     "property %s y\nproperty %s z\nelement face 1\n"
                     "property list %s %s vertex_indices\nend_header\n",
                     big ? "big" : "little", n, n, n, n, n);
            add_text(&file, header);
            uint64_t highest = (UINT64_C(1) << (8 * types[t].size)) - 1;
            for (uint64_t i = 0; i < 9; i++)
                add_word(&file, i == 4 ? highest : i, types[t].size);
            add_word(&file, 3, types[t].size);
            for (uint64_t i = 0; i < 3; i++)
                add_word(&file, i, types[t].size);
            float want[9];
            for (int i = 0; i < 9; i++)
                want[i] = (float)i;
            want[4] = types[t].is_signed ? -1.0f : (float)highest;
            expect_triangles(&file, want, 3, index, 1);
        }
    }
}

static void ply_of_bare_returns_keeps_a_newline_in_the_data(void **state)
{
    (void)state;
    struct ply_bytes file = {.size = 0};
    add_text(&file, "ply\rformat binary_little_endian 1.0\relement vertex 3\rproperty uchar x\r"
                    "property uchar y\rproperty uchar z\relement face 1\r"
                    "property list uchar uchar vertex_indices\rend_header\r");
    static const float want[] = {10, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t index[] = {0, 1, 2};
    for (int i = 0; i < 9; i++)
        add_word(&file, (uint64_t)want[i], 1);
    add_text(&file, "\3");
    for (uint64_t i = 0; i < 3; i++)
        add_word(&file, i, 1);
    expect_triangles(&file, want, 3, index, 1);
}

/* Properties of an element that is neither vertex nor face, some named as theirs are. */
static const char *const other_names[] = {"x",     "y",   "z", "vertex_indices", "vertex_index",
                                          "green", "red", "w"};

/* A square and its faces, and an element `edge` with each of these names before, between or behind
 * them: names belong to their element alone. */
static void ply_names_belong_to_their_element(void **state)
{
    (void)state;
    static const float vertex[] = {0, 0, 0, 1, 0, 0, 1, 1, 0};
    static const uint32_t index[] = {0, 1, 2};
    for (int place = 0; place < 3; place++)
        for (int list = 0; list < 2; list++) {
            struct ply_bytes file = {.size = 0};
            add_text(&file, "ply\nformat ascii 1.0\n");
            for (int e = 0; e < 3; e++) {
                if (e == place) {
                    add_text(&file, "element edge 2\n");
                    for (size_t n = 0; n < ARRAY_COUNT(other_names); n++) {
                        add_text(&file, list ? "property list uchar int " : "property int ");
                        add_text(&file, other_names[n]);
                        add_text(&file, "\n");
                    }
                } else if (e == (place == 0 ? 1 : 0)) {
                    add_text(&file, "element vertex 3\nproperty float red\n" XYZ
                                    "property float vertex_indices\n");
                } else {
                    add_text(&file, "element face 1\nproperty float x\n" FACE
                                    "property list uchar float red\n");
                }
            }
            add_text(&file, "end_header\n");
            for (int e = 0; e < 3; e++) {
                for (int k = 0; k < 2 && e == place; k++)
                    add_text(&file, list ? "1 9 1 9 1 9 0 0 2 9 9 0 1 9\n" : "9 9 9 9 9 9 9 9\n");
                if (e == (place == 0 ? 1 : 0))
                    add_text(&file, "7 0 0 0 7\n7 1 0 0 7\n7 1 1 0 7\n");
                else if (e != place)
                    add_text(&file, "7 3 0 1 2 2 7 7\n");
            }
            expect_triangles(&file, vertex, 3, index, 1);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ply_reads_ascii),
        cmocka_unit_test(ply_reads_binary_of_both_orders),
        cmocka_unit_test(ply_reads_every_scalar_type),
        cmocka_unit_test(ply_of_bare_returns_keeps_a_newline_in_the_data),
        cmocka_unit_test(ply_names_belong_to_their_element),
    };
    return cmocka_run_group_tests_name("read_ply", tests, NULL, NULL);
}
