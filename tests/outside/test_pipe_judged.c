/* Laws of what comes over a pipe: answers about worlds are judged as those of any engine, as text
 * as over the pipe; requests of version 1 are what they were. The peers are this program
 * (tests/outside/world_peers.h). */
#define _GNU_SOURCE /* setenv, open_memstream, mkstemp */
#include "ref/match/match.h"
#include "ref/outside/pipe_text.h"
#include "ref/outside/recorded.h"
#include "tests/outside/world_piped.h"

static struct match_options options_of(void)
{
    return (struct match_options){.builder = builders[0],
                                  .build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT},
                                  .box = box_tests[0],
                                  .tri = tri_tests[0],
                                  .query = QUERY_CLOSEST,
                                  .repeats = 1};
}

static void judge_engine(const struct engine *engine, struct row *row)
{
    struct pool pool = {.options = {.peer_ms = 20000, .peer_mb = UINT32_MAX}};
    struct match_options options = options_of();
    struct match match;
    struct reason reason = {""};
    if (match_make_world(&world, ray, mode, RAYS, &options, &pool, &match, &reason))
        fail_msg("%s", reason.text);
    match_run(&match, engine, row);
    if (row->status != ROW_OK)
        fail_msg("%s: %s", engine->name, row->reason.text);
    match_free(&match);
    pool_free(&pool);
}

/* The answers of a tracer with the defect, as it writes them. */
static void write_answers(enum world_defect defect, char **bytes, size_t *size)
{
    struct world_look look;
    struct reason reason;
    FILE *to = open_memstream(bytes, size);
    assert_non_null(to);
    assert_int_equal(world_look_make(&world, tri_test_find("mt"), &look, &reason), STATUS_OK);
    world_look_bend(&look, defect);
    fputs("raydiff 2\n", to);
    for (size_t i = 0; i < RAYS; i++) {
        struct hit hit;
        uint32_t tag;
        look_at(&look, QUERY_CLOSEST, i, &hit, &tag);
        const struct world_words words = world_words_of(&world, &hit, tag);
        if (hit.prim == ABI_NO_PRIM)
            fputs("m\n", to);
        else
            fprintf(to, "h %a %a %a %u %u %u %s %u\n", (double)hit.t, (double)hit.u, (double)hit.v,
                    words.instance, words.geometry, words.triangle, words.side ? "front" : "back",
                    words.custom);
    }
    assert_int_equal(fclose(to), 0);
    world_look_free(&look);
}

