/* Trials of worlds: meshes by the recipes of scenes, or a world of scenes/worlds, placed in all the
 * ways that have been hard. Bytes are the same on every machine, see fuzz/gen/gen_sketch.h; worlds
 * of scenes/worlds keep the same rules in double. */
#ifndef FUZZ_GEN_WORLD_H
#define FUZZ_GEN_WORLD_H

#include "fuzz/gen/gen.h"
#include "ref/base/rng.h"

/* Makes the meshes, geometries and instances of a trial that has no world yet, and its filter, with
 * `options->rays` rays that are not aimed yet. Errors: as gen_trial. */
enum status gen_world_draw(struct rng *rng, const struct gen_options *options,
                           struct fuzz_trial *out, struct reason *reason) MUST_USE;

/* Aims its rays at what is placed, and draws what they may meet. Errors: STATUS_MEMORY. */
enum status gen_world_aim(struct rng *rng, struct fuzz_trial *trial,
                          struct reason *reason) MUST_USE;

/* The placed triangles of a trial's world, rounded to float32, for aiming; at most some thousands.
 * The trial's own scene where one is placed beyond float32, or none is. Caller frees it. Errors:
 * STATUS_MEMORY. */
enum status gen_world_placed(const struct fuzz_trial *trial, struct scene *out,
                             struct reason *reason) MUST_USE;

/* Takes over a small world of a random generator of scenes/worlds, of which `name` is then the
 * name. Errors: as gen_world_draw. */
enum status gen_world_of_scenes(struct rng *rng, uint32_t rays, struct fuzz_trial *out,
                                const char **name, struct reason *reason) MUST_USE;

/* Places an instance of a mesh whose box is `box`: the identity, moved, far, scaled, stretched,
 * turned, mirrored, sheared, nearly singular, ... `before` is the instance before it, or NULL:
 * where that is, or touching it. The transform is finite and not singular. */
void gen_place(struct rng *rng, const struct box *box, const struct instance *before,
               struct instance *out);

/* Draws mask, flags and custom index; some instances are then inactive. */
void gen_instance_members(struct rng *rng, uint32_t index, struct instance *out);

/* Draws which candidates count, and its parameters. */
struct filter_rule gen_filter(struct rng *rng);

/* True if the transform is what world_finish takes. */
bool gen_transform_is_good(const struct instance *instance);

/* The box of a mesh of a trial's world; that from -1 to 1 if it has no triangle. */
struct box gen_mesh_box(const struct fuzz_trial *trial, uint32_t mesh);

/* An edit of what only worlds have, appended to the recipe's name: instances, transforms, masks,
 * flags, geometries, filter, what rays may meet. *changed: whether any bit is another one. Errors:
 * STATUS_MEMORY; the trial is then unchanged. */
enum status gen_world_edit(struct rng *rng, struct fuzz_trial *trial, bool *changed,
                           const char **name) MUST_USE;

/* After an edit of the scene: geometries cover it again. */
void gen_world_settle(struct fuzz_trial *trial);

#endif
