/* Rays through dual-split trees: nodes are entered exactly where slab_watertight accepts the boxes
 * that the planes imply, nothing that engine cpu finds on the boxes is lost, closed meshes stay
 * closed. */
#include "ref/dual/dual.h"
#include "ref/primitives/test_run.h"
#include "ref/trace/trace.h"
#include "ref/twin/twin.h"
#include "scenes/scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#include "tests/dual/dual_fixture.h"
#include "tests/support/adverse.h"
#include "tests/support/corridor.h"

#define ROOM 1200u /* hits of a ray: more than there are triangles in any scene here */

static uint32_t rays_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 100000 : 4000;
}

static struct job job_of(const struct dual_stand *s, enum query query, const char *tri)
{
    return (struct job){.scene = &s->scene,
                        .packed = &s->packed,
                        .box = box_test_find("watertight"),
                        .tri = tri_test_find(tri),
                        .query = query};
}

/* --- rays ------------------------------------------------------------------------------------- */

/* A place where planes are: each coordinate a bound of a node, or beside one, or of a vertex. */
static void place(const struct dual_stand *s, struct rng *rng, float at[3])
{
    uint32_t corner = rng_below(rng, 3 * s->scene.tri_count);
    const float *vertex = s->scene.vertex + 3 * (size_t)s->scene.index[corner];
    for (uint32_t k = 0; k < 3; k++) {
        const struct bvh_node *node = &s->bvh.node[rng_below(rng, s->bvh.node_count)];
        uint32_t kind = rng_below(rng, 4);
        at[k] = kind < 2 ? vertex[k] : dual_bound(&node->bounds, k + 3 * rng_below(rng, 2));
        if (kind == 3)
            at[k] = adverse_beside(rng, at[k]);
    }
}

/* From one such place to another, along axes and across them, within planes, with zeros of both
 * signs; or any bits at all. */
static struct ray draw(const struct dual_stand *s, struct rng *rng)
{
    struct ray ray = {.tmax = rng_below(rng, 3) ? INFINITY : rng_range(rng, 0, 2)};
    uint32_t kind = rng_below(rng, 8);
    float to[3];
    place(s, rng, ray.org);
    place(s, rng, to);
    for (uint32_t k = 0; k < 3; k++)
        ray.dir[k] = to[k] - ray.org[k];
    if (kind < 3) /* along an axis, or at right angles to one */
        for (uint32_t k = 0; k < 3; k++)
            if (kind == k || rng_below(rng, 2))
                ray.dir[k] = rng_below(rng, 2) ? 0.0f : -0.0f;
    if (kind == 3)
        adverse_direction(rng, 0x1p20f, ray.dir);
    if (kind == 4)
        for (uint32_t k = 0; k < 3; k++)
            ray.org[k] -= rng_range(rng, -8, 8) * ray.dir[k];
    if (kind == 5)
        ray.tmin = rng_range(rng, 0, 1);
    if (kind == 6)
        adverse_scale(ray.dir, -100 - (int)rng_below(rng, 40));
    if (kind == 7 && rng_below(rng, 4) == 0)
        for (uint32_t i = 0; i < 8; i++) {
            float any = float_from_bits((uint32_t)rng_u64(rng));
            if (rng_below(rng, 2))
                *(i < 3   ? &ray.org[i]
                  : i < 6 ? &ray.dir[i - 3]
                  : i < 7 ? &ray.tmin
                          : &ray.tmax) = any;
        }
    return ray;
}

/* --- where a ray goes ------------------------------------------------------------------------- */

struct dual_way {
    const struct dual_stand *stand;
    struct slab_ray ray;
    float tmax;
    uint64_t planes, tris;
};

/* Counts what a ray without a hit must do in the node, which the box test decides. */
static void go(struct dual_way *way, uint32_t at, const struct box *in)
{
    const struct dual_seen seen = dual_look(&way->stand->tree, at);
    float entry;
    if (!slab_watertight(&way->ray, in, way->tmax, &entry))
        return;
    if (seen.kind == DUAL_IS_LEAF) {
        way->tris += seen.count;
        return;
    }
    struct box first = dual_cut(*in, seen.side[0], seen.plane[0]),
               second = dual_cut(*in, seen.side[1], seen.plane[1]);
    way->planes += 2;
    if (seen.kind == DUAL_IS_CARVE) {
        first = dual_cut(first, seen.side[1], seen.plane[1]);
        go(way, seen.next, &first);
        return;
    }
    go(way, at + 3, &first);
    go(way, seen.next, &second);
}

