/* The first test of many triangles, vectorised over triangles: which of them does the line of a ray
 * certainly miss? Most are dropped here.
 *
 * With z the largest axis of |d| and s = (dx/dz, dy/dz), the line is moved onto the z axis by the
 * shear x' = X - sx Z, y' = Y - sy Z of X = v - o (Woop, Benthin, Wald 2013); then the products
 * x'_b y'_c - y'_b x'_c are w / dz, all three with the same factor, so that two of opposite sign
 * are a miss. Let M bound |v - o| in every axis and e = 2^-53. Then
 *   |X^ - X| <= e M, |sx^ Z^ rounded - sx Z| <= 3.01 e M, so |x'^ - x'| <= 6.02 e M, |x'| <= 2 M;
 *   each product is off by 2 * 2.01 M * 6.02 e M + 4.05 e M^2 <= 28.3 e M^2;
 *   the difference by 2 * 28.3 e M^2 + 8.1 e M^2 <= 65 e M^2.
 * EARLY_BOUND has room for M computed in double. Nothing underflows: with float32 inputs s is at
 * least 2^-277, x' a multiple of 2^-479, the products of 2^-958.
 *
 * A triangle whose x' are all of one sign lies beside the line, too; so with y'. Of a ray in its
 * plane all products are 0, and only this tells. EARLY_BESIDE has room over the 6.02 e M of x'. */
#ifndef ORACLE_EARLY_H
#define ORACLE_EARLY_H

#include "ref/abi.h"

#include <stdbool.h>

#define EARLY_BOUND  (72 * 0x1p-53)
#define EARLY_BESIDE (8 * 0x1p-53)
#define EARLY_MOST   64u /* triangles of one call */
#define EARLY_PAD    8u  /* elements that each array has behind its last */

/* Coordinates of triangles, one array per vertex and axis. */
struct early_soup {
    const double *v[3][3]; /* [vertex][axis] */
};

/* A ray whose direction is not 0. */
struct early_ray {
    double o[3];
    double s[2]; /* shear along kx, ky */
    int kx, ky, kz;
};

struct early_ray early_ray_make(const struct ray *ray);

/* Returns a bit for each of the triangles first .. first + count - 1 (count <= EARLY_MOST) that is
 * not certainly missed; `largest` bounds |v - o| of all of them in every axis. The same bits from
 * every kernel. */
typedef uint64_t early_function(const struct early_soup *soup, const struct early_ray *ray,
                                uint32_t first, uint32_t count, double largest);

struct early_kernel {
    const char *name; /* "plain", "sse2", "avx2", "avx512" */
    early_function *look;
    bool (*runs)(void); /* whether it runs on this machine */
};

/* All compiled kernels, the fastest last; ends with name NULL. */
extern const struct early_kernel early_kernels[];

/* The fastest kernel that runs on this machine. */
const struct early_kernel *early_best(void);

#endif
