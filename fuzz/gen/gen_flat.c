/* Recipes of flat boxes: sheets, walls and stacks. */
#include "fuzz/gen/gen_recipes.h"

/* A lattice in a plane of constant height, or with random heights. */
struct flat_sheet {
    float origin[3], step, height; /* step along both axes, height up to which it may rise */
    int up;                        /* axis */
};

static void lattice_point(struct sketch *sketch, uint32_t i, uint32_t j, float out[3],
                          const void *how)
{
    const struct flat_sheet *sheet = how;
    int a = (sheet->up + 1) % 3, b = (sheet->up + 2) % 3;
    out[a] = sheet->origin[a] + sheet->step * (float)i;
    out[b] = sheet->origin[b] + sheet->step * (float)j;
    out[sheet->up] = sheet->origin[sheet->up];
    if (sheet->height > 0)
        out[sheet->up] += sheet->height * sketch_signed(sketch);
}

static struct flat_sheet sheet_around_origin(struct sketch *sketch, uint32_t n, uint32_t m)
{
    struct flat_sheet sheet = {.step = power_of_two((int)rng_below(sketch->rng, 6) - 3)};
    sheet.up = (int)rng_below(sketch->rng, 3);
    sheet.origin[(sheet.up + 1) % 3] = -0.5f * sheet.step * (float)n;
    sheet.origin[(sheet.up + 2) % 3] = -0.5f * sheet.step * (float)m;
    return sheet;
}

/* A flat grid: every inner vertex belongs to six triangles of one plane. */
void draw_grid(struct sketch *sketch)
{
    uint32_t n, m;
    sketch_sheet_size(sketch, &n, &m);
    struct flat_sheet sheet = sheet_around_origin(sketch, n, m);
    if (rng_below(sketch->rng, 2)) /* tenths: the plane is no float16, nor its centroids in it */
        sheet.origin[sheet.up] = 0.1f * (float)((int)rng_below(sketch->rng, 200) - 100);
    if (n > 0)
        sketch_sheet(sketch, n, m, lattice_point, &sheet);
}

void draw_terrain(struct sketch *sketch)
{
    uint32_t n, m;
    sketch_sheet_size(sketch, &n, &m);
    struct flat_sheet sheet = sheet_around_origin(sketch, n, m);
    sheet.height = sheet.step * power_of_two(-(int)rng_below(sketch->rng, 10));
    if (n > 0)
        sketch_sheet(sketch, n, m, lattice_point, &sheet);
}

/* Triangles that overlap in one plane, corners on a lattice. */
void draw_coplanar(struct sketch *sketch)
{
    int up = (int)rng_below(sketch->rng, 3);
    float height = 0.25f * (float)((int)rng_below(sketch->rng, 17) - 8);
    while (sketch_room(sketch) > 0) {
        float v[3][3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                v[c][k] = k == up ? height : 0.25f * (float)((int)rng_below(sketch->rng, 17) - 8);
        sketch_loose(sketch, v);
    }
}

/* Quads over each other, a step of a float or a power of two apart. */
void draw_sheets(struct sketch *sketch)
{
    int up = (int)rng_below(sketch->rng, 3), exponent = 1 - (int)rng_below(sketch->rng, 24);
    bool steps = rng_below(sketch->rng, 2);
    float height = sketch_signed(sketch);
    while (sketch_room(sketch) >= 2) {
        struct flat_sheet sheet = {.step = 2.0f, .up = up};
        for (int k = 0; k < 3; k++)
            sheet.origin[k] = k == up ? height : -1.0f;
        sketch_sheet(sketch, 1, 1, lattice_point, &sheet);
        height = steps ? float_step(height, 1 + (int)rng_below(sketch->rng, 3))
                       : height + power_of_two(exponent);
    }
}

/* Axis-aligned walls: boxes without thickness, near the origin and as far as 65504, where an
 * absolute padding vanishes. */
void draw_walls(struct sketch *sketch)
{
    float reach = power_of_two((int)rng_below(sketch->rng, 15));
    while (sketch_room(sketch) >= 2) {
        struct flat_sheet sheet = {.up = (int)rng_below(sketch->rng, 3)};
        sheet.step = reach * (0.0625f + rng_float(sketch->rng));
        for (int k = 0; k < 3; k++)
            sheet.origin[k] = reach * sketch_signed(sketch);
        sketch_sheet(sketch, 1, 1, lattice_point, &sheet);
    }
}