static void nodes_are_entered_as_boxes_are(void **state)
{
    (void)state;
    for (size_t i = 0; i < 2 * DUAL_SCENES; i++) {
        struct dual_stand s = {.what = NULL};
        struct rng rng = rng_make(11, i);
        uint64_t tris = 0;
        dual_stand_make(&s, i / 2, i % 2 ? DUAL_ALL : DUAL_BY_COST);
        const struct job job = job_of(&s, QUERY_ALL, "woop");
        for (uint32_t n = 0; n < rays_each() / 4; n++) {
            const struct ray ray = draw(&s, &rng);
            struct trace_counts counts = {0, 0};
            struct hit hit;
            uint32_t found;
            struct dual_way way = {.stand = &s, .ray = slab_ray_make(&ray), .tmax = ray.tmax};
            slab_ray_place(&way.ray, &s.bvh.node[0].bounds);
            go(&way, 0, &s.bvh.node[0].bounds);
            dual_ray_all(&s.tree, &job, &ray, 1, &hit, &found, &counts);
            if (counts.boxes != 6 + way.planes || counts.tris != way.tris)
                fail_msg("%s, ray %u: %llu planes and %llu triangles, not %llu and %llu", s.what, n,
                         (unsigned long long)counts.boxes, (unsigned long long)counts.tris,
                         (unsigned long long)way.planes + 6, (unsigned long long)way.tris);
            tris += way.tris;
        }
        assert_true(tris > 0);
        dual_stand_free(&s);
    }
}

/* --- what is found ---------------------------------------------------------------------------- */

/* At most as far as t may be behind the nearest hit: by the bound of woop's t. */
static double farthest(const struct dual_stand *s, const struct ray *ray, const struct hit *hit)
{
    float v[3][3];
    scene_tri(&s->scene, hit->prim, v);
    const struct twin twin = twin_eval(TWIN_WOOP, ROUNDING_IEEE, ray, v);
    return (double)hit->t + twin.t_err;
}

/* Whether a hit is farther than another one by more than both bounds. */
static bool is_behind(const struct dual_stand *s, const struct ray *ray, const struct hit *hit,
                      const struct hit *nearest)
{
    const double doubt = farthest(s, ray, hit) - (double)hit->t;
    return hit->t > nearest->t && (double)hit->t - doubt > farthest(s, ray, nearest);
}

/* Every hit is accepted by the triangle test, with its bits. Returns the nearest one. */
static const struct hit *must_be_hits(const struct dual_stand *s, const struct ray *ray,
                                      uint32_t tri_id, const struct hit *list, uint32_t count)
{
    const struct tri_ray r = tri_ray_make(ray);
    const struct hit *nearest = list;
    assert_true(count <= s->scene.tri_count);
    for (uint32_t n = 0; n < count; n++) {
        float v[3][3];
        struct hit hit;
        scene_tri(&s->scene, list[n].prim, v);
        assert_true(tri_test_run(tri_id, &r, v, &hit));
        hit.prim = list[n].prim;
        assert_memory_equal(&hit, &list[n], sizeof hit);
        nearest = hit.t < nearest->t ? &list[n] : nearest;
    }
    return nearest;
}

static int by_prim(const void *a, const void *b)
{
    return order_numbers(((const struct hit *)a)->prim, ((const struct hit *)b)->prim);
}

/* The list has each of the hits of engine cpu on the boxes, which are in it or smaller. */
static void must_have_all(const struct dual_stand *s, uint32_t n, struct hit *list, uint32_t count,
                          const struct hit *cpu, uint32_t cpu_count)
{
    qsort(list, count, sizeof *list, by_prim);
    for (uint32_t i = 1; i < count; i++)
        assert_true(list[i - 1].prim < list[i].prim);
    for (uint32_t i = 0; i < cpu_count; i++)
        if (!bsearch(&cpu[i], list, count, sizeof *list, by_prim))
            fail_msg("%s, ray %u: triangle %u is not listed", s->what, n, cpu[i].prim);
}

