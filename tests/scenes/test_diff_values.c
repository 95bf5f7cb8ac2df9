/* The first number in which two paths differ, and its first bit: paths made by hand. */
#include "scenes/render/diff_values.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>
#include <cmocka.h> /* last: it has a macro `fail` */

#define BOUNCES 3u
#define LIGHTS  2u

/* A walk of one path whose arrays are its own. */
struct values_made {
    struct diff_walk walk;
    uint32_t length, pixel;
    struct walk_step step[BOUNCES];
    struct walk_light light[BOUNCES * LIGHTS];
};

static struct values_made a, b;

/* Every number is another. */
static void number_all(void *values, size_t size)
{
    static float next = 1.0f;
    float *at = values;
    for (size_t i = 0; i < size / sizeof *at; i++)
        at[i] = next += 0.5f;
}

static void make(struct values_made *out)
{
    out->length = 2;
    out->walk = (struct diff_walk){.count = 1,
                                   .bounces = BOUNCES,
                                   .lights = LIGHTS,
                                   .shadow_query = QUERY_ANY,
                                   .length = &out->length,
                                   .step = out->step,
                                   .light = out->light,
                                   .frame = {.pixel = &out->pixel}};
}

static int both(void **state)
{
    (void)state;
    memset(&a, 0, sizeof a);
    number_all(a.step, sizeof a.step);
    for (size_t i = 0; i < ARRAY_COUNT(a.light); i++) {
        a.light[i].asked = true;
        a.light[i].shadowed = i % 2;
        number_all(&a.light[i].nl, 3 * sizeof(float));
        number_all(&a.light[i].ray, sizeof a.light[i].ray);
        number_all(&a.light[i].hit, sizeof a.light[i].hit);
    }
    b = a;
    make(&a);
    make(&b);
    return 0;
}

static struct first_bit compare(void)
{
    return walk_first_bit(&a.walk, &b.walk, 0);
}

static void equal_paths_differ_nowhere(void **state)
{
    (void)state;
    assert_false(compare().differs);
    b.step[2].hit.t = -1; /* behind the end of both */
    b.light[2 * LIGHTS].nl = -1;
    assert_false(compare().differs);
}

/* From the last number to the first: each that is turned comes before all those turned before. */
static void every_number_has_its_place(void **state)
{
    (void)state;
    struct walk_step *first = &b.step[0], *second = &b.step[1];
    struct walk_light *light = &b.light[0], *other = &b.light[1];
    const struct {
        float *number;
        const char *name;
        uint32_t segment, light;
    } turned[] = {
        {&second->total.z, "blue", 1, UINT32_MAX},
        {&second->total.x, "red", 1, UINT32_MAX},
        {&second->n.y, "normal y", 1, UINT32_MAX},
        {&second->hit.v, "v", 1, UINT32_MAX},
        {&second->hit.u, "u", 1, UINT32_MAX},
        {&second->hit.t, "t", 1, UINT32_MAX},
        {&second->weight, "weight", 1, UINT32_MAX},
        {&second->ray.tmax, "tmax", 1, UINT32_MAX},
        {&second->ray.dir[2], "direction z", 1, UINT32_MAX},
        {&second->ray.org[0], "origin x", 1, UINT32_MAX},
        {&first->total.y, "green", 0, UINT32_MAX},
        {&first->s, "specular light", 0, UINT32_MAX},
        {&first->d, "diffuse light", 0, UINT32_MAX},
        {&other->ray.dir[0], "direction x", 0, 1},
        {&other->far, "distance", 0, 1},
        {&light->ray.tmax, "tmax", 0, 0},
        {&light->ray.org[1], "origin y", 0, 0},
        {&light->rv, "mirrored . eye", 0, 0},
        {&light->nl, "normal . light", 0, 0},
        {&first->g.x, "plane x", 0, UINT32_MAX},
        {&first->n.z, "normal z", 0, UINT32_MAX},
        {&first->p.z, "point z", 0, UINT32_MAX},
        {&first->ray.tmin, "tmin", 0, UINT32_MAX},
        {&first->ray.org[1], "origin y", 0, UINT32_MAX},
    };
    for (size_t i = 0; i < ARRAY_COUNT(turned); i++) {
        uint32_t bits = float_bits(*turned[i].number);
        *turned[i].number = float_from_bits(bits ^ 4u);
        struct first_bit found = compare();
        assert_true(found.differs && found.is_float);
        assert_string_equal(found.name, turned[i].name);
        assert_int_equal(found.segment, turned[i].segment);
        assert_int_equal(found.light, turned[i].light);
        assert_int_equal(found.bit, 2);
        assert_int_equal(found.bits[0], bits);
        assert_int_equal(found.bits[1], bits ^ 4u);
        assert_int_equal(found.ulps, 4);
    }
}

static void the_highest_bit_is_named(void **state)
{
    (void)state;
    b.step[0].hit.t = float_from_bits(float_bits(a.step[0].hit.t) ^ 0x00800003u);
    assert_int_equal(compare().bit, 23);
    a.step[0].hit.t = 0.0f;
    b.step[0].hit.t = -0.0f;
    struct first_bit found = compare();
    assert_string_equal(found.name, "t");
    assert_int_equal(found.bit, 31);
    assert_int_equal(found.ulps, 0);
    b.step[0].hit.t = float_from_bits(0x80000001u);
    assert_int_equal(compare().ulps, 1);
    b.step[0].hit.prim ^= 1u; /* comes before t, and is no float */
    found = compare();
    assert_string_equal(found.name, "triangle");
    assert_false(found.is_float);
    assert_int_equal(found.bit, 0);
    assert_int_equal(found.ulps, 0);
}

/* Whichever triangle blocks a light, it is blocked; but whether is compared. */
static void any_hits_have_no_name(void **state)
{
    (void)state;
    b.light[1].hit.prim++;
    b.light[1].hit.t = 0;
    assert_false(compare().differs);
    a.walk.shadow_query = b.walk.shadow_query = QUERY_CLOSEST; /* these have */
    assert_string_equal(compare().name, "triangle");
    assert_int_equal(compare().light, 1);
    a.walk.shadow_query = b.walk.shadow_query = QUERY_ANY;
    b.light[1].shadowed = !b.light[1].shadowed;
    assert_string_equal(compare().name, "shadowed");
    b.light[0].asked = false;
    assert_string_equal(compare().name, "asked");
    assert_int_equal(compare().bits[0], 1);
    assert_int_equal(compare().bits[1], 0);
}

static void one_path_goes_on(void **state)
{
    (void)state;
    b.length = 1;
    struct first_bit found = compare();
    assert_string_equal(found.name, "goes on");
    assert_int_equal(found.segment, 1);
    assert_int_equal(found.bits[0], 1);
    assert_int_equal(found.bits[1], 0);
    b.length = 3;
    assert_int_equal(compare().segment, 2);
    assert_int_equal(compare().bits[1], 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(equal_paths_differ_nowhere, both),
        cmocka_unit_test_setup(every_number_has_its_place, both),
        cmocka_unit_test_setup(the_highest_bit_is_named, both),
        cmocka_unit_test_setup(any_hits_have_no_name, both),
        cmocka_unit_test_setup(one_path_goes_on, both),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
