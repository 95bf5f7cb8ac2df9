#include "ref/judge/ray_triangle.h"

#include "ref/judge/judge_inner.h"

#include <math.h>

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
    t.unit = JUDGE_UNIT * most;
    return t;
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void sub(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[k] - b[k];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* Across the triangle's plane; its length is twice the area. */
static void normal_of(const struct ray_triangle *t, double out[3])
{
    cross(t->side[2], t->side[0], out);
}

/* Distance of p to the segment from a along ab. */
static double to_segment(const double p[3], const double a[3], const double ab[3])
{
    double ap[3], rest[3];
    sub(p, a, ap);
    double length = dot(ab, ab), s = length > 0.0 ? dot(ap, ab) / length : 0.0;
    s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    for (int k = 0; k < 3; k++)
        rest[k] = ap[k] - s * ab[k];
    return sqrt(dot(rest, rest));
}

double ray_triangle_distance(const double p[3], const struct ray_triangle *t)
{
    double n[3], ap[3], beside[3], least = INFINITY;
    bool above = true;
    normal_of(t, n);
    double area = sqrt(dot(n, n));
    for (int c = 0; c < 3; c++) {
        least = fmin(least, to_segment(p, t->v[c], t->side[c]));
        sub(p, t->v[c], ap);
        cross(t->side[c], ap, beside);
        above = above && dot(beside, n) >= 0.0;
    }
    if (!above || !(area > 0.0))
        return least;
    sub(p, t->v[0], ap);
    return fmin(least, fabs(dot(ap, n)) / area);
}

double ray_triangle_plane_distance(double t, const struct ray_triangle *tri)
{
    double n[3], p[3];
    normal_of(tri, n);
    for (int k = 0; k < 3; k++)
        p[k] = t * tri->d[k] - tri->v[0][k];
    double area = sqrt(dot(n, n));
    return area > 0.0 ? fabs(dot(p, n)) / area : 0.0;
}

double ray_triangle_line_distance(const double p[3], const struct ray_triangle *tri)
{
    double across[3], length = sqrt(dot(tri->d, tri->d));
    cross(p, tri->d, across);
    return length > 0.0 ? sqrt(dot(across, across)) / length : 0.0;
}

void judge_edge_distances(const struct ray *ray, float v[3][3], double out[3])
{
    struct ray_triangle t = ray_triangle_of(ray, v);
    for (int c = 0; c < 3; c++) {
        const double *side = t.side[(c + 1) % 3];
        double n[3], across[3];
        cross(t.v[(c + 1) % 3], side, n);
        cross(t.d, side, across);
        double length = sqrt(dot(across, across));
        out[c] = length > 0.0 ? dot(t.d, n) / length / t.unit : 0.0;
    }
}

double judge_point_displacement(const struct ray *ray, float v[3][3], double t)
{
    struct ray_triangle tri = ray_triangle_of(ray, v);
    double at[3] = {t * tri.d[0], t * tri.d[1], t * tri.d[2]};
    return tri.unit > 0.0 ? ray_triangle_distance(at, &tri) / tri.unit : 0.0;
}

double judge_unit_of_t(const struct ray *ray, float v[3][3])
{
    struct ray_triangle t = ray_triangle_of(ray, v);
    double n[3];
    normal_of(&t, n);
    return t.unit * sqrt(dot(n, n)) / fabs(dot(t.d, n));
}
