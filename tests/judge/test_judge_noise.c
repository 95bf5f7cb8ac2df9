/* What a formula can come to is allowed, and so is what is exactly right; of triangles whose
 * determinant may be 0 nothing else. */
#include "ref/twin/twin_replay.h"
#include "ref/base/rng.h"
#include "tests/judge/degenerate.h"
#include "tests/exact/trials.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/honest_count.h"
#include "tests/judge/judge_fixture.h"
#include "tests/support/stand.h"
#include "ref/primitives/test_run.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const struct stand_rounding liberties[] = {
    {"ieee", ROUNDING_IEEE, false},      {"ieee, fused", ROUNDING_IEEE, true},
    {"flushed", ROUNDING_FLUSHED, true}, {"vulkan rte", ROUNDING_VULKAN_RTE, true},
    {"vulkan", ROUNDING_VULKAN, true},   {"embree", ROUNDING_EMBREE, true},
};

static struct replay_answer answer_of(const struct evaluation *e)
{
    return (struct replay_answer){{(double)e->t, (double)e->u, (double)e->v},
                                  {(double)e->t, (double)e->u, (double)e->v}};
}

static uint64_t tries(uint64_t quick)
{
    return getenv("RAYDIFF_SLOW") ? 20 * quick : quick;
}

struct noise_tally {
    uint64_t evaluations, exact, accepted, open;
    struct honest_count honest;
};

/* The triangle alone, before the judge of an engine with this formula and rounding. */
static struct judge_fixture *judge_fixture_alone(const struct trials_trial *trial,
                                                 const struct fixture_subject *subject)
{
    struct scene scene;
    assert_int_equal(scene_make(3, 1, &scene), STATUS_OK);
    for (uint32_t c = 0; c < 3; c++)
        scene.index[c] = c;
    memcpy(scene.vertex, trial->v, sizeof trial->v);
    struct judge_fixture *c = judge_fixture_of(scene);
    judge_fixture_seat(c, subject, QUERY_CLOSEST);
    judge_fixture_ask(c, trial->ray);
    return c;
}

static void must_be_believed(struct judge_fixture *c, struct hit answer, struct noise_tally *tally)
{
    char line[400];
    bool refused = verdict(c, answer) == VERDICT_WRONG;
    if (refused && tally->honest.refused < HONEST_SHOWN) {
        judge_line(&c->ray, &c->judgement, &answer, line, sizeof line);
        print_message("%s: an honest answer is WRONG (%s): %s\n", c->subject->name,
                      wrong_name(c->judgement.wrong), line);
    }
    honest_counted(&tally->honest, refused);
}

/* The answer that is exactly right, but for its float32. False: an open range ends there, or the
 * line meets the plane in more than a point. */
static bool exact_answer(const struct judge_fixture *c, const struct truth *truth, struct hit *out)
{
    *out = a_miss();
    if (c->truth.prim == ABI_NO_PRIM)
        return true;
    *out = (struct hit){(float)truth->t.head, (float)truth->weight[1].head,
                        (float)truth->weight[2].head, 0};
    return truth->point &&
           (!c->subject->model.open || (out->t > c->ray.tmin && out->t < c->ray.tmax));
}

static bool is_answer(const struct evaluation *e)
{
    return isfinite(e->t) && isfinite(e->u) && isfinite(e->v);
}

/* The replay comes to what was answered. */
static void must_be_possible(const struct trials_trial *trial, size_t f,
                             const struct liberty *liberty, const struct evaluation *e,
                             const char *what, struct noise_tally *tally)
{
    const struct ray *ray = &trial->ray;
    struct replay_answer a = answer_of(e);
    const struct replay_answer any = {{(double)ray->tmin, 0, 0}, {(double)ray->tmax, 1, 1}};
    float v[3][3];
    memcpy(v, trial->v, sizeof v);
    bool one = replay_can_answer(formulas[f].formula, liberty, ray, v, &any);
    bool this = replay_can_answer(formulas[f].formula, liberty, ray, v, &a);
    if ((!one || !this) && tally->honest.refused < HONEST_SHOWN) {
        print_pair(ray, trial->v);
        print_message("%s, %s: t %a u %a v %a was answered, and %s is possible\n", formulas[f].name,
                      what, (double)e->t, (double)e->u, (double)e->v, one ? "another" : "nothing");
    }
    honest_counted(&tally->honest, !one || !this);
}

