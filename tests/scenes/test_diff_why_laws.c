/* Why two paths part, by laws: the largest error is that of all answers that differ, either order
 * names the same side, and the side that is not as published is at fault. */
#include "tests/scenes/diff_why_fixture.h"

/* A walk of a tracer that lies from a wave on. */
static void walk_lying(enum why_lie lie, uint32_t from_wave, struct diff_walk *out)
{
    s.lie = lie;
    s.at = from_wave;
    walk(lie == NONE ? honest : lying, out);
}

static struct path_why paths(const struct diff_walk *a, const struct diff_walk *b, size_t i)
{
    struct path_why found;
    assert_int_equal(why_paths(&s.judges, a, b, i, &found, &reason), STATUS_OK);
    return found;
}

static double over_of(unsigned side, bool shadow, const struct ray *ray, const struct hit *hit)
{
    struct why_answer answer;
    assert_int_equal(why_judge(&s.judges, side, shadow, ray, hit, &answer, &reason), STATUS_OK);
    assert_memory_equal(&answer.ray, ray, sizeof *ray);
    assert_memory_equal(&answer.hit, hit, sizeof *hit);
    return answer.judgement.over;
}

static double over_of_both(bool shadow, const struct ray *ray[2], const struct hit *hit[2])
{
    if (memcmp(ray[0], ray[1], sizeof *ray[0]) == 0 && memcmp(hit[0], hit[1], sizeof *hit[0]) == 0)
        return 0;
    return fmax(over_of(0, shadow, ray[0], hit[0]), over_of(1, shadow, ray[1], hit[1]));
}

/* The largest err/E of two paths that have the same triangles and shadows. */
static double largest(const struct diff_walk *a, const struct diff_walk *b, size_t i)
{
    double over = 0;
    for (uint32_t k = 0; k < a->length[i]; k++) {
        const struct walk_step *step[2] = {walk_step_of(a, i, k), walk_step_of(b, i, k)};
        const struct ray *ray[2] = {&step[0]->ray, &step[1]->ray};
        const struct hit *hit[2] = {&step[0]->hit, &step[1]->hit};
        over = fmax(over, over_of_both(false, ray, hit));
        for (uint32_t l = 0; l < a->lights && hit[0]->prim != ABI_NO_PRIM; l++) {
            const struct walk_light *light[2] = {walk_light_of(a, i, k, l),
                                                 walk_light_of(b, i, k, l)};
            const struct ray *to[2] = {&light[0]->ray, &light[1]->ray};
            const struct hit *met[2] = {&light[0]->hit, &light[1]->hit};
            if (light[0]->asked)
                over = fmax(over, over_of_both(true, to, met));
        }
    }
    return over;
}

static void errors_are_the_largest_of_a_path(void **state)
{
    (void)state;
    struct diff_walk a, b;
    size_t rounded = 0, earlier = 0;
    walk_lying(NONE, 0, &a);
    walk_lying(ULP, 0, &b);
    for (size_t i = 0; i < a.count; i++) {
        struct path_why found = paths(&a, &b, i), turned = paths(&b, &a, i);
        assert_int_equal(found.why, turned.why);
        if (found.why != WHY_ROUNDING && found.why != WHY_SAME)
            continue;
        assert_int_equal(found.segment, a.length[i]);
        assert_int_equal(found.light, WHY_NO_LIGHT);
        assert_false(found.answer[0].judged || found.answer[1].judged);
        double over = largest(&a, &b, i);
        assert_true(found.over == over && turned.over == over);
        rounded += over > 0;
        const struct ray *ray[2] = {&walk_step_of(&a, i, a.length[i] - 1)->ray,
                                    &walk_step_of(&b, i, a.length[i] - 1)->ray};
        const struct hit *hit[2] = {&walk_step_of(&a, i, a.length[i] - 1)->hit,
                                    &walk_step_of(&b, i, a.length[i] - 1)->hit};
        earlier += over_of_both(false, ray, hit) < over;
    }
    assert_true(rounded > 20 && earlier > 5);
    walk_free(&a);
    walk_free(&b);
}

