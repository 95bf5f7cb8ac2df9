/* Forms by value: formats are those of Vulkan by their names, transforms are what their words say
 * and are undone exactly or not at all, what is added lies on other triangles, and all that is not
 * read is what no driver may read. */
#include "scenes/scenes.h"

#include <vulkan/vulkan_core.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <cmocka.h>

#include "gpu/accel/accel_window.h"
#include "tests/accel/form_reader.h"

/* --- formats ---------------------------------------------------------------------------------- */

#define NAMED(name)                                                                                \
    {                                                                                              \
#name, VK_FORMAT_##name                                                                    \
    }

static uint32_t number_of(const char *vulkan)
{
    static const struct {
        const char *name;
        uint32_t number;
    } all[] = {
        NAMED(R32G32B32_SFLOAT),   NAMED(R32G32_SFLOAT),      NAMED(R32G32B32A32_SFLOAT),
        NAMED(R16G16_SFLOAT),      NAMED(R16G16B16_SFLOAT),   NAMED(R16G16B16A16_SFLOAT),
        NAMED(R16G16_SNORM),       NAMED(R16G16B16A16_SNORM), NAMED(R16G16_UNORM),
        NAMED(R16G16B16A16_UNORM), NAMED(R8G8_SNORM),         NAMED(R8G8B8A8_SNORM),
        NAMED(R8G8_UNORM),         NAMED(R8G8B8A8_UNORM),     NAMED(A2B10G10R10_UNORM_PACK32),
        NAMED(R64G64B64_SFLOAT)};
    for (size_t i = 0; i < ARRAY_COUNT(all); i++)
        if (strcmp(all[i].name, vulkan) == 0)
            return all[i].number;
    fail_msg("no format %s", vulkan);
    return 0;
}

/* "R16G16_SNORM": the letters are components, the numbers their bits. */
static void formats_are_what_their_names_say(void **state)
{
    (void)state;
    for (size_t f = 0; f < ACCEL_FORMATS; f++) {
        const struct accel_format_facts *facts = &accel_format[f];
        const char *at = facts->vulkan, *kind = strchr(at, '_') + 1;
        uint32_t sum = 0, letters = 0, largest = 0;
        char name[8];
        for (char *end; *at != '_'; at = end, letters++) {
            const uint32_t bits = (uint32_t)strtoul(at + 1, &end, 10);
            sum += bits;
            largest = bits > largest ? bits : largest;
        }
        assert_int_equal(facts->vk_format, number_of(facts->vulkan));
        assert_int_equal(facts->bits, largest);
        assert_int_equal(facts->bytes, sum / 8);
        assert_int_equal(facts->packed, strstr(kind, "PACK32") != NULL);
        assert_int_equal(facts->align, facts->packed ? 4 : largest / 8);
        assert_int_equal(facts->components, facts->packed ? 3 : letters);
        assert_int_equal(facts->kind, kind[0] == 'U'   ? ACCEL_UNORM
                                      : kind[1] == 'N' ? ACCEL_SNORM
                                                       : ACCEL_FLOAT);
        assert_int_equal(facts->nan, facts->kind == ACCEL_FLOAT);
        snprintf(name, sizeof name, "%c%ux%u",
                 "fsu"[facts->kind == ACCEL_FLOAT   ? 0
                       : facts->kind == ACCEL_SNORM ? 1
                                                    : 2],
                 facts -> bits, facts -> components);
        assert_string_equal(facts->name, name);
    }
}

/* All bytes of a vertex, and none behind it; a fourth component is what no driver may read. */
static void a_vertex_is_written_whole_and_alone(void **state)
{
    (void)state;
    for (size_t f = 0; f < ACCEL_FORMATS; f++)
        for (int nan = 0; nan < 1 + accel_format[f].nan; nan++) {
            static const float at[3] = {1, 1, 0};
            const uint32_t bytes = accel_format[f].bytes, read = bytes * 3 / 4;
            uint8_t to[2][64];
            memset(to[0], 0x55, sizeof to[0]);
            memset(to[1], 0xAA, sizeof to[1]);
            for (int i = 0; i < 2; i++)
                if (nan)
                    accel_encode_nan((enum accel_format)f, at, to[i]);
                else
                    assert_true(accel_encode((enum accel_format)f, at, to[i]));
            assert_memory_equal(to[0], to[1], bytes);
            for (uint32_t i = 0; i < sizeof to[0]; i++)
                if (i >= bytes)
                    assert_true(to[0][i] == 0x55 && to[1][i] == 0xAA);
                else if (accel_format[f].components == 4 && i >= read)
                    assert_int_equal(to[0][i], 0xFF);
        }
}

