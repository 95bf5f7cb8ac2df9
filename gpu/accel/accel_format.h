/* Formats of vertices: what they hold, and which numbers they hold exactly. */
#ifndef ACCEL_FORMAT_H
#define ACCEL_FORMAT_H

#include "gpu/accel/accel_variant.h"

/* How a component is stored. */
enum accel_kind { ACCEL_FLOAT, ACCEL_SNORM, ACCEL_UNORM };

struct accel_format_facts {
    const char *name;    /* as in a variant */
    const char *vulkan;  /* VK_FORMAT_... */
    uint32_t vk_format;  /* its number */
    uint32_t bytes;      /* of a vertex */
    uint32_t align;      /* of its address, and what strides are multiples of */
    uint32_t components; /* 2: z is 0; of 4 the last is not read */
    uint32_t bits;       /* of a component */
    enum accel_kind kind;
    bool packed; /* in one word, x lowest */
    bool nan;    /* there is a NaN */
};

extern const struct accel_format_facts accel_format[ACCEL_FORMATS];

/* Writes a vertex. Returns false if a coordinate is no number of the format, or not one whose value
 * the standard gives exactly: of a normalised format these are -1, 0 and 1. */
bool accel_encode(enum accel_format format, const float at[3], uint8_t *to);

/* Writes a vertex whose x is NaN; the format has one. */
void accel_encode_nan(enum accel_format format, const float at[3], uint8_t *to);

#endif
