/* Lines that only worlds have. */
#include "ref/outside/pipe_text_inner.h"

#include "ref/outside/pipe.h"
#include "ref/outside/pipe_world.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

const char *pipe_filter_name(uint32_t kind)
{
    static const char *const names[] = {[FILTER_ALL] = "all",
                                        [FILTER_NONE] = "none",
                                        [FILTER_TRIANGLES] = "triangles",
                                        [FILTER_CELLS] = "cells"};
    return kind < ARRAY_COUNT(names) ? names[kind] : NULL;
}

static const char *opacity_name(uint32_t i)
{
    static const char *const names[] = {"opaque", "filtered"};
    return i < ARRAY_COUNT(names) ? names[i] : NULL;
}

static const char *side_name(uint32_t i)
{
    static const char *const names[] = {"back", "front"};
    return i < ARRAY_COUNT(names) ? names[i] : NULL;
}

static struct world_mesh *last_mesh(struct pipe_reading *r)
{
    return &r->out->world.mesh[r->out->world.mesh_count - 1];
}

/* Triangles that the geometries of the last mesh have. */
static uint32_t covered(struct pipe_reading *r)
{
    const struct world_mesh *mesh = last_mesh(r);
    if (mesh->geometry_count == 0)
        return 0;
    const struct geometry *last = &mesh->geometry[mesh->geometry_count - 1];
    return last->first + last->count;
}

enum status pipe_text_end_mesh(struct pipe_reading *r)
{
    if (!r->world.open)
        return STATUS_OK;
    struct world_mesh *mesh = last_mesh(r);
    r->world.open = false;
    *mesh->scene = (struct scene){.vertex = r->mesh.vertex,
                                  .index = r->mesh.index,
                                  .vertex_count = (uint32_t)r->mesh.vertex_count,
                                  .tri_count = (uint32_t)r->mesh.tri_count};
    r->mesh = (struct mesh){0};
    if (mesh->geometry_count == 0)
        return scan_fail(&r->scan, r->reason, "mesh %u ends without a 'g' line",
                         r->out->world.mesh_count - 1);
    if (covered(r) != mesh->scene->tri_count)
        return scan_fail(&r->scan, r->reason,
                         "mesh %u ends with %u triangles, of which its geometries have %u",
                         r->out->world.mesh_count - 1, mesh->scene->tri_count, covered(r));
    return STATUS_OK;
}

static enum status read_mesh(struct pipe_reading *r)
{
    struct world *world = &r->out->world;
    enum status status = pipe_text_end_mesh(r);
    if (status)
        return status;
    if (array_reserve(&world->mesh, &r->world.capacity, (size_t)world->mesh_count + 1,
                      sizeof *world->mesh))
        return pipe_text_no_memory(r);
    struct scene *scene = alloc_zeroed(1, sizeof *scene);
    if (!scene)
        return pipe_text_no_memory(r);
    world->mesh[world->mesh_count++] = (struct world_mesh){.scene = scene};
    r->world.open = true;
    r->world.geometry_capacity = 0;
    return STATUS_OK;
}

static enum status read_geometry(struct pipe_reading *r)
{
    uint32_t count;
    enum status status = pipe_text_number(r, "triangles", UINT32_MAX - 1, &count);
    if (status)
        return status;
    const uint32_t opacity = pipe_text_word(r, opacity_name), first = covered(r);
    if (!opacity_name(opacity))
        return scan_fail(&r->scan, r->reason, "a geometry is opaque or filtered");
    if (count > r->mesh.tri_count - first)
        return scan_fail(&r->scan, r->reason,
                         "a geometry of %u triangles, but only %zu are before this line in no "
                         "other",
                         count, r->mesh.tri_count - first);
    struct world_mesh *mesh = last_mesh(r);
    if (array_reserve(&mesh->geometry, &r->world.geometry_capacity,
                      (size_t)mesh->geometry_count + 1, sizeof *mesh->geometry))
        return pipe_text_no_memory(r);
    mesh->geometry[mesh->geometry_count++] = (struct geometry){first, count, opacity == 0};
    return STATUS_OK;
}

/* The number of a mesh; "-": none. */
static enum status read_mesh_number(struct pipe_reading *r, uint32_t *out)
{
    struct scan ahead = r->scan;
    const char *word;
    *out = WORLD_NO_MESH;
    if (scan_word(&ahead, &word) == 1 && *word == '-') {
        r->scan = ahead;
        return STATUS_OK;
    }
    return pipe_text_number(r, "mesh", WORLD_NO_MESH - 1, out);
}

