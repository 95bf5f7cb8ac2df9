/* What the running driver's float arithmetic is worth: every operation that the tracing shaders
 * use, against C's on the same numbers. */
#ifndef PROBE_H
#define PROBE_H

#include "gpu/vk.h"

#define PROBE_OPS 7u

/* One operation. Ordinary triples have magnitudes from 2^-40 to 2^40; special ones are zeros of
 * both signs, subnormals, infinities, NaNs and the ends of the range. Two NaNs are equal. */
struct probe_op {
    const char *name;
    uint32_t ordinary, ordinary_differs;
    uint32_t special, special_differs;
    uint32_t worst_ulp; /* of the ordinary ones */
};

/* Runs the probe, a few milliseconds beside the driver's compiler. Errors: as vk_dispatch. */
enum status probe_run(struct vk *vk, struct probe_op out[PROBE_OPS],
                      struct reason *reason) MUST_USE;

/* Two lines for `raydiff doctor`: the operations that equal C's, and those that do not. */
void probe_text(const struct probe_op op[PROBE_OPS], char *text, size_t text_bytes);

#endif
