/* The numbers that tracers with a defect of numbering report, by value: a long row of instances,
 * some of them inactive, each met by a ray of its own. */
#include "ref/explain/world_defect.h"
#include "tests/two_level/two_level_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define INSTANCES 1300u
#define APART     8.0f

static bool is_inactive(uint32_t i)
{
    return i % 7 == 2;
}

static struct world row_of_instances(void)
{
    struct world world = fixture_room(1, INSTANCES);
    fixture_mesh(&world, 0, "sphere:n=2", 3);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        world.instance[i].m[0][3] = APART * (float)i;
        if (is_inactive(i))
            world.instance[i].mesh = WORLD_NO_MESH;
    }
    fixture_finish(&world);
    return world;
}

/* A ray from without to the middle of a triangle of the last geometry. */
static void answer(struct world_look *look, enum world_defect defect, uint32_t i, struct hit *hit,
                   uint32_t *tag)
{
    const struct scene *scene = look->world->mesh[0].scene;
    struct ray ray = {.org = {APART * (float)i, 0, 0}, .tmax = 100};
    const struct hit none = hit_none();
    float v[3][3];
    scene_tri(scene, scene->tri_count - 1 - i % 3, v);
    for (int k = 0; k < 3; k++) {
        ray.dir[k] = -(v[0][k] + v[1][k] + v[2][k]);
        ray.org[k] -= ray.dir[k];
    }
    world_look_bend(look, defect);
    world_look_trace(look, QUERY_CLOSEST, &ray, (struct ray_mode){.mask = 0xFF}, &none, hit, tag);
}

/* What each defect makes of the number of a placed triangle; counted by hand. */
static uint32_t number_with(const struct world *world, enum world_defect defect,
                            const struct place *place)
{
    uint32_t before = 0; /* inactive instances */
    for (uint32_t k = 0; k < place->instance; k++)
        before += is_inactive(k);
    switch (defect) {
    case WORLD_DEFECT_MESH_NUMBERS:
        return place->prim;
    case WORLD_DEFECT_GEOMETRY_FIRST:
        return world->first[place->instance] + place->tri;
    case WORLD_DEFECT_INACTIVE_COUNT_NOT:
        return world->first[place->instance - before] + place->prim;
    case WORLD_DEFECT_NUMBER_10:
        return world->first[place->instance % 1024] + place->prim;
    default:
        return world->first[place->instance] + place->prim;
    }
}

static uint32_t custom_with(const struct world *world, enum world_defect defect, uint32_t i)
{
    switch (defect) {
    case WORLD_DEFECT_CUSTOM_IS_NUMBER:
        return i;
    case WORLD_DEFECT_CUSTOM_16:
        return world->instance[i].custom % 65536;
    case WORLD_DEFECT_CUSTOM_8:
        return world->instance[i].custom % 256;
    case WORLD_DEFECT_CUSTOM_OF_BEFORE:
        return world->instance[i ? i - 1 : 0].custom;
    default:
        return world->instance[i].custom;
    }
}

static void numbers_are_those_of_the_defect(void **state)
{
    static const enum world_defect defects[] = {
        WORLD_DEFECT_NONE,      WORLD_DEFECT_MESH_NUMBERS,     WORLD_DEFECT_GEOMETRY_FIRST,
        WORLD_DEFECT_NUMBER_10, WORLD_DEFECT_CUSTOM_16,        WORLD_DEFECT_INACTIVE_COUNT_NOT,
        WORLD_DEFECT_CUSTOM_8,  WORLD_DEFECT_CUSTOM_IS_NUMBER, WORLD_DEFECT_CUSTOM_OF_BEFORE};
    (void)state;
    struct world world = row_of_instances();
    struct world_look look;
    assert_int_equal(world_look_make(&world, tri_test_find("mt"), &look, NULL), STATUS_OK);
    for (uint32_t i = 0; i < INSTANCES; i += i % 3 == 2 ? 40 : 1) {
        struct hit right, hit;
        uint32_t tag;
        answer(&look, WORLD_DEFECT_NONE, i, &right, &tag);
        assert_int_equal(right.prim == ABI_NO_PRIM, is_inactive(i));
        for (size_t d = 0; d < ARRAY_COUNT(defects) && !is_inactive(i); d++) {
            const struct place place = world_place(&world, right.prim);
            assert_int_equal(place.instance, i);
            assert_true(place.geometry > 0); /* else two defects are none */
            answer(&look, defects[d], i, &hit, &tag);
            assert_int_equal(hit.prim, number_with(&world, defects[d], &place));
            assert_int_equal(tag & ABI_TAG_CUSTOM, custom_with(&world, defects[d], i));
            assert_true(tag & ABI_TAG_FRONT);
            assert_int_equal(float_bits(hit.t), float_bits(right.t));
        }
    }
    world_look_free(&look);
    world_free(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(numbers_are_those_of_the_defect)};
    return cmocka_run_group_tests_name("world_numbers", tests, NULL, NULL);
}
