/* What the files of Embree's worlds share: for embree_worlds.c embree_bare.c and
 * embree_world_*.c only. */
#ifndef EMBREE_WORLD_INNER_H
#define EMBREE_WORLD_INNER_H

#include "ref/engines/embree_inner.h"
#include "ref/world/world.h"

/* Embree aborts on rays in the space of a mesh as it does on rays of the world. Instances that
 * lengthen rays about as much are one class. Embree's masks have 32 bits, those of worlds 8, so
 * each class has 8 bits of its own, and a ray that a class may not be given has none of them. */
#define CLASSES 4u

struct embree_class {
    double growth; /* rays get at most so many times as long; 0: no instance */
    double far;    /* largest coordinate of a translation */
};

struct embree_world {
    const struct world *world; /* borrowed; not read when it is freed */
    RTCScene top;
    RTCScene *mesh; /* mesh_count of them; NULL: no triangles */
    uint32_t mesh_count;
    bool *placed; /* of each instance: `top` has it */
    struct embree_class class[CLASSES];
    bool bare; /* no candidate is tested */
};

/* Embree's mask for a ray; 0 if it meets nothing or is not given to Embree. */
uint32_t embree_mask_for(const struct embree *embree, const struct ray *ray, struct ray_mode mode);

/* The mask that Embree has for an instance, which is added to its class. Errors: STATUS_UNSUPPORTED
 * Embree may abort on every ray that meets it. */
enum status embree_instance_mask(struct embree *embree, uint32_t number, uint32_t *out,
                                 struct reason *reason) MUST_USE;

/* Adds an instance to the top. Errors: the same. */
enum status embree_add_instance(struct embree *embree, uint32_t number,
                                struct reason *reason) MUST_USE;

/* As world_tracer.move_world. */
enum status embree_move_world(void *self, const struct world_job *job,
                              struct reason *reason) MUST_USE;

/* Where Embree's numbers are. Returns false if there is no such triangle. */
bool embree_place_of(const struct world *world, const struct RTCHit *hit, struct place *out);

/* The hit in our terms. Ng_x says which side is seen: 1 the front, 0 the back. */
void embree_take_hit(const struct world *world, const struct RTCHit *from, float t, struct hit *hit,
                     uint32_t *tag);

/* The same of the hit that a ray ended at; of a bare world Ng is still the triangle's. */
void embree_read_hit(const struct embree_world *world, struct RTCRayHit *from, struct hit *hit,
                     uint32_t *tag);

/* Traces rays of a bare world without modes: Embree's structures are filled before and read behind
 * what is timed. Errors: STATUS_MEMORY; as embree_error. */
enum status embree_trace_bare(struct embree *embree, const struct ray *ray, size_t count,
                              struct hit *hit, uint32_t *tag, struct trace_report *report,
                              struct reason *reason) MUST_USE;

#endif
