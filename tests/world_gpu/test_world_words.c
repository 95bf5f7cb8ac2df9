/* What shaders read of a world, held to the world itself: whatever order meshes of few and of many
 * geometries and triangles are in, each instance finds those of its own mesh. The device is that of
 * tests/gpu/fake_vulkan.h. */
#include "gpu/trace/world_upload.h"
#include "ref/base/rng.h"
#include "tests/gpu/fake_work.h"
#include "tests/two_level/two_level_fixture.h"
#include "tests/two_level/braid_stand.h"
#include "tests/two_level/world_stand.h"

#define WORLDS 40
#define QUAD   4u /* words */

static struct vk *vk;

/* Meshes of drawn sizes, some empty; instances of drawn meshes, some of none. */
static struct world world_drawn(uint64_t seed)
{
    struct rng rng = rng_make(seed, 1);
    const uint32_t meshes = 1 + rng_below(&rng, 5), instances = 1 + rng_below(&rng, 9);
    struct world world = fixture_room(meshes, instances);
    for (uint32_t m = 0; m < world.mesh_count; m++) {
        char spec[40];
        const uint32_t some = rng_below(&rng, 4);
        (void)snprintf(spec, sizeof spec, "soup:n=%u", some * rng_below(&rng, 20));
        fixture_mesh(&world, m, spec, 1 + rng_below(&rng, 5));
    }
    for (uint32_t i = 0; i < world.instance_count; i++) {
        const bool none = rng_below(&rng, 5) == 0;
        world.instance[i].mesh = none ? WORLD_NO_MESH : rng_below(&rng, world.mesh_count);
        world.instance[i].flags = rng_below(&rng, 12);
    }
    world.filter = (struct filter_rule){FILTER_TRIANGLES, (uint32_t)seed, 100};
    fixture_finish(&world);
    return world;
}

/* All words of a buffer. */
static uint32_t *words_of(struct vk_buffer *buffer)
{
    struct reason reason = {""};
    const uint64_t bytes = vk_buffer_bytes(buffer);
    uint32_t *word = calloc(bytes / 4 + 1, 4);
    assert_non_null(word);
    gpu_must(vk_buffer_read(vk, buffer, 0, word, bytes, &reason), &reason);
    return word;
}

/* The quads from number `first` of the geometries on are those of the mesh. */
static void has_geometries(const uint32_t *geometries, uint32_t first, uint32_t count,
                           const struct world_mesh *mesh)
{
    assert_int_equal(count, mesh->geometry_count);
    for (uint32_t g = 0; g < count; g++) {
        const uint32_t *at = geometries + (size_t)QUAD * (first + g);
        assert_int_equal(at[0], mesh->geometry[g].first);
        assert_int_equal(at[1], mesh->geometry[g].count);
        assert_int_equal(at[2], mesh->geometry[g].opaque);
        assert_int_equal(at[3], 0);
    }
}

static void has_filter(const struct world_push *push, const struct world *world)
{
    assert_int_equal(push->instance_count, world->instance_count);
    assert_int_equal(push->filter_kind, world->filter.kind);
    assert_int_equal(push->filter_seed, world->filter.seed);
    assert_int_equal(push->filter_share, world->filter.share);
}

static void drivers_trees_have_their_geometries(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < WORLDS; seed++) {
        struct world world = world_drawn(seed);
        struct reason reason = {""};
        struct world_push push;
        struct vk_buffer *buffer = NULL;
        uint64_t quads = world.instance_count;
        gpu_must(world_upload_query(vk, &world, &buffer, &push, &reason), &reason);
        for (uint32_t m = 0; m < world.mesh_count; m++)
            quads += world.mesh[m].geometry_count;
        assert_int_equal(vk_buffer_bytes(buffer), quads * ABI_WORLD_QUAD_BYTES);
        has_filter(&push, &world);
        uint32_t *word = words_of(buffer);
        for (uint32_t i = 0; i < world.instance_count; i++) {
            const uint32_t *at = word + (size_t)QUAD * (push.records + i);
            const struct instance *instance = &world.instance[i];
            if (instance->mesh == WORLD_NO_MESH) {
                assert_int_equal(at[2], 0);
                continue;
            }
            assert_int_equal(at[0], world.first[i]);
            assert_int_equal(at[3], instance->flags);
            has_geometries(word + (size_t)QUAD * push.geometries, at[1], at[2],
                           &world.mesh[instance->mesh]);
        }
        free(word);
        vk_buffer_free(vk, buffer);
        world_free(&world);
    }
}

