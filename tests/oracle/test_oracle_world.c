/* The oracle of a world against GMP rationals, pair by pair, over kinds of transforms: class,
 * range, signs, enclosures, facing, what counts; the order of two hits; t as text. A few hundred
 * pairs a kind; RAYDIFF_SLOW=1: 10^6. */
#include "tests/exact/gmp_world.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

struct world_tally {
    size_t faults, pairs, exact, class[ORACLE_CLASS_COUNT], admission[ORACLE_ADMISSION_COUNT];
    size_t front, ties;
};

static void add(struct world_tally *all, const struct world_tally *one)
{
    all->faults += one->faults;
    all->pairs += one->pairs;
    all->exact += one->exact;
    all->front += one->front;
    all->ties += one->ties;
    for (int c = 0; c < ORACLE_CLASS_COUNT; c++)
        all->class[c] += one->class[c];
    for (int a = 0; a < ORACLE_ADMISSION_COUNT; a++)
        all->admission[a] += one->admission[a];
}

/* What is wrong with one pair beyond what oracle_pair states. */
static const char *standing_fault(const struct world_case *c, int ray, uint32_t prim,
                                  const struct oracle_pair *got, const struct gmp_pair *want,
                                  struct world_tally *tally)
{
    bool in_plane = got->class == ORACLE_IN_PLANE;
    if (!oracle_is_hit(got) && !in_plane)
        return NULL;
    if (!in_plane) {
        bool front = oracle_is_front(c->oracle, got, prim);
        const struct instance *at = &c->world.instance[world_instance_of(&c->world, prim)];
        bool flip = at->flags & ABI_INSTANCE_FLIP_FACING;
        tally->front += front;
        if (front != ((gmp_world_facing(&c->world, &c->ray[ray], prim) < 0) != flip))
            return "facing";
    }
    double weight[2][2];
    if (!in_plane)
        oracle_weights(c->oracle, &c->ray[ray], prim, weight[0], weight[1]);
    for (int i = 0; i < 2 && !in_plane; i++)
        if (exact_gmp_compare(want->weight[i + 1], weight[i][0]) < 0 ||
            exact_gmp_compare(want->weight[i + 1], weight[i][1]) > 0 ||
            weight[i][1] - weight[i][0] > 0x1p-50 * weight[i][1] + 0x1p-990)
            return "weights";
    enum oracle_admission admission =
        oracle_admit(c->oracle, &c->ray[ray], c->mode[ray], prim, got);
    tally->admission[admission]++;
    if (admission != gmp_world_admit(&c->world, &c->ray[ray], c->mode[ray], prim, want))
        return "admission";
    return NULL;
}

static void check_pairs(const struct world_turn *turn, const struct world_case *c,
                        struct world_tally *tally)
{
    struct gmp_pair want;
    exact_gmp_init(&want);
    for (int i = 0; i < WORLD_RAYS; i++)
        for (uint32_t prim = 0; prim < world_tri_count(&c->world); prim++) {
            struct oracle_pair got;
            oracle_pair(c->oracle, &c->ray[i], prim, &got);
            gmp_world_pair(&c->world, &c->ray[i], prim, &want);
            const char *fault = pair_fault(&c->ray[i], &got, &want);
            if (!fault)
                fault = standing_fault(c, i, prim, &got, &want, tally);
            if (fault && tally->faults++ == 0)
                printf("%s: %s, prim %u\n", turn->name, fault, prim);
            tally->pairs++;
            tally->class[got.class]++;
            tally->exact += !got.by_filter;
        }
    exact_gmp_clear(&want);
}

static struct world_tally over_worlds(const struct world_turn *turn, uint64_t seed, size_t worlds,
                                      void (*check)(const struct world_turn *turn,
                                                    const struct world_case *c,
                                                    struct world_tally *tally))
{
    struct world_tally all = {0};
#pragma omp parallel for schedule(dynamic, 1)
    for (size_t w = 0; w < worlds; w++) {
        struct world_case c;
        struct world_tally tally = {0};
        world_case_make(turn, seed + w, &c);
        check(turn, &c, &tally);
        world_case_free(&c);
#pragma omp critical(world_tally)
        add(&all, &tally);
    }
    return all;
}

