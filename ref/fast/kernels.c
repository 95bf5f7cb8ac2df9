#include "ref/fast/fast.h"

extern const struct fast_kernel fast_portable, fast_small_portable;
#if defined(__x86_64__)
extern const struct fast_kernel fast_avx2, fast_avx512, fast_small_avx2, fast_small_avx512;
#endif

const struct fast_kernel *const fast_kernels[] = {
#if defined(__x86_64__)
    &fast_avx512,
    &fast_avx2,
#endif
    &fast_portable,
    NULL,
};

const struct fast_kernel *const fast_small_kernels[] = {
#if defined(__x86_64__)
    &fast_small_avx512,
    &fast_small_avx2,
#endif
    &fast_small_portable,
    NULL,
};

static const struct fast_kernel *best_of(const struct fast_kernel *const *kernel)
{
    while (!(*kernel)->runs())
        kernel++;
    return *kernel;
}

const struct fast_kernel *fast_kernel_best(void)
{
    return best_of(fast_kernels);
}

const struct fast_kernel *fast_small_kernel_best(void)
{
    return best_of(fast_small_kernels);
}
