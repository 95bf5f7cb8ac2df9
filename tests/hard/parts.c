#include "tests/hard/parts.h"

#include "scenes/scenes.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* The array with room for `need` elements; as it was, and part.failed, without memory. */
static void *reserve(struct hard_part *part, void *array, size_t *room, size_t need, size_t size)
{
    if (!part->failed && array_reserve(&array, room, need, size))
        part->failed = true;
    return array;
}

struct hard_part *part_add(struct hard_made *made, const char *label, ...)
{
    assert(made->part_count < HARD_PARTS_MOST);
    struct hard_part *part = &made->part[made->part_count++];
    va_list args;
    va_start(args, label);
    (void)vsnprintf(part->label, sizeof part->label, label, args);
    va_end(args);
    return part;
}

struct hard_part *part_open(struct hard_made *made, const char *spec)
{
    struct hard_part *part = part_add(made, "%s", spec);
    if (scene_open(spec, 1, &part->scene, NULL)) {
        part->failed = true;
        return part;
    }
    part->vertex_room = 3 * (size_t)part->scene.vertex_count;
    part->index_room = 3 * (size_t)part->scene.tri_count;
    return part;
}

uint32_t part_vertex(struct hard_part *part, float x, float y, float z)
{
    struct scene *scene = &part->scene;
    size_t at = 3 * (size_t)scene->vertex_count;
    scene->vertex = reserve(part, scene->vertex, &part->vertex_room, at + 3, sizeof(float));
    if (part->failed)
        return 0;
    scene->vertex[at] = x;
    scene->vertex[at + 1] = y;
    scene->vertex[at + 2] = z;
    return scene->vertex_count++;
}

uint32_t part_tri(struct hard_part *part, uint32_t a, uint32_t b, uint32_t c)
{
    struct scene *scene = &part->scene;
    size_t at = 3 * (size_t)scene->tri_count;
    scene->index = reserve(part, scene->index, &part->index_room, at + 3, sizeof(uint32_t));
    if (part->failed)
        return 0;
    scene->index[at] = a;
    scene->index[at + 1] = b;
    scene->index[at + 2] = c;
    return scene->tri_count++;
}

uint32_t part_triangle(struct hard_part *part, float ax, float ay, float az, float bx, float by,
                       float bz, float cx, float cy, float cz)
{
    uint32_t first = part_vertex(part, ax, ay, az);
    part_vertex(part, bx, by, bz);
    part_vertex(part, cx, cy, cz);
    return part_tri(part, first, first + 1, first + 2);
}

uint32_t part_tri_of(struct hard_part *part, float v[3][3])
{
    return part_triangle(part, v[0][0], v[0][1], v[0][2], v[1][0], v[1][1], v[1][2], v[2][0],
                         v[2][1], v[2][2]);
}

void part_layer(struct hard_part *part, float z)
{
    part_triangle(part, 0, 0, z, 4, 0, z, 0, 4, z);
}

void part_split(struct hard_part *part, const struct hard_part *from)
{
    for (uint32_t i = 0; i < from->scene.tri_count; i++) {
        float v[3][3];
        scene_tri(&from->scene, i, v);
        part_tri_of(part, v);
    }
}

void part_grid(struct hard_part *part, uint32_t n, int up, float height, float cell, float from)
{
    uint32_t first = part->scene.vertex_count, side = n + 1;
    for (uint32_t j = 0; j < side; j++)
        for (uint32_t i = 0; i < side; i++) {
            float p[3];
            p[up] = height;
            p[(up + 1) % 3] = from + cell * (float)i;
            p[(up + 2) % 3] = from + cell * (float)j;
            part_vertex(part, p[0], p[1], p[2]);
        }
    for (uint32_t j = 0; j < n; j++)
        for (uint32_t i = 0; i < n; i++) {
            uint32_t a = first + i + side * j;
            part_tri(part, a, a + 1, a + side + 1);
            part_tri(part, a, a + side + 1, a + side);
        }
}

uint32_t grid_tri(uint32_t n, float x, float y)
{
    uint32_t i = (uint32_t)x, j = (uint32_t)y;
    return 2 * (i + n * j) + (x - (float)i < y - (float)j);
}

struct hard_part *part_floor(struct hard_made *made, const char *label, uint32_t n, float height)
{
    struct hard_part *part = part_add(made, "%s", label);
    part_grid(part, n, 2, height, 1, 0);
    return part;
}

