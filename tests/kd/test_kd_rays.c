/* Rays through k-d trees, held to every triangle: what the exact ray meets and the test accepts is
 * found, what is found is accepted with the same bits, and nothing twice. */
#include "ref/engine.h"
#include "ref/kd/kd.h"
#include "ref/oracle/oracle.h"
#include "scenes/scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/resource.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/kd/kd_fixture.h"

#define RAYS 1500u

struct kd_stand {
    const char *what;
    struct scene scene;
    struct kd_tree tree;
    struct oracle *oracle;
    void *engine;      /* kd, prepared for lists */
    struct hit *every; /* of one ray, of every triangle; prim: ABI_NO_PRIM if not accepted */
    bool *surely;      /* and the exact ray hits it in its range */
    double *t_hi;      /* at most so far */
    uint64_t met;
};

static void stand_of(struct kd_stand *s, struct scene scene)
{
    const struct engine_options options = {.threads = 1, .device = -1};
    const struct engine *kd = engine_find("kd");
    s->scene = scene;
    s->tree = kd_tree_of(&s->scene, s->what);
    const struct job job = {.scene = &s->scene, .query = QUERY_ALL};
    assert_int_equal(oracle_make(&s->scene, &s->oracle, NULL), STATUS_OK);
    assert_int_equal(engine_open(kd, &options, &s->engine, NULL), STATUS_OK);
    assert_int_equal(kd->prepare(s->engine, &job, NULL), STATUS_OK);
    s->every = calloc(s->scene.tri_count, sizeof *s->every);
    s->surely = calloc(s->scene.tri_count, sizeof *s->surely);
    s->t_hi = calloc(s->scene.tri_count, sizeof *s->t_hi);
    assert_true(s->every && s->surely && s->t_hi);
}

static void stand_make(struct kd_stand *s, size_t i)
{
    struct scene scene = kd_scene(i, &s->what);
    stand_of(s, scene);
}

static void stand_free(struct kd_stand *s)
{
    engine_find("kd")->close(s->engine);
    oracle_free(s->oracle);
    kd_free(&s->tree);
    scene_free(&s->scene);
    free(s->every);
    free(s->surely);
    free(s->t_hi);
}

/* --- rays ------------------------------------------------------------------------------------- */

/* A plane of the tree that a walk by chance comes to, of that axis; else one of the scene's box. */
static float plane_of(const struct kd_tree *tree, struct rng *rng, uint32_t axis)
{
    for (uint32_t tries = 0; tries < 20; tries++) {
        const struct kd_node *node = &tree->node[rng_below(rng, tree->node_count)];
        if ((node->what & 3u) == axis)
            return node->at;
    }
    return rng_below(rng, 2) ? tree->box.lo[axis] : tree->box.hi[axis];
}

/* A place on a triangle: a vertex, on an edge or inside, or its nearest planes in one axis or two.
 */
static void aim_at(const struct kd_stand *s, struct rng *rng, float at[3])
{
    float v[3][3];
    uint32_t kind = rng_below(rng, 5), corner = rng_below(rng, 3);
    float a = rng_float(rng), b = kind == 1 ? 0 : (1 - a) * rng_float(rng);
    scene_tri(&s->scene, rng_below(rng, s->scene.tri_count), v);
    for (int k = 0; k < 3; k++) {
        const float *p = v[corner], *q = v[(corner + 1) % 3], *r = v[(corner + 2) % 3];
        at[k] = kind == 0 ? p[k] : p[k] + a * (q[k] - p[k]) + b * (r[k] - p[k]);
        if (kind >= 3 && rng_below(rng, 2))
            at[k] = plane_of(&s->tree, rng, (uint32_t)k);
    }
}

static struct ray draw(const struct kd_stand *s, struct rng *rng)
{
    struct ray ray = {.tmax = INFINITY};
    float at[3], size = 0;
    uint32_t kind = rng_below(rng, 8);
    aim_at(s, rng, at);
    for (int k = 0; k < 3; k++)
        size = fmaxf(size, 0.5f * s->tree.box.hi[k] - 0.5f * s->tree.box.lo[k]);
    for (int k = 0; k < 3; k++) {
        float way = size * rng_range(rng, -2, 2);
        if (kind < 3 && kind != (uint32_t)k) /* along an axis */
            way = 0;
        if (kind == 3 && k == (int)rng_below(rng, 3)) /* at right angles to one */
            way = 0;
        ray.org[k] = at[k] - way;
        ray.dir[k] = kind == 4 ? way : at[k] - ray.org[k];
    }
    if (kind == 5)
        ray.tmax = rng_range(rng, 0.5f, 1.5f);
    if (kind == 6)
        ray.tmin = rng_range(rng, 0.5f, 1.0f);
    return ray;
}

/* --- one ray ---------------------------------------------------------------------------------- */

