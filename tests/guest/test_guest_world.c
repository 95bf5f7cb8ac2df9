/* Laws of worlds for tracers from outside (ref/guest/): in both ways a guest is given the world and
 * its rays to the bit, and its hits arrive; one that names what is not there is told. */
#define _GNU_SOURCE /* setenv */
#include "tests/guest/guest_ways.h"

#include "ref/twin/model.h"
#include "scenes/scenes.h"

#define RAYS 150

#include "tests/support/mixed_rays.h"

static enum status play(bool inside, enum query query, struct hit *hit, uint32_t *tag,
                        struct model *model, struct reason *reason)
{
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    return play_world(engine_way("guest_bad.so", inside), &options, query, 1, hit, tag, model,
                      reason);
}

static uint32_t mixed(uint32_t hash, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ ((const unsigned char *)bytes)[i]) * 16777619u;
    return hash;
}

static uint32_t mixed_mesh(uint32_t hash, const struct world_mesh *mesh)
{
    hash = mixed(hash, mesh->scene->vertex, 12 * (size_t)mesh->scene->vertex_count);
    hash = mixed(hash, mesh->scene->index, 12 * (size_t)mesh->scene->tri_count);
    for (uint32_t g = 0; g < mesh->geometry_count; g++) {
        const uint32_t words[] = {mesh->geometry[g].count, mesh->geometry[g].opaque};
        hash = mixed(hash, words, sizeof words);
    }
    return hash;
}

/* What tests/peers/guest_bad.c answers to ray i, from the world itself: hashes of every bit that
 * it was given. */
static bool expected(uint32_t i, enum query query, struct hit *hit, uint32_t *tag)
{
    const uint32_t number = i % world.instance_count;
    const struct instance *instance = &world.instance[number];
    if (instance->mesh == WORLD_NO_MESH)
        return false;
    const struct world_mesh *mesh = &world.mesh[instance->mesh];
    const struct geometry *last = &mesh->geometry[mesh->geometry_count - 1];
    if (last->count == 0)
        return false;
    const uint32_t of_instance[] = {instance->mesh, instance->custom, instance->mask,
                                    instance->flags};
    const uint32_t of_query[] = {(uint32_t)query, (uint32_t)world.filter.kind, world.filter.seed,
                                 world.filter.share};
    uint32_t place = mixed(1, of_instance, sizeof of_instance);
    place = mixed_mesh(mixed(place, instance->m, 48), mesh);
    *hit = (struct hit){
        (float)(place >> 8),
        (float)(mixed(mixed(2, &ray[i], sizeof ray[i]), &mode[i], sizeof mode[i]) >> 8),
        (float)(mixed(3, of_query, sizeof of_query) >> 8),
        world.first[number] + last->first + last->count - 1};
    *tag = instance->custom | (number & 1 ? ABI_TAG_FRONT : 0);
    return true;
}

static void a_guest_has_the_world_to_the_bit(void **state)
{
    struct hit hit[RAYS], want;
    uint32_t tag[RAYS], want_tag;
    struct model model;
    (void)state;
    behave("model");
    for (int inside = 0; inside < 2; inside++)
        for (enum query query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
            struct reason reason = {""};
            size_t hits = 0;
            if (play(inside, query, hit, tag, &model, &reason))
                fail_msg("%s", reason.text);
            assert_int_equal(model.formula, TWIN_UNKNOWN); /* transforms are its own */
            for (uint32_t i = 0; i < RAYS; i++) {
                want = (struct hit){.prim = ABI_NO_PRIM};
                want_tag = 0;
                hits += expected(i, query, &want, &want_tag);
                assert_memory_equal(&want, &hit[i], sizeof want);
                assert_int_equal(want_tag, tag[i]);
            }
            assert_true(hits > RAYS / 8);
        }
}

