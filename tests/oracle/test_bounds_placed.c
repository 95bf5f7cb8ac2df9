/* The bounds of twins of placed triangles hold: transforms of every kind, pairs of every kind,
 * each formula and each rounding, evaluations as bad as the rounding allows against rationals.
 * Prints how near errors come to their bounds. */
#include "tests/exact/legal_operations.h"
#include "tests/exact/placed_trials.h"

#include "ref/twin/twin_replay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* it defines fail() as a macro */

#include "tests/support/stand.h"

#define OWN       6 /* formulas that are written here come first */
#define ROUNDINGS 4 /* Embree has transforms of its own */

static uint64_t pairs_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 4100 : 60;
}

static void print_instance(const struct exact_placed *placed)
{
    for (int i = 0; i < 3; i++)
        print_message("m%d %a %a %a %a\n", i, (double)placed->instance.m[i][0],
                      (double)placed->instance.m[i][1], (double)placed->instance.m[i][2],
                      (double)placed->instance.m[i][3]);
}

struct where {
    size_t f, r;
    int kind, pair_kind;
};

static void must_hold(const char *broken, const struct exact_placed *placed, struct where at)
{
    if (!broken)
        return;
    print_instance(placed);
    print_pair(&placed->trial.ray, placed->trial.v);
    fail_msg("%s, rounding %s, %s behind %s: broken: %s", formulas[at.f].name, roundings[at.r].name,
             trial_kind(at.pair_kind), placed_kind(at.kind), broken);
}

/* --- errors over bounds, by their sizes ------------------------------------------------------- */

#define BINS 400 /* of 1/400 */
struct sizes {
    uint64_t bin[BINS + 1], count;
    double most;
};

static void note(struct sizes *sizes, double x)
{
    sizes->bin[(size_t)(fmin(x, 1.0) * BINS)]++;
    sizes->count++;
    sizes->most = fmax(sizes->most, x);
}

static double share_of(const struct sizes *sizes, double share)
{
    uint64_t seen = 0;
    for (size_t i = 0; i <= BINS; i++) {
        seen += sizes->bin[i];
        if ((double)seen >= share * (double)sizes->count)
            return (double)(i + 1) / BINS;
    }
    return 1.0;
}

struct placed_tally {
    struct sizes t, u, v;
    uint64_t evaluations, bounded, certain, in_contract;
};

static struct placed_tally tally[ROUNDINGS][OWN];
static uint64_t sides[ROUNDINGS]; /* known */

static void count(struct placed_tally *n, const struct twin *twin, const struct nearness *near)
{
    n->evaluations++;
    n->certain += twin->certain;
    if (!isfinite(twin->t_err))
        return;
    n->bounded++;
    note(&n->t, near->t);
    note(&n->u, near->u);
    note(&n->v, near->v);
}

/* --- one pair --------------------------------------------------------------------------------- */

static double off(double value, struct sum exact)
{
    return fabs((value - exact.head) - exact.tail);
}

static const char *near_broken(const struct exact_placed *placed, const struct twin *twin)
{
    const struct truth *truth = &placed->trial.truth;
    if (!truth->point || !isfinite(twin->t_err))
        return NULL;
    if (!(off(twin->t_near, truth->t) <= twin->t_off) || !(4 * twin->t_off <= twin->t_err))
        return "t's near value";
    bool u = isinf(twin->u_err) || off(twin->u_near, truth->weight[1]) <= 0x1p-20 * twin->u_err;
    bool v = isinf(twin->v_err) || off(twin->v_near, truth->weight[2]) <= 0x1p-20 * twin->v_err;
    return u && v ? NULL : "u's or v's near value";
}

/* The judge takes E for the error of the distance to a box as well: ref/judge/judge_lost.c. */
static const char *box_entry_broken(const struct twin *twin, struct rounding rounding)
{
    double least = (2.0 * rounding.add + rounding.div) * 0x1p-24 * fabs(twin->t_near);
    return twin->t_err < least ? "E covers the entry of a box" : NULL; /* NaN: infinite, too */
}

