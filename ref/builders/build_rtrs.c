/* RTRS's builder, bit for bit, faults included (RTRS, file bvh/aabb.rs). Its faults:
 *   F4   all three axes decide: flat geometry is not split if its centroid rounds out of its plane
 *   F5   if one side is empty the box is cut in half and keeps that shape, so that it need not
 *        contain its triangles any more
 *   F19  if the half box equals the box, RTRS would not terminate: rejected, the only difference
 * All operations are in float, each rounded. */
#include "ref/build/top_down.h"

#include <string.h>

/* The mean of the midpoints of the three edges; the division is a multiplication by the rounded
 * third. */
static void centroid(float v[3][3], float out[3])
{
    for (int k = 0; k < 3; k++) {
        float ab = (v[0][k] + v[1][k]) * 0.5f;
        float bc = (v[1][k] + v[2][k]) * 0.5f;
        float ca = (v[2][k] + v[0][k]) * 0.5f;
        out[k] = ((ab + bc) + ca) * (1.0f / 3.0f);
    }
}

/* The longest axis; among equal ones x before y before z, and z if nothing can be compared
 * (NaN). */
static int longest_axis(const float extent[3])
{
    if (extent[0] >= extent[1] && extent[0] >= extent[2])
        return 0;
    return extent[1] >= extent[2] && extent[1] >= extent[0] ? 1 : 2;
}

static bool contains(const struct box *box, const float p[3])
{
    return p[0] >= box->lo[0] && p[0] <= box->hi[0] && p[1] >= box->lo[1] && p[1] <= box->hi[1] &&
           p[2] >= box->lo[2] && p[2] <= box->hi[2];
}

/* Moves the triangles whose centroids lie in `box` to the front; both sides keep their order.
 * Returns their number. */
static uint32_t partition(struct build *build, const struct build_node *node, const struct box *box)
{
    uint32_t *prim = build->prim + node->first;
    uint32_t left = 0, right = 0;
    for (uint32_t i = 0; i < node->count; i++) {
        if (contains(box, build->centroid + 3 * (size_t)prim[i]))
            prim[left++] = prim[i];
        else
            build->spare[right++] = prim[i];
    }
    memcpy(prim + left, build->spare, right * sizeof *prim);
    return left;
}

static enum status split(struct build *build, struct build_node *node, uint32_t *left,
                         struct reason *reason)
{
    *left = 0;
    while (node->count > build->options->leaf) {
        const struct box box = node->bounds;
        float extent[3];
        for (int k = 0; k < 3; k++)
            extent[k] = box.hi[k] - box.lo[k];
        int axis = longest_axis(extent);
        if (extent[axis] < build->options->eps * 0.5f)
            return STATUS_OK;
        struct box fst = box, snd = box;
        fst.hi[axis] = snd.lo[axis] = box.lo[axis] + extent[axis] * 0.5f;
        uint32_t front = partition(build, node, &fst);
        if (front > 0 && front < node->count) {
            *left = front;
            return STATUS_OK;
        }
        node->bounds = front == 0 ? snd : fst;
        /* The same box with the same triangles would be split the same way again. Compares bits,
         * because of NaN. */
        if (memcmp(&node->bounds, &box, sizeof box) == 0)
            return fail(reason, STATUS_LIMIT,
                        "rtrs: RTRS never ends here (fault F19, docs/rtrs-faults.md): "
                        "%u triangles, the first is %u, in a box whose half %c [%a, %a] is "
                        "itself; eps %g",
                        node->count, build->prim[node->first], "xyz"[axis], (double)box.lo[axis],
                        (double)box.hi[axis], (double)build->options->eps);
    }
    return STATUS_OK;
}

static enum status build_rtrs_tree(const struct scene *scene, const struct build_options *options,
                                   struct bvh *out, struct reason *reason)
{
    static const struct build_rule rule = {centroid, split};
    struct build_options whole = *options;
    whole.presplit = 0;
    return build_top_down(&rule, scene, &whole, out, reason);
}

extern const struct builder build_rtrs;
const struct builder build_rtrs = {
    .name = "rtrs",
    .summary = "as RTRS builds, cut boxes included; leaves can exceed the limit below eps / 2",
    .faithful = true,
    .build = build_rtrs_tree,
    .takes = "eps",
    .tri_bytes = 44,
};
