/* A card per driver: what its arithmetic, conversions and loops do, measured. The tracing shaders
 * need only what gpu/card/probe.h measures; the rest shows which operations they must avoid. */
#ifndef CARD_H
#define CARD_H

#include "gpu/card/probe.h"

#include <jansson.h>

/* How a function with a choice of roundings computes. Counted where the choices differ. */
struct card_choice {
    uint32_t telling; /* operands for which plain, other and the result are not all equal */
    uint32_t plain;   /* as if written out, each operation rounded */
    uint32_t other;   /* fused, or rearranged */
    uint32_t neither;
};

/* A function of one operand against C's nearest result. */
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
    uint32_t wrong;         /* zeros, normal numbers, infinities, NaN not as they should be */
    uint32_t kept, flushed; /* subnormal codes */
    uint32_t subnormal_wrong;
};

/* Floats to halves; compared with the nearest half, ties to even. */
struct card_pack {
    uint32_t count, differs;
    uint32_t beyond;   /* of them: no neighbour either, which Vulkan does not allow */
    uint32_t overflow; /* of them: |x| >= 65520 */
    uint32_t tiny;     /* |x| < 2^-14 */
    uint32_t normal;   /* the rest */
    float example;     /* a normal one, else any; its result and the nearest */
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

/* The card as lines of text, and as an object of JSON (NULL without memory). */
void card_text(const struct card *card, char *text, size_t text_bytes);
json_t *card_json(const struct card *card);

#endif
