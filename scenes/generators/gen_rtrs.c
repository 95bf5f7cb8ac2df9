#include "scenes/generators/pen.h"

#include <math.h>

enum { GREY, RED, MIRROR }; /* materials */

/* The faces of the dodecahedron, counter-clockwise seen from outside, each from the first corner of
 * its fan. Corners 0 .. 7 are those of the cube, negative in axis k where bit k is set; then come
 * three golden rectangles. The first corner of a fan determines its triangles, and so the tree. */
static const uint8_t face[12][5] = {
    {16, 0, 12, 2, 18}, {16, 18, 6, 13, 4}, {17, 5, 15, 7, 19}, {17, 19, 3, 14, 1},
    {17, 1, 8, 10, 5},  {16, 4, 10, 8, 0},  {18, 2, 9, 11, 6},  {19, 7, 11, 9, 3},
    {13, 6, 11, 7, 15}, {10, 4, 13, 15, 5}, {8, 1, 14, 12, 0},  {9, 2, 12, 14, 3},
};

/* Rounds to six decimals, as in the mesh file that the published one was made from. */
static double six_decimals(double x)
{
    return round(x * 1e6) / 1e6;
}

/* A corner of the cube from 1 to 2, nearest to the origin: its three edges and the face that they
 * span. */
static void draw_tetrahedron(struct pen *pen)
{
    pen->material = RED;
    for (int i = 0; i < 4; i++)
        pen_vertex(pen, i == 1 ? 2 : 1, i == 2 ? 2 : 1, i == 3 ? 2 : 1);
    pen_tri(pen, 0, 2, 1);
    pen_tri(pen, 0, 3, 2);
    pen_tri(pen, 0, 1, 3);
    pen_tri(pen, 1, 2, 3);
}

/* Draws the dodecahedron around the origin, its corners at distance 1. */
static void draw_dodecahedron(struct pen *pen)
{
    double golden = (1 + sqrt(5.0)) / 2, unit = 1 / sqrt(3.0), v[20][3];
    cube_corners(unit, v);
    golden_corners(golden * unit, 1 / golden * unit, v + 8);
    uint32_t first = pen->vertex_count;
    for (int i = 0; i < 20; i++)
        pen_vertex(pen, six_decimals(v[i][0]), six_decimals(v[i][1]), six_decimals(v[i][2]));
    pen->material = GREY;
    for (int f = 0; f < 12; f++)
        for (int c = 4; c > 1; c--)
            pen_tri(pen, first + face[f][c - 1], first + face[f][c], first + face[f][0]);
}

/* The published materials (no triangle uses the last) and lights. */
static const struct material materials[] = {
    [GREY] = {{0.4f, 0.4f, 0.3f}, {0.6f, 0.3f, 0.1f}, 50},
    [RED] = {{0.3f, 0.1f, 0.1f}, {0.9f, 0.1f, 0}, 10},
    [MIRROR] = {{1, 1, 1}, {0, 10, 0.8f}, 1425},
};
static const struct light lights[] = {
    {{-20, 20, 20}, 1.5f}, {{30, 50, -25}, 1.8f}, {{30, 20, 30}, 1.7f}};

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    (void)value;
    enum status status = pen_start(pen, 24, 40, reason);
    if (status)
        return status;
    status = pen_furnish(pen, materials, ARRAY_COUNT(materials), lights, ARRAY_COUNT(lights), -10,
                         reason);
    if (status)
        return status;
    draw_tetrahedron(pen);
    draw_dodecahedron(pen);
    return STATUS_OK;
}

const struct generator gen_rtrs = {
    .name = "rtrs",
    .summary = "RTRS's default scene: tetrahedron, dodecahedron; furnished; no parameter",
    .make = make,
    .seedless = true,
};