/* Each coordinate on its own: what is taken comes again, and what the format has not is refused. */
static void coordinates_come_again_or_are_refused(void **state)
{
    (void)state;
    static const float all[] = {-1,    -0.5f, 0,     0.5f,     1,        2,          -2,
                                -0.0f, 65504, 65536, 0x1p-24f, 0x1p-25f, 0x1.004p0f, 0x1.002p0f};
    for (size_t f = 0; f < ACCEL_FORMATS; f++)
        for (size_t n = 0; n < 3 * ARRAY_COUNT(all); n++) {
            const struct accel_format_facts *facts = &accel_format[f];
            const uint32_t k = (uint32_t)(n % 3);
            float at[3] = {0, 0, 0};
            uint8_t to[32];
            const float x = at[k] = all[n / 3];
            const bool taken = accel_encode((enum accel_format)f, at, to);
            const bool half =
                facts->bits != 16 || (fabsf(x) < 65536 && x != 0x1p-25f && x != 0x1.002p0f);
            const bool is = k >= facts->components ? x == 0
                            : facts->kind == ACCEL_FLOAT
                                ? half
                                : x == 0 || x == 1 || (x == -1 && facts->kind == ACCEL_SNORM);
            assert_int_equal(taken, is);
            for (uint32_t i = 0; i < 3 && i < facts->components && is; i++)
                assert_true(component(facts, to, i) == (double)at[i]);
        }
}

/* --- transforms ------------------------------------------------------------------------------- */

/* One number in each row and column; of turned ones off the diagonal, and of both signs. */
static void transforms_are_what_their_words_say(void **state)
{
    (void)state;
    for (enum accel_transform which = 0; which < ACCEL_TRANSFORMS; which++)
        for (uint32_t number = 0; number < 24; number++) {
            const struct accel_variant variant = {.transform = which};
            uint32_t negative = 0, moved = 0, columns = 0, large = 0;
            float m[3][4];
            assert_int_equal(accel_transform_of(&variant, number, m),
                             which != ACCEL_TRANSFORM_NONE);
            for (uint32_t j = 0; j < 9; j++) {
                const float x = m[j / 3][j % 3];
                if (x == 0)
                    continue;
                int exponent;
                assert_true(frexpf(fabsf(x), &exponent) == 0.5f);
                assert_true(which == ACCEL_SCALED ? x >= 2 && x <= 16 : fabsf(x) == 1);
                columns += 1u << 8 * (j % 3);
                negative += x < 0;
                large += (uint32_t)exponent;
                assert_true((j / 3 == j % 3) == (which != ACCEL_TURNED || number % 3 == 2));
            }
            for (uint32_t k = 0; k < 3; k++)
                moved += m[k][3] == (float)(4 + number % 8 + k);
            assert_int_equal(columns, 0x010101);
            assert_int_equal(negative, which == ACCEL_TURNED ? 1 + number % 2 : 0);
            assert_int_equal(moved, which == ACCEL_MOVED ? 3 : 0);
            if (which == ACCEL_SCALED) /* three of 2 to 16 in a row, which go around */
                assert_int_equal(large, 12 - (number + 3) % 4);
        }
}

/* Whether the point comes out again is known exactly; so it is for each coordinate on its own. */
static void what_is_undone_comes_again_exactly(void **state)
{
    (void)state;
    uint32_t exact = 0, rounded = 0;
    uint32_t seed = 1;
    for (enum accel_transform which = 0; which < ACCEL_TRANSFORMS; which++)
        for (uint32_t n = 0; n < 3000; n++) {
            const struct accel_variant variant = {.transform = which};
            float at[3] = {1, -2, 3}, to[3], m[3][4];
            seed = seed * 1664525u + 1013904223u;
            at[n % 3] = ldexpf((float)(seed >> 8) - 0x1p23f, (int)(n / 3 % 150) - 149);
            const bool is = accel_untransform(&variant, n, at, to);
            bool same = true, tiny = false;
            if (accel_transform_of(&variant, n, m))
                for (int k = 0; k < 3; k++) {
                    long double sum = m[k][3];
                    for (int i = 0; i < 3; i++)
                        sum += (long double)m[k][i] * to[i];
                    same = same && sum == at[k];
                    tiny = tiny || (to[k] != 0 && fabsf(to[k]) < 1e-37f);
                }
            else
                assert_memory_equal(at, to, sizeof at);
            assert_int_equal(is, same && !tiny);
            *(is ? &exact : &rounded) += 1;
        }
    assert_true(exact > 3000 && rounded > 300);
}

/* --- buffers ---------------------------------------------------------------------------------- */

static void expect_point(const struct accel_variant *variant, const float is[3],
                         const float *should, bool nan)
{
    for (int k = 0; k < 3; k++)
        if (nan && (k == 0 || variant->transform))
            assert_true(isnan(is[k]));
        else
            assert_true(is[k] == should[k]);
}

/* Triangle t of those behind the scene's: i is like triangle 8 i, first with a NaN, then of two
 * points or of one. */
