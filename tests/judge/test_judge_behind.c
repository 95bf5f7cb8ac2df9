/* An answer that names the nearest triangle, with a t within its error but behind the next hit:
 * that hit is lost. The nearest triangle is grazed, so that its t is hardly bounded; the next one
 * is met head-on. */
#include "ref/judge/judge_inner.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/judge/judge_fixture.h"

#include <math.h>

#define DISTANCE 4.0f

/* Triangle 0 rises by `slope` along x and meets the axis z at DISTANCE; triangle `edges` + 1 lies
 * across it, `gap` farther; those between have an edge there, between the two. */
static struct scene steep_behind(float slope, float gap, uint32_t edges)
{
    struct scene scene;
    assert_int_equal(scene_make(3 * edges + 6, edges + 2, &scene), STATUS_OK);
    for (uint32_t i = 0; i < scene.vertex_count; i++) {
        const float corner[3][2] = {{-1, -1}, {1, -1}, {0, 2}};
        float *v = &scene.vertex[3 * i], x = corner[i % 3][0];
        v[0] = i / 3 > 0 && i / 3 <= edges && i % 3 == 0 ? 0 : x;
        v[1] = corner[i % 3][1];
        v[2] =
            i < 3 ? DISTANCE + slope * x : DISTANCE + gap * (float)(i / 3 + 1) / (float)(edges + 2);
        scene.index[i] = i;
    }
    return scene;
}

static struct scene steep(float slope, float gap)
{
    return steep_behind(slope, gap, 0);
}

/* How far t of triangle 0 may be off. */
static double error_of(const struct judge_fixture *c)
{
    double error = judge_twin(c->judge, &c->ray, 0, NULL).t_err;
    return isfinite(error) ? error : 0;
}

static struct judge_fixture *steep_case(const struct fixture_subject *subject, float slope,
                                        float gap, enum query query)
{
    struct judge_fixture *c = judge_fixture_of(steep(slope, gap));
    judge_fixture_seat(c, subject, query);
    judge_fixture_ask(c, along_z(0, 0.125f));
    return c;
}

static struct hit at(const struct judge_fixture *c, double t)
{
    struct hit hit = right_answer(c, 0);
    hit.t = (float)t;
    return hit;
}

/* Before the next hit, and up to it, the nearest is right; behind it and its own error the next one
 * is lost; and any hit may be either. */
static void the_next_hit_is_lost(const struct fixture_subject *subject, float slope, float gap,
                                 enum query query)
{
    struct judge_fixture *c = steep_case(subject, slope, gap, query);
    double t = c->truth.t_lo, next = c->truth.t_next, error = error_of(c);
    assert_true(c->truth.prim == 0 && next > t && error > 4 * (next - t));
    must_be(c, at(c, t), VERDICT_RIGHT);
    must_be(c, at(c, t - 0.5 * error), VERDICT_RIGHT);
    must_be(c, at(c, (t + next) / 2), VERDICT_RIGHT);
    must_be(c, at(c, next), VERDICT_RIGHT);
    struct hit behind = at(c, t + 0.75 * error);
    if (query == QUERY_ANY) {
        must_be(c, behind, VERDICT_RIGHT);
    } else {
        must_be_wrong(c, behind, WRONG_MISSED);
        assert_true(c->judgement.behind);
        assert_int_equal(c->judgement.expected, 0);
        assert_int_equal(c->judgement.lost, 1);
        assert_true(c->judgement.lost_lo <= next && c->judgement.lost_hi >= next);
    }
    must_be_wrong(c, at(c, t + 1.5 * error), WRONG_DISTANCE);
    must_be_wrong(c, at(c, t - 1.5 * error), WRONG_DISTANCE);
    judge_fixture_close(c);
}

static void an_answer_behind_the_next_hit_has_lost_it(void **state)
{
    (void)state;
    uint32_t tried = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (float slope = 1000; slope < 2e6f && !is_unknown(&subjects[s]); slope *= 8)
            for (int query = QUERY_CLOSEST; query <= QUERY_ANY; query++) {
                struct judge_fixture *c = steep_case(&subjects[s], slope, 1, (enum query)query);
                double error = error_of(c);
                judge_fixture_close(c);
                if (error < 0x1p-10 || error > 1 ||
                    (query == QUERY_ANY && subjects[s].model.any_unnamed))
                    continue;
                the_next_hit_is_lost(&subjects[s], slope, (float)(error / 16), (enum query)query);
                tried++;
            }
    if (tried < 20)
        fail_msg("only %u tried", tried);
}

