/* How much slack the constants of the oracle of worlds have: what they bound against rationals.
 * Prints the largest error over bound; fails above 1. */
#include "ref/oracle/placed_filter.h"
#include "ref/oracle/placing.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static uint64_t trials_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 30000 : 500;
}

/* --- rationals -------------------------------------------------------------------------------- */

struct world_rationals {
    mpq_t m[3][4], o[3], d[3], v[3][3], a[3][3], e[3][3], w[3][3], out, left, right;
};

static void each(struct world_rationals *q, void (*do_it)(mpq_t))
{
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            do_it(q->v[i][j]);
            do_it(q->a[i][j]);
            do_it(q->e[i][j]);
            do_it(q->w[i][j]);
        }
        for (int j = 0; j < 4; j++)
            do_it(q->m[i][j]);
        do_it(q->o[i]);
        do_it(q->d[i]);
    }
    do_it(q->out);
    do_it(q->left);
    do_it(q->right);
}

static void init(mpq_t x)
{
    mpq_init(x);
}

static void clear(mpq_t x)
{
    mpq_clear(x);
}

/* out += x y, or -= */
static void add_product(struct world_rationals *q, mpq_t out, const mpq_t x, const mpq_t y,
                        bool minus)
{
    mpq_mul(q->left, x, y);
    if (minus)
        mpq_sub(out, out, q->left);
    else
        mpq_add(out, out, q->left);
}

/* One instance, triangle and ray, and all that follows from them. */
struct bounded_trial {
    struct instance at;
    struct ray ray;
    float v[3][3];
};

static void fill(struct world_rationals *q, const struct bounded_trial *trial)
{
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 4; j++)
            mpq_set_d(q->m[k][j], (double)trial->at.m[k][j]);
        for (int c = 0; c < 3; c++)
            mpq_set_d(q->v[c][k], (double)trial->v[c][k]);
        mpq_set_d(q->o[k], (double)trial->ray.org[k]);
        mpq_set_d(q->d[k], (double)trial->ray.dir[k]);
    }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            mpq_sub(q->a[c][k], q->m[k][3], q->o[k]);
            for (int j = 0; j < 3; j++)
                add_product(q, q->a[c][k], q->m[k][j], q->v[c][j], false);
        }
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            mpq_sub(q->e[c][k], q->a[(c + 2) % 3][k], q->a[(c + 1) % 3][k]);
}

/* out = [x, y, z] */
static void triple(struct world_rationals *q, mpq_t x[3], mpq_t y[3], mpq_t z[3])
{
    mpq_set_si(q->out, 0, 1);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        mpq_mul(q->right, y[i], z[j]);
        add_product(q, q->out, x[k], q->right, false);
        mpq_mul(q->right, y[j], z[i]);
        add_product(q, q->out, x[k], q->right, true);
    }
}

/* Error of `value`, which should be q->out, over its bound. */
static double share(struct world_rationals *q, double value, double err)
{
    mpq_set_d(q->left, value);
    mpq_sub(q->left, q->left, q->out);
    if (mpq_sgn(q->left) == 0)
        return 0;
    if (err == 0)
        return INFINITY;
    mpq_abs(q->left, q->left);
    mpq_set_d(q->right, err);
    mpq_div(q->left, q->left, q->right);
    return mpq_get_d(q->left);
}

/* The inverse of M, by cofactors. */
static void invert(struct world_rationals *q)
{
    mpq_t det;
    mpq_init(det);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int a = (j + 1) % 3, b = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            mpq_set_si(q->w[i][j], 0, 1);
            add_product(q, q->w[i][j], q->m[a][c], q->m[b][d], false);
            add_product(q, q->w[i][j], q->m[a][d], q->m[b][c], true);
        }
    for (int j = 0; j < 3; j++)
        add_product(q, det, q->m[0][j], q->w[j][0], false);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            mpq_div(q->w[i][j], q->w[i][j], det);
    mpq_clear(det);
}

