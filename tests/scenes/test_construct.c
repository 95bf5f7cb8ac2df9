/* Laws of scenes/construct.h: where triangles, vertices, materials and normals of the models end
 * up, and what is refused. The golden scene is the one that RTRS's authors published. */
#define _GNU_SOURCE /* mkdtemp */
#include "scenes/construct.h"
#include "scenes/read/formats.h"
#include "scenes/read/normals.h"
#include "scenes/scenes.h"
#include "tests/support/published.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "tests/support/root.h"

static struct reason reason;
static struct construct_notes notes;

static const char *in_folder(const char *name)
{
    static char path[4][300];
    static unsigned next;
    char *one = path[next++ % 4];
    snprintf(one, sizeof path[0], "%s/%s", root, name);
    return one;
}

static const char *file_of(const char *name, const char *text)
{
    const char *path = in_folder(name);
    FILE *stream = fopen(path, "w");
    assert_non_null(stream);
    fputs(text, stream);
    assert_int_equal(fclose(stream), 0);
    return path;
}

static struct construct_model model_of(const char *spec, uint32_t material)
{
    return (struct construct_model){spec, material, transform_identity(), 0, 0};
}

static const struct material two[] = {{{0.4f, 0.4f, 0.3f}, {0.6f, 0.3f, 0.1f}, 50},
                                      {{0.3f, 0.1f, 0.1f}, {0.9f, 0.1f, 0.0f}, 10}};

/* Models and the two materials above, seen from z = -10. */
static struct construct construct_of(struct construct_model *model, uint32_t count)
{
    return (struct construct){.model = model,
                              .model_count = count,
                              .material = two,
                              .material_count = 2,
                              .camera = {.pos = {0, 0, -10}},
                              .seed = 1};
}

static struct scene made(const struct construct *from)
{
    struct scene scene;
    if (construct_scene(from, &scene, &notes, &reason))
        fail_msg("%s", reason.text);
    assert_int_equal(scene_check(&scene, &reason), STATUS_OK);
    return scene;
}

static void expect_refused(const struct construct *from, const char *rule)
{
    struct scene scene;
    assert_int_equal(construct_scene(from, &scene, &notes, &reason), STATUS_INPUT);
    if (!strstr(reason.text, rule))
        fail_msg("'%s' is not in '%s'", rule, reason.text);
    assert_null(scene.vertex);
    assert_int_equal(scene.tri_count, 0);
}

/* One of the published scene's two meshes as a file: triangles and vertices from first to last. */
static const char *part_of(const struct scene *scene, const char *name, uint32_t first_vertex,
                           uint32_t vertices, uint32_t first_tri, uint32_t tris)
{
    struct scene part;
    const char *path = in_folder(name);
    assert_int_equal(scene_make(vertices, tris, &part), STATUS_OK);
    memcpy(part.vertex, scene->vertex + 3 * (size_t)first_vertex, 12 * (size_t)vertices);
    for (uint32_t i = 0; i < 3 * tris; i++)
        part.index[i] = scene->index[3 * (size_t)first_tri + i] - first_vertex;
    assert_int_equal(scene_write(path, &part, &reason), STATUS_OK);
    scene_free(&part);
    return path;
}

/* The published scene from its own meshes, materials, lights and camera, of which RTRS's tool
 * could not have made it: indices one too high, and no negative number. */
