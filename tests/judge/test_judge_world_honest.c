/* No honest answer to a ray of a world is WRONG: each formula of ours, each rounding, closest, any
 * and all hits, behind transforms of many kinds. Some 40,000 answers; RAYDIFF_SLOW=1: over 10^6.
 * And of tracers with transforms of their own, judged as unknown formulas. */
#include "tests/judge/honest_world.h"

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

#define OWN       5 /* of formulas */
#define ROUNDINGS 4
#define RAYS      10

static uint64_t worlds(void)
{
    return getenv("RAYDIFF_SLOW") ? 1700 : 60;
}

static uint64_t verdicts[VERDICT_COUNT], ill;

struct honest_seat {
    const struct judged_world *w;
    struct judge *judge[3]; /* of each query */
    size_t f, r;
    struct legal legal;
};

static struct model model_of(size_t f, size_t r, bool unknown)
{
    if (unknown)
        return (struct model){.formula = TWIN_UNKNOWN, .rounding = roundings[r].rounding};
    return (struct model){.formula = formulas[f].formula,
                          .rounding = roundings[r].rounding,
                          .bits = r == 0,
                          .watertight = formulas[f].formula == TWIN_WOOP && r < 3,
                          .open = formulas[f].formula == TWIN_MT_RTRS};
}

static void not_wrong(const struct honest_seat *s, const struct ray *ray, struct ray_mode mode,
                      const struct judgement *j, const struct hit *hit, const char *query)
{
    verdicts[j->verdict]++;
    ill += j->ill_conditioned;
    if (j->verdict != VERDICT_WRONG)
        return;
    char line[400];
    judge_line(ray, j, hit, line, sizeof line);
    fail_msg("%s, %s, %s, mask %x flags %x: %s: %s", formulas[s->f].name, roundings[s->r].name,
             query, (unsigned)mode.mask, (unsigned)mode.flags, wrong_name(j->wrong), line);
}

static void ask(struct honest_seat *s, const struct ray *ray, struct ray_mode mode)
{
    struct oracle_answer truth = judged_world_truth(s->w, ray, mode);
    enum twin_formula formula = formulas[s->f].formula;
    struct judgement closest, any, out;
    struct hit hit[2], list[WORLD_MOST_HITS];
    uint32_t tag[2], tags[WORLD_MOST_HITS];
    for (int q = 0; q < 2; q++) {
        honest_world_trace(s->w, formula, &s->legal, ray, mode, q ? QUERY_ANY : QUERY_CLOSEST,
                           &hit[q], &tag[q]);
        assert_int_equal(judge_world_answer(s->judge[q], ray, mode, &truth, &hit[q], tag[q], &out),
                         STATUS_OK);
        not_wrong(s, ray, mode, &out, &hit[q], q ? "any" : "closest");
        *(q ? &any : &closest) = out;
    }
    judge_any_against_closest(s->judge[1], ray, &hit[0], &closest, &hit[1], &any);
    not_wrong(s, ray, mode, &any, &hit[1], "any against closest");
    struct list_judgement listed;
    size_t count = honest_world_list(s->w, formula, &s->legal, ray, mode, list, tags);
    assert_int_equal(judge_world_list(s->judge[2], ray, mode, list, tags, count, &listed),
                     STATUS_OK);
    not_wrong(s, ray, mode, &listed.judgement, &listed.at_fault, "all");
}

static void sit(struct honest_seat *s, const struct judged_world *w, size_t f, size_t r,
                bool unknown)
{
    const enum query queries[3] = {QUERY_CLOSEST, QUERY_ANY, QUERY_ALL};
    struct model model = model_of(f, r, unknown);
    struct reason reason = {""};
    *s = (struct honest_seat){.w = w, .f = f, .r = r};
    s->legal = (struct legal){.rounding = model.rounding, .style = LEGAL_ALIKE};
    for (int q = 0; q < 3; q++)
        assert_int_equal(judge_make(w->oracle, &model, queries[q], &s->judge[q], &reason),
                         STATUS_OK);
}

