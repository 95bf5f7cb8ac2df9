#include "tests/exact/world_cases.h"

#include "tests/exact/oracle_cases.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- transforms ------------------------------------------------------------------------------- */

static float whole(struct rng *rng, int most)
{
    return (float)((int)rng_below(rng, (uint32_t)(2 * most + 1)) - most);
}

static void set_identity(float m[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = i == j;
}

static void scale_axes(float m[3][4], float x, float y, float z)
{
    for (int i = 0; i < 3; i++) {
        m[i][0] *= x;
        m[i][1] *= y;
        m[i][2] *= z;
    }
}

static void make_identity(struct rng *rng, float m[3][4])
{
    set_identity(m);
    if (rng_below(rng, 2))
        m[1][0] = -0.0f;
}

static void make_moved(struct rng *rng, float m[3][4])
{
    set_identity(m);
    for (int i = 0; i < 3; i++)
        m[i][3] = rng_range(rng, -1e6f, 1e6f);
}

/* A rotation, rounded, about a random axis by a random angle; a translation of about its size. */
static void make_turned(struct rng *rng, float m[3][4])
{
    double q[4], length = 0;
    for (int i = 0; i < 4; i++) {
        q[i] = (double)rng_range(rng, -1, 1);
        length += q[i] * q[i];
    }
    for (int i = 0; i < 4; i++)
        q[i] /= sqrt(length + 1e-9);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        m[i][i] = (float)(1 - 2 * (q[j] * q[j] + q[k] * q[k]));
        m[i][j] = (float)(2 * (q[i] * q[j] - q[k] * q[3]));
        m[j][i] = (float)(2 * (q[i] * q[j] + q[k] * q[3]));
        m[i][3] = rng_range(rng, -3, 3);
    }
}

static void make_far(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    for (int i = 0; i < 3; i++)
        m[i][3] *= 1e6f;
}

static void make_small(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    scale_axes(m, 1e-6f, 1e-6f, 1e-6f);
}

static void make_flat(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    if (rng_below(rng, 2))
        scale_axes(m, 1e6f, 1, 1);
    else
        scale_axes(m, 1, 1e-6f, 1);
}

static void make_mirror(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    scale_axes(m, -1, 1, rng_below(rng, 2) ? 2 : 1);
}

static void make_shear(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    for (int i = 0; i < 3; i++)
        m[i][1] += 40 * m[i][0] * rng_range(rng, -1, 1);
}

/* The third column is nearly one of the plane of the first two: the inverse is huge. */
static void make_singular(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    float a = rng_range(rng, -1, 1), b = rng_range(rng, -1, 1);
    for (int i = 0; i < 3; i++)
        m[i][2] = a * m[i][0] + b * m[i][1];
    if (rng_below(rng, 2)) /* even by a last place of one number alone */
        m[rng_below(rng, 3)][2] *= 1 + 0x1p-20f;
}

static void make_tiny(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] *= rng_below(rng, 4) ? 1e-38f : 1e-42f;
}

static void make_huge(struct rng *rng, float m[3][4])
{
    make_turned(rng, m);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] *= j == 3 ? 3e37f : 1e38f;
}

static void make_any_bits(struct rng *rng, float m[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = random_bits(rng);
}

/* Axes exchanged, mirrored and scaled by powers of two, moved by whole numbers. */
static void make_powers(struct rng *rng, float m[3][4])
{
    int first = (int)rng_below(rng, 3), step = 1 + (int)rng_below(rng, 2);
    memset(m, 0, 12 * sizeof(float));
    for (int i = 0; i < 3; i++) {
        float size = ldexpf(1, (int)rng_below(rng, 7) - 3);
        m[i][(first + step * i) % 3] = rng_below(rng, 2) ? size : -size;
        m[i][3] = whole(rng, 8);
    }
}

/* Small whole numbers. */
static void make_lattice(struct rng *rng, float m[3][4])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            m[i][j] = whole(rng, j == 3 ? 9 : 2);
}

/* The same, times powers of two far apart, so that sums cancel and leave double. */
static void make_spread(struct rng *rng, float m[3][4])
{
    make_lattice(rng, m);
    float x = ldexpf(1, (int)rng_below(rng, 120) - 60), y = ldexpf(1, (int)rng_below(rng, 40) - 20);
    scale_axes(m, x, y, 1);
}

