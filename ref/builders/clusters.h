/* Builders from below that merge clusters along the order of Morton codes until one is left: what
 * they share. */
#ifndef CLUSTERS_H
#define CLUSTERS_H

#include "ref/build/lanes.h"
#include "ref/build/refs.h"
#include "ref/tree/bvh.h"

#include <math.h>

/* The first nodes are the references. */
struct clusters {
    const struct ref *ref;
    uint32_t (*child)[2];
    uint32_t *leaves;
    uint32_t nodes;       /* nodes made so far */
    uint32_t *cluster;    /* nodes without a parent, in order */
    struct lane_box *box; /* their boxes, scaled so that areas neither overflow nor vanish */
    uint32_t *chosen;     /* for the rule's use, a number for each cluster */
    uint32_t count, radius, threads;
    struct build_traffic traffic;
};

/* A round should leave at most this fraction of the clusters; usually it leaves two thirds. If one
 * of more than CLUSTERS_FEW leaves more, adjacent clusters are paired after it. */
#define CLUSTERS_SLOW(count) ((count) - (count) / 16)
#define CLUSTERS_FEW         1024u

/* The best neighbour so far. */
struct choice {
    float area;       /* of the common box */
    uint32_t differs; /* bits in which the places differ: unique for each neighbour */
};

#define CHOICE_NONE ((struct choice){INFINITY, UINT32_MAX})

static inline void choose(struct choice *choice, float area, uint32_t differs)
{
    if (area < choice->area || (area == choice->area && differs < choice->differs))
        *choice = (struct choice){area, differs};
}

/* Half the area of the common box; infinite for NaN, if vertices are not finite. */
static inline float common_area(const struct lane_box *a, const struct lane_box *b)
{
    struct lane_box both = *a;
    lane_box_add(&both, b);
    float area = lanes_half_area(both.hi - both.lo);
    return area < INFINITY ? area : INFINITY;
}

/* Makes a node above two clusters; returns its number. */
uint32_t clusters_join(struct clusters *c, uint32_t a, uint32_t b);

/* How a builder merges. */
struct cluster_rule {
    void (*round)(struct clusters *c); /* leaves fewer clusters */
    bool chooses;                      /* it uses `chosen` */
};

/* Builds the tree of a scene; implements builder->build. *traffic, unless it is NULL, becomes what
 * the rounds have counted. Errors: as build_check; STATUS_MEMORY; then *out is zero. */
enum status clusters_build(const struct cluster_rule *rule, const struct scene *scene,
                           const struct build_options *options, struct bvh *out,
                           struct build_traffic *traffic, struct reason *reason) MUST_USE;

#endif
