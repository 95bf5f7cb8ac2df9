#include "gpu/accel/accel_format.h"

#include "ref/base/half.h"

#include <math.h>
#include <string.h>

const struct accel_format_facts accel_format[ACCEL_FORMATS] = {
    [ACCEL_F32X3] = {"f32x3", "R32G32B32_SFLOAT", 106, 12, 4, 3, 32, ACCEL_FLOAT, false, true},
    [ACCEL_F32X2] = {"f32x2", "R32G32_SFLOAT", 103, 8, 4, 2, 32, ACCEL_FLOAT, false, true},
    [ACCEL_F32X4] = {"f32x4", "R32G32B32A32_SFLOAT", 109, 16, 4, 4, 32, ACCEL_FLOAT, false, true},
    [ACCEL_F16X2] = {"f16x2", "R16G16_SFLOAT", 83, 4, 2, 2, 16, ACCEL_FLOAT, false, true},
    [ACCEL_F16X3] = {"f16x3", "R16G16B16_SFLOAT", 90, 6, 2, 3, 16, ACCEL_FLOAT, false, true},
    [ACCEL_F16X4] = {"f16x4", "R16G16B16A16_SFLOAT", 97, 8, 2, 4, 16, ACCEL_FLOAT, false, true},
    [ACCEL_S16X2] = {"s16x2", "R16G16_SNORM", 78, 4, 2, 2, 16, ACCEL_SNORM, false, false},
    [ACCEL_S16X4] = {"s16x4", "R16G16B16A16_SNORM", 92, 8, 2, 4, 16, ACCEL_SNORM, false, false},
    [ACCEL_U16X2] = {"u16x2", "R16G16_UNORM", 77, 4, 2, 2, 16, ACCEL_UNORM, false, false},
    [ACCEL_U16X4] = {"u16x4", "R16G16B16A16_UNORM", 91, 8, 2, 4, 16, ACCEL_UNORM, false, false},
    [ACCEL_S8X2] = {"s8x2", "R8G8_SNORM", 17, 2, 1, 2, 8, ACCEL_SNORM, false, false},
    [ACCEL_S8X4] = {"s8x4", "R8G8B8A8_SNORM", 38, 4, 1, 4, 8, ACCEL_SNORM, false, false},
    [ACCEL_U8X2] = {"u8x2", "R8G8_UNORM", 16, 2, 1, 2, 8, ACCEL_UNORM, false, false},
    [ACCEL_U8X4] = {"u8x4", "R8G8B8A8_UNORM", 37, 4, 1, 4, 8, ACCEL_UNORM, false, false},
    [ACCEL_U10X3] = {"u10x3", "A2B10G10R10_UNORM_PACK32", 64, 4, 4, 3, 10, ACCEL_UNORM, true,
                     false},
    [ACCEL_F64X3] = {"f64x3", "R64G64B64_SFLOAT", 118, 24, 8, 3, 64, ACCEL_FLOAT, false, true},
};

/* The bits of a number, or false if the format does not hold it. */
static bool bits_of(const struct accel_format_facts *format, float x, uint64_t *bits)
{
    const uint32_t lower = format->kind == ACCEL_SNORM ? format->bits - 1 : format->bits;
    const uint64_t most = UINT64_MAX >> (64 - lower);
    const double wide = (double)x;
    *bits = 0;
    if (format->kind != ACCEL_FLOAT) {
        *bits = x == 0.0f ? 0 : x == 1.0f ? most : (1ull << format->bits) - most;
        return x == 0.0f || x == 1.0f || (x == -1.0f && format->kind == ACCEL_SNORM);
    }
    if (format->bits == 16) {
        const struct half half = half_nearest(x);
        *bits = half.bits;
        return half_to_float(half) == x || isnan(x);
    }
    if (format->bits == 32)
        memcpy(bits, &x, sizeof x);
    else
        memcpy(bits, &wide, sizeof wide);
    return true;
}

/* What no driver may read: a NaN, or all bits. */
#define UNREAD UINT64_MAX

static void put(const struct accel_format_facts *format, uint32_t component, uint64_t bits,
                uint8_t *to)
{
    const uint32_t bytes = format->bits / 8;
    uint32_t word = 0;
    if (!format->packed) {
        for (uint32_t i = 0; i < bytes; i++)
            to[component * bytes + i] = (uint8_t)(bits >> 8 * i);
        return;
    }
    memcpy(&word, to, sizeof word);
    word = component == 0 ? 0xC0000000u : word;
    word |= (uint32_t)bits << format->bits * component;
    memcpy(to, &word, sizeof word);
}

bool accel_encode(enum accel_format format, const float at[3], uint8_t *to)
{
    const struct accel_format_facts *facts = &accel_format[format];
    bool exact = true;
    for (uint32_t k = 0; k < 3; k++) {
        uint64_t bits = 0;
        if (k >= facts->components) {
            exact = exact && at[k] == 0.0f;
        } else {
            exact = bits_of(facts, at[k], &bits) && exact;
            put(facts, k, bits, to);
        }
    }
    if (facts->components == 4)
        put(facts, 3, UNREAD, to);
    return exact;
}

void accel_encode_nan(enum accel_format format, const float at[3], uint8_t *to)
{
    const float none[3] = {NAN, at[1], at[2]};
    (void)accel_encode(format, none, to);
}
