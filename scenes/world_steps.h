/* Worlds that move: the steps of a life cycle whose instances move, or the vertices of whose meshes
 * do. */
#ifndef WORLD_STEPS_H
#define WORLD_STEPS_H

#include "ref/world/world.h"
#include "scenes/life_steps.h"

/* Moves instances, or all meshes, each as motion_apply moves a scene. The world has passed
 * world_finish, and still obeys every rule then, but placed triangles may have to be numbered again
 * (world_finish): an exchange gives an instance another mesh. The result depends on the world, the
 * motion and the seed alone, and is the same on every machine.
 *   An instance whose moved transform would have a determinant of 0, an inverse beyond float32, or
 *   vertices from WORLD_REACH on, if it had none before, keeps its transform; a mesh one of whose
 *   instances would keeps its vertices. Hiding leaves something active, if anything was. Errors:
 * STATUS_MEMORY; then the world is as it was. */
enum status world_motion_apply(const struct step *step, struct world *world,
                               struct reason *reason) MUST_USE;

#define WORLD_REACH 0x1p120

/* Moves `count` worlds on from the first: out[i + 1] is out[i] after step[i]. Vertices, instances
 * and numbers of triangles of each are its own, everything else is the first's
 * (steps_worlds_free). Errors: STATUS_MEMORY; then there is nothing to free. */
enum status steps_worlds(const struct world *first, const struct step *step, uint32_t count,
                         struct world out[LIFE_STEPS_MOST + 1], struct reason *reason) MUST_USE;

/* Frees what it made. */
void steps_worlds_free(struct world world[LIFE_STEPS_MOST + 1], uint32_t count);

#endif
