/* Vector types of gcc and clang, available on every processor. Expects INLINE. */
#ifndef FAST_VECTORS_H
#define FAST_VECTORS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

typedef float float4 __attribute__((vector_size(16)));
typedef float float8 __attribute__((vector_size(32)));
typedef float float16 __attribute__((vector_size(64)));
typedef int32_t int16v __attribute__((vector_size(64)));
typedef int32_t int4 __attribute__((vector_size(16)));
typedef int32_t int8 __attribute__((vector_size(32)));
typedef uint8_t byte8 __attribute__((vector_size(8)));
typedef uint16_t short8 __attribute__((vector_size(16)));

INLINE float8 all8(float x)
{
    return (float8){x, x, x, x, x, x, x, x};
}

#endif
