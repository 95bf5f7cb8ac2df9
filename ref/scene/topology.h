/* How the triangles of a scene are connected. Vertices at the same position are one point. An edge
 * lists its triangles and the direction of each; a point lists the triangles around it. */
#ifndef TOPOLOGY_H
#define TOPOLOGY_H

#include "ref/scene/scene.h"

#define TOPOLOGY_NONE 0xFFFFFFFFu

/* An edge between points a < b. */
struct topology_edge {
    uint32_t a, b;
    uint32_t first;    /* its triangles are side[first .. first + forward + backward - 1] */
    uint32_t forward;  /* number of these that traverse it from a to b; they come first */
    uint32_t backward; /* number of these that traverse it from b to a */
};

/* Owns its arrays. */
struct topology {
    uint32_t vertex_count, tri_count, point_count, edge_count;
    uint32_t collapsed; /* triangles with two corners at one point: they have no edges and are in no
                           fan */
    uint32_t *point;    /* vertex_count: the point of each vertex */
    uint32_t *corner;   /* 3 * tri_count: the points of each triangle */
    uint32_t *vertex;   /* point_count: the first vertex at each point */
    uint32_t *edge_of;  /* 3 * tri_count: [3 * i + c] is the edge from corner c to the next one,
                           TOPOLOGY_NONE in collapsed triangles */
    struct topology_edge *edge; /* edge_count, sorted by a, then b */
    uint32_t *side;             /* triangles of the edges */
    uint32_t *fan_first;        /* point_count + 1 */
    uint32_t *fan; /* triangles around point p: fan[fan_first[p] .. fan_first[p + 1] - 1] */
};

/* Welds vertices whose coordinates are equal as numbers (+0 == -0) and lists edges and fans. The
 * scene must have passed scene_check and is not kept. In each direction of an edge and in every fan
 * triangles are in ascending order. Errors: STATUS_LIMIT over 2^32 / 3 triangles; STATUS_MEMORY. */
enum status topology_make(const struct scene *scene, struct topology *out,
                          struct reason *reason) MUST_USE;
void topology_free(struct topology *topology); /* does nothing if zero */

/* True if as many triangles traverse the edge in one direction as in the other: two neighbours of
 * one winding, or several such pairs. */
bool topology_edge_closed(const struct topology_edge *edge);

/* True if every edge at point `p` is closed, and there is at least one. */
bool topology_fan_closed(const struct topology *topology, uint32_t p);

/* True if the fan of point `p` is one ring: every edge at p joins exactly two of its triangles, of
 * one winding, and all of them are connected. */
bool topology_fan_is_ring(const struct topology *topology, uint32_t p);

/* Returns the edge that triangles `a` and `b`, which must differ, share and traverse in opposite
 * directions, as neighbours of one winding do; TOPOLOGY_NONE if there is none. */
uint32_t topology_shared_edge(const struct topology *topology, uint32_t a, uint32_t b);

/* Returns the first edge that is not closed, in the order of `edge`; TOPOLOGY_NONE if the mesh is
 * closed and consistently wound. */
uint32_t topology_open_edge(const struct topology *topology);

/* Returns STATUS_OK if the mesh is closed, consistently wound and has a triangle. Else STATUS_INPUT
 * with the first open edge: its triangle, its vertices and their positions, and what is wrong
 * there. */
enum status topology_is_closed(const struct topology *topology, const struct scene *scene,
                               struct reason *reason) MUST_USE;

#endif