static void judge_text(enum world_defect defect, struct row *row)
{
    const struct pipe_limits limits = {.rays = RAYS, .triangles = 0, .world = &world};
    const struct engine *engine;
    struct pipe_text text;
    struct reason reason = {""};
    char *bytes = NULL;
    size_t size = 0;
    write_answers(defect, &bytes, &size);
    if (pipe_text_parse("answers", bytes, size, &limits, &text, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(text.hit_count, RAYS);
    struct recorded recorded = {.ray = ray,
                                .mode = mode,
                                .hit = text.hit,
                                .tag = text.tag,
                                .count = RAYS,
                                .formula = text.formula};
    assert_int_equal(recorded_engine(&recorded, &engine, &reason), STATUS_OK);
    judge_engine(engine, row);
    pipe_text_free(&text);
    free(bytes);
}

/* Lies, and the kind that each is found as. */
static const struct lie {
    enum world_defect defect;
    enum wrong kind;
} lies[] = {
    {WORLD_DEFECT_NONE, WRONG_NOT},
    {WORLD_DEFECT_MASK_IGNORED, WRONG_MASKED},
    {WORLD_DEFECT_MASK_EQUAL, WRONG_MISSED},
    {WORLD_DEFECT_SKIP_IGNORED, WRONG_MASKED},
    {WORLD_DEFECT_CULL_IGNORED, WRONG_CULLED},
    {WORLD_DEFECT_FLIP_IGNORED, WRONG_FACING},
    {WORLD_DEFECT_SIDE, WRONG_FACING},
    {WORLD_DEFECT_FILTER_IGNORED, WRONG_OPACITY},
    {WORLD_DEFECT_FORCE_IGNORED, WRONG_OPACITY},
    {WORLD_DEFECT_CUSTOM_IS_NUMBER, WRONG_INSTANCE},
    {WORLD_DEFECT_CUSTOM_16, WRONG_INSTANCE},
    {WORLD_DEFECT_LAST_TRANSFORM, WRONG_INSTANCE},
    {WORLD_DEFECT_LENGTH, WRONG_DISTANCE},
};

static void lies_are_found_over_the_pipe_and_as_text(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(lies); i++) {
        const struct lie *lie = &lies[i];
        struct row row[2];
        char what[20];
        snprintf(what, sizeof what, "defect:%d", (int)lie->defect);
        judge_engine(peer_engine(what), &row[0]);
        judge_text(lie->defect, &row[1]);
        if (lie->kind == WRONG_NOT ? row[0].count[VERDICT_WRONG] > 0 : row[0].wrong[lie->kind] == 0)
            fail_msg("%s: %zu WRONG, none of them is %s", world_defect_about(lie->defect)->text,
                     row[0].count[VERDICT_WRONG], wrong_name(lie->kind));
        assert_memory_equal(row[0].count, row[1].count, sizeof row[0].count);
        assert_memory_equal(row[0].wrong, row[1].wrong, sizeof row[0].wrong);
        assert_int_equal(row[0].hits, row[1].hits);
        assert_true(row[0].unknown && row[1].unknown);
    }
}

/* Recorded answers belong to their rays and to what these may meet. */
static void recorded_answers_are_of_their_modes(void **state)
{
    (void)state;
    struct hit hit[2] = {{.prim = ABI_NO_PRIM}, {.prim = ABI_NO_PRIM}}, out[2];
    uint32_t tag[2] = {0, 0}, out_tag[2];
    struct ray_mode other[2] = {mode[0], mode[1]};
    struct recorded recorded = {.ray = ray, .mode = mode, .hit = hit, .tag = tag, .count = 2};
    const struct world_job job = job_of(QUERY_CLOSEST);
    const struct engine *engine;
    struct trace_report report;
    struct reason reason = {""};
    void *self;
    assert_int_equal(recorded_engine(&recorded, &engine, &reason), STATUS_OK);
    assert_int_equal(engine_open(engine, NULL, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    assert_int_equal(
        engine->worlds->trace_world(self, ray, mode, 2, out, out_tag, &report, &reason), STATUS_OK);
    other[1].mask ^= 1;
    assert_int_equal(
        engine->worlds->trace_world(self, ray, other, 2, out, out_tag, &report, &reason),
        STATUS_UNSUPPORTED);
    hit[1].prim = world_tri_count(&world);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_LIMIT);
    recorded.tag = NULL;
    assert_int_equal(recorded_engine(&recorded, &engine, &reason), STATUS_OK);
    assert_false(engine_traces_worlds(engine, self));
}

/* --- version 1 -------------------------------------------------------------------------------- */

static void add(char *bytes, size_t *size, const void *more, size_t count)
{
    memcpy(bytes + *size, more, count);
    *size += count;
}

/* What a peer of scenes is sent, in this very order, whether a world was tried before or not. */
static void requests_of_version_1_are_what_they_were(void **state)
{
    (void)state;
    float vertex[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0f, 0, 1};
    uint32_t index[6] = {0, 1, 2, 0, 2, 3};
    const struct scene scene = {
        .vertex = vertex, .index = index, .vertex_count = 4, .tri_count = 2};
    const struct job job = {.scene = &scene, .tri = tri_test_find("mt"), .query = QUERY_ANY};
    const struct ray two[2] = {{{0.25f, 0.25f, -1}, 0, {0, 0, 1}, 9}, {{1, 2, 3}, 4, {5, 6, 7}, 8}};
    const uint32_t words[4][8] = {{0x51524452u, 1, 0, 0, 0, 0, 0, 0},
                                  {0x51524452u, 1, 1, 4, 2, 0, 0, 0},
                                  {0x51524452u, 1, 1, 4, 2, 2, 1, 0},
                                  {0x51524452u, 1, 1, 4, 2, 1, 1, 0}};
    char want[1024], got[1024], name[PIPE_NAME_MOST], path[] = "/tmp/test_pipe_world_XXXXXX";
    size_t size = 0;
    struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct world_job world_job = job_of(QUERY_CLOSEST);
    const struct engine *engine;
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit[2];
    void *self;
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(setenv("PEER_FILE", path, 1), 0);
    snprintf(name, sizeof name, "pipe:tee \"$PEER_FILE\" | %.100s --scenes", program);
    assert_int_equal(pipe_engine(name, &engine, &reason), STATUS_OK);
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &world_job, &reason), STATUS_UNSUPPORTED);
    assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
    if (engine->trace(self, two, 2, hit, &report, &reason) ||
        engine->trace(self, two, 1, hit, &report, &reason))
        fail_msg("%s", reason.text);
    add(want, &size, words[0], 32);
    add(want, &size, words[1], 32);
    add(want, &size, vertex, sizeof vertex);
    add(want, &size, index, sizeof index);
    add(want, &size, words[2], 32);
    add(want, &size, two, 64);
    add(want, &size, words[3], 32);
    add(want, &size, two, 32);
    engine->close(self);
    assert_int_equal(read(file, got, sizeof got), size);
    assert_memory_equal(got, want, size);
    close(file);
    unlink(path);
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "--scenes") == 0)
        return peer_main("honest");
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return world_peer_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lies_are_found_over_the_pipe_and_as_text),
        cmocka_unit_test(recorded_answers_are_of_their_modes),
        cmocka_unit_test(requests_of_version_1_are_what_they_were),
    };
    return cmocka_run_group_tests(tests, make_world, free_world);
}
