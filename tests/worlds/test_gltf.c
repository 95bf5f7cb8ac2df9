/* glTF: what is read of files by hand, number by number. */
#define _GNU_SOURCE /* open_memstream */
#include "tests/worlds/gltf_fixture.h"

static void expect_m(const struct instance *instance, const float m[12])
{
    for (int i = 0; i < 12; i++) {
        if (instance->m[i / 4][i % 4] != m[i])
            print_error("%d: %g, not %g\n", i, (double)instance->m[i / 4][i % 4], (double)m[i]);
        assert_true(instance->m[i / 4][i % 4] == m[i]);
    }
}

static void check_meshes(const struct world *world)
{
    static const uint32_t index[] = {0, 1, 2, 0, 2, 3, /* list */
                                     0, 1, 2, 1, 3, 2, /* strip: every other one turned */
                                     2, 1, 3, 1, 0, 3 /* fan of 3 */};
    static const uint32_t other[] = {0, 1, 2, 3, 4, 5, 3, 5, 6};
    static const bool opaque[] = {true, false, false};
    const struct world_mesh *mesh = world->mesh;
    assert_int_equal(world->mesh_count, 2);
    assert_int_equal(mesh[0].scene->vertex_count, 4);
    assert_int_equal(mesh[0].scene->tri_count, 6);
    assert_memory_equal(mesh[0].scene->index, index, sizeof index);
    for (int i = 0; i < 4; i++)
        assert_memory_equal(mesh[0].scene->vertex + 3 * i, near_by[i], 12);
    assert_int_equal(mesh[0].geometry_count, 3);
    for (uint32_t i = 0; i < 3; i++) {
        assert_int_equal(mesh[0].geometry[i].first, 2 * i);
        assert_int_equal(mesh[0].geometry[i].count, 2);
        assert_int_equal(mesh[0].geometry[i].opaque, opaque[i]);
    }
    assert_int_equal(mesh[1].scene->vertex_count, 7);
    assert_int_equal(mesh[1].scene->tri_count, 3);
    assert_memory_equal(mesh[1].scene->vertex, far_off, sizeof far_off);
    assert_memory_equal(mesh[1].scene->vertex + 9, near_by[0], 12);
    assert_memory_equal(mesh[1].scene->vertex + 18, near_by[3], 12);
    assert_memory_equal(mesh[1].scene->index, other, sizeof other);
    assert_true(!mesh[1].geometry[0].opaque && mesh[1].geometry[1].opaque);
    assert_int_equal(mesh[1].geometry[1].first, 1);
}

static void check_instances(const struct world *world)
{
    static const float first[12] = {4, 0, 0, 20, 0, 3, -1, 26, 1, 0, 4, 37};
    static const float second[12] = {0, -6, 0, 10, 2, 0, 0, 20, 0, 0, 4, 30};
    assert_int_equal(world->instance_count, 2);
    expect_m(&world->instance[0], first);
    expect_m(&world->instance[1], second);
    assert_int_equal(world->instance[0].mesh, 0);
    assert_int_equal(world->instance[0].custom, 0);
    assert_int_equal(world->instance[0].mask, 0xFF);
    assert_int_equal(world->instance[0].flags, 0); /* one of its primitives is double-sided */
    assert_int_equal(world->instance[1].mesh, 1);
    assert_int_equal(world->instance[1].custom, 70000);
    assert_int_equal(world->instance[1].mask, 3);
    assert_int_equal(world->instance[1].flags, ABI_INSTANCE_CULL_DISABLE); /* both are */
}

static void every_number_of_a_file_is_read(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_gltf_changed("main", "main", &world), STATUS_OK);
    check_meshes(&world);
    check_instances(&world);
    assert_int_equal(fixture_notes.points_and_lines, 2);
    assert_int_equal(fixture_notes.skins + fixture_notes.morphs, 0);
    assert_int_equal(world.filter.kind, FILTER_ALL);
    world_free(&world);
}

static void glb_is_the_same_file(void **state)
{
    (void)state;
    size_t size;
    char *bytes = gltf_glb(&size);
    struct world world;
    enum status status = read_copy(read_gltf_bytes, bytes, size, "w.gltf", &world);
    if (status)
        print_error("%s\n", reason.text);
    assert_int_equal(status, STATUS_OK);
    check_meshes(&world);
    check_instances(&world);
    world_free(&world);
    free(bytes);
}

