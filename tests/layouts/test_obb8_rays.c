/* Layout obb8: no ray that meets a point of a triangle misses its oriented box, and every ray that
 * passes well beside one does. */
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/obb8_words.h"

#define CHILDREN 8u

/* Whether the ray misses a child of the record on the way to a leaf with the triangle. */
static bool misses_above(const struct packed *packed, uint32_t record, uint32_t prim,
                         const struct oblique_ray *ray, float tmax, bool *found)
{
    struct wide node;
    packed->layout->load(packed, record, &node);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++)
        *found |= packed_item(packed, &node, i) == prim;
    for (uint32_t c = 0; c < node.child_count && !*found; c++) {
        bool missed = misses_above(packed, node.child[c], prim, ray, tmax, found);
        if (*found)
            return missed || packed->layout->misses(packed, record, node.child[c], ray, tmax);
    }
    return false;
}

/* Rays of whole numbers through points of triangles that are whole numbers, all exact. */
static void no_ray_misses_what_it_meets(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 7);
    static const float scale[] = {1, 0x1p-90f, 0x1p78f};
    for (uint32_t round = 0; round < 60; round++) {
        const float unit = scale[round % 3];
        struct scene scene = slivers(&rng, 40, (float)(round % 4) * 3000, 900, 300);
        for (uint32_t i = 0; i < 9 * scene.tri_count; i++)
            scene.vertex[i] = 8 * rintf(scene.vertex[i]) * unit;
        struct packed packed;
        pack(&packed, "obb8", &scene, 2);
        for (uint32_t n = 0; n < 2000; n++) {
            struct oblique_ray ray = {.by = 0};
            const uint32_t prim = rng_below(&rng, scene.tri_count), b = rng_below(&rng, 9),
                           c = rng_below(&rng, 9 - b), far = 1u << rng_below(&rng, 10);
            float v[3][3];
            bool found = false;
            scene_tri(&scene, prim, v);
            for (uint32_t k = 0; k < 3;
                 k++) { /* a point by eighths, and `far` directions before it */
                float p =
                    ((float)(8 - b - c) * v[0][k] + (float)b * v[1][k] + (float)c * v[2][k]) / 8;
                ray.dir[k] = (float)((int)rng_below(&rng, 41) - 20) * (n % 5 == k ? 0 : 1);
                ray.org[k] = p - (float)far * (ray.dir[k] * unit);
            }
            /* Directions of ordinary size: distances have the unit. */
            float t = (float)far * unit;
            ray.least = n % 2 ? t : 0;
            assert_false(misses_above(&packed, packed.root, prim, &ray, t, &found));
            assert_true(found);
        }
        packed_free(&packed);
        scene_free(&scene);
    }
}

/* Rays along a face of an oriented box, through its vertices, so far from 0 that places along axes
 * are rounded by as much as the steps of their planes. In every octant, and most often where all
 * coordinates are below 0: what is far is so to both sides. */
static void rays_along_faces_meet_them(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 7);
    for (uint32_t round = 0; round < 120; round++) {
        struct scene scene = slivers(&rng, 8, 0, 60, 60);
        const float far_away = (float)((5 + round % 3) << 20);
        const uint32_t below = round % 2 ? 7 : round / 2;
        for (uint32_t i = 0; i < 9 * scene.tri_count; i++)
            scene.vertex[i] = rintf(scene.vertex[i]) + (below >> i % 3 & 1 ? -far_away : far_away);
        struct packed packed;
        pack(&packed, "obb8", &scene, 1);
        const uint32_t *word = packed.word + WORDS * (size_t)packed.root;
        for (uint32_t n = 0; n < 8 * 3 * 3 * 8 && bits(word, 120, 8); n++) {
            const uint32_t prim = n % 8, c = n / 8 % 3, j = n / 24 % 3, far = 1u << n / 72;
            struct oblique_ray ray = {.by = 0};
            float v[3][3];
            bool found = false;
            scene_tri(&scene, prim, v);
            for (uint32_t k = 0; k < 3; k++) {
                ray.dir[k] = (float)axis_of(word, j, k);
                ray.org[k] = v[c][k] - (float)far * ray.dir[k];
            }
            assert_false(misses_above(&packed, packed.root, prim, &ray, (float)far, &found));
            assert_true(found);
        }
        packed_free(&packed);
        scene_free(&scene);
    }
}

