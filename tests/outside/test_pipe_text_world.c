/* Laws of worlds as text (ref/outside/pipe_text.h, version 2): what is written reads back to the
 * bit, in both notations; answers are the hits and tags that they name; whatever else is in a file
 * is named with its line. */
#define _POSIX_C_SOURCE 200809L /* open_memstream */
#include "ref/base/rng.h"
#include "ref/outside/pipe_text.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#define RAYS 200

/* A world of two meshes, three geometries, and an instance without a mesh. */
#define REQUEST                                                                                    \
    "raydiff 2\nquery any\nfilter cells 7 128\nmesh\nv 0 0 0\nv 1 0 0\nv 0 1 0\nt 0 1 2\nt 0 2 "   \
    "1\n"                                                                                          \
    "g 1 opaque\ng 1 filtered\nmesh\ng 0 opaque\n"                                                 \
    "i 0 9 255 0 1 0 0 5 0 1 0 0 0 0 1 0\ni - 1 2 3 1 0 0 0 0 1 0 0 0 0 1 0\n"                     \
    "i 1 5 1 2 2 0 0 0 0 1 0 0 0 0 1 0\nr 0.25 0.25 -1 0 0 0 1 9 255 16\nend\n"

static enum status parse(const char *text, const struct world *world, struct pipe_text *out,
                         struct reason *reason)
{
    const struct pipe_limits limits = {
        .rays = 3, .triangles = world ? 0 : UINT32_MAX, .world = world};
    return pipe_text_parse("file", text, strlen(text), &limits, out, reason);
}

static void must_be_the_same(const struct world *a, const struct world *b)
{
    assert_int_equal(a->mesh_count, b->mesh_count);
    assert_int_equal(a->instance_count, b->instance_count);
    for (uint32_t i = 0; i < a->mesh_count; i++) {
        const struct world_mesh *x = &a->mesh[i], *y = &b->mesh[i];
        assert_int_equal(x->scene->vertex_count, y->scene->vertex_count);
        assert_int_equal(x->scene->tri_count, y->scene->tri_count);
        assert_int_equal(x->geometry_count, y->geometry_count);
        if (x->scene->vertex_count)
            assert_memory_equal(x->scene->vertex, y->scene->vertex,
                                12 * (size_t)x->scene->vertex_count);
        if (x->scene->tri_count)
            assert_memory_equal(x->scene->index, y->scene->index, 12 * (size_t)x->scene->tri_count);
        for (uint32_t g = 0; g < x->geometry_count; g++)
            assert_true(x->geometry[g].first == y->geometry[g].first &&
                        x->geometry[g].count == y->geometry[g].count &&
                        x->geometry[g].opaque == y->geometry[g].opaque);
    }
    assert_memory_equal(a->instance, b->instance, a->instance_count * sizeof *a->instance);
    assert_memory_equal(a->first, b->first, (a->instance_count + 1) * sizeof *a->first);
    assert_true(a->filter.kind == b->filter.kind && a->filter.seed == b->filter.seed &&
                a->filter.share == b->filter.share);
}

static void what_is_written_reads_back_to_the_bit(void **state)
{
    (void)state;
    for (size_t g = 0; world_generators[g]; g++)
        for (int decimal = 0; decimal < 2; decimal++) {
            struct pipe_from from = {.hash = 5,
                                     .seed = 7,
                                     .count = RAYS,
                                     .rays = "mixed",
                                     .modes = "drawn",
                                     .spec = "a world, with blanks.glb"};
            const struct pipe_limits limits = pipe_limits_none();
            struct world world;
            struct ray *ray = NULL;
            struct ray_mode *mode = NULL;
            struct pipe_text text;
            struct reason reason = {""};
            char *bytes = NULL;
            size_t size = 0;
            FILE *stream = open_memstream(&bytes, &size);
            assert_non_null(stream);
            if (world_open(world_generators[g]->name, 3, &world, &reason) ||
                world_rays_new(&world, ray_sets[0], RAY_MODES_DRAWN, 3, RAYS, &ray, &mode, &reason))
                fail_msg("%s", reason.text);
            pipe_text_write_world(stream, &from, &world, ray, mode, RAYS, QUERY_ANY, decimal);
            assert_int_equal(fclose(stream), 0);
            if (pipe_text_parse("file", bytes, size, &limits, &text, &reason))
                fail_msg("%s: %s", world_generators[g]->name, reason.text);
            assert_int_equal(text.version, 2);
            assert_int_equal(text.query, QUERY_ANY);
            assert_int_equal(text.ray_count, RAYS);
            assert_memory_equal(text.ray, ray, RAYS * sizeof *ray);
            assert_memory_equal(text.mode, mode, RAYS * sizeof *mode);
            must_be_the_same(&world, &text.world);
            assert_true(pipe_hash_world(&world, ray, mode, RAYS, QUERY_ANY) ==
                        pipe_hash_world(&text.world, text.ray, text.mode, RAYS, QUERY_ANY));
            assert_string_equal(text.from.modes, from.modes);
            assert_string_equal(text.from.spec, from.spec);
            pipe_text_free(&text);
            world_free(&world);
            free(ray);
            free(mode);
            free(bytes);
        }
}

