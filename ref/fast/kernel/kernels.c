#include "ref/fast/fast.h"
#include "ref/store.h"

extern const struct fast_kernel fast_portable, fast_small_portable, fast_tiny_portable;
#if defined(__x86_64__)
extern const struct fast_kernel fast_avx2, fast_avx512, fast_small_avx2, fast_small_avx512,
    fast_tiny_avx2, fast_tiny_avx512;
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

const struct fast_kernel *const fast_tiny_kernels[] = {
#if defined(__x86_64__)
    &fast_tiny_avx512,
    &fast_tiny_avx2,
#endif
    &fast_tiny_portable,
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

const struct fast_kernel *fast_tiny_kernel_best(void)
{
    return best_of(fast_tiny_kernels);
}

const struct fast_form fast_forms[3] = {
    {"fast", fast_make, fast_kernels, fast_kernel_best},
    {"fast_small", fast_make_small, fast_small_kernels, fast_small_kernel_best},
    {"fast_tiny", fast_make_tiny, fast_tiny_kernels, fast_tiny_kernel_best},
};

const struct fast_form *fast_form_of(bool small, const struct packed *packed)
{
    return &fast_forms[!small ? 0 : packed->store->id == ABI_STORE_QUANTISED ? 2 : 1];
}
