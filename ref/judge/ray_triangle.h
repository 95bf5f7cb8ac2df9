/* A triangle as a ray sees it, in doubles: how far points of the ray are from it. Distances are in the
 * unit of the scene, and of points relative to the ray's origin. */
#ifndef RAY_TRIANGLE_H
#define RAY_TRIANGLE_H

#include "ref/abi.h"

struct ray_triangle {
    double v[3][3];    /* relative to the ray's origin */
    double side[3][3]; /* from vertex c to the next: not the difference of the above, which of a
                          small triangle far away is less than the rounding of a double */
    double d[3];
    double unit; /* u * max |v| */
};

struct ray_triangle ray_triangle_of(const struct ray *ray, float v[3][3]);

/* Distance of p to the triangle: to its plane above the triangle, else to the nearest edge. */
double ray_triangle_distance(const double p[3], const struct ray_triangle *t);

/* Distance of the ray's point at t to the triangle's plane; 0 if it has no area. */
double ray_triangle_plane_distance(double t, const struct ray_triangle *tri);

/* Distance of p to the line of the ray. */
double ray_triangle_line_distance(const double p[3], const struct ray_triangle *tri);

#endif