/* The numbers of an evaluated ray against those that are promised. */
static const char *ray_broken(const struct exact_placed *placed, const struct twin_ray *promised,
                              const struct ray *ray)
{
    mpq_t off;
    bool within = true;
    mpq_init(off);
    for (int k = 0; k < 6; k++) {
        float value = k < 3 ? ray->org[k] : ray->dir[k - 3];
        double most = k < 3 ? promised->org_off[k] : promised->dir_off[k - 3];
        if (isinf(most))
            continue;
        mpq_set_d(off, (double)value);
        mpq_sub(off, off, k < 3 ? placed->org[k] : placed->dir[k - 3]);
        mpq_abs(off, off);
        within = within && exact_gmp_compare(off, most) <= 0;
    }
    mpq_clear(off);
    if (!within)
        return "a number of the ray";
    return promised->in_contract && !ray_in_contract(ray) ? "the contract of a ray" : NULL;
}

/* d . ((v1 - v0) x (v2 - v0)) as engines compute it, and exactly. */
static const char *side_broken(const struct exact_placed *placed, struct legal *legal,
                               const struct ray *ray, int side)
{
    float(*v)[3] = (float(*)[3])placed->trial.v, e1[3], e2[3], n[3];
    legal_subtract(legal, v[1], v[0], e1);
    legal_subtract(legal, v[2], v[0], e2);
    legal_cross(legal, e1, e2, n);
    float seen = legal_dot(legal, ray->dir, n);
    return side && (side != placed->side || (seen > 0) - (seen < 0) != side) ? "the side" : NULL;
}

static const char *axes_broken(const struct twin_ray *promised, const struct ray *ray)
{
    int axis[3][3], taken[3], orders = twin_placed_axes(TWIN_WOOP, promised, axis);
    bool found = false;
    twin_axes(TWIN_WOOP, ray, taken);
    for (int i = 0; i < orders; i++)
        found = found || memcmp(axis[i], taken, sizeof taken) == 0;
    return found || !promised->in_contract ? NULL : "the order of axes";
}

/* The replay, which is slow, of some pairs. */
static const char *replay_broken(const struct exact_placed *placed, const struct twin_ray *ray,
                                 struct where at, const struct evaluation *evaluation)
{
    const struct liberty liberty = {roundings[at.r].rounding, false};
    const double answer[3] = {(double)evaluation->t, (double)evaluation->u, (double)evaluation->v};
    struct replay_answer exact;
    memcpy(exact.lo, answer, sizeof answer);
    memcpy(exact.hi, answer, sizeof answer);
    bool is_answer = isfinite(evaluation->t) && isfinite(evaluation->u) && isfinite(evaluation->v);
    return !evaluation->accepted || !is_answer || !ray->in_contract ||
                   !pair_in_contract(&ray->world, placed->trial.v) ||
                   replay_can_answer_placed(formulas[at.f].formula, &liberty, ray,
                                            (float(*)[3])placed->trial.v, &exact)
               ? NULL
               : "a replay that cannot come to the answer";
}

static void check_formula(const struct exact_placed *placed, const struct twin_ray *ray,
                          struct where at, uint64_t index)
{
    static const enum legal_style styles[] = {LEGAL_ALL_NEAREST, LEGAL_ALL_LOW, LEGAL_ALL_HIGH,
                                              LEGAL_RANDOM, LEGAL_RANDOM};
    const struct trials_trial *trial = &placed->trial;
    enum twin_formula formula = formulas[at.f].formula;
    struct rounding rounding = roundings[at.r].rounding;
    struct twin twin = twin_eval_placed(formula, rounding, ray, (float(*)[3])trial->v);
    struct placed_tally *n = &tally[at.r][at.f];
    struct legal legal = {.rounding = rounding, .rng = rng_make(index, at.r)};
    struct nearness near;
    must_hold(box_entry_broken(&twin, rounding), placed, at);
    must_hold(near_broken(placed, &twin), placed, at);
    n->in_contract += ray->in_contract;
    for (size_t s = 0; s < ARRAY_COUNT(styles); s++) {
        legal.style = styles[s];
        struct evaluation evaluation = legal_evaluate_placed(&legal, formula, trial->place,
                                                             &trial->ray, (float(*)[3])trial->v);
        must_hold(trial_broken(trial, formula, &twin, &evaluation, &near), placed, at);
        count(n, &twin, &near);
        if (at.r == 0)
            break; /* IEEE leaves no choice */
    }
    if (index % 16 == 0) {
        legal.style = LEGAL_ALIKE;
        legal.seed = index;
        struct evaluation evaluation = legal_evaluate_placed(&legal, formula, trial->place,
                                                             &trial->ray, (float(*)[3])trial->v);
        must_hold(replay_broken(placed, ray, at, &evaluation), placed, at);
    }
    if (at.r > 0 && index % 32 == 0) {
        must_hold(trial_worsen(trial, formula, &twin, &legal, &near), placed, at);
        count(n, &twin, &near);
    }
}

