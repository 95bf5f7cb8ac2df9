/* Laws of the text form of requests and answers (ref/outside/pipe_text.h): what is written reads
 * back to the bit, in both notations; whatever else is in a file is named with its line. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/outside/pipe_text.h"
#include "ref/outside/recorded.h"
#include "ref/base/rng.h"
#include "scenes/rays/rays.h"
#include "scenes/scenes.h"
#include "ref/twin/model.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const struct pipe_limits any_limits = {SIZE_MAX, UINT32_MAX, NULL};

static enum status parse(const char *text, const struct pipe_limits *limits, struct pipe_text *out,
                         struct reason *reason)
{
    return pipe_text_parse("file", text, strlen(text), limits, out, reason);
}

static void must_read_back(const struct scene *scene, const struct ray *ray, size_t count,
                           bool decimal, uint64_t seed)
{
    struct pipe_from from = {.hash = pipe_hash(scene, ray, count, QUERY_ANY),
                             .seed = seed,
                             .count = count,
                             .rays = "mixed",
                             .spec = "a mesh, with blanks.obj"};
    struct pipe_text text;
    struct reason reason = {""};
    char *bytes = NULL;
    size_t size = 0;
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    pipe_text_write(stream, &from, scene, ray, count, QUERY_ANY, decimal);
    assert_int_equal(fclose(stream), 0);
    if (pipe_text_parse("file", bytes, size, &any_limits, &text, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(text.ray_count, count);
    assert_int_equal(text.scene.vertex_count, scene->vertex_count);
    assert_int_equal(text.scene.tri_count, scene->tri_count);
    assert_memory_equal(text.scene.vertex, scene->vertex, 12 * (size_t)scene->vertex_count);
    assert_memory_equal(text.scene.index, scene->index, 12 * (size_t)scene->tri_count);
    for (size_t i = 0; i < count; i++) {
        const float *a = text.ray[i].org, *b = ray[i].org; /* eight floats in a row */
        for (int k = 0; k < 8; k++)
            assert_true(float_bits(a[k]) == float_bits(b[k]) || (a[k] != a[k] && b[k] != b[k]));
    }
    assert_int_equal(text.query, QUERY_ANY);
    assert_true(text.from.hash == from.hash && text.from.seed == seed && text.from.count == count);
    assert_string_equal(text.from.rays, from.rays);
    assert_string_equal(text.from.spec, from.spec);
    pipe_text_free(&text);
    free(bytes);
}

static void what_is_written_reads_back_to_the_bit(void **state)
{
    (void)state;
    enum { COUNT = 3000 };
    struct scene scene;
    struct reason reason;
    struct rng rng = rng_make(1, 4);
    struct ray *ray = calloc(COUNT, sizeof *ray);
    assert_non_null(ray);
    assert_int_equal(scene_open("soup:n=200", 3, &scene, &reason), STATUS_OK);
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++) { /* any finite float */
        float x = float_from_bits((uint32_t)rng_u64(&rng));
        if (float_is_finite(x))
            scene.vertex[i] = x;
    }
    for (size_t i = 0; i < COUNT; i++) { /* any float at all */
        uint32_t bits[8];
        for (int k = 0; k < 8; k++)
            bits[k] = (uint32_t)rng_u64(&rng);
        if (i % 3 == 0)
            bits[i % 8] = i % 2 ? 0x7F800000u : 0x80000000u;
        memcpy(&ray[i], bits, sizeof bits);
    }
    must_read_back(&scene, ray, COUNT, false, 7);
    must_read_back(&scene, ray, COUNT, true, 7);
    static const uint64_t seeds[] = {
        0, 1, 999999999999999999u, 1000000000000000000u, INT64_MAX, UINT64_MAX};
    for (size_t i = 0; i < ARRAY_COUNT(seeds); i++)
        for (size_t count = 0; count < 3; count++)
            must_read_back(&scene, ray, count, i % 2, seeds[i]);
    scene_free(&scene);
    free(ray);
}

