#include "tests/judge/honest_world.h"

#include "tests/exact/legal_operations.h"
#include "tests/exact/placed_trials.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- worlds ----------------------------------------------------------------------------------- */

#define RINGS  3
#define AROUND 4

/* A closed mesh like a globe, of unit size. */
static struct scene *make_globe(void)
{
    struct scene *scene = calloc(1, sizeof *scene);
    const uint32_t corners = 2 + RINGS * AROUND, tris = 2 * RINGS * AROUND;
    uint32_t n = 0;
    if (!scene || scene_make(corners, tris, scene))
        abort();
    for (uint32_t i = 0; i < RINGS * AROUND; i++) {
        double down = 3.14159 * (i / AROUND + 1) / (RINGS + 1);
        double turn = 6.28318 * (i % AROUND) / AROUND + 0.3;
        float *p = scene->vertex + 3 * (size_t)i;
        p[0] = (float)(sin(down) * cos(turn));
        p[1] = (float)(sin(down) * sin(turn));
        p[2] = (float)cos(down);
    }
    memcpy(scene->vertex + 3 * (corners - 2), (float[]){0, 0, 1, 0, 0, -1}, 6 * sizeof(float));
    for (uint32_t a = 0; a < AROUND; a++) {
        uint32_t b = (a + 1) % AROUND, last = (RINGS - 1) * AROUND;
        const uint32_t caps[6] = {corners - 2, a, b, corners - 1, last + b, last + a};
        memcpy(scene->index + 3 * (size_t)n, caps, sizeof caps);
        n += 2;
        for (uint32_t r = 0; r + 1 < RINGS; r++) {
            uint32_t i = r * AROUND, j = i + AROUND;
            const uint32_t quad[6] = {i + a, j + a, j + b, i + a, j + b, i + b};
            memcpy(scene->index + 3 * (size_t)n, quad, sizeof quad);
            n += 2;
        }
    }
    return scene;
}

#define SOUP 6

static struct scene *make_soup(struct rng *rng)
{
    struct scene *scene = calloc(1, sizeof *scene);
    if (!scene || scene_make(3 * SOUP, SOUP, scene))
        abort();
    for (uint32_t i = 0; i < 9 * SOUP; i++)
        scene->vertex[i] = rng_range(rng, -1, 1);
    for (uint32_t i = 0; i < 3 * SOUP; i++)
        scene->index[i] = i;
    memcpy(scene->vertex + 9, scene->vertex, 6 * sizeof(float)); /* two that share an edge */
    return scene;
}

static void split(struct rng *rng, struct scene *scene, struct world_mesh *out)
{
    uint32_t first = rng_below(rng, scene->tri_count);
    *out = (struct world_mesh){scene, calloc(2, sizeof *out->geometry), 2};
    if (!out->geometry)
        abort();
    out->geometry[0] = (struct geometry){0, first, rng_below(rng, 2)};
    out->geometry[1] = (struct geometry){first, scene->tri_count - first, rng_below(rng, 2)};
}

static void draw_instance(struct rng *rng, struct instance *out)
{
    static const uint32_t opacity[] = {0, 0, 0, ABI_INSTANCE_FORCE_OPAQUE,
                                       ABI_INSTANCE_FORCE_NO_OPAQUE};
    int kind;
    do
        kind = (int)rng_below(rng, PLACED_KINDS);
    while (strcmp(placed_kind(kind), "at_ends") == 0);
    placed_transform(kind, rng, out);
    out->mesh = rng_below(rng, 2);
    out->custom = rng_below(rng, 3) ? rng_below(rng, ABI_CUSTOM_MOST) : rng_below(rng, 2);
    out->mask = rng_below(rng, 2) ? 0xFF : rng_below(rng, 256);
    out->flags = opacity[rng_below(rng, 5)];
    out->flags |= rng_below(rng, 4) ? 0 : ABI_INSTANCE_CULL_DISABLE;
    out->flags |= rng_below(rng, 3) ? 0 : ABI_INSTANCE_FLIP_FACING;
}

void judged_world_of(struct world world, struct judged_world *out)
{
    struct reason reason = {""};
    *out = (struct judged_world){.world = world};
    out->place = calloc(world.instance_count, sizeof *out->place);
    if (!out->place)
        abort();
    for (uint32_t i = 0; i < world.instance_count; i++)
        if (world.instance[i].mesh != WORLD_NO_MESH &&
            twin_place_of(&world.instance[i], &out->place[i], &reason))
            abort();
    if (oracle_make_world(&out->world, &out->oracle, &reason))
        abort();
}