/* Tests every triangle. Returns how many are surely to be found. */
static uint32_t test_all(struct kd_stand *s, const struct ray *ray)
{
    uint32_t sure = 0;
    for (uint32_t prim = 0; prim < s->scene.tri_count; prim++) {
        struct oracle_pair pair;
        s->surely[prim] = false;
        if (!tri_accel_hit(&s->tree.tri[prim], ray->org, ray->dir, ray->tmin, ray->tmax,
                           &s->every[prim])) {
            s->every[prim].prim = ABI_NO_PRIM;
            continue;
        }
        oracle_pair(s->oracle, ray, prim, &pair);
        s->surely[prim] =
            oracle_is_hit(&pair) && oracle_in_range(&pair, ORACLE_CLOSED) && pair.t_lo > 0x1p-100;
        s->t_hi[prim] = pair.t_hi;
        sure += s->surely[prim];
    }
    s->met += sure;
    return sure;
}

static void must_be_accepted(const struct kd_stand *s, const struct hit *hit, uint32_t i)
{
    if (hit->prim == ABI_NO_PRIM)
        return;
    assert_true(hit->prim < s->scene.tri_count);
    if (memcmp(hit, &s->every[hit->prim], sizeof *hit) != 0)
        fail_msg("%s, ray %u: triangle %u was not accepted so", s->what, i, hit->prim);
}

/* No answer is behind what it was to find, neither its exact place nor the computed one. */
static void must_be_nearest(const struct kd_stand *s, const struct hit *hit, uint32_t i)
{
    for (uint32_t prim = 0; prim < s->scene.tri_count; prim++) {
        if (!s->surely[prim])
            continue;
        double t = fmax((double)s->every[prim].t, s->t_hi[prim]);
        if (hit->prim == ABI_NO_PRIM || (double)hit->t > t)
            fail_msg("%s, ray %u: triangle %u at %a is lost, answer %d at %a", s->what, i, prim, t,
                     (int)hit->prim, (double)hit->t);
    }
}

static void must_be_listed(struct kd_stand *s, const struct ray *ray, uint32_t i)
{
    enum { ROOM = 1100 };
    static struct hit list[ROOM];
    uint32_t count = 0, fewer = 0;
    const struct engine *kd = engine_find("kd");
    assert_int_equal(kd->trace_all(s->engine, ray, 1, ROOM, list, &count, NULL), STATUS_OK);
    assert_true(count <= s->scene.tri_count);
    for (uint32_t n = 0; n < count; n++) {
        must_be_accepted(s, &list[n], i);
        if (s->every[list[n].prim].prim == ABI_NO_PRIM)
            fail_msg("%s, ray %u: triangle %u is listed twice", s->what, i, list[n].prim);
        s->every[list[n].prim].prim = ABI_NO_PRIM; /* taken */
        s->surely[list[n].prim] = false;
    }
    for (uint32_t prim = 0; prim < s->scene.tri_count; prim++)
        if (s->surely[prim])
            fail_msg("%s, ray %u: triangle %u is not listed", s->what, i, prim);
    assert_int_equal(kd->trace_all(s->engine, ray, 1, 1, list, &fewer, NULL), STATUS_OK);
    assert_int_equal(fewer, count);
}

static void what_is_met_is_found(void **state)
{
    (void)state;
    for (size_t i = 0; i < KD_SCENES; i++) {
        struct kd_stand s = {.what = NULL};
        struct rng rng = rng_make(7, i);
        stand_make(&s, i);
        for (uint32_t n = 0; n < RAYS; n++) {
            struct kd_counts counts = {0};
            struct ray ray = draw(&s, &rng);
            if (!ray_in_contract(&ray))
                continue;
            uint32_t sure = test_all(&s, &ray);
            struct hit closest = kd_closest(&s.tree, &ray, &counts),
                       any = kd_any(&s.tree, &ray, &counts);
            must_be_accepted(&s, &closest, n);
            must_be_accepted(&s, &any, n);
            must_be_nearest(&s, &closest, n);
            assert_true(sure == 0 || any.prim != ABI_NO_PRIM);
            must_be_listed(&s, &ray, n);
        }
        print_message("%-16s %7llu hits that must be found\n", s.what, (unsigned long long)s.met);
        stand_free(&s);
    }
}

/* --- corners of voxels ------------------------------------------------------------------------ */

struct kd_corners {
    struct kd_stand *stand;
    struct rng rng;
    uint64_t sure;
};

/* Rays at a corner of a voxel, where three planes are equally far: what is hit there is
 * found, whatever voxels the ray comes by. */
static void aim_at_corner(void *user, const struct kd_node *leaf, const struct box *voxel,
                          uint32_t depth)
{
    struct kd_corners *c = user;
    struct kd_stand *s = c->stand;
    (void)depth;
    for (uint32_t corner = 0; corner < 8 && leaf->what >> 2; corner++) {
        struct ray ray = {.tmax = INFINITY};
        struct kd_counts counts = {0};
        for (uint32_t k = 0; k < 3; k++) {
            float at = corner >> k & 1 ? voxel->hi[k] : voxel->lo[k];
            ray.org[k] = at + rng_range(&c->rng, -3, 3);
            ray.dir[k] = at - ray.org[k];
        }
        c->sure += test_all(s, &ray) > 0;
        struct hit closest = kd_closest(&s->tree, &ray, &counts);
        must_be_accepted(s, &closest, corner);
        must_be_nearest(s, &closest, corner);
    }
}

