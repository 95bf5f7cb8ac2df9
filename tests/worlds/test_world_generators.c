/* Generators of worlds: the same bytes everywhere, and each what its name tells. */
#define _GNU_SOURCE /* open_memstream */
#include "ref/scene/topology.h"
#include "scenes/worlds.h"
#include "tests/worlds/files_fixture.h"

static void open_spec(const char *spec, uint64_t seed, struct world *out)
{
    enum status status = world_open(spec, seed, out, &reason);
    if (status)
        print_error("%s: %s\n", spec, reason.text);
    assert_int_equal(status, STATUS_OK);
    struct world copy = *out;
    copy.first = NULL;
    assert_int_equal(world_finish(&copy, &reason), STATUS_OK);
    free(copy.first);
}

static uint64_t add_word(uint64_t hash, uint32_t word)
{
    return (hash ^ word) * 1099511628211u;
}

/* Every number of a world, as one. */
static uint64_t digest(const char *spec, uint64_t seed)
{
    struct world world;
    uint64_t hash = 14695981039346656037u;
    open_spec(spec, seed, &world);
    for (uint32_t i = 0; i < world.mesh_count; i++) {
        const struct scene *scene = world.mesh[i].scene;
        for (size_t k = 0; k < 3 * (size_t)scene->vertex_count; k++)
            hash = add_word(hash, float_bits(scene->vertex[k]));
        for (size_t k = 0; k < 3 * (size_t)scene->tri_count; k++)
            hash = add_word(hash, scene->index[k]);
        for (uint32_t k = 0; k < world.mesh[i].geometry_count; k++)
            hash = add_word(hash,
                            2 * world.mesh[i].geometry[k].count + world.mesh[i].geometry[k].opaque);
    }
    for (uint32_t i = 0; i < world.instance_count; i++) {
        const struct instance *instance = &world.instance[i];
        for (int k = 0; k < 12; k++)
            hash = add_word(hash, float_bits(instance->m[k / 4][k % 4]));
        hash = add_word(hash, instance->mesh);
        hash = add_word(hash, instance->custom);
        hash = add_word(hash, instance->mask + 256 * instance->flags);
    }
    hash = add_word(hash, (uint32_t)world.filter.kind);
    hash = add_word(add_word(hash, world.filter.seed), world.filter.share);
    world_free(&world);
    return hash;
}

/* The bytes of each, made once on x86-64: another machine makes the same. */
static const struct {
    const char *spec;
    uint64_t digest;
} made[] = {
    {"placed-identity", 0xf9a3d49ee9b51fa},
    {"placed-far", 0xc44e5101740a201e},
    {"placed-turned", 0x97dbdcc089dffbb2},
    {"placed-scaled", 0xc5ec61815f392f44},
    {"placed-tiny", 0xf652e95a418216f2},
    {"placed-stretched", 0x8b8a15f955faca09},
    {"placed-mirrored", 0x95d93e2bdcb1183b},
    {"placed-sheared", 0xadd548eef1ff8cca},
    {"placed-thin", 0x12d5ad9239c7f134},
    {"wall", 0xd1bd75275ace2f62},
    {"nest", 0xf96d366cb93c4089},
    {"crowd", 0x3ce0e70c5582e508},
    {"twins", 0xfb55baf5e2476b24},
    {"room", 0xb077598c86ebe944},
    {"mixed", 0xdd198f7123cc350b},
};

static void every_generator_makes_the_same_bytes(void **state)
{
    (void)state;
    size_t count = 0;
    while (world_generators[count])
        count++;
    assert_int_equal(count, ARRAY_COUNT(made));
    for (size_t i = 0; i < ARRAY_COUNT(made); i++) {
        const struct world_generator *generator = world_generators[i];
        uint64_t got = digest(made[i].spec, 1);
        assert_string_equal(generator->name, made[i].spec);
        assert_ptr_equal(world_generator_find(generator->name), generator);
        assert_null(generator_find(generator->name));
        assert_true(strlen(generator->summary) > 10);
        if (got != made[i].digest)
            print_error("{\"%s\", 0x%llx},\n", made[i].spec, (unsigned long long)got);
        assert_true(got == made[i].digest);
        assert_int_equal(digest(made[i].spec, 2) == got, generator->seedless);
    }
    assert_null(world_generator_find("sphere"));
}

static void values_are_checked(void **state)
{
    (void)state;
    struct world world;
    const struct world_generator *crowd = world_generator_find("crowd");
    const double fraction[GENERATOR_PARAMS] = {2.5, 0.1}, many[GENERATOR_PARAMS] = {2e6, 0.1};
    const double nan[GENERATOR_PARAMS] = {2, NAN};
    assert_int_equal(world_generator_make(crowd, fraction, 1, &world, &reason), STATUS_INPUT);
    assert_non_null(strstr(reason.text, "crowd: n=2.5, but it must be a whole number"));
    assert_int_equal(world_generator_make(crowd, many, 1, &world, &reason), STATUS_LIMIT);
    assert_int_equal(world_generator_make(crowd, nan, 1, &world, &reason), STATUS_LIMIT);
    assert_null(world.mesh);
}

