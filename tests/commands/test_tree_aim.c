/* The parts of raydiff tree --aim that need no driver. Rays meet a triangle beyond the bound, and
 * each such triangle is drawn. Enlarged worlds keep their triangles. Lost rays are counted. */
#include "cmd/tree/cmd_tree_aim.h"
#include "scenes/worlds.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* --- rays ------------------------------------------------------------------------------------- */

#define SPIKES 6u
#define DRAWS  300u

/* Triangles apart in every coordinate: each reaches from -0.5 to 1 along its own diagonal. */
static void make_mesh(struct scene *out)
{
    assert_int_equal(scene_make(3 * SPIKES, SPIKES, out), STATUS_OK);
    for (uint32_t i = 0; i < SPIKES; i++)
        for (uint32_t c = 0; c < 3; c++) {
            float *v = out->vertex + 9 * (size_t)i + 3 * (size_t)c;
            for (uint32_t k = 0; k < 3; k++)
                v[k] = 16 * (float)((i * (k + 1)) % (SPIKES + 1)) + (c == k ? 1.0f : -0.5f);
            out->index[3 * i + c] = 3 * i + c;
        }
}

/* Of how much each corner a point is made in the plane of two coordinates. Returns whether it is in
 * the triangle but for roundings. */
static bool weights_of(double v[3][3], unsigned k, unsigned i, double x, double y, double out[3])
{
    const double det =
        (v[1][k] - v[0][k]) * (v[2][i] - v[0][i]) - (v[2][k] - v[0][k]) * (v[1][i] - v[0][i]);
    out[1] = ((x - v[0][k]) * (v[2][i] - v[0][i]) - (v[2][k] - v[0][k]) * (y - v[0][i])) / det;
    out[2] = ((v[1][k] - v[0][k]) * (y - v[0][i]) - (x - v[0][k]) * (v[1][i] - v[0][i])) / det;
    out[0] = 1 - out[1] - out[2];
    return fmin(out[0], fmin(out[1], out[2])) > -1e-4;
}

/* What the rays of a goal reached. */
struct reached {
    uint32_t rays[SPIKES]; /* of each triangle */
    double most[3];        /* weight of each corner, where the whole triangle is beyond */
    uint32_t way[3][2];
};

static void look_at(const struct tree_dump *dump, const struct dump_side *goal,
                    const struct ray *ray, struct reached *out)
{
    const struct dump_instance *instance = &dump->instance[goal->item];
    const unsigned k = goal->side % 3;
    unsigned j = 0, met = 0;
    while (ray->dir[j] == 0)
        j++;
    const unsigned i = 3 - k - j;
    const size_t other = (j + 1) % 3, third = (j + 2) % 3;
    assert_true(j != k && fabsf(ray->dir[j]) == 1 && ray->dir[other] == 0 && ray->dir[third] == 0);
    assert_true(ray->tmin == 0 && isinf(ray->tmax));
    assert_true(goal->side < 3 ? ray->org[k] < goal->bound : ray->org[k] > goal->bound);
    for (uint32_t t = 0; t < SPIKES; t++) {
        double v[3][3], weight[3];
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++) {
                const float *p = dump->below[0].scene.vertex + 9 * (size_t)t + 3 * c;
                const float *row = instance->m[a];
                v[c][a] = (double)row[3];
                for (int b = 0; b < 3; b++)
                    v[c][a] += (double)row[b] * (double)p[b];
            }
        if (!weights_of(v, k, i, (double)ray->org[k], (double)ray->org[i], weight))
            continue;
        double at = 0;
        for (int c = 0; c < 3; c++)
            at += weight[c] * v[c][j];
        if ((at - (double)ray->org[j]) * (double)ray->dir[j] < 0.5)
            continue; /* behind the origin */
        met++;
        out->rays[t]++;
        for (int c = 0; c < 3; c++)
            out->most[c] = fmax(out->most[c], weight[c]);
    }
    assert_true(met > 0);
    out->way[j][ray->dir[j] < 0]++;
}