static void the_published_scene_is_made(void **state)
{
    (void)state;
    struct scene published, scene;
    assert_int_equal(scene_open("rtrs", 1, &published, &reason), STATUS_OK);
    struct construct_model model[] = {
        model_of(part_of(&published, "tetrahedron.obj", 0, 4, 0, 4), 1),
        model_of(part_of(&published, "dodecahedron.ply", 4, 20, 4, 36), 0)};
    struct construct from = construct_of(model, 2);
    from.material = published.material;
    from.material_count = published.material_count;
    from.light = published.light;
    from.light_count = published.light_count;
    from.camera = published.camera;
    scene = made(&from);
    assert_int_equal(scene.tri_count, 40);
    assert_int_equal(scene.vertex_count, 24);
    assert_memory_equal(scene.vertex, published.vertex, 24 * 12);
    assert_memory_equal(scene.index, published.index, 40 * 12);
    assert_memory_equal(scene.material_of, published.material_of, 40 * 4);
    assert_int_equal(scene.material_count, 3);
    assert_memory_equal(scene.material, published.material, 3 * sizeof *scene.material);
    assert_int_equal(scene.light_count, 3);
    assert_memory_equal(scene.light, published.light, 3 * sizeof *scene.light);
    assert_memory_equal(scene.camera.pos, published.camera.pos, 12);
    assert_memory_equal(scene.camera.at, published.camera.at, 12);
    assert_true(scene.has_camera && scene.camera.orbit);
    assert_int_equal(notes.red, CONSTRUCT_DEFAULT);
    assert_int_equal(notes.unused + notes.filled, 0);
    assert_int_equal(model[0].tri_count, 4);
    assert_int_equal(model[1].vertex_count, 20);
    scene_free(&scene);
    scene_free(&published);
}

/* Of the file itself, whose normals are RTRS's: computed in float32, so that only the last
 * digits may differ. */
static void its_normals_are_the_seeds(void **state)
{
    (void)state;
    struct scene published, scene;
    const char *path = published_scene();
    if (!path)
        skip();
    if (scene_read(path, &published, &reason))
        fail_msg("%s", reason.text);
    struct construct_model model = model_of(in_folder("whole.obj"), 0);
    assert_int_equal(scene_write(model.spec, &published, &reason), STATUS_OK);
    struct construct from = construct_of(&model, 1);
    scene = made(&from);
    assert_int_equal(scene.vertex_count, published.vertex_count);
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        if (fabsf(scene.normal[i] - published.normal[i]) > 1e-6f)
            fail_msg("normal %u: %.9g, published %.9g", i, (double)scene.normal[i],
                     (double)published.normal[i]);
    scene_free(&scene);
    scene_free(&published);
}

static void materials_keep_their_indices(void **state)
{
    (void)state;
    static const struct {
        uint32_t given, first, second; /* materials, and what two models ask for */
        uint32_t count, becomes_first, becomes_second, red;
    } cases[] = {
        {2, 0, 1, 2, 0, 1, CONSTRUCT_DEFAULT},
        {2, 1, 0, 2, 1, 0, CONSTRUCT_DEFAULT},
        {2, CONSTRUCT_DEFAULT, 1, 3, 2, 1, 2},
        {2, CONSTRUCT_DEFAULT, CONSTRUCT_DEFAULT, 3, 2, 2, 2},
        {1, 0, CONSTRUCT_DEFAULT, 2, 0, 1, 1},
        {0, 0, CONSTRUCT_DEFAULT, 1, 0, 0, 0},
        {0, 0, 0, 1, 0, 0, 0},
    };
    for (size_t i = 0; i < ARRAY_COUNT(cases); i++) {
        struct construct_model model[] = {model_of("platonic:which=0", cases[i].first),
                                          model_of("platonic:which=1", cases[i].second)};
        struct construct from = construct_of(model, 2);
        from.material_count = cases[i].given;
        struct scene scene = made(&from);
        assert_int_equal(scene.tri_count, 4 + 12);
        assert_int_equal(scene.material_count, cases[i].count);
        for (uint32_t t = 0; t < scene.tri_count; t++)
            assert_int_equal(scene.material_of[t],
                             t < 4 ? cases[i].becomes_first : cases[i].becomes_second);
        assert_memory_equal(scene.material, two, cases[i].given * sizeof *two);
        assert_int_equal(notes.red, cases[i].red);
        if (cases[i].red != CONSTRUCT_DEFAULT)
            assert_memory_equal(&scene.material[cases[i].red], &rtrs_red, sizeof rtrs_red);
        scene_free(&scene);
    }
    struct construct_model model[] = {model_of("platonic:which=0", 0),
                                      model_of("platonic:which=1", 2)};
    struct construct from = construct_of(model, 2);
    expect_refused(&from, "model 1 (platonic:which=1): material 2, but there are 2, counted from 0 "
                          "to 1");
    from.material_count = 1;
    expect_refused(&from, "there is 1, counted from 0 to 0");
    from.material_count = 0;
    expect_refused(&from, "material 2, but none is given: there is only the default, 0");
}