/* Requests that get larger, and smaller again: each is answered as it would be alone. */
static void requests_may_get_larger(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {1, 40, RAYS, 7, RAYS};
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    const struct world_job job = job_of(QUERY_CLOSEST);
    behave("model");
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_bad.so", inside);
        struct hit hit[RAYS], want;
        uint32_t tag[RAYS], want_tag;
        struct trace_report report;
        struct reason reason = {""};
        void *self;
        if (engine_open(engine, &options, &self, &reason) ||
            engine->worlds->prepare_world(self, &job, &reason))
            fail_msg("%s", reason.text);
        for (size_t s = 0; s < ARRAY_COUNT(sizes); s++) {
            if (engine->worlds->trace_world(self, ray, mode, sizes[s], hit, tag, &report, &reason))
                fail_msg("%s", reason.text);
            for (uint32_t i = 0; i < sizes[s]; i++) {
                want = (struct hit){.prim = ABI_NO_PRIM};
                want_tag = 0;
                (void)expected(i, QUERY_CLOSEST, &want, &want_tag);
                assert_memory_equal(&want, &hit[i], sizeof want);
                assert_int_equal(want_tag, tag[i]);
            }
        }
        engine->close(self);
    }
}

static void a_hit_of_what_is_not_there_is_told(void **state)
{
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct model model;
    (void)state;
    behave("world_beyond");
    for (int inside = 0; inside < 2; inside++) {
        struct reason reason = {""};
        assert_int_equal(play(inside, QUERY_CLOSEST, hit, tag, &model, &reason), STATUS_DEVICE);
        assert_non_null(strstr(reason.text, "its answer to ray 2 names instance "));
    }
}

static void a_guest_without_worlds_is_skipped(void **state)
{
    struct hit hit[RAYS];
    uint32_t tag[RAYS];
    struct model model;
    (void)state;
    behave("only_closest");
    for (int inside = 0; inside < 2; inside++) {
        struct reason reason = {""};
        assert_int_equal(play(inside, QUERY_CLOSEST, hit, tag, &model, &reason),
                         STATUS_UNSUPPORTED);
        assert_non_null(strstr(reason.text, "traces scenes, not worlds"));
    }
}

/* Of worlds no formula of ours is true, of a scene the guest's own is, whichever came before. */
static void a_model_is_of_what_is_prepared_last(void **state)
{
    (void)state;
    const struct engine_options options = {.peer_ms = 20000, .peer_mb = UINT32_MAX};
    const struct world_job placed = job_of(QUERY_CLOSEST);
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_open("sphere:n=4", 1, &scene, &reason), STATUS_OK);
    const struct job job = {.scene = &scene, .tri = placed.tri, .query = QUERY_CLOSEST};
    behave("model");
    for (int inside = 0; inside < 2; inside++) {
        const struct engine *engine = engine_way("guest_bad.so", inside);
        void *self;
        if (engine_open(engine, &options, &self, &reason))
            fail_msg("%s", reason.text);
        assert_int_equal(engine_model(engine, self, job.tri).formula, TWIN_WOOP);
        for (int turn = 0; turn < 2; turn++) {
            assert_int_equal(engine->worlds->prepare_world(self, &placed, &reason), STATUS_OK);
            assert_int_equal(engine_model(engine, self, job.tri).formula, TWIN_UNKNOWN);
            assert_int_equal(engine->prepare(self, &job, &reason), STATUS_OK);
            assert_int_equal(engine_model(engine, self, job.tri).formula, TWIN_WOOP);
        }
        engine->close(self);
    }
    scene_free(&scene);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_guest_has_the_world_to_the_bit),
        cmocka_unit_test(requests_may_get_larger),
        cmocka_unit_test(a_hit_of_what_is_not_there_is_told),
        cmocka_unit_test(a_guest_without_worlds_is_skipped),
        cmocka_unit_test(a_model_is_of_what_is_prepared_last),
    };
    if (guest_host_is_meant(argc, argv))
        return guest_host_main(argv);
    find_folder(argv[0]);
    return cmocka_run_group_tests(tests, make_world, free_world);
}
