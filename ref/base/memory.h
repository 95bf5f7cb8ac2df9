/* How much memory there is: what is larger is refused before it is begun, with the numbers, where
 * the system would give it and end the process when it is used. */
#ifndef MEMORY_H
#define MEMORY_H

#include <stdbool.h>
#include <stdint.h>

/* Smaller allocations are not checked. */
#define MEMORY_LARGE ((uint64_t)256 << 20)

/* Bytes that this process can still allocate: the least of what the system reports as available and
 * what its control group (version 2) and its address space limit leave. UINT64_MAX if none is known.
 */
uint64_t memory_left(void);

/* True unless `bytes` are MEMORY_LARGE or more, and more than there are left. */
static inline bool memory_fits(uint64_t bytes)
{
    return bytes < MEMORY_LARGE || bytes <= memory_left();
}

#endif
