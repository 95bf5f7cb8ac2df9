/* Laws of many answers in one call of ref/library/raydiff.h: each is judged as it is alone,
 * whatever stands before it, and the sums are those of the answers. */
#include "ref/library/raydiff.h"
#include "scenes/scenes.h"

#include <math.h>
#include <stdarg.h>
#include <setjmp.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "tests/library/library_fixture.h"

#define RAYS 40000u /* several times what is held at a time */
#define PART 1237u

struct library_many {
    float ray[8 * RAYS];
    uint32_t mask[RAYS];
    struct raydiff_nearest truth[RAYS];
    struct raydiff_answer answer[RAYS];
    struct raydiff_judged judged[RAYS], apart[RAYS];
};

static struct library_many *many;

static int make_many(void **state)
{
    (void)state;
    many = calloc(1, sizeof *many);
    return many ? 0 : -1;
}

static int free_many(void **state)
{
    (void)state;
    free(many);
    return 0;
}

/* The answer with the exact triangle and t; u and v in double. Instances lie 1.5 apart along x. */
static struct raydiff_answer right_answer(const struct raydiff_oracle *oracle,
                                          const struct scene *scene, uint32_t i)
{
    const struct raydiff_nearest *truth = &many->truth[i];
    struct raydiff_answer out = {(float)truth->t_lo, 0, 0, truth->triangle};
    uint32_t instance, triangle;
    double e[3][3], n[3], size = 0, u = 0, v = 0;
    float corner[3][3];
    if (truth->triangle == RAYDIFF_NOTHING)
        return out;
    assert_int_equal(raydiff_placed(oracle, truth->triangle, &instance, &triangle, NULL), 0);
    scene_tri(scene, triangle, corner);
    for (int k = 0; k < 3; k++) {
        const double from = (double)corner[0][k] + (k == 0 ? 1.5 * instance : 0);
        e[0][k] = (double)corner[1][k] - (double)corner[0][k];
        e[1][k] = (double)corner[2][k] - (double)corner[0][k];
        e[2][k] = (double)many->ray[8 * i + (uint32_t)k] +
                  truth->t_lo * (double)many->ray[8 * i + 4 + (uint32_t)k] - from;
    }
    for (int k = 0; k < 3; k++)
        n[k] = e[0][(k + 1) % 3] * e[1][(k + 2) % 3] - e[0][(k + 2) % 3] * e[1][(k + 1) % 3];
    for (int k = 0; k < 3; k++) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        size += n[k] * n[k];
        u += n[k] * (e[2][a] * e[1][b] - e[2][b] * e[1][a]);
        v += n[k] * (e[0][a] * e[2][b] - e[0][b] * e[2][a]);
    }
    out.u = (float)(u / size);
    out.v = (float)(v / size);
    return out;
}

/* Rays of the set, and the answers of a tracer that loses some hits and has some too far away. */
static void ask(const struct raydiff_oracle *oracle, const struct scene *scene, const char *set,
                bool masked)
{
    assert_int_equal(raydiff_hard_rays(oracle, set, 5, RAYS, many->ray, NULL), 0);
    for (uint32_t i = 0; i < RAYS; i++)
        many->mask[i] = i % 7 < 3 ? 1 : 3;
    assert_int_equal(
        raydiff_exact(oracle, many->ray, masked ? many->mask : NULL, RAYS, 2, many->truth, NULL),
        0);
    for (uint32_t i = 0; i < RAYS; i++) {
        many->answer[i] = right_answer(oracle, scene, i);
        if (i % 11 == 4)
            many->answer[i].triangle = RAYDIFF_NOTHING;
        if (i % 13 == 6)
            many->answer[i].t *= 1.5f;
    }
}

/* All at once, and PART at a time; returns how many are at fault. */
static uint64_t judge_both_ways(const struct raydiff_oracle *oracle, bool masked)
{
    struct raydiff_judging how = {.mask = masked ? many->mask : NULL};
    struct raydiff_counts all, sum = {0};
    struct raydiff_why why;
    if (raydiff_judge(oracle, &how, many->ray, many->answer, RAYS, 2, many->judged, &all, &why))
        fail_msg("%s", why.line);
    for (size_t from = 0; from < RAYS; from += PART) {
        const size_t part = RAYS - from < PART ? RAYS - from : PART;
        struct raydiff_counts counts;
        how.mask = masked ? many->mask + from : NULL;
        assert_int_equal(raydiff_judge(oracle, &how, many->ray + 8 * from, many->answer + from,
                                       part, 1, many->apart + from, &counts, NULL),
                         0);
        sum.answers += counts.answers;
        sum.hits += counts.hits;
        for (int k = 0; k < RAYDIFF_VERDICTS; k++)
            sum.verdict[k] += counts.verdict[k];
        for (int k = 0; k < RAYDIFF_FAULTS; k++)
            sum.fault[k] += counts.fault[k];
    }
    assert_memory_equal(many->judged, many->apart, sizeof many->judged);
    assert_int_equal(sum.answers, RAYS);
    assert_int_equal(all.answers, RAYS);
    assert_int_equal(sum.hits, all.hits);
    assert_memory_equal(sum.verdict, all.verdict, sizeof sum.verdict);
    assert_memory_equal(sum.fault, all.fault, sizeof sum.fault);
    return all.verdict[RAYDIFF_VERDICT_WRONG];
}