static void the_scene_decides_which_nodes_are_placed(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_gltf_changed("\"scene\": 1, ", "", &world), STATUS_OK);
    assert_int_equal(world.instance_count, 1); /* the first scene: node 3 */
    assert_true(instance_is_identity(&world.instance[0]));
    world_free(&world);
    assert_int_equal(read_gltf_changed("\"nodes\": [0],", "\"nodes\": [3, 0],", &world), STATUS_OK);
    assert_int_equal(world.instance_count, 3); /* in the order of the nodes */
    assert_int_equal(world.instance[1].custom, 70000);
    world_free(&world);
    assert_int_equal(
        read_gltf_changed("\"scene\": 1, \"scenes\": [{\"nodes\": [3]}, {\"nodes\": [0], "
                          "\"name\": \"main\"}]",
                          "\"a\": {}", &world),
        STATUS_OK);
    assert_int_equal(world.instance_count, 3); /* without a scene all nodes are */
    world_free(&world);
    assert_int_equal(read_gltf_changed("\"nodes\": [0],", "\"nodes\": [],", &world), STATUS_OK);
    assert_int_equal(world.instance_count, 0);
    assert_int_equal(world.mesh_count, 2);
    world_free(&world);
}

/* v + 2 w (u x v) + 2 u x (u x v), for a quaternion (u, w) of length 1. */
static void rotate(const double q[4], const double v[3], double out[3])
{
    double once[3], twice[3];
    for (int i = 0; i < 3; i++)
        once[i] = q[(i + 1) % 3] * v[(i + 2) % 3] - q[(i + 2) % 3] * v[(i + 1) % 3];
    for (int i = 0; i < 3; i++)
        twice[i] = q[(i + 1) % 3] * once[(i + 2) % 3] - q[(i + 2) % 3] * once[(i + 1) % 3];
    for (int i = 0; i < 3; i++)
        out[i] = v[i] + 2 * q[3] * once[i] + 2 * twice[i];
}

static void a_quaternion_turns_as_it_should(void **state)
{
    (void)state;
    struct rng rng = rng_make(3, 0);
    for (int round = 0; round < 200; round++) {
        double q[4], length = 0;
        char text[200];
        struct world world;
        for (int k = 0; k < 4; k++) {
            q[k] = (double)rng_range(&rng, -1, 1);
            length += q[k] * q[k];
        }
        if (length < 0.1)
            continue;
        for (int k = 0; k < 4; k++)
            q[k] /= sqrt(length);
        double off = 1 + (round % 7 - 3) * 0.003; /* not quite of length 1 */
        (void)snprintf(text, sizeof text, "%.17g, %.17g, %.17g, %.17g", off * q[0], off * q[1],
                       off * q[2], off * q[3]);
        assert_int_equal(read_gltf_changed("0, 0, 0.705, 0.705", text, &world), STATUS_OK);
        for (int j = 0; j < 3; j++) {
            const double axis[3] = {j == 0, j == 1, j == 2};
            double turned[3];
            rotate(q, axis, turned);
            turned[0] *= 2; /* of the parent */
            for (int i = 0; i < 3; i++)
                assert_true(fabs(turned[i] * (2 + j) - (double)world.instance[1].m[i][j]) < 1e-6);
        }
        world_free(&world);
    }
}

/* 1 + 2^-24 and 1 + 2^-30 are 1 in float32; their product, in double, is not. */
static void a_product_is_rounded_once(void **state)
{
    (void)state;
    struct world world;
    const char *deep = "{\"children\": [1], \"scale\": [1.000000059604644775390625, 1, 1]},";
    char *whole = gltf_text();
    char *text = changed(whole,
                         "{\"children\": [1, 2], \"translation\": [10, 20, 30], \"scale\": "
                         "[2, 1, 1]},",
                         deep);
    char *both =
        changed(text, "[2, 0, 1, 0,  0, 3, 0, 0,  0, -1, 4, 0,  5, 6, 7, 1]",
                "[1.000000000931322574615478515625, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, "
                "0, 1]");
    assert_int_equal(read_gltf_text(both, &world), STATUS_OK);
    assert_int_equal(float_bits(world.instance[0].m[0][0]), 0x3F800001u);
    world_free(&world);
    free(both);
    free(text);
    free(whole);
}

/* 1 + 2^-24, 1 + 2^-30 and 1 - 2^-25, from the node up: after two of them float32 has 1 + 2^-23,
 * and then the third does not bring it back to 1, which is nearest to the product of all. */
