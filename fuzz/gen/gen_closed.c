/* Recipes of closed meshes and of pieces of them. */
#include "fuzz/gen/gen_recipes.h"

/* Boxes side by side and through each other, then tetrahedra. */
void draw_boxes(struct sketch *sketch)
{
    while (sketch_room(sketch) >= SKETCH_BOX) {
        float lo[3], hi[3];
        sketch_point(sketch, sketch_origin, 1.0f, lo);
        for (int k = 0; k < 3; k++)
            hi[k] = lo[k] + 0.0625f + rng_float(sketch->rng);
        sketch_box(sketch, lo, hi);
    }
    draw_tetrahedra(sketch);
}

void draw_tetrahedra(struct sketch *sketch)
{
    while (sketch_room(sketch) >= SKETCH_TETRA) {
        float v[4][3], centre[3];
        sketch_point(sketch, sketch_origin, 0.75f, centre);
        for (int c = 0; c < 4; c++)
            sketch_point(sketch, centre, 0.5f, v[c]);
        sketch_tetra(sketch, v);
    }
}

/* A long box, in which Woop's rounding is absolute and a relative padding is too small. */
void draw_corridor(struct sketch *sketch)
{
    int axis = (int)rng_below(sketch->rng, 3), longer = 2 + (int)rng_below(sketch->rng, 14);
    float lo[3], hi[3];
    for (int k = 0; k < 3; k++) {
        hi[k] = 1.0f;
        if (k == axis)
            hi[k] = power_of_two(longer);
        lo[k] = -hi[k];
    }
    if (sketch_room(sketch) >= SKETCH_BOX)
        sketch_box(sketch, lo, hi);
    draw_soup(sketch);
}

/* Moves a point of the octahedron half way to the cube around it: round enough, and without a
 * square root. */
static void bulge(float p[3])
{
    float most = 0;
    for (int k = 0; k < 3; k++) {
        float size = p[k] < 0 ? -p[k] : p[k];
        most = size > most ? size : most;
    }
    for (int k = 0; k < 3; k++)
        p[k] = 0.5f * p[k] + 0.375f * (p[k] / most);
}

/* A closed bulging octahedron, its edges cut in n: 8 n^2 triangles, shared vertices. */
static void draw_ball(struct sketch *sketch, uint32_t n, const float centre[3], float radius)
{
    /* Rows of constant y from the top; each is a ring of 4 m points, a pole for m = 0. */
    uint32_t above = 0; /* first vertex of the row above */
    for (uint32_t row = 0; row <= 2 * n; row++) {
        uint32_t m = row <= n ? row : 2 * n - row, ring = m ? 4 * m : 1;
        uint32_t first = sketch->vertex_count;
        for (uint32_t i = 0; i < ring; i++) {
            float p[3] = {0, (float)n - (float)row, 0};
            uint32_t side = m ? i / m : 0, along = m ? i % m : 0;
            float a = (float)(m - along), b = (float)along;
            p[0] = side == 0 ? a : side == 1 ? -b : side == 2 ? -a : b;
            p[2] = side == 0 ? b : side == 1 ? a : side == 2 ? -b : -a;
            for (int k = 0; k < 3; k++)
                p[k] = p[k] / (float)n;
            bulge(p);
            sketch_vertex(sketch, centre[0] + radius * p[0], centre[1] + radius * p[1],
                          centre[2] + radius * p[2]);
        }
        /* Between a ring of m and its neighbour of m - 1: per side m triangles on the large ring
         * and m - 1 on the small one. */
        bool down = row <= n; /* the row above is the smaller */
        uint32_t large = down ? first : above, small = down ? above : first;
        uint32_t size = down ? m : m + 1; /* points per side of the larger */
        for (uint32_t side = 0; row > 0 && side < 4; side++)
            for (uint32_t i = 0; i < size; i++) {
                uint32_t few = size > 1 ? 4 * (size - 1) : 1;
                uint32_t a = large + side * size + i;
                uint32_t b = large + (side * size + i + 1) % (4 * size);
                uint32_t c = small + (side * (size - 1) + i) % few;
                uint32_t d = small + (side * (size - 1) + i + 1) % few;
                sketch_tri(sketch, down ? b : a, down ? a : b, c);
                if (i + 1 < size)
                    sketch_tri(sketch, down ? d : b, down ? b : d, c);
            }
        above = first;
    }
}

