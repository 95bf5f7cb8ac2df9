/* Readers hold nothing of what they read or refuse (tests/laws/in_use.h): of files of every
 * format, whole, cut anywhere, or with any byte changed. */
#define _GNU_SOURCE
#include "ref/packed/packed_file.h"
#include "ref/store.h"
#include "ref/tree/bvh_json.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#include "tests/laws/in_use.h"
#include "tests/laws/text_samples.h"

#define BYTES_MOST 8192

static struct {
    struct scene scene;
    struct bvh bvh;
    struct packed packed;
    FILE *nowhere;
} all;

/* --- formats with bytes of a scene ------------------------------------------------------------ */

static enum status reads_rtrs(const char *bytes, size_t size, FILE *stream, struct reason *reason)
{
    struct scene scene;
    return print_mesh(read_rtrs("f", bytes, size, &scene, reason), &scene, stream);
}

static enum status reads_packed(const char *bytes, size_t size, FILE *stream, struct reason *reason)
{
    struct packed packed;
    const enum status status =
        packed_file_read("f", bytes, size, &all.scene, &packed, NULL, reason);
    (void)stream;
    packed_free(&packed);
    return status;
}

static enum status reads_tree(const char *bytes, size_t size, FILE *stream, struct reason *reason)
{
    struct bvh bvh;
    const enum status status = bvh_json_read("f", bytes, size, &all.scene, &bvh, reason);
    (void)stream;
    if (!status)
        bvh_free(&bvh);
    return status;
}

static void write_packed(FILE *stream)
{
    packed_file_write(&all.packed, stream);
}

static void write_tree(FILE *stream)
{
    bvh_json_write(&all.bvh, stream);
}

static void write_as_rtrs(FILE *stream)
{
    assert_int_equal(write_rtrs(&all.scene, stream, NULL), STATUS_OK);
}

static void write_as_ply(FILE *stream)
{
    assert_int_equal(write_ply(&all.scene, stream, NULL), STATUS_OK);
}

static void write_as_stl(FILE *stream)
{
    assert_int_equal(write_stl(&all.scene, stream, NULL), STATUS_OK);
}

static const struct written {
    const char *what;
    reads_fn *reads;
    void (*write)(FILE *stream);
} written[] = {{"RTRS", reads_rtrs, write_as_rtrs},
               {"binary PLY", reads_ply, write_as_ply},
               {"binary STL", reads_stl, write_as_stl},
               {"packed tree", reads_packed, write_packed},
               {"JSON tree", reads_tree, write_tree}};

/* --- cycles ----------------------------------------------------------------------------------- */

struct freed_text {
    reads_fn *reads;
    char byte[BYTES_MOST];
    size_t size;
    size_t read, refused;
};

static void read_some(struct freed_text *b, size_t size, size_t changed, char to)
{
    char copy[BYTES_MOST];
    struct reason reason = {""};
    memcpy(copy, b->byte, size);
    copy[size] = '\0';
    if (changed < size)
        copy[changed] = to;
    *(b->reads(copy, size, all.nowhere, &reason) ? &b->refused : &b->read) += 1;
}

/* Whole, cut at each byte, and with each byte another. */
static void read_all(const void *what)
{
    struct freed_text *b = (struct freed_text *)(uintptr_t)what;
    static const char to[] = {'9', '-', ' ', '\n', 'x', '\0'};
    const size_t step = 1 + b->size / 700;
    for (size_t i = 0; i < b->size; i += step) {
        read_some(b, i, b->size, 0);
        read_some(b, b->size, i, to[i % sizeof to]);
    }
    read_some(b, b->size, b->size, 0);
}

static void must_free_all(const char *what, struct freed_text *b)
{
    must_hold_no_more(what, "reading it", read_all, b);
    assert_true(b->read > 0 && b->refused > 10);
}

static void texts_are_freed(void **state)
{
    (void)state;
    for (size_t s = 0; s < ARRAY_COUNT(samples); s++) {
        struct freed_text b = {.reads = samples[s].reads};
        for (const char *at = samples[s].text; *at; at++)
            if (*at != '|')
                b.byte[b.size++] = *at;
        must_free_all(samples[s].what, &b);
    }
}

static void files_are_freed(void **state)
{
    (void)state;
    for (size_t w = 0; w < ARRAY_COUNT(written); w++) {
        struct freed_text b = {.reads = written[w].reads};
        FILE *stream = fmemopen(b.byte, sizeof b.byte, "w");
        assert_non_null(stream);
        written[w].write(stream);
        const long size = ftell(stream);
        assert_int_equal(fclose(stream), 0);
        assert_in_range(size, 100, BYTES_MOST - 1);
        b.size = (size_t)size;
        must_free_all(written[w].what, &b);
    }
}

static int make_all(void **state)
{
    const struct build_options options = {.leaf = 2, .eps = BUILD_EPS_DEFAULT};
    (void)state;
    assert_int_equal(scene_open("soup:n=8", 1, &all.scene, NULL), STATUS_OK);
    assert_int_equal(builder_find("median")->build(&all.scene, &options, &all.bvh, NULL), 0);
    assert_int_equal(packed_make(layout_find("f32"), &all.bvh, &all.scene, &all.packed, NULL), 0);
    all.nowhere = fopen("/dev/null", "w");
    assert_non_null(all.nowhere);
    return 0;
}

static int free_all(void **state)
{
    (void)state;
    fclose(all.nowhere);
    packed_free(&all.packed);
    bvh_free(&all.bvh);
    scene_free(&all.scene);
    return 0;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_forgotten_is_seen),
        cmocka_unit_test(texts_are_freed),
        cmocka_unit_test(files_are_freed),
    };
    keep_nothing(argc, argv);
    return cmocka_run_group_tests_name("freed: texts", tests, make_all, free_all);
}
