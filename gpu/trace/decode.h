/* Compares what a layout's C and its GLSL decode from the same bytes. A shader made of the layout's
 * file (shaders/decode.glsl) outputs what it reads from every record and every slot. */
#ifndef DECODE_H
#define DECODE_H

#include "ref/engine.h"
#include "ref/layout.h"

struct decoded {
    uint32_t records; /* that can be reached, all of them compared */
    uint32_t slots;   /* of them: items and children */
    uint32_t differ;  /* records of which something differs */
    char first[200]; /* the first of them: "record 3: y hi: C decodes 0x1p+0, GLSL 0x1p+1"; or "" */
};

/* Compares what both decode, record by record; numbers are equal by value, and a NaN is a NaN. A
 * reference to an inner node of a wide layout is compared by what is decoded at the node that it
 * leads to. `packed` must be sound (packed_check). Errors: STATUS_UNSUPPORTED the layout
 * has no such shader, no device; STATUS_DEVICE; STATUS_LIMIT; STATUS_MEMORY. */
enum status decode_compare(const struct packed *packed, const struct engine_options *options,
                           struct decoded *out, struct reason *reason) MUST_USE;

#endif
