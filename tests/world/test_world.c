/* Worlds: which are refused and why and how placed triangles are numbered. */
#include "tests/world/world_fixture.h"

#include "ref/base/rng.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

/* --- rules ------------------------------------------------------------------------------------ */

/* Checks that the world of `change` is refused with a reason that has `text`, and frees it. */
static void refused(struct world *world, enum status expected, const char *text)
{
    struct reason reason = {""};
    enum status status = world_finish(world, &reason);
    if (status != expected || !strstr(reason.text, text))
        fail_msg("status %d, \"%s\" instead of %d, \"%s\"", (int)status, reason.text, (int)expected,
                 text);
    world_free(world);
}

static struct world two_of_three(void)
{
    return fixture_world((const uint32_t[]){3, 2}, 2, 3);
}

static void what_breaks_a_rule_is_refused_by_name(void **state)
{
    (void)state;
    struct world w;
    w = two_of_three(), w.instance[2].mesh = 2;
    refused(&w, STATUS_INPUT, "instance 2: mesh 2, but the world has 2");
    w = two_of_three(), w.instance[1].custom = 0x1000000;
    refused(&w, STATUS_INPUT, "instance 1: custom index 16777216 is over 16777215");
    w = two_of_three(), w.instance[1].mask = 256;
    refused(&w, STATUS_INPUT, "instance 1: mask 256 is over 255");
    w = two_of_three(), w.instance[0].flags = 16;
    refused(&w, STATUS_INPUT, "instance 0: flags 0x10 are unknown");
    w = two_of_three(), w.instance[0].flags = 12;
    refused(&w, STATUS_INPUT, "instance 0: it is forced to be opaque and not to be opaque");
    w = two_of_three(), w.mesh[1].scene->vertex[4] = NAN;
    refused(&w, STATUS_INPUT, "mesh 1: vertex 1: coordinate y is not finite");
    w = two_of_three(), w.mesh[0].scene->index[8] = 9;
    refused(&w, STATUS_INPUT, "mesh 0: triangle 2: vertex index 9");
    w = two_of_three(), w.mesh[0].geometry_count = 0;
    refused(&w, STATUS_INPUT, "mesh 0: at least one geometry");
    w = two_of_three(), w.mesh[1].geometry[0].count = 1;
    refused(&w, STATUS_INPUT, "mesh 1: its geometries cover 1 of 2 triangles");
    w = two_of_three(), w.mesh[1].geometry[0].count = 3;
    refused(&w, STATUS_INPUT, "mesh 1: geometry 0 has triangles from 0 on, 3 of them");
    w = two_of_three(), w.mesh[1].geometry[0].first = 1;
    refused(&w, STATUS_INPUT, "mesh 1: geometry 0 has triangles from 1 on");
    w = two_of_three(), w.filter.kind = (enum filter_kind)4;
    refused(&w, STATUS_INPUT, "filter: kind 4 is unknown");
    w = two_of_three(), w.filter.share = 257;
    refused(&w, STATUS_INPUT, "filter: a share of 257 of 256");
}

/* Triangles that geometries leave out or have twice, wherever: the first that does is told with its
 * own numbers. */
static void geometries_that_do_not_cover_are_told_by_number(void **state)
{
    (void)state;
    struct rng rng = rng_make(55, 0);
    for (int turn = 0; turn < 500; turn++) {
        struct world w = fixture_world((const uint32_t[]){4, 20, 3}, 3, 3);
        const uint32_t geometries = 1 + rng_below(&rng, 5), wrong = rng_below(&rng, geometries);
        struct geometry *own = calloc(geometries, sizeof *own);
        char text[160];
        assert_non_null(own);
        free(w.mesh[1].geometry);
        w.mesh[1].geometry = own;
        w.mesh[1].geometry_count = geometries;
        for (uint32_t i = 0, first = 0; i < geometries; i++) {
            own[i] = (struct geometry){.first = first, .opaque = true};
            own[i].count = i + 1 == geometries ? 20 - first : rng_below(&rng, (20 - first) / 2);
            first += own[i].count;
        }
        if (turn % 2)
            own[wrong].count += 20 - own[wrong].first - own[wrong].count + 1 + rng_below(&rng, 9);
        else
            own[wrong].first += 1 + rng_below(&rng, 9);
        snprintf(text, sizeof text,
                 "mesh 1: geometry %u has triangles from %u on, %u of them: geometries cover the "
                 "mesh's 20 in order",
                 wrong, own[wrong].first, own[wrong].count);
        refused(&w, STATUS_INPUT, text);
    }
}

static void every_number_of_a_transform_must_be_finite(void **state)
{
    (void)state;
    static const float bad[] = {INFINITY, -INFINITY, NAN};
    for (int i = 0; i < 12; i++)
        for (size_t b = 0; b < ARRAY_COUNT(bad); b++) {
            struct world w = two_of_three();
            char text[80];
            w.instance[1].m[i / 4][i % 4] = bad[b];
            snprintf(text, sizeof text, "instance 1: row %d, column %d of its transform is not",
                     i / 4, i % 4);
            refused(&w, STATUS_INPUT, text);
        }
}