/* By how far, of the sizes that meet there, the ray passes an oriented box. In long double. */
static long double apart(const uint32_t *word, uint32_t s, const struct oblique_ray *ray,
                         long double tmax)
{
    long double near = ray->least, far = tmax, beside = 0;
    for (uint32_t j = 0; j < 3; j++) {
        double lo[2], hi[2];
        long double o = 0, d = 0, size = 0;
        plane_of(word, j, s, false, lo);
        plane_of(word, j, s, true, hi);
        for (uint32_t k = 0; k < 3; k++) {
            o += (long double)axis_of(word, j, k) * ray->org[k];
            d += (long double)axis_of(word, j, k) * ray->dir[k];
            size += abs(axis_of(word, j, k)) * (fabsl((long double)ray->org[k]) + 8);
        }
        long double a = (long double)lo[0] + lo[1] - o, b = (long double)hi[0] + hi[1] - o;
        a -= size * 0x1p-12L + (long double)ray->by * 21; /* 21: the largest sum of components */
        b += size * 0x1p-12L + (long double)ray->by * 21;
        if (d == 0) {
            beside = a > 0 || b < 0 ? 1 : beside;
            continue;
        }
        near = fmaxl(near, fminl(a / d, b / d));
        far = fminl(far, fmaxl(a / d, b / d));
    }
    return beside > 0 ? beside : near - fabsl(near) * 0x1p-12L - far - fabsl(far) * 0x1p-12L;
}

/* Of random rays: what passes well beside a child is missed, in every slot, of nodes and leaves. */
static void what_passes_well_beside_is_missed(void **state)
{
    (void)state;
    struct rng rng = rng_make(5, 7);
    uint32_t missed[2][CHILDREN] = {{0}}, let = 0;
    for (uint32_t round = 0; round < 40; round++) {
        struct scene scene = slivers(&rng, 200, 0, 2, 1);
        struct packed packed;
        pack(&packed, "obb8", &scene, 1 + round % 3);
        for (uint32_t n = 0; n < 300; n++) {
            struct oblique_ray ray = {.by = n % 3 ? 0 : rng_range(&rng, 0, 0.1f)};
            const float tmax = n % 2 ? INFINITY : rng_range(&rng, 0, 3);
            for (int k = 0; k < 3; k++) {
                ray.org[k] = rng_range(&rng, -6, 6);
                ray.dir[k] = n % 7 == 0 && k > 0 ? 0 : rng_range(&rng, -1, 1);
            }
            ray.least = n % 4 ? 0 : rng_range(&rng, -1, 3);
            uint32_t r = rng_below(&rng, packed.node_count);
            const uint32_t *word = packed.word + WORDS * (size_t)r;
            struct wide node;
            packed.layout->load(&packed, r, &node);
            for (uint32_t s = 0; s < node.child_count; s++) {
                bool is = packed.layout->misses(&packed, r, node.child[s], &ray, tmax);
                if (!bits(word, 120, 8)) {
                    assert_false(is);
                    continue;
                }
                bool well = apart(word, s, &ray, (long double)tmax) > 0;
                if (well && !is)
                    fail_msg("record %u, slot %u: not missed", r, s);
                missed[node.leaf_count[s] > 0][s] += is;
                let += !is;
            }
        }
        packed_free(&packed);
        scene_free(&scene);
    }
    for (uint32_t s = 0; s < CHILDREN; s++)
        assert_true(missed[0][s] > 0 && missed[1][s] > 0);
    assert_true(let > 1000);
}

/* A ray `by` beside a box is not missed, and a little farther it is. */
static void what_is_beside_counts_as_met(void **state)
{
    (void)state;
    struct scene scene = trees_grid(1);
    static const float v[9] = {0, 0, 0, 1, 1, 0, 0.5f, 0.5f, 0.01f}; /* along a diagonal */
    memcpy(scene.vertex, v, sizeof v);
    struct packed packed;
    struct wide node;
    pack(&packed, "obb8", &scene, 1);
    packed.layout->load(&packed, 0, &node);
    assert_int_equal(bits(packed.word, 120, 8), 1);
    for (uint32_t i = 1; i < 100; i++) {
        /* Down z, beside the diagonal by off / sqrt(2). */
        float off = (float)i * 0.004f;
        struct oblique_ray ray = {{0.5f + off, 0.5f, 5}, {0, 0, -1}, 0, 0};
        assert_true(packed.layout->misses(&packed, 0, node.child[0], &ray, INFINITY));
        ray.by = off;
        assert_false(packed.layout->misses(&packed, 0, node.child[0], &ray, INFINITY));
        ray.by = off * 0.45f; /* as much along x and along y */
        assert_true(packed.layout->misses(&packed, 0, node.child[0], &ray, INFINITY));
    }
    packed_free(&packed);
    scene_free(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_ray_misses_what_it_meets),
        cmocka_unit_test(rays_along_faces_meet_them),
        cmocka_unit_test(what_passes_well_beside_is_missed),
        cmocka_unit_test(what_is_beside_counts_as_met),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
