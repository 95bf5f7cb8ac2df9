/* The fuzzer's rays: how many are aimed, and that they meet what they are aimed at. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "fuzz/gen/aim.h"
#include "fuzz/gen/gen_sketch.h"
#include "ref/base/half.h"
#include "ref/layout.h"

#include <cmocka.h>

#include "tests/fuzz/fuzz_gen_trials.h"
#include "ref/primitives/test_run.h"

#define TRIALS 200u
#define RAYS   500u

/* --- distances, in double ----------------------------------------------------------------------
 */

/* Distance of a point from a segment. */
static double from_segment(const float p[3], const float a[3], const float b[3])
{
    double along = 0, square = 0, left = 0;
    for (int k = 0; k < 3; k++) {
        along += ((double)p[k] - (double)a[k]) * ((double)b[k] - (double)a[k]);
        square += ((double)b[k] - (double)a[k]) * ((double)b[k] - (double)a[k]);
    }
    double s = square > 0 ? fmin(fmax(along / square, 0), 1) : 0;
    for (int k = 0; k < 3; k++) {
        double d = (double)p[k] - (double)a[k] - s * ((double)b[k] - (double)a[k]);
        left += d * d;
    }
    return sqrt(left);
}

/* Distance of a point from the faces of a box; if `edges` from its edges. */
static double from_box(const float p[3], const struct box *box, bool edges)
{
    double best = INFINITY;
    for (int skip = 0; skip < 3; skip++)
        for (int side = 0; side < 4; side++) {
            int a = (skip + 1) % 3, b = (skip + 2) % 3;
            double off[3];
            for (int k = 0; k < 3; k++)
                off[k] = fmax(
                    fmax((double)box->lo[k] - (double)p[k], (double)p[k] - (double)box->hi[k]), 0);
            off[a] = fabs((double)(side & 1 ? box->hi[a] : box->lo[a]) - (double)p[a]);
            if (edges)
                off[b] = fabs((double)(side & 2 ? box->hi[b] : box->lo[b]) - (double)p[b]);
            best = fmin(best, sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2]));
        }
    return best;
}

/* Distance of a point from the nearest feature of its kind. */
static double from_feature(const struct aim *aim, enum aim_kind kind, const float p[3])
{
    double best = INFINITY;
    for (uint32_t i = 0; kind == AIM_CORNER || kind == AIM_FACE ? i < aim->box_count : 0; i++)
        best = fmin(best, from_box(p, &aim->box[i], kind == AIM_CORNER));
    for (uint32_t i = 0; i < aim->scene->tri_count && !isfinite(best) + 1; i++) {
        float v[3][3];
        if (kind == AIM_CORNER || kind == AIM_FACE)
            break;
        scene_tri(aim->scene, i, v);
        for (int c = 0; c < 3; c++)
            best = fmin(best, from_segment(p, v[c], kind == AIM_EDGE ? v[(c + 1) % 3] : v[c]));
    }
    return best;
}

/* Distance of the ray's line from a point. */
static double from_line(const struct ray *ray, const float p[3])
{
    double dd = 0, pd = 0, pp = 0;
    for (int k = 0; k < 3; k++) {
        double d = (double)ray->dir[k], q = (double)p[k] - (double)ray->org[k];
        dd += d * d;
        pd += q * d;
    }
    for (int k = 0; k < 3; k++) {
        double rest = (double)p[k] - (double)ray->org[k] - pd / dd * (double)ray->dir[k];
        pp += rest * rest;
    }
    return sqrt(pp);
}

/* Largest number that plays a part: what rounding is measured by. */
static double size_of(const struct aim *aim, const struct ray *ray)
{
    double size = 0;
    for (int k = 0; k < 3; k++)
        size = fmax(size, fmax(fabs((double)ray->org[k]),
                               fmax(fabs((double)aim->all.lo[k]), fabs((double)aim->all.hi[k]))));
    return size;
}

/* --- shares ------------------------------------------------------------------------------------
 */

typedef enum aim_kind aim_fn(const struct aim *aim, struct rng *rng, struct ray *out,
                             float target[3]);

struct aim_tally {
    uint32_t kind[AIM_KINDS], exact, off, astray, out_of_contract;
};

/* Counts rays by kind; `off`: the target is farther from its feature than a displacement may be,
 * `astray`: the line misses its target. */
