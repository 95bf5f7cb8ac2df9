/* What a compute shader from outside expects of who runs it. */
#ifndef SPIRV_INTERFACE_H
#define SPIRV_INTERFACE_H

#include "ref/base/base.h"

struct spirv_interface {
    uint32_t local[3]; /* size of a workgroup; 0: not stated */
    bool local_chosen; /* specialization constant 0 stands for local[0] */
};

/* Examines a module of `count` words. Errors: STATUS_INPUT not a module; no entry point "main" of a
 * compute shader, or one of another kind; a binding from `bindings` on, or in another set than 0;
 * capabilities beyond Shader; a workgroup of more than one dimension. STATUS_MEMORY. */
enum status spirv_interface(const uint32_t *word, size_t count, uint32_t bindings,
                            struct spirv_interface *out, struct reason *reason) MUST_USE;

#endif
