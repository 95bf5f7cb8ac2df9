/* Frames and codes of the grid family that shaders choose by integers
 * (shaders/build/build_number.glsl) are those of C, in each format, on every driver here. */
#include "ref/layouts/grid_number.h"
#include "tests/layouts/drawn_bits.h"

#include "tests/support/gpu.h"

#define GROUP  64u
#define POWERS 255u /* biased exponents */
#define PAIRS  (4 * POWERS * POWERS)
#define EDGES  36u

struct number_case {
    uint32_t lo, hi, bound[2];
};

/* Down and up; `code` counts if there is one. */
struct number_codes {
    uint32_t has, code, world_has, world_code;
};

struct number_made {
    uint32_t there, origin, exponent;
    struct number_codes of[2][2];
};

static bool make_frame(const struct number_format *format, const struct number_case *c,
                       struct number_frame *out)
{
    const struct box box = {{float_from_bits(c->lo)}, {float_from_bits(c->hi)}};
    return number_frame_make(format, &box, out);
}

/* Numbers at the ends of the subnormal ones, of a frame and of halves. */
static uint32_t edge(uint32_t i)
{
    static const uint32_t size[EDGES / 2] = {
        0,           1,           0x007FFFFFu, 0x00800000u, 0x00800001u, 0x00FFFFFFu,
        0x01000000u, 0x387FFFFFu, 0x38800000u, 0x477FE000u, 0x477FE001u, 0x477FF000u,
        0x47800000u, 0x7E7FFFFFu, 0x7E800000u, 0x7E800001u, 0x7F7F0000u, 0x7F7FFFFFu};
    return size[i / 2] | i % 2 << 31;
}

/* Any bound that a frame may have, a number of the frame or what lies beside it, or an end. */
static uint32_t draw_bound(struct rng *rng, const struct number_format *format,
                           const struct number_case *c)
{
    struct number_frame frame;
    const uint32_t kind = rng_below(rng, 4), code = rng_below(rng, format->last + 1);
    const int64_t lo = order_of_bits(c->lo), hi = order_of_bits(c->hi);
    if (kind == 0 || !make_frame(format, c, &frame))
        return bits_of_order(lo + (int64_t)(rng_float(rng) * (float)(hi - lo)));
    if (kind == 1)
        return rng_below(rng, 2) ? c->lo : c->hi;
    const uint32_t bits = float_bits(number_decode(format, &frame, 0, code));
    const int64_t beside = order_of_bits(bits) + (int64_t)rng_below(rng, 3) - 1;
    return (bits & 0x7F000000u) >= 0x7F000000u ? c->lo : bits_of_order(beside);
}

static void draw(struct rng *rng, const struct number_format *format, bool near_pairs,
                 struct number_case *out)
{
    for (uint32_t i = 0; i < PAIRS; i++) {
        uint32_t a = (i / 4 / POWERS) << 23 | draw_fraction(rng) | (i & 1) << 31;
        uint32_t b = (i / 4 % POWERS) << 23 | draw_fraction(rng) | (i >> 1 & 1) << 31;
        if (near_pairs) {
            const int64_t apart = (int64_t)rng_below(rng, 1u << rng_below(rng, 27));
            b = bits_of_order(order_of_bits(a) + apart);
        }
        if (i < EDGES * EDGES) {
            a = edge(i / EDGES);
            b = edge(i % EDGES);
        }
        if ((b & 0x7F800000u) == 0x7F800000u)
            b = a;
        bool swapped = order_of_bits(a) > order_of_bits(b);
        out[i].lo = swapped ? b : a;
        out[i].hi = swapped ? a : b;
        out[i].bound[0] = draw_bound(rng, format, &out[i]);
        out[i].bound[1] = draw_bound(rng, format, &out[i]);
    }
}

static void check_codes(const struct number_format *format, const struct number_frame *frame,
                        const struct number_case *c, const struct number_made *made)
{
    for (int b = 0; b < 2; b++)
        for (int up = 0; up < 2; up++) {
            const float bound = float_from_bits(c->bound[b]);
            const struct number_codes *of = &made->of[b][up];
            uint32_t code;
            bool has = frame && number_encode(format, frame, 0, bound, up, &code);
            if (frame && (has != of->has || (has && code != of->code)))
                fail_msg("%s: %a in %a + n * 2^%d, %s: %u %x, not %u %x", format->name,
                         (double)bound, (double)frame->origin[0], (int)frame->scale[0] - 127,
                         up ? "up" : "down", of->has, of->code, has, code);
            if (!format->sign)
                continue;
            has = number_encode(format, NULL, 0, bound, up, &code);
            if (has != of->world_has || (has && code != of->world_code))
                fail_msg("%s: %a, %s: %u %x, not %u %x", format->name, (double)bound,
                         up ? "up" : "down", of->world_has, of->world_code, has, code);
        }
}

static void check_case(const struct number_format *format, const struct number_case *c,
                       const struct number_made *made)
{
    struct number_frame frame;
    const bool framed = format->bits < 32; /* no layout has a float32 in a frame */
    const bool there = framed && make_frame(format, c, &frame);
    if (framed && there != made->there)
        fail_msg("%s: %08x to %08x: %u, not %u", format->name, c->lo, c->hi, made->there, there);
    if (there &&
        (float_bits(frame.origin[0]) != made->origin || frame.scale[0] != made->exponent + 127))
        fail_msg("%s: %08x to %08x: origin %08x, 2^%d, not %08x, 2^%d", format->name, c->lo, c->hi,
                 made->origin, (int)made->exponent, float_bits(frame.origin[0]),
                 (int)frame.scale[0] - 127);
    check_codes(format, there ? &frame : NULL, c, made);
}

static void check_format(struct vk *vk, const struct number_format *format, struct number_case *c)
{
    static const uint32_t group = GROUP;
    const uint32_t push[] = {PAIRS, format->id};
    struct number_made *made = malloc(PAIRS * sizeof *made);
    assert_non_null(made);
    memset(made, 0xA5, PAIRS * sizeof *made);
    gpu_run_on(vk, "probe_number", &group, 1, push, sizeof push, (PAIRS + GROUP - 1) / GROUP, 2,
               (const uint64_t[]){PAIRS * sizeof *c, PAIRS * sizeof *made},
               (void *const[]){c, made});
    for (uint32_t i = 0; i < PAIRS; i++)
        check_case(format, &c[i], &made[i]);
    free(made);
}

static void play(struct vk *vk, const char *driver, void *of)
{
    struct rng rng = rng_make(3, 0);
    struct number_case *c = malloc(PAIRS * sizeof *c);
    (void)of;
    assert_non_null(c);
    for (size_t f = 0; number_formats[f]; f++)
        for (int near_pairs = 0; near_pairs < 2; near_pairs++) {
            draw(&rng, number_formats[f], near_pairs, c);
            check_format(vk, number_formats[f], c);
        }
    free(c);
    print_message("%s: %u axes a format\n", driver, 2 * PAIRS);
}

static void codes_are_those_of_c(void **state)
{
    (void)state;
    if (!gpu_on_cpu_drivers(play, NULL))
        skip();
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(codes_are_those_of_c),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
