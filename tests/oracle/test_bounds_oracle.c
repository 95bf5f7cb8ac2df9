/* How much slack the constants of the oracle's double arithmetic have: what they bound against
 * rationals. Prints the largest error over bound; fails above 1. */
#include "tests/exact/trials.h"

#include "ref/oracle/early.h"
#include "ref/oracle/filter.h"
#include "ref/oracle/pair.c" /* for its own functions */
#include "ref/oracle/oracle_tree.h"

#include <math.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static uint64_t pairs_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 50000 : 1000;
}

/* [x, y, z] of exact differences, in rationals. */
struct rationals {
    mpq_t a[3][3], d[3], e1[3], e2[3], out, left, right;
};

static void each(struct rationals *q, void (*do_it)(mpq_t))
{
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            do_it(q->a[c][k]);
        do_it(q->d[k]);
        do_it(q->e1[k]);
        do_it(q->e2[k]);
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

static void difference(struct rationals *q, mpq_t out, float a, float b)
{
    mpq_set_d(out, (double)a);
    mpq_set_d(q->left, (double)b);
    mpq_sub(out, out, q->left);
}

static void fill(struct rationals *q, const struct trials_trial *trial)
{
    for (int k = 0; k < 3; k++) {
        mpq_set_d(q->d[k], (double)trial->ray.dir[k]);
        for (int c = 0; c < 3; c++)
            difference(q, q->a[c][k], trial->v[c][k], trial->ray.org[k]);
        difference(q, q->e1[k], trial->v[1][k], trial->v[0][k]);
        difference(q, q->e2[k], trial->v[2][k], trial->v[0][k]);
    }
}

/* Error over bound of `value`, which should be x . (y cross z). */
static double share(struct rationals *q, mpq_t x[3], mpq_t y[3], mpq_t z[3], double value,
                    double err)
{
    mpq_set_d(q->out, value);
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        mpq_mul(q->left, y[i], z[j]);
        mpq_mul(q->right, y[j], z[i]);
        mpq_sub(q->left, q->left, q->right);
        mpq_mul(q->left, q->left, x[k]);
        mpq_sub(q->out, q->out, q->left);
    }
    double off = fabs(mpq_get_d(q->out));
    return off > 0 ? off / err : 0;
}

static void filter_has_this_much_slack(void **state)
{
    (void)state;
    struct rationals q;
    struct gmp_pair pair;
    double most[3] = {0, 0, 0};
    each(&q, init);
    exact_gmp_init(&pair);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t n = 0; n < pairs_each(); n++) {
            struct trials_trial trial;
            struct filter f;
            trial_make(kind, n, &pair, &trial);
            filter_edges(&trial.ray, trial.v, &f);
            filter_plane(&f);
            fill(&q, &trial);
            for (int c = 0; c < 3; c++)
                most[0] = fmax(most[0], share(&q, q.d, q.a[(c + 1) % 3], q.a[(c + 2) % 3], f.w[c],
                                              f.w_err[c]));
            most[1] = fmax(most[1], share(&q, q.d, q.e1, q.e2, f.det, f.det_err));
            most[2] = fmax(most[2], share(&q, q.a[0], q.e1, q.e2, f.t, f.t_err));
        }
    exact_gmp_clear(&pair);
    each(&q, clear);
    print_message("oracle's filter, 9 * 2^-53: largest error over bound w %.3f, D %.3f, T %.3f, of "
                  "%llu pairs\n",
                  most[0], most[1], most[2], (unsigned long long)(TRIAL_KINDS * pairs_each()));
    for (int i = 0; i < 3; i++)
        assert_true(most[i] <= 1 && most[i] > 0.1);
}

/* --- areas and enclosures --------------------------------------------------------------------- */

