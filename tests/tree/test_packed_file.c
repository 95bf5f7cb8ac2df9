/* Laws of ref/packed/packed_file.h: what is written reads back to the byte and traces alike;
 * whatever is changed in it is refused, counted as a fault, or still safe to trace; nothing leads
 * out of it. */
#define _POSIX_C_SOURCE 200809L
#include "ref/packed/packed_file.h"
#include "ref/base/rng.h"
#include "ref/trace/trace.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define HEAD 48 /* bytes before the records */

static struct scene scene;
static struct reason reason;

/* A tree of the scene in the file's form; the caller frees it. */
static char *file_of(const struct layout *layout, size_t *size)
{
    const struct build_options build = {.leaf = 2, .eps = 0.02f};
    struct bvh bvh;
    struct packed packed;
    char *bytes = NULL;
    assert_int_equal(builder_find("median")->build(&scene, &build, &bvh, &reason), STATUS_OK);
    assert_int_equal(packed_make(layout, &bvh, &scene, &packed, &reason), STATUS_OK);
    FILE *stream = open_memstream(&bytes, size);
    assert_non_null(stream);
    packed_file_write(&packed, stream);
    assert_int_equal(fclose(stream), 0);
    packed_free(&packed);
    bvh_free(&bvh);
    return bytes;
}

static enum status read_it(const char *bytes, size_t size, struct packed *out,
                           struct packed_faults *faults)
{
    return packed_file_read("file", bytes, size, &scene, out, faults, &reason);
}

/* Every ray must end, with a triangle of the scene or none. Returns how many hit. */
static size_t trace_all(const struct packed *packed)
{
    size_t hits = 0;
    for (int i = 0; i < 50; i++) {
        struct rng rng = rng_make(3, (uint64_t)i);
        struct ray ray = {.tmax = 1e30f};
        struct hit hit;
        for (int k = 0; k < 3; k++) {
            ray.org[k] = rng_range(&rng, -2, 2);
            ray.dir[k] = rng_range(&rng, -0.2f, 0.2f) - ray.org[k];
        }
        assert_int_equal(trace_ray(&(struct job){.scene = &scene,
                                                 .packed = packed,
                                                 .box = box_tests[0],
                                                 .tri = tri_tests[0],
                                                 .query = QUERY_CLOSEST},
                                   &ray, &hit, NULL),
                         STATUS_OK);
        assert_true(hit.prim == ABI_NO_PRIM || hit.prim < scene.tri_count);
        hits += hit.prim != ABI_NO_PRIM;
    }
    return hits;
}

static void what_is_written_reads_back(void **state)
{
    (void)state;
    for (size_t l = 0; layouts[l]; l++) {
        size_t size, again_size;
        char *bytes = file_of(layouts[l], &size), *again = NULL;
        struct packed packed;
        struct packed_faults faults;
        enum status status = read_it(bytes, size, &packed, &faults);
        if (status && !layouts[l]->faithful)
            fail_msg("%s: %s", layouts[l]->name, reason.text);
        if (!status) {
            FILE *stream = open_memstream(&again, &again_size);
            assert_non_null(stream);
            packed_file_write(&packed, stream);
            assert_int_equal(fclose(stream), 0);
            assert_int_equal(again_size, size);
            assert_memory_equal(again, bytes, size);
            assert_true(trace_all(&packed) > 10);
            free(again);
        }
        if (!layouts[l]->faithful)
            assert_string_equal(reason.text, "");
        packed_free(&packed);
        free(bytes);
    }
}

/* Puts a word into a copy, reads it, and expects a reason with `rule`, which is all of it if
 * it begins with the file's name; NULL: that it is taken. */
static void expect_word(const char *bytes, size_t size, size_t at, uint32_t word, const char *rule)
{
    struct packed packed;
    char *copy = malloc(size);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    memcpy(copy + at, &word, 4);
    enum status status = read_it(copy, size, &packed, NULL);
    assert_int_equal(status, rule ? STATUS_INPUT : STATUS_OK);
    bool whole = rule && strncmp(rule, "file: ", 6) == 0;
    if (rule && (whole ? strcmp(reason.text, rule) != 0 : !strstr(reason.text, rule)))
        fail_msg("'%s' is not in '%s'", rule, reason.text);
    if (rule)
        assert_null(packed.word);
    packed_free(&packed);
    free(copy);
}

/* As expect_word; the text has the numbers of the file. */
static void expect_text(const char *bytes, size_t size, size_t at, uint32_t word,
                        const char *format, ...) PRINTF_LIKE(5, 6);

static void expect_text(const char *bytes, size_t size, size_t at, uint32_t word,
                        const char *format, ...)
{
    char text[200];
    va_list args;
    va_start(args, format);
    (void)vsnprintf(text, sizeof text, format, args);
    va_end(args);
    expect_word(bytes, size, at, word, text);
}