/* What is exactly right, and what the roundings make of it. */
static void check(struct trials_trial *trial, uint64_t index, size_t f, size_t r, const char *what,
                  struct noise_tally *tally)
{
    static const enum legal_style styles[] = {LEGAL_ALL_NEAREST, LEGAL_ALL_LOW, LEGAL_ALL_HIGH,
                                              LEGAL_ALIKE, LEGAL_ALIKE};
    enum twin_formula formula = formulas[f].formula;
    struct liberty liberty = {liberties[r].rounding, liberties[r].fuses};
    struct fixture_subject subject = {formulas[f].name,
                                      twin_is_own(formula) ? formulas[f].name : "mt",
                                      {.formula = formula,
                                       .rounding = liberty.rounding,
                                       .bits = !liberty.fuses,
                                       .open = formula == TWIN_MT_RTRS}};
    struct judge_fixture *c = judge_fixture_alone(trial, &subject);
    struct legal legal = {.rounding = liberty.rounding, .fuses = liberty.fuses};
    struct twin twin = twin_eval(formula, liberty.rounding, &trial->ray, trial->v);
    struct hit exact;
    bool is_small = formula == TWIN_MT_RTRS && !twin.possible; /* below its own epsilon */
    if ((c->truth.prim == ABI_NO_PRIM || !is_small) && exact_answer(c, &trial->truth, &exact)) {
        tally->exact++;
        must_be_believed(c, exact, tally);
    }
    for (size_t s = 0; s < ARRAY_COUNT(styles); s++) {
        legal.style = styles[s];
        legal.seed = index * 8 + s;
        struct evaluation e = legal_evaluate(&legal, formula, &trial->ray, trial->v);
        tally->evaluations++;
        if (!e.accepted)
            must_be_believed(c, a_miss(), tally);
        if (!e.accepted || !is_answer(&e))
            continue;
        tally->accepted++;
        tally->open += isfinite(twin.t_err) ? 0 : 1;
        must_be_believed(c, (struct hit){e.t, e.u, e.v, 0}, tally);
        must_be_possible(trial, f, &liberty, &e, what, tally);
    }
    judge_fixture_close(c);
}

typedef void draw_fn(int kind, uint64_t index, struct gmp_pair *pair, struct trials_trial *out);

static void draw_degenerate(int kind, uint64_t index, struct gmp_pair *pair,
                            struct trials_trial *out)
{
    struct rng rng = rng_make(index, (uint64_t)kind);
    degenerate_triangle((enum degenerate)kind, &rng, out->v);
    out->ray = degenerate_ray((enum degenerate)kind, &rng, out->v);
    if (pair_in_contract(&out->ray, out->v))
        trial_truth(pair, out);
}

static const char *degenerate_kind(int kind)
{
    return degenerate_names[kind];
}

static void check_all(draw_fn *draw, const char *(*name)(int), int kinds, uint64_t each)
{
    uint64_t refused = 0;
    struct gmp_pair pair;
    exact_gmp_init(&pair);
    for (size_t f = 0; f < ARRAY_COUNT(formulas); f++)
        for (size_t r = 0; r < ARRAY_COUNT(liberties); r++) {
            struct noise_tally tally = {.honest = honest_begun()};
            for (int kind = 0; kind < kinds; kind++)
                for (uint64_t i = 0; i < each; i++) {
                    struct trials_trial trial;
                    draw(kind, i, &pair, &trial);
                    if (pair_in_contract(&trial.ray, trial.v))
                        check(&trial, i, f, r, name(kind), &tally);
                }
            print_message("%-15s %-12s %8llu evaluations, accepted %8llu, open %8llu; "
                          "exact %8llu\n",
                          formulas[f].name, liberties[r].name,
                          (unsigned long long)tally.evaluations, (unsigned long long)tally.accepted,
                          (unsigned long long)tally.open, (unsigned long long)tally.exact);
            refused += honest_ended(&tally.honest, formulas[f].name);
        }
    exact_gmp_clear(&pair);
    assert_int_equal(refused, 0);
}

static void legal_answers_are_possible(void **state)
{
    (void)state;
    check_all(trial_make, trial_kind, TRIAL_KINDS, tries(40));
}

static void legal_answers_of_degenerate_triangles_are_possible(void **state)
{
    (void)state;
    check_all(draw_degenerate, degenerate_kind, DEGENERATE_COUNT, tries(200));
}

/* --- the cheat: the degenerate triangle is answered, whatever the ray, so that it hides all --- */

