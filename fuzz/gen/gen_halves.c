/* Recipes about float16: stored bounds must not be inside the true ones. */
#include "fuzz/gen/gen_recipes.h"

#include "ref/base/half.h"

/* A finite float16 of exponent at most `most`: 0 to 29 for 2^-15 (subnormal) to 2^15. */
static float any_half(struct sketch *sketch, uint32_t least, uint32_t most)
{
    uint32_t exponent = least + rng_below(sketch->rng, most - least + 1);
    uint32_t mantissa = rng_below(sketch->rng, 1024), sign = rng_below(sketch->rng, 2);
    if (rng_below(sketch->rng, 4) == 0) /* where steps change */
        mantissa = rng_below(sketch->rng, 2) ? 0 : 1023;
    uint32_t bits = sign << 15 | exponent << 10 | mantissa;
    return half_to_float((struct half){(uint16_t)bits});
}

/* Coordinates on float16s of one or two exponents and a few steps of float32 beside them, so that
 * triangles are of about one size. */
static void draw_beside(struct sketch *sketch, bool midpoints)
{
    uint32_t exponent = 8 + rng_below(sketch->rng, 20);
    bool narrow = rng_below(sketch->rng, 2);
    while (sketch_room(sketch) > 0) {
        float v[3][3], anchor[3];
        for (int k = 0; k < 3; k++)
            anchor[k] = any_half(sketch, exponent, exponent);
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                float step = power_of_two((int)exponent - 25), x = anchor[k];
                int away = (int)rng_below(sketch->rng, 129) - 64;
                x = narrow ? x + step * (float)away
                           : any_half(sketch, exponent - !midpoints, exponent);
                if (midpoints)
                    x += 0.5f * step;
                v[c][k] = float_step(x, (int)rng_below(sketch->rng, 5) - 2);
            }
        sketch_loose(sketch, v);
    }
}

void draw_codes(struct sketch *sketch)
{
    draw_beside(sketch, false);
}

/* Half way between two float16s, where rounding to nearest turns. */
void draw_midpoints(struct sketch *sketch)
{
    draw_beside(sketch, true);
}

/* Up to the largest float16, and in one trial of four beyond it. */
void draw_largest(struct sketch *sketch)
{
    static const float end[] = {65503.9961f, 65504.0f, 65472.0f, 65488.0f,
                                65504.0039f, 65519.0f, 65520.0f, 1e5f};
    uint32_t ends = rng_below(sketch->rng, 4) ? 4 : ARRAY_COUNT(end);
    while (sketch_room(sketch) > 0) {
        float v[3][3], centre[3];
        sketch_point(sketch, sketch_origin, 32768.0f, centre);
        for (int c = 0; c < 3; c++) {
            sketch_point(sketch, centre, 32700.0f, v[c]);
            uint32_t k = rng_below(sketch->rng, 6);
            float sign = sketch_sign(sketch), at = end[rng_below(sketch->rng, ends)];
            if (k < 3)
                v[c][k] = sign * at;
        }
        sketch_loose(sketch, v);
    }
}

/* Bounds at zero, beside it, and at the least normal float16: signs of zero, subnormals. */
void draw_about_zero(struct sketch *sketch)
{
    static const float near[] = {0.0f,     -0.0f,     0x1p-25f, 0x1p-24f,   0x1p-14f,
                                 0x1p-15f, 0x1p-126f, 0x1p-60f, 0x1.8p-15f, 0x1.fffp-15f};
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) {
                v[c][k] = sketch_signed(sketch);
                if (rng_below(sketch->rng, 3) == 0) {
                    float sign = sketch_sign(sketch);
                    v[c][k] = sign * near[rng_below(sketch->rng, ARRAY_COUNT(near))];
                }
            }
        sketch_loose(sketch, v);
    }
}