/* Behind a hit that cannot be missed by more than two of its errors. */
static void a_hit_is_lost_from_two_errors_on(void **state)
{
    (void)state;
    uint32_t tried = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (float slope = 1000; slope < 2e6f && !is_unknown(&subjects[s]); slope *= 8) {
            struct judge_fixture *c = steep_case(&subjects[s], slope, 1, QUERY_CLOSEST);
            double error = error_of(c);
            judge_fixture_close(c);
            if (error < 0x1p-10 || error > 1 || subjects[s].model.slab)
                continue;
            c = steep_case(&subjects[s], slope, (float)(error / 16), QUERY_CLOSEST);
            struct oracle_pair pair;
            oracle_pair(c->oracle, &c->ray, 1, &pair);
            double limit = pair.t_hi + 2 * judge_twin(c->judge, &c->ray, 1, NULL).t_err;
            float last = (float)limit;
            if ((double)last > limit)
                last = nextafterf(last, 0);
            must_be(c, at(c, (double)last), VERDICT_RIGHT);
            must_be_wrong(c, at(c, (double)nextafterf(last, 2 * DISTANCE)), WRONG_MISSED);
            assert_int_equal(c->judgement.lost, 1);
            judge_fixture_close(c);
            tried++;
        }
    assert_true(tried > 10);
}

/* Not Embree's default box test, whose error is that of these far coordinates. */
static bool has_exact_boxes(const struct fixture_subject *subject)
{
    return !is_unknown(subject) && !subject->model.slab;
}

/* Hits at edges may be missed, however many there are; the first that may not is named. */
static void hits_at_edges_are_not_lost(void **state)
{
    (void)state;
    static const uint32_t edges[] = {1, 2, 7, 8, 9, 15, 16, 17, 30};
    uint32_t tried = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (size_t e = 0; e < ARRAY_COUNT(edges) && has_exact_boxes(&subjects[s]); e++)
            for (uint32_t last = 0; last < 2; last++) {
                struct judge_fixture *c = judge_fixture_of(steep_behind(0x1p17f, 1, edges[e]));
                judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
                judge_fixture_ask(c, along_z(0, 0.125f));
                double gap = error_of(c) / 4;
                judge_fixture_close(c);
                struct scene scene = steep_behind(0x1p17f, (float)gap, edges[e]);
                scene.tri_count -= last; /* the one that cannot be missed */
                c = judge_fixture_of(scene);
                judge_fixture_seat(c, &subjects[s], QUERY_CLOSEST);
                judge_fixture_ask(c, along_z(0, 0.125f));
                struct hit behind = at(c, c->truth.t_lo + 3 * gap);
                if (gap < 0x1p-10) {
                    judge_fixture_close(c);
                    continue;
                }
                assert_int_equal(c->truth.prim, 0);
                if (last) {
                    must_be(c, behind, VERDICT_RIGHT);
                } else {
                    must_be_wrong(c, behind, WRONG_MISSED);
                    assert_int_equal(c->judgement.lost, edges[e] + 1);
                    assert_true(c->judgement.behind && c->judgement.expected == 0);
                }
                judge_fixture_close(c);
                tried++;
            }
    if (tried < 50)
        fail_msg("only %u tried", tried);
}

/* Without a next hit the nearest is right wherever its error reaches. */
static void without_a_next_hit_nothing_is_lost(void **state)
{
    (void)state;
    uint32_t tried = 0;
    for (size_t s = 0; s < SUBJECTS; s++)
        for (float slope = 1000; slope < 2e6f && !is_unknown(&subjects[s]); slope *= 8) {
            struct judge_fixture *c = steep_case(&subjects[s], slope, -100, QUERY_CLOSEST);
            double error = error_of(c);
            if (error > 0 && error < 1) {
                must_be(c, at(c, c->truth.t_lo + 0.75 * error), VERDICT_RIGHT);
                must_be(c, at(c, c->truth.t_lo - 0.75 * error), VERDICT_RIGHT);
                tried++;
            }
            judge_fixture_close(c);
        }
    assert_true(tried > 20);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_answer_behind_the_next_hit_has_lost_it),
        cmocka_unit_test(a_hit_is_lost_from_two_errors_on),
        cmocka_unit_test(hits_at_edges_are_not_lost),
        cmocka_unit_test(without_a_next_hit_nothing_is_lost),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
