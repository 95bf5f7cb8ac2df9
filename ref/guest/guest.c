#include "ref/guest/guest.h"

#include "ref/base/text.h"
#include "ref/outside/pipe.h"
#include "ref/outside/shared_object.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_MOST 31

/* A table of version 1 ends before its `move`. */
#define OLD_VERSION 1u
#define OLD_BYTES   offsetof(struct raydiff_engine, move)

/* The name of the first function that the table needs and does not have; NULL: none. */
static const char *missing(const struct raydiff_engine *table)
{
    const bool scenes = table->can & (RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY),
               all = table->can & RAYDIFF_ENGINE_ALL, worlds = table->can & RAYDIFF_ENGINE_WORLDS,
               native = table->can & RAYDIFF_ENGINE_NATIVE,
               moves = table->can & RAYDIFF_ENGINE_MOVE;
    const struct {
        const char *name;
        bool fine;
    } needs[] = {{"open", table->open},
                 {"close", table->close},
                 {"build", table->build || !(scenes || all)},
                 {"trace", table->trace || !(scenes || native)},
                 {"trace_all", table->trace_all || !all},
                 {"build_world", table->build_world || !worlds},
                 {"trace_world", table->trace_world || !worlds},
                 {"rays_make", table->rays_make || !native},
                 {"rays_trace", table->rays_trace || !native},
                 {"hits_read", table->hits_read || !native},
                 {"rays_free", table->rays_free || !native},
                 {"move", !moves || table->move}}; /* which a table of version 1 does not have */
    for (size_t i = 0; i < ARRAY_COUNT(needs); i++)
        if (!needs[i].fine)
            return needs[i].name;
    return NULL;
}

static bool is_old(const struct raydiff_engine *table)
{
    return table->version == OLD_VERSION && table->bytes == OLD_BYTES;
}

enum status guest_check(const char *path, const struct raydiff_engine *table, struct reason *reason)
{
    if (!table)
        return fail(reason, STATUS_INPUT, "%.120s: raydiff_engine() returns NULL", path);
    const bool old = is_old(table);
    const uint32_t known = RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_ANY | RAYDIFF_ENGINE_ALL |
                           RAYDIFF_ENGINE_WORLDS | RAYDIFF_ENGINE_NATIVE |
                           (old ? 0u : RAYDIFF_ENGINE_MOVE);
    if (!old && (table->version != RAYDIFF_ENGINE_VERSION || table->bytes != sizeof *table))
        return fail(reason, STATUS_INPUT,
                    "%.120s: version %u of %u bytes, this raydiff has %u of %zu: compile it with "
                    "its ref/raydiff_engine.h",
                    path, table->version, table->bytes, RAYDIFF_ENGINE_VERSION, sizeof *table);
    if (!object_name_is_fine(table->name, NAME_MOST))
        return fail(reason, STATUS_INPUT,
                    "%.120s: its name must be a letter, then letters, digits and _, at most %d",
                    path, NAME_MOST);
    if (table->can & ~known)
        return fail(reason, STATUS_INPUT, "%.120s: can 0x%x has more than 0x%x", path, table->can,
                    known);
    if (!(table->can & (RAYDIFF_ENGINE_CLOSEST | RAYDIFF_ENGINE_WORLDS)))
        return fail(reason, STATUS_INPUT, "%.120s: can 0x%x has neither CLOSEST nor WORLDS", path,
                    table->can);
    const char *none = missing(table);
    if (none)
        return fail(reason, STATUS_INPUT, "%.120s: it has no %s(), which can 0x%x needs", path,
                    none, table->can);
    return STATUS_OK;
}

