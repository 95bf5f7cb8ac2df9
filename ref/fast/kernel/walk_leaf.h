/* The leaves of a traversal: tests of their triangles, and the best hit. Included by
 * ref/fast/kernel/walk.h. */

/* Keeps the nearest of the triangles in `in`, all of which have t in range. */
INLINE void keep(struct walk_best *best, uint32_t in, group t)
{
    uint32_t lane = (uint32_t)__builtin_ctz(in);
    float at[GROUP];
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
INLINE uint32_t admitted(const struct fast_tree *tree, const struct instance_at *at,
                         const struct ray *inside, const struct walk_best *hits, uint32_t in,
                         group t)
{
    float all[GROUP];
    memcpy(all, &t, sizeof all);
    for (uint32_t rest = in; rest; rest &= rest - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(rest), tag;
        struct hit hit = {all[i], hits->v[i] / hits->det[i], hits->w[i] / hits->det[i],
                          prim_of(tree, hits->block, hits->part, i)};
        if (!candidate_counts(at, inside->dir, &hit, &tag))
            in &= ~(1u << i);
    }
    return in;
}

/* Triangles of a leaf as a ray sees them. */
struct leaf_seen {
    group v, w, det, t; /* as in struct walk_best; t of hits */
};

/* Tests a group of a leaf's triangles with the operations of tri_woop; each vertex was translated
 * and sheared once. Returns the triangles that are hit in the ray's range.
 *   leave   to return early if none is hit; what is seen is then of no use */
INLINE uint32_t see_group(const struct walk_ray *r, const struct leaf_rows *rows, uint32_t number,
                          bool leave, struct leaf_seen *seen)
{
    const leaf_row x = rows->x, y = rows->y;
    const uint32_t n = rows->vertices;
    group_codes c[3];
    const uint32_t there = leaf_codes(rows, number, c);
    group x0 = row_corners(x, c[0], n), x1 = row_corners(x, c[1], n), x2 = row_corners(x, c[2], n);
    group y0 = row_corners(y, c[0], n), y1 = row_corners(y, c[1], n), y2 = row_corners(y, c[2], n);
    group w0 = x2 * y1 - y2 * x1;
    group w1 = x0 * y2 - y0 * x2;
    group w2 = x1 * y0 - y1 * x0;
    group det = (w0 + w1) + w2, zero = group_all(0);
    uint32_t outside = group_less(group_min(group_min(w0, w1), w2), zero) &
                       group_less(zero, group_max(group_max(w0, w1), w2));
    uint32_t in = group_unequal(det, zero) & ~outside & there;
    if (leave && in == 0)
        return 0;
    const leaf_row z = row_times(rows->az, r->shear[2]);
    group t = (w0 * row_corners(z, c[0], n) + w1 * row_corners(z, c[1], n)) +
              w2 * row_corners(z, c[2], n);
    t = t / det;
    *seen = (struct leaf_seen){w1, w2, det, t};
    return in & group_not_below(t, r->tmin) & group_below(t, r->tbest);
}

INLINE void keep_seen(struct walk_best *best, const struct leaf_rows *rows, uint32_t number,
                      const struct leaf_seen *seen)
{
    memcpy(best->v, &seen->v, sizeof best->v);
    memcpy(best->w, &seen->w, sizeof best->w);
    memcpy(best->det, &seen->det, sizeof best->det);
    best->block = rows->block;
    best->part = leaf_part(rows, number);
}

/* Tests a leaf. Returns true if a triangle is hit nearer than the best hit, of a world one that
 * counts. Where there are several groups of triangles, the range ends at hits of those before.
 *   at   the instance that the ray is in, and `inside` the ray there; NULL: all triangles count */
INLINE bool test_leaf(struct walk_ray *r, const struct fast_tree *tree, uint32_t leaf,
                      const struct instance_at *at, const struct ray *inside,
                      struct walk_best *best)
{
    struct leaf_rows rows;
    const uint32_t groups = leaf_open(r, tree, leaf, &rows);
    bool found = false;
    for (uint32_t number = 0; number < groups; number++) {
        struct leaf_seen seen;
        uint32_t in = see_group(r, &rows, number, true, &seen);
        if (in == 0)
            continue;
        if (at) {
            struct walk_best hits;
            keep_seen(&hits, &rows, number, &seen);
            in = admitted(tree, at, inside, &hits, in, seen.t);
            if (in == 0)
                continue;
        }
        keep(best, in, seen.t);
        keep_seen(best, &rows, number, &seen);
        found = true;
        if (number + 1 < groups)
            narrow(r, best->t);
    }
    return found;
}

/* `tree` is read by tiny trees alone. */
INLINE void write_hit(const struct fast_tree *tree, const struct walk_best *best, struct hit *hit)
{
    uint32_t lane = best->lane;
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    if (best->block)
        *hit = (struct hit){.t = best->t,
                            .u = best->v[lane] / best->det[lane],
                            .v = best->w[lane] / best->det[lane],
                            .prim = prim_of(tree, best->block, best->part, lane)};
}