static void limits_themselves_are_taken(void **state)
{
    (void)state;
    struct world w = two_of_three();
    w.instance[0].custom = ABI_CUSTOM_MOST;
    w.instance[1].custom = ABI_CUSTOM_MOST; /* may repeat */
    w.instance[1].mask = 0;
    w.instance[2].mesh = WORLD_NO_MESH;
    w.instance[0].flags =
        ABI_INSTANCE_CULL_DISABLE | ABI_INSTANCE_FLIP_FACING | ABI_INSTANCE_FORCE_NO_OPAQUE;
    w.filter = (struct filter_rule){FILTER_CELLS, UINT32_MAX, 256};
    fixture_finish(&w);
    assert_int_equal(world_tri_count(&w), 5);
    world_free(&w);
    w = fixture_world((const uint32_t[]){0}, 1, 2);
    fixture_finish(&w);
    assert_int_equal(world_tri_count(&w), 0);
    world_free(&w);
    w = fixture_world((const uint32_t[]){1}, 1, 0);
    fixture_finish(&w);
    assert_int_equal(world_tri_count(&w), 0);
    world_free(&w);
}

/* Numbers of triangles of three meshes that 65537 instances take in turn, so that exactly
 * `total` are placed. */
static void meshes_of(uint64_t total, uint32_t tris[3])
{
    const uint64_t more = 21846, fewer = 21845; /* instances of the first two, and of the last */
    tris[2] = (uint32_t)((more - total % more) % more); /* fewer is more - 1 */
    const uint64_t both = (total - fewer * tris[2]) / more;
    tris[0] = (uint32_t)(both / 2);
    tris[1] = (uint32_t)(both - tris[0]);
    assert_true(more * tris[0] + more * tris[1] + fewer * tris[2] == total);
}

/* Of every number about 2^32: the last that fits is 2^32 - 2, as 2^32 - 1 is no triangle. */
static void the_most_placed_triangles_are_exact(void **state)
{
    (void)state;
    for (uint64_t less = 0; less < 6; less++) {
        const uint64_t total = ((uint64_t)1 << 32) - less;
        uint32_t tris[3];
        meshes_of(total, tris);
        struct world w = fixture_world(tris, 3, 65537);
        struct reason reason = {""};
        const enum status status = world_finish(&w, &reason);
        assert_int_equal(status, less < 2 ? STATUS_LIMIT : STATUS_OK);
        if (status)
            assert_non_null(strstr(reason.text, "instance 65536: the world has 429496729"));
        else
            assert_true(world_tri_count(&w) == total);
        world_free(&w);
    }
}

static void placed_triangles_have_32_bits(void **state)
{
    (void)state;
    /* 2^16 instances of 2^16 - 1 triangles fit below 2^32 - 1; those of 2^16 do not. */
    for (uint32_t more = 0; more < 2; more++) {
        struct world w = fixture_world((const uint32_t[]){65535 + more}, 1, 65536);
        struct reason reason = {""};
        enum status status = world_finish(&w, &reason);
        assert_int_equal(status, more ? STATUS_LIMIT : STATUS_OK);
        if (more)
            assert_non_null(strstr(reason.text, "instance 65535: the world has 4294967296"));
        else
            assert_int_equal(world_tri_count(&w), 65535u * 65536u);
        world_free(&w);
    }
}

/* --- determinants ------------------------------------------------------------------------------
 */

static int sign_of_small(int m[9])
{
    int det = m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
              m[2] * (m[3] * m[7] - m[4] * m[6]);
    return (det > 0) - (det < 0);
}

/* Rows and columns scaled by powers of two: the sign stays, whatever the exponents. */
static void signs_of_determinants_are_exact(void **state)
{
    (void)state;
    struct rng rng = rng_make(7, 0);
    unsigned seen[3] = {0};
    for (int round = 0; round < 20000; round++) {
        int small[9];
        float m[3][4] = {{0}};
        int row[3], column[3];
        for (int k = 0; k < 3; k++) {
            row[k] = (int)rng_below(&rng, 100) - 50;
            column[k] = (int)rng_below(&rng, 100) - 50;
        }
        for (int i = 0; i < 9; i++) {
            small[i] = (int)rng_below(&rng, 5) - 2;
            m[i / 3][i % 3] = ldexpf((float)small[i], row[i / 3] + column[i % 3]);
        }
        int sign = sign_of_small(small);
        assert_int_equal(instance_det_sign((const float(*)[4])m), sign);
        seen[sign + 1]++;
    }
    assert_true(seen[0] > 1000 && seen[1] > 1000 && seen[2] > 1000);
}

