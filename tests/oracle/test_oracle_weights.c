/* Weights of hits in double, where the filter says that it knows them: they enclose the exact ones,
 * whatever the pair; of slivers that reach far behind the ray above all, whose D is the difference
 * of what is much larger, while the products with the near vertex are known well. */
#include "ref/oracle/environment.h"
#include "ref/oracle/oracle_world.h"
#include "ref/oracle/pair.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/world_cases.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

struct weighed {
    uint32_t known, open, tight;
};

/* Of a pair that is a hit; others have no weights. */
static void weigh(const struct oracle *oracle, const struct ray *ray, uint32_t prim,
                  struct weighed *tally)
{
    struct oracle_pair pair;
    struct located at = pair_locate(oracle, prim);
    struct enclosure weight[2];
    double exact[2][2];
    oracle_pair(oracle, ray, prim, &pair);
    if (!oracle_is_hit(&pair))
        return;
    unsigned long saved = environment_enter();
    bool known = pair_weights(ray, &at, &weight[0], &weight[1]);
    environment_leave(saved);
    tally->open += !known;
    if (!known)
        return;
    tally->known++;
    oracle_weights(oracle, ray, prim, exact[0], exact[1]);
    for (int i = 0; i < 2; i++) {
        assert_true(weight[i].lo <= exact[i][1] && exact[i][0] <= weight[i].hi);
        tally->tight += weight[i].hi - weight[i].lo < 0x1p-30;
    }
}

static void of_scenes(void **state)
{
    (void)state;
    struct weighed tally = {0};
    for (int kind = 0; kind < ORACLE_CASES; kind++)
        for (uint64_t seed = 0; seed < 30; seed++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[kind], seed, &batch);
            for (uint32_t i = 0; i < BATCH; i++)
                for (uint32_t k = 0; k < BATCH; k++)
                    weigh(batch.oracle, &batch.ray[i], k, &tally);
            batch_free(&batch);
        }
    print_message("known %u, open %u, narrow %u\n", tally.known, tally.open, tally.tight);
    assert_true(tally.known > 500 && tally.open > 20 && tally.tight > tally.known);
}

/* The ray meets the middle of a long edge, with the third vertex beside it. */
static void flat_sliver(struct rng *rng, struct scene *scene, struct ray *ray)
{
    const float way[2] = {rng_float(rng) - 0.5f, rng_float(rng) - 0.5f};
    const float near = ldexpf(1, -40 - (int)rng_below(rng, 20));
    int turn = (int)rng_below(rng, 3);
    for (int c = 0; c < 3; c++) {
        float *v = scene->vertex + 3 * ((c + turn) % 3);
        for (int k = 0; k < 2; k++)
            v[k] = c == 0 ? near * (rng_float(rng) - 0.5f) : c == 1 ? way[k] : -way[k];
        v[2] = 1;
    }
    *ray = (struct ray){{0}, 0, {0, 0, 1}, INFINITY};
}

/* A vertex beside the ray, the others far behind it in nearly one direction. */
static void sliver(struct rng *rng, struct scene *scene, struct ray *ray)
{
    const float way[2] = {rng_float(rng) - 0.5f, rng_float(rng) - 0.5f};
    const float thin = ldexpf(1, -(int)rng_below(rng, 14));
    const float near = ldexpf(1, -(int)rng_below(rng, 30));
    int turn = (int)rng_below(rng, 3);
    for (int c = 0; c < 3; c++) {
        float *v = scene->vertex + 3 * ((c + turn) % 3);
        float far = c ? 1000 : -near, beside = c ? (float)(2 * c - 3) * thin * rng_float(rng) : 0;
        v[0] = far * way[0] - beside * way[1];
        v[1] = far * way[1] + beside * way[0];
        v[2] = 1 + (float)c * rng_float(rng);
    }
    *ray = (struct ray){{0}, 0, {0, 0, 1}, INFINITY};
}

static void of_slivers(void **state)
{
    (void)state;
    struct rng rng = rng_make(83, 0);
    struct weighed plain = {0}, placed = {0};
    for (int n = 0; n < 40000; n++) {
        struct ray ray;
        struct scene scene;
        struct oracle *oracle, *own;
        struct world world;
        struct reason reason = {""};
        assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
        for (uint32_t c = 0; c < 3; c++)
            scene.index[c] = c;
        (n % 4 < 2 ? sliver : flat_sliver)(&rng, &scene, &ray);
        assert_int_equal(oracle_make(&scene, &own, &reason), STATUS_OK);
        weigh(own, &ray, 0, &plain);
        oracle_free(own);
        if (n % 2 == 0) {
            const int large = n % 16 ? 0 : (int)rng_below(&rng, 200) - 100;
            assert_int_equal(world_of_scene(&scene, &world, &reason), STATUS_OK);
            for (int k = 0; k < 9; k++) /* the ray stays where it is */
                if (k != 2 && k != 5)
                    world.instance[0].m[k / 3][k % 3] =
                        ldexpf((k % 4 == 0) + 0.25f * (rng_float(&rng) - 0.5f), large);
            assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
            weigh(oracle, &ray, 0, &placed);
            oracle_free(oracle);
            world_free(&world);
        }
        scene_free(&scene);
    }
    print_message("known %u, open %u; placed %u, %u\n", plain.known, plain.open, placed.known,
                  placed.open);
    assert_true(plain.known > 500 && plain.open > 500 && placed.known > 100 && placed.open > 100);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(of_scenes),
        cmocka_unit_test(of_slivers),
    };
    return cmocka_run_group_tests_name("oracle_weights", tests, NULL, NULL);
}
