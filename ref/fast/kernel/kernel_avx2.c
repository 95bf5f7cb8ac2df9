/* The AVX2 traversal: rows of 16 vertices in two registers, the second of which most leaves do not
 * need. */
#include "ref/fast/fast.h"

#if defined(__x86_64__)

#include "ref/fast/kernel/avx2.h"
#include "ref/fast/kernel/walk.h"

const struct fast_kernel fast_avx2 = {"avx2", runs, closest, any_hit, trace_world};

#endif
