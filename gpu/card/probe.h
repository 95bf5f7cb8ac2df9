/* Measures the running driver's float arithmetic: every operation that the tracing shaders use is
 * compared with C on the same numbers. */
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
    PROBE_MUL_ADD, /* two roundings, as it is decorated with NoContraction */
    PROBE_LESS,
    PROBE_OPS
};

/* One operation. Ordinary triples have magnitudes from 2^-40 to 2^40. Special ones contain zeros of
 * both signs, subnormals, infinities, NaNs or the ends of the range. Two NaNs are equal. */
struct probe_op {
    const char *name;
    uint32_t ordinary, ordinary_differs;
    uint32_t special, special_differs;
    uint32_t flushed;   /* of those that differ: right if subnormals are flushed to zero */
    uint32_t worst_ulp; /* of the ordinary triples */
};

#define PROBE_TRIPLES 16384u
struct probe_triple {
    float a, b, c;
};

/* Whether a triple has no special number. */
bool probe_is_ordinary(uint32_t i);

/* Writes the PROBE_TRIPLES triples that every probe uses. */
void probe_triples(struct probe_triple *triple);

/* Compares the PROBE_OPS results of each triple with C. */
void probe_compare(const struct probe_triple *triple, const float *got,
                   struct probe_op out[PROBE_OPS]);

/* Runs the probe, in under 10 ms plus the driver's compile time. Errors: as vk_dispatch. */
enum status probe_run(struct vk *vk, struct probe_op out[PROBE_OPS],
                      struct reason *reason) MUST_USE;

/* As probe_run with another shader of the interface of probe_ops, for tests of the probe. */
enum status probe_run_shader(struct vk *vk, const struct shader *shader,
                             struct probe_op out[PROBE_OPS], struct reason *reason) MUST_USE;

/* What the judge may assume of a device's arithmetic. */
struct arithmetic {
    struct rounding rounding;
    bool bits;    /* results must have C's bits */
    bool flushes; /* subnormal operands or results are flushed to zero */
};

/* Derives what the judge may assume. All bits as in C: ROUNDING_IEEE with bits. Only subnormals
 * differ, by being flushed to zero: ROUNDING_FLUSHED with bits (where no value is subnormal).
 * Otherwise no bits. Each operation then has IEEE's error if all ordinary results were C's, else
 * the larger of Vulkan's specified error and the measured one. If only a*b+c differs (contraction),
 * its error is smaller than that of the two operations, but its bits differ. */
struct arithmetic probe_arithmetic(const struct probe_op op[PROBE_OPS]);

/* Measures `vk`. If that fails, returns Vulkan's specified errors without bits. */
struct arithmetic probe_measure(struct vk *vk);

/* Writes lines for `raydiff doctor`: which operations equal C's, and how the others differ. */
void probe_text(const struct probe_op op[PROBE_OPS], char *text, size_t text_bytes);

/* Describes the arithmetic in one line. */
const char *probe_arithmetic_text(const struct arithmetic *arithmetic);

#endif
