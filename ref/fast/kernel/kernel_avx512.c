/* The AVX-512 traversal: rows of 16 vertices in one register, and children sorted in one. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#define FAST_PACKETS
#include "ref/fast/kernel/avx512.h"
#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_avx512 = {"avx512", runs, closest, any_hit, trace_world};

#endif
