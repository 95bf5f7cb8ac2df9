/* A guest is a tracer in a shared object (ref/raydiff_engine.h), loaded into this process. What it
 * returns is checked before it is used; that it crashes or hangs is not prevented here:
 * ref/guest/guest_host.h runs it in a process of its own. */
#ifndef GUEST_H
#define GUEST_H

#include "ref/raydiff_engine.h"
#include "ref/scene/scene.h"
#include "ref/twin/model.h"

#define GUEST_PATH_MOST 160

struct guest {
    char path[GUEST_PATH_MOST]; /* as named, for reasons */
    void *handle;
    const struct raydiff_engine *table;
    struct raydiff_engine whole; /* of a table of version 1: the same with what it lacks */
    void *self;                  /* NULL: not open */
};

/* Loads the object and checks its table. *out must stay where it is until guest_close. Errors:
 * STATUS_INPUT "PATH: rule": no regular file, no shared object, no raydiff_engine(), another
 * version, a function that is missing. */
enum status guest_load(const char *path, struct guest *out, struct reason *reason) MUST_USE;

#define GUEST_TRY_MS 10000u

/* Loads the object in a child process, and ends that, after `ms` at the latest. Errors: as
 * guest_load; STATUS_DEVICE it crashed or did not end. */
enum status guest_try(const char *path, uint32_t ms, struct reason *reason) MUST_USE;

/* The check of guest_load. */
enum status guest_check(const char *path, const struct raydiff_engine *table,
                        struct reason *reason) MUST_USE;

/* Makes its tracer. Errors: STATUS_UNSUPPORTED refused, STATUS_MEMORY, STATUS_DEVICE, each with the
 * guest's own reason. */
enum status guest_open(struct guest *guest, uint32_t threads, struct reason *reason) MUST_USE;

/* Closes the tracer and unloads the object. Does nothing on zero. */
void guest_close(struct guest *guest);

bool guest_can(const struct guest *guest, uint32_t what);

/* What it promises; the numbers are its own. */
struct raydiff_engine_model guest_promise(const struct guest *guest);

/* The same as the judge takes it. Errors: STATUS_DEVICE an unknown number. */
enum status guest_model(const struct guest *guest, struct model *out,
                        struct reason *reason) MUST_USE;

/* What it says that it holds; 0: not known. */
struct raydiff_engine_memory guest_memory(const struct guest *guest);

/* Calls of the table. Errors: STATUS_REFUSED, STATUS_MEMORY, STATUS_DEVICE (also for a number that
 * is no status), with the guest's reason behind the name of the function. STATUS_REFUSED also for
 * what its `can` does not have. */
enum status guest_build(struct guest *guest, const struct raydiff_engine_mesh *mesh,
                        struct reason *reason) MUST_USE;
enum status guest_move(struct guest *guest, const struct raydiff_engine_mesh *mesh,
                       struct reason *reason) MUST_USE;
enum status guest_trace(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                        uint32_t query, struct raydiff_engine_hit *hit,
                        struct reason *reason) MUST_USE;
enum status guest_trace_all(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                            uint32_t capacity, struct raydiff_engine_hit *hit, uint32_t *hit_count,
                            struct reason *reason) MUST_USE;
enum status guest_build_world(struct guest *guest, const struct raydiff_engine_world *world,
                              struct reason *reason) MUST_USE;
enum status guest_trace_world(struct guest *guest, const struct raydiff_engine_world_ray *ray,
                              size_t count, uint32_t query, struct raydiff_engine_world_hit *hit,
                              struct reason *reason) MUST_USE;

/* Rays in the guest's own form: made, traced as often as wanted, read, freed. */
enum status guest_rays_make(struct guest *guest, const struct raydiff_engine_ray *ray, size_t count,
                            uint32_t query, void **rays, struct reason *reason) MUST_USE;
enum status guest_rays_trace(struct guest *guest, void *rays, struct reason *reason) MUST_USE;

/* A world from the words of pipe_world_words (ref/outside/pipe_world.h), which it points into.
 * Its meshes are freed by the caller. NULL: no memory. */
struct raydiff_engine_world_mesh *guest_world(const char *words, uint32_t meshes,
                                              uint32_t instances,
                                              struct raydiff_engine_world *out) MUST_USE;

#endif
