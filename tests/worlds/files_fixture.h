/* Worlds in tests: bytes to worlds, files that are there or not, and worlds compared to the bit.
 * Include after <cmocka.h>'s own needs and before it. */
#ifndef TESTS_WORLD_FIXTURE_H
#define TESTS_WORLD_FIXTURE_H

#include "ref/base/rng.h"
#include "ref/world/world.h"
#include "scenes/read/world_formats.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct reason reason;

/* A triangle for every scene that a world names, but for "nothing". */
static inline enum status fixture_scene(void *user, const char *spec, struct scene *out,
                                        struct reason *why)
{
    (void)user;
    *out = (struct scene){0};
    if (strcmp(spec, "nothing") == 0) {
        strcpy(why->text, "nothing: No such file");
        return STATUS_INPUT;
    }
    assert_int_equal(scene_make(3, 1, out), STATUS_OK);
    for (uint32_t i = 0; i < 3; i++)
        out->index[i] = i;
    out->vertex[3] = out->vertex[7] = 1;
    return STATUS_OK;
}

/* The file "triangle.bin": three vertices of a triangle; and no other. */
static inline enum status fixture_bytes(void *user, const char *path, char **bytes, size_t *size,
                                        struct reason *why)
{
    static const float corner[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    (void)user;
    *bytes = NULL;
    *size = 0;
    if (strcmp(path, "a triangle.bin") != 0) {
        (void)snprintf(why->text, sizeof why->text, "%.100s: No such file", path);
        return STATUS_INPUT;
    }
    *size = sizeof corner;
    *bytes = malloc(sizeof corner + 1);
    assert_non_null(*bytes);
    memcpy(*bytes, corner, sizeof corner);
    (*bytes)[sizeof corner] = '\0';
    return STATUS_OK;
}

static const struct world_files fixture_files = {fixture_scene, fixture_bytes, NULL};

/* What every reader promises of a world, or of a refusal. */
static inline void check_promise(enum status status, const struct world *world, const char *name)
{
    if (status == STATUS_OK) {
        struct world copy = *world;
        copy.first = NULL;
        assert_int_equal(world_finish(&copy, NULL), STATUS_OK);
        free(copy.first);
        return;
    }
    assert_null(world->mesh);
    assert_null(world->instance);
    assert_null(world->first);
    assert_int_equal(strncmp(reason.text, name, strlen(name)), 0);
    assert_int_equal(reason.text[strlen(name)], ':');
    assert_null(strchr(reason.text, '\n'));
}

typedef enum status fixture_read_fn(const char *bytes, size_t size, struct world *out);

/* Reads a copy, so that a byte read beyond the end is seen by a sanitizer. */
static inline enum status read_copy(fixture_read_fn *read, const char *bytes, size_t size,
                                    const char *name, struct world *out)
{
    char *copy = malloc(size + 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    copy[size] = '\0';
    reason.text[0] = '\0';
    enum status status = read(copy, size, out);
    free(copy);
    check_promise(status, out, name);
    return status;
}

static inline void expect_rule(enum status status, const char *rule)
{
    assert_int_equal(status, STATUS_INPUT);
    if (!strstr(reason.text, rule))
        print_error("'%s' lacks '%s'\n", reason.text, rule);
    assert_non_null(strstr(reason.text, rule));
}

/* The text with the first `old` replaced by `new`; the caller frees it. */
static inline char *changed(const char *text, const char *old, const char *new)
{
    const char *at = strstr(text, old);
    if (!at)
        print_error("no '%s' in the text\n", old);
    assert_non_null(at);
    char *out = malloc(strlen(text) + strlen(new) + 1);
    assert_non_null(out);
    (void)sprintf(out, "%.*s%s%s", (int)(at - text), text, new, at + strlen(old));
    return out;
}

static inline void assert_same_world(const struct world *a, const struct world *b)
{
    assert_int_equal(a->mesh_count, b->mesh_count);
    assert_int_equal(a->instance_count, b->instance_count);
    for (uint32_t i = 0; i < a->mesh_count; i++) {
        const struct scene *one = a->mesh[i].scene, *other = b->mesh[i].scene;
        assert_int_equal(one->vertex_count, other->vertex_count);
        assert_int_equal(one->tri_count, other->tri_count);
        assert_memory_equal(one->vertex, other->vertex, 12 * (size_t)one->vertex_count);
        assert_memory_equal(one->index, other->index, 12 * (size_t)one->tri_count);
        assert_int_equal(a->mesh[i].geometry_count, b->mesh[i].geometry_count);
        for (uint32_t k = 0; k < a->mesh[i].geometry_count; k++) {
            const struct geometry *g = &a->mesh[i].geometry[k], *h = &b->mesh[i].geometry[k];
            assert_int_equal(g->first, h->first);
            assert_int_equal(g->count, h->count);
            assert_int_equal(g->opaque, h->opaque);
        }
    }
    for (uint32_t i = 0; i < a->instance_count; i++) {
        const struct instance *one = &a->instance[i], *other = &b->instance[i];
        assert_memory_equal(one->m, other->m, sizeof one->m);
        assert_int_equal(one->mesh, other->mesh);
        assert_int_equal(one->custom, other->custom);
        assert_int_equal(one->mask, other->mask);
        assert_int_equal(one->flags, other->flags);
        assert_int_equal(a->first[i + 1], b->first[i + 1]);
    }
    assert_int_equal(a->filter.kind, b->filter.kind);
    assert_int_equal(a->filter.seed, b->filter.seed);
    assert_int_equal(a->filter.share, b->filter.share);
}

/* The bytes that a writer makes; the caller frees them. */
typedef enum status fixture_write_fn(const struct world *world, FILE *stream, struct reason *why);
static inline char *written_world(fixture_write_fn *write, const struct world *world, size_t *size)
{
    char *bytes = NULL;
    FILE *stream = open_memstream(&bytes, size);
    assert_non_null(stream);
    reason.text[0] = '\0';
    enum status status = write(world, stream, &reason);
    if (status)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
    assert_int_equal(fclose(stream), 0);
    return bytes;
}

/* A finite float of any bits. */
static inline float wild_float(struct rng *rng)
{
    float x = float_from_bits((uint32_t)rng_u64(rng));
    return float_is_finite(x) ? x : -0.0f;
}

/* A world of random bits: meshes of up to 9 vertices, geometries, instances of any transform that
 * is not singular, filters. None of its geometries is empty, and no mesh. */
static inline void make_wild_world(struct rng *rng, struct world *out)
{
    uint32_t meshes = 1 + rng_below(rng, 3), instances = rng_below(rng, 6);
    *out = (struct world){.mesh_count = meshes, .instance_count = instances};
    out->mesh = alloc_zeroed(meshes, sizeof *out->mesh);
    out->instance = alloc_zeroed(instances, sizeof *out->instance);
    for (uint32_t i = 0; i < meshes; i++) {
        struct world_mesh *mesh = &out->mesh[i];
        uint32_t vertices = 1 + rng_below(rng, 9), triangles = 2 + rng_below(rng, 7);
        uint32_t cut = 1 + rng_below(rng, triangles - 1);
        mesh->scene = alloc_zeroed(1, sizeof *mesh->scene);
        mesh->geometry = alloc_zeroed(2, sizeof *mesh->geometry);
        assert_int_equal(scene_make(vertices, triangles, mesh->scene), STATUS_OK);
        for (uint32_t k = 0; k < 3 * vertices; k++)
            mesh->scene->vertex[k] = wild_float(rng);
        for (uint32_t k = 0; k < 3 * triangles; k++)
            mesh->scene->index[k] = rng_below(rng, vertices);
        mesh->geometry_count = 2;
        mesh->geometry[0] = (struct geometry){0, cut, rng_below(rng, 2) == 0};
        mesh->geometry[1] = (struct geometry){cut, triangles - cut, rng_below(rng, 2) == 0};
    }
    for (uint32_t i = 0; i < instances; i++) {
        struct instance *instance = &out->instance[i];
        uint32_t mesh = rng_below(rng, meshes + 1);
        *instance = (struct instance){.mesh = mesh == meshes ? WORLD_NO_MESH : mesh};
        do
            for (int k = 0; k < 12; k++)
                instance->m[k / 4][k % 4] = wild_float(rng);
        while (instance_det_sign(instance->m) == 0);
        /* Each has its default as often as not, so that every set of them is met. */
        uint32_t told = rng_below(rng, 8);
        instance->custom = told & 1 ? rng_below(rng, ABI_CUSTOM_MOST + 1) : 0;
        instance->mask = told & 2 ? rng_below(rng, 256) : 0xFF;
        instance->flags = told & 4 ? rng_below(rng, 12) : 0; /* not both of the force flags */
    }
    out->filter.kind = (enum filter_kind)rng_below(rng, 4);
    out->filter.seed = (uint32_t)rng_u64(rng);
    out->filter.share = rng_below(rng, 257);
    assert_int_equal(world_finish(out, &reason), STATUS_OK);
}

#endif
