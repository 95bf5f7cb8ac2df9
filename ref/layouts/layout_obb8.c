/* Layout `obb8`: nodes of eight children that have, beside boxes, bounds along three oblique axes,
 * which all children of a node share: what lies below a child is in its box and in an oriented box.
 *   words 0-2    origin of the boxes' frame, float32
 *   word 3       bytes ex, ey, ez: exponents of its steps, plus 127; byte 3: 1 if there are axes
 *   word 4       record of its first child that is a node; these records are adjacent
 *   word 5       item slot of its first leaf's first item; the leaves' items are adjacent
 *   word 6       four bits for each child: 0 none, 1 to 3 the items of a leaf, 15 a node
 *   word 7       bytes: exponents of the steps along the axes, plus 127; bits 24-27: z of axis 2
 *   words 8-10   origin along the axes, float32
 *   word 11      four bits each, signed: x, y, z of axes 0 and 1, x and y of axis 2
 *   words 12-23  lo x, lo y, lo z, hi x, hi y, hi z: two words each, a byte for each child; plane q
 *                lies at origin + q * 2^e (ref/layouts/wide_nodes.h)
 *   words 24-35  the same along axes 0, 1, 2
 * A point's place along an axis is its product with it, not divided by its length. Bounds are those
 * of triangles, not of boxes, so a tree is built anew, not refitted. */
#include "ref/layouts/oblique.h"
#include "ref/layouts/wide_nodes.h"

#include <math.h>
#include <stdlib.h>

#define WORDS      36u
#define WIDTH      8u
#define LEAF_MOST  3u
#define PLANES     255u
#define INNER      15u
#define BOX_AT     12u
#define OBLIQUE_AT 24u
#define LARGEST    0x1p96f /* places along axes are at most 2^100 */

/* What a bound along an axis may be beside the ray, of the magnitudes that it is computed from:
 * more than all roundings, and more than woop moves a triangle (docs/layouts.md). */
#define BESIDE       0x1p-18f
#define BESIDE_LEAST 0x1p-99f
#define SLACK        0x1p-18f /* of distances */
#define PARALLEL     0x1p-100f

/* --- words ------------------------------------------------------------------------------------ */

static uint32_t byte_of(const uint32_t *word, uint32_t at)
{
    return word[at / 4] >> at % 4 * 8 & 0xFFu;
}

static void put_byte(uint32_t *word, uint32_t at, uint32_t value)
{
    word[at / 4] &= ~(0xFFu << at % 4 * 8);
    word[at / 4] |= value << at % 4 * 8;
}

static void put_planes(const struct node_axis *axis, uint32_t k, uint32_t s, float lo, float hi,
                       uint32_t *word)
{
    put_byte(word, WIDTH * k + s, node_axis_down(axis, lo));
    put_byte(word, WIDTH * (3 + k) + s, node_axis_up(axis, hi));
}

static void put_boxes(const struct box *const box[WIDTH], uint32_t *word)
{
    struct box all = wide_nodes_frame(box);
    for (uint32_t k = 0; k < 3; k++) {
        struct node_axis axis = node_axis_make(all.lo[k], all.hi[k], PLANES);
        word[k] = float_bits(axis.origin);
        put_byte(word + 3, k, (uint32_t)(axis.exponent + 127));
        for (uint32_t s = 0; s < WIDTH; s++)
            if (box[s])
                put_planes(&axis, k, s, box[s]->lo[k], box[s]->hi[k], word + BOX_AT);
    }
}

static void put_children(const struct wide_child *child, uint32_t count, uint32_t *word)
{
    bool have_node = false, have_leaf = false;
    for (uint32_t s = 0; s < count; s++) {
        word[6] |= (child[s].count ? child[s].count : INNER) << 4 * s;
        bool *have = child[s].count ? &have_leaf : &have_node;
        if (!*have)
            word[child[s].count ? 5 : 4] = child[s].first;
        *have = true;
    }
}

static struct node_axis axis_at(const uint32_t *origin, const uint32_t *exponents, uint32_t k)
{
    return (struct node_axis){float_from_bits(origin[k]), (int)byte_of(exponents, k) - 127};
}

static void decode(const struct packed *packed, uint32_t record, struct wide_slot *slot)
{
    const uint32_t *word = packed->word + (size_t)WORDS * record;
    uint32_t next_node = word[4], next_item = word[5];
    for (uint32_t s = 0; s < WIDTH; s++) {
        uint32_t kind = word[6] >> 4 * s & 15u;
        slot[s].there = kind != 0;
        slot[s].first = kind == INNER ? next_node : next_item;
        slot[s].count = kind == INNER ? 0 : kind;
        next_node += kind == INNER;
        next_item += slot[s].count;
    }
    for (uint32_t k = 0; k < 3; k++) {
        const struct node_axis axis = axis_at(word, word + 3, k);
        for (uint32_t s = 0; s < WIDTH; s++) {
            slot[s].box.lo[k] = node_axis_plane(&axis, byte_of(word + BOX_AT, WIDTH * k + s));
            slot[s].box.hi[k] = node_axis_plane(&axis, byte_of(word + BOX_AT, WIDTH * (3 + k) + s));
        }
    }
}

