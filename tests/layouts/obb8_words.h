/* The words of layout obb8, by their places in bits, and triangles that it suits. Include after
 * cmocka.h. */
#ifndef TESTS_OBB8_WORDS_H
#define TESTS_OBB8_WORDS_H

#include "tests/layouts/records.h"

#define WORDS 36u

/* Component k of axis j. */
static inline int axis_of(const uint32_t *word, uint32_t j, uint32_t k)
{
    uint32_t i = 3 * j + k, four = i < 8 ? bits(word, 352 + 4 * i, 4) : bits(word, 248, 4);
    return four < 8 ? (int)four : (int)four - 16;
}

/* The two parts of a plane; their sum is it. */
static inline void plane_of(const uint32_t *word, uint32_t j, uint32_t s, bool up, double part[2])
{
    uint32_t q = bits(word, 768 + 64 * (j + (up ? 3 : 0)) + 8 * s, 8);
    part[0] = (double)float_from_bits(word[8 + j]);
    part[1] = ldexp(q, (int)bits(word, 224 + 8 * j, 8) - 127);
}

/* The sign of a sum of up to 8 doubles, exactly: it is kept in parts that do not overlap. */
static inline int sign_of_sum(const double *x, uint32_t count)
{
    double part[8];
    int sign = 0;
    for (uint32_t n = 0; n < count; n++) {
        double q = x[n];
        for (uint32_t i = 0; i < n; i++) {
            double sum = q + part[i], b = sum - q;
            part[i] = (q - (sum - b)) + (part[i] - b);
            q = sum;
        }
        part[n] = q;
    }
    for (uint32_t i = 0; i < count; i++) /* the largest is the last that is not 0 */
        sign = part[i] != 0 ? (part[i] > 0 ? 1 : -1) : sign;
    return sign;
}

/* Triangles about `centre`, each turned by any angle; `size` apart, `side` long and thin. */
static inline struct scene slivers(struct rng *rng, uint32_t count, float centre, float size,
                                   float side)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++) {
        float at[3], along[3];
        for (int k = 0; k < 3; k++) {
            at[k] = centre + rng_range(rng, -size, size);
            along[k] = rng_range(rng, -side, side);
        }
        for (uint32_t c = 0; c < 3; c++)
            for (uint32_t k = 0; k < 3; k++)
                scene.vertex[9 * (size_t)i + 3 * c + k] =
                    at[k] + along[k] * (float)c + rng_range(rng, -side, side) * 0x1p-6f;
    }
    return scene;
}

#endif