/* The bound of a side, beyond which is a part of what the mesh has along its axis. */
static struct dump_side goal_of(const struct tree_dump *dump, uint32_t item, unsigned side,
                                float part)
{
    const struct box box = scene_tri_bounds(&dump->scene, item);
    const float lo = box.lo[side % 3], hi = box.hi[side % 3];
    return (struct dump_side){item, side, side < 3 ? lo + part * (hi - lo) : hi - part * (hi - lo)};
}

static void aim_at(const struct tree_dump *dump, uint32_t item, unsigned side, struct rng *rng)
{
    struct ray ray;
    const struct dump_side some = goal_of(dump, item, side, 0.01f),
                           all = goal_of(dump, item, side, 1.01f),
                           none = goal_of(dump, item, side, -0.01f);
    struct reached reached = {0};
    assert_false(tree_aim_ray(dump, &none, rng, &ray));
    for (uint32_t n = 0; n < DRAWS; n++) {
        assert_true(tree_aim_ray(dump, &some, rng, &ray));
        look_at(dump, &some, &ray, &reached);
    }
    memset(&reached, 0, sizeof reached);
    for (uint32_t n = 0; n < DRAWS; n++) {
        assert_true(tree_aim_ray(dump, &all, rng, &ray));
        look_at(dump, &all, &ray, &reached);
    }
    for (uint32_t t = 0; t < SPIKES; t++)
        assert_true(reached.rays[t] > DRAWS / SPIKES / 4);
    for (unsigned c = 0; c < 3; c++) {
        assert_true(reached.most[c] > 0.8);
        for (int way = 0; way < 2; way++)
            assert_int_equal(reached.way[c][way] > DRAWS / 8, c != side % 3);
    }
}

static void rays_meet_what_is_beyond_the_bound(void **state)
{
    (void)state;
    struct tree_dump dump = {.tri_known = true, .tri_count = 8, .below_count = 1};
    struct rng rng = rng_make(3, 0);
    dump.instance = calloc(dump.tri_count, sizeof *dump.instance);
    dump.below = calloc(1, sizeof *dump.below);
    assert_true(dump.instance && dump.below);
    make_mesh(&dump.below[0].scene);
    for (uint32_t i = 0; i < dump.tri_count; i++)
        for (int j = 0; j < 12; j++)
            dump.instance[i].m[j / 4][j % 4] =
                (j % 5 == 0 ? 1 + rng_float(&rng) : rng_float(&rng) / 4 - 0.125f) +
                (j % 4 == 3 ? 200 * rng_float(&rng) - 100 : 0);
    assert_int_equal(dump_place(&dump, NULL), STATUS_OK);
    for (uint32_t i = 0; i < dump.tri_count; i++)
        for (unsigned side = 0; side < 6; side++)
            aim_at(&dump, i, side, &rng);
    tree_dump_free(&dump);
}

/* --- larger worlds ---------------------------------------------------------------------------- */

/* The first triangles are the same to the bit, the two behind them are points, and the box is
 * larger by what the header tells. */
static void must_be_enlarged(const struct world_mesh *mesh, const struct world_mesh *before)
{
    const struct scene *a = before->scene, *b = mesh->scene;
    const struct box small = scene_bounds(a), large = scene_bounds(b);
    if (a->tri_count == 0) {
        assert_int_equal(b->tri_count + mesh->geometry[0].count, 0);
        return;
    }
    assert_int_equal(b->tri_count, a->tri_count + 2);
    assert_memory_equal(a->index, b->index, 12 * (size_t)a->tri_count);
    assert_memory_equal(a->vertex, b->vertex, 12 * (size_t)a->vertex_count);
    for (uint32_t t = a->tri_count; t < b->tri_count; t++) {
        const struct box point = scene_tri_bounds(b, t);
        for (int k = 0; k < 3; k++)
            assert_true(point.lo[k] == point.hi[k]);
    }
    for (int k = 0; k < 3; k++) {
        const float by = 0.25f * (small.hi[k] - small.lo[k]) + 0x1p-10f * fabsf(small.hi[k]);
        assert_true(large.lo[k] == fmaxf(small.lo[k] - by, -FLT_MAX));
        assert_true(large.hi[k] == fminf(small.hi[k] + by, FLT_MAX));
    }
    assert_int_equal(mesh->geometry_count, before->geometry_count);
    for (uint32_t g = 0; g < mesh->geometry_count; g++)
        assert_int_equal(mesh->geometry[g].count,
                         before->geometry[g].count + (g + 1 == mesh->geometry_count ? 2 : 0));
}

