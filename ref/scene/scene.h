/* Boxes, and a scene: indexed triangles with the other contents of an RTRS scene file. */
#ifndef SCENE_H
#define SCENE_H

#include "ref/base/base.h"

#include <float.h>

/* An axis-aligned box, closed. Empty when lo > hi. */
struct box {
    float lo[3];
    float hi[3];
};

static inline struct box box_empty(void)
{
    return (struct box){{FLT_MAX, FLT_MAX, FLT_MAX}, {-FLT_MAX, -FLT_MAX, -FLT_MAX}};
}

/* Grows `box` by a point; a NaN coordinate changes nothing. Uses selects instead of branches, which
 * are hard to predict here. */
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

/* Half of the surface area, in double: finite for every box of finite bounds. */
static inline double box_half_area(const struct box *box)
{
    double x = (double)box->hi[0] - (double)box->lo[0];
    double y = (double)box->hi[1] - (double)box->lo[1];
    double z = (double)box->hi[2] - (double)box->lo[2];
    return x * y + y * z + z * x;
}

/* The same; 0 for an empty box. */
static inline double box_half_area_or_none(const struct box *box)
{
    for (int k = 0; k < 3; k++)
        if (box->hi[k] < box->lo[k])
            return 0;
    return box_half_area(box);
}

struct camera {
    float pos[3];
    float at[3];
    bool orbit; /* RTRS "Orbit", else "Fixed" */
};

struct light {
    float pos[3];
    float strength;
};

struct material {
    float color[3];
    float albedo[3]; /* diffuse, specular, reflective */
    float spec;      /* exponent */
};

/* Owns its arrays (see scene_free). A scene made by a reader or generator has passed scene_check.
 * Triangle i has the vertices index[3i .. 3i+2]; hits name triangles by this index. */
struct scene {
    float *vertex;   /* 3 * vertex_count, finite */
    uint32_t *index; /* 3 * tri_count, each < vertex_count */
    uint32_t vertex_count;
    uint32_t tri_count;
    float *normal;        /* 3 * vertex_count, or NULL */
    int32_t *material_of; /* tri_count, or NULL: all 0 */
    struct light *light;  /* light_count, NULL if none */
    struct material *material;
    uint32_t light_count;
    uint32_t material_count;
    struct camera camera; /* used if has_camera; else scene_camera chooses one */
    bool has_camera;
};

/* Allocates zeroed vertex and index arrays; the rest of *out is zero. 0 triangles are allowed.
 * Errors: STATUS_MEMORY. */
enum status scene_make(uint32_t vertex_count, uint32_t tri_count, struct scene *out) MUST_USE;

/* Frees the scene's arrays and zeroes it. A zero scene is allowed. */
void scene_free(struct scene *scene);

/* Checks that indices are in range and vertices finite. Errors: STATUS_INPUT with the first invalid
 * triangle or vertex in `reason`. */
enum status scene_check(const struct scene *scene, struct reason *reason) MUST_USE;

/* Returns the exact bounds of all triangles; box_empty() without triangles. */
struct box scene_bounds(const struct scene *scene);

/* Returns the exact bounds of triangle `prim`. */
struct box scene_tri_bounds(const struct scene *scene, uint32_t prim);

/* Returns the scene's camera, or one that sees the whole scene from outside along (1, 0.7, 1.3). */
struct camera scene_camera(const struct scene *scene);

/* Copies the nine coordinates of triangle `prim`. */
static inline void scene_tri(const struct scene *scene, uint32_t prim, float v[3][3])
{
    for (int c = 0; c < 3; c++) {
        const float *p = scene->vertex + 3 * (size_t)scene->index[3 * (size_t)prim + (size_t)c];
        v[c][0] = p[0];
        v[c][1] = p[1];
        v[c][2] = p[2];
    }
}

#endif
