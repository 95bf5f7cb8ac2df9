#include "bench/measure/small_parts.h"

#include <math.h>

const char *const small_part_names[SMALL_PARTS] = {"nodes",    "headers", "corners",
                                                   "vertices", "numbers", "ends"};

/* Bits that tell some of `all` things from each other. */
static double bits_of(double all)
{
    return all > 1 ? log2(all) : 0;
}

/* Bits that tell which `count` of `all` numbers there are. */
static double bits_of_choice(double all, double count)
{
    return (lgamma(all + 1) - lgamma(count + 1) - lgamma(all - count + 1)) / log(2);
}

static double range_of_axis(const uint32_t *block, uint32_t k)
{
    uint32_t most = 0, width = small_width(*block, k);
    for (uint32_t i = 0; i < small_vertices(*block); i++) {
        uint32_t more = block_bits(block, small_row(*block, k) + width * i, width);
        most = more > most ? more : most;
    }
    return (double)most + 1;
}

static double range_of_prims(const uint32_t *block)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < small_tris(*block); i++) {
        uint32_t more = small_prim(block, i) - block[4];
        most = more > most ? more : most;
    }
    return (double)most + 1;
}

static void count_block(const uint32_t *block, struct small_parts *parts)
{
    const double n = small_vertices(*block), tris = small_tris(*block);
    const uint32_t numbers = small_row(*block, 3);
    const uint32_t bits = numbers + small_tris(*block) * small_prim_width(*block);
    parts->held[PART_HEADS] += 4 * SMALL_HEAD;
    parts->held[PART_CORNERS] += tris * SMALL_CORNERS / 8;
    parts->held[PART_VERTICES] += n * small_before(*block, 3) / 8;
    parts->held[PART_PRIMS] += (bits - numbers) / 8.0;
    parts->held[PART_ENDS] += (-bits & 31u) / 8.0;
    parts->least[PART_CORNERS] += tris * bits_of(n * (n - 1) * (n - 2)) / 8;
    for (uint32_t k = 0; k < 3; k++)
        parts->least[PART_VERTICES] += n * bits_of(range_of_axis(block, k)) / 8;
    parts->least[PART_PRIMS] += bits_of_choice(range_of_prims(block), tris) / 8;
}

struct small_parts small_parts_count(const struct fast_tree *tree)
{
    struct small_parts parts = {.held = {0}};
    for (uint32_t n = 0; n < tree->node_count; n++)
        for (uint32_t i = 0; i < small_children(&tree->small[n]); i++) {
            const uint32_t ref = small_ref(&tree->small[n], i);
            if (ref & FAST_LEAF)
                count_block(tree->block + (ref & ~FAST_LEAF), &parts);
        }
    parts.held[PART_NODES] = (double)sizeof *tree->small * tree->node_count;
    parts.least[PART_NODES] = parts.held[PART_NODES];
    parts.least[PART_HEADS] = parts.held[PART_HEADS];
    return parts;
}