/* The volume inside the triangles' winding: positive where they face outward. */
static double volume(const struct scene *scene, uint32_t first, uint32_t count)
{
    double sum = 0;
    for (uint32_t t = first; t < first + count; t++) {
        float v[3][3];
        scene_tri(scene, t, v);
        for (int k = 0; k < 3; k++)
            sum += (double)v[0][k] *
                   ((double)v[1][(k + 1) % 3] * (double)v[2][(k + 2) % 3] -
                    (double)v[1][(k + 2) % 3] * (double)v[2][(k + 1) % 3]) /
                   6;
    }
    return sum;
}

/* Models stand where their transforms put them, with outside outside, also where it mirrors, and
 * with normals of what they have become. */
static void transforms_move_models_and_normals(void **state)
{
    (void)state;
    const float stretch[3] = {4, 1, 1}, mirror[3] = {1, -2, 1}, away[3] = {10, 0, 0};
    struct construct_model model[] = {model_of("sphere:n=6", 0), model_of("sphere:n=6", 0),
                                      model_of("sphere:n=6", 1)};
    struct transform step = transform_translate(away);
    assert_int_equal(transform_scale(stretch, &model[1].transform, &reason), STATUS_OK);
    assert_int_equal(transform_scale(mirror, &model[2].transform, &reason), STATUS_OK);
    model[2].transform = transform_then(&model[2].transform, &step);
    struct construct from = construct_of(model, 3);
    struct scene scene = made(&from);
    uint32_t tris = model[0].tri_count, vertices = model[0].vertex_count;
    double plain = volume(&scene, 0, tris);
    assert_true(plain > 3.5);
    assert_true(fabs(volume(&scene, tris, tris) - 4 * plain) < 1e-5);
    assert_true(fabs(volume(&scene, 2 * tris, tris) - 2 * plain) < 1e-4);
    for (uint32_t v = 0; v < vertices; v++) {
        const float *p = scene.vertex + 3 * (size_t)v, *second = p + 3 * (size_t)vertices;
        const float *third = second + 3 * (size_t)vertices;
        const float *n = scene.normal + 3 * (size_t)(vertices + v);
        assert_true(second[0] == 4 * p[0] && second[1] == p[1] && second[2] == p[2]);
        assert_true(third[0] == p[0] + 10 && third[1] == -2 * p[1] && third[2] == p[2]);
        /* The stretched sphere's normal leans away from its long axis: (x / 4, y, z), nearly. */
        double along[3] = {(double)p[0] / 4, (double)p[1], (double)p[2]}, length = 0, dot = 0;
        for (int k = 0; k < 3; k++)
            length += along[k] * along[k];
        for (int k = 0; k < 3; k++)
            dot += along[k] * (double)n[k] / sqrt(length);
        assert_true(dot > 0.9);
    }
    /* To the bit, they are the normals of the whole as it stands. */
    float *again = scene_normals(&scene);
    assert_non_null(again);
    assert_memory_equal(again, scene.normal, 12 * (size_t)scene.vertex_count);
    free(again);
    scene_free(&scene);
}

static void an_untransformed_model_keeps_its_bits(void **state)
{
    (void)state;
    struct construct_model model[] = {model_of("needles:n=20,seed=3", 1)};
    struct construct from = construct_of(model, 1);
    struct scene scene = made(&from), mesh;
    assert_int_equal(scene_open(model[0].spec, 1, &mesh, &reason), STATUS_OK);
    assert_int_equal(scene.vertex_count, mesh.vertex_count);
    assert_memory_equal(scene.vertex, mesh.vertex, 12 * (size_t)mesh.vertex_count);
    assert_memory_equal(scene.index, mesh.index, 12 * (size_t)mesh.tri_count);
    scene_free(&mesh);
    scene_free(&scene);
    /* What a furnished model brings along stays behind. */
    model[0] = model_of("cornell", 1);
    scene = made(&from);
    assert_int_equal(scene.material_count, 2);
    assert_int_equal(scene.light_count, 0);
    assert_true(scene.camera.pos[2] == -10 && !scene.camera.orbit);
    scene_free(&scene);
}

