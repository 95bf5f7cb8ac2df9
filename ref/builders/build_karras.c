/* The hierarchy of Morton codes of a fixed number of bits, as devices build it, in integers only
 * (ref/staged/staged.h). The tree of `lbvh` has codes of as many bits as fit beside a number. */
#include "ref/staged/staged_builder.h"

static enum status build_30(const struct scene *scene, const struct build_options *options,
                            struct bvh *out, struct reason *reason)
{
    return staged_builder(STAGED_LBVH30, scene, options, out, reason);
}

static enum status build_63(const struct scene *scene, const struct build_options *options,
                            struct bvh *out, struct reason *reason)
{
    return staged_builder(STAGED_LBVH63, scene, options, out, reason);
}

extern const struct builder build_lbvh30, build_lbvh63;
const struct builder build_lbvh30 = {
    .name = "lbvh30",
    .summary = "codes of 30 bits, as devices build it: gpu_lbvh30 in C, stage by stage",
    .build = build_30,
    .tri_bytes = STAGED_TRI_BYTES,
};
const struct builder build_lbvh63 = {
    .name = "lbvh63",
    .summary = "the same with 63 bits: gpu_lbvh63 in C",
    .build = build_63,
    .tri_bytes = STAGED_TRI_BYTES,
};
