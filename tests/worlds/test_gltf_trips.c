/* What is written as glTF and GLB is read to the bit; what neither can hold is named. */
#define _GNU_SOURCE /* open_memstream */
#include "scenes/worlds.h"
#include "tests/worlds/gltf_fixture.h"

static void expect_trip(const struct world *world)
{
    static fixture_write_fn *const write[] = {write_gltf, write_glb};
    for (size_t i = 0; i < ARRAY_COUNT(write); i++) {
        size_t size;
        struct world back;
        char *bytes = written_world(write[i], world, &size);
        assert_int_equal(memcmp(bytes, "glTF", 4) == 0, i == 1);
        enum status status = read_copy(read_gltf_bytes, bytes, size, "w.gltf", &back);
        if (status)
            print_error("%s\n", reason.text);
        assert_int_equal(status, STATUS_OK);
        assert_same_world(world, &back);
        world_free(&back);
        free(bytes);
    }
}

static void worlds_of_any_bits_come_back(void **state)
{
    (void)state;
    struct rng rng = rng_make(11, 0);
    for (int i = 0; i < 400; i++) {
        struct world world;
        make_wild_world(&rng, &world);
        expect_trip(&world);
        world_free(&world);
    }
}

static void worlds_of_generators_come_back(void **state)
{
    (void)state;
    for (size_t i = 0; world_generators[i]; i++) {
        struct world world;
        if (strcmp(world_generators[i]->name, "mixed") == 0)
            continue; /* it has an empty mesh */
        assert_int_equal(world_open(world_generators[i]->name, 3, &world, &reason), STATUS_OK);
        expect_trip(&world);
        world_free(&world);
    }
}

static void a_world_without_anything_comes_back(void **state)
{
    (void)state;
    struct world world = {0};
    assert_int_equal(world_finish(&world, &reason), STATUS_OK);
    expect_trip(&world);
    world_free(&world);
}

/* What glTF demands of a file that its readers do not: bounds of positions, alignment, kinds. */
static void a_file_keeps_the_rules_of_the_format(void **state)
{
    (void)state;
    struct world world;
    size_t size;
    assert_int_equal(world_open("placed-mirrored:n=2", 1, &world, &reason), STATUS_OK);
    char *bytes = written_world(write_gltf, &world, &size);
    assert_non_null(strstr(bytes, "\"min\": [-1.0, -1.0, -1.0], \"max\": [1.0, 1.0, 1.0]"));
    assert_non_null(strstr(bytes, "\"byteOffset\": 0, \"byteLength\": 216, \"target\": 34962"));
    assert_non_null(strstr(bytes, "\"byteOffset\": 216, \"byteLength\": 384, \"target\": 34963"));
    assert_non_null(strstr(bytes, "\"componentType\": 5125, \"count\": 96, \"type\": \"SCALAR\""));
    assert_non_null(strstr(bytes, "\"byteLength\": 600"));
    assert_null(strstr(bytes, "materials"));
    free(bytes);
    bytes = written_world(write_glb, &world, &size);
    uint32_t word[5];
    memcpy(word, bytes, sizeof word);
    assert_int_equal(word[2], size);
    assert_int_equal(word[3] % 4, 0);
    assert_int_equal(size, 28 + word[3] + 600);
    free(bytes);
    world_free(&world);
}

static void expect_unwritable(const char *spec, const char *rule)
{
    struct world world;
    char *bytes = NULL;
    size_t size;
    assert_int_equal(world_open(spec, 1, &world, &reason), STATUS_OK);
    FILE *stream = open_memstream(&bytes, &size);
    assert_non_null(stream);
    expect_rule(write_gltf(&world, stream, &reason), rule);
    expect_rule(write_glb(&world, stream, &reason), rule);
    assert_int_equal(fclose(stream), 0);
    assert_int_equal(size, 0);
    free(bytes);
    world_free(&world);
}

static void what_the_format_cannot_hold_is_named(void **state)
{
    (void)state;
    expect_unwritable("mixed:seed=4", "has no triangle, which glTF cannot hold");
    expect_unwritable("soup:n=0", "mesh 0: has no vertex, which glTF cannot hold");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_of_any_bits_come_back),
        cmocka_unit_test(worlds_of_generators_come_back),
        cmocka_unit_test(a_world_without_anything_comes_back),
        cmocka_unit_test(a_file_keeps_the_rules_of_the_format),
        cmocka_unit_test(what_the_format_cannot_hold_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
