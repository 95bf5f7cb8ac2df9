/* The triangles of a mesh in the form of a variant, read as the Vulkan specification says they are
 * read: they are those of the scene, bit for bit but for the sign of zero. What is added is
 * inactive or degenerate, and what no driver may read is never read. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu/accel/accel_format.h"
#include "gpu/accel/accel_input.h"
#include "scenes/scenes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "tests/accel/form_reader.h"

/* --- laws ------------------------------------------------------------------------------------- */

static bool same_point(const float a[3], const float b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* The triangles that were added: inactive, or of at most two points. */
static void expect_added(const struct accel_variant *variant, float v[3][3])
{
    const bool inactive = isnan(v[0][0]) || isnan(v[1][0]) || isnan(v[2][0]);
    const bool degenerate =
        same_point(v[0], v[1]) || same_point(v[1], v[2]) || same_point(v[0], v[2]);
    for (int i = 0; i < 3; i++) /* no other component may be NaN alone */
        assert_true(isnan(v[i][0]) || (!isnan(v[i][1]) && !isnan(v[i][2])));
    assert_true((variant->nan && inactive) || (variant->degenerate && degenerate));
}

/* Returns how many vertices differ before an update. */
static size_t expect_part(const struct scene *scene, const struct accel_part *part,
                          const struct accel_variant *variant, struct form_reader *r,
                          uint32_t count)
{
    size_t moved = 0;
    assert_true(count >= part->count);
    assert_true(variant->nan || variant->degenerate || count == part->count);
    assert_true(!part->count || !(variant->nan || variant->degenerate) || count > part->count);
    for (uint32_t t = 0; t < count; t++) {
        float v[3][3], before[3][3];
        for (uint32_t k = 0; k < 3; k++) {
            r->vertices = r->input->before;
            vertex_of(r, t, k, before[k]);
            r->vertices = r->input->vertices;
            vertex_of(r, t, k, v[k]);
            assert_true(isnan(v[k][0]) == isnan(before[k][0])); /* as updates require */
            moved += !same_point(v[k], before[k]);
        }
        if (t >= part->count) {
            expect_added(variant, v);
            continue;
        }
        const uint32_t *index = scene->index + 3 * (size_t)(part->first + t);
        for (uint32_t k = 0; k < 3; k++)
            if (!same_point(v[k], scene->vertex + 3 * (size_t)index[k]))
                fail_msg("triangle %u, vertex %u: (%g, %g, %g)", part->first + t, k,
                         (double)v[k][0], (double)v[k][1], (double)v[k][2]);
    }
    /* What a driver may read, which is not more than is read. */
    if (count)
        assert_int_equal(r->form->max_vertex,
                         r->largest + (r->form->index_bytes ? 0 : r->form->first_vertex));
    return moved;
}

/* The variant is used: what it names is not what it would be without the word. */
static void expect_used(const struct accel_variant *variant, const struct vk_accel_form *form,
                        uint32_t number)
{
    const bool transform = variant->transform != ACCEL_TRANSFORM_NONE;
    assert_int_equal(form->index_bytes, variant->index == ACCEL_UNINDEXED ? 0
                                        : variant->index == ACCEL_U16     ? 2
                                                                          : 4);
    assert_int_equal(form->format, accel_format[variant->format].vk_format);
    assert_int_equal(form->stride,
                     variant->stride ? variant->stride : accel_format[variant->format].bytes);
    assert_true((form->first_vertex != 0) == variant->first_vertex);
    assert_true((form->primitive_offset != 0) == variant->offset);
    assert_true((form->transform_offset != 0) == (variant->offset && transform));
    assert_true((form->transform_at != VK_ACCEL_NO_TRANSFORM) == transform);
    if (variant->offset)
        assert_true(form->vertices_at > 0 && (!form->index_bytes || form->indices_at > 0));
    if (variant->offset && variant->index == ACCEL_U16 && number == 0)
        assert_true(form->max_vertex >= 65535);
}

/* Returns false if the scene is refused, with a line that names a vertex. */
static bool expect_scene(const char *spec, const char *name)
{
    struct scene scene;
    struct accel_variant variant;
    struct accel_input input;
    struct accel_part *part;
    struct reason reason = {""};
    uint32_t count, next = 0;
    assert_int_equal(scene_open(spec, 1, &scene, &reason), STATUS_OK);
    assert_int_equal(accel_parse(name, &variant, &reason), STATUS_OK);
    assert_int_equal(accel_split(&scene, &variant, &part, &count, &reason), STATUS_OK);
    enum status status = accel_input_make(&scene, NULL, part, count, &variant, &input, &reason);
    if (status)
        assert_true(status == STATUS_LIMIT && strstr(reason.text, "rayquery: vertex "));
    for (uint32_t g = 0; g < count && !status; g++) {
        struct form_reader r = form_reader_make(&input, g, input.vertices);
        expect_used(&variant, &input.form[g], g);
        assert_int_equal(part[g].first, next);
        next += part[g].count;
        assert_true(input.form[g].stride >= r.format->bytes);
        const size_t moved = expect_part(&scene, &part[g], &variant, &r, input.count[g]);
        assert_true(part[g].count < 2 || moved > 0);
    }
    assert_true(status || next == scene.tri_count);
    assert_true(status || !variant.split || count >= variant.split);
    accel_input_free(&input);
    free(part);
    scene_free(&scene);
    return !status;
}

/* An update finds each vertex where it was. */
static void what_is_updated_was_where_the_vertices_were(void **state)
{
    (void)state;
    size_t taken = 0;
    struct scene scene;
    struct reason reason = {""};
    assert_int_equal(scene_open("soup:n=301", 1, &scene, &reason), STATUS_OK);
    float *earlier = malloc(12 * (size_t)scene.vertex_count);
    assert_non_null(earlier);
    for (size_t i = 0; i < 3 * (size_t)scene.vertex_count; i++)
        earlier[i] = scene.vertex[3 * (size_t)scene.vertex_count - 1 - i];
    for (size_t i = 0; accel_names[i]; i++) {
        struct accel_variant variant;
        struct accel_input input;
        struct accel_part *part;
        uint32_t count;
        assert_int_equal(accel_parse(accel_names[i], &variant, &reason), STATUS_OK);
        if (variant.format || variant.transform == ACCEL_MOVED || variant.index == ACCEL_U8)
            continue;
        assert_int_equal(accel_split(&scene, &variant, &part, &count, &reason), STATUS_OK);
        assert_int_equal(accel_input_make(&scene, earlier, part, count, &variant, &input, &reason),
                         STATUS_OK);
        for (uint32_t g = 0; g < count; g++) {
            struct form_reader r = form_reader_make(&input, g, input.before);
            for (uint32_t c = 0; c < 3 * part[g].count; c++) {
                float v[3];
                vertex_of(&r, c / 3, c % 3, v);
                const uint32_t number = scene.index[3 * (size_t)part[g].first + c];
                assert_true(same_point(v, earlier + 3 * (size_t)number));
            }
        }
        accel_input_free(&input);
        free(part);
        taken++;
    }
    assert_true(taken > 20);
    free(earlier);
    scene_free(&scene);
}

static void every_form_has_the_triangles_of_the_scene(void **state)
{
    (void)state;
    size_t taken = 0;
    static const char *const exact[] = {"grid:n=6,height=2", "grid:n=2,height=0",
                                        "tests/accel/cube.obj", "tests/accel/square.obj"};
    for (size_t i = 0; accel_names[i]; i++) {
        struct accel_variant variant;
        struct reason reason;
        bool any = false;
        assert_int_equal(accel_parse(accel_names[i], &variant, &reason), STATUS_OK);
        if (variant.index == ACCEL_U8)
            continue;
        for (size_t s = 0; s < ARRAY_COUNT(exact); s++)
            any = expect_scene(exact[s], accel_names[i]) || any;
        if (!any)
            fail_msg("%s takes no scene", accel_names[i]);
        taken++;
        if (!variant.format && variant.transform != ACCEL_MOVED)
            assert_true(expect_scene("soup:n=301", accel_names[i]));
    }
    assert_true(taken > 50);
}

/* Axes together, of each two that can meet. */
static void forms_meet_one_another(void **state)
{
    (void)state;
    static const char *const words[][5] = {
        {"", ":split2", ":split5", ":split64", ""},
        {"", ":scaled", ":turned", "", ""},
        {"", ":u16", ":unindexed", "", ""},
        {"", ":f32x4", ":f64x3", ":stride16", ":f64x3:stride40"},
        {"", ":offset", ":first_vertex", ":offset:first_vertex", ""},
        {"", ":nan", ":degenerate", ":nan:degenerate", ""}};
    static const size_t choices[] = {4, 3, 3, 5, 4, 4};
    for (size_t i = 1; i < 4 * 3 * 3 * 5 * 4 * 4; i++) {
        char name[ACCEL_NAME_MOST] = "rayquery";
        size_t rest = i;
        for (size_t axis = 0; axis < ARRAY_COUNT(choices); axis++) {
            strcat(name, words[axis][rest % choices[axis]]);
            rest /= choices[axis];
        }
        assert_true(expect_scene("soup:n=67", name));
    }
}

/* 16 bits are used to the last, and more vertices than they reach make more geometries. */
static void sixteen_bits_are_used_to_the_last(void **state)
{
    (void)state;
    struct scene scene;
    struct reason reason;
    struct accel_input input;
    const struct accel_variant variant = {.index = ACCEL_U16, .offset = true};
    assert_int_equal(scene_open("soup:n=30000", 1, &scene, &reason), STATUS_OK);
    assert_true(scene.vertex_count > 65536);
    const struct accel_part all = {0, scene.tri_count};
    assert_int_equal(accel_input_make(&scene, NULL, &all, 1, &variant, &input, &reason),
                     STATUS_LIMIT);
    assert_non_null(strstr(reason.text, "16-bit indices reach 65536"));
    accel_input_free(&input);
    scene_free(&scene);
    assert_true(expect_scene("soup:n=30000", "rayquery:u16"));
    assert_true(expect_scene("soup:n=30000", "rayquery:u16:offset:nan"));
    assert_true(expect_scene("soup:n=0", "rayquery:u16:offset:nan"));
}

static void what_would_be_rounded_is_refused_by_its_vertex(void **state)
{
    (void)state;
    assert_false(expect_scene("sphere:n=3", "rayquery:moved"));
    assert_false(expect_scene("sphere:n=3", "rayquery:f16x4"));
    assert_false(expect_scene("grid:n=4,height=2", "rayquery:f32x2"));
    assert_false(expect_scene("grid:n=4,height=0", "rayquery:s16x2"));
    assert_false(expect_scene("grid:n=2,height=0", "rayquery:u8x2"));
    assert_true(expect_scene("grid:n=4,height=2", "rayquery:moved"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_form_has_the_triangles_of_the_scene),
        cmocka_unit_test(what_is_updated_was_where_the_vertices_were),
        cmocka_unit_test(forms_meet_one_another),
        cmocka_unit_test(sixteen_bits_are_used_to_the_last),
        cmocka_unit_test(what_would_be_rounded_is_refused_by_its_vertex),
    };
    return cmocka_run_group_tests_name("accel_input", tests, NULL, NULL);
}
