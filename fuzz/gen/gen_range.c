/* Recipes about where a scene is and how large. */
#include "fuzz/gen/gen_recipes.h"

/* Moves and scales what has been drawn. */
static void place(struct sketch *sketch, float scale, const float offset[3])
{
    for (uint32_t i = 0; i < sketch->vertex_count; i++)
        for (uint32_t k = 0; k < 3; k++) {
            float *x = &sketch->vertex[3 * (size_t)i + k];
            *x = *x * scale + offset[k];
        }
}

static void draw_some_shape(struct sketch *sketch)
{
    static draw_fn *const shape[] = {draw_soup, draw_boxes, draw_balls, draw_terrain, draw_grid};
    shape[rng_below(sketch->rng, ARRAY_COUNT(shape))](sketch);
}

/* Far from the origin by 2^3 to 2^22 sizes: coordinates lose their lower bits. */
void draw_far(struct sketch *sketch)
{
    float offset[3], far = power_of_two(3 + (int)rng_below(sketch->rng, 20));
    float scale = 1.0f;
    if (rng_below(sketch->rng, 4) > 0 && far > 16384.0f) { /* most within float16's range */
        scale = 16384.0f / far;
        far = 16384.0f;
    }
    draw_some_shape(sketch);
    for (int k = 0; k < 3; k++)
        offset[k] = rng_below(sketch->rng, 4) ? far * sketch_signed(sketch) : 0.0f;
    place(sketch, scale, offset);
}

/* A few large triangles over a small soup. */
void draw_mixed(struct sketch *sketch)
{
    int smaller = 4 + (int)rng_below(sketch->rng, 18);
    while (sketch_room(sketch) > 0) {
        float centre[3], size = power_of_two(-(int)rng_below(sketch->rng, (uint32_t)smaller));
        sketch_point(sketch, sketch_origin, size, centre);
        sketch_small(sketch, centre, size);
    }
}

/* Extents around the least normal float16, 2^-14, and below all of them. */
void draw_tiny_scale(struct sketch *sketch)
{
    draw_some_shape(sketch);
    place(sketch, power_of_two(-12 - (int)rng_below(sketch->rng, 16)), sketch_origin);
}

/* Any scale that the contract has room for; rarely beyond. */
void draw_any_scale(struct sketch *sketch)
{
    int exponent = (int)rng_below(sketch->rng, 60) - 36;
    if (rng_below(sketch->rng, 16) == 0)
        exponent = (int)rng_below(sketch->rng, 220) - 140;
    draw_some_shape(sketch);
    place(sketch, power_of_two(exponent), sketch_origin);
}
