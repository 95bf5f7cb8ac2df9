/* The counts of a tree, for tests that have memory for them. */
#ifndef SUPPORT_COUNTED_H
#define SUPPORT_COUNTED_H

#include "ref/layout.h"

#include <stdlib.h>

/* Aborts without memory. */
static inline struct bvh_stats bvh_counted(const struct bvh *bvh, const struct scene *scene)
{
    struct bvh_stats stats;
    if (bvh_count(bvh, scene, &stats, NULL))
        abort();
    return stats;
}

#endif