/* Error of a component of the normal over what filter_has_area allows it. */
static double area_share(struct rationals *q, const struct trials_trial *trial, int k)
{
    int i = (k + 1) % 3, j = (k + 2) % 3;
    double e1[2], e2[2];
    const int axis[2] = {i, j};
    for (int n = 0; n < 2; n++) {
        e1[n] = (double)trial->v[1][axis[n]] - (double)trial->v[0][axis[n]];
        e2[n] = (double)trial->v[2][axis[n]] - (double)trial->v[0][axis[n]];
    }
    double left = e1[0] * e2[1], right = e1[1] * e2[0];
    mpq_mul(q->left, q->e1[i], q->e2[j]);
    mpq_mul(q->right, q->e1[j], q->e2[i]);
    mpq_sub(q->left, q->left, q->right);
    mpq_set_d(q->out, left - right);
    mpq_sub(q->out, q->out, q->left);
    double off = fabs(mpq_get_d(q->out));
    return off > 0 ? off / (FILTER_FLAT * (fabs(left) + fabs(right))) : 0;
}

/* How much of its widening an enclosure needs: the filter's bounds taken as exact numbers, without
 * the slack that they have. */
static double enclosure_share(struct rationals *q, const struct filter *f)
{
    double lo, hi, d = fabs(f->det), t = fabs(f->t);
    enclose(f, &lo, &hi);
    double inner = fmin(fabs(lo), fabs(hi)), outer = fmax(fabs(lo), fabs(hi)), most = 0;
    for (int n = 0; n < 2; n++) { /* 0: the lower end, (t - e) / (d + e'); 1: the upper */
        mpq_set_d(q->left, t);
        mpq_set_d(q->right, n ? f->t_err : -f->t_err);
        mpq_add(q->left, q->left, q->right);
        mpq_set_d(q->out, d);
        mpq_set_d(q->right, n ? -f->det_err : f->det_err);
        mpq_add(q->out, q->out, q->right);
        mpq_div(q->left, q->left, q->out);
        double exact = mpq_get_d(q->left);
        mpq_set_d(q->right, n ? outer : inner);
        mpq_sub(q->right, n ? q->right : q->left, n ? q->left : q->right);
        double room = mpq_get_d(q->right) / (exact * ENCLOSE_PAD); /* 1: none was needed */
        most = fmax(most, 1 - room);
    }
    return most;
}

static void enclosures_have_this_much_slack(void **state)
{
    (void)state;
    struct rationals q;
    struct gmp_pair pair;
    double area = 0, needed = 0, widest = 0;
    uint64_t refused = 0;
    each(&q, init);
    exact_gmp_init(&pair);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t n = 0; n < pairs_each(); n++) {
            struct trials_trial trial;
            struct filter f;
            double lo, hi;
            trial_make(kind, n, &pair, &trial);
            filter_edges(&trial.ray, trial.v, &f);
            filter_plane(&f);
            fill(&q, &trial);
            for (int k = 0; k < 3; k++)
                area = fmax(area, area_share(&q, &trial, k));
            if (filter_sign(f.det, f.det_err) == 0 || filter_sign(f.t, f.t_err) == 0)
                continue;
            needed = fmax(needed, enclosure_share(&q, &f));
            enclose(&f, &lo, &hi);
            double width = (hi - lo) / fmin(fabs(lo), fabs(hi));
            if (width <= NARROW)
                widest = fmax(widest, width);
            else
                refused++;
        }
    exact_gmp_clear(&pair);
    each(&q, clear);
    print_message("oracle's areas, 6 * 2^-53: largest error over bound %.3f\n", area);
    print_message("oracle's enclosures of t, 2^-50: needed of it %.3f\n", needed);
    print_message(
        "oracle's enclosures kept, 2^-40: widest %.3f of it; made anew from integers %llu\n",
        widest / NARROW, (unsigned long long)refused);
    assert_true(area <= 1 && area > 0.1);
    assert_true(needed <= 1 && needed > 0.05);
    assert_true(widest > 0 && refused > 0);
}

/* --- the first look --------------------------------------------------------------------------- */

static double largest_of(const struct trials_trial *trial)
{
    double most = 0;
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++)
            most = fmax(most, fabs((double)trial->v[c][k] - (double)trial->ray.org[k]));
    return most;
}

/* Does the first look drop the triangle, with its bound of products times `factor`, and that of
 * places times its root? */
