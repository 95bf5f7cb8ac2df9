#include "scenes/generators/pen.h"

#include <math.h>

enum { DEPTH, N };

#define CHILDREN 9
#define WALL     2.25 /* half side of the box; a flake of radius 1 reaches 1 + 2/3 + ... < 2 */

/* A sphere and the frame of its children: axis, u, v are orthonormal, axis points away from the
 * parent. */
struct ball {
    double centre[3];
    double radius;
    double axis[3], u[3], v[3];
};

/* Child `which` of `parent`: six around the equator, three above, where spheres touch in a dense
 * packing (height sqrt(2/3)). Siblings of a third of the radius do not touch. */
static struct ball child(const struct ball *parent, int which)
{
    double root = sqrt(0.75);
    double turn[CHILDREN][2] = {{1, 0},       {0.5, root}, {-0.5, root}, {-1, 0}, {-0.5, -root},
                                {0.5, -root}, {root, 0.5}, {-root, 0.5}, {0, -1}};
    double up = which < 6 ? 0 : sqrt(2.0 / 3.0);
    double out = which < 6 ? 1 : sqrt(1.0 / 3.0);
    struct ball ball = {.radius = parent->radius / 3};
    for (int k = 0; k < 3; k++) {
        double flat = turn[which][0] * parent->u[k] + turn[which][1] * parent->v[k];
        ball.axis[k] = up * parent->axis[k] + out * flat;
        ball.u[k] = out * parent->axis[k] - up * flat;
        ball.centre[k] = parent->centre[k] + (parent->radius + ball.radius) * ball.axis[k];
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        ball.v[k] = ball.axis[a] * ball.u[b] - ball.axis[b] * ball.u[a];
    }
    return ball;
}

/* The recursion depth is at most the largest `depth` parameter. */
static void draw_flake(struct pen *pen, uint32_t n, const struct ball *ball, uint32_t depth)
{
    pen_sphere(pen, n, ball->centre, ball->radius);
    for (int i = 0; depth > 0 && i < CHILDREN; i++) {
        struct ball next = child(ball, i);
        draw_flake(pen, n, &next, depth - 1);
    }
}

/* Draws the box around the flake, facing inward. */
static void draw_box(struct pen *pen)
{
    static const uint8_t face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    uint32_t first = pen->vertex_count;
    for (int i = 0; i < 8; i++)
        pen_vertex(pen, i & 1 ? WALL : -WALL, i & 2 ? WALL : -WALL, i & 4 ? WALL : -WALL);
    for (int f = 0; f < 6; f++) {
        pen_tri(pen, first + face[f][0], first + face[f][2], first + face[f][1]);
        pen_tri(pen, first + face[f][0], first + face[f][3], first + face[f][2]);
    }
}

static enum status make(struct pen *pen, const double *value, struct reason *reason)
{
    uint32_t depth = (uint32_t)value[DEPTH], n = (uint32_t)value[N];
    uint64_t balls = 1;
    for (uint32_t i = 0; i < depth; i++)
        balls = balls * CHILDREN + 1;
    enum status status =
        pen_start(pen, 8 + balls * PEN_SPHERE_VERTICES(n), 12 + balls * PEN_SPHERE_TRIS(n), reason);
    if (status)
        return status;
    draw_box(pen);
    draw_flake(
        pen, n,
        &(const struct ball){.radius = 1, .axis = {0, 1, 0}, .u = {1, 0, 0}, .v = {0, 0, -1}},
        depth);
    return STATUS_OK;
}

const struct generator gen_flake = {
    .name = "flake",
    .summary = "sphere with nine smaller spheres on it, and so on, in a closed box; no seed",
    .param = {[DEPTH] = {"depth", "generations of smaller spheres", 2, 0, 6, true},
              [N] = {"n", "each sphere has 8 n^2 triangles", 2, 1, 64, true}},
    .make = make,
    .seedless = true,
};
