/* A scene while a recipe draws it, and the recipes. Bytes are the same on every machine: only + - *
 * / of float32 in a stated order and bit patterns are used, no function of libm; random numbers are
 * drawn one a statement, since C leaves the order within an expression open. For the generators of
 * trials and the tests. */
#ifndef FUZZ_GEN_SKETCH_H
#define FUZZ_GEN_SKETCH_H

#include "fuzz/gen/gen.h"
#include "ref/base/rng.h"

/* The arrays hold 3 * goal vertices and goal triangles. */
struct sketch {
    struct rng *rng;
    float *vertex;
    uint32_t *index;
    uint32_t vertex_count, tri_count; /* drawn so far */
    uint32_t goal;                    /* triangles to draw */
    uint32_t leaf;                    /* 0: the generator chooses */
    bool plain;                       /* no edits: they would move what matters */
};

struct recipe {
    const char *name;
    const char *summary;
    uint32_t weight; /* of RECIPE_WEIGHTS */
    /* The goal, in place of the options' range; NULL: that range. */
    uint32_t (*goal)(struct rng *rng);
    /* Draws at most `goal` triangles; the rest is filled with small loose ones. */
    void (*draw)(struct sketch *sketch);
};

/* Weights of all recipes add up to this. */
#define RECIPE_WEIGHTS 4096u

extern const struct recipe recipes[]; /* the last one has no name */

/* A random recipe, by weight. */
const struct recipe *gen_recipe(struct rng *rng);

/* Draws sketch->goal triangles by a recipe into the arrays of a sketch that is otherwise zero. */
void gen_draw(const struct recipe *recipe, struct sketch *sketch);

/* Chooses builder, leaf (unless `leaf`), tests and query. */
void gen_choose_tests(struct rng *rng, const struct gen_options *options, uint32_t leaf,
                      struct fuzz_trial *trial);

/* 2^exponent, -149 <= exponent <= 127. */
static inline float power_of_two(int exponent)
{
    return float_from_bits(exponent >= -126 ? (uint32_t)(exponent + 127) << 23
                                            : 1u << (exponent + 149));
}

/* The next float in that direction: up for steps > 0. Never leaves the finite ones; 0 and -0 are
 * one place. */
float float_step(float x, int steps);

/* Triangles that can still be drawn. */
static inline uint32_t sketch_room(const struct sketch *sketch)
{
    return sketch->goal - sketch->tri_count;
}

/* Adds a vertex and returns its index. There is room for three for every triangle. */
uint32_t sketch_vertex(struct sketch *sketch, float x, float y, float z);
/* Adds a triangle, if there is room. */
void sketch_tri(struct sketch *sketch, uint32_t a, uint32_t b, uint32_t c);
/* Adds a triangle of three vertices of its own. */
void sketch_loose(struct sketch *sketch, float v[3][3]);

extern const float sketch_origin[3]; /* 0, 0, 0 */

/* A point in the cube of side 2 * reach around `centre`. */
void sketch_point(struct sketch *sketch, const float centre[3], float reach, float out[3]);
/* A loose triangle whose corners lie in that cube. */
void sketch_small(struct sketch *sketch, const float centre[3], float reach);

/* Closed boxes facing outward, 12 triangles; needs their room. */
#define SKETCH_BOX 12u
void sketch_box(struct sketch *sketch, const float lo[3], const float hi[3]);
/* A closed tetrahedron, 4 triangles; needs their room. */
#define SKETCH_TETRA 4u
void sketch_tetra(struct sketch *sketch, float v[4][3]);

/* A sheet of n x m quads, (n + 1) (m + 1) vertices and 2 n m triangles; needs their room. point()
 * places lattice point (i, j). */
void sketch_sheet(struct sketch *sketch, uint32_t n, uint32_t m,
                  void (*point)(struct sketch *sketch, uint32_t i, uint32_t j, float out[3],
                                const void *how),
                  const void *how);
/* n and m of the largest nearly square sheet that has room; 0, 0 if none has. */
void sketch_sheet_size(const struct sketch *sketch, uint32_t *n, uint32_t *m);

/* Uniform in -1 .. 1. */
static inline float sketch_signed(struct sketch *sketch)
{
    return 2.0f * rng_float(sketch->rng) - 1.0f;
}

/* -1 or 1. */
static inline float sketch_sign(struct sketch *sketch)
{
    return rng_below(sketch->rng, 2) ? 1.0f : -1.0f;
}

#endif