/* Woop's edge functions may have any sign where a triangle is smaller than the rounding of its
 * distance: true if no mesh, of unit size, is nearly so. */
static bool is_near(const struct judged_world *w, const struct ray *ray)
{
    bool near = true;
    for (uint32_t i = 0; i < w->world.instance_count; i++) {
        struct twin_ray placed;
        if (w->world.instance[i].mesh == WORLD_NO_MESH)
            continue;
        twin_ray_of(&w->place[i], ROUNDING_IEEE, false, ray, &placed);
        for (int k = 0; k < 3; k++)
            near = near && fabs(placed.org_near[k]) < 0x1p18;
    }
    return near;
}

/* All rays of one world. */
static void ask_all(const struct judged_world *w, uint64_t i, size_t f, size_t r, bool unknown)
{
    struct honest_seat s;
    struct rng rng = rng_make(i, 11);
    sit(&s, w, f, r, unknown);
    for (int n = 0; n < RAYS; n++) {
        struct ray ray = judged_world_aim(w, &rng);
        struct ray_mode mode = judged_world_mode(&rng);
        s.legal.seed = i * RAYS + (uint64_t)n;
        if (!unknown || is_near(w, &ray))
            ask(&s, &ray, mode);
    }
    for (int q = 0; q < 3; q++)
        judge_free(s.judge[q]);
}

static uint64_t print_verdicts(void)
{
    uint64_t all = 0;
    for (int v = 0; v < VERDICT_COUNT; v++) {
        print_message("%s %llu  ", verdict_name((enum verdict)v), (unsigned long long)verdicts[v]);
        all += verdicts[v];
    }
    print_message("of %llu\n", (unsigned long long)all);
    return all;
}

static void honest_answers_are_never_wrong(void **state)
{
    (void)state;
    memset(verdicts, 0, sizeof verdicts);
    for (uint64_t i = 0; i < worlds(); i++) {
        struct judged_world w;
        judged_world_make(i, &w);
        for (size_t f = 0; f < OWN; f++)
            for (size_t r = 0; r < ROUNDINGS; r++)
                ask_all(&w, i, f, r, false);
        judged_world_free(&w);
    }
    uint64_t all = print_verdicts();
    assert_true(verdicts[VERDICT_RIGHT] > all / 2);
    assert_true(verdicts[VERDICT_BOUNDARY] > 0 && verdicts[VERDICT_TIE] > 0);
    assert_true(verdicts[VERDICT_OUT_OF_CONTRACT] < all / 8);
}

/* In C's arithmetic and in Vulkan's: Moeller and Trumbore, woop, and Pluecker's. */
static void nor_are_those_of_a_black_box(void **state)
{
    (void)state;
    static const size_t told[] = {0, 2, 3};
    memset(verdicts, 0, sizeof verdicts);
    ill = 0;
    for (uint64_t i = 0; i < 2 * worlds(); i++) {
        struct judged_world w;
        judged_world_make(i, &w);
        for (size_t f = 0; f < ARRAY_COUNT(told); f++)
            for (size_t r = 0; r < ROUNDINGS; r += 3) {
                w.affine = i % 2;
                ask_all(&w, i, told[f], r, true);
            }
        judged_world_free(&w);
    }
    uint64_t all = print_verdicts();
    print_message("ill-conditioned %llu\n", (unsigned long long)ill);
    assert_true(verdicts[VERDICT_RIGHT] > all / 3);
    assert_true(ill > 0 && ill < all / 3);
}

/* --- numbers that are not finite -------------------------------------------------------------- */