static struct aim_tally tally_of(aim_fn *make, uint32_t trials)
{
    struct aim_tally tally = {.exact = 0};
    static const struct gen_options no_rays = {.triangles_least = 16, .triangles_most = 64};
    for (uint32_t t = 0; t < trials; t++) {
        struct fuzz_trial trial = trial_of(17, t, &no_rays);
        struct rng rng = rng_make(19, t);
        struct aim aim;
        if (trial.scene.tri_count > 100) {
            fuzz_trial_free(&trial);
            continue;
        }
        aim_make(&trial.scene, trial.build.leaf, &rng, &aim);
        for (uint32_t i = 0; i < RAYS; i++) {
            struct ray ray;
            float target[3] = {0, 0, 0};
            enum aim_kind kind = make(&aim, &rng, &ray, target);
            tally.kind[kind]++;
            tally.out_of_contract += kind != AIM_DEGENERATE && !ray_in_contract(&ray);
            if (kind >= AIM_FEATURES || trial.scene.tri_count == 0)
                continue;
            double size = size_of(&aim, &ray), away = from_feature(&aim, kind, target);
            double room = kind == AIM_HALF ? 0x1p-6 * size + 0x1p-13 : 0;
            tally.exact += away <= 0x1p-22 * size;
            tally.off += away > 0x1p-5 * (double)aim.extent + 0x1p-20 * size + room;
            tally.astray += from_line(&ray, target) > 0x1p-20 * size;
        }
        fuzz_trial_free(&trial);
    }
    return tally;
}

static uint32_t aimed_of(const struct aim_tally *tally, uint32_t *all)
{
    uint32_t aimed = 0;
    *all = 0;
    for (uint32_t k = 0; k < AIM_KINDS; k++) {
        *all += tally->kind[k];
        aimed += k < AIM_FEATURES ? tally->kind[k] : 0;
    }
    return aimed;
}

static void three_rays_of_four_are_aimed_at_features(void **state)
{
    (void)state;
    static const char *const name[AIM_KINDS] = {"vertex",  "edge",      "corner", "face",
                                                "float16", "inside",    "random", "axis",
                                                "grazing", "degenerate"};
    struct aim_tally tally = tally_of(aim_ray, TRIALS);
    uint32_t all, aimed = aimed_of(&tally, &all);
    for (uint32_t k = 0; k < AIM_KINDS; k++) {
        print_message("%-10s %5.1f %%\n", name[k], 100.0 * tally.kind[k] / all);
        assert_true(tally.kind[k] > all / 200);
    }
    print_message("%u of %u rays are aimed at features, %u of them to rounding; %u are off, %u go "
                  "astray\n",
                  aimed, all, tally.exact, tally.off, tally.astray);
    assert_true(aimed >= all / 10 * 7);
    assert_true(tally.exact >= aimed / 3);
    assert_int_equal(tally.off, 0);
    assert_int_equal(tally.out_of_contract, 0);
    /* Components below 2^-59 of the largest become 0, which far from the origin is a step. */
    assert_true(tally.astray < aimed / 1000);
}

/* Planted: rays that say they are aimed. */
static enum aim_kind pretend(const struct aim *aim, struct rng *rng, struct ray *out,
                             float target[3])
{
    float other[3];
    enum aim_kind kind = aim_ray(aim, rng, out, target);
    if (kind < AIM_FEATURES)
        while (aim_ray(aim, rng, out, other) != AIM_RANDOM)
            ;
    return kind;
}

/* Planted: aims at the middle of the scene. */
static enum aim_kind lazy(const struct aim *aim, struct rng *rng, struct ray *out, float target[3])
{
    enum aim_kind kind = aim_ray(aim, rng, out, target);
    for (int k = 0; k < 3; k++)
        target[k] = aim->centre[k];
    return kind;
}

static void rays_that_are_not_aimed_are_caught(void **state)
{
    (void)state;
    struct aim_tally tally = tally_of(pretend, 20);
    assert_true(tally.astray > 1000);
    tally = tally_of(lazy, 20);
    assert_true(tally.off > 1000);
}

/* Rays of whole trials whose lines pass a vertex to rounding, in percent; `aimed` or replaced by
 * random ones. */
static double through_vertices(bool aimed)
{
    uint32_t all = 0, through = 0;
    for (uint32_t t = 0; t < 60; t++) {
        struct fuzz_trial trial = trial_of(37, t, &ordinary);
        struct rng rng = rng_make(37, t);
        struct aim aim;
        if (trial.scene.tri_count == 0 || trial.scene.tri_count > 100) {
            fuzz_trial_free(&trial);
            continue;
        }
        aim_make(&trial.scene, 1, &rng, &aim);
        for (uint32_t i = 0; i < trial.ray_count; i++) {
            float unused[3];
            double nearest = INFINITY;
            while (!aimed && aim_ray(&aim, &rng, &trial.ray[i], unused) != AIM_RANDOM)
                ;
            for (uint32_t v = 0; v < trial.scene.vertex_count; v++)
                nearest = fmin(nearest, from_line(&trial.ray[i], trial.scene.vertex + 3 * v));
            all++;
            through += nearest <= 0x1p-21 * (double)aim.extent;
        }
        fuzz_trial_free(&trial);
    }
    return 100.0 * through / all;
}