static void products_are_not_rounded_on_the_way(void **state)
{
    (void)state;
    struct world world;
    static const char text[] =
        "{\"asset\":{\"version\":\"2.0\"},\"nodes\":["
        "{\"children\":[1],\"scale\":[0.9999999701976776123046875,1,1]},"
        "{\"children\":[2],\"scale\":[1.000000000931322574615478515625,1,1]},"
        "{\"scale\":[1.000000059604644775390625,1,1],\"extras\":{\"raydiff\":{}}}]}";
    assert_int_equal(read_gltf_text(text, &world), STATUS_OK);
    assert_int_equal(world.instance_count, 1);
    assert_int_equal(float_bits(world.instance[0].m[0][0]), 0x3F800000u);
    world_free(&world);
}

/* A node without a transform changes nothing, not even the sign of a zero. */
static void plain_nodes_leave_every_bit(void **state)
{
    (void)state;
    struct world world;
    char *whole = gltf_text();
    char *text = changed(whole, ", \"translation\": [10, 20, 30], \"scale\": [2, 1, 1]", "");
    char *both = changed(text, "0, -1, 4, 0,", "-0.0, -1e-45, 4, 0,");
    assert_int_equal(read_gltf_text(both, &world), STATUS_OK);
    assert_int_equal(float_bits(world.instance[0].m[0][2]), 0x80000000u);
    assert_int_equal(float_bits(world.instance[0].m[1][2]), 0x80000001u);
    world_free(&world);
    free(both);
    free(text);
    free(whole);
}

static void what_is_left_out_is_counted(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_gltf_changed("{\"mesh\": 1,", "{\"mesh\": 1, \"skin\": 0,", &world),
                     STATUS_OK);
    assert_int_equal(fixture_notes.skins, 1);
    world_free(&world);
    assert_int_equal(
        read_gltf_changed("\"mode\": 5,", "\"mode\": 5, \"targets\": [{\"POSITION\": 4}],", &world),
        STATUS_OK);
    assert_int_equal(fixture_notes.morphs, 1);
    assert_int_equal(fixture_notes.points_and_lines, 2);
    world_free(&world);
}

/* A mesh of points is an empty one, so that meshes keep their numbers. */
static void a_mesh_of_points_is_empty(void **state)
{
    (void)state;
    struct world world;
    const char *text =
        "{\"asset\":{\"version\":\"2.1\"},\"meshes\":[{\"primitives\":[{\"attributes\":{"
        "},\"mode\":1}]}],\"nodes\":[{\"mesh\":0},{},{\"extras\":{\"raydiff\":{\"mask\":0}}}]}";
    assert_int_equal(read_gltf_text(text, &world), STATUS_OK);
    assert_int_equal(world.mesh[0].geometry_count, 1);
    assert_int_equal(world.mesh[0].geometry[0].count, 0);
    assert_int_equal(world.instance_count, 2);
    assert_int_equal(world.instance[0].flags, 0);
    assert_int_equal(world.instance[1].mesh, WORLD_NO_MESH);
    assert_int_equal(world.instance[1].mask, 0);
    world_free(&world);
    assert_int_equal(read_gltf_text("{\"asset\":{\"version\":\"2.0\"}}", &world), STATUS_OK);
    assert_int_equal(world.mesh_count + world.instance_count, 0);
    world_free(&world);
}

static void flags_of_the_extras_come_before_materials(void **state)
{
    (void)state;
    struct world world;
    assert_int_equal(read_gltf_changed("\"mask\": 3", "\"flags\": [\"force_no_opaque\"]", &world),
                     STATUS_OK);
    assert_int_equal(world.instance[1].flags, ABI_INSTANCE_FORCE_NO_OPAQUE);
    assert_int_equal(world.instance[1].mask, 0xFF);
    world_free(&world);
    assert_int_equal(read_gltf_changed("\"mask\": 3", "\"flags\": []", &world), STATUS_OK);
    assert_int_equal(world.instance[1].flags, 0);
    world_free(&world);
}