static void expect_like(const struct scene *scene, const struct accel_part *part,
                        const struct accel_variant *variant, struct form_reader *r, uint32_t t)
{
    const uint32_t each = window_added(part->count);
    const bool nan = variant->nan && t < each;
    const uint32_t i = nan || !variant->nan ? t : t - each;
    const uint32_t like = part->first + (8 * i < part->count ? 8 * i : 0);
    for (uint32_t k = 0; k < 3; k++) {
        const uint32_t a = i % 3, b = i % 2 ? a : (a + 1) % 3;
        const uint32_t from = nan ? k : k == 1 ? b : a;
        float v[3];
        vertex_of(r, part->count + t, k, v);
        expect_point(variant, v, scene->vertex + 3 * (size_t)scene->index[3 * (size_t)like + from],
                     nan && k == i % 3);
    }
}

static void expect_buffers(const char *spec, const char *name)
{
    struct scene scene;
    struct accel_variant variant;
    struct accel_input input;
    struct accel_part *part;
    struct reason reason = {""};
    uint32_t count;
    uint64_t indices_to = 0;
    assert_int_equal(scene_open(spec, 1, &scene, &reason), STATUS_OK);
    assert_int_equal(accel_parse(name, &variant, &reason), STATUS_OK);
    assert_int_equal(accel_split(&scene, &variant, &part, &count, &reason), STATUS_OK);
    if (accel_input_make(&scene, NULL, part, count, &variant, &input, &reason))
        fail_msg("%s, %s: %s", spec, name, reason.text);
    uint8_t *read = calloc(input.vertex_bytes + 1, 1);
    assert_non_null(read);
    for (uint32_t g = 0; g < count; g++) {
        struct form_reader r = form_reader_make(&input, g, input.vertices);
        r.read = read;
        for (uint32_t c = 0; c < 3 * input.count[g]; c++) {
            float v[3];
            vertex_of(&r, c / 3, c % 3, v);
        }
        for (uint32_t t = 0; t < input.count[g] - part[g].count; t++)
            expect_like(&scene, &part[g], &variant, &r, t);
        indices_to = r.indices_to > indices_to ? r.indices_to : indices_to;
        if (variant.offset)
            assert_int_equal(r.form->primitive_offset, r.form->index_bytes
                                                           ? 6 * r.form->index_bytes
                                                           : 2 * r.form->stride + r.format->align);
    }
    for (size_t i = 0; i < input.vertex_bytes; i++)
        if (!read[i])
            assert_true(input.vertices[i] == 0xFF && input.before[i] == 0xFF);
    for (size_t i = 0; i < input.transform_bytes && variant.offset; i++)
        if (i % 96 < 48) /* before each transform there is room for one */
            assert_int_equal(input.transforms[i], 0xFF);
    if (variant.index != ACCEL_UNINDEXED)
        assert_int_equal((indices_to + 3) / 4 * 4, input.index_bytes);
    free(read);
    accel_input_free(&input);
    free(part);
    scene_free(&scene);
}

static void what_is_not_read_is_what_no_driver_may_read(void **state)
{
    (void)state;
    static const char *const index[] = {"", ":u16", ":unindexed"};
    static const char *const more[] = {"", ":offset", ":offset:split3:first_vertex"};
    for (size_t f = 0; f < ACCEL_FORMATS; f++)
        for (size_t n = f ? 0 : 1; n < 9; n++) {
            char name[ACCEL_NAME_MOST];
            snprintf(name, sizeof name, "rayquery%s%s%s%s", f ? ":" : "",
                     f ? accel_format[f].name : "", index[n % 3], more[n / 3]);
            expect_buffers("tests/accel/square.obj", name);
            if (accel_format[f].nan && accel_format[f].components > 2) {
                strcat(name, ":nan:degenerate");
                expect_buffers("tests/accel/cube.obj", name);
            }
        }
    static const char *const others[] = {"rayquery:nan",
                                         "rayquery:degenerate:split2",
                                         "rayquery:scaled:offset:nan:split5",
                                         "rayquery:turned:offset:degenerate:unindexed",
                                         "rayquery:stride20:offset:u16:nan:degenerate",
                                         "rayquery:scaled:stride48:f32x4:split7:offset:unindexed"};
    for (size_t i = 0; i < ARRAY_COUNT(others); i++)
        expect_buffers("soup:n=131", others[i]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(formats_are_what_their_names_say),
        cmocka_unit_test(a_vertex_is_written_whole_and_alone),
        cmocka_unit_test(coordinates_come_again_or_are_refused),
        cmocka_unit_test(transforms_are_what_their_words_say),
        cmocka_unit_test(what_is_undone_comes_again_exactly),
        cmocka_unit_test(what_is_not_read_is_what_no_driver_may_read),
    };
    return cmocka_run_group_tests_name("accel_forms", tests, NULL, NULL);
}
