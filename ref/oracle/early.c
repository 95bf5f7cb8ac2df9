#include "ref/oracle/early.h"

#include <math.h>
#include <stddef.h>

#define EARLY_TURN_MOST 0x1p-10 /* of h */

struct early_ray early_ray_make(const struct ray *ray)
{
    struct early_ray r;
    r.kz = fabsf(ray->dir[1]) > fabsf(ray->dir[0]) ? 1 : 0;
    r.kz = fabsf(ray->dir[2]) > fabsf(ray->dir[r.kz]) ? 2 : r.kz;
    r.kx = (r.kz + 1) % 3;
    r.ky = (r.kz + 2) % 3;
    for (int k = 0; k < 3; k++)
        r.o[k] = (double)ray->org[k];
    r.s[0] = (double)ray->dir[r.kx] / (double)ray->dir[r.kz];
    r.s[1] = (double)ray->dir[r.ky] / (double)ray->dir[r.kz];
    r.bound = EARLY_BOUND;
    r.beside = EARLY_BESIDE;
    r.more = 0;
    return r;
}

struct early_ray early_ray_about(const double o[3], const double d[3], const double o_err[3],
                                 const double d_err[3])
{
    struct early_ray r = {.bound = INFINITY, .beside = INFINITY};
    r.kz = fabs(d[1]) > fabs(d[0]) ? 1 : 0;
    r.kz = fabs(d[2]) > fabs(d[r.kz]) ? 2 : r.kz;
    r.kx = (r.kz + 1) % 3;
    r.ky = (r.kz + 2) % 3;
    for (int k = 0; k < 3; k++)
        r.o[k] = o[k];
    double z = fabs(d[r.kz]) - d_err[r.kz];
    double h = (fmax(d_err[r.kx], d_err[r.ky]) + d_err[r.kz]) / z;
    double g = fmax(o_err[r.kx], o_err[r.ky]) + o_err[r.kz];
    if (!(z > 0 && h < EARLY_TURN_MOST))
        return r;
    r.s[0] = d[r.kx] / d[r.kz];
    r.s[1] = d[r.ky] / d[r.kz];
    r.bound = EARLY_BOUND * (1 + h / EARLY_SHARE);
    r.beside = EARLY_BESIDE * (1 + h / EARLY_SHARE);
    r.more = 1.01 * g / (EARLY_OWN + h);
    return r;
}

#define KERNEL plain
#define KERNEL_TARGET
#define LANES                                   1
#define V                                       double
#define LOAD(p)                                 (*(p))
#define SPLAT(x)                                (x)
#define SUB(a, b)                               ((a) - (b))
#define MUL(a, b)                               ((a) * (b))
#define MAX(a, b)                               ((a) > (b) ? (a) : (b))
#define MIN(a, b)                               ((a) < (b) ? (a) : (b))
#define MISSED(most, least, bound, minus_bound) ((most) > (bound) && (least) < (minus_bound))
#define ABOVE(value, bound)                     ((value) > (bound))
#include "ref/oracle/early_kernel.h"

static bool always(void)
{
    return true;
}

#if defined(__x86_64__)
#include <immintrin.h>

#define KERNEL sse2
#define KERNEL_TARGET
#define LANES 2
#define V     __m128d
#define LOAD  _mm_loadu_pd
#define SPLAT _mm_set1_pd
#define SUB   _mm_sub_pd
#define MUL   _mm_mul_pd
#define MAX   _mm_max_pd
#define MIN   _mm_min_pd
#define MISSED(most, least, bound, minus_bound)                                                    \
    _mm_movemask_pd(_mm_and_pd(_mm_cmpgt_pd(most, bound), _mm_cmplt_pd(least, minus_bound)))
#define ABOVE(value, bound) _mm_movemask_pd(_mm_cmpgt_pd(value, bound))
#include "ref/oracle/early_kernel.h"

#define KERNEL        avx2
#define KERNEL_TARGET __attribute__((target("avx2")))
#define LANES         4
#define V             __m256d
#define LOAD          _mm256_loadu_pd
#define SPLAT         _mm256_set1_pd
#define SUB           _mm256_sub_pd
#define MUL           _mm256_mul_pd
#define MAX           _mm256_max_pd
#define MIN           _mm256_min_pd
#define MISSED(most, least, bound, minus_bound)                                                    \
    _mm256_movemask_pd(_mm256_and_pd(_mm256_cmp_pd(most, bound, _CMP_GT_OQ),                       \
                                     _mm256_cmp_pd(least, minus_bound, _CMP_LT_OQ)))
#define ABOVE(value, bound) _mm256_movemask_pd(_mm256_cmp_pd(value, bound, _CMP_GT_OQ))
#include "ref/oracle/early_kernel.h"

#define KERNEL        avx512
#define KERNEL_TARGET __attribute__((target("avx512f")))
#define LANES         8
#define V             __m512d
#define LOAD          _mm512_loadu_pd
#define SPLAT         _mm512_set1_pd
#define SUB           _mm512_sub_pd
#define MUL           _mm512_mul_pd
#define MAX           _mm512_max_pd
#define MIN           _mm512_min_pd
#define MISSED(most, least, bound, minus_bound)                                                    \
    _mm512_mask_cmp_pd_mask(_mm512_cmp_pd_mask(most, bound, _CMP_GT_OQ), least, minus_bound,       \
                            _CMP_LT_OQ)
#define ABOVE(value, bound) _mm512_cmp_pd_mask(value, bound, _CMP_GT_OQ)
#include "ref/oracle/early_kernel.h"

static bool has_avx2(void)
{
    return __builtin_cpu_supports("avx2");
}

static bool has_avx512(void)
{
    return __builtin_cpu_supports("avx512f");
}
#endif

const struct early_kernel early_kernels[] = {
    {"plain", plain, always},
#if defined(__x86_64__)
    {"sse2", sse2, always},   {"avx2", avx2, has_avx2}, {"avx512", avx512, has_avx512},
#endif
    {NULL, NULL, NULL},
};

const struct early_kernel *early_best(void)
{
    const struct early_kernel *best = &early_kernels[0];
    for (const struct early_kernel *kernel = early_kernels; kernel->name; kernel++)
        if (kernel->runs())
            best = kernel;
    return best;
}
