/* The nearest hits of worlds: against GMP rationals and the rules of ref/world/world.h applied one
 * by one; every path against every other; crossings against pairs. */
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

static size_t faults;

static void report(const char *what, const char *kind, const struct ray *ray)
{
#pragma omp critical(world_report)
    if (faults++ == 0)
        printf("%s, %s: o=(%a,%a,%a) d=(%a,%a,%a) t=[%a,%a]\n", what, kind, (double)ray->org[0],
               (double)ray->org[1], (double)ray->org[2], (double)ray->dir[0], (double)ray->dir[1],
               (double)ray->dir[2], (double)ray->tmin, (double)ray->tmax);
}

static void closest(const struct world_case *c, enum oracle_path path, enum oracle_ends ends,
                    bool modes, unsigned threads, struct oracle_answer *out)
{
    struct reason reason = {""};
    if (oracle_closest_world(c->oracle, path, ends, c->ray, modes ? c->mode : NULL, WORLD_RAYS,
                             threads, out, NULL, &reason))
        abort();
}

struct closest_tally {
    size_t hits, ties, modes;
};

/* Both paths, one ray. */
static void check_ray(const char *kind, const struct world_case *c, int i,
                      const struct gmp_nearest *want, const struct oracle_answer got[2])
{
    struct gmp_pair pair;
    const struct ray *ray = &c->ray[i];
    exact_gmp_init(&pair);
    if (want->count)
        gmp_world_pair(&c->world, ray, want->prim, &pair);
    const char *fault = answer_fault(&got[0], want, &pair);
    if (fault)
        report(fault, kind, ray);
    bool flag = got[0].flags & ORACLE_SAW_IN_PLANE;
    if (flag != want->in_plane && !(flag && want->in_plane_close))
        report("in plane", kind, ray);
    if (answer_is_exact(c->oracle, ray, &got[0]) != ((got[0].flags & ORACLE_SAW_EXACT) != 0))
        report("exact", kind, ray);
    if (!answer_same(&got[0], &got[1]))
        report("paths differ", kind, ray);
    exact_gmp_clear(&pair);
}

static void check_world(const char *kind, const struct world_case *c, struct closest_tally *tally)
{
    struct gmp_nearest want;
    exact_gmp_nearest_init(&want);
    for (int run = 0; run < 3; run++) {
        enum oracle_ends ends = run == 1 ? ORACLE_OPEN : ORACLE_CLOSED;
        bool modes = run < 2;
        struct oracle_answer brute[WORLD_RAYS], tree[WORLD_RAYS];
        closest(c, ORACLE_BRUTE, ends, modes, 1, brute);
        closest(c, run ? ORACLE_TREE : ORACLE_AUTO, ends, modes, 1, tree);
        for (int i = 0; i < WORLD_RAYS; i++) {
            const struct oracle_answer got[2] = {brute[i], tree[i]};
            gmp_world_nearest(&c->world, &c->ray[i], modes ? c->mode[i] : ray_mode_all(), ends,
                              &want);
            check_ray(kind, c, i, &want, got);
            tally->hits += want.count > 0;
            tally->ties += want.count > 1;
        }
    }
    exact_gmp_nearest_clear(&want);
}

static void closest_agrees_with_rationals(void **state)
{
    (void)state;
    size_t worlds = count_per_kind(720) / (3 * WORLD_RAYS), ties = 0;
    faults = 0;
    for (int k = 0; k < WORLD_TURNS; k++) {
        size_t hits = 0, tied = 0;
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : hits, tied)
        for (size_t w = 0; w < worlds; w++) {
            struct world_case c;
            struct closest_tally tally = {0};
            world_case_make(&world_turns[k], 20000 + w, &c);
            check_world(world_turns[k].name, &c, &tally);
            world_case_free(&c);
            hits += tally.hits;
            tied += tally.ties;
        }
        printf("%-9s %zu rays, %zu hits, %zu ties\n", world_turns[k].name, 3 * worlds * WORLD_RAYS,
               hits, tied);
        assert_true(hits > worlds * WORLD_RAYS / 2);
        ties += tied;
    }
    assert_int_equal(faults, 0);
    assert_true(ties > 200);
}

