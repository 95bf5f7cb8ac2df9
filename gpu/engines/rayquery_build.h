/* Engine `rayquery` and its variants: how a device is opened for one, and how its structures are
 * made. */
#ifndef RAYQUERY_BUILD_H
#define RAYQUERY_BUILD_H

#include "gpu/accel/accel_variant.h"
#include "ref/engine.h"
#include "ref/world/world.h"

/* engine.open of a variant. Errors: as engine.open; STATUS_UNSUPPORTED also a feature, a vertex
 * format or an index type that the device lacks, with its name. */
enum status rayquery_open(const struct engine_options *options, const struct accel_variant *variant,
                          void **self, struct reason *reason) MUST_USE;

/* engine.move of a variant with an update: the structures are built over the vertices of the last
 * prepare or move, then updated. */
enum status rayquery_move(void *self, const struct job *job, struct reason *reason) MUST_USE;

/* The same of a world: world_tracer.move_world. */
enum status rayquery_move_world(void *self, const struct world_job *job,
                                struct reason *reason) MUST_USE;

/* Whether a variant is engine rayquery itself. */
bool rayquery_is_plain(const struct accel_variant *variant);

/* What a world was like before an update; owns its arrays. Zero: not known. */
struct rayquery_past {
    float **vertex; /* of each mesh; NULL: it has none */
    struct instance *instance;
    uint32_t mesh_count, instance_count;
};

/* Keeps a copy of what moves of the world in place of what *past had. Errors: STATUS_MEMORY; then
 * *past is zero. */
enum status rayquery_keep(const struct world *world, struct rayquery_past *past,
                          struct reason *reason) MUST_USE;
void rayquery_forget(struct rayquery_past *past);

/* Makes the structures of a world. `options`: those that the device was opened with, for a second
 * one. `past`: what an update of a variant with one finds; of a world of as many meshes and
 * instances, or NULL. Errors: as vk_accel_make_world; STATUS_LIMIT a vertex that the
 * variant would round, or too many for its indices; as vk_open for the second device. */
enum status rayquery_build(struct vk *vk, const struct vk_options *options,
                           const struct world *world, const struct rayquery_past *past,
                           const struct accel_variant *variant, struct vk_accel **out,
                           struct reason *reason) MUST_USE;

#endif