/* A triangle of size 4, placed 2^-k times as large. */
static void tiny_triangle(int k, struct judged_world *out)
{
    static const float corner[9] = {0, 0, 0, 4, 0, 0, 0, 4, 0};
    struct world world = {.mesh_count = 1, .instance_count = 1};
    world.mesh = calloc(1, sizeof *world.mesh);
    world.instance = calloc(1, sizeof *world.instance);
    assert_true(world.mesh && world.instance);
    world.mesh[0] =
        (struct world_mesh){calloc(1, sizeof(struct scene)), calloc(1, sizeof(struct geometry)), 1};
    assert_true(world.mesh[0].scene && world.mesh[0].geometry);
    assert_int_equal(scene_make(3, 1, world.mesh[0].scene), STATUS_OK);
    memcpy(world.mesh[0].scene->vertex, corner, sizeof corner);
    for (uint32_t i = 0; i < 3; i++)
        world.mesh[0].scene->index[i] = i;
    world.mesh[0].geometry[0] = (struct geometry){0, 1, true};
    world.instance[0] = (struct instance){.mask = 0xFF};
    for (int i = 0; i < 3; i++)
        world.instance[0].m[i][i] = ldexpf(1, -k);
    assert_int_equal(world_finish(&world, NULL), STATUS_OK);
    judged_world_of(world, out);
}

/* A hit of it with a number of a kind that overflow gives, as a closest one, an any-hit and a list;
 * `wrong`: it must be WRONG, else not judged. */
static void play_not_finite(const struct judged_world *w, const struct ray *ray,
                            const struct model *model, bool wrong)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    const struct ray_mode mode = {.mask = 0xFF};
    struct oracle_answer truth = judged_world_truth(w, ray, mode);
    assert_int_equal(truth.prim, 0);
    for (enum query query = 0; query < QUERY_COUNT; query++) {
        struct judge *judge;
        assert_int_equal(judge_make(w->oracle, model, query, &judge, NULL), STATUS_OK);
        for (int i = 0; i < 3 * 3; i++) {
            struct hit hit = {(float)truth.t_lo, 0.25f, 0.25f, 0};
            struct list_judgement list;
            struct judgement *j = &list.judgement;
            uint32_t tag = 0; /* the back: d . N > 0 */
            *(i / 3 == 0 ? &hit.t : i / 3 == 1 ? &hit.u : &hit.v) = bad[i % 3];
            if (query == QUERY_ALL)
                assert_int_equal(judge_world_list(judge, ray, mode, &hit, &tag, 1, &list), 0);
            else
                assert_int_equal(judge_world_answer(judge, ray, mode, &truth, &hit, tag, j), 0);
            assert_int_equal(j->verdict, wrong ? VERDICT_WRONG : VERDICT_OUT_OF_CONTRACT);
            assert_true(!wrong || j->wrong == WRONG_NOT_FINITE);
        }
        judge_free(judge);
    }
}

/* Products of a direction of 2^k, an origin of 2^j and edges overflow, sooner or later; where the
 * contract ends in the space of the mesh nothing is promised, by an unknown formula either. */
static void numbers_are_finite_in_contract(void **state)
{
    (void)state;
    for (int k = 0; k <= 60; k += 5)
        for (int j = 0; j <= 60; j += 5) {
            struct judged_world w;
            const float side = ldexpf(1, -k);
            const struct ray ray = {{side, side, -ldexpf(1, j - k)}, 0, {0, 0, 1}, INFINITY};
            bool in_contract = k <= 40 && j <= 40;
            tiny_triangle(k, &w);
            for (size_t f = 0; f < OWN; f++)
                for (size_t r = 0; r < 2 * ROUNDINGS; r++) {
                    struct model model = model_of(f, r % ROUNDINGS, r >= ROUNDINGS);
                    if (model.bits || (k != 40 && j != 40)) /* else roundings pass the end */
                        play_not_finite(&w, &ray, &model, in_contract);
                }
            judged_world_free(&w);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(honest_answers_are_never_wrong),
        cmocka_unit_test(nor_are_those_of_a_black_box),
        cmocka_unit_test(numbers_are_finite_in_contract),
    };
    return cmocka_run_group_tests_name("judge_world_honest", tests, NULL, NULL) ? 1 : 0;
}
