#include "ref/base/decimal.h"
#include "scenes/read/world_fields.h"
#include "scenes/read/world_formats.h"

static void put_number(FILE *stream, const char *before, float x)
{
    char text[DECIMAL_TEXT];
    decimal_write_float(x, text);
    fprintf(stream, "%s%s", before, text);
}

/* A key and its numbers, three on a line. */
static void put_vertices(const struct scene *scene, FILE *stream)
{
    fputs("\"vertices\": [", stream);
    for (size_t i = 0; i < 3 * (size_t)scene->vertex_count; i++)
        put_number(stream, i == 0 ? "\n    " : i % 3 ? ", " : ",\n    ", scene->vertex[i]);
    fputs("],\n   ", stream);
}

static void put_indices(const struct scene *scene, FILE *stream)
{
    fputs("\"indices\": [", stream);
    for (size_t i = 0; i < 3 * (size_t)scene->tri_count; i++)
        fprintf(stream, "%s%u", i == 0 ? "\n    " : i % 3 ? ", " : ",\n    ", scene->index[i]);
    fputs("]", stream);
}

static void put_mesh(const struct world_mesh *mesh, FILE *stream)
{
    fputs("  {", stream);
    put_vertices(mesh->scene, stream);
    put_indices(mesh->scene, stream);
    bool plain = mesh->geometry_count == 1 && mesh->geometry[0].opaque;
    for (uint32_t i = 0; i < mesh->geometry_count && !plain; i++)
        fprintf(stream, "%s{\"count\": %u, \"opaque\": %s}",
                i ? ",\n    " : ",\n   \"geometries\": [\n    ", mesh->geometry[i].count,
                mesh->geometry[i].opaque ? "true" : "false");
    fputs(plain ? "}" : "]}", stream);
}

/* True if the transform is the one that is left out, to the bit. */
static bool is_default(const struct instance *instance)
{
    for (int i = 0; i < 12; i++)
        if (float_bits(instance->m[i / 4][i % 4]) != float_bits(i % 5 == 0 ? 1.0f : 0.0f))
            return false;
    return true;
}

static void put_instance(const struct instance *instance, FILE *stream)
{
    if (instance->mesh == WORLD_NO_MESH)
        fputs("  {\"mesh\": null", stream);
    else
        fprintf(stream, "  {\"mesh\": %u", instance->mesh);
    for (int i = 0; i < 12 && !is_default(instance); i++)
        put_number(stream, i ? ", " : ", \"transform\": [", instance->m[i / 4][i % 4]);
    if (!is_default(instance))
        fputc(']', stream);
    put_instance_members(instance, false, stream);
    fputc('}', stream);
}

enum status write_world(const struct world *world, FILE *stream, struct reason *reason)
{
    (void)reason;
    fputs("{\"raydiff_world\": 1,\n \"meshes\": [", stream);
    for (uint32_t i = 0; i < world->mesh_count; i++) {
        fputs(i ? ",\n" : "\n", stream);
        put_mesh(&world->mesh[i], stream);
    }
    fputs("],\n \"instances\": [", stream);
    for (uint32_t i = 0; i < world->instance_count; i++) {
        fputs(i ? ",\n" : "\n", stream);
        put_instance(&world->instance[i], stream);
    }
    fputc(']', stream);
    if (filter_is_told(&world->filter)) {
        fputs(",\n \"filter\": ", stream);
        put_filter(&world->filter, stream);
    }
    fputs("}\n", stream);
    return STATUS_OK;
}