void judged_world_make(uint64_t seed, struct judged_world *out)
{
    struct rng rng = rng_make(seed, 99);
    struct reason reason = {""};
    struct world world = {.mesh_count = 2, .instance_count = 5};
    world.mesh = calloc(world.mesh_count, sizeof *world.mesh);
    world.instance = calloc(world.instance_count, sizeof *world.instance);
    if (!world.mesh || !world.instance)
        abort();
    split(&rng, make_globe(), &world.mesh[0]);
    split(&rng, make_soup(&rng), &world.mesh[1]);
    for (uint32_t i = 0; i < world.instance_count; i++)
        draw_instance(&rng, &world.instance[i]);
    if (rng_below(&rng, 2)) /* the third is where the second is */
        memcpy(world.instance[2].m, world.instance[1].m, sizeof world.instance[2].m);
    if (rng_below(&rng, 4) == 0)
        world.instance[3].mesh = WORLD_NO_MESH;
    world.filter.kind = (enum filter_kind)rng_below(&rng, 4);
    world.filter.seed = (uint32_t)rng_u64(&rng);
    world.filter.share = rng_below(&rng, 257);
    if (world_finish(&world, &reason))
        abort();
    judged_world_of(world, out);
}

void judged_world_free(struct judged_world *w)
{
    oracle_free(w->oracle);
    world_free(&w->world);
    free(w->place);
}

/* --- rays ------------------------------------------------------------------------------------- */

/* The corners in the world. */
static void corners_of(const struct world *world, uint32_t prim, double out[3][3])
{
    struct place place = world_place(world, prim);
    const struct instance *at = &world->instance[place.instance];
    float v[3][3];
    scene_tri(world->mesh[place.mesh].scene, place.prim, v);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            out[c][k] = (double)at->m[k][3];
            for (int j = 0; j < 3; j++)
                out[c][k] += (double)at->m[k][j] * (double)v[c][j];
        }
}

/* The inside, an edge, a vertex, a point beside an edge, or one where cells of a filter meet. */
static void draw_weights(struct rng *rng, double w[3])
{
    uint32_t kind = rng_below(rng, 5), first = rng_below(rng, 3);
    double a = (double)rng_float(rng), b = (double)rng_float(rng) * (1 - a);
    double beside = ldexp(1, -10 - (int)rng_below(rng, 16));
    double u = 0.25 * (1 + rng_below(rng, 3)), v = rng_below(rng, 2) ? 0.25 : a * (1 - u);
    const double parts[4][3] = {
        {a, b, 1 - a - b}, {a, 1 - a, 0}, {1, 0, 0}, {a, 1 - a - beside, beside}};
    for (uint32_t c = 0; c < 3 && kind < 4; c++)
        w[(c + first) % 3] = parts[kind][c];
    if (kind == 4) {
        w[0] = 1 - u - v;
        w[1] = u;
        w[2] = v;
    }
}

struct ray judged_world_aim(const struct judged_world *w, struct rng *rng)
{
    double v[3][3], weight[3], size = 0;
    corners_of(&w->world, rng_below(rng, world_tri_count(&w->world)), v);
    draw_weights(rng, weight);
    for (int k = 0; k < 3; k++)
        for (int c = 1; c < 3; c++)
            size = fmax(size, fabs(v[c][k] - v[0][k]));
    int power = rng_below(rng, 3) ? (int)rng_below(rng, 3) : (int)rng_below(rng, 20);
    double away = ldexp(size, power);
    float stretch = rng_below(rng, 2) ? 1 : rng_range(rng, 0.1f, 10);
    struct ray ray = {.tmin = 0, .tmax = INFINITY};
    for (int k = 0; k < 3; k++) {
        double target = weight[0] * v[0][k] + weight[1] * v[1][k] + weight[2] * v[2][k];
        ray.org[k] = (float)(target + away * (double)rng_range(rng, -1, 1));
        ray.dir[k] = (float)((double)stretch * (target - (double)ray.org[k]));
    }
    if (rng_below(rng, 8) == 0)
        ray.tmax = 1 / stretch;
    if (rng_below(rng, 8) == 0)
        ray.tmin = 0.5f / stretch;
    return ray;
}

struct ray_mode judged_world_mode(struct rng *rng)
{
    static const uint32_t opacity[] = {
        0, 0, 0, ABI_RAY_OPAQUE, ABI_RAY_NO_OPAQUE, ABI_RAY_CULL_OPAQUE, ABI_RAY_CULL_NO_OPAQUE};
    static const uint32_t facing[] = {0, ABI_RAY_CULL_BACK, ABI_RAY_CULL_FRONT};
    struct ray_mode mode = ray_mode_all();
    if (rng_below(rng, 2))
        return mode;
    if (rng_below(rng, 3) == 0)
        mode.mask = rng_below(rng, 256);
    mode.flags = opacity[rng_below(rng, 7)];
    mode.flags |= rng_below(rng, 40) ? facing[rng_below(rng, 3)] : ABI_RAY_SKIP_TRIANGLES;
    mode.flags |= rng_below(rng, 8) ? 0 : ABI_RAY_FIRST;
    return mode;
}