static bool dropped(const struct trials_trial *trial, double factor)
{
    double v[3][3][1 + EARLY_PAD] = {0};
    struct early_soup soup;
    struct early_ray ray = early_ray_make(&trial->ray);
    for (int c = 0; c < 3; c++)
        for (int k = 0; k < 3; k++) {
            v[c][k][0] = (double)trial->v[c][k];
            soup.v[c][k] = v[c][k];
        }
    return early_kernels[0].look(&soup, &ray, 0, 1, largest_of(trial) * sqrt(factor)) == 0;
}

/* A ray that meets an edge or a vertex exactly, though its shear and products are rounded. */
static void draw_exact(struct rng *rng, struct trials_trial *out)
{
    int feature = (int)rng_below(rng, 3), bits = 4 + (int)rng_below(rng, 8);
    float stretch = (float)(1 + 2 * rng_below(rng, 512));
    for (int k = 0; k < 3; k++) {
        for (int c = 0; c < 3; c++)
            out->v[c][k] = (float)((int)rng_below(rng, 1u << bits) - (1 << (bits - 1)));
        float at = out->v[0][k];
        if (feature > 0)
            at = 0.5f * (at + out->v[1][k]);
        out->ray.org[k] = (float)((int)rng_below(rng, 1u << bits) - (1 << (bits - 1)));
        out->ray.dir[k] = stretch * (at - out->ray.org[k]);
    }
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
}

static void first_look_has_this_much_slack(void **state)
{
    (void)state;
    double broke = 0;
    uint64_t trials = 0;
    struct rng rng = rng_make(41, 0);
    for (uint64_t n = 0; n < 200 * pairs_each(); n++) {
        struct trials_trial trial;
        draw_exact(&rng, &trial);
        if (trial.ray.dir[0] == 0 && trial.ray.dir[1] == 0 && trial.ray.dir[2] == 0)
            continue;
        trials++;
        assert_false(dropped(&trial, 1));
        while (broke < 1 && dropped(&trial, broke + 1.0 / 512))
            broke += 1.0 / 512;
    }
    print_message(
        "oracle's first look, 72 and 8 * 2^-53: dropped an exact hit at %.2f and %.2f * 2^-53, "
        "of %llu\n",
        72 * broke, 8 * sqrt(broke), (unsigned long long)trials);
    assert_true(broke > 0); /* else the search sees nothing */
}

/* --- the tree's planes ------------------------------------------------------------------------ */

static void planes_have_this_much_slack(void **state)
{
    (void)state;
    double most = 0;
    struct rng rng = rng_make(42, 0);
    mpq_t t, b, d;
    mpq_inits(t, b, d, NULL);
    for (uint64_t n = 0; n < 20 * pairs_each(); n++) {
        float plane = rng_range(&rng, -2, 2), o = rng_range(&rng, -1, 1) * 0x1p-30f;
        float dir = 1 + rng_float(&rng);
        double computed = ((double)plane - (double)o) * (1 / (double)dir);
        mpq_set_d(t, (double)plane);
        mpq_set_d(b, (double)o);
        mpq_set_d(d, (double)dir);
        mpq_sub(t, t, b);
        mpq_div(t, t, d);
        double size = fabs(mpq_get_d(t));
        mpq_set_d(b, computed);
        mpq_sub(t, t, b);
        most = fmax(most, fabs(mpq_get_d(t)) / (size * TREE_PAD));
    }
    mpq_clears(t, b, d, NULL);
    print_message("oracle's tree, 2^-49: largest error of a plane over it %.3f, of %llu\n", most,
                  (unsigned long long)(20 * pairs_each()));
    assert_true(most < 0.5 && most > 0.1); /* half goes to the entry, half to the exit */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filter_has_this_much_slack),
        cmocka_unit_test(enclosures_have_this_much_slack),
        cmocka_unit_test(first_look_has_this_much_slack),
        cmocka_unit_test(planes_have_this_much_slack),
    };
    return cmocka_run_group_tests_name("bounds_oracle", tests, NULL, NULL) ? 1 : 0;
}
