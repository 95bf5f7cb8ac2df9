/* The traversal, compiled once for every kind of processor. The including file defines
 * KERNEL_TARGET (an attribute, or nothing), INLINE, and these on the vectors of vectors.h:
 *   planes      8 codes as floats              fma8       a * b + c, rounded once or twice
 *   max4, max8  a if a > b, else b             min8       a if a < b, else b
 *   bits4       the lanes' sign bits           permute4   lanes selected by an index vector
 *   lane8       one of 4 lanes, copied to 8    lane16     one of 4 lanes, copied to 16
 *   less, unequal, not_above                   bits of the lanes where it holds
 *   vertices    a row of up to 16 floats       corners    8 of a row, by 4-bit codes
 *   codes       the 8 4-bit codes of a word
 *   push        writes three or more children, farthest first; push_any all but the last
 * and groups of triangles: ref/fast/kernel/walk_group.h. FAST_SMALL chooses the nodes
 * and leaves of ref/fast/small_tree.h, FAST_TINY the nodes and the leaves of tiny trees. All
 * comparisons with NaN are false, also by unequal. */
#include "ref/fast/fast.h"

#include "ref/fast/block.h"
#include "ref/fast/fast_world.h"
#include "ref/world/candidate.h"

#include <string.h>

/* Half the padding of the bounds, relative to the largest distance of the scene from the ray's
 * origin in any axis (docs/numerics.md, "Boxes", fast). */
#define FAST_PAD 0x1p-19f

/* The axes that woop calls x, y, z; row 2 * main axis, plus 1 if the ray's direction is negative
 * there. */
static const int32_t axes_of[6][4] __attribute__((aligned(16))) = {
    {1, 2, 0, 0}, {2, 1, 0, 0}, {2, 0, 1, 0}, {0, 2, 1, 0}, {0, 1, 2, 0}, {1, 0, 2, 0},
};

/* A ray, prepared for traversal. */
struct walk_ray {
    float8 scale[3], near[3], far[3]; /* t of a bound is code * scale + near (or far) */
    float8 tmin, tbest;
    size_t near_row[3], far_row[3]; /* offsets of the near and far bounds in a node */
    float16 o[3], shear[3];         /* woop */
    uint32_t axis[3];
    float tlimit;      /* hits must have t below it */
    uint32_t key_most; /* stack entries with larger keys are farther than the best hit */
};

/* The best hit; u and v are divided at the end. */
struct walk_best {
    float v[GROUP], w[GROUP], det[GROUP];
    float t;
    const uint32_t *block; /* NULL: no hit */
    uint32_t part, lane;   /* as prim_of takes them */
};

/* The stack. It has room for one vector more, as push writes whole vectors. */
struct walk_stack {
    uint32_t ref[FAST_STACK + FAST_WIDTH], key[FAST_STACK + FAST_WIDTH];
};

/* The current place of a traversal, in a struct of its own so that it stays in registers. */
struct walk_place {
    size_t depth;
    uint32_t now; /* the reference to visit next */
};

INLINE float4 all4(float x)
{
    return (float4){x, x, x, x};
}

INLINE int4 all4i(int32_t x)
{
    return (int4){x, x, x, x};
}

INLINE float4 size4(float4 v)
{
    return (float4)((int4)v & 0x7FFFFFFF);
}

/* The largest of the first three lanes, copied to these three. */
INLINE float4 most3(float4 v)
{
    return max4(permute4(v, (int4){2, 0, 1, 0}), max4(permute4(v, (int4){1, 2, 0, 0}), v));
}

INLINE void narrow(struct walk_ray *r, float t)
{
    r->tlimit = t;
    r->tbest = all8(t);
    r->key_most = float_bits(t) | 7;
}

/* The next float above tmax, so that a hit at exactly tmax is below it. */
INLINE float above(float tmax)
{
    uint32_t bits = float_bits(tmax);
    return float_from_bits(bits + (bits < 0x7F800000u));
}

INLINE void prepare_woop(struct walk_ray *r, float4 o, float4 d, uint32_t main, uint32_t signs)
{
    const int32_t *axes = axes_of[2 * main + (signs >> main & 1)];
    int4 order;
    memcpy(&order, axes, sizeof order);
    float4 from = permute4(o, order), to = permute4(d, order);
    float4 over = {to[0], to[1], 1, 1};
    float4 shear = over / all4(to[2]);
    for (int k = 0; k < 3; k++) {
        r->o[k] = lane16(from, k);
        r->shear[k] = lane16(shear, k);
        r->axis[k] = (uint32_t)axes[k];
    }
}

