/* The edits, by file; the table is fuzz/gen/mutate.c. */
#ifndef FUZZ_MUTATE_INNER_H
#define FUZZ_MUTATE_INNER_H

#include "fuzz/gen/gen_sketch.h"
#include "fuzz/gen/mutate.h"

typedef enum status edit_fn(struct rng *rng, struct fuzz_trial *trial, bool *changed);

/* mutate_shape.c: coordinates of the whole scene; half of the time the rays go with it. */
edit_fn edit_snap, edit_scale, edit_move, edit_negate, edit_swap_axes, edit_flatten, edit_halves;
/* mutate_vertex.c: one vertex. */
edit_fn edit_next_float, edit_onto_vertex, edit_onto_edge, edit_zero, edit_far_vertex;
/* mutate_triangles.c: which triangles there are, and what they share. */
edit_fn edit_duplicate, edit_permute, edit_turn, edit_weld, edit_unweld, edit_drop;
/* mutate_rays.c */
edit_fn edit_aim, edit_ray_step, edit_ray_axis, edit_ray_range, edit_ray_back, edit_ray_scale;
/* mutate_tests.c */
edit_fn edit_leaf, edit_builder, edit_box, edit_tri, edit_query, edit_refit;

/* Sets a coordinate or a ray's number. */
static inline void put(float *place, float x, bool *changed)
{
    if (float_bits(*place) == float_bits(x))
        return;
    *place = x;
    *changed = true;
}

/* The same of a vertex, which stays finite. */
static inline void put_finite(float *place, float x, bool *changed)
{
    if (float_is_finite(x))
        put(place, x, changed);
}

/* Largest |coordinate| of all vertices. */
float largest_of(const struct scene *scene);

/* A random vertex that a triangle uses; NULL if there is none. */
float *some_vertex(struct rng *rng, struct scene *scene);

#endif
