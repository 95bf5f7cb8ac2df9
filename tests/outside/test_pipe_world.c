/* Laws of engines "pipe:COMMAND" on worlds (ref/outside/pipe.h, version 2): a peer receives the
 * world and the rays to the bit, and what it cannot mean is refused in one line. The peers are this
 * program (tests/outside/world_peers.h). */
#define _GNU_SOURCE /* setenv */
#include "ref/outside/pipe_world.h"
#include "ref/twin/model.h"
#include "tests/outside/world_piped.h"

/* Opens the peer, prepares and traces; the first status that is not OK. */
static enum status play(const char *what, enum query query, struct hit hit[RAYS],
                        uint32_t tag[RAYS], struct model *model, struct reason *reason)
{
    const bool late = strcmp(what, "hangs") == 0;
    const struct engine_options options = {.peer_ms = late ? 300 : 20000, .peer_mb = UINT32_MAX};
    /* Twice: the world is not sent again. */
    return play_world(peer_engine(what), &options, query, 2, hit, tag, model, reason);
}

static void a_peer_has_the_world_to_the_bit(void **state)
{
    (void)state;
    for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
        struct hit hit[RAYS], own;
        uint32_t tag[RAYS], own_tag;
        struct world_look look;
        struct reason reason = {""};
        size_t hits = 0;
        if (play("honest", query, hit, tag, NULL, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(world_look_make(&world, tri_test_find("mt"), &look, &reason), STATUS_OK);
        for (size_t i = 0; i < RAYS; i++) {
            look_at(&look, query, i, &own, &own_tag);
            assert_memory_equal(&own, &hit[i], sizeof own);
            assert_int_equal(own_tag, tag[i]);
            hits += own.prim != ABI_NO_PRIM;
        }
        assert_true(hits > RAYS / 4);
        world_look_free(&look);
    }
}

/* Without modes rays meet everything. */
static void rays_without_modes_meet_everything(void **state)
{
    (void)state;
    const struct engine *engine = peer_engine("honest");
    struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct world_job job = job_of(QUERY_CLOSEST);
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit[RAYS], own;
    struct world_look look;
    uint32_t tag[RAYS], own_tag;
    void *self;
    const struct hit none = {.prim = ABI_NO_PRIM};
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->trace_world(self, ray, NULL, RAYS, hit, tag, &report, &reason),
                     STATUS_OK);
    assert_int_equal(world_look_make(&world, tri_test_find("mt"), &look, &reason), STATUS_OK);
    for (size_t i = 0; i < RAYS; i++) {
        world_look_trace(&look, QUERY_CLOSEST, &ray[i], ray_mode_all(), &none, &own, &own_tag);
        assert_memory_equal(&own, &hit[i], sizeof own);
        assert_int_equal(own_tag, tag[i]);
    }
    world_look_free(&look);
    engine->close(self);
}

/* Every way to break version 2, and its error. */
static const struct broken {
    const char *what;
    enum status status;
    const char *said;
} broken[] = {
    {"instance", STATUS_DEVICE, "its answer to ray 10 names instance 32 of 32"},
    {"no_mesh", STATUS_DEVICE, "its answer to ray 10 names instance 2, which has no mesh"},
    {"geometry", STATUS_DEVICE, "its answer to ray 10 names geometry 99 of 5 of instance 1"},
    {"triangle", STATUS_DEVICE, "its answer to ray 10 names triangle 999999 of 55 of instance 1"},
    {"side", STATUS_DEVICE, "its answer to ray 10 has side 2: 1 is the front, 0 the back"},
    {"custom", STATUS_DEVICE, "its answer to ray 10 has custom index 16777216"},
    {"miss_side", STATUS_DEVICE, "its answer to ray 10 is a miss of side 1"},
    {"miss_geometry", STATUS_DEVICE, "its answer to ray 10 is a miss of geometry 3"},
    {"miss_custom", STATUS_DEVICE, "its answer to ray 10 is a miss of custom index 5"},
    {"dies", STATUS_DEVICE, "it was ended by signal 9 after the answer to ray 9"},
    {"hangs", STATUS_DEVICE, "late: not done within 0.3 s, after the answer to ray 9"},
    {"few", STATUS_DEVICE, "its answer is about 399 rays, not 400, from ray 0 on"},
    {"long", STATUS_DEVICE, "its answer is longer than 400 rays"},
    {"old", STATUS_DEVICE, "its answer is of version 1, not 2"},
    {"fickle", STATUS_DEVICE, "now declares another formula, rounding or flags"},
    {"refuses", STATUS_REFUSED, "refused: only teapots"},
    {"scenes", STATUS_UNSUPPORTED, "traces scenes, not worlds: its flags have no 8"},
};

