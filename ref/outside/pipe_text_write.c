/* Requests as text, and the hash that answers to them are known by. */
#include "ref/outside/pipe_text.h"

#include "ref/base/decimal.h"
#include "ref/base/ray_text.h"
#include "ref/outside/pipe.h"
#include "ref/outside/pipe_world.h"

#include <inttypes.h>
#include <stdlib.h>

#define HASH_START UINT64_C(0xCBF29CE484222325)

static uint64_t hash_more(uint64_t hash, const void *bytes, size_t size)
{
    const unsigned char *at = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ at[i]) * UINT64_C(0x100000001B3);
    return hash;
}

uint64_t pipe_hash(const struct scene *scene, const struct ray *ray, size_t ray_count,
                   enum query query)
{
    uint64_t hash = HASH_START;
    const uint32_t head[] = {scene->vertex_count, scene->tri_count, (uint32_t)query};
    hash = hash_more(hash, head, sizeof head);
    hash = hash_more(hash, scene->vertex, 3 * sizeof(float) * (size_t)scene->vertex_count);
    hash = hash_more(hash, scene->index, 3 * sizeof(uint32_t) * (size_t)scene->tri_count);
    return hash_more(hash, ray, ray_count * sizeof *ray);
}

uint64_t pipe_hash_world(const struct world *world, const struct ray *ray,
                         const struct ray_mode *mode, size_t ray_count, enum query query)
{
    const uint32_t head[] = {PIPE_VERSION_WORLD, world->mesh_count, world->instance_count,
                             (uint32_t)query};
    size_t size;
    char *words = pipe_world_words(world, &size);
    if (!words)
        return 0;
    uint64_t hash = hash_more(hash_more(HASH_START, head, sizeof head), words, size);
    free(words);
    hash = hash_more(hash, ray, ray_count * sizeof *ray);
    return hash_more(hash, mode, ray_count * sizeof *mode);
}

static void put(FILE *stream, float x, bool decimal)
{
    char text[32];
    if (decimal && float_is_finite(x))
        decimal_write_float(x, text);
    else
        float_text_write(x, text);
    fputc(' ', stream);
    fputs(text, stream);
}

static void put_floats(FILE *stream, const float *x, int count, bool decimal)
{
    for (int i = 0; i < count; i++)
        put(stream, x[i], decimal);
}

static void put_head(FILE *stream, unsigned version, const struct pipe_from *from, enum query query)
{
    fprintf(stream, "raydiff %u\n", version);
    if (from)
        fprintf(stream, "from %016" PRIx64 " %" PRIu64 " %" PRIu64 " %s%s%s %s\n", from->hash,
                from->seed, from->count, from->rays, from->modes[0] ? " modes=" : "", from->modes,
                from->spec);
    fprintf(stream, "query %s\n", query_name(query));
}

static void put_scene(FILE *stream, const struct scene *scene, bool decimal)
{
    for (size_t i = 0; i < scene->vertex_count; i++) {
        fputc('v', stream);
        put_floats(stream, scene->vertex + 3 * i, 3, decimal);
        fputc('\n', stream);
    }
    for (size_t i = 0; i < scene->tri_count; i++)
        fprintf(stream, "t %u %u %u\n", scene->index[3 * i], scene->index[3 * i + 1],
                scene->index[3 * i + 2]);
}

static void put_ray(FILE *stream, const struct ray *r, bool decimal)
{
    const float x[8] = {r->org[0], r->org[1], r->org[2], r->tmin,
                        r->dir[0], r->dir[1], r->dir[2], r->tmax};
    fputc('r', stream);
    put_floats(stream, x, 8, decimal);
}

void pipe_text_write(FILE *stream, const struct pipe_from *from, const struct scene *scene,
                     const struct ray *ray, size_t ray_count, enum query query, bool decimal)
{
    put_head(stream, PIPE_VERSION, from, query);
    put_scene(stream, scene, decimal);
    for (size_t i = 0; i < ray_count; i++) {
        put_ray(stream, &ray[i], decimal);
        fputc('\n', stream);
    }
    fputs("end\n", stream);
}

static void put_mesh(FILE *stream, const struct world_mesh *mesh, bool decimal)
{
    fputs("mesh\n", stream);
    put_scene(stream, mesh->scene, decimal);
    for (uint32_t i = 0; i < mesh->geometry_count; i++)
        fprintf(stream, "g %u %s\n", mesh->geometry[i].count,
                mesh->geometry[i].opaque ? "opaque" : "filtered");
}

static void put_instance(FILE *stream, const struct instance *one, bool decimal)
{
    if (one->mesh == WORLD_NO_MESH)
        fputs("i -", stream);
    else
        fprintf(stream, "i %u", one->mesh);
    fprintf(stream, " %u %u %u", one->custom, one->mask, one->flags);
    for (int row = 0; row < 3; row++)
        put_floats(stream, one->m[row], 4, decimal);
    fputc('\n', stream);
}

void pipe_text_write_world(FILE *stream, const struct pipe_from *from, const struct world *world,
                           const struct ray *ray, const struct ray_mode *mode, size_t ray_count,
                           enum query query, bool decimal)
{
    const struct filter_rule *filter = &world->filter;
    put_head(stream, PIPE_VERSION_WORLD, from, query);
    fprintf(stream, "filter %s %u %u\n", pipe_filter_name((uint32_t)filter->kind), filter->seed,
            filter->share);
    for (uint32_t i = 0; i < world->mesh_count; i++)
        put_mesh(stream, &world->mesh[i], decimal);
    for (uint32_t i = 0; i < world->instance_count; i++)
        put_instance(stream, &world->instance[i], decimal);
    for (size_t i = 0; i < ray_count; i++) {
        put_ray(stream, &ray[i], decimal);
        fprintf(stream, " %u %u\n", mode[i].mask, mode[i].flags);
    }
    fputs("end\n", stream);
}
