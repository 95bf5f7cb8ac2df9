/* A pass of the radix sort: an invocation has ABI_BUILD_EACH keys in a row. */
#ifndef BUILD_DIGIT_GLSL
#define BUILD_DIGIT_GLSL

#include "build_job.glsl"

#define DIGITS (1u << ABI_BUILD_DIGIT)

uvec4 key_at(uint i)
{
    return job.swapped != 0u ? others[i] : keys[i];
}

uint digit_of(uvec4 key)
{
    uint word = job.shift < 32u ? key.y : key.x;
    return (word >> (job.shift & 31u)) & (DIGITS - 1u);
}

#endif
