#include "ref/build/clip.h"

#include <math.h>

#define CLIP_ERROR 0x1p-50

static float float_below(double x)
{
    float f = (float)x;
    return (double)f > x ? nextafterf(f, -INFINITY) : f;
}

static float float_above(double x)
{
    float f = (float)x;
    return (double)f < x ? nextafterf(f, INFINITY) : f;
}

/* Computes where the edge p q, p[axis] < s < q[axis], crosses plane s. */
static void add_crossing(const float p[3], const float q[3], int axis, float s, struct box *bounds)
{
    double t = ((double)s - (double)p[axis]) / ((double)q[axis] - (double)p[axis]);
    for (int k = 0; k < 3; k++) {
        double from = (double)p[k], to = (double)q[k];
        double at = from + (to - from) * t, error = CLIP_ERROR * (fabs(from) + fabs(to));
        float lo = float_below(at - error), hi = float_above(at + error);
        if (k == axis)
            lo = hi = s;
        if (lo < bounds->lo[k])
            bounds->lo[k] = lo;
        if (hi > bounds->hi[k])
            bounds->hi[k] = hi;
    }
}

void clip_between(float v[3][3], int axis, float lo, float hi, struct box *box)
{
    struct box bounds = box_empty();
    for (int c = 0; c < 3; c++) {
        const float *a = v[c], *b = v[(c + 1) % 3];
        const float *p = a[axis] < b[axis] ? a : b, *q = a[axis] < b[axis] ? b : a;
        if (lo <= a[axis] && a[axis] <= hi)
            box_add_point(&bounds, a);
        if (p[axis] < lo && lo < q[axis])
            add_crossing(p, q, axis, lo, &bounds);
        if (p[axis] < hi && hi < q[axis])
            add_crossing(p, q, axis, hi, &bounds);
    }
    for (int k = 0; k < 3; k++) {
        box->lo[k] = bounds.lo[k] > box->lo[k] ? bounds.lo[k] : box->lo[k];
        box->hi[k] = bounds.hi[k] < box->hi[k] ? bounds.hi[k] : box->hi[k];
    }
}

void clip_inside(float v[3][3], struct box *box)
{
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < 3 && !clip_is_empty(box); k++)
            clip_between(v, k, box->lo[k], box->hi[k], box);
}

int part_cut(float v[3][3], const struct part *part, int axis, float at, struct part piece[2])
{
    piece[0] = piece[1] = *part;
    piece[0].box.hi[axis] = at;
    piece[1].box.lo[axis] = at;
    clip_inside(v, &piece[0].box);
    clip_inside(v, &piece[1].box);
    return !clip_is_empty(&piece[0].box) + 2 * !clip_is_empty(&piece[1].box);
}
