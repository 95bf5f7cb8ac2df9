/* What the world of a trial means, told without numbers of meshes, geometries or vertices: each
 * instance has its triangles by the values of their corners. Includes cmocka.h, whose macros must
 * come last. */
#ifndef TESTS_WORLD_MEANING_H
#define TESTS_WORLD_MEANING_H

#include "fuzz/play/trial.h"
#include "ref/base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#define MESHES     4
#define GEOMETRIES 12
#define TRIANGLES  24
#define INSTANCES  5
#define RAYS       4

/* Triangles by their numbers in the world as it was drawn. */
struct shown_geometry {
    uint32_t count, triangle[TRIANGLES];
    bool opaque;
};

struct shown_mesh {
    uint32_t of; /* the mesh that it was, by its number in the world as it was drawn */
    uint32_t count;
    struct shown_geometry sort[GEOMETRIES]; /* a geometry each */
};

struct meaning {
    uint32_t meshes, instances, rays;
    struct shown_mesh mesh[MESHES],
        shown[INSTANCES];           /* what an instance shows; 0 geometries: none */
    struct instance how[INSTANCES]; /* without its mesh */
    struct ray ray[RAYS];
    struct ray_mode mode[RAYS];
    struct filter_rule filter;
};

/* The number that a triangle of `scene` has in the world as it was drawn. */
static inline uint32_t number_of(const struct scene *drawn, const struct scene *scene,
                                 uint32_t triangle)
{
    float is[3][3], was[3][3];
    scene_tri(scene, triangle, is);
    for (uint32_t i = 0; i < drawn->tri_count; i++) {
        scene_tri(drawn, i, was);
        if (memcmp(is, was, sizeof is) == 0)
            return i;
    }
    fail_msg("triangle %u was not in the world before", triangle);
    return 0;
}

static inline struct meaning meaning_of(const struct scene *drawn, const struct fuzz_trial *trial)
{
    struct meaning out = {.meshes = trial_world_meshes(&trial->world)};
    uint32_t at = 0;
    out.instances = trial->world.instance_count;
    out.rays = trial->ray_count;
    out.filter = trial->world.filter;
    for (uint32_t g = 0; g < trial->world.geometry_count; g++) {
        const struct trial_geometry *one = &trial->world.geometry[g];
        struct shown_mesh *mesh = &out.mesh[one->mesh];
        struct shown_geometry *sort = &mesh->sort[mesh->count++];
        mesh->of = one->mesh;
        sort->opaque = one->opaque;
        while (sort->count < one->count)
            sort->triangle[sort->count++] = number_of(drawn, &trial->scene, at++);
    }
    assert_int_equal(at, trial->scene.tri_count);
    for (uint32_t i = 0; i < out.instances; i++) {
        uint32_t mesh = trial->world.instance[i].mesh;
        assert_true(mesh == WORLD_NO_MESH || mesh < out.meshes);
        out.how[i] = trial->world.instance[i];
        out.how[i].mesh = 0;
        if (mesh != WORLD_NO_MESH)
            out.shown[i] = out.mesh[mesh];
    }
    memcpy(out.ray, trial->ray, out.rays * sizeof *out.ray);
    memcpy(out.mode, trial->world.mode, out.rays * sizeof *out.mode);
    return out;
}

/* --- worlds ----------------------------------------------------------------------------------- */

static inline void draw_instances(struct rng *rng, struct trial_world *world, uint32_t meshes)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct instance *one = &world->instance[i];
        uint32_t mesh = rng_below(rng, meshes + 1);
        one->mesh = mesh < meshes ? mesh : WORLD_NO_MESH;
        one->m[0][3] = (float)rng_below(rng, 99);
        one->custom = rng_below(rng, 1u << 20);
        one->mask = rng_below(rng, 256);
        one->flags = rng_below(rng, 16);
        if ((one->flags & ABI_INSTANCE_FORCE_OPAQUE) && (one->flags & ABI_INSTANCE_FORCE_NO_OPAQUE))
            one->flags &= ~ABI_INSTANCE_FORCE_OPAQUE;
    }
}