enum status guest_load(const char *path, struct guest *out, struct reason *reason)
{
    *out = (struct guest){.handle = NULL};
    if (strlen(path) >= sizeof out->path)
        return fail(reason, STATUS_INPUT, "%.60s...: a path of over %d characters", path,
                    GUEST_PATH_MOST - 1);
    enum status status = object_check_file(path, reason);
    if (status)
        return status;
    void *handle = object_open(path, reason);
    if (!handle)
        return STATUS_INPUT;
    union {
        void *object;
        const struct raydiff_engine *(*function)(void);
    } found = {.object = dlsym(handle, "raydiff_engine")};
    const struct raydiff_engine *table = found.object ? found.function() : NULL;
    status = found.object ? guest_check(path, table, reason)
                          : fail(reason, STATUS_INPUT,
                                 "%.120s: it does not export raydiff_engine(); in C++ it is "
                                 "declared extern \"C\", as the header does",
                                 path);
    if (status) {
        dlclose(handle);
        return status;
    }
    strcpy(out->path, path);
    out->handle = handle;
    out->table = table;
    if (is_old(table)) {
        memcpy(&out->whole, table, OLD_BYTES);
        out->table = &out->whole;
    }
    return STATUS_OK;
}

/* The status of a call that returned `returned`. */
static enum status told(const struct guest *guest, const char *function, int returned, char *text,
                        struct reason *reason)
{
    text[RAYDIFF_ENGINE_REASON - 1] = '\0';
    const char *why = text[0] ? text : "without a reason";
    switch (returned) {
    case RAYDIFF_ENGINE_OK:
        return STATUS_OK;
    case RAYDIFF_ENGINE_REFUSED:
        return fail(reason, STATUS_REFUSED, "%.80s refused: %s", guest->path, why);
    case RAYDIFF_ENGINE_MEMORY:
        return fail(reason, STATUS_MEMORY, "%.80s: %s() has no memory: %s", guest->path, function,
                    why);
    case RAYDIFF_ENGINE_FAILED:
        return fail(reason, STATUS_DEVICE, "%.80s: %s() failed: %s", guest->path, function, why);
    default:
        return fail(reason, STATUS_DEVICE, "%.80s: %s() returned %d, which is no status",
                    guest->path, function, returned);
    }
}

bool guest_can(const struct guest *guest, uint32_t what)
{
    return (guest->table->can & what) == what;
}

enum status guest_open(struct guest *guest, uint32_t threads, struct reason *reason)
{
    const struct raydiff_engine_options options = {sizeof options, threads};
    char text[RAYDIFF_ENGINE_REASON] = "";
    void *self = NULL;
    enum status status =
        told(guest, "open", guest->table->open(&options, &self, text), text, reason);
    if (!status && !self)
        status =
            fail(reason, STATUS_DEVICE, "%.80s: open() succeeded and gave no tracer", guest->path);
    guest->self = status ? NULL : self;
    return status == STATUS_REFUSED ? STATUS_UNSUPPORTED : status;
}

void guest_close(struct guest *guest)
{
    if (guest->self)
        guest->table->close(guest->self);
    if (guest->handle)
        dlclose(guest->handle);
    *guest = (struct guest){.handle = NULL};
}

struct raydiff_engine_model guest_promise(const struct guest *guest)
{
    struct raydiff_engine_model out = {.formula = RAYDIFF_ENGINE_UNKNOWN};
    if (guest->table->model)
        guest->table->model(guest->self, &out);
    return out;
}

enum status guest_model(const struct guest *guest, struct model *out, struct reason *reason)
{
    struct reason why;
    const struct raydiff_engine_model from = guest_promise(guest);
    enum status status = pipe_model(from.formula, from.rounding, from.flags, out, &why);
    if (!status)
        status = pipe_displacement(from.displacement, out, &why);
    return status ? fail(reason, STATUS_DEVICE, "%.80s: its model(): %.200s", guest->path, why.text)
                  : STATUS_OK;
}

struct raydiff_engine_memory guest_memory(const struct guest *guest)
{
    struct raydiff_engine_memory out = {.tree_bytes = 0};
    if (guest->table->memory)
        guest->table->memory(guest->self, &out);
    return out;
}

/* --- calls ------------------------------------------------------------------------------------ */

static enum status cannot(const struct guest *guest, uint32_t what, const char *words,
                          struct reason *reason)
{
    return guest_can(guest, what) ? STATUS_OK
                                  : fail(reason, STATUS_REFUSED,
                                         "%.80s refused: its `can` has no %s", guest->path, words);
}

