/* End-point overlap: cuts triangles by the boxes of nodes that are not theirs. */
#include "ref/tree/tree_quality.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles per partial sum. Sums are added in a fixed order, so the number of threads does not
 * change the result. */
#define BLOCK 256u

/* Most corners of a triangle cut by the six planes of a box. */
#define CORNERS_MOST 9

struct polygon {
    double p[CORNERS_MOST][3];
    int count;
};

/* Keeps the part on the side sign * x[axis] <= sign * plane. */
static void cut(const struct polygon *in, int axis, double plane, double sign, struct polygon *out)
{
    out->count = 0;
    for (int i = 0; i < in->count; i++) {
        const double *a = in->p[i], *b = in->p[(i + 1) % in->count];
        double da = sign * (plane - a[axis]), db = sign * (plane - b[axis]);
        if (da >= 0 && out->count < CORNERS_MOST)
            memcpy(out->p[out->count++], a, sizeof out->p[0]);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) {
            double *p = out->p[out->count < CORNERS_MOST ? out->count : CORNERS_MOST - 1];
            for (int k = 0; k < 3; k++)
                p[k] = a[k] + (b[k] - a[k]) * (da / (da - db));
            p[axis] = plane;
            out->count += out->count < CORNERS_MOST;
        }
    }
}

/* Returns the part of a polygon in a closed box. */
static void cut_box(const struct polygon *in, const struct box *box, struct polygon *out)
{
    struct polygon half;
    *out = *in;
    for (int k = 0; k < 3 && out->count > 0; k++) {
        cut(out, k, (double)box->hi[k], 1, &half);
        cut(&half, k, (double)box->lo[k], -1, out);
    }
}

static double area_of(const struct polygon *polygon)
{
    double sum[3] = {0, 0, 0};
    const double *o = polygon->p[0];
    for (int i = 1; i + 1 < polygon->count; i++)
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            const double *a = polygon->p[i], *b = polygon->p[i + 1];
            sum[k] += (a[l] - o[l]) * (b[m] - o[m]) - (a[m] - o[m]) * (b[l] - o[l]);
        }
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

/* A tree and the references of each triangle. */
struct overlap {
    const struct overlap_tree *tree;
    const struct scene *scene;
    const uint32_t *place; /* index in `of` of the first reference of triangle i */
    const uint32_t *of;    /* items by triangle, ascending */
};

static bool owns(const struct overlap *o, uint32_t node, uint32_t prim)
{
    const struct overlap_node *of = &o->tree->node[node];
    for (uint32_t i = o->place[prim]; i < o->place[prim + 1]; i++)
        if (o->of[i] >= of->item_first && o->of[i] < of->item_end)
            return true;
    return false;
}

/* Area times cost of one triangle's parts below a node, in nodes that do not contain the
 * triangle. *visits counts down to 0, where it ends. */
static double overlap_below(const struct overlap *o, uint32_t index, uint32_t prim,
                            const struct polygon *part, uint64_t *visits)
{
    const struct overlap_node *node = &o->tree->node[index];
    struct polygon inside;
    double sum = 0;
    if (*visits == 0)
        return 0;
    --*visits;
    cut_box(part, &node->box, &inside);
    if (inside.count < 3)
        return 0;
    if (!owns(o, index, prim))
        sum = area_of(&inside) * (node->child_count
                                      ? QUALITY_NODE
                                      : QUALITY_TRIANGLE * (node->item_end - node->item_first));
    for (uint32_t i = 0; i < node->child_count; i++)
        sum += overlap_below(o, o->tree->child[node->child_first + i], prim, &inside, visits);
    return sum;
}

