/* The oracle against GMP rationals, pair by pair, over all kinds of tests/exact/oracle_cases.c. A
 * few thousand pairs per kind; RAYDIFF_SLOW=1: 10^6. */
#include "ref/oracle/internal.h"
#include "tests/exact/exact_gmp.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static void print_pair(const char *what, const char *kind, const struct ray *ray, float v[3][3])
{
#pragma omp critical
    printf("%s, kind %s: o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a] v=(%a,%a,%a) (%a,%a,%a) (%a,%a,%a)\n",
           what, kind, (double)ray->org[0], (double)ray->org[1], (double)ray->org[2],
           (double)ray->dir[0], (double)ray->dir[1], (double)ray->dir[2], (double)ray->tmin,
           (double)ray->tmax, (double)v[0][0], (double)v[0][1], (double)v[0][2], (double)v[1][0],
           (double)v[1][1], (double)v[1][2], (double)v[2][0], (double)v[2][1], (double)v[2][2]);
}

struct pairs_tally {
    size_t faults, pairs, class[ORACLE_CLASS_COUNT], exact;
};

/* Ray i against its own triangle and the next one, which some kinds relate to it. */
static void check_batch(const struct oracle_case *kind, const struct oracle_batch *batch,
                        struct pairs_tally *tally)
{
    struct gmp_pair want;
    exact_gmp_init(&want);
    for (uint32_t i = 0; i < BATCH; i++)
        for (uint32_t next = 0; next < 2; next++) {
            struct oracle_pair got;
            uint32_t prim = (i + next) % BATCH;
            float v[3][3];
            scene_tri(&batch->scene, prim, v);
            oracle_pair(batch->oracle, &batch->ray[i], prim, &got);
            exact_gmp_pair(&batch->ray[i], v, &want);
            const char *fault = pair_fault(&batch->ray[i], &got, &want);
            if (fault && tally->faults++ == 0)
                print_pair(fault, kind->name, &batch->ray[i], v);
            tally->pairs++;
            tally->class[got.class]++;
            tally->exact += !got.by_filter;
        }
    exact_gmp_clear(&want);
}

static void oracle_pair_agrees_with_rationals(void **state)
{
    (void)state;
    size_t class[ORACLE_CLASS_COUNT] = {0}, faults = 0;
    for (int k = 0; k < ORACLE_CASES; k++) {
        const struct oracle_case *kind = &oracle_cases[k];
        size_t batches = count_per_kind(4000) / (2 * BATCH);
        struct pairs_tally all = {0};
#pragma omp parallel for schedule(dynamic, 8)
        for (size_t b = 0; b < batches; b++) {
            struct oracle_batch batch;
            struct pairs_tally tally = {0};
            batch_make(kind, b, &batch);
            check_batch(kind, &batch, &tally);
            batch_free(&batch);
#pragma omp critical
            {
                all.faults += tally.faults;
                all.pairs += tally.pairs;
                all.exact += tally.exact;
                for (int c = 0; c < ORACLE_CLASS_COUNT; c++)
                    all.class[c] += tally.class[c];
            }
        }
        printf("%-13s %zu pairs, %zu faults, %zu left the filter:", kind->name, all.pairs,
               all.faults, all.exact);
        for (int c = 0; c < ORACLE_CLASS_COUNT; c++) {
            printf(" %s %zu", oracle_class_name((enum oracle_class)c), all.class[c]);
            class[c] += all.class[c];
        }
        printf("\n");
        faults += all.faults;
    }
    assert_int_equal(faults, 0);
    for (int c = 0; c < ORACLE_CLASS_COUNT; c++) /* the kinds together show every class */
        assert_true(class[c] > 100);
}

/* Sign of t_a - t_b over all pairs of hits of a ray. */
static size_t compare_faults(const struct oracle_batch *batch, size_t *ties)
{
    struct gmp_pair want[BATCH];
    size_t faults = 0;
    for (uint32_t i = 0; i < BATCH; i++)
        exact_gmp_init(&want[i]);
    for (uint32_t i = 0; i < BATCH; i++) {
        for (uint32_t p = 0; p < BATCH; p++) {
            float v[3][3];
            scene_tri(&batch->scene, p, v);
            exact_gmp_pair(&batch->ray[i], v, &want[p]);
        }
        for (uint32_t a = 0; a < BATCH; a++)
            for (uint32_t b = 0; b < BATCH; b++) {
                bool hits = true;
                for (int n = 0; n < 2; n++) {
                    enum oracle_class class = want[n ? a : b].class;
                    hits = hits && (class == ORACLE_INSIDE || class == ORACLE_EDGE ||
                                    class == ORACLE_VERTEX);
                }
                if (!hits)
                    continue;
                int sign = mpq_cmp(want[a].t, want[b].t);
                sign = (sign > 0) - (sign < 0);
                faults += oracle_compare(batch->oracle, &batch->ray[i], a, b) != sign;
                *ties += a != b && sign == 0;
            }
    }
    for (uint32_t i = 0; i < BATCH; i++)
        exact_gmp_clear(&want[i]);
    return faults;
}

