#include "scenes/generators/pen.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

enum status pen_start(struct pen *pen, uint64_t vertex_count, uint64_t tri_count,
                      struct reason *reason)
{
    if (tri_count > GENERATOR_TRI_MAX || vertex_count > 3 * (uint64_t)GENERATOR_TRI_MAX)
        return fail(reason, STATUS_LIMIT,
                    "%s: %" PRIu64 " triangles and %" PRIu64 " vertices, but at most %u and %u",
                    pen->generator->name, tri_count, vertex_count, GENERATOR_TRI_MAX,
                    3 * GENERATOR_TRI_MAX);
    if (scene_make((uint32_t)vertex_count, (uint32_t)tri_count, pen->scene))
        return fail(reason, STATUS_MEMORY, "%s: no memory for %" PRIu64 " triangles",
                    pen->generator->name, tri_count);
    return STATUS_OK;
}

enum status pen_furnish(struct pen *pen, const struct material *material, uint32_t material_count,
                        const struct light *light, uint32_t light_count, float eye,
                        struct reason *reason)
{
    struct scene *scene = pen->scene;
    scene->material_of = alloc_zeroed(scene->tri_count, sizeof *scene->material_of);
    scene->material = alloc_zeroed(material_count, sizeof *scene->material);
    scene->light = alloc_zeroed(light_count, sizeof *scene->light);
    if (!scene->material_of || !scene->material || !scene->light)
        return fail(reason, STATUS_MEMORY, "%s: no memory for the materials", pen->generator->name);
    memcpy(scene->material, material, material_count * sizeof *material);
    memcpy(scene->light, light, light_count * sizeof *light);
    scene->material_count = material_count;
    scene->light_count = light_count;
    scene->camera = (struct camera){.pos = {0, 0, eye}, .orbit = true};
    scene->has_camera = true;
    return STATUS_OK;
}

uint32_t pen_vertex(struct pen *pen, double x, double y, double z)
{
    assert(pen->vertex_count < pen->scene->vertex_count);
    float *v = pen->scene->vertex + 3 * (size_t)pen->vertex_count;
    v[0] = (float)x;
    v[1] = (float)y;
    v[2] = (float)z;
    return pen->vertex_count++;
}

void pen_tri(struct pen *pen, uint32_t a, uint32_t b, uint32_t c)
{
    assert(pen->tri_count < pen->scene->tri_count);
    uint32_t *index = pen->scene->index + 3 * (size_t)pen->tri_count;
    index[0] = a;
    index[1] = b;
    index[2] = c;
    if (pen->scene->material_of)
        pen->scene->material_of[pen->tri_count] = pen->material;
    pen->tri_count++;
}

void pen_quad(struct pen *pen, const double origin[3], const double e1[3], const double e2[3],
              uint32_t n)
{
    uint32_t first = pen->vertex_count;
    for (uint32_t j = 0; j <= n; j++)
        for (uint32_t i = 0; i <= n; i++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = origin[k] + e1[k] * i / n + e2[k] * j / n;
            pen_vertex(pen, p[0], p[1], p[2]);
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + j * (n + 1) + i;
            pen_tri(pen, a, a + 1, a + n + 2);
            pen_tri(pen, a, a + n + 2, a + n + 1);
        }
}

/* A ring of equal height on the octahedron: 4 * side vertices, or one if side is 0. */
struct ring {
    uint32_t first;
    uint32_t side;
};

static uint32_t ring_vertex(struct ring ring, uint32_t m)
{
    return ring.side ? ring.first + m % (4 * ring.side) : ring.first;
}

static struct ring draw_ring(struct pen *pen, uint32_t n, uint32_t row, const double centre[3],
                             double radius)
{
    struct ring ring = {.first = pen->vertex_count, .side = row <= n ? row : 2 * n - row};
    int side = (int)ring.side, z = (int)n - (int)row;
    for (int m = 0; m < (side ? 4 * side : 1); m++) {
        int turn = side ? m / side : 0, s = side ? m % side : 0, c = side - s;
        int x = turn == 0 ? c : turn == 1 ? -s : turn == 2 ? -c : s;
        int y = turn == 0 ? s : turn == 1 ? c : turn == 2 ? -s : -c;
        double scale = radius / sqrt((double)(x * x + y * y + z * z));
        pen_vertex(pen, centre[0] + scale * x, centre[1] + scale * y, centre[2] + scale * z);
    }
    return ring;
}

/* Draws the triangles between the ring nearer to a pole and the longer one. `north` selects the
 * winding, so that both hemispheres face outward. */
static void draw_band(struct pen *pen, struct ring polar, struct ring wide, bool north)
{
    for (uint32_t turn = 0; turn < 4; turn++)
        for (uint32_t s = 0; s <= polar.side; s++) {
            uint32_t a = ring_vertex(polar, turn * polar.side + s);
            uint32_t b = ring_vertex(wide, turn * wide.side + s);
            uint32_t c = ring_vertex(wide, turn * wide.side + s + 1);
            pen_tri(pen, a, north ? b : c, north ? c : b);
            if (s == polar.side)
                continue;
            uint32_t d = ring_vertex(polar, turn * polar.side + s + 1);
            pen_tri(pen, a, north ? c : d, north ? d : c);
        }
}

void pen_sphere(struct pen *pen, uint32_t n, const double centre[3], double radius)
{
    struct ring above = draw_ring(pen, n, 0, centre, radius);
    for (uint32_t row = 1; row <= 2 * n; row++) {
        struct ring below = draw_ring(pen, n, row, centre, radius);
        if (row <= n)
            draw_band(pen, above, below, true);
        else
            draw_band(pen, below, above, false);
        above = below;
    }
}

void cube_corners(double half, double v[8][3])
{
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++)
            v[i][k] = i >> k & 1 ? -half : half;
}

void golden_corners(double a, double b, double v[12][3])
{
    for (int i = 0; i < 12; i++) {
        int k = i / 4;
        v[i][k] = 0;
        v[i][(k + 1) % 3] = i & 1 ? -a : a;
        v[i][(k + 2) % 3] = i & 2 ? -b : b;
    }
}