/* Makes the numbers of the meshes as large as float32 has them. */
static void to_the_ends(struct world *world)
{
    for (uint32_t m = 0; m < world->mesh_count; m++) {
        const struct scene *mesh = world->mesh[m].scene;
        float most = 0;
        for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
            most = fmaxf(most, fabsf(mesh->vertex[i]));
        for (size_t i = 0; i < 3 * (size_t)mesh->vertex_count; i++)
            mesh->vertex[i] = (float)((double)mesh->vertex[i] / (double)most * (double)FLT_MAX);
    }
}

static void larger_worlds_keep_their_triangles(void **state)
{
    (void)state;
    static const char *const spec[] = {"crowd:n=30", "mixed", "twins", "nest", "room", "soup:n=9"};
    for (size_t s = 0; s < 2 * ARRAY_COUNT(spec); s++) {
        struct world world, before;
        struct reason reason = {""};
        assert_int_equal(world_open(spec[s / 2], 1, &world, &reason), STATUS_OK);
        assert_int_equal(world_open(spec[s / 2], 1, &before, &reason), STATUS_OK);
        if (s % 2) {
            to_the_ends(&world);
            to_the_ends(&before);
        }
        if (tree_aim_enlarge(&world, &reason))
            fail_msg("%s: %s", spec[s / 2], reason.text);
        assert_int_equal(world.mesh_count, before.mesh_count);
        for (uint32_t m = 0; m < world.mesh_count; m++)
            must_be_enlarged(&world.mesh[m], &before.mesh[m]);
        /* Numbers of triangles move on by two an instance. */
        for (uint32_t i = 0; i < world.instance_count; i++)
            assert_true(world.first[i] >= before.first[i] &&
                        world.first[i] <= before.first[i] + 2 * i);
        world_free(&world);
        world_free(&before);
    }
}

/* --- counts ----------------------------------------------------------------------------------- */

#define RAYS  400u
#define ITEMS 3u

static void losses_are_counted_of_what_was_hit(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 50; seed++) {
        static uint32_t answer[3][RAYS];
        static struct ray ray[RAYS];
        static struct dump_side goal[RAYS];
        struct dump_instance instance[ITEMS] = {{.number = 2}, {.number = 0}, {.number = 1}};
        const struct tree_dump dump = {.instance = instance};
        const struct tree_told told = {.dump = &dump};
        const uint32_t rays = (uint32_t)(seed * seed) % RAYS;
        const struct aiming aiming = {&told, goal, ray, rays};
        struct rng rng = rng_make(seed, 0);
        struct tree_aimed out = {.done = true, .tries = rays};
        uint32_t aimed = 0, lost = 0, found = 0, first = 0;
        for (uint32_t i = 0; i < rays; i++) {
            goal[i] = (struct dump_side){rng_below(&rng, ITEMS), rng_below(&rng, 6), 0};
            ray[i].org[0] = (float)i;
            for (int a = 0; a < 3; a++)
                answer[a][i] = rng_below(&rng, ITEMS + 1);
            const uint32_t want = (goal[i].item + 2) % ITEMS;
            const bool hit = answer[0][i] == want, missed = hit && answer[1][i] != want;
            const bool again = missed && answer[2][i] == want;
            first = again && found == 0 ? i : first;
            aimed += hit;
            lost += missed;
            found += again;
        }
        tree_aim_count(&aiming, answer[0], answer[1], answer[2], &out);
        assert_true(out.tries == rays && out.aimed == aimed && out.lost == lost);
        assert_int_equal(out.found, found);
        if (found) {
            assert_true(out.ray.org[0] == (float)first && out.side == goal[first].side);
            assert_int_equal(out.instance, (goal[first].item + 2) % ITEMS);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_what_is_beyond_the_bound),
        cmocka_unit_test(larger_worlds_keep_their_triangles),
        cmocka_unit_test(losses_are_counted_of_what_was_hit),
    };
    return cmocka_run_group_tests_name("tree_aim", tests, NULL, NULL) ? 1 : 0;
}