/* Returns false if the kernel cannot trace the ray: NaN, infinity, or numbers that could overflow
 * or underflow below. Direction components below 2^-60 of the largest one are raised to that: the
 * padding of such an axis is beyond any hit. */
INLINE bool prepare(struct walk_ray *r, const struct fast_tree *tree, const struct ray *ray)
{
    float4 o, d, lo, step, extent;
    memcpy(&o, (const char *)ray + offsetof(struct ray, org), sizeof o); /* and tmin */
    memcpy(&d, (const char *)ray + offsetof(struct ray, dir), sizeof d); /* and tmax */
    memcpy(&lo, tree->lo, sizeof lo);
    memcpy(&step, tree->step, sizeof step);
    memcpy(&extent, tree->extent, sizeof extent);
    float4 size = size4(d), largest = most3(size);
    float4 safe = max4(largest * 0x1p-60f, size);
    safe = (float4)((int4)safe | ((int4)d & INT32_MIN));
    float4 inverse = 1.0f / safe;
    float4 away = lo - o, off = away * inverse;
    float4 most = most3(size4(away) + extent);
    float4 span = most * size4(inverse);
    float4 pad = span * FAST_PAD;
    uint32_t fine = bits4((float4)(size4(off) + span < all4(0x1p100f))) & 7;
    if (!(fine == 7 && most[0] < tree->reach && largest[0] >= 0x1p-40f && largest[0] <= 0x1p40f &&
          ray->tmin >= 0.0f && ray->tmax >= ray->tmin))
        return false;
    uint32_t signs = bits4(d);
    float4 scale = step * inverse, near = off - pad, far = off + pad;
    for (int k = 0; k < 3; k++) {
        bool down = signs >> k & 1;
        r->scale[k] = lane8(scale, k);
        r->near[k] = lane8(near, k);
        r->far[k] = lane8(far, k);
        r->near_row[k] = (size_t)((down ? 3 : 0) + k) * FAST_WIDTH;
        r->far_row[k] = (size_t)((down ? 0 : 3) + k) * FAST_WIDTH;
    }
    uint32_t is_largest = bits4((float4)(size == largest)) & 7;
    prepare_woop(r, o, d, (uint32_t)__builtin_ctz(is_largest), signs);
    r->tmin = all8(ray->tmin + 0.0f); /* -0 becomes 0: keys are compared as integers */
    narrow(r, above(ray->tmax));
    return true;
}

#include "ref/fast/kernel/leaf_row.h"

/* The vertices of a leaf, translated and sheared. */
struct leaf_rows {
    leaf_row x, y, az;
    const uint32_t *block;
    uint32_t vertices, tris; /* the second by small and tiny trees alone */
};

#if defined FAST_TINY
#include "ref/fast/kernel/walk_tiny.h"
#elif defined FAST_SMALL
#include "ref/fast/kernel/walk_small.h"
#else
#include "ref/fast/kernel/walk_plain.h"
#endif

/* Returns the nearest child and pushes the others on the stack. `mask` is not 0. */
INLINE uint32_t choose(uint32_t *key, uint32_t *ref, size_t *depth, const uint32_t *child,
                       uint32_t mask, float8 entry)
{
    uint32_t bits[FAST_WIDTH];
    uint32_t i = (uint32_t)__builtin_ctz(mask), rest = mask & (mask - 1);
    if (rest == 0)
        return child[i];
    if ((rest & (rest - 1)) == 0) {
        uint32_t j = (uint32_t)__builtin_ctz(rest);
        memcpy(bits, &entry, sizeof bits);
        bool second = bits[j] < bits[i];
        ref[*depth] = child[second ? i : j];
        key[(*depth)++] = bits[second ? i : j];
        return child[second ? j : i];
    }
    *depth += push(key + *depth, ref + *depth, child, mask, entry) - 1;
    return ref[*depth];
}

#include "ref/fast/kernel/walk_leaf.h"