const struct world_turn world_turns[WORLD_TURNS] = {
    {"identity", make_identity, true},  {"moved", make_moved, false},
    {"turned", make_turned, false},     {"far", make_far, false},
    {"small", make_small, false},       {"flat", make_flat, false},
    {"mirror", make_mirror, false},     {"shear", make_shear, false},
    {"singular", make_singular, false}, {"tiny", make_tiny, false},
    {"huge", make_huge, false},         {"any bits", make_any_bits, false},
    {"powers", make_powers, true},      {"lattice", make_lattice, true},
    {"spread", make_spread, false},
};

void world_turn_draw(const struct world_turn *turn, struct rng *rng, float m[3][4])
{
    do
        turn->make(rng, m);
    while (instance_det_sign(m) == 0);
}

/* --- meshes ----------------------------------------------------------------------------------- */

#define MESH_TRIS 5

static struct scene *draw_scene(struct rng *rng, bool lattice)
{
    struct scene *scene = malloc(sizeof *scene);
    if (!scene || scene_make(3 * MESH_TRIS, MESH_TRIS, scene))
        abort();
    for (uint32_t i = 0; i < 9 * MESH_TRIS; i++)
        scene->vertex[i] = lattice ? whole(rng, 4) : rng_range(rng, -1, 1);
    for (uint32_t i = 0; i < 3 * MESH_TRIS; i++)
        scene->index[i] = i;
    /* The second shares an edge with the first; the last is sometimes without area. */
    memcpy(scene->vertex + 9, scene->vertex, 6 * sizeof(float));
    if (rng_below(rng, 2))
        memcpy(scene->vertex + 9 * (MESH_TRIS - 1), scene->vertex + 9 * MESH_TRIS - 3,
               3 * sizeof(float));
    return scene;
}

/* One geometry, or three of which one is empty. */
static void draw_mesh(struct rng *rng, bool lattice, struct world_mesh *out)
{
    out->scene = draw_scene(rng, lattice);
    out->geometry_count = rng_below(rng, 2) ? 1 : 3;
    out->geometry = calloc(3, sizeof *out->geometry);
    if (!out->geometry)
        abort();
    out->geometry[0] = (struct geometry){0, out->geometry_count == 1 ? MESH_TRIS : 2, false};
    out->geometry[1] = (struct geometry){2, 0, true};
    out->geometry[2] = (struct geometry){2, MESH_TRIS - 2, rng_below(rng, 2)};
    out->geometry[0].opaque = rng_below(rng, 2);
}

/* --- worlds ----------------------------------------------------------------------------------- */

static void draw_flags(struct rng *rng, struct instance *out)
{
    static const uint32_t opacity[] = {0, 0, ABI_INSTANCE_FORCE_OPAQUE,
                                       ABI_INSTANCE_FORCE_NO_OPAQUE};
    out->custom = rng_below(rng, 4);
    out->mask = rng_below(rng, 4) ? 0xFF : rng_below(rng, 256);
    out->flags = opacity[rng_below(rng, 4)];
    out->flags |= rng_below(rng, 3) ? 0 : ABI_INSTANCE_CULL_DISABLE;
    out->flags |= rng_below(rng, 2) ? ABI_INSTANCE_FLIP_FACING : 0;
}

struct ray_mode world_mode_draw(struct rng *rng)
{
    static const uint32_t opacity[] = {
        0, 0, ABI_RAY_OPAQUE, ABI_RAY_NO_OPAQUE, ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE};
    static const uint32_t facing[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT};
    struct ray_mode mode = {.mask = 0xFF};
    if (rng_below(rng, 4) == 0)
        mode.mask = rng_below(rng, 256);
    mode.flags = opacity[rng_below(rng, 6)];
    mode.flags |= rng_below(rng, 20) ? facing[rng_below(rng, 3)] : ABI_RAY_SKIP_TRIANGLES;
    mode.flags |= rng_below(rng, 8) ? 0 : ABI_RAY_FIRST;
    return mode;
}

static float float_of(double x)
{
    return (float)fmin(fmax(x, -0x1.8p127), 0x1.8p127);
}

/* Corners of a placed triangle and a point of it, rounded; returns its size. */
static double look_at(const struct world *world, uint32_t prim, const double weight[3],
                      double corner[3][3], double target[3])
{
    struct place place = world_place(world, prim);
    const struct instance *at = &world->instance[place.instance];
    float v[3][3];
    double size = 0;
    scene_tri(world->mesh[place.mesh].scene, place.prim, v);
    for (int k = 0; k < 3; k++) {
        target[k] = 0;
        for (int c = 0; c < 3; c++) {
            corner[c][k] = (double)at->m[k][3];
            for (int j = 0; j < 3; j++)
                corner[c][k] += (double)at->m[k][j] * (double)v[c][j];
            target[k] += weight[c] * corner[c][k];
        }
        size =
            fmax(size, fmax(fabs(corner[1][k] - corner[0][k]), fabs(corner[2][k] - corner[0][k])));
    }
    return size;
}

