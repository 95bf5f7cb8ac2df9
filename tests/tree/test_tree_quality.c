/* Numbers of trees: cost by hand, end-point overlap by hand and by points on the triangles. */
#include "ref/tree/tree_quality.h"
#include "tests/support/built.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

static double overlap_of(const struct bvh *bvh, const struct scene *scene, uint32_t most)
{
    double overlap = -1;
    assert_int_equal(tree_overlap(bvh, scene, most, &overlap), STATUS_OK);
    return overlap;
}

/* Triangles with the right angle at (a, a) and two corners at 1, in one leaf each. All of the
 * second is in the first one's box; of the first the part with x and y above 1/4, whose legs are
 * 1/2. */
static void overlap_by_hand(void **state)
{
    (void)state;
    static const float at[] = {0, 0.25f};
    struct scene scene = trees_grid(2);
    for (uint32_t i = 0; i < 18; i++) {
        bool far = i % 9 == 3 || i % 9 == 7;
        scene.vertex[i] = i % 3 == 2 ? 0 : far ? 1 : at[i / 9];
    }
    struct bvh bvh = trees_make(&scene, 1, TREES_BALANCED);
    double first = 0.5, second = 0.75 * 0.75 / 2, part = 0.5 * 0.5 / 2;
    assert_true(fabs(overlap_of(&bvh, &scene, 0) - (second + part) / (first + second)) < 1e-12);
    bvh_free(&bvh);
    bvh = trees_make(&scene, 2, TREES_BALANCED);
    assert_true(overlap_of(&bvh, &scene, 0) == 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Cost of the nodes whose boxes contain a point, but not its triangle. */
static double cost_at(const struct bvh *bvh, uint32_t prim, const double p[3])
{
    double cost = 0;
    for (uint32_t i = 0; i < bvh->node_count; i++) {
        const struct bvh_node *node = &bvh->node[i];
        bool inside = true, own = false;
        for (int k = 0; k < 3; k++)
            inside =
                inside && p[k] >= (double)node->bounds.lo[k] && p[k] <= (double)node->bounds.hi[k];
        if (!inside)
            continue;
        uint32_t last = i;
        while (bvh->node[last].item_count == 0)
            last = bvh->node[last].snd;
        uint32_t end = bvh->node[last].item_first + bvh->node[last].item_count;
        for (uint32_t item = node->item_first; item < end; item++)
            own = own || bvh->prim[item] == prim;
        cost += own ? 0 : node->item_count ? node->item_count : 1;
    }
    return cost;
}

static void overlap_is_what_points_on_the_triangles_meet(void **state)
{
    (void)state;
    struct scene scene = built_soup(60, 4);
    for (size_t c = 540; c-- > 0;) /* closer together */
        scene.vertex[c] -= 0.9f * scene.vertex[c / 9 * 9 + c % 3];
    struct bvh bvh;
    const struct build_options options = {.leaf = 3};
    assert_int_equal(builder_find("lbvh")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    double sum = 0, area = 0;
    const int steps = 40;
    for (uint32_t i = 0; i < scene.tri_count; i++) {
        double e[2][3], n = 0, met = 0;
        const float *v = scene.vertex + 9 * (size_t)i;
        for (int c = 0; c < 6; c++)
            e[c / 3][c % 3] = (double)v[3 + c] - (double)v[c % 3];
        for (int k = 0; k < 3; k++) {
            double x =
                e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
            n += x * x;
        }
        for (int a = 0; a < steps; a++)
            for (int b = 0; b < steps; b++) {
                double s = (a + 0.5) / steps, t = (b + 0.5) / steps, p[3];
                bool fold = s + t > 1;
                for (int k = 0; k < 3; k++)
                    p[k] =
                        (double)v[k] + (fold ? 1 - s : s) * e[0][k] + (fold ? 1 - t : t) * e[1][k];
                met += cost_at(&bvh, i, p);
            }
        sum += met / (steps * steps) * sqrt(n) / 2;
        area += sqrt(n) / 2;
    }
    double overlap = overlap_of(&bvh, &scene, 0);
    assert_true(overlap > 0.1);
    assert_true(fabs(overlap - sum / area) < 0.01 * overlap);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void an_estimate_is_near_and_scale_changes_nothing(void **state)
{
    (void)state;
    struct scene scene = built_soup(4000, 5);
    struct bvh bvh;
    const struct build_options options = {.leaf = 4};
    assert_int_equal(builder_find("median")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    double all = overlap_of(&bvh, &scene, 0), sah = tree_sah(&bvh);
    assert_true(fabs(overlap_of(&bvh, &scene, 1500) - all) < 0.2 * all);
    assert_true(overlap_of(&bvh, &scene, 4000) == all);
    bvh_free(&bvh);
    for (size_t c = 0; c < (size_t)9 * 4000; c++)
        scene.vertex[c] *= 0x1p100f; /* areas of 2^200 */
    assert_int_equal(builder_find("median")->build(&scene, &options, &bvh, NULL), STATUS_OK);
    assert_true(overlap_of(&bvh, &scene, 0) == all && tree_sah(&bvh) == sah);
    bvh_free(&bvh);
    scene_free(&scene);
}

static void trees_without_area_have_no_cost(void **state)
{
    (void)state;
    struct scene scene;
    struct bvh bvh = {0};
    assert_int_equal(scene_make(0, 0, &scene), STATUS_OK);
    assert_true(tree_sah(&bvh) == 0 && overlap_of(&bvh, &scene, 0) == 0);
    scene_free(&scene);
    static const float point[3][3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    scene = trees_copies(9, point);
    bvh = trees_make(&scene, 2, TREES_BALANCED);
    assert_true(tree_sah(&bvh) == 0 && overlap_of(&bvh, &scene, 0) == 0);
    bvh_free(&bvh);
    scene_free(&scene);
}

/* Of more triangles than `most`, every second, third .. is measured, so that they are not more than
 * that: as where all others have no area. */
static void a_sample_is_of_every_so_manyth(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 2, 99, 100, 101},
                          mosts[] = {0, 1, 2, 7, 33, 49, 50, 51, 99, 100};
    for (size_t i = 0; i < ARRAY_COUNT(counts); i++) {
        struct scene scene = built_soup(counts[i], 7), flat = built_soup(counts[i], 7);
        struct bvh bvh = trees_make(&scene, 2, TREES_BALANCED);
        for (size_t m = 0; m < ARRAY_COUNT(mosts); m++) {
            uint32_t every = 1;
            while (mosts[m] && (counts[i] + every - 1) / every > mosts[m])
                every++;
            for (uint32_t t = 0; t < counts[i]; t++)
                for (uint32_t c = 0; c < 3; c++)
                    flat.index[3 * t + c] = scene.index[3 * t + (t % every ? 0 : c)];
            const double want = overlap_of(&bvh, &flat, 0),
                         got = overlap_of(&bvh, &scene, mosts[m]);
            if (fabs(got - want) > 1e-12 * want)
                fail_msg("%u of %u: %.17g, not %.17g", mosts[m], counts[i], got, want);
        }
        bvh_free(&bvh);
        scene_free(&scene);
        scene_free(&flat);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(overlap_by_hand),
        cmocka_unit_test(a_sample_is_of_every_so_manyth),
        cmocka_unit_test(overlap_is_what_points_on_the_triangles_meet),
        cmocka_unit_test(an_estimate_is_near_and_scale_changes_nothing),
        cmocka_unit_test(trees_without_area_have_no_cost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
