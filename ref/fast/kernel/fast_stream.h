/* Traces rays that are not alike in a stream: some dozens are under way, and each of them makes a
 * step in its turn. What a ray meets decides hardly any branch, so a processor computes the steps
 * of several rays at once, and what the next ones read is prefetched. The hits are those of walk(),
 * except among triangles at the same t. Included by ref/fast/kernel/walk.h behind
 * ref/fast/kernel/fast_lanes.h, for kernels that define as well:
 *   push_all       writes the children of a mask; push() must have no branches for up to 4
 *   group_nearest  the first lane with the least number, of the lanes of a mask
 *   lanes16        four vectors, turned into four words of each lane */

#define STREAM_RAYS 64u              /* under way */
#define STREAM_DONE (FAST_LEAF | 1u) /* stands below all of a stack: no block begins at word 1 */

/* What a ray does next. */
enum { STREAM_NODE, STREAM_LEAF, STREAM_END, STREAM_KINDS };

/* The leaf of a best hit. */
struct stream_best {
    float v[GROUP], w[GROUP], det[GROUP];
    const uint32_t *block;
    uint32_t part, lane;
};

/* The part of a ray that is made for 16 at once: eight times four words. */
struct stream_ready {
    float scale[3], tmin, near[3], tbest; /* as of walk_ray */
    float far[3], none, o[4], shear[4];   /* the fourth words are not used */
    uint32_t axis[4], near_row[4], far_row[4];
};
#define STREAM_WORDS 8
_Static_assert(sizeof(struct stream_ready) == STREAM_WORDS * 16, "eight times four words");

struct stream_ray {
    _Alignas(64) struct stream_ready ready;
    uint32_t depth, now;
    uint32_t kept; /* best[kept] is of the best hit, the other one is written next */
    uint32_t is_hit;
    struct hit *hit;
    struct stream_best best[2];
    /* Room for one vector more, as push() writes whole vectors, and for STREAM_DONE. */
    uint32_t ref[FAST_STACK + 2 * FAST_WIDTH], key[FAST_STACK + 2 * FAST_WIDTH];
};

/* Rays by what they do next. Their numbers stand in 16 bits each of `count`: a compiler keeps it in
 * a register, and numbers in memory were a tenth slower. */
struct stream_lists {
    struct stream_ray *ray[STREAM_KINDS][STREAM_RAYS];
    uint64_t count;
};

/* The rays of a call that have not been started, and the places that are free for them. */
struct stream_source {
    const struct fast_tree *tree;
    const struct ray *ray;
    struct hit *hit;
    size_t next, count;
    struct stream_ray *spare[STREAM_RAYS];
    uint32_t spares;
};

INLINE uint32_t listed(uint64_t count, uint32_t kind)
{
    return count >> 16 * kind & 0xFFFF;
}

INLINE void list(struct stream_lists *lists, uint64_t *count, uint32_t kind, struct stream_ray *r)
{
    lists->ray[kind][listed(*count, kind)] = r;
    *count += UINT64_C(1) << 16 * kind;
}

/* --- beginning and end ------------------------------------------------------------------------ */

/* Writes the words of struct stream_ready of all lanes, in the order of lanes16. */
INLINE void lanes_ready(const struct lanes *l, float out[STREAM_WORDS][4 * LANES])
{
    const float16 none = all16(0);
    const float16 first[5][4] = {{l->scale[0], l->scale[1], l->scale[2], l->tmin},
                                 {l->near[0], l->near[1], l->near[2], l->tbest},
                                 {l->far[0], l->far[1], l->far[2], none},
                                 {l->o[0], l->o[1], l->o[2], none},
                                 {l->shear[0], l->shear[1], l->shear[2], none}};
    int16v axis[3], row[2][3];
    const int16v zero = (int16v)none;
    const uint32_t turned =
        (l->main[0] & l->down[0]) | (l->main[1] & l->down[1]) | (l->main[2] & l->down[2]);
    const int16v last = blend16i(l->main[2], blend16i(l->main[1], zero, zero + 1), zero + 2);
    const int16v after = blend16i(l->main[2], last + 1, zero);
    const int16v before = blend16i(l->main[0], last - 1, zero + 2);
    axis[0] = blend16i(turned, after, before);
    axis[1] = blend16i(turned, before, after);
    axis[2] = last;
    for (int k = 0; k < 3; k++) {
        const int16v down = blend16i(l->down[k], zero, zero + (int32_t)(3 * FAST_WIDTH));
        row[0][k] = down + (int32_t)FAST_WIDTH * k;
        row[1][k] = (int32_t)FAST_WIDTH * (k + 3) - down;
    }
    for (int i = 0; i < 5; i++)
        lanes16(first[i], out[i]);
    const float16 axes[4] = {(float16)axis[0], (float16)axis[1], (float16)axis[2], none};
    lanes16(axes, out[5]);
    for (int i = 0; i < 2; i++) {
        const float16 rows[4] = {(float16)row[i][0], (float16)row[i][1], (float16)row[i][2], none};
        lanes16(rows, out[6 + i]);
    }
}

