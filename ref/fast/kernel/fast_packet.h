/* Traces up to 16 rays together where they are alike: directions of the same signs and main axis. A
 * node is tested for all of them at once by bounds of their rays, then each child that remains for
 * each ray. Where few rays are left, they go on one by one. Hits are those of walk(), except among
 * triangles at the same t. Included by ref/fast/kernel/walk.h behind
 * ref/fast/kernel/fast_lanes.h. */

#define PACKET_FEW 3u /* so many rays go on alone */

/* Lanes that are alike. */
struct packet {
    struct lanes *l;
    /* Bounds of all rays: none enters a child before the least, or leaves it behind the most. */
    float8 least_scale[3], least_near[3], most_scale[3], most_far[3], least_tmin, most_tbest;
    size_t near_row[3], far_row[3];
    uint32_t axis[3];
};

struct packet_stack {
    uint32_t ref[FAST_STACK + FAST_WIDTH], key[FAST_STACK + FAST_WIDTH];
    uint32_t rays[FAST_STACK + FAST_WIDTH];
};

/* The least and the largest of the lanes in `rays`. */
INLINE float least16(float16 v, uint32_t rays)
{
    return least_of16(blend16(rays, all16(__builtin_inff()), v));
}

INLINE float most16(float16 v, uint32_t rays)
{
    return -least16(-v, rays);
}

/* Of no open lanes it is any number. */
INLINE void packet_narrow(struct packet *p)
{
    p->most_tbest = all8(most16(p->l->tbest, p->l->open));
}

/* The open lanes that are as the first one. */
INLINE uint32_t alike(const struct lanes *l)
{
    uint32_t lanes = l->open;
    if (lanes == 0)
        return 0;
    const uint32_t first = (uint32_t)__builtin_ctz(lanes);
    for (int k = 0; k < 3; k++) {
        lanes &= l->down[k] >> first & 1 ? l->down[k] : ~l->down[k];
        lanes &= l->main[k] >> first & 1 ? l->main[k] : ~l->main[k];
    }
    return lanes;
}

/* Makes a packet of the open lanes, which are alike. */
INLINE void packet_make(struct packet *p, struct lanes *l)
{
    struct walk_ray first;
    p->l = l;
    lane_ray(l, (uint32_t)__builtin_ctz(l->open), &first);
    for (int k = 0; k < 3; k++) {
        p->near_row[k] = first.near_row[k];
        p->far_row[k] = first.far_row[k];
        p->axis[k] = first.axis[k];
        p->least_scale[k] = all8(least16(l->scale[k], l->open));
        p->least_near[k] = all8(least16(l->near[k], l->open));
        p->most_scale[k] = all8(most16(l->scale[k], l->open));
        p->most_far[k] = all8(most16(l->far[k], l->open));
    }
    p->least_tmin = all8(least16(l->tmin, l->open));
    packet_narrow(p);
}

/* --- leaves and nodes ------------------------------------------------------------------------- */

/* Tests all triangles of a leaf for the lanes `rays`, with the operations of test_leaf. */
INLINE void packet_leaf(struct packet *p, const struct fast_tree *tree, uint32_t leaf, bool any,
                        uint32_t rays)
{
    struct lanes *l = p->l;
    const uint32_t *block = tree->block + (leaf & (FAST_LEAF_WORDS - 1));
    const uint32_t n = (leaf >> FAST_LEAF_COUNT & 15u) + 1;
    const float *row = (const float *)(const void *)(block + BLOCK_CORNERS);
    const float *from[3] = {row + p->axis[0] * n, row + p->axis[1] * n, row + p->axis[2] * n};
    float16 x[BLOCK_VERTICES], y[BLOCK_VERTICES], z[BLOCK_VERTICES];
    for (uint32_t i = 0; i < n; i++) {
        const float16 az = from[2][i] - l->o[2];
        x[i] = from[0][i] - l->o[0] - l->shear[0] * az;
        y[i] = from[1][i] - l->o[1] - l->shear[1] * az;
        z[i] = l->shear[2] * az;
    }
    const uint32_t used = block[0] | block[1] | block[2]; /* an absent triangle has no bits */
    const float16 zero = all16(0);
    for (uint32_t i = 0; i < BLOCK_TRIS && used >> (4 * i) && rays; i++) {
        const uint32_t a = block[0] >> (4 * i) & 15, b = block[1] >> (4 * i) & 15,
                       c = block[2] >> (4 * i) & 15;
        const float16 w0 = x[c] * y[b] - y[c] * x[b];
        const float16 w1 = x[a] * y[c] - y[a] * x[c];
        const float16 w2 = x[b] * y[a] - y[b] * x[a];
        const float16 det = (w0 + w1) + w2;
        uint32_t in =
            rays & unequal16(det, zero) &
            ~(less16(min16(min16(w0, w1), w2), zero) & less16(zero, max16(max16(w0, w1), w2)));
        if (in == 0)
            continue;
        float16 t = (w0 * z[a] + w1 * z[b]) + w2 * z[c];
        t = t / det;
        in &= not_above16(l->tmin, t) & less16(t, l->tbest);
        lanes_keep(l, any, in, t, w1, w2, det, block_prim(block, n, i));
        if (any)
            rays &= ~in;
    }
    packet_narrow(p);
}

