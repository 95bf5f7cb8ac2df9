/* The first look (ref/oracle/early.h) at its borders: of small whole numbers, where nothing is
 * rounded, every kernel's bits are those of the definition, with bounds that many products and
 * places meet exactly; a ray's shear and bounds are those of the formulas, along every axis. */
#include "ref/base/rng.h"
#include "ref/oracle/early.h"

#include <math.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define TRIS 80

static double place[3][3][TRIS + EARLY_PAD]; /* [vertex][axis] */

/* Whether a triangle is dropped: two products beyond the bound on either side, or all places
 * beyond theirs on one side of an axis. */
static bool dropped(const struct early_ray *ray, uint32_t tri, double largest)
{
    const double bound = ray->bound * largest * largest, beside = ray->beside * largest;
    double at[3][2];
    bool above = false, below = false;
    for (int c = 0; c < 3; c++) {
        double z = place[c][ray->kz][tri] - ray->o[ray->kz];
        at[c][0] = place[c][ray->kx][tri] - ray->o[ray->kx] - ray->s[0] * z;
        at[c][1] = place[c][ray->ky][tri] - ray->o[ray->ky] - ray->s[1] * z;
    }
    for (int c = 0; c < 3; c++) {
        const double *one = at[(c + 1) % 3], *two = at[(c + 2) % 3];
        double w = one[0] * two[1] - one[1] * two[0];
        above = above || w > bound;
        below = below || w < -bound;
    }
    bool out = above && below;
    for (int k = 0; k < 2; k++) {
        double low = fmin(fmin(at[0][k], at[1][k]), at[2][k]);
        double high = fmax(fmax(at[0][k], at[1][k]), at[2][k]);
        out = out || low > beside || high < -beside;
    }
    return out;
}

static void kernels_drop_by_definition(void **state)
{
    (void)state;
    struct rng rng = rng_make(51, 0);
    uint32_t drops = 0, keeps = 0;
    for (uint32_t round = 0; round < 3000; round++) {
        const uint32_t count = 1 + rng_below(&rng, EARLY_MOST),
                       first = rng_below(&rng, TRIS - count);
        const double largest = ldexp(1, (int)rng_below(&rng, 3));
        struct early_ray ray = {.kz = (int)rng_below(&rng, 3), .more = 1e9};
        struct early_soup soup;
        const int turn = rng_below(&rng, 2) ? 1 : 2;
        ray.kx = (ray.kz + turn) % 3;
        ray.ky = (ray.kz + 3 - turn) % 3;
        ray.bound = (double)rng_below(&rng, 4) / (largest * largest);
        ray.beside = rng_below(&rng, 2) ? (double)rng_below(&rng, 3) / largest : INFINITY;
        for (int k = 0; k < 3; k++)
            ray.o[k] = (double)rng_below(&rng, 3) - 1;
        ray.s[0] = 0.5 * (double)rng_below(&rng, 3) - 0.5;
        ray.s[1] = 0.5 * (double)rng_below(&rng, 3) - 0.5;
        for (uint32_t i = 0; i < 9 * TRIS; i++)
            place[i / 3 % 3][i % 3][i / 9] = (double)rng_below(&rng, 7) - 3;
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++)
                soup.v[c][k] = place[c][k];
        uint64_t want = 0;
        for (uint32_t i = 0; i < count; i++) {
            bool drop = dropped(&ray, first + i, largest);
            want |= (uint64_t)!drop << i;
            drops += drop;
            keeps += !drop;
        }
        for (const struct early_kernel *kernel = early_kernels; kernel->name; kernel++)
            if (kernel->runs() && kernel->look(&soup, &ray, first, count, largest) != want)
                fail_msg("%s, round %u: another answer", kernel->name, round);
    }
    assert_true(drops > 10000 && keeps > 10000);
}

static void the_last_that_runs_is_the_best(void **state)
{
    (void)state;
    const struct early_kernel *last = NULL;
    for (const struct early_kernel *kernel = early_kernels; kernel->name; kernel++)
        last = kernel->runs() ? kernel : last;
    assert_ptr_equal(early_best(), last);
    assert_string_equal(early_kernels[0].name, "plain");
    assert_true(early_kernels[0].runs());
}

/* The axes of a ray: the first of the largest numbers, and both behind it. */
static void expect_axes(const struct early_ray *ray, const double d[3])
{
    int z = 0;
    for (int k = 1; k < 3; k++)
        z = fabs(d[k]) > fabs(d[z]) ? k : z;
    assert_int_equal(ray->kz, z);
    assert_int_equal(ray->kx, (z + 1) % 3);
    assert_int_equal(ray->ky, (z + 2) % 3);
}