/* Adds every stride-th triangle's area and overlap. With visits left over it returns true. */
static bool overlap_block(const struct overlap *o, uint32_t block, uint32_t stride, uint64_t visits,
                          double *sum, double *area)
{
    uint32_t count = o->scene->tri_count;
    uint64_t begin = (uint64_t)block * BLOCK * stride, end = begin + (uint64_t)BLOCK * stride;
    *sum = *area = 0;
    for (uint64_t i = begin; i < end && i < count; i += stride) {
        struct polygon polygon = {.count = 3};
        float v[3][3];
        scene_tri(o->scene, (uint32_t)i, v);
        for (int c = 0; c < 9; c++)
            polygon.p[c / 3][c % 3] = (double)v[c / 3][c % 3];
        *area += area_of(&polygon);
        *sum += overlap_below(o, 0, (uint32_t)i, &polygon, &visits);
    }
    return visits > 0;
}

/* Fills place (tri_count + 1) and of (prim_count). */
static void index_make(const struct overlap_tree *tree, uint32_t *place, uint32_t *of)
{
    for (uint32_t i = 0; i < tree->prim_count; i++)
        place[tree->prim[i] + 1]++;
    for (uint32_t i = 0; i < tree->tri_count; i++)
        place[i + 1] += place[i];
    /* Each range is filled from its end, so that place has the starts again afterwards. */
    for (uint32_t i = tree->prim_count; i-- > 0;)
        of[--place[tree->prim[i] + 1]] = i;
    memmove(place, place + 1, tree->tri_count * sizeof *place);
    place[tree->tri_count] = tree->prim_count;
}

enum status overlap_measure(const struct overlap_tree *tree, const struct scene *scene,
                            uint32_t most, uint64_t visits, double *out)
{
    uint32_t count = scene->tri_count, unfinished = 0;
    uint32_t stride = most && count > most ? (count + most - 1) / most : 1;
    uint32_t blocks =
        (uint32_t)(((uint64_t)count + (uint64_t)BLOCK * stride - 1) / ((uint64_t)BLOCK * stride));
    uint32_t *place = alloc_zeroed((size_t)count + 1, sizeof *place);
    uint32_t *of = alloc_zeroed(tree->prim_count, sizeof *of);
    double *part = alloc_zeroed(blocks, 2 * sizeof *part), sum = 0, area = 0;
    bool enough = place && of && part;
    if (enough && tree->node_count) {
        index_make(tree, place, of);
        struct overlap o = {tree, scene, place, of};
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : unfinished) if (blocks > 16)
        for (uint32_t i = 0; i < blocks; i++)
            unfinished += !overlap_block(&o, i, stride, visits, &part[2 * i], &part[2 * i + 1]);
        for (uint32_t i = 0; i < blocks; i++) {
            sum += part[2 * i];
            area += part[2 * i + 1];
        }
    }
    *out = unfinished ? (double)NAN : area > 0 ? sum / area : 0;
    free(place);
    free(of);
    free(part);
    return enough ? STATUS_OK : STATUS_MEMORY;
}

enum status tree_overlap(const struct bvh *bvh, const struct scene *scene, uint32_t most,
                         double *out)
{
    struct overlap_node *node = alloc_zeroed(bvh->node_count, sizeof *node);
    uint32_t *child = alloc_zeroed(bvh->node_count, 2 * sizeof *child);
    enum status status = node && child ? STATUS_OK : STATUS_MEMORY;
    for (uint32_t i = bvh->node_count; i-- > 0 && !status;) {
        const struct bvh_node *from = &bvh->node[i];
        const bool leaf = from->item_count > 0;
        node[i] = (struct overlap_node){.box = from->bounds,
                                        .child_first = 2 * (size_t)i,
                                        .child_count = leaf ? 0 : 2,
                                        .item_first = from->item_first,
                                        .item_end = leaf ? from->item_first + from->item_count
                                                         : node[from->snd].item_end};
        child[2 * (size_t)i] = from->fst;
        child[2 * (size_t)i + 1] = from->snd;
    }
    *out = 0;
    if (!status)
        status = overlap_measure(&(struct overlap_tree){.node = node,
                                                        .child = child,
                                                        .prim = bvh->prim,
                                                        .node_count = bvh->node_count,
                                                        .prim_count = bvh->prim_count,
                                                        .tri_count = bvh->tri_count},
                                 scene, most, UINT64_MAX, out);
    free(node);
    free(child);
    return status;
}