/* det M in double: exact enough for its size, the sign is exact elsewhere. */
static double determinant(const struct instance *instance)
{
    double m[3][3], det = 0;
    for (int i = 0; i < 9; i++)
        m[i / 3][i % 3] = (double)instance->m[i / 3][i % 3];
    for (int j = 0; j < 3; j++)
        det += m[0][j] *
               (m[1][(j + 1) % 3] * m[2][(j + 2) % 3] - m[1][(j + 2) % 3] * m[2][(j + 1) % 3]);
    return det;
}

/* Length of row or column i of M. */
static double length(const struct instance *instance, int i, bool row)
{
    double sum = 0;
    for (int j = 0; j < 3; j++) {
        double x = (double)(row ? instance->m[i][j] : instance->m[j][i]);
        sum += x * x;
    }
    return sqrt(sum);
}

static bool near(double x, double wanted)
{
    return fabs(x - wanted) <= 1e-6 * fabs(wanted);
}

static void expect_turned(const struct instance *instance, double size)
{
    for (int i = 0; i < 6; i++)
        assert_true(near(length(instance, i % 3, i < 3), size));
    assert_true(near(determinant(instance), size * size * size));
    for (int i = 0; i < 9; i++) /* no axis is kept */
        assert_true(fabs((double)instance->m[i / 3][i % 3]) < 0.99999 * size);
}

static void placed_are_what_they_are_called(void **state)
{
    (void)state;
    struct world world;
    open_spec("placed-identity:count=5", 1, &world);
    for (uint32_t i = 0; i < 5; i++)
        assert_true(instance_is_identity(&world.instance[i]));
    world_free(&world);
    open_spec("placed-far:count=50", 1, &world);
    for (uint32_t i = 0; i < 50; i++)
        for (int k = 0; k < 12; k++) {
            float x = world.instance[i].m[k / 4][k % 4];
            assert_true(k % 4 == 3 ? fabsf(x) >= 2e6f : x == (k % 5 == 0));
        }
    world_free(&world);
    open_spec("placed-turned:count=50", 1, &world);
    for (uint32_t i = 0; i < 50; i++)
        expect_turned(&world.instance[i], 1);
    world_free(&world);
    open_spec("placed-tiny:count=50", 1, &world);
    for (uint32_t i = 0; i < 50; i++)
        expect_turned(&world.instance[i], 1e-6);
    world_free(&world);
}

static void scales_are_powers_of_two(void **state)
{
    (void)state;
    struct world world;
    float least = 1, most = 1;
    open_spec("placed-scaled:count=500", 1, &world);
    for (uint32_t i = 0; i < 500; i++) {
        float size = world.instance[i].m[0][0];
        assert_int_equal(float_bits(size) & 0x7FFFFF, 0);
        assert_true(size == world.instance[i].m[1][1] && size == world.instance[i].m[2][2]);
        least = size < least ? size : least;
        most = size > most ? size : most;
    }
    assert_true(least == 0x1p-20f && most == 0x1p20f);
    world_free(&world);
}

static void stretched_mirrored_sheared_and_thin(void **state)
{
    (void)state;
    struct world world;
    open_spec("placed-stretched:count=40", 1, &world);
    for (uint32_t i = 0; i < 40; i++) {
        double least = INFINITY, most = 0;
        for (int k = 0; k < 3; k++) {
            least = fmin(least, length(&world.instance[i], k, false));
            most = fmax(most, length(&world.instance[i], k, false));
        }
        assert_true(near(most / least, 1e6));
        assert_int_equal(instance_det_sign(world.instance[i].m), 1);
    }
    world_free(&world);
    open_spec("placed-mirrored:count=40", 1, &world);
    for (uint32_t i = 0; i < 40; i++) {
        assert_int_equal(instance_det_sign(world.instance[i].m), -1);
        assert_true(near(determinant(&world.instance[i]), -1));
    }
    world_free(&world);
    open_spec("placed-sheared:count=40", 1, &world);
    for (uint32_t i = 0; i < 40; i++) {
        const struct instance *instance = &world.instance[i];
        assert_true(determinant(instance) == 1);
        assert_true(instance->m[0][1] != 0 && instance->m[0][2] != 0 && instance->m[1][2] != 0);
    }
    world_free(&world);
    open_spec("placed-thin:count=400", 1, &world);
    for (uint32_t i = 0; i < 400; i++)
        assert_true(determinant(&world.instance[i]) == 0x1p-20);
    world_free(&world);
}

/* Six times the volume inside: positive if the triangles face outward. */
static double volume6(const struct scene *scene)
{
    double sum = 0;
    for (uint32_t i = 0; i < scene->tri_count; i++) {
        float v[3][3];
        scene_tri(scene, i, v);
        for (int k = 0; k < 3; k++)
            sum += (double)v[0][k] * ((double)v[1][(k + 1) % 3] * (double)v[2][(k + 2) % 3] -
                                      (double)v[1][(k + 2) % 3] * (double)v[2][(k + 1) % 3]);
    }
    return sum;
}