/* Numbers of which many are 0 and many are the same but for their sign. */
static double draw_number(struct rng *rng)
{
    static const double few[] = {0, 0, 1, 1, 1, 0.5, 3};
    double size = rng_below(rng, 3) ? few[rng_below(rng, 7)] : (double)rng_float(rng);
    return rng_below(rng, 2) ? size : -size;
}

static void rays_are_sheared_along_their_largest_axis(void **state)
{
    (void)state;
    struct rng rng = rng_make(52, 0);
    const double none[3] = {0, 0, 0};
    for (uint32_t n = 0; n < 5000; n++) {
        struct ray ray = {.tmax = 1};
        double o[3], d[3];
        bool any = false;
        for (int k = 0; k < 3; k++) {
            ray.org[k] = (float)(o[k] = (double)(float)draw_number(&rng));
            ray.dir[k] = (float)(d[k] = (double)(float)draw_number(&rng));
            any = any || d[k] != 0;
        }
        if (!any)
            continue;
        struct early_ray early[2] = {early_ray_make(&ray), early_ray_about(o, d, none, none)};
        for (int i = 0; i < 2; i++) {
            const struct early_ray *r = &early[i];
            expect_axes(r, d);
            assert_memory_equal(r->o, o, sizeof o);
            assert_true(r->s[0] == d[r->kx] / d[r->kz] && r->s[1] == d[r->ky] / d[r->kz]);
            assert_true(r->bound == EARLY_BOUND && r->beside == EARLY_BESIDE && r->more == 0);
        }
    }
}

/* Of errors of its own along each axis: the largest of both that are sheared, and that of the axis
 * itself, over what it is for certain. */
static void errors_widen_the_bounds_by_their_formulas(void **state)
{
    (void)state;
    struct rng rng = rng_make(53, 0);
    uint32_t known = 0, open = 0;
    for (uint32_t n = 0; n < 20000; n++) {
        double o[3], d[3], o_err[3], d_err[3];
        for (int k = 0; k < 3; k++) {
            o[k] = draw_number(&rng);
            d[k] = draw_number(&rng);
            o_err[k] = fabs(draw_number(&rng));
            o_err[k] = ldexp(o_err[k], -(int)rng_below(&rng, 50));
            d_err[k] = fabs(draw_number(&rng));
            d_err[k] = ldexp(d_err[k], -(int)rng_below(&rng, 20));
        }
        const struct early_ray ray = early_ray_about(o, d, o_err, d_err);
        expect_axes(&ray, d);
        assert_memory_equal(ray.o, o, sizeof o);
        const double z = fabs(d[ray.kz]) - d_err[ray.kz];
        const double turn = fmax(d_err[ray.kx], d_err[ray.ky]) + d_err[ray.kz];
        const double move = fmax(o_err[ray.kx], o_err[ray.ky]) + o_err[ray.kz];
        if (z > 0 && turn / z < 0x1p-10) {
            const double h = turn / z;
            assert_true(ray.s[0] == d[ray.kx] / d[ray.kz] && ray.s[1] == d[ray.ky] / d[ray.kz]);
            assert_true(fabs(ray.bound / (EARLY_BOUND * (1 + h / EARLY_SHARE)) - 1) < 1e-12);
            assert_true(fabs(ray.beside / (EARLY_BESIDE * (1 + h / EARLY_SHARE)) - 1) < 1e-12);
            assert_true(move == 0 ? ray.more == 0
                                  : fabs(ray.more / (1.01 * move / (EARLY_OWN + h)) - 1) < 1e-12);
            known++;
        } else {
            assert_true(isinf(ray.bound) && isinf(ray.beside));
            assert_true(ray.more == 0 && ray.s[0] == 0 && ray.s[1] == 0);
            open++;
        }
    }
    assert_true(known > 2000 && open > 2000);
    /* At the border itself: 2^-10 of the axis is too much; so is an axis that may be 0. */
    for (int k = 0; k < 3; k++) {
        double o[3] = {1, 2, 3}, d[3] = {0, 0, 0}, err[3] = {0, 0, 0}, none[3] = {0, 0, 0};
        d[k] = -1;
        err[(k + 1) % 3] = 0x1p-10;
        assert_true(isinf(early_ray_about(o, d, none, err).bound));
        err[(k + 1) % 3] = nextafter(0x1p-10, 0);
        assert_true(early_ray_about(o, d, none, err).bound < 1);
        err[(k + 1) % 3] = 0;
        err[k] = 1;
        assert_true(isinf(early_ray_about(o, d, none, err).bound));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kernels_drop_by_definition),
        cmocka_unit_test(the_last_that_runs_is_the_best),
        cmocka_unit_test(rays_are_sheared_along_their_largest_axis),
        cmocka_unit_test(errors_widen_the_bounds_by_their_formulas),
    };
    return cmocka_run_group_tests_name("oracle_kernels", tests, NULL, NULL);
}
