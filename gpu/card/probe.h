/* What the running driver's float arithmetic is worth: every operation that the tracing shaders
 * use, against C's on the same numbers. */
#ifndef PROBE_H
#define PROBE_H

#include "gpu/shaders/shaders.h"
#include "gpu/vk/vk.h"
#include "ref/twin/model.h"

enum probe_op_id {
    PROBE_ADD,
    PROBE_SUB,
    PROBE_MUL,
    PROBE_DIV,
    PROBE_RECIPROCAL,
    PROBE_MUL_ADD, /* two roundings: it is decorated with NoContraction */
    PROBE_LESS,
    PROBE_OPS
};

/* One operation. Ordinary triples have magnitudes from 2^-40 to 2^40; special ones are zeros of
 * both signs, subnormals, infinities, NaNs and the ends of the range. Two NaNs are equal. */
struct probe_op {
    const char *name;
    uint32_t ordinary, ordinary_differs;
    uint32_t special, special_differs;
    uint32_t flushed;   /* of those that differ: right if subnormals are zeros */
    uint32_t worst_ulp; /* of the ordinary ones */
};

/* Runs the probe, under 10 ms beside the driver's compiler. Errors: as vk_dispatch. */
enum status probe_run(struct vk *vk, struct probe_op out[PROBE_OPS],
                      struct reason *reason) MUST_USE;

/* The same with another shader of the same interface as probe_ops: for tests of the probe. */
enum status probe_run_shader(struct vk *vk, const struct shader *shader,
                             struct probe_op out[PROBE_OPS], struct reason *reason) MUST_USE;

/* What the judge may assume. */
struct arithmetic {
    struct rounding rounding;
    bool bits;    /* C's bits may be demanded */
    bool flushes; /* subnormal operands or results become zeros */
};

/* Every bit as in C: ROUNDING_IEEE, bits. Only subnormals differ, and by being zeros:
 * ROUNDING_FLUSHED, bits (where no value is subnormal). Otherwise no bits, and per operation
 * IEEE's error if all ordinary results were C's, else that of Vulkan's specification or what was
 * seen if that is worse. A sum of a product that differs alone (contraction) has smaller errors
 * than its two operations, and other bits. */
struct arithmetic probe_arithmetic(const struct probe_op op[PROBE_OPS]);

/* Measures `vk`; if that fails, Vulkan's specification without bits. */
struct arithmetic probe_measure(struct vk *vk);

/* Lines for `raydiff doctor`: the operations that equal C's, and those that do not. */
void probe_text(const struct probe_op op[PROBE_OPS], char *text, size_t text_bytes);

/* One line: what the judge uses. */
const char *probe_arithmetic_text(const struct arithmetic *arithmetic);

#endif