/* A change in any bit is another hash. */
static void the_hash_sees_every_part(void **state)
{
    (void)state;
    float vertex[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t index[3] = {0, 1, 2};
    struct scene scene = {.vertex = vertex, .index = index, .vertex_count = 3, .tri_count = 1};
    struct ray ray = {{0.25f, 0.25f, -1}, 0, {0, 0, 1}, 9};
    uint64_t hash = pipe_hash(&scene, &ray, 1, QUERY_CLOSEST);
    assert_true(hash == pipe_hash(&scene, &ray, 1, QUERY_CLOSEST));
    assert_true(hash != pipe_hash(&scene, &ray, 1, QUERY_ANY));
    assert_true(hash != pipe_hash(&scene, &ray, 0, QUERY_CLOSEST));
    ray.tmax = 8;
    assert_true(hash != pipe_hash(&scene, &ray, 1, QUERY_CLOSEST));
    ray.tmax = 9;
    vertex[8] = -0.0f;
    assert_true(hash != pipe_hash(&scene, &ray, 1, QUERY_CLOSEST));
    vertex[8] = 0.0f;
    index[0] = 1;
    assert_true(hash != pipe_hash(&scene, &ray, 1, QUERY_CLOSEST));
}

static void answers_have_what_their_words_say(void **state)
{
    (void)state;
    struct pipe_text text;
    struct reason reason = {""};
    const char *file = "raydiff 1 # of a tracer\r\n"
                       "formula woop vulkan_rte\n"
                       "flags unnamed open\n"
                       "\n"
                       "  h 0x1.8p+1 .25 -2.5e-1 7   # a hit\n"
                       "m\n"
                       "h nan inf -inf 0\n"
                       "end\n"
                       "# that was all";
    if (parse(file, &(struct pipe_limits){3, 8, NULL}, &text, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(text.hit_count, 3);
    assert_true(text.hit[0].t == 3.0f && text.hit[0].u == 0.25f && text.hit[0].v == -0.25f);
    assert_int_equal(text.hit[0].prim, 7);
    assert_int_equal(text.hit[1].prim, ABI_NO_PRIM);
    assert_false(float_is_finite(text.hit[2].t));
    assert_int_equal(text.formula, 2);
    assert_int_equal(text.rounding, 3);
    assert_int_equal(text.flags, 5);
    pipe_text_free(&text);
    assert_int_equal(parse("refused  too many triangles \n", &any_limits, &text, &reason),
                     STATUS_OK);
    assert_string_equal(text.refused, "too many triangles");
    pipe_text_free(&text);
}

static void what_is_wrong_is_named_with_its_line(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } bad[] = {
        {"raydiff 2\n", "file:1: version 2, not 1"},
        {"m\n\n# x\nq 1\n", "file:4: 'q' is no line: v, t, r, h, m"},
        {"v 0 0\n", "file:1: z: end of line is not a float32 number"},
        {"v 0 0 1x\n", "file:1: z: '1x' is not a float32 number"},
        {"v 0 0 0x1.8\n", "file:1: z: '0x1.8' is not a float32 number"},
        {"v 0 0 0x1.0000001p+0\n", "file:1: z: '0x1.0000001p+0' is not a float32 number"},
        {"v 0 0 inf\n", "file:1: a vertex is finite"},
        {"v 0 0 1e39\n", "file:1: a vertex is finite"},
        {"v 0 0 0 0\n", "file:1: '0' is too much on a line 'v'"},
        {"v 0 0 0\n", "file: has no triangle"},
        {"v 0 0 0\nt 0 0 1\n", "file:2: vertex 1 is none of the 1 before this line"},
        {"v 0 0 0\nt 0 0 -1\n", "file:2: vertex -1 is none"},
        {"t 0 0 0\n", "file:1: vertex 0 is none of the 0"},
        {"v 0 0 0\nt 0 0 99999999999999999999\n", "file:2: vertex: "},
        {"r 0 0 0 0 1 1 1\n", "file:1: tmax: end of line is not a float32 number"},
        {"r 0 0 0 0 1 1 1 2 3\n", "file:1: '3' is too much on a line 'r'"},
        {"h 1 0 0\n", "file:1: triangle: "},
        {"h 1 0 0 1.5\n", "file:1: triangle: '1.5'"},
        {"h 1 0 0 8\n", "file:1: triangle 8 is none of 8"},
        {"h 1 0 0 -1\n", "file:1: triangle -1 is none of 8"},
        {"h 1 0 0 4294967295\n", "file:1: triangle 4294967295 is none of 8"},
        {"m 1\n", "file:1: '1' is too much on a line 'm'"},
        {"m\nm\nm\nm\n", "file:4: an answer to ray 3, but there are only 3 rays"},
        {"query all\n", "file:1: queries are closest, any"},
        {"formula sse\n", "file:1: formulas are unknown, mt, woop"},
        {"formula mt half\n", "file:1: roundings are ieee"},
        {"flags wet\n", "file:1: flags are open"},
        {"from x 1 2 mixed soup\n", "file:1: not a 'from' line"},
        {"from 0123456789abcdef 1 2 mixed\n", "file:1: not a 'from' line"},
        {"from 0123456789abcdef -1 2 mixed soup\n", "file:1: not a 'from' line"},
        {"from 0123456789abcdef 1 -2 mixed soup\n", "file:1: not a 'from' line"},
        {"from 0123456789abcdef 18446744073709551616 2 mixed soup\n", "file:1: not a 'from' line"},
        {"from 0123456789abcdef 1 18446744073709551616 mixed soup\n", "file:1: not a 'from' line"},
        {"end\nm\n", "file:2: nothing follows 'end'"},
    };
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++) {
        struct pipe_text text;
        struct reason reason = {""};
        enum status status = parse(bad[i].text, &(struct pipe_limits){3, 8, NULL}, &text, &reason);
        if (status != STATUS_INPUT || strncmp(reason.text, bad[i].said, strlen(bad[i].said)) != 0)
            fail_msg("'%s': %s '%s', not '%s'", bad[i].text, status_text(status), reason.text,
                     bad[i].said);
        assert_null(text.ray);
        assert_null(text.hit);
    }
}

/* Every file cut anywhere, and with any byte changed, is read or refused with a line. */
static void no_bytes_are_too_bad(void **state)
{
    (void)state;
    char file[] = "raydiff 1\nfrom 0123456789abcdef 1 2 mixed soup\nquery any\nv 0 0 0x1p-3\n"
                  "v 1 0 0\nv 0 1e-3 0\nt 0 1 2\nr 0 0 -1 0 0 0 1 inf\nh 1 .5 .25 0\nm\n"
                  "formula mt ieee\nflags open\nrefused so\nend\n";
    struct rng rng = rng_make(5, 6);
    size_t read = 0;
    for (int i = 0; i < 20000; i++) {
        char bytes[sizeof file];
        struct pipe_text text;
        struct reason reason = {""};
        size_t size = rng_below(&rng, sizeof file);
        memcpy(bytes, file, sizeof file);
        for (uint32_t k = rng_below(&rng, 3); k > 0; k--)
            bytes[rng_below(&rng, sizeof file - 1)] = (char)rng_u64(&rng);
        bytes[size] = '\0';
        enum status status = pipe_text_parse("file", bytes, size, &any_limits, &text, &reason);
        if (status)
            assert_int_equal(strncmp(reason.text, "file:", 5), 0);
        read += !status;
        pipe_text_free(&text);
    }
    assert_in_range(read, 1, 19999);
}

static void a_written_answer_is_an_engine(void **state)
{
    (void)state;
    const struct engine *engine;
    struct reason reason = {""};
    struct trace_report report;
    struct ray ray[2] = {{{0, 0, -1}, 0, {0, 0, 1}, 9}, {{1, 0, -1}, 0, {0, 0, 1}, 9}};
    struct hit hit, given = {3, 0.5f, 0.25f, 17};
    char name[RECORDED_NAME_MOST];
    void *self;
    static const char *const bad[] = {"answer:",
                                      "answer:mt",
                                      "answer:mt:ieee:0",
                                      "answer:mt:ieee:miss",
                                      "answer:sse:ieee:0:miss",
                                      "answer:mt:half:0:miss",
                                      "answer:mt:ieee:8:miss",
                                      "answer:mt:ieee:0:miss:1",
                                      "answer:mt:ieee:0:1:2:3",
                                      "answer:mt:ieee:0:1:2:3:4:5",
                                      "answer:mt:ieee:0:1:2:3:x",
                                      "answer:mt:ieee:0:1::3:4",
                                      "answer:mt:ieee:0:1:2:3:4294967295",
                                      "answer:mt:ieee:0:1:2:3:4294967296",
                                      "answer:mt:ieee:0:1:2:3:18446744073709551616",
                                      "answer:mt:ieee:0:1:2:3:-1",
                                      "answer:mt:ieee:0:1:2:3:+1",
                                      "answer:mt:ieee:0:1:2:3: 1",
                                      "answer:mt:ieee:4294967296:miss"};
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
        if (recorded_find(bad[i], &engine, &reason) != STATUS_INPUT)
            fail_msg("'%s' was taken", bad[i]);
    struct recorded answers = {
        .ray = ray, .hit = &given, .count = 1, .formula = 1, .rounding = 4, .flags = 1};
    assert_int_equal(recorded_engine(&answers, &engine, &reason), STATUS_OK);
    recorded_name(engine->name, &given, name);
    assert_string_equal(name, "answer:mt:embree:1:0x1.8p+1:0x1p-1:0x1p-2:17");
    assert_int_equal(recorded_find(name, &engine, &reason), STATUS_OK);
    assert_ptr_equal(engine_find(name), engine);
    assert_int_equal(engine_open(engine, &(struct engine_options){0}, &self, &reason), STATUS_OK);
    assert_int_equal(engine->trace(self, ray, 1, &hit, &report, &reason), STATUS_OK);
    assert_memory_equal(&hit, &given, sizeof hit);
    assert_int_equal(engine->trace(self, ray + 1, 1, &hit, &report, &reason), STATUS_UNSUPPORTED);
    assert_int_equal(engine->trace(self, ray, 1, &hit, &report, &reason), STATUS_OK);
    struct model model = engine_model(engine, self, NULL);
    assert_true(model.formula == TWIN_MT && model.rounding.div == 5.5 && model.open);
    engine->close(self);
    assert_int_equal(recorded_find("answer:mt:ieee:0:miss", &engine, &reason), STATUS_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_reads_back_to_the_bit),
        cmocka_unit_test(the_hash_sees_every_part),
        cmocka_unit_test(answers_have_what_their_words_say),
        cmocka_unit_test(what_is_wrong_is_named_with_its_line),
        cmocka_unit_test(no_bytes_are_too_bad),
        cmocka_unit_test(a_written_answer_is_an_engine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
