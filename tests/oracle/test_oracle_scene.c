/* The nearest hits of whole scenes: against GMP rationals, and every path against every other. */
#include "ref/oracle/internal.h"
#include "ref/oracle/exact.h"
#include "tests/exact/exact_gmp.h"
#include "tests/exact/oracle_batch.h"
#include "tests/exact/pair_fault.h"
#include "tests/support/ray_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t faults; /* found by any thread; printed once each kind */

static void report(const char *what, const char *where, const struct ray *ray)
{
#pragma omp critical
    if (faults++ < 5)
        printf("%s, %s: o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a]\n", what, where, (double)ray->org[0],
               (double)ray->org[1], (double)ray->org[2], (double)ray->dir[0], (double)ray->dir[1],
               (double)ray->dir[2], (double)ray->tmin, (double)ray->tmax);
}

static void closest(const struct oracle *oracle, enum oracle_path path, enum oracle_ends ends,
                    const struct ray *ray, size_t count, unsigned threads,
                    struct oracle_answer *out)
{
    struct reason reason = {""};
    if (oracle_closest(oracle, path, ends, ray, count, threads, out, NULL, &reason))
        abort();
}

static void check_batch(const struct oracle_case *kind, const struct oracle_batch *batch,
                        size_t *hits)
{
    static const enum oracle_path paths[] = {ORACLE_BRUTE, ORACLE_TREE};
    struct gmp_nearest want;
    struct gmp_pair pair;
    exact_gmp_nearest_init(&want);
    exact_gmp_init(&pair);
    for (int e = 0; e < 2; e++) {
        enum oracle_ends ends = e ? ORACLE_OPEN : ORACLE_CLOSED;
        struct oracle_answer got[2][BATCH];
        for (int p = 0; p < 2; p++)
            closest(batch->oracle, paths[p], ends, batch->ray, BATCH, 1, got[p]);
        for (int i = 0; i < BATCH; i++) {
            exact_gmp_nearest(&batch->scene, &batch->ray[i], ends, &want);
            if (want.count) {
                float v[3][3];
                scene_tri(&batch->scene, want.prim, v);
                exact_gmp_pair(&batch->ray[i], v, &pair);
            }
            *hits += want.count > 0;
            for (int p = 0; p < 2; p++) {
                const char *fault = answer_fault(&got[p][i], &want, &pair);
                if (fault)
                    report(fault, kind->name, &batch->ray[i]);
                /* The flag is decided by enclosures: where both begin together, either will do. */
                bool flag = got[p][i].flags & ORACLE_SAW_IN_PLANE;
                if (flag != want.in_plane && !(flag && want.in_plane_close))
                    report("in plane", kind->name, &batch->ray[i]);
                if (answer_is_exact(batch->oracle, &batch->ray[i], &got[p][i]) !=
                    ((got[p][i].flags & ORACLE_SAW_EXACT) != 0))
                    report("exact", kind->name, &batch->ray[i]);
            }
        }
    }
    exact_gmp_nearest_clear(&want);
    exact_gmp_clear(&pair);
}

static void closest_agrees_with_rationals(void **state)
{
    (void)state;
    size_t batches = count_per_kind(4096) / (2 * BATCH * BATCH);
    faults = 0;
    for (int k = 0; k < ORACLE_CASES; k++) {
        size_t hits = 0;
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : hits)
        for (size_t b = 0; b < batches; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[k], 5000 + b, &batch);
            check_batch(&oracle_cases[k], &batch, &hits);
            batch_free(&batch);
        }
        printf("%-13s %zu rays, %zu hits\n", oracle_cases[k].name, 2 * batches * BATCH, hits);
    }
    assert_int_equal(faults, 0);
}

