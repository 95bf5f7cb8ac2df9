/* The leak counter: rays from inside a closed mesh, aimed at its edges and vertices, and how many
 * of them an engine lets through, reports twice, or counts wrongly. */
#ifndef LEAKS_H
#define LEAKS_H

#include "ref/engine.h"
#include "ref/oracle/oracle.h"
#include "ref/scene/topology.h"

/* What a ray was aimed at. */
enum leak_aim {
    LEAK_VERTEX,
    LEAK_MIDPOINT, /* the middle of an edge */
    LEAK_EDGE,     /* some point of an edge */
    LEAK_BESIDE,   /* a hair beside a point of an edge */
    LEAK_AIMS,
};

/* Counts of rays. From inside every ray leaves the mesh, and it crosses it an odd number of times.
 */
struct leak_tally {
    size_t rays;
    size_t misses;  /* the closest hit is none */
    size_t empty;   /* of all hits there is none */
    size_t doubles; /* triangles hit together of which exactly one should be, see leaks_extra */
    size_t even;    /* an even number of triangles is hit, also 0 */
    /* Of rays whose number stays even with each double hit counted once: */
    size_t lost;     /* a triangle that the exact ray crosses inside is not listed, nor is one that
                        touches it: a wall was passed through. Not counted within the formula's
                        proven error of a silhouette, where both walls may be passed */
    size_t phantoms; /* a triangle is listed that the exact ray does not meet, nor does any that
                        touches it, and that the formula cannot accept within its proven error */
    size_t repeated; /* one triangle is listed twice */
};

#define LEAK_FINDINGS 4

/* A miss or a double hit that was kept. */
struct leak_finding {
    bool is_double;
    enum leak_aim aim;
    size_t ray_index;
    struct ray ray;
    uint32_t prim[2]; /* of a double hit: two triangles of which only one should be hit */
};

struct leaks {
    struct leak_tally tally[LEAK_AIMS];
    bool lists; /* the engine can list all hits; else only rays and misses are counted */
    struct leak_finding finding[LEAK_FINDINGS]; /* misses before double hits */
    size_t finding_count;
    uint64_t ns; /* spent in the engine */
};

/* The rays and the mesh; all borrowed. */
struct leak_rays {
    const struct topology *topology; /* of a closed mesh */
    const struct oracle *oracle;     /* of the same */
    const struct ray *ray;           /* from strictly inside */
    const uint8_t *aim;              /* enum leak_aim of each */
    size_t ray_count;
};

const char *leak_aim_name(enum leak_aim aim); /* "vertex", "midpoint", "edge", "beside" */

/* The sum over all aims. */
struct leak_tally leaks_total(const struct leaks *leaks);

/* Traces the rays with closest-hit and all-hits queries and counts.
 *   job     to prepare; its query is ignored
 *   digest  NULL, or ray_count numbers: a hash of every bit of each ray's answers, lists in order
 * Errors: those of the engine; STATUS_MEMORY. */
enum status leaks_count(const struct leak_rays *rays, const struct engine *engine, void *self,
                        const struct job *job, struct leaks *out, uint64_t *digest,
                        struct reason *reason) MUST_USE;

/* Returns how many of the triangles `prim`, all different, are hit too many. Two that the ray sees
 * from the same side exclude each other if they are neighbours along an edge, or lie in one fan
 * that is a ring and seen from that side as a whole: their projections along the ray only touch.
 * Groups of such triangles count once.
 *   pair   set to two that exclude each other, if any; may be NULL
 *   group  room for `count` numbers */
size_t leaks_extra(const struct topology *topology, const struct oracle *oracle,
                   const struct ray *ray, const uint32_t *prim, size_t count, uint32_t pair[2],
                   uint32_t *group);

/* What a standard demands at edges of closed meshes. */
struct leak_profile {
    const char *name;
    const char *summary;
    bool misses_must;  /* a miss breaks the rule; else "should not" */
    bool doubles_must; /* so does a double hit */
};

/* NULL-terminated; the first is the default. */
extern const struct leak_profile *const leak_profiles[];

const struct leak_profile *leak_profile_find(const char *name); /* or NULL */

#endif