/* A name with a blank is written %20; only buffers that are used are read. */
static void buffers_are_files_beside_it(void **state)
{
    (void)state;
    struct world world;
    static const char text[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":9,\"uri\":\"gone.bin\"},"
        "{\"byteLength\":36,\"uri\":\"a%%20triangle%s\"}],\"bufferViews\":[{\"buffer\":1,"
        "\"byteLength\":36}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
        "\"type\":\"VEC3\"},{\"componentType\":1,\"count\":0,\"type\":\"MAT9\",\"sparse\":0}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0}]"
        "}";
    char file[sizeof text + 10];
    (void)snprintf(file, sizeof file, text, "%2Ebin");
    assert_int_equal(read_gltf_text(file, &world), STATUS_OK);
    assert_int_equal(world_tri_count(&world), 1);
    assert_true(world.mesh[0].scene->vertex[3] == 1 && world.mesh[0].scene->vertex[7] == 1);
    world_free(&world);
    (void)snprintf(file, sizeof file, text, "%2ebix");
    expect_rule(read_gltf_text(file, &world), "w.gltf: buffers[1].uri: a triangle.bix: No such");
    (void)snprintf(file, sizeof file, text, "%2");
    expect_rule(read_gltf_text(file, &world), "buffers[1].uri: a % must begin two hexadecimal");
    (void)snprintf(file, sizeof file, text, "%00");
    expect_rule(read_gltf_text(file, &world), "buffers[1].uri: a % must begin two hexadecimal");
    (void)snprintf(file, sizeof file, text, "%g0");
    expect_rule(read_gltf_text(file, &world), "buffers[1].uri: a % must begin two hexadecimal");
}

static void base64_of_any_length_comes_back(void **state)
{
    (void)state;
    struct rng rng = rng_make(9, 0);
    for (size_t size = 0; size < 70; size++) {
        unsigned char bytes[70];
        char *text = NULL, back[70];
        size_t length, got;
        for (size_t i = 0; i < size; i++)
            bytes[i] = (unsigned char)rng_below(&rng, 256);
        FILE *stream = open_memstream(&text, &length);
        assert_non_null(stream);
        base64_encode(bytes, size, stream);
        assert_int_equal(fclose(stream), 0);
        assert_int_equal(length, (size + 2) / 3 * 4);
        assert_true(base64_decode(text, length, back, &got));
        assert_int_equal(got, size);
        assert_memory_equal(back, bytes, size);
        free(text);
    }
    static const char *const good[] = {"", "TWFu", "TWE=", "TQ==", "+/+/"};
    static const size_t sizes[] = {0, 3, 2, 1, 3};
    static const char *const bad[] = {"T",    "TW",       "TWE",    "====",   "T===",
                                      "TW=u", "TWF=",     "TR==",   "TWE-",   "TW u",
                                      "TWE_", "TWE=TWFu", "TWFu\n", "TWF\xC3"};
    char out[8];
    size_t got;
    for (size_t i = 0; i < ARRAY_COUNT(good); i++) {
        assert_true(base64_decode(good[i], strlen(good[i]), out, &got));
        assert_int_equal(got, sizes[i]);
    }
    for (size_t i = 0; i < ARRAY_COUNT(bad); i++)
        assert_false(base64_decode(bad[i], strlen(bad[i]), out, &got));
}

/* Extras of the file that are no object, or have no filter, say nothing. */
static void extras_of_any_kind_are_read(void **state)
{
    (void)state;
    static const struct {
        const char *extras;
        enum filter_kind kind;
    } of[] = {{"7", FILTER_ALL},
              {"null", FILTER_ALL},
              {"\"raydiff\"", FILTER_ALL},
              {"[{\"raydiff\": {\"filter\": {\"kind\": \"none\"}}}]", FILTER_ALL},
              {"{}", FILTER_ALL},
              {"{\"other\": {\"filter\": 3}}", FILTER_ALL},
              {"{\"raydiff\": {}}", FILTER_ALL},
              {"{\"raydiff\": {\"filter\": {\"kind\": \"none\"}}}", FILTER_NONE}};
    for (size_t i = 0; i < ARRAY_COUNT(of); i++) {
        char text[200];
        struct world world;
        snprintf(text, sizeof text, "\"extras\": %s, \"scene\": 1,", of[i].extras);
        assert_int_equal(read_gltf_changed("\"scene\": 1,", text, &world), STATUS_OK);
        check_meshes(&world);
        check_instances(&world);
        assert_int_equal(world.filter.kind, of[i].kind);
        world_free(&world);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_number_of_a_file_is_read),
        cmocka_unit_test(glb_is_the_same_file),
        cmocka_unit_test(the_scene_decides_which_nodes_are_placed),
        cmocka_unit_test(a_quaternion_turns_as_it_should),
        cmocka_unit_test(a_product_is_rounded_once),
        cmocka_unit_test(products_are_not_rounded_on_the_way),
        cmocka_unit_test(plain_nodes_leave_every_bit),
        cmocka_unit_test(what_is_left_out_is_counted),
        cmocka_unit_test(a_mesh_of_points_is_empty),
        cmocka_unit_test(flags_of_the_extras_come_before_materials),
        cmocka_unit_test(extras_of_any_kind_are_read),
        cmocka_unit_test(buffers_are_files_beside_it),
        cmocka_unit_test(base64_of_any_length_comes_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
