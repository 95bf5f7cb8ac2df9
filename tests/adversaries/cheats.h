/* Dishonest tracers: each is engine cpu on layout f32, whose answers it spoils in one way. Most use
 * up one allowed class as far as it goes, and know the exact truth to do so. */
#ifndef TESTS_ADVERSARIES_CHEATS_H
#define TESTS_ADVERSARIES_CHEATS_H

#include "ref/judge/judge.h"
#include "ref/match/match.h"

#include <stdio.h>

/* What a liar knows. */
struct lie {
    const struct match *match;
    size_t calls; /* of trace, this one included */
    size_t count; /* rays of this call */
    const struct ray *ray;
    const struct hit *right;   /* what cpu answers to them */
    const struct judge *judge; /* who will judge the answers */
    double amount;             /* of the cheat */
};

enum cheat_rays {
    RAYS_PRIMARY,
    RAYS_MIXED,
    RAYS_RANGES,
    RAYS_AXIS,
    RAYS_FAR,
    RAYS_IN_PLANE,
    RAYS_BAD,
};

#define CHEAT_LINES 20 /* triangles without area that are lines, the last ones of a scene */

struct cheat {
    const char *name;
    const char *uses;  /* the allowance that it lives on */
    const char *scene; /* of the quick suite; NULL: sphere:n=24, the large run's mesh */
    enum cheat_rays rays;
    double amount; /* units, steps, or for RAYS_FAR the distance of the camera in sizes */
    enum query query;
    struct model model; /* what it says of itself */
    /* Changes the answer to ray i of this call, *hit, which is cpu's. */
    void (*spoil)(const struct lie *lie, size_t i, struct hit *hit);
    bool caught;
    double away; /* if it is not: the largest share of the hits it may spoil */
    bool large;  /* takes more rays than the quick suite has */
    /* QUERY_ALL: changes the list, `count` hits of at most `capacity`, in place of the above. */
    void (*spoil_list)(const struct lie *lie, size_t i, struct hit *hit, uint32_t *count,
                       uint32_t capacity);
};

extern const struct cheat cheats[], outsiders[];
extern const size_t cheat_count, outsider_count;

#endif
