#include "ref/base/rng.h"
#include "scenes/read/formats.h"
#include "ref/scene/mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* A file made piece by piece; numbers in either byte order. */
struct ply_bytes {
    char at[4096];
    size_t size;
    bool big;
};

static void add_text(struct ply_bytes *file, const char *text)
{
    memcpy(file->at + file->size, text, strlen(text));
    file->size += strlen(text);
}

static void add_word(struct ply_bytes *file, uint64_t word, size_t size)
{
    for (size_t i = 0; i < size; i++)
        file->at[file->size++] = (char)(word >> 8 * (file->big ? size - 1 - i : i));
}

static void add_float(struct ply_bytes *file, float x)
{
    add_word(file, float_bits(x), 4);
}

static void add_double(struct ply_bytes *file, double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    add_word(file, bits, 8);
}

/* Reads from memory of exactly this size, so that the sanitizer sees a step too far. */
static enum status read_bytes(const char *bytes, size_t size, struct scene *out)
{
    char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    reason.text[0] = '\0';
    enum status status = read_ply("m.ply", copy, size, out, &reason);
    free(copy);
    if (status == STATUS_OK) {
        assert_true(out->tri_count > 0);
        assert_int_equal(scene_check(out, NULL), STATUS_OK);
    } else {
        assert_null(out->vertex);
        assert_int_equal(strncmp(reason.text, "m.ply:", 6), 0);
        assert_null(strchr(reason.text, '\n'));
    }
    return status;
}

static void expect_refused_bytes(const struct ply_bytes *file, const char *rule)
{
    struct scene scene;
    enum status status = read_bytes(file->at, file->size, &scene);
    scene_free(&scene);
    assert_int_equal(status, STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
}

static void expect_refused(const char *text, const char *rule)
{
    struct ply_bytes file = {.size = 0};
    add_text(&file, text);
    expect_refused_bytes(&file, rule);
}

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

static const float square[] = {0, 0, 0, 0.1f, 0, -0.0f, 1, 1, 0, 0, 1e-3f, 2};
static const uint32_t fan[] = {0, 1, 2, 0, 2, 3, 3, 1, 0};

#define XYZ  "property float x\nproperty float y\nproperty float z\n"
#define FACE "property list uchar int vertex_indices\n"

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

/* The same mesh with every type of the standard somewhere, things to skip before, between and
 * behind, and elements in another order. */
static void add_mixed(struct ply_bytes *file)
{
    add_text(file, "element camera 1\nproperty double focus\nproperty list ushort short marks\n"
                   "element face 2\nproperty char flag\n"
                   "property list short ushort vertex_indices\nproperty list uint double w\n"
                   "element vertex 4\nproperty uchar red\nproperty double z\nproperty float x\n"
                   "property uint id\nproperty float32 y\n"
                   "element edge 1\nproperty int16 a\nproperty uint16 b\nend_header\n");
    add_double(file, 1.5);
    add_word(file, 2, 2);
    add_word(file, 0x0102, 2);
    add_word(file, 0x0304, 2);
    static const uint16_t polygon[2][5] = {{4, 0, 1, 2, 3}, {3, 3, 1, 0, 0}};
    for (int i = 0; i < 2; i++) {
        add_word(file, 0xFF, 1);
        for (int k = 0; k <= polygon[i][0]; k++)
            add_word(file, polygon[i][k], 2);
        add_word(file, (uint64_t)i, 4);
        for (int k = 0; k < i; k++)
            add_double(file, 0.25);
    }
    for (int i = 0; i < 4; i++) {
        add_word(file, 200, 1);
        add_double(file, (double)square[3 * i + 2]);
        add_float(file, square[3 * i]);
        add_word(file, 0xFFFFFFFF, 4);
        add_float(file, square[3 * i + 1]);
    }
    add_word(file, 0xFFFF, 2);
    add_word(file, 1, 2);
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

#define ASCII "ply\nformat ascii 1.0\n"

static void ply_names_line_and_rule_of_the_header(void **state)
{
    (void)state;
    expect_refused("plyx\n", ":1: a PLY file begins");
    expect_refused("ply", ":1: the header is cut short");
    expect_refused("ply\nelement vertex 1\n" XYZ "element face 1\n" FACE "end_header\n",
                   ":8: the header names no format");
    expect_refused("ply\nformat ascii 2.0\n", ":2: format must be");
    expect_refused("ply\nformat binary 1.0\n", ":2: format must be");
    expect_refused(ASCII "format ascii 1.0\n", ":3: the format is already given");
    expect_refused(ASCII "Created by x\n", ":3: 'Created' is no keyword");
    expect_refused(ASCII "element vertex\n", ":3: count of the element: end of line");
    expect_refused(ASCII "element vertex -1\n", ":3: an element cannot be there -1 times");
    expect_refused(ASCII "element vertex 3 4\n", ":3: '4' is too much");
    expect_refused(ASCII "element vertex 3\nelement vertex 3\n", ":4: an element of this name");
    expect_refused(ASCII "property float x\n", ":3: a property needs an element");
    expect_refused(ASCII "element vertex 3\nproperty half x\n", ":4: 'half' is no type");
    expect_refused(ASCII "element vertex 3\nproperty float\n", ":4: the name of the property");
    expect_refused(ASCII "element vertex 3\nproperty float x\nproperty int x\n",
                   ":5: a property of this name");
    expect_refused(ASCII "element face 3\nproperty list float int vertex_indices\n",
                   ":4: the length of a list must be of a whole type");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n"
                         "property list uchar float vertex_indices\nend_header\n",
                   ":9: vertex indices must be of a whole type");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n"
                         "property int vertex_indices\nend_header\n",
                   ":9: property vertex_indices must be a list");
    expect_refused(ASCII "element vertex 3\nproperty list uchar float x\nelement face 1\n" FACE
                         "end_header\n",
                   ":7: property x must not be a list");
    expect_refused(ASCII
                   "element vertex 3\nproperty float x\nproperty float y\nelement face 1\n" FACE
                   "end_header\n",
                   ":8: an element vertex with properties x, y, z is needed");
    expect_refused(ASCII "element vertex 3\n" XYZ "end_header\n", ":7: an element face");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n" FACE
                         "property list uchar int vertex_index\nend_header\n",
                   ":10: an element face with one list");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n" FACE
                         "element none 9999999\nend_header\n",
                   ":10: element none has no property");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n" FACE "end_header",
                   "a line end must follow end_header");
}