static void a_determinant_of_one_last_bit_is_not_singular(void **state)
{
    (void)state;
    /* (1 + e)(1 - e) - 1 = -e^2, which double loses; far apart exponents likewise. */
    const float e = FLT_EPSILON;
    const float close[3][4] = {{1 + e, 1, 0, 0}, {1, 1 - e, 0, 0}, {0, 0, 1, 0}};
    assert_int_equal(instance_det_sign(close), -1);
    const float far[3][4] = {{FLT_MAX, 0x1p-149f, 0, 0}, {0, FLT_MAX, 0, 0}, {0, 0, 0x1p-149f, 0}};
    assert_int_equal(instance_det_sign(far), 1);
    const float same[3][4] = {{1 + e, 3, 5, 0}, {1 + e, 3, 5, 0}, {7, 11, 13, 0}};
    assert_int_equal(instance_det_sign(same), 0);
    struct world w = two_of_three();
    memcpy(w.instance[2].m, same, sizeof same);
    refused(&w, STATUS_INPUT, "instance 2: its transform is singular");
}

static void the_identity_is_each_of_twelve_numbers(void **state)
{
    (void)state;
    struct instance at = {.m = {{1, -0.0f, 0, 0}, {0, 1, 0, -0.0f}, {0, 0, 1, 0}}};
    assert_true(instance_is_identity(&at));
    for (int i = 0; i < 12; i++) {
        struct instance off = at;
        off.m[i / 4][i % 4] = i % 5 == 0 ? 1 + FLT_EPSILON : 0x1p-149f;
        assert_false(instance_is_identity(&off));
    }
}

/* --- places ----------------------------------------------------------------------------------- */

/* Every placed triangle of a world with empty instances and several geometries is in its place:
 * counted up one by one. */
static void every_placed_triangle_has_its_place(void **state)
{
    (void)state;
    struct world w = fixture_world((const uint32_t[]){5, 0, 3}, 3, 9);
    w.instance[3].mesh = WORLD_NO_MESH;
    w.instance[0].mesh = WORLD_NO_MESH;
    w.instance[8].mesh = 1;
    free(w.mesh[0].geometry);
    w.mesh[0].geometry_count = 4;
    w.mesh[0].geometry = calloc(4, sizeof *w.mesh[0].geometry);
    assert_non_null(w.mesh[0].geometry);
    w.mesh[0].geometry[1] = (struct geometry){0, 2, false};
    w.mesh[0].geometry[2] = (struct geometry){2, 0, true};
    w.mesh[0].geometry[2].first = 2;
    w.mesh[0].geometry[3] = (struct geometry){2, 3, true};
    fixture_finish(&w);
    uint32_t next = 0;
    for (uint32_t i = 0; i < w.instance_count; i++) {
        const struct scene *scene = world_scene(&w, i);
        assert_int_equal(w.first[i], next);
        for (uint32_t g = 0, prim = 0; scene && g < w.mesh[w.instance[i].mesh].geometry_count; g++)
            for (uint32_t t = 0; t < w.mesh[w.instance[i].mesh].geometry[g].count; t++) {
                struct place place = world_place(&w, next);
                assert_int_equal(place.instance, i);
                assert_int_equal(place.mesh, w.instance[i].mesh);
                assert_int_equal(place.geometry, g);
                assert_int_equal(place.tri, t);
                assert_int_equal(place.prim, prim++);
                assert_int_equal(world_instance_of(&w, next), i);
                next++;
            }
    }
    assert_int_equal(world_tri_count(&w), next);
    assert_int_equal(next, 5 + 3 + 3);
    world_free(&w);
}

static void a_scene_is_a_world_of_one(void **state)
{
    (void)state;
    struct world_mesh mesh = fixture_mesh(4);
    struct world w;
    struct reason reason;
    assert_int_equal(world_of_scene(mesh.scene, &w, &reason), STATUS_OK);
    assert_int_equal(w.instance_count, 1);
    assert_ptr_equal(world_scene(&w, 0), mesh.scene);
    assert_true(instance_is_identity(&w.instance[0]));
    assert_int_equal(w.instance[0].mask, 0xFF);
    assert_int_equal(world_tri_count(&w), 4);
    assert_true(w.mesh[0].geometry[0].opaque);
    world_free(&w);
    assert_int_equal(mesh.scene->tri_count, 4); /* borrowed: it is still there */
    mesh.scene->vertex[0] = INFINITY;
    assert_int_equal(world_of_scene(mesh.scene, &w, &reason), STATUS_INPUT);
    assert_null(w.mesh);
    scene_free(mesh.scene);
    free(mesh.scene);
    free(mesh.geometry);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_breaks_a_rule_is_refused_by_name),
        cmocka_unit_test(geometries_that_do_not_cover_are_told_by_number),
        cmocka_unit_test(every_number_of_a_transform_must_be_finite),
        cmocka_unit_test(limits_themselves_are_taken),
        cmocka_unit_test(placed_triangles_have_32_bits),
        cmocka_unit_test(the_most_placed_triangles_are_exact),
        cmocka_unit_test(signs_of_determinants_are_exact),
        cmocka_unit_test(a_determinant_of_one_last_bit_is_not_singular),
        cmocka_unit_test(the_identity_is_each_of_twelve_numbers),
        cmocka_unit_test(every_placed_triangle_has_its_place),
        cmocka_unit_test(a_scene_is_a_world_of_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
