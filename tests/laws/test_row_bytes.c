/* Bytes that a row tells, counted again from what was packed: of nodes, of items, and of the
 * scene or the meshes only where the storage has no vertices of its own. */
#include "ref/match/match.h"
#include "ref/store.h"
#include "scenes/rays/rays.h"
#include "scenes/rays/world_rays.h"
#include "scenes/worlds.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define COUNT 60u

static struct match_options options_of(const struct tri_store *store)
{
    return (struct match_options){.builder = builder_find("median"),
                                  .build = {.leaf = 2, .eps = BUILD_EPS_DEFAULT},
                                  .store = store,
                                  .box = box_test_find("robust"),
                                  .tri = tri_test_find("mt"),
                                  .query = QUERY_CLOSEST,
                                  .repeats = 1};
}

static uint64_t words_of(const struct packed *packed)
{
    return 4 * ((uint64_t)packed->word_count + packed->item_count);
}

static uint64_t of_mesh(const struct scene *scene)
{
    return 12 * ((uint64_t)scene->vertex_count + scene->tri_count);
}

/* Layouts with items of their own in their nodes cannot be stored otherwise: those are left out. */
static size_t check_scene(const struct scene *scene, const struct ray *ray,
                          const struct tri_store *store)
{
    static const char *const names[] = {"f32", "rf16", "half4", "cwbvh80", "tiny8", "bvh2_u8_node"};
    const struct match_options options = options_of(store);
    struct pool pool = {.options = {.threads = 1, .device = -1}};
    struct match match;
    struct reason reason = {""};
    struct row row;
    size_t seen = 0;
    assert_int_equal(match_make(scene, ray, COUNT, &options, &pool, &match, &reason), STATUS_OK);
    for (size_t l = 0; l < ARRAY_COUNT(names); l++) {
        if (match_pack(&match, layout_find(names[l]), &reason))
            continue;
        match_run(&match, engine_find("cpu"), &row);
        const bool indexed = strcmp(match.packed.store->name, "indexed") == 0;
        assert_int_equal(row.node_bytes, 4 * (uint64_t)match.packed.word_count);
        assert_int_equal(row.node_bytes + row.item_bytes, words_of(&match.packed));
        assert_int_equal(row.scene_bytes, indexed ? of_mesh(scene) : 0);
        seen++;
    }
    match_free(&match);
    pool_free(&pool);
    return seen;
}

static size_t check_world(const struct world *world, const struct tri_store *store)
{
    const struct match_options options = options_of(store);
    struct pool pool = {.options = {.threads = 1, .device = -1}};
    struct match match;
    struct reason reason = {""};
    struct ray *ray;
    struct ray_mode *mode;
    struct row row;
    uint64_t meshes = 0, trees = 0;
    assert_int_equal(
        world_rays_new(world, ray_sets[0], RAY_MODES_MIXED, 1, COUNT, &ray, &mode, &reason),
        STATUS_OK);
    assert_int_equal(match_make_world(world, ray, mode, COUNT, &options, &pool, &match, &reason),
                     STATUS_OK);
    const bool packed = match_pack(&match, layout_find("f32"), &reason) == STATUS_OK;
    if (packed) {
        const struct packed_world *at = &match.packed_world;
        match_run(&match, engine_find("cpu"), &row);
        for (uint32_t i = 0; i < at->tree_count; i++)
            trees += words_of(&at->bottom[i]);
        for (uint32_t i = 0; i < world->mesh_count; i++)
            meshes += of_mesh(world->mesh[i].scene);
        assert_int_equal(row.node_bytes + row.item_bytes,
                         trees + words_of(&at->top) + 64 * (uint64_t)at->entry_count);
        assert_int_equal(row.scene_bytes, strcmp(store->name, "indexed") == 0 ? meshes : 0);
    }
    match_free(&match);
    pool_free(&pool);
    free(ray);
    free(mode);
    return packed;
}

static void a_row_has_the_bytes_of_what_is_packed(void **state)
{
    (void)state;
    struct scene scene;
    struct world world;
    struct reason reason = {""};
    static struct ray ray[COUNT];
    size_t scenes = 0, worlds = 0, stores = 0;
    assert_int_equal(scene_open("grid:n=6", 1, &scene, &reason), STATUS_OK); /* on grids, too */
    assert_int_equal(world_open("mixed", 1, &world, &reason), STATUS_OK);
    assert_int_equal(ray_set_make(ray_sets[0], &scene, 1, COUNT, ray, &reason), STATUS_OK);
    for (; tri_stores[stores]; stores++) {
        const size_t some = check_scene(&scene, ray, tri_stores[stores]);
        scenes += some > 0;
        worlds += check_world(&world, tri_stores[stores]);
    }
    print_message("%zu of %zu storages with scenes, %zu with worlds\n", scenes, stores, worlds);
    assert_true(scenes >= 6 && worlds >= 4);
    world_free(&world);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_row_has_the_bytes_of_what_is_packed)};
    return cmocka_run_group_tests_name("bytes of rows", tests, NULL, NULL);
}
