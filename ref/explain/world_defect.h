/* What tracers of worlds get wrong: for each such defect a tracer that has it and no other, so that
 * its answers can be held beside those of an engine. */
#ifndef WORLD_DEFECT_H
#define WORLD_DEFECT_H

#include "ref/engine.h"
#include "ref/world/world.h"

enum world_cause {
    WORLD_CAUSE_NONE,      /* nothing is WRONG */
    WORLD_CAUSE_TRANSFORM, /* rays enter instances by another transform, or leave with another t */
    WORLD_CAUSE_BOX,       /* the box of an instance does not contain it */
    WORLD_CAUSE_MASK,
    WORLD_CAUSE_CULL, /* culling by facing, and which side is reported */
    WORLD_CAUSE_OPACITY,
    WORLD_CAUSE_INDEX,   /* instances, geometries or custom indices are exchanged or cut */
    WORLD_CAUSE_UNKNOWN, /* none of these gives the answers */
    WORLD_CAUSE_COUNT
};

/* "none", "transform", "world_box", "mask", "cull", "opacity", "instance_index", "unknown". */
const char *world_cause_name(enum world_cause cause);

enum world_defect {
    WORLD_DEFECT_NONE, /* the rules as they are */
    WORLD_DEFECT_MASK_IGNORED,
    WORLD_DEFECT_MASK_EQUAL,
    WORLD_DEFECT_MASK_ANY_BIT, /* a mask that is not 0 meets every other */
    WORLD_DEFECT_SKIP_IGNORED, /* triangles are not skipped */
    WORLD_DEFECT_CULL_IGNORED,
    WORLD_DEFECT_CULLS_IGNORED, /* by facing and by opacity */
    WORLD_DEFECT_CULL_OTHER,    /* back for front */
    WORLD_DEFECT_DISABLE_IGNORED,
    WORLD_DEFECT_FLIP_IGNORED,
    WORLD_DEFECT_MIRROR,        /* a mirror exchanges the sides */
    WORLD_DEFECT_FRONT_IS_BACK, /* everywhere */
    WORLD_DEFECT_SIDE,          /* the other side is reported */
    WORLD_DEFECT_OPACITY_CULL_IGNORED,
    WORLD_DEFECT_FORCE_IGNORED,
    WORLD_DEFECT_RAY_OPACITY_IGNORED,
    WORLD_DEFECT_RAY_BEFORE_INSTANCE, /* the instance overrides the ray */
    WORLD_DEFECT_GEOMETRY_OPAQUE,     /* every geometry is opaque */
    WORLD_DEFECT_GEOMETRY_OF_FIRST,   /* as opaque as the mesh's first */
    WORLD_DEFECT_FILTER_IGNORED,
    WORLD_DEFECT_FILTER_NONE,
    WORLD_DEFECT_ENDS_AT_CANDIDATE, /* of any hits a ray ends at one that does not count */
    WORLD_DEFECT_INSTANCE_ZERO,     /* hits of instance 0 are none */
    WORLD_DEFECT_CUSTOM_IS_NUMBER,  /* custom index: the instance's number */
    WORLD_DEFECT_CUSTOM_16,
    WORLD_DEFECT_CUSTOM_8,
    WORLD_DEFECT_NUMBER_10,          /* 10 bits of an instance's number are kept */
    WORLD_DEFECT_CUSTOM_OF_BEFORE,   /* that of the instance before */
    WORLD_DEFECT_INACTIVE_COUNT_NOT, /* instances are numbered without those that are inactive */
    WORLD_DEFECT_MESH_NUMBERS,       /* hits name triangles of meshes */
    WORLD_DEFECT_GEOMETRY_FIRST,     /* triangles are numbered anew in each geometry */
    WORLD_DEFECT_LAST_TRANSFORM,     /* an instance has the transform of the one before */
    WORLD_DEFECT_FIRST_TRANSFORM,    /* all have that of the first */
    WORLD_DEFECT_NO_TRANSFORM,
    WORLD_DEFECT_NO_TRANSLATION,
    WORLD_DEFECT_TRANSPOSED,
    WORLD_DEFECT_NOT_INVERTED,
    WORLD_DEFECT_LENGTH,        /* t counts in units of the direction's length in the world */
    WORLD_DEFECT_OBJECT_LENGTH, /* in the mesh */
    WORLD_DEFECT_LENGTH_KEPT,   /* the direction in the mesh has the length of that in the world */
    WORLD_DEFECT_NOT_CARRIED,   /* the nearest hit of any instance, not of all */
    WORLD_DEFECT_COUNT
};

struct world_defect_about {
    const char *text; /* "a tracer that ...", a clause of one line */
    enum world_cause cause;
};

const struct world_defect_about *world_defect_about(enum world_defect defect);

/* A world as these tracers see it. */
struct world_look {
    const struct world *world;
    const struct tri_test *tri;
    struct instance_record *record; /* one per instance */
    struct instance_record *bent;   /* the same, as the defect that is looked at has them */
    struct box *mesh_box;           /* one per mesh */
    enum world_defect defect;
};

/* Borrows the world. Errors: those of world_records_make; STATUS_MEMORY. *out is zero on error. */
enum status world_look_make(const struct world *world, const struct tri_test *tri,
                            struct world_look *out, struct reason *reason) MUST_USE;
void world_look_free(struct world_look *look); /* a zero one is fine */

/* Sets the defect of the answers that follow. */
void world_look_bend(struct world_look *look, enum world_defect defect);

/* Answers one ray. Triangles are tested in order, without trees; a mesh whose box the ray misses is
 * left out. What depends on the order in which a tracer comes upon instances or triangles is
 * answered as `given`, an answer of the tracer's, where that is possible. */
void world_look_trace(const struct world_look *look, enum query query, const struct ray *ray,
                      struct ray_mode mode, const struct hit *given, struct hit *hit,
                      uint32_t *tag);

#endif
