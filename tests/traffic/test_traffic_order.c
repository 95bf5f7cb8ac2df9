/* The order of sorted rays is a second, plain one's; and a scene of another size has the same paths
 * at that size. */
#include "ref/base/rng.h"
#include "tests/traffic/traffic_fixture.h"

#include <math.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

/* --- sorted rays ------------------------------------------------------------------------------ */

#define RAYS   2048 /* whole bursts */
#define CELLS  64
#define DIGITS (3 * 6 + 3 + 3 * 6)

/* Digits that are compared one by one, and the place among equal ones. */
struct plain_key {
    unsigned char digit[DIGITS];
    size_t place;
};

static int cell(double x, double lo, double hi)
{
    const double at = hi > lo ? floor(CELLS * ((x - lo) / (hi - lo))) : 0;
    return (int)fmin(fmax(at, 0), CELLS - 1);
}

/* Halves of the box in turn: x, y, z, then half of each half. */
static unsigned char *put_cells(unsigned char *out, const float *at, const double lo[3],
                                const double hi[3])
{
    for (int size = CELLS / 2; size > 0; size /= 2)
        for (int k = 0; k < 3; k++)
            *out++ = cell((double)at[k], lo[k], hi[k]) / size % 2 == 1;
    return out;
}

static struct plain_key key_of(const struct ray *ray, const struct box *box, size_t place)
{
    struct plain_key key = {.place = place};
    double lo[3], hi[3], most = 0;
    for (int k = 0; k < 3; k++) {
        lo[k] = (double)box->lo[k];
        hi[k] = (double)box->hi[k];
        most = fmax(most, fabs((double)ray->dir[k]));
    }
    unsigned char *out = put_cells(key.digit, ray->org, lo, hi);
    for (int k = 0; k < 3; k++) {
        *out++ = ray->dir[k] < 0;
        lo[k] = -most;
        hi[k] = most;
    }
    (void)put_cells(out, ray->dir, lo, hi);
    return key;
}

static int by_digits(const void *a, const void *b)
{
    const struct plain_key *x = a, *y = b;
    const int order = memcmp(x->digit, y->digit, sizeof x->digit);
    return order ? order : x->place < y->place ? -1 : x->place > y->place;
}

/* A scheduler that has sorted plainly, for nothing. */
static enum status play_plainly(struct traffic_run *run, struct reason *reason)
{
    enum status status = STATUS_OK;
    const struct box box = scene_bounds(run->walker->job.scene);
    for (uint32_t w = 0; w < run->depth && !status; w++) {
        const struct traffic_wave *wave = &run->paths->wave[w];
        struct plain_key *key = calloc(wave->count, sizeof *key);
        uint32_t *order = calloc(wave->count, sizeof *order);
        assert_true(key && order);
        for (size_t i = 0; i < wave->count; i++)
            key[i] = key_of(&wave->ray[i], &box, i);
        qsort(key, wave->count, sizeof *key, by_digits);
        for (size_t i = 0; i < wave->count; i++)
            order[i] = (uint32_t)key[i].place;
        status = traffic_in_order(run, w, order, reason);
        free(key);
        free(order);
    }
    return status;
}

/* Rays of few origins and of directions that differ little, some along axes: every digit decides
 * somewhere. */
static void draw_rays(struct traffic_wave *wave, const struct scene *scene)
{
    const struct box box = scene_bounds(scene);
    struct rng rng = rng_make(11, 0);
    for (size_t i = 0; i < wave->count; i++) {
        struct ray *ray = &wave->ray[i];
        for (int k = 0; k < 3; k++) {
            const float size = box.hi[k] - box.lo[k];
            const float part = (float)rng_below(&rng, 66) / 64 - 1.0f / 128;
            const bool few = rng_below(&rng, 4) > 0;
            ray->org[k] = box.lo[k] + size * (few ? 0.5f : part);
            ray->dir[k] = (float)((int)rng_below(&rng, 65) - 32) / (few ? 1024 : 32);
        }
        ray->dir[i % 3] = i % 2 ? 1 : -1;
    }
}