static void trials_have_the_aimed_rays(void **state)
{
    (void)state;
    double aimed = through_vertices(true), random = through_vertices(false);
    print_message(
        "%.1f %% of the rays of trials pass a vertex to rounding, %.1f %% of random ones\n", aimed,
        random);
    assert_true(aimed > 15 && random < 5);
}

/* --- boxes and halves --------------------------------------------------------------------------
 */

static bool is_node(const struct bvh *bvh, const struct box *box)
{
    for (uint32_t i = 0; i < bvh->node_count; i++)
        if (memcmp(&bvh->node[i].bounds, box, sizeof *box) == 0)
            return true;
    return false;
}

/* What is aimed at are mostly the boxes that builder median makes. */
static void boxes_are_those_of_the_tree(void **state)
{
    (void)state;
    static const struct gen_options no_rays = {.triangles_least = 16, .triangles_most = 64};
    uint32_t boxes = 0, nodes = 0;
    for (uint32_t t = 0; t < TRIALS; t++) {
        struct fuzz_trial trial = trial_of(23, t, &no_rays);
        struct rng rng = rng_make(1, t);
        struct aim aim;
        struct bvh bvh;
        aim_make(&trial.scene, trial.build.leaf, &rng, &aim);
        assert_true(aim.box_count >= 1);
        if (trial.scene.tri_count > 0 && trial.scene.tri_count <= AIM_SPLIT_MOST) {
            assert_int_equal(builder_find("median")->build(&trial.scene, &trial.build, &bvh, NULL),
                             STATUS_OK);
            for (uint32_t i = 0; i < aim.box_count; i++) {
                boxes++;
                nodes += is_node(&bvh, &aim.box[i]);
            }
            bvh_free(&bvh);
        }
        fuzz_trial_free(&trial);
    }
    print_message("%u of %u boxes are nodes of the tree\n", nodes, boxes);
    assert_true(boxes > 1000 && nodes > boxes / 10 * 9);
}

/* Lost hits, of rays that hit by brute force, on a tree whose stored bounds were rounded to
 * nearest: published layout rtrs_rf_paper has them. Aimed rays must lose far more than random ones.
 */
static uint32_t lost_to_rounding(bool aimed, uint32_t *traced)
{
    uint32_t lost = 0;
    static const struct gen_options no_rays = {.triangles_least = 16, .triangles_most = 64};
    const struct tri_test *woop = tri_test_find("woop");
    for (uint32_t t = 0; t < TRIALS; t++) {
        struct fuzz_trial trial = trial_of(29, t, &no_rays);
        struct rng rng = rng_make(31, t);
        struct aim aim;
        aim_make(&trial.scene, 1, &rng, &aim);
        for (uint32_t n = 0; n < 100 && trial.scene.tri_count > 0; n++) {
            struct ray ray;
            float target[3], v[3][3];
            struct hit hit;
            enum aim_kind kind = aim_ray(&aim, &rng, &ray, target);
            if (!ray_in_contract(&ray) || (kind < AIM_FEATURES) != aimed)
                continue;
            ++*traced;
            for (uint32_t i = 0; i < trial.scene.tri_count && i < 64; i++) {
                struct box box = scene_tri_bounds(&trial.scene, i), stored;
                struct slab_ray slab = slab_ray_make(&ray);
                struct tri_ray tri = tri_ray_make(&ray);
                float entry;
                for (int k = 0; k < 3; k++) {
                    stored.lo[k] = half_to_float(half_nearest(box.lo[k]));
                    stored.hi[k] = half_to_float(half_nearest(box.hi[k]));
                }
                slab_ray_place(&slab, &stored);
                scene_tri(&trial.scene, i, v);
                lost += tri_test_run(woop->id, &tri, v, &hit) &&
                        !box_test_run(ABI_BOX_ROBUST, &slab, &stored, ray.tmax, &entry);
            }
        }
        fuzz_trial_free(&trial);
    }
    return lost;
}

static void aimed_rays_find_bounds_rounded_inward(void **state)
{
    (void)state;
    uint32_t aimed_rays = 0, other_rays = 0;
    uint32_t aimed = lost_to_rounding(true, &aimed_rays);
    uint32_t other = lost_to_rounding(false, &other_rays);
    double share = (double)aimed / aimed_rays, other_share = (double)other / other_rays;
    print_message("boxes rounded to nearest lose %u hits of %u aimed rays (%.2f %%), %u of %u "
                  "others (%.2f %%)\n",
                  aimed, aimed_rays, 100 * share, other, other_rays, 100 * other_share);
    assert_true(share > 0.02 && share > 2 * other_share);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(three_rays_of_four_are_aimed_at_features),
        cmocka_unit_test(rays_that_are_not_aimed_are_caught),
        cmocka_unit_test(trials_have_the_aimed_rays),
        cmocka_unit_test(boxes_are_those_of_the_tree),
        cmocka_unit_test(aimed_rays_find_bounds_rounded_inward),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
