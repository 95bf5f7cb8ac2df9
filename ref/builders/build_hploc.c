/* H-PLOC (Benthin et al. 2024), see ref/staged/staged_hploc.c. */
#include "ref/staged/staged_builder.h"

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    return staged_builder(STAGED_HPLOC, scene, options, out, reason);
}

extern const struct builder build_hploc;
const struct builder build_hploc = {
    .name = "hploc",
    .summary = "clusters from below in the ranges of lbvh63: gpu_hploc in C",
    .build = build,
    .tri_bytes = STAGED_TRI_BYTES,
};