static void walls_are_boxes_side_by_side(void **state)
{
    (void)state;
    struct world world;
    struct topology topology;
    open_spec("wall:n=3,offset=-2", 1, &world);
    const struct scene *box = world.mesh[0].scene;
    assert_int_equal(box->tri_count, 12);
    assert_true(volume6(box) == 6);
    assert_int_equal(topology_make(box, &topology, &reason), STATUS_OK);
    assert_int_equal(topology_is_closed(&topology, box, &reason), STATUS_OK);
    topology_free(&topology);
    assert_int_equal(world.instance_count, 9);
    for (uint32_t i = 0; i < 9; i++) {
        assert_true(world.instance[i].m[0][3] == (float)(i % 3) - 2);
        assert_true(world.instance[i].m[1][3] == (float)(i / 3) - 2);
        assert_true(world.instance[i].m[2][3] == 0 && determinant(&world.instance[i]) == 1);
    }
    world_free(&world);
    open_spec("wall:n=1024", 1, &world);
    assert_int_equal(world_tri_count(&world), 12 << 20);
    world_free(&world);
}

static void crowds_nests_and_twins(void **state)
{
    (void)state;
    struct world world;
    open_spec("crowd:n=100000,size=0.01", 1, &world);
    assert_int_equal(world.instance_count, 100000);
    assert_int_equal(world_tri_count(&world), 1200000);
    for (uint32_t i = 0; i < world.instance_count; i++) {
        double size = length(&world.instance[i], 0, false);
        assert_true(size > 0.0049 && size < 0.0151);
        assert_int_equal(world.instance[i].custom, i);
    }
    world_free(&world);
    open_spec("nest:count=70", 1, &world);
    for (uint32_t i = 0; i < 70; i++) { /* the origin is inside each */
        const struct instance *instance = &world.instance[i];
        double size = length(instance, 0, false), off = 0;
        assert_true(near(size, 1 / (1 + 0.125 * (i % 64))));
        for (int k = 0; k < 3; k++)
            off += (double)instance->m[k][3] * (double)instance->m[k][3];
        assert_true(i > 4 || sqrt(off) < size);
    }
    world_free(&world);
    open_spec("twins:k=3", 1, &world);
    assert_int_equal(world.mesh_count, 1);
    assert_int_equal(world.mesh[0].scene->tri_count, 128);
    assert_true(instance_is_identity(&world.instance[0]));
    assert_false(instance_is_identity(&world.instance[1]));
    world_free(&world);
}

/* Every kind of instance is there: without a mesh, masked, of each flag, of the largest index. */
static void mixed_worlds_have_everything(void **state)
{
    (void)state;
    struct world world;
    uint32_t flags[16] = {0}, meshless = 0, masked = 0, largest = 0, of_mesh[3] = {0};
    uint32_t opaque = 0, empty = 0;
    open_spec("mixed:count=1000,share=77,filter=2", 1, &world);
    for (uint32_t i = 0; i < 1000; i++) {
        const struct instance *instance = &world.instance[i];
        flags[instance->flags]++;
        meshless += instance->mesh == WORLD_NO_MESH;
        masked += instance->mask == 0;
        largest += instance->custom == ABI_CUSTOM_MOST;
        if (instance->mesh != WORLD_NO_MESH)
            of_mesh[instance->mesh]++;
    }
    for (uint32_t i = 0; i < 16; i++) /* all but those that force both */
        assert_int_equal(flags[i] > 0, i < 12);
    assert_true(meshless > 50 && masked > 50 && largest > 50);
    assert_true(of_mesh[0] > 100 && of_mesh[1] > 100 && of_mesh[2] > 100);
    assert_int_equal(world.mesh[2].scene->tri_count, 0);
    assert_int_equal(world.mesh[0].geometry_count, 5);
    assert_int_equal(world.filter.kind, FILTER_TRIANGLES);
    assert_int_equal(world.filter.share, 77);
    world_free(&world);
    for (uint64_t seed = 1; seed < 20; seed++) {
        open_spec("mixed", seed, &world);
        for (uint32_t k = 0; k < 5; k++) {
            opaque += world.mesh[0].geometry[k].opaque;
            empty += world.mesh[0].geometry[k].count == 0;
        }
        world_free(&world);
    }
    assert_true(opaque > 20 && opaque < 90 && empty >= 19);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_generator_makes_the_same_bytes),
        cmocka_unit_test(values_are_checked),
        cmocka_unit_test(placed_are_what_they_are_called),
        cmocka_unit_test(scales_are_powers_of_two),
        cmocka_unit_test(stretched_mirrored_sheared_and_thin),
        cmocka_unit_test(walls_are_boxes_side_by_side),
        cmocka_unit_test(crowds_nests_and_twins),
        cmocka_unit_test(mixed_worlds_have_everything),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