/* Starts a ray at the root. */
INLINE void stream_start(struct stream_ray *r, float ready[STREAM_WORDS][4 * LANES], uint32_t lane,
                         struct hit *hit)
{
    const uint32_t place = 4 * (4 * (lane & 3) + (lane >> 2));
    for (int i = 0; i < STREAM_WORDS; i++)
        memcpy((char *)&r->ready + 16 * i, &ready[i][place], 16);
    r->depth = 1;
    r->now = 0;
    r->kept = r->is_hit = 0;
    r->hit = hit;
    r->best[0].v[0] = r->best[0].w[0] = 0;
    r->best[0].det[0] = 1;
    r->best[0].block = leaf_none;
    r->best[0].part = r->best[0].lane = 0;
    r->ref[0] = STREAM_DONE;
    r->key[0] = 0;
}

/* The lanes that meet a child of a node, by test_node. */
INLINE uint32_t lanes_meet(const struct lanes *l, const walk_node *node)
{
    uint32_t met = 0;
    for (uint32_t i = 0, n = node_children(node); i < n; i++) {
        float16 in = l->tmin, out = l->tbest;
        for (int k = 0; k < 3; k++) {
            const float16 lower = all16(node_code(node, 0, k, i));
            const float16 upper = all16(node_code(node, 1, k, i));
            const float16 near = blend16(l->down[k], lower, upper);
            const float16 far = blend16(l->down[k], upper, lower);
            in = max16(fma16(near, l->scale[k], l->near[k]), in);
            out = min16(fma16(far, l->scale[k], l->far[k]), out);
        }
        met |= not_above16(in, out);
    }
    return met & l->open;
}

/* Starts the next 16 rays, or as many as are left, but those that meet no child of the root. */
INLINE void stream_fill(struct stream_source *from, bool any, struct stream_lists *now)
{
    const size_t left = from->count - from->next;
    const uint32_t n = left < LANES ? (uint32_t)left : LANES;
    const struct ray *ray = from->ray + from->next;
    struct hit *hit = from->hit + from->next;
    struct ray last[LANES];
    struct lanes l;
    float ready[STREAM_WORDS][4 * LANES];
    if (n < LANES) {
        memset(last, 0, sizeof last); /* rays that no kernel traces */
        memcpy(last, ray, n * sizeof *ray);
    } else {
        for (size_t k = 0; k < LANES; k += 2)
            __builtin_prefetch(ray + 2 * LANES + k);
    }
    lanes_prepare(&l, from->tree, n < LANES ? last : ray);
    for (uint32_t i = 0; i < n; i++)
        hit[i] = (struct hit){.prim = ABI_NO_PRIM};
    uint32_t met = lanes_meet(&l, node_at(from->tree, 0));
    if (met)
        lanes_ready(&l, ready);
    for (uint32_t rest = met; rest; rest &= rest - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(rest);
        struct stream_ray *r = from->spare[--from->spares];
        stream_start(r, ready, lane, &hit[lane]);
        list(now, &now->count, STREAM_NODE, r);
    }
    for (uint32_t rest = ~l.open & ((1u << n) - 1); rest; rest &= rest - 1) {
        const uint32_t lane = (uint32_t)__builtin_ctz(rest);
        fast_careful(from->tree, &ray[lane], any, &hit[lane]);
    }
    from->next += n;
}

INLINE void stream_write(const struct fast_tree *tree, const struct stream_ray *r)
{
    const struct stream_best *best = &r->best[r->kept];
    const uint32_t lane = best->lane;
    *r->hit = (struct hit){.t = float_from_bits(float_bits(r->ready.tbest) & (0 - r->is_hit)),
                           .u = best->v[lane] / best->det[lane],
                           .v = best->w[lane] / best->det[lane],
                           .prim = prim_of(tree, best->block, best->part, lane)};
}

/* --- steps ------------------------------------------------------------------------------------ */

/* The ray as test_node and leaf_open read it. */
INLINE struct walk_ray stream_seen(const struct stream_ready *from)
{
    struct walk_ray r = {.key_most = 0};
    for (int k = 0; k < 3; k++) {
        r.scale[k] = all8(from->scale[k]);
        r.near[k] = all8(from->near[k]);
        r.far[k] = all8(from->far[k]);
        r.near_row[k] = from->near_row[k];
        r.far_row[k] = from->far_row[k];
        r.o[k] = all16(from->o[k]);
        r.shear[k] = all16(from->shear[k]);
        r.axis[k] = from->axis[k];
    }
    r.tmin = all8(from->tmin);
    r.tbest = all8(from->tbest);
    return r;
}

/* Pushes the children that the ray meets. Returns the depth of the stack. */
INLINE uint32_t stream_node(struct stream_ray *r, const struct fast_tree *tree, bool any)
{
    const struct walk_ray seen = stream_seen(&r->ready);
    const walk_node *node = node_at(tree, r->now);
    const uint32_t depth = r->depth;
    uint32_t own[FAST_WIDTH];
    const uint32_t *child = node_refs(node, own);
    float8 entry;
    const uint32_t mask = test_node(&seen, node, &entry);
    return depth + (any ? push_all(r->ref + depth, child, mask)
                        : push(r->key + depth, r->ref + depth, child, mask, entry));
}

