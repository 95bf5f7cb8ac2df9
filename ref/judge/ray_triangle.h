/* A triangle as a ray sees it, in doubles: how far points of the ray are from it. Distances are in
 * the unit of the scene, and of points relative to the ray's origin. */
#ifndef RAY_TRIANGLE_H
#define RAY_TRIANGLE_H

#include "ref/abi.h"

/* Of vectors in doubles. */
static inline double judge_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void judge_cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

struct ray_triangle {
    double v[3][3];    /* relative to the ray's origin */
    double side[3][3]; /* from vertex c to the next: not the difference of the above, which of a
                          small triangle far away is less than the rounding of a double */
    double d[3];       /* the direction */
    double n[3], area; /* across the triangle's plane, and its length: twice the area */
    double unit;       /* u * max |v| */
};

struct ray_triangle ray_triangle_of(const struct ray *ray, float v[3][3]);

/* The same of the vertices M v + T. */
struct ray_triangle ray_triangle_placed(const struct ray *ray, const float m[3][4], float v[3][3]);

/* Distance of p to the triangle: to its plane above the triangle, else to the nearest edge. */
double ray_triangle_distance(const double p[3], const struct ray_triangle *t);

/* The same of the ray's point at t. */
double ray_triangle_distance_at(double t, const struct ray_triangle *tri);

/* Distance of the ray's point at t to the triangle's plane; 0 if it has no area. */
double ray_triangle_plane_distance(double t, const struct ray_triangle *tri);

/* Distance of p to the line of the ray. */
double ray_triangle_line_distance(const double p[3], const struct ray_triangle *tri);

/* t where the ray meets the triangle's plane, in double from the triangle's own edges; not finite
 * if the ray is parallel to it. No bound of its error is proven. */
double judge_plane_t(const struct ray *ray, float v[3][3]);

#endif