static void draw_range(struct rng *rng, struct ray *ray)
{
    static const float ends[] = {-2, -1, -0.5f, 0, 0.5f, 1, 2, 4};
    ray->tmin = rng_below(rng, 2) ? 0 : -0x1p127f;
    ray->tmax = INFINITY;
    if (rng_below(rng, 3) == 0) {
        ray->tmin = ends[rng_below(rng, 4)];
        ray->tmax = rng_below(rng, 6) ? ends[4 + rng_below(rng, 4)] : ray->tmin;
    }
    if (rng_below(rng, 10) == 0)
        ray->tmax = -ray->tmin;
}

void world_case_aim(const struct world *world, bool whole_numbers, struct rng *rng, struct ray *ray)
{
    static const double part[4][3] = {{0.5, 0.25, 0.25}, {0.5, 0.5, 0}, {1, 0, 0}, {0, 0.25, 0.75}};
    double weight[3], corner[3][3], target[3];
    const double *chosen = part[rng_below(rng, 4)];
    int turn = (int)rng_below(rng, 3);
    for (int c = 0; c < 3; c++)
        weight[c] = chosen[(c + turn) % 3];
    double size = look_at(world, rng_below(rng, world_tri_count(world)), weight, corner, target);
    bool along = rng_below(rng, 6) == 0, from = rng_below(rng, 10) == 0;
    float stretch = (float)(1 + rng_below(rng, 3));
    double away = rng_below(rng, 4) ? 3 : 300;
    for (int k = 0; k < 3; k++) {
        double offset =
            whole_numbers ? (double)whole(rng, 8) : size * away * (double)rng_range(rng, -1, 1);
        ray->org[k] = float_of(from ? corner[0][k] : target[k] + offset);
        ray->dir[k] = float_of((double)stretch * (target[k] - (double)ray->org[k]));
        if (along) { /* an edge's direction, from a point of its plane */
            ray->org[k] = float_of(target[k] + (double)stretch * (corner[1][k] - corner[2][k]));
            ray->dir[k] = float_of(corner[1][k] - corner[0][k]);
        }
    }
    draw_range(rng, ray);
    for (int k = 0; k < 3 && rng_below(rng, 12) == 0; k++)
        ray->dir[k] = 0;
}

static void draw_instances(const struct world_turn *turn, struct rng *rng, struct world *world)
{
    for (uint32_t i = 0; i < world->instance_count; i++) {
        struct instance *at = &world->instance[i];
        at->mesh = rng_below(rng, 2);
        world_turn_draw(i < 2 || turn->whole ? turn : &world_turns[rng_below(rng, WORLD_TURNS)],
                        rng, at->m);
        draw_flags(rng, at);
    }
    /* The second is at the place of the first. */
    memcpy(world->instance[1].m, world->instance[0].m, sizeof world->instance[0].m);
    world->instance[1].mesh = rng_below(rng, 4) ? world->instance[0].mesh : 1;
    world->instance[2].mesh = WORLD_NO_MESH;
    set_identity(world->instance[3].m);
}

void world_case_make(const struct world_turn *turn, uint64_t seed, struct world_case *out)
{
    struct rng start = rng_make(seed, 7), rng = {rng_u64(&start)};
    struct reason reason = {""};
    struct world *world = &out->world;
    *world = (struct world){.mesh_count = 2, .instance_count = 5};
    world->mesh = calloc(world->mesh_count, sizeof *world->mesh);
    world->instance = calloc(world->instance_count, sizeof *world->instance);
    if (!world->mesh || !world->instance)
        abort();
    draw_mesh(&rng, turn->whole, &world->mesh[0]);
    draw_mesh(&rng, turn->whole || rng_below(&rng, 2), &world->mesh[1]);
    draw_instances(turn, &rng, world);
    world->filter.kind = (enum filter_kind)rng_below(&rng, 4);
    world->filter.seed = (uint32_t)rng_u64(&rng);
    world->filter.share = rng_below(&rng, 257);
    if (world_finish(world, &reason) || oracle_make_world(world, &out->oracle, &reason))
        abort();
    for (int i = 0; i < WORLD_RAYS; i++) {
        world_case_aim(world, turn->whole, &rng, &out->ray[i]);
        out->mode[i] = rng_below(&rng, 4) ? world_mode_draw(&rng) : ray_mode_all();
    }
}

void world_case_free(struct world_case *c)
{
    oracle_free(c->oracle);
    world_free(&c->world);
}
