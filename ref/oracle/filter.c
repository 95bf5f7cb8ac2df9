#include "ref/oracle/filter.h"

#include "ref/mutant.h"

#include <math.h>

#define EPS 0x1p-53
#if MUTANT == MUTANT_FILTER_BOUND
#define CUBIC (0.125 * EPS)
#else
#define CUBIC (9 * EPS)
#endif

/* [x, y, z], and its perm. */
static double triple(const double x[3], const double y[3], const double z[3], double *perm)
{
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        double left = y[i] * z[j], right = y[j] * z[i];
        sum += x[k] * (left - right);
        size += fabs(x[k]) * (fabs(left) + fabs(right));
    }
    *perm = size;
    return sum;
}

static void subtract(const struct ray *ray, float v[3][3], double a[3][3], double d[3])
{
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->dir[k];
        for (int c = 0; c < 3; c++)
            a[c][k] = (double)v[c][k] - (double)ray->org[k];
    }
}

void filter_eval(const struct ray *ray, float v[3][3], struct filter *out)
{
    double a[3][3], d[3], e1[3], e2[3], perm;
    subtract(ray, v, a, d);
    for (int c = 0; c < 3; c++) {
        out->w[c] = triple(d, a[(c + 1) % 3], a[(c + 2) % 3], &perm);
        out->w_err[c] = CUBIC * perm;
    }
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
    }
    out->det = triple(d, e1, e2, &perm);
    out->det_err = CUBIC * perm;
    out->t = triple(a[0], e1, e2, &perm);
    out->t_err = CUBIC * perm;
}

bool filter_misses(const struct ray *ray, float v[3][3])
{
    double a[3][3], d[3];
    bool positive = false, negative = false;
    subtract(ray, v, a, d);
    for (int c = 0; c < 3; c++) {
        double perm, w = triple(d, a[(c + 1) % 3], a[(c + 2) % 3], &perm);
        positive |= w > CUBIC * perm;
        negative |= w < -CUBIC * perm;
    }
    return positive && negative;
}