/* The wall at z = 40, and the triangle before it as number 2. */
static struct scene wall_with(float v[3][3])
{
    struct scene scene;
    static const float corner[4][3] = {
        {-999, -999, 40}, {999, -999, 40}, {999, 999, 40}, {-999, 999, 40}};
    static const uint32_t index[3][3] = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}};
    assert_int_equal(scene_make(7, 3, &scene), STATUS_OK);
    memcpy(scene.vertex, corner, sizeof corner);
    memcpy(scene.vertex + 12, v, 9 * sizeof(float));
    memcpy(scene.index, index, sizeof index);
    return scene;
}

/* Does the judge take some answer of triangle 2 that hides the wall, at the triangle or elsewhere?
 */
static bool hides(struct judge_fixture *c, bool at_triangle)
{
    static const double share[] = {0.5, 0.01, 0.3, 0.77, 0.999};
    static const float weight[][2] = {{0.25f, 0.25f}, {0, 0},       {1, 0},
                                      {0, 1},         {0.5f, 0.5f}, {0.3333333f, 0.3333333f},
                                      {0.5f, 0},      {0.1f, 0.7f}};
    float v[3][3];
    double on = 0, length = 0;
    scene_tri(&c->scene, 2, v);
    for (int k = 0; k < 3; k++) { /* the ray's point nearest to the first vertex */
        double d = (double)c->ray.dir[k];
        on += d * ((double)v[0][k] - (double)c->ray.org[k]);
        length += d * d;
    }
    struct tri_ray ready = tri_ray_make(&c->ray);
    double level = ((double)v[0][ready.kz] - (double)ready.o[ready.kz]) / (double)ready.d[ready.kz];
    size_t all = ARRAY_COUNT(share) + (at_triangle ? 2 : 0);
    for (size_t s = 0; s < all; s++)
        for (size_t w = 0; w < ARRAY_COUNT(weight); w++) {
            double t = s < ARRAY_COUNT(share)    ? share[s] * c->truth.t_lo
                       : s == ARRAY_COUNT(share) ? on / length
                                                 : level;
            if (!(t < c->truth.t_lo))
                continue;
            struct hit hit = {(float)t, weight[w][0], weight[w][1], 2};
            if (verdict(c, hit) != VERDICT_WRONG)
                return true;
        }
    return false;
}

/* Rays to the wall: of a camera, or in the triangle's plane. */
static struct ray wall_ray(enum degenerate kind, bool aimed, struct rng *rng, float v[3][3])
{
    if (aimed)
        return degenerate_ray(kind, rng, v);
    return (struct ray){{0.5f, 0.25f, -20},
                        0,
                        {rng_range(rng, -0.5f, 0.5f), rng_range(rng, -0.5f, 0.5f), 1},
                        0x1p60f};
}

static size_t hidden(const struct fixture_subject *subject, enum degenerate kind, bool aimed,
                     size_t *rays)
{
    size_t count = 0;
    *rays = 0;
    for (uint64_t i = 0; i < tries(4); i++) {
        struct rng rng = rng_make(i, (uint64_t)kind + 100);
        float v[3][3];
        degenerate_triangle(kind, &rng, v);
        struct judge_fixture *c = judge_fixture_of(wall_with(v));
        judge_fixture_seat(c, subject, QUERY_CLOSEST);
        for (int k = 0; k < 20; k++) {
            struct ray ray = wall_ray(kind, aimed, &rng, v);
            if (!ray_in_contract(&ray))
                continue;
            judge_fixture_ask(c, ray);
            if (c->truth.prim == ABI_NO_PRIM || c->truth.prim == 2)
                continue;
            ++*rays;
            count += hides(c, !aimed); /* an aimed ray is at it, exactly or nearly */
        }
        judge_fixture_close(c);
    }
    return count;
}

/* Exactly 0 in every evaluation, so that nothing can be hidden. */
static bool is_nothing(enum degenerate kind)
{
    return kind == ALL_EQUAL || kind == ON_AXIS;
}

