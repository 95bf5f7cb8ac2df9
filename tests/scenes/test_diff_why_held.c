/* Why two paths part: what has no cause, the published profile, and pictures that are not their
 * walks. */
#include "tests/scenes/diff_why_fixture.h"

/* Paths of two engines that agree on every hit, but not on what follows from them. */
static void what_has_no_cause_is_unexplained(void **state)
{
    (void)state;
    struct diff_walk a, b;
    struct path_why found;
    size_t cut = 0, lit = 0;
    walk(honest, &a);
    walk(honest, &b);
    for (size_t i = 0; i < a.count; i++) {
        if (a.length[i] < 2)
            continue;
        b.length[i]--; /* ended early */
        assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
        assert_int_equal(found.why, WHY_UNEXPLAINED);
        assert_int_equal(found.segment, b.length[i]);
        b.length[i]++;
        struct walk_light *light = &b.light[i * b.bounces * b.lights];
        light->asked = !light->asked;
        assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
        assert_int_equal(found.why, WHY_UNEXPLAINED);
        assert_int_equal(found.light, 0);
        light->asked = !light->asked;
        if (light->asked) { /* the same answer, taken for a shadow here and for none there */
            light->shadowed = !light->shadowed;
            assert_int_equal(why_paths(&s.judges, &a, &b, i, &found, &reason), STATUS_OK);
            assert_int_equal(found.why, WHY_UNEXPLAINED);
            assert_int_equal(found.light, 0);
            light->shadowed = !light->shadowed;
            lit++;
        }
        cut++;
    }
    assert_true(cut > 20 && lit > 20);
    walk_free(&a);
    walk_free(&b);
}

static void the_published_profile_asks_otherwise(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    forget();
    prepare(PROFILE_RTRS);
    count_whys(NONE, 0, why);
    assert_int_equal(why[WHY_SAME], WIDTH * HEIGHT);
    count_whys(OTHER_PRIM, 0, why);
    assert_true(why[WHY_WRONG] > 50);
    count_whys(ULP, 0, why);
    assert_int_equal(why[WHY_WRONG] + why[WHY_RENDERER] + why[WHY_UNEXPLAINED], 0);
    a_walk_is_the_picture(state);
    forget();
    prepare(PROFILE_REPAIRED);
}

/* Whole pictures: what a renderer of its own made of right answers. */
static void pictures_are_held_to_their_walks(void **state)
{
    (void)state;
    struct engine_options options = {.device = -1};
    struct side other;
    struct pair pair;
    size_t *pixel, count, at = 0;
    assert_int_equal(side_draw(&s.cpu, &s.view, &reason), STATUS_OK);
    assert_int_equal(side_open(engine_find("cpu"), &options, &s.job, true, &other, &reason),
                     STATUS_OK);
    assert_int_equal(side_draw(&other, &s.view, &reason), STATUS_OK);
    assert_int_equal(pair_compare(&s.cpu, &other, &pair, &pixel, &count, &reason), STATUS_OK);
    assert_true(pair.same_bits && pair_agrees(&pair));
    assert_int_equal(count, 0);
    free(pixel);
    while (other.frame.segment[at * 3].prim == ABI_NO_PRIM ||
           other.frame.segment[at * 3].asked == 0)
        at++;
    other.frame.segment[at * 3].shadowed ^= 1u;
    other.frame.pixel[at + 1] ^= 0x40u;
    assert_int_equal(pair_compare(&s.cpu, &other, &pair, &pixel, &count, &reason), STATUS_OK);
    assert_int_equal(count, 2);
    assert_int_equal(pair.diff.field[PATH_SHADOWED], 1);
    assert_int_equal(pair.diff.excess, 1);
    assert_int_equal(pair.diff.largest, 0x40);
    assert_false(pair_agrees(&pair));
    assert_int_equal(pair_explain(&s.cpu, &other, &s.view, s.oracle, pixel, count, &pair, &reason),
                     STATUS_OK);
    assert_int_equal(pair.why[WHY_RENDERER], 2);
    assert_int_equal(pair.example[WHY_RENDERER][0].pixel, at);
    assert_int_equal(pair.example[WHY_RENDERER][0].field, PATH_SHADOWED);
    assert_int_equal(pair.example[WHY_RENDERER][0].why.side, 1);
    assert_int_equal(pair.example[WHY_RENDERER][1].pixel, at + 1);
    other.model.bits = false; /* explained or not, it is a fault */
    pair.same_bits = false;
    assert_false(pair_agrees(&pair));
    free(pixel);
    side_close(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_has_no_cause_is_unexplained),
        cmocka_unit_test(the_published_profile_asks_otherwise),
        cmocka_unit_test(pictures_are_held_to_their_walks),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
