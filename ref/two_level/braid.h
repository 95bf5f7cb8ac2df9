/* Re-braiding: the top of a world may name parts of instances in place of whole ones (Benthin,
 * Wald, Woop, Afra 2017, Improved Two-Level BVHs using Partial Re-Braiding). Long instances that
 * lie across each other have boxes that overlap; those of their parts overlap less.
 *
 * A part is an instance and a node of the tree of its mesh: the triangles below it. Opening
 * replaces an entry of the top by one for each child of its node. The entry of the largest gain is
 * opened next (braid_gain), of equal ones that of the first instance, until the budget is spent. A
 * ray enters an entry about as often as its box has surface, so what is saved is the surface of the
 * box less that of the children's; these count for 3/4, since smaller boxes also are better told
 * apart by the nodes above. The paper opens what is largest, also where the children's boxes are
 * nearly the parent's, as those of two sides of a box are.
 *
 * What stays whole: an instance whose mesh is one leaf; one whose mesh has a split tree, since
 * parts of it would share triangles; and what would need boxes too wide (below). The paper measures
 * extents against the world's; here width is what an entry costs, so this is the measure.
 *
 * Seams. A ray is moved into the space of a mesh with rounding (ref/world/object_ray.h). One entry
 * for an instance needs no allowance for that: all its triangles are tested with one moved ray, and
 * the exact ray meets the exact box wherever it meets a triangle. With parts the moved ray may pass
 * from a triangle of one part, which the exact ray meets, into its neighbour in another part, whose
 * box the exact ray misses: a watertight test would lose the hit. So all boxes of a braided top are
 * tested as if they were wider, by e = share (|o| + reach), |o| the largest coordinate of the ray's
 * origin: one product and one sum a ray.
 *
 * The bound. u = 2^-24; sums and products are off by a u, divisions by r u (a = 1, r = 1 by IEEE
 * 754; 2 and 5 in Vulkan at worst). Norms are those of the largest coordinate, |M| has the sizes of
 * the numbers of M, K = | |M| |M^-1| |, N = | |M| |. Let the moved ray o', d' be found by the
 * watertight test to meet a triangle at t, at p' = o' + t d', and let q = M p' + T be that point in
 * the world. The exact ray is there at o + t d = q - M (e_o + t e_d), e_o and e_d being what o' and
 * d' are off. To first order, with x = o - T:
 *   origin     |M| |e_o| <= (4a + 1) u K |x|: W once, the difference, the products, two sums each
 *   direction  |M| |t e_d| <= (3a + 1) u K |t d|
 *   test       Woop's places are off by what docs/numerics.md (Boxes, watertight) says: along each
 *              axis of the mesh the point is a mean of the triangle's vertices, at another t: off
 *              by ((4a + r) t + 4a rho) u, rho at most L / |d'_z|, L being the longest side of the
 *              mesh's box and d'_z the largest component of d'. In the world that is (4a + r) u K
 *              |t d| + 4a u K N L, since |d| <= N |d'_z|. The means of the axes have weights that
 *              differ by 4a u: the point is that far, times L, from the triangle: 4a u N L.
 *   planes     slab_ray_widen rounds by a u (|o| + e)
 * With |x| <= |o| + |T|, |t d| <= |o| + B, B the largest coordinate of the instance's box, and R
 * the largest of |T|, B and N L over all opened instances, the sum is at most
 *   u K ((12a + r + 2) |o| + (19a + r + 2) R)   31 |o| + 45 R at a = 2, r = 5
 * since K >= 1. 64 u K (|o| + R) has room for what is left: products of errors, which are below
 * 2^-8 of this for K <= 2^10, and e's own two roundings; share and reach are rounded up. Numbers
 * are kept within 2^-40 .. 2^40, so that what is lost below 2^-126 is far below u R. Then the exact
 * ray is in the widened box at t, and the box test allows for its own rounding as always.
 *
 * A part is not opened, nor its instance, where e of a ray that begins within the reach, 2 share
 * reach, would be over 2^-6 of the longest side of its box: such boxes would be wide in vain, and
 * all others with them. */
#ifndef BRAID_H
#define BRAID_H

#include "ref/tree/bvh.h"
#include "ref/world/world_boxes.h"

#define BRAID_MOST       64u        /* largest world_build.braid */
#define BRAID_ENTRIES    (1u << 29) /* most entries that opening makes */
#define BRAID_SHARE      0x1p-18    /* 64 u */
#define BRAID_KAPPA_MOST 0x1p10     /* instances of larger K stay whole */
#define BRAID_WIDTH_MOST 0x1p-6     /* of the longest side of a box */
#define BRAID_LARGEST    0x1p40     /* of R, N and the inverse's numbers */
#define BRAID_LEAST      0x1p-40    /* of R */

struct world_part {
    uint32_t instance;
    uint32_t node; /* of the tree of its mesh; not 0, which is all of it */
};

/* Owns `part` (see world_parts_free). An instance that has parts is opened: together they have each
 * triangle of its mesh once. */
struct world_parts {
    struct world_part *part; /* by instance, then by node; NULL: none */
    uint32_t count;
    float share, reach; /* of braid_width; 0 without parts */
};

/* e above: the same operations in shaders/world.glsl. */
static inline float braid_width(float share, float reach, const float org[3])
{
    float largest = 0.0f;
    for (int k = 0; k < 3; k++) {
        float a = org[k] < 0.0f ? -org[k] : org[k];
        largest = a > largest ? a : largest;
    }
    return share * (largest + reach);
}

/* What opening is worth: surface that it saves. `child` are the boxes of the node's children. */
static inline double braid_gain(const struct box *box, const struct box child[2])
{
    return box_half_area(box) - 0.75 * (box_half_area(&child[0]) + box_half_area(&child[1]));
}

/* What share and reach must be at least if the instance, whose box is `box`, is opened; false if it
 * must not be opened. */
bool braid_needs(const struct world *world, uint32_t instance, const struct box *box, float *share,
                 float *reach);

/* Opens instances until the top has braid * (active instances) entries, or BRAID_ENTRIES, or
 * nothing is left to be opened. Of 0 and 1 there are no parts.
 *   bottom  the trees of the meshes
 *   box     the boxes of the instances
 *   how     what boxes of parts are made of, as those of instances
 * *part_box has the box of each part, count of them, or is NULL; caller frees. Errors:
 * STATUS_MEMORY; *out and *part_box are then zero. */
enum status braid_make(const struct world *world, const struct bvh *bottom, const struct box *box,
                       enum world_boxes how, uint32_t braid, struct world_parts *out,
                       struct box **part_box, struct reason *reason) MUST_USE;

void world_parts_free(struct world_parts *parts); /* zero ones are fine */

#endif