/* The liar is named in either order; the answers are those of the sides. */
static void either_order_names_the_liar(void **state)
{
    (void)state;
    static const enum why_lie lies[] = {FAR_OFF, OTHER_PRIM, LOST_HIT, LOST_SHADOW, MADE_SHADOW};
    struct diff_walk a, b;
    walk_lying(NONE, 0, &a);
    for (size_t k = 0; k < ARRAY_COUNT(lies); k++) {
        size_t wrong = 0;
        walk_lying(lies[k], 0, &b);
        for (size_t i = 0; i < a.count; i++) {
            struct path_why found = paths(&a, &b, i), turned = paths(&b, &a, i);
            assert_int_equal(found.why, turned.why);
            assert_true(found.segment == turned.segment && found.light == turned.light);
            if (found.why != WHY_WRONG)
                continue;
            assert_true(found.side == 1 && turned.side == 0);
            for (unsigned side = 0; side < 2; side++) {
                const struct why_answer *one = &found.answer[side],
                                        *same = &turned.answer[1 - side];
                assert_true(one->judged && same->judged);
                assert_memory_equal(&one->hit, &same->hit, sizeof one->hit);
                assert_int_equal(one->judgement.verdict == VERDICT_WRONG, side == 1);
                assert_int_equal(same->judgement.verdict == VERDICT_WRONG, side == 1);
            }
            wrong++;
        }
        assert_true(wrong > 5);
        walk_free(&b);
    }
    walk_free(&a);
}

/* Both are wrong in other ways: at fault is the one that is not as published. */
static void of_two_liars_the_published_one_is_excused(void **state)
{
    (void)state;
    struct diff_walk a, b;
    size_t both = 0;
    walk_lying(LOST_HIT, 0, &a);
    walk_lying(FAR_OFF, 0, &b);
    for (unsigned published = 0; published < 4; published++) {
        s.judges.published[0] = published & 1;
        s.judges.published[1] = published >> 1;
        for (size_t i = 0; i < a.count; i++) {
            struct path_why found = paths(&a, &b, i);
            if (found.answer[0].judgement.verdict != VERDICT_WRONG ||
                found.answer[1].judgement.verdict != VERDICT_WRONG || !found.answer[0].judged)
                continue;
            assert_int_equal(found.why, published == 3 ? WHY_PUBLISHED : WHY_WRONG);
            if (published == 1 || published == 2)
                assert_int_equal(found.side, published == 1);
            both++;
        }
    }
    s.judges.published[0] = s.judges.published[1] = false;
    assert_true(both > 80);
    walk_free(&a);
    walk_free(&b);
}

static enum verdict verdict_of(unsigned side, const struct walk_step *step)
{
    struct why_answer answer;
    assert_int_equal(why_judge(&s.judges, side, false, &step->ray, &step->hit, &answer, &reason),
                     STATUS_OK);
    return answer.judgement.verdict;
}

/* Two answers to one ray, neither of them wrong: the verdict is that of the first side that is not
 * simply right, be it a tie or nearly one. */
static void parting_must_be_allowed(const struct diff_walk *a, const struct diff_walk *b, size_t i,
                                    size_t met[VERDICT_COUNT])
{
    struct path_why found = paths(a, b, i);
    uint32_t at = 0;
    while (at < a->length[i] && at < b->length[i] &&
           walk_step_of(a, i, at)->hit.prim == walk_step_of(b, i, at)->hit.prim)
        at++;
    if (at == a->length[i] || at == b->length[i])
        return;
    const struct walk_step *of[2] = {walk_step_of(a, i, at), walk_step_of(b, i, at)};
    if (memcmp(&of[0]->ray, &of[1]->ray, sizeof of[0]->ray) != 0 || found.segment < at)
        return; /* after an earlier difference */
    enum verdict verdict[2] = {verdict_of(0, of[0]), verdict_of(1, of[1])};
    if (verdict[0] == VERDICT_WRONG || verdict[1] == VERDICT_WRONG) { /* an ulp is far there */
        assert_int_equal(found.why, WHY_WRONG);
        return;
    }
    unsigned side = verdict[0] == VERDICT_RIGHT;
    bool open = verdict[side] != VERDICT_RIGHT;
    assert_int_equal(found.why, open ? WHY_ALLOWED : WHY_UNEXPLAINED);
    assert_true(found.segment == at && found.light == WHY_NO_LIGHT);
    if (!open)
        return;
    assert_int_equal(found.side, side);
    assert_int_equal(found.verdict, verdict[side]);
    assert_true(found.answer[0].judged && found.answer[1].judged);
    assert_int_equal(found.answer[0].hit.prim, of[0]->hit.prim);
    assert_int_equal(found.answer[1].hit.prim, of[1]->hit.prim);
    met[verdict[side]] += side + 1;
}