/* Brute force with the plain kernel on one thread, against everything else. */
static void compare_paths(const struct scene *scene, const char *name, const struct ray *ray,
                          size_t count, size_t *hits)
{
    struct oracle *oracle;
    struct reason reason = {""};
    if (oracle_make(scene, &oracle, &reason))
        fail_msg("%s", reason.text);
    struct oracle_answer *want = alloc_zeroed(count, sizeof *want);
    struct oracle_answer *got = alloc_zeroed(count, sizeof *got);
    const struct early_kernel *best = oracle->kernel;
    for (int e = 0; e < 2; e++) {
        enum oracle_ends ends = e ? ORACLE_OPEN : ORACLE_CLOSED;
        oracle->kernel = &early_kernels[0];
        closest(oracle, ORACLE_BRUTE, ends, ray, count, 1, want);
        for (size_t i = 0; i < count; i++)
            *hits += want[i].prim != ABI_NO_PRIM;
        for (int run = 0; run < 4; run++) {
            oracle->kernel = run == 2 ? &early_kernels[0] : best;
            closest(oracle, run == 0 ? ORACLE_BRUTE : ORACLE_TREE, ends, ray, count,
                    run == 3 ? 1 : 2, got);
            for (size_t i = 0; i < count; i++)
                if (!answer_same(&want[i], &got[i]))
                    report(run == 0 ? "brute, threads" : "tree", name, &ray[i]);
        }
    }
    free(want);
    free(got);
    oracle_free(oracle);
}

static void every_path_gives_the_same_answer(void **state)
{
    (void)state;
    static const char *const sets[] = {"random", "vertices", "edges",  "corners",
                                       "axis",   "bounce",   "ranges", "primary"};
    static struct ray ray[COUNT];
    size_t hits = 0;
    faults = 0;
    for (const struct generator *const *g = generators; *g; g++) {
        struct scene scene = default_scene((*g)->name);
        if (scene.tri_count <= 4096)
            for (size_t s = 0; s < ARRAY_COUNT(sets); s++) {
                size_t count = COUNT / 8;
                struct reason reason = {""};
                if (ray_set_make(ray_set_find(sets[s]), &scene, 7, count, ray, &reason) ==
                    STATUS_OK)
                    compare_paths(&scene, (*g)->name, ray, count, &hits);
            }
        scene_free(&scene);
    }
    printf("%zu hits\n", hits);
    assert_int_equal(faults, 0);
    assert_true(hits > 5000);
}

/* Rays exactly through corners of boxes, with t that no axis can represent: each axis rounds its
 * own way, and only the padding keeps them together. */
static void the_tree_sees_corners(void **state)
{
    (void)state;
    enum { TRIS = 400, RAYS = 2000 };
    static struct ray ray[RAYS];
    struct rng rng = rng_make(11, 0);
    struct scene scene;
    size_t hits = 0;
    faults = 0;
    if (scene_make(3 * TRIS, TRIS, &scene))
        abort();
    for (uint32_t i = 0; i < TRIS; i++) {
        float at[3];
        for (uint32_t k = 0; k < 3; k++)
            at[k] = (float)((int)rng_below(&rng, 200) - 100);
        for (uint32_t c = 0; c < 3; c++) {
            scene.index[3 * i + c] = 3 * i + c;
            for (uint32_t k = 0; k < 3; k++)
                scene.vertex[9 * i + 3 * c + k] = at[k] + (float)rng_below(&rng, 9);
        }
    }
    for (int i = 0; i < RAYS; i++) {
        const float *v = scene.vertex + 3 * rng_below(&rng, 3 * TRIS);
        float stretch = (float)(3 + 2 * rng_below(&rng, 50));
        ray[i] = (struct ray){.tmin = 0, .tmax = INFINITY};
        for (int k = 0; k < 3; k++) {
            ray[i].org[k] = (float)((int)rng_below(&rng, 600) - 300);
            ray[i].dir[k] = stretch * (v[k] - ray[i].org[k]);
        }
    }
    compare_paths(&scene, "corners on a lattice", ray, RAYS, &hits);
    assert_int_equal(faults, 0);
    assert_true(hits > 2 * RAYS - 200); /* but for triangles without area or seen edge-on */
    scene_free(&scene);
}

/* Of a batch by brute force: every pair is counted, and those that left the filter are some of
 * those that are not the filter's, all hits in range among them. Counts add up, on any number of
 * threads. */