/* Moves from a node to one of its children; returns false if the ray meets none. */
INLINE bool descend(const struct walk_ray *r, const struct fast_tree *tree, bool any,
                    struct walk_stack *stack, struct walk_place *at)
{
    const walk_node *node = node_at(tree, at->now);
    uint32_t own[FAST_WIDTH];
    const uint32_t *child = node_refs(node, own);
    float8 entry;
    uint32_t mask = test_node(r, node, &entry);
    if (mask == 0)
        return false;
    if (any) {
        at->depth += push_any(stack->ref + at->depth, child, mask);
        at->now = child[31 - __builtin_clz(mask)]; /* in the order of a stream's rays */
    } else {
        at->now = choose(stack->key, stack->ref, &at->depth, child, mask, entry);
    }
    return true;
}

/* Returns true if the traversal is finished. `in` and `inside` as test_leaf's. */
INLINE bool visit_leaf(struct walk_ray *r, const struct fast_tree *tree, bool any,
                       const struct instance_at *in, const struct ray *inside,
                       struct walk_best *best, const struct walk_place *at)
{
    if (!test_leaf(r, tree, at->now, in, inside, best))
        return false;
    if (!any)
        narrow(r, best->t);
    return any;
}

/* Moves to the top of the stack; returns false if the stack is empty. */
INLINE bool pop(const struct walk_ray *r, bool any, const struct walk_stack *stack,
                struct walk_place *at)
{
    do {
        if (at->depth == 0)
            return false;
        at->depth--;
    } while (!any && stack->key[at->depth] > r->key_most);
    at->now = stack->ref[at->depth];
    return true;
}

/* Traverses a tree from a node or leaf on. */
INLINE void walk_from(struct walk_ray *r, const struct fast_tree *tree, uint32_t from, bool any,
                      const struct instance_at *in, const struct ray *inside,
                      struct walk_best *best)
{
    struct walk_stack stack;
    struct walk_place at = {0, from};
    do {
        while (!(at.now & FAST_LEAF))
            if (!descend(r, tree, any, &stack, &at))
                goto missed;
        if (visit_leaf(r, tree, any, in, inside, best, &at))
            break;
    missed:;
    } while (pop(r, any, &stack, &at));
}

/* Traverses a tree from its root. */
INLINE void walk_tree(struct walk_ray *r, const struct fast_tree *tree, bool any,
                      const struct instance_at *in, const struct ray *inside,
                      struct walk_best *best)
{
    walk_from(r, tree, 0, any, in, inside, best);
}

INLINE void walk(const struct fast_tree *tree, const struct ray *ray, bool any, struct hit *hit)
{
    struct walk_ray r;
    struct walk_best best = {.block = NULL, .lane = 0};
    if (!prepare(&r, tree, ray)) {
        fast_careful(tree, ray, any, hit);
        return;
    }
    walk_tree(&r, tree, any, NULL, NULL, &best);
    write_hit(tree, &best, hit);
}

#include "ref/fast/kernel/fast_pair.h"

#ifdef FAST_LANES
#include "ref/fast/kernel/fast_lanes.h"
#include "ref/fast/kernel/fast_stream.h"
#endif

/* Traces rays on their own. */
INLINE void walk_apart(const struct fast_tree *tree, const struct ray *ray, size_t count, bool any,
                       struct hit *hit)
{
#ifdef FAST_LANES
    if (tree->in_stream && count >= LANES) {
        walk_stream(tree, ray, count, any, hit);
        return;
    }
#endif
    if (tree->in_pairs && count > 1)
        walk_pairs(tree, ray, count, any, hit);
    else
        for (size_t i = 0; i < count; i++)
            walk(tree, &ray[i], any, &hit[i]);
}

#ifdef FAST_PACKETS
#include "ref/fast/kernel/fast_packet.h"
#endif

INLINE void walk_many(const struct fast_tree *tree, const struct ray *ray, size_t count, bool any,
                      struct hit *hit)
{
#ifdef FAST_PACKETS
    if (tree->in_packets) {
        walk_packets(tree, ray, count, any, hit);
        return;
    }
#endif
    walk_apart(tree, ray, count, any, hit);
}

KERNEL_TARGET static void closest(const struct fast_tree *tree, const struct ray *ray, size_t count,
                                  struct hit *hit)
{
    walk_many(tree, ray, count, false, hit);
}

KERNEL_TARGET static void any_hit(const struct fast_tree *tree, const struct ray *ray, size_t count,
                                  struct hit *hit)
{
    walk_many(tree, ray, count, true, hit);
}

#if !defined FAST_SMALL && !defined FAST_TINY
#include "ref/fast/kernel/walk_world.h"
#endif
