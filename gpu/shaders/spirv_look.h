/* Examines a SPIR-V module's arithmetic by the types of results, not by a list of operations as the
 * build's tool does (shaders/spirv_tool.c), so that each can check the other. */
#ifndef SPIRV_LOOK_H
#define SPIRV_LOOK_H

#include "gpu/shaders/shaders.h"
#include "ref/base/base.h"

struct spirv_found {
    uint32_t float_ops;          /* arithmetic with a float result */
    uint32_t bare;               /* of them, without NoContraction: a driver may fuse them */
    uint32_t bare_signs;         /* of these, negations, which round nothing */
    uint32_t sums;               /* dot and matrix products */
    uint32_t inexact_ext;        /* extended instructions other than UnpackHalf2x16 */
    uint32_t open_ext;           /* those with a float result whose rounding or NaNs are open */
    uint32_t other_capabilities; /* other than Shader */
};

/* Examines a module of `count` words. Errors: STATUS_INPUT not a module; STATUS_MEMORY. */
enum status spirv_look(const uint32_t *word, uint32_t count, struct spirv_found *out,
                       struct reason *reason) MUST_USE;

/* Checks that all float arithmetic in every tracing shader of this program is decorated. Errors:
 * STATUS_INTERNAL "shader NAME: n of m float operations without NoContraction"; as spirv_look. */
enum status spirv_check_tracing(struct reason *reason) MUST_USE;

#endif
