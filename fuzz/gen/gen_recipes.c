#include "fuzz/gen/gen_recipes.h"

#define RECIPE(id, weight_, goal_, draw_, summary_)                                                \
    static const struct recipe id = {                                                              \
        .name = #id, .summary = summary_, .weight = weight_, .goal = goal_, .draw = draw_}

RECIPE(soup, 220, NULL, draw_soup, "loose triangles of one size");
RECIPE(needles, 140, NULL, draw_needles, "one side far shorter than the others");
RECIPE(slivers, 140, NULL, draw_slivers, "a corner beside the opposite edge");
RECIPE(duplicates, 140, NULL, draw_duplicates, "every triangle several times");
RECIPE(flattened, 80, NULL, draw_flattened, "triangles without area among others");
RECIPE(lattice, 200, NULL, draw_lattice, "corners on small integers");
RECIPE(boxes, 200, NULL, draw_boxes, "closed boxes");
RECIPE(tetrahedra, 160, NULL, draw_tetrahedra, "closed tetrahedra");
RECIPE(corridor, 120, NULL, draw_corridor, "a long closed box");
RECIPE(balls, 240, NULL, draw_balls, "closed balls in each other");
RECIPE(fan, 140, NULL, draw_fan, "a closed double cone");
RECIPE(patch, 140, NULL, draw_patch, "a piece of a curved surface");
RECIPE(grid, 180, NULL, draw_grid, "a flat grid");
RECIPE(terrain, 180, NULL, draw_terrain, "a grid with heights");
RECIPE(coplanar, 120, NULL, draw_coplanar, "overlapping triangles of one plane");
RECIPE(sheets, 120, NULL, draw_sheets, "quads hardly above each other");
RECIPE(walls, 160, NULL, draw_walls, "axis-aligned quads, also far away");
RECIPE(nested, 120, NULL, draw_nested, "boxes in boxes");
RECIPE(concentric, 120, NULL, draw_concentric, "triangles with one centroid");
RECIPE(chain, 140, NULL, draw_chain, "positions 2^-i: a deep tree");
RECIPE(far, 180, NULL, draw_far, "far from the origin");
RECIPE(mixed, 120, NULL, draw_mixed, "large triangles over tiny ones");
RECIPE(tiny_scale, 120, NULL, draw_tiny_scale, "extents about 2^-14");
RECIPE(any_scale, 90, NULL, draw_any_scale, "any extent");
RECIPE(codes, 130, NULL, draw_codes, "coordinates on and beside float16s");
RECIPE(midpoints, 130, NULL, draw_midpoints, "coordinates half way between float16s");
RECIPE(largest, 80, NULL, draw_largest, "coordinates about 65504");
RECIPE(about_zero, 100, NULL, draw_about_zero, "coordinates about 0 and 2^-14");
RECIPE(few, 84, goal_few, draw_few, "0 to 15 triangles");
RECIPE(records, 1, goal_records, draw_records, "as many records as 15 or 16 bits count");
RECIPE(items, 1, goal_items, draw_items, "as many triangles as 15 or 16 bits count");

const struct recipe *const recipes[] = {
    &soup,     &needles,   &slivers,    &duplicates, &flattened, &lattice, &boxes,      &tetrahedra,
    &corridor, &balls,     &fan,        &patch,      &grid,      &terrain, &coplanar,   &sheets,
    &walls,    &nested,    &concentric, &chain,      &far,       &mixed,   &tiny_scale, &any_scale,
    &codes,    &midpoints, &largest,    &about_zero, &few,       &records, &items,      NULL,
};
