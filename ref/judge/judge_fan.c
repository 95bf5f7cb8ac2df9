/* Why a watertight test cannot miss the inside of a closed fan.
 *
 * Woop's test shears each vertex into the plane across the ray, the ray itself to its origin O; the
 * sheared place X depends on the vertex position and the ray alone, so all triangles around a
 * vertex see the same X. (Equal positions give equal X; -0 for +0 changes only signs of zeros.) Of
 * the edge from X to Y it computes fl(fl(Xx Yy) - fl(Xy Yx)), or the negative of it. Rounding is
 * monotone, so ab >= cd implies fl(ab) >= fl(cd): the computed sign is never the opposite of the
 * exact sign for X and Y, at most 0 in its place, and seen from the triangle on the other side it
 * is the same with the other sign. Zero counts as inside.
 *
 * A fan here is a set S of triangles grown from one of them: beyond each edge whose computed sign
 * is not proven to be s, the common sign of all determinants, the neighbour joins, and it must run
 * along that edge in the opposite direction. The fan is closed if each such edge has exactly one
 * neighbour, each determinant is proven (so not computed 0 either), each t is proven to lie inside
 * the range, and an edge is left beyond which no triangle was tested. Around an edge or a vertex
 * that the ray nearly meets that is the fan of the edge or the vertex.
 *
 * Claim: the test accepts a triangle of S. Take s = +1, and a point Q near O on no line of an edge.
 * The number of triangles of S with Q inside is the sum of their winding numbers around Q, as all
 * are counterclockwise. Each winding number is a sum of angles over directed edges. The two
 * directions of an edge that was crossed cancel; what is left are edges proven to be positive,
 * which see O, and so Q, strictly on their left: each has a positive angle, and there is at least
 * one. So the sum is positive, a whole number, at least 1: some triangle has Q inside. S is finite,
 * so with Q going to O some triangle has O inside or on its border: its exact edge functions for
 * the sheared places are >= 0, so the computed ones are; its computed determinant is not 0 and its
 * computed t lies in the range. It is accepted, with a t of at most its exact one + E.
 *
 * "Proven" is as in the twin: the exact value, and every evaluation of it that the rounding
 * allows, has that sign; the exact edge function of the sheared places is one of those evaluations.
 *
 * In a world a fan lies within one instance: all its triangles see one ray, o' and d', in the space
 * of the mesh, whatever that is off, and signs are proven for every o' and d' that may be computed.
 * Each triangle must surely count: one that is culled or passed over is none that the test can hit.
 * Nothing is proven across instances. */
#include "ref/judge/judge_inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles of a fan; larger ones (the poles of very fine spheres) get the boundary band. */
#define FAN_MOST 1024

struct fan {
    const struct judge *judge;
    const struct topology *topology;
    const struct ray *ray;
    struct judge_at at; /* the first triangle */
    uint32_t prim[FAN_MOST];
    size_t count;
    int sign;     /* of all determinants */
    bool rim;     /* an edge is left beyond which no triangle was tested */
    double limit; /* largest t that some triangle may answer */
};

/* What is proven of one triangle. */
struct seen {
    int edge[3], det;
    double t_most;
};

/* Returns false if its t is not proven to lie inside the range, or if it may not count. */
static bool see_by_twin(const struct fan *fan, uint32_t prim, struct seen *seen)
{
    struct twin twin = judge_twin(fan->judge, fan->ray, prim, NULL);
    double t = twin.t_near, e = twin.t_err + twin.t_off;
    seen->det = twin.det;
    memcpy(seen->edge, twin.edge, sizeof seen->edge);
    seen->t_most = t + 2.0 * e;
    return t - e > (double)fan->ray->tmin && t + e < (double)fan->ray->tmax &&
           judge_surely_counts(fan->judge, fan->ray, prim, &twin);
}

/* The same by exact signs and distances, for an unknown formula. */
static bool see_by_distance(const struct fan *fan, uint32_t prim, struct seen *seen)
{
    float v[3][3];
    struct oracle_pair pair;
    judge_tri(fan->judge, prim, v); /* where it is: at the identity, if in a world */
    oracle_pair(fan->judge->oracle, fan->ray, prim, &pair);
    struct judge_rounding rounding = judge_rounding_of(fan->ray, v);
    seen->det = pair.det;
    for (int c = 0; c < 3; c++)
        seen->edge[c] = fabs(judge_edge_distance(&rounding, c)) > FAN_BAND ? pair.edge[c] : 0;
    double t = judge_plane_t(fan->ray, v), band = FAN_BAND * judge_unit_of_t(&rounding);
    seen->t_most = t + fmax(1.0, fan->judge->displacement / FAN_BAND) * band;
    return t - band > (double)fan->ray->tmin && t + band < (double)fan->ray->tmax &&
           judge_surely_counts(fan->judge, fan->ray, prim, NULL);
}

