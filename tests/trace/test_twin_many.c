/* Twins by vectors are the twins computed alone, bit for bit, for every kind of vector that runs
 * here, every formula and every rounding. */
#include "ref/base/base.h"
#include "ref/base/rng.h"
#include "ref/twin/twin.h"
#include "ref/twin/twin_lanes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define PAIRS  61u /* no multiple of the lanes */
#define ROUNDS 60u

static const enum twin_formula formulas[] = {
    TWIN_MT,     TWIN_MT_RTRS,       TWIN_WOOP,    TWIN_PLUECKER, TWIN_BALDWIN_WEBBER,
    TWIN_EMBREE, TWIN_EMBREE_ROBUST, TWIN_UNKNOWN, TWIN_TRI_ACCEL};
static const struct rounding roundings[] = {{1, 1, 1, 0x1p-149},
                                            {1, 1, 1, 0x1p-126},
                                            {1, 1, 5.5, 0x1p-126},
                                            {2, 2, 5, 0x1p-126},
                                            {1, 1, 5, 0x1p-126}};

enum many_kind { KIND_PLAIN, KIND_LATTICE, KIND_SCALED, KIND_TINY, KIND_HUGE, KINDS };

static float draw(struct rng *rng, enum many_kind kind)
{
    float x = rng_range(rng, -4, 4);
    switch (kind) {
    case KIND_LATTICE: /* zeros, ties, edges met exactly */
        return (float)(int)x;
    case KIND_SCALED: /* products at both ends of float32 */
        return ldexpf(x, (int)rng_below(rng, 90) - 45);
    case KIND_TINY: /* what may be flushed */
        return ldexpf(x, -(int)rng_below(rng, 149));
    case KIND_HUGE: /* what overflows */
        return ldexpf(x, (int)rng_below(rng, 124));
    case KIND_PLAIN:
    case KINDS:
        break;
    }
    return x;
}

static void draw_all(struct rng *rng, enum many_kind kind, struct scene *scene, struct ray *ray,
                     struct twin_pair *pair)
{
    for (uint32_t i = 0; i < 3 * scene->vertex_count; i++)
        scene->vertex[i] = draw(rng, kind);
    for (uint32_t i = 0; i < 3 * scene->tri_count; i++)
        scene->index[i] = rng_below(rng, scene->vertex_count);
    for (uint32_t i = 0; i < PAIRS; i++) {
        const float *at = scene->vertex + 3 * rng_below(rng, scene->vertex_count);
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = draw(rng, kind);
            ray[i].dir[k] = rng_below(rng, 2) ? draw(rng, kind) : at[k] - ray[i].org[k];
        }
        ray[i].tmin = rng_below(rng, 3) ? 0 : 0.5f;
        ray[i].tmax = rng_below(rng, 3) ? INFINITY : 1;
        pair[i] = (struct twin_pair){&ray[i], rng_below(rng, scene->tri_count)};
    }
}

static bool same_number(double a, double b)
{
    return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b));
}

static void compare(const struct twin *one, const struct twin *many)
{
    assert_int_equal(one->possible, many->possible);
    assert_int_equal(one->certain, many->certain);
    assert_int_equal(one->beyond, many->beyond);
    for (int c = 0; c < 3; c++)
        assert_int_equal(one->edge[c], many->edge[c]);
    assert_int_equal(one->det, many->det);
    assert_true(same_number(one->t_err, many->t_err));
    assert_true(same_number(one->u_err, many->u_err));
    assert_true(same_number(one->v_err, many->v_err));
    assert_true(same_number(one->t_near, many->t_near));
    assert_true(same_number(one->u_near, many->u_near));
    assert_true(same_number(one->v_near, many->v_near));
}

/* Both signs of the determinant, certain and impossible hits, infinite bounds. */
static size_t kinds_of(const struct twin *twin)
{
    return (size_t)1 << (2 * twin->possible + twin->certain) | (size_t)16
                                                                   << (isinf(twin->t_err) ? 1 : 0);
}

static void vectors_give_the_same_twins(void **state)
{
    (void)state;
    const struct twin_kernel *const kernels[] = {
#if defined(TWIN_VECTORS)
        &twin_avx2,
        &twin_avx512,
#endif
        NULL,
    };
    struct scene scene;
    struct ray ray[PAIRS];
    struct twin_pair pair[PAIRS];
    struct twin many[PAIRS];
    struct rng rng = rng_make(91, 0);
    size_t seen = 0;
    assert_int_equal(scene_make(24, 16, &scene), STATUS_OK);
    for (uint32_t n = 0; n < ROUNDS * KINDS; n++) {
        draw_all(&rng, (enum many_kind)(n % KINDS), &scene, ray, pair);
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
            for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
                for (size_t k = 0; k < ARRAY_COUNT(kernels); k++) {
                    if (!kernels[k])
                        twin_eval_many(formulas[f], roundings[r], &scene, pair, PAIRS, many);
                    else if (kernels[k]->runs())
                        twin_eval_by(kernels[k], formulas[f], roundings[r], &scene, pair, PAIRS,
                                     many);
                    else
                        continue;
                    for (size_t i = 0; i < PAIRS; i++) {
                        float v[3][3];
                        scene_tri(&scene, pair[i].prim, v);
                        struct twin one = twin_eval(formulas[f], roundings[r], pair[i].ray, v);
                        compare(&one, &many[i]);
                        seen |= kinds_of(&one);
                    }
                }
    }
    scene_free(&scene);
    assert_int_equal(seen & 0x35, 0x35); /* impossible, possible, certain; finite and infinite */
    assert_true(seen & 0x20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(vectors_give_the_same_twins)};
    return cmocka_run_group_tests_name("twin_many", tests, NULL, NULL) ? 1 : 0;
}