static void what_no_answer_can_be_is_said_in_one_line(void **state)
{
    (void)state;
    for (size_t i = 0; i < ARRAY_COUNT(broken); i++) {
        const struct broken *one = &broken[i];
        struct hit hit[RAYS];
        uint32_t tag[RAYS];
        struct reason reason = {""};
        enum status status = play(one->what, QUERY_CLOSEST, hit, tag, NULL, &reason);
        if (status != one->status || !strstr(reason.text, one->said) || strchr(reason.text, '\n'))
            fail_msg("%s: status %s, '%s'; not '%s'", one->what, status_text(status), reason.text,
                     one->said);
    }
}

/* A ray is told by its number among all, whichever of the requests of 2^18 rays it is in. */
static void a_ray_is_told_by_its_number_among_all(void **state)
{
    (void)state;
    enum { EACH = 1 << 18, ALL = EACH + 20 };
    const struct engine *engine = peer_engine("instance");
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    const struct world_job job = job_of(QUERY_CLOSEST);
    struct ray *many = calloc(ALL, sizeof *many);
    struct hit *hit = calloc(ALL, sizeof *hit);
    uint32_t *tag = calloc(ALL, sizeof *tag);
    struct trace_report report;
    struct reason reason = {""};
    void *self;
    assert_true(many && hit && tag);
    for (size_t i = 0; i < ALL; i++)
        many[i] = ray[i % RAYS];
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->trace_world(self, many, NULL, ALL, hit, tag, &report, &reason),
                     STATUS_DEVICE);
    if (!strstr(reason.text, "its answer to ray 262154 names instance 32 of 32"))
        fail_msg("%s", reason.text);
    engine->close(self);
    free(many);
    free(hit);
    free(tag);
}

static void lists_are_not_in_the_protocol(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct reason reason = {""};
    assert_int_equal(play("honest", QUERY_ALL, hit, tag, NULL, &reason), STATUS_UNSUPPORTED);
    assert_null(peer_engine("honest")->worlds->trace_world_all);
}

/* A peer without flag 8 is sent no word of version 2, after which it would end. */
static void a_peer_of_scenes_is_left_as_it_was(void **state)
{
    (void)state;
    const struct engine *engine = peer_engine("scenes");
    struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct world_job job = job_of(QUERY_CLOSEST);
    const struct scene none = {.vertex_count = 0};
    const struct job empty = {.scene = &none, .tri = job.tri};
    struct reason reason = {""};
    void *self;
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_false(engine_traces_worlds(engine, self));
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_UNSUPPORTED);
    assert_int_equal(engine->prepare(self, &empty, &reason), STATUS_OK);
    engine->close(self);
    engine = peer_engine("honest");
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_true(engine_traces_worlds(engine, self));
    engine->close(self);
}

/* A formula has no transforms; it would be held to those of engines of ours. */
static void a_formula_of_a_world_is_unknown(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct model model;
    struct reason reason = {""};
    assert_int_equal(play("declared", QUERY_CLOSEST, hit, tag, &model, &reason), STATUS_OK);
    assert_int_equal(model.formula, TWIN_UNKNOWN);
}

static void custom_indices_that_are_not_kept_are_the_instances(void **state)
{
    (void)state;
    struct hit hit[RAYS], other[RAYS];
    uint32_t tag[RAYS], kept[RAYS];
    struct reason reason = {""};
    assert_int_equal(play("honest", QUERY_CLOSEST, hit, kept, NULL, &reason), STATUS_OK);
    assert_int_equal(play("keeps_none", QUERY_CLOSEST, other, tag, NULL, &reason), STATUS_OK);
    assert_memory_equal(hit, other, sizeof hit);
    assert_memory_equal(kept, tag, sizeof tag);
}