/* All is the same at each level, but for the rays that sorting reads and writes once. */
static void must_move_alike(const struct traffic_result *sorted, const struct traffic_result *plain)
{
    assert_int_equal(sorted->visits, plain->visits);
    for (int level = 0; level < TRAFFIC_LEVELS; level++)
        for (int cause = 0; cause < TRAFFIC_CAUSES; cause++) {
            const uint64_t *a = &sorted->count[level].in[cause],
                           *b = &plain->count[level].in[cause];
            const uint64_t more = level == TRAFFIC_DRAM && cause == TRAFFIC_RAYS
                                      ? (uint64_t)TRAFFIC_RAY_BYTES * sorted->rays
                                      : 0;
            assert_int_equal(*a, *b + more);
            a = &sorted->count[level].out[cause];
            b = &plain->count[level].out[cause];
            assert_int_equal(*a, *b + more);
        }
}

static void rays_are_sorted_as_a_plain_order_is(void **state)
{
    (void)state;
    struct traffic_case c;
    assert_true(traffic_case_open("soup:n=3000,size=0.2", "f32", "indexed", &c));
    traffic_case_start(&c, RAYS, 1, 2000);
    struct reason reason;
    struct traffic_machine m = traffic_small();
    m.lanes = 1;
    draw_rays(&c.paths.wave[0], &c.scene);
    assert_int_equal(traffic_paths_trace(&c.paths, &c.job, &reason), STATUS_OK);
    const struct scheduler plain = {.name = "plain", .play = play_plainly};
    struct traffic_run run = {.machine = &m, .paths = &c.paths, .depth = 1, .walker = &c.walker};
    struct traffic_result result;
    assert_int_equal(traffic_play(&plain, &run, &result, &reason), STATUS_OK);
    const struct traffic_result sorted = traffic_case_play(&c, "sorted", &m);
    const struct traffic_result unsorted = traffic_case_play(&c, "depth_first", &m);
    must_move_alike(&sorted, &result);
    assert_true(traffic_scene_part(&sorted, TRAFFIC_DRAM) <
                traffic_scene_part(&unsorted, TRAFFIC_DRAM));
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

/* --- paths ------------------------------------------------------------------------------------ */

static void paths_have_the_size_of_the_scene(void **state)
{
    (void)state;
    struct traffic_case c, scaled;
    assert_true(traffic_case_open("soup:n=700,size=0.5", "f32", "indexed", &c));
    traffic_case_start(&c, 500, 4, 2000);
    for (int power = -9; power <= 9; power += 3) {
        char spec[64];
        snprintf(spec, sizeof spec, TRAFFIC_SCALED "%d soup:n=700,size=0.5", power);
        assert_true(traffic_case_open(spec, "f32", "indexed", &scaled));
        traffic_case_start(&scaled, 500, 4, 2000);
        assert_int_equal(scaled.paths.depth, c.paths.depth);
        for (uint32_t k = 0; k < c.paths.depth; k++) {
            const struct traffic_wave *a = &c.paths.wave[k], *b = &scaled.paths.wave[k];
            assert_int_equal(b->count, a->count);
            for (size_t i = 0; i < a->count; i++) {
                assert_int_equal(b->hit[i].prim, a->hit[i].prim);
                for (int e = 0; e < 3; e++) {
                    assert_true(b->ray[i].org[e] == ldexpf(a->ray[i].org[e], power));
                    assert_true(b->ray[i].dir[e] == a->ray[i].dir[e]);
                }
            }
        }
        traffic_case_stop(&scaled);
        traffic_case_close(&scaled);
    }
    traffic_case_stop(&c);
    traffic_case_close(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_sorted_as_a_plain_order_is),
        cmocka_unit_test(paths_have_the_size_of_the_scene),
    };
    return cmocka_run_group_tests_name("traffic_order", tests, NULL, NULL) ? 1 : 0;
}
