#include "scenes/generators/pen.h"

enum { N };

enum { WHITE, RED, GREEN, LAMP };

#define QUADS 18 /* 5 walls, 2 blocks of 6, the lamp */

/* A parallelogram and its material. */
struct quad {
    double origin[3], e1[3], e2[3];
    int32_t material;
};

/* The room is the cube -1..1, open towards the camera at +z. */
static const struct quad room[] = {
    {{-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, WHITE}, /* floor */
    {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, WHITE},  /* ceiling */
    {{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, WHITE}, /* back */
    {{-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, RED},   /* left */
    {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}, GREEN},  /* right */
    {{-0.25, 0.96875, -0.25}, {0.5, 0, 0}, {0, 0, 0.5}, LAMP},
};

/* A block on the floor. Its x and z edges are rotated by an angle with rational sine and cosine, so
 * that no library function is needed. */
struct cornell_block {
    double x, z; /* centre */
    double half, height;
    double cosine, sine;
};

static const struct cornell_block blocks[] = {
    {-0.375, -0.375, 0.3125, 1.25, 24.0 / 25.0, 7.0 / 25.0},
    {0.375, 0.25, 0.3125, 0.625, 12.0 / 13.0, -5.0 / 13.0},
};

static void draw_block(struct pen *pen, const struct cornell_block *b, uint32_t n)
{
    double ex[3] = {2 * b->half * b->cosine, 0, -2 * b->half * b->sine};
    double ez[3] = {2 * b->half * b->sine, 0, 2 * b->half * b->cosine};
    double up[3] = {0, b->height, 0};
    double p[8][3]; /* corner i: bit 0 along ex, bit 1 up, bit 2 along ez */
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) {
            double middle = k == 0 ? b->x : k == 1 ? -1 : b->z;
            p[i][k] = middle + (i & 1 ? 0.5 : -0.5) * ex[k] + (i & 4 ? 0.5 : -0.5) * ez[k] +
                      (i & 2 ? 1 : 0) * up[k];
        }
    pen_quad(pen, p[0], ex, ez, n); /* bottom */
    pen_quad(pen, p[2], ez, ex, n); /* top */
    pen_quad(pen, p[0], up, ex, n);
    pen_quad(pen, p[4], ex, up, n);
    pen_quad(pen, p[0], ez, up, n);
    pen_quad(pen, p[1], up, ez, n);
}

static const struct material materials[] = {
    [WHITE] = {{0.75f, 0.75f, 0.75f}, {0.9f, 0.1f, 0}, 10},
    [RED] = {{0.75f, 0.125f, 0.125f}, {0.9f, 0.1f, 0}, 10},
    [GREEN] = {{0.125f, 0.75f, 0.125f}, {0.9f, 0.1f, 0}, 10},
    [LAMP] = {{1, 1, 1}, {1, 0, 0}, 1},
};

static const struct light lamp = {{0, 0.9375f, 0}, 1.5f};

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t n = (uint32_t)value[N];
    enum status status =
        pen_start(pen, QUADS * PEN_QUAD_VERTICES(n), QUADS * 2 * (uint64_t)n * n, reason);
    if (status)
        return status;
    status = pen_furnish(pen, materials, ARRAY_COUNT(materials), &lamp, 1, 3, reason);
    if (status)
        return status;
    for (size_t i = 0; i < ARRAY_COUNT(room); i++) {
        pen->material = room[i].material;
        pen_quad(pen, room[i].origin, room[i].e1, room[i].e2, n);
    }
    pen->material = WHITE;
    for (size_t i = 0; i < ARRAY_COUNT(blocks); i++)
        draw_block(pen, &blocks[i], n);
    return STATUS_OK;
}

const struct generator gen_cornell = {
    .name = "cornell",
    .summary = "box open in front, two blocks, a lamp; materials, light and camera; no seed",
    .param = {[N] = {"n", "each side is n x n quads", 1, 1, 170, true}},
    .make = make,
    .seedless = true,
};