static void ties_part_paths_as_they_may(void **state)
{
    (void)state;
    for (uint32_t wave = 0; wave < 3; wave += 2) {
        struct diff_walk a, b;
        size_t met[VERDICT_COUNT] = {0}, turned[VERDICT_COUNT] = {0}, why[WHY_COUNT];
        walk_lying(NONE, 0, &a);
        walk_lying(TWIN_PRIM, wave, &b);
        for (size_t i = 0; i < a.count; i++) {
            parting_must_be_allowed(&a, &b, i, met);
            parting_must_be_allowed(&b, &a, i, turned);
        }
        assert_true(met[VERDICT_TIE] > 10 && met[VERDICT_NEAR_TIE] > 10);
        assert_true(turned[VERDICT_TIE] > 10 && turned[VERDICT_NEAR_TIE] > 10);
        assert_true(met[VERDICT_NEAR_TIE] != turned[VERDICT_NEAR_TIE]); /* the other side */
        walk_free(&a);
        walk_free(&b);
        count_whys(TWIN_PRIM, wave, why);
        assert_true(why[WHY_ALLOWED] > 20);
        assert_int_equal(why[WHY_UNEXPLAINED] + why[WHY_RENDERER], 0);
    }
}

/* Below the shade lies the floor: a shadow ray may meet either, another ray the nearer alone. */
static void shadow_rays_may_meet_any(void **state)
{
    (void)state;
    struct ray ray = {.org = {0.1f, 4, 0.2f}, .dir = {0, -1, 0}, .tmax = 10}, beyond = ray;
    struct hit near, far;
    beyond.tmin = 3;
    assert_int_equal(honest(NULL, QUERY_CLOSEST, &ray, 1, &near, &reason), STATUS_OK);
    assert_int_equal(honest(NULL, QUERY_CLOSEST, &beyond, 1, &far, &reason), STATUS_OK);
    assert_true(near.prim / 2 == 3 && far.prim / 2 == 0);
    for (unsigned side = 0; side < 2; side++)
        for (int shadow = 0; shadow < 2; shadow++) {
            struct why_answer answer;
            assert_int_equal(why_judge(&s.judges, side, shadow, &ray, &near, &answer, &reason),
                             STATUS_OK);
            assert_int_equal(answer.judgement.verdict, VERDICT_RIGHT);
            assert_int_equal(answer.truth.prim, near.prim);
            assert_int_equal(why_judge(&s.judges, side, shadow, &ray, &far, &answer, &reason),
                             STATUS_OK);
            assert_int_equal(answer.judgement.verdict == VERDICT_WRONG, !shadow);
        }
    size_t why[WHY_COUNT];
    count_whys(NONE, 0, why);
    assert_int_equal(why[WHY_SAME], WIDTH * HEIGHT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_walk_is_the_picture),
        cmocka_unit_test(errors_are_the_largest_of_a_path),
        cmocka_unit_test(either_order_names_the_liar),
        cmocka_unit_test(of_two_liars_the_published_one_is_excused),
        cmocka_unit_test(ties_part_paths_as_they_may),
        cmocka_unit_test(shadow_rays_may_meet_any),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
