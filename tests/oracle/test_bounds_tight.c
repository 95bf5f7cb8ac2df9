/* The bound of t where running errors are far too wide and where what it leaves out of them would
 * show: small triangles from afar, down to those whose sides are as short as rounding moves them.
 * Legal evaluations (tests/exact/legal.h) are searched for the worst t. Prints the largest error
 * over bound, with how small the triangle was; fails above 1, and where no error comes within a
 * third.
 */
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

#define SIZES 20u /* 1 to 2^-19 of the distance */

static uint64_t pairs_each(void)
{
    return getenv("RAYDIFF_SLOW") ? 8000 : 160;
}

/* Triangles at most 2^-size across at a distance of about 1, of any slope and shape, some of them
 * with the ray along an axis or from the world's origin. */
static void draw(struct rng *rng, uint32_t size, struct gmp_pair *pair, struct trials_trial *out)
{
    double target[3], a = (double)rng_float(rng), b = (1 - a) * (double)rng_float(rng);
    float length = ldexpf(1, -(int)size);
    uint32_t thin = rng_below(rng, 6), plain = rng_below(rng, 6);
    for (int k = 0; k < 3; k++) {
        float centre = rng_range(rng, -1, 1);
        out->ray.org[k] = plain == 0 ? 0 : rng_range(rng, -1, 1);
        if (plain == 1 && k < 2)
            centre = out->ray.org[k];
        for (int c = 0; c < 3; c++)
            out->v[c][k] =
                centre + length * rng_range(rng, -1, 1) * (thin == (uint32_t)k ? 0.1f : 1);
        target[k] = (1 - a - b) * (double)out->v[0][k] + a * (double)out->v[1][k] +
                    b * (double)out->v[2][k];
        out->ray.dir[k] = (float)(target[k] - (double)out->ray.org[k]);
    }
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
    trial_truth(pair, out);
}

struct tight_row {
    double most;
    uint32_t size; /* of the triangle */
    uint64_t evaluations, bounded;
};

static double over_of(const struct trials_trial *trial, enum twin_formula formula,
                      const struct twin *twin, struct legal *legal, struct tight_row *row)
{
    struct nearness near;
    struct evaluation evaluation =
        legal_evaluate(legal, formula, &trial->ray, (float(*)[3])trial->v);
    const char *broken = trial_broken(trial, formula, twin, &evaluation, &near);
    row->evaluations++;
    if (broken) {
        print_pair(&trial->ray, trial->v);
        fail_msg("%s", broken);
    }
    return near.t;
}

/* From the choices that the last evaluation made, keeps each change of one operation that takes t
 * farther off. */
static double climb(const struct trials_trial *trial, enum twin_formula formula,
                    const struct twin *twin, struct legal *legal, double most,
                    struct tight_row *row)
{
    static const uint8_t other[] = {LEGAL_LOW, LEGAL_HIGH, LEGAL_FUSE};
    uint32_t count = legal->count < LEGAL_MOST ? legal->count : LEGAL_MOST;
    legal->style = LEGAL_CHOSEN;
    for (uint32_t i = 0; i < count; i++)
        for (size_t n = 0; n < ARRAY_COUNT(other); n++) {
            uint8_t before = legal->choice[i];
            legal->choice[i] = other[n];
            double over = over_of(trial, formula, twin, legal, row);
            if (over > most)
                most = over;
            else
                legal->choice[i] = before;
        }
    return most;
}

static void try_pair(const struct trials_trial *trial, uint32_t size, size_t f, size_t r,
                     uint64_t index, struct tight_row *row)
{
    static const enum legal_style styles[] = {LEGAL_ALL_NEAREST, LEGAL_ALL_LOW, LEGAL_ALL_HIGH,
                                              LEGAL_RANDOM};
    struct twin twin =
        twin_eval(formulas[f].formula, roundings[r].rounding, &trial->ray, (float(*)[3])trial->v);
    struct legal legal = {
        .rounding = roundings[r].rounding, .fuses = roundings[r].fuses, .rng = rng_make(index, r)};
    double most = 0;
    bool searched = roundings[r].rounding.div > 1 && index % 8 == 0 && isfinite(twin.t_err);
    for (size_t s = 0; s < ARRAY_COUNT(styles) && (s == 0 || r > 0); s++) {
        legal.style = styles[s];
        most = fmax(most, over_of(trial, formulas[f].formula, &twin, &legal, row));
        if (searched)
            most = fmax(most, climb(trial, formulas[f].formula, &twin, &legal, most, row));
    }
    row->bounded += isfinite(twin.t_err) ? 1 : 0;
    if (most > row->most)
        row->size = size;
    row->most = fmax(row->most, most);
}

static void small_triangles_from_afar(void **state)
{
    (void)state;
    static struct tight_row row[ARRAY_COUNT(roundings)][ARRAY_COUNT(formulas)];
    struct gmp_pair pair;
    struct rng rng = rng_make(131, 0);
    exact_gmp_init(&pair);
    for (uint64_t i = 0; i < pairs_each() * SIZES; i++) {
        struct trials_trial trial;
        uint32_t size = (uint32_t)(i / 8 % SIZES);
        draw(&rng, size, &pair, &trial);
        for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
            for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
                try_pair(&trial, size, f, r, i, &row[r][f]);
    }
    exact_gmp_clear(&pair);
    print_message("%-11s %-14s %6s %9s %12s %9s\n", "rounding", "formula", "t", "size",
                  "evaluations", "bounded");
    for (size_t r = 0; r < ARRAY_COUNT(roundings); r++)
        for (size_t f = 0; f < ARRAY_COUNT(formulas); f++) {
            print_message("%-11s %-14s %6.3f     2^-%-2u %12llu %9llu\n", roundings[r].name,
                          formulas[f].name, row[r][f].most, row[r][f].size,
                          (unsigned long long)row[r][f].evaluations,
                          (unsigned long long)row[r][f].bounded);
            assert_true(row[r][f].most > 1.0 / 3);
            assert_true(row[r][f].bounded > pairs_each() * SIZES / 4);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(small_triangles_from_afar)};
    return cmocka_run_group_tests_name("bounds_tight", tests, NULL, NULL) ? 1 : 0;
}
