#include "scenes/generators/pen.h"

#include <math.h>

enum { WHICH, RADIUS, ROWS };

enum { ALL = 5 };

#define VERTEX_MAX 20
#define FACE_MAX   20

/* A solid: faces with `corners` vertices each, counter-clockwise seen from outside. */
struct solid {
    uint32_t vertex_count, face_count, corners;
    uint8_t face[FACE_MAX][5];
};

/* Faces index the vertices that solid_vertices writes. */
static const struct solid solids[ALL] = {
    {4, 4, 3, {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}},
    {8, 6, 4, {{0, 1, 3, 2}, {0, 2, 6, 4}, {0, 4, 5, 1}, {1, 5, 7, 3}, {2, 3, 7, 6}, {4, 6, 7, 5}}},
    {6,
     8,
     3,
     {{0, 2, 4}, {0, 3, 5}, {0, 4, 3}, {0, 5, 2}, {1, 2, 5}, {1, 3, 4}, {1, 4, 2}, {1, 5, 3}}},
    {20,
     12,
     5,
     {{0, 8, 9, 2, 12},
      {0, 12, 13, 4, 16},
      {0, 16, 17, 1, 8},
      {1, 14, 3, 9, 8},
      {1, 17, 5, 15, 14},
      {2, 9, 3, 19, 18},
      {2, 18, 6, 13, 12},
      {3, 14, 15, 7, 19},
      {4, 10, 5, 17, 16},
      {4, 13, 6, 11, 10},
      {5, 10, 11, 7, 15},
      {6, 18, 19, 7, 11}}},
    {12, 20, 3, {{0, 1, 4},   {0, 4, 8},  {0, 6, 1}, {0, 8, 9},  {0, 9, 6},  {1, 6, 11}, {1, 10, 4},
                 {1, 11, 10}, {2, 3, 7},  {2, 5, 3}, {2, 7, 9},  {2, 8, 5},  {2, 9, 8},  {3, 5, 10},
                 {3, 10, 11}, {3, 11, 7}, {4, 5, 8}, {4, 10, 5}, {6, 7, 11}, {6, 9, 7}}},
};

/* Writes the vertices of solid `which` and returns their distance from its centre. */
static double solid_vertices(int which, double v[VERTEX_MAX][3])
{
    double golden = (1 + sqrt(5.0)) / 2;
    switch (which) {
    case 0: /* alternate corners of the cube */
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++)
                v[i][k] = i == 0 || i == k + 1 ? 1 : -1;
        return sqrt(3.0);
    case 1:
        cube_corners(1, v);
        return sqrt(3.0);
    case 2:
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < 3; k++)
                v[i][k] = k == i / 2 ? (i & 1 ? -1 : 1) : 0;
        return 1;
    case 3:
        cube_corners(1, v);
        golden_corners(1 / golden, golden, v + 8);
        return sqrt(3.0);
    default:
        golden_corners(1, golden, v);
        return sqrt(1 + golden * golden);
    }
}

static void draw_solid(struct pen *pen, int which, const double centre[3], double radius)
{
    const struct solid *solid = &solids[which];
    double v[VERTEX_MAX][3];
    double scale = radius / solid_vertices(which, v);
    uint32_t first = pen->vertex_count;
    for (uint32_t i = 0; i < solid->vertex_count; i++)
        pen_vertex(pen, centre[0] + scale * v[i][0], centre[1] + scale * v[i][1],
                   centre[2] + scale * v[i][2]);
    for (uint32_t f = 0; f < solid->face_count; f++)
        for (uint32_t c = 2; c < solid->corners; c++)
            pen_tri(pen, first + solid->face[f][0], first + solid->face[f][c - 1],
                    first + solid->face[f][c]);
}

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    int which = (int)value[WHICH], rows = (int)value[ROWS];
    int first = which == ALL ? 0 : which, last = which == ALL ? ALL - 1 : which;
    uint64_t vertex_count = 0, tri_count = 0;
    for (int i = first; i <= last; i++) {
        vertex_count += solids[i].vertex_count;
        tri_count += (uint64_t)solids[i].face_count * (solids[i].corners - 2);
    }
    enum status status =
        pen_start(pen, vertex_count * (uint64_t)rows, tri_count * (uint64_t)rows, reason);
    if (status)
        return status;
    double step = 2.5 * value[RADIUS]; /* neighbours are half a radius apart */
    for (int row = 0; row < rows; row++)
        for (int i = first; i <= last; i++)
            draw_solid(pen, i,
                       (const double[3]){(i - 0.5 * (first + last)) * step, 0,
                                         (row - 0.5 * (rows - 1)) * step},
                       value[RADIUS]);
    return STATUS_OK;
}

const struct generator gen_platonic = {
    .name = "platonic",
    .summary = "platonic solids, closed, side by side along x; no seed",
    .param = {[WHICH] = {"which",
                         "0 tetrahedron, 1 cube, 2 octahedron, 3 dodecahedron, 4 icosahedron, "
                         "5 all",
                         5, 0, 5, true},
              [RADIUS] = {"radius", "distance of the vertices from the centre", 1, 1e-9, 1e9,
                          false},
              [ROWS] = {"rows", "copies along z", 1, 1, 1 << 14, true}},
    .make = make,
    .seedless = true,
};