/* Component k of axis j. */
static float component(const uint32_t *word, uint32_t j, uint32_t k)
{
    uint32_t i = 3 * j + k, four = i < 8 ? word[11] >> 4 * i : word[7] >> 24;
    return (float)((int)((four & 15u) ^ 8u) - 8);
}

static void put_axes(const tilt_axes axes, uint32_t *word)
{
    word[3] |= 1u << 24;
    for (uint32_t i = 0; i < 8; i++)
        word[11] |= ((uint32_t)axes[i / 3][i % 3] & 15u) << 4 * i;
    word[7] |= ((uint32_t)axes[2][2] & 15u) << 24;
}

/* --- bounds along axes ------------------------------------------------------------------------ */

/* Returns the rotation whose boxes, where they are smaller, save most; TILTS if none is smaller. */
static uint32_t best_tilt(const struct wide_slot *slot, const struct spans *span)
{
    uint32_t best = TILTS;
    double most = 0;
    for (uint32_t t = 0; t < TILTS; t++) {
        double saved = 0;
        for (uint32_t s = 0; s < WIDTH; s++)
            if (slot[s].there)
                saved += fmax(0, box_half_area(&slot[s].box) - spans_area(&span[s], t));
        if (saved > most) {
            most = saved;
            best = t;
        }
    }
    return best;
}

static void put_tilt(const struct wide_slot *slot, const struct spans *span, uint32_t t,
                     uint32_t *word)
{
    if (t < TILTS)
        put_axes(tilts[t], word);
    for (uint32_t j = 0; j < 3 && t < TILTS; j++) {
        float lo = INFINITY, hi = -INFINITY;
        for (uint32_t s = 0; s < WIDTH; s++)
            if (slot[s].there) {
                lo = fminf(lo, span[s].lo[t][j]);
                hi = fmaxf(hi, span[s].hi[t][j]);
            }
        const struct node_axis axis = node_axis_make(lo, hi, PLANES);
        word[8 + j] = float_bits(axis.origin);
        put_byte(word + 7, j, (uint32_t)(axis.exponent + 127));
        for (uint32_t s = 0; s < WIDTH; s++)
            if (slot[s].there)
                put_planes(&axis, j, s, span[s].lo[t][j], span[s].hi[t][j], word + OBLIQUE_AT);
    }
}

/* Writes the axes of all records, the last first: children come after their parents. */
static enum status tilt(const struct scene *scene, struct packed *out, struct reason *reason)
{
    struct spans *all = alloc_zeroed(out->node_count, sizeof *all);
    if (!all)
        return fail(reason, STATUS_MEMORY, "obb8: no memory for the bounds of %u nodes",
                    out->node_count);
    for (uint32_t r = out->node_count; r-- > 0;) {
        struct wide_slot slot[WIDTH];
        struct spans span[WIDTH];
        uint32_t *word = out->word + (size_t)WORDS * r;
        decode(out, r, slot);
        spans_clear(&all[r]);
        for (uint32_t s = 0; s < WIDTH; s++) {
            if (!slot[s].there)
                continue;
            spans_clear(&span[s]);
            if (slot[s].count == 0)
                span[s] = all[slot[s].first];
            for (uint32_t i = 0; i < slot[s].count; i++)
                spans_add_triangle(&span[s], scene, out->item[slot[s].first + i]);
            spans_add(&all[r], &span[s]);
        }
        put_tilt(slot, span, best_tilt(slot, span), word);
    }
    free(all);
    return STATUS_OK;
}

static enum status pack(const struct layout *self, const struct bvh *bvh, const struct scene *scene,
                        struct packed *out, struct reason *reason)
{
    enum status status = wide_form_pack(self, bvh, scene, out, reason);
    return status ? status : tilt(scene, out, reason);
}

static enum status pack_tree(const struct layout *self, struct wide_tree *tree,
                             const uint32_t *item, uint32_t item_count, const struct scene *scene,
                             struct packed *out, struct reason *reason)
{
    enum status status = wide_form_pack_tree(self, tree, item, item_count, scene, out, reason);
    return status ? status : tilt(scene, out, reason);
}

/* --- rays ------------------------------------------------------------------------------------- */

/* Returns the slot of a child, or WIDTH. */
static uint32_t slot_of(const struct packed *packed, uint32_t record, const uint32_t *word,
                        uint32_t child)
{
    uint32_t node = word[4];
    if (child >= packed->node_count)
        return child - packed->node_count - WIDTH * record;
    for (uint32_t s = 0; s < WIDTH; s++) {
        bool inner = (word[6] >> 4 * s & 15u) == INNER;
        if (inner && node == child)
            return s;
        node += inner;
    }
    return WIDTH;
}

/* Narrows the distances *near to *far to those at which the ray is between two planes along an
 * axis, which are `beside` farther apart on both sides; false if a ray along them is at none. */