static enum status read_instance(struct pipe_reading *r)
{
    static const char *const what[] = {"M00", "M01", "M02", "T0",  "M10", "M11",
                                       "M12", "T1",  "M20", "M21", "M22", "T2"};
    struct world *world = &r->out->world;
    struct instance one;
    struct reason why = {""};
    enum status status = pipe_text_end_mesh(r);
    if (!status)
        status = read_mesh_number(r, &one.mesh);
    if (!status)
        status = pipe_text_number(r, "custom index", ABI_CUSTOM_MOST, &one.custom);
    if (!status)
        status = pipe_text_number(r, "mask", 0xFF, &one.mask);
    if (!status)
        status = pipe_text_number(r, "flags", ABI_INSTANCE_FLAGS, &one.flags);
    if (!status)
        status = pipe_text_floats(r, what, &one.m[0][0], 12);
    if (status)
        return status;
    if (array_reserve(&world->instance, &r->world.instance_capacity,
                      (size_t)world->instance_count + 1, sizeof one))
        return pipe_text_no_memory(r);
    world->instance[world->instance_count] = one;
    if (world_check_instance(world, world->instance_count, &why))
        return scan_fail(&r->scan, r->reason, "%s", why.text);
    world->instance_count++;
    return STATUS_OK;
}

static enum status read_filter(struct pipe_reading *r)
{
    struct filter_rule *filter = &r->out->world.filter;
    const uint32_t kind = pipe_text_word(r, pipe_filter_name);
    if (!pipe_filter_name(kind))
        return scan_fail(&r->scan, r->reason, "filters are all, none, triangles, cells");
    filter->kind = (enum filter_kind)kind;
    enum status status = pipe_text_number(r, "seed", UINT32_MAX, &filter->seed);
    return status ? status : pipe_text_number(r, "share", 256, &filter->share);
}

/* v and t lines are read as those of scenes, but in a mesh. */
static enum status check_open(struct pipe_reading *r, const char *word, size_t length)
{
    if (r->world.open)
        return STATUS_OK;
    return scan_fail(&r->scan, r->reason, "a line '%.*s' in no mesh: 'mesh' begins one",
                     (int)length, word);
}

bool pipe_text_world_line(struct pipe_reading *r, const char *word, size_t length,
                          enum status *status)
{
    static const struct {
        const char *name;
        enum status (*read)(struct pipe_reading *r);
        bool in_mesh;
    } lines[] = {{"v", NULL, true},           {"t", NULL, true},
                 {"g", read_geometry, true},  {"mesh", read_mesh, false},
                 {"i", read_instance, false}, {"filter", read_filter, false},
                 {"r", NULL, false}};
    *status = STATUS_OK;
    if (r->out->version != PIPE_VERSION_WORLD)
        return false;
    for (size_t i = 0; i < ARRAY_COUNT(lines); i++) {
        if (strlen(lines[i].name) != length || memcmp(word, lines[i].name, length) != 0)
            continue;
        if (lines[i].in_mesh)
            *status = check_open(r, word, length);
        else if (!lines[i].read) /* a ray */
            *status = pipe_text_end_mesh(r);
        if (!*status && lines[i].read)
            *status = lines[i].read(r);
        return *status || lines[i].read;
    }
    return false;
}

enum status pipe_text_mode(struct pipe_reading *r)
{
    struct ray_mode mode;
    struct reason why = {""};
    enum status status = pipe_text_number(r, "mask", 0xFF, &mode.mask);
    if (!status)
        status = pipe_text_number(r, "flags", ABI_RAY_FLAGS, &mode.flags);
    if (status)
        return status;
    if (ray_mode_check(mode, &why))
        return scan_fail(&r->scan, r->reason, "%s", why.text);
    if (array_reserve(&r->out->mode, &r->mode_capacity, r->out->ray_count + 1, sizeof mode))
        return pipe_text_no_memory(r);
    r->out->mode[r->out->ray_count] = mode;
    return STATUS_OK;
}

enum status pipe_text_world_hit(struct pipe_reading *r)
{
    static const char *const what[] = {"t", "u", "v"};
    struct pipe_world_hit hit = {.custom = PIPE_NO_CUSTOM};
    struct hit taken = {.prim = 0};
    struct reason why = {""};
    uint32_t tag = 0;
    float n[3];
    enum status status = pipe_text_floats(r, what, n, 3);
    if (!status)
        status = pipe_text_number(r, "instance", UINT32_MAX - 1, &hit.instance);
    if (!status)
        status = pipe_text_number(r, "geometry", UINT32_MAX - 1, &hit.geometry);
    if (!status)
        status = pipe_text_number(r, "triangle", UINT32_MAX - 1, &hit.triangle);
    if (status)
        return status;
    hit.t = n[0], hit.u = n[1], hit.v = n[2];
    hit.side = pipe_text_word(r, side_name);
    if (!side_name(hit.side))
        return scan_fail(&r->scan, r->reason, "behind the triangle stands front or back");
    scan_blanks(&r->scan);
    if (!scan_line_done(&r->scan))
        status = pipe_text_number(r, "custom index", ABI_CUSTOM_MOST, &hit.custom);
    if (status)
        return status;
    if (r->limits->world && pipe_world_take(r->limits->world, &hit, false, &taken, &tag, &why))
        return scan_fail(&r->scan, r->reason, "an answer to ray %zu that %s", r->out->hit_count,
                         why.text);
    return pipe_text_add_hit(r, taken, tag);
}
