/* The leaves of a traversal: tests of their triangles, and the best hit. Included by
 * ref/fast/walk.h. */

/* Keeps the nearest of the triangles in `in`, all of which have t in range. */
INLINE void keep(struct walk_best *best, uint32_t in, float8 t)
{
    uint32_t lane = (uint32_t)__builtin_ctz(in);
    float at[8];
    memcpy(at, &t, sizeof at);
    for (uint32_t rest = in & (in - 1); rest; rest &= rest - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rest);
        lane = at[i] < at[lane] ? i : lane;
    }
    best->lane = lane;
    best->t = at[lane];
}

/* Returns those of the triangles in `in` that count as hits; `inside` is the ray in the instance.
 * */
INLINE uint32_t admitted(const struct instance_at *at, const struct ray *inside,
                         const struct walk_best *hits, const uint32_t *block, uint32_t n,
                         uint32_t in, float8 t)
{
    float all[8];
    memcpy(all, &t, sizeof all);
    for (uint32_t rest = in; rest; rest &= rest - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rest), tag;
        struct hit hit = {all[i], hits->v[i] / hits->det[i], hits->w[i] / hits->det[i],
                          block_prim(block, n, i)};
        if (!candidate_counts(at, inside->dir, &hit, &tag))
            in &= ~(1u << i);
    }
    return in;
}

/* The triangles of a leaf as a ray sees them. */
struct leaf_seen {
    float8 v, w, det, t; /* as in struct walk_best; t of hits */
    const uint32_t *block;
    uint32_t vertices;
};

/* Tests all triangles of a leaf with the operations of tri_woop; each vertex is translated and
 * sheared once. Returns the triangles that are hit in the ray's range.
 *   leave   to return early if none is hit; what is seen is then of no use */
INLINE uint32_t see_leaf(const struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                         bool leave, struct leaf_seen *seen)
{
    const uint32_t *block = tree->block + (leaf & (FAST_LEAF_WORDS - 1));
    uint32_t n = (leaf >> FAST_LEAF_COUNT & 15u) + 1;
    const uint32_t *row = block + BLOCK_CORNERS;
    float16 az = vertices(row + r->axis[2] * n, n) - r->o[2];
    float16 x = vertices(row + r->axis[0] * n, n) - r->o[0] - r->shear[0] * az;
    float16 y = vertices(row + r->axis[1] * n, n) - r->o[1] - r->shear[1] * az;
    codes8 c0 = codes(block[0]), c1 = codes(block[1]), c2 = codes(block[2]);
    float8 x0 = corners(x, c0, n), x1 = corners(x, c1, n), x2 = corners(x, c2, n);
    float8 y0 = corners(y, c0, n), y1 = corners(y, c1, n), y2 = corners(y, c2, n);
    float8 w0 = x2 * y1 - y2 * x1;
    float8 w1 = x0 * y2 - y0 * x2;
    float8 w2 = x1 * y0 - y1 * x0;
    float8 det = (w0 + w1) + w2, zero = all8(0);
    uint32_t outside = less(min8(min8(w0, w1), w2), zero) & less(zero, max8(max8(w0, w1), w2));
    uint32_t in = unequal(det, zero) & ~outside;
    if (leave && in == 0)
        return 0;
    float16 z = r->shear[2] * az;
    float8 t = (w0 * corners(z, c0, n) + w1 * corners(z, c1, n)) + w2 * corners(z, c2, n);
    t = t / det;
    *seen = (struct leaf_seen){w1, w2, det, t, block, n};
    return in & not_above(r->tmin, t) & less(t, r->tbest);
}

/* Tests a leaf. Returns true if a triangle is hit nearer than the best hit, of a world one that
 * counts.
 *   at   the instance that the ray is in, and `inside` the ray there; NULL: all triangles count */
INLINE bool test_leaf(const struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                      const struct instance_at *at, const struct ray *inside,
                      struct walk_best *best)
{
    struct leaf_seen seen;
    uint32_t in = see_leaf(r, tree, leaf, true, &seen);
    if (in == 0)
        return false;
    if (at) {
        struct walk_best hits;
        memcpy(hits.v, &seen.v, sizeof hits.v);
        memcpy(hits.w, &seen.w, sizeof hits.w);
        memcpy(hits.det, &seen.det, sizeof hits.det);
        in = admitted(at, inside, &hits, seen.block, seen.vertices, in, seen.t);
        if (in == 0)
            return false;
    }
    keep(best, in, seen.t);
    memcpy(best->v, &seen.v, sizeof best->v);
    memcpy(best->w, &seen.w, sizeof best->w);
    memcpy(best->det, &seen.det, sizeof best->det);
    best->block = seen.block;
    best->vertices = seen.vertices;
    return true;
}

INLINE void write_hit(const struct walk_best *best, struct hit *hit)
{
    uint32_t lane = best->lane;
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    if (best->block)
        *hit = (struct hit){.t = best->t,
                            .u = best->v[lane] / best->det[lane],
                            .v = best->w[lane] / best->det[lane],
                            .prim = block_prim(best->block, best->vertices, lane)};
}
