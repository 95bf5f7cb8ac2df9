#include "scenes/facts.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

static struct facts facts_of(const float *vertex, uint32_t vertex_count, const uint32_t *index,
                             uint32_t tri_count)
{
    struct scene scene;
    struct facts facts;
    assert_int_equal(scene_make(vertex_count, tri_count, &scene), STATUS_OK);
    if (tri_count) {
        memcpy(scene.vertex, vertex, 3 * vertex_count * sizeof *vertex);
        memcpy(scene.index, index, 3 * tri_count * sizeof *index);
    }
    assert_int_equal(facts_make(&scene, &facts), STATUS_OK);
    scene_free(&scene);
    return facts;
}

static void facts_count_triangles_without_area(void **state)
{
    (void)state;
    /* A point, a doubled corner, a line, and two near misses. */
    static const float vertex[] = {1,    2,    3,      0,    0,    0,      0.1f,
                                   0.2f, 0.7f, 0.2f,   0.4f, 1.4f, 1e-45f, 0,
                                   0,    0,    1e-45f, 0,    1,    1,      1 + 0x1p-23f};
    static const uint32_t index[] = {0, 0, 0, 0, 1, 1, 1, 2, 3, 1, 4, 5, 0, 1, 6};
    struct facts facts = facts_of(vertex, 7, index, 5);
    assert_int_equal(facts.zero_area, 3);
    assert_int_equal(facts.duplicate, 0);
    static const float sliver[] = {0, 0, 0, 1, 1, 1, 2, 2, 2 + 0x1p-22f};
    static const uint32_t one[] = {0, 1, 2};
    assert_int_equal(facts_of(sliver, 3, one, 1).zero_area, 0);
    /* Both products are the same double: 6.9e-18 lies below its last bit. */
    static const float hair[] = {0, 0x1.415af4p-10f,     0x1.d77c96p-10f,
                                 0, 7017547 * 0x1p-23f,  9086827 * 0x1p-24f,
                                 0, 10162473 * 0x1p-24f, 6584211 * 0x1p-24f};
    assert_int_equal(facts_of(hair, 3, one, 1).zero_area, 0);
}

static void facts_count_repeated_triangles(void **state)
{
    (void)state;
    static const float vertex[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, -0.0f, 0, -0.0f, 1, 0, 0, 0, 2, 0};
    /* the same, turned, flipped, by other vertices of the same place; and one that is different */
    static const uint32_t index[] = {0, 1, 2, 1, 2, 0, 2, 1, 0, 3, 4, 2, 0, 1, 5};
    struct facts facts = facts_of(vertex, 6, index, 5);
    assert_int_equal(facts.duplicate, 3);
    assert_int_equal(facts.zero_area, 0);
}

static void facts_measure_what_triangles_use(void **state)
{
    (void)state;
    static const float vertex[] = {-7, 0, 1, 1, 0, 1, 0, 2, 1, 1000, 0, 0};
    static const uint32_t index[] = {0, 1, 2};
    struct facts facts = facts_of(vertex, 4, index, 1);
    assert_true(facts.extent == 8 && facts.largest == 7);
    assert_true(facts.bounds.hi[0] == 1 && facts.bounds.lo[2] == 1);
    facts = facts_of(NULL, 0, NULL, 0);
    assert_true(facts.extent == 0 && facts.largest == 0 && facts.zero_area == 0);
    static const float huge[] = {-3e38f, 0, 0, 3e38f, 0, 0, 0, 1, 0};
    facts = facts_of(huge, 3, index, 1);
    assert_true(isinf(facts.extent) && facts.zero_area == 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(facts_count_triangles_without_area),
        cmocka_unit_test(facts_count_repeated_triangles),
        cmocka_unit_test(facts_measure_what_triangles_use),
    };
    return cmocka_run_group_tests_name("facts", tests, NULL, NULL);
}
