#include "ref/oracle/placed_filter.h"

#include <math.h>

/* [x, y, z], and its perm from the sizes of x, y and z. */
static double triple(const double x[3], const double y[3], const double z[3],
                     const double x_size[3], const double y_size[3], const double z_size[3],
                     double *perm)
{
    double sum = 0, size = 0;
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sum += x[k] * (y[i] * z[j] - y[j] * z[i]);
        size += x_size[k] * (y_size[i] * z_size[j] + y_size[j] * z_size[i]);
    }
    *perm = size;
    return sum;
}

void placed_edges(const struct ray *ray, float v[3][3], const struct instance *at,
                  struct placed_filter *out)
{
    struct filter *f = &out->filter;
    double d_size[3];
    for (int k = 0; k < 3; k++) {
        const double m[3] = {(double)at->m[k][0], (double)at->m[k][1], (double)at->m[k][2]};
        double shift = (double)at->m[k][3] - (double)ray->org[k];
        f->d[k] = (double)ray->dir[k];
        d_size[k] = fabs(f->d[k]);
        for (int c = 0; c < 3; c++) {
            const float *p = v[c], *from = v[(c + 1) % 3], *to = v[(c + 2) % 3];
            double a[3], e[3];
            for (int j = 0; j < 3; j++) {
                a[j] = m[j] * (double)p[j];
                e[j] = m[j] * ((double)to[j] - (double)from[j]);
            }
            f->a[c][k] = a[0] + a[1] + a[2] + shift;
            out->a_size[c][k] = fabs(a[0]) + fabs(a[1]) + fabs(a[2]) + fabs(shift);
            f->e[c][k] = e[0] + e[1] + e[2];
            out->e_size[c][k] = fabs(e[0]) + fabs(e[1]) + fabs(e[2]);
        }
    }
    for (int c = 0; c < 3; c++) {
        double perm;
        f->w[c] = triple(f->d, f->a[(c + 1) % 3], f->e[c], d_size, out->a_size[(c + 1) % 3],
                         out->e_size[c], &perm);
        f->w_err[c] = PLACED_CUBIC * perm;
    }
}

void placed_plane(struct placed_filter *out)
{
    struct filter *f = &out->filter;
    double d_size[3], perm;
    for (int k = 0; k < 3; k++)
        d_size[k] = fabs(f->d[k]);
    f->det = triple(f->d, f->e[0], f->e[1], d_size, out->e_size[0], out->e_size[1], &perm);
    f->det_err = PLACED_CUBIC * perm;
    f->t = triple(f->a[0], f->e[0], f->e[1], out->a_size[0], out->e_size[0], out->e_size[1], &perm);
    f->t_err = PLACED_CUBIC * perm;
}

static bool moderate(double x)
{
    return x == 0 || (fabs(x) >= 0x1p-400 && fabs(x) <= 0x1p400);
}

bool placed_is_moderate(const struct placed_filter *placed)
{
    const struct filter *f = &placed->filter;
    return moderate(f->w[0]) && moderate(f->w[1]) && moderate(f->w[2]) && moderate(f->det) &&
           moderate(f->t);
}
