/* The grid family on the running drivers: all codes of every format through the shaders' decoder
 * (shaders/grid.glsl), and every member's answers, against C. */
#include "ref/layouts/grid.h"

#include "tests/support/drivers.h"

#include <float.h>
#include <math.h>

#define HEAD  3u /* words of a record of two slots before its frame */
#define CODES 12u

/* Frames whose axes differ; the second presses on both ends of the range. */
static const struct number_frame frames[] = {
    {{0, 1, -1000.25f}, {127, 107, 134}},
    {{1e30f, -0x1p-100f, 3e-38f}, {207, 30, 16}},
};

/* Records of every code on every axis: code c is the lower and its complement the upper bound. */
struct coded {
    const struct layout *layout;
    const struct number_format *format;
    const struct number_frame *scene_frame;
    bool own_frames, world;
    struct packed packed;
};

static void put_bits(uint32_t *word, uint32_t at, uint32_t bits, uint32_t code)
{
    for (uint32_t b = 0; b < bits; b++)
        word[(at + b) / 32] |= (code >> b & 1) << (at + b) % 32;
}

static void put_frame(uint32_t word[4], const struct number_frame *frame)
{
    for (int k = 0; k < 3; k++)
        word[k] = float_bits(frame->origin[k]);
    word[3] = frame->scale[0] | frame->scale[1] << 8 | frame->scale[2] << 16;
}

static uint32_t code_at(const struct coded *c, uint32_t record, uint32_t index)
{
    uint32_t pair = (record - (c->scene_frame ? 1 : 0)) * 6 + index / 2;
    uint32_t code = pair / 3, mask = (1u << c->format->bits) - 1;
    return (index % 2 ? ~code : code) & mask;
}

static struct coded coded_make(const struct layout *layout, const struct number_format *format,
                               const struct number_frame *scene_frame)
{
    struct coded c = {.layout = layout, .format = format, .scene_frame = scene_frame};
    c.own_frames = strstr(layout->name, "_node") != NULL;
    c.world = strstr(layout->name, "_world") != NULL;
    uint32_t records = (1u << format->bits) / 2 + (scene_frame ? 1 : 0);
    uint32_t words = layout->node_bytes / 4;
    c.packed = (struct packed){.layout = layout,
                               .word = calloc(records, layout->node_bytes),
                               .word_count = records * words,
                               .node_count = records,
                               .ref_count = 3 * records};
    assert_non_null(c.packed.word);
    if (scene_frame)
        put_frame(c.packed.word, scene_frame);
    for (uint32_t r = scene_frame ? 1 : 0; r < records; r++) {
        uint32_t *word = c.packed.word + (size_t)r * words;
        if (c.own_frames)
            put_frame(word + HEAD, &frames[r % 2]);
        for (uint32_t i = 0; i < CODES; i++) {
            uint32_t at = format->bits == 10 ? i / 3 * 32 + i % 3 * 10 : i * format->bits;
            put_bits(word + HEAD + (c.own_frames ? 4 : 0), at, format->bits, code_at(&c, r, i));
        }
    }
    return c;
}

static bool is_subnormal(float x)
{
    return x != 0 && fabsf(x) < FLT_MIN;
}

/* On the way to a bound there is a subnormal, which a driver may take for 0: nothing stored is so.
 */
static bool may_be_flushed(const struct coded *c, const struct number_frame *frame, uint32_t axis,
                           uint32_t code)
{
    float number = c->format->number(code);
    if (!frame)
        return false;
    float scaled = ldexpf(number, (int)frame->scale[axis] - 127);
    return is_subnormal(number) || is_subnormal(scaled) ||
           is_subnormal(frame->origin[axis] + scaled);
}

static bool same(float a, float b)
{
    return float_bits(a) == float_bits(b) || (isnan(a) && isnan(b));
}

/* Bounds are in the order of the probe: lower and upper of a slot. */
static void compare(const struct coded *c, const char *driver, const float *got)
{
    for (uint32_t r = c->scene_frame ? 1 : 0; r < c->packed.node_count; r++) {
        const struct number_frame *frame = c->own_frames ? &frames[r % 2] : c->scene_frame;
        for (uint32_t slot = 0; slot < 2; slot++) {
            struct box box = c->layout->box(&c->packed, c->packed.node_count + 2 * r + slot);
            for (uint32_t k = 0; k < 6; k++) {
                uint32_t axis = k % 3, upper = k / 3;
                uint32_t code = code_at(c, r, 6 * slot + 2 * axis + upper);
                float want = number_decode(c->format, frame, (int)axis, code);
                float c_has = upper ? box.hi[axis] : box.lo[axis];
                float has = got[CODES * (size_t)r + 6 * slot + k];
                if (!same(want, c_has) ||
                    (!same(want, has) && !may_be_flushed(c, frame, axis, code)))
                    fail_msg("%s: %s: code %x, axis %u: %a in C, %a in the shader, not %a", driver,
                             c->layout->name, code, axis, (double)c_has, (double)has, (double)want);
            }
        }
    }
}

