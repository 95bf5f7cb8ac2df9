/* Why two paths part: tracers that lie in one known way, and what is said of them. The scene is two
 * mirrors, a floor and a lamp, so that paths have several segments and shadows. */
#include "tests/scenes/diff_why_fixture.h"

static void nothing_differs(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    count_whys(NONE, 0, why);
    assert_int_equal(why[WHY_SAME], WIDTH * HEIGHT);
}

static void an_ulp_is_rounding_or_drift(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    count_whys(ULP, 0, why);
    assert_true(why[WHY_ROUNDING] > WIDTH * HEIGHT / 4);
    assert_int_equal(why[WHY_RENDERER] + why[WHY_UNEXPLAINED], 0);
    assert_int_equal(why[WHY_WRONG], 0);
}

static void lies_are_wrong(void **state)
{
    (void)state;
    static const enum why_lie lies[] = {FAR_OFF, OTHER_PRIM, LOST_HIT};
    for (size_t i = 0; i < ARRAY_COUNT(lies); i++)
        for (uint32_t wave = 0; wave < 3; wave += 2) { /* of the first segment, and the second */
            size_t why[WHY_COUNT];
            count_whys(lies[i], wave, why);
            assert_true(why[WHY_WRONG] > 20);
            assert_int_equal(why[WHY_UNEXPLAINED] + why[WHY_DRIFT] + why[WHY_ROUNDING], 0);
        }
}

/* Known to be wrong; but not if the other one is wrong, too. */
static void faults_as_published_are_known(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    s.judges.published[1] = true;
    count_whys(LOST_HIT, 0, why);
    assert_true(why[WHY_PUBLISHED] > 20);
    assert_int_equal(why[WHY_WRONG] + why[WHY_UNEXPLAINED], 0);
    s.judges.published[0] = true;
    s.judges.published[1] = false;
    count_whys(LOST_HIT, 0, why);
    assert_true(why[WHY_WRONG] > 20);
    assert_int_equal(why[WHY_PUBLISHED], 0);
    s.judges.published[0] = false;
}

static void shadows_are_judged(void **state)
{
    (void)state;
    size_t why[WHY_COUNT];
    count_whys(LOST_SHADOW, 0, why);
    assert_true(why[WHY_WRONG] > 5);
    assert_int_equal(why[WHY_WRONG] + why[WHY_SAME], WIDTH * HEIGHT);
    count_whys(MADE_SHADOW, 0, why);
    assert_true(why[WHY_WRONG] > 50);
    assert_int_equal(why[WHY_WRONG] + why[WHY_SAME], WIDTH * HEIGHT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_walk_is_the_picture),         cmocka_unit_test(nothing_differs),
        cmocka_unit_test(an_ulp_is_rounding_or_drift),   cmocka_unit_test(lies_are_wrong),
        cmocka_unit_test(faults_as_published_are_known), cmocka_unit_test(shadows_are_judged),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
