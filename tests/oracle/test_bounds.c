/* The twins' bounds hold: for every formula and rounding, on pairs of every kind, evaluations as
 * bad as the rounding allows are compared with the exact truth. Prints the largest error over
 * bound. */
#include "tests/exact/trials.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/support/stand.h"

static uint64_t pairs_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 20000 : 300;
}

static void must_hold(const char *broken, const struct trials_trial *trial, size_t f, size_t r,
                      int kind)
{
    if (!broken)
        return;
    print_pair(&trial->ray, trial->v);
    fail_msg("%s, rounding %s, %s: broken: %s", formulas[f].name, roundings[r].name,
             trial_kind(kind), broken);
}

/* The judge takes E for the error of the distance to a box as well: ref/judge/judge_lost.c. */
static const char *box_entry_broken(const struct twin *twin, struct rounding rounding)
{
    double least = (2.0 * rounding.add + rounding.div) * 0x1p-24 * fabs(twin->t_near);
    return twin->t_err < least ? "E covers the entry of a box" : NULL; /* NaN: infinite, too */
}

struct bounds_tally {
    struct nearness most;
    uint64_t evaluations, bounded, certain;
};

static void count(struct bounds_tally *tally, const struct twin *twin, const struct nearness *near)
{
    tally->evaluations++;
    tally->bounded += isfinite(twin->t_err) ? 1 : 0;
    tally->certain += twin->certain;
    tally->most.t = fmax(tally->most.t, near->t);
    tally->most.u = fmax(tally->most.u, near->u);
    tally->most.v = fmax(tally->most.v, near->v);
}

static void check_pair(const struct trials_trial *trial, size_t f, size_t r, int kind,
                       uint64_t index, struct bounds_tally *tally)
{
    static const enum legal_style styles[] = {LEGAL_ALL_NEAREST, LEGAL_ALL_LOW, LEGAL_ALL_HIGH,
                                              LEGAL_RANDOM, LEGAL_RANDOM};
    enum twin_formula formula = formulas[f].formula;
    struct twin twin =
        twin_eval(formula, roundings[r].rounding, &trial->ray, (float(*)[3])trial->v);
    struct legal legal = {
        .rounding = roundings[r].rounding, .fuses = roundings[r].fuses, .rng = rng_make(index, r)};
    struct nearness near;
    must_hold(box_entry_broken(&twin, roundings[r].rounding), trial, f, r, kind);
    for (size_t s = 0; s < ARRAY_COUNT(styles); s++) {
        legal.style = styles[s];
        struct evaluation evaluation =
            legal_evaluate(&legal, formula, &trial->ray, (float(*)[3])trial->v);
        must_hold(trial_broken(trial, formula, &twin, &evaluation, &near), trial, f, r, kind);
        count(tally, &twin, &near);
        if (r == 0)
            break; /* IEEE leaves no choice */
    }
    if (r > 0 && index % 16 == 0) {
        must_hold(trial_worsen(trial, formula, &twin, &legal, &near), trial, f, r, kind);
        count(tally, &twin, &near);
    }
}

static void bounds_hold_for_every_legal_evaluation(void **state)
{
    (void)state;
    static struct bounds_tally tally[ARRAY_COUNT(roundings)][ARRAY_COUNT(formulas)];
    struct gmp_pair pair;
    exact_gmp_init(&pair);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t i = 0; i < pairs_each(); i++) {
            struct trials_trial trial;
            trial_make(kind, i, &pair, &trial);
            for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
                for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
                    check_pair(&trial, f, r, kind, i, &tally[r][f]);
        }
    exact_gmp_clear(&pair);
    print_message("%d kinds, %llu pairs each; largest error over bound\n", TRIAL_KINDS,
                  (unsigned long long)pairs_each());
    print_message("%-11s %-14s %6s %6s %6s %12s %9s %9s\n", "rounding", "formula", "t", "u", "v",
                  "evaluations", "bounded", "certain");
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
            const struct bounds_tally *n = &tally[r][f];
            print_message("%-11s %-14s %6.3f %6.3f %6.3f %12llu %9llu %9llu\n", roundings[r].name,
                          formulas[f].name, n->most.t, n->most.u, n->most.v,
                          (unsigned long long)n->evaluations, (unsigned long long)n->bounded,
                          (unsigned long long)n->certain);
            /* Not vacuous: bounds are finite, hits certain, and errors come near; of t, whose
             * bound is to be tight, within a third. */
            assert_true(n->bounded > n->evaluations / 4 && n->certain > n->evaluations / 100);
            assert_true(n->most.t > 1.0 / 3 && n->most.u > 0.1 && n->most.v > 0.1);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold_for_every_legal_evaluation),
    };
    return cmocka_run_group_tests_name("bounds", tests, NULL, NULL) ? 1 : 0;
}
