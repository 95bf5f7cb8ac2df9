/* Recipes of boxes in boxes and of deep trees. */
#include "fuzz/gen/gen_recipes.h"

/* Boxes in boxes, each smaller by a constant factor, around different points. */
void draw_nested(struct sketch *sketch)
{
    float factor = rng_below(sketch->rng, 2) ? 0.5f : 0.75f + 0.25f * rng_float(sketch->rng);
    float lo[3] = {-1, -1, -1}, hi[3] = {1, 1, 1};
    while (sketch_room(sketch) >= SKETCH_BOX) {
        sketch_box(sketch, lo, hi);
        for (int k = 0; k < 3; k++) {
            float side = hi[k] - lo[k];
            lo[k] = lo[k] + (1.0f - factor) * side * rng_float(sketch->rng);
            hi[k] = lo[k] + factor * side;
        }
    }
    draw_tetrahedra(sketch);
}

/* Triangles of every size with one centroid: no plane separates them. */
void draw_concentric(struct sketch *sketch)
{
    int up = (int)rng_below(sketch->rng, 3);
    bool flat = rng_below(sketch->rng, 2);
    float size = 1.0f, shrink = rng_below(sketch->rng, 2) ? 0.5f : 0.9375f;
    while (sketch_room(sketch) > 0) {
        float v[3][3], tilt = flat ? 0 : size * sketch_signed(sketch);
        int a = (up + 1) % 3, b = (up + 2) % 3;
        v[0][a] = 2.0f * size, v[0][b] = 0, v[0][up] = 0;
        v[1][a] = -size, v[1][b] = 1.5f * size, v[1][up] = tilt;
        v[2][a] = -size, v[2][b] = -1.5f * size, v[2][up] = -tilt;
        sketch_loose(sketch, v);
        size *= shrink;
    }
}

/* Positions 2^-i, sizes likewise: the middle of the longest axis always separates one triangle, and
 * the tree becomes a chain. */
void draw_chain(struct sketch *sketch)
{
    int axis = (int)rng_below(sketch->rng, 3), step = 1 + (int)rng_below(sketch->rng, 2);
    int exponent = (int)rng_below(sketch->rng, 10);
    float sign = sketch_sign(sketch);
    while (sketch_room(sketch) > 0 && exponent > -50) {
        float at = sign * power_of_two(exponent), v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                float wide = 0.5f * at * sketch_signed(sketch);
                v[c][k] = k == axis ? at + 0.25f * wide : wide;
            }
        sketch_loose(sketch, v);
        exponent -= step;
    }
    while (sketch_room(sketch) > 0) { /* the rest at the near end */
        float near[3] = {0, 0, 0};
        near[axis] = sign * power_of_two(exponent);
        sketch_small(sketch, near, power_of_two(exponent));
    }
}
