/* A driver's card: measurements of its arithmetic, conversions and loops. The tracing shaders need
 * only what gpu/card/probe.h measures; the rest shows which operations they must avoid. */
#ifndef CARD_H
#define CARD_H

#include "gpu/card/probe.h"

#include <jansson.h>

/* How the driver computes a function that it may round in different ways. Counted where the results
 * differ. */
struct card_choice {
    uint32_t telling; /* operands for which plain, other and the result are not all equal */
    uint32_t plain;   /* as written, each operation rounded */
    uint32_t other;   /* fused, or rearranged */
    uint32_t neither;
};

/* A function of one operand, compared with the nearest result in C. */
struct card_root {
    uint32_t count, differs, worst_ulp;
};

/* Results for (1, NaN), (NaN, 1), (-0, +0), (+0, -0). */
struct card_pair {
    float first_nan, second_nan; /* of (NaN, 1) and (1, NaN) */
    float minus_plus, plus_minus;
};

/* All 65,536 codes of a half, in both halves of a word. */
struct card_unpack {
    uint32_t wrong;         /* zeros, normal numbers, infinities or NaN that are wrong */
    uint32_t kept, flushed; /* subnormal codes */
    uint32_t subnormal_wrong;
};

/* Conversion of floats to halves, compared with the nearest half, ties to even. */
struct card_pack {
    uint32_t count, differs;
    uint32_t beyond;   /* of them: not even a neighbour, which Vulkan does not allow */
    uint32_t overflow; /* of them: |x| >= 65520 */
    uint32_t tiny;     /* |x| < 2^-14 */
    uint32_t normal;   /* the rest */
    float example;     /* a normal number if one differs, else any */
    uint32_t example_got, example_nearest;
};

#define CARD_LOOPS 3u

/* Iterations of one loop, of two loops in sequence, and of two nested loops. */
struct card_loop {
    uint32_t asked[CARD_LOOPS], ran[CARD_LOOPS];
};

struct card {
    struct vk_limits limits;
    struct probe_op op[PROBE_OPS];
    struct arithmetic arithmetic;
    struct card_root sqrt, inversesqrt;
    struct card_pair min, max;
    struct card_choice fma;          /* other: fused */
    struct card_choice contraction;  /* a*b+c without NoContraction; other: fused */
    struct card_choice distribution; /* (a-b)*c without NoContraction; other: a*c-b*c */
    struct card_unpack unpack;
    struct card_pack pack;
    struct card_loop loop;
};

/* Measures an open device. Errors: as vk_dispatch. */
enum status card_make(struct vk *vk, struct card *out, struct reason *reason) MUST_USE;

/* Writes the card as lines of text, or returns it as a JSON object (NULL without memory). */
void card_text(const struct card *card, char *text, size_t text_bytes);
json_t *card_json(const struct card *card);

#endif
