/* The generalised triangle strip of the dense geometry format, see ref/store/store_dgf1.c. */
#ifndef DENSE_STRIP_H
#define DENSE_STRIP_H

#include "ref/scene/scene.h"

#define DENSE_TRIS     64u
#define DENSE_VERTICES 64u
#define DENSE_INDICES  (3 * DENSE_TRIS)

/* How a triangle shares an edge with those before it. */
enum control { CONTROL_RESTART, CONTROL_EDGE1, CONTROL_EDGE2, CONTROL_BACKTRACK };

/* Triangles as a strip, in their order. */
struct dense_strip {
    int32_t vertex[DENSE_VERTICES][3]; /* in the order of their first indices */
    uint32_t vertices, tris, indices, reused, largest;
    uint8_t control[DENSE_TRIS], turn[DENSE_TRIS];
    bool first[DENSE_INDICES];
    uint8_t reuse[DENSE_INDICES];
};

/* Makes a strip of `count` >= 1 triangles, whose coordinates are whole numbers of steps, below 2^31
 * in magnitude. Returns false if there are too many triangles or vertices. */
bool dense_strip_make(const struct scene *scene, double step, const uint32_t *prim, uint32_t count,
                      struct dense_strip *s);

/* Returns the two vertices that a control other than CONTROL_RESTART reuses: `one` is the triangle
 * before it, with the control `before`, `two` the one before that. */
void dense_edge(enum control control, enum control before, const uint32_t one[3],
                const uint32_t two[3], uint32_t edge[2]);

#endif