static void draw(const struct world_turn *turn, struct rng *rng, struct bounded_trial *out)
{
    *out = (struct bounded_trial){.at = {.mask = 0xFF}};
    world_turn_draw(turn, rng, out->at.m);
    float far = rng_below(rng, 2) ? 1 : 1000;
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            out->v[c][k] = rng_range(rng, -1, 1);
        out->ray.org[k] = rng_range(rng, -far, far);
        out->ray.dir[k] = rng_range(rng, -1, 1);
    }
    uint32_t near = rng_below(rng, 3); /* to what the origin is so near that sums cancel */
    for (int k = 0; k < 3 && near < 2; k++) {
        double at = (double)out->at.m[k][3];
        for (int j = 0; j < 3 && near; j++)
            at += (double)out->at.m[k][j] * (double)out->v[1][j];
        if (fabs(at) < 1e38)
            out->ray.org[k] = (float)at + (near ? 0 : rng_range(rng, -1, 1));
    }
}

/* --- bounds ----------------------------------------------------------------------------------- */

static void the_filter_of_placed_triangles_has_this_much_slack(void **state)
{
    (void)state;
    struct world_rationals q;
    double most[3] = {0, 0, 0};
    each(&q, init);
    for (int kind = 0; kind < WORLD_TURNS; kind++) {
        struct rng rng = far_rng((uint64_t)kind + 60);
        for (uint64_t n = 0; n < trials_each(); n++) {
            struct bounded_trial trial;
            struct placed_filter placed;
            const struct filter *f = &placed.filter;
            draw(&world_turns[kind], &rng, &trial);
            placed_edges(&trial.ray, trial.v, &trial.at, &placed);
            placed_plane(&placed);
            fill(&q, &trial);
            for (int c = 0; c < 3; c++) {
                triple(&q, q.d, q.a[(c + 1) % 3], q.a[(c + 2) % 3]);
                most[0] = fmax(most[0], share(&q, f->w[c], f->w_err[c]));
            }
            triple(&q, q.d, q.e[0], q.e[1]);
            most[1] = fmax(most[1], share(&q, f->det, f->det_err));
            triple(&q, q.a[0], q.a[1], q.a[2]);
            most[2] = fmax(most[2], share(&q, f->t, f->t_err));
        }
    }
    each(&q, clear);
    print_message("placed filter, 17 * 2^-53: largest error over bound w %.3f, D %.3f, T %.3f, of "
                  "%llu pairs\n",
                  most[0], most[1], most[2], (unsigned long long)(WORLD_TURNS * trials_each()));
    for (int i = 0; i < 3; i++)
        assert_true(most[i] <= 1 && most[i] > 0.05);
}

static void rays_in_a_mesh_have_this_much_slack(void **state)
{
    (void)state;
    struct world_rationals q;
    double inverse_most = 0, o_most = 0, d_most = 0;
    each(&q, init);
    for (int kind = 0; kind < WORLD_TURNS; kind++) {
        struct rng rng = far_rng((uint64_t)kind + 90);
        for (uint64_t n = 0; n < trials_each(); n++) {
            struct bounded_trial trial;
            struct inverse inverse;
            struct sight sight;
            draw(&world_turns[kind], &rng, &trial);
            placing_invert(trial.at.m, &inverse);
            assert_int_equal(inverse.det_sign, instance_det_sign(trial.at.m));
            sight_make(&inverse, &trial.at, &trial.ray, &sight);
            fill(&q, &trial);
            invert(&q);
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) {
                    mpq_set(q.out, q.w[i][j]);
                    inverse_most = fmax(inverse_most, share(&q, inverse.w[i][j],
                                                            6 * 0x1p-53 * fabs(inverse.w[i][j])));
                }
                mpq_set_si(q.out, 0, 1);
                for (int j = 0; j < 3; j++)
                    add_product(&q, q.out, q.w[i][j], q.d[j], false);
                d_most = fmax(d_most, share(&q, sight.d[i], sight.d_err[i]));
                mpq_set_si(q.out, 0, 1);
                for (int j = 0; j < 3; j++) {
                    add_product(&q, q.out, q.w[i][j], q.o[j], false);
                    add_product(&q, q.out, q.w[i][j], q.m[j][3], true);
                }
                o_most = fmax(o_most, share(&q, sight.o[i], sight.o_err[i]));
            }
        }
    }
    each(&q, clear);
    print_message("inverses, 6 * 2^-53: largest error over bound %.3f\n", inverse_most);
    print_message("rays in a mesh, 14 * 2^-53: largest error over bound o %.3f, d %.3f\n", o_most,
                  d_most);
    assert_true(inverse_most <= 1 && inverse_most > 0.1);
    assert_true(o_most <= 1 && o_most > 0.1 && d_most <= 1 && d_most > 0.1);
}

