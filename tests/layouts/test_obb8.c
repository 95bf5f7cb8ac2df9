/* Layout obb8: oriented boxes hold their triangles, by exact sums; no ray that meets a point of a
 * triangle misses one, and every ray that passes well beside one does. */
#include "ref/packed/packed_check.h"
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <float.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/records.h"

#define WORDS    36u
#define CHILDREN 8u

/* --- words ------------------------------------------------------------------------------------ */

static int axis_of(const uint32_t *word, uint32_t j, uint32_t k)
{
    uint32_t i = 3 * j + k, four = i < 8 ? bits(word, 352 + 4 * i, 4) : bits(word, 248, 4);
    return four < 8 ? (int)four : (int)four - 16;
}

/* The two parts of a plane; their sum is it. */
static void plane_of(const uint32_t *word, uint32_t j, uint32_t s, bool up, double part[2])
{
    uint32_t q = bits(word, 768 + 64 * (j + (up ? 3 : 0)) + 8 * s, 8);
    part[0] = (double)float_from_bits(word[8 + j]);
    part[1] = ldexp(q, (int)bits(word, 224 + 8 * j, 8) - 127);
}

/* --- exact sums ------------------------------------------------------------------------------- */

/* The sign of a sum of up to 8 doubles, exactly: a sum that is kept in parts that do not overlap. */
static int sign_of_sum(const double *x, uint32_t count)
{
    double part[8];
    int sign = 0;
    for (uint32_t n = 0; n < count; n++) {
        double q = x[n];
        for (uint32_t i = 0; i < n; i++) {
            double sum = q + part[i], b = sum - q;
            part[i] = (q - (sum - b)) + (part[i] - b);
            q = sum;
        }
        part[n] = q;
    }
    for (uint32_t i = 0; i < count; i++) /* the largest is the last that is not 0 */
        sign = part[i] != 0 ? (part[i] > 0 ? 1 : -1) : sign;
    return sign;
}

/* The sign of a point's place along an axis less a plane. */
static int side_of(const uint32_t *word, uint32_t j, uint32_t s, bool up, const float v[3],
                   double more)
{
    double part[2];
    plane_of(word, j, s, up, part);
    const double x[] = {axis_of(word, j, 0) * (double)v[0],
                        axis_of(word, j, 1) * (double)v[1],
                        axis_of(word, j, 2) * (double)v[2],
                        -part[0],
                        -part[1],
                        -more};
    return sign_of_sum(x, 6);
}

static void sums_are_exact(void **state)
{
    (void)state;
    const double a[] = {0x1p60, 1, -0x1p60, 0x1p-60, -1};
    assert_int_equal(sign_of_sum(a, 5), 1);
    const double b[] = {1, 0x1p-53, 0x1p-106, -1, -0x1p-53, -0x1p-105};
    assert_int_equal(sign_of_sum(b, 6), -1);
    const double c[] = {0x1p100, 3, -0x1p100, -3};
    assert_int_equal(sign_of_sum(c, 4), 0);
}

/* --- containment ------------------------------------------------------------------------------ */

/* What is met below the children of records. */
struct held {
    uint32_t oblique, points, tight, slots;
};

static void check_point(const uint32_t *word, uint32_t s, const float v[3], bool met[3][2],
                        struct held *held)
{
    for (uint32_t j = 0; j < 3; j++)
        for (int up = 0; up < 2; up++) {
            double step = ldexp(1, (int)bits(word, 224 + 8 * j, 8) - 127);
            int side = side_of(word, j, s, up, v, 0);
            if (up ? side > 0 : side < 0)
                fail_msg("slot %u, axis %u: %.9g %.9g %.9g lies outside", s, j, (double)v[0],
                         (double)v[1], (double)v[2]);
            side = side_of(word, j, s, up, v, up ? -1.01 * step : 1.01 * step);
            met[j][up] |= up ? side > 0 : side < 0; /* within a step, and a little for rounding */
            held->points++;
        }
}

/* All points below a child of a record. */
static void check_below(const struct packed *packed, const struct scene *scene, uint32_t ref,
                        const uint32_t *word, uint32_t s, bool met[3][2], struct held *held)
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++)
        check_below(packed, scene, node.child[c], word, s, met, held);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++) {
        float v[3][3];
        scene_tri(scene, packed_item(packed, &node, i), v);
        for (uint32_t c = 0; c < 3; c++)
            check_point(word, s, v[c], met, held);
    }
}

static void check_record(const struct packed *packed, const struct scene *scene, uint32_t record,
                         struct held *held)
{
    const uint32_t *word = packed->word + WORDS * (size_t)record;
    struct wide node;
    packed->layout->load(packed, record, &node);
    assert_true(bits(word, 120, 8) <= 1 && bits(word, 252, 4) == 0);
    if (!bits(word, 120, 8)) {
        for (uint32_t i = 24; i < WORDS; i++)
            assert_int_equal(word[i], 0);
        return;
    }
    held->oblique++;
    for (uint32_t j = 0; j < 3; j++) { /* at right angles, none is 0 */
        const uint32_t next = (j + 1) % 3;
        int dot = 0, square = 0;
        for (uint32_t k = 0; k < 3; k++) {
            dot += axis_of(word, j, k) * axis_of(word, next, k);
            square += axis_of(word, j, k) * axis_of(word, j, k);
        }
        assert_true(dot == 0 && square > 0);
    }
    for (uint32_t s = 0; s < node.child_count; s++) {
        bool met[3][2] = {{false}};
        check_below(packed, scene, node.child[s], word, s, met, held);
        for (uint32_t j = 0; j < 3; j++)
            held->tight += met[j][0] + met[j][1];
        held->slots |= 1u << s;
    }
}

