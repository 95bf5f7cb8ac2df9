/* Worlds and modes of rays composed of one member of each of some axes, so that a covering array
 * can make all pairs of them meet. */
#ifndef COMPOSED_H
#define COMPOSED_H

#include "scenes/worlds.h"

enum composed_axis {
    COMPOSED_TRANSFORM, /* one of placed_kinds[] for all instances */
    COMPOSED_MASKS,     /* of instances and, for every second ray, of rays */
    COMPOSED_FLAGS,     /* of instances */
    COMPOSED_GEOMETRY,  /* whether geometries are opaque */
    COMPOSED_FILTER,
    COMPOSED_RAYS,  /* flags of every second ray */
    COMPOSED_COUNT, /* instances */
    COMPOSED_AXES
};

/* Numbers of members, each below composed_members. */
struct composition {
    uint32_t member[COMPOSED_AXES];
};

uint32_t composed_members(enum composed_axis axis);

/* The name of a member, "mirrored", "cull-back" or "16"; NULL past the last. */
const char *composed_name(enum composed_axis axis, uint32_t member);

/* Finds a member by its name. Errors: STATUS_INPUT with the names of the axis. */
enum status composed_find(enum composed_axis axis, const char *name, uint32_t *member,
                          struct reason *reason) MUST_USE;

/* Makes the world; the same arguments give the same bytes on every machine. It has passed
 * world_finish, and instance 0 is active. Errors: STATUS_MEMORY. */
enum status composed_make(const struct composition *of, uint64_t seed, struct world *out,
                          struct reason *reason) MUST_USE;

/* What `count` rays may meet. Even ones meet every active instance and take every triangle for
 * opaque, so that something is hit whatever the world. Odd ones have the flags that the composition
 * names; masks of one bit, or any, if its masks are not `all`. */
void composed_modes(const struct composition *of, uint64_t seed, size_t count,
                    struct ray_mode *out);

#endif