/* A change of anything is another hash. */
static void the_hash_sees_every_part(void **state)
{
    (void)state;
    static const struct {
        const char *from, *to;
    } changes[] = {{"v 1 0 0", "v 1 0 -0"},
                   {"t 0 2 1", "t 0 1 2"},
                   {"g 1 opaque", "g 1 filtered"},
                   {"g 1 filtered", "g 1 opaque"},
                   {"cells", "triangles"},
                   {" 7 128", " 8 128"},
                   {" 7 128", " 7 129"},
                   {"i 0 9", "i 0 8"},
                   {"i 0 9", "i 1 9"},
                   {"i 0 9 255 0", "i 0 9 254 0"},
                   {"255 0 1", "255 1 1"},
                   {"0 0 5 0 1", "0 0 6 0 1"},
                   {"r 0.25", "r 0.5"},
                   {"9 255 16", "9 254 16"},
                   {"9 255 16", "9 255 32"},
                   {"query any", "query closest"},
                   {"mesh\ng 0 opaque\n", "mesh\ng 0 opaque\ng 0 opaque\n"}};
    struct pipe_text text;
    struct reason reason = {""};
    if (parse(REQUEST, NULL, &text, &reason))
        fail_msg("%s", reason.text);
    const uint64_t hash = pipe_hash_world(&text.world, text.ray, text.mode, 1, text.query);
    pipe_text_free(&text);
    for (size_t i = 0; i < ARRAY_COUNT(changes); i++) {
        char changed[sizeof REQUEST + 32];
        const char *at = strstr(REQUEST, changes[i].from);
        assert_non_null(at);
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - REQUEST), REQUEST, changes[i].to,
                 at + strlen(changes[i].from));
        if (parse(changed, NULL, &text, &reason))
            fail_msg("%s: %s", changes[i].to, reason.text);
        if (pipe_hash_world(&text.world, text.ray, text.mode, 1, text.query) == hash)
            fail_msg("'%s' for '%s' has the same hash", changes[i].to, changes[i].from);
        pipe_text_free(&text);
    }
}

/* The placed triangle, not the triangle of the geometry; the instance's custom index unless there
 * is another. */