struct oracle_answer judged_world_truth(const struct judged_world *w, const struct ray *ray,
                                        struct ray_mode mode)
{
    struct oracle_answer truth;
    struct reason reason = {""};
    if (oracle_closest_world(w->oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, &mode, 1, 1, &truth, NULL,
                             &reason))
        abort();
    return truth;
}

/* --- the tracer ------------------------------------------------------------------------------- */

static struct ray take_along(const struct judged_world *w, struct legal *legal, uint32_t instance,
                             const struct ray *ray)
{
    const struct twin_place *place = &w->place[instance];
    struct ray out = legal_transform(legal, place, ray);
    for (int k = 0; k < 3 && w->affine && !place->identity; k++) {
        const float *row = place->w + 3 * k;
        out.org[k] =
            legal_sub(legal, legal_dot(legal, row, ray->org), legal_dot(legal, row, place->t));
    }
    return out;
}

/* d . ((v1 - v0) x (v2 - v0)) < 0 is the front. */
static bool sees_front(struct legal *legal, const float d[3], float v[3][3], uint32_t flags)
{
    float e1[3], e2[3], n[3];
    legal_subtract(legal, v[1], v[0], e1);
    legal_subtract(legal, v[2], v[0], e2);
    legal_cross(legal, e1, e2, n);
    bool against = legal_dot(legal, d, n) < 0;
    return against != ((flags & ABI_INSTANCE_FLIP_FACING) != 0);
}

/* A candidate and whether it counts. */
static bool candidate(const struct judged_world *w, enum twin_formula formula, struct legal *legal,
                      uint32_t prim, const struct ray *placed, struct ray_mode mode,
                      struct hit *hit, uint32_t *tag)
{
    const struct world *world = &w->world;
    struct place place = world_place(world, prim);
    const struct instance *at = &world->instance[place.instance];
    float v[3][3];
    scene_tri(world->mesh[place.mesh].scene, place.prim, v);
    struct evaluation e = legal_evaluate(legal, formula, placed, v);
    if (!e.accepted)
        return false;
    bool opaque =
        world_is_opaque(at, world->mesh[place.mesh].geometry[place.geometry].opaque, mode);
    bool front = sees_front(legal, placed->dir, v, at->flags);
    *hit = (struct hit){e.t, e.u, e.v, prim};
    *tag = at->custom | (front ? ABI_TAG_FRONT : 0);
    return !world_culls(at, opaque, front, mode) &&
           (opaque || filter_passes(&world->filter, &place, e.u, e.v));
}

void honest_world_trace(const struct judged_world *w, enum twin_formula formula,
                        struct legal *legal, const struct ray *ray, struct ray_mode mode,
                        enum query query, struct hit *hit, uint32_t *tag)
{
    const struct world *world = &w->world;
    bool first = query == QUERY_ANY || (mode.flags & ABI_RAY_FIRST);
    *hit = (struct hit){.prim = ABI_NO_PRIM};
    *tag = 0;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        if (!world_meets(&world->instance[i], mode))
            continue;
        struct ray placed = take_along(w, legal, i, ray);
        for (uint32_t p = world->first[i]; p < world->first[i + 1]; p++) {
            struct hit one;
            uint32_t seen;
            if (first && hit->prim != ABI_NO_PRIM)
                return;
            if (candidate(w, formula, legal, p, &placed, mode, &one, &seen) &&
                (hit->prim == ABI_NO_PRIM || one.t < hit->t)) {
                *hit = one;
                *tag = seen;
            }
        }
    }
}

size_t honest_world_list(const struct judged_world *w, enum twin_formula formula,
                         struct legal *legal, const struct ray *ray, struct ray_mode mode,
                         struct hit hit[WORLD_MOST_HITS], uint32_t tag[WORLD_MOST_HITS])
{
    const struct world *world = &w->world;
    size_t count = 0;
    for (uint32_t i = 0; i < world->instance_count; i++) {
        if (!world_meets(&world->instance[i], mode))
            continue;
        struct ray placed = take_along(w, legal, i, ray);
        for (uint32_t p = world->first[i]; p < world->first[i + 1]; p++) {
            struct hit one;
            uint32_t seen;
            if (!candidate(w, formula, legal, p, &placed, mode, &one, &seen))
                continue;
            size_t at = count;
            if (count == WORLD_MOST_HITS)
                abort();
            for (; at > 0 && hit[at - 1].t > one.t; at--) {
                hit[at] = hit[at - 1];
                tag[at] = tag[at - 1];
            }
            hit[at] = one;
            tag[at] = seen;
            count++;
        }
    }
    return count;
}