/* Sign of the float x minus coordinate k of a placed corner. */
static int beyond(struct world_rationals *q, float x, const struct instance *at, int k,
                  const float corner[3])
{
    if (isinf(x))
        return x > 0 ? 1 : -1;
    mpq_set_d(q->out, (double)x);
    mpq_set_d(q->right, (double)at->m[k][3]);
    mpq_sub(q->out, q->out, q->right);
    for (int j = 0; j < 3; j++) {
        mpq_set_d(q->right, (double)corner[j]);
        add_product(q, q->out, q->m[k][j], q->right, true);
    }
    return mpq_sgn(q->out);
}

/* A box and a transform whose sums often cancel to less than a last place of their terms. */
static void draw_box(const struct world_turn *turn, struct rng *rng, struct bounded_trial *trial,
                     struct box *box)
{
    draw(turn, rng, trial);
    float size = rng_below(rng, 4) ? 1 : 1000;
    for (int k = 0; k < 3; k++) {
        box->lo[k] = size * rng_range(rng, -1, 1);
        box->hi[k] = box->lo[k] + (rng_below(rng, 3) ? size * rng_float(rng) : 0);
    }
    int k = (int)rng_below(rng, 3);
    double sum = 0;
    for (int j = 0; j < 3; j++)
        sum += (double)trial->at.m[k][j] * (double)box->lo[j];
    if (fabs(sum) < 1e38)
        trial->at.m[k][3] = -(float)sum;
}

static void world_boxes_contain_all_corners(void **state)
{
    (void)state;
    struct world_rationals q;
    uint64_t unpadded = 0, infinite = 0;
    each(&q, init);
    for (int kind = 0; kind < WORLD_TURNS; kind++) {
        struct rng rng = far_rng((uint64_t)kind + 120);
        for (uint64_t n = 0; n < trials_each(); n++) {
            struct bounded_trial trial;
            struct box box;
            draw_box(&world_turns[kind], &rng, &trial, &box);
            fill(&q, &trial);
            struct box placed = placing_bounds(trial.at.m, &box);
            for (int i = 0; i < 24; i++) {
                float corner[3];
                int k = i / 8;
                double computed = 0;
                for (int j = 0; j < 3; j++) {
                    corner[j] = i >> j & 1 ? box.hi[j] : box.lo[j];
                    computed += (double)trial.at.m[k][j] * (double)corner[j];
                }
                computed += (double)trial.at.m[k][3];
                assert_true(beyond(&q, placed.lo[k], &trial.at, k, corner) <= 0);
                assert_true(beyond(&q, placed.hi[k], &trial.at, k, corner) >= 0);
                infinite += isinf(placed.hi[k]) || isinf(placed.lo[k]);
                /* What a pad of 0 would do: the sum, rounded to a float outward. */
                float rounded = (float)computed;
                if ((double)rounded < computed)
                    rounded = nextafterf(rounded, INFINITY);
                unpadded += beyond(&q, rounded, &trial.at, k, corner) < 0;
            }
        }
    }
    each(&q, clear);
    print_message(
        "world boxes: without a pad %llu corners were outside; %llu bounds are infinite\n",
        (unsigned long long)unpadded, (unsigned long long)infinite);
    assert_true(unpadded > 20 && infinite > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_filter_of_placed_triangles_has_this_much_slack),
        cmocka_unit_test(rays_in_a_mesh_have_this_much_slack),
        cmocka_unit_test(world_boxes_contain_all_corners),
    };
    return cmocka_run_group_tests_name("oracle_world_bounds", tests, NULL, NULL) ? 1 : 0;
}
