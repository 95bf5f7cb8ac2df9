/* Layout obb8: each node has the rotation whose boxes save most of its children's areas, or none
 * where no rotation does; by areas that are computed from the triangles below each child. */
#include "ref/layouts/oblique.h"
#include "ref/store.h"
#include "tests/support/tree_fixture.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/layouts/obb8_words.h"

/* Along the three axes of each rotation, in units of their lengths. */
struct wide_spans {
    double lo[TILTS][3], hi[TILTS][3];
};

static void add_below(const struct packed *packed, const struct scene *scene, uint32_t ref,
                      struct wide_spans *out)
{
    struct wide node;
    packed->layout->load(packed, ref, &node);
    for (uint32_t c = 0; c < node.child_count; c++)
        add_below(packed, scene, node.child[c], out);
    for (uint32_t i = 0; i < (node.child_count ? 0 : node.item_count); i++) {
        float v[3][3];
        scene_tri(scene, packed_item(packed, &node, i), v);
        for (uint32_t n = 0; n < TILTS * 9; n++) {
            const int8_t *a = tilts[n / 9][n / 3 % 3];
            const double length = sqrt((double)(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]));
            double at = 0;
            for (int k = 0; k < 3; k++)
                at += (double)a[k] / length * (double)v[n % 3][k];
            out->lo[n / 9][n / 3 % 3] = fmin(out->lo[n / 9][n / 3 % 3], at);
            out->hi[n / 9][n / 3 % 3] = fmax(out->hi[n / 9][n / 3 % 3], at);
        }
    }
}

