#include "ref/packed/refit.h"

#include <stdlib.h>

enum status bvh_refit(struct bvh *bvh, const struct scene *scene, struct reason *reason)
{
    if (bvh->tri_count != scene->tri_count)
        return fail(reason, STATUS_INPUT, "the tree holds %u triangles, the scene has %u",
                    bvh->tri_count, scene->tri_count);
    if (bvh_is_split(bvh))
        return fail(reason, STATUS_LIMIT,
                    "rebuild: the tree is split, its boxes of parts of triangles cannot be "
                    "refitted");
    struct box *exact = bvh_exact_bounds(bvh, scene);
    if (!exact)
        return fail(reason, STATUS_MEMORY, "no memory to refit a tree of %u nodes",
                    bvh->node_count);
    for (uint32_t i = 0; i < bvh->node_count; i++)
        bvh->node[i].bounds = exact[i];
    free(exact);
    return STATUS_OK;
}