/* Triangles share vertices, also with those of other meshes; some vertices have none. */
static inline void draw_triangles(struct rng *rng, struct scene *scene)
{
    for (uint32_t v = 0; v < scene->vertex_count; v++)
        for (uint32_t k = 0; k < 3; k++)
            scene->vertex[3 * v + k] = (float)(k == 0 ? v : rng_below(rng, 50));
    for (uint32_t t = 0; t < scene->tri_count; t++) {
        scene->index[3 * t] = t; /* its own: no two triangles are alike */
        scene->index[3 * t + 1] = rng_below(rng, scene->vertex_count);
        scene->index[3 * t + 2] = rng_below(rng, scene->vertex_count);
    }
}

static inline struct fuzz_trial draw(uint64_t index)
{
    struct rng rng = rng_make(11, index);
    struct fuzz_trial out;
    struct trial_geometry geometry[GEOMETRIES];
    uint32_t meshes = 1 + rng_below(&rng, MESHES), count = 0, triangles = 0;
    for (uint32_t m = 0; m < meshes; m++)
        for (uint32_t more = 1 + rng_below(&rng, 3); more > 0; more--) {
            uint32_t size = rng_below(&rng, 3), opaque = rng_below(&rng, 2);
            geometry[count++] = (struct trial_geometry){m, size, opaque};
            triangles += size;
        }
    uint32_t instances = 1 + rng_below(&rng, INSTANCES);
    assert_int_equal(fuzz_trial_make(triangles + 3, triangles, RAYS, &out, NULL), STATUS_OK);
    assert_int_equal(trial_world_make(triangles, count, instances, RAYS, &out.world, NULL),
                     STATUS_OK);
    memcpy(out.world.geometry, geometry, count * sizeof *geometry);
    draw_instances(&rng, &out.world, meshes);
    draw_triangles(&rng, &out.scene);
    for (uint32_t i = 0; i < RAYS; i++) {
        out.ray[i] = (struct ray){{(float)i, 0, 0}, 0, {1, 2, 3}, 4};
        out.world.mode[i].mask = rng_below(&rng, 256);
        out.world.mode[i].flags = 1u << rng_below(&rng, 9);
    }
    out.world.filter = (struct filter_rule){FILTER_CELLS, 2 + rng_below(&rng, 99), 77};
    struct reason reason = {""};
    if (fuzz_trial_check(&out, &reason))
        fail_msg("world %u: %s", (unsigned)index, reason.text);
    return out;
}

/* --- comparison ------------------------------------------------------------------------------- */

static inline bool same_shapes(const struct shown_mesh *a, const struct shown_mesh *b)
{
    bool same = a->count == b->count;
    for (uint32_t g = 0; g < a->count && same; g++) {
        const struct shown_geometry *x = &a->sort[g], *y = &b->sort[g];
        same = x->opaque == y->opaque && x->count == y->count &&
               memcmp(x->triangle, y->triangle, x->count * sizeof *x->triangle) == 0;
    }
    return same;
}

/* What is not the same in both; NULL: nothing. */
static inline const char *differing(const struct meaning *a, const struct meaning *b)
{
    if (a->meshes != b->meshes || a->instances != b->instances || a->rays != b->rays)
        return "how many there are";
    for (uint32_t m = 0; m < a->meshes; m++)
        if (!same_shapes(&a->mesh[m], &b->mesh[m]))
            return "a mesh";
    for (uint32_t i = 0; i < a->instances; i++) {
        if (!same_shapes(&a->shown[i], &b->shown[i]))
            return "what an instance shows";
        if (memcmp(&a->how[i], &b->how[i], sizeof a->how[i]) != 0)
            return "how an instance shows it";
    }
    if (memcmp(a->ray, b->ray, a->rays * sizeof *a->ray) != 0)
        return "a ray";
    if (memcmp(a->mode, b->mode, a->rays * sizeof *a->mode) != 0)
        return "what a ray may meet";
    return memcmp(&a->filter, &b->filter, sizeof a->filter) != 0 ? "the filter" : NULL;
}

#endif
