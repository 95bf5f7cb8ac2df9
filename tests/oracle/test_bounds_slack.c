/* How much slack the roundings' constants have: each is tightened step by step, alone, until an
 * evaluation breaks a bound. Prints the table; fails if a bound breaks untightened, or if none
 * breaks that should, which would mean that the search sees nothing. */
/* The twin once more, with a band that can be turned. */
static double band = 0x1p-23;
#define EMBREE_BAND band
#include "ref/twin/twin.c"

#include "tests/exact/trials.h"

#include <stdio.h>
#include <stdlib.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

static const enum twin_formula formulas[] = {
    TWIN_MT, TWIN_WOOP, TWIN_PLUECKER, TWIN_BALDWIN_WEBBER, TWIN_EMBREE, TWIN_EMBREE_ROBUST};
static const char *const formula_name[] = {"mt",     "woop",         "pluecker", "baldwin_webber",
                                           "embree", "embree_robust"};

enum constant { ADD, MUL, DIV, TINY, ALL, BAND };
static const char *const constant_name[] = {"add",  "mul",          "div",
                                            "tiny", "all relative", "robust band"};

#define STEPS 20 /* of 1/20 of the constant */

struct slack_row {
    const char *rounding_name;
    struct rounding rounding;
    bool fuses;
    enum constant constant;
    int broken; /* fewest steps that broke; STEPS + 1: none did */
    const char *what;
    size_t formula;
    uint64_t trials;
};

#define ROWS 18
static void fill(struct slack_row row[ROWS])
{
    static const struct {
        const char *name;
        struct rounding rounding;
        bool fuses;
    } roundings[] = {{"ieee", ROUNDING_IEEE, false},
                     {"vulkan", ROUNDING_VULKAN, false},
                     {"embree", ROUNDING_EMBREE, true}};
    int n = 0;
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
        for (int c = ADD; c <= ALL; c++)
            row[n++] = (struct slack_row){roundings[r].name,
                                          roundings[r].rounding,
                                          roundings[r].fuses,
                                          (enum constant)c,
                                          STEPS + 1,
                                          "",
                                          0,
                                          0};
    row[n++] =
        (struct slack_row){"vulkan rte", ROUNDING_VULKAN_RTE, false, DIV, STEPS + 1, "", 0, 0};
    row[n++] = (struct slack_row){"flushed", ROUNDING_FLUSHED, false, TINY, STEPS + 1, "", 0, 0};
    row[n++] = (struct slack_row){"embree", ROUNDING_EMBREE, true, BAND, STEPS + 1, "", 0, 0};
    assert_int_equal(n, ROWS);
}

/* The rounding with the row's constant tightened. The others stay as they are. */
static struct rounding tightened(const struct slack_row *row, int steps)
{
    struct rounding k = row->rounding;
    double factor = 1.0 - (double)steps / STEPS;
    if (row->constant == ADD || row->constant == ALL)
        k.add *= factor;
    if (row->constant == MUL || row->constant == ALL)
        k.mul *= factor;
    if (row->constant == DIV || row->constant == ALL)
        k.div *= factor;
    if (row->constant == TINY)
        k.tiny *= factor;
    return k;
}

static const char *broken_at(const struct slack_row *row, int steps, size_t f,
                             const struct trials_trial *trial, struct legal *legal, bool search)
{
    struct rounding k = tightened(row, steps);
    band = row->constant == BAND ? 0x1p-23 * (1.0 - (double)steps / STEPS) : 0x1p-23;
    struct twin twin = twin_eval(formulas[f], k, &trial->ray, (float(*)[3])trial->v);
    struct nearness near;
    if (search)
        return trial_worsen(trial, formulas[f], &twin, legal, &near);
    struct evaluation evaluation =
        legal_evaluate(legal, formulas[f], &trial->ray, (float(*)[3])trial->v);
    return trial_broken(trial, formulas[f], &twin, &evaluation, &near);
}

/* One evaluation, or a search for the worst, with ever less tightening while it breaks. */
static void tighten(struct slack_row *row, size_t f, const struct trials_trial *trial,
                    uint64_t seed, enum legal_style style, bool search)
{
    row->trials++;
    while (row->broken > 0) {
        struct legal legal = {.rounding = row->rounding,
                              .fuses = row->fuses,
                              .style = style,
                              .rng = rng_make(seed, 5)};
        if (search) { /* from a random evaluation on */
            legal_evaluate(&legal, formulas[f], &trial->ray, (float(*)[3])trial->v);
            legal.style = LEGAL_CHOSEN;
        }
        const char *what = broken_at(row, row->broken - 1, f, trial, &legal, search);
        if (!what)
            return;
        row->broken--;
        row->what = what;
        row->formula = f;
    }
}

static uint64_t pairs_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 6000 : 300;
}

static void try_all(struct slack_row row[ROWS], const struct trials_trial *trial, uint64_t seed)
{
    static const enum legal_style styles[] = {LEGAL_ALL_LOW, LEGAL_ALL_HIGH, LEGAL_RANDOM};
    for (int n = 0; n < ROWS; n++)
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
            for (size_t s = 0; s < ARRAY_COUNT(styles); s++)
                tighten(&row[n], f, trial, seed, styles[s], false);
            if (seed % 64 == 0 && row[n].rounding_name[0] != 'i')
                tighten(&row[n], f, trial, seed, LEGAL_RANDOM, true);
        }
}

static void constants_have_this_much_slack(void **state)
{
    (void)state;
    static struct slack_row row[ROWS];
    struct gmp_pair pair;
    fill(row);
    exact_gmp_init(&pair);
    for (int kind = 0; kind < TRIAL_KINDS; kind++)
        for (uint64_t i = 0; i < pairs_each(); i++) {
            struct trials_trial trial;
            trial_make(kind, i, &pair, &trial);
            try_all(row, &trial, i);
        }
    exact_gmp_clear(&pair);
    print_message("%-11s %-13s %10s %10s %10s %10s  %s\n", "rounding", "constant", "proven", "held",
                  "broke", "trials", "broken first: what, in which formula");
    for (int n = 0; n < ROWS; n++) {
        const struct slack_row *r = &row[n];
        const double value[] = {
            r->rounding.add, r->rounding.mul, r->rounding.div, r->rounding.tiny, 1.0, 0x1p-23};
        double proven = value[r->constant], step = proven / STEPS;
        char broke[32] = "-";
        if (r->broken <= STEPS)
            snprintf(broke, sizeof broke, "%.4g", proven - r->broken * step);
        print_message("%-11s %-13s %10.4g %10.4g %10s %10llu  %s%s%s\n", r->rounding_name,
                      constant_name[r->constant], proven, proven - (r->broken - 1) * step, broke,
                      (unsigned long long)r->trials, r->what, *r->what ? ", " : "",
                      *r->what ? formula_name[r->formula] : "");
        assert_true(r->broken > 0); /* untightened, nothing may break */
        if (r->constant == ALL)     /* the bounds are not far too wide */
            assert_true(r->broken <= STEPS * 3 / 4);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constants_have_this_much_slack),
    };
    return cmocka_run_group_tests_name("bounds_slack", tests, NULL, NULL) ? 1 : 0;
}
