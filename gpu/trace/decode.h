/* Compares what the C and the GLSL code of a layout decode from the same bytes. A shader made from
 * the layout's file (shaders/decode.glsl) writes what it reads from every record and slot. */
#ifndef DECODE_H
#define DECODE_H

#include "ref/engine.h"
#include "ref/layout.h"

struct decoded {
    uint32_t records; /* reachable records, all compared */
    uint32_t slots;   /* their items and children */
    uint32_t differ;  /* records that differ */
    char first[200];  /* the first: "record 3: y hi: C decodes 0x1p+0, GLSL 0x1p+1"; or "" */
};

/* Compares record by record. Numbers are equal by value, and a NaN equals a NaN. A reference to an
 * inner node of a wide layout is compared by what is decoded at the node that it leads to. `packed`
 * must be sound (packed_check). Errors: STATUS_UNSUPPORTED the layout has no such shader, or no
 * device; STATUS_DEVICE; STATUS_LIMIT; STATUS_MEMORY. */
enum status decode_compare(const struct packed *packed, const struct engine_options *options,
                           struct decoded *out, struct reason *reason) MUST_USE;

#endif
