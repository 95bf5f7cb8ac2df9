/* What the recipes draw, one function each; the table is fuzz/gen/gen_recipes.c. */
#ifndef FUZZ_GEN_RECIPES_H
#define FUZZ_GEN_RECIPES_H

#include "fuzz/gen/gen_sketch.h"

typedef void draw_fn(struct sketch *sketch);

/* gen_loose.c */
draw_fn draw_soup, draw_needles, draw_slivers, draw_duplicates, draw_flattened, draw_lattice;
/* gen_closed.c */
draw_fn draw_boxes, draw_tetrahedra, draw_corridor, draw_balls, draw_fan, draw_patch;
/* gen_flat.c */
draw_fn draw_grid, draw_terrain, draw_coplanar, draw_sheets, draw_walls;
/* gen_nested.c */
draw_fn draw_nested, draw_concentric, draw_chain;
/* gen_range.c */
draw_fn draw_far, draw_mixed, draw_tiny_scale, draw_any_scale;
/* gen_halves.c */
draw_fn draw_codes, draw_midpoints, draw_largest, draw_about_zero;
/* gen_limits.c */
draw_fn draw_records, draw_items, draw_few;
uint32_t goal_records(struct rng *rng);
uint32_t goal_items(struct rng *rng);
uint32_t goal_few(struct rng *rng);

#endif