static double area_of(const double e[3])
{
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* Where there are no axes there is no oriented box, nor is there one below a leaf; bounds along
 * axes are in order. */
static void check_boxes(const struct packed *packed, uint32_t record, bool any)
{
    const struct oblique_ray ray = {{3, 4, 5}, {1, -2, 3}, 0, 0};
    struct wide node, leaf;
    packed->layout->load(packed, record, &node);
    for (uint32_t c = 0; c < node.child_count; c++) {
        struct oblique_box box;
        const uint32_t child = node.child[c];
        assert_int_equal(packed->layout->oblique(packed, record, child, &ray, &box), any);
        for (int j = 0; j < 3 && any; j++)
            assert_true(box.lo[j] <= box.hi[j] && box.step[j] > 0 && box.beside[j] > 0);
        packed->layout->load(packed, child, &leaf);
        if (leaf.child_count == 0)
            assert_false(packed->layout->oblique(packed, child, record, &ray, &box));
        assert_true(any || !packed->layout->misses(packed, record, child, &ray, 0));
    }
    struct oblique_box none; /* of no child */
    assert_false(packed->layout->oblique(packed, record, record, &ray, &none));
}

/* What each rotation saves of the areas of a record's children. */
static void find_savings(const struct packed *packed, const struct scene *scene, uint32_t record,
                         double saved[TILTS])
{
    struct wide node;
    memset(saved, 0, TILTS * sizeof *saved);
    packed->layout->load(packed, record, &node);
    for (uint32_t c = 0; c < node.child_count; c++) {
        struct wide_spans spans;
        double e[3];
        for (uint32_t n = 0; n < 3 * TILTS; n++) {
            spans.lo[n / 3][n % 3] = INFINITY;
            spans.hi[n / 3][n % 3] = -INFINITY;
        }
        add_below(packed, scene, node.child[c], &spans);
        for (int k = 0; k < 3; k++)
            e[k] = (double)node.box[c].hi[k] - (double)node.box[c].lo[k];
        const double box = area_of(e);
        for (uint32_t t = 0; t < TILTS; t++) {
            for (int k = 0; k < 3; k++)
                e[k] = spans.hi[t][k] - spans.lo[t][k];
            saved[t] += fmax(0, box - area_of(e));
        }
    }
}

/* The rotation that a record has; TILTS: none. */
static uint32_t tilt_of(const uint32_t *word)
{
    for (uint32_t t = 0; t < TILTS && bits(word, 120, 8); t++) {
        bool same = true;
        for (uint32_t i = 0; i < 9; i++)
            same = same && axis_of(word, i / 3, i % 3) == tilts[t][i / 3][i % 3];
        if (same)
            return t;
    }
    assert_int_equal(bits(word, 120, 8), 0);
    return TILTS;
}

static void each_node_has_the_rotation_that_saves_most(void **state)
{
    (void)state;
    static const int corner[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0},
                                     {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    struct rng rng = rng_make(13, 7);
    uint32_t chosen[TILTS + 1] = {0};
    for (uint32_t round = 0; round < 300; round++) {
        const bool square = round % 8 == 0; /* along axes: no rotation is smaller */
        struct scene scene = slivers(&rng, square ? 2 : 1 + round % 40, 0, 3, 1);
        for (uint32_t i = 0; i < 18 && square; i++)
            scene.vertex[i] = (float)(corner[i / 3][(i + round / 8) % 3] << round % 5);
        struct packed packed;
        pack(&packed, "obb8", &scene, square ? 2 : 1 + round % 3);
        for (uint32_t r = 0; r < packed.node_count; r++) {
            double saved[TILTS], most = 0;
            const uint32_t is = tilt_of(packed.word + WORDS * (size_t)r);
            check_boxes(&packed, r, is < TILTS);
            find_savings(&packed, &scene, r, saved);
            for (uint32_t t = 0; t < TILTS; t++)
                most = fmax(most, saved[t]);
            const double has = is < TILTS ? saved[is] : 0;
            if (has < most * (1 - 1e-6) - 1e-6)
                fail_msg("record %u: rotation %u saves %g, another %g", r, is, has, most);
            assert_true(is == TILTS || most > 0);
            chosen[is]++;
        }
        packed_free(&packed);
        scene_free(&scene);
    }
    for (uint32_t t = 0; t <= TILTS; t++)
        assert_true(chosen[t] > 0);
}

/* From 2^-100 on, of both signs, a ray meets the planes of an axis; below it is along them, and at
 * all distances or at none. */
static void rays_are_along_planes_below_2_to_minus_100(void **state)
{
    (void)state;
    static const float dirs[] = {0x1p-100f, 0x1.fffffep-101f, 0, 0x1.000002p-100f, 1};
    struct rng rng = rng_make(17, 7);
    uint32_t along = 0, across = 0;
    for (uint32_t round = 0; round < 40; round++) {
        struct scene scene = slivers(&rng, 6, 0, 3, 1);
        struct packed packed;
        struct wide node;
        pack(&packed, "obb8", &scene, 1);
        packed.layout->load(&packed, packed.root, &node);
        for (uint32_t n = 0; n < 5 * 2 * 3 && bits(packed.word, 120, 8); n++) {
            struct oblique_ray ray = {{0, 0, 0}, {0, 0, 0}, 0, 0};
            struct oblique_box box;
            ray.dir[n % 3] = dirs[n / 6] * (n / 3 % 2 ? -1 : 1);
            ray.org[0] = n % 2 ? 1e4f : 0; /* outside, or among them */
            assert_true(packed.layout->oblique(&packed, packed.root, node.child[0], &ray, &box));
            for (int j = 0; j < 3; j++) {
                const float dir = (float)box.axis[j][n % 3] * ray.dir[n % 3];
                const float org = (float)box.axis[j][0] * ray.org[0];
                const bool parallel = fabsf(dir) < 0x1p-100f;
                const bool inside =
                    org >= box.lo[j] - box.beside[j] && org <= box.hi[j] + box.beside[j];
                if (parallel) {
                    assert_true(box.enter[j] == (inside ? -INFINITY : INFINITY));
                    assert_true(box.leave[j] == -box.enter[j]);
                } else {
                    assert_true(isfinite(box.enter[j]) && isfinite(box.leave[j]));
                }
                *(parallel ? &along : &across) += 1;
            }
        }
        packed_free(&packed);
        scene_free(&scene);
    }
    assert_true(along > 200 && across > 200);
}

static int gcd(int a, int b)
{
    return b ? gcd(b, a % b) : abs(a);
}

/* Each is a rotation, none of them twice; axes have no common divisor, so that their places are as
 * small as they can be, and fit in four bits. */
static void rotations_are_those_of_small_numbers(void **state)
{
    (void)state;
    for (uint32_t t = 0; t < TILTS; t++) {
        const tilt_axes *m = &tilts[t];
        int det = 0, size = 1;
        for (int j = 0; j < 3; j++) {
            const int8_t *a = (*m)[j], *b = (*m)[(j + 1) % 3];
            assert_int_equal(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], 0);
            assert_int_equal(gcd(gcd(a[0], a[1]), a[2]), 1);
            size *= a[0] * a[0] + a[1] * a[1] + a[2] * a[2];
            det += (*m)[0][j] * ((*m)[1][(j + 1) % 3] * (*m)[2][(j + 2) % 3] -
                                 (*m)[1][(j + 2) % 3] * (*m)[2][(j + 1) % 3]);
            for (int k = 0; k < 3; k++)
                assert_in_range(a[k] + 8, 0, 15);
        }
        assert_true(det > 0 && det * det == size);
        for (uint32_t other = 0; other < t; other++)
            assert_memory_not_equal(tilts[t], tilts[other], sizeof tilts[t]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rotations_are_those_of_small_numbers),
        cmocka_unit_test(rays_are_along_planes_below_2_to_minus_100),
        cmocka_unit_test(each_node_has_the_rotation_that_saves_most),
    };
    return cmocka_run_group_tests_name("obb8_choice", tests, NULL, NULL);
}
