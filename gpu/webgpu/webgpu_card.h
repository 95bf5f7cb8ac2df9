/* What Dawn and its driver make of WGSL's arithmetic, measured. The judge does not use it: it keeps
 * to WGSL's bounds. */
#ifndef WEBGPU_CARD_H
#define WEBGPU_CARD_H

#include "gpu/card/probe.h"
#include "ref/engine.h"

/* How an expression without fences was computed, of operands that tell. */
struct webgpu_choice {
    uint32_t telling, plain, other, neither;
};

struct webgpu_card {
    char device[128];
    struct probe_op op[PROBE_OPS];
    struct arithmetic arithmetic;       /* as gpu/card/probe.h derives it */
    struct webgpu_choice contraction;   /* a * b + c; other: fused */
    struct webgpu_choice distribution;  /* (a - b) * c; other: a * c - b * c */
    struct webgpu_choice reassociation; /* (a + b) + c; other: a + (b + c) */
};

/* Derives the card from what shaders/wgsl/probe.wgsl wrote, WEBGPU_PROBED floats a triple. */
#define WEBGPU_PROBED 10u
void webgpu_card_of(const struct probe_triple *triple, const float *got, struct webgpu_card *out);

/* Starts Dawn and measures. Errors: as webgpu_start, webgpu_run. */
enum status webgpu_card_make(const struct engine_options *options, struct webgpu_card *out,
                             struct reason *reason) MUST_USE;

void webgpu_card_text(const struct webgpu_card *card, char *text, size_t text_bytes);

#endif
