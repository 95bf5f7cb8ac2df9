/* Boxes and the few vector operations that builders and scenes share. The box and triangle tests
 * do not use it: their operation order is part of their contract (ref/primitives/). */
#ifndef GEOM_H
#define GEOM_H

#include <float.h>
#include <stdbool.h>

struct vec3 {
    float x, y, z;
};

/* An axis-aligned box, closed. Empty when lo > hi. */
struct box {
    float lo[3];
    float hi[3];
};

static inline struct box box_empty(void)
{
    return (struct box){{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

/* Grows `box` by a point; a NaN coordinate changes nothing. Selects, not branches, which are hard
 * to predict here. */
static inline void box_add_point(struct box *box, const float p[3])
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = p[k] < box->lo[k] ? p[k] : box->lo[k];
        box->hi[k] = p[k] > box->hi[k] ? p[k] : box->hi[k];
    }
}

static inline void box_add_box(struct box *box, const struct box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

static inline bool box_contains_box(const struct box *outer, const struct box *inner)
{
    for (int k = 0; k < 3; k++)
        if (!(outer->lo[k] <= inner->lo[k] && inner->hi[k] <= outer->hi[k]))
            return false;
    return true;
}

/* Half its area, in double: finite for every box of finite bounds. */
static inline double box_half_area(const struct box *box)
{
    double x = (double)box->hi[0] - (double)box->lo[0];
    double y = (double)box->hi[1] - (double)box->lo[1];
    double z = (double)box->hi[2] - (double)box->lo[2];
    return x * y + y * z + z * x;
}

/* The same; 0 of an empty box. */
static inline double box_half_area_or_none(const struct box *box)
{
    for (int k = 0; k < 3; k++)
        if (box->hi[k] < box->lo[k])
            return 0;
    return box_half_area(box);
}

static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline struct vec3 vec3_scale(struct vec3 a, float s)
{
    return (struct vec3){a.x * s, a.y * s, a.z * s};
}

static inline float vec3_dot(struct vec3 a, struct vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
    return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

#endif