/* --- larger worlds: brute force against the tree ---------------------------------------------- */

/* A mesh of a patch of n x n quads: curved, or in one plane across an axis, where boxes have no
 * thickness and any error of a ray misses them. */
static struct scene *patch(uint32_t n, bool curved)
{
    struct scene *scene = malloc(sizeof *scene);
    if (!scene || scene_make((n + 1) * (n + 1), 2 * n * n, scene))
        abort();
    for (uint32_t i = 0; i < (n + 1) * (n + 1); i++) {
        float x = (float)(i % (n + 1)) / (float)n - 0.5f,
              y = (float)(i / (n + 1)) / (float)n - 0.5f;
        scene->vertex[3 * i] = x;
        scene->vertex[3 * i + 1] = y;
        scene->vertex[3 * i + 2] = curved ? x * x - y * y + 0.25f : 0.25f;
    }
    for (uint32_t i = 0; i < n * n; i++) {
        uint32_t a = i / n * (n + 1) + i % n, *at = scene->index + 6 * i;
        at[0] = a, at[1] = a + 1, at[2] = a + n + 1;
        at[3] = a + 1, at[4] = a + n + 2, at[5] = a + n + 1;
    }
    return scene;
}

static void patches_make(const struct world_turn *turn, uint32_t n, uint32_t count, uint64_t seed,
                         struct world *out)
{
    struct rng rng = far_rng(seed);
    struct reason reason = {""};
    *out = (struct world){.mesh_count = 1, .instance_count = count};
    out->mesh = calloc(1, sizeof *out->mesh);
    out->instance = calloc(count, sizeof *out->instance);
    struct geometry *geometry = calloc(1, sizeof *geometry);
    if (!out->mesh || !out->instance || !geometry)
        abort();
    *geometry = (struct geometry){0, 2 * n * n, true};
    out->mesh[0] = (struct world_mesh){patch(n, n % 2), geometry, 1};
    for (uint32_t i = 0; i < count; i++) {
        out->instance[i].mask = 0xFF;
        world_turn_draw(turn, &rng, out->instance[i].m);
    }
    if (world_finish(out, &reason))
        abort();
}

/* Rays that hit, and some that pass far away or run along an axis. */
static void paths_agree(void **state)
{
    (void)state;
    enum { RAYS = 300 };
    static struct ray ray[RAYS];
    static struct oracle_answer brute[RAYS], tree[RAYS], two[RAYS];
    for (int k = 0; k < WORLD_TURNS; k++) {
        struct world world;
        struct oracle *oracle;
        struct reason reason = {""};
        struct oracle_stats few = {0}, all = {0};
        size_t hits = 0;
        struct rng rng = far_rng(31 + (uint64_t)k);
        patches_make(&world_turns[k], k % 2 ? 10 : 7, 40, 77 + (uint64_t)k, &world);
        assert_int_equal(oracle_make_world(&world, &oracle, &reason), STATUS_OK);
        for (int i = 0; i < RAYS; i++)
            world_case_aim(&world, false, &rng, &ray[i]);
        assert_int_equal(oracle_closest_world(oracle, ORACLE_BRUTE, ORACLE_CLOSED, ray, NULL, RAYS,
                                              2, brute, &all, &reason),
                         STATUS_OK);
        assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, NULL, RAYS,
                                              1, tree, &few, &reason),
                         STATUS_OK);
        assert_int_equal(oracle_closest_world(oracle, ORACLE_TREE, ORACLE_CLOSED, ray, NULL, RAYS,
                                              2, two, NULL, &reason),
                         STATUS_OK);
        for (int i = 0; i < RAYS; i++) {
            hits += brute[i].prim != ABI_NO_PRIM;
            if (!answer_same(&brute[i], &tree[i]) || !answer_same(&tree[i], &two[i]))
                fail_msg("%s: ray %d: %u and %u", world_turns[k].name, i, brute[i].prim,
                         tree[i].prim);
        }
        printf("%-9s %zu hits, %llu pairs by brute force, %llu by the tree\n", world_turns[k].name,
               hits, (unsigned long long)all.pairs, (unsigned long long)few.pairs);
        assert_true(hits > RAYS / 4);
        assert_true(all.pairs > 8 * few.pairs);
        oracle_free(oracle);
        world_free(&world);
    }
}