/* Triangles about `centre`, each turned by any angle; `size` apart, `side` long and thin. */
static struct scene slivers(struct rng *rng, uint32_t count, float centre, float size, float side)
{
    struct scene scene = trees_grid(count);
    for (uint32_t i = 0; i < count; i++) {
        float at[3], along[3];
        for (int k = 0; k < 3; k++) {
            at[k] = centre + rng_range(rng, -size, size);
            along[k] = rng_range(rng, -side, side);
        }
        for (uint32_t c = 0; c < 3; c++)
            for (uint32_t k = 0; k < 3; k++)
                scene.vertex[9 * (size_t)i + 3 * c + k] =
                    at[k] + along[k] * (float)c + rng_range(rng, -side, side) * 0x1p-6f;
    }
    return scene;
}

static void check_scene(const struct scene *scene, uint32_t leaf, struct held *held)
{
    struct packed packed;
    pack(&packed, "obb8", scene, leaf);
    assert_int_equal(packed_check(&packed, scene, NULL, NULL), STATUS_OK);
    for (uint32_t r = 0; r < packed.node_count; r++)
        check_record(&packed, scene, r, held);
    packed_free(&packed);
}

static void oriented_boxes_hold_their_triangles(void **state)
{
    (void)state;
    static const float scale[] = {0x1p-140f, 0x1p-126f, 0x1p-60f, 1, 0x1p60f, 0x1p86f};
    struct rng rng = rng_make(1, 7);
    struct held held = {0};
    for (uint32_t round = 0; round < 240; round++) {
        const float size = scale[round % 6], centre = round / 6 % 4 == 0 ? 0 : size * 3;
        struct scene scene = slivers(&rng, 1 + round % 90, centre * (float)(round / 24 % 3 * 100),
                                     size, size * 0.3f);
        for (uint32_t i = 0; i < 9 * scene.tri_count && round % 5 == 0; i++)
            if (rng_below(&rng, 4) == 0) /* zeros of both signs, the least numbers */
                scene.vertex[i] = rng_below(&rng, 2) ? -0.0f : 0x1p-149f;
        for (uint32_t i = 0; i < scene.vertex_count && round % 7 == 0; i++)
            scene.vertex[3 * i + round % 3] = centre; /* flat */
        check_scene(&scene, 1 + round % 3, &held);
        scene_free(&scene);
    }
    assert_true(held.oblique > 500);
    assert_int_equal(held.slots, 255);
    /* Bounds lie within a step of a point. Steps are larger only far from the origin. */
    assert_true(held.tight > 6 * held.oblique);
}

/* A triangle that ends where it begins stands for the box of its vertices: all eight corners. */
static void a_line_stands_for_its_box(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 7);
    for (uint32_t round = 0; round < 200; round++) {
        struct packed packed;
        struct held held = {0};
        struct wide node;
        struct scene scene = slivers(&rng, 5, 0, 1, 1);
        for (uint32_t i = 0; i < scene.tri_count; i++)
            memcpy(scene.vertex + 9 * (size_t)i + 6, scene.vertex + 9 * (size_t)i, 12);
        for (uint32_t i = 0; i < 9 * 4; i++) /* the others are thin, so that there are axes */
            scene.vertex[i] = i % 9 < 6 ? scene.vertex[i] : scene.vertex[i - 3] + 0.01f;
        pack(&packed, "obb8", &scene, 1);
        packed.layout->load(&packed, 0, &node);
        for (uint32_t c = 0; c < node.child_count && bits(packed.word, 120, 8); c++) {
            float v[3][3];
            bool met[3][2];
            if (packed.item[node.leaf_first[c]] != 4)
                continue;
            scene_tri(&scene, 4, v);
            for (uint32_t corner = 0; corner < 8; corner++) {
                const float at[3] = {v[corner & 1][0], v[corner >> 1 & 1][1], v[corner >> 2][2]};
                check_point(packed.word, c, at, met, &held);
            }
        }
        assert_true(held.points == 48 || !bits(packed.word, 120, 8));
        packed_free(&packed);
        scene_free(&scene);
    }
}

/* Every component of a vertex at the largest magnitude that is taken. */
static void the_largest_numbers_are_held(void **state)
{
    (void)state;
    for (uint32_t signs = 0; signs < 512; signs++) {
        struct held held = {0};
        struct scene scene = trees_grid(2);
        for (uint32_t i = 0; i < 9; i++)
            scene.vertex[i] = signs >> i & 1 ? 0x1p96f : -0x1p96f;
        check_scene(&scene, 1, &held);
        scene_free(&scene);
    }
}

/* --- rays ------------------------------------------------------------------------------------- */

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

/* By how far, of the sizes that meet there, the ray passes an oriented box, or 0. In long double. */
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
        cmocka_unit_test(sums_are_exact),
        cmocka_unit_test(oriented_boxes_hold_their_triangles),
        cmocka_unit_test(a_line_stands_for_its_box),
        cmocka_unit_test(the_largest_numbers_are_held),
        cmocka_unit_test(no_ray_misses_what_it_meets),
        cmocka_unit_test(what_passes_well_beside_is_missed),
        cmocka_unit_test(what_is_beside_counts_as_met),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
