/* PLY files that are refused, with line or byte and rule, and quickly. */
#include "tests/scenes/ply_fixture.h"

static void expect_refused(const char *text, const char *rule)
{
    struct ply_bytes file = {.size = 0};
    add_text(&file, text);
    expect_refused_bytes(&file, rule);
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
    expect_refused(ASCII "element vertex -1\n", ":3: the count of an element cannot be -1");
    expect_refused(ASCII "element vertex 3 4\n", ":3: '4' is too much");
    expect_refused(ASCII "element vertex 3\nelement vertex 3\n", ":4: an element of this name");
    expect_refused(ASCII "property float x\n", ":3: a property needs an element");
    expect_refused(ASCII "element vertex 3\nproperty half x\n", ":4: 'half' is no type");
    expect_refused(ASCII "element vertex 3\nproperty float\n", ":4: the name of the property");
    expect_refused(ASCII "element vertex 3\nproperty float x\nproperty int x\n",
                   ":5: a property of this name");
    expect_refused(ASCII "element face 3\nproperty list float int vertex_indices\n",
                   ":4: the length of a list must have an integer type");
    expect_refused(ASCII "element vertex 3\n" XYZ "element face 1\n"
                         "property list uchar float vertex_indices\nend_header\n",
                   ":9: vertex indices must have an integer type");
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

/* Each property of each element named as each one before it, and each element, is refused on its
 * own line. */
static void ply_refuses_names_given_twice(void **state)
{
    (void)state;
    enum { ELEMENTS = 3, PROPERTIES = 4 };
    for (int element = 0; element < ELEMENTS; element++)
        for (int second = 0; second < PROPERTIES; second++)
            for (int first = 0; first < second + (second == 0); first++) {
                char text[600] = ASCII, rule[80];
                int line = 2, refused = 0;
                for (int e = 0; e < ELEMENTS; e++) {
                    size_t at = strlen(text);
                    bool again = second == 0 && e > 0 && e == element; /* the element's own name */
                    (void)snprintf(text + at, sizeof text - at, "element e%d 1\n",
                                   again ? e - 1 : e);
                    line++;
                    refused = again ? line : refused;
                    for (int p = 0; p < PROPERTIES; p++) {
                        bool twice = second > 0 && e == element && p == second;
                        at = strlen(text);
                        (void)snprintf(text + at, sizeof text - at, "property %s p%d\n",
                                       p % 2 ? "list uchar int" : "int", twice ? first : p);
                        line++;
                        refused = twice ? line : refused;
                    }
                }
                (void)snprintf(rule, sizeof rule,
                               second > 0 ? ":%d: a property of this name is already there"
                                          : ":%d: an element of this name is already there",
                               refused);
                if (refused)
                    expect_refused(text, rule);
            }
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
                   "4000000000 elements of at least 6 bytes do not fit into the 6 bytes left");
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

/* At both sides of each border, with the file's numbers. */
static void ply_refuses_corners_beyond_the_vertices(void **state)
{
    (void)state;
    for (int vertices = 3; vertices < 6; vertices++)
        for (int corner = 0; corner < 3; corner++)
            for (int index = -2; index < vertices + 2; index++) {
                struct ply_bytes file = {.size = 0};
                struct scene scene;
                char line[100], rule[100];
                int used[3] = {0, 1, 2};
                used[corner] = index;
                (void)snprintf(line, sizeof line, ASCII "element vertex %d\n", vertices);
                add_text(&file, line);
                add_text(&file, XYZ "element face 2\n" FACE "end_header\n");
                for (int i = 0; i < vertices; i++)
                    add_text(&file, i % 2 ? "1 0 0\n" : "0 1 0\n");
                (void)snprintf(line, sizeof line, "3 0 1 2\n3 %d %d %d\n", used[0], used[1],
                               used[2]);
                add_text(&file, line);
                (void)snprintf(rule, sizeof rule,
                               "m.ply:%d: vertex index %d, but there are %d vertices",
                               11 + vertices, index, vertices);
                if (index < 0 || index >= vertices) {
                    expect_refused_bytes(&file, rule);
                    continue;
                }
                assert_int_equal(read_bytes(file.at, file.size, &scene), STATUS_OK);
                scene_free(&scene);
            }
}

static void ply_refuses_faces_by_their_corners(void **state)
{
    (void)state;
    static const int counts[] = {-7, -1, 0, 1, 2, 3, 4, 65535, 65536, 65537, 1000000};
    enum { ROOM = 200000 };
    char *text = malloc(ROOM);
    assert_non_null(text);
    for (size_t k = 0; k < ARRAY_COUNT(counts); k++) {
        struct scene scene;
        char rule[100] = "";
        size_t size = (size_t)snprintf(text, ROOM, TWO "0 0 0\n1 0 0\n0 1 0\n%d", counts[k]);
        for (int i = 0; i < counts[k] && i < 65540; i++) {
            text[size++] = ' ';
            text[size++] = (char)('0' + i % 3);
        }
        text[size++] = '\n';
        if (counts[k] < 0)
            (void)snprintf(rule, sizeof rule, "m.ply:13: a list of %d values", counts[k]);
        else if (counts[k] < 3)
            (void)snprintf(rule, sizeof rule,
                           "m.ply:13: face with %d corners; at least 3 are needed", counts[k]);
        else if (counts[k] > 65536)
            (void)snprintf(rule, sizeof rule, "m.ply:13: polygon with more than 65536 corners");
        assert_int_equal(read_bytes(text, size, &scene), rule[0] ? STATUS_INPUT : STATUS_OK);
        assert_string_equal(reason.text, rule);
        if (!rule[0])
            assert_int_equal(scene.tri_count, counts[k] - 2);
        scene_free(&scene);
    }
    free(text);
}

/* A binary file cut behind each byte of its data, and with bytes behind its end. */
static void ply_counts_the_bytes_left(void **state)
{
    (void)state;
    struct ply_bytes file = {.size = 0};
    struct scene scene;
    add_text(&file, BINARY "element vertex 4\n" XYZ "element face 2\n" FACE "end_header\n");
    size_t data = file.size;
    for (int i = 0; i < 12; i++)
        add_float(&file, square[i]);
    for (uint64_t f = 0; f < 2; f++) {
        add_word(&file, 3, 1);
        for (uint64_t c = 0; c < 3; c++)
            add_word(&file, (c + f) % 4, 4);
    }
    size_t whole = file.size - data;
    assert_int_equal(whole, 48 + 26);
    for (size_t left = 0; left < whole + 5; left++) {
        char rule[100] = "the data are cut short";
        struct ply_bytes cut = file;
        cut.size = data + left;
        if (left < 48)
            (void)snprintf(rule, sizeof rule,
                           ": 4 elements of at least 12 bytes do not fit into the %zu bytes left",
                           left);
        else if (left < 50)
            (void)snprintf(rule, sizeof rule,
                           ": 2 elements of at least 1 bytes do not fit into the %zu bytes left",
                           left - 48);
        else if (left > whole)
            (void)snprintf(rule, sizeof rule, ": %zu bytes follow the last element", left - whole);
        memset(cut.at + data + whole, 'x', 5);
        if (left != whole) {
            expect_refused_bytes(&cut, rule);
            continue;
        }
        assert_int_equal(read_bytes(cut.at, cut.size, &scene), STATUS_OK);
        scene_free(&scene);
    }
}

/* As many elements and properties as there may be. */
static void ply_reads_the_longest_headers(void **state)
{
    (void)state;
    enum { LINE = 32, ELEMENTS = 256, PROPERTIES = 4096 };
    char *text = malloc(400 + LINE * PROPERTIES);
    struct scene scene;
    assert_non_null(text);
    for (int k = 0; k < 2; k++) {
        size_t size = (size_t)sprintf(text, ASCII "element vertex 3\n" XYZ);
        for (int i = 2; i < ELEMENTS && k == 0; i++)
            size += (size_t)sprintf(text + size, "element e%d 0\nproperty int n\n", i);
        if (k == 1)
            size += (size_t)sprintf(text + size, "element many 0\n");
        for (int i = 4; i < PROPERTIES && k == 1; i++)
            size += (size_t)sprintf(text + size, "property int n%d\n", i);
        size += (size_t)sprintf(text + size, "element face 1\n" FACE
                                             "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
        if (read_bytes(text, size, &scene))
            fail_msg("%s", reason.text);
        scene_free(&scene);
    }
    free(text);
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
        cmocka_unit_test(ply_names_line_and_rule_of_the_header),
        cmocka_unit_test(ply_refuses_names_given_twice),
        cmocka_unit_test(ply_names_line_and_rule_of_ascii_data),
        cmocka_unit_test(ply_names_byte_and_rule_of_binary_data),
        cmocka_unit_test(ply_refuses_corners_beyond_the_vertices),
        cmocka_unit_test(ply_refuses_faces_by_their_corners),
        cmocka_unit_test(ply_counts_the_bytes_left),
        cmocka_unit_test(ply_reads_the_longest_headers),
        cmocka_unit_test(ply_refuses_endless_headers_fast),
        cmocka_unit_test(ply_survives_every_prefix_and_damaged_byte),
        cmocka_unit_test(ply_survives_noise_behind_a_header),
    };
    return cmocka_run_group_tests_name("read_ply_bad", tests, NULL, NULL);
}
