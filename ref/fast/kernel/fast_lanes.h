/* 16 rays, one a lane of vectors, that are prepared at once.
 * Included by ref/fast/kernel/walk.h, for kernels that define on 16 lanes:
 *   fma16, max16, min16                as fma8, max8, min8
 *   less16, unequal16, not_above16     bits of the lanes where it holds
 *   blend16, blend16i                  the second vector in the lanes of a mask, else the first
 *   signs16                            the lanes' sign bits
 *   least_of16                         the least of all lanes
 *   words16                            four words of 16 rays, a vector each */

#define LANES     16u
#define LANES_ALL 0xFFFFu

/* Rays and their best hits. */
struct lanes {
    float16 scale[3], near[3], far[3]; /* as of walk_ray */
    float16 tmin, tbest;
    float16 o[3], shear[3]; /* woop, along each lane's own axes */
    float16 v, w, det;      /* of the best hits; u and v are divided at the end */
    int16v prim;            /* ABI_NO_PRIM: no hit */
    uint32_t down[3];       /* lanes whose direction is negative along an axis */
    uint32_t main[3];       /* lanes by their main axis */
    uint32_t open;          /* lanes that look for a hit, of those that a kernel can trace */
};

INLINE float16 all16(float x)
{
    return (float16){x, x, x, x, x, x, x, x, x, x, x, x, x, x, x, x};
}

INLINE float16 size16(float16 v)
{
    return (float16)((int16v)v & 0x7FFFFFFF);
}

INLINE float at16(const float16 *v, uint32_t lane)
{
    float one;
    memcpy(&one, (const char *)v + 4 * (size_t)lane, sizeof one);
    return one;
}

/* --- preparing -------------------------------------------------------------------------------- */

/* The vectors of three axes in the order of axes_of, in each lane its own. */
INLINE void along_axes(const struct lanes *l, uint32_t turned, const float16 v[3], float16 out[3])
{
    const float16 next = blend16(l->main[2], blend16(l->main[1], v[1], v[2]), v[0]);
    const float16 last = blend16(l->main[2], blend16(l->main[1], v[2], v[0]), v[1]);
    out[0] = blend16(turned, next, last);
    out[1] = blend16(turned, last, next);
    out[2] = blend16(l->main[2], blend16(l->main[1], v[0], v[1]), v[2]);
}

/* The part of prepare_woop. */
INLINE void lanes_woop(struct lanes *l, const float16 o[3], const float16 d[3],
                       const float16 size[3], float16 largest)
{
    float16 to[3];
    uint32_t rest = LANES_ALL, turned = 0; /* negative along the main axis */
    for (int k = 0; k < 3; k++) {
        l->down[k] = signs16(d[k]);
        l->main[k] = not_above16(largest, size[k]) & rest;
        rest &= ~l->main[k];
        turned |= l->main[k] & l->down[k];
    }
    along_axes(l, turned, o, l->o);
    along_axes(l, turned, d, to);
    for (int k = 0; k < 3; k++)
        l->shear[k] = (k < 2 ? to[k] : all16(1)) / to[2];
}

/* Prepares 16 rays, each with the operations of prepare(). */
INLINE void lanes_prepare(struct lanes *l, const struct fast_tree *tree, const struct ray *ray)
{
    float16 o[4], d[4], size[3]; /* with tmin and tmax */
    float16 inverse[3], off[3], most = all16(0);
    words16(ray->org, o);
    words16(ray->dir, d);
    for (int k = 0; k < 3; k++)
        size[k] = size16(d[k]);
    const float16 largest = max16(max16(size[2], size[0]), size[1]);
    for (int k = 0; k < 3; k++) {
        float16 safe = max16(largest * 0x1p-60f, size[k]);
        safe = (float16)((int16v)safe | ((int16v)d[k] & INT32_MIN));
        inverse[k] = 1.0f / safe;
        const float16 away = tree->lo[k] - o[k];
        off[k] = away * inverse[k];
        most = max16(size16(away) + tree->extent[k], most);
    }
    l->open = less16(most, all16(tree->reach)) & not_above16(all16(0x1p-40f), largest) &
              not_above16(largest, all16(0x1p40f)) & not_above16(all16(0), o[3]) &
              not_above16(o[3], d[3]);
    for (int k = 0; k < 3; k++) {
        const float16 span = most * size16(inverse[k]), pad = span * FAST_PAD;
        l->open &= less16(size16(off[k]) + span, all16(0x1p100f));
        l->scale[k] = tree->step[k] * inverse[k];
        l->near[k] = off[k] - pad;
        l->far[k] = off[k] + pad;
    }
    lanes_woop(l, o, d, size, largest);
    l->tmin = o[3] + 0.0f;
    const int16v bits = (int16v)d[3]; /* above() of each */
    l->tbest = (float16)(bits - (bits < 0x7F800000));
    l->v = l->w = all16(0);
    l->det = all16(1);
    l->prim = (int16v)all16(0) | (int32_t)ABI_NO_PRIM;
}

