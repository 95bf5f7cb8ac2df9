#include "ref/oracle/filter.h"

#include <math.h>

#define EPS   0x1p-53
#define CUBIC (9 * EPS)

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

void filter_edges(const struct ray *ray, float v[3][3], struct filter *out)
{
    for (int k = 0; k < 3; k++) {
        out->d[k] = (double)ray->dir[k];
        for (int c = 0; c < 3; c++) {
            out->a[c][k] = (double)v[c][k] - (double)ray->org[k];
            out->e[c][k] = (double)v[(c + 2) % 3][k] - (double)v[(c + 1) % 3][k];
        }
    }
    for (int c = 0; c < 3; c++) {
        double perm;
        out->w[c] = triple(out->d, out->a[(c + 1) % 3], out->e[c], &perm);
        out->w_err[c] = CUBIC * perm;
    }
}

/* (v1 - v0) x (v2 - v0) = (v2 - v1) x (v0 - v2) */
void filter_plane(struct filter *out)
{
    double perm;
    out->det = triple(out->d, out->e[0], out->e[1], &perm);
    out->det_err = CUBIC * perm;
    out->t = triple(out->a[0], out->e[0], out->e[1], &perm);
    out->t_err = CUBIC * perm;
}

/* Whether the difference of two products of edges certainly is not 0. */
static bool not_zero(double left, double right)
{
    return fabs(left - right) > FILTER_FLAT * (fabs(left) + fabs(right));
}

bool filter_has_area(float v[3][3])
{
    double e1[3], e2[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
    }
    return not_zero(e1[0] * e2[1], e1[1] * e2[0]) || not_zero(e1[1] * e2[2], e1[2] * e2[1]) ||
           not_zero(e1[2] * e2[0], e1[0] * e2[2]);
}