enum status guest_build(struct guest *guest, const struct raydiff_engine_mesh *mesh,
                        struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    enum status status = cannot(guest, RAYDIFF_ENGINE_CLOSEST, "CLOSEST", reason);
    return status
               ? status
               : told(guest, "build", guest->table->build(guest->self, mesh, text), text, reason);
}

enum status guest_move(struct guest *guest, const struct raydiff_engine_mesh *mesh,
                       struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    enum status status = cannot(guest, RAYDIFF_ENGINE_MOVE, "MOVE", reason);
    return status ? status
                  : told(guest, "move", guest->table->move(guest->self, mesh, text), text, reason);
}

/* Any hits need ANY, or the nearest is one. */
enum status guest_trace(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                        uint32_t query, struct raydiff_engine_hit *hit, struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    const uint32_t as = guest_can(guest, RAYDIFF_ENGINE_ANY) ? query : 0;
    const int returned = guest->table->trace(guest->self, ray, count, as, hit, text);
    return told(guest, "trace", returned, text, reason);
}

enum status guest_trace_all(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                            uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                            struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    enum status status = cannot(guest, RAYDIFF_ENGINE_ALL, "ALL", reason);
    return status ? status
                  : told(guest, "trace_all",
                         guest->table->trace_all(guest->self, ray, count, capacity, hit, hit_count,
                                                 text),
                         text, reason);
}

enum status guest_build_world(struct guest *guest, const struct raydiff_engine_world *world,
                              struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    enum status status = cannot(guest, RAYDIFF_ENGINE_WORLDS, "WORLDS", reason);
    return status ? status
                  : told(guest, "build_world", guest->table->build_world(guest->self, world, text),
                         text, reason);
}

enum status guest_trace_world(struct guest *guest, const struct raydiff_engine_world_ray *ray,
                              size_t count, uint32_t query, struct raydiff_engine_world_hit *hit,
                              struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    const int returned = guest->table->trace_world(guest->self, ray, count, query, hit, text);
    return told(guest, "trace_world", returned, text, reason);
}

enum status guest_rays_make(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                            uint32_t query, void **rays, struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    const uint32_t as = guest_can(guest, RAYDIFF_ENGINE_ANY) ? query : 0;
    *rays = NULL;
    const int returned = guest->table->rays_make(guest->self, ray, count, as, rays, text);
    return told(guest, "rays_make", returned, text, reason);
}

enum status guest_rays_trace(struct guest *guest, void *rays, struct reason *reason)
{
    char text[RAYDIFF_ENGINE_REASON] = "";
    return told(guest, "rays_trace", guest->table->rays_trace(guest->self, rays, text), text,
                reason);
}

/* --- worlds ----------------------------------------------------------------------------------- */

static const void *skip(const char **at, size_t bytes)
{
    const char *from = *at;
    *at += bytes;
    return from;
}

struct raydiff_engine_world_mesh *guest_world(const char *words, uint32_t meshes,
                                              uint32_t instances, struct raydiff_engine_world *out)
{
    struct raydiff_engine_world_mesh *mesh = alloc_zeroed(meshes, sizeof *mesh);
    const uint32_t *filter = skip((const char **)&words, 4 * sizeof *filter);
    *out = (struct raydiff_engine_world){.mesh = mesh,
                                         .mesh_count = meshes,
                                         .instance_count = instances,
                                         .filter_kind = filter[0],
                                         .filter_seed = filter[1],
                                         .filter_share = filter[2]};
    for (uint32_t i = 0; mesh && i < meshes; i++) {
        const uint32_t *head = skip(&words, 4 * sizeof *head);
        struct raydiff_engine_mesh *of = &mesh[i].mesh;
        of->vertex_count = head[0];
        of->triangle_count = head[1];
        mesh[i].geometry_count = head[2];
        of->vertex = skip(&words, 3 * sizeof(float) * (size_t)head[0]);
        of->index = skip(&words, 3 * sizeof(uint32_t) * (size_t)head[1]);
        mesh[i].geometry = skip(&words, sizeof *mesh->geometry * (size_t)head[2]);
    }
    out->instance = (const void *)words;
    return mesh;
}