static void oracle_compare_agrees_with_rationals(void **state)
{
    (void)state;
    size_t faults = 0, ties = 0, batches = count_per_kind(4000) / (BATCH * BATCH);
    for (int k = 0; k < ORACLE_CASES; k++)
#pragma omp parallel for schedule(dynamic, 2) reduction(+ : faults, ties)
        for (size_t b = 0; b < batches; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[k], 1000 + b, &batch);
            faults += compare_faults(&batch, &ties);
            batch_free(&batch);
        }
    printf("%zu exact ties\n", ties);
    assert_int_equal(faults, 0);
    assert_true(ties > 1000);
}

/* t as text, read back by GMP. */
static void oracle_rational_is_t_in_lowest_terms(void **state)
{
    (void)state;
    size_t written = 0;
    for (int k = 0; k < ORACLE_CASES; k++)
        for (uint64_t b = 0; b < 20; b++) {
            struct oracle_batch batch;
            struct gmp_pair want;
            batch_make(&oracle_cases[k], 2000 + b, &batch);
            exact_gmp_init(&want);
            for (uint32_t i = 0; i < BATCH; i++) {
                char text[1200];
                float v[3][3];
                scene_tri(&batch.scene, i, v);
                exact_gmp_pair(&batch.ray[i], v, &want);
                bool hit = want.point && want.class != ORACLE_MISS;
                assert_int_equal(oracle_rational(batch.oracle, &batch.ray[i], i, text, sizeof text),
                                 hit);
                if (!hit)
                    continue;
                char *power = strstr(text, "*2^");
                mpq_t got, scale;
                mpq_inits(got, scale, NULL);
                long twos = power ? strtol(power + 3, NULL, 10) : 0;
                if (power)
                    *power = 0;
                assert_int_equal(mpq_set_str(got, text, 10), 0);
                mpq_set(scale, got);
                mpq_canonicalize(scale);
                assert_int_equal(mpz_cmp(mpq_denref(scale), mpq_denref(got)), 0);
                if (twos > 0)
                    mpq_mul_2exp(got, got, (mp_bitcnt_t)twos);
                else
                    mpq_div_2exp(got, got, (mp_bitcnt_t)-twos);
                assert_int_equal(mpq_cmp(got, want.t), 0);
                assert_false(oracle_rational(batch.oracle, &batch.ray[i], i, text, 3) &&
                             strlen(text) > 2);
                mpq_clears(got, scale, NULL);
                written++;
            }
            exact_gmp_clear(&want);
            batch_free(&batch);
        }
    assert_true(written > 500);
}

static void what_is_no_class_has_no_name(void **state)
{
    (void)state;
    for (int a = 0; a < ORACLE_CLASS_COUNT; a++)
        for (int b = 0; b <= ORACLE_CLASS_COUNT; b++)
            assert_int_equal(strcmp(oracle_class_name((enum oracle_class)a),
                                    oracle_class_name((enum oracle_class)b)) == 0,
                             a == b);
    assert_string_equal(oracle_class_name(ORACLE_CLASS_COUNT), "unknown");
}

/* As many threads as asked for, or as OpenMP has; none that would find nothing to do, but one. */
static void a_team_has_work_for_all(void **state)
{
    (void)state;
    const int all = omp_get_max_threads();
    omp_set_num_threads(5);
    for (unsigned asked = 0; asked < 20; asked++)
        for (size_t parts = 0; parts < 20; parts++) {
            size_t most = asked ? asked : 5;
            assert_int_equal(oracle_team(parts, asked),
                             parts == 0 ? 1 : (int)(parts < most ? parts : most));
        }
    assert_int_equal(oracle_team((size_t)1 << 40, 7), 7);
    omp_set_num_threads(all);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(oracle_pair_agrees_with_rationals),
        cmocka_unit_test(oracle_compare_agrees_with_rationals),
        cmocka_unit_test(oracle_rational_is_t_in_lowest_terms),
        cmocka_unit_test(what_is_no_class_has_no_name),
        cmocka_unit_test(a_team_has_work_for_all),
    };
    return cmocka_run_group_tests_name("oracle", tests, NULL, NULL) ? 1 : 0;
}