static bool narrow(float lo, float hi, float beside, float org, float dir, float *near, float *far)
{
    lo -= beside;
    hi += beside;
    if (!(dir >= PARALLEL || dir <= -PARALLEL))
        return !(org < lo || org > hi);
    float inv = 1.0f / dir;
    float a = (lo - org) * inv, b = (hi - org) * inv;
    float first = a < b ? a : b, last = a < b ? b : a;
    *near = first > *near ? first : *near;
    *far = last < *far ? last : *far;
    return true;
}

/* The ray and the bounds of a child along one axis of its node. */
struct along {
    float lo, hi, beside, org, dir;
};

/* The largest magnitudes of points of the node and of the origin. */
static void reach_of(const uint32_t *word, const struct oblique_ray *ray, float reach[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        const struct node_axis frame = axis_at(word, word + 3, k);
        reach[k] = (fabsf(frame.origin) +
                    node_axis_plane(&(struct node_axis){0, frame.exponent}, PLANES)) +
                   fabsf(ray->org[k]);
    }
}

static void look_along(const uint32_t *word, uint32_t s, uint32_t j, const float reach[3],
                       const struct oblique_ray *ray, struct along *out)
{
    const struct node_axis axis = axis_at(word + 8, word + 7, j);
    const float x = component(word, j, 0), y = component(word, j, 1), z = component(word, j, 2);
    const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
    float size = (ax * reach[0] + ay * reach[1]) + az * reach[2];
    out->org = (x * ray->org[0] + y * ray->org[1]) + z * ray->org[2];
    out->dir = (x * ray->dir[0] + y * ray->dir[1]) + z * ray->dir[2];
    out->beside = (size * BESIDE + ((ax + ay) + az) * ray->by) + BESIDE_LEAST;
    out->lo = node_axis_plane(&axis, byte_of(word + OBLIQUE_AT, WIDTH * j + s));
    out->hi = node_axis_plane(&axis, byte_of(word + OBLIQUE_AT, WIDTH * (3 + j) + s));
}

/* Returns the words of a node that has oriented boxes, or NULL, and the slot of its child. */
static const uint32_t *boxes_at(const struct packed *packed, uint32_t ref, uint32_t child,
                                uint32_t *s)
{
    if (ref >= packed->node_count)
        return NULL;
    const uint32_t *word = packed->word + (size_t)WORDS * ref;
    *s = slot_of(packed, ref, word, child);
    return (word[3] >> 24 & 1) && *s < WIDTH ? word : NULL;
}

static bool misses(const struct packed *packed, uint32_t ref, uint32_t child,
                   const struct oblique_ray *ray, float tmax)
{
    uint32_t s;
    const uint32_t *word = boxes_at(packed, ref, child, &s);
    float near = ray->least, far = tmax, reach[3];
    if (!word)
        return false;
    reach_of(word, ray, reach);
    for (uint32_t j = 0; j < 3; j++) {
        struct along a;
        look_along(word, s, j, reach, ray, &a);
        if (!narrow(a.lo, a.hi, a.beside, a.org, a.dir, &near, &far))
            return true;
    }
    return near - fabsf(near) * SLACK > far + fabsf(far) * SLACK;
}

static bool oblique(const struct packed *packed, uint32_t ref, uint32_t child,
                    const struct oblique_ray *ray, struct oblique_box *out)
{
    uint32_t s;
    const uint32_t *word = boxes_at(packed, ref, child, &s);
    float reach[3];
    *out = (struct oblique_box){.slack = SLACK};
    if (!word)
        return false;
    reach_of(word, ray, reach);
    for (uint32_t j = 0; j < 3; j++) {
        struct along a;
        look_along(word, s, j, reach, ray, &a);
        for (uint32_t k = 0; k < 3; k++)
            out->axis[j][k] = component(word, j, k);
        out->lo[j] = a.lo;
        out->hi[j] = a.hi;
        out->step[j] =
            node_axis_plane(&(struct node_axis){0, axis_at(word + 8, word + 7, j).exponent}, 1);
        out->beside[j] = a.beside;
        out->enter[j] = -INFINITY;
        out->leave[j] = INFINITY;
        if (!narrow(a.lo, a.hi, a.beside, a.org, a.dir, &out->enter[j], &out->leave[j])) {
            out->enter[j] = INFINITY;
            out->leave[j] = -INFINITY;
        }
    }
    return true;
}

static const struct wide_form form = {
    .decode = decode,
    .node_cost = 1.0f,
    .largest = LARGEST,
    .places = UINT32_MAX,
    .put_boxes = put_boxes,
    .put_children = put_children,
};

extern const struct layout layout_obb8;
const struct layout layout_obb8 = {
    .name = "obb8",
    .summary = "144-byte nodes of 8 children with boxes and oriented boxes, bounds of 8 bits",
    .node_bytes = 4 * WORDS,
    .width = WIDTH,
    .order = VISIT_NEAR,
    .family = &form,
    .pack = pack,
    .leaf_most = LEAF_MOST,
    .pack_tree = pack_tree,
    .load = wide_form_load,
    .box = wide_form_box,
    .misses = misses,
    .oblique = oblique,
    .item = wide_nodes_item,
};
