/* The boxes that rays are aimed at. */
#include "fuzz/gen/aim_inner.h"

#include "fuzz/gen/gen_sketch.h"

#include <string.h>

/* Coordinates up to which rays are aimed: origins stay within 2^40 then. */
#define REACH 0x1p37f

/* A range of triangles still to be split. */
struct boxes_range {
    uint32_t first, count;
};

struct boxes_split {
    float centroid[AIM_SPLIT_MOST][3];
    struct box box[AIM_SPLIT_MOST];
    uint8_t prim[AIM_SPLIT_MOST];
};

static struct box box_of_range(const struct boxes_split *split, struct boxes_range range)
{
    struct box box = box_empty();
    for (uint32_t i = 0; i < range.count; i++)
        box_add_box(&box, &split->box[split->prim[range.first + i]]);
    return box;
}

static int longest_axis(const struct box *box)
{
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (box->hi[k] - box->lo[k] > box->hi[axis] - box->lo[axis])
            axis = k;
    return axis;
}

/* Moves the triangles whose centroids are below `middle`, and the first `ties` of those on it, to
 * the front; both sides keep their order. Returns how many. */
static uint32_t part(struct boxes_split *split, struct boxes_range range, int axis, float middle,
                     uint32_t ties)
{
    uint8_t *prim = split->prim + range.first, back[AIM_SPLIT_MOST];
    uint32_t front = 0, rest = 0;
    for (uint32_t i = 0; i < range.count; i++) {
        float at = split->centroid[prim[i]][axis];
        bool tie = at == middle && ties > 0;
        ties -= tie;
        if (at < middle || tie)
            prim[front++] = prim[i];
        else
            back[rest++] = prim[i];
    }
    memcpy(prim + front, back, rest);
    return front;
}

/* Moves the half with the smaller centroids to the front. */
static uint32_t halve(struct boxes_split *split, struct boxes_range range, int axis)
{
    float sorted[AIM_SPLIT_MOST];
    uint32_t half = range.count / 2, below = 0;
    for (uint32_t i = 0; i < range.count; i++) {
        float at = split->centroid[split->prim[range.first + i]][axis];
        uint32_t place = i;
        for (; place > 0 && sorted[place - 1] > at; place--)
            sorted[place] = sorted[place - 1];
        sorted[place] = at;
    }
    while (sorted[below] < sorted[half])
        below++;
    return part(split, range, axis, sorted[half], half - below);
}

/* Splits at the middle of the longest axis, in halves if that separates nothing. */
static uint32_t split_range(struct boxes_split *split, struct boxes_range range,
                            const struct box *box)
{
    int axis = longest_axis(box);
    float middle = 0.5f * box->lo[axis] + 0.5f * box->hi[axis];
    uint32_t front = part(split, range, axis, middle, UINT32_MAX);
    return front == 0 || front == range.count ? halve(split, range, axis) : front;
}

static void add_split_boxes(uint32_t leaf, struct aim *aim)
{
    struct boxes_split split;
    struct boxes_range todo[AIM_SPLIT_MOST];
    uint32_t waiting = 1;
    todo[0] = (struct boxes_range){0, aim->scene->tri_count};
    for (uint32_t i = 0; i < todo[0].count; i++) {
        float v[3][3];
        scene_tri(aim->scene, i, v);
        split.prim[i] = (uint8_t)i;
        split.box[i] = box_empty();
        for (int c = 0; c < 3; c++)
            box_add_point(&split.box[i], v[c]);
        for (int k = 0; k < 3; k++)
            split.centroid[i][k] =
                (float)(((double)v[0][k] + (double)v[1][k] + (double)v[2][k]) / 3);
    }
    while (waiting > 0 && aim->box_count < AIM_BOXES_MOST) {
        struct boxes_range range = todo[--waiting];
        struct box box = box_of_range(&split, range);
        aim->box[aim->box_count++] = box;
        if (range.count <= leaf)
            continue;
        uint32_t front = split_range(&split, range, &box);
        todo[waiting++] = (struct boxes_range){range.first, front};
        todo[waiting++] = (struct boxes_range){range.first + front, range.count - front};
    }
}

static void add_random_boxes(struct rng *rng, struct aim *aim)
{
    while (aim->box_count < AIM_BOXES_MOST / 2)
        aim->box[aim->box_count++] =
            scene_tri_bounds(aim->scene, rng_below(rng, aim->scene->tri_count));
}

void aim_make(const struct scene *scene, uint32_t leaf, struct rng *rng, struct aim *out)
{
    out->scene = scene;
    out->box_count = 0;
    if (scene->tri_count == 0) {
        out->box[out->box_count++] = (struct box){{-0.5f, -0.5f, -0.5f}, {0.5f, 0.5f, 0.5f}};
    } else if (scene->tri_count <= AIM_SPLIT_MOST) {
        add_split_boxes(leaf, out);
    } else {
        out->box[out->box_count++] = scene_bounds(scene);
        add_random_boxes(rng, out);
    }
    out->all = out->box[0];
    out->extent = 0;
    for (int k = 0; k < 3; k++) {
        float *lo = &out->all.lo[k], *hi = &out->all.hi[k];
        *lo = aim_clamped(*lo, REACH);
        *hi = aim_clamped(*hi, REACH);
        out->centre[k] = 0.5f * *lo + 0.5f * *hi;
        if (*hi - *lo > out->extent)
            out->extent = *hi - *lo;
    }
    if (!(out->extent >= 0x1p-100f))
        out->extent = out->extent > 0 ? 0x1p-100f : 1.0f;
    int exponent = (int)(float_bits(out->extent) >> 23) - 127;
    out->quantum = power_of_two(exponent - 8);
}