#define TWO ASCII "element vertex 3\n" XYZ "element face 1\n" FACE "end_header\n"

static void ply_names_line_and_rule_of_ascii_data(void **state)
{
    (void)state;
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
                   ":13: vertex index 3, but there are 3 vertices");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n", ":13: vertex index -1");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ":13: vertex index: end of line");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 2\n", ":13: '2' is more than");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n2 0 1\n", ":13: face with 2 corners");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n-3 0 1\n", ":13: a list of -3 values");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n1000000 0 1\n", "more than 65536 corners");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 nan\n3 0 1 2\n", ":12: z: 'nan' is not");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 1e99\n3 0 1 2\n", ":12: z: '1e99' is beyond");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1\n3 0 1 2\n", ":12: z: end of line");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n", "the data are cut short");
    expect_refused(TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 2 1 0\n",
                   ":13: 9 bytes follow the last element");
    expect_refused(ASCII "element vertex 4000000000\n" XYZ "element face 1\n" FACE
                         "end_header\n0 0 0\n",
                   "4000000000 elements of at least 6 bytes do not fit into the 7 bytes left");
    expect_refused(ASCII "element vertex 0\n" XYZ "element face 0\n" FACE "end_header\n",
                   "has no triangle (0 vertices)");
}

#define BINARY "ply\nformat binary_little_endian 1.0\n"

