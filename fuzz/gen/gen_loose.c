/* Recipes of loose triangles: no two share a vertex index. */
#include "fuzz/gen/gen_recipes.h"

/* Triangles of one size in the unit cube, small or as large as it. */
void draw_soup(struct sketch *sketch)
{
    float size = power_of_two(-(int)rng_below(sketch->rng, 6));
    while (sketch_room(sketch) > 0) {
        float centre[3];
        sketch_point(sketch, sketch_origin, 1.0f, centre);
        sketch_small(sketch, centre, size);
    }
}

/* Long and thin: two corners beside each other, the third far away; 1 : 2^8 to 1 : 2^24. */
void draw_needles(struct sketch *sketch)
{
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        float width = power_of_two(-8 - (int)rng_below(sketch->rng, 17));
        sketch_point(sketch, sketch_origin, 1.0f, v[0]);
        sketch_point(sketch, v[0], width, v[1]);
        sketch_point(sketch, sketch_origin, 1.0f, v[2]);
        sketch_loose(sketch, v);
    }
}

/* Thin: the third corner beside a point of the opposite edge, by 2^-8 to 2^-24 or not at all. */
void draw_slivers(struct sketch *sketch)
{
    while (sketch_room(sketch) > 0) {
        float v[3][3], width = 0, s = rng_float(sketch->rng);
        if (rng_below(sketch->rng, 4) > 0)
            width = power_of_two(-8 - (int)rng_below(sketch->rng, 17));
        else
            s = 0.5f; /* in the middle the edge often passes through a float */
        sketch_point(sketch, sketch_origin, 1.0f, v[0]);
        sketch_point(sketch, sketch_origin, 1.0f, v[1]);
        for (int k = 0; k < 3; k++)
            v[2][k] = v[0][k] + s * (v[1][k] - v[0][k]) + width * sketch_signed(sketch);
        sketch_loose(sketch, v);
    }
}

/* Each triangle two to nine times, its corners in any order. */
void draw_duplicates(struct sketch *sketch)
{
    while (sketch_room(sketch) > 0) {
        float v[3][3], w[3][3];
        uint32_t copies = 2 + rng_below(sketch->rng, 8);
        for (int c = 0; c < 3; c++)
            sketch_point(sketch, sketch_origin, 1.0f, v[c]);
        for (uint32_t i = 0; i < copies; i++) {
            uint32_t turn = rng_below(sketch->rng, 3), mirror = rng_below(sketch->rng, 2);
            for (uint32_t c = 0; c < 3; c++)
                for (int k = 0; k < 3; k++)
                    w[mirror ? 2 - c : c][k] = v[(c + turn) % 3][k];
            sketch_loose(sketch, w);
        }
    }
}

/* Corners that fall together, collinear corners, and a few sound triangles between them. */
void draw_flattened(struct sketch *sketch)
{
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        uint32_t kind = rng_below(sketch->rng, 4);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) /* a lattice, so that middles are exact */
                v[c][k] = 0.125f * (float)((int)rng_below(sketch->rng, 17) - 8);
        for (int k = 0; k < 3; k++) {
            if (kind == 0 || kind == 1)
                v[1][k] = v[0][k];
            if (kind == 0)
                v[2][k] = v[0][k];
            if (kind == 2)
                v[2][k] = 0.5f * v[0][k] + 0.5f * v[1][k];
        }
        sketch_loose(sketch, v);
    }
}

/* Corners on the lattice of the integers from -4 to 4: exact ties, edges through corners. */
void draw_lattice(struct sketch *sketch)
{
    float scale = power_of_two((int)rng_below(sketch->rng, 9) - 4);
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                v[c][k] = scale * (float)((int)rng_below(sketch->rng, 9) - 4);
        sketch_loose(sketch, v);
    }
}