/* The largest ball that has room, then tetrahedra. */
void draw_balls(struct sketch *sketch)
{
    float radius = 1.0f;
    while (sketch_room(sketch) >= 8) {
        float centre[3];
        uint32_t n = 1;
        while (8 * (n + 1) * (n + 1) <= sketch_room(sketch))
            n++;
        if (n > 1)
            n -= rng_below(sketch->rng, 2);
        sketch_point(sketch, sketch_origin, 0.25f, centre);
        draw_ball(sketch, n, centre, radius);
        radius *= 0.5f;
    }
    draw_tetrahedra(sketch);
}

/* A double cone: all triangles meet in one of two points, as many in each as there is room for. */
void draw_fan(struct sketch *sketch)
{
    uint32_t around = sketch_room(sketch) / 2;
    if (around < 3)
        return;
    float apex[2][3];
    for (int k = 0; k < 3; k++) {
        apex[0][k] = 0.125f * sketch_signed(sketch);
        apex[1][k] = 0.125f * sketch_signed(sketch);
    }
    apex[0][2] += 1.0f;
    apex[1][2] -= 1.0f;
    uint32_t top = sketch_vertex(sketch, apex[0][0], apex[0][1], apex[0][2]);
    uint32_t bottom = sketch_vertex(sketch, apex[1][0], apex[1][1], apex[1][2]);
    for (uint32_t i = 0; i < around; i++) {
        /* Around a square, so that no sine is needed. */
        float turn = 4.0f * (float)i / (float)around;
        uint32_t side = (uint32_t)turn;
        float along = 2.0f * (turn - (float)side) - 1.0f;
        float x = side == 0 ? 1.0f : side == 1 ? -along : side == 2 ? -1.0f : along;
        float y = side == 0 ? along : side == 1 ? 1.0f : side == 2 ? -along : -1.0f;
        sketch_vertex(sketch, x, y, 0.25f * sketch_signed(sketch));
    }
    for (uint32_t i = 0; i < around; i++) {
        uint32_t a = top + 2 + i, b = top + 2 + (i + 1) % around;
        sketch_tri(sketch, top, a, b);
        sketch_tri(sketch, bottom, b, a);
    }
}

/* A piece of a curved surface as scanners give it: the unit sphere by its rational chart, with a
 * little noise. */
static void chart(struct sketch *sketch, uint32_t i, uint32_t j, float out[3], const void *how)
{
    const float *step = how; /* origin in both directions, steps, noise */
    float u = step[0] + step[2] * (float)i, v = step[1] + step[3] * (float)j;
    float square = u * u + v * v, below = 1.0f / (1.0f + square);
    out[0] = 2.0f * u * below;
    out[1] = 2.0f * v * below;
    out[2] = (square - 1.0f) * below;
    for (int k = 0; k < 3; k++)
        out[k] += step[4] * sketch_signed(sketch);
}

void draw_patch(struct sketch *sketch)
{
    uint32_t n, m;
    float step[5];
    sketch_sheet_size(sketch, &n, &m);
    step[0] = 2.0f * sketch_signed(sketch);
    step[1] = 2.0f * sketch_signed(sketch);
    step[2] = power_of_two(-1 - (int)rng_below(sketch->rng, 7));
    step[3] = step[2];
    step[4] = rng_below(sketch->rng, 2) ? 0.125f * step[2] : 0.0f;
    if (n > 0)
        sketch_sheet(sketch, n, m, chart, step);
}