static void expect_counts(const struct oracle_batch *batch, size_t *undecided, size_t *wide)
{
    struct oracle_stats stats = {0}, twice;
    struct oracle_answer got[BATCH];
    struct reason reason = {""};
    size_t most = 0, least = 0;
    assert_int_equal(oracle_closest(batch->oracle, ORACLE_BRUTE, ORACLE_CLOSED, batch->ray, BATCH,
                                    1, got, &stats, &reason),
                     STATUS_OK);
    twice = stats;
    assert_int_equal(oracle_closest(batch->oracle, ORACLE_BRUTE, ORACLE_CLOSED, batch->ray, BATCH,
                                    3, got, &twice, &reason),
                     STATUS_OK);
    assert_true(twice.pairs == 2 * stats.pairs && twice.undecided == 2 * stats.undecided &&
                twice.wide == 2 * stats.wide);
    size_t rays = 0;
    for (uint32_t i = 0; i < BATCH; i++) {
        rays += oracle_takes(&batch->ray[i]) && !ray_is_still(&batch->ray[i]);
        for (uint32_t prim = 0; prim < BATCH && oracle_takes(&batch->ray[i]); prim++) {
            struct oracle_pair pair;
            oracle_pair(batch->oracle, &batch->ray[i], prim, &pair);
            bool counts = (oracle_is_hit(&pair) || pair.class == ORACLE_IN_PLANE) &&
                          oracle_in_range(&pair, ORACLE_CLOSED);
            most += !pair.by_filter && pair.class != ORACLE_ZERO_AREA;
            least += !pair.by_filter && counts;
        }
    }
    assert_int_equal(stats.pairs, BATCH * rays);
    assert_in_range(stats.undecided, least, most);
    assert_true(stats.wide <= stats.undecided);
    *undecided += stats.undecided;
    *wide += stats.wide;
}

/* Lattices need no wide integers, exponents far apart do. */
static void work_is_counted(void **state)
{
    (void)state;
    for (int k = 0; k < ORACLE_CASES; k++) {
        size_t undecided = 0, wide = 0;
        for (uint64_t b = 0; b < 20; b++) {
            struct oracle_batch batch;
            batch_make(&oracle_cases[k], 7000 + b, &batch);
            expect_counts(&batch, &undecided, &wide);
            batch_free(&batch);
        }
        if (strcmp(oracle_cases[k].name, "lattice") == 0)
            assert_true(undecided > 0 && wide == 0);
        if (strcmp(oracle_cases[k].name, "spread") == 0)
            assert_true(wide > 0);
    }
}

/* Sizes that touch the ends of leaves and runs, with many ties. */
static void duplicates_tie_in_any_number(void **state)
{
    (void)state;
    static const uint32_t sizes[] = {0, 1, 2, 4, 5, 63, 64, 65, 128, 1000};
    for (size_t n = 0; n < ARRAY_COUNT(sizes); n++) {
        struct scene scene;
        struct oracle *oracle;
        struct oracle_answer got;
        struct reason reason = {""};
        struct ray ray = {{0.1f, 0.2f, -1}, 0, {0, 0, 3}, INFINITY};
        assert_int_equal(scene_make(3, sizes[n], &scene), STATUS_OK);
        for (uint32_t i = 0; i < 9; i++)
            scene.vertex[i] = (float)(i == 3) + (float)(i == 7);
        for (uint32_t i = 0; i < 3 * sizes[n]; i++)
            scene.index[i] = i % 3;
        assert_int_equal(oracle_make(&scene, &oracle, &reason), STATUS_OK);
        for (int p = 0; p < 3; p++) {
            closest(oracle, (enum oracle_path)p, ORACLE_CLOSED, &ray, 1, 1, &got);
            assert_int_equal(got.tie_count, sizes[n]);
            assert_int_equal(got.prim, sizes[n] ? 0 : ABI_NO_PRIM);
            assert_true(got.t_next == INFINITY);
        }
        oracle_free(oracle);
        scene_free(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closest_agrees_with_rationals),
        cmocka_unit_test(every_path_gives_the_same_answer),
        cmocka_unit_test(the_tree_sees_corners),
        cmocka_unit_test(work_is_counted),
        cmocka_unit_test(duplicates_tie_in_any_number),
    };
    return cmocka_run_group_tests_name("oracle_scene", tests, NULL, NULL) ? 1 : 0;
}
