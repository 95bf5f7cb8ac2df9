/* Top-down by the surface area heuristic, with splits between bins of centres (Wald 2007, On fast
 * construction of SAH-based bounding volume hierarchies) on all three axes. With up to FEW_MOST
 * triangles every position is tried instead of bins. Ours: areas relative to the node, which works
 * for scenes of any size, and the depth limit. */
#include "ref/build/bins.h"
#include "ref/build/few.h"
#include "ref/build/grow.h"
#include "ref/build/room.h"
#include "ref/build/swap.h"

struct binned {
    struct ref *ref;
    uint32_t leaf, bins;
};

/* Larger ranges are binned and divided in parts, which threads share. */
#define ALONE 16384u

static void bin_range(const struct binned *b, const struct grow_range *range,
                      const struct bin_map *map, struct bins *bins, uint32_t threads)
{
    const struct ref *ref = b->ref + range->first;
    if (range->count <= ALONE || threads == 1) {
        bins_add(bins, map, ref, range->count);
        return;
    }
    uint32_t parts = (range->count + ALONE - 1) / ALONE;
#pragma omp parallel num_threads(threads)
    {
        struct bins mine;
        bins_clear(&mine, map->count);
#pragma omp for schedule(static)
        for (uint32_t i = 0; i < parts; i++) {
            uint32_t first = i * ALONE, rest = range->count - first;
            bins_add(&mine, map, ref + first, rest < ALONE ? rest : ALONE);
        }
        /* Sums, minima and maxima: the order does not matter. */
#pragma omp critical(bins)
        bins_merge(bins, &mine, map->count);
    }
}

static uint32_t halve(void *user, const struct grow_range *range, struct grow_range child[2])
{
    const struct binned *b = user;
    return refs_halve(b->ref + range->first, range->count, &range->centres, &child[0].centres,
                      &child[1].centres);
}

/* Returns the number of bins for a range. */
static uint32_t bins_for(const struct binned *b, uint32_t count)
{
    uint32_t worth = 4 + count / 8;
    return worth < b->bins ? worth : b->bins;
}

static uint32_t split(void *user, const struct grow_range *range, struct grow_range child[2],
                      uint32_t threads)
{
    const struct binned *b = user;
    struct ref *ref = b->ref + range->first;
    if (range->count <= FEW_MOST) {
        uint32_t left = few_split(ref, range->count, b->leaf);
        child[0].centres = child[1].centres = range->centres; /* only halve() reads it */
        return left || range->count <= b->leaf ? left : halve(user, range, child);
    }
    struct bins bins;
    struct bin_map map = bin_map_of(&range->centres, bins_for(b, range->count));
    bins_clear(&bins, map.count);
    bin_range(b, range, &map, &bins, threads);
    struct bin_split best = bins_split(&bins, map.count);
    float as_leaf = best.whole * ((float)range->count - COST_NODE);
    if (range->count <= b->leaf && !(best.bin && best.cost < as_leaf))
        return 0;
    if (best.bin == 0)
        return halve(user, range, child);
    struct ref_cut cut = {.map = &map, .axis = best.axis, .bin = (int32_t)best.bin};
    return refs_divide(ref, range->count, &cut, threads, &child[0].centres, &child[1].centres);
}

static struct lane_box leaf(void *user, const struct grow_range *range, uint32_t *prim)
{
    const struct ref *ref = ((const struct binned *)user)->ref + range->first;
    struct lane_box box = lane_box_empty();
    for (uint32_t i = 0; i < range->count; i++) {
        lane_box_add(&box, &ref[i].box);
        prim[i] = ref_prim(&ref[i]);
    }
    return box;
}

static enum status start(void *user, struct ref *ref, uint32_t threads, struct grow_range *root)
{
    (void)threads;
    (void)root;
    ((struct binned *)user)->ref = ref;
    return STATUS_OK;
}

static enum status build(const struct scene *scene, const struct build_options *options,
                         struct bvh *out, struct reason *reason)
{
    static const struct grow_rule rule = {
        .start = start, .split = split, .halve = halve, .leaf = leaf};
    uint32_t bins = options->bins ? options->bins : BUILD_BINS_DEFAULT;
    struct binned b = {.leaf = options->leaf, .bins = bins < BINS_MOST ? bins : BINS_MOST};
    return grow_build(&rule, &b, scene, options, out, reason);
}

extern const struct builder build_sah_binned;
const struct builder build_sah_binned = {
    .name = "sah_binned",
    .summary = "surface area heuristic between --bins bins, exact for 8 triangles and fewer",
    .build = build,
    .takes = "bins presplit",
    .tri_bytes = 190,
};