static void a_degenerate_triangle_hides_nothing_that_it_is_not_before(void **state)
{
    (void)state;
    for (int aimed = 0; aimed < 2; aimed++)
        for (size_t s = 0; s < SUBJECTS; s++) {
            if (is_unknown(&subjects[s]))
                continue;
            char line[300] = "";
            size_t all = 0, hid = 0;
            for (int kind = 0; kind < DEGENERATE_COUNT; kind++) {
                size_t rays, count = hidden(&subjects[s], (enum degenerate)kind, aimed, &rays);
                snprintf(line + strlen(line), sizeof line - strlen(line), " %zu/%zu", count, rays);
                all += rays;
                hid += count;
                assert_true(rays > 0);
                if (is_nothing((enum degenerate)kind) && count)
                    fail_msg("%s: %s hides %zu of %zu rays", subjects[s].name,
                             degenerate_names[kind], count, rays);
            }
            print_message("%-7s %-24s%s\n", aimed ? "aimed" : "camera", subjects[s].name, line);
            size_t limit = !aimed ? 1000 : rounding_is_nearest(subjects[s].model.rounding) ? 20 : 4;
            if (hid * limit > all)
                fail_msg("%s: %zu of %zu rays are hidden", subjects[s].name, hid, all);
        }
}

/* What C itself comes to is allowed, unless a certain hit lies before it. */
static void noise_does_not_excuse_a_certain_hit_before_it(void **state)
{
    (void)state;
    size_t kept[VERDICT_COUNT] = {0}, missed = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (uint64_t i = 0; i < tries(4000); i++) {
            struct rng rng = rng_make(i, s);
            enum degenerate kind = (enum degenerate)(i % DEGENERATE_COUNT);
            float v[3][3];
            struct hit hit = {.prim = 2};
            degenerate_triangle(kind, &rng, v);
            struct ray ray = degenerate_ray(kind, &rng, v);
            struct tri_ray ready = tri_ray_make(&ray);
            if (!subjects[s].model.bits || !ray_in_contract(&ray) ||
                !tri_test_run(tri_test_find(subjects[s].tri)->id, &ready, v, &hit))
                continue;
            struct judge_fixture *c = judge_fixture_of(wall_with(v));
            judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
            judge_fixture_ask(c, ray);
            bool lost = c->truth.prim < 2 && (double)hit.t > c->truth.t_hi * 1.001 &&
                        c->truth.margin > 0.01f;
            if (verdict(c, hit) == VERDICT_WRONG && c->judgement.wrong != WRONG_MISSED)
                must_be(c, hit, VERDICT_NOISE);
            if (lost)
                must_be_wrong(c, hit, WRONG_MISSED);
            missed += lost;
            kept[c->judgement.verdict]++;
            judge_fixture_close(c);
        }
    print_message("noise %zu, in_plane %zu, boundary %zu, a wall before it %zu\n",
                  kept[VERDICT_NOISE], kept[VERDICT_IN_PLANE], kept[VERDICT_BOUNDARY], missed);
    assert_true(kept[VERDICT_NOISE] > 0 && kept[VERDICT_IN_PLANE] > 0);
    assert_true(kept[VERDICT_BOUNDARY] > 0 && missed > 0);
}

/* Nor is the exact t of a sliver that is exactly hit, though its determinant's sign be open. */
static void the_exact_hit_of_a_sliver_is_not_wrong(void **state)
{
    (void)state;
    size_t open = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (uint64_t i = 0; i < tries(500); i++) {
            struct rng rng = rng_make(i, s + 40);
            enum degenerate kind = i % 2 ? SLIVER : NEAR_LINE;
            float v[3][3];
            degenerate_triangle(kind, &rng, v);
            struct judge_fixture *c = judge_fixture_of(wall_with(v));
            judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
            judge_fixture_ask(c, degenerate_ray(kind, &rng, v));
            struct twin twin =
                twin_eval(subjects[s].model.formula, subjects[s].model.rounding, &c->ray, v);
            if (!is_unknown(&subjects[s]) && ray_in_contract(&c->ray) && c->truth.prim == 2 &&
                twin.possible && !isfinite(twin.t_err)) {
                struct hit hit = {(float)c->truth.t_lo, 0.25f, 0.25f, 2};
                if (verdict(c, hit) == VERDICT_WRONG)
                    must_be(c, hit, VERDICT_BOUNDARY);
                open++;
            }
            judge_fixture_close(c);
        }
    print_message("%zu slivers hit with an open determinant\n", open);
    assert_true(open > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(legal_answers_are_possible),
        cmocka_unit_test(legal_answers_of_degenerate_triangles_are_possible),
        cmocka_unit_test(noise_does_not_excuse_a_certain_hit_before_it),
        cmocka_unit_test(the_exact_hit_of_a_sliver_is_not_wrong),
        cmocka_unit_test(a_degenerate_triangle_hides_nothing_that_it_is_not_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