void part_cube(struct hard_part *part, float from, float size)
{
    static const unsigned char corner[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                                {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                                {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    uint32_t first = part->scene.vertex_count;
    for (int c = 0; c < 8; c++)
        part_vertex(part, from + (c & 1 ? size : 0), from + (c & 2 ? size : 0),
                    from + (c & 4 ? size : 0));
    for (size_t i = 0; i < ARRAY_COUNT(corner); i++)
        part_tri(part, first + corner[i][0], first + corner[i][1], first + corner[i][2]);
}

struct ray ray_turned(int up, struct ray ray)
{
    struct ray turned = ray;
    for (int k = 0; k < 3; k++) {
        turned.org[(up + k) % 3] = ray.org[k];
        turned.dir[(up + k) % 3] = ray.dir[k];
    }
    return turned;
}

struct ray ray_at(const float from[3], const float to[3])
{
    return ray_of(from[0], from[1], from[2], to[0] - from[0], to[1] - from[1], to[2] - from[2]);
}

void part_ray(struct hard_part *part, struct ray ray)
{
    size_t need = part->ray_count + 1;
    part->ray = reserve(part, part->ray, &part->ray_room, need, sizeof *part->ray);
    part->want = reserve(part, part->want, &part->want_room, need, sizeof *part->want);
    if (part->failed)
        return;
    part->ray[part->ray_count] = ray;
    part->want[part->ray_count++] = (struct hard_want){0};
}

static struct hard_want *last_want(struct hard_part *part)
{
    static struct hard_want lost; /* written to and never read */
    return part->failed ? &lost : &part->want[part->ray_count - 1];
}

void want(struct hard_part *part, enum hard_scope scope, unsigned what)
{
    struct hard_want *want = last_want(part);
    want->what |= what;
    want->scope = scope;
}

/* Room for the last ray's set of triangles; NULL without memory. */
static uint32_t *want_set(struct hard_part *part, enum hard_scope scope, uint32_t count)
{
    part->id = reserve(part, part->id, &part->id_room, part->id_count + count, sizeof *part->id);
    if (part->failed)
        return NULL;
    struct hard_want *last = last_want(part);
    last->id_first = (uint32_t)part->id_count;
    last->id_count = count;
    part->id_count += count;
    want(part, scope, WANT_HIT | WANT_ID);
    return part->id + last->id_first;
}

void want_ids(struct hard_part *part, enum hard_scope scope, uint32_t count, const uint32_t *id)
{
    uint32_t *set = want_set(part, scope, count);
    if (set)
        memcpy(set, id, count * sizeof *id);
}

void want_range(struct hard_part *part, enum hard_scope scope, uint32_t first, uint32_t count)
{
    uint32_t *set = want_set(part, scope, count);
    for (uint32_t i = 0; set && i < count; i++)
        set[i] = first + i;
}

void want_id(struct hard_part *part, enum hard_scope scope, uint32_t id)
{
    want_range(part, scope, id, 1);
}

void want_t(struct hard_part *part, enum hard_scope scope, float t)
{
    last_want(part)->t = t;
    want(part, scope, WANT_HIT | WANT_T);
}

void want_like(struct hard_part *part, enum hard_scope scope, size_t like, int shift, float add)
{
    struct hard_want *last = last_want(part);
    last->like = (uint32_t)like;
    last->shift = shift;
    last->add = add;
    want(part, scope, WANT_LIKE);
}

void expect_hit(struct hard_part *part, enum hard_scope scope, struct ray ray)
{
    part_ray(part, ray);
    want(part, scope, WANT_HIT);
}

void expect_miss(struct hard_part *part, enum hard_scope scope, struct ray ray)
{
    part_ray(part, ray);
    want(part, scope, WANT_MISS);
}

void expect_id(struct hard_part *part, enum hard_scope scope, struct ray ray, uint32_t id)
{
    part_ray(part, ray);
    want_id(part, scope, id);
}

void expect_t(struct hard_part *part, enum hard_scope scope, struct ray ray, float t)
{
    part_ray(part, ray);
    want_t(part, scope, t);
}

void random_point(struct rng *rng, float lo, float hi, float p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = rng_range(rng, lo, hi);
}

void random_near(struct rng *rng, const float centre[3], float reach, float p[3])
{
    for (int k = 0; k < 3; k++)
        p[k] = centre[k] + reach * rng_range(rng, -1, 1);
}

void random_far(struct rng *rng, float distance, float p[3])
{
    random_point(rng, -1, 1, p);
    float length = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int k = 0; k < 3; k++)
        p[k] *= distance / length;
}

void part_corner(const struct hard_part *part, uint32_t vertex, float p[3])
{
    if (!part->failed)
        memcpy(p, part->scene.vertex + 3 * (size_t)vertex, 3 * sizeof *p);
}

void part_point(const struct hard_part *part, struct rng *rng, uint32_t prim, float p[3])
{
    float v[3][3], w[3] = {0.125f, 0.125f, 0.125f};
    float a = 0.625f * rng_float(rng), b = 0.625f * rng_float(rng);
    if (part->failed)
        return;
    float lower = fminf(a, b), upper = fmaxf(a, b);
    w[0] += lower;
    w[1] += upper - lower;
    w[2] += 0.625f - upper;
    scene_tri(&part->scene, prim, v);
    for (int k = 0; k < 3; k++)
        p[k] = w[0] * v[0][k] + w[1] * v[1][k] + w[2] * v[2][k];
}

void part_edge(const struct hard_part *part, uint32_t prim, int c, float p[3])
{
    float v[3][3];
    if (part->failed)
        return;
    scene_tri(&part->scene, prim, v);
    for (int k = 0; k < 3; k++)
        p[k] = 0.5f * (v[c][k] + v[(c + 1) % 3][k]);
}