/* --- hits ------------------------------------------------------------------------------------- */

/* Takes a hit of the lanes `in`. */
INLINE void lanes_keep(struct lanes *l, bool any, uint32_t in, float16 t, float16 v, float16 w,
                       float16 det, uint32_t prim)
{
    l->tbest = blend16(in, l->tbest, t);
    l->v = blend16(in, l->v, v);
    l->w = blend16(in, l->w, w);
    l->det = blend16(in, l->det, det);
    l->prim = blend16i(in, l->prim, (int16v)all16(0) | (int32_t)prim);
    if (any)
        l->open &= ~in;
}

/* Writes the hits of all lanes. */
INLINE void lanes_write(const struct lanes *l, struct hit *hit)
{
    const float16 u = l->v / l->det, v = l->w / l->det;
    for (uint32_t i = 0; i < LANES; i++) {
        uint32_t prim;
        memcpy(&prim, (const char *)&l->prim + 4 * (size_t)i, sizeof prim);
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
        if (prim != ABI_NO_PRIM)
            hit[i] = (struct hit){at16(&l->tbest, i), at16(&u, i), at16(&v, i), prim};
    }
}

/* --- single rays ------------------------------------------------------------------------------ */

INLINE void lane_ray(const struct lanes *l, uint32_t lane, struct walk_ray *r)
{
    const uint32_t main = (l->main[1] >> lane & 1) + 2 * (l->main[2] >> lane & 1);
    const int32_t *axes = axes_of[2 * main + (l->down[main] >> lane & 1)];
    for (int k = 0; k < 3; k++) {
        const bool down = l->down[k] >> lane & 1;
        r->scale[k] = all8(at16(&l->scale[k], lane));
        r->near[k] = all8(at16(&l->near[k], lane));
        r->far[k] = all8(at16(&l->far[k], lane));
        r->o[k] = all16(at16(&l->o[k], lane));
        r->shear[k] = all16(at16(&l->shear[k], lane));
        r->near_row[k] = (size_t)((down ? 3 : 0) + k) * FAST_WIDTH;
        r->far_row[k] = (size_t)((down ? 0 : 3) + k) * FAST_WIDTH;
        r->axis[k] = (uint32_t)axes[k];
    }
    r->tmin = all8(at16(&l->tmin, lane));
    narrow(r, at16(&l->tbest, lane));
}

INLINE void lane_keep(struct lanes *l, const struct fast_tree *tree, bool any, uint32_t lane,
                      const struct walk_best *best)
{
    const uint32_t at = best->lane;
    if (best->block)
        lanes_keep(l, any, 1u << lane, all16(best->t), all16(best->v[at]), all16(best->w[at]),
                   all16(best->det[at]), prim_of(tree, best->block, best->part, at));
}

/* Traces the lanes `rays` from a node or leaf on. */
INLINE void lanes_apart(struct lanes *l, const struct fast_tree *tree, uint32_t ref, bool any,
                        uint32_t rays)
{
    for (; rays; rays &= rays - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(rays);
        struct walk_ray r;
        struct walk_best best = {.block = NULL, .lane = 0};
        lane_ray(l, lane, &r);
        walk_from(&r, tree, ref, any, NULL, NULL, &best);
        lane_keep(l, tree, any, lane, &best);
    }
}
