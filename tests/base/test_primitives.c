/* Laws of ref/primitives/: the tables and the contract of rays. The tests themselves: test_boxes.c
 * and test_triangles.c. */
#include "ref/base/base.h"
#include "ref/primitives/primitives.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

static void tables_find_every_name_and_no_other(void **state)
{
    (void)state;
    for (size_t i = 0; box_tests[i]; i++)
        assert_ptr_equal(box_test_find(box_tests[i]->name), box_tests[i]);
    for (size_t i = 0; tri_tests[i]; i++)
        assert_ptr_equal(tri_test_find(tri_tests[i]->name), tri_tests[i]);
    assert_null(box_test_find("Robust"));
    assert_null(tri_test_find(""));
    assert_int_equal(box_test_find("rtrs")->id, ABI_BOX_RTRS);
    assert_int_equal(box_test_find("robust")->id, ABI_BOX_ROBUST);
    assert_int_equal(tri_test_find("mt_rtrs")->id, ABI_TRI_MT_RTRS);
    assert_int_equal(tri_test_find("mt")->id, ABI_TRI_MT);
    assert_int_equal(tri_test_find("woop")->id, ABI_TRI_WOOP);
}

static void tables_begin_with_a_repaired_member(void **state)
{
    (void)state;
    assert_string_equal(box_tests[0]->name, "robust");
    assert_string_equal(tri_tests[0]->name, "mt");
    assert_true(box_test_find("rtrs")->faithful && tri_test_find("mt_rtrs")->faithful);
    assert_false(box_tests[0]->faithful || tri_tests[0]->faithful);
    assert_true(tri_test_find("woop")->watertight && tri_test_find("mt_rtrs")->open);
}

static void queries_have_three_names(void **state)
{
    (void)state;
    enum query query = QUERY_ANY;
    assert_true(query_find("closest", &query) && query == QUERY_CLOSEST);
    assert_true(query_find("any", &query) && query == QUERY_ANY);
    assert_true(query_find("all", &query) && query == QUERY_ALL);
    assert_false(query_find("alle", &query));
    assert_string_equal(query_name(QUERY_CLOSEST), "closest");
    assert_string_equal(query_name(QUERY_ANY), "any");
    assert_string_equal(query_name(QUERY_ALL), "all");
}

/* Is a ray in contract that differs from a good one in one float? Word 0-2 origin, 3 tmin, 4-6
 * direction (1, 1, 1), 7 tmax. */
static bool contract_with(int word, float value)
{
    float w[8] = {0, 0, 0, 0, 1, 1, 1, 10};
    struct ray ray;
    w[word] = value;
    memcpy(&ray, w, sizeof ray);
    return ray_in_contract(&ray);
}

static void contract_has_closed_borders(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            float s = (float)sign;
            assert_true(contract_with(k, s * 0x1p40f));
            assert_false(contract_with(k, s * nextafterf(0x1p40f, INFINITY)));
            assert_true(contract_with(4 + k, s * 0x1p40f));
            assert_false(contract_with(4 + k, s * nextafterf(0x1p40f, INFINITY)));
            assert_true(contract_with(4 + k, s * 0x1p-60f));
            assert_false(contract_with(4 + k, s * nextafterf(0x1p-60f, 0)));
            assert_true(contract_with(4 + k, s * 0.0f));
        }
    assert_true(contract_with(3, 10) && contract_with(3, -0.0f));
    assert_false(contract_with(3, nextafterf(10, 11)) || contract_with(3, -1e-30f));
    assert_true(contract_with(7, INFINITY) && contract_with(7, 0));
    assert_false(contract_with(7, -1e-30f));
    struct ray least = {{0, 0, 0}, 0, {0, 0x1p-40f, 0}, 1};
    assert_true(ray_in_contract(&least));
    least.dir[1] = nextafterf(0x1p-40f, 0);
    assert_false(ray_in_contract(&least));
    least.dir[1] = 0;
    assert_false(ray_in_contract(&least));
}

static void contract_takes_no_nan_and_no_infinity_but_tmax(void **state)
{
    (void)state;
    for (int word = 0; word < 8; word++) {
        assert_false(contract_with(word, NAN));
        assert_false(contract_with(word, -INFINITY));
        assert_int_equal(contract_with(word, INFINITY), word == 7);
    }
}

/* The sum of products that every bit comparison relies on: no step is fused. */
static void nothing_is_contracted(void **state)
{
    (void)state;
    volatile float a = 1 + 0x1p-12f, b = 1 + 0x1p-11f; /* a a is b + 2^-24, rounded to b */
    float product = a * a - b;
    assert_true(product == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(tables_find_every_name_and_no_other),
        cmocka_unit_test(tables_begin_with_a_repaired_member),
        cmocka_unit_test(queries_have_three_names),
        cmocka_unit_test(contract_has_closed_borders),
        cmocka_unit_test(contract_takes_no_nan_and_no_infinity_but_tmax),
        cmocka_unit_test(nothing_is_contracted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