/* The one other triangle at the edge opposite corner `c`, which it runs along the other way;
 * TOPOLOGY_NONE if there is none, or more than one. */
static uint32_t beyond(const struct topology *topology, uint32_t prim, uint32_t c)
{
    uint32_t e = topology->edge_of[3 * (size_t)prim + (c + 1) % 3];
    if (e == TOPOLOGY_NONE)
        return TOPOLOGY_NONE;
    const struct topology_edge *edge = &topology->edge[e];
    if (edge->forward != 1 || edge->backward != 1)
        return TOPOLOGY_NONE;
    const uint32_t *side = topology->side + edge->first;
    return side[0] == prim ? side[1] : side[0];
}

static bool join(struct fan *fan, uint32_t prim)
{
    for (size_t i = 0; i < fan->count; i++)
        if (fan->prim[i] == prim)
            return true;
    if (fan->count == FAN_MOST)
        return false;
    fan->prim[fan->count++] = prim;
    return true;
}

/* The neighbour of a triangle of the scene or the world, as above. */
static uint32_t neighbour(const struct fan *fan, uint32_t prim, uint32_t c)
{
    uint32_t base = fan->at.base, other = beyond(fan->topology, prim - base, c);
    return other == TOPOLOGY_NONE ? TOPOLOGY_NONE : base + other;
}

/* Adds the neighbours of member `i`; false if the fan is not closed there. */
static bool grow(struct fan *fan, size_t i)
{
    struct seen seen;
    uint32_t prim = fan->prim[i];
    bool unknown = fan->judge->model.formula == TWIN_UNKNOWN;
    if (!(unknown ? see_by_distance(fan, prim, &seen) : see_by_twin(fan, prim, &seen)))
        return false;
    if (i == 0)
        fan->sign = seen.det;
    if (seen.det == 0 || seen.det != fan->sign)
        return false;
    fan->limit = fmax(fan->limit, seen.t_most);
    for (uint32_t c = 0; c < 3; c++) {
        if (seen.edge[c] == fan->sign) {
            fan->rim = true;
            continue;
        }
        uint32_t other = neighbour(fan, prim, c);
        if (other == TOPOLOGY_NONE || !join(fan, other))
            return false;
    }
    return true;
}

/* The topology of a mesh, made by the first thread that needs it. */
static enum status topology_of(const struct judge *judge, const struct judge_at *at,
                               const struct topology **out)
{
    struct judge_lazy *lazy = judge->lazy;
    _Atomic(struct topology *) *place = &lazy->topology[at->mesh];
    struct topology *made = atomic_load(place);
    enum status status = STATUS_OK;
    if (!made) {
        pthread_mutex_lock(&lazy->lock);
        made = atomic_load(place);
        if (!made) {
            made = malloc(sizeof *made);
            status = made ? topology_make(at->scene, made, NULL) : STATUS_MEMORY;
            if (status) {
                free(made);
                made = NULL;
            }
            atomic_store(place, made);
        }
        pthread_mutex_unlock(&lazy->lock);
    }
    *out = made;
    return status;
}

enum status judge_fan(const struct judge *judge, const struct ray *ray, uint32_t prim,
                      const struct judge_found *found, bool *closed, double *limit)
{
    struct fan fan = {.judge = judge, .ray = ray, .limit = -INFINITY};
    *closed = false;
    fan.at = judge_locate(judge, prim);
    if (judge->world && !judge->own && !judge->place[fan.at.instance].identity)
        return STATUS_OK; /* nothing is known of the ray that it tests */
    enum status status = topology_of(judge, &fan.at, &fan.topology);
    if (status)
        return status;
    fan.prim[fan.count++] = prim;
    for (size_t i = 0; i < fan.count; i++)
        if (judge_find(found, fan.prim[i]) || !grow(&fan, i))
            return STATUS_OK;
    *closed = fan.rim;
    *limit = fan.limit;
    return STATUS_OK;
}