/* Pushes the children that any of the lanes `rays` meets, the nearest last. */
INLINE void packet_node(const struct packet *p, const struct fast_node *node, uint32_t rays,
                        struct packet_stack *stack, size_t *depth)
{
    const struct lanes *l = p->l;
    const uint16_t *row = node->bound[0][0];
    float near[3][FAST_WIDTH] __attribute__((aligned(32)));
    float far[3][FAST_WIDTH] __attribute__((aligned(32)));
    uint32_t lanes[FAST_WIDTH], met = 0;
    float8 entry = p->least_tmin, exit = p->most_tbest;
    for (int k = 0; k < 3; k++) {
        const float8 n = planes(row + p->near_row[k]), f = planes(row + p->far_row[k]);
        memcpy(near[k], &n, sizeof n);
        memcpy(far[k], &f, sizeof f);
        entry = max8(fma8(n, p->least_scale[k], p->least_near[k]), entry);
        exit = min8(fma8(f, p->most_scale[k], p->most_far[k]), exit);
    }
    for (uint32_t rest = not_above(entry, exit); rest; rest &= rest - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(rest);
        float16 in = l->tmin, out = l->tbest;
        for (int k = 0; k < 3; k++) {
            in = max16(fma16(all16(near[k][i]), l->scale[k], l->near[k]), in);
            out = min16(fma16(all16(far[k][i]), l->scale[k], l->far[k]), out);
        }
        lanes[i] = not_above16(in, out) & rays;
        met |= (uint32_t)(lanes[i] != 0) << i;
    }
    if (met == 0)
        return;
    const uint32_t count = push(stack->key + *depth, stack->ref + *depth, node->ref, met, entry);
    for (uint32_t i = 0; i < count; i++)
        stack->rays[*depth + i] = lanes[stack->key[*depth + i] & 7];
    *depth += count;
}

/* --- the traversal ---------------------------------------------------------------------------- */

INLINE void walk_packet(struct packet *p, const struct fast_tree *tree, bool any)
{
    struct packet_stack stack;
    size_t depth = 1;
    stack.ref[0] = stack.key[0] = 0;
    stack.rays[0] = p->l->open;
    while (depth > 0) {
        depth--;
        const uint32_t ref = stack.ref[depth], key = stack.key[depth] & ~7u;
        uint32_t rays = stack.rays[depth] & p->l->open;
        if (!any)
            rays &= not_above16(all16(float_from_bits(key)), p->l->tbest);
        if (rays == 0)
            continue;
        if ((uint32_t)__builtin_popcount(rays) <= PACKET_FEW) {
            lanes_apart(p->l, tree, ref, any, rays);
            packet_narrow(p);
        } else if (ref & FAST_LEAF) {
            packet_leaf(p, tree, ref, any, rays);
        } else {
            packet_node(p, &tree->node[ref], rays, &stack, &depth);
        }
    }
}

/* Traces 16 rays; those that are not alike, as many. */
INLINE void packet_trace(const struct fast_tree *tree, const struct ray *ray, bool any,
                         struct hit *hit)
{
    struct lanes l;
    struct packet p;
    lanes_prepare(&l, tree, ray);
    l.open &= alike(&l);
    uint32_t apart = LANES_ALL & ~l.open;
    if ((uint32_t)__builtin_popcount(l.open) <= PACKET_FEW) {
        apart = LANES_ALL;
    } else {
        packet_make(&p, &l);
        walk_packet(&p, tree, any);
        lanes_write(&l, hit);
    }
    for (; apart; apart &= apart - 1) {
        const uint32_t i = (uint32_t)__builtin_ctz(apart);
        walk(tree, &ray[i], any, &hit[i]);
    }
}

/* Where a ray meets the plane through the scene's middle that is across its main axis. */
INLINE float4 at_middle(const struct fast_tree *tree, const struct ray *ray)
{
    float4 o, d, lo, extent;
    memcpy(&o, (const char *)ray + offsetof(struct ray, org), sizeof o);
    memcpy(&d, (const char *)ray + offsetof(struct ray, dir), sizeof d);
    memcpy(&lo, tree->lo, sizeof lo);
    memcpy(&extent, tree->extent, sizeof extent);
    const float4 size = size4(d), ahead = (lo + extent * 0.5f - o) / d;
    const uint32_t main = (uint32_t)__builtin_ctz((bits4((float4)(size == most3(size))) & 7) | 8);
    return o + d * all4(ahead[main & 3]);
}

/* Whether 16 rays may be alike, by four of them: to prepare them at once does not pay otherwise.
 * Rays that are many triangles apart do not stay together for long. */
INLINE bool seem_alike(const struct fast_tree *tree, const struct ray *ray)
{
    uint32_t differ = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 5; i < 16; i += 5)
            differ |= float_bits(ray[0].dir[k]) ^ float_bits(ray[i].dir[k]);
    if (differ >> 31)
        return false;
    float4 first = at_middle(tree, ray), most = {0, 0, 0, 0};
    for (int i = 5; i < 16; i += 5)
        most = max4(size4(at_middle(tree, ray + i) - first), most);
    return most3(most)[0] <= tree->packet_width;
}

INLINE void walk_packets(const struct fast_tree *tree, const struct ray *ray, size_t count,
                         bool any, struct hit *hit)
{
    size_t apart = 0; /* the first ray that is not traced yet */
    for (size_t i = 0; i + LANES <= count; i += LANES) {
        for (size_t k = 0; k < LANES; k += 2) /* processors do not foresee it */
            __builtin_prefetch(ray + i + 2 * LANES + k);
        if (!seem_alike(tree, ray + i))
            continue;
        walk_apart(tree, ray + apart, i - apart, any, hit + apart);
        packet_trace(tree, ray + i, any, hit + i);
        apart = i + LANES;
    }
    walk_apart(tree, ray + apart, count - apart, any, hit + apart);
}