/* The quads of tree `t`, and what they refer to in the other buffers. */
static void has_tree(const struct world *world, const struct packed_world *packed, uint32_t t,
                     const struct world_push *push, uint32_t *const word[WORLD_BINDINGS])
{
    const uint32_t *at = word[ABI_BIND_WORLD] + (size_t)QUAD * ABI_WORLD_TREE * t;
    const struct packed *tree = t ? &packed->bottom[t - 1] : &packed->top;
    assert_int_equal(at[3], tree->root);
    assert_int_equal(at[4], tree->node_count > 0 ? tree->ref_count : 0);
    assert_int_equal(at[5], tree->item_count);
    if (tree->word_count)
        assert_memory_equal(word[ABI_BIND_NODES] + at[0], tree->word, 4 * tree->word_count);
    if (tree->item_count)
        assert_memory_equal(word[ABI_BIND_ITEMS] + at[1], tree->item, 4 * tree->item_count);
    if (t == 0) {
        assert_int_equal(at[6], packed->entry_count);
        return;
    }
    const struct world_mesh *mesh = &world->mesh[packed->mesh[t - 1]];
    assert_int_equal(at[6], mesh->scene->tri_count);
    has_geometries(word[ABI_BIND_WORLD] + (size_t)QUAD * push->geometries, at[7], at[8], mesh);
    for (uint32_t i = 0; i < at[6]; i++) {
        float tri[3][3];
        scene_tri(mesh->scene, i, tri);
        const uint32_t *corners = word[ABI_BIND_TRIS] + (size_t)ABI_TRI_FLOATS * (at[2] + i);
        assert_memory_equal(corners, tri, sizeof tri);
    }
}

static void trees_refer_to_what_is_theirs(void **state)
{
    (void)state;
    static const uint32_t bindings[] = {ABI_BIND_NODES, ABI_BIND_ITEMS, ABI_BIND_TRIS,
                                        ABI_BIND_WORLD};
    static const char *const names[] = {"f32", "rf16", "half4"};
    struct vk_buffer *buffer[WORLD_BINDINGS] = {NULL}; /* kept from world to world */
    size_t parts = 0;
    for (uint64_t seed = 0; seed < WORLDS; seed++) {
        struct world world = world_drawn(seed);
        /* Of half of them instances are opened, so that entries are parts. */
        struct packed_world packed = seed % 2 ? stand_world(&world, names[seed % 3])
                                              : braid_world(&world, "median", names[seed % 3], 60);
        parts += packed.entry_count > world.instance_count;
        const struct world_job job = {.world = &world, .packed = &packed};
        struct reason reason = {""};
        struct world_push push;
        uint32_t *word[WORLD_BINDINGS] = {NULL};
        gpu_must(world_upload(vk, &job, buffer, &push, &reason), &reason);
        for (size_t b = 0; b < ARRAY_COUNT(bindings); b++)
            word[bindings[b]] = words_of(buffer[bindings[b]]);
        has_filter(&push, &world);
        assert_int_equal(push.entry_count, packed.entry_count);
        assert_memory_equal(word[ABI_BIND_WORLD] + (size_t)QUAD * push.records, packed.record,
                            packed.entry_count * sizeof *packed.record);
        for (uint32_t t = 0; t <= packed.tree_count; t++)
            has_tree(&world, &packed, t, &push, word);
        for (size_t b = 0; b < ARRAY_COUNT(bindings); b++)
            free(word[bindings[b]]);
        packed_world_free(&packed);
        world_free(&world);
    }
    assert_true(parts > WORLDS / 4);
    for (size_t b = 0; b < WORLD_BINDINGS; b++)
        vk_buffer_free(vk, buffer[b]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(drivers_trees_have_their_geometries),
        cmocka_unit_test(trees_refer_to_what_is_theirs),
    };
    const struct vk_options options = fake_options();
    fake_reset();
    vk = must_open(&options);
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    must_close(vk);
    return failed;
}
