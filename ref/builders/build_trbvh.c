/* Restructures treelets of the hierarchy of Morton codes (Karras and Aila 2013, Fast parallel
 * construction of high-quality bounding volume hierarchies): one triangle a leaf at first, then
 * ROUNDS times over the tree from below, then leaves of up to `leaf` triangles where these cost
 * less. Ours: the cost that treelets lower is that with these leaves, and never rises. */
#include "ref/build/links.h"
#include "ref/build/presplit.h"
#include "ref/builders/treelets.h"

#define ROUNDS 3u

extern const struct builder build_lbvh;

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    struct build_options single = *options;
    single.leaf = options->leaf > 0;
    enum status status = build_lbvh.build(scene, &single, out, reason);
    if (status || out->node_count == 0)
        return status;
    status = tree_treelets(out, options->leaf, ROUNDS, options->threads);
    if (!status && options->presplit > 0)
        status = presplit_merge(out, out->tri_count);
    if (!status)
        status = tree_collapse(out, options->leaf);
    if (!status)
        return STATUS_OK;
    tree_drop(out);
    return fail(reason, status, "no memory to build a tree of %u triangles", scene->tri_count);
}

extern const struct builder build_trbvh;
const struct builder build_trbvh = {
    .name = "trbvh",
    .summary = "the order of Morton codes, its treelets of 7 leaves made anew three times where "
               "that costs less",
    .build = build,
    .takes = "presplit",
    .tri_bytes = 320,
};