static void pairs_agree_with_rationals(void **state)
{
    (void)state;
    struct world_tally sum = {0};
    for (int k = 0; k < WORLD_TURNS; k++) {
        struct world_tally all =
            over_worlds(&world_turns[k], 100, count_per_kind(6000) / 300 + 1, check_pairs);
        printf("%-9s %zu pairs, %zu left the filter:", world_turns[k].name, all.pairs, all.exact);
        for (int c = 0; c < ORACLE_CLASS_COUNT; c++)
            printf(" %s %zu", oracle_class_name((enum oracle_class)c), all.class[c]);
        printf("\n");
        /* What is not made to be on edges is decided by double, nearly always. */
        if (strcmp(world_turns[k].name, "turned") == 0)
            assert_true(all.exact < all.pairs / 4);
        add(&sum, &all);
    }
    assert_int_equal(sum.faults, 0);
    for (int c = 0; c < ORACLE_CLASS_COUNT; c++)
        assert_true(sum.class[c] > 100);
    for (int a = 0; a < ORACLE_ADMISSION_COUNT; a++) {
        printf("%s %zu ", oracle_admission_name((enum oracle_admission)a), sum.admission[a]);
        assert_true(sum.admission[a] > 50);
    }
    printf("front %zu\n", sum.front);
}

/* --- the order of hits, and texts ------------------------------------------------------------- */

static bool is_hit(const struct gmp_pair *pair)
{
    return pair->class == ORACLE_INSIDE || pair->class == ORACLE_EDGE ||
           pair->class == ORACLE_VERTEX;
}

static void check_order(const struct world_turn *turn, const struct world_case *c,
                        struct world_tally *tally)
{
    uint32_t count = world_tri_count(&c->world);
    struct gmp_pair *want = calloc(count, sizeof *want);
    if (!want)
        abort();
    for (uint32_t p = 0; p < count; p++)
        exact_gmp_init(&want[p]);
    for (int i = 0; i < WORLD_RAYS; i++) {
        for (uint32_t p = 0; p < count; p++)
            gmp_world_pair(&c->world, &c->ray[i], p, &want[p]);
        for (uint32_t a = 0; a < count; a++)
            for (uint32_t b = 0; b < count; b++) {
                if (!is_hit(&want[a]) || !is_hit(&want[b]))
                    continue;
                int sign = mpq_cmp(want[a].t, want[b].t);
                sign = (sign > 0) - (sign < 0);
                if (oracle_compare(c->oracle, &c->ray[i], a, b) != sign && tally->faults++ == 0)
                    printf("%s: order of %u and %u\n", turn->name, a, b);
                tally->pairs++;
                tally->ties +=
                    sign == 0 && world_instance_of(&c->world, a) != world_instance_of(&c->world, b);
            }
    }
    for (uint32_t p = 0; p < count; p++)
        exact_gmp_clear(&want[p]);
    free(want);
}

static void order_agrees_with_rationals(void **state)
{
    (void)state;
    struct world_tally sum = {0};
    for (int k = 0; k < WORLD_TURNS; k++) {
        struct world_tally all =
            over_worlds(&world_turns[k], 7000, count_per_kind(6000) / 400, check_order);
        add(&sum, &all);
    }
    printf("%zu compared, %zu exact ties of two instances\n", sum.pairs, sum.ties);
    assert_int_equal(sum.faults, 0);
    assert_true(sum.ties > 300);
}

/* Reads "num/den" or "num/den*2^k". */
static void read_rational(char *text, mpq_t out)
{
    char *power = strstr(text, "*2^");
    long twos = power ? strtol(power + 3, NULL, 10) : 0;
    if (power)
        *power = 0;
    assert_int_equal(mpq_set_str(out, text, 10), 0);
    if (twos > 0)
        mpq_mul_2exp(out, out, (mp_bitcnt_t)twos);
    else
        mpq_div_2exp(out, out, (mp_bitcnt_t)-twos);
}

static void t_is_written_exactly(void **state)
{
    (void)state;
    size_t written = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 2; w++) {
            struct world_case c;
            struct gmp_pair want;
            mpq_t got;
            world_case_make(&world_turns[k], 9000 + w, &c);
            exact_gmp_init(&want);
            mpq_init(got);
            for (uint32_t n = 0; n < WORLD_RAYS * world_tri_count(&c.world); n++) {
                char text[1200], told[ORACLE_T_TEXT];
                const struct ray *ray = &c.ray[n % WORLD_RAYS];
                uint32_t prim = n / WORLD_RAYS;
                gmp_world_pair(&c.world, ray, prim, &want);
                assert_int_equal(oracle_rational(c.oracle, ray, prim, text, sizeof text),
                                 is_hit(&want));
                oracle_t_text(c.oracle, ray, prim, told);
                assert_int_equal(strcmp(told, "is none") == 0,
                                 want.class == ORACLE_MISS || want.class == ORACLE_ZERO_AREA);
                if (!is_hit(&want))
                    continue;
                read_rational(text, got);
                assert_int_equal(mpq_cmp(got, want.t), 0);
                written++;
            }
            mpq_clear(got);
            exact_gmp_clear(&want);
            world_case_free(&c);
        }
    assert_true(written > 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pairs_agree_with_rationals),
        cmocka_unit_test(order_agrees_with_rationals),
        cmocka_unit_test(t_is_written_exactly),
    };
    return cmocka_run_group_tests_name("oracle_world", tests, NULL, NULL) ? 1 : 0;
}
