#include "ref/fast/fast.h"

extern const struct fast_kernel fast_portable;
#if defined(__x86_64__)
extern const struct fast_kernel fast_avx2, fast_avx512;
#endif

const struct fast_kernel *const fast_kernels[] = {
#if defined(__x86_64__)
    &fast_avx512,
    &fast_avx2,
#endif
    &fast_portable,
    NULL,
};

const struct fast_kernel *fast_kernel_best(void)
{
    size_t i = 0;
    while (!fast_kernels[i]->runs())
        i++;
    return fast_kernels[i];
}