static void check_pair(const struct exact_placed *placed, struct where at, uint64_t index)
{
    static const enum legal_style styles[] = {LEGAL_ALL_NEAREST, LEGAL_ALL_LOW, LEGAL_ALL_HIGH,
                                              LEGAL_RANDOM,      LEGAL_RANDOM,  LEGAL_RANDOM};
    for (at.r = 0; at.r < ROUNDINGS; at.r++) {
        struct rounding rounding = roundings[at.r].rounding;
        struct legal legal = {.rounding = rounding, .rng = rng_make(index, 77)};
        struct twin_ray ray;
        twin_ray_of(&placed->place, rounding, false, &placed->trial.ray, &ray);
        int side = twin_placed_side(rounding, &ray, (float(*)[3])placed->trial.v);
        sides[at.r] += side != 0;
        at.f = 0;
        for (size_t s = 0; s < ARRAY_COUNT(styles); s++) {
            legal.style = styles[s];
            struct ray one = legal_transform(&legal, &placed->place, &placed->trial.ray);
            must_hold(ray_broken(placed, &ray, &one), placed, at);
            must_hold(axes_broken(&ray, &one), placed, at);
            must_hold(side_broken(placed, &legal, &one, side), placed, at);
        }
        for (at.f = 0; at.f < OWN; at.f++)
            check_formula(placed, &ray, at, index);
    }
}

static void print_tally(void)
{
    print_message("%-11s %-14s %20s %20s %11s %8s %8s %8s\n", "", "", "t: half  99 %  most",
                  "u: half  99 %  most", "evaluations", "bounded", "certain", "contract");
    for (size_t r = 0; r < ROUNDINGS; r++)
        for (size_t f = 0; f < OWN; f++) {
            const struct placed_tally *n = &tally[r][f];
            print_message("%-11s %-14s %6.3f %6.3f %6.3f %6.3f %6.3f %6.3f %11llu %8llu %8llu "
                          "%8llu\n",
                          roundings[r].name, formulas[f].name, share_of(&n->t, 0.5),
                          share_of(&n->t, 0.99), n->t.most, share_of(&n->u, 0.5),
                          share_of(&n->u, 0.99), fmax(n->u.most, n->v.most),
                          (unsigned long long)n->evaluations, (unsigned long long)n->bounded,
                          (unsigned long long)n->certain, (unsigned long long)n->in_contract);
            /* Not vacuous, and not far too wide. */
            assert_true(n->bounded > n->evaluations / 3 && n->certain > n->evaluations / 20);
            assert_true(n->t.most > 0.3 && n->u.most > 0.3 && n->v.most > 0.2);
            assert_true(share_of(&n->t, 0.99) > 0.15 && share_of(&n->t, 0.5) > 0.02);
        }
}

static void bounds_hold_through_every_transform(void **state)
{
    (void)state;
    struct gmp_pair pair;
    struct exact_placed placed;
    uint64_t pairs = 0;
    exact_gmp_init(&pair);
    placed_init(&placed);
    for (int kind = 0; kind < PLACED_KINDS; kind++)
        for (int pair_kind = 0; pair_kind < TRIAL_KINDS; pair_kind++)
            for (uint64_t i = 0; i < pairs_each(); i++) {
                if (!placed_make(kind, pair_kind, i, &pair, &placed))
                    continue;
                pairs++;
                check_pair(&placed, (struct where){.kind = kind, .pair_kind = pair_kind}, i);
            }
    placed_clear(&placed);
    exact_gmp_clear(&pair);
    print_message("%llu pairs, the side is known of %llu, %llu, %llu, %llu; errors over bounds\n",
                  (unsigned long long)pairs, (unsigned long long)sides[0],
                  (unsigned long long)sides[1], (unsigned long long)sides[2],
                  (unsigned long long)sides[3]);
    for (size_t r = 0; r < ROUNDINGS; r++)
        assert_true(sides[r] > pairs / 2);
    print_tally();
    assert_true(pairs > pairs_each() * PLACED_KINDS * TRIAL_KINDS / 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_hold_through_every_transform),
    };
    return cmocka_run_group_tests_name("bounds_placed", tests, NULL, NULL) ? 1 : 0;
}