/* Only where a ray may end at any hit; elsewhere the answer names what is not there. */
static void a_peer_that_names_nothing_need_not(void **state)
{
    (void)state;
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct reason reason = {""};
    size_t hits = 0;
    if (play("unnamed", QUERY_ANY, hit, tag, NULL, &reason))
        fail_msg("%s", reason.text);
    for (size_t i = 0; i < RAYS; i++) {
        assert_true((hit[i].prim == 0 || hit[i].prim == ABI_NO_PRIM) && tag[i] == 0);
        hits += hit[i].prim == 0;
    }
    assert_true(hits > RAYS / 4);
    assert_int_equal(play("unnamed", QUERY_CLOSEST, hit, tag, NULL, &reason), STATUS_DEVICE);
    assert_non_null(strstr(reason.text, "names geometry 77"));
}

static void a_peer_that_died_has_the_world_again(void **state)
{
    (void)state;
    const struct engine *engine = peer_engine("dies");
    struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    struct world_job job = job_of(QUERY_CLOSEST);
    struct trace_report report;
    struct reason reason = {""};
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    size_t at;
    void *self;
    assert_int_equal(engine_open(engine, &options, &self, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->prepare_world(self, &job, &reason), STATUS_OK);
    assert_int_equal(engine->worlds->trace_world(self, ray, mode, RAYS, hit, tag, &report, &reason),
                     STATUS_DEVICE);
    assert_int_equal(engine->fault(self, &at), ENGINE_ENDED);
    assert_int_equal(at, WORLD_PEER_RAY);
    assert_int_equal(setenv("PEER", "honest", 1), 0);
    if (engine->worlds->trace_world(self, ray, mode, RAYS, hit, tag, &report, &reason))
        fail_msg("%s", reason.text);
    engine->close(self);
}

/* Each number of an answer up to the last that exists, and one more. */
static void numbers_of_an_answer_end_where_the_world_does(void **state)
{
    (void)state;
    struct hit hit;
    uint32_t tag, tried = 0;
    for (uint32_t i = 0; i < world.instance_count; i++) {
        const uint32_t mesh = world.instance[i].mesh;
        for (uint32_t g = 0; mesh != WORLD_NO_MESH && g < world.mesh[mesh].geometry_count; g++) {
            const struct geometry *geometry = &world.mesh[mesh].geometry[g];
            const struct pipe_world_hit last = {.instance = i,
                                                .geometry = g,
                                                .triangle = geometry->count - 1,
                                                .side = 1,
                                                .custom = ABI_CUSTOM_MOST};
            struct pipe_world_hit more[5] = {last, last, last, last, last};
            if (geometry->count == 0)
                continue;
            assert_int_equal(pipe_world_take(&world, &last, false, &hit, &tag, NULL), STATUS_OK);
            assert_int_equal(hit.prim, world.first[i] + geometry->first + geometry->count - 1);
            assert_int_equal(tag, ABI_CUSTOM_MOST | ABI_TAG_FRONT);
            more[0].instance = world.instance_count;
            more[1].geometry = world.mesh[mesh].geometry_count;
            more[2].triangle++;
            more[3].side++;
            more[4].custom++;
            for (size_t k = 0; k < ARRAY_COUNT(more); k++) {
                assert_int_equal(pipe_world_take(&world, &more[k], false, &hit, &tag, NULL),
                                 STATUS_INPUT);
                assert_int_equal(hit.prim, ABI_NO_PRIM);
                assert_int_equal(tag, 0);
            }
            tried++;
        }
    }
    assert_true(tried > 10);
}

int main(int argc, char **argv)
{
    if (argc == 3 && strcmp(argv[1], "--peer") == 0)
        return world_peer_main(argv[2]);
    program = argv[0];
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_an_answer_end_where_the_world_does),
        cmocka_unit_test(a_peer_has_the_world_to_the_bit),
        cmocka_unit_test(rays_without_modes_meet_everything),
        cmocka_unit_test(what_no_answer_can_be_is_said_in_one_line),
        cmocka_unit_test(a_ray_is_told_by_its_number_among_all),
        cmocka_unit_test(lists_are_not_in_the_protocol),
        cmocka_unit_test(a_peer_of_scenes_is_left_as_it_was),
        cmocka_unit_test(a_formula_of_a_world_is_unknown),
        cmocka_unit_test(custom_indices_that_are_not_kept_are_the_instances),
        cmocka_unit_test(a_peer_that_names_nothing_need_not),
        cmocka_unit_test(a_peer_that_died_has_the_world_again),
    };
    return cmocka_run_group_tests(tests, make_world, free_world);
}