static void ply_names_byte_and_rule_of_binary_data(void **state)
{
    (void)state;
    static const char header[] =
        BINARY "element vertex 3\n" XYZ "element face 1\n" FACE "end_header\n";
    static const struct {
        uint32_t x, corners, index; /* x as bits */
        const char *rule;
    } bad[] = {
        {0, 3, 3, "byte 214: vertex index 3, but there are 3 vertices"},
        {0, 3, 0xFFFFFFFF, "byte 214: vertex index -1"},
        {0, 2, 0, "byte 205: face with 2 corners"},
        {0, 4, 2, "the data are cut short"},
        {0x7FC00000, 3, 2, "byte 169: x is not a finite"},
        {0xFF800000, 3, 2, "byte 169: x is not a finite"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct ply_bytes file = {.size = 0};
        add_text(&file, header);
        assert_int_equal(file.size, 169);
        for (int k = 0; k < 9; k++)
            add_word(&file, k ? 0x3F800000 : bad[i].x, 4);
        add_word(&file, bad[i].corners, 1);
        add_word(&file, 0, 4);
        add_word(&file, 1, 4);
        add_word(&file, bad[i].index, 4);
        expect_refused_bytes(&file, bad[i].rule);
    }
    struct ply_bytes file = {.size = 0};
    add_text(&file,
             BINARY "element vertex 99999999999\n" XYZ "element face 1\n" FACE "end_header\nabc");
    expect_refused_bytes(&file, "99999999999 elements of at least 12 bytes do not fit into the 3");
    struct ply_bytes large = {.size = 0};
    add_text(&large, BINARY "element vertex 1\nproperty double x\nproperty float y\n"
                            "property float z\nelement face 1\n" FACE "end_header\n");
    add_double(&large, 3.4028235677973366e38); /* halfway to 2^128 */
    add_float(&large, 0);
    add_float(&large, 0);
    add_word(&large, 0, 4);
    expect_refused_bytes(&large, "x is not a finite 32-bit float");
}

static void ply_refuses_endless_headers_fast(void **state)
{
    (void)state;
    static const struct {
        const char *line, *rule;
    } endless[] = {{"element %07zu 1\n", ":259: more than 256 elements"},
                   {"property int %07zu\n", ":4100: more than 4096 properties"}};
    enum { COUNT = 200000, LINE = 32 };
    char *text = malloc(64 + COUNT * LINE);
    assert_non_null(text);
    for (size_t k = 0; k < 2; k++) {
        size_t size = (size_t)sprintf(text, ASCII "%s", k ? "element x 1\n" : "");
        for (size_t i = 0; i < COUNT; i++)
            size += (size_t)snprintf(text + size, LINE, endless[k].line, i);
        struct scene scene;
        assert_int_equal(read_bytes(text, size, &scene), STATUS_INPUT);
        assert_non_null(strstr(reason.text, endless[k].rule));
    }
    free(text);
}

static void survive(const struct ply_bytes *file)
{
    uint32_t read = 0;
    for (size_t size = 0; size <= file->size; size++) {
        struct scene scene;
        read += read_bytes(file->at, size, &scene) == STATUS_OK;
        scene_free(&scene);
    }
    assert_true(read >= 1 && read < 4); /* whole, and without the last line end */
    struct ply_bytes damaged = *file;
    for (size_t i = 0; i < file->size; i++) {
        for (int bit = 0; bit < 10; bit++) {
            int byte = bit == 8 ? 0 : bit == 9 ? 0xFF : file->at[i] ^ 1 << bit;
            damaged.at[i] = (char)byte;
            struct scene scene;
            enum status status = read_bytes(damaged.at, damaged.size, &scene);
            assert_true(status == STATUS_OK || status == STATUS_INPUT);
            scene_free(&scene);
        }
        damaged.at[i] = file->at[i];
    }
}

static void ply_survives_every_prefix_and_damaged_byte(void **state)
{
    (void)state;
    struct ply_bytes ascii = {.size = 0};
    add_text(&ascii, TWO "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    survive(&ascii);
    struct ply_bytes little = {.size = 0};
    add_text(&little, "ply\nformat binary_little_endian 1.0\n");
    add_mixed(&little);
    survive(&little);
    struct ply_bytes big = {.big = true};
    add_text(&big, "ply\nformat binary_big_endian 1.0\n");
    add_mixed(&big);
    survive(&big);
}

static void ply_survives_noise_behind_a_header(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 0);
    for (int run = 0; run < 2000; run++) {
        struct ply_bytes file = {.size = 0};
        add_text(&file, run % 2 ? BINARY : ASCII);
        add_text(&file, "element face 2\n" FACE "element vertex 2\n" XYZ "end_header\n");
        while (file.size < 300)
            add_word(&file, rng_u64(&rng) & (run % 3 ? 0x0302010003020100 : UINT64_MAX), 8);
        struct scene scene;
        assert_int_equal(read_bytes(file.at, file.size, &scene), STATUS_INPUT);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ply_reads_ascii),
        cmocka_unit_test(ply_reads_binary_of_both_orders),
        cmocka_unit_test(ply_reads_every_scalar_type),
        cmocka_unit_test(ply_of_bare_returns_keeps_a_newline_in_the_data),
        cmocka_unit_test(ply_names_line_and_rule_of_the_header),
        cmocka_unit_test(ply_names_line_and_rule_of_ascii_data),
        cmocka_unit_test(ply_names_byte_and_rule_of_binary_data),
        cmocka_unit_test(ply_refuses_endless_headers_fast),
        cmocka_unit_test(ply_survives_every_prefix_and_damaged_byte),
        cmocka_unit_test(ply_survives_noise_behind_a_header),
    };
    return cmocka_run_group_tests_name("read_ply", tests, NULL, NULL);
}