/* And each that woop over all triangles finds, where it is certain that its t is in the range and
 * the scene is in contract (docs/numerics.md). */
static void must_have_brute(const struct dual_stand *s, uint32_t n, const struct ray *ray,
                            const struct hit *list, uint32_t count)
{
    static struct hit all[ROOM];
    uint32_t most = trace_brute_all(&s->scene, tri_test_find("woop"), ray, ROOM, all);
    for (uint32_t side = 0; side < 6; side++)
        if (!(fabsf(dual_bound(&s->tree.box, side)) <= 0x1p40f))
            return;
    for (uint32_t i = 0; i < most && ray_in_contract(ray); i++) {
        const double late = farthest(s, ray, &all[i]), t = (double)all[i].t;
        if (t - (late - t) > (double)ray->tmin && late < (double)ray->tmax &&
            !bsearch(&all[i], list, count, sizeof *list, by_prim))
            fail_msg("%s, ray %u: triangle %u is lost", s->what, n, all[i].prim);
    }
}

static void must_be_found(const struct dual_stand *s, const char *tri, const struct ray *ray,
                          uint32_t n, uint64_t *hits)
{
    static struct hit list[ROOM], cpu[ROOM];
    struct job job = job_of(s, QUERY_ALL, tri);
    struct hit closest, any;
    uint32_t count, cpu_count;
    dual_ray_all(&s->tree, &job, ray, ROOM, list, &count, NULL);
    assert_int_equal(trace_ray_all(&job, ray, ROOM, cpu, &cpu_count, NULL), STATUS_OK);
    const struct hit nearest = *must_be_hits(s, ray, job.tri->id, list, count);
    must_have_all(s, n, list, count, cpu, cpu_count);
    if (n % 16 == 0) /* woop */
        must_have_brute(s, n, ray, list, count);
    job.query = QUERY_CLOSEST;
    dual_ray(&s->tree, &job, ray, &closest, NULL);
    job.query = QUERY_ANY;
    dual_ray(&s->tree, &job, ray, &any, NULL);
    assert_int_equal(closest.prim != ABI_NO_PRIM, count > 0);
    assert_int_equal(any.prim != ABI_NO_PRIM, count > 0);
    if (count == 0)
        return;
    (void)must_be_hits(s, ray, job.tri->id, &any, 1);
    (void)must_be_hits(s, ray, job.tri->id, &closest, 1);
    if (job.tri->id == ABI_TRI_WOOP && ray_in_contract(ray) &&
        is_behind(s, ray, &closest, &nearest))
        fail_msg("%s, ray %u: the nearest is at %a, not at %a", s->what, n, (double)nearest.t,
                 (double)closest.t);
    *hits += count;
}

static void what_boxes_find_is_found(void **state)
{
    (void)state;
    static const char *const tri[] = {"woop", "mt", "pluecker", "baldwin_webber"};
    for (size_t i = 0; i < 2 * DUAL_SCENES; i++) {
        struct dual_stand s = {.what = NULL};
        struct rng rng = rng_make(12, i);
        uint64_t hits = 0;
        dual_stand_make(&s, i / 2, i % 2 ? DUAL_ALL : DUAL_BY_COST);
        for (uint32_t n = 0; n < rays_each(); n++) {
            const struct ray ray = draw(&s, &rng);
            must_be_found(&s, tri[n % 8 < 4 ? 0 : n % 8 - 4], &ray, n, &hits);
        }
        print_message("%-16s %8llu hits\n", s.what, (unsigned long long)hits);
        dual_stand_free(&s);
    }
}

/* Every ray starts inside of a closed box that is long and narrow, and woop hits that; where its t
 * is far enough from the range's end, so it does in the tree (tests/trace/test_watertight.c). */