/* --- crossings -------------------------------------------------------------------------------- */

/* Every triangle in range that counts is listed once, hits by their exact order. */
static void check_crossings(const struct world_case *c, int i, double t_most, bool ours,
                            size_t *listed)
{
    struct oracle_crossing *list = NULL;
    struct gmp_pair pair, last;
    struct reason reason = {""};
    size_t capacity = 0, count, want = 0;
    uint32_t tris = world_tri_count(&c->world);
    struct ray_mode mode = ours ? c->mode[i] : ray_mode_all();
    exact_gmp_init(&pair);
    exact_gmp_init(&last);
    assert_int_equal(oracle_crossings_world(c->oracle, &c->ray[i], mode, t_most, &list, &capacity,
                                            &count, &reason),
                     STATUS_OK);
    for (uint32_t prim = 0; prim < tris; prim++) {
        struct oracle_pair got;
        oracle_pair(c->oracle, &c->ray[i], prim, &got);
        gmp_world_pair(&c->world, &c->ray[i], prim, &pair);
        bool met = (pair.class == ORACLE_IN_PLANE && pair.range == ORACLE_WITHIN) ||
                   exact_gmp_hits(&pair, ORACLE_CLOSED);
        bool due = met && got.t_lo <= t_most &&
                   gmp_world_admit(&c->world, &c->ray[i], mode, prim, &pair) == ORACLE_ADMITTED;
        size_t times = 0;
        for (size_t n = 0; n < count; n++)
            times += list[n].prim == prim;
        assert_int_equal(times, due);
        want += due;
    }
    assert_int_equal(count, want);
    for (size_t n = 0; n < count; n++) {
        gmp_world_pair(&c->world, &c->ray[i], list[n].prim, n % 2 ? &last : &pair);
        if (n == 0 || list[n].pair.class == ORACLE_IN_PLANE ||
            list[n - 1].pair.class == ORACLE_IN_PLANE)
            continue;
        int sign = n % 2 ? mpq_cmp(pair.t, last.t) : mpq_cmp(last.t, pair.t);
        assert_true(sign < 0 || (sign == 0 && list[n - 1].prim < list[n].prim));
    }
    *listed += count;
    free(list);
    exact_gmp_clear(&pair);
    exact_gmp_clear(&last);
}

static void crossings_are_listed_once(void **state)
{
    (void)state;
    size_t listed = 0;
    for (int k = 0; k < WORLD_TURNS; k++)
        for (uint64_t w = 0; w < 4; w++) {
            struct world_case c;
            world_case_make(&world_turns[k], 40000 + w, &c);
            for (int i = 0; i < WORLD_RAYS; i++) {
                check_crossings(&c, i, INFINITY, i % 2, &listed);
                check_crossings(&c, i, 1, i % 3, &listed);
                check_crossings(&c, i, -1, i % 3, &listed);
            }
            world_case_free(&c);
        }
    printf("%zu crossings\n", listed);
    assert_true(listed > 1000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closest_agrees_with_rationals),
        cmocka_unit_test(paths_agree),
        cmocka_unit_test(crossings_are_listed_once),
    };
    return cmocka_run_group_tests_name("oracle_world_closest", tests, NULL, NULL) ? 1 : 0;
}