/* Returns 1 if a triangle is hit, else 0. */
INLINE uint32_t stream_leaf(struct stream_ray *r, const struct fast_tree *tree)
{
    struct walk_ray ray = stream_seen(&r->ready);
    struct leaf_rows rows;
    const uint32_t groups = leaf_open(&ray, tree, r->now, &rows);
    uint32_t found = 0;
    for (uint32_t number = 0; number < groups; number++) {
        struct stream_best *best = &r->best[r->kept ^ 1];
        struct leaf_seen seen;
        const uint32_t in = see_group(&ray, &rows, number, false, &seen), hit = in != 0;
        float least;
        best->lane = group_nearest(seen.t, in, &least);
        memcpy(best->v, &seen.v, sizeof best->v);
        memcpy(best->w, &seen.w, sizeof best->w);
        memcpy(best->det, &seen.det, sizeof best->det);
        best->block = rows.block;
        best->part = leaf_part(&rows, number);
        r->kept ^= hit;
        r->is_hit |= hit;
        r->ready.tbest = least < r->ready.tbest ? least : r->ready.tbest;
        ray.tbest = all8(r->ready.tbest);
        found |= hit;
    }
    return found;
}

/* Pops what the ray does next, prefetches it, and puts the ray in that list.
 *   base   of nodes and of blocks
 *   over   1: the ray ends, else 0 */
INLINE void stream_next(struct stream_ray *r, uint32_t depth, const char *const base[2], bool any,
                        uint32_t over, struct stream_lists *to, uint64_t *count)
{
    const uint32_t key_most = float_bits(r->ready.tbest) | 7;
    do
        depth--;
    while (!any && r->key[depth] > key_most);
    const uint32_t now = (r->ref[depth] & (over - 1)) | (STREAM_DONE & (0 - over));
    r->depth = depth;
    r->now = now;
    const char *from = place_of(base, now);
    for (int i = 0; i < PLACE_LINES; i++)
        __builtin_prefetch(from + 64 * i);
    list(to, count, (now >> 31) + (now == STREAM_DONE), r);
}

/* --- the traversal ---------------------------------------------------------------------------- */

/* Each ray under way makes a step. */
INLINE void stream_step(const struct stream_lists *now, const struct fast_tree *tree, bool any,
                        struct stream_lists *to)
{
    const char *const base[2] = {(const char *)node_at(tree, 0), (const char *)tree->block};
    uint64_t count = 0;
    for (uint32_t i = 0, n = listed(now->count, STREAM_NODE); i < n; i++) {
        struct stream_ray *r = now->ray[STREAM_NODE][i];
        const uint32_t depth = stream_node(r, tree, any);
        stream_next(r, depth, base, any, 0, to, &count);
    }
    for (uint32_t i = 0, n = listed(now->count, STREAM_LEAF); i < n; i++) {
        struct stream_ray *r = now->ray[STREAM_LEAF][i];
        const uint32_t found = stream_leaf(r, tree);
        stream_next(r, r->depth, base, any, any & found, to, &count);
    }
    to->count = count;
}

INLINE void stream_walk(const struct fast_tree *tree, const struct ray *ray, size_t count, bool any,
                        struct hit *hit)
{
    struct stream_ray all[STREAM_RAYS];
    struct stream_lists lists[2];
    struct stream_source from = {
        .tree = tree, .ray = ray, .hit = hit, .count = count, .spares = STREAM_RAYS};
    for (uint32_t i = 0; i < STREAM_RAYS; i++)
        from.spare[i] = &all[i];
    lists[0].count = 0;
    for (uint32_t turn = 0;; turn ^= 1) {
        struct stream_lists *now = &lists[turn], *to = &lists[turn ^ 1];
        for (uint32_t i = 0, n = listed(now->count, STREAM_END); i < n; i++) {
            struct stream_ray *r = now->ray[STREAM_END][i];
            stream_write(tree, r);
            from.spare[from.spares++] = r;
        }
        while (from.spares >= LANES && from.next < count)
            stream_fill(&from, any, now);
        if (from.spares == STREAM_RAYS)
            return;
        stream_step(now, tree, any, to);
    }
}

/* Two functions, as several places call them. */
KERNEL_TARGET static __attribute__((noinline)) void
stream_closest(const struct fast_tree *tree, const struct ray *ray, size_t count, struct hit *hit)
{
    stream_walk(tree, ray, count, false, hit);
}

KERNEL_TARGET static __attribute__((noinline)) void
stream_any(const struct fast_tree *tree, const struct ray *ray, size_t count, struct hit *hit)
{
    stream_walk(tree, ray, count, true, hit);
}

INLINE void walk_stream(const struct fast_tree *tree, const struct ray *ray, size_t count, bool any,
                        struct hit *hit)
{
    if (any)
        stream_any(tree, ray, count, hit);
    else
        stream_closest(tree, ray, count, hit);
}
