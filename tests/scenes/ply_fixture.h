/* What test_read_ply.c and test_read_ply_bad.c share; includes cmocka.h. */
#ifndef PLY_FIXTURE_H
#define PLY_FIXTURE_H

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

static const float square[] = {0, 0, 0, 0.1f, 0, -0.0f, 1, 1, 0, 0, 1e-3f, 2};
static const uint32_t fan[] = {0, 1, 2, 0, 2, 3, 3, 1, 0};

#define XYZ  "property float x\nproperty float y\nproperty float z\n"
#define FACE "property list uchar int vertex_indices\n"

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

#endif
