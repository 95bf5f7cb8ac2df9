/* Available memory. A job that needs more is rejected, with the numbers, before it starts: the
 * system might grant the allocation and kill the process when the memory is used. */
#ifndef MEMORY_H
#define MEMORY_H

#include <stdbool.h>
#include <stdint.h>

/* Smaller allocations are not checked. */
#define MEMORY_LARGE ((uint64_t)256 << 20)

/* Returns the bytes that this process can still allocate: the least of what the system reports as
 * available and what its control group (version 2) and its address space limit leave. UINT64_MAX if
 * none is known. */
uint64_t memory_left(void);

/* True if `bytes` is below MEMORY_LARGE or at most memory_left(). */
static inline bool memory_fits(uint64_t bytes)
{
    return bytes < MEMORY_LARGE || bytes <= memory_left();
}

#endif