static void normals_that_are_none_are_told(void **state)
{
    (void)state;
    struct construct_model model[] = {
        model_of("platonic:which=0", 0),
        model_of(file_of("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 7 7 7\nf 1 2 3\n"
                                     "f 1 2 4\n"),
                 0)};
    struct construct from = construct_of(model, 2);
    expect_refused(&from, "flat.obj): vertex 3 of triangle 1 has no normal");
    assert_int_equal(notes.filled, 1);
    from.fill_normals = true;
    struct scene scene = made(&from);
    assert_int_equal(notes.filled, 1);
    assert_int_equal(notes.unused, 1);
    for (uint32_t v = 4 + 3; v < 4 + 5; v++) {
        const float *n = scene.normal + 3 * (size_t)v;
        assert_true(n[0] == 0 && n[1] == 1 && n[2] == 0);
    }
    scene_free(&scene);
    /* A vertex of two triangles is counted once. */
    model[1] =
        model_of(file_of("twice.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 3 0 0\nf 1 2 3\nf 1 2 4\n"), 0);
    scene = made(&from);
    assert_int_equal(notes.filled, 4);
    scene_free(&scene);
    /* A vertex of no triangle is no reason to refuse a mesh. */
    from.fill_normals = false;
    model[1] = model_of(file_of("spare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 7 7 7\nf 1 2 3\n"), 0);
    scene = made(&from);
    assert_int_equal(notes.unused, 1);
    assert_int_equal(notes.filled, 0);
    scene_free(&scene);
    /* Nor is one of slivers, whose angles rounding takes out of acos' range. */
    model[1] = model_of("needles:n=300,aspect=1e9", 0);
    from.fill_normals = true;
    scene = made(&from);
    for (uint32_t i = 0; i < 3 * scene.vertex_count; i++)
        assert_true(float_is_finite(scene.normal[i]));
    scene_free(&scene);
    /* Two triangles back to back. */
    model[1] = model_of(file_of("leaf.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 3 2\n"), 0);
    from.fill_normals = false;
    expect_refused(&from, "face each other");
}

static void what_is_wrong_is_named(void **state)
{
    (void)state;
    struct construct_model model[] = {model_of("platonic", 0), model_of("platonic", 0)};
    struct construct from = construct_of(model, 0);
    expect_refused(&from, "no model is given");
    from.model_count = 2;
    model[1].spec = in_folder("nothing.obj");
    expect_refused(&from, "nothing.obj: No such file");
    model[1].spec = file_of("broken.obj", "v 0 0 0\nf 1 2 3\n");
    expect_refused(&from, "broken.obj:2: ");
    model[1].spec = "platonic:radius=1e9";
    const float huge[3] = {1, 1e30f, 1};
    assert_int_equal(transform_scale(huge, &model[1].transform, &reason), STATUS_OK);
    expect_refused(&from, "model 1 (platonic:radius=1e9): its transform takes vertex 0 out of");
    model[1] = model_of("platonic", 0);
    from.camera.at[2] = -10;
    expect_refused(&from, "the camera has no direction");
    from.camera.at[2] = 3e38f;
    from.camera.pos[2] = -3e38f;
    expect_refused(&from, "farther away than the range of a float");
    from.camera.at[2] = NAN;
    expect_refused(&from, "camera target 0: number 2 is not finite");
    from.camera.at[2] = 0;
    const struct light light[] = {{{0, 0, 0}, 1}, {{0, 0, 0}, INFINITY}};
    from.light = light;
    from.light_count = 2;
    expect_refused(&from, "light 1: number 3 is not finite");
    from.light_count = 0;
    const struct material wrong[] = {two[0], {{0, 0, 0}, {0, NAN, 0}, 1}};
    from.material = wrong;
    expect_refused(&from, "material 1: number 4 is not finite");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_published_scene_is_made),
        cmocka_unit_test(its_normals_are_the_seeds),
        cmocka_unit_test(materials_keep_their_indices),
        cmocka_unit_test(transforms_move_models_and_normals),
        cmocka_unit_test(an_untransformed_model_keeps_its_bits),
        cmocka_unit_test(normals_that_are_none_are_told),
        cmocka_unit_test(what_is_wrong_is_named),
    };
    return cmocka_run_group_tests_name("construct", tests, make_root, remove_root);
}