/* Infinite and undefined codes are decoded too, as they can be in a file. */
static void decode_all(struct vk *vk, const char *driver, const char *format, const char *frame,
                       const struct number_frame *scene_frame)
{
    char name[64];
    size_t f = 0;
    (void)snprintf(name, sizeof name, "bvh2_%s_%s", format, frame);
    while (strcmp(number_formats[f]->name, format) != 0)
        assert_non_null(number_formats[++f]);
    const struct layout *layout = layout_find(name);
    if (!layout)
        return;
    struct coded c = coded_make(layout, number_formats[f], scene_frame);
    const uint64_t bounds = (uint64_t)c.packed.node_count * CODES * 4;
    float *got = calloc(c.packed.node_count, CODES * sizeof *got);
    uint32_t none[4] = {0};
    assert_non_null(got);
    const struct push push = {.ray_count = c.packed.node_count, .node_count = c.packed.ref_count};
    gpu_run_on(vk, "probe_grid",
               (const uint32_t[]){64, ABI_BOX_ROBUST, ABI_TRI_MT, 0, 16, 0, layout->constant[0],
                                  layout->constant[1]},
               8, &push, sizeof push, c.packed.node_count / 64 + 1, 6,
               (const uint64_t[]){16, bounds, 16, 4 * (uint64_t)c.packed.word_count, 16, 16},
               (void *const[]){none, got, none, c.packed.word, none, none});
    compare(&c, driver, got);
    free(got);
    packed_free(&c.packed);
}

static void decode_every_format(struct vk *vk, const char *driver, void *of)
{
    (void)of;
    for (size_t f = 1; number_formats[f]; f++) {
        const char *format = number_formats[f]->name;
        decode_all(vk, driver, format, "world", NULL);
        decode_all(vk, driver, format, "scene", &frames[0]);
        decode_all(vk, driver, format, "scene", &frames[1]);
        decode_all(vk, driver, format, "node", NULL);
    }
}

static void every_code_decodes_to_the_bits_of_c(void **state)
{
    (void)state;
    if (!gpu_on_cpu_drivers(decode_every_format, NULL))
        skip();
}

/* One small scene; `raydiff conform --layout every` has all tests of boxes and triangles. */
static void every_member_has_the_bits_of_c(void **state)
{
    (void)state;
    const struct engine_options options = {.device = -1};
    struct reason reason = {""};
    void *self = NULL;
    enum status status = engine_open(engine_find("vulkan"), &options, &self, &reason);
    if (status == STATUS_UNSUPPORTED) {
        print_message("SKIP %s\n", reason.text);
        skip();
    }
    gpu_must(status, &reason);
    struct drivers_view view = view_make("soup:n=150", "vertices", 400);
    size_t members = 0;
    for (size_t l = 0; layouts_all[l]; l++) {
        if (strncmp(layout_shader(layouts_all[l]), "grid", 4) != 0)
            continue;
        view_pack(&view, layouts_all[l]->name);
        const struct job job = {.scene = &view.scene,
                                .packed = &view.packed,
                                .box = box_test_find("watertight"),
                                .tri = tri_test_find("woop"),
                                .query = QUERY_CLOSEST};
        size_t hits = driver_trace("vulkan", self, &view, &job, view.got);
        for (size_t i = 0; i < view.ray_count; i++)
            assert_int_equal(trace_ray(&(struct job){.scene = &view.scene,
                                                     .packed = &view.packed,
                                                     .box = job.box,
                                                     .tri = job.tri,
                                                     .query = job.query},
                                       &view.ray[i], &view.expected[i], NULL),
                             STATUS_OK);
        if (view_differs(&view) || hits < 100)
            fail_msg("%s: %zu of %zu answers differ, %zu hits", layouts_all[l]->name,
                     view_differs(&view), view.ray_count, hits);
        members++;
    }
    assert_int_equal(members, 41);
    view_free(&view);
    engine_find("vulkan")->close(self);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_code_decodes_to_the_bits_of_c),
        cmocka_unit_test(every_member_has_the_bits_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
