/* All 65,536 half codes through the decoders of the shaders (shaders/half.glsl), on the running
 * driver, against ref/base/half.h. */
#include "ref/abi.h"
#include "ref/base/half.h"

#include "tests/support/gpu.h"

#define CODES 65536u

/* Bits of near x, near y, far x, far y, by half_bounds and by half_bounds_any. */
struct half_decoded {
    uint32_t normal[4];
    uint32_t any[4];
};

static struct half_decoded *decode(void)
{
    struct vk_options options = gpu_options();
    struct vk *vk = gpu_open(&options);
    struct half_decoded *out = calloc(CODES, sizeof *out);
    uint32_t none[4];
    assert_non_null(out);
    struct push push = {.ray_count = CODES};
    gpu_run(vk, "probe_half", (const uint32_t[]){64, ABI_BOX_ROBUST, ABI_TRI_MT, 0, 16}, 5, &push,
            sizeof push, CODES / 64, 6, (const uint64_t[]){16, CODES * sizeof *out, 16, 16, 16, 16},
            (void *const[]){none, out, none, none, none, none});
    gpu_close(vk);
    return out;
}

/* The four planes of the word that holds `code` below and `code` ^ 0x8000 above: x in order, y
 * swapped. */
static uint32_t expected(uint32_t code, int plane)
{
    uint32_t above = code ^ 0x8000u;
    uint32_t stored = plane == 0 || plane == 3 ? code : above;
    return float_bits(half_to_float((struct half){(uint16_t)stored}));
}

static bool is_normal_or_zero(uint32_t code)
{
    uint32_t exponent = code >> 10 & 31;
    return (code & 0x7FFF) == 0 || (exponent > 0 && exponent < 31);
}

static void half_decodes_every_code_the_same(void **state)
{
    (void)state;
    struct half_decoded *decoded = decode();
    for (uint32_t code = 0; code < CODES; code++)
        for (int plane = 0; plane < 4; plane++)
            if (decoded[code].any[plane] != expected(code, plane))
                fail_msg("code %04x, plane %d: %08x, not %08x", code, plane,
                         decoded[code].any[plane], expected(code, plane));
    free(decoded);
}

static void half_unpacks_zeros_and_normals_the_same(void **state)
{
    (void)state;
    struct half_decoded *decoded = decode();
    uint32_t checked = 0, subnormal_kept = 0;
    for (uint32_t code = 0; code < CODES; code++)
        for (int plane = 0; plane < 4; plane++) {
            bool same = decoded[code].normal[plane] == expected(code, plane);
            uint32_t magnitude = code & 0x7FFF;
            if (is_normal_or_zero(code)) {
                checked++;
                if (!same)
                    fail_msg("code %04x, plane %d: %08x, not %08x", code, plane,
                             decoded[code].normal[plane], expected(code, plane));
            } else if (magnitude < 0x400) {
                subnormal_kept += same;
            }
        }
    assert_int_equal(checked, 4 * (2 + 2 * 30 * 1024));
    print_message("unpackHalf2x16 keeps %u of 2046 subnormal codes (nothing relies on it)\n",
                  subnormal_kept / 4);
    free(decoded);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(half_decodes_every_code_the_same),
        cmocka_unit_test(half_unpacks_zeros_and_normals_the_same),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
