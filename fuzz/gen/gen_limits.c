/* Recipes about numbers of triangles: the 16-bit fields of the reduced-footprint layouts, and
 * scenes of hardly any triangle. The large ones cost as much as a thousand ordinary trials and are
 * drawn accordingly rarely. */
#include "fuzz/gen/gen_recipes.h"

/* Leaves of 1 triangle make 3 n - 1 records in a 16-byte layout, whose last child is record
 * 3 n - 3: it passes 32767 from n = 10923 to 10924, and 65535 from 21846 to 21847. */
uint32_t goal_records(struct rng *rng)
{
    static const uint32_t goal[] = {10922, 10923, 10924, 10925, 11200, 21846, 21847, 21850};
    return goal[rng_below(rng, ARRAY_COUNT(goal))];
}

uint32_t goal_items(struct rng *rng)
{
    static const uint32_t goal[] = {32767, 32768, 32769, 65534, 65535, 65536, 65537};
    return goal[rng_below(rng, ARRAY_COUNT(goal))];
}

uint32_t goal_few(struct rng *rng)
{
    return rng_below(rng, 16);
}

/* Small triangles in the cells of a lattice of 2^k cells, half as wide as a cell: the middle of any
 * box of an even number of cells falls between two of them, so that a builder that splits there
 * makes the even tree, full leaves of 8 included. Triangles beyond the cells share the first
 * cells. */
static void draw_dust(struct sketch *sketch)
{
    uint32_t bits[3] = {4, 4, 4}, grown = 0; /* cells along each axis, as powers of two */
    while ((1u << (bits[0] + bits[1] + bits[2])) + 1 < sketch->goal)
        bits[grown++ % 3]++;
    const float step = 0.0625f;
    uint32_t first = rng_below(sketch->rng, sketch->goal);
    for (uint32_t i = 0; i < sketch->goal; i++) {
        uint32_t at = first + i < sketch->goal ? first + i : first + i - sketch->goal;
        float centre[3];
        for (int k = 0; k < 3; k++) {
            float cells = (float)(1u << bits[k]);
            centre[k] = step * ((float)(at & ((1u << bits[k]) - 1)) + 0.5f - 0.5f * cells);
            at >>= bits[k];
        }
        sketch_small(sketch, centre, 0.25f * step);
    }
}

void draw_records(struct sketch *sketch)
{
    sketch->leaf = 1;
    sketch->plain = true;
    draw_dust(sketch);
}

void draw_items(struct sketch *sketch)
{
    sketch->leaf = 8;
    sketch->plain = true;
    draw_dust(sketch);
}

/* 0 to 15 triangles, where the root is a leaf. */
void draw_few(struct sketch *sketch)
{
    sketch->leaf = 1 + rng_below(sketch->rng, 9);
    if (rng_below(sketch->rng, 2))
        draw_tetrahedra(sketch);
    draw_soup(sketch);
}