static void answers_name_placed_triangles(void **state)
{
    (void)state;
    struct pipe_text request, answer;
    struct reason reason = {""};
    if (parse(REQUEST, NULL, &request, &reason))
        fail_msg("%s", reason.text);
    request.world.instance[1].mesh = 0; /* so that a second instance has triangles */
    assert_int_equal(world_finish(&request.world, &reason), STATUS_OK);
    if (parse("raydiff 2\nh 1 .5 .25 0 1 0 front\nh 2 0 0 1 1 0 back 77\nm\n", &request.world,
              &answer, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(answer.hit_count, 3);
    assert_int_equal(answer.hit[0].prim, 1);
    assert_true(answer.hit[0].t == 1.0f && answer.hit[0].u == 0.5f && answer.hit[0].v == 0.25f);
    assert_int_equal(answer.tag[0], 9 | ABI_TAG_FRONT);
    assert_int_equal(answer.hit[1].prim, 3);
    assert_int_equal(answer.tag[1], 77);
    assert_int_equal(answer.hit[2].prim, ABI_NO_PRIM);
    assert_int_equal(answer.tag[2], 0);
    pipe_text_free(&answer);
    pipe_text_free(&request);
}

static const struct bad {
    const char *text, *said;
} bad_requests[] = {
    {"m\nraydiff 2\n", "file:2: 'raydiff 2' is not the first line"},
    {"raydiff 2\nraydiff 1\n", "file:2: 'raydiff 1' is not the first line"},
    {"raydiff 3\n", "file:1: version 3, not 1 or 2"},
    {"mesh\n", "file:1: 'mesh' is no line: v, t, r, h, m"},
    {"i 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n", "file:1: 'i' is no line"},
    {"raydiff 2\nv 0 0 0\n", "file:2: a line 'v' in no mesh"},
    {"raydiff 2\nt 0 0 0\n", "file:2: a line 't' in no mesh"},
    {"raydiff 2\ng 0 opaque\n", "file:2: a line 'g' in no mesh"},
    {"raydiff 2\nmesh 1\n", "file:2: '1' is too much on a line 'mesh'"},
    {"raydiff 2\nmesh\nmesh\n", "file:3: mesh 0 ends without a 'g' line"},
    {"raydiff 2\nmesh\nv 0 0 0\nt 0 0 0\ng 2 opaque\n", "file:5: a geometry of 2 triangles, but "
                                                        "only 1 are before this line"},
    {"raydiff 2\nmesh\nv 0 0 0\nt 0 0 0\ng 0 opaque\nr 0 0 0 0 1 1 1 2 255 0\n",
     "file:6: mesh 0 ends with 1 triangles, of which its geometries have 0"},
    {"raydiff 2\nmesh\ng 0 solid\n", "file:3: a geometry is opaque or filtered"},
    {"raydiff 2\nmesh\ng -1 opaque\n", "file:3: triangles -1 is not in 0 .."},
    {"raydiff 2\nmesh\ng 0 opaque\nr 0 0 0 0 1 1 1 2 255 0\nv 0 0 0\n",
     "file:5: a line 'v' in no mesh"},
    {"raydiff 2\ni 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n", "file:2: instance 0: mesh 0, but the world "
                                                       "has 0"},
    {"raydiff 2\ni - 16777216 0 0 1 0 0 0 0 1 0 0 0 0 1 0\n",
     "file:2: custom index 16777216 is not in 0 .. 16777215"},
    {"raydiff 2\ni - 0 256 0 1 0 0 0 0 1 0 0 0 0 1 0\n", "file:2: mask 256 is not in 0 .. 255"},
    {"raydiff 2\ni - 0 1 16 1 0 0 0 0 1 0 0 0 0 1 0\n", "file:2: flags 16 is not in 0 .. 15"},
    {"raydiff 2\ni - 0 1 12 1 0 0 0 0 1 0 0 0 0 1 0\n", "file:2: instance 0: it is forced"},
    {"raydiff 2\ni - 0 1 0 1 0 0 0 0 1 0 0 0 0 0 0\n", "file:2: instance 0: its transform is "
                                                       "singular"},
    {"raydiff 2\ni - 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n", "file:2: T2: end of line"},
    {"raydiff 2\ni - 0 1 0 1 0 0 inf 0 1 0 0 0 0 1 0\n", "file:2: instance 0: row 0, column 3"},
    {"raydiff 2\nfilter some 1 2\n", "file:2: filters are all, none, triangles, cells"},
    {"raydiff 2\nfilter cells 1 257\n", "file:2: share 257 is not in 0 .. 256"},
    {"raydiff 2\nr 0 0 0 0 1 1 1 2\n", "file:2: mask: "},
    {"raydiff 2\nr 0 0 0 0 1 1 1 2 255 48\n", "file:2: ray flags 0x30: at most one of cull back"},
    {"raydiff 2\nr 0 0 0 0 1 1 1 2 255 512\n", "file:2: flags 512 is not in 0 .. 511"},
    {"raydiff 2\nfrom 0123456789abcdef 1 2 mixed crowd\n", "file:2: 'from' is of a scene"},
    {"from 0123456789abcdef 1 2 mixed modes=all crowd\n", "file:1: 'from' is of a world"},
    {"raydiff 2\nfrom 0123456789abcdef 1 2 mixed modes=aaaaaaaaaaaaaaaa crowd\n",
     "file:2: not a 'from' line"},
};

static const struct bad bad_answers[] = {
    {"m\n", "file:1: an answer of version 1, to rays in a world: its first line is 'raydiff 2'"},
    {"h 1 0 0 0\n", "file:1: an answer of version 1"},
    {"raydiff 1\n", "file:1: version 1, not 2: the rays are in a world"},
    {"raydiff 2\nh 1 0 0 0\n", "file:2: geometry: "},
    {"raydiff 2\nh 1 0 0 0 0 0\n", "file:2: behind the triangle stands front or back"},
    {"raydiff 2\nh 1 0 0 0 0 0 1\n", "file:2: behind the triangle stands front or back"},
    {"raydiff 2\nh 1 0 0 0 0 0 front 9 1\n", "file:2: '1' is too much on a line 'h'"},
    {"raydiff 2\nh 1 0 0 0 0 0 front 16777216\n", "file:2: custom index 16777216"},
    {"raydiff 2\nm\nh 1 0 0 3 0 0 front\n",
     "file:3: an answer to ray 1 that names instance 3 of 3"},
    {"raydiff 2\nh 1 0 0 1 0 0 front\n", "file:2: an answer to ray 0 that names instance 1, which "
                                         "has no mesh"},
    {"raydiff 2\nh 1 0 0 0 2 0 front\n", "file:2: an answer to ray 0 that names geometry 2 of 2"},
    {"raydiff 2\nh 1 0 0 0 1 1 front\n", "file:2: an answer to ray 0 that names triangle 1 of 1"},
    {"raydiff 2\nh 1 0 0 -1 0 0 front\n", "file:2: instance -1 is not in"},
    {"raydiff 2\nh 1 0 0 4294967295 0 0 front\n", "file:2: instance 4294967295 is not in"},
    {"raydiff 2\nm front\n", "file:2: 'front' is too much on a line 'm'"},
    {"raydiff 2\nm\nm\nm\nm\n", "file:5: an answer to ray 3, but there are only 3 rays"},
};

static void must_be_refused(const struct bad *bad, const struct world *world)
{
    struct pipe_text text;
    struct reason reason = {""};
    enum status status = parse(bad->text, world, &text, &reason);
    if (status != STATUS_INPUT || strncmp(reason.text, bad->said, strlen(bad->said)) != 0)
        fail_msg("'%s': %s '%s', not '%s'", bad->text, status_text(status), reason.text, bad->said);
    assert_null(text.ray);
    assert_null(text.hit);
    assert_null(text.world.mesh);
}

static void what_is_wrong_is_named_with_its_line(void **state)
{
    (void)state;
    struct pipe_text request;
    struct reason reason = {""};
    for (size_t i = 0; i < ARRAY_COUNT(bad_requests); i++)
        must_be_refused(&bad_requests[i], NULL);
    assert_int_equal(parse(REQUEST, NULL, &request, &reason), STATUS_OK);
    for (size_t i = 0; i < ARRAY_COUNT(bad_answers); i++)
        must_be_refused(&bad_answers[i], &request.world);
    pipe_text_free(&request);
}

/* Files with bytes changed are read whole, as worlds that pass every rule, or refused with a
 * line. */
static void no_bytes_are_too_bad(void **state)
{
    (void)state;
    static const char file[] = REQUEST, answer[] = "raydiff 2\nh 1 .5 .25 0 1 0 front\nm\n"
                                                   "h 2 0 0 2 0 0 back 77\nflags open\nend\n";
    struct rng rng = rng_make(5, 6);
    struct pipe_text request;
    struct reason reason = {""};
    size_t read = 0;
    assert_int_equal(parse(REQUEST, NULL, &request, &reason), STATUS_OK);
    for (int i = 0; i < 40000; i++) {
        char bytes[sizeof file];
        struct pipe_text text;
        const bool of_answer = i % 2;
        const char *from = of_answer ? answer : file;
        const size_t whole = of_answer ? sizeof answer : sizeof file;
        memcpy(bytes, from, whole);
        for (uint32_t k = rng_below(&rng, 3); k > 0; k--)
            bytes[rng_below(&rng, (uint32_t)whole - 1)] =
                rng_below(&rng, 2) ? (char)rng_u64(&rng)
                                   : from[rng_below(&rng, (uint32_t)whole - 1)];
        bytes[rng_below(&rng, 4) ? whole - 1 : rng_below(&rng, (uint32_t)whole)] = '\0';
        enum status status = parse(bytes, of_answer ? &request.world : NULL, &text, &reason);
        if (status)
            assert_int_equal(strncmp(reason.text, "file:", 5), 0);
        read += !status;
        if (!status && text.version == 2)
            assert_int_equal(world_finish(&text.world, &reason), STATUS_OK);
        for (size_t k = 0; k < text.hit_count && of_answer; k++)
            assert_true(text.hit[k].prim == ABI_NO_PRIM ||
                        text.hit[k].prim < world_tri_count(&request.world));
        pipe_text_free(&text);
    }
    assert_in_range(read, 1000, 39999);
    pipe_text_free(&request);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_reads_back_to_the_bit),
        cmocka_unit_test(the_hash_sees_every_part),
        cmocka_unit_test(answers_name_placed_triangles),
        cmocka_unit_test(what_is_wrong_is_named_with_its_line),
        cmocka_unit_test(no_bytes_are_too_bad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