static void expect_truth(void)
{
    uint32_t apart = 0;
    for (uint32_t i = 0; i < RAYS; i++) {
        const struct raydiff_judged *one = &many->judged[i];
        assert_int_equal(one->expected, many->truth[i].triangle);
        assert_true(one->t_lo <= one->t_hi && one->t_hi - one->t_lo <= 0x1p-38 * fabs(one->t_hi));
        assert_memory_equal(&one->t_lo, &many->truth[i].t_lo, sizeof one->t_lo);
        assert_memory_equal(&one->t_hi, &many->truth[i].t_hi, sizeof one->t_hi);
        apart += one->t_lo < one->t_hi;
        if (many->truth[i].triangle == RAYDIFF_NOTHING)
            assert_true(!(one->t_lo < 0) && !(one->t_lo > 0) && !(one->t_hi > 0));
    }
    assert_true(apart > RAYS / 10);
}

static void an_answer_is_judged_as_it_is_alone(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("sphere:n=6");
    ask(stand.oracle, &stand.scene, NULL, false);
    assert_in_range(judge_both_ways(stand.oracle, false), RAYS / 20, RAYS / 2);
    expect_truth();
    library_stand_free(&stand);
}

static void a_mask_is_that_of_its_ray(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("sphere:n=6");
    const struct raydiff_mesh mesh = {stand.scene.vertex, stand.scene.index,
                                      stand.scene.vertex_count, stand.scene.tri_count};
    struct raydiff_instance instance[3];
    struct raydiff_oracle *oracle;
    for (uint32_t i = 0; i < 3; i++) {
        const float m[12] = {1, 0, 0, 1.5f * (float)i, 0, 1, 0, 0, 0, 0, 1, 0};
        memcpy(instance[i].transform, m, sizeof m);
        instance[i].mesh = 0;
        instance[i].mask = i == 1 ? 2 : 1;
    }
    assert_int_equal(raydiff_oracle_make_world(&mesh, 1, instance, 3, &oracle, NULL), 0);
    ask(oracle, &stand.scene, NULL, true);
    assert_in_range(judge_both_ways(oracle, true), RAYS / 20, RAYS / 2);
    expect_truth();
    raydiff_oracle_free(oracle);
    /* A mesh behind the last is none. */
    struct raydiff_why why;
    instance[2].mesh = 1;
    assert_int_equal(raydiff_oracle_make_world(&mesh, 1, instance, 3, &oracle, &why),
                     RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "instance 2: mesh 1, but the world has 1");
    instance[2].mesh = RAYDIFF_NOTHING;
    assert_int_equal(raydiff_oracle_make_world(&mesh, 1, instance, 3, &oracle, &why),
                     RAYDIFF_ERROR_INPUT);
    assert_string_equal(why.line, "instance 2: mesh 4294967295, but the world has 1");
    library_stand_free(&stand);
}

/* A tracer that loses every hit that is excused beside an edge: none is a fault alone, all of them
 * together are not rounding. */
static void hits_lost_beside_edges_are_a_fault_together(void **state)
{
    (void)state;
    struct library_stand stand = library_stand("sphere:n=6");
    struct raydiff_counts counts;
    ask(stand.oracle, &stand.scene, "edges", false);
    for (uint32_t i = 0; i < RAYS; i++)
        many->answer[i].triangle = RAYDIFF_NOTHING;
    assert_int_equal(raydiff_judge(stand.oracle, NULL, many->ray, many->answer, RAYS, 2,
                                   many->judged, &counts, NULL),
                     0);
    assert_true(counts.verdict[RAYDIFF_VERDICT_BOUNDARY] > 1000);
    for (uint32_t i = 0; i < RAYS; i++)
        if (many->judged[i].verdict != RAYDIFF_VERDICT_BOUNDARY)
            many->answer[i] = right_answer(stand.oracle, &stand.scene, i);
    assert_int_equal(raydiff_judge(stand.oracle, NULL, many->ray, many->answer, RAYS, 2,
                                   many->judged, &counts, NULL),
                     0);
    assert_int_equal(counts.verdict[RAYDIFF_VERDICT_WRONG], 0);
    assert_true(counts.beside_edges > 0);
    assert_int_equal(counts.faults, counts.beside_edges);
    library_stand_free(&stand);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_answer_is_judged_as_it_is_alone),
        cmocka_unit_test(a_mask_is_that_of_its_ray),
        cmocka_unit_test(hits_lost_beside_edges_are_a_fault_together),
    };
    return cmocka_run_group_tests_name("library_many", tests, make_many, free_many);
}