static void a_wrong_head_is_refused(void **state)
{
    (void)state;
    size_t size;
    char *bytes = file_of(layout_find("f32"), &size);
    uint32_t count[2]; /* records, items */
    memcpy(count, bytes + 28, sizeof count);
    assert_true(size == HEAD + 32 * (size_t)count[0] + 4 * (size_t)count[1]);
    expect_word(bytes, size, 0, 0, "'RDPK'");
    expect_word(bytes, size, 4, 2, "file: version 2; this program reads 1");
    expect_word(bytes, size, 8, 0x00363166, "file: names no layout (raydiff list layouts)");
    expect_word(bytes, size, 20, 1, "names no layout");
    expect_word(bytes, size, 24, 16, "file: records of 16 bytes, those of f32 have 32");
    static const uint32_t beside[] = {1, 17, 1000};
    for (size_t i = 0; i < ARRAY_COUNT(beside); i++) {
        uint32_t more = beside[i];
        expect_text(bytes, size, 28, count[0] + more,
                    "file: %u records and %u items are %zu bytes, not %zu", count[0] + more,
                    count[1], size + 32 * (size_t)more, size);
        expect_text(bytes, size, 32, count[1] + more,
                    "file: %u records and %u items are %zu bytes, not %zu", count[0],
                    count[1] + more, size + 4 * (size_t)more, size);
        expect_text(bytes, size, 40, scene.tri_count + more,
                    "file: is of %u triangles, the scene has %u", scene.tri_count + more,
                    scene.tri_count);
        expect_text(bytes, size, 44, ABI_STACK_MAX + more,
                    "file: needs %u stack entries, at most %u are possible", ABI_STACK_MAX + more,
                    ABI_STACK_MAX);
    }
    expect_text(bytes, size, 28, UINT32_MAX,
                "file: %u records and %u items are %llu bytes, not %zu", UINT32_MAX, count[1],
                HEAD + 32ull * UINT32_MAX + 4ull * count[1], size);
    expect_text(bytes, size, 32, UINT32_MAX,
                "file: %u records and %u items are %llu bytes, not %zu", count[0], UINT32_MAX,
                HEAD + 32ull * count[0] + 4ull * UINT32_MAX, size);
    expect_word(bytes, size, 36, UINT32_MAX, "outside");
    expect_word(bytes, size, 44, 0, "the packed tree says 0");
    expect_word(bytes, size, 44, ABI_STACK_MAX, NULL);
    for (size_t cut = 0; cut < size; cut += cut < HEAD ? 1 : 13) {
        struct packed packed;
        assert_int_equal(read_it(bytes, cut, &packed, NULL), STATUS_INPUT);
    }
    free(bytes);
}

static void unsafe_trees_are_refused_and_wrong_ones_are_counted(void **state)
{
    (void)state;
    const size_t root_snd = HEAD + 12, root_lo = HEAD;
    size_t size;
    char *bytes = file_of(layout_find("f32"), &size);
    uint32_t records, last = scene.tri_count - 1;
    memcpy(&records, bytes + 28, 4);
    const size_t first_item = HEAD + 32 * (size_t)records;
    expect_word(bytes, size, root_snd, 0, "reached more than once");
    expect_word(bytes, size, root_snd, 1, "reached more than once");
    expect_word(bytes, size, root_snd, records, "outside the");
    expect_word(bytes, size, HEAD + 28, UINT32_MAX, ""); /* the root is a leaf of so many items */
    expect_word(bytes, size, first_item, last + 1, "item slot 0 names triangle");
    expect_word(bytes, size, first_item, last, NULL); /* twice, and another one lost */
    assert_non_null(strstr(reason.text, "file: f32: "));
    expect_word(bytes, size, root_lo + 32, 0x7F800000, NULL); /* a box that holds nothing */
    assert_non_null(strstr(reason.text, "do not contain"));
    free(bytes);
}

/* Random damage of the records of every layout: most is noticed, what is not is safe. */
static void damaged_trees_are_refused_or_safe(void **state)
{
    (void)state;
    size_t refused = 0, faulty = 0, sound = 0;
    for (size_t l = 0; layouts[l]; l++) {
        size_t size;
        char *bytes = file_of(layouts[l], &size);
        for (uint64_t i = 0; i < 3000; i++) {
            struct rng rng = rng_make(i, l);
            struct packed packed;
            char *copy = malloc(size);
            assert_non_null(copy);
            memcpy(copy, bytes, size);
            for (uint32_t n = 1 + rng_below(&rng, 3); n > 0; n--)
                copy[HEAD + rng_below(&rng, (uint32_t)size - HEAD)] ^=
                    (char)(1u << rng_below(&rng, 8));
            if (read_it(copy, size, &packed, NULL)) {
                assert_null(packed.word);
                refused++;
            } else {
                trace_all(&packed);
                faulty += reason.text[0] != '\0';
                sound += reason.text[0] == '\0';
            }
            packed_free(&packed);
            free(copy);
        }
        free(bytes);
    }
    printf("%zu refused, %zu faulty, %zu sound\n", refused, faulty, sound);
    assert_true(refused > 1000 && faulty > 1000 && sound > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_reads_back),
        cmocka_unit_test(a_wrong_head_is_refused),
        cmocka_unit_test(unsafe_trees_are_refused_and_wrong_ones_are_counted),
        cmocka_unit_test(damaged_trees_are_refused_or_safe),
    };
    if (scene_open("soup:n=40,size=0.8", 1, &scene, &reason))
        return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    scene_free(&scene);
    return failed;
}