/* Of needles, which planes cut, and of a grid, at whose vertices planes meet. */
static void corners_of_voxels_are_no_holes(void **state)
{
    (void)state;
    for (uint64_t seed = 0; seed < 6; seed++) {
        struct kd_stand s = {.what = "corners"};
        struct scene scene;
        assert_int_equal(
            scene_open(seed % 2 ? "needles:n=200" : "grid:n=12,offset=7", seed, &scene, NULL),
            STATUS_OK);
        stand_of(&s, scene);
        struct kd_corners c = {.stand = &s, .rng = rng_make(seed, 4)};
        kd_each_leaf(&s.tree, 0, s.tree.box, 0, aim_at_corner, &c);
        print_message("%5u nodes, %6llu rays must hit\n", s.tree.node_count,
                      (unsigned long long)c.sure);
        assert_true(c.sure > 50);
        stand_free(&s);
    }
}

/* Layers across the x axis: a ray along it, either way, is at its end after the first one. */
static void the_nearest_ends_the_ray(void **state)
{
    enum { LAYERS = 200 };
    (void)state;
    struct scene scene = trees_grid(LAYERS);
    for (size_t c = 0; c < 9 * (size_t)LAYERS; c++) {
        static const float corner[3][3] = {{0, -1, -1}, {0, 3, -1}, {0, -1, 3}};
        scene.vertex[c] = corner[c / 3 % 3][c % 3] + (c % 3 == 0 ? (float)(c / 9) : 0);
    }
    struct kd_tree tree = kd_tree_of(&scene, "layers");
    for (int i = 0; i < 2 * LAYERS; i++) {
        float way = i % 2 ? 1 : -1, from = (float)(i / 2) - 0.25f * way;
        struct ray ray = {
            .org = {from, 0.25f, 0.125f}, .dir = {way, 0.01f, -0.02f}, .tmax = INFINITY};
        struct kd_counts counts = {0};
        struct hit hit = kd_closest(&tree, &ray, &counts);
        assert_int_equal(hit.prim, i / 2);
        assert_float_equal(hit.t, 0.25f, 1e-4);
        assert_in_range(counts.tris, 1, 4);
        assert_in_range(counts.planes, 1, 2 * tree.depth);
    }
    kd_free(&tree);
    scene_free(&scene);
}

/* --- what is read ----------------------------------------------------------------------------- */

static void add_read(void *counts, enum kd_read array, ptrdiff_t number, size_t bytes)
{
    static const size_t size[] = {8, 4, 48};
    assert_int_equal(bytes, size[array]);
    assert_true(number >= 0);
    ((uint64_t *)counts)[array]++;
}

static void all_that_is_read_is_told(void **state)
{
    (void)state;
    struct kd_stand s = {.what = NULL};
    struct rng rng = rng_make(8, 0);
    stand_make(&s, KD_SCENES - 2);
    for (uint32_t n = 0; n < RAYS; n++) {
        uint64_t reads[3] = {0};
        struct kd_counts counts = {0};
        struct ray ray = draw(&s, &rng);
        struct hit closest = kd_closest(&s.tree, &ray, &counts);
        struct hit watched = kd_watched(&s.tree, &ray, add_read, reads);
        assert_memory_equal(&watched, &closest, sizeof closest);
        assert_int_equal(reads[KD_READ_NODE], counts.planes + counts.leaves);
        assert_int_equal(reads[KD_READ_ITEM], counts.tris);
        assert_int_equal(reads[KD_READ_TRI], counts.tris);
    }
    stand_free(&s);
}

/* Refused, and by its name: 10^8 triangles take 19 GB, of a process that may have 4. */
static void what_takes_too_much_memory_is_refused(void **state)
{
    (void)state;
    struct rlimit old, few = {.rlim_cur = (rlim_t)4 << 30};
    struct scene scene = {.tri_count = 100000000};
    struct kd_tree tree;
    struct reason reason = {""};
    assert_int_equal(getrlimit(RLIMIT_AS, &old), 0);
    few.rlim_max = old.rlim_max;
    if (setrlimit(RLIMIT_AS, &few))
        skip();
    enum status status = kd_make(&scene, &tree, &reason);
    assert_int_equal(setrlimit(RLIMIT_AS, &old), 0);
    assert_int_equal(status, STATUS_MEMORY);
    assert_non_null(
        strstr(reason.text, "a k-d tree of 100000000 triangles takes at least 19.0 GB"));
    assert_true(!tree.node && !tree.item && !tree.tri);
    scene.tri_count = KD_TRIS_MOST + 1;
    assert_int_equal(kd_make(&scene, &tree, &reason), STATUS_LIMIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_that_is_read_is_told),
        cmocka_unit_test(what_takes_too_much_memory_is_refused),
        cmocka_unit_test(the_nearest_ends_the_ray),
        cmocka_unit_test(corners_of_voxels_are_no_holes),
        cmocka_unit_test(what_is_met_is_found),
    };
    return cmocka_run_group_tests_name("kd_rays", tests, NULL, NULL);
}
