/* Triangles without area, wherever they stand among others: each is known for one, no other is, and
 * they change no answer of the oracle. */
#include "ref/base/rng.h"
#include "ref/oracle/oracle.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define RAYS 60u

static struct reason reason;

/* A corner of small whole numbers. */
static void put_corner(struct rng *rng, float at[3])
{
    for (int k = 0; k < 3; k++)
        at[k] = (float)((int)rng_below(rng, 41) - 20);
}

/* Three corners on a line, some or all of them equal. */
static void put_flat(struct rng *rng, float *v)
{
    float step[3];
    put_corner(rng, v);
    put_corner(rng, step);
    const int second = (int)rng_below(rng, 4), third = (int)rng_below(rng, 3) - 1;
    for (int k = 0; k < 3; k++) {
        v[3 + k] = v[k] + (float)second * step[k];
        v[6 + k] = v[k] + (float)third * step[k];
    }
}

static bool has_area(const float *v)
{
    double a[3], b[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        a[k] = (double)v[3 + k] - (double)v[k];
        b[k] = (double)v[6 + k] - (double)v[k];
    }
    for (int k = 0; k < 3; k++)
        sum += fabs(a[k] * b[(k + 1) % 3] - a[(k + 1) % 3] * b[k]);
    return sum > 0; /* whole numbers: exact */
}

/* Of `all` triangles about one in `share` is flat; `some` has the others, place[i] is where the
 * i-th of them is in `all`. */
static void make_scenes(struct rng *rng, uint32_t count, uint32_t share, struct scene *all,
                        struct scene *some, uint32_t *place)
{
    uint32_t used = 0;
    assert_int_equal(scene_make(3 * count, count, all), STATUS_OK);
    for (uint32_t i = 0; i < count; i++) {
        float *v = all->vertex + 9 * (size_t)i;
        const bool flat = rng_below(rng, share) == 0;
        do
            if (flat)
                put_flat(rng, v);
            else
                for (int c = 0; c < 3; c++)
                    put_corner(rng, v + 3 * c);
        while (has_area(v) == flat);
        for (uint32_t c = 0; c < 3; c++)
            all->index[3 * i + c] = 3 * i + c;
        if (!flat)
            place[used++] = i;
    }
    assert_int_equal(scene_make(3 * used, used, some), STATUS_OK);
    for (uint32_t i = 0; i < used; i++)
        memcpy(some->vertex + 9 * (size_t)i, all->vertex + 9 * (size_t)place[i],
               9 * sizeof *some->vertex);
    for (uint32_t i = 0; i < 3 * used; i++)
        some->index[i] = i;
}

static void triangles_without_area_are_as_if_not_there(void **state)
{
    (void)state;
    static const uint32_t counts[] = {1, 3, 8, 9, 17, 40, 130, 300};
    struct rng rng = rng_make(2, 1);
    size_t hits = 0, flats = 0;
    for (uint32_t turn = 0; turn < 8 * ARRAY_COUNT(counts); turn++) {
        const uint32_t count = counts[turn % ARRAY_COUNT(counts)];
        uint32_t place[300];
        struct scene all, some;
        struct oracle *with, *without;
        struct oracle_answer got[RAYS], want[RAYS];
        struct ray ray[RAYS];
        make_scenes(&rng, count, 2 + turn % 5, &all, &some, place);
        if (oracle_make(&all, &with, &reason) || oracle_make(&some, &without, &reason))
            fail_msg("%s", reason.text);
        for (uint32_t i = 0; i < RAYS; i++) {
            float to[3];
            put_corner(&rng, ray[i].org);
            put_corner(&rng, to);
            for (int k = 0; k < 3; k++)
                ray[i].dir[k] = to[k] + (k == (int)(i % 3) ? 0.5f : 0) - ray[i].org[k];
            ray[i].tmin = 0;
            ray[i].tmax = 1e30f;
        }
        assert_int_equal(
            oracle_closest(with, ORACLE_TREE, ORACLE_CLOSED, ray, RAYS, 1, got, NULL, &reason),
            STATUS_OK);
        assert_int_equal(
            oracle_closest(without, ORACLE_TREE, ORACLE_CLOSED, ray, RAYS, 1, want, NULL, &reason),
            STATUS_OK);
        for (uint32_t i = 0; i < RAYS; i++) {
            const bool hit = want[i].prim != ABI_NO_PRIM;
            assert_int_equal(got[i].prim, hit ? place[want[i].prim] : ABI_NO_PRIM);
            assert_true(!hit || (got[i].t_lo == want[i].t_lo && got[i].t_hi == want[i].t_hi));
            hits += hit;
        }
        for (uint32_t p = 0; p < count; p++) {
            struct oracle_pair pair;
            oracle_pair(with, &ray[p % RAYS], p, &pair);
            const bool flat = !has_area(all.vertex + 9 * (size_t)p);
            assert_int_equal(pair.class == ORACLE_ZERO_AREA, flat);
            flats += flat;
        }
        oracle_free(with);
        oracle_free(without);
        scene_free(&all);
        scene_free(&some);
    }
    assert_true(hits > 500 && flats > 500);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangles_without_area_are_as_if_not_there)};
    return cmocka_run_group_tests_name("oracle_flat", tests, NULL, NULL);
}
