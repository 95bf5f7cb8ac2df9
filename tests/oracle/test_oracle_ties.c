/* Ties of triangles that share vertices, edges or all three: found without arithmetic
 * (ref/oracle/nearest.c), so they are compared with the fractions here; and hits that are apart by
 * less than any enclosure tells. */
#include "ref/oracle/oracle.h"
#include "ref/base/rng.h"

#include <math.h>
#include <stdio.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h> /* last: it defines fail() as a macro */

#define TRIANGLES 12u
#define RAYS      24u
#define SCENES    400u

/* On the lattice, in the plane z = 0 or off it by next to nothing. */
static void put_vertex(struct rng *rng, float *v)
{
    v[0] = (float)rng_below(rng, 9);
    v[1] = (float)rng_below(rng, 9);
    v[2] = 0;
    if (rng_below(rng, 4) == 0)
        v[2] = ldexpf(1, -30 - (int)rng_below(rng, 60)) * (rng_below(rng, 2) ? 1.0f : -1.0f);
}

/* Triangles over few vertices, each with copies, so that faces are shared by index and by place. */
static void put_scene(struct rng *rng, struct scene *scene)
{
    uint32_t half = scene->vertex_count / 2;
    for (uint32_t i = 0; i < half; i++) {
        put_vertex(rng, &scene->vertex[3 * i]);
        for (uint32_t k = 0; k < 3; k++)
            scene->vertex[3 * (half + i) + k] = scene->vertex[3 * i + k];
    }
    for (uint32_t i = 0; i < 3 * scene->tri_count; i++)
        scene->index[i] = rng_below(rng, scene->vertex_count);
}

/* Up through a point of the lattice or of its halves, straight or not. */
static struct ray put_ray(struct rng *rng)
{
    float x = 0.5f * (float)rng_below(rng, 17), y = 0.5f * (float)rng_below(rng, 17);
    float dx = (float)rng_below(rng, 3) - 1, dy = (float)rng_below(rng, 3) - 1;
    return (struct ray){{x - dx, y - dy, -1}, 0, {dx, dy, 1}, INFINITY};
}

static bool is_hit(const struct oracle_pair *pair)
{
    return pair->class == ORACLE_INSIDE || pair->class == ORACLE_EDGE ||
           pair->class == ORACLE_VERTEX;
}

static void only_equal_fractions_tie(void **state)
{
    (void)state;
    struct rng rng = rng_make(77, 0);
    struct scene scene;
    size_t ties = 0, near_ties = 0;
    assert_int_equal(scene_make(12, TRIANGLES, &scene), STATUS_OK);
    for (uint32_t s = 0; s < SCENES; s++) {
        struct oracle *oracle = NULL;
        struct reason reason = {""};
        struct ray ray[RAYS];
        struct oracle_answer answer[RAYS];
        put_scene(&rng, &scene);
        for (uint32_t i = 0; i < RAYS; i++)
            ray[i] = put_ray(&rng);
        assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
        assert_int_equal(oracle_closest(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, RAYS, 1, answer,
                                        NULL, &reason),
                         STATUS_OK);
        for (uint32_t i = 0; i < RAYS; i++) {
            uint32_t first = ABI_NO_PRIM, count = 0, close = 0;
            struct oracle_pair best, pair;
            for (uint32_t prim = 0; prim < TRIANGLES; prim++) {
                oracle_pair(oracle, &ray[i], prim, &pair);
                if (!is_hit(&pair))
                    continue;
                int order =
                    first == ABI_NO_PRIM ? -1 : oracle_compare(oracle, &ray[i], prim, first);
                bool overlap = order != 0 && first != ABI_NO_PRIM && pair.t_lo <= best.t_hi &&
                               pair.t_hi >= best.t_lo;
                close += overlap;
                count = order < 0 ? 1 : count + (order == 0);
                if (order < 0) {
                    first = prim;
                    best = pair;
                }
            }
            assert_int_equal(answer[i].prim, first);
            assert_int_equal(answer[i].tie_count, count);
            ties += count > 1;
            near_ties += close;
        }
        oracle_free(oracle);
    }
    scene_free(&scene);
    printf("%zu ties, %zu hits next to others\n", ties, near_ties);
    assert_true(ties > 1000 && near_ties > 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(only_equal_fractions_tie)};
    return cmocka_run_group_tests_name("oracle_ties", tests, NULL, NULL) ? 1 : 0;
}
