#include "ref/judge/ray_triangle.h"

#include "ref/judge/judge_inner.h"

#include <math.h>

static void finish(struct ray_triangle *t, double most)
{
    t->unit = JUDGE_UNIT * most;
    judge_cross(t->side[2], t->side[0], t->n);
    t->area = sqrt(judge_dot(t->n, t->n));
}

struct ray_triangle ray_triangle_of(const struct ray *ray, float v[3][3])
{
    struct ray_triangle t;
    double most = 0.0;
    for (int k = 0; k < 3; k++) {
        t.d[k] = (double)ray->dir[k];
        for (int c = 0; c < 3; c++) {
            t.v[c][k] = (double)v[c][k] - (double)ray->org[k];
            t.side[c][k] = (double)v[(c + 1) % 3][k] - (double)v[c][k];
            most = fmax(most, fabs(t.v[c][k]));
        }
    }
    finish(&t, most);
    return t;
}

struct ray_triangle ray_triangle_placed(const struct ray *ray, const float m[3][4], float v[3][3])
{
    struct ray_triangle t;
    double most = 0.0;
    for (int k = 0; k < 3; k++) {
        t.d[k] = (double)ray->dir[k];
        for (int c = 0; c < 3; c++) {
            const float *from = v[c], *to = v[(c + 1) % 3];
            t.v[c][k] = (double)m[k][3] - (double)ray->org[k];
            t.side[c][k] = 0.0;
            for (int j = 0; j < 3; j++) {
                t.v[c][k] += (double)m[k][j] * (double)from[j];
                t.side[c][k] += (double)m[k][j] * ((double)to[j] - (double)from[j]);
            }
            most = fmax(most, fabs(t.v[c][k]));
        }
    }
    finish(&t, most);
    return t;
}

static void sub(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

/* Distance of p to the segment from a along ab. */
static double to_segment(const double p[3], const double a[3], const double ab[3])
{
    double ap[3], rest[3];
    sub(p, a, ap);
    double length = judge_dot(ab, ab), s = length > 0.0 ? judge_dot(ap, ab) / length : 0.0;
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    for (int k = 0; k < 3; k++)
        rest[k] = ap[k] - s * ab[k];
    return sqrt(judge_dot(rest, rest));
}

double ray_triangle_distance(const double p[3], const struct ray_triangle *t)
{
    double ap[3], beside[3], least = INFINITY;
    bool above = true;
    for (int c = 0; c < 3; c++) {
        least = fmin(least, to_segment(p, t->v[c], t->side[c]));
        sub(p, t->v[c], ap);
        judge_cross(t->side[c], ap, beside);
        above = above && judge_dot(beside, t->n) >= 0.0;
    }
    if (!above || !(t->area > 0.0))
        return least;
    sub(p, t->v[0], ap);
    return fmin(least, fabs(judge_dot(ap, t->n)) / t->area);
}

double ray_triangle_distance_at(double t, const struct ray_triangle *tri)
{
    const double at[3] = {t * tri->d[0], t * tri->d[1], t * tri->d[2]};
    return ray_triangle_distance(at, tri);
}

double ray_triangle_plane_distance(double t, const struct ray_triangle *tri)
{
    double p[3];
    for (int k = 0; k < 3; k++)
        p[k] = t * tri->d[k] - tri->v[0][k];
    return tri->area > 0.0 ? fabs(judge_dot(p, tri->n)) / tri->area : 0.0;
}

double ray_triangle_line_distance(const double p[3], const struct ray_triangle *tri)
{
    double across[3], length = sqrt(judge_dot(tri->d, tri->d));
    judge_cross(p, tri->d, across);
    return length > 0.0 ? sqrt(judge_dot(across, across)) / length : 0.0;
}

double judge_plane_t(const struct ray *ray, float v[3][3])
{
    double d[3], e1[3], e2[3], s[3], n[3];
    for (int k = 0; k < 3; k++) {
        d[k] = (double)ray->dir[k];
        e1[k] = (double)v[1][k] - (double)v[0][k];
        e2[k] = (double)v[2][k] - (double)v[0][k];
        s[k] = (double)v[0][k] - (double)ray->org[k];
    }
    judge_cross(e1, e2, n);
    return judge_dot(s, n) / judge_dot(d, n);
}

double judge_point_displacement(const struct ray_triangle *tri, double t)
{
    return tri->unit > 0.0 ? ray_triangle_distance_at(t, tri) / tri->unit : 0.0;
}