static void long_corridors_do_not_leak(void **state)
{
    (void)state;
    for (int i = 0; i < 12; i++) {
        const int axis = i % 3;
        struct dual_stand s = {.what = "corridor"};
        struct rng rng = rng_make(7, (uint64_t)i);
        dual_stand_of(&s, corridor_scene(axis, i % 6 < 3 ? 100.0f : 1000.0f), "median",
                      i < 6 ? DUAL_BY_COST : DUAL_ALL);
        const struct job job = job_of(&s, QUERY_CLOSEST, "woop");
        uint32_t hits = 0;
        for (uint32_t n = 0; n < 5 * rays_each(); n++) {
            const uint32_t j = n % 6;
            const struct ray ray =
                corridor_ray(&rng, axis, j == 0 ? 0.0 : ldexp(1.0, 2 * (int)j - 23));
            struct hit all, hit;
            trace_brute(&s.scene, job.tri, QUERY_CLOSEST, &ray, &all);
            if (all.prim == ABI_NO_PRIM || all.t < 0.01f)
                continue;
            hits++;
            dual_ray(&s.tree, &job, &ray, &hit, NULL);
            assert_int_not_equal(hit.prim, ABI_NO_PRIM);
            assert_false(is_behind(&s, &ray, &hit, &all));
        }
        assert_true(hits > 4 * rays_each());
        dual_stand_free(&s);
    }
}

/* --- what it takes ---------------------------------------------------------------------------- */

/* Layers across the x axis: a ray along it, either way, is at its end after the first one. */
static void the_nearest_ends_the_ray(void **state)
{
    enum { LAYERS = 200 };
    (void)state;
    struct dual_stand s = {.what = "layers"};
    struct scene scene = trees_grid(LAYERS);
    for (size_t c = 0; c < 9 * (size_t)LAYERS; c++) {
        static const float corner[3][3] = {{0, -1, -1}, {0, 3, -1}, {0, -1, 3}};
        scene.vertex[c] = corner[c / 3 % 3][c % 3] + (c % 3 == 0 ? (float)(c / 9) : 0);
    }
    dual_stand_of(&s, scene, "median", DUAL_BY_COST);
    for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++)
        for (int i = 0; i < 2 * LAYERS; i++) {
            float way = i % 2 ? 1 : -1, from = (float)(i / 2) - 0.25f * way;
            struct ray ray = {
                .org = {from, 0.25f, 0.125f}, .dir = {way, 0.01f, -0.02f}, .tmax = INFINITY};
            const struct job job = job_of(&s, (enum query)query, "woop");
            struct trace_counts counts = {0, 0};
            struct hit hit;
            dual_ray(&s.tree, &job, &ray, &hit, &counts);
            if (query == QUERY_CLOSEST)
                assert_int_equal(hit.prim, i / 2);
            assert_in_range(counts.tris, 1, 6);
            assert_in_range(counts.boxes, 8, 6 + 6 * s.tree.depth);
        }
    dual_stand_free(&s);
}

struct dual_reads {
    const struct dual_tree *tree;
    uint64_t planes, leaves;
};

static void add_read(void *reader, uint32_t word, uint32_t words)
{
    struct dual_reads *reads = reader;
    const struct dual_seen seen = dual_look(reads->tree, word);
    assert_int_equal(words, seen.kind == DUAL_IS_LEAF ? 2 : 3);
    reads->leaves += seen.kind == DUAL_IS_LEAF;
    reads->planes += seen.kind == DUAL_IS_LEAF ? 0 : 2;
}

static void all_that_is_read_is_told(void **state)
{
    (void)state;
    struct dual_stand s = {.what = NULL};
    struct rng rng = rng_make(8, 0);
    uint64_t leaves = 0;
    dual_stand_make(&s, BUILT_SCENES + 3, DUAL_BY_COST);
    const struct job job = job_of(&s, QUERY_CLOSEST, "mt");
    for (uint32_t n = 0; n < rays_each(); n++) {
        const struct ray ray = draw(&s, &rng);
        struct dual_reads reads = {.tree = &s.tree};
        struct trace_counts counts = {0, 0};
        struct hit closest, watched;
        dual_ray(&s.tree, &job, &ray, &closest, &counts);
        watched = dual_watched(&s.tree, &job, &ray, add_read, &reads);
        assert_memory_equal(&watched, &closest, sizeof closest);
        assert_int_equal(6 + reads.planes, counts.boxes);
        leaves += reads.leaves;
    }
    assert_true(leaves > rays_each());
    dual_stand_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_that_is_read_is_told),
        cmocka_unit_test(the_nearest_ends_the_ray),
        cmocka_unit_test(long_corridors_do_not_leak),
        cmocka_unit_test(nodes_are_entered_as_boxes_are),
        cmocka_unit_test(what_boxes_find_is_found),
    };
    return cmocka_run_group_tests_name("dual_rays", tests, NULL, NULL);
}
