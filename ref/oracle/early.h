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
 * plane all products are 0, and only this tells. EARLY_BESIDE has room over the 6.02 e M of x'.
 *
 * Of a ray in the space of a mesh, o and d are known to o_err and d_err alone. With
 *   h = (d_err_x + d_err_z) / (|dz| - d_err_z) < 2^-10, the larger of it and of the same with y,
 *   g = o_err_x + o_err_z, likewise,
 * s is off by h more, and x' by E = (6.02 e + h) M + 1.01 g in all. Let L = M + 1.01 g / (6.1 e +
 * h), so that E <= (6.1 e + h) L and |x'| <= 2.01 L. The products' difference is then off by
 * 8.04 (6.1 e + h) L^2 + 16.2 e L^2 <= (65.3 e + 8.04 h) L^2. So with L for M, both bounds times
 * 1 + h / (7 e) suffice. */
#ifndef ORACLE_EARLY_H
#define ORACLE_EARLY_H

#include "ref/abi.h"

#include <stdbool.h>

#define EARLY_BOUND   (72 * 0x1p-53)
#define EARLY_BESIDE  (8 * 0x1p-53)
#define EARLY_OWN     (6.1 * 0x1p-53)
#define EARLY_SHARE   (7 * 0x1p-53)
#define EARLY_LEAST   0x1p-400 /* of `largest`, for rays in the space of a mesh: */
#define EARLY_LARGEST 0x1p400  /* no product is subnormal or overflows */
#define EARLY_MOST    64u      /* triangles of one call */
#define EARLY_PAD     8u       /* elements that each array has behind its last */

/* Coordinates of triangles, one array per vertex and axis. */
struct early_soup {
    const double *v[3][3]; /* [vertex][axis] */
};

/* A ray whose direction is not 0. */
struct early_ray {
    double o[3];
    double s[2];          /* shear along kx, ky */
    double bound, beside; /* EARLY_BOUND and EARLY_BESIDE, or more */
    double more;          /* L - M: is added to `largest` by the caller */
    int kx, ky, kz;
};

struct early_ray early_ray_make(const struct ray *ray);

/* A ray in the space of a mesh, known to the errors; one that is not known well enough for this
 * misses nothing. */
struct early_ray early_ray_about(const double o[3], const double d[3], const double o_err[3],
                                 const double d_err[3]);

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
